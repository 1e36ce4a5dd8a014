//! Warm answers against cold ones along paths, and descent that stays on its branch.

use super::super::hand::{FILES, axes, bend, cone, dome, drilled, whole};
use super::*;
use crate::exchange::step::{PartPick, read_part};
use crate::math::{Random, Vector3};
use crate::part::{Brep, PartMinima, Placing};
use std::time::Instant;

fn by_hand(random: &mut Random) -> Vec<(&'static str, Part)> {
    let frame = axes([0.01, 0.02, 0.03], [1.0, 2.0, 3.0], [1.0, 0.0, 0.0]);
    let torus = |major_m, minor_m| {
        whole(Carrier::Torus {
            axes: frame,
            major_m,
            minor_m,
        })
    };
    let ball = whole(Carrier::Sphere {
        axes: frame,
        radius_m: 0.01,
    });
    let all: [(&str, Brep); 7] = [
        ("drilled", drilled()),
        ("cone", cone()),
        ("dome", dome()),
        ("bend", bend()),
        ("ball", ball),
        ("apple", torus(0.01, 0.02)),
        ("ring", torus(0.02, 0.005)),
    ];
    let mut placed = |brep: &Brep| {
        let placing = Placing {
            turn: random.rotation().to_rotation_matrix().into_inner(),
            scale: 1.0,
            shift: random.vector() * 0.1,
        };
        Part::new(&brep.placed(&placing).expect("in range")).expect("a part")
    };
    all.iter()
        .map(|(name, brep)| (*name, placed(brep)))
        .collect()
}

fn of_file(name: &str) -> Part {
    let path = std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/parts")
        .join(format!("{name}.step"));
    let bytes = std::fs::read(path).expect("the file");
    let read = read_part(&bytes, &PartPick::default()).expect("a part");
    Part::new(&read.brep).expect("a part")
}

/// A smooth path of queries around a part, at up to 0.2 m/s and 1 kHz: through it, along its surface, with jumps.
struct Path<'a> {
    part: &'a Part,
    q: Point3,
    velocity_m: Vector3,
    step_m: f64,
}

impl<'a> Path<'a> {
    fn new(part: &'a Part, random: &mut Random) -> Self {
        Self {
            part,
            q: anywhere(part, random),
            velocity_m: Vector3::zeros(),
            step_m: random.float(2e-5, 2e-4),
        }
    }

    /// The next query; `along`: it keeps near the surface.
    fn next(&mut self, along: bool, cold: &mut PartSolver, random: &mut Random) -> Point3 {
        if random.below(400) == 0 {
            self.q = anywhere(self.part, random);
            self.step_m = random.float(2e-5, 2e-4);
            return self.q;
        }
        if random.below(200) == 0 {
            self.q += random.vector() * (0.05 * self.part.size_m());
            return self.q;
        }
        let (low, high) = self.part.bounds();
        let home = Point3::from(0.5 * (low.coords + high.coords)) - self.q;
        let far = home.norm() / self.part.size_m();
        let pull = if far > 0.8 {
            0.1 * home.normalize()
        } else {
            Vector3::zeros()
        };
        let push = self.velocity_m + self.step_m * (0.1 * random.vector() + pull);
        self.velocity_m = push.try_normalize(0.0).unwrap_or(push) * self.step_m;
        self.q += self.velocity_m;
        if along && let Some(foot) = cold.closest(self.part, &self.q) {
            let most_m = 0.01 * self.part.size_m();
            if foot.distance > most_m {
                self.q = foot.point + (self.q - foot.point) * (most_m / foot.distance);
            }
        }
        self.q
    }
}

fn anywhere(part: &Part, random: &mut Random) -> Point3 {
    let (low, high) = part.bounds();
    let middle = Point3::from(0.5 * (low.coords + high.coords));
    middle + 0.7 * (high - low).component_mul(&random.vector())
}

fn quantile(times: &mut [f64], share: f64) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[((times.len() - 1) as f64 * share) as usize]
}

fn follows(name: &str, part: &Part, steps: usize, random: &mut Random) {
    let mut cold = PartSolver::new(part);
    let mut solver = cold.clone();
    let size_m = part.size_m();
    for along in [false, true] {
        let mut path = Path::new(part, random);
        let mut warm = WarmFoot::default();
        let mut last = path.q;
        let (mut times_us, mut cold_us, mut kept) = (Vec::new(), Vec::new(), 0);
        for k in 0..steps {
            let q = path.next(along, &mut cold, random);
            let moved_m = (q - last).norm();
            last = q;
            let before = warm;
            let start = Instant::now();
            let foot = solver.closest_warm_moved(part, &q, moved_m, &mut warm);
            times_us.push(start.elapsed().as_secs_f64() * 1e6);
            let start = Instant::now();
            let right = cold.closest(part, &q);
            cold_us.push(start.elapsed().as_secs_f64() * 1e6);
            let (foot, right) = (foot.expect("finite"), right.expect("finite"));
            kept += usize::from(before.budget_m > moved_m);
            assert_eq!(foot.certified, right.certified, "{name} {k}");
            let off = (foot.distance - right.distance).abs();
            assert!(
                off <= 1e-12 * size_m,
                "{name} {k}: {foot:?}, right {right:?}, at {q:?} from {before:?}"
            );
            let there = part.point(foot.place);
            let off = (there - foot.point).norm();
            assert!(
                off <= 1e-12 * size_m + 2.0 * part.gap_m(),
                "{name} {k}: {foot:?} is {off:e} from its place"
            );
            if k % 64 == 0 {
                let mut again = before;
                let other = PartSolver::new(part).closest_warm_moved(part, &q, moved_m, &mut again);
                assert_eq!((other, again), (Some(foot), warm), "{name} {k}");
            }
            // From its own place, descent stays.
            let stays = cold.local(part, &q, foot.place);
            let off = stays.map_or(0.0, |stays| stays.distance - foot.distance);
            assert!(
                off.abs() <= 1e-9 * size_m + 2.0 * part.gap_m(),
                "{name} {k}: {stays:?} from {foot:?}"
            );
        }
        println!(
            "{name:<20} along {along:<5} warm {:.2} µs, p99 {:.2}; cold {:.2} µs, p99 {:.2}; {:.0} % by certificate",
            quantile(&mut times_us, 0.5),
            quantile(&mut times_us, 0.99),
            quantile(&mut cold_us, 0.5),
            quantile(&mut cold_us, 0.99),
            100.0 * kept as f64 / steps as f64
        );
    }
}

#[test]
fn warm_answers_are_cold_ones_on_parts_by_hand() {
    let mut random = Random(4711);
    for (name, part) in by_hand(&mut random) {
        follows(name, &part, 3_000, &mut random);
    }
}

#[test]
fn warm_answers_are_cold_ones_on_parts_of_files() {
    let mut random = Random(4712);
    for name in FILES {
        follows(name, &of_file(name), 1_500, &mut random);
    }
}

/// Into the drilled block from above, and on past its middle: the foot stays on top. Sideways it goes over the rim.
#[test]
fn descent_stays_on_its_branch_and_goes_over_edges() {
    let part = Part::new(&drilled()).expect("a part");
    let mut solver = PartSolver::new(&part);
    let mut place = None;
    for k in 0..1_000 {
        let q = Point3::new(0.012, 0.012, 0.03 - 2.9e-5 * f64::from(k));
        let start = place.unwrap_or_else(|| solver.closest(&part, &q).expect("finite").place);
        let foot = solver.local(&part, &q, start).expect("arrives");
        assert!((foot.point.z - 0.02).abs() < 1e-15, "{foot:?} at {q}");
        place = Some(foot.place);
    }
    let from = place.expect("a place");
    for (q, right) in [
        // Beyond the side: over the edge onto it, or onto the edge.
        (
            Point3::new(-0.01, 0.012, 0.01),
            Point3::new(0.0, 0.012, 0.01),
        ),
        (
            Point3::new(-0.01, 0.012, 0.03),
            Point3::new(0.0, 0.012, 0.02),
        ),
        (Point3::new(-0.01, -0.01, 0.03), Point3::new(0.0, 0.0, 0.02)),
        // In the hole: onto its wall.
        (
            Point3::new(0.026, 0.02, 0.01),
            Point3::new(0.022, 0.02, 0.01),
        ),
    ] {
        let foot = solver.local(&part, &q, from).expect("arrives");
        assert!((foot.point - right).norm() < 1e-14, "{foot:?} at {q}");
    }
}

/// From any place to any query: never farther than the place, never nearer than the nearest.
#[test]
fn descent_falls_and_arrives() {
    let mut random = Random(4713);
    let mut all = by_hand(&mut random);
    all.extend(FILES.map(|name| (name, of_file(name))));
    for (name, part) in all {
        let mut solver = PartSolver::new(&part);
        let (mut lost, count) = (0, 400);
        let slack_m = 1e-9 * part.size_m() + 2.0 * part.gap_m();
        for k in 0..count {
            let near = anywhere(&part, &mut random);
            let q = anywhere(&part, &mut random);
            let [from, right] = [near, q].map(|q| solver.closest(&part, &q).expect("finite"));
            let Some(foot) = solver.local(&part, &q, from.place) else {
                lost += 1;
                continue;
            };
            let least = right.distance;
            let most = (q - from.point).norm();
            assert!(
                foot.distance <= most + slack_m && foot.distance >= least - slack_m,
                "{name} {k}: {foot:?} from {from:?}, {most} to {least}"
            );
            let again = solver
                .local(&part, &q, foot.place)
                .map(|foot| foot.distance);
            let off = again.map_or(0.0, |d| d - foot.distance);
            assert!(
                off <= slack_m,
                "{name} {k}: {off:e} farther from its own end"
            );
        }
        println!("{name}: {lost} of {count} do not arrive");
        assert!(lost * 20 <= count, "{name}: {lost} do not arrive");
    }
}

/// One tick after another along a smooth path near a part with B-splines, as a tool asks for them: a warm closest point, a
/// descent, all minima near.
#[test]
fn ticks_on_b_splines_are_cheap_and_right() {
    let mut random = Random(4714);
    for name in ["loft", "seam_cut", "thread"] {
        let part = of_file(name);
        let (mut cold, mut solver) = (PartSolver::new(&part), PartSolver::new(&part));
        let mut minima = PartMinima::new(&part);
        let size_m = part.size_m();
        let (low, high) = part.bounds();
        let (mut q, mut heading) = (high, (low - high).normalize());
        let (mut last, mut warm) = (q, WarmFoot::default());
        let mut times = [const { Vec::new() }; 4];
        for k in 0..4_000 {
            heading = (heading + 0.2 * random.vector()).normalize();
            q += heading * random.float(2e-5, 2e-4);
            let right = cold.closest(&part, &q).expect("finite");
            if right.distance > 0.05 * size_m {
                heading = (right.point - q) / right.distance;
            }
            let moved_m = (q - last).norm();
            last = q;
            let start = Instant::now();
            let foot = solver.closest_warm_moved(&part, &q, moved_m, &mut warm);
            let one = start.elapsed();
            let foot = foot.expect("finite");
            let local = solver.local(&part, &q, foot.place);
            let two = start.elapsed();
            let found = minima.within(&part, &mut solver, &q, 0.02 * size_m);
            let three = start.elapsed();
            let spent = [one, two - one, three - two, three];
            for (times, spent) in times.iter_mut().zip(spent) {
                times.push(spent.as_secs_f64() * 1e6);
            }
            let off_m = (foot.distance - right.distance).abs();
            assert!(
                off_m <= 1e-12 * size_m,
                "{name} {k}: {foot:?}, right {right:?}"
            );
            let off_m = found.map_or(0.0, |found| (found.distance - right.distance).abs());
            assert!(
                off_m <= 1e-12 * size_m,
                "{name} {k}: {found:?}, right {right:?}"
            );
            assert!(
                found.is_some() || right.distance > 0.02 * size_m,
                "{name} {k}"
            );
            assert!(local.is_some(), "{name} {k}");
            if k % 64 == 0 {
                let mut other = PartMinima::new(&part);
                let again = other.within(&part, &mut PartSolver::new(&part), &q, 0.02 * size_m);
                assert_eq!(
                    (again, other.found()),
                    (found, minima.found()),
                    "{name} {k}"
                );
            }
        }
        let what = ["warm", "local", "minima", "all"];
        for (what, times) in what.iter().zip(&mut times) {
            print!(
                "{name} {what} {:.2} µs, p99 {:.1}; ",
                quantile(times, 0.5),
                quantile(times, 0.99)
            );
        }
        println!();
    }
}
