//! Marks over the pictures, made into shapes once per scene and zoom.

use std::sync::Arc;

use eframe::egui::{Painter, Rect, Shape};
use motionscope_core::scene::{Mark, Role, Scene};

use super::{Input, Lens, pixels};
use crate::paint::{Look, Panel, Placement, Style, primitive, resolve};
use crate::ui::drawing::ink;
use crate::ui::drawing::primitives::{Kept, Maker};

/// The shapes that were shown last, by panel.
#[derive(Clone, Default)]
pub struct Marks {
    /// The role that is pointed at in the legend or in words: its marks are seen alone.
    pub lit: Option<Role>,
    look: Option<(Arc<Scene>, Style, Look)>,
    slots: Vec<Slot>,
}

/// What shapes follow from.
#[derive(Clone, PartialEq)]
struct Key {
    look: Look,
    place: Placement,
    pane: Rect,
    pixels_per_point: f32,
    atlas: u64,
    without: Vec<usize>,
    /// The role whose marks are seen alone.
    lit: Option<Role>,
}

#[derive(Clone)]
struct Slot {
    /// Which of several estimators, and which of its pictures.
    place: (usize, Panel),
    scene: Arc<Scene>,
    key: Key,
    shapes: Vec<Shape>,
    kept: Kept,
}

impl Marks {
    /// How the scene looks: the same for the marks and for the legend.
    pub fn look(&mut self, input: &Input<'_>) -> Look {
        let style = input.look.style(input.pictures);
        match &self.look {
            Some((scene, known, look)) if Arc::ptr_eq(scene, input.scene) && *known == style => *look,
            _ => {
                let look = Look::new(input.scene, style);
                self.look = Some((input.scene.clone(), style, look));
                look
            }
        }
    }

    /// Paints the marks of `scene` that the panel shows; `moving` are on their way, by their place in the scene.
    pub fn paint(
        &mut self,
        painter: &Painter,
        (spot, lens): ((usize, Panel), &Lens),
        scene: &Arc<Scene>,
        input: &Input<'_>,
        moving: &[(usize, Mark)],
    ) {
        let (_, panel) = spot;
        let look = self.look(input);
        let pane = primitive::Rect { min: lens.pane.min.into(), max: lens.pane.max.into() };
        let picture = lens.picture_rect().intersect(lens.pane);
        let room = Some(primitive::Rect { min: picture.min.into(), max: picture.max.into() });
        let place = Placement { seen: Some(pane), room, ..Placement::new(lens.picture_rect().min.into(), lens.scale) };
        let without = moving.iter().map(|(index, _)| *index).collect();
        let (pixels_per_point, atlas) = (painter.pixels_per_point(), ink::atlas(painter.ctx()));
        let lit = self.lit;
        let key = Key { look, place, pane: lens.pane, pixels_per_point, atlas, without, lit };
        let at = self.slots.iter().position(|slot| slot.place == spot);
        let fresh = at.is_some_and(|i| Arc::ptr_eq(&self.slots[i].scene, scene) && self.slots[i].key == key);
        if !fresh {
            let kept = at.map(|i| self.slots.swap_remove(i).kept).unwrap_or_default();
            // Where numbers stand in the pixels, a layer of colours would hide them.
            let has_numbers = pixels::has_numbers(lens);
            let clear = |mark: &Mark| !has_numbers || !mark.shape.is_layer() || pixels::tells_costs(mark, lens);
            let is_lit = |mark: &Mark| lit.is_none_or(|role| mark.role == role);
            let shown = |(i, mark): &(usize, &Mark)| {
                panel.shows(mark.on) && clear(mark) && is_lit(mark) && !key.without.contains(i)
            };
            let still = scene.marks.iter().enumerate().filter(shown).map(|(_, mark)| mark);
            let mut maker = Maker::new(painter, input.gpu, kept);
            resolve(still, &look, place).iter().for_each(|primitive| maker.add(primitive));
            let (shapes, kept) = maker.finish();
            self.slots.push(Slot { place: spot, scene: scene.clone(), key, shapes, kept });
        }
        if let Some(slot) = self.slots.iter().find(|slot| slot.place == spot) {
            painter.extend(slot.shapes.iter().cloned());
        }
        let mut maker = Maker::new(painter, input.gpu, Kept::default());
        let moving = moving
            .iter()
            .map(|(_, mark)| mark)
            .filter(|mark| panel.shows(mark.on) && lit.is_none_or(|role| mark.role == role));
        resolve(moving, &look, place).iter().for_each(|primitive| maker.add(primitive));
        painter.extend(maker.finish().0);
    }
}
