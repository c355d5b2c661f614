//! The search for extrema among 26 neighbours in position and scale.

use super::super::{Event, Row, Sift, Stage, State};
use crate::base::words::{self, gray, pixel};
use crate::geometry::Grid;
use crate::methods::differential::explain;
use crate::methods::scale_space::{Extremum, Refined, beats};
use crate::run::Seen;
use crate::scene::{Fact, Picture, Role, Scene, Sentence, Shape, Tile};

/// The differences of Gaussians below, at and above a pixel, with its position.
pub(super) struct Around<'a> {
    at: Extremum,
    differences: [&'a Grid<f32>; 3],
}

impl Around<'_> {
    fn value(&self) -> f32 {
        self.differences[1][(self.at.x, self.at.y)]
    }
}

impl Sift {
    pub(super) fn current_row(&self, state: &State) -> Option<Row> {
        (state.stage == Stage::Extrema).then(|| self.row(state.picture.size(), state.next)).flatten()
    }

    /// Octave and level in words, counted from 1 as octaves are.
    pub(super) fn scale_name(&self, octave: usize, level: usize) -> String {
        let sigma = self.shape().sigma_of(level as f32) * self.shape().pixel_px(octave);
        format!("octave {}, difference {} (σ = {} px of the frame)", octave + 1, level + 1, gray(sigma))
    }

    pub(super) fn row_said(&self, state: &State) -> String {
        let Some(Row { octave, level, y }) = self.current_row(state) else { return String::new() };
        format!(
            "Row {y} of {}: each pixel with |D| above {} gray levels, half the contrast threshold, is compared with its 26 neighbours in \
             position and scale.",
            self.scale_name(octave, level),
            gray(self.least())
        )
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

    pub(super) fn extremum_said(&self, state: &State, x: usize) -> Sentence {
        let Some(Row { octave, level, y }) = self.current_row(state) else { return Sentence::default() };
        let Some(around) = self.around(state, Extremum { octave, level, x, y }) else { return Sentence::default() };
        compared(&around)
    }

    pub(super) fn row_facts(&self, seen: &Seen<Self>) -> Vec<Fact> {
        let Some(Row { octave, level, y }) = self.current_row(seen.before) else { return Vec::new() };
        let found = seen.events.iter().filter(|event| matches!(event, Event::Extremum(_))).count();
        vec![
            Fact::new("Searched", self.scale_name(octave, level), None),
            Fact::new("Row", y.to_string(), None),
            Fact::new("Extrema so far", words::grouped(seen.before.extrema.len() + found), Some(Role::Candidate)),
        ]
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
        scene.mark(Picture::RESPONSE, Role::Window, Shape::Path { points: ends, closed: false });
        scene.legend(Role::Window, "row searched");
        if !points.is_empty() {
            scene.mark(Picture::RESPONSE, Role::Candidate, Shape::Points(points));
            scene.legend(Role::Candidate, "extremum in position and scale");
        }
        if let Some(Event::Extremum(x)) = seen.events.last() {
            let at = Extremum { octave, level, x: *x, y };
            let found = Refined { at, offset: [0.0; 3], response: 0.0 };
            scene.mark(Picture::RESPONSE, Role::Best, self.circle(&found));
            scene.legend(Role::Best, "extremum of this step, radius √2 σ");
        }
        if let Some(around) = seen.point().and_then(|point| self.pointed_at(state, point)) {
            let [x, y] = self.point_of(&around.at);
            let reach = [1.5 * size; 2];
            let square = Shape::Rect { min: [x - reach[0], y - reach[1]], max: [x + reach[0], y + reach[1]] };
            scene.mark(Picture::RESPONSE, Role::Reference, square);
        }
    }
}

/// The comparison of a pixel with its 26 neighbours.
pub(super) fn compared(around: &Around) -> Sentence {
    let (value, Extremum { x, y, .. }) = (around.value(), around.at);
    let (extreme, larger) = if value > 0.0 { ("maximum", "larger") } else { ("minimum", "smaller") };
    let said = Sentence::default().ink(Role::Candidate, format!("Pixel {}", pixel((x, y))));
    match beats(around.differences, (x, y)) {
        None => said.text(format!(
            " has D = {} gray levels: none of its 26 neighbours is {larger}, a {extreme} in position and scale, the centre of a {} blob.",
            gray(value),
            if value > 0.0 { "dark" } else { "bright" }
        )),
        Some((level, at, other)) => said.text(format!(
            " has D = {} gray levels, but its neighbour {} {} has {}: no extremum.",
            gray(value),
            pixel(at),
            ["at the smaller scale", "at the same scale", "at the larger scale"][level],
            gray(other)
        )),
    }
}

/// The 3 × 3 × 3 neighbourhood of a pixel, as three tiles.
pub(super) fn neighbourhood(around: &Around) -> Vec<Tile> {
    let place = (around.at.x, around.at.y);
    let labels = ["D, smaller scale", "D, this scale", "D, larger scale"];
    let values = around.differences.map(|difference| explain::around(difference, place, 1));
    let most = values.iter().flat_map(|grid| grid.cells()).fold(0.0f32, |most, v| most.max(v.abs())).max(1.0);
    let tile = |(label, values)| Tile { label, role: None, values, range: [-most, most], framed: Vec::new() };
    labels.into_iter().zip(values).map(tile).collect()
}
