//! What the loop does and how well, as clients see it: what changes make of it.

use palpate_drive::overload::{CAUSES, QUIET};
use palpate_proto::messages::{EventKind, LoopState};
use palpate_sim::tick::record::Command;

/// The state after a command, and the event for it; no event where nothing has changed.
pub(super) fn after(state: LoopState, command: Command) -> (LoopState, Option<EventKind>) {
    use LoopState::{Paused, Running, Stopping};
    match (state, command) {
        (_, Command::Reset) => (state, Some(EventKind::Reset)),
        (_, Command::Stop) => (Stopping, None),
        (Running, Command::Pause) => (Paused, Some(EventKind::Paused)),
        (Paused, Command::Resume) => (Running, Some(EventKind::Resumed)),
        (
            _,
            Command::Pause
            | Command::Resume
            | Command::Step(_)
            | Command::Quality(_)
            | Command::PutOff { .. }
            | Command::Send { .. }
            | Command::Device { .. },
        ) => (state, None),
    }
}

/// Why quality went from one level to another, for people: which way first. `cause`: of the newest change, as an
/// index of [`CAUSES`]; `None` where a recording is played.
pub(super) fn quality_reason(before: u8, level: u8, cause: Option<usize>) -> String {
    let worse = level > before;
    let way = if worse { "lowered" } else { "raised" };
    let why = match cause {
        None => ", as it was recorded".to_owned(),
        Some(_) if !worse => ": ticks have ended in good time for a while".to_owned(),
        // It has changed again meanwhile, and the cause of this time is not known any more.
        Some(QUIET) => ": a tenth of the ticks overran".to_owned(),
        Some(cause) => format!(
            ": a tenth of the ticks overran, most of their time in {}",
            cause_name(cause)
        ),
    };
    format!("{way} from level {before}{why}")
}

/// What an overrun is put down to.
pub(super) fn cause_name(cause: usize) -> &'static str {
    CAUSES.get(cause).copied().unwrap_or("the system")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_told_where_it_changes_something_and_a_loop_that_ends_goes_on_ending() {
        use LoopState::{Paused, Running, Stopping};
        let table = [
            (Running, Command::Pause, Paused, Some(EventKind::Paused)),
            (Running, Command::Resume, Running, None),
            (Running, Command::Step(3), Running, None),
            (Running, Command::Reset, Running, Some(EventKind::Reset)),
            (Running, Command::Stop, Stopping, None),
            (Paused, Command::Pause, Paused, None),
            (Paused, Command::Resume, Running, Some(EventKind::Resumed)),
            (Paused, Command::Step(3), Paused, None),
            (Paused, Command::Reset, Paused, Some(EventKind::Reset)),
            (Paused, Command::Stop, Stopping, None),
            (Stopping, Command::Pause, Stopping, None),
            (Stopping, Command::Resume, Stopping, None),
            (Stopping, Command::Step(3), Stopping, None),
            (Stopping, Command::Reset, Stopping, Some(EventKind::Reset)),
            (Stopping, Command::Stop, Stopping, None),
        ];
        for (state, command, then, event) in table {
            assert_eq!(
                after(state, command),
                (then, event),
                "{state:?}, {command:?}"
            );
        }
    }

    #[test]
    fn a_change_of_quality_says_which_way_it_went_and_blames_nothing_when_it_rises() {
        let deform = CAUSES.iter().position(|cause| *cause == "deform");
        let lowered =
            "lowered from level 0: a tenth of the ticks overran, most of their time in deform";
        assert_eq!(quality_reason(0, 1, deform), lowered);
        for (before, level) in [(3, 2), (2, 1), (1, 0)] {
            for cause in [Some(QUIET), deform] {
                assert_eq!(
                    quality_reason(before, level, cause),
                    format!(
                        "raised from level {before}: ticks have ended in good time for a while"
                    )
                );
            }
        }
        assert_eq!(
            quality_reason(1, 2, Some(QUIET)),
            "lowered from level 1: a tenth of the ticks overran"
        );
        // Played back, or sought to: nothing overran here.
        assert_eq!(
            quality_reason(0, 2, None),
            "lowered from level 0, as it was recorded"
        );
        assert_eq!(
            quality_reason(2, 0, None),
            "raised from level 2, as it was recorded"
        );
    }
}
