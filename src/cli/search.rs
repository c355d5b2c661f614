//! Search over lessons, glossary, estimators, parameters, charts and examples.

use motionscope_core::base::Error;
use serde_json::{Value, json};

use crate::search::{Hit, grouped, search, suggest};

/// Hits of a kind that are printed for a person.
const MOST: usize = 12;

/// What has all words of `query`, for a person, or all of it for a script.
///
/// # Errors
/// If nothing has, for a person.
pub fn found(query: &str, as_json: bool) -> Result<String, Error> {
    let hits = search(query);
    if as_json {
        return Ok(format!("{:#}", json!(hits.iter().map(object).collect::<Vec<_>>())));
    }
    if hits.is_empty() {
        let try_instead = match suggest(query) {
            Some(meant) => format!("did you mean {}?", Error::short_name(&meant)),
            None => "try fewer words, or the beginning of a word".to_owned(),
        };
        let query = Error::short_name(query);
        return Err(Error::new(format!("nothing has all words of {query}; {try_instead}")));
    }
    let group = |(kind, hits): (crate::search::Kind, Vec<&Hit>)| {
        let lines: String = hits.iter().take(MOST).map(|hit| line(hit)).collect();
        let more = match hits.len().saturating_sub(MOST) {
            0 => String::new(),
            more => format!("  and {more} more with --json\n"),
        };
        format!("{}\n\n{lines}{more}", kind.title())
    };
    Ok(grouped(&hits).into_iter().map(group).collect::<Vec<_>>().join("\n"))
}

/// A hit for a person: what it is, where it is from, the words around the match, and how to open it.
fn line(hit: &Hit) -> String {
    let Hit { title, place, excerpt, target, .. } = hit;
    format!("  {title} ({place})\n      {}\n      motionscope {}\n", excerpt.text, target.arguments())
}

/// A hit for a script.
fn object(hit: &Hit) -> Value {
    json!({
        "kind": hit.kind.id(),
        "title": hit.title,
        "place": hit.place,
        "excerpt": hit.excerpt.text,
        "arguments": hit.target.arguments(),
    })
}
