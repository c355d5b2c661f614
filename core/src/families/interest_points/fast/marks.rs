//! The marks of FAST.

use super::probe::{Probe, SHADES, number, role_of_run, shows_circle};
use super::{Event, Fast, Stage};
use crate::geometry::Grid;
use crate::methods::features::segment::{CIRCLE, COMPASS, Candidate, Circle, RADIUS};
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape};

fn point((x, y): (usize, usize)) -> [f32; 2] {
    [x as f32, y as f32]
}

impl Fast {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        draw_scores(seen, scene);
        let mut points = |role, meaning, places: Vec<(usize, usize)>| {
            if !places.is_empty() {
                scene.mark(Picture::CURRENT, role, Shape::Points(places.into_iter().map(point).collect()));
                scene.legend(role, meaning);
            }
        };
        let places = |peaks: &[u32]| peaks.iter().map(|peak| state.place(*peak)).collect::<Vec<_>>();
        match state.stage {
            Stage::Test => {
                let passing = seen.events.iter().filter_map(|event| match event {
                    Event::Tested(Candidate { x, score: 0 }) => Some((*x, state.row)),
                    _ => None,
                });
                points(Role::Candidate, "passes the high-speed test only", passing.collect());
                let found = seen.events.iter().filter_map(|event| match event {
                    Event::Tested(Candidate { x, score: 1.. }) => Some((*x, state.row)),
                    _ => None,
                });
                points(Role::Best, "corner", found.collect());
            }
            Stage::Suppression => {
                let of_row = |is_maximum: bool| {
                    let compared = seen.events.iter().filter_map(move |event| match event {
                        Event::Compared(place, by) if by.is_none() == is_maximum => Some(*place),
                        _ => None,
                    });
                    compared.collect::<Vec<_>>()
                };
                points(Role::Rejected, "suppressed (non-maximum)", of_row(false));
                points(Role::Best, "local maximum of the score", [places(&state.peaks), of_row(true)].concat());
            }
            Stage::Choice => {
                let tested = |is_kept: bool| {
                    let peaks = seen.events.iter().filter_map(move |event| match event {
                        Event::Peak(peak, near) if near.is_none() == is_kept => Some(*peak),
                        _ => None,
                    });
                    places(&peaks.collect::<Vec<_>>())
                };
                let (kept, dropped) = (tested(true), tested(false));
                let mut is_done = Grid::new(state.scores.width(), state.scores.height(), seen.after.is_some());
                kept.iter().chain(&dropped).for_each(|place| is_done[*place] = true);
                let waiting = places(&state.peaks).into_iter().filter(|place| !is_done[*place]).collect();
                points(Role::Candidate, "local maximum, not yet tested", waiting);
                points(Role::Rejected, "rejected by the minimum distance", dropped);
                points(Role::Result, "corner", kept);
            }
        }
        if state.stage != Stage::Choice {
            let row = Shape::pixels(0, state.row as i32, state.scores.width(), 1);
            scene.mark(Picture::CURRENT, Role::Window, row);
            scene.legend(Role::Window, "current row");
        }
        self.draw_pixel(seen, scene);
    }

    fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(Probe { place, circle, is_pointed_at }) = self.probe(seen) else { return };
        if !shows_circle(seen) {
            let radius = self.selection.min_distance as f32;
            let shape = Shape::Ellipse { center: point(place), radii: [radius; 2], angle_rad: 0.0 };
            scene.mark(Picture::CURRENT, Role::Window, shape);
            scene.legend(Role::Window, "minimum distance");
        } else if let Some(circle) = circle {
            draw_circle(&circle, (seen.before.stage, seen.before.scores.size()), scene);
            // A step is about the pixel that it tests or compares, and not about the pointer.
            if !is_pointed_at && matches!(seen.events.last(), Some(Event::Tested(_) | Event::Compared(..))) {
                let reach = RADIUS as f32 + 0.5;
                scene.work = Some([-reach, reach].map(|by| point(place).map(|c| c + by)));
            }
        }
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(place.0 as i32, place.1 as i32, 1, 1));
        scene.legend(Role::Reference, "inspected pixel p");
    }
}

/// Draws the pixels of the circle by their shades, and the longest run, in roles that no corner of `stage` has.
fn draw_circle(circle: &Circle, (stage, (width, height)): (Stage, (usize, usize)), scene: &mut Scene) {
    let on_circle = |k: usize, radius: f32| {
        let [x, y] = point(circle.center);
        let [i, j] = CIRCLE[k % 16].map(|offset| radius * offset as f32);
        [x + i, y + j]
    };
    for (shade, role, meaning) in SHADES {
        for k in (0..16).filter(|k| circle.shades[*k] == shade) {
            let [x, y] = on_circle(k, 1.0);
            scene.mark(Picture::CURRENT, role, Shape::pixels(x as i32, y as i32, 1, 1));
            scene.legend(role, meaning);
        }
    }
    if let Some((start, length)) = circle.run {
        let points = (start..start + length).map(|k| on_circle(k, 1.0)).collect();
        let (role, meaning) = role_of_run(circle, stage);
        scene.mark(Picture::CURRENT, role, Shape::Path { points, closed: length == 16 });
        scene.legend(role, meaning);
    }
    for k in COMPASS {
        let text = number(k).to_string();
        let is_inside = |at: &[f32; 2]| at[0] >= 0.0 && at[1] >= 0.0 && at[0] < width as f32 && at[1] < height as f32;
        // At the border of the picture there is room on the inner side only.
        let at = Some(on_circle(k, 4.0 / 3.0)).filter(is_inside).unwrap_or_else(|| on_circle(k, 2.0 / 3.0));
        scene.mark(Picture::CURRENT, Role::Reference, Shape::Text { at, text });
    }
}

/// Draws the scores so far.
fn draw_scores(seen: &Seen<Fast>, scene: &mut Scene) {
    let state = seen.before;
    let (width, height) = state.scores.size();
    let mut values = state.scores.map(|score| if *score > 0 { f32::from(*score) } else { f32::NAN });
    for event in seen.events {
        if let Event::Tested(Candidate { x, score: score @ 1.. }) = event {
            values[(*x, state.row)] = f32::from(*score);
        }
    }
    if width * height > 0 && values.cells().iter().any(|value| value.is_finite()) {
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
        scene.heat = Some("V");
    }
}
