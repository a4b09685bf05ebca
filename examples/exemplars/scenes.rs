// The scenes kept as PNG in this folder; shared by the example that makes them and the test that
// compares them.

use image::RgbImage;
use vtex_testing::{SceneKind, SceneParams, generate};

/// File name and parameters of every scene.
pub(crate) fn finished() -> Vec<(&'static str, SceneParams)> {
    let scene = |kind, seed, size, coverage| SceneParams {
        kind,
        seed,
        size,
        coverage,
        blur: 0.6,
        noise: 0.8,
        ..SceneParams::default()
    };
    vec![
        ("terrazzo", scene(SceneKind::Terrazzo, 1, 56.0, 0.5)),
        ("pebbles", scene(SceneKind::Pebbles, 5, 60.0, 0.72)),
        ("leaves", scene(SceneKind::Leaves, 3, 84.0, 0.5)),
        ("flowers", scene(SceneKind::Flowers, 5, 60.0, 0.22)),
        ("concrete", scene(SceneKind::Concrete, 2, 56.0, 0.25)),
    ]
}

/// The picture of a scene with 64 levels per channel. The difference is invisible, and the PNG is a
/// third smaller.
pub(crate) fn picture(params: &SceneParams) -> vtex::Result<RgbImage> {
    let mut image = generate(params)?.image;
    for value in image.iter_mut() {
        let tone = *value / 4;
        *value = tone * 4 + tone / 16;
    }
    Ok(image)
}
