//! Keys of topics and services, and the liveliness tokens that make up the ROS graph.

use super::RosType;

/// Identity of an endpoint: XXH3-128 (seed 0) of its token's text, little-endian.
pub type Gid = [u8; 16];

/// What an endpoint does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Publishes a topic.
    Publisher,
    /// Subscribes to a topic.
    Subscription,
    /// Answers a service.
    Service,
    /// Calls a service.
    Client,
}

impl Kind {
    fn letters(self) -> &'static str {
        match self {
            Self::Publisher => "MP",
            Self::Subscription => "MS",
            Self::Service => "SS",
            Self::Client => "SC",
        }
    }
}

/// Quality of service as the graph tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Qos {
    /// Best effort, the newest only: motion and forces.
    Newest,
    /// Reliable, ten kept: states, events, services.
    Reliable,
}

impl Qos {
    fn text(self) -> &'static str {
        match self {
            Self::Newest => "2::,1:,:,:,,",
            Self::Reliable => "::,10:,:,:,,",
        }
    }
}

/// A name within one part of a token: `/` becomes `%`.
fn mangled(name: &str) -> String {
    name.replace('/', "%")
}

/// Key of a topic or service: `0/arm/measured_cp/geometry_msgs::msg::dds_::PoseStamped_/RIHS01_…`.
pub fn topic_key(domain: u32, topic: &str, kind: &RosType) -> String {
    format!("{}/{}", without_hash(domain, topic, kind), kind.hash)
}

/// The same for subscribers: with any hash, because Humble says `TypeHashNotSupported`.
pub fn topic_subscription(domain: u32, topic: &str, kind: &RosType) -> String {
    format!("{}/*", without_hash(domain, topic, kind))
}

fn without_hash(domain: u32, topic: &str, kind: &RosType) -> String {
    format!("{domain}/{}/{}", topic.trim_matches('/'), kind.dds_name())
}

/// A node of the graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// ROS domain.
    pub domain: u32,
    /// Id of the Zenoh session.
    pub zid: String,
    /// Number of the node within the session.
    pub id: u64,
    /// Its name, without namespace.
    pub name: String,
}

/// Token of a node.
pub fn node_token(node: &Node) -> String {
    let Node {
        domain,
        zid,
        id,
        name,
    } = node;
    format!("@ros2_lv/{domain}/{zid}/{id}/{id}/NN/%/%/{name}")
}

/// An endpoint of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    /// What it does.
    pub kind: Kind,
    /// Number within the session.
    pub id: u64,
    /// Topic or service, with its slashes: `/arm/servo_cf`.
    pub topic: String,
    /// Type of its messages.
    pub ros_type: &'static RosType,
    /// Quality of service.
    pub qos: Qos,
}

impl Endpoint {
    /// Its token.
    pub fn token(&self, node: &Node) -> String {
        let Node {
            domain,
            zid,
            id,
            name,
        } = node;
        let topic = mangled(&format!("/{}", self.topic.trim_matches('/')));
        format!(
            "@ros2_lv/{domain}/{zid}/{id}/{}/{}/%/%/{name}/{topic}/{}/{}/{}",
            self.id,
            self.kind.letters(),
            self.ros_type.dds_name(),
            self.ros_type.hash,
            self.qos.text()
        )
    }

    /// Its identity in attachments.
    pub fn gid(&self, node: &Node) -> Gid {
        gid_of(&self.token(node))
    }
}

/// Identity of the endpoint that has this token.
pub fn gid_of(token: &str) -> Gid {
    xxhash_rust::xxh3::xxh3_128(token.as_bytes()).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::super::{PoseStamped, RosMessage, WrenchStamped};
    use super::*;

    #[test]
    fn a_topic_has_the_key_of_rmw_zenoh() {
        assert_eq!(
            topic_key(0, "/arm/measured_cp", PoseStamped::TYPE),
            "0/arm/measured_cp/geometry_msgs::msg::dds_::PoseStamped_/\
             RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"
        );
        assert_eq!(
            topic_subscription(7, "arm/measured_cp/", PoseStamped::TYPE),
            "7/arm/measured_cp/geometry_msgs::msg::dds_::PoseStamped_/*"
        );
    }

    #[test]
    fn tokens_and_identity_are_those_of_the_graph() {
        let node = Node {
            domain: 0,
            zid: "a1b2".into(),
            id: 0,
            name: "palpate".into(),
        };
        assert_eq!(node_token(&node), "@ros2_lv/0/a1b2/0/0/NN/%/%/palpate");
        let end = Endpoint {
            kind: Kind::Publisher,
            id: 3,
            topic: "/arm/servo_cf".into(),
            ros_type: WrenchStamped::TYPE,
            qos: Qos::Newest,
        };
        let token = "@ros2_lv/0/a1b2/0/3/MP/%/%/palpate/%arm%servo_cf/geometry_msgs::msg::dds_::WrenchStamped_/\
                     RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77/2::,1:,:,:,,";
        assert_eq!(end.token(&node), token);
        assert_eq!(end.gid(&node), gid_of(token));
        // XXH3-128 of the empty text, from the algorithm's own specification.
        assert_eq!(
            u128::from_le_bytes(gid_of("")),
            0x99aa_06d3_0147_98d8_6001_c324_468d_497f
        );
    }
}
