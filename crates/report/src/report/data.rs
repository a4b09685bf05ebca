//! The page's data for its script, as JSON: figures and names, without pictures.

use super::Named;
use super::distributions::{self, BinnedDistribution};
use super::groups::ReportGroup;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use vtex_base::geometry::{Rect, Vec2};
use vtex_base::raster::colour::Colour;
use vtex_output::{SceneCategory, coverage, inside};
use vtex_scene::element::{self, Gaussian};
use vtex_scene::library::{AnalyzeParams, Arrangement, Library, Motif, MotifPart};
use vtex_scene::scene::{
    CategoryId, ControlPoint, Edge, EditRecord, ElementId, Instance, InstanceId, Role, Scene, SynthParams,
    Tile,
};

/// All data of the page.
#[derive(Serialize)]
pub(super) struct ReportData<'a> {
    /// Name and version of the program that wrote the page.
    pub(super) program: &'static str,
    pub(super) groups: Vec<GroupData<'a>>,
    pub(super) scene: Option<SceneData<'a>>,
}

/// One exemplar.
#[derive(Serialize)]
pub(super) struct GroupData<'a> {
    /// Name and SHA-256 of the photograph.
    file: &'a str,
    sha256: &'a str,
    /// Id of the photograph on the page, or why it is missing.
    pub(super) photo: Option<String>,
    pub(super) photo_missing: Option<String>,
    /// Id of the picture that shows its textons one by one.
    pub(super) picture: Option<String>,
    /// The Gaussians of what that picture shows, if it is the exemplar drawn back.
    pub(super) ellipses: Vec<Ellipse>,
    /// The motifs of a drawing.
    motifs: Vec<MotifData>,
    library: Option<LibraryData<'a>>,
    /// Whether the scene was made from it.
    in_scene: bool,
    categories: Vec<CategoryData>,
    textons: Vec<TextonData>,
    /// Ids of the instances in each category, where the category's number alone is ambiguous.
    instances: BTreeMap<u32, Vec<InstanceId>>,
    distributions: Vec<BinnedDistribution>,
}

#[derive(Serialize)]
struct LibraryData<'a> {
    name: &'a str,
    program: &'a str,
    segmenter: &'a str,
    width: u32,
    height: u32,
    warnings: &'a [String],
    /// As text, because numbers in scripts are not exact beyond 2⁵³.
    seed: String,
    parameters: &'a AnalyzeParams,
    defaults: AnalyzeParams,
    coverage: f64,
    primaries: usize,
    clipped: usize,
    details: usize,
    secondaries: usize,
    secondary_spacing: f64,
    /// Rows or lattice: what they are, and the borders of their cells as path data.
    lattice: Option<LatticeData>,
    /// With one pixel for each unit, like the elements.
    arrangement: Cow<'a, Arrangement>,
    descriptor_half: u32,
    background: BackgroundData,
}

#[derive(Serialize)]
struct LatticeData {
    words: String,
    kept: bool,
    path: String,
}

#[derive(Serialize)]
struct BackgroundData {
    spacing: f64,
    fallback: Colour,
    /// Pixels from the left and from the top, colour.
    points: Vec<(f64, f64, Colour)>,
}

/// A motif of a drawing.
#[derive(Serialize)]
struct MotifData {
    /// Motifs of one kind are copies of each other.
    kind: u32,
    /// Bounding boxes of its elements: x, y, width, height.
    parts: Vec<[f64; 4]>,
}

/// The result.
#[derive(Serialize)]
pub(super) struct SceneData<'a> {
    name: &'a str,
    program: &'a str,
    width: u32,
    height: u32,
    tile: Tile,
    /// Treatment of primaries at the edge; `None` without a domain.
    domain: Option<Edge>,
    seed: Option<String>,
    parameters: Option<&'a SynthParams>,
    defaults: SynthParams,
    /// Operations applied after synthesis, in order.
    edits: Vec<EditData>,
    exemplars: Vec<&'a str>,
    coverage: f64,
    primaries: usize,
    details: usize,
    secondaries: usize,
    background: BackgroundData,
    ellipses: Vec<Ellipse>,
}

/// The ellipse of two standard deviations of an individual element: x, y, half axes, all in pixels, and the
/// angle of its direction in degrees from x towards y. For an elliptic element it is the outline.
pub(super) type Ellipse = [f64; 5];

/// An operation that was applied to the result.
#[derive(Serialize)]
struct EditData {
    operation: String,
    /// As text, like all seeds.
    seed: String,
}

/// A category in the exemplar and in the result. Shares are of the picture's area, 0 to 1.
#[derive(Default, Serialize)]
struct CategoryData {
    /// On the page its number, from 1, as in the classes of pictures.
    #[serde(serialize_with = "CategoryId::serialize_number")]
    id: CategoryId,
    name: String,
    /// Mean colour of its members.
    colour: Colour,
    /// Mean area of its members, in pixels.
    area: f64,
    /// Number of its members that the border does not cut.
    members: Option<usize>,
    whole: Option<usize>,
    wanted: Option<f64>,
    placed: Option<usize>,
    got: Option<f64>,
}

/// A primary.
#[derive(Serialize)]
struct TextonData {
    /// Its index in its library.
    source: ElementId,
    /// Its id in the picture that shows it.
    id: u32,
    #[serde(serialize_with = "CategoryId::serialize_number")]
    category: CategoryId,
    area: f64,
    clipped: bool,
    /// Number of its instances in the result.
    placed: usize,
    /// Bounding box in that picture: x, y, width, height.
    bounds: [f64; 4],
    /// Centroid in the exemplar.
    centre: Option<[f64; 2]>,
}

impl<'a> GroupData<'a> {
    pub(super) fn new(group: &'a ReportGroup<'a>, scene: Option<&'a Scene>) -> Self {
        let scene = scene.filter(|_| !group.references.is_empty());
        let mut placed = BTreeMap::new();
        for (source, _) in scene.iter().flat_map(|s| s.individuals()).filter_map(|i| own(group, scene, i)) {
            *placed.entry(source).or_insert(0) += 1;
        }
        let count = |source: ElementId| placed.get(&source).copied().unwrap_or(0);
        let library = group.library.map(|l| &l.content);
        let textons = match (library, scene) {
            (Some(library), _) => of_library(library, count),
            (None, Some(scene)) => of_scene(group, scene, count),
            (None, None) => Vec::new(),
        };
        let mut instances: BTreeMap<u32, Vec<InstanceId>> = BTreeMap::new();
        if let Some(scene) = scene.filter(|s| s.libraries.len() > 1) {
            for instance in scene.individuals() {
                if let Some((_, category)) = own(group, Some(scene), instance) {
                    instances.entry(category.number()).or_default().push(instance.id);
                }
            }
        }
        Self {
            file: &group.exemplar.exemplar,
            sha256: &group.exemplar.sha256,
            photo: None,
            photo_missing: None,
            picture: None,
            ellipses: Vec::new(),
            motifs: library.map_or(Vec::new(), motifs),
            library: group.library.map(LibraryData::new),
            in_scene: !group.references.is_empty(),
            categories: categories(group, scene, &textons),
            textons,
            instances,
            distributions: distributions::all(group, scene),
        }
    }
}

/// Source and category of a scene's element, if it comes from the exemplar of the group.
fn own(
    group: &ReportGroup<'_>,
    scene: Option<&Scene>,
    instance: &Instance,
) -> Option<(ElementId, CategoryId)> {
    let element = scene?.element(instance);
    group.references.contains(&element.library).then_some((element.source?, element.category?))
}

fn of_library(library: &Library, placed: impl Fn(ElementId) -> usize) -> Vec<TextonData> {
    // In a reconstruction, secondaries come first.
    let first = library.secondaries().len() as u32;
    let texton = |(i, p): (usize, &vtex_scene::library::ExemplarElement)| TextonData {
        source: ElementId::after(i),
        id: first + i as u32,
        category: p.category.unwrap_or_default(),
        area: f64::from(p.area),
        clipped: p.clipped,
        placed: placed(ElementId::after(i)),
        bounds: sides(element::bounds(&p.shapes)),
        centre: Some(p.centroid),
    };
    library.primaries().iter().enumerate().map(texton).collect()
}

/// The motifs of a library. Parts that its page cuts off from the others are beside them.
fn motifs(library: &Library) -> Vec<MotifData> {
    let page = library.page();
    let part = |part: &MotifPart| {
        let bounds = element::bounds(&library.elements[part.element.index()].shapes);
        let by = [0, 1].map(|k| f64::from(part.periods[k]) * page[k]);
        sides(bounds + Vec2::new(by[0], by[1]))
    };
    let motif = |motif: &Motif| MotifData { kind: motif.kind, parts: motif.parts.iter().map(part).collect() };
    library.motifs.iter().map(motif).collect()
}

fn of_scene(group: &ReportGroup<'_>, scene: &Scene, placed: impl Fn(ElementId) -> usize) -> Vec<TextonData> {
    let texton = |i: usize| {
        let element = &scene.elements[i];
        let source = element.source.unwrap_or_default();
        TextonData {
            source,
            id: i as u32,
            category: element.category.unwrap_or_default(),
            area: libm::round(element.outline().area()),
            clipped: false,
            placed: placed(source),
            bounds: sides(element.bounds()),
            centre: None,
        }
    };
    // One fused element represents all that are mostly of one primary, unless the whole primary is there.
    let mut shown: BTreeMap<Option<ElementId>, usize> = BTreeMap::new();
    for i in group.textons(scene) {
        let rank = |i: usize| (!scene.elements[i].fused, scene.elements[i].outline().area());
        let best = shown.entry(scene.elements[i].source).or_insert(i);
        if rank(i) > rank(*best) {
            *best = i;
        }
    }
    let mut shown: Vec<usize> = shown.into_values().collect();
    shown.sort_unstable();
    shown.into_iter().map(texton).collect()
}

fn sides(r: Rect) -> [f64; 4] {
    [r.x0, r.y0, r.width(), r.height()].map(|v| libm::round(v * 10.0) / 10.0)
}

/// All categories of the library and of the scene, in order.
fn categories<'a>(
    group: &ReportGroup<'a>,
    scene: Option<&Scene>,
    textons: &[TextonData],
) -> Vec<CategoryData> {
    let mut found: BTreeMap<CategoryId, CategoryData> = BTreeMap::new();
    let of_library = |l: &'a Library| l.categories.iter().zip(l.category_names()).enumerate();
    for (i, (category, name)) in group.library.iter().flat_map(|l| of_library(&l.content)) {
        let members = || textons.iter().filter(|t| t.category.index() == i);
        let about = CategoryData {
            id: CategoryId(i as u16),
            name,
            colour: category.colour(),
            area: libm::round(category.centre[3]),
            members: Some(members().count()),
            whole: Some(members().filter(|t| !t.clipped).count()),
            wanted: Some(category.coverage),
            ..CategoryData::default()
        };
        found.insert(about.id, about);
    }
    let Some(scene) = scene else { return found.into_values().collect() };
    let canvas = (inside(scene) as f64).max(1.0);
    let mut covered: BTreeMap<CategoryId, u64> = BTreeMap::new();
    for ((library, category), pixels) in coverage(scene) {
        if group.references.contains(&library) {
            *covered.entry(category).or_default() += pixels;
        }
    }
    let shown = vtex_output::categories(scene);
    for category in covered.keys() {
        let name = |c: &&SceneCategory| group.references.contains(&c.library) && c.category == *category;
        let name = shown.iter().find(name).map(|c| c.name.clone()).unwrap_or_default();
        let of_scene = || CategoryData { name, ..look(group, scene, *category) };
        found.entry(*category).or_insert_with(of_scene);
    }
    for about in found.values_mut() {
        about.got = Some(covered.get(&about.id).map_or(0.0, |p| *p as f64 / canvas));
        let same =
            |i: &&Instance| own(group, Some(scene), i).is_some_and(|(_, category)| category == about.id);
        about.placed = Some(scene.individuals().filter(same).count());
    }
    found.into_values().collect()
}

/// A category that no library describes.
fn look(group: &ReportGroup<'_>, scene: &Scene, id: CategoryId) -> CategoryData {
    let (mut sum, mut area, mut count) = ([0.0; 3], 0.0, 0.0);
    for instance in scene.individuals() {
        if own(group, Some(scene), instance).is_some_and(|(_, category)| category == id) {
            let element = scene.element(instance);
            let colour = instance.colour.unwrap_or(element.base().colour).to_f64();
            sum = [0, 1, 2].map(|k| sum[k] + colour[k]);
            area += element.outline().area() * instance.affine().determinant().abs();
            count += 1.0;
        }
    }
    let mean = |v: f64| if count > 0.0 { v / count } else { 0.0 };
    let colour = Colour::from_f64(sum.map(mean));
    CategoryData { id, colour, area: libm::round(mean(area)), ..CategoryData::default() }
}

/// The Gaussians of a scene's individual elements, in painting order.
pub(super) fn ellipses(scene: &Scene) -> Vec<Ellipse> {
    let own = scene.gaussians().into_iter().zip(scene.roles()).filter(|(_, role)| role.is_individual());
    let ellipse = |g: Gaussian| {
        let [long, short] = g.deviations();
        let short_of = |v: f64| libm::round(v * 10.0) / 10.0;
        let angle = libm::atan2(g.direction.y, g.direction.x).to_degrees();
        [g.mean.x, g.mean.y, 2.0 * long, 2.0 * short, angle].map(short_of)
    };
    own.filter_map(|(g, _)| g.map(ellipse)).collect()
}

impl<'a> LibraryData<'a> {
    fn new(named: &'a Named<Library>) -> Self {
        let library = &named.content;
        let (source, background) = (&library.source, library.background());
        let fine = library.at_scale([1.0; 2]);
        Self {
            name: &named.name,
            program: &source.program,
            segmenter: &source.segmenter,
            width: source.width,
            height: source.height,
            warnings: &source.warnings,
            seed: source.parameters.seed.to_string(),
            parameters: &source.parameters,
            defaults: AnalyzeParams::default(),
            coverage: library.coverage,
            primaries: library.primaries().len(),
            clipped: library.primaries().iter().filter(|p| p.clipped).count(),
            details: library.primaries().iter().map(|p| p.details().len()).sum(),
            secondaries: library.secondaries().len(),
            secondary_spacing: library.secondary_spacing(),
            lattice: library.lattice.as_ref().map(|lattice| LatticeData {
                words: lattice.in_words(),
                kept: lattice.is_kept(),
                path: library.path_of_cells(lattice),
            }),
            descriptor_half: fine.descriptor_half,
            arrangement: match fine {
                Cow::Borrowed(library) => Cow::Borrowed(&library.arrangement),
                Cow::Owned(library) => Cow::Owned(library.arrangement),
            },
            background: BackgroundData::new(background.spacing, background.fallback, &background.points),
        }
    }
}

impl BackgroundData {
    fn new(spacing: f64, fallback: Colour, points: &[ControlPoint]) -> Self {
        let short = |v: f64| libm::round(v * 10.0) / 10.0;
        let points = points.iter().map(|p| (short(p.x), short(p.y), p.colour)).collect();
        Self { spacing, fallback, points }
    }
}

impl EditData {
    fn new(record: &EditRecord) -> Self {
        Self { operation: record.operation.to_string(), seed: record.seed.to_string() }
    }
}

impl<'a> SceneData<'a> {
    pub(super) fn new(named: &'a Named<Scene>) -> Self {
        let scene = &named.content;
        let covered: u64 = coverage(scene).values().sum();
        let fields = || scene.layers.iter().filter_map(|layer| layer.field.as_ref());
        let first = fields().next().map_or((0.0, Colour::default()), |f| (f.spacing, f.fallback));
        let points: Vec<ControlPoint> = fields().flat_map(|f| &f.points).copied().collect();
        Self {
            name: &named.name,
            program: &scene.program,
            width: scene.width,
            height: scene.height,
            tile: scene.tile,
            domain: scene.domain.as_ref().map(|d| d.edge),
            seed: scene.parameters.as_ref().map(|p| p.seed.to_string()),
            parameters: scene.parameters.as_ref(),
            defaults: SynthParams::default(),
            edits: scene.edits.iter().map(EditData::new).collect(),
            exemplars: scene.libraries.iter().map(|l| l.exemplar.as_str()).collect(),
            coverage: covered as f64 / (inside(scene) as f64).max(1.0),
            primaries: scene.of_role(Role::Primary).count(),
            details: scene.individuals().map(|i| scene.element(i).details().len()).sum(),
            secondaries: scene.of_role(Role::Secondary).count(),
            background: BackgroundData::new(first.0, first.1, &points),
            ellipses: ellipses(scene),
        }
    }
}
