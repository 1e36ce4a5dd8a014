use super::super::{Interval, Tensor};
use super::*;
use palpate_geometry::math::Random;

/// a + b s + c t in Bernstein form, with the rounding of its sums.
fn plane(a: f64, b: f64, c: f64) -> Tensor {
    Tensor::new(
        [1, 1],
        [a, a + c, a + b, a + b + c]
            .map(|x| Interval::around(x, 1e-15))
            .to_vec(),
    )
}

fn product(planes: &[Tensor]) -> Tensor {
    // A bilinear form is the sum of its rows, each a polynomial in t times one in s.
    planes
        .iter()
        .skip(1)
        .fold(planes[0].clone(), |product, next| {
            let c = next.coefficients();
            let row = |k: usize| super::super::Bernstein::new(vec![c[2 * k], c[2 * k + 1]]);
            let of = |k: usize| {
                let mut unit = vec![Interval::ZERO; 2];
                unit[k] = Interval::point(1.0);
                super::super::Bernstein::new(unit)
            };
            product
                .times_in_t(&row(0))
                .times_in_s(&of(0))
                .plus(&product.times_in_t(&row(1)).times_in_s(&of(1)))
        })
}

fn solve(f: &Tensor, g: &Tensor) -> Found {
    PairSolver::default().solve(&System::new(f, g), &Limits::default())
}

#[test]
fn lines_across_lines_have_all_their_crossings() {
    let mut random = Random(9);
    for _ in 0..60 {
        // Vertical-ish lines s = a + small t, horizontal-ish lines t = b + small s: each pair
        // crosses once.
        let (mut first, mut second) = (Vec::new(), Vec::new());
        let (m, n) = (random.integer(1, 4), random.integer(1, 4));
        for k in 0..m {
            let a = (k as f64 + random.float(0.3, 0.7)) / m as f64;
            first.push((a, random.float(-0.05, 0.05)));
        }
        for k in 0..n {
            let b = (k as f64 + random.float(0.3, 0.7)) / n as f64;
            second.push((b, random.float(-0.05, 0.05)));
        }
        let f = product(
            &first
                .iter()
                .map(|&(a, slope)| plane(-a, 1.0, -slope))
                .collect::<Vec<_>>(),
        );
        let g = product(
            &second
                .iter()
                .map(|&(b, slope)| plane(-b, -slope, 1.0))
                .collect::<Vec<_>>(),
        );
        let mut wanted: Vec<[f64; 2]> = Vec::new();
        for &(a, u) in &first {
            for &(b, v) in &second {
                let s = (a + u * b) / (1.0 - u * v);
                wanted.push([s, b + v * s]);
            }
        }
        let found = solve(&f, &g);
        wanted.retain(|w| w.iter().all(|x| (0.0..=1.0).contains(x)));
        assert_eq!(found.status, Status::Complete);
        assert_eq!(found.roots.len(), wanted.len());
        for w in wanted {
            let nearest = found
                .roots
                .iter()
                .map(|r| (r.at[0] - w[0]).abs().max((r.at[1] - w[1]).abs()));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-12, "{w:?} is {nearest} from the nearest root");
        }
    }
}

#[test]
fn roots_on_edges_and_corners_are_kept_and_proved() {
    for (s, t) in [
        (0.0, 0.0),
        (1.0, 0.4),
        (0.5, 1.0),
        (1.0, 1.0),
        (0.5, 0.5),
        (0.484_375, 0.25),
    ] {
        let found = solve(
            &plane(-s - 0.3 * t, 1.0, 0.3),
            &plane(-t + 0.2 * s, -0.2, 1.0),
        );
        assert_eq!(
            (found.status, found.roots.len()),
            (Status::Complete, 1),
            "({s}, {t}): {found:?}"
        );
        let at = found.roots[0].at;
        assert!(
            (at[0] - s).abs() < 1e-14 && (at[1] - t).abs() < 1e-14,
            "{at:?} is not ({s}, {t})"
        );
    }
}

#[test]
fn a_touching_pair_of_curves_is_a_cluster_and_a_shared_line_a_continuum() {
    // t = 0.3 touches t − 0.3 = (s − 0.6)².
    let square = product(&[plane(-0.6, 1.0, 0.0), plane(-0.6, 1.0, 0.0)]);
    let line = plane(-0.3, 0.0, 1.0);
    let touching = square.minus(&line.elevated([2, 2]));
    let found = solve(&touching, &line);
    assert_eq!(
        (found.status, found.roots.len(), found.clusters.len()),
        (Status::Cluster, 0, 1),
        "{found:?}"
    );
    let cluster = &found.clusters[0];
    assert!(
        cluster.extent() < 2e-5 && cluster.low[0] <= 0.6 && cluster.high[0] >= 0.6,
        "{cluster:?}"
    );

    let diagonal = plane(-0.2, 1.0, -0.7);
    let found = solve(
        &product(&[diagonal.clone(), plane(2.0, 1.0, 0.0)]),
        &product(&[diagonal, plane(3.0, 0.0, 1.0)]),
    );
    assert_eq!(found.status, Status::Continuum);
    assert!(
        found.clusters.len() == 1 && found.clusters[0].extent() > 0.75,
        "{:?}",
        found.clusters.len()
    );
}

#[test]
fn a_small_budget_is_a_status() {
    let f = product(&[
        plane(-0.2, 1.0, 0.1),
        plane(-0.8, 1.0, 0.1),
        plane(-0.5, 1.0, 0.1),
    ]);
    let g = product(&[
        plane(-0.2, 0.1, 1.0),
        plane(-0.8, 0.1, 1.0),
        plane(-0.5, 0.1, 1.0),
    ]);
    let limits = Limits {
        budget: 5,
        coarse_budget: 5,
        half: false,
    };
    assert_eq!(
        PairSolver::default()
            .solve(&System::new(&f, &g), &limits)
            .status,
        Status::Budget
    );
    assert_eq!(solve(&f, &g).roots.len(), 9);
}
