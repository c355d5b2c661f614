//! The pages of a TIFF file (TIFF 6.0, section 2), of which its decoder reads the first.

use std::collections::HashSet;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};

use crate::files::File;

/// A page, by its directory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Page {
    /// Where the directory begins in the file.
    pub directory: u32,
    /// Width and height in px.
    pub size: (usize, usize),
    /// Whether it is a smaller copy of another page, or its mask.
    pub is_auxiliary: bool,
    /// Whether its samples are floating-point numbers.
    pub is_float: bool,
}

/// More pages than any recording has.
const MOST_PAGES: usize = 1 << 20;
/// More entries than all of its directories have. Crafted directories may overlap, so that a small file has many more.
const MOST_ENTRIES: usize = 1 << 25;

/// Whether a file begins as a BigTIFF, whose offsets have 64 bits.
pub(crate) fn is_big(head: &[u8]) -> bool {
    [b"II+\0", b"MM\0+"].iter().any(|magic| head.starts_with(*magic))
}

/// The pages of `file`, in order; none if it is no TIFF. What is damaged ends them.
pub(crate) fn pages(file: &mut File) -> Vec<Page> {
    Reader { bytes: BufReader::new(file), is_little: true }.pages(MOST_PAGES).unwrap_or_default()
}

/// The first page of `file`; `None` if it is no TIFF.
pub(crate) fn first_page(file: &mut File) -> Option<Page> {
    Reader { bytes: BufReader::new(file), is_little: true }.pages(1).ok()?.pop()
}

struct Reader<R> {
    bytes: R,
    is_little: bool,
}

impl<R: BufRead + Seek> Reader<R> {
    fn pages(&mut self, most: usize) -> io::Result<Vec<Page>> {
        let mut magic = [0; 4];
        self.bytes.rewind()?;
        self.bytes.read_exact(&mut magic)?;
        match &magic {
            b"II*\0" => self.is_little = true,
            b"MM\0*" => self.is_little = false,
            _ => return Ok(Vec::new()),
        }
        let mut next = self.long()?;
        let (mut pages, mut met, mut entries) = (Vec::new(), HashSet::new(), 0);
        // A directory that leads back to an earlier one has no end.
        while next != 0 && pages.len() < most && entries < MOST_ENTRIES && met.insert(next) {
            let Ok((page, count, following)) = self.page(next) else { break };
            pages.push(page);
            entries += count;
            next = following;
        }
        Ok(pages)
    }

    /// The page whose directory is at `directory`, the number of its entries, and where the next one is.
    fn page(&mut self, directory: u32) -> io::Result<(Page, usize, u32)> {
        self.bytes.seek(SeekFrom::Start(directory.into()))?;
        let count = self.short()?;
        let entries = (0..count).map(|_| self.entry()).collect::<io::Result<Vec<_>>>()?;
        let next = self.long()?;
        let mut page = Page { directory, ..Page::default() };
        for entry in &entries {
            match entry.tag {
                254 => page.is_auxiliary = self.first(entry)? & 0b101 != 0,
                256 => page.size.0 = self.first(entry)? as usize,
                257 => page.size.1 = self.first(entry)? as usize,
                339 => page.is_float = self.first(entry)? == 3,
                _ => {}
            }
        }
        Ok((page, entries.len(), next))
    }

    fn entry(&mut self) -> io::Result<Entry> {
        let (tag, kind, count) = (self.short()?, self.short()?, self.long()?);
        let mut value = [0; 4];
        self.bytes.read_exact(&mut value)?;
        Ok(Entry { tag, kind, count, value })
    }

    /// The first number of an entry: two bytes or four, in the entry itself if all of its numbers fit there.
    fn first(&mut self, &Entry { kind, count, value, .. }: &Entry) -> io::Result<u32> {
        const SHORT: u16 = 3;
        let [a, b, ..] = value;
        match kind {
            SHORT if count > 2 => {
                let offset = self.number(value);
                self.bytes.seek(SeekFrom::Start(offset.into()))?;
                self.short().map(u32::from)
            }
            SHORT => {
                Ok(u32::from(if self.is_little { u16::from_le_bytes([a, b]) } else { u16::from_be_bytes([a, b]) }))
            }
            _ => Ok(self.number(value)),
        }
    }

    fn number(&self, bytes: [u8; 4]) -> u32 {
        if self.is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) }
    }

    fn long(&mut self) -> io::Result<u32> {
        let mut bytes = [0; 4];
        self.bytes.read_exact(&mut bytes)?;
        Ok(self.number(bytes))
    }

    fn short(&mut self) -> io::Result<u16> {
        let mut bytes = [0; 2];
        self.bytes.read_exact(&mut bytes)?;
        Ok(if self.is_little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
    }
}

struct Entry {
    tag: u16,
    kind: u16,
    count: u32,
    value: [u8; 4],
}

/// A TIFF file whose header leads to another page as the first.
pub(crate) struct Paged {
    file: File,
    at: u64,
    /// The four bytes of the header that lead to the first page, if they are replaced.
    directory: Option<[u8; 4]>,
}

impl Paged {
    /// `file`, which is read as it is, or with `page` as its first.
    pub(crate) fn new(mut file: File, page: Option<u32>) -> io::Result<Self> {
        let mut order = [0; 2];
        if page.is_some() {
            file.rewind()?;
            file.read_exact(&mut order)?;
        }
        file.rewind()?;
        let directory = page.map(|page| if order == *b"II" { page.to_le_bytes() } else { page.to_be_bytes() });
        Ok(Self { file, at: 0, directory })
    }
}

impl Read for Paged {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        /// Where the header has the offset of the first directory.
        const AT: u64 = 4;
        let count = self.file.read(buffer)?;
        for (own, place) in self.directory.iter().flatten().zip(AT..) {
            let index = place.checked_sub(self.at).and_then(|index| usize::try_from(index).ok());
            if let Some(byte) = index.and_then(|index| buffer[..count].get_mut(index)) {
                *byte = *own;
            }
        }
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Paged {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = self.file.seek(to)?;
        Ok(self.at)
    }
}
