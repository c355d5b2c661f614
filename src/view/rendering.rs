//! Rendering of a step as a picture, identical in the window and on the command line.

use std::iter;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::params::{Kind, Spec, Value};
use motionscope_core::run::AnyEstimator;
use motionscope_core::scene::{Readout, Sentence};

use super::look::{CaptionWords, Look};
use super::moment::Moment;
use super::panes::Selection;
use super::tile;
use crate::paint::charts::relief::risen;
use crate::paint::{Caption, Figure, FigureOptions, Part, View};

/// A moment with its view options, ready to be rendered.
#[derive(Clone, Copy)]
pub struct Rendering<'a> {
    /// The moment.
    pub moment: &'a Moment,
    /// The estimator with its parameters.
    pub estimator: &'a dyn AnyEstimator,
    /// The view options.
    pub look: &'a Look,
    /// The panes of the sheet; none for the stage alone.
    pub panes: &'a Selection,
}

/// Zoom, titles and caption of a figure.
pub(super) struct Around {
    /// Points per pixel of the clip.
    pub zoom: f32,
    /// Whether pictures have titles.
    pub titles: bool,
    /// The caption above and below.
    pub caption: Option<Caption>,
}

impl Rendering<'_> {
    /// Returns the view of the step.
    pub(super) fn view(&self) -> View {
        let Self { moment, estimator, look, .. } = *self;
        look.view_of(&moment.pictures, moment.stands(estimator.shows_frame_alone()))
    }

    /// Returns the figure of the step, with the marks that fit at `scale` pixels per point.
    pub(super) fn figure(&self, around: Around, scale: u32) -> Figure {
        let Self { moment, look, panes, .. } = *self;
        let Moment { scene, pictures, .. } = moment;
        let heat = moment.step.readouts.iter().find_map(|readout| match readout {
            Readout::Surface(surface) => Some(surface.title.to_string()),
            _ => None,
        });
        let view = self.view();
        let options = FigureOptions {
            view,
            style: look.style(pictures),
            phase: look.streaks.unwrap_or_default().get(),
            share: look.blend,
            zoom: around.zoom,
            titles: around.titles,
            scale,
            focus: look.focus,
            section: panes.angles.section,
            backdrop: look.backdrop,
            at_end: moment.at_end,
            leaned: look.landscape.then_some(panes.angles.surface),
            frame: Some(moment.frame),
            legend: look.legend,
            heat: heat.or(scene.heat.map(str::to_owned)).unwrap_or_default(),
            caption: around.caption,
            freehand: Arc::clone(&moment.freehand),
        };
        Figure::of(&self.parts(view), scene, &options)
    }

    /// Returns what each estimator shows in `view`.
    pub(super) fn parts(&self, view: View) -> Vec<Part<'_>> {
        let Self { moment, look, .. } = *self;
        let Moment { scene, pictures, tiles, .. } = moment;
        if tiles.is_empty() {
            let pictures = pictures.on_level(scene.levels.as_ref(), look.level, view);
            let rises = look.landscape.then(|| risen(&moment.step, iter::empty())).flatten();
            return vec![Part { pictures, scene, rises, heading: None }];
        }
        let beside = |member: usize| tile::beside(tiles, member).map(|(name, step)| (name, &**step));
        let parts = tiles.iter().enumerate().map(|(member, tile)| Part {
            pictures: tile.pictures(pictures, look.level, view),
            scene: &tile.scene,
            rises: look.landscape.then(|| risen(&tile.step, beside(member))).flatten(),
            heading: Some((&tile.names, tile.is_done, &tile.words)),
        });
        parts.collect()
    }

    pub(super) fn caption(&self) -> Caption {
        let Moment { clip, cursor, step, tiles, .. } = self.moment;
        Caption {
            // Each of several has its name above its own picture.
            title: match tiles.len() {
                0 => self.estimator.info().name.into(),
                count => format!("{count} estimators in lockstep"),
            },
            details: format!("{clip} · {}", settings_text(self.estimator)),
            place: format!("step {cursor}"),
            formula: match self.look.caption {
                CaptionWords::Full => step.formulas().to_vec(),
                CaptionWords::Off | CaptionWords::On => Vec::new(),
            },
            sentence: match tiles.first() {
                Some(tile) => Sentence::default().text(format!("{}: ", tile.names[0])).then(step.sentence.clone()),
                None => step.sentence.clone(),
            },
        }
    }
}

/// Largest number of parameters listed completely; of more, only those that differ from their defaults.
const MOST_SETTINGS: usize = 11;

/// Returns the parameters of an estimator with their values.
fn settings_text(estimator: &dyn AnyEstimator) -> String {
    let specs = estimator.specs();
    let all = specs.iter().zip(estimator.values());
    let chosen = all.filter(|(spec, (_, value))| specs.len() <= MOST_SETTINGS || spec.default != *value);
    let words: Vec<String> = chosen.map(|(spec, (_, value))| said(spec, value)).collect();
    if words.is_empty() { "default parameters".into() } else { words.join(" · ") }
}

/// Returns a parameter with its value: `block 16 px`.
pub fn said(spec: &Spec, value: Value) -> String {
    let shown = match (&spec.kind, value) {
        (Kind::Choice(all), Value::Choice(name)) => {
            all.iter().find(|choice| choice.name == name).map_or(name, |choice| choice.label).to_string()
        }
        (_, Value::Placed(placed)) => placed.words(),
        (_, value) => value.to_string(),
    };
    let unit = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
    format!("{} {shown}{unit}", spec.label.to_lowercase())
}

/// The file format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A bitmap.
    Png,
    /// Vector graphics.
    Svg,
    /// A page of vector graphics with text that can be searched.
    Pdf,
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(ending: &str) -> Result<Self, Error> {
        let all = [Self::Png, Self::Svg, Self::Pdf];
        let refused = || Error::new(format!("the formats of pictures are png, svg and pdf, not {ending}"));
        all.into_iter().find(|format| format.extension() == ending.to_lowercase()).ok_or_else(refused)
    }
}

impl Format {
    /// Returns the format by the extension of `path`; `-` is a PNG.
    ///
    /// # Errors
    /// A sentence with the extensions.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let refused =
            || Error::new(format!("{}: the name of a picture must end in .png, .svg or .pdf", path.display()));
        match extension {
            None if path == Path::new("-") => Ok(Self::Png),
            extension => extension.and_then(|ending| ending.parse().ok()).ok_or_else(refused),
        }
    }

    /// Returns the file extension.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
            Self::Pdf => "pdf",
        }
    }
}
