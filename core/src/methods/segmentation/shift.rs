//! Mean-shift clustering: the modes of the density of the points.

use super::points::{Place, Points, squared_distance};
use crate::base::effort;

/// Points whose density is estimated at most.
const SAMPLES: usize = 2000;
/// Starts of the ascent at most.
const STARTS: usize = 64;
/// Share of the sample that a mode needs within its bandwidth; a mode with fewer lies between motions.
pub const LEAST_SHARE: f64 = 0.02;
/// Squared length of a shift, in squared units of the points, below which it has converged.
const CONVERGED: f32 = 1e-8;

/// A maximum of the density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Its place.
    pub place: Place,
    /// Number of points of the sample within the bandwidth.
    pub support: usize,
}

/// The sample of the points, and the places from which the ascents start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Density {
    sample: Points,
    /// The starts.
    pub starts: Vec<Place>,
}

impl Density {
    /// Samples `points`.
    pub fn new(points: &Points) -> Self {
        let sample = points.sampled(SAMPLES).0;
        let starts = points.sampled(STARTS).0;
        Self { sample, starts: (0..starts.len()).map(|i| starts.at(i)).collect() }
    }

    /// Number of points in the sample.
    pub fn len(&self) -> usize {
        self.sample.len()
    }

    /// One shift: the mean of the points within `bandwidth` (K. Fukunaga and L. Hostetler 1975), and their number.
    pub fn shifted(&self, at: &Place, bandwidth: f32) -> Mode {
        effort::add(self.sample.len());
        let (mut sum, mut support) = ([0.0f64; 6], 0usize);
        for place in (0..self.sample.len()).map(|i| self.sample.at(i)) {
            if squared_distance(&place, at) <= bandwidth * bandwidth {
                sum.iter_mut().zip(place).for_each(|(sum, c)| *sum += f64::from(c));
                support += 1;
            }
        }
        if support == 0 {
            return Mode { place: *at, support };
        }
        Mode { place: sum.map(|sum| (sum / support as f64) as f32), support }
    }

    /// Size in memory in bytes.
    pub fn bytes(&self) -> usize {
        self.sample.bytes() + size_of_val(&self.starts[..])
    }
}

/// Whether a shift between two places has converged.
pub fn has_converged(from: &Place, to: &Place) -> bool {
    squared_distance(from, to) <= CONVERGED
}

/// Adds a mode to those known; one within `bandwidth` of another is the same, and the denser of both stays. Returns its index and whether it is new.
pub fn merge(modes: &mut Vec<Mode>, found: Mode, bandwidth: f32) -> (usize, bool) {
    let near = modes.iter().position(|mode| squared_distance(&mode.place, &found.place) <= bandwidth * bandwidth);
    match near {
        Some(index) => {
            if found.support > modes[index].support {
                modes[index] = found;
            }
            (index, false)
        }
        None => {
            modes.push(found);
            (modes.len() - 1, true)
        }
    }
}

/// The modes with enough support, or the densest where none has.
pub fn supported(modes: &[Mode], samples: usize) -> Vec<Place> {
    let least = LEAST_SHARE * samples as f64;
    let most = modes.iter().map(|mode| mode.support).max().unwrap_or(0);
    let keeps = |mode: &&Mode| mode.support as f64 >= least || mode.support == most;
    modes.iter().filter(keeps).map(|mode| mode.place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ascents_lead_to_the_centres_of_the_groups() {
        let near = |i: usize, k: usize| ((i * k) % 23) as f32 / 23.0 - 11.0 / 23.0;
        let center = |i: usize| if i.is_multiple_of(4) { [5.0, 1.0] } else { [0.0, 0.0] };
        let value = |d: usize, k: usize| (0..1840).map(|i| center(i)[d] + near(i / 4, k)).collect();
        let density = Density::new(&Points::new(vec![value(0, 5), value(1, 9)]));
        let mut modes = Vec::new();
        for start in &density.starts {
            let mut at = *start;
            let mode = loop {
                let next = density.shifted(&at, 1.0);
                if has_converged(&at, &next.place) {
                    break next;
                }
                at = next.place;
            };
            merge(&mut modes, mode, 1.0);
        }
        let places = supported(&modes, density.len());
        assert_eq!(places.len(), 2, "{modes:?}");
        for truth in [[0.0, 0.0], [5.0, 1.0]] {
            let off = |place: &Place| (place[0] - truth[0]).hypot(place[1] - truth[1]);
            assert!(places.iter().any(|place| off(place) < 0.1), "{places:?}");
        }
    }

    #[test]
    fn a_mode_of_few_points_is_left_out_unless_it_is_all_there_is() {
        let mode = |x: f32, support| Mode { place: [x, 0.0, 0.0, 0.0, 0.0, 0.0], support };
        assert_eq!(supported(&[mode(1.0, 500), mode(9.0, 19)], 1000).len(), 1);
        assert_eq!(supported(&[mode(1.0, 3)], 1000).len(), 1);
        let mut modes = vec![mode(1.0, 10)];
        assert_eq!(merge(&mut modes, mode(1.5, 20), 1.0), (0, false));
        assert_eq!(modes, [mode(1.5, 20)]);
        assert_eq!(merge(&mut modes, mode(4.0, 5), 1.0), (1, true));
    }
}
