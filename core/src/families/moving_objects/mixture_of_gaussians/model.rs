//! The modes of all pixels and their update by a frame.
//!
//! Pixels are processed in groups of a row that fit a SIMD register, and a group processes only as many modes as its pixels
//! have: most have one or two. The first modes of all groups are stored one after the other, then the second ones, so that
//! memory is read in order and only as much of it is used as there are modes.

use super::{MAX_SIGMAS, MixtureOfGaussians};
use crate::base::{LANES, Threads, wide::widest};
use crate::data::{Frame, Mask};
use crate::methods::subtraction::{Accepted, Found, ShadowLimits, shadow_brightness};

/// The weights of red, green and blue in a gray level.
const LUMA: [f32; 3] = [0.299, 0.587, 0.114];

/// A weighted normal distribution of a pixel with equal variance in all channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The weight w, 0 to 1: the share of the frames that the mode explains.
    pub weight: f32,
    /// The variance σ²: the mean of |I − μ|² over all channels together, so n times that of one of n equal channels.
    pub variance: f32,
    /// The mean μ: the gray level, or red, green and blue.
    pub mean: Vec<f32>,
}

impl Mode {
    /// Returns the distance of a pixel from the mean, |I − μ| / σ.
    pub fn distance(&self, pixel: &[f32]) -> f32 {
        let square: f32 = pixel.iter().zip(&self.mean).map(|(pixel, mean)| (pixel - mean) * (pixel - mean)).sum();
        (square / self.variance).sqrt()
    }

    /// Returns the gray levels within `threshold` standard deviations. Those of a colour are distributed as the weighted sum of its
    /// channels.
    pub fn accepted(&self, threshold: f32) -> Accepted {
        let share = match self.mean.len() {
            3 => (LUMA.iter().map(|weight| weight * weight).sum::<f32>() / 3.0).sqrt(),
            _ => 1.0,
        };
        let sigma = share * self.variance.sqrt();
        let around = Accepted::around(self.gray(), threshold * sigma);
        Accepted { weight: Some(self.weight), sigma: Some(sigma), ..around }
    }

    /// Returns the gray level of the mean.
    pub fn gray(&self) -> f32 {
        match self.mean[..] {
            [red, green, blue] => LUMA[0] * red + LUMA[1] * green + LUMA[2] * blue,
            _ => self.mean[0],
        }
    }
}

/// The modes of all pixels.
#[derive(Debug, PartialEq)]
pub struct Mixture {
    size: (usize, usize),
    /// 1 for gray values, 3 for colours.
    channels: usize,
    /// The maximum number of modes of a pixel.
    most: usize,
    /// The number of modes in use in each group.
    counts: Vec<u8>,
    /// The modes, by their index, and of each those of all groups: the weights of the pixels, their variances, and the means of
    /// each channel. A mode that a pixel has not got weighs nothing. None where the mixture is packed.
    planes: Vec<Vec<f32>>,
    /// The modes in use, by group, if it is packed.
    packed: Option<Packed>,
}

/// The modes in use, without gaps.
#[derive(Clone, Debug, PartialEq)]
struct Packed {
    cells: Vec<f32>,
    /// The index of each group's first cell.
    starts: Vec<usize>,
}

impl Clone for Mixture {
    /// Copies only the planes in use.
    fn clone(&self) -> Self {
        let used = self.used();
        let copy =
            |(index, plane): (usize, &Vec<f32>)| if index < used { plane.clone() } else { vec![0.0; plane.len()] };
        Self {
            planes: self.planes.iter().enumerate().map(copy).collect(),
            counts: self.counts.clone(),
            packed: self.packed.clone(),
            ..*self
        }
    }
}

/// The parameters as the inner loop needs them.
#[derive(Clone, Copy)]
struct Rates {
    rate: f32,
    /// Weight that each mode loses per frame, α c_T.
    lost: f32,
    /// The squared threshold and the initial, least and largest variance.
    limit: f32,
    first: f32,
    least: f32,
    largest: f32,
    background: f32,
    /// The shadow threshold; none if shadows are not detected.
    darkest: Option<f32>,
}

impl Rates {
    fn new(of: &MixtureOfGaussians) -> Self {
        let first = of.initial_sigma.max(of.min_sigma);
        Self {
            rate: of.learning_rate,
            lost: of.learning_rate * of.complexity_reduction,
            limit: of.threshold * of.threshold,
            first: first * first,
            least: of.min_sigma * of.min_sigma,
            largest: MAX_SIGMAS * MAX_SIGMAS * first * first,
            background: of.background_ratio,
            darkest: of.shadow.detect_shadows.then_some(of.shadow.shadow_threshold),
        }
    }

    /// The weight of a mode after a frame, 0 without support, and the share of the way to the pixel that its mean and variance move.
    #[inline(always)]
    fn weight_after(&self, before: f32, is_match: bool) -> (f32, f32) {
        let weight = before + self.rate * (if is_match { 1.0 } else { 0.0 } - before) - self.lost;
        // A mode without support is pruned.
        let weight = if (weight > 0.0) & (before > 0.0) { weight } else { 0.0 };
        let step = self.rate / weight;
        (weight, if is_match & (weight > 0.0) { step } else { 0.0 })
    }

    /// The variance of a matched mode after a frame, by the rule alone and within its limits.
    #[inline(always)]
    fn variance_after(&self, before: f32, square: f32, step: f32) -> [f32; 2] {
        let free = before + step * (square - before);
        let variance = if free > self.least { free } else { self.least };
        [free, if variance < self.largest { variance } else { self.largest }]
    }
}

/// The decision about a pixel.
pub struct Verdict {
    /// The modes before the update, the heaviest first.
    pub modes: Vec<Mode>,
    /// Whether it is foreground, shadows included.
    pub is_foreground: bool,
    /// The matched mode.
    pub matched: Option<Matched>,
    /// The index of the background mode that it is a shadow on, and its brightness as a share of that mode's.
    pub shadow: Option<(usize, f32)>,
}

/// The mode that a pixel matches.
pub struct Matched {
    /// Its index among the modes.
    pub mode: usize,
    /// The place where it is stored, before the update and after it.
    pub slot: usize,
    /// The variance that the update gives it without limits.
    pub free_variance: f32,
}

/// A band of rows of the model, the masks and the frame.
struct Band<'a> {
    width: usize,
    most: usize,
    counts: &'a mut [u8],
    /// For each mode, the planes of the groups.
    planes: Vec<&'a mut [f32]>,
    mask: &'a mut [u64],
    shadows: &'a mut [u64],
    frame: &'a Frame,
    first_row: usize,
}

/// The number of rows of a band.
const BAND_ROWS: usize = 16;

impl Mixture {
    /// Initialises one mode per pixel with the first frame as mean.
    pub fn new(of: &MixtureOfGaussians, first: &Frame) -> Self {
        let (width, height) = first.size();
        let channels = if first.color().is_some() { 3 } else { 1 };
        let groups = width.div_ceil(LANES) * height;
        let part = (2 + channels) * LANES;
        let (mut cells, variance) = (vec![0.0; groups * part], Rates::new(of).first);
        for (group, cells) in cells.chunks_exact_mut(part).enumerate() {
            let (y, start) = (group / width.div_ceil(LANES), group % width.div_ceil(LANES) * LANES);
            cells[..LANES].fill(1.0);
            cells[LANES..2 * LANES].fill(variance);
            let means = cells[2 * LANES..].as_chunks_mut::<LANES>().0;
            match means {
                [mean] => *mean = gray(first, y, start)[0],
                means => means.copy_from_slice(&color(first, y, start)),
            }
        }
        let counts = vec![1; groups];
        Self { size: first.size(), channels, most: of.modes, counts, planes: vec![cells], packed: None }
    }

    /// Memory of this many modes per pixel in bytes: weight, variance and means.
    pub fn need(modes: usize, channels: usize) -> f64 {
        (modes * (2 + channels) * size_of::<f32>() + 2) as f64
    }

    /// Numbers of a mode of a group.
    fn part(&self) -> usize {
        (2 + self.channels) * LANES
    }

    /// The most modes that a group uses.
    fn used(&self) -> usize {
        self.counts.iter().copied().max().map_or(0, usize::from)
    }

    fn mode(&self, group: usize, index: usize) -> &[f32] {
        let part = self.part();
        match &self.packed {
            Some(Packed { cells, starts }) => &cells[starts[group] + index * part..][..part],
            None => &self.planes[index][group * part..][..part],
        }
    }

    fn modes_of(&self, group: usize) -> impl Iterator<Item = &[f32]> {
        (0..usize::from(self.counts[group])).map(move |index| self.mode(group, index))
    }

    /// The same without room for modes that are not in use: most pixels have one or two.
    #[must_use]
    pub fn packed(&self) -> Self {
        if self.packed.is_some() {
            return self.clone();
        }
        let (part, mut cells, mut starts) = (self.part(), Vec::new(), Vec::with_capacity(self.counts.len()));
        cells.reserve_exact(self.counts.iter().map(|count| usize::from(*count) * part).sum());
        for group in 0..self.counts.len() {
            starts.push(cells.len());
            self.modes_of(group).for_each(|mode| cells.extend_from_slice(mode));
        }
        let (counts, packed) = (self.counts.clone(), Some(Packed { cells, starts }));
        Self { counts, planes: Vec::new(), packed, ..*self }
    }

    /// Makes room for modes that may come with a frame: a group gets at most one more.
    fn make_room(&mut self) {
        let (part, used) = (self.part(), self.used());
        let planes = (used + 1).min(self.most);
        let plane = || vec![0.0; self.counts.len() * part];
        while self.planes.len() < planes {
            self.planes.push(plane());
        }
        let Some(Packed { cells, starts }) = self.packed.take() else { return };
        for (group, (count, start)) in self.counts.iter().zip(starts).enumerate() {
            for (plane, mode) in self.planes.iter_mut().zip(cells[start..].chunks_exact(part)).take(usize::from(*count))
            {
                plane[group * part..][..part].copy_from_slice(mode);
            }
        }
    }

    /// Returns a frame in the channels of the modes, if it has others: a clip may mix gray and color frames.
    fn gathered(&self, frame: &Frame) -> Option<Frame> {
        match (self.channels, frame.color().is_some()) {
            (3, false) => Some(as_color(frame)),
            (1, true) => Some(Frame::gray(frame.luma().clone())),
            _ => None,
        }
    }

    /// Classifies the pixels of a frame and updates the modes with it.
    pub fn subtract(&mut self, of: &MixtureOfGaussians, frame: &Frame, threads: &Threads) -> Found {
        self.make_room();
        let ((width, height), part) = (self.size, self.part());
        let (rates, most) = (Rates::new(of), self.most);
        let gathered = self.gathered(frame);
        let frame = gathered.as_ref().unwrap_or(frame);
        let (mut mask, mut shadows) = (Mask::new(width, height), Mask::new(width, height));
        let groups = BAND_ROWS * width.div_ceil(LANES);
        let mut planes: Vec<_> = self.planes.iter_mut().map(|plane| plane.chunks_mut(groups * part)).collect();
        let bands = self.counts.chunks_mut(groups).map(|counts| {
            let planes: Vec<&mut [f32]> = planes.iter_mut().filter_map(Iterator::next).collect();
            (counts, planes)
        });
        // Groups reach beyond the width; the mask drops their bits there.
        mask.write(|words, in_row| {
            shadows.write(|shadows, _| {
                let words = words.chunks_mut(BAND_ROWS * in_row).zip(shadows.chunks_mut(BAND_ROWS * in_row));
                let bands = bands.zip(words).enumerate().map(|(i, ((counts, planes), (mask, shadows)))| Band {
                    width,
                    most,
                    counts,
                    planes,
                    mask,
                    shadows,
                    frame,
                    first_row: i * BAND_ROWS,
                });
                match self.channels {
                    1 => threads.each(bands, |mut band| in_gray(&mut band, rates)),
                    _ => threads.each(bands, |mut band| in_color(&mut band, rates)),
                }
            });
        });
        let tells_shadows = of.shadow.detect_shadows && self.channels == 3;
        Found { mask, shadows: tells_shadows.then_some(shadows) }
    }

    /// Returns the modes displaced by `by` px; uncovered pixels are initialised with the frame.
    pub fn moved(&self, of: &MixtureOfGaussians, by: [f32; 2], frame: &Frame) -> Self {
        let (mut source, (width, height), part) = (self.clone(), self.size, self.part());
        let by = by.map(|c| c.round() as i32);
        source.make_room();
        let gathered = self.gathered(frame);
        let mut moved = Self::new(of, gathered.as_ref().unwrap_or(frame));
        moved.planes.resize_with(source.planes.len().max(1), || vec![0.0; self.counts.len() * part]);
        let in_row = width.div_ceil(LANES);
        let start = |x: usize, y: usize| (y * in_row + x / LANES) * part + x % LANES;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let [from_x, from_y] = [x as i32 - by[0], y as i32 - by[1]];
            if !(0..width as i32).contains(&from_x) || !(0..height as i32).contains(&from_y) {
                continue;
            }
            let (from, to) = (start(from_x as usize, from_y as usize), start(x, y));
            for (plane, earlier) in moved.planes.iter_mut().zip(&source.planes) {
                for number in (0..part).step_by(LANES) {
                    plane[to + number] = earlier[from + number];
                }
            }
        }
        for (group, count) in moved.counts.iter_mut().enumerate() {
            let is_used = |plane: &Vec<f32>| plane[group * part..][..LANES].iter().any(|weight| *weight > 0.0);
            *count = moved.planes.iter().rposition(is_used).map_or(0, |last| last as u8 + 1);
        }
        moved
    }

    /// Returns whether a background mode of pixel `of` explains the value of the frame at a place.
    pub fn fits(&self, by: &MixtureOfGaussians, (frame, place): (&Frame, (usize, usize)), of: (usize, usize)) -> bool {
        let pixel = self.value(frame, place);
        if by.background_ratio <= 0.0 {
            // Then no mode is background, and the heaviest one counts.
            return self.distance_of(pixel, of, by.background_ratio) <= by.threshold;
        }
        let (group, lane) = self.lane(of);
        let mut modes = self.weights(group, lane).peekable();
        let is_near = |(index, weight): (usize, f32)| {
            self.distance_from((group, lane), index, pixel) <= by.threshold
                && self.heavier((group, lane), (index, weight)) < by.background_ratio
        };
        modes.peek().is_none() || modes.any(is_near)
    }

    /// Width and height in px.
    pub fn size(&self) -> (usize, usize) {
        self.size
    }

    /// The modes of a pixel, the heaviest first; of two as heavy, the older place.
    pub fn modes(&self, place: (usize, usize)) -> Vec<Mode> {
        self.ranked(place).into_iter().map(|slot| self.mode_in(slot, place)).collect()
    }

    /// The places of the modes of a pixel in that order.
    fn ranked(&self, place: (usize, usize)) -> Vec<usize> {
        let (group, lane) = self.lane(place);
        let mut modes: Vec<_> = self.weights(group, lane).collect();
        modes.sort_by(|a, b| b.1.total_cmp(&a.1));
        modes.into_iter().map(|(slot, _)| slot).collect()
    }

    /// The mode of a pixel that is stored in a place.
    pub fn mode_in(&self, slot: usize, place: (usize, usize)) -> Mode {
        let (group, lane) = self.lane(place);
        let mode = self.mode(group, slot);
        let mean = mode[2 * LANES..].chunks_exact(LANES).map(|mean| mean[lane]).collect();
        Mode { weight: mode[lane], variance: mode[LANES + lane], mean }
    }

    /// The number of background modes of a pixel, which are the heaviest.
    pub fn background_modes(&self, of: &MixtureOfGaussians, place: (usize, usize)) -> usize {
        let (group, lane) = self.lane(place);
        let modes = self.weights(group, lane);
        modes.filter(|mode| self.heavier((group, lane), *mode) < of.background_ratio).count()
    }

    /// The decision about a pixel, as a group of equal pixels meets it.
    pub fn verdict(&self, of: &MixtureOfGaussians, pixel: &[f32], place: (usize, usize)) -> Verdict {
        match *pixel {
            [red, green, blue] => self.verdict_in(of, [red, green, blue], place),
            _ => self.verdict_in(of, [pixel[0]], place),
        }
    }

    fn verdict_in<const C: usize>(&self, of: &MixtureOfGaussians, pixel: [f32; C], place: (usize, usize)) -> Verdict {
        let (group, lane) = self.lane(place);
        let mut cells: Vec<Vec<f32>> = self.modes_of(group).map(<[f32]>::to_vec).collect();
        let mut planes: Vec<&mut [f32]> = cells.iter_mut().map(|mode| &mut mode[..]).collect();
        let (count, rates, pixels) = (planes.len(), Rates::new(of), pixel.map(|level| [level; LANES]));
        let group = Group { planes: &mut planes, place: 0, most: self.most, count, pixels, rates: &rates };
        let Decision { matches, foreground, shadows, shadowed } = group.decide();
        let (ranked, modes) = (self.ranked(place), self.modes(place));
        let rank = |slot: usize| ranked.iter().position(|of| *of == slot);
        let matched = rank(matches.modes[lane] as usize).filter(|_| matches.weights[lane] > 0.0).map(|mode| {
            let (_, step) = rates.weight_after(modes[mode].weight, true);
            let square = group.squares(group.mode(ranked[mode]))[lane];
            let [free_variance, _] = rates.variance_after(modes[mode].variance, square, step);
            Matched { mode, slot: ranked[mode], free_variance }
        });
        let shadow = rank(shadowed[lane].into()).filter(|_| shadows >> lane & 1 == 1);
        let shadow = shadow.and_then(|mode| Some((mode, group.brightness(ranked[mode], lane, rates.darkest?)?)));
        Verdict { modes, is_foreground: foreground >> lane & 1 == 1, matched, shadow }
    }

    /// Returns the distance of a pixel from the nearest background mode in σ; from the heaviest mode if none is
    /// background. The background consists of the heaviest modes, whose weights add up to `background`.
    pub fn distance(&self, frame: &Frame, place: (usize, usize), background: f32) -> f32 {
        self.distance_of(self.value(frame, place), place, background)
    }

    /// Returns the colour of a pixel, or its gray level three times.
    fn value(&self, frame: &Frame, place: (usize, usize)) -> [f32; 3] {
        match (self.channels, frame.color()) {
            (3, Some(color)) => color[place].map(f32::from),
            _ => [f32::from(frame.luma()[place]); 3],
        }
    }

    /// The group of a pixel and its lane there.
    fn lane(&self, (x, y): (usize, usize)) -> (usize, usize) {
        (y * self.size.0.div_ceil(LANES) + x / LANES, x % LANES)
    }

    /// The modes of a pixel that are in use, each with its weight.
    fn weights(&self, group: usize, lane: usize) -> impl Iterator<Item = (usize, f32)> {
        self.modes_of(group).map(move |mode| mode[lane]).enumerate().filter(|(_, weight)| *weight > 0.0)
    }

    /// The weight of all modes of a pixel that are heavier than one of them; of two as heavy, the older place.
    fn heavier(&self, (group, lane): (usize, usize), (index, weight): (usize, f32)) -> f32 {
        let is_before = |(other, heavier): &(usize, f32)| *heavier > weight || (*heavier == weight && *other < index);
        self.weights(group, lane).filter(is_before).map(|(_, weight)| weight).sum()
    }

    /// The distance of a pixel from a mode in σ.
    fn distance_from(&self, (group, lane): (usize, usize), index: usize, pixel: [f32; 3]) -> f32 {
        let mode = self.mode(group, index);
        let means = mode[2 * LANES..].chunks_exact(LANES).map(|mean| mean[lane]);
        let square: f32 = pixel.iter().zip(means).map(|(pixel, mean)| (pixel - mean) * (pixel - mean)).sum();
        (square / mode[LANES + lane]).sqrt()
    }

    fn distance_of(&self, pixel: [f32; 3], place: (usize, usize), background: f32) -> f32 {
        let (group, lane) = self.lane(place);
        let (mut nearest, mut of_heaviest) = (f32::INFINITY, [0.0; 2]);
        for (index, weight) in self.weights(group, lane) {
            let heavier = self.heavier((group, lane), (index, weight));
            let distance = self.distance_from((group, lane), index, pixel);
            if heavier < background {
                nearest = nearest.min(distance);
            }
            if weight > of_heaviest[0] {
                of_heaviest = [weight, distance];
            }
        }
        if nearest.is_finite() { nearest } else { of_heaviest[1] }
    }

    /// Returns a pixel in the channels of the modes.
    pub fn pixel(&self, frame: &Frame, place: (usize, usize)) -> Vec<f32> {
        match (self.channels, frame.color()) {
            (3, Some(color)) => color[place].map(f32::from).to_vec(),
            (channels, _) => vec![f32::from(frame.luma()[place]); channels],
        }
    }

    /// Memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        let planes: usize = self.planes.iter().map(|plane| size_of_val(&plane[..])).sum();
        let packed = self.packed.as_ref().map_or(0, |of| size_of_val(&of.cells[..]) + size_of_val(&of.starts[..]));
        size_of_val(&self.counts[..]) + planes + packed
    }
}

/// A gray picture in colour.
fn as_color(frame: &Frame) -> Frame {
    Frame::rgb(frame.luma().map(|gray| [*gray; 3]))
}

/// The pixels of a group; 0 beyond the edge.
#[inline(always)]
fn gray(frame: &Frame, y: usize, start: usize) -> [[f32; LANES]; 1] {
    let (row, mut pixels) = (&frame.luma().row(y)[start..], [0.0; LANES]);
    pixels.iter_mut().zip(row).for_each(|(pixel, gray)| *pixel = f32::from(*gray));
    [pixels]
}

#[inline(always)]
fn color(frame: &Frame, y: usize, start: usize) -> [[f32; LANES]; 3] {
    let mut pixels = [[0.0; LANES]; 3];
    if let Some(color) = frame.color() {
        let row = &color.row(y)[start..];
        let count = row.len().min(LANES);
        for (channel, pixels) in pixels.iter_mut().enumerate() {
            pixels[..count].iter_mut().zip(row).for_each(|(pixel, color)| *pixel = f32::from(color[channel]));
        }
    }
    pixels
}

widest!(fn in_gray(band: &mut Band<'_>, rates: Rates) = gray_band);
widest!(fn in_color(band: &mut Band<'_>, rates: Rates) = color_band);

#[inline(always)]
fn gray_band(band: &mut Band<'_>, rates: Rates) {
    work::<1>(band, rates, |frame, y, [row]| {
        row.iter_mut().zip(frame.luma().row(y)).for_each(|(to, gray)| *to = *gray);
    });
}

#[inline(always)]
fn color_band(band: &mut Band<'_>, rates: Rates) {
    work::<3>(band, rates, |frame, y, [red, green, blue]| {
        let Some(color) = frame.color() else { return };
        for (((to_red, to_green), to_blue), [r, g, b]) in red.iter_mut().zip(green).zip(blue).zip(color.row(y)) {
            (*to_red, *to_green, *to_blue) = (*r, *g, *b);
        }
    });
}

/// Processes the groups of a band; `split` separates the channels of a row, which are 0 beyond the edge.
#[inline(always)]
fn work<const C: usize>(band: &mut Band<'_>, rates: Rates, split: impl Fn(&Frame, usize, [&mut [u8]; C])) {
    let (in_row, words) = (band.width.div_ceil(LANES), band.width.div_ceil(64));
    let mut rows: [Vec<u8>; C] = std::array::from_fn(|_| vec![0; in_row * LANES]);
    for (row, counts) in band.counts.chunks_mut(in_row).enumerate() {
        split(band.frame, band.first_row + row, rows.each_mut().map(|row| &mut row[..band.width]));
        for (group, count) in counts.iter_mut().enumerate() {
            let start = group * LANES;
            let pixels = rows.each_ref().map(|row| lanes(&row[start..]));
            let (planes, place) = (&mut band.planes[..], (row * in_row + group) * (2 + C) * LANES);
            let mut group = Group { planes, place, most: band.most, count: usize::from(*count), pixels, rates: &rates };
            let (foreground, shadows) = group.take_in();
            *count = group.count as u8;
            let (word, bit) = (row * words + start / 64, start % 64);
            band.mask[word] |= u64::from(foreground) << bit;
            band.shadows[word] |= u64::from(shadows) << bit;
        }
    }
}

/// Returns the first pixels of a row that is long enough.
#[inline(always)]
fn lanes(row: &[u8]) -> [f32; LANES] {
    let mut pixels = [0.0; LANES];
    if let Some(row) = row.first_chunk::<LANES>() {
        for lane in 0..LANES {
            pixels[lane] = f32::from(row[lane]);
        }
    }
    pixels
}

/// A bit for each lane for which `is` holds.
#[inline(always)]
fn bits(is: impl Fn(usize) -> bool) -> u16 {
    let mut bits = [0u32; LANES];
    for (lane, bit) in bits.iter_mut().enumerate() {
        *bit = if is(lane) { 1 << lane } else { 0 };
    }
    bits.iter().fold(0, |all, bit| all | bit) as u16
}

/// Adjacent pixels of a row with their modes.
struct Group<'a, 'b, const C: usize> {
    /// For each mode, the planes of all groups, with the index at which its own begin.
    planes: &'a mut [&'b mut [f32]],
    place: usize,
    most: usize,
    count: usize,
    pixels: [[f32; LANES]; C],
    rates: &'a Rates,
}

/// The matched mode of each pixel.
struct Matches {
    /// Its weight; 0 where there is none.
    weights: [f32; LANES],
    /// Its index.
    modes: [f32; LANES],
}

/// The decision about the pixels of a group, a bit for each.
struct Decision {
    matches: Matches,
    foreground: u16,
    shadows: u16,
    /// The background mode that each shadow lies on.
    shadowed: [u8; LANES],
}

impl<const C: usize> Group<'_, '_, C> {
    /// Classifies and updates the pixels; returns a bit for each foreground pixel and for each shadow.
    #[inline(always)]
    fn take_in(&mut self) -> (u16, u16) {
        let Decision { matches, foreground, shadows, .. } = self.decide();
        self.update(&matches);
        (foreground, shadows)
    }

    /// Classifies the pixels.
    #[inline(always)]
    fn decide(&self) -> Decision {
        let matches = self.matches();
        let heavier = self.heavier(&matches.weights, &matches.modes);
        let background = self.rates.background;
        let foreground = !bits(|lane| (matches.weights[lane] > 0.0) & (heavier[lane] < background));
        let (shadows, shadowed) = match self.rates.darkest {
            // A gray level has no colour to keep.
            Some(darkest) if C == 3 && foreground != 0 => self.shadows(foreground, darkest),
            _ => (0, [0; LANES]),
        };
        Decision { matches, foreground, shadows, shadowed }
    }

    #[inline(always)]
    fn mode(&self, mode: usize) -> &[[f32; LANES]] {
        self.planes[mode][self.place..][..(2 + C) * LANES].as_chunks::<LANES>().0
    }

    #[inline(always)]
    fn mode_mut(&mut self, mode: usize) -> &mut [[f32; LANES]] {
        self.planes[mode][self.place..][..(2 + C) * LANES].as_chunks_mut::<LANES>().0
    }

    /// Returns |I − μ|² of a mode.
    #[inline(always)]
    fn squares(&self, mode: &[[f32; LANES]]) -> [f32; LANES] {
        let mut squares = [0.0; LANES];
        for (pixels, means) in self.pixels.iter().zip(&mode[2..2 + C]) {
            for lane in 0..LANES {
                let off = pixels[lane] - means[lane];
                squares[lane] += off * off;
            }
        }
        squares
    }

    /// Returns the heaviest mode that matches each pixel; of two of equal weight, the first.
    #[inline(always)]
    fn matches(&self) -> Matches {
        let mut found = Matches { weights: [0.0; LANES], modes: [-1.0; LANES] };
        for index in 0..self.count {
            let mode = self.mode(index);
            let squares = self.squares(mode);
            for lane in 0..LANES {
                let (weight, variance) = (mode[0][lane], mode[1][lane]);
                let is_better = (squares[lane] <= self.rates.limit * variance) & (weight > found.weights[lane]);
                found.weights[lane] = if is_better { weight } else { found.weights[lane] };
                found.modes[lane] = if is_better { index as f32 } else { found.modes[lane] };
            }
        }
        found
    }

    /// Returns the total weight of all modes before the one of this weight and index.
    #[inline(always)]
    fn heavier(&self, weights: &[f32; LANES], modes: &[f32; LANES]) -> [f32; LANES] {
        let mut sum = [0.0; LANES];
        for index in 0..self.count {
            let mode = self.mode(index);
            for lane in 0..LANES {
                let weight = mode[0][lane];
                let is_before = (weight > weights[lane]) | ((weight == weights[lane]) & ((index as f32) < modes[lane]));
                sum[lane] += if is_before { weight } else { 0.0 };
            }
        }
        sum
    }

    /// Returns the foreground pixels that are shadows on a background mode, and the first such mode of each.
    fn shadows(&self, foreground: u16, darkest: f32) -> (u16, [u8; LANES]) {
        let (mut shadows, mut shadowed) = (0, [0; LANES]);
        for index in 0..self.count {
            let mode = self.mode(index);
            let heavier = self.heavier(&mode[0], &[index as f32; LANES]);
            for lane in (0..LANES).filter(|lane| foreground >> lane & 1 == 1) {
                let is_background = mode[0][lane] > 0.0 && heavier[lane] < self.rates.background;
                let is_new = is_background && shadows >> lane & 1 == 0;
                if is_new && self.brightness(index, lane, darkest).is_some() {
                    shadows |= 1 << lane;
                    shadowed[lane] = index as u8;
                }
            }
        }
        (shadows, shadowed)
    }

    /// Returns the brightness of a pixel as a share of that of a mode, if it may be a shadow on it.
    #[inline(always)]
    fn brightness(&self, index: usize, lane: usize, darkest: f32) -> Option<f32> {
        let mode = self.mode(index);
        let (pixel, mean) = (self.pixels.map(|p| p[lane]), std::array::from_fn::<_, C, _>(|c| mode[2 + c][lane]));
        shadow_brightness(pixel, mean, ShadowLimits { darkest, limit: self.rates.limit * mode[1][lane] })
    }

    /// Updates the modes with the pixels.
    #[inline(always)]
    fn update(&mut self, matches: &Matches) {
        let rates = *self.rates;
        let mut total = [0.0f32; LANES];
        for index in 0..self.count {
            let squares = self.squares(self.mode(index));
            let pixels = self.pixels;
            let mode = self.mode_mut(index);
            let mut steps = [0.0; LANES];
            for lane in 0..LANES {
                let is_match = matches.modes[lane] == index as f32;
                let (weight, step) = rates.weight_after(mode[0][lane], is_match);
                steps[lane] = step;
                mode[0][lane] = weight;
                total[lane] += weight;
                let [_, variance] = rates.variance_after(mode[1][lane], squares[lane], step);
                mode[1][lane] = if is_match { variance } else { mode[1][lane] };
            }
            for (means, pixels) in mode[2..2 + C].iter_mut().zip(&pixels) {
                for lane in 0..LANES {
                    means[lane] += steps[lane] * (pixels[lane] - means[lane]);
                }
            }
        }
        self.normalise(matches, &total);
        let new = bits(|lane| matches.weights[lane] == 0.0);
        if rates.rate > 0.0 && new != 0 {
            (0..LANES).filter(|lane| new >> lane & 1 == 1).for_each(|lane| self.begin(lane));
        }
    }

    /// Normalises the weights where a mode matches, and counts the modes left.
    #[inline(always)]
    fn normalise(&mut self, matches: &Matches, total: &[f32; LANES]) {
        let mut scale = [1.0; LANES];
        for lane in 0..LANES {
            scale[lane] = if matches.weights[lane] > 0.0 { 1.0 / total[lane] } else { 1.0 };
        }
        let mut count = 0;
        for index in 0..self.count {
            let weights = &mut self.mode_mut(index)[0];
            for lane in 0..LANES {
                weights[lane] *= scale[lane];
            }
            count = if bits(|lane| weights[lane] > 0.0) != 0 { index + 1 } else { count };
        }
        self.count = count;
    }

    /// Adds a mode for a pixel without a match, in a free slot or in place of the mode of least weight.
    fn begin(&mut self, lane: usize) {
        let weight = |group: &Self, index: usize| group.mode(index)[0][lane];
        let lightest = (0..self.count).reduce(|a, b| if weight(self, b) < weight(self, a) { b } else { a });
        let place = match lightest {
            Some(index) if weight(self, index) == 0.0 || self.count == self.most => index,
            _ => self.count,
        };
        self.count = self.count.max(place + 1);
        self.mode_mut(place)[0][lane] = 0.0;
        let others: f32 = (0..self.count).map(|index| weight(self, index)).sum();
        let Rates { rate, first, .. } = *self.rates;
        if others > 0.0 {
            (0..self.count).for_each(|index| self.mode_mut(index)[0][lane] *= (1.0 - rate) / others);
        }
        let pixel = self.pixels.map(|pixels| pixels[lane]);
        let mode = self.mode_mut(place);
        mode[0][lane] = if others > 0.0 { rate } else { 1.0 };
        mode[1][lane] = first;
        mode[2..2 + C].iter_mut().zip(pixel).for_each(|(mean, pixel)| mean[lane] = pixel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn a_distance_is_that_of_the_modes_one_by_one_packed_or_not() {
        let of = MixtureOfGaussians { learning_rate: 0.2, ..MixtureOfGaussians::default() };
        let value = |x: usize, y: usize, t: usize| {
            (40 + (x * 7 + y * 13) % 50 + if t.is_multiple_of(3) { 90 } else { t % 5 }) as u8
        };
        for in_color in [false, true] {
            let frame = |t: usize| match in_color {
                true => Frame::rgb(Grid::from_fn(37, 5, |x, y| [value(x, y, t), value(y, x, t), 90])),
                false => Frame::gray(Grid::from_fn(37, 5, |x, y| value(x, y, t))),
            };
            let mut model = Mixture::new(&of, &frame(0));
            for t in 1..9 {
                model.subtract(&of, &frame(t), &Threads::single());
            }
            let (next, packed) = (frame(9), model.packed());
            for place in (0..5).flat_map(|y| (0..37).map(move |x| (x, y))) {
                let (modes, pixel) = (model.modes(place), model.pixel(&next, place));
                let mut heavier = 0.0;
                let mut expected = f32::INFINITY;
                for mode in &modes {
                    if heavier < of.background_ratio {
                        expected = expected.min(mode.distance(&pixel));
                    }
                    heavier += mode.weight;
                }
                let found = model.distance(&next, place, of.background_ratio);
                assert!((found - expected).abs() <= 1e-5 * expected.abs(), "{place:?}: {found}, {expected}");
                assert_eq!(packed.distance(&next, place, of.background_ratio), found);
            }
            assert!(packed.bytes() < model.bytes() && model.clone().packed() == packed);
            model.subtract(&of, &next, &Threads::single());
            let mut again = packed;
            again.subtract(&of, &next, &Threads::single());
            assert_eq!(again.packed().modes((3, 2)), model.modes((3, 2)));
        }
    }
}
