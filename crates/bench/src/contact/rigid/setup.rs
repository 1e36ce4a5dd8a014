//! Bodies of a case, and the text of our scene with them.

use palpate_geometry::math::Vector3;
use std::f64::consts::PI;
use std::fmt::Write;

pub(super) const DT_S: f64 = 1e-3;
pub(super) const GRAVITY_M_S2: f64 = 9.81;
/// Of the pucks, m.
pub(super) const RADIUS_M: f64 = 0.02;
pub(super) const HEIGHT_M: f64 = 0.02;
/// Of the balls, m.
pub(super) const BALL_M: f64 = 0.03;
pub(super) const DENSITY_KG_M3: f64 = 1000.0;

/// A puck's axis is along z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Form {
    Puck,
    Ball,
}

/// A body and how it starts.
#[derive(Clone, Debug, serde::Serialize)]
pub(super) struct Thing {
    pub shape: Form,
    /// The middle of a puck's lower face, and of a ball.
    pub place_m: [f64; 3],
    pub density_kg_m3: f64,
    pub velocity_m_s: [f64; 3],
    pub spin_rad_s: [f64; 3],
}

/// How a body moves after a tick.
#[derive(Clone, Debug, serde::Deserialize)]
pub(super) struct Motion {
    pub centre_m: [f64; 3],
    pub velocity_m_s: [f64; 3],
    pub spin_rad_s: [f64; 3],
    /// Of length 1. It starts along z.
    pub axis: [f64; 3],
}

impl Motion {
    /// Of its axis.
    pub(super) fn tilt_rad(&self) -> f64 {
        let [x, y, z] = self.axis;
        libm::atan2(libm::hypot(x, y), z)
    }
}

/// Bodies, what they lie on and what pulls them.
#[derive(Clone, Debug, serde::Serialize)]
pub(super) struct Setup {
    pub things: Vec<Thing>,
    pub gravity_m_s2: [f64; 3],
    pub mu: f64,
    pub restitution: f64,
    /// Its top is at z = 0.
    pub floor: bool,
    pub ticks: usize,
}

impl Thing {
    /// With its lower face at a height, m.
    pub(super) fn puck(low_m: f64, density_kg_m3: f64) -> Self {
        Self {
            shape: Form::Puck,
            place_m: [0.0, 0.0, low_m],
            density_kg_m3,
            velocity_m_s: [0.0; 3],
            spin_rad_s: [0.0; 3],
        }
    }

    pub(super) fn ball(x_m: f64) -> Self {
        Self {
            shape: Form::Ball,
            place_m: [x_m, 0.0, 0.0],
            ..Self::puck(0.0, DENSITY_KG_M3)
        }
    }

    /// Where its middle starts.
    pub(super) fn centre_m(&self) -> [f64; 3] {
        let [x, y, z] = self.place_m;
        match self.shape {
            Form::Puck => [x, y, z + 0.5 * HEIGHT_M],
            Form::Ball => [x, y, z],
        }
    }

    pub(super) fn mass_kg(&self) -> f64 {
        let volume_m3 = match self.shape {
            Form::Puck => PI * RADIUS_M * RADIUS_M * HEIGHT_M,
            Form::Ball => 4.0 / 3.0 * PI * BALL_M * BALL_M * BALL_M,
        };
        self.density_kg_m3 * volume_m3
    }

    /// About its axis and across, of its mass, m².
    fn gyration_m2(&self) -> [f64; 2] {
        let r2 = RADIUS_M * RADIUS_M;
        match self.shape {
            Form::Puck => [0.5 * r2, (3.0 * r2 + HEIGHT_M * HEIGHT_M) / 12.0],
            Form::Ball => [0.4 * BALL_M * BALL_M; 2],
        }
    }

    /// Of its motion.
    pub(super) fn energy_j(&self, motion: &Motion) -> f64 {
        let [about, across] = self.gyration_m2();
        let velocity = Vector3::from(motion.velocity_m_s);
        let spin = Vector3::from(motion.spin_rad_s);
        let along = spin.dot(&Vector3::from(motion.axis));
        let turns = about * along * along + across * (spin.norm_squared() - along * along);
        0.5 * self.mass_kg() * (velocity.norm_squared() + turns)
    }

    fn text(&self, id: &str) -> String {
        let surface = match self.shape {
            Form::Puck => puck_surface(),
            Form::Ball => format!("surface = {{ builtin = \"sphere\", size = {BALL_M:?} }}\n"),
        };
        format!(
            "[[body]]\nid = \"{id}\"\nfree = true\nmaterial = {{ density_kg_m3 = {:?} }}\n\
             pose = {{ position = {:?} }}\nvelocity_m_s = {:?}\nspin_rad_s = {:?}\n{surface}",
            self.density_kg_m3, self.place_m, self.velocity_m_s, self.spin_rad_s
        )
    }
}

impl Setup {
    /// On a level floor under gravity, and without bouncing.
    pub(super) fn on_floor(things: Vec<Thing>, mu: f64, ticks: usize) -> Self {
        Self {
            things,
            gravity_m_s2: [0.0, 0.0, -GRAVITY_M_S2],
            mu,
            restitution: 0.0,
            floor: true,
            ticks,
        }
    }

    /// Our scene. The floor comes first where there is one, and bodies touch their neighbours only.
    pub(super) fn text(&self) -> String {
        let mut text = format!("[gravity]\nacceleration = {:?}\n", self.gravity_m_s2);
        let mut below = None;
        if self.floor {
            text += "[[body]]\nid = \"floor\"\nsurface = { builtin = \"sheet\", size = 2.0 }\n";
            below = Some("floor".to_owned());
        }
        for (k, thing) in self.things.iter().enumerate() {
            let id = format!("b{k}");
            text += &thing.text(&id);
            if let Some(below) = below {
                text += &self.contact(&below, &id);
            }
            below = Some(id);
        }
        text
    }

    fn contact(&self, a: &str, b: &str) -> String {
        let mut text = format!("[[contact]]\npair = [\"{a}\", \"{b}\"]\n");
        if self.mu > 0.0 {
            let _ = writeln!(text, "friction = {{ mu = {:?} }}", self.mu);
        }
        if self.restitution > 0.0 {
            let _ = writeln!(text, "restitution = {:?}", self.restitution);
        }
        text
    }
}

/// A surface of revolution with flat ends and a rounded rim. Its lower face is in z = 0.
fn puck_surface() -> String {
    let spans = 10;
    let inner = (1..spans).map(|k| f64::from(k) / f64::from(spans));
    let ends = |end: f64| std::iter::repeat_n(end, 4);
    let v: Vec<f64> = ends(0.0).chain(inner).chain(ends(1.0)).collect();
    let u: Vec<f64> = (0..=12).map(|k| f64::from(k) / 12.0).collect();
    format!(
        "[body.surface.inline]\nformat = \"palpate.surface.v1\"\nunit = \"m\"\ndegree = [3, 3]\n\
         periodic = [true, false]\nknots = [{u:?}, {v:?}]\npoints = {:?}\n",
        puck_net()
    )
}

/// Rows of points along the profile, twelve around.
fn puck_net() -> Vec<Vec<[f64; 3]>> {
    // A cubic B-spline of twelve points around is inside of its polygon by this.
    let out = 3.0 / (2.0 + libm::cos(PI / 6.0));
    let rim = 0.025 * HEIGHT_M;
    // Four rows in a plane make a span of it.
    let mut profile: Vec<(f64, f64)> = [0.0, 0.3, 0.6, 0.85, 0.95].map(|part| (part, 0.0)).into();
    profile.extend([(1.0, rim), (1.0, 0.5 * HEIGHT_M), (1.0, HEIGHT_M - rim)]);
    profile.extend([0.95, 0.85, 0.6, 0.3, 0.0].map(|part| (part, HEIGHT_M)));
    let row = |k: u8| {
        let angle = f64::from(k) * PI / 6.0;
        let point = |&(part, z): &(f64, f64)| {
            let r = out * part * RADIUS_M;
            [r * libm::cos(angle), r * libm::sin(angle), z]
        };
        profile.iter().map(point).collect()
    };
    (0..12).map(row).collect()
}
