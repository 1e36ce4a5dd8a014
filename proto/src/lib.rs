//! Wire messages, key expressions and recording schemas of Palpate.

pub mod messages;
