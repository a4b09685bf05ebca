//! The text of `-h`: a few lines for each command. `--help` lists everything.

use std::ffi::OsString;

/// Of each command: its options in the order of their use, each with a few words.
const COMMON: [(&str, &[(&str, &str)]); 20] = [
    (
        "texture",
        &[
            ("photo", "The photograph; - reads stdin"),
            ("output", "Result: .svg, .pdf, .png, .scene.json"),
            ("size", "Canvas, px: 1000 or 1000x600"),
            ("tile", "Repeat without a seam"),
            ("preset", "draft, fine or poster"),
            ("seed", "The same number, the same texture"),
        ],
    ),
    (
        "vectorize",
        &[
            ("photo", "The photograph; - reads stdin"),
            ("output", "Result: .svg, .pdf, .png, .scene.json"),
            ("fidelity", "Distance of outlines, px; smaller is finer"),
            ("colors", "Most colours, all flat"),
            ("max_paths", "Most elements"),
            ("preset", "draft, fine or poster"),
        ],
    ),
    (
        "analyze",
        &[
            ("photo", "The photograph; - reads stdin"),
            ("output", "Result: .lib.json or .lib.json.gz"),
            ("segmenter", "auto, texton, regions, felzenszwalb or sam"),
            ("masks", "Use the masks of a file"),
            ("layers", "Nested layers: auto, off, or 1 to 6"),
            ("preset", "draft, fine or poster"),
            ("seed", "The same number, the same library"),
        ],
    ),
    (
        "synth",
        &[
            ("library", "The library; - reads stdin"),
            ("output", "Result: .svg, .pdf, .png, .scene.json"),
            ("size", "Canvas, px: 1000 or 1000x600"),
            ("tile", "Repeat without a seam"),
            ("domain", "Fill the shape of an SVG"),
            ("seed", "The same number, the same texture"),
        ],
    ),
    (
        "batch",
        &[
            ("input", "Photographs, libraries, folders or a file of jobs"),
            ("out_dir", "Folder for results"),
            ("format", "svg, png, pdf, scene.json and others"),
            ("size", "Canvas, px: 1000 or 1000x600"),
            ("shard", "A part of the jobs: I/N"),
        ],
    ),
    (
        "warp",
        &[
            ("scene", "The scene; - reads stdin"),
            ("library", "The libraries that it was made from"),
            ("scale", "Stretch the canvas: 1.5 or 1.5x2"),
            ("cage", "The cage before: an SVG with one path"),
            ("to", "The cage after"),
            ("output", "Result: .svg, .pdf, .png, .scene.json"),
        ],
    ),
    (
        "transfer",
        &[
            ("structure", "Whose arrangement is kept: a scene or library"),
            ("appearance", "Whose elements are taken; several with --map"),
            ("map", "Where which is used: a picture"),
            ("mode", "mean (colours only) or replace"),
            ("output", "Result: .svg, .pdf, .png, .scene.json"),
        ],
    ),
    (
        "animate",
        &[
            ("scene", "The scene; - reads stdin"),
            ("flow", "shear, vortex, wind, or a picture of directions"),
            ("frames", "Pictures in a loop"),
            ("output", "Result: .svg, .gif, .png, .apng or a folder"),
        ],
    ),
    (
        "stylize",
        &[
            ("picture", "The picture; - reads stdin"),
            ("with", "The texture that it is redrawn in"),
            ("keep", "Of the picture: lightness, color or none"),
            ("element_size", "Distance of the largest elements, px"),
            ("output", "Result: .svg, .pdf, .png, .scene.json"),
        ],
    ),
    (
        "check",
        &[
            ("scene", "A scene or a library; - reads stdin"),
            ("library", "Whose parameters of analysis are used"),
        ],
    ),
    (
        "edit",
        &[
            ("scene", "The scene; - reads stdin"),
            ("op", "An operation, in quotes; again and again"),
            ("list", "Explain all operations"),
            ("output", "Result: .svg, .pdf, .png, .scene.json"),
        ],
    ),
    (
        "tune",
        &[
            ("library", "The library"),
            ("name", "Name of the weights"),
            ("evaluations", "Sets of weights tried"),
            ("seed", "The same number, the same weights"),
        ],
    ),
    (
        "render",
        &[
            ("file", "A library, scene or SVG; - reads stdin"),
            ("output", "Result: .png, .svg, .pdf, .scene.json"),
            ("scale", "Pixels of a PNG for each of the canvas"),
        ],
    ),
    (
        "interp",
        &[
            ("from", "The scene to begin with"),
            ("to", "The scene to end with"),
            ("output", "Animation .svg, .gif, .png, or a folder"),
            ("frames", "Pictures"),
            ("back", "Play there and back"),
            ("at", "One scene only, 0 to 1"),
        ],
    ),
    (
        "layers",
        &[
            ("input", "A photograph or a layer map; - reads stdin"),
            ("output", "The new map: .png, .svg, .json"),
            ("size", "Canvas, px: 1000 or 1000x600"),
            ("tile", "Repeat without a seam"),
            ("layers", "Number of layers, 1 to 6"),
            ("seed", "The same number, the same map"),
        ],
    ),
    (
        "raster",
        &[
            ("photo", "The photograph; - reads stdin"),
            ("output", "Result: .png"),
            ("size", "Canvas, px: 1000 or 1000x600"),
            ("tile", "Repeat without a seam"),
            ("method", "correspondence, tsvq or tsvq-soft"),
            ("seed", "The same number, the same picture"),
        ],
    ),
    (
        "inspect",
        &[
            ("file", "A library or scene; - reads stdin"),
            ("output", "Write a page for a browser, .html"),
            ("json", "Print JSON"),
        ],
    ),
    (
        "metrics",
        &[
            ("exemplar", "A picture, SVG, library or scene"),
            ("result", "What is compared with it"),
            ("scale", "How many times as large the result is"),
            ("json", "Print JSON"),
        ],
    ),
    ("doctor", &[("engine", "auto, onnxruntime or rten"), ("json", "Print JSON")]),
    ("completions", &[("shell", "bash, zsh, fish, powershell or elvish")]),
];

/// Whether `-h` stands among the arguments.
pub(crate) fn asked(arguments: &[OsString]) -> bool {
    arguments.iter().skip(1).take_while(|a| *a != "--").any(|a| a == "-h")
}

/// The command whose help is short.
pub(crate) fn shortened(mut command: clap::Command) -> clap::Command {
    command.build();
    let names: Vec<String> = command.get_subcommands().map(|sub| sub.get_name().to_owned()).collect();
    for name in names {
        let Some((_, shown)) = COMMON.iter().find(|(known, _)| *known == name) else { continue };
        command = command.mut_subcommand(&name, |sub| {
            let sub = sub.mut_args(|arg| {
                let known = shown.iter().position(|(id, _)| arg.get_id() == id);
                match known {
                    Some(at) => arg.help(shown[at].1).display_order(at).help_heading("Most used"),
                    None => arg.hide(true),
                }
            });
            sub.after_help(format!("'vtex {name} --help' says more."))
        });
    }
    command
}
