//! Points, rings, outlines with holes, contour tracing, curve fitting.
//! Knows nothing of images, libraries or scenes. Points and paths are those of `kurbo`.

mod outline;
mod path_text;

pub use kurbo::{Affine, BezPath, PathEl, Point, Rect, Vec2};
pub use outline::{Outline, STEP};
pub use path_text::{PathText, parse_path, write_path};
