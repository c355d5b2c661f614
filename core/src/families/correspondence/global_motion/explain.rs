//! The explanation and the drawing of the estimation of global motion.

use super::mosaic::mosaic;
use super::{Best, Event, GlobalMotion, State, line};
use crate::base::words::{self, grouped};
use crate::geometry::Grid;
use crate::methods::geometric::{
    Correspondence,
    fit::squared_error,
    ransac::{Score, Scoring},
};
use crate::products::metrics;
use crate::products::model::{Matrix3, Model, mapped};
use crate::run::Seen;
use crate::scene::{
    Canvas, Fact, Link, Math, Matrix, Name, Picture, PictureRole, Readout, Role, Scene, Sentence, Series, Shape, Step,
};

/// Frames registered in the coordinates of frame t.
const MOSAIC: Picture = Picture { role: PictureRole::Mosaic, ..Picture::CURRENT };

fn px(value: f64) -> String {
    words::fixed(value, 2)
}

/// The name of a model in a sentence.
fn called(model: Model) -> &'static str {
    match model {
        Model::Translation => "translation",
        Model::Rigid => "rigid motion",
        Model::Similarity => "similarity",
        Model::Affine => "affine map",
        Model::Homography => "homography",
    }
}

fn rms(score: &Score) -> f64 {
    (score.squared / score.inliers.max(1) as f64).sqrt()
}

impl GlobalMotion {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let Some(last) = seen.events.last() else {
            let sentence = format!(
                "{} passed the ratio test and the cross-check. Some are still wrong, so least squares over all would be wrong too: RANSAC seeks \
                 the {} with which most of them agree.",
                words::counted(state.fixed.matches.len(), "match").replace("matchs", "matches"),
                called(self.model)
            );
            return Step { line: line::MATCH, sentence: Sentence::default().text(sentence), readouts: Vec::new() };
        };
        let (line, sentence) = self.said(seen, last);
        let sentence = match seen.after {
            Some(after) if after.fitted.is_some() => self.concluded(after, sentence),
            _ => sentence,
        };
        Step { line, sentence, readouts: self.readouts(seen, last) }
    }

    fn said(&self, seen: &Seen<Self>, event: &Event) -> (Name, Sentence) {
        let (state, said) = (seen.before, Sentence::default());
        let (count, size) = (state.fixed.points.len(), self.model.sample_size());
        match event {
            Event::TooFew => (line::REPEAT, said.text(self.too_few(count))),
            Event::Sample(_) => {
                let each = if size == 1 { "a match".to_owned() } else { format!("{size} matches") };
                let told = format!(
                    "Iteration {}: a random sample of {each}. Each gives two equations, and the {} has {} degrees of freedom.",
                    state.iterations + 1,
                    called(self.model),
                    self.model.freedom()
                );
                (line::DRAW, said.text(told))
            }
            Event::Hypothesis(None) => {
                let told = "The sample determines no model: its points lie on a line or at one place, or on both sides of the horizon. It is skipped.";
                (line::HYPOTHESISE, said.ink(Role::Rejected, told))
            }
            Event::Hypothesis(Some(_)) => {
                let told = format!(
                    "The {} through the sample is the hypothesis H; it is right if all of the sample are inliers.",
                    called(self.model)
                );
                (line::HYPOTHESISE, said.text(told))
            }
            Event::Scored(score) => (line::COUNT, self.scored_said(state, score)),
            Event::Local(_, score) => {
                let told = format!(
                    "Local optimisation: fitted to its inliers, H has {} inliers with an rms distance of {} px.",
                    grouped(score.inliers),
                    px(rms(score))
                );
                (line::OPTIMISE, said.text(told))
            }
            Event::Best(needed) => (line::KEEP_BEST, said.text(self.best_said(seen, *needed))),
            Event::Refit(_, score) => {
                let told = format!(
                    "Least squares over all inliers: {} of {} matches are inliers, rms distance {} px.",
                    grouped(score.inliers),
                    grouped(count),
                    words::fixed(rms(score), 3)
                );
                (line::REFIT, said.ink(Role::Result, told))
            }
        }
    }

    fn too_few(&self, count: usize) -> String {
        let size = self.model.sample_size();
        let name = called(self.model);
        match count < size {
            true => format!(
                "{count} of the needed {size} matches: too few for this model ({name}). A higher ratio limit, a detector with a lower threshold \
                 or a simpler model helps."
            ),
            false => format!(
                "No sample of {count} matches determined this model ({name}): their points lie on a line or at one place."
            ),
        }
    }

    fn scored_said(&self, state: &State, score: &Score) -> Sentence {
        let said = Sentence::default().ink(Role::Candidate, format!("{} inliers", grouped(score.inliers)));
        let said = said.text(format!(
            " of {} matches lie within {} px of H x",
            grouped(state.fixed.points.len()),
            words::fine(self.threshold)
        ));
        let cost = match self.scoring {
            Scoring::Msac => format!(" (MSAC cost {} px²)", words::fixed(score.cost, 1)),
            _ => String::new(),
        };
        let said = said.text(cost);
        match state.best {
            None => said.text(": the first hypothesis, so the best so far."),
            Some(best) if score.is_better(&best.score) => {
                said.text(format!(": better than {} so far.", grouped(best.score.inliers)))
            }
            Some(best) => {
                said.text(format!(": not better than the best, {} so far. Discarded.", grouped(best.score.inliers)))
            }
        }
    }

    /// The best hypothesis at the end of the events so far.
    fn best_now(&self, seen: &Seen<Self>) -> Option<(Matrix3, Score)> {
        let mut matrix = None;
        let mut best = seen.before.best.map(|best| (best.matrix, best.score));
        let mut candidate: Option<(Matrix3, Score)> = None;
        for event in seen.events {
            match event {
                Event::Hypothesis(found) => matrix = *found,
                Event::Scored(score) => candidate = matrix.map(|matrix| (matrix, *score)),
                Event::Local(matrix, score) => candidate = Some((*matrix, *score)),
                Event::Best(_) => best = candidate,
                Event::Refit(matrix, score) => best = Some((*matrix, *score)),
                Event::TooFew | Event::Sample(_) => {}
            }
        }
        best
    }

    fn best_said(&self, seen: &Seen<Self>, needed: usize) -> String {
        let (count, size) = (seen.before.fixed.points.len(), self.model.sample_size());
        let inliers = self.best_now(seen).map_or(0, |(_, score)| score.inliers);
        let share = inliers as f64 / count as f64;
        let iterations = words::counted(needed, "iteration");
        let why = match needed == self.max_iterations {
            true => format!("the maximum of {iterations} is kept"),
            false => format!(
                "{iterations} contain a sample without outliers with a probability of {} %",
                words::fixed(100.0 * f64::from(self.confidence), 1)
            ),
        };
        format!(
            "New best hypothesis: with a share of inliers w = {} all {size} of a sample are inliers with probability wⁿ = {}, so {why}.",
            words::fixed(share, 3),
            words::fixed(share.powi(size as i32), 3)
        )
    }

    fn concluded(&self, after: &State, sentence: Sentence) -> Sentence {
        let Some(Best { matrix, score }) = after.fitted else { return sentence };
        let count = after.fixed.points.len();
        let error = self.error(after);
        let quality =
            error.map_or_else(String::new, |error| format!(" Mean endpoint error {} px.", words::fixed(error, 3)));
        let advice = match score.inliers * 2 < count {
            true => {
                "Fewer than half of the matches agree: parallax or moving objects need a model with more freedom, or local motion."
            }
            false => "Outliers are wrong matches, moving objects, or depth that the model cannot explain.",
        };
        sentence.text(format!(
            " End of the run after {}: {}.{quality} {advice}",
            words::counted(after.iterations, "iteration"),
            described(self.model, &matrix)
        ))
    }

    /// Mean endpoint error against the true flow.
    fn error(&self, state: &State) -> Option<f64> {
        let truth = state.fixed.truth.as_ref()?;
        let flow = self.model_of(state).displacements_of_pixels();
        metrics::flow_error(&flow, truth).ok().flatten().map(|error| error.epe_px)
    }

    fn readouts(&self, seen: &Seen<Self>, event: &Event) -> Vec<Readout> {
        let state = seen.before;
        let (count, best) = (state.fixed.points.len(), self.best_now(seen));
        let mut facts = vec![
            Fact::new("Matches", grouped(count), None),
            Fact::new("Iterations", grouped(state.iterations + usize::from(!matches!(event, Event::Refit(..)))), None),
        ];
        let inliers = |score: &Score| format!("{} of {}", grouped(score.inliers), grouped(count));
        facts.extend(best.map(|(_, score)| Fact::new("Inliers of the best", inliers(&score), Some(Role::Best))));
        facts.extend(
            best.map(|(_, score)| Fact::new("rms distance", format!("{} px", words::fixed(rms(&score), 3)), None)),
        );
        let needed = if let Event::Best(needed) = event { *needed } else { state.needed };
        facts.push(Fact::new("Iterations needed", grouped(needed), None));
        let mut all = vec![Readout::Facts(facts)];
        all.extend(best.map(|(_, score)| Readout::Equation(self.needed_equation(&score, count, needed))));
        all.push(Readout::Matrices(self.matrices(seen, best)));
        all.extend(self.series(seen, best).map(Readout::Series));
        all
    }

    /// N = log(1 − p) / log(1 − wⁿ), in symbols and in numbers.
    fn needed_equation(&self, score: &Score, count: usize, needed: usize) -> Vec<Math> {
        let share = score.inliers as f64 / count as f64;
        let size = self.model.sample_size();
        let log = |inner: Vec<Math>| Math::Row([vec![Math::text("log(1 − ")], inner, vec![Math::text(")")]].concat());
        let symbols = Math::Row(vec![
            Math::Var("N"),
            Math::text(" = "),
            Math::over(log(vec![Math::Var("p")]), log(vec![Math::power(Math::Var("w"), Math::Var("n"))])),
        ]);
        let numbers = Math::Row(vec![
            Math::text("= "),
            Math::over(
                log(vec![Math::text(format!("{}", self.confidence))]),
                log(vec![Math::power(Math::ink(Role::Best, words::fixed(share, 3)), Math::text(size.to_string()))]),
            ),
            Math::text(format!(", so {} (at most {})", grouped(needed), grouped(self.max_iterations))),
        ]);
        vec![symbols, numbers]
    }

    /// The hypothesis and the best model.
    fn matrices(&self, seen: &Seen<Self>, best: Option<(Matrix3, Score)>) -> Vec<Matrix> {
        let hypothesis = seen.events.iter().rev().find_map(|event| match event {
            Event::Hypothesis(found) => *found,
            _ => None,
        });
        let matrix = |symbol, name, role, entries: Matrix3| Matrix {
            symbol,
            name,
            role: Some(role),
            entries: Grid::from_fn(3, 3, |x, y| entries[y][x]),
            rows: Vec::new(),
            columns: Vec::new(),
            changed: None,
        };
        let mut all = Vec::new();
        all.extend(hypothesis.map(|found| matrix("H", "hypothesis", Role::Candidate, found)));
        all.extend(best.map(|(found, _)| matrix("H", "best so far", Role::Best, found)));
        all
    }

    /// Inliers of the best hypothesis over the iterations.
    fn series(&self, seen: &Seen<Self>, best: Option<(Matrix3, Score)>) -> Option<Series> {
        let mut points: Vec<[f32; 2]> =
            seen.before.history.iter().enumerate().map(|(i, inliers)| [(i + 1) as f32, *inliers as f32]).collect();
        if !matches!(seen.events.last(), Some(Event::Refit(..))) {
            points.push([(seen.before.iterations + 1) as f32, best.map_or(0.0, |(_, score)| score.inliers as f32)]);
        }
        (!points.is_empty()).then(|| Series {
            title: "Inliers of the best hypothesis",
            x_label: "iteration",
            y_label: "inliers",
            x_max: points.len().max(seen.before.needed.min(4 * points.len())),
            lines: vec![("inliers", Role::Best, points)],
            ..Series::default()
        })
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let Some(last) = seen.events.last() else {
            scene.legend(Role::Reference, "match");
            for found in &state.fixed.matches {
                scene.links.push(link(Role::Reference, found.from, found.to));
            }
            return;
        };
        let shown = seen.events.iter().rev().find_map(|event| match event {
            Event::Hypothesis(Some(matrix)) | Event::Local(matrix, _) | Event::Refit(matrix, _) => Some(*matrix),
            _ => None,
        });
        self.draw_matches(state, shown, scene);
        if let Some(Event::Sample(indices)) = seen.events.iter().find(|event| matches!(event, Event::Sample(_))) {
            let points = |side: fn(&Correspondence) -> [f64; 2]| {
                indices.iter().map(|i| side(&state.fixed.points[*i]).map(|c| c as f32)).collect::<Vec<_>>()
            };
            for (on, at) in [(Picture::CURRENT, points(|m| m.from)), (Picture::NEXT, points(|m| m.to))] {
                at.into_iter().for_each(|center| {
                    scene.mark(on, Role::Candidate, Shape::Ellipse { center, radii: [4.0; 2], angle_rad: 0.0 });
                });
            }
            scene.legend(Role::Candidate, "sample");
        }
        if let Some(matrix) = shown {
            self.draw_outline(state, &matrix, scene);
        }
        if let (Event::Refit(matrix, _), Some(_)) = (last, seen.after) {
            let (frames, matrix) = (state.fixed.pair.frames.clone(), *matrix);
            let made = move || mosaic([frames[0].luma(), frames[1].luma()], &matrix);
            scene.pictures =
                vec![Canvas::of_clip(Picture::CURRENT), Canvas::of_clip(Picture::NEXT), Canvas::made(MOSAIC, made)];
        }
    }

    /// Inliers and outliers of a model.
    fn draw_matches(&self, state: &State, shown: Option<Matrix3>, scene: &mut Scene) {
        let limit = f64::from(self.threshold).powi(2);
        for (found, point) in state.fixed.matches.iter().zip(&state.fixed.points) {
            let (role, meaning) = match shown {
                None => (Role::Reference, "match"),
                Some(matrix) if squared_error(&matrix, point) <= limit => (Role::Result, "inlier"),
                Some(_) => (Role::Rejected, "outlier"),
            };
            scene.links.push(link(role, found.from, found.to));
            scene.legend(role, meaning);
        }
    }

    /// The outline of frame t where the model maps it to in frame t + 1.
    fn draw_outline(&self, state: &State, matrix: &Matrix3, scene: &mut Scene) {
        let (width, height) = state.fixed.pair.frames[0].size();
        let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
        let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
        let moved = corners.iter().map(|corner| mapped(matrix, *corner)).collect::<Option<Vec<_>>>();
        let Some(moved) = moved else { return };
        // Far beyond the picture there is nothing to see.
        let reach = 4.0 * right.max(bottom);
        if moved.iter().flatten().all(|c| c.abs() < reach) {
            let points = moved.into_iter().map(|at| at.map(|c| c as f32)).collect();
            scene.mark(Picture::NEXT, Role::Window, Shape::Path { points, closed: true });
            scene.legend(Role::Window, "outline of frame t");
        }
    }
}

fn link(role: Role, from: [f32; 2], to: [f32; 2]) -> Link {
    Link { role, ends: [(Picture::CURRENT, from), (Picture::NEXT, to)] }
}

/// A model in words: its translation, rotation and scale where these are defined.
fn described(model: Model, matrix: &Matrix3) -> String {
    let [[a, _, u], [c, _, v], _] = *matrix;
    let motion = format!("translation ({}, {}) px", px(u), px(v));
    let degrees = words::fixed(c.atan2(a).to_degrees(), 2);
    match model {
        Model::Translation => motion,
        Model::Rigid => format!("rotation {degrees}°, {motion}"),
        Model::Similarity => format!("rotation {degrees}°, scale {}, {motion}", words::fixed(a.hypot(c), 3)),
        Model::Affine | Model::Homography => format!("{} with the {motion} at the origin", called(model)),
    }
}
