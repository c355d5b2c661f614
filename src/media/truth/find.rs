//! Where truth lies: beside the clip, or where a person says.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::{ClipInfo, Error, Truth};

use super::{Files, field, mot};
use crate::media::names::{extension, file_name, natural_order, stem};
use crate::media::sequence::{Sequence, number, parent};

/// The clip that truth is sought for.
pub(crate) struct Subject {
    path: PathBuf,
    size: (usize, usize),
    /// The first of the clip's pictures, if it is made of pictures.
    first: Option<PathBuf>,
    /// The numbers in the pictures' names, by frame.
    numbers: Vec<Option<u64>>,
    by_name: HashMap<String, usize>,
    by_number: HashMap<u64, usize>,
}

/// What lay beside a clip.
#[derive(Default)]
pub(crate) struct Found {
    /// The truth, if there is any.
    pub truth: Option<Arc<dyn Truth>>,
    /// What was there but cannot be used.
    pub warnings: Vec<String>,
}

impl Subject {
    /// The clip at `path` that `info` tells about.
    pub(crate) fn new(path: &Path, info: &ClipInfo) -> Self {
        let pictures = match info.container.as_str() {
            "images" => Sequence::find(path).map(|sequence| sequence.files).unwrap_or_default(),
            _ => Vec::new(),
        };
        let mut subject = Self {
            path: path.into(),
            size: (info.width, info.height),
            first: pictures.first().cloned(),
            numbers: Vec::new(),
            by_name: HashMap::new(),
            by_number: HashMap::new(),
        };
        for (t, picture) in pictures.iter().enumerate() {
            let number = number(&file_name(picture));
            subject.numbers.push(number);
            subject.by_name.entry(stem(picture)).or_insert(t);
            if let Some(number) = number {
                subject.by_number.entry(number).or_insert(t);
            }
        }
        subject
    }

    /// Where the frames lie.
    fn folder(&self) -> &Path {
        parent(self.first.as_ref().unwrap_or(&self.path))
    }

    /// Whether the clip is made of pictures rather than a single file.
    fn has_pictures(&self) -> bool {
        self.first.is_some()
    }

    /// The frame that the truth called `name` belongs to: that of the same name or number; in a video the
    /// number counts frames from 0.
    fn frame_of(&self, name: &str) -> Option<usize> {
        let number = number(name);
        if self.has_pictures() {
            let by_number = || number.and_then(|number| self.by_number.get(&number));
            self.by_name.get(&stem(Path::new(name))).or_else(by_number).copied()
        } else {
            number.and_then(|number| usize::try_from(number).ok())
        }
    }

    /// Whether the picture after frame `t` is missing, so that the clip's next frame is not what the flow leads to.
    fn gap_after(&self, t: usize) -> bool {
        let number = |t: usize| self.numbers.get(t).copied().flatten();
        number(t).zip(number(t + 1)).is_some_and(|(this, next)| next > this.saturating_add(1))
    }

    /// Files of one kind of truth by frame; the first in natural order wins.
    fn by_frame(&self, files: impl IntoIterator<Item = PathBuf>) -> BTreeMap<usize, PathBuf> {
        let mut frames = BTreeMap::new();
        for file in files {
            if let Some(t) = self.frame_of(&file_name(&file)).filter(|&t| !self.gap_after(t)) {
                frames.entry(t).or_insert(file);
            }
        }
        frames
    }
}

/// Looks for truth beside the clip, where the benchmarks and `motionscope synth` put it.
pub(crate) fn beside(subject: &Subject) -> Found {
    let mut found = Found::default();
    let mut files = Files::new(subject.size);
    let mut accept = |sound: Result<(), Error>| {
        let is_sound = sound.is_ok();
        found.warnings.extend(sound.err().map(|why| format!("truth beside the clip is not used: {why}")));
        is_sound
    };
    let flows = flows_beside(subject);
    if flows.values().next().is_none_or(|first| accept(field::check_flow(first, subject.size))) {
        files.flows = flows;
    }
    let masks = masks_beside(subject);
    if masks.values().next().is_none_or(|first| accept(field::check_mask(first, subject.size))) {
        files.masks = masks;
    }
    if let Some(path) = tracks_beside(subject) {
        match mot::read(&path) {
            Ok(objects) => files.objects = Some(objects),
            Err(why) => _ = accept(Err(why)),
        }
    }
    if !files.is_empty() {
        found.truth = Some(Arc::new(files));
    }
    found
}

/// Opens truth that a person points to: a flow, a `gt.txt`, or a folder of flows.
///
/// A single flow whose name fits no frame belongs to the first.
///
/// # Errors
/// One sentence that names the file if it is no truth, or not that of this clip.
pub(crate) fn open(path: &Path, subject: &Subject) -> Result<Arc<dyn Truth>, Error> {
    let mut files = Files::new(subject.size);
    if path.is_dir() {
        files.flows = subject.by_frame(list(path, is_flow));
        if files.flows.is_empty() {
            return Err(super::file_error(path, "the folder holds no .flo or PNG whose number is that of a frame"));
        }
    } else if extension(path) == "txt" {
        files.objects = Some(mot::read(path)?);
    } else {
        let t = subject.frame_of(&file_name(path)).filter(|_| subject.has_pictures()).unwrap_or(0);
        files.flows.insert(t, path.into());
    }
    if let Some(first) = files.flows.values().next() {
        field::check_flow(first, subject.size)?;
    }
    Ok(Arc::new(files))
}

fn flows_beside(subject: &Subject) -> BTreeMap<usize, PathBuf> {
    let folder = subject.folder();
    let mut files: Vec<_> =
        neighbours(folder, &["flow", "other-gt-flow"]).iter().flat_map(|folder| list(folder, is_flow)).collect();
    if subject.has_pictures() {
        files.extend(list(folder, |file| extension(file) == "flo"));
    }
    let mut frames = subject.by_frame(files);
    let own = subject.path.with_extension("flo");
    if !frames.contains_key(&0) && own.is_file() && !subject.gap_after(0) {
        frames.insert(0, own);
    }
    frames
}

fn masks_beside(subject: &Subject) -> BTreeMap<usize, PathBuf> {
    let folder = subject.folder();
    let is_png = |file: &Path| extension(file) == "png";
    let is_mask =
        |file: &Path| is_png(file) && file_name(file).starts_with("occ") && !subject.by_name.contains_key(&stem(file));
    let inside = neighbours(folder, &["occ", "occlusions"]);
    subject.by_frame(inside.iter().flat_map(|folder| list(folder, is_png)).chain(list(folder, is_mask)))
}

fn tracks_beside(subject: &Subject) -> Option<PathBuf> {
    let folder = subject.folder();
    // MOTChallenge keeps the pictures in `img1` and the tracks in `gt` beside it.
    let above = if folder.ends_with("img1") { folder.parent() } else { None };
    let folders = [Some(folder), above];
    folders
        .into_iter()
        .flatten()
        .flat_map(|folder| [folder.join("gt.txt"), folder.join("gt").join("gt.txt")])
        .find(|file| file.is_file())
}

/// Folders of the given names inside `folder`, and where Sintel and Middlebury have them: `clean/alley_1` has its flow
/// in `flow/alley_1`.
fn neighbours(folder: &Path, names: &[&str]) -> Vec<PathBuf> {
    let whole = fs::canonicalize(folder).unwrap_or_else(|_| folder.into());
    let above = whole.parent().and_then(Path::parent).zip(whole.file_name());
    let beside = names.iter().filter_map(|name| above.map(|(above, clip)| above.join(name).join(clip)));
    let inside = names.iter().map(|name| folder.join(name));
    inside.chain(beside.filter(|beside| *beside != whole)).filter(|folder| folder.is_dir()).collect()
}

fn is_flow(file: &Path) -> bool {
    matches!(extension(file).as_str(), "flo" | "png")
}

/// The files in `folder` that `fit`, in natural order; none if it cannot be read.
fn list(folder: &Path, fits: impl Fn(&Path) -> bool) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> = entries.map(|entry| entry.path()).filter(|path| fits(path) && path.is_file()).collect();
    files.sort_by(|a, b| natural_order(&file_name(a), &file_name(b)));
    files
}

#[cfg(test)]
mod tests {
    use motionscope_core::{Clip, Flow, Grid, ObjectBox};

    use super::*;
    use crate::media::export::{self, Pixels};
    use crate::media::{self, Open};

    fn flow(u: f32) -> Flow {
        Flow(Grid::new(4, 3, [u, 0.5]))
    }

    fn put(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    /// Pictures `frame07.png` to `frame10.png` and `frame13.png`.
    fn pictures(folder: &Path) {
        for name in ["frame07.png", "frame08.png", "frame09.png", "frame10.png", "frame13.png"] {
            put(folder, name, export::png(4, 3, Pixels::Gray(&[9; 12])).unwrap());
        }
    }

    fn open(path: &Path) -> Clip {
        media::open(path, &Open::default()).unwrap()
    }

    fn u(clip: &Clip, t: usize) -> Option<f32> {
        clip.truth().and_then(|truth| truth.flow(t).unwrap()).and_then(|flow| flow.at(1, 1)).map(|[u, _]| u)
    }

    #[test]
    fn flow_belongs_to_the_picture_of_its_number() {
        let folder = tempfile::tempdir().unwrap();
        pictures(folder.path());
        put(folder.path(), "flow08.flo", export::flo(&flow(8.0)));
        put(folder.path(), "flow/frame_0009.png", export::kitti(&flow(9.0)).unwrap().bytes);
        put(folder.path(), "flow10.flo", export::flo(&flow(10.0)));
        let all = open(folder.path());
        assert_eq!((0..5).map(|t| u(&all, t)).collect::<Vec<_>>(), [None, Some(8.0), Some(9.0), None, None]);
        assert_eq!(all.truth().unwrap().kinds(), ["flow"]);
        let from = open(&folder.path().join("frame08.png"));
        assert_eq!((u(&from, 0), u(&from, 1)), (Some(8.0), Some(9.0)));
    }

    #[test]
    fn flow_lies_where_sintel_has_it() {
        let folder = tempfile::tempdir().unwrap();
        pictures(&folder.path().join("clean/alley"));
        put(folder.path(), "flow/alley/frame_0008.flo", export::flo(&flow(3.0)));
        assert_eq!(u(&open(&folder.path().join("clean/alley")), 1), Some(3.0));
        // Pictures in a folder of that very name are no flow.
        pictures(&folder.path().join("flow/whale"));
        let whale = open(&folder.path().join("flow/whale/frame08.png"));
        assert!(whale.truth().is_none() && whale.info().warnings.len() == 2, "{:?}", whale.info().warnings);
    }

    #[test]
    fn a_clip_s_own_flow_is_that_of_its_first_frame() {
        let folder = tempfile::tempdir().unwrap();
        pictures(&folder.path().join("whale"));
        put(folder.path(), "whale.flo", export::flo(&flow(1.0)));
        let clip = open(&folder.path().join("whale"));
        assert_eq!((u(&clip, 0), u(&clip, 1)), (Some(1.0), None));
    }

    #[test]
    fn masks_and_tracks_are_found_too() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("img1");
        pictures(&frames);
        put(&frames, "occ_0008.png", export::png(4, 3, Pixels::Gray(&[255; 12])).unwrap());
        let object = ObjectBox { id: 5, x: 1.0, y: 2.0, width: 3.0, height: 4.0, visibility: 1.0 };
        put(folder.path(), "gt/gt.txt", export::mot(&[vec![], vec![object]]));
        let clip = open(&frames);
        let truth = clip.truth().unwrap();
        assert_eq!(clip.info().frames, Some(5));
        assert_eq!(truth.kinds(), ["occlusion", "objects"]);
        assert!(truth.occlusion(0).unwrap().is_none());
        assert!(truth.occlusion(1).unwrap().unwrap().cells().iter().all(|&hidden| hidden));
        assert_eq!(truth.objects(1).unwrap(), Some(vec![object]));
        assert_eq!(truth.objects(4).unwrap(), Some(vec![]));
    }

    #[test]
    fn truth_that_does_not_fit_is_a_warning_beside_and_an_error_by_hand() {
        let folder = tempfile::tempdir().unwrap();
        pictures(folder.path());
        put(folder.path(), "flow/flow07.flo", export::flo(&Flow(Grid::new(5, 3, [0.0; 2]))));
        put(folder.path(), "gt.txt", "1,2,3");
        let clip = open(folder.path());
        assert!(clip.truth().is_none());
        let told = clip.info().warnings.join("\n");
        assert!(told.contains("flow07.flo") && told.contains("5×3") && told.contains("gt.txt: line 1"), "{told}");
        for (name, why) in
            [("flow/flow07.flo", "5×3"), ("gt.txt", "line 1"), ("frame07.png", "16-bit"), ("gone", "no such")]
        {
            let options = Open { truth: Some(folder.path().join(name)), ..Open::default() };
            let told = media::open(folder.path(), &options).unwrap_err().to_string();
            assert!(told.contains(name) && told.contains(why), "{told}");
        }
    }

    #[test]
    fn truth_by_hand_wins() {
        let folder = tempfile::tempdir().unwrap();
        pictures(folder.path());
        put(folder.path(), "flow07.flo", export::flo(&flow(7.0)));
        put(folder.path(), "made/my.flo", export::flo(&flow(1.0)));
        put(folder.path(), "made/my08.flo", export::flo(&flow(2.0)));
        let by_hand = |name: &str| {
            let options = Open { truth: Some(folder.path().join(name)), ..Open::default() };
            let clip = media::open(folder.path(), &options).unwrap();
            (u(&clip, 0), u(&clip, 1))
        };
        assert_eq!(by_hand("made/my.flo"), (Some(1.0), None));
        assert_eq!(by_hand("made/my08.flo"), (None, Some(2.0)));
        assert_eq!(by_hand("made"), (None, Some(2.0)));
    }
}
