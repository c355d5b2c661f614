//! One picture of a run, without a window: its result, or the step that is most worth seeing.

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::Clip;
use motionscope_core::geometry::Grid;
use motionscope_core::run::{Cursor, Move, Walk};
use motionscope_core::scene::{Picture, Role, Scene};

use super::look::{CaptionWords, Look};
use super::moment::Viewer;
use super::motion::Reverse;
use super::panes::Selection;
use super::rendering::Rendering;
use crate::experiment::travel::travel;
use crate::experiment::{Experiment, interest};
use crate::paint::{FocusMode, View};

/// Width of the picture of a result in pixels, as near as whole pixels of the clip allow.
const RESULT_PX: usize = 640;
/// Most pixels for each pixel of the clip.
const MOST_SCALE: usize = 3;
/// Where a run stands whose units are not ordered over the picture, so that none is of most interest.
const UNIT: usize = 7;

/// Runs `experiment` on `clip` to its end, and returns its picture there (flow, mask, boxes or whatever it shows) in the colours of
/// `look`.
///
/// # Errors
/// If it cannot run there, or not within the memory that there is, or if `stop` is set.
pub async fn of_result(experiment: &Experiment, clip: &Clip, look: &Look, stop: &Stop) -> Result<Grid<[u8; 3]>, Error> {
    let view = look.view.filter(|view| view.is_of_the_end());
    let look = Look { view, focus: FocusMode::Off, streaks: None, legend: false, caption: CaptionWords::Off, ..*look };
    let (width, _) = clip.size();
    let scale = (RESULT_PX / width.max(1)).clamp(1, MOST_SCALE) as u32;
    let to_end = async |walk: &mut dyn Walk| go(walk, Move::End, stop).await;
    Still { experiment, clip, look: &look, scale }.at(to_end, |_| look.view).await
}

/// Runs `experiment` on `clip` to the middle of its unit of most interest, and returns its picture there, at one pixel for each pixel of
/// the clip.
///
/// # Errors
/// As [`of_result`].
pub async fn of_step(experiment: &Experiment, clip: &Clip, look: &Look, stop: &Stop) -> Result<Grid<[u8; 3]>, Error> {
    let to_step = async |walk: &mut dyn Walk| {
        let opening = interest::opening(walk, clip, experiment.frame);
        let unit = opening.map_or(UNIT, |opening| opening.unit);
        go(walk, Move::To(Cursor { unit, event: usize::MAX }), stop).await?;
        if experiment.estimator.tests_candidates() {
            // At the end the block has its vector, and its candidates are no longer drawn.
            let half = Cursor { event: walk.events() / 2, ..walk.cursor() };
            go(walk, Move::To(half), stop).await?;
        }
        Ok(())
    };
    Still { experiment, clip, look, scale: 1 }.at(to_step, |scene| Some(where_it_searches(scene))).await
}

/// A run that is drawn once.
struct Still<'a> {
    experiment: &'a Experiment,
    clip: &'a Clip,
    look: &'a Look,
    /// Pixels for each pixel of the clip.
    scale: u32,
}

impl Still<'_> {
    /// The picture where `walk` takes the run, in the view that is chosen for its scene.
    async fn at(
        &self,
        walk: impl AsyncFnOnce(&mut dyn Walk) -> Result<(), Error>,
        view: impl FnOnce(&Scene) -> Option<View>,
    ) -> Result<Grid<[u8; 3]>, Error> {
        let &Self { experiment, clip, look, scale } = self;
        let estimator = &*experiment.estimator;
        let reverse = Reverse::new(estimator, clip, experiment.frame);
        let mut viewer = Viewer::new(experiment, clip, look, &reverse)?.with_explanation(false);
        walk(&mut *viewer.walk).await?;
        let moment = &viewer.moment(None)?;
        let look = &Look { view: view(&moment.scene), ..*look };
        Rendering { moment, estimator, look, panes: &Selection::default() }.pixels(scale)
    }
}

/// Makes a move, unless `stop` is set or the run fails.
async fn go(walk: &mut dyn Walk, to: Move, stop: &Stop) -> Result<(), Error> {
    if !travel(walk, to, &|| !stop.is_set()).await {
        stop.check()?;
    }
    walk.failure().map_or(Ok(()), |failure| Err(failure.clone()))
}

/// The picture in which a search tests candidates, else the one at time t.
fn where_it_searches(scene: &Scene) -> View {
    let is_search = |role: Role| matches!(role, Role::Candidate | Role::Window);
    match scene.marks.iter().any(|mark| mark.on == Picture::NEXT && is_search(mark.role)) {
        true => View::Next,
        false => View::Current,
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::course::estimator;

    use super::*;
    use crate::experiment::source::Source;
    use crate::media::Open;
    use crate::work;

    fn of<T>(id: &str, draw: impl FnOnce(&Experiment, &Clip) -> T) -> T {
        let source = Source::parse("synth:pillar,width=96,height=64,frames=2").expect("a sample");
        let clip = source.open(&Open::default()).expect("it opens").clip;
        draw(&Experiment::new(source, estimator(id).expect("it exists")), &clip)
    }

    fn result(id: &str, stop: &Stop) -> Result<Grid<[u8; 3]>, Error> {
        of(id, |experiment, clip| work::finish(of_result(experiment, clip, &Look::of_window(), stop)))
    }

    #[test]
    fn the_picture_is_that_of_the_end_of_the_run() {
        let of = |id| result(id, &Stop::default()).expect("it runs");
        let (flow, blocks) = (of("horn-schunck"), of("diamond"));
        assert_eq!((flow.size(), blocks.size()), ((288, 192), (288, 192)), "frame t alone");
        assert_ne!(flow, blocks);
    }

    #[test]
    fn a_step_is_not_the_result() {
        let step = of("diamond", |experiment, clip| {
            work::finish(of_step(experiment, clip, &Look::of_window(), &Stop::default()))
        });
        let step = step.expect("it runs");
        assert!(step.size().0 >= 96, "frame t + 1, or a part of it enlarged");
        assert_ne!(step, result("diamond", &Stop::default()).expect("it runs"));
    }

    #[test]
    fn a_run_that_is_stopped_has_no_picture() {
        let stop = Stop::default();
        stop.set(true);
        let given_up = result("horn-schunck", &stop).expect_err("it was to stop");
        assert_eq!(given_up.to_string(), stop.check().expect_err("it is set").to_string());
    }
}
