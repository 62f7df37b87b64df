//! From what a person types to a machine: rotors and feedback by name, and the settings they start with.

use rotor::{Feedback, Rotor, Settings, SettingsError, builtin};

use crate::cli::MachineArgs;
use crate::failure::Failure;

/// The rotor of that name.
///
/// # Errors
/// No such rotor: the message lists what there is.
pub(crate) fn rotor(name: &str) -> Result<Rotor, Failure> {
    builtin::rotor(name)
        .ok_or_else(|| Failure::Usage(format!("no rotor '{name}': built in are {}", builtin::ROTORS.join(", "))))
}

/// The feedback of that name for `rotor`.
///
/// # Errors
/// No such feedback for this rotor: the message lists what there is.
pub(crate) fn feedback(rotor: &Rotor, name: &str) -> Result<Feedback, Failure> {
    builtin::feedback(rotor, name).ok_or_else(|| {
        let known = builtin::feedback_names(rotor).join(", ");
        Failure::Usage(format!("no feedback '{name}' for {}: built in are {known}", rotor.name()))
    })
}

/// What feedback a command takes when none is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Default {
    /// Analysis looks at the rotor as it is: `off`.
    Analysis,
    /// A live bench starts stable: `cancel`, `composite`, or `off` for a rotor that has neither.
    Live,
}

/// The rotor and settings that the common options describe.
///
/// # Errors
/// An unknown name, or a value that does not fit the rotor.
pub(crate) fn machine(args: &MachineArgs, speed: f64, default: Default) -> Result<(Rotor, Settings), Failure> {
    let rotor = rotor(&args.rotor)?;
    let name = args.feedback.as_deref().unwrap_or(match default {
        Default::Analysis => "off",
        Default::Live => builtin::live_feedback_name(&rotor),
    });
    let mut settings = Settings::new(&rotor, speed, feedback(&rotor, name)?);
    if let Some(deadband) = args.deadband {
        settings.set("deadband".parse()?, deadband)?;
    }
    settings.check(&rotor)?;
    Ok((rotor, settings))
}

/// Applies one `KEY=VALUE` to `settings`; `feedback` takes a name, every other key a number.
///
/// # Errors
/// No `=`, or whatever the key or the value has wrong.
pub(crate) fn assign(rotor: &Rotor, settings: &mut Settings, assignment: &str) -> Result<(), Failure> {
    let Some((key, value)) = assignment.split_once('=') else {
        return Err(Failure::Usage(format!("'{assignment}': expected KEY=VALUE, such as speed=3")));
    };
    match key {
        "feedback" => settings.feedback = feedback(rotor, value)?,
        _ => settings.assign(key, value).map_err(|error: SettingsError| Failure::Usage(error.to_string()))?,
    }
    Ok(())
}
