//! The current unit of SURF, with the data that its explanation needs.

use std::sync::Arc;

use super::hessian::{LAYERS, Layer};
use super::{Event, MIDDLE, Maximum, Part, Surf};
use crate::methods::features::integral::Integral;
use crate::run::Seen;

/// The current unit, with the data that its explanation needs.
pub(super) enum Probe<'a> {
    Integral,
    Filter(Filtered<'a>),
    Search(Searched<'a>),
    Choice(&'a Arc<Vec<Maximum>>),
    Keypoint(Described<'a>),
}

/// A layer and the pixel whose filters are shown.
pub(super) struct Filtered<'a> {
    pub integral: &'a Integral,
    pub octave: usize,
    pub layer: &'a Arc<Layer>,
    /// The filter at work, 3 at the determinant.
    pub part: usize,
    /// A sample at which the filters fit, if there is one.
    pub sample: Option<(usize, usize)>,
}

/// A middle layer that is searched.
pub(super) struct Searched<'a> {
    pub octave: usize,
    pub layers: [&'a Layer; 3],
    /// The sample at work.
    pub sample: Option<(usize, usize)>,
}

/// A keypoint that is described.
pub(super) struct Described<'a> {
    pub index: usize,
    pub maximum: &'a Maximum,
    pub sums: Vec<[f32; 2]>,
    pub angle_rad: Option<f32>,
    pub subregions: Vec<[f32; 4]>,
    pub length: Option<f32>,
}

impl Surf {
    pub(super) fn probe<'a>(&self, seen: &'a Seen<Self>) -> Option<Probe<'a>> {
        let state = seen.before;
        seen.events.last()?;
        match state.part() {
            Part::Integral => Some(Probe::Integral),
            Part::Layer(index) => {
                let layer = seen.events.iter().find_map(|event| match event {
                    Event::Filtered(layer) => Some(layer),
                    _ => None,
                })?;
                let fits = |sample: &(usize, usize)| layer.fits(*sample, state.picture.size());
                let pointed = seen.point().and_then(|at| layer.nearest(at)).filter(fits);
                let sample = pointed.or_else(|| layer.strongest());
                let (octave, part) = (index / LAYERS, seen.events.len() - 1);
                Some(Probe::Filter(Filtered { integral: state.integral.as_ref()?, octave, layer, part, sample }))
            }
            Part::Search(index) => {
                let sample = seen.events.iter().rev().find_map(|event| match event {
                    Event::Compared(sample, _) | Event::Refined(sample, _) => Some(*sample),
                    _ => None,
                });
                Some(Probe::Search(Searched { octave: index / MIDDLE, layers: state.three(index)?, sample }))
            }
            Part::Choice => seen.events.iter().find_map(|event| match event {
                Event::Ranked(maxima) => Some(Probe::Choice(maxima)),
                _ => None,
            }),
            Part::Keypoint(index) => Some(Probe::Keypoint(described(seen, index, state.keypoint(index)?))),
        }
    }
}

/// The current keypoint as known from its events.
fn described<'a>(seen: &Seen<Surf>, index: usize, maximum: &'a Maximum) -> Described<'a> {
    let mut of = Described { index, maximum, sums: Vec::new(), angle_rad: None, subregions: Vec::new(), length: None };
    for event in seen.events {
        match event {
            Event::Sector(sum) => of.sums.push(*sum),
            Event::Oriented(angle_rad) => of.angle_rad = Some(*angle_rad),
            Event::Subregion(sums) => of.subregions.push(*sums),
            Event::UnitLength(length) => of.length = Some(*length),
            _ => {}
        }
    }
    of
}
