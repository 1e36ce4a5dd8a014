//! The page: its socket, who may use it, and what it does to a scene.

mod browser;
mod crowds;
mod hands;
mod recordings;
mod security;
mod shown;

use crate::daemon::SOFT_DROP;

/// A rigid drop and two balls, which builds at once.
pub const TWO_BALLS: &str = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
[[tool]]
id = "other"
shape = { sphere = { radius_m = 0.005 } }
pose = { position = [-0.06, 0.003, 0.045] }
"#;

/// A ball that a page presses into a soft drop.
pub const SOFT: &str = SOFT_DROP;
