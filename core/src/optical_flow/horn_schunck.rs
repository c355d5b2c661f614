//! Horn and Schunck's method: the smoothest field that the gradient constraints allow.

use std::sync::Arc;

use crate::differential::{Field, Given, Linear, Scheme, field, filter, relax, tell};
use crate::scene::{Fact, Math, Picture, Plane, Readout, Sentence, Series, Shape};
use crate::{
    Clip, DenseField, Error, Estimator, Flow, Grid, Info, Observer, Output, Progress, Promise, Role, Rung, Scene, Seen,
    Step, Threads, choices, params, pyramid,
};

choices! {
    /// How the equations are solved. All methods come to the same field in the end.
    pub enum Solver {
        /// All pixels at once, from the averages of the iteration before, as in the paper.
        Jacobi = "jacobi" "Jacobi",
        /// Pixel by pixel along the rows, from the newest values: about twice as fast to converge.
        GaussSeidel = "gauss-seidel" "Gauss–Seidel",
        /// As Gauss–Seidel, but each pixel goes farther than it should (successive over-relaxation): much faster.
        Sor = "sor" "SOR",
    }
}

params! {
    /// Horn and Schunck's method. The energy ∫∫ (Iₓ u + I_y v + Iₜ)² + α² (|∇u|² + |∇v|²) is made as small as can be.
    /// Where course notes multiply the second part by (Iₓ² + I_y²) as well, that is a misprint: smoothness counts everywhere alike.
    pub struct HornSchunck {
        /// Weight α of smoothness: the larger, the smoother the field; about the gradient, in gray levels per px, that counts as much.
        alpha: f32 = 8.0, 0.1..=1000.0;
        /// Iterations for each level and warp.
        iterations: usize = 100, 1..=1000;
        /// How the equations are solved.
        solver: Solver = Solver::Jacobi;
        /// How far SOR goes beyond Gauss and Seidel: 1 is theirs, from 2 on nothing converges.
        relaxation: f32 = 1.9, 1.0..=1.99;
        /// Go on to the next warp when an iteration changes displacements by less on average; 0 does all iterations.
        tolerance: f32 = 0.0, 0.0..=1.0, "px";
        /// Levels of the pyramid, each half as large as the one before; fewer where a side would be less than 16 px. 1 is the method of the paper.
        levels: usize = 4, 1..=10;
        /// How often on each level frame t+1 is brought back by what was found, and its derivatives taken anew.
        warps: usize = 3, 1..=20;
        /// How derivatives are estimated from pixels.
        derivatives: Scheme = Scheme::FivePoint;
        /// Standard deviation of the Gaussian that smooths both frames first; 0 leaves them as they are.
        smoothing: f32 = 0.5, 0.0..=5.0, "px";
    }
}

/// From one level of the pyramid to the next.
const FACTOR: f32 = 0.5;

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// What comes next: the level, 0 being the picture itself, the warp on it, and the iteration for that.
    level: usize,
    warp: usize,
    iteration: usize,
    /// What was found by now, on the level of the last iteration.
    field: Arc<Field>,
    /// The constraints of the last iteration.
    linear: Option<Arc<(Linear, relax::System)>>,
    /// The iterations before the eyes of someone.
    notes: Vec<Note>,
    is_done: bool,
}

/// What stays the same all along.
struct Fixed {
    given: Given,
    /// The levels of frames t and t + 1, the picture first.
    levels: [Vec<Grid<f32>>; 2],
}

/// An iteration in numbers.
#[derive(Clone, Copy, Debug)]
struct Note {
    /// The parts of the energy, on average over the pixels.
    data: f32,
    smoothness: f32,
    /// Mean change of the displacements, in px of the picture.
    change: f32,
    /// Mean endpoint error in px of the picture; NaN where there is no truth.
    error: f32,
}

/// What happens in an iteration.
#[derive(Clone)]
pub enum Event {
    /// Frame t + 1 is brought back, and the constraints are taken anew.
    Warped(Arc<(Linear, relax::System)>),
    /// The averages of the neighbours are taken. What the iteration will come to, and the pixel that changes most.
    Averaged {
        /// The field after the iteration.
        to: Arc<Field>,
        /// The pixel that changes most.
        most: (usize, usize),
    },
    /// Every pixel is set to what fits it and its neighbours' average.
    Updated,
}

impl HornSchunck {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let given = Given::new(clip, frame, self.smoothing, threads)?;
        let levels = [0, 1].map(|i| pyramid::levels(given.pictures[i].clone(), FACTOR, self.levels, threads));
        let level = levels[0].len() - 1;
        let field = Arc::new(Field::new(levels[0][level].size(), [0.0; 2]));
        let fixed = Arc::new(Fixed { given, levels });
        Ok(State { fixed, level, warp: 0, iteration: 0, field, linear: None, notes: Vec::new(), is_done: false })
    }

    /// The constraints of the warp at hand; those that there are, unless it begins.
    fn linear(&self, state: &State, threads: &Threads) -> Arc<(Linear, relax::System)> {
        if let Some(linear) = state.linear.as_ref().filter(|_| state.iteration > 0) {
            return Arc::clone(linear);
        }
        let pictures = [0, 1].map(|i| &state.fixed.levels[i][state.level]);
        let size = pictures[0].size();
        let start = match state.field.u.size() == size {
            true => (*state.field).clone(),
            false => state.field.resized(size, threads),
        };
        let start = match state.linear {
            Some(_) => Field { u: filter::median(&start.u, threads), v: filter::median(&start.v, threads) },
            None => start,
        };
        let linear = Linear::about(start, pictures, self.derivatives, threads);
        let system = relax::System::new(&linear, self.alpha, threads);
        Arc::new((linear, system))
    }

    /// `count` iterations from `field` on.
    fn iterate(&self, system: &relax::System, field: &Field, count: usize, threads: &Threads) -> Field {
        let relaxation = match self.solver {
            Solver::Jacobi => return system.jacobi(field, count, threads),
            Solver::GaussSeidel => 1.0,
            Solver::Sor => self.relaxation,
        };
        let mut field = field.clone();
        (0..count).for_each(|_| system.sweep(&mut field, relaxation));
        field
    }

    /// Whether an iteration that changed displacements by so much on average was the last of its warp.
    fn is_settled(&self, change: f64) -> bool {
        change < f64::from(self.tolerance)
    }

    /// Does `count` iterations of the warp at hand, and takes the place of the next.
    fn work(&self, state: &mut State, count: usize, threads: &Threads) -> (Arc<Field>, f64) {
        let linear = self.linear(state, threads);
        let from = if state.iteration == 0 { Arc::new(linear.0.start.clone()) } else { Arc::clone(&state.field) };
        let to = self.iterate(&linear.1, &from, count, threads);
        let change = if count == 1 { relax::change(&from, &to) } else { f64::INFINITY };
        (state.field, state.linear) = (Arc::new(to), Some(linear));
        state.iteration += count;
        if state.iteration >= self.iterations || self.is_settled(change) {
            (state.iteration, state.warp) = (0, state.warp + 1);
        }
        if state.warp == self.warps {
            state.warp = 0;
            match state.level.checked_sub(1) {
                Some(level) => state.level = level,
                None => state.is_done = true,
            }
        }
        (from, change)
    }
}

impl State {
    /// How many px of the picture one of a level is, across and down.
    fn scale(&self, level: usize) -> [f32; 2] {
        let ((width, height), (w, h)) = (self.fixed.given.size(), self.fixed.levels[0][level].size());
        [width as f32 / w as f32, height as f32 / h as f32]
    }

    /// What was found by now, on the picture.
    fn flow(&self) -> Flow {
        let size = self.fixed.given.size();
        if self.field.u.size() == size {
            self.field.flow()
        } else {
            self.field.resized(size, &Threads::single()).flow()
        }
    }

    /// An iteration on `level` that came to the field at hand, in numbers.
    fn note(&self, level: usize, alpha: f32, change: f64) -> Option<Note> {
        let linear = &self.linear.as_ref()?.0;
        let [data, smoothness] = relax::energy(linear, alpha, &self.field).map(|part| part as f32);
        let change = change as f32 * self.scale(level)[0];
        Some(Note { data, smoothness, change, error: self.error(level) })
    }

    /// Mean endpoint error in px of the picture, over the pixels of `level` whose true motion is known.
    fn error(&self, level: usize) -> f32 {
        let Some(truth) = &self.fixed.given.truth else { return f32::NAN };
        let scale = self.scale(level);
        let (width, height) = self.field.u.size();
        let (mut sum, mut known) = (0.0, 0u32);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let place = |i: usize, scale: f32| ((i as f32 + 0.5) * scale) as usize;
            let Some([true_u, true_v]) = truth.at(place(x, scale[0]), place(y, scale[1])) else { continue };
            let [u, v] = self.field.at(x, y);
            sum += f64::from((u * scale[0] - true_u).hypot(v * scale[1] - true_v));
            known += 1;
        }
        (sum / f64::from(known)) as f32
    }
}

/// The pixel whose displacement changes most from one field to the other; the first of several.
fn most_changed(from: &Field, to: &Field) -> (usize, usize) {
    let squared = |place: (usize, usize)| (to.u[place] - from.u[place]).powi(2) + (to.v[place] - from.v[place]).powi(2);
    let (width, height) = from.u.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    places.fold((0, 0), |most, place| if squared(place) > squared(most) { place } else { most })
}

impl Estimator for HornSchunck {
    const INFO: Info = Info {
        id: "horn-schunck",
        name: "Horn–Schunck",
        family: "Optical flow",
        summary: "Finds the field that fits the gradient constraints of all pixels and is as smooth as can be.",
        source: "B. K. P. Horn and B. G. Schunck, Determining optical flow, Artificial Intelligence 17, 1981; pyramid and \
                 warping: E. Meinhardt-Llopis, J. Sánchez and D. Kondermann, Horn–Schunck optical flow with a multi-scale \
                 strategy, Image Processing On Line 3, 2013; medians: D. Sun, S. Roth and M. J. Black, Secrets of optical flow \
                 estimation and their principles, CVPR 2010",
        pseudocode: &[
            "E(u, v) = ∫∫ (Iₓ u + I_y v + Iₜ)² + α² (|∇u|² + |∇v|²)",
            "(u, v) ← 0 on the coarsest level",
            "for each level, from the coarsest to the picture itself",
            "  for each warp",
            "    (u, v) ← medians of 3×3 px: nothing astray is carried on",
            "    bring frame t+1 back along (u, v), take Iₓ, I_y, Iₜ",
            "    for each iteration",
            "      (u_m, v_m) ← mean of the neighbours, for each pixel",
            "      (u, v) ← (u_m, v_m) − ∇I (Iₓ u_m + I_y v_m + Iₜ) / (α² + |∇I|²)",
        ],
        rungs: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const PROMISE: Promise = Promise::SubPixel { off_centi_px: 5 };
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (level, is_first) = (state.level, state.iteration == 0);
        let (from, change) = self.work(state, 1, &Threads::single());
        if let Some(linear) = state.linear.as_ref().filter(|_| is_first) {
            observer.see(|| Event::Warped(Arc::clone(linear)));
        }
        observer.see(|| Event::Averaged { to: Arc::clone(&state.field), most: most_changed(&from, &state.field) });
        observer.see(|| Event::Updated);
        state.notes.extend(state.note(level, self.alpha, change));
        Ok(if state.is_done { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        (self.tolerance == 0.0).then(|| state.fixed.levels[0].len() * self.warps * self.iterations)
    }

    fn place(&self, state: &State) -> Vec<Rung> {
        let levels = state.fixed.levels[0].len();
        let rung = |index, of| Rung { index, of: Some(of) };
        vec![
            rung(0, 1),
            rung(levels - 1 - state.level, levels),
            rung(state.warp, self.warps),
            rung(state.iteration, self.iterations),
        ]
    }

    fn state_bytes(&self, state: &State) -> usize {
        // The constraints are shared by the iterations of a warp.
        size_of::<State>() + size_of_val(&state.notes[..]) + 2 * size_of_val(state.field.u.cells())
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        field::draw(state.flow().0, scene);
        if let Some(Looked { place: [x, y], scale, .. }) = Looked::at(seen) {
            let edge = |i: usize, scale: f32| i as f32 * scale - 0.5;
            let min = [edge(x, scale[0]), edge(y, scale[1])];
            let max = [edge(x + 1, scale[0]), edge(y + 1, scale[1])];
            scene.mark(Picture::Current, Role::Reference, Shape::Rect { min, max });
            scene.legend(Role::Reference, "pixel that is explained");
        }
    }

    fn output(&self, state: &State) -> Output {
        Output::Dense(DenseField { flow: state.flow(), confidence: None })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        // Where each change decides whether to go on, iterations come one by one.
        let count = if self.tolerance > 0.0 { 1 } else { self.iterations };
        while !state.is_done {
            self.work(&mut state, count, threads);
        }
        Ok(state)
    }
}

/// The iteration at a cursor, at one pixel: the one pointed at, else the one that changes most.
struct Looked<'a> {
    linear: &'a Linear,
    /// The field before the iteration and after it.
    from: &'a Field,
    to: &'a Field,
    /// The pixel on its level, and how many px of the picture it is.
    place: [usize; 2],
    scale: [f32; 2],
}

impl<'a> Looked<'a> {
    /// `None` until the averages are taken.
    fn at(seen: &'a Seen<HornSchunck>) -> Option<Self> {
        let (to, most) = seen.events.iter().find_map(|event| match event {
            Event::Averaged { to, most } => Some((&**to, *most)),
            _ => None,
        })?;
        let state = seen.before;
        let (linear, from) = match seen.events.first() {
            Some(Event::Warped(linear)) => (&linear.0, &linear.0.start),
            _ => (&state.linear.as_ref()?.0, &*state.field),
        };
        let scale = state.scale(state.level);
        let (width, height) = to.u.size();
        let pointed_at = seen.focus.and_then(|point| state.fixed.given.pixel_at(point)).map(|(x, y)| {
            let on_level = |c: usize, scale: f32, extent: usize| (((c as f32 + 0.5) / scale) as usize).min(extent - 1);
            (on_level(x, scale[0], width), on_level(y, scale[1], height))
        });
        let (x, y) = pointed_at.unwrap_or(most);
        Some(Self { linear, from, to, place: [x, y], scale })
    }

    fn pixel(&self) -> (usize, usize) {
        (self.place[0], self.place[1])
    }
}

impl HornSchunck {
    fn told(&self, seen: &Seen<Self>) -> Step {
        let Some(event) = seen.events.last() else {
            let sentence = "The energy to be made small has two parts: how far the gradient constraints are off, and α² \
                            times how unlike neighbours move. Where course notes multiply the second part by \
                            (Iₓ² + I_y²) as well, that is a misprint.";
            return Step { line: 0, sentence: Sentence::default().text(sentence), readouts: Vec::new() };
        };
        let line = match event {
            Event::Warped(_) => 5,
            Event::Averaged { .. } => 7,
            Event::Updated => 8,
        };
        let mut readouts = vec![Readout::Facts(self.facts(seen))];
        if let Some(looked) = Looked::at(seen) {
            let mean = self.mean(&looked);
            readouts.push(Readout::Equation(self.equation(&looked, mean)));
            readouts.push(Readout::Plane(self.plane(seen, &looked, mean)));
        }
        readouts.extend(self.series(seen).into_iter().map(Readout::Series));
        Step { line, sentence: self.sentence(seen, event), readouts }
    }

    /// The average of the neighbours from which the pixel is set.
    fn mean(&self, looked: &Looked) -> [f32; 2] {
        let earlier = if self.solver == Solver::Jacobi { looked.from } else { looked.to };
        relax::mean_around(earlier, looked.from, looked.pixel())
    }

    fn sentence(&self, seen: &Seen<Self>, event: &Event) -> Sentence {
        let state = seen.before;
        let said = Sentence::default();
        let Some(looked) = Looked::at(seen) else {
            let (width, height) = state.fixed.levels[0][state.level].size();
            let warp = format!("{} of {}", state.warp + 1, self.warps);
            return said.text(format!(
                "Level {} of the pyramid is {width}×{height} px large. Warp {warp}: frame t+1 is brought back by what was \
                 found so far, and the derivatives are taken of what is left.",
                state.level
            ));
        };
        let ([x, y], mean) = (looked.place, self.mean(&looked));
        let pixel = format!("pixel ({x}, {y})");
        let [a, b, c] = looked.linear.factors.at(looked.pixel());
        let to = looked.to.at(x, y);
        match event {
            Event::Updated => {
                let off = tell::number(a * mean[0] + b * mean[1] + c);
                let relaxed = if self.solver == Solver::Sor { " and beyond" } else { "" };
                said.text(format!("With the average, the constraint is off by {off} gray levels at "))
                    .ink(Role::Reference, pixel)
                    .text(format!(". It is moved along its gradient towards the line{relaxed}, to "))
                    .ink(Role::Result, format!("{} px", tell::vector(to)))
                    .text(": the nearer to it, the larger the gradient is beside α.")
            }
            _ => said
                .text("The neighbours of ")
                .ink(Role::Reference, pixel)
                .text(" move by ")
                .ink(Role::Predicted, format!("{} px", tell::vector(mean)))
                .text(" on average. If smoothness alone counted, so would the pixel."),
        }
    }

    fn facts(&self, seen: &Seen<Self>) -> Vec<Fact> {
        let state = seen.before;
        let fact = |label, value, role| Fact { label, value, role };
        let (width, height) = state.fixed.levels[0][state.level].size();
        let of = state.fixed.levels[0].len() - 1;
        let mut facts = vec![
            fact("Level", format!("{} of {of} to 0, {width}×{height} px", state.level), None),
            fact("Iteration", format!("{} of {}", state.iteration + 1, self.iterations), None),
        ];
        if let Some(looked) = Looked::at(seen) {
            let [x, y] = looked.place;
            facts.push(fact("Pixel", format!("({x}, {y}) of the level"), Some(Role::Reference)));
            facts.push(looked.linear.factors.fact(looked.pixel()));
            facts.push(fact("Before", format!("{} px", tell::vector(looked.from.at(x, y))), Some(Role::Best)));
        }
        if let Some(note) = seen.after.and_then(|after| after.notes.last()) {
            let [data, smoothness] = [note.data, note.smoothness].map(tell::number);
            facts.push(fact("Energy per pixel", format!("{data} data + {smoothness} smoothness"), None));
            facts.push(fact("Mean change", format!("{:.5} px", note.change), None));
            if note.error.is_finite() {
                facts.push(fact("Mean error", format!("{:.3} px", note.error), Some(Role::Truth)));
            }
        }
        facts
    }

    /// The update in symbols, and with the numbers of the pixel.
    fn equation(&self, looked: &Looked, mean: [f32; 2]) -> Vec<Math> {
        let factors = looked.linear.factors.at(looked.pixel());
        let [a, b, c] = factors;
        let [x, y] = looked.place;
        let to = looked.to.at(x, y);
        let (off, weight) = (a * mean[0] + b * mean[1] + c, self.alpha * self.alpha + a * a + b * b);
        let squared = |base: Math| Math::power(base, Math::text("2"));
        let mean_of = |name: &'static str| Math::indexed(Math::Var(name), Math::Var("m"));
        let symbols = |to: &'static str, along: &'static str| {
            let top = vec![
                tell::derivative("x"),
                Math::text(" "),
                mean_of("u"),
                Math::text(" + "),
                tell::derivative("y"),
                Math::text(" "),
                mean_of("v"),
                Math::text(" + "),
                tell::derivative("t"),
            ];
            let bottom = vec![
                squared(Math::Var("α")),
                Math::text(" + "),
                squared(tell::derivative("x")),
                Math::text(" + "),
                squared(tell::derivative("y")),
            ];
            Math::Row(vec![
                Math::Var(to),
                Math::text(" = "),
                mean_of(to),
                Math::text(" − "),
                tell::derivative(along),
                Math::text(" "),
                Math::Frac(Box::new(Math::Row(top)), Box::new(Math::Row(bottom))),
            ])
        };
        let numbers = |gradient: f32, mean: f32, to: f32| {
            let over = if self.solver == Solver::Sor { " → " } else { " = " };
            Math::Row(vec![
                Math::text("= "),
                Math::ink(Role::Predicted, tell::number(mean)),
                Math::text(" − "),
                Math::ink(Role::Reference, tell::number(gradient)),
                Math::text(" · "),
                Math::Frac(Box::new(Math::text(tell::number(off))), Box::new(Math::text(tell::number(weight)))),
                Math::text(over),
                Math::ink(Role::Result, tell::number(to)),
            ])
        };
        vec![symbols("u", "x"), numbers(a, mean[0], to[0]), symbols("v", "y"), numbers(b, mean[1], to[1])]
    }

    /// The constraint of the pixel, the average, and where the pixel goes from there.
    fn plane(&self, seen: &Seen<Self>, looked: &Looked, mean: [f32; 2]) -> Plane {
        let [x, y] = looked.place;
        let mut points = vec![
            ("before", Role::Best, looked.from.at(x, y)),
            ("average", Role::Predicted, mean),
            ("after", Role::Result, looked.to.at(x, y)),
        ];
        if !matches!(seen.events.last(), Some(Event::Updated)) {
            points.pop();
        }
        let Looked { scale, .. } = *looked;
        let on_picture = |i: usize| ((looked.place[i] as f32 + 0.5) * scale[i]) as usize;
        let truth = seen.before.fixed.given.true_displacement((on_picture(0), on_picture(1)));
        points.extend(truth.map(|[u, v]| ("truth", Role::Truth, [u / scale[0], v / scale[1]])));
        let line = tell::line(looked.linear.factors.at(looked.pixel()), 1.0, Role::Candidate);
        Plane {
            title: "Constraint and smoothness",
            reach: tell::reach(points.iter().map(|(.., point)| *point)),
            lines: line.into_iter().collect(),
            points,
            ellipse: None,
        }
    }

    /// What became of the energy, of the change and of the error, iteration by iteration.
    fn series(&self, seen: &Seen<Self>) -> Vec<Series> {
        let notes = &seen.after.unwrap_or(seen.before).notes;
        if notes.is_empty() {
            return Vec::new();
        }
        let line = |of: fn(&Note) -> f32| -> Vec<[f32; 2]> {
            notes.iter().enumerate().map(|(i, note)| [(i + 1) as f32, of(note)]).collect()
        };
        let x_max = self.units(seen.before).unwrap_or(notes.len());
        let series =
            |title, y_label, lines| Series { title, x_label: "iteration", y_label, x_max, events: Vec::new(), lines };
        let energy = vec![
            ("energy", Role::Result, line(|note| note.data + note.smoothness)),
            ("data", Role::Reference, line(|note| note.data)),
            ("smoothness", Role::Predicted, line(|note| note.smoothness)),
        ];
        let mut all = vec![
            series("Energy per pixel", "gray levels²", energy),
            series("Mean change", "px", vec![("change", Role::Best, line(|note| note.change))]),
        ];
        if notes.iter().all(|note| note.error.is_finite()) {
            all.push(series("Mean endpoint error", "px", vec![("error", Role::Error, line(|note| note.error))]));
        }
        all
    }
}
