//! The viewer page and its WebSocket.
