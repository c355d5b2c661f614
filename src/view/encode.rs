//! The encoding of a rendering as a file: the stage alone, or a sheet of panes.

use motionscope_core::base::Error;
use motionscope_core::geometry::Grid;

use super::look::CaptionWords;
use super::rendering::{Around, Format, Rendering};
use super::sheet::Layout;
use crate::paint::{self, Figure, export_pdf, export_png, export_svg};

/// The scale of marks in SVG and PDF, as in a PNG of this scale.
const SVG_SCALE: u32 = 2;

impl Rendering<'_> {
    /// Encodes the picture; a PNG has `scale` pixels for each pixel of the clip.
    ///
    /// # Errors
    /// If the picture would be larger than can be written.
    pub fn encode(&self, format: Format, scale: u32) -> Result<Vec<u8>, Error> {
        self.encode_with(format, scale, None)
    }

    /// Returns the pixels of the picture as a PNG of this scale has them.
    ///
    /// # Errors
    /// As [`Rendering::encode`].
    pub fn pixels(&self, scale: u32) -> Result<Grid<[u8; 3]>, Error> {
        paint::pixels(&self.picture(scale, None), scale)
    }

    /// Encodes one of several pictures whose sheets share a `layout`, made by the first of them.
    ///
    /// # Errors
    /// As [`Rendering::encode`].
    pub fn encode_in(&self, layout: &mut Option<Layout>, format: Format, scale: u32) -> Result<Vec<u8>, Error> {
        self.encode_with(format, scale, Some(layout))
    }

    fn encode_with(&self, format: Format, scale: u32, layout: Option<&mut Option<Layout>>) -> Result<Vec<u8>, Error> {
        self.encoded(format, scale, |scale| self.picture(scale, layout))
    }

    /// Encodes the picture with what `around` puts around it.
    ///
    /// # Errors
    /// As [`Rendering::encode`].
    pub fn encode_around(
        &self,
        format: Format,
        scale: u32,
        around: impl FnOnce(Figure) -> Figure,
    ) -> Result<Vec<u8>, Error> {
        self.encoded(format, scale, |scale| around(self.picture(scale, None)))
    }

    /// Encodes the figure that is made for a scale of marks.
    fn encoded(&self, format: Format, scale: u32, figure: impl FnOnce(u32) -> Figure) -> Result<Vec<u8>, Error> {
        match format {
            Format::Png => export_png(&figure(scale), scale),
            Format::Svg => export_svg(&figure(SVG_SCALE), self.look.svg_text).map(String::into_bytes),
            Format::Pdf => export_pdf(&figure(SVG_SCALE)),
        }
    }

    /// Returns the stage alone, or a sheet of the selected panes.
    fn picture(&self, scale: u32, layout: Option<&mut Option<Layout>>) -> Figure {
        if !self.panes.panes.is_empty() {
            return self.sheet(scale, layout);
        }
        let caption = (self.look.caption != CaptionWords::Off).then(|| self.caption());
        self.figure(Around { zoom: 1.0, titles: false, caption }, scale)
    }
}
