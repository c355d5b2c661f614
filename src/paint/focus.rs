//! Focus: the part of the picture in which a step works, and how closely it is shown.
//!
//! The bounds come from the marks of a scene by their roles, so that every estimator has them and none is named.
//!
//! `Work::of` takes the bounds, `CloseUp::of` the magnification of all pictures beside each other in coarse steps; figures and
//! the stage (`ui/stage/follow.rs`) ask the same. A zoom by hand pauses the focus; `Angles::section`, the part then shown, is
//! what files and sessions show.

mod local;

use motionscope_core::scene::{Mark, Picture, Role, Scene, Shape};

use super::primitive::Rect;

/// When the pictures show the part at work in the place of the whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FocusMode {
    /// Where the work is small.
    Auto,
    /// Wherever a step works on a part.
    On,
    /// Never.
    #[default]
    Off,
}

impl FocusMode {
    /// Every mode.
    pub const ALL: [FocusMode; 3] = [FocusMode::Auto, FocusMode::On, FocusMode::Off];

    /// Stable name, for sessions and the command line.
    pub const fn id(self) -> &'static str {
        match self {
            FocusMode::Auto => "auto",
            FocusMode::On => "on",
            FocusMode::Off => "off",
        }
    }

    /// Name as shown.
    pub const fn name(self) -> &'static str {
        match self {
            FocusMode::Auto => "Focus where the work is small",
            FocusMode::On => "Focus at every step",
            FocusMode::Off => "Whole picture",
        }
    }

    /// What it shows, in one sentence.
    pub const fn tip(self) -> &'static str {
        match self {
            FocusMode::Auto => {
                "Magnify the block, window or ellipse of the step where it takes less than 1/6 of the picture, the outline of a model \
                 or the surroundings of a tracked object where they take less than 1/4."
            }
            FocusMode::On => "Magnify the block, window, ellipse or pixel of every step that has one.",
            FocusMode::Off => "Show the whole picture at every step.",
        }
    }

    /// Whether `work` on a picture of this size is magnified; `at_end` is the end of the run.
    fn wants(self, work: &Work, size: [f32; 2], at_end: bool) -> bool {
        match self {
            FocusMode::Off => false,
            FocusMode::On => true,
            FocusMode::Auto => {
                !at_end && !work.is_picture_wide && work.side().powi(2) < size[0] * size[1] / work.large()
            }
        }
    }
}

/// Work on less than one part in so many of the picture is small: a square around it is compared with the picture.
const LARGE: f32 = 6.0;
/// The same for work that a scene names. Its marks are small, as the ways to edges around a model, so that more of the picture is magnified.
const LARGE_NAMED: f32 = 4.0;
/// Side in px of what is shown around a single pixel, so that its neighbourhood is seen.
const LEAST_SIDE: f32 = 22.0;
/// Room around the work, as a share of it and in px.
const MARGIN: (f32, f32) = (0.12, 2.0);
/// Room on each side of a tracked object, in sizes of it: six of them are seen across.
const OBJECT_MARGIN: f32 = 2.5;
/// The largest magnification of a tracked object: closer, the view would leap with each change of its covariance.
const OBJECT_MOST: f32 = 4.0;
/// How much smaller than they could be shown works and tracked objects may be, before they are shown larger.
const SLACK: (f32, f32) = (2.0, 10.0);
/// Steps of magnification: coarse, so that a little more or less work does not change it.
const STEPS: [f32; 13] = [1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 96.0];
/// Least side in px of a section that is shown.
const LEAST_SECTION: f32 = 1.0;
/// More points or arrows in one mark are a result of many places, not the work of one step.
const FEW: usize = 24;

/// A circle of at most this radius in px surrounds a point; a larger one is a neighbourhood, as that of a descriptor.
const SPOT: f32 = 4.0;

/// Where a step works, in image pixels of frame t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Bounds of the marks at work.
    pub bounds: Rect,
    /// The part of them without which the step cannot be followed: all but a search window in which nothing is tested yet.
    needed: Rect,
    /// Whether the step works on all pixels at once, builds a map of them all, sums up the picture or has single points only, among
    /// lines all over it; then a pixel is only an example.
    pub is_picture_wide: bool,
    /// Whether there are only several of a kind, as all detections of a frame: then the step is about none of them alone.
    pub is_of_many: bool,
    /// Whether the step is about an object that is tracked, predicted or estimated with its covariance: then its surroundings are
    /// seen too.
    is_object: bool,
    /// Whether the scene names it.
    is_named: bool,
}

impl Work {
    /// The work that `scene` shows on a picture of `size` px; `None` where none of its marks is at work.
    pub fn of(scene: &Scene, size: (usize, usize)) -> Option<Self> {
        let picture = [size.0 as f32, size.1 as f32];
        let inside = |bounds: Rect| Rect {
            min: [0, 1].map(|i| bounds.min[i].clamp(-0.5, picture[i] - 0.5)),
            max: [0, 1].map(|i| bounds.max[i].clamp(-0.5, picture[i] - 0.5)),
        };
        let marks = || scene.marks.iter().filter(|mark| mark.on.is_aligned_with(Picture::CURRENT));
        let whole = Rect { min: [-0.5; 2], max: picture.map(|extent| extent - 0.5) };
        let spoken = spoken_of(scene).filter(|bounds| whole.meets(bounds));
        let with_spoken = |bounds: Rect| inside(spoken.into_iter().fold(bounds, union));
        if let Some([min, max]) = scene.work {
            let bounds = with_spoken(Rect { min, max });
            return Some(Self { is_named: true, ..Self::around(bounds) });
        }
        // What lies beyond the picture cannot be shown: its border is no place of work.
        let seen = |mark: &Mark| bounds_at_work(mark).filter(|bounds| whole.meets(bounds));
        let own: Vec<&Mark> = marks().filter(|mark| !has_twin(mark, scene) && seen(mark).is_some()).collect();
        let bounds = match own.is_empty() {
            false => own.iter().filter_map(|mark| seen(mark)).reduce(union),
            true => marks().filter_map(seen).reduce(union),
        };
        let bounds = local::tested_part(scene).or(bounds);
        let has_window = marks().any(|mark| mark.role == Role::Window && bounds_at_work(mark).is_some());
        let is_object = !has_window && marks().any(is_state);
        // The frame of a tracked object is one among those of others, but belongs to its state.
        let frames = || marks().filter(|mark| is_object && matches!(mark.shape, Shape::Rect { .. })).filter_map(seen);
        let bounds = bounds.map(|own| frames().filter(|frame| frame.contains(own.center())).fold(own, union));
        let is_example = !own.is_empty() && are_examples(&own, scene, picture);
        let bounds = bounds.or(scene.is_overview.then_some(whole))?;
        let needed = local::untested_block(scene).unwrap_or(bounds);
        let is_map = |mark: &Mark| match &mark.shape {
            Shape::Heat { values, .. } => values.size() == size,
            Shape::Mask(_) | Shape::Labels(_) => true,
            // A window over a field says for which pixel it is solved; without one all pixels are relaxed together.
            Shape::Flow { .. } => !has_window,
            // Frames of results are what all of the picture amounts to.
            Shape::Rect { .. } => mark.role == Role::Result,
            _ => false,
        };
        Some(Self {
            bounds: with_spoken(bounds),
            needed: with_spoken(needed),
            is_picture_wide: scene.is_overview || marks().any(is_map) || is_example,
            is_of_many: own.is_empty() && !scene.is_overview,
            is_object,
            is_named: false,
        })
    }

    /// Work within `bounds` and all of it needed, on nothing that is particular.
    fn around(bounds: Rect) -> Self {
        let (is_picture_wide, is_of_many, is_object, is_named) = (false, false, false, false);
        Self { bounds, needed: bounds, is_picture_wide, is_of_many, is_object, is_named }
    }

    /// The part of a picture, one in so many, from which on it is large.
    fn large(&self) -> f32 {
        if self.is_named { LARGE_NAMED } else { LARGE }
    }

    /// Its longer side in px.
    pub fn side(&self) -> f32 {
        let [width, height] = self.bounds.size();
        width.max(height)
    }

    /// The largest magnification at which it is seen with some room around it where `room` px are seen unmagnified.
    fn times(&self, room: [f32; 2]) -> f32 {
        match self.is_object {
            true => times(self.bounds.grown(OBJECT_MARGIN * self.side()), room).min(OBJECT_MOST),
            false => times(self.bounds, room),
        }
    }
}

/// The largest magnification at which `bounds` are seen with some room around them where `room` px are seen unmagnified.
fn times(bounds: Rect, room: [f32; 2]) -> f32 {
    let size = bounds.size();
    let fits = |times: &f32| {
        (0..2).all(|i| (size[i] * (1.0 + 2.0 * MARGIN.0) + 2.0 * MARGIN.1).max(LEAST_SIDE) * times <= room[i])
    };
    STEPS.into_iter().rev().find(fits).unwrap_or(1.0)
}

/// The bounds of the single marks that the sentence of the step speaks of, whatever their role; of several of a role none is meant.
fn spoken_of(scene: &Scene) -> Option<Rect> {
    let single = |role: &Role| {
        let mut marks =
            scene.marks.iter().filter(|mark| mark.role == *role && mark.on.is_aligned_with(Picture::CURRENT));
        let mark = marks.next().filter(|_| marks.next().is_none())?;
        let is_one = match &mark.shape {
            Shape::Rect { .. } | Shape::Ellipse { .. } => true,
            Shape::Points(points) => points.len() == 1,
            Shape::Arrows(arrows) => arrows.len() == 1,
            _ => false,
        };
        bounds_of(mark).filter(|_| is_one)
    };
    scene.spoken.iter().filter_map(single).reduce(union)
}

/// Whether `scene` has another frame or ellipse of the same role on the same picture.
fn has_twin(mark: &Mark, scene: &Scene) -> bool {
    let kind = |shape: &Shape| match shape {
        Shape::Rect { .. } => Some(0),
        Shape::Ellipse { .. } => Some(1),
        _ => None,
    };
    let is_alike = |other: &Mark| {
        let has_place = mark.role != Role::Window || mark.shape == other.shape;
        (other.on, other.role, kind(&other.shape)) == (mark.on, mark.role, kind(&mark.shape)) && has_place
    };
    kind(&mark.shape).is_some() && scene.marks.iter().filter(|other| is_alike(other)).nth(1).is_some()
}

/// Whether a mark is the state of a tracked object with its covariance, or its measurement.
fn is_state(mark: &Mark) -> bool {
    match mark.shape {
        Shape::Ellipse { .. } => matches!(mark.role, Role::Predicted | Role::Estimate),
        Shape::Points(_) => mark.role == Role::Measured,
        _ => false,
    }
}

/// The bounds of a mark, if it belongs to the work of a step: results, truth, trails and layers do not.
fn bounds_at_work(mark: &Mark) -> Option<Rect> {
    let is_result = matches!(mark.role, Role::Result | Role::Truth | Role::Error);
    if is_result { None } else { bounds_of(mark) }
}

/// The bounds of a mark that lies at few places.
fn bounds_of(mark: &Mark) -> Option<Rect> {
    let bounds = match &mark.shape {
        Shape::Rect { min, max } => Some(Rect::between(*min, *max)),
        Shape::Ellipse { center, radii, angle_rad } => {
            let (sin, cos) = angle_rad.sin_cos();
            let half = [(radii[0] * cos).hypot(radii[1] * sin), (radii[0] * sin).hypot(radii[1] * cos)];
            Some(Rect { min: [0, 1].map(|i| center[i] - half[i]), max: [0, 1].map(|i| center[i] + half[i]) })
        }
        Shape::Path { points, closed: true } if mark.role != Role::Window => around(points.iter().copied()),
        Shape::Points(points) if points.len() <= FEW => around(points.iter().copied()),
        Shape::Arrows(arrows) if arrows.len() <= FEW => around(arrows.iter().flat_map(|a| [a.from, a.to])),
        _ => None,
    };
    bounds.filter(|_| mark.shape.is_finite())
}

/// Whether the marks at work are single points among lines all over a picture of `size` px: such a point, as an epipole or the
/// keypoint of one of many matches, is an example, and no place of work.
fn are_examples(own: &[&Mark], scene: &Scene, size: [f32; 2]) -> bool {
    let links = scene.links.iter().filter_map(|link| around(link.ends.iter().map(|(_, at)| *at)));
    let lines = scene.marks.iter().filter_map(|mark| match &mark.shape {
        // A path of more points is a trail.
        Shape::Path { points, closed } if *closed || points.len() == 2 => around(points.iter().copied()),
        _ => None,
    });
    let is_all_over = |bounds: Option<Rect>| {
        let size_of = bounds.map(|bounds| bounds.size());
        size_of.is_some_and(|[width, height]| width.max(height).powi(2) >= size[0] * size[1] / LARGE)
    };
    let (has_links, has_lines) = (is_all_over(links.reduce(union)), is_all_over(lines.reduce(union)));
    own.iter().all(|mark| match mark.shape {
        Shape::Points(_) => has_links || has_lines,
        Shape::Ellipse { radii, .. } => has_links && radii[0].max(radii[1]) <= SPOT,
        _ => false,
    })
}

fn around(points: impl Iterator<Item = [f32; 2]>) -> Option<Rect> {
    points.map(|point| Rect { min: point, max: point }).reduce(union)
}

fn union(a: Rect, b: Rect) -> Rect {
    Rect { min: [0, 1].map(|i| a.min[i].min(b.min[i])), max: [0, 1].map(|i| a.max[i].max(b.max[i])) }
}

/// A part of a picture that is shown magnified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloseUp {
    /// The point in its middle, in image pixels.
    pub center: [f32; 2],
    /// How many times as large as in the whole picture it is shown.
    pub times: f32,
}

impl CloseUp {
    /// The close-ups of several pictures beside each other, all magnified alike; `None` where the whole is shown.
    ///
    /// `room` is how many px of the picture of `size` px are seen unmagnified: as many as it has, or more. `before` holds those of the
    /// step before, which stay as they are while they serve.
    pub fn of(mode: FocusMode, works: &[Option<Work>], at: Site<'_>) -> Vec<Option<Self>> {
        let Site { size, room, at_end, before, is_same_unit } = at;
        let picture = [size.0 as f32, size.1 as f32];
        let known: Vec<&Work> = works.iter().flatten().collect();
        let whole = || vec![None; works.len()];
        let Some(all) = known.iter().map(|work| work.bounds).reduce(union) else { return whole() };
        if known.iter().all(|work| work.is_of_many) && mode != FocusMode::Off && !at_end && before.len() == works.len()
        {
            // What was looked at goes on in a moment.
            return before.to_vec();
        }
        if known.iter().any(|work| !mode.wants(work, picture, at_end)) {
            return whole();
        }
        let least = known.iter().map(|work| work.times(room)).fold(f32::INFINITY, f32::min);
        // Pictures of one and the same block are looked at in one and the same place.
        let needed = known.iter().map(|work| work.needed).reduce(union).unwrap_or(all);
        let together = Work { needed, ..Work::around(all) };
        let is_shared = times(all, room) >= least;
        let kept = before.iter().flatten().next().map(|one| one.times);
        let most = known.iter().map(|work| times(work.needed, room)).fold(f32::INFINITY, f32::min);
        let slack = if known.iter().any(|work| work.is_object) { SLACK.1 } else { SLACK.0 };
        // Within a unit the visible part only grows.
        let may_stay = |kept: &f32| *kept <= most && (is_same_unit || slack * kept > least);
        let times = kept.filter(may_stay).unwrap_or(least);
        if times <= 1.0 {
            return whole();
        }
        let close_up = |(i, work): (usize, &Option<Work>)| {
            let work = if is_shared { &together } else { work.as_ref().unwrap_or(&together) };
            let fresh = Self { center: within(work.bounds.center(), times, picture, room), times };
            let before = before.get(i).copied().flatten().filter(|old| old.times == times);
            Some(before.filter(|old| old.serves(work, &fresh, room)).unwrap_or(fresh))
        };
        works.iter().enumerate().map(close_up).collect()
    }

    /// The close-up that shows `section` of a picture of `size` px and no more, and width and height of its pane in px of the picture
    /// unmagnified: along one side as many as the picture has, along the other no more. What lies beyond the picture belongs to no
    /// section. `None` where it is the whole picture.
    pub fn of_section(section: Rect, size: (usize, usize)) -> Option<(Self, [f32; 2])> {
        let picture = [size.0 as f32, size.1 as f32];
        let inside = |c: f32, i: usize| c.clamp(-0.5, picture[i] - 0.5);
        let min = [0, 1].map(|i| inside(section.min[i], i));
        let section = Rect { min, max: [0, 1].map(|i| inside(section.max[i], i)) };
        let extent = section.size().map(|side| side.max(LEAST_SECTION));
        let times = (picture[0] / extent[0]).min(picture[1] / extent[1]);
        let pane = extent.map(|side| (side * times).round());
        // A hair's breadth less is the rounding of the whole.
        let is_part = (0..2).any(|i| 1.001 * extent[i] < picture[i]);
        is_part.then(|| (Self { center: within(section.center(), times, picture, pane), times }, pane))
    }

    /// Whether it may stay: the work lies in it, and a `fresh` one would lie little further.
    fn serves(&self, work: &Work, fresh: &Self, room: [f32; 2]) -> bool {
        let seen = self.seen(room);
        (0..2).all(|i| {
            let off = (self.center[i] - fresh.center[i]).abs() * self.times / room[i];
            off < 0.08 && seen.min[i] <= work.needed.min[i] && work.needed.max[i] <= seen.max[i]
        })
    }

    /// What is seen of the picture, in image pixels.
    pub fn seen(&self, room: [f32; 2]) -> Rect {
        let half = room.map(|c| c / self.times / 2.0);
        Rect { min: [0, 1].map(|i| self.center[i] - half[i]), max: [0, 1].map(|i| self.center[i] + half[i]) }
    }
}

/// Where close-ups are shown.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// Width and height of the picture in px.
    pub size: (usize, usize),
    /// How many px are seen across and down where it is not magnified.
    pub room: [f32; 2],
    /// Whether the run is at its end.
    pub at_end: bool,
    /// The close-ups of the step before.
    pub before: &'a [Option<CloseUp>],
    /// Whether that step was of the same unit.
    pub is_same_unit: bool,
}

/// `center`, moved so that nothing beyond the picture is seen where the picture is larger than what is.
fn within(center: [f32; 2], times: f32, picture: [f32; 2], room: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|i| {
        let half = room[i] / times / 2.0;
        let (low, high) = (half - 0.5, picture[i] - 0.5 - half);
        if low <= high { center[i].clamp(low, high) } else { (picture[i] - 1.0) / 2.0 }
    })
}

/// Where the small map of the whole picture lies in `pane`: in a corner that is free of `work`, if one is; `None` where there is
/// no room for it.
pub fn map_rect(pane: Rect, picture: [f32; 2], work: Option<Rect>) -> Option<Rect> {
    let [width, height] = pane.size();
    let scale = (MAP_SHARE * width / picture[0]).min(MAP_SHARE * height / picture[1]);
    let scale = scale.min(LARGEST_MAP / picture[0].max(picture[1]));
    let size = picture.map(|c| (c * scale).round());
    if size[0].max(size[1]) < LEAST_MAP || size[0].min(size[1]) < 8.0 {
        return None;
    }
    let (right, bottom) = (pane.max[0] - MAP_GAP - size[0], pane.max[1] - MAP_GAP - size[1]);
    let (left, top) = (pane.min[0] + MAP_GAP, pane.min[1] + MAP_GAP);
    let corners = [[right, bottom], [left, bottom], [right, top], [left, top]].map(|min| Rect::new(min, size));
    let is_free = |rect: &Rect| work.is_none_or(|work| !rect.grown(MAP_GAP).meets(&work));
    corners.into_iter().find(is_free).or(Some(corners[0]))
}

/// Most of a pane's width and height that its map takes.
const MAP_SHARE: f32 = 0.24;
/// Longer side of a map in points, at most and at least.
const LARGEST_MAP: f32 = 200.0;
const LEAST_MAP: f32 = 28.0;
/// Between a map and the edges of its pane, in points.
const MAP_GAP: f32 = 6.0;

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::geometry::Grid;
    use motionscope_core::scene::{Arrow, Link};

    const SIZE: (usize, usize) = (320, 240);
    const ROOM: [f32; 2] = [320.0, 240.0];

    fn search(x: i32, y: i32) -> Scene {
        let mut scene = Scene::default();
        let far = Arrow { from: [300.0, 200.0], to: [310.0, 210.0] };
        scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(vec![far; 3]));
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x, y, 16, 16));
        scene.mark(Picture::NEXT, Role::Window, Shape::pixels(x - 16, y - 16, 48, 48));
        scene.mark(Picture::NEXT, Role::Candidate, Shape::pixels(x - 3, y + 5, 16, 16));
        scene
    }

    fn of(mode: FocusMode, scenes: &[Scene], before: &[Option<CloseUp>]) -> Vec<Option<CloseUp>> {
        let works: Vec<_> = scenes.iter().map(|scene| Work::of(scene, SIZE)).collect();
        CloseUp::of(mode, &works, Site { size: SIZE, room: ROOM, at_end: false, before, is_same_unit: false })
    }

    fn one(mode: FocusMode, scene: &Scene) -> Option<CloseUp> {
        of(mode, std::slice::from_ref(scene), &[])[0]
    }

    #[test]
    fn a_small_search_is_magnified_and_all_of_it_is_seen() {
        let scene = search(100, 80);
        let close = one(FocusMode::Auto, &scene).unwrap();
        assert_eq!(close, CloseUp { center: [107.5, 87.5], times: 3.0 });
        let (seen, work) = (close.seen(ROOM), Work::of(&scene, SIZE).unwrap());
        assert_eq!(work.bounds, Rect::new([83.5, 63.5], [48.0, 48.0]), "results elsewhere are no work");
        assert!((0..2).all(|i| seen.min[i] < work.bounds.min[i] && work.bounds.max[i] < seen.max[i]));
        assert_eq!(one(FocusMode::Off, &scene), None);
        let corner = one(FocusMode::Auto, &search(0, 0)).unwrap().seen(ROOM);
        assert_eq!(corner.min, [-0.5; 2], "nothing beyond the picture is shown");
    }

    #[test]
    fn a_single_mark_that_the_sentence_speaks_of_stays_in_sight() {
        let mut scene = search(100, 80);
        let outlier = [170.0, 90.0];
        scene.mark(Picture::NEXT, Role::Error, Shape::Points(vec![outlier]));
        let is_seen =
            |scene: &Scene| one(FocusMode::Auto, scene).is_none_or(|close| close.seen(ROOM).contains(outlier));
        assert!(!is_seen(&scene), "the sentence does not mention it");
        // There are three arrows of the other role: none of them is meant.
        scene.spoken = vec![Role::Error, Role::Result];
        let close = one(FocusMode::Auto, &scene).expect("still a part of the picture");
        assert!(is_seen(&scene) && close.times < 3.0, "{close:?}");
        scene.mark(Picture::NEXT, Role::Error, Shape::Points(vec![[10.0, 10.0]]));
        assert!(!is_seen(&scene), "of several none is meant");
        scene.spoken = vec![Role::Truth];
        scene.mark(Picture::NEXT, Role::Truth, Shape::Points(vec![[310.0, 10.0]]));
        assert_eq!(one(FocusMode::Auto, &scene), None, "it is far away: the whole picture");
    }

    #[test]
    fn work_that_a_scene_names_may_be_larger() {
        let bounds = Rect::new([90.0, 70.0], [120.0, 90.0]);
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Reference, Shape::Rect { min: bounds.min, max: bounds.max });
        assert_eq!(one(FocusMode::Auto, &scene), None);
        scene.work = Some([bounds.min, bounds.max]);
        assert_eq!(one(FocusMode::Auto, &scene).unwrap().times, 2.0);
        scene.work = Some([[60.0, 40.0], [210.0, 160.0]]);
        assert_eq!(one(FocusMode::Auto, &scene), None);
    }

    #[test]
    fn candidates_move_nothing_and_blocks_keep_the_magnification() {
        let mut scene = search(100, 80);
        let first = one(FocusMode::Auto, &scene);
        scene.mark(Picture::NEXT, Role::Candidate, Shape::pixels(110, 90, 16, 16));
        assert_eq!(one(FocusMode::Auto, &scene), first);
        let before = [first];
        for x in (0..300).step_by(16) {
            let close = of(FocusMode::Auto, &[search(x, 80)], &before)[0].unwrap();
            assert_eq!(close.times, 3.0, "block at {x}");
        }
        let same = of(FocusMode::Auto, &[search(102, 80)], &before)[0];
        assert_eq!(same, first, "2 px are no reason to move");
    }

    #[test]
    fn a_fast_search_is_seen_more_closely_and_the_next_block_as_closely() {
        let mut scene = search(100, 80);
        let tested = |x: usize, y: usize| (x, y) == (16, 16) || (x, y) == (16, 14);
        let values = Grid::from_fn(33, 33, |x, y| if tested(x, y) { 7.0 } else { f32::NAN });
        scene.mark(Picture::NEXT, Role::Candidate, Shape::Heat { origin: [91.5, 71.5], values });
        let mut start = search(116, 80);
        start.marks.truncate(3);
        let close = of(FocusMode::Auto, std::slice::from_ref(&scene), &[]);
        assert_eq!(close[0].map(|close| close.times), Some(4.0));
        assert_eq!(one(FocusMode::Auto, &start).map(|close| close.times), Some(3.0), "the window");
        let works = [Work::of(&scene, SIZE)];
        let before = [Some(CloseUp { center: [107.5, 87.5], times: 1.5 })];
        let site = Site { size: SIZE, room: ROOM, at_end: false, before: &before, is_same_unit: true };
        let within = CloseUp::of(FocusMode::Auto, &works, site)[0];
        assert_eq!(within.map(|close| close.times), Some(1.5), "within a block the visible part only grows");
        let next = of(FocusMode::Auto, &[start], &close)[0];
        assert_eq!(next.map(|close| close.times), Some(4.0), "the view does not go back for a window");
    }

    #[test]
    fn large_work_and_maps_of_all_pixels_are_shown_whole_unless_focus_is_on() {
        let mut large = Scene::default();
        large.mark(Picture::CURRENT, Role::Window, Shape::pixels(0, 40, 320, 1));
        assert_eq!(one(FocusMode::Auto, &large), None, "a row is as long as the picture is wide");
        let mut relaxed = Scene::default();
        relaxed.mark(
            Picture::CURRENT,
            Role::Result,
            Shape::Flow { origin: [0.0; 2], values: Grid::new(320, 240, [1.0; 2]) },
        );
        assert_eq!(one(FocusMode::On, &relaxed), None, "no mark is at work");
        relaxed.mark(Picture::CURRENT, Role::Reference, Shape::pixels(50, 60, 1, 1));
        assert_eq!(one(FocusMode::Auto, &relaxed), None, "all pixels are relaxed, this is an example");
        assert!(one(FocusMode::On, &relaxed).is_some_and(|close| close.times >= 8.0));
        relaxed.mark(Picture::CURRENT, Role::Window, Shape::pixels(46, 56, 9, 9));
        assert!(one(FocusMode::Auto, &relaxed).is_some(), "a window is solved by itself");
    }

    #[test]
    fn the_pixels_that_a_step_names_are_magnified_whatever_else_is_drawn() {
        let mut scene = Scene::default();
        let values = Grid::new(320, 240, 1.0);
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
        scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(0, 40, 320, 1));
        assert_eq!(one(FocusMode::Auto, &scene), None, "a row and a map of all pixels");
        scene.work = Some([[196.5, 36.5], [203.5, 43.5]]);
        let close = one(FocusMode::Auto, &scene).unwrap();
        assert!(close.center == [200.0, 40.0] && close.times >= 8.0, "{close:?}");
    }

    #[test]
    fn a_point_among_lines_all_over_the_picture_is_no_place_of_work() {
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Best, Shape::Points(vec![[200.0, 90.0]]));
        assert!(one(FocusMode::Auto, &scene).is_some(), "alone it is");
        let line = |x: f32| Shape::Path { points: vec![[x, 0.0], [200.0, 239.0]], closed: false };
        let mut lines = scene.clone();
        lines.mark(Picture::CURRENT, Role::Predicted, line(10.0));
        assert_eq!(one(FocusMode::Auto, &lines), None, "epipolar lines");
        assert!(one(FocusMode::On, &lines).is_some());
        let mut links = scene.clone();
        let link =
            |y: f32| Link { role: Role::Result, ends: [(Picture::CURRENT, [9.0, y]), (Picture::NEXT, [12.0, y])] };
        links.links = vec![link(20.0), link(220.0)];
        assert_eq!(one(FocusMode::Auto, &links), None, "matches");
        let ellipse = Shape::Ellipse { center: [200.0, 90.0], radii: [4.0; 2], angle_rad: 0.0 };
        links.mark(Picture::CURRENT, Role::Measured, ellipse);
        assert_eq!(one(FocusMode::Auto, &links), None, "the keypoint of one of the matches");
        let mut described = links.clone();
        let neighborhood = Shape::Ellipse { center: [200.0, 90.0], radii: [9.6; 2], angle_rad: 0.0 };
        described.mark(Picture::CURRENT, Role::Reference, neighborhood);
        assert!(one(FocusMode::Auto, &described).is_some(), "the neighbourhood of a descriptor");
        links.mark(Picture::CURRENT, Role::Window, Shape::pixels(192, 82, 16, 16));
        assert!(one(FocusMode::Auto, &links).is_some(), "a window is solved by itself");
        let trail = vec![[10.0, 10.0], [90.0, 40.0], [200.0, 90.0]];
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Path { points: trail, closed: false });
        assert!(one(FocusMode::Auto, &scene).is_some(), "a point and its trail");
    }

    #[test]
    fn a_point_beyond_the_picture_is_not_looked_for_at_its_border() {
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Points(vec![[520.0, 90.0]]));
        for mode in [FocusMode::Auto, FocusMode::On] {
            assert_eq!(one(mode, &scene), None);
        }
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(-4, 80, 16, 16));
        let work = Work::of(&scene, SIZE).unwrap();
        assert_eq!(work.bounds, Rect { min: [-0.5, 79.5], max: [11.5, 95.5] }, "a block at the border is at work");
    }

    #[test]
    fn the_end_is_shown_whole() {
        let works = [Work::of(&search(100, 80), SIZE)];
        let site = Site { size: SIZE, room: ROOM, at_end: true, before: &[], is_same_unit: false };
        assert_eq!(CloseUp::of(FocusMode::Auto, &works, site), [None]);
    }

    #[test]
    fn an_ellipse_is_bounded_whatever_its_angle() {
        let mut scene = Scene::default();
        let shape =
            Shape::Ellipse { center: [100.0, 90.0], radii: [20.0, 4.0], angle_rad: std::f32::consts::FRAC_PI_2 };
        scene.mark(Picture::CURRENT, Role::Predicted, shape);
        let bounds = Work::of(&scene, SIZE).unwrap().bounds;
        let off = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        assert!(off(bounds.min, [96.0, 70.0]) < 1e-3 && off(bounds.max, [104.0, 110.0]) < 1e-3, "{bounds:?}");
    }

    #[test]
    fn of_many_detections_none_is_the_work_and_an_ellipse_is() {
        let mut scene = Scene::default();
        for x in [40, 220] {
            scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x, 60, 50, 50));
        }
        assert_eq!(one(FocusMode::Auto, &scene), None, "they lie all over the picture");
        let before = [Some(CloseUp { center: [60.0, 80.0], times: 4.0 })];
        assert_eq!(of(FocusMode::Auto, std::slice::from_ref(&scene), &before), before, "the view stays where it was");
        let at = |x: f32| Shape::Ellipse { center: [x, 85.0], radii: [4.0, 3.0], angle_rad: 0.0 };
        let mut inside = scene.clone();
        inside.mark(Picture::CURRENT, Role::Predicted, at(65.0));
        let work = Work::of(&inside, SIZE).unwrap();
        assert_eq!(
            work.bounds,
            Rect { min: [39.5, 59.5], max: [89.5, 109.5] },
            "the frame of the object belongs to it"
        );
        assert_eq!(one(FocusMode::Auto, &inside), None, "six of its sizes take the whole picture");
        scene.mark(Picture::CURRENT, Role::Predicted, at(150.0));
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Points(vec![[154.0, 88.0]]));
        let close = one(FocusMode::Auto, &scene).unwrap();
        assert!((3.0..=OBJECT_MOST).contains(&close.times) && (145.0..155.0).contains(&close.center[0]), "{close:?}");
        let work = Work::of(&scene, SIZE).unwrap();
        let seen = close.seen(ROOM).size();
        assert!(seen.iter().all(|extent| *extent >= 6.0 * work.side()), "{seen:?} of {:?}", work.bounds);
        let small = [Some(CloseUp { times: 2.0, ..close })];
        let kept = of(FocusMode::Auto, std::slice::from_ref(&scene), &small)[0];
        assert_eq!(kept.map(|close| close.times), Some(2.0), "from frame to frame it stays while it serves");
    }

    #[test]
    fn a_step_that_sums_up_the_picture_shows_all_of_it() {
        let mut scene = search(100, 80);
        let close = [one(FocusMode::Auto, &scene)];
        scene.is_overview = true;
        assert!(close[0].is_some() && of(FocusMode::Auto, std::slice::from_ref(&scene), &close) == [None]);
        // Beside another one the view stays on the whole picture, whether or not marks are at work.
        let empty = Scene { is_overview: true, ..Scene::default() };
        for overview in [scene, empty] {
            assert_eq!(of(FocusMode::Auto, &[search(100, 80), overview], &[]), [None, None]);
        }
    }

    #[test]
    fn several_are_magnified_alike() {
        let close = of(FocusMode::Auto, &[search(100, 80), search(100, 80)], &[]);
        assert!(close[0].is_some() && close[0] == close[1]);
        let apart = of(FocusMode::Auto, &[search(32, 32), search(240, 160)], &[]);
        let [Some(a), Some(b)] = apart[..] else { panic!("{apart:?}") };
        assert!(a.times == b.times && a.center != b.center);
    }

    #[test]
    fn a_section_is_seen_exactly_whatever_its_shape() {
        let seen = |section: Rect| {
            let (close, pane) = CloseUp::of_section(section, SIZE).unwrap();
            assert!(pane.iter().zip(ROOM).all(|(side, most)| (1.0..=most).contains(side)), "{pane:?}");
            close.seen(pane)
        };
        let off = |a: Rect, b: Rect| (0..2).map(move |i| (a.min[i] - b.min[i]).abs().max((a.max[i] - b.max[i]).abs()));
        let sizes = [[40.0, 80.0], [23.0, 21.0], [26.7, 20.0], [260.0, 33.3], [320.0, 100.0], [100.0, 240.0]];
        for section in sizes.map(|size| Rect::centered([159.5, 119.5], size)) {
            let seen = seen(section);
            assert!(off(seen, section).fold(0.0, f32::max) <= 0.5, "{seen:?} in place of {section:?}");
        }
        let corner = seen(Rect::centered([-0.5; 2], [80.0, 60.0]));
        assert!(off(corner, Rect::new([-0.5; 2], [40.0, 30.0])).fold(0.0, f32::max) < 1e-3, "{corner:?}");
        for whole in [Rect::centered([160.0, 120.0], [900.0; 2]), Rect::new([-0.5; 2], ROOM)] {
            assert_eq!(CloseUp::of_section(whole, SIZE), None);
        }
        let outside = seen(Rect::centered([1e5; 2], [9.0; 2]));
        assert!(outside.size()[0].is_finite() && outside.max[0] <= 319.5 + 1e-3, "{outside:?}");
    }

    #[test]
    fn a_map_lies_in_a_corner_that_is_free() {
        let pane = Rect::new([10.0, 20.0], [640.0, 480.0]);
        let corner = map_rect(pane, ROOM, None).unwrap();
        assert!(corner.max[0] < pane.max[0] && corner.max[1] < pane.max[1] && corner.min[0] > 400.0);
        let other = map_rect(pane, ROOM, Some(corner)).unwrap();
        assert!(!other.meets(&corner));
        assert_eq!(map_rect(Rect::new([0.0; 2], [60.0, 45.0]), ROOM, None), None, "a stamp has no room for one");
    }
}
