//! Durations and sizes as people write them.

use std::time::Duration;

/// `10s`, `500ms`, `2m`, `1.5h`, or plain seconds.
pub fn duration(text: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3_600.0)];
    let (number, scale) = units
        .iter()
        .find_map(|(unit, scale)| text.strip_suffix(unit).map(|number| (number, *scale)))
        .unwrap_or((text, 1.0));
    let seconds = number.trim().parse::<f64>().ok().map(|value| value * scale);
    match seconds {
        Some(seconds) if seconds > 0.0 && seconds < 1e7 => Ok(Duration::from_secs_f64(seconds)),
        _ => Err(format!(
            "{text:?} is not a valid duration; write 10s, 500ms or 2m"
        )),
    }
}

/// How long a certificate is valid: `30d`, `12h`.
pub fn validity(text: &str) -> Result<Duration, String> {
    let days = text
        .strip_suffix('d')
        .and_then(|days| days.parse::<f64>().ok());
    match days {
        Some(days) if days > 0.0 && days <= 3_650.0 => Ok(Duration::from_secs_f64(days * 86_400.0)),
        Some(_) => Err("certificates are valid for at most 3650d".into()),
        None => duration(text).map_err(|_| format!("{text:?} is not a validity; write 30d or 12h")),
    }
}

/// `500MB`, `2GB`, `64KiB`, or plain bytes.
pub fn bytes(text: &str) -> Result<u64, String> {
    let units = [
        ("KiB", 1024.0),
        ("MiB", 1024.0 * 1024.0),
        ("GiB", 1024.0 * 1024.0 * 1024.0),
        ("kB", 1e3),
        ("KB", 1e3),
        ("MB", 1e6),
        ("GB", 1e9),
        ("B", 1.0),
    ];
    let (number, scale) = units
        .iter()
        .find_map(|(unit, scale)| text.strip_suffix(unit).map(|number| (number, *scale)))
        .unwrap_or((text, 1.0));
    match number.trim().parse::<f64>().ok().map(|value| value * scale) {
        Some(bytes) if (1.0..1e15).contains(&bytes) => Ok(bytes as u64),
        _ => Err(format!(
            "{text:?} is not a valid size; write 500MB, 2GB or 64KiB"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_read_as_people_write_them() {
        for (text, size) in [
            ("500MB", 500_000_000),
            ("64KiB", 65_536),
            ("1.5GB", 1_500_000_000),
            ("7", 7),
            ("9B", 9),
        ] {
            assert_eq!(bytes(text), Ok(size), "{text}");
        }
        for text in ["", "MB", "-1MB", "0", "nan", "1e99", "ten", "10 elephants"] {
            assert!(bytes(text).is_err(), "{text:?}");
        }
    }

    #[test]
    fn durations_read_as_people_write_them() {
        for (text, ms) in [
            ("10s", 10_000),
            ("500ms", 500),
            ("2m", 120_000),
            ("1.5", 1_500),
            ("1h", 3_600_000),
        ] {
            assert_eq!(duration(text).unwrap().as_millis(), ms, "{text}");
        }
        for text in ["", "s", "-1s", "0", "nan", "1e99s", "ten"] {
            assert!(duration(text).is_err(), "{text:?}");
        }
    }
}
