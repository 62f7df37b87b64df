//! What is searched of a rotor of shaft elements: the law of its drawing, or gains at every magnetic bearing.

use rotor::{BeamRotor, Feedback, Rotor, Signal};

use super::TuneArgs;
use super::typed::{Places, Signal as Drive};
use crate::failure::Failure;

/// What a search begins with where there are no gains: the stiffness `K_t`, and as much damping at `w0`.
const HOVER: [f64; 4] = [1.0, 1.0, 0.0, 0.0];

/// The feedback whose gains are searched, `feedback` being the rotor's own, or off.
///
/// # Errors
/// Places that the rotor does not have.
pub(super) fn template(args: &TuneArgs, rotor: &Rotor, feedback: &Feedback) -> Result<Feedback, Failure> {
    let Some(beam) = rotor.beam() else { return Ok(feedback.clone()) };
    if args.bearing.is_some() {
        return Err(Failure::Usage(
            "--bearing: every magnetic bearing of a rotor of shaft elements is searched: leave it out, or give --feedback FILE".into(),
        ));
    }
    if args.signal.is_none() && args.sensors.is_none() && !feedback.is_off() {
        return Ok(feedback.clone());
    }
    let mut made = beam.no_feedback().with_parts(feedback.first().parts);
    // Each bearing keeps its own actuator.
    for bearing in &mut made.bearings {
        if let Some(own) = feedback.bearings.iter().find(|own| own.station == bearing.station) {
            bearing.parts = own.parts;
        }
    }
    let named = args.sensors.as_ref().map(|typed| places(typed, rotor, beam)).transpose()?;
    for bearing in &mut made.bearings {
        let own = bearing.signals[0].clone();
        let at = |place: &usize, gains: [f64; 4]| Signal::at_mass(*place, rotor.len(), gains);
        let is_own = |place: &usize| own.displacement[*place] != 0.0;
        let sensors = named.clone().unwrap_or_else(|| (0..rotor.len()).filter(is_own).collect());
        bearing.signals = if args.signal == Some(Drive::Individual) || sensors.len() == 1 {
            // Without a sensor of its own a bearing begins with the first.
            let first = sensors.iter().position(is_own).unwrap_or(0);
            let of = |(k, place)| at(place, if k == first { HOVER } else { [0.0; 4] });
            sensors.iter().enumerate().map(of).collect()
        } else {
            let weight = |place: usize| f64::from(u8::from(sensors.contains(&place)));
            let weights: Vec<f64> = (0..rotor.len()).map(weight).collect();
            vec![Signal::composite(&weights, HOVER.map(|gain| gain / sensors.len() as f64))]
        };
    }
    Ok(made)
}

/// Places of the rotor, counted from 0: by number from 1, by name, or by the name of the magnetic bearing whose sensor it is.
fn places(typed: &Places, rotor: &Rotor, beam: &BeamRotor) -> Result<Vec<usize>, Failure> {
    let count = rotor.len();
    let names = match typed {
        Places::Any(_) => {
            return Err(Failure::Usage(
                "--sensors any: places of a rotor of shaft elements are named, such as left,right".into(),
            ));
        }
        Places::These(numbers) => numbers.iter().map(usize::to_string).collect(),
        Places::Named(names) => names.clone(),
    };
    let bearings = beam.no_feedback();
    let of_bearing = |name: &str| {
        let bearing = bearings.bearings.iter().find(|bearing| bearing.name.as_deref() == Some(name))?;
        bearing.signals[0].displacement.iter().position(|weight| *weight != 0.0)
    };
    let mut found = Vec::new();
    for name in &names {
        let number = || name.parse::<usize>().ok().and_then(|n| n.checked_sub(1)).filter(|place| *place < count);
        let place = of_bearing(name).or_else(|| (0..count).find(|k| rotor.place_name(*k) == *name)).or_else(number);
        let Some(place) = place else {
            let known: Vec<String> = bearings.bearings.iter().filter_map(|bearing| bearing.name.clone()).collect();
            return Err(Failure::Usage(format!(
                "--sensors: no place '{name}': {} has magnetic bearings {} and places 1 to {count}",
                rotor.name(),
                known.join(", ")
            )));
        };
        if found.contains(&place) {
            return Err(Failure::Usage(format!("--sensors: place '{name}' is named twice")));
        }
        found.push(place);
    }
    Ok(found)
}
