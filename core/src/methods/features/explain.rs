//! The explanation and the drawing of corner detection.

use super::corners::{Corners, Event, Measure, Stage, State};
use super::declare::line;
use super::eigenvalues::{self, Pixel};
use super::select::{Peaks, Selection, Settings};
use crate::base::words::{self, pixel};
use crate::geometry::Grid;
use crate::methods::differential::{Tensor, explain, numbers};
use crate::run::Seen;
use crate::scene::{Fact, Math, Name, Picture, Readout, Role, Scene, Sentence, Shape, Step, Surface, Tile};

fn point((x, y): (usize, usize)) -> [f32; 2] {
    [x as f32, y as f32]
}

/// The inspected pixel with its structure tensor and response.
struct Probe {
    place: (usize, usize),
    /// Whether it is the pixel pointed at rather than the current one.
    is_pointed_at: bool,
    tensor: Tensor,
    response: f32,
    /// The eigenvalue below which noise alone may be the gradient.
    flat: f32,
}

impl<M: Measure> Corners<M> {
    /// Returns the pixel pointed at, or else the current one.
    fn probe(&self, seen: &Seen<Self>) -> Option<Probe> {
        let state = seen.before;
        let at_work = match seen.events.last()? {
            Event::Response(_) => (seen.events.len() - 1, state.row),
            Event::Row => (0, state.row),
            Event::Over(place, _) => *place,
            Event::Ranked => state.strongest()?,
            Event::Peak(peak, _) => state.place(*peak),
        };
        let place = seen.point().and_then(|point| state.map.cell_at(point)).unwrap_or(at_work);
        let is_pointed_at = place != at_work;
        let tensors = self.tensors(state);
        let (tensor, flat) = (tensors.at(place), tensors.flat_below());
        let response = self.0.response([tensor.xx, tensor.xy, tensor.yy]);
        Some(Probe { place, is_pointed_at, tensor, response, flat })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last() else {
            let sentence = "A corner has gradients in two directions, so it can be located and tracked without the aperture \
                            problem. The eigenvalues λ₁ ≥ λ₂ of the structure tensor measure this: both large means corner, \
                            one large means edge, none means flat.";
            return Step {
                line: line::TAKE_DERIVATIVES,
                sentence: Sentence::default().text(sentence),
                readouts: Vec::new(),
            };
        };
        let at_work = match last {
            Event::Response(_) => line::RESPOND,
            Event::Row => line::EACH_STRONG,
            Event::Over(..) => line::SUPPRESS,
            Event::Ranked => line::EACH_PEAK,
            Event::Peak(_, Some(_)) => line::DROP_NEAR,
            Event::Peak(_, None) => line::KEEP,
        };
        let probe = self.probe(seen);
        // Sentence, numbers and line refer to one pixel.
        let (line, sentence) = match &probe {
            Some(probe) if probe.is_pointed_at && seen.before.stage == Stage::Response => {
                (line::RESPOND, self.responds(probe))
            }
            Some(probe) if probe.is_pointed_at => {
                let (line, verdict) = self.verdict(seen, probe);
                (line, self.responds(probe).text(format!(" Status: {verdict}.")))
            }
            probe => (at_work, self.concluded(seen, self.sentence(seen, *last, probe.as_ref()))),
        };
        let readouts = probe.map_or_else(
            || vec![Readout::Facts(vec![Fact::new("Local maxima", "none", None)])],
            |probe| self.readouts(seen, &probe),
        );
        Step { line, sentence, readouts }
    }

    /// Explains eigenvalues and response of a pixel.
    fn responds(&self, probe: &Probe) -> Sentence {
        let eigenvalues = probe.tensor.eigenvalues();
        let [large, small] = eigenvalues.map(numbers::response);
        Sentence::default()
            .ink(Role::Reference, format!("Pixel {}", pixel(probe.place)))
            .text(format!(": eigenvalues λ₁ = {large} and λ₂ = {small}. "))
            .text(self.0.meaning(eigenvalues, probe.response, probe.flat))
    }

    /// Adds the conclusion at the end of a run.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let Some(after) = seen.after.filter(|_| seen.before.stage == Stage::Choice) else { return sentence };
        let (Some(first), Some(last)) = (after.kept.first(), after.kept.last()) else { return sentence };
        let response = |index: u32| numbers::response(after.map[after.place(index)]);
        let kept = words::counted(after.kept.len(), "corner");
        let maxima = match after.peaks.len() {
            1 => "1 local maximum".to_owned(),
            count => format!("{count} local maxima"),
        };
        let responses = match after.kept.len() {
            1 => format!("response {}", response(*first)),
            _ => format!("responses {} to {}", response(*first), response(*last)),
        };
        let help = self.0.settings().selection.advice(after.kept.len(), after.peaks.len());
        sentence.text(format!(" End of the run: {kept} from {maxima}, {responses}. {help}"))
    }

    fn sentence(&self, seen: &Seen<Self>, event: Event, probe: Option<&Probe>) -> Sentence {
        let (state, peaks, said) = (seen.before, self.peaks(seen.before), Sentence::default());
        let Settings { threshold, selection: Selection { max_points, min_distance }, .. } = self.0.settings();
        match event {
            Event::Response(_) => match probe {
                Some(probe) => self.responds(probe),
                None => said.text("The response of each pixel is a function of its structure tensor."),
            },
            Event::Row if peaks.over(state.row).next().is_none() => said.text(
                match state.row == 0 || state.row + 1 == state.map.height() {
                    true => format!(
                        "Row {} is the image border: without all eight neighbours no pixel can be a local maximum.",
                        state.row
                    ),
                    false => format!(
                        "Row {}: no response reaches the threshold R = {}, {} of the largest response {}.",
                        state.row,
                        numbers::response(peaks.limit),
                        words::percent(threshold),
                        numbers::response(state.largest)
                    ),
                },
            ),
            Event::Row => said.text(format!(
                "Row {}: {} at least the threshold R = {}, {} of the largest response {}. Non-maximum suppression follows.",
                state.row,
                match peaks.over(state.row).count() {
                    1 => "1 response is".to_owned(),
                    count => format!("{count} responses are"),
                },
                numbers::response(peaks.limit),
                words::percent(threshold),
                numbers::response(state.largest)
            )),
            Event::Over(place, by) => over(&peaks, place, by),
            Event::Ranked if state.peaks.is_empty() => said.text(
                "No response is a local maximum above the threshold, so there are no corners: the frame has no texture, \
                 or only edges.",
            ),
            Event::Ranked => said.text(format!(
                "{} ranked by response. In this order at most {max_points} become corners (the maximum number of points), each at least \
                 {min_distance} px (the minimum distance) from those kept before.",
                match state.peaks.len() {
                    1 => "1 local maximum is".to_owned(),
                    count => format!("{count} local maxima are"),
                }
            )),
            Event::Peak(peak, near) => self.chosen(seen, peak, near),
        }
    }

    /// Explains the selection of a local maximum.
    fn chosen(&self, seen: &Seen<Self>, peak: u32, near: Option<u32>) -> Sentence {
        let state = seen.before;
        let response = |peak: u32| state.map[state.place(peak)];
        let with = format!(", R = {},", numbers::response(response(peak)));
        let said = Sentence::default().text("Local maximum ");
        let Some(near) = near else {
            let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
            return said
                .ink(Role::Result, pixel(state.place(peak)))
                .text(format!("{with} has no stronger corner within the minimum distance: kept as corner {count}."));
        };
        let why = if response(near) > response(peak) {
            format!("has the larger response {}", numbers::response(response(near)))
        } else {
            "has an equal response and comes first".into()
        };
        said.ink(Role::Rejected, pixel(state.place(peak)))
            .text(format!(
                "{with} is closer than the minimum distance ({} px) to corner ",
                self.0.settings().selection.min_distance
            ))
            .ink(Role::Result, pixel(state.place(near)))
            .text(format!(", which {why}: rejected."))
    }

    fn readouts(&self, seen: &Seen<Self>, probe: &Probe) -> Vec<Readout> {
        let (state, Probe { place, tensor, response, .. }) = (seen.before, probe);
        let fact = |label, value: String, role| Fact::new(label, value, role);
        let [large, small] = tensor.eigenvalues().map(numbers::response);
        let Tensor { xx, xy, yy, .. } = *tensor;
        let [a, b, c] = [xx, xy, yy].map(numbers::response);
        let mut facts = vec![
            fact("Pixel", pixel(*place), Some(Role::Reference)),
            fact("Σ w I_x², Σ w I_x I_y, Σ w I_y²", format!("{a}, {b}, {c} (Σ w = 1)"), None),
            fact("Eigenvalues λ₁, λ₂", format!("{large} and {small}"), None),
            fact("Response R", numbers::response(*response), Some(Role::Result)),
        ];
        if state.stage != Stage::Response {
            facts.push(fact("Threshold", numbers::response(self.peaks(state).limit), None));
            facts.push(fact("Status", self.verdict(seen, probe).1, None));
        }
        let tile = |label, values: Grid<f32>, range| Tile { label, role: None, values, range, framed: Vec::new() };
        let radius = (self.0.settings().window / 2 + 1).min(5);
        let [symbols, numbers] = self.0.equation(tensor);
        let mut tiles = vec![tile("Frame t", explain::around(state.picture.luma(), *place, radius), [0.0, 255.0])];
        if state.stage != Stage::Response {
            let shown = explain::around(&state.map.map(|response| M::shown(*response)), *place, radius);
            let most = shown.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(*v));
            tiles.push(tile("Response, compressed", shown, [0.0, most]));
        }
        let threshold = (state.stage != Stage::Response).then(|| self.peaks(state).limit);
        let inspected = Pixel { name: pixel(*place), eigenvalues: tensor.eigenvalues(), threshold, flat: probe.flat };
        let mut readouts = vec![
            Readout::Facts(facts),
            Readout::Equation(vec![matrix(), symbols, numbers]),
            Readout::Regions(eigenvalues::regions(&self.0, inspected)),
            Readout::Tiles(tiles),
        ];
        readouts.extend(hills(seen, *place).map(Readout::Landscape));
        readouts
    }

    /// Returns the status of a pixel after the response stage, and the line that decided it.
    fn verdict(&self, seen: &Seen<Self>, probe: &Probe) -> (Name, String) {
        let (state, peaks, place) = (seen.before, self.peaks(seen.before), probe.place);
        if !peaks.is_over(place.0, place.1) {
            let (width, height) = state.map.size();
            let is_border = place.0 == 0 || place.1 == 0 || place.0 + 1 == width || place.1 + 1 == height;
            let why = if is_border { "image border, no local maximum" } else { "below the threshold" };
            return (line::EACH_STRONG, why.into());
        }
        if let Some(by) = peaks.suppressed_by(place) {
            return (line::SUPPRESS, format!("suppressed by {}", pixel(by)));
        }
        let Selection { min_distance, max_points } = self.0.settings().selection;
        let index = (place.1 * state.map.width() + place.0) as u32;
        let choice = seen.events.iter().find_map(|event| match event {
            Event::Peak(peak, near) if *peak == index => Some(*near),
            _ => None,
        });
        match choice {
            Some(None) => (line::KEEP, "corner".into()),
            Some(Some(near)) => (
                line::DROP_NEAR,
                format!("local maximum, rejected within {min_distance} px of {}", pixel(state.place(near))),
            ),
            None if seen.after.is_some() && state.stage == Stage::Choice => {
                (line::KEEP, format!("local maximum, not among the {max_points} strongest"))
            }
            None => (line::SUPPRESS, "local maximum".into()),
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        self.draw_map(seen, scene);
        let mut points = |role, meaning, places: Vec<(usize, usize)>| {
            if !places.is_empty() {
                scene.mark(Picture::CURRENT, role, Shape::Points(places.into_iter().map(point).collect()));
                scene.legend(role, meaning);
            }
        };
        let places = |peaks: &[u32]| peaks.iter().map(|peak| state.place(*peak)).collect::<Vec<_>>();
        match state.stage {
            Stage::Response => {}
            Stage::Suppression => {
                let over = |is_peak: bool| {
                    let of_row = seen.events.iter().filter_map(move |event| match event {
                        Event::Over(place, by) if by.is_none() == is_peak => Some(*place),
                        _ => None,
                    });
                    of_row.collect::<Vec<_>>()
                };
                points(Role::Rejected, "suppressed (non-maximum)", over(false));
                points(Role::Best, "local maximum", [places(&state.peaks), over(true)].concat());
            }
            Stage::Choice => {
                let looked_at = |is_kept: bool| {
                    let peaks = seen.events.iter().filter_map(move |event| match event {
                        Event::Peak(peak, near) if near.is_none() == is_kept => Some(*peak),
                        _ => None,
                    });
                    places(&peaks.collect::<Vec<_>>())
                };
                let (kept, dropped) = (looked_at(true), looked_at(false));
                let done: Vec<_> = kept.iter().chain(&dropped).copied().collect();
                // Beyond max-points nothing was tested.
                let mut is_done = Grid::new(state.map.width(), state.map.height(), seen.after.is_some());
                done.iter().for_each(|place| is_done[*place] = true);
                let waiting = places(&state.peaks).into_iter().filter(|place| !is_done[*place]).collect();
                points(Role::Candidate, "local maximum, not yet tested", waiting);
                points(Role::Rejected, "rejected by the minimum distance", dropped);
                points(Role::Result, "corner", kept);
            }
        }
        self.draw_pixel(seen, scene);
    }

    /// Draws the responses so far; in later stages only those that reach the threshold.
    fn draw_map(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, peaks) = (seen.before, self.peaks(seen.before));
        let (width, height) = state.map.size();
        let is_shown = |x: usize, y: usize| state.stage == Stage::Response || peaks.is_over(x, y);
        let shown = |x, y| response(seen, (x, y)).filter(|_| is_shown(x, y)).map_or(f32::NAN, M::shown);
        let values = Grid::from_fn(width, height, shown);
        if values.cells().iter().any(|value| value.is_finite()) {
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
            scene.heat = Some(M::SHOWN);
        }
    }

    fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(probe) = self.probe(seen) else { return };
        let (x, y) = (probe.place.0 as i32, probe.place.1 as i32);
        let Settings { window, selection: Selection { min_distance, .. }, .. } = self.0.settings();
        if let (Some(Event::Peak(..)), None) = (seen.events.last(), seen.point()) {
            let radius = min_distance as f32;
            let shape = Shape::Ellipse { center: point(probe.place), radii: [radius; 2], angle_rad: 0.0 };
            scene.mark(Picture::CURRENT, Role::Window, shape);
            scene.legend(Role::Window, "minimum distance");
        } else {
            let reach = (window / 2) as i32;
            let side = 2 * reach as usize + 1;
            scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x - reach, y - reach, side, side));
            scene.legend(Role::Window, "window");
        }
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x, y, 1, 1));
        scene.legend(Role::Reference, "inspected pixel");
    }
}

/// The response of a pixel, if it has been computed.
fn response<M: Measure>(seen: &Seen<Corners<M>>, (x, y): (usize, usize)) -> Option<f32> {
    let state = seen.before;
    match (state.stage, seen.events.get(x)) {
        (Stage::Response, Some(Event::Response(response))) if y == state.row => Some(*response),
        (Stage::Response, _) if y >= state.row => None,
        _ => state.map.get(x, y).copied(),
    }
}

/// The responses computed so far around a pixel, compressed as on the map.
fn hills<M: Measure>(seen: &Seen<Corners<M>>, place: (usize, usize)) -> Option<Surface> {
    /// How far they reach to each side, in px.
    const REACH: usize = 20;
    let (width, height) = seen.before.map.size();
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

impl State {
    /// Returns the position of the strongest local maximum.
    fn strongest(&self) -> Option<(usize, usize)> {
        let better = |a: u32, b: u32| if self.map[self.place(b)] > self.map[self.place(a)] { b } else { a };
        self.peaks.iter().copied().reduce(better).map(|peak| self.place(peak))
    }
}

/// Non-maximum suppression of a pixel that reaches the threshold; `by` is the neighbour that suppresses it.
fn over(peaks: &Peaks<'_>, place: (usize, usize), by: Option<(usize, usize)>) -> Sentence {
    let (said, response) = (Sentence::default(), |place| numbers::response(peaks.map[place]));
    let limit = numbers::response(peaks.limit);
    let Some(by) = by else {
        return said.ink(Role::Best, format!("Pixel {}", pixel(place))).text(format!(
            ": R = {} reaches the threshold of {limit} and no neighbour has a larger response: a local maximum.",
            response(place)
        ));
    };
    said.ink(Role::Rejected, format!("Pixel {}", pixel(place)))
        .text(format!(": R = {} reaches the threshold of {limit}, but neighbour ", response(place)))
        .ink(Role::Best, pixel(by))
        .text(if peaks.map[by] > peaks.map[place] {
            format!(" has the larger response {}: suppressed.", response(by))
        } else {
            " has an equal response and comes first: suppressed.".into()
        })
}

/// The structure tensor in symbols.
fn matrix() -> Math {
    let product =
        |parts: Vec<Math>| Math::Row([vec![Math::text("Σ "), Math::Var("w"), Math::text(" ")], parts].concat());
    let squared = |along| product(vec![Math::power(explain::derivative(along), Math::text("2"))]);
    let mixed = || product(vec![explain::derivative("x"), explain::derivative("y")]);
    Math::Row(vec![
        Math::Bold("T"),
        Math::text(" = "),
        Math::Matrix(vec![vec![squared("x"), mixed()], vec![mixed(), squared("y")]]),
    ])
}
