//! The explanation and the drawing of point trajectories.

use std::sync::Arc;

use super::{Event, Moved, Note, Pair, PointTrajectories, State, What, distance, line};
use crate::geometry::Grid;
use crate::methods::{
    differential::{explain::value as shared, field},
    features::{conclude, level_trace::value as tracking, reason_of, trails},
};
use crate::products::{Status, consistency::returned};
use crate::run::Seen;
use crate::scene::{Arrow, Name, Picture, Readout, Role, Scene, Series, Shape, Step, Tile, Unit};
use crate::{cases, variables};

/// The unit of eigenvalues of a structure tensor.
const SQUARED_GRADIENT: Unit = Unit::new("(gray levels per px)²", 2);
const SQUARED_PX: Unit = Unit::new("px²", 3);

variables! {
    /// The first frame of the pair.
    FRAME: "Pair", "t", Unit::WHOLE;
    /// The second frame of the pair.
    NEXT_FRAME: "", "t+1", Unit::WHOLE;
    /// The method of the dense flow.
    METHOD: "", "", Unit::WHOLE;
    /// The number of points at the start of the pair.
    POINTS: "Points", "", Unit::count("point");
    /// The number of points that start in this frame.
    BEGUN: "New points", "", Unit::count("new point"), Role::Measured;
    /// The number of points that are not lost in the pair.
    CONTINUING: "", "", Unit::count(""), Role::Result;
    /// The spacing of the grid points.
    SPACING: "", "", Unit::new("px", 0);
    /// The mean drift between flow and feature tracks.
    MEAN_DRIFT: "Mean drift", "", Unit::SUBPIXEL, Role::Error;
    /// The mean distance of the flow tracks from the true positions.
    MEAN_FLOW_ERROR: "Mean error of flow tracks", "", Unit::SUBPIXEL, Role::Result;
    /// The mean distance of the feature tracks from the true positions.
    MEAN_FEATURE_ERROR: "Mean error of feature tracks", "", Unit::SUBPIXEL, Role::Predicted;
    /// The number of the point, from 1.
    POINT: "Point", "", Unit::WHOLE, Role::Reference;
    /// The forward flow at the point.
    FORWARD_FLOW: "Forward flow w", "w", Unit::SUBPIXEL, Role::Result;
    /// The backward flow where the forward flow leads.
    BACKWARD_FLOW: "Backward flow w′", "w'", Unit::SUBPIXEL;
    /// The position to which the flow leads.
    END: "", "x + w", Unit::SUBPIXEL, Role::Result;
    /// The squared forward–backward error |w + w′|².
    SQUARED_ERROR: "Squared forward–backward error", "|w + w'|^2", SQUARED_PX;
    /// The largest accepted squared forward–backward error.
    SQUARED_TOLERANCE: "", "", SQUARED_PX;
    /// The position of the feature track in the second frame.
    FEATURE_END: "Feature track", "y", Unit::SUBPIXEL, Role::Predicted;
    /// The reason for which the feature track is lost.
    FEATURE_LOSS: "Feature track lost", "", Unit::WHOLE, Role::Predicted;
    /// The drift: the distance between flow and feature track.
    DRIFT: "Drift", "|x - y|", Unit::SUBPIXEL, Role::Error;
    /// The true position in the second frame.
    TRUE_POSITION: "True position", "", Unit::SUBPIXEL, Role::Truth;
    /// The distance of the flow track from the true position.
    FLOW_ERROR: "Error of the flow track", "", Unit::SUBPIXEL;
    /// The distance of the feature track from the true position.
    FEATURE_ERROR: "Error of the feature track", "", Unit::SUBPIXEL;
}

cases! { over value, shared, tracking;
    OPENING: "Grid points are {result|advected by dense flow} from frame to frame, x ← x + w(x), so errors of the flow accumulate as \
              drift. The same points are {predicted|tracked as features}; their distance measures the drift without ground truth.",
    PAIR: "frames {frame} and {next_frame}",
    FLOW: "{method} estimates the flow w from frame {frame} to {next_frame} and the backward flow w′ for the forward–backward check.",
    OCCUPIED: "No new points: all grid cells with λ₂ ≥ {min_eigenvalue} are occupied. {points} continue.",
    REPLENISH_OFF: "No new points: replenish is off. {points} continue.",
    BEGUN: "{begun} in empty grid cells of {spacing} with λ₂ of at least {min_eigenvalue} (the minimum eigenvalue); {points} continue.",
    CONTINUING: "{continuing} of {points} continue in frame {next_frame}.",
    MEAN_DRIFT: "Mean drift between flow and feature tracks: {mean_drift}.",
    NO_DRIFT: "No feature track is left, so the drift is unknown.",
    END_OF_PAIR: "End of the pair:",
    POINT: "{reference|Point} {point}",
    POINT_AT: "{point} at {position:bare}",
    SQUARED_ERROR: "{squared_error}, tolerance {squared_tolerance}",
    FLAT: " is {rejected|lost}: λ₂ = {lambda_2:bare} is below the minimum eigenvalue of {min_eigenvalue}, so the window has no texture or \
           only an edge.",
    OUTSIDE: " is {rejected|lost}: the flow leads out of the frame.",
    ASTRAY: " is {rejected|lost}: forward–backward error {fb_error} exceeds the tolerance of {max_fb_error}, a sign of occlusion or \
             wrong flow.",
    UNKNOWN: " is {rejected|lost}: the flow is unknown at this position.",
    ADVECTED: " is advected to {end:bare}",
    DRIFT: ", its feature track to {feature_end:bare}. Drift between both since the start: {drift}.",
    FEATURE_LOST: "; its feature track is {rejected|lost}.",
    TRUTH: "True position: {true_position:bare}, so the flow trajectory has an error of {flow_error}.",
}

/// Radius of the image patches, in px.
const TILE_REACH_PX: isize = 4;

/// The legend of trail and position by feature tracking.
const AS_FEATURE: &str = "feature track";

fn last(events: &[Event]) -> Option<&What> {
    events.last().map(|event| &event.0)
}

/// The results of the points so far.
fn moved(events: &[Event]) -> impl Iterator<Item = (&Arc<Pair>, &Moved)> {
    events.iter().filter_map(|event| if let What::Moved(pair, moved) = &event.0 { Some((pair, moved)) } else { None })
}

impl PointTrajectories {
    fn pointed_at<'a>(&self, seen: &Seen<'a, Self>) -> Option<(&'a Arc<Pair>, &'a Moved)> {
        let point = seen.point()?;
        let far = |moved: &Moved| distance(moved.live.at, point);
        let nearest = moved(seen.events).min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
        nearest.filter(|(_, moved)| far(moved) <= self.spacing as f32)
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let Some(event) = last(seen.events) else { return Step::at(line::EACH_FRAME).say(case::OPENING) };
        let at = |line| {
            let step = Step::at(line).put(value::NEXT_FRAME, state.frame + 1);
            let step = step.put(shared::MIN_EIGENVALUE, self.min_eigenvalue);
            step.fact_as(value::FRAME.is(state.frame), case::PAIR)
        };
        let step = match (event, self.pointed_at(seen)) {
            (_, Some((pair, moved))) | (What::Moved(pair, moved), None) => {
                self.tell_point(at, moved).show(Readout::Tiles(tiles(pair, moved)))
            }
            (What::Flow(_), None) => {
                let step = at(line::FIND_FLOW).fact(value::POINTS, state.live.len());
                step.put(value::METHOD, self.method.estimator().info().name).say(case::FLOW)
            }
            (What::Begun(count), None) => {
                let step = at(line::BEGIN_POINTS).fact(value::BEGUN, *count).put(value::POINTS, state.live.len());
                step.put(value::SPACING, self.spacing).say(match count {
                    0 if self.replenish || state.frame == state.span.first => case::OCCUPIED,
                    0 => case::REPLENISH_OFF,
                    _ => case::BEGUN,
                })
            }
            (What::Done(note), None) => self.conclude(seen, at(line::COMPARE_FEATURES), note),
        };
        step.show_all(plots(seen.after.unwrap_or(state)))
    }

    fn tell_point(&self, at: impl Fn(Name) -> Step, moved: &Moved) -> Step {
        let of_point = |line| self.put(at(line), moved).say(case::POINT);
        match moved.feature.status {
            Status::Flat => of_point(line::IS_FLAT).say(case::FLAT),
            Status::Outside => of_point(line::IS_OUTSIDE).say(case::OUTSIDE),
            Status::Astray if moved.check(self).is_some() => of_point(line::IS_ASTRAY).say(case::ASTRAY),
            Status::Astray => of_point(line::IS_ASTRAY).say(case::UNKNOWN),
            _ => {
                let step = of_point(line::CARRY).say(case::ADVECTED);
                let step = step.say(if moved.apart().is_some() { case::DRIFT } else { case::FEATURE_LOST });
                step.say_if(moved.truth.is_some(), case::TRUTH)
            }
        }
    }

    fn put(&self, step: Step, moved: &Moved) -> Step {
        let at = moved.live.at;
        let step = step.put(tracking::POSITION, at).fact_as(value::POINT.is(moved.live.track + 1), case::POINT_AT);
        let mut step = step.fact_of(shared::LAMBDA_2.is(moved.structure).in_unit(SQUARED_GRADIENT));
        if let Some(flow) = moved.there {
            step = step.fact(value::FORWARD_FLOW, flow).put(value::END, [0, 1].map(|i| at[i] + flow[i]));
            step = step.formula("x + w = {position} + {forward_flow} = {end}");
        }
        step = step.fact_if(value::BACKWARD_FLOW, moved.back);
        if let Some([error, tolerance]) = moved.check(self) {
            let is_near = error <= tolerance;
            let squared = value::SQUARED_ERROR.is(error).inked(if is_near { Role::Best } else { Role::Rejected });
            step = step.put(tracking::FB_ERROR, error.sqrt()).put(tracking::MAX_FB_ERROR, tolerance.sqrt());
            step = step.put(value::SQUARED_TOLERANCE, tolerance).fact_as(squared, case::SQUARED_ERROR);
            step = step.formula(match is_near {
                true => r"|w + w'|^2 = {squared_error} \le {squared_tolerance:unit}",
                false => r"|w + w'|^2 = {squared_error} > {squared_tolerance:unit}",
            });
        }
        let reason = moved.twin.and_then(|twin| reason_of(twin.status));
        step = step.fact_if(value::FEATURE_END, moved.twin_to()).fact_if(value::FEATURE_LOSS, reason);
        step = step.fact_if(value::DRIFT, moved.apart()).fact_if(value::TRUE_POSITION, moved.truth);
        let error = |to: Option<[f32; 2]>| Some(distance(to?, moved.truth?));
        step.fact_if(value::FLOW_ERROR, error(moved.to())).fact_if(value::FEATURE_ERROR, error(moved.twin_to()))
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step, note: &Note) -> Step {
        let known = |number: f32| number.is_finite().then_some(number);
        let [flow_error, feature_error] = note.errors.map(known);
        let step = step.fact(value::POINTS, note.points).fact_if(value::MEAN_DRIFT, known(note.apart));
        let step = step.fact_if(value::MEAN_FLOW_ERROR, flow_error).fact_if(value::MEAN_FEATURE_ERROR, feature_error);
        let step = step.put(value::CONTINUING, seen.after.map_or(0, |after| after.live.len())).say(case::CONTINUING);
        let step = step.say(if known(note.apart).is_some() { case::MEAN_DRIFT } else { case::NO_DRIFT });
        let Some((pair, _)) = moved(seen.events).next() else { return step };
        let features = moved(seen.events).map(|(_, moved)| moved.feature);
        conclude(step.say(case::END_OF_PAIR), "point", features, pair.truth.as_deref())
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
        let at_work = match last(seen.events) {
            Some(What::Moved(_, moved)) => Some(moved),
            _ => None,
        };
        if let Some(moved) = self.pointed_at(seen).map(|(_, moved)| moved).or(at_work) {
            trails::points(scene, Role::Reference, "inspected point", vec![moved.live.at]);
        }
        scene.legend(Role::Result, "displacement to frame t+1");
    }
}

/// Draws the positions in frame t + 1 by flow, by feature tracking and in truth, and the drift between the first two.
fn draw_ends(scene: &mut Scene, done: &[&Moved]) {
    let mut mark = |role, meaning, places: Vec<[f32; 2]>| {
        if !places.is_empty() {
            scene.draw(Picture::NEXT, (role, meaning), Shape::Points(places));
        }
    };
    let known = |of: &dyn Fn(&Moved) -> Option<[f32; 2]>| done.iter().filter_map(|moved| of(moved)).collect();
    mark(Role::Truth, "true position", known(&|moved| moved.to().and(moved.truth)));
    mark(Role::Predicted, AS_FEATURE, known(&|moved| moved.to().and(moved.twin_to())));
    mark(Role::Result, "displacement to frame t+1", known(&Moved::to));
    for (to, twin) in done.iter().filter_map(|moved| Some((moved.to()?, moved.twin_to()?))) {
        scene.draw(Picture::NEXT, (Role::Error, "drift"), Shape::line(vec![to, twin]));
    }
}

impl Moved {
    /// Returns the squared forward–backward error and its tolerance, in px²; `None` where flow is unknown.
    fn check(&self, by: &PointTrajectories) -> Option<[f32; 2]> {
        Some(returned(self.there?, self.back?, (by.relative_tolerance, by.absolute_tolerance)))
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
    let tile = |label, role, values| Tile::gray(label, values).with_role(role);
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
        let series =
            Series::new(title, ["pair", "px"], state.span.frames().map_or(notes.len(), |frames| frames - 1), lines);
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
