//! Values of a scene against what they are in use. A value outside is asked about, with the unit that would bring it
//! inside.

use super::{Found, short};
use crate::scene::Scene;
use crate::scene::spec::{FrictionSpec, RefineSpec, SceneSpec};
use palpate_geometry::contact::ToolShape;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::skin::SkinSolver;

/// What a quantity is in use.
struct Usual {
    /// As people call it.
    name: &'static str,
    unit: &'static str,
    /// Least and most.
    range: [f64; 2],
    /// Units that it may have been given in by mistake, and how many of ours one is.
    slips: &'static [(&'static str, f64)],
}

const fn usual(
    name: &'static str,
    unit: &'static str,
    range: [f64; 2],
    slips: &'static [(&'static str, f64)],
) -> Usual {
    Usual {
        name,
        unit,
        range,
        slips,
    }
}

/// From brain and the softest gels to diamond.
const YOUNG: Usual = usual(
    "Young's modulus",
    "Pa",
    [50.0, 1.3e12],
    &[("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9)],
);
/// From foam to osmium.
const DENSITY: Usual = usual("density", "kg/m³", [20.0, 25_000.0], &[("g/cm³", 1e3)]);
/// Gels and tissue have some milliseconds.
const DAMPING: Usual = usual(
    "damping time",
    "s",
    [0.0, 0.5],
    &[("ms", 1e-3), ("µs", 1e-6)],
);
const STRAIN: Usual = usual("strain", "", [0.0, 0.5], &[("%", 1e-2)]);
/// Rubber on rubber reaches 1 to 2.
const FRICTION: Usual = usual("coefficient of friction", "", [0.0, 2.0], &[("%", 1e-2)]);
/// Jupiter's is 25.
const GRAVITY: Usual = usual("gravity", "m/s²", [0.0, 30.0], &[("mm/s²", 1e-3)]);
const STIFFNESS: Usual = usual("coupling's stiffness", "N/m", [5.0, 1e7], &[("N/mm", 1e3)]);
const GRIP: Usual = usual("grip", "N", [0.0, 500.0], &[("mN", 1e-3)]);
const TIME: Usual = usual("time", "s", [0.0, 5.0], &[("ms", 1e-3), ("µs", 1e-6)]);
const STALE: Usual = usual("time", "s", [1e-3, 5.0], &[("ms", 1e-3), ("µs", 1e-6)]);
const ENCODER: Usual = usual(
    "encoder's step",
    "m",
    [0.0, 2e-3],
    &[("mm", 1e-3), ("µm", 1e-6)],
);
const SPEED: Usual = usual("speed", "m/s", [0.0, 30.0], &[("mm/s", 1e-3)]);
/// Hands feel single ticks below.
const RATE: Usual = usual("rate", "Hz", [200.0, 10_000.0], &[("kHz", 1e3)]);
/// What a hand presses: from a lens to a torso. Their files are in millimetres, most often.
const SIZE: Usual = usual("size", "m", [5e-4, 5.0], &[("mm", 1e-3), ("km", 1e3)]);
const MASS: Usual = usual("mass", "kg", [0.0, 2_000.0], &[]);

/// Nor is a tool this many times longer than the largest body, or starts farther away from all of them.
const MOST_RATIO: f64 = 20.0;
/// Tools that start within this distance, m, of a body, however small that is, are beside it.
const BESIDE_M: f64 = 2.0;
/// A focus this far from the surface, relative to the body's size, is elsewhere.
const FOCUS: f64 = 0.25;

impl Usual {
    /// What to ask about a value, if anything.
    fn ask(&self, value: f64) -> Option<String> {
        let [least, most] = self.range;
        if (least..=most).contains(&value) {
            return None;
        }
        let Self { name, unit, .. } = self;
        let value_in =
            |value: f64, unit: &str| format!("{} {unit}", short(value)).trim().to_owned();
        let meant: Vec<String> = (self.slips.iter())
            .filter(|(_, factor)| (least..=most).contains(&(value * factor)))
            .map(|(slip, factor)| {
                let (ours, theirs) = (value_in(value * factor, unit), value_in(value, slip));
                format!("{ours} ({theirs})")
            })
            .collect();
        let meant = match meant.as_slice() {
            [] => String::new(),
            meant => format!("; did you mean {}?", meant.join(", or ")),
        };
        let usual = match least == 0.0 {
            true => format!("at most {}", value_in(most, unit)),
            false => format!("{} to {}", short(least), value_in(most, unit)),
        };
        Some(format!(
            "a {name} of {} is unusual (in use: {usual}){meant}",
            value_in(value, unit)
        ))
    }
}

pub(super) fn look(scene: &Scene, found: &mut Found) {
    let mut see = |usual: &Usual, path: String, value: f64| {
        if let Some(what) = usual.ask(value) {
            found.unusual(path, what);
        }
    };
    values(&scene.spec, &mut see);
    sizes(scene, found);
    focuses(scene, found);
}

/// Shows every value that has a row in the table.
fn values(spec: &SceneSpec, see: &mut dyn FnMut(&Usual, String, f64)) {
    see(&RATE, "loop.rate_hz".into(), f64::from(spec.loop_.rate_hz));
    let gravity = Vector3::from(spec.gravity.acceleration).norm();
    see(&GRAVITY, "gravity.acceleration".into(), gravity);
    see(
        &TIME,
        "gravity.smoothing_s".into(),
        spec.gravity.smoothing_s,
    );
    for (b, body) in spec.bodies.iter().enumerate() {
        let at = |key: &str| format!("body[{b}].{key}");
        let matter = &body.material;
        let mut given = |usual: &Usual, key: &str, value: Option<f64>| {
            if let Some(value) = value {
                see(usual, at(key), value);
            }
        };
        given(&YOUNG, "material.young_pa", matter.young_pa);
        given(&DENSITY, "material.density_kg_m3", matter.density_kg_m3);
        given(&DAMPING, "material.damping_s", matter.damping_s);
        let yields = matter.plastic.as_ref().map(|plastic| plastic.yield_strain);
        given(&STRAIN, "material.plastic.yield_strain", yields);
        for (r, region) in body.regions.iter().enumerate() {
            given(&YOUNG, &format!("region[{r}].young_pa"), region.young_pa);
            given(
                &DENSITY,
                &format!("region[{r}].density_kg_m3"),
                region.density_kg_m3,
            );
        }
        let speed = Vector3::from(body.velocity_m_s).norm();
        given(&SPEED, "velocity_m_s", Some(speed));
    }
    let mut friction = |at: String, friction: Option<&FrictionSpec>| {
        if let Some(friction) = friction {
            see(&FRICTION, at, friction.mu);
        }
    };
    for (t, tool) in spec.tools.iter().enumerate() {
        friction(format!("tool[{t}].friction.mu"), tool.friction.as_ref());
    }
    for (c, contact) in spec.contacts.iter().enumerate() {
        friction(
            format!("contact[{c}].friction.mu"),
            contact.friction.as_ref(),
        );
    }
    for (t, tool) in spec.tools.iter().enumerate() {
        let mut given = |usual, key: &str, value| see(usual, format!("tool[{t}].{key}"), value);
        let stiffness = tool.coupling.stiffness_n_m;
        if stiffness.is_finite() {
            given(&STIFFNESS, "coupling.stiffness_n_m", stiffness);
        }
        given(&GRIP, "grip.force_max_n", tool.grip.force_max_n);
        given(&TIME, "device.ramp_s", tool.device.ramp_s);
        given(&STALE, "device.stale_s", tool.device.stale_s);
        given(&TIME, "device.delay_s", tool.device.delay_s);
        given(&ENCODER, "device.encoder_m", tool.device.encoder_m);
    }
}

/// Diagonal of the points' box, m.
fn size_of(points: &[Point3]) -> f64 {
    let Some(first) = points.first() else {
        return 0.0;
    };
    let grown = |(low, high): (Point3, Point3), p: &Point3| (low.inf(p), high.sup(p));
    let (low, high) = points.iter().fold((*first, *first), grown);
    (high - low).norm()
}

/// Bodies and tools as large as no one means.
fn sizes(scene: &Scene, found: &mut Found) {
    let mut largest_m = 0.0_f64;
    for (b, body) in scene.bodies.iter().enumerate() {
        largest_m = largest_m.max(body.size_m);
        let surface = format!("body[{b}].surface");
        if let Some(what) = SIZE.ask(body.size_m) {
            found.unusual(
                surface,
                format!(
                    "body {}: {what} (is its file in millimetres? \"unit\": \"mm\" in a JSON file, unit = \"mm\" or --unit mm for meshes)",
                    body.id
                ),
            );
        } else if let Some(what) = scene.mass(b).and_then(|(mass_kg, _)| MASS.ask(mass_kg)) {
            found.unusual(surface, format!("body {}: {what}", body.id));
        }
    }
    for (t, tool) in scene.tools.iter().enumerate() {
        // Planes and bars without end are drawn as large as is asked.
        if matches!(scene.shape_name(t), "plane" | "point" | "implicit") {
            continue;
        }
        let size_m = size_of(&scene.tool_outline(t, largest_m).points);
        if size_m > SIZE.range[1] || (largest_m > 0.0 && size_m > MOST_RATIO * largest_m) {
            found.unusual(
                format!("tool[{t}].shape"),
                format!(
                    "tool {}: it is {} m long, the largest body {} m; is its file in millimetres? (unit = \"mm\" in its shape)",
                    tool.id,
                    short(size_m),
                    short(largest_m)
                ),
            );
        }
    }
    for t in 0..scene.tools.len() {
        far(scene, t, largest_m, found);
    }
}

/// A tool far away from every body.
fn far(scene: &Scene, t: usize, largest_m: f64, found: &mut Found) {
    let tool = &scene.tools[t];
    let carries = scene
        .spec
        .bodies
        .iter()
        .any(|body| body.carried_by.as_ref() == Some(&tool.id));
    let touches = scene.pairs.iter().any(|pair| pair.tool() == Some(t));
    if carries || !touches || matches!(tool.shape, ToolShape::Plane { .. }) {
        return;
    }
    let away = scene.bodies.iter().map(|body| {
        let points = body.skin.points();
        let away = points.iter().map(|p| (p - tool.start.0).norm());
        away.fold(f64::INFINITY, f64::min)
    });
    let away_m = away.fold(f64::INFINITY, f64::min);
    if away_m > BESIDE_M.max(MOST_RATIO * largest_m) {
        found.unusual(
            format!("tool[{t}].pose"),
            format!(
                "tool {} starts {} m away from every body; is its position in millimetres?",
                tool.id,
                short(away_m)
            ),
        );
    }
}

/// Points of refinement that are on no surface.
fn focuses(scene: &Scene, found: &mut Found) {
    for (b, (body, spec)) in scene.bodies.iter().zip(&scene.spec.bodies).enumerate() {
        let RefineSpec::Focus { focus } = &spec.lattice.refine else {
            continue;
        };
        let placed = scene.placement(b);
        let mut solver = SkinSolver::new(&body.skin);
        for (k, point) in focus.iter().enumerate() {
            let foot = solver.closest(&body.skin, &(placed * Point3::from(*point)));
            if foot.distance > FOCUS * body.size_m {
                found.unusual(
                    format!("body[{b}].lattice.refine.focus[{k}]"),
                    format!(
                        "a focus {} m from the surface of body {} refines whatever is nearest; give points on it, in m, in \
                         the body's frame",
                        short(foot.distance),
                        body.id
                    ),
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_out_of_use_is_asked_about_with_the_units_that_fit() {
        let asked = |usual: &Usual, value: f64| usual.ask(value).unwrap_or_default();
        assert_eq!(
            asked(&DENSITY, 1.05),
            "a density of 1.05 kg/m³ is unusual (in use: 20 to 25000 kg/m³); did you mean 1050 kg/m³ (1.05 g/cm³)?"
        );
        assert_eq!(
            asked(&YOUNG, 20.0),
            "a Young's modulus of 20 Pa is unusual (in use: 50 to 1.3e12 Pa); did you mean 20000 Pa (20 kPa), or 2e7 Pa (20 \
             MPa), or 2e10 Pa (20 GPa)?"
        );
        assert!(asked(&GRAVITY, 9810.0).contains("did you mean 9.81 m/s² (9810 mm/s²)?"));
        assert!(asked(&TIME, 50.0).contains("did you mean 0.05 s (50 ms)"));
        assert!(asked(&SIZE, 50.0).contains("did you mean 0.05 m (50 mm)"));
        assert!(asked(&STRAIN, 2.0).contains("0.02 (2 %)"));
        assert!(asked(&STIFFNESS, 1.0).contains("1000 N/m (1 N/mm)"));
        assert!(asked(&ENCODER, 0.02).contains("2e-5 m (0.02 mm)"));
        // Nothing that would bring it inside.
        assert_eq!(
            asked(&MASS, 1e7),
            "a mass of 1e7 kg is unusual (in use: at most 2000 kg)"
        );
    }

    #[test]
    fn what_is_in_use_is_not_asked_about() {
        for (usual, values) in [
            (&YOUNG, [50.0, 20e3, 210e9]),
            (&DENSITY, [30.0, 1_000.0, 19_300.0]),
            (&DAMPING, [0.0, 2e-3, 0.3]),
            (&FRICTION, [0.0, 0.4, 1.5]),
            (&GRAVITY, [0.0, 1.62, 9.81]),
            (&STIFFNESS, [10.0, 1_000.0, 1e5]),
            (&RATE, [500.0, 1_000.0, 4_000.0]),
            (&SIZE, [1e-3, 0.1, 1.8]),
        ] {
            for value in values {
                assert_eq!(usual.ask(value), None);
            }
        }
    }
}
