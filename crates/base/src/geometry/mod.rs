//! Points, rings, outlines with holes, contour tracing, curve fitting.
//! Knows nothing of images, libraries or scenes. Points and paths are those of `kurbo`.

mod arc_samples;
pub mod assign;
mod cage;
pub mod coherence;
mod convex;
mod curve;
pub mod dense;
pub mod displace;
mod fit;
mod fitted_map;
mod interior;
mod lower;
mod moments;
mod offset;
mod outline;
mod outside;
mod path_text;
mod periodic;
pub mod plane;
mod polygon;
mod refit;
mod region_window;
mod rigid;
mod second_moments;
mod simple;
mod trace;

pub use assign::{Table, assign};
pub use cage::Cage;
pub use convex::{ConvexPolygon, closed_rings};
pub use curve::Curve;
pub use fit::fitted_curve;
pub use fitted_map::{FittedMap, Scale};
pub use interior::Interior;
pub use kurbo::{Affine, BezPath, PathEl, Point, Rect, Vec2};
pub use lower::Lower;
pub use moments::Moments;
pub use offset::{moved_inwards, opened, signed_area};
pub use outline::{Outline, STEP};
pub use outside::CurvePart;
pub use path_text::{PathText, parse_path, write_path};
pub use periodic::{NearPoints, shortest_offset, wrapped};
pub use polygon::{edges, inside, nearest, nearest_between, ring_path};
pub use region_window::RegionWindow;
pub use rigid::rigid_map;
pub use second_moments::SecondMoments;
pub use simple::is_simple;
pub use trace::{OUTSIDE, PlanarMap};

/// Coefficients of a map as scenes hold them: five decimals of the linear part, two of the shift.
pub fn rounded(map: Affine) -> [f64; 6] {
    let [a, b, c, d, e, f] = map.as_coeffs();
    let [a, b, c, d] = [a, b, c, d].map(|v| libm::round(v * 1e5) / 1e5);
    let [e, f] = [e, f].map(|v| libm::round(v * 100.0) / 100.0);
    [a, b, c, d, e, f]
}

/// A rotation about the origin by an angle in radians, from x towards y; the same on every platform.
pub fn rotation(angle: f64) -> Affine {
    let (sine, cosine) = libm::sincos(angle);
    Affine::new([cosine, sine, -sine, cosine, 0.0, 0.0])
}
