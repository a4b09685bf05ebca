use super::*;
use crate::import::motifs::swatches::{Swatch, SwatchPlan, thirty};
use crate::import::{ImportParams, import};
use vtex_base::geometry::{Point, shortest_offset};
use vtex_scene::library::{AnalyzeParams, Grouping, Library};

fn read(svg: &str, wrap: bool, group: MotifGrouping, elements: Grouping) -> Library {
    let analyze = AnalyzeParams { group, elements, ..AnalyzeParams::default() };
    import(svg.as_bytes(), "swatch.svg", &ImportParams { wrap: Some(wrap), analyze }, &()).unwrap()
}

/// For each part of a swatch, the number of its motif, or of its element beyond those of the motifs.
fn found(swatch: &Swatch, library: &Library) -> Vec<usize> {
    let periods = [0, 1].map(|k| swatch.wrap.then_some(swatch.size[k]));
    let mut own: Vec<usize> = (0..library.elements.len()).map(|k| library.motifs.len() + k).collect();
    for (m, motif) in library.motifs.iter().enumerate() {
        motif.parts.iter().for_each(|p| own[p.element.index()] = m);
    }
    let shapes: Vec<(Point, usize)> = (library.elements.iter().enumerate())
        .flat_map(|(k, e)| e.shapes.iter().map(move |s| (s.outline.bounds().center(), k)))
        .collect();
    let nearest = |at: Point| {
        let far = |p: Point| shortest_offset(at, p, periods).hypot();
        let (place, element) = shapes.iter().min_by(|a, b| far(a.0).total_cmp(&far(b.0))).unwrap();
        assert!(far(*place) < 2.5, "no shape at {at}");
        own[*element]
    };
    swatch.parts.iter().map(|(at, _)| nearest(*at)).collect()
}

/// The adjusted Rand index of two divisions (Hubert and Arabie 1985).
fn adjusted_rand(a: &[usize], b: &[usize]) -> f64 {
    let pairs =
        |counts: BTreeMap<(usize, usize), f64>| counts.values().map(|n| n * (n - 1.0) / 2.0).sum::<f64>();
    let count = |key: &dyn Fn(usize) -> (usize, usize)| {
        let mut counts: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        (0..a.len()).for_each(|k| *counts.entry(key(k)).or_default() += 1.0);
        pairs(counts)
    };
    let (both, first, second) = (count(&|k| (a[k], b[k])), count(&|k| (a[k], 0)), count(&|k| (b[k], 0)));
    let all = a.len() as f64 * (a.len() as f64 - 1.0) / 2.0;
    let expected = first * second / all;
    (both - expected) / ((first + second) / 2.0 - expected)
}

/// Adjusted Rand indices of swatches, with elements as `how` says.
fn indices(plans: &[SwatchPlan], how: Grouping, group: MotifGrouping) -> Vec<f64> {
    let index = |plan: &SwatchPlan| {
        let swatch = plan.drawn();
        let library = read(&swatch.svg, swatch.wrap, group, how);
        let known: Vec<usize> = swatch.parts.iter().map(|p| p.1).collect();
        let index = adjusted_rand(&known, &found(&swatch, &library));
        println!("{index:.3} {:?} {plan:?}", library.motif_sizes());
        index
    };
    let all: Vec<f64> = plans.iter().map(index).collect();
    println!("{how:?}, {group:?}: mean {:.3}", all.iter().sum::<f64>() / all.len() as f64);
    all
}

#[test]
fn known_groups_of_thirty_swatches_are_found() {
    // Pieces that are very near each other are one element already; with pieces as elements none are.
    for (how, seed) in [(Grouping::Auto, 0), (Grouping::Piece, 1000)] {
        let all = indices(&thirty(seed), how, MotifGrouping::Auto);
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        assert!(mean >= 0.95 && all.iter().all(|v| *v >= 0.7), "{how:?}: {mean} {all:?}");
    }
    let alone = indices(&thirty(1000)[..5], Grouping::Piece, MotifGrouping::None);
    assert!(alone.iter().all(|v| *v < 0.05), "{alone:?}");
}

/// A page with shapes.
fn page(shapes: &str) -> String {
    format!("<svg xmlns='http://www.w3.org/2000/svg' width='200' height='200'>{shapes}</svg>")
}

#[test]
fn contact_alone_joins_what_touches() {
    // Two pairs that touch, and two that are near.
    let bar = |x: u32, y: u32, w: u32| format!("<path d='M{x} {y}h{w}v6h-{w}z' fill='#123'/>");
    let touching = [(20, 30), (120, 60)].map(|(x, y)| bar(x, y, 20) + &bar(x + 20, y, 14)).concat();
    let near = [(30, 120), (130, 150)].map(|(x, y)| bar(x, y, 20) + &bar(x, y + 10, 20)).concat();
    let svg = page(&(touching + &near));
    let sizes = |group| read(&svg, false, group, Grouping::Piece).motif_sizes();
    assert_eq!(sizes(MotifGrouping::Contact), BTreeMap::from([(2, 2)]));
    assert_eq!(sizes(MotifGrouping::Auto), BTreeMap::from([(2, 4)]));
    assert!(sizes(MotifGrouping::None).is_empty());
}

#[test]
fn groups_of_the_author_that_recur_are_motifs() {
    // A disc and a square whose distance does not stand out, among others.
    let pair = |x: u32, y: u32| {
        let disc = format!("<circle cx='{x}' cy='{y}' r='5'/>");
        format!("<g>{disc}<path d='M{} {y}h10v10h-10z'/></g>", x + 25)
    };
    let loose = |x: u32, y: u32| format!("<circle cx='{x}' cy='{y}' r='5'/>");
    let singles: String =
        [(60, 20), (100, 50), (160, 60), (20, 80), (60, 100)].map(|(x, y)| loose(x, y)).concat();
    let grouped = page(&(pair(20, 40) + &pair(90, 90) + &pair(40, 150) + &singles));
    let sizes = |svg: &str| read(svg, false, MotifGrouping::Auto, Grouping::Piece).motif_sizes();
    assert_eq!(sizes(&grouped), BTreeMap::from([(2, 3)]));
    assert!(sizes(&grouped.replace("<g>", "").replace("</g>", "")).is_empty());
    let once = page(&(pair(20, 40) + &singles));
    assert!(sizes(&once).is_empty());
}

#[test]
fn motifs_cross_the_borders_of_a_page_that_repeats() {
    let swatch = thirty(0)[0].drawn();
    let library = read(&swatch.svg, true, MotifGrouping::Auto, Grouping::Auto);
    let crossing = library.motifs.iter().flat_map(|m| &m.parts).filter(|p| p.periods != [0; 2]);
    assert!(crossing.count() > 0);
    for motif in &library.motifs {
        let at = |k: usize| {
            let part = &motif.parts[k];
            let [x, y] = library.elements[part.element.index()].centroid;
            let [i, j] = part.periods.map(f64::from);
            Point::new(x + i * swatch.size[0], y + j * swatch.size[1])
        };
        assert!(at(0).distance(at(1)) < 12.0, "{motif:?}");
    }
}

#[test]
fn grouping_stops_wherever_it_is_asked_to() {
    let swatch = thirty(0)[13].drawn();
    let library = read(&swatch.svg, swatch.wrap, MotifGrouping::None, Grouping::Piece);
    let count = library.elements.len();
    let source = MotifSource {
        elements: &library.elements,
        layers: &vec![0; count],
        groups: &vec![None; count],
        is_endless: &vec![false; count],
        size: swatch.size,
        wrap: swatch.wrap,
    };
    let asked = std::cell::Cell::new(0);
    let run = |most: usize| {
        asked.set(0);
        motifs(&source, MotifGrouping::Auto, &|| {
            asked.set(asked.get() + 1);
            if asked.get() > most { Err(vtex_base::Error::Interrupted) } else { Ok(()) }
        })
    };
    assert!(!run(usize::MAX).unwrap().is_empty());
    let all = asked.get();
    assert!(all > count, "{all} questions for {count} elements");
    assert!((0..all).step_by(7).all(|most| run(most).is_err()));
}

/// Flowers of five petals around places, each turned by its own angle, on a page of 900 x 900; each a group of the author if
/// asked for.
fn flowers(places: &[Point], in_groups: bool) -> String {
    let flower = |(k, at): (usize, &Point)| {
        let petal = |petal: u32| {
            let angle = 36.7 * k as f64 + 72.0 * f64::from(petal);
            let Point { x, y } = *at;
            format!("<ellipse rx='6' ry='3' transform='translate({x} {y})rotate({angle})translate(20)'/>")
        };
        let petals: String = (0..5).map(petal).collect();
        if in_groups { format!("<g>{petals}</g>") } else { petals }
    };
    let all: String = places.iter().enumerate().map(flower).collect();
    format!("<svg xmlns='http://www.w3.org/2000/svg' width='900' height='900'>{all}</svg>")
}

#[test]
fn motifs_of_motifs_are_wholes() {
    // Middles of twelve groups, a little out of line.
    let middle = |k: usize| {
        let [x, y] = [(150 + k % 3 * 330) as f64, (110 + k / 3 * 225) as f64];
        Point::new(x + (k * 37 % 23) as f64, y + (k * 53 % 19) as f64)
    };
    let around = |middle: Point, k: usize, distance: f64| {
        (0..3).map(move |n| {
            let (sine, cosine) = libm::sincos(0.9 * k as f64 + f64::from(n) * std::f64::consts::TAU / 3.0);
            middle + distance * vtex_base::geometry::Vec2::new(cosine, sine)
        })
    };
    let groups: Vec<Point> = (0..12).flat_map(|k| around(middle(k), k, 43.0)).collect();
    for wrap in [false, true] {
        let library = read(&flowers(&groups, false), wrap, MotifGrouping::Auto, Grouping::Piece);
        assert_eq!(library.motif_sizes(), BTreeMap::from([(15, 12)]), "{wrap}");
        for motif in &library.motifs {
            let at = |part: &MotifPart| {
                let [x, y] = library.elements[part.element.index()].centroid;
                let [i, j] = part.periods.map(|v| 900.0 * f64::from(v));
                Point::new(x + i, y + j)
            };
            assert!(motif.parts.iter().all(|part| at(part).distance(at(&motif.parts[0])) < 150.0));
        }
        let of_author = flowers(&groups, true);
        let library = read(&of_author, wrap, MotifGrouping::Auto, Grouping::Piece);
        assert_eq!(library.motif_sizes(), BTreeMap::from([(15, 12)]), "{wrap}");
        // The same flowers, spread over the page.
        let even: Vec<Point> = (0..36)
            .map(|k| {
                Point::new((75 + k % 6 * 150 + k * 7 % 20) as f64, (75 + k / 6 * 150 + k * 11 % 17) as f64)
            })
            .collect();
        let library = read(&flowers(&even, false), wrap, MotifGrouping::Auto, Grouping::Piece);
        assert_eq!(library.motif_sizes(), BTreeMap::from([(5, 36)]), "{wrap}");
        // Two pairs of them by chance.
        let mut some = even.clone();
        (some[8], some[27]) = (some[7] + (even[8] - even[7]) * 0.4, some[26] + (even[27] - even[26]) * 0.4);
        let library = read(&flowers(&some, false), wrap, MotifGrouping::Auto, Grouping::Piece);
        assert_eq!(library.motif_sizes(), BTreeMap::from([(5, 36)]), "{wrap}");
    }
}
