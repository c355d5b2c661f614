//! The explanation and the drawing of a mosaic.

use std::sync::Arc;

use super::{Event, Mosaic, Placed, State, line};
use crate::methods::camera_path::explain::value as path;
use crate::methods::camera_path::{
    Blending, Canvas as Sheet, chain_step, conclude, draw_link, estimate_step, outline, path_series,
};
use crate::products::Views;
use crate::run::Seen;
use crate::scene::{Canvas, Matrix, Name, Picture, PictureRole, Readout, Role, Scene, Shape, Step, Unit};
use crate::{cases, variables};

/// The mosaic.
const MOSAIC: Picture = Picture { role: PictureRole::Mosaic, ..Picture::CURRENT };

/// A chained path that ends farther than this from the true one shows seams, in px.
const SEAMS_PX: f64 = 3.0;

variables! {
    /// The frame that gives the mosaic its coordinates.
    REFERENCE: "Reference frame", "c", Unit::WHOLE;
    /// The width of the mosaic.
    WIDTH: "Mosaic", "", Unit::new("px", 0), Role::Result;
    /// The height of the mosaic.
    HEIGHT: "Height", "", Unit::new("px", 0), Role::Result;
    /// The number of frames of the run.
    FRAMES: "Frames", "", Unit::count("frame");
    /// The number of frames that lie completely on the mosaic.
    WHOLE_FRAMES: "Frames on it", "", Unit::count("");
    /// The number of frames that the border of the mosaic cuts.
    CUT_FRAMES: "Frames cut", "", Unit::count("frame");
    /// The number of frames on the mosaic so far.
    BLENDED: "Frames blended", "", Unit::count("");
    /// The share of the mosaic that frames cover.
    COVERED: "Covered", "", Unit::PERCENT, Role::Result;
}

cases! { over value, path;
    OPENING: "A mosaic registers all frames of a shot in one coordinate system. The motions of consecutive frames are chained first; this is exact for \
              a rotating camera or a planar scene.",
    SIZE: "{width:bare}×{height}",
    BOUNDED: "The mosaic takes the coordinates of frame {reference}, in the middle of the shot, so that errors of the chain grow to both sides alike. \
              All outlines span {width:bare}×{height}",
    END: ".",
    ONE_CUT: "; {cut_frames} is cut",
    SOME_CUT: "; {cut_frames} are cut",
    WHY_CUT: ", because the outline would make the mosaic too large or reach infinity. A shorter shot or a simpler motion model helps.",
    NO_PLACE: "Frame {frame} has {rejected|no place on the mosaic}: its map A to the reference frame has no inverse. A shorter shot or a simpler \
               motion model helps.",
    REGISTERED: "Frame {frame} is registered by A = P({reference}) P({frame})⁻¹: its outline on the mosaic is the {result|marked quadrilateral}.",
    LEFT_OUT: "Frame {frame} has no place on the mosaic and is left out.",
    FEATHERED: "Frame {frame} is blended in, with weights that fall to 0 at its border: seams vanish, but moving objects leave faint ghosts.",
    NEWEST: "Frame {frame} is blended in: it covers all earlier frames, so each moving object is shown where it was last, with seams.",
    COVERED: "{covered} of the mosaic is covered.",
    CONCLUDED: "End of the run: {frames} in one picture.",
    UNKNOWN_DRIFT: "The drift of the path is unknown. {read_error}.",
    INFINITE_DRIFT: "The chained map of the last frame sends a corner of the picture to infinity.",
    DRIFT: "At the end of the chained path the corners are up to {drift} off",
    SEAMS: ": parallax, moving objects or a model with too much freedom. Blurred seams show it.",
    NO_TRUTH: "Double edges show errors of the chained path; broken straight lines show parallax.",
}

impl Mosaic {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let (chain, name) = (&seen.before.chain, self.motion.estimator().info().name);
        match seen.events.last() {
            None => Step::at(line::EACH_PAIR).say(case::OPENING),
            Some(Event::Estimated(link)) => estimate_step(chain, link, (name, seen.clip)),
            Some(Event::Chained(link)) => {
                chain_step([chain, &seen.after.unwrap_or(seen.before).chain], link, seen.clip)
            }
            Some(Event::Bounded(canvas)) => {
                let (frames, reference) = (chain.to_frames.len(), chain.span.first + seen.before.reference());
                let step = put_size(Step::at(line::BOUND), canvas).fact(value::WHOLE_FRAMES, canvas.complete);
                let step = step.fact(value::REFERENCE, reference).put(value::CUT_FRAMES, frames - canvas.complete);
                let step = match frames - canvas.complete {
                    0 => step.say(case::BOUNDED).say(case::END),
                    1 => step.say(case::BOUNDED).say(case::ONE_CUT).say(case::WHY_CUT),
                    _ => step.say(case::BOUNDED).say(case::SOME_CUT).say(case::WHY_CUT),
                };
                step.show_all(path_series(chain, &[], seen.clip))
            }
            Some(Event::Found(placed)) => {
                let step = frame_step(line::PLACE, seen, placed);
                step.say(if placed.map.is_some() { case::REGISTERED } else { case::NO_PLACE })
            }
            Some(Event::Blended(placed)) => {
                let step = frame_step(line::BLEND, seen, placed).put(value::COVERED, 100.0 * placed.canvas.covered());
                let step = step.say(match (placed.map, self.blending) {
                    (None, _) => case::LEFT_OUT,
                    (_, Blending::Mean) => case::FEATHERED,
                    (_, Blending::Newest) => case::NEWEST,
                });
                match seen.after.filter(|after| after.done.is_some()) {
                    Some(after) => conclude_run(step.say(case::COVERED), seen, after),
                    None => step.say(case::COVERED),
                }
            }
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        match seen.events.last() {
            None => {}
            Some(Event::Estimated(link) | Event::Chained(link)) => draw_link(&seen.before.chain, link, scene),
            Some(Event::Bounded(canvas)) => {
                show(canvas, scene);
                for i in 0..seen.before.chain.to_frames.len() {
                    draw_outline(canvas, (seen.before, i), Role::Window, scene);
                }
                scene.legend(Role::Window, "outline of a frame");
            }
            Some(Event::Found(placed) | Event::Blended(placed)) => {
                // The frame itself appears with its blending.
                match (seen.events.last(), &seen.before.canvas) {
                    (Some(Event::Found(_)), Some(before)) => show(before, scene),
                    _ => show(&placed.canvas, scene),
                }
                draw_outline(&placed.canvas, (seen.before, seen.before.placed), Role::Result, scene);
                scene.legend(Role::Result, "outline of frame t");
            }
        }
    }
}

fn put_size(step: Step, canvas: &Sheet) -> Step {
    let (width, height) = canvas.window.size;
    step.put(value::HEIGHT, height).fact_as(value::WIDTH.is(width), case::SIZE)
}

/// A step of a frame with its numbers, its maps and the path.
fn frame_step(line: Name, seen: &Seen<Mosaic>, placed: &Placed) -> Step {
    let (state, chain) = (seen.before, &seen.before.chain);
    let mut matrices =
        vec![Matrix::of_rows("P", "from the first frame", &chain.to_frames[state.placed]).with_role(Role::Measured)];
    matrices.extend(placed.map.as_ref().map(|map| Matrix::of_rows("A", "to the mosaic", map).with_role(Role::Result)));
    let step = Step::at(line).fact(path::FRAME, chain.span.first + state.placed);
    let step = put_size(step, &placed.canvas).fact(value::BLENDED, state.placed + 1);
    let step = step.put(value::REFERENCE, chain.span.first + state.reference()).formula("A = P(c) P(t)^{-1}");
    step.show(Readout::Matrices(matrices)).show_all(path_series(chain, &[], seen.clip))
}

fn conclude_run(step: Step, seen: &Seen<Mosaic>, after: &State) -> Step {
    let step = step.put(value::FRAMES, after.chain.to_frames.len()).say(case::CONCLUDED);
    let step = match after.chain.field(&[], Views::None).errors(seen.clip).map(|errors| errors.drift_px) {
        Err(error) => step.put(path::READ_ERROR, error.to_string()).say(case::UNKNOWN_DRIFT),
        Ok(None) => step.say(case::NO_TRUTH),
        Ok(Some(drift)) if !drift.is_finite() => step.say(case::INFINITE_DRIFT),
        Ok(Some(drift)) => {
            let end = if drift > SEAMS_PX { case::SEAMS } else { case::END };
            step.put(path::DRIFT, drift).say(case::DRIFT).say(end)
        }
    };
    conclude(step, &after.chain)
}

/// Shows the frame beside the mosaic so far.
fn show(canvas: &Arc<Sheet>, scene: &mut Scene) {
    let canvas = Arc::clone(canvas);
    scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(MOSAIC, move || canvas.picture())];
}

/// Draws the outline of frame `i` of the run on the mosaic.
fn draw_outline(canvas: &Sheet, (state, i): (&State, usize), role: Role, scene: &mut Scene) {
    let origin = canvas.window.origin.map(f64::from);
    let corners = state.to_reference(i).and_then(|map| outline(&map, state.chain.picture));
    let Some(corners) = corners else { return };
    let points = corners.iter().map(|at| [0, 1].map(|c| (at[c] - origin[c]) as f32)).collect();
    scene.mark(MOSAIC, role, Shape::outline(points));
}
