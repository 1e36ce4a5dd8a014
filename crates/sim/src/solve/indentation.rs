//! How far a ball goes into a solid beyond what the solid's control net can show.
//!
//! A ball that touches lightly presses a patch smaller than the spans of the net. The net gives way
//! there as if a patch of its own size were pressed, which is too little: the smaller the patch, the
//! farther a force goes in. By Hertz, a ball of radius R on a half-space of modulus E* = E / (1 − ν²)
//! presses a patch of radius a = ∛(3 F R / 4 E*) under a force F, and goes in by a² / R. A net that
//! spreads forces over a radius a₀ shows a patch of about ∛(a³ + a₀³), under which the same force
//! goes in by a³ / (R ∛(a³ + a₀³)). What is missing is
//!
//! ```text
//! δ = a₀² / R · g(a / a₀),    g(x) = x² − x³ / ∛(1 + x³)
//! ```
//!
//! It rises up to a = 1.04 a₀ and stays as large from there on: a contact that gave way less the
//! harder it is pressed could turn unstable within a tick. So it is at most 0.21 a₀² / R; and
//! a₀ counts as no larger than the ball.
//!
//! Source: K. L. Johnson, *Contact Mechanics* (1985), eq. 4.22–4.24, for the half-space. That
//! radii add by their cubes is a fit: it lies between the measured errors of coarse and fine nets.

use palpate_geometry::math::Vector3;

/// Patches smaller than this, relative to the net's own, count as if they were so large: below it,
/// force and depth are proportional, so that first touch has a finite stiffness.
const LEAST_PATCH: f64 = 0.25;
/// Where g is largest: 2 ∛(1 + x³)⁴ = x (3 + 2 x³).
const LARGEST: f64 = 1.044_344_433_009_053_4;

/// How finely a solid resolves what presses it at a place of its surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// E / (1 − ν²), Pa.
    pub plane_modulus_pa: f64,
    /// Radius over which a force on one place of the net spreads, m.
    pub patch_m: f64,
    /// Mean curvature of the surface at rest, 1/m; positive where it is convex.
    pub curvature_1_m: f64,
}

impl Resolution {
    /// Of a place that control points with these weights make; zeros where they have none.
    pub fn blend(of: &[Self], controls: &[u32], weights: &[f64]) -> Self {
        debug_assert_eq!(controls.len(), weights.len(), "a weight a control point");
        let mut sum = Self::default();
        for (&control, weight) in controls.iter().zip(weights) {
            if let Some(one) = of.get(control as usize) {
                sum.add(*weight, one);
            }
        }
        sum
    }

    /// Adds a multiple of another.
    pub fn add(&mut self, share: f64, other: &Self) {
        self.plane_modulus_pa += share * other.plane_modulus_pa;
        self.patch_m += share * other.patch_m;
        self.curvature_1_m += share * other.curvature_1_m;
    }
}

/// δ linear about a force: `offset_m + slope_m_n F`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Indentation {
    /// Along which the ball goes in, out of the body.
    pub normal: Vector3,
    /// m.
    pub offset_m: f64,
    /// m/N, no less than zero.
    pub slope_m_n: f64,
}

impl Indentation {
    /// Of a ball about a force (N); zero where the surface is hollower than the ball is round.
    pub fn of(radius_m: f64, at: &Resolution, force_n: f64, normal: &Vector3) -> Self {
        let curvature = 1.0 / radius_m + at.curvature_1_m;
        if !(radius_m > 0.0 && curvature > 0.0 && at.plane_modulus_pa > 0.0 && at.patch_m > 0.0) {
            return Self::default();
        }
        // Hertz' patches are smaller than the ball.
        let patch_m = at.patch_m.min(radius_m);
        // R is that of ball and surface together; F = load x³.
        let scale_m = patch_m * patch_m * curvature;
        let load_n = 4.0 / 3.0 * at.plane_modulus_pa * patch_m * scale_m;
        let x = libm::cbrt(force_n.max(0.0) / load_n);
        let (offset_m, slope_m_n) = if x <= LEAST_PATCH {
            let least_n = load_n * LEAST_PATCH * LEAST_PATCH * LEAST_PATCH;
            (0.0, scale_m * missing(LEAST_PATCH).0 / least_n)
        } else {
            let (deep, rise) = missing(x.min(LARGEST));
            let slope = if x < LARGEST {
                scale_m * rise / (3.0 * load_n * x * x)
            } else {
                0.0
            };
            (scale_m * deep - slope * force_n, slope)
        };
        Self {
            normal: *normal,
            offset_m,
            slope_m_n,
        }
    }
}

/// A ball that touches a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// Of the ball, m; 0: none.
    pub radius_m: f64,
    /// Where it touches.
    pub place: Resolution,
    /// Out of the body.
    pub normal: Vector3,
    /// All that the body bore of the ball in the last tick, N.
    pub force_n: f64,
}

/// A force this many times that of the last tick is a hit.
const HIT: f64 = 4.0;

impl Touch {
    /// The indentation of this tick, in which the ball is `depth_m` inside before contact moves anything
    /// and the surface gives way by `compliance_m_n`: linear about the force of the last tick, or, where a hit
    /// makes it more than four times that, about the force of this depth.
    pub fn indentation(&self, depth_m: f64, compliance_m_n: f64) -> Indentation {
        let near = |force_n| Indentation::of(self.radius_m, &self.place, force_n, &self.normal);
        let last = near(self.force_n);
        let most_n = depth_m / compliance_m_n;
        if !(most_n > HIT * self.force_n && most_n.is_finite()) {
            return last;
        }
        // c F + δ(F) rises with F.
        let (mut low, mut high) = (0.0, most_n);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let there = near(middle);
            let deep = there.offset_m + (there.slope_m_n + compliance_m_n) * middle;
            *(if deep < depth_m { &mut low } else { &mut high }) = middle;
        }
        if low > HIT * self.force_n {
            near(low)
        } else {
            last
        }
    }
}

/// Enough for a billionth.
const HALVINGS: usize = 30;

/// g(x), and how it rises.
fn missing(x: f64) -> (f64, f64) {
    let cube = x * x * x;
    let shown = libm::cbrt(1.0 + cube);
    (
        x * x - cube / shown,
        2.0 * x - x * x * (3.0 + 2.0 * cube) / ((1.0 + cube) * shown),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(force_n: f64) -> Indentation {
        let place = Resolution {
            plane_modulus_pa: 20e3,
            patch_m: 2e-3,
            curvature_1_m: 50.0,
        };
        Indentation::of(0.01, &place, force_n, &Vector3::z())
    }

    fn deep(force_n: f64) -> f64 {
        let near = at(force_n);
        near.offset_m + near.slope_m_n * force_n
    }

    /// Force under which the patch is as large as the net's: 4 E* a₀³ / 3 R.
    const LOAD_N: f64 = 4.0 / 3.0 * 20e3 * 8e-9 * 150.0;

    #[test]
    fn far_finer_than_the_net_it_is_hertz_and_never_more() {
        for x in [0.26_f64, 0.5, 1.0] {
            let hertz = (x * 2e-3).powi(2) * 150.0;
            let shown = hertz * x / (1.0 + x.powi(3)).cbrt();
            let missing = deep(LOAD_N * x.powi(3));
            assert!((missing / (hertz - shown) - 1.0).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn it_rises_with_the_force_and_its_slope_says_how() {
        let mut last = 0.0;
        for k in 1..4_000 {
            let force_n = LOAD_N * 1e-3 * f64::from(k);
            let now = deep(force_n);
            assert!(
                now >= last - 1e-18,
                "at {force_n} N: {now} m after {last} m"
            );
            let step = 1e-6 * force_n;
            let slope = (deep(force_n + step) - deep(force_n - step)) / (2.0 * step);
            let stated = at(force_n).slope_m_n;
            assert!(stated >= 0.0);
            // Between the two forces the slope may change where g is largest.
            assert!(
                (slope - stated).abs() < 1e-3 * slope.max(1e-6),
                "at {force_n} N: {slope} and {stated} m/N"
            );
            last = now;
        }
        let largest = 150.0 * 4e-6 * 0.206_640_226_948_319_63;
        assert!(
            (last / largest - 1.0).abs() < 1e-12,
            "{last} m of {largest} m"
        );
    }

    #[test]
    fn a_small_ball_on_a_coarse_net_stays_outside() {
        let place = Resolution {
            plane_modulus_pa: 20e3,
            patch_m: 10e-3,
            curvature_1_m: 0.0,
        };
        let near = Indentation::of(1e-3, &place, 1e6, &Vector3::z());
        assert!(near.slope_m_n == 0.0 && near.offset_m < 0.21e-3, "{near:?}");
    }

    #[test]
    fn a_hit_meets_what_its_depth_means_at_once() {
        let touch = Touch {
            radius_m: 0.01,
            place: Resolution {
                plane_modulus_pa: 20e3,
                patch_m: 2e-3,
                curvature_1_m: 50.0,
            },
            normal: Vector3::z(),
            force_n: 0.0,
        };
        let compliance = 1e-2;
        for depth in [1e-5, 1e-4, 1e-3, 1.0] {
            let near = touch.indentation(depth, compliance);
            let force = (depth - near.offset_m) / (near.slope_m_n + compliance);
            let missed = deep(force) + compliance * force - depth;
            assert!(
                missed.abs() < 1e-8 * depth,
                "{depth} m: {missed} m off at {force} N"
            );
        }
        // Close to the force of the last tick it stays near that.
        let held = Touch {
            force_n: 0.05,
            ..touch
        };
        let depth = deep(0.051) + compliance * 0.051;
        assert_eq!(held.indentation(depth, compliance), at(0.05));
    }

    #[test]
    fn points_have_none() {
        let place = Resolution {
            plane_modulus_pa: 20e3,
            patch_m: 2e-3,
            curvature_1_m: 50.0,
        };
        assert_eq!(
            Indentation::of(0.0, &place, 1.0, &Vector3::z()),
            Indentation::default()
        );
    }

    #[test]
    fn hollow_places_and_no_solid_have_none() {
        let hollow = Resolution {
            plane_modulus_pa: 20e3,
            patch_m: 2e-3,
            curvature_1_m: -120.0,
        };
        for place in [hollow, Resolution::default()] {
            assert_eq!(
                Indentation::of(0.01, &place, 1.0, &Vector3::z()),
                Indentation::default()
            );
        }
    }
}
