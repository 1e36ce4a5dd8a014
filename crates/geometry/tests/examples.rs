//! The examples run and hold what they assert.

#[path = "../examples/surface_query.rs"]
mod surface_query;

#[test]
fn surface_query_runs() {
    surface_query::main().unwrap();
}
