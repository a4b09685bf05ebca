//! Operations that treat elements as Gaussians with an appearance.

use super::tests::{among, compare, edited, on, one, outline, scene, those};
use super::*;
use vtex_base::geometry::{NearPoints, Point, shortest_offset};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::Gaussian;
use vtex_scene::scene::{ElementId, Instance, Scene, testing};

fn vary(colour: Option<f64>, shape: Option<f64>) -> Action {
    Action::Vary { colour: colour.map(Into::into), shape: shape.map(Into::into), within: Within::Layer }
}

fn shuffle(outlines: bool) -> Action {
    Action::Shuffle { within: Within::Layer, share: 1.0, outlines }
}

fn jitter(jitter: Jitter) -> Action {
    Action::Jitter(jitter)
}

fn gaussians(scene: &Scene) -> Vec<Gaussian> {
    scene.gaussians().into_iter().map(Option::unwrap).collect()
}

/// Variance of the median colours of a layer of secondaries, summed over L, a and b.
fn variance(scene: &Scene) -> f64 {
    let count = scene.secondary().len();
    let all: Vec<[f64; 3]> = scene.appearances()[..count].iter().map(|a| a.median.map(f64::from)).collect();
    let spread = |k: usize| {
        let mean = all.iter().map(|c| c[k]).sum::<f64>() / count as f64;
        all.iter().map(|c| (c[k] - mean) * (c[k] - mean)).sum::<f64>() / count as f64
    };
    (0..3).map(spread).sum()
}

/// A scene whose colours leave room on all sides.
fn muted() -> Scene {
    let mut scene = scene();
    for instance in scene.secondary_mut() {
        let v = (instance.id.0 % 60) as u8;
        instance.colour = Some(Colour([100 + v, 110, 170 - v]));
    }
    scene
}

#[test]
fn what_changes_nothing_gives_the_same_bytes() {
    let still = Action::Transform { by: [0.0; 2], scale: [1.0; 2], angle: 0.0, about: About::Selection };
    for action in [vary(Some(1.0), None), vary(None, Some(1.0)), still] {
        let (after, outcomes) = edited(&scene(), &[action.into()]);
        assert_eq!(after.to_json(), scene().to_json());
        assert_eq!(outcomes[0].matched, 300);
    }
}

#[test]
fn variances_of_colours_grow_with_the_square() {
    let before = variance(&muted());
    for factor in [0.5, 1.5, 2.0] {
        let after = variance(&edited(&muted(), &[on("secondary", vary(Some(factor), None))]).0);
        let ratio = after / before / (factor * factor);
        assert!((ratio - 1.0).abs() < 0.02, "{factor}: {ratio}");
    }
    let same = edited(&muted(), &[on("secondary", vary(Some(0.0), None))]).0;
    assert!(same.secondary().iter().all(|i| i.colour == same.secondary()[0].colour));
    // Two elements remain two, in new colours.
    let after = one(on("primary", vary(Some(0.5), None)));
    assert_eq!(after.elements.len(), 3);
    assert_ne!(after.elements, scene().elements);
}

#[test]
fn shapes_become_alike_or_more_varied_about_their_mean() {
    let same = one(on("primary", vary(None, Some(0.0))));
    let all = gaussians(&same)[240..].to_vec();
    let own = gaussians(&scene())[240..].to_vec();
    for k in 0..3 {
        let mean = own.iter().map(|g| g.covariance[k]).sum::<f64>() / own.len() as f64;
        assert!(all.iter().all(|g| (g.covariance[k] - mean).abs() < 0.01), "{k} {mean}");
    }
    assert!(all.iter().zip(&own).all(|(a, b)| a.mean.distance(b.mean) < 0.02));
    // The inverse operation restores the shapes.
    let back = edited(&scene(), &[vary(None, Some(2.0)).into(), vary(None, Some(1.0)).into()]).0;
    assert_eq!(back.edits.len(), 1);
    let wide = gaussians(&back)[240..].to_vec();
    let spread =
        |all: &[Gaussian]| all.iter().map(|g| (g.covariance[0] - g.covariance[2]).abs()).sum::<f64>();
    assert!(spread(&wide) > 1.5 * spread(&own));
}

/// The colours of each instance, in order.
fn shown(scene: &Scene) -> Vec<Vec<Colour>> {
    let of = |i: &Instance| {
        let element = scene.element(i);
        let own = element.paint(i.colour).0;
        std::iter::once(own).chain(element.details().iter().map(|d| d.colour)).collect()
    };
    scene.instances().map(of).collect()
}

#[test]
fn appearances_change_places_and_outlines_stay() {
    let before = muted();
    let after = edited(&before, &[shuffle(false).into()]).0;
    for (a, b) in before.instances().zip(after.instances()) {
        assert_eq!((a.id, a.transform), (b.id, b.transform));
        assert_eq!(before.element(a).outline(), after.element(b).outline());
    }
    let (mut old, mut new) = (shown(&before), shown(&after));
    // Two thirds of the primaries look the same, so at most one third of these can get another appearance.
    let changed = old[..240].iter().zip(&new).filter(|(a, b)| a != b).count();
    assert!(changed >= 230, "{changed}");
    let changed = old[240..].iter().zip(&new[240..]).filter(|(a, b)| a != b).count();
    assert_eq!(changed, 40);
    old.sort();
    new.sort();
    assert_eq!(old, new, "the same colours as before");
    let details = after.primary().iter().map(|i| &after.element(i).details()[0]);
    assert!(details.clone().all(|d| (d.outline.area() - 24.0).abs() < 2.0));
    let other = apply(before.clone(), &[shuffle(false).into()], &Files::default(), Some(6)).unwrap().0;
    assert_ne!(shown(&other), shown(&after));
}

#[test]
fn outlines_change_places_within_their_gaussians() {
    let mut before = scene();
    let tall = testing::element(3, Some(7), outline("M-4-9h8l2 20h-12z"), Colour([9; 3]));
    before.elements.push(tall);
    before.primary_mut().iter_mut().step_by(3).for_each(|i| i.element = ElementId(3));
    let after = edited(&before, &[on("primary", shuffle(true))]).0;
    let exchanged = before.primary().iter().zip(after.primary()).filter(|(a, b)| a.element != b.element);
    assert!(exchanged.count() >= 40);
    for (a, b) in gaussians(&before).iter().zip(gaussians(&after)) {
        let size = a.covariance[0] + a.covariance[2];
        assert!(a.covariance.iter().zip(b.covariance).all(|(a, b)| (a - b).abs() < 1e-3 * size));
        assert!(shortest_offset(a.mean, b.mean, before.periods()).hypot2() < 1e-3);
    }
}

#[test]
fn details_do_not_stick_out_of_the_outlines_that_get_them() {
    let mut before = scene();
    let slim = testing::element(3, Some(7), outline("M-12 0l12-3 12 3-12 3z"), Colour([9; 3]));
    before.elements.push(slim);
    before.primary_mut().iter_mut().step_by(2).for_each(|i| i.element = ElementId(3));
    let after = edited(&before, &[on("primary", shuffle(false))]).0;
    let mut bent = 0;
    for element in after.elements.iter().filter(|e| e.outline() == before.elements[3].outline()) {
        let hull = &element.outline().polygons(0.01)[0];
        for point in element.details().iter().flat_map(|d| d.outline.polygons(0.05)).flatten() {
            let out = vtex_base::geometry::nearest(hull, point).distance(point);
            assert!(vtex_base::geometry::inside(hull, point) || out < 0.3, "{point} {out}");
            bent += 1;
        }
    }
    assert!(bent > 0);
}

#[test]
fn what_is_too_thin_is_left_and_counted() {
    let mut before = scene();
    before.elements.push(testing::element(3, Some(7), outline("M-9 0h18v0.8h-18z"), Colour([9; 3])));
    before.elements.push(testing::element(4, Some(7), outline("M-9 0h18z"), Colour([9; 3])));
    before.primary_mut()[3].element = ElementId(3);
    before.primary_mut()[4].element = ElementId(4);
    for action in [vary(None, Some(0.3)), shuffle(false), shuffle(true)] {
        let (after, outcomes) = edited(&before, &[action.into()]);
        assert_eq!(outcomes[0].thin, 2);
        for own in [3, 4].map(|k| &before.primary()[k]) {
            let same = after.primary().iter().find(|i| i.id == own.id).unwrap();
            assert_eq!(same.transform, own.transform);
            assert_eq!(after.element(same), before.element(own));
        }
    }
}

#[test]
fn transforms_are_exact_and_touch_no_others() {
    let conditions = [among(Identity::Category, &[7], true)];
    let action = Action::Transform { by: [3.0, -2.0], scale: [2.0, 1.0], angle: 90.0, about: About::Each };
    let after = edited(&scene(), &[those(&conditions, action)]).0;
    for (a, b) in after.instances().zip(scene().instances()) {
        if b.element != ElementId(1) {
            assert_eq!(a, b);
            continue;
        }
        let [p, q, r, s, x, y] = b.transform;
        let wanted = [-q, 2.0 * p, -s, 2.0 * r];
        assert!(a.transform[..4].iter().zip(wanted).all(|(a, b)| (a - b).abs() < 2e-5));
        let way =
            shortest_offset(Point::new(x, y), Point::new(a.transform[4], a.transform[5]), scene().periods());
        assert!((way.x - 3.0).abs() < 0.011 && (way.y + 2.0).abs() < 0.011, "{way:?}");
    }
    // Scaling about the common middle doubles the distances between a few elements on the left.
    let few = [compare(Quantity::X, Comparison::Less, 60.0), compare(Quantity::Y, Comparison::Less, 60.0)];
    let action = Action::Transform { by: [0.0; 2], scale: [2.0; 2], angle: 0.0, about: About::Selection };
    let (mut plain, chosen) = (scene(), those(&few, action));
    plain.tile = Default::default();
    let after = edited(&plain, &[chosen]).0;
    let moved: Vec<[Point; 2]> = plain
        .instances()
        .zip(after.instances())
        .filter(|(a, b)| a != b)
        .map(|(a, b)| [a, b].map(|i| Point::new(i.transform[4], i.transform[5])))
        .collect();
    assert!(moved.len() > 3);
    for pair in moved.windows(2) {
        let far = |k: usize| pair[0][k].distance(pair[1][k]);
        assert!((far(1) - 2.0 * far(0)).abs() < 0.03);
    }
}

/// Least distance of two places of a layer.
fn nearest(scene: &Scene, instances: &[Instance]) -> f64 {
    let points: Vec<Point> = instances.iter().map(|i| Point::new(i.transform[4], i.transform[5])).collect();
    let near = NearPoints::new(&points, scene.periods(), 60.0);
    let mut least = f64::MAX;
    for (i, p) in points.iter().enumerate() {
        near.each(*p, |j| {
            if i != j {
                least = least.min(shortest_offset(*p, points[j], scene.periods()).hypot2());
            }
        });
    }
    libm::sqrt(least)
}

#[test]
fn relaxing_evens_distances() {
    let relax = |rounds, minimum_distance| Action::Relax { rounds, strength: 0.5, minimum_distance };
    let even = one(on("secondary", relax(60, None)));
    // Their distance in a lattice would be 24.
    let (before, after) = (nearest(&scene(), scene().secondary()), nearest(&even, even.secondary()));
    assert!(before < 4.0 && after > 14.0, "{before} {after}");
    assert_eq!(even.primary(), scene().primary());
    let apart = one(on("secondary", relax(200, Some(12.0))));
    assert!(nearest(&apart, apart.secondary()) > 11.9);
    let moved = apart.secondary().iter().zip(scene().secondary()).filter(|(a, b)| **a != **b).count();
    assert!(moved < 240, "those far from others stay: {moved}");
    // Elements at one place are separated.
    let mut heap = scene();
    heap.secondary_mut().iter_mut().take(20).for_each(|i| i.transform = [1.0, 0.0, 0.0, 1.0, 50.0, 50.0]);
    let parted = edited(&heap, &[on("secondary", relax(200, Some(8.0)))]).0;
    assert!(nearest(&parted, parted.secondary()) > 7.0);
}

#[test]
fn what_is_relaxed_in_a_place_stays_there_and_becomes_even() {
    // Three quarters of the secondaries lie in the left third.
    let mut dense = scene();
    let [width, height] = [f64::from(dense.width), f64::from(dense.height)];
    let mut random = stream(1, "test/relax", 0);
    for (k, instance) in dense.secondary_mut().iter_mut().enumerate() {
        let x = if k % 4 == 0 { random.range(width / 3.0, width) } else { random.range(0.0, width / 3.0) };
        (instance.transform[4], instance.transform[5]) = (x, random.range(0.0, height));
    }
    let left = |i: &Instance| i.transform[4] < width / 3.0;
    let count = dense.secondary().iter().filter(|i| left(i)).count();
    let relax = Action::Relax { rounds: 60, strength: 0.5, minimum_distance: None };
    let place = compare(Quantity::X, Comparison::Less, width / 3.0);
    let after = edited(&dense, &[Operation { layer: Some("secondary".into()), ..those(&[place], relax) }]).0;
    for (old, new) in dense.secondary().iter().zip(after.secondary()) {
        assert_eq!(left(old), left(new));
        assert!(left(old) || old == new);
    }
    let alone = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.secondary_mut().retain(left);
        nearest(&scene, scene.secondary())
    };
    let lattice = 1.0746 * libm::sqrt(width / 3.0 * height / count as f64);
    let (before, after) = (alone(&dense), alone(&after));
    assert!(before < 0.2 * lattice && after > 0.4 * lattice, "{before} {after} {lattice}");
}

#[test]
fn what_would_become_too_thin_is_counted() {
    let mut flat = scene();
    let id = flat.primary()[0].id;
    for instance in flat.primary_mut() {
        let [.., x, y] = instance.transform;
        let thin = if instance.id == id { 0.3 } else { 1.0 };
        instance.transform = [1.0, 0.0, 0.0, thin, x, y];
    }
    let (after, outcomes) = edited(&flat, &[on("primary", vary(None, Some(3.0)))]);
    let of = |scene: &Scene| scene.primary().iter().find(|i| i.id == id).cloned();
    assert_eq!((outcomes[0].thin, of(&after)), (1, of(&flat)));
}

#[test]
fn orders_sort_the_selected_in_their_layers() {
    let ys = |s: &Scene| s.primary().iter().map(|i| i.transform[5]).collect::<Vec<_>>();
    let rising = one(Action::Order { by: OrderBy::Y, reverse: false });
    assert!(ys(&rising).windows(2).all(|w| w[0] <= w[1]));
    assert!(ys(&one(Action::Order { by: OrderBy::Y, reverse: true })).windows(2).all(|w| w[0] >= w[1]));
    let mut ids: Vec<u32> = rising.instances().map(|i| i.id.0).collect();
    ids.sort_unstable();
    assert_eq!(ids, (0..300).collect::<Vec<_>>());
    // Elements that are not selected keep their places in the order.
    let some = one(those(
        &[among(Identity::Category, &[7], true)],
        Action::Order { by: OrderBy::X, reverse: false },
    ));
    assert_eq!(some.primary()[..40], scene().primary()[..40]);
    assert!(some.primary()[40..].windows(2).all(|w| w[0].transform[4] <= w[1].transform[4]));
    // Where copies are stacked, what is painted later stays higher.
    let mut stacked = scene();
    stacked.instances_mut().zip(0..).for_each(|(instance, height)| instance.height = height);
    let (sorted, _) = edited(&stacked, &[Action::Order { by: OrderBy::Y, reverse: false }.into()]);
    assert!(sorted.instances().map(|i| i.height).eq(0..300) && ys(&sorted) == ys(&rising));
    let random = |seed| {
        let operation = [Action::Order { by: OrderBy::Random, reverse: false }.into()];
        apply(scene(), &operation, &Files::default(), Some(seed)).unwrap().0
    };
    assert_ne!(random(1), random(2));
    let light = one(Action::Order { by: OrderBy::Lightness, reverse: false });
    assert!(light.element(&light.primary()[0]).base().colour == Colour([40, 60, 150]));
}

#[test]
fn further_changes_by_jitter_leave_places_as_they_were() {
    let still = Jitter { distance: 9.0, angle: 30.0, scale: 10.0, ..Jitter::default() };
    let (plain, more) =
        (one(jitter(still.clone())), Jitter { hue: 30.0, chroma: 20.0, lightness: 10.0, ..still });
    let coloured = one(jitter(more.clone()));
    for (a, b) in plain.instances().zip(coloured.instances()) {
        assert_eq!(a.transform, b.transform);
    }
    assert_ne!(shown(&plain), shown(&coloured));
    let base = |s: &Scene, i: &Instance| s.element(i).paint(i.colour).0.to_oklab();
    for (a, b) in plain.instances().zip(coloured.instances()) {
        assert!((base(&plain, a)[0] - base(&coloured, b)[0]).abs() < 0.11);
    }
    let flipped = one(jitter(Jitter { flip: 0.3, ..Jitter::default() }));
    let share = flipped.instances().filter(|i| i.affine().determinant() < 0.0).count() as f64 / 300.0;
    assert!((share - 0.3).abs() < 0.1, "{share}");
    let stretched = one(jitter(Jitter { stretch: 50.0, ..Jitter::default() }));
    for (a, b) in gaussians(&stretched).iter().zip(gaussians(&scene())) {
        assert!((a.size() / b.size() - 1.0).abs() < 1e-3);
        let ratio = |g: &Gaussian| g.deviations()[0] / g.deviations()[1];
        assert!((0.49..1.51).contains(&(ratio(a) / ratio(&b))));
    }
}

#[test]
fn jitter_in_steps_has_few_values_and_normal_ones_gather() {
    let steps = Jitter { scale: 40.0, steps: 2, ..Jitter::default() };
    let factor = |i: &Instance| libm::round(libm::sqrt(i.affine().determinant().abs()) * 100.0) as i64;
    let mut counts = std::collections::BTreeMap::new();
    one(jitter(steps)).instances().for_each(|i| *counts.entry(factor(i)).or_insert(0) += 1);
    assert_eq!(counts.keys().copied().collect::<Vec<_>>(), [60, 80, 100, 120, 140]);
    assert!(counts.values().all(|n| (40..80).contains(n)), "{counts:?}");
    let off = |distribution| {
        let scene = one(jitter(Jitter { scale: 40.0, distribution, ..Jitter::default() }));
        let off: Vec<i64> = scene.instances().map(|i| (factor(i) - 100).abs()).collect();
        assert!(off.iter().all(|v| *v <= 40));
        off.iter().filter(|v| **v < 20).count()
    };
    // Two thirds lie within one standard deviation.
    let (even, normal) = (off(Distribution::Uniform), off(Distribution::Normal));
    assert!((120..180).contains(&even) && (190..235).contains(&normal), "{even} {normal}");
}

#[test]
fn maps_stand_for_numbers_and_colours() {
    let map = || NumberOrMap::Map("fade.png".into());
    let sizes = one(Action::Scale { factor: map() });
    for (a, b) in sizes.instances().zip(scene().instances()) {
        let x = b.transform[4];
        let factor = libm::sqrt(a.affine().determinant());
        assert!(!(20.0..380.0).contains(&x) || (factor - x / 200.0).abs() < 0.03, "{x} {factor}");
    }
    let turned = one(Action::Rotate { angle: map() });
    assert_ne!(turned.primary(), scene().primary());
    let varied =
        edited(&muted(), &[Action::Vary { colour: Some(map()), shape: None, within: Within::Layer }.into()])
            .0;
    let change = |k: usize| {
        let lab = |s: &Scene| s.secondary()[k].colour.unwrap().to_oklab();
        (lab(&varied)[0] - lab(&muted())[0]).abs()
    };
    let at = |k: usize| muted().secondary()[k].transform[4];
    let middle = (0..240).filter(|k| (190.0..210.0).contains(&at(*k))).map(change).fold(0.0, f32::max);
    let left = (0..240).filter(|k| at(*k) < 30.0).map(change).fold(0.0, f32::max);
    assert!(middle < 0.004 && left > 0.012, "{middle} {left}");
    let tint = Action::Tint { colour: ColourOrMap::Map("fade.png".into()), amount: 1.0, share: 1.0 };
    let grey = one(tint);
    for i in grey.secondary() {
        let [r, g, b] = i.colour.unwrap().0;
        let wanted = i.transform[4] / 400.0 * 256.0;
        assert!(r == g && g == b, "{r} {g} {b}");
        let off = (f64::from(r) - wanted).abs();
        assert!(off < 8.0 || !(20.0..380.0).contains(&i.transform[4]), "{r} {wanted}");
    }
    let background = one(on(
        "background",
        Action::Tint { colour: ColourOrMap::Map("fade.png".into()), amount: 1.0, share: 1.0 },
    ));
    let points = &background.field().points;
    assert!(points.iter().find(|p| p.x > 370.0).unwrap().colour.0[0] > 200);
    let missing = Action::Scale { factor: NumberOrMap::Map("x.png".into()) };
    let error = apply(scene(), &[missing.into()], &Files::default(), None).unwrap_err();
    assert!(matches!(error, Error::Edit { fault: EditFault::NoFile(_), .. }));
}

#[test]
fn what_is_drawn_on_one_element_appears_on_all_like_it() {
    let mut before = scene();
    // The drawing has a dot in the middle of the canvas: two pixels from the centre of this bar.
    before.primary_mut()[5].transform = [0.0, 1.0, -1.0, 0.0, 200.0, 152.0];
    let propagate = |similar, replace| Action::Propagate {
        drawing: Some("dot.svg".into()),
        element: None,
        fill: None,
        of: None,
        similar,
        replace,
    };
    let (after, outcomes) = edited(&before, &[on("primary", propagate(None, false))]);
    assert_eq!((outcomes[0].matched, outcomes[0].thin), (40, 0));
    for (a, b) in after.instances().zip(before.instances()) {
        let (new, old) = (after.element(a), before.element(b));
        if old.category != Some(vtex_scene::scene::CategoryId(3)) {
            assert_eq!(new, old);
            continue;
        }
        let dot = &new.shapes[2];
        assert_eq!((new.shapes.len(), dot.colour), (3, Colour([0, 0, 255])));
        // In its own coordinates, where the bar was turned by a quarter.
        let centre = dot.outline.bounds().center();
        assert!((centre - Point::new(-2.0, 0.0)).hypot2() < 1e-3, "{centre}");
        assert!((dot.outline.area() - 12.57).abs() < 0.1);
    }
    let replaced = edited(&before, &[on("primary", propagate(Some(0.01), true))]).0;
    let bar = replaced.element(&replaced.primary()[5]);
    assert_eq!((bar.shapes.len(), bar.outline()), (1, before.elements[0].outline()));
    let all = edited(&before, &[on("primary", propagate(Some(2.0), false))]).1;
    assert_eq!(all[0].matched, 60);
    // A shape far from all elements is not drawn.
    let far = |i: &mut Instance| {
        i.transform[4] = if (150.0..250.0).contains(&i.transform[4]) { 20.0 } else { i.transform[4] }
    };
    before.primary_mut().iter_mut().for_each(far);
    assert_eq!(edited(&before, &[on("primary", propagate(None, false))]).1[0].matched, 0);
}

#[test]
fn all_elements_like_one_take_a_drawing_or_a_colour() {
    let before = scene();
    let id = before.primary()[5].id;
    let category = before.element(&before.primary()[5]).category;
    let like = |i: &Instance, scene: &Scene| scene.element(i).category == category;
    let propagate = |element: Option<&str>, fill, of, replace| Action::Propagate {
        drawing: None,
        element: element.map(str::to_owned),
        fill,
        of,
        similar: None,
        replace,
    };
    let red = Colour([255, 0, 0]);
    let (after, outcomes) = edited(&before, &[on("primary", propagate(None, Some(red), Some(id), false))]);
    let count = before.primary().iter().filter(|i| like(i, &before)).count();
    assert_eq!((outcomes[0].matched, outcomes[0].thin), (count, 0));
    for (a, b) in after.instances().zip(before.instances()) {
        let is = a.colour == Some(red);
        assert_eq!(is, like(b, &before) && before.primary().contains(b));
    }
    // A drawing by itself replaces each element, in its frame.
    let (after, outcomes) =
        edited(&before, &[on("primary", propagate(Some("dot.svg"), None, Some(id), true))]);
    assert_eq!(outcomes[0].matched, count);
    let pairs = after.gaussians().into_iter().zip(before.gaussians());
    for ((a, b), (new, old)) in after.instances().zip(before.instances()).zip(pairs) {
        if !(before.primary().contains(b) && like(b, &before)) {
            assert_eq!(after.element(a), before.element(b));
            continue;
        }
        let element = after.element(a);
        assert_eq!((element.shapes.len(), element.shapes[0].colour), (1, Colour([0, 0, 255])));
        let (new, old) = (new.unwrap(), old.unwrap());
        let size = old.covariance[0] + old.covariance[2];
        let alike = new.covariance.iter().zip(old.covariance).all(|(a, b)| (a - b).abs() < 2e-3 * size);
        assert!(alike && new.mean.distance(old.mean) < 0.05, "{new:?} {old:?}");
    }
    // Without an element to compare with, all selected elements change; with an id that is not selected,
    // none.
    let all = edited(&before, &[on("primary", propagate(None, Some(red), None, false))]).1;
    assert_eq!(all[0].matched, before.primary().len());
    let none = edited(&before, &[on("secondary", propagate(None, Some(red), Some(id), false))]);
    assert_eq!((none.1[0].matched, none.0.elements), (0, before.elements.clone()));
    let similar = Action::Propagate {
        drawing: None,
        element: None,
        fill: Some(red),
        of: None,
        similar: Some(0.1),
        replace: false,
    };
    let error = apply(before.clone(), &[similar.into()], &Files::default(), None);
    assert!(matches!(error, Err(Error::Edit { fault: EditFault::LikeNothing, .. })));
    let error = apply(before, &[propagate(None, None, None, false).into()], &Files::default(), None);
    assert!(matches!(error, Err(Error::Edit { fault: EditFault::NotOneOf(_), .. })));
}

#[test]
fn more_than_a_scene_is_to_hold_is_not_drawn_on_it() {
    let lines: String = (0..180_000).map(|k| format!("M{} {}h3v2z", k % 200, k % 90)).collect();
    let drawing =
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 300"><path d="{lines}"/></svg>"#);
    let operation: Operation = Action::Propagate {
        drawing: None,
        element: Some("lines.svg".into()),
        fill: None,
        of: None,
        similar: None,
        replace: false,
    }
    .into();
    let before = scene();
    let files = Files::read(std::slice::from_ref(&operation), [before.width, before.height], |_| {
        Ok(drawing.clone().into_bytes())
    })
    .unwrap();
    let error = apply(before, &[operation], &files, None).unwrap_err();
    let Error::Edit { fault: EditFault::TooMuchDrawn { lines, elements, most }, .. } = error else {
        panic!("{error}");
    };
    assert!(lines > 700_000 && elements == 3 && lines * elements > most);
}
