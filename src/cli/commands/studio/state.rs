//! The state of the session, as the page reads it.

use super::desk::{Opened, SideFile};
use super::session::{Session, Work, WorkSession};
use crate::cli::failure::Failure;
use crate::cli::input::InputKind;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;
use vtex::output::categories;

/// What the page shows and can set.
pub(super) fn state(session: &Arc<Session>) -> Value {
    let version = session.version();
    let work = session.state();
    let open: Vec<String> = work.sessions.iter().map(|one| name_of(&one.opened)).collect();
    let mut state = json!({
        "version": version,
        "busy": work.done < version && !work.rests && !open.is_empty(),
        "rests": work.rests,
        "fault": work.fault,
        "warnings": work.warnings,
        "open": open,
        "active": work.active,
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
    let desk = one.desk();
    let library = one.kept.library.as_ref();
    let file = |file: &SideFile| file.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let files: BTreeMap<_, _> = desk.files.iter().map(|(k, v)| (k, file(v))).collect();
    let kind = match one.opened.kind {
        InputKind::Image => "photograph",
        InputKind::Svg => "drawing",
        InputKind::Library => "library",
        _ => "scene",
    };
    json!({
        "name": name_of(&one.opened),
        "kind": kind,
        "size": one.opened.size,
        "options": desk.options,
        "seed": desk.seed.to_string(),
        "operations": desk.operations,
        "files": files,
        "mended": desk.masks.as_ref().map(|masks| file(masks)),
        "undo": one.can_undo(),
        "redo": one.can_redo(),
        "restored": one.restored,
        "notKept": one.not_kept,
        "keptIn": one.opened.work_path().file_name().map(|name| name.to_string_lossy()),
        "elements": one.elements.as_ref().map(|elements| json!({
            "version": one.elements_version,
            "count": elements.len(),
        })),
        "analysis": library.map(|library| json!({
            "primaries": library.primaries().len(),
            "secondaries": library.secondaries().len(),
            "coverage": library.coverage,
            "warnings": library.source.warnings,
        })),
        "texture": one.kept.shown.as_ref().map(|shown| json!({
            "number": shown.number,
            "width": shown.scene.width,
            "height": shown.scene.height,
            "whole": shown.whole,
            "draft": shown.draft,
            "tiles": [shown.scene.tile.x, shown.scene.tile.y],
            "elements": shown.scene.count(),
            "categories": categories(&shown.plain),
            "layers": shown.scene.layers.iter().map(|layer| &layer.name).collect::<Vec<_>>(),
        })),
        "variants": json!({ "show": one.wants_variants, "made": one.thumbnails }),
    })
}

/// What is worked on.
///
/// # Errors
/// Nothing that is open.
pub(super) fn active(work: &Work) -> Result<&WorkSession, Failure> {
    work.sessions.get(work.active).ok_or_else(|| Failure::failed("nothing is open"))
}
