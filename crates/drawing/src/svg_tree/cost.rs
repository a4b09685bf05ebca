//! What drawing a tree costs, in time and in memory, estimated beforehand.
//!
//! The renderer cannot be interrupted, and 200 bytes can take hours or terabytes: a wide `feMorphology` looks at a million
//! pixels for each pixel, patterns and layers have pictures of their own, dashes have no least length.

use resvg::usvg::filter::{Filter, Kind};
use resvg::usvg::{ClipPath, Group, Mask, Node, Paint, Path, Pattern, Rect, Transform, tiny_skia_path};

/// Time for an element, in nanoseconds as all times here. Measured with resvg on one core of a virtual machine.
const ELEMENT: f64 = 3e3;
/// Time for a dash of a stroke.
const DASH: f64 = 2e3;
/// Time for two lines of one path that change their order, or that the renderer compares.
const CROSSING: f64 = 10.0;
/// Times for a pixel that is filled with a colour, a gradient or a pattern.
const FILLED: [f64; 3] = [3.0, 12.0, 30.0];
/// Time for a pixel and a stop of its gradient: the renderer looks at all of them.
const STOP: f64 = 0.8;
/// Time for a pixel of a layer, of a clip path, of a mask.
const LAYER: f64 = 30.0;
const CLIPPED: f64 = 4.0;
const MASKED: f64 = 16.0;
/// Bytes of a pixel.
const PIXEL: f64 = 4.0;

/// What drawing costs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DrawingCost {
    /// Time, in nanoseconds.
    pub(super) time: f64,
    /// Most memory for pictures beside the canvas, in bytes.
    pub(super) memory: f64,
}

impl DrawingCost {
    /// What drawing the content of a group on a canvas of a size costs. The estimate ends where it exceeds `most`.
    pub(super) fn of(group: &Group, transform: Transform, canvas: [u32; 2], most: Self) -> Self {
        let canvas = canvas.map(f64::from);
        let mut estimate = Estimate { canvas, most, cost: Self::default(), held: 0.0 };
        estimate.group(group, transform);
        estimate.cost
    }

    pub(super) fn exceeds(&self, most: Self) -> bool {
        self.time > most.time || self.memory > most.memory
    }
}

struct Estimate {
    /// Width and height of the canvas, in pixels.
    canvas: [f64; 2],
    most: DrawingCost,
    cost: DrawingCost,
    /// Bytes of the pictures that are open.
    held: f64,
}

impl Estimate {
    /// Runs `within` while a picture of `bytes` bytes is open.
    fn holding(&mut self, bytes: f64, within: impl FnOnce(&mut Self)) {
        self.held += bytes;
        self.cost.memory = self.cost.memory.max(self.held);
        if !self.cost.exceeds(self.most) {
            within(self);
        }
        self.held -= bytes;
    }

    /// Adds a group, given the transform of what is around it: the tree's own product is wrong below `use` elements of
    /// symbols.
    fn group(&mut self, group: &Group, around: Transform) {
        let map = around.pre_concat(group.transform());
        if !group.should_isolate() {
            return self.children(group, map);
        }
        let pixels = self.pixels(group.layer_bounding_box().to_rect(), map);
        self.cost.time += LAYER * pixels;
        self.holding(PIXEL * pixels, |estimate| {
            estimate.children(group, map);
            group.filters().iter().for_each(|filter| estimate.filter(filter, group, map));
            group.clip_path().into_iter().for_each(|clip| estimate.clip(clip, map, pixels));
            group.mask().into_iter().for_each(|mask| estimate.mask(mask, map, pixels));
        });
    }

    /// Pixels of a layer that holds a rectangle: the renderer cuts layers at five times the canvas.
    fn pixels(&self, bounds: Rect, map: Transform) -> f64 {
        let drawn =
            bounds.transform(map).map_or([f64::INFINITY; 2], |b| [b.width(), b.height()].map(f64::from));
        (0..2).map(|k| (drawn[k] + 4.0).min(5.0 * self.canvas[k])).product()
    }

    fn children(&mut self, group: &Group, map: Transform) {
        for node in group.children() {
            self.cost.time += ELEMENT;
            if self.cost.exceeds(self.most) {
                return;
            }
            match node {
                Node::Group(inner) => self.group(inner, map),
                Node::Path(path) => self.path(path, map),
                Node::Image(_) | Node::Text(_) => {}
            }
        }
    }

    fn clip(&mut self, clip: &ClipPath, map: Transform, pixels: f64) {
        self.cost.time += CLIPPED * pixels;
        self.holding((PIXEL + 1.0) * pixels, |estimate| {
            estimate.clipping(clip.root(), map.pre_concat(clip.transform()), pixels);
            clip.clip_path().into_iter().for_each(|inner| estimate.clip(inner, map, pixels));
        });
    }

    /// Adds the shapes of a clip path. Those that are clipped themselves have a picture as large as that of the whole.
    fn clipping(&mut self, group: &Group, map: Transform, pixels: f64) {
        for node in group.children() {
            self.cost.time += ELEMENT;
            if self.cost.exceeds(self.most) {
                return;
            }
            match node {
                Node::Group(inner) => {
                    let map = map.pre_concat(inner.transform());
                    let Some(clip) = inner.clip_path() else {
                        self.clipping(inner, map, pixels);
                        continue;
                    };
                    self.cost.time += LAYER * pixels;
                    self.holding(PIXEL * pixels, |estimate| {
                        estimate.clipping(inner, map, pixels);
                        estimate.clip(clip, map, pixels);
                    });
                }
                Node::Path(path) => self.path(path, map),
                Node::Image(_) | Node::Text(_) => {}
            }
        }
    }

    fn mask(&mut self, mask: &Mask, map: Transform, pixels: f64) {
        self.cost.time += MASKED * pixels;
        self.holding((PIXEL + 2.0) * pixels, |estimate| {
            estimate.children(mask.root(), map);
            mask.mask().into_iter().for_each(|inner| estimate.mask(inner, map, pixels));
        });
    }

    fn path(&mut self, path: &Path, map: Transform) {
        if !path.is_visible() {
            return;
        }
        let lines = PathLines::of(path.data(), map);
        if let Some(fill) = path.fill() {
            let area = self.pixels(path.bounding_box(), map).min(lines.area);
            self.cost.time += CROSSING * lines.crossings(1.0, 0.0, path.bounding_box(), map);
            self.paint(fill.paint(), area, map);
        }
        if let Some(stroke) = path.stroke() {
            let scale = (map.sx.abs() + map.kx.abs()).max(map.sy.abs() + map.ky.abs());
            let width = f64::from(stroke.width().get() * scale);
            let area =
                self.pixels(path.stroke_bounding_box(), map).min((lines.length + width) * (width + 2.0));
            let dashes = stroke.dasharray().map_or(0.0, |pattern| {
                let period: f64 = pattern.iter().map(|d| f64::from(d * scale)).sum();
                lines.length / period * pattern.len() as f64
            });
            self.cost.time += DASH * dashes;
            self.cost.time +=
                CROSSING * lines.crossings(2.0, dashes * width, path.stroke_bounding_box(), map);
            self.paint(stroke.paint(), area, map);
        }
    }

    fn paint(&mut self, paint: &Paint, pixels: f64, map: Transform) {
        let [plain, gradient, pattern] = FILLED;
        self.cost.time += pixels
            * match paint {
                Paint::Color(_) => plain,
                Paint::LinearGradient(g) => gradient + STOP * g.stops().len() as f64,
                Paint::RadialGradient(g) => gradient + STOP * g.stops().len() as f64,
                Paint::Pattern(_) => pattern,
            };
        if let Paint::Pattern(pattern) = paint {
            self.pattern(pattern, map);
        }
    }

    /// Adds a pattern: the renderer draws it once for each shape, into a picture as large as its period on the canvas.
    fn pattern(&mut self, pattern: &Pattern, map: Transform) {
        let (sx, sy) = map.pre_concat(pattern.transform()).get_scale();
        let sides = [pattern.rect().width() * sx, pattern.rect().height() * sy].map(f64::from);
        let pixels = sides[0] * sides[1];
        self.cost.time += pixels;
        self.holding(PIXEL * pixels, |estimate| {
            estimate.children(pattern.root(), Transform::from_scale(sx, sy));
        });
    }

    fn filter(&mut self, filter: &Filter, group: &Group, map: Transform) {
        // Upper bounds of the scale; a rotated axis gets the scales of both.
        let scale = [map.sx.abs() + map.kx.abs(), map.ky.abs() + map.sy.abs()].map(f64::from);
        let bounds = group.layer_bounding_box();
        let sides = [bounds.width(), bounds.height()].map(f64::from);
        let sides = [0, 1].map(|k| (sides[k] * scale[k]).clamp(1.0, 5.0 * self.canvas[k]));
        let reach = |radius: f32, k: usize| (f64::from(radius) * scale[k] * 2.0 + 1.0).min(2.0 * sides[k]);
        let pixel = |kind: &Kind| match kind {
            Kind::Turbulence(t) => 200.0 * f64::from(t.num_octaves()),
            Kind::Morphology(m) => 2.0 * reach(m.radius_x().get(), 0) * reach(m.radius_y().get(), 1),
            Kind::ConvolveMatrix(c) => 4.0 * f64::from(c.matrix().columns()) * f64::from(c.matrix().rows()),
            Kind::Merge(m) => 40.0 * m.inputs().len() as f64,
            Kind::DiffuseLighting(_) | Kind::SpecularLighting(_) => 100.0,
            _ => 40.0,
        };
        let pixels = sides[0] * sides[1];
        self.cost.time += pixels * filter.primitives().iter().map(|p| pixel(p.kind())).sum::<f64>();
        // Each step keeps its result.
        let results = filter.primitives().len() as f64 + 2.0;
        self.holding(PIXEL * pixels * results, |estimate| {
            for primitive in filter.primitives() {
                if let Kind::Image(image) = primitive.kind() {
                    estimate.children(image.root(), map);
                }
            }
        });
    }
}

/// Sums over the lines of a path on the canvas, with curves replaced by their control polygons.
#[derive(Default)]
struct PathLines {
    length: f64,
    /// Sum of their heights.
    rise: f64,
    /// Upper bound of the area that they enclose.
    area: f64,
}

impl PathLines {
    fn of(path: &tiny_skia_path::Path, map: Transform) -> Self {
        use tiny_skia_path::{PathSegment, Point};
        let mut lines = Self::default();
        let (mut start, mut at) = (Point::zero(), Point::zero());
        let placed = |mut p: Point| {
            map.map_point(&mut p);
            p
        };
        for segment in path.segments() {
            let mut go = |to: &[Point]| {
                for p in to.iter().map(|p| placed(*p)) {
                    let [dx, dy] = [p.x - at.x, p.y - at.y].map(f64::from);
                    lines.length += libm::hypot(dx, dy);
                    lines.rise += dy.abs();
                    let across = [at.x - start.x, at.y - start.y].map(f64::from);
                    lines.area += 0.5 * (across[0] * dy - across[1] * dx).abs();
                    at = p;
                }
            };
            match segment {
                PathSegment::MoveTo(p) => {
                    start = placed(p);
                    at = start;
                }
                PathSegment::LineTo(p) => go(&[p]),
                PathSegment::QuadTo(a, p) => go(&[a, p]),
                PathSegment::CubicTo(a, b, p) => go(&[a, b, p]),
                PathSegment::Close => at = start,
            }
        }
        lines
    }

    /// Pairs of lines of the path that may cross: the renderer sorts them for each row of pixels, starting from the order
    /// of the row before. `sides` lines are drawn for each line, and `more` is the height of others.
    fn crossings(&self, sides: f64, more: f64, bounds: Rect, map: Transform) -> f64 {
        let height = bounds.transform(map).map_or(0.0, |b| f64::from(b.height())).max(1.0);
        // Mean number of lines that a row meets.
        let lines = (sides * self.rise + more) / height;
        lines * lines
    }
}
