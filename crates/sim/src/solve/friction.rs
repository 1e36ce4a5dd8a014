//! Contact forces with Coulomb friction and grips.
//!
//! Couplings and bodies give way alike in x, y and z: a force f_j on row j moves row i by S_ij f_j
//! with one number S_ij. Wanted are forces whose displacements u_i = b_i + Σ_j S_ij f_j keep each
//! row's law:
//!
//! - push, normal n, coefficient μ, drag c: f = λ n + t with λ ≥ 0, u_n ≥ 0, λ u_n = 0 and |t| ≤ μ
//!   λ while u_t = 0; where the row slips, t = −(μ λ / |u_t| + c) u_t (Signorini, Coulomb and
//!   Stokes);
//! - grip: u = 0 while |f| is below the limit, f = −limit u / |u| beyond it.
//!
//! A tool that may turn adds, for two of its rows with arms r_i and r_j, C (r_j × f_j) × r_i to
//! what row i moves. A body with soft modes adds Σ_k p_ik g_k (p_jk · f_j), where p_ik is how mode k
//! moves row i.
//!
//! A free rigid body adds three such modes for its turns, of which a row knows more than their sum: the
//! block S of the row is no more than a normal + b across, with a = S_nn + |S_nt| and b = |S_tt| + |S_nt|
//! (Young's inequality), and a step with these two goes down as well, in fewer sweeps.
//!
//! Solved row by row in a fixed number of sweeps (nonsmooth contact dynamics: Jean 1999, "The
//! non-smooth contact dynamics method", §5). S_ii being a number, each row's own problem has the
//! closed form used here; with an arm S_ii + C |r_i|² stands for it, which is no less than the
//! row's own compliance in any direction, so that every step still goes down. Grips and
//! frictionless rows are minima of a convex function, which every sweep lowers; sliding rows are
//! not, and jams at a high μ have more than one answer: the one nearest to the last tick's is
//! found.

use palpate_geometry::math::{Lane, Matrix3, Vector3};

/// Coulomb's law for a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Largest tangential over normal force while it sticks (> 0).
    pub mu: f64,
    /// The same while it slips, at most `mu`.
    pub mu_kinetic: f64,
    /// Drag of the whole contact against its slip, N·s/m.
    pub viscous_n_s_m: f64,
}

/// Where a row sticks: a place of the body, and how far from it the holder was. It lasts until the
/// row slips, so nothing that sweeps leave over, and no trembling of the hand, adds up to a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stick {
    /// On the body's surface.
    pub u: f64,
    /// On the body's surface.
    pub v: f64,
    /// From there to the tool's reference point, m; in the tool's frame unless it is a ball.
    /// Between bodies, which have no such point: what the row has crept.
    pub offset: Vector3,
}

/// What a row may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionLaw {
    /// It pushes, and resists slip by at most this multiple of its normal force.
    Push {
        /// μ (≥ 0).
        mu: f64,
        /// Drag for each metre it slips within the tick, N/m (≥ 0).
        drag_n_m: f64,
    },
    /// It holds in every direction.
    Grip {
        /// Greatest force, N.
        limit_n: f64,
    },
}

impl FrictionLaw {
    /// It pushes, and nothing else.
    pub const SMOOTH: Self = Self::Push {
        mu: 0.0,
        drag_n_m: 0.0,
    };

    /// It pushes, with Coulomb's friction.
    pub fn coulomb(mu: f64) -> Self {
        Self::Push { mu, drag_n_m: 0.0 }
    }
}

/// A row of a tool that may turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lever {
    /// Index of the tool.
    pub tool: usize,
    /// From its reference point to the contact, m.
    pub arm: Vector3,
    /// How far a torque turns it, rad/(N·m).
    pub compliance_rad_nm: f64,
}

fn lane(v: &Vector3) -> Lane {
    [v.x, v.y, v.z, 0.0]
}

fn vector(l: &Lane) -> Vector3 {
    Vector3::new(l[0], l[1], l[2])
}

fn dot(a: &Lane, b: &Lane) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: &Lane, b: &Lane) -> Lane {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
        0.0,
    ]
}

/// How a row turns its tool.
#[derive(Clone, Copy, Debug)]
struct Turning {
    tool: usize,
    arm: Lane,
    /// C, rad/(N·m); 0: it does not.
    compliance: f64,
}

/// How a row is moved by soft modes: a range of the pool.
#[derive(Clone, Copy, Debug, Default)]
struct ModesOfRow {
    start: u32,
    end: u32,
    /// Σ g |p|², no less than what they add to the row's own compliance in any direction, m/N.
    own: f64,
    /// Of turns: along the normal and across it, m/N.
    turns: [f64; 2],
}

/// How one mode moves one row.
#[derive(Clone, Copy, Debug)]
struct ModeOfRow {
    mode: u32,
    gain: f64,
    moves: Lane,
}

/// One row.
#[derive(Clone, Copy, Debug)]
struct Bound {
    modes: ModesOfRow,
    normal: Lane,
    /// b, m.
    free: Lane,
    law: FrictionLaw,
    turning: Turning,
    /// The last sweep met the edge of its cone.
    slips: bool,
}

/// Buffers for up to `capacity` rows.
#[derive(Clone, Debug, Default)]
pub struct FrictionProblem {
    rows: Vec<Bound>,
    /// f, N.
    forces: Vec<Lane>,
    /// u, m.
    displaced: Vec<Lane>,
    /// (tools), N·m: what turns each tool, within a solve.
    torques: Vec<Lane>,
    /// Modes of rows, row after row.
    pool: Vec<ModeOfRow>,
    /// (modes), J: work of the forces on each mode, within a solve.
    excited: Vec<f64>,
    /// Σ g p pᵀ of the turns of the row just added, m/N.
    turned: Matrix3,
}

impl FrictionProblem {
    /// Room for `capacity` rows of `tools` tools on bodies with `modes` soft modes, each row moved by
    /// those of at most two of them, `modes_of_row`.
    pub fn new(capacity: usize, tools: usize, modes: usize, modes_of_row: usize) -> Self {
        Self {
            pool: Vec::with_capacity(capacity * modes_of_row),
            excited: vec![0.0; modes],
            rows: Vec::with_capacity(capacity),
            forces: Vec::with_capacity(capacity),
            displaced: Vec::with_capacity(capacity),
            torques: vec![[0.0; 4]; tools],
            turned: Matrix3::zeros(),
        }
    }

    /// No rows.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.forces.clear();
        self.displaced.clear();
        self.pool.clear();
    }

    /// True when this tick has forces here.
    pub fn is_active(&self) -> bool {
        !self.rows.is_empty()
    }

    /// Adds a row: its unit normal, its displacement without contact forces (m), its law, and where
    /// its force starts (N).
    pub fn push(&mut self, normal: &Vector3, free_m: &Vector3, law: FrictionLaw, warm_n: &Vector3) {
        debug_assert!(
            self.rows.len() < self.rows.capacity(),
            "more rows than room"
        );
        let turning = Turning {
            tool: 0,
            arm: [0.0; 4],
            compliance: 0.0,
        };
        self.rows.push(Bound {
            normal: lane(normal),
            free: lane(free_m),
            law,
            turning,
            slips: false,
            modes: ModesOfRow {
                start: self.pool.len() as u32,
                end: self.pool.len() as u32,
                own: 0.0,
                turns: [0.0; 2],
            },
        });
        self.forces.push(lane(warm_n));
        self.displaced.push([0.0; 4]);
    }

    /// The row just added turns its tool.
    pub fn set_lever(&mut self, lever: &Lever) {
        if let Some(row) = self.rows.last_mut() {
            row.turning = Turning {
                tool: lever.tool,
                arm: lane(&lever.arm),
                compliance: lever.compliance_rad_nm,
            };
        }
    }

    /// The row just added is moved by a soft mode: `moves` for each unit of it.
    pub fn add_mode(&mut self, mode: usize, gain: f64, moves: &Vector3) {
        debug_assert!(gain >= 0.0, "a mode that drives");
        if let Some(row) = self.rows.last_mut()
            && *moves != Vector3::zeros()
        {
            self.pool.push(ModeOfRow {
                mode: mode as u32,
                gain,
                moves: lane(moves),
            });
            row.modes.end = self.pool.len() as u32;
            row.modes.own += gain * moves.norm_squared();
        }
    }

    /// The row just added is moved by the turn of a free body: `moves` for each rad of it. When all of
    /// them are added, [`FrictionProblem::bound_turns`].
    pub fn add_turn(&mut self, mode: usize, gain: f64, moves: &Vector3) {
        debug_assert!(gain >= 0.0, "a turn that drives");
        if let Some(row) = self.rows.last_mut() {
            self.pool.push(ModeOfRow {
                mode: mode as u32,
                gain,
                moves: lane(moves),
            });
            row.modes.end = self.pool.len() as u32;
            self.turned += moves * moves.transpose() * gain;
        }
    }

    /// Bounds what the turns just added to a row add to its own compliance.
    pub fn bound_turns(&mut self) {
        let turned = std::mem::take(&mut self.turned);
        if turned == Matrix3::zeros() {
            return;
        }
        let Some(row) = self.rows.last_mut() else {
            return;
        };
        let normal = vector(&row.normal);
        // Any direction across will do, well away from the normal.
        let axis = match normal.x.abs() < 0.6 {
            true => Vector3::x(),
            false => Vector3::y(),
        };
        let first = normal.cross(&axis).normalize();
        let second = normal.cross(&first);
        let pushed = turned * normal;
        let along = normal.dot(&pushed);
        let coupled = (pushed - normal * along).norm();
        let (a, b) = (first.dot(&(turned * first)), second.dot(&(turned * second)));
        let c = first.dot(&(turned * second));
        let across = 0.5 * (a + b) + (0.25 * (a - b) * (a - b) + c * c).sqrt();
        row.modes.turns = [along + coupled, across + coupled];
    }

    /// Changes a row's displacement without contact forces (m); its force stays as it is.
    pub fn set_free(&mut self, i: usize, free_m: &Vector3) {
        self.rows[i].free = lane(free_m);
    }

    /// Runs `sweeps` sweeps on the compliance `matrix` (n × n, row by row, m/N).
    pub fn solve(&mut self, matrix: &[f64], sweeps: usize) {
        debug_assert!(sweeps > 0, "a solve of no sweeps");
        debug_assert_eq!(
            matrix.len(),
            self.rows.len() * self.rows.len(),
            "matrix and rows disagree"
        );
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { solve_avx2(self, matrix, sweeps) };
        }
        self.sweep(matrix, sweeps);
    }

    #[inline(always)]
    fn sweep(&mut self, matrix: &[f64], sweeps: usize) {
        let n = self.rows.len();
        let Self {
            rows,
            forces,
            displaced,
            torques,
            pool,
            excited,
            ..
        } = self;
        torques.fill([0.0; 4]);
        excited.fill(0.0);
        for (row, force) in rows.iter().zip(forces.iter()) {
            row.turning.add(torques, force);
            row.modes.add(pool, excited, force);
        }
        for _ in 0..sweeps {
            for (i, row) in rows.iter_mut().enumerate() {
                let compliances = &matrix[i * n..(i + 1) * n];
                let turning = row.turning;
                let modes = row.modes;
                let own = compliances[i]
                    + turning.compliance * dot(&turning.arm, &turning.arm)
                    + modes.own;
                // A row that nothing can move, or a number that is none: no force of its own.
                let stiffness = if own > 0.0 { 1.0 / own } else { 0.0 };
                let mut next = [0.0; 4];
                if stiffness > 0.0 && stiffness.is_finite() {
                    let mut u = total(compliances, forces, &row.free);
                    turning.displace(torques, &mut u);
                    modes.displace(pool, excited, &mut u);
                    next = if modes.turns == [0.0; 2] {
                        let mut wish = [0.0; 4];
                        for c in 0..4 {
                            wish[c] = forces[i][c] - u[c] * stiffness;
                        }
                        row.allowed(&wish, own)
                    } else {
                        row.allowed_turning(&forces[i], &u, own)
                    };
                }
                if turning.compliance > 0.0 || modes.start < modes.end {
                    let mut change = [0.0; 4];
                    for c in 0..4 {
                        change[c] = next[c] - forces[i][c];
                    }
                    turning.add(torques, &change);
                    modes.add(pool, excited, &change);
                }
                forces[i] = next;
            }
        }
        for (i, row) in rows.iter().enumerate() {
            displaced[i] = total(&matrix[i * n..(i + 1) * n], forces, &row.free);
            row.turning.displace(torques, &mut displaced[i]);
            row.modes.displace(pool, excited, &mut displaced[i]);
        }
    }

    /// Force of a row along its normal, N.
    pub fn normal_n(&self, i: usize) -> f64 {
        dot(&self.forces[i], &self.rows[i].normal)
    }

    /// The rest of it, N.
    pub fn tangent_n(&self, i: usize) -> Vector3 {
        self.force_n(i) - vector(&self.rows[i].normal) * self.normal_n(i)
    }

    /// Force of a row, N.
    pub fn force_n(&self, i: usize) -> Vector3 {
        vector(&self.forces[i])
    }

    /// Replaces the force of a row by an equivalent one.
    pub fn set_force(&mut self, i: usize, force_n: &Vector3) {
        self.forces[i] = lane(force_n);
    }

    /// Displacement of a row under all forces, m.
    pub fn displaced_m(&self, i: usize) -> Vector3 {
        vector(&self.displaced[i])
    }

    /// The row's normal.
    pub fn normal(&self, i: usize) -> Vector3 {
        vector(&self.rows[i].normal)
    }

    /// The row is at the edge of what its law allows.
    pub fn slips(&self, i: usize) -> bool {
        self.rows[i].slips
    }

    /// The row's law.
    pub fn law(&self, i: usize) -> FrictionLaw {
        self.rows[i].law
    }
}

/// The same code with 256-bit registers; nothing is fused, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn solve_avx2(problem: &mut FrictionProblem, matrix: &[f64], sweeps: usize) {
    problem.sweep(matrix, sweeps);
}

/// b + Σ S_j f_j, in four sums that do not wait for each other.
#[inline(always)]
fn total(compliances: &[f64], forces: &[Lane], free: &Lane) -> Lane {
    debug_assert_eq!(compliances.len(), forces.len(), "a compliance a force");
    let mut sums = [*free, [0.0; 4], [0.0; 4], [0.0; 4]];
    let whole = compliances.len() / 4 * 4;
    for (s, f) in compliances[..whole]
        .chunks_exact(4)
        .zip(forces[..whole].chunks_exact(4))
    {
        for k in 0..4 {
            for c in 0..4 {
                sums[k][c] += s[k] * f[k][c];
            }
        }
    }
    for (s, f) in compliances[whole..].iter().zip(&forces[whole..]) {
        for c in 0..4 {
            sums[0][c] += s * f[c];
        }
    }
    let mut sum = [0.0; 4];
    for c in 0..4 {
        sum[c] = (sums[0][c] + sums[1][c]) + (sums[2][c] + sums[3][c]);
    }
    sum
}

impl Turning {
    /// A force turns the tool.
    #[inline(always)]
    fn add(&self, torques: &mut [Lane], force: &Lane) {
        if self.compliance > 0.0 {
            let torque = cross(&self.arm, force);
            for c in 0..4 {
                torques[self.tool][c] += torque[c];
            }
        }
    }

    /// The tool's turn moves the row.
    #[inline(always)]
    fn displace(&self, torques: &[Lane], u: &mut Lane) {
        if self.compliance > 0.0 {
            let moved = cross(&torques[self.tool], &self.arm);
            for c in 0..4 {
                u[c] += self.compliance * moved[c];
            }
        }
    }
}

impl ModesOfRow {
    /// A force excites the modes.
    #[inline(always)]
    fn add(&self, pool: &[ModeOfRow], excited: &mut [f64], force: &Lane) {
        for entry in &pool[self.start as usize..self.end as usize] {
            excited[entry.mode as usize] += dot(&entry.moves, force);
        }
    }

    /// The modes move the row.
    #[inline(always)]
    fn displace(&self, pool: &[ModeOfRow], excited: &[f64], u: &mut Lane) {
        for entry in &pool[self.start as usize..self.end as usize] {
            let amount = entry.gain * excited[entry.mode as usize];
            for c in 0..4 {
                u[c] += amount * entry.moves[c];
            }
        }
    }
}

impl Bound {
    /// The force of a row on a free body after `force`, under which it is displaced by `u`; `own`: what a
    /// unit of force moves it in any direction without the body's turns, m/N.
    #[inline(always)]
    fn allowed_turning(&mut self, force: &Lane, u: &Lane, own: f64) -> Lane {
        let [along, across] = self.modes.turns.map(|turns| own + turns);
        match self.law {
            FrictionLaw::Push { .. } => {
                let depth = dot(u, &self.normal);
                let mut wish = [0.0; 4];
                for c in 0..4 {
                    let tangent = u[c] - depth * self.normal[c];
                    wish[c] = force[c] - depth / along * self.normal[c] - tangent / across;
                }
                self.allowed(&wish, across)
            }
            FrictionLaw::Grip { .. } => {
                let stiffness = 1.0 / along.max(across);
                let mut wish = [0.0; 4];
                for c in 0..4 {
                    wish[c] = force[c] - u[c] * stiffness;
                }
                self.allowed(&wish, along.max(across))
            }
        }
    }

    /// The force the row takes when `wish` would bring its displacement to zero; `own`: what a unit
    /// of force moves it, m/N.
    #[inline(always)]
    fn allowed(&mut self, wish: &Lane, own: f64) -> Lane {
        match self.law {
            FrictionLaw::Push { mu, drag_n_m } => {
                let along = dot(wish, &self.normal);
                let pushes = along > 0.0;
                if !pushes {
                    self.slips = false;
                    return [0.0; 4];
                }
                let mut tangent = [0.0; 4];
                for c in 0..4 {
                    tangent[c] = wish[c] - along * self.normal[c];
                }
                let (size, most) = (dot(&tangent, &tangent).sqrt(), mu * along);
                self.slips = size > most;
                // Slip is own (size − |t|) against the way, and |t| = most + drag × slip.
                let drag = drag_n_m * own;
                let scale = if self.slips {
                    (most + drag * size) / ((1.0 + drag) * size)
                } else {
                    1.0
                };
                let mut force = [0.0; 4];
                for c in 0..4 {
                    force[c] = along * self.normal[c] + scale * tangent[c];
                }
                force
            }
            FrictionLaw::Grip { limit_n } => {
                let size = dot(wish, wish).sqrt();
                self.slips = size > limit_n;
                let scale = if self.slips { limit_n / size } else { 1.0 };
                wish.map(|x| x * scale)
            }
        }
    }
}

#[cfg(test)]
mod tests;
