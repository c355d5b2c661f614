//! The gray levels of a pixel over the last frames, and those that its model takes for background in the present one.

use super::{Background, Channel, State};
use crate::data::{Clip, Frame};
use crate::methods::numbers::ratio;
use crate::scene::{Band, Readout, Role, Series};

/// The gray levels that a model takes for background at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accepted {
    /// The weight of the mode; nothing for a model with a single one.
    pub weight: Option<f32>,
    /// The mean of the background.
    pub mean: f32,
    /// The largest difference from the mean that is background.
    pub reach: f32,
    /// The standard deviation, where the model has one.
    pub sigma: Option<f32>,
}

impl Accepted {
    /// A background of one gray level with a threshold.
    pub fn around(mean: f32, reach: f32) -> Self {
        Self { weight: None, mean, reach, sigma: None }
    }

    /// The band of these levels in frame `t`; `number` counts the modes from 1. Earlier frames met another model, which is not kept.
    fn band(&self, number: usize, t: f32) -> Band {
        let name = match self.weight {
            Some(weight) => format!("mode {number} in frame {t}, weight {}", ratio(weight.into())),
            None => format!("background in frame {t}"),
        };
        Band { name, values: [self.mean - self.reach, self.mean + self.reach], at: Some(t) }
    }

    fn density(&self, level: f32) -> Option<f32> {
        let sigma = self.sigma?;
        let off = (level - self.mean) / sigma;
        Some(self.weight.unwrap_or(1.0) * (-0.5 * off * off).exp() / (sigma * std::f32::consts::TAU.sqrt()))
    }
}

/// No more frames than this.
const MOST_FRAMES: usize = 100;
/// And no more than these pixels, which stay in memory from step to step.
const MOST_PIXELS: usize = 16 << 20;
/// Gray levels that share a cell of the histogram.
const CELL: usize = 4;

/// The levels of a pixel in the last frames up to that of `state`, with their numbers; those that cannot be read are left out.
fn levels<T>((clip, state): (&Clip, &State<T>), place: (usize, usize), channel: Channel) -> Vec<[f32; 2]> {
    let pixels = (state.picture.0 * state.picture.1).max(1);
    let count = (MOST_PIXELS / pixels).clamp(2, MOST_FRAMES);
    let first = (state.frame + 1).saturating_sub(count).max(state.span.first);
    let level = |t: usize| Some([t as f32, f32::from(channel.level(&*clip.frame(t).ok()?, place))]);
    (first..=state.frame).filter_map(level).collect()
}

/// The title of the plot of a pixel over the frames.
fn title(channel: Channel) -> &'static str {
    match channel {
        Channel::Gray => "Gray level of the pixel",
        Channel::Color(0) => "Red of the pixel",
        Channel::Color(1) => "Green of the pixel",
        Channel::Color(_) => "Blue of the pixel",
    }
}

/// Plots of a pixel: its levels over the frames, in the channel that decides, with what the model takes for background in the present
/// one, and their distribution with the densities of the modes.
pub(super) fn plots<M: Background>(
    detector: &M,
    (clip, state): (&Clip, &State<M::Model>),
    (model, frame): (&M::Model, &Frame),
    place: (usize, usize),
) -> Vec<Readout> {
    let channel = detector.channel(model, frame, place);
    let levels = levels((clip, state), place, channel);
    let (Some(first), Some(last)) = (levels.first(), levels.last()) else { return Vec::new() };
    if first == last {
        return Vec::new();
    }
    let accepted = detector.accepted(model, place, channel);
    let mut lines = vec![(channel.name().unwrap_or("gray level"), Role::Measured, levels.clone())];
    // The model is compared with the corrected frame.
    let compared = f32::from(channel.level(frame, place));
    if compared != last[1] {
        lines.push(("corrected for the exposure", Role::Result, vec![[last[0], compared]]));
    }
    let over_time = Series {
        fits_values: true,
        bands: accepted.iter().enumerate().map(|(i, accepted)| accepted.band(i + 1, last[0])).collect(),
        ..Series::new(title(channel), ["frame", "level"], last[0] as usize, lines)
    };
    let distribution =
        accepted.iter().any(|accepted| accepted.sigma.is_some()).then(|| distribution(&levels, &accepted));
    [Some(over_time), distribution].into_iter().flatten().map(Readout::Series).collect()
}

/// The share of the frames in each cell of gray levels, and that which the modes predict.
fn distribution(levels: &[[f32; 2]], accepted: &[Accepted]) -> Series {
    let mut shares = [0.0; 256 / CELL];
    for [_, level] in levels {
        shares[*level as usize / CELL] += 1.0 / levels.len() as f32;
    }
    let middle = |cell: usize| (cell * CELL) as f32 + (CELL - 1) as f32 / 2.0;
    // The levels that occur or are expected, with some margin.
    let seen = levels.iter().map(|[_, level]| *level);
    let expected = accepted.iter().flat_map(|of| [of.mean - of.reach, of.mean + of.reach]);
    let all: Vec<f32> = seen.chain(expected).map(|level| level.clamp(0.0, 255.0)).collect();
    let low = (all.iter().copied().fold(255.0, f32::min) as usize).saturating_sub(2 * CELL) / CELL;
    let high = (all.iter().copied().fold(0.0, f32::max) as usize + 2 * CELL).min(255) / CELL;
    let found = (low..=high).map(|cell| [middle(cell), shares[cell]]).collect();
    let predicted = |level: f32| accepted.iter().filter_map(|accepted| accepted.density(level)).sum::<f32>();
    let predicted =
        (low * CELL..(high + 1) * CELL).map(|level| [level as f32, CELL as f32 * predicted(level as f32)]).collect();
    Series {
        is_sweep: true,
        ..Series::new(
            "Distribution of its levels",
            ["level", "share of the frames"],
            (high + 1) * CELL - 1,
            vec![("frames", Role::Measured, found), ("model", Role::Predicted, predicted)],
        )
    }
}
