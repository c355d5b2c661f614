//! Everything that the steps of a unit of motion clustering show.

use std::sync::Arc;

use super::{Data, Event, Method, MotionClustering, State};
use crate::methods::segmentation::{
    Place, SegmentationRun,
    mixture::Component,
    shift::{self, Mode},
};
use crate::run::Seen;

/// Everything that the steps of a unit show.
pub(super) struct View<'a> {
    pub by: &'a MotionClustering,
    pub seen: &'a Seen<'a, SegmentationRun<MotionClustering>>,
    pub data: Option<&'a Arc<Data>>,
    /// The means up to the cursor.
    pub means: Vec<Place>,
    pub components: Vec<Component>,
    pub modes: Vec<Mode>,
    pub nearest: Option<&'a Arc<Vec<u8>>>,
    /// The places of the window of mean shift so far.
    pub path: Vec<Place>,
}

impl<'a> View<'a> {
    pub(super) fn new(by: &'a MotionClustering, seen: &'a Seen<'a, SegmentationRun<MotionClustering>>) -> Self {
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
    pub(super) fn centers(&self) -> Vec<Place> {
        match self.by.method {
            Method::GaussianMixture if !self.components.is_empty() => self.components.iter().map(|c| c.mean).collect(),
            Method::MeanShift if self.means.is_empty() => self.modes.iter().map(|mode| mode.place).collect(),
            _ => self.means.clone(),
        }
    }

    pub(super) fn displacement(&self, place: &Place) -> [f32; 2] {
        let first = self.by.first_displacement();
        [place[first], place[first + 1]]
    }

    pub(super) fn point(&self) -> Option<(usize, &'a Arc<Data>)> {
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
