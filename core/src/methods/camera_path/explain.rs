//! The chaining of motions in words, numbers and marks.

use super::chain::pairs_line as line;
use super::{Chain, Link, Refused, outline};
use crate::data::Clip;
use crate::products::model::{Matrix3, Support, inverse, mapped, product};
use crate::products::path::{chained, corner_error, middle, track, true_motions};
use crate::scene::{
    Case, Matrix, Name, Number, Picture, Question, Readout, Reply, Role, Scene, Series, Shape, Step, Unit, Value,
};
use crate::{cases, variables};

variables! { pub mod value;
    /// The frame, or the first frame of the pair.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The second frame of the pair.
    NEXT_FRAME: "Next frame", "t + 1", Unit::WHOLE;
    /// The frames of the pair.
    PAIR: "Pair", "", Unit::WHOLE;
    /// The method that finds the motion of a pair.
    STAGE: "Motion stage", "", Unit::WHOLE;
    /// The motion of the centre of the picture between the frames of the pair.
    MOTION: "Motion of the centre", "", Unit::PX, Role::Measured;
    /// The true motion of the centre of the picture.
    TRUE_MOTION: "Motion of the centre, true", "", Unit::PX, Role::Truth;
    /// The largest distance of a corner moved by the motion from one moved by the true motion.
    CORNER_ERROR: "Error at the corners", "", Unit::PX, Role::Error;
    /// The motion of the view since the first frame.
    VIEW_MOTION: "Motion of the view", "", Unit::PX, Role::Result;
    /// The number of matches that agree with the motion.
    INLIERS: "Inliers", "", Unit::count("");
    /// The number of matches that the motion is estimated from.
    MATCHES: "Matches", "", Unit::count("match");
    /// The number of pairs so far.
    PAIRS: "Pairs chained", "", Unit::count("");
    /// The number of pairs without a usable motion.
    UNUSABLE: "Pairs without a motion", "", Unit::count("pair"), Role::Rejected;
    /// The first frame of the first pair without a usable motion.
    UNUSABLE_FROM: "First frame without a motion", "", Unit::WHOLE;
    /// The second frame of that pair.
    UNUSABLE_TO: "Frame after it", "", Unit::WHOLE;
    /// The number of motions that bend the picture.
    BENT: "Bent pairs", "", Unit::count("");
    /// The first frame of the first pair with a motion that bends the picture.
    BENT_FROM: "First bent frame", "", Unit::WHOLE;
    /// The second frame of that pair.
    BENT_TO: "Frame after it", "", Unit::WHOLE;
    /// The largest distance of a corner from the nearest similarity.
    BEND: "Bend", "", Unit::PX;
    /// The group of transformations of the motion.
    MODEL: "Model", "", Unit::WHOLE;
    /// The number of matches that determine a motion of the model.
    SAMPLE_SIZE: "Matches needed", "", Unit::WHOLE;
    /// The farthest motion of a corner.
    CORNER_MOTION: "Largest corner motion", "", Unit::PX;
    /// The diagonal of the picture.
    DIAGONAL: "Diagonal", "", Unit::PX;
    /// The mean or median difference of the frames registered by the motion.
    REGISTERED_DIFFERENCE: "Difference, registered", "", Unit::GRAY;
    /// The mean or median difference of the frames as they are.
    REST_DIFFERENCE: "Difference at rest", "", Unit::GRAY;
    /// The largest error of a corner at the end of the chained path.
    DRIFT: "Drift", "", Unit::PX;
    /// The reason why the ground truth is unreadable.
    READ_ERROR: "Error of the truth", "", Unit::WHOLE;
}

cases! { pub over value;
    PAIR: "frames {frame} and {next_frame}",
    ESTIMATED: "{stage} finds the motion of the background from frame {frame} to frame {next_frame}: ",
    MOTION: "{motion} at the centre of the picture",
    UPWARDS: ", upwards",
    DOWNWARDS: ", downwards",
    SUPPORT: ", with {inliers} of {matches}.",
    END: ".",
    UNUSABLE: "{rejected|none that is usable}.",
    BREAKS_PATH: "{rejected|none that continues the path}.",
    AT_REST: "The camera counts as at rest in this pair.",
    CHAINED: "P({next_frame}) = M({frame}) P({frame}): the view has moved by {view_motion} from the first frame. Errors of the motions add up \
              along the chain.",
    FEW_INLIERS: "A motion of the model ({model}) has {inliers} of {matches} as inliers. At least {sample_size} are needed, and more than agree by \
                  chance: the frames overlap too little, or have too little texture.",
    REJECTED: "The motion stage rejects its estimate ({model}); the steps of that method say which number was too small.",
    SINGULAR: "The matrix has no inverse.",
    BEYOND_HORIZON: "It maps a corner of the picture beyond the horizon line, as no camera does.",
    TOO_FAR: "The motion moves a corner by {corner_motion}, and the diagonal of the picture, {diagonal}, is the most.",
    WORSE: "Registered by it the frames differ by {registered_difference} on average, and by {rest_difference:bare} as they are: its few inliers \
            lie on an object, or are wrong.",
    BENDS: "The motion bends the picture: a corner is {bend} off the nearest similarity. The median difference of the frames registered by it is \
            {registered_difference}, and {rest_difference:bare} as they are: many of its inliers lie on a moving object. The model similarity \
            avoids it.",
    PATH_ENDS: "Chained to the motions before, it gives a map from the first frame without an inverse: the view has moved too far from that of \
                the first frame. A shorter run helps.",
    UNUSABLE_PAIRS: "Pairs without a usable motion, which count as at rest: {unusable:bare} of {pairs}. Frames {unusable_from} and {unusable_to}:",
    BENT_PAIRS: "Motions that bend the picture: {bent} of {pairs}. From frame {bent_from} to {bent_to} a corner is {bend} off the nearest \
                 similarity. A camera bends consecutive frames less, so matches on a moving object may be taken for the background; the model \
                 similarity avoids it.",
}

/// The question about the motion of a pair; a level one is not asked about.
pub(crate) const DIRECTION: Question = Question::choice(
    "direction",
    "Does the background move up or down in the next pair?",
    &[Reply::told(line::ESTIMATE, case::DOWNWARDS, "Down"), Reply::told(line::ESTIMATE, case::UPWARDS, "Up")],
);

/// The displacement of the middle of a picture by a map; not a number beyond the horizon.
pub fn displacement(map: &Matrix3, size: (usize, usize)) -> [f64; 2] {
    let from = middle(size);
    mapped(map, from).map_or([f64::NAN; 2], |to| [to[0] - from[0], to[1] - from[1]])
}

/// The step of a pair: its motion by the method `stage`, with the path before it.
pub fn estimate_step(chain: &Chain, link: &Link, (stage, clip): (&str, &Clip)) -> Step {
    let step = pair_step(line::ESTIMATE, chain, link).put(value::STAGE, stage).say(case::ESTIMATED);
    let step = match link.refused {
        None => tell_motion(step, link),
        Some(refused) => {
            let step = step.say(if refused == Refused::Path { case::BREAKS_PATH } else { case::UNUSABLE });
            let (step, why) = refusal(step, refused);
            step.say(why).say(case::AT_REST)
        }
    };
    let motion = Matrix::of_rows("M", "motion of the pair", &link.motion).with_role(Role::Measured);
    step.show(Readout::Matrices(vec![motion])).show_all(path_series(chain, &[], clip))
}

/// Tells the motion of a pair, whose y points down.
fn tell_motion(step: Step, link: &Link) -> Step {
    let v = match step.value(value::MOTION) {
        Some(Value { of, number: Number::Vector(uv), .. }) => uv.get(1).and_then(|v| of.is(*v).rounded()),
        _ => None,
    };
    let step = step.say(case::MOTION);
    let step = match v {
        Some(v) if v < 0.0 => step.say(case::UPWARDS),
        Some(v) if v > 0.0 => step.say(case::DOWNWARDS),
        _ => step,
    };
    match link.field.support {
        Some(support) => put_support(step, support).say(case::SUPPORT),
        None => step.say(case::END),
    }
}

fn put_support(step: Step, Support { inliers, matches }: Support) -> Step {
    step.put(value::INLIERS, inliers).put(value::MATCHES, matches)
}

/// The step of a pair that continues the path, which is `chained` then.
pub fn chain_step([chain, chained]: [&Chain; 2], link: &Link, clip: &Clip) -> Step {
    let back = inverse(&link.after).map_or([f64::NAN; 2], |back| displacement(&back, chain.picture));
    let step = pair_step(line::CHAIN, chain, link).fact(value::PAIRS, chain.motions.len() + 1);
    let matrices = vec![
        Matrix::of_rows("M", "motion of the pair", &link.motion).with_role(Role::Measured),
        Matrix::of_rows("P", "from the first frame", &link.after).with_role(Role::Result),
    ];
    let step = step.put(value::VIEW_MOTION, back).say(case::CHAINED).show(Readout::Matrices(matrices));
    step.show_all(path_series(chained, &[], clip))
}

fn pair_step(line: Name, chain: &Chain, link: &Link) -> Step {
    let (size, frames) = (chain.picture, [chain.frame, chain.frame + 1]);
    let step = Step::at(line).put(value::FRAME, frames[0]).put(value::NEXT_FRAME, frames[1]);
    let step = step.fact_as(value::PAIR.is(frames), case::PAIR);
    let step = step.fact(value::MOTION, displacement(&link.motion, size));
    let step = match &link.truth {
        Ok(None) => step,
        Ok(Some(truth)) => {
            let step = step.fact(value::TRUE_MOTION, displacement(truth, size));
            step.fact(value::CORNER_ERROR, corner_error([&link.motion, truth], size))
        }
        Err(error) => step.fact_of(value::TRUE_MOTION.is(error.to_string()).inked(Role::Rejected)),
    };
    step.fact_if(value::UNUSABLE, (chain.unknown > 0).then_some(chain.unknown))
}

/// Puts the values that explain a rejected motion; returns the case.
pub fn refusal(step: Step, refused: Refused) -> (Step, &'static Case) {
    let differences = |step: Step, [registered, at_rest]: [f64; 2]| {
        step.put(value::REGISTERED_DIFFERENCE, registered).put(value::REST_DIFFERENCE, at_rest)
    };
    match refused {
        Refused::Unknown(model, support) => {
            let step =
                step.put(value::MODEL, model.label().to_lowercase()).put(value::SAMPLE_SIZE, model.sample_size());
            match support {
                Some(support) => (put_support(step, support), case::FEW_INLIERS),
                None => (step, case::REJECTED),
            }
        }
        Refused::Singular => (step, case::SINGULAR),
        Refused::Far { moved_px, .. } if moved_px.is_infinite() => (step, case::BEYOND_HORIZON),
        Refused::Far { moved_px, most_px } => {
            (step.put(value::CORNER_MOTION, moved_px).put(value::DIAGONAL, most_px), case::TOO_FAR)
        }
        Refused::Worse { registered, at_rest } => (differences(step, [registered, at_rest]), case::WORSE),
        Refused::Bent { bend_px, registered, at_rest } => {
            (differences(step.put(value::BEND, bend_px), [registered, at_rest]), case::BENDS)
        }
        Refused::Path => (step, case::PATH_ENDS),
    }
}

/// Tells at the end of a run the number of pairs without usable motion and of motions that bend the picture, with the first of each.
pub fn conclude(step: Step, chain: &Chain) -> Step {
    let step = step.put(value::PAIRS, chain.motions.len());
    let step = match chain.first_refused {
        Some((frame, refused)) => {
            let step = step.put(value::UNUSABLE, chain.unknown).put(value::UNUSABLE_FROM, frame);
            let (step, why) = refusal(step.put(value::UNUSABLE_TO, frame + 1), refused);
            step.say(case::UNUSABLE_PAIRS).say(why)
        }
        None => step,
    };
    match chain.first_bent {
        Some((frame, bend_px)) => {
            let step = step.put(value::BENT, chain.bent).put(value::BENT_FROM, frame).put(value::BENT_TO, frame + 1);
            step.put(value::BEND, bend_px).say(case::BENT_PAIRS)
        }
        None => step,
    }
}

/// The camera's path along x and along y: by the estimated motions, smoothed, and true.
pub fn path_series(chain: &Chain, corrections: &[Matrix3], clip: &Clip) -> Vec<Readout> {
    let (maps, size) = (&chain.to_frames[..], chain.picture);
    if maps.len() < 2 {
        return Vec::new();
    }
    let smooth: Vec<_> = corrections.iter().zip(maps).map(|(correction, map)| product(correction, map)).collect();
    // Unreadable truth is reported with the pair that needs it.
    let truth = true_motions(clip, (chain.span.first, maps.len() - 1)).unwrap_or_default().map(|all| chained(&all));
    let line = |maps: &[Matrix3], axis: usize| -> Vec<[f32; 2]> {
        let places = track(maps, size);
        places.iter().enumerate().map(|(i, at)| [(chain.span.first + i) as f32, at[axis] as f32]).collect()
    };
    let series = |axis: usize, title, y_label| {
        let mut lines = vec![("estimated", Role::Measured, line(maps, axis))];
        lines.extend(truth.as_ref().map(|truth| ("true", Role::Truth, line(truth, axis))));
        if !smooth.is_empty() {
            lines.push(("smoothed", Role::Result, line(&smooth, axis)));
        }
        Readout::Series(Series {
            fits_values: true,
            ..Series::new(title, ["frame", y_label], chain.span.first + chain.frames().unwrap_or(maps.len()) - 1, lines)
        })
    };
    vec![series(0, "Path of the camera along x", "x in px"), series(1, "Path of the camera along y", "y in px")]
}

/// Draws the outline of a picture by its corners, if it has one.
pub fn draw_outline(
    scene: &mut Scene,
    on: Picture,
    (role, meaning): (Role, &'static str),
    corners: Option<[[f64; 2]; 4]>,
) {
    if let Some(corners) = corners {
        let points = corners.iter().map(|at| at.map(|c| c as f32)).collect();
        scene.draw(on, (role, meaning), Shape::outline(points));
    }
}

/// The outline of frame t in frame t + 1, and the path of the camera so far in frame t.
pub fn draw_link(chain: &Chain, link: &Link, scene: &mut Scene) {
    let outline = |map| outline(map, chain.picture);
    draw_outline(scene, Picture::NEXT, (Role::Window, "outline of frame t"), outline(&link.motion));
    let truth = link.truth.as_ref().ok().and_then(Option::as_ref);
    draw_outline(scene, Picture::NEXT, (Role::Truth, "its true outline"), truth.and_then(outline));
    draw_path(chain, &link.before, scene);
}

/// Draws the path of the camera's view through the frames so far, in the frame to which `to_frame` maps the first one.
fn draw_path(chain: &Chain, to_frame: &Matrix3, scene: &mut Scene) {
    let places = track(&chain.to_frames, chain.picture);
    let reach = 2.0 * chain.picture.0.max(chain.picture.1) as f64;
    let here = places.iter().filter_map(|at| mapped(to_frame, *at));
    let points: Vec<_> = here.filter(|at| at.iter().all(|c| c.abs() < reach)).map(|at| at.map(|c| c as f32)).collect();
    scene.mark(Picture::CURRENT, Role::Measured, Shape::Points(points.last().copied().into_iter().collect()));
    scene.draw(Picture::CURRENT, (Role::Measured, "path of the frame centre"), Shape::line(points));
}
