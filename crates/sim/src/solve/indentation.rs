//! How far a tool goes into a solid beyond what the solid's control net can show.
//!
//! A tool that touches lightly presses a patch smaller than the spans of the net. The net gives way
//! there as if a patch of its own size were pressed, which is too little: the smaller the patch, the
//! farther a force goes in. On a half-space of modulus E* = E / (1 − ν²) a tool that stands f(r) over
//! the surface at a distance r from where it touches first presses a patch of radius a when it goes in
//! by δ(a), under the force F(a):
//!
//! ```text
//! f = α r + β r² + γ r⁴      δ = π α a / 2 + 2 β a² + 8 γ a⁴ / 3      F = 2 E* (π α a² / 4 + 4 β a³ / 3 + 32 γ a⁵ / 15)
//! ```
//!
//! A force on one place of a net that spreads it over a radius a₀ goes in by F / (2 E* a₀). What is
//! missing is δ(a) − F(a) / (2 E* a₀). It rises with slope (1/a − 1/a₀) / (2 E*) up to a = a₀ and stays
//! as large from there on, whatever the tool.
//!
//! A net of cubes of side h moves under pressure like the half-space but for
//! (1 − exp(−k s))⁴ of waves of number k, s = 1.06 h: a force on one place goes in by 25 / (12 π E* s), so
//! a₀ = 6 π s / 25 = 0.80 h, for cells of another shape the root of spans and cube root of volumes. Solved with that
//! response, what is missing under a paraboloid is as above up to a₀, then falls from 0.19 s² β by a quarter
//! until a = 2.7 a₀; under a cone it is none from 2 a₀ on.
//!
//! Source: I. N. Sneddon, Int. J. Engng. Sci. 3 (1965) 47, for the half-space.

use palpate_geometry::math::{Matrix3, Point3, Vector3};
use std::f64::consts::PI;

/// a₀ over the side of a cube of the net.
pub const PATCH: f64 = 6.0 * PI / 25.0 * 1.06;
/// a₀ over the spans of a net whose control points are coordinates: it shows waves up to the length of two
/// spans as they are. Measured: slabs of 8 to 16 spans then have 0.9 to 1.16 times Hertz' force.
pub const PATCH_OF_SMOOTH: f64 = 0.57 * PATCH;
/// Sum of the squares of a place's weights at a control point of a cubic net.
const AT_NODE: f64 = 0.25;
/// That sum in the middle of a cell.
const IN_CELL: f64 = 0.2117;
/// How much more the net gives way where these are larger. Measured: without it a ball on slabs of 8 and 16 spans
/// has 4 and 10 % more force in a cell than on a node, with it 1 %.
pub const FOCUS: f64 = 0.6;
/// As [`FOCUS`], for a net whose control points are coordinates. Measured: without it a ball on slabs of 8 to 16 spans has
/// 8 to 30 % more force in a cell than on a node.
pub const FOCUS_OF_SMOOTH: f64 = 1.9;
/// Patches smaller than this, relative to a₀, count as if they were so large: below it, force and depth
/// are proportional, so that first touch has a finite stiffness.
const LEAST_PATCH: f64 = 0.005;

/// What would change with forces by more than what undoes that change comes by this share of it in a tick.
pub const EASE: f64 = 0.1;
/// By how much of itself a round tool's part is less where the patch is twice the net's. Of the response above; a ball
/// pressed 2 mm into a slab of 16 spans has 3 % more force for it.
pub const LESS: f64 = 0.25;
/// As [`LESS`], for a net whose control points are coordinates: it gives way under a wider patch as it does under one point.
/// Measured: 1 mm under a ball of 10 mm, control points of slabs of 12 and 16 spans have 0.91 and 0.92 times Hertz' force
/// with 0.25, 0.93 with this; with 0.8 a teardrop with a focus has 6 % too much.
pub const LESS_OF_SMOOTH: f64 = 0.6;

/// How much larger a₀ of such a net is where its layers are so many times as thick as its spans are long. Measured on slabs
/// whose cells are 10 and 30 mm thick under spans of 3.75 to 7.5 mm: without it they have up to 2.5 times Hertz' force; those
/// twice as thick as their spans have 1.16 times without the power, 1.06 with it.
pub fn of_layers(thick: f64) -> f64 {
    (1.07 * thick.sqrt() - 0.61).max(libm::pow(thick.max(1.0), 0.1))
}

/// How finely a solid resolves what presses it at a place of its surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// E / (1 − ν²), Pa.
    pub plane_modulus_pa: f64,
    /// By how much more a patch gives way across its normal than along it: (2 − ν) / (2 − 2 ν).
    pub across: f64,
    /// 1 + d / dt: how much stiffer damping makes it within a tick.
    pub voigt: f64,
    /// a₀: radius over which a force on one place of the net spreads, m.
    pub patch_m: f64,
    /// How much of that is due to where between control points the place is.
    pub focus: f64,
    /// By how much of itself a round tool's part is less where the patch is twice the net's.
    pub less: f64,
    /// Mean curvature of the surface at rest, 1/m; positive where it is convex.
    pub curvature_1_m: f64,
    /// One over the depth to which a tool may go in, 1/m; 0 where it is as deep as it likes.
    pub thin_1_m: f64,
}

impl Resolution {
    /// Of a place that control points with these weights make; zeros where they have none.
    pub fn blend(of: &[Self], controls: &[u32], weights: &[f64]) -> Self {
        debug_assert_eq!(controls.len(), weights.len(), "a weight a control point");
        let (mut sum, mut squares) = (Self::default(), 0.0);
        for (&control, weight) in controls.iter().zip(weights) {
            if let Some(one) = of.get(control as usize) {
                sum.add(*weight, one);
                squares += weight * weight;
            }
        }
        // At a pole many control points are one.
        let squares = squares.max(IN_CELL);
        sum.patch_m /= 1.0 + sum.focus * (squares / AT_NODE - 1.0);
        sum
    }

    /// Adds a multiple of another.
    pub fn add(&mut self, share: f64, other: &Self) {
        self.plane_modulus_pa += share * other.plane_modulus_pa;
        self.across += share * other.across;
        self.voigt += share * other.voigt;
        self.patch_m += share * other.patch_m;
        self.focus += share * other.focus;
        self.less += share * other.less;
        self.curvature_1_m += share * other.curvature_1_m;
        self.thin_1_m += share * other.thin_1_m;
    }
}

/// How high a tool stands over a surface around the place where it touches: α r + β r² + γ r⁴.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Profile {
    /// α, of a tip.
    pub slope: f64,
    /// β, half the curvature, 1/m.
    pub bend_1_m: f64,
    /// γ, of a rounded edge, 1/m³.
    pub rim_1_m3: f64,
}

impl Profile {
    /// Of curved surfaces.
    pub fn round(curvature_1_m: f64) -> Self {
        Self {
            bend_1_m: 0.5 * curvature_1_m,
            ..Self::default()
        }
    }

    /// Of a ball.
    pub fn ball(radius_m: f64) -> Self {
        Self {
            rim_1_m3: 0.125 / (radius_m * radius_m * radius_m),
            ..Self::round(1.0 / radius_m)
        }
    }

    /// The sum of terms, none of them negative, that is nearest to heights at these radii, (m, m), relative to the
    /// heights.
    pub fn through(points: &[(f64, f64); 3]) -> Self {
        let row = |(r, height): (f64, f64)| Vector3::new(r, r * r, r * r * r * r) / height;
        let rows = points.map(row);
        let of = |used: usize| {
            let keep = |k: usize| if used >> k & 1 == 1 { 1.0 } else { 0.0 };
            let keep = Vector3::new(keep(0), keep(1), keep(2));
            let size = rows
                .iter()
                .fold(Vector3::zeros(), |size, row| size + row.component_mul(row));
            let size = size.map(f64::sqrt);
            let (mut matrix, mut right) = (Matrix3::identity(), Vector3::zeros());
            matrix -= Matrix3::from_diagonal(&keep);
            for row in &rows {
                let row = row.component_div(&size).component_mul(&keep);
                matrix += row * row.transpose();
                right += row;
            }
            let found = matrix.try_inverse()? * right;
            let missed = |row: &Vector3| (row.component_div(&size).dot(&found) - 1.0).powi(2);
            let missed: f64 = rows.iter().map(missed).sum();
            (found.min() >= 0.0).then(|| (missed, found.component_div(&size)))
        };
        let best = (1..8).filter_map(of).min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(Self::default(), |(_, found)| Self {
            slope: found.x,
            bend_1_m: found.y,
            rim_1_m3: found.z,
        })
    }

    /// On a surface that is bent itself, by this mean curvature; nothing where that is hollower.
    pub fn on(&self, curvature_1_m: f64) -> Self {
        let bend_1_m = (self.bend_1_m + 0.5 * curvature_1_m).max(0.0);
        Self { bend_1_m, ..*self }
    }

    /// With heights so many times as large.
    pub fn times(&self, share: f64) -> Self {
        Self {
            slope: share * self.slope,
            bend_1_m: share * self.bend_1_m,
            rim_1_m3: share * self.rim_1_m3,
        }
    }

    /// How far it goes into a half-space where it presses a patch of this radius, m.
    fn depth_m(&self, a: f64) -> f64 {
        a * (0.5 * PI * self.slope + a * (2.0 * self.bend_1_m + 8.0 / 3.0 * self.rim_1_m3 * a * a))
    }

    /// The force under which it does, over 2 E*, m².
    fn load_m2(&self, a: f64) -> f64 {
        let (tip, rim) = (0.25 * PI * self.slope, 32.0 / 15.0 * self.rim_1_m3 * a * a);
        a * a * (tip + a * (4.0 / 3.0 * self.bend_1_m + rim))
    }

    /// The radius of the patch under a load that is less than that of `most_m`, m.
    fn patch_of_load_m(&self, load_m2: f64, most_m: f64) -> f64 {
        // Both are convex: Newton's steps from above stay above.
        newton(
            most_m,
            |a| self.load_m2(a) - load_m2,
            |a| a * self.depth_slope(a),
        )
    }

    /// The radius of the patch at a depth, or `most_m`.
    fn patch_of_depth_m(&self, depth_m: f64, most_m: f64) -> f64 {
        if self.depth_m(most_m) <= depth_m {
            return most_m;
        }
        newton(
            most_m,
            |a| self.depth_m(a) - depth_m,
            |a| self.depth_slope(a),
        )
    }

    /// How the depth grows with the radius of the patch.
    fn depth_slope(&self, a: f64) -> f64 {
        0.5 * PI * self.slope + a * (4.0 * self.bend_1_m + 32.0 / 3.0 * self.rim_1_m3 * a * a)
    }
}

/// The zero of a convex function that rises, from above.
fn newton(from: f64, f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> f64 {
    let mut a = from;
    for _ in 0..NEWTON {
        let step = f(a) / slope(a);
        a -= step;
        if step.is_nan() || step <= 1e-12 * a {
            break;
        }
    }
    a
}

/// Enough from four times the radius.
const NEWTON: usize = 20;

/// δ linear about a force: `offset_m + slope_m_n F`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Indentation {
    /// Along which the tool goes in, out of the body.
    pub normal: Vector3,
    /// m.
    pub offset_m: f64,
    /// m/N, no less than zero.
    pub slope_m_n: f64,
    /// Across the normal within the tick, m/N; no less than zero.
    pub across_m_n: f64,
}

impl Indentation {
    /// How far a force takes the tool, m/N.
    pub fn block_m_n(&self) -> Matrix3 {
        let along = self.normal * self.normal.transpose();
        along * self.slope_m_n + (Matrix3::identity() - along) * self.across_m_n
    }

    /// Of a tool about its force, N, with those of others beside it as they were.
    pub fn of(touch: &Touch, force_n: f64) -> Self {
        let Touch {
            profile,
            place,
            normal,
            flat_1_m,
            most_m,
            share,
            beside_n,
            less_m,
            ..
        } = touch;
        let force_n = force_n * share;
        let all_n = force_n + beside_n;
        let (patch_m, twice_pa) = (place.patch_m, 2.0 * place.plane_modulus_pa);
        if twice_pa.is_nan() || twice_pa <= 0.0 {
            return Self::default();
        }
        let full_m = profile.patch_of_depth_m(*most_m, patch_m);
        let full_m2 = profile.load_m2(full_m);
        let missing_m = |a: f64| profile.depth_m(a) - profile.load_m2(a) / patch_m;
        let least_m = LEAST_PATCH * full_m;
        let (load_m2, least_m2) = (all_n.max(0.0) / twice_pa, profile.load_m2(least_m));
        let (offset_m, slope_m_n) = if full_m2 <= 0.0 {
            (0.0, 0.0)
        } else if load_m2 <= least_m2 {
            let slope = missing_m(least_m) / (twice_pa * least_m2);
            (slope * beside_n, slope)
        } else if load_m2 < full_m2 {
            let a = profile.patch_of_load_m(load_m2, full_m);
            let slope = (1.0 / a - 1.0 / patch_m) / twice_pa;
            (missing_m(a) - slope * force_n, slope)
        } else {
            (missing_m(full_m), 0.0)
        };
        // Several rows press a patch wider than the net's, and slip one after the other.
        let one_place = (2.0 - libm::cbrt(load_m2 / full_m2)).clamp(0.0, 1.0);
        let shown_m_n = match one_place > 0.0 {
            true => one_place / (twice_pa * patch_m),
            false => 0.0,
        };
        // Less from zero on is none.
        let offset_m = (offset_m - less_m).max(-slope_m_n * force_n);
        let flat_m_n = flat_1_m / twice_pa;
        Self {
            normal: *normal,
            offset_m: offset_m + flat_m_n * beside_n,
            // A face is one place.
            slope_m_n: slope_m_n * share + flat_m_n,
            across_m_n: touch.across_m_n(slope_m_n * share, shown_m_n * share) / place.voigt,
        }
    }
}

/// A tool that touches a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// Of the tool over the surface.
    pub profile: Profile,
    /// What a net shows too little of the tool's flat face, times 2 E*, 1/m.
    pub flat_1_m: f64,
    /// It goes in by no more, m.
    pub most_m: f64,
    /// What the body is where it touches.
    pub place: Resolution,
    /// Where it touches, m.
    pub point: Point3,
    /// Out of the body.
    pub normal: Vector3,
    /// All that the body bore of it in the last tick, N.
    pub force_n: f64,
    /// The share of it in one place.
    pub share: f64,
    /// What other tools pushed there, N.
    pub beside_n: f64,
    /// By how much less it goes in where the net shows more than one place, m.
    pub less_m: f64,
    /// How far friction has drawn the surface aside beyond what the net shows, m.
    pub drawn_m: Vector3,
    /// Coefficient of static friction; 0 without friction.
    pub mu: f64,
}

/// Cube root of the friction that is left under the least force across that counts.
const LEFT: f64 = 0.999;

/// A force this many times that of the last tick is a hit.
const HIT: f64 = 4.0;

impl Touch {
    /// What it pushed in one place in the last tick, N.
    pub fn in_place_n(&self) -> f64 {
        self.share * self.force_n
    }

    /// How far the surface is drawn aside by friction for each newton beyond what the net shows, at rest, m/N, where it
    /// goes in by so much for each newton, and by so much that the net shows.
    ///
    /// A patch that is pressed with N by a ball slips from its rim on: it is drawn by
    /// 3 µ N c / 2 (1 − (1 − T / (µ N))^⅔) under T (R. D. Mindlin, J. Appl. Mech. 16 (1949) 259), c what it gives way
    /// while all of it sticks, of which the net shows a part, and that part without slip. This is the mean of what is
    /// missing up to where it is drawn now.
    fn across_m_n(&self, slope_m_n: f64, shown_m_n: f64) -> f64 {
        if self.mu == 0.0 {
            return 0.0;
        }
        let [start_m_n, shown_m_n] = [slope_m_n, shown_m_n].map(|c| self.place.across * c);
        let whole_m_n = start_m_n + shown_m_n;
        // Of the friction that holds, by the cube root of what is left of it.
        let missing_m_n = |left: f64| {
            1.5 * whole_m_n * (1.0 - left * left) - shown_m_n * (1.0 - left * left * left)
        };
        let drawn_m_n = self.drawn_m.norm() / (self.mu * self.force_n);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            // It falls with what is left.
            let deep = missing_m_n(middle) > drawn_m_n;
            *(if deep { &mut low } else { &mut high }) = middle;
        }
        // Drawn a little from the start, or it would never begin.
        let left = match drawn_m_n > 0.0 {
            true => low.min(LEFT),
            false => LEFT,
        };
        missing_m_n(left) / (1.0 - left * left * left)
    }

    /// How far it is still drawn aside at the end of the tick without a force, m: a Voigt solid creeps back.
    pub fn left_m(&self) -> Vector3 {
        match self.place.voigt {
            voigt if voigt > 0.0 => self.drawn_m * (1.0 - 1.0 / voigt),
            _ => Vector3::zeros(),
        }
    }

    /// What is less than [`Self::less_m`] comes to under a force, m.
    ///
    /// It follows forces by and by: a step of the force would change a tip's part by more than what undoes that step.
    pub fn less_under_m(&self, force_n: f64) -> f64 {
        let Self {
            profile,
            place,
            most_m,
            share,
            beside_n,
            ..
        } = self;
        let full_m = profile.patch_of_depth_m(*most_m, place.patch_m);
        let over =
            (share * force_n + beside_n) / (2.0 * place.plane_modulus_pa) / profile.load_m2(full_m);
        if over.is_nan() || over <= 1.0 {
            return 0.0;
        }
        let past = |far: f64| far.min(2.0) - 1.0;
        let (tip, round) = (past(over.sqrt()), past(libm::cbrt(over)));
        let tip_m = 0.25 * PI * profile.slope * full_m;
        let full_m = profile.depth_m(full_m) - profile.load_m2(full_m) / place.patch_m;
        tip_m * tip * tip + place.less * (full_m - tip_m).max(0.0) * round
    }

    /// The indentation of this tick, in which the tool is `depth_m` inside before contact moves anything
    /// and the surface gives way by `compliance_m_n`: linear about the force of the last tick, or, where a hit
    /// makes it more than four times that, about the force of this depth.
    pub fn indentation(&self, depth_m: f64, compliance_m_n: f64) -> Indentation {
        let near = |force_n| Indentation::of(self, force_n);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn touch(profile: Profile) -> Touch {
        Touch {
            profile,
            most_m: f64::INFINITY,
            place: Resolution {
                plane_modulus_pa: 20e3,
                patch_m: 2e-3,
                across: 1.0,
                voigt: 1.0,
                ..Resolution::default()
            },
            normal: Vector3::z(),
            share: 1.0,
            ..Touch::default()
        }
    }

    const SHAPES: [Profile; 4] = [
        Profile {
            slope: 0.5,
            bend_1_m: 0.0,
            rim_1_m3: 0.0,
        },
        Profile {
            slope: 0.0,
            bend_1_m: 75.0,
            rim_1_m3: 0.0,
        },
        Profile {
            slope: 0.0,
            bend_1_m: 0.0,
            rim_1_m3: 1e8,
        },
        Profile {
            slope: 0.2,
            bend_1_m: 50.0,
            rim_1_m3: 1e7,
        },
    ];

    /// What is missing under a force, m.
    fn deep(touch: &Touch, force_n: f64) -> f64 {
        let near = Indentation::of(touch, force_n);
        near.offset_m + near.slope_m_n * force_n
    }

    #[test]
    fn it_and_the_net_go_in_as_far_as_a_half_space() {
        // Hertz, Sneddon: F = 4/3 E* √R δ^1.5, F = 2 E* δ² / (π α).
        let net = 1.0 / (2.0 * 20e3 * 2e-3);
        for share in [0.05_f64, 0.2, 0.6, 0.99] {
            let a = share * 2e-3;
            let (radius_m, ball) = (1.0 / 150.0, touch(SHAPES[1]));
            let depth_m = a * a / radius_m;
            let force_n = 4.0 / 3.0 * 20e3 * radius_m.sqrt() * depth_m.powf(1.5);
            let off = deep(&ball, force_n) + net * force_n - depth_m;
            assert!(off.abs() < 1e-9 * depth_m, "ball, {share}: {off} m");
            let depth_m = 0.5 * PI * 0.5 * a;
            let force_n = 2.0 * 20e3 * depth_m * depth_m / (PI * 0.5);
            let off = deep(&touch(SHAPES[0]), force_n) + net * force_n - depth_m;
            assert!(off.abs() < 1e-9 * depth_m, "cone, {share}: {off} m");
        }
    }

    // R. D. Mindlin (1949): a ball pressed with N is drawn aside by 3 µ N c / 2 (1 − (1 − T / (µ N))^⅔), c = across / (2 E* a).
    #[test]
    fn it_and_the_net_are_drawn_aside_as_a_half_space() {
        let (patch_m, twice_pa, mu) = (2e-3, 2.0 * 20e3, 0.5);
        for share in [0.1_f64, 0.6, 0.999, 1.0] {
            let a = share * patch_m;
            let force_n = twice_pa * SHAPES[1].load_m2(a);
            let mut touch = Touch {
                force_n,
                mu,
                ..touch(SHAPES[1])
            };
            let (whole_m_n, net_m_n) = (1.0 / (twice_pa * a), 1.0 / (twice_pa * patch_m));
            for held in [0.05_f64, 0.3, 0.7, 0.95] {
                let across_n = held * mu * force_n;
                for _ in 0..200 {
                    let drawn_m = across_n * Indentation::of(&touch, force_n).across_m_n;
                    touch.drawn_m = Vector3::x() * drawn_m;
                }
                let exact_m =
                    1.5 * mu * force_n * whole_m_n * (1.0 - libm::cbrt((1.0 - held).powi(2)));
                let off = (touch.drawn_m.x + across_n * net_m_n) / exact_m - 1.0;
                assert!(off.abs() < 1e-6, "{share} {held}: {off}");
            }
        }
    }

    #[test]
    fn a_ball_goes_in_as_segedin_says() {
        // C. M. Segedin (1957): δ = a artanh(a / R), F = E* ((a² + R²) artanh(a / R) − a R).
        let (radius_m, ball) = (0.01, Profile::ball(0.01));
        for a in [1e-3_f64, 2e-3, 4e-3] {
            let x = (a / radius_m).atanh();
            let (depth_m, load_m2) = (
                a * x,
                ((a * a + radius_m * radius_m) * x - a * radius_m) / 2.0,
            );
            let bound = (a / radius_m).powi(4);
            assert!((ball.depth_m(a) / depth_m - 1.0).abs() < bound, "{a} m");
            assert!((ball.load_m2(a) / load_m2 - 1.0).abs() < bound, "{a} m");
        }
    }

    #[test]
    fn it_rises_up_to_the_patch_and_its_slope_says_how() {
        for shape in SHAPES {
            let touch = touch(shape);
            let full_n = 2.0 * 20e3 * shape.load_m2(2e-3);
            let mut last = 0.0;
            for k in 1..1_000 {
                let force_n = full_n * 1e-3 * f64::from(k);
                let now = deep(&touch, force_n);
                assert!(
                    now >= last,
                    "{shape:?} at {force_n} N: {now} m after {last} m"
                );
                let step = 1e-6 * force_n;
                let slope =
                    (deep(&touch, force_n + step) - deep(&touch, force_n - step)) / (2.0 * step);
                let stated = Indentation::of(&touch, force_n).slope_m_n;
                assert!(stated >= 0.0);
                assert!(
                    (slope - stated).abs() < 1e-3 * slope + 1e-6,
                    "{shape:?} at {force_n} N: {slope}, {stated} m/N"
                );
                last = now;
            }
        }
    }

    #[test]
    fn half_of_the_force_in_each_of_two_places_goes_in_half_as_far_as_twice() {
        for shape in SHAPES {
            let (one, two) = (
                touch(shape),
                Touch {
                    share: 0.5,
                    ..touch(shape)
                },
            );
            let force_n = 0.1 * 2.0 * 20e3 * shape.load_m2(2e-3);
            let off = deep(&two, 2.0 * force_n) / deep(&one, force_n) - 1.0;
            assert!(off.abs() < 1e-12, "{shape:?}: {off}");
        }
    }

    #[test]
    fn no_tool_goes_in_farther_than_it_is_large() {
        for shape in SHAPES {
            let small = Touch {
                most_m: 1e-4,
                ..touch(shape)
            };
            for force_n in [1e-3, 1.0, 1e6] {
                assert!(deep(&small, force_n) < 1e-4, "{shape:?} at {force_n} N");
            }
        }
    }

    #[test]
    fn a_profile_goes_through_heights_of_its_kind() {
        for shape in SHAPES {
            let height =
                |r: f64| shape.slope * r + shape.bend_1_m * r * r + shape.rim_1_m3 * r.powi(4);
            let found = Profile::through(&[0.5e-3, 1e-3, 2e-3].map(|r| (r, height(r))));
            for r in [0.5e-3, 1e-3, 1.7e-3, 2e-3] {
                let again = found.slope * r + found.bend_1_m * r * r + found.rim_1_m3 * r.powi(4);
                assert!(
                    (again / height(r) - 1.0).abs() < 1e-9,
                    "{shape:?}: {found:?}"
                );
            }
        }
        // Heights that no such sum has: all terms stay positive.
        let wall = Profile::through(&[(0.5e-3, 1e-9), (1e-3, 1e-9), (2e-3, 1.0)]);
        assert!(
            wall.slope >= 0.0 && wall.bend_1_m >= 0.0 && wall.rim_1_m3 >= 0.0,
            "{wall:?}"
        );
    }

    #[test]
    fn a_hit_meets_what_its_depth_means_at_once() {
        let touch = touch(SHAPES[1]);
        let compliance = 1e-2;
        for depth in [1e-5, 1e-4, 1e-3, 1.0] {
            let near = touch.indentation(depth, compliance);
            let force = (depth - near.offset_m) / (near.slope_m_n + compliance);
            let missed = deep(&touch, force) + compliance * force - depth;
            assert!(
                missed.abs() < 1e-6 * depth,
                "{depth} m: {missed} m off at {force} N"
            );
        }
        // Close to the force of the last tick it stays near that.
        let held = Touch {
            force_n: 0.05,
            ..touch
        };
        let depth = deep(&held, 0.051) + compliance * 0.051;
        assert_eq!(
            held.indentation(depth, compliance),
            Indentation::of(&held, 0.05)
        );
    }

    #[test]
    fn a_flat_face_goes_in_as_forces_do_in_one_place_or_many() {
        let face = Touch {
            flat_1_m: 100.0,
            share: 0.25,
            ..touch(Profile::default())
        };
        for force_n in [1e-6, 1.0, 1e3] {
            let off = deep(&face, force_n) / (100.0 / (2.0 * 20e3) * force_n) - 1.0;
            assert!(off.abs() < 1e-12, "{force_n} N: {off}");
        }
    }

    #[test]
    fn what_does_not_stand_off_and_no_solid_have_none() {
        let flat = touch(Profile::default());
        assert_eq!(deep(&flat, 1.0), 0.0);
        let nowhere = Touch {
            place: Resolution::default(),
            ..touch(SHAPES[1])
        };
        assert_eq!(Indentation::of(&nowhere, 1.0), Indentation::default());
    }
}
