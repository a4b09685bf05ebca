//! Drawing → library: an SVG read as elements in layers.
//!
//! The stages, in order: lines of a picture as an SVG ([`line_art`]), shapes of the page ([`read`]), connected
//! pieces of compound paths ([`pieces`]), pieces made whole across the borders of a periodic page ([`torus`], [`joints`]),
//! contacts of pieces (`vtex_base::raster::contact`), division of pieces into elements ([`elements`]), elements
//! that belong together ([`motifs`]), and the library of it ([`assemble`]), with how copies of the page overlap
//! ([`stacking`]). [`patterns`] unfolds pattern fills.
//!
//! A library has the units of the drawing's page. Its maps have a whole number of pixels for each of them, so
//! that the shorter side of the page has at least 200 px and the median piece at least eight cells of the
//! guide; pages beyond 4096 px have fewer. Pages of less than ten units are read as ten or a hundred times
//! as large.
//!
//! Works badly for drawings whose elements touch and are neither grouped nor of one path, such as a mosaic:
//! each piece is then an element.

mod assemble;
mod categories;
mod clip;
mod elements;
mod joints;
mod lines;
mod motifs;
mod offsets;
mod paint;
mod patterns;
mod periodic;
mod picture;
mod pieces;
mod read;
mod recurring;
mod shapes;
mod stacking;
mod stubs;
mod torus;

pub use vtex_scene::library::Grouping;

pub use crate::line_art::shows_lines;
use crate::{line_art, svg_tree};
use assemble::{DrawingOrigin, assemble};
use pieces::DrawingPiece;
use read::DrawingPage;
use torus::Torus;
use vtex_base::error::Result;
use vtex_base::geometry::Affine;
use vtex_base::progress::{Progress, advance};
use vtex_base::raster::colour::Colour;
use vtex_scene::element::Shape;
use vtex_scene::library::{AnalyzeParams, Library, MotifGrouping, PictureKind};

/// How a drawing is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportParams {
    /// Whether opposite borders of the page join. `None` (the default): tested on the picture. The field of
    /// `analyze` has no effect.
    pub wrap: Option<bool>,
    /// Parameters, of which `kind`, `elements`, `group`, `lenient`, `categories` and `descriptor_reach` have an effect.
    pub analyze: AnalyzeParams,
}

/// Whether bytes, plain or gzip, look like an SVG: they may still be a damaged one.
pub fn is_drawing(bytes: &[u8]) -> bool {
    svg_tree::is_svg(bytes)
}

/// Reads an SVG or SVGZ, or a picture of lines where `kind` says so, as a library. `name` appears in errors and in the
/// library. Nothing outside the file is ever loaded. A drawing that has only a background is permitted: its library has no
/// primaries and a warning.
///
/// # Errors
/// [`vtex_base::Error::Control`] for what is no SVG, or one that takes too much to parse ([`svg_tree::tree`]) or to draw
/// ([`svg_tree::draw`]), for a page beyond a million units, and, unless
/// `lenient`, for raster images, filters, masks, blend modes, patterns in other shapes and clip paths that are not
/// convex polygons; [`vtex_base::Error::TooLarge`] beyond 64 MiB, 400 000 XML elements or 100 000 shapes, or
/// for shapes that together paint more than a gigapixel where the page has 200 px;
/// [`vtex_base::Error::Parameter`], [`vtex_base::Error::Interrupted`]. For a picture of lines also
/// [`vtex_base::Error::Decode`], and [`vtex_base::Error::Unusable`] below 32 × 32 pixels and where no lines stand out.
pub fn import(bytes: &[u8], name: &str, params: &ImportParams, progress: &dyn Progress) -> Result<Library> {
    params.analyze.validate()?;
    advance(progress, "drawing", 0, 4)?;
    let (mut page, wrap) = if params.analyze.kind == PictureKind::Curves && !is_drawing(bytes) {
        let art = line_art::read(bytes, name, params.wrap, progress)?;
        let page = read::read(art.svg.as_bytes(), name, (params.analyze.lenient, false), progress)?;
        (DrawingPage { warnings: art.warnings, ..page }, Some(art.wrap))
    } else {
        let of_pattern = params.wrap != Some(false);
        (read::read(bytes, name, (params.analyze.lenient, of_pattern), progress)?, params.wrap)
    };
    advance(progress, "drawing", 1, 4)?;
    let split = matches!(params.analyze.elements, Grouping::Auto | Grouping::Piece);
    let mut pieces: Vec<DrawingPiece> = Vec::new();
    for (k, item) in page.items.iter().enumerate() {
        advance(progress, "drawing", 1, 4)?;
        pieces.extend(pieces::pieces(k, item, split));
    }
    for piece in &mut pieces {
        piece.parts.retain(shapes::is_visible);
    }
    pieces.retain(|p| !p.parts.is_empty());
    stubs::remove_covered(&mut pieces);
    let found = pieces.len();
    let (background, pieces) = assemble::background(&page, pieces);
    // To save time, very many shapes beneath the background are not drawn.
    page.is_incomplete |= found - pieces.len() > MOST_BENEATH;
    let scale = assemble::scale(&page, &pieces, name)?;
    let picture = picture::picture(&page, (background, &pieces), scale)
        .map_err(|found| read::fault(name, found.reason, found.advice))?;
    let (wrap, remark) = match wrap {
        Some(wrap) => (wrap, None),
        None if periodic::is_periodic(&picture) || joins_where_cut(&page, (background, &pieces), scale) => {
            (true, None)
        }
        None => repeated_anyway(&page, &pieces),
    };
    page.warnings.extend(remark.clone());
    advance(progress, "drawing", 2, 4)?;
    let (pieces, copies) = if wrap {
        let on_page = pieces.into_iter().filter(|p| !page.is_beside(p)).collect();
        let (mut pieces, copies) = Torus::new(page.size).whole(on_page);
        joints::close(&mut pieces, page.size);
        (pieces, copies)
    } else {
        page.count(true);
        (pieces, Vec::new())
    };
    advance(progress, "drawing", 3, 4)?;
    let origin = DrawingOrigin { bytes, name, params, wrap, copies, scale, picture, background };
    let library = assemble(&page, &pieces, origin, progress)?;
    for warning in &library.source.warnings {
        match remark.as_ref() == Some(warning) {
            true => progress.warn_of_placing(warning),
            false => progress.warn(warning),
        }
    }
    advance(progress, "drawing", 4, 4)?;
    Ok(library)
}

/// Reads an SVG or SVGZ as it stands: one element for each shape, in painting order, on a page that does not repeat. For a
/// drawing beside which a texture is made. `name` appears in errors and in the library.
///
/// # Errors
/// Those of [`import`], which is not lenient.
pub fn as_drawn(bytes: &[u8], name: &str, progress: &dyn Progress) -> Result<Library> {
    let analyze =
        AnalyzeParams { elements: Grouping::Path, group: MotifGrouping::None, ..AnalyzeParams::default() };
    import(bytes, name, &ImportParams { wrap: Some(false), analyze }, progress)
}

/// Reads the shapes of an SVG or SVGZ in painting order, its page fitted to a canvas of `width` × `height`
/// pixels as SVG viewers do by default: scaled to the largest size that fits, and centred. `name` appears in
/// errors. Nothing outside the file is ever loaded.
///
/// # Errors
/// [`vtex_base::Error::Control`] for what is no SVG, and for a drawing without shapes or with raster images,
/// filters, masks, blend modes or pattern fills; [`vtex_base::Error::TooLarge`] as [`import`].
pub fn drawn(bytes: &[u8], name: &str, [width, height]: [u32; 2]) -> Result<Vec<Shape>> {
    let page = read::read(bytes, name, (false, false), &())?;
    let [wide, high] = page.size;
    let scale = (f64::from(width) / wide).min(f64::from(height) / high);
    let left = (f64::from(width) - scale * wide) / 2.0;
    let top = (f64::from(height) - scale * high) / 2.0;
    let map = Affine::new([scale, 0.0, 0.0, scale, left, top]);
    let all = page.items.iter().enumerate().filter(|(_, item)| !item.is_beside);
    let pieces = all.flat_map(|(k, item)| pieces::pieces(k, item, false));
    let shapes: Vec<Shape> = pieces.flat_map(|piece| shapes::shapes(&piece, map)).collect();
    if shapes.is_empty() {
        return Err(read::fault(name, "it has no shapes", "draw at least one shape in it"));
    }
    Ok(shapes)
}

/// Most shapes beneath the background that are drawn for the picture of the page.
const MOST_BENEATH: usize = 1000;
/// Number of whole pieces from which on a page is not repeated as a whole.
const FEWEST: usize = 8;

/// Whether opposite borders join where these cut pieces. Gradients, which would be drawn in their mean colour, tell nothing.
fn joins_where_cut(
    page: &DrawingPage,
    (background, pieces): (Colour, &[DrawingPiece]),
    size: [u32; 2],
) -> bool {
    let cut: Vec<_> = pieces.iter().filter(|piece| periodic::is_cut(piece, page.size)).collect();
    let is_plain = |piece: &&DrawingPiece| piece.parts.iter().all(|part| part.paint.gradient.is_none());
    cut.iter().all(is_plain)
        && periodic::is_periodic(&picture::drawn(page, background, cut.into_iter(), size))
}

/// Whether a page whose borders do not join is repeated nevertheless, because too few of its pieces are
/// whole; and the warning about it.
fn repeated_anyway(page: &DrawingPage, pieces: &[DrawingPiece]) -> (bool, Option<String>) {
    let inside = clip::page(page.size);
    let whole = pieces.iter().filter(|p| inside.contains_rect(p.bounds())).count();
    if whole >= FEWEST {
        return (false, None);
    }
    let remark =
        "the borders of the page do not join, but few shapes on it are whole, so vtex reads it as a tile";
    (true, Some(remark.into()))
}
