//! Truth that lies in files: exact flow, occlusion, tracks, foreground. Found beside a clip, or given by hand.

mod field;
mod find;
pub(super) mod mot;
mod region;
mod subject;

use std::collections::{BTreeMap, VecDeque};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use motionscope_core::base::Error;
use motionscope_core::data::{Disparity, Flow, ObjectBox, TrueMask, Truth};
use motionscope_core::geometry::Grid;

use super::names::file_name;
use super::sequence::parent;
use crate::files;

pub(super) use field::depth;
pub(crate) use find::{GroundTruth, is_place};
use subject::Subject;

/// Truth in files: a field is read when it is asked for, and the last few are kept.
struct Files {
    size: (usize, usize),
    flows: BTreeMap<usize, PathBuf>,
    occlusions: BTreeMap<usize, PathBuf>,
    disparities: BTreeMap<usize, PathBuf>,
    /// Gray levels per px of disparity in 8-bit pictures, if given.
    scale: Option<f32>,
    /// Disparities in frame t + 1 of the pixels of frame t.
    next_disparities: BTreeMap<usize, PathBuf>,
    foregrounds: BTreeMap<usize, PathBuf>,
    labels: BTreeMap<usize, PathBuf>,
    objects: Option<Objects>,
    /// The file names of each kind.
    names: Vec<String>,
    last_flows: Mutex<Last<Flow>>,
    last_occlusions: Mutex<Last<Grid<bool>>>,
    last_disparities: Mutex<Last<Disparity>>,
    last_next: Mutex<Last<Disparity>>,
    last_foregrounds: Mutex<Last<TrueMask>>,
    last_labels: Mutex<Last<Grid<u32>>>,
}

/// The true objects of each frame, and the file that they were read from.
struct Objects {
    path: PathBuf,
    tracks: mot::Tracks,
}

impl Files {
    fn new(size: (usize, usize)) -> Self {
        Self {
            size,
            flows: BTreeMap::new(),
            occlusions: BTreeMap::new(),
            disparities: BTreeMap::new(),
            scale: None,
            next_disparities: BTreeMap::new(),
            foregrounds: BTreeMap::new(),
            labels: BTreeMap::new(),
            objects: None,
            names: Vec::new(),
            last_flows: Mutex::default(),
            last_occlusions: Mutex::default(),
            last_disparities: Mutex::default(),
            last_next: Mutex::default(),
            last_foregrounds: Mutex::default(),
            last_labels: Mutex::default(),
        }
    }

    fn is_empty(&self) -> bool {
        self.kinds().is_empty()
    }

    /// Has the files called as they are found from `folder`.
    fn tell_from(&mut self, folder: &Path) {
        let named = |files: &BTreeMap<usize, PathBuf>| {
            let first = name_from(folder, files.values().next()?);
            Some(match files.len() - 1 {
                0 => first,
                1 => format!("{first} and 1 other file"),
                others => format!("{first} and {others} other files"),
            })
        };
        // The scale decides every figure, and is only known by the name of the file.
        let scale =
            self.disparities.values().next().and_then(|first| field::scale(first, self.size, self.scale).ok()?);
        let scale = scale.map_or_else(String::new, |scale| format!(" ({scale} gray levels per px)"));
        let disparity = named(&self.disparities).map(|name| name + &scale);
        let objects = self.objects.iter().map(|objects| name_from(folder, &objects.path));
        let fields = [&self.flows, &self.occlusions].into_iter().filter_map(named).chain(disparity).chain(objects);
        let rest = [&self.foregrounds, &self.next_disparities, &self.labels].into_iter().filter_map(named);
        self.names = fields.chain(rest).collect();
    }
}

impl Truth for Files {
    fn flow(&self, t: usize) -> Result<Option<Arc<Flow>>, Error> {
        keep(&self.last_flows, t, &self.flows, |path| field::flow(path, self.size))
    }

    fn is_of_plane(&self, t: usize) -> bool {
        self.flows.get(&t).is_some_and(|path| field::is_homography(path))
    }

    fn occlusion(&self, t: usize) -> Result<Option<Arc<Grid<bool>>>, Error> {
        keep(&self.last_occlusions, t, &self.occlusions, |path| field::mask(path, self.size))
    }

    fn objects(&self, t: usize) -> Result<Option<Vec<ObjectBox>>, Error> {
        Ok(self.objects.as_ref().map(|objects| objects.tracks.objects.get(&t).cloned().unwrap_or_default()))
    }

    fn ignored_objects(&self, t: usize) -> Result<Vec<ObjectBox>, Error> {
        Ok(self.objects.as_ref().and_then(|objects| objects.tracks.ignored.get(&t).cloned()).unwrap_or_default())
    }

    fn foreground(&self, t: usize) -> Result<Option<Arc<TrueMask>>, Error> {
        keep(&self.last_foregrounds, t, &self.foregrounds, |path| field::foreground(path, self.size))
    }

    fn segments(&self, t: usize) -> Result<Option<Arc<Grid<u32>>>, Error> {
        keep(&self.last_labels, t, &self.labels, |path| field::labels(path, self.size))
    }

    fn next_disparity(&self, t: usize) -> Result<Option<Arc<Disparity>>, Error> {
        let read = |path: &Path| field::disparity(path, self.size, self.scale);
        keep(&self.last_next, t, &self.next_disparities, read)
    }

    fn disparity(&self, t: usize) -> Result<Option<Arc<Disparity>>, Error> {
        let read = |path: &Path| field::disparity(path, self.size, self.scale);
        keep(&self.last_disparities, t, &self.disparities, read)
    }

    fn kinds(&self) -> Vec<&'static str> {
        let kinds = [
            ("flow", !self.flows.is_empty()),
            ("occlusion", !self.occlusions.is_empty()),
            ("disparity", !self.disparities.is_empty()),
            ("objects", self.objects.is_some()),
            ("foreground", !self.foregrounds.is_empty()),
            ("next disparity", !self.next_disparities.is_empty()),
            ("segments", !self.labels.is_empty()),
        ];
        kinds.into_iter().filter_map(|(name, known)| known.then_some(name)).collect()
    }

    fn names(&self) -> Vec<String> {
        self.names.clone()
    }
}

/// Returns `file` relative to `folder`: its name, with folders if it lies elsewhere.
pub(super) fn name_from(folder: &Path, file: &Path) -> String {
    /// Truth and right views lie two folders up at most.
    const UP: usize = 3;
    let whole = |folder: &Path| files::canonicalize(folder).unwrap_or_else(|_| folder.into());
    let (from, to) = (whole(folder), whole(parent(file)).join(file_name(file)));
    let near = from.ancestors().take(UP).find_map(|above| to.strip_prefix(above).ok());
    near.map_or_else(|| file_name(file), |near| near.display().to_string())
}

/// The last fields that were asked for, newest at the back.
type Last<T> = VecDeque<(usize, Arc<T>)>;

/// Enough for a pair of neighbours in both directions; a 1080p flow takes 16 MiB.
const KEPT: usize = 4;

fn keep<T>(
    last: &Mutex<Last<T>>,
    t: usize,
    files: &BTreeMap<usize, PathBuf>,
    read: impl FnOnce(&Path) -> Result<T, Error>,
) -> Result<Option<Arc<T>>, Error> {
    let Some(path) = files.get(&t) else { return Ok(None) };
    let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
    let field = match last.iter().position(|(kept, _)| *kept == t).and_then(|i| last.remove(i)) {
        Some((_, field)) => field,
        None => Arc::new(read(path)?),
    };
    last.push_back((t, Arc::clone(&field)));
    if last.len() > KEPT {
        last.pop_front();
    }
    Ok(Some(field))
}

/// Returns the error about the ground truth at `path`.
fn file_error(path: &Path, why: impl Display) -> Error {
    Error::new(format!("{}: {why}", files::label(path)))
}
