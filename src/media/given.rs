//! Files and values given explicitly for a clip, instead of those found beside it.

use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;

use super::picture::Contrast;

/// Ground truth, detections and a right view given explicitly for a clip, instead of files found beside it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    /// The ground truth.
    pub truth: Option<PathBuf>,
    /// The detections, as MOTChallenge rows.
    pub detections: Option<PathBuf>,
    /// The right view of a rectified pair of cameras.
    pub right: Option<RightView>,
    /// The calibration of both cameras.
    pub calibration: Option<GivenCalibration>,
    /// Gray levels per px of disparity of a true disparity in 8 bits.
    pub disparity_scale: Option<f32>,
    /// The folder of measured depths.
    pub depths: Option<PathBuf>,
    /// Units of a measured depth per m.
    pub depth_scale: Option<f32>,
    /// The range of 16-bit samples that is shown; by default that of the whole clip.
    pub contrast: Option<Contrast>,
}

impl Given {
    /// Returns these files with those of `later` in their place.
    #[must_use]
    pub fn then(self, later: Self) -> Self {
        Self {
            truth: later.truth.or(self.truth),
            detections: later.detections.or(self.detections),
            right: later.right.or(self.right),
            calibration: later.calibration.or(self.calibration),
            disparity_scale: later.disparity_scale.or(self.disparity_scale),
            depths: later.depths.or(self.depths),
            depth_scale: later.depth_scale.or(self.depth_scale),
            contrast: later.contrast.or(self.contrast),
        }
    }

    /// The paths of these files.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        let Self { truth, detections, right, calibration, depths, .. } = self;
        let right = right.as_ref().filter(|view| **view != RightView::SideBySide).map(RightView::path);
        let calibration = calibration.as_ref().and_then(GivenCalibration::path);
        [truth.as_deref(), detections.as_deref(), right, calibration, depths.as_deref()].into_iter().flatten()
    }

    /// The same with `f` applied to the path of each file.
    #[must_use]
    pub fn map_path(self, f: impl Fn(&Path) -> PathBuf) -> Self {
        let Self { truth, detections, right, calibration, disparity_scale, depths, depth_scale, contrast } = self;
        Self {
            truth: truth.map(|path| f(&path)),
            detections: detections.map(|path| f(&path)),
            right: right.map(|view| view.map_path(&f)),
            calibration: calibration.map(|given| given.map_path(&f)),
            disparity_scale,
            depths: depths.map(|path| f(&path)),
            depth_scale,
            contrast,
        }
    }
}

/// The units of a depth per m that were `written`, and read as `scale`.
///
/// # Errors
/// One sentence if it is no positive number.
pub fn depth_scale(scale: Option<f32>, written: impl Display) -> Result<f32, Error> {
    let why = || Error::new(format!("the scale of depths is a positive number of units per m, not {written}"));
    scale.filter(|scale| scale.is_finite() && *scale > 0.0).ok_or_else(why)
}

/// The gray levels per px of a disparity that were `written`, and read as `scale`.
///
/// # Errors
/// One sentence if it is no positive number.
pub fn disparity_scale(scale: Option<f32>, written: impl Display) -> Result<f32, Error> {
    let why =
        || Error::new(format!("the scale of a disparity is a positive number of gray levels per px, not {written}"));
    scale.filter(|scale| scale.is_finite() && *scale > 0.0).ok_or_else(why)
}

/// A right view given explicitly.
#[derive(Clone, Debug, PartialEq)]
pub enum RightView {
    /// A clip of its own: pictures, a folder of them, or a video.
    File(PathBuf),
    /// The right half of each frame; the left half is the left view.
    SideBySide,
}

impl RightView {
    /// The word for [`RightView::SideBySide`].
    pub const SIDE_BY_SIDE: &'static str = "side-by-side";

    /// The view at `path`, or that of side-by-side frames.
    pub fn of(path: &Path) -> Self {
        if path == Path::new(Self::SIDE_BY_SIDE) { Self::SideBySide } else { Self::File(path.into()) }
    }

    /// The same with `f` applied to its path, if it has one.
    #[must_use]
    pub fn map_path(self, f: impl FnOnce(&Path) -> PathBuf) -> Self {
        match self {
            Self::File(path) => Self::File(f(&path)),
            Self::SideBySide => Self::SideBySide,
        }
    }

    /// Its path, or the word for side-by-side frames.
    pub fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::SideBySide => Path::new(Self::SIDE_BY_SIDE),
        }
    }
}

/// A calibration given explicitly.
#[derive(Clone, Debug, PartialEq)]
pub enum GivenCalibration {
    /// A `calib.txt` of KITTI or Middlebury.
    File(PathBuf),
    /// Typed numbers.
    Typed {
        /// Focal length in px.
        focal_px: f64,
        /// Baseline in m.
        baseline_m: f64,
        /// Principal point in px; the centre of the picture by default.
        principal_px: Option<[f64; 2]>,
    },
}

impl GivenCalibration {
    /// Two numbers F,B or four F,B,CX,CY are typed; anything else is a path.
    pub fn of(text: &Path) -> Self {
        let numbers = |text: &str| text.split(',').map(|part| part.trim().parse().ok()).collect::<Option<Vec<f64>>>();
        match text.to_str().and_then(numbers).as_deref() {
            Some(&[focal_px, baseline_m]) => Self::Typed { focal_px, baseline_m, principal_px: None },
            Some(&[focal_px, baseline_m, x, y]) => Self::Typed { focal_px, baseline_m, principal_px: Some([x, y]) },
            _ => Self::File(text.into()),
        }
    }

    /// Its path, if it has one.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Typed { .. } => None,
        }
    }

    /// The same with `f` applied to its path, if it has one.
    #[must_use]
    pub fn map_path(self, f: impl FnOnce(&Path) -> PathBuf) -> Self {
        match self {
            Self::File(path) => Self::File(f(&path)),
            typed => typed,
        }
    }
}

/// As [`GivenCalibration::of`] reads it.
impl fmt::Display for GivenCalibration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Typed { focal_px, baseline_m, principal_px } => {
                write!(f, "{focal_px},{baseline_m}")?;
                principal_px.map_or(Ok(()), |[x, y]| write!(f, ",{x},{y}"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_numbers_are_read_as_they_are_written() {
        let of = |text: &str| GivenCalibration::of(Path::new(text));
        let typed = |principal_px| GivenCalibration::Typed { focal_px: 721.5, baseline_m: 0.54, principal_px };
        assert_eq!(of("721.5,0.54"), typed(None));
        assert_eq!(of("721.5, 0.54,609.5,172.5"), typed(Some([609.5, 172.5])));
        assert_eq!(of("calib,2.txt"), GivenCalibration::File("calib,2.txt".into()));
        for text in ["721.5,0.54", "721.5,0.54,609.5,172.5", "calib.txt"] {
            assert_eq!(of(text).to_string(), text);
        }
    }
}
