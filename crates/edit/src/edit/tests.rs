//! Properties of every operation.

use super::*;
use vtex_base::geometry::{Affine, Outline, SecondMoments, parse_path, shortest_offset};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::Profile;
use vtex_scene::library::Library;
use vtex_scene::scene::{ControlPoint, ElementId, Field, Instance, InstanceId, Shape, Tile, testing};

pub(super) fn outline(text: &str) -> Outline {
    Outline::new(&parse_path(text).unwrap()).unwrap()
}

/// Bars of two categories with a detail each, and specks, on a canvas of 400 × 300 that repeats.
pub(super) fn scene() -> Scene {
    let bar = |source, category, colour| {
        let mut bar = testing::element(source, Some(category), outline("M-10-3h20v6h-20z"), colour);
        bar.shapes.push(Shape::new(outline("M-2-2h6v4h-6z"), Colour([240; 3])));
        bar
    };
    let speck = testing::element(2, None, outline("M-1-1h3v2h-3z"), Colour([90; 3]));
    let mut random = stream(3, "test/scene", 0);
    let mut place = |id: u32, element: u32| {
        let at = [random.range(0.0, 400.0), random.range(0.0, 300.0)].map(libm::round);
        let affine =
            Affine::translate((at[0], at[1])) * vtex_base::geometry::rotation(random.range(0.0, 6.0));
        Instance { transform: affine.as_coeffs(), ..Instance::new(InstanceId(id), ElementId(element)) }
    };
    let primary: Vec<Instance> = (0..60).map(|i| place(i, u32::from(i >= 40))).collect();
    let secondary = (60..300)
        .map(|i| Instance { colour: Some(Colour([100, 110, (i % 256) as u8])), ..place(i, 2) })
        .collect();
    let point = |i: u32| ControlPoint {
        x: f64::from(i % 16) * 25.0,
        y: f64::from(i / 16) * 25.0,
        colour: Colour([120, 100, 80]),
    };
    let elements = vec![bar(0, 3, Colour([180, 60, 50])), bar(1, 7, Colour([40, 60, 150])), speck];
    let points = (0..192).map(point).collect();
    let field = Field { points, ..testing::flat(Colour([120, 100, 80])) };
    let scene = testing::scene([400, 300], elements, secondary, primary, field);
    Scene { tile: Tile { x: true, y: true }, ..scene }
}

/// Files that operations name.
fn file(name: &str) -> Result<Vec<u8>> {
    let picture = |value: &dyn Fn(u32) -> u8| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::GrayImage::from_fn(64, 4, |x, _| image::Luma([value(x)]));
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    Ok(match name {
        "left.png" => picture(&|x| if x < 32 { 255 } else { 0 }),
        "fade.png" => picture(&|x| (x * 4) as u8),
        "disc.svg" => br#"<svg xmlns="http://www.w3.org/2000/svg" width="400" height="300"><circle cx="200" cy="150" r="100"/></svg>"#.to_vec(),
        "dot.svg" => br##"<svg xmlns="http://www.w3.org/2000/svg" width="400" height="300"><circle cx="200" cy="150" r="2" fill="#00f"/></svg>"##.to_vec(),
        "two.txt" => b"#ffe0a0 #203040".to_vec(),
        _ => return Err(Error::read(name.as_ref(), std::io::ErrorKind::NotFound.into())),
    })
}

pub(super) fn on(layer: &str, action: Action) -> Operation {
    Operation { layer: Some(layer.into()), ..action.into() }
}

pub(super) fn those(conditions: &[Condition], action: Action) -> Operation {
    Operation { conditions: conditions.to_vec(), ..action.into() }
}

pub(super) fn among(identity: Identity, numbers: &[u32], wanted: bool) -> Condition {
    Condition::Among { identity, numbers: numbers.to_vec(), wanted }
}

pub(super) fn compare(quantity: Quantity, comparison: Comparison, limit: f64) -> Condition {
    Condition::Compare { quantity, comparison, limit }
}

fn within(shape: &str, inside: bool) -> Condition {
    Condition::Place { shape: shape.into(), inside }
}

fn thin(keep: f64, order: ThinOrder) -> Action {
    Action::Thin { keep: Some(keep), order, minimum_area: None }
}

pub(super) fn tint(colour: [u8; 3], amount: f64, share: f64) -> Action {
    Action::Tint { colour: Colour(colour).into(), amount, share }
}

fn recolor(from: [u8; 3], to: [u8; 3], reach: f64) -> Action {
    Action::Recolor { from: Colour(from), to: Colour(to), reach, keep: Keep::Nothing }
}

fn two_colours() -> Action {
    Action::Palette { colours: vec![Colour([255, 224, 160]), Colour([32, 48, 64])], file: None }
}

fn shadow(angle: f64, length: f64, opacity: f64, blur: f64) -> Action {
    Action::Shadow { angle, length, opacity, blur }
}

pub(super) fn edited(scene: &Scene, operations: &[Operation]) -> (Scene, Vec<Outcome>) {
    let files = Files::read(operations, [400, 300], file).unwrap();
    apply(scene.clone(), operations, &files, Some(5)).unwrap()
}

pub(super) fn one(operation: impl Into<Operation>) -> Scene {
    edited(&scene(), &[operation.into()]).0
}

#[test]
fn what_cannot_be_done_is_a_fault() {
    let range = |name, value: &str, allowed: &str| {
        let (value, allowed) = (value.into(), allowed.into());
        EditFault::Range { name, value, allowed }
    };
    let background = |action| on("background", action);
    let nothing = Action::Thin { keep: None, order: ThinOrder::Area, minimum_area: None };
    let still = Action::Jitter(Jitter::default());
    let large = compare(Quantity::Area, Comparison::More, 3.0);
    for (operation, fault) in [
        (thin(2.0, ThinOrder::Area).into(), range("keep", "2", "0 to 1")),
        (Action::Scale { factor: 0.0.into() }.into(), range("factor", "0", "0.01 to 100")),
        (shadow(0.0, 1.0, 1.0, 201.0).into(), range("blur", "201", "0 to 200 px")),
        (nothing.into(), EditFault::NothingKept),
        (still.into(), EditFault::NothingChanged),
        (background(Action::Flatten), EditFault::NotForBackground),
        (
            Operation { conditions: vec![large], ..background(tint([0; 3], 0.5, 1.0)) },
            EditFault::BackgroundCondition,
        ),
        (Action::Density { map: "x.png".into() }.into(), EditFault::NoFile("x.png".into())),
        (those(&[within("x.svg", true)], Action::Delete), EditFault::NoFile("x.svg".into())),
    ] {
        let error = apply(scene(), &[operation], &Files::default(), None).unwrap_err();
        assert!(matches!(&error, Error::Edit { fault: found, .. } if *found == fault), "{error}");
    }
    let nan = validate(&Action::Rotate { angle: f64::NAN.into() }.into());
    assert!(matches!(nan, Err(EditFault::Range { .. })));
}

#[test]
fn files_are_read_by_name_and_their_errors_passed_on() {
    let read = |action: Action| Files::read(&[action.into()], [9, 9], file).unwrap_err();
    let missing = read(Action::Mask { shape: "nowhere.svg".into(), inside: true });
    assert!(matches!(missing, Error::Read { .. }));
    let wrong = read(Action::Replace { library: "two.txt".into() });
    assert!(matches!(wrong, Error::Format { .. }));
}

#[test]
fn chains_are_recorded_and_may_be_done_one_by_one() {
    let chain: [Operation; 4] = [
        thin(0.6, ThinOrder::Random).into(),
        Action::Jitter(Jitter { distance: 9.0, ..Jitter::default() }).into(),
        thin(0.5, ThinOrder::BlueNoise).into(),
        tint([255, 0, 0], 0.5, 0.5).into(),
    ];
    let (all, outcomes) = edited(&scene(), &chain);
    let records = chain.clone().map(Recorded::Edit);
    assert_eq!(all.edits.iter().map(|e| e.operation.clone()).collect::<Vec<_>>(), records);
    assert_eq!((outcomes[0].matched, outcomes[0].removed), (300, 120));
    let step = chain.iter().fold(scene(), |scene, done| edited(&scene, std::slice::from_ref(done)).0);
    assert_eq!(all.to_json(), step.to_json());
    assert_eq!(Scene::from_bytes(all.to_json(), "x").unwrap(), all);
    let other = apply(scene(), &chain[..1], &Files::default(), Some(6)).unwrap().0;
    assert_ne!(other.primary(), one(chain[0].clone()).primary());
    // A repeated operation draws different random numbers.
    assert_eq!(edited(&scene(), &[chain[0].clone(), chain[0].clone()]).0.primary().len(), 22);
}

#[test]
fn conditions_and_layers_select() {
    use Comparison::{AtLeast, AtMost, Less, More};
    let shift = || Action::Move { x: 1.0, y: 1.0 };
    let layer = |layer| edited(&scene(), &[on(layer, shift())]).1[0].matched;
    let matched = |conditions: &[Condition]| edited(&scene(), &[those(conditions, shift())]).1[0].matched;
    let category = |numbers: &[u32], wanted| matched(&[among(Identity::Category, numbers, wanted)]);
    let measured = |quantity, comparison, limit| matched(&[compare(quantity, comparison, limit)]);
    assert_eq!(matched(&[]), 300);
    assert_eq!([layer("primary"), layer("Secondary")], [60, 240]);
    assert_eq!([category(&[3], true), category(&[3, 7], true)], [40, 60]);
    assert_eq!(category(&[3], false), 260);
    assert_eq!([measured(Quantity::Area, More, 100.0), measured(Quantity::Area, AtMost, 7.0)], [60, 240]);
    assert_eq!(measured(Quantity::Elongation, AtLeast, 3.0), 60);
    let both = |id| matched(&[among(Identity::Id, &[id], true), among(Identity::Category, &[3], true)]);
    assert_eq!([both(7), both(70)], [1, 0]);
    let library = |number| matched(&[among(Identity::Library, &[number], true)]);
    assert_eq!([library(0), library(1)], [300, 0]);
    let mut with_motifs = scene();
    with_motifs.primary_mut()[3..6].iter_mut().for_each(|i| i.motif = Some(4));
    let motif = [those(&[among(Identity::Motif, &[4], true)], Action::Delete)];
    let (kept, reports) = edited(&with_motifs, &motif);
    assert_eq!((reports[0].matched, kept.instances().filter_map(|i| i.motif).count()), (3, 0));
    let (left, right) = (measured(Quantity::X, Less, 200.0), measured(Quantity::X, AtLeast, 200.0));
    assert!(left > 100 && right > 100 && left + right == 300);
    let inside = matched(&[within("left.png", true)]);
    assert!(inside.abs_diff(left) <= 6 && inside + matched(&[within("left.png", false)]) == 300);
    let disc = matched(&[within("disc.svg", true)]) as f64 / 300.0;
    assert!((disc - 0.26).abs() < 0.1, "{disc}");
}

#[test]
fn thinning_keeps_shares_and_the_large_ones() {
    for order in [ThinOrder::Area, ThinOrder::Random, ThinOrder::BlueNoise] {
        let few = one(thin(0.25, order));
        assert_eq!((few.primary().len(), few.secondary().len()), (15, 60), "{order:?}");
        let rest = one(on("secondary", thin(0.0, order)));
        assert_eq!((rest.primary().len(), rest.secondary().len(), rest.elements.len()), (60, 0, 2));
    }
    // The textons kept with a smaller random share are among those kept with a larger one.
    let ids =
        |share: f64| one(thin(share, ThinOrder::Random)).secondary().iter().map(|i| i.id).collect::<Vec<_>>();
    let (few, many) = (ids(0.2), ids(0.7));
    assert!(few.iter().all(|id| many.contains(id)));
    let large = one(Action::Thin { keep: None, order: ThinOrder::Area, minimum_area: Some(30.0) });
    assert_eq!((large.primary().len(), large.secondary().len()), (60, 0));
    assert!(large.elements.iter().all(|t| t.details().is_empty()), "details of 24 px are small too");
    assert_eq!(one(those(&[among(Identity::Category, &[7], true)], Action::Delete)).primary().len(), 40);
}

#[test]
fn maps_and_shapes_thin_by_place() {
    let mean_x =
        |s: &Scene| s.secondary().iter().map(|i| i.transform[4]).sum::<f64>() / s.secondary().len() as f64;
    let (faded, whole) = (one(Action::Density { map: "fade.png".into() }), scene());
    assert!(faded.secondary().len() > 80 && faded.secondary().len() < 160);
    assert!(mean_x(&faded) > mean_x(&whole) + 30.0);
    let kept = |inside| {
        let masked = one(Action::Mask { shape: "disc.svg".into(), inside });
        masked.primary().iter().map(|i| i.id).collect::<Vec<_>>()
    };
    let (inside, outside) = (kept(true), kept(false));
    assert!(!inside.is_empty() && inside.len() + outside.len() == 60);
    assert!(inside.iter().all(|id| !outside.contains(id)));
}

#[test]
fn orienting_turns_longer_axes_the_shorter_way() {
    let angles = |s: &Scene| -> Vec<f64> {
        let of = |i: &Instance| {
            SecondMoments::new(s.elements[i.element.index()].outline()).moved(i.affine()).angle()
        };
        s.primary().iter().map(|i| of(i).to_degrees().rem_euclid(180.0)).collect()
    };
    let off = |a: f64, b: f64| (a - b).rem_euclid(180.0).min((b - a).rem_euclid(180.0));
    let orient = |strength| one(Action::Orient { direction: Direction::Angle(30.0), strength });
    assert!(angles(&orient(1.0)).iter().all(|a| off(*a, 30.0) < 0.1));
    let half = orient(0.5);
    for (before, after) in angles(&scene()).iter().zip(angles(&half)) {
        assert!((off(after, 30.0) - off(*before, 30.0) / 2.0).abs() < 0.1);
    }
    let by_map = Action::Orient { direction: Direction::Map("fade.png".into()), strength: 1.0 };
    let field = one(on("primary", by_map));
    for (instance, angle) in field.primary().iter().zip(angles(&field)) {
        let x = instance.transform[4];
        if (20.0..380.0).contains(&x) {
            assert!(off(angle, x / 400.0 * 180.0) < 4.0, "{x}: {angle}");
        }
    }
}

#[test]
fn places_stay_on_a_canvas_that_repeats() {
    for action in [
        Action::Move { x: 350.0, y: -290.5 },
        Action::Jitter(Jitter { distance: 30.0, angle: 40.0, scale: 20.0, ..Jitter::default() }),
        Action::Scale { factor: 2.0.into() },
        Action::Rotate { angle: 77.0.into() },
    ] {
        let text = action.to_string();
        let after = one(action);
        assert_ne!(after.primary(), scene().primary(), "{text}");
        for (a, b) in after.primary().iter().zip(scene().primary()) {
            let [.., x, y] = a.transform;
            assert!((0.0..400.0).contains(&x) && (0.0..300.0).contains(&y), "{text}: {x} {y}");
            assert_eq!(a.id, b.id);
        }
    }
    let twice = one(Action::Scale { factor: 2.0.into() }).primary()[0].affine().determinant();
    assert!((twice - 4.0).abs() < 1e-3);
}

#[test]
fn colours_change_for_those_selected_and_no_others() {
    let red = one(those(&[among(Identity::Category, &[3], true)], tint([255, 0, 0], 1.0, 1.0)));
    for (instance, before) in red.primary().iter().zip(scene().primary()) {
        let element = red.element(instance);
        let tinted = before.element == ElementId(0);
        assert_eq!(element.base().colour == Colour([255, 0, 0]), tinted);
        assert_eq!(element.details()[0].colour == Colour([255, 0, 0]), tinted);
    }
    assert_eq!(red.secondary(), scene().secondary());
    // A texton is listed twice if only some of its instances are tinted.
    let some = one(on("primary", tint([255, 0, 0], 0.5, 0.5)));
    assert_eq!(some.elements.len(), 5);
    let background = one(on("background", tint([0; 3], 0.5, 1.0)));
    assert!(
        background.field().points.iter().all(|p| p.colour.0[0] < 90) && background.field().fallback.0[0] < 90
    );
    assert_eq!(background.elements, scene().elements);
}

#[test]
fn recolouring_keeps_shading_and_leaves_what_is_unlike() {
    let blue = one(recolor([180, 60, 50], [60, 80, 180], 0.15));
    let [red, other] = [&blue.elements[0], &blue.elements[1]];
    assert_eq!(red.base().colour, Colour::from_hex("#3c50b4").unwrap());
    assert_eq!(red.details()[0].colour, Colour([240; 3]), "the light detail is unlike");
    assert_eq!(other.base().colour, Colour([40, 60, 150]));
    // Elements without a similar colour neither count nor change.
    let (same, outcomes) = edited(&scene(), &[recolor([0, 255, 0], [0; 3], 0.1).into()]);
    assert_eq!((outcomes[0].matched, same.elements), (0, scene().elements));
    let red = edited(&scene(), &[recolor([180, 60, 50], [0; 3], 0.05).into()]).1[0].matched;
    assert_eq!(red, 40);
}

#[test]
fn details_in_another_colour_can_stay() {
    let mut flower = scene();
    let shapes = &mut flower.elements[0].shapes;
    shapes[0].colour = Colour([225, 225, 215]);
    let [mut shade, mut heart] = [shapes[1].clone(), shapes[1].clone()];
    (shade.colour, heart.colour) = (Colour([170, 170, 160]), Colour([200, 160, 20]));
    shapes.truncate(1);
    shapes.extend([shade, heart]);
    let recolour = |keep| {
        let (from, to) = (Colour([225, 225, 215]), Colour([220, 90, 140]));
        let colours = edited(&flower, &[Action::Recolor { from, to, reach: 2.0, keep }.into()]).0;
        [0, 1, 2].map(|k| colours.elements[0].shapes[k].colour)
    };
    let [base, shade, heart] = recolour(Keep::Details);
    assert_eq!((base, heart), (Colour([220, 90, 140]), Colour([200, 160, 20])));
    assert!(shade.0[0] > shade.0[1] + 40, "{shade:?}");
    assert_ne!(recolour(Keep::Nothing)[2], heart);
}

#[test]
fn a_palette_changes_backgrounds_too_unless_a_layer_is_named() {
    let after = one(two_colours());
    assert_ne!(after.field().points, scene().field().points);
    assert_eq!(one(on("primary", two_colours())).field().points, scene().field().points);
}

#[test]
fn categories_are_selected_by_names_that_the_scene_has() {
    let mut named = scene();
    let others = (2..12).map(|k| format!("stone {k}"));
    let names: Vec<String> = ["moss".to_owned(), "wet stone".to_owned()].into_iter().chain(others).collect();
    named.libraries[0].categories.clone_from(&names);
    let by = |categories: &[&str], wanted| Condition::Named {
        categories: categories.iter().map(|name| (*name).to_owned()).collect(),
        wanted,
    };
    let left = |condition| edited(&named, &[those(&[condition], Action::Delete)]).0.layers;
    assert_eq!(left(by(&["Wet Stone"], true)), left(among(Identity::Category, &[1], true)));
    assert_eq!(left(by(&["moss", "2"], false)), left(among(Identity::Category, &[0, 1], false)));
    let unknown = those(&[by(&["sky"], true)], Action::Delete);
    let error = apply(named.clone(), &[unknown], &Files::default(), None).unwrap_err();
    let fault = EditFault::NoCategory { name: "sky".into(), known: names };
    assert!(matches!(error, Error::Edit { fault: found, .. } if found == fault));
}

#[test]
fn a_background_without_points_has_a_colour_too() {
    let mut bare = scene();
    bare.field_mut().points.clear();
    let (after, outcomes) = edited(&bare, &[on("background", tint([0; 3], 1.0, 1.0))]);
    assert_eq!((outcomes[0].matched, after.field().fallback), (1, Colour([0; 3])));
}

#[test]
fn palettes_give_dark_colours_the_dark_colour_and_equal_ones_the_same() {
    let after = one(on("primary", two_colours()));
    let lightness = |shape: &Shape| shape.colour.to_oklab()[0];
    let details: Vec<&Shape> = after.elements[..2].iter().map(|element| &element.details()[0]).collect();
    assert!(details.iter().all(|detail| lightness(detail) > 0.75) && details[0].colour == details[1].colour);
    assert!(lightness(after.elements[1].base()) < 0.5, "{:?}", after.elements[1].base().colour);
    assert_eq!(after.secondary()[0].colour, scene().secondary()[0].colour);
    assert_ne!(one(two_colours()).secondary()[0].colour, scene().secondary()[0].colour);
}

#[test]
fn without_categories_a_palette_follows_lightness() {
    let after = edited(&scene(), &[on("primary", Action::Delete), two_colours().into()]).0;
    let lightness = |i: &Instance| i.colour.unwrap().to_oklab()[0];
    let (mut before, mut now): (Vec<f32>, Vec<f32>) = (
        scene().secondary().iter().map(lightness).collect(),
        after.secondary().iter().map(lightness).collect(),
    );
    [&mut before, &mut now].into_iter().for_each(|v| v.sort_by(f32::total_cmp));
    let range = |v: &[f32]| v[v.len() - 1] - v[0];
    // Both colours of the palette occur.
    assert!(range(&now) > 2.0 * range(&before), "{} {}", range(&now), range(&before));
}

#[test]
fn shadows_and_lines_have_the_size_asked_for_on_the_canvas() {
    let line = |width| Action::Outline { width, colour: Colour([16, 32, 48]) };
    let twice = Action::Scale { factor: 2.0.into() };
    let styled = edited(&scene(), &[twice.into(), shadow(90.0, 8.0, 0.4, 6.0).into(), line(3.0).into()]).0;
    let all = || styled.primary().iter().chain(styled.secondary());
    assert!(all().all(|i| i.shadow.unwrap().offset == [0.0, 8.0]));
    assert!(all().all(|i| i.shadow.unwrap().blur == 3.0 && i.stroke.unwrap().width == 1.5));
    let none = edited(&styled, &[on("primary", shadow(45.0, 5.0, 0.0, 5.0)), line(0.0).into()]).0;
    assert!(none.primary().iter().all(|i| i.shadow.is_none()) && none.secondary()[0].shadow.is_some());
    assert!(none.primary().iter().chain(none.secondary()).all(|i| i.stroke.is_none()));
}

#[test]
fn soft_ellipses_have_neither_shadow_nor_line() {
    let mut scene = scene();
    let spot = scene.secondary()[0].element;
    let around = scene.elements[spot.index()].outline().clone();
    let soft = Shape::soft_along(&around, Colour([9; 3]), Profile::Soft).unwrap();
    scene.elements[spot.index()] = scene.elements[spot.index()].with_shapes(vec![soft]);
    let line = Action::Outline { width: 2.0, colour: Colour([16, 32, 48]) };
    let styled = edited(&scene, &[shadow(90.0, 8.0, 0.4, 6.0).into(), line.into()]).0;
    let (spots, others): (Vec<_>, Vec<_>) =
        styled.primary().iter().chain(styled.secondary()).partition(|i| i.element == spot);
    assert!(!spots.is_empty() && spots.iter().all(|i| i.shadow.is_none() && i.stroke.is_none()));
    assert!(!others.is_empty() && others.iter().all(|i| i.shadow.is_some() && i.stroke.is_some()));
}

#[test]
fn flat_and_simple_textons_are_less() {
    let flat = one(on("primary", Action::Flatten));
    assert!(flat.elements.iter().all(|t| t.details().is_empty()));
    let (before, after) = (colours::mean(&scene().elements[0]), flat.elements[0].base().colour);
    assert_eq!(before, after);
    let simple = one(Action::Simplify { tolerance: 6.0 });
    assert!(simple.elements.iter().all(|t| t.details().is_empty()));
    let few = |s: &Scene| s.elements.iter().map(|t| t.outline().to_string().len()).sum::<usize>();
    assert!(few(&simple) <= few(&scene()));
}

#[test]
fn ink_drawings_keep_ids_and_places_and_leave_light_spots_out() {
    let hatch = |spacing| Action::Hatch {
        spacing,
        angle: -45.0,
        width: 0.7,
        colour: Colour([0; 3]),
        paper: Colour([255; 3]),
    };
    let drawn = one(on("primary", hatch(1.0)));
    let ids = |scene: &Scene| scene.primary().iter().map(|i| (i.id, i.transform)).collect::<Vec<_>>();
    assert_eq!(ids(&drawn), ids(&scene()));
    assert_eq!(drawn.secondary(), scene().secondary());
    let is_ink = |c: Colour| c == Colour([0; 3]) || c == Colour([255; 3]);
    for instance in drawn.primary() {
        let element = &drawn.elements[instance.element.index()];
        assert!(instance.colour.is_none() && element.shapes.len() >= 2);
        assert!(element.shapes.iter().all(|shape| is_ink(shape.colour)), "{element:?}");
    }
    // Of two kinds of spots the dark ones become dots.
    let mut spots = scene();
    let second = spots.secondary()[0].element;
    for (i, element) in spots.elements.iter_mut().enumerate().filter(|(_, e)| e.category.is_none()) {
        let around = Outline::along(&element.outline().polygons(0.1), 0.1).unwrap();
        let tone = if i == second.index() { 10 } else { 240 };
        let soft = Shape::soft_along(&around, Colour([tone; 3]), Profile::Soft).unwrap();
        *element = element.with_shapes(vec![soft]);
    }
    spots.instances_mut().for_each(|instance| instance.colour = None);
    let dots = edited(&spots, &[on("secondary", hatch(4.0))]).0;
    let dark = spots.secondary().iter().filter(|i| i.element == second).count();
    assert_eq!(dots.secondary().len(), dark);
    assert!(dots.secondary().iter().all(|i| !dots.elements[i.element.index()].base().is_soft()));
    for wrong in [0.4, f64::NAN, 1e9] {
        assert!(apply(scene(), &[hatch(wrong).into()], &Files::default(), None).is_err(), "{wrong}");
    }
}

#[test]
fn too_far_is_an_error_and_nothing_to_do_is_none() {
    let far: Vec<Operation> = vec![Action::Move { x: 1e6, y: 0.0 }.into(); 12];
    let plain = Scene { tile: Tile::default(), ..scene() };
    let error = apply(plain.clone(), &far, &Files::default(), None).unwrap_err().to_string();
    assert!(error.contains("it leads too far"), "{error}");
    let (same, outcomes) =
        edited(&plain, &[those(&[among(Identity::Category, &[99], true)], Action::Delete)]);
    assert_eq!((outcomes[0].matched, outcomes[0].removed), (0, 0));
    assert_eq!(same.primary(), plain.primary());
    let mut empty = plain;
    empty.layers.iter_mut().for_each(|layer| layer.instances.clear());
    empty.elements.clear();
    for operation in [
        thin(0.5, ThinOrder::BlueNoise).into(),
        two_colours().into(),
        Action::Orient { direction: Direction::Angle(3.0), strength: 1.0 }.into(),
        on("background", tint([255; 3], 0.5, 1.0)),
        Action::Simplify { tolerance: 1.0 }.into(),
    ] {
        assert_eq!(edited(&empty, &[operation]).0.primary().len(), 0);
    }
}

/// A library of an exemplar with discs, ovals and bars.
fn library() -> Library {
    use vtex_analyze::{AnalyzeParams, Exemplar, Limits, analyze};
    let inside = |x: u32, y: u32| {
        let (cx, cy) = (f64::from(x % 32) - 16.0, f64::from(y % 32) - 16.0);
        let squash = f64::from((x / 32) % 3 + 1);
        let (u, v) = (cx, cy * squash);
        u * u + v * v < 150.0
    };
    let image = image::RgbImage::from_fn(192, 160, |x, y| {
        image::Rgb(if inside(x, y) { [210, 190, 90] } else { [60, 70, 60] })
    });
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    let exemplar = Exemplar::from_bytes(bytes.get_ref(), "ovals.png", &Limits::default()).unwrap();
    analyze(&exemplar, &vtex_segment::segment::Regions, &AnalyzeParams::default(), &()).unwrap()
}

#[test]
fn replaced_textons_take_place_size_and_direction_of_those_they_replace() {
    let library = library();
    assert!(library.primaries().iter().filter(|p| !p.clipped).count() > 12);
    let replace = on("primary", Action::Replace { library: "ovals".into() });
    let files = |library| Files { libraries: [("ovals".into(), library)].into(), ..Files::default() };
    let line_around = on("primary", Action::Outline { width: 2.0, colour: Colour([0; 3]) });
    let after = apply(scene(), &[line_around, replace.clone()], &files(library.clone()), None).unwrap().0;
    assert_eq!((after.libraries.len(), after.secondary().len()), (2, 240));
    // Widths of lines do not depend on the size of the new textons in their library.
    for instance in after.primary() {
        let width = instance.stroke.unwrap().width * libm::sqrt(instance.affine().determinant());
        assert!((width - 2.0).abs() < 0.05, "{width}");
        let [.., x, y] = instance.transform;
        assert!((0.0..400.0).contains(&x) && (0.0..300.0).contains(&y), "{x} {y}");
    }
    // A library without primaries replaces none.
    let bare = library.without_primaries();
    let (same, outcomes) = apply(scene(), &[replace], &files(bare), None).unwrap();
    assert_eq!((outcomes[0].matched, same.primary()), (0, scene().primary()));
    for (new, old) in after.primary().iter().zip(scene().primary()) {
        let of = |s: &Scene, i: &Instance| {
            SecondMoments::new(s.elements[i.element.index()].outline()).moved(i.affine())
        };
        let (new, old) = (of(&after, new), of(&scene(), old));
        assert!((new.area / old.area - 1.0).abs() < 0.01);
        let way = shortest_offset(old.centroid, new.centroid, after.periods());
        assert!(way.hypot2() < 0.01, "{way:?}");
        let turn = (new.angle() - old.angle()).rem_euclid(std::f64::consts::PI);
        assert!(turn.min(std::f64::consts::PI - turn) < 0.02);
        // Bars become the most elongated of the ovals, whose axes are as three to one.
        assert!(new.elongation() > 2.4, "{}", new.elongation());
    }
    let used = after.elements.iter().filter(|t| t.library.0 == 1);
    assert!(used.count() >= 1);
}
