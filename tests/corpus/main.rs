//! Files by the thousand, mutated from good ones and made up, that no reader may stumble over: no panic, no hang, no number
//! that is none, and no half result. What a reader accepts goes on through all that would be done with it.
//!
//! The run is bounded and always the same, so that a failure can be had again. `just fuzz` runs on with other seeds:
//! `WHIRL_FUZZ_SECONDS` is how long for each kind of file, `WHIRL_FUZZ_SEED` where it begins. Recordings have a corpus of
//! their own beside their reader, in `crates/tape/tests`.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

mod harness;
mod machine;
mod made_up;
mod mutation;
mod screens;
