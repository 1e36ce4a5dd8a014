use super::*;

const MTLS: (&str, &str) = (
    "transport/link/tls",
    r#"{ enable_mtls: true, root_ca_certificate_base64: "YQ==" }"#,
);
const RULES: (&str, &str) = ("access_control/enabled", "true");

/// Openings of a session that has our defaults and these settings besides.
fn found(mode: &str, settings: &[(&str, &str)]) -> Vec<String> {
    let mut config = crate::configuration(None, mode).unwrap();
    for (key, value) in settings {
        config.insert_json5(key, value).unwrap();
    }
    openings(&config)
        .into_iter()
        .map(|opening| opening.what)
        .collect()
}

fn with_endpoint(key: &str, endpoint: &str, more: &[(&str, &str)]) -> Vec<String> {
    let list = format!("[{endpoint:?}]");
    found("peer", &[&[(key, list.as_str())], more].concat())
}

const BOTH: [&str; 2] = ["listen/endpoints", "connect/endpoints"];

#[test]
fn links_that_stay_on_this_machine_need_nothing() {
    let through_loopback = format!("tcp/127.0.0.1:7447#iface={LOOPBACK_INTERFACE}");
    for here in [
        "tcp/127.0.0.1:7447",
        "tcp/localhost:7447",
        "tcp/LOCALHOST:7447",
        "tcp/[::1]:7447",
        "tcp/127.3.2.1:7447",
        "tcp/[::ffff:127.0.0.1]:7447",
        "tcp/127.0.0.1:7447?prio=1-3",
        "tcp/127.0.0.1:7447#so_sndbuf=65536",
        through_loopback.as_str(),
        "tls/127.0.0.1:7447",
        "quic/127.0.0.1:7447",
        "unixsock-stream//tmp/palpate",
    ] {
        for key in BOTH {
            assert!(with_endpoint(key, here, &[]).is_empty(), "{key} {here}");
        }
    }
}

// Neither a name that means loopback today, nor a spelling that only the resolver understands, nor a protocol.
#[test]
fn links_that_may_leave_this_machine_are_openings_in_either_direction() {
    let own_name = std::fs::read_to_string("/etc/hostname").unwrap_or_default();
    let own_name = format!("tcp/{}:7447", own_name.trim());
    for away in [
        "tcp/0.0.0.0:7447",
        "tcp/[::]:7447",
        "tcp/10.0.0.2:7447",
        "tcp/[fe80::1]:7447",
        "tcp/[::ffff:10.0.0.2]:7447",
        "tcp/[::ffff:0.0.0.0]:7447",
        "tcp/lab.example:7447",
        "tcp/localhost.example:7447",
        "tcp/127.0.0.1.example:7447",
        "tcp/2130706433:7447",
        "tcp/0x7f000001:7447",
        "tcp/127.1:7447",
        "tcp/0:7447",
        "tcp/127.0.0.1",
        "tcp/10.0.0.2:7447?prio=1-3",
        "tcp/10.0.0.2:7447#iface=lo",
        "tcp/127.0.0.1:7447#iface=eth0",
        "tcp/127.0.0.1:7447#iface=lo;iface=eth0",
        "tls/lab.example:7447",
        "quic/0.0.0.0:7447",
        "quic/lab.example:7447?rel=0",
        // Not built in, but the rule does not lean on that.
        "udp/127.0.0.1:7447",
        "ws/127.0.0.1:7447",
        "quic_datagram/127.0.0.1:7447",
        "serial//dev/ttyACM0",
        "unixpipe/palpate",
        "vsock/2:7447",
        own_name.as_str(),
    ] {
        for key in BOTH {
            assert_eq!(with_endpoint(key, away, &[]), [away], "{key}");
        }
    }
}

#[test]
fn tls_and_quic_with_an_identity_may_leave_and_what_listens_needs_rules_too() {
    for endpoint in [
        "tls/0.0.0.0:7447",
        "quic/lab.example:7447",
        "tls/[::]:7447#so_rcvbuf=65536",
    ] {
        let in_ = |more: &[_]| with_endpoint("listen/endpoints", endpoint, more);
        let out = |more: &[_]| with_endpoint("connect/endpoints", endpoint, more);
        assert_eq!(in_(&[MTLS]), [endpoint]);
        assert_eq!(in_(&[RULES]), [endpoint]);
        assert!(in_(&[MTLS, RULES]).is_empty());
        assert_eq!(out(&[RULES]), [endpoint]);
        assert!(out(&[MTLS]).is_empty());
        // Certificates of clients, but nobody to have signed them; names that nobody compares; rules that forbid nothing.
        let no_authority = ("transport/link/tls/root_ca_certificate_base64", "null");
        assert_eq!(out(&[MTLS, no_authority]), [endpoint]);
        let any_name = ("transport/link/tls/verify_name_on_connect", "false");
        assert_eq!(out(&[MTLS, any_name]), [endpoint]);
        let allow = ("access_control/default_permission", "\"allow\"");
        assert_eq!(in_(&[MTLS, RULES, allow]), [endpoint]);
        assert_eq!(
            in_(&[MTLS, RULES, ("transport/link/tls/enable_mtls", "false")]),
            [endpoint]
        );
    }
    let plain = with_endpoint("listen/endpoints", "tcp/0.0.0.0:7447", &[MTLS, RULES]);
    assert_eq!(plain, ["tcp/0.0.0.0:7447"]);
}

// Zenoh lets an endpoint say otherwise than the configuration.
#[test]
fn an_endpoint_cannot_switch_its_own_certificates_off() {
    for parameters in [
        "enable_mtls=false",
        "verify_name_on_connect=false",
        "root_ca_certificate_file=/tmp/other.pem",
        "listen_certificate_base64=YQ==",
        "so_sndbuf=65536;enable_mtls=false",
    ] {
        let endpoint = format!("tls/0.0.0.0:7447#{parameters}");
        for key in BOTH {
            let open = with_endpoint(key, &endpoint, &[MTLS, RULES]);
            // A parameter may be a key.
            assert_eq!(open, ["tls/0.0.0.0:7447#…"], "{key} {parameters}");
        }
    }
}

#[test]
fn endpoints_count_for_the_mode_of_the_session_and_in_groups() {
    let by_mode = r#"{ peer: ["tcp/0.0.0.0:0"], router: ["tcp/127.0.0.1:0"] }"#;
    for key in BOTH {
        assert_eq!(found("peer", &[(key, by_mode)]), ["tcp/0.0.0.0:0"]);
        assert!(found("router", &[(key, by_mode)]).is_empty());
        assert!(found("client", &[(key, by_mode)]).is_empty());
    }
    let group = r#"["tcp/127.0.0.1:1", { strategy: "allOf", locators: ["tcp/127.0.0.1:2", "tcp/10.0.0.2:3"] }]"#;
    assert_eq!(
        found("peer", &[("connect/endpoints", group)]),
        ["tcp/10.0.0.2:3"]
    );
}

// A session's neighbours tell it of addresses that they made up; whoever answers multicast can be anybody.
#[test]
fn links_to_whoever_is_found_are_openings_with_certificates_too() {
    let on = [("scouting/multicast/enabled", "true"), MTLS, RULES];
    assert_eq!(found("peer", &on), ["scouting/multicast"]);
    assert_eq!(found("client", &on), ["scouting/multicast"]);
    assert_eq!(found("router", &on), [""; 0]);
    let routers = (
        "scouting/multicast/autoconnect",
        r#"{ router: ["peer"], peer: [] }"#,
    );
    assert_eq!(
        found("router", &[&on[..], &[routers]].concat()),
        ["scouting/multicast"]
    );
    assert_eq!(found("peer", &[&on[..], &[routers]].concat()), [""; 0]);
    let gossip = ("scouting/gossip/autoconnect", r#"["router"]"#);
    assert_eq!(found("peer", &[gossip, MTLS, RULES]), ["scouting/gossip"]);
    let off = ("scouting/gossip/enabled", "false");
    assert_eq!(found("peer", &[gossip, off]), [""; 0]);
}

#[test]
fn a_configuration_that_others_may_change_is_an_opening() {
    let (enabled, write) = (
        ("adminspace/enabled", "true"),
        ("adminspace/permissions/write", "true"),
    );
    assert_eq!(
        found("peer", &[enabled, write]),
        ["adminspace/permissions/write"]
    );
    assert_eq!(found("peer", &[enabled]), [""; 0]);
}

// Zenoh's own defaults, without ours: all interfaces, multicast, gossip.
#[test]
fn a_bare_configuration_of_zenoh_does_not_open() {
    let config = zenoh::Config::default();
    let all: Vec<_> = openings(&config)
        .into_iter()
        .map(|opening| opening.what)
        .collect();
    assert_eq!(all, ["tcp/[::]:0", "scouting/multicast", "scouting/gossip"]);
    let error = open(config, false).unwrap_err();
    assert!(error.to_string().contains("--insecure"), "{error}");
}
