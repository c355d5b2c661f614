//! The explanation and the drawing of Lucas and Kanade's method.

use super::{ADVICE, Event, LucasKanade, Solution, line, solved};
use crate::base::{Threads, words};
use crate::data::Flow;
use crate::geometry::Sampling;
use crate::methods::differential::{
    Conclusion, Constraints, EDGE_RATIO, FramePair, Linear, Tensor, Texture, explain, field, numbers,
};
use crate::run::Seen;
use crate::scene::{
    Constraint, Fact, Footing, Math, Picture, Plane, PlaneCost, Readout, Role, Scene, Sentence, Shape, Spread, Step,
    arrow_spacing,
};

/// The inspected pixel, the one pointed at or else the current one, with the solution of its window.
struct Probe<'a> {
    pixel: (usize, usize),
    linear: &'a Linear,
    tensor: Tensor,
    solution: Solution,
    spread: Option<Spread>,
}

impl Probe<'_> {
    fn is_solved(&self) -> bool {
        self.solution.displacement[0].is_finite()
    }
}

/// How many times the threshold the smaller eigenvalue must be to exceed it clearly.
const CLEAR: f32 = 2.0;

fn px(uv: [f32; 2]) -> String {
    format!("{} px", numbers::vector(uv))
}

/// The end of a sentence after the flow `found`: its endpoint error where the true flow is known.
fn endpoint_error(truth: Option<[f32; 2]>, found: [f32; 2]) -> String {
    match truth.map(|[u, v]| (found[0] - u).hypot(found[1] - v)).filter(|error| error.is_finite()) {
        Some(error) => format!("; endpoint error {} px.", numbers::px(error)),
        None => ".".into(),
    }
}

impl LucasKanade {
    fn probe<'a>(&self, seen: &Seen<'a, Self>) -> Option<Probe<'a>> {
        let state = seen.before;
        let last = solved(seen.events).len().checked_sub(1)?;
        let pointed_at = seen.point().and_then(|point| state.frame_pair.pixel_at(point));
        let pixel = pointed_at.unwrap_or((last, state.y));
        let linear = self.linear(state, &Threads::single());
        let mut tensor = Tensor::default();
        self.window().sums(&linear.factors).row(pixel.1, |x, found| {
            if x == pixel.0 {
                tensor = found;
            }
        });
        let solution = self.solve(&tensor);
        Some(Probe { pixel, linear, tensor, solution, spread: tensor.spread(solution.displacement) })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        if let [Event::Linearized] = seen.events {
            return self.linearized(seen.before.iteration);
        }
        let Some(probe) = self.probe(seen) else {
            let sentence = "One gradient constraint has two unknowns, so Lucas and Kanade assume constant flow in a window. \
                            Least squares gives T (u, v) = −Σ w ∇I I_t with the structure tensor T. (Course \
                            notes with (I_x, I_y; I_t, I_y) (u, v) = −(I_t, I_x) are misprinted.)";
            return Step {
                values: Vec::new(),
                line: line::START_AT_ZERO,
                sentence: Sentence::default().text(sentence),
                readouts: Vec::new(),
            };
        };
        let line = if probe.is_solved() { line::SOLVE } else { line::IS_SINGULAR };
        let (sentence, readouts) = (self.sentence(seen, &probe), self.readouts(seen, &probe));
        let has_gaps = readouts.iter().any(|readout| match readout {
            Readout::Plane(plane) => plane.cost.as_ref().is_some_and(PlaneCost::has_gaps),
            _ => false,
        });
        let border = " The cost surface ends where the window leaves frame t+1.";
        let sentence = sentence.text(if has_gaps { border } else { "" });
        Step { sentence: self.concluded(seen, sentence), readouts, ..Step::at(line) }
    }

    /// Explains the linearisation before the first row of an iteration.
    fn linearized(&self, iteration: usize) -> Step {
        let number = format!("Iteration {} of {}", iteration + 1, self.iterations);
        let what = match iteration {
            0 => ": the flow is still 0, so the gradient constraints are taken from both frames without warping.",
            _ => {
                ": frame t+1 is warped toward frame t by the current flow (u₀, v₀), and brightness constancy is linearised \
                 again. This reduces the linearisation error of large motion."
            }
        };
        let facts = vec![Fact::new("Iteration", format!("{} of {}", iteration + 1, self.iterations), None)];
        let sentence = Sentence::default().text(number + what);
        Step { values: Vec::new(), line: line::LINEARIZE, sentence, readouts: vec![Readout::Facts(facts)] }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        field::draw(seen.before.flow(seen.events), scene);
        draw_textures(seen, scene);
        let Some(probe) = self.probe(seen) else { return };
        let ((x, y), reach) = (probe.pixel, self.window as i32 / 2);
        let (left, top, side) = (x as i32 - reach, y as i32 - reach, 2 * reach as usize + 1);
        scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(left, top, side, side));
        scene.legend(Role::Window, "window");
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x as i32, y as i32, 1, 1));
        scene.legend(Role::Reference, "inspected pixel");
        if let Some(spread) = probe.spread {
            let center = [x as f32 + spread.center[0], y as f32 + spread.center[1]];
            let shape = Shape::Ellipse { center, radii: spread.radii, angle_rad: spread.angle_rad };
            scene.mark(Picture::CURRENT, Role::Measured, shape);
            scene.legend(Role::Measured, "standard deviation of the flow (1 σ)");
        }
    }

    /// Adds the conclusion of an iteration and of the run, at the end of each.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let (Some(after), None) = (seen.after, seen.point()) else { return sentence };
        if after.iteration == seen.before.iteration {
            return sentence;
        }
        if after.iteration == self.iterations {
            let conclusion = Conclusion::new(&after.frame_pair, &Flow(after.flow(&[])), 1.0);
            return sentence.text(" ").then(conclusion.tell(Step::at(line::SOLVE), &ADVICE).sentence);
        }
        let count = |wanted: Texture| after.found.iter().filter(|solution| solution.texture == wanted).count();
        let percent = |count: usize| format!("{:.0} %", 100.0 * count as f32 / after.found.len().max(1) as f32);
        sentence.text(format!(
            " End of the iteration: {} of the windows are corners with flow, {} edges, {} flat.",
            percent(count(Texture::Corner)),
            percent(count(Texture::Edge)),
            percent(count(Texture::Flat))
        ))
    }

    fn sentence(&self, seen: &Seen<Self>, probe: &Probe) -> Sentence {
        let Solution { displacement, eigenvalues, texture } = probe.solution;
        let (x, y) = probe.pixel;
        let [large, small] = eigenvalues.map(numbers::gray);
        let said =
            Sentence::default().text("Window of ").ink(Role::Reference, format!("pixel {}", words::pixel((x, y))));
        // An eigenvalue above the threshold is refused only for rounding errors.
        let why = |eigenvalue: f32, otherwise: &str| match eigenvalue < self.min_eigenvalue {
            true => format!("below the threshold of {}", numbers::gray(self.min_eigenvalue)),
            false => otherwise.to_owned(),
        };
        // The constraint of the pixel itself is unknown: the rest of the window decides nothing.
        if matches!(texture, Texture::Flat | Texture::Edge) && !probe.linear.factors.is_known(probe.pixel) {
            let [gone, all] = self.left(&probe.linear.factors, probe.pixel);
            return said.text(format!(
                ": the flow (u₀, v₀) leads the pixel itself and {} of the {all} pixels of its window out of frame t+1. The other \
                 constraints, λ₁ = {large} and λ₂ = {small}, do not determine the flow: it is unknown.",
                gone.saturating_sub(1)
            ));
        }
        match texture {
            Texture::Unknown => {
                said.text(": the flow leads all its pixels out of frame t+1. Without constraints the flow is unknown.")
            }
            Texture::Flat if eigenvalues[0] >= self.min_eigenvalue && eigenvalues[1] > 0.0 => said.text(format!(
                ": λ₂ = {small} is {}, and λ₁ = {large} is less than {EDGE_RATIO:.0} times as large, so this is no edge but a flat \
                 window: its weak gradients have many directions. Noise would determine the solution, so the flow is unknown.",
                why(eigenvalues[1], "0 up to rounding")
            )),
            Texture::Flat => said.text(format!(
                ": λ₁ = {large} and λ₂ = {small} are both {}, a flat window. Noise would determine the solution, so the flow is \
                 unknown.",
                why(eigenvalues[0], "0 up to rounding")
            )),
            Texture::Edge => said.text(format!(
                ": λ₁ = {large}, but λ₂ = {small} is {}, an edge. The constraint lines are nearly parallel (aperture problem), so \
                 the flow is unknown.",
                why(eigenvalues[1], "0 up to rounding")
            )),
            Texture::Corner => {
                let threshold = numbers::gray(self.min_eigenvalue);
                let what = match eigenvalues[1] < CLEAR * self.min_eigenvalue {
                    true => "λ₂ only slightly, so noise has much influence on the solution",
                    false => "so the constraint lines intersect well",
                };
                said.text(format!(
                    ": λ₁ = {large} and λ₂ = {small} exceed the threshold of {threshold}, {what}. Least squares gives (u, v) = "
                ))
                .ink(Role::Result, px(displacement))
                .text(endpoint_error(seen.before.frame_pair.true_displacement(probe.pixel), displacement))
            }
        }
    }

    fn facts(&self, seen: &Seen<Self>, probe: &Probe) -> Vec<Fact> {
        let Probe { pixel, linear, tensor, solution, spread } = probe;
        let fact = |label, value: String, role| Fact::new(label, value, role);
        let mut facts = vec![fact("Pixel", words::pixel(*pixel), Some(Role::Reference)), linear.fact(*pixel)];
        if seen.before.iteration > 0 {
            facts.push(fact("Linearised at (u₀, v₀)", px(linear.start.at(pixel.0, pixel.1)), Some(Role::Best)));
        }
        let [gone, all] = self.left(&linear.factors, *pixel);
        if gone > 0 {
            facts.push(fact("Outside frame t+1", format!("{gone} of {all} pixels of the window"), None));
        }
        let [large, small] = solution.eigenvalues.map(numbers::gray);
        let texture = match solution.texture {
            Texture::Unknown => "unknown",
            Texture::Flat => "flat",
            Texture::Edge => "edge",
            Texture::Corner => "corner",
        };
        facts.push(fact("Eigenvalues λ₁, λ₂", format!("{large} and {small}: {texture}"), None));
        if probe.is_solved() {
            let off = numbers::gray(tensor.residual(solution.displacement).sqrt());
            facts.push(fact("Flow (u, v)", px(solution.displacement), Some(Role::Result)));
            facts.push(fact("RMS residual of the constraints", format!("{off} gray levels"), None));
        }
        if let Some(spread) = spread {
            let [a, b] = spread.radii.map(numbers::px);
            facts.push(fact(
                "Standard deviation of the flow",
                format!("{a} px along the gradient, {b} px across"),
                None,
            ));
        }
        let truth = seen.before.frame_pair.true_displacement(*pixel);
        facts.extend(truth.map(|truth| fact("True flow", px(truth), Some(Role::Truth))));
        facts
    }

    fn readouts(&self, seen: &Seen<Self>, probe: &Probe) -> Vec<Readout> {
        let (frame_pair, displacement) = (&seen.before.frame_pair, probe.solution.displacement);
        let mut points = vec![("zero flow", Role::Reference, [0.0; 2])];
        points.extend(probe.is_solved().then_some(("least squares", Role::Result, displacement)));
        let truth = frame_pair.true_displacement(probe.pixel);
        points.extend(truth.map(|truth| ("true flow", Role::Truth, truth)));
        let start = probe.linear.start.at(probe.pixel.0, probe.pixel.1);
        let reach = explain::reach(points.iter().map(|(.., point)| *point).chain([start]));
        let plane = Plane {
            groups: Vec::new(),
            title: "Mean squared difference and constraint lines",
            unit: "px".into(),
            center: [0.0; 2],
            reach,
            cost: Some(self.squared_difference(frame_pair, probe.pixel, reach)),
            path: [start].into_iter().chain(probe.is_solved().then_some(displacement)).collect(),
            lines: self.lines(&probe.linear.factors, probe.pixel),
            points,
            ellipse: probe.spread,
        };
        let [current, next] = &frame_pair.pictures;
        let radius = (self.window / 2).min(5);
        vec![
            Readout::Facts(self.facts(seen, probe)),
            Readout::Equation(equation(probe, seen.before.iteration > 0)),
            Readout::Plane(plane),
            Readout::Tiles(probe.linear.tiles([current, next], probe.pixel, radius)),
        ]
    }

    /// Returns the quantity that least squares minimizes, without linearisation: the weighted mean of (I(x + d, t + 1) − I(x, t))²
    /// over the window around a pixel, for the displacements d up to `reach`. NaN where part of the window leaves frame t + 1.
    fn squared_difference(&self, of: &FramePair, (x, y): (usize, usize), reach: f32) -> PlaneCost {
        let [current, next] = &of.pictures;
        let (window, radius) = (self.window(), self.window as isize / 2);
        let along = || -radius..=radius;
        let pixels: Vec<_> = along()
            .flat_map(|j| along().map(move |i| [i, j]))
            .filter_map(|[i, j]| {
                let (x, y) = (x.checked_add_signed(i)?, y.checked_add_signed(j)?);
                Some(([x as f32, y as f32], *current.get(x, y)?, window.weight([i, j])))
            })
            .collect();
        let total: f32 = pixels.iter().map(|(.., weight)| weight).sum();
        let cost = |[u, v]: [f32; 2]| {
            let squared = |([x, y], gray, weight): &([f32; 2], f32, f32)| {
                weight * (Sampling::Bicubic.sample_inside(next, x + u, y + v) - gray).powi(2)
            };
            pixels.iter().map(squared).sum::<f32>() / total
        };
        PlaneCost::sampled(explain::SQUARED_DIFFERENCE, ([0.0; 2], reach), pixels.len(), cost)
            .on(Footing::new(Picture::CURRENT, [x as f32, y as f32]))
    }

    /// Returns the number of pixels of a window that lead out of frame t + 1, and their number in frame t.
    fn left(&self, of: &Constraints, (x, y): (usize, usize)) -> [usize; 2] {
        let (window, (width, height)) = (self.window(), of.a.size());
        let ((left, across), (top, down)) = (window.inside(x, width), window.inside(y, height));
        let (columns, rows) = (left..left + across.len(), top..top + down.len());
        let all = columns.len() * rows.len();
        let gone = |y: usize| of.unknown_in_row(y).filter(|x| columns.contains(x)).count();
        [rows.map(gone).sum(), all]
    }

    /// Returns the constraint lines of the window by their weights; a subset for large windows.
    fn lines(&self, of: &Constraints, (x, y): (usize, usize)) -> Vec<Constraint> {
        let (window, reach) = (self.window(), self.window as isize / 2);
        let step = self.window / 12 + 1;
        let along = || (-reach..=reach).step_by(step);
        let pixels = along().flat_map(|j| along().map(move |i| [i, j])).filter_map(|[i, j]| {
            let place = (x.checked_add_signed(i)?, y.checked_add_signed(j)?);
            of.a.get(place.0, place.1)?;
            let [a, b, c] = of.at(place);
            Some(([a, b, c], window.weight([i, j]) * a.hypot(b)))
        });
        let pixels: Vec<_> = pixels.collect();
        let most = pixels.iter().fold(f32::MIN_POSITIVE, |most, (_, weight)| most.max(*weight));
        let line = |(factors, weight)| explain::line(factors, weight / most, Role::Candidate);
        pixels.into_iter().filter_map(line).collect()
    }
}

/// Marks windows without flow on the grid of the arrows.
fn draw_textures(seen: &Seen<LucasKanade>, scene: &mut Scene) {
    let textures = seen.before.solutions(seen.events, |solution| solution.map(|solution| solution.texture));
    // Every other grid point, so that the edge itself stays visible.
    let spacing = 2 * arrow_spacing(textures.size());
    let along = |extent: usize| (spacing / 2..extent).step_by(spacing);
    let places: Vec<_> = along(textures.height()).flat_map(|y| along(textures.width()).map(move |x| (x, y))).collect();
    for (texture, role, meaning) in [
        (Texture::Edge, Role::Rejected, "edge: only normal flow determined"),
        (Texture::Flat, Role::Predicted, "flat: no flow determined"),
    ] {
        let is_so = |place: &&(usize, usize)| textures[**place] == Some(texture);
        let points: Vec<_> = places.iter().filter(is_so).map(|(x, y)| [*x as f32, *y as f32]).collect();
        if !points.is_empty() {
            scene.mark(Picture::CURRENT, role, Shape::Points(points));
            scene.legend(role, meaning);
        }
    }
}

/// The normal equations of the window, in symbols and with numbers. After warping (`is_about`), c replaces I_t; its definition is
/// that of the inspected pixel.
fn equation(probe: &Probe, is_about: bool) -> Vec<Math> {
    let Probe { pixel, linear, tensor, .. } = probe;
    let right = || if is_about { Math::Var("c") } else { explain::derivative("t") };
    let mut lines = if is_about { linear.definition(*pixel, Role::Reference).to_vec() } else { Vec::new() };
    let squared = |along| Math::power(explain::derivative(along), Math::text("2"));
    let mixed = || Math::Row(vec![explain::derivative("x"), explain::derivative("y")]);
    let equal = |along| Math::Row(vec![explain::derivative(along), right()]);
    lines.extend([
        symbols([squared("x"), mixed(), equal("x")], ""),
        symbols([mixed(), squared("y"), equal("y")], ",  Σ w = 1"),
        row(tensor.xx, tensor.xy, tensor.xt),
        row(tensor.xy, tensor.yy, tensor.yt),
    ]);
    if probe.is_solved() {
        let found = Math::ink(Role::Result, numbers::vector(probe.solution.displacement));
        let parts = [Math::text("("), Math::Var("u"), Math::text(", "), Math::Var("v"), Math::text(") = "), found];
        lines.push(Math::Row(parts.to_vec()));
    }
    lines
}

/// A normal equation in symbols.
fn symbols([first, second, right]: [Math; 3], after: &str) -> Math {
    let sum = |product| Math::Row(vec![Math::text("Σ "), Math::Var("w"), Math::text(" "), product]);
    Math::Row(vec![
        sum(first),
        Math::text(" "),
        Math::Var("u"),
        Math::text(" + "),
        sum(second),
        Math::text(" "),
        Math::Var("v"),
        Math::text(" = − "),
        sum(right),
        Math::text(after),
    ])
}

/// A normal equation in numbers.
fn row(a: f32, b: f32, c: f32) -> Math {
    Math::Row(vec![
        Math::ink(Role::Reference, numbers::gray(a)),
        Math::text(" "),
        Math::Var("u"),
        Math::text(" "),
        Math::ink(Role::Reference, numbers::summand(numbers::gray(b))),
        Math::text(" "),
        Math::Var("v"),
        Math::text(" = "),
        Math::ink(Role::Reference, numbers::gray(-c)),
    ])
}
