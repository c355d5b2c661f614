//! Everything that an estimator says: its steps, its parameters, its declaration.

use std::collections::{BTreeMap, BTreeSet};

use motionscope_core::params::{Kind, Spec};
use motionscope_core::run::AnyEstimator;
use motionscope_core::scene::{Readout, Scene, Shape, Step, Value};

/// Texts by where they stand (`sentence`, `fact`, `parameter`), each once: without its numbers.
#[derive(Default)]
pub struct Texts(BTreeMap<&'static str, BTreeMap<String, Seen>>);

/// A text as it was seen.
#[derive(Default)]
struct Seen {
    /// As it was seen first.
    first: String,
    /// How many decimals each of its numbers had at any time, from left to right.
    decimals: Vec<BTreeSet<usize>>,
}

impl Texts {
    /// Adds a text that stands at `place`.
    pub fn add(&mut self, place: &'static str, text: &str) {
        if !text.is_empty() {
            let seen = self.0.entry(place).or_default().entry(stripped(text)).or_default();
            if seen.first.is_empty() {
                seen.first = text.to_owned();
            }
            // An equation shows quantities of many kinds in one form.
            let decimals = if place == "equation" { Vec::new() } else { decimals(text) };
            for (i, decimals) in decimals.into_iter().enumerate() {
                if seen.decimals.len() <= i {
                    seen.decimals.push(BTreeSet::new());
                }
                seen.decimals[i].insert(decimals);
            }
        }
    }

    /// Each text with its place.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.0.iter().flat_map(|(place, texts)| texts.values().map(move |text| (*place, text.first.as_str())))
    }

    /// Texts of which one number has different decimals at different times. Whole numbers may stand without any.
    pub fn with_changing_decimals(&self) -> impl Iterator<Item = &str> {
        let changes = |seen: &&Seen| seen.decimals.iter().any(|of| of.iter().filter(|count| **count > 0).count() > 1);
        self.0.values().flat_map(BTreeMap::values).filter(changes).map(|seen| seen.first.as_str())
    }

    /// Adds what an estimator says before it runs.
    pub fn add_estimator(&mut self, estimator: &dyn AnyEstimator) {
        let info = estimator.info();
        self.add("name", info.name);
        self.add("summary", info.summary);
        info.granularities.iter().for_each(|name| self.add("granularity", name));
        info.pseudocode.iter().for_each(|line| self.add("pseudocode", line.text));
        estimator.specs().iter().for_each(|spec| self.add_parameter(spec));
    }

    fn add_parameter(&mut self, spec: &Spec) {
        let unit = if spec.unit.is_empty() { String::new() } else { format!(" [{}]", spec.unit) };
        self.add("parameter", &format!("{}{unit}: {}", spec.label, spec.doc));
        self.add_choices(&spec.kind);
    }

    fn add_choices(&mut self, kind: &Kind) {
        match kind {
            Kind::Choice(all) => {
                all.iter().for_each(|choice| self.add("choice", &format!("{}: {}", choice.label, choice.doc)));
            }
            Kind::Optional { of, .. } => self.add_choices(of),
            _ => {}
        }
    }

    /// Adds what a step says.
    pub fn add_step(&mut self, step: &Step) {
        self.add("sentence", &step.sentence.plain());
        step.values.iter().for_each(|value| self.add_value(value));
        step.readouts.iter().for_each(|readout| self.add_readout(readout));
    }

    fn add_value(&mut self, value: &Value) {
        self.add("definition", value.of.definition.trim());
        if !value.of.label.is_empty() {
            self.add("fact", value.of.label);
        }
    }

    fn add_readout(&mut self, readout: &Readout) {
        match readout {
            Readout::Facts(facts) => {
                facts.iter().for_each(|fact| self.add("fact", &format!("{}: {}", fact.label, fact.value)))
            }
            Readout::Equation(lines) => lines.iter().for_each(|line| self.add("equation", &line.plain())),
            Readout::Tiles(tiles) => tiles.iter().for_each(|tile| self.add("tile", tile.label)),
            Readout::Series(series) => {
                self.add("plot", &format!("{} ({} over {})", series.title, series.y_label, series.x_label));
                series.lines.iter().for_each(|(name, ..)| self.add("plot", name));
                series.sections.iter().for_each(|section| self.add("plot", &section.label));
                series.bands.iter().for_each(|band| self.add("plot", &band.name));
                series.thresholds.iter().for_each(|(name, _)| self.add("plot", name));
            }
            Readout::Surface(surface) | Readout::Landscape(surface) => {
                self.add("plot", surface.title);
                surface.named.iter().for_each(|(name, ..)| self.add("plot", name));
            }
            Readout::Plane(plane) => {
                self.add("plot", plane.title);
                plane.points.iter().for_each(|(name, ..)| self.add("plot", name));
            }
            Readout::Regions(regions) => {
                self.add("plot", regions.title);
                regions.names.iter().for_each(|(name, _)| self.add("plot", name));
                regions.boundaries.iter().for_each(|(name, ..)| self.add("plot", name));
            }
            Readout::Diagram(diagram) => {
                self.add("plot", diagram.title);
                self.add("plot", &diagram.summary);
                diagram.words.iter().for_each(|words| self.add("plot", &words.text));
            }
            Readout::Histogram(histogram) => self.add("plot", histogram.of),
            Readout::Distribution(distribution) => {
                self.add("plot", &format!("{} [{}]", distribution.title, distribution.unit));
                distribution.figures.iter().for_each(|(name, _)| self.add("plot", name));
            }
            Readout::Stack(_) => {}
            Readout::Cloud(cloud) => {
                self.add("plot", cloud.title);
                cloud.legend.iter().for_each(|(_, meaning)| self.add("legend", meaning));
            }
            Readout::Matrices(all) => {
                all.iter().for_each(|matrix| self.add("matrix", &format!("{}: {}", matrix.symbol, matrix.name)))
            }
        }
    }

    /// Adds what stands on a scene.
    pub fn add_scene(&mut self, scene: &Scene) {
        scene.legend.iter().for_each(|(_, meaning)| self.add("legend", meaning));
        if let Some(heat) = scene.heat {
            self.add("legend", heat);
        }
        for mark in &scene.marks {
            if let Shape::Text { text, .. } = &mark.shape {
                self.add("mark", text);
            }
        }
    }
}

/// How many decimals each number of a text has, from left to right; those of percentages are given by a person, and count as
/// none.
pub fn decimals(text: &str) -> Vec<usize> {
    let mut all = Vec::new();
    let letters: Vec<char> = text.chars().collect();
    let is_digit = |i: usize| letters.get(i).is_some_and(char::is_ascii_digit);
    let mut i = 0;
    while i < letters.len() {
        if !is_digit(i) {
            i += 1;
            continue;
        }
        while is_digit(i) || ",\u{2009}\u{202f}".contains(*letters.get(i).unwrap_or(&'x')) && is_digit(i + 1) {
            i += 1;
        }
        let mut count = 0;
        if letters.get(i) == Some(&'.') && is_digit(i + 1) {
            i += 1;
            while is_digit(i) {
                (i, count) = (i + 1, count + 1);
            }
        }
        let is_percentage =
            letters[i..].iter().collect::<String>().trim_start_matches(['\u{a0}', ' ']).starts_with('%');
        all.push(if is_percentage { 0 } else { count });
    }
    all
}

#[test]
fn decimals_are_counted() {
    assert_eq!(decimals("At (−3.5, 2) px: 12\u{202f}345.25 of 5, 99.9 %."), [1, 0, 2, 0, 0]);
}

/// A sentence without its numbers.
pub fn stripped(sentence: &str) -> String {
    let mut words = String::new();
    let mut letters = sentence.chars().peekable();
    while let Some(c) = letters.next() {
        let mut is_within = || words.ends_with('#') && letters.peek().is_some_and(char::is_ascii_digit);
        let is_number = c.is_ascii_digit() || (".,\u{2009}\u{202f}".contains(c) && is_within());
        match is_number {
            true if words.ends_with('#') => {}
            true => {
                if words.ends_with(['−', '±', '+']) {
                    words.pop();
                }
                words.push('#');
            }
            false => words.push(c),
        }
    }
    words
}

#[test]
fn numbers_are_stripped_from_a_sentence() {
    let said = "At (−3.5, 2) px: 1\u{2009}234 of 5, ±0.25.";
    assert_eq!(stripped(said), "At (#, #) px: # of #, #.");
}
