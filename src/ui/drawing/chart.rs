//! Charts as the window's shapes, made once for what they show, their place and their look.

use std::sync::Arc;

use eframe::egui::{self, Painter, Pos2, Rect, Shape};
use motionscope_core::scene::Step;

use crate::paint::charts::{ChartStyle, Drawing};
use crate::paint::primitive;
use crate::paint::{ColorMap, Primitive, Theme};
use crate::ui::drawing::ink;
use crate::ui::drawing::primitives::{Kept, Maker};

/// Whose data a chart shows, and how it looks.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The step that tells the data: as long as it stays the same, nothing is laid out anew. Without it, every frame is.
    pub step: Option<&'a Arc<Step>>,
    /// The name of the estimator.
    pub whose: &'a str,
    /// Colors and sizes.
    pub theme: Theme,
    /// Colors for small and large numbers.
    pub colors: ColorMap,
}

impl Subject<'_> {
    /// How charts look through `painter`.
    pub fn style(&self, painter: &Painter) -> ChartStyle {
        ChartStyle { theme: self.theme, colors: self.colors, density: painter.pixels_per_point() }
    }
}

/// A chart that is shown: its shapes, and where its parts stand.
pub struct Chart<P, K = ()> {
    known: Option<Known<P, K>>,
    kept: Kept,
}

impl<P, K> Default for Chart<P, K> {
    fn default() -> Self {
        Self { known: None, kept: Kept::default() }
    }
}

struct Known<P, K> {
    /// What it follows from: the step and the data in it, the place, the look and what else is seen.
    key: Key<K>,
    place: P,
    body: Vec<(Option<Rect>, Vec<Shape>)>,
    head: Vec<Shape>,
}

#[derive(PartialEq)]
struct Key<K> {
    /// The step by its place in memory; what is kept here stays there.
    step: Option<(Held, usize)>,
    area: Rect,
    style: ChartStyle,
    atlas: u64,
    more: K,
}

/// A step that is the same as long as it is the very same.
struct Held(Arc<Step>);

impl PartialEq for Held {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl<P: Clone, K: PartialEq> Chart<P, K> {
    /// Lays `data` of a subject out with `draw` in `area`, unless that is what is there; gives where its parts stand.
    /// `more` is what else it follows from.
    pub fn lay_out<T: ?Sized>(
        &mut self,
        painter: &Painter,
        (subject, data): (Subject<'_>, &T),
        (area, more): (Rect, K),
        draw: impl FnOnce(primitive::Rect, ChartStyle) -> Drawing<P>,
    ) -> P {
        let address = std::ptr::from_ref(data).cast::<u8>() as usize;
        let step = subject.step.map(|step| (Held(Arc::clone(step)), address));
        let atlas = ink::atlas(painter.ctx());
        let key = Key { step, area, style: subject.style(painter), atlas, more };
        match &self.known {
            Some(known) if known.key == key && key.step.is_some() => known.place.clone(),
            _ => {
                let Drawing { place, body, head } = draw(rect_of(area), key.style);
                // What is scrolled out of sight now may come into it later.
                let whole = unclipped(painter);
                let mut maker = Maker::new(&whole, None, std::mem::take(&mut self.kept));
                let body = body.into_iter().map(|layer| {
                    layer.primitives.iter().for_each(|primitive| maker.add(primitive));
                    (layer.clip.map(rect_from), maker.take())
                });
                let body = body.collect();
                head.iter().for_each(|primitive| maker.add(primitive));
                let head = maker.take();
                self.kept = maker.finish().1;
                self.known = Some(Known { key, place: place.clone(), body, head });
                place
            }
        }
    }

    /// Paints all but the line above.
    pub fn body(&self, painter: &Painter) {
        for (clip, shapes) in self.known.iter().flat_map(|known| &known.body) {
            let seen = clip.map_or(painter.clip_rect(), |clip| clip.intersect(painter.clip_rect()));
            painter.with_clip_rect(seen).extend(shapes.iter().cloned());
        }
    }

    /// Paints the line above.
    pub fn head(&self, painter: &Painter) {
        painter.extend(self.known.iter().flat_map(|known| &known.head).cloned());
    }

    /// Paints everything that belongs to the origin of the sheet at another place.
    pub fn moved(&self, painter: &Painter, by: egui::Vec2) {
        for shape in self.known.iter().flat_map(|known| known.body.iter().flat_map(|(_, shapes)| shapes)) {
            let mut shape = shape.clone();
            shape.translate(by);
            painter.add(shape);
        }
    }
}

/// A painter to whom nothing is out of sight.
pub fn unclipped(painter: &Painter) -> Painter {
    let mut whole = painter.clone();
    whole.set_clip_rect(Rect::EVERYTHING);
    whole
}

/// A rectangle of the window as painters have it.
pub fn rect_of(rect: Rect) -> primitive::Rect {
    primitive::Rect { min: rect.min.into(), max: rect.max.into() }
}

/// A rectangle of painters as the window has it.
pub fn rect_from(rect: primitive::Rect) -> Rect {
    Rect::from_min_max(Pos2::from(rect.min), Pos2::from(rect.max))
}

/// Paints what follows the pointer.
pub fn over(painter: &Painter, primitives: &[Primitive]) {
    painter.extend(super::primitives::shapes(painter, primitives));
}
