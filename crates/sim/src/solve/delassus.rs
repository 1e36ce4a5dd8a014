//! What rows on a deforming surface do to each other: J A Jᵀ, J the weights of the rows, A the operator by which the
//! body's step answers loads, in 3 × 3 blocks between coordinates of its net.
//!
//! Rows share control points, so each block that matters is read once for a batch of sides. Blocks stand between frames
//! that turn with the body: directions are turned into the frame of each control point, displacements back.

use super::rigid_part::{Loads, RigidPart};
use palpate_geometry::math::lanes::{Baseline, Lanes};
use palpate_geometry::math::{Lane, Vector3, simd};

/// No slot.
const NONE: u32 = u32::MAX;
/// Sides whose answers are found together.
const BATCH: usize = 128;
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
    /// Places concerned, ascending, and where the entries of each begin in `by_slot`.
    concerned: Vec<Concerned>,
    /// Entries of slot after slot: side and entry.
    by_slot: Vec<(u32, u32)>,
    /// Of entry after entry, weighted directions in the frame of its place.
    directions: Vec<Lane>,
    /// What unit forces on a batch of sides do at the slots, side after side and direction after direction, m/N.
    response: Vec<Lane>,
}

#[derive(Clone, Copy, Debug)]
struct Side {
    row: u32,
    sign: f64,
    start: u32,
    end: u32,
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
    /// They are one side.
    pub same: bool,
    /// By direction of the force: the displacement with the signs of both sides, m/N.
    pub moved: [Vector3; MOST],
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
            concerned: Vec::with_capacity(slots),
            by_slot: vec![(0, 0); entries],
            directions: vec![[0.0; 4]; MOST * entries],
            response: vec![[0.0; 4]; MOST * slots * sides.min(BATCH)],
        }
    }

    /// No sides.
    pub fn clear(&mut self) {
        for seen in &self.concerned {
            self.slot_of[seen.place as usize] = NONE;
        }
        self.sides.clear();
        self.entries.clear();
        self.concerned.clear();
    }

    /// Adds a side of a row, pushed along the row's normal times `sign`: (place, weight) of its control points that
    /// move.
    pub fn add(&mut self, row: usize, sign: f64, weights: impl Iterator<Item = (usize, f64)>) {
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

    /// Orders places as they lie in every column, and entries by slot. To be called once all sides are there.
    pub fn sort(&mut self) {
        debug_assert!(
            self.entries.len() <= self.by_slot.len(),
            "no room for weights"
        );
        self.concerned.sort_unstable_by_key(|seen| seen.place);
        for (slot, seen) in self.concerned.iter_mut().enumerate() {
            self.slot_of[seen.place as usize] = slot as u32;
            seen.start = 0;
        }
        for entry in &mut self.entries {
            entry.slot = self.slot_of[entry.slot as usize];
        }
        // Counts, then ends, then, filled from the back, starts.
        for entry in &self.entries {
            self.concerned[entry.slot as usize].start += 1;
        }
        let mut end = 0;
        for seen in &mut self.concerned {
            end += seen.start;
            seen.start = end;
        }
        for (s, side) in self.sides.iter().enumerate().rev() {
            for e in (side.start..side.end).rev() {
                let start = &mut self.concerned[self.entries[e as usize].slot as usize].start;
                *start -= 1;
                self.by_slot[*start as usize] = (s as u32, e);
            }
        }
    }

    /// Calls `add` for every pair of sides, once each, the row that is moved no later than the other. `normal_of`: the
    /// direction of a row's force; without it, three forces along the axes.
    pub fn each_pair(
        &mut self,
        compliance: &impl Compliance,
        normal_of: Option<&dyn Fn(usize) -> Vector3>,
        add: impl FnMut(PairOfSides),
    ) {
        let wanted = match normal_of {
            Some(normal_of) => {
                return self.run::<1>(compliance, &|row| [normal_of(row)], add);
            }
            None => [Vector3::x(), Vector3::y(), Vector3::z()],
        };
        self.run::<3>(compliance, &|_| wanted, add);
    }

    /// Adds what the rigid motions of a free body do at the slots, in the world.
    fn add_rigid<const C: usize>(
        &mut self,
        rigid: &RigidPart,
        of_row: &dyn Fn(usize) -> [Vector3; C],
        sides: std::ops::Range<usize>,
    ) {
        let slots = self.concerned.len();
        for (k, side) in self.sides[sides].iter().enumerate() {
            let mut loads = [Loads::default(); C];
            let wanted = of_row(side.row as usize);
            for entry in &self.entries[side.start as usize..side.end as usize] {
                let place = self.concerned[entry.slot as usize].place as usize;
                for (loads, way) in loads.iter_mut().zip(&wanted) {
                    rigid.add(place, &(way * entry.weight), loads);
                }
            }
            let amounts = loads.map(|loads| rigid.amounts(&loads));
            let response = &mut self.response[C * slots * k..C * slots * (k + 1)];
            for (moved, seen) in response.chunks_exact_mut(C).zip(&self.concerned) {
                for (moved, amounts) in moved.iter_mut().zip(&amounts) {
                    add_to(moved, &rigid.moved(seen.place as usize, amounts));
                }
            }
        }
    }

    /// Directions of all entries in the frames of their places.
    fn turn<const C: usize>(
        &mut self,
        compliance: &impl Compliance,
        of_row: &dyn Fn(usize) -> [Vector3; C],
    ) {
        for side in &self.sides {
            let wanted = of_row(side.row as usize);
            for e in side.start as usize..side.end as usize {
                let Entry { slot, weight } = self.entries[e];
                let frame = compliance.frame(self.concerned[slot as usize].place as usize);
                for (to, way) in self.directions[C * e..].iter_mut().zip(&wanted) {
                    *to = into_rest(frame, way, weight);
                }
            }
        }
    }

    fn run<const C: usize>(
        &mut self,
        compliance: &impl Compliance,
        of_row: &dyn Fn(usize) -> [Vector3; C],
        mut add: impl FnMut(PairOfSides),
    ) {
        self.turn::<C>(compliance, of_row);
        for first in (0..self.sides.len()).step_by(BATCH) {
            let last = (first + BATCH).min(self.sides.len());
            self.respond::<C>(compliance, first, last);
            self.turn_back::<C>(compliance, last - first);
            if let Some(rigid) = compliance.rigid() {
                self.add_rigid::<C>(rigid, of_row, first..last);
            }
            for s in first..last {
                for t in 0..=s {
                    add(self.pair::<C>(s, t, first));
                }
            }
        }
    }

    /// Finds what the sides of a batch do at all slots, in the frames of the slots.
    fn respond<const C: usize>(&mut self, compliance: &impl Compliance, first: usize, last: usize) {
        let slots = self.concerned.len();
        self.response[..C * slots * (last - first)].fill([0.0; 4]);
        for slot in 0..slots {
            let end = self.concerned.get(slot + 1);
            let end = end.map_or(self.entries.len(), |next| next.start as usize);
            let own = &self.by_slot[self.concerned[slot].start as usize..end];
            let from = own.partition_point(|entry| (entry.0 as usize) < first);
            let to = own.partition_point(|entry| (entry.0 as usize) < last);
            let column = compliance.column(self.concerned[slot].place as usize);
            let batch = Batch {
                entries: &own[from..to],
                first,
                concerned: &self.concerned,
                directions: &self.directions,
            };
            batch.add::<C>(column, &mut self.response);
        }
    }

    /// Turns what a batch does at the slots into the world.
    fn turn_back<const C: usize>(&mut self, compliance: &impl Compliance, sides: usize) {
        let slots = self.concerned.len();
        let of_sides = self.response.chunks_mut(C * slots.max(1)).take(sides);
        for of_side in of_sides {
            for (moved, seen) in of_side.chunks_exact_mut(C).zip(&self.concerned) {
                let frame = compliance.frame(seen.place as usize);
                for moved in moved {
                    *moved = from_rest(frame, moved);
                }
            }
        }
    }

    fn pair<const C: usize>(&self, s: usize, t: usize, first: usize) -> PairOfSides {
        let slots = self.concerned.len();
        let response = &self.response[C * slots * (s - first)..C * slots * (s - first + 1)];
        let (pushed, moved_side) = (&self.sides[s], &self.sides[t]);
        let sign = pushed.sign * moved_side.sign;
        let mut moved = [[0.0; 4]; C];
        for entry in &self.entries[moved_side.start as usize..moved_side.end as usize] {
            let at = C * entry.slot as usize;
            for (sum, part) in moved.iter_mut().zip(&response[at..at + C]) {
                for k in 0..4 {
                    sum[k] += entry.weight * part[k];
                }
            }
        }
        let mut out = [Vector3::zeros(); MOST];
        for (out, [x, y, z, _]) in out.iter_mut().zip(moved) {
            *out = Vector3::new(x, y, z) * sign;
        }
        PairOfSides {
            rows: [moved_side.row as usize, pushed.row as usize],
            same: s == t,
            moved: out,
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
            self.directions[0] = into_rest(compliance.frame(place), &force, 1.0);
            let batch = Batch {
                entries: &[(0, 0)],
                first: 0,
                concerned: &self.concerned,
                directions: &self.directions,
            };
            batch.add::<1>(compliance.column(place), &mut self.response);
        }
        self.turn_back::<1>(compliance, 1);
        if let Some(rigid) = rigid {
            let amounts = rigid.amounts(&sum);
            for (moved, seen) in self.response.iter_mut().zip(&self.concerned) {
                add_to(moved, &rigid.moved(seen.place as usize, &amounts));
            }
        }
        for side in &self.sides {
            let mut moved = Vector3::zeros();
            for entry in &self.entries[side.start as usize..side.end as usize] {
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

/// Entries of one slot in a batch of sides.
struct Batch<'a> {
    /// Side and entry.
    entries: &'a [(u32, u32)],
    first: usize,
    concerned: &'a [Concerned],
    directions: &'a [Lane],
}

impl Batch<'_> {
    /// Adds what they do at all slots; `column`: the blocks of their place.
    fn add<const C: usize>(&self, column: &[[f32; 9]], response: &mut [Lane]) {
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_wide::<C>(self, column, response) };
        }
        self.add_in::<Baseline, C>(column, response);
    }

    #[inline(always)]
    fn add_in<L: Lanes, const C: usize>(&self, column: &[[f32; 9]], response: &mut [Lane]) {
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
            for &(side, entry) in self.entries {
                let ways = &self.directions[C * entry as usize..C * (entry as usize + 1)];
                let at = C * (slots * (side as usize - self.first) + slot);
                for (moved, way) in response[at..at + C].iter_mut().zip(ways) {
                    let first = L::load(moved) + columns[0] * L::splat(way[0]);
                    let rest = columns[1] * L::splat(way[1]) + columns[2] * L::splat(way[2]);
                    (first + rest).store(moved);
                }
            }
        }
    }
}

/// The same code with 256-bit registers; nothing is fused, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_wide<const C: usize>(batch: &Batch<'_>, column: &[[f32; 9]], response: &mut [Lane]) {
    batch.add_in::<palpate_geometry::math::lanes::Wide, C>(column, response);
}

#[cfg(test)]
mod tests {
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
                delassus.add(row, sign, weights.iter().copied());
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
        let (places, normal) = (13, |row: usize| Vector3::new(1.0, 0.1 * row as f64, -0.5));
        let dense = Dense::new(places, &mut random);
        let mut delassus = Delassus::new(300, 5, places);
        for count in [12, 200, 3] {
            let all = sides(&mut delassus, count, places, &mut random);
            for smooth in [true, false] {
                let (of_row, mut seen) = (&normal as &dyn Fn(usize) -> Vector3, 0);
                let mut pairs = (0..all.len()).flat_map(|s| (0..=s).map(move |t| (s, t)));
                delassus.each_pair(&dense, smooth.then_some(of_row), |pair| {
                    let (s, t) = pairs.next().unwrap();
                    let (pushed, moved) = (&all[s], &all[t]);
                    let mut expected = Matrix3::zeros();
                    for &(a, u) in &moved.2 {
                        for &(b, w) in &pushed.2 {
                            expected += dense.world(a, b) * (u * w * moved.1 * pushed.1);
                        }
                    }
                    assert_eq!((pair.rows, pair.same), ([moved.0, pushed.0], s == t));
                    let ways = match smooth {
                        true => vec![normal(pushed.0)],
                        false => vec![Vector3::x(), Vector3::y(), Vector3::z()],
                    };
                    for (way, found) in ways.iter().zip(pair.moved) {
                        assert!((found - expected * way).norm() < 1e-10, "{found}");
                    }
                    seen += 1;
                });
                assert_eq!(seen, all.len() * (all.len() + 1) / 2);
            }
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
        let directions: Vec<Lane> = (0..6)
            .map(|_| [random.unit(), random.unit(), random.unit(), 0.0])
            .collect();
        let batch = Batch {
            entries: &[(0, 0), (1, 1)],
            first: 0,
            concerned: &concerned,
            directions: &directions,
        };
        let (mut slow, mut fast) = (vec![[0.1; 4]; 54], vec![[0.1; 4]; 54]);
        batch.add_in::<Baseline, 3>(dense.column(4), &mut slow);
        // SAFETY: asked just above.
        #[allow(unsafe_code)]
        unsafe {
            add_wide::<3>(&batch, dense.column(4), &mut fast);
        }
        assert_eq!(slow, fast);
    }
}
