//! From what a person types to a machine: rotors and feedback by name or from a file, and the settings they start with.

mod assignment;
mod machine;
mod toml_file;

use std::path::Path;

use rotor::file;
use rotor::profile::Profile;
use rotor::{Feedback, Rotor, builtin};

use crate::failure::Failure;

pub(crate) use assignment::assign_all;
pub(crate) use machine::{Default, Machine};
pub(crate) use toml_file::{FileError, text};

/// Whether what was typed means a file: it ends in `.toml` or has a path separator.
pub(crate) fn is_file(typed: &str) -> bool {
    typed.contains(std::path::is_separator) || typed.ends_with(".toml")
}

/// The rotor in a file's text; the file's stem is its name if it gives none.
///
/// # Errors
/// All that is wrong with it.
pub(crate) fn rotor_of(path: &str, text: &str) -> Result<Rotor, FileError> {
    let stem = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
    // Files that it names lie beside it.
    let folder = Path::new(path).parent().unwrap_or(Path::new("")).to_owned();
    let open = move |name: &str| {
        let of_matrices = folder.join(name);
        std::fs::read(&of_matrices)
            .map_err(|error| format!("{}: {error}: expected a file of matrices", of_matrices.display()))
    };
    file::read_rotor_with(text, &stem, &open).map_err(|faults| FileError::wrong(path, text, faults))
}

/// The feedback in a file's text, for a rotor if it is known.
///
/// # Errors
/// All that is wrong with it.
pub(crate) fn feedback_of(path: &str, text: &str, rotor: Option<&Rotor>) -> Result<Feedback, FileError> {
    let read = rotor.map_or_else(|| file::read_feedback(text, None), |rotor| file::read_feedback_for(text, rotor));
    read.map_err(|faults| FileError::wrong(path, text, faults))
}

/// The rotor of that name, or in that file.
///
/// # Errors
/// No such rotor: the message lists what there is. Or all that is wrong with the file.
pub(crate) fn rotor(typed: &str) -> Result<Rotor, Failure> {
    if is_file(typed) {
        return Ok(rotor_of(typed, &text(typed)?)?);
    }
    builtin::rotor(typed).ok_or_else(|| {
        let known = builtin::ROTORS.join(", ");
        let meant = text::meant(typed, &builtin::ROTORS);
        Failure::Usage(format!("no rotor '{typed}': {meant}built in are {known}; {A_FILE_TOO}"))
    })
}

/// The profile of speed in a file, for `rotor`.
///
/// # Errors
/// A file that cannot be read, or all that is wrong with it.
pub(crate) fn profile(rotor: &Rotor, path: &str) -> Result<Profile, Failure> {
    let text = text(path)?;
    Ok(file::read_profile(&text, rotor).map_err(|faults| FileError::wrong(path, &text, faults))?)
}

/// The feedback of that name for `rotor`, or in that file.
///
/// # Errors
/// No such feedback for this rotor: the message lists what there is. Or all that is wrong with the file, or does not
/// fit the rotor.
pub(crate) fn feedback(rotor: &Rotor, typed: &str) -> Result<Feedback, Failure> {
    if is_file(typed) {
        let text = text(typed)?;
        return Ok(file::read_feedback_for(&text, rotor).map_err(|faults| FileError::wrong(typed, &text, faults))?);
    }
    builtin::feedback(rotor, typed).ok_or_else(|| {
        let known = builtin::feedback_names(rotor).join(", ");
        let (meant, name) = (text::meant(typed, builtin::feedback_names(rotor)), rotor.name());
        Failure::Usage(format!("no feedback '{typed}' for {name}: {meant}built in are {known}; {A_FILE_TOO}"))
    })
}

const A_FILE_TOO: &str = "a path or a name that ends in .toml is a file";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_or_a_toml_name_is_a_file() {
        for typed in ["a.toml", "./a", "/dev/stdin", "folder/"] {
            assert!(is_file(typed), "{typed}");
        }
        for typed in ["jeffcott", "three-mass", "toml", "."] {
            assert!(!is_file(typed), "{typed}");
        }
    }
}
