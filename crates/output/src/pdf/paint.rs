//! Gradients and opacity.

use super::content::{ContentStream, PLACE, SHARE, rounded, shares};
use super::file::File;
use pdf_writer::types::{FunctionShadingType, MaskType};
use pdf_writer::writers::{
    ExponentialFunction, ExtGraphicsState, FunctionShading, ShadingPattern, StitchingFunction,
};
use pdf_writer::{Name, Obj, Ref};
use vtex_base::geometry::Rect;
use vtex_scene::element::{GradientKind, Stop};
use vtex_scene::scene::Gradient;

/// Decimals of the offsets of stops.
const OFFSET: u32 = 5;

/// Sets the opacity of later fills.
pub(super) fn set_opacity(content: &mut ContentStream, file: &mut File, opacity: f64) {
    let [opacity] = rounded([opacity], SHARE);
    content.set_opacity(file.add(|object| {
        object.start::<ExtGraphicsState<'_>>().non_stroking_alpha(opacity);
    }));
}

/// Makes later lines translucent.
pub(super) fn set_line_opacity(content: &mut ContentStream, file: &mut File, opacity: f64) {
    let [opacity] = rounded([opacity], SHARE);
    content.set_opacity(file.add(|object| {
        object.start::<ExtGraphicsState<'_>>().stroking_alpha(opacity);
    }));
}

/// Masks later painting by the luminosity of `mask`, a form that is a group.
pub(super) fn set_mask(content: &mut ContentStream, file: &mut File, mask: Ref) {
    content.set_mask(file.add(|object| {
        object.start::<ExtGraphicsState<'_>>().soft_mask().subtype(MaskType::Luminosity).group(mask);
    }));
}

/// Sets the gradient of later fills within `bounds`.
pub(super) fn set_gradient(content: &mut ContentStream, file: &mut File, gradient: &Gradient, bounds: Rect) {
    if gradient.stops().any(|stop| stop.opacity != 1.0) {
        let mut mask = ContentStream::new();
        let opacity = |stop: &Stop| rounded([stop.opacity], SHARE);
        mask.shade(file.add(|object| write_shading(object.start(), gradient, opacity)));
        let mask = mask.group(file, bounds);
        set_mask(content, file, mask);
    }
    let pattern = file.add(|object| {
        let mut pattern: ShadingPattern<'_> = object.start();
        write_shading(pattern.function_shading(), gradient, |stop| shares(stop.colour));
    });
    content.fill_with_pattern(pattern);
}

/// A gradient of grey or RGB; `components` gives those of a stop.
fn write_shading<const N: usize>(
    mut shading: FunctionShading<'_>,
    gradient: &Gradient,
    components: impl Fn(&Stop) -> [f32; N],
) {
    let [[x1, y1], [x2, y2]] = [gradient.from, gradient.to];
    match gradient.kind {
        GradientKind::Linear => {
            shading.shading_type(FunctionShadingType::Axial).coords(rounded([x1, y1, x2, y2], PLACE));
        }
        GradientKind::Radial => {
            let radius = libm::hypot(x2 - x1, y2 - y1);
            let circles = rounded([x1, y1, 0.0, x1, y1, radius], PLACE);
            shading.shading_type(FunctionShadingType::Radial).coords(circles);
        }
    }
    if N == 1 {
        shading.color_space().device_gray()
    } else {
        shading.color_space().device_rgb()
    }
    shading.extend([true; 2]);
    let stops: Vec<_> = gradient.stops().map(|stop| (stop.offset, components(&stop))).collect();
    write_function(shading.insert(Name(b"Function")), &stops);
}

/// A function on 0 to 1 that is linear between stops, each an offset with its components.
fn write_function<const N: usize>(object: Obj<'_>, stops: &[(f64, [f32; N])]) {
    let linear = |object: Obj<'_>, pair: &[(f64, [f32; N])]| {
        object.start::<ExponentialFunction<'_>>().domain([0.0, 1.0]).c0(pair[0].1).c1(pair[1].1).n(1.0);
    };
    let segments: Vec<_> = stops.windows(2).filter(|pair| pair[0].0 < pair[1].0).collect();
    if let [only] = segments[..] {
        return linear(object, only);
    }
    let mut all: StitchingFunction<'_> = object.start();
    all.domain([0.0, 1.0]).bounds(segments.iter().skip(1).map(|pair| rounded([pair[0].0], OFFSET)[0]));
    all.encode([0.0, 1.0].repeat(segments.len()));
    let mut functions = all.insert(Name(b"Functions")).array();
    segments.iter().for_each(|pair| linear(functions.push(), pair));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_bounds_between_segments() {
        let of = |stops: &[(f64, [f32; 1])]| {
            let mut chunk = pdf_writer::Chunk::with_settings(super::super::file::COMPACT);
            write_function(chunk.indirect(Ref::new(1)), stops);
            String::from_utf8(chunk.as_bytes().to_vec()).unwrap()
        };
        let two = of(&[(0.0, [0.0]), (1.0, [1.0])]);
        assert!(two.contains("<</FunctionType 2/Domain[0 1]/C0[0]/C1[1]/N 1>>"), "{two}");
        let step = of(&[(0.0, [0.0]), (0.5, [0.25]), (0.5, [1.0]), (1.0, [1.0])]);
        assert_eq!(step.matches("/FunctionType 2").count(), 2);
        assert!(step.contains("/C1[0.25]") && step.contains("/Bounds[0.5]/Encode[0 1 0 1]"), "{step}");
    }
}
