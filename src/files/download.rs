//! Downloads: a page saves files to memory as to a disk, then hands them to the browser. A folder becomes a zip file.

use std::path::{Path, PathBuf};

use motionscope_core::base::Error;

use super::memory::{self, Bytes, SAVED};
use super::{IN_PAGE, exists, zip};

/// Where a file that the user calls `path` is written: there on the desktop, and in the folder of downloads in a page, which
/// knows no other folders.
pub fn target(path: &Path) -> PathBuf {
    if IN_PAGE { place(path) } else { path.to_owned() }
}

fn place(path: &Path) -> PathBuf {
    let folder = Path::new(SAVED);
    // In a tree of its own nothing is in the way.
    memory::lock().make_folders(folder).unwrap_or_default();
    path.file_name().map_or_else(|| folder.join("motionscope"), |name| folder.join(name))
}

/// Hands the file or folder saved at `path` over to the browser, and forgets it; on the desktop it stays. Returns the `outcome` of saving.
///
/// # Errors
/// The error of `outcome`, or that the browser does not take the file.
pub fn hand_over<T>(path: &Path, outcome: Result<T, Error>) -> Result<T, Error> {
    if !path.starts_with(SAVED) || !super::is_in_memory(path) {
        return outcome;
    }
    let handed = outcome.and_then(|value| download(path).map(|()| value));
    memory::lock().remove_all(path);
    handed
}

fn download(path: &Path) -> Result<(), Error> {
    let (name, bytes) = content(path)?;
    #[cfg(target_arch = "wasm32")]
    super::page::download(&name, bytes.as_ref())?;
    #[cfg(not(target_arch = "wasm32"))]
    let _ = (name, bytes);
    Ok(())
}

/// The name and the bytes of the file at `path`, or of a zip file of the folder there.
fn content(path: &Path) -> Result<(String, Bytes), Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if !exists(path) {
        return Err(Error::new(format!("{name} was not written; save it again")));
    }
    let memory = memory::lock();
    if let Ok(bytes) = memory.file(path) {
        return Ok((name, bytes));
    }
    let below = memory.below(path).filter_map(|file| {
        let inner = file.strip_prefix(path).ok()?;
        // The list of files in a folder is not part of the download.
        let is_hidden = inner.file_name()?.to_string_lossy().starts_with('.');
        let bytes = memory.file(file).ok().filter(|_| !is_hidden)?;
        Some((Path::new(&name).join(inner).to_string_lossy().replace('\\', "/"), bytes))
    });
    Ok((format!("{name}.zip"), zip::stored(&below.collect::<Vec<_>>())?.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files;

    #[test]
    fn a_file_keeps_its_name_and_a_folder_becomes_a_zip_file() {
        let file = place(Path::new("a.png"));
        files::save(&file, b"picture").unwrap();
        assert_eq!(content(&file).unwrap(), ("a.png".into(), b"picture".to_vec().into()));
        assert_eq!(hand_over(&file, Ok(1)).unwrap(), 1);
        assert!(!files::exists(&file) && hand_over(&file, Ok(1)).is_err());

        let folder = place(Path::new("steps"));
        files::create_dir_all(&folder.join("flow")).unwrap();
        for name in ["0.png", "flow/0.flo", ".list"] {
            files::save(&folder.join(name), name.as_bytes()).unwrap();
        }
        let (name, bytes) = content(&folder).unwrap();
        let text = String::from_utf8_lossy(bytes.as_ref()).into_owned();
        assert_eq!(name, "steps.zip");
        assert!(text.contains("steps/0.png") && text.contains("steps/flow/0.flo") && !text.contains(".list"));
        assert!(hand_over(&folder, Err::<(), _>(Error::new("cancelled"))).is_err() && !files::exists(&folder));
    }

    #[test]
    fn on_a_desktop_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        files::save(&target(&path), b"x").unwrap();
        assert!(hand_over(&path, Ok(())).is_ok() && path.is_file());
    }
}
