//! Two surfaces: spheres against spheres, refined alternately on body and tool, then triangles
//! against triangles.

use super::Spheres;
use super::counters::{self, Counters, LevelCounters, MAX_LEVELS};
use super::cover::{CellId, Cover};
use super::gaps::gaps;
use super::grid::SAME_DEPTH;
use super::hull::Witness;
use super::levels::Levels;
use super::region::SphereRegion;
use super::triangles;
use palpate_geometry::contact::{Contact, ContactSet, Reach, ToolPoint};

/// Pairs of cells for which there is room, for each cell of both surfaces. Coinciding curved
/// surfaces need about 13.
const PAIRS_PER_CELL: usize = 12;
/// And at least so many.
const LEAST_PAIRS: usize = 1 << 14;

/// Room for one pair of surfaces.
#[derive(Clone, Debug)]
pub struct SpheresPair {
    witness: Witness,
    pairs: Vec<[CellId; 2]>,
    next: Vec<[CellId; 2]>,
    marks: [Marks; 2],
    regions: [SphereRegion; 2],
    counters: Counters,
}

/// What is known of the cells of one surface during a query.
#[derive(Clone, Debug)]
struct Marks {
    /// (levels) of (cells): stamp of the query, shifted, and bits.
    cells: Vec<Vec<u32>>,
    stamp: u32,
    /// Spheres of the present level: seen, and met.
    seen: u32,
    met: u32,
}

const SEEN: u32 = 1;
const MET: u32 = 2;
/// Stays whole.
const FINAL: u32 = 4;
const CROSSING: u32 = 8;
/// Was asked whether it is flat.
const ASKED: u32 = 16;
const BITS: u32 = 5;

impl Marks {
    fn new(cover: &Cover) -> Self {
        let cells = (0..cover.levels())
            .map(|k| vec![0; cover.u.level(k).len() * cover.v.level(k).len()])
            .collect();
        Self {
            cells,
            stamp: 0,
            seen: 0,
            met: 0,
        }
    }

    fn begin(&mut self) {
        self.stamp += 1;
        if self.stamp == u32::MAX >> BITS {
            self.cells.iter_mut().for_each(|level| level.fill(0));
            self.stamp = 1;
        }
    }

    /// Sets a bit; true when it was not yet set.
    #[inline(always)]
    fn set(&mut self, cover: &Cover, id: CellId, bit: u32) -> bool {
        let level = usize::from(id.level);
        let mark = &mut self.cells[level]
            [usize::from(id.i) * cover.v.level(level).len() + usize::from(id.j)];
        if *mark >> BITS != self.stamp {
            *mark = self.stamp << BITS;
        }
        let new = *mark & bit == 0;
        *mark |= bit;
        new
    }

    #[inline(always)]
    fn has(&self, cover: &Cover, id: CellId, bit: u32) -> bool {
        let level = usize::from(id.level);
        let mark =
            self.cells[level][usize::from(id.i) * cover.v.level(level).len() + usize::from(id.j)];
        mark >> BITS == self.stamp && mark & bit != 0
    }
}

impl SpheresPair {
    /// Sizes everything for these two.
    pub fn new(body: &Spheres, tool: &Spheres) -> Self {
        let cells = |s: &Spheres| s.cover.u.finest() * s.cover.v.finest();
        let room = (PAIRS_PER_CELL * (cells(body) + cells(tool))).max(LEAST_PAIRS);
        Self {
            witness: Witness::default(),
            pairs: Vec::with_capacity(room),
            next: Vec::with_capacity(room),
            marks: [Marks::new(&body.cover), Marks::new(&tool.cover)],
            regions: [
                SphereRegion::new(&body.cover),
                SphereRegion::new(&tool.cover),
            ],
            counters: Counters::default(),
        }
    }

    /// What the last query did.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Contacts of two surfaces as loaded; both the ones this was made for. A contact for each
    /// connected part of either surface inside the other, at the part's deepest point; where a
    /// margin is asked for and nothing crosses, the local gaps within it. Parts behind an open
    /// surface reach as far as its feet are seen from the front.
    pub fn find(
        &mut self,
        body: &mut Spheres,
        tool: &mut Spheres,
        reach: &Reach,
        set: &mut ContactSet,
    ) {
        set.clear();
        self.counters = Counters::default();
        let margin = if reach.margin_m.is_finite() && reach.margin_m > 0.0 {
            reach.margin_m
        } else {
            0.0
        };
        let (b, t) = (&mut body.cover, &mut tool.cover);
        if !(b.size_m.is_finite() && t.size_m.is_finite()) {
            return;
        }
        (b.points.computed, t.points.computed) = (0, 0);
        let support = |d: &palpate_geometry::math::Vector3| b.farthest(d) - t.farthest(&-d);
        if self
            .witness
            .separates(support, margin + b.noise_m() + t.noise_m())
        {
            self.counters.hulls_apart = true;
            return;
        }
        let all = self.start(b, t, margin);
        self.refine(b, t, margin, [body.flat_turn, tool.flat_turn], all);
        let crossing = self.cross(b, t);
        if crossing || self.contained(b, t, [&mut body.levels, &mut tool.levels], reach) {
            set.set_overlap();
            let [of_body, of_tool] = &mut self.regions;
            let noise = SAME_DEPTH * b.size_m;
            let queries = of_body.contacts(b, t, &mut tool.levels, 1.0, |deep, area| {
                if let Some(deep) = deep {
                    // Out of the body is into the tool: against the tool's normal.
                    let (normal, depth_m) = (-deep.normal, deep.depth_m);
                    let ([u, v], on_body) = (deep.uv, deep.point);
                    let on_tool = on_body - normal * depth_m;
                    set.push(Contact {
                        u,
                        v,
                        on_body,
                        on_tool,
                        normal,
                        depth_m,
                        tool_uv: Some(deep.foot_uv),
                        point: ToolPoint::Found,
                    });
                }
                set.push_rectangle(area);
            });
            let more = of_tool.contacts(t, b, &mut body.levels, reach.side(), |deep, _| {
                if let Some(deep) = deep.filter(|deep| deep.depth_m > noise) {
                    let ([u, v], normal) = (deep.foot_uv, deep.normal);
                    let on_body = deep.point + normal * deep.depth_m;
                    let (on_tool, depth_m) = (deep.point, deep.depth_m);
                    set.push(Contact {
                        u,
                        v,
                        on_body,
                        on_tool,
                        normal,
                        depth_m,
                        tool_uv: Some(deep.uv),
                        point: ToolPoint::Found,
                    });
                }
            });
            self.counters.depth_queries += queries + more;
        } else if margin > 0.0 {
            gaps(
                &self.pairs,
                b,
                t,
                &mut body.peaks,
                margin,
                reach.side(),
                set,
            );
        }
    }

    /// Pairs of the coarsest cells that meet; for each side, whether all did.
    fn start(&mut self, b: &mut Cover, t: &mut Cover, margin: f64) -> [bool; 2] {
        self.marks.iter_mut().for_each(Marks::begin);
        self.pairs.clear();
        let meets = |[low, high]: [palpate_geometry::math::Point3; 2], reach: f64| {
            move |l: &palpate_geometry::math::Point3, h: &palpate_geometry::math::Point3| {
                (0..3).all(|c| l[c] <= high[c] + reach && h[c] >= low[c] - reach)
            }
        };
        let reach = margin + b.noise_m() + t.noise_m();
        let (box_b, box_t) = (b.whole_box(), t.whole_box());
        // The next list holds the tool's cells for a moment.
        self.next.clear();
        t.concerned(meets(box_b, reach), |id| self.next.push([id, id]));
        let (pairs, next) = (&mut self.pairs, &self.next);
        b.concerned(meets(box_t, reach), |id| {
            pairs.extend(
                next.iter()
                    .map(|[tool, _]| [id, *tool])
                    .take(pairs.capacity() - pairs.len()),
            );
        });
        let (mut kept, tests) = (0, self.pairs.len() as u32);
        for k in 0..self.pairs.len() {
            let pair = self.pairs[k];
            let [of_body, of_tool] = &mut self.marks;
            of_body.seen += u32::from(of_body.set(b, pair[0], SEEN));
            of_tool.seen += u32::from(of_tool.set(t, pair[1], SEEN));
            if b.lens(pair[0]).meets(t.lens(pair[1]), margin) {
                of_body.met += u32::from(of_body.set(b, pair[0], MET));
                of_tool.met += u32::from(of_tool.set(t, pair[1], MET));
                self.pairs[kept] = pair;
                kept += 1;
            }
        }
        self.pairs.truncate(kept);
        (self.counters.body[0].tests, self.counters.body[0].meets) = (tests, kept as u32);
        [self.count(b, t, 0, 0), self.count(b, t, 1, 0)]
    }

    /// Closes a level of one side; true when all its spheres met.
    fn count(&mut self, b: &mut Cover, t: &mut Cover, side: usize, level: usize) -> bool {
        let marks = &mut self.marks[side];
        let (seen, met) = (
            std::mem::take(&mut marks.seen),
            std::mem::take(&mut marks.met),
        );
        let (levels, cover): (&mut [LevelCounters; MAX_LEVELS], _) = if side == 0 {
            (&mut self.counters.body, b)
        } else {
            (&mut self.counters.tool, t)
        };
        let counts = counters::of(levels, level);
        counts.spheres += seen;
        counts.points += std::mem::take(&mut cover.points.computed);
        seen > 0 && seen == met
    }

    fn refine(
        &mut self,
        b: &mut Cover,
        t: &mut Cover,
        margin: f64,
        turns: [f64; 2],
        mut all: [bool; 2],
    ) {
        let mut levels = [0, 0];
        loop {
            let mut moved = false;
            for side in 0..2 {
                let count = if side == 0 { b.levels() } else { t.levels() };
                if levels[side] + 1 >= count || self.pairs.is_empty() {
                    continue;
                }
                if all[side] && self.counters.early_stop.is_none() {
                    self.counters.early_stop = Some(levels[side] as u8);
                }
                moved |= self.descend(b, t, side, levels[side], turns[side], margin);
                levels[side] += 1;
                all[side] = self.count(b, t, side, levels[side]);
            }
            if !moved {
                break;
            }
        }
    }

    /// Takes the cells of one side to the next level, but for those that are flat.
    fn descend(
        &mut self,
        b: &mut Cover,
        t: &mut Cover,
        side: usize,
        level: usize,
        turn: f64,
        margin: f64,
    ) -> bool {
        self.next.clear();
        let (mut moved, mut tests, mut meets) = (false, 0, 0);
        for k in 0..self.pairs.len() {
            let pair = self.pairs[k];
            let id = pair[side];
            let cover = if side == 0 { &mut *b } else { &mut *t };
            let mut whole = usize::from(id.level) < level || self.marks[side].has(cover, id, FINAL);
            if !whole && self.marks[side].set(cover, id, ASKED) {
                let [[i0, i1], [j0, j1]] = cover.children(id);
                if cover.is_flat(id, turn) {
                    self.marks[side].set(cover, id, FINAL);
                    whole = true;
                } else {
                    self.marks[side].seen += (i1 - i0) * (j1 - j0);
                    cover.make_children(id);
                }
            }
            if whole {
                self.keep(pair);
                continue;
            }
            moved = true;
            let [[i0, i1], [j0, j1]] = cover.children(id);
            let other = if side == 0 {
                *t.lens(pair[1])
            } else {
                *b.lens(pair[0])
            };
            let cover = if side == 0 { &*b } else { &*t };
            tests += (i1 - i0) * (j1 - j0);
            let (lenses, columns) = cover.made_lenses(usize::from(id.level) + 1);
            for i in i0..i1 {
                for (k, (lens, _)) in lenses[i as usize * columns..][j0 as usize..j1 as usize]
                    .iter()
                    .enumerate()
                {
                    if lens.meets(&other, margin) {
                        let child = CellId {
                            level: id.level + 1,
                            i: i as u16,
                            j: j0 as u16 + k as u16,
                        };
                        let marks = &mut self.marks[side];
                        marks.met += u32::from(marks.set(cover, child, MET));
                        meets += 1;
                        let mut pair = pair;
                        pair[side] = child;
                        self.keep(pair);
                    }
                }
            }
        }
        let levels = if side == 0 {
            &mut self.counters.body
        } else {
            &mut self.counters.tool
        };
        let counts = counters::of(levels, level + 1);
        counts.tests += tests;
        counts.meets += meets;
        std::mem::swap(&mut self.pairs, &mut self.next);
        moved
    }

    #[inline(always)]
    fn keep(&mut self, pair: [CellId; 2]) {
        if self.next.len() < self.next.capacity() {
            self.next.push(pair);
        } else {
            self.counters.dropped += 1;
        }
    }

    /// Triangle–triangle tests of the pairs that are left; marks the cells that cross. True when
    /// any do.
    fn cross(&mut self, b: &mut Cover, t: &mut Cover) -> bool {
        let [of_body, of_tool] = &mut self.regions;
        of_body.clear();
        of_tool.clear();
        let mut any = false;
        let mut last = None;
        for &[x, y] in &self.pairs {
            self.counters.triangulated_cells += u32::from(last != Some(x));
            last = Some(x);
            if self.marks[0].has(b, x, CROSSING) && self.marks[1].has(t, y, CROSSING) {
                continue;
            }
            let (p, q) = (b.corners(x), t.corners(y));
            for second in triangles::split(&q) {
                let s = second.map(|k| q[k]);
                // One plane decides for both triangles of the body's cell.
                let normal = (s[1] - s[0]).cross(&(s[2] - s[0]));
                let sides = p.map(|p| (p - s[0]).dot(&normal));
                if sides.iter().all(|x| *x > 0.0) || sides.iter().all(|x| *x < 0.0) {
                    continue;
                }
                for first in triangles::split(&p) {
                    let f = first.map(|k| p[k]);
                    self.counters.triangle_tests += 1;
                    if triangles::meet(&f, &s) {
                        self.counters.triangle_meets += 1;
                        any = true;
                        self.marks[0].set(b, x, CROSSING);
                        self.marks[1].set(t, y, CROSSING);
                        of_body.cross(b, x, &p, &s, t.outward());
                        of_tool.cross(t, y, &q, &f, b.outward());
                    }
                }
            }
        }
        any
    }

    /// Nothing crosses: one may still be wholly inside the other.
    fn contained(
        &mut self,
        b: &mut Cover,
        t: &mut Cover,
        levels: [&mut Levels; 2],
        reach: &Reach,
    ) -> bool {
        let [of_body, of_tool] = &mut self.regions;
        let [levels_b, levels_t] = levels;
        let tool_in_body = b.closed && of_tool.is_inside(t, b, levels_b, reach.side());
        let body_in_tool = !tool_in_body && t.closed && of_body.is_inside(b, t, levels_t, 1.0);
        if tool_in_body {
            of_tool.take_all(t);
        }
        if body_in_tool {
            of_body.take_all(b);
        }
        tool_in_body || body_in_tool
    }
}
