//! A rotor as a drawing: sections of shaft, discs, bearings and seals in SI units, made into finite elements and into few coordinates.
//!
//! Everything is radially symmetric, so that both planes of bending are one complex number: displacement `p = x + j y` and tilt
//! `psi = beta - j alpha` at each node, forward whirl turning `x` towards `y`. At the spin speed `w`
//!
//! ```text
//! M p'' + (C + Cr - j w G) p' + (K - j (Kc + w Cr)) p = f
//! ```
//!
//! behind them one displacement for each pedestal that a bearing stands on, with real matrices that do not depend on `w`. An eigenvalue with a positive imaginary part whirls forward.
//!
//! ```
//! use beam::{Bearing, Coefficient, Disc, Drawing, Material, Section, Sketch};
//!
//! // A disc in the middle of a shaft on two bearings.
//! let steel =
//!     Material { name: "steel".into(), density: 7810.0, youngs_modulus: 211e9, shear_modulus: 81.2e9 };
//! let bearing = |station| Bearing { station, stiffness: 1e6.into(), damping: 200.0.into(), ..Bearing::default() };
//! let drawing = Drawing::new(Sketch {
//!     name: "two halves".into(),
//!     materials: vec![steel],
//!     sections: vec![Section { elements: 3, ..Section::cylinder(0.75, 0.05) }; 2],
//!     discs: vec![Disc { station: 1, mass: 32.6, polar_inertia: 0.33, diametral_inertia: 0.178 }],
//!     bearings: vec![bearing(0), bearing(2)],
//!     ..Sketch::default()
//! })?;
//!
//! let full = drawing.full();
//! let poles = full.eigenvalues(400.0)?;
//! assert_eq!(poles.len(), 2 * 2 * 7, "two coordinates a node, two eigenvalues a coordinate");
//! assert!(poles.iter().all(|pole| pole.re < 0.0), "its bearings damp it");
//!
//! // Eight displacements stand for all of it.
//! let reduced = full.reduce(&drawing, 8)?;
//! assert_eq!(reduced.coordinates(), 8);
//! let lost = beam::lost(&full, &reduced, &[0.0, 400.0], 1500.0)?;
//! assert!(lost.worst_frequency() < 1e-3, "{lost:?}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`Sketch`], [`Drawing`]: what there is, before and after it has been checked; [`read()`] and [`write()`] as a file.
//! * [`Matrices`]: a rotor as another program has it, in place of a shaft; [`read_matrices`] from its files.
//! * [`FullModel`]: the matrices of all elements, with what holds the rotor listed beside ([`Spring`]).
//! * [`Reduced`]: few coordinates, each the displacement of a place; [`lost`] says what that costs.
//! * [`import_ross`]: the files of ROSS.
//!
//! Text in, values out: no files, no terminal, no loop and no motion.

mod assemble;
mod check;
mod coefficient;
mod drawing;
mod element;
mod file;
mod free;
mod lost;
mod matrices;
mod model;
mod modes;
mod pedestal;
mod poles;
mod reduce;
mod ross;
mod select;
mod unbalance;

pub use check::{DrawingError, DrawingFault};
pub use coefficient::Coefficient;
pub use drawing::{
    Amount, Bearing, Coupling, Disc, Drawing, ImportedController, Magnetic, Material, Pedestal, PointMass, Section,
    Sensor, Shear, Sketch, Sleeve, Unbalance,
};
pub use file::{Also, Open, is_drawing, read, read_and, write, write_and};
pub use linear::C64;
pub use lost::{Lost, LostError, LostPole, lost};
pub use matrices::{Matrices, MatrixError, read_matrices};
pub use model::{FullModel, Place, Spring, SpringPart};
pub use poles::PoleError;
pub use reduce::{Reduced, ReductionError};
pub use ross::{Note, import_ross};

/// The most elements of a shaft.
pub const MAX_ELEMENTS: usize = 256;

/// The most coordinates of a rotor that is given as matrices.
pub const MAX_ROWS: usize = 128;

/// The most pedestals of a rotor.
pub const MAX_PEDESTALS: usize = 8;

/// The most coordinates that a rotor is reduced to.
pub const MAX_COORDINATES: usize = 16;

/// The most bytes of a rotor's name.
pub const MAX_NAME: usize = 64;
