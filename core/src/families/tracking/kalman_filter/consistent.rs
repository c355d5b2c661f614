//! The blob that moves most consistently, to start a track with.

use super::{KalmanFilter, State};
use crate::base::Error;
use crate::data::{Clip, Detection};

/// The number of frames that are searched ahead, with hindsight (non-causal).
const AHEAD: usize = 40;
/// The least number of frames of a motion.
const LEAST_FRAMES: usize = 4;
/// The greatest displacement between frames, as a multiple of the longer side of a blob, and in px.
const REACH_SIDES: f64 = 3.0;
const REACH_PX: f64 = 24.0;
/// The most frames in a row in which a blob may be missing: it passes something of its own colour, or is small.
const MOST_MISSED: usize = 2;
/// The greatest change of a displacement, as a share of it, and in px.
const CHANGE: f64 = 0.35;
const CHANGE_PX: f64 = 3.0;
/// The uncertainty of a blob's position, as a share of its shorter side: contact with something else moves its centroid.
const BLUR_SIDES: f64 = 0.25;

/// A blob that moves: its frame, counted from the current one, its index there, and the length of its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ConsistentObject {
    pub frame: usize,
    pub index: usize,
    pub length_px: f64,
}

impl KalmanFilter {
    /// Returns the blob of the next frames that moves most consistently: over the greatest distance at a displacement that changes little.
    pub(super) fn most_consistent(
        &self,
        (clip, t): (&Clip, usize),
        state: &State,
    ) -> Result<Option<ConsistentObject>, Error> {
        let mut frames = Vec::new();
        for ahead in t..t + AHEAD {
            let is_over = match state.span.frames() {
                Some(count) => ahead >= state.span.first + count,
                None => !clip.has_frame(ahead)?,
            };
            if is_over {
                break;
            }
            match state.detector.look(clip, ahead) {
                Ok(found) => frames.push(found),
                Err(error) if ahead == t => return Err(error),
                // A damaged frame ends the search; the run ends when it gets there.
                Err(_) => break,
            }
        }
        clip.wanted()?;
        let all =
            frames.iter().enumerate().flat_map(|(frame, found)| (0..found.len()).map(move |index| (frame, index)));
        let moving = all.filter_map(|(frame, index)| {
            let length_px = longest(&frames[frame..], index);
            (length_px > 0.0).then_some(ConsistentObject { frame, index, length_px })
        });
        // Of equal motions, the first.
        Ok(moving.reduce(|best, blob| if blob.length_px > best.length_px { blob } else { best }))
    }
}

fn place(found: &Detection) -> [f64; 2] {
    found.center.map(f64::from)
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Returns the length in px of the longest consistent motion of a blob of the first frame; 0 if it has none.
fn longest(frames: &[Vec<Detection>], index: usize) -> f64 {
    let Some(next) = frames.get(1) else { return 0.0 };
    let start = &frames[0][index];
    let [width, height] = start.bounds.size().map(f64::from);
    let reach = REACH_PX.max(REACH_SIDES * width.max(height));
    let near = next.iter().filter(|found| apart(place(start), place(found)) <= reach);
    let blur_px = BLUR_SIDES * width.min(height);
    near.map(|second| continued(frames, [place(start), place(second)], blur_px)).fold(0.0, f64::max)
}

/// Returns the distance that a motion covers from its first two positions on, as long as its displacement changes little, given the
/// uncertainty of a position. A few missed frames do not end it.
fn continued(frames: &[Vec<Detection>], [start, second]: [[f64; 2]; 2], blur_px: f64) -> f64 {
    let (mut at, mut by, mut count, mut steps) = (second, [0, 1].map(|i| second[i] - start[i]), 2, 1);
    for frame in &frames[2..] {
        let expected = [0, 1].map(|i| at[i] + steps as f64 * by[i]);
        let nearest = frame.iter().map(place).min_by(|a, b| apart(*a, expected).total_cmp(&apart(*b, expected)));
        let allowed = steps as f64 * CHANGE_PX.max(CHANGE * by[0].hypot(by[1])) + blur_px;
        match nearest.filter(|next| apart(*next, expected) <= allowed) {
            Some(next) => {
                by = [0, 1].map(|i| (next[i] - at[i]) / steps as f64);
                (at, count, steps) = (next, count + 1, 1);
            }
            None if steps <= MOST_MISSED => steps += 1,
            None => break,
        }
    }
    let length = apart(start, at);
    // Flicker in place is no motion.
    if count >= LEAST_FRAMES && length > CHANGE_PX * (count - 1) as f64 / 2.0 { length } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Bounds;

    fn blob(x: f32, y: f32) -> Detection {
        Detection {
            bounds: Bounds::around([x, y], [8.0, 8.0]),
            center: [x, y],
            score: 1.0,
            blob: None,
            deviation_px: None,
        }
    }

    #[test]
    fn a_thrown_ball_moves_and_flicker_does_not() {
        let frame = |t: i32| {
            let t = t as f32;
            let jitter = if t % 2.0 == 0.0 { 2.5 } else { -2.5 };
            vec![blob(200.0 + jitter, 90.0), blob(20.0 + 12.0 * t, 150.0 - 14.0 * t + t * t)]
        };
        let frames: Vec<_> = (0..12).map(frame).collect();
        assert_eq!(longest(&frames, 0), 0.0);
        assert!(longest(&frames, 1) > 130.0, "{}", longest(&frames, 1));
        assert_eq!(longest(&frames[10..], 1), 0.0, "two frames are no motion");
        let hidden: Vec<_> = (0..12).map(|t| if [5, 6].contains(&t) { vec![] } else { frame(t) }).collect();
        assert_eq!(longest(&hidden, 1), longest(&frames, 1), "two missed frames do not end it");
    }
}
