//! The PDF painter: lines that stay sharp, and words that stay words, in the program's own type.
//!
//! A file is one figure, or sheets of paper with figures on them ([`export_sheets`]).

mod fonts;
mod page;

use std::io::Write as _;
use std::sync::Arc;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use motionscope_core::base::Error;
use motionscope_core::geometry::Grid;
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::Figure;
use super::primitive::Point;
use fonts::Fonts;
use page::Page;

/// A sheet of paper with figures on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Width and height in points of paper, 72 of which are an inch.
    pub size: [f32; 2],
    /// What stands on it, back to front.
    pub figures: Vec<Placed>,
}

/// A figure on a [`Sheet`].
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The figure.
    pub figure: Figure,
    /// Where its upper left corner lies, in points of paper.
    pub at: Point,
    /// Points of paper for each of its own.
    pub scale: f32,
}

/// `figure` as a PDF file of one page, as large as the figure. The same figure gives the same bytes.
///
/// # Errors
/// If a part of it cannot be packed.
pub fn export_pdf(figure: &Figure) -> Result<Vec<u8>, Error> {
    let placed = Placed { figure: figure.clone(), at: [0.0; 2], scale: 1.0 };
    export_sheets(&figure.description, &[Sheet { size: figure.size, figures: vec![placed] }])
}

/// `sheets` as a PDF file of a page each, about `subject`. The same sheets give the same bytes.
///
/// # Errors
/// If a part of them cannot be packed.
pub fn export_sheets(subject: &str, sheets: &[Sheet]) -> Result<Vec<u8>, Error> {
    write(subject, sheets).map_err(|reason| Error::new(format!("the PDF could not be made: {reason}")))
}

/// Numbers of the objects of a file, one after the other.
struct Numbers(i32);

impl Numbers {
    fn next(&mut self) -> Ref {
        self.0 += 1;
        Ref::new(self.0)
    }
}

fn write(subject: &str, sheets: &[Sheet]) -> Result<Vec<u8>, String> {
    let mut numbers = Numbers(0);
    let [catalog, pages, info] = [(); 3].map(|()| numbers.next());
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    let mut fonts = Fonts::default();
    let drawn: Vec<(Page, Ref)> = sheets.iter().map(|sheet| (Page::of(sheet, &mut fonts), numbers.next())).collect();
    let count = i32::try_from(drawn.len()).map_err(|error| error.to_string())?;
    pdf.pages(pages).kids(drawn.iter().map(|(_, id)| *id)).count(count);
    let fonts: Vec<(Vec<u8>, Ref)> = fonts
        .used()
        .map(|font| Ok((font.name(), font.write(&mut pdf, &mut numbers)?)))
        .collect::<Result<_, String>>()?;
    for ((page, id), sheet) in drawn.into_iter().zip(sheets) {
        one(&mut pdf, &mut numbers, (page, sheet), Place { id, pages, fonts: &fonts })?;
    }
    let mut about = pdf.document_info(info);
    about.title(TextStr("Motionscope")).subject(TextStr(subject)).creator(TextStr("Motionscope"));
    about.finish();
    Ok(pdf.finish())
}

/// Where a page belongs, and the type that all pages share.
struct Place<'a> {
    id: Ref,
    pages: Ref,
    fonts: &'a [(Vec<u8>, Ref)],
}

/// Writes a page with its pictures.
fn one(pdf: &mut Pdf, numbers: &mut Numbers, (page, sheet): (Page, &Sheet), place: Place<'_>) -> Result<(), String> {
    let contents = numbers.next();
    let images: Vec<Ref> =
        page.images.iter().map(|pixels| image(pdf, numbers, pixels)).collect::<Result<_, String>>()?;
    let opacities: Vec<(Vec<u8>, Ref)> =
        page.opacities.iter().map(|alpha| (page::opacity(*alpha), numbers.next())).collect();
    for (alpha, (_, id)) in page.opacities.iter().zip(&opacities) {
        let share = f32::from(*alpha) / 255.0;
        pdf.ext_graphics(*id).non_stroking_alpha(share).stroking_alpha(share);
    }
    let mut written = pdf.page(place.id);
    written.parent(place.pages).media_box(Rect::new(0.0, 0.0, sheet.size[0], sheet.size[1])).contents(contents);
    let mut resources = written.resources();
    let mut all = resources.fonts();
    place.fonts.iter().for_each(|(name, id)| _ = all.pair(Name(name), *id));
    all.finish();
    let mut all = resources.x_objects();
    images.iter().enumerate().for_each(|(i, id)| _ = all.pair(Name(&page::image(i)), *id));
    all.finish();
    let mut all = resources.ext_g_states();
    opacities.iter().for_each(|(name, id)| _ = all.pair(Name(name), *id));
    all.finish();
    resources.finish();
    written.finish();
    let packed = packed(&page.content.finish())?;
    pdf.stream(contents, &packed).filter(Filter::FlateDecode);
    Ok(())
}

/// Packed as every reader can unpack it.
fn packed(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|error| error.to_string())
}

/// Writes a picture, and how opaque its pixels are unless all are.
fn image(pdf: &mut Pdf, numbers: &mut Numbers, pixels: &Arc<Grid<[u8; 4]>>) -> Result<Ref, String> {
    let side = |n: usize| i32::try_from(n).map_err(|error| error.to_string());
    let (width, height) = (side(pixels.width())?, side(pixels.height())?);
    let id = numbers.next();
    let mask = pixels.cells().iter().any(|p| p[3] != 255).then(|| numbers.next());
    let colors = packed(&pixels.cells().iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect::<Vec<u8>>())?;
    let mut object = pdf.image_xobject(id, &colors);
    object.filter(Filter::FlateDecode);
    object.width(width).height(height).bits_per_component(8).interpolate(false);
    object.color_space().device_rgb();
    if let Some(mask) = mask {
        object.s_mask(mask);
    }
    object.finish();
    if let Some(mask) = mask {
        let alpha = packed(&pixels.cells().iter().map(|p| p[3]).collect::<Vec<u8>>())?;
        let mut object = pdf.image_xobject(mask, &alpha);
        object.filter(Filter::FlateDecode);
        object.width(width).height(height).bits_per_component(8).interpolate(false);
        object.color_space().device_gray();
    }
    Ok(id)
}

#[cfg(test)]
mod tests;
