//! The force pass over springs: four side by side, in an order in which neighbours in memory share no node.
//!
//! g_i = Σ k (|d| − L) / |d| d, eqs. 5.8–5.13 of the thesis. A spring without length has no direction and no force.

use super::material::Stiffening;
use super::springs::Spring;
use crate::math::lanes::{Baseline, Four, Lanes};
use crate::math::{Lane, Point3, simd};

/// Springs four by four; the last block is filled up with springs without stiffness from a node to itself.
#[derive(Clone, Debug, Default)]
pub(super) struct SpringTable {
    a: Vec<[u32; 4]>,
    b: Vec<[u32; 4]>,
    stiffness: Vec<Four>,
    rest: Vec<Four>,
    stiffening: Option<Stiffening>,
    count: usize,
}

/// Springs looked through for one that shares no node with its block.
const WINDOW: usize = 64;
/// No stiffening.
const PLAIN: Stiffening = Stiffening { strain: f64::INFINITY, ratio: 1.0, least_length: 0.0, least_length_ratio: 1.0 };
/// Lengths below this count as this long: the force of a spring without length is then zero, not undefined.
const LEAST_LENGTH: f64 = 1e-100;

impl SpringTable {
    pub(super) fn new(springs: &[Spring], stiffening: Option<Stiffening>) -> Self {
        let mut table = Self { stiffening, count: springs.len(), ..Self::default() };
        let mut waiting: Vec<&Spring> = Vec::with_capacity(WINDOW);
        let mut coming = springs.iter();
        loop {
            while waiting.len() < WINDOW
                && let Some(spring) = coming.next()
            {
                waiting.push(spring);
            }
            if waiting.is_empty() {
                return table;
            }
            let mut block: Vec<&Spring> = Vec::with_capacity(4);
            while block.len() < 4 && !waiting.is_empty() {
                let shares = |s: &&Spring| block.iter().any(|o| s.a == o.a || s.a == o.b || s.b == o.a || s.b == o.b);
                // A store into a node and the next load from it would wait for each other.
                let next = waiting.iter().position(|spring| !shares(spring)).unwrap_or(0);
                block.push(waiting.remove(next));
            }
            let get = |k: usize, of: fn(&Spring) -> f64| block.get(k).map_or(0.0, |spring| of(spring));
            table.a.push(std::array::from_fn(|k| block.get(k).map_or(block[0].a, |spring| spring.a)));
            table.b.push(std::array::from_fn(|k| block.get(k).map_or(block[0].a, |spring| spring.b)));
            table.stiffness.push(std::array::from_fn(|k| get(k, |spring| spring.stiffness_n_m)));
            table.rest.push(std::array::from_fn(|k| get(k, |spring| spring.rest_length_m)));
        }
    }

    /// Springs.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Rest lengths at the start, four by four.
    pub(super) fn rest(&self) -> &[Four] {
        &self.rest
    }

    /// Springs by block and place: (block, place, a, b, k).
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, usize, usize, usize, f64)> + '_ {
        (0..self.count).map(|_| ()).zip(self.places()).map(|((), (block, place))| {
            let (a, b) = (self.a[block][place] as usize, self.b[block][place] as usize);
            (block, place, a, b, self.stiffness[block][place])
        })
    }

    fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        // Only the last block of a run may be short, and runs end only with the springs.
        (0..self.a.len()).flat_map(|block| (0..4).map(move |place| (block, place)))
    }

    /// Adds forces (N) to `residual`; `rest`: lengths without force, four by four.
    pub(super) fn add_forces(&self, rest: &[Four], places: &[Lane], residual: &mut [Lane]) {
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_forces_wide(self, rest, places, residual) };
        }
        self.add_forces_in::<Baseline>(rest, places, residual);
    }

    // No closures here: what they call would not be compiled for the wider registers of the function around them.
    #[inline(always)]
    fn add_forces_in<L: Lanes>(&self, rest: &[Four], places: &[Lane], residual: &mut [Lane]) {
        match &self.stiffening {
            None => self.run::<L, false>(&PLAIN, rest, places, residual),
            Some(law) => self.run::<L, true>(law, rest, places, residual),
        }
    }

    #[inline(always)]
    fn run<L: Lanes, const STIFFENING: bool>(
        &self,
        law: &Stiffening,
        rest: &[Four],
        places: &[Lane],
        residual: &mut [Lane],
    ) {
        let (far, near) = (L::splat(1.0 + law.strain.min(1e100)), L::splat(law.least_length));
        let (more_far, more_near) = (L::splat(law.ratio - 1.0), L::splat(law.least_length_ratio - 1.0));
        let (zero, least) = (L::splat(0.0), L::splat(LEAST_LENGTH));
        for (((a, b), k), rest) in self.a.iter().zip(&self.b).zip(&self.stiffness).zip(rest) {
            let d = [
                L::load(&places[b[0] as usize]) - L::load(&places[a[0] as usize]),
                L::load(&places[b[1] as usize]) - L::load(&places[a[1] as usize]),
                L::load(&places[b[2] as usize]) - L::load(&places[a[2] as usize]),
                L::load(&places[b[3] as usize]) - L::load(&places[a[3] as usize]),
            ];
            let [x, y, z, _] = L::transposed(d);
            let length = (x * x + y * y + z * z).sqrt().greatest(least);
            let rest = L::load(rest);
            let mut stretch = length - rest;
            if STIFFENING {
                let over = (length - rest * far).greatest(zero);
                let under = (length - rest * near).least(zero);
                stretch = stretch + over * more_far + under * more_near;
            }
            let pull = L::load(k) * stretch / length;
            let mut pulls = [0.0; 4];
            pull.store(&mut pulls);
            for s in 0..4 {
                let force = d[s] * L::splat(pulls[s]);
                let near = &mut residual[a[s] as usize];
                (L::load(near) + force).store(near);
                let far = &mut residual[b[s] as usize];
                (L::load(far) - force).store(far);
            }
        }
    }

    /// Σ of the springs' energies, J.
    pub(super) fn energy_j(&self, rest: &[Four], at: impl Fn(usize) -> Point3) -> f64 {
        let energy = |(block, place, a, b, k): (usize, usize, usize, usize, f64)| {
            let (length, rest) = ((at(b) - at(a)).norm(), rest[block][place]);
            let mut twice = (length - rest).powi(2);
            if let Some(law) = &self.stiffening {
                if law.strain.is_finite() {
                    twice += (law.ratio - 1.0) * (length - rest * (1.0 + law.strain)).max(0.0).powi(2);
                }
                twice += (law.least_length_ratio - 1.0) * (length - rest * law.least_length).min(0.0).powi(2);
            }
            0.5 * k * twice
        };
        self.each().map(energy).sum()
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_forces_wide(table: &SpringTable, rest: &[Four], places: &[Lane], residual: &mut [Lane]) {
    table.add_forces_in::<crate::math::lanes::Wide>(rest, places, residual);
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Random(u64);
    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        }
    }

    /// Random springs among random nodes; some nodes coincide.
    fn springs(random: &mut Random, nodes: usize, count: usize) -> (Vec<Spring>, Vec<Lane>) {
        let mut places: Vec<Lane> = (0..nodes).map(|_| [random.next(), random.next(), random.next(), 0.0]).collect();
        places[1] = places[0];
        let mut index = || ((random.next() + 0.5) * nodes as f64) as u32;
        let pairs: Vec<(u32, u32)> = (0..count).map(|_| (index(), index())).filter(|(a, b)| a != b).collect();
        let mut springs: Vec<Spring> = pairs
            .into_iter()
            .map(|(a, b)| Spring {
                a: a.min(b),
                b: a.max(b),
                stiffness_n_m: 50.0 * (random.next() + 0.6),
                rest_length_m: random.next() + 0.5,
            })
            .collect();
        springs.push(Spring { a: 0, b: 1, stiffness_n_m: 3.0, rest_length_m: 0.2 });
        (springs, places)
    }

    const LAW: Stiffening = Stiffening { strain: 0.2, ratio: 4.0, least_length: 0.5, least_length_ratio: 9.0 };

    #[test]
    fn forces_are_the_falling_slope_of_the_energy() {
        let mut random = Random(3);
        for law in [None, Some(LAW)] {
            let (springs, mut places) = springs(&mut random, 30, 201);
            places[1] = [0.7, 0.1, -0.3, 0.0];
            let table = SpringTable::new(&springs, law);
            let energy = |places: &[Lane]| {
                table.energy_j(table.rest(), |k| Point3::new(places[k][0], places[k][1], places[k][2]))
            };
            let mut forces = vec![[0.0; 4]; 30];
            table.add_forces(table.rest(), &places, &mut forces);
            let step = 1e-6;
            for node in 0..30 {
                for c in 0..3 {
                    let mut moved = places.clone();
                    moved[node][c] += step;
                    let above = energy(&moved);
                    moved[node][c] -= 2.0 * step;
                    let slope = (above - energy(&moved)) / (2.0 * step);
                    // Central differences of energies of some hundred joules.
                    assert!((forces[node][c] + slope).abs() < 1e-5, "{} is not {}", forces[node][c], -slope);
                }
            }
        }
    }

    #[test]
    fn every_spring_is_counted_once_and_pushes_both_ends_alike() {
        let mut random = Random(5);
        for count in [1, 2, 3, 4, 5, 63, 64, 65, 300] {
            let (springs, places) = springs(&mut random, 20, count);
            let table = SpringTable::new(&springs, None);
            let mut seen: Vec<(usize, usize)> = table.each().map(|(_, _, a, b, _)| (a, b)).collect();
            let mut asked: Vec<(usize, usize)> = springs.iter().map(|s| (s.a as usize, s.b as usize)).collect();
            seen.sort_unstable();
            asked.sort_unstable();
            assert_eq!(seen, asked);
            let mut forces = vec![[0.0; 4]; 20];
            table.add_forces(table.rest(), &places, &mut forces);
            for c in 0..3 {
                assert!(forces.iter().map(|f| f[c]).sum::<f64>().abs() < 1e-11);
                assert!(forces.iter().all(|f| f[c].is_finite()));
            }
        }
    }

    #[test]
    fn wide_registers_give_the_same_bits() {
        let mut random = Random(7);
        for law in [None, Some(LAW)] {
            let (springs, places) = springs(&mut random, 40, 401);
            let table = SpringTable::new(&springs, law);
            let (mut slow, mut fast) = (vec![[0.0; 4]; 40], vec![[0.0; 4]; 40]);
            table.add_forces_in::<Baseline>(table.rest(), &places, &mut slow);
            table.add_forces(table.rest(), &places, &mut fast);
            assert_eq!(slow, fast);
        }
    }
}
