//! Writes handouts and worksheets.

use motionscope_core::base::Error;

use super::snapshot::Snapshot;
use crate::experiment::pixel::Chosen;
use crate::files;
use crate::media::Progress;
use crate::media::export::{self, Inputs, Target};
use crate::paint::Freehand;
use crate::paint::charts::prose::Prose;
use crate::session::lesson::Lesson;
use crate::session::lesson::handout;
use crate::ui::commands::{Order, OutputKind};
use crate::view::look::Look;
use crate::view::page::Stand;
use crate::view::paper::THEME;
use crate::view::worksheet::About;

/// The page of a lesson that a worksheet is of.
pub struct OfPage {
    /// The titles of lesson and page.
    pub title: String,
    /// Its words.
    pub prose: Prose,
}

/// Writes the handout of `lesson`; says what was written.
///
/// # Errors
/// If a page cannot be shown, the file cannot be written, or the work was cancelled.
pub async fn handout(order: &Order, lesson: &Lesson, progress: &dyn Progress) -> Result<String, Error> {
    let OutputKind::Handout(options) = order.what else { return Err(Error::new("this is no handout")) };
    let name = order.path.file_name().unwrap_or(order.path.as_os_str()).to_string_lossy();
    let guard = |inputs: &Inputs| {
        let target = Target::File(&order.path);
        let refused = |why: String| Error::new(format!("{name} {why}; choose {}", target.other()));
        export::check(inputs, &[target]).map_err(|conflict| refused(conflict.why))
    };
    let pdf = handout::handout(lesson, options, &guard, Some(progress)).await?;
    saved(order, &pdf)
}

/// Writes the worksheet of the step that is `shown`; says what was written.
///
/// # Errors
/// If the step computes nothing that can be left out, the file cannot be written, or the work was cancelled.
pub async fn worksheet(
    order: &Order,
    shown: &Snapshot,
    page: Option<&OfPage>,
    progress: &dyn Progress,
) -> Result<String, Error> {
    let answers = order.what == OutputKind::Worksheet { answers: true };
    let (cursor, pixel) = (shown.cursor, shown.held().map(Chosen::Held));
    let stand = Stand {
        prepared: &shown.subject,
        cursor,
        pixel,
        look: Look { theme: THEME, ..order.look },
        freehand: Freehand::default(),
    };
    let title = page.map_or(shown.subject.experiment.info().name, |page| &page.title);
    let about = About { title, prose: page.map(|page| &page.prose), answers };
    saved(order, &about.encode(&stand, Some(progress)).await?)
}

fn saved(order: &Order, pdf: &[u8]) -> Result<String, Error> {
    export::save_result(&order.path, pdf)?;
    Ok(format!("Saved {}.", files::label(&order.path)))
}
