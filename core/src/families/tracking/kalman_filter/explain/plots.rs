//! The plots of the Kalman filter over the frames.

use super::{Line, deviation, distance, frame_of};
use crate::base::words::percent;
use crate::families::tracking::kalman_filter::sensors::Sensors;
use crate::families::tracking::kalman_filter::{Event, FrameRecord, Gated, KalmanFilter, modes};
use crate::methods::kalman::{Filter, chi_square};
use crate::run::Seen;
use crate::scene::{Band, Readout, Role, Series};

impl KalmanFilter {
    /// The plots up to the current frame.
    pub(super) fn series(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.after.unwrap_or(seen.before);
        let records = || state.records.iter().enumerate();
        let x = |i: usize| (state.span.first + i) as f32;
        let line = |of: &dyn Fn(&FrameRecord) -> Option<f64>| -> Vec<[f32; 2]> {
            records().filter_map(|(i, record)| Some([x(i), of(record)? as f32])).collect()
        };
        // Two-sided: the statistic of a filter with a covariance far too large lies below the lower end.
        let band = |dof: usize| Band {
            name: "95 % band".into(),
            values: [0.025, 0.975].map(|p| chi_square::quantile(p, dof) as f32),
            at: None,
        };
        let x_max = state.span.first + state.span.frames().map_or(state.records.len(), |frames| frames - 1);
        let series = |title, y_label, lines: Vec<Line>| Series {
            decimals: Some(2),
            present: seen.before.back.map(|_| frame_of(seen.before) as f32),
            ..Series::new(title, ["frame", y_label], x_max, lines)
        };
        if state.records.len() < 2 {
            return Vec::new();
        }
        let sigma = line(&|record| record.filtered.as_ref().map(deviation));
        let smoothed = line(&|record| record.smoothed.as_ref().map(deviation));
        let has_estimates = !sigma.is_empty() || !smoothed.is_empty();
        let mut deviations = vec![("filtered", Role::Estimate, sigma)];
        if !smoothed.is_empty() {
            deviations.push(("smoothed", Role::Result, smoothed));
        }
        let names = if self.sensors == Sensors::One {
            ["NIS"; 2]
        } else {
            ["NIS of the first sensor", "NIS of the second sensor"]
        };
        let mut all = Vec::new();
        let probabilities = modes::lines(records().map(|(i, record)| (x(i), &**record)));
        if !probabilities.is_empty() {
            all.push(Series { decimals: Some(3), ..series("Mode probabilities", "μ", probabilities) });
        }
        for (sensor, title) in names.into_iter().enumerate() {
            // The current frame counts from its gate on.
            let present = seen.events.iter().find_map(|event| match event {
                Event::Gated(gated) if seen.after.is_none() && gated.reading.sensor == sensor => Some(&**gated),
                _ => None,
            });
            let point_of = |gated: &Gated| [x(state.records.len()), gated.squared_distance as f32];
            // The line is broken where there is no measurement.
            let mut all_of =
                line(&|record| Some(record.of_sensor(sensor).map_or(f64::NAN, |gated| gated.squared_distance)));
            let mut refused = line(&|record| {
                let gated = record.of_sensor(sensor).filter(|gated| !gated.is_inside())?;
                Some(gated.squared_distance)
            });
            all_of.extend(present.map(point_of));
            refused.extend(present.filter(|gated| !gated.is_inside()).map(point_of));
            let dof = records().find_map(|(_, record)| Some(record.of_sensor(sensor)?.measurement().numbers()));
            let Some(dof) = dof else { continue };
            let mut lines = vec![("NIS", Role::Measured, all_of)];
            if !refused.is_empty() {
                lines.push(("rejected", Role::Rejected, refused));
            }
            let limit = chi_square::quantile(f64::from(self.gate), dof) as f32;
            let thresholds = vec![(format!("{} gate", percent(self.gate)), limit)];
            let nis = series(title, "d²", lines);
            all.push(Series { bands: vec![band(dof)], thresholds, ..nis });
        }
        if has_estimates {
            all.push(series("Position σ", "px", deviations));
        }
        let nees = line(&|record| record.filtered?.squared_error(record.truth?));
        if nees.len() > 1 {
            let off = |of: fn(&FrameRecord) -> Option<Filter>| {
                line(&move |record: &FrameRecord| Some(distance(of(record)?.place(), record.truth?)))
            };
            let nees = series("NEES", "NEES", vec![("NEES", Role::Error, nees)]);
            all.push(Series { bands: vec![band(2)], ..nees });
            let mut errors = vec![("filtered", Role::Estimate, off(|record| record.filtered))];
            let measured = line(&|record| Some(distance(record.of_sensor(0)?.measurement().place, record.truth?)));
            errors.push(("measurement", Role::Measured, measured));
            if state.back.is_some() {
                errors.push(("smoothed", Role::Result, off(|record| record.smoothed)));
            }
            all.push(series("Position error", "px", errors));
        }
        all.into_iter().map(Readout::Series).collect()
    }
}
