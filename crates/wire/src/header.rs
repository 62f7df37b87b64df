//! The C header of the messages, made of the tables of channels and of messages. `whirl.h` beside this crate's manifest is kept
//! in step with it by a test; `cargo run -p wire --example header -- crates/wire/whirl.h` makes it again.

use std::fmt::Write as _;

use crate::channels::{CHANNELS, Scope, channels_of};
use crate::control::{ControlCommand, Readings};
use crate::message::{Analysis, Answer, BenchStatusMessage, ControlHealth, Flags, Health, RequestMessage, Trip};
use crate::wire_struct::{Message, MessageTable};
use crate::{
    DOCUMENTS_KEPT, DocumentHead, EVENTS_KEPT, EventMessage, MAX_BURST, MAX_DOCUMENT, MAX_SNAPSHOT, RecorderStatus,
    SCHEMA, SnapshotHead,
};

/// Longest line of a comment.
const WIDTH: usize = 116;

/// Numbers that the messages go by: name, value and meaning.
pub const CONSTANTS: [(&str, usize, &str); 8] = [
    ("SCHEMA", SCHEMA as usize, "version of all messages together"),
    ("MAX_MASSES", rotor::MAX_MASSES, "masses of the largest rotor"),
    ("MAX_BEARINGS", rotor::MAX_BEARINGS, "control bearings of the largest machine"),
    ("MAX_BURST", MAX_BURST, "steps of the largest message of whirl/NAME/state"),
    ("EVENTS_KEPT", EVENTS_KEPT, "events that reach readers that come late"),
    ("DOCUMENTS_KEPT", DOCUMENTS_KEPT, "documents that reach readers that come late"),
    ("MAX_DOCUMENT", MAX_DOCUMENT, "bytes of the largest document"),
    ("MAX_SNAPSHOT", MAX_SNAPSHOT, "words of the largest snapshot"),
];

/// Flags of a step beside contacts: name, flag and meaning.
pub const FLAGS: [(&str, Flags, &str); 6] = [
    ("SATURATED", Flags::SATURATED, "the control bearing is at its limit"),
    ("TRIPPED", Flags::TRIPPED, "the machine has tripped: the rotor is held where it was, or coasts down"),
    (
        "LATE",
        Flags::LATE,
        "the step was sent more than one period of wake-ups (of a step, or of all steps that share one) after it was due",
    ),
    ("EXTERNAL", Flags::EXTERNAL, "the command comes from a controller outside"),
    ("HELD", Flags::HELD, "a command from outside that should be there is not: the last one is held"),
    (
        "COASTING",
        Flags::COASTING,
        "beside TRIPPED: not held, the speed coasts down to rest and the rotor goes on moving",
    ),
];

/// Every message, those that others contain first.
#[must_use]
pub fn messages() -> Vec<MessageTable> {
    vec![
        Analysis::table(),
        Health::table(),
        ControlHealth::table(),
        Trip::table(),
        DocumentHead::table(),
        BenchStatusMessage::table(),
        EventMessage::table(),
        RequestMessage::table(),
        Answer::table(),
        RecorderStatus::table(),
        SnapshotHead::table(),
        Readings::table(),
        ControlCommand::table(),
    ]
}

/// The header.
#[must_use]
pub fn text() -> String {
    let mut out = String::new();
    comment(
        &mut out,
        "",
        "The messages of a whirl bench, for C and C++. Made of the tables of the crate `wire`; not to be edited. \
         Dimensionless units of the model throughout: displacement in e_t, time tau = w0 t, velocity in w0 e_t, control in \
         w0^2 e_t. The services are those of iceoryx2, called whirl/NAME/state and so on; the schema is their attribute \
         whirl.schema. Texts are UTF-8, padded with zeros, and have no zero at the end where they fill their place.",
    );
    out += "#ifndef WHIRL_H\n#define WHIRL_H\n\n#include <stdint.h>\n#include <string.h>\n\n";
    for (name, value, meaning) in CONSTANTS {
        let _ = writeln!(out, "#define WHIRL_{name} {value} /* {meaning} */");
    }
    out += "\n";
    steps(&mut out);
    for message in messages() {
        structure(&mut out, &message);
    }
    out += "#endif\n";
    out
}

/// The words of a step.
fn steps(out: &mut String) {
    let [once, mass, sensor, further] = [Scope::Once, Scope::Mass, Scope::Sensor, Scope::Further].map(channels_of);
    comment(
        out,
        "",
        "whirl/NAME/state carries slices of 64-bit words: rows of WHIRL_WIDTH words, one after the other, one row a step, up \
         to WHIRL_MAX_BURST. Each row says itself how many masses, sensors and control bearings it has. Below are the places \
         of its words; masses and sensors are counted from 0, and so are control bearings after the first. Doubles are read with \
         whirl_number.",
    );
    let mut within = [0; 4];
    for row in CHANNELS {
        let place = within[row.scope as usize];
        within[row.scope as usize] += 1;
        let name = row.name.to_ascii_uppercase();
        let (arguments, value) = match row.scope {
            Scope::Once => ("", format!("{place}")),
            Scope::Mass => ("(mass)", format!("({once} + {mass} * (mass) + {place})")),
            Scope::Sensor => {
                ("(masses, sensor)", format!("({once} + {mass} * (masses) + {sensor} * (sensor) + {place})"))
            }
            Scope::Further => (
                "(masses, sensors, further)",
                format!("({once} + {mass} * (masses) + {sensor} * (sensors) + {further} * (further) + {place})"),
            ),
        };
        let unit = row.dimension.unit();
        let unit = if unit.is_empty() { "uint64_t".to_owned() } else { format!("double, {unit}") };
        let _ = writeln!(out, "#define WHIRL_{name}{arguments} {value} /* {unit}: {} */", row.meaning);
    }
    let _ = writeln!(
        out,
        "\n#define WHIRL_WIDTH(masses, sensors, further) ({once} + {mass} * (masses) + {sensor} * (sensors) + {further} * (further))"
    );
    out.push_str("#define WHIRL_MASSES(row) ((unsigned)((row)[WHIRL_FLAGS] >> 32 & 0xffff))\n");
    out.push_str("#define WHIRL_SENSORS(row) ((unsigned)((row)[WHIRL_FLAGS] >> 48 & 0xff))\n");
    out.push_str("/* Control bearings after the first. */\n#define WHIRL_FURTHER(row) ((unsigned)((row)[WHIRL_FLAGS] >> 56))\n\n");
    out.push_str("/* Bit m of the flags is set while mass m presses on its bearing. */\n");
    for (name, Flags(bits), meaning) in FLAGS {
        let _ = writeln!(out, "#define WHIRL_{name} UINT32_C({bits:#x}) /* {meaning} */");
    }
    out.push_str(
        "\n/* The double whose bits a word is. */\nstatic inline double whirl_number(uint64_t word) {\n    double number;\n    \
         memcpy(&number, &word, sizeof number);\n    return number;\n}\n\n",
    );
}

fn structure(out: &mut String, message: &MessageTable) {
    comment(out, "", &message.meaning);
    let _ = writeln!(out, "struct {} {{ /* {} bytes, {} */", message.c_name, message.size, message.name);
    for field in &message.fields {
        comment(out, "    ", &format!("{}: {}", field.offset, field.meaning));
        let _ = writeln!(out, "    {} {}{};", field.c_type, field.name, field.c_suffix);
    }
    out.push_str("};\n\n");
}

/// A comment, broken into lines; without the marks of rustdoc.
fn comment(out: &mut String, indent: &str, text: &str) {
    let text = text.replace(['[', ']', '`'], "").replace("crate::", "");
    let mut line = format!("{indent}/*");
    for word in text.split_whitespace() {
        if line.len() + 1 + word.len() > WIDTH {
            out.push_str(&line);
            out.push('\n');
            line = format!("{indent}  ");
        }
        line.push(' ');
        line.push_str(word);
    }
    out.push_str(&line);
    out.push_str(" */\n");
}
