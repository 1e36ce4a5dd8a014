//! JSON Schema of scene files, for editors and validators, from the types of [`super::spec`] and their
//! doc comments.
//!
//! Beyond what the types say, each number has its unit under `x-unit` (from the ending of its key)
//! and a default that JSON cannot write under `x-default` (`inf`).

use serde_json::Value;

/// The schema (draft 7, which editors of TOML understand).
///
/// # Examples
/// ```
/// let schema = palpate_sim::scene::schema();
/// assert_eq!(schema["properties"]["loop"]["default"]["rate_hz"], 1000);
/// ```
pub fn schema() -> Value {
    // A test of this module holds the file to the types.
    serde_json::from_str(include_str!("schema/scene.schema.json")).unwrap_or_default()
}

#[cfg(test)]
mod generate;
#[cfg(test)]
mod tests;
