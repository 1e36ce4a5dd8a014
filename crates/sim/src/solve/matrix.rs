//! How the forces of a tick move its rows: the Delassus matrix D, m/N.
//!
//! In ticks without friction and grips forces have one direction, their row's normal, and D_ij is a number; in
//! others they have the three of the world, and D_ij is a block of 3 × 3: what a force on row j moves row i. All
//! that gives way adds to it, and nothing stands beside it. D_ji = D_ijᵀ, so a row of it is read as a column.

use palpate_geometry::math::{Matrix3, Vector3};

/// Room for a number of rows.
#[derive(Clone, Debug)]
pub struct ContactMatrix {
    /// Of each force: 1 or 3.
    directions: usize,
    normals: Vec<Vector3>,
    /// Row by row, with `directions` of them for each contact row.
    entries: Vec<f64>,
}

impl ContactMatrix {
    /// Room for `rows` rows, or `whole_rows` whose forces have three components.
    pub fn new(rows: usize, whole_rows: usize) -> Self {
        Self {
            directions: 1,
            normals: Vec::with_capacity(rows),
            entries: vec![0.0; (rows * rows).max(9 * whole_rows * whole_rows)],
        }
    }

    /// Rows with these normals that do not move each other yet; `whole`: under forces of three components.
    pub fn begin(&mut self, normals: impl Iterator<Item = Vector3>, whole: bool) {
        self.normals.clear();
        self.normals.extend(normals);
        self.directions = if whole { 3 } else { 1 };
        let size = self.size();
        debug_assert!(size * size <= self.entries.len(), "more rows than room");
        self.entries[..size * size].fill(0.0);
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.normals.len()
    }

    /// Forces have three components.
    pub fn is_whole(&self) -> bool {
        self.directions == 3
    }

    /// Components of all forces together.
    pub fn size(&self) -> usize {
        self.rows() * self.directions
    }

    /// Adds a block to D_ij, and what mirrors it to D_ji.
    pub fn add(&mut self, i: usize, j: usize, block: &Matrix3) {
        if !self.is_whole() {
            let along = self.normals[i].dot(&(block * self.normals[j]));
            return self.add_along(i, j, along);
        }
        self.add_block(i, j, block);
        if i != j {
            self.add_block(j, i, &block.transpose());
        }
    }

    fn add_block(&mut self, i: usize, j: usize, block: &Matrix3) {
        let size = self.size();
        for a in 0..3 {
            let entries = &mut self.entries[(3 * i + a) * size + 3 * j..][..3];
            for b in 0..3 {
                entries[b] += block[(a, b)];
            }
        }
    }

    /// Adds a block that moves alike in every direction.
    pub fn add_isotropic(&mut self, i: usize, j: usize, m_per_n: f64) {
        if !self.is_whole() {
            return self.add_along(i, j, m_per_n * self.normals[i].dot(&self.normals[j]));
        }
        for a in 0..3 {
            self.add_entry((i, a), (j, a), m_per_n);
        }
    }

    /// Adds what forces along the normals move rows along theirs, where forces have no other direction.
    pub fn add_along(&mut self, i: usize, j: usize, m_per_n: f64) {
        debug_assert!(!self.is_whole(), "a force of three components");
        self.add_entry((i, 0), (j, 0), m_per_n);
    }

    /// Lets a row give way under its own force by this share more.
    pub fn ease(&mut self, i: usize, share: f64) {
        let (size, of_row) = (self.size(), i * self.directions);
        for a in of_row..of_row + self.directions {
            for own in &mut self.entries[a * size + of_row..][..self.directions] {
                *own += *own * share;
            }
        }
    }

    /// How far a row gives way along its normal under its own push, m/N.
    pub fn along(&self, i: usize) -> f64 {
        match self.is_whole() {
            true => self.normals[i].dot(&(self.block(i, i) * self.normals[i])),
            false => self.entry(i, i),
        }
    }

    /// D_ij, where forces have three components.
    pub fn block(&self, i: usize, j: usize) -> Matrix3 {
        debug_assert!(self.is_whole(), "forces along the normals");
        Matrix3::from_fn(|a, b| self.entry(3 * i + a, 3 * j + b))
    }

    /// What the components of the force of a row move all rows: one column after the other.
    pub fn columns(&self, i: usize) -> &[f64] {
        let length = self.directions * self.size();
        &self.entries[i * length..(i + 1) * length]
    }

    /// What one component moves another.
    pub fn entry(&self, a: usize, b: usize) -> f64 {
        debug_assert!(a < self.size() && b < self.size(), "no such component");
        self.entries[a * self.size() + b]
    }

    /// Adds to one entry, and to the one that mirrors it.
    fn add_entry(&mut self, (i, a): (usize, usize), (j, b): (usize, usize), m_per_n: f64) {
        let (size, of) = (self.size(), self.directions);
        let (row, column) = (i * of + a, j * of + b);
        debug_assert!(row < size && column < size, "no such component");
        self.entries[row * size + column] += m_per_n;
        if i != j {
            self.entries[column * size + row] += m_per_n;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn block(random: &mut Random) -> Matrix3 {
        Matrix3::from_columns(&[random.vector(), random.vector(), random.vector()])
    }

    /// The same blocks along the normals and whole.
    #[test]
    fn it_is_symmetric_and_its_normals_see_what_smooth_ticks_see() {
        let mut random = Random(23);
        let normals: Vec<Vector3> = (0..7).map(|_| random.vector().normalize()).collect();
        let [mut smooth, mut whole] = [false, true].map(|is_whole| {
            let mut matrix = ContactMatrix::new(7, 7);
            // What was there before is forgotten.
            matrix.begin(normals.iter().copied(), true);
            matrix.add(6, 5, &Matrix3::identity());
            matrix.begin(normals.iter().copied(), is_whole);
            matrix
        });
        for i in 0..7 {
            for j in 0..=i {
                let mut block = block(&mut random);
                if i == j {
                    block += block.transpose();
                }
                for matrix in [&mut smooth, &mut whole] {
                    matrix.add(i, j, &block);
                    matrix.add_isotropic(i, j, 0.5);
                }
            }
            for matrix in [&mut smooth, &mut whole] {
                matrix.ease(i, 0.1);
            }
        }
        for i in 0..7 {
            for j in 0..7 {
                let block = whole.block(i, j);
                assert_eq!(block, whole.block(j, i).transpose());
                assert_eq!(smooth.entry(i, j), smooth.entry(j, i));
                let along = normals[i].dot(&(block * normals[j]));
                assert!((along - smooth.entry(i, j)).abs() < 1e-14);
            }
            assert!((whole.along(i) - smooth.along(i)).abs() < 1e-14);
            let columns = whole.columns(i);
            assert!((0..63).all(|k| columns[k] == whole.entry(k % 21, 3 * i + k / 21)));
        }
    }
}
