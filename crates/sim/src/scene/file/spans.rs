//! Where in a scene file the keys of the scene stand.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The keys and values of a TOML text with their spans.
pub(super) struct Spans<'t>(Option<Spanned<DeTable<'t>>>);

impl<'t> Spans<'t> {
    /// Of a text that parses; of any other, nothing is found.
    pub fn of(text: &'t str) -> Self {
        Self(DeTable::parse(text).ok())
    }

    /// Byte at which the key of a path such as `body[0].material.young_pa` starts; of the longest
    /// part of the path that is written down, where the whole is not.
    pub fn start_of(&self, path: &str) -> usize {
        let Some(top) = &self.0 else { return 0 };
        let mut start = 0;
        let mut table = Some(top.get_ref());
        let mut value: Option<&Spanned<DeValue<'_>>>;
        for step in path.split('.') {
            let mut parts = step.split('[');
            let key = parts.next().unwrap_or("");
            let Some((name, found)) = table.and_then(|table| {
                table
                    .iter()
                    .find(|(name, _)| name.get_ref().as_ref() == key)
            }) else {
                return start;
            };
            start = name.span().start;
            value = Some(found);
            for index in parts {
                let index = index.trim_end_matches(']').parse().ok();
                let entries = value.and_then(|value| value.get_ref().as_array());
                let entry = index.and_then(|index: usize| entries?.get(index));
                let Some(entry) = entry else { return start };
                start = entry.span().start;
                value = Some(entry);
            }
            table = value.and_then(|value| value.get_ref().as_table());
        }
        start
    }
}
