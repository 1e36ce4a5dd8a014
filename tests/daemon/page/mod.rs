//! The page: its socket, who may use it, and what it does to a scene.

mod browser;
mod crowds;
mod hands;
mod recordings;
mod security;
mod shown;

use crate::daemon::side_by_side;
pub use crate::scenes::{SOFT_DROP as SOFT, TWO_BALLS};

#[test]
fn pages_and_connections_that_are_silent_or_do_not_read() {
    side_by_side![
        hands::a_hand_without_motors_stays_while_its_page_is_silent_and_is_lost_after_half_a_second,
        security::a_connection_whose_request_does_not_end_is_closed,
        shown::a_page_that_does_not_read_gets_the_newest_only,
    ];
}
