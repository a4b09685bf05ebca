//! The order of layers from bottom to top.

use super::map::Contacts;

/// The order of labels from bottom to top with the least contact between non-consecutive layers. Ties go to
/// the order with the largest label at the bottom, then the next.
pub(super) fn order(contacts: &Contacts, shares: &[f64]) -> Vec<usize> {
    let mut best: Option<(u64, Vec<usize>)> = None;
    let by_area = {
        let mut all: Vec<usize> = (0..shares.len()).collect();
        all.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]).then(a.cmp(&b)));
        all
    };
    // Orders with the largest labels at the bottom come first, so the first of several ties is kept.
    permutations(&by_area, &mut Vec::new(), &mut |order| {
        let touch: u64 = (0..order.len())
            .flat_map(|a| (a + 2..order.len()).map(move |b| (a, b)))
            .map(|(a, b)| contacts.between(order[a], order[b]))
            .sum();
        if best.as_ref().is_none_or(|b| touch < b.0) {
            best = Some((touch, order.to_vec()));
        }
    });
    best.map_or_else(Vec::new, |b| b.1)
}

fn permutations(items: &[usize], head: &mut Vec<usize>, visit: &mut impl FnMut(&[usize])) {
    if head.len() == items.len() {
        return visit(head);
    }
    for &item in items {
        if !head.contains(&item) {
            head.push(item);
            permutations(items, head, visit);
            head.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vtex_base::raster::LabelMap;

    #[test]
    fn rings_are_ordered_by_contact() {
        // Concentric rings; the outermost, label 1, is the largest.
        let names = [1, 3, 0, 2];
        let mut map = LabelMap::filled(40, 40, 0);
        for y in 0..40u32 {
            for x in 0..40u32 {
                let d = x.min(39 - x).min(y).min(39 - y);
                map.set(x, y, names[(d / 5).min(3) as usize]);
            }
        }
        let shares: Vec<f64> = map.areas().iter().map(|&a| f64::from(a) / 1600.0).collect();
        let found = order(&Contacts::new(&map, 4, [false; 2]), &shares);
        assert_eq!(found, [1, 3, 0, 2]);
    }
}
