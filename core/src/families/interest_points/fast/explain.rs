//! The explanation and the drawing of FAST.

use super::{Event, Fast, Stage, State, corners, line};
use crate::base::words::{counted, grouped, pixel};
use crate::geometry::Grid;
use crate::methods::differential::explain;
use crate::methods::features::{
    Selection,
    segment::{CIRCLE, COMPASS, Candidate, Circle, RADIUS, Shade, suppressed_by},
};
use crate::run::Seen;
use crate::scene::{Fact, Framed, Math, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

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
        let probe = self.probe(seen);
        let Some(last) = seen.events.last() else {
            return Step { line: line::EACH_PIXEL, sentence: self.introduction(), readouts: Vec::new() };
        };
        let (line, sentence) = match &probe {
            Some(probe) if probe.is_pointed_at => self.verdict(seen, probe),
            probe => {
                let (line, sentence) = self.at_work(seen, *last, probe.as_ref());
                (line, self.concluded(seen, sentence))
            }
        };
        let readouts = match &probe {
            Some(probe) => self.readouts(seen, probe),
            None => vec![Readout::Facts(self.facts_of_row(seen.before))],
        };
        Step { line, sentence, readouts }
    }

    fn introduction(&self) -> Sentence {
        let Self { threshold, arc, .. } = self;
        Sentence::default().text(format!(
            "At a corner most of a small circle differs from its centre p. FAST compares 16 pixels with I_p and looks for an arc \
             of {arc} contiguous ones, all brighter than I_p + {threshold} or all darker than I_p − {threshold}. It needs only \
             comparisons of gray levels."
        ))
    }

    /// Explains the last event.
    fn at_work(&self, seen: &Seen<Self>, event: Event, probe: Option<&Probe>) -> (Name, Sentence) {
        let state = seen.before;
        match (event, probe.and_then(|probe| probe.circle.as_ref())) {
            (Event::Row, _) => (line::HIGH_SPEED, self.row(state)),
            (Event::Tested(_), Some(circle)) => self.tested(circle),
            (Event::Tested(_), None) => (line::EACH_PIXEL, self.introduction()),
            (Event::Corners, _) => (line::EACH_CORNER, corners_of_row(state)),
            (Event::Compared(place, by), _) => (line::SUPPRESS, compared(state, place, by)),
            (Event::Ranked, _) => (line::EACH_PEAK, self.ranked(state)),
            (Event::Peak(peak, Some(near)), _) => (line::DROP_NEAR, self.rejected(state, peak, near)),
            (Event::Peak(peak, None), _) => {
                let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
                (line::KEEP, kept(state, peak, count))
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

    /// Explains the high-speed test of a row.
    fn row(&self, state: &State) -> Sentence {
        let (all, passing) = self.passing(state, state.row);
        let (y, compass) = (state.row, self.test().compass_points());
        let said = Sentence::default();
        if all == 0 {
            return said.text(format!(
                "Row {y}: no pixel is {RADIUS} px away from the border, so no circle fits and there are no corners."
            ));
        }
        said.text(format!(
            "Row {y}: {passing} of {all} pixels pass the high-speed test, with {compass} adjacent compass pixels of the circle (1, \
             5, 9, 13) all brighter than I_p + {t} or all darker than I_p − {t}. Any arc of {} contains {compass} of them, so no \
             other pixel can be a corner.",
            self.arc,
            t = self.threshold
        ))
    }

    /// Explains the tests of a pixel, with the line that decides.
    fn tested(&self, circle: &Circle) -> (Name, Sentence) {
        let Self { threshold, arc, .. } = self;
        let compass = self.test().compass_points();
        let said = |role| {
            let name = format!("Pixel {}", pixel(circle.center));
            Sentence::default().ink(role, name).text(format!(", I_p = {}: ", circle.level))
        };
        let (start, length) = circle.run.unwrap_or_default();
        let limit = |shade| match shade {
            Shade::Darker => format!("darker than I_p − {threshold} = {}", i32::from(circle.level) - *threshold as i32),
            _ => format!("brighter than I_p + {threshold} = {}", usize::from(circle.level) + threshold),
        };
        let ends = match length {
            0 | 16 => String::new(),
            1 => format!(" (pixel {})", number(start)),
            _ => format!(" ({} to {})", number(start), number(start + length - 1)),
        };
        let limit = limit(circle.shades[start]).replace("than I_p − ", "than I_p\u{a0}−\u{a0}");
        if circle.compass < compass {
            return (
                line::HIGH_SPEED,
                said(Role::Rejected).text(format!(
                    "the longest run of brighter or darker compass pixels is {}, and an arc of {arc} needs {compass}: \
                     rejected by the high-speed test.",
                    circle.compass
                )),
            );
        }
        if circle.arc.is_none() {
            return (
                line::SEGMENT_TEST,
                said(Role::Rejected).text(format!(
                    "the longest run has {length} contiguous pixels{ends} {limit}. The arc needs {arc}: no corner."
                )),
            );
        }
        let (weakest, difference) = weakest(circle, *arc);
        let said = said(Role::Best).text(format!(
            "{length} contiguous pixels{ends} are {limit}, at least {arc}: a corner. Its score is V = {}, since with t = {difference} \
             its best arc loses pixel {}, which differs by {difference}.",
            circle.score,
            number(weakest)
        ));
        (line::SCORE, said)
    }

    fn ranked(&self, state: &State) -> Sentence {
        let said = Sentence::default();
        let Selection { min_distance, max_points } = self.selection;
        if state.peaks.is_empty() && state.scores.cells().iter().all(|score| *score == 0) {
            return said.text(format!(
                "No pixel has {} contiguous circle pixels that differ by more than {} gray levels: there are no corners. The highest \
                 score is V = {}, and a corner has at least V = t = {}. A lower threshold finds corners of less contrast.",
                self.arc,
                self.threshold,
                self.test().highest_score(state.picture.luma()),
                self.threshold
            ));
        }
        if state.peaks.is_empty() {
            return said.text(
                "No score exceeds those of all 8 neighbours: neighbours with equal scores suppress each other, which happens in \
                 pictures without noise. So no corner is left.",
            );
        }
        said.text(format!(
            "{} ranked by score. In this order at most {} are kept (the maximum number of points), each at least {min_distance} px \
             (the minimum distance) from those kept before.",
            match state.peaks.len() {
                1 => "1 corner is".to_owned(),
                count => format!("{} corners are", grouped(count)),
            },
            grouped(max_points),
        ))
    }

    fn rejected(&self, state: &State, peak: u32, near: u32) -> Sentence {
        let [score, stronger] = [peak, near].map(|index| state.score(index));
        let why = match stronger > score {
            true => format!("has the higher score {stronger}"),
            false => "has an equal score and comes first".to_owned(),
        };
        Sentence::default()
            .text("Corner ")
            .ink(Role::Rejected, pixel(state.place(peak)))
            .text(format!(
                ", V = {score}, is closer than the minimum distance ({} px) to corner ",
                self.selection.min_distance
            ))
            .ink(Role::Result, pixel(state.place(near)))
            .text(format!(", which {why}: rejected."))
    }

    /// Adds the conclusion at the end of a run.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let Some(after) = seen.after.filter(|_| seen.before.stage == Stage::Choice) else { return sentence };
        let (Some(first), Some(last)) = (after.kept.first(), after.kept.last()) else { return sentence };
        let found = after.scores.cells().iter().filter(|score| **score > 0).count();
        let scores = match after.kept.len() {
            1 => format!("score {}", after.score(*first)),
            _ => format!("scores {} to {}", after.score(*first), after.score(*last)),
        };
        let help = self.selection.advice(after.kept.len(), after.peaks.len());
        sentence.text(format!(
            " End of the run: {} kept, {scores}; {} passed the segment test and {} non-maximum suppression. {help}",
            counted(after.kept.len(), "corner"),
            match found {
                1 => "1 pixel".to_owned(),
                found => format!("{} pixels", grouped(found)),
            },
            grouped(after.peaks.len()),
        ))
    }

    /// Explains the pixel pointed at, as far as it is known what became of it.
    fn verdict(&self, seen: &Seen<Self>, probe: &Probe) -> (Name, Sentence) {
        let place = probe.place;
        let Some(circle) = &probe.circle else {
            let said = Sentence::default().ink(Role::Rejected, format!("Pixel {}", pixel(place)));
            return (
                line::EACH_PIXEL,
                said.text(format!(
                    " is less than {RADIUS} px from the border: its circle does not fit into the picture."
                )),
            );
        };
        let (line, said) = self.tested(circle);
        match self.status(seen, place).filter(|_| circle.arc.is_some()) {
            Some((line, status)) => (line, said.text(format!(" Status: {status}."))),
            None => (line, said),
        }
    }

    /// Returns what became of a corner after the segment test, and the line that decided it.
    fn status(&self, seen: &Seen<Self>, place: (usize, usize)) -> Option<(Name, String)> {
        let state = seen.before;
        let is_compared = match state.stage {
            Stage::Test => false,
            Stage::Suppression => place.1 < state.row,
            Stage::Choice => true,
        };
        if !is_compared {
            return None;
        }
        if let Some(by) = suppressed_by(&state.scores, place) {
            return Some((line::SUPPRESS, format!("suppressed by {}, V = {}", pixel(by), state.scores[by])));
        }
        let index = (place.1 * state.scores.width() + place.0) as u32;
        let choice = seen.events.iter().find_map(|event| match event {
            Event::Peak(peak, near) if *peak == index => Some(*near),
            _ => None,
        });
        let Selection { min_distance, max_points } = self.selection;
        Some(match choice {
            Some(None) => (line::KEEP, "kept".into()),
            Some(Some(near)) => {
                (line::DROP_NEAR, format!("rejected within {min_distance} px of {}", pixel(state.place(near))))
            }
            None if seen.after.is_some() && state.stage == Stage::Choice => {
                (line::KEEP, format!("not among the {} of highest score", grouped(max_points)))
            }
            None => (line::SUPPRESS, "local maximum of the score".into()),
        })
    }

    fn facts_of_row(&self, state: &State) -> Vec<Fact> {
        let count = corners(&state.scores, state.row).count();
        match state.stage {
            Stage::Test => {
                let (all, passing) = self.passing(state, state.row);
                vec![
                    Fact::new("Row", state.row.to_string(), Some(Role::Window)),
                    Fact::new("Pixels with a circle", all.to_string(), None),
                    Fact::new("Pass the high-speed test", passing.to_string(), Some(Role::Candidate)),
                ]
            }
            Stage::Suppression => vec![
                Fact::new("Row", state.row.to_string(), Some(Role::Window)),
                Fact::new("Corners", count.to_string(), None),
            ],
            Stage::Choice => vec![Fact::new("Local maxima of the score", grouped(state.peaks.len()), None)],
        }
    }

    fn readouts(&self, seen: &Seen<Self>, Probe { place, circle, .. }: &Probe) -> Vec<Readout> {
        let state = seen.before;
        let mut facts = vec![Fact::new("Pixel", pixel(*place), Some(Role::Reference))];
        let mut readouts = Vec::new();
        if let Some(circle) = circle {
            let length = circle.run.map_or(0, |(_, length)| length);
            facts.extend([
                Fact::new("Gray level I_p", circle.level.to_string(), None),
                Fact::new(
                    "Brighter, darker",
                    format!("{} and {}", circle.count(Shade::Brighter), circle.count(Shade::Darker)),
                    None,
                ),
                Fact::new("Longest run", format!("{length} of the {} needed", self.arc), None),
                Fact::new("Score V", circle.score.to_string(), Some(Role::Result)),
            ]);
            if circle.arc.is_some() {
                facts.extend(self.status(seen, *place).map(|(_, status)| Fact::new("Status", status, None)));
                readouts.push(Readout::Equation(self.equation(circle)));
            }
            readouts.push(Readout::Series(self.series(circle)));
        }
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
        readouts.push(Readout::Tiles(tiles));
        readouts.insert(0, Readout::Facts(facts));
        readouts
    }

    /// The score in symbols and in numbers.
    fn equation(&self, circle: &Circle) -> Vec<Math> {
        let index = |base, index| Math::indexed(Math::Var(base), Math::Var(index));
        let (weakest, difference) = weakest(circle, self.arc);
        let symbols = Math::Row(vec![
            Math::Var("V"),
            Math::text(format!(" = max over arcs of {} pixels of (min ", self.arc)),
            Math::abs(Math::Row(vec![index("I", "k"), Math::text(" − "), index("I", "p")])),
            Math::text(") − 1"),
        ]);
        let numbers = Math::Row(vec![
            Math::text(" = "),
            Math::abs(Math::Row(vec![
                Math::ink(
                    Role::Candidate,
                    (i32::from(circle.level) + i32::from(circle.differences[weakest])).to_string(),
                ),
                Math::text(" − "),
                Math::ink(Role::Reference, circle.level.to_string()),
            ])),
            Math::text(" − 1 = "),
            Math::ink(Role::Result, (difference - 1).to_string()),
        ]);
        vec![symbols, numbers]
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

/// Explains the row whose corners are compared next.
fn corners_of_row(state: &State) -> Sentence {
    let y = state.row;
    Sentence::default().text(match corners(&state.scores, y).count() {
        0 => format!("Row {y} has no corners, so there is nothing to suppress."),
        count => format!(
            "Row {y}: {}. Non-maximum suppression keeps those with a score V above that of all 8 neighbours; an arc slides over \
             neighbouring pixels, so one corner of the scene passes the test several times.",
            counted(count, "corner")
        ),
    })
}

/// Non-maximum suppression of a corner; `by` is the neighbour that suppresses it.
fn compared(state: &State, place: (usize, usize), by: Option<(usize, usize)>) -> Sentence {
    let (said, score) = (Sentence::default(), state.scores[place]);
    let Some(by) = by else {
        return said
            .ink(Role::Best, format!("Corner {}", pixel(place)))
            .text(format!(": the score {score} exceeds those of all 8 neighbours: a local maximum."));
    };
    let (than, why) = match state.scores[by] > score {
        true => ("the higher score", "suppressed"),
        false => ("the same score", "neither exceeds the other, so both are suppressed"),
    };
    said.ink(Role::Rejected, format!("Corner {}", pixel(place)))
        .text(format!(" has the score {score}, and its neighbour "))
        .ink(Role::Best, pixel(by))
        .text(format!(" {than} {}: {why}.", state.scores[by]))
}

/// Explains that a corner is kept.
fn kept(state: &State, peak: u32, count: usize) -> Sentence {
    Sentence::default().text("Corner ").ink(Role::Result, pixel(state.place(peak))).text(format!(
        ", V = {}, has no stronger corner within the minimum distance: kept as number {}.",
        state.score(peak),
        grouped(count)
    ))
}
