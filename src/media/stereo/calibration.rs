//! Calibrations of rectified pairs: KITTI's and Middlebury's `calib.txt`.

use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::Calibration;

use crate::files;
use crate::media::input;
use crate::media::names::file_name;
use crate::media::sequence::parent;

/// The cameras of KITTI that the views are from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cameras {
    /// 0 and 1.
    Gray,
    /// 2 and 3.
    Color,
    /// Unknown: 2 and 3 if the file has them.
    Any,
}

impl Cameras {
    /// Those that the folder of `frame` is named after: `image_0`, or `image_00/data`.
    pub fn of(frame: &Path) -> Self {
        let folder = files::canonicalize(parent(frame)).unwrap_or_else(|_| parent(frame).into());
        let folders = folder.ancestors().take(2).map(file_name);
        let number = folders.filter_map(|name| name.strip_prefix("image_")?.parse::<u32>().ok()).next();
        match number {
            Some(0 | 1) => Self::Gray,
            Some(2 | 3) => Self::Color,
            _ => Self::Any,
        }
    }
}

/// The calibration in the file at `path`.
///
/// # Errors
/// One sentence, without the path, if it has neither format.
pub(super) fn read(path: &Path, cameras: Cameras) -> Result<Calibration, Error> {
    let text = input::text(path)?;
    middlebury(&text).or_else(|| kitti(&text, cameras)).ok_or_else(|| {
        Error::new(
            "it is no calibration of a rectified pair: Middlebury's has cam0=[…], cam1=[…] and baseline=, KITTI's the rows P0: to P3: \
             of 12 numbers",
        )
    })
}

/// All numbers in `text`.
fn numbers(text: &str) -> Vec<f64> {
    let parts = text.split(|c: char| c.is_whitespace() || "[];,".contains(c));
    parts.filter_map(|part| part.parse().ok()).collect()
}

/// Middlebury 2014: camera matrices by rows, baseline in mm.
fn middlebury(text: &str) -> Option<Calibration> {
    let value = |key: &str| {
        text.lines().find_map(|line| Some(numbers(line.trim().strip_prefix(key)?.trim_start().strip_prefix('=')?)))
    };
    let ([left, right], baseline) = ([value("cam0")?, value("cam1")?], *value("baseline")?.first()?);
    if left.len() != 9 || right.len() != 9 {
        return None;
    }
    let offset = value("doffs").and_then(|value| value.first().copied()).unwrap_or(right[2] - left[2]);
    Some(Calibration {
        focal_px: left[0],
        baseline_m: baseline / 1000.0,
        principal_px: [left[2], left[5]],
        offset_px: offset,
    })
}

/// KITTI: 3×4 projection matrices by rows; the fourth column holds the focal length times the position in m.
fn kitti(text: &str, cameras: Cameras) -> Option<Calibration> {
    let matrix = |camera: u32| {
        let keys = [format!("P{camera}:"), format!("P_rect_{camera:02}:")];
        let row = |line: &str| keys.iter().find_map(|key| Some(numbers(line.trim().strip_prefix(key.as_str())?)));
        text.lines().find_map(row).filter(|numbers| numbers.len() == 12)
    };
    let pair = |left: u32| Some([matrix(left)?, matrix(left + 1)?]);
    let [left, right] = match cameras {
        Cameras::Gray => pair(0)?,
        Cameras::Color => pair(2)?,
        Cameras::Any => pair(2).or_else(|| pair(0))?,
    };
    Some(Calibration {
        focal_px: left[0],
        baseline_m: (left[3] - right[3]) / left[0],
        principal_px: [left[2], left[6]],
        offset_px: right[2] - left[2],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str, cameras: Cameras) -> Result<Calibration, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("calib.txt");
        std::fs::write(&path, text).unwrap();
        read(&path, cameras)
    }

    #[test]
    fn middlebury_is_in_millimetres_and_has_an_offset() {
        let text = "cam0=[3979.911 0 1244.772; 0 3979.911 1019.507; 0 0 1]\n\
                    cam1=[3979.911 0 1369.115; 0 3979.911 1019.507; 0 0 1]\n\
                    doffs=124.343\nbaseline=193.001\nwidth=2964\nheight=1988\nndisp=270\n";
        let found = parsed(text, Cameras::Any).unwrap();
        assert_eq!((found.focal_px, found.baseline_m), (3979.911, 0.193_001));
        assert_eq!((found.principal_px, found.offset_px), ([1244.772, 1019.507], 124.343));
        // Without it, the offset follows from the principal points.
        let found = parsed(&text.replace("doffs", "other"), Cameras::Any).unwrap();
        assert!((found.offset_px - 124.343).abs() < 1e-9);
    }

    #[test]
    fn kitti_has_four_cameras() {
        let row = |name: &str, f: f64, shift: f64| format!("{name}: {f} 0 609.5 {shift} 0 {f} 172.8 0 0 0 1 0\n");
        let text =
            row("P0", 720.0, 0.0) + &row("P1", 720.0, -388.8) + &row("P2", 700.0, 42.0) + &row("P3", 700.0, -343.0);
        let baselines = [Cameras::Gray, Cameras::Color, Cameras::Any].map(|c| parsed(&text, c).unwrap().baseline_m);
        assert!(baselines.iter().zip([0.54, 0.55, 0.55]).all(|(a, b)| (a - b).abs() < 1e-12), "{baselines:?}");
        assert_eq!(parsed(&text, Cameras::Gray).unwrap().principal_px, [609.5, 172.8]);
        let rectified = text.replace('P', "P_rect_0");
        assert_eq!(parsed(&rectified, Cameras::Color).unwrap(), parsed(&text, Cameras::Color).unwrap());
        let of = |path: &str| Cameras::of(Path::new(path));
        assert_eq!(
            ["a/image_0/1.png", "a/image_02/data/1.png", "a/b.png"].map(of),
            [Cameras::Gray, Cameras::Color, Cameras::Any]
        );
    }

    #[test]
    fn anything_else_is_refused_with_both_formats() {
        for text in ["", "P0: 1 2 3\nP1: 1 2 3\n", "cam0=[1 2]\ncam1=[1 2]\nbaseline=3\n"] {
            let told = parsed(text, Cameras::Any).unwrap_err().to_string();
            assert!(told.contains("cam0") && told.contains("P0:"), "{told}");
        }
    }
}
