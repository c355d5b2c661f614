//! The charts of a pixel of FAST.

use super::probe::{Probe, SHADES, number, role_of_run, shows_circle};
use super::{Fast, Stage};
use crate::methods::differential::explain;
use crate::methods::features::segment::{CIRCLE, COMPASS, Circle, RADIUS};
use crate::run::Seen;
use crate::scene::{Framed, Readout, Role, Series, Step, Tile};

impl Fast {
    pub(super) fn add_charts(&self, seen: &Seen<Self>, step: Step, Probe { place, circle, .. }: &Probe) -> Step {
        let state = seen.before;
        let mut picture = Tile::gray("Frame t", explain::around(state.picture.luma(), *place, RADIUS));
        if let Some(circle) = circle.as_ref().filter(|_| shows_circle(seen)) {
            picture.framed = framed(circle, state.stage);
        }
        let mut tiles = vec![picture];
        if state.stage != Stage::Response {
            let scores = explain::around(&state.map.map(|score| f32::from(*score)), *place, RADIUS);
            tiles.push(Tile::positive("Score V", scores));
        }
        step.show_all(circle.as_ref().map(|circle| Readout::Series(self.series(circle)))).show(Readout::Tiles(tiles))
    }

    /// The differences on the circle against the threshold.
    fn series(&self, circle: &Circle) -> Series {
        let all: Vec<[f32; 2]> = circle
            .differences
            .iter()
            .enumerate()
            .map(|(k, difference)| [number(k) as f32, f32::from(*difference)])
            .collect();
        let on_arc = |k: usize| circle.arc.is_some_and(|start| (k + 16 - start) % 16 < self.arc);
        let arc = all.iter().enumerate().map(|(k, [x, y])| [*x, if on_arc(k) { *y } else { f32::NAN }]).collect();
        let mut lines = vec![("difference", Role::Candidate, all)];
        if circle.arc.is_some() {
            lines.push(("arc that decides", Role::Result, arc));
        }
        let t = self.threshold as f32;
        Series {
            x_ticks: COMPASS.map(|k| number(k) as f32).to_vec(),
            thresholds: vec![("+t".into(), t), ("−t".into(), -t)],
            is_sweep: true,
            ..Series::new("Differences on the circle", ["pixel of the circle", "gray levels"], 16, lines)
        }
    }
}

/// The pixels of the circle by their shades, and the longest run around them, as they are drawn on the stage.
fn framed(circle: &Circle, stage: Stage) -> Vec<Framed> {
    let pixel = |k: usize| CIRCLE[k % 16].map(|offset| offset.saturating_add_unsigned(RADIUS) as usize);
    let run = circle.run.map(|(start, length)| Framed {
        role: role_of_run(circle, stage).0,
        pixels: (start..start + length).map(pixel).collect(),
        is_outer: true,
    });
    let of_shade = |(shade, role, _)| {
        let pixels = (0..16).filter(|k| circle.shades[*k] == shade).map(pixel).collect();
        Framed { role, pixels, is_outer: false }
    };
    run.into_iter().chain(SHADES.map(of_shade)).collect()
}
