//! What is left when nothing can be proved: boxes that touch, as one.

use super::pair::Area;

/// A connected set of boxes that may hold roots.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// Corner of the smallest box around all.
    pub low: [f64; 2],
    /// The other corner.
    pub high: [f64; 2],
    /// Middles of the boxes.
    pub middles: Vec<[f64; 2]>,
}

impl Cluster {
    /// The longer side.
    pub fn extent(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}

/// Boxes that touch within a rounding, or within half their width, as one; in order of their first
/// boxes.
pub(super) fn chains(areas: &[Area]) -> Vec<Cluster> {
    let mut leader: Vec<usize> = (0..areas.len()).collect();
    for i in 0..areas.len() {
        for j in 0..i {
            if touch(&areas[i], &areas[j]) {
                let (a, b) = (find(&mut leader, i), find(&mut leader, j));
                leader[a.max(b)] = a.min(b);
            }
        }
    }
    let mut clusters: Vec<(usize, Cluster)> = Vec::new();
    for (k, area) in areas.iter().enumerate() {
        let first = find(&mut leader, k);
        let high = [0, 1].map(|axis| area.low[axis] + area.width[axis]);
        let middle = [0, 1].map(|axis| area.low[axis] + 0.5 * area.width[axis]);
        match clusters.iter_mut().find(|(leader, _)| *leader == first) {
            Some((_, cluster)) => {
                cluster.low = [0, 1].map(|axis| cluster.low[axis].min(area.low[axis]));
                cluster.high = [0, 1].map(|axis| cluster.high[axis].max(high[axis]));
                cluster.middles.push(middle);
            }
            None => clusters.push((
                first,
                Cluster {
                    low: area.low,
                    high,
                    middles: vec![middle],
                },
            )),
        }
    }
    clusters.into_iter().map(|(_, cluster)| cluster).collect()
}

fn touch(a: &Area, b: &Area) -> bool {
    (0..2).all(|k| {
        let room = 1e-9 + 0.5 * a.width[k].min(b.width[k]);
        a.low[k] <= b.low[k] + b.width[k] + room && b.low[k] <= a.low[k] + a.width[k] + room
    })
}

fn find(leader: &mut [usize], mut k: usize) -> usize {
    while leader[k] != k {
        leader[k] = leader[leader[k]];
        k = leader[k];
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_in_a_row_are_one_chain() {
        let area = |x: f64, y: f64| Area {
            low: [x, y],
            width: [0.1, 0.1],
        };
        let clusters = chains(&[
            area(0.0, 0.0),
            area(0.5, 0.5),
            area(0.2, 0.2),
            area(0.1, 0.1),
        ]);
        assert_eq!(clusters.len(), 2);
        assert_eq!(
            (clusters[0].middles.len(), clusters[1].middles.len()),
            (3, 1)
        );
        assert!((clusters[0].extent() - 0.3).abs() < 1e-15);
    }
}
