//! Applications of the fundamental matrix: guided matching along epipolar lines, and the rectified pair.

use super::vocabulary::{case, value};
use super::{EpipolarGeometry, Planarity, cut, line_of};
use crate::base::Threads;
use crate::data::Clip;
use crate::methods::geometric::Correspondence;
use crate::methods::geometric::epipolar::{epipoles, sampson_squared};
use crate::methods::geometric::rectify::{Rectification, Refusal, rectify};
use crate::methods::geometric::robust::{Best, Estimate};
use crate::methods::matching::{Admits, Candidates};
use crate::products::model::{IDENTITY, Matrix3, inverse};
use crate::products::registration::registered;
use crate::products::{Match, MatchErrors, MatchField, MatchStatus};
use crate::scene::{Canvas, Focus, Link, Matrix, Picture, Readout, Role, Scene, Shape, Step};

/// Largest number of rows drawn on the rectified pair.
const ROWS: usize = 12;

/// From this ratio of areas on, most of a rectified picture shows the surroundings of its epipole.
const DISTORTED: f64 = 8.0;

/// The symbols of the epipoles and the names of their frames.
const EPIPOLES: [(&str, &str); 2] = [("e", "frame t"), ("e′", "frame t+1")];

/// The distance of an epipole from its frame in px.
fn beside_px(estimate: &Estimate<'_>, frame: usize) -> Option<f64> {
    let [x, y, w] = epipoles(&estimate.best?.matrix)?[frame];
    let (width, height) = estimate.size();
    let outside = |c: f64, extent: usize| (-c).max(c - (extent - 1) as f64).max(0.0);
    Some(outside(x / w, width).hypot(outside(y / w, height)))
}

/// The correct matches among those with a known true displacement, if there are any.
fn compare_with_truth(all: &[Match], estimate: &Estimate<'_>) -> Option<MatchErrors> {
    Some(MatchField::compare(all.iter(), estimate.truth?)).filter(|errors| errors.known > 0)
}

impl EpipolarGeometry {
    /// The matches of all keypoints with those whose position agrees with the matrix.
    fn along_lines(&self, estimate: &Estimate<'_>, matrix: &Matrix3) -> Vec<Match> {
        let limit = f64::from(self.robust.threshold).powi(2);
        let near = |from: [f32; 2], to: [f32; 2]| {
            let pair = Correspondence { from: from.map(f64::from), to: to.map(f64::from) };
            sampson_squared(matrix, &pair) <= limit
        };
        let admits: &Admits<'_> = &near;
        let candidates = Candidates { admits: Some(admits), ..self.matching.candidates(estimate.pair) };
        let [here, there] = estimate.pair.sides.each_ref();
        let one = |index: usize| Some(candidates.compare(index, &mut ())?.matched(here, index, there));
        let all = (0..here.points.len()).filter_map(one);
        all.filter(|found| found.status == MatchStatus::Match).collect()
    }

    /// The matches without guidance.
    fn unguided(&self, estimate: &Estimate<'_>) -> Vec<Match> {
        // The clip only serves to cancel the work, and there is nothing to cancel.
        let clip = Clip::blank("a pair of frames", estimate.size(), 2);
        let mut all = self.matching.matches(estimate.pair, &clip, &Threads::single()).unwrap_or_default();
        all.retain(|found| found.status == MatchStatus::Match);
        all
    }

    pub(super) fn tell_guidance(&self, step: Step, estimate: &Estimate<'_>, focus: Option<Focus>) -> Step {
        let Some(Best { matrix, .. }) = estimate.best else { return step };
        let (plain, found) = (self.unguided(estimate), self.along_lines(estimate, &matrix));
        let [before, after] = [&plain, &found].map(|all| compare_with_truth(all, estimate));
        let (mut step, unguided) = (step, value::UNGUIDED.is(plain.len()));
        if let Some(errors) = before {
            step = step.put(value::UNGUIDED_RIGHT, errors.right).put(value::UNGUIDED_KNOWN, errors.known);
        }
        if let Some(errors) = after {
            step = step.put(value::GUIDED_RIGHT, errors.right).put(value::GUIDED_KNOWN, errors.known);
        }
        let step = step.fact_as(unguided, if before.is_some() { case::UNGUIDED_OF } else { case::UNGUIDED });
        let guided = if after.is_some() { case::GUIDED_OF } else { case::GUIDED };
        let mut step = step.fact_as(value::GUIDED.is(found.len()), guided);
        if let Some((_, near)) = self.example(estimate, &matrix, (&found, focus)) {
            step = step.put(value::KEYPOINTS, estimate.pair.sides[1].points.len());
            step = step.fact_as(value::NEAR.is(near.len()), case::NEAR_OF);
        }
        let step = step.say(case::GUIDANCE).say(guided).say(case::WITHOUT_GUIDANCE);
        let step = step.say(if before.is_some() { case::UNGUIDED_OF } else { case::UNGUIDED }).say(case::LESS_ALIKE);
        match [before, after].map(|errors| errors.and_then(MatchErrors::precision)) {
            [Some(before), Some(after)] if after < before => step
                .put(value::UNGUIDED_PRECISION, 100.0 * before)
                .put(value::GUIDED_PRECISION, 100.0 * after)
                .put(value::WITHOUT_SECOND, found.iter().filter(|found| found.ratio.is_none()).count())
                .say(case::LESS_PRECISE),
            _ => step,
        }
    }

    /// A keypoint, the one nearest to the point pointed at or that of the middle match, and its candidates near the epipolar line.
    fn example(
        &self,
        estimate: &Estimate<'_>,
        matrix: &Matrix3,
        (found, focus): (&[Match], Option<Focus>),
    ) -> Option<([f32; 2], Vec<[f32; 2]>)> {
        let [here, there] = estimate.pair.sides.each_ref();
        let from = match focus {
            Some(Focus { on: Picture::CURRENT, at, .. }) => {
                let far = |point: [f32; 2]| (point[0] - at[0]).hypot(point[1] - at[1]);
                here.points.iter().map(|point| point.at).min_by(|a, b| far(*a).total_cmp(&far(*b)))?
            }
            _ => found.get(found.len() / 2)?.from,
        };
        let limit = f64::from(self.robust.threshold).powi(2);
        let is_near = |to: &[f32; 2]| {
            let pair = Correspondence { from: from.map(f64::from), to: to.map(f64::from) };
            sampson_squared(matrix, &pair) <= limit
        };
        Some((from, there.points.iter().map(|point| point.at).filter(is_near).collect()))
    }

    pub(super) fn draw_guided(&self, estimate: &Estimate<'_>, focus: Option<Focus>, scene: &mut Scene) {
        let Some(Best { matrix, .. }) = estimate.best else { return };
        let (plain, found) = (self.unguided(estimate), self.along_lines(estimate, &matrix));
        for one in &found {
            let is_old = plain.iter().any(|other| other.from == one.from && other.to == one.to);
            let (role, meaning) = match is_old {
                true => (Role::Reference, "match, with and without guidance"),
                false => (Role::Result, "match by guidance alone"),
            };
            scene.links.push(Link { role, ends: [(Picture::CURRENT, one.from), (Picture::NEXT, one.to)] });
            scene.legend(role, meaning);
        }
        let Some((from, near)) = self.example(estimate, &matrix, (&found, focus)) else { return };
        scene.draw(Picture::CURRENT, (Role::Measured, "keypoint"), Shape::circle(from, 4.0));
        if let Some(ends) = cut(line_of(&matrix, from.map(f64::from)), estimate.size()) {
            scene.draw(Picture::NEXT, (Role::Predicted, "its epipolar line"), Shape::line(ends.to_vec()));
        }
        for center in near {
            scene.draw(Picture::NEXT, (Role::Candidate, "candidate near the line"), Shape::circle(center, 3.0));
        }
    }

    fn rectification(&self, estimate: &Estimate<'_>) -> Result<(Rectification, Vec<Correspondence>), Refusal> {
        let matrix = estimate.best.ok_or(Refusal::Degenerate)?.matrix;
        if let Some(planar) = self.planarity(estimate).filter(Planarity::is_plane) {
            return Err(Refusal::Planar(planar.share));
        }
        let inliers = self.inliers(estimate, &matrix);
        rectify(&matrix, &inliers, estimate.size()).map(|found| (found, inliers))
    }

    pub(super) fn tell_rectification(&self, step: Step, estimate: &Estimate<'_>) -> Step {
        let of_epipole =
            |step: Step, i: usize| step.put(value::SYMBOL, EPIPOLES[i].0).put(value::PICTURE, EPIPOLES[i].1);
        let (found, inliers) = match self.rectification(estimate) {
            Ok(found) => found,
            Err(Refusal::EpipoleInside { frame, at }) => {
                return of_epipole(step, frame).fact(value::EPIPOLE_INSIDE, at).say(case::EPIPOLE_INSIDE);
            }
            Err(Refusal::Planar(share)) => return step.fact(value::ON_PLANE, 100.0 * share).say(case::MEANINGLESS),
            Err(Refusal::Degenerate) => return step.say(case::IMPOSSIBLE),
        };
        let ((width, height), (frame, stretch)) = (found.size, found.stretch(estimate.size()));
        let off = found.row_error_px(&inliers);
        let step = step.put(value::HEIGHT, height).fact_as(value::WIDTH.is(width), case::SIZE);
        let step = match off {
            Some(off) => step.fact(value::ROW_ERROR, off),
            None => step.fact_as(value::ROW_ERROR.is("undefined"), case::NO_ROW_ERROR),
        };
        let step = step.fact(value::STRETCH, stretch).say(case::RECTIFIED);
        let step = step.show(Readout::Matrices(vec![
            Matrix::of_rows("H", "rectifies frame t", &found.maps[0]).with_role(Role::Reference),
            Matrix::of_rows("H′", "rectifies frame t+1", &found.maps[1]).with_role(Role::Result),
        ]));
        let (rows, before) = if off.is_some() { (case::ROWS_DIFFER, case::BUT) } else { (case::NO_ROWS, case::AND) };
        match beside_px(estimate, frame).filter(|_| stretch > DISTORTED) {
            Some(beside) => {
                let step = of_epipole(step, frame).put(value::BESIDE, beside);
                step.say(rows).say(before).say(case::DISTORTED)
            }
            None => step.say(rows).say(case::SEARCH),
        }
    }

    pub(super) fn draw_rectified(&self, estimate: &Estimate<'_>, scene: &mut Scene) {
        let Ok((found, inliers)) = self.rectification(estimate) else {
            scene.legend(Role::Rejected, "no rectified pair");
            return;
        };
        let pictures = [Picture::warped(0), Picture::warped(1)];
        let window = found.window();
        scene.pictures = (0..2)
            .map(|i| {
                let (frame, back) = (estimate.pair.frames[i].clone(), inverse(&found.maps[i]).unwrap_or(IDENTITY));
                Canvas::made(pictures[i], move || registered(&frame, &back, &window))
            })
            .collect();
        let few = inliers.iter().step_by(inliers.len().div_ceil(ROWS).max(1)).filter_map(|m| found.of(m));
        for Correspondence { from, to } in few {
            let [from, to] = [from, to].map(|at| at.map(|c| c as f32));
            let right = found.size.0 as f32 - 0.5;
            for (on, at) in pictures.into_iter().zip([from, to]) {
                let points = vec![[-0.5, from[1]], [right, from[1]]];
                scene.mark(on, Role::Predicted, Shape::line(points));
                scene.mark(on, Role::Result, Shape::circle(at, 3.0));
            }
            scene.legend(Role::Predicted, "epipolar line of a match");
            scene.legend(Role::Result, "matched keypoint");
        }
    }
}
