//! The explanation and the drawing of Lucas and Kanade's method.

use super::{ADVICE, Event, LucasKanade, Solution, line, solved};
use crate::base::Threads;
use crate::base::words::further_digits;
use crate::data::Flow;
use crate::geometry::Sampling;
use crate::methods::differential::{
    Conclusion, Constraints, EDGE_RATIO, FramePair, Linear, Tensor, Texture,
    explain::{self, case as shared_case, value as shared},
    field,
};
use crate::run::Seen;
use crate::scene::{
    Case, Constraint, Footing, Picture, Plane, PlaneCost, Readout, Role, Scene, Shape, Spread, Step, Unit,
    arrow_spacing,
};
use crate::{cases, variables};

variables! {
    /// The pixels of the window that the flow leads out of frame t+1.
    OUTSIDE: "Outside frame t+1", "", Unit::WHOLE;
    /// The pixels of the window that the flow leads out of frame t+1, besides the inspected one.
    OTHERS_OUTSIDE: "", "", Unit::WHOLE;
    /// The pixels of the window in frame t.
    WINDOW_PIXELS: "", "", Unit::count("pixel");
    /// The least ratio of the eigenvalues of an edge.
    EDGE_RATIO: "", "", Unit::WHOLE;
    /// The texture of the window by its eigenvalues.
    TEXTURE: "", "", Unit::WHOLE;
    /// The sums Σ w I_x², Σ w I_x I_y and Σ w I_y² over the window.
    TENSOR: "", r"\mathbf{T}", Unit::FINE, Role::Reference;
    /// The right-hand side of the normal equations.
    RIGHT_SIDE: "", "", Unit::FINE, Role::Reference;
    /// The flow by least squares.
    FLOW: "Flow (u, v)", "(u, v)", Unit::SUBPIXEL, Role::Result;
    /// The distance of the flow from the true flow.
    ENDPOINT_ERROR: "", "", Unit::SUBPIXEL;
    /// The root of the weighted mean of the squared residuals of the gradient constraints.
    RMS_RESIDUAL: "RMS residual of the constraints", "", Unit::GRAY;
    /// The standard deviation of the flow along the dominant gradient.
    DEVIATION_ALONG: "Standard deviation of the flow", "", Unit::SUBPIXEL;
    /// The standard deviation of the flow across the dominant gradient.
    DEVIATION_ACROSS: "", "", Unit::SUBPIXEL;
    /// The share of the windows that are corners.
    CORNERS: "", "", Unit::WHOLE_PERCENT;
    /// The share of the windows that are edges.
    EDGES: "", "", Unit::WHOLE_PERCENT;
    /// The share of the windows that are flat.
    FLAT: "", "", Unit::WHOLE_PERCENT;
}

cases! { pub(super) over value, shared;
    OPENING: "One gradient constraint has two unknowns, so Lucas and Kanade assume constant flow in a window. Least squares gives \
              T (u, v) = −Σ w ∇I I_t with the structure tensor T. (Course notes with (I_x, I_y; I_t, I_y) (u, v) = −(I_t, I_x) are \
              misprinted.)",
    FIRST_ITERATION: "Iteration {iteration} of {iterations}: the flow is still 0, so the gradient constraints are taken from both frames \
                      without warping.",
    LATER_ITERATION: "Iteration {iteration} of {iterations}: frame t+1 is warped toward frame t by the current flow (u₀, v₀), and \
                      brightness constancy is linearised again. This reduces the linearisation error of large motion.",
    WINDOW: "Window of {reference|pixel} {pixel}",
    PIXEL_OUTSIDE: ": the flow (u₀, v₀) leads the pixel itself and {others_outside} of the {window_pixels} of its window out of frame \
                    t+1. The other constraints, λ₁ = {lambda_1} and λ₂ = {lambda_2}, do not determine the flow: it is unknown.",
    ALL_OUTSIDE: ": the flow leads all its pixels out of frame t+1. Without constraints the flow is unknown.",
    SMALLER: ": λ₂ = {lambda_2} is",
    BOTH: ": λ₁ = {lambda_1} and λ₂ = {lambda_2} are both",
    LARGER: ": λ₁ = {lambda_1}, but λ₂ = {lambda_2} is",
    BELOW: "below the threshold of {min_eigenvalue}",
    ROUNDING: "0 up to rounding",
    MANY_DIRECTIONS: ", and λ₁ = {lambda_1} is less than {edge_ratio} times as large, so this is no edge but a flat window: its weak \
                      gradients have many directions.",
    FLAT_WINDOW: ", a flat window.",
    FLAT: "Noise would determine the solution, so the flow is unknown.",
    EDGE: ", an edge. The constraint lines are nearly parallel (aperture problem), so the flow is unknown.",
    CORNER: ": λ₁ = {lambda_1} and λ₂ = {lambda_2} exceed the threshold of {min_eigenvalue},",
    NOISY: "λ₂ only slightly, so noise has much influence on the solution.",
    WELL_CONDITIONED: "so the constraint lines intersect well.",
    SOLVED: "Least squares gives (u, v) = {flow}",
    ENDPOINT_ERROR: "; endpoint error {endpoint_error}.",
    END: ".",
    GAPS: "The cost surface ends where the window leaves frame t+1.",
    END_OF_ITERATION: "End of the iteration: {corners} of the windows are corners with flow, {edges} edges, {flat} flat.",
    EIGENVALUES: "{lambda_1} and {lambda_2}: {texture}",
    OUTSIDE_OF: "{outside} of {window_pixels} of the window",
    DEVIATIONS: "{deviation_along} along the gradient, {deviation_across} across",
}

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

/// Factor by which the smaller eigenvalue must exceed the threshold to exceed it clearly.
const CLEAR: f32 = 2.0;

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
            return self.tell_linearization(seen.before.iteration);
        }
        let Some(probe) = self.probe(seen) else { return Step::at(line::START_AT_ZERO).say(case::OPENING) };
        let step = Step::at(if probe.is_solved() { line::SOLVE } else { line::IS_SINGULAR });
        let step = self.tell_window(self.put_window(seen, step, &probe), &probe);
        let plane = self.plane(&seen.before.frame_pair, &probe);
        let step = step.say_if(plane.cost.as_ref().is_some_and(PlaneCost::has_gaps), case::GAPS);
        let step = self.conclude(seen, equations(step, &probe, seen.before.iteration > 0)).show(Readout::Plane(plane));
        let [current, next] = &seen.before.frame_pair.pictures;
        step.show(Readout::Tiles(probe.linear.tiles([current, next], probe.pixel, (self.window / 2).min(5))))
    }

    /// Explains the linearisation before the first row of an iteration.
    fn tell_linearization(&self, iteration: usize) -> Step {
        let step = Step::at(line::LINEARIZE).put(shared::ITERATIONS, self.iterations);
        let step = step.fact_as(shared::ITERATION.is(iteration + 1), shared_case::ITERATION);
        step.say(if iteration == 0 { case::FIRST_ITERATION } else { case::LATER_ITERATION })
    }

    fn put_window(&self, seen: &Seen<Self>, step: Step, probe: &Probe) -> Step {
        let Probe { pixel, linear, tensor, solution, spread } = *probe;
        let (Solution { displacement, eigenvalues: [large, small], texture }, frames) =
            (solution, &seen.before.frame_pair);
        let texture = match texture {
            Texture::Unknown => "unknown",
            Texture::Flat => "flat",
            Texture::Edge => "edge",
            Texture::Corner if small < CLEAR * self.min_eigenvalue => "weak corner",
            Texture::Corner => "corner",
        };
        let mut step = linear.put(step, pixel).put(shared::MIN_EIGENVALUE, self.min_eigenvalue);
        if seen.before.iteration > 0 {
            step = step.fact_of(shared::START.is(linear.start.at(pixel.0, pixel.1)).inked(Role::Best));
        }
        let [outside, all] = self.outside(&linear.factors, pixel);
        step = step.put(value::OTHERS_OUTSIDE, outside.saturating_sub(1)).put(value::WINDOW_PIXELS, all);
        if outside > 0 {
            step = step.fact_as(value::OUTSIDE.is(outside), case::OUTSIDE_OF);
        }
        step = step.put(value::EDGE_RATIO, EDGE_RATIO).put(shared::LAMBDA_2, small).put(value::TEXTURE, texture);
        step = step.fact_as(shared::LAMBDA_1.is(large), case::EIGENVALUES);
        if probe.is_solved() {
            let residual = tensor.residual(displacement).sqrt();
            step = step.fact(value::FLOW, displacement).fact(value::RMS_RESIDUAL, residual);
        }
        if let Some(Spread { radii: [along, across], .. }) = spread {
            let along = value::DEVIATION_ALONG.is(along);
            step = step.put(value::DEVIATION_ACROSS, across).fact_as(along, case::DEVIATIONS);
        }
        let truth = frames.true_displacement(pixel);
        if let Some([u, v]) = truth.filter(|_| probe.is_solved()) {
            step = step.put(value::ENDPOINT_ERROR, (displacement[0] - u).hypot(displacement[1] - v));
        }
        step.fact_if(shared::TRUE_FLOW, truth)
    }

    /// Interprets the eigenvalues of a window.
    fn tell_window(&self, step: Step, probe: &Probe) -> Step {
        let Solution { eigenvalues: [large, small], texture, .. } = probe.solution;
        // An eigenvalue above the threshold is refused only for rounding errors.
        let why = |eigenvalue: f32| -> &'static Case {
            if eigenvalue < self.min_eigenvalue { case::BELOW } else { case::ROUNDING }
        };
        let step = step.say(case::WINDOW);
        match texture {
            Texture::Unknown => step.say(case::ALL_OUTSIDE),
            // The constraint of the pixel itself is unknown; the rest of the window does not determine its flow.
            Texture::Flat | Texture::Edge if !probe.linear.factors.is_known(probe.pixel) => {
                step.say(case::PIXEL_OUTSIDE)
            }
            Texture::Flat if large >= self.min_eigenvalue && small > 0.0 => {
                step.say(case::SMALLER).say(why(small)).say(case::MANY_DIRECTIONS).say(case::FLAT)
            }
            Texture::Flat => step.say(case::BOTH).say(why(large)).say(case::FLAT_WINDOW).say(case::FLAT),
            Texture::Edge => step.say(case::LARGER).say(why(small)).say(case::EDGE),
            Texture::Corner => {
                let is_noisy = small < CLEAR * self.min_eigenvalue;
                let step = step.say(case::CORNER).say(if is_noisy { case::NOISY } else { case::WELL_CONDITIONED });
                let has_error = step.value(value::ENDPOINT_ERROR).is_some();
                step.say(case::SOLVED).say(if has_error { case::ENDPOINT_ERROR } else { case::END })
            }
        }
    }

    /// Adds the conclusion of an iteration and of the run, at the end of each.
    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let (Some(after), None) = (seen.after, seen.point()) else { return step };
        if after.iteration == seen.before.iteration {
            return step;
        }
        if after.iteration == self.iterations {
            return Conclusion::new(&after.frame_pair, &Flow(after.flow(&[])), 1.0).tell(step, &ADVICE);
        }
        let share = |wanted: Texture| {
            let count = after.found.iter().filter(|solution| solution.texture == wanted).count();
            100.0 * count as f32 / after.found.len().max(1) as f32
        };
        let step = step.put(value::CORNERS, share(Texture::Corner)).put(value::EDGES, share(Texture::Edge));
        step.put(value::FLAT, share(Texture::Flat)).say(case::END_OF_ITERATION)
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        field::draw(seen.before.flow(seen.events), scene);
        draw_textures(seen, scene);
        let Some(probe) = self.probe(seen) else { return };
        let ((x, y), reach) = (probe.pixel, self.window as i32 / 2);
        let (left, top, side) = (x as i32 - reach, y as i32 - reach, 2 * reach as usize + 1);
        scene.draw(Picture::CURRENT, (Role::Window, "window"), Shape::pixels(left, top, side, side));
        scene.draw(Picture::CURRENT, (Role::Reference, "inspected pixel"), Shape::pixels(x as i32, y as i32, 1, 1));
        if let Some(spread) = probe.spread {
            let center = [x as f32 + spread.center[0], y as f32 + spread.center[1]];
            let shape = Shape::Ellipse { center, radii: spread.radii, angle_rad: spread.angle_rad };
            scene.draw(Picture::CURRENT, (Role::Measured, "standard deviation of the flow (1 σ)"), shape);
        }
    }

    /// Returns the constraint lines of the window over its squared difference.
    fn plane(&self, frame_pair: &FramePair, probe: &Probe) -> Plane {
        let found = probe.is_solved().then_some(probe.solution.displacement);
        let mut points = vec![("zero flow", Role::Reference, [0.0; 2])];
        points.extend(found.map(|found| ("least squares", Role::Result, found)));
        points.extend(frame_pair.true_displacement(probe.pixel).map(|truth| ("true flow", Role::Truth, truth)));
        let start = probe.linear.start.at(probe.pixel.0, probe.pixel.1);
        let reach = explain::reach(points.iter().map(|(.., point)| *point).chain([start]));
        Plane {
            groups: Vec::new(),
            title: "Mean squared difference and constraint lines",
            unit: "px".into(),
            center: [0.0; 2],
            reach,
            cost: Some(self.squared_difference(frame_pair, probe.pixel, reach)),
            path: [start].into_iter().chain(found).collect(),
            lines: self.lines(&probe.linear.factors, probe.pixel),
            points,
            ellipse: probe.spread,
        }
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
    fn outside(&self, of: &Constraints, (x, y): (usize, usize)) -> [usize; 2] {
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
    // Only every other grid point, so that the edge itself stays visible.
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
            scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(points));
        }
    }
}

/// Writes the normal equations of the window, in symbols and with numbers. After warping (`is_about`), c replaces I_t; its definition
/// is that of the inspected pixel.
fn equations(step: Step, probe: &Probe, is_about: bool) -> Step {
    let Tensor { xx, xy, yy, xt, yt, .. } = probe.tensor;
    let right = if is_about { "c" } else { "I_t" };
    let step = if is_about { probe.linear.define(step, probe.pixel, Unit::SUBPIXEL) } else { step };
    let step = step.formula(format!(r"\sum w\,I_x^2\,u + \sum w\,I_x I_y\,v = -\sum w\,I_x {right}"));
    let step = step.formula(format!(r"\sum w\,I_x I_y\,u + \sum w\,I_y^2\,v = -\sum w\,I_y {right}, \quad \sum w = 1"));
    let unit = Unit::FINE.finer(further_digits(|further| is_solved_by(probe, *further)) as u8);
    let step = step.put_value(value::TENSOR.is([xx, xy, yy]).in_unit(unit));
    let step = step.put_value(value::RIGHT_SIDE.is([-xt, -yt]).in_unit(unit));
    let step = step.formula(r"{tensor:1}\,u {tensor:2:signed}\,v = {right_side:1}");
    let step = step.formula(r"{tensor:2}\,u {tensor:3:signed}\,v = {right_side:2}");
    if probe.is_solved() { step.formula("(u, v) = {flow}") } else { step }
}

/// Whether the normal equations, written with this many further decimals, have the solution as it is written.
fn is_solved_by(probe: &Probe, further: usize) -> bool {
    let Tensor { xx, xy, yy, xt, yt, .. } = probe.tensor;
    let unit = Unit::FINE.finer(further as u8);
    let written = |number: f32| value::RIGHT_SIDE.is(number).in_unit(unit).rounded().unwrap_or(f64::NAN);
    let [xx, xy, yy, xt, yt] = [xx, xy, yy, xt, yt].map(written);
    let det = xx * yy - xy * xy;
    let solution = [xy * yt - yy * xt, xy * xt - xx * yt].map(|minor| minor / det);
    !probe.is_solved() || value::FLOW.is(solution).bare() == value::FLOW.is(probe.solution.displacement).bare()
}
