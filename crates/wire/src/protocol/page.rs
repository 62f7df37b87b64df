//! `docs/book/src/protocol.md`: services, steps and messages as tables, made of the tables that the program itself goes by.

use std::fmt::Write as _;

use super::{ICEORYX2, Payload, SCHEMA_ATTRIBUTE, SERVICES, Service};
use crate::SCHEMA;
use crate::channels::{CHANNELS, Scope, channels_of};
use crate::header::{CONSTANTS, FLAGS, messages};
use crate::message::Flags;
use crate::wire_struct::{Field, MessageTable};

/// What stands before the tables.
const BEFORE: &str = include_str!("before.md");

/// The page.
#[must_use]
pub fn page() -> String {
    let mut out = BEFORE
        .replace("{schema}", &SCHEMA.to_string())
        .replace("{attribute}", SCHEMA_ATTRIBUTE)
        .replace("{iceoryx2}", ICEORYX2);
    out += "\n## Services\n\n| service | pattern | from | message | waits | kept | places | what |\n|---|---|---|---|---|---|---|---|\n";
    for service in SERVICES {
        let Service { topic, pattern, from, buffered, kept, parties, meaning, .. } = service;
        let _ = writeln!(
            out,
            "| `whirl/NAME/{topic}` | {} | {from} | {} | {buffered} | {kept} | {parties} | {meaning} |",
            pattern.name(),
            message_of(&service),
        );
    }
    out += "\n*Waits*: messages that wait for a reader that sleeps; of more the oldest are lost. *Kept*: messages that reach a reader that comes \
            late, at the next message or within a tenth of a second. *Places*: how many may read, or ask.\n";
    out += "\n| number | value | what |\n|---|---|---|\n";
    for (name, value, meaning) in CONSTANTS {
        let _ = writeln!(out, "| `{name}` | {value} | {meaning} |");
    }
    steps(&mut out);
    out += "\n## Messages\n";
    for message in messages() {
        table(&mut out, &message);
    }
    out
}

fn message_of(service: &Service) -> String {
    let mut told = match service.payload {
        Payload::None => "-".to_owned(),
        Payload::One(name) => link(name),
        Payload::Slice(element, most) => format!("slice of up to {most} `{element}`"),
    };
    if let Some(header) = service.header {
        let _ = write!(told, ", user header {}", link(header));
    }
    if let Some(answer) = service.answer {
        let _ = write!(told, "; answer {}", link(answer));
    }
    told
}

fn link(name: &str) -> String {
    format!("[`{name}`](#{})", name.replace('.', "").to_ascii_lowercase())
}

fn steps(out: &mut String) {
    let [once, mass, sensor, further] = [Scope::Once, Scope::Mass, Scope::Sensor, Scope::Further].map(channels_of);
    let _ = write!(
        out,
        "\n## Steps\n\n`whirl/NAME/state` carries rows of 64-bit words, one row a step, one after the other. A row of `m` masses, `s` sensors and `b` control \
         bearings has `{once} + {mass} m + {sensor} s + {further} (b - 1)` words; `flags` says how many there are of each. `i` is a mass, sensor or control bearing after \
         the first, counted from 0.\n\n| channel | place | type | unit | what |\n|---|---|---|---|---|\n"
    );
    let mut within = [0; 4];
    for row in CHANNELS {
        let place = within[row.scope as usize];
        within[row.scope as usize] += 1;
        let (name, place) = match row.scope {
            Scope::Once => (row.name.to_owned(), format!("{place}")),
            Scope::Mass => (format!("{}N", row.name), format!("{} + {mass} i", once + place)),
            Scope::Sensor => (format!("{}N", row.name), format!("{} + {mass} m + {sensor} i", once + place)),
            Scope::Further => {
                (format!("{}N", row.name), format!("{} + {mass} m + {sensor} s + {further} i", once + place))
            }
        };
        let unit = row.dimension.unit();
        let (kind, unit) = if row.channel.is_number() { ("f64", unit) } else { ("u64", "") };
        let _ = writeln!(out, "| `{name}` | {place} | {kind} | {unit} | {} |", row.meaning);
    }
    out.push_str("\n| flag | bit | what |\n|---|---|---|\n| `contact.N` | N - 1 | mass N presses on its bearing |\n");
    for (name, Flags(bits), meaning) in FLAGS {
        let _ = writeln!(out, "| `{}` | {} | {meaning} |", name.to_ascii_lowercase(), bits.trailing_zeros());
    }
}

fn table(out: &mut String, message: &MessageTable) {
    let _ = write!(
        out,
        "\n### {}\n\n{} {} bytes; `struct {}` in C.\n\n| offset | field | type | what |\n|---|---|---|---|\n",
        message.name,
        plain(&message.meaning),
        message.size,
        message.c_name
    );
    for field in &message.fields {
        let _ =
            writeln!(out, "| {} | `{}` | {} | {} |", field.offset, field.name, type_of(field), plain(&field.meaning));
    }
}

/// What a field is: `u64`, `f64[4]`, `text[32]`.
fn type_of(field: &Field) -> String {
    let shape: String = field.shape.iter().map(|count| format!("[{count}]")).collect();
    if field.element.starts_with("whirl.") { link(field.element) + &shape } else { field.element.to_owned() + &shape }
}

/// Without the marks of rustdoc, and fit for a cell of a table.
fn plain(meaning: &str) -> String {
    let meaning = meaning.replace("crate::message::", "").replace("crate::", "").replace("::", ".");
    meaning.replace("[`", "`").replace("`]", "`").replace('|', "\\|")
}
