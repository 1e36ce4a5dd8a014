//! Exact operations that keep a surface's shape or take a part of it: elevation, parts, Bézier
//! patches, reversal, affine maps, iso-curves.

use super::lines::Direction;
use super::{Curve, Surface, SurfaceError};
use crate::basis::{KnotError, KnotVector};
use crate::math::{Matrix3, Vector3};

impl Surface {
    /// Returns this surface with the degree raised by one in a direction; the shape is unchanged.
    ///
    /// # Errors
    /// The degree would pass [`MAX_DEGREE`](crate::basis::MAX_DEGREE).
    pub fn elevated(&self, direction: Direction) -> Result<Self, SurfaceError> {
        let change = self
            .knots(direction)
            .elevation()
            .map_err(|e| direction.refused(e))?;
        Ok(self.changed(direction, &change))
    }

    /// The part between two parameters of a direction, clamped there. In a periodic direction it
    /// may pass the seam: the end is then above the start by a period at most, or below it and
    /// meant a period on.
    ///
    /// # Errors
    /// A parameter that is not finite or outside the domain, or an empty part.
    pub fn part(&self, direction: Direction, start: f64, end: f64) -> Result<Self, SurfaceError> {
        let change = self
            .knots(direction)
            .restriction(start, end)
            .map_err(|e| direction.refused(e))?;
        Ok(self.changed(direction, &change))
    }

    /// The rectangle `u × v` of parameters as a surface of its own, clamped.
    ///
    /// # Errors
    /// As [`Surface::part`].
    pub fn sub_surface(&self, u: [f64; 2], v: [f64; 2]) -> Result<Self, SurfaceError> {
        self.part(Direction::U, u[0], u[1])?
            .part(Direction::V, v[0], v[1])
    }

    /// The parts before and after a parameter. A periodic direction is cut at the start of its
    /// period as well.
    ///
    /// # Errors
    /// A parameter that is not finite or not inside the domain.
    pub fn split(&self, direction: Direction, at: f64) -> Result<[Self; 2], SurfaceError> {
        let (start, end) = self.knots(direction).domain();
        if !(at > start && at < end) {
            return Err(direction.refused(KnotError::Outside {
                value: at,
                start,
                end,
            }));
        }
        Ok([
            self.part(direction, start, at)?,
            self.part(direction, at, end)?,
        ])
    }

    /// Returns this surface clamped in both directions; a periodic direction gets a seam.
    pub fn clamped(&self) -> Self {
        [Direction::U, Direction::V]
            .into_iter()
            .fold(self.clone(), |surface, direction| {
                surface.changed(direction, &surface.knots(direction).clamping())
            })
    }

    /// One Bézier surface for every pair of spans of positive length, u-major; each keeps its
    /// parameters.
    pub fn bezier_patches(&self) -> Vec<Self> {
        let spans = |knots: &KnotVector| -> Vec<[f64; 2]> {
            knots
                .spans()
                .map(|i| [knots.knots()[i], knots.knots()[i + 1]])
                .collect()
        };
        let (us, vs) = (spans(self.knots_u()), spans(self.knots_v()));
        let patch = |surface: &Self, direction, [start, end]: [f64; 2]| {
            surface
                .part(direction, start, end)
                .expect("a span lies in its domain")
        };
        us.iter()
            .map(|&u| patch(self, Direction::U, u))
            .flat_map(|strip| {
                vs.iter()
                    .map(|&v| patch(&strip, Direction::V, v))
                    .collect::<Vec<_>>()
            })
            .collect()
    }

    /// Returns this surface with the parameter of a direction reversed, over the original domain; the
    /// outward side is unchanged.
    pub fn reversed(&self, direction: Direction) -> Self {
        let knots = self.knots(direction);
        let (start, end) = knots.domain();
        let mirrored: Vec<f64> = knots
            .file_knots()
            .iter()
            .rev()
            .map(|&t| mirror(t, start, end))
            .collect();
        let reversed = if knots.is_periodic() {
            KnotVector::periodic(knots.degree(), mirrored)
        } else {
            KnotVector::new(knots.degree(), mirrored)
        };
        let reversed = reversed.expect("mirrored knots keep the rules");
        // A period's first point is the one whose window ends in the first span: mirrored, it
        // starts there.
        let turn = if knots.is_periodic() {
            knots.degree()
        } else {
            0
        };
        let flip = !self.flip_normal();
        self.with_lines(direction, reversed, |line| {
            let mut line: Vec<_> = line.iter().rev().copied().collect();
            line.rotate_right(turn);
            line
        })
        .with_flip_normal(flip)
    }

    /// `x ↦ matrix x + translation`, outward side kept when the matrix mirrors.
    ///
    /// # Errors
    /// A result that is not finite.
    pub fn affine(&self, matrix: &Matrix3, translation: &Vector3) -> Result<Self, SurfaceError> {
        let points = self
            .net()
            .points()
            .iter()
            .map(|point| matrix * point + translation)
            .collect();
        let net = super::ControlNet::new(self.net().rows(), self.net().columns(), points)?;
        let mut mapped = self.clone();
        *mapped.net_mut() = net;
        let mirrors = matrix.determinant() < 0.0;
        let flip = self.flip_normal();
        Ok(mapped.with_flip_normal(flip != mirrors))
    }

    /// The curve on which one parameter is constant; it runs along the other direction.
    ///
    /// # Errors
    /// A parameter that is not finite or outside the domain.
    pub fn iso_curve(&self, constant: Direction, parameter: f64) -> Result<Curve, SurfaceError> {
        let knots = self.knots(constant);
        let window = knots.window(knots.checked(parameter).map_err(|e| constant.refused(e))?);
        let entries = window
            .values()
            .iter()
            .enumerate()
            .map(|(k, &value)| ((window.first + k) % knots.count(), value));
        let points: Vec<_> = self
            .lines(constant)
            .iter()
            .map(|line| super::lines::combine(entries.clone(), line))
            .collect();
        let along = match constant {
            Direction::U => self.knots_v(),
            Direction::V => self.knots_u(),
        };
        Ok(Curve::from_line(
            along.clone(),
            &points,
            self.weights().is_some(),
        ))
    }
}

/// `start + end − t`, exact at the ends.
fn mirror(t: f64, start: f64, end: f64) -> f64 {
    match t {
        t if t == start => end,
        t if t == end => start,
        t => start + (end - t),
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::fifty_surfaces;
    use super::*;
    use crate::basis::KnotKind;
    use crate::basis::testing::Random;
    use crate::math::Point3;

    const BOTH: [Direction; 2] = [Direction::U, Direction::V];

    /// Parameters inside spans: at disjoined knots the side matters.
    fn inside(random: &mut Random, surface: &Surface) -> Vec<(f64, f64)> {
        let mut one = |knots: &KnotVector| -> Vec<f64> {
            let t = knots.knots();
            knots
                .spans()
                .map(|i| t[i] + random.float(0.05, 0.95) * (t[i + 1] - t[i]))
                .collect()
        };
        let (us, vs) = (one(surface.knots_u()), one(surface.knots_v()));
        us.iter()
            .flat_map(|&u| vs.iter().map(move |&v| (u, v)))
            .collect()
    }

    fn assert_same(
        a: &Surface,
        b: &Surface,
        at: &[(f64, f64)],
        map: impl Fn(f64, f64) -> (f64, f64),
        what: &str,
    ) {
        for &(u, v) in at {
            let (x, y) = map(u, v);
            let error = (a.point(u, v) - b.point(x, y)).norm();
            assert!(
                error <= 1e-12 * a.size(),
                "{what} moved {a:?} by {error} at ({u}, {v})"
            );
        }
    }

    #[test]
    fn elevation_and_clamping_leave_every_kind_of_surface_where_it_is() {
        let mut random = Random(61);
        for surface in fifty_surfaces(61) {
            let at = inside(&mut random, &surface);
            let higher = surface
                .elevated(Direction::U)
                .unwrap()
                .elevated(Direction::V)
                .unwrap();
            assert_same(&surface, &higher, &at, |u, v| (u, v), "elevation");
            let clamped = surface.clamped();
            assert!(
                BOTH.iter()
                    .all(|d| clamped.knots(*d).kind() == KnotKind::Clamped)
            );
            assert_same(&surface, &clamped, &at, |u, v| (u, v), "clamping");
        }
    }

    #[test]
    fn reversal_mirrors_the_parameters_and_keeps_the_outward_side() {
        let mut random = Random(62);
        for surface in fifty_surfaces(62) {
            let at = inside(&mut random, &surface);
            let ((a, b), (c, d)) = (surface.knots_u().domain(), surface.knots_v().domain());
            assert_same(
                &surface,
                &surface.reversed(Direction::U),
                &at,
                |u, v| (a + b - u, v),
                "reversal in u",
            );
            assert_same(
                &surface,
                &surface.reversed(Direction::V),
                &at,
                |u, v| (u, c + d - v),
                "reversal in v",
            );
        }
        for name in ["teardrop", "sphere", "torus"] {
            let surface = builtin(name, None, None).unwrap();
            let reversed = surface.reversed(Direction::U);
            assert!(
                (reversed.volume() / surface.volume() - 1.0).abs() < 1e-13,
                "{name}"
            );
            assert_eq!(
                reversed.topology().closing,
                surface.topology().closing,
                "{name}"
            );
        }
    }

    #[test]
    fn pieces_put_together_are_the_surface() {
        let mut random = Random(63);
        for surface in fifty_surfaces(63) {
            let at = inside(&mut random, &surface);
            let patches = surface.bezier_patches();
            let spans = |d: Direction| surface.knots(d).spans().count();
            assert_eq!(patches.len(), spans(Direction::U) * spans(Direction::V));
            for &(u, v) in &at {
                let holds = |k: &KnotVector, x: f64| k.domain().0 <= x && x <= k.domain().1;
                let patch = patches
                    .iter()
                    .find(|p| holds(p.knots_u(), u) && holds(p.knots_v(), v))
                    .unwrap();
                let counts = [patch.net().rows(), patch.net().columns()];
                assert_eq!(
                    counts,
                    [
                        surface.knots_u().degree() + 1,
                        surface.knots_v().degree() + 1
                    ]
                );
                assert!((patch.point(u, v) - surface.point(u, v)).norm() <= 1e-12 * surface.size());
            }
            let (start, end) = surface.knots_u().domain();
            let cut = random.float(start, end);
            let [before, after] = surface.split(Direction::U, cut).unwrap();
            for &(u, v) in &at {
                let half = if u < cut { &before } else { &after };
                assert!((half.point(u, v) - surface.point(u, v)).norm() <= 1e-12 * surface.size());
            }
        }
    }

    #[test]
    fn a_part_of_a_torus_may_pass_its_seam() {
        let torus = builtin("torus", None, None).unwrap();
        let part = torus.sub_surface([0.75, 1.25], [0.9, 0.1]).unwrap();
        let ((a, b), (c, d)) = (part.knots_u().domain(), part.knots_v().domain());
        assert_eq!((a, b, c), (0.75, 1.25, 0.9));
        assert!((d - 1.1).abs() < 1e-15);
        for (u, v) in [(0.75, 0.9), (0.99, 1.0), (1.0, 1.0), (1.2, 1.05), (b, d)] {
            assert!((part.point(u, v) - torus.point(u, v)).norm() < 1e-15);
        }
    }

    #[test]
    fn poles_and_seams_stay_exact() {
        for name in ["teardrop", "sphere"] {
            let surface = builtin(name, None, None).unwrap();
            for changed in [
                surface
                    .elevated(Direction::U)
                    .unwrap()
                    .elevated(Direction::V)
                    .unwrap(),
                surface.split(Direction::V, 0.37).unwrap()[0].clone(),
            ] {
                let net = changed.net();
                assert!(
                    (0..net.columns()).all(|j| net.at(0, j) == net.at(net.rows() - 1, j)),
                    "{name}: seam"
                );
                assert!(
                    (0..net.rows()).all(|i| net.at(i, 0) == net.at(0, 0)),
                    "{name}: pole"
                );
            }
        }
    }

    #[test]
    fn affine_maps_move_points_as_the_net_and_turn_normals_out() {
        let mirror = Matrix3::new(-1.0, 0.2, 0.0, 0.0, 1.5, 0.1, 0.3, 0.0, 0.8);
        let shift = Vector3::new(0.1, -0.2, 0.3);
        for name in ["teardrop", "sphere", "torus"] {
            let surface = builtin(name, None, None).unwrap();
            let mapped = surface.affine(&mirror, &shift).unwrap();
            let error = mapped.volume() / (surface.volume() * mirror.determinant().abs()) - 1.0;
            assert!(error.abs() < 1e-11, "{name}: volume off by {error}");
            let wanted: Point3 = mirror * surface.point(0.3, 0.6) + shift;
            assert!((mapped.point(0.3, 0.6) - wanted).norm() < 1e-14);
        }
        let sheet = builtin("sheet", None, None).unwrap();
        assert!(sheet.affine(&(mirror * f64::MAX), &shift).is_err());
    }

    #[test]
    fn iso_curves_run_on_the_surface() {
        let mut random = Random(64);
        for surface in fifty_surfaces(64) {
            for &(u, v) in inside(&mut random, &surface).iter().take(6) {
                let (along_v, along_u) = (
                    surface.iso_curve(Direction::U, u).unwrap(),
                    surface.iso_curve(Direction::V, v).unwrap(),
                );
                let frame = surface.frame(u, v);
                for (curve, at, tangent) in [(along_v, v, frame.dv), (along_u, u, frame.du)] {
                    let (point, derivative) = curve.point_and_tangent(at);
                    assert!((point - frame.point).norm() <= 1e-12 * surface.size());
                    assert!(
                        (derivative - tangent).norm() <= 1e-10 * tangent.norm().max(surface.size())
                    );
                }
            }
        }
    }

    #[test]
    fn parts_outside_are_refused() {
        let sheet = builtin("sheet", None, None).unwrap();
        let error = sheet.part(Direction::V, 0.2, 1.2).unwrap_err();
        assert_eq!(
            error.to_string(),
            "knots in v: 1.2 is outside the domain 0 ..= 1"
        );
        assert!(sheet.split(Direction::U, 0.0).is_err());
        assert!(sheet.split(Direction::U, f64::NAN).is_err());
        assert!(sheet.iso_curve(Direction::U, -0.1).is_err());
    }
}
