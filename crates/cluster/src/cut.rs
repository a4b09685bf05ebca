//! Normalised cuts of small graphs (Shi and Malik 2000).

/// Steps of the power method.
const STEPS: usize = 60;

/// The two sides of a good normalised cut of a graph, given by the neighbours of each node and the weights of the edges
/// to them, from 0. `None` for fewer than two nodes.
pub(crate) fn normalised_cut(graph: &[Vec<(usize, f64)>]) -> Option<Vec<bool>> {
    let count = graph.len();
    if count < 2 {
        return None;
    }
    // An edge to itself keeps a node without others in the graph.
    let degree: Vec<f64> = graph.iter().map(|e| e.iter().map(|e| e.1).sum::<f64>() + 1e-9).collect();
    let total: f64 = degree.iter().sum();
    // The second eigenvector of D⁻¹W: power steps of (1 + D⁻¹W) / 2 without the constant part.
    let mut v: Vec<f64> = (0..count).map(|i| f64::from((i * 7919 % 1009) as u32) / 1009.0 - 0.5).collect();
    for _ in 0..STEPS {
        let mean = v.iter().zip(&degree).map(|(v, d)| v * d).sum::<f64>() / total;
        v.iter_mut().for_each(|v| *v -= mean);
        let next: Vec<f64> = (0..count)
            .map(|i| {
                let sum: f64 = graph[i].iter().map(|(j, w)| w * v[*j]).sum();
                0.5 * (v[i] + (sum + 1e-9 * v[i]) / degree[i])
            })
            .collect();
        let size = libm::sqrt(next.iter().map(|v| v * v).sum());
        if size < 1e-30 {
            break;
        }
        v = next.into_iter().map(|v| v / size).collect();
    }
    // The best cut between two successive nodes.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| v[*a].total_cmp(&v[*b]).then(a.cmp(b)));
    let mut side = vec![false; count];
    let (mut cut, mut inside) = (0.0, 0.0);
    let (mut best, mut first) = (f64::INFINITY, 1);
    for (k, &i) in order[..count - 1].iter().enumerate() {
        side[i] = true;
        inside += degree[i];
        for (j, w) in graph[i].iter().filter(|e| e.0 != i) {
            cut += if side[*j] { -w } else { *w };
        }
        let cost = cut / inside + cut / (total - inside).max(1e-12);
        if cost < best {
            (best, first) = (cost, k + 1);
        }
    }
    let mut side = vec![true; count];
    order[..first].iter().for_each(|i| side[*i] = false);
    Some(side)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_loosely_linked_groups_are_parted() {
        let group = |i: usize| usize::from(i >= 7);
        let link = |i: usize, j: usize| if group(i) == group(j) { 0.9 } else { 0.05 };
        let graph: Vec<Vec<(usize, f64)>> =
            (0..12).map(|i| (0..12).filter(|j| *j != i).map(|j| (j, link(i, j))).collect()).collect();
        let side = normalised_cut(&graph).unwrap();
        assert!((0..12).all(|i| side[i] == side[group(i) * 7]), "{side:?}");
        assert!(side[0] != side[7]);
        assert_eq!(normalised_cut(&[Vec::new()]), None);
        assert!(normalised_cut(&vec![Vec::new(); 3]).is_some());
    }
}
