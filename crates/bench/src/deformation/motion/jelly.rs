//! A ball of jelly that falls a few millimetres into a bowl: when it is at rest.
//!
//! Against our own step with many iterations: the exact step with contact knows no friction, without
//! which the ball would roll about for long.

use super::{CONVERGED, Row, SETTINGS, Setting, World, failed, row};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;
use palpate_sim::body::{Deformable, DeformableState};

/// Radius of the ball, m, how high it hangs over the bottom of the bowl, m, and its d, s.
const RADIUS_M: f64 = 0.016;
const DROP_M: f64 = 0.003;
const DAMPING_S: f64 = 1e-2;
/// The bowl is z = BEND (x² + y²), 1/m, as far as HALF to each side, m.
const BEND: f64 = 50.0 / 3.0;
const HALF_M: f64 = 0.04;
/// At rest nothing moves faster, m/s.
const REST_M_S: f64 = 1e-3;
/// For so many ticks.
const STILL: usize = 100;
/// Ticks within which it has to be.
const TICKS: usize = 3_000;
/// How far around a pole its dimple is looked for, of the domain.
const BESIDE: f64 = 0.06;

pub(super) fn rows(wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    const CASE: &str = "motion/jelly/bowl";
    if wanted(CASE) {
        rests(CASE, out);
    }
}

/// A fall and what came of it.
struct Fall {
    /// Tick from which on it was at rest for a tenth of a second; all of them if it never was.
    rest: usize,
    /// Last tick in which it moved.
    last: usize,
    /// Largest dimple at a pole in the end, m.
    dimple_m: f64,
    /// Height of the centre of mass in the end, from the start, m.
    height_m: f64,
}

/// Follows a fall tick by tick.
#[derive(Default)]
struct Follower {
    tick: usize,
    /// Last tick in which it moved.
    moved: usize,
    rest: Option<usize>,
}

impl Follower {
    fn look(&mut self, state: &DeformableState) {
        self.tick += 1;
        let squares = state.velocities.iter().map(|v| v.norm_squared());
        if squares.fold(0.0, f64::max) >= REST_M_S * REST_M_S {
            self.moved = self.tick;
        }
        if self.tick - self.moved == STILL {
            self.rest = self.rest.or(Some(self.moved));
        }
    }

    fn fall(&self, body: &Deformable, state: &DeformableState, surface: &Surface) -> Fall {
        let moved = state.positions.iter().zip(body.rest()).zip(body.masses());
        let sum: f64 = moved.map(|((x, rest), m)| m * (x.z - rest.z)).sum();
        Fall {
            rest: self.rest.unwrap_or(self.tick),
            last: self.moved,
            dimple_m: dimple_m(surface),
            height_m: sum / body.mass_kg(),
        }
    }
}

/// The surface of a state.
fn surface_of(rest: &Surface, body: &Deformable, state: &DeformableState) -> Surface {
    let mut surface = rest.clone();
    for (control, point) in surface.net_mut().points_mut().iter_mut().enumerate() {
        *point = state.positions[body.coordinate_of_control(control)];
    }
    surface
}

/// How far a pole stands inwards of what is around it, of the two, m; zero where it stands out.
fn dimple_m(surface: &Surface) -> f64 {
    let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
    let beside = BESIDE * (v.1 - v.0);
    let poles = [surface.point(u.0, v.0), surface.point(u.0, v.1)];
    let inwards = |pole: Point3, other: Point3, beside: f64| {
        let out = (pole - other).normalize();
        let places = (0..24).map(|k| u.0 + (u.1 - u.0) * f64::from(k) / 24.0);
        let sum: Vector3 = places.map(|u| surface.point(u, beside) - pole).sum();
        sum.dot(&out) / 24.0
    };
    let low = inwards(poles[0], poles[1], v.0 + beside);
    let high = inwards(poles[1], poles[0], v.1 - beside);
    low.max(high).max(0.0)
}

fn text(setting: Setting) -> String {
    let across = [-HALF_M, 0.0, HALF_M];
    let square = HALF_M * HALF_M;
    let rise = [square, -square, square].map(|x| BEND * x);
    let rows = [0, 1, 2].map(|i| {
        let points = [0, 1, 2].map(|j| {
            format!(
                "[{:?}, {:?}, {:?}]",
                across[i],
                across[j],
                rise[i] + rise[j]
            )
        });
        format!("[{}]", points.join(", "))
    });
    let knots = "[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]";
    format!(
        r#"
[loop]
rate_hz = 1000
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "jelly"
surface = {{ builtin = "sphere", net = [10, 8], size = {RADIUS_M:?} }}
pose = {{ position = [0.0, 0.0, {:?}] }}
model = "continuum"
material = {{ young_pa = 3e3, poisson = 0.45, density_kg_m3 = 1050.0, damping_s = {DAMPING_S:?} }}
lattice = {{ layers = 2, refine = "none" }}
{}
[[body]]
id = "bowl"
surface = {{ inline = {{ format = "palpate.surface.v1", degree = [2, 2], periodic = [false, false], knots = [{knots}, {knots}], points = [{}] }} }}
[[contact]]
pair = ["jelly", "bowl"]
friction = {{ mu = 0.15 }}
[[tool]]
id = "pen"
shape = {{ point = {{}} }}
pose = {{ position = [0.0, 0.0, 1.0] }}
"#,
        RADIUS_M + DROP_M,
        setting.text(),
        rows.join(", ")
    )
}

fn fallen(setting: Setting) -> Result<(Fall, Vec<f64>), String> {
    let mut world = World::new(&text(setting))?;
    let mut follower = Follower::default();
    for _ in 0..TICKS {
        world.at([0.0, 0.0, 1.0]);
        follower.look(world.body()?.1);
    }
    let (body, state) = world.body()?;
    let surface = surface_of(world.scene.rest_surface(0).expect("a surface"), body, state);
    Ok((follower.fall(body, state, &surface), world.ticks_s))
}

fn rests(case: &str, out: &mut dyn FnMut(Row)) {
    let (right, right_s) = match fallen(Setting::auto(CONVERGED)) {
        Ok(done) => done,
        Err(why) => return out(failed(case, "none", &why)),
    };
    // What the reference itself is good for.
    let mut about = match fallen(Setting::auto(CONVERGED / 2)) {
        Ok((fall, _)) => format!("; with {} iterations after {} ms", CONVERGED / 2, fall.rest),
        Err(why) => format!("; with half of them: {why}"),
    };
    let mut tell = |setting: Setting, fall: &Fall, ticks_s: Vec<f64>| {
        let note = format!(
            "at rest after {} ms (last stir {} ms), with {CONVERGED} iterations after {} ms ({} ms); dimple at a pole {:.3} mm and {:.3} mm; \
             {:.3} mm and {:.3} mm below the start; {} iterations, matrix {}{}",
            fall.rest,
            fall.last,
            right.rest,
            right.last,
            fall.dimple_m * 1e3,
            right.dimple_m * 1e3,
            -fall.height_m * 1e3,
            -right.height_m * 1e3,
            setting.iterations,
            setting.matrix,
            std::mem::take(&mut about),
        );
        let error = fall.rest as f64 / right.rest as f64 - 1.0;
        row(
            case,
            &setting.method(),
            ticks_s,
            (error, "of the time to rest"),
            note,
        )
    };
    for setting in SETTINGS {
        out(match fallen(setting) {
            Ok((fall, ticks_s)) => tell(setting, &fall, ticks_s),
            Err(why) => failed(case, &setting.method(), &why),
        });
    }
    out(tell(Setting::auto(CONVERGED), &right, right_s));
}
