//! Small pictures of the estimators at work, each of a step of its example of success. They are made one at a time by a task, only of the estimators in sight, and kept for the session.

use std::collections::BTreeMap;

use eframe::egui::{ColorImage, Context, TextureHandle, TextureOptions};
use motionscope_core::base::{Error, Stop};
use motionscope_core::course::examples;

use super::background::Background;
use super::color_image;
use crate::experiment::source::Source;
use crate::media::Open;
use crate::paint::{FocusMode, Theme};
use crate::session::example;
use crate::view::look::Look;
use crate::view::still;

/// Width and height of the clip behind a picture in px: marks are as thick on it as on a large one, so that they are seen.
const CLIP_PX: (usize, usize) = (160, 120);

/// The pictures by the ids of their estimators.
#[derive(Default)]
pub struct StepPictures {
    /// Those that were made; `None` where one cannot be made.
    made: BTreeMap<&'static str, Option<TextureHandle>>,
    /// The estimators in sight in the frame that is being drawn, whose pictures are not there yet.
    wished: Vec<&'static str>,
    /// The picture that is being made.
    work: Option<(&'static str, Background<ColorImage>)>,
    /// Whether one was made that was not drawn yet.
    is_fresh: bool,
}

impl StepPictures {
    /// The picture of the estimator `id`, which is in sight; `None` until it is made.
    pub fn picture(&mut self, id: &'static str) -> Option<TextureHandle> {
        let made = self.made.get(id).cloned();
        if made.is_none() {
            self.wished.push(id);
        }
        made.flatten()
    }

    /// Ends a frame: the next picture that was wished for in it is made. Where none was, none is made any more.
    pub fn settle(&mut self, ctx: &Context) {
        self.is_fresh = false;
        if let Some((id, outcome)) = self.work.as_ref().and_then(|(id, work)| Some((*id, work.take()?))) {
            let load = |image| ctx.load_texture(id, image, TextureOptions::LINEAR);
            self.made.insert(id, outcome.ok().map(load));
            (self.work, self.is_fresh) = (None, true);
            ctx.request_repaint();
        }
        let made = &self.made;
        self.wished.retain(|id| !made.contains_key(id));
        // A picture that has gone out of sight gives way to those in sight.
        self.work.take_if(|(id, _)| !self.wished.contains(id));
        if let Some(id) = self.wished.first()
            && self.work.is_none()
        {
            self.work = Some((id, start(id, ctx.clone())));
        }
        self.wished.clear();
    }

    /// Whether the picture of the estimator `id` is there.
    pub fn has(&self, id: &str) -> bool {
        self.made.get(id).is_some_and(Option::is_some)
    }

    /// Whether all pictures in sight are drawn.
    pub fn is_complete(&self) -> bool {
        self.work.is_none() && !self.is_fresh
    }
}

fn start(id: &'static str, ctx: Context) -> Background<ColorImage> {
    Background::new(
        "draw an estimator",
        move || ctx.request_repaint(),
        async move |control| picture(id, &control.stop).await,
    )
}

/// The picture of a step of the estimator `id`.
async fn picture(id: &str, stop: &Stop) -> Result<ColorImage, Error> {
    let works = examples::of(id).find(|example| !example.is_failure());
    let works = works.ok_or_else(|| Error::new(format!("{id} has no example of success")))?;
    let mut experiment = example::session(id, works)?.experiment;
    if let Source::Synth { difficulty, .. } = &mut experiment.source {
        (difficulty.width, difficulty.height) = CLIP_PX;
    }
    let clip = experiment.source.open(&Open::default())?.clip.until(stop.clone());
    let look = Look { theme: Theme::Dark, focus: FocusMode::On, ..Look::default() };
    Ok(color_image(&still::of_step(&experiment, &clip, &look, stop).await?))
}
