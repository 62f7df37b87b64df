//! The command line, as clap sees it. These doc comments are what `--help` prints.

use clap::{Args, Parser, Subcommand};

use crate::commands;

/// A terminal workbench for stabilising rotors with magnetic bearings.
///
/// Without a command, `whirl` starts a simulation of the three-mass rotor and a dashboard on it.
#[derive(Debug, Parser)]
#[command(name = "whirl", version, disable_help_subcommand = true)]
pub(crate) struct Cli {
    /// What to do; `up` if nothing is said
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// Every command, in the order in which `--help` lists them.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Print eigenvalues and minimum damping at one speed
    Poles(commands::poles::PolesArgs),
    /// Simulate offline, as fast as it goes
    Run(commands::run::RunArgs),
    /// Print the largest steady control force over speed
    Force(commands::force::ForceArgs),
    /// Print the exact synchronous response, all branches
    Response(commands::response::ResponseArgs),
    /// Print the exact self-excited limit cycles, all branches
    Cycles(commands::cycles::CyclesArgs),
}

/// Which machine: the options that every command on a rotor shares.
#[derive(Clone, Debug, Args)]
pub(crate) struct MachineArgs {
    /// The rotor: jeffcott or three-mass
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    pub rotor: String,
    /// The feedback: off; cancel (jeffcott); composite, individual (three-mass)
    #[arg(long, value_name = "NAME")]
    pub feedback: Option<String>,
    /// Clearance of every support bearing, in e_t
    #[arg(long, value_name = "G", allow_negative_numbers = true)]
    pub deadband: Option<f64>,
}
