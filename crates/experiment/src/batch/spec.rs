//! `SWEEP.toml`: a scene, what varies in it, motions and seeds.
//!
//! ```toml
//! scene = "builtin:teardrop"      # or a scene file beside this one
//! for_s = 0.5
//! seeds = { from = 1, count = 10 }
//!
//! [vary]                          # keys of the scene by path
//! "body.drop.material.young_pa" = { from = 1e4, to = 4e4, count = 4, scale = "log" }
//! "tool.ball.coupling.stiffness_n_m" = [500.0, 1000.0]
//!
//! [[motion]]
//! name = "press"
//! hands.ball = { motion = "press", depth_m = 0.004 }
//! ```

use super::error::BatchError;
use palpate_proto::text::located;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Value;

/// Most values that one key can have.
const MOST_VALUES: usize = 100_000;

/// A sweep as it is written.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepSpec {
    /// `builtin:NAME` or a scene file.
    pub scene: String,
    /// Simulated time of each run, s.
    pub for_s: f64,
    /// Seeds of what is random in devices, hands and networks.
    #[serde(default)]
    pub seeds: Seeds,
    /// Keys of the scene that are the same in all runs.
    #[serde(default)]
    pub set: BTreeMap<String, Value>,
    /// Keys of the scene that vary: a list of values, or a range.
    #[serde(default)]
    pub vary: BTreeMap<String, Value>,
    /// Columns beside the usual ones, by tool: `peak_`, `least_`, `mean_`, `rms_` or `end_` before the name of
    /// a quantity.
    #[serde(default)]
    pub columns: Vec<String>,
    /// Draw values instead of taking all combinations.
    pub random: Option<RandomSpec>,
    /// What moves tools.
    #[serde(rename = "motion")]
    pub motions: Vec<MotionSpec>,
}

/// `seeds = [1, 2]` or `seeds = { from = 1, count = 10 }`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Seeds {
    /// These.
    List(Vec<u64>),
    /// So many, from one on.
    From {
        /// The first.
        from: u64,
        /// How many.
        count: usize,
    },
}

impl Default for Seeds {
    fn default() -> Self {
        Self::List(vec![1])
    }
}

/// `[random]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomSpec {
    /// How many sets of values to draw; each is run with all motions and seeds.
    pub samples: usize,
    /// Decides them.
    #[serde(default)]
    pub seed: u64,
}

/// `[[motion]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionSpec {
    /// What it is called in the results.
    pub name: String,
    /// By tool; a tool that is not named stays where the scene puts it.
    pub hands: BTreeMap<String, HandSpec>,
}

/// What moves a tool.
#[derive(Clone, Debug, PartialEq, Deserialize, serde::Serialize)]
#[serde(deny_unknown_fields)]
pub struct HandSpec {
    /// press, slide, tap, circle, pull, tremor, hold, or a motion file.
    pub motion: String,
    /// Past the first touch, m.
    #[serde(default = "depth")]
    pub depth_m: f64,
    /// Device by name or file. Left out: the tool goes exactly where the motion says, and seeds
    /// decide nothing.
    pub device: Option<String>,
    /// Hand on it: light, relaxed, firm, or a file.
    pub hand: Option<String>,
    /// Bound of the hand's tremor in each axis, m; that of the hand if left out.
    pub tremor_m: Option<f64>,
    /// Network between device and loop, each way, s.
    #[serde(default)]
    pub delay_s: f64,
    /// Up to this much more, s.
    #[serde(default)]
    pub jitter_s: f64,
    /// Share of poses and of forces that are lost.
    #[serde(default)]
    pub loss: f64,
    /// Share that comes after the next one.
    #[serde(default)]
    pub reorder: f64,
    /// The device controls its port's energy.
    #[serde(default)]
    pub passivity: bool,
}

fn depth() -> f64 {
    0.004
}

/// `{ from = 1e4, to = 4e4, count = 4, scale = "log" }`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct RangeSpec {
    from: f64,
    to: f64,
    count: Option<usize>,
    #[serde(default)]
    scale: Scale,
    /// Whole numbers only.
    #[serde(default)]
    whole: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Scale {
    #[default]
    Linear,
    Log,
}

/// A checked entry of `[vary]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// Path of the key in the scene.
    pub key: String,
    values: Values,
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    List(Vec<Value>),
    Range(RangeSpec),
}

impl Varied {
    /// Checks an entry. `random`: values are drawn, a range has no count.
    ///
    /// # Errors
    /// A reason, in words.
    pub fn new(key: &str, value: &Value, random: bool) -> Result<Self, String> {
        let values = match value {
            Value::Array(list) if list.is_empty() => return Err("has no values".into()),
            Value::Array(list) => Values::List(list.clone()),
            Value::Table(table) => {
                let range: RangeSpec = (table.clone().try_into())
                    .map_err(|error: toml::de::Error| error.message().to_owned())?;
                range.checked(random)?
            }
            _ => {
                return Err(
                    "write a list of values, [1.0, 2.0], or a range, { from = 1.0, to = 2.0, count = 3 }; \
                     what is the same in all runs belongs into [set]"
                        .into(),
                );
            }
        };
        let (key, most) = (key.to_owned(), MOST_VALUES);
        let varied = Self { key, values };
        match varied.count() <= most {
            true => Ok(varied),
            false => Err(format!("has {} values; {most} at most", varied.count())),
        }
    }

    /// Values of a grid.
    pub fn count(&self) -> usize {
        match &self.values {
            Values::List(list) => list.len(),
            Values::Range(range) => range.count.unwrap_or(1),
        }
    }

    /// Value of a grid, from 0.
    pub fn at(&self, index: usize) -> Value {
        match &self.values {
            Values::List(list) => list[index].clone(),
            Values::Range(range) => {
                let last = self.count().saturating_sub(1).max(1);
                range.value(index as f64 / last as f64)
            }
        }
    }

    /// A value for a number that is drawn evenly from [0, 1).
    pub fn drawn(&self, share: f64) -> Value {
        match &self.values {
            Values::List(list) => {
                let index = (share * list.len() as f64) as usize;
                list[index.min(list.len() - 1)].clone()
            }
            Values::Range(range) => range.value(share),
        }
    }

    /// Its values are numbers with a point, or can become such.
    pub fn all(&self, mut is: impl FnMut(&Value) -> bool) -> bool {
        match &self.values {
            Values::List(list) => list.iter().all(is),
            Values::Range(range) => is(&range.value(0.0)),
        }
    }
}

impl RangeSpec {
    fn checked(self, random: bool) -> Result<Values, String> {
        let Self {
            from, to, scale, ..
        } = self;
        if !(from.is_finite() && to.is_finite() && from < to) {
            return Err(format!(
                "from = {from} and to = {to}: from must be below to"
            ));
        }
        if scale == Scale::Log && from <= 0.0 {
            return Err(format!("a range on a log scale is above 0, from = {from}"));
        }
        match (random, self.count) {
            (true, Some(_)) => {
                Err("with [random] a range is drawn from: leave its count out".into())
            }
            (false, None | Some(0 | 1)) => {
                Err("a range in a grid needs a count of 2 or more".into())
            }
            _ => Ok(Values::Range(self)),
        }
    }

    /// At a share of the way, 0 to 1; the ends are exactly those that are written.
    fn value(&self, share: f64) -> Value {
        let (from, to) = (self.from, self.to);
        let value = match self.scale {
            _ if share == 0.0 => from,
            _ if share == 1.0 => to,
            Scale::Linear => from + (to - from) * share,
            Scale::Log => from * libm::exp(libm::log(to / from) * share),
        };
        match self.whole {
            true => Value::Integer(value.round() as i64),
            false => Value::Float(value),
        }
    }
}

impl SweepSpec {
    /// Reads a sweep; `name` is for messages.
    ///
    /// # Errors
    /// Not such TOML.
    pub fn parse(text: &str, name: &str) -> Result<Self, BatchError> {
        toml::from_str(text).map_err(|error| BatchError::File {
            path: name.to_owned(),
            reason: located(text, error.span(), error.message()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn varied(text: &str, random: bool) -> Result<Varied, String> {
        let table: toml::Table = toml::from_str(&format!("k = {text}")).unwrap();
        Varied::new("k", &table["k"], random)
    }

    #[test]
    fn ranges_reach_both_ends_exactly() {
        let range = varied("{ from = 0.1, to = 0.7, count = 4 }", false).unwrap();
        let values: Vec<f64> = (0..4).map(|k| range.at(k).as_float().unwrap()).collect();
        assert_eq!((values[0], values[3]), (0.1, 0.7));
        assert!((values[1] - 0.3).abs() < 1e-15);
        let log = varied(
            "{ from = 1e3, to = 1e5, count = 3, scale = \"log\" }",
            false,
        )
        .unwrap();
        assert!((log.at(1).as_float().unwrap() / 1e4 - 1.0).abs() < 1e-14);
        assert_eq!(log.at(2).as_float(), Some(1e5));
        let whole = varied("{ from = 1, to = 9, count = 3, whole = true }", false).unwrap();
        assert_eq!(whole.at(1), Value::Integer(5));
    }

    #[test]
    fn what_has_no_values_is_refused_with_what_would_do() {
        for (text, random, expected) in [
            ("[]", false, "no values"),
            ("3.0", false, "[set]"),
            ("{ from = 1, to = 2 }", false, "count"),
            ("{ from = 1, to = 2, count = 1 }", false, "count"),
            ("{ from = 1, to = 2, count = 3 }", true, "count"),
            ("{ from = 2, to = 1, count = 3 }", false, "below"),
            ("{ from = nan, to = 1, count = 3 }", false, "below"),
            (
                "{ from = 0, to = 1, count = 3, scale = \"log\" }",
                false,
                "log",
            ),
            ("{ from = 1, to = 2, count = 200000 }", false, "at most"),
            ("{ from = 1, to = 2, step = 3 }", false, "step"),
        ] {
            let error = varied(text, random).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
