//! The path of a camera over a scene, exact at any real time.

use super::maths::sin;
use super::motion::Affine;
use super::shape::{Point, length};

/// The motion of a camera that pans steadily and shakes. At time 0 it is where a camera at rest is.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Velocity in units of the scene per frame.
    pub pan: Point,
    /// Amplitude of the shake along x and y, in units of the scene.
    pub shake: Point,
    /// Amplitude of the rotation about the optical axis, in turns.
    pub roll: f64,
}

impl Path {
    /// A camera at rest.
    pub const REST: Self = Self { pan: [0.0; 2], shake: [0.0; 2], roll: 0.0 };

    /// The map from the scene about the middle of the first picture to that about the middle of the picture at time `t`.
    pub fn pose(&self, t: f64) -> Affine {
        let [across, down] = [tremor(t, [5.3, 2.9]), tremor(t, [4.1, 7.7])];
        let shaken = [across, down];
        let at: Point = std::array::from_fn(|i| self.pan[i] * t + self.shake[i] * shaken[i]);
        let turned = self.roll * tremor(t, [6.1, 3.7]);
        Affine::similarity(0.0, 1.0, at.map(|c| -c)).then(&Affine::similarity(-turned, 1.0, [0.0; 2]))
    }

    /// The largest distance from its first place up to time `t`.
    pub fn reach(&self, t: f64) -> f64 {
        length(self.pan) * t + length(self.shake)
    }
}

/// Two sinusoids of these periods in frames, between −1 and 1 together; 0 at time 0.
fn tremor(t: f64, [slow, fast]: [f64; 2]) -> f64 {
    0.6 * sin(t / slow) + 0.4 * sin(t / fast)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_at_rest_changes_nothing() {
        for t in [0.0, 3.5, 20.0] {
            assert_eq!(Path::REST.pose(t).apply([12.0, -7.0]), [12.0, -7.0]);
        }
    }

    #[test]
    fn a_pan_to_the_right_moves_the_picture_to_the_left() {
        let path = Path { pan: [2.0, 0.5], ..Path::REST };
        assert_eq!(path.pose(4.0).apply([10.0, 10.0]), [2.0, 8.0]);
    }

    #[test]
    fn the_shake_stays_within_its_reach_and_begins_at_rest() {
        let path = Path { pan: [0.0; 2], shake: [3.0, 4.0], roll: 0.0 };
        assert_eq!(path.pose(0.0).apply([1.0, 1.0]), [1.0, 1.0]);
        let farthest = (0..400).map(|i| length(path.pose(f64::from(i) * 0.25).shift)).fold(0.0, f64::max);
        assert!((3.0..=path.reach(100.0)).contains(&farthest), "{farthest}");
    }
}
