//! Marks that distinguish saved results from ground truth, so that no estimator is compared with its own result.
//!
//! A PNG says so itself, in a text chunk. A `.flo` and MOTChallenge rows have no room for it (Middlebury's own reader refuses a
//! byte too many), so where their name is one of truth, a hidden list beside them does.

use std::io::BufReader;
use std::path::Path;

use motionscope_core::base::Error;

use super::save::{cannot_write, save};
use super::written_files::hash;
use crate::files::{self, File};
use crate::media::catch_panic::catch_panic;
use crate::media::names::extension;
use crate::media::sequence::parent;
use crate::media::truth;

/// The mark in saved PNG files; ground truth has none.
pub(super) const SOFTWARE: [&str; 2] = ["Software", "Motionscope"];
/// The file in which results are listed, a line for each; hidden, so that it is no part of a clip.
const LIST: &str = ".motionscope-results";

/// Writes the result of an estimator to `path`, whole or not at all, so that it is never taken for truth; `-` is the standard
/// output.
///
/// # Errors
/// As [`save`].
pub fn save_result(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let target = files::canonicalize(path).unwrap_or_else(|_| path.into());
    // Before it is there: a list that is ahead of its files does no harm.
    for place in [path, &target] {
        if path != Path::new("-") && is_listed_kind(place) && truth::is_place(place) {
            list(place, bytes).map_err(|error| cannot_write(path, &error))?;
        }
    }
    save(path, bytes)
}

/// Whether the file at `path` was written by [`save_result`] and is still as it was written.
pub(crate) fn is_result(path: &Path) -> bool {
    if is_listed_kind(path) { is_on_list(path) } else { extension(path) == "png" && says_so(path) }
}

/// Whether files of this kind cannot say what they are.
fn is_listed_kind(path: &Path) -> bool {
    matches!(extension(path).as_str(), "flo" | "pfm" | "txt")
}

/// Adds a line to the list in the folder of `path`, in one go, so that several programs may do it at a time.
fn list(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if lists(path, bytes) {
        return Ok(());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().replace(['\n', '\r'], " ");
    let line = format!("{:016x} {name}\n", hash(bytes));
    files::append(&parent(path).join(LIST), line.as_bytes())
}

fn is_on_list(path: &Path) -> bool {
    files::is_file(&parent(path).join(LIST)) && files::read(path).is_ok_and(|bytes| lists(path, &bytes))
}

/// Whether the list in the folder of `path` contains the hash of `bytes`, under any name.
fn lists(path: &Path, bytes: &[u8]) -> bool {
    let Ok(list) = files::read_to_string(&parent(path).join(LIST)) else { return false };
    let wanted = format!("{:016x} ", hash(bytes));
    list.lines().any(|line| line.starts_with(&wanted))
}

/// Whether the PNG at `path` is marked as a result; only its header is read.
fn says_so(path: &Path) -> bool {
    let texts = || {
        let reader = png::Decoder::new(BufReader::new(File::open(path).ok()?)).read_info().ok()?;
        Some(reader.info().uncompressed_latin1_text.clone())
    };
    let [keyword, text] = SOFTWARE;
    let texts = catch_panic(texts).ok().flatten().unwrap_or_default();
    texts.iter().any(|said| said.keyword == keyword && said.text == text)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::{Pixels, kitti_result, mot, png, png_result};
    use super::*;

    #[test]
    fn pictures_say_so_and_the_rest_is_listed_where_truth_is_looked_for() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let gray = Pixels::Gray(&[7; 6]);
        fs::write(at("made.png"), png_result(3, 2, gray).unwrap()).unwrap();
        fs::write(at("known.png"), png(3, 2, gray).unwrap()).unwrap();
        assert_eq!(["made.png", "known.png", "gone.png"].map(|name| is_result(&at(name))), [true, false, false]);
        let flow = motionscope_core::data::Flow(motionscope_core::geometry::Grid::new(2, 2, [1.0, 0.0]));
        fs::write(at("flow.png"), kitti_result(&flow).unwrap().bytes).unwrap();
        assert!(is_result(&at("flow.png")));

        save_result(&at("a.flo"), b"a").unwrap();
        assert!(!at(LIST).exists(), "nobody takes that name for truth");
        save_result(&at("flow10.flo"), b"b").unwrap();
        save_result(&at("gt.txt"), mot(&[]).as_bytes()).unwrap();
        save_result(&at("flow10.flo"), b"c").unwrap();
        assert!(is_result(&at("flow10.flo")) && is_result(&at("gt.txt")) && !is_result(&at("a.flo")));
        // It is still one by another name, and none once somebody wrote something else.
        fs::rename(at("flow10.flo"), at("flow11.flo")).unwrap();
        fs::write(at("flow10.flo"), "truth").unwrap();
        assert!(is_result(&at("flow11.flo")) && !is_result(&at("flow10.flo")));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_hides_no_place_of_truth() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("flow")).unwrap();
        std::os::unix::fs::symlink(at("flow"), at("results")).unwrap();
        save_result(&at("results/frame_0001.flo"), b"a").unwrap();
        assert!(is_result(&at("flow/frame_0001.flo")));
        fs::write(at("flow10.flo"), "truth").unwrap();
        std::os::unix::fs::symlink(at("flow10.flo"), at("mine.flo")).unwrap();
        save_result(&at("mine.flo"), b"b").unwrap();
        assert!(is_result(&at("flow10.flo")));
    }
}
