//! Exact solution of the transport problem: the least cost of moving one distribution onto another.
//!
//! Successive shortest paths with potentials (Edmonds and Karp 1972). Amounts are integers, so the
//! algorithm terminates and nothing is lost to rounding. Meant for some hundreds of points.

/// A distribution: points with their amounts.
type Heaps<T> = [(T, u64)];

/// Least mean distance over which mass moves from `a` to `b`, both normalised to sum 1; 0 if one is
/// empty. `distance` must be a metric. Sums must be below 2³².
pub(super) fn mean_cost<T: PartialEq>(a: &Heaps<T>, b: &Heaps<T>, distance: impl Fn(&T, &T) -> f64) -> f64 {
    let sum = |heaps: &Heaps<T>| heaps.iter().map(|h| h.1).sum::<u64>();
    let (all_a, all_b) = (sum(a), sum(b));
    if all_a == 0 || all_b == 0 {
        return 0.0;
    }
    // Both are scaled to the same sum.
    let mut supply: Vec<u64> = a.iter().map(|h| h.1 * all_b).collect();
    let mut demand: Vec<u64> = b.iter().map(|h| h.1 * all_a).collect();
    // Mass at a common point stays: by the triangle inequality moving it is never cheaper.
    for (i, p) in a.iter().enumerate() {
        for (j, _) in b.iter().enumerate().filter(|(_, q)| q.0 == p.0) {
            let same = supply[i].min(demand[j]);
            supply[i] -= same;
            demand[j] -= same;
        }
    }
    let cost = a.iter().map(|p| b.iter().map(|q| distance(&p.0, &q.0)).collect()).collect();
    let mut network = FlowNetwork::new(cost, supply, demand);
    while network.augment() {}
    network.total() / (all_a as f64 * all_b as f64)
}

struct FlowNetwork {
    cost: Vec<Vec<f64>>,
    flow: Vec<Vec<u64>>,
    supply: Vec<u64>,
    demand: Vec<u64>,
    /// Potentials of sources, then of sinks. Reduced costs of residual edges are never negative.
    potential: Vec<f64>,
}

impl FlowNetwork {
    fn new(cost: Vec<Vec<f64>>, supply: Vec<u64>, demand: Vec<u64>) -> Self {
        let flow = vec![vec![0; demand.len()]; supply.len()];
        let potential = vec![0.0; supply.len() + demand.len()];
        Self { cost, flow, supply, demand, potential }
    }

    /// Augments along the cheapest path from remaining supply to remaining demand. `false` if none is
    /// left.
    fn augment(&mut self) -> bool {
        let (sources, sinks) = (self.supply.len(), self.demand.len());
        let mut distance = vec![f64::INFINITY; sources + sinks];
        let mut before = vec![usize::MAX; sources + sinks];
        let mut settled = vec![false; sources + sinks];
        for i in (0..sources).filter(|i| self.supply[*i] > 0) {
            distance[i] = 0.0;
        }
        // Dijkstra's algorithm on a dense graph.
        let end = loop {
            let open = (0..sources + sinks).filter(|v| !settled[*v] && distance[*v].is_finite());
            let Some(v) = open.min_by(|a, b| distance[*a].total_cmp(&distance[*b])) else { return false };
            settled[v] = true;
            if v >= sources && self.demand[v - sources] > 0 {
                break v;
            }
            let mut relax = |to: usize, cost: f64| {
                // Rounding may make a reduced cost slightly negative.
                let reduced = (cost + self.potential[v] - self.potential[to]).max(0.0);
                if !settled[to] && distance[v] + reduced < distance[to] {
                    (distance[to], before[to]) = (distance[v] + reduced, v);
                }
            };
            if v < sources {
                (0..sinks).for_each(|j| relax(sources + j, self.cost[v][j]));
            } else {
                let j = v - sources;
                (0..sources).filter(|i| self.flow[*i][j] > 0).for_each(|i| relax(i, -self.cost[i][j]));
            }
        };
        let reach = distance[end];
        self.potential.iter_mut().zip(&distance).for_each(|(p, d)| *p += d.min(reach));
        self.send(&before, end);
        true
    }

    /// Sends as much as possible along a path.
    fn send(&mut self, before: &[usize], end: usize) {
        let sources = self.supply.len();
        let mut path = vec![end];
        while let Some(&v) = path.last().filter(|v| before[**v] != usize::MAX) {
            path.push(before[v]);
        }
        let start = path[path.len() - 1];
        let back = path.windows(2).filter(|edge| edge[0] < sources);
        let room = back.map(|edge| self.flow[edge[0]][edge[1] - sources]).min().unwrap_or(u64::MAX);
        let amount = room.min(self.supply[start]).min(self.demand[end - sources]);
        for edge in path.windows(2) {
            match edge[0].checked_sub(sources) {
                Some(j) => self.flow[edge[1]][j] += amount,
                None => self.flow[edge[0]][edge[1] - sources] -= amount,
            }
        }
        self.supply[start] -= amount;
        self.demand[end - sources] -= amount;
    }

    fn total(&self) -> f64 {
        let rows = self.flow.iter().zip(&self.cost);
        rows.map(|(flow, cost)| flow.iter().zip(cost).map(|(f, c)| *f as f64 * c).sum::<f64>()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::sampling::stream;

    #[test]
    fn on_a_line_it_is_the_difference_of_sums() {
        // In one dimension the answer is known: the area between the cumulative distributions.
        let mut random = stream(1, "transport test", 0);
        for _ in 0..20 {
            let mut heaps =
                || -> Vec<(i32, u64)> { (0..30).map(|x| (x, random.below(5))).filter(|h| h.1 > 0).collect() };
            let (a, b) = (heaps(), heaps());
            let below = |heaps: &[(i32, u64)], x: i32| {
                let sum = |most: i32| heaps.iter().filter(|h| h.0 <= most).map(|h| h.1).sum::<u64>() as f64;
                sum(x) / sum(i32::MAX)
            };
            let wanted: f64 = (0..30).map(|x| (below(&a, x) - below(&b, x)).abs()).sum();
            let found = mean_cost(&a, &b, |p, q| f64::from((p - q).abs()));
            assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
        }
    }

    #[test]
    fn a_cheap_start_may_have_to_be_undone() {
        // The nearest neighbour of both is 1: greedy pairing costs 0 + 10, the best 1 + 2.
        let found =
            mean_cost(&[(0, 1), (1, 1)], &[(1, 1), (3, 1)], |p: &i32, q: &i32| f64::from((p - q).abs()));
        assert_eq!(found, 1.5);
        assert_eq!(mean_cost(&[(0, 0)], &[(1, 3)], |_, _| 1.0), 0.0);
    }
}
