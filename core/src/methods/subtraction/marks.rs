//! The marks of a background subtraction.

use std::sync::Arc;

use super::mask_history::MaskHistory;
use super::{Background, Event, Subtraction};
use crate::base::words::grouped;
use crate::data::{Detection, Mask, MaskErrors};
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape};

impl MaskHistory<'_> {
    /// Draws the result of the last stage.
    pub(crate) fn draw(&self, scene: &mut Scene) {
        let [gone, new] = match self.change() {
            Some([before, after]) => {
                [before.without(after), after.without(before)].map(|m| (m.count() > 0).then_some(m))
            }
            None => [None, None],
        };
        match self.events.last() {
            Some(Event::Opened(mask)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                gone.into_iter().for_each(|gone| layer(scene, Role::Rejected, "removed by opening", Arc::new(gone)));
            }
            Some(Event::Closed(mask)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                new.into_iter().for_each(|new| layer(scene, Role::Estimate, "filled by closing", Arc::new(new)));
            }
            Some(Event::Labelled(labels, _)) => {
                scene.draw(
                    Picture::CURRENT,
                    (Role::Candidate, "connected components, one colour each"),
                    Shape::Labels(Arc::clone(labels)),
                );
            }
            Some(Event::Kept(blobs)) => {
                draw_blobs(scene, &blobs[1], (Role::Rejected, "below the minimum area"));
                draw_blobs(scene, &blobs[0], (Role::Result, "blob"));
                draw_shapes(scene, &blobs[0]);
            }
            _ => {}
        }
    }
}

impl<M: Background> Subtraction<M> {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let history = MaskHistory::new(seen.events);
        if let (Some(model), Some(frame)) = (self.compared_model(seen), history.frame()) {
            scene.pictures = self.0.pictures(&model, frame.size());
            // After the update it is the new model.
            scene.layers =
                self.0.layers(seen.after.and_then(|after| after.model.as_ref()).unwrap_or(&model), &self.past(seen));
        }
        match seen.events.last() {
            None => {}
            Some(Event::Followed(..)) => scene.legend(Role::Predicted, "background model, shifted with the camera"),
            Some(Event::Begun(_) | Event::Exposed(..)) => scene.legend(Role::Predicted, "background model"),
            Some(Event::Registered(_)) => scene.legend(Role::Predicted, "previous frame, warped by the motion"),
            Some(Event::Compared(_, difference)) => {
                let values = difference.as_ref().clone();
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::heat(values));
                scene.heat = Some(M::SHOWN);
                scene.legend(Role::Candidate, M::COMPARED);
            }
            Some(Event::Decided(mask)) => layer(scene, Role::Candidate, "foreground", Arc::clone(mask)),
            Some(Event::Shadows(mask, shadows)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                layer(scene, Role::Rejected, "shadow", Arc::clone(shadows));
            }
            Some(Event::Steadied(mask, displaced)) => {
                layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                layer(scene, Role::Rejected, "displaced background", Arc::clone(displaced));
            }
            Some(Event::Updated(conclusion)) => {
                match &conclusion.errors {
                    Some(errors) => draw_errors(scene, errors),
                    None => history.masks().next_back().into_iter().for_each(|mask| {
                        layer(scene, Role::Candidate, "foreground", Arc::clone(mask));
                    }),
                }
                history.kept().into_iter().for_each(|[kept, _]| draw_blobs(scene, kept, (Role::Result, "blob")));
            }
            _ => history.draw(scene),
        }
        if let Some((x, y)) = seen.point().and_then(|point| history.frame()?.luma().cell_at(point)) {
            let beside = scene.pictures.iter().map(|canvas| canvas.picture).filter(|on| self.0.explains(*on));
            let mut all: Vec<_> = beside.chain([Picture::CURRENT]).collect();
            all.sort();
            all.dedup();
            for on in all {
                scene.mark(on, Role::Reference, Shape::pixels(x as i32, y as i32, 1, 1));
            }
            scene.legend(Role::Reference, "explained pixel");
        }
    }
}

fn layer(scene: &mut Scene, role: Role, meaning: &'static str, mask: Arc<Mask>) {
    scene.draw(Picture::CURRENT, (role, meaning), Shape::Mask(mask));
}

/// Draws a mask compared with the true foreground.
fn draw_errors(scene: &mut Scene, errors: &MaskErrors) {
    layer(scene, Role::Estimate, "correct foreground", Arc::new(errors.correct.clone()));
    layer(scene, Role::Error, "false alarm", Arc::new(errors.false_positives.clone()));
    layer(scene, Role::Truth, "missed", Arc::new(errors.misses.clone()));
}

fn draw_blobs(scene: &mut Scene, blobs: &[Detection], (role, meaning): (Role, &'static str)) {
    for blob in blobs {
        scene.mark(Picture::CURRENT, role, Shape::Rect { min: blob.bounds.min, max: blob.bounds.max });
    }
    scene.legend(role, meaning);
}

/// Draws centroids, ellipses and labels.
fn draw_shapes(scene: &mut Scene, blobs: &[Detection]) {
    for Detection { bounds, center, blob, .. } in blobs {
        let Some(blob) = blob else { continue };
        let ellipse = Shape::Ellipse { center: *center, radii: blob.radii, angle_rad: blob.angle_rad };
        scene.draw(Picture::CURRENT, (Role::Estimate, "ellipse of equal second moments"), ellipse);
        scene.draw(Picture::CURRENT, (Role::Measured, "centroid"), Shape::Points(vec![*center]));
        let text =
            Shape::Text { at: bounds.min, text: format!("{}: {} px", blob.label, grouped(blob.area_px as usize)) };
        scene.mark(Picture::CURRENT, Role::Result, text);
    }
}
