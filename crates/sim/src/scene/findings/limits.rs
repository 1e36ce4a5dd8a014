//! What the solvers do not hold: said with how far off it comes out, and what helps. Each figure is from a measurement
//! that its comment names.

use super::{FindingKind, Found, short};
use crate::body::Material;
use crate::scene::model::material_of;
use crate::scene::plan::slow_step;
use crate::scene::spec::ModelSpec;
use crate::scene::{BodyModel, Scene};
use crate::solve::rows::Holder;
use palpate_geometry::surface::Surface;
use std::f64::consts::PI;

/// Poisson's ratio up to which single precision holds the step: at 0.4999 a press at 200 mm/s is off by 10 % of its peak
/// where it is off by 0.4 % at 0.499.
const MOST_POISSON: f64 = 0.499;

/// Ticks that a contact should last. A free ball of 10 mm in the way of a tool with a coupling of 1000 N/m gets
/// 0.89, 0.81, 0.71, 0.55 and 0.46 of the force of the spring in 20, 11, 6.4, 3.5 and 2 ticks, near [`kept`]; a soft
/// ball that falls 50 mm comes back from 12, 7 and 4 ticks of contact by 55, 33 and 3 % of that.
const CONTACT_TICKS: f64 = 10.0;

/// Speed at which the contact of a body is judged, m/s: it falls 50 mm.
const MEETING_M_S: f64 = 1.0;

/// Times by which a free body may be heavier than one below it. Of two rings of one size the upper sinks into the
/// lower from 20 times its mass on, and at 100 times throws it off.
const MOST_MASSES: f64 = 10.0;

pub(super) fn look(scene: &Scene, found: &mut Found) {
    nearly_incompressible(scene, found);
    short_contacts(scene, found);
    unequal_masses(scene, found);
    slow_steps(scene, found);
    stiff_couplings(scene, found);
    loaded_surfaces(scene, found);
}

/// What was set right in surfaces as they were read, and where they are open by little.
fn loaded_surfaces(scene: &Scene, found: &mut Found) {
    for (path, note) in &scene.notes {
        found.limit(path.clone(), note.clone());
    }
    for (b, body) in scene.bodies.iter().enumerate() {
        for slit in body.skin.surface().into_iter().flat_map(Surface::slits) {
            found.limit(
                format!("body[{b}].surface"),
                format!(
                    "body {}: {slit}, and opens further where the body is pulled: make its control points equal, unless a \
                     slit is meant",
                    body.id
                ),
            );
        }
    }
}

fn nearly_incompressible(scene: &Scene, found: &mut Found) {
    for (b, body) in scene.spec.bodies.iter().enumerate() {
        if !matches!(body.model(), ModelSpec::Continuum | ModelSpec::Net) {
            continue;
        }
        let own =
            material_of(&body.material).map(|material| ("material".to_owned(), material.poisson));
        let regions = body.regions.iter().enumerate();
        let regions =
            regions.filter_map(|(r, region)| Some((format!("region[{r}]"), region.poisson?)));
        for (key, poisson) in own.into_iter().chain(regions) {
            if poisson > MOST_POISSON {
                found.add(
                    FindingKind::Wrong,
                    format!("body[{b}].{key}.poisson"),
                    format!(
                        "body {}: poisson is {poisson}; it must be 0 to {MOST_POISSON}: nearer to 0.5 a body that is pressed fast \
                         meets forces that are off by 10 % and more",
                        body.id
                    ),
                );
            }
        }
    }
}

/// Modulus of a contact with a rigid thing, Pa, and radius of a ball of the same volume, m.
fn firmness(material: &Material, mass_kg: f64) -> (f64, f64) {
    let modulus = material.young_pa / (1.0 - material.poisson * material.poisson);
    let radius_m = libm::cbrt(0.75 * mass_kg / (PI * material.density_kg_m3));
    (modulus, radius_m)
}

/// Of the peak force of a spring in a contact of so many ticks, what backward Euler keeps.
fn kept(ticks: f64) -> f64 {
    libm::exp(-PI * PI / (4.0 * ticks))
}

/// Contacts that are over in a few ticks.
fn short_contacts(scene: &Scene, found: &mut Found) {
    let rate_for = |ticks: f64| short((CONTACT_TICKS / ticks / scene.dt_s / 100.0).ceil() * 100.0);
    for (b, (body, spec)) in scene.bodies.iter().zip(&scene.spec.bodies).enumerate() {
        let (Some(mass_kg), Some(material)) = (scene.free_mass_kg(b), material_of(&spec.material))
        else {
            continue;
        };
        let deforms = matches!(body.model, BodyModel::Deforming(_));
        let (modulus, radius_m) = firmness(&material, mass_kg);
        let mut pairs = scene.pairs.iter();
        let meets = pairs.any(|pair| match pair.holder {
            Holder::Body(other) => (other as usize == b) != (pair.body == b),
            Holder::Tool(_) => false,
        });
        if deforms && meets {
            // Hertz: 2.87 (m² / (R E*² v))^(1/5).
            let time_s = 2.87
                * libm::pow(
                    mass_kg * mass_kg / (radius_m * modulus * modulus * MEETING_M_S),
                    0.2,
                );
            let ticks = time_s / scene.dt_s;
            if ticks < CONTACT_TICKS {
                found.limit(
                    format!("body[{b}].material"),
                    format!(
                        "body {} ({} Pa, {} kg) meets others for {} ticks at {MEETING_M_S} m/s: it does not bounce as its material \
                         does, and may be thrown off what it lies on; rate_hz = {} would give it ten, as would a softer or heavier \
                         material, or model = \"rigid\" with free = true",
                        body.id,
                        short(material.young_pa),
                        short(mass_kg),
                        short(ticks),
                        rate_for(ticks)
                    ),
                );
            }
        }
        let tools = scene
            .pairs
            .iter()
            .filter(|pair| pair.body == b)
            .filter_map(|pair| pair.tool());
        let stiffest = tools.map(|t| {
            let tool = &scene.tools[t];
            let ball_m = tool
                .shape
                .ball_radius_m()
                .filter(|radius| *radius > 0.0)
                .unwrap_or(radius_m);
            // Of Hertz' contact at a tenth of the radius.
            let own = 2.0 * modulus * 0.1_f64.sqrt() * ball_m.min(radius_m);
            let compliance = tool.coupling.compliance_m_n() + if deforms { 1.0 / own } else { 0.0 };
            (1.0 / compliance, t)
        });
        let stiffest = stiffest.max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((stiffness, t)) = stiffest {
            let ticks = PI * (mass_kg / stiffness).sqrt() / scene.dt_s;
            if ticks < CONTACT_TICKS {
                found.limit(
                    format!("tool[{t}].coupling.stiffness_n_m"),
                    format!(
                        "tool {} taps body {} ({} kg) for {} ticks at {} N/m: the force comes out some {:.0} % too low; rate_hz = {}, \
                         a softer coupling or a heavier body would give it ten",
                        scene.tools[t].id,
                        body.id,
                        short(mass_kg),
                        short(ticks),
                        short(stiffness),
                        100.0 * (1.0 - kept(ticks)),
                        rate_for(ticks)
                    ),
                );
            }
        }
    }
}

/// Free bodies of very different masses that may lie on each other.
fn unequal_masses(scene: &Scene, found: &mut Found) {
    for pair in &scene.pairs {
        let Holder::Body(other) = pair.holder else {
            continue;
        };
        let mut two = [other as usize, pair.body];
        let masses = two.map(|body| scene.free_mass_kg(body));
        let [Some(a), Some(b)] = masses else { continue };
        if b > a {
            two.reverse();
        }
        let ratio = a.max(b) / a.min(b);
        if two[0] != two[1] && ratio > MOST_MASSES {
            let [heavy, light] = two.map(|body| &scene.bodies[body].id);
            found.limit(
                format!("body[{}].material.density_kg_m3", two[0]),
                format!(
                    "body {heavy} is {} times as heavy as {light}: lying on it, it slowly sinks into it or throws it off; keep \
                     bodies that carry each other within {MOST_MASSES} times, or hold one of them",
                    short(ratio)
                ),
            );
        }
    }
}

/// Steps that take longer than the ticks they have.
fn slow_steps(scene: &Scene, found: &mut Found) {
    for (b, body) in scene.bodies.iter().enumerate() {
        let slow = body
            .deforming()
            .and_then(|body| slow_step(body, scene.dt_s));
        if let Some(slow) = slow {
            found.limit(
                format!("body[{b}].integrator"),
                format!("body {}: {slow}", body.id),
            );
        }
    }
}

/// Couplings stiffer than their devices render.
fn stiff_couplings(scene: &Scene, found: &mut Found) {
    for (t, tool) in scene.tools.iter().enumerate() {
        let stiffness = tool.coupling.stiffness_n_m();
        let passive = scene
            .stiffness_limits_of(tool)
            .map(|limits| limits.passive_n_m());
        if let Some(passive) =
            passive.filter(|passive| stiffness.is_finite() && stiffness > *passive)
        {
            found.limit(
                format!("tool[{t}].coupling.stiffness_n_m"),
                format!(
                    "tool {}: a coupling of {stiffness} N/m exceeds what its device renders passively in any hand ({passive:.0} \
                     N/m); `bounded = true` in its coupling reduces it to that",
                    tool.id
                ),
            );
        }
    }
}
