//! Drawings beside which a texture is made.

#[cfg(any(feature = "clustered", feature = "curves"))]
use vtex_base::error::Error;
use vtex_base::geometry::{Affine, CurvePart, Interior, Outline, Point};
use vtex_scene::element::{ElementId, Line, Shape};
use vtex_scene::library::{ExemplarElement, ExemplarInstance, Library};

/// A drawing that stays as it is, and the region to be filled so that it fits to it, with lines or with elements
/// (*Continuous Curve Textures*, §2.3). The texture holds the drawing as the layer `drawn`, and what is made as the layer
/// `predicted`.
#[derive(Clone, Debug)]
pub struct DrawnContext {
    /// The drawing, in the units of the canvas, its page at the canvas's upper left corner.
    pub drawing: Library,
    /// The region, on the canvas.
    pub region: Outline,
    /// A part of the drawing of the library, in that drawing's units, of which a copy is laid in the region, the middle of
    /// its bounds on that of the region's. The copy is fitted to the drawing around the region. `None`: chance decides what
    /// comes into the region.
    pub source: Option<Outline>,
    /// Whether what the drawing holds in the region is left out first: strokes are cut at the border of the region; of other
    /// shapes, and of elements of the library, those go whose middle lies in it.
    pub anew: bool,
}

impl DrawnContext {
    /// The context without the lines in the region: strokes are cut at its border, and other shapes go whose bounds have
    /// their middle in it. What lies beyond a canvas of a width and height counts as the nearest place on it.
    pub(crate) fn without_lines(&self, canvas: [u32; 2]) -> Self {
        let region = Interior::new(&self.region);
        let is_inside = |p: Point| region.contains_on(canvas.map(f64::from), p);
        self.replacing(|shape| outside(shape, &is_inside))
    }

    /// The context with some of its drawing's shapes, in painting order.
    #[cfg(feature = "clustered")]
    pub(crate) fn keeping(&self, is_kept: &[bool]) -> Self {
        let mut kept = is_kept.iter();
        self.replacing(|shape| if kept.next() == Some(&false) { Vec::new() } else { vec![shape] })
    }

    /// The shapes of the drawing in its painting order.
    pub(crate) fn shapes(&self) -> Vec<Shape> {
        let drawing = &self.drawing;
        let placed = |instance: &ExemplarInstance| {
            let map = Affine::new(instance.transform);
            let element = drawing.elements.get(instance.element.index());
            element.into_iter().flat_map(move |e| e.shapes.iter().map(move |s| s.moved(map)))
        };
        drawing.layers.iter().flat_map(|layer| &layer.instances).flat_map(placed).collect()
    }

    /// The context with each shape of its drawing replaced by others.
    fn replacing(&self, mut by: impl FnMut(Shape) -> Vec<Shape>) -> Self {
        let mut context = Self { anew: false, ..self.clone() };
        let drawing = &mut context.drawing;
        let mut elements: Vec<ExemplarElement> = Vec::new();
        for layer in &mut drawing.layers {
            for instance in std::mem::take(&mut layer.instances) {
                let element = &drawing.elements[instance.element.index()];
                let placed = element.shapes.iter().map(|s| s.moved(Affine::new(instance.transform)));
                for shape in placed.flat_map(&mut by) {
                    layer.instances.push(ExemplarInstance::of(ElementId::after(elements.len())));
                    elements.push(ExemplarElement {
                        silhouette: None,
                        shapes: vec![shape],
                        ..element.clone()
                    });
                }
            }
        }
        drawing.elements = elements;
        context
    }

    /// The error of a region that holds nothing of a kind.
    #[cfg(any(feature = "clustered", feature = "curves"))]
    pub(crate) fn too_small(&self, kind: &str) -> Error {
        let bounds = self.region.bounds();
        let value = format!("{:.0} x {:.0} px", bounds.width(), bounds.height());
        let allowed = format!("large enough for {kind} like those of the library");
        Error::Parameter { name: "region", value, allowed: allowed.into() }
    }

    /// Share of a canvas that the region takes.
    #[cfg(any(feature = "clustered", feature = "curves"))]
    pub(crate) fn share(&self, canvas: [f64; 2]) -> f64 {
        (self.region.area() / (canvas[0] * canvas[1])).min(1.0)
    }

    /// The context in units of which `pixels` stand for one, beside a library in units of which `of_library` do.
    pub(crate) fn scaled(&self, pixels: [f64; 2], of_library: [f64; 2]) -> Self {
        let [stretch, own] = [pixels, of_library].map(|[x, y]| Affine::scale_non_uniform(x, y));
        Self {
            drawing: self.drawing.scaled(pixels),
            region: self.region.moved(stretch),
            source: self.source.as_ref().map(|source| source.moved(own)),
            anew: self.anew,
        }
    }
}

/// What of a shape is outside a region.
fn outside(shape: Shape, is_inside: &impl Fn(Point) -> bool) -> Vec<Shape> {
    let Some(line) = &shape.line else {
        return if is_inside(shape.outline.bounds().center()) { Vec::new() } else { vec![shape] };
    };
    let of_part = |CurvePart { curve, from }| {
        let line = Line { path: curve, dash_offset: line.dash_offset + from, ..(**line).clone() };
        let stroke = Shape::stroked(line, shape.colour)?;
        Some(Shape { gradient: shape.gradient.clone(), opacity: shape.opacity, ..stroke })
    };
    line.path.outside(is_inside).into_iter().filter_map(of_part).collect()
}
