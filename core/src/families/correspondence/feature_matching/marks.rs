//! The marks of feature matching.

use super::{Event, FeatureMatching};
use crate::methods::matching::{Event as Compared, Neighbors};
use crate::products::keypoints::{Keypoint, WINDOW_SIGMAS};
use crate::products::{MatchField, MatchStatus};
use crate::run::Seen;
use crate::scene::{Link, Picture, Role, Scene, Shape};

impl FeatureMatching {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let [here, there] = state.fixed.pair.sides.each_ref();
        let is_end = seen.after.is_some_and(|after| after.found.len() >= after.count());
        let alone = if is_end { "keypoint without a match: rejected" } else { "keypoint; second nearest" };
        for (on, side) in [(Picture::CURRENT, here), (Picture::NEXT, there)] {
            let points: Vec<_> = side.points.iter().map(|point| point.at).collect();
            if !points.is_empty() {
                scene.draw(on, (Role::Rejected, alone), Shape::Points(points));
            }
        }
        let shown = seen.after.unwrap_or(state);
        let truth = state.fixed.truth.as_deref();
        for found in shown.matches().filter(|found| found.status == MatchStatus::Match) {
            let (role, meaning) = match truth.map(|truth| MatchField::is_right(&found, truth)) {
                Some(Some(true)) if is_end => (Role::Best, "correct match"),
                Some(Some(true)) => (Role::Best, "correct match; nearest"),
                Some(Some(false)) => (Role::Error, "wrong match"),
                Some(None) => (Role::Result, "match, true displacement unknown"),
                None => (Role::Result, "match"),
            };
            scene.links.push(link(role, found.from, found.to));
            scene.legend(role, meaning);
        }
        if !is_end {
            self.draw_current(seen, scene);
        }
    }

    fn draw_current(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let [here, there] = state.fixed.pair.sides.each_ref();
        let index = state.found.len();
        let (Some(point), false) = (here.points.get(index), seen.events.is_empty()) else { return };
        self.draw_keypoint((Picture::CURRENT, Role::Reference), point.at, &here.keypoints[index], scene);
        scene.legend(Role::Reference, "keypoint compared");
        if self.settings.radius > 0 {
            let radii = [self.settings.radius as f32; 2];
            scene.draw(
                Picture::NEXT,
                (Role::Predicted, "search radius"),
                Shape::Ellipse { center: point.at, radii, angle_rad: 0.0 },
            );
        }
        let mut candidate = |index: usize, role, meaning| {
            let to = there.points[index].at;
            self.draw_keypoint((Picture::NEXT, role), to, &there.keypoints[index], scene);
            scene.links.push(link(role, point.at, to));
            scene.legend(role, meaning);
        };
        for event in seen.events {
            match event {
                Event::Of(Compared::Found(Neighbors { first, second })) => {
                    if let Some((index, _)) = second {
                        candidate(*index, Role::Rejected, "keypoint; second nearest");
                    }
                    if let Some((index, _)) = first {
                        candidate(*index, Role::Best, "nearest");
                    }
                }
                Event::Of(Compared::Nearer { index, .. })
                    if std::ptr::eq(event, seen.events.last().unwrap_or(event)) =>
                {
                    candidate(*index, Role::Candidate, "nearest so far");
                }
                _ => {}
            }
        }
    }

    /// A circle as large as the described neighbourhood, or the square of a patch.
    fn draw_keypoint(&self, (on, role): (Picture, Role), at: [f32; 2], keypoint: &Keypoint, scene: &mut Scene) {
        let shape = match keypoint.scale_px {
            Some(scale) => Shape::circle(at, WINDOW_SIGMAS / 2.0 * scale),
            None => {
                let reach = self.settings.reach() as f32 + 0.5;
                Shape::Rect { min: at.map(|c| c - reach), max: at.map(|c| c + reach) }
            }
        };
        scene.mark(on, role, shape);
    }
}

fn link(role: Role, from: [f32; 2], to: [f32; 2]) -> Link {
    Link { role, ends: [(Picture::CURRENT, from), (Picture::NEXT, to)] }
}
