//! Profiles of speed: `[[leg]]` one after the other, dimensionless or, of a rotor in SI units, in rpm, rpm/s and seconds.

use text::{Domain, Fault, Faults, Reader, Table};
use units::{Dimension, Units};

use crate::profile::{Leg, MAX_LEGS, Profile};
use crate::{PARAMETERS, Rotor};

/// What a leg is, for a message.
const LEG: &str =
    "to = SPEED and rate = RATE, or dwell = TIME, or torque = TORQUE, inertia = INERTIA and duration = TIME";

/// Reads a profile for `rotor`: `from` (the speed that it begins at, 0 if absent) and `[[leg]]` tables, each with `to` and `rate`, and
/// `decay = "exponential"` beside them, or with `dwell`, or with `torque`, `inertia`, `duration` and perhaps `drag`.
///
/// # Errors
/// All that is wrong with the file, with lines and columns: rates that are not positive, legs that go nowhere, speeds beyond those
/// that the setting `speed` may have.
pub fn read_profile(text: &str, rotor: &Rotor) -> Result<Profile, Faults> {
    let (mut reader, file) = Reader::parse(text)?;
    let units = Units::of(rotor.scales().copied(), 1.0);
    reader.only(&file, &["from", "leg"]);
    let from = speed(&mut reader, &file, "from", &units).unwrap_or(0.0);
    let (mut now, mut legs, mut lines) = (from, Vec::new(), Vec::new());
    for (i, (table, at)) in reader.tables(&file, "leg", Some(MAX_LEGS)).into_iter().enumerate() {
        reader.only(table, &["to", "rate", "dwell", "decay", "torque", "inertia", "drag", "duration"]);
        let within = format!("[[leg]] {}", i + 1);
        let has = |key: &str| table.contains_key(key);
        lines.push(1 + text[..at.start.min(text.len())].matches('\n').count());
        let kinds: Vec<&str> = ["to", "dwell", "torque"].into_iter().filter(|key| has(key)).collect();
        if kinds.len() != 1 {
            let found =
                if kinds.is_empty() { "neither to nor dwell nor torque".to_owned() } else { kinds.join(" and ") };
            reader.fault(at, format!("{within} with {found}"), LEG);
            continue;
        }
        let others: &[&str] = match kinds[0] {
            "torque" => &["rate", "decay"],
            "dwell" => &["rate", "decay", "inertia", "drag", "duration"],
            _ => &["inertia", "drag", "duration"],
        };
        for key in others.iter().filter(|key| has(key)) {
            reader.fault(at.clone(), format!("{within}: {key} beside {}", kinds[0]), LEG);
        }
        if has("torque") {
            let leg = driven(&mut reader, table, (&within, at.clone()), rotor);
            let (_, end) = leg.runs(now);
            let row = PARAMETERS.iter().find(|row| row.name == "speed");
            if let Some(row) = row.filter(|row| end.is_finite() && !(row.min..=row.max).contains(&end)) {
                let [end, min, max] = [end, row.min, row.max].map(|end| units.shown(Dimension::Speed, end));
                reader.fault(
                    at,
                    format!("{within} ends at a speed of {end}"),
                    format!("torque, drag and duration for {min} to {max}"),
                );
            }
            now = end;
            legs.push(leg);
            continue;
        }
        if has("dwell") {
            let typed = reader.required(table, (&within, at), "dwell", Domain::Positive);
            let duration = units.typed(Dimension::Time, typed);
            legs.push(Leg::Dwell { duration });
            continue;
        }
        if legs.iter().any(|leg| matches!(leg, Leg::Drive { .. })) {
            let expected = "dwell or torque: where a leg after one of a torque begins is not known before";
            reader.fault(at, format!("{within} to a speed"), expected);
            continue;
        }
        let to = speed(&mut reader, table, "to", &units).unwrap_or(f64::NAN);
        let typed = reader.required(table, (&within, at), "rate", Domain::Positive);
        let rate = units.typed(Dimension::SpeedRate, typed);
        if let (true, Some(value)) = (to == now, table.get("to")) {
            reader.wrong("to", value, "another speed than that before it: this leg goes nowhere");
        }
        now = to;
        legs.push(if reader.choice(table, "decay", &["exponential"]).is_some() {
            Leg::Decay { speed: to, rate }
        } else {
            Leg::To { speed: to, rate }
        });
    }
    let starts = lines.clone();
    reader.finish(Profile { from, legs, lines }).map_err(|faults| in_legs(&faults, &starts))
}

/// The same faults, each with the leg that it is in; `starts` are the lines at which legs begin.
fn in_legs(faults: &Faults, starts: &[usize]) -> Faults {
    let named = |fault: &Fault| match starts.partition_point(|start| *start <= fault.line) {
        leg @ 1.. if !fault.found.starts_with("[[leg]]") => {
            Fault { found: format!("[[leg]] {leg}: {}", fault.found), ..fault.clone() }
        }
        _ => fault.clone(),
    };
    Faults::some(faults.list().iter().map(named).collect()).unwrap_or_else(|| faults.clone())
}

/// A leg turned by a torque: SI rotors have it in N m, inertia in kg m^2, drag in N m s.
fn driven(reader: &mut Reader<'_>, table: &Table<'_>, within: (&str, std::ops::Range<usize>), rotor: &Rotor) -> Leg {
    let [torque, inertia, drag, time] = rotor.scales().map_or([1.0; 4], |scales| {
        let torque = scales.k_t * scales.e_t * scales.e_t;
        [torque, scales.m_t * scales.e_t * scales.e_t, torque / scales.w0, scales.seconds(1.0)]
    });
    Leg::Drive {
        torque: reader.required(table, within.clone(), "torque", Domain::Finite) / torque,
        inertia: reader.required(table, within.clone(), "inertia", Domain::Positive) / inertia,
        drag: reader.number(table, "drag", Domain::NotNegative).unwrap_or(0.0) / drag,
        duration: reader.required(table, within, "duration", Domain::Positive) / time,
    }
}

/// A speed under `key`, in the range of the setting.
fn speed(reader: &mut Reader<'_>, table: &Table<'_>, key: &str, units: &Units) -> Option<f64> {
    let value = table.get(key)?;
    let typed = reader.number(table, key, Domain::Finite)?;
    let speed = units.typed(Dimension::Speed, typed);
    if let Some(row) = PARAMETERS.iter().find(|row| row.name == "speed")
        && !(row.min..=row.max).contains(&speed)
        && typed.is_finite()
    {
        let [min, max] = [row.min, row.max].map(|end| units.shown(Dimension::Speed, end));
        reader.wrong(key, value, format!("a speed from {min} to {max}"));
    }
    Some(speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;

    fn problems(text: &str) -> Vec<String> {
        let rotor = builtin::rotor("three-mass").unwrap();
        let problems = read_profile(text, &rotor).unwrap_err();
        problems
            .list()
            .iter()
            .map(|p| format!("{}:{} {}, expected {}", p.line, p.column, p.found, p.expected))
            .collect()
    }

    #[test]
    fn a_run_up_with_a_dwell_and_a_coast_down() {
        let rotor = builtin::rotor("three-mass").unwrap();
        let text = "[[leg]]\nto = 6.0\nrate = 0.01\n\n[[leg]]\ndwell = 300\n[[leg]]\nto = 0\nrate = 0.02\ndecay = \"exponential\"\n";
        let profile = read_profile(text, &rotor).unwrap();
        let expected =
            [Leg::To { speed: 6.0, rate: 0.01 }, Leg::Dwell { duration: 300.0 }, Leg::Decay { speed: 0.0, rate: 0.02 }];
        assert_eq!((profile.from, &profile.legs[..], &profile.lines[..]), (0.0, &expected[..], &[1, 5, 7][..]));
    }

    #[test]
    fn an_si_rotor_has_rpm_and_seconds() {
        // w0 = 1000 rad/s: 9549.3 rpm are R = 1, and a second is a thousand units of tau.
        let masses = vec![crate::PhysicalMass { mass: 1.0, bearing_stiffness: 1e6, ..Default::default() }];
        let rotor = Rotor::from_si("si", masses, vec![], Some(1e-6)).unwrap();
        let scales = *rotor.scales().unwrap();
        let text = "from = 1000\n[[leg]]\nto = 3000\nrate = 100\n[[leg]]\ndwell = 2\n";
        let profile = read_profile(text, &rotor).unwrap();
        let course = profile.course();
        assert!((scales.rpm(profile.from) - 1000.0).abs() < 1e-9);
        // 2000 rpm at 100 rpm/s are 20 s.
        assert!((scales.seconds(course[1].0) - 20.0).abs() < 1e-9 && (scales.rpm(course[1].1) - 3000.0).abs() < 1e-9);
        assert!((scales.seconds(course[2].0) - 22.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_leg_is_told_with_its_line() {
        assert_eq!(problems(""), ["1:1 no [[leg]], expected 1 to 64 of them"]);
        let wrong = "[[leg]]\nto = 6\nrate = 0\n[[leg]]\nto = 3\nrate = -0.1\n[[leg]]\nto = 3\nrate = 0.1\n[[leg]]\ndwell = 0\n";
        let found = problems(wrong);
        assert!(found[0].starts_with("3:8 [[leg]] 1: rate = 0, expected"), "{found:?}");
        assert!(found[1].starts_with("6:8 [[leg]] 2: rate = -0.1, expected"), "{found:?}");
        assert!(found[2].starts_with("8:6 [[leg]] 3: to = 3, expected another speed"), "{found:?}");
        assert!(found[3].starts_with("11:9 [[leg]] 4: dwell = 0, expected"), "{found:?}");
        let found = problems("[[leg]]\nto = 1e9\nrate = 1\n[[leg]]\nrate = 1\n[[leg]]\ndwell = 1\nrate = 2\n");
        assert!(found[0].contains("expected a speed from 0 to"), "{found:?}");
        assert!(found[1].contains("[[leg]] 2 with neither to nor dwell nor torque"), "{found:?}");
        assert!(found[2].contains("[[leg]] 3: rate beside dwell"), "{found:?}");
        let found = problems("[[leg]]\nto = 1\nrate = 1\ndecay = \"exponental\"\n[[leg]]\ntoo = 1\n");
        assert!(
            found[0].contains("expected \"exponential\"") && found.iter().any(|p| p.contains("did you mean 'to'?")),
            "{found:?}"
        );
    }

    #[test]
    fn a_torque_has_inertia_and_time_and_no_speed_after_it() {
        let rotor = builtin::rotor("three-mass").unwrap();
        let profile = read_profile("[[leg]]\ntorque = 0.3\ninertia = 60\nduration = 400\n", &rotor).unwrap();
        assert_eq!(profile.legs, [Leg::Drive { torque: 0.3, inertia: 60.0, drag: 0.0, duration: 400.0 }]);
        assert!(profile.is_driven() && (profile.ends_at() - 2.0).abs() < 1e-12);
        let found = problems(
            "[[leg]]\ntorque = 1\ninertia = 0\nrate = 1\n[[leg]]\nto = 1\nrate = 1\n[[leg]]\ndwell = 1\ndrag = 1\n",
        );
        for told in [
            "rate beside torque",
            "inertia = 0, expected",
            "without duration",
            "[[leg]] 2 to a speed, expected dwell or torque",
            "drag beside dwell",
        ] {
            assert!(found.iter().any(|p| p.contains(told)), "{told}: {found:?}");
        }
    }
}
