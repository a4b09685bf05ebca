//! Formats of pictures that are recognised, but not read.

/// First bytes of a file, from some place on, and the format.
const BEGINNINGS: [(usize, &[u8], &str); 21] = [
    (0, b"8BPS", "a Photoshop picture (PSD)"),
    (0, b"\0\0\0\x0cjP  \r\n\x87\n", "a JPEG 2000 picture"),
    (0, b"\xff\x4f\xff\x51", "a JPEG 2000 picture"),
    (0, b"\0\0\0\x0cJXL \r\n\x87\n", "a JPEG XL picture"),
    (0, b"\xff\x0a", "a JPEG XL picture"),
    (0, b"gimp xcf", "a GIMP picture (XCF)"),
    (0, b"\x76\x2f\x31\x01", "an OpenEXR picture"),
    (0, b"#?RADIANCE", "a Radiance picture (HDR)"),
    (0, b"#?RGBE", "a Radiance picture (HDR)"),
    (0, b"qoif", "a QOI picture"),
    (0, b"DDS ", "a DDS picture"),
    (0, b"\0\0\x01\0", "an icon (ICO)"),
    (8, b"CR", "a raw photograph of a Canon camera (CR2)"),
    (4, b"ftypcrx ", "a raw photograph of a Canon camera (CR3)"),
    (0, b"FUJIFILMCCD-RAW", "a raw photograph of a Fujifilm camera (RAF)"),
    (0, b"IIRO", "a raw photograph of an Olympus camera (ORF)"),
    (0, b"IIRS", "a raw photograph of an Olympus camera (ORF)"),
    (0, b"IIU\0", "a raw photograph of a Panasonic camera (RW2)"),
    (0, b"FOVb", "a raw photograph of a Sigma camera (X3F)"),
    (4, b"ftypavif", "an AVIF picture"),
    (4, b"ftypavis", "an AVIF picture"),
];

/// The format of a picture that vtex does not read, with its article, such as `a HEIC picture`; `None` for all other
/// content. The first 64 bytes suffice.
pub(super) fn format(bytes: &[u8]) -> Option<&'static str> {
    let begins = |at: usize, with: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(with));
    if let Some((_, beginning, name)) = BEGINNINGS.iter().find(|(at, with, _)| begins(*at, with)) {
        // Two letters within a TIFF.
        let is_own = *beginning != b"CR" || begins(0, b"II*\0");
        return is_own.then_some(*name);
    }
    if !begins(4, b"ftyp") {
        return None;
    }
    // The brands of a file of the family of HEIF: its own, and those that it is compatible with.
    let length = bytes.first_chunk().map_or(0, |length| u32::from_be_bytes(*length) as usize);
    let brands = bytes.get(8..length.min(64).min(bytes.len())).unwrap_or_default().chunks_exact(4);
    let has = |wanted: &[&[u8]]| brands.clone().any(|brand| wanted.contains(&brand));
    if has(&[b"avif", b"avis"]) {
        Some("an AVIF picture")
    } else if has(&[b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1"]) {
        Some("a HEIC picture")
    } else {
        None
    }
}
