//! Promises of the contract, one a file, kept by the real program.

mod assess;
mod circular;
mod console;
mod documents;
mod endings;
mod events;
mod examples;
mod files;
mod kept;
mod linear;
mod live;
mod loops;
mod manners;
mod many;
mod papers;
mod picture;
mod poles;
mod recordings;
mod replay;
mod report;
mod run;
mod speeds;
mod tune;
mod typed;
mod units;
mod workbench;
