//! The exact backward Euler step of a body that a rigid frictionless obstacle touches.
//!
//! `M (x' − x − dt v) / dt² = f + M g + F + Σ λ ∇g(x')` with `g(x') ≥ 0`, `λ ≥ 0` and `λ g(x') = 0` at
//! places of the surface, g an analytic gap: Newton's method, each step of which solves the
//! quadratic program that is linear in the gaps (sequential quadratic programming) by the active sets
//! of Lawson & Hanson (1974, ch. 23). Normals and gaps are those of the end of the step and nothing is
//! taken from the contact solver of the simulation: neither its rows, nor its queries, nor its
//! compliance.

use super::obstacle::Obstacle;
use super::{ExactStep, Solved, Unsolved, largest};
use palpate_geometry::basis::Blending;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;
use palpate_sim::body::DeformableState;
use std::collections::BTreeMap;

/// Residual over the largest force at which a step with contact is solved.
const TOLERANCE: f64 = 1e-10;
/// Gap over the size of the body that counts as none.
const TOUCHING: f64 = 1e-10;
/// Newton's method starts at this share of the way that inertia alone would take the body; the next one
/// is tried when it does not converge.
const STARTS: [f64; 4] = [1.0, 0.0, 0.5, 0.8];
/// Newton steps.
const STEPS: usize = 200;
/// A step that leaves more of the residual than this pays for a new factor.
const SLOW: f64 = 0.3;
/// Changes of the active set in one program.
const CHANGES: usize = 2_000;
/// Added to the diagonal of the program, of its largest entry: places close together press the body
/// alike.
const RIDGE: f64 = 1e-13;

/// Places of a surface whose contact is asked for.
#[derive(Clone, Debug)]
pub struct Skin {
    /// (places): coordinate and weight.
    places: Vec<Vec<(u32, f64)>>,
}

impl Skin {
    /// A grid of `counts` places over the domain of a surface whose control points are coordinates of
    /// the body, of which those `within` are kept.
    ///
    /// # Errors
    /// The grid does not give the points of the surface.
    pub fn new(
        step: &ExactStep<'_>,
        surface: &Surface,
        counts: [usize; 2],
        within: impl Fn(&Point3) -> bool,
    ) -> Result<Self, String> {
        let grid = |(from, to): (f64, f64), count: usize| -> Vec<f64> {
            let along = |k: usize| from + (to - from) * k as f64 / (count - 1) as f64;
            (0..count).map(along).collect()
        };
        let (us, vs) = (
            grid(surface.knots_u().domain(), counts[0]),
            grid(surface.knots_v().domain(), counts[1]),
        );
        let (rows, columns) = (
            Blending::new(surface.knots_u(), &us),
            Blending::new(surface.knots_v(), &vs),
        );
        let net = surface.net();
        let mut places: Vec<Vec<(u32, f64)>> = Vec::new();
        for (i, u) in us.iter().enumerate() {
            for (j, v) in vs.iter().enumerate() {
                let mut at = Vector3::zeros();
                let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
                let mut sum = 0.0;
                for (row, a) in rows.entries(i, 0) {
                    for (column, b) in columns.entries(j, 0) {
                        let control = row * net.columns() + column;
                        let weight = a * b * surface.weights().map_or(1.0, |of| of[control]);
                        at += net.at(row, column).coords * weight;
                        sum += weight;
                        let coordinate = step.body.coordinate_of_control(control) as u32;
                        *weights.entry(coordinate).or_insert(0.0) += weight;
                    }
                }
                let at = Point3::from(at / sum);
                weights.values_mut().for_each(|weight| *weight /= sum);
                if (at - surface.point(*u, *v)).norm() > 1e-9 {
                    return Err(format!("the surface at ({u}, {v}) is not that of its net"));
                }
                if within(&at) {
                    places.push(weights.into_iter().filter(|(_, w)| *w != 0.0).collect());
                }
            }
        }
        Ok(Self { places })
    }

    /// Of the given places: coordinates of the body and their weights, which add up to one.
    pub fn at(places: Vec<Vec<(u32, f64)>>) -> Self {
        Self { places }
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.places.len()
    }
}

/// What presses, from one step to the next.
#[derive(Clone, Debug, Default)]
pub struct Touch {
    /// Place of the skin and its force, N, of those that press.
    pressing: Vec<(usize, f64)>,
    /// Sum of the forces on the body, N.
    pub force_n: Vector3,
}

/// What is missing at the end of a Newton step.
struct End {
    /// On each coordinate without contact, N.
    missing: Vec<f64>,
    /// Largest with contact, N.
    left_n: f64,
    /// Largest gap of a place that presses, or depth of one that is inside, m.
    open_m: f64,
    /// Largest force, N.
    scale_n: f64,
    /// Sum of the contact forces on the body, N.
    force_n: Vector3,
}

/// A place of the skin with regard to the free coordinates.
struct Place {
    /// From those that are fixed, m.
    fixed: Vector3,
    /// Row of a free coordinate and weight.
    free: Vec<(usize, f64)>,
}

impl Place {
    fn at(&self, places: &[f64]) -> Point3 {
        let mut at = self.fixed;
        for &(row, weight) in &self.free {
            for axis in 0..3 {
                at[axis] += weight * places[3 * row + axis];
            }
        }
        Point3::from(at)
    }

    /// weight × how far `moved` takes the place.
    fn moves(&self, moved: &[f64]) -> Vector3 {
        let mut by = Vector3::zeros();
        for &(row, weight) in &self.free {
            for axis in 0..3 {
                by[axis] += weight * moved[3 * row + axis];
            }
        }
        by
    }
}

/// Columns of the inverse of the factored tangent, by row of a free coordinate.
pub(super) type Columns = BTreeMap<usize, [Vec<f64>; 3]>;

impl ExactStep<'_> {
    /// One step of a state with a load on each coordinate, N, and an obstacle, which stands where it
    /// is at the end of the step.
    ///
    /// # Errors
    /// No convergence.
    pub fn step_touching(
        &mut self,
        state: &mut DeformableState,
        load_n: &[Vector3],
        skin: &Skin,
        obstacle: &Obstacle,
        touch: &mut Touch,
    ) -> Result<Solved, Unsolved> {
        let motion = self.motion(state, load_n);
        let skin = self.rows_of(skin, state);
        let before = touch.clone();
        let mut unsolved = Unsolved::default();
        // Where a step is large, Newton's method may go round in circles from one start and not from another.
        for share in STARTS {
            let between = motion.coasting.iter().zip(&motion.start);
            let places = between.map(|(to, from)| from + share * (to - from));
            match self.solve_touching(&motion, &skin, obstacle, touch, places.collect()) {
                Ok((solved, places)) => {
                    self.finish(state, &motion, &places);
                    return Ok(solved);
                }
                Err(why) => unsolved = why,
            }
            touch.clone_from(&before);
        }
        Err(unsolved)
    }

    /// The places at the end of a step, looked for from the given ones.
    fn solve_touching(
        &mut self,
        motion: &super::Motion,
        skin: &[Place],
        obstacle: &Obstacle,
        touch: &mut Touch,
        mut places: Vec<f64>,
    ) -> Result<(Solved, Vec<f64>), Unsolved> {
        let mut solved = Solved::default();
        let touching_m = TOUCHING * self.size_m;
        let mut pressing = std::mem::take(&mut touch.pressing);
        let (mut residual, _) = self.missing(motion, &places);
        let (mut before, mut fresh) = (f64::INFINITY, false);
        if self.stale || self.factor.is_none() {
            self.renew(motion, &places);
            fresh = true;
        }
        loop {
            // The quadratic program of gaps that are linear about these places.
            let near: Vec<(usize, f64, Vector3)> = skin
                .iter()
                .enumerate()
                .map(|(k, place)| (k, obstacle.gap(&place.at(&places))))
                .filter(|(_, (gap, ..))| *gap < 0.05 * self.size_m)
                .map(|(k, (gap, normal, _))| (k, gap, normal))
                .collect();
            let mut moved = self.precondition(&residual);
            let forces = self.program(skin, &near, &moved, &pressing);
            for &(entry, force) in &forces {
                let (k, _, normal) = near[entry];
                self.press(&skin[k], &(normal * force), &mut moved);
            }
            pressing = forces
                .iter()
                .map(|&(e, force)| (near[e].0, force))
                .collect();
            solved.steps += 1;
            // The whole way, or less where that leads nowhere with a factor of these places.
            let (from, mut length) = (places.clone(), 1.0);
            let state_of = loop {
                for ((x, from), d) in places.iter_mut().zip(&from).zip(&moved) {
                    *x = from + length * d;
                }
                let end = self.end(motion, skin, obstacle, &places, &pressing);
                let merit = end.left_n.max(end.open_m * self.stiffest_n_m);
                if merit < before || !fresh || length < 0.02 {
                    break (end, merit);
                }
                length *= 0.5;
            };
            let (end, now) = state_of;
            let scale_n = motion.scale_n.max(end.scale_n);
            (residual, touch.force_n) = (end.missing, end.force_n);
            solved.residual = end.left_n / scale_n.max(f64::MIN_POSITIVE);
            if end.left_n <= self.rounding_n {
                solved.residual = 0.0;
            }
            let small = solved.residual <= TOLERANCE;
            if small && end.open_m <= touching_m {
                break;
            }
            let unsolved = Unsolved {
                steps: solved.steps,
                residual_n: end.left_n,
                scale_n,
            };
            if solved.steps == STEPS || !now.is_finite() {
                self.stale = true;
                return Err(unsolved);
            }
            let slow = now > SLOW * before;
            before = now;
            // A factor that was slow is not of these places.
            fresh = slow;
            if slow {
                self.renew(motion, &places);
            }
        }
        touch.pressing = pressing;
        Ok((solved, places))
    }

    /// What is missing at the end of a Newton step, with normals and gaps of there.
    fn end(
        &mut self,
        motion: &super::Motion,
        skin: &[Place],
        obstacle: &Obstacle,
        places: &[f64],
        pressing: &[(usize, f64)],
    ) -> End {
        let (missing, law_n) = self.missing(motion, places);
        let (mut left, mut force_n) = (missing.clone(), Vector3::zeros());
        let (mut open_m, mut scale_n) = (0.0_f64, law_n);
        for &(k, force) in pressing {
            let (gap, normal, _) = obstacle.gap(&skin[k].at(places));
            open_m = open_m.max(gap.abs());
            scale_n = scale_n.max(force);
            force_n += normal * force;
            for &(row, weight) in &skin[k].free {
                for axis in 0..3 {
                    left[3 * row + axis] += weight * force * normal[axis];
                }
            }
        }
        for place in skin {
            open_m = open_m.max(-obstacle.gap(&place.at(places)).0);
        }
        End {
            missing,
            left_n: largest(&left),
            open_m,
            scale_n,
            force_n,
        }
    }

    /// A new factor at places, and none of the old one's columns.
    fn renew(&mut self, motion: &super::Motion, places: &[f64]) {
        let ahead = self.ahead(motion, places);
        self.refactor(&ahead);
        self.columns.clear();
    }

    /// The skin with regard to the free coordinates of this step.
    fn rows_of(&self, skin: &Skin, state: &DeformableState) -> Vec<Place> {
        let mut row = vec![usize::MAX; state.positions.len()];
        for (k, &c) in self.order.iter().enumerate() {
            row[c as usize] = k;
        }
        let place = |weights: &Vec<(u32, f64)>| {
            let (mut fixed, mut free) = (Vector3::zeros(), Vec::new());
            for &(c, weight) in weights {
                match row[c as usize] {
                    usize::MAX => fixed += state.positions[c as usize].coords * weight,
                    row => free.push((row, weight)),
                }
            }
            Place { fixed, free }
        };
        skin.places.iter().map(place).collect()
    }

    /// Adds what a force on a place moves to `moved`.
    fn press(&mut self, place: &Place, force: &Vector3, moved: &mut [f64]) {
        for &(row, weight) in &place.free {
            self.column(row);
            for axis in 0..3 {
                let amount = weight * force[axis];
                for (m, c) in moved.iter_mut().zip(&self.columns[&row][axis]) {
                    *m += amount * c;
                }
            }
        }
    }

    /// Makes the columns of a free coordinate, if they are not there.
    fn column(&mut self, row: usize) {
        if self.columns.contains_key(&row) {
            return;
        }
        let columns = [0, 1, 2].map(|axis| {
            let mut unit = vec![0.0; self.masses.len()];
            unit[3 * row + axis] = 1.0;
            self.precondition(&unit)
        });
        self.columns.insert(row, columns);
    }

    /// Forces λ ≥ 0 of near places (entry of `near`, N) after which no gap is negative and only gaps
    /// that are closed carry force, if the body moves by `free` and by what they move.
    fn program(
        &mut self,
        skin: &[Place],
        near: &[(usize, f64, Vector3)],
        free: &[f64],
        before: &[(usize, f64)],
    ) -> Vec<(usize, f64)> {
        // Gaps without forces.
        let open: Vec<f64> = near
            .iter()
            .map(|(k, gap, normal)| gap + normal.dot(&skin[*k].moves(free)))
            .collect();
        let goal_m = 1e-3 * TOUCHING * self.size_m;
        let mut set: Vec<Pressing> = Vec::new();
        for &(k, force) in before {
            if let Ok(entry) = near.binary_search_by_key(&k, |entry| entry.0) {
                set.push(self.pressing(skin, near, entry, force));
            }
        }
        let mut added = usize::MAX;
        for _ in 0..CHANGES {
            // Forces that close the gaps of the set; those that would pull leave it.
            while !set.is_empty() {
                let wanted = close(&set, skin, near, &open);
                let mut share: f64 = 1.0;
                for (member, wanted) in set.iter().zip(&wanted) {
                    if *wanted <= 0.0 {
                        share = share.min(member.force / (member.force - wanted));
                    }
                }
                for (member, wanted) in set.iter_mut().zip(&wanted) {
                    member.force += share * (wanted - member.force);
                }
                if share >= 1.0 {
                    break;
                }
                let least = 1e-12 * set.iter().map(|m| m.force).fold(0.0, f64::max);
                set.retain(|member| member.force > least);
            }
            // The place that is deepest inside joins.
            let mut total = vec![0.0; free.len()];
            for member in &set {
                for (t, m) in total.iter_mut().zip(&member.moves) {
                    *t += member.force * m;
                }
            }
            let gaps = near.iter().zip(&open).enumerate();
            let deepest = gaps
                .filter(|(entry, _)| set.iter().all(|member| member.entry != *entry))
                .map(|(entry, ((k, _, normal), open))| {
                    (entry, open + normal.dot(&skin[*k].moves(&total)))
                })
                .min_by(|a, b| a.1.total_cmp(&b.1));
            match deepest {
                // What has just left would only come and go.
                Some((entry, gap)) if gap < -goal_m && entry != added => {
                    set.push(self.pressing(skin, near, entry, 0.0));
                    added = entry;
                }
                _ => break,
            }
        }
        set.iter().map(|m| (m.entry, m.force)).collect()
    }

    fn pressing(
        &mut self,
        skin: &[Place],
        near: &[(usize, f64, Vector3)],
        entry: usize,
        force: f64,
    ) -> Pressing {
        let (k, _, normal) = near[entry];
        let mut moves = vec![0.0; self.masses.len()];
        self.press(&skin[k], &normal, &mut moves);
        Pressing {
            entry,
            force,
            moves,
        }
    }
}

/// A place in the active set.
struct Pressing {
    /// Of the near places.
    entry: usize,
    /// N.
    force: f64,
    /// How one newton moves the free coordinates, m.
    moves: Vec<f64>,
}

/// Forces of a set after which all of its gaps are zero.
fn close(
    set: &[Pressing],
    skin: &[Place],
    near: &[(usize, f64, Vector3)],
    open: &[f64],
) -> Vec<f64> {
    let n = set.len();
    let mut matrix = nalgebra::DMatrix::zeros(n, n);
    let mut right = nalgebra::DVector::zeros(n);
    for (i, member) in set.iter().enumerate() {
        let (k, _, normal) = near[member.entry];
        for (j, other) in set.iter().enumerate() {
            matrix[(i, j)] = normal.dot(&skin[k].moves(&other.moves));
        }
        right[i] = -open[member.entry];
    }
    let ridge = RIDGE * matrix.diagonal().max();
    for i in 0..n {
        matrix[(i, i)] += ridge;
    }
    match matrix.clone().cholesky() {
        Some(factor) => factor.solve(&right).iter().copied().collect(),
        // Rounding has made it indefinite: the least change that solves it.
        None => {
            let solved = matrix.svd(true, true).solve(&right, 1e-12 * ridge / RIDGE);
            solved.map_or(vec![0.0; n], |x| x.iter().copied().collect())
        }
    }
}
