//! The pieces of a cut.

use super::caps::caps;
use super::field::{Field, restricted, value};
use super::grid::Grid;
use super::leaves::{Leaf, Leaves};
use super::measure::{Integrals, integrals};
use super::regions::{Regions, Sets};
use super::rim::{Fitter, RimEdge};
use super::{CutError, CutPlane};
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestSolver, Surface, Topology};
use std::collections::{BTreeMap, BTreeSet};

/// Of the size: closer than this a plane touches.
const TOUCHES: f64 = 1e-11;

/// A plane part of a piece's boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Cap {
    /// Its rims, as the piece's `Piece::rims` counts them: the outer one, then its holes.
    pub rims: Vec<usize>,
    /// m².
    pub area_m2: f64,
}

/// A connected part of what is above or below the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// It is on the side that the plane's normal points to.
    pub above: bool,
    /// Within skin and caps, m³; 0 of sheets.
    pub volume_m3: f64,
    /// All caps, m²: by the flux of the skin's normals, −n · ∬ S_u × S_v.
    pub cap_area_m2: f64,
    /// Of the surface, m².
    pub skin_area_m2: f64,
    /// Centre of mass, m; of a sheet, of its skin.
    pub centroid: Point3,
    /// Empty where the surface has no inside.
    pub caps: Vec<Cap>,
    /// Closed walks around its skin, which is on their left as S_u × S_v sees it.
    pub(super) rims: Vec<Vec<RimEdge>>,
    /// Rims of each connected part of its skin.
    pub(super) skins: Vec<Vec<usize>>,
}

impl Piece {
    /// How many closed walks bound its skin.
    pub fn rim_count(&self) -> usize {
        self.rims.len()
    }
}

/// What a plane makes of a surface.
pub struct Cut {
    /// As it was cut.
    pub surface: Surface,
    /// By which it was cut.
    pub plane: CutPlane,
    /// Those above first, then by where they begin in (u, v).
    pub pieces: Vec<Piece>,
    /// The surface has an inside, and pieces have caps.
    pub closed: bool,
    /// S_u × S_v points out of it.
    pub(super) outwards: bool,
    places: Places,
}

/// Which piece a place of the surface belongs to.
struct Places {
    grid: Grid,
    degree: [usize; 2],
    leaves: BTreeMap<([u64; 2], [u64; 2]), Spot>,
    /// Of the leaves, each once.
    sizes: BTreeSet<[u64; 2]>,
}

struct Spot {
    leaf: Leaf,
    /// The piece below and the piece above.
    pieces: [usize; 2],
}

/// Cuts a surface by a plane. A closed surface gives bodies with caps, an open one gives sheets.
///
/// Regions of the surface that one cap joins are one piece: a cup that is cut through its wall stays one.
///
/// # Errors
/// A plane that misses or only touches the surface, a surface of joined patches, curves that rounding hides.
///
/// # Examples
/// ```
/// use palpate_geometry::cut::{CutPlane, cut_by_plane};
/// use palpate_geometry::math::{Point3, Vector3};
/// use palpate_geometry::surface::builtin;
/// let ball = builtin("sphere", None, Some(0.02))?;
/// let plane = CutPlane::through(&Point3::new(0.0, 0.0, 0.01), &Vector3::z()).expect("a direction");
/// let cut = cut_by_plane(&ball, &plane)?;
/// // A cap half as high as the radius: π h² (3 r − h) / 3.
/// let volume = std::f64::consts::PI * 1e-4 * 0.05 / 3.0;
/// assert!((cut.pieces[0].volume_m3 / volume - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cut_by_plane(surface: &Surface, plane: &CutPlane) -> Result<Cut, CutError> {
    let topology = surface.topology();
    let closed = topology.is_closed();
    cut(surface, &topology, plane, closed)
}

/// Cuts a surface by a plane as a sheet, also a closed one: its pieces are connected parts of it, without caps.
///
/// # Errors
/// As [`cut_by_plane`].
///
/// # Examples
/// ```
/// use palpate_geometry::cut::{CutPlane, cut_sheet_by_plane};
/// use palpate_geometry::math::{Point3, Vector3};
/// use palpate_geometry::surface::builtin;
/// let ring = builtin("torus", None, None)?;
/// let plane = CutPlane::through(&Point3::origin(), &Vector3::x()).expect("a direction");
/// let cut = cut_sheet_by_plane(&ring, &plane)?;
/// // Two bent tubes, open at both ends.
/// assert_eq!(cut.pieces.iter().map(|piece| piece.rim_count()).collect::<Vec<_>>(), [2, 2]);
/// assert_eq!(cut.pieces[0].cap_area_m2, 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cut_sheet_by_plane(surface: &Surface, plane: &CutPlane) -> Result<Cut, CutError> {
    cut(surface, &surface.topology(), plane, false)
}

/// Into bodies with caps where `closed`, else into sheets.
fn cut(
    surface: &Surface,
    topology: &Topology,
    plane: &CutPlane,
    closed: bool,
) -> Result<Cut, CutError> {
    if surface.joints().is_some() || topology.torn.contains(&true) {
        return Err(CutError::Joined);
    }
    let grid = Grid::new(surface, topology);
    let field = Field::new(surface, &grid, plane);
    let leaves = Leaves::new(&field, &grid)?;
    let regions = Regions::new(&field, &grid, &leaves)?;
    if regions.crossings.is_empty() {
        return Err(misses(surface, plane));
    }
    let sums = integrals(surface, plane, &field, &grid, &leaves, &regions);
    let volume: f64 = sums.iter().map(|sum| sum.volume_m3).sum();
    let outwards = if topology.is_closed() {
        volume > 0.0
    } else {
        !surface.flip_normal()
    };
    let fitter = Fitter::new(surface, plane, &field, &grid, &leaves, &regions);
    let fitter = fitter.ok_or(CutError::Unclear { u: 0.0, v: 0.0 })?;
    let rims: Vec<Vec<RimEdge>> = (regions.loops.iter())
        .map(|one| fitter.edges(one))
        .collect::<Result<_, _>>()?;
    let group = Grouping {
        plane,
        regions: &regions,
        rims: &rims,
        sums: &sums,
        closed,
        outwards,
    };
    let (pieces, of) = group.pieces()?;
    let places = Places::new(grid, &field, leaves, &regions, &of);
    Ok(Cut {
        surface: surface.clone(),
        plane: *plane,
        pieces,
        closed,
        outwards,
        places,
    })
}

/// How far a surface that has no curve with a plane is from it.
fn misses(surface: &Surface, plane: &CutPlane) -> CutError {
    let mut solver = ClosestSolver::new(surface);
    let mut height = |direction: Vector3| {
        let (_, _, point) = solver.deepest_along(surface, &direction);
        plane.height(&point)
    };
    let (low, high) = (height(-plane.normal), height(plane.normal));
    let above = low + high > 0.0;
    let distance_m = if above { low } else { -high };
    CutError::Misses {
        above,
        distance_m: match distance_m <= TOUCHES * surface.size() {
            true => 0.0,
            false => distance_m,
        },
    }
}

struct Grouping<'a> {
    plane: &'a CutPlane,
    regions: &'a Regions,
    rims: &'a [Vec<RimEdge>],
    sums: &'a [Integrals],
    closed: bool,
    outwards: bool,
}

impl Grouping<'_> {
    /// Pieces, and the piece of each region.
    fn pieces(&self) -> Result<(Vec<Piece>, Vec<usize>), CutError> {
        let count = self.regions.above.len();
        let mut sets = Sets::new(count);
        // Rims by their numbers among the loops.
        let mut all: Vec<(Vec<usize>, f64)> = Vec::new();
        for above in [true, false] {
            let chosen: Vec<usize> = (0..self.rims.len())
                .filter(|&k| {
                    self.closed && self.regions.above[self.regions.loops[k].region] == above
                })
                .collect();
            let sides: Vec<(&[RimEdge], bool)> = (chosen.iter())
                .map(|&k| (self.rims[k].as_slice(), above == self.outwards))
                .collect();
            for (members, area_m2) in caps(self.plane, &sides)? {
                let rims: Vec<usize> = members.into_iter().map(|m| chosen[m]).collect();
                for &rim in &rims[1..] {
                    sets.join(
                        self.regions.loops[rims[0]].region,
                        self.regions.loops[rim].region,
                    );
                }
                all.push((rims, area_m2));
            }
        }
        let mut order: Vec<usize> = (0..count).filter(|&k| sets.of(k) == k).collect();
        order.sort_by_key(|&k| !self.regions.above[k]);
        let of: Vec<usize> = (0..count)
            .map(|k| {
                let root = sets.of(k);
                order.iter().position(|&o| o == root).unwrap_or(0)
            })
            .collect();
        let pieces = (0..order.len()).map(|piece| self.piece(piece, &of, &all));
        Ok((pieces.collect(), of))
    }

    fn piece(&self, piece: usize, of: &[usize], caps: &[(Vec<usize>, f64)]) -> Piece {
        let mut sum = Integrals::default();
        let mine = |region: usize| of[region] == piece;
        let mut above = false;
        for region in (0..of.len()).filter(|&r| mine(r)) {
            sum += &self.sums[region];
            above = self.regions.above[region];
        }
        let loops: Vec<usize> = (0..self.rims.len())
            .filter(|&k| mine(self.regions.loops[k].region))
            .collect();
        let number = |rim: &usize| loops.iter().position(|l| l == rim);
        let caps = caps
            .iter()
            .filter(|(rims, _)| loops.contains(&rims[0]))
            .map(|(rims, area_m2)| Cap {
                rims: rims.iter().filter_map(number).collect(),
                area_m2: *area_m2,
            });
        let sense = if self.outwards { 1.0 } else { -1.0 };
        let side = if above { sense } else { -sense };
        let centre = match self.closed {
            true => sum.first_m4 / sum.volume_m3,
            false => sum.area_first_m3 / sum.area_m2,
        };
        Piece {
            above,
            volume_m3: if self.closed {
                sense * sum.volume_m3
            } else {
                0.0
            },
            cap_area_m2: if self.closed {
                side * self.plane.normal.dot(&sum.across_m2)
            } else {
                0.0
            },
            skin_area_m2: sum.area_m2,
            centroid: self.plane.origin() + centre,
            caps: caps.collect(),
            skins: (0..of.len())
                .filter(|&region| mine(region))
                .map(|region| {
                    let around = |k: &usize| self.regions.loops[loops[*k]].region == region;
                    (0..loops.len()).filter(around).collect()
                })
                .collect(),
            rims: loops.iter().map(|&k| self.rims[k].clone()).collect(),
        }
    }
}

impl Cut {
    /// The surface's parameters.
    pub(super) fn grid(&self) -> &Grid {
        &self.places.grid
    }

    pub(super) fn point(&self, uv: [f64; 2]) -> Point3 {
        let [u, v] = self.places.grid.reduced(uv);
        self.surface.point(u, v)
    }

    /// The piece that a place of the surface belongs to; its parameters are confined to the domain. On the curve itself, either.
    pub fn piece_at(&self, u: f64, v: f64) -> usize {
        let Places {
            grid,
            degree,
            leaves,
            sizes,
        } = &self.places;
        let uv = grid.reduced([u, v]);
        let below = grid.below(uv);
        for &size in sizes {
            let at = [0, 1].map(|d| below[d] - below[d] % size[d]);
            if let Some(Spot { leaf, pieces }) = leaves.get(&(at, size)) {
                let [x, y] = leaf.local(grid, uv);
                let above = value(&restricted(&leaf.points, *degree, 0, x), y) > 0.0;
                return pieces[usize::from(above)];
            }
        }
        0
    }
}

impl Places {
    fn new(grid: Grid, field: &Field, leaves: Leaves, regions: &Regions, of: &[usize]) -> Self {
        let mut spots = BTreeMap::new();
        let mut by_leaf = vec![[0; 2]; leaves.all.len()];
        for cell in &regions.cells {
            let sectors = cell.first..cell.first + cell.count;
            let piece = |above: bool| {
                let found = (sectors.clone()).find(|&k| regions.sectors[k].above == above);
                of[regions.of[found.unwrap_or(cell.first)]]
            };
            for &k in &cell.leaves {
                by_leaf[k] = [piece(false), piece(true)];
            }
        }
        for (leaf, pieces) in leaves.all.into_iter().zip(by_leaf) {
            spots.insert((leaf.at, leaf.size), Spot { leaf, pieces });
        }
        Self {
            grid,
            degree: field.degree(),
            sizes: spots.keys().map(|(_, size)| *size).collect(),
            leaves: spots,
        }
    }
}
