//! MCAP: recorder, reader, replay, recovery.
