//! The files of the page, which are part of the program.

/// Name, media type and content of each file.
const FILES: [(&str, &str, &str); 13] = [
    ("", "text/html; charset=utf-8", include_str!("../page/index.html")),
    ("style.css", "text/css; charset=utf-8", include_str!("../page/style.css")),
    ("icon.svg", "image/svg+xml", include_str!("../page/icon.svg")),
    ("main.js", SCRIPT, include_str!("../page/main.js")),
    ("server.js", SCRIPT, include_str!("../page/server.js")),
    ("dom.js", SCRIPT, include_str!("../page/dom.js")),
    ("canvas.js", SCRIPT, include_str!("../page/canvas.js")),
    ("labels.js", SCRIPT, include_str!("../page/labels.js")),
    ("knobs.js", SCRIPT, include_str!("../page/knobs.js")),
    ("change.js", SCRIPT, include_str!("../page/change.js")),
    ("paint.js", SCRIPT, include_str!("../page/paint.js")),
    ("categories.js", SCRIPT, include_str!("../page/categories.js")),
    ("mend.js", SCRIPT, include_str!("../page/mend.js")),
];

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Media type and content of a file of the page.
pub(crate) fn file(name: &str) -> Option<(&'static str, &'static str)> {
    FILES.iter().find(|(known, ..)| *known == name).map(|&(_, media_type, content)| (media_type, content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_small_and_without_inline_scripts() {
        assert!(FILES.iter().map(|(.., content)| content.len()).sum::<usize>() <= 300_000);
        let (_, page) = file("").unwrap();
        for forbidden in ["<script>", " style=\"", " onclick", "<style", "http://", "https://"] {
            assert!(!page.contains(forbidden), "{forbidden}");
        }
        for (name, ..) in &FILES[1..3] {
            assert!(page.contains(&format!("\"{name}\"")), "{name}");
        }
        assert!(page.contains("<script type=\"module\" src=\"main.js\"></script>"));
        assert!(file("../Cargo.toml").is_none() && file("api").is_none());
    }
}
