//! The programs that vtex can be added to, and the files of each extension.

use clap::ValueEnum;

/// A program that vtex can be added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Host {
    Inkscape,
    Gimp,
}

/// Facts about a program and its extension.
pub(crate) struct HostFacts {
    /// The program on the command line.
    pub(crate) word: &'static str,
    pub(crate) title: &'static str,
    /// The program's name for an extension.
    pub(crate) extension: &'static str,
    /// The menu with the entries of vtex.
    pub(crate) menu: &'static str,
    /// A text that each file of the extension contains.
    pub(crate) mark: &'static str,
    pub(crate) files: &'static [Embedded],
    /// The file that the program starts itself, if any.
    pub(crate) executable: Option<&'static str>,
    /// Modules that the extension needs in the Python of the system.
    pub(crate) modules: &'static [&'static str],
    /// The oldest version that works.
    pub(crate) oldest: [u32; 2],
    /// File names of the program, the best first.
    pub(crate) programs: &'static [&'static str],
    /// The folder of the program on macOS.
    pub(crate) on_macos: &'static str,
    /// The folder of the program on Windows, below that of all programs.
    pub(crate) on_windows: &'static str,
}

/// A file of an extension.
pub(crate) struct Embedded {
    pub(crate) name: &'static str,
    pub(crate) content: &'static str,
}

macro_rules! embedded {
    ($folder:literal: $($name:literal),+ $(,)?) => {
        &[$(Embedded {
            name: $name,
            content: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/integrations/", $folder, "/", $name)),
        }),+]
    };
}

static INKSCAPE: HostFacts = HostFacts {
    word: "inkscape",
    title: "Inkscape",
    extension: "extension",
    menu: "Extensions > Texture (vtex)",
    mark: "Part of the extension of vtex for Inkscape",
    files: embedded![
        "inkscape":
        "vtex_arrange.py",
        "vtex_boxes.py",
        "vtex_colour.py",
        "vtex_extension.py",
        "vtex_fill.inx",
        "vtex_fill.py",
        "vtex_program.py",
        "vtex_recolour.inx",
        "vtex_recolour.py",
        "vtex_repaint.py",
        "vtex_shapes.py",
        "vtex_swatch.inx",
        "vtex_swatch.py",
        "vtex_texture.py",
    ],
    executable: None,
    modules: &["lxml", "numpy", "cssselect", "tinycss2"],
    oldest: [1, 2],
    programs: &["inkscape"],
    on_macos: "/Applications/Inkscape.app/Contents/MacOS",
    on_windows: "Inkscape\\bin",
};

static GIMP: HostFacts = HostFacts {
    word: "gimp",
    title: "GIMP",
    extension: "plug-in",
    menu: "Filters > Texture (vtex)",
    mark: "Part of the plug-in of vtex for GIMP",
    files: embedded!["gimp": "vtex.py", "vtex_commands.py"],
    executable: Some("vtex.py"),
    modules: &[],
    oldest: [3, 0],
    // Beside GIMP 2.10, version 3 has the longer names.
    programs: &["gimp-3", "gimp-3.0", "gimp"],
    on_macos: "/Applications/GIMP.app/Contents/MacOS",
    on_windows: "GIMP 3\\bin",
};

impl Host {
    pub(crate) fn facts(self) -> &'static HostFacts {
        match self {
            Self::Inkscape => &INKSCAPE,
            Self::Gimp => &GIMP,
        }
    }
}
