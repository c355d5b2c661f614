//! The plane of displacements and the plots of motion clustering.

use super::view::View;
use super::{Event, Method, MotionClustering};
use crate::methods::segmentation::explain::{mean_name, plane};
use crate::methods::segmentation::{
    Place,
    kmeans::{self, Trial},
};
use crate::scene::{Readout, Role, Series};

/// Numbers of clusters that are plotted after a run with a given number.
const PLOTTED: usize = 8;

impl MotionClustering {
    pub(super) fn plane(&self, view: &View) -> Option<Readout> {
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

    pub(super) fn plots(&self, view: &View) -> Vec<Readout> {
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
                fits_values: self.method == Method::GaussianMixture,
                decimals: Some(if self.method == Method::GaussianMixture { 4 } else { 3 }),
                ..Series::new(title, [x_label, title], points.len(), vec![(title, role, points)])
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
}

/// The plots of mean squared distance and silhouette over the number of clusters.
fn elbow(trials: &[Trial], chosen: usize) -> Vec<Readout> {
    let plot = |title, role, value: &dyn Fn(&Trial) -> Option<f64>| {
        let points = trials.iter().filter_map(|trial| Some([trial.clusters as f32, value(trial)? as f32]));
        let points: Vec<[f32; 2]> = points.collect();
        (points.len() > 1).then(|| {
            Readout::Series(Series {
                is_sweep: true,
                chosen: Some(chosen as f32).filter(|chosen| points.iter().any(|[k, _]| k == chosen)),
                decimals: Some(3),
                ..Series::new(title, ["clusters", title], trials.len(), vec![(title, role, points)])
            })
        })
    };
    let within = plot("Mean squared distance by number of clusters", Role::Error, &|trial| Some(trial.within));
    let silhouette = plot("Mean silhouette by number of clusters", Role::Measured, &|trial| trial.silhouette);
    within.into_iter().chain(silhouette).collect()
}
