//! Key expressions. `palpate/{instance}/…`; ids are `[a-z0-9_-]{1,64}`; `@` chunks stay out of
//! `**`. Where a message travels is in the table of [`crate::messages`].

use crate::messages::{
    ALL, ContactSet, ControlNet, DeviceInfo, LoopStatus, Message, SceneSnapshot, SimEvent,
    ToolContact, ToolForce, ToolForceV2, ToolPose,
};

/// An id that cannot be a chunk of a key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a valid id: use 1 to 64 of a-z, 0-9, '_' and '-'")]
pub struct IdError(pub String);

/// Checks an id.
///
/// # Errors
/// Empty, longer than 64, or other characters.
pub fn check_id(id: &str) -> Result<&str, IdError> {
    let fits = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_' || b == b'-';
    if (1..=64).contains(&id.len()) && id.bytes().all(fits) {
        Ok(id)
    } else {
        Err(IdError(id.to_owned()))
    }
}

/// All keys of one instance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Keys {
    root: String,
}

impl Keys {
    /// Keys of an instance.
    ///
    /// # Errors
    /// A name that is not a valid id.
    pub fn new(instance: &str) -> Result<Self, IdError> {
        Ok(Self {
            root: format!("palpate/{}", check_id(instance)?),
        })
    }

    /// Key of a message; `id` is that of the tool or body whose message it is, or anything for a
    /// message that has no owner.
    pub fn of<M: Message>(&self, id: &str) -> String {
        self.filled(M::KEY, id)
    }

    fn filled(&self, template: &str, id: &str) -> String {
        let key = template.replace("{tool}", id).replace("{body}", id);
        format!("{}/{key}", self.root)
    }

    /// Poses of a tool, tool → daemon.
    pub fn tool_pose(&self, tool: &str) -> String {
        self.of::<ToolPose>(tool)
    }

    /// Forces of a tool, daemon → tool.
    pub fn tool_force(&self, tool: &str) -> String {
        self.of::<ToolForce>(tool)
    }

    /// The same with their errors.
    pub fn tool_force_v2(&self, tool: &str) -> String {
        self.of::<ToolForceV2>(tool)
    }

    /// What contacts do to a tool, daemon → all.
    pub fn tool_contact(&self, tool: &str) -> String {
        self.of::<ToolContact>(tool)
    }

    /// What the device of a tool can do, tool → daemon; also queryable.
    pub fn tool_device(&self, tool: &str) -> String {
        self.of::<DeviceInfo>(tool)
    }

    /// Control net of a body; also queryable.
    pub fn body_net(&self, body: &str) -> String {
        self.of::<ControlNet>(body)
    }

    /// Contacts.
    pub fn contact(&self) -> String {
        self.of::<ContactSet>("")
    }

    /// Health; also queryable.
    pub fn status(&self) -> String {
        self.of::<LoopStatus>("")
    }

    /// Events.
    pub fn event(&self) -> String {
        self.of::<SimEvent>("")
    }

    /// Queryable: everything a late joiner needs.
    pub fn scene(&self) -> String {
        self.of::<SceneSnapshot>("")
    }

    /// Queryable of one method.
    pub fn rpc(&self, method: &str) -> String {
        format!("{}/rpc/{method}", self.root)
    }

    /// Queryable: JSON about the server.
    pub fn meta_info(&self) -> String {
        format!("{}/@meta/info", self.root)
    }

    /// Queryable: layout of a message by its versioned name; `*` for all.
    pub fn meta_schema(&self, name: &str) -> String {
        format!("{}/@meta/schema/{name}", self.root)
    }

    /// Queryable: OpenMetrics text.
    pub fn meta_metrics(&self) -> String {
        format!("{}/@meta/metrics", self.root)
    }

    /// Liveliness token of a daemon that is recording.
    pub fn live_recorder(&self, id: &str) -> String {
        format!("{}/@live/recorder/{id}", self.root)
    }

    /// Liveliness token of a daemon that serves a page.
    pub fn live_viewer(&self, id: &str) -> String {
        format!("{}/@live/viewer/{id}", self.root)
    }

    /// A key given short: whole (`palpate/default/status`), without its head (`tool/ball/force`),
    /// or one word for all of a kind (`force`, `pose`, `device`, `net`, `all`).
    pub fn expand(&self, key: &str) -> String {
        let key = key.trim_matches('/');
        if key == "palpate" || key.starts_with("palpate/") {
            return key.to_owned();
        }
        if key == "all" || key.is_empty() {
            return format!("{}/**", self.root);
        }
        // `contact` is a key as it stands before it is the last word of another.
        let kind = ALL.iter().find(|message| message.key == key).or_else(|| {
            ALL.iter()
                .find(|message| message.key.ends_with(&format!("}}/{key}")))
        });
        match kind {
            Some(message) => self.filled(message.key, "*"),
            None => format!("{}/{key}", self.root),
        }
    }

    /// Liveliness token of a server.
    pub fn live_server(&self, id: &str) -> String {
        format!("{}/@live/server/{id}", self.root)
    }

    /// Liveliness token of whoever holds a tool; `*` for all.
    pub fn live_tool(&self, tool: &str) -> String {
        format!("{}/@live/tool/{tool}", self.root)
    }

    /// The tool whose liveliness token a key is.
    pub fn tool_of_live<'k>(&self, key: &'k str) -> Option<&'k str> {
        key.strip_prefix(&self.root)?.strip_prefix("/@live/tool/")
    }
}

/// Liveliness tokens of all instances.
pub const LIVE_EVERYWHERE: &str = "palpate/*/@live/*/*";

/// Descriptions of all instances.
pub const INFO_EVERYWHERE: &str = "palpate/*/@meta/info";

/// Instance, kind (`server`, `tool`, `recorder`, `viewer`) and id of a liveliness token.
pub fn parse_live(key: &str) -> Option<(&str, &str, &str)> {
    let mut chunks = key.split('/');
    let parsed = match (
        chunks.next()?,
        chunks.next()?,
        chunks.next()?,
        chunks.next()?,
        chunks.next()?,
    ) {
        ("palpate", instance, "@live", kind, id) => (instance, kind, id),
        _ => return None,
    };
    chunks.next().is_none().then_some(parsed)
}

/// Enough of the id that a client attaches to its poses to tell clients apart, as text.
pub fn short_id(id: &[u8]) -> String {
    // First comes the session, last the number of the call in it.
    let tail = id.len().saturating_sub(4).max(4).min(id.len());
    let bytes = id.iter().take(4).chain(&id[tail..]);
    bytes.map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_the_table_and_live_keys_parse_back() {
        let keys = Keys::new("default").unwrap();
        assert_eq!(keys.tool_pose("ball"), "palpate/default/tool/ball/pose");
        assert_eq!(
            keys.tool_contact("ball"),
            "palpate/default/tool/ball/contact"
        );
        assert_eq!(keys.tool_device("ball"), "palpate/default/tool/ball/device");
        assert_eq!(keys.body_net("drop"), "palpate/default/body/drop/net");
        assert_eq!(keys.rpc("reset"), "palpate/default/rpc/reset");
        assert_eq!(keys.tool_of_live(&keys.live_tool("ball")), Some("ball"));
        assert_eq!(
            keys.meta_schema("palpate.ToolPose.v1"),
            "palpate/default/@meta/schema/palpate.ToolPose.v1"
        );
        assert_eq!(keys.expand("tool/ball/force"), keys.tool_force("ball"));
        assert_eq!(keys.expand("palpate/other/status"), "palpate/other/status");
        assert_eq!(
            (keys.expand("net"), keys.expand("status")),
            (keys.body_net("*"), keys.status())
        );
        assert_eq!(
            parse_live(&keys.live_recorder("f00")),
            Some(("default", "recorder", "f00"))
        );
        assert_eq!(parse_live("palpate/default/status"), None);
        assert_eq!(keys.tool_of_live("palpate/other/@live/tool/ball"), None);
    }

    #[test]
    fn ids_with_other_characters_are_refused() {
        for id in ["", "A", "a/b", "a b", "ä", "*", "@x", &"a".repeat(65)] {
            assert!(check_id(id).is_err(), "{id:?} was accepted");
        }
        assert!(check_id(&"a".repeat(64)).is_ok());
    }
}
