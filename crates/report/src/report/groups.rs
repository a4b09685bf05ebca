//! Groups: for each exemplar, its library and the part of the scene made from it.

use super::{Named, Subject};
use vtex_scene::library::Library;
use vtex_scene::reconstruct::reconstruct;
use vtex_scene::scene::{ElementId, Field, Instance, InstanceId, Layer, LibraryId, LibraryRef, Role, Scene};

/// One exemplar with its library, the part of the scene made from it, or both.
pub(super) struct ReportGroup<'a> {
    /// The photograph.
    pub(super) exemplar: LibraryRef,
    /// The library, if the report has it.
    pub(super) library: Option<&'a Named<Library>>,
    /// Its indices in [`Scene::libraries`]; empty if the scene was not made from it.
    pub(super) references: Vec<LibraryId>,
}

/// The exemplars that libraries and scene refer to, without duplicates.
pub fn exemplars(libraries: &[Named<Library>], scene: Option<&Named<Scene>>) -> Vec<LibraryRef> {
    let of_scene = scene.iter().flat_map(|s| s.content.libraries.iter().map(LibraryRef::exemplar));
    let mut found: Vec<LibraryRef> = Vec::new();
    for exemplar in libraries.iter().map(|l| l.content.reference().exemplar()).chain(of_scene) {
        if !found.contains(&exemplar) {
            found.push(exemplar);
        }
    }
    found
}

impl<'a> ReportGroup<'a> {
    /// One group for each library, then one for each exemplar of the scene without a library.
    pub(super) fn all(subject: &Subject<'a>) -> Vec<Self> {
        let of_library = |l: &'a Named<Library>| Self {
            exemplar: l.content.reference(),
            library: Some(l),
            references: Vec::new(),
        };
        let mut groups: Vec<Self> = subject.libraries.iter().map(of_library).collect();
        let Some(scene) = subject.scene else { return groups };
        for (i, exemplar) in scene.content.libraries.iter().enumerate() {
            let fits = |g: &Self| {
                let explained =
                    g.library.is_none_or(|l| explains(&l.content, &scene.content, LibraryId(i as u32)));
                g.exemplar.sha256 == exemplar.sha256 && explained
            };
            match groups.iter().position(fits) {
                Some(known) => groups[known].references.push(LibraryId(i as u32)),
                None => groups.push(Self {
                    exemplar: exemplar.clone(),
                    library: None,
                    references: vec![LibraryId(i as u32)],
                }),
            }
        }
        groups
    }

    /// Indices in [`Scene::elements`] of the primaries made from this exemplar.
    pub(super) fn textons(&self, scene: &Scene) -> Vec<usize> {
        let own = |i: &usize| {
            let element = &scene.elements[*i];
            element.category.is_some() && self.references.contains(&element.library)
        };
        (0..scene.elements.len()).filter(own).collect()
    }

    /// A scene that shows the primaries one by one: the reconstruction of the library, or without a
    /// library, all primaries of the scene at the origin, with their indices as ids.
    pub(super) fn drawn(&self, scene: Option<&Scene>) -> Option<Scene> {
        if let Some(library) = self.library {
            return Some(reconstruct(&library.content));
        }
        let scene = scene?;
        let place = |i: usize| Instance::new(InstanceId(i as u32), ElementId::after(i));
        Some(Scene {
            layers: vec![Layer {
                field: scene
                    .layers
                    .iter()
                    .find_map(|l| l.field.clone())
                    .map(|f| Field { points: Vec::new(), ..f }),
                instances: self.textons(scene).into_iter().map(place).collect(),
                ..Layer::new(Role::Primary)
            }],
            domain: None,
            ..scene.clone()
        })
    }
}

/// Whether the textons that a scene has from an exemplar are those of this library. Several libraries
/// may be made from one photograph with different parameters.
fn explains(library: &Library, scene: &Scene, reference: LibraryId) -> bool {
    scene.elements.iter().filter(|e| e.library == reference).all(|element| {
        let known = element.source.map(|source| library.elements.get(source.index()));
        // The source of small elements of old scenes is not known.
        known.is_none_or(|own| own.is_some_and(|own| own.category == element.category))
    })
}
