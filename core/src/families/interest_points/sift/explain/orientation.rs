//! The orientation histogram of a keypoint and its peaks.

use super::super::{Event, Sift, State, case, features, line, value};
use crate::methods::differential::explain;
use crate::methods::scale_space::{Extremum, Histogram, ORIENTATIONS, PEAK_RATIO, Peak, Refined};
use crate::run::Seen;
use crate::scene::{Arrow, Canvas, Picture, Readout, Role, Scene, Series, Shape, Step, Tile};

impl Sift {
    /// Explains the orientation histogram of a keypoint or one of its peaks.
    pub(super) fn tell_orientation(&self, seen: &Seen<Self>, event: Event) -> Step {
        let line = if let Event::Peak(_) = event { line::ORIENT } else { line::EACH_KEYPOINT };
        let (step, state) = (Step::at(line), seen.before);
        let Some(refined) = state.refined.get(state.next) else { return step };
        let sigma = self.sigma_in_octave(refined);
        let step = step.put(value::WINDOW_RADIUS, Histogram::radius_px(sigma)).put(value::WEIGHT_SIGMA, 1.5 * sigma);
        let step = match event {
            Event::Peak(Peak { angle_rad, share, .. }) => {
                let peaks = seen.events.iter().filter(|event| matches!(event, Event::Peak(_))).count();
                let step = step.put(features::ORIENTATION, angle_rad.to_degrees()).put(value::PEAK, peaks);
                let step = step.put(value::PEAK_SHARE, 100.0 * share);
                step.say(if share == 1.0 { case::HIGHEST } else { case::FURTHER })
            }
            _ => step.say(case::HISTOGRAM),
        };
        let histogram = self.histogram(&state.space, refined);
        let points = |bins: &[f32; ORIENTATIONS]| {
            bins.iter().enumerate().map(|(bin, weight)| [10.0 * bin as f32, *weight]).collect::<Vec<_>>()
        };
        let series = Series {
            thresholds: vec![("80 % of the highest".to_owned(), PEAK_RATIO * histogram.highest())],
            is_sweep: true,
            ..Series::new(
                "Orientation histogram",
                ["gradient direction, degrees", "weight"],
                350,
                vec![
                    ("before smoothing", Role::Rejected, points(&histogram.raw)),
                    ("smoothed", Role::Result, points(&histogram.bins)),
                ],
            )
        };
        step.show(Readout::Series(series)).show(Readout::Tiles(vec![self.patch(state, refined)]))
    }

    /// The Gaussian image around a keypoint.
    pub(super) fn patch(&self, state: &State, refined: &Refined) -> Tile {
        let Extremum { octave, level, x, y } = refined.at;
        let image = &state.space.octaves[octave].gaussians[level];
        let values = explain::around(image, (x, y), 8);
        Tile::gray("Gaussian image", values)
    }

    pub(super) fn draw_orientation(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT)];
        self.draw_circles(Picture::CURRENT, state.refined.iter(), scene);
        let Some(refined) = state.refined.get(state.next) else { return };
        let (center, _) = self.in_frame(refined);
        let pixel_px = self.shape().pixel_px(refined.at.octave);
        let radius = Histogram::radius_px(self.sigma_in_octave(refined)) as f32 * pixel_px;
        let window = Shape::circle(center, radius);
        scene.draw(Picture::CURRENT, (Role::Window, "window of the histogram"), window);
        let peaks = seen.events.iter().filter_map(|event| match event {
            Event::Peak(peak) => Some(peak.angle_rad),
            _ => None,
        });
        let arrows: Vec<Arrow> = peaks.map(|angle| arrow(center, angle, radius)).collect();
        if !arrows.is_empty() {
            scene.draw(Picture::CURRENT, (Role::Best, "orientation"), Shape::Arrows(arrows));
        }
    }
}

pub(super) fn arrow(from: [f32; 2], angle_rad: f32, length: f32) -> Arrow {
    let (sin, cos) = angle_rad.sin_cos();
    Arrow { from, to: [from[0] + length * cos, from[1] + length * sin] }
}
