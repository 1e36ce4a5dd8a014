//! What the curve divides the surface into: connected regions above and below, and the loops around them.
//!
//! ```text
//! rectangles ──▶ cells: one rectangle, or neighbours too small to halve, which are one point of the curve
//! cell ──▶ sectors between the crossings on its boundary ──▶ regions: sectors that share a piece of a side
//! sectors ──▶ loops: from crossing to crossing, the region on the left; along a border where the surface ends
//! ```
//! In a cell with four crossings or more (a saddle in the plane, a pole) sectors only touch: what is left and right of it
//! does not hang together, neither above nor below.

use super::CutError;
use super::field::Field;
use super::grid::{Grid, Side};
use super::leaves::{Kind, Leaves, Walk, canonical};
use std::collections::BTreeMap;

/// A rectangle, or several.
pub(super) struct Cell {
    pub leaves: Vec<usize>,
    /// Its first sector, and how many there are.
    pub first: usize,
    pub count: usize,
}

/// A part of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    pub cell: usize,
    pub above: bool,
    /// The crossings from which and to which the curve goes with the sector on the left.
    pub arc: Option<[usize; 2]>,
}

/// Where the curve crosses a side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub uv: [f64; 2],
    pub side: Side,
}

/// A part of a loop.
#[derive(Clone, Debug)]
pub(super) enum Step {
    /// The curve within a sector.
    Arc(usize),
    /// Along a line where the surface ends: from, to; `pole`: all of it is one point.
    Border {
        direction: usize,
        ends: [[f64; 2]; 2],
        pole: bool,
    },
}

/// A closed walk with a region on its left.
#[derive(Clone, Debug)]
pub(super) struct Loop {
    pub region: usize,
    pub steps: Vec<Step>,
}

pub(super) struct Regions {
    pub cells: Vec<Cell>,
    pub sectors: Vec<Sector>,
    /// By sector.
    pub of: Vec<usize>,
    /// By region: it is above.
    pub above: Vec<bool>,
    pub crossings: Vec<Crossing>,
    pub loops: Vec<Loop>,
}

/// What lies on one side of a piece of a line: the sectors at its start and its end.
#[derive(Clone, Copy, Debug)]
struct Flank {
    walk: Walk,
    sectors: [usize; 2],
    crossing: Option<usize>,
}

impl Regions {
    pub fn new(field: &Field, grid: &Grid, leaves: &Leaves) -> Result<Self, CutError> {
        let mut build = Build {
            field,
            grid,
            leaves,
            cells: Vec::new(),
            sectors: Vec::new(),
            crossings: Vec::new(),
            known: BTreeMap::new(),
            flanks: BTreeMap::new(),
        };
        for (members, around) in build.clusters()? {
            build.add_cell(members, &around);
        }
        build.finish()
    }
}

struct Build<'a> {
    field: &'a Field,
    grid: &'a Grid,
    leaves: &'a Leaves,
    cells: Vec<Cell>,
    sectors: Vec<Sector>,
    crossings: Vec<Crossing>,
    known: BTreeMap<Side, usize>,
    flanks: BTreeMap<Side, Vec<Flank>>,
}

type Cluster = (Vec<usize>, Vec<Walk>);

impl Build<'_> {
    /// Rectangles with their boundaries; neighbours of the smallest ones together.
    fn clusters(&self) -> Result<Vec<Cluster>, CutError> {
        let mut out: Vec<Cluster> = Vec::new();
        let mut last: Vec<(usize, Vec<Walk>)> = Vec::new();
        for (k, leaf) in self.leaves.all.iter().enumerate() {
            let around = self.leaves.around(self.grid, leaf);
            match leaf.kind {
                Kind::Last(_) => last.push((k, around)),
                _ => out.push((vec![k], around)),
            }
        }
        let mut sets = Sets::new(last.len());
        let mut first: BTreeMap<Side, usize> = BTreeMap::new();
        for (n, (_, around)) in last.iter().enumerate() {
            for walk in around {
                let other = *first.entry(walk.side).or_insert(n);
                sets.join(n, other);
            }
        }
        let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for n in 0..last.len() {
            members.entry(sets.of(n)).or_default().push(n);
        }
        for group in members.into_values() {
            let mut open: BTreeMap<Side, Vec<Walk>> = BTreeMap::new();
            for walk in group.iter().flat_map(|&n| &last[n].1) {
                open.entry(walk.side).or_default().push(*walk);
            }
            let walks: Vec<Walk> = open
                .into_values()
                .filter(|walks| walks.len() == 1)
                .flatten()
                .collect();
            let leaves: Vec<usize> = group.iter().map(|&n| last[n].0).collect();
            let around = self.ring(walks).ok_or_else(|| {
                let [u, v] = self.leaves.all[leaves[0]].parameters(self.grid, [0.5; 2]);
                CutError::Unclear { u, v }
            })?;
            out.push((leaves, around));
        }
        Ok(out)
    }

    /// Walks end to start, if they are one ring.
    fn ring(&self, walks: Vec<Walk>) -> Option<Vec<Walk>> {
        let mut by_start: BTreeMap<[u64; 2], Walk> = BTreeMap::new();
        for walk in &walks {
            let before = by_start.insert(canonical(self.grid, walk.start()), *walk);
            if before.is_some() {
                return None;
            }
        }
        let first = *walks.first()?;
        let mut ring = vec![first];
        let mut at = canonical(self.grid, first.end());
        while at != canonical(self.grid, first.start()) {
            let next = *by_start.get(&at)?;
            ring.push(next);
            if ring.len() > walks.len() {
                return None;
            }
            at = canonical(self.grid, next.end());
        }
        (ring.len() == walks.len()).then_some(ring)
    }

    fn is_above(&self, place: [u64; 2]) -> bool {
        self.leaves.is_above(self.grid, place)
    }

    fn crossing(&mut self, side: Side) -> usize {
        if let Some(&known) = self.known.get(&side) {
            return known;
        }
        let uv = self.field.crossing(self.grid, &side);
        self.known.insert(side, self.crossings.len());
        self.crossings.push(Crossing { uv, side });
        self.crossings.len() - 1
    }

    /// Sectors of a cell, from one crossing of its boundary to the next.
    fn add_cell(&mut self, leaves: Vec<usize>, around: &[Walk]) {
        let cell = self.cells.len();
        let first = self.sectors.len();
        let crosses: Vec<Option<usize>> = around
            .iter()
            .map(|walk| {
                (self.is_above(walk.start()) != self.is_above(walk.end()))
                    .then(|| self.crossing(walk.side))
            })
            .collect();
        let at: Vec<usize> = crosses.iter().flatten().copied().collect();
        let count = at.len();
        let start = self.is_above(around[0].start());
        // Sector k lies between crossing k − 1 and crossing k, counter-clockwise.
        for k in 0..count.max(1) {
            self.sectors.push(Sector {
                cell,
                above: start ^ (k % 2 == 1),
                arc: (count > 0).then(|| [at[k], at[(k + count - 1) % count]]),
            });
        }
        let mut sector = 0;
        for (walk, crossing) in around.iter().zip(crosses) {
            let start = sector;
            if crossing.is_some() {
                sector = (sector + 1) % count;
            }
            let ends = [first + start, first + sector];
            let flank = Flank {
                walk: *walk,
                sectors: if walk.forward {
                    ends
                } else {
                    [ends[1], ends[0]]
                },
                crossing,
            };
            self.flanks.entry(walk.side).or_default().push(flank);
        }
        self.cells.push(Cell {
            leaves,
            first,
            count: self.sectors.len() - first,
        });
    }

    fn finish(self) -> Result<Regions, CutError> {
        let mut sets = Sets::new(self.sectors.len());
        for flanks in self.flanks.values() {
            if let [a, b] = flanks[..] {
                (0..2).for_each(|k| sets.join(a.sectors[k], b.sectors[k]));
            }
        }
        let mut names: BTreeMap<usize, usize> = BTreeMap::new();
        let mut above = Vec::new();
        let mut of = Vec::with_capacity(self.sectors.len());
        for (k, sector) in self.sectors.iter().enumerate() {
            let name = *names.entry(sets.of(k)).or_insert_with(|| {
                above.push(sector.above);
                above.len() - 1
            });
            of.push(name);
        }
        let loops = self.loops(&of)?;
        Ok(Regions {
            cells: self.cells,
            sectors: self.sectors,
            of,
            above,
            crossings: self.crossings,
            loops,
        })
    }

    fn loops(&self, of: &[usize]) -> Result<Vec<Loop>, CutError> {
        let border = Border::new(self);
        let mut begins: BTreeMap<(usize, bool), usize> = BTreeMap::new();
        for (k, sector) in self.sectors.iter().enumerate() {
            if let Some([from, _]) = sector.arc {
                begins.insert((from, sector.above), k);
            }
        }
        let mut used = vec![false; self.sectors.len()];
        let mut loops = border.whole(of);
        for first in 0..self.sectors.len() {
            if used[first] || self.sectors[first].arc.is_none() {
                continue;
            }
            let mut steps = Vec::new();
            let mut at = first;
            while !used[at] {
                used[at] = true;
                steps.push(Step::Arc(at));
                let sector = &self.sectors[at];
                let Some([_, mut to]) = sector.arc else { break };
                if let Some(walk) = border.at(to) {
                    to = border.follow(walk, &mut steps);
                }
                let next = begins.get(&(to, sector.above));
                let [u, v] = self.crossings[to].uv;
                at = *next.ok_or(CutError::Unclear { u, v })?;
            }
            if at != first {
                let [u, v] = self.crossings[self.sectors[at].arc.map_or(0, |arc| arc[0])].uv;
                return Err(CutError::Unclear { u, v });
            }
            let region = of[first];
            loops.push(Loop { region, steps });
        }
        Ok(loops)
    }
}

/// The lines at which the surface ends, walked with it on the left.
struct Border<'a> {
    grid: &'a Grid,
    crossings: &'a [Crossing],
    flanks: Vec<Flank>,
    /// By start.
    next: BTreeMap<[u64; 2], usize>,
    /// By crossing.
    crossed: BTreeMap<usize, usize>,
}

impl<'a> Border<'a> {
    fn new(build: &'a Build<'_>) -> Self {
        let single = build.flanks.values().filter(|flanks| flanks.len() == 1);
        let flanks: Vec<Flank> = single.flatten().copied().collect();
        let mut next = BTreeMap::new();
        let mut crossed = BTreeMap::new();
        for (k, flank) in flanks.iter().enumerate() {
            next.insert(canonical(build.grid, flank.walk.start()), k);
            if let Some(crossing) = flank.crossing {
                crossed.insert(crossing, k);
            }
        }
        Self {
            grid: build.grid,
            crossings: &build.crossings,
            flanks,
            next,
            crossed,
        }
    }

    fn at(&self, crossing: usize) -> Option<usize> {
        self.crossed.get(&crossing).copied()
    }

    fn after(&self, k: usize) -> usize {
        self.next[&canonical(self.grid, self.flanks[k].walk.end())]
    }

    /// Whether it is a pole.
    fn is_pole(&self, side: &Side) -> bool {
        let d = 1 - side.direction;
        self.grid.poles[d][usize::from(side.line != 0)]
    }

    fn step(&self, k: usize, ends: [[f64; 2]; 2]) -> Step {
        let side = &self.flanks[k].walk.side;
        Step::Border {
            direction: side.direction,
            ends,
            pole: self.is_pole(side),
        }
    }

    fn ends(&self, k: usize) -> [[f64; 2]; 2] {
        let walk = &self.flanks[k].walk;
        [walk.start(), walk.end()].map(|place| self.grid.parameters(place))
    }

    /// From the crossing of a piece to the next crossing, which is returned.
    fn follow(&self, first: usize, steps: &mut Vec<Step>) -> usize {
        let mut at = first;
        let mut from = self.flanks[first].crossing.map(|c| self.crossings[c].uv);
        loop {
            let [start, end] = self.ends(at);
            let crossing = self.flanks[at]
                .crossing
                .filter(|_| at != first || from.is_none());
            let to = crossing.map_or(end, |c| self.crossings[c].uv);
            push(steps, self.step(at, [from.take().unwrap_or(start), to]));
            if let Some(crossing) = crossing {
                return crossing;
            }
            at = self.after(at);
        }
    }

    /// Rings of the border that the curve does not cross.
    fn whole(&self, of: &[usize]) -> Vec<Loop> {
        let mut used = vec![false; self.flanks.len()];
        let mut out = Vec::new();
        for first in 0..self.flanks.len() {
            let mut steps = Vec::new();
            let mut crossed = false;
            let mut at = first;
            while !used[at] {
                used[at] = true;
                crossed |= self.flanks[at].crossing.is_some();
                push(&mut steps, self.step(at, self.ends(at)));
                at = self.after(at);
            }
            let is_pole = |step: &Step| matches!(step, Step::Border { pole: true, .. });
            if !steps.is_empty() && !crossed && !steps.iter().all(is_pole) {
                let region = of[self.flanks[first].sectors[0]];
                out.push(Loop { region, steps });
            }
        }
        out
    }
}

/// Adds a step along the border; one that goes on straight is made longer.
fn push(steps: &mut Vec<Step>, next: Step) {
    if let (
        Some(Step::Border {
            direction, ends, ..
        }),
        Step::Border {
            direction: along,
            ends: [from, to],
            ..
        },
    ) = (steps.last_mut(), &next)
        && direction == along
        && ends[1] == *from
    {
        ends[1] = *to;
        return;
    }
    steps.push(next);
}

/// Disjoint sets.
pub(super) struct Sets(Vec<usize>);

impl Sets {
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    pub fn of(&mut self, k: usize) -> usize {
        let mut root = k;
        while self.0[root] != root {
            root = self.0[root];
        }
        let mut at = k;
        while self.0[at] != root {
            at = std::mem::replace(&mut self.0[at], root);
        }
        root
    }

    /// The lesser name stays.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b)] = a.min(b);
    }
}
