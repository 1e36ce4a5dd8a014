//! Writes parts as an AP242 file: a product each, its solids and sheets as boundaries. ISO 10303-242, -42 and -21.
//!
//! ```text
//! Brep ── numbers and directions as they read back ──▶ Brep ── points, curves, edges, loops, faces, shells, solids ──▶ text
//! ```
//! Same part, same bytes; and the file that is written of what was read from one is that file. Vertices, edges, faces and
//! shells are written once each, and points, directions, curves and surfaces once for all that have the same.

use super::write::surface_text;
use crate::exchange::LengthUnit;
use crate::exchange::number::real;
use crate::exchange::spline::{SplineError, Written, runs};
use crate::math::{Point3, Vector3, direction_of};
use crate::part::pcurve::{FlatCurve, pictures};
use crate::part::{
    Axes, Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell, Carrier, is_unit,
};
use crate::surface::{Curve, Surface};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;

/// Values in a line of a list.
const PER_LINE: usize = 8;

/// Why a part was not written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WritePartError {
    /// A surface that STEP has no form for.
    #[error("face #{id}: {source}")]
    Face {
        /// In the file that it was read from.
        id: u64,
        /// What is wrong.
        source: SplineError,
    },
    /// A curve that STEP has no form for.
    #[error(
        "edge #{id}: its curve is separated at t = {knot} (a knot of multiplicity degree + 1), which this format does not \
         support: split the edge there"
    )]
    Edge {
        /// In the file that it was read from.
        id: u64,
        /// Knot value.
        knot: f64,
    },
}

/// The file of a part: coordinates in `unit` if that is m, cm, mm or inch, else in mm. Reading it gives the same numbers bit
/// for bit where they were read from a file of the same unit or are written in metres, else the nearest that the unit has.
///
/// Edges of B-spline faces have their pictures in (u, v) beside them. A face without bounds gets a vertex or seams, since the
/// format asks for one.
///
/// # Errors
/// A surface or curve that comes apart at a knot.
///
/// # Examples
/// ```
/// use palpate_geometry::exchange::step::{PartPick, read_part, write_part};
/// use palpate_geometry::math::{Point3, Vector3};
/// use palpate_geometry::part::{Axes, Brep, BrepFace, BrepShell, Carrier};
/// let axes = Axes::new(Point3::origin(), &Vector3::z(), None).expect("an axis");
/// let (carrier, bounds) = (Carrier::Sphere { axes, radius_m: 0.01 }, Vec::new());
/// let ball = Brep {
///     faces: vec![BrepFace { id: 1, carrier, same_sense: true, bounds }],
///     shells: vec![BrepShell { faces: vec![0], closed: true, solid: Some(0) }],
///     ..Brep::default()
/// };
/// let millimetres = palpate_geometry::surface::file::Unit::Millimetre.into();
/// let text = write_part(&ball, &millimetres, "ball")?;
/// let read = read_part(text.as_bytes(), &PartPick::default())?;
/// assert_eq!(read.solids[0].name, "ball");
/// assert_eq!(read.brep.faces[0].carrier, ball.faces[0].carrier);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_part(brep: &Brep, unit: &LengthUnit, name: &str) -> Result<String, WritePartError> {
    write_parts(&[(name, brep)], unit)
}

/// [`write_part`] of several parts with their names: a product each, in one file. Each is written as it would be alone, so
/// that none shares geometry with another.
///
/// # Errors
/// A surface or curve that comes apart at a knot.
pub fn write_parts(parts: &[(&str, &Brep)], unit: &LengthUnit) -> Result<String, WritePartError> {
    let unit = &written_unit(unit);
    let mut sink = Sink::default();
    let mut names = Vec::with_capacity(parts.len());
    for (name, brep) in parts {
        let brep = &settled(brep, unit)?;
        sink.known.clear();
        let mut writer = Writer {
            brep,
            unit,
            sink,
            vertices: vec![None; brep.vertices.len()],
            edges: vec![None; brep.edges.len()],
            carriers: vec![None; brep.faces.len()],
            pictures: pictures(brep),
            flat_context: None,
        };
        let name = coded(name);
        let product = writer.product(&name);
        let context = writer.context();
        writer.representation(&name, product, context)?;
        sink = writer.sink;
        names.push(name);
    }
    let name = names.join(", ");
    // A time would make two files of one part differ.
    let version = env!("CARGO_PKG_VERSION");
    Ok(format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('boundary representation'),'2;1');\n\
         FILE_NAME('{name}','1970-01-01T00:00:00',(''),(''),'palpate {version}','palpate {version}','');\n\
         FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {{ 1 0 10303 442 1 1 4 }}'));\nENDSEC;\nDATA;\n\
         {}ENDSEC;\nEND-ISO-10303-21;\n",
        sink.out
    ))
}

/// m, cm, mm or inch.
pub(in crate::exchange) fn written_unit(unit: &LengthUnit) -> LengthUnit {
    let known = [
        LengthUnit::of_metres("m", 1.0, 1.0),
        LengthUnit::of_metres("cm", 1.0, 1e2),
        LengthUnit::of_metres("inch", 25.4, 1e3),
    ];
    let same = |one: &LengthUnit| (one.metres() / unit.metres() - 1.0).abs() < 1e-12;
    let found = known.into_iter().find(same);
    found.unwrap_or_else(|| LengthUnit::of_metres("mm", 1.0, 1e3))
}

/// The part with the numbers and directions that a reader will have.
fn settled(brep: &Brep, unit: &LengthUnit) -> Result<Brep, WritePartError> {
    let length = |x: f64| unit.to_metres(unit.of_length(x));
    let point = |p: &Point3| p.map(length);
    let place = |axes: &Axes| {
        let origin = point(&axes.origin);
        let [z, x] = [axes.z, axes.x].map(|v| v.add_scalar(0.0));
        Axes::exactly(origin, &z, &x).unwrap_or(Axes { origin, ..*axes })
    };
    let curve = |edge: &BrepEdge| {
        Ok(match &edge.curve {
            BrepCurve::Line { origin, direction } => BrepCurve::Line {
                origin: point(origin),
                direction: unit_vector(direction),
            },
            BrepCurve::Circle { axes, radius_m } => BrepCurve::Circle {
                axes: place(axes),
                radius_m: length(*radius_m),
            },
            BrepCurve::Ellipse { axes, radii_m } => BrepCurve::Ellipse {
                axes: place(axes),
                radii_m: radii_m.map(length),
            },
            BrepCurve::Hyperbola { axes, radii_m } => BrepCurve::Hyperbola {
                axes: place(axes),
                radii_m: radii_m.map(length),
            },
            BrepCurve::Parabola { axes, focal_m } => BrepCurve::Parabola {
                axes: place(axes),
                focal_m: length(*focal_m),
            },
            BrepCurve::Spline(curve) => {
                if let Some(&knot) = curve.knots().disjoined().first() {
                    return Err(WritePartError::Edge { id: edge.id, knot });
                }
                let points = curve.points().iter().map(point).collect();
                let weights = curve.weights().map(<[f64]>::to_vec);
                let moved = Curve::new(curve.knots().clone(), points, weights);
                BrepCurve::Spline(moved.unwrap_or_else(|_| curve.clone()))
            }
        })
    };
    let carrier = |carrier: &Carrier| match carrier {
        Carrier::Plane(axes) => Carrier::Plane(place(axes)),
        Carrier::Cylinder { axes, radius_m } => Carrier::Cylinder {
            axes: place(axes),
            radius_m: length(*radius_m),
        },
        Carrier::Cone {
            axes,
            half_angle_rad,
        } => Carrier::Cone {
            axes: place(axes),
            half_angle_rad: *half_angle_rad,
        },
        Carrier::Sphere { axes, radius_m } => Carrier::Sphere {
            axes: place(axes),
            radius_m: length(*radius_m),
        },
        Carrier::Torus {
            axes,
            major_m,
            minor_m,
        } => Carrier::Torus {
            axes: place(axes),
            major_m: length(*major_m),
            minor_m: length(*minor_m),
        },
        Carrier::Spline(surface) => {
            let mut moved = (**surface).clone();
            for p in moved.net_mut().points_mut() {
                *p = point(p);
            }
            Carrier::Spline(Box::new(moved))
        }
    };
    let edges = brep.edges.iter().map(|edge| {
        Ok(BrepEdge {
            curve: curve(edge)?,
            ..edge.clone()
        })
    });
    let faces = brep.faces.iter().map(|face| BrepFace {
        carrier: carrier(&face.carrier),
        ..face.clone()
    });
    Ok(Brep {
        vertices: brep.vertices.iter().map(point).collect(),
        edges: edges.collect::<Result<_, _>>()?,
        faces: faces.collect(),
        shells: all_shells(brep),
        uncertainty_m: length(brep.uncertainty_m),
    })
}

/// Of length 1, without −0.
fn unit_vector(v: &Vector3) -> Vector3 {
    let v = match is_unit(v) {
        true => *v,
        false => direction_of(v).unwrap_or(*v),
    };
    v.add_scalar(0.0)
}

/// The shells, and one of the faces that are in none.
fn all_shells(brep: &Brep) -> Vec<BrepShell> {
    let mut alone = vec![true; brep.faces.len()];
    for &face in brep.shells.iter().flat_map(|shell| &shell.faces) {
        alone[face as usize] = false;
    }
    let alone = (0..brep.faces.len() as u32).filter(|&f| alone[f as usize]);
    let mut shells = brep.shells.clone();
    shells.push(BrepShell {
        faces: alone.collect(),
        closed: false,
        solid: None,
    });
    shells.retain(|shell| !shell.faces.is_empty());
    shells
}

/// Instances, numbered as they come.
#[derive(Default)]
struct Sink {
    out: String,
    count: u64,
    known: BTreeMap<String, u64>,
}

impl Sink {
    fn add(&mut self, text: &str) -> u64 {
        self.count += 1;
        let _ = writeln!(self.out, "#{}={text};", self.count);
        self.count
    }

    /// The instance with this text, which has no other identity.
    fn share(&mut self, text: String) -> u64 {
        if let Some(&known) = self.known.get(&text) {
            return known;
        }
        let id = self.add(&text);
        self.known.insert(text, id);
        id
    }
}

struct Writer<'a> {
    brep: &'a Brep,
    unit: &'a LengthUnit,
    sink: Sink,
    vertices: Vec<Option<u64>>,
    edges: Vec<Option<u64>>,
    /// By face.
    carriers: Vec<Option<u64>>,
    /// By edge: face and curve in its parameters.
    pictures: Vec<Vec<(u32, FlatCurve)>>,
    flat_context: Option<u64>,
}

impl Writer<'_> {
    /// The product; its shape is returned.
    fn product(&mut self, name: &str) -> u64 {
        let sink = &mut self.sink;
        let application = sink.add("APPLICATION_CONTEXT('managed model based 3d engineering')");
        sink.add(&format!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','ap242_managed_model_based_3d_engineering',2014,\
             #{application})"
        ));
        let of_product = sink.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
        let product = sink.add(&format!("PRODUCT('{name}','{name}','',(#{of_product}))"));
        sink.add(&format!(
            "PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"
        ));
        let formation = sink.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
        let of_definition = sink.add(&format!(
            "PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"
        ));
        let definition = sink.add(&format!(
            "PRODUCT_DEFINITION('design','',#{formation},#{of_definition})"
        ));
        sink.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"))
    }

    /// Units, and how far edges may be off.
    fn context(&mut self) -> u64 {
        let (unit, sink) = (self.unit, &mut self.sink);
        let si = |prefix: &str| format!("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.))");
        let length = match unit.name() {
            "m" => sink.add(&si("$")),
            "cm" => sink.add(&si(".CENTI.")),
            "inch" => {
                let millimetre = sink.add(&si(".MILLI."));
                let inch = sink.add(&format!(
                    "LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#{millimetre})"
                ));
                let power = sink.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)");
                sink.add(&format!(
                    "(CONVERSION_BASED_UNIT('INCH',#{inch})LENGTH_UNIT()NAMED_UNIT(#{power}))"
                ))
            }
            _ => sink.add(&si(".MILLI.")),
        };
        let angle = sink.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        let solid_angle = sink.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
        let mut uncertainty = String::new();
        if self.brep.uncertainty_m > 0.0 {
            let measure = sink.add(&format!(
                "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','')",
                real(unit.of_length(self.brep.uncertainty_m), 'E')
            ));
            uncertainty = format!("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{measure}))");
        }
        sink.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3){uncertainty}\
             GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle}))REPRESENTATION_CONTEXT('',''))"
        ))
    }

    fn representation(
        &mut self,
        name: &str,
        product: u64,
        context: u64,
    ) -> Result<(), WritePartError> {
        let origin = self.axes(&Axes {
            origin: Point3::origin(),
            x: Vector3::x(),
            y: Vector3::y(),
            z: Vector3::z(),
        });
        let mut items = vec![origin];
        let brep = self.brep;
        let groups = groups(brep);
        for group in &groups {
            let shells = &brep.shells[group.clone()];
            items.push(self.item(shells)?);
        }
        let solids = groups
            .iter()
            .filter(|group| brep.shells[group.start].solid.is_some())
            .count();
        let kind = match solids {
            0 => "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
            n if n == groups.len() => "ADVANCED_BREP_SHAPE_REPRESENTATION",
            _ => "SHAPE_REPRESENTATION",
        };
        let items = list(items.iter().map(|id| format!("#{id}")));
        let shape = self
            .sink
            .add(&format!("{kind}('{name}',{items},#{context})"));
        self.sink.add(&format!(
            "SHAPE_DEFINITION_REPRESENTATION(#{product},#{shape})"
        ));
        Ok(())
    }

    /// A solid, or shells that share edges.
    fn item(&mut self, shells: &[BrepShell]) -> Result<u64, WritePartError> {
        let mut ids = Vec::new();
        for shell in shells {
            let mut faces = Vec::new();
            for &face in &shell.faces {
                faces.push(format!("#{}", self.face(face)?));
            }
            let kind = match shell.closed {
                true => "CLOSED_SHELL",
                false => "OPEN_SHELL",
            };
            ids.push(self.sink.add(&format!("{kind}('',{})", list(faces))));
        }
        let (outer, voids) = (ids[0], &ids[1..]);
        let text = match (shells[0].solid, voids) {
            (None, _) => {
                let shells = list(ids.iter().map(|id| format!("#{id}")));
                format!("SHELL_BASED_SURFACE_MODEL('',{shells})")
            }
            (Some(_), []) => format!("MANIFOLD_SOLID_BREP('',#{outer})"),
            (Some(_), _) => {
                // Faces of voids look into them, out of the matter.
                let mut turned = Vec::new();
                for void in voids {
                    let text = format!("ORIENTED_CLOSED_SHELL('',*,#{void},.T.)");
                    turned.push(format!("#{}", self.sink.add(&text)));
                }
                format!("BREP_WITH_VOIDS('',#{outer},{})", list(turned))
            }
        };
        Ok(self.sink.add(&text))
    }

    fn face(&mut self, index: u32) -> Result<u64, WritePartError> {
        let face = &self.brep.faces[index as usize];
        let mut bounds = Vec::new();
        for bound in &face.bounds {
            let text = match bound {
                BrepBound::Vertex(vertex) => {
                    let vertex = self.vertex(*vertex);
                    format!("VERTEX_LOOP('',#{vertex})")
                }
                BrepBound::Loop(uses) => {
                    let mut edges = Vec::with_capacity(uses.len());
                    for &(edge, forward) in uses {
                        edges.push((self.edge(edge)?, forward));
                    }
                    self.edge_loop(&edges)
                }
            };
            bounds.push(text);
        }
        if bounds.is_empty() {
            bounds = self.whole(face);
        }
        let bounds: Vec<String> = (bounds.iter())
            .map(|text| {
                let walk = self.sink.add(text);
                let bound = format!("FACE_BOUND('',#{walk},.T.)");
                format!("#{}", self.sink.add(&bound))
            })
            .collect();
        let carrier = self.carrier(index)?;
        // Of a B-spline the file knows the normal of its parametrisation only.
        let flipped = matches!(&face.carrier, Carrier::Spline(surface) if surface.flip_normal());
        Ok(self.sink.add(&format!(
            "ADVANCED_FACE('',{},#{carrier},{})",
            list(bounds),
            logical(face.same_sense != flipped)
        )))
    }

    fn edge_loop(&mut self, uses: &[(u64, bool)]) -> String {
        let mut oriented = Vec::with_capacity(uses.len());
        for (edge, forward) in uses {
            let text = format!("ORIENTED_EDGE('',*,*,#{edge},{})", logical(*forward));
            oriented.push(format!("#{}", self.sink.add(&text)));
        }
        format!("EDGE_LOOP('',{})", list(oriented))
    }

    /// The bounds of a face that has none: both seams of a ring, or vertices.
    fn whole(&mut self, face: &BrepFace) -> Vec<String> {
        let places = match &face.carrier {
            Carrier::Torus {
                axes,
                major_m,
                minor_m,
            } if major_m > minor_m => return vec![self.ring(face, axes, *major_m, *minor_m)],
            Carrier::Torus {
                axes,
                major_m,
                minor_m,
            } => {
                let up = axes.z * (minor_m * minor_m - major_m * major_m).sqrt();
                vec![axes.origin - up, axes.origin + up]
            }
            Carrier::Sphere { axes, radius_m } => vec![axes.origin - axes.z * *radius_m],
            Carrier::Spline(surface) => {
                let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
                vec![surface.point(u.0, v.0)]
            }
            Carrier::Plane(axes) | Carrier::Cone { axes, .. } => vec![axes.origin],
            Carrier::Cylinder { axes, radius_m } => vec![axes.origin + axes.x * *radius_m],
        };
        let bound = |place: &Point3| {
            let vertex = self.vertex_at(place);
            format!("VERTEX_LOOP('',#{vertex})")
        };
        places.iter().map(bound).collect()
    }

    fn ring(&mut self, face: &BrepFace, axes: &Axes, major_m: f64, minor_m: f64) -> String {
        let vertex = self.vertex_at(&(axes.origin + axes.x * (major_m + minor_m)));
        let tube = Axes {
            origin: axes.origin + axes.x * major_m,
            x: axes.x,
            y: axes.z,
            z: -axes.y,
        };
        let [round, across] =
            [(*axes, major_m + minor_m), (tube, minor_m)].map(|(axes, radius_m)| {
                let place = self.axes(&axes);
                let radius = self.length(radius_m);
                let circle = self.sink.share(format!("CIRCLE('',#{place},{radius})"));
                self.sink
                    .add(&format!("EDGE_CURVE('',#{vertex},#{vertex},#{circle},.T.)"))
            });
        let mut uses = [
            (round, true),
            (across, true),
            (round, false),
            (across, false),
        ];
        if !face.same_sense {
            uses.reverse();
            uses.iter_mut()
                .for_each(|(_, forward)| *forward = !*forward);
        }
        self.edge_loop(&uses)
    }

    fn vertex(&mut self, index: u32) -> u64 {
        if let Some(known) = self.vertices[index as usize] {
            return known;
        }
        let brep = self.brep;
        let id = self.vertex_at(&brep.vertices[index as usize]);
        self.vertices[index as usize] = Some(id);
        id
    }

    fn vertex_at(&mut self, point: &Point3) -> u64 {
        let point = self.point(point);
        self.sink.add(&format!("VERTEX_POINT('',#{point})"))
    }

    fn edge(&mut self, index: u32) -> Result<u64, WritePartError> {
        if let Some(known) = self.edges[index as usize] {
            return Ok(known);
        }
        let edge = &self.brep.edges[index as usize];
        let [first, last] = edge.ends.map(|vertex| self.vertex(vertex));
        let mut curve = self.curve(&edge.curve);
        let pictures = std::mem::take(&mut self.pictures[index as usize]);
        let mut drawn = Vec::new();
        // The format has room for two.
        for (face, picture) in pictures.iter().take(2) {
            drawn.push(format!("#{}", self.picture(*face, picture)?));
        }
        if !drawn.is_empty() {
            let text = format!("SURFACE_CURVE('',#{curve},{},.CURVE_3D.)", list(drawn));
            curve = self.sink.add(&text);
        }
        let id = self.sink.add(&format!(
            "EDGE_CURVE('',#{first},#{last},#{curve},{})",
            logical(edge.along)
        ));
        self.edges[index as usize] = Some(id);
        Ok(id)
    }

    /// A curve in the parameters of a face's surface.
    fn picture(&mut self, face: u32, picture: &FlatCurve) -> Result<u64, WritePartError> {
        let surface = self.carrier(face)?;
        let context = match self.flat_context {
            Some(context) => context,
            None => self.sink.add(
                "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('',''))",
            ),
        };
        self.flat_context = Some(context);
        let points: Vec<u64> = (picture.points.iter())
            .map(|[u, v]| {
                let (u, v) = (real(*u, 'E'), real(*v, 'E'));
                self.sink.share(format!("CARTESIAN_POINT('',({u},{v}))"))
            })
            .collect();
        let last = picture.breaks.len() - 1;
        let knots = picture.breaks.iter().enumerate();
        let knots: Vec<(f64, u64)> = knots
            .map(|(k, t)| (*t, if k == 0 || k == last { 4 } else { 3 }))
            .collect();
        let closed = picture.points[0] == picture.points[picture.points.len() - 1];
        let curve = self
            .sink
            .add(&spline_text(3, &points, closed, &knots, None));
        let drawn = self.sink.add(&format!(
            "DEFINITIONAL_REPRESENTATION('',(#{curve}),#{context})"
        ));
        Ok(self.sink.add(&format!("PCURVE('',#{surface},#{drawn})")))
    }

    fn curve(&mut self, curve: &BrepCurve) -> u64 {
        let text = match curve {
            BrepCurve::Line { origin, direction } => {
                let (origin, direction) = (self.point(origin), self.direction(direction));
                let vector = self.sink.share(format!("VECTOR('',#{direction},1.)"));
                format!("LINE('',#{origin},#{vector})")
            }
            BrepCurve::Circle { axes, radius_m } => {
                format!("CIRCLE('',#{},{})", self.axes(axes), self.length(*radius_m))
            }
            BrepCurve::Ellipse { axes, radii_m } => self.conic("ELLIPSE", axes, *radii_m),
            BrepCurve::Hyperbola { axes, radii_m } => self.conic("HYPERBOLA", axes, *radii_m),
            BrepCurve::Parabola { axes, focal_m } => {
                format!(
                    "PARABOLA('',#{},{})",
                    self.axes(axes),
                    self.length(*focal_m)
                )
            }
            BrepCurve::Spline(curve) => {
                let knots = curve.knots();
                let count = curve.points().len();
                let index: Vec<usize> = (0..knots.basis_count()).map(|k| k % count).collect();
                let points: Vec<u64> = (index.iter())
                    .map(|&k| self.point(&curve.points()[k]))
                    .collect();
                let weights: Option<Vec<f64>> = curve
                    .weights()
                    .map(|weights| index.iter().map(|&k| weights[k]).collect());
                let closed = points[0] == points[points.len() - 1] || knots.is_periodic();
                let runs = runs(knots.knots());
                spline_text(knots.degree(), &points, closed, &runs, weights.as_deref())
            }
        };
        self.sink.share(text)
    }

    fn conic(&mut self, name: &str, axes: &Axes, radii_m: [f64; 2]) -> String {
        let place = self.axes(axes);
        let [a, b] = radii_m.map(|radius_m| self.length(radius_m));
        format!("{name}('',#{place},{a},{b})")
    }

    /// The surface of a face.
    fn carrier(&mut self, face: u32) -> Result<u64, WritePartError> {
        if let Some(known) = self.carriers[face as usize] {
            return Ok(known);
        }
        let BrepFace { id, carrier, .. } = &self.brep.faces[face as usize];
        let text = match carrier {
            Carrier::Plane(axes) => format!("PLANE('',#{})", self.axes(axes)),
            Carrier::Cylinder { axes, radius_m } => {
                let (place, radius) = (self.axes(axes), self.length(*radius_m));
                format!("CYLINDRICAL_SURFACE('',#{place},{radius})")
            }
            // Its radius at the apex, where the axes are.
            Carrier::Cone {
                axes,
                half_angle_rad,
            } => {
                let (place, angle) = (self.axes(axes), real(*half_angle_rad, 'E'));
                format!("CONICAL_SURFACE('',#{place},0.,{angle})")
            }
            Carrier::Sphere { axes, radius_m } => {
                let (place, radius) = (self.axes(axes), self.length(*radius_m));
                format!("SPHERICAL_SURFACE('',#{place},{radius})")
            }
            Carrier::Torus {
                axes,
                major_m,
                minor_m,
            } => {
                let place = self.axes(axes);
                let [major, minor] = [major_m, minor_m].map(|radius_m| self.length(*radius_m));
                match minor_m > major_m {
                    true => format!("DEGENERATE_TOROIDAL_SURFACE('',#{place},{major},{minor},.T.)"),
                    false => format!("TOROIDAL_SURFACE('',#{place},{major},{minor})"),
                }
            }
            Carrier::Spline(surface) => self
                .spline(surface)
                .map_err(|source| WritePartError::Face { id: *id, source })?,
        };
        let id = self.sink.share(text);
        self.carriers[face as usize] = Some(id);
        Ok(id)
    }

    fn spline(&mut self, surface: &Surface) -> Result<String, SplineError> {
        let written = Written::new(&surface.clone().with_flip_normal(false))?;
        let points: Vec<u64> = written.points.iter().map(|p| self.point(p)).collect();
        Ok(surface_text(&written, |k| format!("#{}", points[k])))
    }

    fn axes(&mut self, axes: &Axes) -> u64 {
        let origin = self.point(&axes.origin);
        let [z, x] = [axes.z, axes.x].map(|direction| self.direction(&direction));
        self.sink
            .share(format!("AXIS2_PLACEMENT_3D('',#{origin},#{z},#{x})"))
    }

    fn point(&mut self, point: &Point3) -> u64 {
        let [x, y, z] = [point.x, point.y, point.z].map(|x| self.length(x));
        self.sink
            .share(format!("CARTESIAN_POINT('',({x},{y},{z}))"))
    }

    fn direction(&mut self, direction: &Vector3) -> u64 {
        let [x, y, z] = [direction.x, direction.y, direction.z].map(|x| real(x + 0.0, 'E'));
        self.sink.share(format!("DIRECTION('',({x},{y},{z}))"))
    }

    /// A length in the unit of the file.
    fn length(&self, metres: f64) -> String {
        real(self.unit.of_length(metres), 'E')
    }
}

/// Shells of one solid, and sheets in a row that share edges.
fn groups(brep: &Brep) -> Vec<Range<usize>> {
    let shells = &brep.shells;
    let mut last = vec![0; brep.edges.len()];
    for (k, shell) in shells.iter().enumerate() {
        for &face in &shell.faces {
            for bound in &brep.faces[face as usize].bounds {
                if let BrepBound::Loop(uses) = bound {
                    uses.iter().for_each(|(edge, _)| last[*edge as usize] = k);
                }
            }
        }
    }
    let mut groups: Vec<Range<usize>> = Vec::new();
    let mut reach = 0;
    for (k, shell) in shells.iter().enumerate() {
        let with = groups.last_mut().filter(|group| {
            let first = &shells[group.start];
            first.solid == shell.solid && (shell.solid.is_some() || k <= reach)
        });
        match with {
            Some(group) => group.end = k + 1,
            None => groups.push(k..k + 1),
        }
        for &face in &shell.faces {
            for bound in &brep.faces[face as usize].bounds {
                if let BrepBound::Loop(uses) = bound {
                    let farthest = uses.iter().map(|(edge, _)| last[*edge as usize]);
                    reach = farthest.fold(reach, usize::max);
                }
            }
        }
    }
    groups
}

fn spline_text(
    degree: usize,
    points: &[u64],
    closed: bool,
    knots: &[(f64, u64)],
    weights: Option<&[f64]>,
) -> String {
    let points = list(points.iter().map(|id| format!("#{id}")));
    let common = format!("{degree},{points},.UNSPECIFIED.,{},.U.", logical(closed));
    let times = list(knots.iter().map(|(_, times)| times.to_string()));
    let values = list(knots.iter().map(|(knot, _)| real(*knot, 'E')));
    let knots = format!("{times},{values},.UNSPECIFIED.");
    match weights {
        None => format!("B_SPLINE_CURVE_WITH_KNOTS('',{common},{knots})"),
        Some(weights) => {
            let weights = list(weights.iter().map(|weight| real(*weight, 'E')));
            format!(
                "(BOUNDED_CURVE()B_SPLINE_CURVE({common})B_SPLINE_CURVE_WITH_KNOTS({knots})CURVE()\
                 GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({weights})REPRESENTATION_ITEM(''))"
            )
        }
    }
}

fn logical(flag: bool) -> &'static str {
    if flag { ".T." } else { ".F." }
}

/// `(…)`, a few values a line.
fn list(values: impl IntoIterator<Item = String>) -> String {
    let values: Vec<String> = values.into_iter().collect();
    let lines: Vec<String> = values.chunks(PER_LINE).map(|some| some.join(",")).collect();
    format!("({})", lines.join(",\n"))
}

/// A text as it stands between apostrophes: ASCII, all else in hexadecimal.
fn coded(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            _ => {
                let mut units = [0; 2];
                out.push_str("\\X2\\");
                for unit in c.encode_utf16(&mut units) {
                    let _ = write!(out, "{unit:04X}");
                }
                out.push_str("\\X0\\");
            }
        }
    }
    out
}
