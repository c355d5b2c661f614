//! Pyramidal Lucas-Kanade: features are tracked from coarse to fine.

use std::sync::Arc;

use crate::differential::{tell, truth};
use crate::estimator::Mapped;
use crate::features::follow::{self, Follow, Followed};
use crate::features::tracker::Level;
use crate::features::{Account, detect};
use crate::interest_points::ShiTomasi;
use crate::scene::{Arrow, Fact, Picture, Readout, Sentence, Shape};
use crate::{
    Clip, Error, Estimator, Feature, Flow, Info, Observer, Output, PointField, Progress, Promise, Role, Rung, Scene,
    Seen, Status, Step, Threads, choices, params,
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

impl Fixed {
    fn pyramids(&self) -> [&[Level]; 2] {
        self.levels.each_ref().map(Vec::as_slice)
    }
}

/// What happens to a point on one level.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// There is no point at all.
    Nothing,
    /// A step of following it.
    Of(follow::Event),
}

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
        let of_frame = |i: usize| Level::pyramid(pair[i].luma(), self.levels, self.reach());
        let levels = <[_; 2]>::try_from(threads.map(2, of_frame)).unwrap_or_default();
        let level = levels[0].len() - 1;
        let fixed = Fixed { levels, points, truth: truth(clip, frame) };
        Ok(State { fixed: Arc::new(fixed), found: Vec::new(), level, guess: [0.0; 2] })
    }

    fn follow(&self) -> Follow {
        let Self { iterations, epsilon, threshold, max_residual, .. } = *self;
        Follow { reach: self.reach(), iterations, epsilon, threshold, max_residual }
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
fn feature(at: [f32; 2], (displacement, result): ([f32; 2], Result<f32, Status>)) -> Feature {
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
            "    T ← mean of (Iₓ², Iₓ I_y; Iₓ I_y, I_y²) over the window at x in frame t",
            "    if the smaller eigenvalue of T < threshold, then hand g on, or lost on the picture",
            "    d ← g; repeat",
            "      b ← mean of δI (Iₓ, I_y), δI = frame t at x − frame t+1 at x + d",
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
        let mut observer = Mapped { observer, map: Event::Of };
        match self.follow().on_level(fixed.pyramids(), state.level, (at, state.guess), &mut observer) {
            Followed::Guess(finer) => {
                (state.level, state.guess) = (state.level - 1, finer);
                return Ok(Progress::More);
            }
            Followed::Done(displacement, result) => state.found.push(feature(at, (displacement, result))),
        }
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
            Event::Of(follow::Event::End(_, Err(_))) => Some(Role::Rejected),
            _ => None,
        }
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Nothing) => 0,
            Some(Event::Of(follow::Event::Window(_))) => 4,
            Some(Event::Of(follow::Event::Iteration { .. })) => 8,
            Some(Event::Of(
                follow::Event::Handed(_, Some(Status::Flat)) | follow::Event::End(_, Err(Status::Flat)),
            )) => 5,
            Some(Event::Of(follow::Event::Handed(..))) => 10,
            Some(Event::Of(follow::Event::End(..))) => 11,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        draw_points(seen, scene);
        if let Some(account) = account(self, seen) {
            account.draw([Picture::Current, Picture::Next], scene);
        }
    }

    fn output(&self, state: &State) -> Output {
        Output::Points(PointField { picture: state.fixed.levels[0][0].size(), points: state.found.clone() })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        let fixed = Arc::clone(&state.fixed);
        state.found = threads.map(fixed.points.len(), |i| {
            let at = fixed.points[i];
            feature(at, self.follow().through(fixed.pyramids(), at, &mut ()))
        });
        Ok(state)
    }
}

/// What has happened to the point at the cursor on its level.
fn account<'a>(estimator: &PyramidalLucasKanade, seen: &Seen<'a, PyramidalLucasKanade>) -> Option<Account<'a>> {
    let state = seen.before;
    let events = seen.events.iter().filter_map(|event| if let Event::Of(event) = event { Some(*event) } else { None });
    Some(Account {
        follow: estimator.follow(),
        pyramids: state.fixed.pyramids(),
        level: state.level,
        at: *state.fixed.points.get(state.found.len())?,
        guess: state.guess,
        events: events.collect(),
        name: format!("Point {}", state.found.len() + 1),
    })
    .filter(|account| !account.events.is_empty())
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
    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let fixed = &seen.before.fixed;
        match (account(self, seen), seen.events.is_empty()) {
            (Some(account), _) => account.sentence(),
            (None, false) => Sentence::default().text("The picture has no corner: there is nothing to track."),
            (None, true) => {
                let said = Sentence::default().text(format!("{} points are tracked", fixed.points.len()));
                match fixed.levels[0].len() {
                    1 => said.text(", each on the picture itself."),
                    levels => said.text(format!(
                        ", each from the coarsest of {levels} levels, where its way is short, to the picture."
                    )),
                }
            }
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let (state, count) = (seen.before, seen.before.fixed.points.len());
        let fact = |label, value: String, role| Fact { label, value, role };
        let Some(account) = account(self, seen) else {
            let points = || vec![Readout::Facts(vec![fact("Points", count.to_string(), None)])];
            return if seen.events.is_empty() { Vec::new() } else { points() };
        };
        let point = account.at;
        let place = format!("{} of {count} at {}", state.found.len() + 1, tell::vector(point));
        let mut facts = vec![fact("Point", place, Some(Role::Reference))];
        facts.extend(account.facts());
        let truth = state.fixed.truth.as_ref().and_then(|truth| truth.at(point[0] as usize, point[1] as usize));
        facts.extend(truth.map(|truth| fact("Truth", format!("{} px", tell::vector(truth)), Some(Role::Truth))));
        [vec![Readout::Facts(facts)], account.readouts()].concat()
    }
}
