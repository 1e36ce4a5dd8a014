//! A gel ball under a large ball, and a block between two plates: squeezed, held, let go.
//!
//! The gel ball is held by its underside. The plates grip the block: scenes have no grips of faces, so
//! both faces are fixed, and one of them is put elsewhere from tick to tick. It goes back before the
//! block is left alone, because it cannot let go.

use super::beam::{FAR_TOOL, surface};
use super::held::{HOLD, Held, REST, gently};
use super::{Effort, Row, Setting, World, failed};
use palpate_geometry::math::{Point3, Vector3};

/// For how long a body is squeezed, in ticks, and a plate goes back.
const PRESS: usize = 1_000;
const BACK: usize = 100;
/// Poisson's ratios, and damping times, ms.
const POISSON: [f64; 4] = [0.3, 0.45, 0.49, 0.499];
const DAMPING_MS: [u32; 4] = [0, 2, 5, 20];
/// Radius of the gel ball and of what presses it, m.
const GEL_M: f64 = 0.04;
const LARGE_M: f64 = 0.2;
/// Below this share of its radius under the middle the gel ball is held: by less it rolls away.
const HELD: f64 = 0.5;
/// Side of the block, m, and its cells along one.
const SIDE_M: f64 = 0.04;
const CELLS: usize = 4;

/// What is done to a body.
#[derive(Clone, Copy)]
enum Way {
    /// The gel ball is pressed to this share of its height.
    Ball(f64),
    /// The upper face of the block goes so far, in sides of it.
    Block([f64; 3]),
}

const WAYS: [(&str, Way); 6] = [
    ("ball/0.7", Way::Ball(0.7)),
    ("ball/0.5", Way::Ball(0.5)),
    ("block/0.7", Way::Block([0.0, 0.0, -0.3])),
    ("block/0.5", Way::Block([0.0, 0.0, -0.5])),
    ("block/drawn/2", Way::Block([0.0, 0.0, 1.0])),
    ("block/sheared/1.5", Way::Block([1.5, 0.0, 0.0])),
];

/// A material and a setting.
#[derive(Clone, Copy)]
struct Of {
    poisson: f64,
    damping_s: f64,
    setting: Setting,
}

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    let quick = effort == Effort::Quick;
    for (name, way) in WAYS {
        for poisson in POISSON {
            for damping_ms in DAMPING_MS {
                let case = format!("motion/squeeze/{name}/{poisson}/d{damping_ms}");
                let usual = damping_ms == 2 && [0.3, 0.49].contains(&poisson);
                if wanted(&case) && (usual || !quick) {
                    for setting in [1, 2].map(Setting::auto) {
                        let damping_s = f64::from(damping_ms) * 1e-3;
                        let of = Of {
                            poisson,
                            damping_s,
                            setting,
                        };
                        let row = match way {
                            Way::Ball(share) => ball(&case, share, of),
                            Way::Block(by) => block(&case, Vector3::from(by) * SIDE_M, of),
                        };
                        let method = setting.method();
                        out(row.unwrap_or_else(|why| failed(&case, &method, &why)));
                    }
                }
            }
        }
    }
}

fn material(of: Of) -> String {
    format!(
        "model = \"continuum\"\nmaterial = {{ young_pa = 20e3, poisson = {:?}, density_kg_m3 = 1000.0, damping_s = {:?} }}\n{}",
        of.poisson,
        of.damping_s,
        of.setting.text()
    )
}

/// The gel ball about the origin, and the large one above it.
fn ball_text(of: Of) -> String {
    format!(
        r#"
[loop]
rate_hz = 1000
[[body]]
id = "gel"
surface = {{ builtin = "sphere", net = [8, 8], size = {GEL_M:?} }}
lattice = {{ layers = 3, refine = "none" }}
fixed = [{{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, 1.0] }}]
{}
[[tool]]
id = "large"
shape = {{ sphere = {{ radius_m = {LARGE_M:?} }} }}
pose = {{ position = [0.0, 0.0, {:?}] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6 }}
"#,
        -HELD * GEL_M,
        material(of),
        GEL_M + LARGE_M + 1e-3,
    )
}

fn ball(case: &str, share: f64, of: Of) -> Result<Row, String> {
    let mut world = World::new(&ball_text(of))?;
    let above = GEL_M + LARGE_M;
    let depth_m = 2.0 * GEL_M * (1.0 - share);
    let at = |world: &mut World, part: f64| {
        let place = [0.0, 0.0, above - depth_m * gently(part)];
        world.at(place).tools[0].force_n.z
    };
    for k in 1..=PRESS {
        at(&mut world, k as f64 / PRESS as f64);
    }
    let mut held = Held::default();
    for k in 0..HOLD {
        let force_n = at(&mut world, 1.0);
        held.look(k, force_n, &world)?;
    }
    for _ in 0..REST {
        world.at([0.0, 0.0, 1.0]);
    }
    held.row(case, of.setting, &world)
}

/// The block below z = 0, its upper and its lower face held.
fn block_text(of: Of) -> String {
    let surface = surface(1, [CELLS + 1; 2], SIDE_M, SIDE_M);
    let sliver = 1e-3 * SIDE_M;
    format!(
        r#"
[loop]
rate_hz = 1000
[[body]]
id = "block"
surface = {{ inline = {surface} }}
lattice = {{ layers = {CELLS}, refine = "none", thickness_m = {SIDE_M:?} }}
fixed = [{{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, -1.0] }}, {{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, 1.0] }}]
{}
{FAR_TOOL}"#,
        -sliver,
        sliver - SIDE_M,
        material(of),
    )
}

/// Coordinates of the upper face, and where they rest.
struct Plate(Vec<(usize, Point3)>);

impl Plate {
    fn of(world: &World) -> Result<Self, String> {
        let (body, _) = world.body()?;
        let held = (0..body.coordinate_count())
            .map(|c| (c, body.rest()[c]))
            .filter(|&(c, place)| body.unknown(c).is_none() && place.z > -0.5 * SIDE_M);
        Ok(Self(held.collect()))
    }

    /// One tick with the plate so far from where it rests.
    fn put(&self, world: &mut World, by: Vector3) -> Result<(), String> {
        world.move_held(&self.0, by)?;
        world.at([0.0, 0.0, 10.0]);
        Ok(())
    }

    /// What holds the plate out along `way`, against the law's force, N.
    fn force_n(&self, world: &World, way: &Vector3) -> Result<f64, String> {
        let (body, state) = world.body()?;
        let mut scratch = body.scratch();
        let forces = body.internal_forces(state, &mut scratch);
        let on_it = self.0.iter().map(|&(c, _)| forces[c]);
        Ok(on_it
            .map(|f| -Vector3::new(f[0], f[1], f[2]).dot(way))
            .sum())
    }
}

fn block(case: &str, by: Vector3, of: Of) -> Result<Row, String> {
    let mut world = World::new(&block_text(of))?;
    let plate = Plate::of(&world)?;
    for k in 1..=PRESS {
        plate.put(&mut world, by * gently(k as f64 / PRESS as f64))?;
    }
    let (mut held, way) = (Held::default(), by.normalize());
    for k in 0..HOLD {
        plate.put(&mut world, by)?;
        held.look(k, plate.force_n(&world, &way)?, &world)?;
    }
    for k in 1..=BACK + REST {
        plate.put(&mut world, by * gently(1.0 - k as f64 / BACK as f64))?;
    }
    held.row(case, of.setting, &world)
}

#[cfg(test)]
mod tests {
    use super::*;

    // E A ε of a column is a lower bound for a block whose faces are held.
    #[test]
    fn a_block_that_is_gripped_bears_what_its_material_says() {
        let of = Of {
            poisson: 0.3,
            damping_s: 2e-3,
            setting: Setting::auto(1),
        };
        let mut world = World::new(&block_text(of)).unwrap();
        let plate = Plate::of(&world).unwrap();
        assert_eq!(plate.0.len(), (CELLS + 1) * (CELLS + 1));
        let by = Vector3::z() * -0.01 * SIDE_M;
        for k in 0..600 {
            let share = gently(f64::from(k) / 300.0);
            plate.put(&mut world, by * share).unwrap();
        }
        let force_n = plate.force_n(&world, &-Vector3::z()).unwrap();
        let column_n = 20e3 * SIDE_M * SIDE_M * 0.01;
        assert!(force_n > column_n && force_n < 1.3 * column_n, "{force_n}");
    }
}
