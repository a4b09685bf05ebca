//! `vtex inspect -o report.html`: libraries and a scene → a page to look at.

use crate::cli::common::Common;
use crate::cli::failure::Failure;
use crate::cli::format;
use crate::cli::hints;
use crate::cli::input::{Input, InputKind};
use crate::cli::options::files::{ForceArgs, check_files};
use crate::cli::output::{Destination, WrittenFile};
use crate::cli::progress::Reporter;
use crate::cli::summary::{ElementCounts, Summary};
use std::path::{Path, PathBuf};
use vtex::library::Library;
use vtex::report::{self, Named, Photo, Subject};
use vtex::scene::Scene;

/// Options of a page, and its place.
pub(super) struct PageOptions {
    exemplars: Vec<Input>,
    place: Destination,
}

impl PageOptions {
    /// `None` if no page is requested.
    pub(super) fn new(
        files: &[Input],
        output: Option<PathBuf>,
        exemplars: Vec<PathBuf>,
        force: &ForceArgs,
    ) -> Result<Option<Self>, Failure> {
        let Some(output) = output else {
            if files.len() > 1 {
                return Err(Failure::usage("several files are shown on a page only")
                    .hint("name the page, as in -o report.html, or give one file at a time"));
            }
            return Ok(None);
        };
        let exemplars: Vec<Input> = exemplars.into_iter().map(Input::new).collect();
        let read = files.iter().map(|file| ("the input", file));
        let read: Vec<_> = read.chain(exemplars.iter().map(|file| ("--exemplar", file))).collect();
        check_files(&read, &[("-o", Some(&output))])?;
        if output.as_os_str() == "-" {
            return Ok(Some(Self { exemplars, place: Destination::Stdout }));
        }
        format::check_page_name(&output)?;
        Ok(Some(Self { exemplars, place: Destination::File { path: output, force: force.force } }))
    }
}

pub(super) fn run(
    common: &Common,
    reporter: &Reporter,
    inputs: &[Input],
    page: &PageOptions,
) -> anyhow::Result<()> {
    page.place.probe()?;
    reporter.stage("reading")?;
    let (libraries, scene) = read(inputs)?;
    let photos = photos(inputs, &page.exemplars, &libraries, scene.as_ref())?;
    reporter.stage("writing")?;
    let subject =
        Subject { libraries: &libraries, scene: scene.as_ref(), photos: &photos, ask: hints::PHOTO };
    let (warnings, bytes) = page.place.write(|out| report::write(&subject, out))?;
    let written = WrittenFile { bytes, warnings, ..WrittenFile::default() };
    let first = libraries.first().map(|l| &l.content);
    let counts = match &scene {
        Some(scene) => Some(ElementCounts::of_scene(&scene.content)),
        None => first.map(ElementCounts::of_library),
    };
    let size = match &scene {
        Some(scene) => [scene.content.width, scene.content.height],
        None => first.map_or([0; 2], |l| [l.source.width, l.source.height]),
    };
    let summary = Summary {
        size,
        counts,
        ..Summary::new(
            "inspect",
            inputs.iter().map(Input::name).collect(),
            page.place.path(),
            written,
            reporter,
        )
    };
    summary.print(common, page.place == Destination::Stdout)
}

/// Libraries, and the scene if there is one.
type Contents = (Vec<Named<Library>>, Option<Named<Scene>>);

/// The content of the inputs.
fn read(inputs: &[Input]) -> anyhow::Result<Contents> {
    let (mut libraries, mut scene) = (Vec::new(), None);
    for input in inputs {
        let bytes = input.read()?;
        let path = input.name();
        let name = file_name(input.path());
        match InputKind::expect(&bytes, input, &[InputKind::Library, InputKind::Scene])? {
            InputKind::Library => {
                libraries.push(Named { name, content: Library::from_bytes(bytes, &path)? });
            }
            _ if scene.is_some() => {
                let failure = Failure::usage(format!("'{path}' is a second scene; a page shows one"));
                return Err(failure.hint("write a page for each").into());
            }
            _ => scene = Some(Named { name, content: Scene::from_bytes(bytes, &path)? }),
        }
    }
    Ok((libraries, scene))
}

/// The files given as photographs, and files beside the inputs that have the name of an exemplar.
fn photos(
    inputs: &[Input],
    given: &[Input],
    libraries: &[Named<Library>],
    scene: Option<&Named<Scene>>,
) -> anyhow::Result<Vec<Photo>> {
    let mut found = Vec::new();
    for input in given {
        let bytes = input.read()?;
        InputKind::expect(&bytes, input, &[InputKind::Image, InputKind::Unknown])?;
        found.push(Photo::new(file_name(input.path()), bytes, true));
    }
    let folders = inputs.iter().filter_map(|input| match input {
        Input::File(path) => path.parent(),
        Input::Stdin => None,
    });
    let mut folders: Vec<&Path> = folders.collect();
    folders.dedup();
    for exemplar in report::exemplars(libraries, scene) {
        // Only the file name is used, so that a library cannot refer to other folders.
        let Some(name) = Path::new(&exemplar.exemplar).file_name() else { continue };
        for path in folders.iter().map(|folder| folder.join(name)).filter(|path| path.is_file()) {
            // The user did not name this file, so it is skipped if it cannot be read.
            if let Ok(bytes) = Input::File(path).read() {
                found.push(Photo::new(name.to_string_lossy(), bytes, false));
            }
        }
    }
    Ok(found)
}

/// A path without its folder.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
