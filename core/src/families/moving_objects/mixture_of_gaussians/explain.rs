//! How a pixel is decided by its modes.

use super::model::is_darker;
use super::{Mixture, MixtureOfGaussians, Mode};
use crate::base::words;
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::subtraction::Explanation;
use crate::scene::{Fact, Math, Matrix, Role, Sentence};

/// What the modes of a pixel say about it.
struct Verdict {
    /// Those of the background are the first so many.
    background: usize,
    /// The one that fits.
    fits: Option<usize>,
    /// The mode of the background of which the pixel is a shadow, and the share of light.
    shadow: Option<(usize, f32)>,
}

impl Verdict {
    fn is_foreground(&self) -> bool {
        self.fits.is_none_or(|mode| mode >= self.background)
    }
}

impl MixtureOfGaussians {
    fn verdict(&self, modes: &[Mode], pixel: &[f32]) -> Verdict {
        let mut heavier = 0.0;
        let is_background = |mode: &&Mode| {
            let is_one = heavier < self.background;
            heavier += mode.weight;
            is_one
        };
        let background = modes.iter().take_while(is_background).count();
        let limit = |mode: &Mode| self.threshold * self.threshold * mode.variance;
        let fits = modes.iter().position(|mode| {
            let square: f32 = pixel.iter().zip(&mode.mean).map(|(pixel, mean)| (pixel - mean) * (pixel - mean)).sum();
            square <= limit(mode)
        });
        let shadow = modes[..background].iter().enumerate().find_map(|(index, mode)| {
            let ([_, _, _], [_, _, _]) = (pixel, &mode.mean[..]) else { return None };
            let [pixel, mean] = [pixel, &mode.mean].map(|of| [of[0], of[1], of[2]]);
            let [along, square] = [pixel, mean].map(|of| (0..3).map(|c| of[c] * mean[c]).sum::<f32>());
            (self.shadows && is_darker(pixel, mean, (self.darkest, limit(mode)))).then_some((index, along / square))
        });
        Verdict { background, fits, shadow }
    }

    pub(super) fn explanation(
        &self,
        [before, after]: [Option<&Mixture>; 2],
        frame: &Frame,
        place: (usize, usize),
    ) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let (pixel, modes) = (before.pixel(frame, place), before.modes(place));
        let verdict = self.verdict(&modes, &pixel);
        Explanation {
            facts: self.facts(&modes, &pixel, &verdict),
            equation: self.equation(&modes, &pixel, &verdict),
            matrices: matrices(&modes, &pixel, after.map(|after| after.modes(place))),
            verdict: self.sentence(&modes, &pixel, &verdict),
        }
    }

    fn facts(&self, modes: &[Mode], pixel: &[f32], verdict: &Verdict) -> Vec<Fact> {
        let role = if verdict.is_foreground() { Role::Result } else { Role::Rejected };
        let mut facts = vec![
            Fact::new(if pixel.len() == 1 { "Gray" } else { "Colour" }, values(pixel), Some(Role::Measured)),
            Fact::new("Modes", modes.len().to_string(), None),
            Fact::new("Of the background", format!("the first {}", verdict.background), Some(Role::Predicted)),
            Fact::new("Fits", verdict.fits.map_or("none".into(), |mode| format!("mode {}", mode + 1)), Some(role)),
        ];
        facts.extend(verdict.fits.map(|mode| {
            Fact::new("Distance", format!("{} σ", words::number(modes[mode].distance(pixel))), Some(role))
        }));
        facts.push(Fact::new("Threshold", format!("{} σ", words::number(self.threshold)), None));
        facts
    }

    /// How far the pixel is from the mode that fits, or from the heaviest.
    fn equation(&self, modes: &[Mode], pixel: &[f32], verdict: &Verdict) -> Vec<Math> {
        let Some(mode) = modes.get(verdict.fits.unwrap_or(0)) else { return Vec::new() };
        let size = |inner: Vec<Math>| Math::Abs(Box::new(Math::Row(inner)));
        let index = (verdict.fits.unwrap_or(0) + 1).to_string();
        let of = |name| Math::indexed(Math::Var(name), Math::text(index.clone()));
        let symbols = Math::Frac(Box::new(size(vec![Math::Var("I"), Math::text(" − "), of("μ")])), Box::new(of("σ")));
        let numbers = Math::Frac(
            Box::new(size(vec![
                Math::ink(Role::Measured, values(pixel)),
                Math::text(" − "),
                Math::ink(Role::Predicted, values(&mode.mean)),
            ])),
            Box::new(Math::ink(Role::Predicted, words::number(mode.variance.sqrt()))),
        );
        let (sign, role) = if verdict.fits.is_some() { (" ≤ ", Role::Rejected) } else { (" > ", Role::Result) };
        vec![
            Math::Row(vec![symbols, Math::text(" ≤ "), Math::Var("T")]),
            Math::Row(vec![
                numbers,
                Math::text(" = "),
                Math::ink(role, words::number(mode.distance(pixel))),
                Math::text(format!("{sign}{}", words::number(self.threshold))),
            ]),
        ]
    }

    fn sentence(&self, modes: &[Mode], pixel: &[f32], verdict: &Verdict) -> Sentence {
        let said = Sentence::default().text(" is ").ink(Role::Measured, values(pixel));
        let said = match verdict.fits {
            None => said.text(format!(
                " and fits {}: ",
                if modes.len() == 1 { "not its only mode" } else { "none of its modes" }
            )),
            Some(mode) => {
                let weight = words::number(100.0 * modes[mode].weight);
                said.text(" and fits ").ink(Role::Predicted, format!("mode {}", mode + 1)).text(
                    match mode < verdict.background {
                        true => format!(" with {weight} % of the weight, one of the background: "),
                        false => format!(" with only {weight} % of the weight, which is none of the background: "),
                    },
                )
            }
        };
        match (verdict.is_foreground(), verdict.shadow) {
            (false, _) => said.ink(Role::Rejected, "background").text("."),
            (true, None) => said.ink(Role::Result, "foreground").text("."),
            (true, Some((mode, light))) => said.ink(Role::Result, "foreground").text(format!(
                ". But mode {} with {} % of its light would look like that.",
                mode + 1,
                words::number(100.0 * light)
            )),
        }
    }
}

fn values(of: &[f32]) -> String {
    let numbers: Vec<_> = of.iter().map(|value| words::number(*value)).collect();
    match &numbers[..] {
        [one] => one.clone(),
        // Spaces at which no line is broken.
        all => format!("({})", all.join(",\u{a0}")),
    }
}

/// The modes of a pixel, and what has become of them once that is known.
fn matrices(modes: &[Mode], pixel: &[f32], after: Option<Vec<Mode>>) -> Vec<Matrix> {
    let before = table("M", "modes before this frame", modes, pixel);
    let after = after.map(|after| {
        let table = table("M'", "modes after it", &after, pixel);
        let same = |(x, y): (usize, usize)| before.entries.get(x, y) == Some(&table.entries[(x, y)]);
        let changed = Grid::from_fn(table.entries.width(), table.entries.height(), |x, y| !same((x, y)));
        Matrix { role: Some(Role::Estimate), changed: Some(changed), ..table }
    });
    [before].into_iter().chain(after).collect()
}

/// A row for each mode.
fn table(symbol: &'static str, name: &'static str, modes: &[Mode], pixel: &[f32]) -> Matrix {
    let columns = match pixel {
        [_] => vec!["w", "μ", "σ", "|I − μ| / σ"],
        _ => vec!["w", "R", "G", "B", "σ", "|I − μ| / σ"],
    };
    let entries = Grid::from_fn(columns.len(), modes.len(), |x, y| {
        let mode = &modes[y];
        f64::from(match x.checked_sub(1) {
            None => mode.weight,
            Some(channel) if channel < pixel.len() => mode.mean[channel],
            Some(channel) if channel == pixel.len() => mode.variance.sqrt(),
            Some(_) => mode.distance(pixel),
        })
    });
    let rows = (1..=modes.len()).map(|number| number.to_string()).collect();
    let columns = columns.into_iter().map(String::from).collect();
    Matrix { symbol, name, role: Some(Role::Predicted), entries, rows, columns, changed: None }
}
