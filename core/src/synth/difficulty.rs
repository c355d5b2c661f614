//! The difficulties of motion estimation: one slider for each of the course.

use crate::base::Error;
use crate::params::Params;

crate::params! {
    /// The difficulties of a synthetic clip. All are off unless a scene sets them.
    ///
    /// Speed, scale change and rotation change the true motion, and the ground truth follows exactly. All others change only
    /// the appearance.
    #[derive(PartialEq)]
    pub struct Difficulty {
        /// Factor on all velocities of the scene.
        speed: f32 = 1.0, 0.0..=4.0, "×";
        /// Growth of the whole picture per frame (negative: shrinking); after doubling or halving it reverses.
        scale_change: f32 = 0.0, -5.0..=5.0, "%/frame";
        /// Clockwise rotation of the whole picture about its centre per frame.
        rotation: f32 = 0.0, -10.0..=10.0, "°/frame";
        /// Loss of texture contrast; at 100 % every surface is uniform and only outlines remain.
        low_texture: f32 = 0.0, 0.0..=100.0, "%";
        /// Share of every texture that is replaced by a repeating pattern: ambiguous matches.
        repeating_texture: f32 = 0.0, 0.0..=100.0, "%";
        /// Period of the repeating pattern.
        period: u32 = 16, 4..=64, "px";
        /// Share of the background behind moving objects that is covered by patches with their colours and texture: clutter of like colour.
        /// No effect in scenes without objects, and in scenes of bodies in space.
        clutter: f32 = 0.0, 0.0..=100.0, "%";
        /// Multiplicative brightness change per frame (negative: darker), over four frames; over the next four it reverses.
        gain: f32 = 0.0, -10.0..=10.0, "%/frame";
        /// Additive brightness change per frame, over four frames; over the next four it reverses.
        offset: f32 = 0.0, -10.0..=10.0, "levels/frame";
        /// Largest random brightness change of a frame, up or down: violates brightness constancy.
        flicker: f32 = 0.0, 0.0..=50.0, "%";
        /// Exposure time as a share of the time between frames: motion blur.
        motion_blur: f32 = 0.0, 0.0..=100.0, "%";
        /// Standard deviation of the Gaussian noise added to every gray value.
        noise: f32 = 0.0, 0.0..=50.0, "levels";
        /// Share of pixels replaced by black or white.
        salt_and_pepper: f32 = 0.0, 0.0..=50.0, "%";
        /// Compression of 8×8 blocks as in JPEG, at quality 100 minus this; 0 is uncompressed.
        compression: u32 = 0, 0..=99, "%";
        /// Width of every frame.
        width: usize = 320, 32..=1920, "px";
        /// Height of every frame.
        height: usize = 240, 32..=1080, "px";
        /// Number of frames.
        frames: usize = 24, 2..=500;
        /// Random seed of textures and noise. The same seed gives the same clip.
        seed: u32 = 1, 0..=999_999;
    }
    advanced { "width", "height", "seed" }
    when {
        "period": |p| p.repeating_texture > 0.0, "The period has no effect without a repeating texture.";
    }
}

impl Difficulty {
    /// Checks every value against its range, since the fields can be written directly.
    ///
    /// # Errors
    /// If a value is out of range: a sentence with the range.
    pub(super) fn check(&self) -> Result<(), Error> {
        self.specs().iter().zip(self.values()).try_for_each(|(spec, (_, value))| spec.check(value).map(|_| ()))
    }
}
