//! Roles, which are the common names of certificates.

use palpate_proto::keys::{IdError, check_id};
use std::fmt;

/// What the holder of a certificate may do.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// A daemon or router: the end that others connect to.
    Daemon,
    /// Everything: commands, any tool.
    Operator,
    /// Moves one tool, and reads.
    Tool(String),
    /// Reads.
    Viewer,
}

impl Role {
    /// The role of a tool.
    ///
    /// # Errors
    /// The tool's id cannot be one.
    pub fn tool(id: &str) -> Result<Self, IdError> {
        Ok(Self::Tool(check_id(id)?.to_owned()))
    }

    /// The role that a common name says; `None` for any other name.
    pub fn of(common_name: &str) -> Option<Self> {
        match common_name.split_once(':') {
            Some(("tool", id)) => Self::tool(id).ok(),
            Some(_) => None,
            None => match common_name {
                "daemon" => Some(Self::Daemon),
                "operator" => Some(Self::Operator),
                "viewer" => Some(Self::Viewer),
                _ => None,
            },
        }
    }

    /// As part of a file name: no colon.
    pub fn stem(&self) -> String {
        self.to_string().replace(':', "-")
    }
}

/// The common name of its certificates.
impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Daemon => f.write_str("daemon"),
            Self::Operator => f.write_str("operator"),
            Self::Tool(id) => write!(f, "tool:{id}"),
            Self::Viewer => f.write_str("viewer"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_role_is_its_common_name_and_other_names_are_no_roles() {
        let tool = Role::tool("ball").unwrap();
        for role in [Role::Daemon, Role::Operator, tool, Role::Viewer] {
            assert_eq!(Role::of(&role.to_string()), Some(role));
        }
        for name in [
            "", "root", "Operator", "tool:", "tool:*", "tool:a/b", "viewer:x", "tool",
        ] {
            assert_eq!(Role::of(name), None, "{name:?}");
        }
        assert!(Role::tool("*").is_err());
    }
}
