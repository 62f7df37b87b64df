//! Rotors and feedback as files: what is written reads back, SI agrees with the report, and no text makes a panic.

mod any;
mod meaning;
mod read_back;
mod si_units;
mod table_4_2;
