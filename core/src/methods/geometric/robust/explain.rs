//! The explanation and the drawing of robust estimation.

use super::declare::line;
use super::doubt::{Doubt, LEAST_SPREAD_PX, distinct};
use super::{
    Best, Consensus, Estimate, Event, Fixed, InlierCounts, Place, Robust, RobustModel, Sequel, Settings, State,
};
use crate::base::words::{self, grouped};
use crate::data::Clip;
use crate::geometry::Grid;
use crate::methods::geometric::Correspondence;
use crate::methods::geometric::ransac::{Score, Scoring, chosen};
use crate::methods::geometric::system::System;
use crate::products::model::Matrix3;
use crate::run::Seen;
use crate::scene::{Fact, Link, Math, Matrix, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// The RMS distance of the inliers, if there are any.
fn rms(score: &Score) -> String {
    match score.inliers {
        0 => "undefined".into(),
        count => format!("{} px", words::fixed((score.squared / count as f64).sqrt(), 3)),
    }
}

fn matches(count: usize) -> String {
    if count == 1 { "1 match".into() } else { format!("{} matches", grouped(count)) }
}

impl<M: RobustModel> Robust<M> {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let Some(last) = seen.events.last() else {
            let sentence = format!(
                "{} passed the ratio test and the cross-check. Some are still wrong, so least squares over all would be wrong too: RANSAC seeks \
                 the {} with the most inliers.",
                matches(state.fixed.matches.len()),
                self.0.name()
            );
            return Step {
                values: Vec::new(),
                line: line::MATCH,
                sentence: Sentence::default().text(sentence),
                readouts: Vec::new(),
            };
        };
        let (line, sentence) = self.said(seen, last);
        let sentence = match seen.after {
            Some(after) => self.concluded(seen.clip, after, sentence),
            None => sentence,
        };
        Step { values: Vec::new(), line, sentence, readouts: self.readouts(seen, last) }
    }

    fn said(&self, seen: &Seen<Self>, event: &Event) -> (Name, Sentence) {
        let (state, said) = (seen.before, Sentence::default());
        let (count, size) = (state.fixed.points.len(), self.0.sample_size());
        match event {
            Event::TooFew => (line::REPEAT, said.text(self.too_few(&state.fixed, state.consensus.iterations))),
            Event::Sample(_) => {
                let sentence = format!(
                    "Iteration {}: a random sample of {}. {}",
                    state.consensus.iterations + 1,
                    matches(size),
                    self.0.counting()
                );
                (line::DRAW, said.text(sentence))
            }
            Event::Degenerate => {
                let drawn = seen.events.iter().rev().find_map(|event| match event {
                    Event::Sample(indices) => Some(chosen(&state.fixed.points, indices)),
                    _ => None,
                });
                let drawn = drawn.unwrap_or_default();
                let why = match distinct(&drawn) < drawn.len() {
                    true => "some of its matches share a position".to_owned(),
                    false => self.0.why_none(&drawn),
                };
                let said = said.ink(Role::Rejected, "The sample determines no model");
                (line::HYPOTHESISE, said.text(format!(": {why}. It is skipped.")))
            }
            Event::Hypothesis(_) => {
                let sentence = format!(
                    "The {} through the sample is the hypothesis {}; it is right if all of the sample are inliers.",
                    self.0.name(),
                    M::SYMBOL
                );
                (line::HYPOTHESISE, said.text(sentence))
            }
            Event::Scored(score) => (line::COUNT, self.scored_said(state, score)),
            Event::Local(_, score) => {
                let sentence = format!(
                    "Local optimisation: fitted to its inliers, the model has {} inliers with an RMS distance of {}.",
                    grouped(score.inliers),
                    rms(score)
                );
                (line::OPTIMISE, said.text(sentence))
            }
            Event::Best(needed) => (line::KEEP_BEST, said.text(self.best_said(seen, *needed))),
            Event::Resampled(tried, _, score) => {
                let told = format!(
                    "Local optimisation of the best hypothesis: {} fitted to {} of its inliers each, then to their own inliers. The best of all has {} \
                     inliers and a cost of {} px².",
                    words::counted(*tried, "model"),
                    grouped(self.0.resample_size()),
                    grouped(score.inliers),
                    words::fixed(score.cost, 1)
                );
                (line::OPTIMISE, said.text(told))
            }
            Event::Sequel(index, best) => {
                let Sequel { line, sentence, .. } = self.0.sequel(*index, &ended(state, *best), seen.focus);
                (line.unwrap_or(line::REFIT), sentence)
            }
            Event::Refit(_, score) => {
                let said = said
                    .text("Least squares over all inliers: ")
                    .ink(Role::Result, format!("{} of {} matches", grouped(score.inliers), grouped(count)))
                    .text(format!(" are inliers, RMS distance {}.", rms(score)));
                (line::REFIT, said)
            }
            Event::Kept(_, score) => {
                let said = said
                    .text("Least squares over all inliers finds no smaller distances, so the model stays: ")
                    .ink(Role::Result, format!("{} of {} matches", grouped(score.inliers), grouped(count)))
                    .text(format!(" are inliers, RMS distance {}.", rms(score)));
                (line::REFIT, said)
            }
            Event::Doubted(doubt) => (
                line::REFIT,
                said.ink(Role::Rejected, "The model is rejected").text(self.doubted(*doubt, &state.fixed)),
            ),
        }
    }

    /// Why the model is rejected, as the end of a sentence.
    fn doubted(&self, doubt: Doubt, fixed: &Fixed) -> String {
        let name = self.0.name();
        match doubt {
            Doubt::OnLine { inliers, spread_px } => format!(
                ": its {} inliers lie on a line, with an RMS distance of {} px from it, and the {name} needs at least {} px. A \
                 similarity or a translation is determined by them.",
                grouped(inliers),
                words::fixed(spread_px, 2),
                words::fixed(LEAST_SPREAD_PX, 2)
            ),
            Doubt::ByChance { inliers, needed } => format!(
                ": {} of {} matches{} are inliers, and random matches may have as many (number of false alarms at least \
                 1). At least {} inliers are needed; more keypoints, better matches or a simpler model help.",
                grouped(inliers),
                grouped(fixed.distinct),
                if fixed.distinct < fixed.points.len() { " at distinct positions" } else { "" },
                grouped(needed)
            ),
        }
    }

    fn too_few(&self, fixed: &Fixed, iterations: usize) -> String {
        let (size, name, count) = (self.0.sample_size(), self.0.name(), fixed.points.len());
        let help = "A higher ratio limit, a detector with a lower threshold or a simpler model helps.";
        match (count < size, fixed.distinct < size) {
            (true, _) => format!("{count} of the needed {size} matches: too few for this model ({name}). {help}"),
            (false, true) => format!(
                "{} of the needed {size} distinct positions: the {} are too few for this model ({name}), as keypoints with several \
                 orientations at one point count once. {help}",
                fixed.distinct,
                matches(count)
            ),
            (false, false) => format!(
                "0 of {} of {size} matches determined this model ({name}): the points lie on a line or at one place. A simpler model helps.",
                words::counted(iterations, "sample")
            ),
        }
    }

    fn scored_said(&self, state: &State, score: &Score) -> Sentence {
        let said = Sentence::default().ink(Role::Candidate, format!("{} inliers", grouped(score.inliers)));
        let said = said.text(format!(
            " of {} matches have a {} of at most {} px",
            grouped(state.fixed.points.len()),
            M::DISTANCE,
            words::fine(self.0.settings().threshold)
        ));
        if self.0.settings().scoring == Scoring::Ransac {
            return match state.consensus.best {
                None => said.text(": the first hypothesis, so the best so far."),
                Some(best) if score.is_better(&best.score) => {
                    said.text(format!(": better than {} so far.", grouped(best.score.inliers)))
                }
                Some(best) => {
                    said.text(format!(": not better than the best, {} so far. Discarded.", grouped(best.score.inliers)))
                }
            };
        }
        let cost = |score: &Score| words::fixed(score.cost, 3);
        let said = said.text(format!(", MSAC cost {} px²", cost(score)));
        match state.consensus.best {
            None => said.text(": the first hypothesis, so the best so far."),
            Some(best) if score.is_better(&best.score) => {
                said.text(format!(": lower than {} px² so far, so better.", cost(&best.score)))
            }
            Some(best) => {
                said.text(format!(": not below the lowest cost so far, {} px². Discarded.", cost(&best.score)))
            }
        }
    }

    /// The best model at the end of the events so far: the best hypothesis, or the fit to its inliers.
    fn best_now(&self, seen: &Seen<Self>) -> Option<(Matrix3, Score)> {
        let mut best = self.best_hypothesis(seen);
        for event in seen.events {
            match event {
                Event::Resampled(_, matrix, score)
                | Event::Refit(matrix, score)
                | Event::Kept(matrix, score)
                | Event::Sequel(_, Best { matrix, score }) => best = Some((*matrix, *score)),
                Event::Doubted(_) => best = None,
                _ => {}
            }
        }
        best
    }

    /// The best hypothesis at the end of the events so far, from which the number of iterations follows.
    fn best_hypothesis(&self, seen: &Seen<Self>) -> Option<(Matrix3, Score)> {
        let mut matrix = None;
        let mut best = seen.before.consensus.best.map(|best| (best.matrix, best.score));
        let mut candidate: Option<(Matrix3, Score)> = None;
        for event in seen.events {
            match event {
                Event::Hypothesis(found) => matrix = Some(*found),
                Event::Scored(score) => candidate = matrix.map(|matrix| (matrix, *score)),
                Event::Local(matrix, score) => candidate = Some((*matrix, *score)),
                Event::Best(_) => best = candidate,
                _ => {}
            }
        }
        best
    }

    fn best_said(&self, seen: &Seen<Self>, needed: usize) -> String {
        let (count, size) = (seen.before.fixed.points.len(), self.0.sample_size());
        let Settings { confidence, max_iterations, .. } = *self.0.settings();
        let inliers = self.best_now(seen).map_or(0, |(_, score)| score.inliers);
        let share = inliers as f64 / count as f64;
        let iterations = words::counted(needed, "iteration");
        let why = match needed == max_iterations {
            true => format!("the maximum of {iterations} is kept"),
            false => format!(
                "a sample without outliers is drawn in {iterations} with probability {} %",
                words::fixed(100.0 * f64::from(confidence), 1)
            ),
        };
        format!(
            "New best hypothesis: with a share of inliers w = {}, a sample of {size} has no outliers with probability wⁿ = {}, so {why}.",
            words::fixed(share, 3),
            words::fixed(share.powi(size as i32), 3)
        )
    }

    fn concluded(&self, clip: &Clip, after: &State, sentence: Sentence) -> Sentence {
        let Some(Best { matrix, .. }) = after.consensus.fitted else { return sentence };
        let inliers = self.inliers(&after.fixed.points, &matrix);
        // A truth that cannot be read is reported with the figures.
        let foreground = clip.truth().and_then(|truth| truth.foreground(after.fixed.frame).ok().flatten());
        let place = Place::of(&inliers, foreground.as_deref(), clip.size());
        let conclusion = self.0.conclusion(&Estimate { place: Some(place), ..after.estimate() });
        sentence.text(format!(
            " End of the run after {}: {conclusion}",
            words::counted(after.consensus.iterations, "iteration")
        ))
    }

    fn readouts(&self, seen: &Seen<Self>, event: &Event) -> Vec<Readout> {
        let state = seen.before;
        let (count, best) = (state.fixed.points.len(), self.best_now(seen));
        let mut facts = vec![
            Fact::new("Matches", grouped(count), None),
            Fact::new("Iterations", grouped(state.consensus.iterations + usize::from(!is_last(event))), None),
        ];
        let inliers = |score: &Score| format!("{} of {}", grouped(score.inliers), grouped(count));
        facts.extend(best.map(|(_, score)| Fact::new("Inliers of the best", inliers(&score), Some(Role::Best))));
        facts.extend(best.map(|(_, score)| Fact::new("RMS distance", rms(&score), None)));
        let needed = if let Event::Best(needed) = event { *needed } else { state.consensus.needed };
        facts.push(Fact::new("Iterations needed", grouped(needed), None));
        let sequel = match event {
            Event::Sequel(index, best) => self.0.sequel(*index, &ended(state, *best), seen.focus),
            _ => Sequel::default(),
        };
        facts.extend(sequel.facts);
        let system = self.system(seen, event);
        facts.extend(system.facts);
        let mut all = vec![Readout::Facts(facts)];
        // The final fit has other inliers than the hypothesis that the number of iterations follows from.
        let hypothesis = self.best_hypothesis(seen);
        all.extend(hypothesis.map(|(_, score)| Readout::Equation(self.equation(seen, &score, needed))));
        all.push(Readout::Matrices(match sequel.matrices.is_empty() {
            true => [self.matrices(seen, best), system.matrices].concat(),
            false => sequel.matrices,
        }));
        all.extend(self.series(seen, best).map(Readout::Series));
        all
    }

    /// The formulas about the final model, or N = log(1 − p) / log(1 − wⁿ) in symbols and in numbers.
    fn equation(&self, seen: &Seen<Self>, score: &Score, needed: usize) -> Vec<Math> {
        let own = seen
            .after
            .filter(|after| after.consensus.fitted.is_some())
            .map(|after| self.0.equations(&after.estimate()));
        if let Some(own) = own.filter(|own| !own.is_empty()) {
            return own;
        }
        let share = score.inliers as f64 / seen.before.fixed.points.len() as f64;
        let Settings { confidence, max_iterations, .. } = *self.0.settings();
        let log = |inner: Vec<Math>| Math::Row([vec![Math::text("log(1 − ")], inner, vec![Math::text(")")]].concat());
        let symbols = Math::Row(vec![
            Math::Var("N"),
            Math::text(" = "),
            Math::over(log(vec![Math::Var("p")]), log(vec![Math::power(Math::Var("w"), Math::Var("n"))])),
        ]);
        let share = Math::ink(Role::Best, words::fixed(share, 3));
        let power = Math::power(share, Math::text(self.0.sample_size().to_string()));
        let numbers = Math::Row(vec![
            Math::text("= "),
            Math::over(log(vec![Math::text(confidence.to_string())]), log(vec![power])),
            Math::text(format!(", so {} (at most {})", grouped(needed), grouped(max_iterations))),
        ]);
        vec![symbols, numbers]
    }

    /// The linear system behind the model of an event: of the sample, or of all inliers, where the refinement begins.
    fn system(&self, seen: &Seen<Self>, event: &Event) -> System {
        let points = &seen.before.fixed.points;
        let solved: Vec<Correspondence> = match event {
            Event::Hypothesis(_) => match seen.events.iter().rev().find(|event| matches!(event, Event::Sample(_))) {
                Some(Event::Sample(indices)) => chosen(points, indices),
                _ => Vec::new(),
            },
            Event::Local(matrix, _) | Event::Refit(matrix, _) | Event::Kept(matrix, _) => {
                let are_inliers = self.are_inliers(points, matrix);
                points.iter().zip(are_inliers).filter_map(|(point, is_inlier)| is_inlier.then_some(*point)).collect()
            }
            _ => Vec::new(),
        };
        if solved.is_empty() {
            return System::default();
        }
        let system = self.0.system(&solved);
        if matches!(event, Event::Hypothesis(_)) { system } else { system.before_refinement() }
    }

    /// The hypothesis and the best model.
    fn matrices(&self, seen: &Seen<Self>, best: Option<(Matrix3, Score)>) -> Vec<Matrix> {
        let hypothesis = seen.events.iter().rev().find_map(|event| match event {
            Event::Hypothesis(found) => Some(*found),
            _ => None,
        });
        let matrix = |name, role, entries: Matrix3| Matrix {
            symbol: M::SYMBOL,
            name,
            role: Some(role),
            entries: Grid::from_fn(3, 3, |x, y| entries[y][x]),
            rows: Vec::new(),
            columns: Vec::new(),
            changed: None,
            decimals: None,
        };
        let mut all = Vec::new();
        all.extend(hypothesis.map(|found| matrix("hypothesis", Role::Candidate, found)));
        all.extend(best.map(|(found, _)| matrix("best so far", Role::Best, found)));
        all
    }

    /// Inliers of each iteration's hypothesis, and of the best so far. There are none before the first are counted.
    fn series(&self, seen: &Seen<Self>, best: Option<(Matrix3, Score)>) -> Option<Series> {
        let Consensus { history, needed, .. } = &seen.before.consensus;
        let mut counts = history.clone();
        if !seen.events.last().is_some_and(is_last) {
            let counted = |event: &Event| if let Event::Scored(score) = event { Some(score.inliers) } else { None };
            let own = seen.events.iter().filter_map(counted).max();
            counts.push(InlierCounts { own, best: best.map(|(_, score)| score.inliers) });
        }
        let line = |of: fn(&InlierCounts) -> Option<usize>| -> Vec<[f32; 2]> {
            let value = |(i, counts)| [(i + 1) as f32, of(counts).map_or(f32::NAN, |inliers| inliers as f32)];
            counts.iter().enumerate().map(value).collect()
        };
        let is_counted = !history.is_empty() || counts.iter().any(|counts| counts.own.is_some());
        is_counted.then(|| Series {
            title: "Inliers of the hypotheses",
            x_label: "iteration",
            y_label: "inliers",
            x_max: counts.len().max((*needed).min(4 * counts.len())),
            lines: vec![
                ("of this hypothesis", Role::Candidate, line(|counts| counts.own)),
                ("of the best so far", Role::Best, line(|counts| counts.best)),
            ],
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
        if let Event::Sequel(index, best) = last {
            return self.0.draw_sequel(*index, &ended(state, *best), seen.focus, scene);
        }
        let shown = seen.events.iter().rev().find_map(|event| match event {
            Event::Hypothesis(matrix)
            | Event::Local(matrix, _)
            | Event::Resampled(_, matrix, _)
            | Event::Refit(matrix, _)
            | Event::Kept(matrix, _) => Some(*matrix),
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
            self.0.draw(&state.estimate(), matrix, seen.focus, scene);
        }
    }

    /// Inliers and outliers of a model.
    fn draw_matches(&self, state: &State, shown: Option<Matrix3>, scene: &mut Scene) {
        let Fixed { matches, points, .. } = &*state.fixed;
        let inliers = shown.map(|matrix| self.are_inliers(points, &matrix).collect::<Vec<_>>());
        for (i, found) in matches.iter().enumerate() {
            let (role, meaning) = match inliers.as_ref().map(|inliers| inliers[i]) {
                None => (Role::Reference, "match"),
                Some(true) => (Role::Result, "inlier"),
                Some(false) => (Role::Rejected, "outlier"),
            };
            scene.links.push(link(role, found.from, found.to));
            scene.legend(role, meaning);
        }
    }
}

/// Whether an event belongs to the fit to all inliers, after the iterations.
fn is_last(event: &Event) -> bool {
    matches!(event, Event::Resampled(..) | Event::Refit(..) | Event::Kept(..) | Event::Doubted(_) | Event::Sequel(..))
}

/// The estimate at the end of a run that `state` has not quite reached.
fn ended(state: &State, best: Best) -> Estimate<'_> {
    Estimate { best: Some(best), ..state.estimate() }
}

fn link(role: Role, from: [f32; 2], to: [f32; 2]) -> Link {
    Link { role, ends: [(Picture::CURRENT, from), (Picture::NEXT, to)] }
}
