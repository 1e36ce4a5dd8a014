//! `--mouse-tool`: a ball more in the scene, for pages to press with.

use palpate_sim::scene::file::Loaded;
use palpate_sim::scene::spec::{Clock, CouplingSpec, PoseSpec, ShapeSpec, Sphere, ToolSpec};

/// Its id.
const ID: &str = "mouse";
/// Of the largest body, where the scene has no ball.
const SHARE: f64 = 0.04;

/// `10mm`, `1cm`, `0.01m`, in metres; `auto` is `None`.
pub fn radius(text: &str) -> Result<Option<f64>, String> {
    if text == "auto" {
        return Ok(None);
    }
    let units = [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)];
    let radius = units.iter().find_map(|(unit, metres)| {
        let number: f64 = text.strip_suffix(unit)?.trim().parse().ok()?;
        Some(number * metres)
    });
    match radius {
        Some(radius) if radius > 0.0 && radius <= 10.0 => Ok(Some(radius)),
        _ => Err(format!("{text:?} is not a radius; write 10mm or 0.01m")),
    }
}

/// Adds the ball above the bodies. Its coupling is as soft as the hand needs that takes it. Without a radius it is as
/// large as the smallest ball of the scene, so that nets are refined as they are without it.
///
/// # Errors
/// The scene cannot be built, runs in lockstep, or has a tool of this name.
pub fn add(loaded: &mut Loaded, radius: Option<f64>) -> anyhow::Result<()> {
    if loaded.spec.loop_.clock == Clock::Lockstep {
        anyhow::bail!(
            "--mouse-tool: in lockstep a tick waits for a pose of every tool, also while nobody holds the mouse's; \
             run in real time (--clock realtime)"
        );
    }
    if loaded.spec.tools.iter().any(|tool| tool.id == ID) {
        anyhow::bail!(
            "--mouse-tool: the scene has a tool {ID:?} of its own; pages can take that one"
        );
    }
    let scene = loaded.build()?;
    let nets = (0..scene.body_count()).map(|body| scene.skin(body).points());
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in nets.flatten() {
        for c in 0..3 {
            (low[c], high[c]) = (low[c].min(point[c]), high[c].max(point[c]));
        }
    }
    let of_scene = (loaded.spec.tools.iter()).filter_map(|tool| match &tool.shape {
        ShapeSpec::Sphere(Sphere { radius_m }) => Some(*radius_m),
        _ => None,
    });
    let smallest = of_scene.fold(f64::INFINITY, f64::min);
    let largest_m = (0..scene.body_count())
        .map(|body| scene.skin(body).size_m())
        .fold(0.0, f64::max);
    let radius_m = match radius {
        Some(radius) => radius,
        None if smallest.is_finite() => smallest,
        None => SHARE * largest_m,
    };
    let middle = |c: usize| 0.5 * (low[c] + high[c]);
    let pose = PoseSpec {
        // A surface lies within the box of its net.
        position: [middle(0), middle(1), high[2] + 2.0 * radius_m],
        ..PoseSpec::default()
    };
    loaded.spec.tools.push(ToolSpec {
        id: ID.to_owned(),
        shape: ShapeSpec::Sphere(Sphere { radius_m }),
        pose,
        coupling: CouplingSpec {
            bounded: true,
            ..CouplingSpec::default()
        },
        device: Default::default(),
        friction: None,
        grip: Default::default(),
        fixes_nodes: false,
        action: None,
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_read_as_people_write_them() {
        for (text, metres) in [("10mm", 0.01), ("1 cm", 0.01), ("0.02m", 0.02)] {
            let read = radius(text).unwrap().unwrap();
            assert!((read - metres).abs() < 1e-12, "{text}");
        }
        assert_eq!(radius("auto"), Ok(None));
        for text in ["", "10", "-1mm", "0m", "nanm", "11m", "ten mm"] {
            assert!(radius(text).is_err(), "{text:?}");
        }
    }
}
