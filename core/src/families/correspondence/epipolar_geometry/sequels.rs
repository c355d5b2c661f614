//! What follows from the fundamental matrix: guided matching along epipolar lines, and the rectified pair.

use super::{EpipolarGeometry, Planarity, cut, line, line_of};
use crate::base::{Threads, words};
use crate::data::Clip;
use crate::methods::camera_path::matrix;
use crate::methods::geometric::Correspondence;
use crate::methods::geometric::epipolar::{epipoles, sampson_squared};
use crate::methods::geometric::rectify::{Rectification, Refusal, rectify};
use crate::methods::geometric::robust::{Best, Estimate, Sequel};
use crate::methods::matching::{Admits, Candidates};
use crate::methods::numbers::percent;
use crate::products::model::{IDENTITY, Matrix3, inverse};
use crate::products::registration::registered;
use crate::products::{Match, MatchField, MatchStatus};
use crate::scene::{Canvas, Fact, Focus, Link, Picture, Role, Scene, Sentence, Shape};

/// Largest number of rows drawn on the rectified pair.
const ROWS: usize = 12;

/// From this ratio of areas on, a rectified picture is mostly the surroundings of its epipole, and the rest of it a sliver.
const DISTORTED: f64 = 8.0;

/// Why the rectified pair is distorted, and what to use instead.
fn distortion(estimate: &Estimate<'_>, frame: usize, stretch: f64) -> Option<String> {
    let [x, y, w] = epipoles(&estimate.best?.matrix)?[frame];
    let (width, height) = estimate.size();
    let outside = |c: f64, extent: usize| (-c).max(c - (extent - 1) as f64).max(0.0);
    let beside = outside(x / w, width).hypot(outside(y / w, height));
    let which = if frame == 0 { "e lies only {} px beside frame t" } else { "e′ lies only {} px beside frame t+1" };
    Some(format!(
        ", but the epipole {}: areas next to it are magnified {} times as much as those far from it, so most of the picture is a sliver. Guided \
         matching needs no rectification; a polar rectification keeps the lengths of epipolar lines.",
        which.replace("{}", &words::grouped(beside.round() as usize)),
        words::fixed(stretch, 1)
    ))
}

/// The share of right ones among matches with a known true displacement, if there are any.
fn precision(all: &[Match], estimate: &Estimate<'_>) -> Option<f64> {
    MatchField::compare(all.iter(), estimate.truth?).precision()
}

/// What guidance does to the share of right matches, as a sentence.
fn effect(plain: &[Match], guided: &[Match], estimate: &Estimate<'_>) -> String {
    let alone = guided.iter().filter(|found| found.ratio.is_none()).count();
    match (precision(plain, estimate), precision(guided, estimate)) {
        (Some(before), Some(after)) if after < before => format!(
            " The share of right ones falls from {} to {}: wrong candidates near the line pass more easily, and {} without a second \
             candidate, so without a ratio test.",
            percent(before),
            percent(after),
            if alone == 1 { "1 match was".to_owned() } else { format!("{} matches were", words::grouped(alone)) }
        ),
        _ => String::new(),
    }
}

/// The number of matches, and of the right ones among them where the true displacement is known.
fn counted_matches(all: &[Match], estimate: &Estimate<'_>) -> String {
    let count = words::counted(all.len(), "match");
    let errors = estimate.truth.map(|truth| MatchField::compare(all.iter(), truth));
    match errors.filter(|errors| errors.known > 0) {
        Some(errors) => format!("{count}, {} of {} right", words::grouped(errors.right), words::grouped(errors.known)),
        None => count,
    }
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
        // The clip only cancels the work, and there is none to cancel.
        let clip = Clip::blank("a pair of frames", estimate.size(), 2);
        let mut all = self.matching.matches(estimate.pair, &clip, &Threads::single()).unwrap_or_default();
        all.retain(|found| found.status == MatchStatus::Match);
        all
    }

    pub(super) fn guided(&self, estimate: &Estimate<'_>, focus: Option<Focus>) -> Sequel {
        let Some(Best { matrix, .. }) = estimate.best else { return Sequel::default() };
        let (plain, found) = (self.unguided(estimate), self.along_lines(estimate, &matrix));
        let limit = words::fine(self.robust.threshold);
        let mut facts = vec![
            Fact::new("Unguided", counted_matches(&plain, estimate), Some(Role::Reference)),
            Fact::new("Guided", counted_matches(&found, estimate), Some(Role::Result)),
        ];
        if let Some((_, near)) = self.example(estimate, &matrix, (&found, focus)) {
            let of = estimate.pair.sides[1].points.len();
            facts.push(Fact::new(
                "Candidates near the line",
                format!("{} of {}", words::grouped(near.len()), words::grouped(of)),
                Some(Role::Candidate),
            ));
        }
        let sentence = Sentence::default()
            .text(format!("Guided matching compares each keypoint only with those within {limit} px of its epipolar line: "))
            .ink(Role::Result, counted_matches(&found, estimate))
            .text(format!(
                ". Without guidance there are {}. Fewer candidates look alike, so the ratio test rejects fewer correct matches; keypoints \
                 off the line are not matched at all.{}",
                counted_matches(&plain, estimate),
                effect(&plain, &found, estimate)
            ));
        Sequel { line: Some(line::GUIDE), sentence, facts, matrices: Vec::new() }
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
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Ellipse { center: from, radii: [4.0; 2], angle_rad: 0.0 });
        scene.legend(Role::Measured, "keypoint");
        if let Some(ends) = cut(line_of(&matrix, from.map(f64::from)), estimate.size()) {
            scene.mark(Picture::NEXT, Role::Predicted, Shape::Path { points: ends.to_vec(), closed: false });
            scene.legend(Role::Predicted, "its epipolar line");
        }
        for center in near {
            scene.mark(Picture::NEXT, Role::Candidate, Shape::Ellipse { center, radii: [3.0; 2], angle_rad: 0.0 });
            scene.legend(Role::Candidate, "candidate near the line");
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

    pub(super) fn rectified(&self, estimate: &Estimate<'_>) -> Sequel {
        let said = Sentence::default();
        let (sentence, facts, matrices) = match self.rectification(estimate) {
            Ok((found, inliers)) => {
                let (width, height) = found.size;
                let off = found.row_error_px(&inliers).map_or_else(|| "none".into(), |off| words::fixed(off, 2));
                let (frame, stretch) = found.stretch(estimate.size());
                let facts = vec![
                    Fact::new("Rectified pictures", format!("{width}×{height} px"), None),
                    Fact::new("Mean difference of rows", format!("{off} px"), Some(Role::Result)),
                    Fact::new("Largest ratio of areas", words::fixed(stretch, 1), None),
                ];
                let matrices = vec![
                    matrix("H", "rectifies frame t", Role::Reference, &found.maps[0]),
                    matrix("H′", "rectifies frame t+1", Role::Result, &found.maps[1]),
                ];
                let sentence = said
                    .text("Rectification: both frames are warped so that epipolar lines are horizontal and corresponding ones lie in the same row. The rows of the inliers differ by ")
                    .ink(Role::Result, format!("{off} px"))
                    .text(" on average");
                let use_of_it = || "; the search for a match is along a row, as in stereo vision.".to_owned();
                let distorted = (stretch > DISTORTED).then(|| distortion(estimate, frame, stretch)).flatten();
                (sentence.text(distorted.unwrap_or_else(use_of_it)), facts, matrices)
            }
            Err(Refusal::EpipoleInside { frame, at }) => {
                let which = if frame == 0 { "e lies inside frame t" } else { "e′ lies inside frame t+1" };
                let at = words::place(at.map(|c| c as f32));
                let sentence = said.ink(Role::Rejected, "Rectification is impossible").text(format!(
                    ": the epipole {which} at {at}. A homography that sends it to infinity tears the picture. So it is where a camera moves toward the \
                     scene, or where few points determine F. A polar rectification would be needed."
                ));
                (sentence, vec![Fact::new("Epipole inside", format!("{at} px"), Some(Role::Rejected))], Vec::new())
            }
            Err(Refusal::Planar(share)) => {
                let sentence = said
                    .ink(Role::Rejected, "Rectification would mean nothing")
                    .text(": the fundamental matrix is not determined where a homography is the better model.");
                let fact = Fact::new("Explained by a homography", percent(share), Some(Role::Rejected));
                (sentence, vec![fact], Vec::new())
            }
            Err(Refusal::Degenerate) => {
                let sentence = said
                    .ink(Role::Rejected, "Rectification is impossible")
                    .text(": the fundamental matrix does not determine both homographies, or they tear a picture.");
                (sentence, Vec::new(), Vec::new())
            }
        };
        Sequel { line: Some(line::RECTIFY), sentence, facts, matrices }
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
                scene.mark(on, Role::Predicted, Shape::Path { points, closed: false });
                scene.mark(on, Role::Result, Shape::Ellipse { center: at, radii: [3.0; 2], angle_rad: 0.0 });
            }
            scene.legend(Role::Predicted, "epipolar line of a match");
            scene.legend(Role::Result, "matched keypoint");
        }
    }
}
