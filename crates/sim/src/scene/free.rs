//! Rigid bodies that contact and gravity move.

use super::door::At;
use super::mass::Mass;
use super::mover::{MovedBy, Mover};
use super::spec::{BodySpec, SceneSpec};
use palpate_geometry::math::{Pose, Vector3};
use palpate_geometry::skin::Skin;

/// Fastest that a body starts, m/s, and turns, rad/s: beyond, it crosses itself in a tick.
const MOST_LAUNCH: [f64; 2] = [100.0, 1_000.0];
/// Their keys and units.
pub(super) const LAUNCH: [(&str, &str); 2] = [("velocity_m_s", "m/s"), ("spin_rad_s", "rad/s")];

/// What a free rigid body is and how it starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Free {
    /// How its matter is spread.
    pub mass: Mass,
    /// Of the centre of mass at the start, m/s.
    pub velocity_m_s: Vector3,
    /// At the start, rad/s; in the world.
    pub spin_rad_s: Vector3,
    /// The scene's `sleep_m_s`: how slow it is at rest, m/s; 0: never.
    pub sleep_m_s: f64,
}

/// Reads `free = true` of a body, placed in the world. Its frame becomes that of its
/// principal axes.
pub(super) fn build(
    scene: &SceneSpec,
    spec: &BodySpec,
    skin: &Skin,
    density_kg_m3: f64,
    at: &At<'_>,
) -> Option<Mover> {
    let before = at.problem_count();
    let key = at.key("free");
    if spec.model().model().deforms() {
        key.refuse(format!(
            "a body with model = {:?} is moved by contact and gravity already; drop free, or use model = \"rigid\"",
            spec.model().name()
        ));
    }
    for (other, given) in [
        ("motion", spec.motion.is_some()),
        ("carried_by", spec.carried_by.is_some()),
    ] {
        if given {
            at.key(other).refuse(format!(
                "a free body goes where forces take it, so it has no {other}; drop {other} or free"
            ));
        }
    }
    if !spec.fixed.is_empty() {
        at.key("fixed")
            .refuse("nothing holds a free rigid body; drop fixed or free");
    }
    if !spec.regions.is_empty() {
        at.key("region").refuse(
            "a free rigid body has one density, material.density_kg_m3; drop its regions or free",
        );
    }
    if scene.gravity.frame.is_some() {
        key.refuse(
            "a free rigid body moves in the world, not in a frame that a tool carries; drop gravity.frame, or use a deforming model",
        );
    }
    let launch = launch_of(spec, at);
    if !skin.is_closed() {
        return key.refused(
            "a free body needs a closed surface, which has a volume and so a mass; this one is open: close it or drop free",
        );
    }
    let mass = match skin {
        Skin::Surface(surface) => Mass::inside(surface, density_kg_m3),
        Skin::Part(placed) => Mass::inside_part(placed, skin.points(), density_kg_m3),
    };
    let Some(mass) = mass else {
        return key.refused(
            "the surface of a free body must enclose a volume; this one encloses none: give it thickness or drop free",
        );
    };
    let [velocity_m_s, spin_rad_s] = launch?;
    if at.problem_count() > before {
        return None;
    }
    Some(Mover {
        placement: Pose::from_parts(mass.centre.coords.into(), mass.axes),
        by: MovedBy::Forces(Box::new(Free {
            mass,
            velocity_m_s,
            spin_rad_s,
            sleep_m_s: spec.integrator.sleep_m_s,
        })),
    })
}

/// The velocities that a body starts with: m/s, and rad/s.
pub(super) fn launch_of(spec: &BodySpec, at: &At<'_>) -> Option<[Vector3; 2]> {
    let launch = [spec.velocity_m_s, spec.spin_rad_s].map(Vector3::from);
    for (k, value) in launch.iter().enumerate() {
        if value.norm().is_nan() || value.norm() > MOST_LAUNCH[k] {
            let (name, unit) = LAUNCH[k];
            let most = MOST_LAUNCH[k];
            return at.key(name).refused(format!(
                "{name} is {:?}; it must be no longer than {most} {unit}",
                [value.x, value.y, value.z]
            ));
        }
    }
    Some(launch)
}
