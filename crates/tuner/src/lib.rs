//! Gain search: the gains that damp the worst mode best, over a whole family of operating conditions, and how good they are.
//!
//! The report's gains came from Powell's method, one speed at a time. Its objective, the smallest of several damping ratios,
//! has kinks where the least damped mode changes, and Powell's method stops at them. Here:
//!
//! * a [`Problem`] asks about a [`Family`] of conditions (speeds, deadband states, delays, boxes of parameters) and a
//!   [`Structure`] (bearings, signals, gains fixed or scheduled over speed, [`Corner`]s of filters), with a [`Measure`], a bound on gains, and limits of
//!   the control force, of the peak of the sensitivity and of the delay margin;
//! * [`tune()`] climbs from many random starts, each by smoothing ([`smooth`]) and by sequential convex steps on the modes
//!   that matter ([`minimax`]), also where poles merge ([`rows`]); adds the conditions that turn out to be worst
//!   ([`conditions`]); proves the worst over the whole family ([`Certificate`]); and says how near a local optimum it is
//!   ([`Stationarity`]). The same seed gives the same answer, whatever the number of threads;
//! * [`climb_from`] does one start alone and [`finish()`] what comes after all of them, where starts are shared out;
//! * [`track()`] follows gains over speed, [`pareto()`] trades damping for force or gain, [`rank()`] compares places for
//!   bearing and sensors.
//!
//! ```
//! use rotor::builtin;
//! use tuner::{Family, Options, Problem, Schedule, Stop, Structure, tune};
//!
//! let rotor = builtin::rotor("three-mass").ok_or("built in")?;
//! // Bearing at mass 1, sensors at masses 1 and 2, one set of gains of at most 5 for R = 4.
//! let structure = Structure::new(&rotor, &Structure::composite(3, 0, &[0, 1]), Schedule::Fixed)?;
//! let problem = Problem::new(Family::new(&rotor, 4.0, 4.0)?, structure, 5.0);
//! let found = tune(&problem, &Options::for_problem(&problem), &|_| (), Stop::NEVER)?;
//! assert!((found.worst.value - 0.065409).abs() < 1e-5 && found.worst.proven);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Pure but for a thread pool: no files, no terminal.

mod answers;
mod around;
mod certify;
mod conditions;
mod corners;
mod cost;
mod delay;
mod evaluate;
mod exchange;
mod family;
mod finish;
mod force;
mod least_norm;
mod limits;
mod loci;
mod measure;
mod minimax;
mod opened;
mod operating;
mod options;
mod pareto;
mod placement;
mod powell;
mod problem;
mod proven_peak;
mod quadratic_program;
mod rows;
mod search;
mod smooth;
mod stop;
mod structure;
mod track;
mod tuned;
mod worst;

pub use certify::Certificate;
pub use corners::Corner;
pub use cost::Cost;
pub use family::{Family, FamilyAxis, FamilyError, FamilyQuantity};
pub use measure::{Measure, Region};
pub use minimax::Stationarity;
pub use opened::LoopMargins;
pub use options::{Method, Options};
pub use pareto::{ParetoPoint, Price, WIDEST_PEAK, pareto};
pub use placement::{Placement, PlacementProblem, choices, rank};
pub use problem::{Problem, ProblemError};
pub use search::{Climbed, best_start, bound, climb_from, evaluate, finish, tune};
pub use stop::Stop;
pub use structure::{Schedule, Structure};
pub use track::{Tracked, track};
pub use tuned::{Active, Progress, Tuned};
