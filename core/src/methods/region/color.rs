//! Colour histograms: the bins of pixels, and histograms of ellipses weighted by the Epanechnikov kernel.

use crate::base::{effort, wide::wide};
use crate::data::Frame;
use crate::geometry::{Bounds, Grid};
use crate::products::Region;
use crate::{choices, params};

choices! {
    /// Colour space of a histogram. Frames without colour have a histogram of gray levels.
    pub enum ColorSpace {
        /// Red, green and blue: every difference of colour and brightness counts.
        Rgb = "rgb" "RGB",
        /// Hue and saturation, without brightness: tolerates changes of light.
        HueSaturation = "hue-saturation" "Hue–saturation",
    }
}

params! {
    /// The bins of a colour histogram.
    pub struct ColorBins {
        /// Colour channels of the histograms.
        channels: ColorSpace = ColorSpace::Rgb;
        /// Bins along each axis of the colour space. Few bins tolerate noise and changes of light, many tell similar colours apart.
        bins: usize = 16, 2..=32;
    }
}

impl ColorBins {
    /// The binning of a frame: of gray levels where it has no colour.
    pub(crate) fn of(&self, frame: &Frame) -> Binning {
        match (frame.color(), self.channels) {
            (None, _) => Binning::Gray(self.bins),
            (Some(_), ColorSpace::Rgb) => Binning::Rgb(self.bins),
            (Some(_), ColorSpace::HueSaturation) => Binning::HueSaturation(self.bins),
        }
    }

    /// The largest number of bins of a histogram.
    pub(crate) fn most(&self) -> usize {
        Binning::Rgb(self.bins).count()
    }
}

/// The bin of a pixel that is not counted.
pub(crate) const NO_BIN: u16 = u16::MAX;

/// The assignment of colours to bins.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Binning {
    /// Bins of each of red, green and blue.
    Rgb(usize),
    /// Bins of hue and of saturation.
    HueSaturation(usize),
    /// Bins of hue, for pixels of at least this saturation and value, 0 to 1.
    Hue(usize, [f32; 2]),
    /// Bins of gray levels.
    Gray(usize),
}

impl Binning {
    /// Number of bins.
    pub(crate) fn count(self) -> usize {
        match self {
            Self::Rgb(bins) => bins * bins * bins,
            Self::HueSaturation(bins) => bins * bins,
            Self::Hue(bins, _) | Self::Gray(bins) => bins,
        }
    }

    /// The name of its axes.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Rgb(_) => "RGB",
            Self::HueSaturation(_) => "hue–saturation",
            Self::Hue(..) => "hue",
            Self::Gray(_) => "gray-level",
        }
    }
}

/// Hue in turns, saturation and value of a colour, 0 to 1 each.
pub(crate) fn hsv(rgb: [u8; 3]) -> [f32; 3] {
    let [r, g, b] = rgb.map(f32::from);
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    let span = most - least;
    if span == 0.0 {
        return [0.0, 0.0, most / 255.0];
    }
    let sixths = if most == r {
        (g - b) / span + if g < b { 6.0 } else { 0.0 }
    } else if most == g {
        (b - r) / span + 2.0
    } else {
        (r - g) / span + 4.0
    };
    [sixths / 6.0, span / most, most / 255.0]
}

/// The bin of a share of 0 to 1.
fn part(share: f32, bins: usize) -> u16 {
    ((share * bins as f32) as usize).min(bins - 1) as u16
}

/// Pixels from the first to the one behind the last, along x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Area {
    /// The first column and row.
    pub from: [usize; 2],
    /// The column and row behind the last.
    pub to: [usize; 2],
}

impl Area {
    /// The pixels of a picture whose centres lie in a rectangle.
    pub(crate) fn within(Bounds { min, max }: Bounds, (width, height): (usize, usize)) -> Self {
        let extent = [width, height];
        let to = [0, 1].map(|i| (max[i].floor() + 1.0).clamp(0.0, extent[i] as f32) as usize);
        Self { from: [0, 1].map(|i| (min[i].ceil().max(0.0) as usize).min(to[i])), to }
    }

    fn holds(&self, other: &Self) -> bool {
        (0..2).all(|i| self.from[i] <= other.from[i] && other.to[i] <= self.to[i])
    }

    fn size(&self) -> [usize; 2] {
        [0, 1].map(|i| self.to[i] - self.from[i])
    }
}

/// The bins of the pixels of a part of a frame, which grows as needed.
pub(crate) struct Bins<'a> {
    frame: &'a Frame,
    binning: Binning,
    area: Area,
    bins: Grid<u16>,
}

/// Extra pixels on each side, so that few steps need more.
const MARGIN_PX: f32 = 12.0;

impl<'a> Bins<'a> {
    /// The bins of a frame, none of them known yet.
    pub(crate) fn new(frame: &'a Frame, binning: Binning) -> Self {
        Self { frame, binning, area: Area::default(), bins: Grid::new(0, 0, 0) }
    }

    /// Makes the bins of all pixels in a rectangle known.
    pub(crate) fn cover(&mut self, bounds: Bounds) {
        let size = self.frame.size();
        if self.area.holds(&Area::within(bounds, size)) && !self.bins.cells().is_empty() {
            return;
        }
        let min = bounds.min.map(|c| c - MARGIN_PX);
        let area = Area::within(Bounds { min, max: bounds.max.map(|c| c + MARGIN_PX) }, size);
        self.bins = self.of(&area);
        self.area = area;
    }

    fn of(&self, area: &Area) -> Grid<u16> {
        let [width, height] = area.size();
        effort::add(width * height);
        let [left, top] = area.from;
        let columns = left..left + width;
        let mut cells = Vec::with_capacity(width * height);
        match (self.frame.color(), self.binning) {
            (Some(color), Binning::Rgb(bins)) => {
                let along = |factor: usize| std::array::from_fn::<u16, 256, _>(|v| (v * bins / 256 * factor) as u16);
                let [red, green, blue] = [bins * bins, bins, 1].map(along);
                let bin = |rgb: &[u8; 3]| red[rgb[0] as usize] + green[rgb[1] as usize] + blue[rgb[2] as usize];
                (top..top + height).for_each(|y| cells.extend(color.row(y)[columns.clone()].iter().map(bin)));
            }
            (Some(color), binning) => {
                let bin = |rgb: &[u8; 3]| color_bin(binning, *rgb);
                (top..top + height).for_each(|y| cells.extend(color.row(y)[columns.clone()].iter().map(bin)));
            }
            (None, binning) => {
                let bins = binning.count();
                let bin = |level: &u8| (usize::from(*level) * bins / 256) as u16;
                let luma = self.frame.luma();
                (top..top + height).for_each(|y| cells.extend(luma.row(y)[columns.clone()].iter().map(bin)));
            }
        }
        Grid::from_vec(width, height, cells).unwrap_or_else(|_| Grid::new(0, 0, 0))
    }

    /// The bin of a pixel of the area that is known.
    #[inline]
    pub(crate) fn at(&self, x: usize, y: usize) -> Option<u16> {
        let known = self.bins.get(x.checked_sub(self.area.from[0])?, y.checked_sub(self.area.from[1])?);
        known.copied().filter(|bin| *bin != NO_BIN)
    }

    /// The known bins, row by row.
    pub(crate) fn cells(&self) -> &[u16] {
        self.bins.cells()
    }

    /// Sets `positions` to those in [`cells`](Self::cells) of the pixels around the places of a `pattern`, given along x and along y in
    /// radii of an upright ellipse from its centre; of places that are not known, to [`u32::MAX`].
    pub(crate) fn find(&self, region: Region, pattern: [&[f32]; 2], positions: &mut [u32]) {
        find(self, region, pattern, positions);
    }

    /// Calls `see` with each row of pixels that are in the picture and in a rectangle: the bins from the first column on, that
    /// column, and the row.
    pub(crate) fn rows(&self, bounds: Bounds, mut see: impl FnMut(&[u16], usize, usize)) {
        let area = Area::within(bounds, self.frame.size());
        for y in area.from[1]..area.to[1] {
            let columns = area.from[0] - self.area.from[0]..area.to[0] - self.area.from[0];
            see(&self.bins.row(y - self.area.from[1])[columns], area.from[0], y);
        }
    }
}

wide!(fn find(bins: &Bins<'_>, region: Region, pattern: [&[f32]; 2], positions: &mut [u32]) = find_all);

#[inline(always)]
fn find_all(bins: &Bins<'_>, region: Region, [xs, ys]: [&[f32]; 2], positions: &mut [u32]) {
    /// More than any coordinate left of or above the picture, so that truncation is rounding down.
    const BEYOND: f32 = 4096.0;
    let half = region.size.map(|side| side / 2.0);
    let first = bins.area.from.map(|from| from as i32 + BEYOND as i32);
    let (width, height) = (bins.bins.width() as u32, bins.bins.height() as u32);
    for (position, place) in positions.iter_mut().zip(xs.iter().zip(ys)) {
        let at = [region.center[0] + place.0 * half[0], region.center[1] + place.1 * half[1]];
        // Negative ones become larger than any side.
        let [x, y] = [0, 1].map(|i| ((at[i] + (BEYOND + 0.5)) as i32).wrapping_sub(first[i]) as u32);
        let index = y.wrapping_mul(width).wrapping_add(x);
        *position = if (x < width) & (y < height) { index } else { u32::MAX };
    }
}

/// The bin of a colour in a space with hue.
fn color_bin(binning: Binning, rgb: [u8; 3]) -> u16 {
    let [hue, saturation, value] = hsv(rgb);
    match binning {
        Binning::HueSaturation(bins) => part(hue, bins) * bins as u16 + part(saturation, bins),
        Binning::Hue(_, [least, dark]) if saturation < least || value < dark => NO_BIN,
        Binning::Hue(bins, _) => part(hue, bins),
        Binning::Rgb(bins) => {
            rgb.into_iter().fold(0, |bin, v| bin * bins as u16 + (usize::from(v) * bins / 256) as u16)
        }
        Binning::Gray(bins) => part(value, bins),
    }
}

/// Calls `see` with each row of pixels inside an upright ellipse: the bins from the first column on, the offset of that
/// column and of the row from the centre, and 1 minus the squared distance along y in radii.
#[inline]
pub(crate) fn ellipse_rows(bins: &Bins<'_>, region: Region, mut see: impl FnMut(&[u16], [f32; 2], f32)) {
    let ([x0, y0], [a, b]) = (region.center, region.size.map(|side| side / 2.0));
    let (width, height) = bins.frame.size();
    let top = (y0 - b).ceil().max(0.0) as usize;
    let end = ((y0 + b).floor() + 1.0).clamp(0.0, height as f32) as usize;
    for y in top..end {
        let dy = y as f32 - y0;
        let rest = 1.0 - (dy / b) * (dy / b);
        if rest <= 0.0 {
            continue;
        }
        let reach = a * rest.sqrt();
        let left = (x0 - reach).ceil().max(0.0) as usize;
        let right = ((x0 + reach).floor() + 1.0).clamp(0.0, width as f32) as usize;
        if left < right {
            let row = &bins.bins.row(y - bins.area.from[1])[left - bins.area.from[0]..right - bins.area.from[0]];
            see(row, [left as f32 - x0, dy], rest);
        }
    }
}

/// Adds the pixels of an upright ellipse to a histogram, each with the weight 1 − r² of the Epanechnikov kernel; returns the sum of
/// the weights. The pixels must be covered.
pub(crate) fn add_kernel(bins: &Bins<'_>, region: Region, histogram: &mut [f32]) -> f32 {
    let inverse = 2.0 / region.size[0];
    effort::add((region.size[0] * region.size[1]) as usize);
    let mut sum = 0.0;
    ellipse_rows(bins, region, |row, [first, _], rest| {
        let mut total = 0.0;
        for (i, bin) in row.iter().enumerate() {
            let dx = (first + i as f32) * inverse;
            let weight = rest - dx * dx;
            histogram[usize::from(*bin)] += weight;
            total += weight;
        }
        sum += total;
    });
    sum
}

/// Extent of the surroundings as a multiple of that of the object: the area around it is three times its own.
const AROUND: f32 = 2.0;

/// The number of pixels of each bin around the box of a region, up to twice its extent.
pub(crate) fn surroundings(frame: &Frame, binning: Binning, region: Region) -> Vec<f32> {
    let (inner, outer) = (region.bounds(), region.scaled(AROUND).bounds());
    let mut bins = Bins::new(frame, binning);
    bins.cover(outer);
    let mut counts = vec![0.0; binning.count()];
    bins.rows(outer, |row, first, y| {
        let is_inside = |x: f32, y: f32| {
            let Bounds { min, max } = inner;
            (min[0]..=max[0]).contains(&x) && (min[1]..=max[1]).contains(&y)
        };
        for (i, bin) in row.iter().enumerate() {
            let count = counts.get_mut(usize::from(*bin));
            count.filter(|_| !is_inside((first + i) as f32, y as f32)).into_iter().for_each(|count| *count += 1.0);
        }
    });
    counts
}

/// A histogram of shares, with sum 1.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// The bins.
    pub(crate) binning: Binning,
    /// The share of each bin.
    pub shares: Vec<f32>,
    /// The bins with a share, in ascending order.
    pub support: Vec<u16>,
}

impl Histogram {
    /// Normalises sums of bins.
    pub(crate) fn new(binning: Binning, mut shares: Vec<f32>) -> Self {
        let sum: f32 = shares.iter().sum();
        if sum > 0.0 {
            shares.iter_mut().for_each(|share| *share /= sum);
        }
        let support = (0..shares.len()).filter(|bin| shares[*bin] > 0.0).map(|bin| bin as u16).collect();
        Self { binning, shares, support }
    }

    /// The histogram of an ellipse, weighted by the Epanechnikov kernel.
    pub(crate) fn of_ellipse(frame: &Frame, binning: Binning, region: Region) -> Self {
        let mut bins = Bins::new(frame, binning);
        bins.cover(region.bounds());
        let mut sums = vec![0.0; binning.count()];
        add_kernel(&bins, region, &mut sums);
        Self::new(binning, sums)
    }

    /// The Bhattacharyya coefficient with another histogram of the same bins, 0 to 1.
    pub(crate) fn coefficient(&self, other: &[f32]) -> f32 {
        self.support.iter().map(|bin| (self.shares[usize::from(*bin)] * other[usize::from(*bin)]).sqrt()).sum()
    }

    /// Its bins with the largest shares, those first.
    pub(crate) fn largest(&self, most: usize) -> Vec<usize> {
        let mut bins: Vec<_> = self.support.iter().map(|bin| usize::from(*bin)).collect();
        bins.sort_by(|a, b| self.shares[*b].total_cmp(&self.shares[*a]).then(a.cmp(b)));
        bins.truncate(most);
        bins
    }

    /// Whether all of it is in one bin.
    pub(crate) fn is_flat(&self) -> bool {
        self.support.len() == 1
    }

    /// Memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.shares[..]) + size_of_val(&self.support[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_go_round_the_wheel() {
        let hues = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 0, 255], [9, 9, 9]].map(hsv);
        let expected = [[0.0, 1.0, 1.0], [1.0 / 3.0, 1.0, 1.0], [2.0 / 3.0, 1.0, 1.0], [5.0 / 6.0, 1.0, 1.0]];
        for (found, expected) in hues.iter().zip(expected) {
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-6), "{found:?}");
        }
        assert_eq!(hues[4], [0.0, 0.0, 9.0 / 255.0]);
    }

    #[test]
    fn bins_of_an_area_are_those_of_its_pixels() {
        let frame = Frame::rgb(Grid::from_fn(40, 30, |x, y| [x as u8 * 6, y as u8 * 8, (x + y) as u8 * 3]));
        for binning in [Binning::Rgb(16), Binning::HueSaturation(8), Binning::Hue(16, [0.3, 0.2]), Binning::Rgb(5)] {
            let mut bins = Bins::new(&frame, binning);
            bins.cover(Bounds { min: [20.0, 18.0], max: [25.5, 22.0] });
            bins.cover(Bounds { min: [5.0, 18.0], max: [25.5, 22.0] });
            for (x, y) in [(20, 18), (5, 20), (25, 22)] {
                let expected = color_bin(binning, frame.color().expect("colour")[(x, y)]);
                assert_eq!(bins.at(x, y).unwrap_or(NO_BIN), expected, "{binning:?} at {x}, {y}");
            }
        }
    }
}
