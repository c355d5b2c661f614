//! The explanation and the drawing of the tracking of one point on one pyramid level.

use super::follow::{Event, Follow};
use super::tracker::{Level, Mismatch};
use crate::geometry::Grid;
use crate::methods::differential::{
    Tensor,
    explain::{self, value as shared},
    unit_of,
};
use crate::products::Status;
use crate::scene::{
    Case, Footing, Picture, Plane, PlaneCost, Readout, Role, Scene, Shape, Step, Tile, Unit, Value, Variable,
};
use crate::{cases, variables};

variables! { pub mod value;
    /// The position of the point in frame t.
    POSITION: "", r"\mathbf{x}", Unit::SUBPIXEL, Role::Reference;
    /// The displacement with which the iterations on the level begin.
    GUESS: "Initial guess", r"\mathbf{g}", Unit::SUBPIXEL, Role::Predicted;
    /// The structure tensor of the window.
    TENSOR: "", r"\mathbf{T}", Unit::FINE, Role::Reference;
    /// The means of δI I_x and δI I_y over the window, where δI is the difference of the windows.
    MISMATCH: "", r"\mathbf{b}", Unit::FINE, Role::Candidate;
    /// The displacement before the increment.
    BEFORE: "", "", Unit::SUBPIXEL, Role::Candidate;
    /// The increment of the displacement in an iteration.
    INCREMENT: "Increment η", r"\mathbf{\eta}", Unit::SUBPIXEL, Role::Candidate;
    /// The stopping criterion: a shorter increment ends the iterations of the level.
    EPSILON: "", r"\epsilon", Unit::SUBPIXEL;
    /// The mean absolute difference of the windows before the increment.
    DIFFERENCE: "Mean |δI| before the increment", "", Unit::GRAY;
    /// The displacement of the point.
    DISPLACEMENT: "Displacement", r"\mathbf{d}", Unit::SUBPIXEL;
    /// The displacement of the point in px of level 0.
    FULL_RESOLUTION: "At full resolution", "", Unit::SUBPIXEL;
    /// Twice the displacement: the initial guess of the next finer level.
    FINER_GUESS: "", "", Unit::SUBPIXEL, Role::Predicted;
    /// The mean absolute difference of the windows at the end of the tracking.
    RESIDUAL: "", "", Unit::GRAY;
    /// The largest accepted residual.
    MAX_RESIDUAL: "", "", Unit::GRAY;
    /// The forward–backward error: the distance of the point from its position after tracking forward and back.
    FB_ERROR: "Forward–backward error", r"|\mathbf{d} + \mathbf{b}|", Unit::SUBPIXEL, Role::Predicted;
    /// The largest accepted forward–backward error.
    MAX_FB_ERROR: "", "", Unit::SUBPIXEL;
    /// The true displacement of the point.
    TRUE_DISPLACEMENT: "True displacement", "", Unit::SUBPIXEL, Role::Truth;
}

cases! { pub over value, shared;
    LEVEL_OF: "{level} ({coarsest_level} is the coarsest)",
    EIGENVALUES: "{lambda_1} and {lambda_2}",
    WINDOW: " on level {level} ({width:bare}×{height}): λ₁ = {lambda_1}, and λ₂ = {lambda_2} is",
    ILL_CONDITIONED: "below the minimum eigenvalue of {min_eigenvalue}, so the window is ill-conditioned.",
    CONDITIONED: "not below the minimum eigenvalue of {min_eigenvalue}, so the window can be tracked.",
    BEGINS: "Initial guess: {guess}.",
    INCREMENT: "Mean absolute difference of the windows at {before}: {difference}. Solving T η = b gives the increment {increment},",
    CONVERGED: "shorter than ε = {epsilon}: converged at {displacement}.",
    NOT_CONVERGED: "not yet shorter than ε = {epsilon}; the displacement is now {displacement}.",
    ESTIMATE: " on level {level}: displacement {displacement}.",
    NO_ESTIMATE: " has no estimate on level {level}",
    PASSED_DOWN: "The guess {displacement} is passed on.",
    DOUBLED: "Its double is the initial guess of the next finer level, {finer_guess}.",
    TRACKED: ": displacement {displacement}. Mean absolute difference of the windows: {residual}, within the maximum residual of \
              {max_residual:bare}.",
    LOST: " is {rejected|lost}",
    OUTSIDE: ": its window leaves the frame.",
    FLAT: ": λ₂ is below the minimum eigenvalue, so its displacement is ill-conditioned (aperture problem).",
    ASTRAY: ": the forward–backward error exceeds its maximum, a sign of occlusion or a wrong match.",
    CHANGED: ": no affine map fits it to its first view, and it does not resemble that view.",
    UNLIKE: ": the residual exceeds the maximum, a sign of occlusion or a wrong match.",
    UNMATCHED: ": no keypoint of the next frame is its match.",
    END: ".",
}

/// The tracking of a point on one level, up to the current event.
pub struct LevelTrace<'a> {
    /// The parameters of the tracking.
    pub follow: Follow,
    /// The pyramids of both frames.
    pub pyramids: [&'a [Level]; 2],
    /// The level.
    pub level: usize,
    /// Its position in px of level 0.
    pub at: [f32; 2],
    /// The initial guess, in px of the level.
    pub guess: [f32; 2],
    /// The events on this level; at least one.
    pub events: Vec<Event>,
}

fn after(from: [f32; 2], update: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|i| from[i] + update[i])
}

impl LevelTrace<'_> {
    /// Returns a displacement in px of this level.
    fn in_px(&self, of: &'static Variable, displacement: [f32; 2]) -> Value {
        of.is(displacement).in_unit(unit_of(self.level))
    }

    /// Whether the level is finished.
    pub fn is_done(&self) -> bool {
        matches!(self.events.last(), Some(Event::PassedDown(..) | Event::End(..)))
    }

    /// Whether the last event is an iteration that meets the stopping criterion.
    pub fn has_converged(&self) -> bool {
        matches!(self.events.last(), Some(Event::Iteration { update, .. }) if self.follow.converges(*update))
    }

    fn scale(&self) -> f32 {
        (1u32 << self.level) as f32
    }

    /// Returns the current displacement, in px of the level.
    pub fn displacement(&self) -> [f32; 2] {
        match self.events.last() {
            None | Some(Event::Window(_)) => self.guess,
            Some(Event::Iteration { from, update, .. }) => after(*from, *update),
            Some(Event::PassedDown(displacement, _) | Event::End(displacement, _)) => *displacement,
        }
    }

    /// Returns the current displacement, in px of level 0.
    pub fn on_picture(&self) -> [f32; 2] {
        self.displacement().map(|c| c * self.scale())
    }

    fn tensor(&self) -> Option<Tensor> {
        self.events.iter().find_map(|event| if let Event::Window(tensor) = event { Some(*tensor) } else { None })
    }

    /// Returns the last iteration: the displacement before it, the mismatch and the increment.
    fn last(&self) -> Option<([f32; 2], Mismatch, [f32; 2])> {
        self.events.iter().rev().find_map(|event| match event {
            Event::Iteration { from, mismatch, update } => Some((*from, *mismatch, *update)),
            _ => None,
        })
    }

    /// Draws the window in the first frame, the initial guess and the iterations in the second.
    pub fn draw(&self, [from, to]: [Picture; 2], scene: &mut Scene) {
        let half = (self.follow.reach as f32 + 0.5) * self.scale();
        let place = |by: [f32; 2]| [0, 1].map(|i| self.at[i] + by[i] * self.scale());
        let rect = |[x, y]: [f32; 2]| Shape::Rect { min: [x - half, y - half], max: [x + half, y + half] };
        let mut mark = |on, role, shape, meaning| {
            scene.draw(on, (role, meaning), shape);
        };
        mark(from, Role::Reference, rect(self.at), "window");
        mark(to, Role::Predicted, rect(place(self.guess)), "initial guess");
        let role = if self.is_done() { Role::Best } else { Role::Candidate };
        mark(to, role, rect(place(self.displacement())), "window in the other frame");
        let steps = self.events.iter().filter_map(|event| match event {
            Event::Iteration { from, update, .. } => Some([*from, after(*from, *update)]),
            _ => None,
        });
        let steps: Vec<_> = steps.collect();
        if let Some(first) = steps.first() {
            let trail = [first[0]].into_iter().chain(steps.iter().map(|step| step[1]));
            mark(to, Role::Estimate, Shape::line(trail.map(place).collect()), "window centre, by iteration");
        }
    }

    /// Puts the values of this level.
    pub fn put(&self, step: Step) -> Step {
        let Follow { epsilon, threshold, max_residual, .. } = self.follow;
        let (width, height) = self.pyramids[0][self.level].size();
        let step = step.put(shared::COARSEST_LEVEL, self.pyramids[0].len() - 1).put(shared::WIDTH, width);
        let step = step.put(shared::HEIGHT, height).put(value::EPSILON, epsilon).put(value::MAX_RESIDUAL, max_residual);
        let step = step.put(shared::MIN_EIGENVALUE, threshold);
        let step =
            step.fact_as(shared::LEVEL.is(self.level), case::LEVEL_OF).fact_of(self.in_px(value::GUESS, self.guess));
        let step = self.tensor().into_iter().fold(step, |step, tensor| {
            let [large, small] = tensor.eigenvalues();
            step.put(shared::LAMBDA_2, small).fact_as(shared::LAMBDA_1.is(large), case::EIGENVALUES)
        });
        let step = self.last().into_iter().fold(step, |step, (from, mismatch, update)| {
            let step = step.put_value(self.in_px(value::BEFORE, from)).fact_of(self.in_px(value::INCREMENT, update));
            step.fact(value::DIFFERENCE, mismatch.residual)
        });
        let role = match self.is_done() {
            false => Role::Candidate,
            true if self.level > 0 => Role::Best,
            true => Role::Result,
        };
        let displacement = self.displacement();
        let step = step.fact_of(self.in_px(value::DISPLACEMENT, displacement).inked(role));
        let Some(finer) = self.level.checked_sub(1) else { return step };
        let doubled = value::FINER_GUESS.is(displacement.map(|c| 2.0 * c)).in_unit(unit_of(finer));
        step.fact(value::FULL_RESOLUTION, self.on_picture()).put_value(doubled)
    }

    /// Explains the last event, once the values are put; `subject` names the point.
    pub fn tell(&self, step: Step, subject: &'static Case) -> Step {
        match self.events.last() {
            None => step.say(subject),
            Some(Event::Window(tensor)) => {
                let verdict = if self.follow.is_flat(tensor) { case::ILL_CONDITIONED } else { case::CONDITIONED };
                step.say(subject).say(case::WINDOW).say(verdict).say(case::BEGINS)
            }
            Some(Event::Iteration { .. }) => {
                step.say(case::INCREMENT).say(if self.has_converged() { case::CONVERGED } else { case::NOT_CONVERGED })
            }
            Some(Event::PassedDown(_, None)) => step.say(subject).say(case::ESTIMATE).say(case::DOUBLED),
            Some(Event::PassedDown(_, Some(status))) => {
                let step = step.say(subject).say(case::NO_ESTIMATE).say(why(*status));
                step.say(case::PASSED_DOWN).say(case::DOUBLED)
            }
            Some(Event::End(_, Ok(residual))) => step.put(value::RESIDUAL, *residual).say(subject).say(case::TRACKED),
            Some(Event::End(_, Err(status))) => step.say(subject).say(case::LOST).say(why(*status)),
        }
    }

    /// Adds the equations of the last increment, the plane of displacements and the windows. `truth` is the true displacement in
    /// px of level 0, where it is known.
    pub fn show_charts(&self, step: Step, truth: Option<[f32; 2]>) -> Step {
        let step = self.tensor().into_iter().fold(step, |step, window| self.equations(step, &window));
        step.show(Readout::Plane(self.plane(truth))).show(Readout::Tiles(self.tiles()))
    }

    /// Writes T η = b in symbols and in numbers.
    fn equations(&self, step: Step, window: &Tensor) -> Step {
        // Only the part of the window inside the other frame counts.
        let last = self.last();
        let Tensor { xx, xy, yy, .. } = last.map_or(*window, |(_, mismatch, _)| mismatch.tensor);
        let tensor = Grid::from_fn(2, 2, |x, y| f64::from([[xx, xy], [xy, yy]][y][x]));
        let step = step.put(value::TENSOR, tensor).formula(
            r"\mathbf{T}\,\mathbf{\eta} = \mathbf{b} = \begin{pmatrix} \bar{\delta I\,I_x} \\ \bar{\delta I\,I_y} \end{pmatrix}",
        );
        let Some((_, Mismatch { vector, .. }, _)) = last else {
            return step.formula(
                r"{tensor} \begin{pmatrix} \eta_u \\ \eta_v \end{pmatrix} = \begin{pmatrix} \text{?} \\ \text{?} \end{pmatrix}",
            );
        };
        let step = step.put(value::MISMATCH, Grid::from_fn(1, 2, |_, y| f64::from(vector[y])));
        let step = step.formula(r"{tensor} \begin{pmatrix} \eta_u \\ \eta_v \end{pmatrix} = {mismatch}");
        step.formula(r"\mathbf{\eta} = {increment}")
    }

    /// Returns the squared difference of the windows around the initial guess, with the iterations on it.
    fn plane(&self, truth: Option<[f32; 2]>) -> Plane {
        let iterations = self.events.iter().filter_map(|event| match event {
            Event::Iteration { from, update, .. } => Some(after(*from, *update)),
            _ => None,
        });
        let path: Vec<_> = [self.guess].into_iter().chain(iterations).collect();
        let mut points = vec![("initial guess", Role::Predicted, self.guess)];
        points.extend((path.len() > 1).then(|| ("current estimate", Role::Candidate, self.displacement())));
        points.extend(truth.map(|truth| ("true flow", Role::Truth, truth.map(|c| c / self.scale()))));
        let from_guess = |point: [f32; 2]| [0, 1].map(|i| point[i] - self.guess[i]);
        let known = path.iter().copied().chain(points.iter().map(|(.., point)| *point));
        // So that the valley is in sight before the first step.
        let reach = explain::reach(known.map(from_guess)).max(2.0);
        Plane {
            title: "Mean squared difference of the windows",
            unit: unit_of(self.level).name.into(),
            center: self.guess,
            reach,
            cost: Some(self.squared_difference(reach)),
            groups: Vec::new(),
            lines: Vec::new(),
            path,
            points,
            ellipse: None,
        }
    }

    /// Returns the mean of (δI)² over the window for the displacements up to `reach` from the initial guess; NaN where part of the window
    /// leaves the other frame.
    fn squared_difference(&self, reach: f32) -> PlaneCost {
        let [current, next] = self.pyramids.map(|levels| &levels[self.level]);
        let radius = self.follow.reach as isize;
        let at = self.at.map(|c| c / self.scale());
        let along = || (-radius..=radius).map(|by| by as f32);
        let places = along().flat_map(|j| along().map(move |i| [at[0] + i, at[1] + j]));
        let window: Vec<_> =
            places.filter(|place| current.holds(*place)).map(|place| (place, current.sample(place))).collect();
        let cost = |[u, v]: [f32; 2]| {
            let squared = |([x, y], gray): &([f32; 2], f32)| {
                let there = [x + u, y + v];
                if next.holds(there) { (next.sample(there) - gray).powi(2) } else { f32::NAN }
            };
            window.iter().map(squared).sum::<f32>() / window.len() as f32
        };
        let footing = Footing { px: self.scale(), ..Footing::new(Picture::NEXT, self.at) };
        PlaneCost::sampled(explain::SQUARED_DIFFERENCE, (self.guess, reach), window.len(), cost).on(footing)
    }

    /// Returns the window, its position in the other frame, and their difference δI.
    fn tiles(&self) -> Vec<Tile> {
        let [current, next] = self.pyramids.map(|levels| &levels[self.level]);
        let (reach, side) = (self.follow.reach as f32, 2 * self.follow.reach + 1);
        let at = self.at.map(|c| c / self.scale());
        let of = |level: &Level, by: [f32; 2]| {
            Grid::from_fn(side, side, |i, j| {
                let place = [at[0] + by[0] + i as f32 - reach, at[1] + by[1] + j as f32 - reach];
                if level.holds(place) { (level.sample(place) * 10.0).round() / 10.0 } else { f32::NAN }
            })
        };
        let (window, there) = (of(current, [0.0; 2]), of(next, self.displacement()));
        let difference = Grid::from_fn(side, side, |i, j| window[(i, j)] - there[(i, j)]);
        vec![
            Tile::gray("Window in frame t", window).with_role(Role::Reference),
            Tile::gray("Window in frame t+1", there).with_role(Role::Candidate),
            Tile::signed("δI", difference),
        ]
    }
}

/// Why a feature is lost, or has no estimate on a level, as the end of a sentence.
pub fn why(status: Status) -> &'static Case {
    match status {
        Status::Outside => case::OUTSIDE,
        Status::Flat => case::FLAT,
        Status::Astray => case::ASTRAY,
        Status::Changed => case::CHANGED,
        Status::Unlike => case::UNLIKE,
        Status::Unmatched => case::UNMATCHED,
        Status::Found | Status::Tracked => case::END,
    }
}
