//! The marks of corner detection.

use super::corners::{Corners, Event, Measure};
use super::explain::{point, response};
use super::scan::{Scan, Stage};
use super::select::{Selection, Settings};
use crate::geometry::Grid;
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape};

impl<M: Measure> Corners<M> {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        self.draw_map(seen, scene);
        match state.scan.stage {
            Stage::Response => {}
            Stage::Suppression => {
                let compared = seen.events.iter().filter_map(|event| match event {
                    Event::Over(place, by) => Some((*place, by.is_none())),
                    _ => None,
                });
                state.scan.draw_suppression(scene, "local maximum", compared);
            }
            Stage::Choice => {
                let tested = seen.events.iter().filter_map(|event| match event {
                    Event::Peak(peak, near) => Some((*peak, near.is_none())),
                    _ => None,
                });
                state.scan.draw_choice(scene, tested, seen.after.is_some());
            }
        }
        self.draw_pixel(seen, scene);
    }

    /// Draws the responses so far; in later stages only those that reach the threshold.
    fn draw_map(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, peaks) = (seen.before, self.peaks(seen.before));
        let (width, height) = state.scan.map.size();
        let is_shown = |x: usize, y: usize| state.scan.stage == Stage::Response || peaks.is_over(x, y);
        let shown = |x, y| response(seen, (x, y)).filter(|_| is_shown(x, y)).map_or(f32::NAN, M::shown);
        let values = Grid::from_fn(width, height, shown);
        if values.cells().iter().any(|value| value.is_finite()) {
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::heat(values));
            scene.heat = Some(M::SHOWN);
        }
    }

    fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(probe) = self.probe(seen) else { return };
        let (x, y) = (probe.place.0 as i32, probe.place.1 as i32);
        let Settings { window, selection: Selection { min_distance, .. }, .. } = self.0.settings();
        if let (Some(Event::Peak(..)), None) = (seen.events.last(), seen.point()) {
            draw_minimum_distance(scene, probe.place, min_distance);
        } else {
            let reach = (window / 2) as i32;
            let side = 2 * reach as usize + 1;
            scene.draw(Picture::CURRENT, (Role::Window, "window"), Shape::pixels(x - reach, y - reach, side, side));
        }
        scene.draw(Picture::CURRENT, (Role::Reference, "inspected pixel"), Shape::pixels(x, y, 1, 1));
    }
}

/// Draws pixels as points, if there are any.
pub(crate) fn draw_points(scene: &mut Scene, (role, meaning): (Role, &'static str), places: Vec<(usize, usize)>) {
    if !places.is_empty() {
        scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(places.into_iter().map(point).collect()));
    }
}

pub(crate) fn draw_minimum_distance(scene: &mut Scene, place: (usize, usize), min_distance: usize) {
    let shape = Shape::circle(point(place), min_distance as f32);
    scene.draw(Picture::CURRENT, (Role::Window, "minimum distance"), shape);
}

impl<T: Copy + Default + PartialOrd + Into<f32>> Scan<T> {
    /// Draws the local maxima, called `meaning`, and the suppressed pixels; `compared` tells of each pixel of the row whether it
    /// is a local maximum.
    pub(crate) fn draw_suppression(
        &self,
        scene: &mut Scene,
        meaning: &'static str,
        compared: impl Iterator<Item = ((usize, usize), bool)>,
    ) {
        let (maxima, suppressed): (Vec<_>, Vec<_>) = compared.partition(|(_, is_maximum)| *is_maximum);
        draw_points(
            scene,
            (Role::Rejected, "suppressed (non-maximum)"),
            suppressed.into_iter().map(|of| of.0).collect(),
        );
        let earlier = self.peaks.iter().map(|peak| self.place(*peak));
        draw_points(scene, (Role::Best, meaning), earlier.chain(maxima.into_iter().map(|of| of.0)).collect());
    }

    /// Draws the selection; `tested` tells of each local maximum tested so far whether it is kept. At the end no other one is
    /// tested, since there are max-points.
    pub(crate) fn draw_choice(&self, scene: &mut Scene, tested: impl Iterator<Item = (u32, bool)>, is_over: bool) {
        let (kept, dropped): (Vec<_>, Vec<_>) = tested.partition(|(_, is_kept)| *is_kept);
        let mut is_done = Grid::new(self.map.width(), self.map.height(), is_over);
        kept.iter().chain(&dropped).for_each(|(peak, _)| is_done[self.place(*peak)] = true);
        let waiting = self.peaks.iter().map(|peak| self.place(*peak)).filter(|place| !is_done[*place]);
        draw_points(scene, (Role::Candidate, "local maximum, not yet tested"), waiting.collect());
        let places = |tested: Vec<(u32, bool)>| tested.into_iter().map(|(peak, _)| self.place(peak)).collect();
        draw_points(scene, (Role::Rejected, "rejected by the minimum distance"), places(dropped));
        draw_points(scene, (Role::Result, "corner"), places(kept));
    }
}
