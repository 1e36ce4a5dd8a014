//! The values of a `[[body]]`: material, regions, lattice, integrator, and what holds it. They are
//! checked for every body, whether its model uses them or not.

use crate::body::{Deformable, MOST_NODES_A_SIDE, Material, PRESETS, Plastic, Stiffening, preset};
use crate::scene::door::{At, nearest};
use crate::scene::free::{LAUNCH, launch_of};
use crate::scene::spec::{
    BodySpec, FixedSpec, IntegratorSpec, IterationsSpec, LatticeSpec, MaterialSpec, PlasticSpec,
    RefineSpec, RegionSpec, StiffeningSpec,
};
use palpate_geometry::math::{Point3, Vector3};

/// Values that the spec does not give as they are used.
pub(super) struct Values {
    /// Of all cells that no region holds.
    pub material: Material,
    /// What never moves.
    pub held: Vec<Held>,
}

/// A part of a body that never moves.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) enum Held {
    /// Coordinates behind a plane, in the body's frame.
    Behind {
        /// A point of the plane, m.
        point: Point3,
        /// Unit normal, towards the free part.
        normal: Vector3,
    },
    /// Control points whose Greville abscissae lie in both ranges.
    Range {
        /// From and to.
        u: [f64; 2],
        /// From and to.
        v: [f64; 2],
    },
}

/// Checks the values of a body; `at` is its table.
pub(super) fn check(spec: &BodySpec, at: &At<'_>) -> Option<Values> {
    let before = at.problem_count();
    let material = material(&spec.material, &at.key("material"));
    for (r, region) in spec.regions.iter().enumerate() {
        check_region(region, &at.key("region").entry(r));
    }
    check_lattice(&spec.lattice, spec.layers(), &at.key("lattice"));
    check_integrator(&spec.integrator, &at.key("integrator"));
    let held: Vec<Option<Held>> = spec
        .fixed
        .iter()
        .enumerate()
        .map(|(f, fixed)| held(fixed, &at.key("fixed").entry(f)))
        .collect();
    if at.problem_count() > before {
        return None;
    }
    Some(Values {
        material: material?,
        held: held.into_iter().collect::<Option<_>>()?,
    })
}

fn held(spec: &FixedSpec, at: &At<'_>) -> Option<Held> {
    match *spec {
        FixedSpec::Plane { point, normal } => {
            let finite = at.finite("point", &point);
            let normal = at.direction("normal", &normal)?;
            finite?;
            Some(Held::Behind {
                point: Point3::from(point),
                normal,
            })
        }
        FixedSpec::Range { u, v } => {
            let wrong = |[from, to]: [f64; 2]| from.is_nan() || to.is_nan() || from > to;
            if wrong(u) || wrong(v) {
                return at.refused(format!(
                    "u = {u:?}, v = {v:?} is not a range; give [from, to] with from <= to"
                ));
            }
            Some(Held::Range { u, v })
        }
    }
}

/// Gives a body the velocities that it starts with.
pub(super) fn launch(spec: &BodySpec, body: &mut Deformable, at: &At<'_>) -> Option<()> {
    let launch = launch_of(spec, at)?;
    if launch == [Vector3::zeros(); 2] {
        return Some(());
    }
    let first = usize::from(launch[0] == Vector3::zeros());
    at.key(LAUNCH[first].0)
        .take(body.launch(launch[0], launch[1]))
}

/// Most layers of a body.
const MOST_LAYERS: usize = 64;
/// Most nodes in layers: 27,000 take 31 ms a tick.
pub(super) const MOST_POINTS: usize = 64_000;

fn check_lattice(spec: &LatticeSpec, layers: usize, at: &At<'_>) {
    at.count("layers", layers, MOST_LAYERS);
    if let RefineSpec::Counts([u, v]) = spec.refine {
        let most = MOST_POINTS / layers.clamp(1, MOST_LAYERS);
        if u.saturating_mul(v) > most {
            at.key("refine").refuse(format!(
                "{u} x {v} points in {layers} layers are more than {MOST_POINTS} nodes, which no tick can move; \
                 give at most {most} points, or fewer layers"
            ));
        }
    }
    if let Some(thickness) = spec.thickness_m {
        at.above_zero("thickness_m", thickness, "m");
    }
    if spec
        .nodes
        .iter()
        .any(|n| !(2..=MOST_NODES_A_SIDE).contains(n))
    {
        at.key("nodes").refuse(format!(
            "nodes is {:?}; each must be 2 to {MOST_NODES_A_SIDE}",
            spec.nodes
        ));
    }
    at.count("cycles", spec.cycles, 10_000);
    at.count("cells_per_span", spec.cells_per_span, 8);
    if let Some(layers) = spec.cell_layers {
        at.count("cell_layers", layers, 64);
    }
}

fn check_integrator(spec: &IntegratorSpec, at: &At<'_>) {
    let iterations = match spec.iterations {
        IterationsSpec::Count(count) => {
            at.count("iterations", count, 100);
            count
        }
        IterationsSpec::Auto(_) => 1,
    };
    at.count("substeps", spec.substeps, 1_000);
    at.count("contact_sweeps", spec.contact_sweeps, 1_000);
    at.count("every", spec.every as usize, 100);
    if iterations > 1 && spec.every > 1 {
        at.key("iterations").refuse(format!(
            "iterations is {} and every is {}: contact is settled between the iterations of one tick; give one of them 1",
            iterations, spec.every
        ));
    }
    at.not_below_zero("sleep_m_s", spec.sleep_m_s, "m/s");
}

/// The material of a body: its preset, and what differs.
fn material(spec: &MaterialSpec, at: &At<'_>) -> Option<Material> {
    check_moduli(spec.young_pa, spec.poisson, spec.density_kg_m3, at);
    if let Some(damping_s) = spec.damping_s {
        at.not_below_zero("damping_s", damping_s, "s");
    }
    let plastic = spec
        .plastic
        .as_ref()
        .map(|p| plastic(p, &at.key("plastic")));
    let stiffening = spec
        .stiffening
        .as_ref()
        .map(|s| stiffening(s, &at.key("stiffening")));
    let Some(material) = material_of(spec) else {
        let name = spec.preset.as_deref().unwrap_or_default();
        let known: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
        let near = nearest(name, known.iter().copied());
        return at.key("preset").refused(format!(
            "{name:?} is not a material; did you mean {near:?}? (known: {})",
            known.join(", ")
        ));
    };
    Some(Material {
        plastic: plastic.or(material.plastic).filter(|p| p.rate_per_s > 0.0),
        stiffening: stiffening.or(material.stiffening),
        ..material
    })
}

/// The elastic values of a material, and what else its preset has; `None` if there is no such preset.
pub(in crate::scene) fn material_of(spec: &MaterialSpec) -> Option<Material> {
    let of_preset = preset(spec.preset.as_deref().unwrap_or("gel"))?.material;
    Some(Material {
        young_pa: spec.young_pa.unwrap_or(of_preset.young_pa),
        poisson: spec.poisson.unwrap_or(of_preset.poisson),
        density_kg_m3: spec.density_kg_m3.unwrap_or(of_preset.density_kg_m3),
        damping_s: spec.damping_s.unwrap_or(of_preset.damping_s),
        ..of_preset
    })
}

fn plastic(spec: &PlasticSpec, at: &At<'_>) -> Plastic {
    at.not_below_zero("yield_strain", spec.yield_strain, "");
    at.not_below_zero("rate_per_s", spec.rate_per_s, "1/s");
    at.not_below_zero("hardening", spec.hardening, "");
    at.not_below_zero("spread_m", spec.spread_m, "m");
    if !(spec.limit > 0.0 && spec.limit < 1.0) {
        at.key("limit").refuse(format!(
            "limit is {}; it must be above 0 and below 1",
            spec.limit
        ));
    }
    Plastic {
        yield_strain: spec.yield_strain,
        rate_per_s: spec.rate_per_s,
        hardening: spec.hardening,
        limit: spec.limit,
        spread_m: spec.spread_m,
    }
}

fn stiffening(spec: &StiffeningSpec, at: &At<'_>) -> Stiffening {
    for (key, ratio) in [
        ("ratio", spec.ratio),
        ("least_length_ratio", spec.least_length_ratio),
    ] {
        if !(1.0..=1_000.0).contains(&ratio) {
            at.key(key)
                .refuse(format!("{key} is {ratio}; it must be 1 to 1000"));
        }
    }
    if spec.strain.is_nan() || spec.strain < 0.0 {
        at.key("strain")
            .refuse(format!("strain is {}; it must be at least 0", spec.strain));
    }
    if !(0.0..1.0).contains(&spec.least_length) {
        at.key("least_length").refuse(format!(
            "least_length is {}; it must be at least 0 and below 1",
            spec.least_length
        ));
    }
    Stiffening {
        strain: spec.strain,
        ratio: spec.ratio,
        least_length: spec.least_length,
        least_length_ratio: spec.least_length_ratio,
    }
}

fn check_moduli(
    young_pa: Option<f64>,
    poisson: Option<f64>,
    density_kg_m3: Option<f64>,
    at: &At<'_>,
) {
    if let Some(young_pa) = young_pa {
        at.above_zero("young_pa", young_pa, "Pa");
    }
    if let Some(density) = density_kg_m3 {
        at.above_zero("density_kg_m3", density, "kg/m³");
    }
    if let Some(poisson) = poisson
        && !(0.0..0.5).contains(&poisson)
    {
        at.key("poisson").refuse(format!(
            "poisson is {poisson}; it must be at least 0 and below 0.5"
        ));
    }
}

fn check_region(spec: &RegionSpec, at: &At<'_>) {
    check_moduli(spec.young_pa, spec.poisson, spec.density_kg_m3, at);
    if spec.ball.is_some() == spec.box_.is_some() {
        at.refuse("a region needs exactly one of ball, box");
    }
    if let Some(ball) = &spec.ball {
        let at = at.key("ball");
        at.finite("centre", &ball.centre);
        at.above_zero("radius_m", ball.radius_m, "m");
    }
    if let Some(bounds) = &spec.box_
        && (0..3).any(|c| {
            bounds.low[c]
                .partial_cmp(&bounds.high[c])
                .is_none_or(|order| order.is_ge())
        })
    {
        at.key("box").key("low").refuse(format!(
            "low = {:?} must be below high = {:?} in x, y and z",
            bounds.low, bounds.high
        ));
    }
}
