//! Compares a mask with the true pixels of its object: its pixels outside the object, and those of the object that it misses.

use super::ending::FAIR;
use super::vocabulary::{case, value};
use crate::base::Error;
use crate::data::{Clip, Mask, PixelClass};
use crate::geometry::{Bounds, Grid};
use crate::products::MaskField;
use crate::products::region::RegionError;
use crate::scene::Step;

/// The pixels of a mask in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Content {
    /// Pixels of the mask, and those of them that are the object.
    inside: usize,
    own: usize,
    /// Visible pixels of the object.
    object: usize,
    /// Mean gray levels of the object, and of the other pixels of the mask.
    means: [f32; 2],
}

impl Content {
    fn of(mask: &Mask, is_object: impl Fn(usize, usize) -> bool, luma: &Grid<u8>) -> Self {
        let (mut content, mut sums, mut foreign) = (Self::default(), [0.0f64; 2], 0usize);
        for (x, y) in (0..luma.height()).flat_map(|y| (0..luma.width()).map(move |x| (x, y))) {
            let (is_inside, is_object) = (mask.get(x, y), is_object(x, y));
            content.inside += usize::from(is_inside);
            content.own += usize::from(is_inside && is_object);
            content.object += usize::from(is_object);
            foreign += usize::from(is_inside && !is_object);
            let sum = match (is_inside, is_object) {
                (_, true) => &mut sums[0],
                (true, false) => &mut sums[1],
                (false, false) => continue,
            };
            *sum += f64::from(luma[(x, y)]);
        }
        let mean = |sum: f64, count: usize| (sum / count.max(1) as f64) as f32;
        Self { means: [mean(sums[0], content.object), mean(sums[1], foreign)], ..content }
    }

    /// Tells the shares of the mask and of the object.
    fn tell(&self, step: Step, frame: usize) -> Step {
        if self.inside == 0 || self.object == 0 {
            return step;
        }
        let percent = |part: usize, all: usize| 100.0 * part as f64 / all as f64;
        let foreign = self.inside - self.own;
        let step = step.put(value::FRAME_OFF, frame).put(value::FOREIGN, percent(foreign, self.inside));
        let step = step.put(value::OBJECT_LEVEL, self.means[0]).put(value::FOREIGN_LEVEL, self.means[1]);
        let step = step.put(value::LEFT_OUT, percent(self.object - self.own, self.object));
        step.say(if foreign == 0 { case::CONTOUR_SHRANK } else { case::CONTOUR_LEFT })
    }
}

/// Tells the pixels of the mask in the first frame in which it was no longer on the object; nothing where it stayed, or where the true
/// pixels are not known.
pub(super) fn tell(step: Step, clip: &Clip, masks: &MaskField, errors: &[RegionError]) -> Step {
    match first_off(clip, masks, errors) {
        Some((content, frame)) => content.tell(step, frame),
        None => step,
    }
}

/// The pixels of the mask in the first frame in which it was no longer on the object, and that frame.
fn first_off(clip: &Clip, masks: &MaskField, errors: &[RegionError]) -> Option<(Content, usize)> {
    let of_frame = |frame: usize| masks.frames.get(frame.checked_sub(masks.first)?)?.mask.as_ref();
    let left = errors.iter().filter(|error| error.overlap < FAIR);
    let (error, mask) = left.filter_map(|error| Some((error, of_frame(error.frame)?))).next()?;
    let pixels = object(clip, error.frame, error.truth).ok().flatten()?;
    let frame = clip.frame(error.frame).ok()?;
    let is_object = |x: usize, y: usize| pixels.get(x, y);
    Some((Content::of(&mask.unpacked(), is_object, frame.luma()), error.frame))
}

/// The visible pixels of the object with this true box: those of the foreground with the label that most of it has in the box.
fn object(clip: &Clip, frame: usize, Bounds { min, max }: Bounds) -> Result<Option<Mask>, Error> {
    let Some(truth) = clip.truth() else { return Ok(None) };
    let Some((labels, foreground)) = truth.segments(frame)?.zip(truth.foreground(frame)?) else { return Ok(None) };
    let is_foreground = |x: usize, y: usize| foreground.0[(x, y)] == PixelClass::Foreground;
    let within = |x: usize, y: usize| {
        let at = [x as f32, y as f32];
        (0..2).all(|i| (min[i]..=max[i]).contains(&at[i]))
    };
    let (width, height) = labels.size();
    let mut counts = std::collections::BTreeMap::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        if within(x, y) && is_foreground(x, y) {
            *counts.entry(labels[(x, y)]).or_insert(0usize) += 1;
        }
    }
    let most = counts.into_iter().max_by_key(|(_, count)| *count).map(|(label, _)| label);
    Ok(most.map(|label| Mask::from_fn(width, height, |x, y| labels[(x, y)] == label && is_foreground(x, y))))
}

#[cfg(test)]
mod tests {
    use super::super::line;
    use super::*;

    #[test]
    fn a_mask_is_divided_by_the_object() {
        let luma = Grid::from_fn(10, 4, |x, _| if x < 5 { 100 } else { 140 });
        // The mask reaches from column 2 to 6, the object from 0 to 3.
        let mask = Mask::from_fn(10, 4, |x, _| (2..7).contains(&x));
        let content = Content::of(&mask, |x, _| x < 4, &luma);
        assert_eq!(content, Content { inside: 20, own: 8, object: 16, means: [100.0, (100.0 + 2.0 * 140.0) / 3.0] });
        let said = |content: Content| content.tell(Step::at(line::MOVE), 3).sentence.plain();
        let left = said(content);
        assert!(
            left.contains("60.0 % of its inside is not the object") && left.contains("50.0 % of the object lies"),
            "{left}"
        );
        let within = said(Content::of(&mask, |x, _| x < 8, &luma));
        assert!(within.contains("shrank into the object in frame 3: 37.5 %"), "{within}");
        assert_eq!(said(Content::of(&Mask::new(10, 4), |x, _| x < 4, &luma)), "");
    }
}
