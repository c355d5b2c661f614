//! The explanation and the drawing of ORB.

use std::sync::Arc;

use super::{Event, Level, Orb, State, line};
use crate::base::words::{counted, grouped, pixel};
use crate::geometry::Grid;
use crate::methods::differential::{explain, numbers};
use crate::methods::features::brief::{BITS, Moments, Pair, WINDOW_REACH, turned, window_sum};
use crate::methods::features::draw_keypoints;
use crate::methods::features::segment::SegmentTest;
use crate::methods::numbers::percent;
use crate::run::{Progress, Seen};
use crate::scene::{Fact, Math, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

/// The number of responses that a plot shows.
const PLOTTED: usize = 400;

/// A keypoint that is described: its level, and what is known of it so far.
struct Probe<'a> {
    index: usize,
    level: &'a Level,
    place: (usize, usize),
    moments: Moments,
    /// The bits so far.
    bits: Vec<bool>,
}

impl Probe<'_> {
    /// A pair of the pattern, turned by the orientation.
    fn turned(&self, pair: Pair) -> Pair {
        turned(pair, self.moments.direction())
    }

    /// The pixel of the level at an offset.
    fn pixel(&self, [i, j]: [i32; 2]) -> (usize, usize) {
        ((self.place.0 as i32 + i) as usize, (self.place.1 as i32 + j) as usize)
    }

    /// The place in the frame of an offset.
    fn in_frame(&self, [i, j]: [f32; 2]) -> [f32; 2] {
        self.level.of.in_frame([self.place.0 as f32 + i, self.place.1 as f32 + j])
    }
}

/// The mean of a window of the pattern.
fn mean(sum: u32) -> f32 {
    let side = (2 * WINDOW_REACH + 1) as f32;
    sum as f32 / (side * side)
}

impl Orb {
    /// Returns the level at work.
    fn level<'a>(&self, seen: &'a Seen<Self>) -> Option<&'a Arc<Level>> {
        seen.events.iter().find_map(|event| match event {
            Event::Resampled(level) => Some(level),
            _ => None,
        })
    }

    /// Returns the keypoint at work.
    fn probe<'a>(&self, seen: &'a Seen<Self>) -> Option<Probe<'a>> {
        let state = seen.before;
        let index = state.current()?;
        let corner = state.corners.get(index)?;
        let moments = seen.events.iter().find_map(|event| match event {
            Event::Centroid(moments) => Some(*moments),
            _ => None,
        })?;
        let bits = seen.events.iter().filter_map(|event| match event {
            Event::Compared(bit) => Some(*bit),
            _ => None,
        });
        let level = &*state.levels[corner.level];
        Some(Probe { index, level, place: corner.place, moments, bits: bits.collect() })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last() else {
            let sentence = "ORB detects FAST corners on the levels of a pyramid, so that it finds corners of several sizes. Each \
                            gets the direction of its intensity centroid as orientation, and a descriptor of 256 bits: \
                            comparisons of two small windows, turned by the orientation.";
            let said = Sentence::default().text(sentence);
            return Step { line: line::EACH_LEVEL, sentence: said, readouts: Vec::new() };
        };
        let (line, sentence) = match (self.level(seen), self.probe(seen)) {
            (Some(level), _) => self.of_level(seen, level, last),
            (None, Some(probe)) => self.of_keypoint(seen, &probe),
            (None, None) => (line::EACH_LEVEL, Sentence::default()),
        };
        let readouts = match (self.level(seen), self.probe(seen)) {
            (Some(level), _) => self.readouts_of_level(seen, level),
            (None, Some(probe)) => self.readouts_of_keypoint(seen, &probe),
            (None, None) => Vec::new(),
        };
        Step { line, sentence: self.concluded(seen, sentence), readouts }
    }

    /// Explains an event of a level.
    fn of_level(&self, seen: &Seen<Self>, level: &Level, event: &Event) -> (Name, Sentence) {
        let (index, said) = (seen.before.levels.len(), Sentence::default());
        let (width, height) = level.of.picture.size();
        let fits = level.ranked.len();
        match event {
            Event::Detected if level.found == 0 => (
                line::DETECT,
                said.text(format!(
                    "FAST finds no corner on level {index}: no arc of {} pixels differs by more than {} gray levels. A lower \
                     threshold finds corners of less contrast.",
                    self.arc, self.threshold
                )),
            ),
            Event::Detected => (
                line::DETECT,
                said.text(format!(
                    "FAST with an arc of {} and a threshold of {} gray levels finds {} on level {index} after non-maximum \
                     suppression. The {side}×{side} px patch fits into the picture around {} of them.",
                    self.arc,
                    self.threshold,
                    match level.found {
                        1 => "1 corner".to_owned(),
                        found => format!("{} corners", grouped(found)),
                    },
                    grouped(fits),
                    side = 2 * self.radius() + 1,
                )),
            ),
            Event::Ranked => (line::RANK, ranked(level, index)),
            Event::Peak(place, near) => self.chosen(seen, (index, level), (*place, *near)),
            _ if index == 0 => (
                line::RESAMPLE,
                said.text(format!(
                    "Level 0 is the frame itself with {width}×{height} px. Its share of the {} keypoints is {}: a level gets them in \
                     proportion to its width.",
                    grouped(self.selection.max_points),
                    grouped(level.share)
                )),
            ),
            _ => (
                line::RESAMPLE,
                said.text(format!(
                    "Level {index} has {width}×{height} px, a factor {} smaller than the level before: a pixel is {} px of the \
                     frame wide. Its share of the keypoints is {}.",
                    self.scale_factor,
                    numbers::px(level.of.scale),
                    grouped(level.share)
                )),
            ),
        }
    }

    /// Explains the selection of a corner.
    fn chosen(
        &self,
        seen: &Seen<Self>,
        (index, level): (usize, &Level),
        (place, near): (u32, Option<u32>),
    ) -> (Name, Sentence) {
        let name = pixel(level.place(place));
        let response = |place: u32| numbers::gray(level.response(place));
        let said = Sentence::default().text("Corner ");
        let Some(near) = near else {
            let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
            let said = said.ink(Role::Result, name).text(format!(
                " of level {index}, R = {}: kept as keypoint {} of the {} that the level may have.",
                response(place),
                grouped(count),
                grouped(level.share)
            ));
            return (line::KEEP, said);
        };
        let said = said
            .ink(Role::Rejected, name)
            .text(format!(
                " of level {index}, R = {}, is closer than the minimum distance ({} px of the frame) to corner ",
                response(place),
                self.selection.min_distance
            ))
            .ink(Role::Result, pixel(level.place(near)))
            .text(format!(" with R = {}, which is no smaller: rejected.", response(near)));
        (line::DROP_NEAR, said)
    }

    /// Explains an event of a keypoint.
    fn of_keypoint(&self, seen: &Seen<Self>, probe: &Probe<'_>) -> (Name, Sentence) {
        let state = seen.before;
        let Moments { m10, m01, .. } = probe.moments;
        let Some(bit) = probe.bits.last() else {
            let [x, y] = probe.moments.centroid().map(numbers::px);
            let said = Sentence::default()
                .text(format!("Keypoint {} of {} on level {} at ", probe.index + 1, state.corners.len(), state.corners[probe.index].level))
                .ink(Role::Reference, pixel(probe.place))
                .text(format!(
                    ": the moments of its disc are m₁₀ = {} and m₀₁ = {}, so the intensity centroid lies at ({x},\u{a0}{y}) px from the \
                     middle. ",
                    numbers::fixed(m10 as f32, 0),
                    numbers::fixed(m01 as f32, 0)
                ))
                .text("Orientation θ = atan2(m₀₁, m₁₀) = ")
                .ink(Role::Result, degrees(&probe.moments))
                .text(".");
            return (line::ORIENT, said);
        };
        let k = probe.bits.len() - 1;
        let [a, b] = self.means(state, probe, k);
        let turned = probe.turned(state.pattern[k]).map(|offset| pixel(probe.pixel(offset)));
        let [first, second] = turned;
        let comparison = if *bit { "less than" } else { "not less than" };
        let said = Sentence::default()
            .text(format!("Pair {} of {BITS}, turned by {}: the 5×5 window at ", k + 1, degrees(&probe.moments)))
            .ink(Role::Candidate, first)
            .text(format!(
                " px of level {} has the mean {}, {comparison} {} of the window at ",
                state.corners[probe.index].level,
                numbers::gray(a),
                numbers::gray(b)
            ))
            .ink(Role::Candidate, second)
            .text(format!(" px, so the bit is {}.", u8::from(*bit)));
        (line::COMPARE, said)
    }

    /// The means of the two windows of pair `k`.
    fn means(&self, state: &State, probe: &Probe<'_>, k: usize) -> [f32; 2] {
        let pair = probe.turned(state.pattern[k]);
        pair.map(|offset| mean(window_sum(&probe.level.integral, probe.place, offset)))
    }

    /// Adds the conclusion at the end of a run.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let Some(after) = seen.after.filter(|after| after.current() == Some(after.corners.len())) else {
            return sentence;
        };
        let shares: usize = after.levels.iter().map(|level| level.share).sum();
        if after.corners.is_empty() {
            let test = SegmentTest { threshold: self.threshold as u8, arc: self.arc };
            let highest = after.levels.iter().map(|level| test.highest_score(&level.of.picture)).max().unwrap_or(0);
            return sentence.text(match usize::from(highest) < self.threshold {
                true => format!(
                    " End of the run: no keypoints. The highest score of all levels is V = {highest}, and a corner has at least V = t = {}; a \
                     lower threshold finds some.",
                    self.threshold
                ),
                false => format!(
                    " End of the run: no keypoints. No corner is at least {} px from the border and so has a patch of {side}×{side} px; a \
                     smaller patch finds some.",
                    self.margin(),
                    side = self.side()
                ),
            });
        }
        let by_level =
            (0..after.levels.len()).map(|level| after.corners.iter().filter(|corner| corner.level == level).count());
        let by_level: Vec<String> = by_level.map(grouped).collect();
        let ones: u32 = after.described.iter().flat_map(|described| described.bits).map(u64::count_ones).sum();
        let share = f64::from(ones) / (BITS * after.described.len()) as f64;
        let help = match after.corners.len() < shares {
            true => "Some levels have fewer corners than their share; a lower threshold also finds weaker ones.",
            false => {
                "Every level has more corners than its share; a larger maximum number of points keeps weaker ones."
            }
        };
        sentence.text(format!(
            " End of the run: {} on {} ({}, from level 0 on). {} of all bits are 1; near one half, descriptors of different points \
             differ most. {help}",
            counted(after.corners.len(), "keypoint"),
            counted(after.levels.len(), "level"),
            by_level.join(", "),
            percent(share),
        ))
    }

    fn readouts_of_level(&self, seen: &Seen<Self>, level: &Level) -> Vec<Readout> {
        let (index, (width, height)) = (seen.before.levels.len(), level.of.picture.size());
        let mut facts = vec![
            Fact::new("Level", format!("{index} of 0 to {}", seen.before.level_count - 1), None),
            Fact::new("Size", format!("{width}×{height} px"), None),
            Fact::new("Share of the keypoints", grouped(level.share), None),
        ];
        let is_ranked = seen.events.iter().any(|event| matches!(event, Event::Ranked));
        if seen.events.iter().any(|event| matches!(event, Event::Detected)) {
            facts.push(Fact::new("Corners of FAST", grouped(level.found), None));
            facts.push(Fact::new("With room for the patch", grouped(level.ranked.len()), None));
        }
        let place = match seen.events.last() {
            Some(Event::Peak(place, _)) => Some(*place),
            _ => level.ranked.first().map(|(place, _)| *place).filter(|_| is_ranked),
        };
        let mut readouts = Vec::new();
        if let Some(place) = place {
            facts.push(Fact::new("Corner", pixel(level.place(place)), Some(Role::Reference)));
            facts.push(Fact::new("Harris response R", numbers::gray(level.response(place)), Some(Role::Result)));
            let values = explain::around(&level.of.picture, level.place(place), 4);
            readouts.push(Readout::Series(responses(level)));
            readouts.push(Readout::Tiles(vec![Tile {
                label: "Level",
                role: None,
                values,
                range: [0.0, 255.0],
                framed: Vec::new(),
            }]));
        }
        readouts.insert(0, Readout::Facts(facts));
        readouts
    }

    fn readouts_of_keypoint(&self, seen: &Seen<Self>, probe: &Probe<'_>) -> Vec<Readout> {
        let (state, corner) = (seen.before, seen.before.corners[probe.index]);
        let Moments { m00, m10, m01 } = probe.moments;
        let whole = |moment: i32| numbers::fixed(moment as f32, 0);
        let mut facts = vec![
            Fact::new("Keypoint", format!("{} of {}", probe.index + 1, state.corners.len()), None),
            Fact::new("Pixel of its level", pixel(probe.place), Some(Role::Reference)),
            Fact::new("Harris response R", numbers::gray(corner.response), None),
            Fact::new("m₀₀, m₁₀, m₀₁", [m00, m10, m01].map(whole).join(", "), None),
            Fact::new("Orientation θ", degrees(&probe.moments), Some(Role::Result)),
        ];
        let mut lines = vec![angle_in_symbols(), angle_in_numbers(&probe.moments)];
        if let Some((k, bit)) = probe.bits.len().checked_sub(1).map(|k| (k, probe.bits[k])) {
            let [a, b] = self.means(state, probe, k).map(numbers::gray);
            let ones = probe.bits.iter().filter(|bit| **bit).count();
            facts.push(Fact::new("Means of the windows", format!("{a} and {b}"), Some(Role::Candidate)));
            facts.push(Fact::new("Bits so far", format!("{} of {BITS}, {ones} set", k + 1), None));
            facts.push(Fact::new("Last bits", last_bits(&probe.bits), None));
            lines.push(Math::Row(vec![
                Math::text(format!("{a} < {b}: {}", if bit { "true, bit " } else { "false, bit " })),
                Math::ink(Role::Result, u8::from(bit).to_string()),
            ]));
        }
        let tile = |label, values| Tile { label, role: None, values, range: [0.0, 255.0], framed: Vec::new() };
        let tiles = vec![
            tile("Patch", self.patch_of(probe, [1.0, 0.0])),
            tile("Patch, upright", self.patch_of(probe, probe.moments.direction())),
        ];
        vec![Readout::Facts(facts), Readout::Equation(lines), Readout::Tiles(tiles)]
    }

    /// The patch, sampled along a direction.
    fn patch_of(&self, probe: &Probe<'_>, [c, s]: [f32; 2]) -> Grid<f32> {
        let radius = self.radius() as i32;
        let side = 2 * radius as usize + 1;
        Grid::from_fn(side, side, |i, j| {
            let [i, j] = [i as i32 - radius, j as i32 - radius].map(|offset| offset as f32);
            let [x, y] = [c * i - s * j, s * i + c * j].map(|offset| offset.round() as i32);
            // Turned corners of the square may lie outside the picture.
            let column = usize::try_from(probe.place.0 as i32 + x);
            let row = usize::try_from(probe.place.1 as i32 + y);
            let level = column.ok().zip(row.ok()).and_then(|(x, y)| probe.level.of.picture.get(x, y));
            level.map_or(f32::NAN, |level| f32::from(*level))
        })
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let done = seen.after.filter(|after| after.progress() == Progress::Done && !after.described.is_empty());
        match (done, self.level(seen), self.probe(seen)) {
            (Some(done), ..) => draw_keypoints(&done.features(self.side()), scene),
            (None, Some(level), _) => self.draw_level(seen, level, scene),
            (None, None, Some(probe)) => self.draw_keypoint(seen, &probe, scene),
            (None, None, None) => {}
        }
    }

    fn draw_level(&self, seen: &Seen<Self>, level: &Level, scene: &mut Scene) {
        let (margin, (width, height)) = (self.margin() as f32, level.of.picture.size());
        let edges = [[margin - 0.5; 2], [width as f32 - margin - 0.5, height as f32 - margin - 0.5]];
        let [min, max] = edges.map(|edge| level.of.in_frame(edge));
        scene.mark(Picture::CURRENT, Role::Window, Shape::Rect { min, max });
        scene.legend(Role::Window, "area in which the patch fits");
        let mut points = |role, meaning, places: Vec<u32>| {
            if !places.is_empty() {
                let place = |place: u32| level.in_frame(place);
                scene.mark(Picture::CURRENT, role, Shape::Points(places.into_iter().map(place).collect()));
                scene.legend(role, meaning);
            }
        };
        let tested = |is_kept: bool| {
            let peaks = seen.events.iter().filter_map(move |event| match event {
                Event::Peak(place, near) if near.is_none() == is_kept => Some(*place),
                _ => None,
            });
            peaks.collect::<Vec<_>>()
        };
        if seen.events.len() > 1 {
            points(Role::Candidate, "FAST corner", level.ranked.iter().map(|(place, _)| *place).collect());
        }
        points(Role::Rejected, "rejected by the minimum distance", tested(false));
        points(Role::Result, "keypoint", tested(true));
        if let Some(Event::Peak(place, _)) = seen.events.last() {
            self.draw_disc(level, level.place(*place), scene);
        }
    }

    /// Draws the disc around a pixel of a level.
    fn draw_disc(&self, level: &Level, (x, y): (usize, usize), scene: &mut Scene) {
        let center = level.of.in_frame([x as f32, y as f32]);
        let radii = [(self.radius() as f32 + 0.5) * level.of.scale; 2];
        scene.mark(Picture::CURRENT, Role::Reference, Shape::Ellipse { center, radii, angle_rad: 0.0 });
        scene.legend(Role::Reference, "disc of the patch");
    }

    fn draw_keypoint(&self, seen: &Seen<Self>, probe: &Probe<'_>, scene: &mut Scene) {
        let state = seen.before;
        let others: Vec<_> = state.corners[..probe.index].iter().map(|corner| state.at(corner)).collect();
        if !others.is_empty() {
            scene.mark(Picture::CURRENT, Role::Best, Shape::Points(others));
            scene.legend(Role::Best, "described keypoint");
        }
        self.draw_disc(probe.level, probe.place, scene);
        self.draw_pairs(state, probe, scene);
        let [x, y] = probe.moments.direction();
        let reach = self.radius() as f32;
        let points = [[0.0; 2], [reach * x, reach * y]].map(|offset| probe.in_frame(offset)).to_vec();
        scene.mark(Picture::CURRENT, Role::Result, Shape::Path { points, closed: false });
        scene.legend(Role::Result, "orientation");
        scene.mark(Picture::CURRENT, Role::Estimate, Shape::Points(vec![probe.in_frame(probe.moments.centroid())]));
        scene.legend(Role::Estimate, "intensity centroid");
    }

    /// Draws the pairs compared so far, and the two windows of the last one.
    fn draw_pairs(&self, state: &State, probe: &Probe<'_>, scene: &mut Scene) {
        let ends = |k: usize| probe.turned(state.pattern[k]).map(|offset| probe.in_frame(offset.map(|c| c as f32)));
        for (k, bit) in probe.bits.iter().enumerate() {
            let (role, meaning) = match bit {
                true => (Role::Measured, "bit 1: first window darker"),
                false => (Role::Rejected, "bit 0"),
            };
            scene.mark(Picture::CURRENT, role, Shape::Path { points: ends(k).to_vec(), closed: false });
            scene.legend(role, meaning);
        }
        let Some(last) = probe.bits.len().checked_sub(1) else { return };
        let half = WINDOW_REACH as f32 + 0.5;
        for offset in probe.turned(state.pattern[last]) {
            let [x, y] = offset.map(|c| c as f32);
            let [min, max] = [-half, half].map(|edge| probe.in_frame([x + edge, y + edge]));
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::Rect { min, max });
        }
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::Path { points: ends(last).to_vec(), closed: false });
        scene.legend(Role::Candidate, "windows compared");
    }
}

impl Level {
    /// Returns the pixel of a row-major index.
    fn place(&self, index: u32) -> (usize, usize) {
        let width = self.of.picture.width();
        (index as usize % width, index as usize / width)
    }

    /// Returns the position in the frame of a row-major index.
    fn in_frame(&self, index: u32) -> [f32; 2] {
        let (x, y) = self.place(index);
        self.of.in_frame([x as f32, y as f32])
    }

    /// Returns the response of a corner.
    fn response(&self, index: u32) -> f32 {
        self.ranked.iter().find(|(place, _)| *place == index).map_or(f32::NAN, |(_, response)| *response)
    }
}

/// Explains the ranking of a level.
fn ranked(level: &Level, index: usize) -> Sentence {
    let said = Sentence::default();
    let (Some((_, first)), Some((_, last))) = (level.ranked.first(), level.ranked.last()) else {
        return said.text(format!("There is no corner on level {index} to be ranked."));
    };
    said.text(format!(
        "The FAST score is high along edges too, so the corners are ranked by their Harris response over 7×7 \
         px, here {} to {}. Keypoints of level {index}: the strongest {}.",
        numbers::gray(*first),
        numbers::gray(*last),
        grouped(level.share.min(level.ranked.len()))
    ))
}

/// The responses of a level by rank, and how many of them it may keep.
fn responses(level: &Level) -> Series {
    let of = |range: std::ops::Range<usize>| -> Vec<[f32; 2]> {
        range.map(|rank| [(rank + 1) as f32, level.ranked[rank].1 / 1000.0]).collect()
    };
    let shown = level.ranked.len().min(PLOTTED);
    let within = level.share.min(shown);
    let mut lines = vec![("within the share", Role::Result, of(0..within))];
    if within < shown {
        lines.push(("beyond the share", Role::Rejected, of(within..shown)));
    }
    Series {
        title: "Harris response by rank",
        x_label: "rank",
        y_label: "R / 1000",
        x_max: shown,
        lines,
        is_sweep: true,
        ..Series::default()
    }
}

/// The last bits as text, the newest on the right.
fn last_bits(bits: &[bool]) -> String {
    let last = &bits[bits.len().saturating_sub(16)..];
    // In fours, as a nibble is read.
    let fours = last.chunks(4).map(|four| four.iter().map(|bit| if *bit { '1' } else { '0' }).collect::<String>());
    fours.collect::<Vec<_>>().join(" ")
}

/// The orientation in degrees.
fn degrees(moments: &Moments) -> String {
    format!("{}°", numbers::fixed(moments.angle_rad().to_degrees(), 1))
}

fn angle_in_symbols() -> Math {
    let moment = |index| Math::indexed(Math::Var("m"), Math::text(index));
    let sum = |factor| Math::Row(vec![Math::text("Σ "), Math::Var(factor), Math::text(" "), Math::Var("I")]);
    Math::Row(vec![
        Math::Var("θ"),
        Math::text(" = atan2("),
        moment("01"),
        Math::text(", "),
        moment("10"),
        Math::text(") = atan2("),
        sum("y"),
        Math::text(", "),
        sum("x"),
        Math::text(")"),
    ])
}

fn angle_in_numbers(moments: &Moments) -> Math {
    let whole = |moment: i32| Math::ink(Role::Estimate, numbers::fixed(moment as f32, 0));
    Math::Row(vec![
        Math::text(" = atan2("),
        whole(moments.m01),
        Math::text(", "),
        whole(moments.m10),
        Math::text(") = "),
        Math::ink(Role::Result, degrees(moments)),
    ])
}
