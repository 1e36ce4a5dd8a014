//! Roles as Zenoh's access control: what each may say and hear on which keys. Everything else is
//! denied, and so is every certificate without a role.

use super::{AuthError, Role};
use palpate_client::links::LOOPBACK_INTERFACE;
use palpate_proto::keys::{INFO_EVERYWHERE, Keys, LIVE_EVERYWHERE};
use serde_json::{Value, json};

/// Direction of a message, as the daemon sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Flow {
    /// From the client.
    In,
    /// To the client.
    Out,
}

/// What a role may do: these kinds of messages, in this direction, on these keys.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grant {
    flow: Flow,
    /// As Zenoh calls them.
    messages: &'static [&'static str],
    /// Key expressions.
    keys: Vec<String>,
}

impl Grant {
    fn new(flow: Flow, messages: &'static [&'static str], keys: &[&str]) -> Self {
        let keys = keys.iter().map(|key| (*key).to_owned()).collect();
        Self {
            flow,
            messages,
            keys,
        }
    }

    /// One line for people: what a client with it may do. `None` for what only follows from others.
    pub fn said(&self) -> Option<String> {
        let keys = self.keys.join(", ");
        match (self.flow, self.messages.first()?) {
            (Flow::In, &"put") => Some(format!("publishes {keys}")),
            (Flow::In, &"query") => Some(format!("asks {keys}")),
            (Flow::In, &"declare_subscriber") => Some(format!("hears {keys}")),
            (Flow::In, &"liveliness_token") => Some(format!("holds {keys}")),
            _ => None,
        }
    }
}

const ALL: &[&str] = &[
    "put",
    "delete",
    "declare_subscriber",
    "query",
    "reply",
    "declare_queryable",
    "liveliness_token",
    "liveliness_query",
    "declare_liveliness_subscriber",
];
const TOKENS_HEARD: &[&str] = &["liveliness_query", "declare_liveliness_subscriber"];

/// What a role may do with an instance.
///
/// # Errors
/// The instance name cannot be one.
pub fn grants(role: &Role, instance: &str) -> Result<Vec<Grant>, AuthError> {
    let keys = Keys::new(instance)?;
    let root = format!("palpate/{instance}");
    if matches!(role, Role::Daemon | Role::Operator) {
        let own = ["palpate/**", "palpate/*/@meta/**", "palpate/*/@live/**"];
        return Ok(vec![
            Grant::new(Flow::In, ALL, &own),
            Grant::new(Flow::Out, ALL, &own),
        ]);
    }
    let under = |rest: &str| format!("{root}/{rest}");
    let (all, meta, live) = (under("**"), under("@meta/**"), under("@live/**"));
    let asked = [
        keys.scene(),
        keys.status(),
        keys.event(),
        keys.tool_device("*"),
        keys.body_net("*"),
        meta.clone(),
    ];
    let mut asked: Vec<&str> = asked.iter().map(String::as_str).collect();
    // An answer has the key of its question.
    asked.push(INFO_EVERYWHERE);
    let answered = asked.clone();
    let mut grants = vec![
        Grant::new(Flow::In, &["declare_subscriber"], &[&all]),
        Grant::new(Flow::In, &["query"], &asked),
        Grant::new(Flow::In, TOKENS_HEARD, &[&live, LIVE_EVERYWHERE]),
        Grant::new(Flow::Out, &["put"], &[&all]),
        Grant::new(Flow::Out, &["reply", "declare_queryable"], &answered),
        Grant::new(Flow::Out, &["liveliness_token"], &[&live]),
        Grant::new(Flow::Out, TOKENS_HEARD, &[&live, LIVE_EVERYWHERE]),
    ];
    if let Role::Tool(tool) = role {
        let own = [keys.tool_pose(tool), keys.tool_device(tool)];
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        let token = keys.live_tool(tool);
        grants.push(Grant::new(Flow::In, &["put"], &own));
        grants.push(Grant::new(Flow::In, &["liveliness_token"], &[&token]));
        // Without it their client would not know that someone listens.
        grants.push(Grant::new(Flow::Out, &["declare_subscriber"], &own));
    }
    Ok(grants)
}

/// The section `access_control` of a Zenoh configuration for a daemon, or a router before it.
/// Links without TLS show no certificate. Those over the loopback interface and Unix sockets are the machine's own and
/// may do everything; with `insecure` all others may too.
///
/// # Errors
/// The instance name or a tool's id cannot be one.
pub fn rules<'a>(
    instance: &str,
    tools: impl IntoIterator<Item = &'a str>,
    insecure: bool,
) -> Result<Value, AuthError> {
    let mut roles = vec![Role::Daemon, Role::Operator, Role::Viewer];
    for tool in tools {
        roles.push(Role::tool(tool)?);
    }
    let (mut rules, mut subjects, mut policies) = (Vec::new(), Vec::new(), Vec::new());
    for role in &roles {
        let (name, mut own) = (role.to_string(), Vec::new());
        for (k, grant) in grants(role, instance)?.into_iter().enumerate() {
            let id = format!("{name} {k}");
            let flow = match grant.flow {
                Flow::In => "ingress",
                Flow::Out => "egress",
            };
            rules.push(json!({
                "id": id, "permission": "allow", "flows": [flow], "messages": grant.messages,
                "key_exprs": grant.keys,
            }));
            own.push(id);
        }
        subjects.push(json!({ "id": name, "cert_common_names": [name] }));
        policies.push(json!({ "rules": own, "subjects": [name] }));
    }
    let mut plain = vec![
        json!({ "id": "this machine", "link_protocols": ["tcp"], "interfaces": [LOOPBACK_INTERFACE] }),
        json!({ "id": "Unix sockets", "link_protocols": ["unixsock-stream"] }),
    ];
    if insecure {
        plain.push(json!({ "id": "everybody", "link_protocols": ["tcp"] }));
    }
    let ids: Vec<Value> = plain.iter().map(|subject| subject["id"].clone()).collect();
    policies.push(json!({ "rules": ["operator 0", "operator 1"], "subjects": ids }));
    subjects.append(&mut plain);
    Ok(json!({
        "enabled": true, "default_permission": "deny",
        "rules": rules, "subjects": subjects, "policies": policies,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    // Zenoh parses them, and no grant of a role that reads lets anything of its own in.
    #[test]
    fn the_rules_are_a_configuration_and_readers_publish_nothing() {
        let rules = rules("default", ["ball", "pen"], false).unwrap();
        let mut config = zenoh::Config::default();
        config
            .insert_json5("access_control", &rules.to_string())
            .unwrap();
        for grant in grants(&Role::Viewer, "default").unwrap() {
            let writes = [
                "put",
                "delete",
                "reply",
                "declare_queryable",
                "liveliness_token",
            ];
            assert!(
                grant.flow == Flow::Out || grant.messages.iter().all(|m| !writes.contains(m)),
                "{grant:?}"
            );
        }
        let ball = grants(&Role::tool("ball").unwrap(), "default").unwrap();
        let put = ball
            .iter()
            .find(|g| g.flow == Flow::In && g.messages == ["put"]);
        assert_eq!(
            put.unwrap().keys,
            [
                "palpate/default/tool/ball/pose",
                "palpate/default/tool/ball/device"
            ]
        );
        assert!(super::rules("de fault", [], false).is_err());
    }

    // A link that the daemon dials over plain TCP arrives at a network interface, wherever it leads.
    #[test]
    fn without_a_certificate_only_loopback_and_unix_sockets_are_this_machine() {
        let plain = |insecure| {
            let rules = rules("default", [], insecure).unwrap();
            let subjects = rules["subjects"].as_array().unwrap().clone();
            subjects
                .into_iter()
                .filter(|subject| subject["cert_common_names"].is_null())
                .map(|subject| {
                    let loopback = subject["interfaces"] == json!([LOOPBACK_INTERFACE]);
                    (subject["link_protocols"].clone(), loopback)
                })
                .collect::<Vec<_>>()
        };
        let own = vec![(json!(["tcp"]), true), (json!(["unixsock-stream"]), false)];
        assert_eq!(plain(false), own);
        let all = [own, vec![(json!(["tcp"]), false)]].concat();
        assert_eq!(plain(true), all);
    }
}
