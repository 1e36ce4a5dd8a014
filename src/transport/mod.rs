//! Zenoh: keys, sessions, quality of service, the bus thread.
