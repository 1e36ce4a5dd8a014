//! Every reader on bytes that nobody wrote: the fuzz targets, on changed copies of what they start
//! from.

#[path = "../../fuzz/parsers.rs"]
mod parsers;

use palpate_geometry::math::Random;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Changed copies of each seed. Recordings are long, and each copy is read whole.
const CHANGES: usize = 400;

/// One of: cut short, a byte changed, a stretch dropped, doubled or filled, numbers made huge.
fn changed(seed: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        let end = (at + random.below(64)).min(bytes.len());
        match random.below(7) {
            0 => bytes.truncate(at),
            1 => bytes
                .get_mut(at)
                .into_iter()
                .for_each(|byte| *byte ^= 1 << random.below(8)),
            2 => bytes
                .get_mut(at)
                .into_iter()
                .for_each(|byte| *byte = b"0123456789.,;()#'$*-+eD\n{}[]\""[random.below(29)]),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let stretch = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, stretch);
            }
            5 => bytes[at..end].fill([0, 0xff, b'9', b'('][random.below(4)]),
            _ => {
                let digits = [
                    &b"99999999999999999999"[..],
                    b"-1",
                    b"1e999",
                    b"nan",
                    b"4294967295",
                ][random.below(5)];
                bytes.splice(at..at, digits.iter().copied());
            }
        }
    }
    bytes
}

#[test]
fn no_reader_panics_on_changed_files() {
    let mut tried = 0;
    for target in parsers::TARGETS {
        let mut random = Random(17);
        for (k, seed) in (target.seeds)().iter().enumerate() {
            (target.run)(seed);
            let changes = if seed.len() > 100_000 {
                CHANGES / 10
            } else {
                CHANGES
            };
            tried += changes;
            for change in 0..changes {
                let bytes = changed(seed, &mut random);
                let done = catch_unwind(AssertUnwindSafe(|| (target.run)(&bytes)));
                assert!(done.is_ok(), "{}: seed {k}, change {change}", target.name);
            }
        }
    }
    println!(
        "{tried} changed files in {} readers",
        parsers::TARGETS.len()
    );
}

#[test]
fn a_sequence_of_messages_is_taken_and_comes_to_the_same_bits_twice() {
    let bus = (parsers::TARGETS.iter()).find(|target| target.name == "bus");
    for seed in (bus.unwrap().seeds)() {
        let told = palpate_faults::messages(&seed).unwrap();
        println!("{told:?}");
        assert!(told.dropped <= 1 && told.ticks > 200, "{told:?}");
        assert_eq!(palpate_faults::messages(&seed), Ok(told));
    }
}
