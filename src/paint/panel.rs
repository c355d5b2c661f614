//! The pictures that are looked at: a frame, or what becomes of two.

use std::sync::Arc;

use motionscope_core::scene::Picture;
use motionscope_core::{Frame, Grid};

/// How the pair of frames is looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// Frame t.
    Current,
    /// Frame t + 1.
    Next,
    /// Both, side by side.
    #[default]
    SideBySide,
    /// How much each pixel changes.
    Difference,
    /// The mean of both.
    Blend,
    /// Both in turn. A picture cannot blink, so it shows them side by side.
    Blink,
}

impl View {
    /// Every view.
    pub const ALL: [View; 6] =
        [View::Current, View::Next, View::SideBySide, View::Difference, View::Blend, View::Blink];

    /// Stable name, for sessions and the command line.
    pub fn id(self) -> &'static str {
        match self {
            View::Current => "current",
            View::Next => "next",
            View::SideBySide => "side-by-side",
            View::Difference => "difference",
            View::Blend => "blend",
            View::Blink => "blink",
        }
    }

    /// Name as shown.
    pub fn name(self) -> &'static str {
        match self {
            View::Current => "Frame t",
            View::Next => "Frame t+1",
            View::SideBySide => "Side by side",
            View::Difference => "Difference",
            View::Blend => "Blend",
            View::Blink => "Blink",
        }
    }

    /// The panels of a still picture, left to right.
    pub fn panels(self) -> &'static [Panel] {
        match self {
            View::Current => &[Panel::Current],
            View::Next => &[Panel::Next],
            View::SideBySide | View::Blink => &[Panel::Current, Panel::Next],
            View::Difference => &[Panel::Difference],
            View::Blend => &[Panel::Blend],
        }
    }
}

/// One picture on the stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Panel {
    /// Frame t.
    Current,
    /// Frame t + 1.
    Next,
    /// |frame t+1 − frame t| in gray, brightened so that it can be seen.
    Difference,
    /// The mean of both frames.
    Blend,
}

impl Panel {
    /// Whether marks on `picture` are shown here.
    pub fn shows(self, picture: Picture) -> bool {
        match self {
            Panel::Current => picture == Picture::Current,
            Panel::Next => picture == Picture::Next,
            Panel::Difference | Panel::Blend => true,
        }
    }

    /// Its pixels, opaque, and how many times brighter than the numbers say they are.
    pub fn pixels(self, frames: &[Arc<Frame>; 2]) -> (Grid<[u8; 4]>, u16) {
        match self {
            Panel::Current => (colors(&frames[0]), 1),
            Panel::Next => (colors(&frames[1]), 1),
            Panel::Difference => difference(frames),
            Panel::Blend => {
                let (a, b) = (colors(&frames[0]), colors(&frames[1]));
                let mean = |p: [u8; 4], q: [u8; 4]| {
                    std::array::from_fn(|i| (u16::from(p[i]) + u16::from(q[i])).div_ceil(2) as u8)
                };
                (both(&a, &b, mean), 1)
            }
        }
    }

    /// What is above it: `frame 12`, or `frame t` where no number is known.
    pub fn title(self, frame: Option<usize>, gain: u16) -> String {
        let [t, next] = match frame {
            Some(t) => [t.to_string(), t.saturating_add(1).to_string()],
            None => ["t".into(), "t+1".into()],
        };
        match self {
            Panel::Current => format!("frame {t}"),
            Panel::Next => format!("frame {next}"),
            Panel::Difference if gain > 1 => format!("|frame {next} − frame {t}| × {gain}"),
            Panel::Difference => format!("|frame {next} − frame {t}|"),
            Panel::Blend => format!("mean of frames {t} and {next}"),
        }
    }
}

fn colors(frame: &Frame) -> Grid<[u8; 4]> {
    match frame.color() {
        Some(rgb) => rgb.map(|&[r, g, b]| [r, g, b, 255]),
        None => frame.luma().map(|&v| [v, v, v, 255]),
    }
}

/// Cell by cell, over what the two have in common.
fn both<T: Copy, U>(a: &Grid<T>, b: &Grid<T>, f: impl Fn(T, T) -> U) -> Grid<U> {
    Grid::from_fn(a.width().min(b.width()), a.height().min(b.height()), |x, y| f(a[(x, y)], b[(x, y)]))
}

/// The absolute difference of the gray values, times the power of two that brings all but one in a hundred to at most white.
fn difference(frames: &[Arc<Frame>; 2]) -> (Grid<[u8; 4]>, u16) {
    let plain = both(frames[0].luma(), frames[1].luma(), u8::abs_diff);
    let mut counts = [0usize; 256];
    for &v in plain.cells() {
        counts[v as usize] += 1;
    }
    let mut brighter = plain.cells().len() / 100;
    let top = (0..256).rev().find(|&v| {
        let among = counts[v] > brighter;
        brighter = brighter.saturating_sub(counts[v]);
        among
    });
    let gain = [8u16, 4, 2].into_iter().find(|gain| top.is_some_and(|top| top as u16 * gain <= 255)).unwrap_or(1);
    let gray = |&v: &u8| {
        let v = (u16::from(v) * gain).min(255) as u8;
        [v, v, v, 255]
    };
    (plain.map(gray), gain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(value: impl Fn(usize) -> u8) -> Arc<Frame> {
        Arc::new(Frame::gray(Grid::from_fn(200, 1, |x, _| value(x))))
    }

    #[test]
    fn a_difference_is_brightened_until_it_can_be_seen() {
        let gain =
            |change: u8| Panel::Difference.pixels(&[frame(|_| 0), frame(|x| if x < 100 { change } else { 0 })]).1;
        assert_eq!([gain(3), gain(40), gain(100), gain(200)], [8, 4, 2, 1]);
        let (pixels, gain) = Panel::Difference.pixels(&[frame(|_| 9), frame(|x| if x == 0 { 250 } else { 19 })]);
        assert_eq!((gain, pixels[(1, 0)][0], pixels[(0, 0)][0]), (8, 80, 255));
        assert_eq!(Panel::Difference.title(Some(12), 8), "|frame 13 − frame 12| × 8");
    }

    #[test]
    fn a_blend_is_the_mean() {
        let (pixels, _) = Panel::Blend.pixels(&[frame(|_| 10), frame(|_| 20)]);
        assert_eq!(pixels[(0, 0)], [15, 15, 15, 255]);
    }

    #[test]
    fn every_mark_is_seen_in_every_view_of_both() {
        for view in [View::SideBySide, View::Difference, View::Blend, View::Blink] {
            for picture in [Picture::Current, Picture::Next] {
                assert_eq!(view.panels().iter().filter(|panel| panel.shows(picture)).count(), 1, "{view:?}");
            }
        }
    }
}
