//! The steps of corner detection in values, words and charts.

use super::corners::{Corners, Event, Measure};
use super::declare::{Status, be, case, line, value};
use super::eigenvalues::{self, Pixel};
use super::scan::Stage;
use super::select::{Selection, Settings};
use crate::base::words::{further_digits, pixel};
use crate::geometry::Grid;
use crate::methods::differential::{Tensor, explain};
use crate::run::Seen;
use crate::scene::{Picture, Readout, Role, Step, Surface, Tile, Unit};

pub(crate) fn point((x, y): (usize, usize)) -> [f32; 2] {
    [x as f32, y as f32]
}

/// The inspected pixel with its structure tensor and response.
pub(super) struct Probe {
    pub place: (usize, usize),
    /// Whether it is the pixel pointed at rather than the current one.
    pub is_pointed_at: bool,
    pub tensor: Tensor,
    pub response: f32,
    /// Below this eigenvalue, noise alone may be the gradient.
    pub flat: f32,
}

/// The unit of the parts of a formula: that of responses, with the fewest further decimals with which the numbers as they are written
/// give `result` as it is written.
pub(crate) fn unit_of_parts<const N: usize>(parts: [f32; N], result: f32, formula: impl Fn([f64; N]) -> f64) -> Unit {
    let further = further_digits(|further| {
        let unit = Unit::RESPONSE.finer(*further as u8);
        let written = parts.map(|part| value::RESPONSE.is(part).in_unit(unit).rounded().unwrap_or(f64::NAN));
        value::RESPONSE.is(formula(written)).bare() == value::RESPONSE.is(result).bare()
    });
    Unit::RESPONSE.finer(further as u8)
}

/// Interprets the eigenvalues of a pixel and its response; with both eigenvalues below `flat` it lies in a flat area.
pub(super) fn meaning<M: Measure>(of: &M, step: Step, eigenvalues: [f32; 2], (response, flat): (f32, f32)) -> Step {
    let nature = match () {
        () if eigenvalues[0] < flat => 0,
        () if !of.is_corner(eigenvalues, response) => 1,
        () => 2,
    };
    let step = step.put(value::RESPONSE, response).put(value::FLAT_LIMIT, flat);
    step.say(M::MEANING[nature]).say([case::FLAT, case::EDGE, case::CORNER][nature])
}

impl<M: Measure> Corners<M> {
    /// Returns the pixel pointed at, or else the current one.
    pub(super) fn probe(&self, seen: &Seen<Self>) -> Option<Probe> {
        let state = seen.before;
        let at_work = match seen.events.last()? {
            Event::Response(_) => (seen.events.len() - 1, state.scan.row),
            Event::Row => (0, state.scan.row),
            Event::Over(place, _) => *place,
            Event::Ranked => state.scan.strongest()?,
            Event::Peak(peak, _) => state.scan.place(*peak),
        };
        let place = seen.point().and_then(|point| state.scan.map.cell_at(point)).unwrap_or(at_work);
        let is_pointed_at = place != at_work;
        let tensors = self.tensors(state);
        let (tensor, flat) = (tensors.at(place), tensors.flat_below());
        let of_tensor = || self.0.response([tensor.xx, tensor.xy, tensor.yy]);
        Some(Probe { place, is_pointed_at, tensor, response: response(seen, place).unwrap_or_else(of_tensor), flat })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last() else { return Step::at(line::TAKE_DERIVATIVES).say(case::OPENING) };
        let Some(probe) = self.probe(seen) else {
            return Step::at(line::EACH_PEAK).fact(value::LOCAL_MAXIMA, 0).say(case::NO_MAXIMA);
        };
        let at_work = match last {
            Event::Response(_) => line::RESPOND,
            Event::Row => line::EACH_STRONG,
            Event::Over(..) => line::SUPPRESS,
            Event::Ranked => line::EACH_PEAK,
            Event::Peak(_, Some(_)) => line::DROP_NEAR,
            Event::Peak(_, None) => line::KEEP,
        };
        let status = (seen.before.scan.stage != Stage::Response).then(|| self.status(seen, probe.place));
        // Sentence, numbers and line refer to one pixel.
        let line = match &status {
            Some(status) if probe.is_pointed_at => status.line,
            None if probe.is_pointed_at => line::RESPOND,
            _ => at_work,
        };
        let step = self.put_pixel(seen, Step::at(line), (&probe, status.as_ref()));
        let step = match (last, status) {
            (_, Some(status)) if probe.is_pointed_at => status.say(self.responds(step, &probe)),
            (Event::Response(_), _) | (_, None) => self.responds(step, &probe),
            (Event::Row, _) => self.strong(seen, step),
            (Event::Over(_, by), _) => {
                over(seen, step.put_value(value::PIXEL.is(probe.place).inked(role_of(*by))), *by)
            }
            (Event::Ranked, _) => step.say(case::RANKED),
            (Event::Peak(_, near), _) => chosen(seen, step, (probe.place, *near)),
        };
        let step = if probe.is_pointed_at { step } else { self.conclude(seen, step) };
        self.add_charts(seen, step, &probe)
    }

    /// Puts tensor and response of a pixel, the limits of the selection and the outcome for the pixel.
    fn put_pixel(&self, seen: &Seen<Self>, step: Step, (probe, status): (&Probe, Option<&Status>)) -> Step {
        let (state, Tensor { xx, xy, yy, .. }) = (seen.before, probe.tensor);
        let Settings { threshold, selection: Selection { max_points, min_distance }, .. } = self.0.settings();
        let [large, small] = probe.tensor.eigenvalues();
        let step = step.fact(value::PIXEL, probe.place).fact(value::TENSOR, [xx, xy, yy]);
        let step = step.fact(value::LAMBDA_1, large).fact(value::LAMBDA_2, small).fact(value::RESPONSE, probe.response);
        let step = step.formula(
            r"\mathbf{T} = \begin{pmatrix} \sum w\,I_x^2 & \sum w\,I_x I_y \\ \sum w\,I_x I_y & \sum w\,I_y^2 \end{pmatrix}",
        );
        let step = self.0.formulas(step, [xx, xy, yy]);
        let Some(status) = status else { return step };
        let step = step.fact(value::THRESHOLD, self.peaks(state).limit).fact(value::STATUS, status.words);
        let step = step.put(value::QUALITY, 100.0 * threshold).put(value::LARGEST_RESPONSE, state.largest);
        let (step, maxima) = (step.put(value::ROW, state.scan.row), state.scan.peaks.len());
        let step = step.put(value::LOCAL_MAXIMA, maxima).put(value::BE, be(maxima));
        step.put(value::MAX_POINTS, max_points).put(value::MIN_DISTANCE, min_distance)
    }

    /// Explains eigenvalues and response of a pixel.
    fn responds(&self, step: Step, probe: &Probe) -> Step {
        let step = step.say(case::EIGENVALUES);
        meaning(&self.0, step, probe.tensor.eigenvalues(), (probe.response, probe.flat))
    }

    /// Explains which responses of a row reach the threshold.
    fn strong(&self, seen: &Seen<Self>, step: Step) -> Step {
        let (row, count) = (seen.before.scan.row, self.peaks(seen.before).over(seen.before.scan.row).count());
        match count {
            0 if row == 0 || row + 1 == seen.before.scan.map.height() => step.say(case::BORDER),
            0 => step.say(case::ALL_BELOW),
            _ => step.put(value::RESPONSES, count).put(value::BE, be(count)).say(case::REACHED),
        }
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after.filter(|_| seen.before.scan.stage == Stage::Choice) else { return step };
        let (Some(first), Some(last)) = (after.scan.kept.first(), after.scan.kept.last()) else { return step };
        let response = |index: u32| after.scan.map[after.scan.place(index)];
        let step = step.put(value::KEPT, after.scan.kept.len()).put(value::LOCAL_MAXIMA, after.scan.peaks.len());
        let step = step.put(value::FIRST_RESPONSE, response(*first)).put(value::LAST_RESPONSE, response(*last));
        let step = step.say(if after.scan.kept.len() == 1 { case::END_WITH_ONE } else { case::END });
        step.say(self.0.settings().selection.advice(after.scan.kept.len(), after.scan.peaks.len()))
    }

    /// Adds the charts of a pixel.
    fn add_charts(&self, seen: &Seen<Self>, step: Step, probe: &Probe) -> Step {
        let (state, place) = (seen.before, probe.place);
        let radius = (self.0.settings().window / 2 + 1).min(5);
        let mut tiles = vec![Tile::gray("Frame t", explain::around(state.scan.picture.luma(), place, radius))];
        let threshold = (state.scan.stage != Stage::Response).then(|| self.peaks(state).limit);
        if threshold.is_some() {
            let shown = explain::around(&state.scan.map.map(|response| M::shown(*response)), place, radius);
            tiles.push(Tile::positive("Response, compressed", shown));
        }
        let eigenvalues = probe.tensor.eigenvalues();
        let inspected = Pixel { name: pixel(place), eigenvalues, threshold, flat: probe.flat };
        let step = step.show(Readout::Regions(eigenvalues::regions(&self.0, inspected))).show(Readout::Tiles(tiles));
        step.show_all(hills(seen, place).map(Readout::Landscape))
    }

    /// Returns the outcome for a pixel after the response stage.
    fn status(&self, seen: &Seen<Self>, place: (usize, usize)) -> Status {
        let (state, peaks) = (seen.before, self.peaks(seen.before));
        let status = |line, words, case, by| Status { line, words, case, by };
        if !peaks.is_over(place.0, place.1) {
            let (width, height) = state.scan.map.size();
            let is_border = place.0 == 0 || place.1 == 0 || place.0 + 1 == width || place.1 + 1 == height;
            let why = if is_border { "image border, no local maximum" } else { "below the threshold" };
            return status(line::EACH_STRONG, why, case::HAS_STATUS, None);
        }
        if let Some(by) = peaks.suppressed_by(place) {
            return status(line::SUPPRESS, "suppressed", case::HAS_NEIGHBOUR, Some(by));
        }
        let index = (place.1 * state.scan.map.width() + place.0) as u32;
        let choice = seen.events.iter().find_map(|event| match event {
            Event::Peak(peak, near) if *peak == index => Some(*near),
            _ => None,
        });
        match choice {
            Some(None) => status(line::KEEP, "corner", case::HAS_STATUS, None),
            Some(Some(near)) => {
                status(line::DROP_NEAR, "local maximum, rejected", case::HAS_NEAR, Some(state.scan.place(near)))
            }
            None if seen.after.is_some() && state.scan.stage == Stage::Choice => {
                status(line::KEEP, "local maximum", case::IS_BEYOND, None)
            }
            None => status(line::SUPPRESS, "local maximum", case::HAS_STATUS, None),
        }
    }
}

/// The response of a pixel, if it has been computed.
pub(super) fn response<M: Measure>(seen: &Seen<Corners<M>>, (x, y): (usize, usize)) -> Option<f32> {
    let state = seen.before;
    match (state.scan.stage, seen.events.get(x)) {
        (Stage::Response, Some(Event::Response(response))) if y == state.scan.row => Some(*response),
        (Stage::Response, _) if y >= state.scan.row => None,
        _ => state.scan.map.get(x, y).copied(),
    }
}

/// The responses computed so far around a pixel, compressed as on the map.
fn hills<M: Measure>(seen: &Seen<Corners<M>>, place: (usize, usize)) -> Option<Surface> {
    /// How far they reach to each side, in px.
    const REACH: usize = 20;
    let (width, height) = seen.before.scan.map.size();
    let at = |i: usize, from: usize| (from + i).checked_sub(REACH);
    let value = |i, j| {
        let (x, y) = (at(i, place.0)?, at(j, place.1)?);
        if x < width && y < height { response(seen, (x, y)) } else { None }
    };
    let side = 2 * REACH + 1;
    let values = Grid::from_fn(side, side, |i, j| value(i, j).map_or(f32::NAN, M::shown));
    let surface = Surface::over_picture((M::SHOWN, ""), (Picture::CURRENT, point(place), 1.0), values);
    surface.range()?;
    Some(Surface { is_similarity: true, probe: Some([0; 2]), ..surface })
}

/// The role of a pixel that reaches the threshold; `by` is the neighbour that suppresses it.
fn role_of(by: Option<(usize, usize)>) -> Role {
    if by.is_some() { Role::Rejected } else { Role::Best }
}

/// Explains the non-maximum suppression of a pixel; `by` is the neighbour that suppresses it.
fn over<M: Measure>(seen: &Seen<Corners<M>>, step: Step, by: Option<(usize, usize)>) -> Step {
    let Some(by) = by else { return step.say(case::MAXIMUM) };
    let other = seen.before.scan.map[by];
    let is_larger = f64::from(other) > step.real(value::RESPONSE);
    let step = step.put(value::NEIGHBOUR, by).put(value::OTHER_RESPONSE, other).say(case::SUPPRESSED);
    step.say(if is_larger { case::BY_LARGER } else { case::BY_EQUAL })
}

/// Explains the selection of a local maximum; `near` is the corner that rejects it.
fn chosen<M: Measure>(seen: &Seen<Corners<M>>, step: Step, (place, near): ((usize, usize), Option<u32>)) -> Step {
    let role = if near.is_some() { Role::Rejected } else { Role::Result };
    let step = step.put_value(value::PIXEL.is(place).inked(role)).say(case::TESTED);
    let Some(near) = near else {
        let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
        return step.put(value::KEPT, count).say(case::KEPT_AS);
    };
    let near = seen.before.scan.place(near);
    let other = seen.before.scan.map[near];
    let is_larger = f64::from(other) > step.real(value::RESPONSE);
    let step = step.put(value::NEAR_CORNER, near).put(value::OTHER_RESPONSE, other).say(case::IS_NEAR);
    step.say(if is_larger { case::TO_LARGER } else { case::TO_EQUAL })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_has_the_digits_that_make_it_true() {
        let decimals = |parts: [f32; 2]| {
            let unit = unit_of_parts(parts, parts[0] + parts[1], |[a, b]| a + b);
            parts.map(|part| value::RESPONSE.is(part).in_unit(unit).bare())
        };
        assert_eq!(decimals([54.28, -7.16]), ["54.28", "−7.16"]);
        assert_eq!(decimals([54.2834, 7.1634]), ["54.283", "7.163"], "54.28 + 7.16 = 61.44, but the sum is 61.4468");
    }
}
