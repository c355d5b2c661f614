//! Pyramidal Lucas-Kanade: features are tracked from coarse to fine.

use std::sync::Arc;

use crate::differential::{Tensor, tell, truth};
use crate::features::detect;
use crate::features::tracker::{Level, Mismatch, Template};
use crate::interest_points::ShiTomasi;
use crate::pyramid::halvings;
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Sentence, Shape, Tile};
use crate::{
    Clip, Error, Estimator, Feature, Flow, Grid, Info, Observer, Output, PointField, Progress, Promise, Role, Rung,
    Scene, Seen, Status, Step, Threads, choices, params,
};

choices! {
    /// Which points are tracked.
    pub enum Points {
        /// The corners that Shi and Tomasi's detector finds, with its defaults.
        Detect = "detect" "Detected corners",
        /// Those of an even grid.
        Grid = "grid" "Grid",
    }
}

params! {
    /// Lucas and Kanade's method for single points, from a coarse level of a pyramid to the picture itself.
    pub struct PyramidalLucasKanade {
        /// Which points are tracked.
        points: Points = Points::Detect;
        /// At most so many points, of corners the strongest.
        max_points: usize = 500, 1..=5000;
        /// Side of the window around each point, on every level; an even one reaches as far as the next odd one.
        window: usize = 21, 3..=31, "px";
        /// Levels of the pyramid with the picture itself, each half as wide and high; fewer where a side would be less than 16 px.
        levels: usize = 4, 1..=8;
        /// At most so many updates of a displacement on each level.
        iterations: usize = 30, 1..=100;
        /// An update shorter than this, in px of its level, is the last there.
        epsilon: f32 = 0.01, 0.0..=1.0, "px";
        /// A point is lost where the smaller eigenvalue of its window's tensor, in (gray levels per px)² for a pixel, is less.
        threshold: f32 = 0.5, 0.0..=100.0;
        /// A point is lost where its window differs by more than this on average where it led to, in gray levels.
        max_residual: f32 = 20.0, 0.0..=255.0;
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// What became of the points that are done.
    found: Vec<Feature>,
    /// The level at hand.
    level: usize,
    /// The displacement with which it begins, in px of the level.
    guess: [f32; 2],
}

/// What stays the same all along.
struct Fixed {
    /// The levels of both frames, the picture itself first.
    levels: [Vec<Level>; 2],
    points: Vec<[f32; 2]>,
    truth: Option<Arc<Flow>>,
}

/// What happens to a point on one level; displacements are in px of the level.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// There is no point at all.
    Nothing,
    /// Its window in frame t has this tensor.
    Window(Tensor),
    /// Its window was laid at `from` in frame t + 1, and moves by `update`.
    Iteration {
        /// The displacement before.
        from: [f32; 2],
        /// How the window fits there.
        mismatch: Mismatch,
        /// What is added to the displacement.
        update: [f32; 2],
    },
    /// The level is done: with this displacement, which the finer level takes twice, or on the finest with this result.
    End([f32; 2], Result<f32, Status>),
}

/// What a point has come to on a level: its displacement, and its residual or why it is lost.
type Tracked = ([f32; 2], Result<f32, Status>);

impl PyramidalLucasKanade {
    fn reach(&self) -> usize {
        self.window / 2
    }

    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let pair = clip.pair(frame)?;
        let points = match self.points {
            Points::Detect => {
                let detector = ShiTomasi { max_points: self.max_points, ..ShiTomasi::default() };
                detect(&detector, Arc::clone(&pair[0]), threads).iter().map(|feature| feature.at).collect()
            }
            Points::Grid => grid(clip.size(), self.max_points),
        };
        let of_frame = |i: usize| {
            let levels = halvings(pair[i].luma(), self.levels);
            levels.iter().map(|level| Level::new(level, self.reach())).collect::<Vec<_>>()
        };
        let levels = <[_; 2]>::try_from(threads.map(2, of_frame)).unwrap_or_default();
        let level = levels[0].len() - 1;
        let fixed = Fixed { levels, points, truth: truth(clip, frame) };
        Ok(State { fixed: Arc::new(fixed), found: Vec::new(), level, guess: [0.0; 2] })
    }

    /// Tracks the point at `at`, in px of the picture, on one level, beginning with a guess.
    fn track(
        &self,
        (fixed, level): (&Fixed, usize),
        (at, guess): ([f32; 2], [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> Tracked {
        let [current, next] = fixed.levels.each_ref().map(|levels| &levels[level]);
        let at = at.map(|c| c / (1u32 << level) as f32);
        let template = Template::new(current, at, self.reach());
        observer.see(|| Event::Window(template.tensor));
        let (displacement, is_told) = self.iterate((&template, next), (at, guess), observer);
        let (displacement, result) = match is_told {
            Ok(()) if level > 0 => (displacement, Ok(f32::NAN)),
            // Where a coarse level says nothing, its guess is handed on.
            Err(_) if level > 0 => (guess, Ok(f32::NAN)),
            Err(why) => (displacement, Err(why)),
            Ok(()) => {
                let residual = template.mismatch(next, [0, 1].map(|i| at[i] + displacement[i])).residual;
                (displacement, if residual > self.max_residual { Err(Status::Unlike) } else { Ok(residual) })
            }
        };
        observer.see(|| Event::End(displacement, result));
        (displacement, result)
    }

    /// Moves the window until it fits.
    fn iterate(
        &self,
        (template, next): (&Template, &Level),
        (at, guess): ([f32; 2], [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> ([f32; 2], Result<(), Status>) {
        let [large, small] = template.tensor.eigenvalues();
        // Even without a threshold, two lines that are one do not cross.
        if small <= 1e-5 * large || small < self.threshold {
            return (guess, Err(Status::Flat));
        }
        let mut displacement = guess;
        for _ in 0..self.iterations {
            let place = [0, 1].map(|i| at[i] + displacement[i]);
            if !next.holds(place) {
                return (displacement, Err(Status::Outside));
            }
            let mismatch = template.mismatch(next, place);
            let update = template.update(mismatch);
            let from = displacement;
            observer.see(|| Event::Iteration { from, mismatch, update });
            displacement = [0, 1].map(|i| from[i] + update[i]);
            if update[0].hypot(update[1]) < self.epsilon {
                break;
            }
        }
        let is_inside = next.holds([0, 1].map(|i| at[i] + displacement[i]));
        (displacement, if is_inside { Ok(()) } else { Err(Status::Outside) })
    }

    /// Tracks a point through all levels.
    fn whole(&self, fixed: &Fixed, at: [f32; 2]) -> Feature {
        let (mut guess, mut result) = ([0.0; 2], Ok(0.0));
        for level in (0..fixed.levels[0].len()).rev() {
            let (displacement, told) = self.track((fixed, level), (at, guess), &mut ());
            (guess, result) = (displacement.map(|c| if level > 0 { 2.0 * c } else { c }), told);
        }
        feature(at, (guess, result))
    }
}

/// The points of an even grid on a picture of a `size`, at most `most` of them.
fn grid((width, height): (usize, usize), most: usize) -> Vec<[f32; 2]> {
    let mut spacing = ((width * height) as f64 / most as f64).sqrt().ceil().max(1.0) as usize;
    let along = |extent: usize, spacing: usize| ((spacing.min(extent) - 1) / 2..extent).step_by(spacing);
    while along(width, spacing).count() * along(height, spacing).count() > most {
        spacing += 1;
    }
    let row = |y: usize| along(width, spacing).map(move |x| [x as f32, y as f32]);
    along(height, spacing).flat_map(row).collect()
}

/// What a point has come to, as others know it.
fn feature(at: [f32; 2], (displacement, result): Tracked) -> Feature {
    match result {
        Ok(residual) => {
            Feature { at, displacement: Some(displacement), status: Status::Tracked, residual: Some(residual) }
        }
        Err(status) => Feature { at, displacement: None, status, residual: None },
    }
}

impl Estimator for PyramidalLucasKanade {
    const INFO: Info = Info {
        id: "pyramidal-lucas-kanade",
        name: "Pyramidal Lucas–Kanade",
        family: "Optical flow",
        summary: "Tracks single points from a coarse level of a pyramid to the picture, window by window.",
        source: "J.-Y. Bouguet, Pyramidal implementation of the Lucas Kanade feature tracker: description of the algorithm, \
                 Intel Corporation, Microprocessor Research Labs, 2000",
        pseudocode: &[
            "make a pyramid of frame t and one of frame t+1; choose points",
            "for each point x",
            "  g ← 0",
            "  for each level, from the coarsest to the picture itself",
            "    T ← Σ (Iₓ², Iₓ I_y; Iₓ I_y, I_y²) over the window at x in frame t",
            "    if the smaller eigenvalue of T < threshold, then hand g on, or lost on the picture",
            "    d ← g; repeat",
            "      b ← Σ δI (Iₓ, I_y), δI = frame t at x − frame t+1 at x + d",
            "      d ← d + T⁻¹ b",
            "    until |T⁻¹ b| < epsilon, or iterations are done",
            "    g ← 2 d",
            "  lost if x + d is outside or the window differs too much there, else x moves by d",
        ],
        rungs: &["frame", "feature", "level", "iteration"],
        frames: 2,
    };
    const PROMISE: Promise = Promise::Features { off_centi_px: 2 };
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let fixed = Arc::clone(&state.fixed);
        let Some(&at) = fixed.points.get(state.found.len()) else {
            observer.see(|| Event::Nothing);
            return Ok(Progress::Done);
        };
        let tracked = self.track((&fixed, state.level), (at, state.guess), observer);
        if state.level > 0 {
            state.level -= 1;
            state.guess = tracked.0.map(|c| 2.0 * c);
            return Ok(Progress::More);
        }
        state.found.push(feature(at, tracked));
        (state.level, state.guess) = (fixed.levels[0].len() - 1, [0.0; 2]);
        Ok(if state.found.len() == fixed.points.len() { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some((state.fixed.points.len() * state.fixed.levels[0].len()).max(1))
    }

    fn place(&self, state: &State) -> Vec<Rung> {
        let (points, levels) = (state.fixed.points.len(), state.fixed.levels[0].len());
        let rung = |index, of| Rung { index, of: Some(of) };
        vec![rung(0, 1), rung(state.found.len(), points.max(1)), rung(levels - 1 - state.level, levels)]
    }

    /// The unit that finds the point nearest to a place.
    fn unit_at(&self, state: &State, point: [f32; 2]) -> Option<usize> {
        let points = state.fixed.points.iter().enumerate();
        let nearest = points.min_by(|(_, a), (_, b)| {
            let far = |at: &[f32; 2]| (at[0] - point[0]).hypot(at[1] - point[1]);
            far(a).total_cmp(&far(b))
        });
        nearest.map(|(index, _)| (index + 1) * state.fixed.levels[0].len() - 1)
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.found[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let levels: usize = state.fixed.levels.iter().flatten().map(Level::bytes).sum();
        self.state_bytes(state) + size_of_val(&state.fixed.points[..]) + levels
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::End(_, Err(_)) => Some(Role::Rejected),
            _ => None,
        }
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Nothing) => 0,
            Some(Event::Window(_)) => 4,
            Some(Event::Iteration { .. }) => 8,
            Some(Event::End(_, Err(Status::Flat))) => 5,
            Some(Event::End(..)) if seen.before.level > 0 => 10,
            Some(Event::End(..)) => 11,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        draw_points(seen, scene);
        self.draw_windows(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::Points(PointField { picture: state.fixed.levels[0][0].size(), points: state.found.clone() })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        let fixed = Arc::clone(&state.fixed);
        state.found = threads.map(fixed.points.len(), |i| self.whole(&fixed, fixed.points[i]));
        Ok(state)
    }
}

/// Where the point at the cursor is looked for: its place on the level, and the displacement so far.
struct Looked {
    at: [f32; 2],
    displacement: [f32; 2],
    scale: f32,
}

impl Looked {
    fn at(seen: &Seen<PyramidalLucasKanade>) -> Option<Self> {
        let state = seen.before;
        let displacement = match *seen.events.last()? {
            Event::Nothing => return None,
            Event::Window(_) => state.guess,
            Event::Iteration { from, update, .. } => [0, 1].map(|i| from[i] + update[i]),
            Event::End(displacement, _) => displacement,
        };
        let scale = (1u32 << state.level) as f32;
        let at = state.fixed.points.get(state.found.len())?.map(|c| c / scale);
        Some(Self { at, displacement, scale })
    }

    /// Where a displacement leads to, in px of the picture.
    fn place(&self, displacement: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|i| (self.at[i] + displacement[i]) * self.scale)
    }
}

fn draw_points(seen: &Seen<PyramidalLucasKanade>, scene: &mut Scene) {
    let state = seen.after.unwrap_or(seen.before);
    let tracked = state.found.iter().filter_map(|point| {
        let [u, v] = point.displacement?;
        Some(Arrow { from: point.at, to: [point.at[0] + u, point.at[1] + v] })
    });
    let lost = state.found.iter().filter(|point| point.displacement.is_none()).map(|point| point.at);
    let mut points = |role, meaning, places: Vec<[f32; 2]>| {
        if !places.is_empty() {
            scene.mark(Picture::Current, role, Shape::Points(places));
            scene.legend(role, meaning);
        }
    };
    points(Role::Measured, "point that waits", state.fixed.points[state.found.len()..].to_vec());
    points(Role::Rejected, "lost", lost.collect());
    let tracked: Vec<_> = tracked.collect();
    if !tracked.is_empty() {
        scene.mark(Picture::Current, Role::Result, Shape::Arrows(tracked));
        scene.legend(Role::Result, "displacements found");
    }
    if state.fixed.points.is_empty() {
        scene.legend(Role::Rejected, "no points");
    }
}

impl PyramidalLucasKanade {
    /// The window at the cursor in frame t, its guess and its places in frame t + 1.
    fn draw_windows(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(looked) = Looked::at(seen) else { return };
        let half = (self.reach() as f32 + 0.5) * looked.scale;
        let rect = |[x, y]: [f32; 2]| Shape::Rect { min: [x - half, y - half], max: [x + half, y + half] };
        scene.mark(Picture::Current, Role::Reference, rect(looked.place([0.0; 2])));
        scene.legend(Role::Reference, "window in frame t");
        scene.mark(Picture::Next, Role::Predicted, rect(looked.place(seen.before.guess)));
        scene.legend(Role::Predicted, "guess from the coarser level");
        let role = if matches!(seen.events.last(), Some(Event::End(..))) { Role::Best } else { Role::Candidate };
        scene.mark(Picture::Next, role, rect(looked.place(looked.displacement)));
        scene.legend(role, "its place in frame t+1");
        let steps = seen.events.iter().filter_map(|event| match event {
            Event::Iteration { from, update, .. } => Some([*from, [0, 1].map(|i| from[i] + update[i])]),
            _ => None,
        });
        let steps: Vec<_> = steps.collect();
        if let Some(first) = steps.first() {
            let trail = [first[0]].into_iter().chain(steps.iter().map(|step| step[1]));
            let points = trail.map(|displacement| looked.place(displacement)).collect();
            scene.mark(Picture::Next, Role::Estimate, Shape::Path { points, closed: false });
            scene.legend(Role::Estimate, "way of its middle");
        }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (state, said) = (seen.before, Sentence::default());
        let count = state.fixed.points.len();
        let Some(event) = seen.events.last() else {
            return said.text(format!(
                "{count} points are tracked, each from the coarsest of {} levels, where its way is short, to the picture.",
                state.fixed.levels[0].len()
            ));
        };
        let name = format!("Point {}", state.found.len() + 1);
        let (width, height) = state.fixed.levels[0][state.level].size();
        match *event {
            Event::Nothing => said.text("The picture has no corner: there is nothing to track."),
            Event::Window(tensor) => {
                let [large, small] = tensor.eigenvalues().map(tell::number);
                said.ink(Role::Reference, name)
                    .text(format!(" on level {}, {width}×{height} px: the tensor of its window has the eigenvalues {large} and {small}. It begins at ", state.level))
                    .ink(Role::Predicted, format!("{} px", tell::vector(state.guess)))
                    .text(".")
            }
            Event::Iteration { from, mismatch, update } => {
                let size = update[0].hypot(update[1]);
                let end = if size < self.epsilon { ", less than epsilon: that was the last" } else { "" };
                said.text("At ")
                    .ink(Role::Candidate, tell::vector(from))
                    .text(format!(
                        " the windows differ by {} gray levels on average. The mismatch says to move by {} px{end}: now ",
                        tell::number(mismatch.residual),
                        tell::vector(update)
                    ))
                    .ink(Role::Candidate, format!("{} px", tell::vector([0, 1].map(|i| from[i] + update[i]))))
                    .text(".")
            }
            Event::End(displacement, Ok(_)) if state.level > 0 => said
                .ink(Role::Reference, name)
                .text(format!(
                    " leaves level {} with {} px. The finer level begins with twice that, ",
                    state.level,
                    tell::vector(displacement)
                ))
                .ink(Role::Predicted, format!("{} px", tell::vector(displacement.map(|c| 2.0 * c))))
                .text("."),
            Event::End(displacement, Ok(residual)) => said
                .ink(Role::Reference, name)
                .text(" moves by ")
                .ink(Role::Result, format!("{} px", tell::vector(displacement)))
                .text(format!(": its window differs by {} gray levels on average there.", tell::number(residual))),
            Event::End(_, Err(status)) => {
                said.ink(Role::Reference, name).text(" is ").ink(Role::Rejected, "lost").text(match status {
                    Status::Outside => ": it leaves the picture.",
                    Status::Flat => ": its window has too little gradient in one direction, or in both.",
                    _ => ": what it led to looks too different.",
                })
            }
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.before;
        let fact = |label, value: String, role| Fact { label, value, role };
        let px = |uv: [f32; 2]| format!("{} px", tell::vector(uv));
        let Some(looked) = Looked::at(seen) else {
            let count = state.fixed.points.len().to_string();
            return if seen.events.is_empty() {
                Vec::new()
            } else {
                vec![Readout::Facts(vec![fact("Points", count, None)])]
            };
        };
        let (levels, point) = (state.fixed.levels[0].len(), state.fixed.points[state.found.len()]);
        let mut facts = vec![
            fact(
                "Point",
                format!("{} of {} at {}", state.found.len() + 1, state.fixed.points.len(), tell::vector(point)),
                Some(Role::Reference),
            ),
            fact("Level", format!("{} of {} to 0", state.level, levels - 1), None),
            fact("Guess", px(state.guess), Some(Role::Predicted)),
        ];
        let tensor =
            seen.events.iter().find_map(|event| if let Event::Window(tensor) = event { Some(*tensor) } else { None });
        if let Some(tensor) = tensor {
            let [large, small] = tensor.eigenvalues().map(tell::number);
            facts.push(fact("Eigenvalues", format!("{large} and {small}"), None));
        }
        let last = seen.events.iter().rev().find_map(|event| match event {
            Event::Iteration { mismatch, update, .. } => Some((*mismatch, *update)),
            _ => None,
        });
        if let Some((mismatch, update)) = last {
            facts.push(fact("Update", px(update), Some(Role::Candidate)));
            facts.push(fact("Residual", format!("{} gray levels before it", tell::number(mismatch.residual)), None));
        }
        let role = if state.level == 0 { Role::Result } else { Role::Best };
        facts.push(fact("Displacement", px(looked.displacement), Some(role)));
        if looked.scale > 1.0 {
            facts.push(fact("On the picture", px(looked.displacement.map(|c| c * looked.scale)), None));
        }
        let true_displacement =
            state.fixed.truth.as_ref().and_then(|truth| truth.at(point[0] as usize, point[1] as usize));
        facts.extend(true_displacement.map(|truth| fact("Truth", px(truth), Some(Role::Truth))));
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend(tensor.map(|tensor| Readout::Equation(equation(tensor, last))));
        readouts.push(Readout::Tiles(self.tiles(&state.fixed, state.level, &looked)));
        readouts
    }

    /// The window in frame t, where it lies in frame t + 1, and what differs.
    fn tiles(&self, fixed: &Fixed, level: usize, looked: &Looked) -> Vec<Tile> {
        let [current, next] = fixed.levels.each_ref().map(|levels| &levels[level]);
        let reach = self.reach() as f32;
        let side = 2 * self.reach() + 1;
        let place = |by: [f32; 2], i: usize, j: usize| {
            [looked.at[0] + by[0] + i as f32 - reach, looked.at[1] + by[1] + j as f32 - reach]
        };
        let of = |level: &Level, by: [f32; 2]| {
            Grid::from_fn(side, side, |i, j| {
                let place = place(by, i, j);
                if level.holds(place) { (level.sample(place) * 10.0).round() / 10.0 } else { f32::NAN }
            })
        };
        let (window, there) = (of(current, [0.0; 2]), of(next, looked.displacement));
        let difference = Grid::from_fn(side, side, |i, j| window[(i, j)] - there[(i, j)]);
        let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(v.abs()));
        let tile = |label, role, values, range| Tile { label, role, values, range };
        vec![
            tile("Frame t", Some(Role::Reference), window, [0.0, 255.0]),
            tile("Frame t+1", Some(Role::Candidate), there, [0.0, 255.0]),
            tile("δI", None, difference, [-most, most]),
        ]
    }
}

/// T η = b in symbols, and with the means over the window.
fn equation(tensor: Tensor, last: Option<(Mismatch, [f32; 2])>) -> Vec<Math> {
    let eta = |index| Math::indexed(Math::Var("η"), Math::Var(index));
    let delta = || Math::Row(vec![Math::text("δ"), Math::Var("I")]);
    let symbols = Math::Row(vec![
        Math::Var("T"),
        Math::text(" "),
        Math::Var("η"),
        Math::text(" = "),
        Math::Var("b"),
        Math::text(" = Σ "),
        delta(),
        Math::text(" ("),
        tell::derivative("x"),
        Math::text(", "),
        tell::derivative("y"),
        Math::text(")"),
    ]);
    let row = |a: f32, b: f32, right: Option<f32>| {
        Math::Row(vec![
            Math::ink(Role::Reference, tell::number(a)),
            Math::text(" "),
            eta("u"),
            Math::text(" "),
            Math::ink(Role::Reference, tell::plus(b)),
            Math::text(" "),
            eta("v"),
            Math::text(" = "),
            Math::ink(Role::Candidate, right.map_or_else(|| "?".into(), tell::number)),
        ])
    };
    let vector = last.map(|(mismatch, _)| mismatch.vector);
    let mut lines =
        vec![symbols, row(tensor.xx, tensor.xy, vector.map(|b| b[0])), row(tensor.xy, tensor.yy, vector.map(|b| b[1]))];
    lines.extend(last.map(|(_, update)| {
        Math::Row(vec![Math::Var("η"), Math::text(" = "), Math::ink(Role::Result, tell::vector(update))])
    }));
    lines
}
