//! What keeping a session costs the tick.

use super::session::{FOUR_HANDS, Simulated, TEARDROP};
use super::{Bar, Effort, Figure, Files, figure};
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_drive::pacer::{now_ns, sleep_until};
use palpate_drive::stats::Histogram;

pub(super) fn run(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let ticks = if effort == Effort::Quick {
        2_000
    } else {
        20_000
    };
    let files = Files::new("cost")?;
    for (name, text) in [("teardrop", TEARDROP), ("four-hands", FOUR_HANDS)] {
        let mut simulated = Simulated::new(text, |_| {})?;
        let path = files.path(&format!("{name}.mcap"));
        let (recorder, mut port) = simulated.recorder(|settings| settings.to(&path))?;
        let mut nets = NetPool::new(&simulated.scene, port.nets_held());
        let (mut plain, mut keyframes) = (Histogram::default(), Histogram::default());
        let mut next = now_ns();
        for _ in 0..ticks {
            // At its own rate: the caches are as cold as in a loop.
            next = (next + 1_000_000).max(now_ns());
            sleep_until(next);
            let record = simulated.tick();
            let begun = now_ns();
            nets.begin();
            port.tick(&simulated.scene, &simulated.state, &record, &mut nets);
            let took = now_ns() - begun;
            match record.output.tick.is_multiple_of(1_000) {
                true => keyframes.add(took),
                false => plain.add(took),
            }
        }
        drop(port);
        recorder.finish().last()?;
        let us = |ns: u64| ns as f64 * 1e-3;
        let note = format!(
            "p50; p99 {:.2} us, max {:.1} us; a tick with a keyframe (1 in 1000) p50 {:.1} us, max {:.1} us",
            us(plain.quantile(0.99)),
            us(plain.max()),
            us(keyframes.quantile(0.5)),
            us(keyframes.max())
        );
        out(figure(
            "cost/tick",
            name,
            us(plain.quantile(0.5)),
            "us",
            Some(Bar::AtMost(2.0)),
            note,
        ));
    }
    Ok(())
}
