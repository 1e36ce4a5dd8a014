//! `palpate ls`: who is on the bus.

use super::Outcome;
use super::connection::{Connection, PATIENCE};
use palpate_proto::keys::{INFO_EVERYWHERE, Keys, LIVE_EVERYWHERE, parse_live};
use palpate_proto::text::printable;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Print one JSON object per instance.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    connection: Connection,
}

/// One daemon, from its liveliness tokens and its `@meta/info`.
#[derive(Debug, Default, Serialize)]
struct Instance {
    instance: String,
    servers: Vec<String>,
    recording: bool,
    viewer: Option<String>,
    version: String,
    scene: String,
    rate_hz: f64,
    played: bool,
    /// Where others than this machine and holders of identities may come in.
    open: Vec<String>,
    tools: Vec<ListedTool>,
    bodies: Vec<String>,
    /// Keys on which it publishes, with the type of their messages.
    publishes: BTreeMap<String, &'static str>,
}

#[derive(Debug, Default, Serialize)]
struct ListedTool {
    id: String,
    /// Whether a client holds it, from its liveliness token.
    held: bool,
    /// Name from the device's description, if it sent one.
    device: Option<String>,
    /// Forces of ticks in which it was moved: sent to its client, or not because a newer one was there.
    forces_sent: u64,
    forces_overtaken: u64,
    /// Sent, and not received, as far as its client says.
    forces_lost: u64,
}

impl ListedTool {
    /// Forces that its device did not get, if there are any.
    fn missed(&self) -> String {
        let (overtaken, lost) = (self.forces_overtaken, self.forces_lost);
        let of = self.forces_sent + overtaken;
        match overtaken + lost {
            0 => String::new(),
            missed => format!(
                ", {missed} of {of} FORCES LOST: {overtaken} not sent in time, {lost} on the way"
            ),
        }
    }
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let palpate = args.connection.look_on()?;
    // A fresh link learns of tokens and queryables a moment later.
    let has_server = |keys: &[String]| {
        keys.iter()
            .any(|key| parse_live(key).is_some_and(|(_, kind, _)| kind == "server"))
    };
    let tokens = palpate.live(LIVE_EVERYWHERE, PATIENCE, has_server)?;
    let answers = palpate.ask(INFO_EVERYWHERE, PATIENCE)?;
    palpate.close();
    let mut instances = BTreeMap::<String, Instance>::new();
    let named = |instances: &mut BTreeMap<String, Instance>,
                 name: &str,
                 change: &mut dyn FnMut(&mut Instance)| {
        change(
            instances
                .entry(name.to_owned())
                .or_insert_with(|| Instance {
                    instance: name.to_owned(),
                    ..Default::default()
                }),
        );
    };
    for answer in &answers {
        let Ok(info) = serde_json::from_slice::<Value>(&answer.bytes) else {
            continue;
        };
        let name = info["instance"].as_str().unwrap_or_default().to_owned();
        named(&mut instances, &name, &mut |instance| instance.learn(&info));
    }
    for token in &tokens {
        let Some((name, kind, id)) = parse_live(token) else {
            continue;
        };
        named(&mut instances, name, &mut |instance| instance.see(kind, id));
    }
    anyhow::ensure!(
        !instances.is_empty(),
        "the endpoint accepts connections, but no palpate instance was found"
    );
    for instance in instances.values() {
        if args.json {
            println!("{}", serde_json::to_string(instance)?);
        } else {
            print!("{}", printable(&instance.words()));
        }
    }
    Ok(Outcome::Ok)
}

impl Instance {
    fn learn(&mut self, info: &Value) {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let ids = |value: &Value| {
            value
                .as_array()
                .map_or_else(Vec::new, |ids| ids.iter().map(text).collect())
        };
        self.version = text(&info["version"]);
        self.scene = text(&info["scene"]);
        self.rate_hz = info["rate_hz"].as_f64().unwrap_or_default();
        self.played = info["played"].as_bool().unwrap_or_default();
        self.viewer = info["viewer"].as_str().map(str::to_owned);
        self.open = ids(&info["open"]);
        self.bodies = ids(&info["bodies"]);
        let device = |id: &String| {
            info["devices"][id]["info"]["name"]
                .as_str()
                .map(str::to_owned)
        };
        let forces = |id: &str, what: &str| info["forces"][id][what].as_u64().unwrap_or_default();
        self.tools = ids(&info["tools"])
            .into_iter()
            .map(|id| ListedTool {
                held: false,
                device: device(&id),
                forces_sent: forces(&id, "sent"),
                forces_overtaken: forces(&id, "overtaken"),
                forces_lost: forces(&id, "lost"),
                id,
            })
            .collect();
        let Ok(keys) = Keys::new(&self.instance) else {
            return;
        };
        let mut published = vec![keys.status(), keys.event(), keys.contact()];
        published.extend(self.bodies.iter().map(|id| keys.body_net(id)));
        published.extend(self.tools.iter().flat_map(|tool| {
            let id = &tool.id;
            [
                keys.tool_force(id),
                keys.tool_force_v2(id),
                keys.tool_contact(id),
            ]
        }));
        self.publishes = published
            .into_iter()
            .filter_map(|key| palpate_proto::any::name_of_key(&key).map(|name| (key, name)))
            .collect();
    }

    fn see(&mut self, kind: &str, id: &str) {
        match kind {
            "server" => self.servers.push(id.to_owned()),
            "recorder" => self.recording = true,
            "viewer" => drop(self.viewer.get_or_insert_with(|| "yes".into())),
            "tool" => match self.tools.iter_mut().find(|tool| tool.id == id) {
                Some(tool) => tool.held = true,
                // Someone waits for a daemon, or holds what this scene does not have.
                None => self.tools.push(ListedTool {
                    id: id.to_owned(),
                    held: true,
                    ..ListedTool::default()
                }),
            },
            _ => {}
        }
    }

    fn words(&self) -> String {
        let mut out = String::new();
        let how = if self.played {
            ", played from a recording"
        } else {
            ""
        };
        let server = match &self.servers[..] {
            [] => "no server".to_owned(),
            servers => format!("server {}", servers.join(", ")),
        };
        let _ = writeln!(
            out,
            "{}: scene {:?} at {} Hz{how}, palpate {}, {server}",
            self.instance, self.scene, self.rate_hz, self.version
        );
        if !self.open.is_empty() {
            let _ = writeln!(
                out,
                "  OPEN to others, who can move tools and give commands: {}",
                self.open.join(", ")
            );
        }
        for tool in &self.tools {
            let held = if tool.held { "held" } else { "free" };
            let device = tool
                .device
                .as_ref()
                .map_or(String::new(), |name| format!(", device {name:?}"));
            let _ = writeln!(out, "  tool {}: {held}{device}{}", tool.id, tool.missed());
        }
        let _ = writeln!(out, "  bodies {}", self.bodies.join(", "));
        if self.recording {
            let _ = writeln!(out, "  recording");
        }
        if let Some(viewer) = &self.viewer {
            let _ = writeln!(out, "  viewer {viewer}");
        }
        for (key, name) in &self.publishes {
            let _ = writeln!(out, "  {key}  {name}");
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_that_a_device_did_not_get_are_listed_with_their_causes() {
        let mut tool = ListedTool {
            forces_sent: 6_149,
            ..ListedTool::default()
        };
        assert_eq!(tool.missed(), "");
        (tool.forces_overtaken, tool.forces_lost) = (12, 3);
        assert_eq!(
            tool.missed(),
            ", 15 of 6161 FORCES LOST: 12 not sent in time, 3 on the way"
        );
    }
}
