//! An estimate of the cost of drawing filters and repeated patterns of an SVG.
//!
//! Drawing cannot be interrupted, and 200 bytes can take hours: a wide `feMorphology` looks at a million
//! pixels for each pixel, `feTurbulence` adds any number of octaves.

use resvg::usvg::filter::{Filter, Kind};
use resvg::usvg::{Group, Node, Paint, Transform, Tree};

/// Steps that are allowed: some ten seconds.
const MOST: f64 = 1e10;
/// Steps of drawing one element.
const ELEMENT: f64 = 1e3;

/// Whether a tree can be drawn in reasonable time, `scale` pixels to a unit of the SVG, into a picture
/// of the given size.
pub(super) fn affordable(tree: &Tree, scale: [f32; 2], picture: [u32; 2]) -> bool {
    // resvg draws layers of at most five times the picture along each axis.
    let most = picture.map(|v| 5.0 * f64::from(v));
    let mut estimate = Estimate { scale: scale.map(f64::from), most, steps: 0.0 };
    estimate.add_group(tree.root(), Transform::identity());
    estimate.steps <= MOST
}

struct Estimate {
    scale: [f64; 2],
    /// Largest sides of a layer, in pixels.
    most: [f64; 2],
    steps: f64,
}

impl Estimate {
    /// Adds the cost of a group with all its content, given the transform of what is around it: the tree's own product is
    /// wrong below `use` elements of symbols. Returns early beyond [`MOST`], because nested patterns can unfold without end.
    fn add_group(&mut self, group: &Group, around: Transform) {
        let map = around.pre_concat(group.transform());
        if let Some(mask) = group.mask() {
            self.add_group(mask.root(), Transform::identity());
            mask.mask().into_iter().for_each(|inner| self.add_group(inner.root(), Transform::identity()));
        }
        for filter in group.filters() {
            self.add_filter(filter, group, map);
        }
        for node in group.children() {
            self.steps += ELEMENT;
            if self.steps > MOST {
                return;
            }
            match node {
                Node::Group(inner) => self.add_group(inner, map),
                Node::Path(path) => {
                    let paints = [path.fill().map(|f| f.paint()), path.stroke().map(|s| s.paint())];
                    for paint in paints.into_iter().flatten() {
                        if let Paint::Pattern(pattern) = paint {
                            self.add_group(pattern.root(), Transform::identity());
                        }
                    }
                }
                Node::Image(_) | Node::Text(_) => {}
            }
        }
    }

    fn add_filter(&mut self, filter: &Filter, group: &Group, t: Transform) {
        // Upper bounds of the scale of the surrounding groups; a rotated axis gets the scales of both.
        let own = [t.sx.abs() + t.kx.abs(), t.ky.abs() + t.sy.abs()].map(f64::from);
        let scale = [0, 1].map(|k| own[k] * self.scale[k]);
        let bounds = group.layer_bounding_box();
        let sides = [bounds.width(), bounds.height()].map(f64::from);
        let sides = [0, 1].map(|k| (sides[k] * scale[k]).clamp(1.0, self.most[k]));
        let reach = |radius: f32, k: usize| (f64::from(radius) * scale[k] * 2.0 + 1.0).min(2.0 * sides[k]);
        let pixel = |kind: &Kind| match kind {
            Kind::Turbulence(t) => 200.0 * f64::from(t.num_octaves()),
            Kind::Morphology(m) => 2.0 * reach(m.radius_x().get(), 0) * reach(m.radius_y().get(), 1),
            Kind::ConvolveMatrix(c) => 4.0 * f64::from(c.matrix().columns()) * f64::from(c.matrix().rows()),
            Kind::DiffuseLighting(_) | Kind::SpecularLighting(_) => 100.0,
            _ => 40.0,
        };
        let pixels = sides[0] * sides[1];
        self.steps += pixels * filter.primitives().iter().map(|p| pixel(p.kind())).sum::<f64>();
        for primitive in filter.primitives() {
            if let Kind::Image(image) = primitive.kind() {
                self.add_group(image.root(), Transform::identity());
            }
        }
    }
}
