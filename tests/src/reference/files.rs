//! The keys of files. Which ones a table knows is asked of the readers themselves: an unknown key is answered with all that are known.

use control::{FILTERS, PARTS, STATE_SPACE, TRANSFER_FUNCTIONS};
use rotor::{FIELDS, builtin, file};
use text::Faults;

use super::{begin, code, number, table};

/// A key that no table knows.
const UNKNOWN: &str = "not_a_key = 1";

/// A chain that is right, up to its last table.
const CHAIN: &str = "[[mass]]\nmass = 1\nbearing_stiffness = 1\n[[mass]]\nmass = 1\n[[shaft]]\nstiffness = 1\n";
/// A drawing that is right.
const DRAWING: &str = "name = \"a\"\nunits = \"si\"\n[material.steel]\ndensity = 7810\nyoungs_modulus = 211e9\npoisson = 0.3\n[[section]]\nlength = 1\nouter = 0.1\n\
                       elements = 4\nmaterial = \"steel\"\n[[bearing]]\nstation = 1\nstiffness = 1e6\n[[bearing]]\nstation = 2\nstiffness = 1e6\n";
/// Feedback that is right.
const FEEDBACK: &str = "bearing = 1\n[[signal]]\nmass = 1\nkd = 1\n";

/// Every file and its tables.
pub(super) fn page() -> String {
    let mut out = begin(
        "Keys of files",
        "Every table of every file that you write, with the keys that its reader knows. What they mean is in [files that you write](files.md); layouts and the configuration are \
         in [the console](console.md#layouts). A key that is none of these is refused, with what was probably meant.",
    );
    out += "\n## Rotors: a chain of masses\n";
    let rotor = |text: &str| file::read_rotor(text, "a").err();
    tables(
        &mut out,
        &rotor,
        &[
            ("at the top", UNKNOWN, CHAIN),
            ("`[[mass]]`", "", &format!("[[mass]]\n{UNKNOWN}\n{CHAIN}")),
            ("`[[shaft]]`", CHAIN, UNKNOWN),
        ],
    );
    out += "\nThe parameters of a mass:\n";
    let row = |field: &rotor::Field| {
        [
            code(field.name),
            field.meaning.to_owned(),
            field.ratio.to_owned(),
            format!("{} in {}", field.symbol, field.unit),
        ]
    };
    table(&mut out, ["key", "what it is", "dimensionless", "in SI units"], FIELDS.iter().map(row));
    out += "\n## Rotors: a drawing\n";
    let more = |heading: &str| (format!("`{heading}`"), format!("{DRAWING}{heading}\n{UNKNOWN}\n"));
    let tables_of_drawing = [
        "[material.other]",
        "[[section]]",
        "[[sleeve]]",
        "[[disc]]",
        "[[point_mass]]",
        "[[pedestal]]",
        "[[bearing]]",
        "[[seal]]",
        "[[magnetic]]",
        "[[sensor]]",
        "[[unbalance]]",
    ]
    .map(more);
    let mut all: Vec<(&str, &str, &str)> = vec![("at the top", UNKNOWN, DRAWING)];
    all.extend(tables_of_drawing.iter().map(|(name, text)| (name.as_str(), text.as_str(), "")));
    let plant = format!("name = \"a\"\nunits = \"si\"\n[plant]\n{UNKNOWN}\n");
    all.push(("`[plant]`", &plant, ""));
    tables(&mut out, &rotor, &all);
    out += "\n## Feedback\n";
    let three = builtin::rotor("three-mass").expect("it is built in");
    let feedback = |text: &str| file::read_feedback_for(text, &three).err();
    let several = "[[bearing]]\nname = \"a\"\nmass = 1\n[[bearing.signal]]\nmass = 1\nkd = 1\n";
    let bearing = format!("[[bearing]]\n{UNKNOWN}\nmass = 1\n[[bearing.signal]]\nmass = 1\nkd = 1\n");
    let of_loop = format!("{FEEDBACK}[loop]\n{UNKNOWN}\n");
    tables(
        &mut out,
        &feedback,
        &[
            ("at the top, one control bearing", UNKNOWN, FEEDBACK),
            ("at the top, several", UNKNOWN, several),
            ("`[[bearing]]`", &bearing, ""),
            ("`[[signal]]`, `[[bearing.signal]]`", FEEDBACK, UNKNOWN),
            ("`[loop]`, `[bearing.loop]`", &of_loop, ""),
        ],
    );
    out += "\nFor a rotor of shaft elements a place is a `station`, and no `mass`:\n";
    let rig = builtin::rotor("rig").expect("it is built in");
    let of_shafts = |text: &str| file::read_feedback_for(text, &rig).err();
    let signal = "[[bearing.signal]]\nstation = \"left\"\nkd = 1\n";
    let bearing = format!("[[bearing]]\n{UNKNOWN}\nname = \"left\"\n{signal}");
    let before = format!("[[bearing]]\nname = \"left\"\n{signal}");
    tables(
        &mut out,
        &of_shafts,
        &[("`[[bearing]]`", &bearing, ""), ("`[[signal]]`, `[[bearing.signal]]`", &before, UNKNOWN)],
    );
    out += "\nA gain is a number, `{ at_zero = A, slope = B }` or `{ speed = [..], value = [..] }`. Filters, in `filter = [{ kind = .. }]` of a signal or of the sum:\n";
    let row = |((kind, keys), transfers): (&(&str, &[&str]), &str)| {
        [code(kind), keys.iter().map(|key| code(key)).collect::<Vec<_>>().join(", "), code(transfers)]
    };
    table(
        &mut out,
        ["kind", "keys", "what it is, in s = d/dtau"],
        FILTERS.iter().chain([&STATE_SPACE]).zip(TRANSFER_FUNCTIONS).map(row),
    );
    out += "\nThe parts of a loop, in files and as [settings](settings.md):\n";
    let absent = |value: f64| if value.is_finite() { number(value) } else { "none".to_owned() };
    let row = |part: &control::Part| {
        [
            code(part.name),
            part.meaning.to_owned(),
            format!("{} to {}", number(part.min), number(part.max)),
            absent(part.absent),
        ]
    };
    table(&mut out, ["key", "what it is", "range", "absent"], PARTS.iter().map(row));
    out += "\n## Profiles of speed\n";
    let profile = |text: &str| file::read_profile(text, &three).err();
    tables(
        &mut out,
        &profile,
        &[
            ("at the top", UNKNOWN, "[[leg]]\nto = 1\nrate = 0.1\n"),
            ("`[[leg]]`", "[[leg]]\nto = 1\nrate = 0.1\n", UNKNOWN),
        ],
    );
    out += "\n## Drills over time\n";
    let drill = |text: &str| telemetry::drill::read_drill(text).err();
    let step = "[[step]]\nat = 0\nfault = \"sensor-lost\"\n";
    tables(&mut out, &drill, &[("at the top", UNKNOWN, step), ("`[[step]]`", step, UNKNOWN)]);
    out += "\n[Drills](bench.md#drills) have an example.\n\n## Sweeps\n\nThe document of `whirl sweep plan` has one key, `run`: the command line of \
            a `map`, of a `margin` with `--samples`, or of a `tune`, [as here](sweep-on-a-cluster.md).\n";
    out += "\n## Layouts\n";
    let layout = |text: &str| dashboard::Layout::read("a", text).err();
    tables(&mut out, &layout, &[("at the top", UNKNOWN, ""), ("`[[screen]]`", "[[screen]]\n", UNKNOWN)]);
    out += "\n## The configuration\n";
    let config = |text: &str| dashboard::Config::read(text).err();
    tables(&mut out, &config, &[("at the top", UNKNOWN, ""), ("`[alarms]`", "[alarms]\n", UNKNOWN)]);
    out += "\n`[keys]` has a key of the keyboard in quotes for each typed command: [keys](keys.md).\n\n## What standards ask\n\n`whirl assess --print-limits` prints these as a file:\n";
    let row = |limit: &study::assess::Limit| {
        [code(limit.key), number(limit.value), limit.what.to_owned(), limit.source.to_owned()]
    };
    table(&mut out, ["key", "value", "what it is", "from"], study::assess::LIMITS.iter().map(row));
    out
}

/// Tables of a file: its name, and a text before and behind which make up a file with one key that the table does not know.
fn tables(out: &mut String, read: &dyn Fn(&str) -> Option<Faults>, all: &[(&str, &str, &str)]) {
    let row = |&(name, before, behind): &(&str, &str, &str)| {
        let faults = read(&format!("{before}\n{behind}\n")).expect("an unknown key is a fault").in_file("");
        let known = faults
            .lines()
            .find_map(|line| line.split_once("unknown key 'not_a_key': expected ")?.1.split(';').next())
            .unwrap_or_else(|| panic!("{name}: {faults}"));
        let keys: Vec<String> = known.trim_start_matches("one of ").split(", ").map(code).collect();
        [name.to_owned(), keys.join(", ")]
    };
    table(out, ["table", "its keys"], all.iter().map(row));
}
