//! What measures look at.

use super::super::played::{Played, View};
use super::super::surfaces::{grid, rest_surface, surface_now};
use super::edge::{EdgeSpec, Line};
use super::penetration::deepest_m;
use super::prism::Prism;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::scene::Scene;
use palpate_sim::tick::quantity::{Number, ToolTick};
use serde::Deserialize;

/// Cells a span of the triangles that volumes are taken of: with 8, the volume of a sphere of 8 × 5
/// spans is 0.05 % small, at rest and now alike.
const CELLS: usize = 8;
/// Points each way at which a surface is looked at everywhere.
const POINTS: usize = 81;
/// Slower than this, a body is at rest, m/s.
const AT_REST_M_S: f64 = 1e-3;

/// What is looked at, SI.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Look {
    /// Of a point of a body's surface along a direction, m.
    Displacement {
        body: String,
        uv: [f64; 2],
        along: [f64; 3],
    },
    /// The greatest of all points of a body's surface, of those farther than `from_m` from `away`.
    GreatestDisplacement {
        body: String,
        #[serde(default)]
        away: Vec<[f64; 3]>,
        #[serde(default)]
        from_m: f64,
    },
    /// Angle between two parts of a line of the surface, rad: how far the second turned against the
    /// first since the start.
    EdgeAngle(EdgeSpec),
    /// Greatest distance of a part of a line of the surface from its straight line, m.
    EdgeStraightness(EdgeSpec),
    /// Greatest speed of a body, m/s.
    Speed { body: String },
    /// Volume against that at rest, relative.
    VolumeChange { body: String },
    /// Part of a body's volume outside the upright prism over the rim of an open surface.
    Spilled { body: String, rim: String },
    /// How deep any point of a closed body's surface lies behind an open surface, m.
    Penetration { body: String, sheet: String },
    /// Force of all contacts on a body upwards, relative to its weight, less 1; nothing to measure while any of it
    /// moves by a millimetre a second, when its inertia is part of that force.
    WeightError { body: String },
    /// Force of all contacts on a body, N.
    ContactForce { body: String },
    /// A quantity of a tool by its name, as the table of ticks has it: a vector's length, or one component.
    Quantity { tool: String, name: String },
    /// That of this name.
    Force { tool: String },
    /// That of this name.
    Depth { tool: String },
    /// That of this name.
    Energy { tool: String },
    /// Tools in contact.
    Touching {},
    /// What a simulated device gave to the loop at its own port, J; negative: energy was made.
    PortEnergy { tool: String },
    /// Mass of a deforming body, kg.
    Mass { body: String },
    /// Between two bodies' centres of mass, m.
    Distance { bodies: [String; 2] },
    /// A figure of a modeling step by name.
    Result(String),
    /// Places that a scan found stiffer.
    Peaks {},
    /// From a place to the nearest of them, m.
    PeakAway { place: [f64; 2] },
    /// Stiffness at the nearest of them, N/mm.
    PeakStiffness { place: [f64; 2] },
    /// Wall time of a tick, s: 0.5 or 0.99 of them are shorter. Not the same twice.
    TickTime(f64),
    /// Rms distance of a tool from where it was in an earlier run, m.
    Deviation { tool: String, from: String },
}

/// What a look needs of the start.
#[derive(Debug, Default)]
pub struct Start {
    body: usize,
    other: usize,
    tool: usize,
    number: Option<Number>,
    direction: Vector3,
    rest: Vec<Point3>,
    kept: Vec<usize>,
    angle: f64,
    volume_m3: f64,
    mass_kg: f64,
}

impl Look {
    /// Tool and name of a quantity, if that is what is looked at.
    fn quantity(&self) -> Option<(&String, &str)> {
        Some(match self {
            Self::Quantity { tool, name } => (tool, name),
            Self::Force { tool } => (tool, "force"),
            Self::Depth { tool } => (tool, "depth"),
            Self::Energy { tool } => (tool, "energy"),
            _ => return None,
        })
    }

    /// Finds names, and what is at the start.
    pub fn begin(&self, scene: &Scene) -> Result<Start, String> {
        let body = |id: &String| {
            (scene.body_index(id)).ok_or_else(|| format!("measure: the scene has no body {id:?}"))
        };
        let tool = |id: &String| {
            (scene.tool_index(id)).ok_or_else(|| format!("measure: the scene has no tool {id:?}"))
        };
        let mut start = Start::default();
        if let Some((id, name)) = self.quantity() {
            let unknown = || {
                let known: Vec<&str> = Number::names().collect();
                format!(
                    "measure: {name:?} is no quantity of a tool; there are {}",
                    known.join(", ")
                )
            };
            start.tool = tool(id)?;
            start.number = Some(Number::named(name).ok_or_else(unknown)?);
            return Ok(start);
        }
        match self {
            Self::Displacement {
                body: id,
                uv,
                along,
            } => {
                start.body = body(id)?;
                start.rest = vec![rest_surface(scene, start.body)?.point(uv[0], uv[1])];
                start.direction = Vector3::from(*along)
                    .try_normalize(0.0)
                    .ok_or_else(|| format!("measure: {along:?} is no direction"))?;
            }
            Self::GreatestDisplacement {
                body: id,
                away,
                from_m,
            } => {
                start.body = body(id)?;
                let points = grid(rest_surface(scene, start.body)?, [POINTS; 2]);
                start.rest = points.into_iter().map(|(_, _, point)| point).collect();
                let far = |point: &Point3| {
                    (away.iter()).all(|place| (point - Point3::from(*place)).norm() > *from_m)
                };
                let kept = (0..start.rest.len()).filter(|&k| far(&start.rest[k]));
                start.kept = kept.collect();
                if start.kept.is_empty() {
                    return Err("measure: no point of the surface is so far away".into());
                }
            }
            Self::EdgeAngle(spec) | Self::EdgeStraightness(spec) => {
                start.body = body(&spec.body)?;
                start.angle = spec.angle_rad(rest_surface(scene, start.body)?);
            }
            Self::Speed { body: id } | Self::ContactForce { body: id } => start.body = body(id)?,
            Self::Mass { body: id } | Self::WeightError { body: id } => {
                start.body = body(id)?;
                start.mass_kg = (scene.deformable(start.body))
                    .ok_or_else(|| format!("measure: {id:?} is rigid: it has no mass here"))?
                    .mass_kg();
            }
            Self::VolumeChange { body: id } => {
                start.body = body(id)?;
                start.volume_m3 = rest_surface(scene, start.body)?.volume();
            }
            Self::Spilled { body: a, rim: b }
            | Self::Penetration { body: a, sheet: b }
            | Self::Distance { bodies: [a, b] } => {
                (start.body, start.other) = (body(a)?, body(b)?);
                rest_surface(scene, start.body)?;
                rest_surface(scene, start.other)?;
            }
            Self::PortEnergy { tool: id } | Self::Deviation { tool: id, .. } => {
                start.tool = tool(id)?;
            }
            Self::Quantity { .. }
            | Self::Force { .. }
            | Self::Depth { .. }
            | Self::Energy { .. }
            | Self::Touching {}
            | Self::Result(_)
            | Self::Peaks {}
            | Self::PeakAway { .. }
            | Self::PeakStiffness { .. }
            | Self::TickTime(_) => {}
        }
        Ok(start)
    }

    /// The value now; `None` where there is nothing to look at.
    pub fn look(&self, view: &View<'_>, start: &Start) -> Option<f64> {
        let View {
            scene,
            state,
            scratch,
            record,
            ..
        } = view;
        let now = |body: usize| surface_now(scene, state, body);
        match self {
            Self::Displacement { uv, .. } => {
                let point = now(start.body)?.point(uv[0], uv[1]);
                Some((point - start.rest[0]).dot(&start.direction))
            }
            Self::GreatestDisplacement { .. } => {
                let points = grid(&now(start.body)?, [POINTS; 2]);
                let moved = |k: &usize| (points[*k].2 - start.rest[*k]).norm();
                Some(start.kept.iter().map(moved).fold(0.0, f64::max))
            }
            Self::EdgeAngle(spec) => Some(spec.angle_rad(&now(start.body)?) - start.angle),
            Self::EdgeStraightness(spec) => {
                Some(Line::through(&spec.points(&now(start.body)?, spec.to)).straightness_m)
            }
            Self::Speed { .. } => Some(state.speed_m_s(scene, start.body)),
            Self::VolumeChange { .. } => Some(now(start.body)?.volume() / start.volume_m3 - 1.0),
            Self::Spilled { .. } => {
                let (body, rim) = (now(start.body)?, now(start.other)?);
                let mesh = body.tessellated([CELLS; 2]).ok()?;
                let whole = Prism::everywhere().volume_m3(&mesh);
                Some(1.0 - Prism::over_rim(&rim).volume_m3(&mesh) / whole)
            }
            Self::Penetration { .. } => {
                Some(deepest_m(&now(start.body)?, &now(start.other)?, POINTS))
            }
            Self::WeightError { .. } => {
                if state.speed_m_s(scene, start.body) > AT_REST_M_S {
                    return None;
                }
                let gravity = Vector3::from(scene.spec.gravity.acceleration);
                let up = -scratch.contact_force_on(start.body).dot(&gravity) / gravity.norm();
                Some((up / (start.mass_kg * gravity.norm()) - 1.0).abs())
            }
            Self::ContactForce { .. } => Some(scratch.contact_force_on(start.body).norm()),
            Self::Quantity { .. }
            | Self::Force { .. }
            | Self::Depth { .. }
            | Self::Energy { .. } => Some(start.number?.of(&ToolTick::of(record, start.tool))),
            Self::Touching {} => {
                let touching = |t: &usize| record.output.tools[*t].contact_count > 0;
                Some((0..scene.tool_count()).filter(touching).count() as f64)
            }
            Self::PortEnergy { .. } => {
                let device = view.hands[start.tool].as_ref()?.device()?;
                Some(device.given_j())
            }
            Self::Mass { .. } => Some(start.mass_kg),
            Self::Distance { .. } => {
                Some((now(start.body)?.centroid()? - now(start.other)?.centroid()?).norm())
            }
            Self::Result(_)
            | Self::Peaks {}
            | Self::PeakAway { .. }
            | Self::PeakStiffness { .. }
            | Self::TickTime(_)
            | Self::Deviation { .. } => None,
        }
    }

    /// What is known only after the run: `None` for what is looked at while it goes on.
    pub fn after(&self, played: &Played) -> Option<Option<f64>> {
        let peaks = || played.map.as_ref().map(|map| map.peaks());
        let nearest = |place: &[f64; 2]| {
            let away = |at: [f64; 2]| libm::hypot(at[0] - place[0], at[1] - place[1]);
            let all = peaks()?.into_iter().map(|peak| (away(peak.place), peak));
            all.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        Some(match self {
            Self::Result(name) => played.values.get(name).copied(),
            Self::Peaks {} => peaks().map(|peaks| peaks.len() as f64),
            Self::PeakAway { place } => nearest(place).map(|(away, _)| away),
            Self::PeakStiffness { place } => nearest(place).map(|(_, peak)| peak.n_per_mm),
            Self::TickTime(share) => played.tick_us.map(|[median, late, most]| {
                1e-6 * match share {
                    s if *s <= 0.5 => median,
                    s if *s < 1.0 => late,
                    _ => most,
                }
            }),
            _ => return None,
        })
    }
}
