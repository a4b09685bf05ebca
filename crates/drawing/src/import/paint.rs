//! Paints of a drawing: colours, and gradients as elements hold them.

use crate::svg_tree::affine;
use resvg::usvg;
use vtex_base::geometry::{Affine, Point, Vec2};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::{Gradient, GradientKind, Stop};

/// The paint of a shape.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DrawnPaint {
    /// Its colour, or the mean colour of its gradient.
    pub(super) colour: Colour,
    pub(super) gradient: Option<Gradient>,
    pub(super) opacity: f64,
}

/// A paint on the page, and a description of what was changed in it; `None` for a pattern.
pub(super) fn paint(
    paint: &usvg::Paint,
    opacity: f64,
    map: Affine,
) -> Option<(DrawnPaint, Option<&'static str>)> {
    let plain = |c: usvg::Color| DrawnPaint { colour: colour(c), gradient: None, opacity };
    Some(match paint {
        usvg::Paint::Color(c) => (plain(*c), None),
        usvg::Paint::LinearGradient(g) => {
            let [from, to] = [(g.x1(), g.y1()), (g.x2(), g.y2())].map(|(x, y)| point(x, y));
            let ends = linear(from, to, map * affine(g.transform()));
            let remark = spread(g.spread_method());
            (gradient(GradientKind::Linear, ends, g.stops(), opacity), remark)
        }
        usvg::Paint::RadialGradient(g) => {
            let map = map * affine(g.transform());
            let (centre, r) = (point(g.cx(), g.cy()), f64::from(g.r().get()));
            let size = libm::sqrt(map.determinant().abs());
            let ends = Some([map * centre, map * centre + Vec2::new(r * size, 0.0)]);
            let [a, b, c, d, ..] = map.as_coeffs();
            let round = ((a - d).abs() + (b + c).abs()).min((a + d).abs() + (b - c).abs()) < 1e-3 * size;
            let central =
                (g.fx() - g.cx()).abs() + (g.fy() - g.cy()).abs() < 1e-3 * g.r().get() && g.fr().get() <= 0.0;
            let remark = if round && central {
                spread(g.spread_method())
            } else {
                Some("radial gradients are made round, with their focus in the middle")
            };
            (gradient(GradientKind::Radial, ends, g.stops(), opacity), remark)
        }
        usvg::Paint::Pattern(_) => return None,
    })
}

fn spread(method: usvg::SpreadMethod) -> Option<&'static str> {
    (method != usvg::SpreadMethod::Pad).then_some("gradients that repeat are drawn once")
}

fn point(x: f32, y: f32) -> Point {
    Point::new(f64::from(x), f64::from(y))
}

fn colour(c: usvg::Color) -> Colour {
    Colour([c.red, c.green, c.blue])
}

/// The ends of a linear gradient after an affine map. Lines of one colour stay lines, and the new ends lie on
/// a line at right angles to them. `None` if the gradient has no length.
fn linear(from: Point, to: Point, map: Affine) -> Option<[Point; 2]> {
    let [a, b, c, d, ..] = map.as_coeffs();
    let along = to - from;
    let (length, det) = (along.hypot2(), map.determinant());
    if length <= 0.0 || det == 0.0 {
        return None;
    }
    // The gradient of the offset, mapped by the inverse transpose.
    let g = along / length;
    let g = Vec2::new((d * g.x - b * g.y) / det, (a * g.y - c * g.x) / det);
    let from = map * from;
    Some([from, from + g / g.hypot2()])
}

fn gradient(kind: GradientKind, ends: Option<[Point; 2]>, stops: &[usvg::Stop], opacity: f64) -> DrawnPaint {
    let stop = |s: &usvg::Stop| Stop {
        offset: f64::from(s.offset().get()),
        colour: colour(s.color()),
        opacity: f64::from(s.opacity().get()),
    };
    let stops: Vec<Stop> = stops.iter().map(stop).collect();
    let count = stops.len().max(1) as f64;
    let sum = |k: usize| stops.iter().map(|s| s.colour.to_f64()[k]).sum::<f64>() / count;
    let mean = Colour::from_f64([sum(0), sum(1), sum(2)]);
    let (Some(first), Some(last)) = (stops.first(), stops.last()) else {
        return DrawnPaint { colour: mean, gradient: None, opacity };
    };
    let Some([from, to]) = ends.filter(|[from, to]| from != to) else {
        return DrawnPaint { colour: last.colour, gradient: None, opacity: opacity * last.opacity };
    };
    let between = stops.iter().filter(|s| s.offset > 0.0 && s.offset < 1.0 || s != &first && s != &last);
    let gradient = Gradient {
        kind,
        from: [from.x, from.y],
        to: [to.x, to.y],
        start: first.colour,
        end: last.colour,
        between: between.copied().collect(),
        opacities: [first.opacity, last.opacity],
    };
    DrawnPaint { colour: mean, gradient: Some(gradient), opacity }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_gradients_keep_their_lines_of_colour() {
        let map = Affine::new([2.0, 0.3, -0.7, 1.1, 5.0, -3.0]);
        let [p, q] = [Point::new(1.0, 2.0), Point::new(7.0, 4.0)];
        let [from, to] = linear(p, q, map).unwrap();
        let share = |a: Point, b: Point, at: Point| (at - a).dot(b - a) / (b - a).hypot2();
        for at in [(0.0, 0.0), (3.0, -4.0), (9.0, 1.5)].map(Point::from) {
            assert!((share(p, q, at) - share(from, to, map * at)).abs() < 1e-9);
        }
        assert_eq!(linear(p, p, map), None);
    }
}
