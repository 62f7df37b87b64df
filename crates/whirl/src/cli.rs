//! The command line, as clap sees it. These doc comments are what `--help` prints.

use clap::{Parser, Subcommand};

use crate::commands;

/// A terminal workbench for stabilising rotors with magnetic bearings.
///
/// Without a command, `whirl` starts a simulation of the three-mass rotor and a dashboard on it.
#[derive(Debug, Parser)]
#[command(name = "whirl", bin_name = "whirl", version, disable_help_subcommand = true)]
pub(crate) struct Cli {
    /// What to do; `up` if nothing is said
    #[command(subcommand)]
    command: Option<Command>,
}

impl Cli {
    /// What to do.
    pub(crate) fn command(self) -> Command {
        self.command.unwrap_or_else(|| Self::parse_from(["whirl", "up"]).command.expect("`up` is a command"))
    }
}

/// Every command, in the order in which `--help` lists them.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Start a simulation and a dashboard on it; quitting the dashboard ends both
    Up(commands::up::UpArgs),
    /// Run the simulation process alone
    Sim(commands::sim::SimArgs),
    /// Show a dashboard on a running simulation
    Dash(commands::dash::DashArgs),
    /// Record a running simulation in a file, every step
    Record(commands::record::RecordArgs),
    /// Play a recording in the dashboard, and run on from any moment of it with other gains
    Replay(commands::replay::ReplayArgs),
    /// Tell what a recording holds: length, rates, changes, losses, trips, alarms, extremes
    Info(commands::info::InfoArgs),
    /// Make a table of a recording, as CSV or Parquet
    Export(commands::export::ExportArgs),
    /// Print live telemetry, or what happens
    Tail(commands::tail::TailArgs),
    /// List the layouts of the dashboard, show one as a file, or check files
    Layout(commands::layout::LayoutArgs),
    /// Say where the configuration is, what it says, and what holds without one
    Config(commands::config::ConfigArgs),
    /// Change gains, speed, deadband ... of a running simulation
    Set(commands::set::SetArgs),
    /// Hold a drill: one fault at a time on a running simulation, and back
    Drill(commands::drill::DrillArgs),
    /// Mark the present step of a running simulation with a note
    Note(commands::note::NoteArgs),
    /// List running benches: rates, lateness, losses, who is attached
    Status(commands::status::StatusArgs),
    /// Let any program control a running simulation, by its standard input and output
    Control(commands::control::ControlArgs),
    /// Say how another program finds and reads a bench: root, services, types, units
    Wire(commands::wire::WireArgs),
    /// Remove what crashed processes left behind; never touches a live bench
    Clean(commands::clean::CleanArgs),
    /// Print eigenvalues and minimum damping at one speed
    Poles(commands::poles::PolesArgs),
    /// Print every pole as a branch over speed, or the Campbell diagram
    Trace(commands::trace::TraceArgs),
    /// Print every speed at which a mode changes stability
    ///
    /// A threshold is a speed at which a mode leaves zero growth, as speed rises, for a side other than the one it came from.
    /// A mode that rested on zero over a range came from neither side, so the end of that range is a threshold, and so is
    /// R = 0 for a mode that leaves zero there. A mode that touches zero, comes to it and stays, or is on it at every speed
    /// has none. The range asked for has no say in this.
    Thresholds(commands::thresholds::ThresholdsArgs),
    /// Print mode shapes and orbits at one speed
    Modes(commands::modes::ModesArgs),
    /// Print margins of delay, gain and phase, and peaks of sensitivity
    Margin(commands::margin::MarginArgs),
    /// Measure the sensitivity of a running simulation's loop, beside the computed one
    Measure(commands::measure::MeasureArgs),
    /// Print frequency responses, and the response to unbalance
    Bode(commands::bode::BodeArgs),
    /// Print what standards ask of a machine, line by line: found, asked, passed or not
    Assess(commands::assess::AssessArgs),
    /// Simulate offline, as fast as it can
    Run(commands::run::RunArgs),
    /// Run up or coast down through the critical speeds, offline
    Runup(commands::runup::RunupArgs),
    /// Print the largest steady control force over speed
    Force(commands::force::ForceArgs),
    /// Print the exact synchronous response, branch by branch
    Response(commands::response::ResponseArgs),
    /// Print the exact self-excited limit cycles, branch by branch
    Cycles(commands::cycles::CyclesArgs),
    /// Map a quantity over a plane of two parameters: damping, margins, orbits, forces
    Map(commands::map::MapArgs),
    /// Cut maps, samples or searches into shards for schedulers, and gather them
    Sweep(commands::sweep::SweepArgs),
    /// Search the gains that damp the worst mode best, over speeds and deadband states
    Tune(Box<commands::tune::TuneArgs>),
    /// Make the NASA report again: every figure, and every printed number beside ours
    Report(commands::report::ReportArgs),
    /// Make feedback that assigns poles, or show which modes each bearing and sensor reaches
    Assign(commands::assign::AssignArgs),
    /// List the built-in rotors, show one as a file, or check files
    Rotor(commands::rotor::RotorArgs),
    /// Show a page of the book, or what a command takes
    Help(commands::help::HelpArgs),
}
