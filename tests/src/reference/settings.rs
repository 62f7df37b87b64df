//! What can be changed on a running machine, and what is watched.

use alarms::{Limits, Watch};
use rotor::{PARAMETERS, Parameter, Scope, builtin};

use super::{begin, code, number, table};

/// Every setting.
pub(super) fn page() -> String {
    let mut out = begin(
        "Settings",
        "What `whirl set`, `:` in the console, `--set` of every offline command but `force` and `assign` and the settings panel take, as `KEY=VALUE`. Ranges and units are those of a \
         dimensionless rotor; a rotor in SI units has the unit behind. Live, a change is all of its keys or none, and is in force from one step on.",
    );
    let scales =
        *builtin::rotor("rig").and_then(|rotor| rotor.scales().copied().map(Box::new)).expect("the rig is in SI units");
    let row = |row: &Parameter| {
        let off = row.off.map_or_else(String::new, |_| ", or `off`".to_owned());
        [
            code(row.name),
            row.meaning.to_owned(),
            format!("{} to {}{off}", number(row.min), number(row.max)),
            row.unit().to_owned(),
            row.dimension.si(&scales, 1.0).name.to_owned(),
            of_what(row.scope).to_owned(),
            number(row.step),
        ]
    };
    table(
        &mut out,
        ["key", "what it is", "range", "unit", "SI", "one for each", "step of a key"],
        PARAMETERS.iter().map(row),
    );
    out += "\n* `feedback=NAME` or `feedback=FILE` replaces the whole feedback, `feedback=off` takes it away.\n\
            * **Each mass**: `deadband` is that of all, `deadband.2` of mass 2.\n\
            * **Each signal**: `kd` is of the first, `kd.2` of the second; of several control bearings `left.kd`, `left.kd.2`, by the bearing's name. A gain is one \
            number where it is set; schedules over speed stand in [feedback files](files.md#feedback).\n\
            * **Each control bearing**: `limit` is that of all, `left.limit` of one; `sample` and `delay` are the same at each.\n\
            * A value of a rotor in SI units may say what it is counted in, `speed=50Hz`, `kd=2e5N/m`; alone it is in the unit of the table, in the console in \
            micrometres where that shows them. Feedback files count gains as they say.\n\
            * Offline a number of the loop may be of any command but those two: `whirl poles three-mass --set delay=0.05`. `ramp`, `trip`, `coast_down`, `unbalance_added` and the controller outside are of a \
            live bench alone, and refused where they would do nothing.\n";
    out
}

fn of_what(scope: Scope) -> &'static str {
    match scope {
        Scope::Machine => "",
        Scope::Mass => "mass",
        Scope::Signal => "signal",
        Scope::Bearing => "control bearing",
    }
}

/// What is watched, and from where on it is an alarm.
pub(super) fn alarms() -> String {
    let mut out = begin(
        "Alarms",
        "What consoles and recorders watch, with the limits that hold without a configuration file. [The console](console.md#alarms) tells how they show and what they can do.",
    );
    let limits = Limits::default();
    let row = |watch: Watch| {
        let limit = limits.of(watch);
        let told = |value: Option<f64>| match value {
            _ if watch == Watch::Trip => "any".to_owned(),
            _ if limits.follows(watch) => "follows the machine".to_owned(),
            Some(value) if watch.is_bad_below() => format!("at or below {}", number(value)),
            Some(value) => format!("above {}", number(value)),
            None => "off".to_owned(),
        };
        let margin = limit.filter(|_| watch != Watch::Trip).map_or_else(String::new, |limit| number(limit.margin));
        [
            code(watch.name()),
            watch.meaning().to_owned(),
            told(limit.map(|limit| limit.warning)),
            told(limit.map(|limit| limit.alarm)),
            margin,
        ]
    };
    table(&mut out, ["alarm", "its value", "warning", "alarm", "over when back by"], Watch::ALL.map(row));
    out += "\nThe section `[alarms]` of the configuration file (`whirl config path`) changes them: `damping = [0.05, 0.01]` is a warning and an alarm, `\"off\"` \
            takes one away, and `orbit = \"machine\"` (so also `force`) follows clearances, trip and actuator. `:alarm force 2 4` does so on a console that runs. \
            `bell = true` rings the terminal's bell. `run-up` says what an alarm does to a speed that rises: ";
    out += &dashboard::OnAlarm::ALL.map(|(name, _)| format!("`\"{name}\"`")).join(", ");
    out += ".\n";
    out
}
