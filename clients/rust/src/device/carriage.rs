//! A point mass on a damper, held by a hand's spring and damper, pushed by a force and rubbed by
//! dry friction.
//!
//! Between two changes of the friction's direction everything is linear, so each piece is taken
//! exactly ([`Propagator`]); the pieces end where friction stops the mass. Work is integrated with
//! Gauss and Legendre's five points, which for pieces this short (half a radian at most) is exact
//! to rounding.

use super::oscillator::Propagator;
use super::v3;

/// What holds the mass over a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Load {
    pub(super) mass_kg: f64,
    pub(super) damping_n_s_m: f64,
    pub(super) coulomb_n: f64,
    pub(super) hand_stiffness_n_m: f64,
    pub(super) hand_damping_n_s_m: f64,
}

/// Where the hand wants the mass at the begin of a step, and its velocity, constant over the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pull {
    pub(super) position: [f64; 3],
    pub(super) velocity: [f64; 3],
}

/// What was done since the start, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Work {
    pub(super) hand_j: f64,
    pub(super) loop_j: f64,
    pub(super) viscous_j: f64,
    pub(super) coulomb_j: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) position: [f64; 3],
    pub(super) velocity: [f64; 3],
}

/// Nodes on (0, 1) and weights.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_6, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Pieces of one step: more than a mass that slides, stops and turns can need; what is left is
/// friction's.
const PIECES: usize = 8;

/// The linear motion over a time.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    step_s: f64,
    whole: Propagator,
    nodes: [Propagator; 5],
}

impl Piece {
    fn new(load: &Load, step_s: f64) -> Self {
        let alpha = (load.damping_n_s_m + load.hand_damping_n_s_m) / (2.0 * load.mass_kg);
        let kappa = load.hand_stiffness_n_m / load.mass_kg;
        let after = |share: f64| Propagator::new(alpha, kappa, share * step_s);
        Self {
            step_s,
            whole: after(1.0),
            nodes: GAUSS.map(|(node, _)| after(node)),
        }
    }
}

/// Takes steps of one length under one load.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Carriage {
    load: Load,
    piece: Piece,
}

impl Carriage {
    pub(super) fn new(load: Load, step_s: f64) -> Self {
        Self {
            load,
            piece: Piece::new(&load, step_s),
        }
    }

    /// True if it was made for this.
    pub(super) fn is_for(&self, load: &Load, step_s: f64) -> bool {
        self.load == *load && self.piece.step_s == step_s
    }

    /// Steps a period needs so that none turns by more than half a radian or forgets more than
    /// half.
    pub(super) fn steps(load: &Load, period_s: f64) -> usize {
        let rate = (load.damping_n_s_m + load.hand_damping_n_s_m) / load.mass_kg
            + (load.hand_stiffness_n_m / load.mass_kg).sqrt();
        ((rate * period_s / 0.5).ceil()).clamp(1.0, 1_000.0) as usize
    }

    /// One step under a constant force.
    pub(super) fn step(&self, state: &mut State, pull: &Pull, force_n: [f64; 3], work: &mut Work) {
        let load = &self.load;
        if load.coulomb_n == 0.0 {
            self.slide(&self.piece, state, pull, force_n, [0.0; 3], work);
            return;
        }
        let mut pull = *pull;
        let mut left_s = self.piece.step_s;
        for _ in 0..PIECES {
            let direction = if state.velocity == [0.0; 3] {
                let net = self.net(state, &pull, force_n);
                let size = v3::norm(net);
                // It sticks: nothing moves, nothing works. Looked at once a step.
                if size <= load.coulomb_n {
                    return;
                }
                v3::scale(net, 1.0 / size)
            } else {
                v3::scale(state.velocity, 1.0 / v3::norm(state.velocity))
            };
            let friction = v3::scale(direction, -load.coulomb_n);
            let shorter;
            let mut piece = &self.piece;
            if left_s < self.piece.step_s {
                shorter = Piece::new(load, left_s);
                piece = &shorter;
            }
            let mut after = *state;
            let mut done = *work;
            self.slide(piece, &mut after, &pull, force_n, friction, &mut done);
            if v3::dot(after.velocity, direction) > 0.0 {
                (*state, *work) = (after, done);
                return;
            }
            // It comes to rest along its way before the end. From rest the net force exceeds
            // friction, so there the piece has a way to go before it stops again.
            let stop_s = self.stop(state, &pull, force_n, friction, direction, left_s);
            if stop_s > 0.0 {
                self.slide(
                    &Piece::new(load, stop_s),
                    state,
                    &pull,
                    force_n,
                    friction,
                    work,
                );
            }
            left_s -= stop_s;
            pull.position = v3::add(pull.position, v3::scale(pull.velocity, stop_s));
            let across = v3::sub(
                state.velocity,
                v3::scale(direction, v3::dot(state.velocity, direction)),
            );
            // What moves across is stopped too if friction can do it within this step; its energy
            // is friction's.
            let stops = v3::norm(across) * load.mass_kg <= load.coulomb_n * self.piece.step_s;
            let kept = if stops { [0.0; 3] } else { across };
            work.coulomb_j += 0.5
                * load.mass_kg
                * (v3::dot(state.velocity, state.velocity) - v3::dot(kept, kept));
            state.velocity = kept;
            if left_s <= 1e-12 * self.piece.step_s {
                return;
            }
        }
        work.coulomb_j += 0.5 * load.mass_kg * v3::dot(state.velocity, state.velocity);
        state.velocity = [0.0; 3];
    }

    /// Force on a mass at rest, friction aside.
    fn net(&self, state: &State, pull: &Pull, force_n: [f64; 3]) -> [f64; 3] {
        let stretch = v3::sub(pull.position, state.position);
        let held = v3::scale(stretch, self.load.hand_stiffness_n_m);
        v3::add(
            force_n,
            v3::add(held, v3::scale(pull.velocity, self.load.hand_damping_n_s_m)),
        )
    }

    /// When the velocity along `direction` ends, s: it is positive (or about to be) at 0 and not at
    /// `most_s`.
    fn stop(
        &self,
        state: &State,
        pull: &Pull,
        force_n: [f64; 3],
        friction: [f64; 3],
        direction: [f64; 3],
        most_s: f64,
    ) -> f64 {
        let load = &self.load;
        let (alpha, kappa) = (
            (load.damping_n_s_m + load.hand_damping_n_s_m) / (2.0 * load.mass_kg),
            load.hand_stiffness_n_m / load.mass_kg,
        );
        let speed = |t: f64| {
            let propagator = Propagator::new(alpha, kappa, t);
            (0..3)
                .map(|c| direction[c] * self.axis(c, &propagator, state, pull, force_n, friction).1)
                .sum::<f64>()
        };
        let (mut low, mut high) = (0.0, most_s);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if speed(middle) > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        high
    }

    /// Position less the start's pull, and velocity, along one axis.
    fn axis(
        &self,
        c: usize,
        propagator: &Propagator,
        state: &State,
        pull: &Pull,
        force_n: [f64; 3],
        friction: [f64; 3],
    ) -> (f64, f64) {
        // Seen from the moving pull: m y″ = F + f − b (y′ + r′) − c y′ − k y.
        let load = &self.load;
        let (y, w) = (
            state.position[c] - pull.position[c],
            state.velocity[c] - pull.velocity[c],
        );
        let a = (force_n[c] + friction[c] - load.damping_n_s_m * pull.velocity[c]) / load.mass_kg;
        let (y, w) = propagator.step(y, w, a);
        (y, w + pull.velocity[c])
    }

    fn slide(
        &self,
        piece: &Piece,
        state: &mut State,
        pull: &Pull,
        force_n: [f64; 3],
        friction: [f64; 3],
        work: &mut Work,
    ) {
        let load = &self.load;
        for (node, (_, weight)) in piece.nodes.iter().zip(GAUSS) {
            for c in 0..3 {
                let (y, v) = self.axis(c, node, state, pull, force_n, friction);
                let held =
                    -load.hand_stiffness_n_m * y - load.hand_damping_n_s_m * (v - pull.velocity[c]);
                work.hand_j += weight * piece.step_s * held * v;
                work.viscous_j += weight * piece.step_s * load.damping_n_s_m * v * v;
            }
        }
        let before = *state;
        for c in 0..3 {
            let (y, v) = self.axis(c, &piece.whole, &before, pull, force_n, friction);
            let way = y - (before.position[c] - pull.position[c]) + pull.velocity[c] * piece.step_s;
            work.loop_j -= force_n[c] * way;
            work.coulomb_j -= friction[c] * way;
            state.position[c] = before.position[c] + way;
            state.velocity[c] = v;
        }
    }
}
