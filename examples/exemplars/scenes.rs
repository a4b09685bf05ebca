// The scenes kept as PNG in this folder, by file name; shared by the example and the test.

use vtex::procedural::{Kind, SceneParams};

/// Name and parameters of every finished scene.
pub fn finished() -> Vec<(&'static str, SceneParams)> {
    let scene = |kind, seed, size, coverage| SceneParams {
        kind,
        seed,
        size,
        coverage,
        blur: 0.6,
        noise: 1.0,
        ..SceneParams::default()
    };
    vec![
        ("terrazzo", scene(Kind::Terrazzo, 1, 56.0, 0.5)),
        ("pebbles", scene(Kind::Pebbles, 1, 60.0, 0.6)),
        ("leaves", scene(Kind::Leaves, 1, 64.0, 0.5)),
        ("flowers", scene(Kind::Flowers, 1, 56.0, 0.2)),
        ("concrete", scene(Kind::Concrete, 1, 48.0, 0.2)),
    ]
}
