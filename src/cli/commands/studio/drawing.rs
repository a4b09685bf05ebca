//! What is drawn in the page, and files that it sends to steer. It is worked out while other calls go on, and then
//! set, unless what it was drawn on has changed meanwhile.

use super::opened::{Opened, put_beside};
use super::renumbering::following;
use super::session::{DENSITY, DOMAIN, MASKS, Session};
use super::settings::{PALETTE, SideFile, StudioSettings, is_side_file};
use super::stages;
use super::state::{active, nothing_open};
use crate::cli::failure::Failure;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vtex::library::Library;
use vtex_studio::StudioCall;
use vtex_studio::elements::{ElementMasks, Mending};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mend {
    /// The version of the elements that the page shows.
    version: u64,
    mending: Mending,
}

/// A shape to fill, on a canvas of a size.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DrawnShape {
    size: [f64; 2],
    path: Vec<[f64; 2]>,
}

/// What a drawing is made on.
pub(super) struct Ground {
    /// The number of the session.
    pub(super) id: u64,
    pub(super) opened: Arc<Opened>,
    pub(super) settings: StudioSettings,
    /// The elements that the page shows, and their version.
    pub(super) elements: Option<Arc<ElementMasks>>,
    pub(super) version: u64,
    /// What analysis found.
    pub(super) library: Option<Arc<Library>>,
    /// Where the file is written.
    pub(super) path: PathBuf,
}

/// What is worked on, for a file with an ending.
fn ground(session: &Session, ending: &'static str) -> Result<Ground, Failure> {
    let mut work = session.state();
    let at = work.active;
    let one = work.sessions.get_mut(at).ok_or_else(nothing_open)?;
    let path = one.drawn_path(ending);
    Ok(Ground {
        id: one.id,
        opened: Arc::clone(&one.opened),
        settings: one.settings().clone(),
        elements: one.elements.clone(),
        version: one.elements_version,
        library: one.results.library.clone(),
        path,
    })
}

/// The elements that the page shows, to be changed, and the width and height of their photograph.
///
/// # Errors
/// No elements, or others than those of the version.
pub(super) fn elements_of(
    session: &Session,
    version: u64,
) -> Result<(Ground, ElementMasks, [u32; 2]), Failure> {
    let ground = ground(session, MASKS)?;
    if version != ground.version {
        return Err(Failure::failed("the elements have changed meanwhile"));
    }
    match (&ground.elements, ground.opened.size) {
        (Some(elements), Some(size)) => {
            let elements = (**elements).clone();
            Ok((ground, elements, size))
        }
        _ => Err(Failure::failed("there are no elements to correct")),
    }
}

/// Sets what `change` makes of what is set by now, and writes it to disk.
fn put(
    session: &Session,
    id: u64,
    (what, version): (&str, Option<u64>),
    change: impl FnOnce(&StudioSettings) -> StudioSettings,
) -> anyhow::Result<()> {
    let mut work = session.state();
    let one = work.sessions.iter_mut().find(|one| one.id == id).ok_or_else(nothing_open)?;
    if version.is_some_and(|version| version != one.elements_version) {
        return Err(Failure::failed("the elements have changed meanwhile").into());
    }
    let settings = change(one.settings());
    stages::check(&one.opened, &settings)?;
    one.change(what, settings);
    session.changed(&mut work);
    drop(work);
    session.keep(id);
    Ok(())
}

/// Mends the elements that the page shows.
pub(super) fn mend(session: &Session, Mend { version, mending }: Mend) -> anyhow::Result<()> {
    let (ground, mut elements, size) = elements_of(session, version)?;
    let before = elements.category_names().to_vec();
    elements.mend(&mending).map_err(Failure::failed)?;
    put_elements(session, (ground, version), (elements, size), &before)
}

/// Sets elements that were changed. What was set by their categories follows these; `before` are the names before.
pub(super) fn put_elements(
    session: &Session,
    (ground, version): (Ground, u64),
    (elements, size): (ElementMasks, [u32; 2]),
    before: &[String],
) -> anyhow::Result<()> {
    let Ground { id, settings, path, .. } = ground;
    let after = elements.category_names().to_vec();
    let StudioSettings { masks, elements, .. } = settings.with_elements(path, size, elements)?;
    put(session, id, ("", Some(version)), |now| {
        let now = if after.is_empty() { now.clone() } else { following(now, before, &after) };
        StudioSettings { masks, elements, ..now }
    })
}

/// Most pixels along a side of the page of a shape that is drawn.
const SHAPE: f64 = 1000.0;

/// Sets a shape that was drawn as the one to fill.
pub(super) fn draw(session: &Session, DrawnShape { size, path: line }: DrawnShape) -> anyhow::Result<()> {
    if !size.iter().all(|side| (1.0..=1e6).contains(side)) {
        return Err(Failure::usage("the canvas has no size").into());
    }
    let Ground { id, path, .. } = ground(session, DOMAIN)?;
    let by = SHAPE / size[0].max(size[1]);
    let page = size.map(|side| ((side * by).round() as u32).max(1));
    let line = line.into_iter().map(|at| [0, 1].map(|k| at[k] / size[k] * f64::from(page[k]))).collect();
    let mut shape = ElementMasks::new(page, []);
    shape.mend(&Mending::Draw { path: line }).map_err(Failure::failed)?;
    let [width, height] = page;
    let program = vtex::PROGRAM;
    let svg = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Written by {program} -->\n<svg xmlns=\"http://www.w3.org/2000/svg\" \
         width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n<path d=\"{}\"/>\n</svg>\n",
        shape.outlines().concat()
    );
    stages::check_side("domain", svg.as_bytes())?;
    set_file(session, id, "domain", SideFile::drawn(path, svg.into_bytes()))
}

/// Sets a map of densities that was painted, a PNG.
pub(super) fn paint(session: &Session, call: &StudioCall) -> anyhow::Result<()> {
    if !call.body.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Err(Failure::usage("the map is no PNG").into());
    }
    stages::check_side("density", &call.body)?;
    let Ground { id, path, .. } = ground(session, DENSITY)?;
    set_file(session, id, "density", SideFile::drawn(path, call.body.clone()))
}

fn set_file(session: &Session, id: u64, option: &str, file: SideFile) -> anyhow::Result<()> {
    put(session, id, ("", None), |now| with_file(now, option, Some(file)))
}

/// What is set, with a file for an option or an operation, or none. The operation that reads a palette is the first.
fn with_file(settings: &StudioSettings, option: &str, file: Option<SideFile>) -> StudioSettings {
    let mut settings = settings.clone();
    let old = match file {
        Some(file) => settings.files.insert(option.to_owned(), Arc::new(file)),
        None => settings.files.remove(option),
    };
    if option == PALETTE {
        let text = |file: &SideFile| format!("{PALETTE} {}", quoted_name(&file.path));
        settings.operations.retain(|operation| Some(operation) != old.as_deref().map(text).as_ref());
        let new = settings.files.get(option).map(|file| text(file));
        settings.operations.splice(0..0, new);
    }
    settings
}

/// A path as a word of an operation.
fn quoted_name(path: &Path) -> String {
    let name = path.display().to_string();
    if name.chars().any(char::is_whitespace) { format!("'{name}'") } else { name }
}

/// Sets or takes away a file that steers, or the colours of a palette.
pub(super) fn side(session: &Session, call: &StudioCall) -> anyhow::Result<()> {
    let option = call.parameter("option").filter(|option| is_side_file(option));
    let option = option.ok_or_else(|| Failure::usage("there is no such file"))?;
    let (id, opened) = {
        let work = session.state();
        let one = active(&work)?;
        (one.id, Arc::clone(&one.opened))
    };
    if call.body.is_empty() {
        return put(session, id, (option, None), |now| with_file(now, option, None));
    }
    stages::check_side(option, &call.body)?;
    let folder = opened.path.parent().map(Path::to_owned).unwrap_or_default();
    let path = put_beside(&folder, call.parameter("name").unwrap_or_default(), &call.body)?;
    let file = SideFile::new(path, call.body.clone());
    put(session, id, (option, None), |now| with_file(now, option, Some(file)))
}
