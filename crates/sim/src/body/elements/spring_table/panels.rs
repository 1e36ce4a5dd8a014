//! Springs of four nodes in a row to four nodes in a row, as lattices number them.
//!
//! Nodes a … a + 3 of a block and their neighbours b … b + 3 lie side by side in memory, coordinate
//! by coordinate: forces of the block stay in registers, and nothing is gathered, scattered or
//! transposed. A lane without a spring has no stiffness.

use super::pull::Pull;
use crate::body::elements::springs::Spring;
use palpate_geometry::math::Lane;
use palpate_geometry::math::lanes::{Four, Lanes, load, store};

/// A group with fewer springs is as cheap among those without order.
const LEAST_FILLED: usize = 2;

/// All groups of four.
#[derive(Clone, Debug, Default)]
pub(super) struct Panels {
    blocks: Vec<PanelBlock>,
    /// (groups): b − a.
    offsets: Vec<u32>,
    /// (groups): bit k where lane k has a spring.
    filled: Vec<u8>,
    /// Nodes, up to the next multiple of four.
    room: usize,
}

/// Four nodes, and their groups.
#[derive(Clone, Copy, Debug)]
struct PanelBlock {
    first_node: u32,
    begin: u32,
    end: u32,
}

/// Places and forces of nodes by coordinate: x …, y …, z ….
#[derive(Clone, Debug, Default)]
pub struct ByCoordinate {
    places: Vec<f64>,
    forces: Vec<f64>,
}

/// Groups made of springs, and the springs that are in none.
pub(super) struct Grouped {
    pub(super) panels: Panels,
    pub(super) stiffness: Vec<Four>,
    pub(super) rest: Vec<Four>,
    pub(super) loose: Vec<Spring>,
}

impl Panels {
    /// Of springs with a < b, sorted by a.
    pub(super) fn group(springs: &[Spring]) -> Grouped {
        let nodes = springs.iter().map(|s| s.b as usize + 1).max().unwrap_or(0);
        let mut out = Grouped {
            panels: Self {
                room: nodes.next_multiple_of(4),
                ..Self::default()
            },
            stiffness: Vec::new(),
            rest: Vec::new(),
            loose: Vec::new(),
        };
        for of_block in springs.chunk_by(|s, t| s.a / 4 == t.a / 4) {
            let mut sorted: Vec<&Spring> = of_block.iter().collect();
            sorted.sort_by_key(|s| (s.b - s.a, s.a));
            let (first_node, begin) = (sorted[0].a / 4 * 4, out.panels.offsets.len() as u32);
            for group in sorted.chunk_by(|s, t| s.b - s.a == t.b - t.a) {
                let offset = group[0].b - group[0].a;
                let twice = group.windows(2).any(|pair| pair[0].a == pair[1].a);
                if group.len() < LEAST_FILLED
                    || twice
                    || (first_node + offset) as usize + 4 > out.panels.room
                {
                    out.loose.extend(group.iter().copied());
                    continue;
                }
                let (mut stiffness, mut rest, mut filled) = ([0.0; 4], [1.0; 4], 0);
                for spring in group {
                    let lane = (spring.a - first_node) as usize;
                    (stiffness[lane], rest[lane]) = (spring.stiffness_n_m, spring.rest_length_m);
                    filled |= 1 << lane;
                }
                out.stiffness.push(stiffness);
                out.rest.push(rest);
                out.panels.offsets.push(offset);
                out.panels.filled.push(filled);
            }
            let end = out.panels.offsets.len() as u32;
            if end > begin {
                out.panels.blocks.push(PanelBlock {
                    first_node,
                    begin,
                    end,
                });
            }
        }
        out
    }

    /// Number of groups.
    pub(super) fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Springs: (group, lane, a, b).
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, usize, usize, usize)> + '_ {
        let lanes =
            move |group: usize| (0..4).filter(move |lane| self.filled[group] >> lane & 1 == 1);
        let of_block = move |block: &PanelBlock| {
            let first = block.first_node as usize;
            (block.begin as usize..block.end as usize).flat_map(move |group| {
                lanes(group).map(move |k| {
                    (
                        group,
                        k,
                        first + k,
                        first + k + self.offsets[group] as usize,
                    )
                })
            })
        };
        self.blocks.iter().flat_map(of_block)
    }

    /// Buffers of a pass.
    pub(super) fn buffers(&self) -> ByCoordinate {
        let size = if self.blocks.is_empty() {
            0
        } else {
            3 * self.room
        };
        ByCoordinate {
            places: vec![0.0; size],
            forces: vec![0.0; size],
        }
    }

    /// Adds forces (N) to `residual`. `stiffness`, `rest`: of each group.
    // No closures here: what they call would not be compiled for the wider registers of the
    // function around them.
    #[inline(always)]
    pub(super) fn add_forces<L: Lanes, const STIFFENING: bool>(
        &self,
        pull: &Pull<L, STIFFENING>,
        (stiffness, rest): (&[Four], &[Four]),
        places: &[Lane],
        residual: &mut [Lane],
        buffers: &mut ByCoordinate,
    ) {
        if self.blocks.is_empty() {
            return;
        }
        let ByCoordinate {
            places: from,
            forces: to,
        } = buffers;
        let (y, z) = (self.room, 2 * self.room);
        spread::<L>(places, from, self.room);
        to.fill(0.0);
        for block in &self.blocks {
            let a = block.first_node as usize;
            let groups = block.begin as usize..block.end as usize;
            let (ax, ay, az) = (
                load::<L>(from, a),
                load::<L>(from, a + y),
                load::<L>(from, a + z),
            );
            let (mut sx, mut sy, mut sz) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
            let constants = self.offsets[groups.clone()]
                .iter()
                .zip(&stiffness[groups.clone()])
                .zip(&rest[groups]);
            for ((offset, stiffness), rest) in constants {
                let b = a + *offset as usize;
                let (bx, by, bz) = (
                    load::<L>(from, b),
                    load::<L>(from, b + y),
                    load::<L>(from, b + z),
                );
                let (dx, dy, dz) = (bx - ax, by - ay, bz - az);
                let pull = pull.of([dx, dy, dz], stiffness, rest);
                let (px, py, pz) = (dx * pull, dy * pull, dz * pull);
                (sx, sy, sz) = (sx + px, sy + py, sz + pz);
                store(load::<L>(to, b) - px, to, b);
                store(load::<L>(to, b + y) - py, to, b + y);
                store(load::<L>(to, b + z) - pz, to, b + z);
            }
            store(load::<L>(to, a) + sx, to, a);
            store(load::<L>(to, a + y) + sy, to, a + y);
            store(load::<L>(to, a + z) + sz, to, a + z);
        }
        gather::<L>(to, self.room, residual);
    }
}

/// Rows of points to coordinates, `room` of each.
#[inline(always)]
fn spread<L: Lanes>(rows: &[Lane], to: &mut [f64], room: usize) {
    let (fours, odd) = rows[..rows.len().min(room)].as_chunks::<4>();
    for (k, [a, b, c, d]) in fours.iter().enumerate() {
        let [x, y, z, _] = L::transposed([L::load(a), L::load(b), L::load(c), L::load(d)]);
        store(x, to, 4 * k);
        store(y, to, 4 * k + room);
        store(z, to, 4 * k + 2 * room);
    }
    for (k, row) in (4 * fours.len()..).zip(odd) {
        (to[k], to[k + room], to[k + 2 * room]) = (row[0], row[1], row[2]);
    }
}

/// Adds coordinates to rows of points.
#[inline(always)]
fn gather<L: Lanes>(from: &[f64], room: usize, rows: &mut [Lane]) {
    let count = rows.len().min(room);
    let (fours, odd) = rows[..count].as_chunks_mut::<4>();
    for (k, four) in fours.iter_mut().enumerate() {
        let (x, y, z) = (
            load(from, 4 * k),
            load(from, 4 * k + room),
            load(from, 4 * k + 2 * room),
        );
        let parts = L::transposed([x, y, z, L::splat(0.0)]);
        for j in 0..4 {
            (L::load(&four[j]) + parts[j]).store(&mut four[j]);
        }
    }
    for (k, row) in (count / 4 * 4..).zip(odd) {
        for c in 0..3 {
            row[c] += from[k + c * room];
        }
    }
}
