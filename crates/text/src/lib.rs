//! What people write and what they read: TOML files of their own, what they type, and numbers shown to them.
//!
//! Text in, text out: no files are opened here, and nothing is known of rotors.
//!
//! * [`Reader`]: reads the tables of a TOML file, and collects everything that is wrong with it.
//! * [`Fault`], [`Faults`]: what is wrong, where, and what should be there; [`Faults::drawn`] with the lines concerned.
//! * [`Domain`]: which numbers are allowed where one is read.
//! * [`number`]: numbers as people read them. [`amount`]: durations and sizes as typed. [`Lines`]: TOML written with comments.
//!
//! ```
//! use text::{Domain, Reader};
//!
//! fn mass(file: &str) -> Result<f64, text::Faults> {
//!     let (mut reader, table) = Reader::parse(file)?;
//!     reader.only(&table, &["mass"]);
//!     let mass = reader.required(&table, ("the file", 0..0), "mass", Domain::Positive);
//!     reader.finish(mass)
//! }
//! assert_eq!(mass("mass = 2.5"), Ok(2.5));
//! let faults = mass("mas = 2.5\nmass = -1").unwrap_err();
//! assert_eq!(
//!     faults.in_file("a.toml"),
//!     "a.toml:1:1: unknown key 'mas': expected mass; did you mean 'mass'?\n\
//!      a.toml:2:8: mass = -1: expected a finite number greater than 0"
//! );
//! ```

pub mod amount;
mod domain;
mod drawn;
mod fault;
mod lines;
pub mod number;
mod reader;

pub use domain::Domain;
pub use fault::{Fault, Faults, MAX_BYTES, utf8};
pub use lines::{Lines, numbers, string};
pub use reader::{Key, Reader, Table, Value, as_number, meant, nearest};
