//! Colours for numbers.

use super::Color;

/// Which colours stand for small and large numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// Dark violet to yellow, evenly in lightness (van der Walt and Smith 2015).
    #[default]
    Viridis,
    /// Blue over green to red, for finer steps (Mikhailov 2019).
    Turbo,
    /// Blue over gray to red, for numbers with a sign: gray is 0 (after Moreland 2009).
    Diverging,
}

impl ColorMap {
    /// Every colour map that can be chosen; numbers with a sign have their own.
    pub const ALL: [ColorMap; 2] = [ColorMap::Viridis, ColorMap::Turbo];

    /// Stable name, for sessions and the command line.
    pub const fn id(self) -> &'static str {
        match self {
            ColorMap::Viridis => "viridis",
            ColorMap::Turbo => "turbo",
            ColorMap::Diverging => "diverging",
        }
    }

    /// What it is for, in one sentence.
    pub const fn tip(self) -> &'static str {
        match self {
            ColorMap::Viridis => {
                "Costs from violet to yellow, evenly in lightness: they print well and everyone can tell them apart."
            }
            ColorMap::Turbo => "Costs from blue over green to red: small differences are seen better.",
            ColorMap::Diverging => "Negative numbers blue, positive red, 0 gray.",
        }
    }

    /// Name as shown.
    pub const fn name(self) -> &'static str {
        match self {
            ColorMap::Viridis => "Viridis",
            ColorMap::Turbo => "Turbo",
            ColorMap::Diverging => "Diverging",
        }
    }

    /// The colour at `t`, 0 smallest to 1 largest; beyond them the ends, and NaN is clear.
    pub fn at(self, t: f32) -> Color {
        if t.is_nan() {
            return Color::BLACK.alpha(0);
        }
        let stops: &[u32] = match self {
            ColorMap::Viridis => &VIRIDIS,
            ColorMap::Turbo => &TURBO,
            ColorMap::Diverging => &DIVERGING,
        };
        let place = t.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
        let index = (place as usize).min(stops.len() - 2);
        Color::hex(stops[index]).mix(Color::hex(stops[index + 1]), place - index as f32)
    }
}

// Evenly spaced colours of the published map; the middle is a gray of the same lightness as its neighbours.
const DIVERGING: [u32; 9] =
    [0x3b_4cc0, 0x62_82ea, 0x8d_b0fe, 0xb8_d0f9, 0xdd_dddd, 0xf5_c4ad, 0xf4_9a7b, 0xde_604d, 0xb4_0426];
// Every eighth colour of the published tables of 256; in between they are within 3/255 of them.
const VIRIDIS: [u32; 33] = [
    0x44_0154, 0x47_0d60, 0x48_186a, 0x48_2374, 0x47_2d7b, 0x45_3681, 0x42_4086, 0x3f_4989, 0x3b_528b, 0x37_5a8d,
    0x33_638d, 0x2f_6a8e, 0x2c_728e, 0x29_7a8e, 0x26_818e, 0x23_898e, 0x21_908c, 0x1f_988b, 0x1f_9f88, 0x21_a685,
    0x28_ae80, 0x31_b57b, 0x3e_bc74, 0x4c_c26c, 0x5d_c963, 0x6e_ce58, 0x82_d34c, 0x96_d83f, 0xab_dc32, 0xc0_df24,
    0xd5_e21a, 0xea_e51a, 0xfd_e725,
];
const TURBO: [u32; 33] = [
    0x30_123b, 0x39_2a73, 0x40_40a1, 0x44_56c7, 0x46_6be3, 0x46_7ff6, 0x42_93ff, 0x37_a7fa, 0x29_bbec, 0x1d_cdd8,
    0x18_dcc3, 0x1e_e8b0, 0x31_f299, 0x4c_f97e, 0x6b_fd64, 0x8a_ff4d, 0xa3_fd3c, 0xb8_f735, 0xcc_ed34, 0xde_e037,
    0xed_d03a, 0xf8_c03a, 0xfd_ae35, 0xfe_982c, 0xfb_8022, 0xf5_6817, 0xec_520f, 0xe0_4009, 0xd2_3105, 0xc0_2302,
    0xac_1701, 0x95_0d01, 0x7a_0403,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_maps_are_the_published_ones() {
        let known = [
            (ColorMap::Viridis, [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]]),
            (ColorMap::Turbo, [[48, 18, 59], [40, 188, 235], [164, 252, 60], [251, 126, 33], [122, 4, 3]]),
        ];
        for (map, colors) in known {
            for (index, color) in [0, 64, 128, 192, 255].into_iter().zip(colors) {
                let Color([r, g, b, _]) = map.at(index as f32 / 255.0);
                let off = [r, g, b].into_iter().zip(color).map(|(a, b): (u8, u8)| a.abs_diff(b)).max();
                assert!(off <= Some(3), "{map:?} at {index}: {:?}", map.at(index as f32 / 255.0));
            }
        }
    }

    #[test]
    fn zero_is_gray_and_signs_differ() {
        let Color([r, g, b, _]) = ColorMap::Diverging.at(0.5);
        assert!(r == g && g == b, "{r} {g} {b}");
        let (below, above) = (ColorMap::Diverging.at(0.2).0, ColorMap::Diverging.at(0.8).0);
        assert!(below[2] > below[0] && above[0] > above[2]);
    }

    #[test]
    fn the_ends_hold_and_nan_is_clear() {
        for map in ColorMap::ALL {
            assert_eq!(map.at(-7.0), map.at(0.0));
            assert_eq!(map.at(f32::INFINITY), map.at(1.0));
            assert_eq!(map.at(f32::NAN).0[3], 0);
        }
    }

    #[test]
    fn viridis_grows_lighter() {
        let light: Vec<_> = (0..64).map(|i| ColorMap::Viridis.at(i as f32 / 63.0).luminance()).collect();
        assert!(light.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
