//! Scenes that `tools/texton/compose.py` has made of photographs.

use std::path::Path;
use vtex::raster::LabelMap;
use vtex_testing::GeneratedExemplar;

/// The scenes of a folder.
pub(crate) struct ComposedScenes {
    images: Vec<u8>,
    labels: Vec<u8>,
}

impl ComposedScenes {
    /// Their side in pixels.
    const SIDE: usize = 224;

    pub(crate) fn read(folder: &Path) -> std::io::Result<Self> {
        let read = |name| std::fs::read(folder.join(name));
        Ok(Self { images: read("images.rgb")?, labels: read("labels.u16")? })
    }

    pub(crate) fn count(&self) -> u64 {
        (self.labels.len() / (2 * Self::SIDE * Self::SIDE)) as u64
    }

    pub(crate) fn scene(&self, index: u64) -> GeneratedExemplar {
        let (index, pixels, side) = (index as usize, Self::SIDE * Self::SIDE, Self::SIDE as u32);
        let image = self.images[3 * index * pixels..][..3 * pixels].to_vec();
        let labels = self.labels[2 * index * pixels..][..2 * pixels].as_chunks::<2>().0;
        let labels = labels.iter().map(|&pair| u16::from_le_bytes(pair).into()).collect();
        GeneratedExemplar {
            image: image::RgbImage::from_raw(side, side, image).expect("as many bytes as pixels"),
            instances: LabelMap { width: side, height: side, labels },
        }
    }
}
