//! The classification of a pixel by its samples, in words and numbers.

use super::{KnnBackground, Samples, square};
use crate::base::words::counted;
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::numbers::{gray, level};
use crate::methods::subtraction::{Explanation, kind, levels, tuple};
use crate::scene::{Fact, Math, Matrix, Role, Sentence};

/// The names of the sets.
const SETS: [&str; 3] = ["recent", "earlier", "old"];

impl KnnBackground {
    pub(super) fn explanation(
        &self,
        [before, after]: [Option<&Samples>; 2],
        frame: &Frame,
        place: (usize, usize),
    ) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let color = levels(frame, place, before.channels);
        let near = self.near(&before.sets[place], color, before.channels);
        let is_foreground = near.background < self.k;
        let role = if is_foreground { Role::Result } else { Role::Rejected };
        let (shown, limit) = (tuple(&color[..before.channels], |of| level(of.into())), gray(self.threshold));
        let [name, lower] = kind(before.channels);
        let sign = if is_foreground { " < " } else { " ≥ " };
        let mut facts = vec![
            Fact::new(name, shown.clone(), Some(Role::Measured)),
            Fact::new("Near samples", near.all.to_string(), None),
            Fact::new("Near background samples", near.background.to_string(), Some(role)),
            Fact::new("Threshold", format!("{limit} gray levels"), None),
        ];
        let nearest = self.distances(before, frame, place);
        facts.extend(nearest.first().map(|distance| Fact::new("Nearest sample", gray(*distance), None)));
        let equation = vec![
            Math::Row(vec![
                Math::Var("n"),
                Math::text(" = number of "),
                Math::Abs(Box::new(Math::Row(vec![Math::Var("I"), Math::text(" − "), Math::Var("s")]))),
                Math::text(format!(" ≤ {limit}")),
            ]),
            Math::Row(vec![
                Math::Var("n"),
                Math::text(" = "),
                Math::ink(role, near.background.to_string()),
                Math::text(format!("{sign}{} = ", self.k)),
                Math::Var("k"),
            ]),
        ];
        let verdict = Sentence::default()
            .text(format!(": {lower} "))
            .ink(Role::Measured, shown)
            .text(" has ")
            .ink(role, counted(near.background, "background sample"))
            .text(format!(" within {limit} gray levels. "))
            .text(match is_foreground {
                true => format!("That is less than k = {}: foreground.", self.k),
                false => format!("At least k = {} are needed: background.", self.k),
            });
        let update = after.map_or_else(Sentence::default, |after| self.replaced([before, after], near.all, place));
        Explanation { facts, equation, matrices: vec![self.table(before, frame, place)], verdict, update }
    }

    /// The samples of a pixel that a frame has replaced.
    fn replaced(&self, [before, after]: [&Samples; 2], near: usize, place: (usize, usize)) -> Sentence {
        let said = Sentence::default();
        let both = before.sets[place].iter().zip(&after.sets[place]).zip(SETS);
        let changed: Vec<&str> = both.filter(|((old, new), _)| old != new).map(|(_, name)| name).collect();
        if changed.is_empty() {
            return said.text("no sample is replaced in this frame.");
        }
        let class = if near >= self.k { "background" } else { "foreground" };
        said.text("samples replaced among the ")
            .ink(Role::Estimate, format!("{} values", changed.join(" and ")))
            .text(format!("; {} near, so a new one counts as {class}.", counted(near, "sample")))
    }

    /// The samples of a pixel, one row each.
    fn table(&self, model: &Samples, frame: &Frame, place: (usize, usize)) -> Matrix {
        let color = levels(frame, place, model.channels);
        let samples: Vec<_> = self.used(&model.sets[place]).collect();
        let mut columns = if model.channels == 1 { vec!["I"] } else { vec!["R", "G", "B"] };
        columns.extend(["background", "distance"]);
        let channels = model.channels;
        let entries = Grid::from_fn(columns.len(), samples.len(), |x, y| {
            let sample = samples[y];
            match x {
                x if x < channels => f64::from(sample.color[x]),
                x if x == channels => f64::from(u8::from(sample.is_background)),
                _ => f64::from(square(sample.color, color, channels).sqrt()),
            }
        });
        let is_near = |y: usize| square(samples[y].color, color, channels) <= self.threshold * self.threshold;
        let changed = Grid::from_fn(columns.len(), samples.len(), |_, y| samples[y].is_background && is_near(y));
        let names = SETS.iter().flat_map(|name| (1..=self.samples).map(move |number| format!("{name} {number}")));
        Matrix {
            symbol: "S",
            name: "samples before the update",
            role: Some(Role::Predicted),
            entries,
            rows: names.collect(),
            columns: columns.into_iter().map(String::from).collect(),
            changed: Some(changed),
            decimals: None,
        }
    }
}
