//! Where domain types meet palpate-proto.
