//! Everything that an estimator says: its steps, its parameters, its declaration.

use std::collections::BTreeMap;

use motionscope_core::params::{Kind, Spec};
use motionscope_core::scene::{Readout, Scene, Shape};
use motionscope_core::{AnyEstimator, Step};

/// Texts by where they stand (`sentence`, `fact`, `parameter`), each once: without its numbers, and as it was first seen.
#[derive(Default)]
pub struct Texts(BTreeMap<&'static str, BTreeMap<String, String>>);

impl Texts {
    /// Adds a text that stands at `place`.
    pub fn add(&mut self, place: &'static str, text: &str) {
        if !text.is_empty() {
            self.0.entry(place).or_default().entry(stripped(text)).or_insert_with(|| text.to_owned());
        }
    }

    /// Each text with its place.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.0.iter().flat_map(|(place, texts)| texts.values().map(move |text| (*place, text.as_str())))
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
        step.readouts.iter().for_each(|readout| self.add_readout(readout));
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
            Readout::Surface(surface) => self.add("plot", surface.title),
            Readout::Plane(plane) => {
                self.add("plot", plane.title);
                plane.points.iter().for_each(|(name, ..)| self.add("plot", name));
            }
            Readout::Histogram(histogram) => self.add("plot", histogram.of),
            Readout::Distribution(distribution) => {
                self.add("plot", &format!("{} [{}]", distribution.title, distribution.unit));
                distribution.figures.iter().for_each(|(name, _)| self.add("plot", name));
            }
            Readout::Stack(_) => {}
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
