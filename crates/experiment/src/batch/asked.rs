//! Columns that a sweep asks for: `peak_contact_force`, `end_proxy_z_m` and the like.

use palpate_sim::tick::quantity::{Number, ToolTick};

/// What is made of the values of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Over {
    Peak,
    Least,
    Mean,
    Rms,
    End,
}

const OVERS: [(&str, Over); 5] = [
    ("peak_", Over::Peak),
    ("least_", Over::Least),
    ("mean_", Over::Mean),
    ("rms_", Over::Rms),
    ("end_", Over::End),
];

/// A column, and what a tool has shown so far.
#[derive(Clone, Debug)]
pub(super) struct Asked {
    over: Over,
    number: Number,
    value: Option<f64>,
    sum: f64,
    count: u64,
}

impl Asked {
    /// By its name: what is made of the values, then the name of a quantity or of one of its components.
    pub fn named(name: &str) -> Result<Self, String> {
        let parts =
            (OVERS.iter()).find_map(|(start, over)| Some((*over, name.strip_prefix(start)?)));
        let (over, of) = parts.ok_or_else(|| {
            let starts = OVERS.map(|(start, _)| format!("{start}…"));
            format!("{name:?} is none of {}", starts.join(", "))
        })?;
        let number = Number::named(of).ok_or_else(|| {
            let known: Vec<&str> = Number::names().collect();
            format!(
                "{of:?} is no quantity of a tool; there are {}",
                known.join(", ")
            )
        })?;
        Ok(Self {
            over,
            number,
            value: None,
            sum: 0.0,
            count: 0,
        })
    }

    /// A tick; what is not there does not count.
    pub fn push(&mut self, of: &ToolTick<'_>) {
        let value = self.number.of(of);
        if !value.is_finite() {
            return;
        }
        self.count += 1;
        self.sum += if self.over == Over::Rms {
            value * value
        } else {
            value
        };
        let mean = self.sum / self.count as f64;
        self.value = Some(match self.over {
            Over::Peak => self.value.map_or(value, |most| most.max(value)),
            Over::Least => self.value.map_or(value, |least| least.min(value)),
            Over::Mean => mean,
            Over::Rms => libm::sqrt(mean),
            Over::End => value,
        });
    }

    /// The result; `None` if no tick had it.
    pub fn value(&self) -> Option<f64> {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Vector3;
    use palpate_sim::tick::record::ToolOutput;

    #[test]
    fn every_quantity_makes_columns() {
        let (first, second) = (
            ToolOutput::default(),
            ToolOutput {
                force_n: Vector3::new(0.0, 3.0, 4.0),
                ..ToolOutput::default()
            },
        );
        let value = |column: &str| {
            let mut asked = Asked::named(column).unwrap();
            asked.push(&ToolTick::from(&first));
            asked.push(&ToolTick::from(&second));
            asked.value()
        };
        for name in Number::names() {
            for (start, _) in OVERS {
                value(&format!("{start}{name}"));
            }
        }
        assert_eq!(value("peak_force"), Some(5.0));
        assert_eq!(value("mean_force_y_n"), Some(1.5));
        assert_eq!(value("rms_force"), Some(libm::sqrt(12.5)));
        assert_eq!(
            (value("least_depth"), value("end_position_x_m")),
            (Some(0.0), None)
        );
        assert!(Asked::named("most_force").unwrap_err().contains("peak_"));
        assert!(
            Asked::named("peak_banana")
                .unwrap_err()
                .contains("contact_force")
        );
    }
}
