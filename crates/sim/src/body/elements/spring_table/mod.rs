//! The force pass over springs, four side by side.
//!
//! g_i = Σ k (|d| − L) / |d| d, eqs. 5.8–5.13 of the thesis. A spring without length has no
//! direction and no force. Most springs of a lattice lie in [`panels`]; those left over are taken
//! in an order in which neighbours in memory share no node.

mod panels;
mod pull;

use super::law::Place;
use super::springs::Spring;
use crate::body::material::Stiffening;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3, simd};
pub use panels::ByCoordinate;
use panels::{Grouped, Panels};
use pull::Pull;

/// Springs four by four: first those in panels, then the others. The last block is filled up with
/// springs without stiffness from a node to itself.
#[derive(Clone, Debug, Default)]
pub(in crate::body) struct SpringTable {
    panels: Panels,
    /// (blocks of loose springs).
    a: Vec<[u32; 4]>,
    b: Vec<[u32; 4]>,
    /// (groups of panels, then blocks of loose springs).
    stiffness: Vec<Four>,
    rest: Vec<Four>,
    stiffening: Option<Stiffening>,
    count: usize,
    loose_count: usize,
    /// Spring by spring, in the order of [`SpringTable::each`]: its ends, its block and its place there.
    ends: Vec<([u32; 2], u32, u32)>,
}

/// Springs looked through for one that shares no node with its block.
const WINDOW: usize = 64;

impl SpringTable {
    /// Of springs in the order of their nodes, a < b.
    pub(in crate::body) fn new(springs: &[Spring], stiffening: Option<Stiffening>) -> Self {
        let Grouped {
            panels,
            stiffness,
            rest,
            loose,
        } = Panels::group(springs);
        let (count, loose_count) = (springs.len(), loose.len());
        let mut table = Self {
            panels,
            a: Vec::new(),
            b: Vec::new(),
            stiffness,
            rest,
            stiffening,
            count,
            loose_count,
            ends: Vec::new(),
        };
        let mut waiting: Vec<&Spring> = Vec::with_capacity(WINDOW);
        let mut coming = loose.iter();
        loop {
            while waiting.len() < WINDOW
                && let Some(spring) = coming.next()
            {
                waiting.push(spring);
            }
            if waiting.is_empty() {
                let ends = table.each().map(|(block, place, a, b, _)| {
                    ([a as u32, b as u32], block as u32, place as u32)
                });
                table.ends = ends.collect();
                return table;
            }
            let mut block: Vec<&Spring> = Vec::with_capacity(4);
            while block.len() < 4 && !waiting.is_empty() {
                let shares = |s: &&Spring| {
                    block
                        .iter()
                        .any(|o| s.a == o.a || s.a == o.b || s.b == o.a || s.b == o.b)
                };
                // A store into a node and the next load from it would wait for each other.
                let next = waiting
                    .iter()
                    .position(|spring| !shares(spring))
                    .unwrap_or(0);
                block.push(waiting.remove(next));
            }
            let get =
                |k: usize, of: fn(&Spring) -> f64| block.get(k).map_or(0.0, |spring| of(spring));
            table.a.push(std::array::from_fn(|k| {
                block.get(k).map_or(block[0].a, |spring| spring.a)
            }));
            table.b.push(std::array::from_fn(|k| {
                block.get(k).map_or(block[0].a, |spring| spring.b)
            }));
            table.stiffness.push(std::array::from_fn(|k| {
                get(k, |spring| spring.stiffness_n_m)
            }));
            table.rest.push(std::array::from_fn(|k| {
                get(k, |spring| spring.rest_length_m)
            }));
        }
    }

    /// Number of springs.
    pub(in crate::body) fn len(&self) -> usize {
        self.count
    }

    /// Rest lengths at the start, four by four.
    pub(in crate::body) fn rest(&self) -> &[Four] {
        &self.rest
    }

    /// The largest 1 − rest length / length of a spring at `places` (nodes); 0 where none is drawn.
    pub(in crate::body) fn greatest_stretch(&self, rest: &[Four], places: &[Lane]) -> f64 {
        // Of squares, so that there is one root.
        let mut least = 1.0_f64;
        for (block, place, a, b, _) in self.each() {
            let (a, b) = (&places[a], &places[b]);
            let square: f64 = (0..3).map(|k| (b[k] - a[k]) * (b[k] - a[k])).sum();
            let rest = rest[block][place];
            least = least.min(rest * rest / square.max(f64::MIN_POSITIVE));
        }
        1.0 - least.sqrt()
    }

    /// Hands out blocks of the tangent, N/m, along the springs stiffer by a margin, across them by their tension.
    pub(in crate::body) fn tangent_at(
        &self,
        at: &Place<'_>,
        margin: f64,
        out: &mut impl FnMut(u32, u32, Matrix3),
    ) {
        let rest = match at.metrics.is_empty() {
            true => self.rest(),
            false => at.metrics,
        };
        let place = |k: usize| {
            let [x, y, z, _] = at.places[k];
            Vector3::new(x, y, z)
        };
        for (block, lane, a, b, k) in self.each() {
            let edge = place(b) - place(a);
            let Some(way) = edge.try_normalize(0.0) else {
                continue;
            };
            let stretch = (1.0 - rest[block][lane] / edge.norm()).max(0.0);
            let along = way * way.transpose();
            let block = (along * margin + (Matrix3::identity() - along) * stretch) * k;
            out(a as u32, a as u32, block);
            out(b as u32, b as u32, block);
            out(a as u32, b as u32, -block);
        }
    }

    /// Springs by block and place: (block, place, a, b, k).
    pub(in crate::body) fn each(
        &self,
    ) -> impl Iterator<Item = (usize, usize, usize, usize, f64)> + '_ {
        let groups = self.panels.len();
        // Only the last block of loose springs may be short.
        let loose = (0..self.loose_count).map(move |k| {
            let (block, place) = (k / 4, k % 4);
            (
                groups + block,
                place,
                self.a[block][place] as usize,
                self.b[block][place] as usize,
            )
        });
        let all = self.panels.each().chain(loose);
        all.map(|(block, place, a, b)| (block, place, a, b, self.stiffness[block][place]))
    }

    /// The ends of each spring.
    pub(in crate::body) fn ends(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.ends.iter().map(|(ends, ..)| *ends)
    }

    /// Adds forces (N) of some springs, whose numbers count from a first one.
    pub(in crate::body) fn add_forces_of_some(
        &self,
        (some, first): (&[u32], u32),
        rest: &[Four],
        places: &[Lane],
        residual: &mut [Lane],
    ) {
        let law = self.stiffening.as_ref();
        let pull = Pull::<Baseline, true>::new(law);
        for four in some.chunks(4) {
            let (mut d, mut k, mut length) = ([[0.0; 4]; 3], [0.0; 4], [1.0; 4]);
            for (lane, number) in four.iter().enumerate() {
                let ([a, b], block, place) = self.ends[(number - first) as usize];
                let (from, to) = (&places[a as usize], &places[b as usize]);
                for axis in 0..3 {
                    d[axis][lane] = to[axis] - from[axis];
                }
                k[lane] = self.stiffness[block as usize][place as usize];
                length[lane] = rest[block as usize][place as usize];
            }
            let mut pulls = [0.0; 4];
            let [x, y, z] = &d;
            let along = [Baseline::load(x), Baseline::load(y), Baseline::load(z)];
            pull.of(along, &k, &length).store(&mut pulls);
            for (lane, number) in four.iter().enumerate() {
                let ([a, b], ..) = self.ends[(number - first) as usize];
                for axis in 0..3 {
                    let force = d[axis][lane] * pulls[lane];
                    residual[a as usize][axis] += force;
                    residual[b as usize][axis] -= force;
                }
            }
        }
    }

    /// Buffers of a pass.
    pub(in crate::body) fn buffers(&self) -> ByCoordinate {
        self.panels.buffers()
    }

    /// Adds forces (N) to `residual`; `rest`: lengths without force, four by four.
    pub(in crate::body) fn add_forces(
        &self,
        rest: &[Four],
        places: &[Lane],
        residual: &mut [Lane],
        buffers: &mut ByCoordinate,
    ) {
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_forces_wide(self, rest, places, residual, buffers) };
        }
        self.add_forces_in::<Baseline>(rest, places, residual, buffers);
    }

    #[inline(always)]
    fn add_forces_in<L: Lanes>(
        &self,
        rest: &[Four],
        places: &[Lane],
        residual: &mut [Lane],
        buffers: &mut ByCoordinate,
    ) {
        match &self.stiffening {
            None => self.run(
                &Pull::<L, false>::new(None),
                rest,
                places,
                residual,
                buffers,
            ),
            Some(law) => self.run(
                &Pull::<L, true>::new(Some(law)),
                rest,
                places,
                residual,
                buffers,
            ),
        }
    }

    // No closures here: what they call would not be compiled for the wider registers of the
    // function around them.
    #[inline(always)]
    fn run<L: Lanes, const STIFFENING: bool>(
        &self,
        pull: &Pull<L, STIFFENING>,
        rest: &[Four],
        places: &[Lane],
        residual: &mut [Lane],
        buffers: &mut ByCoordinate,
    ) {
        let (of_panels, stiffness) = self.stiffness.split_at(self.panels.len());
        let (rest_of_panels, rest) = rest.split_at(self.panels.len());
        self.panels
            .add_forces(pull, (of_panels, rest_of_panels), places, residual, buffers);
        for (((a, b), k), rest) in self.a.iter().zip(&self.b).zip(stiffness).zip(rest) {
            let d = [
                L::load(&places[b[0] as usize]) - L::load(&places[a[0] as usize]),
                L::load(&places[b[1] as usize]) - L::load(&places[a[1] as usize]),
                L::load(&places[b[2] as usize]) - L::load(&places[a[2] as usize]),
                L::load(&places[b[3] as usize]) - L::load(&places[a[3] as usize]),
            ];
            let [x, y, z, _] = L::transposed(d);
            let mut pulls = [0.0; 4];
            pull.of([x, y, z], k, rest).store(&mut pulls);
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
    pub(in crate::body) fn energy_j(&self, rest: &[Four], at: impl Fn(usize) -> Point3) -> f64 {
        let energy = |(block, place, a, b, k): (usize, usize, usize, usize, f64)| {
            let (length, rest) = ((at(b) - at(a)).norm(), rest[block][place]);
            let mut twice = (length - rest).powi(2);
            if let Some(law) = &self.stiffening {
                if law.strain.is_finite() {
                    twice +=
                        (law.ratio - 1.0) * (length - rest * (1.0 + law.strain)).max(0.0).powi(2);
                }
                twice += (law.least_length_ratio - 1.0)
                    * (length - rest * law.least_length).min(0.0).powi(2);
            }
            0.5 * k * twice
        };
        self.each().map(energy).sum()
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_forces_wide(
    table: &SpringTable,
    rest: &[Four],
    places: &[Lane],
    residual: &mut [Lane],
    buffers: &mut ByCoordinate,
) {
    table.add_forces_in::<palpate_geometry::math::lanes::Wide>(rest, places, residual, buffers);
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    /// Random springs among random nodes; some nodes coincide.
    fn springs(random: &mut Random, nodes: usize, count: usize) -> (Vec<Spring>, Vec<Lane>) {
        let mut places: Vec<Lane> = (0..nodes)
            .map(|_| {
                [
                    random.float(-0.5, 0.5),
                    random.float(-0.5, 0.5),
                    random.float(-0.5, 0.5),
                    0.0,
                ]
            })
            .collect();
        places[1] = places[0];
        let mut index = || ((random.float(-0.5, 0.5) + 0.5) * nodes as f64) as u32;
        let pairs: Vec<(u32, u32)> = (0..count)
            .map(|_| (index(), index()))
            .filter(|(a, b)| a != b)
            .collect();
        let mut springs: Vec<Spring> = pairs
            .into_iter()
            .map(|(a, b)| Spring {
                a: a.min(b),
                b: a.max(b),
                stiffness_n_m: 50.0 * (random.float(-0.5, 0.5) + 0.6),
                rest_length_m: random.float(-0.5, 0.5) + 0.5,
            })
            .collect();
        springs.push(Spring {
            a: 0,
            b: 1,
            stiffness_n_m: 3.0,
            rest_length_m: 0.2,
        });
        (springs, places)
    }

    const LAW: Stiffening = Stiffening {
        strain: 0.2,
        ratio: 4.0,
        least_length: 0.5,
        least_length_ratio: 9.0,
    };

    #[test]
    fn forces_are_the_falling_slope_of_the_energy() {
        let mut random = Random(3);
        for law in [None, Some(LAW)] {
            let (springs, mut places) = springs(&mut random, 30, 201);
            places[1] = [0.7, 0.1, -0.3, 0.0];
            let table = SpringTable::new(&springs, law);
            let energy = |places: &[Lane]| {
                table.energy_j(table.rest(), |k| {
                    Point3::new(places[k][0], places[k][1], places[k][2])
                })
            };
            let mut forces = vec![[0.0; 4]; 30];
            table.add_forces(table.rest(), &places, &mut forces, &mut table.buffers());
            let step = 1e-6;
            for node in 0..30 {
                for c in 0..3 {
                    let mut moved = places.clone();
                    moved[node][c] += step;
                    let above = energy(&moved);
                    moved[node][c] -= 2.0 * step;
                    let slope = (above - energy(&moved)) / (2.0 * step);
                    // Central differences of energies of some hundred joules.
                    assert!(
                        (forces[node][c] + slope).abs() < 1e-5,
                        "{} is not {}",
                        forces[node][c],
                        -slope
                    );
                }
            }
        }
    }

    /// Springs of a bent lattice, and a few across it.
    fn lattice(random: &mut Random, [m, n, o]: [u32; 3]) -> (Vec<Spring>, Vec<Lane>) {
        let index = |i: u32, j: u32, k: u32| (i * n + j) * o + k;
        let mut pairs = Vec::new();
        for (i, j, k) in
            (0..m).flat_map(|i| (0..n).flat_map(move |j| (0..o).map(move |k| (i, j, k))))
        {
            for (di, dj, dk) in [
                (0, 0, 1),
                (0, 1, 0),
                (0, 1, 1),
                (1, 0, 0),
                (1, 0, 1),
                (1, 1, 0),
            ] {
                if i + di < m && j + dj < n && k + dk < o {
                    pairs.push((index(i, j, k), index(i + di, j + dj, k + dk)));
                }
            }
        }
        pairs.extend([(0, m * n * o - 1), (1, m * n * o - 1), (2, 2 + m)]);
        pairs.sort_unstable();
        let spring = |(a, b)| Spring {
            a,
            b,
            stiffness_n_m: 1.0 + random.float(-0.5, 0.5),
            rest_length_m: 0.9 + random.float(-0.5, 0.5),
        };
        let springs = pairs.into_iter().map(spring).collect();
        let places = (0..m * n * o).map(|k| f64::from(k) + random.float(-0.5, 0.5));
        let places = places
            .map(|k| [libm::sin(k), libm::cos(1.7 * k), 0.1 * k, 0.0])
            .collect();
        (springs, places)
    }

    #[test]
    fn lattices_lie_in_panels_and_feel_what_each_spring_does() {
        let mut random = Random(11);
        for size in [[2, 2, 2], [3, 4, 5], [5, 5, 7], [4, 4, 4]] {
            for law in [None, Some(LAW)] {
                let (springs, places) = lattice(&mut random, size);
                let table = SpringTable::new(&springs, law);
                assert!(
                    table.loose_count < springs.len() / 4 + 12,
                    "{} loose of {}",
                    table.loose_count,
                    springs.len()
                );
                let mut asked: Vec<_> = springs
                    .iter()
                    .map(|s| (s.a as usize, s.b as usize, s.stiffness_n_m))
                    .collect();
                let mut seen: Vec<_> = table.each().map(|(.., a, b, k)| (a, b, k)).collect();
                asked.sort_by(|s, t| s.partial_cmp(t).unwrap());
                seen.sort_by(|s, t| s.partial_cmp(t).unwrap());
                assert_eq!(seen, asked);
                let rest: Vec<f64> = table
                    .each()
                    .map(|(block, place, ..)| table.rest()[block][place])
                    .collect();
                let asked_rest: f64 = springs.iter().map(|s| s.rest_length_m).sum();
                assert!((rest.iter().sum::<f64>() - asked_rest).abs() < 1e-9);

                let mut expected = vec![[0.0; 3]; places.len()];
                for s in &springs {
                    let (a, b) = (s.a as usize, s.b as usize);
                    let d: [f64; 3] = std::array::from_fn(|c| places[b][c] - places[a][c]);
                    let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
                    let mut stretch = length - s.rest_length_m;
                    if let Some(law) = law {
                        stretch += (law.ratio - 1.0)
                            * (length - s.rest_length_m * (1.0 + law.strain)).max(0.0);
                        stretch += (law.least_length_ratio - 1.0)
                            * (length - s.rest_length_m * law.least_length).min(0.0);
                    }
                    for c in 0..3 {
                        expected[a][c] += s.stiffness_n_m * stretch / length * d[c];
                        expected[b][c] -= s.stiffness_n_m * stretch / length * d[c];
                    }
                }
                let (mut forces, mut buffers) = (vec![[0.5; 4]; places.len()], table.buffers());
                for pass in 0..2 {
                    forces.iter_mut().for_each(|f| f[..3].fill(0.5));
                    table.add_forces(table.rest(), &places, &mut forces, &mut buffers);
                    for (got, want) in forces.iter().zip(&expected) {
                        for c in 0..3 {
                            assert!(
                                (got[c] - 0.5 - want[c]).abs() < 1e-12,
                                "pass {pass}: {got:?} is not {want:?}"
                            );
                        }
                    }
                }
                let mut slow = vec![[0.5; 4]; places.len()];
                table.add_forces_in::<Baseline>(table.rest(), &places, &mut slow, &mut buffers);
                assert_eq!(slow, forces);
            }
        }
    }

    #[test]
    fn every_spring_is_counted_once_and_pushes_both_ends_alike() {
        let mut random = Random(5);
        for count in [1, 2, 3, 4, 5, 63, 64, 65, 300] {
            let (springs, places) = springs(&mut random, 20, count);
            let table = SpringTable::new(&springs, None);
            let mut seen: Vec<(usize, usize)> =
                table.each().map(|(_, _, a, b, _)| (a, b)).collect();
            let mut asked: Vec<(usize, usize)> = springs
                .iter()
                .map(|s| (s.a as usize, s.b as usize))
                .collect();
            seen.sort_unstable();
            asked.sort_unstable();
            assert_eq!(seen, asked);
            let mut forces = vec![[0.0; 4]; 20];
            table.add_forces(table.rest(), &places, &mut forces, &mut table.buffers());
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
            table.add_forces_in::<Baseline>(table.rest(), &places, &mut slow, &mut table.buffers());
            table.add_forces(table.rest(), &places, &mut fast, &mut table.buffers());
            assert_eq!(slow, fast);
        }
    }
}
