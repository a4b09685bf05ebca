//! Label maps: one label per pixel.

use super::Mask;

/// A row-major map of labels. Their meaning is up to the user; by convention 0 means none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelMap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height` labels, row by row.
    pub labels: Vec<u32>,
}

impl LabelMap {
    /// A map that holds `label` everywhere.
    pub fn filled(width: u32, height: u32, label: u32) -> Self {
        Self { width, height, labels: vec![label; width as usize * height as usize] }
    }

    /// The label at a pixel inside the map.
    pub fn get(&self, x: u32, y: u32) -> u32 {
        self.labels[self.index(x, y)]
    }

    /// Sets the label at a pixel inside the map.
    pub fn set(&mut self, x: u32, y: u32, label: u32) {
        let i = self.index(x, y);
        self.labels[i] = label;
    }

    /// The label at a pixel; `None` outside the map.
    pub fn at(&self, x: i64, y: i64) -> Option<u32> {
        let inside = x >= 0 && y >= 0 && x < i64::from(self.width) && y < i64::from(self.height);
        inside.then(|| self.get(x as u32, y as u32))
    }

    /// The label at a pixel of a canvas of the given size that the map is stretched over.
    pub fn under(&self, at: [u32; 2], canvas: [u32; 2]) -> u32 {
        let own = [self.width, self.height];
        let [x, y] = [0, 1].map(|k| (u64::from(at[k]) * u64::from(own[k]) / u64::from(canvas[k])) as u32);
        self.get(x, y)
    }

    /// The map stretched to another size: each pixel has the label beneath its centre.
    pub fn resized(&self, width: u32, height: u32) -> Self {
        let under = |i: u32, old: u32, new: u32| {
            ((2 * u64::from(i) + 1) * u64::from(old) / (2 * u64::from(new))) as usize
        };
        let columns: Vec<usize> = (0..width).map(|x| under(x, self.width, width)).collect();
        let mut labels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            let row = self.row(under(y, self.height, height) as u32);
            labels.extend(columns.iter().map(|&x| row[x]));
        }
        Self { width, height, labels }
    }

    /// Sets the label of all pixels of a mask that lies inside the map.
    pub fn fill(&mut self, mask: &Mask, label: u32) {
        for s in mask.spans() {
            let start = self.index(s.x0 as u32, s.y as u32);
            self.labels[start..start + s.len() as usize].fill(label);
        }
    }

    /// Whether pixels of two different labels above 0 lie side by side.
    pub fn any_touch(&self) -> bool {
        self.touching().contains(&true)
    }

    /// For each label whether a pixel of it lies beside one of another label above 0. Label 0 touches none.
    pub fn touching(&self) -> Vec<bool> {
        let largest = self.labels.iter().copied().max().unwrap_or(0);
        let mut touching = vec![false; largest as usize + 1];
        let mut compare = |a: u32, b: u32| {
            if a > 0 && b > 0 && a != b {
                touching[a as usize] = true;
                touching[b as usize] = true;
            }
        };
        for y in 0..self.height {
            let row = self.row(y);
            row.windows(2).for_each(|w| compare(w[0], w[1]));
            if y > 0 {
                self.row(y - 1).iter().zip(row).for_each(|(a, b)| compare(*a, *b));
            }
        }
        touching
    }

    /// Index of a pixel in [`LabelMap::labels`].
    pub fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// One row of labels.
    pub fn row(&self, y: u32) -> &[u32] {
        let w = self.width as usize;
        &self.labels[y as usize * w..][..w]
    }

    /// Number of pixels with each label, from 0 to the largest label.
    pub fn areas(&self) -> Vec<u32> {
        let largest = self.labels.iter().copied().max().unwrap_or(0);
        let mut areas = vec![0; largest as usize + 1];
        for &label in &self.labels {
            areas[label as usize] += 1;
        }
        areas
    }
}
