//! Depths that a sensor measured beside the frames: 16-bit pictures, given or found.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use motionscope_core::base::Error;
use motionscope_core::data::{Clip, DepthSource};
use motionscope_core::geometry::Grid;

use super::companion::{Companion, LeftView};
use super::export::InputKind;
use super::names::{file_name, stem};
use super::sequence::{Sequence, parent};
use super::{Given, Open, about, truth};
use crate::files;

/// Units of a 16-bit depth per m, as in the recordings of TUM and ICL-NUIM.
const UNITS_PER_M: f32 = 5000.0;
/// The folder of the depths in that of the frames or beside it.
const FOLDER: &str = "depth";
/// Largest difference in s of the times in the names of a frame and of its depths, as TUM associates them.
const APART_S: f64 = 0.03;
/// Depths that are kept: those of a pair of frames in both directions.
const KEPT: usize = 4;

/// The depths of a clip, read when they are asked for.
struct Files {
    files: Vec<Option<PathBuf>>,
    size: (usize, usize),
    units_per_m: f32,
    last: Mutex<VecDeque<(usize, Arc<Grid<f32>>)>>,
}

impl DepthSource for Files {
    fn depth_m(&self, t: usize) -> Result<Option<Arc<Grid<f32>>>, Error> {
        let Some(path) = self.files.get(t).and_then(Option::as_ref) else { return Ok(None) };
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let known = last.iter().position(|(kept, _)| *kept == t).and_then(|i| last.remove(i));
        let depth = match known {
            Some((_, depth)) => depth,
            None => Arc::new(truth::depth(path, self.size, self.units_per_m)?),
        };
        last.push_back((t, Arc::clone(&depth)));
        if last.len() > KEPT {
            last.pop_front();
        }
        Ok(Some(depth))
    }
}

/// The depths of a clip: a folder of pictures.
pub(super) struct Depths {
    folder: PathBuf,
    /// The pictures in the folder, or why there are none.
    files: Result<Vec<PathBuf>, Error>,
}

impl From<PathBuf> for Depths {
    fn from(folder: PathBuf) -> Self {
        let files = Sequence::find(&folder).map(|found| found.files).map_err(|why| about(&folder, &why));
        Self { folder, files }
    }
}

impl Companion for Depths {
    const KIND: InputKind = InputKind::Depths;
    const IGNORED: &'static str = "the depths beside the clip are ignored";

    fn given(_left: &LeftView<'_>, given: &Given) -> Option<Self> {
        given.depths.clone().map(Self::from)
    }

    /// The folder `depth` in that of the frames or beside it. A given right view takes its place.
    fn beside(left: &LeftView<'_>, given: &Given) -> Option<Self> {
        let frames = files::canonicalize(parent(left.files.first().filter(|_| given.right.is_none())?)).ok()?;
        let places = [Some(frames.join(FOLDER)), frames.parent().map(|above| above.join(FOLDER))];
        places.into_iter().flatten().find(|folder| files::is_dir(folder) && *folder != frames).map(Self::from)
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.clone().unwrap_or_default()
    }

    fn attach(self, clip: Clip, left: &LeftView<'_>, options: &Open) -> Result<Clip, Error> {
        let (found, name) = (self.files?, file_name(&self.folder));
        let files = paired(left.files, &found).ok_or_else(|| {
            let (depths, frames) = (found.len(), left.files.len());
            Error::new(format!(
                "{name}: {depths} depths for {frames} frames, and no names that belong together; name each like its frame"
            ))
        })?;
        let first = files.iter().flatten().next();
        let first = first.ok_or_else(|| Error::new(format!("{name}: no depth belongs to a frame")))?;
        let (size, units_per_m) = (clip.size(), options.given.depth_scale.unwrap_or(UNITS_PER_M));
        truth::depth(first, size, units_per_m)?;
        Ok(clip.with_depths(Arc::new(Files { files, size, units_per_m, last: Mutex::default() })))
    }
}

/// The depth of each frame: the file of its name, else if both names are times in s the nearest, each for one frame, else the one in its
/// place; `None` if there are not as many.
fn paired(frames: &[PathBuf], depths: &[PathBuf]) -> Option<Vec<Option<PathBuf>>> {
    if frames.is_empty() {
        return Some(depths.iter().cloned().map(Some).collect());
    }
    let by_name: BTreeMap<String, &PathBuf> = depths.iter().map(|depth| (stem(depth), depth)).collect();
    let all: Vec<_> = frames.iter().map(|frame| by_name.get(&stem(frame)).map(|depth| (*depth).clone())).collect();
    if all.iter().any(Option::is_some) {
        return Some(all);
    }
    let time = |file: &PathBuf| stem(file).parse::<f64>().ok().filter(|_| stem(file).contains('.'));
    let times = |files: &[PathBuf]| files.iter().map(time).collect::<Option<Vec<f64>>>();
    match (times(frames), times(depths)) {
        (Some(of_frames), Some(of_depths)) => Some(associated(&of_frames, &of_depths, depths)),
        _ => (frames.len() == depths.len()).then(|| depths.iter().cloned().map(Some).collect()),
    }
}

/// Associates frames and depths in the order of the difference of their times, each with one of the other kind.
fn associated(of_frames: &[f64], of_depths: &[f64], depths: &[PathBuf]) -> Vec<Option<PathBuf>> {
    let mut pairs = Vec::new();
    for (frame, at) in of_frames.iter().enumerate() {
        let near = of_depths.iter().enumerate().map(|(depth, time)| ((time - at).abs(), frame, depth));
        pairs.extend(near.filter(|(apart, ..)| *apart < APART_S));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut all, mut is_taken) = (vec![None; of_frames.len()], vec![false; depths.len()]);
    for (_, frame, depth) in pairs {
        if all[frame].is_none() && !is_taken[depth] {
            (all[frame], is_taken[depth]) = (Some(depths[depth].clone()), true);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::media;
    use crate::media::export::{Pixels, png};

    fn put(folder: &Path, name: &str, bytes: &[u8]) {
        let path = folder.join(name);
        std::fs::create_dir_all(parent(&path)).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    /// A 16-bit gray picture of 4×3 px of one level.
    fn level(level: u16) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 4, 3);
        encoder.set_color(::png::ColorType::Grayscale);
        encoder.set_depth(::png::BitDepth::Sixteen);
        let samples: Vec<u8> = [level; 12].iter().flat_map(|level| level.to_be_bytes()).collect();
        encoder.write_header().unwrap().write_image_data(&samples).unwrap();
        bytes
    }

    #[test]
    fn depths_are_found_beside_the_frames_and_belong_to_those_of_their_time() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["100.000.png", "100.033.png", "100.066.png"] {
            put(&folder.path().join("rgb"), name, &png(4, 3, Pixels::Gray(&[9; 12])).unwrap());
        }
        for (name, units) in [("100.010.png", 5000), ("100.041.png", 10_000), ("100.200.png", 7)] {
            put(&folder.path().join("depth"), name, &level(units));
        }
        let clip = media::open(&folder.path().join("rgb"), &Open::default()).unwrap().clip;
        let depth = |clip: &Clip, t: usize| clip.depth_m(t).unwrap().map(|depth| depth[(1, 1)]);
        assert_eq!([0, 1, 2].map(|t| depth(&clip, t)), [Some(1.0), Some(2.0), None], "each depth belongs to one frame");
        let given = Given { depth_scale: Some(1000.0), ..Given::default() };
        let clip = media::open(&folder.path().join("rgb"), &Open { given, ..Open::default() }).unwrap().clip;
        assert_eq!(depth(&clip, 0), Some(5.0));
        let given = Given { depths: Some(folder.path().join("rgb")), ..Given::default() };
        let refused = media::open(&folder.path().join("rgb"), &Open { given, ..Open::default() }).unwrap_err();
        assert!(refused.to_string().contains("16 bits"), "{refused}");
        // By their order only where there are as many.
        put(&folder.path().join("two"), "a.png", &level(1));
        put(&folder.path().join("two"), "b.png", &level(1));
        let given = Given { depths: Some(folder.path().join("two")), ..Given::default() };
        let refused = media::open(&folder.path().join("rgb"), &Open { given, ..Open::default() }).unwrap_err();
        assert!(refused.to_string().contains("2 depths for 3 frames"), "{refused}");
    }
}
