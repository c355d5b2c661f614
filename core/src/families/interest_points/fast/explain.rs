//! The explanation and the drawing of FAST.

use super::{Event, Fast, Stage, State, case, corners, features, line, value};
use crate::geometry::Grid;
use crate::methods::differential::explain;
use crate::methods::features::{
    Selection, Status, be, case as selection,
    segment::{CIRCLE, COMPASS, Candidate, Circle, RADIUS, Shade, suppressed_by},
};
use crate::run::Seen;
use crate::scene::{Framed, Name, Picture, Readout, Role, Scene, Series, Shape, Step, Tile};

fn point((x, y): (usize, usize)) -> [f32; 2] {
    [x as f32, y as f32]
}

/// The number of a pixel on the circle, as in the paper: 1 at the top.
fn number(index: usize) -> usize {
    index % 16 + 1
}

/// The inspected pixel.
struct Probe {
    place: (usize, usize),
    /// Whether it is the pixel pointed at rather than the current one.
    is_pointed_at: bool,
    /// Its circle; none near the border.
    circle: Option<Circle>,
}

impl Fast {
    /// Returns the pixel pointed at, or else the current one.
    fn probe(&self, seen: &Seen<Self>) -> Option<Probe> {
        let state = seen.before;
        let at_work = seen.events.last().and_then(|event| match event {
            Event::Row | Event::Corners => None,
            Event::Tested(Candidate { x, .. }) => Some((*x, state.row)),
            Event::Compared(place, _) => Some(*place),
            Event::Ranked => state.strongest(),
            Event::Peak(peak, _) => Some(state.place(*peak)),
        });
        let pointed = seen.point().and_then(|point| state.scores.cell_at(point)).filter(|_| !seen.events.is_empty());
        let place = pointed.or(at_work)?;
        let circle = Circle::of(state.picture.luma(), place, self.test());
        Some(Probe { place, is_pointed_at: Some(place) != at_work, circle })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last() else { return self.limits(Step::at(line::EACH_PIXEL)).say(case::OPENING) };
        let Some(probe) = self.probe(seen) else { return self.of_row(seen.before, *last) };
        if probe.is_pointed_at {
            return self.verdict(seen, &probe);
        }
        let at = |line, role| {
            let step = self.measured(seen, line, &probe);
            if let Some(role) = role { step.put_value(features::PIXEL.is(probe.place).inked(role)) } else { step }
        };
        let step = match (last, &probe.circle) {
            (Event::Tested(_), Some(circle)) => self.tested(self.measured(seen, self.line_of(circle), &probe), circle),
            (Event::Compared(_, None), _) => at(line::SUPPRESS, Some(Role::Best)).say(case::MAXIMUM),
            (Event::Compared(_, Some(by)), _) => {
                let step = at(line::SUPPRESS, Some(Role::Rejected)).put(features::NEIGHBOUR, *by);
                let is_higher = seen.before.scores[*by] > seen.before.scores[probe.place];
                let step = step.put(value::OTHER_SCORE, seen.before.scores[*by]).say(case::SUPPRESSED);
                step.say(if is_higher { case::BY_HIGHER } else { case::BY_EQUAL })
            }
            (Event::Peak(_, None), _) => {
                let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
                at(line::KEEP, Some(Role::Result)).put(features::KEPT, count).say(case::KEPT)
            }
            (Event::Peak(peak, Some(near)), _) => {
                let [score, other] = [peak, near].map(|index| seen.before.score(*index));
                let step =
                    at(line::DROP_NEAR, Some(Role::Rejected)).put(features::NEAR_CORNER, seen.before.place(*near));
                let step = step.put(value::OTHER_SCORE, other).say(case::NEAR);
                step.say(if other > score { case::TO_HIGHER } else { case::TO_EQUAL })
            }
            _ => {
                let count = seen.before.peaks.len();
                at(line::EACH_PEAK, None).put(value::CORNERS, count).put(features::BE, be(count)).say(case::RANKED)
            }
        };
        self.charted(seen, self.concluded(seen, step), &probe)
    }

    /// Puts the parameters.
    fn limits(&self, step: Step) -> Step {
        let Selection { min_distance, max_points } = self.selection;
        let step = step.put(value::THRESHOLD, self.threshold).put(value::ARC, self.arc);
        let step = step.put(value::COMPASS, self.test().compass_points());
        step.put(features::MAX_POINTS, max_points).put(features::MIN_DISTANCE, min_distance)
    }

    /// Explains an event of a row, or that there is nothing to select from.
    fn of_row(&self, state: &State, event: Event) -> Step {
        let row = |line| self.limits(Step::at(line)).fact_of(features::ROW.is(state.row).inked(Role::Window));
        match event {
            Event::Row => {
                let (all, passing) = self.passing(state, state.row);
                let step = row(line::HIGH_SPEED).fact(value::WITH_CIRCLE, all).fact(value::PASSING, passing);
                step.say(if all == 0 { case::NO_CIRCLE } else { case::HIGH_SPEED })
            }
            Event::Corners => {
                let count = corners(&state.scores, state.row).count();
                let said = if count == 0 { case::NO_CORNERS_IN_ROW } else { case::CORNERS_IN_ROW };
                row(line::EACH_CORNER).fact(value::CORNERS, count).say(said)
            }
            _ => {
                let has_corners = state.scores.cells().iter().any(|score| *score > 0);
                let step = self.limits(Step::at(line::EACH_PEAK)).fact(features::LOCAL_MAXIMA, state.peaks.len());
                let step = step.put(value::HIGHEST_SCORE, self.test().highest_score(state.picture.luma()));
                step.say(if has_corners { case::NO_MAXIMA } else { case::NO_CORNERS })
            }
        }
    }

    /// The number of pixels of a row with a circle, and of those that pass the high-speed test.
    fn passing(&self, state: &State, y: usize) -> (usize, usize) {
        let mut passing: Vec<Candidate> = Vec::new();
        let mut scores = vec![0; state.scores.width()];
        self.test().row(state.picture.luma(), y, &mut scores, &mut passing);
        let (width, height) = state.scores.size();
        let has_circles = (RADIUS..height.saturating_sub(RADIUS)).contains(&y);
        (if has_circles { width.saturating_sub(2 * RADIUS) } else { 0 }, passing.len())
    }

    /// Puts what is known of a pixel, and its score where it is a corner.
    fn measured(&self, seen: &Seen<Self>, line: Name, Probe { place, circle, .. }: &Probe) -> Step {
        let step = self.limits(Step::at(line)).fact(features::PIXEL, *place);
        let Some(circle) = circle else { return step };
        let (start, length) = circle.run.unwrap_or_default();
        let step = step.fact(value::LEVEL, circle.level).fact(value::BRIGHTER, circle.count(Shade::Brighter));
        let step = step.fact(value::DARKER, circle.count(Shade::Darker)).fact(value::RUN, length);
        let step = step.fact(value::ARC, self.arc).fact(value::SCORE, circle.score);
        let step = step.put(value::COMPASS_RUN, circle.compass).put(value::RUN_START, number(start));
        let step = step.put(value::RUN_END, number(start + length.max(1) - 1));
        let (level, threshold) = (i32::from(circle.level), self.threshold as i32);
        let is_darker = circle.shades[start] == Shade::Darker;
        let step = step.put(value::RUN_LIMIT, if is_darker { level - threshold } else { level + threshold });
        if circle.arc.is_none() {
            return step;
        }
        let (weakest, difference) = weakest(circle, self.arc);
        let step = step.put(value::WEAKEST, number(weakest)).put(value::DIFFERENCE, u32::from(difference));
        let step = step.put(value::WEAKEST_LEVEL, level + i32::from(circle.differences[weakest]));
        let step = self.status(seen, *place).into_iter().fold(step, |step, of| step.fact(features::STATUS, of.words));
        let step = step.formula(r"V = \text{max over arcs of }{arc}\text{ pixels of (min }|I_k - I_p|\text{)} - 1");
        step.formula("V = |{weakest_level} - {level}| - 1 = {score}")
    }

    /// The line that decides about a pixel by its circle.
    fn line_of(&self, circle: &Circle) -> Name {
        match circle.compass < self.test().compass_points() {
            true => line::HIGH_SPEED,
            false if circle.arc.is_none() => line::SEGMENT_TEST,
            false => line::SCORE,
        }
    }

    /// Explains the tests of a pixel.
    fn tested(&self, step: Step, circle: &Circle) -> Step {
        let role = if circle.arc.is_some() { Role::Best } else { Role::Rejected };
        let step = step.put_value(features::PIXEL.is(circle.center).inked(role));
        if self.line_of(circle) == line::HIGH_SPEED {
            return step.say(case::FAILS_COMPASS);
        }
        let (start, length) = circle.run.unwrap_or_default();
        let step = step.say(if circle.arc.is_some() { case::CONTIGUOUS } else { case::LONGEST });
        let step = step.say_if(length == 1, case::AT).say_if((2..16).contains(&length), case::FROM_TO);
        match (circle.arc.is_some(), circle.shades[start] == Shade::Darker) {
            (false, false) => step.say(case::BRIGHTER).say(case::TOO_SHORT),
            (false, true) => step.say(case::DARKER).say(case::TOO_SHORT),
            (true, false) => step.say(case::ARE_BRIGHTER).say(case::CORNER),
            (true, true) => step.say(case::ARE_DARKER).say(case::CORNER),
        }
    }

    /// Adds the conclusion at the end of a run.
    fn concluded(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after.filter(|_| seen.before.stage == Stage::Choice) else { return step };
        let (Some(first), Some(last)) = (after.kept.first(), after.kept.last()) else { return step };
        let found = after.scores.cells().iter().filter(|score| **score > 0).count();
        let step = step.put(features::KEPT, after.kept.len()).put(features::LOCAL_MAXIMA, after.peaks.len());
        let step = step.put(value::HIGHEST_SCORE, after.score(*first)).put(value::LOWEST_SCORE, after.score(*last));
        let step = step.put(value::FOUND, found);
        let step = step.say(if after.kept.len() == 1 { case::END_WITH_ONE } else { case::END });
        step.say(self.selection.advice(after.kept.len(), after.peaks.len()))
    }

    /// Explains the pixel pointed at, as far as it is known what became of it.
    fn verdict(&self, seen: &Seen<Self>, probe: &Probe) -> Step {
        let Some(circle) = &probe.circle else {
            let step = self.measured(seen, line::EACH_PIXEL, probe);
            let step = step.put_value(features::PIXEL.is(probe.place).inked(Role::Rejected)).say(case::OUTSIDE);
            return self.charted(seen, step, probe);
        };
        let status = self.status(seen, probe.place).filter(|_| circle.arc.is_some());
        let line = status.as_ref().map_or(self.line_of(circle), |status| status.line);
        let step = self.tested(self.measured(seen, line, probe), circle);
        let step = match &status {
            Some(status) => {
                let score = status.by.map_or(0, |by| seen.before.scores[by]);
                status.say(step.put(value::OTHER_SCORE, score))
            }
            None => step,
        };
        self.charted(seen, step, probe)
    }

    /// Returns what became of a corner after the segment test.
    fn status(&self, seen: &Seen<Self>, place: (usize, usize)) -> Option<Status> {
        let state = seen.before;
        let is_compared = match state.stage {
            Stage::Test => false,
            Stage::Suppression => place.1 < state.row,
            Stage::Choice => true,
        };
        if !is_compared {
            return None;
        }
        let status = |line, words, case, by| Some(Status { line, words, case, by });
        if let Some(by) = suppressed_by(&state.scores, place) {
            return status(line::SUPPRESS, "suppressed", case::HAS_NEIGHBOUR, Some(by));
        }
        let index = (place.1 * state.scores.width() + place.0) as u32;
        let choice = seen.events.iter().find_map(|event| match event {
            Event::Peak(peak, near) if *peak == index => Some(*near),
            _ => None,
        });
        match choice {
            Some(None) => status(line::KEEP, "kept", selection::HAS_STATUS, None),
            Some(Some(near)) => status(line::DROP_NEAR, "rejected", selection::HAS_NEAR, Some(state.place(near))),
            None if seen.after.is_some() && state.stage == Stage::Choice => {
                status(line::KEEP, "not kept", case::IS_BEYOND, None)
            }
            None => status(line::SUPPRESS, "local maximum of the score", selection::HAS_STATUS, None),
        }
    }

    /// Adds the charts of a pixel.
    fn charted(&self, seen: &Seen<Self>, step: Step, Probe { place, circle, .. }: &Probe) -> Step {
        let state = seen.before;
        let tile = |label, values: Grid<f32>, range| Tile { label, role: None, values, range, framed: Vec::new() };
        let mut picture = tile("Frame t", explain::around(state.picture.luma(), *place, RADIUS), [0.0, 255.0]);
        if let Some(circle) = circle.as_ref().filter(|_| shows_circle(seen)) {
            picture.framed = framed(circle, state.stage);
        }
        let mut tiles = vec![picture];
        if state.stage != Stage::Test {
            let scores = explain::around(&state.scores.map(|score| f32::from(*score)), *place, RADIUS);
            let most =
                scores.cells().iter().filter(|score| score.is_finite()).fold(1.0f32, |most, score| most.max(*score));
            tiles.push(tile("Score V", scores, [0.0, most]));
        }
        step.show_all(circle.as_ref().map(|circle| Readout::Series(self.series(circle)))).show(Readout::Tiles(tiles))
    }

    /// The differences on the circle against the threshold.
    fn series(&self, circle: &Circle) -> Series {
        let all: Vec<[f32; 2]> = circle
            .differences
            .iter()
            .enumerate()
            .map(|(k, difference)| [number(k) as f32, f32::from(*difference)])
            .collect();
        let on_arc = |k: usize| circle.arc.is_some_and(|start| (k + 16 - start) % 16 < self.arc);
        let arc = all.iter().enumerate().map(|(k, [x, y])| [*x, if on_arc(k) { *y } else { f32::NAN }]).collect();
        let mut lines = vec![("difference", Role::Candidate, all)];
        if circle.arc.is_some() {
            lines.push(("arc that decides", Role::Result, arc));
        }
        let t = self.threshold as f32;
        Series {
            title: "Differences on the circle",
            x_label: "pixel of the circle",
            y_label: "gray levels",
            x_max: 16,
            x_ticks: COMPASS.map(|k| number(k) as f32).to_vec(),
            lines,
            thresholds: vec![("+t".into(), t), ("−t".into(), -t)],
            is_sweep: true,
            ..Series::default()
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        draw_scores(seen, scene);
        let mut points = |role, meaning, places: Vec<(usize, usize)>| {
            if !places.is_empty() {
                scene.mark(Picture::CURRENT, role, Shape::Points(places.into_iter().map(point).collect()));
                scene.legend(role, meaning);
            }
        };
        let places = |peaks: &[u32]| peaks.iter().map(|peak| state.place(*peak)).collect::<Vec<_>>();
        match state.stage {
            Stage::Test => {
                let passing = seen.events.iter().filter_map(|event| match event {
                    Event::Tested(Candidate { x, score: 0 }) => Some((*x, state.row)),
                    _ => None,
                });
                points(Role::Candidate, "passes the high-speed test only", passing.collect());
                let found = seen.events.iter().filter_map(|event| match event {
                    Event::Tested(Candidate { x, score: 1.. }) => Some((*x, state.row)),
                    _ => None,
                });
                points(Role::Best, "corner", found.collect());
            }
            Stage::Suppression => {
                let of_row = |is_maximum: bool| {
                    let compared = seen.events.iter().filter_map(move |event| match event {
                        Event::Compared(place, by) if by.is_none() == is_maximum => Some(*place),
                        _ => None,
                    });
                    compared.collect::<Vec<_>>()
                };
                points(Role::Rejected, "suppressed (non-maximum)", of_row(false));
                points(Role::Best, "local maximum of the score", [places(&state.peaks), of_row(true)].concat());
            }
            Stage::Choice => {
                let tested = |is_kept: bool| {
                    let peaks = seen.events.iter().filter_map(move |event| match event {
                        Event::Peak(peak, near) if near.is_none() == is_kept => Some(*peak),
                        _ => None,
                    });
                    places(&peaks.collect::<Vec<_>>())
                };
                let (kept, dropped) = (tested(true), tested(false));
                let mut is_done = Grid::new(state.scores.width(), state.scores.height(), seen.after.is_some());
                kept.iter().chain(&dropped).for_each(|place| is_done[*place] = true);
                let waiting = places(&state.peaks).into_iter().filter(|place| !is_done[*place]).collect();
                points(Role::Candidate, "local maximum, not yet tested", waiting);
                points(Role::Rejected, "rejected by the minimum distance", dropped);
                points(Role::Result, "corner", kept);
            }
        }
        if state.stage != Stage::Choice {
            let row = Shape::pixels(0, state.row as i32, state.scores.width(), 1);
            scene.mark(Picture::CURRENT, Role::Window, row);
            scene.legend(Role::Window, "current row");
        }
        self.draw_pixel(seen, scene);
    }

    fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(Probe { place, circle, is_pointed_at }) = self.probe(seen) else { return };
        if !shows_circle(seen) {
            let radius = self.selection.min_distance as f32;
            let shape = Shape::Ellipse { center: point(place), radii: [radius; 2], angle_rad: 0.0 };
            scene.mark(Picture::CURRENT, Role::Window, shape);
            scene.legend(Role::Window, "minimum distance");
        } else if let Some(circle) = circle {
            draw_circle(&circle, (seen.before.stage, seen.before.scores.size()), scene);
            // A step is about the pixel that it tests or compares, and not about the pointer.
            if !is_pointed_at && matches!(seen.events.last(), Some(Event::Tested(_) | Event::Compared(..))) {
                let reach = RADIUS as f32 + 0.5;
                scene.work = Some([-reach, reach].map(|by| point(place).map(|c| c + by)));
            }
        }
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(place.0 as i32, place.1 as i32, 1, 1));
        scene.legend(Role::Reference, "inspected pixel p");
    }
}

/// Whether the circle of the inspected pixel is shown; a corner that is kept or rejected has the minimum distance around it.
fn shows_circle(seen: &Seen<Fast>) -> bool {
    !matches!(seen.events.last(), Some(Event::Peak(..))) || seen.point().is_some()
}

/// The shades with their roles and meanings, which no corner has.
const SHADES: [(Shade, Role, &str); 3] = [
    (Shade::Similar, Role::Estimate, "similar to p"),
    (Shade::Brighter, Role::Measured, "brighter than the centre p by more than t"),
    (Shade::Darker, Role::Predicted, "darker than the centre p by more than t"),
];

/// Role and meaning of the longest run, different from those of the corners of `stage`.
fn role_of_run(circle: &Circle, stage: Stage) -> (Role, &'static str) {
    match circle.arc {
        Some(_) if stage == Stage::Choice => (Role::Window, "longest run, an arc"),
        Some(_) => (Role::Result, "longest run, an arc"),
        None => (Role::Error, "longest run, too short"),
    }
}

/// The pixels of the circle by their shades, and the longest run around them, as they are drawn on the stage.
fn framed(circle: &Circle, stage: Stage) -> Vec<Framed> {
    let pixel = |k: usize| CIRCLE[k % 16].map(|offset| offset.saturating_add_unsigned(RADIUS) as usize);
    let run = circle.run.map(|(start, length)| Framed {
        role: role_of_run(circle, stage).0,
        pixels: (start..start + length).map(pixel).collect(),
        is_outer: true,
    });
    let of_shade = |(shade, role, _)| {
        let pixels = (0..16).filter(|k| circle.shades[*k] == shade).map(pixel).collect();
        Framed { role, pixels, is_outer: false }
    };
    run.into_iter().chain(SHADES.map(of_shade)).collect()
}

/// Draws the pixels of the circle by their shades, and the longest run, in roles that no corner of `stage` has.
fn draw_circle(circle: &Circle, (stage, (width, height)): (Stage, (usize, usize)), scene: &mut Scene) {
    let on_circle = |k: usize, radius: f32| {
        let [x, y] = point(circle.center);
        let [i, j] = CIRCLE[k % 16].map(|offset| radius * offset as f32);
        [x + i, y + j]
    };
    for (shade, role, meaning) in SHADES {
        for k in (0..16).filter(|k| circle.shades[*k] == shade) {
            let [x, y] = on_circle(k, 1.0);
            scene.mark(Picture::CURRENT, role, Shape::pixels(x as i32, y as i32, 1, 1));
            scene.legend(role, meaning);
        }
    }
    if let Some((start, length)) = circle.run {
        let points = (start..start + length).map(|k| on_circle(k, 1.0)).collect();
        let (role, meaning) = role_of_run(circle, stage);
        scene.mark(Picture::CURRENT, role, Shape::Path { points, closed: length == 16 });
        scene.legend(role, meaning);
    }
    for k in COMPASS {
        let text = number(k).to_string();
        let is_inside = |at: &[f32; 2]| at[0] >= 0.0 && at[1] >= 0.0 && at[0] < width as f32 && at[1] < height as f32;
        // At the border of the picture there is room on the inner side only.
        let at = Some(on_circle(k, 4.0 / 3.0)).filter(is_inside).unwrap_or_else(|| on_circle(k, 2.0 / 3.0));
        scene.mark(Picture::CURRENT, Role::Reference, Shape::Text { at, text });
    }
}

impl State {
    fn score(&self, index: u32) -> u8 {
        self.scores.cells()[index as usize]
    }

    /// Returns the position of the local maximum of the highest score.
    fn strongest(&self) -> Option<(usize, usize)> {
        let better = |a: u32, b: u32| if self.score(b) > self.score(a) { b } else { a };
        self.peaks.iter().copied().reduce(better).map(|peak| self.place(peak))
    }
}

/// The pixel of the arc that limits the score, and the size of its difference.
fn weakest(circle: &Circle, arc: usize) -> (usize, u16) {
    let start = circle.arc.unwrap_or_default();
    let sizes = (start..start + arc).map(|k| (k % 16, circle.differences[k % 16].unsigned_abs()));
    sizes.min_by_key(|(_, size)| *size).unwrap_or_default()
}

/// Draws the scores so far.
fn draw_scores(seen: &Seen<Fast>, scene: &mut Scene) {
    let state = seen.before;
    let (width, height) = state.scores.size();
    let mut values = state.scores.map(|score| if *score > 0 { f32::from(*score) } else { f32::NAN });
    for event in seen.events {
        if let Event::Tested(Candidate { x, score: score @ 1.. }) = event {
            values[(*x, state.row)] = f32::from(*score);
        }
    }
    if width * height > 0 && values.cells().iter().any(|value| value.is_finite()) {
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
        scene.heat = Some("V");
    }
}
