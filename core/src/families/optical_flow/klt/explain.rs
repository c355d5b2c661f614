//! How the tracker is told and drawn.

use std::collections::BTreeMap;

use super::{Event, Klt, Live, State, line};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::features::{
    Account,
    affine::{Fit, place},
    follow,
    trails::{self, points},
    why,
};
use crate::products::{Feature, Status};
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Role, Scene, Sentence, Shape, Step, Tile};

fn px(uv: [f32; 2]) -> String {
    format!("{} px", words::vector(uv))
}

fn grays(difference: f32) -> String {
    format!("{} gray levels", words::number(difference))
}

/// The feature whose turn it is.
fn live<'a>(seen: &Seen<'a, Klt>) -> Option<&'a Live> {
    seen.before.live.get(seen.before.turn?)
}

/// The last of the events that `of` knows.
fn last<T>(events: &[Event], of: impl Fn(&Event) -> Option<T>) -> Option<T> {
    events.iter().rev().find_map(of)
}

/// How far from where a feature came tracking it back leads, in px.
fn off_px(live: &Live, place: [f32; 2]) -> f32 {
    (place[0] - live.at[0]).hypot(place[1] - live.at[1])
}

/// Where tracking back leads, if it does.
fn back(events: &[Event]) -> Option<[f32; 2]> {
    last(events, |event| if let Event::Back(back) = event { back.ok() } else { None })
}

fn fit(events: &[Event]) -> Option<Fit> {
    last(events, |event| if let Event::Fit(fit) = event { Some(*fit) } else { None })
}

impl Klt {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Enough | Event::Found(_)) => line::DETECT,
            Some(Event::Taken(_)) => line::TAKE_STRONGEST,
            Some(Event::Forward(..)) => line::TRACK,
            Some(Event::Back(_)) => line::TRACK_BACK,
            Some(Event::Fit(_)) => line::FIT_FIRST_VIEW,
            Some(Event::Verdict(Feature { status, .. })) => match status {
                Status::Astray => line::TRACK_BACK,
                Status::Changed => line::IS_CHANGED,
                Status::Tracked => line::MOVE,
                _ => line::TRACK,
            },
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    /// What has happened to the feature on the level at hand.
    fn account<'a>(&self, seen: &Seen<'a, Self>) -> Option<Account<'a>> {
        let (pair, level) = last_forward(seen.events).map(|(pair, level)| (pair, *level))?;
        let of_level = |wanted: usize| {
            seen.events.iter().filter_map(move |event| match event {
                Event::Forward(_, level, event) if *level == wanted => Some(*event),
                _ => None,
            })
        };
        let guess = of_level(level + 1).find_map(|event| match event {
            follow::Event::Handed(displacement, _) => Some(displacement.map(|c| 2.0 * c)),
            _ => None,
        });
        Some(Account {
            follow: self.follow(),
            pyramids: pair.pyramids(),
            level,
            at: live(seen)?.at,
            guess: guess.unwrap_or_default(),
            events: of_level(level).collect(),
            name: self.name(seen),
        })
    }

    fn name(&self, seen: &Seen<Self>) -> String {
        format!("Feature {}", live(seen).map_or(0, |live| live.track + 1))
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (state, said) = (seen.before, Sentence::default());
        let frame = state.frame;
        let Some(event) = seen.events.last() else {
            return said.text(format!(
                "Features are found in frame {frame} and tracked from frame to frame, through at most {} frames.",
                self.frames
            ));
        };
        match event {
            Event::Enough if self.replenish => said.text(format!(
                "{} tracked already: there is no room for more.",
                match state.live.len() {
                    1 => "1 feature is".into(),
                    count => format!("{count} features are"),
                }
            )),
            Event::Enough => said.text("Features that were lost are not replaced."),
            Event::Found(found) => said
                .text(format!(
                    "{} features may be added. {}: ",
                    self.max_points - state.live.len(),
                    self.detector.estimator().info().name
                ))
                .ink(Role::Best, words::counted(found.keypoints.points.len(), "keypoint"))
                .text(format!(
                    " in frame {frame}{}.",
                    match found.keypoints.keypoints.first().map(|keypoint| keypoint.response) {
                        Some(most) => format!(", the strongest with a response of {}", words::number(most)),
                        None => String::new(),
                    }
                )),
            Event::Taken(found) => said.ink(Role::Result, format!("{} new features", found.taken.len())).text(format!(
                " are taken, the strongest first, each at least {} px from the others{}.",
                self.min_distance,
                match state.live.len() {
                    0 => String::new(),
                    count => format!(" and from the {count} that are tracked"),
                }
            )),
            Event::Forward(..) => self.account(seen).map_or(said, |account| account.sentence()),
            Event::Back(result) => self.way_back(seen, *result),
            Event::Fit(fit) => {
                let since = live(seen).map_or(0, |live| state.tracks[live.track as usize].first);
                said.text("As ")
                    .ink(Role::Reference, self.name(seen))
                    .text(format!(" was first seen, in frame {since}, turned and stretched by "))
                    .ink(Role::Estimate, matrix(fit))
                    .text(format!(
                        " and shifted by {} px{}, it differs by {} on average.",
                        words::number(fit.shift[0].hypot(fit.shift[1])),
                        if self.any_light { format!(", in {}", light(fit)) } else { String::new() },
                        grays(fit.difference)
                    ))
            }
            Event::Verdict(feature) => self.verdict(seen, feature),
        }
    }

    fn way_back(&self, seen: &Seen<Self>, result: Result<[f32; 2], Status>) -> Sentence {
        let said = Sentence::default();
        match (live(seen), result) {
            (Some(live), Ok(place)) => {
                let off_px = off_px(live, place);
                let (role, verdict) =
                    if off_px > self.max_return { (Role::Rejected, "too far") } else { (Role::Best, "near enough") };
                said.text("Tracked back to frame t, ")
                    .ink(Role::Reference, self.name(seen))
                    .text(" comes to ")
                    .ink(Role::Predicted, words::vector(place))
                    .text(format!(", {} px from where it was: ", words::number(off_px)))
                    .ink(role, verdict)
                    .text(".")
            }
            _ => said
                .ink(Role::Reference, self.name(seen))
                .text(" cannot be tracked back: ")
                .ink(Role::Rejected, "the flow back is unknown there")
                .text("."),
        }
    }

    fn verdict(&self, seen: &Seen<Self>, feature: &Feature) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, self.name(seen));
        let frames = live(seen).map_or(0, |live| seen.before.tracks[live.track as usize].points.len());
        let Some(displacement) = feature.displacement else {
            let after = if frames == 1 { "at once".into() } else { format!("after {frames} frames") };
            return said.text(" is ").ink(Role::Rejected, format!("lost {after}")).text(why(feature.status));
        };
        said.text(" moves by ")
            .ink(Role::Result, px(displacement))
            .text(format!(" and has been seen in {} frames by now.", frames + 1))
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let Some(live) = live(seen) else {
            let found = seen.events.last().and_then(|event| match event {
                Event::Found(found) | Event::Taken(found) => Some(found),
                _ => None,
            });
            let mut facts = vec![Fact::new("Tracked", format!("{} features", seen.before.live.len()), None)];
            facts.extend(lost(seen.before).map(|lost| Fact::new("Lost so far", lost, Some(Role::Rejected))));
            // Each number from the step on that finds it.
            let stage = seen.events.len();
            facts.extend(found.map(|found| Fact::new("Keypoints", found.keypoints.points.len().to_string(), None)));
            let taken = found.filter(|_| stage > 1);
            facts.extend(taken.map(|found| Fact::new("New", found.taken.len().to_string(), None)));
            let plots = plots(seen.before).into_iter();
            return if seen.events.is_empty() {
                Vec::new()
            } else {
                [Readout::Facts(facts)].into_iter().chain(plots).collect()
            };
        };
        let account = self.account(seen);
        let mut readouts = vec![Readout::Facts(self.facts(seen, live, account.as_ref()))];
        match (seen.events.last(), account, fit(seen.events)) {
            (Some(Event::Fit(_) | Event::Verdict(_)), Some(account), Some(fit)) => {
                readouts.push(Readout::Equation(equation(&fit, self.any_light)));
                readouts.push(Readout::Tiles(views(&account, live, &fit)));
            }
            (_, Some(account), _) => readouts.extend(account.readouts()),
            _ => {}
        }
        readouts.extend(plots(seen.before));
        readouts
    }

    fn facts(&self, seen: &Seen<Self>, live: &Live, account: Option<&Account>) -> Vec<Fact> {
        let track = &seen.before.tracks[live.track as usize];
        let mut facts = vec![
            Fact::new("Feature", format!("{} at {}", live.track + 1, words::vector(live.at)), Some(Role::Reference)),
            Fact::new("Seen since", format!("frame {}", track.first), None),
        ];
        facts.extend(account.map(Account::facts).unwrap_or_default());
        if let Some(place) = back(seen.events) {
            let off_px = off_px(live, place);
            facts.push(Fact::new("Direction back", format!("{} px off", words::number(off_px)), Some(Role::Predicted)));
        }
        if let Some(fit) = fit(seen.events) {
            facts.push(Fact::new("From first view", grays(fit.difference), Some(Role::Estimate)));
            facts.extend(self.any_light.then(|| Fact::new("Light", light(&fit), None)));
        }
        let truth = last_forward(seen.events).and_then(|(pair, _)| {
            let [x, y] = live.at.map(|c| c.round() as usize);
            pair.truth.as_ref().filter(|truth| truth.0.get(x, y).is_some())?.at(x, y)
        });
        facts.extend(truth.map(|truth| Fact::new("Truth", px(truth), Some(Role::Truth))));
        facts
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        draw_features(seen, scene);
        match seen.events.last() {
            Some(Event::Found(found)) => {
                points(scene, Role::Best, "keypoint", found.keypoints.points.iter().map(|point| point.at).collect());
            }
            Some(Event::Taken(found)) => points(scene, Role::Result, "new feature", found.taken.clone()),
            _ => {}
        }
        let Some(account) = self.account(seen) else { return };
        match (seen.events.last(), fit(seen.events)) {
            (Some(event @ (Event::Fit(_) | Event::Verdict(_))), Some(fit)) => {
                let is_refused = matches!(event, Event::Verdict(feature) if feature.displacement.is_none());
                draw_view(&account, &fit, is_refused, scene);
            }
            _ => account.draw([Picture::CURRENT, Picture::NEXT], scene),
        }
        if let Some(place) = back(seen.events) {
            points(scene, Role::Predicted, "where tracking back leads", vec![place]);
        }
    }
}

fn last_forward(events: &[Event]) -> Option<(&super::Pair, &usize)> {
    events.iter().rev().find_map(|event| match event {
        Event::Forward(pair, level, _) => Some((&**pair, level)),
        _ => None,
    })
}

/// The features of the pair: their trails, where those that had their turn have gone, and those that wait.
fn draw_features(seen: &Seen<Klt>, scene: &mut Scene) {
    let (before, after) = (seen.before, seen.after.unwrap_or(seen.before));
    let is_looking = before.turn.is_none();
    let (frame, live) = (before.frame, if is_looking { &after.live } else { &before.live });
    let (mut arrows, mut lost, mut waiting) = (Vec::new(), Vec::new(), Vec::new());
    for live in live {
        let track = &after.tracks[live.track as usize];
        let Some(feature) = track.at(frame) else { continue };
        trails::trail(scene, (Role::Estimate, "trail"), track, frame);
        match (feature.displacement, feature.status) {
            (Some([u, v]), _) => {
                arrows.push(Arrow { from: feature.at, to: [feature.at[0] + u, feature.at[1] + v] });
            }
            (None, Status::Found) => waiting.push(feature.at),
            (None, _) => lost.push(feature.at),
        }
    }
    points(scene, Role::Measured, if is_looking { "feature" } else { "feature that waits" }, waiting);
    if live.is_empty() {
        scene.legend(Role::Measured, "no features yet");
    }
    points(scene, Role::Rejected, "lost", lost);
    trails::displacements(scene, arrows);
}

/// The outline of the first view as it lies in the second frame.
fn draw_view(account: &Account, fit: &Fit, is_refused: bool, scene: &mut Scene) {
    let half = account.follow.reach as f32 + 0.5;
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    let [x, y] = account.at;
    let window = Shape::Rect { min: [x - half, y - half], max: [x + half, y + half] };
    scene.mark(Picture::CURRENT, Role::Reference, window);
    scene.legend(Role::Reference, "window");
    let to = [0, 1].map(|i| account.at[i] + account.on_picture()[i]);
    let outline = corners.map(|corner| place(to, fit, corner)).to_vec();
    let role = if is_refused { Role::Rejected } else { Role::Best };
    scene.mark(Picture::NEXT, role, Shape::Path { points: outline, closed: true });
    scene.legend(role, "its first view, turned and stretched");
}

fn matrix(fit: &Fit) -> String {
    let [[a, b], [c, d]] = fit.matrix.map(|row| row.map(words::number));
    format!("A\u{a0}= ({a},\u{a0}{b}; {c},\u{a0}{d})")
}

/// The entries of A in brackets.
fn entries(fit: &Fit) -> Math {
    let entry = |value: &f32| Math::ink(Role::Estimate, words::number(*value));
    Math::Matrix(fit.matrix.iter().map(|row| row.iter().map(entry).collect()).collect())
}

/// The light of a fit: `λ = 0.92, δ = −3.1`.
fn light(Fit { light: [gain, offset], .. }: &Fit) -> String {
    format!("λ\u{a0}= {}, δ\u{a0}= {}", words::number(*gain), words::number(*offset))
}

/// What the fit makes least, and what it has come to.
fn equation(fit: &Fit, in_any_light: bool) -> Vec<Math> {
    let (text, var) = (|text: &str| Math::text(text), Math::Var);
    let mut symbols =
        vec![text("Σ ("), var("J"), text("("), Math::Bold("A"), text(" "), var("o"), text(" + "), var("s")];
    symbols.push(text(") − "));
    symbols.extend(in_any_light.then(|| var("λ")));
    symbols.extend([var("I"), text("("), var("o"), text(")")]);
    if in_any_light {
        symbols.extend([text(" − "), var("δ")]);
    }
    symbols.extend([Math::power(text(")"), text("2")), text(" → min")]);
    let numbers = Math::Row(vec![
        Math::Bold("A"),
        text(" = "),
        entries(fit),
        text(", "),
        var("s"),
        text(" = "),
        Math::ink(Role::Estimate, words::vector(fit.shift)),
    ]);
    let mut lines = vec![Math::Row(symbols), numbers];
    lines.extend(in_any_light.then(|| Math::ink(Role::Estimate, light(fit))));
    lines
}

/// The first view, how it lies now, and what differs.
fn views(account: &Account, live: &Live, fit: &Fit) -> Vec<Tile> {
    let side = live.view.side();
    let round = |v: &f32| (v * 10.0).round() / 10.0;
    let grid = |values: &[f32]| Grid::from_fn(side, side, |x, y| round(&values[y * side + x]));
    let to = [0, 1].map(|i| account.at[i] + account.on_picture()[i]);
    let (first, now) = (grid(live.view.values()), grid(&live.view.warped(&account.pyramids[1][0], to, fit)));
    let difference = Grid::from_fn(side, side, |x, y| first[(x, y)] - now[(x, y)]);
    let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(v.abs()));
    let tile = |label, role, values, range| Tile { label, role, values, range };
    vec![
        tile("First view", Some(Role::Reference), first, [0.0, 255.0]),
        tile("Now", Some(Role::Best), now, [0.0, 255.0]),
        tile("Difference", None, difference, [-most, most]),
    ]
}

/// How many features were lost so far, by reason.
fn lost(state: &State) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let last = state.tracks.iter().filter_map(|track| track.points.last());
    for reason in last.filter_map(|point| point.status.name().strip_prefix("lost-")) {
        *counts.entry(reason).or_default() += 1;
    }
    let told: Vec<String> = counts.into_iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    (!told.is_empty()).then(|| told.join(", "))
}

fn plots(state: &State) -> Option<Readout> {
    trails::turnover("Features", &state.counts, &state.tracks, &state.span)
}
