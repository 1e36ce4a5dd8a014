//! Contact queries allocate nothing once their scratch is made, and answer the same twice.

use crate::counting::allocations;
use palpate_geometry::contact::broad::BroadPhase;
use palpate_geometry::contact::exact::{ExactScratch, ball, plane};
use palpate_geometry::contact::implicit::{ImplicitShape, ImplicitSolver};
use palpate_geometry::contact::mesh::{MeshSolver, MeshTool};
use palpate_geometry::contact::{ContactSet, Reach, swept};
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3};
use palpate_geometry::skin::{Skin, SkinSide, SkinSolver};
use palpate_geometry::surface::{Bounds, ClosestSolver, Surface, builtin};

/// Poses around and inside a body, a golden spiral of them.
fn pose(surface: &Surface, k: usize) -> Pose {
    let t = k as f64 * 0.618_033_988_749_894_8;
    let (u, v) = (t.fract(), (t * 1.7).fract());
    let away =
        Vector3::new((7.0 * t).sin(), (5.0 * t).cos(), (3.0 * t).sin()) * 0.1 * surface.size();
    Pose::from_parts(
        (surface.point(u, v).coords + away).into(),
        Rotation::from_euler_angles(t, 2.0 * t, 3.0 * t),
    )
}

/// Runs a query over many poses twice: no allocation, the same answers, some of them contacts.
fn run(name: &str, surface: &Surface, poses: usize, mut query: impl FnMut(&Pose, &mut ContactSet)) {
    let poses: Vec<Pose> = (0..poses).map(|k| pose(surface, k)).collect();
    let mut answers: Vec<ContactSet> = poses.iter().map(|_| ContactSet::new()).collect();
    let count = allocations(|| {
        poses
            .iter()
            .zip(&mut answers)
            .for_each(|(pose, out)| query(pose, out))
    });
    assert_eq!(count, 0, "{name} allocates");
    let mut again = ContactSet::new();
    for (pose, answer) in poses.iter().zip(&answers) {
        query(pose, &mut again);
        assert_eq!(again, *answer, "{name}: another answer to the same query");
    }
    assert!(
        answers.iter().any(|set| set.deepest().is_some()),
        "{name} never touches"
    );
}

fn tetrahedron(size: f64) -> MeshTool {
    let corners = [
        (1.0, 1.0, 1.0),
        (1.0, -1.0, -1.0),
        (-1.0, 1.0, -1.0),
        (-1.0, -1.0, 1.0),
    ];
    let points = corners.map(|(x, y, z)| Point3::new(x, y, z) * size);
    MeshTool::new(&points, &[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]).expect("a solid")
}

#[test]
fn contact_queries_allocate_nothing_and_repeat_themselves() {
    let bodies = [
        builtin("teardrop", Some([12, 12]), None),
        builtin("torus", None, None),
        builtin("sheet", None, None),
    ];
    for body in bodies.map(|b| b.expect("a builtin")) {
        let (size, mut solver) = (body.size(), ClosestSolver::new(&body));
        let reach = Reach {
            margin_m: 0.01 * size,
            below: false,
            closing_m: 0.0,
        };
        let mut scratch = ExactScratch::new(&body, &mut solver);
        run("ball", &body, 300, |p, out| {
            let centre = p * Point3::origin();
            ball::contacts(
                &body,
                &mut solver,
                &centre,
                0.1 * size,
                &reach,
                &mut scratch,
                out,
            );
        });
        run("plane", &body, 300, |p, out| {
            let (point, normal) = (p * Point3::origin(), p * Vector3::z());
            plane::contacts(
                &body,
                &mut solver,
                &point,
                &normal,
                &reach,
                &mut scratch,
                out,
            );
        });
        let tool = ImplicitShape::Box {
            half_extents_m: [0.1 * size, 0.05 * size, 0.2 * size],
        };
        let tool = tool.compile().expect("a box");
        let skin = Skin::from(body.clone());
        let mut closest = SkinSolver::new(&skin);
        let mut implicit = ImplicitSolver::new(&skin);
        run("implicit", &body, 12, |p, out| {
            implicit.contacts(
                SkinSide {
                    skin: &skin,
                    solver: &mut closest,
                },
                &tool,
                p,
                &reach,
                &[],
                out,
            )
        });
        let tool = tetrahedron(0.1 * size);
        let mut mesh = MeshSolver::new(&skin, &tool);
        run("mesh", &body, 12, |p, out| {
            mesh.contacts(
                SkinSide {
                    skin: &skin,
                    solver: &mut closest,
                },
                &tool,
                p,
                &reach,
                &[],
                out,
            )
        });
        let sweeps = allocations(|| {
            for k in 0..30 {
                let (a, b) = (
                    pose(&body, k) * Point3::origin(),
                    pose(&body, k + 7) * Point3::origin(),
                );
                std::hint::black_box(swept::ball(&body, &mut solver, &a, &b, 0.02 * size));
                std::hint::black_box(swept::plane(
                    &body,
                    &mut solver,
                    [a, b],
                    [Vector3::z(), Vector3::x()],
                ));
            }
        });
        assert_eq!(sweeps, 0, "a sweep allocates");
    }
}

#[test]
fn the_broad_phase_allocates_nothing() {
    let mut broad = BroadPhase::new(64, 0.05);
    let count = allocations(|| {
        for step in 0..500_u32 {
            for k in 0..64_u32 {
                if (k + step).is_multiple_of(13) {
                    broad.remove(k);
                    continue;
                }
                let t = f64::from(k) + 0.01 * f64::from(step);
                let at = Point3::new((3.0 * t).sin(), (5.0 * t).cos(), (7.0 * t).sin());
                let half = Vector3::repeat(0.1);
                broad.set(
                    k,
                    &Bounds {
                        min: at - half,
                        max: at + half,
                    },
                    &Vector3::zeros(),
                );
            }
            std::hint::black_box(broad.pairs().len());
        }
    });
    assert_eq!(count, 0);
}
