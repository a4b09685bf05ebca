//! Canvas cells with the same source.

use super::atlas::Atlas;
use super::canvas::Canvas;

/// Distance over which copies count, as a share of the shorter side of the smallest page.
const REACH: f32 = 0.6;

/// The canvas cells of each source.
pub(super) struct Copies {
    starts: Vec<u32>,
    cells: Vec<u32>,
    size: [usize; 2],
    wrap: [bool; 2],
    /// In cells.
    reach: f32,
}

impl Copies {
    pub(super) fn new(canvas: &Canvas, atlas: &Atlas) -> Self {
        let shortest = atlas.pages.iter().flat_map(|p| p.size).min().unwrap_or(1);
        let mut starts = vec![0; atlas.inside.len() + 1];
        let active = || (0..canvas.sources.len()).filter(|&i| canvas.is_active(i));
        active().for_each(|i| starts[canvas.sources[i] as usize + 1] += 1);
        (1..starts.len()).for_each(|s| starts[s] += starts[s - 1]);
        let mut next = starts.clone();
        let mut cells = vec![0; starts[starts.len() - 1] as usize];
        for i in active() {
            let place = &mut next[canvas.sources[i] as usize];
            cells[*place as usize] = i as u32;
            *place += 1;
        }
        Self { starts, cells, size: canvas.size, wrap: canvas.wrap, reach: REACH * shortest as f32 }
    }

    /// Proximity of the nearest earlier cell with the same source: 1 at the same place, 0 out of reach.
    /// Only earlier cells count, so that one of two copies gives way.
    pub(super) fn nearness(&self, source: u32, cell: usize) -> f32 {
        let list = self.starts[source as usize] as usize..self.starts[source as usize + 1] as usize;
        let before = self.cells[list].iter().map(|&q| q as usize).take_while(|&q| q < cell);
        let away = |q: usize, k: usize| {
            let place = |i: usize| if k == 0 { i % self.size[0] } else { i / self.size[0] };
            let d = place(q).abs_diff(place(cell));
            if self.wrap[k] { d.min(self.size[k] - d) } else { d }
        };
        let squares = before.map(|q| away(q, 0) * away(q, 0) + away(q, 1) * away(q, 1));
        let nearest = squares.min().map_or(f32::INFINITY, |d2| libm::sqrtf(d2 as f32));
        (1.0 - nearest / self.reach).max(0.0)
    }
}
