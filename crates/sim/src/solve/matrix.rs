//! How the forces of a tick move its rows: the Delassus matrix D, m/N.
//!
//! The force of a row has one direction, its normal, or the three of the world, where friction or a grip acts across.
//! D has a row and a column for each direction of each force: what a newton along one moves the rows along the others. All
//! that gives way adds to it, and nothing stands beside it. It is symmetric, so a row of it is read as a column.

use palpate_geometry::math::{Matrix3, Vector3};
use std::ops::Range;

/// Room for a number of rows.
#[derive(Clone, Debug)]
pub struct ContactMatrix {
    normals: Vec<Vector3>,
    /// Where the directions of each row begin, and where the last one's end.
    starts: Vec<usize>,
    /// Directions of all forces together.
    size: usize,
    /// Direction by direction.
    entries: Vec<f64>,
}

/// Directions of a force: along the normal, or all.
pub fn directions(normal: &Vector3, whole: bool) -> impl Iterator<Item = Vector3> + Clone + use<> {
    let (first, count) = match whole {
        true => (Vector3::x(), 3),
        false => (*normal, 1),
    };
    [first, Vector3::y(), Vector3::z()].into_iter().take(count)
}

impl ContactMatrix {
    /// Room for `rows` rows whose forces have so many directions together.
    pub fn new(rows: usize, directions: usize) -> Self {
        Self {
            normals: Vec::with_capacity(rows),
            starts: Vec::with_capacity(rows + 1),
            size: 0,
            entries: vec![0.0; directions * directions],
        }
    }

    /// Rows that do not move each other yet: their normals, and whether their forces have all directions.
    pub fn begin(&mut self, rows: impl Iterator<Item = (Vector3, bool)>) {
        self.normals.clear();
        self.starts.clear();
        self.size = 0;
        self.starts.push(0);
        for (normal, whole) in rows {
            self.size += if whole { 3 } else { 1 };
            self.normals.push(normal);
            self.starts.push(self.size);
        }
        let size = self.size;
        debug_assert!(size * size <= self.entries.len(), "more rows than room");
        self.entries[..size * size].fill(0.0);
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.normals.len()
    }

    /// A row's normal.
    pub fn normal(&self, i: usize) -> &Vector3 {
        &self.normals[i]
    }

    /// Directions of all forces together.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Those of a row's force.
    pub fn span(&self, i: usize) -> Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    fn is_whole(&self, i: usize) -> bool {
        self.span(i).len() == 3
    }

    /// Adds to D_ij how a force on row j moves row i, and as much to D_ji.
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, block: &Matrix3) {
        // Of a row by itself both are one.
        let share = if i == j { 0.5 } else { 1.0 };
        for k in 0..self.span(j).len() {
            let moved = match self.is_whole(j) {
                true => block.column(k) * share,
                false => block * (self.normals[j] * share),
            };
            self.add_moved(i, (j, k), &moved);
        }
    }

    /// Adds what moves alike in every direction.
    #[inline]
    pub fn add_isotropic(&mut self, i: usize, j: usize, m_per_n: f64) {
        if self.is_whole(i) || self.is_whole(j) {
            return self.add(i, j, &Matrix3::from_diagonal_element(m_per_n));
        }
        let share = if i == j { 0.5 } else { 1.0 };
        let along = self.normals[i].dot(&self.normals[j]) * (m_per_n * share);
        self.add_along(i, self.starts[j], [along]);
    }

    /// Adds how far one newton along a direction of row j moves row i, m, and as much the other way round.
    #[inline]
    pub fn add_moved(&mut self, i: usize, (j, direction): (usize, usize), moved: &Vector3) {
        let b = self.starts[j] + direction;
        match self.is_whole(i) {
            true => self.add_along(i, b, [moved.x, moved.y, moved.z]),
            false => self.add_along(i, b, [self.normals[i].dot(moved)]),
        }
    }

    #[inline]
    fn add_along<const N: usize>(&mut self, i: usize, b: usize, m_per_n: [f64; N]) {
        let (size, a) = (self.size, self.starts[i]);
        for (a, more) in (a..).zip(m_per_n) {
            if a == b {
                self.entries[a * size + a] += more + more;
            } else {
                self.entries[b * size + a] += more;
                self.entries[a * size + b] += more;
            }
        }
    }

    /// Lets a row give way under its own force by this share more.
    pub fn regularize(&mut self, i: usize, share: f64) {
        let (size, span) = (self.size(), self.span(i));
        for a in span.clone() {
            for own in &mut self.entries[a * size..][span.clone()] {
                *own += *own * share;
            }
        }
    }

    /// How far a row gives way along its normal under its own push, m/N.
    pub fn along(&self, i: usize) -> f64 {
        match self.is_whole(i) {
            true => self.normals[i].dot(&(self.block(i, i) * self.normals[i])),
            false => self.entry(self.starts[i], self.starts[i]),
        }
    }

    /// How far a newton on row j along a direction of its force moves row i along one of its own, m.
    pub fn between(&self, (i, along): (usize, &Vector3), (j, by): (usize, &Vector3)) -> f64 {
        let part = |row: usize, direction: &Vector3, k: usize| match self.is_whole(row) {
            true => direction[k],
            false => direction.dot(&self.normals[row]),
        };
        let mut sum = 0.0;
        for (k, b) in self.span(j).enumerate() {
            let column = &self.entries[b * self.size..][self.span(i)];
            let moved = column.iter().enumerate();
            let moved: f64 = moved.map(|(l, m)| part(i, along, l) * m).sum();
            sum += moved * part(j, by, k);
        }
        sum
    }

    /// D_ij between two rows whose forces have all directions.
    pub fn block(&self, i: usize, j: usize) -> Matrix3 {
        let (i, j) = (self.span(i), self.span(j));
        debug_assert!(i.len() == 3 && j.len() == 3, "a force along its normal");
        Matrix3::from_fn(|a, b| self.entry(i.start + a, j.start + b))
    }

    /// D_ij between any two rows; of one along its normal only, nothing across.
    pub fn whole(&self, i: usize, j: usize) -> Matrix3 {
        if self.is_whole(i) && self.is_whole(j) {
            return self.block(i, j);
        }
        let along = |row: usize, k: usize| match self.is_whole(row) {
            true => Vector3::ith(k, 1.0),
            false => self.normals[row],
        };
        let mut whole = Matrix3::zeros();
        for (k, b) in self.span(j).enumerate() {
            for (l, a) in self.span(i).enumerate() {
                whole += along(i, l) * along(j, k).transpose() * self.entry(a, b);
            }
        }
        whole
    }

    /// What a row's force moves all rows: one column for each of its directions.
    pub fn columns(&self, i: usize) -> &[f64] {
        let (size, span) = (self.size(), self.span(i));
        &self.entries[span.start * size..span.end * size]
    }

    /// What a force along one direction moves along another.
    pub fn entry(&self, a: usize, b: usize) -> f64 {
        debug_assert!(a < self.size() && b < self.size(), "no such direction");
        self.entries[a * self.size() + b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn block(random: &mut Random) -> Matrix3 {
        Matrix3::from_columns(&[random.vector(), random.vector(), random.vector()])
    }

    /// The same blocks between rows along their normals, whole ones, and some of each.
    #[test]
    fn it_is_symmetric_and_normals_see_the_same_of_every_row() {
        let mut random = Random(23);
        let normals: Vec<Vector3> = (0..7).map(|_| random.vector().normalize()).collect();
        let kinds: [fn(usize) -> bool; 3] = [|_| false, |_| true, |i| i % 3 == 1];
        let mut matrices = kinds.map(|is_whole| {
            let rows = || normals.iter().copied().enumerate();
            let mut matrix = ContactMatrix::new(7, 21);
            // What was there before is forgotten.
            matrix.begin(rows().map(|(_, normal)| (normal, true)));
            matrix.add(6, 5, &Matrix3::identity());
            matrix.begin(rows().map(|(i, normal)| (normal, is_whole(i))));
            matrix
        });
        for i in 0..7 {
            for j in 0..=i {
                let mut block = block(&mut random);
                if i == j {
                    block += block.transpose();
                }
                for matrix in &mut matrices {
                    matrix.add(i, j, &block);
                    matrix.add_isotropic(i, j, 0.5);
                }
            }
            matrices
                .iter_mut()
                .for_each(|matrix| matrix.regularize(i, 0.1));
        }
        let [smooth, whole, _] = &matrices;
        for matrix in &matrices {
            for a in 0..matrix.size() {
                (0..a).for_each(|b| assert_eq!(matrix.entry(a, b), matrix.entry(b, a)));
            }
            for i in 0..7 {
                assert!((matrix.along(i) - smooth.along(i)).abs() < 1e-14);
                let (size, span, columns) = (matrix.size(), matrix.span(i), matrix.columns(i));
                assert!(
                    (0..columns.len())
                        .all(|k| columns[k] == matrix.entry(k % size, span.start + k / size))
                );
                for j in 0..7 {
                    let between = normals[i].dot(&(whole.block(i, j) * normals[j]));
                    let seen = |along: &Vector3, at: usize| match matrix.span(at).len() {
                        1 => vec![1.0],
                        _ => along.iter().copied().collect(),
                    };
                    let (of_i, of_j) = (seen(&normals[i], i), seen(&normals[j], j));
                    let mut along = 0.0;
                    for (a, left) in matrix.span(i).zip(of_i) {
                        for (b, right) in matrix.span(j).zip(&of_j) {
                            along += left * matrix.entry(a, b) * right;
                        }
                    }
                    assert!((along - between).abs() < 1e-14);
                    let own = matrix.between((i, &normals[i]), (j, &normals[j]));
                    assert!((own - between).abs() < 1e-14);
                }
            }
        }
    }
}
