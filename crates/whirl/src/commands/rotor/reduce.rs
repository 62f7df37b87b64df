//! `whirl rotor reduce`: which places stand for a rotor of shaft elements, and what is lost by it.

use serde::Serialize;
use units::Dimension;

use crate::catalog;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, rounded};
use crate::quantity::{self, QuantityRange, TypedQuantity};
use crate::units::CommandUnits;

/// Options of `whirl rotor reduce`.
#[derive(Debug, clap::Args)]
pub(super) struct ReduceArgs {
    /// The rotor: rig, or a TOML file with sections
    #[arg(value_name = "ROTOR")]
    rotor: String,
    /// Look at this range of spin speeds (in rpm, or as it says)
    #[arg(long, value_name = "A..B", default_value = "0..6000", value_parser = quantity::range(Dimension::Speed))]
    over: QuantityRange,
    /// How many speeds of the range to look at
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(2..=1000))]
    points: u32,
    /// Compare poles up to this frequency (in Hz, or as it says) [default: ten times the highest speed, at least that of the fourth mode]
    #[arg(long, value_name = "HZ", value_parser = quantity::of(Dimension::Frequency))]
    up_to: Option<TypedQuantity>,
    /// Keep this many coordinates in place of those of the file
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16))]
    coordinates: Option<u32>,
    /// Fail if a pole is off by more than this part of its size
    #[arg(long, value_name = "PART")]
    check: Option<f64>,
    #[command(flatten)]
    format: Format,
}

#[derive(Serialize)]
struct Document<'a> {
    rotor: &'a str,
    full: usize,
    kept: usize,
    places: Vec<Placed>,
    condition: f64,
    up_to_hz: f64,
    worst_frequency: f64,
    worst_damping: f64,
    poles: Vec<Compared>,
}

#[derive(Serialize)]
struct Placed {
    place: usize,
    name: String,
    position: f64,
    station: Option<usize>,
}

#[derive(Serialize)]
struct Compared {
    rpm: f64,
    full: Pole,
    reduced: Pole,
    frequency_error: f64,
    damping_error: f64,
}

#[derive(Serialize)]
struct Pole {
    re: f64,
    im: f64,
}

const COLUMNS: [&str; 6] = ["at (rpm)", "full (1/s)", "full (rad/s)", "off by (part)", "damping", "damping off by"];

pub(super) fn run(args: &ReduceArgs) -> Result<(), Failure> {
    let rotor = catalog::rotor(&args.rotor)?;
    let Some(beam) = rotor.beam() else {
        let why = "a chain of masses is stepped in its own coordinates: nothing is reduced";
        return Err(Failure::Usage(format!("{}: {why}", rotor.name())));
    };
    let units = CommandUnits::of(&rotor);
    let (full, own) = (beam.full(), beam.reduced());
    let asked = args.coordinates.map(|n| full.reduce(beam.drawing(), n as usize)).transpose();
    let asked = asked.map_err(|error| Failure::Usage(error.to_string()))?;
    let reduced = asked.as_ref().unwrap_or(own);
    // Of a drawing in SI units everything is per second.
    let w0 = rotor.scales().map_or(1.0, |scales| scales.w0);
    let over = units.read_range("--over", args.over)?;
    let speeds: Vec<f64> = over.points(args.points as usize).iter().map(|speed| speed * w0).collect();
    let failed = |error: beam::PoleError| Failure::Work(error.to_string());
    let up_to = match args.up_to {
        Some(typed) => match units.read("--up-to", typed)? * w0 {
            up_to if up_to.is_finite() && up_to > 0.0 => up_to,
            _ => return Err(Failure::Usage(format!("--up-to {typed}: expected a finite number greater than 0"))),
        },
        None => {
            let mut frequencies: Vec<f64> =
                full.eigenvalues(0.0).map_err(failed)?.iter().map(|s| s.im.abs()).filter(|w| *w > 0.0).collect();
            frequencies.sort_by(f64::total_cmp);
            // Each mode is there twice: forward and backward.
            let fourth = frequencies.get(7).copied().unwrap_or(f64::INFINITY);
            (10.0 * over.to * w0).max(1.01 * fourth)
        }
    };
    let lost = beam::lost(full, reduced, &speeds, up_to).map_err(failed)?;
    let mut table = Table::new(&COLUMNS);
    for of in &lost.poles {
        table.row([
            Cell::from(rpm(of.speed)),
            Cell::from(of.full.re),
            Cell::from(of.full.im),
            Cell::from(of.frequency),
            Cell::from(-of.full.re / of.full.norm()),
            Cell::from(of.damping),
        ]);
    }
    let places: Vec<Placed> = (reduced.stations.iter().enumerate())
        .map(|(k, place)| Placed {
            place: k + 1,
            name: if asked.is_some() { place.name.clone() } else { rotor.place_name(k) },
            position: place.position,
            station: place.station.map(|station| station + 1),
        })
        .collect();
    let pole = |s: beam::C64| Pole { re: s.re, im: s.im };
    let document = Document {
        rotor: rotor.name(),
        full: full.mass.nrows(),
        kept: reduced.coordinates(),
        condition: reduced.condition,
        up_to_hz: up_to / std::f64::consts::TAU,
        worst_frequency: lost.worst_frequency(),
        worst_damping: lost.worst_damping(),
        poles: (lost.poles.iter())
            .map(|of| Compared {
                rpm: rpm(of.speed),
                full: pole(of.full),
                reduced: pole(of.reduced),
                frequency_error: of.frequency,
                damping_error: of.damping,
            })
            .collect(),
        places,
    };
    let heading = format!(
        "{}: {} coordinates for {}, without control; poles below {} Hz",
        rotor.name(),
        document.kept,
        document.full,
        rounded(document.up_to_hz)
    );
    let listed: Vec<String> =
        document.places.iter().map(|place| format!("{} ({} m)", place.name, rounded(place.position))).collect();
    let footer = format!(
        "worst: frequency off by {}, damping ratio by {}\nplaces: {}\n1 in e_t is {} m; R = 1 is {} rpm",
        rounded(document.worst_frequency),
        rounded(document.worst_damping),
        listed.join(", "),
        rounded(units.scales().map_or(f64::NAN, |scales| scales.e_t)),
        rounded(units.scales().map_or(f64::NAN, |scales| scales.rpm(1.0))),
    );
    args.format.print(&document, &heading, &table, &footer)?;
    match args.check {
        Some(most) if document.worst_frequency > most => Err(Failure::Work(format!(
            "{}: a pole below {} Hz is off by {}, more than {most}",
            rotor.name(),
            rounded(document.up_to_hz),
            rounded(document.worst_frequency)
        ))),
        _ => Ok(()),
    }
}

const RAD_PER_S: f64 = std::f64::consts::PI / 30.0;

/// Revolutions per minute of radians per second, without what the way through `w0` leaves in the last places.
fn rpm(speed: f64) -> f64 {
    text::number::significant(speed / RAD_PER_S, 12)
}
