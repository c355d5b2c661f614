//! The marks of corner detection.

use super::corners::{Corners, Event, Measure, Stage};
use super::explain::{point, response};
use super::select::{Selection, Settings};
use crate::geometry::Grid;
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape};

impl<M: Measure> Corners<M> {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        self.draw_map(seen, scene);
        let mut points = |role, meaning, places: Vec<(usize, usize)>| {
            if !places.is_empty() {
                scene.mark(Picture::CURRENT, role, Shape::Points(places.into_iter().map(point).collect()));
                scene.legend(role, meaning);
            }
        };
        let places = |peaks: &[u32]| peaks.iter().map(|peak| state.place(*peak)).collect::<Vec<_>>();
        match state.stage {
            Stage::Response => {}
            Stage::Suppression => {
                let over = |is_peak: bool| {
                    let of_row = seen.events.iter().filter_map(move |event| match event {
                        Event::Over(place, by) if by.is_none() == is_peak => Some(*place),
                        _ => None,
                    });
                    of_row.collect::<Vec<_>>()
                };
                points(Role::Rejected, "suppressed (non-maximum)", over(false));
                points(Role::Best, "local maximum", [places(&state.peaks), over(true)].concat());
            }
            Stage::Choice => {
                let looked_at = |is_kept: bool| {
                    let peaks = seen.events.iter().filter_map(move |event| match event {
                        Event::Peak(peak, near) if near.is_none() == is_kept => Some(*peak),
                        _ => None,
                    });
                    places(&peaks.collect::<Vec<_>>())
                };
                let (kept, dropped) = (looked_at(true), looked_at(false));
                let done: Vec<_> = kept.iter().chain(&dropped).copied().collect();
                // Beyond max-points nothing was tested.
                let mut is_done = Grid::new(state.map.width(), state.map.height(), seen.after.is_some());
                done.iter().for_each(|place| is_done[*place] = true);
                let waiting = places(&state.peaks).into_iter().filter(|place| !is_done[*place]).collect();
                points(Role::Candidate, "local maximum, not yet tested", waiting);
                points(Role::Rejected, "rejected by the minimum distance", dropped);
                points(Role::Result, "corner", kept);
            }
        }
        self.draw_pixel(seen, scene);
    }

    /// Draws the responses so far; in later stages only those that reach the threshold.
    fn draw_map(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, peaks) = (seen.before, self.peaks(seen.before));
        let (width, height) = state.map.size();
        let is_shown = |x: usize, y: usize| state.stage == Stage::Response || peaks.is_over(x, y);
        let shown = |x, y| response(seen, (x, y)).filter(|_| is_shown(x, y)).map_or(f32::NAN, M::shown);
        let values = Grid::from_fn(width, height, shown);
        if values.cells().iter().any(|value| value.is_finite()) {
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
            scene.heat = Some(M::SHOWN);
        }
    }

    fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(probe) = self.probe(seen) else { return };
        let (x, y) = (probe.place.0 as i32, probe.place.1 as i32);
        let Settings { window, selection: Selection { min_distance, .. }, .. } = self.0.settings();
        if let (Some(Event::Peak(..)), None) = (seen.events.last(), seen.point()) {
            let radius = min_distance as f32;
            let shape = Shape::Ellipse { center: point(probe.place), radii: [radius; 2], angle_rad: 0.0 };
            scene.mark(Picture::CURRENT, Role::Window, shape);
            scene.legend(Role::Window, "minimum distance");
        } else {
            let reach = (window / 2) as i32;
            let side = 2 * reach as usize + 1;
            scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x - reach, y - reach, side, side));
            scene.legend(Role::Window, "window");
        }
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x, y, 1, 1));
        scene.legend(Role::Reference, "inspected pixel");
    }
}
