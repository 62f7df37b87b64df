//! Drills as files: named steps at their times, each a fault, which takes the place of the one before.

use text::{Domain, Faults, Reader};

use super::{DrillError, Fault, FaultOrder};

/// Steps of a drill at most.
const MOST_STEPS: usize = 100;

/// The drills that are built in: a name, and the file.
pub const BUILTIN: [(&str, &str); 2] = [
    ("fading-sensor", include_str!("../../drills/fading-sensor.toml")),
    ("weak-amplifier", include_str!("../../drills/weak-amplifier.toml")),
];

/// What happens in a step.
#[derive(Clone, Debug, PartialEq)]
pub struct DrillStep {
    /// What it is called.
    pub name: String,
    /// When, in seconds after the drill began.
    pub at: f64,
    /// The fault; nothing where the one before ends.
    pub fault: Option<FaultOrder>,
}

/// A row of faults over time, one at a time. At its end nothing of them is left.
#[derive(Clone, Debug, PartialEq)]
pub struct Drill {
    /// What it is called.
    pub name: String,
    /// What it is for, in a few words; may be empty.
    pub about: String,
    /// Its steps, in the order of their times.
    pub steps: Vec<DrillStep>,
    /// When it ends, in seconds after it began.
    pub end: f64,
}

/// The built-in drill of this name.
///
/// # Errors
/// There is none; or its file is wrong, which a test denies.
pub fn builtin(name: &str) -> Option<Result<Drill, Faults>> {
    BUILTIN.iter().find(|(known, _)| *known == name).map(|(_, file)| read_drill(file))
}

/// Reads a drill: `name`, `about`, `end` (seconds), and `[[step]]` tables with `at` (seconds), `fault`, and perhaps `name`, `place` and
/// `size`; or with `at` and `sound = true`, where the fault before ends.
///
/// # Errors
/// All that is wrong with the file, with lines and columns: faults that are none, times that do not rise, a size that a fault has not.
pub fn read_drill(text: &str) -> Result<Drill, Faults> {
    let (mut reader, file) = Reader::parse(text)?;
    reader.only(&file, &["name", "about", "end", "step"]);
    let name = reader.string(&file, "name", "the name of the drill").unwrap_or("drill").to_owned();
    let about = reader.string(&file, "about", "what the drill is for").unwrap_or_default().to_owned();
    let (mut steps, mut last) = (Vec::<DrillStep>::new(), None::<f64>);
    for (i, (table, place)) in reader.tables(&file, "step", Some(MOST_STEPS)).into_iter().enumerate() {
        reader.only(table, &["name", "at", "fault", "place", "size", "sound"]);
        let within = format!("[[step]] {}", i + 1);
        let at = reader.required(table, (&within, place.clone()), "at", Domain::NotNegative);
        if let (Some(before), Some(value)) = (last.filter(|before| at <= *before), table.get("at")) {
            reader.wrong("at", value, format!("more than {before}, when the step before it is"));
        }
        last = Some(at);
        let is_sound = reader.boolean(table, "sound").unwrap_or(false);
        let fault = reader.string(table, "fault", "the name of a fault").map(str::to_owned);
        let fault = match (fault, is_sound) {
            (Some(_), true) => {
                reader.fault(place.clone(), format!("{within}: fault beside sound"), "one of them");
                None
            }
            (None, false) => {
                reader.fault(place.clone(), format!("{within} without fault"), "fault = NAME, or sound = true");
                None
            }
            (None, true) => None,
            (Some(fault), false) => match Fault::named(&fault) {
                Ok(fault) => Some(FaultOrder { fault, at: None, size: None }),
                Err(why) => {
                    if let Some(value) = table.get("fault") {
                        reader.told(value.span(), &why.to_string(), "the name of a fault");
                    }
                    None
                }
            },
        };
        let fault = fault.map(|mut order| {
            order.at = match table.get("place") {
                Some(value) if value.get_ref().as_str().is_some() => value.get_ref().as_str().map(str::to_owned),
                Some(_) => reader.counted(table, "place", rotor::MAX_MASSES, "a place").map(|at| (at + 1).to_string()),
                None => None,
            };
            if let Some(value) = table.get("size") {
                let typed = value.get_ref().as_str().map(str::to_owned);
                let typed = typed.or_else(|| text::as_number(value).map(|size| size.to_string())).unwrap_or_default();
                match order.read_size(&typed) {
                    Ok(size) => order.size = Some(size),
                    Err(DrillError::Size { expected, .. }) => reader.wrong("size", value, expected),
                    Err(other) => reader.told(value.span(), &other.to_string(), "a size"),
                }
            }
            order
        });
        let called = reader.string(table, "name", "what the step is called").map(str::to_owned);
        let called = called.or_else(|| fault.as_ref().map(FaultOrder::to_string)).unwrap_or_else(|| "sound".to_owned());
        steps.push(DrillStep { name: called, at, fault });
    }
    let end = reader.number(&file, "end", Domain::Positive);
    if let (Some(end), Some(value), Some(last)) = (end, file.get("end"), last)
        && end <= last
    {
        reader.wrong("end", value, format!("more than {last}, when the last step is"));
    }
    // As long as the step before it, where nothing is said.
    let lasts = match steps.as_slice() {
        [.., before, last] => last.at - before.at,
        _ => 10.0,
    };
    let end = end.unwrap_or_else(|| last.unwrap_or(0.0) + lasts);
    reader.finish(Drill { name, about, steps, end })
}
