//! Descriptors of keypoints that a detector has found without describing them.

use std::sync::Arc;

use crate::base::{Error, Threads};
use crate::choices;
use crate::geometry::Gray;
use crate::methods::features::brief::{self, Moments};
use crate::methods::features::haar::{self, Blob};
use crate::methods::features::integral::Integral;
use crate::methods::scale_space::{Descriptor as Gradients, Histogram, Place, ScaleSpace, Shape};
use crate::products::keypoints::Descriptor;
use crate::products::{Feature, Keypoint, PointField};

choices! {
    /// Descriptor of the keypoints.
    pub enum DescriptorKind {
        /// That of the detector, if it has one; else patches.
        Auto = "auto" "of the detector",
        /// SIFT: histograms of gradient directions, compared by Euclidean distance.
        Sift = "sift" "SIFT",
        /// SURF: sums of Haar wavelet responses, compared by Euclidean distance.
        Surf = "surf" "SURF",
        /// ORB: 256 comparisons of pairs of windows on the picture itself, turned by the orientation, compared by Hamming distance.
        Orb = "orb" "ORB",
        /// Upright patches of gray values.
        Patch = "patch" "Patches",
    }
}

impl DescriptorKind {
    /// Whether patches are compared, with some detector.
    pub(super) fn may_be_patches(self) -> bool {
        matches!(self, Self::Auto | Self::Patch)
    }

    /// Whether a detector of this id computes it by itself.
    pub fn is_of(self, id: &str) -> bool {
        matches!((self, id), (Self::Sift, "sift") | (Self::Surf, "surf") | (Self::Orb, "orb"))
    }
}

choices! {
    /// Comparison of patches.
    pub enum PatchCost {
        /// Root of the sum of squared differences.
        Ssd = "ssd" "SSD",
        /// Zero-mean normalised cross-correlation: invariant to gain and offset. The distance is √(2 − 2 ZNCC).
        Zncc = "zncc" "ZNCC",
    }
}

/// Keypoints of a frame with a descriptor each.
#[derive(Clone, Debug)]
pub struct Described {
    /// The keypoints.
    pub points: Vec<Feature>,
    /// Their detection results, each with a descriptor.
    pub keypoints: Vec<Keypoint>,
}

impl Described {
    /// Memory of keypoints and descriptors in bytes.
    pub fn bytes(&self) -> usize {
        self.points.len() * 700
    }
}

/// The descriptor that describes keypoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Describe {
    /// The descriptor.
    pub kind: DescriptorKind,
    /// The patches, if these are the descriptor.
    pub patches: Patches,
}

/// Square patches around keypoints, upright and of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patches {
    /// Half the side without the middle, in px.
    pub reach: usize,
    /// The distance of two patches.
    pub cost: PatchCost,
}

impl Describe {
    /// Describes the keypoints of a picture that was found by the detector called `id`. Keypoints whose window leaves the picture are
    /// left out.
    ///
    /// # Errors
    /// If their own descriptors are asked for and there are none.
    pub fn describe(
        &self,
        (picture, field): (&Gray, PointField),
        id: &str,
        threads: &Threads,
    ) -> Result<Described, Error> {
        let PointField { points, mut keypoints, .. } = field;
        keypoints.resize(points.len(), Keypoint::default());
        let has_own = keypoints.iter().all(|keypoint| keypoint.descriptor.is_some()) && !keypoints.is_empty();
        let kind = match (self.kind, has_own) {
            (DescriptorKind::Auto, false) => DescriptorKind::Patch,
            (kind, _) => kind,
        };
        let is_own = kind == DescriptorKind::Auto || (kind.is_of(id) && has_own);
        if is_own || points.is_empty() {
            return Ok(Described { points, keypoints });
        }
        let descriptors: Vec<Option<Descriptor>> = match kind {
            DescriptorKind::Sift => self.gradients(picture, (&points, &mut keypoints), threads),
            DescriptorKind::Surf => wavelets(picture, (&points, &mut keypoints), threads),
            DescriptorKind::Orb => comparisons(picture, (&points, &mut keypoints), threads),
            _ => threads.map(points.len(), |i| self.patches.around(picture, points[i].at)),
        };
        let described = points.into_iter().zip(keypoints).zip(descriptors);
        let known = described.filter_map(|((point, keypoint), descriptor)| {
            Some((point, Keypoint { descriptor: Some(descriptor?), ..keypoint }))
        });
        let (points, keypoints) = known.unzip();
        Ok(Described { points, keypoints })
    }

    /// SIFT descriptors at the scale of each keypoint, turned by its orientation; both are set where the detector has not.
    fn gradients(
        &self,
        picture: &Gray,
        (points, keypoints): (&[Feature], &mut [Keypoint]),
        threads: &Threads,
    ) -> Vec<Option<Descriptor>> {
        let shape = Shape { scales: 3, sigma_px: 1.6, is_doubled: false, octaves: 8 };
        let space = ScaleSpace::of(picture, &shape, threads);
        let place = |i: usize, keypoint: &Keypoint| {
            let sigma = keypoint.scale_px.unwrap_or(USUAL_PX).max(shape.sigma_px);
            // The Gaussian image with the standard deviation nearest to that of the keypoint.
            let steps = ((sigma / shape.sigma_px).log2() * shape.scales as f32).round().max(0.0) as usize;
            let octave = (steps / shape.scales).min(space.octaves.len() - 1);
            let level = (steps - octave * shape.scales).min(shape.levels() - 1);
            let pixel = shape.pixel_px(octave);
            (octave, level, Place { at: points[i].at.map(|c| c / pixel), sigma_px: sigma / pixel, angle_rad: 0.0 })
        };
        let described = threads.map(points.len(), |i| {
            let (octave, level, place) = place(i, &keypoints[i]);
            let image = &space.octaves[octave].gaussians[level];
            let (x, y) = image.cell_at(place.at)?;
            let angle_rad = keypoints[i].angle_rad.unwrap_or_else(|| {
                let histogram = Histogram::around(image, (x, y), place.sigma_px);
                let highest = histogram.peaks().into_iter().max_by(|a, b| a.share.total_cmp(&b.share));
                highest.map_or(0.0, |peak| peak.angle_rad)
            });
            let entries = Gradients::around(image, &Place { angle_rad, ..place }).finished().0;
            Some((angle_rad, Descriptor::Reals(Arc::new(entries))))
        });
        let of_one = |(keypoint, described): (&mut Keypoint, Option<(f32, Descriptor)>)| {
            let (angle_rad, descriptor) = described?;
            keypoint.angle_rad = Some(angle_rad);
            keypoint.scale_px = Some(keypoint.scale_px.unwrap_or(USUAL_PX));
            Some(descriptor)
        };
        keypoints.iter_mut().zip(described).map(of_one).collect()
    }
}

/// Smallest length of a patch without its mean that is not flat, in gray levels.
const LEAST_LENGTH: f32 = 0.5;

/// Standard deviation of keypoints without scale, in px.
const USUAL_PX: f32 = 2.0;

/// SURF descriptors at the scale of each keypoint, turned by its orientation; both are set where the detector has not.
fn wavelets(
    picture: &Gray,
    (points, keypoints): (&[Feature], &mut [Keypoint]),
    threads: &Threads,
) -> Vec<Option<Descriptor>> {
    let integral = Integral::of(picture);
    let of_one = |i: usize| {
        let scale = keypoints[i].scale_px.unwrap_or(USUAL_PX);
        haar::described(&integral, Blob { at: points[i].at, scale }, keypoints[i].angle_rad)
    };
    let described: Vec<(f32, Vec<f32>)> = threads.map(points.len(), of_one);
    let set = |(keypoint, (angle_rad, values)): (&mut Keypoint, (f32, Vec<f32>))| {
        (keypoint.angle_rad, keypoint.scale_px) = (Some(angle_rad), Some(keypoint.scale_px.unwrap_or(USUAL_PX)));
        Some(Descriptor::Reals(values.into()))
    };
    keypoints.iter_mut().zip(described).map(set).collect()
}

/// Rotated BRIEF descriptors of patches of the usual side on the picture itself; none where the patch leaves the picture. The orientation is
/// that of the intensity centroid, by which the pattern is made to be turned.
fn comparisons(
    picture: &Gray,
    (points, keypoints): (&[Feature], &mut [Keypoint]),
    threads: &Threads,
) -> Vec<Option<Descriptor>> {
    /// Radius of the patch of ORB in px.
    const RADIUS: usize = 15;
    let (integral, pattern) = (Integral::of(picture), brief::pattern(RADIUS));
    let of_one = |i: usize| {
        let (x, y) = picture.cell_at(points[i].at)?;
        let fits = |c: usize, extent: usize| c >= RADIUS && c + RADIUS < extent;
        (fits(x, picture.width()) && fits(y, picture.height())).then(|| {
            let moments = Moments::of(picture, (x, y), RADIUS);
            let bits = brief::describe(&integral, (x, y), (&pattern, moments.direction()), |_, _| {});
            (moments.angle_rad(), Descriptor::Bits(bits.to_vec().into()))
        })
    };
    let described: Vec<Option<(f32, Descriptor)>> = threads.map(points.len(), of_one);
    let set = |(keypoint, described): (&mut Keypoint, Option<(f32, Descriptor)>)| {
        let (angle_rad, descriptor) = described?;
        keypoint.angle_rad = Some(angle_rad);
        Some(descriptor)
    };
    keypoints.iter_mut().zip(described).map(set).collect()
}

impl Patches {
    /// The patch around a position, as its descriptor; `None` if it leaves the picture, and for the ZNCC if it is flat.
    fn around(&self, picture: &Gray, at: [f32; 2]) -> Option<Descriptor> {
        let (x, y) = picture.cell_at(at)?;
        let reach = self.reach;
        let is_inside = x >= reach && y >= reach && x + reach < picture.width() && y + reach < picture.height();
        if !is_inside {
            return None;
        }
        let rows = (y - reach..=y + reach).flat_map(|j| &picture.row(j)[x - reach..=x + reach]);
        let mut values: Vec<f32> = rows.map(|value| f32::from(*value)).collect();
        if self.cost == PatchCost::Zncc {
            let mean = values.iter().sum::<f32>() / values.len() as f32;
            values.iter_mut().for_each(|value| *value -= mean);
            let length = values.iter().map(|value| value * value).sum::<f32>().sqrt();
            // A flat patch correlates with none: the length of any other is at least that of one gray level.
            if length < LEAST_LENGTH {
                return None;
            }
            values.iter_mut().for_each(|value| *value /= length);
        }
        Some(Descriptor::Reals(values.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn normalised_patches_do_not_depend_on_gain_and_offset() {
        let picture = Grid::from_fn(20, 20, |x, y| (x * x + 3 * y) as u8 / 4);
        let brighter = picture.map(|value| value * 2 + 30);
        let of = |picture: &Gray, cost| Patches { reach: 3, cost }.around(picture, [9.2, 10.4]).expect("inside");
        let apart = |cost| of(&picture, cost).distance(&of(&brighter, cost)).expect("patches of one size");
        assert!(apart(PatchCost::Zncc) < 1e-3 && apart(PatchCost::Ssd) > 100.0);
        assert!(Patches { reach: 3, cost: PatchCost::Ssd }.around(&picture, [2.0, 10.0]).is_none());
    }

    #[test]
    fn flat_patches_have_no_correlation() {
        let flat: Gray = Grid::new(20, 20, 97);
        let around = |cost| Patches { reach: 3, cost }.around(&flat, [9.0, 9.0]);
        assert!(around(PatchCost::Zncc).is_none() && around(PatchCost::Ssd).is_some());
        let mut spot = flat.clone();
        spot[(9, 9)] = 98;
        assert!(Patches { reach: 3, cost: PatchCost::Zncc }.around(&spot, [9.0, 9.0]).is_some());
    }
}
