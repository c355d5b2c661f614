//! The steps of ORB in values, words and charts.

use super::probe::Probe;
use super::{Event, Level, Orb, State, case, features, line, value};
use crate::base::words::grouped;
use crate::geometry::Grid;
use crate::methods::differential::explain;
use crate::methods::features::brief::{BITS, Moments, WINDOW_REACH, window_sum};
use crate::methods::features::segment::SegmentTest;
use crate::run::Seen;
use crate::scene::{Readout, Role, Series, Step, Tile};

/// The number of responses that a plot shows.
const PLOTTED: usize = 400;

/// The mean of a window of the pattern.
fn mean(sum: u32) -> f32 {
    let side = (2 * WINDOW_REACH + 1) as f32;
    sum as f32 / (side * side)
}

impl Orb {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last() else { return Step::at(line::EACH_LEVEL).say(case::OPENING) };
        let step = match (self.level(seen), self.probe(seen)) {
            (Some(level), _) => self.of_level(seen, level, last),
            (None, Some(probe)) => self.of_keypoint(seen.before, &probe),
            (None, None) => Step::at(line::EACH_LEVEL),
        };
        self.conclude(seen, step)
    }

    fn of_level(&self, seen: &Seen<Self>, level: &Level, event: &Event) -> Step {
        let line = match event {
            Event::Detected => line::DETECT,
            Event::Ranked => line::RANK,
            Event::Peak(_, Some(_)) => line::DROP_NEAR,
            Event::Peak(_, None) => line::KEEP,
            _ => line::RESAMPLE,
        };
        let (index, (width, height)) = (seen.before.levels.len(), level.of.picture.size());
        let step = Step::at(line).fact(value::LEVEL, index).fact(value::LEVELS, seen.before.level_count);
        let step = step.fact(features::WIDTH, width).fact(features::HEIGHT, height).fact(value::SHARE, level.share);
        let step = step.put(value::THRESHOLD, self.threshold).put(value::ARC, self.arc);
        let step = step.put(value::PATCH, self.side()).put(features::MAX_POINTS, self.selection.max_points);
        let step = step.put(value::SCALE_FACTOR, self.scale_factor).put(value::PIXEL_WIDTH, level.of.scale);
        let fits = level.ranked.len();
        let step = match event {
            Event::Resampled(_) => return step.say(if index == 0 { case::FRAME } else { case::SMALLER }),
            _ => step.fact(value::CORNERS, level.found).fact(value::WITH_ROOM, fits),
        };
        let place = match event {
            Event::Peak(place, _) => Some(*place),
            Event::Ranked => level.ranked.first().map(|(place, _)| *place),
            _ => None,
        };
        let step = place.into_iter().fold(step, |step, place| put_corner(step, level, place));
        match (event, level.ranked.first(), level.ranked.last()) {
            (Event::Peak(_, near), ..) => self.chosen(seen, step, (level, *near)),
            (Event::Ranked, Some((_, first)), Some((_, last))) => {
                let step = step.put(features::FIRST_RESPONSE, *first).put(features::LAST_RESPONSE, *last);
                step.put(value::STRONGEST, level.share.min(fits)).say(case::RANKED)
            }
            (Event::Ranked, ..) => step.say(case::NONE_RANKED),
            _ => step.say(if level.found == 0 { case::NO_CORNERS } else { case::DETECTED }),
        }
    }

    /// Explains the selection of a corner; `near` is the one that rejects it.
    fn chosen(&self, seen: &Seen<Self>, step: Step, (level, near): (&Level, Option<u32>)) -> Step {
        let inked = |step: Step, role| {
            let pixel = step.value(features::PIXEL).cloned();
            pixel.into_iter().fold(step, |step, pixel| step.put_value(pixel.inked(role)))
        };
        let Some(near) = near else {
            let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
            return inked(step, Role::Result).put(features::KEPT, count).say(case::KEPT);
        };
        let step = inked(step, Role::Rejected).put(features::NEAR_CORNER, level.place(near));
        let step = step.put(features::OTHER_RESPONSE, level.response(near));
        step.put(features::MIN_DISTANCE, self.selection.min_distance).say(case::NEAR)
    }

    fn of_keypoint(&self, state: &State, probe: &Probe<'_>) -> Step {
        let (corner, Moments { m00, m10, m01 }) = (state.corners[probe.index], probe.moments);
        let line = if probe.bits.is_empty() { line::ORIENT } else { line::COMPARE };
        let step = Step::at(line).fact(features::KEYPOINT, probe.index + 1);
        let step = step.fact(features::KEYPOINTS, state.corners.len()).fact(value::LEVEL, corner.level);
        let step = step.fact(features::PIXEL, probe.place).fact(features::RESPONSE, corner.response);
        let step = step.fact(value::M_00, m00).fact(value::M_10, m10).fact(value::M_01, m01);
        let step = step.fact(features::ORIENTATION, probe.moments.angle_rad().to_degrees());
        let step = step.put(value::CENTROID, probe.moments.centroid());
        let step = step
            .formula(r"\theta = \text{atan2(}m_{01}, m_{10}\text{)} = \text{atan2(}\sum y\,I, \sum x\,I\text{)}")
            .formula(r"\theta = \text{atan2(}{m_01}, {m_10}\text{)} = {orientation:unit}");
        let step = step.show(Readout::Tiles(vec![
            Tile::gray("Patch", self.patch_of(probe, [1.0, 0.0])),
            Tile::gray("Patch, upright", self.patch_of(probe, probe.moments.direction())),
        ]));
        let Some((k, bit)) = probe.bits.len().checked_sub(1).map(|k| (k, probe.bits[k])) else {
            return step.say(case::ORIENTED);
        };
        let offsets = probe.turned(state.pattern[k]);
        let [first, second] = offsets.map(|offset| probe.pixel(offset));
        let means = offsets.map(|offset| mean(window_sum(&probe.level.integral, probe.place, offset)));
        let step = step.put(value::PAIR, k + 1).put(value::FIRST_WINDOW, first).put(value::SECOND_WINDOW, second);
        let step = step.fact(value::FIRST_MEAN, means[0]).fact(value::SECOND_MEAN, means[1]);
        let ones = probe.bits.iter().filter(|bit| **bit).count();
        let step = step.put(value::BIT, u8::from(bit)).fact(value::BITS, k + 1).fact(value::BITS_SET, ones);
        let step = step.fact(value::LAST_BITS, last_bits(&probe.bits)).say(case::COMPARED);
        match bit {
            true => step.say(case::LESS).formula(r"{first_mean} < {second_mean}\text{: true, bit }{bit}"),
            false => step.say(case::NOT_LESS).formula(r"{first_mean} < {second_mean}\text{: false, bit }{bit}"),
        }
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after.filter(|after| after.current() == Some(after.corners.len())) else { return step };
        if after.corners.is_empty() {
            let test = SegmentTest { threshold: self.threshold as u8, arc: self.arc };
            let highest = after.levels.iter().map(|level| test.highest_score(&level.of.picture)).max().unwrap_or(0);
            let step = step.put(value::HIGHEST_SCORE, highest).put(value::MARGIN, self.margin());
            let step = step.put(value::PATCH, self.side()).put(value::THRESHOLD, self.threshold);
            let has_corners = usize::from(highest) >= self.threshold;
            return step.say(if has_corners { case::NO_ROOM } else { case::NO_CONTRAST });
        }
        let by_level =
            (0..after.levels.len()).map(|level| after.corners.iter().filter(|corner| corner.level == level).count());
        let by_level: Vec<String> = by_level.map(grouped).collect();
        let ones: u32 = after.described.iter().flat_map(|described| described.bits).map(u64::count_ones).sum();
        let share = f64::from(ones) / (BITS * after.described.len()) as f64;
        let step = step.put(features::KEYPOINTS, after.corners.len()).put(value::LEVELS, after.levels.len());
        let step = step.put(value::BY_LEVEL, by_level.join(", ")).put(value::ONES, 100.0 * share).say(case::END);
        let shares: usize = after.levels.iter().map(|level| level.share).sum();
        step.say(if after.corners.len() < shares { case::SOME_HAVE_FEWER } else { case::ALL_HAVE_MORE })
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
}

/// Puts a corner of a level with its response, and shows it.
fn put_corner(step: Step, level: &Level, place: u32) -> Step {
    let values = explain::around(&level.of.picture, level.place(place), 4);
    let step = step.fact(features::PIXEL, level.place(place)).fact(features::RESPONSE, level.response(place));
    step.show(Readout::Series(responses(level))).show(Readout::Tiles(vec![Tile::gray("Level", values)]))
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
    Series { is_sweep: true, ..Series::new("Harris response by rank", ["rank", "R / 1000"], shown, lines) }
}

/// The last bits as text, the newest on the right.
fn last_bits(bits: &[bool]) -> String {
    let last = &bits[bits.len().saturating_sub(16)..];
    // In fours, as a nibble is read.
    let fours = last.chunks(4).map(|four| four.iter().map(|bit| if *bit { '1' } else { '0' }).collect::<String>());
    fours.collect::<Vec<_>>().join(" ")
}
