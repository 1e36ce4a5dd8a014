//! What rows on a deforming surface do to each other: J A Jᵀ, J the weights of the rows, A the operator by which the
//! body's step answers loads, in 3 × 3 blocks between coordinates of its net.
//!
//! Rows share control points, so each block that matters is read once for a batch of pushes. Blocks stand between frames
//! that turn with the body: directions are turned into the frame of each control point, displacements back.

use super::rigid_part::{Loads, RigidPart};
use palpate_geometry::math::lanes::{Baseline, Lanes};
use palpate_geometry::math::{Lane, Vector3, simd};

/// No slot.
const NONE: u32 = u32::MAX;
/// Pushes whose answers are found together.
const BATCH: usize = 3 * 128;
/// Directions of a side, at most.
const MOST: usize = 3;

/// Rows of a rotation.
pub type Frame = [[f64; 3]; 3];

/// The operator of a body, by place on its net.
pub trait Compliance {
    /// How a force at a place moves all of them, m/N: blocks by columns.
    fn column(&self, place: usize) -> &[[f32; 9]];
    /// The frame of a place.
    fn frame(&self, place: usize) -> &Frame;
    /// Of a free body, what rigid motions add.
    fn rigid(&self) -> Option<&RigidPart> {
        None
    }
}

/// Buffers for up to a number of sides of rows on one body.
#[derive(Clone, Debug)]
pub struct Delassus {
    /// (places): slot among those concerned.
    slot_of: Vec<u32>,
    sides: Vec<Side>,
    /// Of side after side.
    entries: Vec<Entry>,
    /// Of side after side, a push for each direction of its row's force.
    pushes: Vec<Push>,
    /// Places concerned, ascending, and where those who push each begin in `by_slot`.
    concerned: Vec<Concerned>,
    /// Of slot after slot: push, and where the push in the frame of the slot is.
    by_slot: Vec<(u32, u32)>,
    /// Of push after push and entry after entry, weighted directions in the frame of the entry's place.
    turned: Vec<Lane>,
    /// What a batch of pushes does at the slots, push after push, m/N.
    response: Vec<Lane>,
}

#[derive(Clone, Copy, Debug)]
struct Side {
    row: u32,
    sign: f64,
    start: u32,
    end: u32,
}

impl Side {
    fn range(&self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// A unit force on a side.
#[derive(Clone, Copy, Debug)]
struct Push {
    side: u32,
    direction: u32,
    way: Vector3,
    /// Where it begins in `turned`.
    start: u32,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    /// A place, then its slot.
    slot: u32,
    weight: f64,
}

#[derive(Clone, Copy, Debug)]
struct Concerned {
    place: u32,
    start: u32,
}

/// How a force on one side moves another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairOfSides {
    /// The row that is moved, and the row that the force is on.
    pub rows: [usize; 2],
    /// Which of the directions of the row's force.
    pub direction: usize,
    /// The displacement under one newton with the signs of both sides, m; half of it where they are one side, so that
    /// it is whole with its mirror image, as others are.
    pub moved: Vector3,
}

impl Delassus {
    /// Room for `sides` of `width` weights each, on nets of at most `places`.
    pub fn new(sides: usize, width: usize, places: usize) -> Self {
        let entries = sides * width;
        let slots = places.min(entries);
        Self {
            slot_of: vec![NONE; places],
            sides: Vec::with_capacity(sides),
            entries: Vec::with_capacity(entries),
            pushes: Vec::with_capacity(MOST * sides),
            concerned: Vec::with_capacity(slots),
            by_slot: vec![(0, 0); MOST * entries],
            turned: vec![[0.0; 4]; MOST * entries],
            response: vec![[0.0; 4]; slots * (MOST * sides).min(BATCH)],
        }
    }

    /// No sides.
    pub fn clear(&mut self) {
        for seen in &self.concerned {
            self.slot_of[seen.place as usize] = NONE;
        }
        self.sides.clear();
        self.entries.clear();
        self.pushes.clear();
        self.concerned.clear();
    }

    /// Adds a side of a row, pushed as the row's holder is times `sign`, in so many `directions`: (place, weight) of
    /// its control points that move.
    pub fn add(
        &mut self,
        row: usize,
        sign: f64,
        directions: impl Iterator<Item = Vector3>,
        weights: impl Iterator<Item = (usize, f64)>,
    ) {
        debug_assert!(sign.abs() == 1.0, "a side is pushed along or against");
        debug_assert!(
            self.sides.len() < self.sides.capacity(),
            "no room for a side"
        );
        let start = self.entries.len() as u32;
        for (place, weight) in weights {
            if self.slot_of[place] == NONE {
                self.slot_of[place] = 0;
                let place = place as u32;
                self.concerned.push(Concerned { place, start: 0 });
            }
            let slot = place as u32;
            self.entries.push(Entry { slot, weight });
        }
        let side = self.sides.len() as u32;
        let pushes = directions.zip(0..).map(|(way, direction)| Push {
            side,
            direction,
            way,
            start: 0,
        });
        self.pushes.extend(pushes);
        self.sides.push(Side {
            row: row as u32,
            sign,
            start,
            end: self.entries.len() as u32,
        });
    }

    /// True without sides.
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty()
    }

    /// Orders places as they lie in every column, and pushes by slot. To be called once all sides are there.
    pub fn sort(&mut self) {
        self.concerned.sort_unstable_by_key(|seen| seen.place);
        for (slot, seen) in self.concerned.iter_mut().enumerate() {
            self.slot_of[seen.place as usize] = slot as u32;
            seen.start = 0;
        }
        for entry in &mut self.entries {
            entry.slot = self.slot_of[entry.slot as usize];
        }
        // Counts, then ends, then, filled from the back, starts.
        let mut count = 0;
        for push in &mut self.pushes {
            push.start = count;
            for entry in &self.entries[self.sides[push.side as usize].range()] {
                self.concerned[entry.slot as usize].start += 1;
                count += 1;
            }
        }
        debug_assert!(count as usize <= self.turned.len(), "no room for weights");
        self.by_slot.resize(count as usize, (0, 0));
        let mut end = 0;
        for seen in &mut self.concerned {
            end += seen.start;
            seen.start = end;
        }
        for (p, push) in self.pushes.iter().enumerate().rev() {
            let own = &self.entries[self.sides[push.side as usize].range()];
            for (e, entry) in own.iter().enumerate().rev() {
                let start = &mut self.concerned[entry.slot as usize].start;
                *start -= 1;
                self.by_slot[*start as usize] = (p as u32, push.start + e as u32);
            }
        }
    }

    /// Calls `add` for every push of every two sides, the row that is moved no later than the other.
    pub fn each_pair(&mut self, compliance: &impl Compliance, mut add: impl FnMut(PairOfSides)) {
        self.turn(compliance);
        for first in (0..self.pushes.len()).step_by(BATCH) {
            let last = (first + BATCH).min(self.pushes.len());
            self.respond(compliance, first, last);
            self.turn_back(compliance, last - first);
            if let Some(rigid) = compliance.rigid() {
                self.add_rigid(rigid, first..last);
            }
            let mut next = first;
            for of_side in self.pushes[first..last].chunk_by(|a, b| a.side == b.side) {
                for t in 0..=of_side[0].side as usize {
                    for (k, push) in of_side.iter().enumerate() {
                        add(self.pair(push, t, next + k - first));
                    }
                }
                next += of_side.len();
            }
        }
    }

    /// Adds what the rigid motions of a free body do at the slots, in the world.
    fn add_rigid(&mut self, rigid: &RigidPart, pushes: std::ops::Range<usize>) {
        let slots = self.concerned.len();
        let responses = self.response.chunks_exact_mut(slots.max(1));
        for (push, response) in self.pushes[pushes].iter().zip(responses) {
            let mut loads = Loads::default();
            for entry in &self.entries[self.sides[push.side as usize].range()] {
                let place = self.concerned[entry.slot as usize].place as usize;
                rigid.add(place, &(push.way * entry.weight), &mut loads);
            }
            let amounts = rigid.amounts(&loads);
            for (moved, seen) in response.iter_mut().zip(&self.concerned) {
                add_to(moved, &rigid.moved(seen.place as usize, &amounts));
            }
        }
    }

    /// Turns all pushes into the frames of their places.
    fn turn(&mut self, compliance: &impl Compliance) {
        for push in &self.pushes {
            let own = &self.entries[self.sides[push.side as usize].range()];
            for (to, entry) in self.turned[push.start as usize..].iter_mut().zip(own) {
                let place = self.concerned[entry.slot as usize].place as usize;
                *to = into_rest(compliance.frame(place), &push.way, entry.weight);
            }
        }
    }

    /// Finds what a batch of pushes does at all slots, in the frames of the slots.
    fn respond(&mut self, compliance: &impl Compliance, first: usize, last: usize) {
        let slots = self.concerned.len();
        self.response[..slots * (last - first)].fill([0.0; 4]);
        for slot in 0..slots {
            let end = self.concerned.get(slot + 1);
            let end = end.map_or(self.by_slot.len(), |next| next.start as usize);
            let own = &self.by_slot[self.concerned[slot].start as usize..end];
            let from = own.partition_point(|entry| (entry.0 as usize) < first);
            let to = own.partition_point(|entry| (entry.0 as usize) < last);
            let batch = Batch {
                entries: &own[from..to],
                first,
                concerned: &self.concerned,
                turned: &self.turned,
            };
            let column = compliance.column(self.concerned[slot].place as usize);
            batch.add(column, &mut self.response);
        }
    }

    /// Turns what a batch does at the slots into the world.
    fn turn_back(&mut self, compliance: &impl Compliance, pushes: usize) {
        let of_pushes = self.response.chunks_mut(self.concerned.len().max(1));
        for of_push in of_pushes.take(pushes) {
            for (moved, seen) in of_push.iter_mut().zip(&self.concerned) {
                *moved = from_rest(compliance.frame(seen.place as usize), moved);
            }
        }
    }

    /// How the `p`-th push of a batch moves a side.
    fn pair(&self, push: &Push, t: usize, p: usize) -> PairOfSides {
        let slots = self.concerned.len();
        let response = &self.response[slots * p..slots * (p + 1)];
        let moved_side = &self.sides[t];
        let pushed = &self.sides[push.side as usize];
        let mut moved = [0.0; 4];
        for entry in &self.entries[moved_side.range()] {
            for (sum, part) in moved.iter_mut().zip(&response[entry.slot as usize]) {
                *sum += entry.weight * part;
            }
        }
        let share = if push.side as usize == t { 0.5 } else { 1.0 };
        let [x, y, z, _] = moved;
        PairOfSides {
            rows: [moved_side.row as usize, pushed.row as usize],
            direction: push.direction as usize,
            moved: Vector3::new(x, y, z) * (pushed.sign * moved_side.sign * share),
        }
    }

    /// Calls `add` with each row and how far loads on the net (place, N) move its sides, signs included, m.
    pub fn each_moved(
        &mut self,
        compliance: &impl Compliance,
        loads: impl Iterator<Item = (usize, Vector3)>,
        mut add: impl FnMut(usize, Vector3),
    ) {
        let slots = self.concerned.len();
        self.response[..slots].fill([0.0; 4]);
        let (rigid, mut sum) = (compliance.rigid(), Loads::default());
        for (place, force) in loads {
            if let Some(rigid) = rigid {
                rigid.add(place, &force, &mut sum);
            }
            self.turned[0] = into_rest(compliance.frame(place), &force, 1.0);
            let batch = Batch {
                entries: &[(0, 0)],
                first: 0,
                concerned: &self.concerned,
                turned: &self.turned,
            };
            batch.add(compliance.column(place), &mut self.response);
        }
        self.turn_back(compliance, 1);
        if let Some(rigid) = rigid {
            let amounts = rigid.amounts(&sum);
            for (moved, seen) in self.response.iter_mut().zip(&self.concerned) {
                add_to(moved, &rigid.moved(seen.place as usize, &amounts));
            }
        }
        for side in &self.sides {
            let mut moved = Vector3::zeros();
            for entry in &self.entries[side.range()] {
                let [x, y, z, _] = self.response[entry.slot as usize];
                moved += Vector3::new(x, y, z) * (entry.weight * side.sign);
            }
            add(side.row as usize, moved);
        }
    }
}

fn add_to(lane: &mut Lane, v: &Vector3) {
    for (to, part) in lane.iter_mut().zip(v.iter()) {
        *to += part;
    }
}

/// w Rᵀ v.
fn into_rest(frame: &Frame, v: &Vector3, weight: f64) -> Lane {
    let [a, b, c] = frame;
    let turned = |k: usize| (a[k] * v.x + b[k] * v.y + c[k] * v.z) * weight;
    [turned(0), turned(1), turned(2), 0.0]
}

/// R v.
fn from_rest(frame: &Frame, v: &Lane) -> Lane {
    let turned = frame.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    [turned[0], turned[1], turned[2], 0.0]
}

/// Pushes at one slot in a batch.
struct Batch<'a> {
    /// Push, and where it is in `turned`.
    entries: &'a [(u32, u32)],
    first: usize,
    concerned: &'a [Concerned],
    turned: &'a [Lane],
}

impl Batch<'_> {
    /// Adds what they do at all slots; `column`: the blocks of their place.
    fn add(&self, column: &[[f32; 9]], response: &mut [Lane]) {
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_wide(self, column, response) };
        }
        self.add_in::<Baseline>(column, response);
    }

    #[inline(always)]
    fn add_in<L: Lanes>(&self, column: &[[f32; 9]], response: &mut [Lane]) {
        let slots = self.concerned.len();
        for (slot, seen) in self.concerned.iter().enumerate() {
            let block = &column[seen.place as usize];
            let wide = |k: usize| {
                [
                    block[k].into(),
                    block[k + 1].into(),
                    block[k + 2].into(),
                    0.0,
                ]
            };
            let columns = [L::load(&wide(0)), L::load(&wide(3)), L::load(&wide(6))];
            for &(push, at) in self.entries {
                let way = &self.turned[at as usize];
                let moved = &mut response[slots * (push as usize - self.first) + slot];
                let first = L::load(moved) + columns[0] * L::splat(way[0]);
                let rest = columns[1] * L::splat(way[1]) + columns[2] * L::splat(way[2]);
                (first + rest).store(moved);
            }
        }
    }
}

/// The same code with 256-bit registers; nothing is fused, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_wide(batch: &Batch<'_>, column: &[[f32; 9]], response: &mut [Lane]) {
    batch.add_in::<palpate_geometry::math::lanes::Wide>(column, response);
}

#[cfg(test)]
mod tests {
    use super::super::matrix::directions;
    use super::*;
    use palpate_geometry::math::{Matrix3, Random, rotation_by};

    struct Dense {
        places: usize,
        blocks: Vec<[f32; 9]>,
        frames: Vec<Frame>,
    }

    impl Dense {
        /// F Fᵀ of a random F, so that it is symmetric, between random frames.
        fn new(places: usize, random: &mut Random) -> Self {
            let size = 3 * places;
            let factor: Vec<f64> = (0..size * size).map(|_| random.unit()).collect();
            let entry = |i: usize, j: usize| -> f32 {
                let products = (0..size).map(|k| factor[i * size + k] * factor[j * size + k]);
                products.sum::<f64>() as f32
            };
            let block =
                |b: usize, a: usize| std::array::from_fn(|k| entry(3 * a + k % 3, 3 * b + k / 3));
            let column = |b: usize| (0..places).map(move |a| (b, a));
            let frame = |_| {
                let turn = rotation_by(&random.vector()).to_rotation_matrix();
                std::array::from_fn(|r| std::array::from_fn(|c| turn[(r, c)]))
            };
            Self {
                places,
                blocks: (0..places)
                    .flat_map(column)
                    .map(|(b, a)| block(b, a))
                    .collect(),
                frames: (0..places).map(frame).collect(),
            }
        }

        /// R_a C_ab R_bᵀ.
        fn world(&self, a: usize, b: usize) -> Matrix3 {
            let turn = |k: usize| Matrix3::from_fn(|r, c| self.frames[k][r][c]);
            let block = &self.blocks[b * self.places + a];
            let block = Matrix3::from_fn(|r, c| f64::from(block[3 * c + r]));
            turn(a) * block * turn(b).transpose()
        }
    }

    impl Compliance for Dense {
        fn column(&self, place: usize) -> &[[f32; 9]] {
            &self.blocks[place * self.places..(place + 1) * self.places]
        }
        fn frame(&self, place: usize) -> &Frame {
            &self.frames[place]
        }
    }

    type DenseSide = (usize, f64, Vec<(usize, f64)>);

    fn normal(row: usize) -> Vector3 {
        Vector3::new(1.0, 0.1 * row as f64, -0.5)
    }

    fn sides(
        delassus: &mut Delassus,
        count: usize,
        places: usize,
        random: &mut Random,
    ) -> Vec<DenseSide> {
        delassus.clear();
        let mut all: Vec<DenseSide> = Vec::new();
        for row in 0..count {
            for side in 0..row % 3 {
                let sign = if side == 0 { -1.0 } else { 1.0 };
                let place = |k: usize| (7 * row + 3 * k + 11 * side) % places;
                let weights: Vec<_> = (0..1 + row % 5)
                    .map(|k| (place(k), random.unit()))
                    .collect();
                let ways = directions(&normal(row), row % 4 == 1);
                delassus.add(row, sign, ways, weights.iter().copied());
                all.push((row, sign, weights));
            }
        }
        delassus.sort();
        all
    }

    // Against the product of dense matrices, also in more than one batch.
    #[test]
    fn pairs_and_loads_are_those_of_the_dense_product() {
        let mut random = Random(3);
        let places = 13;
        let dense = Dense::new(places, &mut random);
        let mut delassus = Delassus::new(300, 5, places);
        for count in [12, 200, 3] {
            let all = sides(&mut delassus, count, places, &mut random);
            let mut pushes = all.iter().enumerate().flat_map(|(s, side)| {
                let ways = directions(&normal(side.0), side.0 % 4 == 1);
                let by = move |t| ways.clone().enumerate().map(move |push| (s, t, push));
                (0..=s).flat_map(by)
            });
            delassus.each_pair(&dense, |pair| {
                let (s, t, (direction, way)) = pushes.next().unwrap();
                let (pushed, moved) = (&all[s], &all[t]);
                let mut expected = Matrix3::zeros();
                for &(a, u) in &moved.2 {
                    for &(b, w) in &pushed.2 {
                        expected += dense.world(a, b) * (u * w * moved.1 * pushed.1);
                    }
                }
                if s == t {
                    expected *= 0.5;
                }
                assert_eq!(
                    (pair.rows, pair.direction),
                    ([moved.0, pushed.0], direction)
                );
                let off = (pair.moved - expected * way).norm();
                assert!(off < 1e-10, "{}", pair.moved);
            });
            assert!(pushes.next().is_none());
            let loads: Vec<(usize, Vector3)> = (0..4).map(|k| (3 * k, random.vector())).collect();
            let mut each = all.iter();
            delassus.each_moved(&dense, loads.iter().copied(), |row, found| {
                let (expected_row, sign, weights) = each.next().unwrap();
                let mut expected = Vector3::zeros();
                for &(a, u) in weights {
                    for (b, force) in &loads {
                        expected += dense.world(a, *b) * force * (u * sign);
                    }
                }
                assert!(row == *expected_row && (found - expected).norm() < 1e-10);
            });
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn wide_registers_give_the_same_bits() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            return;
        }
        let mut random = Random(5);
        let dense = Dense::new(9, &mut random);
        let concerned: Vec<Concerned> = (0..9).map(|place| Concerned { place, start: 0 }).collect();
        let turned: Vec<Lane> = (0..2)
            .map(|_| [random.unit(), random.unit(), random.unit(), 0.0])
            .collect();
        let batch = Batch {
            entries: &[(0, 0), (1, 1)],
            first: 0,
            concerned: &concerned,
            turned: &turned,
        };
        let (mut slow, mut fast) = (vec![[0.1; 4]; 18], vec![[0.1; 4]; 18]);
        batch.add_in::<Baseline>(dense.column(4), &mut slow);
        // SAFETY: asked just above.
        #[allow(unsafe_code)]
        unsafe {
            add_wide(&batch, dense.column(4), &mut fast);
        }
        assert_eq!(slow, fast);
    }
}
