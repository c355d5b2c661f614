//! How point trajectories are told and drawn.

use super::{Event, Moved, Note, Pair, PointTrajectories, State, What, distance, end, line};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::{differential::field, features::trails};
use crate::products::{Status, consistency::returned};
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

/// How far tiles reach around a point, in px.
const TILE_REACH_PX: isize = 4;

/// What the trail and the place are that a point has as a feature.
const AS_FEATURE: &str = "as a feature";

fn px(length: f32) -> String {
    format!("{} px", words::number(length))
}

fn last(events: &[Event]) -> Option<&What> {
    events.last().map(|event| &event.0)
}

/// The points that had their turn.
fn moved(events: &[Event]) -> impl Iterator<Item = (&Pair, &Moved)> {
    events
        .iter()
        .filter_map(|event| if let What::Moved(pair, moved) = &event.0 { Some((&**pair, moved)) } else { None })
}

impl PointTrajectories {
    /// Of the points that had their turn, the one that the person points at, or else the last one if it has it now.
    fn looked<'a>(&self, seen: &Seen<'a, Self>) -> Option<(&'a Pair, &'a Moved)> {
        let far = |moved: &Moved| seen.point().map_or(f32::INFINITY, |point| distance(moved.live.at, point));
        let nearest = moved(seen.events).min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
        nearest.filter(|(_, moved)| far(moved) <= self.spacing as f32).or(match last(seen.events)? {
            What::Moved(pair, moved) => Some((&**pair, moved)),
            _ => None,
        })
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = match (last(seen.events), self.looked(seen)) {
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
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (said, state) = (Sentence::default(), seen.before);
        let (here, next) = (state.frame, state.frame + 1);
        if let Some((_, moved)) = self.looked(seen) {
            return self.point(moved);
        }
        match last(seen.events) {
            None | Some(What::Moved(..)) => said
                .text("Points of a grid are ")
                .ink(Role::Result, "carried along")
                .text(" by dense optical flow from frame to frame. The same points are ")
                .ink(Role::Predicted, "followed as features")
                .text(": how far both drift apart tells how far either is to be trusted."),
            Some(What::Flow(_)) => said.text(format!(
                "{} finds where each pixel of frame {here} goes in frame {next}, and where each pixel of that comes from.",
                self.method.estimator().info().name
            )),
            Some(What::Begun(0)) => said.text(format!("No new point begins: {} go on.", state.live.len())),
            Some(What::Begun(count)) => said.ink(Role::Measured, format!("{count} points")).text(format!(
                " begin, {} px apart, where the smaller eigenvalue is at least {}; {} go on.",
                self.spacing,
                words::number(self.structure),
                state.live.len()
            )),
            Some(What::Done(note)) => {
                let left = seen.after.map_or(0, |after| after.live.len());
                let said = said
                    .text(format!("Of {} points ", note.points))
                    .ink(Role::Result, format!("{left} go on"))
                    .text(" in ")
                    .text(format!("frame {next}"));
                if note.apart.is_finite() {
                    return said
                        .text(". As features they are ")
                        .ink(Role::Error, px(note.apart))
                        .text(" away by now, on average.");
                }
                said.text(". None of them is tracked as a feature, so there is no drift to tell.")
            }
        }
    }

    /// What becomes of a point.
    fn point(&self, moved: &Moved) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, format!("Point {}", moved.live.track + 1));
        let Some(to) = moved.to() else {
            let why = match (moved.feature.status, moved.check(self)) {
                (Status::Flat, _) => format!(
                    ": the smaller eigenvalue around it is {}, less than {}.",
                    words::number(moved.structure),
                    words::number(self.structure)
                ),
                (Status::Outside, _) => ": the flow carries it out of the picture.".into(),
                (_, Some([off, limit])) => format!(
                    ": along the flow and back leads {} off, more than {}. Either it is hidden, or the flow is wrong.",
                    px(off.sqrt()),
                    px(limit.sqrt())
                ),
                _ => ": the flow is unknown there.".into(),
            };
            return said.text(" is ").ink(Role::Rejected, "lost").text(why);
        };
        let said = said.text(" is carried to ").ink(Role::Result, words::place(to));
        let said = match (moved.twin_to(), moved.apart()) {
            (Some(twin), Some(apart)) => said
                .text(". As a feature it comes to ")
                .ink(Role::Predicted, words::place(twin))
                .text(": since it began, both have drifted ")
                .ink(Role::Error, px(apart))
                .text(" apart."),
            _ => said.text(". As a feature it is ").ink(Role::Rejected, "lost").text("."),
        };
        match moved.truth {
            Some(truth) => said
                .text(" It truly is at ")
                .ink(Role::Truth, words::place(truth))
                .text(format!(", {} from where the flow has carried it.", px(distance(to, truth)))),
            None => said,
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let Some(event) = last(seen.events) else { return Vec::new() };
        let mut facts =
            vec![Fact::new("Pair", format!("frames {} and {}", seen.before.frame, seen.before.frame + 1), None)];
        let looked = self.looked(seen);
        match (event, looked) {
            (_, Some((_, moved))) => facts.extend(self.facts(moved)),
            (What::Done(note), None) => facts.extend(note.facts()),
            (What::Begun(count), None) => facts.push(Fact::new("New", count.to_string(), Some(Role::Measured))),
            _ => facts.push(Fact::new("Points", seen.before.live.len().to_string(), None)),
        }
        let mut readouts = vec![Readout::Facts(facts)];
        if let Some((pair, moved)) = looked {
            readouts.extend(self.equation(moved).map(Readout::Equation));
            readouts.push(Readout::Tiles(tiles(pair, moved)));
        }
        readouts.extend(plots(seen.after.unwrap_or(seen.before)));
        readouts
    }

    fn facts(&self, moved: &Moved) -> Vec<Fact> {
        let at = words::place(moved.live.at);
        let mut facts = vec![
            Fact::new("Point", format!("{} at {at}", moved.live.track + 1), Some(Role::Reference)),
            Fact::new("Smaller eigenvalue", format!("{} (gray levels per px)²", words::number(moved.structure)), None),
        ];
        facts.extend(moved.there.map(|uv| Fact::new("Flow", format!("{} px", words::vector(uv)), Some(Role::Result))));
        facts.extend(moved.back.map(|uv| Fact::new("Flow back", format!("{} px", words::vector(uv)), None)));
        if let Some([off, limit]) = moved.check(self) {
            facts.push(Fact::new(
                "There and back",
                format!("{} px² off, at most {}", words::number(off), words::number(limit)),
                None,
            ));
        }
        if let Some(twin) = moved.twin {
            let value = end(&twin).map_or(twin.status.name().into(), |to| format!("at {}", words::place(to)));
            facts.push(Fact::new("As a feature", value, Some(Role::Predicted)));
        }
        facts.extend(moved.apart().map(|apart| Fact::new("Drifted apart", px(apart), Some(Role::Error))));
        if let Some(truth) = moved.truth {
            facts.push(Fact::new("Truth", format!("at {}", words::place(truth)), Some(Role::Truth)));
            facts.extend(moved.to().map(|to| Fact::new("Flow off by", px(distance(to, truth)), None)));
            facts.extend(moved.twin_to().map(|to| Fact::new("Feature off by", px(distance(to, truth)), None)));
        }
        facts
    }

    /// Where the point goes, and whether the way back leads there.
    fn equation(&self, moved: &Moved) -> Option<Vec<Math>> {
        let (there, at) = (moved.there?, moved.live.at);
        let to = [0, 1].map(|i| at[i] + there[i]);
        let step = Math::Row(vec![
            Math::Var("x"),
            Math::text(" + "),
            Math::Var("w"),
            Math::text(" = "),
            Math::ink(Role::Reference, words::place(at)),
            Math::text(" + "),
            Math::ink(Role::Result, words::vector(there)),
            Math::text(format!(" = {}", words::place(to))),
        ]);
        let Some([off, limit]) = moved.check(self) else { return Some(vec![step]) };
        let is_near = off <= limit;
        let role = if is_near { Role::Best } else { Role::Rejected };
        let sum = Math::Row(vec![Math::Var("w"), Math::text(" + "), Math::Var("w′")]);
        let check = Math::Row(vec![
            Math::power(Math::Abs(Box::new(sum)), Math::text("2")),
            Math::text(" = "),
            Math::ink(role, words::number(off)),
            Math::text(format!("{}{} px²", if is_near { " ≤ " } else { " > " }, words::number(limit))),
        ]);
        Some(vec![step, check])
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        if let Some(What::Flow(pair)) = last(seen.events) {
            field::draw(pair.flows[0].0.clone(), scene);
        }
        let state = seen.after.unwrap_or(seen.before);
        let frame = seen.before.frame;
        let done: Vec<&Moved> = moved(seen.events).map(|(_, moved)| moved).collect();
        let is_over = seen.after.is_some();
        // They have their turns in their order.
        let waits = if is_over { &[][..] } else { seen.before.live.get(done.len()..).unwrap_or_default() };
        trails::points(scene, Role::Measured, "point", waits.iter().map(|live| live.at).collect());
        for live in done.iter().map(|moved| &moved.live).chain(waits) {
            // What begins in this frame has no trail yet.
            let tracks = [&state.tracks, &state.twins].map(|all| all.get(live.track as usize));
            if let [Some(track), Some(twin)] = tracks {
                trails::trail(scene, (Role::Predicted, AS_FEATURE), twin, frame);
                trails::trail(scene, (Role::Estimate, "trail by dense flow"), track, frame);
            }
        }
        let lost = done.iter().filter(|moved| moved.to().is_none());
        trails::points(scene, Role::Rejected, "lost", lost.map(|moved| moved.live.at).collect());
        let arrow = |moved: &&Moved| Some(Arrow { from: moved.live.at, to: moved.to()? });
        trails::displacements(scene, done.iter().filter_map(arrow).collect());
        draw_ends(scene, &done);
        if let Some((_, moved)) = self.looked(seen) {
            trails::points(scene, Role::Reference, "point that is told of", vec![moved.live.at]);
        }
        scene.legend(Role::Result, "displacements found");
    }
}

/// Where points are in frame t + 1: by the flow, as features and truly, and what lies between the first two.
fn draw_ends(scene: &mut Scene, done: &[&Moved]) {
    let mut mark = |role, meaning, places: Vec<[f32; 2]>| {
        if !places.is_empty() {
            scene.mark(Picture::NEXT, role, Shape::Points(places));
            scene.legend(role, meaning);
        }
    };
    let known = |of: &dyn Fn(&Moved) -> Option<[f32; 2]>| done.iter().filter_map(|moved| of(moved)).collect();
    mark(Role::Truth, "true place", known(&|moved| moved.to().and(moved.truth)));
    mark(Role::Predicted, AS_FEATURE, known(&|moved| moved.to().and(moved.twin_to())));
    mark(Role::Result, "displacements found", known(&Moved::to));
    for (to, twin) in done.iter().filter_map(|moved| Some((moved.to()?, moved.twin_to()?))) {
        scene.mark(Picture::NEXT, Role::Error, Shape::Path { points: vec![to, twin], closed: false });
        scene.legend(Role::Error, "drifted apart");
    }
}

impl Moved {
    /// How far going there and back leads off, squared, and the limit of that, in px²; `None` where it is not known.
    fn check(&self, by: &PointTrajectories) -> Option<[f32; 2]> {
        Some(returned(self.there?, self.back?, (by.share, by.tolerance)))
    }
}

impl Note {
    fn facts(&self) -> Vec<Fact> {
        let known = |label, value: f32, role| value.is_finite().then(|| Fact::new(label, px(value), Some(role)));
        let [flow, feature] = self.errors;
        [
            Some(Fact::new("Points", self.points.to_string(), None)),
            known("Drifted apart, mean", self.apart, Role::Error),
            known("Flow off by, mean", flow, Role::Result),
            known("Features off by, mean", feature, Role::Predicted),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// What lies around the point in frame t, and in frame t + 1 where the flow and where the feature lead.
fn tiles(pair: &Pair, moved: &Moved) -> Vec<Tile> {
    let side = (2 * TILE_REACH_PX + 1) as usize;
    let around = |frame: usize, [x, y]: [f32; 2]| {
        let level = &pair.pyramids[frame][0];
        let off = |c: usize| c as f32 - TILE_REACH_PX as f32;
        // A tenth of a gray level is as much as anybody reads.
        let value = |i, j| (level.sample([x + off(i), y + off(j)]) * 10.0).round() / 10.0;
        Grid::from_fn(side, side, value)
    };
    let tile = |label, role, values| Tile { label, role: Some(role), values, range: [0.0, 255.0] };
    let mut all = vec![tile("Frame t", Role::Reference, around(0, moved.live.at))];
    all.extend(moved.to().map(|to| tile("Frame t+1, by flow", Role::Result, around(1, to))));
    all.extend(moved.twin_to().map(|to| tile("Frame t+1, as a feature", Role::Predicted, around(1, to))));
    all
}

/// How many points there are, and how far they have drifted, from pair to pair.
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
    let drift = series("Drifted apart, mean", vec![("flow and feature", Role::Error, line(&|note| note.apart))]);
    let errors = series(
        "Mean distance from the truth",
        vec![
            ("flow", Role::Result, line(&|note| note.errors[0])),
            ("feature", Role::Predicted, line(&|note| note.errors[1])),
        ],
    );
    let points = trails::turnover("Points", &counts, &state.tracks, &state.span);
    drift.into_iter().chain(errors).chain(points).collect()
}
