//! Matter and steps at the edge: stiffnesses, densities, ticks, Poisson's ratios, thickness.

use super::super::plasticine::{self, Sweep};
use super::super::scenes::plasticine_text;
use super::Kind;
use super::row::Run;
use super::slab::{RADIUS_M, Slab, THICKNESS_M, checkerboard, press};
use crate::Effort;
use palpate_geometry::math::Vector3;

/// Moduli from a thousandth to a million times 20 kPa in one body: the force lies between those of
/// slabs that are all of the softest and all of the stiffest kind, and the base bears it.
pub(super) fn moduli(kind: Kind) -> Result<Run, String> {
    let mut run = Slab {
        regions: checkerboard("young_pa", &[20.0, 20e3, 20e6, 20e9]),
        ..Slab::new(kind)
    }
    .run()?;
    let force = press(&mut run, RADIUS_M, 0.001, 5_000);
    let only = |young: f64| {
        let material = format!("young_pa = {young:?}, damping_s = 2e-3");
        let slab = Slab {
            material,
            ..Slab::new(kind)
        };
        slab.force_n(0.001, 300)
    };
    let bounds = [only(20.0)?, only(20e9)?];
    run.between(
        "force between those of the softest and the stiffest",
        force,
        bounds,
        "N",
    );
    run.base_bears(force, 0.01)?;
    Ok(run)
}

/// Plasticine of 13 MN/m² and 2500 kg/m³ under a ball: more force presses it farther, more stiffness
/// less far, and so does what stays; where nothing yields, nothing stays.
pub(super) fn plasticine(_kind: Kind) -> Result<Run, String> {
    let mut pressed = Vec::new();
    let mut whole: Option<Run> = None;
    for (force_n, mega) in [
        (10.0, 13.0),
        (30.0, 13.0),
        (60.0, 13.0),
        (30.0, 3.0),
        (30.0, 30.0),
    ] {
        let mut run = Run::new(&plasticine_text(mega * 1e6))?;
        let (force, sweep) =
            plasticine::swept(&mut run.world, false, force_n, mega * 1e6, Effort::Full);
        let mut run = match whole.take() {
            Some(mut whole) => {
                whole.world.add(&run.world);
                whole
            }
            None => run,
        };
        let what = format!("force that the hand keeps at {mega} MPa");
        // At 3 MPa the hand keeps 2.3 % less, since the contact is softer than the net alone.
        run.near(&what, force, force_n, 0.03, "N");
        whole = Some(run);
        pressed.push(sweep);
    }
    let mut run = whole.ok_or("no force is given")?;
    for (what, less, more) in [
        ("by 10 N, less than by 30 N", 0, 1),
        ("by 30 N, less than by 60 N", 1, 2),
        ("at 13 MPa, less than at 3 MPa", 1, 3),
        ("at 30 MPa, less than at 13 MPa", 4, 1),
    ] {
        let (less, more): (&Sweep, &Sweep) = (&pressed[less], &pressed[more]);
        let (low, high) = (less.loaded_m * 1e3, more.loaded_m * 1e3);
        run.between(&format!("pressed {what}"), low, [1e-3, high], "mm");
        // What stays of nothing is rounding.
        let (low, high) = (less.kept_m * 1e3, more.kept_m * 1e3);
        run.between(&format!("stays {what}"), low, [-1e-9, high + 1e-9], "mm");
    }
    run.between("stays of 60 N", pressed[2].kept_m * 1e3, [1e-3, 1.0], "mm");
    Ok(run)
}

/// Ticks of 0.1, 0.5, 2, 10 and 50 ms: the force at rest is that of 1 ms.
pub(super) fn ticks(kind: Kind) -> Result<Run, String> {
    let reference = Slab::new(kind).force_n(0.003, 1_000)?;
    let mut whole: Option<Run> = None;
    for rate_hz in [10_000, 2_000, 500, 100, 20] {
        let mut run = Slab {
            rate_hz,
            ..Slab::new(kind)
        }
        .run()?;
        let force = press(&mut run, RADIUS_M, 0.003, 5_000);
        let what = format!("force at {rate_hz} Hz against that at 1 kHz");
        match &mut whole {
            Some(whole) => {
                whole.world.add(&run.world);
                whole.near(&what, force, reference, 1e-3, "N");
            }
            None => {
                run.near(&what, force, reference, 1e-3, "N");
                whole = Some(run);
            }
        }
    }
    whole.ok_or_else(|| "no rate is given".to_owned())
}

/// Densities of 1 and 10⁶ kg/m³ in turn: at rest inertia has no say.
pub(super) fn densities(kind: Kind) -> Result<Run, String> {
    // Cells of a tonne a litre swing for long.
    let rest = |run: &mut Run, ticks: usize| {
        press(run, RADIUS_M, 0.003, ticks);
        run.stay([0.0, 0.0, RADIUS_M - 0.003], 4 * ticks).z
    };
    let mut run = Slab {
        regions: checkerboard("density_kg_m3", &[1.0, 1e6]),
        material: "young_pa = 20e3, damping_s = 50e-3".to_owned(),
        ..Slab::new(kind)
    }
    .run()?;
    let force = rest(&mut run, 5_000);
    let even = rest(&mut Slab::new(kind).run()?, 1_000);
    run.near("force against that of even density", force, even, 1e-3, "N");
    Ok(run)
}

/// ν = 0.499 and a fixed underside: it can neither yield nor flow, and is stiffer than at 0.45, but not by as
/// much as locking makes it. A half-space is stiffer by (1 − 0.45²) / (1 − 0.499²) = 1.06, a `continuum` here
/// by 1.10; a `net` whose cells lock, by 1.88.
pub(super) fn incompressible(kind: Kind) -> Result<Run, String> {
    let of = |poisson: f64| Slab {
        material: format!("young_pa = 20e3, poisson = {poisson:?}, damping_s = 2e-3"),
        ..Slab::new(kind)
    };
    let mut run = of(0.499).run()?;
    let force = press(&mut run, RADIUS_M, 0.003, 5_000);
    run.base_bears(force, 2e-2)?;
    let softer = of(0.45).force_n(0.003, 1_000)?;
    run.between(
        "force from that at ν = 0.45 to 1.25 times that",
        force,
        [softer, 1.25 * softer],
        "N",
    );
    Ok(run)
}

/// One layer of cells.
pub(super) fn single_layer(kind: Kind) -> Result<Run, String> {
    let mut run = Slab {
        layers: 2,
        ..Slab::new(kind)
    }
    .run()?;
    let force = press(&mut run, RADIUS_M, 0.003, 5_000);
    run.base_bears(force, 1e-3)?;
    Ok(run)
}

/// Jelly that sinks by its own weight.
///
/// A block between walls of its own width, free to slide on them, would shrink by ρ g h² / 2 M; free
/// sides give way, so it sinks by ρ g h² / 2 E times what the fixed underside holds back: between the
/// two.
pub(super) fn own_weight(kind: Kind) -> Result<Run, String> {
    const G: f64 = 9.81;
    let slab = Slab {
        side: 8,
        layers: 5,
        material: "preset = \"jelly\"".to_owned(),
        scene: format!("[gravity]\nacceleration = [0.0, 0.0, {:?}]", -G),
        ..Slab::new(kind)
    };
    let mut run = Run::under(&slab.text(), Vector3::new(0.0, 0.0, -G))?;
    let aside = [0.0, 0.0, 0.05];
    run.stay(aside, 10_000);
    let height = |run: &Run| run.world.surface().point(0.5, 0.5).z;
    let sag = -height(&run);
    // Springs have but one ν, 1/4.
    let (young, density) = (6e3, 1_050.0);
    let nu: f64 = if kind.model == "lattice" { 0.25 } else { 0.45 };
    let confined = young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let column = density * G * THICKNESS_M * THICKNESS_M / 2.0;
    let bounds = [column / confined * 1e3, column / young * 1e3];
    run.between("how far its top sinks", sag * 1e3, bounds, "mm");
    let mut jitter: f64 = 0.0;
    for _ in 0..1_000 {
        run.at(aside);
        jitter = jitter.max((height(&run) + sag).abs());
    }
    run.below("how far its top moves at rest", jitter, 1e-9, "m");
    let (body, _) = run.world.body()?;
    let free = (0..body.coordinate_count()).filter(|&k| body.unknown(k).is_some());
    let weight = free.map(|k| body.masses()[k]).sum::<f64>() * G;
    run.base_bears(weight, 1e-3)?;
    Ok(run)
}
