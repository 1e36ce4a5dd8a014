//! Closed surfaces near closed shells of triangles, and how far a surface and a shell are apart.
//!
//! Corners alone tell too little: a box with rounded edges has none on its sides. So points are
//! spread evenly over the area, and get their first parameters from [`SphereMap`]: rings round
//! the longest axis, even along it, circles round the poles. Rounds of [`super::cloud_fit`] follow.

use super::cloud_fit::{CloudSpec, Problem, check_size};
use super::grid_fit::{FitError, Fitted};
use super::shell::Shell;
use super::sphere_map::{SphereMap, longest_axis};
use super::{ClosestSolver, ControlNet, Surface, SurfaceError};
use crate::basis::KnotVector;
use crate::math::Point3;
use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::TriMesh;

/// Points over the area for each control point, and how many at least and at most.
const POINTS_PER_CONTROL: usize = 12;
const FEWEST_POINTS: usize = 3_000;
const MOST_POINTS: usize = 30_000;

/// Edges of the shell that is mapped to the sphere, by the root of its area.
const EDGE: f64 = 1.0 / 30.0;

/// Rounds of new parameters at most.
const MOST_ROUNDS: usize = 2;

/// Points over each of the two when they are compared.
const COMPARED: usize = 10_000;

/// Distances between a surface and a shell, measured over the area of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Points spread over the shell and over the surface.
    pub points: usize,
    /// Root mean square of their distances to the other, m.
    pub rms_m: f64,
    /// Largest distance of the shell's points from the surface, m.
    pub from_shell_m: f64,
    /// Largest distance of the surface's points from the shell, m.
    pub from_surface_m: f64,
}

impl Apart {
    /// The larger of the two largest distances, m.
    pub fn largest_m(&self) -> f64 {
        self.from_shell_m.max(self.from_surface_m)
    }
}

impl Surface {
    /// The closed surface with two poles near a closed shell; `spec.closed` is not asked. The errors
    /// are distances of points spread over the shell from the surface. Always the same for the
    /// same shell.
    ///
    /// # Errors
    /// A shell of several parts, with open edges or with handles; degree, counts or smoothing out of
    /// range.
    pub fn fitted_to_shell(shell: &Shell, spec: &CloudSpec) -> Result<Fitted, FitError> {
        let census = shell.census();
        if census.components != 1 {
            return Err(FitError::Components {
                components: census.components,
            });
        }
        if !census.is_closed() {
            return Err(FitError::OpenShell {
                edges: census.open_edges,
            });
        }
        if census.genus > 0 {
            return Err(FitError::Handles {
                genus: census.genus,
            });
        }
        let count = spec.counts[0].saturating_mul(spec.counts[1]);
        let wanted = (POINTS_PER_CONTROL.saturating_mul(count)).clamp(FEWEST_POINTS, MOST_POINTS);
        check_size(spec, wanted)?;
        if count > wanted {
            return Err(FitError::TooFew {
                direction: "all",
                points: wanted,
                count,
            });
        }
        let bad = |direction| move |source| SurfaceError::Knots { direction, source };
        let knots_u =
            KnotVector::periodic_uniform(spec.degree[0], spec.counts[0]).map_err(bad('u'))?;
        let knots_v =
            KnotVector::clamped_uniform(spec.degree[1], spec.counts[1]).map_err(bad('v'))?;
        let net = ControlNet::from_checked(
            knots_u.count(),
            knots_v.count(),
            vec![Point3::origin(); knots_u.count() * knots_v.count()],
        );
        let problem = Problem::new(Self::from_checked(knots_u, knots_v, net, None), true);
        let fine = shell.with_edges_up_to(EDGE * census.area_m2.sqrt());
        let map = SphereMap::new(&fine, &longest_axis(&fine));
        let places = fine.places(wanted);
        let points: Vec<Point3> = places.iter().map(|&place| fine.point(place)).collect();
        let parameters = places
            .iter()
            .map(|&(triangle, weights)| map.parameters(fine.triangles()[triangle], weights))
            .collect();
        // More rounds come nearer at few places and fold the net at others.
        let spec = CloudSpec {
            rounds: spec.rounds.min(MOST_ROUNDS),
            ..*spec
        };
        let mut fitted = problem.rounds(&points, parameters, &spec, spec.smoothing)?;
        fitted.surface = fitted.surface.oriented_outward();
        Ok(fitted)
    }

    /// How far this surface and a shell are apart, over the area of both.
    pub fn apart_from(&self, shell: &Shell) -> Apart {
        let mut solver = ClosestSolver::new(self);
        let (mut squares, mut from_shell_m, mut from_surface_m) = (0.0, 0.0_f64, 0.0_f64);
        let there = shell.places(COMPARED);
        for &place in &there {
            let distance = solver.closest(self, &shell.point(place)).distance.abs();
            squares += distance * distance;
            from_shell_m = from_shell_m.max(distance);
        }
        let mut points = there.len();
        // The surface's area by its triangles, whose places are then put onto it: chords are short.
        let own = self
            .tessellated([4; 2])
            .ok()
            .and_then(|mesh| Shell::of(&mesh));
        let corners = shell.points().iter().map(|p| DVec3::new(p.x, p.y, p.z));
        let triangles = TriMesh::new(corners.collect(), shell.triangles().to_vec());
        if let (Some(own), Ok(triangles)) = (own, triangles) {
            for place in own.places(COMPARED) {
                let foot = solver.closest(self, &own.point(place)).point;
                let foot = DVec3::new(foot.x, foot.y, foot.z);
                let distance = (triangles.project_local_point(foot, false).point - foot).length();
                squares += distance * distance;
                from_surface_m = from_surface_m.max(distance);
                points += 1;
            }
        }
        Apart {
            points,
            rms_m: (squares / points.max(1) as f64).sqrt(),
            from_shell_m,
            from_surface_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Mesh, builtin};
    use super::*;
    use crate::math::Vector3;

    fn closed(net: usize) -> CloudSpec {
        CloudSpec {
            closed: true,
            counts: [net; 2],
            ..CloudSpec::default()
        }
    }

    /// Twelve triangles, corners only at the corners.
    fn cube(edge: f64) -> Shell {
        let corner =
            |k: usize| Point3::new((k & 1) as f64, ((k >> 1) & 1) as f64, (k >> 2) as f64) * edge;
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles = faces
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        let mesh = Mesh::from_triangles((0..8).map(corner).collect(), triangles).unwrap();
        Shell::of(&mesh).unwrap()
    }

    /// A body of revolution: radii and heights from pole to pole, m.
    fn turned(profile: &[(f64, f64)]) -> Shell {
        let around = 40;
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for &(radius, height) in profile {
            for k in 0..around {
                let angle = std::f64::consts::TAU * f64::from(k) / f64::from(around);
                let (s, c) = libm::sincos(angle);
                points.push(Point3::new(radius * c, radius * s, height));
            }
        }
        let around = around as u32;
        for ring in 0..profile.len() as u32 - 1 {
            for k in 0..around {
                let [a, b] = [k, (k + 1) % around].map(|k| ring * around + k);
                triangles.extend([[a, b, b + around], [a, b + around, a + around]]);
            }
        }
        Shell::of(&Mesh::from_triangles(points, triangles).unwrap()).unwrap()
    }

    /// Least cosine between the normals at neighbouring places round both poles.
    fn least_turn_at_poles(surface: &Surface) -> f64 {
        let mut least = 1.0_f64;
        for v in [0.002, 0.01, 0.03, 0.97, 0.99, 0.998] {
            for k in 0..48 {
                let [a, b] = [k, k + 1].map(|k| surface.normal(f64::from(k % 48) / 48.0, v));
                least = least.min(a.dot(&b));
            }
        }
        least
    }

    // Only the corners have points: measured there, a fit that bulges to twice the volume is exact.
    #[test]
    fn a_cube_is_fitted_over_its_sides_and_not_only_at_its_corners() {
        let cube = cube(0.04);
        let fitted = Surface::fitted_to_shell(&cube, &closed(24)).unwrap();
        let apart = fitted.surface.apart_from(&cube);
        println!("{apart:?}");
        // Its edges are rounded by the spans of the net.
        assert!(apart.rms_m < 4e-4 && apart.largest_m() < 3e-3, "{apart:?}");
        assert!((fitted.surface.volume() / 0.04_f64.powi(3) - 1.0).abs() < 0.02);
        assert!(least_turn_at_poles(&fitted.surface) > 0.5);
    }

    #[test]
    fn a_teardrop_and_a_vase_are_fitted_with_poles_that_do_not_fold() {
        let drop = builtin("teardrop", None, None).unwrap();
        let drop = Shell::of(&drop.tessellated([6; 2]).unwrap()).unwrap();
        // Not seen whole from its middle: the flow parametrises it.
        let vase = turned(&[
            (0.0, 0.0),
            (0.010, 0.001),
            (0.020, 0.004),
            (0.027, 0.012),
            (0.028, 0.022),
            (0.024, 0.032),
            (0.014, 0.040),
            (0.008, 0.050),
            (0.008, 0.062),
            (0.013, 0.072),
            (0.018, 0.078),
            (0.012, 0.082),
            (0.0, 0.083),
        ]);
        for (name, shell) in [("teardrop", drop), ("vase", vase)] {
            let fitted = Surface::fitted_to_shell(&shell, &closed(14)).unwrap();
            let (apart, census) = (fitted.surface.apart_from(&shell), shell.census());
            println!("{name}: {apart:?} of {census:?}");
            assert!(apart.rms_m < 4e-3 * census.size_m, "{name}: {apart:?}");
            assert!(
                (fitted.surface.volume() / census.volume_m3 - 1.0).abs() < 0.02,
                "{name}"
            );
            assert!(least_turn_at_poles(&fitted.surface) > 0.0, "{name}");
        }
    }

    #[test]
    fn shells_that_such_a_surface_cannot_be_are_refused() {
        let of = |name| {
            let surface = builtin(name, None, None).unwrap();
            Shell::of(&surface.tessellated([4; 2]).unwrap()).unwrap()
        };
        let refused = |shell: &Shell| Surface::fitted_to_shell(shell, &closed(12)).unwrap_err();
        assert_eq!(refused(&of("torus")), FitError::Handles { genus: 1 });
        assert!(matches!(refused(&of("sheet")), FitError::OpenShell { .. }));
        let one = of("sphere").points().to_vec();
        let far = one.iter().map(|p| p + Vector3::x()).collect::<Vec<_>>();
        let shift = one.len() as u32;
        let triangles = of("sphere").triangles().to_vec();
        let moved = triangles.iter().map(|t| t.map(|k| k + shift));
        let both = triangles.iter().copied().chain(moved).collect();
        let mesh = Mesh::from_triangles([one, far].concat(), both).unwrap();
        let pair = Shell::of(&mesh).unwrap();
        assert_eq!(refused(&pair), FitError::Components { components: 2 });
        let spec = CloudSpec {
            degree: [15; 2],
            counts: [200; 2],
            ..closed(8)
        };
        assert!(Surface::fitted_to_shell(&of("sphere"), &spec).is_err());
    }

    // The distance from the surface's side finds what the shell's points do not see.
    #[test]
    fn distances_are_measured_from_both_sides() {
        let ball = builtin("sphere", None, Some(0.1)).unwrap();
        let shell = Shell::of(&ball.tessellated([8; 2]).unwrap()).unwrap();
        let near = ball.apart_from(&shell);
        assert!(near.largest_m() < 1e-3, "{near:?}");
        let half: Vec<[u32; 3]> = shell
            .triangles()
            .iter()
            .filter(|t| t.iter().all(|&k| shell.points()[k as usize].z > 0.0))
            .copied()
            .collect();
        let mesh = Mesh::from_triangles(shell.points().to_vec(), half).unwrap();
        let apart = ball.apart_from(&Shell::of(&mesh).unwrap());
        assert!(apart.from_shell_m < 1e-3, "{apart:?}");
        assert!(apart.from_surface_m > 0.3 * ball.size(), "{apart:?}");
    }
}
