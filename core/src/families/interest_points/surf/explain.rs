//! The explanation and the drawing of SURF.

use std::sync::Arc;

use super::hessian::{BALANCE, Filter, LAYERS, Layer, Weighted, determinant};
use super::{Event, MIDDLE, Maximum, Part, State, Surf, case, features, line, value};
use crate::geometry::Grid;
use crate::methods::differential::explain;
use crate::methods::features::haar::{Blob, SECTOR_RAD, SIDE, WHEEL_REACH, dominant, sector_start, subregion_corners};
use crate::methods::features::integral::{Integral, PixelBox};
use crate::methods::features::{Selection, be, draw_keypoints, unit_of_parts};
use crate::run::Seen;
use crate::scene::{Number, Picture, Readout, Role, Scene, Series, Shape, Step, Tile, Value, Variable};

/// The symbols of the three filters.
const SYMBOLS: [&str; 3] = ["D_xx", "D_yy", "D_xy"];

/// The unit at work with what an explanation needs of it.
enum Probe<'a> {
    Integral,
    Filter(Filtered<'a>),
    Search(Searched<'a>),
    Choice(&'a Arc<Vec<Maximum>>),
    Keypoint(Described<'a>),
}

/// A layer and the pixel whose filters are shown.
struct Filtered<'a> {
    integral: &'a Integral,
    octave: usize,
    layer: &'a Arc<Layer>,
    /// The filter at work, 3 at the determinant.
    part: usize,
    /// A sample at which the filters fit, if there is one.
    sample: Option<(usize, usize)>,
}

/// A middle layer that is searched.
struct Searched<'a> {
    octave: usize,
    layers: [&'a Layer; 3],
    /// The sample at work.
    sample: Option<(usize, usize)>,
}

/// A keypoint that is described.
struct Described<'a> {
    index: usize,
    maximum: &'a Maximum,
    sums: Vec<[f32; 2]>,
    angle_rad: Option<f32>,
    subregions: Vec<[f32; 4]>,
    length: Option<f32>,
}

impl Surf {
    fn probe<'a>(&self, seen: &'a Seen<Self>) -> Option<Probe<'a>> {
        let state = seen.before;
        seen.events.last()?;
        match state.part() {
            Part::Integral => Some(Probe::Integral),
            Part::Layer(index) => {
                let layer = seen.events.iter().find_map(|event| match event {
                    Event::Filtered(layer) => Some(layer),
                    _ => None,
                })?;
                let fits = |sample: &(usize, usize)| layer.fits(*sample, state.picture.size());
                let pointed = seen.point().and_then(|at| layer.nearest(at)).filter(fits);
                let sample = pointed.or_else(|| layer.strongest());
                let (octave, part) = (index / LAYERS, seen.events.len() - 1);
                Some(Probe::Filter(Filtered { integral: state.integral.as_ref()?, octave, layer, part, sample }))
            }
            Part::Search(index) => {
                let sample = seen.events.iter().rev().find_map(|event| match event {
                    Event::Compared(sample, _) | Event::Refined(sample, _) => Some(*sample),
                    _ => None,
                });
                Some(Probe::Search(Searched { octave: index / MIDDLE, layers: state.three(index)?, sample }))
            }
            Part::Choice => seen.events.iter().find_map(|event| match event {
                Event::Ranked(maxima) => Some(Probe::Choice(maxima)),
                _ => None,
            }),
            Part::Keypoint(index) => Some(Probe::Keypoint(described(seen, index, state.keypoint(index)?))),
        }
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let step = match self.probe(seen) {
            None => Step::at(line::EACH_LAYER).say(case::OPENING),
            Some(Probe::Integral) => summed(seen.before),
            Some(Probe::Filter(of)) => filtered(seen.before, &of),
            Some(Probe::Search(of)) => self.searched(seen, &of),
            Some(Probe::Choice(maxima)) => self.chosen(seen, maxima),
            Some(Probe::Keypoint(of)) => self.described(seen, &of),
        };
        self.concluded(seen, step)
    }

    /// Explains the search of a layer.
    fn searched(&self, seen: &Seen<Self>, of: &Searched<'_>) -> Step {
        let [below, here, above] = of.layers;
        let at = |line| {
            let step = Step::at(line).fact(value::OCTAVE, of.octave + 1);
            let step = step.fact(value::SIDES, of.layers.map(|layer| layer.filter.size as f64));
            let step = step.put(value::SIDE_BELOW, below.filter.size).put(value::SIDE, here.filter.size);
            let step = step.put(value::SIDE_ABOVE, above.filter.size).fact_of(self.limit());
            let Some(sample) = of.sample else { return step };
            let response = here.responses[sample];
            let tile = |(label, layer): (&'static str, &Layer)| {
                let values = explain::around(&layer.responses, sample, 1);
                Tile { label, role: None, values, range: [0.0, response.max(1.0)], framed: Vec::new() }
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

    /// Explains the description of a keypoint.
    fn described(&self, seen: &Seen<Self>, of: &Described<'_>) -> Step {
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
        charted(
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

    /// Adds the conclusion at the end of a run.
    fn concluded(&self, seen: &Seen<Self>, step: Step) -> Step {
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

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        if let Some(done) = seen.after.filter(|after| after.is_described()) {
            return draw_keypoints(&done.features(), scene);
        }
        match self.probe(seen) {
            None => {}
            Some(Probe::Integral) => {
                let (width, height) = state.picture.size();
                draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
                scene.legend(Role::Window, "summed area");
            }
            Some(Probe::Filter(of)) => draw_filter(state, &of, scene),
            Some(Probe::Search(of)) => draw_search(seen, &of, scene),
            Some(Probe::Choice(maxima)) => draw_choice(seen, maxima, scene),
            Some(Probe::Keypoint(of)) => draw_keypoint(seen, &of, scene),
        }
    }
}

/// The keypoint at work as far as its events tell.
fn described<'a>(seen: &Seen<Surf>, index: usize, maximum: &'a Maximum) -> Described<'a> {
    let mut of = Described { index, maximum, sums: Vec::new(), angle_rad: None, subregions: Vec::new(), length: None };
    for event in seen.events {
        match event {
            Event::Sector(sum) => of.sums.push(*sum),
            Event::Oriented(angle_rad) => of.angle_rad = Some(*angle_rad),
            Event::Subregion(sums) => of.subregions.push(*sums),
            Event::UnitLength(length) => of.length = Some(*length),
            _ => {}
        }
    }
    of
}

fn summed(state: &State) -> Step {
    let (width, height) = state.picture.size();
    let all: u64 = state.picture.luma().cells().iter().map(|level| u64::from(*level)).sum();
    let step = Step::at(line::INTEGRAL).fact(features::WIDTH, width).fact(features::HEIGHT, height);
    let step = step.fact(value::SUM, all as f64).put(value::COLUMNS, width + 1).put(value::ROWS, height + 1);
    step.say(case::SUMMED)
}

/// Explains a filter at a pixel.
fn filtered(state: &State, of: &Filtered<'_>) -> Step {
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
    let tile = Tile { label: "Frame t", role: None, values, range: [0.0, 255.0], framed: Vec::new() };
    let step = step.show(Readout::Tiles(vec![tile]));
    match [case::ALONG_X, case::ALONG_Y, case::ALONG_BOTH].get(of.part) {
        Some(case) => boxes(step.say(case), of, at),
        None => multiplied(step, derivatives),
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

/// Says what the determinant shows, and writes it.
fn multiplied(step: Step, derivatives: [f32; 3]) -> Step {
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

/// Adds the charts of a keypoint.
fn charted(step: Step, of: &Described<'_>) -> Step {
    if of.subregions.is_empty() {
        return if of.sums.is_empty() { step } else { step.show(Readout::Series(wheel_series(of))) };
    }
    let most = of.subregions.iter().flatten().fold(1.0f32, |most, value| most.max(value.abs()));
    let tile = |(i, label): (usize, &'static str)| {
        let value = |x: usize, y: usize| {
            of.subregions.get(y * SIDE + x).map_or(f32::NAN, |sums| (10.0 * sums[i]).round() / 10.0)
        };
        Tile { label, role: None, values: Grid::from_fn(SIDE, SIDE, value), range: [-most, most], framed: Vec::new() }
    };
    let tiles = ["Σ dx", "Σ dy", "Σ |dx|", "Σ |dy|"].into_iter().enumerate().map(tile).collect();
    step.show(Readout::Series(descriptor_series(of))).show(Readout::Tiles(tiles))
}

/// The entries of the descriptor so far, four for each subregion.
fn descriptor_series(of: &Described<'_>) -> Series {
    let (scale, y_label) = match of.length.filter(|length| *length > 0.0) {
        Some(length) => (1.0 / length, "entry of length 1"),
        None => (1.0, "sum, gray levels"),
    };
    let entries = of.subregions.iter().flatten().map(|sum| sum * scale);
    Series {
        title: "Descriptor",
        x_label: "entry, 4 for each subregion",
        y_label,
        x_max: 4 * SIDE * SIDE,
        x_ticks: (0..=SIDE).map(|row| (row * 4 * SIDE).max(1) as f32).collect(),
        sections: Series::cells(SIDE, 4),
        columns: Some(SIDE),
        lines: vec![("entries", Role::Result, Series::bars(entries))],
        is_sweep: true,
        ..Series::default()
    }
}

/// The length of the sums over the direction of the sector.
fn wheel_series(of: &Described<'_>) -> Series {
    let point = |(k, [x, y]): (usize, &[f32; 2])| [sector_start(k).to_degrees(), x.hypot(*y)];
    let points: Vec<[f32; 2]> = of.sums.iter().enumerate().map(point).collect();
    let best = points[dominant(&of.sums).0];
    Series {
        title: "Sum of the wavelet responses in a sector",
        x_label: "first direction of the sector, degrees",
        y_label: "length, gray levels",
        x_max: 360,
        lines: vec![("sector of 60°", Role::Candidate, points), ("longest", Role::Result, vec![best])],
        is_sweep: true,
        ..Series::default()
    }
}

fn draw_box(scene: &mut Scene, PixelBox { min, max }: PixelBox, role: Role) {
    let size = [max[0] - min[0], max[1] - min[1]].map(|side| side as usize);
    scene.mark(Picture::CURRENT, role, Shape::pixels(min[0], min[1], size[0], size[1]));
}

/// Draws the boxes of a filter, the corners of the first, and in the end the responses of the layer.
fn draw_filter(state: &State, of: &Filtered<'_>, scene: &mut Scene) {
    if of.part >= 3 {
        draw_responses(state, of.layer, scene);
    }
    let Some(sample) = of.sample else {
        let (width, height) = state.picture.size();
        draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
        scene.legend(Role::Window, "filtered picture");
        return;
    };
    let at = of.layer.pixel(sample);
    let side = of.layer.filter.size;
    let half = side as i32 / 2;
    scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(at.0 as i32 - half, at.1 as i32 - half, side, side));
    scene.legend(Role::Window, "filter of side L");
    if let Some(boxes) = of.layer.filter.boxes(at).get(of.part) {
        for (of_box, weight) in boxes {
            let (role, meaning) = match weight {
                1.. => (Role::Best, "box of weight 1"),
                -1 => (Role::Error, "box of weight −1"),
                _ => (Role::Error, "box of weight −2"),
            };
            draw_box(scene, *of_box, role);
            scene.legend(role, meaning);
        }
        draw_corners(boxes, scene);
    }
    scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(at.0 as i32, at.1 as i32, 1, 1));
    scene.legend(Role::Reference, "inspected pixel");
}

/// Draws the corners of the first box, at which the integral image is read.
fn draw_corners(boxes: &[Weighted], scene: &mut Scene) {
    let Some((PixelBox { min, max }, _)) = boxes.first() else { return };
    let edge = |c: i32| c as f32 - 0.5;
    let corners =
        [[min[0], min[1]], [max[0], min[1]], [min[0], max[1]], [max[0], max[1]]].map(|corner| corner.map(edge));
    scene.mark(Picture::CURRENT, Role::Result, Shape::Points(corners.to_vec()));
    scene.legend(Role::Result, "corners read for the first box");
    for (at, name) in corners.into_iter().zip(["A", "B", "C", "D"]) {
        scene.mark(Picture::CURRENT, Role::Result, Shape::Text { at, text: name.into() });
    }
}

fn draw_responses(state: &State, layer: &Layer, scene: &mut Scene) {
    let (width, height) = state.picture.size();
    let value = |x: usize, y: usize| {
        let response = layer.responses[(x / layer.step, y / layer.step)];
        if response > 0.0 { response.sqrt() } else { f32::NAN }
    };
    let values = Grid::from_fn(width, height, value);
    if values.cells().iter().any(|value| value.is_finite()) {
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
        scene.heat = Some("√R");
    }
}

/// The circle of a blob: its radius is that of a disc with the largest response at its scale.
fn circle(Blob { at, scale }: Blob) -> Shape {
    Shape::Ellipse { center: at, radii: [scale * std::f32::consts::SQRT_2; 2], angle_rad: 0.0 }
}

fn draw_search(seen: &Seen<Surf>, of: &Searched<'_>, scene: &mut Scene) {
    let [_, here, _] = of.layers;
    draw_responses(seen.before, here, scene);
    let at = |sample: (usize, usize)| {
        let (x, y) = here.pixel(sample);
        [x as f32, y as f32]
    };
    let samples = |is_maximum: bool| {
        let compared = seen.events.iter().filter_map(move |event| match event {
            Event::Compared(sample, by) if by.is_none() == is_maximum => Some(*sample),
            _ => None,
        });
        compared.map(at).collect::<Vec<_>>()
    };
    for (role, meaning, points) in [
        (Role::Rejected, "suppressed (non-maximum)", samples(false)),
        (Role::Best, "maximum over position and scale", samples(true)),
    ] {
        if !points.is_empty() {
            scene.mark(Picture::CURRENT, role, Shape::Points(points));
            scene.legend(role, meaning);
        }
    }
    let (width, height) = seen.before.picture.size();
    let side = here.filter.size;
    match of.sample {
        Some(sample) => {
            let (x, y) = here.pixel(sample);
            let half = side as i32 / 2;
            scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x as i32 - half, y as i32 - half, side, side));
            scene.legend(Role::Window, "filter of side L");
        }
        None => {
            draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
            scene.legend(Role::Window, "searched picture");
        }
    }
}

fn draw_choice(seen: &Seen<Surf>, maxima: &[Maximum], scene: &mut Scene) {
    let mut is_kept = vec![None; maxima.len()];
    for event in seen.events {
        if let Event::Peak(index, near) = event {
            is_kept[*index] = Some(near.is_none());
        }
    }
    let of_status = |status: Option<bool>| {
        let all = maxima.iter().zip(&is_kept).filter(move |(_, other)| **other == status);
        all.map(|(maximum, _)| maximum.blob)
    };
    // Circles of all maxima would hide those that are kept.
    for (status, role, meaning) in [
        (None, Role::Candidate, "maximum, not yet tested"),
        (Some(false), Role::Rejected, "rejected by the minimum distance"),
    ] {
        let points: Vec<_> = of_status(status).map(|blob| blob.at).collect();
        if !points.is_empty() {
            scene.mark(Picture::CURRENT, role, Shape::Points(points));
            scene.legend(role, meaning);
        }
    }
    for blob in of_status(Some(true)) {
        scene.mark(Picture::CURRENT, Role::Result, circle(blob));
        scene.legend(Role::Result, "keypoint, radius √2 s");
    }
    if let Some(Event::Peak(index, _)) = seen.events.last() {
        scene.mark(Picture::CURRENT, Role::Reference, circle(maxima[*index].blob));
        scene.legend(Role::Reference, "maximum of this step");
    }
    if maxima.is_empty() {
        let (width, height) = seen.before.picture.size();
        draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
        scene.legend(Role::Window, "searched picture");
    }
}

fn draw_keypoint(seen: &Seen<Surf>, of: &Described<'_>, scene: &mut Scene) {
    let (state, blob) = (seen.before, of.maximum.blob);
    let others: Vec<_> =
        (0..of.index).filter_map(|index| state.keypoint(index)).map(|maximum| maximum.blob.at).collect();
    if !others.is_empty() {
        scene.mark(Picture::CURRENT, Role::Best, Shape::Points(others));
        scene.legend(Role::Best, "described keypoint");
    }
    scene.mark(Picture::CURRENT, Role::Reference, circle(blob));
    scene.legend(Role::Reference, "keypoint, radius √2 s");
    match of.angle_rad {
        None => draw_wheel(of, scene),
        Some(angle_rad) => {
            draw_subregions(of, angle_rad, scene);
            let reach = 10.0 * blob.scale;
            let tip = [blob.at[0] + reach * angle_rad.cos(), blob.at[1] + reach * angle_rad.sin()];
            scene.mark(Picture::CURRENT, Role::Result, Shape::Path { points: vec![blob.at, tip], closed: false });
            scene.legend(Role::Result, "orientation");
        }
    }
}

/// Draws the disc of the wavelets and the present sector with its sum.
fn draw_wheel(of: &Described<'_>, scene: &mut Scene) {
    let Blob { at: [x, y], scale } = of.maximum.blob;
    let radius = WHEEL_REACH as f32 * scale;
    scene.mark(Picture::CURRENT, Role::Window, Shape::Ellipse { center: [x, y], radii: [radius; 2], angle_rad: 0.0 });
    scene.legend(Role::Window, "samples within 6 s");
    let Some(k) = of.sums.len().checked_sub(1) else { return };
    let on_circle = |angle_rad: f32| [x + radius * angle_rad.cos(), y + radius * angle_rad.sin()];
    let arc = (0..=12).map(|i| on_circle(sector_start(k) + SECTOR_RAD * i as f32 / 12.0));
    let points = [[x, y]].into_iter().chain(arc).collect();
    scene.mark(Picture::CURRENT, Role::Candidate, Shape::Path { points, closed: true });
    scene.legend(Role::Candidate, "sector of 60°");
    let longest = of.sums.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f32::max);
    if longest > 0.0 {
        let tip = |[dx, dy]: [f32; 2]| [x + radius * dx / longest, y + radius * dy / longest];
        let best = of.sums[dominant(&of.sums).0];
        for (role, meaning, sum) in
            [(Role::Measured, "sum of the sector", of.sums[k]), (Role::Estimate, "longest sum", best)]
        {
            scene.mark(Picture::CURRENT, role, Shape::Path { points: vec![[x, y], tip(sum)], closed: false });
            scene.legend(role, meaning);
        }
    }
}

/// Draws the subregions of the descriptor with their sums.
fn draw_subregions(of: &Described<'_>, angle_rad: f32, scene: &mut Scene) {
    let blob = of.maximum.blob;
    let longest = of.subregions.iter().map(|[x, y, ..]| x.hypot(*y)).fold(0.0, f32::max);
    let (sin, cos) = angle_rad.sin_cos();
    let corners: Vec<_> = (0..SIDE * SIDE).flat_map(|k| subregion_corners(blob, angle_rad, k)).collect();
    let ends = |pick: fn(f32, f32) -> f32, start: f32| [0, 1].map(|i| corners.iter().map(|at| at[i]).fold(start, pick));
    scene.work = Some([ends(f32::min, f32::INFINITY), ends(f32::max, f32::NEG_INFINITY)]);
    for k in 0..SIDE * SIDE {
        let points = subregion_corners(blob, angle_rad, k);
        let middle = [0, 1].map(|axis| (points[0][axis] + points[2][axis]) / 2.0);
        let is_current = of.subregions.len() == k + 1 && of.length.is_none();
        let role = if is_current { Role::Candidate } else { Role::Window };
        scene.mark(Picture::CURRENT, role, Shape::Path { points, closed: true });
        let Some([dx, dy, ..]) = of.subregions.get(k).filter(|_| longest > 0.0) else { continue };
        let [u, v] = [dx, dy].map(|sum| sum * 2.5 * blob.scale / longest);
        let tip = [middle[0] + cos * u - sin * v, middle[1] + sin * u + cos * v];
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Path { points: vec![middle, tip], closed: false });
        scene.legend(Role::Measured, "sums Σ dx, Σ dy of a subregion");
    }
    scene.legend(Role::Window, "subregions of 5 s");
}
