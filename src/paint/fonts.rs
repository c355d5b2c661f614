//! The program's type: Inter with digits of one width, and JetBrains Mono for pseudocode.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId};

use super::script::{self, Script};

/// A face of the program's type.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Face {
    /// Inter: nearly everything.
    #[default]
    Sans,
    /// Inter SemiBold: headings.
    Bold,
    /// Inter Italic: variables.
    Italic,
    /// JetBrains Mono: pseudocode, and characters that Inter lacks.
    Mono,
}

impl Face {
    /// Every face.
    pub const ALL: [Face; 4] = [Face::Sans, Face::Bold, Face::Italic, Face::Mono];

    /// Its family name.
    pub fn family(self) -> &'static str {
        match self {
            Face::Sans | Face::Bold | Face::Italic => "Inter",
            Face::Mono => "JetBrains Mono",
        }
    }

    /// The font file.
    pub fn bytes(self) -> &'static [u8] {
        // Each is in the program once, wherever this is inlined.
        static FILES: [&[u8]; 4] = [
            include_bytes!("../../assets/fonts/Inter-Regular.otf"),
            include_bytes!("../../assets/fonts/Inter-SemiBold.otf"),
            include_bytes!("../../assets/fonts/Inter-Italic.otf"),
            include_bytes!("../../assets/fonts/JetBrainsMono-Regular.ttf"),
        ];
        FILES[self as usize]
    }

    pub(crate) fn font(self) -> Option<&'static FontRef<'static>> {
        static FONTS: LazyLock<[Option<FontRef<'static>>; 4]> =
            LazyLock::new(|| Face::ALL.map(|face| FontRef::try_from_slice(face.bytes()).ok()));
        FONTS[self as usize].as_ref()
    }

    /// The face that has `c`: this one, else Mono, else Sans.
    fn with(self, c: char) -> Face {
        let has = |face: &Face| face.font().is_some_and(|font| font.glyph_id(c).0 != 0);
        [self, Face::Mono, Face::Sans].into_iter().find(has).unwrap_or(self)
    }
}

/// One character of a line of text, placed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub face: Face,
    pub glyph: GlyphId,
    /// The character that it stands for.
    pub c: char,
    /// Left edge, from the start of the line, in points.
    pub x: f32,
    /// How far it stands above the baseline, in points.
    pub rise: f32,
    /// Size of its type in points.
    pub size: f32,
    /// Size of an em's unit in points.
    pub unit: f32,
}

/// The characters of `text` in `face` at `size` points, subscripts and superscripts among them, and where the line ends.
pub(crate) fn place(text: &str, face: Face, size: f32) -> (Vec<Placed>, f32) {
    let (mut line, mut x) = (Vec::new(), 0.0);
    for (words, script) in script::parts(text) {
        if script == Script::Over {
            line.extend(over(words, line.last(), (face, size)));
            continue;
        }
        let (size, rise) = (script.share() * size, script.rise() * size);
        let mut before: Option<(Face, GlyphId)> = None;
        for c in words.chars() {
            let face = face.with(c);
            let Some(font) = face.font() else { continue };
            let glyph = font.glyph_id(c);
            let unit = size / font.units_per_em().unwrap_or(1000.0);
            if let Some((_, last)) = before.replace((face, glyph)).filter(|(last, _)| *last == face) {
                x += font.kern_unscaled(last, glyph) * unit;
            }
            line.push(Placed { face, glyph, c, x, rise, size, unit });
            x += font.h_advance_unscaled(glyph) * unit;
        }
    }
    (line, x)
}

/// A sign in the middle over the character `below`.
fn over(sign: &str, below: Option<&Placed>, (face, size): (Face, f32)) -> Option<Placed> {
    let (below, c) = (below?, sign.chars().next()?);
    let face = face.with(c);
    let (font, lower) = (face.font()?, below.face.font()?);
    let (glyph, unit) = (font.glyph_id(c), size / font.units_per_em().unwrap_or(1000.0));
    let x =
        below.x + (lower.h_advance_unscaled(below.glyph) * below.unit - font.h_advance_unscaled(glyph) * unit) / 2.0;
    Some(Placed { face, glyph, c, x, rise: 0.0, size, unit })
}

/// Width of `text` in points.
pub fn width(text: &str, face: Face, size: f32) -> f32 {
    place(text, face, size).1
}

/// The characters of `text` that no font has.
#[cfg(test)]
pub fn missing(text: &str, face: Face, size: f32) -> String {
    place(text, face, size).0.into_iter().filter(|placed| placed.glyph.0 == 0).map(|placed| placed.c).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_face_loads_and_is_small() {
        for face in Face::ALL {
            assert!(face.font().is_some(), "{face:?}");
            assert!(face.bytes().len() < 200_000, "{face:?}");
        }
    }

    #[test]
    fn the_characters_that_are_shown_exist() {
        for c in "ÄÖÜäöüßéèΣΔσαβθ−×÷±√∇≤≥≠≈∞·…→←↑↓₁₂²|–—‹›°▸".chars()
        {
            let face = Face::Sans.with(c);
            assert!(face.font().is_some_and(|font| font.glyph_id(c).0 != 0), "{c}");
        }
    }

    #[test]
    fn what_estimators_say_of_themselves_can_be_written() {
        for estimator in motionscope_core::course::estimators() {
            let info = estimator.info();
            let words =
                [info.name, info.summary, info.source].into_iter().chain(info.pseudocode.iter().map(|line| line.text));
            let docs = estimator.specs().iter().map(|spec| spec.doc.as_str());
            for c in words.chain(docs).flat_map(str::chars) {
                // Drawn as a macron.
                let c = if c == script::MEAN { '¯' } else { c };
                for face in [Face::Sans, Face::Mono].map(|face| face.with(c)) {
                    assert!(face.font().is_some_and(|font| font.glyph_id(c).0 != 0), "{}: {c}", info.id);
                }
            }
        }
    }

    #[test]
    fn the_glossary_can_be_written() {
        for term in motionscope_core::course::glossary::GLOSSARY.iter() {
            let words = [term.name, term.definition, term.symbol.unwrap_or_default()];
            for c in words.into_iter().flat_map(str::chars) {
                assert!(Face::Sans.with(c).font().is_some_and(|font| font.glyph_id(c).0 != 0), "{}: {c}", term.name);
            }
        }
    }

    #[test]
    fn digits_have_one_width_and_pairs_are_kerned() {
        for face in Face::ALL {
            let one = width("1", face, 14.0);
            assert!("023456789".chars().all(|c| width(&c.to_string(), face, 14.0) == one), "{face:?}");
            assert!(width("1471", face, 14.0) - 4.0 * one < 0.01);
        }
        assert!(width("AV", Face::Sans, 14.0) < width("A", Face::Sans, 14.0) + width("V", Face::Sans, 14.0));
    }
}
