//! The explanation and the drawing of point trajectories.

use super::{Event, Moved, Note, Pair, PointTrajectories, State, What, distance, line};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::{
    differential::{field, numbers},
    features::{conclusion, reason_of, trails},
};
use crate::products::{Status, consistency::returned};
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

/// Radius of the image patches, in px.
const TILE_REACH_PX: isize = 4;

/// The legend of trail and position by feature tracking.
const AS_FEATURE: &str = "feature track";

fn px(length: f32) -> String {
    format!("{} px", numbers::px(length))
}

fn last(events: &[Event]) -> Option<&What> {
    events.last().map(|event| &event.0)
}

/// The results of the points so far.
fn moved(events: &[Event]) -> impl Iterator<Item = (&Pair, &Moved)> {
    events
        .iter()
        .filter_map(|event| if let What::Moved(pair, moved) = &event.0 { Some((&**pair, moved)) } else { None })
}

impl PointTrajectories {
    /// Returns the processed point pointed at, or else the current one.
    fn probe<'a>(&self, seen: &Seen<'a, Self>) -> Option<(&'a Pair, &'a Moved)> {
        let far = |moved: &Moved| seen.point().map_or(f32::INFINITY, |point| distance(moved.live.at, point));
        let nearest = moved(seen.events).min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
        nearest.filter(|(_, moved)| far(moved) <= self.spacing as f32).or(match last(seen.events)? {
            What::Moved(pair, moved) => Some((&**pair, moved)),
            _ => None,
        })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let line = match (last(seen.events), self.probe(seen)) {
            (Some(What::Flow(_)), _) => line::FIND_FLOW,
            (Some(What::Begun(_)), _) => line::BEGIN_POINTS,
            (Some(_), Some((_, moved))) => match moved.feature.status {
                Status::Flat => line::IS_FLAT,
                Status::Outside => line::IS_OUTSIDE,
                Status::Astray => line::IS_ASTRAY,
                _ => line::CARRY,
            },
            (Some(What::Done(_)), None) => line::COMPARE_FEATURES,
            _ => line::EACH_FRAME,
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (said, state) = (Sentence::default(), seen.before);
        let (here, next) = (state.frame, state.frame + 1);
        if let Some((_, moved)) = self.probe(seen) {
            return self.point(moved);
        }
        match last(seen.events) {
            None | Some(What::Moved(..)) => said
                .text("Grid points are ")
                .ink(Role::Result, "advected by dense flow")
                .text(" from frame to frame, x ← x + w(x), so errors of the flow accumulate as drift. The same points are ")
                .ink(Role::Predicted, "tracked as features")
                .text("; their distance measures the drift without ground truth."),
            Some(What::Flow(_)) => said.text(format!(
                "{} estimates the flow w from frame {here} to {next} and the backward flow w′ for the forward–backward check.",
                self.method.estimator().info().name
            )),
            Some(What::Begun(0)) => said.text(match self.replenish || here == state.span.first {
                true => format!(
                    "No new points: all grid cells with λ₂ ≥ {} are occupied. {} continue.",
                    numbers::gray(self.min_eigenvalue),
                    words::counted(state.live.len(), "point")
                ),
                false => {
                    format!("No new points: replenish is off. {} continue.", words::counted(state.live.len(), "point"))
                }
            }),
            Some(What::Begun(count)) => said.ink(Role::Measured, words::counted(*count, "new point")).text(format!(
                " in empty grid cells of {} px with λ₂ of at least {} (the minimum eigenvalue); {} continue.",
                self.spacing,
                numbers::gray(self.min_eigenvalue),
                words::counted(state.live.len(), "point")
            )),
            Some(What::Done(note)) => {
                let left = seen.after.map_or(0, |after| after.live.len());
                let said = said
                    .ink(Role::Result, left.to_string())
                    .text(format!(" of {} continue in frame {next}. ", words::counted(note.points as usize, "point")));
                let said = match note.apart.is_finite() {
                    true => {
                        said.text("Mean drift between flow and feature tracks: ").ink(Role::Error, px(note.apart)).text(".")
                    }
                    false => said.text("No feature track is left, so the drift is unknown."),
                };
                self.concluded(seen, said)
            }
        }
    }

    /// Explains the result of a point.
    fn point(&self, moved: &Moved) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, format!("Point {}", moved.live.track + 1));
        let Some(to) = moved.to() else {
            let why = match (moved.feature.status, moved.check(self)) {
                (Status::Flat, _) => format!(
                    ": λ₂ = {} is below the minimum eigenvalue of {}, so the window has no texture or only an edge.",
                    numbers::gray(moved.structure),
                    numbers::gray(self.min_eigenvalue)
                ),
                (Status::Outside, _) => ": the flow leads out of the frame.".into(),
                (_, Some([off, limit])) => format!(
                    ": forward–backward error {} exceeds the tolerance of {}, a sign of occlusion or wrong flow.",
                    px(off.sqrt()),
                    px(limit.sqrt())
                ),
                _ => ": the flow is unknown at this position.".into(),
            };
            return said.text(" is ").ink(Role::Rejected, "lost").text(why);
        };
        let said = said.text(" is advected to ").ink(Role::Result, numbers::vector(to));
        let said = match (moved.twin_to(), moved.apart()) {
            (Some(twin), Some(apart)) => said
                .text(", its feature track to ")
                .ink(Role::Predicted, numbers::vector(twin))
                .text(". Drift between both since the start: ")
                .ink(Role::Error, px(apart))
                .text("."),
            _ => said.text("; its feature track is ").ink(Role::Rejected, "lost").text("."),
        };
        match moved.truth {
            Some(truth) => said
                .text(" True position: ")
                .ink(Role::Truth, numbers::vector(truth))
                .text(format!(", so the flow trajectory has an error of {}.", px(distance(to, truth)))),
            None => said,
        }
    }

    /// Adds the conclusion of a pair.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let Some((pair, _)) = moved(seen.events).next() else { return sentence };
        let features = moved(seen.events).map(|(_, moved)| moved.feature);
        let conclusion = conclusion("points", features, pair.truth.as_deref());
        sentence.text(format!(" End of the pair: {conclusion}"))
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let Some(event) = last(seen.events) else { return Vec::new() };
        let mut facts =
            vec![Fact::new("Pair", format!("frames {} and {}", seen.before.frame, seen.before.frame + 1), None)];
        let probe = self.probe(seen);
        match (event, probe) {
            (_, Some((_, moved))) => facts.extend(self.facts(moved)),
            (What::Done(note), None) => facts.extend(note.facts()),
            (What::Begun(count), None) => facts.push(Fact::new("New points", count.to_string(), Some(Role::Measured))),
            _ => facts.push(Fact::new("Points", seen.before.live.len().to_string(), None)),
        }
        let mut readouts = vec![Readout::Facts(facts)];
        if let Some((pair, moved)) = probe {
            readouts.extend(self.equation(moved).map(Readout::Equation));
            readouts.push(Readout::Tiles(tiles(pair, moved)));
        }
        readouts.extend(plots(seen.after.unwrap_or(seen.before)));
        readouts
    }

    fn facts(&self, moved: &Moved) -> Vec<Fact> {
        let at = numbers::vector(moved.live.at);
        let mut facts = vec![
            Fact::new("Point", format!("{} at {at}", moved.live.track + 1), Some(Role::Reference)),
            Fact::new(
                "Smaller eigenvalue λ₂",
                format!("{} (gray levels per px)²", numbers::gray(moved.structure)),
                None,
            ),
        ];
        facts.extend(
            moved
                .there
                .map(|uv| Fact::new("Forward flow w", format!("{} px", numbers::vector(uv)), Some(Role::Result))),
        );
        facts.extend(moved.back.map(|uv| Fact::new("Backward flow w′", format!("{} px", numbers::vector(uv)), None)));
        if let Some([off, limit]) = moved.check(self) {
            facts.push(Fact::new(
                "Squared forward–backward error",
                format!("{} px², tolerance {} px²", numbers::px(off), numbers::px(limit)),
                None,
            ));
        }
        if let Some(twin) = moved.twin {
            let value = match (twin.end(), reason_of(twin.status)) {
                (Some(to), _) => format!("at {}", numbers::vector(to)),
                (None, Some(reason)) => format!("lost: {reason}"),
                (None, None) => "lost".into(),
            };
            facts.push(Fact::new("Feature track", value, Some(Role::Predicted)));
        }
        facts.extend(moved.apart().map(|apart| Fact::new("Drift", px(apart), Some(Role::Error))));
        if let Some(truth) = moved.truth {
            facts.push(Fact::new("True position", format!("at {}", numbers::vector(truth)), Some(Role::Truth)));
            facts.extend(moved.to().map(|to| Fact::new("Error of the flow track", px(distance(to, truth)), None)));
            facts.extend(
                moved.twin_to().map(|to| Fact::new("Error of the feature track", px(distance(to, truth)), None)),
            );
        }
        facts
    }

    /// Returns the advection step and the forward–backward check as formulas.
    fn equation(&self, moved: &Moved) -> Option<Vec<Math>> {
        let (there, at) = (moved.there?, moved.live.at);
        let to = [0, 1].map(|i| at[i] + there[i]);
        let step = Math::Row(vec![
            Math::Var("x"),
            Math::text(" + "),
            Math::Var("w"),
            Math::text(" = "),
            Math::ink(Role::Reference, numbers::vector(at)),
            Math::text(" + "),
            Math::ink(Role::Result, numbers::vector(there)),
            Math::text(format!(" = {}", numbers::vector(to))),
        ]);
        let Some([off, limit]) = moved.check(self) else { return Some(vec![step]) };
        let is_near = off <= limit;
        let role = if is_near { Role::Best } else { Role::Rejected };
        let sum = Math::Row(vec![Math::Var("w"), Math::text(" + "), Math::Var("w′")]);
        let check = Math::Row(vec![
            Math::power(Math::Abs(Box::new(sum)), Math::text("2")),
            Math::text(" = "),
            Math::ink(role, numbers::px(off)),
            Math::text(format!("{}{} px²", if is_near { " ≤ " } else { " > " }, numbers::px(limit))),
        ]);
        Some(vec![step, check])
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        if let Some(What::Flow(pair)) = last(seen.events) {
            field::draw(pair.flows[0].0.clone(), scene);
        }
        let state = seen.after.unwrap_or(seen.before);
        let frame = seen.before.frame;
        let done: Vec<&Moved> = moved(seen.events).map(|(_, moved)| moved).collect();
        let is_over = seen.after.is_some();
        // Points are processed in order.
        let waits = if is_over { &[][..] } else { seen.before.live.get(done.len()..).unwrap_or_default() };
        trails::points(scene, Role::Measured, "point", waits.iter().map(|live| live.at).collect());
        for live in done.iter().map(|moved| &moved.live).chain(waits) {
            // A new point has no trail yet.
            let tracks = [&state.tracks, &state.twins].map(|all| all.get(live.track as usize));
            if let [Some(track), Some(twin)] = tracks {
                trails::trail(scene, (Role::Predicted, AS_FEATURE), twin, frame);
                trails::trail(scene, (Role::Estimate, "trajectory by dense flow"), track, frame);
            }
        }
        let lost = done.iter().filter(|moved| moved.to().is_none());
        trails::points(scene, Role::Rejected, "lost", lost.map(|moved| moved.live.at).collect());
        let arrow = |moved: &&Moved| Some(Arrow { from: moved.live.at, to: moved.to()? });
        trails::displacements(scene, done.iter().filter_map(arrow).collect());
        draw_ends(scene, &done);
        if let Some((_, moved)) = self.probe(seen) {
            trails::points(scene, Role::Reference, "inspected point", vec![moved.live.at]);
        }
        scene.legend(Role::Result, "displacement to frame t+1");
    }
}

/// Draws the positions in frame t + 1 by flow, by feature tracking and in truth, and the drift between the first two.
fn draw_ends(scene: &mut Scene, done: &[&Moved]) {
    let mut mark = |role, meaning, places: Vec<[f32; 2]>| {
        if !places.is_empty() {
            scene.mark(Picture::NEXT, role, Shape::Points(places));
            scene.legend(role, meaning);
        }
    };
    let known = |of: &dyn Fn(&Moved) -> Option<[f32; 2]>| done.iter().filter_map(|moved| of(moved)).collect();
    mark(Role::Truth, "true position", known(&|moved| moved.to().and(moved.truth)));
    mark(Role::Predicted, AS_FEATURE, known(&|moved| moved.to().and(moved.twin_to())));
    mark(Role::Result, "displacement to frame t+1", known(&Moved::to));
    for (to, twin) in done.iter().filter_map(|moved| Some((moved.to()?, moved.twin_to()?))) {
        scene.mark(Picture::NEXT, Role::Error, Shape::Path { points: vec![to, twin], closed: false });
        scene.legend(Role::Error, "drift");
    }
}

impl Moved {
    /// Returns the squared forward–backward error and its tolerance, in px²; `None` where flow is unknown.
    fn check(&self, by: &PointTrajectories) -> Option<[f32; 2]> {
        Some(returned(self.there?, self.back?, (by.relative_tolerance, by.absolute_tolerance)))
    }
}

impl Note {
    fn facts(&self) -> Vec<Fact> {
        let known = |label, value: f32, role| value.is_finite().then(|| Fact::new(label, px(value), Some(role)));
        let [flow, feature] = self.errors;
        [
            Some(Fact::new("Points", self.points.to_string(), None)),
            known("Mean drift", self.apart, Role::Error),
            known("Mean error of flow tracks", flow, Role::Result),
            known("Mean error of feature tracks", feature, Role::Predicted),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// Patches around the point in frame t, and in frame t + 1 at its positions by flow and by feature tracking.
fn tiles(pair: &Pair, moved: &Moved) -> Vec<Tile> {
    let side = (2 * TILE_REACH_PX + 1) as usize;
    let around = |frame: usize, [x, y]: [f32; 2]| {
        let level = &pair.pyramids[frame][0];
        let off = |c: usize| c as f32 - TILE_REACH_PX as f32;
        // Rounded to a tenth of a gray level for display.
        let value = |i, j| (level.sample([x + off(i), y + off(j)]) * 10.0).round() / 10.0;
        Grid::from_fn(side, side, value)
    };
    let tile = |label, role, values| Tile { label, role: Some(role), values, range: [0.0, 255.0], framed: Vec::new() };
    let mut all = vec![tile("Frame t", Role::Reference, around(0, moved.live.at))];
    all.extend(moved.to().map(|to| tile("t+1, flow", Role::Result, around(1, to))));
    all.extend(moved.twin_to().map(|to| tile("t+1, feature", Role::Predicted, around(1, to))));
    all
}

/// The plots of the number of points, of the drift and of the errors over pairs.
fn plots(state: &State) -> Vec<Readout> {
    let notes = &state.notes;
    let line = |of: &dyn Fn(&Note) -> f32| -> Vec<[f32; 2]> {
        let all = notes.iter().enumerate().map(|(i, note)| [(i + 1) as f32, of(note)]);
        all.filter(|[_, value]| value.is_finite()).collect()
    };
    let series = |title, lines: Vec<(&'static str, Role, Vec<[f32; 2]>)>| {
        let series = Series {
            title,
            x_label: "pair",
            y_label: "px",
            x_max: state.span.frames().map_or(notes.len(), |frames| frames - 1),
            lines,
            ..Series::default()
        };
        let has_line = series.lines.iter().any(|(_, _, line)| line.len() > 1);
        has_line.then_some(Readout::Series(series))
    };
    let counts: Vec<u32> = notes.iter().map(|note| note.points).collect();
    let drift = series("Mean drift", vec![("flow to feature track", Role::Error, line(&|note| note.apart))]);
    let errors = series(
        "Mean distance from the true position",
        vec![
            ("flow track", Role::Result, line(&|note| note.errors[0])),
            ("feature track", Role::Predicted, line(&|note| note.errors[1])),
        ],
    );
    let points = trails::turnover("Points", &counts, &state.tracks, &state.span);
    drift.into_iter().chain(errors).chain(points).collect()
}
