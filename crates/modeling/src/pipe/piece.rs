//! One rational Bézier piece of a spine, in coordinates of the spine's own size.

use palpate_geometry::math::Vector3;

/// c(x) = Σ w_i P_i B_i(x) / Σ w_i B_i(x) for x in [0, 1]: the spine from `start` to `end` of its
/// parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Parameter of the spine where x = 0.
    pub start: f64,
    /// Parameter of the spine where x = 1.
    pub end: f64,
    /// Control points P_i, `degree + 1`.
    pub points: Vec<Vector3>,
    /// Weights w_i above 0, the largest in [1, 2).
    pub weights: Vec<f64>,
}

/// Point and derivatives by x.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// Point c of the curve, m.
    pub point: Vector3,
    /// First derivative c'.
    pub first: Vector3,
    /// Second derivative c''.
    pub second: Vector3,
}

impl Jet {
    /// Curvature, 1 / length; infinite where c' vanishes.
    pub fn curvature(&self) -> f64 {
        let speed = self.first.norm();
        self.first.cross(&self.second).norm() / (speed * speed * speed)
    }
}

type Homogeneous = (Vector3, f64);

fn blend(a: Homogeneous, b: Homogeneous, x: f64) -> Homogeneous {
    (a.0 * (1.0 - x) + b.0 * x, a.1 * (1.0 - x) + b.1 * x)
}

impl Piece {
    /// Degree n.
    pub fn degree(&self) -> usize {
        self.points.len() - 1
    }

    /// The spine's parameter at x.
    pub fn parameter(&self, x: f64) -> f64 {
        if x == 1.0 {
            self.end
        } else {
            self.start + x * (self.end - self.start)
        }
    }

    fn homogeneous(&self) -> Vec<Homogeneous> {
        self.points
            .iter()
            .zip(&self.weights)
            .map(|(p, &w)| (p * w, w))
            .collect()
    }

    /// Point and derivatives by de Casteljau's algorithm.
    pub fn jet(&self, x: f64) -> Jet {
        let n = self.degree();
        let mut line = self.homogeneous();
        let (mut slope, mut bend): (Homogeneous, Homogeneous) =
            ((Vector3::zeros(), 0.0), (Vector3::zeros(), 0.0));
        for count in (1..=n).rev() {
            if count == 2 {
                let k = (n * (n - 1)) as f64;
                bend = (
                    ((line[2].0 - line[1].0) - (line[1].0 - line[0].0)) * k,
                    ((line[2].1 - line[1].1) - (line[1].1 - line[0].1)) * k,
                );
            }
            if count == 1 {
                slope = (
                    (line[1].0 - line[0].0) * n as f64,
                    (line[1].1 - line[0].1) * n as f64,
                );
            }
            for i in 0..count {
                line[i] = blend(line[i], line[i + 1], x);
            }
        }
        let weight = line[0].1;
        let point = line[0].0 / weight;
        let first = (slope.0 - point * slope.1) / weight;
        let second = (bend.0 - first * (2.0 * slope.1) - point * bend.1) / weight;
        Jet {
            point,
            first,
            second,
        }
    }

    /// The parts before and after x.
    pub fn split(&self, x: f64) -> (Self, Self) {
        let n = self.degree();
        let mut line = self.homogeneous();
        let (mut left, mut right) = (vec![line[0]], vec![line[n]]);
        for count in (1..=n).rev() {
            for i in 0..count {
                line[i] = blend(line[i], line[i + 1], x);
            }
            left.push(line[0]);
            right.push(line[count - 1]);
        }
        right.reverse();
        let middle = self.parameter(x);
        (
            Self::from_homogeneous(self.start, middle, &left),
            Self::from_homogeneous(middle, self.end, &right),
        )
    }

    /// Returns this piece reversed: from `end` to `start`.
    pub fn reversed(&self) -> Self {
        let mut other = self.clone();
        other.points.reverse();
        other.weights.reverse();
        std::mem::swap(&mut other.start, &mut other.end);
        other
    }

    /// Weights scaled by a power of two: nothing is rounded but the division by the weight.
    pub fn from_homogeneous(start: f64, end: f64, line: &[Homogeneous]) -> Self {
        let largest = line.iter().fold(0.0, |most: f64, (_, w)| most.max(*w));
        let scale = power_of_two_below(largest);
        let points = line.iter().map(|(p, w)| p / *w).collect();
        Self {
            start,
            end,
            points,
            weights: line.iter().map(|(_, w)| w / scale).collect(),
        }
    }
}

/// The largest power of two no larger than a normal number above 0: dividing by it is exact.
pub(super) fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & 0x7ff0_0000_0000_0000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn random_piece(random: &mut Random) -> Piece {
        let n = random.integer(1, 6);
        let mut coordinate = || random.float(-1.0, 1.0);
        let points = (0..=n)
            .map(|_| Vector3::new(coordinate(), coordinate(), coordinate()))
            .collect();
        let weights = (0..=n).map(|_| random.float(0.3, 3.0)).collect();
        Piece {
            start: 2.0,
            end: 5.0,
            points,
            weights,
        }
    }

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let mut random = Random(11);
        for _ in 0..100 {
            let piece = random_piece(&mut random);
            let (x, h) = (random.float(0.1, 0.9), 1e-4);
            let [before, here, after] = [x - h, x, x + h].map(|x| piece.jet(x));
            let first = (after.point - before.point) / (2.0 * h);
            let second = (after.first - before.first) / (2.0 * h);
            assert!((first - here.first).norm() < 1e-3 * (1.0 + here.first.norm()));
            assert!((second - here.second).norm() < 1e-3 * (1.0 + here.second.norm()) * 10.0);
        }
    }

    #[test]
    fn parts_and_the_reversed_piece_are_the_same_curve() {
        let mut random = Random(12);
        for _ in 0..100 {
            let piece = random_piece(&mut random);
            let (cut, x) = (random.float(0.2, 0.8), random.float(0.0, 1.0));
            let (left, right) = piece.split(cut);
            assert!((left.jet(x).point - piece.jet(cut * x).point).norm() < 1e-14);
            assert!((right.jet(x).point - piece.jet(cut + (1.0 - cut) * x).point).norm() < 1e-14);
            assert!((piece.reversed().jet(x).point - piece.jet(1.0 - x).point).norm() < 1e-14);
            assert!((left.parameter(1.0) - (2.0 + 3.0 * cut)).abs() < 1e-15);
        }
    }
}
