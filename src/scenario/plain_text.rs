//! Files that are not plain text.

/// Reason why a file is not plain text, from its first bytes and its line ends; `None` for plain text.
pub(super) fn not_plain(bytes: &[u8]) -> Option<String> {
    if let Some(kind) = binary_kind(bytes) {
        return Some(format!("the file is {kind}"));
    }
    let is_utf_16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    // In UTF-16 without a mark, every other byte of letters and digits is zero.
    let wrong = if is_utf_16 || bytes.iter().take(100).any(|byte| *byte == 0) {
        "the file is UTF-16 text, as some programs export it, or no text: save it as UTF-8 or plain text"
    } else if bytes.contains(&b'\r') && !bytes.contains(&b'\n') {
        "the lines end with a carriage return alone (CR), as on old Macs: save the file with line ends LF or CR LF"
    } else {
        return None;
    };
    Some(wrong.to_owned())
}

/// Kind of a file that is no text, and its remedy, from its first bytes; `None` for other kinds and for text.
pub(super) fn binary_kind(bytes: &[u8]) -> Option<&'static str> {
    const SHEET: &str = "a spreadsheet: save its sheet as CSV";
    const ARCHIVE: &str = "an archive (ZIP): unpack it";
    const COMPRESSED: &str = "compressed (gzip): unpack it";
    const SEED: &str =
        "SEED or MiniSEED: convert it to a table, with ObsPy for example (docs/records.md)";
    const SAC: &str = "a SAC file: convert it to a table, with ObsPy for example (docs/records.md)";
    /// Names with which the archive of a spreadsheet begins, at byte 30.
    const PARTS: [&[u8]; 5] = [
        b"[Content_Types].xml",
        b"_rels/",
        b"docProps/",
        b"xl/",
        b"mimetypeapplication/vnd.oasis.opendocument.spreadsheet",
    ];
    let begins = |start: &[u8]| bytes.starts_with(start);
    let is_sheet = || {
        let name = bytes.get(30..).unwrap_or_default();
        PARTS.iter().any(|part| name.starts_with(part))
    };
    // Records of SEED begin with six digits, a letter for their kind and a blank; those of version 3 with a mark.
    let is_seed = || {
        let digits = bytes.iter().take(6);
        let is_numbered = digits.filter(|byte| byte.is_ascii_digit()).count() == 6;
        let kind = bytes.get(6..8);
        is_numbered
            && kind.is_some_and(|kind| b"VASTDRQM".contains(&kind[0]) && b" \0".contains(&kind[1]))
    };
    // The header of SAC has its version at byte 304, in either order of bytes.
    let is_sac = || {
        let version = bytes.get(304..308).filter(|_| bytes.len() >= 632);
        version.is_some_and(|bytes| {
            [[6, 0, 0, 0], [7, 0, 0, 0], [0, 0, 0, 6], [0, 0, 0, 7]]
                .iter()
                .any(|version| bytes == version)
        })
    };
    match bytes {
        _ if begins(b"PK\x03\x04") && is_sheet() => Some(SHEET),
        _ if begins(b"PK\x03\x04") => Some(ARCHIVE),
        _ if begins(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1") => Some(SHEET),
        _ if begins(b"\x1f\x8b") => Some(COMPRESSED),
        _ if begins(b"MS\x03") || is_seed() => Some(SEED),
        _ if is_sac() => Some(SAC),
        _ => None,
    }
}
