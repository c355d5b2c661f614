//! The conclusion at the end of a run: how good a dense flow field is, where it is worst, and why there.

use super::{FramePair, Tensor};
use crate::data::Flow;
use crate::geometry::Sampling;
use crate::scene::{Case, Role, Step, Unit};

/// Remedies for the failures of a method.
pub struct Advice {
    /// Where the window or pixel has too little texture, or only an edge.
    pub texture: &'static Case,
    /// At motion boundaries.
    pub boundary: &'static Case,
    /// Where the motion is larger than the linearisation reaches.
    pub motion: &'static Case,
}

crate::variables! {
    /// The share of the pixels with flow.
    DENSITY: "Density", "", Unit::WHOLE_PERCENT;
    /// The mean endpoint error of the flow field.
    MEAN_ERROR: "Mean endpoint error", "", Unit::SUBPIXEL, Role::Error;
    /// The mean residual |I(x + w, t+1) − I(x, t)| of the flow field.
    MEAN_RESIDUAL: "Mean residual", "", Unit::GRAY, Role::Error;
    /// The largest endpoint error of a pixel.
    LARGEST_ERROR: "Largest error", "", Unit::SUBPIXEL;
    /// The largest residual of a pixel.
    LARGEST_RESIDUAL: "Largest residual", "", Unit::GRAY;
    /// The pixel with the largest error or residual.
    WORST_PIXEL: "Worst pixel", "", Unit::WHOLE;
    /// The larger eigenvalue of the structure tensor at the worst pixel.
    WORST_LAMBDA_1: "λ₁ there", r"\lambda_1", Unit::GRAY;
    /// The smaller eigenvalue of the structure tensor at the worst pixel.
    WORST_LAMBDA_2: "λ₂ there", r"\lambda_2", Unit::GRAY;
    /// The largest difference of the flow of the worst pixel from that of its neighbours.
    NEIGHBOUR_DIFFERENCE: "Difference of neighbouring flows", "", Unit::SUBPIXEL;
    /// The length of the true motion at the worst pixel.
    TRUE_LENGTH: "True motion there", "", Unit::SUBPIXEL;
    /// The change of the gray level along the true motion at the worst pixel.
    BRIGHTNESS_CHANGE: "Change of brightness there", "", Unit::GRAY;
}

crate::cases! { over value;
    NOT_EVALUATED: "End of the run: flow at {density} of the pixels, none of which can be evaluated.",
    SPARSE_ERROR: "End of the run: flow at {density} of the pixels, mean endpoint error {mean_error}.",
    DENSE_ERROR: "End of the run: mean endpoint error {mean_error}.",
    SPARSE_RESIDUAL: "End of the run: flow at {density} of the pixels, mean residual |I(x + w, t+1) − I(x, t)| = {mean_residual} (no \
                      true flow is loaded).",
    DENSE_RESIDUAL: "End of the run: mean residual |I(x + w, t+1) − I(x, t)| = {mean_residual} (no true flow is loaded).",
    WORST_BY_ERROR: "The largest error, {largest_error}, is at pixel {worst_pixel}",
    WORST_BY_RESIDUAL: "The largest residual, {largest_residual}, is at pixel {worst_pixel}",
    OUTSIDE: ": the motion leads out of frame t+1, so there is no match.",
    FLAT: ": no texture (λ₁ = {worst_lambda_1:bare}, λ₂ = {worst_lambda_2:bare}), so there is no constraint.",
    EDGE: ": an edge (λ₁ = {worst_lambda_1:bare}, λ₂ = {worst_lambda_2:bare}), so only the normal component is constrained.",
    WEAK: ": weak texture (λ₁ = {worst_lambda_1:bare}, λ₂ = {worst_lambda_2:bare}), no stronger than what noise of 3 gray levels makes \
           of a plain.",
    BOUNDARY: ", where neighbouring flows differ by {neighbour_difference}: a motion boundary or an outlier.",
    LARGE: ": its true motion of {true_length} may be larger than the linearisation reaches.",
    BRIGHTNESS: ", where the gray level changes by {brightness_change:bare} along the true motion: the brightness is not constant, or the \
                 place is hidden in frame t+1. A cost that is invariant to gain and offset, such as ZNCC in block matching, tolerates a \
                 change of brightness.",
    UNEXPLAINED: ".",
}

/// The quality of a flow field: its endpoint error where the true flow is known, else its residual.
pub struct Conclusion {
    has_truth: bool,
    /// Share of the pixels with flow, 0 to 1.
    density: f32,
    /// Pixels that were judged.
    pixels: usize,
    /// Mean error in px, or mean residual in gray levels.
    mean: f32,
    worst: Option<Worst>,
}

/// The pixel with the largest error or residual.
struct Worst {
    place: (usize, usize),
    size: f32,
    cause: Cause,
}

/// Why flow is wrong at a pixel.
enum Cause {
    /// The motion leads out of frame t + 1.
    Outside,
    /// Both eigenvalues of the structure tensor are small.
    Flat([f32; 2]),
    /// The smaller eigenvalue is small.
    Edge([f32; 2]),
    /// The smaller eigenvalue is about as large as noise makes it.
    Weak([f32; 2]),
    /// Neighbours within 2 px move differently, by up to this many px.
    Boundary(f32),
    /// The true motion, in px, is large on the coarsest level, or more than twice the estimate.
    Large(f32),
    /// The gray level changes so much along the true motion.
    Brightness(f32),
    /// None of these.
    Unknown,
}

/// Eigenvalues below this are no texture, in (gray levels per px)².
const TEXTURE: f32 = 1.0;
/// Noise with a standard deviation of 3 gray levels gives eigenvalues of about this, in (gray levels per px)².
const NOISE: f32 = 4.5;
/// Factor by which a gradient in one direction must exceed the noise to count as an edge.
const EDGE: f32 = 4.0;
/// Neighbours that differ by more are a motion boundary, in px.
const BOUNDARY_PX: f32 = 1.0;
/// Noise and interpolation change the gray level along the true motion by less.
const CHANGE: f32 = 10.0;
/// A motion larger than this may be out of reach, in px.
const LARGE_PX: f32 = 2.0;
/// A motion larger than this on the coarsest level is out of reach of the linearisation, in px of that level.
const REACH_PX: f32 = 3.0;
/// Half the side of the neighbourhood that is looked at around the worst pixel, in px.
const REACH: usize = 2;

impl Conclusion {
    /// Judges `flow` between two frames; a pixel of the coarsest level is `coarsest_px` wide, 1 without a pyramid.
    pub fn new(frames: &FramePair, flow: &Flow, coarsest_px: f32) -> Self {
        let (width, height) = frames.size();
        let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let has_truth = places().any(|place| frames.true_displacement(place).is_some());
        let (mut sum, mut pixels, mut known, mut worst) = (0.0, 0usize, 0usize, None);
        for place in places() {
            let Some(found) = flow.at(place.0, place.1) else { continue };
            known += 1;
            let Some(size) = deviation(frames, place, found, has_truth) else { continue };
            (sum, pixels) = (sum + f64::from(size), pixels + 1);
            if worst.is_none_or(|(_, most)| size > most) {
                worst = Some((place, size));
            }
        }
        let worst = worst.filter(|(_, size)| *size > 0.0);
        let worst = worst.map(|(place, size)| Worst {
            place,
            size,
            cause: cause((frames, flow), place, has_truth, coarsest_px),
        });
        let density = known as f32 / (width * height).max(1) as f32;
        Self { has_truth, density, pixels, mean: (sum / pixels.max(1) as f64) as f32, worst }
    }

    /// Adds the conclusion to the last step of a run.
    pub fn tell(&self, step: Step, advice: &Advice) -> Step {
        let step = step.put(value::DENSITY, 100.0 * self.density);
        if self.pixels == 0 {
            return step.say(case::NOT_EVALUATED);
        }
        // A dense field covers all pixels, so there is nothing to report.
        let (step, said) = match (self.has_truth, self.density < 1.0) {
            (true, true) => (step.put(value::MEAN_ERROR, self.mean), case::SPARSE_ERROR),
            (true, false) => (step.put(value::MEAN_ERROR, self.mean), case::DENSE_ERROR),
            (false, true) => (step.put(value::MEAN_RESIDUAL, self.mean), case::SPARSE_RESIDUAL),
            (false, false) => (step.put(value::MEAN_RESIDUAL, self.mean), case::DENSE_RESIDUAL),
        };
        let step = step.say(said);
        let Some(Worst { place, size, cause }) = &self.worst else { return step };
        let step = step.put(value::WORST_PIXEL, *place);
        let step = match self.has_truth {
            true => step.put(value::LARGEST_ERROR, *size).say(case::WORST_BY_ERROR),
            false => step.put(value::LARGEST_RESIDUAL, *size).say(case::WORST_BY_RESIDUAL),
        };
        cause.tell(step, advice)
    }
}

/// The endpoint error of a pixel in px, or without truth its residual in gray levels.
fn deviation(frames: &FramePair, (x, y): (usize, usize), [u, v]: [f32; 2], has_truth: bool) -> Option<f32> {
    if has_truth {
        let truth = frames.true_displacement((x, y))?;
        return Some((u - truth[0]).hypot(v - truth[1]));
    }
    let [current, next] = &frames.pictures;
    let there = Sampling::Bilinear.sample_inside(next, x as f32 + u, y as f32 + v);
    there.is_finite().then(|| (there - current[(x, y)]).abs())
}

/// Why flow is wrong at a pixel.
fn cause((frames, flow): (&FramePair, &Flow), place: (usize, usize), has_truth: bool, coarsest_px: f32) -> Cause {
    let motion = |(x, y)| if has_truth { frames.true_displacement((x, y)) } else { flow.at(x, y) };
    let (Some([u, v]), Some(found)) = (motion(place), flow.at(place.0, place.1)) else { return Cause::Unknown };
    let (width, height) = frames.size();
    let to = [place.0 as f32 + u, place.1 as f32 + v];
    let is_inside = (0.0..=width as f32 - 1.0).contains(&to[0]) && (0.0..=height as f32 - 1.0).contains(&to[1]);
    let near = |at: usize, extent: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(extent);
    let around = near(place.1, height).flat_map(|y| near(place.0, width).map(move |x| (x, y)));
    let others = around.clone().filter_map(motion);
    let differs = others.fold(0.0f32, |most, other| most.max((other[0] - u).hypot(other[1] - v)));
    let eigenvalues = tensor(frames, around).eigenvalues();
    let (true_px, found_px) = (u.hypot(v), found[0].hypot(found[1]));
    let [current, next] = &frames.pictures;
    let change = (Sampling::Bilinear.sample_inside(next, to[0], to[1]) - current[place]).abs();
    match () {
        () if !is_inside => Cause::Outside,
        () if has_truth && true_px > REACH_PX * coarsest_px => Cause::Large(true_px),
        () if eigenvalues[0] < TEXTURE => Cause::Flat(eigenvalues),
        () if differs > BOUNDARY_PX => Cause::Boundary(differs),
        () if eigenvalues[1] < TEXTURE || eigenvalues[1] < NOISE && eigenvalues[0] > EDGE * NOISE => {
            Cause::Edge(eigenvalues)
        }
        () if has_truth && true_px > LARGE_PX && 2.0 * found_px < true_px => Cause::Large(true_px),
        () if has_truth && change > CHANGE => Cause::Brightness(change),
        () if eigenvalues[1] < NOISE => Cause::Weak(eigenvalues),
        () => Cause::Unknown,
    }
}

/// The structure tensor of frame t over some pixels, by central differences.
fn tensor(frames: &FramePair, places: impl Iterator<Item = (usize, usize)>) -> Tensor {
    let (picture, (width, height)) = (&frames.pictures[0], frames.size());
    let mut tensor = Tensor::default();
    for (x, y) in places {
        let gx = 0.5 * (picture[((x + 1).min(width - 1), y)] - picture[(x.saturating_sub(1), y)]);
        let gy = 0.5 * (picture[(x, (y + 1).min(height - 1))] - picture[(x, y.saturating_sub(1))]);
        tensor.xx += gx * gx;
        tensor.xy += gx * gy;
        tensor.yy += gy * gy;
        tensor.pixels += 1.0;
    }
    let mean = |sum: f32| sum / tensor.pixels.max(1.0);
    Tensor { xx: mean(tensor.xx), xy: mean(tensor.xy), yy: mean(tensor.yy), ..tensor }
}

impl Cause {
    fn tell(&self, step: Step, advice: &Advice) -> Step {
        let of = |step: Step, [large, small]: [f32; 2]| {
            step.put(value::WORST_LAMBDA_1, large).put(value::WORST_LAMBDA_2, small)
        };
        match *self {
            Cause::Outside => step.say(case::OUTSIDE),
            Cause::Flat(pair) => of(step, pair).say(case::FLAT).say(advice.texture),
            Cause::Edge(pair) => of(step, pair).say(case::EDGE).say(advice.texture),
            Cause::Weak(pair) => of(step, pair).say(case::WEAK).say(advice.texture),
            Cause::Boundary(px) => step.put(value::NEIGHBOUR_DIFFERENCE, px).say(case::BOUNDARY).say(advice.boundary),
            Cause::Large(px) => step.put(value::TRUE_LENGTH, px).say(case::LARGE).say(advice.motion),
            Cause::Brightness(change) => step.put(value::BRIGHTNESS_CHANGE, change).say(case::BRIGHTNESS),
            Cause::Unknown => step.say(case::UNEXPLAINED),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Grid;

    mod advice {
        crate::cases! { pub(super) TEXTURE: "T.", BOUNDARY: "B.", MOTION: "M." }
    }

    const ADVICE: Advice = {
        use advice::case::{BOUNDARY, MOTION, TEXTURE};
        Advice { texture: TEXTURE, boundary: BOUNDARY, motion: MOTION }
    };

    crate::line_names!(END);

    fn told(conclusion: &Conclusion) -> String {
        conclusion.tell(Step::at(END), &ADVICE).sentence.plain()
    }

    fn pair(truth: Option<[f32; 2]>, value: impl Fn(usize, usize) -> f32) -> FramePair {
        let picture = || Grid::from_fn(20, 16, &value);
        let truth = truth.map(|uv| Arc::new(Flow(Grid::new(20, 16, uv))));
        FramePair { pictures: [picture(), picture()], truth }
    }

    fn waves(x: usize, y: usize) -> f32 {
        128.0 + 40.0 * (0.9 * x as f32).sin() + 40.0 * (0.8 * y as f32).cos()
    }

    fn said(frames: &FramePair, flow: impl Fn(usize, usize) -> [f32; 2]) -> String {
        told(&Conclusion::new(frames, &Flow(Grid::from_fn(20, 16, flow)), 1.0))
    }

    #[test]
    fn the_reason_is_that_of_the_worst_pixel() {
        let truth = Some([3.0, 0.0]);
        let large = said(&pair(truth, waves), |x, y| if (x, y) == (8, 8) { [0.0; 2] } else { [3.0, 0.0] });
        assert!(large.contains("3.000 px, is at pixel (8, 8): its true motion of 3.000 px may be larger"), "{large}");
        let outside = said(&pair(truth, waves), |x, _| if x == 19 { [0.0; 2] } else { [3.0, 0.0] });
        assert!(outside.contains("leads out of frame t+1"), "{outside}");
        let flat = said(&pair(truth, |_, _| 90.0), |_, _| [0.0; 2]);
        assert!(flat.contains("mean endpoint error 3.000 px") && flat.contains("no texture"), "{flat}");
        let at_one = |x, y| if (x, y) == (8, 8) { [2.0, 0.0] } else { [3.0, 0.0] };
        let weak = said(&pair(truth, |x, y| 0.05 * waves(x, y)), at_one);
        assert!(weak.contains("weak texture (λ₁ = ") && weak.ends_with("T."), "{weak}");
        let edge = said(&pair(truth, |x, _| waves(x, 0)), |_, _| [2.0, 1.0]);
        assert!(edge.contains("normal component is constrained. T."), "{edge}");
        let mut lit = pair(Some([0.0; 2]), waves);
        lit.pictures[1] = Grid::from_fn(20, 16, |x, y| waves(x, y) + 30.0);
        let light = said(&lit, |x, y| if (x, y) == (8, 8) { [1.0, 0.0] } else { [0.0; 2] });
        assert!(light.contains("the gray level changes by 30.00 along the true motion"), "{light}");
    }

    #[test]
    fn a_motion_out_of_reach_is_the_reason_on_one_level() {
        let (frames, still) = (pair(Some([6.0, 0.0]), |_, _| 90.0), Flow(Grid::new(20, 16, [0.0; 2])));
        let one_level = told(&Conclusion::new(&frames, &still, 1.0));
        assert!(one_level.contains("its true motion of 6.000 px") && one_level.ends_with("M."), "{one_level}");
        let pyramid = told(&Conclusion::new(&frames, &still, 4.0));
        assert!(pyramid.contains("no texture") && pyramid.ends_with("T."), "{pyramid}");
    }

    #[test]
    fn without_truth_the_residual_is_judged() {
        let boundary = said(&pair(None, waves), |x, y| if (x, y) == (8, 8) { [2.0, 0.0] } else { [0.0; 2] });
        assert!(
            boundary.contains("a motion boundary or an outlier") && boundary.contains("(no true flow is loaded)"),
            "{boundary}"
        );
        let none = said(&pair(None, waves), |_, _| Flow::UNKNOWN);
        assert!(none.contains("flow at 0 % of the pixels, none of which can"), "{none}");
    }
}
