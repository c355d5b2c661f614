//! The orientation histogram of a keypoint and its peaks.

use super::super::{Event, Sift, State};
use crate::base::words::{self, gray};
use crate::methods::differential::explain;
use crate::methods::scale_space::{Extremum, Histogram, ORIENTATIONS, PEAK_RATIO, Peak, Refined};
use crate::run::Seen;
use crate::scene::{Arrow, Canvas, Picture, Readout, Role, Scene, Sentence, Series, Shape, Tile};

impl Sift {
    pub(super) fn histogram_said(&self, state: &State) -> Sentence {
        let Some(refined) = state.refined.get(state.next) else { return Sentence::default() };
        let sigma = self.sigma_in_octave(refined);
        Sentence::default().text(format!(
            "Gradient directions within {} px of the octave, weighted by their magnitudes and a Gaussian with 1.5 σ = {} px, fill 36 bins \
             of 10°. The histogram is smoothed, and its peaks are the orientations.",
            Histogram::radius_px(sigma),
            gray(1.5 * sigma)
        ))
    }

    pub(super) fn orientation_readouts(&self, state: &State) -> Vec<Readout> {
        let Some(refined) = state.refined.get(state.next) else { return Vec::new() };
        let histogram = self.histogram(&state.space, refined);
        let points = |bins: &[f32; ORIENTATIONS]| {
            bins.iter().enumerate().map(|(bin, weight)| [10.0 * bin as f32, *weight]).collect::<Vec<_>>()
        };
        let series = Series {
            title: "Orientation histogram",
            x_label: "gradient direction, degrees",
            y_label: "weight",
            x_max: 350,
            lines: vec![
                ("before smoothing", Role::Rejected, points(&histogram.raw)),
                ("smoothed", Role::Result, points(&histogram.bins)),
            ],
            thresholds: vec![("80 % of the highest".to_owned(), PEAK_RATIO * histogram.highest())],
            is_sweep: true,
            ..Series::default()
        };
        let patch = self.patch(state, refined);
        vec![Readout::Series(series), Readout::Tiles(vec![patch])]
    }

    /// The Gaussian image around a keypoint.
    pub(super) fn patch(&self, state: &State, refined: &Refined) -> Tile {
        let Extremum { octave, level, x, y } = refined.at;
        let image = &state.space.octaves[octave].gaussians[level];
        let values = explain::around(image, (x, y), 8);
        Tile { label: "Gaussian image", role: None, values, range: [0.0, 255.0], framed: Vec::new() }
    }

    pub(super) fn draw_orientation(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT)];
        self.draw_circles(Picture::CURRENT, state.refined.iter(), scene);
        let Some(refined) = state.refined.get(state.next) else { return };
        let (center, _) = self.in_frame(refined);
        let pixel_px = self.shape().pixel_px(refined.at.octave);
        let radius = Histogram::radius_px(self.sigma_in_octave(refined)) as f32 * pixel_px;
        let window = Shape::Ellipse { center, radii: [radius; 2], angle_rad: 0.0 };
        scene.mark(Picture::CURRENT, Role::Window, window);
        scene.legend(Role::Window, "window of the histogram");
        let peaks = seen.events.iter().filter_map(|event| match event {
            Event::Peak(peak) => Some(peak.angle_rad),
            _ => None,
        });
        let arrows: Vec<Arrow> = peaks.map(|angle| arrow(center, angle, radius)).collect();
        if !arrows.is_empty() {
            scene.mark(Picture::CURRENT, Role::Best, Shape::Arrows(arrows));
            scene.legend(Role::Best, "orientation");
        }
    }
}

pub(super) fn peak_said(seen: &Seen<Sift>, peak: Peak) -> Sentence {
    let peaks = seen.events.iter().filter(|event| matches!(event, Event::Peak(_))).count();
    let degrees = words::fixed(peak.angle_rad.to_degrees().into(), 1);
    let said = Sentence::default().text("Orientation ").ink(Role::Result, format!("{degrees}°"));
    match peak.share == 1.0 {
        true => said.text(", the highest peak, interpolated between bins. The descriptor is turned by it, so that it turns with the picture."),
        false => said.text(format!(
            ": a peak of {} of the highest, at least the required 80 %, so keypoint {peaks} has the same place and another orientation.",
            words::percent((1000.0 * peak.share).round() / 1000.0)
        )),
    }
}

/// An arrow from a point in a direction.
pub(super) fn arrow(from: [f32; 2], angle_rad: f32, length: f32) -> Arrow {
    let (sin, cos) = angle_rad.sin_cos();
    Arrow { from, to: [from[0] + length * cos, from[1] + length * sin] }
}
