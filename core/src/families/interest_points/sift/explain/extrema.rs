//! The search for extrema among 26 neighbours in position and scale.

use super::super::{Event, Row, Sift, Stage, State, case, features, value};
use crate::geometry::Grid;
use crate::methods::differential::explain;
use crate::methods::scale_space::{Extremum, Refined, beats};
use crate::run::Seen;
use crate::scene::{Name, Picture, Readout, Role, Scene, Shape, Step, Tile};

/// The differences of Gaussians below, at and above a pixel, with its position.
pub(super) struct Around<'a> {
    at: Extremum,
    differences: [&'a Grid<f32>; 3],
}

impl Around<'_> {
    /// Explains the comparison of the pixel with its 26 neighbours.
    pub(super) fn tell_comparison(&self, step: Step) -> Step {
        let place = (self.at.x, self.at.y);
        let value = self.differences[1][place];
        let step = step.put_value(features::PIXEL.is(place).inked(Role::Candidate)).put(value::D, value);
        let step = match beats(self.differences, place) {
            None => step.say(if value > 0.0 { case::MAXIMUM } else { case::MINIMUM }),
            Some((level, at, other)) => {
                let step = step.put(features::NEIGHBOUR, at).put(value::OTHER_D, other).say(case::NO_EXTREMUM);
                step.say([case::AT_SMALLER, case::AT_SAME, case::AT_LARGER][level])
            }
        };
        step.show(self.tiles())
    }

    /// The 3 × 3 × 3 neighbourhood of the pixel, as three tiles.
    pub(super) fn tiles(&self) -> Readout {
        let labels = ["D, smaller scale", "D, this scale", "D, larger scale"];
        let values = self.differences.map(|difference| explain::around(difference, (self.at.x, self.at.y), 1));
        let most = values.iter().flat_map(|grid| grid.cells()).fold(0.0f32, |most, v| most.max(v.abs())).max(1.0);
        let tile = |(label, values)| Tile::new(label, values, [-most, most]);
        Readout::Tiles(labels.into_iter().zip(values).map(tile).collect())
    }
}

impl Sift {
    pub(super) fn current_row(&self, state: &State) -> Option<Row> {
        (state.stage == Stage::Extrema).then(|| self.row(state.picture.size(), state.next)).flatten()
    }

    pub(super) fn around<'a>(&self, state: &'a State, at: Extremum) -> Option<Around<'a>> {
        let all = &state.space.octaves.get(at.octave)?.differences;
        let level = |level: usize| all.get(level).map(|image| &**image);
        let differences = [level(at.level.checked_sub(1)?)?, level(at.level)?, level(at.level + 1)?];
        let (width, height) = differences[1].size();
        let is_inside = at.x > 0 && at.y > 0 && at.x + 1 < width && at.y + 1 < height;
        is_inside.then_some(Around { at, differences })
    }

    /// The pixel of the current difference under a point of the frame.
    pub(super) fn pointed_at<'a>(&self, state: &'a State, point: [f32; 2]) -> Option<Around<'a>> {
        let Row { octave, level, .. } = self.current_row(state)?;
        let size = self.shape().pixel_px(octave);
        let [x, y] = point.map(|c| (c / size).round().max(0.0) as usize);
        self.around(state, Extremum { octave, level, x, y })
    }

    /// A step about the row being searched.
    pub(super) fn tell_search(&self, seen: &Seen<Self>, line: Name) -> Step {
        let Some(Row { octave, level, y }) = self.current_row(seen.before) else { return Step::at(line) };
        let sigma = self.shape().sigma_of(level as f32) * self.shape().pixel_px(octave);
        let found = seen.events.iter().filter(|event| matches!(event, Event::Extremum(_))).count();
        let step = Step::at(line).fact(value::OCTAVE, octave + 1).fact(value::DIFFERENCE, level + 1);
        let step = step.fact(value::SIGMA_IN_FRAME, sigma).fact(features::ROW, y).put(value::LEAST, self.least());
        step.fact(value::EXTREMA_SO_FAR, seen.before.extrema.len() + found)
    }

    pub(super) fn point_of(&self, at: &Extremum) -> [f32; 2] {
        let size = self.shape().pixel_px(at.octave);
        [at.x as f32 * size, at.y as f32 * size]
    }

    pub(super) fn draw_extrema(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let Some(Row { octave, level, y }) = self.current_row(state) else { return };
        self.show_difference(state, (octave, level), scene);
        let in_row = seen.events.iter().filter_map(|event| match event {
            Event::Extremum(x) => Some(Extremum { octave, level, x: *x, y }),
            _ => None,
        });
        let points: Vec<_> = state.extrema.iter().copied().chain(in_row).map(|at| self.point_of(&at)).collect();
        let size = self.shape().pixel_px(octave);
        let row = (y as f32 * size, state.picture.size().0 as f32);
        let ends = vec![[-0.5, row.0], [row.1 - 0.5, row.0]];
        scene.draw(Picture::RESPONSE, (Role::Window, "row searched"), Shape::line(ends));
        if !points.is_empty() {
            scene.draw(Picture::RESPONSE, (Role::Candidate, "extremum in position and scale"), Shape::Points(points));
        }
        if let Some(Event::Extremum(x)) = seen.events.last() {
            let at = Extremum { octave, level, x: *x, y };
            let found = Refined { at, offset: [0.0; 3], response: 0.0 };
            scene.draw(Picture::RESPONSE, (Role::Best, "extremum of this step, radius √2 σ"), self.circle(&found));
        }
        if let Some(around) = seen.point().and_then(|point| self.pointed_at(state, point)) {
            let [x, y] = self.point_of(&around.at);
            let reach = [1.5 * size; 2];
            let square = Shape::Rect { min: [x - reach[0], y - reach[1]], max: [x + reach[0], y + reach[1]] };
            scene.mark(Picture::RESPONSE, Role::Reference, square);
        }
    }
}
