//! Where truth lies: beside the clip, or where a person says.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::{Error, Truth};

use super::{Files, Subject, field, file_error, mot};
use crate::media::names::{extension, file_name, natural_order};

/// What lay beside a clip.
#[derive(Default)]
pub(crate) struct Found {
    /// The truth, if there is any.
    pub truth: Option<Arc<dyn Truth>>,
    /// What was there but cannot be used.
    pub warnings: Vec<String>,
}

/// Looks for truth beside the clip, where the benchmarks and `motionscope synth` put it.
pub(crate) fn beside(subject: &Subject) -> Found {
    let mut found = Found::default();
    if subject.path == Path::new("-") {
        return found;
    }
    let folder = subject.folder();
    let mut files = Files::new(subject.size);
    let mut accept = |sound: Result<(), Error>| {
        let is_sound = sound.is_ok();
        found.warnings.extend(sound.err().map(|why| format!("truth beside the clip is not used: {why}")));
        is_sound
    };
    let mut flows = flows_in(folder, subject);
    if let Some(own) = own_flow(subject) {
        flows.entry(0).or_insert(own);
    }
    if accept(check(&flows, field::check_flow, subject)) {
        files.flows = flows;
    }
    let masks = masks_in(folder, subject);
    if accept(check(&masks, field::check_mask, subject)) {
        files.masks = masks;
    }
    if let Some(path) = tracks_in(folder) {
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

/// Opens truth that a person points to: a flow, a `gt.txt`, a folder of flows, or one that `motionscope synth` wrote.
///
/// A single flow whose name fits no frame belongs to the first.
///
/// # Errors
/// One sentence that names the file if it is no truth, or not that of this clip.
pub(crate) fn open(path: &Path, subject: &Subject) -> Result<Arc<dyn Truth>, Error> {
    let mut files = Files::new(subject.size);
    if path.is_dir() {
        files.flows = flows_in(path, subject);
        files.masks = masks_in(path, subject);
        files.objects = tracks_in(path).map(|tracks| mot::read(&tracks)).transpose()?;
        if files.flows.is_empty() {
            files.flows = subject.by_frame(list(path, is_flow));
        }
    } else if extension(path) == "txt" {
        files.objects = Some(mot::read(path)?);
    } else {
        let t = subject.named(path).or_else(|| subject.numbered(path)).filter(|_| subject.has_pictures());
        files.flows.insert(t.unwrap_or(0), path.into());
    }
    if files.is_empty() {
        return Err(file_error(path, "the folder holds no truth: no gt.txt, and no flow with the number of a frame"));
    }
    check(&files.flows, field::check_flow, subject)?;
    check(&files.masks, field::check_mask, subject)?;
    Ok(Arc::new(files))
}

/// Whether the first of `files` belongs to this clip, told from its header.
fn check(
    files: &BTreeMap<usize, PathBuf>,
    header: fn(&Path, (usize, usize)) -> Result<(), Error>,
    subject: &Subject,
) -> Result<(), Error> {
    files.values().next().map_or(Ok(()), |first| header(first, subject.size))
}

/// Where one kind of truth lies, seen from the folder of the frames.
struct Places {
    /// Folders in it.
    inside: &'static [&'static str],
    /// Folders beside it, as KITTI has them: `image_2` and `flow_occ`.
    beside: &'static [&'static str],
    /// Folders two above it that hold one of its name, as Sintel and Middlebury have them: `clean/alley_1` and
    /// `flow/alley_1`.
    across: &'static [&'static str],
}

const FLOWS: Places =
    Places { inside: &["flow"], beside: &["flow_occ", "flow_noc"], across: &["flow", "other-gt-flow"] };
const MASKS: Places = Places { inside: &["occ", "occlusions"], beside: &[], across: &["occlusions"] };

impl Places {
    /// The files that `fit` in the first of these places that has any for the clip.
    fn search(&self, folder: &Path, subject: &Subject, fits: fn(&Path) -> bool) -> BTreeMap<usize, PathBuf> {
        let whole = fs::canonicalize(folder).unwrap_or_else(|_| folder.into());
        let inside = self.inside.iter().map(|name| folder.join(name));
        let beside = self.beside.iter().filter_map(|name| Some(whole.parent()?.join(name)));
        let across =
            self.across.iter().filter_map(|name| Some(whole.parent()?.parent()?.join(name).join(whole.file_name()?)));
        let places = inside.chain(beside).chain(across.filter(|across| *across != whole));
        let mut found = places.map(|place| subject.by_frame(list(&place, fits)));
        found.find(|frames| !frames.is_empty()).unwrap_or_default()
    }
}

fn flows_in(folder: &Path, subject: &Subject) -> BTreeMap<usize, PathBuf> {
    let mut flows = FLOWS.search(folder, subject, is_flow);
    if subject.has_pictures() {
        for (t, flow) in subject.by_frame(list(folder, |file| extension(file) == "flo")) {
            flows.entry(t).or_insert(flow);
        }
    }
    flows
}

/// The flow that is called as the clip.
fn own_flow(subject: &Subject) -> Option<PathBuf> {
    let own = if subject.path.is_dir() {
        let mut name = subject.path.file_name()?.to_owned();
        name.push(".flo");
        subject.path.with_file_name(name)
    } else {
        subject.path.with_extension("flo")
    };
    (own.is_file() && !subject.gap_after(0)).then_some(own)
}

fn masks_in(folder: &Path, subject: &Subject) -> BTreeMap<usize, PathBuf> {
    let mut masks = MASKS.search(folder, subject, is_png);
    let is_mask = |file: &Path| is_png(file) && file_name(file).starts_with("occ") && subject.named(file).is_none();
    for (t, mask) in subject.by_frame(list(folder, is_mask)) {
        masks.entry(t).or_insert(mask);
    }
    masks
}

fn tracks_in(folder: &Path) -> Option<PathBuf> {
    // MOTChallenge keeps the pictures in `img1`, what was detected in `det` and the tracks in `gt` beside both.
    let above = if folder.ends_with("img1") || folder.ends_with("det") { folder.parent() } else { None };
    [Some(folder), above]
        .into_iter()
        .flatten()
        .flat_map(|folder| [folder.join("gt.txt"), folder.join("gt").join("gt.txt")])
        .find(|file| file.is_file())
}

fn is_png(file: &Path) -> bool {
    extension(file) == "png"
}

fn is_flow(file: &Path) -> bool {
    is_png(file) || extension(file) == "flo"
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
    fn flow_lies_where_kitti_has_it() {
        let folder = tempfile::tempdir().unwrap();
        for clip in 0..3 {
            for t in [10, 11] {
                let picture = export::png(4, 3, Pixels::Gray(&[9; 12])).unwrap();
                put(folder.path(), &format!("image_2/00000{clip}_{t}.png"), picture);
            }
            // The last has none.
            if clip < 2 {
                let made = export::kitti(&flow(clip as f32)).unwrap();
                put(folder.path(), &format!("flow_occ/00000{clip}_10.png"), made.bytes);
            }
        }
        let u_of = |clip| u(&open(&folder.path().join(format!("image_2/00000{clip}_10.png"))), 0);
        assert_eq!((u_of(0), u_of(1), u_of(2)), (Some(0.0), Some(1.0), None));
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
        put(folder.path(), "whole/flow/frame_0007.flo", export::flo(&flow(3.0)));
        assert_eq!(by_hand("whole"), (Some(3.0), None));
    }
}
