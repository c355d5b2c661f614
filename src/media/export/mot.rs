//! Tracks of objects as MOTChallenge rows.

use motionscope_core::data::ObjectBox;

/// `frames` of objects as a `gt.txt`: frame, id, left, top, width, height, 1, class 1, visibility; frames and pixels
/// counted from 1 (Milan et al., MOT16: A Benchmark for Multi-Object Tracking, 2016).
pub fn mot(frames: &[Vec<ObjectBox>]) -> String {
    let rows = frames.iter().enumerate().flat_map(|(t, objects)| objects.iter().map(move |object| (t + 1, object)));
    rows.map(|(frame, object)| {
        let ObjectBox { id, x, y, width, height, visibility } = *object;
        let ([left, top, width, height], visibility) = (rect([x, y, width, height]), brief(visibility));
        format!("{frame},{id},{left},{top},{width},{height},1,1,{visibility}\n")
    })
    .collect()
}

/// A box by its left and top edge, width and height, as they count pixels: the edge of our first one lies at −0.5, that of theirs at 1.
pub fn rect([x, y, width, height]: [f32; 4]) -> [f64; 4] {
    [x + FIRST_PX, y + FIRST_PX, width, height].map(brief)
}

/// From where our first pixel begins to where theirs does.
const FIRST_PX: f32 = 1.5;

/// Four decimals at most.
fn brief(value: f32) -> f64 {
    (f64::from(value) * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_pixels_are_counted_from_one() {
        let object = ObjectBox { id: 7, x: -0.5, y: 9.5, width: 4.0, height: 2.5, visibility: 0.75 };
        assert_eq!(mot(&[vec![], vec![object]]), "2,7,1,11,4,2.5,1,1,0.75\n");
    }
}
