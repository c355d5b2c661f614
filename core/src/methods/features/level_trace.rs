//! The explanation and the drawing of the tracking of one point on one pyramid level.

use super::follow::{Event, Follow};
use super::tracker::{Level, Mismatch};
use crate::geometry::Grid;
use crate::methods::differential::{Tensor, explain, numbers};
use crate::products::Status;
use crate::scene::{Fact, Footing, Math, Picture, Plane, PlaneCost, Readout, Role, Scene, Sentence, Shape, Tile};

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
    /// Its name: `Point 7`.
    pub name: String,
}

fn px(uv: [f32; 2]) -> String {
    in_px(uv, 0)
}

/// A displacement in px of a level.
fn in_px(uv: [f32; 2], level: usize) -> String {
    let of = if level == 0 { String::new() } else { format!(" of level {level}") };
    format!("{} px{of}", numbers::vector(uv))
}

fn after(from: [f32; 2], update: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|i| from[i] + update[i])
}

impl LevelTrace<'_> {
    /// Returns a displacement on this level as text.
    fn px(&self, uv: [f32; 2]) -> String {
        in_px(uv, self.level)
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

    /// Returns the last increment and its mismatch.
    fn last(&self) -> Option<(Mismatch, [f32; 2])> {
        self.events.iter().rev().find_map(|event| match event {
            Event::Iteration { mismatch, update, .. } => Some((*mismatch, *update)),
            _ => None,
        })
    }

    /// Draws the window in the first frame, the initial guess and the iterations in the second.
    pub fn draw(&self, [from, to]: [Picture; 2], scene: &mut Scene) {
        let half = (self.follow.reach as f32 + 0.5) * self.scale();
        let place = |by: [f32; 2]| [0, 1].map(|i| self.at[i] + by[i] * self.scale());
        let rect = |[x, y]: [f32; 2]| Shape::Rect { min: [x - half, y - half], max: [x + half, y + half] };
        let mut mark = |on, role, shape, meaning| {
            scene.mark(on, role, shape);
            scene.legend(role, meaning);
        };
        mark(from, Role::Reference, rect(self.at), "window");
        mark(to, Role::Predicted, rect(place(self.guess)), "initial guess");
        let is_done = matches!(self.events.last(), Some(Event::PassedDown(..) | Event::End(..)));
        let role = if is_done { Role::Best } else { Role::Candidate };
        mark(to, role, rect(place(self.displacement())), "window in the other frame");
        let steps = self.events.iter().filter_map(|event| match event {
            Event::Iteration { from, update, .. } => Some([*from, after(*from, *update)]),
            _ => None,
        });
        let steps: Vec<_> = steps.collect();
        if let Some(first) = steps.first() {
            let trail = [first[0]].into_iter().chain(steps.iter().map(|step| step[1]));
            mark(
                to,
                Role::Estimate,
                Shape::Path { points: trail.map(place).collect(), closed: false },
                "window centre, by iteration",
            );
        }
    }

    /// Explains the last event in words.
    pub fn sentence(&self) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, self.name.clone());
        let (width, height) = self.pyramids[0][self.level].size();
        match self.events.last() {
            None => said,
            Some(Event::Window(tensor)) => {
                let [large, small] = tensor.eigenvalues().map(numbers::gray);
                let threshold = numbers::gray(self.follow.threshold);
                let verdict = match self.follow.is_flat(tensor) {
                    true => format!("below the minimum eigenvalue of {threshold}, so the window is ill-conditioned"),
                    false => format!("not below the minimum eigenvalue of {threshold}, so the window can be tracked"),
                };
                let explanation = format!(
                    " on level {} ({width}×{height} px): λ₁ = {large}, and λ₂ = {small} is {verdict}. Initial guess: ",
                    self.level
                );
                said.text(explanation).ink(Role::Predicted, self.px(self.guess)).text(".")
            }
            Some(Event::Iteration { from, mismatch, update }) => {
                let epsilon = numbers::px(self.follow.epsilon);
                let end = match self.follow.converges(*update) {
                    true => format!(", shorter than ε = {epsilon} px: converged at "),
                    false => format!(", not yet shorter than ε = {epsilon} px; the displacement is now "),
                };
                Sentence::default()
                    .text("Mean absolute difference of the windows at ")
                    .ink(Role::Candidate, self.px(*from))
                    .text(format!(
                        ": {} gray levels. Solving T η = b gives the increment {}{end}",
                        numbers::gray(mismatch.residual),
                        self.px(*update)
                    ))
                    .ink(Role::Candidate, self.px(after(*from, *update)))
                    .text(".")
            }
            Some(Event::PassedDown(displacement, reason)) => {
                let explanation = match reason {
                    None => format!(" on level {}: displacement {}.", self.level, self.px(*displacement)),
                    Some(status) => format!(
                        " has no estimate on level {}{} The guess {} is passed on.",
                        self.level,
                        why(*status),
                        self.px(*displacement)
                    ),
                };
                let explanation = format!("{explanation} Its double is the initial guess of the next finer level, ");
                said.text(explanation)
                    .ink(Role::Predicted, in_px(displacement.map(|c| 2.0 * c), self.level - 1))
                    .text(".")
            }
            Some(Event::End(displacement, Ok(residual))) => {
                let residual = format!(
                    ". Mean absolute difference of the windows: {} gray levels, within the maximum residual of {}.",
                    numbers::gray(*residual),
                    numbers::gray(self.follow.max_residual)
                );
                said.text(": displacement ").ink(Role::Result, px(*displacement)).text(residual)
            }
            Some(Event::End(_, Err(status))) => said.text(" is ").ink(Role::Rejected, "lost").text(why(*status)),
        }
    }

    /// Returns the facts of this level.
    pub fn facts(&self) -> Vec<Fact> {
        let fact = |label, value: String, role| Fact::new(label, value, role);
        let mut facts = vec![
            fact("Level", format!("{} ({} is the coarsest)", self.level, self.pyramids[0].len() - 1), None),
            fact("Initial guess", self.px(self.guess), Some(Role::Predicted)),
        ];
        if let Some(tensor) = self.tensor() {
            let [large, small] = tensor.eigenvalues().map(numbers::gray);
            facts.push(fact("Eigenvalues λ₁, λ₂", format!("{large} and {small}"), None));
        }
        if let Some((mismatch, update)) = self.last() {
            facts.push(fact("Increment η", self.px(update), Some(Role::Candidate)));
            facts.push(fact(
                "Mean |δI| before the increment",
                format!("{} gray levels", numbers::gray(mismatch.residual)),
                None,
            ));
        }
        let role = if self.level == 0 { Role::Result } else { Role::Best };
        facts.push(fact("Displacement", self.px(self.displacement()), Some(role)));
        if self.level > 0 {
            facts.push(fact("At full resolution", px(self.on_picture()), None));
        }
        facts
    }

    /// Returns the equations of the last increment, the plane of displacements and the windows. `truth` is the true displacement in
    /// px of level 0, where it is known.
    pub fn readouts(&self, truth: Option<[f32; 2]>) -> Vec<Readout> {
        let equation = self.tensor().map(|tensor| Readout::Equation(equation(&tensor, self.last())));
        let others = [Readout::Plane(self.plane(truth)), Readout::Tiles(self.tiles())];
        equation.into_iter().chain(others).collect()
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
            unit: if self.level == 0 { "px".into() } else { format!("px of level {}", self.level) },
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
        let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(v.abs()));
        let tile = |label, role, values, range| Tile { label, role, values, range, framed: Vec::new() };
        vec![
            tile("Window in frame t", Some(Role::Reference), window, [0.0, 255.0]),
            tile("Window in frame t+1", Some(Role::Candidate), there, [0.0, 255.0]),
            tile("δI", None, difference, [-most, most]),
        ]
    }
}

/// Why a feature is lost, or has no estimate on a level, as the end of a sentence.
pub fn why(status: Status) -> &'static str {
    match status {
        Status::Outside => ": its window leaves the frame.",
        Status::Flat => {
            ": λ₂ is below the minimum eigenvalue, so its displacement is ill-conditioned (aperture problem)."
        }
        Status::Astray => ": the forward–backward error exceeds its maximum, a sign of occlusion or a wrong match.",
        Status::Changed => ": no affine map fits it to its first view, and it does not resemble that view.",
        Status::Unlike => ": the residual exceeds the maximum, a sign of occlusion or a wrong match.",
        Status::Unmatched => ": no keypoint of the next frame is its match.",
        Status::Found | Status::Tracked => ".",
    }
}

/// T η = b in symbols and in numbers.
fn equation(window: &Tensor, last: Option<(Mismatch, [f32; 2])>) -> Vec<Math> {
    // Only the part of the window inside the other frame counts.
    let tensor = last.as_ref().map_or(window, |(mismatch, _)| &mismatch.tensor);

    let eta = |index| Math::indexed(Math::Var("η"), Math::Var(index));
    let product = |along| {
        let factors = vec![Math::text("δ"), Math::Var("I"), Math::text(" "), explain::derivative(along)];
        Math::mean(Math::Row(factors))
    };
    let symbols = Math::Row(vec![
        Math::Bold("T"),
        Math::text(" "),
        Math::Bold("η"),
        Math::text(" = "),
        Math::Bold("b"),
        Math::text(" = "),
        Math::column([product("x"), product("y")]),
    ]);
    let entry = |value: f32| Math::ink(Role::Reference, numbers::gray(value));
    let right = |value: Option<f32>| Math::ink(Role::Candidate, value.map_or_else(|| "?".into(), numbers::gray));
    let vector = last.map(|(mismatch, _)| mismatch.vector);
    let numbers = Math::Row(vec![
        Math::Matrix(vec![vec![entry(tensor.xx), entry(tensor.xy)], vec![entry(tensor.xy), entry(tensor.yy)]]),
        Math::column([eta("u"), eta("v")]),
        Math::text(" = "),
        Math::column([0, 1].map(|i| right(vector.map(|b| b[i])))),
    ]);
    let mut lines = vec![symbols, numbers];
    lines.extend(last.map(|(_, update)| {
        Math::Row(vec![Math::Bold("η"), Math::text(" = "), Math::ink(Role::Result, numbers::vector(update))])
    }));
    lines
}
