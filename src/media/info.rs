//! The description of a clip, as text and as JSON.

use std::fmt;

use motionscope_core::base::words::fixed;
use motionscope_core::data::{Calibration, Clip};
use serde::Serialize;

/// The description of a clip that `motionscope info` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Number of frames; `None` if counting requires decoding the whole file.
    pub frames: Option<usize>,
    /// Mean frames per second, if the clip says.
    pub fps: Option<f64>,
    /// Duration in seconds, if frames and rate are known.
    pub seconds: Option<f64>,
    /// The container format.
    pub container: String,
    /// How the frames are coded.
    pub codec: String,
    /// Kinds of truth that come with the clip.
    pub truth: Vec<&'static str>,
    /// The files of each kind of ground truth, unless computed.
    pub truth_files: Vec<String>,
    /// The name of the right view as found from the left one, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<String>,
    /// Whether depths were measured beside the frames.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub depths: bool,
    /// The calibration of both views, if it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<Cameras>,
    /// The frames that are identical to the frame before them; `None` where frames were not compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeats: Option<Repeats>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Frames that are identical to the frame before them, as recorders and converters of rates leave them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Repeats {
    /// The number of frames that are identical to the frame before.
    pub identical: usize,
    /// The number of frames that were compared with the frame before.
    pub compared: usize,
}

impl Repeats {
    /// Compares the first frames of `clip`, `most` pairs at most. A frame that cannot be read is identical to none.
    pub fn of(clip: &Clip, most: usize) -> Self {
        let pairs = clip.info().frames.map_or(most, |frames| frames.saturating_sub(1)).min(most);
        let mut repeats = Self { identical: 0, compared: 0 };
        let mut before = clip.frame(0).ok();
        for t in 1..=pairs {
            let frame = clip.frame(t).ok();
            if frame.is_none() && clip.has_frame(t) != Ok(true) {
                break;
            }
            repeats.compared += 1;
            repeats.identical += usize::from(frame.is_some() && frame == before);
            before = frame;
        }
        repeats
    }
}

/// The calibration of a rectified pair of cameras.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cameras {
    /// Focal length in px.
    pub focal_px: f64,
    /// Baseline in m.
    pub baseline_m: f64,
    /// Principal point of the left view in px.
    pub principal_px: [f64; 2],
    /// Principal point of the right view minus that of the left one, along x in px.
    pub offset_px: f64,
}

impl From<&Calibration> for Cameras {
    fn from(calibration: &Calibration) -> Self {
        let Calibration { focal_px, baseline_m, principal_px, offset_px } = *calibration;
        Self { focal_px, baseline_m, principal_px, offset_px }
    }
}

impl Info {
    /// The facts about `clip`.
    pub fn of(clip: &Clip) -> Self {
        let info = clip.info().clone();
        Self {
            width: info.width,
            height: info.height,
            frames: info.frames,
            fps: info.fps,
            seconds: info.frames.zip(info.fps).map(|(frames, fps)| frames as f64 / fps).filter(|s| s.is_finite()),
            container: info.container,
            codec: info.codec,
            truth: clip.truth().map(|truth| truth.kinds()).unwrap_or_default(),
            truth_files: clip.truth().map(|truth| truth.names()).unwrap_or_default(),
            right: clip.right().map(|right| right.info().name.clone()),
            depths: clip.has_depths(),
            calibration: clip.calibration().map(Cameras::from),
            repeats: None,
            warnings: info.warnings,
        }
    }

    /// The same with the frames counted that repeat the frame before: among the first, or `all` of them. Frames that are computed
    /// are not compared.
    #[must_use]
    pub fn with_repeats(self, clip: &Clip, all: bool) -> Self {
        /// Enough to see what a converter of rates does, in little time.
        const MOST_PAIRS: usize = 100;
        let is_recorded = !clip.is_blank() && clip.info().container != "synthetic";
        let most = if all { usize::MAX } else { MOST_PAIRS };
        Self { repeats: is_recorded.then(|| Repeats::of(clip, most)), ..self }
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { width, height, frames, fps, seconds, container, codec, truth, truth_files, .. } = self;
        writeln!(f, "size      {width}×{height} px")?;
        match frames {
            Some(frames) => writeln!(f, "frames    {frames}")?,
            None => writeln!(f, "frames    not counted (--count decodes the whole file)")?,
        }
        if let Some(fps) = fps {
            writeln!(f, "rate      {} frames/s", brief(*fps))?;
        }
        if let Some(seconds) = seconds {
            writeln!(f, "length    {} s", brief(*seconds))?;
        }
        writeln!(f, "container {container}")?;
        writeln!(f, "codec     {codec}")?;
        let files = |i: usize| truth_files.get(i).map_or_else(String::new, |name| format!(" ({name})"));
        let kinds: Vec<_> = truth.iter().enumerate().map(|(i, kind)| format!("{kind}{}", files(i))).collect();
        writeln!(f, "truth     {}", if truth.is_empty() { "none".into() } else { kinds.join(", ") })?;
        if let Some(right) = &self.right {
            writeln!(f, "right     {right}")?;
        }
        if self.depths {
            writeln!(f, "depths    measured")?;
        }
        if let Some(Cameras { focal_px, baseline_m, .. }) = &self.calibration {
            let (focal, baseline) = (fixed(*focal_px, 1), fixed(*baseline_m, 3));
            writeln!(f, "cameras   focal length {focal} px, baseline {baseline} m")?;
        }
        if let Some(Repeats { identical, compared }) = self.repeats.filter(|repeats| repeats.identical > 0) {
            let frames = if *frames == Some(compared + 1) { "" } else { "first " };
            writeln!(
                f,
                "repeats   {identical} of the {frames}{compared} frames after frame 0 are identical to the frame before"
            )?;
        }
        self.warnings.iter().try_for_each(|warning| writeln!(f, "warning   {warning}"))
    }
}

/// Three decimals at most, and no trailing zeros.
fn brief(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use motionscope_core::data::{ClipInfo, Frame};
    use motionscope_core::geometry::Grid;

    use super::*;

    fn clip(frames: Option<usize>, fps: Option<f64>) -> Clip {
        let clip = Clip::from_frames("c", vec![Frame::gray(Grid::new(4, 3, 0))]).unwrap();
        let warnings = vec!["16 bits per channel are reduced to 8".into()];
        let info = ClipInfo { frames, fps, warnings, ..clip.info().clone() };
        clip.with_info(info)
    }

    #[test]
    fn a_script_finds_every_key() {
        let json = serde_json::to_string(&Info::of(&clip(Some(36), Some(24.0)))).unwrap();
        let golden = r#"{"width":4,"height":3,"frames":36,"fps":24.0,"seconds":1.5,"container":"memory","codec":"raw","truth":[],"truth_files":[],"warnings":["16 bits per channel are reduced to 8"]}"#;
        assert_eq!(json, golden);
        let unknown = serde_json::to_value(Info::of(&clip(None, Some(0.0)))).unwrap();
        assert!(unknown["frames"].is_null() && unknown["seconds"].is_null());
        assert!(serde_json::to_value(Info::of(&clip(Some(1), Some(0.0)))).unwrap()["seconds"].is_null());
    }

    #[test]
    fn frames_that_repeat_the_one_before_are_counted() {
        let of = |values: &[u8]| {
            let frames = values.iter().map(|value| Frame::gray(Grid::new(4, 3, *value))).collect();
            let clip = Clip::from_frames("c", frames).unwrap();
            Info::of(&clip).with_repeats(&clip, false)
        };
        // The same picture later on is no repetition.
        let repeated = of(&[1, 1, 2, 1, 1, 1]);
        assert_eq!(repeated.repeats, Some(Repeats { identical: 3, compared: 5 }));
        assert!(repeated.to_string().contains("3 of the 5 frames"));
        let none = of(&[1, 2, 3]);
        assert_eq!(none.repeats.map(|repeats| repeats.identical), Some(0));
        assert!(!none.to_string().contains("identical"));
        assert_eq!(of(&[1]).repeats, Some(Repeats { identical: 0, compared: 0 }));
        assert_eq!(of(&[7; 150]).repeats, Some(Repeats { identical: 100, compared: 100 }));
    }

    #[test]
    fn a_person_reads_units() {
        let message = Info::of(&clip(Some(7), Some(30_000.0 / 1001.0))).to_string();
        assert!(
            message.contains("4×3 px\n") && message.contains("29.97 frames/s\n") && message.contains("0.234 s\n"),
            "{message}"
        );
        assert!(Info::of(&clip(None, None)).to_string().contains("--count"));
    }
}
