//! Checksums and sizes of a checkpoint put right, as far as its structure can be followed.

/// Bytes before the first section.
const BEGIN: usize = 12;
/// Mark of the end.
const END: u8 = 255;

/// Puts right the checksums of all sections, and number, length and checksum at the end.
pub fn put_right(bytes: &mut [u8]) {
    let (mut at, mut sections) = (BEGIN, 0_u64);
    while let Some(end) = section_end(bytes, at) {
        put(bytes, end, &crc32fast::hash(&bytes[at..end]).to_le_bytes());
        (at, sections) = (end + 4, sections + 1);
    }
    if bytes.get(at) == Some(&END) && at + 21 <= bytes.len() {
        put(bytes, at + 1, &sections.to_le_bytes());
        put(bytes, at + 9, &(at as u64 + 21).to_le_bytes());
        put(bytes, at + 17, &crc32fast::hash(&bytes[..at + 17]).to_le_bytes());
    }
}

/// Where the checksum of the section that begins at `at` stands.
fn section_end(bytes: &[u8], at: usize) -> Option<usize> {
    if *bytes.get(at)? == END {
        return None;
    }
    let content = at + 2 + usize::from(*bytes.get(at + 1)?) + 8;
    let length = u64::from_le_bytes(bytes.get(content - 8..content)?.try_into().ok()?);
    let end = content.checked_add(usize::try_from(length).ok()?)?;
    (end.checked_add(4)? <= bytes.len()).then_some(end)
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}
