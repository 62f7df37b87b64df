//! Recordings as tables.
