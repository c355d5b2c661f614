//! Zip files without compression: the files in them are compressed already.

use flate2::Crc;
use motionscope_core::base::Error;

use super::memory::Bytes;

/// Signatures of the parts of a zip file (PKWARE's APPNOTE, 4.3).
const LOCAL: u32 = 0x0403_4B50;
const CENTRAL: u32 = 0x0201_4B50;
const END: u32 = 0x0605_4B50;
/// The version that is needed to read folders, and the flag that says that names are UTF-8.
const VERSION: u16 = 20;
const UTF8: u16 = 1 << 11;
/// The 1st of January 1980, the first day that a zip file knows.
const DATE: u16 = 0x21;

/// A zip file of `files`, by their names with `/`.
///
/// # Errors
/// If there are too many, or they are too large.
pub(super) fn stored(files: &[(String, Bytes)]) -> Result<Vec<u8>, Error> {
    let too_large = || Error::new("these files are too many for one zip file; save fewer of them");
    let word = |value: usize| u32::try_from(value).map_err(|_| too_large());
    let half = |value: usize| u16::try_from(value).map_err(|_| too_large());
    let (mut zip, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let bytes = bytes.as_ref();
        let mut crc = Crc::new();
        crc.update(bytes);
        let offset = word(zip.len())?;
        // Common to the file and its entry in the directory: version, flags, method, time, date, checksum, sizes, lengths of the name and of extras.
        let mut facts = Vec::new();
        [VERSION, UTF8, 0, 0, DATE].into_iter().for_each(|value| put16(&mut facts, value));
        [crc.sum(), word(bytes.len())?, word(bytes.len())?].into_iter().for_each(|value| put32(&mut facts, value));
        [half(name.len())?, 0].into_iter().for_each(|value| put16(&mut facts, value));

        put32(&mut zip, LOCAL);
        zip.extend([&facts, name.as_bytes(), bytes].concat());

        put32(&mut directory, CENTRAL);
        put16(&mut directory, VERSION);
        directory.extend(facts);
        // No comment, the first disk, no attributes.
        directory.extend([0; 10]);
        put32(&mut directory, offset);
        directory.extend(name.as_bytes());
    }
    let (count, start, size) = (half(files.len())?, word(zip.len())?, word(directory.len())?);
    zip.extend(directory);
    put32(&mut zip, END);
    [0, 0, count, count].into_iter().for_each(|value| put16(&mut zip, value));
    [size, start].into_iter().for_each(|value| put32(&mut zip, value));
    put16(&mut zip, 0);
    Ok(zip)
}

fn put16(to: &mut Vec<u8>, value: u16) {
    to.extend(value.to_le_bytes());
}

fn put32(to: &mut Vec<u8>, value: u32) {
    to.extend(value.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    #[test]
    fn another_program_finds_the_files_in_it() {
        let files = [("a/b.txt", "one"), ("a/c é.txt", ""), ("d", "three")];
        let zip = stored(&files.map(|(name, text)| (name.into(), text.as_bytes().to_vec().into()))).unwrap();
        assert!(zip.starts_with(b"PK\x03\x04"));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.zip");
        std::fs::write(&path, zip).unwrap();
        let script = "import sys, zipfile; z = zipfile.ZipFile(sys.argv[1]); assert z.testzip() is None; \
                      print([(n, z.read(n).decode()) for n in z.namelist()])";
        // Where there is no Python there is no other program to ask.
        let Ok(said) = Command::new("python3").args(["-c", script]).arg(&path).output() else { return };
        let text = String::from_utf8_lossy(&said.stdout).into_owned();
        assert!(said.status.success() && text.contains("('a/b.txt', 'one')"), "{text}");
        assert!(text.contains("('a/c é.txt', '')") && text.contains("('d', 'three')"), "{text}");
    }
}
