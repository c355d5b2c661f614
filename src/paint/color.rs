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

    /// Relative luminance, 0 black to 1 white (WCAG 2).
    pub fn luminance(self) -> f32 {
        let linear = |c: u8| match f32::from(c) / 255.0 {
            c if c <= 0.040_45 => c / 12.92,
            c => ((c + 0.055) / 1.055).powf(2.4),
        };
        let [r, g, b, _] = self.0;
        0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
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

#[cfg(test)]
mod tests {
    use super::*;

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
