//! Template matching: a small picture slides over a search area of the next frame.

mod charts;
mod explain;
mod place;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Error, Observer};
use crate::data::{Clip, Flow, Frame};
use crate::geometry::{Bounds, Gray, Grid};
use crate::methods::{
    correlation::{self, Evaluation, MOST_PX, Moments, Score},
    differential::truth,
};
use crate::products::{Feature, Output, Product, ProductKind, Status, Track, TrackField};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Span, need};
use crate::scene::{Chart, Focus, Picture, Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};
use vocabulary::case;

choices! {
    /// Computation of the sums over all places. All ways give the same scores.
    pub enum Method {
        /// The way with less effort for the sizes of template and search area.
        Auto = "auto" "Automatic",
        /// The sum over the template at each place.
        Direct = "direct" "Direct",
        /// Products of spectra, by the fast Fourier transform.
        Fourier = "fft" "Fourier transform",
    }
}

choices! {
    /// Template of the later frames.
    pub enum Update {
        /// The first template in all frames: no drift, but it is lost when the object changes its appearance.
        Fixed = "fixed" "Fixed",
        /// The window at the match becomes the template of the next frame: it follows changes, but errors add up to drift.
        EveryFrame = "every-frame" "Every frame",
    }
}

params! {
    /// Template matching.
    pub struct TemplateMatching {
        /// Number of frames, including the first; fewer at the end of the clip.
        frames: usize = 30, 2..=10_000;
        /// Template: a rectangle in the first frame. Without one, the block with the largest eigenvalue λ₂ near the middle of the
        /// frame is taken.
        template: Option<Bounds> = None::<Bounds>;
        /// Side of a template that is chosen automatically, at most half a side of the frame.
        size: usize = 32, 4..=256, "px";
        /// Largest displacement from the last position, along x and y. Larger ranges reach larger motion but offer more false matches.
        search_range: usize = 24, 1..=8192, "px";
        /// Score of a window. Correlations tolerate changes in contrast, the zero-mean one in brightness too.
        score: Score = Score::Zncc;
        /// Computation of the scores. It changes the effort, not the result.
        method: Method = Method::Auto;
        /// Template of the later frames.
        update: Update = Update::Fixed;
        /// Smallest accepted ZNCC of template and match, whatever the score. Below it the template is lost.
        min_zncc: f32 = 0.5, 0.0..=1.0;
    }
    advanced { "method", "min-zncc" }
    when {
        "method": |p| p.score != Score::Sad, "The method has no effect on SAD, which no product of spectra gives.";
    }
}

/// The smallest side of a template in px.
const LEAST_PX: usize = 4;
/// The smallest standard deviation of a template with texture, in gray levels.
const LEAST_DEVIATION: f64 = 1.0;
/// The largest drift that is measured, in px.
const DRIFT_PX: i32 = 12;

/// A template and its origin.
pub struct Template {
    /// The frame that it was cut from.
    frame: usize,
    /// Its first pixel there.
    at: [i32; 2],
    pixels: Gray,
    /// The tracked point relative to its first pixel, in px.
    anchor: [f32; 2],
    /// The smaller eigenvalue of its structure tensor, if it was chosen by it.
    eigenvalue: Option<f32>,
}

impl Template {
    fn cut(luma: &Gray, frame: usize, at: [i32; 2], (width, height): (usize, usize)) -> Self {
        let pixels = window(luma, at, (width, height));
        let anchor = [width, height].map(|side| (side as f32 - 1.0) / 2.0);
        Self { frame, at, pixels, anchor, eigenvalue: None }
    }

    /// The standard deviation of its gray levels.
    fn deviation(&self) -> f64 {
        Moments::of(&self.pixels, &self.pixels).deviations()[0]
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.pixels.cells().len()
    }
}

/// The pixels of a rectangle that lies inside a picture.
fn window(luma: &Gray, [x, y]: [i32; 2], (width, height): (usize, usize)) -> Gray {
    let mut pixels = Grid::new(width, height, 0);
    for j in 0..height {
        pixels.row_mut(j).copy_from_slice(&luma.row(y as usize + j)[x as usize..][..width]);
    }
    pixels
}

/// A pair of frames with the costs of all places of the search area.
pub struct Pair {
    frames: [Arc<Frame>; 2],
    template: Arc<Template>,
    /// The position of the template in the first frame.
    from: [i32; 2],
    /// The first place of the search area.
    origin: [i32; 2],
    /// The costs of the places, smaller is better.
    costs: Grid<f64>,
    way: Evaluation,
    truth: Option<Arc<Flow>>,
}

impl Pair {
    /// The displacement of a place of the search area.
    fn displacement(&self, (x, y): (usize, usize)) -> [i32; 2] {
        [self.origin[0] + x as i32 - self.from[0], self.origin[1] + y as i32 - self.from[1]]
    }

    /// The first pixel of the window at a place.
    fn corner(&self, (x, y): (usize, usize)) -> [i32; 2] {
        [self.origin[0] + x as i32, self.origin[1] + y as i32]
    }

    /// The sums over the template and the window at a place.
    fn moments(&self, place: (usize, usize)) -> Moments {
        let under = window(self.frames[1].luma(), self.corner(place), self.template.pixels.size());
        Moments::of(&self.template.pixels, &under)
    }

    /// Whether a place is better than another: lower cost, then shorter displacement.
    fn is_better(&self, place: (usize, usize), than: (usize, usize)) -> bool {
        let length = |place| {
            let [u, v] = self.displacement(place).map(i64::from);
            u * u + v * v
        };
        let (a, b) = (self.costs[place], self.costs[than]);
        a < b || (a == b && length(place) < length(than))
    }

    fn better(&self, best: Option<(usize, usize)>, place: (usize, usize)) -> (usize, usize) {
        best.filter(|&best| !self.is_better(place, best)).unwrap_or(place)
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    span: Span,
    /// The first frame of the current pair.
    frame: usize,
    /// The current unit of the pair: its search area, a row of it, or the decision after the last row.
    turn: usize,
    /// Number of units before this pair.
    begun: usize,
    first: Arc<Template>,
    template: Arc<Template>,
    /// The position of the template in the first frame of the pair, and of the tracked point.
    at: [i32; 2],
    point: [f32; 2],
    /// The true position of the tracked point, where the motion is known.
    true_point: Option<[f32; 2]>,
    /// The best place of the rows so far.
    best: Option<(usize, usize)>,
    track: Arc<Track>,
    past: Arc<Vec<Past>>,
    picture: (usize, usize),
    is_over: bool,
    /// Recomputed on demand.
    pair: Option<Arc<Pair>>,
}

/// The outcome of a pair, for plots.
#[derive(Clone, Copy)]
struct Past {
    zncc: f32,
    /// Distances of the tracked point from the match of the first template and from its true position, in px.
    drift: Option<Drift>,
    error: Option<f32>,
    /// Whether the match lies at the limit of the search range.
    is_at_limit: bool,
}

/// The offset of the tracked point from the match of the first template.
#[derive(Clone, Copy)]
struct Drift {
    offset: [f32; 2],
    /// Whether that match lies at the border of its search, beyond which the drift may be larger.
    is_at_least: bool,
}

impl Drift {
    fn length(self) -> f32 {
        let [x, y] = self.offset;
        x.hypot(y)
    }
}

/// The decision on a pair.
pub struct Found {
    pair: Arc<Pair>,
    /// The place with the lowest cost.
    best: (usize, usize),
    /// Sub-pixel part of the position, and the costs behind it along x and y.
    fraction: [f32; 2],
    around: [Option<[f64; 3]>; 2],
    /// The second-best peak, if there is any.
    second: Option<(usize, usize)>,
    zncc: f64,
    feature: Feature,
    /// The position of the tracked point in the second frame.
    point: [f32; 2],
    /// Its true position there, where the motion is known.
    true_point: Option<[f32; 2]>,
    drift: Option<Drift>,
}

impl Found {
    fn is_lost(&self) -> bool {
        self.feature.displacement.is_none()
    }

    /// Whether the peak lies at an end of the search range: a better one may lie beyond it.
    fn is_at_limit(&self, range: usize) -> bool {
        self.pair.displacement(self.best).iter().any(|along| along.unsigned_abs() as usize == range)
    }

    /// The ratio of the scores, or of the costs, of the best and the second peak; larger is clearer.
    fn ratio(&self, score: Score) -> Option<f64> {
        let [best, second] = [self.pair.costs[self.best], self.pair.costs[self.second?]];
        let ratio = if score.is_similarity() { (1.0 - best) / (1.0 - second) } else { second / best };
        // The cost of a perfect match is 0.
        (ratio.is_finite() && ratio >= 1.0).then_some(ratio)
    }
}

/// A stage of the decision on a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The place with the lowest cost.
    Peak,
    /// Its sub-pixel position.
    Subpixel,
    /// The second-best peak.
    Second,
    /// Whether the template is lost.
    Check,
    /// The drift from the first template.
    Drift,
    /// The new template.
    Update,
}

/// An event of a unit.
#[derive(Clone)]
pub enum Event {
    /// The template.
    Chosen(Arc<Template>),
    /// A template without texture.
    Flat(Arc<Template>),
    /// The search area.
    Area(Arc<Pair>),
    /// The score of a place.
    Candidate(Arc<Pair>, [u32; 2]),
    /// A stage of the decision.
    Decided(Stage, Arc<Found>),
}

impl TemplateMatching {
    /// Returns the current pair with the costs of its search area.
    fn pair(&self, clip: &Clip, state: &mut State) -> Result<Arc<Pair>, Error> {
        if let Some(pair) = &state.pair {
            return Ok(Arc::clone(pair));
        }
        need::check_kept(clip, self.state_bytes(state))?;
        let frames = clip.pair(state.frame)?;
        let (template, size) = (Arc::clone(&state.template), state.template.pixels.size());
        let (origin, places) = self.area(state.at, state.picture, size);
        let reach = (places.0 + size.0 - 1, places.1 + size.1 - 1);
        let area = window(frames[1].luma(), origin, reach);
        let way = match self.method {
            Method::Auto => correlation::faster(self.score, size, places),
            Method::Fourier if self.score != Score::Sad => Evaluation::Fourier,
            _ => Evaluation::Direct,
        };
        let costs = correlation::map(self.score, way, &template.pixels, &area);
        let truth = truth(clip, state.frame);
        let pair = Arc::new(Pair { frames, template, from: state.at, origin, costs, way, truth });
        state.pair = Some(Arc::clone(&pair));
        Ok(pair)
    }

    /// The first place of the search area and the number of its columns and rows: the template stays inside the picture.
    fn area(&self, at: [i32; 2], picture: (usize, usize), size: (usize, usize)) -> ([i32; 2], (usize, usize)) {
        let last = [picture.0 as i32 - size.0 as i32, picture.1 as i32 - size.1 as i32];
        let range = self.search_range as i32;
        let low = [0, 1].map(|i| (at[i] - range).max(0));
        let high = [0, 1].map(|i| (at[i] + range).min(last[i]));
        (low, ((high[0] - low[0] + 1) as usize, (high[1] - low[1] + 1) as usize))
    }

    /// Scores a row of the search area.
    fn row(
        pair: &Arc<Pair>,
        best: Option<(usize, usize)>,
        y: usize,
        observer: &mut impl Observer<Event>,
    ) -> (usize, usize) {
        let mut best = pair.better(best, (0, y));
        place::not_above(pair.costs.row(y), pair.costs[best], |x| {
            best = pair.better(Some(best), (x, y));
            pair.costs[best]
        });
        (0..pair.costs.width()).for_each(|x| observer.see(|| Event::Candidate(Arc::clone(pair), [x as u32, y as u32])));
        best
    }

    fn decide(&self, state: &State, pair: &Arc<Pair>, best: (usize, usize)) -> Found {
        let (fraction, around) = place::subpixel(&pair.costs, best);
        let (corner, anchor) = (pair.corner(best), state.template.anchor);
        let point = [0, 1].map(|i| corner[i] as f32 + fraction[i] + anchor[i]);
        let zncc = 1.0 - pair.moments(best).zero_mean_cost();
        let under = window(pair.frames[1].luma(), corner, pair.template.pixels.size());
        let residual = Some(mean_difference(&pair.template.pixels, &under));
        let is_kept = zncc >= f64::from(self.min_zncc);
        let displacement = is_kept.then(|| [0, 1].map(|i| point[i] - state.point[i]));
        let status = if is_kept { Status::Tracked } else { Status::Unlike };
        let true_point = state.true_point.and_then(|at| {
            let [u, v] = pair.truth.as_ref()?.sample(at)?;
            Some([at[0] + u, at[1] + v])
        });
        let is_measured = is_kept && self.update == Update::EveryFrame;
        let drift = is_measured.then(|| self.drift(state, pair, point));
        Found {
            pair: Arc::clone(pair),
            best,
            fraction,
            around,
            second: place::second(&pair.costs, best),
            zncc,
            feature: Feature { at: state.point, displacement, status, residual },
            point,
            true_point,
            drift,
        }
    }

    /// The offset of `point` from the best match of the first template within a few px of it.
    fn drift(&self, state: &State, pair: &Pair, point: [f32; 2]) -> Drift {
        let (first, size) = (&state.first, state.first.pixels.size());
        let near = TemplateMatching { search_range: DRIFT_PX as usize, ..self.clone() };
        let last = [state.picture.0 - size.0, state.picture.1 - size.1];
        let corner = [0, 1].map(|i| ((point[i] - first.anchor[i]).round() as i32).clamp(0, last[i] as i32));
        let (origin, places) = near.area(corner, state.picture, size);
        let area = window(pair.frames[1].luma(), origin, (places.0 + size.0 - 1, places.1 + size.1 - 1));
        let costs = correlation::map(Score::Zncc, Evaluation::Direct, &first.pixels, &area);
        let all = (0..places.1).flat_map(|y| (0..places.0).map(move |x| (x, y)));
        let best = all.min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or_default();
        let (fraction, _) = place::subpixel(&costs, best);
        let found = [origin[0] + best.0 as i32, origin[1] + best.1 as i32];
        // The picture border ends the search, too, but no template lies beyond it.
        let is_at_least = (0..2).any(|i| (found[i] - corner[i]).abs() == DRIFT_PX);
        Drift { offset: [0, 1].map(|i| point[i] - (found[i] as f32 + fraction[i] + first.anchor[i])), is_at_least }
    }

    /// Stores the decision and moves on to the next pair; returns whether the run ends.
    fn go_on(&self, clip: &Clip, state: &mut State, found: &Found) -> bool {
        let track = Arc::make_mut(&mut state.track);
        if let Some(last) = track.points.last_mut() {
            *last = found.feature;
        }
        let distance = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        Arc::make_mut(&mut state.past).push(Past {
            zncc: found.zncc as f32,
            drift: found.drift,
            error: found.true_point.filter(|_| !found.is_lost()).map(|truth| distance(truth, found.point)),
            is_at_limit: found.is_at_limit(self.search_range),
        });
        let rows = found.pair.costs.height();
        (state.begun, state.turn, state.best, state.pair) = (state.begun + rows + 2, 0, None, None);
        state.frame += 1;
        if found.is_lost() {
            return true;
        }
        track.points.push(Feature::found(found.point));
        state.at = found.pair.corner(found.best);
        if self.update == Update::EveryFrame {
            state.template = Arc::new(self.updated(state, found));
        }
        (state.point, state.true_point) = (found.point, found.true_point);
        state.span.is_over(clip, state.frame + 1)
    }

    /// The window at the match as a template. Its anchor keeps the sub-pixel position.
    fn updated(&self, state: &State, found: &Found) -> Template {
        let (at, size) = (found.pair.corner(found.best), state.template.pixels.size());
        let cut = Template::cut(found.pair.frames[1].luma(), state.frame, at, size);
        Template { anchor: [0, 1].map(|i| found.point[i] - at[i] as f32), ..cut }
    }
}

/// The mean absolute difference of two pictures of one size, in gray levels.
fn mean_difference(a: &Gray, b: &Gray) -> f32 {
    let sum: u64 = a.cells().iter().zip(b.cells()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    (sum as f64 / a.cells().len() as f64) as f32
}

pseudocode! {
    CHOOSE: "T ← template in the first frame; stop if it has no texture",
    EACH_PAIR: "for each pair of frames t, t+1",
    SET_AREA: "  A ← places within search-range of the last position, inside frame t+1",
    EACH_ROW: "  for each row of A",
    SCORE: "    for each place x: s(x) ← score of T and the window of frame t+1 at x; keep the best",
    TAKE_PEAK: "  x* ← place with the best score",
    FIT_PARABOLA: "  x* ← x* + vertex of the parabola through s at x* and its neighbours, along x and y",
    COMPARE_SECOND: "  ratio ← best peak to second-best peak",
    CHECK: "  lost if ZNCC at x* < min-zncc; else the template moves to x*",
    MEASURE_DRIFT: "  drift ← x* − position at which the first template fits best",
    UPDATE: "  if update: T ← window of frame t+1 at x*",
}

impl Estimator for TemplateMatching {
    const INFO: Info = Info {
        id: "template-matching",
        name: "Template matching",
        family: "Correspondence",
        summary: "Slides a template over a search area of the next frame, scores every window, and follows the best through the clip.",
        source: "D. I. Barnea and H. F. Silverman, A class of algorithms for fast digital image registration, IEEE Trans. Computers \
                 21(2), 1972; J. P. Lewis, Vision Interface 1995; template update: I. Matthews, \
                 T. Ishikawa and S. Baker, The template update problem, PAMI 26(6), 2004",
        pseudocode: line::ALL,
        granularities: &["clip", "pair", "row", "candidate"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::place("found", "Where is the template in frame t+1?", line::CHECK, Role::Best),
        Question::choice(
            "best",
            "Is the score of the next place the best so far?",
            &[Reply::told(line::SCORE, case::NOT_BEST, "No"), Reply::told(line::SCORE, case::NEW_BEST, "Yes")],
        ),
        Question::choice(
            "lost",
            "Is the match accepted?",
            &[
                Reply::told(line::CHECK, case::LOST, "No: the template is lost"),
                Reply::at(line::CHECK, "Yes: the template moves there"),
            ],
        ),
    ];
    const GUARANTEE: Guarantee = Guarantee::Better;
    const CHARTS: &'static [Chart] = &[Chart::Surface, Chart::Tiles, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[TrackField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let span = Span::new(clip, frame, self.frames)?;
        let template = Arc::new(self.choose(clip.frame(frame)?.luma(), frame)?);
        let point = [0, 1].map(|i| template.at[i] as f32 + template.anchor[i]);
        let begin = Feature::found(point);
        Ok(State {
            span,
            frame,
            turn: 0,
            begun: 0,
            at: template.at,
            first: Arc::clone(&template),
            template,
            point,
            true_point: Some(point),
            best: None,
            track: Arc::new(Track { first: frame, points: vec![begin] }),
            past: Arc::default(),
            picture: clip.size(),
            is_over: false,
            pair: None,
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let is_first = state.frame == state.span.first && state.turn == 0;
        if is_first && state.template.deviation() < LEAST_DEVIATION {
            observer.see(|| Event::Flat(Arc::clone(&state.template)));
            if let Some(point) = Arc::make_mut(&mut state.track).points.last_mut() {
                point.status = Status::Flat;
            }
            state.is_over = true;
            return Ok(Progress::Done);
        }
        if is_first {
            observer.see(|| Event::Chosen(Arc::clone(&state.template)));
        }
        let pair = self.pair(clip, state)?;
        let rows = pair.costs.height();
        if state.turn == 0 {
            observer.see(|| Event::Area(Arc::clone(&pair)));
        } else if state.turn <= rows {
            state.best = Some(Self::row(&pair, state.best, state.turn - 1, observer));
        } else {
            let found = Arc::new(self.decide(state, &pair, state.best.unwrap_or_default()));
            let mut see = |stage| observer.see(|| Event::Decided(stage, Arc::clone(&found)));
            [Stage::Peak, Stage::Subpixel, Stage::Second, Stage::Check].into_iter().for_each(&mut see);
            if found.drift.is_some() {
                [Stage::Drift, Stage::Update].into_iter().for_each(&mut see);
            }
            state.is_over = self.go_on(clip, state, &found);
            return Ok(if state.is_over { Progress::Done } else { Progress::More });
        }
        state.turn += 1;
        Ok(Progress::More)
    }

    fn units(&self, _: &State) -> Option<usize> {
        None
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let (_, (_, rows)) = self.area(state.at, state.picture, state.template.pixels.size());
        [state.span.place_of_pair(state.frame), vec![Granularity { index: state.turn, of: Some(rows + 2) }]].concat()
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.frame)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Flat(_) => Some(Role::Rejected),
            Event::Decided(Stage::Check, found) if found.is_lost() => Some(Role::Rejected),
            Event::Decided(Stage::Check, _) => Some(Role::Best),
            _ => None,
        }
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let (first, last) = (state.span.first, state.frame);
        Output::of(TrackField { picture: state.picture, first, last, tracks: vec![Arc::clone(&state.track)] })
    }
}

impl Footprint<State> for TemplateMatching {
    fn need(&self, clip: &Clip) -> Need {
        let (width, height) = clip.size();
        let side =
            self.template.map_or(self.size, |zone| zone.size().map(|c| c as usize).into_iter().fold(0, usize::max));
        let reach = side.min(MOST_PX) + 2 * self.search_range + 1;
        let area = (reach.min(width), reach.min(height));
        // Sums, costs, widened pixels and spectra of the area; in a walk the chart and the events of a row too.
        let pixels = (area.0 * area.1) as f64;
        let run = 36.0 * pixels + correlation::bytes(area) as f64;
        Need::default().and([run, run + 60.0 * pixels]).and([8e6; 2])
    }

    fn at_rest(&self, state: &State) -> State {
        State { pair: None, ..state.clone() }
    }

    fn state_bytes(&self, state: &State) -> usize {
        let own = size_of::<State>() + state.track.bytes() + size_of_val(&state.past[..]);
        own + if self.update == Update::EveryFrame { state.template.bytes() } else { 0 }
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let (_, places) = self.area(state.at, state.picture, state.template.pixels.size());
        self.state_bytes(state) + state.first.bytes() + places.0 * places.1 * size_of::<f64>()
    }
}

impl Pointed<State> for TemplateMatching {
    fn takes(&self, picture: Picture) -> bool {
        picture == Picture::NEXT
    }

    /// Returns the row of the window around a position of the second frame of the pair.
    fn unit_at(&self, state: &State, Focus { at: [_, y], .. }: Focus) -> Option<usize> {
        let (origin, places) = self.area(state.at, state.picture, state.template.pixels.size());
        let row = (y - state.template.anchor[1]).round() as i32 - origin[1];
        (0..places.1 as i32).contains(&row).then_some(state.begun + 1 + row as usize)
    }
}
