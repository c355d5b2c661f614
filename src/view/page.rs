//! The page of a lesson as a picture: its words beside the step that they explain.

use motionscope_core::base::Error;
use motionscope_core::run::{AnyEstimator, Cursor, Move};
use motionscope_core::scene::Focus;

use super::look::Look;
use super::moment::Viewer;
use super::motion::Reverse;
use super::panes::{STAGE, Selection, charts};
use super::rendering::{Format, Rendering};
use crate::experiment::Prepared;
use crate::experiment::pixel::Chosen;
use crate::experiment::travel::travel;
use crate::media::Progress;
use crate::paint::charts::prose::{Prose, lay_out};
use crate::paint::charts::{Canvas, Level, Type};
use crate::paint::primitive::{Anchor, Point};
use crate::paint::{Face, Figure, Freehand, Layer, Theme};

/// Width of the words in points, and what is left around them.
const WIDTH: f32 = 380.0;
const MARGIN: f32 = 20.0;
/// Size of their type in points.
const TYPE_PT: f32 = 17.0;

/// The words of a page.
#[derive(Clone, Copy)]
pub struct Words<'a> {
    /// The title of the lesson.
    pub lesson: &'a str,
    /// The title of the page.
    pub title: &'a str,
    /// The number of the page, from 1, and how many there are.
    pub number: [usize; 2],
    /// What it says.
    pub prose: &'a Prose,
}

/// What stands beside the words.
pub struct Stand<'a> {
    /// The run, with its clip open.
    pub prepared: &'a Prepared,
    /// The step that is shown.
    pub cursor: Cursor,
    /// The pixel that is explained, if there is one.
    pub pixel: Option<Chosen>,
    /// How pictures look.
    pub look: Look,
    /// What was drawn by hand on the steps of the page.
    pub freehand: Freehand,
}

impl Stand<'_> {
    /// Goes to the step and hands over what is seen there, with the pixel that is explained.
    ///
    /// # Errors
    /// If the run cannot start or breaks off, the pixel cannot be explained, or the work was cancelled.
    pub(super) async fn seen<T>(
        &self,
        progress: Option<&dyn Progress>,
        take: impl FnOnce(&mut Viewer<'_>, Option<Focus>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let Self { prepared: Prepared { experiment, clip, .. }, cursor, pixel, look, freehand } = self;
        let reverse = Reverse::new(&*experiment.estimator, clip, experiment.frame);
        let mut viewer = Viewer::new(experiment, clip, look, &reverse)?;
        viewer.freehand.clone_from(freehand);
        let is_wanted = || !progress.is_some_and(|progress| progress.cancelled());
        if !travel(&mut *viewer.walk, Move::To(*cursor), &is_wanted).await {
            return Err(Error::new("saving was cancelled"));
        }
        if let Some(failure) = viewer.walk.failure() {
            return Err(failure.clone());
        }
        let focus = pixel.map(|pixel| pixel.here(&*viewer.walk, clip)).transpose()?;
        take(&mut viewer, focus.flatten())
    }

    /// The estimator.
    pub(super) fn estimator(&self) -> &dyn AnyEstimator {
        &*self.prepared.experiment.estimator
    }
}

impl Words<'_> {
    /// Encodes the page: its words beside the pictures and the first chart of its step.
    ///
    /// # Errors
    /// If the run cannot start or breaks off, or the picture would be larger than can be written.
    pub async fn encode(&self, stand: &Stand<'_>, format: Format, scale: u32) -> Result<Vec<u8>, Error> {
        let (estimator, look) = (stand.estimator(), &stand.look);
        let moment = stand.seen(None, |viewer, focus| viewer.moment(focus)).await?;
        let first = charts(&moment.step, estimator.charts()).into_iter().next();
        let panes = Selection { panes: [Some(&STAGE), first].into_iter().flatten().collect(), ..Selection::default() };
        let rendering = Rendering { moment: &moment, estimator, look, panes: &panes };
        rendering.encode_around(format, scale, |figure| self.beside(figure, look.theme))
    }

    /// The words left of `figure`.
    fn beside(&self, figure: Figure, theme: Theme) -> Figure {
        let column = WIDTH + 2.0 * MARGIN;
        let (words, height) = self.column(theme);
        let Figure { size, background, layers, description, .. } = figure;
        let layers = layers.into_iter().map(|layer| layer.moved([column, 0.0]));
        let mut line = Canvas::default();
        let size = [size[0] + column, size[1].max((height + MARGIN).ceil())];
        line.down(column, [MARGIN, size[1] - MARGIN], theme.chrome().line);
        let description = format!("{}. {} {description}", self.title, self.prose.plain());
        let layers = [words].into_iter().chain(line.into_layers()).chain(layers).collect();
        Figure { size, background, layers, panels: Vec::new(), description }
    }

    /// Titles and words below each other, and where they end.
    fn column(&self, theme: Theme) -> (Layer, f32) {
        let mut canvas = Canvas::default();
        let left: Point = [MARGIN, MARGIN];
        let [number, count] = self.number;
        let dim = Type::dim(theme);
        canvas.text(left, (Anchor::Start, Level::Top), self.lesson, dim);
        let right = [MARGIN + WIDTH, MARGIN];
        canvas.text(right, (Anchor::End, Level::Top), &format!("{number} of {count}"), dim);
        let title = Type { face: Face::Bold, size: 1.25 * TYPE_PT, ..Type::text(theme) };
        let title = canvas.text([MARGIN, MARGIN + 2.0 * dim.size], (Anchor::Start, Level::Top), self.title, title);
        let page = lay_out(self.prose, WIDTH, TYPE_PT, theme).block.moved([MARGIN, title.max[1] + TYPE_PT]);
        let height = title.max[1] + TYPE_PT + page.size[1];
        canvas.extend(page.primitives);
        (Layer { clip: None, primitives: canvas.into_primitives() }, height)
    }
}
