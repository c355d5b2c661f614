//! A path as a person types or pastes it.

use std::ffi::OsString;
use std::path::Path;

use crate::experiment::source::Source;
use crate::files::{self, IN_PAGE};
use crate::session::link::{Link, decoded_bytes};

/// A path or a link as typed or pasted: quotes, a leading `~` and `file://` are understood.
///
/// Of several lines the first that leads somewhere counts, or else the first.
pub fn parse(text: &str) -> Option<OsString> {
    // File managers copy remarks too, which are no links.
    let lines = text.lines().map(str::trim).filter(|line| *line != "#" && !line.starts_with("# "));
    let mut paths = lines.filter_map(line).peekable();
    let first = paths.next()?;
    if paths.peek().is_none() || leads_somewhere(&first) {
        return Some(first);
    }
    Some(paths.find(leads_somewhere).unwrap_or(first))
}

/// Whether a path is a link, or names a scene, a pair of pictures, or a file that is there.
pub fn leads_somewhere(path: &OsString) -> bool {
    let is_clip = || matches!(Source::typed(path), Ok(Source::Synth { .. } | Source::Pair(_)));
    // The folders of a page are its own.
    let is_there = || if IN_PAGE { files::is_file(Path::new(path)) } else { files::exists(Path::new(path)) };
    Link::is_one(path) || is_clip() || is_there()
}

fn line(text: &str) -> Option<OsString> {
    let text = text.trim_matches(['"', '\'']);
    if text.is_empty() {
        return None;
    }
    if let Some(url) = text.strip_prefix("file://") {
        let path = url.strip_prefix("localhost").unwrap_or(url);
        // A drive follows a slash: file:///C:/clips.
        let path = if cfg!(windows) { path.trim_start_matches('/') } else { path };
        return Some(decoded(path));
    }
    match (text.strip_prefix("~/"), files::home()) {
        (Some(rest), Some(home)) => Some(home.join(rest).into()),
        _ => Some(text.into()),
    }
}

/// A path with its `%20`s put back into bytes, as URLs have them.
fn decoded(text: &str) -> OsString {
    let bytes = decoded_bytes(text);
    #[cfg(unix)]
    return std::os::unix::ffi::OsStringExt::from_vec(bytes);
    #[cfg(not(unix))]
    String::from_utf8_lossy(&bytes).into_owned().into()
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn pasted_paths_are_understood() {
        let parsed = |text: &str| parse(text).map(|path| path.to_string_lossy().into_owned());
        assert_eq!(parsed("  \"/a b/c.mp4\" \n").as_deref(), Some("/a b/c.mp4"));
        assert_eq!(parsed("  "), None);
        if let Some(home) = std::env::var_os("HOME") {
            assert_eq!(parse("~/x.gif"), Some(std::path::Path::new(&home).join("x.gif").into()));
        }
    }

    #[cfg(unix)]
    #[test]
    fn what_file_managers_copy_is_decoded() {
        use std::os::unix::ffi::OsStrExt;
        assert_eq!(parse("file:///a/b.mp4"), Some("/a/b.mp4".into()));
        assert_eq!(parse("file:///a%20b/100%25.mp4"), Some("/a b/100%.mp4".into()));
        assert_eq!(parse("file://localhost/%C3%BCbung.mp4"), Some("/übung.mp4".into()));
        assert_eq!(parse("file:///caf%E9"), Some(std::ffi::OsStr::from_bytes(b"/caf\xE9").into()));
        assert_eq!(parse("file:///50%.mp4"), Some("/50%.mp4".into()));
        assert_eq!(parse("/a/100%20.mp4"), Some("/a/100%20.mp4".into()), "only a URL is coded");
    }

    #[test]
    fn of_several_lines_one_is_opened() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("b.mp4");
        std::fs::write(&file, []).unwrap();
        let there = file.display();
        assert_eq!(parse(&format!("# copied\r\n/no/such/a.mp4\r\n{there}\r\n")), Some(file.clone().into()));
        assert_eq!(parse("/no/a.mp4\n/no/b.mp4"), Some("/no/a.mp4".into()));
        assert_eq!(parse("look at\nsynth:pillar"), Some("synth:pillar".into()));
        assert_eq!(parse("look at\nhttps://a.org/#lesson:x"), Some("https://a.org/#lesson:x".into()));
        assert_eq!(parse("#lesson:kalman-filter/3"), Some("#lesson:kalman-filter/3".into()));
    }
}
