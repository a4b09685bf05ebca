//! Shapes as files hold them.

use super::*;
use vtex_base::geometry::{Affine, Curve, parse_path, rotation};
use vtex_base::raster::colour::Colour;

fn curve(text: &str) -> Curve {
    Curve::new(parse_path(text).unwrap()).unwrap()
}

fn again(shape: &Shape) -> Shape {
    serde_json::from_str(&serde_json::to_string(shape).unwrap()).unwrap()
}

#[test]
fn filled_and_stroked_shapes_are_read_as_they_were_written() {
    let outline = Outline::new(&parse_path("M0 0h8v4h-8z").unwrap()).unwrap();
    let filled = Shape::new(outline, Colour([1, 2, 3]));
    let text = serde_json::to_string(&filled).unwrap();
    assert_eq!(text, r##"{"outline":"m0 0h8v4h-8z","colour":"#010203"}"##);
    assert_eq!(again(&filled), filled);

    let line = Line { dashes: vec![3.0, 1.0], cap: Cap::Round, ..Line::new(curve("M0 0h20"), 2.0) };
    let stop = Stop { offset: 0.3, colour: Colour([9; 3]), opacity: 0.5 };
    let linear = Gradient::linear([0.0, 0.0], [20.0, 0.0], [Colour([0; 3]), Colour([255; 3])]);
    let gradient = Gradient { kind: GradientKind::Radial, between: vec![stop], ..linear };
    let stroked = Shape::stroked(line, Colour([7; 3])).unwrap();
    let stroked = Shape { gradient: Some(Box::new(gradient)), opacity: 0.25, ..stroked };
    let text = serde_json::to_string(&stroked).unwrap();
    assert!(!text.contains("outline") && text.contains("\"dashes\":[3.0,1.0]"), "{text}");
    assert_eq!(again(&stroked), stroked);
}

#[test]
fn moved_ellipses_are_read_as_they_were_written() {
    let ellipse = Ellipse { centre: [4.0, 3.0], matrix: [2.0, 0.5, 1.0], profile: Profile::Sharp };
    let soft = Shape::of_ellipse(ellipse, Colour([7; 3])).unwrap();
    for turn in [0.4, -2.0, 3.1] {
        let moved = soft.moved(Affine::translate((3.3, -0.7)) * rotation(turn) * Affine::FLIP_X);
        assert_eq!(again(&moved), moved);
    }
}

#[test]
fn soft_ellipses_are_stored_by_their_matrix() {
    let ellipse = Ellipse { centre: [4.0, 3.0], matrix: [2.0, 0.5, 1.0], profile: Profile::Soft };
    let soft = Shape::of_ellipse(ellipse, Colour([7; 3])).unwrap();
    let text = serde_json::to_string(&soft).unwrap();
    assert_eq!(text, r##"{"ellipse":{"centre":[4.0,3.0],"matrix":[2.0,0.5,1.0]},"colour":"#070707"}"##);
    assert_eq!(again(&soft), soft);
    // Its weighted area is smaller than that of its rim, and it is visible only on another shape.
    let rim = soft.outline.area();
    assert!((rim - 1.75 * std::f64::consts::PI).abs() < 0.02 && soft.area() < 0.2 * rim);
    let base = Shape::new(Outline::new(&parse_path("M0 0h8v4h-8z").unwrap()).unwrap(), Colour([1; 3]));
    assert_eq!(bounds(&[base.clone(), soft.clone()]), base.outline.bounds());
    assert_eq!(fault(&[base.clone(), soft.clone()]), None);
    assert!(fault(&[soft.clone(), base]).is_some_and(|f| f.contains("shapes on a soft ellipse")));
    // Alone it is a valid element.
    assert_eq!(fault(std::slice::from_ref(&soft)), None);
    assert_eq!(bounds(std::slice::from_ref(&soft)), soft.outline.bounds());
    let sharp = Shape::of_ellipse(Ellipse { profile: Profile::Sharp, ..ellipse }, Colour([7; 3])).unwrap();
    let text = serde_json::to_string(&sharp).unwrap();
    assert!(text.contains(r#""profile":"sharp""#) && again(&sharp) == sharp, "{text}");
    // Another outline gives another ellipse.
    let twice = soft.with_outline(soft.outline.moved(Affine::scale(2.0)));
    let matrix = twice.ellipse.unwrap().matrix;
    assert!(matrix.iter().zip([4.0, 1.0, 2.0]).all(|(a, b)| (a - b).abs() < 0.02), "{matrix:?}");
    let shaded = r##"{"colour":"#000000","ellipse":{"centre":[0,0],"matrix":[1,0,0]}}"##;
    let error = serde_json::from_str::<Shape>(shaded).unwrap_err().to_string();
    assert!(error.contains("semi-axes"), "{error}");
}

#[test]
fn the_outline_of_a_line_is_the_area_that_it_paints() {
    let area = |line: Line| Shape::stroked(line, Colour([0; 3])).unwrap().outline.area();
    let plain = Line::new(curve("M0 0h20"), 2.0);
    assert!((area(plain.clone()) - 40.0).abs() < 0.1);
    assert!((area(Line { cap: Cap::Square, ..plain.clone() }) - 44.0).abs() < 0.1);
    let dashed = Line { dashes: vec![5.0, 5.0], ..plain.clone() };
    assert!((area(dashed) - 20.0).abs() < 0.1);
    // A line with too many dashes is drawn without gaps.
    assert!((area(Line { dashes: vec![1e-9, 1e-9], ..plain.clone() }) - 40.0).abs() < 0.1);
    let moved = Shape::stroked(plain, Colour([0; 3])).unwrap().moved(Affine::scale(3.0));
    assert!((moved.outline.area() - 360.0).abs() < 1.0);
    assert_eq!(moved.line.unwrap().width, 6.0);
}

#[test]
fn a_rim_goes_with_its_shape() {
    let outline = Outline::new(&parse_path("M0 0h8v4h-8z").unwrap()).unwrap();
    let rim = SoftRim { width: 2.0, colour: Colour([90; 3]), opacity: 0.8 };
    let shape = Shape { rim: Some(Box::new(rim)), ..Shape::new(outline.clone(), Colour([1; 3])) };
    let text = serde_json::to_string(&shape).unwrap();
    assert!(text.ends_with(r##""rim":{"width":2.0,"colour":"#5a5a5a","opacity":0.8}}"##), "{text}");
    assert_eq!(again(&shape), shape);
    assert_eq!(bounds(std::slice::from_ref(&shape)), outline.bounds().inflate(1.0, 1.0));
    let twice = shape.moved(Affine::scale(2.0));
    assert_eq!(twice.rim, Some(Box::new(SoftRim { width: 4.0, ..rim })));
    assert_eq!(shape.with_outline(twice.outline).rim, shape.rim);
    assert_eq!(shape.recoloured(|_| Colour([7; 3])).rim.unwrap().colour, Colour([7; 3]));
    // Along the first shape only, if that is filled.
    assert_eq!(fault(&[shape.clone(), Shape::new(outline.clone(), Colour([2; 3]))]), None);
    let below = fault(&[Shape::new(outline, Colour([2; 3])), shape.clone()]);
    assert!(below.is_some_and(|f| f.contains("not along its first shape")));
    let line = Shape::stroked(Line::new(curve("M0 0h20"), 2.0), Colour([0; 3])).unwrap();
    assert!(fault(&[Shape { rim: shape.rim.clone(), ..line }]).is_some_and(|f| f.contains("filled outline")));
    let wide = Shape { rim: Some(Box::new(SoftRim { width: 0.0, ..rim })), ..shape };
    assert!(fault(&[wide]).is_some_and(|f| f.contains("the width of a rim")));
}

#[test]
fn what_is_neither_or_both_is_refused() {
    let read = |text: &str| serde_json::from_str::<Shape>(text).map_err(|e| e.to_string()).unwrap_err();
    for text in [
        r##"{"colour":"#000000"}"##,
        r##"{"colour":"#000000","outline":"M0 0h1v1z","line":{"path":"M0 0h1","width":1}}"##,
    ] {
        assert!(read(text).contains("an outline, a line or an ellipse"), "{}", read(text));
    }
    let wide = r##"{"colour":"#000000","line":{"path":"M0 0h1","width":-1}}"##;
    assert!(read(wide).contains("the width of a line, -1"), "{}", read(wide));
}

#[test]
fn strange_paint_is_a_fault() {
    let outline = Outline::new(&parse_path("M0 0h8v4h-8z").unwrap()).unwrap();
    let shape = Shape::new(outline, Colour([0; 3]));
    let linear = Gradient::linear([0.0, 0.0], [9.0, 0.0], [Colour([0; 3]); 2]);
    let stop = |offset| Stop { offset, colour: Colour([0; 3]), opacity: 1.0 };
    let with = |gradient| fault(&[Shape { gradient: Some(Box::new(gradient)), ..shape.clone() }]);
    assert_eq!(with(linear.clone()), None);
    assert!(with(Gradient { to: [0.0; 2], ..linear.clone() }).unwrap().contains("no way"));
    assert!(with(Gradient { between: vec![stop(0.5), stop(0.2)], ..linear.clone() }).is_some());
    assert!(with(Gradient { between: vec![stop(2.0)], ..linear.clone() }).is_some());
    assert!(with(Gradient { opacities: [0.5, f64::NAN], ..linear }).is_some());
    assert!(fault(&[Shape { opacity: 1.5, ..shape }]).unwrap().contains("opacity"));
    assert!(fault(&[]).is_some());
}
