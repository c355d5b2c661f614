//! The marks of motion clustering.

use std::sync::Arc;

use super::view::View;
use super::{Event, MotionClustering};
use crate::methods::segmentation::SegmentationRun;
use crate::methods::segmentation::explain::{draw_flow, draw_labels, draw_segments};
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape};

impl MotionClustering {
    pub(super) fn draw_marks(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
        let view = View::new(self, seen);
        let Some((event, data)) = seen.events.last().zip(view.data) else { return };
        let points = |scene: &mut Scene, role, meaning, indices: &mut dyn Iterator<Item = usize>| {
            let width = data.flow.0.width();
            let place = |point: usize| {
                let index = data.pixels[point] as usize;
                [(index % width) as f32, (index / width) as f32]
            };
            scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(indices.map(place).collect()));
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
