//! The export of results: a module for each kind of file, and [`EXPORTS`], their list.
//!
//! The flags of `motionscope run`, the window's dialogs and the files follow from it.
//!
//! An [`Export`] declares the flag, the formats and the kinds of products; the protection of inputs and the writing follow from
//! it as well. A new kind of result is a module here and one in the core's `products`, with a line in each list.

mod cloud;
mod disparity;
mod flow;
mod labels;
mod masks;
mod pictures;
mod table;
mod tracks;

use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::products::{Output, ProductKind};

use crate::files;
use crate::media::export::{self, Target};
use crate::media::names::extension;

/// All exports; where two share a file extension, the window offers the first.
pub const EXPORTS: &[&Export] = &[
    &flow::EXPORT,
    &disparity::EXPORT,
    &table::EXPORT,
    &tracks::EXPORT,
    &masks::EXPORT,
    &labels::EXPORT,
    &pictures::EXPORT,
    &cloud::EXPORT,
];

/// An export of a product to files.
#[derive(Debug)]
pub struct Export {
    /// The flag on the command line, without dashes.
    pub flag: &'static str,
    /// The placeholder of the value in the help.
    pub value: &'static str,
    /// The help text.
    pub help: &'static str,
    /// The name in the window: `Masks`.
    pub name: &'static str,
    /// The content of the files, in one sentence.
    pub explained: &'static str,
    /// The kinds of products that can be exported so.
    pub takes: &'static [&'static ProductKind],
    /// The prefix of the file names, if several files are saved in a folder.
    pub folder: Option<&'static str>,
    /// Whether a path with the ending of its format is a single file, that of the last frame, and no folder.
    pub or_file: bool,
    /// The formats; the first is used for standard output.
    pub formats: &'static [Format],
}

/// Exports are equal if they have the same flag.
impl PartialEq for Export {
    fn eq(&self, other: &Self) -> bool {
        self.flag == other.flag
    }
}

/// A file format.
#[derive(Debug)]
pub struct Format {
    /// The file extension, in lower case.
    pub ending: &'static str,
    /// The name of the format.
    pub doc: &'static str,
    /// Encodes the file, or the files of a folder.
    pub encode: fn(&Output) -> Result<EncodedFiles, Error>,
}

/// The encoded files.
#[derive(Debug, Default, PartialEq)]
pub struct EncodedFiles {
    /// The bytes of each file, with its name where it goes into a folder.
    pub files: Vec<(String, Vec<u8>)>,
    /// Information that the format cannot hold, if any, as a clause.
    pub lost: Option<String>,
}

impl EncodedFiles {
    /// Returns one file without loss.
    fn file(bytes: impl Into<Vec<u8>>) -> Self {
        Self { files: vec![(String::new(), bytes.into())], lost: None }
    }
}

impl Export {
    /// Where it writes to at `path`.
    pub fn target<'a>(&self, path: &'a Path) -> Target<'a> {
        self.folder_at(path).map_or(Target::File(path), |begin| Target::Numbered(path, begin))
    }

    /// The prefix of the file names if `path` is a folder of several files.
    pub fn folder_at(&self, path: &Path) -> Option<&'static str> {
        let ending = extension(path);
        let is_file = self.or_file && self.formats.iter().any(|format| format.ending == ending);
        self.folder.filter(|_| !is_file)
    }

    /// Whether an estimator that makes products of `kinds` has something to be written so.
    pub fn can_write(&self, kinds: &[&ProductKind]) -> bool {
        self.takes.iter().any(|kind| kinds.contains(kind))
    }

    /// Refuses an estimator that makes nothing to be written so.
    ///
    /// # Errors
    /// A sentence with what it makes.
    pub fn check(&self, id: &str, kinds: &[&ProductKind]) -> Result<(), Error> {
        if self.can_write(kinds) {
            return Ok(());
        }
        let made: Vec<_> = kinds.iter().map(|kind| kind.name.to_lowercase()).collect();
        Err(Error::new(format!("{id} makes {}, which --{} cannot save; omit it", made.join(" and "), self.flag)))
    }

    /// The format that the ending of `path` asks for; the first for `-` and for a folder.
    ///
    /// # Errors
    /// A sentence that tells which endings there are.
    pub fn format(&self, path: &Path) -> Result<&'static Format, Error> {
        let ending = extension(path);
        let is_first = self.folder_at(path).is_some() || path == Path::new("-");
        let found = self.formats.iter().find(|format| is_first || format.ending == ending);
        found.ok_or_else(|| {
            let endings: Vec<_> = self.formats.iter().map(|format| format!(".{}", format.ending)).collect();
            Error::new(format!(
                "{}: --{} saves {}; - is standard output",
                path.display(),
                self.flag,
                endings.join(" or ")
            ))
        })
    }

    /// Writes `made` to `path`, each file whole or not at all; says what was written.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn save(&self, path: &Path, made: &EncodedFiles) -> Result<String, Error> {
        if self.folder_at(path).is_none() {
            made.files.last().map_or(Ok(()), |(_, bytes)| export::save_result(path, bytes))?;
            return Ok(files::label(path).to_string());
        }
        let save = || made.files.iter().try_for_each(|(name, bytes)| export::save_result(&path.join(name), bytes));
        export::fill_folder(path, save)?;
        let plural = if made.files.len() == 1 { "" } else { "s" };
        Ok(format!("{} file{plural} into {}", made.files.len(), files::label(path)))
    }
}

/// The formats of single files for an estimator that makes products of `kinds`, one for each ending; tables come first.
pub fn formats(kinds: &[&ProductKind]) -> Vec<(&'static Export, &'static Format)> {
    let mut all: Vec<(&'static Export, &'static Format)> = Vec::new();
    let able = |export: &&&Export| export.folder.is_none() && export.can_write(kinds);
    let tables_first = EXPORTS.iter().filter(|export| ***export == table::EXPORT);
    let others = EXPORTS.iter().filter(|export| ***export != table::EXPORT);
    for export in tables_first.chain(others).copied().filter(|export| able(&export)) {
        for format in export.formats {
            if all.iter().all(|(_, known)| known.ending != format.ending) {
                all.push((export, format));
            }
        }
    }
    all
}

/// The exports into folders for an estimator that makes products of `kinds`.
pub fn folders(kinds: &[&ProductKind]) -> impl Iterator<Item = &'static Export> {
    EXPORTS.iter().copied().filter(move |export| export.folder.is_some() && export.can_write(kinds))
}

/// Exports that were asked for on the command line, with their paths.
#[derive(Debug, Default)]
pub struct Asked(pub Vec<(&'static Export, PathBuf)>);

impl clap::Args for Asked {
    fn augment_args(command: clap::Command) -> clap::Command {
        EXPORTS.iter().fold(command, |command, export| {
            let flag = clap::Arg::new(export.flag).long(export.flag).value_name(export.value).help(export.help);
            command.arg(flag.value_parser(clap::value_parser!(PathBuf)))
        })
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for Asked {
    fn from_arg_matches(matches: &clap::ArgMatches) -> Result<Self, clap::Error> {
        let asked = |export: &&'static Export| Some((*export, matches.get_one::<PathBuf>(export.flag)?.clone()));
        Ok(Self(EXPORTS.iter().filter_map(asked).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &clap::ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::products::KINDS;

    use super::*;

    #[test]
    fn every_kind_of_product_can_be_written() {
        for kind in KINDS {
            assert!(EXPORTS.iter().any(|export| export.takes.contains(kind)), "{}", kind.id);
        }
        for (i, export) in EXPORTS.iter().enumerate() {
            assert!(EXPORTS[..i].iter().all(|other| other.flag != export.flag), "--{}", export.flag);
            assert!(!export.takes.is_empty() && !export.formats.is_empty(), "--{}", export.flag);
        }
    }

    #[test]
    fn the_ending_of_a_name_says_how_it_is_written() {
        let of = |export: &Export, name: &str| export.format(Path::new(name)).map(|format| format.ending);
        let flows = ["-", "a.FLO", "b.png", "c/d.npy"].map(|name| of(&flow::EXPORT, name).unwrap());
        assert_eq!(flows, ["flo", "flo", "png", "npy"]);
        let rows = ["-", "a.txt", "a.CSV", "b/c.npy"].map(|name| of(&tracks::EXPORT, name).unwrap());
        assert_eq!(rows, ["txt", "txt", "csv", "npy"]);
        assert!(of(&tracks::EXPORT, "a.png").unwrap_err().to_string().contains(".npy"));
        assert!(of(&table::EXPORT, "a").is_err() && of(&masks::EXPORT, "folder").is_ok());
        let folder = |name: &str| labels::EXPORT.folder_at(Path::new(name)).is_some();
        assert_eq!(["all", "a.PNG", "b/c.png", "d.npy"].map(folder), [true, false, false, true]);
        assert!(masks::EXPORT.folder_at(Path::new("masks.png")).is_some(), "masks are always a folder");
    }
}
