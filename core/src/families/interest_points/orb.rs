//! ORB: oriented FAST corners on a pyramid, described by rotated comparisons of pixels.

mod explain;
mod marks;
mod probe;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Frame};
use crate::geometry::{Gray, Grid};
use crate::methods::features::{
    Selection,
    brief::{self, BITS, Bits, Moments, Pair},
    choose,
    integral::Integral,
    scale_pyramid::{ScaleLevel, level_count},
    segment::{self, RADIUS, SegmentTest},
    value as features,
};
use crate::products::keypoints::WINDOW_SIGMAS;
use crate::products::{Descriptor, Feature, Keypoint, Output, PointField, Product, ProductKind, Status};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Question, Reply, Role, Scene, Step, Unit};
use crate::{cases, params, pseudocode, variables};

params! {
    /// ORB keypoints: FAST corners on a pyramid, ranked by their Harris response, with an orientation and a binary descriptor.
    pub struct Orb {
        /// Number of pyramid levels. More levels find larger corners.
        levels: usize = 8, 1..=8;
        /// Scale factor f between two levels.
        scale_factor: f32 = 1.2, 1.1..=2.0;
        /// Threshold t of FAST: pixels of the circle are brighter than the centre p above I_p + t, and darker below I_p − t.
        threshold: usize = 20, 1..=254, "gray levels";
        /// Length n of the arc of FAST: contiguous pixels of the 16 that must be all brighter or all darker.
        arc: usize = 9, 9..=12, "px";
        /// Side of the patch on its level, for orientation and descriptor; an even side is rounded up.
        patch: usize = 31, 15..=63, "px";
        /// Limits of distance and number.
        selection: Selection = Selection { min_distance: 0, ..Selection::default() };
    }
    advanced { "arc", "patch" }
}

pseudocode! {
    EACH_LEVEL: "for each level of the pyramid, f times smaller than the one before",
    RESAMPLE: "  resample the picture to this level",
    DETECT: "  corners ← FAST with non-maximum suppression, where the patch fits",
    RANK: "  rank them by Harris response R = det T − k (tr T)²",
    DROP_NEAR: "  reject a corner within min-distance of a stronger one",
    KEEP: "  keep the others as keypoints, up to the share of the level in max-points",
    EACH_KEYPOINT: "for each keypoint",
    ORIENT: "  θ ← atan2(m₀₁, m₁₀), the direction of the intensity centroid of the disc around it",
    COMPARE: "  for each pair of 5×5 windows a, b of the pattern, turned by θ: bit ← mean of a < mean of b",
}

variables! {
    /// The current level of the pyramid.
    LEVEL: "Level", "", Unit::WHOLE;
    /// The number of levels of the pyramid.
    LEVELS: "Levels", "", Unit::count("level");
    /// The threshold t of FAST.
    THRESHOLD: "", "t", Unit::LEVEL;
    /// The length of the arc of FAST.
    ARC: "", "n", Unit::count("");
    /// The side of the patch around a keypoint.
    PATCH: "", "", Unit::new("px", 0);
    /// The keypoints that the level may have, in proportion to its width.
    SHARE: "Share of the keypoints", "", Unit::count("");
    /// The scale factor between two levels.
    SCALE_FACTOR: "", "f", Unit::SET;
    /// The width of a pixel of the level in the frame.
    PIXEL_WIDTH: "", "", Unit::SUBPIXEL;
    /// The corners that FAST finds on the level.
    CORNERS: "Corners of FAST", "", Unit::count("corner");
    /// The corners around which the patch fits.
    WITH_ROOM: "With room for the patch", "", Unit::count("");
    /// The corners of the level that become keypoints.
    STRONGEST: "", "", Unit::count("");
    /// The moment of order 0 of the disc around the keypoint: the sum of its gray levels.
    M_00: "m₀₀", "m_{00}", Unit::WHOLE;
    /// The moment of the disc along x.
    M_10: "m₁₀", "m_{10}", Unit::WHOLE, Role::Estimate;
    /// The moment of the disc along y.
    M_01: "m₀₁", "m_{01}", Unit::WHOLE, Role::Estimate;
    /// The intensity centroid of the disc relative to its middle.
    CENTROID: "", "", Unit::SUBPIXEL, Role::Estimate;
    /// The number of the pair of windows, from 1.
    PAIR: "", "", Unit::count("");
    /// The middle of the first window of the pair.
    FIRST_WINDOW: "", "a", Unit::new("px", 0), Role::Candidate;
    /// The middle of the second window of the pair.
    SECOND_WINDOW: "", "b", Unit::new("px", 0), Role::Candidate;
    /// The mean of the first window.
    FIRST_MEAN: "Mean of the first window", "", Unit::FINE, Role::Candidate;
    /// The mean of the second window.
    SECOND_MEAN: "Mean of the second window", "", Unit::FINE, Role::Candidate;
    /// The bit of the pair: whether the first mean is smaller.
    BIT: "", "", Unit::WHOLE, Role::Result;
    /// The bits of the descriptor so far.
    BITS: "Bits so far", "", Unit::count("");
    /// The bits so far that are 1.
    BITS_SET: "Bits set", "", Unit::count("");
    /// The last bits, the newest on the right.
    LAST_BITS: "Last bits", "", Unit::WHOLE;
    /// The highest FAST score of all levels.
    HIGHEST_SCORE: "", "V", Unit::WHOLE;
    /// The smallest distance of a keypoint from the border.
    MARGIN: "", "", Unit::new("px", 0);
    /// The keypoints of each level, from level 0 on.
    BY_LEVEL: "", "", Unit::WHOLE;
    /// The share of the bits of all descriptors that are 1.
    ONES: "", "", Unit::PERCENT;
}

cases! { over value, features;
    OPENING: "ORB detects FAST corners on the levels of a pyramid, so that it finds corners of several sizes. Each gets the \
              direction of its intensity centroid as orientation, and a descriptor of 256 bits: comparisons of two small \
              windows, turned by the orientation.",
    FRAME: "Level 0 is the frame itself with {width:bare}×{height}. Its share of the {max_points} keypoints is {share}: a \
            level gets them in proportion to its width.",
    SMALLER: "Level {level} has {width:bare}×{height}, a factor {scale_factor} smaller than the level before: a pixel is \
              {pixel_width} of the frame wide. Its share of the keypoints is {share}.",
    NO_CORNERS: "FAST finds no corner on level {level}: no arc of {arc} pixels differs by more than {threshold}. A lower \
                 threshold finds corners of less contrast.",
    DETECTED: "FAST with an arc of {arc} and a threshold of {threshold} finds {corners} on level {level} after non-maximum \
               suppression. The {patch:bare}×{patch} patch fits into the picture around {with_room} of them.",
    NONE_RANKED: "There is no corner on level {level} to be ranked.",
    RANKED: "The FAST score is high along edges too, so the corners are ranked by their Harris response over 7×7 px, here \
             {first_response} to {last_response}. Keypoints of level {level}: the strongest {strongest}.",
    KEPT: "Corner {pixel} of level {level}, R = {response}: kept as keypoint {kept:bare} of the {share} that the level may \
           have.",
    NEAR: "Corner {pixel} of level {level}, R = {response}, is closer than the minimum distance ({min_distance} of the frame) \
           to corner {near_corner} with R = {other_response}, which is no smaller: rejected.",
    ORIENTED: "Keypoint {keypoint} of {keypoints:bare} on level {level} at {pixel}: the moments of its disc are m₁₀ = {m_10} \
               and m₀₁ = {m_01}, so the intensity centroid lies at {centroid} from the middle. Orientation θ = atan2(m₀₁, \
               m₁₀) = {orientation}.",
    COMPARED: "Pair {pair} of 256, turned by {orientation}: the 5×5 window at {first_window} of level {level} has the mean \
               {first_mean},",
    LESS: "less than {second_mean} of the window at {second_window}, so the bit is 1.",
    NOT_LESS: "not less than {second_mean} of the window at {second_window}, so the bit is 0.",
    NO_CONTRAST: "End of the run: no keypoints. The highest score of all levels is V = {highest_score}, and a corner has at \
                  least V = t = {threshold:bare}; a lower threshold finds some.",
    NO_ROOM: "End of the run: no keypoints. No corner is at least {margin} from the border and so has a patch of \
              {patch:bare}×{patch}; a smaller patch finds some.",
    END: "End of the run: {keypoints} on {levels} ({by_level}, from level 0 on). {ones} of all bits are 1; near one half, \
          descriptors of different points differ most.",
    SOME_HAVE_FEWER: "Some levels have fewer corners than their share; a lower threshold also finds weaker ones.",
    ALL_HAVE_MORE: "Every level has more corners than its share; a larger maximum number of points keeps weaker ones.",
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    /// Frame t.
    picture: Arc<Frame>,
    /// The levels so far.
    levels: Vec<Arc<Level>>,
    /// Number of levels that there will be.
    level_count: usize,
    /// The pairs of windows that are compared.
    pattern: Arc<[Pair]>,
    /// The keypoints, level after level, once all are detected.
    corners: Arc<[Corner]>,
    /// Orientation and descriptor of the first of them.
    described: Vec<Described>,
}

/// A level of the pyramid with its corners.
#[derive(Debug)]
pub struct Level {
    /// The picture, resampled.
    of: ScaleLevel,
    integral: Integral,
    /// The largest number of keypoints of this level.
    share: usize,
    /// The number of corners of FAST, with those near the border.
    found: usize,
    /// The places where the patch fits, with their responses, the strongest first.
    ranked: Vec<(u32, f32)>,
}

/// A keypoint as it was detected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    level: usize,
    /// Its pixel of the level.
    place: (usize, usize),
    /// Harris response.
    response: f32,
}

/// Orientation and descriptor of a keypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Described {
    moments: Moments,
    bits: Bits,
}

/// An event of a unit.
#[derive(Clone, Debug)]
pub enum Event {
    /// A level is resampled.
    Resampled(Arc<Level>),
    /// Its corners are detected.
    Detected,
    /// They are ranked.
    Ranked,
    /// The next of them, and the one within min-distance that rejects it, if there is one.
    Peak(u32, Option<u32>),
    /// The moments of the disc around a keypoint.
    Centroid(Moments),
    /// The next bit of its descriptor.
    Compared(bool),
}

/// The Harris constant k.
const HARRIS_K: f32 = 0.04;

/// The windows over which a response is taken reach this far from their middle: 7×7 px.
const RESPONSE_REACH: usize = 3;

/// The Harris response of a pixel: Sobel's derivatives, averaged over 7×7 px.
fn response(picture: &Gray, (x, y): (usize, usize)) -> f32 {
    let (mut xx, mut xy, mut yy) = (0i32, 0i32, 0i32);
    for j in y - RESPONSE_REACH..=y + RESPONSE_REACH {
        let rows = [j - 1, j, j + 1]
            .map(|row| &picture.row(row)[x - RESPONSE_REACH - 1..=x + RESPONSE_REACH + 1])
            .map(|row| <[u8; 2 * RESPONSE_REACH + 3]>::try_from(row).unwrap_or_default().map(i32::from));
        for i in 1..=2 * RESPONSE_REACH + 1 {
            let [above, here, below] = rows;
            let across = above[i + 1] + 2 * here[i + 1] + below[i + 1] - above[i - 1] - 2 * here[i - 1] - below[i - 1];
            let down = below[i - 1] + 2 * below[i] + below[i + 1] - above[i - 1] - 2 * above[i] - above[i + 1];
            xx += across * across;
            xy += across * down;
            yy += down * down;
        }
    }
    // Sobel's weights sum to 8 for a derivative of one gray level per px.
    let pixels = ((2 * RESPONSE_REACH + 1) * (2 * RESPONSE_REACH + 1)) as f32;
    let [xx, xy, yy] = [xx, xy, yy].map(|sum| sum as f32 / (64.0 * pixels));
    let trace = xx + yy;
    xx * yy - xy * xy - HARRIS_K * trace * trace
}

impl Orb {
    /// The radius of the patch.
    fn radius(&self) -> usize {
        self.patch / 2
    }

    /// The side of the patch on its level in px.
    fn side(&self) -> usize {
        2 * self.radius() + 1
    }

    /// The pixels next to the border that have no patch, or no response.
    fn margin(&self) -> usize {
        self.radius().max(RESPONSE_REACH + 1).max(RADIUS)
    }

    fn begin(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let picture = clip.frame(frame)?;
        let (level_count, pattern) = (self.level_count(picture.size()), brief::pattern(self.radius()).into());
        let (levels, described) = (Vec::new(), Vec::new());
        Ok(State { picture, levels, level_count, pattern, corners: Arc::default(), described })
    }

    /// The number of levels that have room for a patch.
    fn level_count(&self, size: (usize, usize)) -> usize {
        level_count(size, self.scale_factor, (2 * self.margin() + 1, self.levels))
    }

    /// The number of keypoints of a level: in proportion to its width, as its corners are per px of a contour.
    fn share(&self, level: usize, levels: usize) -> usize {
        let (most, ratio) = (self.selection.max_points as f64, 1.0 / f64::from(self.scale_factor));
        let up_to =
            |level: usize| (most * (1.0 - ratio.powi(level as i32)) / (1.0 - ratio.powi(levels as i32))).round();
        (up_to(level + 1) - up_to(level)) as usize
    }

    fn resampled(&self, picture: &Gray, before: Option<&ScaleLevel>) -> ScaleLevel {
        before.map_or_else(|| ScaleLevel::first(picture.clone()), |before| before.next(self.scale_factor))
    }

    /// Detects and ranks the corners of a level.
    fn detected(&self, of: ScaleLevel, share: usize) -> Level {
        let (width, height) = of.picture.size();
        let (margin, mut scores) = (self.margin(), Grid::new(width, height, 0));
        let test = SegmentTest { threshold: self.threshold as u8, arc: self.arc };
        (0..height).for_each(|y| test.row(&of.picture, y, scores.row_mut(y), &mut ()));
        let (mut found, mut ranked) = (0, Vec::new());
        for y in 0..height {
            segment::maxima(&scores, y, |x| {
                found += 1;
                let fits = |c: usize, extent: usize| c >= margin && c + margin < extent;
                if fits(x, width) && fits(y, height) {
                    ranked.push(((y * width + x) as u32, response(&of.picture, (x, y))));
                }
            });
        }
        ranked.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        Level { integral: Integral::of(&of.picture), of, share, found, ranked }
    }

    fn selected(&self, (index, level): (usize, &Level), observer: &mut impl Observer<Event>) -> Vec<Corner> {
        let (width, _) = level.of.picture.size();
        let ranked: Vec<u32> = level.ranked.iter().map(|(place, _)| *place).collect();
        let min_distance = (self.selection.min_distance as f32 / level.of.scale).round() as usize;
        let limits = Selection { min_distance, max_points: level.share };
        let kept = choose(&ranked, level.of.picture.size(), limits, |peak, near| {
            observer.see(|| Event::Peak(peak, near));
        });
        let mut rest = level.ranked.iter();
        let corner = |place: &u32| {
            // Both are in the same order.
            let response = rest.find(|(other, _)| other == place).map_or(0.0, |(_, response)| *response);
            Corner { level: index, place: (*place as usize % width, *place as usize / width), response }
        };
        kept.iter().map(corner).collect()
    }

    /// Orients and describes a keypoint.
    fn describe(&self, state: &State, index: usize, observer: &mut impl Observer<Event>) -> Described {
        let Corner { level, place, .. } = state.corners[index];
        let Level { of, integral, .. } = &*state.levels[level];
        let moments = Moments::of(&of.picture, place, self.radius());
        observer.see(|| Event::Centroid(moments));
        let bits = brief::describe(integral, place, (&state.pattern, moments.direction()), |_, bit| {
            observer.see(|| Event::Compared(bit));
        });
        Described { moments, bits }
    }
}

impl State {
    /// Returns the index of the keypoint that is described next, once all levels are done.
    fn current(&self) -> Option<usize> {
        (self.levels.len() == self.level_count).then_some(self.described.len())
    }

    fn progress(&self) -> Progress {
        match self.levels.len() == self.level_count && self.described.len() == self.corners.len() {
            true => Progress::Done,
            false => Progress::More,
        }
    }

    /// Returns the position of a keypoint in the frame.
    fn at(&self, corner: &Corner) -> [f32; 2] {
        let (x, y) = corner.place;
        self.levels[corner.level].of.in_frame([x as f32, y as f32])
    }

    /// Returns the described keypoints, the strongest first, given the side of a patch on its level. Their scale is a twelfth of the side in
    /// the frame, as the window of a SIFT descriptor is 12 σ wide.
    fn features(&self, side: usize) -> PointField {
        let mut order: Vec<usize> = (0..self.described.len()).collect();
        order.sort_by(|a, b| self.corners[*b].response.total_cmp(&self.corners[*a].response));
        let feature = |&i: &usize| Feature {
            at: self.at(&self.corners[i]),
            displacement: None,
            status: Status::Found,
            residual: None,
        };
        let keypoint = |&i: &usize| Keypoint {
            response: self.corners[i].response,
            scale_px: Some(self.levels[self.corners[i].level].of.scale * side as f32 / WINDOW_SIGMAS),
            angle_rad: Some(self.described[i].moments.angle_rad()),
            descriptor: Some(Descriptor::Bits(self.described[i].bits.to_vec().into())),
        };
        PointField {
            picture: self.picture.size(),
            points: order.iter().map(feature).collect(),
            keypoints: order.iter().map(keypoint).collect(),
        }
    }
}

impl Estimator for Orb {
    const INFO: Info = Info {
        id: "orb",
        name: "ORB keypoints",
        family: "Interest points",
        summary: "FAST corners on a pyramid with the orientation of their intensity centroid and a descriptor of 256 comparisons.",
        source: "E. Rublee, V. Rabaud, K. Konolige and G. Bradski, ORB: an efficient alternative to SIFT or SURF, ICCV 2011; with a \
                 random pattern as in M. Calonder et al., BRIEF, ECCV 2010",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "part", "step"],
        frames: 1,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "bit",
            "Which value does the bit of the next pair have?",
            &[
                Reply::told(line::COMPARE, case::LESS, "1: the first mean is smaller"),
                Reply::told(line::COMPARE, case::NOT_LESS, "0"),
            ],
        ),
        Question::value("corners", "How many corners does FAST find on the next level?", line::DETECT, value::CORNERS)
            .unless_told(&[case::NO_CORNERS]),
    ];
    // Coarse levels are sampled at other places when the picture moves.
    const GUARANTEE: Guarantee = Guarantee::SubPixelPlaces { off_centi_px: 150 };
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Tiles];
    const PRODUCES: &'static [&'static ProductKind] = &[PointField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.begin(clip, frame)
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        if let Some(index) = state.current() {
            let described = self.describe(state, index, observer);
            state.described.push(described);
            return Ok(state.progress());
        }
        let index = state.levels.len();
        let of = self.resampled(state.picture.luma(), state.levels.last().map(|level| &level.of));
        let level = Arc::new(self.detected(of, self.share(index, state.level_count)));
        observer.see(|| Event::Resampled(Arc::clone(&level)));
        observer.see(|| Event::Detected);
        observer.see(|| Event::Ranked);
        let corners = self.selected((index, &level), observer);
        state.corners = state.corners.iter().copied().chain(corners).collect();
        state.levels.push(level);
        Ok(state.progress())
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.current().map(|_| state.level_count + state.corners.len())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let (stage, index, of) = match state.current() {
            Some(index) => (1, index, state.corners.len()),
            None => (0, state.levels.len(), state.level_count),
        };
        let granularity = |index, of| Granularity { index, of: Some(of) };
        vec![granularity(0, 1), granularity(stage, 2), granularity(index, of)]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Resampled(_) | Event::Centroid(_) => Some(Role::Window),
            Event::Peak(_, None) => Some(Role::Result),
            Event::Peak(_, Some(_)) => Some(Role::Rejected),
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
        Output::of(state.features(self.side()))
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.begin(clip, frame)?;
        let mut pyramid: Vec<ScaleLevel> = Vec::new();
        for _ in 0..state.level_count {
            clip.wanted()?;
            let next = self.resampled(state.picture.luma(), pyramid.last());
            pyramid.push(next);
        }
        let levels = pyramid.into_iter().enumerate().map(|(i, of)| (of, self.share(i, state.level_count)));
        let detected = threads.gather(levels, |(of, share)| clip.wanted().map(|()| Arc::new(self.detected(of, share))));
        state.levels = detected.into_iter().collect::<Result<_, _>>()?;
        let selected = |level: (usize, &Arc<Level>)| self.selected((level.0, level.1), &mut tally.counter());
        state.corners = state.levels.iter().enumerate().flat_map(selected).collect();
        // Resampling, detection and ranking of each level.
        tally.add_events(3 * state.level_count as u64);
        tally.add_events(((1 + BITS) * state.corners.len()) as u64);
        tally.add_units(state.level_count + state.corners.len());
        let describe = |index| self.describe(&state, index, &mut ());
        state.described = threads.map_while(state.corners.len(), || clip.wanted(), describe)?;
        Ok(state)
    }
}

impl Footprint<State> for Orb {
    fn need(&self, clip: &Clip) -> Need {
        let (width, height) = clip.size();
        let pixels = (width * height) as f64;
        let level = |level: usize| f64::from(self.scale_factor).powi(-2 * level as i32);
        let area: f64 = (0..self.level_count(clip.size())).map(level).sum();
        let points = (self.selection.max_points as f64).min(pixels * area / 4.0);
        // Picture, integral image and scores of each level, and its corners in lists.
        Need::per_pixel(clip, [14.0 * area, 14.0 * area]).and([400.0 * points, 1600.0 * points])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.levels[..]) + size_of_val(&state.described[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let level = |level: &Arc<Level>| {
            size_of_val(level.of.picture.cells()) + level.integral.bytes() + size_of_val(&level.ranked[..])
        };
        self.state_bytes(state) + size_of_val(&state.corners[..]) + state.levels.iter().map(level).sum::<usize>()
    }
}

impl Pointed<State> for Orb {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.current()?;
        let distance = |corner: &Corner| {
            let [x, y] = state.at(corner);
            (x - point[0]).hypot(y - point[1])
        };
        let nearest = state.corners.iter().map(distance).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|(_, distance)| *distance < NEAR).map(|(i, _)| state.level_count + i)
    }
}

/// A click within this distance selects a keypoint, in px.
const NEAR: f32 = 8.0;
