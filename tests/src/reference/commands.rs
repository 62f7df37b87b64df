//! Commands and exit codes.

use clap::{Arg, Command};

use super::{begin, code, table};

/// Every command with its options.
pub(super) fn page() -> String {
    let mut program = whirl::command();
    program.build();
    let mut out = begin(
        "Commands",
        "Every command with everything that it takes, as `whirl COMMAND --help` and `whirl help COMMAND` tell it. `whirl` without a command is `whirl up`. \
         What commands print: [JSON](json.md); how they end: [exit codes](exit-codes.md).",
    );
    let of_each: Vec<&Command> = program.get_subcommands().filter(|command| !command.is_hide_set()).collect();
    table(
        &mut out,
        ["command", "what it does"],
        of_each.iter().map(|command| {
            let name = command.get_name();
            [format!("[`{name}`](#whirl-{name})"), about(command)]
        }),
    );
    of_each.into_iter().for_each(|command| tell(&mut out, command, 2));
    out
}

fn about(command: &Command) -> String {
    command.get_about().map(ToString::to_string).unwrap_or_default()
}

fn tell(out: &mut String, command: &Command, depth: usize) {
    let mut command = command.clone();
    let usage = command.render_usage().to_string();
    let told = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
    let name = command.get_bin_name().unwrap_or_else(|| command.get_name());
    *out += &format!("\n{} {name}\n\n{}\n", "#".repeat(depth), as_sentence(&told));
    *out += &format!("\n```text\n{}\n```\n", usage.trim_start_matches("Usage: "));
    let arguments: Vec<&Arg> =
        command.get_arguments().filter(|arg| !arg.is_hide_set() && arg.get_id() != "help").collect();
    if !arguments.is_empty() {
        table(out, ["option", "what it is", "if absent"], arguments.into_iter().map(row));
    }
    for below in command.get_subcommands().filter(|below| below.get_name() != "help") {
        tell(out, below, depth + 1);
    }
}

/// What clap tells ends without a full stop where it is one sentence.
fn as_sentence(told: &str) -> String {
    let told = told.trim();
    if told.ends_with(['.', '?', '!']) { told.to_owned() } else { format!("{told}.") }
}

fn row(arg: &Arg) -> [String; 3] {
    let values = arg.get_value_names().unwrap_or_default().join(" ");
    let takes = arg.get_action().takes_values() && !values.is_empty();
    let name = match (arg.get_short(), arg.get_long()) {
        (Some(short), Some(long)) => format!("-{short}, --{long}"),
        (None, Some(long)) => format!("--{long}"),
        (Some(short), None) => format!("-{short}"),
        (None, None) => String::new(),
    };
    let typed = match (name.is_empty(), takes) {
        (true, _) => values,
        (false, true) => format!("{name} {values}"),
        (false, false) => name,
    };
    let mut what = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    what = what.split_whitespace().collect::<Vec<_>>().join(" ");
    let possible: Vec<String> =
        arg.get_possible_values().iter().filter(|_| takes).map(|value| code(value.get_name())).collect();
    if !possible.is_empty() && !arg.is_hide_possible_values_set() {
        what += &format!(": {}", possible.join(", "));
    }
    let defaults = arg.get_default_values().iter().map(|value| code(&value.to_string_lossy())).collect::<Vec<_>>();
    let absent = match (takes, arg.is_required_set()) {
        (_, true) => "required".to_owned(),
        (true, false) => defaults.join(" "),
        (false, false) => String::new(),
    };
    [code(&typed), what, absent]
}

/// Exit codes, and what of the surroundings counts.
pub(super) fn exit_codes() -> String {
    let mut out = begin(
        "Exit codes and environment",
        "What a script can rely on. Results go to stdout, everything else to stderr; a pipe whose reader has gone, as `head` does, is no failure.",
    );
    table(
        &mut out,
        ["exit code", "what it means"],
        whirl::EXIT_CODES.iter().map(|(number, meaning)| [number.to_string(), (*meaning).to_owned()]),
    );
    out += "\nNo command overwrites a file: one that is there already is refused before anything is done, with exit code 2, and replaced with `--force`. Of a \
            file that is wrong every fault is told, a line each: `FILE:LINE:COLUMN: what was found: expected what`.\n\n## Environment\n";
    table(
        &mut out,
        ["variable", "what it does"],
        whirl::ENVIRONMENT.iter().map(|(name, meaning)| [code(name), (*meaning).to_owned()]),
    );
    out += "\n`whirl config path` prints where the configuration, layouts, gains and commands of yours are.\n";
    out
}
