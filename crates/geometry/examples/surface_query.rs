//! Build a B-spline surface, evaluate it, and query closest points and contacts.
//!
//! `cargo run -p palpate-geometry --example surface_query`

use palpate_geometry::basis::KnotVector;
use palpate_geometry::contact::exact::{ExactScratch, ball};
use palpate_geometry::contact::{ContactSet, Reach};
use palpate_geometry::exchange::{Format, Pick, read_surface, write_surface};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{ClosestSolver, ControlNet, Surface};

type Error = Box<dyn std::error::Error>;

/// A biquadratic patch over the square [0, 2]² (m): z = x² + y².
fn bowl() -> Result<Surface, Error> {
    // Quadratic Bézier: x(u) = 2u from ordinates 0, 1, 2, and x² = 4u² from ordinates 0, 0, 4.
    let (linear, square) = ([0.0, 1.0, 2.0], [0.0, 0.0, 4.0]);
    let mut points = Vec::new();
    for i in 0..3 {
        for j in 0..3 {
            points.push(Point3::new(linear[i], linear[j], square[i] + square[j]));
        }
    }
    let knots = KnotVector::clamped_uniform(2, 3)?;
    let net = ControlNet::new(3, 3, points)?;
    Ok(Surface::new(knots.clone(), knots, net, None)?)
}

/// Runs the example.
pub fn main() -> Result<(), Error> {
    let surface = bowl()?;

    // Evaluate: point and derivatives at (u, v).
    let frame = surface.frame(0.25, 0.5);
    println!("S(0.25, 0.5) = {}, S_u = {}", frame.point, frame.du);
    assert!((frame.point - Point3::new(0.5, 1.0, 1.25)).norm() < 1e-14);

    // Closest point: certified to be the global minimum of the distance.
    let mut solver = ClosestSolver::new(&surface);
    let query = Point3::new(0.8, 0.9, 3.0);
    let foot = solver.closest(&surface, &query);
    println!(
        "closest to {query}: {} at {:.6} m",
        foot.point, foot.distance
    );
    let tangents = surface.frame(foot.u, foot.v);
    let difference = query - foot.point;
    assert!(difference.dot(&tangents.du).abs() < 1e-12);
    assert!(difference.dot(&tangents.dv).abs() < 1e-12);
    for k in 0..=100 {
        for l in 0..=100 {
            let sample = surface.point(f64::from(k) / 100.0, f64::from(l) / 100.0);
            assert!((query - sample).norm() >= foot.distance);
        }
    }

    // Contact: a ball of radius 0.2 m whose centre is 0.15 m above the surface, along its normal.
    let mut scratch = ExactScratch::new(&surface, &mut solver);
    let mut contacts = ContactSet::new();
    let centre = surface.point(0.2, 0.2) + 0.15 * surface.normal(0.2, 0.2);
    ball::contacts(
        &surface,
        &mut solver,
        &centre,
        0.2,
        &Reach::TOUCH,
        &mut scratch,
        &mut contacts,
    );
    let contact = contacts.deepest().ok_or("the ball touches the bowl")?;
    println!(
        "contact at u {:.3}, v {:.3}, depth {:.3} m",
        contact.u, contact.v, contact.depth_m
    );
    assert!((contact.depth_m - 0.05).abs() < 1e-12);
    let gap = contact.on_body - contact.on_tool - contact.normal * contact.depth_m;
    assert!(gap.norm() < 1e-12);

    // Exchange: a STEP file in metres reads back to the same surface.
    let step = write_surface(&surface, Format::Step, Unit::Metre)?;
    let back = read_surface(&step, Format::Step, Pick::default())?;
    println!("STEP file of {} bytes", step.len());
    assert_eq!(back.surface.net(), surface.net());
    Ok(())
}
