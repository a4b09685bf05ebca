//! Results of the long work, kept under what makes them.

use super::settings::StudioSettings;
use serde::Serialize;
use serde_json::{Value, json};
use std::sync::Arc;
use vtex::library::Library;
use vtex::output::{SceneCategory, categories};
use vtex::scene::Scene;

/// What makes a result: checksums of files, and command lines.
pub(super) type Key = Vec<String>;

/// Results by what makes them, the newest last.
pub(super) struct Results<T>(Vec<(Key, Arc<T>)>);

impl<T> Default for Results<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> Results<T> {
    /// The result of what makes it.
    pub(super) fn get(&self, key: &Key) -> Option<Arc<T>> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, result)| Arc::clone(result))
    }

    /// Keeps a result, and no more than a number of them.
    pub(super) fn put(&mut self, key: Key, result: Arc<T>, most: usize) {
        self.0.retain(|(known, _)| *known != key);
        self.0.push((key, result));
        if self.0.len() > most {
            self.0.remove(0);
        }
    }
}

/// The texture that the page shows.
#[derive(Clone)]
pub(super) struct Shown {
    /// Counts up with every texture.
    pub(super) number: u64,
    pub(super) scene: Arc<Scene>,
    /// The categories of the scene before operations, with their colours now.
    pub(super) categories: Arc<Vec<Value>>,
    /// Width and height of the whole picture, of which a draft has less.
    pub(super) whole: [u32; 2],
    pub(super) draft: bool,
}

/// The categories of the scene before operations, and their colours now.
pub(super) fn categories_of(plain: &Scene, scene: &Scene) -> Arc<Vec<Value>> {
    let now = categories(scene);
    let with_colour = |category: SceneCategory| {
        let own = now.iter().find(|now| (now.library, now.category) == (category.library, category.category));
        let colour = own.map_or(category.colour, |own| own.colour);
        let mut value = json!(category);
        value["now"] = json!(colour);
        value
    };
    Arc::new(categories(plain).into_iter().map(with_colour).collect())
}

/// Results of one thing that is worked on.
#[derive(Default)]
pub(super) struct WorkResults {
    pub(super) libraries: Results<Library>,
    pub(super) scenes: Results<Scene>,
    /// The library of the texture that is shown.
    pub(super) library: Option<Arc<Library>>,
    /// A number that no other library has.
    pub(super) library_version: u64,
    pub(super) shown: Option<Shown>,
}

/// A small picture of a variant.
#[derive(Clone, Serialize)]
pub(super) struct Thumbnail {
    #[serde(serialize_with = "as_text")]
    pub(super) seed: u64,
    #[serde(skip)]
    pub(super) png: Vec<u8>,
    #[serde(skip)]
    pub(super) of: StudioSettings,
}

fn as_text<S: serde::Serializer>(seed: &u64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(seed)
}

impl Thumbnail {
    /// Whether it shows a variant of what is set.
    pub(super) fn is_of(&self, settings: &StudioSettings) -> bool {
        StudioSettings { seed: self.seed, ..settings.clone() } == self.of
    }
}
