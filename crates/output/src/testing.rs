//! Scenes made by hand, for the tests of the writers.

use crate::formats::{FileKind, PAGE_BEGINNING, WriteOptions};
use crate::writing::PreparedFile;
use vtex_base::geometry::{Affine, BezPath, Curve, Outline, Point, parse_path};
use vtex_base::raster::colour::Colour;
use vtex_base::sampling::{Area, Stream, poisson_disk, stream};
use vtex_scene::element::{Cap, Ellipse, GradientKind, Join, Line, Profile, SoftRim, Stop};
use vtex_scene::scene::{
    ControlPoint, Element, ElementId, Field, Gradient, Instance, InstanceId, Layer, LibraryRef, Role, Scene,
    Shadow, Shape, Stroke, SynthParams, Tile, testing,
};

/// A closed smooth ring around a centre, bumpy by `rough`; clockwise, or the other way for holes.
fn ring(path: &mut BezPath, centre: Point, radius: f64, rough: f64, hole: bool, rng: &mut Stream) {
    const CORNERS: usize = 7;
    let mut points: Vec<Point> = (0..CORNERS)
        .map(|i| {
            let angle = i as f64 / CORNERS as f64 * std::f64::consts::TAU;
            let r = radius * (1.0 + rough * (rng.unit() - 0.5));
            centre + (libm::cos(angle) * r, libm::sin(angle) * r)
        })
        .collect();
    if hole {
        points.reverse();
    }
    let at = |i: usize| points[i % CORNERS];
    path.move_to(points[0]);
    for i in 0..CORNERS {
        let (p0, p1, p2, p3) = (at(i + CORNERS - 1), at(i), at(i + 1), at(i + 2));
        path.curve_to(p1 + (p2 - p0) / 6.0, p2 - (p3 - p1) / 6.0, p2);
    }
    path.close_path();
}

fn outline(centre: Point, radius: f64, rough: f64, hole: bool, rng: &mut Stream) -> Outline {
    let mut path = BezPath::new();
    ring(&mut path, centre, radius, rough, false, rng);
    if hole {
        ring(&mut path, centre, radius * 0.4, rough, true, rng);
    }
    Outline::new(&path).unwrap()
}

/// A colour about `centre`, each component within `spread` of it.
fn colour(centre: [f64; 3], spread: f64, rng: &mut Stream) -> Colour {
    Colour::from_f64(centre.map(|v| v + spread * (rng.unit() * 2.0 - 1.0)))
}

/// A change of colour across a texton.
fn gradient(radius: f64, base: [f64; 3], rng: &mut Stream) -> Gradient {
    let mut point = || [0; 2].map(|_| libm::round(100.0 * radius * (rng.unit() * 2.0 - 1.0)) / 100.0);
    let (from, to) = (point(), point());
    Gradient::linear(from, to, [colour(base, 40.0, rng), colour(base, 40.0, rng)])
}

/// Overlapping stones with details, holes, turns and mirrors over small chips on a cloudy background. Some
/// textons occur often, some once, one never; some instances cross the border.
pub(super) fn scene(width: u32, height: u32, seed: u64) -> Scene {
    let mut rng = stream(seed, "output/test-scene", 0);
    let rng = &mut rng;
    let area = f64::from(width) * f64::from(height);
    let elements: Vec<Element> = (0..40u32)
        .map(|i| {
            let primary = i < 24;
            let radius = if primary { 14.0 + rng.unit() * 22.0 } else { 2.0 + rng.unit() * 3.0 };
            let base = [150.0, 120.0, 95.0].map(|v| v + 60.0 * (rng.unit() - 0.5));
            let details = if primary && i % 6 != 5 { 4 + i % 5 } else { 0 };
            let own = outline(Point::ORIGIN, radius, 0.5, i % 7 == 3, rng);
            let category = primary.then_some((i % 5) as u16);
            let mut element = testing::element(i, category, own, colour(base, 6.0, rng));
            element.shapes[0].gradient =
                (primary && i % 3 == 1).then(|| Box::new(gradient(radius, base, rng)));
            for _ in 0..details {
                let centre = Point::new(
                    radius * 0.5 * (rng.unit() * 2.0 - 1.0),
                    radius * 0.5 * (rng.unit() * 2.0 - 1.0),
                );
                let size = radius * (0.1 + 0.3 * rng.unit());
                let shape = Shape::new(outline(centre, size, 0.8, false, rng), colour(base, 25.0, rng));
                let gradient = (rng.unit() < 0.4).then(|| Box::new(gradient(radius, base, rng)));
                element.shapes.push(Shape { gradient, ..shape });
            }
            if details > 0 && i % 4 == 2 {
                // One within the outline, one across it.
                let soft = |x: f64, colour, profile| {
                    let matrix = [0.6, 0.2, 0.4].map(|v| v * radius);
                    Shape::of_ellipse(Ellipse { centre: [x * radius, 0.0], matrix, profile }, Colour(colour))
                };
                let pair =
                    [soft(0.1, [40, 50, 20], Profile::Sharp), soft(0.8, [230, 220, 200], Profile::Soft)];
                element.shapes.extend(pair.into_iter().flatten());
            }
            element
        })
        .collect();
    let mut id = 0;
    let mut place = |range: std::ops::Range<u32>, count: usize, turned: bool, rng: &mut Stream| {
        let mut instances = Vec::new();
        for i in 0..count {
            let shift = Affine::translate((
                libm::floor(rng.unit() * f64::from(width)),
                libm::floor(rng.unit() * f64::from(height)),
            ));
            let affine = if turned && i % 3 == 0 {
                let size = 0.8 + 0.4 * rng.unit();
                shift
                    * vtex_base::geometry::rotation(rng.unit() * 6.3)
                    * Affine::scale_non_uniform(size, -size)
            } else {
                shift
            };
            // The last three textons of the range occur once, once and never.
            let many = range.len() - 3;
            let which = if i < 2 { many + i } else { (i * 7 + i * i) % many };
            id += 1;
            instances.push(Instance {
                transform: affine.as_coeffs(),
                colour: (!turned || i % 11 == 4).then(|| colour([120.0, 130.0, 90.0], 50.0, rng)),
                ..Instance::new(InstanceId(id), ElementId(range.start + which as u32))
            });
        }
        instances
    };
    let secondary = place(24..40, (area / 400.0) as usize + 4, false, rng);
    let primary = place(0..24, (area / 2500.0) as usize + 4, true, rng);
    let domain = Area::plane(f64::from(width), f64::from(height));
    let points = poisson_disk(domain, 25.0, rng)
        .into_iter()
        .map(|[x, y]| {
            let light = rng.range(-30.0, 30.0);
            ControlPoint { x, y, colour: colour([105.0, 110.0, 80.0].map(|v| v + light), 6.0, rng) }
        })
        .collect();
    let field = Field { points, ..testing::flat(Colour([105, 110, 80])) };
    let scene = testing::scene([width, height], elements, secondary, primary, field);
    Scene {
        parameters: Some(SynthParams { width, height, seed, ..SynthParams::default() }),
        program: "vtex test".into(),
        libraries: vec![LibraryRef {
            fine: false,
            exemplar: "stones & <chips>.jpg".into(),
            sha256: "0".repeat(64),
            categories: Vec::new(),
        }],
        ..scene
    }
}

/// As [`scene`], but it repeats: textons hang over all edges and corners, control points keep their
/// distance across the seams.
pub(super) fn tiled(width: u32, height: u32, seed: u64, tile: Tile) -> Scene {
    let mut scene = scene(width, height, seed);
    let (w, h) = (f64::from(width), f64::from(height));
    let places = [
        (0.0, 0.0),
        (w - 2.0, 3.0),
        (1.0, h - 4.0),
        (w - 1.0, h),
        (0.4 * w, 1.0),
        (w, 0.3 * h),
        (9.0, 0.6 * h),
    ];
    for layer in &mut scene.layers {
        for (instance, (x, y)) in layer.instances.iter_mut().zip(places) {
            (instance.transform[4], instance.transform[5]) = (x, y);
        }
    }
    let mut rng = stream(seed, "output/tiled-scene", 0);
    let area = Area { width: w, height: h, wrap_x: tile.x, wrap_y: tile.y };
    scene.field_mut().points = poisson_disk(area, 25.0, &mut rng)
        .into_iter()
        .map(|[x, y]| {
            let light = rng.range(-30.0, 30.0);
            ControlPoint { x, y, colour: colour([105.0, 110.0, 80.0].map(|v| v + light), 6.0, &mut rng) }
        })
        .collect();
    scene.tile = tile;
    scene
}

/// The scene with everything shifted and, along axes that tile, wrapped onto the canvas.
pub(super) fn moved(mut scene: Scene, dx: f64, dy: f64) -> Scene {
    let (w, h, tile) = (f64::from(scene.width), f64::from(scene.height), scene.tile);
    let along = |v: f64, d: f64, size: f64, repeats: bool| {
        if repeats { (v + d).rem_euclid(size) } else { v + d }
    };
    for instance in scene.instances_mut() {
        let t = &mut instance.transform;
        (t[4], t[5]) = (along(t[4], dx, w, tile.x), along(t[5], dy, h, tile.y));
    }
    for p in &mut scene.field_mut().points {
        (p.x, p.y) = (along(p.x, dx, w, tile.x), along(p.y, dy, h, tile.y));
    }
    if let Some(domain) = &mut scene.domain {
        let path = Affine::translate((dx, dy)) * domain.outline.path();
        domain.outline = Outline::new(&path).unwrap();
    }
    scene
}

/// The scene with shadows under its primaries and some of its secondaries, and lines along some of both.
pub(super) fn styled(mut scene: Scene) -> Scene {
    let layers = scene.layers.iter_mut().rev();
    let all = layers.flat_map(|l| l.instances.iter_mut().map(|i| (i, l.role.is_individual())));
    for (k, (instance, primary)) in all.enumerate() {
        if primary || k % 3 == 0 {
            let blur = if k % 5 == 0 { 0.0 } else { 4.0 };
            instance.shadow = Some(Shadow { offset: [3.5, 5.25], opacity: 0.45, blur });
        }
        if k % 4 == 1 {
            let colour = Colour([250, 240, 210]);
            instance.stroke = Some(Stroke { width: if primary { 2.5 } else { 1.0 }, colour });
        }
    }
    scene
}

/// The scene with a soft rim along each filled element, of any width and opacity.
pub(super) fn rimmed(mut scene: Scene) -> Scene {
    for (k, element) in scene.elements.iter_mut().enumerate().filter(|(_, e)| !e.base().is_soft()) {
        let k = k as f64;
        let colour = Colour::from_f64([40.0 + 5.0 * k, 90.0, 240.0 - 5.0 * k]);
        let rim = SoftRim { width: 1.5 + 0.75 * (k % 9.0), colour, opacity: 0.4 + 0.2 * (k % 4.0) };
        element.shapes[0].rim = Some(Box::new(rim));
    }
    scene
}

/// The scene with properties of drawings: a layer in a region with a field, stroked paths with dashes, radial
/// gradients, translucent shapes and soft rims.
pub(super) fn drawn(mut scene: Scene) -> Scene {
    let curve = |text: &str| Curve::new(parse_path(text).unwrap()).unwrap();
    let line = Line { cap: Cap::Round, join: Join::Round, ..Line::new(curve("M-15 0C-5-20 5 20 15 0"), 3.0) };
    let dashed = Line { dashes: vec![6.0, 4.0], ..Line::new(curve("M-20-9h40v18h-40z"), 2.0) };
    let disc = Outline::new(&parse_path("M-14 0C-14-19 14-19 14 0C14 19-14 19-14 0z").unwrap()).unwrap();
    let linear = Gradient::linear([-3.0, -2.0], [11.0, 5.0], [Colour([250, 230, 90]), Colour([120, 20, 60])]);
    let stop = Stop { offset: 0.4, colour: Colour([240, 120, 40]), opacity: 0.8 };
    let radial = Gradient { kind: GradientKind::Radial, between: vec![stop], ..linear };
    let rim = |colour, width| Some(Box::new(SoftRim { width, colour: Colour(colour), opacity: 0.9 }));
    let shapes = [
        vec![Shape::stroked(line, Colour([20, 60, 160])).unwrap()],
        vec![
            Shape {
                opacity: 0.5,
                rim: rim([250, 200, 90], 3.0),
                ..Shape::new(disc.clone(), Colour([30, 140, 90]))
            },
            Shape::stroked(dashed, Colour([250, 250, 250])).unwrap(),
        ],
        vec![Shape {
            gradient: Some(Box::new(radial)),
            rim: rim([60, 50, 30], 6.0),
            ..Shape::new(disc, Colour([200, 90, 50]))
        }],
    ];
    let mut next = scene.instances().map(|i| i.id.0).max().unwrap_or(0);
    let (w, h) = (f64::from(scene.width), f64::from(scene.height));
    let mut instances = Vec::new();
    for (k, shapes) in shapes.into_iter().enumerate() {
        let element = scene.add(Element { silhouette: None, shapes, ..scene.elements[0].clone() });
        for i in 0..4 {
            next += 1;
            let at = (w * (0.1 + 0.23 * f64::from(i)), h * (0.02 + 0.31 * k as f64));
            let affine =
                Affine::translate(at) * vtex_base::geometry::rotation(f64::from(i)) * Affine::scale(1.2);
            let transform = affine.as_coeffs();
            instances.push(Instance { transform, ..Instance::new(InstanceId(next), element) });
        }
    }
    let region = format!(
        "M{} 0H{w}V{h}H{}C{} {} {} {} {} 0z",
        0.3 * w,
        0.2 * w,
        0.5 * w,
        0.7 * h,
        0.1 * w,
        0.3 * h,
        0.3 * w
    );
    scene.layers.push(Layer {
        name: "moss & <lichen>".into(),
        region: Some(Outline::new(&parse_path(&region).unwrap()).unwrap()),
        field: Some(Field { points: Vec::new(), ..testing::flat(Colour([70, 110, 60])) }),
        instances,
        ..Layer::new(Role::Primary)
    });
    scene
}

/// A file of each format of scenes, not packed, and a page and a GIF, not sealed.
pub(super) fn files(scene: &Scene) -> Vec<Vec<u8>> {
    let kinds = FileKind::all().filter(|kind| kind.format.is_of_scene() && !kind.gzip);
    let mut files: Vec<Vec<u8>> = kinds
        .map(|kind| {
            let mut out = Vec::new();
            let file = PreparedFile::new(kind, scene, WriteOptions::default(), &()).unwrap();
            file.write(&(), &mut out).unwrap();
            out
        })
        .collect();
    files.push(format!("{PAGE_BEGINNING}0.1.0 -->\n<html></html>\n").into_bytes());
    files.push(b"GIF89a\x01\0\x01\0\0\0\0\x21\xfe\x0avtex 0.1.0\0\x3b".to_vec());
    files
}

/// The scene with all that shows in black on white, some elements in white; without gradients, shadows, soft shading and
/// regions.
pub(super) fn printed(mut scene: Scene) -> Scene {
    let [black, white] = [Colour([0; 3]), Colour([255; 3])];
    for element in &mut scene.elements {
        element.shapes.retain(|shape| !shape.is_soft());
        for shape in &mut element.shapes {
            shape.gradient = None;
            *shape = shape.recoloured(|_| black);
        }
    }
    for (k, instance) in scene.instances_mut().enumerate() {
        instance.colour = (k % 5 == 0).then_some(white);
        instance.stroke = (k % 3 == 0).then_some(Stroke { width: 1.5, colour: black });
        instance.shadow = None;
    }
    scene.layers.iter_mut().for_each(|layer| (layer.region, layer.field) = (None, None));
    scene.layers[0].field = Some(testing::flat(white));
    scene
}
