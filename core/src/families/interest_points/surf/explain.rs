//! The explanation and the drawing of SURF.

use std::sync::Arc;

use super::hessian::{BALANCE, Filter, LAYERS, Layer, Neighbor, Refined, Weighted, determinant};
use super::{Event, MIDDLE, Maximum, Part, State, Surf, line};
use crate::base::words::{counted, grouped, pixel, place};
use crate::geometry::Grid;
use crate::methods::differential::{explain, numbers};
use crate::methods::features::draw_keypoints;
use crate::methods::features::haar::{Blob, SECTOR_RAD, SIDE, WHEEL_REACH, dominant, sector_start, subregion_corners};
use crate::methods::features::integral::{Integral, PixelBox};
use crate::run::Seen;
use crate::scene::{Fact, Math, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

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

    /// Why there are no keypoints.
    fn none_said(&self, state: &State) -> String {
        let responses = state.layers.iter().flat_map(|layer| layer.responses.cells());
        let largest = responses.fold(0.0, |most: f32, response| most.max(*response));
        match largest > self.threshold {
            true => "0 samples above the threshold are a maximum among their 26 neighbours, so there are no keypoints: the frame has no blobs \
                     of these sizes."
                .into(),
            false => format!(
                "The largest response is R = {}, and a keypoint needs more than the threshold R = {}, so there are no keypoints: the frame \
                 has too little contrast. A lower threshold finds weaker ones.",
                numbers::gray(largest),
                numbers::gray(self.threshold)
            ),
        }
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let (line, sentence, readouts) = match self.probe(seen) {
            None => (line::EACH_LAYER, introduction(), Vec::new()),
            Some(Probe::Integral) => (line::INTEGRAL, summed(seen.before), integral_facts(seen.before)),
            Some(Probe::Filter(of)) => {
                let (line, sentence) = filtered(&of);
                (line, sentence, readouts_of_filter(seen.before, &of))
            }
            Some(Probe::Search(of)) => {
                let (line, sentence) = self.searched(seen, &of);
                (line, sentence, self.readouts_of_search(&of))
            }
            Some(Probe::Choice(maxima)) => {
                let (line, sentence) = self.chosen(seen, maxima);
                (line, sentence, readouts_of_choice(seen, maxima))
            }
            Some(Probe::Keypoint(of)) => {
                let (line, sentence) = self.described(seen, &of);
                (line, sentence, readouts_of_keypoint(seen.before, &of))
            }
        };
        Step { line, sentence: self.concluded(seen, sentence), readouts }
    }

    fn searched(&self, seen: &Seen<Self>, of: &Searched<'_>) -> (Name, Sentence) {
        let said = Sentence::default();
        let [below, here, above] = of.layers;
        let response = |(k, sample): Neighbor| numbers::gray(of.layers[k].responses[sample]);
        match seen.events.last() {
            Some(Event::Compared(sample, Some(by))) => {
                let which = match by.0 {
                    0 => format!(" of the layer below (L = {})", below.filter.size),
                    2 => format!(" of the layer above (L = {})", above.filter.size),
                    _ => " of its own layer".to_owned(),
                };
                let said = said
                    .ink(Role::Rejected, format!("Sample {}", pixel(here.pixel(*sample))))
                    .text(format!(": R = {} is above the threshold, but its neighbour ", response((1, *sample))))
                    .ink(Role::Best, pixel(of.layers[by.0].pixel(by.1)))
                    .text(format!("{which} has {}, which is no smaller: suppressed.", response(*by)));
                (line::SUPPRESS, said)
            }
            Some(Event::Compared(sample, None)) => {
                let said = said
                    .ink(Role::Best, format!("Sample {}", pixel(here.pixel(*sample))))
                    .text(format!(
                        ": R = {} exceeds all 26 neighbours, 8 in its layer and 9 in each of the layers of L = {} and {}: a maximum \
                         over position and scale.",
                        response((1, *sample)),
                        below.filter.size,
                        above.filter.size
                    ));
                (line::SUPPRESS, said)
            }
            Some(Event::Refined(sample, refined)) => (line::REFINE, refined_to(here.pixel(*sample), *refined)),
            _ => {
                let count = here.responses.cells().iter().filter(|response| **response > self.threshold).count();
                let said = said.text(format!(
                    "Octave {}, L = {} px: {} the threshold R = {}. Non-maximum suppression compares each with its 26 neighbours \
                     in position and scale.",
                    of.octave + 1,
                    here.filter.size,
                    match count {
                        1 => "1 sample exceeds".to_owned(),
                        count => format!("{} samples exceed", grouped(count)),
                    },
                    self.threshold
                ));
                (line::EACH_SAMPLE, said)
            }
        }
    }

    fn chosen(&self, seen: &Seen<Self>, maxima: &[Maximum]) -> (Name, Sentence) {
        let said = Sentence::default();
        let response = |index: usize| numbers::gray(maxima[index].refined.response);
        let at = |index: usize| place(maxima[index].blob.at);
        match seen.events.last() {
            Some(Event::Peak(index, Some(near))) => {
                let said = said
                    .text("Maximum ")
                    .ink(Role::Rejected, at(*index))
                    .text(format!(
                        ", R = {}, is closer than the minimum distance ({} px) to keypoint ",
                        response(*index),
                        self.selection.min_distance
                    ))
                    .ink(Role::Result, at(*near))
                    .text(format!(" with R = {}, which is no smaller: rejected.", response(*near)));
                (line::DROP_NEAR, said)
            }
            Some(Event::Peak(index, None)) => {
                let said = said.text("Maximum ").ink(Role::Result, at(*index)).text(format!(
                    ", R = {}, scale s = {} px: kept as keypoint {}.",
                    response(*index),
                    numbers::px(maxima[*index].blob.scale),
                    grouped(kept(seen).count())
                ));
                (line::KEEP, said)
            }
            _ if maxima.is_empty() => (
                line::EACH_PEAK,
                said.text(self.none_said(seen.before)),
            ),
            _ => (
                line::EACH_PEAK,
                said.text(format!(
                    "{} ranked by response. In this order at most {} become keypoints (the maximum number of points), each at least {} \
                     px (the minimum distance) from those kept before.",
                    match maxima.len() {
                        1 => "1 maximum is".to_owned(),
                        count => format!("{} maxima are", grouped(count)),
                    },
                    grouped(self.selection.max_points),
                    self.selection.min_distance
                )),
            ),
        }
    }

    fn described(&self, seen: &Seen<Self>, of: &Described<'_>) -> (Name, Sentence) {
        let said = Sentence::default();
        let Blob { at, scale } = of.maximum.blob;
        match seen.events.last() {
            Some(Event::Wavelets) => {
                let said = said.text(format!("Keypoint {} at ", of.index + 1)).ink(Role::Reference, place(at)).text(format!(
                    ": Haar wavelets of side 4 s = {} px respond at 109 samples within 6 s = {} px, s = {} px. They are weighted with a \
                     Gaussian of standard deviation 2 s.",
                    numbers::px(4.0 * scale),
                    numbers::px(6.0 * scale),
                    numbers::px(scale)
                ));
                (line::WAVELETS, said)
            }
            Some(Event::Sector(sum)) => {
                let k = of.sums.len() - 1;
                let (best, _) = dominant(&of.sums);
                let length = |[x, y]: [f32; 2]| numbers::gray(x.hypot(y));
                let verdict = match best == k {
                    true => "the longest so far".to_owned(),
                    false => format!("shorter than {} from {} on", length(of.sums[best]), degrees(sector_start(best))),
                };
                let said = said.text(format!(
                    "Sector from {} to {}: the responses in it sum to a vector of length {}, {verdict}.",
                    degrees(sector_start(k)),
                    degrees(sector_start(k) + SECTOR_RAD),
                    length(*sum)
                ));
                (line::SECTOR, said)
            }
            Some(Event::Subregion(sums)) => {
                let k = of.subregions.len();
                let [dx, dy, x, y] = sums.map(numbers::gray);
                let said = said.text(format!(
                    "Subregion {k} of {}: Σ d_x = {dx}, Σ d_y = {dy}, Σ |d_x| = {x}, Σ |d_y| = {y}. A sum much smaller than that of its \
                     absolute values means that the gradient changes sign, as in a pattern of stripes.",
                    SIDE * SIDE
                ));
                (line::SUBREGION, said)
            }
            Some(Event::UnitLength(length)) => {
                let said = match *length > 0.0 {
                    true => format!(
                        "The 64 values have the length {}. Divided by it, they no longer depend on the contrast.",
                        numbers::gray(*length)
                    ),
                    false => {
                        "All 64 values are 0: the neighbourhood is flat and cannot be distinguished from others.".into()
                    }
                };
                (line::UNIT_LENGTH, Sentence::default().text(said))
            }
            _ if self.upright => (
                line::ORIENT,
                said.text(format!("Keypoint {} at ", of.index + 1))
                    .ink(Role::Reference, place(at))
                    .text(format!(", s = {} px: upright, so its orientation is θ = 0.", numbers::px(scale))),
            ),
            _ => {
                let (best, angle_rad) = dominant(&of.sums);
                let [x, y] = of.sums.get(best).copied().unwrap_or_default();
                let said = said
                    .text(format!(
                        "The sector from {} on has the longest sum, {}. Its direction is the orientation θ = ",
                        degrees(sector_start(best)),
                        numbers::gray(x.hypot(y))
                    ))
                    .ink(Role::Result, degrees(angle_rad))
                    .text(".");
                (line::ORIENT, said)
            }
        }
    }

    fn readouts_of_search(&self, of: &Searched<'_>) -> Vec<Readout> {
        let [_, here, _] = of.layers;
        let mut facts = vec![
            Fact::new("Octave", (of.octave + 1).to_string(), None),
            Fact::new("Filter sizes L", of.layers.map(|layer| layer.filter.size.to_string()).join(", "), None),
            Fact::new("Threshold", self.threshold.to_string(), None),
        ];
        let Some(sample) = of.sample else { return vec![Readout::Facts(facts)] };
        facts.push(Fact::new("Sample", pixel(here.pixel(sample)), Some(Role::Reference)));
        facts.push(Fact::new("Response R", numbers::gray(here.responses[sample]), Some(Role::Result)));
        let most = here.responses[sample].max(1.0);
        let labels = ["R, layer below", "R", "R, layer above"];
        let tile = |(label, layer): (&'static str, &Layer)| {
            let values = explain::around(&layer.responses, sample, 1);
            Tile { label, role: None, values, range: [0.0, most], framed: Vec::new() }
        };
        vec![Readout::Facts(facts), Readout::Tiles(labels.into_iter().zip(of.layers).map(tile).collect())]
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

fn degrees(angle_rad: f32) -> String {
    format!("{}°", numbers::fixed(angle_rad.to_degrees(), 1))
}

/// The maxima kept so far.
fn kept(seen: &Seen<Surf>) -> impl Iterator<Item = usize> {
    seen.events.iter().filter_map(|event| match event {
        Event::Peak(index, None) => Some(*index),
        _ => None,
    })
}

fn introduction() -> Sentence {
    Sentence::default().text(
        "A blob has large second derivatives of one sign in all directions, so the determinant of its Hessian is large. SURF computes the \
         derivatives with box filters: the sum of a box of any size needs four values of an integral image.",
    )
}

fn summed(state: &State) -> Sentence {
    let (width, height) = state.picture.size();
    Sentence::default().text(format!(
        "The integral image Σ holds the sum of all pixels above and to the left of each of {}×{} corners. The sum of any box is then D − B − \
         C + A of the values at its corners: three additions, whatever its size.",
        width + 1,
        height + 1
    ))
}

fn integral_facts(state: &State) -> Vec<Readout> {
    let (width, height) = state.picture.size();
    let all: u64 = state.picture.luma().cells().iter().map(|level| u64::from(*level)).sum();
    vec![Readout::Facts(vec![
        Fact::new("Picture", format!("{width}×{height} px"), None),
        Fact::new("Sum of all gray levels", grouped(all as usize), None),
    ])]
}

/// Explains a filter at a pixel.
fn filtered(of: &Filtered<'_>) -> (Name, Sentence) {
    let lines = [line::DERIVE_XX, line::DERIVE_YY, line::DERIVE_XY, line::DETERMINANT];
    let line = lines[of.part.min(3)];
    let Filter { size } = of.layer.filter;
    let (octave, scale) = (of.octave + 1, numbers::px(of.layer.filter.scale()));
    let said = Sentence::default();
    let Some(sample) = of.sample else {
        let what = SYMBOLS.get(of.part).map_or("The determinant".to_owned(), |symbol| format!("The filter {symbol}"));
        return (
            line,
            said.text(format!(
                "{what} of side L = {size} px (octave {octave}, scale s = {scale} px) has no positive response: the picture is flat for \
                 it, or smaller than it."
            )),
        );
    };
    let derivatives = of.layer.filter.derivatives(of.integral, of.layer.pixel(sample));
    let name = format!("Pixel {}", pixel(of.layer.pixel(sample)));
    if let Some(symbol) = SYMBOLS.get(of.part) {
        let boxes = if of.part == 2 {
            "four boxes with weights 1, −1, −1, 1"
        } else {
            "three boxes with weights 1, −2, 1"
        };
        let along = ["along x", "along y", "along both axes"][of.part];
        let said = said.ink(Role::Reference, name).text(format!(
            ", L = {size} px, s = {scale} px: {symbol} = {}, the second derivative {along} by {boxes}.",
            numbers::gray(derivatives[of.part])
        ));
        return (line, said);
    }
    let response = determinant(derivatives);
    let [xx, yy, _] = derivatives;
    let meaning = match () {
        () if response > 0.0 && xx + yy < 0.0 => "is positive, and the second derivatives are negative: a bright blob",
        () if response > 0.0 => "is positive, and so are the second derivatives: a dark blob",
        () => "is not positive: the second derivatives differ in sign, or there is an edge",
    };
    let said = said
        .ink(Role::Reference, name)
        .text(format!(", octave {octave}, L = {size} px: R = D_xx D_yy − (0.9 D_xy)² = "))
        .ink(Role::Result, numbers::gray(response))
        .text(format!(" {meaning}."));
    (line, said)
}

fn readouts_of_filter(state: &State, of: &Filtered<'_>) -> Vec<Readout> {
    let Filter { size } = of.layer.filter;
    let mut facts = vec![
        Fact::new("Octave", (of.octave + 1).to_string(), None),
        Fact::new("Filter side L", format!("{size} px"), None),
        Fact::new("Scale s = 1.2 L / 9", format!("{} px", numbers::px(of.layer.filter.scale())), None),
        Fact::new("Sample spacing", format!("{} px", of.layer.step), None),
    ];
    let Some(sample) = of.sample else { return vec![Readout::Facts(facts)] };
    let at = of.layer.pixel(sample);
    let derivatives = of.layer.filter.derivatives(of.integral, at);
    facts.push(Fact::new("Pixel", pixel(at), Some(Role::Reference)));
    for (symbol, derivative) in SYMBOLS.into_iter().zip(derivatives).take(of.part + 1) {
        facts.push(Fact::new(symbol, numbers::gray(derivative), None));
    }
    let mut readouts = Vec::new();
    if of.part < 3 {
        readouts.push(Readout::Equation(box_equations(of, at)));
    } else {
        facts.push(Fact::new("Response R", numbers::gray(determinant(derivatives)), Some(Role::Result)));
        readouts.push(Readout::Equation(determinant_equations(derivatives)));
    }
    let values = explain::around(state.picture.luma(), at, (size / 2).min(5));
    readouts.push(Readout::Tiles(vec![Tile {
        label: "Frame t",
        role: None,
        values,
        range: [0.0, 255.0],
        framed: Vec::new(),
    }]));
    readouts.insert(0, Readout::Facts(facts));
    readouts
}

/// The sum of the first box by its corners, and the filter by the sums of its boxes.
fn box_equations(of: &Filtered<'_>, at: (usize, usize)) -> Vec<Math> {
    let boxes = &of.layer.filter.boxes(at)[of.part];
    let whole = |value: i64| numbers::fixed(value as f32, 0);
    let Some((first, _)) = boxes.first() else { return Vec::new() };
    let [a, b, c, d] = of.integral.corners(*first).map(|corner| grouped(corner as usize));
    let sum = grouped(of.integral.sum(*first) as usize);
    let corners = Math::Row(vec![
        Math::indexed(Math::Var("S"), Math::text("1")),
        Math::text(" = D − B − C + A = "),
        Math::ink(Role::Result, format!("{d} − {b} − {c} + {a}")),
        Math::text(format!(" = {sum}")),
    ]);
    let terms: Vec<String> = boxes
        .iter()
        .map(|(of_box, weight)| {
            let sign = if *weight < 0 { "− " } else { "+ " };
            let factor = if weight.abs() > 1 { format!("{} · ", weight.abs()) } else { String::new() };
            format!("{sign}{factor}{}", grouped(of.integral.sum(*of_box) as usize))
        })
        .collect();
    let total: i64 =
        boxes.iter().map(|(of_box, weight)| i64::from(*weight) * i64::from(of.integral.sum(*of_box))).sum();
    let Filter { size } = of.layer.filter;
    let filter = Math::Row(vec![
        Math::indexed(Math::Var("D"), Math::Var(["xx", "yy", "xy"][of.part])),
        Math::text(format!(
            " = ({}) / {size}² = {} / {} = ",
            terms.join(" ").trim_start_matches("+ "),
            whole(total),
            size * size
        )),
        Math::ink(Role::Result, numbers::gray(total as f32 / (size * size) as f32)),
    ]);
    vec![corners, filter]
}

fn determinant_equations(derivatives: [f32; 3]) -> Vec<Math> {
    let symbol = |index| Math::indexed(Math::Var("D"), Math::Var(index));
    let [xx, yy, xy] = derivatives.map(numbers::gray);
    let symbols = Math::Row(vec![
        Math::Var("R"),
        Math::text(" = "),
        symbol("xx"),
        Math::text(" "),
        symbol("yy"),
        Math::text(" − "),
        Math::squared(Math::Row(vec![Math::text(format!("({BALANCE} ")), symbol("xy"), Math::text(")")])),
    ]);
    let numbers = Math::Row(vec![
        Math::text(" = "),
        Math::ink(Role::Reference, xx),
        Math::text(" · "),
        Math::ink(Role::Reference, yy),
        Math::text(" − "),
        Math::squared(Math::Row(vec![
            Math::text(format!("({BALANCE} · ")),
            Math::ink(Role::Reference, xy),
            Math::text(")"),
        ])),
        Math::text(" = "),
        Math::ink(Role::Result, numbers::gray(determinant(derivatives))),
    ]);
    vec![symbols, numbers]
}

/// Explains the refinement of a maximum.
fn refined_to(at: (usize, usize), refined: Option<Refined>) -> Sentence {
    let said = Sentence::default().ink(Role::Reference, format!("Maximum {}", pixel(at)));
    let Some(refined) = refined else {
        return said.text(": the quadratic function through its neighbours has no vertex, so it is rejected.");
    };
    let [dx, dy, ds] = refined.offset.map(numbers::gray);
    let said = said.text(format!(
        ": the vertex of the quadratic function through its neighbours lies at an offset of ({dx},\u{a0}{dy}) samples and {ds} layers, "
    ));
    match refined.is_near() {
        true => said.text("with R = ").ink(Role::Result, numbers::gray(refined.response)).text(": accepted."),
        false => said
            .text("more than one sample away, where the fit is unreliable: ")
            .ink(Role::Rejected, "rejected")
            .text("."),
    }
}

fn readouts_of_choice(seen: &Seen<Surf>, maxima: &[Maximum]) -> Vec<Readout> {
    let mut facts = vec![
        Fact::new("Maxima", grouped(maxima.len()), None),
        Fact::new("Kept so far", grouped(kept(seen).count()), Some(Role::Result)),
    ];
    let Some(Event::Peak(index, _)) = seen.events.last() else { return vec![Readout::Facts(facts)] };
    let Maximum { octave, layer, refined, blob, .. } = maxima[*index];
    facts.extend([
        Fact::new("Position", place(blob.at), Some(Role::Reference)),
        Fact::new("Scale s", format!("{} px", numbers::px(blob.scale)), None),
        Fact::new("Octave and filter", format!("{}, L = {} px", octave + 1, Filter::of(octave, layer).size), None),
        Fact::new("Response R", numbers::gray(refined.response), None),
    ]);
    vec![Readout::Facts(facts)]
}

fn readouts_of_keypoint(state: &State, of: &Described<'_>) -> Vec<Readout> {
    let Blob { at, scale } = of.maximum.blob;
    let mut facts = vec![
        Fact::new("Keypoint", format!("{} of {}", of.index + 1, state.kept().len()), None),
        Fact::new("Position", place(at), Some(Role::Reference)),
        Fact::new("Scale s", format!("{} px", numbers::px(scale)), None),
    ];
    facts.extend(of.angle_rad.map(|angle_rad| Fact::new("Orientation θ", degrees(angle_rad), Some(Role::Result))));
    facts.extend(of.length.map(|length| Fact::new("Length before scaling", numbers::gray(length), None)));
    let mut readouts = vec![Readout::Facts(facts)];
    if !of.sums.is_empty() && of.subregions.is_empty() {
        readouts.push(Readout::Series(wheel_series(of)));
    }
    if !of.subregions.is_empty() {
        readouts.push(Readout::Series(descriptor_series(of)));
        let labels = ["Σ dx", "Σ dy", "Σ |dx|", "Σ |dy|"];
        let most = of.subregions.iter().flatten().fold(1.0f32, |most, value| most.max(value.abs()));
        let tile = |(i, label): (usize, &'static str)| {
            let value = |x: usize, y: usize| {
                of.subregions.get(y * SIDE + x).map_or(f32::NAN, |sums| (10.0 * sums[i]).round() / 10.0)
            };
            Tile {
                label,
                role: None,
                values: Grid::from_fn(SIDE, SIDE, value),
                range: [-most, most],
                framed: Vec::new(),
            }
        };
        readouts.push(Readout::Tiles(labels.into_iter().enumerate().map(tile).collect()));
    }
    readouts
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

impl Surf {
    /// Adds the conclusion at the end of a run.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let Some(after) = seen.after else { return sentence };
        let is_over = after.kept.is_some() && after.described.len() == after.kept().len();
        let (Some(first), Some(last)) =
            (after.keypoint(0), after.kept().last().and_then(|index| after.maxima.get(*index)))
        else {
            return sentence;
        };
        if !is_over {
            return sentence;
        }
        let by_octave = (0..after.octaves).map(|octave| {
            let is_in = |index: &&usize| after.maxima[**index].octave == octave;
            grouped(after.kept().iter().filter(is_in).count())
        });
        let by_octave: Vec<String> = by_octave.collect();
        let help = self.selection.advice(after.kept().len(), after.maxima.len());
        sentence.text(format!(
            " End of the run: {} from {}, responses {} to {}; by octave {}. {help}",
            counted(after.kept().len(), "keypoint"),
            match after.maxima.len() {
                1 => "1 maximum".to_owned(),
                count => format!("{} maxima", grouped(count)),
            },
            numbers::gray(first.refined.response),
            numbers::gray(last.refined.response),
            by_octave.join(", ")
        ))
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
