//! The steps of SURF in values, words and formulas.

use super::charts::add_charts;
use super::hessian::{BALANCE, Filter, Layer, determinant};
use super::probe::{Described, Filtered, Probe, Searched};
use super::{Event, Maximum, State, Surf, case, features, line, value};
use crate::methods::differential::explain;
use crate::methods::features::haar::{Blob, SECTOR_RAD, dominant, sector_start};
use crate::methods::features::{Selection, be, unit_of_parts};
use crate::run::Seen;
use crate::scene::{Number, Readout, Role, Step, Tile, Value, Variable};

/// The symbols of the three filters.
const SYMBOLS: [&str; 3] = ["D_xx", "D_yy", "D_xy"];

impl Surf {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let step = match self.probe(seen) {
            None => Step::at(line::EACH_LAYER).say(case::OPENING),
            Some(Probe::Integral) => tell_sums(seen.before),
            Some(Probe::Filter(of)) => tell_filter(seen.before, &of),
            Some(Probe::Search(of)) => self.tell_search(seen, &of),
            Some(Probe::Choice(maxima)) => self.chosen(seen, maxima),
            Some(Probe::Keypoint(of)) => self.tell_description(seen, &of),
        };
        self.conclude(seen, step)
    }

    fn tell_search(&self, seen: &Seen<Self>, of: &Searched<'_>) -> Step {
        let [below, here, above] = of.layers;
        let at = |line| {
            let step = Step::at(line).fact(value::OCTAVE, of.octave + 1);
            let step = step.fact(value::SIDES, of.layers.map(|layer| layer.filter.size as f64));
            let step = step.put(value::SIDE_BELOW, below.filter.size).put(value::SIDE, here.filter.size);
            let step = step.put(value::SIDE_ABOVE, above.filter.size).fact_of(self.limit());
            let Some(sample) = of.sample else { return step };
            let response = here.responses[sample];
            let tile = |(label, layer): (&'static str, &Layer)| {
                Tile::new(label, explain::around(&layer.responses, sample, 1), [0.0, response.max(1.0)])
            };
            let tiles = ["R, layer below", "R", "R, layer above"].into_iter().zip(of.layers).map(tile).collect();
            let step = step.fact(features::PIXEL, here.pixel(sample)).fact(features::RESPONSE, response);
            step.show(Readout::Tiles(tiles))
        };
        let inked = |step: Step, sample, role| step.put_value(features::PIXEL.is(here.pixel(sample)).inked(role));
        match seen.events.last() {
            Some(Event::Compared(sample, None)) => inked(at(line::SUPPRESS), *sample, Role::Best).say(case::MAXIMUM),
            Some(Event::Compared(sample, Some((k, other)))) => {
                let layer = of.layers[*k];
                let step = inked(at(line::SUPPRESS), *sample, Role::Rejected);
                let step = step.put(features::NEIGHBOUR, layer.pixel(*other));
                let step = step.put(features::OTHER_RESPONSE, layer.responses[*other]).say(case::SUPPRESSED);
                step.say([case::OF_LAYER_BELOW, case::OF_ITS_LAYER, case::OF_LAYER_ABOVE][*k])
            }
            Some(Event::Refined(_, None)) => at(line::REFINE).say(case::NO_VERTEX),
            Some(Event::Refined(_, Some(refined))) => {
                let [x, y, layers] = refined.offset;
                let step = at(line::REFINE).put(value::OFFSET, [x, y]).put(value::LAYER_OFFSET, layers);
                let step = step.put(features::RESPONSE, refined.response).say(case::VERTEX);
                step.say(if refined.is_near() { case::ACCEPTED } else { case::TOO_FAR })
            }
            _ => {
                let count = here.responses.cells().iter().filter(|response| **response > self.threshold).count();
                let step = at(line::EACH_SAMPLE).put(value::SAMPLES, count);
                step.put(value::EXCEED, if count == 1 { "exceeds" } else { "exceed" }).say(case::ABOVE_THRESHOLD)
            }
        }
    }

    /// The threshold as it was set.
    fn limit(&self) -> Value {
        features::THRESHOLD.is(self.threshold)
    }

    /// Explains the selection of keypoints.
    fn chosen(&self, seen: &Seen<Self>, maxima: &[Maximum]) -> Step {
        let Selection { min_distance, max_points } = self.selection;
        let kept = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
        let at = |line| {
            let step = Step::at(line).fact(value::MAXIMA, maxima.len());
            let step = step.fact_of(features::KEPT.is(kept).inked(Role::Result)).put_value(self.limit());
            step.put(features::MIN_DISTANCE, min_distance).put(features::MAX_POINTS, max_points)
        };
        let Some(Event::Peak(index, near)) = seen.events.last() else {
            let step = at(line::EACH_PEAK).put(features::BE, be(maxima.len()));
            if !maxima.is_empty() {
                return step.say(case::RANKED);
            }
            let responses = seen.before.layers.iter().flat_map(|layer| layer.responses.cells());
            let largest = responses.fold(0.0, |most: f32, response| most.max(*response));
            let said = if largest > self.threshold { case::NO_MAXIMA } else { case::ALL_BELOW };
            return step.put(features::LARGEST_RESPONSE, largest).say(said);
        };
        let Maximum { octave, layer, refined, blob, .. } = maxima[*index];
        let (line, role) = if near.is_some() { (line::DROP_NEAR, Role::Rejected) } else { (line::KEEP, Role::Result) };
        let step = at(line).fact(features::POSITION, blob.at).fact(value::SCALE, blob.scale);
        let step = step.fact(value::OCTAVE, octave + 1).fact(value::SIDE, Filter::of(octave, layer).size);
        let step = step.fact(features::RESPONSE, refined.response);
        let step = step.put_value(features::POSITION.is(blob.at).inked(role));
        let Some(near) = near else { return step.say(case::KEPT) };
        let Maximum { refined, blob, .. } = maxima[*near];
        step.put(value::NEAR_KEYPOINT, blob.at).put(features::OTHER_RESPONSE, refined.response).say(case::NEAR)
    }

    fn tell_description(&self, seen: &Seen<Self>, of: &Described<'_>) -> Step {
        let last = seen.events.last();
        let line = match last {
            Some(Event::Wavelets) => line::WAVELETS,
            Some(Event::Sector(_)) => line::SECTOR,
            Some(Event::Subregion(_)) => line::SUBREGION,
            Some(Event::UnitLength(_)) => line::UNIT_LENGTH,
            _ => line::ORIENT,
        };
        let Blob { at, scale } = of.maximum.blob;
        let step = Step::at(line).fact(features::KEYPOINT, of.index + 1);
        let step = step.fact(features::KEYPOINTS, seen.before.kept().len());
        let step = step.fact(features::POSITION, at).fact(value::SCALE, scale);
        let step = step.fact_if(features::ORIENTATION, of.angle_rad.map(f32::to_degrees));
        let step = step.fact_if(value::LENGTH, of.length);
        let (best, _) = dominant(&of.sums);
        let length = |[x, y]: [f32; 2]| x.hypot(y);
        let longest = of.sums.get(best).copied().unwrap_or_default();
        let step = step.put(value::LONGEST, length(longest));
        let step = step.put(value::LONGEST_START, sector_start(best).to_degrees());
        let step = step.put(value::WAVELET_SIDE, 4.0 * scale).put(value::WHEEL_RADIUS, 6.0 * scale);
        add_charts(
            match last {
                Some(Event::Wavelets) => step.say(case::WAVELETS),
                Some(Event::Sector(sum)) => {
                    let k = of.sums.len() - 1;
                    let ends = [sector_start(k), sector_start(k) + SECTOR_RAD].map(f32::to_degrees);
                    let step = step.put(value::SECTOR_START, ends[0]).put(value::SECTOR_END, ends[1]);
                    let step = step.put(value::SECTOR_LENGTH, length(*sum)).say(case::SECTOR);
                    step.say(match best == k {
                        true if k == 0 => case::IS_FIRST,
                        true => case::IS_LONGEST,
                        false => case::IS_SHORTER,
                    })
                }
                Some(Event::Subregion([dx, dy, x, y])) => {
                    let step = step.put(value::SUBREGION, of.subregions.len()).put(value::SUM_X, *dx);
                    step.put(value::SUM_Y, *dy).put(value::SIZE_X, *x).put(value::SIZE_Y, *y).say(case::SUBREGION)
                }
                Some(Event::UnitLength(length)) => {
                    step.say(if *length > 0.0 { case::UNIT_LENGTH } else { case::ALL_ZERO })
                }
                _ => step.say(if self.upright { case::UPRIGHT } else { case::ORIENTED }),
            },
            of,
        )
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after.filter(|after| after.is_described()) else { return step };
        let kept = || after.kept().iter().map(|index| &after.maxima[*index]);
        let (Some(first), Some(last)) = (kept().next(), kept().next_back()) else { return step };
        let by_octave = (0..after.octaves).map(|octave| kept().filter(|maximum| maximum.octave == octave).count());
        let step = step.put(features::KEYPOINTS, after.kept().len()).put(value::MAXIMA, after.maxima.len());
        let step = step.put(features::FIRST_RESPONSE, first.refined.response);
        let step = step.put(features::LAST_RESPONSE, last.refined.response);
        let step = step.put(value::BY_OCTAVE, by_octave.collect::<Number>()).say(case::END);
        step.say(self.selection.advice(after.kept().len(), after.maxima.len()))
    }
}

fn tell_sums(state: &State) -> Step {
    let (width, height) = state.picture.size();
    let all: u64 = state.picture.luma().cells().iter().map(|level| u64::from(*level)).sum();
    let step = Step::at(line::INTEGRAL).fact(features::WIDTH, width).fact(features::HEIGHT, height);
    let step = step.fact(value::SUM, all as f64).put(value::COLUMNS, width + 1).put(value::ROWS, height + 1);
    step.say(case::SUMMED)
}

fn tell_filter(state: &State, of: &Filtered<'_>) -> Step {
    let lines = [line::DERIVE_XX, line::DERIVE_YY, line::DERIVE_XY, line::DETERMINANT];
    let Filter { size } = of.layer.filter;
    let step = Step::at(lines[of.part.min(3)]).fact(value::OCTAVE, of.octave + 1).fact(value::SIDE, size);
    let step = step.fact(value::SCALE, of.layer.filter.scale()).fact(value::SPACING, of.layer.step);
    let Some(sample) = of.sample else {
        return match SYMBOLS.get(of.part) {
            Some(symbol) => step.put(value::FILTER, *symbol).say(case::NO_FILTER),
            None => step.say(case::NO_DETERMINANT),
        };
    };
    let at = of.layer.pixel(sample);
    let derivatives = of.layer.filter.derivatives(of.integral, at);
    let all = DERIVATIVES.into_iter().zip(derivatives).take(of.part + 1);
    let step = all.fold(step.fact(features::PIXEL, at), |step, (of, derivative)| step.fact(of, derivative));
    let values = explain::around(state.picture.luma(), at, (size / 2).min(5));
    let step = step.show(Readout::Tiles(vec![Tile::gray("Frame t", values)]));
    match [case::ALONG_X, case::ALONG_Y, case::ALONG_BOTH].get(of.part) {
        Some(case) => boxes(step.say(case), of, at),
        None => tell_determinant(step, derivatives),
    }
}

/// The variables of the three filters.
const DERIVATIVES: [&Variable; 3] = [value::D_XX, value::D_YY, value::D_XY];

/// Writes the sum of the first box of a filter by its corners, and the filter by the sums of its boxes.
fn boxes(step: Step, of: &Filtered<'_>, at: (usize, usize)) -> Step {
    let (boxes, side) = (&of.layer.filter.boxes(at)[of.part], of.layer.filter.size);
    let Some((first, _)) = boxes.first() else { return step };
    let corners = [value::CORNER_A, value::CORNER_B, value::CORNER_C, value::CORNER_D];
    let corners = corners.into_iter().zip(of.integral.corners(*first));
    let mut step = corners.fold(step, |step, (of, corner)| step.put(of, corner)).put(value::AREA, side * side);
    let (mut terms, mut total) = (String::new(), 0.0);
    for (k, (of_box, weight)) in boxes.iter().enumerate() {
        let sum = of.integral.sum(*of_box);
        step = step.put([value::BOX_1, value::BOX_2, value::BOX_3, value::BOX_4][k], sum);
        total += f64::from(*weight) * f64::from(sum);
        terms += match weight {
            1.. if k == 0 => "",
            1.. => " + ",
            -1 => " - ",
            _ => r" - 2 \cdot ",
        };
        terms += &format!("{{box_{}}}", k + 1);
    }
    let (symbol, derivative) = (DERIVATIVES[of.part].symbol, SYMBOLS[of.part].to_lowercase());
    let step = step.put(value::BOXES, total);
    let step = step.formula("S_1 = D - B - C + A = {corner_d} - {corner_b} - {corner_c} + {corner_a} = {box_1}");
    step.formula(format!(
        r"{symbol} = \frac{{{terms}}}{{{{side}}^2}} = \frac{{{{boxes}}}}{{{{area}}}} = {{{derivative}}}"
    ))
}

/// Interprets the determinant and writes its formula.
fn tell_determinant(step: Step, derivatives: [f32; 3]) -> Step {
    let response = determinant(derivatives);
    let step = step.fact(features::RESPONSE, response).say(case::DETERMINANT).say(match () {
        () if response > 0.0 && derivatives[0] + derivatives[1] < 0.0 => case::IS_BRIGHT,
        () if response > 0.0 => case::IS_DARK,
        () => case::IS_NO_BLOB,
    });
    let product = |[xx, yy, xy]: [f64; 3]| xx * yy - (f64::from(BALANCE) * xy).powi(2);
    let unit = unit_of_parts(derivatives, response, product);
    let parts = DERIVATIVES.into_iter().zip(derivatives).map(|(of, part)| of.is(part).in_unit(unit));
    let step = parts.fold(step, Step::put_value).formula(r"R = D_{xx} D_{yy} - (0.9\,D_{xy})^2");
    step.formula(r"R = {d_xx} \cdot {d_yy} - (0.9 \cdot {d_xy})^2 = {response}")
}
