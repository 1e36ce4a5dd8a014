//! Solids f ≤ 0 in the tool's frame, and the depth of a point in them.

use super::expression::ExpressionError;
use super::interval::Interval;
use super::side::Side;
use super::tape::Tape;
use crate::contact::Features;
use crate::math::{Point3, Pose, Vector3};

/// A solid around the tool's reference point; axes are along z.
#[derive(Clone, Debug, PartialEq)]
pub enum ImplicitShape {
    /// A ball.
    Sphere {
        /// Radius, m.
        radius_m: f64,
    },
    /// A round bar, from −half_length to +half_length, or without end.
    Cylinder {
        /// Radius, m.
        radius_m: f64,
        /// Half the length, m; `None`: infinite.
        half_length_m: Option<f64>,
    },
    /// A cone with its tip at the origin, opening towards +z.
    Cone {
        /// Angle between axis and side, rad, below π/2.
        half_angle_rad: f64,
        /// From tip to base, m.
        height_m: f64,
    },
    /// x²/a² + y²/b² + z²/c² ≤ 1.
    Ellipsoid {
        /// a, b, c, m.
        semi_axes_m: [f64; 3],
    },
    /// A ring around z.
    Torus {
        /// From the centre to the middle of the tube, m.
        major_radius_m: f64,
        /// Of the tube, m.
        minor_radius_m: f64,
    },
    /// A cuboid.
    Box {
        /// Half of each edge, m.
        half_extents_m: [f64; 3],
    },
    /// Any function of x, y, z (m): see [`Tape::parse`].
    Expression {
        /// As written.
        text: String,
    },
}

/// Why a shape is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImplicitError {
    /// A length or angle out of range.
    #[error("{name} is {value}; it must be {allowed}")]
    Size {
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// The text of an expression.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
}

/// Lengths outside of this range are refused, m: squares of them must stay numbers too.
const LENGTHS_M: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

impl ImplicitError {
    /// Checks a length of a shape; `name` is the key that gives it.
    ///
    /// # Errors
    /// A length outside of 1e-9 to 1e9 m.
    pub fn check_length(name: &'static str, value: f64) -> Result<(), Self> {
        if LENGTHS_M.contains(&value) {
            return Ok(());
        }
        Err(Self::Size {
            name,
            value,
            allowed: "a length from 1e-9 to 1e9 m",
        })
    }
}

impl ImplicitShape {
    /// Every size that is out of range; `text` and `compile` answer with the first.
    pub fn wrong_sizes(&self) -> Vec<ImplicitError> {
        let mut wrong = Vec::new();
        let mut length =
            |name, value: f64| wrong.extend(ImplicitError::check_length(name, value).err());
        match self {
            Self::Sphere { radius_m } => length("radius_m", *radius_m),
            Self::Cylinder {
                radius_m,
                half_length_m,
            } => {
                length("radius_m", *radius_m);
                half_length_m
                    .iter()
                    .for_each(|&half| length("half_length_m", half));
            }
            Self::Cone {
                half_angle_rad: angle,
                height_m,
            } => {
                length("height_m", *height_m);
                if !(*angle > 1e-6 && *angle < std::f64::consts::FRAC_PI_2 - 1e-6) {
                    wrong.push(ImplicitError::Size {
                        name: "half_angle_rad",
                        value: *angle,
                        allowed: "between 0 and π/2 rad",
                    });
                }
            }
            Self::Ellipsoid { semi_axes_m } => semi_axes_m
                .iter()
                .for_each(|&axis| length("semi_axes_m", axis)),
            Self::Torus {
                major_radius_m,
                minor_radius_m,
            } => {
                length("major_radius_m", *major_radius_m);
                length("minor_radius_m", *minor_radius_m);
            }
            Self::Box { half_extents_m } => half_extents_m
                .iter()
                .for_each(|&half| length("half_extents_m", half)),
            Self::Expression { .. } => {}
        }
        wrong
    }

    /// The function as text; it is compiled like any other.
    ///
    /// # Errors
    /// A size that is not positive and finite.
    pub fn text(&self) -> Result<String, ImplicitError> {
        if let Some(error) = self.wrong_sizes().into_iter().next() {
            return Err(error);
        }
        Ok(match self {
            Self::Sphere { radius_m } => format!("sqrt(x^2 + y^2 + z^2) - {radius_m:e}"),
            Self::Cylinder {
                radius_m,
                half_length_m,
            } => {
                let side = format!("hypot(x, y) - {radius_m:e}");
                match half_length_m {
                    None => side,
                    Some(half) => format!("max({side}, abs(z) - {half:e})"),
                }
            }
            Self::Cone {
                half_angle_rad: angle,
                height_m: h,
            } => {
                let (c, s) = (libm::cos(*angle), libm::sin(*angle));
                format!("max(hypot(x, y) * {c:e} - z * {s:e}, z - {h:e})")
            }
            Self::Ellipsoid {
                semi_axes_m: [a, b, c],
            } => {
                let least = a.min(*b).min(*c);
                format!("{least:e} * (sqrt((x / {a:e})^2 + (y / {b:e})^2 + (z / {c:e})^2) - 1)")
            }
            Self::Torus {
                major_radius_m: big,
                minor_radius_m: small,
            } => format!("hypot(hypot(x, y) - {big:e}, z) - {small:e}"),
            Self::Box {
                half_extents_m: [a, b, c],
            } => format!("max(abs(x) - {a:e}, abs(y) - {b:e}, abs(z) - {c:e})"),
            Self::Expression { text } => text.clone(),
        })
    }

    /// Ready for queries.
    ///
    /// # Errors
    /// A size out of range, or a text that is not a valid function.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::contact::implicit::ImplicitShape;
    /// use palpate_geometry::math::Point3;
    /// let text = "x^2 + y^2 + z^2 - 1".to_owned();
    /// let ball = ImplicitShape::Expression { text }.compile()?;
    /// assert_eq!(ball.tape().value(&Point3::new(0.0, 0.0, 2.0)), 3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn compile(&self) -> Result<ImplicitTool, ImplicitError> {
        Ok(ImplicitTool {
            tape: Tape::parse(&self.text()?)?,
            sides: self.sides(),
            ties: 0,
            features: self.features(),
        })
    }
}

/// A compiled solid.
#[derive(Clone, Debug, PartialEq)]
pub struct ImplicitTool {
    tape: Tape,
    /// Its smooth sides, of each of which a point is below if it is inside; none where they are not known.
    sides: Vec<Side>,
    /// Of a function whose edges were found: which operations make them, as bits of [`Tape::choices`]. What these choose
    /// is the number of a side.
    ties: u64,
    features: Features,
}

/// Where a point stands: the zero set along its gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stand {
    /// Distance to the zero set, m; negative outside.
    pub depth_m: f64,
    /// Unit gradient.
    pub uphill: Vector3,
}

/// Of lengths, what a few operations on them may leave.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Doublings of the first step in search of the zero set.
const DOUBLINGS: usize = 24;
/// Steps of the safeguarded Newton method; bisection alone would be done after as many.
const STEPS: usize = 80;

impl ImplicitTool {
    /// Its corners and edges, as far as they are known, in the tool's frame.
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// The function, in the tool's frame.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// Looks for edges of a function, within so much of the origin in x, y and z, m; those of other shapes are known.
    pub fn with_edges_found(mut self, reach_m: f64) -> Self {
        if self.sides.is_empty() {
            self.find_edges(reach_m);
        }
        self
    }

    pub(super) fn know(&mut self, features: Features, ties: u64) {
        (self.features, self.ties) = (features, ties);
    }

    /// All its edges are known.
    pub(super) fn edges_known(&self) -> bool {
        !self.sides.is_empty() || self.ties != 0
    }

    /// The side above which a point of the tool's frame is highest, or those after it.
    pub(super) fn side(&self, p: &Point3, after: usize) -> Option<usize> {
        if self.ties != 0 {
            return (after == 0).then(|| self.tape.choices(p) as usize);
        }
        let gap = |k: usize| self.sides[k].gap(p).0;
        let is_higher = |a: usize, b: usize| gap(a) > gap(b) || (gap(a) == gap(b) && a < b);
        (0..self.sides.len()).find(|&k| {
            (0..self.sides.len())
                .filter(|&other| is_higher(other, k))
                .count()
                == after
        })
    }

    /// How far a point of the tool's frame is below a side that goes on beyond its edges, m.
    pub(super) fn depth_below(&self, side: usize, p: &Point3) -> f64 {
        if self.ties != 0 {
            // What makes no edge goes on choosing for itself.
            let choices = |q: &Point3| side as u64 & self.ties | self.tape.choices(q) & !self.ties;
            let below = stand_in(|q| self.tape.gradient_with(q, choices(q)), p);
            return below.map_or(f64::NEG_INFINITY, |stand| stand.depth_m);
        }
        -self.sides[side].gap(p).0
    }

    /// The function and its gradient.
    fn gradient(&self, p: &Point3) -> (f64, Vector3) {
        if self.sides.is_empty() {
            return self.tape.gradient(p);
        }
        self.side(p, 0)
            .map_or_else(|| self.tape.gradient(p), |side| self.sides[side].gap(p))
    }

    /// All values over the box of a sphere around a point of the tool's frame.
    pub fn range_around(&self, centre: &Point3, half: &Vector3) -> Interval {
        self.tape.interval(&(centre - half), &(centre + half))
    }

    /// First-order depth −f / |∇f| (−∞ where that means nothing) and the unit gradient.
    pub(super) fn rough(&self, p: &Point3) -> (f64, Vector3) {
        let (f, gradient) = self.gradient(p);
        let steepness = gradient.norm().max(1e-12);
        let depth_m = -f / steepness;
        (
            if depth_m.is_nan() {
                f64::NEG_INFINITY
            } else {
                depth_m
            },
            gradient / steepness,
        )
    }

    /// How deep a point of the tool's frame is, m; −∞ where that means nothing.
    pub(in crate::contact) fn depth_m(&self, p: &Point3) -> f64 {
        self.stand(p)
            .map_or(f64::NEG_INFINITY, |stand| stand.depth_m)
    }

    /// Depth of a point of the tool's frame along its gradient (along +z where that vanishes);
    /// `None` where f is not a number or the zero set is not on that line.
    pub(super) fn stand(&self, p: &Point3) -> Option<Stand> {
        let known = (!self.sides.is_empty()).then(|| self.side(p, 0)).flatten();
        if let Some(side) = known {
            return self.stand_below(side, p);
        }
        stand_in(|q| self.tape.gradient(q), p)
    }

    /// The same below the side that is nearest, to which distances are known.
    fn stand_below(&self, side: usize, p: &Point3) -> Option<Stand> {
        let (gap_m, uphill) = self.sides[side].gap(p);
        let foot = p - uphill * gap_m;
        let rounding = ROUNDING * (p.coords.amax() + gap_m.abs());
        // From inside, no other side is nearer.
        let on_it = gap_m <= 0.0 || self.sides.iter().all(|s| s.gap(&foot).0 <= rounding);
        on_it.then_some(Stand {
            depth_m: -gap_m,
            uphill,
        })
    }

    /// Gap of a world point to the tool at a pose, m, and the unit vector towards the tool's
    /// matter; first order, for samples near the surface of the tool. `None` where the function
    /// means nothing.
    pub fn signed_gap(&self, pose: &Pose, point: &Point3) -> Option<(f64, Vector3)> {
        let (f, gradient) = self.gradient(&pose.inverse_transform_point(point));
        let steepness = gradient.norm();
        let gap_m = f / steepness;
        (gap_m.is_finite() && steepness > 0.0)
            .then(|| (gap_m, -(pose.rotation * (gradient / steepness))))
    }
}

/// The zero set of a function, given with its gradient, along that from a point.
fn stand_in(gradient_at: impl Fn(&Point3) -> (f64, Vector3), p: &Point3) -> Option<Stand> {
    let (f, gradient) = gradient_at(p);
    let steepness = gradient.norm();
    if !f.is_finite() || !steepness.is_finite() {
        return None;
    }
    let uphill = if steepness > 0.0 {
        gradient / steepness
    } else {
        Vector3::z()
    };
    if f == 0.0 {
        return Some(Stand {
            depth_m: 0.0,
            uphill,
        });
    }
    // Inside, uphill leads out.
    let along = if f < 0.0 { uphill } else { -uphill };
    let guess = if steepness > 0.0 {
        f.abs() / steepness
    } else {
        1e-3 * p.coords.amax().max(f.abs()).min(1e3)
    };
    let at = |t: f64| {
        let (g, slope) = gradient_at(&(p + along * t));
        // Made to fall towards zero from above, whichever side we are on.
        let sign = if f < 0.0 { -1.0 } else { 1.0 };
        (sign * g, sign * slope.dot(&along))
    };
    let (mut low, mut high) = (0.0, guess);
    let mut there = at(high);
    let mut doublings = 0;
    while there.0 > ROUNDING * (p.coords.amax() + f.abs()) {
        doublings += 1;
        if doublings > DOUBLINGS {
            return None;
        }
        low = high;
        high *= 2.0;
        there = at(high);
    }
    if there.0.is_nan() {
        return None;
    }
    // Newton from the far end, kept between a positive and a negative value.
    let mut t = high;
    for _ in 0..STEPS {
        let (g, slope) = there;
        if g == 0.0 {
            break;
        }
        if g > 0.0 {
            low = t
        } else {
            high = t
        }
        let newton = t - g / slope;
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - t).abs() <= 2.0 * f64::EPSILON * t.abs() || next <= low || next >= high {
            t = next.clamp(low, high);
            break;
        }
        t = next;
        there = at(t);
        if there.0.is_nan() {
            return None;
        }
    }
    Some(Stand {
        depth_m: if f < 0.0 { t } else { -t },
        uphill,
    })
}
