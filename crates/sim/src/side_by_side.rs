//! Work on threads of its own, beside the loop.

/// What `make` gives for 0 to `count` − 1, each on a thread where there are several.
pub(crate) fn side_by_side<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if count < 2 {
        return (0..count).map(make).collect();
    }
    let mut made: Vec<Option<T>> = (0..count).map(|_| None).collect();
    std::thread::scope(|threads| {
        let make = &make;
        for (k, made) in made.iter_mut().enumerate() {
            threads.spawn(move || *made = Some(make(k)));
        }
    });
    // A thread that panics ends the scope with its panic.
    debug_assert!(made.iter().all(Option::is_some), "none is left out");
    made.into_iter().flatten().collect()
}
