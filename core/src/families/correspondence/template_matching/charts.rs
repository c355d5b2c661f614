//! The charts and the drawing of template matching.

use std::sync::Arc;

use super::{Drift, Event, Found, Pair, Past, State, Template, TemplateMatching, window};
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::correlation::Score;
use crate::methods::features::trails;
use crate::run::Seen;
use crate::scene::{
    Arrow, Canvas, Footing, Picture, PictureRole, Readout, Role, Scene, Series, Shape, Step, Surface, Tile,
};

/// The pair that a step shows, the best place so far, and the place with its numbers.
pub(super) struct Shown<'a> {
    pub(super) pair: &'a Pair,
    /// Number of places scored before, row by row.
    pub(super) done: usize,
    /// Number of places scored in this unit.
    pub(super) here: usize,
    /// The best place before the current candidate.
    pub(super) before: Option<(usize, usize)>,
    pub(super) best: Option<(usize, usize)>,
    pub(super) place: Option<(usize, usize)>,
    pub(super) found: Option<&'a Found>,
}

impl<'a> Shown<'a> {
    pub(super) fn of(seen: &Seen<'a, TemplateMatching>) -> Option<Self> {
        let of = |pair, done| Self { pair, done, here: 0, before: None, best: None, place: None, found: None };
        match seen.events.last()? {
            Event::Chosen(_) | Event::Flat(_) => None,
            Event::Area(pair) => Some(of(pair, 0)),
            Event::Candidate(pair, [x, y]) => {
                let (x, y) = (*x as usize, *y as usize);
                let before = (0..x).fold(seen.before.best, |best, x| Some(pair.better(best, (x, y))));
                let (best, place) = (Some(pair.better(before, (x, y))), Some((x, y)));
                Some(Self { here: x + 1, before, best, place, ..of(pair, y * pair.costs.width()) })
            }
            Event::Decided(_, found) => {
                let best = Some(found.best);
                Some(Self { best, place: best, found: Some(found), ..of(&found.pair, found.pair.costs.cells().len()) })
            }
        }
    }

    /// The role of the place with its numbers.
    pub(super) fn role(&self) -> Role {
        if self.found.is_some() || self.place == self.best { Role::Best } else { Role::Candidate }
    }
}

impl TemplateMatching {
    pub(super) fn add_charts(&self, step: Step, seen: &Seen<Self>, shown: &Shown) -> Step {
        let tiles = match shown.place {
            Some(place) => tiles(shown.pair, place, shown.role()),
            None => vec![template_tile(&shown.pair.template)],
        };
        let step = step.show(Readout::Tiles(tiles)).show(Readout::Surface(self.surface(seen, shown)));
        step.show_all(self.plots(seen.after.filter(|_| shown.found.is_some()).unwrap_or(seen.before)))
    }

    /// The costs of the places scored so far.
    fn surface(&self, seen: &Seen<Self>, shown: &Shown) -> Surface {
        let (pair, width) = (shown.pair, shown.pair.costs.width());
        let count = shown.done + shown.here;
        let values = Grid::from_fn(width, pair.costs.height(), |x, y| {
            if y * width + x < count { pair.costs[(x, y)] as f32 } else { f32::NAN }
        });
        // A click leads to events of this unit.
        let event = |x: usize, y: usize| {
            let index = y * width + x;
            (shown.done..count).contains(&index).then(|| index - shown.done + 1)
        };
        let events = Grid::from_fn(width, pair.costs.height(), event);
        let truth = shown.found.and_then(|found| {
            let to = found.true_point?;
            Some([0, 1].map(|i| to[i] - seen.before.template.anchor[i] - pair.from[i] as f32))
        });
        // A match stands at its centre.
        let (width_px, height_px) = seen.before.template.pixels.size();
        let center =
            [(pair.from[0], width_px), (pair.from[1], height_px)].map(|(c, side)| c as f32 + (side as f32 - 1.0) / 2.0);
        let footing = Footing::new(Picture::NEXT, center);
        let all = pair.costs.cells().iter().map(|cost| *cost as f32);
        let range = all.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], cost| [low.min(cost), high.max(cost)]);
        Surface {
            unit: match self.score {
                Score::Ssd => "gray levels²",
                Score::Sad => "gray levels",
                Score::Ncc | Score::Zncc => "",
            },
            scale: (range[0] < range[1]).then_some(range),
            probe: shown.place.filter(|_| shown.found.is_none()).map(|place| pair.displacement(place)),
            best: shown.best.map(|best| pair.displacement(best)),
            truth,
            footing: Some(Footing { whole: Some(pair.costs.map(|cost| *cost as f32)), ..footing }),
            ..Surface::new(self.score.cost_name(), pair.displacement((0, 0)), values, events)
        }
    }

    /// The score and the drift of the pairs so far.
    fn plots(&self, state: &State) -> Vec<Readout> {
        if state.past.is_empty() {
            return Vec::new();
        }
        let line = |of: fn(&Past) -> Option<f32>| -> Vec<[f32; 2]> {
            let points = state.past.iter().enumerate().filter_map(|(i, past)| Some([(i + 1) as f32, of(past)?]));
            points.collect()
        };
        let x_max = state.span.frames().map_or(state.past.len(), |frames| frames - 1);
        let score = Series {
            thresholds: vec![("minimum".into(), self.min_zncc)],
            ..Series::new(
                "ZNCC at the peak",
                ["pair", "ZNCC"],
                x_max,
                vec![("ZNCC", Role::Best, line(|past| Some(past.zncc)))],
            )
        };
        let lines = [
            ("from the first template", Role::Error, line(|past| past.drift.map(Drift::length))),
            ("from the true position", Role::Truth, line(|past| past.error)),
        ];
        let lines: Vec<_> = lines.into_iter().filter(|(.., points)| !points.is_empty()).collect();
        let drift = (!lines.is_empty()).then(|| Series::new("Drift", ["pair", "distance (px)"], x_max, lines));
        [Some(score), drift].into_iter().flatten().map(Readout::Series).collect()
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let (width, height) = state.template.pixels.size();
        let rectangle = |[x, y]: [i32; 2]| Shape::pixels(x, y, width, height);
        trails::trail(scene, (Role::Estimate, "path of the template"), &state.track, state.frame);
        scene.draw(Picture::CURRENT, (Role::Reference, "template"), rectangle(state.at));
        let template = Arc::clone(&state.template);
        let canvas = Picture { role: PictureRole::Template, ..Picture::CURRENT };
        scene.pictures = vec![
            Canvas::of_clip(Picture::CURRENT),
            Canvas::of_clip(Picture::NEXT),
            Canvas::made(canvas, move || Frame::gray(template.pixels.clone())),
        ];
        let Some(shown) = Shown::of(seen) else { return };
        let (pair, places) = (shown.pair, shown.pair.costs.size());
        let mut mark = |role, meaning, shape| {
            scene.draw(Picture::NEXT, (role, meaning), shape);
        };
        let area = Shape::pixels(pair.origin[0], pair.origin[1], places.0 + width - 1, places.1 + height - 1);
        mark(Role::Window, "search area", area);
        if let Some(best) = shown.best {
            mark(Role::Best, "best so far", rectangle(pair.corner(best)));
        }
        if let Some(place) = shown.place.filter(|_| shown.found.is_none()) {
            mark(Role::Candidate, "candidate", rectangle(pair.corner(place)));
        }
        let Some(found) = shown.found else { return };
        if let Some(second) = found.second {
            mark(Role::Rejected, "second-best peak", rectangle(pair.corner(second)));
        }
        if let Some(truth) = found.true_point {
            mark(Role::Truth, "true position", Shape::Points(vec![truth]));
        }
        if let Some([u, v]) = found.feature.displacement {
            let from = found.feature.at;
            trails::displacements(scene, vec![Arrow { from, to: [from[0] + u, from[1] + v] }]);
        }
    }
}

pub(super) fn template_tile(template: &Template) -> Tile {
    let values = template.pixels.map(|&pixel| f32::from(pixel));
    Tile::gray("template", values).with_role(Role::Reference)
}

/// The template, the window at a place, and their difference.
fn tiles(pair: &Pair, place: (usize, usize), role: Role) -> Vec<Tile> {
    let template = &pair.template.pixels;
    let under = window(pair.frames[1].luma(), pair.corner(place), template.size());
    let difference = Grid::from_fn(template.width(), template.height(), |x, y| {
        f32::from(under[(x, y)]) - f32::from(template[(x, y)])
    });
    let values = under.map(|&pixel| f32::from(pixel));
    vec![
        template_tile(&pair.template),
        Tile::gray("window", values).with_role(role),
        Tile::new("difference", difference, [-64.0, 64.0]).with_role(Role::Error),
    ]
}
