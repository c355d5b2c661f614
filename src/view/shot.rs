//! A picture of one step: the same pixels for the window and for the command line.

use std::path::Path;
use std::str::FromStr;

use motionscope_core::params::Kind;
use motionscope_core::scene::{Readout, Sentence};
use motionscope_core::{AnyEstimator, Clip, Cursor, Error, Levels, Move, Scene, Spec, Step, Value, Walk, Way};

use crate::experiment::company::Company;
use crate::experiment::pixel::Chosen;
use crate::media::{Progress, export};
use crate::paint::{
    ArrowStyle, Caption, ColorMap, FlowLayer, Lengthen, LevelShown, Opacity, Part, Phase, Pictures, Plate,
    PlateOptions, Share, Style, Theme, View, export_pdf, export_png, export_svg,
};
use crate::view::motion::{Motion, Offer, Reverse, Site, Want};
use crate::view::panes::Selection;
use crate::view::tile::{self, Tile, endings, predicted, tiles};

/// An SVG can be looked at from near: it has the marks of a PNG of this scale.
const SVG_SCALE: u32 = 2;

/// How a step is looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// The view; `None` for what suits the step.
    pub view: Option<View>,
    /// Which level of a pyramid is seen, where the step works on one.
    pub level: LevelShown,
    /// The share of frame t + 1 in a blend.
    pub share: Share,
    /// Colours and sizes.
    pub theme: Theme,
    /// Colours of heat.
    pub colors: ColorMap,
    /// The layer of colours that tells of motion; `None` for what suits the estimator.
    pub layer: Option<FlowLayer>,
    /// How opaque that is; `None` for what suits it.
    pub opacity: Option<Opacity>,
    /// How long displacements are drawn.
    pub lengthen: Lengthen,
    /// From one displacement to the next in px, where there is room; `None` for as many as there is room for.
    pub spacing_px: Option<u16>,
    /// The moment at which streaklines are seen in the place of displacements, a share of a particle's life.
    pub streaks: Option<Phase>,
    /// Whether what the marks mean stands below.
    pub legend: bool,
    /// Whether estimator, parameters and sentence stand around the pictures.
    pub caption: bool,
}

impl Look {
    /// What of motion it wants to see.
    pub fn want(&self) -> Want {
        let Self { layer, opacity, colors, spacing_px, streaks, .. } = *self;
        Want { layer, opacity, colors, streaks: streaks.is_some(), spacing_px }
    }

    /// How `pictures` are drawn.
    pub fn style(&self, pictures: &Pictures) -> Style {
        let Self { theme, colors, lengthen, spacing_px, streaks, .. } = *self;
        let streak_frames = pictures.streaks.as_ref().filter(|_| streaks.is_some()).map(|all| all.life_frames());
        Style { theme, colors, arrows: ArrowStyle { lengthen, spacing_px, streak_frames } }
    }
}

/// What stands around pictures.
pub(super) struct Around {
    /// Points per pixel of the clip.
    pub zoom: f32,
    /// Whether titles stand above them.
    pub titles: bool,
    /// Words above and below.
    pub caption: Option<Caption>,
}

/// A step of a run.
pub struct Moment<'a> {
    /// The estimator with its parameters.
    pub estimator: &'a dyn AnyEstimator,
    /// Frame t.
    pub frame: usize,
    /// Where the run stands.
    pub cursor: Cursor,
    /// Whether that is its end.
    pub at_end: bool,
    /// What the step tells.
    pub step: &'a Step,
    /// What it shows.
    pub scene: &'a Scene,
    /// The frames, and at the end what the run has made of them.
    pub pictures: &'a Pictures,
    /// Each of those that go in lockstep; none where there is but one.
    pub tiles: &'a [Tile],
}

/// Frames `t` and `t + 1` of `clip`, and what their files are called; the last frame stands beside itself.
///
/// # Errors
/// If there is no such frame, or it cannot be decoded.
pub fn pair(clip: &Clip, t: usize) -> Result<Pictures, Error> {
    Ok(Pictures { names: [t, t + 1].map(|frame| clip.frame_name(frame)), ..Pictures::of(clip.pair_or_last(t)?) })
}

/// The pair of frames that was shown last: most steps show the same as the one before.
#[derive(Default)]
pub struct LastPair(Option<(usize, Pictures)>);

impl LastPair {
    /// The frames that the unit at hand of `walk` works on.
    ///
    /// # Errors
    /// As [`pair`].
    pub fn of(&mut self, walk: &dyn Walk, clip: &Clip) -> Result<&Pictures, Error> {
        let t = walk.at_frame();
        let pictures = match self.0.take() {
            Some((frame, pictures)) if frame == t => pictures,
            _ => pair(clip, t)?,
        };
        Ok(&self.0.insert((t, pictures)).1)
    }
}

/// What can be looked at where `walk` stands, which runs on `pair`.
pub fn pictures(walk: &dyn Walk, pair: &Pictures) -> Pictures {
    Pictures { prediction: walk.at_end().then(|| predicted(&walk.output(), pair)).flatten(), ..pair.clone() }
}

/// Everything that a walk shows where it stands.
pub struct Still {
    frame: usize,
    cursor: Cursor,
    at_end: bool,
    step: Step,
    scene: Scene,
    pictures: Pictures,
    tiles: Vec<Tile>,
    offer: Offer,
}

impl Still {
    /// Where `walk` stands, which runs on `pair` of `clip`, with the pixel `focus` explained and what `want` wants to see of
    /// motion.
    ///
    /// # Errors
    /// If what that takes, as the truth or the reverse pair, cannot be had.
    pub fn of(
        (walk, focus): (&dyn Walk, Option<[f32; 2]>),
        (clip, pair): (&Clip, &Pictures),
        want: &Want,
        reverse: &Reverse<'_>,
    ) -> Result<Self, Error> {
        let mut tiles = tiles(walk, focus, &endings(walk, clip, pair));
        let (mut pictures, scene) = (pictures(walk, pair), tile::scene(walk, focus, &tiles));
        let site = Site { walk, clip, scene: &scene };
        let motion = Motion::of(site, want, || reverse.flow().map(Some))?;
        motion.put(&mut pictures, &mut tiles);
        Ok(Self {
            frame: walk.at_frame(),
            cursor: walk.cursor(),
            at_end: walk.at_end(),
            step: walk.step(focus),
            scene,
            pictures,
            tiles,
            offer: motion.offer,
        })
    }

    /// Which layers there are.
    pub fn offer(&self) -> &Offer {
        &self.offer
    }

    /// Why it does not show `layer`, as part of a sentence; `None` if it does.
    pub fn why_without(&self, layer: FlowLayer) -> Option<&'static str> {
        let mut shown = self.pictures.layer.iter().chain(self.tiles.iter().filter_map(|tile| tile.layer.as_ref()));
        let is_shown = shown.any(|tint| tint.kind == layer);
        (!is_shown).then(|| self.offer.why_not(layer).unwrap_or("nothing has moved there yet"))
    }

    /// The pyramid on which the step works, if it does.
    pub fn levels(&self) -> Option<&Levels> {
        tile::levels(&self.scene, &self.tiles)
    }

    /// The step of a run of `estimator`.
    pub fn moment<'a>(&'a self, estimator: &'a dyn AnyEstimator) -> Moment<'a> {
        let Self { frame, cursor, at_end, ref step, ref scene, ref pictures, ref tiles, .. } = *self;
        Moment { estimator, frame, cursor, at_end, step, scene, pictures, tiles }
    }
}

impl Moment<'_> {
    /// The picture of this step as a file; a PNG has `scale` pixels for each pixel of the clip.
    ///
    /// # Errors
    /// If the picture would be larger than can be written.
    pub fn encode(&self, look: &Look, panes: &Selection, format: Format, scale: u32) -> Result<Vec<u8>, Error> {
        match format {
            Format::Png => export_png(&self.picture(look, panes, scale), scale),
            Format::Svg => export_svg(&self.picture(look, panes, SVG_SCALE)).map(String::into_bytes),
            Format::Pdf => export_pdf(&self.picture(look, panes, SVG_SCALE)),
        }
    }

    /// The stage alone, or a sheet of the panes that are selected.
    fn picture(&self, look: &Look, panes: &Selection, scale: u32) -> Plate {
        if !panes.panes.is_empty() {
            return self.sheet(look, panes, scale);
        }
        let caption = look.caption.then(|| self.caption());
        self.plate(look, Around { zoom: 1.0, titles: false, caption }, scale)
    }

    /// How the step is looked at, unless that is chosen: a finished field says all in one picture, and so does a single frame;
    /// a search needs both.
    pub(super) fn view(&self, look: &Look) -> View {
        let is_single = self.estimator.is_of_single_frames();
        let fitting = if self.at_end || is_single { View::Current } else { View::SideBySide };
        let view = look.view.unwrap_or(fitting).or_current(self.pictures);
        if self.tiles.is_empty() { view } else { view.alone(self.at_end) }
    }

    /// The pictures of this step, with the marks that `scale` pixels for each point have room for.
    pub(super) fn plate(&self, look: &Look, around: Around, scale: u32) -> Plate {
        let heat = self.step.readouts.iter().find_map(|readout| match readout {
            Readout::Surface(surface) => Some(surface.title.to_string()),
            _ => None,
        });
        let view = self.view(look);
        let options = PlateOptions {
            view,
            style: look.style(self.pictures),
            phase: look.streaks.unwrap_or_default().get(),
            share: look.share,
            zoom: around.zoom,
            titles: around.titles,
            scale,
            frame: Some(self.frame),
            legend: look.legend,
            heat: heat.or(self.scene.heat.map(str::to_owned)).unwrap_or_default(),
            caption: around.caption,
        };
        if self.tiles.is_empty() {
            let pictures = self.pictures.on_level(self.scene.levels.as_ref(), look.level, view);
            return Plate::new(&pictures, self.scene, &options);
        }
        let parts: Vec<_> = self
            .tiles
            .iter()
            .map(|tile| Part {
                pictures: tile.pictures(self.pictures, look.level, view),
                scene: &tile.scene,
                heading: Some((tile.info.name, tile.is_done, &tile.words)),
            })
            .collect();
        Plate::of(&parts, self.scene, &options)
    }

    pub(super) fn caption(&self) -> Caption {
        Caption {
            // Each of several has its name above its own picture.
            title: match self.tiles.len() {
                0 => self.estimator.info().name.into(),
                count => format!("{count} estimators in lockstep"),
            },
            details: told(self.estimator),
            place: format!("step {}", self.cursor),
            sentence: match self.tiles.first() {
                Some(tile) => {
                    let name = (format!("{}: ", tile.info.name), None);
                    Sentence([vec![name], self.step.sentence.0.clone()].concat())
                }
                None => self.step.sentence.clone(),
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

/// A range of steps to be written as numbered pictures.
pub struct Steps {
    /// The first step.
    pub from: Cursor,
    /// The last step; beyond the end of the run, its end.
    pub to: Cursor,
    /// The rung whose stops are written.
    pub rung: usize,
    /// What they are written as.
    pub format: Format,
    /// Pixels for each pixel of the clip.
    pub scale: u32,
    /// How they look.
    pub look: Look,
    /// The panes that stand on each; none for the stage alone.
    pub panes: Selection,
    /// The pixel that is explained wherever it can be, in the place of the one at work.
    pub pixel: Option<Chosen>,
    /// Whether a layer that none of the steps has is refused.
    pub must_have_layer: bool,
}

/// What the names of all pictures of steps begin with.
pub const STEP: &str = "step_";

/// Pictures of steps that were written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// How many.
    pub count: usize,
    /// How many of them are without the layer that is wanted, which that is, and why the first has none.
    bare: Option<(usize, FlowLayer, &'static str)>,
}

impl Written {
    fn add(&mut self, bare: Option<(FlowLayer, &'static str)>) {
        self.count += 1;
        let before = self.bare.map_or(0, |(count, ..)| count);
        self.bare = self.bare.or(bare.map(|(layer, why)| (0, layer, why)));
        if let Some((count, ..)) = &mut self.bare {
            *count = before + usize::from(bare.is_some());
        }
    }

    /// How many, in words.
    pub fn pictures(&self) -> String {
        if self.count == 1 { "1 picture".into() } else { format!("{} pictures", self.count) }
    }

    /// What is missing in them, as the end of a sentence.
    pub fn without(&self) -> String {
        match self.bare {
            None => String::new(),
            Some((bare, layer, why)) => {
                let of_them = if bare == self.count { String::new() } else { format!("{bare} of them ") };
                format!(", {of_them}without the layer {}: {why}", layer.id())
            }
        }
    }
}

impl Steps {
    /// What picture number `index` is called.
    pub fn file_name(index: usize, format: Format) -> String {
        format!("{STEP}{index:05}.{}", format.extension())
    }

    /// How much of the way from the first step to the last is done where `walk` stands, from 0 to 1.
    fn share(&self, walk: &dyn Walk) -> f32 {
        let place = |cursor: Cursor| cursor.unit as f32 + cursor.event.min(walk.events()) as f32 / walk.events() as f32;
        let (from, to) = (place(self.from), place(self.to));
        ((place(walk.cursor()) - from) / (to - from).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)
    }

    /// Writes `step_00000.png` … into `folder`, each whole or not at all; gives how many.
    ///
    /// # Errors
    /// If the run cannot start or breaks off, a pixel that is asked for cannot be explained at the first step, no step has the
    /// layer that they must have, a file cannot be written, or the work was cancelled.
    pub fn write(
        &self,
        (estimator, company): (&dyn AnyEstimator, &Company),
        clip: &Clip,
        frame: usize,
        folder: &Path,
        progress: Option<&dyn Progress>,
    ) -> Result<Written, Error> {
        self.panes.check(estimator)?;
        let mut walk = company.walk(estimator, clip, frame)?;
        let (mut pairs, reverse) = (LastPair::default(), Reverse::new(estimator, clip, frame));
        self.begin(&mut *walk, progress)?;
        self.pixel.map(|pixel| pixel.here(&*walk, clip)).transpose()?;
        let layer = self.look.layer.filter(|layer| *layer != FlowLayer::None);
        if let Some(layer) = layer.filter(|_| self.must_have_layer) {
            self.check_layer(layer, &mut *walk, clip, progress)?;
            self.begin(&mut *walk, progress)?;
        }
        export::make_folder(folder)?;
        let mut written = Written::default();
        while walk.cursor() <= self.to {
            let pair = pairs.of(&*walk, clip)?;
            let focus = self.pixel.and_then(|pixel| pixel.on_the_way(&*walk));
            let still = Still::of((&*walk, focus), (clip, pair), &self.look.want(), &reverse)?;
            let picture = still.moment(estimator).encode(&self.look, &self.panes, self.format, self.scale)?;
            export::save_result(&folder.join(Self::file_name(written.count, self.format)), &picture)?;
            written.add(layer.and_then(|layer| Some((layer, still.why_without(layer)?))));
            if let Some(progress) = progress {
                progress.report(self.share(&*walk));
            }
            if walk.at_end() {
                break;
            }
            travel(&mut *walk, Move::Rung(self.rung, Way::Forward), written.count, progress)?;
        }
        walk.failure().map_or(Ok(written), |failure| Err(failure.clone()))
    }

    /// Goes to the first stop.
    fn begin(&self, walk: &mut dyn Walk, progress: Option<&dyn Progress>) -> Result<(), Error> {
        travel(walk, Move::To(self.from), 0, progress)?;
        if walk.cursor().unit < self.from.unit {
            let short =
                || Error::new(format!("the run ends at {}, before the first step {}", walk.cursor(), self.from));
            return Err(walk.failure().cloned().unwrap_or_else(short));
        }
        if self.rung + 1 < walk.info().rungs.len() && walk.cursor().event < walk.events() {
            travel(walk, Move::Rung(self.rung, Way::Forward), 0, progress)?;
        }
        Ok(())
    }

    /// Refuses a layer that none of the steps has; looks at the last one before those between, because most have it there.
    fn check_layer(
        &self,
        layer: FlowLayer,
        walk: &mut dyn Walk,
        clip: &Clip,
        progress: Option<&dyn Progress>,
    ) -> Result<(), Error> {
        let why_not = |walk: &dyn Walk| {
            let scene = tile::scene(walk, None, &tiles(walk, None, &[]));
            Offer::at(Site { walk, clip, scene: &scene }).why_not(layer)
        };
        let Some(why) = why_not(walk) else { return Ok(()) };
        travel(walk, Move::To(self.to), 0, progress)?;
        let at_last = why_not(walk);
        if at_last.is_some() && !layer.is_of_the_end() {
            self.begin(walk, progress)?;
            while !walk.at_end() && walk.cursor() <= self.to {
                if why_not(walk).is_none() {
                    return Ok(());
                }
                travel(walk, Move::Rung(self.rung, Way::Forward), 0, progress)?;
            }
        }
        let refused = format!("none of these steps has the layer {}: {why}; choose another --layer", layer.id());
        at_last.map_or(Ok(()), |_| Err(Error::new(refused)))
    }
}

/// Makes a move of `walk` unless it is cancelled, after so many pictures were `written`.
fn travel(walk: &mut dyn Walk, to: Move, written: usize, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let cancelled = || progress.is_some_and(|progress| progress.cancelled());
    walk.go(to);
    while !cancelled() {
        if walk.work(&mut || !cancelled()) {
            return Ok(());
        }
    }
    Err(Error::new(format!("writing was cancelled after {written} pictures")))
}

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels.
    Png,
    /// Lines that stay sharp at any size.
    Svg,
    /// A page with lines that stay sharp and words that stay words.
    Pdf,
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(ending: &str) -> Result<Self, Error> {
        let all = [Self::Png, Self::Svg, Self::Pdf];
        let told = || Error::new(format!("a picture is written as png, svg or pdf, and not {ending}"));
        all.into_iter().find(|format| format.extension() == ending.to_lowercase()).ok_or_else(told)
    }
}

impl Format {
    /// The format that the ending of `path` asks for; `-` is a PNG.
    ///
    /// # Errors
    /// A sentence that tells which endings there are.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let told = || Error::new(format!("{}: a picture is written as .png, .svg or .pdf", path.display()));
        match extension {
            None if path == Path::new("-") => Ok(Self::Png),
            extension => extension.and_then(|ending| ending.parse().ok()).ok_or_else(told),
        }
    }

    /// The ending of a file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
            Self::Pdf => "pdf",
        }
    }
}
