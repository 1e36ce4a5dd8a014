//! Two couplings for comparison only: the seed's, in which free nodes move and the net is fitted to
//! them (its eq. 3.7), and contact at the nodes themselves.
//!
//! The fit is linear in the nodes, P = (NᵀN)⁻¹Nᵀ, so the fitted surface moves by N(u, v) P δx.
//! Contact is found on it; what it finds pushes the nearest node, as in the seed. Force and motion
//! are not each other's transpose: what the ball gives is not what the nodes take.

use super::scenes::TEARDROP_FIXED_M;
use nalgebra::DMatrix;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{Surface, builtin};
use palpate_sim::body::{
    Deformable, DeformableScratch, DeformableState, Inside, Integrator, Solid, StepMatrix,
    StepSettings, coordinates_of_controls, preset,
};
use palpate_thesis::cells::transfinite;

/// Samples of the fitted surface in u and v.
const SAMPLES: usize = 96;
/// Contacts farther than this are not rows, m.
const NEAR_M: f64 = 2e-4;
const SWEEPS: usize = 60;
const BALL_M: f64 = 0.01;

/// A cube lattice whose exterior nodes are free.
pub(super) struct Refit {
    pub body: Deformable,
    pub state: DeformableState,
    /// At rest.
    pub surface: Surface,
    scratch: DeformableScratch,
    /// (exterior nodes) of the cube.
    nodes: Vec<usize>,
    at_rest: Vec<Point3>,
    /// None: contact at the nodes.
    fit: Option<Fit>,
    /// Where the exterior nodes would be without contact.
    places: Vec<Point3>,
}

struct Fit {
    /// Motions of the net's coordinates from those of nodes.
    projector: DMatrix<f64>,
    coordinates: Vec<Point3>,
    /// Weights of the coordinates at each sample.
    samples: Vec<Vec<(usize, f64)>>,
}

/// One contact: the node it pushes, where to, how far there is to go, and the nodes that move its
/// place.
struct Contact {
    node: usize,
    push: Vector3,
    gap_m: f64,
    sample: Option<usize>,
}

fn weights(surface: &Surface, of_control: &[u32], [u, v]: [f64; 2]) -> Vec<(usize, f64)> {
    let (wu, wv) = (surface.knots_u().window(u), surface.knots_v().window(v));
    let (rows, columns) = (surface.net().rows(), surface.net().columns());
    let mut entries: Vec<(usize, f64)> = Vec::with_capacity(wu.len * wv.len);
    for (a, n) in wu.values().iter().enumerate() {
        for (b, m) in wv.values().iter().enumerate() {
            let control = (wu.first + a) % rows * columns + (wv.first + b) % columns;
            let coordinate = of_control[control] as usize;
            match entries.iter_mut().find(|(c, _)| *c == coordinate) {
                Some((_, weight)) => *weight += n * m,
                None => entries.push((coordinate, n * m)),
            }
        }
    }
    entries
}

impl Fit {
    fn new(surface: &Surface, exterior: &[(u32, [f64; 2])]) -> Option<Self> {
        let of_control = coordinates_of_controls(surface.net().points(), &[]);
        let count = *of_control.iter().max()? as usize + 1;
        let mut coordinates = vec![Point3::origin(); count];
        for (point, &coordinate) in surface.net().points().iter().zip(&of_control) {
            coordinates[coordinate as usize] = *point;
        }
        let mut map = DMatrix::zeros(exterior.len(), count);
        for (row, (_, uv)) in exterior.iter().enumerate() {
            for (coordinate, weight) in weights(surface, &of_control, *uv) {
                map[(row, coordinate)] = weight;
            }
        }
        let projector = (map.transpose() * &map).cholesky()?.solve(&map.transpose());
        let spread =
            |(low, high): (f64, f64), k: usize| low + (high - low) * k as f64 / SAMPLES as f64;
        let (us, vs) = (surface.knots_u().domain(), surface.knots_v().domain());
        let pairs = (0..SAMPLES).flat_map(|i| (0..=SAMPLES).map(move |j| (i, j)));
        let samples = pairs
            .map(|(i, j)| weights(surface, &of_control, [spread(us, i), spread(vs, j)]))
            .collect();
        Some(Self {
            projector,
            coordinates,
            samples,
        })
    }

    /// Coordinates of the net for moved nodes.
    fn fitted(&self, moved: &[Vector3]) -> Vec<Point3> {
        let mut net = self.coordinates.clone();
        for (c, point) in net.iter_mut().enumerate() {
            for (j, d) in moved.iter().enumerate() {
                *point += d * self.projector[(c, j)];
            }
        }
        net
    }

    /// How much each node moves a sample.
    fn shares(&self, sample: usize) -> Vec<f64> {
        let nodes = self.projector.ncols();
        let mut shares = vec![0.0; nodes];
        for &(coordinate, weight) in &self.samples[sample] {
            for (j, share) in shares.iter_mut().enumerate() {
                *share += weight * self.projector[(coordinate, j)];
            }
        }
        shares
    }
}

impl Refit {
    /// The teardrop with `nodes` a side; `net` is fitted to them, or contact is at the nodes.
    pub(super) fn new(nodes: usize, net: Option<[usize; 2]>) -> Result<Self, String> {
        let surface = builtin("teardrop", Some([8, 8]), None).map_err(|e| e.to_string())?;
        let surface = match net {
            Some([r, s]) if [r, s] != [8, 8] => {
                surface.refined_to(r, s).map_err(|e| e.to_string())?
            }
            _ => surface,
        };
        let cube = transfinite(&surface, [nodes; 3]).map_err(|e| e.to_string())?;
        let material = preset("gel").ok_or("no gel")?.material;
        let settings = StepSettings {
            dt_s: 1e-3,
            integrator: Integrator::Implicit {
                iterations: 1,
                // Contact is solved on columns of the compliance alone: no soft modes.
                matrix: StepMatrix::Bounding,
            },
            sleep_m_s: 0.0,
        };
        let fixed: Vec<bool> = cube
            .grid
            .nodes
            .iter()
            .map(|p| p.z <= TEARDROP_FIXED_M)
            .collect();
        let whole = Solid::whole(
            &cube.grid,
            &fixed,
            surface.volume().abs(),
            Inside::Springs,
            |_| material,
        );
        // Contact may push any node of the exterior: the body keeps what that does to all.
        let of_exterior = cube.exterior.iter().map(|(node, _)| *node).collect();
        let solid = Solid {
            coordinate_of_control: of_exterior,
            ..whole
        };
        let body = solid
            .build(&material, settings)
            .map_err(|e| e.to_string())?;
        let fit = match net {
            Some(_) => Some(
                Fit::new(&surface, &cube.exterior).ok_or("the nodes do not determine the net")?,
            ),
            None => None,
        };
        let (state, mut scratch) = (body.rest_state(), body.scratch());
        body.predict(&state, &mut scratch);
        let nodes: Vec<usize> = cube
            .exterior
            .iter()
            .map(|(node, _)| *node as usize)
            .collect();
        let at_rest: Vec<Point3> = nodes.iter().map(|&node| cube.grid.nodes[node]).collect();
        let places = at_rest.clone();
        Ok(Self {
            body,
            state,
            surface,
            scratch,
            nodes,
            at_rest,
            fit,
            places,
        })
    }

    /// One step with the ball there; the force on it, N.
    pub(super) fn step(&mut self, ball: &Point3) -> Vector3 {
        self.body.predict(&self.state, &mut self.scratch);
        for (place, &node) in self.places.iter_mut().zip(&self.nodes) {
            *place = self.scratch.predicted[node];
        }
        let contacts = self.contacts(ball);
        let forces = self.solve(&contacts);
        let mut on_ball = Vector3::zeros();
        for (contact, force_n) in contacts.iter().zip(forces) {
            let force = contact.push * force_n;
            on_ball -= force;
            if force_n > 0.0 {
                self.body
                    .push(&mut self.scratch, self.nodes[contact.node], force);
            }
        }
        self.body.advance(&mut self.state, &mut self.scratch);
        on_ball
    }

    /// The deepest place of each node that is nearest to one.
    fn contacts(&self, ball: &Point3) -> Vec<Contact> {
        let mut of_node: Vec<Option<Contact>> = self.nodes.iter().map(|_| None).collect();
        let mut meet = |point: Point3, node: Option<usize>, sample: Option<usize>| {
            let away = point - ball;
            let distance = away.norm();
            let gap_m = distance - BALL_M;
            if gap_m > NEAR_M || distance < 1e-6 {
                return;
            }
            let node = node.unwrap_or_else(|| self.nearest(&point));
            let free = self.body.unknown(self.nodes[node]).is_some();
            if free
                && of_node[node]
                    .as_ref()
                    .is_none_or(|other| gap_m < other.gap_m)
            {
                of_node[node] = Some(Contact {
                    node,
                    push: away / distance,
                    gap_m,
                    sample,
                });
            }
        };
        match &self.fit {
            None => (0..self.nodes.len()).for_each(|k| meet(self.places[k], Some(k), None)),
            Some(fit) => {
                let moved: Vec<Vector3> = self
                    .places
                    .iter()
                    .zip(&self.at_rest)
                    .map(|(p, rest)| p - rest)
                    .collect();
                let net = fit.fitted(&moved);
                for (sample, weights) in fit.samples.iter().enumerate() {
                    let at: Vector3 = weights
                        .iter()
                        .map(|(c, weight)| net[*c].coords * *weight)
                        .sum();
                    meet(Point3::from(at), None, Some(sample));
                }
            }
        }
        of_node.into_iter().flatten().collect()
    }

    fn nearest(&self, point: &Point3) -> usize {
        let (mut best, mut least) = (0, f64::INFINITY);
        for (k, place) in self.places.iter().enumerate() {
            let squared = (place - point).norm_squared();
            if squared < least {
                (best, least) = (k, squared);
            }
        }
        best
    }

    /// Forces that keep every contact's place out of the ball, N.
    fn solve(&self, contacts: &[Contact]) -> Vec<f64> {
        let n = contacts.len();
        let mut effects = vec![0.0; n * n];
        for (s, there) in contacts.iter().enumerate() {
            let shares = there
                .sample
                .zip(self.fit.as_ref())
                .map(|(sample, fit)| fit.shares(sample));
            for (r, here) in contacts.iter().enumerate() {
                let of_node = |k: usize| {
                    let load = (self.nodes[here.node], &here.push);
                    let moved = self.body.moved_by(&self.scratch, load, self.nodes[k]);
                    moved.map_or(0.0, |moved| moved.dot(&there.push))
                };
                let moved = match &shares {
                    None => of_node(there.node),
                    Some(shares) => shares
                        .iter()
                        .enumerate()
                        .map(|(k, share)| share * of_node(k))
                        .sum(),
                };
                effects[s * n + r] = moved;
            }
        }
        // All rows at once, so that nodes share what is deepest between them; row by row the first
        // node would take all, as one force moves a smooth surface everywhere near.
        let (mut forces, mut gaps) = (vec![0.0_f64; n], vec![0.0; n]);
        for _ in 0..SWEEPS {
            for (s, gap_m) in gaps.iter_mut().enumerate() {
                *gap_m =
                    contacts[s].gap_m + (0..n).map(|r| effects[s * n + r] * forces[r]).sum::<f64>();
            }
            for (s, gap_m) in gaps.iter().enumerate() {
                let all: f64 = effects[s * n..(s + 1) * n]
                    .iter()
                    .map(|effect| effect.abs())
                    .sum();
                if effects[s * n + s] > 0.0 {
                    forces[s] = (forces[s] - gap_m / all).max(0.0);
                }
            }
        }
        forces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_gives_back_what_the_net_itself_did_to_the_nodes() {
        // Nodes moved by the net, x = N P: the least squares are exact.
        let refit = Refit::new(8, Some([8, 8])).unwrap();
        let fit = refit.fit.as_ref().unwrap();
        let motion = |c: usize| {
            Vector3::new(
                libm::sin(c as f64),
                libm::cos(3.0 * c as f64),
                0.2 * c as f64,
            ) * 1e-3
        };
        let cube = transfinite(&refit.surface, [8; 3]).unwrap();
        let of_control = coordinates_of_controls(refit.surface.net().points(), &[]);
        let moved: Vec<Vector3> = cube
            .exterior
            .iter()
            .map(|(_, uv)| {
                weights(&refit.surface, &of_control, *uv)
                    .iter()
                    .map(|(c, w)| motion(*c) * *w)
                    .sum()
            })
            .collect();
        for (c, (fitted, rest)) in fit.fitted(&moved).iter().zip(&fit.coordinates).enumerate() {
            let miss = (fitted - rest - motion(c)).norm();
            assert!(miss < 1e-9, "coordinate {c} misses {miss} m");
        }
    }

    #[test]
    fn a_ball_beside_the_body_feels_nothing_and_one_in_it_is_pushed_out() {
        let mut refit = Refit::new(8, None).unwrap();
        assert_eq!(
            refit.step(&Point3::new(0.06, 0.003, 0.045)),
            Vector3::zeros()
        );
        // Later it may slip through: nodes are as far apart as the ball is wide.
        let mut largest_n = 0.0_f64;
        for k in 0..300 {
            largest_n = largest_n.max(
                refit
                    .step(&Point3::new(0.045 - 1e-4 * f64::from(k), 0.003, 0.045))
                    .x,
            );
        }
        assert!(largest_n > 0.01, "{largest_n} N");
    }
}
