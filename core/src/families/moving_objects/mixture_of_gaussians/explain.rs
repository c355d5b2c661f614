//! The classification of a pixel by its modes, in words and numbers.

use super::{Mixture, MixtureOfGaussians, Mode};
use crate::base::words;
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::numbers::{gray, level, percent, ratio};
use crate::methods::subtraction::{Explanation, ShadowLimits, is_shadow};
use crate::scene::{Fact, Math, Matrix, Role, Sentence};

/// The classification of a pixel by its modes.
struct Verdict {
    /// The number of background modes, which come first.
    background: usize,
    /// The index of the matched mode.
    matched: Option<usize>,
    /// The background mode that the pixel is a shadow on, and its brightness as a share of that mode's.
    shadow: Option<(usize, f32)>,
}

impl Verdict {
    fn is_foreground(&self) -> bool {
        self.matched.is_none_or(|mode| mode >= self.background)
    }
}

impl MixtureOfGaussians {
    /// Returns the number of background modes, which come first.
    pub(super) fn background_modes(&self, modes: &[Mode]) -> usize {
        let mut heavier = 0.0;
        let is_background = |mode: &&Mode| {
            let is_one = heavier < self.background_ratio;
            heavier += mode.weight;
            is_one
        };
        modes.iter().take_while(is_background).count()
    }

    fn verdict(&self, modes: &[Mode], pixel: &[f32]) -> Verdict {
        let background = self.background_modes(modes);
        let limit = |mode: &Mode| self.threshold * self.threshold * mode.variance;
        let matched = modes.iter().position(|mode| {
            let square: f32 = pixel.iter().zip(&mode.mean).map(|(pixel, mean)| (pixel - mean) * (pixel - mean)).sum();
            square <= limit(mode)
        });
        let shadow = modes[..background].iter().enumerate().find_map(|(index, mode)| {
            let ([_, _, _], [_, _, _]) = (pixel, &mode.mean[..]) else { return None };
            let [pixel, mean] = [pixel, &mode.mean].map(|of| [of[0], of[1], of[2]]);
            let [along, square] = [pixel, mean].map(|of| (0..3).map(|c| of[c] * mean[c]).sum::<f32>());
            (self.shadow.detect_shadows
                && is_shadow(pixel, mean, ShadowLimits { darkest: self.shadow.shadow_threshold, limit: limit(mode) }))
            .then_some((index, along / square))
        });
        Verdict { background, matched, shadow }
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
            update: after.map_or_else(Sentence::default, |after| {
                self.update(verdict.matched.map(|mode| (mode, &modes[mode])), &pixel, &after.modes(place))
            }),
        }
    }

    fn facts(&self, modes: &[Mode], pixel: &[f32], verdict: &Verdict) -> Vec<Fact> {
        let role = if verdict.is_foreground() { Role::Result } else { Role::Rejected };
        let mut facts = vec![
            Fact::new(if pixel.len() == 1 { "Gray level" } else { "Colour" }, levels(pixel), Some(Role::Measured)),
            Fact::new("Modes", modes.len().to_string(), None),
            Fact::new("Background modes", verdict.background.to_string(), Some(Role::Predicted)),
            Fact::new("Matched mode", verdict.matched.map_or("none".into(), |mode| (mode + 1).to_string()), Some(role)),
        ];
        facts.extend(
            verdict
                .matched
                .map(|mode| Fact::new("Distance", format!("{} σ", gray(modes[mode].distance(pixel))), Some(role))),
        );
        facts.push(Fact::new("Threshold", format!("{} σ", gray(self.threshold)), None));
        facts
    }

    /// The distance of the pixel from the matched mode, or from the heaviest.
    fn equation(&self, modes: &[Mode], pixel: &[f32], verdict: &Verdict) -> Vec<Math> {
        let Some(mode) = modes.get(verdict.matched.unwrap_or(0)) else { return Vec::new() };
        let size = |inner: Vec<Math>| Math::Abs(Box::new(Math::Row(inner)));
        let index = (verdict.matched.unwrap_or(0) + 1).to_string();
        let of = |name| Math::indexed(Math::Var(name), Math::text(index.clone()));
        let symbols = Math::Frac(Box::new(size(vec![Math::Var("I"), Math::text(" − "), of("μ")])), Box::new(of("σ")));
        let numbers = Math::Frac(
            Box::new(size(vec![
                Math::ink(Role::Measured, levels(pixel)),
                Math::text(" − "),
                Math::ink(Role::Predicted, values(&mode.mean)),
            ])),
            Box::new(Math::ink(Role::Predicted, gray(mode.variance.sqrt()))),
        );
        let (sign, role) = if verdict.matched.is_some() { (" ≤ ", Role::Rejected) } else { (" > ", Role::Result) };
        vec![
            Math::Row(vec![symbols, Math::text(" ≤ "), Math::Var("T")]),
            Math::Row(vec![
                numbers,
                Math::text(" = "),
                Math::ink(role, gray(mode.distance(pixel))),
                Math::text(format!("{sign}{}", gray(self.threshold))),
            ]),
        ]
    }

    fn sentence(&self, modes: &[Mode], pixel: &[f32], verdict: &Verdict) -> Sentence {
        let name = if pixel.len() == 1 { "gray level" } else { "colour" };
        let said = Sentence::default().text(format!(": {name} ")).ink(Role::Measured, levels(pixel));
        let limit = gray(self.threshold);
        let said = match verdict.matched {
            None => {
                let nearest = modes.iter().map(|mode| mode.distance(pixel)).fold(f32::INFINITY, f32::min);
                said.text(format!(
                    " matches no mode: the nearest is {} σ away, the threshold {limit} σ. ",
                    gray(nearest)
                ))
            }
            Some(mode) => {
                let (weight, share) = (f64::from(modes[mode].weight), words::percent(self.background_ratio));
                said.text(" matches ").ink(Role::Predicted, format!("mode {}", mode + 1)).text(format!(
                    " of weight {}, {} the {share} of the background: ",
                    ratio(weight),
                    if mode < verdict.background { "within" } else { "outside" }
                ))
            }
        };
        let (background, foreground) = match verdict.matched {
            None => ("Background", "Foreground"),
            Some(_) => ("background", "foreground"),
        };
        match (verdict.is_foreground(), verdict.shadow) {
            (false, _) => said.ink(Role::Rejected, background).text("."),
            (true, None) => said.ink(Role::Result, foreground).text("."),
            (true, Some((mode, light))) => said.ink(Role::Result, foreground).text(format!(
                ". It has the colour of background mode {} at {} of its brightness, above the shadow threshold {}.",
                mode + 1,
                percent(light.into()),
                words::percent(self.shadow.shadow_threshold)
            )),
        }
    }

    /// The update of the matched mode with its numbers, or the new mode.
    fn update(&self, matched: Option<(usize, &Mode)>, pixel: &[f32], after: &[Mode]) -> Sentence {
        let said = Sentence::default();
        let alpha = ratio(self.learning_rate.into());
        let nearest = |mean: &[f32]| {
            let off = |mode: &Mode| mode.mean.iter().zip(mean).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
            after.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
        };
        let Some((index, old)) = matched else {
            return match nearest(pixel) {
                Some(new) if self.learning_rate > 0.0 => said.text("no mode matches. ").ink(
                    Role::Estimate,
                    format!(
                        "A new mode starts with μ = {}, σ = {} and weight {}.",
                        levels(pixel),
                        gray(new.variance.sqrt()),
                        ratio(new.weight.into())
                    ),
                ),
                _ => said.text("no mode matches, and a learning rate of 0 adds none."),
            };
        };
        let weight = old.weight + self.learning_rate * (1.0 - old.weight - self.complexity_reduction);
        let step = if weight > 0.0 { self.learning_rate / weight } else { 0.0 };
        let moved: Vec<f32> = old.mean.iter().zip(pixel).map(|(mean, pixel)| mean + step * (pixel - mean)).collect();
        let Some(new) = nearest(&moved) else { return said };
        said.text(format!("mode {} is matched. With α = {alpha}, ", index + 1)).ink(
            Role::Estimate,
            format!(
                "{}, {} and {}.",
                goes("its weight", [old, new].map(|mode| ratio(mode.weight.into()))),
                goes("μ", [old, new].map(|mode| values(&mode.mean))),
                goes("σ", [old, new].map(|mode| gray(mode.variance.sqrt())))
            ),
        )
    }
}

/// The change of a quantity, unless it is too small for its decimals.
fn goes(name: &str, [from, to]: [String; 2]) -> String {
    if from == to { format!("{name} stays {to}") } else { format!("{name} goes from {from} to {to}") }
}

/// The mean of a mode as text.
fn values(of: &[f32]) -> String {
    tuple(of.iter().map(|value| gray(*value)).collect())
}

/// A pixel as text.
fn levels(of: &[f32]) -> String {
    tuple(of.iter().map(|value| level(*value)).collect())
}

fn tuple(numbers: Vec<String>) -> String {
    match &numbers[..] {
        [one] => one.clone(),
        // No-break spaces.
        all => format!("({})", all.join(",\u{a0}")),
    }
}

/// The modes of a pixel before the update, and after it once that is done.
fn matrices(modes: &[Mode], pixel: &[f32], after: Option<Vec<Mode>>) -> Vec<Matrix> {
    let before = table("M", "modes before the update", modes, pixel);
    let after = after.map(|after| {
        let table = table("M′", "modes after the update", &after, pixel);
        let same = |(x, y): (usize, usize)| before.entries.get(x, y) == Some(&table.entries[(x, y)]);
        let changed = Grid::from_fn(table.entries.width(), table.entries.height(), |x, y| !same((x, y)));
        Matrix { role: Some(Role::Estimate), changed: Some(changed), ..table }
    });
    [before].into_iter().chain(after).collect()
}

/// The table of modes, one row each.
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
    Matrix { symbol, name, role: Some(Role::Predicted), entries, rows, columns, changed: None, decimals: None }
}

#[cfg(test)]
mod tests {
    use super::goes;

    #[test]
    fn what_does_not_change_stays() {
        let told = |pair: [&str; 2]| goes("σ", pair.map(str::to_owned));
        assert_eq!([told(["2.00", "2.00"]), told(["2.00", "2.01"])], ["σ stays 2.00", "σ goes from 2.00 to 2.01"]);
    }
}
