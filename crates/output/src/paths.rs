//! Outlines as paths of tiny-skia, and regions that clip what is drawn.

use tiny_skia::{FillRule, Mask, PathBuilder, PixmapMut, Transform};
use vtex_base::geometry::{Affine, Outline, PathEl};
use vtex_scene::scene::Scene;

/// The path as tiny-skia's type; `None` if there is nothing to fill.
pub(super) fn path_of(outline: &Outline) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for element in outline.path().elements() {
        match *element {
            PathEl::MoveTo(p) => builder.move_to(p.x as f32, p.y as f32),
            PathEl::LineTo(p) => builder.line_to(p.x as f32, p.y as f32),
            PathEl::QuadTo(a, p) => builder.quad_to(a.x as f32, a.y as f32, p.x as f32, p.y as f32),
            PathEl::CurveTo(a, b, p) => {
                builder.cubic_to(a.x as f32, a.y as f32, b.x as f32, b.y as f32, p.x as f32, p.y as f32);
            }
            PathEl::ClosePath => builder.close(),
        }
    }
    builder.finish()
}

/// A clip shape, in pixels of the picture.
pub(super) struct ClipRegion(Vec<(tiny_skia::Path, Affine)>);

impl ClipRegion {
    /// The domain of a scene, with its copies. A scene without a domain has an empty region.
    pub(super) fn of_domain(scene: &Scene, scale: [f64; 2]) -> Self {
        scene.domain.as_ref().map_or(Self(Vec::new()), |d| Self::new(scene, &d.outline, scale))
    }

    /// An outline on the canvas of a scene, with its copies.
    pub(super) fn new(scene: &Scene, outline: &Outline, scale: [f64; 2]) -> Self {
        let scale = Affine::scale_non_uniform(scale[0], scale[1]);
        let copies = scene.copies(outline.bounds());
        Self(copies.filter_map(|shift| Some((path_of(outline)?, scale * Affine::translate(shift)))).collect())
    }

    /// The opacity of each pixel of a band that begins at row `top`.
    pub(super) fn mask(&self, width: u32, rows: u32, top: f64, anti_alias: bool) -> Option<Mask> {
        let mut mask = Mask::new(width, rows)?;
        for (path, affine) in &self.0 {
            mask.fill_path(path, FillRule::Winding, anti_alias, band_transform(*affine, top));
        }
        Some(mask)
    }

    pub(super) fn clip(&self, band: &mut PixmapMut<'_>, top: f64) {
        if let Some(mask) = self.mask(band.width(), band.height(), top, true) {
            band.apply_mask(&mask);
        }
    }
}

/// A map to the picture as a transform of tiny-skia, in a band that begins at row `top`.
pub(super) fn band_transform(affine: Affine, top: f64) -> Transform {
    let [a, b, c, d, e, f] = affine.as_coeffs();
    let [a, b, c, d, e, f] = [a, b, c, d, e, f - top].map(|v| v as f32);
    Transform::from_row(a, b, c, d, e, f)
}
