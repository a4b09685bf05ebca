//! Gradients and opacity.

use super::content::{ContentStream, numbers, shares};
use super::file::{File, Ref};
use std::fmt::Write;
use std::io::Result;
use vtex_base::geometry::Rect;
use vtex_scene::element::{GradientKind, Stop};
use vtex_scene::scene::Gradient;

/// Decimals of the coordinates of gradients.
const PLACE: u32 = 3;
/// Decimals of the offsets of stops.
const OFFSET: u32 = 5;
/// Decimals of colours and opacities.
const SHARE: u32 = 3;

/// Sets the opacity of later fills.
pub(super) fn set_opacity(content: &mut ContentStream, file: &mut File, opacity: f64) {
    let mut object = String::from("<</Type /ExtGState/ca ");
    numbers(&mut object, [opacity], SHARE);
    object.pop();
    content.set_opacity(file.add(object + ">>"));
}

/// Makes later lines translucent.
pub(super) fn set_line_opacity(content: &mut ContentStream, file: &mut File, opacity: f64) {
    let mut object = String::from("<</Type /ExtGState/CA ");
    numbers(&mut object, [opacity], SHARE);
    object.pop();
    content.set_opacity(file.add(object + ">>"));
}

/// Masks later painting by the luminosity of `mask`, a form that is a group.
pub(super) fn set_mask(content: &mut ContentStream, file: &mut File, mask: Ref) {
    let object = format!("<</Type /ExtGState/SMask <</Type /Mask/S /Luminosity/G {mask}>>>>");
    content.set_mask(file.add(object));
}

/// Sets the gradient of later fills within `bounds`.
///
/// # Errors
/// Those of packing.
pub(super) fn set_gradient(
    content: &mut ContentStream,
    file: &mut File,
    gradient: &Gradient,
    bounds: Rect,
) -> Result<()> {
    if gradient.stops().any(|stop| stop.opacity != 1.0) {
        let mut mask = ContentStream::default();
        mask.shade(file.add(shading(gradient, "DeviceGray", |stop| [stop.opacity])));
        let mask = mask.group(file, bounds)?;
        set_mask(content, file, mask);
    }
    let shading = shading(gradient, "DeviceRGB", |stop| shares(stop.colour));
    let pattern = file.add(format!("<</Type /Pattern/PatternType 2/Shading {shading}>>"));
    content.fill_with_pattern(pattern);
    Ok(())
}

/// The shading dictionary of a gradient in a colour space; `components` gives those of a stop.
fn shading<const N: usize>(
    gradient: &Gradient,
    space: &str,
    components: impl Fn(&Stop) -> [f64; N],
) -> String {
    let [[x1, y1], [x2, y2]] = [gradient.from, gradient.to];
    let mut coordinates = String::new();
    let kind = match gradient.kind {
        GradientKind::Linear => {
            numbers(&mut coordinates, [x1, y1, x2, y2], PLACE);
            2
        }
        GradientKind::Radial => {
            numbers(&mut coordinates, [x1, y1, 0.0, x1, y1, libm::hypot(x2 - x1, y2 - y1)], PLACE);
            3
        }
    };
    let function =
        function(&gradient.stops().map(|stop| (stop.offset, components(&stop))).collect::<Vec<_>>());
    format!(
        "<</ShadingType {kind}/ColorSpace /{space}/Coords [{}]/Function {function}/Extend [true true]>>",
        coordinates.trim_end()
    )
}

/// The dictionary of a function on 0 to 1 that is linear between stops, each an offset with its components.
fn function<const N: usize>(stops: &[(f64, [f64; N])]) -> String {
    let segments: Vec<_> = stops.windows(2).filter(|pair| pair[0].0 < pair[1].0).collect();
    let mut functions = segments.iter().map(|pair| {
        let [mut c0, mut c1] = [String::new(), String::new()];
        numbers(&mut c0, pair[0].1, SHARE);
        numbers(&mut c1, pair[1].1, SHARE);
        format!("<</FunctionType 2/Domain [0 1]/N 1/C0 [{}]/C1 [{}]>>", c0.trim_end(), c1.trim_end())
    });
    if segments.len() < 2 {
        return functions.next().unwrap_or_default();
    }
    let functions: String = functions.collect();
    let (mut bounds, mut encode) = (String::new(), String::new());
    for (k, pair) in segments.iter().enumerate() {
        if k > 0 {
            numbers(&mut bounds, [pair[0].0], OFFSET);
        }
        let _ = write!(encode, "0 1 ");
    }
    let (bounds, encode) = (bounds.trim_end(), encode.trim_end());
    format!("<</FunctionType 3/Domain [0 1]/Functions [{functions}]/Bounds [{bounds}]/Encode [{encode}]>>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_bounds_between_segments() {
        let two = function(&[(0.0, [0.0]), (1.0, [1.0])]);
        assert_eq!(two, "<</FunctionType 2/Domain [0 1]/N 1/C0 [0]/C1 [1]>>");
        let step = function(&[(0.0, [0.0]), (0.5, [0.25]), (0.5, [1.0]), (1.0, [1.0])]);
        assert_eq!(step.matches("/FunctionType 2").count(), 2);
        assert!(step.contains("/C1 [.25]") && step.contains("/Bounds [.5]/Encode [0 1 0 1]"), "{step}");
    }
}
