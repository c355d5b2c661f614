//! A colour, and how well two of them can be told apart.

/// An sRGB colour with straight alpha: `[red, green, blue, alpha]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Color(pub [u8; 4]);

impl Color {
    /// Black.
    pub const BLACK: Color = Color::hex(0x00_0000);
    /// White.
    pub const WHITE: Color = Color::hex(0xff_ffff);

    /// The opaque colour `0xRRGGBB`.
    pub const fn hex(rgb: u32) -> Self {
        Self([(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8, 255])
    }

    /// An opaque gray.
    pub const fn gray(v: u8) -> Self {
        Self([v, v, v, 255])
    }

    /// The same colour with this alpha, 0 clear to 255 opaque.
    #[must_use]
    pub const fn alpha(self, alpha: u8) -> Self {
        let [r, g, b, _] = self.0;
        Self([r, g, b, alpha])
    }

    /// The colour a share `t` of the way from this one to `other`, 0 to 1.
    #[must_use]
    pub fn mix(self, other: Color, t: f32) -> Self {
        Self(std::array::from_fn(|i| {
            let (a, b) = (f32::from(self.0[i]), f32::from(other.0[i]));
            (a + (b - a) * t.clamp(0.0, 1.0)).round() as u8
        }))
    }

    /// Red, green and blue in proportion to light.
    fn linear(self) -> [f32; 3] {
        let [r, g, b, _] = self.0;
        [r, g, b].map(|c| match f32::from(c) / 255.0 {
            c if c <= 0.040_45 => c / 12.92,
            c => ((c + 0.055) / 1.055).powf(2.4),
        })
    }

    /// Relative luminance, 0 black to 1 white (WCAG 2).
    pub fn luminance(self) -> f32 {
        let [r, g, b] = self.linear();
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// Contrast with `other`, 1 none to 21 black on white (WCAG 2).
    pub fn contrast(self, other: Color) -> f32 {
        let (a, b) = (self.luminance() + 0.05, other.luminance() + 0.05);
        a.max(b) / a.min(b)
    }

    /// This colour, moved away from `background` as far as a contrast of `least` asks for, and no further.
    #[must_use]
    pub fn legible_on(self, background: Color, least: f32) -> Self {
        let away = if background.luminance() > 0.18 { Color::BLACK } else { Color::WHITE };
        let steps = (0..=40).map(|i| self.mix(away, i as f32 / 40.0));
        steps.into_iter().find(|c| c.contrast(background) >= least).unwrap_or(away)
    }
}

/// How colours are seen.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Vision {
    /// With all three kinds of cones.
    Usual,
    /// Without those for long waves.
    Protanopia,
    /// Without those for middle waves.
    Deuteranopia,
}

#[cfg(test)]
impl Vision {
    /// What becomes of linear red, green and blue, after Machado, Oliveira and Fernandes: A Physiologically-based Model for Simulation of
    /// Color Vision Deficiency (2009), severity 1.0.
    fn matrix(self) -> [[f32; 3]; 3] {
        match self {
            Vision::Usual => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Vision::Protanopia => [
                [0.152_286, 1.052_583, -0.204_868],
                [0.114_503, 0.786_281, 0.099_216],
                [-0.003_882, -0.048_116, 1.051_998],
            ],
            Vision::Deuteranopia => [
                [0.367_322, 0.860_646, -0.227_968],
                [0.280_085, 0.672_501, 0.047_413],
                [-0.011_820, 0.042_940, 0.968_881],
            ],
        }
    }
}

#[cfg(test)]
impl Color {
    /// What this colour looks like with `vision`.
    pub(super) fn seen_with(self, vision: Vision) -> Self {
        let from = self.linear();
        let seen = vision.matrix().map(|row| row.iter().zip(from).map(|(factor, c)| factor * c).sum::<f32>());
        let encoded = |c: f32| match c.clamp(0.0, 1.0) {
            c if c <= 0.003_130_8 => 12.92 * c,
            c => 1.055 * c.powf(1.0 / 2.4) - 0.055,
        };
        let [r, g, b] = seen.map(|c| (255.0 * encoded(c)).round() as u8);
        Self([r, g, b, self.0[3]])
    }

    /// The coordinates of this colour in CIELAB under D65.
    pub(super) fn lab(self) -> [f32; 3] {
        let [r, g, b] = self.linear();
        let rows =
            [[0.412_456, 0.357_576, 0.180_438], [0.212_673, 0.715_152, 0.072_175], [0.019_334, 0.119_192, 0.950_304]];
        let xyz = rows.map(|[x, y, z]: [f32; 3]| x * r + y * g + z * b);
        let share = |c: f32, white: f32| match c / white {
            c if c > 0.008_856 => c.cbrt(),
            c => 7.787 * c + 16.0 / 116.0,
        };
        let [x, y, z] = [share(xyz[0], 0.950_47), share(xyz[1], 1.0), share(xyz[2], 1.088_83)];
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_lacks_a_cone_sees_grays_as_they_are_and_red_as_no_green() {
        for vision in [Vision::Protanopia, Vision::Deuteranopia] {
            assert!(Color::gray(128).seen_with(vision).0.iter().take(3).all(|c| c.abs_diff(128) <= 1), "{vision:?}");
        }
        let [red, green] = [0xd0_3030, 0x30_8030].map(Color::hex);
        let hue = |color: Color| color.seen_with(Vision::Deuteranopia).lab()[1];
        assert!((hue(red) - hue(green)).abs() < 0.2 * (red.lab()[1] - green.lab()[1]).abs());
    }

    #[test]
    fn contrast_is_that_of_the_standard() {
        assert!((Color::BLACK.contrast(Color::WHITE) - 21.0).abs() < 1e-3);
        assert_eq!(Color::WHITE.contrast(Color::WHITE), 1.0);
        // 0x767676 is the lightest gray that reaches 4.5 on white.
        assert!(Color::hex(0x76_7676).contrast(Color::WHITE) >= 4.5);
        assert!(Color::hex(0x77_7777).contrast(Color::WHITE) < 4.5);
    }

    #[test]
    fn a_color_is_moved_only_as_far_as_needed() {
        let yellow = Color::hex(0xf0_e442);
        assert_eq!(yellow.legible_on(Color::BLACK, 4.5), yellow);
        let on_white = yellow.legible_on(Color::WHITE, 4.5);
        assert!(on_white.contrast(Color::WHITE) >= 4.5 && on_white.contrast(Color::WHITE) < 5.2);
    }
}
