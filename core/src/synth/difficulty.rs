//! What makes motion hard to see: one slider for each difficulty of the course.

use crate::base::Error;
use crate::params::Params;

crate::params! {
    /// Every difficulty that a synthetic clip can have, and its size. All are off unless a scene says otherwise.
    ///
    /// Speed, scale change and rotation change the true motion, and the truth follows exactly. All others change
    /// only how the motion looks.
    #[derive(PartialEq)]
    pub struct Difficulty {
        /// How many times faster than usual everything in the scene moves.
        speed: f32 = 1.0, 0.0..=4.0, "×";
        /// How much the whole picture grows in each frame (shrinks if negative); once doubled or halved, it goes back.
        scale_change: f32 = 0.0, -5.0..=5.0, "%/frame";
        /// How far the whole picture turns clockwise about its centre in each frame.
        rotation: f32 = 0.0, -10.0..=10.0, "°/frame";
        /// How much of the texture's contrast is gone; at 100 % every surface is plain and only outlines are left.
        low_texture: f32 = 0.0, 0.0..=100.0, "%";
        /// How much of every texture is replaced by a pattern that repeats itself.
        repeating_texture: f32 = 0.0, 0.0..=100.0, "%";
        /// Distance after which the repeating pattern looks the same again.
        period: u32 = 16, 4..=64, "px";
        /// How much brighter the light gets in each of four frames (darker if negative); in the next four it goes back.
        gain: f32 = 0.0, -10.0..=10.0, "%/frame";
        /// How many gray levels are added in each of four frames; in the next four they are taken away again.
        offset: f32 = 0.0, -10.0..=10.0, "levels/frame";
        /// How far the light of any frame may be off at random, up or down.
        flicker: f32 = 0.0, 0.0..=50.0, "%";
        /// How long the shutter stays open, as a share of the time between frames; what moves is smeared.
        motion_blur: f32 = 0.0, 0.0..=100.0, "%";
        /// Standard deviation of the Gaussian noise on the gray value of every pixel.
        noise: f32 = 0.0, 0.0..=50.0, "levels";
        /// Share of pixels that are replaced by black or white.
        salt_and_pepper: f32 = 0.0, 0.0..=50.0, "%";
        /// How strongly blocks of 8×8 pixels are compressed, as in JPEG at quality 100 less this; 0 is uncompressed.
        compression: u32 = 0, 0..=99, "%";
        /// Width of every frame.
        width: usize = 320, 32..=1920, "px";
        /// Height of every frame.
        height: usize = 240, 32..=1080, "px";
        /// Number of frames.
        frames: usize = 24, 2..=500;
        /// Another number gives other textures and other noise; the same number, the same bytes.
        seed: u32 = 1, 0..=999_999;
    }
    advanced { "width", "height", "seed" }
    when {
        "period": |p| p.repeating_texture > 0.0, "The period has no effect without a repeating texture.";
    }
}

impl Difficulty {
    /// Checks every value, since the fields can be written directly.
    ///
    /// # Errors
    /// A sentence with the range of the first value that is not allowed.
    pub(super) fn check(&self) -> Result<(), Error> {
        self.specs().iter().zip(self.values()).try_for_each(|(spec, (_, value))| spec.check(value).map(|_| ()))
    }
}
