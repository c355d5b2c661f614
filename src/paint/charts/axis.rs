//! Axes of plots: where ticks stand.

/// A range of values laid along a range of the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Values at the two ends.
    pub values: [f32; 2],
    /// Places of the two ends, in points; the first may be the larger.
    pub places: [f32; 2],
    /// Whether equal ratios of values are equally far apart; both ends are positive then.
    pub is_logarithmic: bool,
}

/// Values this small are none: no axis has ticks between them.
const NOTHING: f32 = 1e-30;

impl Axis {
    /// An axis with equal steps.
    pub fn new(values: [f32; 2], places: [f32; 2]) -> Self {
        Self { values, places, is_logarithmic: false }
    }

    /// Where `value` stands.
    pub fn place(&self, value: f32) -> f32 {
        let scaled = |value: f32| if self.is_logarithmic { value.max(f32::MIN_POSITIVE).ln() } else { value };
        let ([a, b], value) = (self.values.map(scaled), scaled(value));
        let [p, q] = self.places;
        if a == b { (p + q) / 2.0 } else { p + (value - a) / (b - a) * (q - p) }
    }

    /// What stands at `place`.
    pub fn value(&self, place: f32) -> f32 {
        let [a, b] = self.values;
        let [p, q] = self.places;
        let share = (place - p) / (q - p);
        match self.is_logarithmic {
            _ if p == q => a,
            true => a * (b / a).powf(share),
            false => a + share * (b - a),
        }
    }

    /// Round ticks at least `spacing` points apart and at least `smallest` in value.
    pub fn ticks(&self, spacing: f32, smallest: f32) -> Vec<f32> {
        ticks(self.low(), self.high(), self.step(spacing).max(smallest))
    }

    /// The same, but longer: it ends on ticks, so that it has two at least and seldom changes while values come in.
    #[must_use]
    pub fn rounded(self, spacing: f32) -> Self {
        let [low, high] = [self.low(), self.high()];
        let (span, size) = (high - low, low.abs().max(high.abs()));
        // A single value has some room on either side.
        let ends = match size {
            _ if span > 1e-6 * size && span > NOTHING => [low, high],
            size if size > NOTHING => [low - 0.1 * size, high + 0.1 * size],
            _ => [0.0, 1.0],
        };
        let step = nice(f64::from(Self { values: ends, ..self }.step(spacing))) as f32;
        let values = [(ends[0] / step).floor() * step, (ends[1] / step).ceil().max(1.0) * step];
        Self { values, ..self }
    }

    /// Ticks of displacements: multiples of a power of two, as search ranges are, at least `spacing` points apart.
    pub fn displacement_ticks(&self, spacing: f32) -> Vec<f32> {
        let least = self.step(spacing);
        let steps = (0..16).map(|i| (1u32 << i) as f32);
        let Some(step) = steps.into_iter().find(|step| *step >= least) else { return Vec::new() };
        let (first, last) = ((self.low() / step).ceil() as i32, (self.high() / step).floor() as i32);
        (first..=last).map(|i| i as f32 * step).collect()
    }

    fn low(&self) -> f32 {
        self.values[0].min(self.values[1])
    }

    fn high(&self) -> f32 {
        self.values[0].max(self.values[1])
    }

    /// The step in value of ticks `spacing` points apart.
    fn step(&self, spacing: f32) -> f32 {
        let length = (self.places[1] - self.places[0]).abs();
        (self.high() - self.low()) / (length / spacing.max(1.0)).floor().max(1.0)
    }
}

/// Multiples of the smallest of 1, 2, 5 × 10ⁿ that is at least `step`, from `low` to `high`.
pub fn ticks(low: f32, high: f32, step: f32) -> Vec<f32> {
    if !(low.is_finite() && high.is_finite() && step.is_finite() && step > 0.0 && low <= high) {
        return Vec::new();
    }
    let step = nice(f64::from(step));
    let slack = 1e-4;
    let first = (f64::from(low) / step - slack).ceil() as i64;
    let last = (f64::from(high) / step + slack).floor() as i64;
    (first..=last).take(1000).map(|i| (i as f64 * step) as f32).collect()
}

/// The smallest of 1, 2, 5 × 10ⁿ that is at least `step`.
fn nice(step: f64) -> f64 {
    let decade = 10f64.powf(step.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|m| m * decade);
    steps.into_iter().find(|&s| s >= step * (1.0 - 1e-6)).unwrap_or(10.0 * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_value_has_an_axis_around_it() {
        for value in [0.0, 5.0, -3.0, 2e6, 1e-6] {
            let axis = Axis::new([value; 2], [300.0, 20.0]).rounded(36.0);
            let [low, high] = axis.values;
            assert!(
                low.is_finite() && high.is_finite() && low <= value && value <= high && low < high,
                "{value}: {axis:?}"
            );
            assert!(axis.place(value).is_finite() && !axis.ticks(36.0, 0.0).is_empty(), "{value}: {axis:?}");
        }
        assert_eq!(Axis::new([0.0, f32::MIN_POSITIVE], [300.0, 20.0]).rounded(36.0).values, [0.0, 1.0]);
    }

    #[test]
    fn places_and_values_are_inverse() {
        let down = Axis::new([0.0, 900.0], [300.0, 20.0]);
        assert_eq!(down.place(0.0), 300.0);
        assert_eq!(down.place(900.0), 20.0);
        assert!((down.value(down.place(512.0)) - 512.0).abs() < 1e-3);
        assert_eq!(Axis::new([3.0, 3.0], [0.0, 10.0]).place(3.0), 5.0);
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-16.0, 16.0, 7.0), [-10.0, 0.0, 10.0]);
        assert_eq!(ticks(-16.0, 16.0, 5.0), [-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0]);
        assert_eq!(ticks(0.0, 1.0, 0.2), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert!(ticks(0.0, f32::NAN, 1.0).is_empty() && ticks(0.0, 1.0, 0.0).is_empty());
        assert!(ticks(0.0, 1e30, 1e-30).len() <= 1000);
    }

    #[test]
    fn ticks_keep_their_distance() {
        for high in [7.0, 33.0, 812.0, 65_025.0, 1.6e7] {
            let axis = Axis::new([0.0, high], [0.0, 240.0]);
            let ticks = axis.ticks(40.0, 1.0);
            assert!(!ticks.is_empty());
            assert!(ticks.windows(2).all(|w| axis.place(w[1]) - axis.place(w[0]) >= 39.9), "{high}: {ticks:?}");
        }
    }

    #[test]
    fn even_a_short_axis_has_two_ticks() {
        for length in [20.0, 50.0, 90.0, 300.0] {
            for high in [0.4, 1.0, 7.0, 410.0, 1300.0, 76_799.0] {
                let axis = Axis::new([0.0, high], [length, 0.0]).rounded(36.0);
                let ticks = axis.ticks(36.0, 0.0);
                assert!(ticks.len() >= 2 && ticks.last() >= Some(&(high * 0.999)), "{high} on {length}: {ticks:?}");
            }
        }
    }

    #[test]
    fn displacements_are_ticked_by_powers_of_two() {
        let axis = |side: f32, length: f32| Axis::new([-side, side], [0.0, length]);
        assert_eq!(axis(16.0, 160.0).displacement_ticks(50.0), [-16.0, 0.0, 16.0]);
        assert_eq!(axis(16.0, 260.0).displacement_ticks(50.0), [-16.0, -8.0, 0.0, 8.0, 16.0]);
        assert_eq!(axis(10.0, 160.0).displacement_ticks(50.0), [-8.0, 0.0, 8.0]);
        assert_eq!(axis(1.0, 900.0).displacement_ticks(50.0), [-1.0, 0.0, 1.0]);
        assert!(axis(f32::NAN, 100.0).displacement_ticks(50.0).is_empty());
    }
}
