//! The steps of motion clustering in words, numbers and marks.

use std::sync::Arc;

use super::{Data, Event, Features, LEAST_RISE, Method, MotionClustering, State, line};
use crate::base::words;
use crate::methods::numbers::{fixed, percent, ratio};
use crate::methods::segmentation::explain::{
    conclusion, draw_flow, draw_labels, draw_segments, mean_name, plane, segment_facts,
};
use crate::methods::segmentation::{
    Place, SegmentationRun, kmeans,
    kmeans::Trial,
    mixture::{Component, responsibilities},
    seeds::Seed,
    shift::{self, LEAST_SHARE, Mode},
    squared_distance,
};
use crate::run::Seen;
use crate::scene::{Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// Numbers of clusters that are plotted after a run with a given number.
const PLOTTED: usize = 8;

/// A squared distance of points.
fn squared(value: f64) -> String {
    fixed(value, 3)
}

/// A pixel of a point as text.
fn pixel_of(data: &Data, point: usize) -> String {
    let (index, width) = (data.pixels[point] as usize, data.flow.0.width());
    words::pixel((index % width, index / width))
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
    fn displacement(&self, place: &Place) -> String {
        let first = self.by.first_displacement();
        words::place([place[first], place[first + 1]])
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
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Flow(_)) => line::FIND_FLOW,
            Some(Event::Compared(..)) => line::CHOOSE_NUMBER,
            Some(Event::Seeded(..) | Event::Exhausted(_)) => line::PICK_SEED,
            Some(Event::Sampled(_)) => line::SAMPLE,
            Some(Event::Assigned(..)) => line::ASSIGN,
            Some(Event::Averaged { .. }) => line::UPDATE_MEAN,
            Some(Event::Expected(..)) => line::EXPECT,
            Some(Event::Maximized(..)) => line::MAXIMIZE,
            Some(Event::Shifted(..)) => line::SHIFT,
            Some(Event::Found(..)) => line::MERGE,
            Some(Event::Kept(_)) => line::KEEP_MODES,
            Some(Event::Labelled(_)) => line::LABEL,
        };
        Step { line, sentence: self.sentence(&view), readouts: self.readouts(&view) }
    }

    fn sentence(&self, view: &View) -> Sentence {
        let said = Sentence::default();
        match view.seen.events.last() {
            None => said.text(
                "Pixels that move together have similar displacements, so they form a cluster in the plane of displacements. The \
                 clustering separates such clusters without looking at the picture.",
            ),
            Some(Event::Flow(data)) => self.flow_sentence(view, data),
            Some(Event::Compared(trials, count)) => compared(trials, *count),
            Some(Event::Seeded(index, seed)) => seeded(view, *index, seed),
            Some(Event::Exhausted(0)) => said.text("Without points there are no seeds, and so no clusters."),
            Some(Event::Exhausted(count)) => said
                .text("All pixels lie on the seeds so far. The flow has only ")
                .ink(Role::Result, words::counted(*count, "distinct motion"))
                .text(", so k is lowered to that."),
            Some(Event::Sampled(density)) => said.text(format!(
                "Mean shift estimates the density of the displacements from a sample of {} pixels. An ascent starts at {} of them.",
                words::grouped(density.len()),
                density.starts.len()
            )),
            Some(Event::Assigned(_, changed, within)) => self.assigned(view, *changed, *within),
            Some(Event::Averaged { index, from, to, count }) => averaged(view, *index, [from, to], *count),
            Some(Event::Expected(_, changed, likelihood)) => self.expected(view, *changed, *likelihood),
            Some(Event::Maximized(index, component)) => said
                .text(format!("Component {} now has the weight ", index + 1))
                .ink(Role::Measured, ratio(component.weight))
                .text(" and the mean displacement ")
                .ink(Role::Result, view.displacement(&component.mean))
                .text(" px/frame: averages over all pixels, weighted by responsibility, so that each pixel may count for several components."),
            Some(Event::Shifted(from, mode)) => said
                .text(format!(
                    "{} of the sample lie within {} px/frame of {}. The window moves to their mean ",
                    words::counted(mode.support, "pixel"),
                    fixed(self.bandwidth.into(), 2),
                    view.displacement(from)
                ))
                .ink(Role::Estimate, view.displacement(&mode.place))
                .text(", toward higher density."),
            Some(Event::Found(mode, index, is_new)) => said
                .text("The window stays at ")
                .ink(Role::Result, view.displacement(&mode.place))
                .text(match is_new {
                    true => format!(": a new mode of the density, number {}.", index + 1),
                    false => format!(": within the bandwidth of mode {}, so it is the same mode.", index + 1),
                }),
            Some(Event::Kept(places)) => said
                .ink(Role::Result, format!("{} of {}", places.len(), words::counted(view.modes.len(), "mode")))
                .text(format!(
                    " have at least {} of the sample within the bandwidth. Each pixel goes to the nearest of them; smaller modes lie \
                     between motions, where the flow is smoothed.",
                    percent(LEAST_SHARE)
                )),
            Some(Event::Labelled(frame)) => {
                let t = view.seen.before.record.frame();
                let hint = self.hint(view, frame.segments.len());
                said.text(format!("Frame {t} is segmented: {}{hint}", conclusion(view.seen.clip, t, frame)))
            }
        }
    }

    fn flow_sentence(&self, view: &View, data: &Data) -> Sentence {
        let t = view.seen.before.record.frame();
        let said =
            Sentence::default().text(format!("{} gives the flow from frame {t} to {}. ", self.input.name(), t + 1));
        let coordinates = match self.features {
            Features::Displacement => "its displacement (u, v) in px/frame".to_owned(),
            Features::PositionAndDisplacement => format!(
                "its position, weighted by {}, and its displacement, (s x, s y, u, v)",
                fixed(self.position_weight.into(), 3)
            ),
        };
        match data.points.len() {
            0 => said.text("No pixel has a known flow, so there is nothing to segment."),
            count => said
                .ink(Role::Measured, format!("{} pixels", words::grouped(count)))
                .text(format!(" are points: {coordinates}.")),
        }
    }

    fn assigned(&self, view: &View, changed: usize, within: f64) -> Sentence {
        let round = view.seen.before.progress.len() + 1;
        let said = Sentence::default()
            .text(format!("Iteration {round}: each pixel goes to the nearest mean. "))
            .ink(Role::Candidate, format!("{} pixels", words::grouped(changed)))
            .text(" change their cluster; the mean squared distance is ")
            .ink(Role::Error, squared(within))
            .text(".");
        match changed {
            0 => said.text(" No change, so the means stay as well: converged to a local minimum."),
            _ if round == self.iterations => said.text(" The limit of iterations is reached."),
            _ => said,
        }
    }

    fn expected(&self, view: &View, changed: usize, likelihood: f64) -> Sentence {
        let before = view.seen.before.progress.last();
        let said = Sentence::default()
            .text("Responsibilities divide each pixel among the components. Log-likelihood per pixel: ")
            .ink(Role::Measured, fixed(likelihood, 4))
            .text(match before {
                Some(before) => format!(", before {}; it never falls. ", fixed(*before, 4)),
                None => ". ".to_owned(),
            })
            .text(format!("{} pixels change their most likely component.", words::grouped(changed)));
        match before {
            Some(before) if likelihood - before < LEAST_RISE => {
                said.text(format!(" The rise is below {}: converged.", fixed(LEAST_RISE, 4)))
            }
            _ => said,
        }
    }

    /// What the number of segments suggests for the next run.
    fn hint(&self, view: &View, segments: usize) -> String {
        if segments == 0 {
            return String::new();
        }
        match self.method {
            Method::MeanShift => format!(
                " The number follows from the bandwidth of {} px/frame: a smaller one separates more motions.",
                fixed(self.bandwidth.into(), 2)
            ),
            _ if self.clusters == 1 => " A single cluster was asked for, so no motions are separated.".into(),
            _ if segments < view.means.len() => " A cluster without pixels is no segment.".into(),
            _ => match self.features {
                Features::Displacement => {
                    " Objects of one displacement share a segment wherever they are, and a rotating object falls into several.".into()
                }
                Features::PositionAndDisplacement => {
                    " The position keeps segments compact, and splits what is large in the picture.".into()
                }
            },
        }
    }

    fn readouts(&self, view: &View) -> Vec<Readout> {
        let seen = view.seen;
        let Some(event) = seen.events.last() else { return Vec::new() };
        let mut facts = vec![Fact::new("Frame", seen.before.record.frame().to_string(), None)];
        facts.extend(match event {
            Event::Labelled(frame) => segment_facts(frame),
            _ => self.facts(view, event),
        });
        let mut readouts = Vec::new();
        if let Some((point, data)) = view.point() {
            let place = data.points.at(point);
            facts.push(Fact::new("Pixel", pixel_of(data, point), Some(Role::Reference)));
            facts.push(Fact::new(
                "Displacement",
                format!("{} px/frame", view.displacement(&place)),
                Some(Role::Measured),
            ));
            readouts.extend(self.equation(view, &place, data.points.dimensions()).map(Readout::Equation));
        }
        readouts.insert(0, Readout::Facts(facts));
        readouts.extend(self.plane(view));
        readouts.extend(self.plots(view));
        readouts
    }

    fn facts(&self, view: &View, event: &Event) -> Vec<Fact> {
        let points = view.data.map_or(0, |data| data.points.len());
        let mut facts = vec![Fact::new("Points", words::grouped(points), None)];
        match event {
            Event::Compared(trials, _) => {
                facts.extend(trials.iter().filter_map(|trial| {
                    let text = format!("{} with {} clusters", ratio(trial.silhouette?), trial.clusters);
                    Some(Fact::new("Mean silhouette", text, None))
                }));
            }
            Event::Assigned(_, changed, within) => {
                facts.push(Fact::new("Changes", words::grouped(*changed), Some(Role::Candidate)));
                facts.push(Fact::new("Mean squared distance", squared(*within), Some(Role::Error)));
            }
            Event::Expected(_, changed, likelihood) => {
                facts.push(Fact::new("Changes", words::grouped(*changed), Some(Role::Candidate)));
                facts.push(Fact::new("Log-likelihood per pixel", fixed(*likelihood, 4), Some(Role::Measured)));
            }
            Event::Maximized(_, component) => {
                let first = self.first_displacement();
                let deviation = |i: usize| fixed(component.covariance[i][i].sqrt(), 2);
                let text = format!("({}, {}) px/frame", deviation(first), deviation(first + 1));
                facts.push(Fact::new("Weight", ratio(component.weight), Some(Role::Measured)));
                facts.push(Fact::new("Standard deviations", text, None));
            }
            _ => {}
        }
        let centers = view.centers();
        facts.push(Fact::new("Clusters", centers.len().to_string(), None));
        facts
    }

    /// How the pixel pointed at is assigned.
    fn equation(&self, view: &View, place: &Place, dimensions: usize) -> Option<Vec<Math>> {
        /// Clusters with a line of their own.
        const LINES: usize = 6;
        let centers = view.centers();
        if centers.is_empty() {
            return None;
        }
        let row = |index: usize, name: &'static str, value: String, is_best: bool| {
            let role = if is_best { Role::Best } else { Role::Candidate };
            let symbol = Math::indexed(Math::Var(name), Math::text((index + 1).to_string()));
            Math::Row(vec![symbol, Math::text(" = "), Math::ink(role, value)])
        };
        if self.method == Method::GaussianMixture && !view.components.is_empty() {
            let all = responsibilities(&view.components, place, dimensions);
            let most = all.iter().map(|(share, _)| *share).fold(0.0, f64::max);
            let rows = all.iter().enumerate().take(LINES);
            return Some(rows.map(|(i, (share, _))| row(i, "r", ratio(*share), *share == most)).collect());
        }
        let all: Vec<f32> = centers.iter().map(|center| squared_distance(center, place)).collect();
        let least = all.iter().copied().fold(f32::INFINITY, f32::min);
        let rows = all.iter().enumerate().take(LINES);
        Some(rows.map(|(i, d)| row(i, "d²", squared((*d).into()), *d == least)).collect())
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

fn compared(trials: &[Trial], count: usize) -> Sentence {
    let said = Sentence::default();
    match trials.iter().find(|trial| trial.clusters == count).and_then(|trial| trial.silhouette) {
        Some(silhouette) => said
            .text("The mean silhouette is largest with ")
            .ink(Role::Result, format!("{count} clusters"))
            .text(format!(
                ": {}. A value near 1 means that pixels are much nearer to their own cluster than to the next one. More clusters lower the \
                 distances further, but beyond the elbow they only split a motion.",
                ratio(silhouette)
            )),
        None => said.text("No second cluster can be compared, since no pixel moves differently or only one cluster is allowed: k = 1."),
    }
}

fn seeded(view: &View, index: usize, seed: &Seed) -> Sentence {
    let pixel = view.data.map_or_else(String::new, |data| pixel_of(data, seed.point));
    let said = Sentence::default()
        .text(format!("Seed {}: pixel {pixel} with the displacement ", index + 1))
        .ink(Role::Candidate, view.displacement(&seed.place))
        .text(" px/frame");
    if index == 0 {
        return said.text(", drawn from all pixels with equal probability.");
    }
    said.text(format!(
        ". Its squared distance to the nearest earlier seed is {}, of {} in all, which is its probability; distant pixels are \
         likely, so the seeds spread over the motions.",
        squared(seed.squared_distance.into()),
        squared(seed.sum)
    ))
}

fn averaged(view: &View, index: usize, [from, to]: [&Place; 2], count: usize) -> Sentence {
    let said = Sentence::default().text(format!("Mean {}", index + 1));
    if count == 0 {
        return said.text(" has no pixels, so it stays where it is.");
    }
    said.text(" moves from ")
        .ink(Role::Predicted, view.displacement(from))
        .text(" to ")
        .ink(Role::Result, view.displacement(to))
        .text(format!(" px/frame, the average of its {} pixels.", words::grouped(count)))
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
