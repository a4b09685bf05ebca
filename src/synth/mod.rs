//! Library → scene: target map, scoring, density, secondaries, background.
