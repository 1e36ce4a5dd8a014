//! What every reader is put through: round trips, and malformed bytes.

use crate::basis::KnotVector;
use crate::basis::testing::Random;
use crate::math::Point3;
use crate::surface::{ControlNet, Direction, Surface, builtin, file};

/// Builtins of every kind, the rational teardrop, and an open sheet whose outward side is turned.
pub(super) fn surfaces() -> Vec<(&'static str, Surface)> {
    let made = |name, net| builtin(name, net, None).unwrap();
    let rational = file::read(include_str!("../surface/data/teardrop_8_rational.json")).unwrap();
    vec![
        ("sheet", made("sheet", None)),
        ("teardrop 8", made("teardrop", None)),
        ("teardrop 12", made("teardrop", Some([12, 12]))),
        ("teardrop 20", made("teardrop", Some([20, 20]))),
        ("rational teardrop", rational),
        ("sphere", made("sphere", None)),
        ("torus", made("torus", None)),
        ("rational torus", rational_torus()),
    ]
}

/// The torus with weights, and uneven knots.
fn rational_torus() -> Surface {
    let torus = builtin("torus", None, Some(0.3))
        .unwrap()
        .insert_knots(Direction::U, &[0.11, 0.5, 0.5])
        .unwrap();
    let weights = (0..torus.net().points().len())
        .map(|k| 1.0 + 0.1 * (k % 7) as f64)
        .collect();
    let (u, v) = (torus.knots_u().clone(), torus.knots_v().clone());
    Surface::new(u, v, torus.net().clone(), Some(weights))
        .unwrap()
        .oriented_outward()
}

/// A surface of one span a direction, for files small enough to break at every byte.
pub(super) fn small(rational: bool) -> Surface {
    let knots = || KnotVector::clamped_uniform(1, 2).unwrap();
    let points = (0..4)
        .map(|k| Point3::new(f64::from(k / 2), f64::from(k % 2), 0.25))
        .collect();
    let weights = rational.then(|| vec![1.0, 2.0, 1.0, 0.5]);
    Surface::new(
        knots(),
        knots(),
        ControlNet::new(2, 2, points).unwrap(),
        weights,
    )
    .unwrap()
}

/// Largest distance of two surfaces at the same random parameters, over their size.
pub(super) fn difference(a: &Surface, b: &Surface) -> f64 {
    let mut random = Random(5);
    assert_eq!(
        (a.knots_u().domain(), a.knots_v().domain()),
        (b.knots_u().domain(), b.knots_v().domain())
    );
    let at =
        |random: &mut Random, knots: &KnotVector| random.float(knots.domain().0, knots.domain().1);
    let distance = |_| {
        let (u, v) = (at(&mut random, a.knots_u()), at(&mut random, a.knots_v()));
        (a.point(u, v) - b.point(u, v)).norm() / a.size()
    };
    (0..300).map(distance).fold(0.0, f64::max)
}

/// Calls `read` with every beginning of `bytes`; all that are shorter than `whole` must be refused.
pub(super) fn every_prefix(bytes: &[u8], whole: usize, read: impl Fn(&[u8]) -> bool) {
    for end in 0..bytes.len() {
        assert!(
            !read(&bytes[..end]) || end >= whole,
            "read although cut at {end} of {}",
            bytes.len()
        );
    }
}

/// Calls `read` with changed copies of `bytes`: each byte replaced, stretches doubled, dropped or
/// swapped. Nothing is asked but that it returns.
pub(super) fn mutations(bytes: &[u8], seed: u64, read: impl Fn(&[u8])) {
    let mut random = Random(seed);
    for at in 0..bytes.len() {
        let mut changed = bytes.to_vec();
        changed[at] = match random.integer(0, 3) {
            0 => bytes[at] ^ (1 << random.integer(0, 7)),
            1 => b"0123456789.,;()#'$*-+ED\n"[random.integer(0, 23)],
            2 => bytes[random.integer(0, bytes.len() - 1)],
            _ => random.integer(0, 255) as u8,
        };
        read(&changed);
    }
    for _ in 0..200 {
        let start = random.integer(0, bytes.len() - 1);
        let end = random.integer(start, (start + 200).min(bytes.len()));
        let to = random.integer(0, bytes.len());
        let mut dropped = bytes.to_vec();
        let piece: Vec<u8> = dropped.drain(start..end).collect();
        read(&dropped);
        let mut doubled = bytes.to_vec();
        doubled.splice(to..to, piece);
        read(&doubled);
    }
}
