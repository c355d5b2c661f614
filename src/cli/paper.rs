//! Handouts and worksheets from the command line.

use std::path::{Path, PathBuf};

use clap::Args as Group;
use motionscope_core::base::Error;
use motionscope_core::run::Cursor;

use super::outputs::{check_folder, refuse_losses};
use super::print::say;
use crate::experiment::Prepared;
use crate::experiment::pixel::Chosen;
use crate::media::export::{Inputs, Target, save_result};
use crate::paint::Freehand;
use crate::session::lesson::Address;
use crate::session::lesson::handout::{handout, worksheet};
use crate::view::handout::{Options, PerSheet};
use crate::view::look::Look;
use crate::view::page::Stand;
use crate::view::paper::THEME;
use crate::view::worksheet::About;
use crate::work;

/// A worksheet of a step.
#[derive(Group)]
pub struct WorksheetArgs {
    /// Save a worksheet of the step as .pdf: what it computes is left out, with room to write.
    #[arg(long, help_heading = "Paper", value_name = "FILE.pdf")]
    pub worksheet: Option<PathBuf>,
    /// Fill in the answers of worksheet or handout.
    #[arg(long, help_heading = "Paper")]
    pub answers: bool,
}

/// A handout of a lesson.
#[derive(Group)]
pub struct HandoutArgs {
    /// Save all pages of the lesson on sheets of paper as one .pdf.
    #[arg(long, help_heading = "Paper", value_name = "FILE.pdf", conflicts_with_all = ["out", "animation", "worksheet", "steps"])]
    pub handout: Option<PathBuf>,
    /// Pages on a sheet of the handout: 1, 2 or 4.
    #[arg(long, help_heading = "Paper", value_name = "N", default_value = "2", value_parser = per_sheet, requires = "handout")]
    pub pages_per_sheet: PerSheet,
}

fn per_sheet(text: &str) -> Result<PerSheet, String> {
    text.parse().map_err(|error: Error| error.to_string())
}

impl WorksheetArgs {
    /// Refuses a file that is no PDF, or in no folder, and --answers without anything to be answered.
    ///
    /// # Errors
    /// One sentence.
    pub fn check(&self) -> Result<(), Error> {
        if self.answers && self.worksheet.is_none() {
            return Err(Error::new("--answers needs --worksheet FILE.pdf"));
        }
        self.worksheet.as_deref().map_or(Ok(()), |path| check_paper("worksheet", path))
    }

    /// Makes the worksheet of the step of a run.
    ///
    /// # Errors
    /// If the step computes nothing that can be asked for.
    pub fn encode(
        &self,
        prepared: &Prepared,
        (cursor, pixel): (Cursor, Option<Chosen>),
        look: Look,
    ) -> Result<Vec<u8>, Error> {
        let stand =
            Stand { prepared, cursor, pixel, look: Look { theme: THEME, ..look }, freehand: Freehand::default() };
        let title = prepared.experiment.info().name;
        work::finish(About { title, prose: None, answers: self.answers }.encode(&stand, None))
    }
}

/// Refuses a file that is no PDF, or in a folder that does not exist.
fn check_paper(flag: &str, path: &Path) -> Result<(), Error> {
    let is_pdf = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pdf"));
    if !is_pdf {
        return Err(Error::new(format!("--{flag} {}: its name must end in .pdf", path.display())));
    }
    check_folder(path)
}

/// What is asked for of a lesson.
pub struct Asked<'a> {
    /// A worksheet of the page.
    pub worksheet: &'a WorksheetArgs,
    /// A handout of all pages.
    pub handout: &'a HandoutArgs,
    /// Whether input files may be overwritten.
    pub force: bool,
}

/// Saves the handout of a lesson or the worksheet of a page, if one is `asked` for; gives whether it is.
///
/// # Errors
/// One sentence if the lesson is wrong, or the file cannot be written.
pub fn of_lesson(asked: &Asked<'_>, address: &Address) -> Result<bool, Error> {
    let answers = asked.worksheet.answers;
    let (flag, path) = match (&asked.handout.handout, &asked.worksheet.worksheet) {
        (Some(path), _) => ("handout", path),
        (None, Some(path)) => ("worksheet", path),
        (None, None) => return Ok(false),
    };
    check_paper(flag, path)?;
    let lesson = address.load()?;
    let guard = |inputs: &Inputs| refuse_losses(inputs, &[(flag, Target::File(path))], asked.force);
    let pdf = match flag {
        "handout" => {
            let options = Options { per_sheet: asked.handout.pages_per_sheet, answers };
            work::finish(handout(&lesson, options, &guard, None))?
        }
        _ => work::finish(worksheet((&lesson, address.page), answers, &guard, None))?,
    };
    save_result(path, &pdf)?;
    say(&format!("Saved {}.", path.display()))?;
    Ok(true)
}
