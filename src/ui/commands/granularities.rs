//! The granularities of the ladder, by the estimator's own names.

/// The three granularities of the ladder that have keys, by the estimator's own names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Granularities {
    names: &'static [&'static str],
}

impl Granularities {
    /// The granularities of an estimator, outermost first.
    pub fn new(names: &'static [&'static str]) -> Self {
        Self { names }
    }

    /// Their names, the outermost first.
    pub fn names(self) -> &'static [&'static str] {
        self.names
    }

    /// Index of the granularity that one steps into: an event.
    pub fn event(self) -> usize {
        self.names.len().saturating_sub(1)
    }

    /// Index of the granularity that one steps over: a unit.
    pub fn unit(self) -> usize {
        self.names.len().saturating_sub(2)
    }

    /// Index of the granularity that one steps out of.
    pub fn group(self) -> usize {
        self.names.len().saturating_sub(3)
    }

    /// The name of a granularity.
    pub fn name(self, index: usize) -> &'static str {
        self.names.get(index).copied().unwrap_or("step")
    }

    /// The name of the granularity that one steps out of; the outermost one is the whole run.
    pub fn outer(self) -> &'static str {
        if self.group() == 0 { "run" } else { self.name(self.group()) }
    }

    /// `text` with the names put in for `{into}`, `{over}` and `{out}`.
    pub fn fill(self, text: &str) -> String {
        text.replace("{into}", self.name(self.event()))
            .replace("{over}", self.name(self.unit()))
            .replace("{out}", self.outer())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_ladders_have_all_three_steps() {
        let two = Granularities::new(&["frame", "pixel"]);
        assert_eq!((two.event(), two.unit(), two.group()), (1, 0, 0));
    }
}
