//! How much of a picture each detail and each secondary is, by the bytes it takes.
//!
//! A patch is seen as much as its area times the Oklab distance of its colour from what would be seen
//! in its place; a detail in all instances of its texton, which share its bytes. What hides a part of
//! it is not regarded. Counted by byte, not by piece, a file of the same size is nearer to the whole:
//! mean difference 3.7 instead of 4.3 at three fifths of a texture of grass, 0.96 instead of 1.22 at
//! two thirds of one of stones.

use crate::geometry::{Outline, PathText, Rect, write_path};
use crate::raster::colour::{Colour, oklab};
use crate::scene::field::Interpolant;
use crate::scene::{Patch, Scene, Texton};

/// About how many bytes a reference to a texton takes, with place and colour.
const REFERENCE: f64 = 50.0;

/// The order in which details and secondaries can be left out.
pub(super) struct Ranks {
    /// By texton and detail.
    details: Vec<Vec<usize>>,
    secondaries: Vec<usize>,
    /// How many instances of each texton there are among the primaries and secondaries.
    uses: Vec<usize>,
    count: usize,
}

impl Ranks {
    pub(super) fn new(scene: &Scene) -> Self {
        // How often each texton stands, and how large all these are together.
        let mut sizes = vec![0.0; scene.textons.len()];
        let mut uses = vec![0; scene.textons.len()];
        for instance in scene.primary.iter().chain(&scene.secondary) {
            sizes[instance.texton as usize] += instance.affine().determinant().abs();
            uses[instance.texton as usize] += 1;
        }
        let mut all: Vec<(f64, Place)> = Vec::new();
        for (t, texton) in scene.textons.iter().enumerate() {
            for (d, detail) in texton.details.iter().enumerate() {
                let seen = sizes[t] * detail.outline.area() * distance(detail.colour, beneath(texton, d));
                all.push((seen / bytes(&detail.outline), Place::Detail(t, d)));
            }
        }
        let own_bytes: Vec<f64> = (scene.textons.iter().zip(&uses))
            .map(|(texton, &uses)| {
                let whole = bytes(&texton.outline);
                if uses > 1 { REFERENCE + whole / uses as f64 } else { whole }
            })
            .collect();
        let field = Interpolant::new(&scene.background, scene.width, scene.height, scene.tile);
        for (i, instance) in scene.secondary.iter().enumerate() {
            let texton = &scene.textons[instance.texton as usize];
            let affine = instance.affine();
            let at = affine * texton.outline.bounds().center();
            let ground = Colour::from_f64(field.at(at.x, at.y));
            let contrast = distance(instance.colour.unwrap_or(texton.colour), ground);
            let area = texton.outline.area() * affine.determinant().abs();
            // With details it is more than its base; it goes only after these.
            let own: f64 = texton.details.iter().map(|p| p.outline.area() * distance(p.colour, ground)).sum();
            let bytes = own_bytes[instance.texton as usize];
            all.push(((area * contrast + own) / bytes, Place::Secondary(i)));
        }
        // The sort is stable: ties stay in the order of the scene.
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut ranks = Self {
            details: scene.textons.iter().map(|t| vec![0; t.details.len()]).collect(),
            secondaries: vec![0; scene.secondary.len()],
            uses,
            count: all.len(),
        };
        for (rank, (_, place)) in all.into_iter().enumerate() {
            match place {
                Place::Detail(t, d) => ranks.details[t][d] = rank,
                Place::Secondary(i) => ranks.secondaries[i] = rank,
            }
        }
        ranks
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Takes the first `count` out of a scene with the same textons and instances. Gives the numbers
    /// of details, on all instances, and of secondaries.
    pub(super) fn leave_out(&self, scene: &mut Scene, count: usize) -> (usize, usize) {
        let mut details = 0;
        for ((texton, ranks), uses) in scene.textons.iter_mut().zip(&self.details).zip(&self.uses) {
            let before = texton.details.len();
            keep(&mut texton.details, ranks, count);
            details += (before - texton.details.len()) * uses;
        }
        let before = scene.secondary.len();
        keep(&mut scene.secondary, &self.secondaries, count);
        (details, before - scene.secondary.len())
    }
}

enum Place {
    Detail(usize, usize),
    Secondary(usize),
}

/// Keeps the items whose rank is `count` or more.
fn keep<T>(items: &mut Vec<T>, ranks: &[usize], count: usize) {
    let mut ranks = ranks.iter();
    items.retain(|_| ranks.next().is_some_and(|&rank| rank >= count));
}

/// The colour that would be seen in place of a detail: that of the last one before it that it lies
/// in as a whole, else that of the base.
fn beneath(texton: &Texton, detail: usize) -> Colour {
    let bounds = texton.details[detail].outline.bounds();
    let contains = |outer: Rect| {
        outer.x0 <= bounds.x0 && outer.y0 <= bounds.y0 && outer.x1 >= bounds.x1 && outer.y1 >= bounds.y1
    };
    let holds = |p: &&Patch| {
        contains(p.outline.bounds()) && kurbo::Shape::winding(p.outline.path(), bounds.center()) != 0
    };
    texton.details[..detail].iter().rev().find(holds).map_or(texton.colour, |p| p.colour)
}

/// About how many bytes of an SVG a path takes.
fn bytes(outline: &Outline) -> f64 {
    const AROUND: usize = 30;
    (write_path(outline.path(), PathText { precision: 1 }).len() + AROUND) as f64
}

/// Oklab distance: 1 from black to white.
fn distance(a: Colour, b: Colour) -> f64 {
    let (a, b) = (oklab(a.0), oklab(b.0));
    libm::sqrt((0..3).map(|c| f64::from(a[c] - b[c])).map(|d| d * d).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::testing;

    #[test]
    fn specks_like_their_ground_go_first_and_contrast_last() {
        let mut scene = testing::scene(300, 200, 3);
        let used =
            scene.primary.iter().map(|i| i.texton as usize).find(|&t| scene.textons[t].details.len() > 3);
        let texton = used.unwrap();
        let base = scene.textons[texton].colour;
        scene.textons[texton].details[1].colour = base;
        scene.textons[texton].details[2].colour = Colour([255, 0, 255]);
        scene.textons[texton].details[2].outline = scene.textons[texton].outline.clone();
        let ranks = Ranks::new(&scene);
        let mut few = scene.clone();
        let invisible = few.textons[texton].details[1].clone();
        let loud = few.textons[texton].details[2].clone();
        let (details, secondaries) = ranks.leave_out(&mut few, ranks.len() / 2);
        assert!(details > 0 && secondaries > 0);
        assert!(!few.textons[texton].details.contains(&invisible));
        assert!(few.textons[texton].details.contains(&loud));
        let (_, all) = ranks.leave_out(&mut scene, ranks.len());
        assert_eq!(all, ranks.secondaries.len());
        assert!(scene.textons.iter().all(|t| t.details.is_empty()) && scene.secondary.is_empty());
    }

    #[test]
    fn a_detail_on_a_detail_is_compared_with_that() {
        let mut texton = testing::scene(50, 50, 4).textons.swap_remove(0);
        let mut patch = texton.details[0].clone();
        patch.outline = texton.outline.clone();
        patch.colour = Colour([10, 20, 30]);
        texton.details = vec![patch.clone(), patch];
        assert_eq!(beneath(&texton, 0), texton.colour);
        assert_eq!(beneath(&texton, 1), Colour([10, 20, 30]));
    }
}
