//! Pieces of sheets, against the cut's own measures, the plane and the surface that was cut.

use super::*;
use crate::cut::{CutError, CutPlane, cut_by_plane, cut_sheet_by_plane};
use crate::math::{Random, Vector3};
use crate::surface::{ClosestSolver, ControlNet, builtin};
use std::f64::consts::TAU;

/// A tube about z, open at both ends.
fn tube() -> Surface {
    let (around, along) = (16, 10);
    let points = (0..around).flat_map(|i| {
        let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
        (0..along).map(move |j| {
            let z = 0.12 * j as f64 / (along - 1) as f64;
            let r = 0.02 + 0.004 * (40.0 * z).sin();
            Point3::new(r * cos, r * sin, z)
        })
    });
    let net = ControlNet::new(around, along, points.collect()).unwrap();
    let knots_u = crate::basis::KnotVector::periodic_uniform(3, around).unwrap();
    let knots_v = crate::basis::KnotVector::clamped_uniform(3, along).unwrap();
    Surface::new(knots_u, knots_v, net, None).unwrap()
}

fn spacing_m(surface: &Surface) -> f64 {
    let count = surface.net().points().len() as f64;
    (surface.area() / count).sqrt()
}

fn size(piece: &crate::cut::Piece) -> f64 {
    piece.skin_area_m2.sqrt()
}

/// Where the lines of the surface's border are farthest from the plane or, where that is nearer, from the border of the
/// surface that was cut, m.
fn border_off_m(made: &Surface, cut: &Cut) -> f64 {
    let topology = made.topology();
    let mut lines: Vec<Box<dyn Fn(f64) -> [f64; 2]>> = Vec::new();
    for d in 0..2 {
        for end in 0..2 {
            if !topology.wraps(d) && !topology.poles[d][end] {
                let end = end as f64;
                lines.push(match d {
                    0 => Box::new(move |t| [end, t]),
                    _ => Box::new(move |t| [t, end]),
                });
            }
        }
    }
    assert!(!lines.is_empty());
    let mut solver = ClosestSolver::new(&cut.surface);
    let own = cut.surface.topology();
    let mut most = 0.0_f64;
    for line in &lines {
        for k in 0..=60 {
            let [u, v] = line(f64::from(k) / 60.0);
            let point = made.point(u, v);
            let height = cut.plane.height(&point).abs();
            let foot = solver.closest(&cut.surface, &point);
            let near = [foot.u, foot.v];
            let (mut best, knots) = (height, [cut.surface.knots_u(), cut.surface.knots_v()]);
            for d in (0..2).filter(|&d| !own.wraps(d)) {
                let (start, end) = knots[d].domain();
                for (side, value) in [start, end].into_iter().enumerate() {
                    if !own.poles[d][side] {
                        let mut at = near;
                        at[d] = value;
                        best = best.min((cut.surface.point(at[0], at[1]) - point).norm());
                    }
                }
            }
            most = most.max(best);
        }
    }
    most
}

/// Fits all pieces; the share of the size that each is off.
fn fitted(surface: &Surface, plane: &CutPlane, what: &str) -> Vec<(f64, f64)> {
    let cut = match cut_sheet_by_plane(surface, plane) {
        Ok(cut) => cut,
        Err(CutError::Misses { .. }) => return Vec::new(),
        Err(error) => panic!("{what}: {error}"),
    };
    let spec = SheetSpec {
        spacing_m: spacing_m(surface),
    };
    let mut offs = Vec::new();
    for (k, piece) in cut.pieces.iter().enumerate() {
        let what = format!("{what}, piece {k} of {}", cut.pieces.len());
        let made = match cut.sheet(k, surface, &spec) {
            Ok(made) => made,
            Err(reason @ PieceSkinError::Folded { .. }) => {
                println!("{what}: {reason}");
                continue;
            }
            Err(error) => panic!("{what}: {error}"),
        };
        let finer = SheetSpec {
            spacing_m: spec.spacing_m / 1.5,
        };
        let made = match made.off_m > 1e-3 * size(piece) {
            true => cut.sheet(k, surface, &finer).unwrap_or(made),
            false => made,
        };
        let net = made.surface.net();
        let size = size(piece);
        let border = border_off_m(&made.surface, &cut) / size;
        let area = made.surface.area() / piece.skin_area_m2 - 1.0;
        let poles = made.surface.topology().poles;
        println!(
            "{what}: {} × {} {poles:?}, off {:.1e}, border {border:.1e}, area {area:.1e}",
            net.rows(),
            net.columns(),
            made.off_m / size
        );
        assert!(!made.surface.topology().is_closed(), "{what}");
        assert_eq!(
            made.surface.clone().with_exact_seams(),
            made.surface,
            "{what}"
        );
        offs.push((made.off_m / size, border));
    }
    offs
}

fn through(surface: &Surface, random: &mut Random) -> CutPlane {
    let (a, b) = (surface.knots_u().domain(), surface.knots_v().domain());
    let point = surface.point(random.float(a.0, a.1), random.float(b.0, b.1));
    CutPlane::through(&point, &random.vector()).unwrap()
}

#[test]
fn random_planes_through_sheets_give_sheets_within_a_thousandth() {
    let mut random = Random(91);
    let bodies = [
        (
            "ball",
            builtin("sphere", Some([16, 9]), Some(0.05)).unwrap(),
        ),
        ("drop", builtin("teardrop", Some([12, 12]), None).unwrap()),
        ("square", builtin("sheet", None, None).unwrap()),
        ("tube", tube()),
    ];
    let mut good = Vec::new();
    for (what, body) in &bodies {
        let mut offs = Vec::new();
        for k in 0..10 {
            let plane = through(body, &mut random);
            offs.extend(fitted(body, &plane, &format!("{what} {k}")));
        }
        let mut off: Vec<f64> = offs.iter().map(|off| off.0).collect();
        let mut border: Vec<f64> = offs.iter().map(|off| off.1).collect();
        off.sort_by(f64::total_cmp);
        border.sort_by(f64::total_cmp);
        let (n, most) = (off.len(), off.len() - 1);
        assert!(n >= 18, "{what}: {n} pieces");
        println!(
            "{what}: {n} pieces, off {:.1e} (median), {:.1e} (all), borders {:.1e} {:.1e}",
            off[n / 2],
            off[most],
            border[n / 2],
            border[most]
        );
        // A drop's ends have curvature that a net of its own fineness shows less well.
        let median = if *what == "drop" { 3e-3 } else { 1e-3 };
        good.push((off[n / 2] < median && off[3 * n / 4] < 1e-2, *what));
        good.push((border[n / 2] < 1e-4 && border[most] < 1e-2, *what));
    }
    assert!(good.iter().all(|one| one.0), "{good:?}");
}

// Of a square every piece is exact, whatever its corners: triangles, quadrangles and pentagons.
#[test]
fn a_flat_square_s_pieces_are_polygons() {
    let square = builtin("sheet", Some([10, 10]), Some(0.1)).unwrap();
    for (normal, offset_m, what) in [
        ([1.0, 0.0, 0.0], 0.01, "straight"),
        ([1.0, 0.3, 0.0], 0.01, "oblique"),
        ([1.0, 1.2, 0.0], 0.04, "a corner"),
    ] {
        let normal = Vector3::from(normal).normalize();
        let cut = cut_sheet_by_plane(&square, &CutPlane { normal, offset_m }).unwrap();
        for (k, piece) in cut.pieces.iter().enumerate() {
            let made = cut
                .sheet(k, &square, &SheetSpec { spacing_m: 0.01 })
                .unwrap();
            let what = format!("{what}, piece {k}");
            assert!(made.off_m < 1e-9 * size(piece), "{what}: {:e}", made.off_m);
            let area = made.surface.area() / piece.skin_area_m2 - 1.0;
            assert!(area.abs() < 1e-9, "{what}: {area:e}");
            assert!(border_off_m(&made.surface, &cut) < 1e-9, "{what}");
            // Its sides face as those of the square do.
            assert!(made.surface.normal(0.3, 0.4).z > 0.999, "{what}");
        }
    }
}

#[test]
fn what_has_no_such_sheet_is_refused() {
    let ring = builtin("torus", None, None).unwrap();
    let spec = SheetSpec { spacing_m: 0.01 };
    let plane = |normal: Vector3, offset_m: f64| CutPlane { normal, offset_m };
    let along = cut_sheet_by_plane(&ring, &plane(Vector3::z(), 0.0)).unwrap();
    assert_eq!(along.sheet(0, &ring, &spec).unwrap().rims, 2);
    let edge = cut_sheet_by_plane(&ring, &plane(Vector3::x(), 0.045)).unwrap();
    let refused = edge.sheet(1, &ring, &spec).unwrap_err();
    assert_eq!(refused, PieceSkinError::Handles { handles: 1 });
    let missing = edge.sheet(2, &ring, &spec).unwrap_err();
    assert_eq!(missing, PieceSkinError::Piece { piece: 2, count: 2 });
    let solid = cut_by_plane(&ring, &plane(Vector3::x(), 0.0)).unwrap();
    assert_eq!(
        solid.sheet(0, &ring, &spec).unwrap_err(),
        PieceSkinError::Solid
    );
    for spacing_m in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9] {
        let refused = edge.sheet(0, &ring, &SheetSpec { spacing_m }).unwrap_err();
        assert!(
            matches!(refused, PieceSkinError::Spacing { .. }),
            "{spacing_m}"
        );
    }
    let ball = builtin("sphere", None, None).unwrap();
    assert_eq!(
        edge.sheet(0, &ball, &spec).unwrap_err(),
        PieceSkinError::Rest
    );
}
