//! Devices and programs that do not speak our messages: each against a daemon as a process.

mod foxglove;
mod guard;
mod haply;
mod igtl;
pub mod peer;
mod peers;
pub mod ros2;
mod rosbridge;

use crate::daemon::side_by_side;

#[test]
fn arms_routers_and_subscribers_come_and_go() {
    side_by_side![
        guard::the_simulated_arm_is_pressed_by_the_daemon_over_ros,
        haply::in_real_time_the_adapter_and_the_simulated_service_press_the_drop,
        haply::over_the_simulated_service_the_forces_are_those_of_a_native_run_bit_for_bit,
        ros2::a_router_may_appear_later_go_and_come_back,
        ros2::contact_wrenches_and_nets_are_published_while_somebody_subscribes,
        rosbridge::a_throttled_subscriber_gets_fewer_messages,
    ];
}
