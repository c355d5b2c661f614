//! Export of a range of steps as numbered pictures, or as one animation.
//!
//! One walk through the range serves all media. For an animation each step is kept as a PNG; `media/export/animation` puts them
//! on one size, blends pictures between them if asked, and writes only the rectangle that changes.

use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::Clip;
use motionscope_core::run::{Cursor, Direction, Move, Walk};

use super::look::Look;
use super::moment::Viewer;
use super::motion::{AvailableLayers, Reverse, Site};
use super::panes::{EXPLANATION, Selection};
use super::rendering::{Format, Rendering};
use super::sheet::Layout;
use super::tile::{self, tiles};
use crate::experiment::Prepared;
use crate::experiment::pixel::Chosen;
use crate::experiment::travel::travel;
use crate::media::export::{AnimationFormat, Reel, Timing};
use crate::media::{Progress, export};
use crate::paint::{FlowLayer, Freehand};
use crate::work;

/// Steps of a run at which a granularity stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// The first step.
    pub from: Cursor,
    /// The last step; beyond the end of the run, its end.
    pub to: Cursor,
    /// The granularity whose stops are shown.
    pub granularity: usize,
}

/// A range of steps to be saved as pictures.
pub struct Steps {
    /// The steps.
    pub range: Range,
    /// Pixels for each pixel of the clip.
    pub scale: u32,
    /// The view options.
    pub look: Look,
    /// The panes of each sheet; none for the stage alone.
    pub panes: Selection,
    /// The pixel that is explained where possible, instead of the current one.
    pub pixel: Option<Chosen>,
    /// Whether a layer that no step has is an error.
    pub must_have_layer: bool,
    /// What was drawn by hand in the run.
    pub freehand: Freehand,
    /// Number of pictures of each step, in which its charts in space turn once; 1 for none that turns.
    pub turntable: u32,
}

/// What a range of steps is saved as.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Medium<'a> {
    /// Numbered pictures in a folder, `step_00000.png` and so on.
    Pictures(&'a Path, Format),
    /// One animation in a file; the ending of its name is the format.
    Animation(&'a Path, Timing),
}

/// The prefix of the file names.
pub const STEP: &str = "step_";

/// The pictures that were saved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Written {
    /// Their number.
    pub count: usize,
    /// The number of pictures without the requested layer, the layer, and why the first has none.
    bare: Option<(usize, FlowLayer, &'static str)>,
    /// Steps per second of an animation whose format cannot play as fast as was asked for.
    slowed_hz: Option<f32>,
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

    /// Returns the number in words.
    pub fn pictures(&self) -> String {
        if self.count == 1 { "1 picture".into() } else { format!("{} pictures", self.count) }
    }

    /// Returns what is not as it was asked for, as the end of a sentence.
    pub fn without(&self) -> String {
        let slowed = self.slowed_hz.map_or_else(String::new, |rate_hz| {
            format!(", at {} steps/s, the most that this format plays", (100.0 * rate_hz).round() / 100.0)
        });
        slowed + &self.without_layer()
    }

    fn without_layer(&self) -> String {
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
    /// Returns the file name of picture number `index`.
    pub fn file_name(index: usize, format: Format) -> String {
        format!("{STEP}{index:05}.{}", format.extension())
    }

    /// Returns the progress at the cursor of `walk`, from 0 to 1.
    fn share(&self, walk: &dyn Walk) -> f32 {
        let place = |cursor: Cursor| cursor.unit as f32 + cursor.event.min(walk.events()) as f32 / walk.events() as f32;
        let (from, to) = (place(self.range.from), place(self.range.to));
        ((place(walk.cursor()) - from) / (to - from).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)
    }

    /// Writes the steps of the run of `prepared`, each file whole or not at all; gives how many. Before the first picture is
    /// painted, `tell` receives their number.
    ///
    /// # Errors
    /// If the estimator never has one of the panes, the run cannot start or breaks off, a pixel that is asked for cannot be
    /// explained at the first step, no step has the layer that they must have, a file cannot be written, or the work was cancelled.
    pub async fn write(
        &self,
        prepared: &Prepared,
        medium: Medium<'_>,
        progress: Option<&dyn Progress>,
        tell: Option<&dyn Fn(usize)>,
    ) -> Result<Written, Error> {
        match medium {
            Medium::Pictures(folder, format) => {
                let save = |rendering: Rendering<'_>, layout: &mut Option<Layout>, index| {
                    let picture = rendering.encode_in(layout, format, self.scale)?;
                    let file = folder.join(Self::file_name(index, format));
                    export::fill_folder(folder, || export::save_result(&file, &picture))
                };
                self.each(prepared, progress, tell, save).await
            }
            Medium::Animation(path, timing) => {
                let format = AnimationFormat::of(path)?;
                let [r, g, b, _] = self.look.theme.chrome().panel.0;
                let played = timing.played(format);
                let mut reel = Reel::new(played, [r, g, b]);
                let painting = progress.map(|progress| Part { progress, from: 0.0, to: PAINTING });
                let painting = painting.as_ref().map(|part| part as &dyn Progress);
                let keep = |rendering: Rendering<'_>, layout: &mut Option<Layout>, _| {
                    reel.push(rendering.encode_in(layout, Format::Png, self.scale)?)
                };
                let mut written = self.each(prepared, painting, tell, keep).await?;
                let encoding = progress.map(|progress| Part { progress, from: PAINTING, to: 1.0 });
                let bytes = reel.encode(format, encoding.as_ref().map(|part| part as &dyn Progress)).await?;
                export::save_result(path, &bytes)?;
                written.slowed_hz = (played != timing).then_some(played.rate_hz);
                Ok(written)
            }
        }
    }

    /// Walks through the steps and hands over each, with the layout that all sheets share and its index.
    async fn each(
        &self,
        prepared: &Prepared,
        progress: Option<&dyn Progress>,
        tell: Option<&dyn Fn(usize)>,
        mut take: impl FnMut(Rendering<'_>, &mut Option<Layout>, usize) -> Result<(), Error>,
    ) -> Result<Written, Error> {
        let Prepared { experiment, clip, .. } = prepared;
        let estimator = &*experiment.estimator;
        self.panes.check(estimator)?;
        let reverse = Reverse::new(estimator, clip, experiment.frame);
        let is_explained = self.panes.panes.contains(&&EXPLANATION);
        let mut viewer = Viewer::new(experiment, clip, &self.look, &reverse)?.with_explanation(is_explained);
        viewer.freehand.clone_from(&self.freehand);
        self.begin(&mut *viewer.walk, progress).await?;
        self.pixel.map(|pixel| pixel.here(&*viewer.walk, clip)).transpose()?;
        let layer = self.look.layer.filter(|layer| *layer != FlowLayer::None);
        if let Some(layer) = layer.filter(|_| self.must_have_layer) {
            self.check_layer(layer, &mut *viewer.walk, clip, progress).await?;
            self.begin(&mut *viewer.walk, progress).await?;
        }
        if let Some(tell) = tell {
            tell(self.count(prepared, progress).await? * self.turntable.max(1) as usize);
        }
        let (mut written, mut layout) = (Written::default(), None);
        while viewer.walk.cursor() <= self.range.to {
            let focus = self.pixel.and_then(|pixel| pixel.on_the_way(&*viewer.walk));
            let moment = viewer.moment(focus)?;
            for number in 0..self.turntable.max(1) {
                let panes = self.panes.turned(number as f32 / self.turntable.max(1) as f32);
                let rendering = Rendering { moment: &moment, estimator, look: &self.look, panes: &panes };
                take(rendering, &mut layout, written.count)?;
                work::breathe().await;
                written.add(layer.and_then(|layer| Some((layer, moment.why_without(layer)?))));
                if progress.is_some_and(|progress| progress.cancelled()) {
                    return Err(cancelled(written.count));
                }
            }
            if let Some(progress) = progress {
                progress.report(self.share(&*viewer.walk));
            }
            if viewer.walk.at_end() {
                break;
            }
            let next = Move::Granularity(self.range.granularity, Direction::Forward);
            go(&mut *viewer.walk, next, written.count, progress).await?;
        }
        viewer.walk.failure().map_or(Ok(written), |failure| Err(failure.clone()))
    }

    /// How many pictures [`Steps::write`] shows, found by going through them without drawing any.
    ///
    /// # Errors
    /// If the run cannot start or ends before the first step, or the work was cancelled.
    pub async fn count(&self, prepared: &Prepared, progress: Option<&dyn Progress>) -> Result<usize, Error> {
        let Prepared { experiment, clip, .. } = prepared;
        let mut walk = experiment.walk(clip)?;
        self.begin(&mut *walk, progress).await?;
        let mut count = 0;
        while walk.cursor() <= self.range.to {
            count += 1;
            if walk.at_end() {
                break;
            }
            go(&mut *walk, Move::Granularity(self.range.granularity, Direction::Forward), 0, progress).await?;
        }
        Ok(count)
    }

    /// Goes to the first stop.
    async fn begin(&self, walk: &mut dyn Walk, progress: Option<&dyn Progress>) -> Result<(), Error> {
        go(walk, Move::To(self.range.from), 0, progress).await?;
        if walk.cursor().unit < self.range.from.unit {
            let short =
                || Error::new(format!("the run ends at {}, before the first step {}", walk.cursor(), self.range.from));
            return Err(walk.failure().cloned().unwrap_or_else(short));
        }
        if self.range.granularity + 1 < walk.info().granularities.len() && walk.cursor().event < walk.events() {
            go(walk, Move::Granularity(self.range.granularity, Direction::Forward), 0, progress).await?;
        }
        Ok(())
    }

    /// Refuses a layer that none of the steps has; looks at the last one before those between, because most have it there.
    async fn check_layer(
        &self,
        layer: FlowLayer,
        walk: &mut dyn Walk,
        clip: &Clip,
        progress: Option<&dyn Progress>,
    ) -> Result<(), Error> {
        let why_not = |walk: &dyn Walk| {
            let scene = tile::scene(walk, None, &tiles(walk, None, &[]));
            AvailableLayers::at(Site { walk, clip, scene: &scene }).why_not(layer)
        };
        let Some(why) = why_not(walk) else { return Ok(()) };
        go(walk, Move::To(self.range.to), 0, progress).await?;
        let at_last = why_not(walk);
        if at_last.is_some() && !layer.is_of_the_end() {
            self.begin(walk, progress).await?;
            while !walk.at_end() && walk.cursor() <= self.range.to {
                if why_not(walk).is_none() {
                    return Ok(());
                }
                go(walk, Move::Granularity(self.range.granularity, Direction::Forward), 0, progress).await?;
            }
        }
        let refused = format!("none of these steps has the layer {}: {why}; choose another --layer", layer.id());
        at_last.map_or(Ok(()), |_| Err(Error::new(refused)))
    }
}

/// The share of the work on an animation after which its pictures are painted.
const PAINTING: f32 = 0.7;

/// A part of a longer computation, which reports its own progress from 0 to 1.
struct Part<'a> {
    progress: &'a dyn Progress,
    from: f32,
    to: f32,
}

impl Progress for Part<'_> {
    fn report(&self, fraction: f32) {
        self.progress.report(self.from + fraction * (self.to - self.from));
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }
}

/// Makes a move of `walk` unless it is cancelled, after so many pictures were `written`.
async fn go(walk: &mut dyn Walk, to: Move, written: usize, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let is_wanted = || !progress.is_some_and(|progress| progress.cancelled());
    if travel(walk, to, &is_wanted).await { Ok(()) } else { Err(cancelled(written)) }
}

fn cancelled(written: usize) -> Error {
    Error::new(format!("saving was cancelled after {written} pictures"))
}
