//! The content of the files that operations name.

use std::collections::BTreeMap;
use vtex_base::error::{EditFault, Result};
use vtex_base::geometry::Interior;
use vtex_base::raster::{ControlMap, is_picture};
use vtex_drawing::control::{self, ColourMap};
use vtex_drawing::import;
use vtex_scene::library::Library;
use vtex_scene::scene::{Action, ColourOrMap, Condition, Direction, NumberOrMap, Operation, Shape};

/// Files that operations need, by the names in the operations.
#[derive(Clone, Debug, Default)]
pub struct Files {
    /// Grey maps, 0 to 1.
    pub maps: BTreeMap<String, ControlMap>,
    /// Maps of colours.
    pub colours: BTreeMap<String, ColourMap>,
    /// Insides of the shapes of `mask` and of conditions, in pixels of the canvas.
    pub shapes: BTreeMap<String, Interior>,
    /// Shapes of drawings, in pixels of the canvas.
    pub drawings: BTreeMap<String, Vec<Shape>>,
    /// Libraries of `replace`.
    pub libraries: BTreeMap<String, Library>,
}

impl Files {
    /// Loads every file that `operations` name, for a canvas of the given size in pixels; `read` maps a
    /// file's name to its bytes.
    ///
    /// # Errors
    /// Those of `read`, and of a file whose content is not of the expected kind.
    pub fn read(
        operations: &[Operation],
        canvas: [u32; 2],
        mut read: impl FnMut(&str) -> Result<Vec<u8>>,
    ) -> Result<Self> {
        let mut files = Self::default();
        for Operation { action, conditions, .. } in operations {
            for condition in conditions {
                if let Condition::Place { shape, .. } = condition {
                    files.shapes.insert(shape.clone(), region(&read(shape)?, shape, canvas)?);
                }
            }
            match action {
                Action::Density { map }
                | Action::Orient { direction: Direction::Map(map), .. }
                | Action::Scale { factor: NumberOrMap::Map(map) }
                | Action::Rotate { angle: NumberOrMap::Map(map) } => files.add_map(map, &mut read)?,
                Action::Vary { colour, shape, .. } => {
                    for number in [colour, shape].into_iter().flatten() {
                        if let NumberOrMap::Map(map) = number {
                            files.add_map(map, &mut read)?;
                        }
                    }
                }
                Action::Tint { colour: ColourOrMap::Map(map), .. } => {
                    files.colours.insert(map.clone(), control::colours(&read(map)?, map)?);
                }
                Action::Propagate { drawing, element, .. } => {
                    for file in [drawing, element].into_iter().flatten() {
                        let shapes = import::drawn(&read(file)?, file, canvas)?;
                        files.drawings.insert(file.clone(), shapes);
                    }
                }
                Action::Mask { shape, .. } => {
                    files.shapes.insert(shape.clone(), region(&read(shape)?, shape, canvas)?);
                }
                Action::Replace { library } => {
                    files.libraries.insert(library.clone(), Library::from_bytes(read(library)?, library)?);
                }
                Action::Thin { .. }
                | Action::Orient { .. }
                | Action::Tint { .. }
                | Action::Recolor { .. }
                | Action::Palette { .. }
                | Action::Shadow { .. }
                | Action::Flatten
                | Action::Simplify { .. }
                | Action::Outline { .. }
                | Action::Hatch { .. }
                | Action::Move { .. }
                | Action::Scale { .. }
                | Action::Rotate { .. }
                | Action::Transform { .. }
                | Action::Jitter(_)
                | Action::Shuffle { .. }
                | Action::Relax { .. }
                | Action::Order { .. }
                | Action::Delete => {}
            }
        }
        Ok(files)
    }

    fn add_map(&mut self, name: &str, read: &mut impl FnMut(&str) -> Result<Vec<u8>>) -> Result<()> {
        self.maps.insert(name.to_owned(), control::level(&read(name)?, name)?);
        Ok(())
    }

    pub(super) fn colours(&self, name: &str) -> Result<&ColourMap, EditFault> {
        self.colours.get(name).ok_or_else(|| EditFault::NoFile(name.to_owned()))
    }

    pub(super) fn drawing(&self, name: &str) -> Result<&[Shape], EditFault> {
        self.drawings.get(name).map(Vec::as_slice).ok_or_else(|| EditFault::NoFile(name.to_owned()))
    }

    pub(super) fn map(&self, name: &str) -> Result<&ControlMap, EditFault> {
        self.maps.get(name).ok_or_else(|| EditFault::NoFile(name.to_owned()))
    }

    pub(super) fn shape(&self, name: &str) -> Result<&Interior, EditFault> {
        self.shapes.get(name).ok_or_else(|| EditFault::NoFile(name.to_owned()))
    }

    pub(super) fn library(&self, name: &str) -> Result<&Library, EditFault> {
        self.libraries.get(name).ok_or_else(|| EditFault::NoFile(name.to_owned()))
    }
}

/// The inside of the shape of an SVG, or of the white parts of a picture.
fn region(bytes: &[u8], name: &str, canvas: [u32; 2]) -> Result<Interior> {
    let picture = is_picture(bytes);
    let outline =
        if picture { control::mask(bytes, name, canvas)? } else { control::shape(bytes, name, canvas)? };
    Ok(Interior::new(&outline))
}
