//! Libraries for tests, made from label maps: outlines are the pixels' own borders.

use super::{
    AnalyzeParams, Arrangement, Category, CategoryId, ExemplarElement, Guide, Library, Picture, Role, Shape,
    Source, SourceKind,
};
use crate::scene::{ControlPoint, Field};
use vtex_base::geometry::{BezPath, Outline};
use vtex_base::raster::colour::Colour;
use vtex_base::raster::{LabelMap, Mask};
use vtex_base::sampling::{Area, poisson_disk, stream};

/// One ring around each run of a mask.
fn outline(mask: &Mask) -> Outline {
    let mut path = BezPath::new();
    for s in mask.spans() {
        let [x0, x1, y] = [s.x0, s.x1, s.y].map(f64::from);
        path.move_to((x0, y));
        [(x1, y), (x1, y + 1.0), (x0, y + 1.0)].into_iter().for_each(|p| path.line_to(p));
        path.close_path();
    }
    Outline::new(&path).unwrap()
}

/// A library of a label map: categories by area (small, middle, large), secondaries of 2 × 2
/// pixels at a few places of the background, a palette of two colours.
pub fn library(map: &LabelMap) -> Library {
    let (w, h) = (map.width, map.height);
    let masks = Mask::all_of_labels(map, map.areas().len());
    let total = f64::from(w) * f64::from(h);
    let mut areas: Vec<u32> = masks[1..].iter().map(Mask::area).collect();
    areas.sort_unstable();
    let bound = |k: usize| areas.get(areas.len() * k / 3).copied().unwrap_or(0);
    let category = |area: u32| CategoryId(u16::from(area > bound(1)) + u16::from(area > bound(2)));
    let mut categories = vec![Category { name: None, centre: [0.0; 5], members: 0, coverage: 0.0 }; 3];
    let mut elements: Vec<ExemplarElement> = masks[1..]
        .iter()
        .enumerate()
        .map(|(i, mask)| {
            let (area, (cx, cy)) = (mask.area(), mask.centroid().unwrap());
            let (x0, y0, x1, y1) = mask.bounds().unwrap();
            let c = category(area);
            categories[usize::from(c.0)].members += 1;
            categories[usize::from(c.0)].coverage += f64::from(area) / total;
            let colour = Colour([(60 * c.0) as u8 + 80, (i % 200) as u8, 90]);
            ExemplarElement {
                category: Some(c),
                colour,
                difference: None,
                area,
                centroid: [cx, cy],
                compactness: Some(0.5),
                clipped: x0 == 0 || y0 == 0 || x1 == w as i32 || y1 == h as i32,
                silhouette: None,
                shapes: vec![Shape::new(outline(mask), colour)],
            }
        })
        .collect();
    let coverage = categories.iter().map(|c| c.coverage).sum::<f64>().min(1.0);
    let mut random = stream(1, "testing/secondaries", 0);
    let background = poisson_disk(Area::plane(f64::from(w - 2), f64::from(h - 2)), 9.0, &mut random);
    let background = background.into_iter().map(|p| p.map(|v| v as i32));
    let secondaries = background.filter(|p| map.get(p[0] as u32, p[1] as u32) == 0).map(|[x, y]| {
        let spans = [0, 1].map(|dy| vtex_base::raster::Span { y: y + dy, x0: x, x1: x + 2 });
        let colour = Colour([200, 190, 180]);
        ExemplarElement {
            category: None,
            colour,
            difference: Some([20, 10, -10]),
            area: 4,
            centroid: [f64::from(x) + 1.0, f64::from(y) + 1.0],
            compactness: None,
            clipped: false,
            silhouette: None,
            shapes: vec![Shape::new(outline(&Mask::from_spans(spans.to_vec())), colour)],
        }
    });
    let count = elements.len();
    elements.extend(secondaries);
    let site = |x, y, v| ControlPoint { x, y, colour: Colour([v; 3]) };
    let background = Field {
        spacing: 25.0,
        fallback: Colour([120; 3]),
        points: vec![site(3.0, 3.0, 100), site(40.0, 30.0, 140)],
    };
    Library {
        format: Library::FORMAT.into(),
        version: Library::VERSION,
        source: Source {
            strata_reason: None,
            kind: SourceKind::Photograph,
            file: "test.png".into(),
            width: w,
            height: h,
            scale: [1.0; 2],
            copies: [1; 2],
            stacking: [0; 2],
            contrast: 1.0,
            light: None,
            sha256: "0".repeat(64),
            segmenter: "test".into(),
            parameters: AnalyzeParams::default(),
            program: vtex_base::PROGRAM.into(),
            warnings: Vec::new(),
        },
        descriptor_half: (2.25 * libm::sqrt(total / count.max(1) as f64)) as u32,
        layers: Library::three_layers(&elements, background, 11.0),
        elements,
        categories,
        coverage,
        arrangement: Arrangement::from_labels(map),
        guide: None,
        lattice: None,
        motifs: Vec::new(),
    }
}

/// [`library`] with a guide: primaries in their colours on dark background, which grows lighter to the right.
pub fn guided(map: &LabelMap) -> Library {
    let mut library = library(map);
    let colour = |x: u32, y: u32| match map.get(x.min(map.width - 1), y.min(map.height - 1)) {
        0 => image::Rgb([(40 + x * 60 / map.width) as u8; 3]),
        label => image::Rgb(library.primaries()[label as usize - 1].colour.0),
    };
    let cell = |size: u32| size.div_ceil(2);
    let picture = image::RgbImage::from_fn(cell(map.width), cell(map.height), |x, y| colour(2 * x, 2 * y));
    library.guide = Some(Guide { cell: 2, picture: Picture(picture) });
    library
}

/// A mosaic of stones: each pixel belongs to the nearest of scattered centres if it is within the
/// share `fill` of the way to the border between two.
pub fn mosaic(side: u32, spacing: f64, fill: f64, seed: u64) -> LabelMap {
    let mut random = stream(seed, "testing/mosaic", 0);
    let size = f64::from(side);
    let centres = poisson_disk(Area::plane(size, size), spacing, &mut random);
    let scale: Vec<f64> = centres.iter().map(|_| random.range(0.75, 1.0)).collect();
    let mut map = LabelMap::filled(side, side, 0);
    for y in 0..side {
        for x in 0..side {
            let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let (mut first, mut second, mut nearest) = (f64::INFINITY, f64::INFINITY, 0);
            for (i, c) in centres.iter().enumerate() {
                let d = libm::hypot(c[0] - px, c[1] - py);
                if d < first {
                    (second, first, nearest) = (first, d, i);
                } else if d < second {
                    second = d;
                }
            }
            if first < second * fill * scale[nearest] {
                map.set(x, y, nearest as u32 + 1);
            }
        }
    }
    // Numbers without gaps.
    let mut names = vec![0; centres.len() + 1];
    let mut count = 0;
    for label in &mut map.labels {
        if *label != 0 {
            if names[*label as usize] == 0 {
                count += 1;
                names[*label as usize] = count;
            }
            *label = names[*label as usize];
        }
    }
    map
}

impl Library {
    /// Removes all secondaries.
    pub fn without_secondaries(mut self) -> Self {
        self.elements.truncate(self.primaries().len());
        self.layers.iter_mut().filter(|l| l.role == Role::Secondary).for_each(|l| l.instances.clear());
        self
    }

    /// Removes all primaries.
    pub fn without_primaries(mut self) -> Self {
        let secondaries = self.secondaries().to_vec();
        let (background, spacing) = (self.background().into_owned(), self.secondary_spacing());
        self.layers = Self::three_layers(&secondaries, background, spacing);
        self.elements = secondaries;
        self.arrangement.runs = vec![0, self.arrangement.width * self.arrangement.height];
        self.categories.clear();
        self
    }

    /// Replaces its secondaries.
    pub fn with_secondaries(self, secondaries: Vec<ExemplarElement>) -> Self {
        let mut library = self.without_secondaries();
        let (background, spacing) = (library.background().into_owned(), library.secondary_spacing());
        library.elements.extend(secondaries);
        library.layers = Self::three_layers(&library.elements, background, spacing);
        library
    }
}

/// [`guided`] with two strata: the right half is another one, with a lighter background.
pub fn layered(map: &LabelMap) -> Library {
    let mut library = guided(map);
    let middle = f64::from(map.width / 2);
    let right = Mask::from_spans(
        (0..map.height as i32)
            .map(|y| vtex_base::raster::Span { y, x0: map.width as i32 / 2, x1: map.width as i32 })
            .collect(),
    );
    let plain = library.layers.clone();
    let mut layers = Vec::new();
    for (k, name) in ["paint", "rust"].into_iter().enumerate() {
        for layer in &plain {
            let mut layer = layer.clone();
            layer.name = match layer.role {
                Role::Background => name.into(),
                role => format!("{name} {}", role.name()),
            };
            layer
                .instances
                .retain(|i| (library.elements[i.element.index()].centroid[0] >= middle) == (k == 1));
            if layer.role == Role::Background {
                let value = [60, 180][k];
                layer.colour = Some(Colour([value; 3]));
                layer.region = (k == 1).then(|| outline(&right));
                if let Some(field) = &mut layer.field {
                    let x = middle * (0.5 + k as f64);
                    let point = |y: f64| ControlPoint { x, y, colour: Colour([value; 3]) };
                    field.points = [0.25, 0.75].map(|v| point(v * f64::from(map.height))).to_vec();
                }
            }
            layers.push(layer);
        }
    }
    library.layers = layers;
    library
}
