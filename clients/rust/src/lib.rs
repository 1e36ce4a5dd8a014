//! Client of Palpate.
