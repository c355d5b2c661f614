//! Boxes, of which an MP4 or QuickTime file is made.

use super::bytes::Bytes;

/// Kind, header size and whole size of the box that begins with `head`.
pub(crate) fn box_header(head: &[u8]) -> Option<([u8; 4], u64, u64)> {
    let mut bytes = Bytes(head);
    let size = bytes.be32()?;
    let kind = bytes.tag()?;
    match size {
        1 => Some((kind, 16, bytes.be64()?)),
        _ => Some((kind, 8, u64::from(size))),
    }
}

/// The boxes inside `data`; what is malformed ends them.
pub(crate) fn boxes(mut data: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    std::iter::from_fn(move || {
        let (kind, header, size) = box_header(data)?;
        let size = if size == 0 { data.len() } else { usize::try_from(size).ok()? };
        let payload = data.get(usize::try_from(header).ok()?..size)?;
        data = &data[size..];
        Some((kind, payload))
    })
}

/// The first box called `kind` inside `data`.
pub(crate) fn find<'a>(data: &'a [u8], kind: &[u8; 4]) -> Option<&'a [u8]> {
    boxes(data).find(|(found, _)| found == kind).map(|(_, payload)| payload)
}
