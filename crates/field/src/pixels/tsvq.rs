//! Tree-structured vector quantisation: a codebook with logarithmic search time (Wei and Levoy,
//! "Deterministic Texture Analysis and Synthesis using Tree Structure Vector Quantization").

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

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
    members: Vec<u32>,
}

/// A tree of vectors.
pub(super) struct Codebook {
    /// Number of components of a vector.
    pub(super) length: usize,
    means: Vec<f32>,
    nodes: Vec<CodebookNode>,
    leaves: usize,
    /// The vectors of each leaf among which the nearest is sought.
    compared: Vec<Vec<u32>>,
}

/// Squared distance of two vectors.
#[inline]
pub(super) fn distance(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

/// The squared distance of two vectors, if it is below `most`.
fn nearer(a: &[f32], b: &[f32], most: f32) -> Option<f32> {
    const AT_ONCE: usize = 16;
    let mut sum = 0.0;
    for (a, b) in a.chunks(AT_ONCE).zip(b.chunks(AT_ONCE)) {
        a.iter().zip(b).for_each(|(x, y)| sum += (x - y) * (x - y));
        if sum >= most {
            return None;
        }
    }
    Some(sum)
}

impl Codebook {
    /// A codebook of at most `leaves` leaves. `vectors` holds vectors of `length` components, one after the
    /// other. The leaf with the largest distortion is split until there are enough.
    pub(super) fn new(vectors: &[f32], length: usize, leaves: usize) -> Self {
        let all: Vec<u32> = (0..(vectors.len() / length) as u32).collect();
        let mut book = Self { length, means: Vec::new(), nodes: Vec::new(), leaves: 1, compared: Vec::new() };
        let mut queue = BinaryHeap::new();
        let distortion = book.add(vectors, all);
        queue.push((distortion, Reverse(0u32)));
        while book.leaves < leaves {
            let Some((distortion, Reverse(worst))) = queue.pop() else { break };
            if distortion == 0 {
                break;
            }
            let members = std::mem::take(&mut book.nodes[worst as usize].members);
            let Some([left, right]) = book.split(vectors, worst, &members) else {
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
        book.compared = book.nodes.iter().map(|node| book.differing(vectors, &node.members)).collect();
        book
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
    fn split(&self, vectors: &[f32], node: u32, members: &[u32]) -> Option<[Vec<u32>; 2]> {
        let length = self.length;
        let of = |m: u32| &vectors[m as usize * length..][..length];
        let mean = self.mean(node);
        // The axis starts towards the vector farthest from the mean.
        let far = members.iter().copied().fold(None, |best: Option<(f32, u32)>, m| {
            let d = distance(of(m), mean);
            if best.is_none_or(|b| d > b.0) { Some((d, m)) } else { best }
        })?;
        let mut axis: Vec<f32> = of(far.1).iter().zip(mean).map(|(v, m)| v - m).collect();
        let mut size = 0.0;
        for _ in 0..POWER {
            let mut next = vec![0f32; length];
            for &m in members {
                let along: f32 = of(m).iter().zip(mean).zip(&axis).map(|((v, c), a)| (v - c) * a).sum();
                next.iter_mut().zip(of(m).iter().zip(mean)).for_each(|(n, (v, c))| *n += along * (v - c));
            }
            size = libm::sqrtf(next.iter().map(|v| v * v).sum());
            if size <= 0.0 {
                return None;
            }
            axis = next.into_iter().map(|v| v / size).collect();
        }
        let step = libm::sqrtf(size / members.len() as f32);
        let mut centres = [-0.5, 0.5]
            .map(|side: f32| mean.iter().zip(&axis).map(|(c, a)| c + side * step * a).collect::<Vec<f32>>());
        let mut parts: [Vec<u32>; 2] = Default::default();
        for _ in 0..LLOYD {
            let mut now: [Vec<u32>; 2] = Default::default();
            for &m in members {
                let nearer = distance(of(m), &centres[1]) < distance(of(m), &centres[0]);
                now[usize::from(nearer)].push(m);
            }
            if now.iter().any(Vec::is_empty) {
                return None;
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
        Some(parts)
    }

    /// For each node the mean colour of its vectors' centre pixels; black unless the node is a leaf.
    pub(super) fn means_of(&self, middles: &[u32], pixels: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let mean = |node: &CodebookNode| {
            let count = node.members.len().max(1) as f32;
            let of = |m: &u32| pixels[middles[*m as usize] as usize];
            std::array::from_fn(|c| node.members.iter().map(|m| of(m)[c]).sum::<f32>() / count)
        };
        self.nodes.iter().map(mean).collect()
    }

    /// The leaf of a vector, and the number of distances computed.
    pub(super) fn encode(&self, vector: &[f32]) -> (u32, u32) {
        let (mut node, mut compared) = (0, 0);
        while let Some([left, right]) = self.nodes[node as usize].children {
            let nearer = distance(vector, self.mean(right)) < distance(vector, self.mean(left));
            node = if nearer { right } else { left };
            compared += 2;
        }
        (node, compared)
    }

    /// The vector of a leaf that is nearest to the given one; ties go to the first.
    pub(super) fn nearest(&self, vectors: &[f32], leaf: u32, vector: &[f32]) -> u32 {
        let of = |m: u32| &vectors[m as usize * self.length..][..self.length];
        let mut best = (f32::INFINITY, 0);
        for &m in &self.compared[leaf as usize] {
            if let Some(d) = nearer(of(m), vector, best.0) {
                best = (d, m);
            }
        }
        best.1
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

    fn distortion(book: &Codebook, vectors: &[f32]) -> f64 {
        vectors.chunks(LENGTH).map(|v| f64::from(distance(v, book.mean(book.encode(v).0)))).sum()
    }

    #[test]
    fn a_leaf_of_nearly_all_vectors_costs_no_more_than_others() {
        // A picture near white: nearly all vectors are similar, few of them equal, and a few are distant.
        let mut random: Stream = stream(1, "tsvq test", 1);
        let mut near: Vec<f32> = (0..20_000 * LENGTH).map(|_| 1.0 - random.unit() as f32 * 1e-3).collect();
        near.extend((0..7 * LENGTH).map(|k| -((k / LENGTH) as f32)));
        let white = vec![1.0; 20_000 * LENGTH];
        for (vectors, most) in [(&near, MOST_COMPARED), (&white, 1)] {
            let book = Codebook::new(vectors, LENGTH, 8);
            let largest = book.compared.iter().map(Vec::len).max().unwrap();
            assert!(largest <= most, "{largest}");
            let leaf = book.encode(&vectors[..LENGTH]).0;
            assert!(
                distance(
                    &vectors[book.nearest(vectors, leaf, &vectors[..LENGTH]) as usize * LENGTH..][..LENGTH],
                    &vectors[..LENGTH]
                ) < 1e-4
            );
        }
    }

    #[test]
    fn more_leaves_are_nearer_and_cost_a_logarithm() {
        let (known, held) = (vectors(4000, 1), vectors(500, 2));
        let mut last = f64::INFINITY;
        for leaves in [1, 16, 64, 512] {
            let book = Codebook::new(&known, LENGTH, leaves);
            assert_eq!(book.leaves, leaves);
            let own = distortion(&book, &known);
            assert!(own < last, "{leaves}: {own} {last}");
            last = own;
            let asked: u32 = held.chunks(LENGTH).map(|v| book.encode(v).1).sum();
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
        let book = Codebook::new(&[1.0; 40], 4, 8);
        assert_eq!(book.leaves, 1);
        let two = Codebook::new(&[0.0, 0.0, 1.0, 1.0], 2, 8);
        assert_eq!(two.leaves, 2);
        let leaf = two.encode(&[0.9, 0.8]).0;
        assert_eq!(two.nearest(&[0.0, 0.0, 1.0, 1.0], leaf, &[0.9, 0.8]), 1);
    }
}
