//! Tree-structured vector quantisation: a codebook with logarithmic search time (Wei and Levoy,
//! "Deterministic Texture Analysis and Synthesis using Tree Structure Vector Quantization").

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};
use vtex_base::error::Result;

/// Lloyd iterations of a split.
const LLOYD: usize = 10;
/// Power iterations for the principal axis of a split.
const POWER: usize = 5;

/// Most vectors of a leaf that are compared.
const MOST_COMPARED: usize = 2048;

/// A node: the mean of its vectors, and either two child nodes or the vectors themselves.
struct CodebookNode {
    /// Index of the first component of its mean.
    mean: usize,
    children: Option<[u32; 2]>,
    /// Once the tree is made, those among which the nearest is sought.
    members: Vec<u32>,
}

/// A tree of vectors.
pub(super) struct Codebook {
    /// Number of components of a vector.
    pub(super) length: usize,
    means: Vec<f32>,
    nodes: Vec<CodebookNode>,
    leaves: usize,
}

/// Components that are summed side by side.
const LANES: usize = 8;

/// Squared distance of two vectors.
#[inline]
pub(super) fn distance(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0f32; LANES];
    let (mut left, mut right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    for (a, b) in left.by_ref().zip(right.by_ref()) {
        (0..LANES).for_each(|k| sums[k] += (a[k] - b[k]) * (a[k] - b[k]));
    }
    let rest = left.remainder().iter().zip(right.remainder());
    rest.map(|(a, b)| (a - b) * (a - b)).sum::<f32>() + sums.iter().sum::<f32>()
}

/// Squared distance of two vectors in the components that are known: 1 or 0 for each; all without `known`.
#[inline]
pub(super) fn distance_of_known(a: &[f32], b: &[f32], known: Option<&[f32]>) -> f32 {
    let Some(known) = known else { return distance(a, b) };
    let mut sums = [0f32; LANES];
    let mut all = (a.chunks_exact(LANES), b.chunks_exact(LANES), known.chunks_exact(LANES));
    for ((a, b), known) in all.0.by_ref().zip(all.1.by_ref()).zip(all.2.by_ref()) {
        (0..LANES).for_each(|k| sums[k] += (a[k] - b[k]) * (a[k] - b[k]) * known[k]);
    }
    let rest = all.0.remainder().iter().zip(all.1.remainder()).zip(all.2.remainder());
    rest.map(|((a, b), known)| (a - b) * (a - b) * known).sum::<f32>() + sums.iter().sum::<f32>()
}

impl Codebook {
    /// A codebook of at most `leaves` leaves. `vectors` holds vectors of `length` components, one after the
    /// other. The leaf with the largest distortion is split until there are enough. `go_on` may stop the
    /// work.
    pub(super) fn new(
        vectors: &[f32],
        length: usize,
        leaves: usize,
        go_on: &mut dyn FnMut() -> Result<()>,
    ) -> Result<Self> {
        let all: Vec<u32> = (0..(vectors.len() / length) as u32).collect();
        let mut book = Self { length, means: Vec::new(), nodes: Vec::new(), leaves: 1 };
        let mut queue = BinaryHeap::new();
        let distortion = book.add(vectors, all);
        queue.push((distortion, Reverse(0u32)));
        while book.leaves < leaves {
            let Some((distortion, Reverse(worst))) = queue.pop() else { break };
            if distortion == 0 {
                break;
            }
            let members = std::mem::take(&mut book.nodes[worst as usize].members);
            let Some([left, right]) = book.split(vectors, worst, &members, go_on)? else {
                book.nodes[worst as usize].members = members;
                continue;
            };
            let first = book.nodes.len() as u32;
            for (k, part) in [left, right].into_iter().enumerate() {
                let distortion = book.add(vectors, part);
                queue.push((distortion, Reverse(first + k as u32)));
            }
            book.nodes[worst as usize].children = Some([first, first + 1]);
            book.leaves += 1;
        }
        for node in 0..book.nodes.len() {
            book.nodes[node].members = book.differing(vectors, &book.nodes[node].members);
        }
        Ok(book)
    }

    /// The different vectors among `members`, sampled evenly if there are more than [`MOST_COMPARED`]. In a
    /// picture of almost one colour, one leaf holds nearly all vectors.
    fn differing(&self, vectors: &[f32], members: &[u32]) -> Vec<u32> {
        let mut seen: HashSet<Vec<u32>> = HashSet::new();
        let bits = |m: u32| vectors[m as usize * self.length..][..self.length].iter().map(|v| v.to_bits());
        let first: Vec<u32> = members.iter().copied().filter(|&m| seen.insert(bits(m).collect())).collect();
        let step = first.len().div_ceil(MOST_COMPARED).max(1);
        first.into_iter().step_by(step).collect()
    }

    /// Adds a leaf. Returns the bits of its distortion, which sort like its value.
    fn add(&mut self, vectors: &[f32], members: Vec<u32>) -> u64 {
        let length = self.length;
        let of = |m: u32| &vectors[m as usize * length..][..length];
        let mut sum = vec![0f64; length];
        for &m in &members {
            sum.iter_mut().zip(of(m)).for_each(|(s, v)| *s += f64::from(*v));
        }
        let mean = self.means.len();
        self.means.extend(sum.iter().map(|s| (s / members.len().max(1) as f64) as f32));
        let middle = &self.means[mean..];
        let distortion: f64 = members.iter().map(|&m| f64::from(distance(of(m), middle))).sum();
        self.nodes.push(CodebookNode { mean, children: None, members });
        distortion.to_bits()
    }

    fn mean(&self, node: u32) -> &[f32] {
        &self.means[self.nodes[node as usize].mean..][..self.length]
    }

    /// Splits the vectors of a leaf by 2-means along their principal axis; `None` if a part stays empty.
    fn split(
        &self,
        vectors: &[f32],
        node: u32,
        members: &[u32],
        go_on: &mut dyn FnMut() -> Result<()>,
    ) -> Result<Option<[Vec<u32>; 2]>> {
        let length = self.length;
        let of = |m: u32| &vectors[m as usize * length..][..length];
        let mean = self.mean(node);
        // The axis starts towards the vector farthest from the mean.
        let far = members.iter().copied().fold(None, |best: Option<(f32, u32)>, m| {
            let d = distance(of(m), mean);
            if best.is_none_or(|b| d > b.0) { Some((d, m)) } else { best }
        });
        let Some(far) = far else { return Ok(None) };
        let mut axis: Vec<f32> = of(far.1).iter().zip(mean).map(|(v, m)| v - m).collect();
        let mut size = 0.0;
        for _ in 0..POWER {
            go_on()?;
            let mut next = vec![0f32; length];
            for &m in members {
                let along: f32 = of(m).iter().zip(mean).zip(&axis).map(|((v, c), a)| (v - c) * a).sum();
                next.iter_mut().zip(of(m).iter().zip(mean)).for_each(|(n, (v, c))| *n += along * (v - c));
            }
            size = libm::sqrtf(next.iter().map(|v| v * v).sum());
            if size <= 0.0 {
                return Ok(None);
            }
            axis = next.into_iter().map(|v| v / size).collect();
        }
        let step = libm::sqrtf(size / members.len() as f32);
        let mut centres = [-0.5, 0.5]
            .map(|side: f32| mean.iter().zip(&axis).map(|(c, a)| c + side * step * a).collect::<Vec<f32>>());
        let mut parts: [Vec<u32>; 2] = Default::default();
        for _ in 0..LLOYD {
            go_on()?;
            let mut now: [Vec<u32>; 2] = Default::default();
            for &m in members {
                let nearer = distance(of(m), &centres[1]) < distance(of(m), &centres[0]);
                now[usize::from(nearer)].push(m);
            }
            if now.iter().any(Vec::is_empty) {
                return Ok(None);
            }
            if now == parts {
                break;
            }
            parts = now;
            for (centre, part) in centres.iter_mut().zip(&parts) {
                let mut sum = vec![0f64; length];
                for &m in part {
                    sum.iter_mut().zip(of(m)).for_each(|(s, v)| *s += f64::from(*v));
                }
                *centre = sum.iter().map(|s| (s / part.len() as f64) as f32).collect();
            }
        }
        Ok(Some(parts))
    }

    /// The vector of the nearest leaf that costs least, and its cost: `cost` of the vector and its distance in
    /// the components that are known (1 or 0 for each; all without `known`). Ties go to the first.
    pub(super) fn search(
        &self,
        vectors: &[f32],
        vector: &[f32],
        known: Option<&[f32]>,
        cost: impl Fn(u32, f32) -> f32,
    ) -> (u32, f32) {
        let far = |to: &[f32]| distance_of_known(vector, to, known);
        let mut node = 0;
        while let Some([left, right]) = self.nodes[node as usize].children {
            node = if far(self.mean(right)) < far(self.mean(left)) { right } else { left };
        }
        let mut best = (0, f32::INFINITY);
        for &m in &self.nodes[node as usize].members {
            let cost = cost(m, far(&vectors[m as usize * self.length..][..self.length]));
            if cost < best.1 {
                best = (m, cost);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::{Stream, stream};

    const LENGTH: usize = 12;

    /// Vectors around forty centres.
    fn vectors(count: usize, seed: u64) -> Vec<f32> {
        let mut centres = stream(1, "tsvq test centres", 0);
        let centres: Vec<f32> = (0..40 * LENGTH).map(|_| centres.normal() as f32 * 2.0).collect();
        let mut random: Stream = stream(seed, "tsvq test", 0);
        let mut all = Vec::new();
        for _ in 0..count {
            let c = random.index(40) * LENGTH;
            all.extend((0..LENGTH).map(|k| centres[c + k] + random.normal() as f32 * 0.5));
        }
        all
    }

    fn book(vectors: &[f32], length: usize, leaves: usize) -> Codebook {
        Codebook::new(vectors, length, leaves, &mut || Ok(())).unwrap()
    }

    /// The leaf of a vector, and the number of distances that lead to it.
    fn encode(book: &Codebook, vector: &[f32]) -> (u32, u32) {
        let (mut node, mut compared) = (0, 0);
        while let Some([left, right]) = book.nodes[node as usize].children {
            let nearer = distance(vector, book.mean(right)) < distance(vector, book.mean(left));
            (node, compared) = (if nearer { right } else { left }, compared + 2);
        }
        (node, compared)
    }

    fn distortion(book: &Codebook, vectors: &[f32]) -> f64 {
        vectors.chunks(LENGTH).map(|v| f64::from(distance(v, book.mean(encode(book, v).0)))).sum()
    }

    #[test]
    fn a_leaf_of_nearly_all_vectors_costs_no_more_than_others() {
        // A picture near white: nearly all vectors are similar, few of them equal, and a few are distant.
        let mut random: Stream = stream(1, "tsvq test", 1);
        let mut near: Vec<f32> = (0..20_000 * LENGTH).map(|_| 1.0 - random.unit() as f32 * 1e-3).collect();
        near.extend((0..7 * LENGTH).map(|k| -((k / LENGTH) as f32)));
        let white = vec![1.0; 20_000 * LENGTH];
        for (vectors, most) in [(&near, MOST_COMPARED), (&white, 1)] {
            let book = book(vectors, LENGTH, 8);
            let largest = book.nodes.iter().map(|node| node.members.len()).max().unwrap();
            assert!(largest <= most, "{largest}");
            let found = book.search(vectors, &vectors[..LENGTH], None, |_, d| d).0 as usize;
            assert!(distance(&vectors[found * LENGTH..][..LENGTH], &vectors[..LENGTH]) < 1e-4);
        }
    }

    #[test]
    fn more_leaves_are_nearer_and_cost_a_logarithm() {
        let (known, held) = (vectors(4000, 1), vectors(500, 2));
        let mut last = f64::INFINITY;
        for leaves in [1, 16, 64, 512] {
            let book = book(&known, LENGTH, leaves);
            assert_eq!(book.leaves, leaves);
            let own = distortion(&book, &known);
            assert!(own < last, "{leaves}: {own} {last}");
            last = own;
            let asked: u32 = held.chunks(LENGTH).map(|v| encode(&book, v).1).sum();
            let mean = f64::from(asked) / 500.0;
            assert!(mean <= 3.0 * libm::log2(leaves as f64).max(0.0) + 1e-9, "{leaves}: {mean}");
            let full: f64 = held
                .chunks(LENGTH)
                .map(|v| {
                    let leaf = |n: &CodebookNode| distance(v, &book.means[n.mean..][..LENGTH]);
                    let all = book.nodes.iter().filter(|n| n.children.is_none()).map(leaf);
                    f64::from(all.fold(f32::INFINITY, f32::min))
                })
                .sum();
            assert!(distortion(&book, &held) <= 1.5 * full, "{leaves}: {} {full}", distortion(&book, &held));
        }
    }

    #[test]
    fn all_leaves_of_equal_vectors_are_one() {
        assert_eq!(book(&[1.0; 40], 4, 8).leaves, 1);
        let two = book(&[0.0, 0.0, 1.0, 1.0], 2, 8);
        assert_eq!(two.leaves, 2);
        let search = |vector: [f32; 2], known| two.search(&[0.0, 0.0, 1.0, 1.0], &vector, known, |_, d| d).0;
        assert_eq!(search([0.9, 0.8], None), 1);
        assert_eq!(search([0.9, 0.2], Some(&[0.0, 1.0])), 0);
        assert_eq!(search([0.9, 0.2], Some(&[1.0, 0.0])), 1);
        let one = book(&[0.0, 0.0, 1.0, 1.0], 2, 1);
        assert_eq!(
            one.search(&[0.0, 0.0, 1.0, 1.0], &[0.9, 0.8], None, |m, d| if m == 1 { 9.0 } else { d }).0,
            0
        );
        assert!(matches!(
            Codebook::new(&[0.0, 1.0], 1, 2, &mut || Err(vtex_base::Error::Interrupted)),
            Err(vtex_base::Error::Interrupted)
        ));
    }
}
