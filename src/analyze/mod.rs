//! Image → library: primaries, details, secondaries, categories, descriptors, palette.
