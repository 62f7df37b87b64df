//! JSON fields: what commands print with `--json`, asked of the program itself, and what the names mean.
//!
//! The fields are those of the examples below. One that has no meaning in `json_fields.txt`, and a meaning that no field has, fail.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::{begin, code, table};

/// Commands whose document is told, with what makes it.
const EXAMPLES: [&str; 25] = [
    "poles three-mass --speed 6 --feedback composite",
    "thresholds three-mass --over 0..6",
    "trace three-mass --over 0..6 --points 5 --feedback composite --campbell",
    "modes three-mass --speed 4",
    "margin three-mass --speed 6 --feedback individual --sensitivities --box 10% --samples 100 --simulate",
    "margin rig --speed 6000 --box 10%",
    "bode three-mass --feedback individual --speed 6",
    "bode three-mass --feedback individual --over 0..6 --of unbalance",
    "assess three-mass --feedback individual --over 0..6",
    "run three-mass --feedback individual --speed 6 --duration 100",
    "runup three-mass --feedback individual --from 0 --to 6 --rate 0.1",
    "force three-mass --feedback individual --over 0..6 --points 3",
    "response three-mass --over 0..2 --points 3",
    "cycles three-mass --over 5..6 --points 3 --deadband 1 --feedback composite",
    "map three-mass --feedback individual --x speed=0..8 --y delay=0..0.3 --points 4x3",
    "map jeffcott --speed 1.6 --deadband 1 --x start.1.y=0..6 --y start.1.vy=0..3 --quantity orbit --points 2x2",
    "tune three-mass --speed 6 --starts 2",
    "tune three-mass --speed 4 --starts 2 --criteria ratio,cost",
    "assign three-mass --speed 2 --poles -0.3,0.5;-0.3,-0.5;-0.2,1;-0.2,-1;-0.2,1.4;-0.2,-1.4",
    "assign jeffcott --cancel",
    "assign three-mass --speed 2 --table",
    "rotor list",
    "rotor reduce rig --over 0..6000",
    "layout list",
    "wire",
];

/// Commands on benches, recordings and shards, and one that takes long: what they print, in words.
const OTHERS: [(&str, &str); 14] = [
    (
        "tail",
        "an object a step: `seq lost tau speed revision run_id` (hexadecimal), `masses[]` with `y z vy vz`, `force` with `y z`, `flags` in words, and every other channel under its name (`uy_commanded`, `reading_y1` ..); of an SI rotor `si` too, with `time` (s) `speed_rpm masses[]` (m, m/s) and `force` (N)",
    ),
    (
        "tail --events",
        "an object an event: `number lost event seq tau wall_ns who why text run_id`, with `revision` and `settings` after it, and what else it has, as `late missed`",
    ),
    (
        "status",
        "`benches[]`, with the numbers of its table in full, of an SI rotor `speed_rpm` and `scales` too, and `log`",
    ),
    (
        "set",
        "`accepted`; `changed revision applied_at_step substeps`, or the `reason` why not, with `min_damping` (`now`, `then`) or `orbit` (`now`, `limit`) where that is it; `accepted` is `null` where the bench did not answer",
    ),
    (
        "drill",
        "an object a change: `step` (of a drill over time) `fault` (`null`: put back) `changed revision applied_at_step`; without a fault the list of them, `name meaning at size`",
    ),
    ("note", "`seq tau` at which it stands"),
    (
        "measure",
        "`points[]`, with `measured` and `computed` (`re im amplitude phase`, in degrees) and `coherence` at each `frequency`; `peak`, `largest_difference`, `least_coherence`, and in `bent_by` what bends it",
    ),
    ("clean", "`dead_processes` (how many) and `live_benches` (names)"),
    (
        "info",
        "`file parts bytes rotor masses steps first last seconds lost settings_changes events trips alarms alarm_limits min_damping max_force max_radius snapshots checksums damage notices legs criticals` and more",
    ),
    ("export", "`out rows checksums damage notices`"),
    ("report", "`files` (how many), `figures[]` and `numbers[]`, each printed number beside ours"),
    ("rotor check", "`files[]`, with `file ok kind name masses problems`"),
    (
        "rotor show",
        "the numbers of the rotor: `name masses[] shafts[] feedback`; of one in SI units `units scales`; a drawing has no masses there",
    ),
    (
        "sweep gather",
        "`shards rows columns files`; of a search `best` (`index objective`), and with `--out` what `tune` has instead",
    ),
];

/// What names mean.
const MEANINGS: &str = include_str!("json_fields.txt");

/// The page; `run` is the program.
///
/// # Panics
/// If a field has no meaning, or a meaning no field.
pub fn page(run: &dyn Fn(&[&str]) -> Value) -> String {
    let meanings: BTreeMap<&str, &str> =
        MEANINGS.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(" = ")).collect();
    let mut used = BTreeSet::new();
    let mut out = begin(
        "JSON fields",
        "What commands print with `--json`: one document, numbers in full precision, dimensionless unless a name says otherwise (a rotor in SI units has `scales`). What is not finite or not there is \
         `null`, often with the reason in a field of the same name with `_null`. `[]` is a list, `.N` a name that depends on the machine. Fields are added, not changed. What benches and recordings print is [at the end](#the-others).",
    );
    for example in EXAMPLES {
        let words: Vec<&str> = example.split(' ').chain(["--json"]).collect();
        let mut fields = Vec::new();
        walk(&run(&words), "", &mut fields);
        out += &format!("\n## whirl {}\n\n`whirl {example} --json`\n", heading(example));
        let row = |(path, kind): (String, String)| {
            let plain = path.replace("[]", "");
            let name = meanings.keys().filter(|name| fits(&plain, name)).max_by_key(|name| name.len());
            let name =
                name.unwrap_or_else(|| panic!("json_fields.txt does not say what {path} of `whirl {example}` is"));
            used.insert(*name);
            [code(&path), kind, meanings[name].to_owned()]
        };
        table(&mut out, ["field", "type", "what it is"], fields.into_iter().map(row));
    }
    out += "\n## The others\n\nOf benches ([bench](bench.md), [protocol](protocol.md)), recordings ([damage](recordings.md#damage)) and long work:\n";
    table(&mut out, ["command", "its JSON"], OTHERS.map(|(command, what)| [code(command), what.to_owned()]));
    let unused: Vec<&&str> = meanings.keys().filter(|name| !used.contains(*name)).collect();
    assert!(unused.is_empty(), "json_fields.txt has meanings that no field has: {unused:?}");
    out
}

/// Whether a meaning is that of a path.
fn fits(path: &str, name: &str) -> bool {
    match name.strip_suffix('*') {
        Some(parent) => path.starts_with(parent),
        None => path == name || path.ends_with(&format!(".{name}")),
    }
}

/// The words of a command before its options and its rotor.
fn heading(example: &str) -> String {
    let two = example.split(' ').take(2).collect::<Vec<_>>().join(" ");
    let variant = ["--poles", "--cancel", "--table"].into_iter().find(|option| example.contains(option));
    if let Some(option) = variant.filter(|_| example.starts_with("assign")) {
        format!("assign {option}")
    } else if example.starts_with("rotor") || example.starts_with("layout") {
        two
    } else if example.contains("--criteria") {
        "tune --criteria".to_owned()
    } else if example.starts_with("margin rig") {
        "margin, of a drawing".to_owned()
    } else if example.contains("--of unbalance") {
        "bode --of unbalance".to_owned()
    } else {
        example.split(' ').next().unwrap_or_default().to_owned()
    }
}

/// The paths of what is in a value that has no fields of its own, with their types, in order.
fn walk(value: &Value, path: &str, fields: &mut Vec<(String, String)>) {
    match value {
        // Names that depend on the machine, as those of parameters or quantiles, are one field.
        Value::Object(map) if map.keys().all(|key| key.contains('.')) && !map.is_empty() => {
            map.values().for_each(|value| walk(value, &format!("{path}.N"), fields));
        }
        Value::Object(map) => {
            for (key, value) in map {
                walk(value, &if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, fields);
            }
        }
        Value::Array(list) if !list.is_empty() => list.iter().for_each(|item| walk(item, &format!("{path}[]"), fields)),
        _ => {
            let kind = match value {
                Value::Null => "null",
                Value::Bool(_) => "true or false",
                Value::Number(_) => "number",
                Value::String(_) => "text",
                Value::Array(_) | Value::Object(_) => "list",
            };
            match fields.iter_mut().find(|(known, _)| known == path) {
                // Of several, as a number that is null in places.
                Some((_, kinds)) if !kinds.split(", ").any(|known| known == kind) => *kinds += &format!(", {kind}"),
                Some(_) => {}
                None => fields.push((path.to_owned(), kind.to_owned())),
            }
        }
    }
}
