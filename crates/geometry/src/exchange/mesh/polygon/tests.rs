use super::*;
use crate::math::Random;
use std::collections::BTreeMap;

type Flat = Vec<[f64; 2]>;

fn flat(at: &[[f64; 2]]) -> Vec<Point3> {
    at.iter().map(|p| Point3::new(p[0], p[1], 0.0)).collect()
}

fn all(points: &[Point3]) -> Result<Vec<[u32; 3]>, Flaw> {
    triangles(points, &(0..points.len() as u32).collect::<Vec<_>>())
}

/// Twice the vector area.
fn area(points: &[Point3]) -> Vector3 {
    let next = points.iter().cycle().skip(1);
    points
        .iter()
        .zip(next)
        .map(|(a, b)| (a - points[0]).cross(&(b - points[0])))
        .sum()
}

/// How often a polygon winds round a place that is on none of its edges.
fn winding(polygon: &[[f64; 2]], p: [f64; 2]) -> i32 {
    let next = polygon.iter().cycle().skip(1);
    let edges = polygon.iter().zip(next);
    edges
        .map(|(a, b)| {
            let left = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            i32::from(a[1] <= p[1] && b[1] > p[1] && left > 0.0)
                - i32::from(a[1] > p[1] && b[1] <= p[1] && left < 0.0)
        })
        .sum()
}

/// The triangles have the polygon's area, all turn its way, and leave its edges.
fn covers(points: &[Point3], found: &[[u32; 3]], context: &str) {
    let whole = area(points);
    let normal = whole.normalize();
    let mut sum = 0.0;
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for triangle in found {
        let part = area(&triangle.map(|k| points[k as usize])).dot(&normal);
        assert!(
            part > -1e-12 * whole.norm(),
            "{context}: a triangle is turned over"
        );
        sum += part;
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            *edges.entry((a, b)).or_default() += 1;
            *edges.entry((b, a)).or_default() -= 1;
        }
    }
    assert!(
        (sum / whole.norm() - 1.0).abs() < 1e-12,
        "{context}: {sum} of {}",
        whole.norm()
    );
    let count = points.len() as u32;
    for ((a, b), times) in edges {
        let wanted = i32::from((a + 1) % count == b) - i32::from((b + 1) % count == a);
        assert_eq!(times, wanted, "{context}: edge {a} {b}");
    }
    assert_eq!(found.len(), points.len() - 2, "{context}");
}

/// Random corners, turned round where edges cross until none do.
fn untangled(random: &mut Random, count: usize) -> Flat {
    let mut at: Flat = (0..count)
        .map(|_| [random.signed(), random.signed()])
        .collect();
    let left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    'again: loop {
        for i in 0..count {
            for j in i + 2..count {
                let (a, b, c, d) = (at[i], at[i + 1], at[j], at[(j + 1) % count]);
                if (j + 1) % count != i
                    && left(a, b, c) != left(a, b, d)
                    && left(c, d, a) != left(c, d, b)
                {
                    at[i + 1..=j].reverse();
                    continue 'again;
                }
            }
        }
        return at;
    }
}

/// A comb, a spiral and a star, each with so many teeth.
fn shapes(teeth: usize) -> [Flat; 3] {
    let x = |k: usize| k as f64;
    let mut comb: Flat = (0..2 * teeth + 1)
        .map(|k| [x(k), x(k % 2) * 5.0 + 1.0])
        .collect();
    comb.extend([[x(2 * teeth), 0.0], [0.0, 0.0]]);
    let round = |k: usize, radius: f64| {
        [
            radius * libm::cos(x(k) * 0.3),
            radius * libm::sin(x(k) * 0.3),
        ]
    };
    let count = 10 * teeth;
    let mut spiral: Flat = (0..count).map(|k| round(k, 5.0 + x(k))).collect();
    spiral.extend((0..count).rev().map(|k| round(k, 4.0 + x(k))));
    let turn = std::f64::consts::PI / teeth as f64;
    let star = (0..2 * teeth).map(|k| {
        let radius = [1.0, 0.1][k % 2];
        [
            radius * libm::cos(x(k) * turn),
            radius * libm::sin(x(k) * turn),
        ]
    });
    [comb, spiral, star.collect()]
}

#[test]
fn simple_polygons_in_any_plane_keep_their_area_and_edges() {
    let mut random = Random(404);
    let mut polygons: Vec<Flat> = (3..12).flat_map(shapes).collect();
    // As many corners as there may be.
    let [comb, _, star] = shapes(MOST_EARS / 2 - 2);
    polygons.extend([comb, star]);
    for count in 4..40 {
        polygons.extend((0..10).map(|_| untangled(&mut random, count)));
    }
    for (k, polygon) in polygons.iter().enumerate() {
        for start in [0, polygon.len() / 2] {
            let mut polygon = polygon.clone();
            polygon.rotate_left(start);
            covers(
                &flat(&polygon),
                &all(&flat(&polygon)).unwrap(),
                &format!("{k} from {start}"),
            );
            let (turn, shift) = (random.rotation(), random.vector() * 3.0);
            let scale = libm::pow(10.0, random.signed() * 3.0);
            let placed: Vec<Point3> = flat(&polygon)
                .iter()
                .map(|p| turn * (p * scale) + shift)
                .collect();
            covers(
                &placed,
                &all(&placed).unwrap(),
                &format!("{k} from {start}, placed"),
            );
        }
    }
}

// Corners on a grid of 5 × 5 meet, lie on edges and in line as often as not.
#[test]
fn what_is_read_covers_what_the_polygon_winds_round_once() {
    let mut random = Random(405);
    let mut read = [0; 2];
    for _ in 0..40_000 {
        let count = random.integer(4, 10);
        let mut grid = || random.integer(0, 4) as f64;
        let mut polygon: Flat = (0..count).map(|_| [grid(), grid()]).collect();
        let points = flat(&polygon);
        if area(&points).z < 0.0 {
            polygon.reverse();
        }
        let points = flat(&polygon);
        let places = (0..400).map(|k| {
            [
                f64::from(k % 20) * 0.2 + 0.013,
                f64::from(k / 20) * 0.2 + 0.0171,
            ]
        });
        let windings: Vec<_> = places.map(|p| (p, winding(&polygon, p))).collect();
        match all(&points) {
            Ok(found) => {
                read[0] += 1;
                for (p, wound) in windings {
                    let corners = |t: &[u32; 3]| t.map(|k| polygon[k as usize]);
                    let cover: i32 = found.iter().map(|t| winding(&corners(t), p)).sum();
                    assert!(
                        cover == wound && (0..=1).contains(&cover),
                        "{polygon:?}: {found:?} at {p:?}"
                    );
                }
            }
            Err(_) if is_simple(&polygon) => panic!("refused: {polygon:?}"),
            Err(_) => read[1] += 1,
        }
    }
    assert!(read[0] > 1000 && read[1] > 1000, "{read:?}");
}

/// No two edges have a place in common but the corner between them.
fn is_simple(polygon: &[[f64; 2]]) -> bool {
    let count = polygon.len();
    let at = |k: usize| Coord {
        x: polygon[k % count][0],
        y: polygon[k % count][1],
    };
    let within = |a: Coord<f64>, b: Coord<f64>, p: Coord<f64>| {
        side([a, b, p]) == 0.0 && (p.x - a.x) * (p.x - b.x) + (p.y - a.y) * (p.y - b.y) <= 0.0
    };
    (0..count).all(|i| {
        (i + 1..count).all(|j| {
            let (a, b, c, d) = (at(i), at(i + 1), at(j), at(j + 1));
            let next = |one: usize, other: usize| (one + 1) % count == other;
            if next(i, j) {
                return !within(a, b, d) && !within(c, d, a);
            }
            if next(j, i) {
                return !within(a, b, c) && !within(c, d, b);
            }
            let crosses =
                side([a, b, c]) * side([a, b, d]) < 0.0 && side([c, d, a]) * side([c, d, b]) < 0.0;
            !crosses && !within(a, b, c) && !within(a, b, d) && !within(c, d, a) && !within(c, d, b)
        })
    })
}

#[test]
fn fans_are_as_they_were_and_holes_are_reached_by_bridges() {
    let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(all(&square), Ok(vec![[0, 1, 2], [0, 2, 3]]));
    // An L whose fan is right only from its inner corner, and a warped square.
    let ell = flat(&[
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
    ]);
    assert_eq!(
        all(&ell),
        Ok(vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    );
    let mut warped = square.clone();
    warped[2].z = 0.4;
    assert_eq!(all(&warped), Ok(vec![[0, 1, 2], [0, 2, 3]]));
    // A square with a hole, and a bridge from the second corner of the one to the first of the other.
    let frame = flat(&[
        [0.0, 0.0],
        [3.0, 0.0],
        [3.0, 3.0],
        [0.0, 3.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [2.0, 1.0],
    ]);
    for bridge in 0..4 {
        for hole in 4..8 {
            let outer = (0..=4).map(|k| (bridge + k) % 4);
            let inner = (0..=4).map(|k| (hole + k) % 4 + 4);
            let corners: Vec<u32> = outer.chain(inner).collect();
            // A bridge across the hole is none.
            let found = triangles(&frame, &corners);
            if (bridge, hole) == (0, 4) || (bridge, hole) == (2, 6) {
                let covered: f64 = found
                    .unwrap()
                    .iter()
                    .map(|t| area(&t.map(|k| frame[k as usize])).z)
                    .sum();
                assert_eq!(covered, 16.0);
            } else if let Ok(found) = found {
                let covered: f64 = found
                    .iter()
                    .map(|t| area(&t.map(|k| frame[k as usize])).z)
                    .sum();
                assert_eq!(covered, 16.0, "{bridge} {hole}");
            }
        }
    }
}

#[test]
fn what_is_no_polygon_says_why() {
    let bow = flat(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]]);
    assert_eq!(all(&bow), Err(Flaw::Crossed));
    let line = flat(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [2.0, 2.0]]);
    assert_eq!(all(&line), Err(Flaw::Flat));
    let spike = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(all(&spike), Err(Flaw::Crossed));
    let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(
        triangles(&square, &[0, 1, 2, 3, 0, 1, 2, 3]),
        Err(Flaw::Crossed),
        "twice round"
    );
    assert_eq!(triangles(&square, &[0, 1, 1, 0]), Err(Flaw::Flat));
    assert_eq!(
        triangles(&square, &[0, 0, 1, 2, 0]),
        Ok(vec![[0, 1, 2]]),
        "corners that come twice in turn are one"
    );
    let [comb, ..] = shapes(MOST_EARS);
    assert_eq!(all(&flat(&comb)), Err(Flaw::Long));
}
