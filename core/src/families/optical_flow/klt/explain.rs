//! The explanation and the drawing of the KLT tracker.

use super::vocabulary::{case, value};
use super::{Event, Klt, Live, Pair, Returned, line};
use crate::geometry::Grid;
use crate::methods::features::{
    affine::{Fit, place},
    be, conclude, follow,
    level_trace::{LevelTrace, case as tracking_case, value as tracking, why},
    put_lost,
    trails::{self, points},
    value as features,
};
use crate::products::{Feature, Status};
use crate::run::Seen;
use crate::scene::{Arrow, Picture, Readout, Role, Scene, Shape, Step, Tile};

/// The current feature.
fn live<'a>(seen: &Seen<'a, Klt>) -> Option<&'a Live> {
    seen.before.live.get(seen.before.turn?)
}

/// The last event that `of` accepts.
fn last<T>(events: &[Event], of: impl Fn(&Event) -> Option<T>) -> Option<T> {
    events.iter().rev().find_map(of)
}

/// The result of tracking back, if it succeeded.
fn back(events: &[Event]) -> Option<Returned> {
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
        let frame = seen.before.frame;
        let Some(event) = seen.events.last() else {
            let step = Step::at(line::EACH_FRAME).put(value::FRAME, frame).put(value::FRAMES, self.frames);
            return step.say(case::OPENING);
        };
        let step = match event {
            Event::Enough => {
                let said = if self.replenish { case::ENOUGH } else { case::REPLENISH_OFF };
                self.put_counts(seen, Step::at(line::DETECT)).say(said)
            }
            Event::Found(found) => {
                let detector = self.detector.estimator().info().name;
                let step = self.put_counts(seen, Step::at(line::DETECT)).put(value::DETECTOR, detector);
                let step = step.fact(value::KEYPOINTS, found.keypoints.points.len()).say(case::FOUND);
                match found.keypoints.keypoints.first() {
                    Some(first) => step.put(features::FIRST_RESPONSE, first.response).say(case::STRONGEST),
                    None => step.say(case::END),
                }
            }
            Event::Taken(found) => {
                let step = self.put_counts(seen, Step::at(line::TAKE_STRONGEST));
                let step = step.fact(value::KEYPOINTS, found.keypoints.points.len());
                step.fact(value::NEW, found.taken.len()).put(features::MIN_DISTANCE, self.min_distance).say(case::TAKEN)
            }
            _ => self.tell_tracking(seen, event),
        };
        step.show_all(trails::turnover("Features", &seen.before.counts, &seen.before.tracks, &seen.before.span))
    }

    fn put_counts(&self, seen: &Seen<Self>, step: Step) -> Step {
        let (state, count) = (seen.before, seen.before.live.len());
        let step = step.put(value::FRAME, state.frame).put(features::MAX_POINTS, self.max_points);
        let last = state.tracks.iter().filter_map(|track| Some(track.points.last()?.status));
        put_lost(step.put(features::BE, be(count)).fact(value::TRACKED_FEATURES, count), last)
    }

    fn tell_tracking(&self, seen: &Seen<Self>, event: &Event) -> Step {
        let (Some(live), Some(level_trace)) = (live(seen), self.level_trace(seen)) else {
            return Step::at(line::EACH_FEATURE);
        };
        let at = |line| self.put(seen, Step::at(line), (live, &level_trace));
        let step = match event {
            Event::Back(Ok(Returned { is_above, .. })) => {
                let step = at(line::TRACK_BACK).put(tracking::MAX_FB_ERROR, self.max_fb_error).say(case::RETURNED);
                step.say(if *is_above { case::ABOVE } else { case::NOT_ABOVE })
            }
            Event::Back(Err(_)) => at(line::TRACK_BACK).say(case::FEATURE).say(case::NOT_RETURNED),
            Event::Fit(_) => {
                let step = at(line::FIT_FIRST_VIEW).put(value::MAX_DISSIMILARITY, self.max_dissimilarity);
                step.say(case::FITTED).say_if(self.illumination, case::WITH_LIGHT).say(case::DISSIMILARITY)
            }
            Event::Correlated(None) => at(line::CORRELATE).say(case::UNEXPLAINED).say(case::NO_CONTRAST),
            Event::Correlated(Some((correlation, resembles))) => {
                let step = at(line::CORRELATE).put(value::CORRELATION, *correlation);
                let step = step.put(value::MIN_CORRELATION, self.min_correlation).say(case::UNEXPLAINED);
                step.say(if *resembles { case::RESEMBLES } else { case::DIFFERS })
            }
            Event::Verdict(Feature { status: Status::Tracked, .. }) => {
                self.conclude(seen, at(line::MOVE).say(case::FEATURE).say(case::PASSED))
            }
            Event::Verdict(Feature { status, .. }) => {
                let step = at(match status {
                    Status::Astray => line::TRACK_BACK,
                    Status::Changed => line::IS_CHANGED,
                    _ => line::TRACK,
                });
                let is_first = step.real(value::TRACK_LENGTH) == 1.0;
                let step = step.say(case::FEATURE).say(tracking_case::LOST);
                let step = step.say(if is_first { case::IN_FIRST_PAIR } else { case::AFTER });
                self.conclude(seen, step.say(why(*status)))
            }
            _ => level_trace.tell(at(line::TRACK), case::FEATURE),
        };
        match (event, fit(seen.events)) {
            (Event::Fit(_) | Event::Correlated(_) | Event::Verdict(_), Some(fit)) => {
                self.equations(step).show(Readout::Tiles(views(&level_trace, live, &fit)))
            }
            _ => level_trace.show_charts(step, true_displacement(seen, live)),
        }
    }

    /// Puts the values of the current feature so far.
    fn put(&self, seen: &Seen<Self>, step: Step, (live, level_trace): (&Live, &LevelTrace)) -> Step {
        let track = &seen.before.tracks[live.track as usize];
        let is_tracked = matches!(seen.events.last(), Some(Event::Verdict(feature)) if feature.displacement.is_some());
        let length = track.points.len() + usize::from(is_tracked);
        let step = step.put(tracking::POSITION, live.at).put(value::TRACK_LENGTH, length);
        let step = step.fact_as(value::FEATURE.is(live.track + 1), case::FEATURE_AT);
        let mut step = level_trace.put(step.fact_as(value::FIRST_FRAME.is(track.first), case::FRAME));
        if let Some(Returned { at, off_px, .. }) = back(seen.events) {
            step = step.put(value::RETURNED, at).fact(tracking::FB_ERROR, off_px);
        }
        if let Some(Fit { matrix, shift, light: [gain, offset], difference, .. }) = fit(seen.events) {
            step = step.put(value::MATRIX, Grid::from_fn(2, 2, |x, y| f64::from(matrix[y][x])));
            step = step.put(value::SHIFT, shift).put(value::SHIFT_LENGTH, shift[0].hypot(shift[1]));
            step = step.fact(value::DISSIMILARITY, difference).put(value::OFFSET, offset);
            step = if self.illumination { step.fact_as(value::GAIN.is(gain), case::LIGHT) } else { step };
        }
        step.fact_if(tracking::TRUE_DISPLACEMENT, true_displacement(seen, live))
    }

    /// Writes the objective of the affine fit and its result.
    fn equations(&self, step: Step) -> Step {
        if !self.illumination {
            let step = step.formula(r"\sum (J(\mathbf{A}\,o + s) - I(o))^2 \to \min");
            return step.formula(r"\mathbf{A} = {matrix}, s = {shift}");
        }
        let step = step.formula(r"\sum (J(\mathbf{A}\,o + s) - \lambda I(o) - \delta)^2 \to \min");
        step.formula(r"\mathbf{A} = {matrix}, s = {shift}").formula(r"\lambda = {gain}, \delta = {offset}")
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let frame = seen.before.frame;
        let (Some(after), Some((pair, _))) = (seen.after, last_forward(seen.events)) else { return step };
        if after.frame == frame {
            return step;
        }
        let features = after.tracks.iter().filter_map(|track| track.at(frame)).copied();
        let step = step.put(value::FRAME, frame).put(value::NEXT_FRAME, after.frame).say(case::END_OF_PAIR);
        conclude(step, "feature", features, pair.truth.as_deref())
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
        })
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
        if let Some(Returned { at, .. }) = back(seen.events) {
            points(scene, Role::Predicted, "position after tracking back", vec![at]);
        }
    }
}

fn last_forward(events: &[Event]) -> Option<(&Pair, &usize)> {
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
    scene.draw(Picture::CURRENT, (Role::Reference, "window"), window);
    let to = [0, 1].map(|i| level_trace.at[i] + level_trace.on_picture()[i]);
    let outline = corners.map(|corner| place(to, fit, corner)).to_vec();
    let role = if is_refused { Role::Rejected } else { Role::Best };
    scene.draw(Picture::NEXT, (role, "first view, mapped by the affine fit"), Shape::outline(outline));
}

/// The first view, the mapped window, and their difference.
fn views(level_trace: &LevelTrace, live: &Live, fit: &Fit) -> Vec<Tile> {
    let side = live.view.side();
    let round = |v: &f32| (v * 10.0).round() / 10.0;
    let grid = |values: &[f32]| Grid::from_fn(side, side, |x, y| round(&values[y * side + x]));
    let to = [0, 1].map(|i| level_trace.at[i] + level_trace.on_picture()[i]);
    let (first, now) = (grid(live.view.values()), grid(&live.view.warped(&level_trace.pyramids[1][0], to, fit)));
    let difference = Grid::from_fn(side, side, |x, y| first[(x, y)] - now[(x, y)]);
    vec![
        Tile::gray("First view", first).with_role(Role::Reference),
        Tile::gray("Mapped window", now).with_role(Role::Best),
        Tile::signed("Difference", difference),
    ]
}
