//! The region that is tracked: as placed, that of a true object, or the middle of the frame.

use super::vocabulary::case;
use crate::base::Error;
use crate::data::{Clip, ObjectBox};
use crate::geometry::Bounds;
use crate::params;
use crate::products::Region;
use crate::scene::{Question, Reply, Role};

params! {
    /// The parameters of all trackers of a region.
    pub struct Settings {
        /// Region of the object: a rectangle in the first frame. Without one it is the box of a true object that is wholly visible, where
        /// the truth is known, and else a square in the middle of the frame with a quarter of its shorter side.
        region: Option<Bounds> = None::<Bounds>;
        /// Maximum number of frames, the first included.
        frames: usize = 300, 2..=10_000;
        /// Restart from the true box 5 frames after the overlap with it fell to 0, as the VOT benchmark does: the number of failures is the
        /// robustness of the tracker. Without true boxes it has no effect.
        restart: bool = false;
    }
}

/// Names of the lines of pseudocode that all trackers of a region have.
pub(crate) mod line {
    crate::line_names!(CHOOSE, EACH_FRAME, MOVE);
}

/// The question of all trackers of a region: its place in the next frame.
pub(crate) const WHERE: Question =
    Question::place("where", "Where does the tracker place the region in the next frame?", line::MOVE, Role::Estimate)
        .after_first_unit();

/// The question of trackers with a criterion of loss.
pub(crate) const LOST: Question = Question::choice(
    "lost",
    "Does the tracker report that the object is lost?",
    &[
        Reply::told(line::MOVE, case::LOST, "Yes: its match is too poor"),
        Reply::told(line::MOVE, case::LAST_LOST, "Yes: its match is too poor"),
        Reply::at(line::MOVE, "No: the region moves"),
    ],
)
.after_first_unit();

/// The smallest side of a region in px.
const LEAST_PX: f32 = 4.0;
/// A region in the middle has this part of the shorter side of the frame.
const PART: usize = 4;
/// The least overlap of a placed region with the true object that it is on.
const LEAST_OVERLAP: f32 = 0.1;
/// A true object is wholly visible if this share of it is.
pub(super) const WHOLE: f32 = 0.99;

/// The source of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The parameter.
    Placed,
    /// The box of a true object.
    Truth,
    /// The middle of the frame.
    Middle,
}

/// The region of the first frame.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The region.
    pub region: Region,
    /// Its source.
    pub origin: Origin,
    /// The identity of the true object under it, where one is known.
    pub object: Option<u32>,
}

/// Returns the region to be tracked from frame `t` on: `zone` if that is placed.
///
/// # Errors
/// If less than 4×4 px of it are inside the picture, the picture is too small for a region, or the truth cannot be read.
pub(super) fn choose(zone: Option<Bounds>, clip: &Clip, t: usize) -> Result<Chosen, Error> {
    let objects = match clip.truth() {
        Some(truth) => truth.objects(t)?.unwrap_or_default(),
        None => Vec::new(),
    };
    if let Some(zone) = zone {
        let bounds = placed(zone, clip.size())?;
        let overlap = |object: &&ObjectBox| bounds.iou(&Bounds::from(*object));
        let nearest = objects.iter().max_by(|a, b| overlap(a).total_cmp(&overlap(b)).then(b.id.cmp(&a.id)));
        let object = nearest.filter(|object| overlap(object) >= LEAST_OVERLAP).map(|object| object.id);
        return Ok(Chosen { region: bounds.into(), origin: Origin::Placed, object });
    }
    let inside = |object: &ObjectBox| Some((object.id, within(Bounds::from(object), clip.size())?));
    let whole = objects.iter().filter(|object| object.visibility >= WHOLE).find_map(inside);
    if let Some((id, bounds)) = whole {
        return Ok(Chosen { region: bounds.into(), origin: Origin::Truth, object: Some(id) });
    }
    Ok(Chosen { region: middle(clip.size())?.into(), origin: Origin::Middle, object: None })
}

/// Frames from a failure to the restart (M. Kristan et al., A novel performance evaluation methodology for single-target trackers, IEEE
/// PAMI 38(11), 2016).
const PAUSE: usize = 5;

/// The state of a run with restarts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Restarts {
    /// The frame from which on the tracker may restart, while it waits.
    pub waits_until: Option<usize>,
    /// Number of restarts so far.
    pub count: usize,
}

impl Restarts {
    /// Whether the tracker fails with `region` in frame `t`: its box and that of the true object have nothing in common.
    ///
    /// # Errors
    /// If the truth cannot be read.
    pub fn fail(&mut self, region: &Region, object: Option<u32>, (clip, t): (&Clip, usize)) -> Result<bool, Error> {
        let is_apart =
            true_box(object, clip, t)?.is_some_and(|object| region.bounds().iou(&Bounds::from(&object)) == 0.0);
        if is_apart {
            self.waits_until = Some(t + PAUSE);
        }
        Ok(is_apart)
    }

    /// The region of a restart in frame `t`, if it is time for one and the object is wholly visible.
    ///
    /// # Errors
    /// If the truth cannot be read.
    pub fn region(&self, object: Option<u32>, (clip, t): (&Clip, usize)) -> Result<Option<Region>, Error> {
        if self.waits_until.is_none_or(|until| t < until) {
            return Ok(None);
        }
        let found = true_box(object, clip, t)?.filter(|object| object.visibility >= WHOLE);
        Ok(found.and_then(|object| within(Bounds::from(&object), clip.size())).map(Region::from))
    }
}

/// The true object in frame `t`.
fn true_box(id: Option<u32>, clip: &Clip, t: usize) -> Result<Option<ObjectBox>, Error> {
    let (Some(id), Some(truth)) = (id, clip.truth()) else { return Ok(None) };
    Ok(truth.objects(t)?.and_then(|objects| objects.into_iter().find(|object| object.id == id)))
}

/// The part of a rectangle inside a picture, if it is large enough.
fn within(bounds: Bounds, size: (usize, usize)) -> Option<Bounds> {
    let part = clipped(bounds, size);
    part.size().iter().all(|side| *side >= LEAST_PX).then_some(part)
}

fn clipped(Bounds { min, max }: Bounds, (width, height): (usize, usize)) -> Bounds {
    let end = [width, height].map(|extent| extent as f32 - 0.5);
    Bounds { min: min.map(|c| c.max(-0.5)), max: [0, 1].map(|i| max[i].min(end[i])) }
}

fn placed(zone: Bounds, size: (usize, usize)) -> Result<Bounds, Error> {
    within(zone, size).ok_or_else(|| {
        let [width, height] = clipped(zone, size).size().map(|side| side.max(0.0).round());
        Error::new(format!(
            "the region has {width}×{height} px inside the picture of {}×{} px, and needs at least {LEAST_PX} px a side; place it \
             anew, or set region to none",
            size.0, size.1
        ))
    })
}

/// The square in the middle of the frame.
fn middle((width, height): (usize, usize)) -> Result<Bounds, Error> {
    let side = (width.min(height) / PART) as f32;
    let side = side.max(LEAST_PX);
    let center = [width, height].map(|extent| (extent as f32 - 1.0) / 2.0);
    within(Bounds::around(center, [side; 2]), (width, height)).ok_or_else(|| {
        Error::new(format!(
            "the picture of {width}×{height} px is too small for a region, which has at least {LEAST_PX} px a side; open a larger one"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_is_the_part_inside_the_picture() {
        let zone = |min, max| Bounds { min, max };
        assert_eq!(placed(zone([-9.0, 2.0], [8.0, 99.0]), (20, 16)).expect("large enough").min, [-0.5, 2.0]);
        for (bounds, told) in [
            (zone([40.0, 2.0], [60.0, 9.0]), "0×7 px inside the picture of 20×16 px"),
            (zone([3.0, 2.0], [4.0, 3.0]), "1×1 px inside"),
        ] {
            let refusal = placed(bounds, (20, 16)).expect_err("too small").to_string();
            assert!(refusal.contains(told) && refusal.ends_with("set region to none"), "{refusal}");
        }
        assert_eq!(middle((80, 40)).expect("large enough").size(), [10.0; 2]);
        assert!(middle((3, 40)).expect_err("too small").to_string().contains("3×40"));
    }
}
