//! A boundary as files write it: vertices, edges, faces and shells, before anything is computed of it.

use super::carrier::{Axes, Carrier};
use crate::math::{Matrix3, Point3, Vector3};
use crate::surface::Curve;

/// Vertices, edges, faces, shells; lengths in m, in one coordinate system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Brep {
    /// m.
    pub vertices: Vec<Point3>,
    /// Each is used once by each face that it bounds.
    pub edges: Vec<BrepEdge>,
    /// In the order of the file's shells.
    pub faces: Vec<BrepFace>,
    /// What the faces make together.
    pub shells: Vec<BrepShell>,
    /// How far the file says that its edges and vertices may be off their surfaces, m; 0 where it does not say.
    pub uncertainty_m: f64,
}

/// A piece of a curve between two vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct BrepEdge {
    /// `#id` in the file.
    pub id: u64,
    /// The whole curve.
    pub curve: BrepCurve,
    /// First and last vertex; one vertex twice for a closed curve.
    pub ends: [u32; 2],
    /// From the first vertex to the last one goes along the curve; against it if false.
    pub along: bool,
}

/// A curve in space, unbounded or closed where its kind is.
#[derive(Clone, Debug, PartialEq)]
pub enum BrepCurve {
    /// Through the origin.
    Line {
        /// m.
        origin: Point3,
        /// Of unit length.
        direction: Vector3,
    },
    /// origin + a (cos t x + sin t y).
    Circle {
        /// At the centre.
        axes: Axes,
        /// m.
        radius_m: f64,
    },
    /// origin + a cos t x + b sin t y.
    Ellipse {
        /// At the centre.
        axes: Axes,
        /// a and b, m.
        radii_m: [f64; 2],
    },
    /// origin + a cosh t x + b sinh t y.
    Hyperbola {
        /// At the centre.
        axes: Axes,
        /// a and b, m.
        radii_m: [f64; 2],
    },
    /// origin + f t² x + 2 f t y.
    Parabola {
        /// At the vertex.
        axes: Axes,
        /// f, m.
        focal_m: f64,
    },
    /// Polylines are those of degree 1.
    Spline(Curve),
}

/// A part of a carrier within loops of edges.
#[derive(Clone, Debug, PartialEq)]
pub struct BrepFace {
    /// `#id` in the file.
    pub id: u64,
    /// What it is a part of.
    pub carrier: Carrier,
    /// The face's normal is the carrier's; its opposite if false.
    pub same_sense: bool,
    /// Outer and inner ones alike, in any order. Who walks along one on the side of the face's normal has the face on the left.
    pub bounds: Vec<BrepBound>,
}

/// What bounds a face.
#[derive(Clone, Debug, PartialEq)]
pub enum BrepBound {
    /// Edges end to start, and whether each goes from its first vertex to its last.
    Loop(Vec<(u32, bool)>),
    /// A single vertex: the apex of a cone, a pole; the face goes all round it.
    Vertex(u32),
}

impl BrepBound {
    /// Walked the other way.
    pub(crate) fn reverse(&mut self) {
        if let Self::Loop(uses) = self {
            uses.reverse();
            uses.iter_mut()
                .for_each(|(_, forward)| *forward = !*forward);
        }
    }
}

/// Faces that are connected.
#[derive(Clone, Debug, PartialEq)]
pub struct BrepShell {
    /// Indices of faces.
    pub faces: Vec<u32>,
    /// The file calls it closed.
    pub closed: bool,
    /// Index of the solid that it bounds, alone or with others (voids); `None` for sheets.
    pub solid: Option<u32>,
}

/// A rotation, reflection, scale and shift: x ↦ scale · turn · x + shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// Orthogonal; its determinant is −1 for a mirror image.
    pub turn: Matrix3,
    /// Above 0.
    pub scale: f64,
    /// m.
    pub shift: Vector3,
}

impl Default for Placing {
    fn default() -> Self {
        Self {
            turn: Matrix3::identity(),
            scale: 1.0,
            shift: Vector3::zeros(),
        }
    }
}

impl Placing {
    /// The place of a point.
    pub fn point(&self, point: &Point3) -> Point3 {
        Point3::from(self.turn * point.coords * self.scale + self.shift)
    }

    /// First `inner`, then this.
    pub fn after(&self, inner: &Self) -> Self {
        Self {
            turn: self.turn * inner.turn,
            scale: self.scale * inner.scale,
            shift: self.turn * inner.shift * self.scale + self.shift,
        }
    }

    /// It makes mirror images.
    pub fn mirrors(&self) -> bool {
        self.turn.determinant() < 0.0
    }

    /// Where axes come to lie. Of a mirror image y is turned round, so that they stay right-handed; a circle's angles
    /// then run the other way.
    fn axes(&self, axes: &Axes) -> Axes {
        let (x, z) = (self.turn * axes.x, self.turn * axes.z);
        Axes {
            origin: self.point(&axes.origin),
            x,
            y: z.cross(&x),
            z,
        }
    }
}

impl Brep {
    /// Its copy in another place.
    ///
    /// # Errors
    /// A B-spline's coordinates, or those of a curve, leave the range of lengths.
    pub fn placed(&self, placing: &Placing) -> Result<Self, OutOfRange> {
        let mirrored = placing.mirrors();
        let curve = |curve: &BrepCurve| {
            let scaled = |[a, b]: [f64; 2]| [a * placing.scale, b * placing.scale];
            Ok(match curve {
                BrepCurve::Line { origin, direction } => BrepCurve::Line {
                    origin: placing.point(origin),
                    direction: placing.turn * direction,
                },
                // Traversed backwards where it is mirrored: see `along` below.
                BrepCurve::Circle { axes, radius_m } => BrepCurve::Circle {
                    axes: placing.axes(axes),
                    radius_m: radius_m * placing.scale,
                },
                BrepCurve::Ellipse { axes, radii_m } => BrepCurve::Ellipse {
                    axes: placing.axes(axes),
                    radii_m: scaled(*radii_m),
                },
                BrepCurve::Hyperbola { axes, radii_m } => BrepCurve::Hyperbola {
                    axes: placing.axes(axes),
                    radii_m: scaled(*radii_m),
                },
                BrepCurve::Parabola { axes, focal_m } => BrepCurve::Parabola {
                    axes: placing.axes(axes),
                    focal_m: focal_m * placing.scale,
                },
                BrepCurve::Spline(curve) => {
                    let points = curve.points().iter().map(|p| placing.point(p)).collect();
                    let weights = curve.weights().map(<[f64]>::to_vec);
                    let curve = Curve::new(curve.knots().clone(), points, weights);
                    BrepCurve::Spline(curve.map_err(|_| OutOfRange)?)
                }
            })
        };
        let turned = |curve: &BrepCurve| {
            mirrored && !matches!(curve, BrepCurve::Line { .. } | BrepCurve::Spline(_))
        };
        let edges = self.edges.iter().map(|edge| {
            Ok(BrepEdge {
                curve: curve(&edge.curve)?,
                along: edge.along != turned(&edge.curve),
                ..edge.clone()
            })
        });
        let faces = self.faces.iter().map(|face| face.placed(placing, mirrored));
        Ok(Self {
            vertices: self.vertices.iter().map(|p| placing.point(p)).collect(),
            edges: edges.collect::<Result<_, _>>()?,
            faces: faces.collect::<Result<_, _>>()?,
            shells: self.shells.clone(),
            uncertainty_m: self.uncertainty_m * placing.scale,
        })
    }

    /// Takes faces out that are marked, and edges that bound no other face.
    pub(super) fn remove_faces(&mut self, gone: &[bool]) {
        let renumbered = |keep: &[bool]| -> Vec<u32> {
            let mut next = 0;
            let number = |keep: &bool| {
                let own = next;
                next += u32::from(*keep);
                own
            };
            keep.iter().map(number).collect()
        };
        let kept: Vec<bool> = gone.iter().map(|gone| !gone).collect();
        let face_index = renumbered(&kept);
        let mut all = kept.iter();
        self.faces.retain(|_| all.next() == Some(&true));
        for shell in &mut self.shells {
            shell.faces.retain(|&f| kept[f as usize]);
            (shell.faces.iter_mut()).for_each(|f| *f = face_index[*f as usize]);
        }
        let uses = |face: &mut BrepFace, act: &mut dyn FnMut(&mut u32)| {
            for bound in &mut face.bounds {
                if let BrepBound::Loop(uses) = bound {
                    uses.iter_mut().for_each(|(edge, _)| act(edge));
                }
            }
        };
        let mut used = vec![false; self.edges.len()];
        for face in &mut self.faces {
            uses(face, &mut |edge| used[*edge as usize] = true);
        }
        let edge_index = renumbered(&used);
        for face in &mut self.faces {
            uses(face, &mut |edge| *edge = edge_index[*edge as usize]);
        }
        let mut all = used.iter();
        self.edges.retain(|_| all.next() == Some(&true));
    }

    /// Adds all that another has, beside what is here.
    pub fn add(&mut self, other: Self) {
        let [vertex, edge, face] =
            [self.vertices.len(), self.edges.len(), self.faces.len()].map(|n| n as u32);
        let solids = self.shells.iter().filter_map(|shell| shell.solid);
        let solid = solids.max().map_or(0, |last| last + 1);
        self.vertices.extend(other.vertices);
        self.edges.extend(other.edges.into_iter().map(|mut e| {
            e.ends = e.ends.map(|v| v + vertex);
            e
        }));
        self.faces.extend(other.faces.into_iter().map(|mut f| {
            for bound in &mut f.bounds {
                match bound {
                    BrepBound::Loop(uses) => uses.iter_mut().for_each(|(e, _)| *e += edge),
                    BrepBound::Vertex(v) => *v += vertex,
                }
            }
            f
        }));
        self.shells.extend(other.shells.into_iter().map(|mut s| {
            s.faces.iter_mut().for_each(|f| *f += face);
            s.solid = s.solid.map(|k| k + solid);
            s
        }));
        self.uncertainty_m = self.uncertainty_m.max(other.uncertainty_m);
    }
}

impl BrepFace {
    /// In another place. A mirror image is walked round the other way; a B-spline's parametrisation then gives the
    /// opposite normal.
    fn placed(&self, placing: &Placing, mirrored: bool) -> Result<Self, OutOfRange> {
        let scale = placing.scale;
        let carrier = match &self.carrier {
            Carrier::Plane(axes) => Carrier::Plane(placing.axes(axes)),
            Carrier::Cylinder { axes, radius_m } => Carrier::Cylinder {
                axes: placing.axes(axes),
                radius_m: radius_m * scale,
            },
            Carrier::Cone {
                axes,
                half_angle_rad,
            } => Carrier::Cone {
                axes: placing.axes(axes),
                half_angle_rad: *half_angle_rad,
            },
            Carrier::Sphere { axes, radius_m } => Carrier::Sphere {
                axes: placing.axes(axes),
                radius_m: radius_m * scale,
            },
            Carrier::Torus {
                axes,
                major_m,
                minor_m,
            } => Carrier::Torus {
                axes: placing.axes(axes),
                major_m: major_m * scale,
                minor_m: minor_m * scale,
            },
            Carrier::Spline(surface) => {
                let mut moved = (**surface).clone();
                for point in moved.net_mut().points_mut() {
                    *point = placing.point(point);
                    if crate::math::first_outside(std::slice::from_ref(point)).is_some() {
                        return Err(OutOfRange);
                    }
                }
                Carrier::Spline(Box::new(moved))
            }
        };
        let spline = matches!(carrier, Carrier::Spline(_));
        let mut bounds = self.bounds.clone();
        for bound in &mut bounds {
            if mirrored {
                bound.reverse();
            }
        }
        Ok(Self {
            id: self.id,
            carrier,
            same_sense: self.same_sense != (mirrored && spline),
            bounds,
        })
    }
}

/// Coordinates leave the range of lengths that can be calculated with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a coordinate leaves the range of lengths where its assembly puts it")]
pub struct OutOfRange;
