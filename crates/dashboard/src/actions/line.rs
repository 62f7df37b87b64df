//! A line as it is typed after `:`, or stands behind a key.

use rotor::{Key, PARAMETERS, Settings};

use super::action::Action;
use super::argument::assignments;
use super::table::ACTIONS;

/// Whether a word is a setting, with or without an index.
fn is_setting(word: &str) -> bool {
    word.parse::<Key>().is_ok()
}

/// A line whose settings are called as they are where there are several control bearings, `left.kd=3`, with the keys that they are.
pub(crate) fn with_keys(line: &str, settings: Option<&Settings>) -> String {
    let Some(settings) = settings else { return line.to_owned() };
    let key = |word: &str| settings.key(word).ok().filter(|_| word.contains('.')).map(|key| key.to_string());
    let word = |word: &str| match word.split_once('=') {
        Some((name, rest)) => key(name).map(|key| format!("{key}={rest}")),
        None => key(word),
    };
    let words = line.split(' ').map(|typed| word(typed).unwrap_or_else(|| typed.to_owned()));
    words.collect::<Vec<_>>().join(" ")
}

/// What a command line asks for.
///
/// # Errors
/// In words: no such command, or what is wrong with its argument.
pub(crate) fn parse(line: &str) -> Result<Action, String> {
    let line = line.trim();
    let end = line.find([' ', '=']).unwrap_or(line.len());
    let (name, rest) = line.split_at(end);
    // As they are typed elsewhere.
    let name = match name {
        "q" => "quit",
        "w" => "save",
        name => name,
    };
    let Some(row) = ACTIONS.iter().find(|row| row.name == name) else {
        if is_setting(name) {
            return assignments(line);
        }
        let known: Vec<&str> =
            ACTIONS.iter().map(|row| row.name).chain(PARAMETERS.iter().map(|row| row.name)).collect();
        let meant = text::meant(name, &known);
        return Err(format!("no command '{name}': {meant}tab shows what there is, ? the help"));
    };
    let argument = rest.trim();
    match (row.argument, argument) {
        ("", "") => {}
        ("", found) => return Err(format!("{name} '{found}': expected nothing after {name}")),
        (wanted, "") if !wanted.starts_with('[') => return Err(format!("{name}: expected {name} {wanted}")),
        _ => {}
    }
    (row.make)(argument).map_err(|error| format!("{name} {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actions::{TypedLimit, TypedScaling};
    use crate::axis::Scaling;
    use crate::selection::ReadoutMove;
    use alarms::Watch;
    use rotor::typed::TypedRange;
    use telemetry::edits::Edit;
    use units::{Dimension, Typed};

    #[test]
    fn every_row_and_every_key_is_a_command_that_parses() {
        for row in ACTIONS {
            assert!(ACTIONS.iter().filter(|other| other.name == row.name).count() == 1, "{} twice", row.name);
            assert!(!is_setting(row.name), "{} is a setting", row.name);
            for (chord, argument) in row.keys.iter().flat_map(|keys| keys.chords) {
                let line = format!("{} {argument}", row.name);
                // Keys of commands that take a text open the command line with the name in it.
                let needs_text = !row.argument.is_empty() && !row.argument.starts_with('[') && argument.is_empty();
                assert!(needs_text || parse(&line).is_ok(), "{chord}: {line}: {:?}", parse(&line));
            }
        }
    }

    #[test]
    fn settings_are_called_after_their_control_bearing() {
        let rotor = rotor::builtin::rotor("rig").unwrap();
        let own = rotor::builtin::feedback(&rotor, "own").unwrap();
        let settings = Settings::new(&rotor, 1.0, own);
        let read = |line: &str| with_keys(line, Some(&settings));
        assert_eq!(read("right.kd=3"), "kd.2=3");
        assert_eq!(read("set left.kd = 3 right.lag 0.1 speed=2"), "set kd.1 = 3 lag.2 0.1 speed=2");
        assert_eq!(read("note the left.one is loud"), "note the left.one is loud");
        assert_eq!(with_keys("right.kd=3", None), "right.kd=3");
    }

    #[test]
    fn commands_are_parsed_and_mistakes_told() {
        let key = |name: &str| name.parse::<Key>().unwrap();
        assert_eq!(parse("seek -30"), Ok(Action::Seek(-30.0)));
        assert_eq!(parse("  note two words "), Ok(Action::Edit(Edit::Note("two words".into()))));
        assert_eq!(parse("speed 6"), Ok(Action::SetTyped(vec![(key("speed"), 6.0.into())])));
        assert_eq!(parse("kd.2=-1e-3"), Ok(Action::SetTyped(vec![(key("kd.2"), (-1e-3).into())])));
        assert_eq!(
            parse("set kd=1 speed = 3"),
            Ok(Action::SetTyped(vec![(key("kd"), 1.0.into()), (key("speed"), 3.0.into())]))
        );
        let read = |name: &str, typed| (key(name), key(name).parameter.read(typed).unwrap());
        let units = vec![read("kd", "2e5N/m"), read("cd", "-120N s/m"), read("speed", "50Hz"), read("delay", "off")];
        assert_eq!(parse("set kd=2e5N/m cd = -120 N s/m speed 50 Hz delay off"), Ok(Action::SetTyped(units)));
        assert!(parse("set kd=1 sped=3").unwrap_err().starts_with("set no setting 'sped'"), "and no unit of kd");
        assert_eq!(parse("zoom"), Ok(Action::ZoomReset));
        assert_eq!((parse("q"), parse("w good")), (Ok(Action::Quit), Ok(Action::Save("good".into()))));
        assert!(parse("layuot").unwrap_err().starts_with("no command 'layuot': did you mean 'layout'?"));
        assert!(parse("sped 3").unwrap_err().contains("did you mean 'speed'?"));
        let fix = |low, high| Scaling::Fix([low, high]);
        assert_eq!(parse("scale 0.5"), Ok(Action::Scale(None, vec![Scaling::Times(0.5)])));
        assert_eq!(parse("scale auto"), Ok(Action::Scale(None, vec![Scaling::Auto])));
        assert_eq!(
            parse("scale poles -1..0.1 0..3"),
            Ok(Action::Scale(Some("poles".into()), vec![fix(-1.0, 0.1), fix(0.0, 3.0)]))
        );
        assert_eq!(parse("strips auto"), Ok(Action::Strips(None)));
        assert!(matches!(parse("strips y.1+z.1 force"), Ok(Action::Strips(Some(strips))) if strips.len() == 2));
        let along = |typed| Some(TypedScaling::Fix(TypedRange::read(Dimension::Frequency, typed).unwrap()));
        assert_eq!(parse("spectrum 2 -3..3"), Ok(Action::Spectra(Some(Some(1)), along("-3..3"))));
        assert_eq!(parse("spectrum 0..500 Hz"), Ok(Action::Spectra(None, along("0..500Hz"))));
        let typed = |dimension, typed| Typed::read(dimension, typed).unwrap();
        assert_eq!(
            parse("run-up 1000..3100 rpm 10 rpm/s"),
            Ok(Action::RunUp {
                from: Some(typed(Dimension::Speed, "1000rpm")),
                to: typed(Dimension::Speed, "3100rpm"),
                rate: typed(Dimension::SpeedRate, "10rpm/s"),
            })
        );
        let pair = |dimension, pair: [&'static str; 2]| TypedLimit::Pair(pair.map(|end| typed(dimension, end)));
        let limits = pair(Dimension::Length, ["100um", "0.2mm"]);
        assert_eq!(parse("alarm orbit 100um 0.2 mm"), Ok(Action::Limit(Watch::Orbit, limits)));
        let limits = pair(Dimension::Force, ["2N", "4"]);
        assert_eq!(parse("alarm force 2N 4"), Ok(Action::Limit(Watch::Force, limits)));
        assert_eq!(parse("alarm force machine"), Ok(Action::Limit(Watch::Force, TypedLimit::Machine)));
        assert_eq!(parse("spectrum auto"), Ok(Action::Spectra(Some(None), Some(TypedScaling::Auto))));
        assert_eq!(parse("read -1.25"), Ok(Action::Read(ReadoutMove::At(-1.25))));
        for (line, complaint) in [
            ("scale", "scale : expected auto, TIMES or LOW..HIGH"),
            ("scale orbits", "scale orbits: expected auto, TIMES or LOW..HIGH"),
            ("scale orbits 1..x", "scale '1..x': expected auto, TIMES above 0 and other than 1, or LOW..HIGH"),
            ("scale orbits -2", "scale '-2': expected auto, TIMES above 0 and other than 1, or LOW..HIGH"),
            ("strips y.1+speed", "strips 'y.1+speed': expected series of one unit, and speed has another"),
            ("spectrum 0", "spectrum '0': expected a mass, LOW..HIGH or auto"),
            ("scale orbits 7..-7", "scale '7..-7': expected auto, TIMES above 0 and other than 1, or LOW..HIGH"),
            ("scale orbits 0...3", "scale '0...3': expected auto, TIMES above 0 and other than 1, or LOW..HIGH"),
            (
                "scale poles 0..1 0..2 0..3",
                "scale poles 0..1 0..2 0..3: expected one scale, or two for a plot with two axes of values",
            ),
            ("run-up 3100N 10", "run-up '3100N': expected a number, alone or in rpm, Hz, rad/s"),
            ("run-up 0...6 0.01", "run-up '0...6': more than two dots in a row: expected A..B such as 0..3, or 0..0.3"),
            (
                "run-up 1rpm..3 10",
                "run-up '1rpm..3': expected a unit at the upper end, which is that of both, or at each, such as 0..300Hz",
            ),
            (
                "alarm forc 2 4",
                "alarm 'forc': did you mean 'force'? expected one of damping, sensitivity, delay-margin, orbit, force, saturation, lateness, losses",
            ),
            ("alarm orbit 2N 4", "alarm '2N': expected a number, alone or in m, mm, um, nm"),
            ("spectrum 0..3s", "spectrum '0..3s': each end: expected a number, alone or in Hz, kHz, rpm, rad/s"),
            ("spectrum 1 2", "spectrum '2' sets again what stands before it: expected each once"),
            ("spectrum auto 2", "spectrum '2' sets again what stands before it: expected each once"),
            ("spectrum 0..3 1 0..2", "spectrum '0..2' sets again what stands before it: expected each once"),
            ("strips y z y", "strips 'y' is given twice: expected each strip once"),
            ("strips y.1+y.1", "strips 'y.1+y.1': expected each series once"),
            ("set kd=1 kd=2", "set 'kd=1' does nothing: 'kd=2' sets the same. Expected each once"),
            ("kd 1 kd.1 2", "'kd=1' does nothing: 'kd.1=2' sets the same. Expected each once"),
            ("deadband.2=1 deadband=3", "'deadband.2=1' does nothing: 'deadband=3' sets the same. Expected each once"),
            ("seek 0", "seek 0: expected a number other than 0"),
            ("step 0", "step 0: expected a number other than 0"),
            ("nudge 0", "nudge 0: expected a number other than 0"),
            ("zoom 1", "zoom 1: expected a number other than 1"),
            ("span 0.001", "span 0.001: expected a number from 0.02 to 3600"),
            ("span 1e9", "span 1000000000: expected a number from 0.02 to 3600"),
            ("read there", "read 'there': expected a number"),
            ("fly", "no command 'fly': tab shows what there is, ? the help"),
            ("seek", "seek: expected seek SECONDS"),
            ("seek x", "seek 'x': expected a number"),
            ("seek NaN", "seek 'NaN': expected a number"),
            ("zoom 0", "zoom 0: expected a number above 0"),
            ("undo it", "undo 'it': expected nothing after undo"),
            ("kd", "kd: expected kd=VALUE"),
            ("kd=much", "kd = 'much': expected a number"),
            ("", "no command '': tab shows what there is, ? the help"),
        ] {
            assert_eq!(parse(line), Err(complaint.to_owned()), "{line}");
        }
    }
}
