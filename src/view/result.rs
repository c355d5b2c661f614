//! The result of an estimator as one picture: flow, mask, boxes or whatever it shows at the end of its run.

use motionscope_core::{Clip, Error, Grid, Move};

use super::look::{CaptionWords, Look};
use super::moment::Viewer;
use super::motion::Reverse;
use super::panes::Selection;
use super::rendering::Rendering;
use crate::experiment::Experiment;
use crate::paint::FocusMode;

/// Width of the picture in pixels, as near as whole pixels of the clip allow.
const WIDTH_PX: usize = 640;
/// Most pixels for each pixel of the clip.
const MOST_SCALE: usize = 3;

/// Runs `experiment` on `clip` to its end, and returns its picture there, with the colours of `look` and nothing around it.
///
/// # Errors
/// If it cannot run there, or not within the memory that there is.
pub fn picture(experiment: &Experiment, clip: &Clip, look: &Look) -> Result<Grid<[u8; 3]>, Error> {
    let view = look.view.filter(|view| view.is_of_the_end());
    let look = &Look { view, focus: FocusMode::Off, streaks: None, legend: false, caption: CaptionWords::Off, ..*look };
    let estimator = &*experiment.estimator;
    let reverse = Reverse::new(estimator, clip, experiment.frame);
    let mut viewer = Viewer::new(experiment, clip, look, &reverse)?.with_explanation(false);
    viewer.walk.jump(Move::End);
    if let Some(failure) = viewer.walk.failure() {
        return Err(failure.clone());
    }
    let moment = &viewer.moment(None)?;
    let (width, _) = moment.pictures.pair[0].size();
    let scale = (WIDTH_PX / width.max(1)).clamp(1, MOST_SCALE) as u32;
    Rendering { moment, estimator, look, panes: &Selection::default() }.pixels(scale)
}

#[cfg(test)]
mod tests {
    use motionscope_core::estimator;

    use super::*;
    use crate::experiment::source::Source;
    use crate::media::Open;

    #[test]
    fn the_picture_is_that_of_the_end_of_the_run() {
        let source = Source::parse("synth:pillar,width=96,height=64,frames=2").expect("a sample");
        let clip = source.open(&Open::default()).expect("it opens");
        let of = |id: &str| {
            let experiment = Experiment::new(source.clone(), estimator(id).expect("it exists"));
            picture(&experiment, &clip, &Look::of_window()).expect("it runs")
        };
        let (flow, blocks) = (of("horn-schunck"), of("diamond"));
        assert_eq!((flow.size(), blocks.size()), ((288, 192), (288, 192)), "frame t alone");
        assert_ne!(flow, blocks);
    }
}
