//! Names of files that some systems do not take as such.

/// Whether Windows takes a name for a device, whatever its ending.
pub fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_ascii_uppercase();
    let port = stem.strip_prefix("COM").or_else(|| stem.strip_prefix("LPT"));
    let is_number = |digit: &str| {
        let mut all = digit.chars();
        all.next().is_some_and(|c| matches!(c, '0'..='9' | '¹' | '²' | '³')) && all.next().is_none()
    };
    matches!(&stem[..], "CON" | "PRN" | "AUX" | "NUL" | "CONIN$" | "CONOUT$") || port.is_some_and(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn devices_are_known_by_their_stems() {
        assert!(["nul", "Con.png", "com1.tar.gz", "LPT9 .svg", "conin$", "COM¹"].into_iter().all(is_device));
        assert!(!["null.png", "com.png", "com10.png", "console", ""].into_iter().any(is_device));
    }
}
