//! Which machine: the words that every command on a rotor shares.

use clap::Args;

/// Which machine: the options that every command on a rotor shares.
#[derive(Clone, Debug, Args)]
pub(crate) struct MachineArgs {
    /// The rotor: jeffcott, three-mass, or a TOML file
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    pub rotor: String,
    /// The feedback: off; cancel (jeffcott); composite, individual (three-mass); or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub feedback: Option<String>,
    /// Clearance of every support bearing, in e_t (SI rotors: in m)
    #[arg(long, value_name = "G", allow_negative_numbers = true)]
    pub deadband: Option<f64>,
}
