//! The first step shown of a run: at the block or pixel with the most motion, not in the first corner of the picture.

use motionscope_core::data::{Clip, Flow, Frame};
use motionscope_core::run::{Cursor, Explained, ROW, Walk};
use motionscope_core::scene::Focus;

/// Side of the windows that are compared, in px.
const WINDOW: usize = 16;
/// Distance of their centres, in px.
const STEP: usize = 8;
/// Least distance of a centre from the border, in px: nearer, a search window is cut off.
const MARGIN: usize = 24;
/// Share of the largest true motion that counts as large.
const LARGE: f32 = 0.5;

/// The step with which a run on `frame` of `clip` opens: in the first pass over the picture, the one at the pixel of most interest.
/// `None` where the run has no such pass, or nothing moves.
pub fn opening(walk: &dyn Walk, clip: &Clip, frame: usize) -> Option<Cursor> {
    let pass = walk.place().last()?.of?;
    first_step(walk, Focus::current(pixel(clip, frame)?)).filter(|cursor| cursor.unit < pass)
}

/// Where a run stands before the first step at the pixel `focus`; `None` where no step is at one pixel or block.
pub fn first_step(walk: &dyn Walk, focus: Focus) -> Option<Cursor> {
    let is_row = walk.info().granularities.iter().rev().nth(1) == Some(&ROW);
    match walk.explained(focus) {
        // The next step is then the one at this pixel.
        Some(Explained::From(turn)) if is_row => Some(Cursor { event: turn.event.saturating_sub(1), ..turn }),
        Some(Explained::Always) => None,
        _ => Some(Cursor { unit: walk.unit_at(focus)?, event: 0 }),
    }
}

/// The centre of the window of frame t with the largest change to frame t + 1, where the truth is known among those that move far;
/// `None` if nothing changes, or the frames cannot be read.
fn pixel(clip: &Clip, t: usize) -> Option<[f32; 2]> {
    let pair = clip.pair(t).ok()?;
    let truth = clip.truth().and_then(|truth| truth.flow(t).ok().flatten());
    let (width, height) = pair[0].size();
    let centers = |side: usize| (MARGIN.min(side / 3)..side.saturating_sub(MARGIN.min(side / 3))).step_by(STEP);
    let all = || centers(height).flat_map(|y| centers(width).map(move |x| (x, y)));
    let speed = |flow: &Flow, (x, y)| flow.at(x, y).map_or(0.0, |[u, v]| u.hypot(v));
    let least = truth.as_ref().map(|flow| LARGE * all().map(|at| speed(flow, at)).fold(0.0, f32::max));
    let moves = |at| match (&truth, least) {
        (Some(flow), Some(least)) => speed(flow, at) >= least,
        _ => true,
    };
    // Of equal ones the first is taken.
    let (_, (x, y)) =
        all().filter(|at| moves(*at)).map(|at| (change(&pair, at), at)).rev().max_by_key(|(sum, _)| *sum)?;
    (change(&pair, (x, y)) > 0).then_some([x as f32, y as f32])
}

/// The sum of the absolute differences of two frames in the window around a pixel, in gray levels.
fn change(pair: &[std::sync::Arc<Frame>; 2], (x, y): (usize, usize)) -> u32 {
    let [first, second] = pair.each_ref().map(|frame| frame.luma());
    let around = |at: usize, end: usize| at.saturating_sub(WINDOW / 2)..(at + WINDOW / 2).min(end);
    let (width, height) = pair[0].size();
    let pixels = around(y, height).flat_map(|y| around(x, width).map(move |x| (x, y)));
    pixels.map(|at| u32::from(first[at].abs_diff(second[at]))).sum()
}

#[cfg(test)]
mod tests {
    use motionscope_core::course::estimator;
    use motionscope_core::synth::{self, Difficulty};

    use super::*;

    fn opened(id: &str, scene: &str) -> Option<Cursor> {
        let clip = synth::make(scene, &Difficulty::default()).expect("a scene");
        let walk = estimator(id).expect("an estimator").walk(&clip, 0).expect("a run");
        opening(&*walk, &clip, 0)
    }

    #[test]
    fn a_run_opens_at_a_block_that_moves_far() {
        let clip = synth::make("pillar", &Difficulty::default()).expect("a scene");
        let flow = clip.truth().expect("truth").flow(0).expect("readable").expect("known");
        let speed = |at: &[f32; 2]| flow.at(at[0] as usize, at[1] as usize).map_or(0.0, |[u, v]| u.hypot(v));
        let at = pixel(&clip, 0).expect("something moves");
        let most =
            flow.0.cells().iter().map(|[u, v]| u.hypot(*v)).filter(|speed| speed.is_finite()).fold(0.0, f32::max);
        assert!(speed(&at) >= LARGE * most && most > 1.0, "{at:?}: {} of {most}", speed(&at));
        let cursor = opened("full-search", "pillar").expect("a block");
        assert!(cursor.unit > 0 && cursor.event == 0, "{cursor:?}");
    }

    #[test]
    fn the_next_step_of_a_pass_over_pixels_is_the_one_of_most_interest() {
        let clip = synth::make("pillar", &Difficulty::default()).expect("a scene");
        let at = pixel(&clip, 0).expect("something moves");
        let cursor = opened("lucas-kanade", "pillar").expect("a pixel");
        assert_eq!([cursor.event as f32, cursor.unit as f32], at);
    }

    #[test]
    fn what_has_no_pass_over_the_picture_opens_at_its_start() {
        for id in ["kalman-filter", "horn-schunck", "running-average", "phase-correlation"] {
            assert_eq!(opened(id, "pillar"), None, "{id}");
        }
    }
}
