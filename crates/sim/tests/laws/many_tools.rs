//! Scenes of as many tools as there may be.

use crate::common::{Laws as _, World, many_tools, place_of_many};
use palpate_sim::scene::file;
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::record::TickOutput;
use std::path::Path;

/// How deep a tool is pushed at the end, m: each a little deeper than the one before it.
fn depth_m(tool: usize) -> f64 {
    0.003 + 2e-5 * tool as f64
}

/// Those tools over a plate that does not give way.
fn rigid(tools: impl IntoIterator<Item = usize>) -> String {
    let soft = many_tools(tools, "");
    let (body, tools) = soft.split_once("model = ").unwrap();
    let tools = &tools[tools.find("[[tool]]").unwrap()..];
    format!("{body}{tools}")
}

/// Lowers the tools of a scene, then holds them.
fn pressed(text: &str) -> TickOutput {
    let mut world = World::new(text);
    let ids = world
        .scene
        .spec
        .tools
        .iter()
        .map(|tool| &tool.id["ball".len()..]);
    let tools: Vec<usize> = ids.map(|number| number.parse().unwrap()).collect();
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

#[test]
fn each_of_64_tools_feels_on_a_rigid_plate_what_it_feels_alone() {
    let all: Vec<usize> = (0..64).collect();
    let together = pressed(&rigid(all));
    for tool in [0, 7, 27, 36, 63] {
        let alone = pressed(&rigid([tool])).tools[0];
        assert!(alone.force_n.z > 1.0, "tool {tool}: {} N", alone.force_n.z);
        let among = together.tools[tool];
        let contact = among.contact.expect("it touches");
        assert_eq!(contact.holder, Holder::Tool(tool as u32));
        // One solve for all: it may take other sweeps than that for one.
        let apart = (among.force_n - alone.force_n).norm();
        assert!(
            apart < 1e-12 * alone.force_n.norm(),
            "tool {tool}: {apart} N"
        );
        assert_eq!(among.contact_count, alone.contact_count);
    }
    assert_eq!(together.contacts.list().len(), 64);
}

// On one slab they do feel each other, by what the net's spans (47 mm, at a distance of 100 mm)
// carry on: a neighbour presses the slab down a little, so each is lighter than alone, those in a
// corner (two neighbours) half as much as those in the middle (four).
#[test]
fn each_of_64_tools_on_a_soft_slab_feels_itself_and_its_neighbours() {
    let all: Vec<usize> = (0..64).collect();
    let together = pressed(&many_tools(all, ""));
    for tool in 0..64 {
        let out = &together.tools[tool];
        let contact = out.contact.expect("it touches");
        assert_eq!(contact.holder, Holder::Tool(tool as u32));
        let [x, y, _] = place_of_many(tool);
        let apart = (contact.point.x - x).hypot(contact.point.y - y);
        assert!(apart < 0.02, "tool {tool} is touched {apart} m beside it");
    }
    let lighter = |tool: usize| {
        let alone = pressed(&many_tools([tool], "")).tools[0];
        let among = together.tools[tool];
        assert_eq!(among.contact_count, alone.contact_count, "tool {tool}");
        1.0 - among.force_n.z / alone.force_n.z
    };
    let corner = [0, 7, 63].map(lighter);
    let middle = [27, 36].map(lighter);
    for share in corner.iter().chain(&middle) {
        assert!((0.0..0.05).contains(share), "{corner:?} {middle:?}");
    }
    let ratio = middle.iter().sum::<f64>() / 2.0 / (corner.iter().sum::<f64>() / 3.0);
    assert!((1.8..2.2).contains(&ratio), "{corner:?} {middle:?}");
    assert!(
        together
            .contacts
            .list()
            .is_sorted_by(|a, b| a.depth_m >= b.depth_m)
    );
}

#[test]
fn more_than_64_tools_are_refused() {
    let refused = |count: usize| {
        let text = many_tools(0..count, "");
        let loaded = file::parse(&text, "many.toml", Path::new(".")).unwrap();
        loaded.build().err().map(|error| error.to_string())
    };
    assert_eq!(refused(64), None);
    let error = refused(65).unwrap();
    let line = 1 + many_tools(0..64, "").lines().count() + 1;
    assert!(
        error.contains("65 tools; a scene has at most 64 tools")
            && error.contains(&format!("many.toml:{line}")),
        "{error}"
    );
}
