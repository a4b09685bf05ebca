//! Properties of generated scenes.

use super::*;
