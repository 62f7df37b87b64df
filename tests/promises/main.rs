//! Promises of the contract, one a file, kept by the real program.

mod circular;
mod poles;
mod run;
