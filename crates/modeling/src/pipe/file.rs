//! The curve file `palpate.curve.v1` (JSON), read to metres.
//!
//! ```json
//! {"format": "palpate.curve.v1", "degree": 3, "knots": [0, …], "points": [[x, y, z], …], "weights": [1, …],
//!  "unit": "m", "periodic": false}
//! ```
//! `weights`, `unit` ("m" unless given, or "mm") and `periodic` may be left out. A periodic curve
//! has one period of knots, one more than control points; any other has `points + degree + 1`.

use palpate_geometry::basis::{KnotError, KnotVector};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{Curve, CurveError};

/// The value of `format`.
pub const FORMAT: &str = "palpate.curve.v1";

/// Why a curve file was refused.
#[derive(Debug, thiserror::Error)]
pub enum CurveFileError {
    /// Not JSON, cut short, a key that is unknown or missing, or a value of another kind; says
    /// where.
    #[error("not a {FORMAT} document: {0}")]
    Json(#[from] serde_json::Error),
    /// Another format.
    #[error("\"format\" is {found:?}, this reads \"{FORMAT}\"")]
    Format {
        /// What stands there.
        found: String,
    },
    /// Another unit.
    #[error("\"unit\" is {found:?}; it is \"m\" or \"mm\"")]
    Unit {
        /// What stands there.
        found: String,
    },
    /// Knots for another number of points.
    #[error(
        "{given} knots, but degree {degree} with {count} control points needs {needed}{}",
        if *.periodic { " (one period: count + 1)" } else { " (count + degree + 1)" }
    )]
    KnotCount {
        /// Knots of the file.
        given: usize,
        /// Polynomial degree.
        degree: usize,
        /// Control points.
        count: usize,
        /// Knots needed.
        needed: usize,
        /// Whether the curve is periodic.
        periodic: bool,
    },
    /// Knots that are none.
    #[error("knots: {0}")]
    Knots(#[from] KnotError),
    /// Points and weights that make no curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    format: String,
    degree: usize,
    knots: Vec<f64>,
    points: Vec<[f64; 3]>,
    weights: Option<Vec<f64>>,
    unit: Option<String>,
    #[serde(default)]
    periodic: bool,
}

/// Reads a document: the curve in metres, and the unit that its numbers are in.
///
/// # Errors
/// See [`CurveFileError`]; each says what is wrong and where.
pub fn read(json: &str) -> Result<(Curve, Unit), CurveFileError> {
    let document: Document = serde_json::from_str(json)?;
    if document.format != FORMAT {
        return Err(CurveFileError::Format {
            found: document.format,
        });
    }
    let unit = match document.unit.as_deref() {
        None | Some("m") => Unit::Metre,
        Some("mm") => Unit::Millimetre,
        Some(other) => {
            return Err(CurveFileError::Unit {
                found: other.to_owned(),
            });
        }
    };
    let (degree, count, given) = (document.degree, document.points.len(), document.knots.len());
    let periodic = document.periodic;
    let needed = if periodic {
        count.saturating_add(1)
    } else {
        count.saturating_add(degree).saturating_add(1)
    };
    if (1..=palpate_geometry::basis::MAX_DEGREE).contains(&degree) {
        if count <= degree {
            return Err(KnotError::TooFew { count, degree }.into());
        }
        if given != needed {
            return Err(CurveFileError::KnotCount {
                given,
                degree,
                count,
                needed,
                periodic,
            });
        }
    }
    let knots = if periodic {
        KnotVector::periodic(degree, document.knots)
    } else {
        KnotVector::new(degree, document.knots)
    }?;
    let points = document
        .points
        .iter()
        .map(|p| Point3::from(p.map(|x| x / unit.per_metre())))
        .collect();
    Ok((Curve::new(knots, points, document.weights)?, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARC: &str = r#"{"format": "palpate.curve.v1", "degree": 2, "knots": [0, 0, 0, 1, 1, 1],
        "points": [[0, 0, 0], [1000, 0, 0], [1000, 1000, 5]], "weights": [1, 0.5, 1], "unit": "mm"}"#;

    #[test]
    fn millimetres_become_metres() {
        let (curve, unit) = read(ARC).unwrap();
        assert_eq!(unit, Unit::Millimetre);
        assert_eq!(curve.points()[2], Point3::new(1.0, 1.0, 0.005));
        assert_eq!(curve.weights(), Some(&[1.0, 0.5, 1.0][..]));
    }

    #[test]
    fn broken_documents_are_refused_with_what_and_where() {
        let message = |from: &str, to: &str| {
            assert!(ARC.contains(from), "{from}");
            read(&ARC.replace(from, to)).unwrap_err().to_string()
        };
        for (from, to, wanted) in [
            (
                "curve.v1",
                "surface.v1",
                "\"format\" is \"palpate.surface.v1\", this reads \"palpate.curve.v1\"",
            ),
            (
                "\"mm\"",
                "\"cm\"",
                "\"unit\" is \"cm\"; it is \"m\" or \"mm\"",
            ),
            (
                "[0, 0, 0, 1, 1, 1]",
                "[0, 0, 0, 1, 1]",
                "5 knots, but degree 2 with 3 control points needs 6 (count + degree + 1)",
            ),
            (
                "[0, 0, 0, 1, 1, 1]",
                "[0, 0, 0, 2, 1, 1]",
                "knots: knot 4 (1) is smaller than the one before it (2)",
            ),
            (
                "\"degree\": 2",
                "\"degree\": 16",
                "knots: degree 16 is outside 1..=15",
            ),
            (
                "\"degree\": 2",
                "\"degree\": 3",
                "knots: 3 control points are too few for degree 3",
            ),
            (
                "0.5, 1]",
                "-0.5, 1]",
                "weight 1 is -0.5; weights are from 1e-9 to 1e9",
            ),
            (
                "0.5, 1]",
                "0, 1]",
                "weight 1 is 0; weights are from 1e-9 to 1e9",
            ),
            ("0.5, 1]", "1]", "2 weights for 3 control points"),
        ] {
            let said = message(from, to);
            assert!(
                said.contains(wanted) || said == wanted,
                "{said}\nis not\n{wanted}"
            );
        }
        assert!(message("\"weights\"", "\"weight\"").contains("unknown field `weight`"));
        assert!(message("\"unit\": \"mm\"", "\"note\": 1").contains("unknown field `note`"));
        assert!(message("[0, 0, 0], ", "[0, 0], ").contains("line 2"));
        assert!(message("1000, 5", "1e999, 5").contains("number out of range"));
    }

    #[test]
    fn a_document_cut_short_is_refused() {
        for end in 0..ARC.len() {
            assert!(
                matches!(read(&ARC[..end]), Err(CurveFileError::Json(_))),
                "cut at {end}"
            );
        }
    }
}
