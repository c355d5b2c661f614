//! Rosten and Drummond's FAST corner detector.

mod charts;
mod explain;
mod marks;
mod probe;

use std::cmp::Reverse;
use std::sync::Arc;

use crate::base::{Error, Mapped, Observer, Tally, Threads};
use crate::data::{Clip, Frame};
use crate::geometry::Grid;
use crate::methods::features::{
    KEPT, Scan, Selection, Stage, choose,
    segment::{self, Candidate, SegmentTest},
    value as features,
};
use crate::products::{Output, PointField, Product, ProductKind};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Question, Reply, Role, Scene, Step, Unit};
use crate::{cases, params, pseudocode, variables};

params! {
    /// FAST corners: pixels with n contiguous pixels of the circle around them that are all brighter or all darker.
    pub struct Fast {
        /// Threshold t: a pixel of the circle is brighter than the centre p above I_p + t, and darker below I_p − t. Higher values find fewer corners, of more contrast.
        threshold: usize = 20, 1..=254, "gray levels";
        /// Length n of the arc: contiguous pixels of the 16 that must be all brighter or all darker. 9 is the most repeatable; 12 allows the original high-speed test with three of four pixels.
        arc: usize = 9, 9..=12, "px";
        /// Limits of distance and number.
        selection: Selection = Selection::default();
    }
}

pseudocode! {
    EACH_PIXEL: "for each pixel p with gray level I_p, at least 3 px from the border",
    HIGH_SPEED: "  reject p unless adjacent compass pixels of the circle, 2 or for n = 12 three, are all > I_p + t or all < I_p − t",
    SEGMENT_TEST: "  reject p unless n contiguous pixels of the 16 on the circle are all > I_p + t or all < I_p − t",
    SCORE: "  else p is a corner with score V ← the largest t for which it is one",
    EACH_CORNER: "for each corner",
    SUPPRESS: "  suppress it unless V exceeds the scores of its 8 neighbours",
    EACH_PEAK: "for each remaining corner, in order of decreasing V",
    DROP_NEAR: "  reject it if a corner was kept within min-distance",
    KEEP: "  else keep it, up to max-points",
}

variables! {
    /// The threshold t: how much a pixel of the circle must be brighter or darker than its centre.
    THRESHOLD: "", "t", Unit::LEVEL;
    /// The contiguous pixels of the circle that must be all brighter or all darker.
    ARC: "Arc length n", "n", Unit::count("");
    /// The adjacent compass pixels that an arc contains.
    COMPASS: "", "", Unit::count("");
    /// The pixels of the row around which a circle fits.
    WITH_CIRCLE: "Pixels with a circle", "", Unit::count("");
    /// The pixels of the row that pass the high-speed test.
    PASSING: "Pass the high-speed test", "", Unit::count(""), Role::Candidate;
    /// The gray level of the pixel.
    LEVEL: "Gray level I_p", "I_p", Unit::WHOLE, Role::Reference;
    /// The pixels of the circle above I_p + t.
    BRIGHTER: "Brighter pixels", "", Unit::count("");
    /// The pixels of the circle below I_p − t.
    DARKER: "Darker pixels", "", Unit::count("");
    /// The longest run of adjacent compass pixels that are all brighter or all darker.
    COMPASS_RUN: "", "", Unit::count("");
    /// The longest run of pixels of the circle that are all brighter or all darker.
    RUN: "Longest run", "", Unit::count("");
    /// The first pixel of the longest run, of 1 to 16.
    RUN_START: "", "", Unit::WHOLE;
    /// The last pixel of the longest run.
    RUN_END: "", "", Unit::WHOLE;
    /// The gray level that the pixels of the longest run exceed or stay below.
    RUN_LIMIT: "", "", Unit::WHOLE;
    /// The corner score: the largest threshold with which the pixel is a corner.
    SCORE: "Score V", "V", Unit::WHOLE, Role::Result;
    /// The score of the neighbour or of the corner that rejects the pixel.
    OTHER_SCORE: "", "", Unit::WHOLE;
    /// The pixel of the best arc with the smallest difference.
    WEAKEST: "", "k", Unit::WHOLE;
    /// The gray level of that pixel.
    WEAKEST_LEVEL: "", "I_k", Unit::WHOLE, Role::Candidate;
    /// The size of its difference from the centre.
    DIFFERENCE: "", "|I_k - I_p|", Unit::WHOLE;
    /// The number of corners.
    CORNERS: "Corners", "", Unit::count("corner");
    /// The highest score in the frame.
    HIGHEST_SCORE: "", "", Unit::WHOLE;
    /// The lowest score of a corner that is kept.
    LOWEST_SCORE: "", "", Unit::WHOLE;
    /// The pixels that pass the segment test.
    FOUND: "", "", Unit::count("pixel");
}

cases! { over value, features;
    OPENING: "At a corner most of a small circle differs from its centre p. FAST compares 16 pixels with I_p and looks for an \
              arc of {arc} contiguous ones, all brighter than I_p + {threshold:bare} or all darker than I_p − \
              {threshold:bare}. It needs only comparisons of gray levels.",
    NO_CIRCLE: "Row {row}: no pixel is 3 px away from the border, so no circle fits and there are no corners.",
    HIGH_SPEED: "Row {row}: {passing} of {with_circle} pixels pass the high-speed test, with {compass} adjacent compass \
                 pixels of the circle (1, 5, 9, 13) all brighter than I_p + {threshold:bare} or all darker than I_p − \
                 {threshold:bare}. Any arc of {arc} contains {compass} of them, so no other pixel can be a corner.",
    OUTSIDE: "{rejected|Pixel} {pixel} is less than 3 px from the border: its circle does not fit into the picture.",
    FAILS_COMPASS: "{rejected|Pixel} {pixel}, I_p = {level}: the longest run of brighter or darker compass pixels is \
                    {compass_run}, and an arc of {arc} needs {compass}: rejected by the high-speed test.",
    LONGEST: "{rejected|Pixel} {pixel}, I_p = {level}: the longest run has {run} contiguous pixels",
    CONTIGUOUS: "{best|Pixel} {pixel}, I_p = {level}: {run} contiguous pixels",
    AT: "(pixel {run_start})",
    FROM_TO: "({run_start} to {run_end})",
    BRIGHTER: "brighter than I_p + {threshold:bare} = {run_limit}",
    DARKER: "darker than I_p\u{a0}−\u{a0}{threshold:bare} = {run_limit}",
    ARE_BRIGHTER: "are brighter than I_p + {threshold:bare} = {run_limit}",
    ARE_DARKER: "are darker than I_p\u{a0}−\u{a0}{threshold:bare} = {run_limit}",
    TOO_SHORT: ". The arc needs {arc}: no corner.",
    CORNER: ", at least {arc}: a corner. Its score is V = {score}, since with t = {difference} its best arc loses pixel \
             {weakest}, which differs by {difference}.",
    NO_CORNERS_IN_ROW: "Row {row} has no corners, so there is nothing to suppress.",
    CORNERS_IN_ROW: "Row {row}: {corners}. Non-maximum suppression keeps those with a score V above that of all 8 neighbours; \
                     an arc slides over neighbouring pixels, so one corner of the scene passes the test several times.",
    MAXIMUM: "{best|Corner} {pixel}: the score {score} exceeds those of all 8 neighbours: a local maximum.",
    SUPPRESSED: "{rejected|Corner} {pixel} has the score {score}, and its neighbour {neighbour}",
    BY_HIGHER: "the higher score {other_score}: suppressed.",
    BY_EQUAL: "the same score {other_score}: neither exceeds the other, so both are suppressed.",
    NO_CORNERS: "No pixel has {arc} contiguous circle pixels that differ by more than {threshold}: there are no corners. The \
                 highest score is V = {highest_score}, and a corner has at least V = t = {threshold:bare}. A lower threshold \
                 finds corners of less contrast.",
    NO_MAXIMA: "No score exceeds those of all 8 neighbours: neighbours with equal scores suppress each other, which happens \
                in pictures without noise. So no corner is left.",
    RANKED: "{corners} {be} ranked by score. In this order at most {max_points} are kept (the maximum number of points), each \
             at least {min_distance} (the minimum distance) from those kept before.",
    KEPT: "Corner {pixel}, V = {score}, has no stronger corner within the minimum distance: kept as number {kept:bare}.",
    NEAR: "Corner {pixel}, V = {score}, is closer than the minimum distance ({min_distance}) to corner {near_corner}, which",
    TO_HIGHER: "has the higher score {other_score}: rejected.",
    TO_EQUAL: "has an equal score and comes first: rejected.",
    HAS_NEIGHBOUR: "Status: suppressed by {neighbour}, V = {other_score}.",
    IS_BEYOND: "Status: not among the {max_points} of highest score.",
    END: "End of the run: {kept} kept, scores {highest_score} to {lowest_score}; {found} passed the segment test and \
          {local_maxima:bare} non-maximum suppression.",
    END_WITH_ONE: "End of the run: {kept} kept, score {highest_score}; {found} passed the segment test and \
                   {local_maxima:bare} non-maximum suppression.",
}

/// The state of a run; the responses are the scores.
type State = Scan<u8>;

/// An event of a unit.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// The high-speed test is applied to a row.
    Row,
    /// The segment test of a pixel that passes the high-speed test.
    Tested(Candidate),
    /// The corners of a row are compared with their neighbours.
    Corners,
    /// A corner, and the neighbour that suppresses it, if one does.
    Compared((usize, usize), Option<(usize, usize)>),
    /// The remaining corners are ranked.
    Ranked,
    /// The next of them, and the corner within min-distance that rejects it, if there is one.
    Peak(u32, Option<u32>),
}

impl Fast {
    fn test(&self) -> SegmentTest {
        SegmentTest { threshold: self.threshold as u8, arc: self.arc }
    }

    fn test_row(&self, picture: &Frame, y: usize, scores: &mut [u8], observer: &mut impl Observer<Event>) {
        observer.see(|| Event::Row);
        self.test().row(picture.luma(), y, scores, &mut Mapped { observer, map: Event::Tested });
    }

    /// Finds the corners of row `y` that are not suppressed.
    fn suppress(&self, scores: &Grid<u8>, y: usize, found: &mut Vec<u32>, observer: &mut impl Observer<Event>) {
        observer.see(|| Event::Corners);
        if watches(observer) {
            for place in corners(scores, y) {
                observer.see(|| Event::Compared(place, segment::suppressed_by(scores, place)));
            }
        }
        segment::maxima(scores, y, |x| found.push((y * scores.width() + x) as u32));
    }

    /// Selects the corners of the highest scores with the minimum distance.
    fn choose(&self, state: &mut State, observer: &mut impl Observer<Event>) {
        let State { map: scores, peaks, .. } = state;
        peaks.sort_unstable_by_key(|&peak| (Reverse(scores.cells()[peak as usize]), peak));
        observer.see(|| Event::Ranked);
        let tested = |peak, near| observer.see(|| Event::Peak(peak, near));
        state.kept = choose(peaks, scores.size(), self.selection, tested);
    }
}

/// Whether `observer` sees any event.
fn watches<O: Observer<Event>>(_: &O) -> bool {
    O::WATCHES
}

/// The corners of a row.
fn corners(scores: &Grid<u8>, y: usize) -> impl Iterator<Item = (usize, usize)> {
    scores.row(y).iter().enumerate().filter(|(_, score)| **score > 0).map(move |(x, _)| (x, y))
}

impl Estimator for Fast {
    const INFO: Info = Info {
        id: "fast",
        name: "FAST corners",
        family: "Interest points",
        summary: "Corner detection by comparing each pixel with a circle of 16 pixels, without any derivative.",
        source: "E. Rosten and T. Drummond, Machine learning for high-speed corner detection, ECCV 2006",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "row", "step"],
        frames: 1,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "corner",
            "Does the next pixel pass the segment test?",
            &[Reply::at(line::SCORE, "Yes: a corner"), Reply::at(line::SEGMENT_TEST, "No")],
        ),
        Question::choice(
            "maximum",
            "Is the next corner a local maximum of the score?",
            &[
                Reply::told(line::SUPPRESS, case::MAXIMUM, "Yes"),
                Reply::told(line::SUPPRESS, case::SUPPRESSED, "No: suppressed"),
            ],
        ),
        KEPT,
    ];
    const GUARANTEE: Guarantee = Guarantee::Places;
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Tiles];
    const PRODUCES: &'static [&'static ProductKind] = &[PointField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State::new(clip.frame(frame)?))
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        match state.stage {
            Stage::Response => {
                let State { picture, map, row, .. } = state;
                self.test_row(picture, *row, Arc::make_mut(map).row_mut(*row), observer);
                Ok(state.next_row())
            }
            Stage::Suppression => {
                let State { map, row, peaks, .. } = state;
                self.suppress(map, *row, peaks, observer);
                Ok(state.next_row())
            }
            Stage::Choice => {
                self.choose(state, observer);
                Ok(Progress::Done)
            }
        }
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.units())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.granularities()
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Tested(Candidate { score: 1.., .. }) | Event::Compared(_, None) => Some(Role::Best),
            Event::Peak(_, None) => Some(Role::Result),
            Event::Compared(_, Some(_)) | Event::Peak(_, Some(_)) => Some(Role::Rejected),
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
        Output::of(state.features())
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        clip.wanted()?;
        let mut state = State::new(clip.frame(frame)?);
        let (width, height) = state.map.size();
        let (rows, mut scores) = (threads.rows_at_once(height), Grid::new(width, height, 0));
        let parts = scores.cells_mut().chunks_mut(rows * width).enumerate();
        threads.each(parts, |(i, part): (usize, &mut [u8])| {
            let mut counter = tally.counter();
            let of_rows = part.chunks_exact_mut(width).enumerate();
            of_rows.for_each(|(j, scores)| self.test_row(&state.picture, i * rows + j, scores, &mut counter));
        });
        let suppress = |i: usize| {
            let (mut found, mut counter) = (Vec::new(), tally.counter());
            let rows = i * rows..((i + 1) * rows).min(height);
            rows.for_each(|y| self.suppress(&scores, y, &mut found, &mut counter));
            found
        };
        let of_rows = threads.map_while(height.div_ceil(rows), || clip.wanted(), suppress)?;
        tally.add_units(state.units());
        (state.map, state.peaks, state.stage) = (Arc::new(scores), of_rows.concat(), Stage::Choice);
        self.choose(&mut state, &mut tally.counter());
        Ok(state)
    }
}

impl Footprint<State> for Fast {
    fn need(&self, clip: &Clip) -> Need {
        let (width, height) = clip.size();
        let pixels = (width * height) as f64;
        // At most every fourth pixel is a local maximum; buckets hold them by place.
        let buckets = pixels * 40.0 / (self.selection.min_distance.max(2) as f64).powi(2);
        let points = 200.0 * (self.selection.max_points as f64).min(pixels / 4.0);
        Need::per_pixel(clip, [6.0, 16.0]).and([points + buckets; 2]).and([0.0, points])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + state.bytes()
    }
}

impl Pointed<State> for Fast {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.unit_at(point)
    }

    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        // The segment test of a pixel depends on the frame alone.
        state.map.cell_at(point).map(|_| Explained::Always)
    }
}
