//! The explanation and the drawing of the KLT tracker.

use std::collections::BTreeMap;

use super::{Event, Klt, Live, State, line};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::differential::numbers;
use crate::methods::features::{
    LevelTrace,
    affine::{Fit, place},
    conclusion, follow, reason_of,
    trails::{self, points},
    why,
};
use crate::products::{Feature, Status};
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Role, Scene, Sentence, Shape, Step, Tile};

fn px(uv: [f32; 2]) -> String {
    format!("{} px", numbers::vector(uv))
}

fn grays(difference: f32) -> String {
    format!("{} gray levels", numbers::gray(difference))
}

/// The current feature.
fn live<'a>(seen: &Seen<'a, Klt>) -> Option<&'a Live> {
    seen.before.live.get(seen.before.turn?)
}

/// The last event that `of` accepts.
fn last<T>(events: &[Event], of: impl Fn(&Event) -> Option<T>) -> Option<T> {
    events.iter().rev().find_map(of)
}

/// The forward–backward error of a feature, in px.
fn fb_error(live: &Live, place: [f32; 2]) -> f32 {
    (place[0] - live.at[0]).hypot(place[1] - live.at[1])
}

/// The position after tracking back, if it succeeded.
fn back(events: &[Event]) -> Option<[f32; 2]> {
    last(events, |event| if let Event::Back(back) = event { back.ok() } else { None })
}

/// The true displacement of a feature, where it is known.
fn true_displacement(seen: &Seen<Klt>, live: &Live) -> Option<[f32; 2]> {
    let (pair, _) = last_forward(seen.events)?;
    let [x, y] = live.at.map(|c| c.round() as usize);
    pair.truth.as_ref().filter(|truth| truth.0.get(x, y).is_some())?.at(x, y)
}

fn fit(events: &[Event]) -> Option<Fit> {
    last(events, |event| if let Event::Fit(fit) = event { Some(*fit) } else { None })
}

impl Klt {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Enough | Event::Found(_)) => line::DETECT,
            Some(Event::Taken(_)) => line::TAKE_STRONGEST,
            Some(Event::Forward(..)) => line::TRACK,
            Some(Event::Back(_)) => line::TRACK_BACK,
            Some(Event::Fit(_)) => line::FIT_FIRST_VIEW,
            Some(Event::Correlated(_)) => line::CORRELATE,
            Some(Event::Verdict(Feature { status, .. })) => match status {
                Status::Astray => line::TRACK_BACK,
                Status::Changed => line::IS_CHANGED,
                Status::Tracked => line::MOVE,
                _ => line::TRACK,
            },
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    /// Returns the tracking of the feature on the current level.
    fn level_trace<'a>(&self, seen: &Seen<'a, Self>) -> Option<LevelTrace<'a>> {
        let (pair, level) = last_forward(seen.events).map(|(pair, level)| (pair, *level))?;
        let of_level = |wanted: usize| {
            seen.events.iter().filter_map(move |event| match event {
                Event::Forward(_, level, event) if *level == wanted => Some(*event),
                _ => None,
            })
        };
        let guess = of_level(level + 1).find_map(|event| match event {
            follow::Event::PassedDown(displacement, _) => Some(displacement.map(|c| 2.0 * c)),
            _ => None,
        });
        Some(LevelTrace {
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
                "KLT detects features in frame {frame} and tracks them from frame to frame, through at most {} frames. Checks \
                 end tracks that drift or are occluded.",
                self.frames
            ));
        };
        match event {
            Event::Enough if self.replenish => said.text(format!(
                "No new features in frame {frame}: {} tracked, and the maximum number of points, {}, is reached.",
                match state.live.len() {
                    1 => "1 feature is".to_owned(),
                    count => format!("{count} features are"),
                },
                self.max_points
            )),
            Event::Enough => said.text(format!(
                "No new features in frame {frame}: replenish is off, so lost features are not replaced."
            )),
            Event::Found(found) => said
                .text(format!(
                    "{} of at most {} features are tracked. {} in frame {frame}: ",
                    state.live.len(),
                    self.max_points,
                    self.detector.estimator().info().name
                ))
                .ink(Role::Best, words::counted(found.keypoints.points.len(), "keypoint"))
                .text(format!(
                    "{}.",
                    match found.keypoints.keypoints.first().map(|keypoint| keypoint.response) {
                        Some(most) => format!(", the strongest with response {}", numbers::gray(most)),
                        None => String::new(),
                    }
                )),
            Event::Taken(found) => said.ink(Role::Result, words::counted(found.taken.len(), "new feature")).text(format!(
                ", in order of decreasing response, each at least {} px (the minimum distance) from all others. Their first views are \
                 stored for the affine check.",
                self.min_distance
            )),
            Event::Forward(..) => self.level_trace(seen).map_or(said, |level_trace| level_trace.sentence()),
            Event::Back(result) => self.backward(seen, *result),
            Event::Fit(fit) => {
                let since = live(seen).map_or(0, |live| state.tracks[live.track as usize].first);
                said.text("Affine fit of the first view (frame ")
                    .text(format!("{since}) of "))
                    .ink(Role::Reference, self.name(seen).to_lowercase())
                    .text(": ")
                    .ink(Role::Estimate, matrix(fit))
                    .text(format!(
                        ", shift {} px{}. Dissimilarity: {}, at most {} is accepted.",
                        numbers::px(fit.shift[0].hypot(fit.shift[1])),
                        if self.illumination { format!(", {}", light(fit)) } else { String::new() },
                        grays(fit.difference),
                        numbers::gray(self.max_dissimilarity)
                    ))
            }
            Event::Correlated(correlation) => {
                let fit = fit(seen.events).map_or_else(String::new, |fit| format!(" (last dissimilarity {})", grays(fit.difference)));
                said.text(format!("No affine map explains the window within the limit{fit}. Correlation with the first view: "))
                    .ink(Role::Estimate, match correlation {
                        Some(correlation) => format!("ρ\u{a0}= {}", numbers::fixed(*correlation, 2)),
                        None => "undefined, as the window has no contrast".into(),
                    })
                    .text(match correlation {
                        Some(correlation) if *correlation >= self.min_correlation => format!(
                            ", not below {}: the feature has deformed, and is kept.",
                            numbers::fixed(self.min_correlation, 2)
                        ),
                        Some(_) => format!(", below {}: it shows something else.", numbers::fixed(self.min_correlation, 2)),
                        None => ".".into(),
                    })
            }
            Event::Verdict(feature) => self.concluded(seen, self.verdict(seen, feature)),
        }
    }

    fn backward(&self, seen: &Seen<Self>, result: Result<[f32; 2], Status>) -> Sentence {
        let said = Sentence::default();
        match (live(seen), result) {
            (Some(live), Ok(place)) => {
                let off_px = fb_error(live, place);
                let (role, verdict) =
                    if off_px > self.max_fb_error { (Role::Rejected, "rejected") } else { (Role::Best, "accepted") };
                said.text("Forward–backward check of ")
                    .ink(Role::Reference, self.name(seen).to_lowercase())
                    .text(": tracking back ends at ")
                    .ink(Role::Predicted, numbers::vector(place))
                    .text(format!(
                        ". The forward–backward error of {} px is {} the maximum of {} px: ",
                        numbers::px(off_px),
                        if off_px > self.max_fb_error { "above" } else { "not above" },
                        numbers::px(self.max_fb_error)
                    ))
                    .ink(role, verdict)
                    .text(".")
            }
            _ => said
                .ink(Role::Reference, self.name(seen))
                .text(": tracking back fails, so the forward–backward check is ")
                .ink(Role::Rejected, "not passed")
                .text("."),
        }
    }

    fn verdict(&self, seen: &Seen<Self>, feature: &Feature) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, self.name(seen));
        let frames = live(seen).map_or(0, |live| seen.before.tracks[live.track as usize].points.len());
        let Some(displacement) = feature.displacement else {
            let after = if frames == 1 { "in its first pair".into() } else { format!("after {frames} frames") };
            return said.text(" is ").ink(Role::Rejected, format!("lost {after}")).text(why(feature.status));
        };
        said.text(" passes all checks: displacement ")
            .ink(Role::Result, px(displacement))
            .text(format!(", track length {} frames.", frames + 1))
    }

    /// Adds the conclusion of a pair and of the run, at the end of each.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let frame = seen.before.frame;
        let (Some(after), Some((pair, _))) = (seen.after, last_forward(seen.events)) else { return sentence };
        if after.frame == frame {
            return sentence;
        }
        let features = after.tracks.iter().filter_map(|track| track.at(frame)).copied();
        let conclusion = conclusion("features", features, pair.truth.as_deref());
        sentence.text(format!(" End of the pair of frames {frame} and {}: {conclusion}", after.frame))
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let Some(live) = live(seen) else {
            let found = seen.events.last().and_then(|event| match event {
                Event::Found(found) | Event::Taken(found) => Some(found),
                _ => None,
            });
            let mut facts = vec![Fact::new("Tracked features", seen.before.live.len().to_string(), None)];
            facts.extend(lost(seen.before).map(|lost| Fact::new("Lost so far", lost, Some(Role::Rejected))));
            // Each number from the step that determines it.
            let stage = seen.events.len();
            facts.extend(found.map(|found| Fact::new("Keypoints", found.keypoints.points.len().to_string(), None)));
            let taken = found.filter(|_| stage > 1);
            facts.extend(taken.map(|found| Fact::new("New features", found.taken.len().to_string(), None)));
            let plots = plots(seen.before).into_iter();
            return if seen.events.is_empty() {
                Vec::new()
            } else {
                [Readout::Facts(facts)].into_iter().chain(plots).collect()
            };
        };
        let level_trace = self.level_trace(seen);
        let mut readouts = vec![Readout::Facts(self.facts(seen, live, level_trace.as_ref()))];
        match (seen.events.last(), level_trace, fit(seen.events)) {
            (Some(Event::Fit(_) | Event::Correlated(_) | Event::Verdict(_)), Some(level_trace), Some(fit)) => {
                readouts.push(Readout::Equation(equation(&fit, self.illumination)));
                readouts.push(Readout::Tiles(views(&level_trace, live, &fit)));
            }
            (_, Some(level_trace), _) => readouts.extend(level_trace.readouts(true_displacement(seen, live))),
            _ => {}
        }
        readouts.extend(plots(seen.before));
        readouts
    }

    fn facts(&self, seen: &Seen<Self>, live: &Live, level_trace: Option<&LevelTrace>) -> Vec<Fact> {
        let track = &seen.before.tracks[live.track as usize];
        let mut facts = vec![
            Fact::new("Feature", format!("{} at {}", live.track + 1, numbers::vector(live.at)), Some(Role::Reference)),
            Fact::new("Detected in", format!("frame {}", track.first), None),
        ];
        facts.extend(level_trace.map(LevelTrace::facts).unwrap_or_default());
        if let Some(place) = back(seen.events) {
            let off_px = fb_error(live, place);
            facts.push(Fact::new(
                "Forward–backward error",
                format!("{} px", numbers::px(off_px)),
                Some(Role::Predicted),
            ));
        }
        if let Some(fit) = fit(seen.events) {
            facts.push(Fact::new("Dissimilarity", grays(fit.difference), Some(Role::Estimate)));
            facts.extend(self.illumination.then(|| Fact::new("Gain λ, offset δ", light(&fit), None)));
        }
        facts.extend(
            true_displacement(seen, live).map(|truth| Fact::new("True displacement", px(truth), Some(Role::Truth))),
        );
        facts
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        draw_features(seen, scene);
        match seen.events.last() {
            Some(Event::Found(found)) => {
                points(scene, Role::Best, "keypoint", found.keypoints.points.iter().map(|point| point.at).collect());
            }
            Some(Event::Taken(found)) => points(scene, Role::Result, "new feature", found.taken.clone()),
            _ => {}
        }
        let Some(level_trace) = self.level_trace(seen) else { return };
        match (seen.events.last(), fit(seen.events)) {
            (Some(event @ (Event::Fit(_) | Event::Correlated(_) | Event::Verdict(_))), Some(fit)) => {
                let is_refused = matches!(event, Event::Verdict(feature) if feature.displacement.is_none());
                draw_view(&level_trace, &fit, is_refused, scene);
            }
            _ => level_trace.draw([Picture::CURRENT, Picture::NEXT], scene),
        }
        if let Some(place) = back(seen.events) {
            points(scene, Role::Predicted, "position after tracking back", vec![place]);
        }
    }
}

fn last_forward(events: &[Event]) -> Option<(&super::Pair, &usize)> {
    events.iter().rev().find_map(|event| match event {
        Event::Forward(pair, level, _) => Some((&**pair, level)),
        _ => None,
    })
}

/// Draws the features of the pair: trails, displacements of tracked ones, lost ones, and those still to be tracked.
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
    points(scene, Role::Measured, if is_looking { "feature" } else { "feature, not yet tracked" }, waiting);
    if live.is_empty() {
        scene.legend(Role::Measured, "no features yet");
    }
    points(scene, Role::Rejected, "lost", lost);
    trails::displacements(scene, arrows);
}

/// Draws the outline of the first view, mapped to the second frame.
fn draw_view(level_trace: &LevelTrace, fit: &Fit, is_refused: bool, scene: &mut Scene) {
    let half = level_trace.follow.reach as f32 + 0.5;
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    let [x, y] = level_trace.at;
    let window = Shape::Rect { min: [x - half, y - half], max: [x + half, y + half] };
    scene.mark(Picture::CURRENT, Role::Reference, window);
    scene.legend(Role::Reference, "window");
    let to = [0, 1].map(|i| level_trace.at[i] + level_trace.on_picture()[i]);
    let outline = corners.map(|corner| place(to, fit, corner)).to_vec();
    let role = if is_refused { Role::Rejected } else { Role::Best };
    scene.mark(Picture::NEXT, role, Shape::Path { points: outline, closed: true });
    scene.legend(role, "first view, mapped by the affine fit");
}

fn matrix(fit: &Fit) -> String {
    let [[a, b], [c, d]] = fit.matrix.map(|row| row.map(numbers::px));
    format!("A\u{a0}= ({a},\u{a0}{b}; {c},\u{a0}{d})")
}

/// The entries of A in brackets.
fn entries(fit: &Fit) -> Math {
    let entry = |value: &f32| Math::ink(Role::Estimate, numbers::fixed(*value, 3));
    Math::Matrix(fit.matrix.iter().map(|row| row.iter().map(entry).collect()).collect())
}

/// Gain and offset of a fit: `λ = 0.920, δ = −3.10`.
fn light(Fit { light: [gain, offset], .. }: &Fit) -> String {
    format!("λ\u{a0}= {}, δ\u{a0}= {}", numbers::px(*gain), numbers::gray(*offset))
}

/// The objective of the fit and its result.
fn equation(fit: &Fit, with_illumination: bool) -> Vec<Math> {
    let (text, var) = (|text: &str| Math::text(text), Math::Var);
    let mut symbols =
        vec![text("Σ ("), var("J"), text("("), Math::Bold("A"), text(" "), var("o"), text(" + "), var("s")];
    symbols.push(text(") − "));
    symbols.extend(with_illumination.then(|| var("λ")));
    symbols.extend([var("I"), text("("), var("o"), text(")")]);
    if with_illumination {
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
        Math::ink(Role::Estimate, numbers::vector(fit.shift)),
    ]);
    let mut lines = vec![Math::Row(symbols), numbers];
    lines.extend(with_illumination.then(|| Math::ink(Role::Estimate, light(fit))));
    lines
}

/// The first view, the mapped window, and their difference.
fn views(level_trace: &LevelTrace, live: &Live, fit: &Fit) -> Vec<Tile> {
    let side = live.view.side();
    let round = |v: &f32| (v * 10.0).round() / 10.0;
    let grid = |values: &[f32]| Grid::from_fn(side, side, |x, y| round(&values[y * side + x]));
    let to = [0, 1].map(|i| level_trace.at[i] + level_trace.on_picture()[i]);
    let (first, now) = (grid(live.view.values()), grid(&live.view.warped(&level_trace.pyramids[1][0], to, fit)));
    let difference = Grid::from_fn(side, side, |x, y| first[(x, y)] - now[(x, y)]);
    let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(v.abs()));
    let tile = |label, role, values, range| Tile { label, role, values, range, framed: Vec::new() };
    vec![
        tile("First view", Some(Role::Reference), first, [0.0, 255.0]),
        tile("Mapped window", Some(Role::Best), now, [0.0, 255.0]),
        tile("Difference", None, difference, [-most, most]),
    ]
}

/// The number of lost features, by reason.
fn lost(state: &State) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let last = state.tracks.iter().filter_map(|track| track.points.last());
    for reason in last.filter_map(|point| reason_of(point.status)) {
        *counts.entry(reason).or_default() += 1;
    }
    let reasons: Vec<String> = counts.into_iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    (!reasons.is_empty()).then(|| reasons.join(", "))
}

fn plots(state: &State) -> Option<Readout> {
    trails::turnover("Features", &state.counts, &state.tracks, &state.span)
}
