//! The long work, and the thread that does it. Results are kept, so only what changed is done again.

use super::command_lines::Commands;
use super::follower::Follower;
use super::knobs::{Stage, stage_of};
use super::opened::Opened;
use super::results::{Key, Shown, Thumbnail, categories_of};
use super::session::{Fault, Session, VARIANTS, next_version};
use super::settings::StudioSettings;
use super::stages::{self, Listener};
use crate::cli::input::InputKind;
use crate::cli::options::render::RenderParameters;
use crate::cli::output::DrawingOptions;
use crate::cli::panics::guarded;
use std::sync::Arc;
use vtex::analyze::AnalysisMemory;
use vtex::library::Library;
use vtex::output::png;
use vtex::scene::Scene;
use vtex::synth::SynthesisMemory;
use vtex_studio::elements::ElementMasks;

/// Canvas of a draft, in square pixels; one that is hardly larger is made at once.
const DRAFT: f64 = 50_000.0;
const HARDLY_LARGER: f64 = 1.3;
/// Canvas of a variant, in square pixels, above which it is drawn as a draft of itself.
const VARIANT: f64 = 400_000.0;
/// Side of the picture of a variant, in pixels.
const THUMBNAIL: f64 = 176.0;
/// Numbers of results that are kept.
const LIBRARIES: usize = 3;
const SCENES: usize = 4;

/// What the last analysis and the last synthesis left for the next ones.
#[derive(Default)]
struct WorkMemory {
    analysis: AnalysisMemory,
    synthesis: SynthesisMemory,
}

/// Works until the program ends.
pub(super) fn work(session: &Arc<Session>) {
    let mut memory = WorkMemory::default();
    while let Some(version) = session.wait() {
        let done = guarded(|| one_version(session, &mut memory, version));
        session.publish(version, |work, _| {
            work.done = version;
            if let Err(error) = &done
                && !matches!(error.downcast_ref(), Some(vtex::Error::Interrupted))
            {
                work.fault = Some(Fault::of(error));
            }
        });
        session.tell();
    }
}

/// Makes what is wanted in a version.
fn one_version(session: &Arc<Session>, memory: &mut WorkMemory, version: u64) -> anyhow::Result<()> {
    let listener: Listener = Arc::new(Follower::new(session, version));
    let snapshot = {
        let work = session.state();
        let one = &work.sessions[work.active];
        (Arc::clone(&one.opened), one.settings().clone())
    };
    let (opened, settings) = &snapshot;
    session.tell();
    let commands = stages::shown(opened, settings);
    let library = match opened.kind {
        InputKind::Scene => None,
        _ => Some(library(session, &mut memory.analysis, version, &snapshot, &commands)?),
    };
    let Some(library) = library else {
        let scene = Arc::new(Scene::from_bytes(&opened.bytes[..], &opened.path.display().to_string())?);
        return show(session, version, (settings, &commands), scene, None);
    };
    if library.primaries().is_empty() && library.secondaries().is_empty() {
        session.publish(version, |work, at| work.sessions[at].results.shown = None);
    }
    let Some(words) = &commands.synth else { return Ok(()) };
    let (key, known) = known_scene(session, &snapshot);
    let synthesis = (&memory.synthesis, &listener);
    let scene = match known {
        Some(scene) => scene,
        None => {
            draft(session, version, settings, &commands, &library, synthesis);
            let scene = stages::synthesize(&library, settings, words, None, synthesis)?;
            let scene = Arc::new(scene);
            session.publish(version, |work, at| {
                work.sessions[at].results.scenes.put(key, Arc::clone(&scene), SCENES);
            });
            scene
        }
    };
    show(session, version, (settings, &commands), scene, None)?;
    // The texture stands, whatever becomes of the variants.
    let fault = match guarded(|| variants(session, version, &snapshot, &library, synthesis)) {
        Err(error) if !matches!(error.downcast_ref(), Some(vtex::Error::Interrupted)) => {
            Some(Fault::of(&error))
        }
        _ => None,
    };
    session.publish(version, |work, at| work.sessions[at].variants_fault = fault);
    Ok(())
}

/// The library of what is wanted: read, kept from before, or found by the analysis.
fn library(
    session: &Arc<Session>,
    memory: &mut AnalysisMemory,
    version: u64,
    (opened, settings): &(Arc<Opened>, StudioSettings),
    commands: &Commands,
) -> anyhow::Result<Arc<Library>> {
    let key = stages::analysis_key(opened, settings);
    let known = {
        let work = session.state();
        work.sessions[work.active].results.libraries.get(&key)
    };
    let library = match (known, &commands.analyze) {
        (Some(library), _) => library,
        (None, Some(words)) => {
            let listener = Arc::new(Follower::of_analysis(session, version, key.clone()));
            let library = Arc::new(stages::analyze(opened, settings, words, memory, listener)?);
            // Kept even if something else has changed meanwhile, for which it is used.
            let mut work = session.state();
            if let Some(one) = work.sessions.iter_mut().find(|one| Arc::ptr_eq(&one.opened, opened)) {
                one.results.libraries.put(key.clone(), Arc::clone(&library), LIBRARIES);
            }
            library
        }
        (None, None) => Arc::new(Library::from_bytes(&opened.bytes[..], &opened.path.display().to_string())?),
    };
    let found = (opened.kind == InputKind::Image).then(|| ElementMasks::of_library(&library)).map(Arc::new);
    session.publish(version, |work, at| {
        let one = &mut work.sessions[at];
        one.results.libraries.put(key, Arc::clone(&library), LIBRARIES);
        if one.results.library.as_ref().is_none_or(|old| !Arc::ptr_eq(old, &library)) {
            one.results.library_version = next_version();
        }
        one.results.library = Some(Arc::clone(&library));
        if one.settings().elements.is_none() && found != one.elements {
            one.elements = found;
            one.elements_version = next_version();
        }
    });
    session.tell();
    Ok(library)
}

/// Shows a smaller canvas first, if the whole one takes its time. A fault of it is that of the whole one too.
fn draft(
    session: &Arc<Session>,
    version: u64,
    settings: &StudioSettings,
    commands: &Commands,
    library: &Library,
    synthesis: (&SynthesisMemory, &Listener),
) {
    let Some(words) = &commands.synth else { return };
    let Ok(whole) = stages::canvas_of(library, words) else { return };
    if area([whole.width, whole.height]) <= DRAFT * HARDLY_LARGER {
        return;
    }
    if let Ok(scene) = stages::synthesize(library, settings, words, Some(DRAFT), synthesis) {
        let _ = show(session, version, (settings, commands), Arc::new(scene), Some(whole.picture_size(1.0)));
    }
}

fn area([width, height]: [u32; 2]) -> f64 {
    f64::from(width) * f64::from(height)
}

/// What makes the scene before operations, and the scene, if it is kept.
fn known_scene(
    session: &Session,
    (opened, settings): &(Arc<Opened>, StudioSettings),
) -> (Key, Option<Arc<Scene>>) {
    let made = settings.options.iter().filter(|(name, _)| stage_of(name) != Some(Stage::Write));
    let options = made.map(|(name, value)| (name.clone(), value.clone())).collect();
    let plain = StudioSettings { options, operations: Vec::new(), ..settings.clone() };
    let Commands { analyze, synth, .. } = stages::shown(opened, &plain);
    let sums = settings.files.values().chain(&settings.masks).map(|file| file.sha256.clone());
    let key: Key = std::iter::once(opened.sha256.clone())
        .chain(sums)
        .chain(analyze.into_iter().flatten())
        .chain(synth.into_iter().flatten())
        .collect();
    let work = session.state();
    let known = work.sessions[work.active].results.scenes.get(&key);
    (key, known)
}

/// Edits a scene and shows it.
fn show(
    session: &Arc<Session>,
    version: u64,
    (settings, commands): (&StudioSettings, &Commands),
    plain: Arc<Scene>,
    draft_of: Option<[u32; 2]>,
) -> anyhow::Result<()> {
    let scene = match &commands.last {
        Some(words) if words[0] == "edit" => Arc::new(stages::edit(&plain, settings, words)?),
        _ => Arc::clone(&plain),
    };
    let categories = categories_of(&plain, &scene);
    session.publish(version, |work, at| {
        let results = &mut work.sessions[at].results;
        let number = results.shown.as_ref().map_or(0, |shown| shown.number) + 1;
        let whole = draft_of.unwrap_or(scene.picture_size(1.0));
        results.shown = Some(Shown { number, scene, categories, whole, draft: draft_of.is_some() });
        if draft_of.is_none() {
            work.done = version;
        }
    });
    session.tell();
    Ok(())
}

/// Draws the variants that the page shows.
fn variants(
    session: &Arc<Session>,
    version: u64,
    snapshot: &(Arc<Opened>, StudioSettings),
    library: &Library,
    synthesis: (&SynthesisMemory, &Listener),
) -> anyhow::Result<()> {
    let (opened, settings) = snapshot;
    let (wanted, first, mut known) = {
        let work = session.state();
        let one = &work.sessions[work.active];
        let known: Vec<u64> = one.thumbnails.iter().map(|thumbnail| thumbnail.seed).collect();
        (one.wants_variants, one.variants_of, known)
    };
    if !wanted {
        return Ok(());
    }
    for seed in (1..=VARIANTS).map(|k| first.wrapping_add(k)) {
        if known.contains(&seed) {
            continue;
        }
        known.push(seed);
        let of = StudioSettings { seed, ..settings.clone() };
        let commands = stages::shown(opened, &of);
        let Some(words) = &commands.synth else { return Ok(()) };
        let whole = stages::canvas_of(library, words)?;
        let most = (area([whole.width, whole.height]) > VARIANT).then_some(DRAFT);
        let scene = stages::synthesize(library, &of, words, most, synthesis)?;
        let scene = match &commands.last {
            Some(words) => stages::edit(&scene, &of, words)?,
            None => scene,
        };
        let drawing = stages::drawing(opened, &commands)?;
        let [width, height] = scene.picture_size(1.0);
        let scale = (THUMBNAIL / f64::from(width.max(height))).min(1.0);
        let render = RenderParameters { scale, ..drawing.render };
        let picture = DrawingOptions { render, ..drawing }.picture(&scene)?;
        let mut bytes = Vec::new();
        png::encode(&picture, None, None, &mut bytes)?;
        let thumbnail = Thumbnail { seed, png: bytes, of };
        if !session.publish(version, |work, at| work.sessions[at].thumbnails.push(thumbnail)) {
            break;
        }
        session.tell();
    }
    Ok(())
}
