//! Which pictures make up a clip.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;

use super::cannot_read;
use super::names::{Numbered, extension, file_name, natural_order, stem};
use crate::files;

/// The pictures of a clip, in order.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Sequence {
    /// One file per frame.
    pub files: Vec<PathBuf>,
    /// Warnings about ignored files.
    pub warnings: Vec<String>,
}

impl Sequence {
    /// Returns the images of `path`: a folder, a pattern like `frame%02d.png`, or the first of numbered files.
    ///
    /// # Errors
    /// A sentence, without the path, if there are none or the folder cannot be read.
    pub(crate) fn find(path: &Path) -> Result<Self, Error> {
        Self::find_with(path, None)
    }

    /// The same as if there were a picture called `added` too, in the same folder.
    fn find_with(path: &Path, added: Option<&str>) -> Result<Self, Error> {
        if files::is_dir(path) {
            folder(path, added)
        } else if let Some(pattern) = Pattern::parse(path) {
            pattern.sequence(path, added)
        } else {
            numbered(path, added)
        }
    }

    /// Leaves out all pictures but the first `count`.
    pub(crate) fn cut(&mut self, count: usize) {
        self.files.truncate(count);
        if count < 2 {
            self.warnings.retain(|warning| !warning.starts_with(GAP));
        }
    }

    fn of_pictures(pictures: Vec<Picture>, mut warnings: Vec<String>) -> Self {
        warnings.extend(gap_warning(&pictures));
        Self { files: pictures.into_iter().map(|picture| picture.file).collect(), warnings }
    }
}

/// Whether `path` is a pattern like `frame%02d.png` rather than a file.
pub(crate) fn is_pattern(path: &Path) -> bool {
    Pattern::parse(path).is_some()
}

/// Whether a file at `added`, where there is none, would be another frame of the clip that `path` stands for, or make it another
/// clip altogether.
pub(crate) fn would_join(path: &Path, added: &Path) -> bool {
    let folder = if files::is_dir(path) { path } else { parent(path) };
    let whole = |folder: &Path| files::canonicalize(folder).ok();
    let name = file_name(added);
    if kind(&name).is_none() || whole(folder) != whole(parent(added)) {
        return false;
    }
    let is_of_series = || shape(&name).is_some_and(|of| shape(&file_name(path)) == Some(of)) && !files::exists(added);
    match (Sequence::find(path), Sequence::find_with(path, Some(&name))) {
        (Ok(now), Ok(then)) => now.files != then.files || is_of_series(),
        _ => false,
    }
}

/// Kinds of pictures by the extensions that they have.
const KINDS: [&[&str]; 6] =
    [&["png"], &["jpg", "jpeg"], &["tif", "tiff"], &["bmp"], &["pnm", "ppm", "pgm", "pbm", "pam"], &["webp"]];

fn kind(name: &str) -> Option<usize> {
    let extension = extension(Path::new(name));
    KINDS.iter().position(|kind| kind.contains(&extension.as_str()))
}

/// A file with its name as text, which is lossy if the name is not Unicode.
struct Picture {
    name: String,
    file: PathBuf,
}

/// The files in `folder` whose names `fit` and are not hidden, in natural order; as if there were one called `added`.
fn pictures_in(folder: &Path, added: Option<&str>, fits: impl Fn(&str) -> bool) -> Result<Vec<Picture>, Error> {
    let mut pictures = Vec::new();
    if let Some(name) = added.filter(|name| !name.starts_with('.') && fits(name) && !files::exists(&folder.join(name)))
    {
        pictures.push(Picture { name: name.to_owned(), file: folder.join(name) });
    }
    for entry in files::read_dir(folder).map_err(|e| cannot_read(&e))? {
        let entry = entry.map_err(|e| cannot_read(&e))?;
        let name = file_name(&entry);
        if !name.starts_with('.') && fits(&name) && files::is_file(&entry) {
            pictures.push(Picture { name, file: entry });
        }
    }
    pictures.sort_by(|a, b| natural_order(&a.name, &b.name).then_with(|| a.file.cmp(&b.file)));
    Ok(pictures)
}

/// Pictures of the most common kind; of these the numbered ones alone if they are most, or one of several series.
fn folder(path: &Path, added: Option<&str>) -> Result<Sequence, Error> {
    let mut pictures = pictures_in(path, added, |name| kind(name).is_some())?;
    let all = pictures.len();
    let common = most(pictures.iter().filter_map(|picture| kind(&picture.name)));
    pictures.retain(|picture| kind(&picture.name) == common);
    if let Some(pattern) = most(pictures.iter().filter_map(|picture| shape(&picture.name))) {
        let fits = |picture: &Picture| shape(&picture.name).as_ref() == Some(&pattern);
        if pictures.iter().filter(|picture| fits(picture)).count() * 2 > pictures.len() {
            pictures.retain(fits);
        } else if let Some(series) = one_of_several(&pictures) {
            pictures.retain(|picture| series_of(&picture.name).as_ref() == Some(&series));
        }
    }
    let Some(Picture { name: first, .. }) = pictures.first() else {
        return Err(Error::new(
            "the folder holds no pictures; choose one with PNG, JPEG, TIFF, BMP, PNM or WebP files, or a video file",
        ));
    };
    let warning = match all - pictures.len() {
        0 => None,
        1 => Some(format!("1 picture of the folder is ignored, because its name does not match {first}")),
        n => Some(format!("{n} pictures of the folder are ignored, because their names do not match {first}")),
    };
    Ok(Sequence::of_pictures(pictures, warning.into_iter().collect()))
}

/// The value that comes most often; of several the least.
fn most<T: Ord>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut counts = BTreeMap::new();
    for value in values {
        *counts.entry(value).or_insert(0_usize) += 1;
    }
    // Reversed, because the last of several equals is taken.
    counts.into_iter().rev().max_by_key(|(_, count)| *count).map(|(value, _)| value)
}

/// All of a numbered name but the number.
fn shape(name: &str) -> Option<(String, String, String)> {
    let path = Path::new(name);
    let stem = stem(path);
    let number = Numbered::parse(&stem)?;
    Some((number.prefix.into(), number.suffix.into(), extension(path)))
}

/// All of a numbered name but its numbers: `000003_10.png` and `000004_11.png` are of one series.
fn series_of(name: &str) -> Option<String> {
    let (prefix, suffix, extension) = shape(name)?;
    let prefix: String = prefix.chars().filter(|c| !c.is_ascii_digit()).collect();
    Some(format!("{prefix}0{suffix}.{extension}"))
}

/// Names of ground-truth images in benchmarks that keep them beside the frames.
const TRUTH: [&str; 6] = ["disp", "flow", "occ", "mask", "depth", "gt"];

/// Whether pictures or a folder of this name hold ground truth in benchmarks.
pub(crate) fn is_called_truth(name: &str) -> bool {
    TRUTH.iter().any(|truth| name.to_ascii_lowercase().starts_with(truth))
}

/// The series with the most pictures, if there are several; of equals one that is not called like truth.
fn one_of_several(pictures: &[Picture]) -> Option<String> {
    let mut counts = BTreeMap::new();
    for series in pictures.iter().filter_map(|picture| series_of(&picture.name)) {
        *counts.entry(series).or_insert(0_usize) += 1;
    }
    counts.retain(|_, count| *count > 1);
    let several = counts.len() > 1;
    // Reversed, because the last of several equals is taken.
    let best = counts.into_iter().rev().max_by_key(|(series, count)| (*count, !is_called_truth(series)));
    best.map(|(series, _)| series).filter(|_| several)
}

/// Returns the image at `path` and those with larger numbers.
fn numbered(path: &Path, added: Option<&str>) -> Result<Sequence, Error> {
    let name = file_name(path);
    let Some(wanted) = shape(&name) else {
        return Ok(Sequence { files: vec![path.into()], warnings: vec![] });
    };
    let folder = parent(path);
    let mut pictures = pictures_in(folder, added, |other| shape(other).as_ref() == Some(&wanted))?;
    let Some(start) = pictures.iter().position(|other| other.file.file_name() == path.file_name()) else {
        return Ok(Sequence { files: vec![path.into()], warnings: vec![] });
    };
    let warning = match start {
        0 => None,
        n => Some(format!("the clip starts at {name}; open {} to include the {n} before it", pictures[0].name)),
    };
    Ok(Sequence::of_pictures(pictures.split_off(start), warning.into_iter().collect()))
}

/// The folder that holds `path`, never empty.
pub(crate) fn parent(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// `frame%02d.png` taken apart.
struct Pattern {
    prefix: String,
    suffix: String,
    digits: usize,
}

impl Pattern {
    fn parse(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (prefix, rest) = name.split_once('%')?;
        let (digits, suffix) = rest.split_once('d')?;
        let digits = match digits {
            "" => 0,
            _ => digits.strip_prefix('0')?.parse().ok().filter(|digits| *digits < 20)?,
        };
        // A file may really be called so.
        (!files::exists(path)).then(|| Self { prefix: prefix.into(), suffix: suffix.into(), digits })
    }

    fn fits(&self, name: &str) -> bool {
        let digits = name.strip_prefix(&self.prefix).and_then(|rest| rest.strip_suffix(&self.suffix));
        let number = digits.and_then(|digits| digits.parse::<u64>().ok());
        number.is_some_and(|number| digits == Some(&format!("{number:0width$}", width = self.digits)))
    }

    fn sequence(&self, path: &Path, added: Option<&str>) -> Result<Sequence, Error> {
        let folder = parent(path);
        let pictures = pictures_in(folder, added, |name| self.fits(name))?;
        if pictures.is_empty() {
            return Err(Error::new("no file fits this pattern; check the folder and the number of digits"));
        }
        Ok(Sequence::of_pictures(pictures, vec![]))
    }
}

/// How the warning of missing numbers begins.
const GAP: &str = "numbers are missing between";

/// Tells of numbers that are missing between the pictures.
fn gap_warning(pictures: &[Picture]) -> Option<String> {
    let shapes: Vec<_> = pictures.iter().map(|picture| shape(&picture.name)).collect();
    if shapes.windows(2).any(|pair| pair[0].is_none() || pair[0] != pair[1]) {
        return None;
    }
    let gap = |pair: &&[Picture]| number(&pair[1].name) > number(&pair[0].name).map(|n| n.saturating_add(1));
    let gaps = pictures.windows(2).filter(gap).count();
    let first = pictures.windows(2).find(gap)?;
    let others = match gaps - 1 {
        0 => String::new(),
        1 => " and in 1 more place".into(),
        n => format!(" and in {n} more places"),
    };
    let [before, after] = [&first[0].name, &first[1].name];
    Some(format!("{GAP} {before} and {after}{others}; the pictures are taken as consecutive"))
}

/// The number in the name of a picture.
pub(crate) fn number(name: &str) -> Option<u64> {
    Numbered::parse(&stem(Path::new(name))).map(|n| n.number)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn with_files(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            fs::write(folder.path().join(name), "").unwrap();
        }
        folder
    }

    fn found(folder: &Path, name: &str) -> (Vec<String>, Vec<String>) {
        let sequence = Sequence::find(&folder.join(name)).unwrap();
        (sequence.files.iter().map(|file| file_name(file)).collect(), sequence.warnings)
    }

    #[test]
    fn a_numbered_picture_opens_those_after_it() {
        let folder = with_files(&["f9.png", "f10.png", "f11.png", "g12.png", "f12.jpg", "f10.flo", "cat.png"]);
        assert_eq!(found(folder.path(), "f9.png"), (vec!["f9.png".into(), "f10.png".into(), "f11.png".into()], vec![]));
        let (names, warnings) = found(folder.path(), "f10.png");
        assert_eq!(names, ["f10.png", "f11.png"]);
        assert_eq!(warnings, ["the clip starts at f10.png; open f9.png to include the 1 before it"]);
        assert_eq!(found(folder.path(), "cat.png"), (vec!["cat.png".into()], vec![]));
    }

    #[test]
    fn a_folder_is_its_most_common_pictures() {
        let folder = with_files(&["f1.png", "f2.png", "f3.png", "occ_1.png", "occ_2.png", "a.jpg", "b.txt", ".f4.png"]);
        let (names, warnings) = found(folder.path(), "");
        assert_eq!(names, ["f1.png", "f2.png", "f3.png"]);
        assert_eq!(warnings, ["3 pictures of the folder are ignored, because their names do not match f1.png"]);
        let holiday = with_files(&["zoo.JPG", "beach.jpeg", "IMG_7.jpg"]);
        assert_eq!(found(holiday.path(), "").0, ["IMG_7.jpg", "beach.jpeg", "zoo.JPG"]);
        assert!(Sequence::find(with_files(&["a.txt"]).path()).unwrap_err().to_string().contains("no pictures"));
    }

    #[test]
    fn of_two_series_one_is_opened() {
        let stereo = with_files(&["disp2.png", "disp6.png", "im2.png", "im6.png"]);
        let (names, warnings) = found(stereo.path(), "");
        assert_eq!(names, ["im2.png", "im6.png"]);
        assert_eq!(warnings[0], "2 pictures of the folder are ignored, because their names do not match im2.png");
        let (names, _) = found(with_files(&["b1.png", "b2.png", "b3.png", "a1.png", "a2.png", "x.png"]).path(), "");
        assert_eq!(names, ["b1.png", "b2.png", "b3.png"]);
        // One series whose clips are numbered too, and pictures of a holiday.
        for all in [["000_10.png", "000_11.png", "001_10.png", "001_11.png"], ["a.png", "b.png", "p1.png", "p2.png"]] {
            assert_eq!(found(with_files(&all).path(), ""), (all.map(String::from).to_vec(), vec![]));
        }
    }

    #[test]
    fn a_picture_that_would_change_the_clip_is_reported() {
        let numbered = with_files(&["f1.png", "f2.png", "f3.png", "step_1.png"]);
        let (series, holiday) = (numbered.path(), with_files(&["a.png", "b.png"]));
        let joins = |opened: &Path, added: &Path| would_join(opened, added);
        assert!(joins(series, &series.join("f4.png")) && joins(&series.join("f2.png"), &series.join("f4.png")));
        assert!(joins(&series.join("f%d.png"), &series.join("f4.png")));
        assert!(joins(&series.join("f2.png"), &series.join("f0.png")), "it is of the same series");
        assert!(joins(holiday.path(), &holiday.path().join("c.png")));
        let free =
            [series.join("step_2.png"), series.join("f4.svg"), series.join("f4.jpg"), holiday.path().join("f4.png")];
        assert!(!free.iter().any(|added| joins(series, added)));
        assert!(!joins(&series.join("f2.png"), &series.join("g4.png")));
    }

    #[test]
    fn gaps_are_reported() {
        let folder = with_files(&["f1.png", "f2.png", "f5.png", "f9.png"]);
        let message = "numbers are missing between f2.png and f5.png and in 1 more place; the pictures are taken as \
                    consecutive";
        assert_eq!(found(folder.path(), "").1, [message]);
    }

    #[test]
    fn a_pattern_takes_the_numbers_it_would_print() {
        let folder = with_files(&["f07.png", "f08.png", "f100.png", "f9.png", "%d.png"]);
        assert_eq!(found(folder.path(), "f%02d.png").0, ["f07.png", "f08.png", "f100.png"]);
        assert_eq!(found(folder.path(), "f%d.png").0, ["f9.png", "f100.png"]);
        assert_eq!(found(folder.path(), "%d.png").0, ["%d.png"]);
        assert!(Sequence::find(&folder.path().join("g%d.png")).unwrap_err().to_string().contains("pattern"));
    }
}
