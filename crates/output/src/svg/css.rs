//! Style rules by which the categories of a file can be recoloured.

use crate::categories::{SceneCategory, class_of};
use std::fmt::Write as _;
use vtex_scene::scene::Scene;

/// One rule for each category, with its name. Nothing is filtered until the custom property `--hue-…` of a
/// category is given a value; `--lightness-…` is 100 % unless it is given one.
pub(super) fn rules(scene: &Scene, categories: &[SceneCategory]) -> String {
    let mut text = String::from("\n/* for example: svg{--hue-1:40deg;--lightness-1:110%} */\n");
    for category in categories {
        let class = class_of(scene, category.library, category.category);
        let number = class.trim_start_matches("category-");
        let _ = writeln!(
            text,
            ".{class}{{filter:hue-rotate(var(--hue-{number})) brightness(var(--lightness-{number},100%))}} /* {} {} */",
            category.name, category.colour
        );
    }
    text
}
