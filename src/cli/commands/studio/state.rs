//! The state of the session, as the page reads it.

use super::opened::Opened;
use super::session::{Session, Work, WorkSession};
use super::settings::SideFile;
use crate::cli::failure::Failure;
use crate::cli::input::InputKind;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;
use vtex::library::Library;
use vtex::scene::LatticeChoice;

/// What the page shows and can set.
pub(super) fn state(session: &Arc<Session>) -> Value {
    let version = session.version();
    let work = session.state();
    let names: Vec<String> = work.sessions.iter().map(|one| name_of(&one.opened)).collect();
    // Files of one name are told apart by their folders.
    let title = |(one, name): (&WorkSession, &String)| {
        let is_only = names.iter().filter(|other| *other == name).count() == 1;
        let title = if is_only { name.clone() } else { one.opened.path.display().to_string() };
        json!({ "id": one.id, "title": title })
    };
    let open: Vec<Value> = work.sessions.iter().zip(&names).map(title).collect();
    let mut state = json!({
        "version": version,
        "busy": work.done < version && !work.rests && !open.is_empty(),
        "rests": work.rests,
        "fault": work.fault,
        "warnings": work.warnings,
        "open": open,
        "active": work.sessions.get(work.active).map(|one| one.id),
        "folder": session.folder.display().to_string(),
    });
    if let Some(one) = work.sessions.get(work.active) {
        state["work"] = state_of(one);
    }
    state
}

fn name_of(opened: &Opened) -> String {
    opened.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn state_of(one: &WorkSession) -> Value {
    let settings = one.settings();
    let library = one.results.library.as_ref();
    let file = |file: &SideFile| file.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let side = |side: &SideFile| json!({ "name": file(side), "sum": side.sha256[..16], "drawn": side.drawn });
    let files: BTreeMap<_, _> = settings.files.iter().map(|(k, v)| (k, side(v))).collect();
    let kind = match one.opened.kind {
        InputKind::Image => "photograph",
        InputKind::Svg => "drawing",
        InputKind::Library => "library",
        _ => "scene",
    };
    json!({
        "id": one.id,
        "name": name_of(&one.opened),
        "kind": kind,
        "size": one.opened.size,
        "options": settings.options,
        "seed": settings.seed.to_string(),
        "operations": settings.operations,
        "files": files,
        "mended": settings.masks.as_ref().map(|masks| file(masks)),
        "undo": one.can_undo(),
        "redo": one.can_redo(),
        "restored": one.restored,
        "notKept": one.not_kept,
        "keptIn": one.opened.work_path().file_name().map(|name| name.to_string_lossy()),
        "elements": one.elements.as_ref().map(|elements| json!({
            "version": one.elements_version,
            "count": elements.len(),
            "categorized": !elements.category_names().is_empty(),
        })),
        "analysis": library.map(|library| json!({
            "version": one.results.library_version,
            "primaries": library.primaries().len(),
            "secondaries": library.secondaries().len(),
            "coverage": library.coverage,
            "warnings": library.source.warnings,
            "lattice": lattice_of(library, settings.options.get("lattice").map(String::as_str)),
        })),
        "texture": one.results.shown.as_ref().map(|shown| json!({
            "number": shown.number,
            "width": shown.scene.picture_size(1.0)[0],
            "height": shown.scene.picture_size(1.0)[1],
            "page": shown.scene.page,
            "whole": shown.whole,
            "draft": shown.draft,
            "tiles": [shown.scene.tile.x, shown.scene.tile.y],
            "elements": shown.scene.count(),
            "categories": *shown.categories,
            "layers": shown.scene.layers.iter().map(|layer| &layer.name).collect::<Vec<_>>(),
        })),
        "variants": json!({ "show": one.wants_variants, "made": one.thumbnails, "fault": one.variants_fault }),
    })
}

/// The rows or the lattice that textures follow, or that they could follow, with the borders of its cells.
fn lattice_of(library: &Library, chosen: Option<&str>) -> Option<Value> {
    let choice: LatticeChoice = chosen.unwrap_or_default().parse().unwrap_or_default();
    let followed = choice.of(library.lattice.as_ref()).ok().flatten();
    let lattice = followed.as_ref().or(library.lattice.as_ref())?;
    Some(json!({
        "words": lattice.in_words(),
        "followed": followed.is_some(),
        "found": library.lattice.as_ref().map(|found| json!({ "kept": found.is_kept(), "vectors": found.vectors })),
        "vectors": lattice.vectors,
        "path": library.path_of_cells(lattice),
    }))
}

/// What is worked on.
///
/// # Errors
/// Nothing that is open.
pub(super) fn active(work: &Work) -> Result<&WorkSession, Failure> {
    work.sessions.get(work.active).ok_or_else(nothing_open)
}

pub(super) fn nothing_open() -> Failure {
    Failure::failed("nothing is open")
}
