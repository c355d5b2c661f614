//! The marks of the trajectory analysis.

use super::explain::{counts, frame_at, frame_of, now};
use super::{Event, TrajectoryAnalysis};
use crate::geometry::Bounds;
use crate::methods::multi_object::directions::Directions;
use crate::products::{Object, TrackStatus, objects::trajectory::TrackPoint};
use crate::run::Seen;
use crate::scene::{Arrow, Picture, Role, Scene, Shape};

/// The frames after which an ended trajectory is no longer drawn.
const TRAIL_FRAMES: usize = 40;

impl TrajectoryAnalysis {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        scene.is_overview = seen.after.is_some() && seen.point().is_none();
        let all = now(seen);
        if let Some(Event::Learned(directions)) = seen.events.last() {
            self.draw_directions(directions, scene);
        }
        self.draw_places(seen, scene);
        let t = frame_of(seen.before);
        for trajectory in &all {
            let is_recent = trajectory.sightings.last().is_some_and(|last| last.frame + TRAIL_FRAMES >= t);
            let points: Vec<[f32; 2]> = trajectory.sightings.iter().map(|seen| point(seen.at)).collect();
            if is_recent && points.len() > 1 {
                let path = Shape::line(points);
                scene.mark_of(trajectory.id, Picture::CURRENT, Role::Estimate, path);
            }
        }
        for object in frame_at(seen).iter().flat_map(|frame| &frame.objects) {
            let of = all.binary_search_by_key(&object.id, |trajectory| trajectory.id).ok();
            let last = of.and_then(|i| all[i].sightings.last()).filter(|seen| seen.frame == t);
            draw_object(scene, object, last);
        }
        let crossings: Vec<[f32; 2]> = all.iter().flat_map(|of| of.crossings.iter().map(|c| point(c.at))).collect();
        if !crossings.is_empty() {
            scene.draw(Picture::CURRENT, (Role::Best, "crossing"), Shape::Points(crossings));
        }
        scene.legend(Role::Estimate, "trajectory of a track");
        if let Some(Event::Unusual(of, anomaly)) = seen.events.last()
            && let Some(last) = of.sightings.last()
        {
            scene.draw(
                Picture::CURRENT,
                (Role::Rejected, "mean direction of tracks"),
                chevron(last.at, anomaly.mean, self.cell_size as f64),
            );
        }
    }

    /// Draws lines and zones with their counts, and with their numbers if there are several.
    fn draw_places(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let zones = self.zones.all();
        for (i, Bounds { min, max }) in zones.iter().enumerate() {
            scene.draw(Picture::CURRENT, (Role::Reference, "zone"), Shape::Rect { min: *min, max: *max });
            if zones.len() > 1 {
                let text = Shape::Text { at: [min[0], max[1]], text: format!("zone {}", i + 1) };
                scene.mark(Picture::CURRENT, Role::Reference, text);
            }
        }
        (0..self.lines.all().len()).for_each(|line| self.draw_line(seen, scene, line));
    }

    fn draw_line(&self, seen: &Seen<Self>, scene: &mut Scene, index: usize) {
        let lines = self.lines.all();
        let line = lines[index];
        let path = Shape::line(vec![line.from, line.to]);
        scene.mark(Picture::CURRENT, Role::Window, path);
        let [u, v] = [0, 1].map(|i| line.to[i] - line.from[i]);
        let length = u.hypot(v);
        // Near its end, where fewer tracks cross than in its middle.
        let at = |share: f32, side: f32| {
            let along = [0, 1].map(|i| line.from[i] + share * (line.to[i] - line.from[i]));
            [along[0] - side * 12.0 * v / length, along[1] + side * 12.0 * u / length]
        };
        let [forward, back] = counts(seen, index);
        // Right as seen along the line, since y points down.
        for (side, text) in [(1.0, format!("+{forward}")), (-1.0, format!("−{back}"))] {
            scene.mark(Picture::CURRENT, Role::Window, Shape::Text { at: at(0.88, side), text });
        }
        if lines.len() > 1 {
            let text = format!("line {}", index + 1);
            scene.mark(Picture::CURRENT, Role::Window, Shape::Text { at: at(0.12, 1.0), text });
        }
        scene.legend(Role::Window, "counting line with crossings");
    }

    fn draw_directions(&self, directions: &Directions, scene: &mut Scene) {
        for (at, mean) in directions.all(self.min_others) {
            let shape = chevron(at.map(f64::from), mean.direction, directions.side_px as f64 * mean.agreement);
            scene.draw(Picture::CURRENT, (Role::Rejected, "mean direction of tracks"), shape);
        }
    }
}

fn point(at: [f64; 2]) -> [f32; 2] {
    at.map(|c| c as f32)
}

/// A short arrow in a direction around a position.
fn chevron(at: [f64; 2], [u, v]: [f64; 2], size_px: f64) -> Shape {
    let place = |along: f64, across: f64| {
        point([at[0] + size_px * (along * u - across * v), at[1] + size_px * (along * v + across * u)])
    };
    let tip = place(0.3, 0.0);
    Shape::line(vec![place(-0.3, 0.0), tip, place(0.18, 0.1), tip, place(0.18, -0.1)])
}

/// Draws a track's box, number and velocity.
fn draw_object(scene: &mut Scene, object: &Object, last: Option<&TrackPoint>) {
    let is_unusual = last.is_some_and(|last| last.anomaly.is_some());
    let (role, meaning) = match object.status {
        _ if is_unusual => (Role::Error, "anomalous direction"),
        TrackStatus::Tentative => (Role::Candidate, "tentative track"),
        TrackStatus::Confirmed => (Role::Estimate, "confirmed track"),
        TrackStatus::Coasting => (Role::Predicted, "coasting track"),
    };
    let Bounds { min, max } = object.bounds;
    scene.mark(Picture::CURRENT, role, Shape::Rect { min, max });
    scene.mark_of(object.id, Picture::CURRENT, role, Shape::Text { at: min, text: object.id.to_string() });
    scene.legend(role, meaning);
    if let Some(TrackPoint { at, velocity: Some(velocity), .. }) = last {
        let (from, to) = (point(*at), point([0, 1].map(|i| at[i] + velocity[i])));
        scene.draw(Picture::CURRENT, (Role::Result, "velocity in px/frame"), Shape::Arrows(vec![Arrow { from, to }]));
    }
}
