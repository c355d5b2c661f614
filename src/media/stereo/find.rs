//! Where the benchmarks have the right view and the calibration.

use std::path::{Path, PathBuf};

use crate::files;
use crate::media::companion::LeftView;
use crate::media::names::{extension, file_name, stem};
use crate::media::sequence::{Sequence, parent};
use crate::media::{Given, RightView};

/// The right view found beside a clip.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Right {
    /// One file for each picture of the left view, or the video.
    pub files: Vec<PathBuf>,
    /// Why a right view that is there cannot be used.
    pub incomplete: Option<String>,
}

/// Names of the views of one moment in Middlebury's folders.
const MIDDLEBURY: [[&str; 2]; 3] = [["im2", "im6"], ["view1", "view5"], ["im0", "im1"]];
/// What lies beside `im0` and `im1` if they are views of one moment.
const OF_STEREO: [&str; 3] = ["calib.txt", "disp0.pfm", "disp0GT.pfm"];
/// Folders of the views: KITTI's, with one and with two digits.
const FOLDERS: [[&str; 2]; 4] =
    [["image_0", "image_1"], ["image_2", "image_3"], ["image_00", "image_01"], ["image_02", "image_03"]];
/// The calibration of a pair.
const CALIBRATION: &str = "calib.txt";
/// The folders in which KITTI has one calibration for each picture.
const CALIBRATIONS: [&str; 2] = ["calib_cam_to_cam", "calib"];

/// Leaves out the pictures of `sequence` that are its right view: the given one, or the second of two that are called like a pair.
pub(crate) fn keep_left(sequence: &mut Sequence, given: &Given) {
    let files = &sequence.files;
    let is_given = |file: &PathBuf| match &given.right {
        Some(RightView::File(right)) => {
            files::canonicalize(right).is_ok_and(|right| files::canonicalize(file).is_ok_and(|f| f == right))
        }
        _ => false,
    };
    let cut = match files.as_slice() {
        [left, right] if given.right.is_none() && right_view(left).as_ref() == Some(right) => Some(1),
        _ => files.iter().position(is_given),
    };
    if let Some(cut) = cut.filter(|cut| *cut > 0) {
        sequence.cut(cut);
    }
}

/// The picture or video in the folder of `left` that is called like its right view.
pub(crate) fn right_view(left: &Path) -> Option<PathBuf> {
    let (folder, name) = (parent(left), stem(left));
    let of_pair = |[from, to]: &[&str; 2]| (*from == name).then(|| (*to).to_owned());
    let is_stereo = || OF_STEREO.iter().any(|file| files::is_file(&folder.join(file)));
    let known = MIDDLEBURY.iter().find_map(of_pair).filter(|right| right != "im1" || is_stereo());
    let right = known.or_else(|| mirrored(&name))?;
    let right = left.with_file_name(match extension(left).as_str() {
        "" => right,
        _ => format!("{right}.{}", left.extension()?.to_string_lossy()),
    });
    files::is_file(&right).then_some(right)
}

/// A name with `left` in it, with `right` in its place.
fn mirrored(name: &str) -> Option<String> {
    let pairs = [("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT")];
    let (left, right) = pairs.into_iter().find(|(left, _)| name.contains(left))?;
    Some(name.replacen(left, right, 1))
}

/// The folders that may hold the right view of pictures in `folder`.
fn folders(folder: &Path) -> Vec<PathBuf> {
    let whole = files::canonicalize(folder).unwrap_or_else(|_| folder.into());
    // KITTI's raw recordings have image_02/data.
    let inner = whole.file_name().filter(|name| *name == "data").map(PathBuf::from);
    let named = if inner.is_some() { whole.parent().unwrap_or(&whole).to_path_buf() } else { whole.clone() };
    let name = file_name(&named);
    let of_pair = |[from, to]: &[&str; 2]| (*from == name).then(|| (*to).to_owned());
    let beside = FOLDERS.iter().find_map(of_pair).or_else(|| mirrored(&name));
    let beside = beside.map(|name| named.with_file_name(name).join(inner.unwrap_or_default()));
    beside.into_iter().chain([whole.join("right")]).collect()
}

/// Looks for the right view of the clip.
pub(super) fn right(left: &LeftView<'_>) -> Right {
    let path = left.path;
    if path == Path::new("-") {
        return Right::default();
    }
    let Some(first) = left.files.first() else {
        let video = if files::is_file(path) { right_view(path) } else { None };
        return Right { files: video.into_iter().collect(), incomplete: None };
    };
    let beside: Option<Vec<_>> = left.files.iter().map(|file| right_view(file)).collect();
    if let Some(files) = beside {
        return Right { files, incomplete: None };
    }
    for folder in folders(parent(first)) {
        let files: Vec<_> = left.files.iter().map(|file| folder.join(file_name(file))).collect();
        match files.iter().find(|file| !files::is_file(file)) {
            None => return Right { files, incomplete: None },
            Some(missing) if files.iter().any(|file| files::is_file(file)) => {
                let why = format!("{} is missing in {}", file_name(missing), file_name(&folder));
                return Right { files: Vec::new(), incomplete: Some(why) };
            }
            Some(_) => {}
        }
    }
    Right::default()
}

/// The calibration beside the clip: of its own, or that of its first picture in KITTI's folders.
pub(crate) fn calibration_beside(left: &LeftView<'_>) -> Option<PathBuf> {
    let first = left.files.first().map(PathBuf::as_path).or(Some(left.path).filter(|path| *path != Path::new("-")))?;
    let whole = files::canonicalize(parent(first)).ok()?;
    let name = stem(first);
    // 000003_10 is picture 10 of clip 000003.
    let clip = name.split_once('_').map_or(name.as_str(), |(clip, _)| clip);
    let near = whole.ancestors().take(3);
    let of_picture =
        near.clone().flat_map(|folder| CALIBRATIONS.map(|name| folder.join(name).join(format!("{clip}.txt"))));
    near.take(2).map(|folder| folder.join(CALIBRATION)).chain(of_picture).find(|file| files::is_file(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_of(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        folder
    }

    /// The names of the right view of the left pictures `names`, from their folder.
    fn found(folder: &Path, names: &[&str]) -> Right {
        let files: Vec<_> = names.iter().map(|name| folder.join(name)).collect();
        right(&LeftView { path: &files[0], files: &files, size: (1, 1) })
    }

    #[test]
    fn the_right_view_lies_where_the_benchmarks_have_it() {
        for (left, right) in [
            ("im2.png", "im6.png"),
            ("view1.png", "view5.png"),
            ("scene_left.png", "scene_right.png"),
            ("Left.ppm", "Right.ppm"),
            ("image_2/000003_10.png", "image_3/000003_10.png"),
            ("image_0/000000.png", "image_1/000000.png"),
            ("image_02/data/0000000000.png", "image_03/data/0000000000.png"),
            ("left/a.png", "right/a.png"),
            ("a.png", "right/a.png"),
        ] {
            let folder = folder_of(&[left, right]);
            let Right { files, incomplete } = found(folder.path(), &[left]);
            let wanted = folder.path().join(right).canonicalize().unwrap();
            assert_eq!((files.len(), incomplete), (1, None), "{left}");
            assert_eq!(files[0].canonicalize().unwrap(), wanted);
        }
    }

    #[test]
    fn names_alone_do_not_make_a_pair() {
        for names in [["im0.png", "im1.png"], ["im2.png", "im3.png"], ["a.png", "b.png"], ["left.png", "right.jpg"]] {
            assert_eq!(found(folder_of(&names).path(), &names[..1]), Right::default(), "{names:?}");
        }
        assert_eq!(found(folder_of(&["im0.png", "im1.png", "calib.txt"]).path(), &["im0.png"]).files.len(), 1);
        let folder = folder_of(&["left/1.png", "left/2.png", "right/1.png"]);
        let Right { files, incomplete } = found(folder.path(), &["left/1.png", "left/2.png"]);
        assert_eq!((files.len(), incomplete.as_deref()), (0, Some("2.png is missing in right")));
    }

    #[test]
    fn the_second_of_a_pair_is_no_frame() {
        let kept = |names: &[&str], given: Given| {
            let folder = folder_of(names);
            let right = |path: &Path| folder.path().join(path);
            let given = Given { right: given.right.map(|view| view.map_path(right)), ..given };
            let mut sequence = Sequence::find(folder.path()).unwrap();
            keep_left(&mut sequence, &given);
            (sequence.files.len(), sequence.warnings.len())
        };
        assert_eq!(kept(&["im2.png", "im6.png"], Given::default()), (1, 0));
        assert_eq!(kept(&["im2.png", "im3.png", "im6.png"], Given::default()), (3, 1), "a camera that moves along");
        assert_eq!(kept(&["f1.png", "f2.png"], Given::default()), (2, 0));
        let given = Given { right: Some(RightView::File("f2.png".into())), ..Given::default() };
        assert_eq!(kept(&["f1.png", "f2.png"], given), (1, 0));
    }

    #[test]
    fn the_calibration_is_that_of_the_clip_or_of_the_picture() {
        for (left, calibration) in [
            ("im0.png", "calib.txt"),
            ("00/image_2/000000.png", "00/calib.txt"),
            ("image_2/000003_10.png", "calib_cam_to_cam/000003.txt"),
            ("training/image_2/000007.png", "training/calib/000007.txt"),
        ] {
            let folder = folder_of(&[left, calibration]);
            let files = [folder.path().join(left)];
            let found = calibration_beside(&LeftView { path: &files[0], files: &files, size: (1, 1) });
            assert_eq!(found, Some(folder.path().join(calibration).canonicalize().unwrap()), "{left}");
        }
    }
}
