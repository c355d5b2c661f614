//! The program's type inside a PDF: of each face the letters that are used, and which characters they stand for.

use std::collections::BTreeMap;

use ab_glyph::{Font as _, GlyphId};
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use subsetter::GlyphRemapper;

use super::super::Face;
use super::{Numbers, packed};

/// Numbers of letters are their places in the font.
const IDENTITY: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// All faces.
#[derive(Default)]
pub struct Fonts(BTreeMap<Face, Font>);

impl Fonts {
    /// A face, which is used from now on.
    pub fn get(&mut self, face: Face) -> &mut Font {
        self.0.entry(face).or_insert_with(|| Font::new(face))
    }

    /// Those that are used.
    pub fn used(&self) -> impl Iterator<Item = &Font> {
        self.0.values()
    }
}

/// A face, as far as it is used.
pub struct Font {
    face: Face,
    letters: GlyphRemapper,
    /// The characters, by their numbers in the file.
    characters: BTreeMap<u16, char>,
    /// The widths in thousandths of the size, by the same numbers.
    widths: BTreeMap<u16, f32>,
}

impl Font {
    fn new(face: Face) -> Self {
        Self { face, letters: GlyphRemapper::new(), characters: BTreeMap::new(), widths: BTreeMap::new() }
    }

    /// What the face is called on the page.
    pub fn name(&self) -> Vec<u8> {
        format!("F{}", self.face as usize).into_bytes()
    }

    /// The number of a glyph in the file, and its width in thousandths of the size.
    pub fn letter(&mut self, glyph: u16, character: char) -> (u16, f32) {
        let id = self.letters.remap(glyph);
        let width = self.face.font().map_or(0.0, |font| {
            font.h_advance_unscaled(GlyphId(glyph)) / font.units_per_em().unwrap_or(1000.0) * 1000.0
        });
        self.characters.insert(id, character);
        self.widths.insert(id, width);
        (id, width)
    }

    /// Writes the face.
    pub fn write(&self, pdf: &mut Pdf, numbers: &mut Numbers) -> Result<Ref, String> {
        let [whole, letters, descriptor, file, characters] = [(); 5].map(|()| numbers.next());
        // Part of a face begins with six capital letters.
        let name = format!("MOTION+{}-{:?}", self.face.family().replace(' ', ""), self.face);
        let subset = subsetter::subset(self.face.bytes(), 0, &self.letters).map_err(|error| error.to_string())?;
        let outlines = table(&subset, *b"CFF ");
        let mut font = pdf.type0_font(whole);
        font.base_font(Name(name.as_bytes())).encoding_predefined(Name(b"Identity-H"));
        font.descendant_font(letters).to_unicode(characters);
        font.finish();
        let kind = if outlines.is_some() { CidFontType::Type0 } else { CidFontType::Type2 };
        let mut font = pdf.cid_font(letters);
        font.subtype(kind).base_font(Name(name.as_bytes())).system_info(IDENTITY).font_descriptor(descriptor);
        font.default_width(0.0);
        if kind == CidFontType::Type2 {
            font.cid_to_gid_map_predefined(Name(b"Identity"));
        }
        let mut widths = font.widths();
        self.widths.iter().for_each(|(id, width)| _ = widths.same(*id, *id, *width));
        widths.finish();
        font.finish();
        self.describe(pdf, (descriptor, file), &name, outlines.is_some());
        let packed_file = packed(outlines.unwrap_or(&subset))?;
        let mut stream = pdf.stream(file, &packed_file);
        stream.filter(Filter::FlateDecode);
        if outlines.is_some() {
            stream.pair(Name(b"Subtype"), Name(b"CIDFontType0C"));
        }
        stream.finish();
        let mut map = UnicodeCmap::<u16>::new(Name(b"Characters"), IDENTITY);
        self.characters.iter().for_each(|(id, character)| map.pair(*id, *character));
        let map = packed(&map.finish())?;
        pdf.stream(characters, &map).filter(Filter::FlateDecode);
        Ok(whole)
    }

    fn describe(&self, pdf: &mut Pdf, (descriptor, file): (Ref, Ref), name: &str, has_curves: bool) {
        let slant = if self.face == Face::Italic { -9.4 } else { 0.0 };
        let mut flags = FontFlags::SYMBOLIC;
        flags.set(FontFlags::FIXED_PITCH, self.face == Face::Mono);
        flags.set(FontFlags::ITALIC, self.face == Face::Italic);
        let mut about = pdf.font_descriptor(descriptor);
        about.name(Name(name.as_bytes())).flags(flags).bbox(Rect::new(-750.0, -300.0, 2600.0, 1100.0));
        about.italic_angle(slant).ascent(969.0).descent(-242.0).cap_height(727.0).stem_v(80.0);
        match has_curves {
            true => about.font_file3(file),
            false => about.font_file2(file),
        };
    }
}

/// A table of a font file.
fn table(font: &[u8], tag: [u8; 4]) -> Option<&[u8]> {
    let number = |at: usize| Some(u32::from_be_bytes(font.get(at..at + 4)?.try_into().ok()?) as usize);
    let count = number(4)? >> 16;
    let entry = (0..count).map(|i| 12 + 16 * i).find(|at| font.get(*at..at + 4) == Some(&tag))?;
    let (from, length) = (number(entry + 8)?, number(entry + 12)?);
    font.get(from..from.checked_add(length)?)
}
