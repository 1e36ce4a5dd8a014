//! The Haply Inverse Service: JSON over a WebSocket, a state for each message.
//!
//! Source: docs.haply.co, Inverse SDK 3.5, "WebSocket protocol". Metres, m/s, newtons. On connect the
//! service sends all that it has; afterwards exactly one state for each message it gets. It keeps no
//! command: a device whose program stops is idle.
