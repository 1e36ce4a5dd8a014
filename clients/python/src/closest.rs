//! Closest points of many queries on all cores, as rows of bytes of dtype `CLOSEST`.

use palpate_geometry::math::Point3;
use palpate_geometry::surface::{ClosestSolver, Surface};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Queries that a thread takes at a time.
const BLOCK: usize = 256;

/// Threads that work at once.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Numbers of a row of dtype `CLOSEST`.
const ROW: usize = 12;

/// A row for each query; which thread makes it does not matter to its bits.
pub fn closest_rows(
    surface: &Surface,
    queries: &[Point3],
    curvature: bool,
    workers: usize,
) -> Vec<u8> {
    let mut rows = vec![0_u8; queries.len() * ROW * 8];
    let write = |solver: &mut ClosestSolver, query: &Point3, row: &mut [u8]| {
        let foot = solver.closest(surface, query);
        let bends = if curvature {
            surface.curvature(foot.u, foot.v)
        } else {
            None
        };
        let bends = bends.map_or([f64::NAN; 2], |c| [c.max, c.min]);
        let (p, n) = (foot.point, foot.normal);
        let values = [
            foot.u,
            foot.v,
            p.x,
            p.y,
            p.z,
            n.x,
            n.y,
            n.z,
            foot.distance,
            foot.signed_distance,
            bends[0],
            bends[1],
        ];
        for (bytes, value) in row.chunks_exact_mut(8).zip(values) {
            bytes.copy_from_slice(&value.to_ne_bytes());
        }
    };
    let workers = workers.min(queries.len().div_ceil(BLOCK));
    if workers <= 1 {
        let mut solver = ClosestSolver::new(surface);
        for (query, row) in queries.iter().zip(rows.chunks_exact_mut(ROW * 8)) {
            write(&mut solver, query, row);
        }
        return rows;
    }
    // Blocks are handed out in order; each has its place in the result.
    let blocks: Vec<_> = queries
        .chunks(BLOCK)
        .zip(rows.chunks_mut(BLOCK * ROW * 8))
        .map(|block| Mutex::new(Some(block)))
        .collect();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        let work = || {
            let mut solver = ClosestSolver::new(surface);
            while let Some(block) = blocks.get(next.fetch_add(1, Ordering::Relaxed)) {
                let taken = block.lock().ok().and_then(|mut block| block.take());
                if let Some((queries, rows)) = taken {
                    for (query, row) in queries.iter().zip(rows.chunks_exact_mut(ROW * 8)) {
                        write(&mut solver, query, row);
                    }
                }
            }
        };
        (1..workers).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    drop(blocks);
    rows
}
