//! Normal flow: the flow component along the gradient, from single pixels.
//!
//! ```text
//!     v
//!     ↑   ╲  I_x u + I_y v + I_t = 0
//!     │    ╲        every (u, v) on the constraint line satisfies brightness constancy;
//!     │   ↗ ╲       the shortest lies along the gradient: the normal flow
//!     └──────╲──→ u
//! ```

use std::sync::Arc;

use crate::base::words::rounded;
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::differential::{Advice, Conclusion, Derivatives, FLAT, FramePair, Scheme, explain, field, numbers};
use crate::products::{Confidence, DenseField, Output, Product, ProductKind};
use crate::run::{
    Cursor, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen,
};
use crate::scene::{Chart, Focus, Picture, Plane, Question, Readout, Reply, Role, Scene, Shape, Step, Unit};
use crate::{cases, params, pseudocode, variables};

params! {
    /// Normal flow: the flow component along the gradient, which a single pixel determines (aperture problem).
    pub struct NormalFlow {
        /// Kernel that estimates the derivatives I_x and I_y.
        derivatives: Scheme = Scheme::Central;
        /// Standard deviation σ of the Gaussian that smooths both frames before derivatives are taken. 0 does not smooth.
        sigma: f32 = 1.0, 0.0..=5.0, "px";
        /// Smallest gradient magnitude |∇I| with flow, in gray levels per px. Higher values suppress noise but leave more pixels without flow.
        min_gradient: f32 = 3.0, 0.0..=50.0;
    }
}

/// Remedies where normal flow fails.
const ADVICE: Advice =
    Advice { texture: case::ADVISE_TEXTURE, boundary: case::ADVISE_BOUNDARY, motion: case::ADVISE_MOTION };

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// The flow of the completed rows.
    found: Vec<[f32; 2]>,
}

/// The constant part of a run.
struct Fixed {
    frame_pair: FramePair,
    derivatives: Derivatives,
}

/// The normal flow of the next pixel of the row; NaN below the threshold.
pub type Event = [f32; 2];

impl NormalFlow {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let frame_pair = FramePair::new(clip, frame, self.sigma, threads)?;
        let derivatives = self.derivatives.of(&frame_pair.pictures[0], &frame_pair.pictures[1], threads);
        Ok(State { fixed: Arc::new(Fixed { frame_pair, derivatives }), found: Vec::new() })
    }

    /// Returns the point of the line a u + b v + c = 0 nearest to the origin, if the gradient (a, b) is large enough.
    #[inline(always)]
    fn nearest(&self, [a, b, c]: [f32; 3]) -> [f32; 2] {
        let squared = a * a + b * b;
        if squared > FLAT && squared >= self.min_gradient * self.min_gradient {
            [-c * a / squared, -c * b / squared]
        } else {
            Flow::UNKNOWN
        }
    }

    /// Computes the flow of row `y`.
    fn row(&self, of: &Derivatives, y: usize, row: &mut [[f32; 2]], observer: &mut impl Observer<Event>) {
        let gradients = of.x.row(y).iter().zip(of.y.row(y));
        for (found, ((&a, &b), &c)) in row.iter_mut().zip(gradients.zip(of.t.row(y))) {
            *found = self.nearest([a, b, c]);
            observer.see(|| *found);
        }
    }
}

impl State {
    fn width(&self) -> usize {
        self.fixed.frame_pair.size().0
    }

    /// Returns the next row.
    fn y(&self) -> usize {
        self.found.len() / self.width()
    }

    /// Returns the flow so far, with `more` of the next row.
    fn flow(&self, more: &[Event]) -> Grid<[f32; 2]> {
        let (width, height) = self.fixed.frame_pair.size();
        let mut flow = Grid::new(width, height, Flow::UNKNOWN);
        let (done, rest) = flow.cells_mut().split_at_mut(self.found.len());
        done.copy_from_slice(&self.found);
        rest[..more.len()].copy_from_slice(more);
        flow
    }
}

variables! {
    /// The normal flow: the flow component along the gradient.
    NORMAL_FLOW: "Normal flow", r"(u, v)", Unit::SUBPIXEL, Role::Result;
    /// The smallest gradient magnitude with flow.
    LEAST_GRADIENT: "Threshold", r"|\nabla I|_{\min}", explain::GRADIENT_UNIT;
    /// The change of the brightness of the pixel per frame.
    CHANGE: "Change of brightness", r"|I_t|", Unit::new("gray levels per frame", 2);
}

cases! { over value, explain::value;
    OPENING: "Brightness constancy gives one equation per pixel for two unknowns, so a single pixel determines only the flow along its \
              gradient. Both frames are smoothed first, because derivatives amplify noise.",
    BELOW: "{reference|Pixel} {pixel}: |∇I| = {gradient} is below the threshold of {least_gradient:bare}: noise would dominate, so the flow \
            is unknown.",
    ROUNDING: "{reference|Pixel} {pixel}: |∇I| = {gradient} is no more than rounding error, so the flow is unknown.",
    STEADY: "{reference|Pixel} {pixel}: |∇I| = {gradient}, and the brightness does not change.",
    BRIGHTER: "{reference|Pixel} {pixel}: |∇I| = {gradient}, and the pixel gets brighter by {change}.",
    DARKER: "{reference|Pixel} {pixel}: |∇I| = {gradient}, and the pixel gets darker by {change}.",
    FLOW: "The normal flow is {normal_flow}, across the edge; the component along the edge is unknown (aperture problem).",
    ADVISE_TEXTURE: "Lucas–Kanade combines the constraints of a window and finds both components where their gradients differ.",
    ADVISE_BOUNDARY: "The temporal derivative mixes both motions there; a smaller sigma mixes less.",
    ADVISE_MOTION: "A pyramid, as in Horn–Schunck with several levels, would reach this motion.",
}

pseudocode! {
    TAKE_DERIVATIVES: "smooth both frames by a Gaussian of σ px; I_x, I_y ← derivatives of their mean; I_t ← their difference",
    EACH_PIXEL: "for each pixel with the gradient constraint I_x u + I_y v + I_t = 0, a line in the (u, v) plane",
    IS_FLAT: "  if |∇I| < min-gradient: flow unknown",
    TAKE_NEAREST: "  else (u, v) ← −I_t ∇I / |∇I|², the point of the line nearest to (0, 0)",
}

impl Estimator for NormalFlow {
    const INFO: Info = Info {
        id: "normal-flow",
        name: "Normal flow",
        family: "Optical flow",
        summary: "The flow component along the gradient of each pixel; the component along the edge is unknown (aperture problem).",
        source: "C. L. Fennema and W. B. Thompson, Velocity determination in scenes containing several moving objects, \
                 Computer Graphics and Image Processing 9(4), 1979; aperture problem: S. Ullman, The Interpretation of \
                 Visual Motion, MIT Press 1979",
        pseudocode: line::ALL,
        granularities: &["frame", "row", "pixel"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "known",
        "Will the next pixel have a normal flow?",
        &[
            Reply::at(line::TAKE_NEAREST, "Yes: its gradient is large enough"),
            Reply::at(line::IS_FLAT, "No: its gradient is too small"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::AlongGradient;
    const TELLS_CONFIDENCE: bool = true;
    const CHARTS: &'static [Chart] = &[Chart::Plane, Chart::Tiles];
    const PRODUCES: &'static [&'static ProductKind] = &[DenseField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let mut row = vec![Flow::UNKNOWN; state.width()];
        self.row(&state.fixed.derivatives, state.y(), &mut row, observer);
        state.found.extend(row);
        Ok(if state.y() == state.fixed.frame_pair.size().1 { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.fixed.frame_pair.size().1)
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.y(), of: self.units(state) }]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let Some(pixel) = pixel(seen) else { return Step::at(line::TAKE_DERIVATIVES).say(case::OPENING) };
        let fixed = &seen.before.fixed;
        let found = self.nearest(fixed.derivatives.at(pixel));
        let step = Step::at(if found[0].is_finite() { line::TAKE_NEAREST } else { line::IS_FLAT });
        let step = self.tell_flow(fixed.derivatives.put(step, pixel), found);
        self.add_charts(conclude(seen, step), fixed, (pixel, found))
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        field::draw(seen.before.flow(seen.events), scene);
        if let Some((x, y)) = pixel(seen) {
            scene.draw(Picture::CURRENT, (Role::Reference, "inspected pixel"), Shape::pixels(x as i32, y as i32, 1, 1));
        }
    }

    fn output(&self, state: &State) -> Output {
        let Derivatives { x, y, .. } = &state.fixed.derivatives;
        let mut values = x.clone();
        for (value, &y) in values.cells_mut().iter_mut().zip(y.cells()) {
            // The same as hypot, but vectorised.
            *value = (f64::from(*value).powi(2) + f64::from(y).powi(2)).sqrt() as f32;
        }
        let confidence = Some(Confidence { name: "gradient", values });
        Output::of(DenseField { flow: Flow(state.flow(&[])), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        clip.wanted()?;
        tally.add_units(state.fixed.frame_pair.size().1);
        let (width, height) = state.fixed.frame_pair.size();
        let mut flow = Grid::new(width, height, [0.0; 2]);
        threads.rows(&mut flow, |y, row| self.row(&state.fixed.derivatives, y, row, &mut tally.counter()));
        state.found = flow.into_cells();
        Ok(state)
    }
}

impl Footprint<State> for NormalFlow {
    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [44.0, 100.0])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.found[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let Fixed { frame_pair, derivatives } = &*state.fixed;
        self.state_bytes(state) + frame_pair.bytes() + derivatives.bytes()
    }
}

impl Pointed<State> for NormalFlow {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.fixed.frame_pair.pixel_at(point).map(|(_, y)| y)
    }

    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        let (x, y) = state.fixed.frame_pair.pixel_at(point)?;
        Some(Explained::From(Cursor { unit: y, event: x + 1 }))
    }
}

/// The inspected pixel: the one pointed at, else the current one.
fn pixel(seen: &Seen<NormalFlow>) -> Option<(usize, usize)> {
    let last = seen.events.len().checked_sub(1)?;
    let pointed_at = seen.point().and_then(|point| seen.before.fixed.frame_pair.pixel_at(point));
    Some(pointed_at.unwrap_or((last, seen.before.y())))
}

impl NormalFlow {
    /// Tells the flow of a pixel from its derivatives.
    fn tell_flow(&self, step: Step, found: [f32; 2]) -> Step {
        let [x, y, change] = [explain::value::I_X, explain::value::I_Y, explain::value::I_T].map(|of| step.real(of));
        let gradient = x.hypot(y);
        let step = step.fact(explain::value::GRADIENT, gradient).put(value::LEAST_GRADIENT, self.min_gradient);
        if !found[0].is_finite() {
            let is_below = gradient < f64::from(self.min_gradient);
            return explain::constraint(step.say(if is_below { case::BELOW } else { case::ROUNDING }));
        }
        let is_steady = rounded(change, numbers::GRAY_DECIMALS) == 0.0;
        let changes = if change > 0.0 { case::BRIGHTER } else { case::DARKER };
        let step = step.put(value::CHANGE, change.abs()).fact(value::NORMAL_FLOW, found);
        let step = step.say(if is_steady { case::STEADY } else { changes }).say(case::FLOW);
        explain::constraint(step).formula(r"(u, v) = -\frac{I_t \nabla I}{|\nabla I|^2} = {normal_flow}")
    }

    fn add_charts(&self, step: Step, fixed: &Fixed, (pixel, found): ((usize, usize), [f32; 2])) -> Step {
        let Fixed { frame_pair, derivatives } = fixed;
        let (factors, truth) = (derivatives.at(pixel), frame_pair.true_displacement(pixel));
        let is_known = found[0].is_finite();
        let mut points = vec![("zero flow", Role::Reference, [0.0; 2])];
        points.extend(is_known.then_some(("normal flow", Role::Result, found)));
        points.extend(truth.map(|truth| ("true flow", Role::Truth, truth)));
        // Below the threshold the line is as uncertain as its gradient is weak.
        let weight = if is_known { 1.0 } else { (factors[0].hypot(factors[1]) / self.min_gradient).min(1.0) };
        let plane = Plane {
            title: "Constraint line",
            unit: "px".into(),
            reach: explain::reach(points.iter().map(|(.., point)| *point)),
            center: [0.0; 2],
            cost: None,
            path: Vec::new(),
            groups: Vec::new(),
            lines: explain::line(factors, weight, Role::Candidate).into_iter().collect(),
            points,
            ellipse: None,
        };
        let [current, next] = &frame_pair.pictures;
        let step = match truth {
            Some(truth) => step.fact(explain::value::TRUE_FLOW, truth),
            None => step,
        };
        step.show(Readout::Plane(plane)).show(Readout::Tiles(derivatives.tiles([current, next], pixel, 3)))
    }
}

fn conclude(seen: &Seen<NormalFlow>, step: Step) -> Step {
    let (Some(after), None) = (seen.after, seen.point()) else { return step };
    let frames = &after.fixed.frame_pair;
    if after.y() < frames.size().1 {
        return step;
    }
    Conclusion::new(frames, &Flow(after.flow(&[])), 1.0).tell(step, &ADVICE)
}
