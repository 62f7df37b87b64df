//! `whirl wire`: how another program finds and reads a bench.

use std::collections::BTreeMap;

use serde::Serialize;
use wire::protocol::{ICEORYX2, Payload, SCHEMA_ATTRIBUTE, SERVICES, Service};
use wire::{BenchName, BenchStatus, CHANNELS, Flags, Root, SCHEMA, Scope, StepLayout, WireError, channels_of, header};

use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, print_text};

/// Options of `whirl wire`.
#[derive(Debug, clap::Args)]
pub(crate) struct WireArgs {
    #[command(flatten)]
    bench: BenchArgs,
    /// Print the C header of all messages, whirl.h
    #[arg(long, conflicts_with_all = ["bench", "json", "csv"])]
    header: bool,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document {
    schema: u32,
    version: &'static str,
    /// The root of this user's benches.
    root: String,
    iceoryx2: Iceoryx2,
    bench: BenchOnWire,
    services: Vec<ServiceEntry>,
    state: State,
    messages: Vec<Message>,
    constants: BTreeMap<String, usize>,
}

/// What iceoryx2 is to be configured with.
#[derive(Debug, Serialize)]
struct Iceoryx2 {
    version: &'static str,
    root: String,
    prefix: String,
    schema_attribute: &'static str,
}

/// The bench that was asked for; what only a running one can say is `null` of another.
#[derive(Debug, Serialize)]
struct BenchOnWire {
    name: String,
    running: bool,
    rotor: Option<String>,
    masses: Option<usize>,
    bearings: Option<usize>,
    /// Words of a step.
    width: Option<usize>,
    /// Every word of a step, in order.
    columns: Option<Vec<ColumnEntry>>,
    /// `w0` in rad/s, `K_t` in N/m, `M_t` in kg, `e_t` in m, of a rotor in SI units.
    scales: Option<[f64; 4]>,
}

#[derive(Debug, Serialize)]
struct ColumnEntry {
    place: usize,
    name: String,
    #[serde(rename = "type")]
    kind: &'static str,
    unit: &'static str,
    meaning: String,
}

#[derive(Debug, Serialize)]
struct ServiceEntry {
    name: String,
    pattern: &'static str,
    hash: String,
    /// Its description, made by iceoryx2 while it is there.
    file: String,
    from: &'static str,
    payload: Option<PayloadEntry>,
    user_header: Option<&'static str>,
    answer: Option<&'static str>,
    buffered: usize,
    kept: usize,
    places: usize,
    meaning: &'static str,
}

#[derive(Debug, Serialize)]
struct PayloadEntry {
    #[serde(rename = "type")]
    kind: &'static str,
    is_slice: bool,
    /// Elements of the longest slice.
    at_most: usize,
}

/// How the words of a step are laid out.
#[derive(Debug, Serialize)]
struct State {
    /// Words of each scope: `once + mass * masses + sensor * sensors + further * (bearings - 1)` are a row.
    words: Scopes,
    channels: Vec<Channel>,
    flags: Vec<FlagEntry>,
}

#[derive(Debug, Serialize)]
struct Scopes {
    once: usize,
    mass: usize,
    sensor: usize,
    further: usize,
}

#[derive(Debug, Serialize)]
struct Channel {
    name: &'static str,
    scope: &'static str,
    /// Among the words of its scope.
    place: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    unit: &'static str,
    meaning: &'static str,
}

#[derive(Debug, Serialize)]
struct FlagEntry {
    name: String,
    mask: u32,
    meaning: &'static str,
}

#[derive(Debug, Serialize)]
struct Message {
    #[serde(rename = "type")]
    name: &'static str,
    c: String,
    size: usize,
    meaning: String,
    fields: Vec<FieldEntry>,
}

#[derive(Debug, Serialize)]
struct FieldEntry {
    name: &'static str,
    offset: usize,
    #[serde(rename = "type")]
    element: &'static str,
    shape: Vec<usize>,
    meaning: String,
}

impl BenchOnWire {
    fn new(name: &BenchName, told: Option<&BenchStatus>) -> Self {
        let layout = told.map(|status| {
            StepLayout::new(status.masses as usize).with_bearings(status.settings.get().feedback.bearings.len())
        });
        let columns = layout.map(|layout| {
            let column = |(place, column): (usize, wire::Column)| ColumnEntry {
                place,
                name: column.name(),
                kind: kind(column.channel),
                unit: column.channel.row().dimension.unit(),
                meaning: column.meaning(),
            };
            layout.columns().enumerate().map(column).collect()
        });
        Self {
            name: name.to_string(),
            running: told.is_some(),
            rotor: told.map(|status| status.rotor_name.as_str().to_owned()),
            masses: layout.map(StepLayout::masses),
            bearings: layout.map(StepLayout::bearings),
            width: layout.map(StepLayout::width),
            columns,
            scales: told.filter(|status| status.scales().is_some()).map(|status| status.scales),
        }
    }
}

fn kind(channel: wire::Channel) -> &'static str {
    if channel.is_number() { "f64" } else { "u64" }
}

fn scope_name(scope: Scope) -> &'static str {
    match scope {
        Scope::Once => "once",
        Scope::Mass => "mass",
        Scope::Sensor => "sensor",
        Scope::Further => "further",
    }
}

impl State {
    fn new() -> Self {
        let channel = |row: &wire::ChannelRow| Channel {
            name: row.name,
            scope: scope_name(row.scope),
            place: row.channel.place_in_scope(),
            kind: kind(row.channel),
            unit: row.dimension.unit(),
            meaning: row.meaning,
        };
        let flag = |(name, Flags(mask), meaning): (&str, Flags, &'static str)| FlagEntry {
            name: name.to_ascii_lowercase(),
            mask,
            meaning,
        };
        let [once, mass, sensor, further] = [Scope::Once, Scope::Mass, Scope::Sensor, Scope::Further].map(channels_of);
        Self {
            words: Scopes { once, mass, sensor, further },
            channels: CHANNELS.iter().map(channel).collect(),
            flags: header::FLAGS.into_iter().map(flag).collect(),
        }
    }
}

impl ServiceEntry {
    fn new(service: &Service, root: &Root, bench: &BenchName) -> Result<Self, WireError> {
        let hash = service.hash(bench)?;
        let file = root.iceoryx2().join("services").join(format!("{}{hash}.service", root.prefix()));
        Ok(Self {
            name: service.name(bench),
            pattern: service.pattern.name(),
            file: file.display().to_string(),
            hash,
            from: service.from,
            payload: match service.payload {
                Payload::None => None,
                Payload::One(kind) => Some(PayloadEntry { kind, is_slice: false, at_most: 1 }),
                Payload::Slice(kind, at_most) => Some(PayloadEntry { kind, is_slice: true, at_most }),
            },
            user_header: service.header,
            answer: service.answer,
            buffered: service.buffered,
            kept: service.kept,
            places: service.parties,
            meaning: service.meaning,
        })
    }
}

fn messages() -> Vec<Message> {
    let field = |field: wire::Field| FieldEntry {
        name: field.name,
        offset: field.offset,
        element: field.element,
        shape: field.shape,
        meaning: field.meaning,
    };
    let message = |table: wire::MessageTable| Message {
        name: table.name,
        c: format!("struct {}", table.c_name),
        size: table.size,
        meaning: table.meaning,
        fields: table.fields.into_iter().map(field).collect(),
    };
    header::messages().into_iter().map(message).collect()
}

/// Prints how benches are found, and what this one sends if it runs.
///
/// # Errors
/// Not a bench name, a root that cannot be used, or a bench of another version.
pub(crate) fn run(args: &WireArgs) -> Result<(), Failure> {
    if args.header {
        return print_text(&header::text());
    }
    let name = args.bench.name()?;
    let carrier = attach::carrier("wire")?;
    let root = Root::from_environment()?;
    // One that does not run has services all the same: those that it will have.
    let told = match attach::glance(&carrier, &name) {
        Ok(mut glance) => Some(attach::first_bench_status(&mut glance, &name)?),
        Err(WireError::NoBench(_)) => None,
        Err(error) => return Err(error.into()),
    };
    let services: Result<Vec<ServiceEntry>, WireError> =
        SERVICES.iter().map(|service| ServiceEntry::new(service, &root, &name)).collect();
    let document = Document {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        root: root.path().display().to_string(),
        iceoryx2: Iceoryx2 {
            version: ICEORYX2,
            root: root.iceoryx2().display().to_string(),
            prefix: root.prefix().to_owned(),
            schema_attribute: SCHEMA_ATTRIBUTE,
        },
        bench: BenchOnWire::new(&name, told.as_deref()),
        services: services?,
        state: State::new(),
        messages: messages(),
        constants: header::CONSTANTS.map(|(name, value, _)| (name.to_ascii_lowercase(), value)).into(),
    };
    let mut table = Table::new(&["service", "pattern", "message", "header", "waits", "kept", "places", "hash"]);
    for service in &document.services {
        let payload = service.payload.as_ref().map_or_else(
            || "-".to_owned(),
            |payload| if payload.is_slice { format!("slice of {}", payload.kind) } else { payload.kind.to_owned() },
        );
        let answer = service.answer.map_or_else(String::new, |answer| format!(", answered by {answer}"));
        table.row([
            Cell::from(&service.name),
            Cell::from(&service.pattern),
            Cell::from(&(payload + &answer)),
            Cell::from(&service.user_header.unwrap_or("-")),
            Cell::from(&service.buffered),
            Cell::from(&service.kept),
            Cell::from(&service.places),
            Cell::from(&service.hash),
        ]);
    }
    let Document { iceoryx2, bench, schema, .. } = &document;
    let heading =
        format!("schema {schema}; iceoryx2 {}: root {}, prefix {}", iceoryx2.version, iceoryx2.root, iceoryx2.prefix);
    let footer = match (bench.width, &bench.rotor) {
        (Some(width), Some(rotor)) => format!("{} runs {rotor}: a step has {width} words", bench.name),
        _ => format!("no bench '{}' is running: these are the services that it will have", bench.name),
    };
    args.format.print(&document, &heading, &table, &footer)
}
