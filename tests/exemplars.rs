//! The generator still makes exactly the exemplars kept in `examples/exemplars`.

use std::path::Path;

#[path = "../examples/exemplars/scenes.rs"]
mod scenes;

#[test]
fn exemplars_are_what_the_generator_makes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exemplars");
    for (name, params) in scenes::finished() {
        let path = folder.join(format!("{name}.png"));
        let kept = image::open(&path).unwrap().to_rgb8();
        assert_eq!(kept.dimensions(), (512, 512), "{name}");
        let made = scenes::picture(&params).unwrap();
        let differing = kept.pixels().zip(made.pixels()).filter(|(a, b)| a != b).count();
        assert_eq!(
            differing, 0,
            "{name}: pixels differ; if meant, make them anew with \
             'cargo run --release --example make_exemplars -- examples/exemplars'"
        );
        assert!(std::fs::metadata(&path).unwrap().len() < 400_000, "{name}.png is too large");
    }
}
