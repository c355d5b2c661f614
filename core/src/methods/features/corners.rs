//! Corner detection: response map, threshold, non-maximum suppression, and selection by response and distance.

use std::sync::Arc;

use super::declare::QUESTIONS;
use super::response::Tensors;
use super::scan::{Scan, Stage};
use super::select::{Peaks, Settings, choose, largest, rank};
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::Clip;
use crate::geometry::{Gray, Grid};
use crate::params::{Params, inner_params};
use crate::products::{Output, PointField, Product, ProductKind};
use crate::run::{
    Cursor, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen,
};
use crate::scene::{Case, Chart, Focus, Question, Role, Scene, Step};

/// A corner measure: the response as a function of the structure tensor.
pub trait Measure: Params + Default + Clone + Send + Sync + 'static {
    /// The detector's name, source and pseudocode.
    const INFO: Info;

    /// Returns the parameters that all corner detectors share.
    fn settings(&self) -> Settings;

    /// Returns the corner response from the windowed means of I_x², I_x I_y and I_y².
    fn response(&self, tensor: [f32; 3]) -> f32;

    /// The displayed function of the response, for the legend.
    const SHOWN: &'static str;

    /// Returns the displayed value of a response, compressed so that weak responses stay visible.
    fn shown(response: f32) -> f32;

    /// Writes the response of a step in symbols and in numbers.
    fn formulas(&self, step: Step, tensor: [f32; 3]) -> Step;

    /// Whether a pixel that is not flat has gradients in two directions.
    fn is_corner(&self, eigenvalues: [f32; 2], response: f32) -> bool;

    /// The beginnings of the sentence about a response: in a flat area, at an edge and at a corner.
    const MEANING: [&'static Case; 3];
}

/// The corner detector with the measure `M`.
#[derive(Clone, Debug, Default)]
pub struct Corners<M>(pub M);

inner_params!(Corners<M: Measure>);

/// The state of a run.
#[derive(Clone)]
pub struct State {
    pub(super) scan: Scan<f32>,
    pub(super) largest: f32,
}

/// An event of a unit.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// The response of the next pixel of the row.
    Response(f32),
    /// The threshold is applied to a row.
    Row,
    /// A pixel that reaches the threshold, and the neighbour that suppresses it, if one does.
    Over((usize, usize), Option<(usize, usize)>),
    /// The local maxima are ranked.
    Ranked,
    /// The next local maximum, and the corner within min-distance that rejects it, if there is one.
    Peak(u32, Option<u32>),
}

impl State {
    fn new(clip: &Clip, frame: usize) -> Result<Self, Error> {
        Ok(Self { scan: Scan::new(clip.frame(frame)?), largest: 0.0 })
    }
}

impl<M: Measure> Corners<M> {
    pub(super) fn tensors<'a>(&self, state: &'a State) -> Tensors<'a> {
        self.tensors_of(state.scan.picture.luma())
    }

    fn tensors_of<'a>(&self, picture: &'a Gray) -> Tensors<'a> {
        let Settings { window, weights, derivatives, .. } = self.0.settings();
        Tensors { picture, scheme: derivatives, window: weights.window(window / 2) }
    }

    /// Returns the response map of an image.
    pub(crate) fn map(&self, picture: &Gray, threads: &Threads) -> Grid<f32> {
        let (width, height) = picture.size();
        let rows = threads.rows_at_once(height);
        let mut map = Grid::new(width, height, 0.0);
        let parts = map.cells_mut().chunks_mut(rows * width).enumerate();
        let tensors = self.tensors_of(picture);
        threads.each(parts, |(i, part): (usize, &mut [f32])| self.respond(&tensors, i * rows, part));
        map
    }

    pub(super) fn peaks<'a>(&self, state: &'a State) -> Peaks<'a> {
        Peaks { map: &state.scan.map, limit: self.0.settings().threshold * state.largest }
    }

    /// Computes the responses of the rows from `first`, as many as `responses` holds.
    fn respond(&self, tensors: &Tensors<'_>, first: usize, responses: &mut [f32]) {
        let width = tensors.picture.width();
        tensors.rows(first..first + responses.len() / width, |y, [xx, xy, yy]| {
            let row = &mut responses[(y - first) * width..][..width];
            for (response, (xx, (xy, yy))) in row.iter_mut().zip(xx.iter().zip(xy.iter().zip(yy))) {
                *response = self.0.response([*xx, *xy, *yy]);
            }
        });
    }

    /// Finds the local maxima of row `y`.
    fn suppress(&self, peaks: Peaks<'_>, y: usize, found: &mut Vec<u32>, observer: &mut impl Observer<Event>) {
        observer.see(|| Event::Row);
        for x in peaks.over(y) {
            observer.see(|| Event::Over((x, y), peaks.suppressed_by((x, y))));
        }
        peaks.peaks(y, |x| found.push((y * peaks.map.width() + x) as u32));
    }

    /// Selects the strongest local maxima with the minimum distance.
    fn choose(&self, state: &mut State, observer: &mut impl Observer<Event>) {
        state.scan.peaks = rank(&state.scan.map, &state.scan.peaks);
        observer.see(|| Event::Ranked);
        let tested = |peak, near| observer.see(|| Event::Peak(peak, near));
        state.scan.kept = choose(&state.scan.peaks, state.scan.map.size(), self.0.settings().selection, tested);
    }

    /// Runs from start to end.
    fn whole(&self, mut state: State, threads: &Threads, tally: &impl Tally<Event>) -> State {
        let height = state.scan.map.height();
        let map = self.map(state.scan.picture.luma(), threads);
        // A response for each pixel; units are the rows of both passes and the choice.
        tally.add_events(map.cells().len() as u64);
        tally.add_units(state.scan.units());
        state.largest = largest(map.cells());
        state.scan.map = Arc::new(map);
        let (peaks, rows) = (self.peaks(&state), threads.rows_at_once(height));
        let of_rows = threads.map(height.div_ceil(rows), |i| {
            let mut found = Vec::new();
            (i * rows..((i + 1) * rows).min(height))
                .for_each(|y| self.suppress(peaks, y, &mut found, &mut tally.counter()));
            found
        });
        state.scan.peaks = of_rows.concat();
        (state.scan.stage, state.scan.row) = (Stage::Choice, 0);
        self.choose(&mut state, &mut tally.counter());
        state
    }
}

/// The memory of the response map and the local maxima, ranked and in buckets.
fn need_of_corners(clip: &Clip, min_distance: usize) -> [f64; 2] {
    let (width, height) = clip.size();
    let pixels = (width * height) as f64;
    let by_place = if min_distance > 1 { pixels * 40.0 / (min_distance as f64).powi(2) } else { 0.0 };
    [14.0 * pixels + by_place, 34.0 * pixels + by_place]
}

impl<M: Measure> Estimator for Corners<M> {
    const INFO: Info = M::INFO;
    const QUESTIONS: &'static [Question] = QUESTIONS;
    const GUARANTEE: Guarantee = Guarantee::Places;
    const CHARTS: &'static [Chart] = &[Chart::Regions, Chart::Tiles];
    const PRODUCES: &'static [&'static ProductKind] = &[PointField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        State::new(clip, frame)
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        match state.scan.stage {
            Stage::Response => {
                let mut row = vec![0.0; state.scan.map.width()];
                self.respond(&self.tensors(state), state.scan.row, &mut row);
                row.iter().for_each(|response| observer.see(|| Event::Response(*response)));
                state.largest = state.largest.max(largest(&row));
                Arc::make_mut(&mut state.scan.map).row_mut(state.scan.row).copy_from_slice(&row);
                Ok(state.scan.next_row())
            }
            Stage::Suppression => {
                let mut found = std::mem::take(&mut state.scan.peaks);
                self.suppress(self.peaks(state), state.scan.row, &mut found, observer);
                state.scan.peaks = found;
                Ok(state.scan.next_row())
            }
            Stage::Choice => {
                self.choose(state, observer);
                Ok(Progress::Done)
            }
        }
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.scan.units())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.scan.granularities()
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Over(_, None) => Some(Role::Best),
            Event::Peak(_, None) => Some(Role::Result),
            Event::Over(_, Some(_)) | Event::Peak(_, Some(_)) => Some(Role::Rejected),
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
        Output::of(state.scan.features())
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        Ok(self.whole(State::new(clip, frame)?, threads, tally))
    }
}

impl<M: Measure> Footprint<State> for Corners<M> {
    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [0.0; 2]).and(need_of_corners(clip, self.0.settings().selection.min_distance))
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + state.scan.bytes()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + self.tensors(state).bytes()
    }
}

impl<M: Measure> Pointed<State> for Corners<M> {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.scan.unit_at(point)
    }

    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        let (x, y) = state.scan.map.cell_at(point)?;
        Some(Explained::From(Cursor { unit: y, event: x + 1 }))
    }
}
