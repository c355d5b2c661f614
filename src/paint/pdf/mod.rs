//! The PDF painter: lines that stay sharp, and words that stay words, in the program's own type.

mod fonts;
mod page;

use std::io::Write as _;
use std::sync::Arc;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use motionscope_core::{Error, Grid};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::Figure;
use page::Page;

/// `figure` as a PDF file of one page, as large as the figure. The same figure gives the same bytes.
///
/// # Errors
/// If a part of it cannot be packed.
pub fn export_pdf(figure: &Figure) -> Result<Vec<u8>, Error> {
    write(figure).map_err(|reason| Error::new(format!("the PDF could not be made: {reason}")))
}

/// Numbers of the objects of a file, one after the other.
struct Numbers(i32);

impl Numbers {
    fn next(&mut self) -> Ref {
        self.0 += 1;
        Ref::new(self.0)
    }
}

fn write(figure: &Figure) -> Result<Vec<u8>, String> {
    let page = Page::of(figure);
    let mut numbers = Numbers(0);
    let [catalog, pages, page_id, contents, info] = [(); 5].map(|()| numbers.next());
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page_id]).count(1);
    let fonts: Vec<(Vec<u8>, Ref)> = page
        .fonts
        .used()
        .map(|font| Ok((font.name(), font.write(&mut pdf, &mut numbers)?)))
        .collect::<Result<_, String>>()?;
    let images: Vec<Ref> =
        page.images.iter().map(|pixels| image(&mut pdf, &mut numbers, pixels)).collect::<Result<_, String>>()?;
    let opacities: Vec<(Vec<u8>, Ref)> =
        page.opacities.iter().map(|alpha| (page::opacity(*alpha), numbers.next())).collect();
    for (alpha, (_, id)) in page.opacities.iter().zip(&opacities) {
        let share = f32::from(*alpha) / 255.0;
        pdf.ext_graphics(*id).non_stroking_alpha(share).stroking_alpha(share);
    }
    let mut sheet = pdf.page(page_id);
    sheet.parent(pages).media_box(Rect::new(0.0, 0.0, figure.size[0], figure.size[1])).contents(contents);
    let mut resources = sheet.resources();
    let mut all = resources.fonts();
    fonts.iter().for_each(|(name, id)| _ = all.pair(Name(name), *id));
    all.finish();
    let mut all = resources.x_objects();
    images.iter().enumerate().for_each(|(i, id)| _ = all.pair(Name(&page::image(i)), *id));
    all.finish();
    let mut all = resources.ext_g_states();
    opacities.iter().for_each(|(name, id)| _ = all.pair(Name(name), *id));
    all.finish();
    resources.finish();
    sheet.finish();
    let packed = packed(&page.content.finish())?;
    pdf.stream(contents, &packed).filter(Filter::FlateDecode);
    let mut about = pdf.document_info(info);
    about.title(TextStr("Motionscope")).subject(TextStr(&figure.description)).creator(TextStr("Motionscope"));
    about.finish();
    Ok(pdf.finish())
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
