//! The messages for Python: ctypes structures and the table of channels, made of the same tables as the C header. `python/whirl/messages.py`
//! beside this crate's manifest is kept in step with it by a test; `cargo run -p wire --example python -- crates/wire/python/whirl/messages.py`
//! makes it again.

use std::fmt::Write as _;

use crate::channels::{CHANNELS, Scope, channels_of};
use crate::header::{CONSTANTS, FLAGS, messages};
use crate::message::Flags;
use crate::protocol::{ICEORYX2, SCHEMA_ATTRIBUTE};
use crate::wire_struct::{Field, MessageTable};

/// Longest line of a docstring or comment.
const WIDTH: usize = 110;

/// The module.
#[must_use]
pub fn text() -> String {
    let mut out = String::from(
        "\"\"\"The messages of a whirl bench. Made of the tables of the crate `wire`; not to be edited.\"\"\"\n\nfrom __future__ import annotations\n\n\
         import builtins\nimport ctypes\nfrom typing import Any, ClassVar, NamedTuple\n\n",
    );
    let _ = writeln!(out, "ICEORYX2 = \"{ICEORYX2}\"\nSCHEMA_ATTRIBUTE = \"{SCHEMA_ATTRIBUTE}\"");
    for (name, value, meaning) in CONSTANTS {
        let _ = writeln!(out, "{name} = {value}  # {meaning}");
    }
    out += "\n#: Flags of a step, beside bit N - 1 for mass N that presses on its bearing.\nFLAGS = {\n";
    for (name, Flags(bits), meaning) in FLAGS {
        let _ = writeln!(out, "    \"{}\": {bits:#x},  # {meaning}", name.to_ascii_lowercase());
    }
    out += "}\n\n\nclass Channel(NamedTuple):\n    \"\"\"A quantity of a step.\"\"\"\n\n    name: str\n    scope: str  # once, mass, sensor, further\n    \
            place: int  # among the words of its scope\n    is_number: bool\n    unit: str\n    meaning: str\n\n\nCHANNELS = (\n";
    for row in CHANNELS {
        let is_number = if row.channel.is_number() { "True" } else { "False" };
        let _ = writeln!(
            out,
            "    Channel(\"{}\", \"{}\", {}, {is_number}, \"{}\", \"{}\"),",
            row.name,
            scope(row.scope),
            row.channel.place_in_scope(),
            row.dimension.unit(),
            row.meaning
        );
    }
    out += ")\n\n#: Words of a row for each of a scope.\nWORDS = {";
    let words = [Scope::Once, Scope::Mass, Scope::Sensor, Scope::Further]
        .map(|of| format!("\"{}\": {}", scope(of), channels_of(of)));
    let _ = writeln!(out, "{}}}", words.join(", "));
    for message in messages() {
        structure(&mut out, &message);
    }
    out
}

fn scope(scope: Scope) -> &'static str {
    match scope {
        Scope::Once => "once",
        Scope::Mass => "mass",
        Scope::Sensor => "sensor",
        Scope::Further => "further",
    }
}

fn structure(out: &mut String, message: &MessageTable) {
    let name = class_name(message.name);
    let _ = write!(out, "\n\nclass {name}(ctypes.Structure):\n    \"\"\"");
    out.push_str(&broken(&plain(&message.meaning), "    ", WIDTH));
    out.push_str("\"\"\"\n\n");
    for field in &message.fields {
        out.push_str(&comment(&plain(&field.meaning)));
        let _ = writeln!(out, "    {}: {}", field.name, annotation(field));
    }
    out.push_str("    _fields_: ClassVar = [\n");
    for field in &message.fields {
        let _ = writeln!(out, "        (\"{}\", {}),", field.name, ctype(field));
    }
    let _ = write!(
        out,
        "    ]\n\n    @staticmethod\n    def type_name() -> str:\n        \"\"\"Its name on the wire.\"\"\"\n        return \"{}\"\n\n\nassert ctypes.sizeof({name}) == {}\n",
        message.name, message.size
    );
}

/// `whirl.BenchStatus` is `BenchStatus`.
fn class_name(name: &str) -> &str {
    name.trim_start_matches("whirl.")
}

fn element(name: &str) -> &str {
    match name {
        "u16" => "ctypes.c_uint16",
        "u32" => "ctypes.c_uint32",
        "u64" => "ctypes.c_uint64",
        "f64" => "ctypes.c_double",
        "text" => "ctypes.c_char",
        message => class_name(message),
    }
}

/// What it is declared as: `ctypes.c_double * 2 * 8`, innermost first.
fn ctype(field: &Field) -> String {
    field.shape.iter().rev().fold(element(field.element).to_owned(), |made, count| format!("{made} * {count}"))
}

/// What it is read as.
fn annotation(field: &Field) -> String {
    let one = match field.element {
        "u16" | "u32" | "u64" => "int",
        "f64" => "float",
        "text" => return "builtins.bytes".to_owned(),
        message => return class_name(message).to_owned(),
    };
    if field.shape.is_empty() { one.to_owned() } else { "ctypes.Array[Any]".to_owned() }
}

/// Without the marks of rustdoc.
fn plain(meaning: &str) -> String {
    meaning
        .replace("crate::message::", "")
        .replace("crate::", "")
        .replace("::", ".")
        .replace("[`", "`")
        .replace("`]", "`")
}

/// Broken into lines of which all but the first begin with `indent`.
fn broken(text: &str, indent: &str, width: usize) -> String {
    let (mut out, mut long) = (String::new(), indent.len() + 3);
    for word in text.split_whitespace() {
        let len = word.chars().count();
        if !out.is_empty() && long + 1 + len > width {
            let _ = write!(out, "\n{indent}");
            long = indent.len();
        } else if !out.is_empty() {
            out.push(' ');
            long += 1;
        }
        out.push_str(word);
        long += len;
    }
    out
}

fn comment(text: &str) -> String {
    format!("    #: {}\n", broken(text, "    #: ", WIDTH))
}
