//! The steps of motion clustering in values, words and formulas.

use super::view::View;
use super::vocabulary::{case, value};
use super::{Data, Event, Features, LEAST_RISE, Method, MotionClustering, has_converged, line};
use crate::methods::segmentation::explain::{case as shared_case, conclude, value as shared};
use crate::methods::segmentation::{SegmentationRun, mixture::responsibilities, shift::LEAST_SHARE, squared_distance};
use crate::run::Seen;
use crate::scene::{Case, Name, Number, Role, Step, Value};

fn pixel_of(data: &Data, point: usize) -> (usize, usize) {
    let (index, width) = (data.pixels[point] as usize, data.flow.0.width());
    (index % width, index / width)
}

impl MotionClustering {
    pub(super) fn explain_step(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        let view = View::new(self, seen);
        let Some(event) = seen.events.last() else { return Step::at(line::EACH_FRAME).say(case::OPENING) };
        let step = self.tell_pixel(self.tell_event(&view, event), &view);
        step.show_all(self.plane(&view)).show_all(self.plots(&view))
    }

    fn tell_event(&self, view: &View, event: &Event) -> Step {
        let t = view.seen.before.record.frame();
        let at = |line: Name| {
            let step = Step::at(line).fact(shared::FRAME, t);
            step.fact(value::POINTS, view.data.map_or(0, |data| data.points.len()))
                .fact(value::CLUSTERS, view.centers().len())
        };
        let numbered = |line: Name, index: usize| at(line).put(value::NUMBER, index + 1);
        match event {
            Event::Flow(data) => {
                let step = at(line::FIND_FLOW).put(shared::METHOD, self.input.name()).put(shared::NEXT_FRAME, t + 1);
                let step = step.put(value::POSITION_WEIGHT, self.position_weight).say(shared_case::FLOW);
                step.say(match self.features {
                    _ if data.points.is_empty() => case::NO_FLOW,
                    Features::Displacement => case::POINTS,
                    Features::PositionAndDisplacement => case::POINTS_WITH_POSITION,
                })
            }
            Event::Compared(trials, count) => {
                let all: Number = trials.iter().map(|trial| trial.silhouette.unwrap_or(f64::NAN)).collect();
                let step = at(line::CHOOSE_NUMBER).fact(value::SILHOUETTES, all).put(value::CHOSEN, *count);
                match trials.iter().find(|trial| trial.clusters == *count).and_then(|trial| trial.silhouette) {
                    Some(silhouette) => step.put(value::SILHOUETTE, silhouette).say(case::COMPARED),
                    None => step.say(case::NOT_COMPARED),
                }
            }
            Event::Seeded(index, seed) => {
                let pixel = view.data.map_or((0, 0), |data| pixel_of(data, seed.point));
                let step = numbered(line::PICK_SEED, *index).put(value::SEED_PIXEL, pixel);
                let step = step.put(value::SEED, view.displacement(&seed.place)).put(value::SUM, seed.sum);
                let step = step.put(value::SEED_DISTANCE, seed.squared_distance);
                step.say(if *index == 0 { case::FIRST_SEED } else { case::SEED })
            }
            Event::Exhausted(0) => at(line::PICK_SEED).say(case::NO_SEEDS),
            Event::Exhausted(count) => at(line::PICK_SEED).put(value::DISTINCT, *count).say(case::EXHAUSTED),
            Event::Sampled(density) => {
                let step = at(line::SAMPLE).put(value::SAMPLE, density.len());
                step.put(value::STARTS, density.starts.len()).say(case::SAMPLED)
            }
            Event::Assigned(_, changed, within) => self.tell_assignment(at(line::ASSIGN), view, (*changed, *within)),
            Event::Averaged { index, count: 0, .. } => numbered(line::UPDATE_MEAN, *index).say(case::EMPTY),
            Event::Averaged { index, from, to, count } => {
                let step = numbered(line::UPDATE_MEAN, *index).put(value::MEAN_BEFORE, view.displacement(from));
                step.put(value::MEAN, view.displacement(to)).put(value::SIZE, *count).say(case::AVERAGED)
            }
            Event::Expected(_, changed, likelihood) => {
                tell_expectation(at(line::EXPECT), view, (*changed, *likelihood))
            }
            Event::Maximized(index, component) => {
                let first = self.first_displacement();
                let deviations = [first, first + 1].map(|i| component.covariance[i][i].sqrt());
                let step = numbered(line::MAXIMIZE, *index).fact(value::WEIGHT, component.weight);
                let step = step.fact(value::DEVIATIONS, deviations);
                step.put(value::MEAN, view.displacement(&component.mean)).say(case::MAXIMIZED)
            }
            Event::Shifted(from, mode) => {
                let step = at(line::SHIFT).put(value::SUPPORT, mode.support).put(value::BANDWIDTH, self.bandwidth);
                let step = step.put(value::WINDOW_BEFORE, view.displacement(from));
                step.put(value::WINDOW, view.displacement(&mode.place)).say(case::SHIFTED)
            }
            Event::Found(mode, index, is_new) => {
                let step = numbered(line::MERGE, *index).put(value::MEAN, view.displacement(&mode.place));
                step.say(if *is_new { case::NEW_MODE } else { case::KNOWN_MODE })
            }
            Event::Kept(places) => {
                let step = at(line::KEEP_MODES).put(value::KEPT, places.len()).put(value::MODES, view.modes.len());
                step.put(value::LEAST_SUPPORT, 100.0 * LEAST_SHARE).say(case::KEPT)
            }
            Event::Labelled(frame) => {
                let step = Step::at(line::LABEL).fact(shared::FRAME, t).put(value::BANDWIDTH, self.bandwidth);
                let step = conclude(step.say(case::LABELLED), view.seen.clip, t, frame);
                match frame.segments.len() {
                    0 => step,
                    segments => step.say(self.hint(view, segments)),
                }
            }
        }
    }

    fn tell_assignment(&self, step: Step, view: &View, (changed, within): (usize, f64)) -> Step {
        let round = view.seen.before.progress.len() + 1;
        let step = step.fact(value::CHANGES, changed).fact(value::WITHIN, within).put(value::ITERATION, round);
        let step = step.say(if round == 1 { case::FIRST_ITERATION } else { case::ITERATION }).say(case::ASSIGNED);
        match changed {
            0 => step.say(case::UNCHANGED),
            _ => step.say_if(round == self.iterations, case::LIMIT),
        }
    }

    /// Advice for the next run, from the number of segments.
    fn hint(&self, view: &View, segments: usize) -> &'static Case {
        match self.method {
            Method::MeanShift => case::BY_BANDWIDTH,
            _ if self.clusters == 1 => case::SINGLE,
            _ if segments < view.means.len() => case::WITHOUT_PIXELS,
            _ if self.features == Features::Displacement => case::BY_DISPLACEMENT,
            _ => case::BY_POSITION,
        }
    }

    /// Adds how the pixel pointed at is assigned.
    fn tell_pixel(&self, step: Step, view: &View) -> Step {
        /// Clusters with a line of their own.
        const LINES: usize = 6;
        let Some((point, data)) = view.point() else { return step };
        let (place, centers) = (data.points.at(point), view.centers());
        let step = step.fact(shared::PIXEL, pixel_of(data, point));
        let step = step.fact(shared::DISPLACEMENT, view.displacement(&place));
        let row = |step: Step, (i, value): (usize, Value), is_best: bool, formula: &str| {
            let role = if is_best { Role::Best } else { Role::Candidate };
            step.put_value(value.inked(role)).formula(formula.replace('j', &format!("{{{}}}", i + 1)))
        };
        if self.method == Method::GaussianMixture && !view.components.is_empty() {
            let all = responsibilities(&view.components, &place, data.points.dimensions());
            let most = all.iter().map(|(share, _)| *share).fold(0.0, f64::max);
            return all.iter().enumerate().take(LINES).fold(step, |step, (i, (share, _))| {
                row(step, (i, value::RESPONSIBILITY.is(*share)), *share == most, "r_j = {responsibility}")
            });
        }
        let all: Vec<f32> = centers.iter().map(|center| squared_distance(center, &place)).collect();
        let least = all.iter().copied().fold(f32::INFINITY, f32::min);
        all.iter().enumerate().take(LINES).fold(step, |step, (i, squared)| {
            row(step, (i, value::DISTANCE.is(*squared)), *squared == least, "d_j^2 = {distance}")
        })
    }
}

fn tell_expectation(step: Step, view: &View, (changed, likelihood): (usize, f64)) -> Step {
    let before = view.seen.before.progress.last();
    let step = step.fact(value::CHANGES, changed).fact(value::LIKELIHOOD, likelihood).put(value::TOLERANCE, LEAST_RISE);
    let step = match before {
        Some(before) => step.put(value::LIKELIHOOD_BEFORE, *before).say(case::EXPECTED),
        None => step.say(case::FIRST_EXPECTED),
    };
    step.say(case::RELABELLED).say_if(has_converged(before, likelihood), case::CONVERGED)
}
