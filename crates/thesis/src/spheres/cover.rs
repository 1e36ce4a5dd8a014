//! A surface under spheres: at each level one for each cell, which holds the surface of the cell.

use super::grid::wrap;
use super::grid::{GridAxis, GridCell};
use super::points::SpherePoints;
use super::sag::Sag;
use super::sphere::{Lens, Sphere};
use palpate_geometry::contact::distance_squared_to_box;
use palpate_geometry::math::{Point3, Pose, Vector3};
use palpate_geometry::surface::Surface;

/// A cell: its place among those of its level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct CellId {
    pub level: u8,
    pub i: u16,
    pub j: u16,
}

/// Points, spheres and bounds of one surface on one grid.
#[derive(Clone, Debug)]
pub(super) struct Cover {
    pub u: GridAxis,
    pub v: GridAxis,
    pub points: SpherePoints,
    sag: Sag,
    /// (net) as it is placed, m.
    control: Vec<Point3>,
    /// (levels) of (cells u × cells v), m; only where the stamp is that of now.
    lenses: Vec<Vec<(Lens, u32)>>,
    now: u32,
    /// (spans u × spans v) boxes of the control points that shape a span: they hold it.
    boxes: Vec<[Point3; 2]>,
    /// (spans u × spans v) and (coarsest cells): squared distances of a query to the boxes, m².
    squares: Vec<f64>,
    bounds: Vec<f64>,
    /// (rows × spans v) boxes along v only.
    strips: Vec<[Point3; 2]>,
    /// Room for rounding, m: a share of the coordinates' size.
    noise_m: f64,
    /// Diagonal of the net's box, m.
    pub size_m: f64,
    /// Spheres made since last asked.
    pub made: u32,
    /// The edges at the start and end of each direction are single points.
    pub poles: [[bool; 2]; 2],
    pub closed: bool,
}

impl Cover {
    pub fn new(surface: &Surface, rows: [usize; 2]) -> Self {
        let topology = surface.topology();
        let u = GridAxis::new(surface.knots_u(), rows[0], topology.wraps(0));
        let v = GridAxis::new(surface.knots_v(), rows[1], topology.wraps(1));
        let none = (Lens::about(&[Point3::origin(); 4], 0.0), 0);
        let levels = u.levels.len().max(v.levels.len());
        let lenses = (0..levels)
            .map(|k| vec![none; u.level(k).len() * v.level(k).len()])
            .collect();
        let spans = u.span_first.len() * v.span_first.len();
        let mut new = Self {
            points: SpherePoints::new(surface, &u, &v),
            sag: Sag::new(surface.knots_u(), surface.knots_v(), &u, &v),
            control: surface.net().points().to_vec(),
            lenses,
            now: 0,
            boxes: vec![[Point3::origin(); 2]; spans],
            squares: vec![0.0; spans],
            bounds: vec![0.0; u.level(0).len() * v.level(0).len()],
            strips: vec![[Point3::origin(); 2]; u.columns[1] * v.span_first.len()],
            noise_m: 0.0,
            size_m: 0.0,
            made: 0,
            poles: topology.poles,
            closed: topology.is_closed(),
            u,
            v,
        };
        new.load(surface, &Pose::identity());
        new
    }

    /// Takes over a net, placed by `pose`.
    pub fn load(&mut self, surface: &Surface, pose: &Pose) {
        for (to, p) in self.control.iter_mut().zip(surface.net().points()) {
            *to = if *pose == Pose::identity() {
                *p
            } else {
                pose * p
            };
        }
        self.points
            .load(&self.control, surface.weights(), &self.u, &self.v);
        self.sag.refresh(&self.points, &self.u, &self.v);
        self.refresh_boxes();
        if self.now == u32::MAX {
            self.lenses.iter_mut().flatten().for_each(|lens| lens.1 = 0);
            self.now = 0;
        }
        self.now += 1;
    }

    fn refresh_boxes(&mut self) {
        let spans = self.v.span_first.len();
        let join =
            |sum: [Point3; 2], other: &[Point3; 2]| [sum[0].inf(&other[0]), sum[1].sup(&other[1])];
        let nothing = [
            Point3::from([f64::INFINITY; 3]),
            Point3::from([f64::NEG_INFINITY; 3]),
        ];
        for i in 0..self.u.columns[1] {
            let line = &self.control[wrap(i, self.u.columns[0]) * self.v.columns[0]..]
                [..self.v.columns[0]];
            for (j, &first) in self.v.span_first.iter().enumerate() {
                let points = (first as usize..first as usize + self.v.width)
                    .map(|b| line[wrap(b, line.len())]);
                self.strips[i * spans + j] = points.fold(nothing, |sum, p| join(sum, &[p, p]));
            }
        }
        let mut whole = nothing;
        for (i, &first) in self.u.span_first.iter().enumerate() {
            for j in 0..spans {
                let column = (first as usize..first as usize + self.u.width)
                    .map(|a| &self.strips[a * spans + j]);
                let joined = column.fold(nothing, join);
                self.boxes[i * spans + j] = joined;
                whole = join(whole, &joined);
            }
        }
        self.size_m = (whole[1] - whole[0]).norm();
        self.noise_m = 64.0 * f64::EPSILON * whole[0].coords.amax().max(whole[1].coords.amax());
    }

    /// Room for rounding of coordinates, m.
    pub fn noise_m(&self) -> f64 {
        self.noise_m
    }

    /// The control point farthest along a direction.
    pub fn farthest(&self, direction: &Vector3) -> Vector3 {
        let (mut most, mut at) = (f64::NEG_INFINITY, Vector3::zeros());
        for p in &self.control {
            let along = p.coords.dot(direction);
            if along > most {
                (most, at) = (along, p.coords);
            }
        }
        at
    }

    /// +1, or −1 where the outward side is against S_u × S_v.
    pub fn outward(&self) -> f64 {
        if self.points.is_flipped() { -1.0 } else { 1.0 }
    }

    pub fn levels(&self) -> usize {
        self.lenses.len()
    }

    #[inline(always)]
    pub fn cells(&self, id: CellId) -> (&GridCell, &GridCell) {
        let level = usize::from(id.level);
        (
            &self.u.level(level)[usize::from(id.i)],
            &self.v.level(level)[usize::from(id.j)],
        )
    }

    /// Corners of a cell, in order round it.
    #[inline(always)]
    pub fn corners(&mut self, id: CellId) -> [Point3; 4] {
        let (cell_u, cell_v) = self.cells(id);
        let ([a, b], [c, d]) = (cell_u.rows, cell_v.rows);
        let (points, u, v) = (&mut self.points, &self.u, &self.v);
        [
            points.at(u, v, a, c),
            points.at(u, v, b, c),
            points.at(u, v, b, d),
            points.at(u, v, a, d),
        ]
    }

    /// Parameters at the corners of a cell, in the same order.
    #[inline(always)]
    pub fn parameters(&self, id: CellId) -> [[f64; 2]; 4] {
        let (u, v) = self.cells(id);
        let (u, v) = (
            u.rows.map(|i| self.u.parameters[i as usize]),
            v.rows.map(|j| self.v.parameters[j as usize]),
        );
        [[u[0], v[0]], [u[1], v[0]], [u[1], v[1]], [u[0], v[1]]]
    }

    /// The sphere that holds the surface of a cell.
    #[inline(always)]
    pub fn sphere(&mut self, id: CellId) -> Sphere {
        self.lens(id).sphere
    }

    /// The sphere and slab that hold the surface of a cell.
    #[inline(always)]
    pub fn lens(&mut self, id: CellId) -> &Lens {
        let level = usize::from(id.level);
        let at = usize::from(id.i) * self.v.level(level).len() + usize::from(id.j);
        if self.lenses[level][at].1 != self.now {
            self.make(id, at);
        }
        &self.lenses[level][at].0
    }

    /// Makes the lenses of all children of a cell, so that [`Cover::made_lenses`] may be read for
    /// them.
    pub fn make_children(&mut self, id: CellId) {
        let [[i0, i1], [j0, j1]] = self.children(id);
        for i in i0..i1 {
            for j in j0..j1 {
                self.lens(CellId {
                    level: id.level + 1,
                    i: i as u16,
                    j: j as u16,
                });
            }
        }
    }

    /// The lenses of a level as they are, and how many make a row.
    #[inline(always)]
    pub fn made_lenses(&self, level: usize) -> (&[(Lens, u32)], usize) {
        (&self.lenses[level], self.v.level(level).len())
    }

    #[inline(never)]
    fn make(&mut self, id: CellId, at: usize) {
        self.made += 1;
        let corners = self.corners(id);
        let lens = Lens::about(&corners, self.sag(id) + self.noise_m);
        self.lenses[usize::from(id.level)][at] = (lens, self.now);
    }

    /// How far the surface of a cell is from its bilinear patch, at most, m.
    pub fn sag(&self, id: CellId) -> f64 {
        let (u, v) = self.cells(id);
        self.sag.of(u, v, self.v.span_first.len())
    }

    /// Cells of the next level: from and to (excluded) in u and v.
    #[inline(always)]
    pub fn children(&self, id: CellId) -> [[u32; 2]; 2] {
        let level = usize::from(id.level);
        let of = |axis: &GridAxis, k: u16| {
            if level + 1 < axis.levels.len() {
                axis.levels[level][usize::from(k)].children
            } else {
                [k.into(), u32::from(k) + 1]
            }
        };
        [of(&self.u, id.i), of(&self.v, id.j)]
    }

    /// Calls with every cell of the coarsest level over spans that `touched` says yes to.
    pub fn concerned(
        &self,
        touched: impl Fn(&Point3, &Point3) -> bool,
        mut each: impl FnMut(CellId),
    ) {
        let spans = self.v.span_first.len();
        for (i, u) in self.u.level(0).iter().enumerate() {
            for (j, v) in self.v.level(0).iter().enumerate() {
                let meets = (u.spans[0]..u.spans[1]).any(|a| {
                    (v.spans[0]..v.spans[1]).any(|b| {
                        let [low, high] = &self.boxes[a as usize * spans + b as usize];
                        touched(low, high)
                    })
                });
                if meets {
                    each(CellId {
                        level: 0,
                        i: i as u16,
                        j: j as u16,
                    });
                }
            }
        }
    }

    /// Calls with the coarsest cells that may hold a point nearer than `within_m`, the most
    /// promising first; it answers how near the next must be. By boxes, so that few spheres are
    /// made.
    pub fn near(
        &mut self,
        q: &Point3,
        within_m: f64,
        mut each: impl FnMut(&mut Self, CellId) -> f64,
    ) {
        for (square, [low, high]) in self.squares.iter_mut().zip(&self.boxes) {
            *square = distance_squared_to_box(q, low, high);
        }
        let spans = self.v.span_first.len();
        let (count_u, count_v) = (self.u.level(0).len(), self.v.level(0).len());
        let bound = |cover: &Self, i: usize, j: usize| {
            let (u, v) = (&cover.u.level(0)[i], &cover.v.level(0)[j]);
            let mut least = f64::INFINITY;
            for a in u.spans[0]..u.spans[1] {
                for square in
                    &cover.squares[a as usize * spans..][v.spans[0] as usize..v.spans[1] as usize]
                {
                    least = if *square < least { *square } else { least };
                }
            }
            least
        };
        let (mut first, mut least) = ((0, 0), f64::INFINITY);
        for i in 0..count_u {
            for j in 0..count_v {
                let square = bound(self, i, j);
                self.bounds[i * count_v + j] = square;
                if square < least {
                    (first, least) = ((i, j), square);
                }
            }
        }
        let id = |(i, j): (usize, usize)| CellId {
            level: 0,
            i: i as u16,
            j: j as u16,
        };
        let noise = self.noise_m;
        let mut within = if least <= within_m * within_m {
            each(self, id(first))
        } else {
            within_m
        };
        for i in 0..count_u {
            for j in 0..count_v {
                let reach = within + noise;
                if (i, j) != first && self.bounds[i * count_v + j] <= reach * reach {
                    within = each(self, id((i, j)));
                }
            }
        }
    }

    /// Box of the whole net.
    pub fn whole_box(&self) -> [Point3; 2] {
        self.boxes.iter().fold(self.boxes[0], |sum, b| {
            [sum[0].inf(&b[0]), sum[1].sup(&b[1])]
        })
    }

    /// The normals at the corners of a cell differ by less than `turn`, and the surface stays as
    /// near to its corners' patch as that turn over the cell's size: between them a bump cannot
    /// hide.
    pub fn is_flat(&mut self, id: CellId, turn: f64) -> bool {
        let sphere = self.sphere(id);
        if self.sag(id) > turn * sphere.radius_m {
            return false;
        }
        let (u, v) = self.cells(id);
        let ([a, b], [c, d]) = (u.rows, v.rows);
        let normals = [(a, c), (b, c), (b, d), (a, d)]
            .map(|(i, j)| self.points.normal(&self.u, &self.v, i, j));
        let Some(first) = normals[0] else {
            return false;
        };
        normals
            .iter()
            .all(|normal| normal.is_some_and(|n| (n - first).norm_squared() < turn * turn))
    }
}
