//! The marks of the Kalman filter on the pictures.

use super::{StepEstimates, truth};
use crate::families::tracking::kalman_filter::sensors::SensorReading;
use crate::families::tracking::kalman_filter::{Event, FrameRecord, Gated, KalmanFilter, modes, modes::point};
use crate::methods::kalman::{Filter, chi_square, ellipse};
use crate::run::Seen;
use crate::scene::{Arrow, Picture, Role, Scene, Shape};

impl KalmanFilter {
    /// Draws the step: trails, detections, the true position, estimates, and measurements with the gate.
    pub(in super::super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, now) = (seen.before, self.now(seen));
        trails(seen, &now, scene);
        let detections = seen.events.iter().find_map(|event| match event {
            Event::Observed(observed) => Some(&observed.detections),
            _ => None,
        });
        for found in detections.into_iter().flat_map(|all| all.iter()) {
            let shape = Shape::Rect { min: found.bounds.min, max: found.bounds.max };
            scene.draw(Picture::CURRENT, (Role::Reference, "detection"), shape);
        }
        self.truth(seen, scene);
        if let Some(predicted) = now.predicted {
            self.draw_estimate(&predicted, (Role::Predicted, "prediction"), scene);
        }
        match seen.events.last() {
            Some(Event::Gated(gated)) => gate(gated, scene),
            Some(Event::Mixed(before)) => modes::draw(before, scene),
            Some(Event::Drawn(before)) => modes::draw_points(before, false, scene),
            Some(Event::Predicted(both)) => {
                modes::draw(&both[1], scene);
                modes::draw_points(&both[0], true, scene);
            }
            Some(Event::Updated(update) | Event::Weighed(update)) => modes::draw(&update.1, scene),
            Some(Event::Retried(retry)) => {
                if let Some(restart) = &retry.restart {
                    let points = restart.path.iter().copied().map(point).collect();
                    scene.draw(Picture::CURRENT, (Role::Result, "restarted track"), Shape::line(points));
                }
            }
            _ => {}
        }
        draw_measurements(seen, &now, scene);
        let is_back = state.back.is_some();
        if let Some(before) = now.before.filter(|_| is_back) {
            self.draw_estimate(&before, (Role::Estimate, "filtered estimate"), scene);
        }
        if let Some(after) = now.after {
            let role = if is_back { (Role::Result, "smoothed estimate") } else { (Role::Estimate, "updated estimate") };
            self.draw_estimate(&after, role, scene);
        }
        if scene.legend.is_empty() {
            scene.legend(Role::Measured, "measurement");
            scene.legend(Role::Predicted, "prediction");
            scene.legend(Role::Estimate, "updated estimate");
        }
    }

    /// Draws an estimated position with its covariance ellipse.
    fn draw_estimate(&self, filter: &Filter, (role, meaning): (Role, &'static str), scene: &mut Scene) {
        let center = filter.place();
        if let Some(shape) = ellipse(center, filter.place_covariance(), self.confidence.share()) {
            scene.mark(Picture::CURRENT, role, shape);
            scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(vec![point(center)]));
        }
    }

    fn truth(&self, seen: &Seen<Self>, scene: &mut Scene) {
        if let Some(truth) = truth(seen) {
            scene.draw(Picture::CURRENT, (Role::Truth, "true position"), Shape::Points(vec![point(truth)]));
        }
    }
}

/// Draws the filtered and the smoothed trajectory up to the estimate of the step.
fn trails(seen: &Seen<KalmanFilter>, now: &StepEstimates, scene: &mut Scene) {
    let state = seen.before;
    let index = now.frame - state.span.first;
    let is_new = matches!(seen.events.last(), Some(Event::Begun(..)));
    let mut draw = |of: fn(&FrameRecord) -> Option<Filter>, role: Role, meaning: &'static str| {
        let known = state.records.iter().enumerate().map(|(i, record)| {
            let of_step = now.after.filter(|_| i == index && role == now.role);
            (of_step.or_else(|| of(record)), record.begins)
        });
        let of_step = now.after.filter(|_| index == state.records.len() && role == now.role);
        let mut runs: Vec<Vec<[f32; 2]>> = Vec::new();
        for (filter, begins) in known.chain(of_step.map(|filter| (Some(filter), is_new))) {
            match filter {
                Some(filter) => {
                    if runs.is_empty() || begins {
                        runs.push(Vec::new());
                    }
                    if let Some(run) = runs.last_mut() {
                        run.push(point(filter.place()));
                    }
                }
                None => runs.push(Vec::new()),
            }
        }
        for points in runs.into_iter().filter(|points| points.len() > 1) {
            scene.draw(Picture::CURRENT, (role, meaning), Shape::line(points));
        }
    };
    draw(
        |record| record.filtered,
        Role::Estimate,
        if state.back.is_some() { "filtered estimate" } else { "updated estimate" },
    );
    if state.back.is_some() {
        draw(|record| record.smoothed, Role::Result, "smoothed estimate");
    }
}

/// Draws the gate: the region of accepted measurements.
fn gate(gated: &Gated, scene: &mut Scene) {
    let Some(numbers) = gated.expected.update_numbers(gated.measurement()) else { return };
    let covariance = [0, 1].map(|i| [0, 1].map(|j| numbers.covariance[(j, i)]));
    // The share of positions within the gating threshold.
    let share = chi_square::share(gated.limit, 2);
    if let Some(shape) = ellipse(gated.expected.place(), covariance, share) {
        scene.draw(Picture::CURRENT, (Role::Window, "gate"), shape);
    }
}

/// Draws the measurements and the innovation.
fn draw_measurements(seen: &Seen<KalmanFilter>, now: &StepEstimates, scene: &mut Scene) {
    let looked = seen.events.iter().find_map(|event| match event {
        Event::Observed(observed) => Some(&observed.measured),
        _ => None,
    });
    let Some(all) = looked.filter(|all| !all.is_empty()) else { return };
    let is_refused = |reading: &&SensorReading| {
        now.gated.iter().any(|gated| gated.reading.sensor == reading.sensor && !gated.is_inside())
    };
    let (refused, taken): (Vec<&SensorReading>, Vec<&SensorReading>) = all.iter().partition(is_refused);
    for (role, reading) in [(Role::Measured, taken), (Role::Rejected, refused)] {
        if !reading.is_empty() {
            let points = reading.iter().map(|reading| point(reading.measurement.place)).collect();
            scene.draw(
                Picture::CURRENT,
                (role, if role == Role::Rejected { "rejected measurement" } else { "measurement" }),
                Shape::Points(points),
            );
        }
    }
    // The innovation of the current sensor; a rejected one updates nothing.
    if let Some(gated) = now.gated.last() {
        let arrow = Arrow { from: point(gated.expected.place()), to: point(gated.measurement().place) };
        let role = if gated.is_inside() { Role::Best } else { Role::Rejected };
        scene.mark(Picture::CURRENT, role, Shape::Arrows(vec![arrow]));
        scene.legend(Role::Best, "innovation ν");
    }
}
