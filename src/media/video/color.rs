//! From luma and chroma planes to a frame.

use crate::media::reason;
use motionscope_core::base::Error;
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;
use yuv::{YuvPlanarImage, YuvRange, YuvStandardMatrix};

/// How chroma is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Chroma {
    /// No colour.
    Mono,
    /// Half the columns, half the rows.
    Yuv420,
    /// A quarter of the columns.
    Yuv411,
    /// Half the columns.
    Yuv422,
    /// Half the rows.
    Yuv440,
    /// All of them.
    Yuv444,
}

impl Chroma {
    /// Luma samples for one of chroma, across and down; `None` without colour.
    pub(crate) fn steps(self) -> Option<(usize, usize)> {
        match self {
            Chroma::Mono => None,
            Chroma::Yuv420 => Some((2, 2)),
            Chroma::Yuv411 => Some((4, 1)),
            Chroma::Yuv422 => Some((2, 1)),
            Chroma::Yuv440 => Some((1, 2)),
            Chroma::Yuv444 => Some((1, 1)),
        }
    }

    /// The name of such samples at `depth` bits, as ffmpeg has it: `yuv420p10`.
    pub(crate) fn name(self, depth: u32) -> String {
        let base = match self {
            Chroma::Mono => "gray",
            Chroma::Yuv420 => "yuv420p",
            Chroma::Yuv411 => "yuv411p",
            Chroma::Yuv422 => "yuv422p",
            Chroma::Yuv440 => "yuv440p",
            Chroma::Yuv444 => "yuv444p",
        };
        if depth == 8 { base.into() } else { format!("{base}{depth}") }
    }
}

/// The weights of R, G and B in luma.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Matrix {
    /// Standard definition.
    Bt601,
    /// High definition.
    Bt709,
    /// Ultra-high definition.
    Bt2020,
    /// The planes are G, B and R.
    Identity,
}

impl Matrix {
    /// The matrix with ISO/IEC 23091-2's number `code`; where that says nothing, by custom from the height in pixels.
    pub(crate) fn from_code(code: u32, height: usize) -> Self {
        match code {
            0 => Matrix::Identity,
            1 => Matrix::Bt709,
            9 | 10 => Matrix::Bt2020,
            5..=7 => Matrix::Bt601,
            _ => Self::by_height(height),
        }
    }

    /// What is customary for pictures `height` pixels high.
    pub(crate) fn by_height(height: usize) -> Self {
        if height >= 720 { Matrix::Bt709 } else { Matrix::Bt601 }
    }
}

/// What sample values mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Colors {
    /// The weights in luma.
    pub matrix: Matrix,
    /// Whether black is 0 and white 255, not 16 and 235.
    pub full_range: bool,
}

/// A decoded picture, before it is a frame.
#[derive(Clone, Debug)]
pub(crate) enum Picture {
    /// In planes.
    Planes(Yuv),
    /// As it is.
    Ready(Frame),
}

impl Picture {
    /// The picture in 8 bits, in colour if it has any.
    ///
    /// # Errors
    /// If its planes are not as large as its size says.
    pub(crate) fn into_frame(self) -> Result<Frame, Error> {
        match self {
            Picture::Planes(yuv) => yuv.into_frame(),
            Picture::Ready(frame) => Ok(frame),
        }
    }
}

/// A picture in luma and chroma planes without padding.
#[derive(Clone, Debug)]
pub(crate) struct Yuv {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// How chroma is sampled.
    pub chroma: Chroma,
    /// Bits per sample; above 8, each sample is two bytes, little-endian.
    pub depth: u32,
    /// Y, U and V; the last two are empty without colour.
    pub planes: [Vec<u8>; 3],
    /// What the values mean.
    pub colors: Colors,
}

impl Yuv {
    /// Width and height in samples of the planes of such a picture.
    pub(crate) fn plane_sizes(width: usize, height: usize, chroma: Chroma) -> [(usize, usize); 3] {
        let small = chroma.steps().map_or((0, 0), |(dx, dy)| (width.div_ceil(dx), height.div_ceil(dy)));
        [(width, height), small, small]
    }

    /// The picture in 8 bits, in colour if it has any.
    ///
    /// # Errors
    /// If the planes are not as large as the size says.
    pub(crate) fn into_frame(mut self) -> Result<Frame, Error> {
        self.reduce_depth();
        let sizes = Self::plane_sizes(self.width, self.height, self.chroma);
        if self.planes.iter().zip(sizes).any(|(plane, (w, h))| plane.len() != w * h) {
            return Err(Error::new("its planes do not have the size that its header tells"));
        }
        if self.chroma == Chroma::Mono {
            return self.into_gray();
        }
        if self.colors.matrix == Matrix::Identity {
            return self.into_identity();
        }
        self.spread_rare_chroma();
        self.into_rgb()
    }

    /// Rounds deeper samples to 8 bits.
    fn reduce_depth(&mut self) {
        if self.depth <= 8 {
            return;
        }
        let shift = self.depth.min(16) - 8;
        let half = 1_u32 << (shift - 1);
        for plane in &mut self.planes {
            let narrow = |pair: &[u8]| {
                let value = u32::from(u16::from_le_bytes([pair[0], pair[1]]));
                ((value + half) >> shift).min(255) as u8
            };
            *plane = plane.chunks_exact(2).map(narrow).collect();
        }
        self.depth = 8;
    }

    fn into_gray(self) -> Result<Frame, Error> {
        let [mut luma, ..] = self.planes;
        if !self.colors.full_range {
            // 16 to 235 become 0 to 255, rounded.
            let wide = |v: usize| u8::try_from((v.saturating_sub(16) * 255 + 109) / 219).unwrap_or(u8::MAX);
            let wide: [u8; 256] = std::array::from_fn(wide);
            luma.iter_mut().for_each(|v| *v = wide[usize::from(*v)]);
        }
        Grid::from_vec(self.width, self.height, luma).map(Frame::gray)
    }

    fn into_identity(self) -> Result<Frame, Error> {
        if self.chroma != Chroma::Yuv444 {
            return Err(Error::new("its colours are stored as RGB at different sizes, which nothing defines"));
        }
        let [g, b, r] = self.planes;
        let rgb = r.iter().zip(&g).zip(&b).map(|((&r, &g), &b)| [r, g, b]).collect();
        Grid::from_vec(self.width, self.height, rgb).map(Frame::rgb)
    }

    /// Repeats chroma samples until only layouts are left that the conversion knows.
    fn spread_rare_chroma(&mut self) {
        let (across, down, chroma) = match self.chroma {
            Chroma::Yuv411 => (2, 1, Chroma::Yuv422),
            Chroma::Yuv440 => (1, 2, Chroma::Yuv444),
            _ => return,
        };
        let [_, (old_width, _), _] = Self::plane_sizes(self.width, self.height, self.chroma);
        let [_, (width, height), _] = Self::plane_sizes(self.width, self.height, chroma);
        for plane in &mut self.planes[1..] {
            *plane = Grid::from_fn(width, height, |x, y| plane[y / down * old_width + x / across]).into_cells();
        }
        self.chroma = chroma;
    }

    fn into_rgb(self) -> Result<Frame, Error> {
        let [_, (chroma_width, _), _] = Self::plane_sizes(self.width, self.height, self.chroma);
        let [width, height, chroma_width] =
            [self.width, self.height, chroma_width].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        let [y_plane, u_plane, v_plane] = &self.planes;
        let image = YuvPlanarImage {
            y_plane,
            y_stride: width,
            u_plane,
            u_stride: chroma_width,
            v_plane,
            v_stride: chroma_width,
            width,
            height,
        };
        let range = if self.colors.full_range { YuvRange::Full } else { YuvRange::Limited };
        let matrix = match self.colors.matrix {
            Matrix::Bt601 | Matrix::Identity => YuvStandardMatrix::Bt601,
            Matrix::Bt709 => YuvStandardMatrix::Bt709,
            Matrix::Bt2020 => YuvStandardMatrix::Bt2020,
        };
        let convert = match self.chroma {
            Chroma::Yuv420 => yuv::yuv420_to_rgb,
            Chroma::Yuv422 => yuv::yuv422_to_rgb,
            _ => yuv::yuv444_to_rgb,
        };
        let mut rgb = vec![[0_u8; 3]; self.width * self.height];
        convert(&image, bytemuck::cast_slice_mut(&mut rgb), width.saturating_mul(3), range, matrix).map_err(
            |error| Error::new(format!("its colours cannot be converted{}", reason::bracketed(&error.to_string()))),
        )?;
        Grid::from_vec(self.width, self.height, rgb).map(Frame::rgb)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(chroma: Chroma, size: (usize, usize), depth: u32, [y, u, v]: [u16; 3], colors: Colors) -> Frame {
        let values = [y, u, v];
        let sizes = Yuv::plane_sizes(size.0, size.1, chroma);
        let planes = std::array::from_fn(|p| {
            let count = sizes[p].0 * sizes[p].1;
            if depth == 8 { vec![values[p] as u8; count] } else { values[p].to_le_bytes().repeat(count) }
        });
        Yuv { width: size.0, height: size.1, chroma, depth, planes, colors }.into_frame().unwrap()
    }

    const SD: Colors = Colors { matrix: Matrix::Bt601, full_range: false };
    const COLORED: [Chroma; 5] = [Chroma::Yuv420, Chroma::Yuv411, Chroma::Yuv422, Chroma::Yuv440, Chroma::Yuv444];

    fn close(frame: &Frame, rgb: [i32; 3]) {
        for cell in frame.color().unwrap().cells() {
            let far = (0..3).any(|c| (i32::from(cell[c]) - rgb[c]).abs() > 1);
            assert!(!far, "{cell:?} is not {rgb:?}");
        }
    }

    #[test]
    fn known_colours_of_every_layout_and_odd_size() {
        for chroma in COLORED {
            for size in [(1, 1), (5, 3), (16, 8), (33, 7)] {
                // Rec. 601's 75 % bars: white, red, blue.
                close(&flat(chroma, size, 8, [180, 128, 128], SD), [191; 3]);
                close(&flat(chroma, size, 8, [65, 100, 212], SD), [191, 0, 0]);
                close(&flat(chroma, size, 8, [35, 212, 114], SD), [0, 0, 191]);
                close(&flat(chroma, size, 10, [65 * 4, 400, 848], SD), [191, 0, 0]);
            }
        }
    }

    #[test]
    fn matrix_and_range_are_heeded() {
        let hd = Colors { matrix: Matrix::from_code(2, 720), full_range: false };
        assert_eq!(hd.matrix, Matrix::Bt709);
        close(&flat(Chroma::Yuv420, (4, 4), 8, [51, 109, 212], hd), [191, 0, 0]);
        let full = Colors { matrix: Matrix::Bt601, full_range: true };
        close(&flat(Chroma::Yuv444, (4, 4), 8, [76, 85, 255], full), [254, 0, 0]);
        let planes = Colors { matrix: Matrix::Identity, full_range: true };
        close(&flat(Chroma::Yuv444, (2, 2), 8, [10, 20, 30], planes), [30, 10, 20]);
    }

    #[test]
    fn gray_keeps_or_widens_its_range() {
        let full = Colors { full_range: true, ..SD };
        assert!(flat(Chroma::Mono, (3, 3), 8, [77, 0, 0], full).luma().cells().iter().all(|&v| v == 77));
        for (limited, wide) in [(16, 0), (235, 255), (126, 128), (0, 0), (255, 255)] {
            assert_eq!(flat(Chroma::Mono, (1, 1), 8, [limited, 0, 0], SD).luma().cells(), [wide]);
        }
        assert_eq!(flat(Chroma::Mono, (1, 1), 12, [4095, 0, 0], full).luma().cells(), [255]);
        assert_eq!(flat(Chroma::Mono, (1, 1), 16, [0x80_7F, 0, 0], full).luma().cells(), [0x80]);
    }

    #[test]
    fn short_planes_are_refused() {
        let yuv = Yuv {
            width: 4,
            height: 4,
            chroma: Chroma::Yuv420,
            depth: 8,
            planes: [vec![0; 16], vec![0; 4], vec![0; 3]],
            colors: SD,
        };
        assert!(yuv.into_frame().is_err());
    }
}
