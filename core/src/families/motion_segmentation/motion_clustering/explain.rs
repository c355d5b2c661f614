//! The steps of motion clustering in words, numbers and marks.

use std::sync::Arc;

use super::{Data, Event, Features, LEAST_RISE, Method, MotionClustering, State, has_converged, line};
use crate::methods::segmentation::explain::{
    case as shared_case, concluded, draw_flow, draw_labels, draw_segments, mean_name, plane, value as shared,
};
use crate::methods::segmentation::{
    Place, SegmentationRun, kmeans,
    kmeans::Trial,
    mixture::{Component, responsibilities},
    shift::{self, LEAST_SHARE, Mode},
    squared_distance,
};
use crate::run::Seen;
use crate::scene::{Case, Name, Number, Picture, Readout, Role, Scene, Series, Shape, Step, Unit, Value};
use crate::{cases, variables};

/// A log-likelihood per pixel.
const LIKELIHOOD_UNIT: Unit = Unit::new("", 4);

variables! { pub(super) mod value;
    /// The number of pixels with a known displacement.
    POINTS: "Points", "", Unit::count("pixel"), Role::Measured;
    /// The number of clusters so far.
    CLUSTERS: "Clusters", "k", Unit::count("");
    /// The displacement that counts as much as a distance of 1 px in the picture.
    POSITION_WEIGHT: "Weight of the position", "s", Unit::RATIO;
    /// The mean silhouettes of 2, 3 and more clusters.
    SILHOUETTES: "Mean silhouettes from k = 2 on", "", Unit::RATIO;
    /// The number of clusters of largest mean silhouette.
    CHOSEN: "Chosen", "k", Unit::count("cluster"), Role::Result;
    /// The mean silhouette of the chosen number of clusters.
    SILHOUETTE: "Silhouette", "", Unit::RATIO;
    /// The number of a seed, mean, component or mode.
    NUMBER: "Number", "j", Unit::WHOLE;
    /// The pixel of a seed.
    SEED_PIXEL: "Pixel of the seed", "", Unit::WHOLE;
    /// The displacement of a seed.
    SEED: "Seed", "", Unit::SPEED, Role::Candidate;
    /// The squared distance of a seed to the nearest earlier one.
    SEED_DISTANCE: "Squared distance", "d^2", Unit::RATIO;
    /// The sum of the squared distances of all pixels to their nearest seeds.
    SUM: "Sum", "", Unit::RATIO;
    /// The number of distinct motions of the flow.
    DISTINCT: "Distinct motions", "", Unit::count("distinct motion"), Role::Result;
    /// The number of pixels of the sample.
    SAMPLE: "Sample", "", Unit::count("pixel");
    /// The number of pixels of the sample at which an ascent starts.
    STARTS: "Starts", "", Unit::count("");
    /// The number of the iteration.
    ITERATION: "Iteration", "", Unit::WHOLE;
    /// The number of pixels that change their cluster or their most likely component.
    CHANGES: "Changes", "", Unit::count("pixel"), Role::Candidate;
    /// The mean squared distance of the pixels to their means.
    WITHIN: "Mean squared distance", "", Unit::RATIO, Role::Error;
    /// A mean before its update.
    MEAN_BEFORE: "Mean before", "", Unit::SPEED, Role::Predicted;
    /// A mean after its update.
    MEAN: "Mean", r"\mu", Unit::SPEED, Role::Result;
    /// The number of pixels of a cluster.
    SIZE: "Pixels", "", Unit::count("pixel");
    /// The log-likelihood per pixel.
    LIKELIHOOD: "Log-likelihood per pixel", "", LIKELIHOOD_UNIT, Role::Measured;
    /// The log-likelihood per pixel after the iteration before.
    LIKELIHOOD_BEFORE: "Before", "", LIKELIHOOD_UNIT;
    /// The rise of the log-likelihood below which the iteration has converged.
    TOLERANCE: "Tolerance", "", LIKELIHOOD_UNIT;
    /// The weight of a component.
    WEIGHT: "Weight", "w", Unit::RATIO, Role::Measured;
    /// The standard deviations of a component along u and v.
    DEVIATIONS: "Standard deviations", "", Unit::SPEED;
    /// The number of pixels of the sample within the bandwidth.
    SUPPORT: "Support", "", Unit::count("pixel");
    /// The radius of the window.
    BANDWIDTH: "Bandwidth", "", Unit::SPEED;
    /// The window before its shift.
    WINDOW_BEFORE: "Window before", "", Unit::SPEED;
    /// The window after its shift.
    WINDOW: "Window", "", Unit::SPEED, Role::Estimate;
    /// The number of modes with enough support.
    KEPT: "Kept", "", Unit::count(""), Role::Result;
    /// The number of modes.
    MODES: "Modes", "", Unit::count("mode");
    /// The share of the sample that a mode needs within the bandwidth.
    LEAST_SUPPORT: "Least support", "", Unit::PERCENT;
    /// The squared distance of the inspected pixel to a mean.
    DISTANCE: "Squared distance", "d^2", Unit::RATIO;
    /// The responsibility of a component for the inspected pixel.
    RESPONSIBILITY: "Responsibility", "r", Unit::RATIO;
}

cases! { pub(super) over value, shared;
    OPENING: "Pixels that move together have similar displacements, so they form a cluster in the plane of displacements. The \
              clustering separates such clusters without looking at the picture.",
    NO_FLOW: "No pixel has a known flow, so there is nothing to segment.",
    POINTS: "{points} are points: its displacement (u, v) in px/frame.",
    POINTS_WITH_POSITION: "{points} are points: its position, weighted by {position_weight}, and its displacement, (s x, s y, u, \
                           v).",
    COMPARED: "The mean silhouette is largest with {chosen}: {silhouette}. A value near 1 means that pixels are much nearer to \
               their own cluster than to the next one. More clusters lower the distances further, but beyond the elbow they only \
               split a motion.",
    NOT_COMPARED: "No second cluster can be compared, since no pixel moves differently or only one cluster is allowed: k = 1.",
    FIRST_SEED: "Seed {number}: pixel {seed_pixel} with the displacement {seed}, drawn from all pixels with equal probability.",
    SEED: "Seed {number}: pixel {seed_pixel} with the displacement {seed}. Its squared distance to the nearest earlier seed is \
           {seed_distance}, of {sum} in all, which is its probability; distant pixels are likely, so the seeds spread over the \
           motions.",
    NO_SEEDS: "Without points there are no seeds, and so no clusters.",
    EXHAUSTED: "All pixels lie on the seeds so far. The flow has only {distinct}, so k is lowered to that.",
    SAMPLED: "Mean shift estimates the density of the displacements from a sample of {sample}. An ascent starts at {starts} of \
              them.",
    FIRST_ITERATION: "Iteration 1: each pixel goes to the nearest mean.",
    ITERATION: "Iteration {iteration}: each pixel goes to the nearest mean.",
    ASSIGNED: "{changes} change their cluster; the mean squared distance is {within}.",
    UNCHANGED: "No change, so the means stay as well: converged to a local minimum.",
    LIMIT: "The limit of iterations is reached.",
    EMPTY: "Mean {number} has no pixels, so it stays where it is.",
    AVERAGED: "Mean {number} moves from {mean_before:bare} to {mean}, the average of its {size}.",
    FIRST_EXPECTED: "Responsibilities divide each pixel among the components. Log-likelihood per pixel: {likelihood}.",
    EXPECTED: "Responsibilities divide each pixel among the components. Log-likelihood per pixel: {likelihood}, before \
               {likelihood_before}; it never falls.",
    RELABELLED: "{changes} change their most likely component.",
    CONVERGED: "The rise is below {tolerance}: converged.",
    MAXIMIZED: "Component {number} now has the weight {weight} and the mean displacement {mean}: averages over all pixels, \
                weighted by responsibility, so that each pixel may count for several components.",
    SHIFTED: "{support} of the sample lie within {bandwidth} of {window_before:bare}. The window moves to their mean \
              {window:bare}, toward higher density.",
    NEW_MODE: "The window stays at {mean:bare}: a new mode of the density, number {number}.",
    KNOWN_MODE: "The window stays at {mean:bare}: within the bandwidth of mode {number}, so it is the same mode.",
    KEPT: "{kept} of {modes} have at least {least_support} of the sample within the bandwidth. Each pixel goes to the nearest of \
           them; smaller modes lie between motions, where the flow is smoothed.",
    LABELLED: "Frame {frame} is segmented:",
    BY_BANDWIDTH: "The number follows from the bandwidth of {bandwidth}: a smaller one separates more motions.",
    SINGLE: "A single cluster was asked for, so no motions are separated.",
    WITHOUT_PIXELS: "A cluster without pixels is no segment.",
    BY_DISPLACEMENT: "Objects of one displacement share a segment wherever they are, and a rotating object falls into several.",
    BY_POSITION: "The position keeps segments compact, and splits what is large in the picture.",
}

/// Numbers of clusters that are plotted after a run with a given number.
const PLOTTED: usize = 8;

/// The pixel of a point.
fn pixel_of(data: &Data, point: usize) -> (usize, usize) {
    let (index, width) = (data.pixels[point] as usize, data.flow.0.width());
    (index % width, index / width)
}

/// Everything that the steps of a unit show.
struct View<'a> {
    by: &'a MotionClustering,
    seen: &'a Seen<'a, SegmentationRun<MotionClustering>>,
    data: Option<&'a Arc<Data>>,
    /// The means up to the cursor.
    means: Vec<Place>,
    components: Vec<Component>,
    modes: Vec<Mode>,
    nearest: Option<&'a Arc<Vec<u8>>>,
    /// The places of the window of mean shift so far.
    path: Vec<Place>,
}

impl<'a> View<'a> {
    fn new(by: &'a MotionClustering, seen: &'a Seen<'a, SegmentationRun<MotionClustering>>) -> Self {
        let before = seen.before;
        let mut view = Self {
            by,
            seen,
            data: before.data.as_ref(),
            means: before.means.clone(),
            components: before.components.clone(),
            modes: before.modes.clone(),
            nearest: Some(&before.nearest).filter(|nearest| before.is_assigned(nearest)),
            path: Vec::new(),
        };
        seen.events.iter().for_each(|event| view.follow(event));
        view
    }

    /// Brings it up to an event.
    fn follow(&mut self, event: &'a Event) {
        match event {
            Event::Flow(data) => self.data = Some(data),
            Event::Seeded(_, seed) => self.means.push(seed.place),
            Event::Assigned(nearest, ..) | Event::Expected(nearest, ..) => self.nearest = Some(nearest),
            Event::Averaged { index, to, .. } => self.means[*index] = *to,
            Event::Maximized(index, component) => self.components[*index] = Component::clone(component),
            Event::Shifted(from, mode) => {
                if self.path.is_empty() {
                    self.path.push(*from);
                }
                self.path.push(mode.place);
            }
            Event::Found(mode, ..) => {
                shift::merge(&mut self.modes, *mode, self.by.bandwidth);
            }
            Event::Kept(places) => self.means.clone_from(places),
            Event::Compared(..) | Event::Exhausted(_) | Event::Sampled(_) | Event::Labelled(_) => {}
        }
    }

    /// The centres of the clusters so far.
    fn centers(&self) -> Vec<Place> {
        match self.by.method {
            Method::GaussianMixture if !self.components.is_empty() => self.components.iter().map(|c| c.mean).collect(),
            Method::MeanShift if self.means.is_empty() => self.modes.iter().map(|mode| mode.place).collect(),
            _ => self.means.clone(),
        }
    }

    /// The displacement of a place.
    fn displacement(&self, place: &Place) -> [f32; 2] {
        let first = self.by.first_displacement();
        [place[first], place[first + 1]]
    }

    /// The point of the pixel that is pointed at.
    fn point(&self) -> Option<(usize, &'a Arc<Data>)> {
        let data = self.data?;
        let pixel = data.flow.0.cell_at(self.seen.point()?)?;
        Some((data.point_of(pixel)?, data))
    }
}

impl State {
    /// Whether the points have clusters.
    fn is_assigned(&self, nearest: &[u8]) -> bool {
        !self.progress.is_empty() && nearest.first().is_some_and(|index| *index < u8::MAX)
    }
}

impl MotionClustering {
    pub(super) fn explained_step(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        let view = View::new(self, seen);
        let Some(event) = seen.events.last() else { return Step::at(line::EACH_FRAME).say(case::OPENING) };
        let step = self.inspected(self.told(&view, event), &view);
        step.show_all(self.plane(&view)).show_all(self.plots(&view))
    }

    fn told(&self, view: &View, event: &Event) -> Step {
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
            Event::Assigned(_, changed, within) => self.assigned(at(line::ASSIGN), view, (*changed, *within)),
            Event::Averaged { index, count: 0, .. } => numbered(line::UPDATE_MEAN, *index).say(case::EMPTY),
            Event::Averaged { index, from, to, count } => {
                let step = numbered(line::UPDATE_MEAN, *index).put(value::MEAN_BEFORE, view.displacement(from));
                step.put(value::MEAN, view.displacement(to)).put(value::SIZE, *count).say(case::AVERAGED)
            }
            Event::Expected(_, changed, likelihood) => expected(at(line::EXPECT), view, (*changed, *likelihood)),
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
                let step = concluded(step.say(case::LABELLED), view.seen.clip, t, frame);
                match frame.segments.len() {
                    0 => step,
                    segments => step.say(self.hint(view, segments)),
                }
            }
        }
    }

    fn assigned(&self, step: Step, view: &View, (changed, within): (usize, f64)) -> Step {
        let round = view.seen.before.progress.len() + 1;
        let step = step.fact(value::CHANGES, changed).fact(value::WITHIN, within).put(value::ITERATION, round);
        let step = step.say(if round == 1 { case::FIRST_ITERATION } else { case::ITERATION }).say(case::ASSIGNED);
        match changed {
            0 => step.say(case::UNCHANGED),
            _ => step.say_if(round == self.iterations, case::LIMIT),
        }
    }

    /// What the number of segments suggests for the next run.
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
    fn inspected(&self, step: Step, view: &View) -> Step {
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

    fn plane(&self, view: &View) -> Option<Readout> {
        let data = view.data?;
        let mut named: Vec<(&'static str, Role, Place)> =
            view.centers().iter().enumerate().map(|(i, place)| (mean_name(i), Role::Result, *place)).collect();
        match view.seen.events.last() {
            Some(Event::Averaged { from, .. }) => named.push(("mean before", Role::Predicted, *from)),
            Some(Event::Shifted(_, mode)) => named.push(("window", Role::Estimate, mode.place)),
            _ => {}
        }
        named.extend(view.point().map(|(point, data)| ("inspected pixel", Role::Reference, data.points.at(point))));
        let group = |point: usize| match view.nearest {
            Some(nearest) => u32::from(nearest[point]) + 1,
            None => 0,
        };
        Some(plane((&data.points, self.first_displacement()), group, &named, &view.path))
    }

    fn plots(&self, view: &View) -> Vec<Readout> {
        let mut all = Vec::new();
        let now = view.seen.before;
        let values = now.progress.iter().copied().chain(match view.seen.events.last() {
            Some(Event::Found(mode, ..)) => Some(mode.support as f64 / now.density.len().max(1) as f64),
            _ => view.seen.events.iter().find_map(|event| match event {
                Event::Assigned(_, _, value) | Event::Expected(_, _, value) => Some(*value),
                _ => None,
            }),
        });
        let points: Vec<[f32; 2]> = values.enumerate().map(|(i, value)| [(i + 1) as f32, value as f32]).collect();
        let (title, x_label, role) = match self.method {
            Method::KMeans => ("Mean squared distance", "iteration", Role::Error),
            Method::GaussianMixture => ("Log-likelihood per pixel", "iteration", Role::Measured),
            Method::MeanShift => ("Share of the sample at the mode", "start", Role::Measured),
        };
        if !points.is_empty() {
            all.push(Readout::Series(Series {
                title,
                x_label,
                y_label: title,
                x_max: points.len(),
                lines: vec![(title, role, points)],
                fits_values: self.method == Method::GaussianMixture,
                decimals: Some(if self.method == Method::GaussianMixture { 4 } else { 3 }),
                ..Series::default()
            }));
        }
        let trials = match (view.seen.events.last(), view.data) {
            (Some(Event::Compared(trials, _)), _) => trials.to_vec(),
            (Some(Event::Labelled(_)), Some(data)) if self.method != Method::MeanShift => {
                kmeans::trials(&data.points, PLOTTED.max(self.clusters), self.seed)
            }
            _ => Vec::new(),
        };
        all.extend(elbow(&trials, view.means.len()));
        all
    }

    pub(super) fn drawn_step(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
        let view = View::new(self, seen);
        let Some((event, data)) = seen.events.last().zip(view.data) else { return };
        let points = |scene: &mut Scene, role, meaning, indices: &mut dyn Iterator<Item = usize>| {
            let width = data.flow.0.width();
            let place = |point: usize| {
                let index = data.pixels[point] as usize;
                [(index % width) as f32, (index / width) as f32]
            };
            scene.mark(Picture::CURRENT, role, Shape::Points(indices.map(place).collect()));
            scene.legend(role, meaning);
        };
        match event {
            Event::Flow(_) | Event::Compared(..) | Event::Exhausted(_) => {
                draw_flow(scene, &data.flow);
            }
            Event::Seeded(..) => {
                let seeds = seen.events.iter().filter_map(|event| match event {
                    Event::Seeded(_, seed) => Some(seed.point),
                    _ => None,
                });
                points(scene, Role::Candidate, "seeds of k-means++", &mut seeds.into_iter());
            }
            Event::Sampled(_) | Event::Shifted(..) | Event::Found(..) => {
                let starts = data.points.sampled(seen.before.density.starts.len().max(match event {
                    Event::Sampled(density) => density.starts.len(),
                    _ => 0,
                }));
                points(scene, Role::Measured, "starts of the ascents", &mut starts.1.iter().copied());
                if let Some(now) =
                    starts.1.get(seen.before.progress.len()).filter(|_| !matches!(event, Event::Sampled(_)))
                {
                    points(scene, Role::Candidate, "current start", &mut std::iter::once(*now));
                }
            }
            Event::Labelled(frame) => draw_segments(scene, frame),
            Event::Kept(_)
            | Event::Assigned(..)
            | Event::Averaged { .. }
            | Event::Expected(..)
            | Event::Maximized(..) => {
                let nearest = view.nearest.map_or(&[][..], |nearest| nearest);
                draw_labels(scene, Arc::new(data.labels(nearest)), "clusters, one colour each");
            }
        }
    }
}

fn expected(step: Step, view: &View, (changed, likelihood): (usize, f64)) -> Step {
    let before = view.seen.before.progress.last();
    let step = step.fact(value::CHANGES, changed).fact(value::LIKELIHOOD, likelihood).put(value::TOLERANCE, LEAST_RISE);
    let step = match before {
        Some(before) => step.put(value::LIKELIHOOD_BEFORE, *before).say(case::EXPECTED),
        None => step.say(case::FIRST_EXPECTED),
    };
    step.say(case::RELABELLED).say_if(has_converged(before, likelihood), case::CONVERGED)
}

/// The plots of mean squared distance and silhouette over the number of clusters.
fn elbow(trials: &[Trial], chosen: usize) -> Vec<Readout> {
    let plot = |title, role, value: &dyn Fn(&Trial) -> Option<f64>| {
        let points = trials.iter().filter_map(|trial| Some([trial.clusters as f32, value(trial)? as f32]));
        let points: Vec<[f32; 2]> = points.collect();
        (points.len() > 1).then(|| {
            Readout::Series(Series {
                title,
                x_label: "clusters",
                y_label: title,
                x_max: trials.len(),
                is_sweep: true,
                chosen: Some(chosen as f32).filter(|chosen| points.iter().any(|[k, _]| k == chosen)),
                lines: vec![(title, role, points)],
                decimals: Some(3),
                ..Series::default()
            })
        })
    };
    let within = plot("Mean squared distance by number of clusters", Role::Error, &|trial| Some(trial.within));
    let silhouette = plot("Mean silhouette by number of clusters", Role::Measured, &|trial| trial.silhouette);
    within.into_iter().chain(silhouette).collect()
}
