//! A picture of one step: the same pixels for the window and for the command line.

use std::path::Path;

use motionscope_core::params::Kind;
use motionscope_core::scene::{Readout, Sentence};
use motionscope_core::{AnyEstimator, Error, Spec, Value};

use super::look::Look;
use super::moment::Moment;
use crate::paint::{Caption, Part, Plate, PlateOptions, export_png, export_svg};

/// An SVG can be looked at from near: it has the marks of a PNG of this scale.
const SVG_SCALE: u32 = 2;

/// A moment that is made into a picture.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    /// What is shown.
    pub moment: &'a Moment,
    /// The estimator with its parameters.
    pub estimator: &'a dyn AnyEstimator,
    /// How it looks.
    pub look: &'a Look,
}

impl Shot<'_> {
    /// The picture as a file; a PNG has `scale` pixels for each pixel of the clip.
    ///
    /// # Errors
    /// If the picture would be larger than can be written.
    pub fn encode(&self, format: Format, scale: u32) -> Result<Vec<u8>, Error> {
        match format {
            Format::Png => export_png(&self.plate(scale), scale),
            Format::Svg => export_svg(&self.plate(SVG_SCALE)).map(String::into_bytes),
        }
    }

    /// The picture, with the marks that `scale` pixels for each pixel of the clip have room for.
    fn plate(&self, scale: u32) -> Plate {
        let Self { moment, look, .. } = *self;
        let Moment { scene, pictures, tiles, .. } = moment;
        let heat = moment.step.readouts.iter().find_map(|readout| match readout {
            Readout::Surface(surface) => Some(surface.title.to_string()),
            _ => None,
        });
        let view = moment.view(look, self.estimator.is_of_single_frames());
        let options = PlateOptions {
            view,
            style: look.style(pictures),
            phase: look.streaks.unwrap_or_default().get(),
            share: look.blend,
            zoom: 1,
            scale,
            frame: Some(moment.frame),
            legend: look.legend,
            heat: heat.or(scene.heat.map(str::to_owned)).unwrap_or_default(),
            caption: look.caption.then(|| self.caption()),
        };
        if tiles.is_empty() {
            let pictures = pictures.on_level(scene.levels.as_ref(), look.level, view);
            return Plate::new(&pictures, scene, &options);
        }
        let parts = tiles.iter().map(|tile| Part {
            pictures: tile.pictures(pictures, look.level, view),
            scene: &tile.scene,
            heading: Some((tile.info.name, tile.is_done, &tile.words)),
        });
        Plate::of(&parts.collect::<Vec<_>>(), scene, &options)
    }

    fn caption(&self) -> Caption {
        let Moment { cursor, step, tiles, .. } = self.moment;
        Caption {
            // Each of several has its name above its own picture.
            title: match tiles.len() {
                0 => self.estimator.info().name.into(),
                count => format!("{count} estimators in lockstep"),
            },
            details: told(self.estimator),
            place: format!("step {cursor}"),
            sentence: match tiles.first() {
                Some(tile) => {
                    let name = (format!("{}: ", tile.info.name), None);
                    Sentence([vec![name], step.sentence.0.clone()].concat())
                }
                None => step.sentence.clone(),
            },
        }
    }
}

/// So many parameters are told all; of more only those that are not as declared.
const ALL_TOLD: usize = 11;

/// The parameters of an estimator with their values.
fn told(estimator: &dyn AnyEstimator) -> String {
    let specs = estimator.specs();
    let all = specs.iter().zip(estimator.values());
    let chosen = all.filter(|(spec, (_, value))| specs.len() <= ALL_TOLD || spec.default != *value);
    let words: Vec<String> = chosen.map(|(spec, (_, value))| said(spec, value)).collect();
    if words.is_empty() { "parameters as they are at first".into() } else { words.join(" · ") }
}

/// A parameter with its value: `block 16 px`.
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

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels.
    Png,
    /// Lines that stay sharp at any size.
    Svg,
}

impl Format {
    /// The format that the ending of `path` asks for; `-` is a PNG.
    ///
    /// # Errors
    /// A sentence that tells which endings there are.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("svg") => Ok(Self::Svg),
            None if path == Path::new("-") => Ok(Self::Png),
            _ => Err(Error::new(format!("{}: a picture is written as .png or .svg", path.display()))),
        }
    }

    /// The ending of a file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }
}
