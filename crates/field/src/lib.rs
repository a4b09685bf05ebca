//! Correspondence fields and what is made with them: layer maps and pixel-based textures.

pub mod correspondence;
pub mod layers;
pub mod pixels;

#[cfg(test)]
mod photographs;
