//! The three themes: how each role is inked, and the colours and sizes of everything around the pictures.
//!
//! `Theme::ink` is a role over footage, with a halo, `Theme::stroke` the same for lines and points on a panel, `Theme::word`
//! for words. Tests measure each against its ground, also as dichromats see it, and require that two roles differ in dash,
//! shape or colour. Marks of an identity have its colour (`Mark::of`), as have its entries in legend and table.

use motionscope_core::scene::Role;

use super::Color;

/// A look of the whole program. The window and the exported pictures share it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Theme {
    /// Quiet and dark: footage stands out.
    #[default]
    Dark,
    /// As carefully made, for bright rooms and for paper.
    Light,
    /// For the last row: large type, thick lines, nothing but black and white around the picture.
    Projector,
}

/// How a role is drawn. Lengths are in points, whatever the zoom of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    /// Colour of lines, points and arrows over footage.
    pub color: Color,
    /// Colour of the thin rim that sets a mark off from any footage.
    pub halo: Color,
    /// Width of that rim on either side.
    pub halo_width: f32,
    /// What closed shapes are filled with; clear for most roles, so that pixels stay visible.
    pub fill: Color,
    /// Width of lines.
    pub width: f32,
    /// Lengths of dashes and gaps in turn; empty for a solid line.
    pub dash: &'static [f32],
    /// What a point looks like.
    pub point: PointShape,
}

/// What a point looks like, so that its role can be told without its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PointShape {
    /// A filled disc.
    Disc,
    /// A circle.
    Ring,
    /// An upright cross, +.
    Plus,
    /// A diagonal cross, ×.
    Cross,
    /// A filled square on its side.
    Square,
    /// A filled square on its corner.
    Diamond,
    /// A filled triangle.
    Triangle,
}

/// Colours around the pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chrome {
    /// Behind pictures and between panels.
    pub background: Color,
    /// Panels, and the paper of an exported figure.
    pub panel: Color,
    /// Buttons, fields and whatever lies on a panel.
    pub raised: Color,
    /// The same under the pointer.
    pub hovered: Color,
    /// Thin lines between things.
    pub line: Color,
    /// Words.
    pub text: Color,
    /// Words that matter less; still at a contrast of 4.5 or more.
    pub dim: Color,
    /// The one colour of the chrome: what is selected, playing or in focus.
    pub accent: Color,
    /// Words on the accent.
    pub on_accent: Color,
    /// Behind selected words and the lit line of the pseudocode.
    pub selection: Color,
    /// Words of an error.
    pub error: Color,
}

/// Sizes of type in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypeSizes {
    /// Labels and units.
    pub small: f32,
    /// Sentences and values.
    pub body: f32,
    /// Headings.
    pub heading: f32,
    /// Pseudocode.
    pub mono: f32,
}

const SKY_BLUE: Color = Color::hex(0x56_b4e9);
const YELLOW: Color = Color::hex(0xf0_e442);
const BLUISH_GREEN: Color = Color::hex(0x00_9e73);
const ORANGE: Color = Color::hex(0xe6_9f00);
const REDDISH_PURPLE: Color = Color::hex(0xcc_79a7);
const VERMILION: Color = Color::hex(0xd5_5e00);
const GRAY: Color = Color::hex(0x9a_9a9a);

impl Theme {
    /// Every theme.
    pub const ALL: [Theme; 3] = [Theme::Dark, Theme::Light, Theme::Projector];

    /// Stable name, for sessions and the command line.
    pub const fn id(self) -> &'static str {
        match self {
            Theme::Dark => "dark",
            Theme::Light => "light",
            Theme::Projector => "projector",
        }
    }

    /// Name as shown.
    pub const fn name(self) -> &'static str {
        match self {
            Theme::Dark => "Dark",
            Theme::Light => "Light",
            Theme::Projector => "Projector",
        }
    }

    /// What it is for, in one sentence.
    pub const fn tip(self) -> &'static str {
        match self {
            Theme::Dark => "Light on dark, for the control.",
            Theme::Light => "Dark on light, for print and bright rooms.",
            Theme::Projector => {
                "Large type and thick lines, for the last row; what is not shown to a class is folded away."
            }
        }
    }

    /// How `role` is drawn: colours after Okabe and Ito, and a line style and a point shape of its own.
    pub fn ink(self, role: Role) -> Ink {
        const SOLID: &[f32] = &[];
        // Paper swaps the two inks that have no hue of their own.
        let (strong, behind) =
            if self == Theme::Light { (Color::BLACK, Color::WHITE) } else { (Color::WHITE, Color::BLACK) };
        let (color, width, dash, point): (_, _, &'static [f32], _) = match role {
            Role::Reference => (SKY_BLUE, 2.0, SOLID, PointShape::Square),
            Role::Window => (strong, 1.5, &[6.0, 4.0], PointShape::Square),
            Role::Candidate => (YELLOW, 2.0, SOLID, PointShape::Ring),
            Role::Rejected => (GRAY, 1.0, SOLID, PointShape::Cross),
            Role::Best => (BLUISH_GREEN, 3.0, SOLID, PointShape::Disc),
            Role::Result => (ORANGE, 2.0, SOLID, PointShape::Disc),
            Role::Predicted => (REDDISH_PURPLE, 2.0, &[5.0, 3.0], PointShape::Ring),
            // What is measured and what is tentative or under test have one colour: a frame tells them by its dashes.
            Role::Measured => (YELLOW, 2.0, &[3.0, 2.0], PointShape::Plus),
            Role::Estimate => (BLUISH_GREEN, 2.0, SOLID, PointShape::Diamond),
            Role::Truth => (Color::WHITE, 2.0, &[2.0, 3.0], PointShape::Ring),
            Role::Error => (VERMILION, 2.0, &[10.0, 3.0, 2.0, 3.0], PointShape::Triangle),
        };
        let halo = match role {
            Role::Window => behind,
            _ => Color::BLACK,
        };
        let fill = match role {
            Role::Predicted | Role::Estimate => color.alpha(0x28),
            _ => color.alpha(0),
        };
        let thick = if self == Theme::Projector { 1.6 } else { 1.0 };
        Ink { color, halo, halo_width: thick, fill, width: width * thick, dash, point }
    }

    /// The role's colour for words on a panel: moved towards the text's until it can be read there.
    pub fn word(self, role: Role) -> Color {
        self.on_panel(role, 4.5)
    }

    /// The role's colour for lines and points on a panel, where no halo sets them off.
    pub fn stroke(self, role: Role) -> Color {
        // With the contrast of the others, the orange of results would be the yellow of candidates to the colour-blind on paper.
        self.on_panel(role, if role == Role::Result { 5.5 } else { 3.5 })
    }

    fn on_panel(self, role: Role, contrast: f32) -> Color {
        let Chrome { panel, text, .. } = self.chrome();
        let color = match role {
            Role::Truth | Role::Window => text,
            _ => self.ink(role).color,
        };
        color.legible_on(panel, contrast)
    }

    /// Colours around the pictures.
    pub fn chrome(self) -> Chrome {
        match self {
            Theme::Dark => Chrome {
                background: Color::hex(0x10_1214),
                panel: Color::hex(0x18_1b1f),
                raised: Color::hex(0x24_282e),
                hovered: Color::hex(0x2f_343c),
                line: Color::hex(0x2c_3138),
                text: Color::hex(0xe6_e9ed),
                dim: Color::hex(0x9a_a2ad),
                accent: Color::hex(0x8c_9eff),
                on_accent: Color::hex(0x10_1214),
                selection: Color::hex(0x2c_3360),
                error: Color::hex(0xff_8a65),
            },
            Theme::Light => Chrome {
                background: Color::hex(0xe9_ebee),
                panel: Color::hex(0xfb_fbfc),
                raised: Color::hex(0xee_f0f3),
                hovered: Color::hex(0xe2_e5ea),
                line: Color::hex(0xd5_d9df),
                text: Color::hex(0x1b_1f24),
                dim: Color::hex(0x5c_6570),
                accent: Color::hex(0x3d_4ec9),
                on_accent: Color::WHITE,
                selection: Color::hex(0xdb_e0ff),
                error: Color::hex(0xb3_3c00),
            },
            Theme::Projector => Chrome {
                background: Color::BLACK,
                panel: Color::BLACK,
                raised: Color::hex(0x26_2626),
                hovered: Color::hex(0x3a_3a3a),
                line: Color::hex(0x5a_5a5a),
                text: Color::WHITE,
                dim: Color::hex(0xd0_d0d0),
                accent: Color::hex(0xb3_beff),
                on_accent: Color::BLACK,
                selection: Color::hex(0x37_4080),
                error: Color::hex(0xff_a184),
            },
        }
    }

    /// Sizes of type.
    pub fn sizes(self) -> TypeSizes {
        match self {
            Theme::Dark | Theme::Light => TypeSizes { small: 12.0, body: 14.0, heading: 16.0, mono: 13.0 },
            Theme::Projector => TypeSizes { small: 18.0, body: 21.0, heading: 24.0, mono: 20.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::color::Vision;
    use super::*;

    #[test]
    fn every_role_can_be_told_without_its_color() {
        for theme in Theme::ALL {
            let mut styles: Vec<_> = Role::ALL.map(|role| theme.ink(role)).to_vec();
            while let Some(ink) = styles.pop() {
                let twin = styles
                    .iter()
                    .find(|other| (other.dash, other.width, other.point) == (ink.dash, ink.width, ink.point));
                assert!(twin.is_none(), "{ink:?} and {twin:?} print alike");
            }
        }
    }

    #[test]
    fn frames_of_two_roles_never_look_alike() {
        for theme in Theme::ALL {
            for (i, role) in Role::ALL.into_iter().enumerate() {
                for other in &Role::ALL[..i] {
                    let [a, b] = [role, *other].map(|role| theme.ink(role));
                    assert!(
                        (a.color, a.dash, a.width, a.fill) != (b.color, b.dash, b.width, b.fill),
                        "{role:?} {other:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn words_can_be_read_in_every_theme() {
        for theme in Theme::ALL {
            let chrome = theme.chrome();
            let pairs = [
                (chrome.text, chrome.panel, 12.0),
                (chrome.text, chrome.hovered, 7.0),
                (chrome.text, chrome.selection, 7.0),
                (chrome.dim, chrome.panel, 4.5),
                (chrome.dim, chrome.raised, 4.5),
                (chrome.error, chrome.panel, 4.5),
                (chrome.accent, chrome.panel, 4.5),
                (chrome.on_accent, chrome.accent, 4.5),
            ];
            for (front, back, least) in pairs {
                assert!(front.contrast(back) >= least, "{theme:?}: {front:?} on {back:?} is {}", front.contrast(back));
            }
            for role in Role::ALL {
                assert!(theme.word(role).contrast(chrome.panel) >= 4.5, "{theme:?} {role:?}");
            }
        }
    }

    const VISIONS: [Vision; 3] = [Vision::Usual, Vision::Protanopia, Vision::Deuteranopia];

    #[test]
    fn every_role_stands_off_its_ground_however_colors_are_seen() {
        let footage = [0x10, 0x77, 0xf0].map(Color::gray);
        for (theme, vision) in Theme::ALL.into_iter().flat_map(|theme| VISIONS.map(|vision| (theme, vision))) {
            let panel = theme.chrome().panel;
            for role in Role::ALL {
                let contrast = |front: Color, ground: Color| front.seen_with(vision).contrast(ground.seen_with(vision));
                let on_panel = [theme.stroke(role), theme.word(role)].map(|color| contrast(color, panel));
                assert!(on_panel.iter().all(|found| *found >= 3.0), "{theme:?} {vision:?} {role:?}: {on_panel:?}");
                let Ink { color, halo, .. } = theme.ink(role);
                for ground in footage {
                    let best = contrast(color, ground).max(contrast(halo, ground));
                    assert!(best >= 3.0, "{theme:?} {vision:?} {role:?} over {ground:?}: {best}");
                }
            }
        }
    }

    /// Whether two colours are told apart at a glance: some three times what is just noticeable.
    fn are_apart(a: Color, b: Color, vision: Vision) -> bool {
        let [a, b] = [a, b].map(|color| color.seen_with(vision).lab());
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt() >= 8.0
    }

    #[test]
    fn two_roles_differ_in_a_dash_a_shape_or_a_color_that_everyone_sees() {
        for (theme, vision) in Theme::ALL.into_iter().flat_map(|theme| VISIONS.map(|vision| (theme, vision))) {
            for (i, role) in Role::ALL.into_iter().enumerate() {
                for other in Role::ALL.into_iter().take(i) {
                    let [a, b] = [role, other].map(|role| theme.ink(role));
                    let of_footage = are_apart(a.color, b.color, vision);
                    let of_panel = are_apart(theme.stroke(role), theme.stroke(other), vision);
                    let what = format!("{theme:?} {vision:?} {role:?} {other:?}");
                    assert!(a.point != b.point || of_footage && of_panel, "points: {what}");
                    let is_line_told = a.dash != b.dash || a.width != b.width || a.fill != b.fill;
                    assert!(is_line_told || of_footage && of_panel, "lines: {what}");
                }
            }
        }
    }

    #[test]
    fn a_halo_contrasts_with_its_mark() {
        for theme in Theme::ALL {
            for role in Role::ALL {
                let ink = theme.ink(role);
                assert!(ink.color.contrast(ink.halo) >= 4.5, "{theme:?} {role:?}: {}", ink.color.contrast(ink.halo));
            }
        }
    }
}
