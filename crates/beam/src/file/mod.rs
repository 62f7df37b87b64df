//! A drawing as a file of its own. Text in, text out; opening files is the caller's.
//!
//! Everything is in SI units, but speeds are in rpm, angles in degrees and unbalances in g mm, as drawings have them. Stations are
//! counted from 1, from left to right: station 1 is the left end of the first `[[section]]`, and every section ends at the next. Unknown keys
//! are errors, because a misspelt key would otherwise be a parameter silently at its default.
//!
//! | table | keys |
//! |---|---|
//! | at the top | `name`, `units = "si"`, `reference_length`, `coordinates`, `mass_damping`, `stiffness_damping` |
//! | `[material.NAME]` | `density`, `youngs_modulus`, and `shear_modulus` or `poisson` |
//! | `[plant]` | in place of materials, sections and discs: `stations`, `positions`, `names`, and `mass`, `damping`, `gyroscopic`, `stiffness`, `cross_stiffness` as rows, or `matrices` |
//! | `[[section]]` | `length`, and `coupling` alone, or `outer`, `inner`, `outer_right`, `inner_right`, `elements`, `material`, and what [`Section`](crate::Section) has |
//! | `[[sleeve]]` | `section`, and the keys of a section but its length and elements |
//! | `[[disc]]` | `station`, and `mass`, `polar_inertia`, `diametral_inertia`, or `outer`, `inner`, `width`, `material` |
//! | `[[point_mass]]` | `station`, `mass` |
//! | `[[bearing]]`, `[[seal]]` | `station`, `stiffness`, `damping`, `cross_stiffness`, `cross_damping`, `mass`, and of a bearing `clearance`, `pedestal` |
//! | `[[pedestal]]` | `mass`, `stiffness`, `damping`, `cross_stiffness`; a bearing stands on it by `pedestal`, its number |
//! | `[[magnetic]]` | `name`, `station`, `sensor`, `force_per_current`, `negative_stiffness`, `clearance`, `touchdown_stiffness`, `controller` |
//! | `[[sensor]]` | `name`, `station` |
//! | `[[unbalance]]` | `station`, `angle`, and `gmm`, or `mass` and `radius`, or `grade` and perhaps `speed` |
//!
//! The matrices of a [`plant`](crate::Matrices) are those of another program; `stations` says which of its coordinates, counted from 1 or by their
//! names, are displacements. `matrices` names files that hold them, which the caller opens ([`Also::open`]); they are written out when the
//! drawing is.
//!
//! A coefficient of a bearing is a number or `{ speed = [..], value = [..] }`.

mod parts;
mod plant;
mod read;
mod shaft;
mod write;

pub use read::{Also, Open, is_drawing, read, read_and};
pub use write::{write, write_and};
