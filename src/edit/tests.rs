//! What every operation holds to.

use super::*;
use crate::geometry::{Affine, Outline, SecondMoments, parse_path, shortest_offset};
use crate::library::Library;
use crate::raster::colour::Colour;
use crate::scene::{ControlPoint, Field, Instance, LibraryRef, Patch, Texton, Tile};

fn outline(text: &str) -> Outline {
    Outline::new(&parse_path(text).unwrap()).unwrap()
}

/// Bars of two categories with a detail each, and specks, on a canvas of 400 × 300 that repeats.
fn scene() -> Scene {
    let bar = |source, category, colour| Texton {
        library: 0,
        source,
        category: Some(category),
        fragment: false,
        outline: outline("M-10-3h20v6h-20z"),
        colour,
        gradient: None,
        details: vec![Patch { outline: outline("M-2-2h6v4h-6z"), colour: Colour([240; 3]), gradient: None }],
    };
    let speck = Texton {
        category: None,
        outline: outline("M-1-1h3v2h-3z"),
        details: Vec::new(),
        ..bar(2, 0, Colour([90; 3]))
    };
    let mut random = stream(3, "test/scene", 0);
    let mut place = |id: u32, texton: u32| {
        let at = [random.range(0.0, 400.0), random.range(0.0, 300.0)].map(libm::round);
        let affine = Affine::translate((at[0], at[1])) * Affine::rotate(random.range(0.0, 6.0));
        Instance { transform: affine.as_coeffs(), ..Instance::new(id, texton) }
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
    Scene {
        format: Scene::FORMAT.into(),
        version: Scene::VERSION,
        width: 400,
        height: 300,
        tile: Tile { x: true, y: true },
        parameters: None,
        program: crate::PROGRAM.into(),
        libraries: vec![LibraryRef { exemplar: "bars".into(), sha256: "0".into() }],
        textons: vec![bar(0, 3, Colour([180, 60, 50])), bar(1, 7, Colour([40, 60, 150])), speck],
        secondary,
        primary,
        background: Field {
            spacing: 25.0,
            fallback: Colour([120, 100, 80]),
            points: (0..192).map(point).collect(),
        },
        domain: None,
        edits: Vec::new(),
    }
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
        "two.txt" => b"#ffe0a0 #203040".to_vec(),
        _ => return Err(Error::read(name.as_ref(), std::io::ErrorKind::NotFound.into())),
    })
}

fn operation(text: &str) -> Operation {
    Request::parse(text).unwrap().load([400, 300], file).unwrap()
}

fn edited(scene: &Scene, operations: &[&str]) -> (Scene, Vec<Outcome>) {
    let operations: Vec<Operation> = operations.iter().map(|t| operation(t)).collect();
    apply(scene.clone(), &operations, Some(5)).unwrap()
}

fn one(text: &str) -> Scene {
    edited(&scene(), &[text]).0
}

fn fault(text: &str) -> [String; 2] {
    let error = Request::parse(text).unwrap_err();
    assert!(matches!(error, Error::Edit { .. }));
    [error.to_string(), error.hint().unwrap_or_default()]
}

#[test]
fn every_example_of_the_catalogue_can_be_parsed() {
    for entry in catalogue() {
        assert!(entry.example.starts_with(entry.name));
        Request::parse(entry.example).unwrap();
        for parameter in entry.parameters.iter().chain(common_parameters()) {
            assert!(!parameter.does.is_empty() && !parameter.range().is_empty());
        }
    }
}

#[test]
fn faults_are_told_with_what_would_be_right() {
    for (text, message, hint) in [
        ("", "it is empty", "thin, density"),
        ("tnit #fff", "there is no operation 'tnit'", "did you mean 'tint'? the operations are thin,"),
        ("tint", "COLOUR is missing (#rrggbb)", "tint COLOUR [--amount NUMBER]"),
        ("tint red", "COLOUR = red is no colour", "#rrggbb"),
        ("tint #fff --amout 1", "'tint' has no flag '--amout'", "did you mean '--amount'?"),
        ("tint #fff --amount", "--amount needs a value", "0 to 1"),
        ("tint #fff --amount 1.5", "--amount = 1.5 is out of range: 0 to 1, default: 0.5", "0 to 1"),
        ("tint #fff --amount NaN", "out of range", "0 to 1"),
        ("tint #fff #000", "'#000' is one word too many", "tint COLOUR"),
        ("thin", "nothing says how much to keep", "such as: thin 0.5"),
        ("thin 2", "KEEP = 2 is out of range: 0 to 1", "0 to 1"),
        ("thin 0.5 --order bluenoise", "is none of blue-noise, random, area", "did you mean 'blue-noise'?"),
        ("thin 0.5 --layer secondry", "--layer = secondry", "did you mean 'secondary'?"),
        ("thin 0.5 --layer background", "cannot be done to the background", "tint, recolor, palette"),
        ("jitter --move 0", "nothing says what to change", "jitter --move 4"),
        ("delete --where colour=3", "'colour' is nothing that textons have", "did you mean"),
        ("delete --where area=3", "'area' is not compared by '='", "area>200"),
        ("delete --where area>x", "'x' is no number", "area>200"),
        ("delete --where category=1.5", "is no whole number", "category=3"),
        ("delete --where inside=", "names no file", "inside=FILE"),
        ("delete --where category", "is no condition", "category=3"),
        ("tint #fff --amount 0.2 --amount=0.3", "--amount is given twice", "once"),
        ("thin --min-area 9 --order area", "--order says which go first", "such as: thin 0.5"),
        ("tint #fff --layer background --where x<9,area>3", "has no categories", "told apart by x"),
        ("delete --where 'area>3", "a quote ' is not closed", "close it"),
    ] {
        let [found, advice] = fault(text);
        assert!(found.contains(message), "{text}: {found}");
        assert!(advice.contains(hint), "{text}: {advice}");
    }
}

#[test]
fn files_are_read_by_name_and_their_errors_passed_on() {
    let missing = Request::parse("mask nowhere.svg").unwrap().load([9, 9], file).unwrap_err();
    assert!(matches!(missing, Error::Read { .. }));
    let wrong = Request::parse("replace two.txt").unwrap().load([9, 9], file).unwrap_err();
    assert!(matches!(wrong, Error::Format { .. }));
}

#[test]
fn chains_are_recorded_and_may_be_done_one_by_one() {
    let chain = ["thin 0.6 --order random", "jitter --move 9", "thin 0.5", "tint #f00 --share 0.5"];
    let (all, outcomes) = edited(&scene(), &chain);
    assert_eq!(all.edits.iter().map(|e| e.operation.as_str()).collect::<Vec<_>>(), chain);
    assert_eq!((outcomes[0].matched, outcomes[0].removed), (300, 120));
    let step = chain.iter().fold(scene(), |scene, text| edited(&scene, &[text]).0);
    assert_eq!(all.to_json(), step.to_json());
    assert_eq!(Scene::from_bytes(&all.to_json(), "x").unwrap(), all);
    let other = apply(scene(), &[operation(chain[0])], Some(6)).unwrap().0;
    assert_ne!(other.primary, one(chain[0]).primary);
    // The same operation again draws anew.
    assert_eq!(edited(&scene(), &[chain[0], chain[0]]).0.primary.len(), 22);
}

#[test]
fn conditions_and_layers_select() {
    let matched = |text: &str| edited(&scene(), &[&format!("move 1 1 {text}")]).1[0].matched;
    assert_eq!(matched(""), 300);
    assert_eq!([matched("--layer primary"), matched("--layer secondary")], [60, 240]);
    assert_eq!([matched("--where category=3"), matched("--where 'category=3|7'")], [40, 60]);
    assert_eq!(matched("--where category!=3"), 260);
    assert_eq!([matched("--where area>100"), matched("--where area<=7")], [60, 240]);
    assert_eq!(matched("--where elongation>=3"), 60);
    assert_eq!([matched("--where 'id=7, category=3'"), matched("--where id=70,category=3")], [1, 0]);
    assert_eq!(matched("--where library=0") - matched("--where library=1"), 300);
    let (left, right) = (matched("--where x<200"), matched("--where x>=200"));
    assert!(left > 100 && right > 100 && left + right == 300);
    let inside = matched("--where inside=left.png");
    assert!(inside.abs_diff(left) <= 6 && inside + matched("--where outside=left.png") == 300);
    let disc = matched("--where inside=disc.svg") as f64 / 300.0;
    assert!((disc - 0.26).abs() < 0.1, "{disc}");
}

#[test]
fn thinning_keeps_shares_and_the_large_ones() {
    for order in ["area", "random", "blue-noise"] {
        let thin = one(&format!("thin 0.25 --order {order}"));
        assert_eq!((thin.primary.len(), thin.secondary.len()), (15, 60), "{order}");
        let rest = one(&format!("thin 0 --order {order} --layer secondary"));
        assert_eq!((rest.primary.len(), rest.secondary.len(), rest.textons.len()), (60, 0, 2));
    }
    // Those kept at random with a smaller share are among those kept with a larger.
    let ids = |share: &str| {
        one(&format!("thin {share} --order random")).secondary.iter().map(|i| i.id).collect::<Vec<_>>()
    };
    let (few, many) = (ids("0.2"), ids("0.7"));
    assert!(few.iter().all(|id| many.contains(id)));
    let large = one("thin --min-area 30");
    assert_eq!((large.primary.len(), large.secondary.len()), (60, 0));
    assert!(large.textons.iter().all(|t| t.details.is_empty()), "details of 24 px are small too");
    assert_eq!(one("delete --where category=7").primary.len(), 40);
}

#[test]
fn maps_and_shapes_thin_by_place() {
    let mean_x =
        |s: &Scene| s.secondary.iter().map(|i| i.transform[4]).sum::<f64>() / s.secondary.len() as f64;
    let (faded, whole) = (one("density fade.png"), scene());
    assert!(faded.secondary.len() > 80 && faded.secondary.len() < 160);
    assert!(mean_x(&faded) > mean_x(&whole) + 30.0);
    let kept = |text: &str| one(text).primary.iter().map(|i| i.id).collect::<Vec<_>>();
    let (inside, outside) = (kept("mask disc.svg"), kept("mask disc.svg --keep outside"));
    assert!(!inside.is_empty() && inside.len() + outside.len() == 60);
    assert!(inside.iter().all(|id| !outside.contains(id)));
}

#[test]
fn orienting_turns_longer_axes_the_shorter_way() {
    let angles = |s: &Scene| -> Vec<f64> {
        let of = |i: &Instance| {
            SecondMoments::new(&s.textons[i.texton as usize].outline).moved(i.affine()).angle()
        };
        s.primary.iter().map(|i| of(i).to_degrees().rem_euclid(180.0)).collect()
    };
    let off = |a: f64, b: f64| (a - b).rem_euclid(180.0).min((b - a).rem_euclid(180.0));
    assert!(angles(&one("orient 30")).iter().all(|a| off(*a, 30.0) < 0.1));
    let half = one("orient 30 --strength 0.5");
    for (before, after) in angles(&scene()).iter().zip(angles(&half)) {
        assert!((off(after, 30.0) - off(*before, 30.0) / 2.0).abs() < 0.1);
    }
    let field = one("orient fade.png --layer primary");
    for (instance, angle) in field.primary.iter().zip(angles(&field)) {
        let x = instance.transform[4];
        if (20.0..380.0).contains(&x) {
            assert!(off(angle, x / 400.0 * 180.0) < 4.0, "{x}: {angle}");
        }
    }
}

#[test]
fn places_stay_on_a_canvas_that_repeats() {
    for text in ["move 350 -290.5", "jitter --move 30 --rotate 40 --scale 20", "scale 2", "rotate 77"] {
        let after = one(text);
        assert_ne!(after.primary, scene().primary, "{text}");
        for (a, b) in after.primary.iter().zip(&scene().primary) {
            let [.., x, y] = a.transform;
            assert!((0.0..400.0).contains(&x) && (0.0..300.0).contains(&y), "{text}: {x} {y}");
            assert_eq!(a.id, b.id);
        }
    }
    let twice = one("scale 2").primary[0].affine().determinant();
    assert!((twice - 4.0).abs() < 1e-3);
}

#[test]
fn colours_change_for_those_selected_and_no_others() {
    let red = one("tint #ff0000 --amount 1 --where category=3");
    for (instance, before) in red.primary.iter().zip(&scene().primary) {
        let texton = &red.textons[instance.texton as usize];
        let tinted = before.texton == 0;
        assert_eq!(texton.colour == Colour([255, 0, 0]), tinted);
        assert_eq!(texton.details[0].colour == Colour([255, 0, 0]), tinted);
    }
    assert_eq!(red.secondary, scene().secondary);
    // A texton of which some are tinted is there twice.
    let some = one("tint #ff0000 --share 0.5 --layer primary");
    assert_eq!(some.textons.len(), 5);
    let ground = one("tint #000 --amount 0.5 --layer background");
    assert!(
        ground.background.points.iter().all(|p| p.colour.0[0] < 90) && ground.background.fallback.0[0] < 90
    );
    assert_eq!(ground.textons, scene().textons);
}

#[test]
fn recolouring_keeps_shading_and_leaves_what_is_unlike() {
    let blue = one("recolor --from #b43c32 --to #3c50b4 --reach 0.15");
    let [red, other] = [&blue.textons[0], &blue.textons[1]];
    assert_eq!(red.colour, Colour::from_hex("#3c50b4").unwrap());
    assert_eq!(red.details[0].colour, Colour([240; 3]), "the light detail is unlike");
    assert_eq!(other.colour, Colour([40, 60, 150]));
    // What has no such colour does not count, and nothing happens to it.
    let (same, outcomes) = edited(&scene(), &["recolor --from #00ff00 --to #000000 --reach 0.1"]);
    assert_eq!((outcomes[0].matched, same.textons), (0, scene().textons));
    let red = edited(&scene(), &["recolor --from #b43c32 --to #000000 --reach 0.05"]).1[0].matched;
    assert_eq!(red, 40);
}

#[test]
fn a_background_without_points_has_a_colour_too() {
    let bare = Scene { background: Field { points: Vec::new(), ..scene().background }, ..scene() };
    let (after, outcomes) = edited(&bare, &["tint #000000 --amount 1 --layer background"]);
    assert_eq!((outcomes[0].matched, after.background.fallback), (1, Colour([0; 3])));
}

#[test]
fn palettes_give_the_dark_category_the_dark_colour() {
    let after = one("palette two.txt");
    let mean = |s: &Scene, i: usize| colours::mean(&s.textons[i]).to_oklab();
    let near = |lab: [f32; 3], hex: &str| {
        let wanted = Colour::from_hex(hex).unwrap().to_oklab();
        (0..3).all(|i| (lab[i] - wanted[i]).abs() < 0.03)
    };
    let dark = usize::from(mean(&scene(), 1)[0] < mean(&scene(), 0)[0]);
    assert!(near(mean(&after, dark), "#203040"), "{:?}", mean(&after, dark));
    // The light colour and the shading above it do not both fit in the gamut.
    assert!(mean(&after, 1 - dark)[0] > mean(&scene(), 1 - dark)[0] + 0.2);
    assert!(after.textons[dark].details[0].colour.0[0] > after.textons[dark].colour.0[0] + 40);
    assert_ne!(after.secondary[0].colour, scene().secondary[0].colour);
}

#[test]
fn without_categories_a_palette_follows_lightness() {
    let after = edited(&scene(), &["delete --layer primary", "palette two.txt"]).0;
    let lightness = |i: &Instance| i.colour.unwrap().to_oklab()[0];
    let (mut before, mut now): (Vec<f32>, Vec<f32>) =
        (scene().secondary.iter().map(lightness).collect(), after.secondary.iter().map(lightness).collect());
    [&mut before, &mut now].into_iter().for_each(|v| v.sort_by(f32::total_cmp));
    let range = |v: &[f32]| v[v.len() - 1] - v[0];
    // Both colours of the palette are there, not one in place of all.
    assert!(range(&now) > 2.0 * range(&before), "{} {}", range(&now), range(&before));
}

#[test]
fn shadows_and_lines_have_the_size_asked_for_on_the_canvas() {
    let dressed =
        edited(&scene(), &["scale 2", "shadow --angle 90 --length 8 --blur 6", "outline 3 #102030"]).0;
    let all = || dressed.primary.iter().chain(&dressed.secondary);
    assert!(all().all(|i| i.shadow.unwrap().offset == [0.0, 8.0]));
    assert!(all().all(|i| i.shadow.unwrap().blur == 3.0 && i.stroke.unwrap().width == 1.5));
    let none = edited(&dressed, &["shadow --opacity 0 --layer primary", "outline 0 #fff"]).0;
    assert!(none.primary.iter().all(|i| i.shadow.is_none()) && none.secondary[0].shadow.is_some());
    assert!(none.primary.iter().chain(&none.secondary).all(|i| i.stroke.is_none()));
}

#[test]
fn flat_and_simple_textons_are_less() {
    let flat = one("flatten --layer primary");
    assert!(flat.textons.iter().all(|t| t.details.is_empty()));
    let (before, after) = (colours::mean(&scene().textons[0]), flat.textons[0].colour);
    assert_eq!(before, after);
    let simple = one("simplify 6");
    assert!(simple.textons.iter().all(|t| t.details.is_empty()));
    let few = |s: &Scene| s.textons.iter().map(|t| t.outline.to_string().len()).sum::<usize>();
    assert!(few(&simple) <= few(&scene()));
}

#[test]
fn too_far_is_an_error_and_nothing_to_do_is_none() {
    let far: Vec<Operation> = vec![operation("move 1e6 0"); 12];
    let plain = Scene { tile: Tile::default(), ..scene() };
    let error = apply(plain.clone(), &far, None).unwrap_err().to_string();
    assert!(error.contains("it leads too far"), "{error}");
    let (same, outcomes) = edited(&plain, &["delete --where category=99"]);
    assert_eq!((outcomes[0].matched, outcomes[0].removed), (0, 0));
    assert_eq!(same.primary, plain.primary);
    let empty = Scene { primary: Vec::new(), secondary: Vec::new(), textons: Vec::new(), ..plain };
    for text in ["thin 0.5", "palette two.txt", "orient 3", "tint #fff --layer background", "simplify 1"] {
        assert_eq!(edited(&empty, &[text]).0.primary.len(), 0, "{text}");
    }
}

/// A library of an exemplar with discs, ovals and bars.
fn library() -> Library {
    use crate::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
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
    analyze(&exemplar, &crate::segment::Regions, &AnalyzeParams::default(), &()).unwrap()
}

#[test]
fn replaced_textons_take_place_size_and_direction_of_those_they_replace() {
    let library = library();
    assert!(library.primaries.iter().filter(|p| !p.clipped).count() > 12);
    let replace = Operation {
        text: "replace ovals.lib.json".into(),
        layers: Layers::Primary,
        conditions: Vec::new(),
        action: Action::Replace { library: Box::new(library) },
    };
    let dress = operation("outline 2 #000 --layer primary");
    let after = apply(scene(), &[dress, replace.clone()], None).unwrap().0;
    assert_eq!((after.libraries.len(), after.secondary.len()), (2, 240));
    // Lines stay as wide as they were, whatever the size that the new textons have in their library.
    for instance in &after.primary {
        let width = instance.stroke.unwrap().width * libm::sqrt(instance.affine().determinant());
        assert!((width - 2.0).abs() < 0.05, "{width}");
        let [.., x, y] = instance.transform;
        assert!((0.0..400.0).contains(&x) && (0.0..300.0).contains(&y), "{x} {y}");
    }
    // A library without primaries has none to give.
    let Action::Replace { library } = &replace.action else { unreachable!() };
    let bare = Library { primaries: Vec::new(), ..*library.clone() };
    let replace = Operation { action: Action::Replace { library: Box::new(bare) }, ..replace };
    let (same, outcomes) = apply(scene(), &[replace], None).unwrap();
    assert_eq!((outcomes[0].matched, same.primary), (0, scene().primary));
    for (new, old) in after.primary.iter().zip(&scene().primary) {
        let of = |s: &Scene, i: &Instance| {
            SecondMoments::new(&s.textons[i.texton as usize].outline).moved(i.affine())
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
    let used = after.textons.iter().filter(|t| t.library == 1);
    assert!(used.count() >= 1);
}

proptest::proptest! {
    #[test]
    fn any_text_is_an_operation_or_a_fault(text in "\\PC*|(tint|thin|move|jitter) [a-z0-9#.=<>|,' -]{0,60}") {
        if let Ok(request) = Request::parse(&text) {
            // What was understood once is understood again, and loading it ends.
            proptest::prop_assert_eq!(Request::parse(text.trim()).unwrap(), request.clone());
            let _ = request.load([400, 300], file);
        }
    }
}
