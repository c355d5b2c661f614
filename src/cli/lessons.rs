//! The lessons of the course: all of them, or the pages of one with their words.

use std::ffi::OsStr;

use motionscope_core::base::Error;
use serde_json::{Value, json};

use crate::session::lesson::{Address, Lesson, Page, all};

/// Lists the lessons, or the pages of the one that is named.
///
/// # Errors
/// If there is no such lesson, or its file cannot be read.
pub fn listed(name: Option<&OsStr>, as_json: bool) -> Result<String, Error> {
    let Some(name) = name else {
        let all = all();
        let text = || all.iter().map(|lesson| format!("{}\n    {}\n", title(lesson), lesson.summary)).collect();
        return Ok(if as_json { format!("{:#}", json!(all.iter().map(object).collect::<Vec<_>>())) } else { text() });
    };
    let unknown = || Error::new(format!("{} is no lesson; name one as lesson:NAME or by its file", name.display()));
    let address = Address::parse(name).ok_or_else(unknown)?;
    let lesson = address.load()?;
    lesson.check()?;
    let pages = || lesson.pages.iter().zip(1..).map(|(page, number)| written(page, number)).collect::<Vec<_>>();
    Ok(if as_json { format!("{:#}", object(&lesson)) } else { format!("{}\n\n{}", title(&lesson), pages().join("\n")) })
}

fn title(lesson: &Lesson) -> String {
    let pages = lesson.pages.len();
    let count = if pages == 1 { "1 page".to_owned() } else { format!("{pages} pages") };
    format!("lesson:{}  {} ({count})", lesson.slug, lesson.title)
}

/// A page for a person.
fn written(page: &Page, number: usize) -> String {
    let words = page.words.as_ref().map(|words| words.plain().replace('\n', "\n    ")).unwrap_or_default();
    format!("{number}  {}\n    {words}\n", page.title)
}

/// A lesson for a script.
fn object(lesson: &Lesson) -> Value {
    let page = |page: &Page| {
        let session = page.session.as_ref().ok();
        json!({
            "title": page.title,
            "clip": session.map(|session| session.experiment.source.to_string()),
            "estimator": session.map(|session| session.experiment.estimator.info().id),
            "step": session.and_then(|session| session.position.cursor).map(|cursor| cursor.to_string()),
            "until": page.until.map(|until| until.to_string()),
            "words": page.words.as_ref().map(|words| words.plain()).ok(),
            "notes": page.notes,
        })
    };
    let pages: Vec<_> = lesson.pages.iter().map(page).collect();
    json!({ "id": lesson.slug, "title": lesson.title, "summary": lesson.summary, "pages": pages })
}
