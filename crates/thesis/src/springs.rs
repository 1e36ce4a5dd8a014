//! Law of springs `seed`: K = E A / L for every spring by itself, with A = V / L of the cells around. Too stiff, as springs
//! side by side each count as if they were alone.

use palpate_sim::body::{CellGrid, CellShares, Spring, SpringLaw, springs_of_cells};

/// `springs = "seed"`.
#[derive(Clone, Copy, Debug)]
pub struct Seed;

/// A cell has four edges along each axis, and two diagonals in each direction of a face.
const SHARES: CellShares = CellShares {
    edge: 0.25,
    diagonal: 0.5,
};

impl SpringLaw for Seed {
    fn name(&self) -> &'static str {
        "seed"
    }

    fn springs(&self, grid: &CellGrid, young_pa: &dyn Fn(usize) -> f64) -> Vec<Spring> {
        springs_of_cells(grid, young_pa, SHARES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Point3;
    use palpate_sim::body::MODULI;

    // A cube of side h, alone: a quarter of the section for each edge, half of A = V / l for each diagonal.
    #[test]
    fn a_spring_has_the_stiffness_of_a_bar_and_stiffer_than_by_moduli() {
        let h = 0.02;
        let cube = CellGrid::cuboid(&Point3::origin(), &Point3::new(h, h, h), [2; 3]);
        let springs = Seed.springs(&cube, &|_| 1e4);
        assert_eq!(springs.len(), 12 + 12);
        let moduli = springs_of_cells(&cube, |_| 1e4, MODULI);
        for (spring, other) in springs.iter().zip(&moduli) {
            let length_m = spring.rest_length_m;
            let edge = length_m < 1.1 * h;
            let area_m2 = h * h * h / length_m * if edge { 0.25 } else { 0.5 };
            let bar_n_m = 1e4 * area_m2 / length_m;
            assert!((spring.stiffness_n_m / bar_n_m - 1.0).abs() < 1e-12);
            assert!(spring.stiffness_n_m > other.stiffness_n_m);
        }
    }
}
