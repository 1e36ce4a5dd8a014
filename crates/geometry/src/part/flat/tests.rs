use super::super::bezier;
use super::*;
use crate::basis::KnotVector;
use crate::exchange::step::{PartPick, read_part};
use crate::math::Point3;

/// Parts of a span, each with a rule of its own.
const PARTS: u32 = 4;
/// Places and weights of Gauss's rule on [0, 1].
const GAUSS: [(f64, f64); 8] = [
    (0.019_855_071_751_231_9, 0.050_614_268_145_188_1),
    (0.101_666_761_293_186_6, 0.111_190_517_226_687_2),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_6),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_6),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_2),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_1),
];

fn cubic(points: &[[f64; 2]], t: f64) -> ([f64; 2], [f64; 2]) {
    let s = 1.0 - t;
    let at = |k: usize| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|j| points[j][k]);
        let value = s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d;
        let slope = 3.0 * (s * s * (b - a) + 2.0 * s * t * (c - b) + t * t * (d - c));
        (value, slope)
    };
    let ((u, du), (v, dv)) = (at(0), at(1));
    ([u, v], [du, dv])
}

/// ∫ |S_u × S_v| du from the first u on.
fn beside(surface: &Surface, [u, v]: [f64; 2]) -> f64 {
    let knots: &KnotVector = surface.knots_u();
    let t = knots.knots();
    let mut sum = 0.0;
    for span in knots.spans() {
        let end = t[span + 1].min(u);
        let step = (end - t[span]) / f64::from(PARTS);
        for k in (0..PARTS).filter(|_| step > 0.0) {
            let a = t[span] + step * f64::from(k);
            let b = a + step;
            sum += GAUSS.iter().fold(0.0, |sum, (x, w)| {
                let frame = surface.frame(a + (b - a) * x, v);
                sum + w * (b - a) * frame.du.cross(&frame.dv).norm()
            });
        }
    }
    sum
}

/// Where a cubic crosses knots of the surface, with both its ends.
fn crossings(surface: &Surface, points: &[[f64; 2]]) -> Vec<f64> {
    let mut all = vec![0.0, 1.0];
    for (k, knots) in [surface.knots_u(), surface.knots_v()].iter().enumerate() {
        for &knot in knots.knots() {
            for step in 0..16 {
                let off = |t: f64| cubic(points, t).0[k] - knot;
                let [mut a, mut b] = [step, step + 1].map(|s| f64::from(s) / 16.0);
                if off(a) * off(b) < 0.0 {
                    let from = off(a);
                    for _ in 0..50 {
                        let t = 0.5 * (a + b);
                        if off(t) * from > 0.0 { a = t } else { b = t }
                    }
                    all.push(a);
                }
            }
        }
    }
    all.sort_unstable_by(f64::total_cmp);
    all
}

/// ∮ (∫ |S_u × S_v| du) dv, by Green.
fn area_within(surface: &Surface, pieces: &[FlatPiece]) -> f64 {
    let mut sum = 0.0;
    for piece in pieces {
        for points in piece.picture.points.windows(4).step_by(3) {
            for part in crossings(surface, points).windows(2) {
                let length = (part[1] - part[0]) / f64::from(PARTS);
                for (k, (x, w)) in (0..PARTS).flat_map(|k| GAUSS.map(|at| (k, at))) {
                    let (uv, slope) = cubic(points, part[0] + length * (f64::from(k) + x));
                    sum += w * length * slope[1] * beside(surface, uv);
                }
            }
        }
    }
    sum
}

fn whole_area(surface: &Surface) -> f64 {
    let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
    let t = surface.knots_v().knots();
    let spans = surface.knots_v().spans().map(|span| [t[span], t[span + 1]]);
    assert_eq!(v.1, surface.knots_v().confine(v.1));
    spans
        .map(|[a, b]| {
            let each = GAUSS.map(|(x, w)| w * (b - a) * beside(surface, [u.1, a + (b - a) * x]));
            each.iter().sum::<f64>()
        })
        .sum()
}

/// How far the picture of a piece is from its curve at most, m.
fn off_curve_m(surface: &Surface, piece: &FlatPiece) -> f64 {
    let places = |segment: &Vec<Homogeneous>| {
        let at = |k: i32| bezier::projected(&bezier::evaluate(segment, f64::from(k) / 2000.0).0);
        (0..=2000).map(at).collect::<Vec<_>>()
    };
    let dense: Vec<Point3> = piece.curve.iter().flat_map(places).collect();
    let away_m = |x: &Point3| {
        let chords = dense.windows(2).map(|pair| {
            let way = pair[1] - pair[0];
            let along = (x - pair[0]).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE);
            (x - (pair[0] + way * along.clamp(0.0, 1.0))).norm()
        });
        chords.fold(f64::INFINITY, f64::min)
    };
    let cubics = piece.picture.points.windows(4).step_by(3);
    let places = cubics.flat_map(|p| {
        [0.0, 0.125, 0.375, 0.625, 0.875].map(|t: f64| {
            let s = 1.0 - t;
            let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
            [0, 1].map(|k| (0..4).map(|i| weights[i] * p[i][k]).sum::<f64>())
        })
    });
    let off = places.map(|[u, v]| away_m(&surface.point(u, v)));
    let measured = !piece.curve.is_empty();
    off.filter(|_| measured).fold(0.0, f64::max)
}

// The area in the rectangle of parameters is that of the part, which is integrated on the carriers; and what is drawn there is
// where the curves are.
#[test]
fn faces_laid_flat_keep_their_areas_and_edges() {
    let parts = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parts");
    let mut seen = 0;
    for entry in std::fs::read_dir(parts).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "step") {
            continue;
        }
        let name = path.file_stem().unwrap().to_str().unwrap();
        let mut read = read_part(&std::fs::read(&path).unwrap(), &PartPick::default()).unwrap();
        let part = read.part(false).unwrap();
        let (areas, size_m) = (part.measure().face_areas_m2, part.size_m());
        for (f, area) in areas.iter().enumerate() {
            let id = part.faces[f].id;
            let flat = part.flattened(f);
            let flat = flat.unwrap_or_else(|problem| panic!("{name}, face #{id}: {problem}"));
            let surface = &flat.surface;
            let mut own = if flat.whole { whole_area(surface) } else { 0.0 };
            for pieces in &flat.loops {
                own += area_within(surface, pieces);
                for (k, piece) in pieces.iter().enumerate() {
                    let next = pieces[(k + 1) % pieces.len()].picture.points[0];
                    assert_eq!(piece.picture.end(), next, "{name}, face #{id}: apart");
                    let ends = [piece.picture.points[0], piece.picture.end()];
                    let (Some(first), Some(last)) = (piece.curve.first(), piece.curve.last())
                    else {
                        continue;
                    };
                    let curve = [&first[0], &last[last.len() - 1]].map(bezier::projected);
                    for (uv, p) in ends.iter().zip(curve) {
                        let off_m = (surface.point(uv[0], uv[1]) - p).norm();
                        let may_m = part.gap_m() + 1e-9 * size_m;
                        assert!(off_m <= may_m, "{name}, face #{id}: {off_m:e} m at {uv:?}");
                    }
                }
            }
            let off = (own / area - 1.0).abs();
            println!("{name}, face #{id}: {off:.1e}");
            // Pictures are as near to the edges as the edges to their faces, the quadrature to 1e-9.
            let curves = flat.loops.iter().flatten().flat_map(|piece| &piece.curve);
            let length_m: f64 = (curves.flat_map(|points| points.windows(2)))
                .map(|pair| (bezier::projected(&pair[1]) - bezier::projected(&pair[0])).norm())
                .sum();
            let mut may = 1e-8 + part.gap_m() * length_m / area;
            if off > may {
                // But for kinks of the surface, between which they are divided nine times.
                let off_m = flat
                    .loops
                    .iter()
                    .flatten()
                    .map(|piece| off_curve_m(surface, piece));
                let off_m = off_m.fold(0.0, f64::max);
                assert!(
                    off_m < 1e-7 * size_m,
                    "{name}, face #{id}: pictures off by {off_m:e} m"
                );
                // So may the loops be that the area is measured in.
                may += 2.0 * off_m * length_m / area;
            }
            assert!(
                off <= may,
                "{name}, face #{id}: area off by {off:e}, not {may:e}"
            );
        }
        seen += 1;
    }
    assert_eq!(seen, 12);
}
