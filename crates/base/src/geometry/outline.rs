//! A closed outline with holes: the shape of a texton.

use super::{parse_path, path_text, write_path};
use kurbo::{Affine, BezPath, ParamCurve, PathEl, PathSeg, Point, Rect, Shape};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;

/// Grid step of outlines' coordinates, in pixels. Two decimals in text are exact.
pub const STEP: f64 = 0.01;

/// A shape: closed rings of lines and cubic Béziers. The outer ring of a connected shape runs clockwise on
/// the screen (x right, y down) and its holes run the other way, so both fill rules give the same result.
/// Coordinates are multiples of [`STEP`] pixels. In JSON it is SVG path data with relative commands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline(BezPath);

impl Outline {
    /// Converts a path: quadratic curves become cubic, coordinates are rounded to the grid, and open
    /// rings are closed. `None` if a coordinate is not finite or beyond ±10⁷ pixels.
    pub fn new(path: &BezPath) -> Option<Self> {
        let snap = |p: Point| {
            let fine = p.x.abs() < 1e7 && p.y.abs() < 1e7; // false for NaN
            fine.then(|| Point::new(libm::round(p.x / STEP) * STEP, libm::round(p.y / STEP) * STEP))
        };
        let mut out = BezPath::with_capacity(path.elements().len() + 1);
        let (mut start, mut current, mut open) = (Point::ORIGIN, Point::ORIGIN, false);
        for element in path.elements() {
            let draws = !matches!(element, PathEl::MoveTo(_) | PathEl::ClosePath);
            if open && !draws {
                out.close_path();
            } else if draws && !open {
                // Elements after a close continue from the ring's start.
                out.move_to(snap(start)?);
            }
            match *element {
                PathEl::MoveTo(p) => {
                    out.move_to(snap(p)?);
                    start = p;
                }
                PathEl::LineTo(p) => {
                    let p = snap(p)?;
                    if Some(p) != end_of(&out) {
                        out.line_to(p);
                    }
                }
                PathEl::QuadTo(a, b) => {
                    let (c1, c2) = (current.lerp(a, 2.0 / 3.0), b.lerp(a, 2.0 / 3.0));
                    out.curve_to(snap(c1)?, snap(c2)?, snap(b)?);
                }
                PathEl::CurveTo(a, b, c) => out.curve_to(snap(a)?, snap(b)?, snap(c)?),
                PathEl::ClosePath => {}
            }
            open = !matches!(element, PathEl::ClosePath);
            current = element.end_point().unwrap_or(start);
        }
        if open {
            out.close_path();
        }
        Some(Self(out))
    }

    /// The outline as a `kurbo` path.
    pub fn path(&self) -> &BezPath {
        &self.0
    }

    /// Whether the outline has no ring.
    pub fn is_empty(&self) -> bool {
        self.0.elements().is_empty()
    }

    /// Enclosed area without holes, in pixels².
    pub fn area(&self) -> f64 {
        self.0.area().abs()
    }

    /// Bounding box, in pixels.
    pub fn bounds(&self) -> Rect {
        self.0.bounding_box()
    }

    /// The outline with a map applied; the same outline where the map leads beyond ±10⁷ pixels.
    pub fn moved(&self, affine: Affine) -> Self {
        Self::new(&(affine * &self.0)).unwrap_or_else(|| self.clone())
    }

    /// The outline with its points mapped; segments longer than `longest` are cut first, so that they follow the map.
    /// `None` if it leads out of the permitted coordinates.
    pub fn carried(&self, longest: f64, map: impl Fn(Point) -> Point) -> Option<Self> {
        let mut path = BezPath::new();
        for (i, element) in self.0.elements().iter().enumerate() {
            let segment = match *element {
                PathEl::MoveTo(p) => {
                    path.move_to(map(p));
                    continue;
                }
                PathEl::ClosePath => {
                    path.close_path();
                    continue;
                }
                _ => self.0.get_seg(i)?,
            };
            let pieces = libm::ceil(segment.start().distance(segment.end()) / longest).max(1.0);
            for k in 0..pieces as usize {
                match segment.subsegment(k as f64 / pieces..(k + 1) as f64 / pieces) {
                    PathSeg::Line(line) => path.line_to(map(line.p1)),
                    PathSeg::Quad(quad) => path.quad_to(map(quad.p1), map(quad.p2)),
                    PathSeg::Cubic(cubic) => path.curve_to(map(cubic.p1), map(cubic.p2), map(cubic.p3)),
                }
            }
        }
        Self::new(&path)
    }

    /// Bounding box of the transformed outline.
    pub fn bounds_after(&self, affine: Affine) -> Rect {
        (affine * &self.0).bounding_box()
    }

    /// Length of all rings, in pixels.
    pub fn perimeter(&self) -> f64 {
        self.0.perimeter(1e-2)
    }

    /// Polsby–Popper compactness, 4π · area / perimeter²: 1 for a disc, less otherwise, 0 if empty.
    pub fn compactness(&self) -> f64 {
        let perimeter = self.perimeter();
        if perimeter > 0.0 {
            (4.0 * std::f64::consts::PI * self.area() / (perimeter * perimeter)).min(1.0)
        } else {
            0.0
        }
    }
}

/// The end point of a path's last element.
fn end_of(path: &BezPath) -> Option<Point> {
    path.elements().last().and_then(PathEl::end_point)
}

impl std::fmt::Display for Outline {
    /// Writes the path data, without loss.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&write_path(&self.0, path_text::STORED))
    }
}

impl Serialize for Outline {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Outline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        struct PathData<'a>(#[serde(borrow)] Cow<'a, str>);

        let path = parse_path(&PathData::deserialize(deserializer)?.0).map_err(serde::de::Error::custom)?;
        Self::new(&path).ok_or_else(|| serde::de::Error::custom("an outline coordinate is out of range"))
    }
}

#[cfg(feature = "schema")]
impl JsonSchema for Outline {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Outline".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "type": "string",
            "description": "SVG path data: closed rings of M, L, H, V, C and Z, in exemplar pixels",
            "pattern": "^[MmLlHhVvCcZz0-9eE+., -]*$",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_on_after_closing_is_a_ring_of_its_own() {
        let of = |text: &str| Outline::new(&parse_path(text).unwrap()).unwrap();
        assert_eq!(of("M1 3l9 0 0 9zh-4v5M20 20h5v5"), of("M1 3h9v9zM1 3h-4v5zM20 20h5v5z"));
        assert_eq!(of("M1 3l9 0 0 9zH1 3"), of("M1 3h9v9zM1 3H3z"));
    }

    #[test]
    fn carried_outlines_follow_the_map_between_their_points() {
        let square = Outline::new(&parse_path("M0 0h10v10h-10zM3 3v2h2v-2z").unwrap()).unwrap();
        assert_eq!(square.carried(100.0, |p| p), Some(square.clone()));
        // The upper side is bent up to a height of 1 in its middle.
        let arched = |p: Point| Point::new(p.x, p.y - p.x * (10.0 - p.x) * (10.0 - p.y) / 250.0);
        let area = |longest: f64| square.carried(longest, arched).unwrap().area() - square.area();
        assert!((area(0.5) - 6.6).abs() < 0.5 && area(100.0).abs() < 0.5, "{} {}", area(0.5), area(100.0));
        assert_eq!(square.carried(1.0, |_| Point::new(1e9, 0.0)), None);
    }
}
