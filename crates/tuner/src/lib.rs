//! Gain search.
mod certify;
mod conditions;
mod evaluate;
mod family;
mod force;
mod least_norm;
mod measure;
mod minimax;
mod powell;
mod problem;
mod quadratic_program;
mod rows;
mod search;
mod smooth;
mod stop;
mod structure;

pub use certify::Certificate;
pub use family::{Axis, Family, FamilyError, Quantity};
pub use measure::Measure;
pub use minimax::Stationarity;
pub use problem::{Problem, ProblemError};
pub use search::{Active, Method, Options, Progress, Tuned, judge, tune};
pub use stop::Stop;
pub use structure::{Schedule, Structure};
