//! Where a picture lies on the screen: zooming and panning, without any drawing.

use eframe::egui::{Pos2, Rect, Vec2, pos2, vec2};

use super::State;
use crate::paint::primitive;

/// Largest size of an image pixel on the screen, in points.
const LARGEST: f32 = 160.0;

/// How far one looks into a picture, shared by all panes that show it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Zoom {
    /// The whole picture, as large as it fits.
    #[default]
    Fit,
    /// A chosen place and scale.
    At {
        /// Image pixel in the middle of the pane.
        center: [f32; 2],
        /// Points on the screen for one image pixel.
        scale: f32,
    },
}

impl Zoom {
    /// The same place, `factor` times as large.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        match self {
            Self::Fit => Self::Fit,
            Self::At { center, scale } => Self::At { center, scale: factor * scale },
        }
    }
}

/// A picture in a pane of the screen. Image pixel centres lie at integers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// The pane, in points.
    pub pane: Rect,
    /// Width and height of the picture in pixels.
    pub picture: Vec2,
    /// Points on the screen for one image pixel.
    pub scale: f32,
    /// Image point in the middle of the pane.
    pub center: Pos2,
}

impl Lens {
    /// The picture of `size` pixels in `pane`, seen through `zoom`.
    pub fn new(pane: Rect, size: (usize, usize), zoom: Zoom) -> Self {
        let picture = vec2(size.0.max(1) as f32, size.1.max(1) as f32);
        let fit = (pane.size().max(Vec2::splat(1.0)) / picture).min_elem();
        let middle = pos2((picture.x - 1.0) / 2.0, (picture.y - 1.0) / 2.0);
        let lens = |scale, center| Self { pane, picture, scale, center };
        match zoom {
            Zoom::Fit => lens(fit.min(LARGEST), middle),
            Zoom::At { center: [x, y], scale } => lens(scale, pos2(x, y)).within(),
        }
    }

    /// The scale at which the whole picture is seen.
    fn fit(&self) -> f32 {
        (self.pane.size().max(Vec2::splat(1.0)) / self.picture).min_elem().min(LARGEST)
    }

    /// Keeps the scale in bounds and the middle of the pane on the picture.
    fn within(mut self) -> Self {
        let smallest = (0.5 * self.fit()).min(1.0);
        self.scale = if self.scale.is_finite() { self.scale.clamp(smallest, LARGEST) } else { self.fit() };
        let last = self.picture - Vec2::splat(0.5);
        let keep = |c: f32, last: f32| if c.is_finite() { c.clamp(-0.5, last) } else { last / 2.0 };
        self.center = pos2(keep(self.center.x, last.x), keep(self.center.y, last.y));
        self
    }

    /// Where image point `image` is on the screen.
    pub fn to_screen(&self, image: [f32; 2]) -> Pos2 {
        self.pane.center() + (pos2(image[0], image[1]) - self.center) * self.scale
    }

    /// The image point at `screen`.
    pub fn to_image(&self, screen: Pos2) -> [f32; 2] {
        (self.center + (screen - self.pane.center()) / self.scale).into()
    }

    /// The image pixel at `screen`, if the picture is there.
    pub fn pixel_at(&self, screen: Pos2) -> Option<[usize; 2]> {
        let [x, y] = self.to_image(screen).map(f32::round);
        let inside = x >= 0.0 && y >= 0.0 && x < self.picture.x && y < self.picture.y && self.pane.contains(screen);
        inside.then_some([x as usize, y as usize])
    }

    /// Where the whole picture lies on the screen, also outside the pane.
    pub fn picture_rect(&self) -> Rect {
        let far = self.picture - Vec2::splat(0.5);
        Rect::from_min_max(self.to_screen([-0.5, -0.5]), self.to_screen([far.x, far.y]))
    }

    /// The square of one pixel on the screen.
    pub fn pixel_rect(&self, [x, y]: [usize; 2]) -> Rect {
        Rect::from_center_size(self.to_screen([x as f32, y as f32]), Vec2::splat(self.scale))
    }

    /// Pixels that can be seen: first and last column, first and last row.
    pub fn visible(&self) -> Option<[[usize; 2]; 2]> {
        let seen = self.picture_rect().intersect(self.pane);
        if !seen.is_positive() {
            return None;
        }
        let place = |p: Pos2| {
            let [x, y] = self.to_image(p).map(f32::round);
            [x.clamp(0.0, self.picture.x - 1.0) as usize, y.clamp(0.0, self.picture.y - 1.0) as usize]
        };
        let ([left, top], [right, bottom]) = (place(seen.min), place(seen.max));
        Some([[left, right], [top, bottom]])
    }

    /// The zoom after magnifying by `factor` with the image point under `cursor` held still.
    pub fn zoomed(&self, cursor: Pos2, factor: f32) -> Zoom {
        let held = self.to_image(cursor);
        let mut lens = Self { scale: self.scale * factor, ..*self }.within();
        let drift = pos2(held[0], held[1]) - Pos2::from(lens.to_image(cursor));
        lens.center += drift;
        lens.within().zoom()
    }

    /// The scale of the picture `times` as large, as far as there is one.
    pub fn magnified(&self, times: f32) -> f32 {
        (times * self.scale).min(LARGEST)
    }

    /// The zoom after the picture was dragged by `delta` points.
    pub fn panned(&self, delta: Vec2) -> Zoom {
        Self { center: self.center - delta / self.scale, ..*self }.within().zoom()
    }

    /// One image pixel to `scale` points, with the middle held still.
    pub fn at_scale(&self, scale: f32) -> Zoom {
        Self { scale, ..*self }.within().zoom()
    }

    fn zoom(&self) -> Zoom {
        Zoom::At { center: self.center.into(), scale: self.scale }
    }

    /// Width and height of what the pane shows, in px of the picture.
    pub fn extent(&self) -> [f32; 2] {
        (self.pane.size() / self.scale).into()
    }
}

impl State {
    /// How the pictures are looked at where that was chosen by hand; none while the view follows the work.
    pub fn chosen(&self) -> Option<Lens> {
        let is_by_hand = self.zoom != Zoom::Fit || self.follow.is_paused();
        let Lens { pane, picture, .. } = self.shown.filter(|_| is_by_hand)?;
        Some(Lens::new(pane, (picture.x as usize, picture.y as usize), self.zoom))
    }

    /// The part of the pictures that is seen where it was chosen by hand, in px of frame t.
    pub fn section(&self) -> Option<primitive::Rect> {
        self.chosen().map(|lens| primitive::Rect::centered(lens.center.into(), lens.extent()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pane() -> Rect {
        Rect::from_min_size(pos2(30.0, 70.0), vec2(600.0, 400.0))
    }

    fn lens(zoom: Zoom) -> Lens {
        Lens::new(pane(), (584, 388), zoom)
    }

    #[test]
    fn fit_shows_the_whole_picture() {
        let lens = lens(Zoom::Fit);
        assert!(pane().expand(1e-3).contains_rect(lens.picture_rect()));
        assert!((lens.picture_rect().center() - pane().center()).length() < 1e-3);
        assert_eq!(lens.visible(), Some([[0, 583], [0, 387]]));
    }

    #[test]
    fn screen_and_image_are_inverse() {
        let lens = lens(Zoom::At { center: [100.25, 57.5], scale: 7.3 });
        for [x, y] in [[0usize, 0], [99, 57], [120, 70]] {
            let there = lens.to_screen([x as f32, y as f32]);
            let back = lens.to_image(there);
            assert!((back[0] - x as f32).abs() < 1e-3 && (back[1] - y as f32).abs() < 1e-3);
            if pane().contains(there) {
                assert_eq!(lens.pixel_at(there), Some([x, y]));
                assert!(lens.pixel_rect([x, y]).contains(there));
            }
        }
        assert_eq!(lens.pixel_at(pos2(0.0, 0.0)), None, "outside the pane");
    }

    #[test]
    fn zooming_keeps_the_pixel_under_the_cursor() {
        let mut lens = lens(Zoom::Fit);
        let cursor = pos2(412.0, 305.0);
        let held = lens.to_image(cursor);
        for factor in [1.3, 2.0, 5.0, 0.7, 0.9] {
            lens = Lens::new(pane(), (584, 388), lens.zoomed(cursor, factor));
            let now = lens.to_image(cursor);
            assert!((now[0] - held[0]).abs() < 1e-2 && (now[1] - held[1]).abs() < 1e-2, "{now:?} {held:?}");
        }
    }

    #[test]
    fn a_part_is_told_of_where_it_was_chosen_by_hand() {
        let mut state = State { shown: Some(lens(Zoom::Fit)), ..State::default() };
        assert_eq!(state.section(), None, "the view follows the work");
        state.zoom = Zoom::At { center: [100.0, 80.0], scale: 8.0 };
        assert_eq!(state.section(), Some(primitive::Rect::new([62.5, 55.0], [75.0, 50.0])));
        state.fit();
        let section = state.section().unwrap();
        let picture = primitive::Rect::new([-0.5; 2], [584.0, 388.0]);
        assert!(picture.corners().iter().all(|corner| section.contains(*corner)), "{section:?}");
    }

    #[test]
    fn a_picture_cannot_be_lost() {
        let far = lens(Zoom::At { center: [1e9, f32::NAN], scale: f32::INFINITY });
        assert!(far.visible().is_some());
        let dragged = Lens::new(pane(), (584, 388), far.panned(vec2(-1e7, 1e7)));
        assert!(dragged.picture_rect().intersects(pane()));
        let tiny = Lens::new(Rect::from_min_size(pos2(0.0, 0.0), Vec2::ZERO), (0, 0), Zoom::Fit);
        assert!(tiny.scale.is_finite() && tiny.scale > 0.0);
    }
}
