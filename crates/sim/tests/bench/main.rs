//! A whole simulation on the carrier for tests: pace, changes, trips, restarts.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

mod changes;
mod events;
mod snapshots;
mod steps;
mod support;
