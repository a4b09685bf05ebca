//! The calls of the page: what it asks, and what it changes.

use super::categories;
use super::command_lines::{Commands, Wanted};
use super::drawing;
use super::knobs::{stage_of, table};
use super::opened::{DOCUMENT, Opened, put_beside};
use super::session::{Fault, Session, VARIANTS, WorkSession};
use super::settings::StudioSettings;
use super::stages;
use super::state::{active, nothing_open, state};
use crate::cli::failure::Failure;
use crate::cli::on_threads;
use crate::cli::options::render::RenderParameters;
use crate::cli::output::DrawingOptions;
use crate::cli::panics::guarded;
use crate::cli::values::Seed;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vtex::output::file::Format;
use vtex::output::png;
use vtex::scene::Scene;
use vtex::synth::reconstruct;
use vtex_studio::elements::categories_of_library;
use vtex_studio::work::{StudioWork, file_name};
use vtex_studio::{App, Content, StudioAnswer, StudioCall, Verb};

/// Most pixels of a picture that is shown.
const PIXELS: f64 = 16e6;

/// The session as the server sees it.
pub(super) struct StudioApp(pub(super) Arc<Session>);

type Answered = anyhow::Result<StudioAnswer>;

impl App for StudioApp {
    fn answer(&self, call: StudioCall) -> StudioAnswer {
        let session = &self.0;
        guarded(|| match call.verb {
            Verb::Get => asked(session, &call),
            Verb::Post => {
                let answer = changed(session, &call);
                session.tell();
                answer
            }
        })
        .unwrap_or_else(|error| {
            let Fault { error, hint } = Fault::of(&error);
            StudioAnswer::fault(422, &error, hint.as_deref())
        })
    }
}

/// Answers a question.
fn asked(session: &Arc<Session>, call: &StudioCall) -> Answered {
    match &call.name[..] {
        "table" => Ok(StudioAnswer::json(&table())),
        "state" => Ok(StudioAnswer::json(&state(session))),
        "elements" => elements(session),
        "picture" => picture(session, call),
        "variant" => variant(session, call),
        "commands" => commands(session, call),
        "save" => save(session, call).map(|bytes| StudioAnswer::bytes(Content::Download, bytes)),
        "weigh" => weigh(session, call),
        _ => Ok(unknown()),
    }
}

fn unknown() -> StudioAnswer {
    StudioAnswer::fault(404, "there is no such call", None)
}

/// The content of a call.
fn content<T: DeserializeOwned>(call: &StudioCall) -> Result<T, Failure> {
    serde_json::from_slice(&call.body).map_err(|e| Failure::failed(format!("the call cannot be read: {e}")))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SetOption {
    name: String,
    /// The default, if there is none.
    value: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SetSeed {
    /// A seed in digits, or none for any.
    seed: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SetOperations {
    operations: Vec<String>,
    /// What changed, so that a slider that moves is one step back.
    what: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Variants {
    show: bool,
    more: bool,
}

/// Most operations, and most characters of a text that the page sets.
const OPERATIONS: usize = 100;
const CHARACTERS: usize = 1000;

/// Changes something.
fn changed(session: &Arc<Session>, call: &StudioCall) -> Answered {
    match &call.name[..] {
        "open" => open(session, call)?,
        "cancel" => session.cancel(),
        "mend" => drawing::mend(session, content(call)?)?,
        "categorize" => categories::categorize(session, content(call)?)?,
        "draw" => drawing::draw(session, content(call)?)?,
        "paint" => drawing::paint(session, call)?,
        "side" => drawing::side(session, call)?,
        _ => return set(session, call),
    }
    Ok(StudioAnswer::json(&json!({})))
}

/// Changes something that takes no time.
fn set(session: &Arc<Session>, call: &StudioCall) -> Answered {
    let mut state = session.state();
    let work = &mut *state;
    let active = work.active;
    let one = work.sessions.get_mut(active).ok_or_else(nothing_open)?;
    match &call.name[..] {
        "set" => {
            let SetOption { name, value } = content(call)?;
            let settings = with_option(one.settings(), &name, value)?;
            put(one, &name, settings)?;
        }
        "seed" => {
            let SetSeed { seed } = content(call)?;
            let chosen = seed.is_none();
            let seed: Seed =
                seed.map_or_else(|| Ok(Seed::chosen()), |text| text.parse()).map_err(Failure::usage)?;
            // Each throw of the dice is a step of its own.
            let what = if chosen { "" } else { "seed" };
            put(one, what, StudioSettings { seed: seed.0, ..one.settings().clone() })?;
            if chosen {
                one.variants_of = seed.0;
                one.thumbnails.clear();
            }
        }
        "operations" => {
            let SetOperations { operations, what } = content(call)?;
            if operations.len() > OPERATIONS {
                return Err(Failure::usage(format!("there are more than {OPERATIONS} operations")).into());
            }
            if operations.iter().any(|text| text.len() > CHARACTERS) {
                return Err(Failure::usage("an operation is too long").into());
            }
            put(one, &what, StudioSettings { operations, ..one.settings().clone() })?;
        }
        "variants" => {
            let Variants { show, more } = content(call)?;
            one.wants_variants = show;
            one.variants_fault = None;
            if more {
                one.variants_of = one.variants_of.wrapping_add(VARIANTS);
                one.thumbnails.clear();
            }
        }
        "undo" | "redo" => {
            one.step(call.name == "undo");
        }
        "anew" => {
            let fresh = StudioSettings::new(session.seed);
            one.change("", fresh);
            one.restored = false;
        }
        "resume" => {}
        "choose" => {
            let id: u64 = content(call)?;
            let index = work.sessions.iter().position(|one| one.id == id);
            work.active = index.ok_or_else(|| Failure::failed("that is not open"))?;
        }
        _ => return Ok(unknown()),
    }
    let id = work.sessions[work.active].id;
    session.changed(work);
    drop(state);
    if !matches!(&call.name[..], "variants" | "choose" | "resume") {
        session.keep(id);
    }
    Ok(StudioAnswer::json(&json!({})))
}

/// What is set, with another value of an option.
fn with_option(
    settings: &StudioSettings,
    name: &str,
    value: Option<String>,
) -> Result<StudioSettings, Failure> {
    if stage_of(name).is_none() {
        return Err(Failure::usage("there is no option of that name here"));
    }
    let mut settings = settings.clone();
    match value {
        Some(value) if value.len() > CHARACTERS => return Err(Failure::usage("the value is too long")),
        Some(value) => drop(settings.options.insert(name.to_owned(), value)),
        None => drop(settings.options.remove(name)),
    }
    Ok(settings)
}

/// Sets something, if all of it is in range.
fn put(one: &mut WorkSession, what: &str, settings: StudioSettings) -> anyhow::Result<()> {
    stages::check(&one.opened, &settings)?;
    one.change(what, settings);
    Ok(())
}

/// Opens a file that the page sent, which is put into the folder of the session.
fn open(session: &Arc<Session>, call: &StudioCall) -> anyhow::Result<()> {
    let name = call.parameter("name").and_then(file_name);
    let name = name.ok_or_else(|| Failure::failed("the file has no usable name"))?;
    // Only what can be opened is put into the folder.
    let seen = Opened::new(name.clone().into(), call.body.clone())?;
    let path = put_beside(&session.folder, &name, &call.body)?;
    let opened = Opened { path, ..seen };
    let one = begun(opened, session.seed);
    let mut work = session.state();
    let known = work.sessions.iter().position(|known| known.opened.path == one.opened.path);
    match known {
        Some(index) => work.active = index,
        None => work.open(one),
    }
    session.changed(&mut work);
    Ok(())
}

/// Begins work on a file, or goes on with that of last time.
pub(super) fn begun(opened: Opened, seed: Option<Seed>) -> WorkSession {
    let path = opened.work_path();
    let fresh = || StudioSettings::new(seed);
    if !path.exists() {
        let settings = fresh();
        return WorkSession::new(opened, settings, false);
    }
    let read = StudioWork::read(&path).map_err(anyhow::Error::from);
    let restored = read.and_then(|work| StudioSettings::restored(&opened, &work));
    let restored = restored.and_then(|settings| stages::check(&opened, &settings).map(|()| settings));
    match restored {
        Ok(settings) => WorkSession::new(opened, settings, true),
        Err(error) => {
            let mut one = WorkSession::new(opened, fresh(), false);
            let reason = Fault::of(&error).error;
            let kept = moved_aside(&path).unwrap_or_else(|| path.clone());
            one.not_kept = Some(format!("cannot load the settings in '{}': {reason}", kept.display()));
            one
        }
    }
}

/// Renames a document of work, so that the next change does not replace it; its new path, if that was possible.
fn moved_aside(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_string_lossy();
    let stem = name.strip_suffix(DOCUMENT)?;
    let mut paths = (1..=100).map(|number| path.with_file_name(format!("{stem}.old-{number}{DOCUMENT}")));
    let free = paths.find(|path| !path.exists())?;
    std::fs::rename(path, &free).ok().map(|()| free)
}

/// The outlines of the elements, the names of categories, and the category of each element, once they are found.
fn elements(session: &Arc<Session>) -> Answered {
    let (elements, version, size, library, known) = {
        let work = session.state();
        let one = active(&work)?;
        let (Some(elements), Some(size)) = (one.elements.clone(), one.opened.size) else {
            let none: [u8; 0] = [];
            return Ok(StudioAnswer::json(
                &json!({ "version": 0, "size": [1, 1], "outlines": none, "places": none, "names": none, "categories": none }),
            ));
        };
        let known = one.outlines.clone().filter(|(version, _)| *version == one.elements_version);
        (elements, one.elements_version, size, one.results.library.clone(), known)
    };
    let outlines = match known {
        Some((_, outlines)) => outlines,
        None => {
            let outlines = Arc::new(on_threads(session.threads, || Ok(elements.outlines()))?);
            let mut work = session.state();
            if let Some(one) = work.sessions.iter_mut().find(|one| one.elements_version == version) {
                one.outlines = Some((version, Arc::clone(&outlines)));
            }
            outlines
        }
    };
    let given = elements.given_categories();
    let found = if given.is_empty() {
        library.map_or_else(Vec::new, |library| categories_of_library(&library))
    } else {
        given
    };
    let names: Vec<&String> = found.iter().map(|category| &category.name).collect();
    Ok(StudioAnswer::json(&json!({
        "version": version,
        "size": size,
        "outlines": *outlines,
        "places": elements.places(),
        "names": names,
        "categories": elements.categories_among(&found),
    })))
}

/// A picture of the photograph, of its drawing back, or of the texture.
fn picture(session: &Arc<Session>, call: &StudioCall) -> Answered {
    let (opened, settings, library, shown) = {
        let work = session.state();
        let one = active(&work)?;
        (
            Arc::clone(&one.opened),
            one.settings().clone(),
            one.results.library.clone(),
            one.results.shown.clone(),
        )
    };
    let missing = || StudioAnswer::fault(404, "there is no such picture yet", None);
    let scale = call.parameter("scale").and_then(|text| text.parse::<f64>().ok()).unwrap_or(1.0);
    let drawn = |scene: &Scene, drawing: DrawingOptions<'_>| {
        let area = scene.picture_size(1.0).map(f64::from).iter().product::<f64>();
        let scale = scale.clamp(0.05, 8.0).min((PIXELS / area).sqrt());
        let render = RenderParameters { scale, ..drawing.render };
        let picture = DrawingOptions { render, ..drawing }.picture_with(scene, &call.caller)?;
        let mut bytes = Vec::new();
        png::encode(&picture, None, None, &mut bytes)?;
        Ok(StudioAnswer::bytes(Content::Png, bytes))
    };
    match (call.parameter("of"), &opened.picture) {
        (Some("photograph"), Some(picture)) => Ok(StudioAnswer::bytes(Content::Png, picture.clone())),
        (Some("redrawn"), _) => {
            let Some(library) = library else { return Ok(missing()) };
            let drawing = stages::drawing(&opened, &stages::shown(&opened, &settings))?;
            on_threads(session.threads, || drawn(&reconstruct(&library), drawing))
        }
        (Some("texture"), _) => {
            let Some(shown) = shown else { return Ok(missing()) };
            let drawing = stages::drawing(&opened, &stages::shown(&opened, &settings))?;
            on_threads(session.threads, || drawn(&shown.scene, drawing))
        }
        (Some("density"), _) => {
            let Some(map) = settings.files.get("density") else { return Ok(missing()) };
            // What was painted is transparent where nothing was.
            if map.bytes.starts_with(b"\x89PNG") {
                return Ok(StudioAnswer::bytes(Content::Png, map.bytes.clone()));
            }
            Ok(StudioAnswer::bytes(Content::Png, stages::density_picture(&map.bytes)?))
        }
        _ => Ok(missing()),
    }
}

/// The small picture of a variant.
fn variant(session: &Arc<Session>, call: &StudioCall) -> Answered {
    let seed = call.parameter("seed").unwrap_or_default();
    let work = session.state();
    let found = active(&work)?.thumbnails.iter().find(|thumbnail| thumbnail.seed.to_string() == seed);
    Ok(match found {
        Some(thumbnail) => StudioAnswer::bytes(Content::Png, thumbnail.png.clone()),
        None => StudioAnswer::fault(404, "there is no such variant", None),
    })
}

/// What is to be saved.
fn wanted(call: &StudioCall) -> Result<Wanted, Failure> {
    let format = call.parameter("format").and_then(Format::named);
    let format = format.ok_or_else(|| Failure::usage("there is no such format"))?;
    let scale = call.parameter("scale").filter(|text| !text.is_empty()).map(str::parse::<f64>).transpose();
    let scale =
        scale.map_err(|_| Failure::usage("the scale is no number"))?.filter(|scale| scale.is_finite());
    Ok(Wanted { format, scale })
}

/// The command lines that make what would be saved.
fn commands(session: &Arc<Session>, call: &StudioCall) -> Answered {
    let wanted = wanted(call)?;
    let work = session.state();
    let one = active(&work)?;
    let commands = Commands::new(&one.opened, one.settings(), wanted);
    Ok(StudioAnswer::json(&json!({ "lines": commands.text(), "file": commands.result() })))
}

/// Maximum size of a PNG that is drawn to show its file size before it is saved, in pixels.
const WEIGHED: f64 = 4e6;

/// The number of bytes of a file that is not saved yet, and the size of a picture. A large PNG takes too long.
fn weigh(session: &Arc<Session>, call: &StudioCall) -> Answered {
    let Wanted { format, scale } = wanted(call)?;
    let canvas = {
        let work = session.state();
        active(&work)?.results.shown.as_ref().map_or([0; 2], |shown| [shown.scene.width, shown.scene.height])
    };
    let scale = if format.uses().scale { scale.unwrap_or(1.0) } else { 1.0 };
    let size = canvas.map(|side| (f64::from(side) * scale).round());
    let is_large = format.uses().scale && size[0] * size[1] > WEIGHED;
    let bytes = if is_large { None } else { Some(save(session, call)?.len()) };
    Ok(StudioAnswer::json(&json!({ "bytes": bytes, "size": size })))
}

/// The bytes of a file.
fn save(session: &Arc<Session>, call: &StudioCall) -> anyhow::Result<Vec<u8>> {
    let wanted = wanted(call)?;
    let (opened, settings, library, shown) = {
        let work = session.state();
        let one = active(&work)?;
        let draft = one.results.shown.as_ref().is_some_and(|shown| shown.draft);
        if work.done < session.version() || work.rests || draft || work.fault.is_some() {
            let failure = Failure::failed("the texture is not finished");
            return Err(failure.hint("wait until it is, and save it then").into());
        }
        (
            Arc::clone(&one.opened),
            one.settings().clone(),
            one.results.library.clone(),
            one.results.shown.clone(),
        )
    };
    let commands = Commands::new(&opened, &settings, wanted);
    let scene = shown.as_ref().map(|shown| &*shown.scene);
    on_threads(session.threads, || {
        stages::write(&opened, &commands, wanted.format, library.as_deref(), scene, &call.caller)
    })
}
