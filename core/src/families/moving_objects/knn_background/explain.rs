//! The classification of a pixel by its samples.

use super::{KnnBackground, Samples, square};
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::subtraction::{self, Cases, Explanation, Probe, levels, put_pixel};
use crate::scene::{Matrix, Readout, Role, Step, Unit};

/// The names of the sets.
const SETS: [&str; 3] = ["recent", "earlier", "old"];

crate::variables! {
    /// The samples within the threshold of the pixel, background or not.
    NEAR: "Near samples", "", Unit::count("sample");
    /// The background samples within the threshold of the pixel.
    NEAR_BACKGROUND: "Near background samples", "n", Unit::count("background sample");
    /// The distance of the nearest background sample.
    NEAREST: "Nearest sample", "", Unit::GRAY;
    /// The number of background samples that make a pixel background.
    K: "", "k", Unit::WHOLE;
    /// The sets of which the update has replaced samples.
    REPLACED_SETS: "", "", Unit::WHOLE, Role::Estimate;
}

crate::cases! { over value, subtraction::value;
    RULE: "fewer than k = {k} background samples lie within {threshold}.",
    NEAR: "has {near_background} within {threshold}.",
    TOO_FEW: "That is less than k = {k}: foreground.",
    ENOUGH: "At least k = {k} are needed: background.",
    NONE_REPLACED: "no sample is replaced in this frame.",
    REPLACED_BY_BACKGROUND: "samples replaced among the {replaced_sets} {estimate|values}; {near} near, so a new one counts as \
                             background.",
    REPLACED_BY_FOREGROUND: "samples replaced among the {replaced_sets} {estimate|values}; {near} near, so a new one counts as \
                             foreground.",
}

impl KnnBackground {
    /// Puts k and the threshold; returns with them the rule.
    pub(super) fn put_rule(&self, step: Step) -> (Step, Cases) {
        (step.put(value::K, self.k).put(subtraction::value::THRESHOLD, self.threshold), vec![case::RULE])
    }

    pub(super) fn explanation(&self, step: Step, probe: &Probe<Samples>) -> Explanation {
        let &Probe { before, after, frame, place } = probe;
        let (color, channels) = (levels(frame, place, before.channels), before.channels);
        let sets = &before.sets[place];
        let near = self.near(sets, color, channels);
        let is_foreground = !self.has_near(sets, (color, channels), |sample| sample.is_background);
        let (role, sign) = if is_foreground { (Role::Result, "<") } else { (Role::Rejected, r"\ge") };
        let (step, level) = put_pixel(step, &color[..channels]);
        let step = step
            .fact(value::NEAR, near.all)
            .fact_of(value::NEAR_BACKGROUND.is(near.background).inked(role))
            .fact(subtraction::value::THRESHOLD, self.threshold)
            .fact_if(value::NEAREST, self.distances(before, frame, place).first().copied())
            .put(value::K, self.k)
            .formula(r"n = \text{number of }|I - s| \le {threshold}")
            .formula(format!("n = {{near_background}} {sign} {{k}} = k"))
            .show(Readout::Matrices(vec![self.table(before, frame, place)]));
        let verdict = vec![level, case::NEAR, if is_foreground { case::TOO_FEW } else { case::ENOUGH }];
        let Some(after) = after else { return Explanation { step, verdict, update: Vec::new() } };
        let both = sets.iter().zip(&after.sets[place]).zip(SETS);
        let changed: Vec<&str> = both.filter(|((old, new), _)| old != new).map(|(_, name)| name).collect();
        let update = match self.has_near(sets, (color, channels), |_| true) {
            _ if changed.is_empty() => case::NONE_REPLACED,
            true => case::REPLACED_BY_BACKGROUND,
            false => case::REPLACED_BY_FOREGROUND,
        };
        let step = step.put(value::REPLACED_SETS, changed.join(" and "));
        Explanation { step, verdict, update: vec![update] }
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
        let table = Matrix::new("S", "samples before the update", entries).with_rows(names).with_columns(columns);
        Matrix { changed: Some(changed), ..table.with_role(Role::Predicted) }
    }
}
