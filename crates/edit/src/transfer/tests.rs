//! Arrangements with the appearance of others.

use super::*;
use vtex_base::document::Document;
use vtex_base::geometry::{Affine, Outline, parse_path};
use vtex_base::raster::colour::Colour;
use vtex_scene::scene::{Instance, InstanceId, Role, Shape, testing};

fn outline(text: &str) -> Outline {
    Outline::new(&parse_path(text).unwrap()).unwrap()
}

/// Elements of one outline and colour, with a detail, on a canvas of 300 × 200.
fn texture(seed: u64, text: &str, colour: [u8; 3]) -> Scene {
    let mut element = testing::element(0, Some(1), outline(text), Colour(colour));
    element.shapes.push(Shape::new(outline("M-1-1h3v3h-3z"), Colour(colour.map(|v| v / 2 + 60))));
    let speck = testing::element(1, None, outline("M-1-1h3v2h-3z"), Colour([90; 3]));
    let mut random = stream(seed, "test/texture", 0);
    let mut place = |id: u32, element: u32| {
        let at = [random.range(0.0, 300.0), random.range(0.0, 200.0)].map(libm::round);
        let linear =
            vtex_base::geometry::rotation(random.range(0.0, 6.0)) * Affine::scale(random.range(0.7, 1.4));
        let transform = (Affine::translate((at[0], at[1])) * linear).as_coeffs();
        Instance { transform, ..Instance::new(InstanceId(id), ElementId(element)) }
    };
    let primary = (0..80).map(|i| place(i, 0)).collect();
    let secondary = (80..200).map(|i| {
        let colour = colour.map(|v| v / 2 + (i % 40) as u8);
        Instance { colour: Some(Colour(colour)), ..place(i, 1) }
    });
    let secondary = secondary.collect();
    let field = testing::flat(Colour(colour.map(|v| v / 2)));
    let mut scene = testing::scene([300, 200], vec![element, speck], secondary, primary, field);
    scene.libraries[0].exemplar = format!("{seed}.jpg");
    scene
}

fn bars() -> Scene {
    texture(1, "M-12-4h24v8h-24z", [170, 120, 80])
}

fn drops() -> Scene {
    texture(2, "M-6 0C-5-5 8-6 12 0C8 6-5 5-6 0z", [90, 130, 160])
}

fn pieces() -> Scene {
    texture(3, "M-6-6h12v12h-12z", [120, 160, 100])
}

fn params(mode: TransferMode, scale: f64) -> TransferParams {
    TransferParams { mode, scale, seed: 5 }
}

/// Distance in Oklab of the mean medians of the primaries of two scenes.
pub(super) fn median_shift(a: &Scene, b: &Scene) -> f64 {
    let [a, b] = [a, b].map(|s| mean(s, &[Role::Primary]));
    libm::sqrt((0..3).map(|k| a[k] - b[k]).map(|d| d * d).sum())
}

pub(super) fn mean(scene: &Scene, roles: &[Role]) -> [f64; 3] {
    let of = scene.roles();
    let all: Vec<[f32; 3]> =
        of.zip(scene.appearances()).filter(|(r, _)| roles.contains(r)).map(|(_, a)| a.median).collect();
    std::array::from_fn(|k| all.iter().map(|lab| f64::from(lab[k])).sum::<f64>() / all.len() as f64)
}

#[test]
fn a_texture_with_its_own_appearance_stays_as_it_is() {
    for mode in [TransferMode::Mean, TransferMode::Replace] {
        let (after, _) = transfer(&bars(), &[bars()], &[], &params(mode, 1.0)).unwrap();
        assert_eq!(after.to_json(), bars().to_json());
    }
}

#[test]
fn replaced_elements_have_the_gaussians_of_the_structure() {
    let (after, report) = transfer(&bars(), &[drops()], &[], &params(TransferMode::Replace, 1.0)).unwrap();
    assert_eq!((report.changed, report.removed, report.thin), (200, 0, 0));
    for (a, b) in bars().gaussians().into_iter().zip(after.gaussians()) {
        let (a, b) = (a.unwrap(), b.unwrap());
        let size = a.covariance[0] + a.covariance[2];
        assert!(a.covariance.iter().zip(b.covariance).all(|(a, b)| (a - b).abs() < 2e-3 * size));
        assert!(a.mean.distance(b.mean) < 0.02);
    }
    // Only elements of the appearance are left, and its library is listed.
    assert_eq!(after.libraries.iter().map(|l| &l.exemplar[..]).collect::<Vec<_>>(), ["1.jpg", "2.jpg"]);
    assert!(after.elements.iter().all(|e| e.library == LibraryId(1)));
    let json = String::from_utf8(after.to_json()).unwrap();
    assert!(json.contains("\"transfer\""));
    let again = transfer(&bars(), &[drops()], &[], &params(TransferMode::Replace, 1.0)).unwrap().0;
    assert_eq!(again.to_json(), after.to_json());
}

#[test]
fn aligned_means_are_those_of_the_appearance() {
    let (after, _) = transfer(&bars(), &[drops()], &[], &params(TransferMode::Mean, 1.0)).unwrap();
    for role in [Role::Primary, Role::Secondary] {
        let (got, wanted) = (mean(&after, &[role]), mean(&drops(), &[role]));
        assert!((0..3).all(|k| (got[k] - wanted[k]).abs() < 0.004), "{got:?} {wanted:?}");
    }
    for (a, b) in after.instances().zip(bars().instances()) {
        assert_eq!((a.transform, after.element(a).outline()), (b.transform, bars().element(b).outline()));
    }
    assert_eq!(after.field().fallback, drops().field().fallback);
}

#[test]
fn a_factor_scales_areas_by_its_square() {
    let area = |s: &Scene| s.gaussians().iter().map(|g| g.unwrap().size()).sum::<f64>();
    for scale in [1.0, 2.0 / 3.0, 4.0 / 9.0] {
        let mut large = bars();
        large.instances_mut().for_each(|i| (0..4).for_each(|k| i.transform[k] *= 3.0));
        for mode in [TransferMode::Mean, TransferMode::Replace] {
            let (after, report) = transfer(&large, &[drops()], &[], &params(mode, scale)).unwrap();
            assert_eq!(report.thin, 0);
            let ratio = area(&after) / area(&large) / (scale * scale);
            assert!((ratio - 1.0).abs() < 0.01, "{scale}: {ratio}");
        }
    }
}

#[test]
fn every_element_is_of_the_appearance_of_its_region() {
    let share = |k: u32| {
        let value = move |i: u32| f32::from(u8::from(i == k));
        ControlMap::new(3, 1, (0..3).map(value).collect()).unwrap()
    };
    let shares = [share(0), share(1), share(2)];
    let all = [drops(), pieces(), bars()];
    let (after, _) = transfer(&bars(), &all, &shares, &params(TransferMode::Replace, 1.0)).unwrap();
    for instance in after.instances() {
        let region = (instance.transform[4] / 100.0).min(2.0) as u32;
        let near = (instance.transform[4] % 100.0 - 100.0).abs() < 1.0 || instance.transform[4] % 100.0 < 1.0;
        assert!(near || after.element(instance).library == LibraryId(1 + region), "{instance:?}");
    }
    for fault in [
        transfer(&bars(), &[drops(), pieces()], &[], &TransferParams::default()),
        transfer(&bars(), &[], &[], &TransferParams::default()),
        transfer(&bars(), &[drops()], &[], &params(TransferMode::Mean, 0.0)),
    ] {
        assert!(matches!(fault, Err(vtex_base::Error::Parameter { .. })));
    }
}

#[test]
fn what_the_appearance_lacks_or_is_too_thin_is_counted() {
    let mut bare = drops();
    bare.secondary_mut().clear();
    let mut thin = bars();
    thin.elements.push(testing::element(3, None, outline("M-9 0h18v0.5h-18z"), Colour([9; 3])));
    thin.primary_mut()[7].element = ElementId(2);
    let (after, report) = transfer(&thin, &[bare], &[], &params(TransferMode::Replace, 1.0)).unwrap();
    assert_eq!((report.changed, report.removed, report.thin), (79, 120, 1));
    assert_eq!(after.primary()[7].transform, thin.primary()[7].transform);
}

/// A light disc with a dark bar on a ground that grows lighter to the right.
fn picture() -> image::RgbImage {
    image::RgbImage::from_fn(240, 180, |x, y| {
        let (u, v) = (f64::from(x) - 120.0, f64::from(y) - 90.0);
        if u.abs() < 50.0 && v.abs() < 8.0 {
            image::Rgb([40, 30, 60])
        } else if u * u + v * v < 4900.0 {
            image::Rgb([230, 200, 150])
        } else {
            image::Rgb([60 + (x / 3) as u8, 90, 100])
        }
    })
}

fn redrawn(keep: Keep) -> Scene {
    stylize(&picture(), &bars(), &StylizeParams { size: 480, levels: 3, keep, ..StylizeParams::default() })
        .unwrap()
}

/// Correlation of the lightness of elements with that of the picture at their places.
fn correlation(scene: &Scene) -> f64 {
    let pairs: Vec<[f64; 2]> = scene
        .gaussians()
        .iter()
        .zip(scene.appearances())
        .filter_map(|(g, a)| {
            let at = g.as_ref()?.mean;
            let [x, y] = [(at.x / 2.0).clamp(0.0, 239.0) as u32, (at.y / 2.0).clamp(0.0, 179.0) as u32];
            Some([f64::from(a.median[0]), f64::from(Colour(picture().get_pixel(x, y).0).to_oklab()[0])])
        })
        .collect();
    let n = pairs.len() as f64;
    let mean = [0, 1].map(|k| pairs.iter().map(|p| p[k]).sum::<f64>() / n);
    let product = |i: usize, j: usize| pairs.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
    product(0, 1) / libm::sqrt(product(0, 0) * product(1, 1))
}

#[test]
fn a_picture_is_redrawn_in_elements() {
    let scene = redrawn(Keep::Color);
    scene.validate().unwrap();
    assert_eq!([scene.width, scene.height], [480, 360]);
    assert!(scene.count() > 400 && scene.gaussians().iter().all(Option::is_some), "{}", scene.count());
    let grey = redrawn(Keep::Lightness);
    assert!(correlation(&scene) > 0.9 && correlation(&grey) > 0.9);
    // Nothing is recoloured where the elements' own colours are kept.
    let own = redrawn(Keep::None);
    assert!(own.elements.iter().all(|e| bars().elements.contains(e)));
    assert_ne!(grey.elements, scene.elements);
    // Small elements lie where there are edges, and along them.
    let small: Vec<Gaussian> = scene.gaussians().into_iter().flatten().filter(|g| g.size() < 9.0).collect();
    assert!(small.len() > 50);
    let bar =
        |g: &&Gaussian| (g.mean.x - 240.0).abs() < 70.0 && ((g.mean.y - 180.0).abs() - 16.0).abs() < 4.0;
    let along: Vec<f64> = small.iter().filter(bar).map(|g| g.angle().abs()).collect();
    assert!(along.len() > 5 && along.iter().all(|a| *a < 0.5), "{along:?}");
    let empty = testing::scene([9, 9], Vec::new(), Vec::new(), Vec::new(), testing::flat(Colour([0; 3])));
    assert!(matches!(
        stylize(&picture(), &empty, &StylizeParams::default()),
        Err(vtex_base::Error::Control { .. })
    ));
}

#[test]
fn more_places_than_can_be_seen_are_refused_or_left_out() {
    let of = |size, element, levels| {
        stylize(&picture(), &bars(), &StylizeParams { size, levels, element, ..StylizeParams::default() })
    };
    assert!(matches!(of(16_384, Some(2.0), 1), Err(vtex_base::Error::TooLarge { .. })));
    // From the second level on elements would be hardly wider than a pixel.
    let count = |levels| of(120, Some(3.0), levels).unwrap().count();
    assert_eq!(count(6), count(1));
    assert!(of(32, None, 1).is_ok());
    assert!(of(120, Some(2.0), 1).is_ok() && of(120, Some(1000.0), 1).is_ok());
    for element in [1.99, 1000.1, 0.0, -5.0, f64::NAN, f64::INFINITY] {
        let fault = of(120, Some(element), 1).unwrap_err();
        assert!(matches!(fault, vtex_base::Error::Parameter { name: "element-size", .. }), "{fault}");
    }
}
