//! The formulas of costs that need the whole block: means, transform coefficients, moments.

use super::Cost;
use super::probe::Probe;
use super::vocabulary::value;
use crate::geometry::Grid;
use crate::methods::cost::{Cut, whole};
use crate::scene::{Number, Step};

/// The difference of a pixel of the block from the mean of the block.
const OFF_MEAN: &str = r"(I_t(x, y) - \bar{I_t})";

impl Probe<'_> {
    /// Adds the formula of the cost, and with the numbers of block `a` and candidate `b`; `next` is the pixel of the candidate.
    pub(super) fn whole_equation(&self, step: Step, next: &str, a: &Cut, b: &Cut) -> Step {
        let (pixels, stride) = b.rows();
        let off_mean = format!(r"({next} - \bar{{I_{{t+1}}}})");
        let named = |formula: String| format!("{{label}}({{u}}, {{v}}) = {formula}");
        let step = match self.settings.matching.cost {
            Cost::Satd => {
                let coefficients = whole::coefficients(a, pixels, stride, (0, 0))[0].into_iter().collect::<Number>();
                step.put(value::COEFFICIENTS, coefficients)
                    .formula(named(r"\frac{1}{2}\, \sum_{\text{4×4}} \sum_{i, j} |(HDH)_{i, j}|".into()))
                    .formula(r"= \frac{1}{2} \cdot ({coefficients:sum} + \ldots)")
            }
            Cost::Ncc => {
                let count = (self.block().width * self.block().height) as f64;
                let [own, others, both] = whole::moments(a, pixels, stride).map(|moment| moment as f64 / count);
                let above = format!(r"\sum_{{x, y}} {OFF_MEAN} \cdot {off_mean}");
                let below = format!(r"\sum_{{x, y}} {OFF_MEAN}^2 \cdot \sum_{{x, y}} {off_mean}^2");
                step.put(value::BLOCK_VARIANCE, own)
                    .put_value(value::CANDIDATE_VARIANCE.is(others).inked(self.shown_role()))
                    .put(value::COVARIANCE, both)
                    .formula(named(format!(r"1 - \frac{{{above}}}{{\sqrt{{{below}}}}}")))
                    .formula(r"= 1 - \frac{{covariance}}{\sqrt{{block_variance} \cdot {candidate_variance}}}")
            }
            _ => {
                let [own, others] = self.means(a, b);
                let (first, last) = (off_means("first"), off_means("last"));
                self.pairs(step, self.block().width * self.block().height, |i| self.pixels(a, b, i))
                    .put(value::BLOCK_MEAN, own)
                    .put(value::CANDIDATE_MEAN, others)
                    .formula(named(format!(r"\sum_{{x, y}} |{OFF_MEAN} - {off_mean}|")))
                    .formula(format!(r"= {first} + \ldots + {last}"))
            }
        };
        step.formula(r"= {distortion}")
    }

    fn means(&self, a: &Cut, b: &Cut) -> [f64; 2] {
        let count = self.block().width * self.block().height;
        [0, 1].map(|of| (0..count).map(|i| f64::from(self.pixels(a, b, i)[of])).sum::<f64>() / count as f64)
    }

    /// The contribution of each pixel to the cost, its name, and its largest possible value.
    pub(super) fn whole_tile(&self, a: &Cut, b: &Cut) -> (&'static str, Grid<f32>, f32) {
        let block = self.block();
        if self.settings.matching.cost == Cost::Satd {
            let (pixels, stride) = b.rows();
            let coefficient = |x: usize, y: usize| {
                let tile = whole::coefficients(a, pixels, stride, (x / 4 * 4, y / 4 * 4));
                tile[y % 4][x % 4] as f32 / 2.0
            };
            return ("|coefficient| / 2", Grid::from_fn(block.width, block.height, coefficient), 255.0 * 8.0);
        }
        let [mean_a, mean_b] = self.means(a, b);
        let off = |x, y| ((f64::from(a.pixel(x, y)) - mean_a) - (f64::from(b.pixel(x, y)) - mean_b)).abs() as f32;
        ("|zero-mean difference|", Grid::from_fn(block.width, block.height, off), 255.0)
    }
}

/// The difference of two pixels, each from the mean of its block.
fn off_means(place: &str) -> String {
    format!("|({{block_{place}}} - {{block_mean}}) - ({{candidate_{place}}} - {{candidate_mean}})|")
}
