//! Contacts of tools with edges and tips.
//!
//! Where a smooth surface meets a smooth tool deepest, their normals agree. At a tip, an edge or a
//! corner the tool has no normal of its own: a query answers with that of a side, and with another
//! in the next tick. The surface has one, and without friction it bears no other force: the contact
//! takes it, and its depth along it. The foot of a tip is exact; that of an edge is as good as the
//! query.

use palpate_geometry::contact::{Contact, ContactSet};
use palpate_geometry::math::{Point3, Pose};
use palpate_geometry::surface::{ClosestSolver, Surface};

/// Normals whose angle has at least this cosine (0.8 degrees) agree: what queries leave over is
/// less, and so are the angles that matter to a hand.
const AGREE: f64 = 1.0 - 1e-4;
/// Cosine below which a side is so steep that the tool does not end along the surface's normal
/// within sight.
const STEEP: f64 = 0.05;
/// A tip whose foot is nearer than this to a contact, relative to the body's size, is what touches
/// there.
const NEAR: f64 = 1e-3;

/// A body as tips see it.
pub(super) struct Faced<'a> {
    pub surface: &'a Surface,
    pub solver: &'a mut ClosestSolver,
    /// A box around it.
    pub bounds: (Point3, Point3),
    pub size_m: f64,
    /// Seen from where its normals point away from.
    pub below: bool,
}

/// Turns the contacts of a tool at `pose`, with `tips` in its frame, to the surface's normals where
/// they are deepest points of a smooth piece of it; adds tips that just touch, where the overlap
/// may be too small for a query.
pub(super) fn face_surface(
    set: &mut ContactSet,
    body: Faced<'_>,
    pose: &Pose,
    tips: &[Point3],
    margin_m: f64,
) {
    let Faced {
        surface,
        solver,
        bounds,
        size_m,
        below,
    } = body;
    let side = if below { -1.0 } else { 1.0 };
    set.turn(|contact| {
        if !is_smooth_at(surface, contact.u, contact.v) {
            return None;
        }
        let normal = surface.normal(contact.u, contact.v) * side;
        let cosine = normal.dot(&contact.normal);
        let sided = cosine > STEEP && cosine < AGREE;
        if !sided {
            return None;
        }
        let near = |tip: &&Point3| {
            (pose * **tip - contact.on_body).norm() < NEAR * size_m + contact.depth_m.abs() / cosine
        };
        for tip in tips.iter().filter(near) {
            let tip = pose * tip;
            let foot = solver.closest(surface, &tip);
            if (foot.point - contact.on_body).norm() < NEAR * size_m
                && is_smooth_at(surface, foot.u, foot.v)
            {
                let (normal, depth_m) = (foot.normal * side, -foot.signed_distance * side);
                return Some(Contact {
                    u: foot.u,
                    v: foot.v,
                    on_body: foot.point,
                    normal,
                    depth_m,
                    ..*contact
                });
            }
        }
        Some(Contact {
            normal,
            depth_m: contact.depth_m / cosine,
            ..*contact
        })
    });
    for tip in tips {
        let tip = pose * tip;
        if (0..3).any(|c| tip[c] < bounds.0[c] - margin_m || tip[c] > bounds.1[c] + margin_m) {
            continue;
        }
        let foot = solver.closest(surface, &tip);
        let known = |contact: &Contact| (contact.on_body - foot.point).norm() < NEAR * size_m;
        if foot.distance <= margin_m
            && is_smooth_at(surface, foot.u, foot.v)
            && !set.contacts().iter().any(known)
        {
            let (normal, depth_m) = (foot.normal * side, -foot.signed_distance * side);
            let on_tool = foot.point - normal * depth_m;
            set.push(Contact {
                u: foot.u,
                v: foot.v,
                on_body: foot.point,
                on_tool,
                normal,
                depth_m,
                tool_uv: None,
            });
        }
    }
}

/// Inside of the surface or on a seam, and on no crease.
fn is_smooth_at(surface: &Surface, u: f64, v: f64) -> bool {
    [(surface.knots_u(), u), (surface.knots_v(), v)]
        .into_iter()
        .all(|(knots, t)| {
            let (start, end) = knots.domain();
            let inside = knots.is_periodic() || (t > start && t < end);
            inside && knots.multiplicity(t) < knots.degree()
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::contact::Reach;
    use palpate_geometry::contact::implicit::{ImplicitShape, ImplicitSolver};
    use palpate_geometry::math::Vector3;
    use palpate_geometry::surface::builtin;

    /// Contacts of a tool with a flat sheet, turned.
    fn faced(shape: &ImplicitShape, pose: &Pose) -> ContactSet {
        let sheet = builtin("sheet", Some([7, 7]), Some(0.1)).unwrap();
        let mut closest = ClosestSolver::new(&sheet);
        let mut solver = ImplicitSolver::new(&sheet, &mut closest);
        let (tool, mut set) = (shape.compile().unwrap(), ContactSet::new());
        let reach = Reach {
            margin_m: 1e-5,
            below: false,
        };
        solver.contacts(&sheet, &mut closest, &tool, pose, &reach, &mut set);
        let bounds = (Point3::new(-0.05, -0.05, 0.0), Point3::new(0.05, 0.05, 0.0));
        let body = Faced {
            surface: &sheet,
            solver: &mut closest,
            bounds,
            size_m: 0.1,
            below: false,
        };
        face_surface(&mut set, body, pose, tool.tips(), reach.margin_m);
        set
    }

    #[test]
    fn a_tip_presses_along_the_surface_as_deep_as_it_is() {
        let cone = ImplicitShape::Cone {
            half_angle_rad: 0.5,
            height_m: 0.05,
        };
        for (x, y, depth) in [
            (0.0, 0.0, 0.003),
            (0.0123, -0.02, 1e-3),
            (-0.031, 0.004, 1e-6),
            (0.01, 0.01, -5e-6),
        ] {
            let set = faced(&cone, &Pose::translation(x, y, -depth));
            let [contact] = set.contacts() else {
                panic!("{x} {y} {depth}: {:?}", set.contacts())
            };
            assert!(
                (contact.normal - Vector3::z()).norm() < 1e-12,
                "{}",
                contact.normal
            );
            assert!(
                (contact.depth_m - depth).abs() < 1e-15,
                "{} is not {depth}",
                contact.depth_m
            );
            assert!((contact.on_body - Point3::new(x, y, 0.0)).norm() < 1e-12);
            assert!(
                (contact.on_body - contact.on_tool - contact.normal * contact.depth_m).norm()
                    < 1e-15
            );
        }
    }

    #[test]
    fn an_edge_presses_along_the_surface_and_a_side_as_before() {
        // A box on its edge, turned by 30 degrees.
        let half = 0.01;
        let cube = ImplicitShape::Box {
            half_extents_m: [half; 3],
        };
        let angle = std::f64::consts::FRAC_PI_6;
        let turn = nalgebra::Isometry3::rotation(Vector3::y() * angle);
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let low = half * (sine + cosine);
        let pose: Pose = Pose::translation(0.0, 0.0, low - 0.002) * Pose::from(turn);
        let set = faced(&cube, &pose);
        let deepest = set.deepest().unwrap();
        assert!(
            (deepest.normal - Vector3::z()).norm() < 1e-12,
            "{}",
            deepest.normal
        );
        // Deepest is where both sides are as far: beside the foot of the edge by s, (cos - sin) /
        // (cos + sin) of its depth.
        let aside = (cosine - sine) / (cosine + sine);
        let expected = 0.002 * (1.0 - aside * sine / cosine);
        assert!(
            (deepest.depth_m - expected).abs() < 1e-9,
            "{} is not {expected}",
            deepest.depth_m
        );
        let flat = faced(&cube, &Pose::translation(0.0, 0.0, half - 0.002));
        let deepest = flat.deepest().unwrap();
        assert_eq!(deepest.depth_m, 0.002);
        assert!((deepest.normal - Vector3::z()).norm() < 1e-15);
    }
}
