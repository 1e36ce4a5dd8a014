//! What a tool touches: shapes, certified queries, contacts.
