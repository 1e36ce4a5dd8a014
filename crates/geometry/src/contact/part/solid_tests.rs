//! Solids against parts: as they would be as balls, as they are in closed form, and the other way round.

use crate::contact::dispatch::{BodyShape, Method, Narrow, Party};
use crate::contact::implicit::ImplicitShape;
use crate::contact::mesh::MeshTool;
use crate::contact::{Contact, Reach, SurfaceShape, ToolPoint, ToolShape};
use crate::exchange::step::{PartPick, read_part};
use crate::math::{Point3, Pose, Random, Vector3};
use crate::part::hand::{prism, rounded};
use crate::part::{Brep, Part};
use crate::skin::{PlacedPart, Skin, SkinSide, SkinSolver};
use crate::surface::{Surface, builtin};
use std::sync::Arc;

const BOX: [[f64; 2]; 4] = [[0.0, 0.0], [0.06, 0.0], [0.06, 0.04], [0.0, 0.04]];
const REACH: Reach = Reach {
    margin_m: 1e-4,
    below: false,
    closing_m: 0.0,
};

fn pose(random: &mut Random) -> Pose {
    let [x, y, z] = random.vector().into();
    Pose::translation(0.1 * x, 0.1 * y, 0.1 * z) * random.rotation()
}

fn part(brep: &Brep) -> Arc<Part> {
    Arc::new(Part::new(brep).expect("a part"))
}

fn part_of_file(name: &str) -> Arc<Part> {
    let path = format!(
        "{}/tests/data/parts/{name}.step",
        env!("CARGO_MANIFEST_DIR")
    );
    let bytes = std::fs::read(path).expect("the file");
    let read = read_part(&bytes, &PartPick::default()).expect("a part");
    part(&read.brep)
}

/// A body, and what it is to surfaces and other parts.
struct Stand {
    skin: Skin,
    solver: SkinSolver,
    solid: Option<Arc<MeshTool>>,
}

impl Stand {
    fn of_part(part: &Arc<Part>, pose: Pose) -> Self {
        let skin = Skin::Part(PlacedPart::new(part.clone(), pose));
        Self {
            solver: SkinSolver::new(&skin),
            solid: MeshTool::of_part(part.clone()).ok().map(Arc::new),
            skin,
        }
    }

    fn of_surface(surface: Surface) -> Self {
        let skin = Skin::from(surface);
        Self {
            solver: SkinSolver::new(&skin),
            solid: None,
            skin,
        }
    }

    fn shape(&self) -> BodyShape<'_> {
        BodyShape {
            skin: &self.skin,
            solid: self.solid.as_ref(),
        }
    }

    fn side(&mut self) -> SkinSide<'_> {
        SkinSide {
            skin: &self.skin,
            solver: &mut self.solver,
        }
    }

    fn touch(&mut self, shape: &ToolShape, pose: &Pose) -> Vec<Contact> {
        let party = Party::Tool(shape);
        let mut narrow = Narrow::new(self.shape(), party, Method::Exact).expect("a pair");
        narrow.contacts(shape, pose, self.side(), REACH);
        self.check(narrow.set.contacts());
        narrow.set.contacts().to_vec()
    }

    fn check(&self, contacts: &[Contact]) {
        for contact in contacts {
            let apart = contact.on_body - contact.on_tool - contact.normal * contact.depth_m;
            assert!(apart.norm() < 1e-14, "{contact:?}");
            let gap_m = self.skin.part().map_or(0.0, |placed| placed.part().gap_m());
            let off = (self.skin.point(contact.u, contact.v) - contact.on_body).norm();
            let most = 1e-9 * self.skin.size_m() + 2.0 * gap_m;
            assert!(off <= most, "{off:e} m off {contact:?}");
        }
    }
}

fn ball(radius_m: f64) -> ToolShape {
    ToolShape::Implicit {
        tool: Box::new(
            ImplicitShape::Sphere { radius_m }
                .compile()
                .expect("a ball"),
        ),
        reach_m: Some(radius_m),
    }
}

fn block(half_extents_m: [f64; 3]) -> ToolShape {
    let shape = ImplicitShape::Box { half_extents_m };
    ToolShape::Implicit {
        tool: Box::new(shape.compile().expect("a box")),
        reach_m: None,
    }
}

/// Places around a part from which a ball reaches into it: random ones, moved to a distance from the closest point.
fn places(stand: &mut Stand, random: &mut Random, away_m: f64, count: usize) -> Vec<Point3> {
    let placed = stand.skin.part().expect("a part").clone();
    let (low, high) = placed.part().bounds();
    (0..count)
        .map(|_| {
            let [x, y, z] = random.vector().into();
            let middle = nalgebra::center(&low, &high);
            let half = (high - low) * 0.6;
            let q = placed.pose() * (middle + half.component_mul(&Vector3::new(x, y, z)));
            let foot = stand.solver.closest(&stand.skin, &q);
            let out = match foot.distance > 1e-6 {
                true => (q - foot.point) * foot.signed_distance.signum() / foot.distance,
                false => foot.normal,
            };
            foot.point + out * away_m
        })
        .collect()
}

#[test]
fn a_ball_as_a_function_touches_a_part_where_a_ball_does() {
    let mut random = Random(11);
    let mut shapes = vec![
        part(&prism(&BOX, 0.03)),
        part(&rounded([0.03, 0.02], 0.004, 0.02)),
    ];
    shapes.extend(["filleted_box", "seam_cut", "turned", "pipe"].map(part_of_file));
    let radius_m = 0.003;
    for (k, part) in shapes.iter().enumerate() {
        let mut stand = Stand::of_part(part, pose(&mut random));
        for centre in places(&mut stand, &mut random, 0.9 * radius_m, 30) {
            let at = Pose::from_parts(centre.coords.into(), random.rotation());
            let exact = stand.touch(&ToolShape::Sphere { radius_m }, &at);
            let found = stand.touch(&ball(radius_m), &at);
            let slack = 1e-8 * part.size_m() + 4.0 * part.gap_m();
            // Each of one has one of the other.
            for (these, others) in [(&exact, &found), (&found, &exact)] {
                // Fixed points of round edges come beside the deepest one.
                let fixed = |contact: &Contact| contact.point == ToolPoint::Round;
                let these = these.iter().filter(|c| c.depth_m > 0.0 && !fixed(c));
                for contact in these {
                    let same = |other: &&Contact| {
                        (other.depth_m - contact.depth_m).abs() <= slack
                            && (other.on_body - contact.on_body).norm() <= 1e-3 * radius_m + slack
                    };
                    assert!(
                        others.iter().any(|other| same(&other)),
                        "{k}: {contact:?} is in none of {others:?}, of {exact:?} and {found:?}; centre {}",
                        stand
                            .skin
                            .part()
                            .expect("a part")
                            .pose()
                            .inverse_transform_point(&centre)
                    );
                }
            }
        }
    }
}

#[test]
fn a_block_lies_on_a_face_of_a_part_with_its_corners_and_crossings() {
    let mut random = Random(12);
    let part = part(&prism(&BOX, 0.03));
    let half = [0.012, 0.009, 0.004];
    for k in 0..40 {
        let pose = pose(&mut random);
        let mut stand = Stand::of_part(&part, pose);
        let depth_m = 1e-4 + 4e-4 * random.unit();
        let turn = random.unit() * 6.0;
        // Half of them hang over an edge.
        let x = if k % 2 == 0 { 0.03 } else { 0.058 };
        let own = Pose::translation(x, 0.02, 0.03 + half[2] - depth_m)
            * crate::math::Rotation::from_axis_angle(&Vector3::z_axis(), turn);
        let found = stand.touch(&block(half), &(pose * own));
        let deepest = found.first().expect("a contact");
        assert!((deepest.depth_m - depth_m).abs() < 1e-12, "{deepest:?}");
        let up = pose * Vector3::z();
        let level: Vec<&Contact> = (found.iter())
            .filter(|c| (c.depth_m - depth_m).abs() < 1e-10 && (c.normal - up).norm() < 1e-9)
            .collect();
        // What carries spans the face: no line has all of it.
        let base = level[0].on_body;
        let far = (level.iter())
            .max_by(|a, b| {
                let away = |c: &Contact| (c.on_body - base).norm();
                away(a).total_cmp(&away(b))
            })
            .expect("one");
        let along = (far.on_body - base).normalize();
        let aside = |c: &&&Contact| (c.on_body - base).cross(&along).norm();
        let widest = level.iter().map(|c| aside(&c)).fold(0.0, f64::max);
        assert!(level.len() >= 4 && widest > 0.004, "{k}: {level:?}");
    }
}

#[test]
fn a_corner_of_a_part_goes_into_a_block_as_deep_as_it_is() {
    let mut random = Random(13);
    let part = part(&prism(&BOX, 0.03));
    for _ in 0..40 {
        let turn = random.rotation();
        // The block's top is z = 0; the lowest corner of the part is below it.
        let corner = |k: usize| {
            let [x, y] = BOX[k % 4];
            turn * Point3::new(x, y, if k < 4 { 0.0 } else { 0.03 })
        };
        let mut heights: Vec<f64> = (0..8).map(|k| corner(k).z).collect();
        heights.sort_by(f64::total_cmp);
        let depth_m = 0.3 * (heights[1] - heights[0]).min(0.003);
        let at = Pose::from_parts(Vector3::new(0.0, 0.0, -heights[0] - depth_m).into(), turn);
        let mut stand = Stand::of_part(&part, at);
        let found = stand.touch(&block([0.5, 0.5, 0.1]), &Pose::translation(0.0, 0.0, -0.1));
        assert_eq!(
            found.iter().filter(|c| c.depth_m > 1e-12).count(),
            1,
            "{found:?}"
        );
        assert!((found[0].depth_m - depth_m).abs() < 1e-13, "{found:?}");
        assert!((found[0].normal + Vector3::z()).norm() < 1e-12, "{found:?}");
    }
}

#[test]
fn two_edges_cross_as_deep_as_they_are() {
    let mut random = Random(14);
    let part = part(&prism(&BOX, 0.03));
    let quarter = std::f64::consts::FRAC_PI_4;
    for _ in 0..30 {
        // An edge of the part along x is its highest line, an edge of the block across is its lowest.
        let tilt = quarter + 0.3 * (random.unit() - 0.5);
        let on_edge = crate::math::Rotation::from_axis_angle(&Vector3::x_axis(), tilt);
        let highest = on_edge * Point3::new(0.0, 0.04, 0.03);
        let lean = quarter + 0.3 * (random.unit() - 0.5);
        let across = crate::math::Rotation::from_axis_angle(&Vector3::y_axis(), lean);
        let half = [0.01, 0.05, 0.01];
        let lowest = across * Point3::new(half[0], 0.0, -half[2]);
        let depth_m = 1e-4 + 2e-4 * random.unit();
        let spot = Point3::new(0.02 + 0.02 * random.unit(), highest.y, highest.z - depth_m);
        let own = Pose::from_parts((spot - lowest).into(), across);
        let pose = pose(&mut random);
        let mut stand = Stand::of_part(
            &part,
            pose * Pose::from_parts(Vector3::zeros().into(), on_edge),
        );
        let found = stand.touch(&block(half), &(pose * own));
        let deep: Vec<&Contact> = found.iter().filter(|c| c.depth_m > 0.0).collect();
        let crossing = pose * Point3::new(spot.x, highest.y, highest.z);
        // Along either edge the other solid is deepest where its two faces are as near.
        let own_m = [tilt, lean].map(|angle| depth_m / (angle.sin() + angle.cos()));
        assert!(!deep.is_empty(), "{found:?}");
        for contact in deep {
            let off = own_m.map(|own_m| (contact.depth_m - own_m).abs());
            assert!(off[0].min(off[1]) < 1e-10, "{contact:?} {own_m:?}");
            assert!(
                (contact.on_body - crossing).norm() < 2.0 * depth_m,
                "{contact:?}"
            );
        }
    }
}

/// Contacts of two bodies, in both orders.
fn between(mine: &mut Stand, theirs: &mut Stand) -> [Vec<Contact>; 2] {
    let reach = REACH;
    let contacts = |mine: &mut Stand, theirs: &mut Stand| {
        let party = Party::Body(theirs.shape());
        let mut narrow = Narrow::new(mine.shape(), party, Method::Exact).expect("a pair");
        narrow.body_contacts(mine.side(), theirs.side(), reach, false);
        mine.check(narrow.set.contacts());
        narrow.set.contacts().to_vec()
    };
    let first = contacts(mine, theirs);
    [first, contacts(theirs, mine)]
}

#[test]
fn a_part_stands_on_a_part_with_its_lowest_corner() {
    let mut random = Random(15);
    let part = part(&prism(&BOX, 0.03));
    for _ in 0..20 {
        let pose = pose(&mut random);
        let turn = random.rotation();
        let corners = (0..8).map(|k: usize| {
            let [x, y] = BOX[k % 4];
            turn * Point3::new(x, y, if k < 4 { 0.0 } else { 0.03 })
        });
        let mut corners: Vec<Point3> = corners.collect();
        corners.sort_by(|a, b| a.z.total_cmp(&b.z));
        let depth_m = 0.3 * (corners[1].z - corners[0].z).min(0.003);
        let spot = Point3::new(0.03, 0.02, 0.03 - depth_m);
        let mut below = Stand::of_part(&part, pose);
        let above = pose * Pose::from_parts((spot - corners[0]).into(), turn);
        let mut above = Stand::of_part(&part, above);
        for (found, up) in between(&mut below, &mut above).into_iter().zip([1.0, -1.0]) {
            let deepest = found.first().expect("a contact");
            assert!((deepest.depth_m - depth_m).abs() < 1e-12, "{found:?}");
            assert!(
                (deepest.normal - pose * Vector3::z() * up).norm() < 1e-9,
                "{found:?}"
            );
            let [u, v] = deepest.tool_uv.expect("a place on the other");
            let other = if up > 0.0 { &above } else { &below };
            assert!(
                (other.skin.point(u, v) - deepest.on_tool).norm() < 1e-9,
                "{found:?}"
            );
        }
    }
}

#[test]
fn a_surface_touches_a_part_as_body_holder_and_tool() {
    let mut random = Random(16);
    let globe = builtin("sphere", None, Some(0.01)).expect("a ball");
    let grid = (0..2500).map(|k| globe.point(f64::from(k % 50) / 50.0, f64::from(k / 50) / 50.0));
    let radii = grid.map(|p| p.coords.norm());
    let (least, most) = radii.fold((f64::INFINITY, 0.0_f64), |(l, h), r| (l.min(r), h.max(r)));
    for part in [part(&prism(&BOX, 0.03)), part_of_file("filleted_box")] {
        let pose = pose(&mut random);
        let mut stand = Stand::of_part(&part, pose);
        for centre in places(&mut stand, &mut random, 0.9 * least, 12) {
            let at = Pose::from_parts(centre.coords.into(), random.rotation());
            let mut moved = globe.clone();
            let points = moved.net_mut().points_mut();
            points.iter_mut().for_each(|p| *p = at * *p);
            let mut body = Stand::of_surface(moved);
            let shape = ToolShape::Surface(Box::new(SurfaceShape::new(globe.clone())));
            let as_tool = stand.touch(&shape, &at);
            let [mine, theirs] = between(&mut body, &mut stand);
            let radius_m = least;
            let exact = stand.touch(&ToolShape::Sphere { radius_m }, &at);
            let depth_m = exact.first().map_or(0.0, |c| c.depth_m);
            for (which, found) in [&as_tool, &mine, &theirs].into_iter().enumerate() {
                let Some(deepest) = found.first() else {
                    panic!(
                        "{which}: no contact at {centre} {pose} at depth {depth_m:e}: {as_tool:?} {mine:?} {theirs:?}"
                    );
                };
                let off = deepest.depth_m - depth_m;
                let slack = 1e-8 * part.size_m() + 4.0 * part.gap_m();
                assert!(
                    (-slack..=most - least + slack).contains(&off),
                    "{off:e} {deepest:?}"
                );
                assert!(deepest.tool_uv.is_some());
            }
        }
    }
}

#[test]
fn a_sheet_part_is_no_solid() {
    let sheet = Stand::of_part(&part_of_file("filleted_box"), Pose::identity());
    let bare = BodyShape::from(&sheet.skin);
    let shape = ToolShape::Surface(Box::new(SurfaceShape::new(
        builtin("sphere", None, None).expect("a ball"),
    )));
    let refused = Narrow::new(bare, Party::Tool(&shape), Method::Exact).expect_err("no solid");
    assert!(
        refused.to_string().contains("without an inside"),
        "{refused}"
    );
}
