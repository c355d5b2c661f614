//! The search for ground truth: beside the clip, or at a given path.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::data::{Clip, Truth};

use super::{Files, Objects, Subject, field, file_error, mot, region};
use crate::files;
use crate::media::companion::{Companion, LeftView, warned};
use crate::media::export::{InputKind, is_result};
use crate::media::input::Node;
use crate::media::names::{Numbered, extension, file_name, natural_order, stem};
use crate::media::sequence::parent;
use crate::media::{Given, Open};

/// The ground truth of a clip in files.
pub(crate) struct GroundTruth {
    subject: Subject,
    files: TruthFiles,
    /// The given path.
    given: Option<PathBuf>,
}

impl Companion for GroundTruth {
    const KIND: InputKind = InputKind::Truth;
    const IGNORED: &'static str = "ground truth beside the clip is ignored";

    fn given(left: &LeftView<'_>, given: &Given) -> Option<Self> {
        let path = given.truth.as_ref()?;
        let subject = Subject::new(left, given.disparity_scale);
        Some(Self { files: TruthFiles::given(path, &subject), subject, given: Some(path.clone()) })
    }

    /// Truth where the benchmarks and `motionscope synth` put it.
    fn beside(left: &LeftView<'_>, given: &Given) -> Option<Self> {
        if left.path == Path::new("-") {
            return None;
        }
        let subject = Subject::new(left, given.disparity_scale);
        Some(Self { files: TruthFiles::beside(&subject), subject, given: None })
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.all()
    }

    /// Each kind of truth that lies beside the clip is ignored by itself if it does not fit.
    fn attach(self, clip: Clip, _left: &LeftView<'_>, _options: &Open) -> Result<Clip, Error> {
        let Self { subject, files, given } = self;
        if let Some(path) = given {
            return open(&path, files, &subject).map(|truth| clip.with_truth(truth));
        }
        let (truth, warnings) = fitting(files, &subject);
        let clip = warned(clip, warnings);
        Ok(match truth {
            Some(truth) => clip.with_truth(truth),
            None => clip,
        })
    }
}

/// The truth in those of `files` that can be read and fit the clip, with warnings about the others.
fn fitting(files: TruthFiles, subject: &Subject) -> (Option<Arc<dyn Truth>>, Vec<String>) {
    let TruthFiles { flows, occlusions, disparities, next_disparities, foregrounds, labels, objects, results } = files;
    let (mut files, mut warnings) = (Files { scale: subject.scale, ..Files::new(subject.size) }, Vec::new());
    let mut accept = |sound: Result<(), Error>| {
        let is_sound = sound.is_ok();
        warnings.extend(sound.err().map(|why| format!("{}: {why}", GroundTruth::IGNORED)));
        is_sound
    };
    if accept(check(&flows, field::check_flow, subject)) {
        files.flows = flows;
    }
    if accept(check(&occlusions, field::check_mask, subject)) {
        files.occlusions = occlusions;
    }
    if accept(check_disparity(&disparities, subject)) {
        files.disparities = disparities;
    }
    if accept(check_disparity(&next_disparities, subject)) {
        files.next_disparities = next_disparities;
    }
    if accept(check(&foregrounds, field::check_mask, subject)) {
        files.foregrounds = foregrounds;
    }
    if accept(check_labels(&labels, subject)) {
        files.labels = labels;
    }
    if let Some(path) = objects {
        match tracks(&path) {
            Ok(tracks) => {
                warnings.extend(tracks.warning.map(str::to_owned));
                files.objects = Some(Objects { path, tracks });
            }
            Err(why) => _ = accept(Err(why)),
        }
    }
    warnings.extend(not_truth(&results));
    if files.is_empty() {
        return (None, warnings);
    }
    files.tell_from(subject.folder());
    (Some(Arc::new(files)), warnings)
}

/// The objects in a table of tracks, or of the region of one object.
fn tracks(path: &Path) -> Result<mot::Tracks, Error> {
    let text = mot::text(path)?;
    let is_named = REGIONS.iter().any(|name| file_name(path).eq_ignore_ascii_case(name));
    if is_named || region::is_region(&text) { region::of_text(path, &text) } else { mot::of_text(path, &text) }
}

/// Tells of results that lie where truth is looked for.
fn not_truth(results: &[PathBuf]) -> Option<String> {
    let first = file_name(results.first()?);
    Some(match results.len() - 1 {
        0 => format!("{first} is a result that Motionscope wrote, so it is not used as truth"),
        more => format!("{first} and {more} more are results that Motionscope wrote, so they are not used as truth"),
    })
}

/// Opens the `files` of ground truth at a given path: a flow, a disparity, a mask of the foreground, labels of segments, a `gt.txt`, a folder of one of these, or a folder
/// written by `motionscope synth`.
///
/// A single field whose name fits no frame belongs to the first, and so does a homography.
///
/// # Errors
/// One sentence that names the file if it is no truth, or not that of this clip.
fn open(path: &Path, files: TruthFiles, subject: &Subject) -> Result<Arc<dyn Truth>, Error> {
    let node = Node::of(path).map_err(|why| file_error(path, why))?;
    let TruthFiles { flows, occlusions, disparities, next_disparities, foregrounds, labels, objects, .. } = files;
    if node == Node::Stream && objects.is_none() {
        let why = "it is a pipe, and a flow is read more than once; save it to a file and give that";
        return Err(file_error(path, why));
    }
    let about = |why: Error| match node {
        Node::Stream => Error::new(format!("{why}; a flow cannot come from a pipe, because it is read more than once")),
        _ => why,
    };
    let read = |path: PathBuf| tracks(&path).map(|tracks| Objects { path, tracks }).map_err(about);
    let objects = objects.map(read).transpose()?;
    let scale = subject.scale;
    let mut files = Files {
        flows,
        occlusions,
        disparities,
        next_disparities,
        scale,
        foregrounds,
        labels,
        objects,
        ..Files::new(subject.size)
    };
    if files.is_empty() {
        return Err(file_error(
            path,
            "the folder holds no ground truth: no gt.txt or groundtruth.txt, and no flow, disparity or mask numbered like a frame",
        ));
    }
    check(&files.flows, field::check_flow, subject)?;
    check(&files.occlusions, field::check_mask, subject)?;
    check_disparity(&files.disparities, subject)?;
    if let Some(first) = files.foregrounds.values().next() {
        field::foreground(first, subject.size)?;
    }
    check_disparity(&files.next_disparities, subject)?;
    check_labels(&files.labels, subject)?;
    files.tell_from(if node == Node::Folder { path } else { parent(path) });
    Ok(Arc::new(files))
}

/// Whether the header of the first of `files` fits this clip.
fn check(
    files: &BTreeMap<usize, PathBuf>,
    header: fn(&Path, (usize, usize)) -> Result<(), Error>,
    subject: &Subject,
) -> Result<(), Error> {
    files.values().next().map_or(Ok(()), |first| header(first, subject.size))
}

/// Whether the header of the first of `files` fits this clip as a disparity.
fn check_disparity(files: &BTreeMap<usize, PathBuf>, subject: &Subject) -> Result<(), Error> {
    files.values().next().map_or(Ok(()), |first| field::check_disparity(first, subject.size, subject.scale))
}

/// Whether the first of `files` has labels for this clip.
fn check_labels(files: &BTreeMap<usize, PathBuf>, subject: &Subject) -> Result<(), Error> {
    files.values().next().map_or(Ok(()), |first| field::labels(first, subject.size).map(drop))
}

/// The files of truth of a clip, by the frame that they belong to; none of them was read.
#[derive(Default)]
struct TruthFiles {
    flows: BTreeMap<usize, PathBuf>,
    occlusions: BTreeMap<usize, PathBuf>,
    disparities: BTreeMap<usize, PathBuf>,
    next_disparities: BTreeMap<usize, PathBuf>,
    foregrounds: BTreeMap<usize, PathBuf>,
    labels: BTreeMap<usize, PathBuf>,
    objects: Option<PathBuf>,
    /// Files among them that are saved results.
    results: Vec<PathBuf>,
}

impl TruthFiles {
    /// Finds the files beside the clip, by the names and folders of the benchmarks and of `motionscope synth`.
    fn beside(subject: &Subject) -> Self {
        let mut search = Search { subject, results: Vec::new() };
        let folder = subject.folder();
        let (flows, occlusions, objects) = (search.flows(folder), search.occlusions(folder), search.tracks(folder));
        let disparities = search.disparities(folder);
        let next_disparities = search.places(&NEXT_DISPARITIES, folder, is_disparity);
        let foregrounds = search.places(&FOREGROUNDS, folder, is_png);
        let labels = search.places(&LABELS, folder, is_png);
        let results = search.results;
        Self { flows, occlusions, disparities, next_disparities, foregrounds, labels, objects, results }
    }

    /// Finds the files at the given `path`.
    fn given(path: &Path, subject: &Subject) -> Self {
        let mut search = Search { subject, results: Vec::new() };
        if files::is_dir(path) {
            let mut flows = search.flows(path);
            let (occlusions, objects) = (search.occlusions(path), search.tracks(path));
            let mut disparities = search.disparities(path);
            let mut foregrounds = search.places(&FOREGROUNDS, path, is_png);
            let next_disparities = search.places(&NEXT_DISPARITIES, path, is_disparity);
            let mut labels = search.places(&LABELS, path, is_png);
            if flows.is_empty() && foregrounds.is_empty() && disparities.is_empty() && labels.is_empty() {
                let scale = subject.scale;
                let all = search.frames(path, |file| is_flow(file) || is_disparity(file));
                let (of_views, others): (BTreeMap<_, _>, BTreeMap<_, _>) =
                    all.into_iter().partition(|(_, file)| field::is_disparity(file, scale));
                disparities = of_views;
                let (with_palette, others): (BTreeMap<_, _>, BTreeMap<_, _>) =
                    others.into_iter().partition(|(_, file)| field::is_labels(file));
                labels = with_palette;
                (foregrounds, flows) = others.into_iter().partition(|(_, file)| field::is_mask(file));
            }
            let results = search.results;
            return Self { flows, occlusions, disparities, next_disparities, foregrounds, labels, objects, results };
        }
        // Rows of objects may come through a pipe, whose name says nothing.
        let is_pipe = || Node::of(path) == Ok(Node::Stream) && !is_flow(path);
        if extension(path) == "txt" || is_pipe() {
            return Self { objects: Some(path.into()), ..Self::default() };
        }
        let t = subject.named(path).or_else(|| subject.numbered(path)).filter(|_| subject.has_pictures());
        let t = t.filter(|_| Node::of(path) != Ok(Node::File) || !field::is_homography(path));
        let only = BTreeMap::from([(t.unwrap_or(0), path.into())]);
        // A pipe can be read only once.
        if Node::of(path) == Ok(Node::File) && field::is_disparity(path, subject.scale) {
            return Self { disparities: only, ..Self::default() };
        }
        if Node::of(path) == Ok(Node::File) && field::is_labels(path) {
            return Self { labels: only, ..Self::default() };
        }
        match Node::of(path) == Ok(Node::File) && field::is_mask(path) {
            true => Self { foregrounds: only, ..Self::default() },
            false => Self { flows: only, ..Self::default() },
        }
    }

    /// All of them, in order.
    fn all(&self) -> Vec<PathBuf> {
        let Self { flows, occlusions, disparities, next_disparities, foregrounds, labels, objects, .. } = self;
        let fields = [flows, occlusions, disparities, next_disparities, foregrounds, labels];
        fields.into_iter().flat_map(BTreeMap::values).chain(objects).cloned().collect()
    }
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
    /// Prefixes of its files in the folder itself, before the frame number.
    word: &'static str,
}

const FLOWS: Places =
    Places { inside: &["flow"], beside: &["flow_occ", "flow_noc"], across: &["flow", "other-gt-flow"], word: "flow" };
const OCCLUSIONS: Places = Places { inside: &["occ", "occlusions"], beside: &[], across: &["occlusions"], word: "occ" };
/// As KITTI has them, and `motionscope synth`.
const DISPARITIES: Places = Places {
    inside: &["disparity"],
    beside: &["disp_occ_0", "disp_occ", "disp_noc_0", "disp_noc"],
    across: &[],
    word: "disp",
};
/// Disparities in frame t + 1 of the pixels of frame t, as KITTI has them.
const NEXT_DISPARITIES: Places =
    Places { inside: &["next-disparity"], beside: &["disp_occ_1", "disp_noc_1"], across: &[], word: "next-disp" };
/// Labels of segments.
const LABELS: Places = Places { inside: &["labels", "segments"], beside: &["labels"], across: &[], word: "labels" };
/// The disparity of a left view in Middlebury's folders, by the name of the view.
const MIDDLEBURY: [[&str; 2]; 4] = [["im2", "disp2"], ["view1", "disp1"], ["im0", "disp0"], ["im0", "disp0GT"]];
/// As changedetection.net has them, and `motionscope synth`.
const FOREGROUNDS: Places =
    Places { inside: &["foreground", "groundtruth"], beside: &["groundtruth"], across: &[], word: "gt" };
/// The table of objects.
const TRACKS: &str = "gt.txt";
/// The tables of the region of one object in the folder of the frames or in the one above, as VOT and OTB have them.
const REGIONS: [&str; 2] = ["groundtruth.txt", "groundtruth_rect.txt"];
/// The folders of frames of these benchmarks.
const FRAMES_OF_REGIONS: [&str; 2] = ["color", "img"];

/// Whether truth of some clip may be looked for at `path`, going by its name and its folders.
pub(crate) fn is_place(path: &Path) -> bool {
    let folder = files::canonicalize(parent(path)).unwrap_or_else(|_| parent(path).into());
    let mut above = folder.ancestors().map(|folder| file_name(folder).to_lowercase());
    let [folder, beyond] = [above.next(), above.next()].map(Option::unwrap_or_default);
    let is_table = |name: &&str| file_name(path).eq_ignore_ascii_case(name);
    [TRACKS].iter().chain(&REGIONS).any(is_table)
        || [FLOWS, OCCLUSIONS, DISPARITIES, NEXT_DISPARITIES, FOREGROUNDS, LABELS].iter().any(
            |Places { inside, beside, across, word }| {
                inside.iter().chain(*beside).any(|name| **name == folder)
                    || across.iter().any(|name| **name == beyond)
                    || is_numbered(path, word)
            },
        )
}

/// Whether a file is called `word` and a number: `flow10`, `flow_10` or `flow-10`.
fn is_numbered(file: &Path, word: &str) -> bool {
    let stem = stem(file);
    let before = Numbered::parse(&stem).filter(|name| name.suffix.is_empty()).map(|name| name.prefix);
    before.and_then(|before| before.strip_prefix(word)).is_some_and(|between| matches!(between, "" | "_" | "-"))
}

/// The search for truth of one clip.
struct Search<'a> {
    subject: &'a Subject,
    /// Files that were skipped because they are saved results.
    results: Vec<PathBuf>,
}

impl Search<'_> {
    /// Those of `files` that are no results.
    fn known(&mut self, files: impl IntoIterator<Item = PathBuf>) -> Vec<PathBuf> {
        let (results, known): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| is_result(file));
        self.results.extend(results);
        known
    }

    /// The files in `folder` that `fit` and belong to a frame, by that frame.
    fn frames(&mut self, folder: &Path, fits: impl Fn(&Path) -> bool) -> BTreeMap<usize, PathBuf> {
        let subject = self.subject;
        let belongs = |file: &Path| subject.named(file).or_else(|| subject.numbered(file)).is_some();
        subject.by_frame(self.known(list(folder, |file| fits(file) && belongs(file))))
    }

    /// The files that `fit` in the first of `places` that has any for the clip.
    fn places(&mut self, places: &Places, folder: &Path, fits: fn(&Path) -> bool) -> BTreeMap<usize, PathBuf> {
        let whole = files::canonicalize(folder).unwrap_or_else(|_| folder.into());
        let inside = places.inside.iter().map(|name| folder.join(name));
        let beside = places.beside.iter().filter_map(|name| Some(whole.parent()?.join(name)));
        let across = places.across.iter();
        let across = across.filter_map(|name| Some(whole.parent()?.parent()?.join(name).join(whole.file_name()?)));
        let mut all = inside.chain(beside).chain(across.filter(|across| *across != whole));
        all.find_map(|place| Some(self.frames(&place, fits)).filter(|frames| !frames.is_empty())).unwrap_or_default()
    }

    fn flows(&mut self, folder: &Path) -> BTreeMap<usize, PathBuf> {
        let mut flows = self.places(&FLOWS, folder, is_flow);
        if self.subject.has_pictures() {
            let own = self.frames(folder, |file| extension(file) == "flo" && is_numbered(file, FLOWS.word));
            for (t, flow) in own.into_iter().chain(self.chairs(folder)) {
                flows.entry(t).or_insert(flow);
            }
        }
        flows
    }

    /// The flows of Flying Chairs: `00001_flow.flo` is that of `00001_img1.ppm`.
    fn chairs(&mut self, folder: &Path) -> BTreeMap<usize, PathBuf> {
        let subject = self.subject;
        let frame = |file: &Path| subject.called(&format!("{}_img1", stem(file).strip_suffix("_flow")?));
        let all = list(folder, |file| extension(file) == "flo" && frame(file).is_some());
        self.known(all).into_iter().filter_map(|file| Some((frame(&file)?, file))).collect()
    }

    fn occlusions(&mut self, folder: &Path) -> BTreeMap<usize, PathBuf> {
        let mut occlusions = self.places(&OCCLUSIONS, folder, is_png);
        let subject = self.subject;
        let is_mask = |file: &Path| is_png(file) && is_numbered(file, OCCLUSIONS.word) && subject.named(file).is_none();
        for (t, mask) in self.frames(folder, is_mask) {
            occlusions.entry(t).or_insert(mask);
        }
        occlusions
    }

    /// The disparities of the left view: as KITTI has them, beside it as `disp2.png` of `im2.png`, or numbered like it.
    fn disparities(&mut self, folder: &Path) -> BTreeMap<usize, PathBuf> {
        let mut disparities = self.places(&DISPARITIES, folder, is_disparity);
        let subject = self.subject;
        for [view, name] in MIDDLEBURY {
            let Some(t) = subject.called(view) else { continue };
            let files = list(folder, |file| is_disparity(file) && stem(file) == name);
            if let Some(file) = self.known(files).into_iter().next() {
                disparities.entry(t).or_insert(file);
            }
        }
        disparities
    }

    fn tracks(&mut self, folder: &Path) -> Option<PathBuf> {
        // MOTChallenge keeps the pictures in `img1`, what was detected in `det` and the tracks in `gt` beside both.
        let above = if folder.ends_with("img1") || folder.ends_with("det") { folder.parent() } else { None };
        let folders = [Some(folder), above].into_iter().flatten();
        let files = folders.flat_map(|folder| [folder.join(TRACKS), folder.join("gt").join(TRACKS)]);
        let above = folder.parent().filter(|_| FRAMES_OF_REGIONS.iter().any(|name| folder.ends_with(name)));
        let folders = [Some(folder), above].into_iter().flatten();
        let regions = folders.flat_map(|folder| REGIONS.map(|name| folder.join(name)));
        self.known(files.chain(regions).filter(|file| files::is_file(file))).into_iter().next()
    }
}

fn is_png(file: &Path) -> bool {
    extension(file) == "png"
}

fn is_flow(file: &Path) -> bool {
    is_png(file) || extension(file) == "flo"
}

fn is_disparity(file: &Path) -> bool {
    is_png(file) || extension(file) == "pfm"
}

/// The files in `folder` that `fit`, in natural order; none if it cannot be read.
fn list(folder: &Path, fits: impl Fn(&Path) -> bool) -> Vec<PathBuf> {
    let entries = files::entries(folder);
    let mut files: Vec<_> = entries.filter(|path| fits(path) && files::is_file(path)).collect();
    files.sort_by(|a, b| natural_order(&file_name(a), &file_name(b)));
    files
}

#[cfg(test)]
mod tests {
    use std::fs;

    use motionscope_core::data::{Clip, Disparity, Flow, ObjectBox};
    use motionscope_core::geometry::Grid;

    use super::*;
    use crate::media;
    use crate::media::export::{self, Pixels};

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
        media::open(path, &Open::default()).unwrap().clip
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
    fn labels_and_disparities_in_the_next_frame_are_found_and_given() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("image_2");
        pictures(&frames);
        let palette: Vec<u8> = (0..=255u8).flat_map(|c| [c, 0, 255 - c]).collect();
        let indices = [1, 1, 2, 2, 1, 1, 2, 2, 0, 0, 3, 3];
        let labels = export::png(4, 3, Pixels::Indexed(&indices, &palette)).unwrap();
        put(&frames, "labels/frame08.png", &labels);
        let map = Disparity(Grid::new(4, 3, 2.5));
        put(folder.path(), "disp_occ_1/frame08.png", export::kitti_disparity(&map).unwrap().bytes);
        let clip = open(&frames);
        let truth = clip.truth().expect("both are found");
        let found = truth.segments(1).unwrap().expect("labels of frame 8");
        assert_eq!(found.cells(), indices.map(u32::from));
        assert_eq!(truth.next_disparity(1).unwrap().unwrap().at(2, 1), Some(2.5));
        assert!(truth.segments(0).unwrap().is_none() && truth.disparity(1).unwrap().is_none());
        assert_eq!(truth.kinds(), ["next disparity", "segments"]);
        // A mask may have a palette, too.
        let mask: Vec<u8> = (0..=255u8).flat_map(|c| [if c == 0 { 0 } else { 255 }; 3]).collect();
        put(folder.path(), "mask.png", export::png(4, 3, Pixels::Indexed(&indices, &mask)).unwrap());
        let given = Given { truth: Some(folder.path().join("mask.png")), ..Given::default() };
        let masked = media::open(&frames, &Open { given, ..Open::default() }).unwrap().clip;
        assert_eq!(masked.truth().unwrap().kinds(), ["foreground"]);
        // Given by hand, a picture with a palette has labels.
        put(folder.path(), "by-hand.png", &labels);
        let given = Given { truth: Some(folder.path().join("by-hand.png")), ..Given::default() };
        let clip = media::open(&frames, &Open { given, ..Open::default() }).unwrap().clip;
        assert_eq!(clip.truth().unwrap().segments(0).unwrap().expect("of the first frame").cells().len(), 12);
        let colour = export::png(4, 3, Pixels::Gray(&[7; 12])).unwrap();
        put(&frames, "labels/frame08.png", colour);
        assert_eq!(
            open(&frames).truth().unwrap().segments(1).unwrap().unwrap()[(0, 0)],
            7,
            "gray levels are labels too"
        );
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
        let named = open(&folder.path().join("image_2/000001_10.png"));
        assert_eq!(named.truth().unwrap().names(), ["flow_occ/000001_10.png"]);
    }

    #[test]
    fn disparity_lies_where_the_benchmarks_have_it() {
        let map = Disparity(Grid::from_fn(4, 3, |x, _| if x == 0 { f32::NAN } else { 2.5 + x as f32 }));
        let picture = || export::png(4, 3, Pixels::Gray(&[9; 12])).unwrap();
        let levels: Vec<u8> = map.0.cells().iter().map(|d| (4.0 * d) as u8).collect();
        let [deep, scaled] =
            [export::kitti_disparity(&map).unwrap().bytes, export::png(4, 3, Pixels::Gray(&levels)).unwrap()];
        for (view, file, bytes, name) in [
            ("image_2/000003_10.png", "disp_occ_0/000003_10.png", deep.clone(), "disp_occ_0/000003_10.png"),
            ("im0.png", "disp0.pfm", export::pfm(&map), "disp0.pfm"),
            ("im2.png", "disp2.png", scaled.clone(), "disp2.png (4 gray levels per px)"),
            ("f_07.png", "disparity/f_07.pfm", export::pfm(&map), "disparity/f_07.pfm"),
        ] {
            let folder = tempfile::tempdir().unwrap();
            put(folder.path(), view, picture());
            put(folder.path(), file, &bytes);
            let by_hand = Given { disparity_scale: file.starts_with("disp2").then_some(4.0), ..Given::default() };
            let clip = media::open(&folder.path().join(view), &Open::from(by_hand.clone())).unwrap().clip;
            let truth = clip.truth().expect("a truth");
            assert_eq!((truth.kinds(), truth.names()), (vec!["disparity"], vec![name.to_owned()]));
            assert_eq!(*truth.disparity(0).unwrap().expect("known"), map, "{file}");
            // By hand, under the name of a disparity.
            let given = Given { truth: Some(folder.path().join(file)), ..by_hand };
            let clip = media::open(&folder.path().join(view), &Open::from(given)).unwrap().clip;
            assert_eq!(*clip.truth().unwrap().disparity(0).unwrap().expect("known"), map, "{file}");
            // A result there is none.
            export::save_result(&folder.path().join(file), &export::pfm(&map)).unwrap();
            if file.ends_with("pfm") {
                assert!(open(&folder.path().join(view)).truth().is_none(), "{file}");
            }
        }
    }

    #[test]
    fn flow_lies_where_flying_chairs_have_it() {
        let folder = tempfile::tempdir().unwrap();
        for pair in [1, 2] {
            for t in [1, 2] {
                let picture = export::png(4, 3, Pixels::Gray(&[9; 12])).unwrap();
                put(folder.path(), &format!("0000{pair}_img{t}.png"), picture);
            }
            put(folder.path(), &format!("0000{pair}_flow.flo"), export::flo(&flow(pair as f32)));
        }
        let u_of = |pair| u(&open(&folder.path().join(format!("0000{pair}_img1.png"))), 0);
        assert_eq!((u_of(1), u_of(2)), (Some(1.0), Some(2.0)));
    }

    #[test]
    fn only_the_names_of_benchmarks_count() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("whale");
        pictures(&frames);
        put(folder.path(), "whale.flo", export::flo(&flow(1.0)));
        for name in ["result_7.flo", "frame-0008_vectors.flo", "frame09.flo", "flow_of_07.flo", "flow07b.flo"] {
            put(&frames, name, export::flo(&flow(1.0)));
        }
        put(&frames, "occluded_by_me_7.png", export::png(4, 3, Pixels::Gray(&[255; 12])).unwrap());
        let clip = open(&frames);
        assert!(clip.truth().is_none() && clip.info().warnings.len() == 2, "{:?}", clip.info().warnings);
        put(&frames, "flow_07.flo", export::flo(&flow(2.0)));
        put(&frames, "flow-8.flo", export::flo(&flow(3.0)));
        let clip = open(&frames);
        assert_eq!((u(&clip, 0), u(&clip, 1), u(&clip, 2)), (Some(2.0), Some(3.0), None));
    }

    #[test]
    fn results_are_never_truth_and_truth_is_named() {
        let folder = tempfile::tempdir().unwrap();
        pictures(folder.path());
        let at = |name: &str| folder.path().join(name);
        put(folder.path(), "flow/frame_0007.flo", export::flo(&flow(7.0)));
        let pixels = vec![255; 12];
        for (name, bytes) in [
            ("flow08.flo", export::flo(&flow(8.0))),
            ("flow/frame_0009.png", export::kitti_result(&flow(9.0)).unwrap().bytes),
            ("occ_0008.png", export::png_result(4, 3, Pixels::Gray(&pixels)).unwrap()),
            (
                "gt.txt",
                export::mot(&[vec![ObjectBox { id: 1, x: 0.0, y: 0.0, width: 2.0, height: 2.0, visibility: 1.0 }]])
                    .into_bytes(),
            ),
        ] {
            export::save_result(&at(name), &bytes).unwrap();
        }
        let clip = open(folder.path());
        assert_eq!((0..4).map(|t| u(&clip, t)).collect::<Vec<_>>(), [Some(7.0), None, None, None]);
        let truth = clip.truth().unwrap();
        assert_eq!((truth.kinds(), truth.names()), (vec!["flow"], vec!["flow/frame_0007.flo".to_owned()]));
        let message = clip.info().warnings.join("\n");
        assert!(message.contains("frame_0009.png and 3 more are results that Motionscope wrote"), "{message}");
        // What others write there afterwards is truth again.
        put(folder.path(), "flow08.flo", export::flo(&flow(5.0)));
        let clip = open(folder.path());
        assert_eq!(u(&clip, 1), Some(5.0));
        assert_eq!(clip.truth().unwrap().names(), ["flow/frame_0007.flo and 1 other file"]);
        // A person may mean it.
        let options = Open::from(Given { truth: Some(at("flow/frame_0009.png")), ..Given::default() });
        let clip = media::open(folder.path(), &options).unwrap().clip;
        assert_eq!((u(&clip, 2), clip.truth().unwrap().names()), (Some(9.0), vec!["frame_0009.png".to_owned()]));
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
        assert_eq!(truth.names(), ["occ_0008.png", "gt/gt.txt"]);
        assert!(truth.occlusion(0).unwrap().is_none());
        assert!(truth.occlusion(1).unwrap().unwrap().cells().iter().all(|&hidden| hidden));
        assert_eq!(truth.objects(1).unwrap(), Some(vec![object]));
        assert_eq!(truth.objects(4).unwrap(), Some(vec![]));
    }

    #[test]
    fn the_region_of_one_object_lies_where_vot_and_otb_have_it() {
        for (frames, table) in
            [("color", "groundtruth.txt"), ("img", "groundtruth_rect.txt"), ("clip", "clip/groundtruth.txt")]
        {
            let folder = tempfile::tempdir().unwrap();
            pictures(&folder.path().join(frames));
            put(folder.path(), table, "1,1,3,2\n1,1,3,1,3,3,1,3\n");
            let clip = open(&folder.path().join(frames));
            let object = |width, height| ObjectBox { id: 1, x: -0.5, y: -0.5, width, height, visibility: 1.0 };
            let truth = clip.truth().expect("a truth");
            assert_eq!(truth.kinds(), ["objects"]);
            assert_eq!(truth.objects(0).unwrap(), Some(vec![object(3.0, 2.0)]));
            assert_eq!(truth.objects(1).unwrap(), Some(vec![object(2.0, 2.0)]));
            assert_eq!(truth.objects(2).unwrap(), Some(vec![]));
            // By hand, under any name, where a line has four numbers.
            put(folder.path(), "boxes.txt", "2,2,2,2\n");
            let options = Open::from(Given { truth: Some(folder.path().join("boxes.txt")), ..Given::default() });
            let clip = media::open(&folder.path().join(frames), &options).unwrap().clip;
            assert_eq!(clip.truth().unwrap().objects(0).unwrap().unwrap()[0].x, 0.5);
        }
        let folder = tempfile::tempdir().unwrap();
        pictures(folder.path());
        put(folder.path(), "groundtruth.txt", "1,1,3\n");
        let told = open(folder.path()).info().warnings.join("\n");
        assert!(told.contains("groundtruth.txt: line 1: 3 values"), "{told}");
    }

    #[test]
    fn foreground_lies_where_changedetection_has_it() {
        use motionscope_core::data::PixelClass::{Background, Foreground, Ignored, Shadow};
        let folder = tempfile::tempdir().unwrap();
        let levels = [0, 50, 85, 170, 255, 255, 0, 0, 0, 0, 0, 0];
        for t in [1, 2] {
            put(folder.path(), &format!("input/in00000{t}.png"), export::png(4, 3, Pixels::Gray(&[9; 12])).unwrap());
            put(
                folder.path(),
                &format!("groundtruth/gt00000{t}.png"),
                export::png(4, 3, Pixels::Gray(&levels)).unwrap(),
            );
        }
        let clip = open(&folder.path().join("input"));
        let truth = clip.truth().unwrap();
        assert_eq!(
            (truth.kinds(), truth.names()),
            (vec!["foreground"], vec!["groundtruth/gt000001.png and 1 other file".to_owned()])
        );
        let mask = truth.foreground(1).unwrap().unwrap();
        assert_eq!(mask.0.cells()[..6], [Background, Shadow, Ignored, Ignored, Foreground, Foreground]);
        assert!(truth.foreground(2).unwrap().is_none());
        // By hand: the folder, and a mask.
        for (given, count) in [("groundtruth", 2), ("groundtruth/gt000002.png", 1)] {
            let options = Open::from(Given { truth: Some(folder.path().join(given)), ..Given::default() });
            let clip = media::open(&folder.path().join("input"), &options).unwrap().clip;
            let known = (0..2).filter(|t| clip.truth().unwrap().foreground(*t).unwrap().is_some()).count();
            assert_eq!(known, count, "{given}");
        }
        put(folder.path(), "groundtruth/gt000001.png", export::png(5, 3, Pixels::Gray(&[0; 15])).unwrap());
        let warned = open(&folder.path().join("input")).info().warnings.join("\n");
        assert!(warned.contains("gt000001.png") && warned.contains("5×3"), "{warned}");
    }

    #[test]
    fn truth_that_does_not_fit_is_a_warning_beside_and_an_error_by_hand() {
        let folder = tempfile::tempdir().unwrap();
        pictures(folder.path());
        put(folder.path(), "flow/flow07.flo", export::flo(&Flow(Grid::new(5, 3, [0.0; 2]))));
        put(folder.path(), "gt.txt", "1,2,3");
        let clip = open(folder.path());
        assert!(clip.truth().is_none());
        let message = clip.info().warnings.join("\n");
        assert!(
            message.contains("flow07.flo") && message.contains("5×3") && message.contains("gt.txt: line 1"),
            "{message}"
        );
        for (name, why) in
            [("flow/flow07.flo", "5×3"), ("gt.txt", "line 1"), ("frame07.png", "16-bit"), ("gone", "no such")]
        {
            let options = Open::from(Given { truth: Some(folder.path().join(name)), ..Given::default() });
            let message = media::open(folder.path(), &options).unwrap_err().to_string();
            assert!(message.contains(name) && message.contains(why), "{message}");
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
            let options = Open::from(Given { truth: Some(folder.path().join(name)), ..Given::default() });
            let clip = media::open(folder.path(), &options).unwrap().clip;
            (u(&clip, 0), u(&clip, 1))
        };
        assert_eq!(by_hand("made/my.flo"), (Some(1.0), None));
        assert_eq!(by_hand("made/my08.flo"), (None, Some(2.0)));
        assert_eq!(by_hand("made"), (None, Some(2.0)));
        put(folder.path(), "whole/flow/frame_0007.flo", export::flo(&flow(3.0)));
        assert_eq!(by_hand("whole"), (Some(3.0), None));
    }
}
