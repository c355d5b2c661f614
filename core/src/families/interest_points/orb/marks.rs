//! The marks of ORB.

use super::probe::Probe;
use super::{Event, Level, Orb, State};
use crate::methods::features::brief::WINDOW_REACH;
use crate::methods::features::draw_keypoints;
use crate::run::{Progress, Seen};
use crate::scene::{Picture, Role, Scene, Shape};

impl Orb {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let done = seen.after.filter(|after| after.progress() == Progress::Done && !after.described.is_empty());
        match (done, self.level(seen), self.probe(seen)) {
            (Some(done), ..) => draw_keypoints(&done.features(self.side()), scene),
            (None, Some(level), _) => self.draw_level(seen, level, scene),
            (None, None, Some(probe)) => self.draw_keypoint(seen, &probe, scene),
            (None, None, None) => {}
        }
    }

    fn draw_level(&self, seen: &Seen<Self>, level: &Level, scene: &mut Scene) {
        let (margin, (width, height)) = (self.margin() as f32, level.of.picture.size());
        let edges = [[margin - 0.5; 2], [width as f32 - margin - 0.5, height as f32 - margin - 0.5]];
        let [min, max] = edges.map(|edge| level.of.in_frame(edge));
        scene.draw(Picture::CURRENT, (Role::Window, "area in which the patch fits"), Shape::Rect { min, max });
        let mut points = |role, meaning, places: Vec<u32>| {
            if !places.is_empty() {
                let place = |place: u32| level.in_frame(place);
                scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(places.into_iter().map(place).collect()));
            }
        };
        let tested = |is_kept: bool| {
            let peaks = seen.events.iter().filter_map(move |event| match event {
                Event::Peak(place, near) if near.is_none() == is_kept => Some(*place),
                _ => None,
            });
            peaks.collect::<Vec<_>>()
        };
        if seen.events.len() > 1 {
            points(Role::Candidate, "FAST corner", level.ranked.iter().map(|(place, _)| *place).collect());
        }
        points(Role::Rejected, "rejected by the minimum distance", tested(false));
        points(Role::Result, "keypoint", tested(true));
        if let Some(Event::Peak(place, _)) = seen.events.last() {
            self.draw_disc(level, level.place(*place), scene);
        }
    }

    fn draw_disc(&self, level: &Level, (x, y): (usize, usize), scene: &mut Scene) {
        let center = level.of.in_frame([x as f32, y as f32]);
        let radii = [(self.radius() as f32 + 0.5) * level.of.scale; 2];
        scene.draw(
            Picture::CURRENT,
            (Role::Reference, "disc of the patch"),
            Shape::Ellipse { center, radii, angle_rad: 0.0 },
        );
    }

    fn draw_keypoint(&self, seen: &Seen<Self>, probe: &Probe<'_>, scene: &mut Scene) {
        let state = seen.before;
        let others: Vec<_> = state.corners[..probe.index].iter().map(|corner| state.at(corner)).collect();
        if !others.is_empty() {
            scene.draw(Picture::CURRENT, (Role::Best, "described keypoint"), Shape::Points(others));
        }
        self.draw_disc(probe.level, probe.place, scene);
        self.draw_pairs(state, probe, scene);
        let [x, y] = probe.moments.direction();
        let reach = self.radius() as f32;
        let points = [[0.0; 2], [reach * x, reach * y]].map(|offset| probe.in_frame(offset)).to_vec();
        scene.draw(Picture::CURRENT, (Role::Result, "orientation"), Shape::line(points));
        scene.draw(
            Picture::CURRENT,
            (Role::Estimate, "intensity centroid"),
            Shape::Points(vec![probe.in_frame(probe.moments.centroid())]),
        );
    }

    /// Draws the pairs compared so far, and the two windows of the last one.
    fn draw_pairs(&self, state: &State, probe: &Probe<'_>, scene: &mut Scene) {
        let ends = |k: usize| probe.turned(state.pattern[k]).map(|offset| probe.in_frame(offset.map(|c| c as f32)));
        for (k, bit) in probe.bits.iter().enumerate() {
            let (role, meaning) = match bit {
                true => (Role::Measured, "bit 1: first window darker"),
                false => (Role::Rejected, "bit 0"),
            };
            scene.draw(Picture::CURRENT, (role, meaning), Shape::line(ends(k).to_vec()));
        }
        let Some(last) = probe.bits.len().checked_sub(1) else { return };
        let half = WINDOW_REACH as f32 + 0.5;
        for offset in probe.turned(state.pattern[last]) {
            let [x, y] = offset.map(|c| c as f32);
            let [min, max] = [-half, half].map(|edge| probe.in_frame([x + edge, y + edge]));
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::Rect { min, max });
        }
        scene.draw(Picture::CURRENT, (Role::Candidate, "windows compared"), Shape::line(ends(last).to_vec()));
    }
}
