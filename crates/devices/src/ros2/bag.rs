//! The text that a bag carries for a type: its fields and those of all types inside it.

use super::types::{PARTS, RosType};

const RULE: &str =
    "================================================================================";

/// Fields of a type, then, each below a rule, those of the types that it uses: MCAP's `ros2msg`.
pub fn schema_text(ros_type: &RosType) -> String {
    let mut text = ros_type.text.to_owned();
    let mut wanted: Vec<&str> = parts_in(ros_type.text);
    let mut next = 0;
    while let Some(&name) = wanted.get(next) {
        next += 1;
        let Some((_, fields)) = PARTS.iter().find(|(part, _)| *part == name) else {
            continue;
        };
        text += &format!("{RULE}\nMSG: {name}\n{fields}");
        for part in parts_in(fields) {
            if !wanted.contains(&part) {
                wanted.push(part);
            }
        }
    }
    text
}

/// Types with a package, in the order of their fields, each once.
fn parts_in(fields: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    for field in fields.lines() {
        let kind = field.split(' ').next().unwrap_or_default();
        let kind = kind.split('[').next().unwrap_or_default();
        if kind.contains('/') && !parts.contains(&kind) {
            parts.push(kind);
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::super::TYPES;
    use super::*;

    #[test]
    fn every_part_of_every_type_is_there_once() {
        for ros_type in TYPES {
            let text = schema_text(ros_type);
            for part in parts_in(&text) {
                let heading = format!("MSG: {part}\n");
                assert_eq!(
                    text.matches(&heading).count(),
                    1,
                    "{}: {part}",
                    ros_type.name
                );
            }
        }
    }
}
