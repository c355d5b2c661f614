//! Colours for all pictures of an animation.

use std::collections::HashMap;

use color_quant::NeuQuant;
use motionscope_core::base::Error;

use super::{AnimationFormat, Progress, Reel, Shots};

/// The index of pixels that do not change.
pub const UNCHANGED: u8 = u8::MAX;
/// The number of colours, whose indices are smaller.
const COLORS: usize = UNCHANGED as usize;
/// The number of colours that are kept exactly: areas, words and marks are of one colour each.
const EXACT: usize = 64;
/// The number of pixels that are counted, of all pictures together.
const COUNTED: u64 = 8_000_000;
/// How often a colour is presented to the quantiser at most.
const MOST_WEIGHT: u32 = 32;
/// Every so manieth pixel teaches the quantiser, as its author advises for good pictures.
const SAMPLE_FACTOR: i32 = 3;
/// Entries of the table of colours that were looked up.
const LOOKED_UP: usize = 1 << 15;

/// The colours, and where each was found last.
pub struct Palette {
    colors: Vec<[u8; 3]>,
    looked_up: Vec<Option<([u8; 3], u8)>>,
}

impl Palette {
    /// Chooses the colours for all pictures of `reel`: all of them if they are few, else the most frequent exactly and the
    /// rest by Dekker's neural network (Network 5, 1994).
    ///
    /// # Errors
    /// If a picture cannot be read back or the work was cancelled.
    pub async fn of(reel: &Reel, progress: Option<&dyn Progress>) -> Result<Self, Error> {
        let pixels = reel.shots() as u64 * u64::from(reel.size[0]) * u64::from(reel.size[1]);
        // Odd, so that columns are not counted again and again.
        let every = usize::try_from(pixels / COUNTED).unwrap_or(usize::MAX) | 1;
        let mut counts: HashMap<[u8; 3], u32> = HashMap::new();
        let mut shots = Shots::new(reel, AnimationFormat::Gif, progress);
        while let Some(shot) = shots.next().await? {
            for pixel in shot.picture.pixels().step_by(every) {
                *counts.entry(pixel.0).or_default() += 1;
            }
        }
        // The order of a hash map differs from run to run.
        let mut counts: Vec<_> = counts.into_iter().collect();
        counts.sort_by_key(|&(color, count)| (std::cmp::Reverse(count), color));
        Ok(Self { colors: chosen(&counts), looked_up: vec![None; LOOKED_UP] })
    }

    /// Returns red, green and blue of all colours one after another.
    pub fn bytes(&self) -> Vec<u8> {
        self.colors.concat()
    }

    /// Returns the index of the nearest colour.
    pub fn index(&mut self, color: [u8; 3]) -> u8 {
        let [r, g, b] = color.map(usize::from);
        let place = (r * 31 + g * 1013 + b * 8191) % LOOKED_UP;
        if let Some((_, index)) = self.looked_up[place].filter(|(of, _)| *of == color) {
            return index;
        }
        let distance =
            |other: &[u8; 3]| (0..3).map(|i| color[i].abs_diff(other[i])).map(|d| u32::from(d).pow(2)).sum::<u32>();
        let nearest = (0..UNCHANGED).zip(&self.colors).min_by_key(|(_, other)| distance(other));
        let index = nearest.map_or(0, |(index, _)| index);
        self.looked_up[place] = Some((color, index));
        index
    }
}

/// Returns at most [`COLORS`] colours for those that were counted, most frequent first.
fn chosen(counts: &[([u8; 3], u32)]) -> Vec<[u8; 3]> {
    if counts.len() <= COLORS {
        return counts.iter().map(|(color, _)| *color).collect();
    }
    let (exact, rest) = counts.split_at(EXACT);
    let repeated = |&([r, g, b], count): &([u8; 3], u32)| [r, g, b, 255].repeat(count.min(MOST_WEIGHT) as usize);
    let samples: Vec<u8> = rest.iter().flat_map(repeated).collect();
    let learnt = NeuQuant::new(SAMPLE_FACTOR, COLORS - EXACT, &samples).color_map_rgb();
    let learnt = learnt.chunks_exact(3).map(|color| [color[0], color[1], color[2]]);
    exact.iter().map(|(color, _)| *color).chain(learnt).collect()
}
