//! From a command line to the command that carries it out.

use crate::cli::{Cli, Command};
use crate::commands::{
    assess, assign, bode, clean, config, control, cycles, dash, drill, export, force, help, info, layout, map, margin,
    measure, modes, note, poles, record, replay, report, response, rotor, run, runup, set, sim, status, sweep, tail,
    thresholds, trace, tune, up, wire,
};
use crate::failure::Failure;

/// Carries out a command line.
///
/// # Errors
/// Whatever the command fails with.
pub(crate) fn run(cli: Cli) -> Result<(), Failure> {
    match cli.command() {
        Command::Up(args) => up::run(&args),
        Command::Sim(args) => sim::run(&args),
        Command::Dash(args) => dash::run(&args),
        Command::Config(args) => config::run(&args),
        Command::Layout(args) => layout::run(&args),
        Command::Record(args) => record::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Tail(args) => tail::run(&args),
        Command::Set(args) => set::run(&args),
        Command::Drill(args) => drill::run(&args),
        Command::Note(args) => note::run(&args),
        Command::Status(args) => status::run(&args),
        Command::Wire(args) => wire::run(&args),
        Command::Control(args) => control::run(&args),
        Command::Clean(args) => clean::run(&args),
        Command::Poles(args) => poles::run(&args),
        Command::Trace(args) => trace::run(&args),
        Command::Thresholds(args) => thresholds::run(&args),
        Command::Modes(args) => modes::run(&args),
        Command::Margin(args) => margin::run(&args),
        Command::Measure(args) => measure::run(&args),
        Command::Assess(args) => assess::run(&args),
        Command::Bode(args) => bode::run(&args),
        Command::Run(args) => run::run(&args),
        Command::Runup(args) => runup::run(&args),
        Command::Force(args) => force::run(&args),
        Command::Response(args) => response::run(&args),
        Command::Cycles(args) => cycles::run(&args),
        Command::Map(args) => map::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Tune(args) => tune::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Assign(args) => assign::run(&args),
        Command::Rotor(args) => rotor::run(&args),
        Command::Help(args) => help::run(&args),
    }
}
