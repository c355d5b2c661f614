//! The glossary of the course: all terms by chapter, or one with its definition.

use motionscope_core::base::Error;
use motionscope_core::course::glossary::{Chapter, GLOSSARY, Term, lookup};
use serde_json::json;

/// All terms for a person, grouped by chapter in the order of the course.
pub fn text() -> String {
    Chapter::ALL.iter().map(|chapter| section(*chapter)).collect::<Vec<_>>().join("\n")
}

fn section(chapter: Chapter) -> String {
    let terms = GLOSSARY.iter().filter(|term| term.chapter == chapter);
    let entry = |term: &Term| format!("  {}\n      {}\n", title(term), term.definition);
    format!("{chapter}\n\n{}", terms.map(entry).collect::<String>())
}

/// One term for a person.
///
/// # Errors
/// If there is no such term: a sentence with similar ones.
pub fn entry(word: &str) -> Result<String, Error> {
    let term = lookup(word)?;
    let also = match &*term.aliases {
        [] => String::new(),
        aliases => format!("  Also: {}\n", aliases.join(", ")),
    };
    Ok(format!("{}\n  {}\n  Chapter: {}\n{also}", title(term), term.definition, term.chapter))
}

fn title(term: &Term) -> String {
    let symbol = term.symbol.map(|symbol| format!("  [{symbol}]")).unwrap_or_default();
    format!("{}{symbol}", term.name)
}

/// All terms for a script, sorted by name.
pub fn json() -> String {
    format!("{:#}", json!(GLOSSARY.iter().map(object).collect::<Vec<_>>()))
}

/// One term for a script.
///
/// # Errors
/// If there is no such term: a sentence with similar ones.
pub fn json_entry(word: &str) -> Result<String, Error> {
    Ok(format!("{:#}", object(lookup(word)?)))
}

fn object(term: &Term) -> serde_json::Value {
    json!({
        "term": term.name,
        "aliases": term.aliases,
        "symbol": term.symbol,
        "definition": term.definition,
        "chapter": term.chapter.title(),
    })
}
