//! The hardware that `palpate device --hardware` knows, one row each.

mod haply;

use haply::HaplyEnd;
use palpate_client::proto::messages::DeviceInfo;
use palpate_devices::{Command, DeviceEnd, Reading};
use std::error::Error;
use std::time::Duration;

/// Why hardware is of no use.
pub type HardwareError = Box<dyn Error + Send + Sync>;

/// A device that is reached.
pub struct Reached {
    /// What drives it.
    pub end: Box<dyn DeviceEnd<Error = HardwareError>>,
    /// As its maker's software calls it.
    pub id: String,
    /// What it can do; the greatest force is the caller's.
    pub info: DeviceInfo,
}

/// A kind of hardware.
pub struct Hardware {
    /// As the option has it.
    pub name: &'static str,
    /// Where its software listens unless said otherwise.
    pub address: &'static str,
    /// Connects to the device of this id, or the only one, at an address; whether on another machine too.
    pub connect: fn(&str, Option<&str>, bool) -> Result<Reached, HardwareError>,
}

/// All kinds.
pub const HARDWARE: &[Hardware] = &[Hardware {
    name: "haply",
    address: haply::DEFAULT_URI,
    connect: |address, id, insecure| {
        let end = HaplyEnd::connect(address, id, insecure)?;
        Ok(reached(end.device_id().to_owned(), end, "haply", 3))
    },
}];

fn reached<D>(id: String, end: D, kind: &str, dof_force: u8) -> Reached
where
    D: DeviceEnd<Error: Error + Send + Sync + 'static> + 'static,
{
    Reached {
        end: Box::new(Any(end)),
        info: DeviceInfo {
            dof_force,
            ..DeviceInfo::named(&format!("{kind} {id}"))
        },
        id,
    }
}

/// A device whose errors are like those of all others.
struct Any<D>(D);

impl<D: DeviceEnd<Error: Error + Send + Sync + 'static>> DeviceEnd for Any<D> {
    type Error = HardwareError;

    fn reading(&mut self, patience: Duration) -> Result<Option<Reading>, HardwareError> {
        Ok(self.0.reading(patience)?)
    }

    fn apply(&mut self, command: &Command) -> Result<(), HardwareError> {
        Ok(self.0.apply(command)?)
    }
}
