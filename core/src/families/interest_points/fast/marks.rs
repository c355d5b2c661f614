//! The marks of FAST.

use super::probe::{Probe, SHADES, number, role_of_run, shows_circle};
use super::{Event, Fast};
use crate::methods::features::segment::{CIRCLE, COMPASS, Candidate, Circle, RADIUS};
use crate::methods::features::{Stage, draw_minimum_distance, draw_points, point};
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape};

impl Fast {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        draw_scores(seen, scene);
        match state.stage {
            Stage::Response => {
                let tested = |is_corner: bool| {
                    let pixels = seen.events.iter().filter_map(move |event| match event {
                        Event::Tested(Candidate { x, score }) if (*score > 0) == is_corner => Some((*x, state.row)),
                        _ => None,
                    });
                    pixels.collect()
                };
                draw_points(scene, (Role::Candidate, "passes the high-speed test only"), tested(false));
                draw_points(scene, (Role::Best, "corner"), tested(true));
            }
            Stage::Suppression => {
                let compared = seen.events.iter().filter_map(|event| match event {
                    Event::Compared(place, by) => Some((*place, by.is_none())),
                    _ => None,
                });
                state.draw_suppression(scene, "local maximum of the score", compared);
            }
            Stage::Choice => {
                let tested = seen.events.iter().filter_map(|event| match event {
                    Event::Peak(peak, near) => Some((*peak, near.is_none())),
                    _ => None,
                });
                state.draw_choice(scene, tested, seen.after.is_some());
            }
        }
        if state.stage != Stage::Choice {
            let row = Shape::pixels(0, state.row as i32, state.map.width(), 1);
            scene.draw(Picture::CURRENT, (Role::Window, "current row"), row);
        }
        self.draw_pixel(seen, scene);
    }

    fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(Probe { place, circle, is_pointed_at }) = self.probe(seen) else { return };
        if !shows_circle(seen) {
            draw_minimum_distance(scene, place, self.selection.min_distance);
        } else if let Some(circle) = circle {
            draw_circle(scene, &circle, seen.before.stage, seen.before.map.size());
            // A step is about the pixel that it tests or compares, and not about the pointer.
            if !is_pointed_at && matches!(seen.events.last(), Some(Event::Tested(_) | Event::Compared(..))) {
                let reach = RADIUS as f32 + 0.5;
                scene.work = Some([-reach, reach].map(|by| point(place).map(|c| c + by)));
            }
        }
        scene.draw(
            Picture::CURRENT,
            (Role::Reference, "inspected pixel p"),
            Shape::pixels(place.0 as i32, place.1 as i32, 1, 1),
        );
    }
}

/// Draws the pixels of the circle by their shades, and the longest run, in roles that no corner of `stage` has.
fn draw_circle(scene: &mut Scene, circle: &Circle, stage: Stage, (width, height): (usize, usize)) {
    let on_circle = |k: usize, radius: f32| {
        let [x, y] = point(circle.center);
        let [i, j] = CIRCLE[k % 16].map(|offset| radius * offset as f32);
        [x + i, y + j]
    };
    for (shade, role, meaning) in SHADES {
        for k in (0..16).filter(|k| circle.shades[*k] == shade) {
            let [x, y] = on_circle(k, 1.0);
            scene.draw(Picture::CURRENT, (role, meaning), Shape::pixels(x as i32, y as i32, 1, 1));
        }
    }
    if let Some((start, length)) = circle.run {
        let points = (start..start + length).map(|k| on_circle(k, 1.0)).collect();
        let (role, meaning) = role_of_run(circle, stage);
        scene.draw(Picture::CURRENT, (role, meaning), Shape::Path { points, closed: length == 16 });
    }
    for k in COMPASS {
        let text = number(k).to_string();
        let is_inside = |at: &[f32; 2]| at[0] >= 0.0 && at[1] >= 0.0 && at[0] < width as f32 && at[1] < height as f32;
        // At the picture border there is room on the inner side only.
        let at = Some(on_circle(k, 4.0 / 3.0)).filter(is_inside).unwrap_or_else(|| on_circle(k, 2.0 / 3.0));
        scene.mark(Picture::CURRENT, Role::Reference, Shape::Text { at, text });
    }
}

fn draw_scores(seen: &Seen<Fast>, scene: &mut Scene) {
    let state = seen.before;
    let (width, height) = state.map.size();
    let mut values = state.map.map(|score| if *score > 0 { f32::from(*score) } else { f32::NAN });
    for event in seen.events {
        if let Event::Tested(Candidate { x, score: score @ 1.. }) = event {
            values[(*x, state.row)] = f32::from(*score);
        }
    }
    if width * height > 0 && values.cells().iter().any(|value| value.is_finite()) {
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::heat(values));
        scene.heat = Some("V");
    }
}
