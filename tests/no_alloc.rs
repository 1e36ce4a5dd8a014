//! The tick allocates nothing once it runs.

mod common;

use common::{World, teardrop};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<Option<u64>> = const { Cell::new(None) };
}

// SAFETY: hands every call to the system allocator unchanged.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get().map(|n| n + 1)));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        unsafe { System.dealloc(ptr, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of this thread while `work` runs.
fn allocations(work: impl FnOnce()) -> u64 {
    COUNT.with(|count| count.set(Some(0)));
    work();
    COUNT.with(|count| count.take()).unwrap_or(0)
}

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1u8; 100]))) > 0);
}

/// Approaches, presses, slides, leaves and comes back.
fn touch(world: &mut World) -> u64 {
    for _ in 0..5 {
        world.at([0.06, 0.003, 0.045]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..3_000 {
            let t = f64::from(k) * 1e-3;
            let x = 0.036 + 0.012 * (4.0 * t).cos();
            let out = world.at([x, 0.003 + 0.004 * (3.0 * t).sin(), 0.045]);
            touched += u32::from(out.tools[0].contact.is_some());
        }
        for _ in 0..200 {
            world.silent();
        }
    });
    assert!(touched > 500, "only {touched} ticks in touch");
    count
}

#[test]
fn a_tick_on_a_rigid_body_allocates_nothing() {
    let text = teardrop(20e3, "\"none\"")
        .replace("model = \"lattice\"\n", "")
        .replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    assert_eq!(touch(&mut World::new(&text)), 0);
}

#[test]
fn a_tick_on_a_lattice_allocates_nothing() {
    let text = teardrop(20e3, "[16, 17]").replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    assert_eq!(touch(&mut World::new(&text)), 0);
}
