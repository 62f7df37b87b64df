//! What sits on the shaft, holds it, or measures it.

use std::ops::Range as Span;

use text::{Domain, Table, Value};
use toml::de::DeValue;

use super::read::Reading;
use crate::{Amount, Bearing, Coefficient, Disc, ImportedController, Magnetic, Pedestal, PointMass, Sensor, Unbalance};

/// Reads all parts.
pub(super) fn all(reading: &mut Reading<'_, '_, '_>) {
    let keys = ["station", "mass", "polar_inertia", "diametral_inertia", "outer", "inner", "width", "material"];
    for (i, (table, at)) in reading.tables("disc", &keys).into_iter().enumerate() {
        let disc = disc(reading, table, (&format!("[[disc]] {}", i + 1), at));
        reading.sketch.discs.push(disc);
    }
    for (i, (table, at)) in reading.tables("point_mass", &["station", "mass"]).into_iter().enumerate() {
        let within = format!("[[point_mass]] {}", i + 1);
        let station = reading.station(table, (&within, at.clone()), "station");
        let mass = reading.reader.required(table, (&within, at), "mass", Domain::NotNegative);
        reading.sketch.point_masses.push(PointMass { station, mass });
    }
    for (i, (table, at)) in
        reading.tables("pedestal", &["mass", "stiffness", "damping", "cross_stiffness"]).into_iter().enumerate()
    {
        let reader = &mut reading.reader;
        let mass = reader.required(table, (&format!("[[pedestal]] {}", i + 1), at), "mass", Domain::Positive);
        let [stiffness, damping] =
            ["stiffness", "damping"].map(|key| reader.number(table, key, Domain::NotNegative).unwrap_or(0.0));
        let cross_stiffness = reader.number(table, "cross_stiffness", Domain::Finite).unwrap_or(0.0);
        reading.sketch.pedestals.push(Pedestal { mass, stiffness, damping, cross_stiffness });
    }
    let keys = ["station", "stiffness", "damping", "cross_stiffness", "cross_damping", "mass", "clearance", "pedestal"];
    for (i, (table, at)) in reading.tables("bearing", &keys).into_iter().enumerate() {
        let mut bearing = bearing(reading, table, (&format!("[[bearing]] {}", i + 1), at));
        bearing.clearance = reading.reader.number(table, "clearance", Domain::NotNegative).unwrap_or(0.0);
        if table.contains_key("pedestal") {
            let pedestals = reading.sketch.pedestals.len();
            bearing.pedestal = reading.reader.counted(table, "pedestal", pedestals, "a [[pedestal]] of the file");
        }
        reading.sketch.bearings.push(bearing);
    }
    for (i, (table, at)) in reading.tables("seal", &keys[..6]).into_iter().enumerate() {
        let seal = bearing(reading, table, (&format!("[[seal]] {}", i + 1), at));
        reading.sketch.seals.push(seal);
    }
    let mut keys = vec![
        "name",
        "station",
        "sensor",
        "force_per_current",
        "negative_stiffness",
        "clearance",
        "touchdown_stiffness",
        "controller",
    ];
    keys.extend(reading.also.magnetic);
    for (i, (table, at)) in reading.tables("magnetic", &keys).into_iter().enumerate() {
        let magnetic = magnetic(reading, table, i, at);
        reading.sketch.magnetics.push(magnetic);
    }
    for (i, (table, at)) in reading.tables("sensor", &["name", "station"]).into_iter().enumerate() {
        let station = reading.station(table, (&format!("[[sensor]] {}", i + 1), at), "station");
        let name = name(reading, table, || format!("s{}", i + 1));
        reading.sketch.sensors.push(Sensor { name, station });
    }
    let keys = ["station", "angle", "gmm", "mass", "radius", "grade", "speed"];
    for (i, (table, at)) in reading.tables("unbalance", &keys).into_iter().enumerate() {
        let unbalance = unbalance(reading, table, (&format!("[[unbalance]] {}", i + 1), at));
        reading.sketch.unbalances.push(unbalance);
    }
}

/// A name, or what stands for it.
fn name(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>, otherwise: impl Fn() -> String) -> String {
    reading.reader.string(table, "name", "a name in quotes").map_or_else(otherwise, str::to_owned)
}

/// A disc by its numbers or by its shape.
fn disc(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>, within: (&str, Span<usize>)) -> Disc {
    let station = reading.station(table, within.clone(), "station");
    let given = |keys: &[&'static str]| keys.iter().copied().filter(|key| table.contains_key(*key)).collect::<Vec<_>>();
    let numbers = given(&["mass", "polar_inertia", "diametral_inertia"]);
    let shape = given(&["outer", "inner", "width", "material"]);
    if !numbers.is_empty() && !shape.is_empty() {
        let found = format!("{} with {} and {}", within.0, numbers[0], shape[0]);
        let expected = "either mass, polar_inertia and diametral_inertia, or outer, inner, width and material";
        reading.reader.fault(within.1, found, expected);
        return Disc { station, mass: f64::NAN, polar_inertia: f64::NAN, diametral_inertia: f64::NAN };
    }
    if shape.is_empty() {
        let mut required = |key| reading.reader.required(table, within.clone(), key, Domain::NotNegative);
        let (mass, polar_inertia) = (required("mass"), required("polar_inertia"));
        return Disc { station, mass, polar_inertia, diametral_inertia: required("diametral_inertia") };
    }
    let material = reading.material(table, within.clone());
    let density = reading.sketch.materials.get(material).map_or(f64::NAN, |material| material.density);
    let reader = &mut reading.reader;
    let [outer, width] = ["outer", "width"].map(|key| reader.required(table, within.clone(), key, Domain::Positive));
    let inner = reader.number(table, "inner", Domain::NotNegative).unwrap_or(0.0);
    if let Some(value) = table.get("inner").filter(|_| inner >= outer) {
        reader.wrong("inner", value, format!("less than the outer diameter, {outer}"));
    }
    Disc::of_shape(station, outer, inner, width, density)
}

/// A bearing without its clearance, or a seal.
fn bearing(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>, within: (&str, Span<usize>)) -> Bearing {
    let station = reading.station(table, within, "station");
    let mut over = |key: &str| table.get(key).map_or(Coefficient::ZERO, |value| coefficient(reading, key, value));
    let (stiffness, damping) = (over("stiffness"), over("damping"));
    let (cross_stiffness, cross_damping) = (over("cross_stiffness"), over("cross_damping"));
    let mass = reading.reader.number(table, "mass", Domain::NotNegative).unwrap_or(0.0);
    Bearing { station, stiffness, damping, cross_stiffness, cross_damping, mass, clearance: 0.0, pedestal: None }
}

/// A number, or a table over speed.
fn coefficient(reading: &mut Reading<'_, '_, '_>, key: &str, value: &Value<'_>) -> Coefficient {
    let expected = "a finite number or { speed = [..], value = [..] }";
    let reader = &mut reading.reader;
    let DeValue::Table(table) = value.get_ref() else {
        let number = text::as_number(value).filter(|number| number.is_finite());
        if number.is_none() {
            reader.wrong(key, value, expected);
        }
        return Coefficient::Constant(number.unwrap_or(f64::NAN));
    };
    if !(table.contains_key("speed") && table.contains_key("value")) {
        reader.wrong(key, value, expected);
        return Coefficient::Constant(f64::NAN);
    }
    reader.only(table, &["speed", "value"]);
    let speeds = reader.numbers(table, "speed", "speeds in rpm").unwrap_or_default();
    let values = reader.numbers(table, "value", "values").unwrap_or_default();
    if speeds.len() != values.len() || speeds.is_empty() {
        let found = format!("{key} with {} speeds and {} values", speeds.len(), values.len());
        reader.fault(value.span(), found, "as many values as speeds, at least one");
        return Coefficient::Constant(f64::NAN);
    }
    let mut risen = true;
    for pair in speeds.windows(2) {
        let [(before, _), (after, at)] = pair else { continue };
        if after <= before {
            reader.fault(at.clone(), format!("speed {after} after {before}"), "rising speeds");
            risen = false;
        }
    }
    if let Some((speed, at)) = speeds.iter().find(|(speed, _)| *speed < 0.0) {
        reader.fault(at.clone(), format!("speed {speed}"), "speeds of at least 0, in rpm");
        risen = false;
    }
    if !risen {
        return Coefficient::Constant(f64::NAN);
    }
    Coefficient::Table(speeds.into_iter().zip(values).map(|((speed, _), (value, _))| (speed, value)).collect())
}

fn magnetic(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>, index: usize, at: Span<usize>) -> Magnetic {
    let within = format!("[[magnetic]] {}", index + 1);
    let station = reading.station(table, (&within, at.clone()), "station");
    let sensor =
        if table.contains_key("sensor") { reading.station(table, (&within, at.clone()), "sensor") } else { station };
    let name = name(reading, table, || format!("m{}", index + 1));
    let reader = &mut reading.reader;
    let force_per_current = reader.required(table, (&within, at.clone()), "force_per_current", Domain::Positive);
    let negative_stiffness = reader.required(table, (&within, at), "negative_stiffness", Domain::NotNegative);
    Magnetic {
        name,
        station,
        sensor,
        force_per_current,
        negative_stiffness,
        clearance: reader.number(table, "clearance", Domain::NotNegative).unwrap_or(0.0),
        touchdown_stiffness: reader.number(table, "touchdown_stiffness", Domain::Positive),
        controller: table.get("controller").and_then(|value| controller(reading, value)),
    }
}

/// `controller = { numerator = [..], denominator = [..] }`.
fn controller(reading: &mut Reading<'_, '_, '_>, value: &Value<'_>) -> Option<ImportedController> {
    let DeValue::Table(table) = value.get_ref() else {
        let expected = "{ numerator = [..], denominator = [..] }, falling powers of s in 1/s, A/m";
        reading.reader.wrong("controller", value, expected);
        return None;
    };
    reading.reader.only(table, &["numerator", "denominator"]);
    let mut list = |key: &str| {
        let list = reading.reader.numbers(table, key, "coefficients in falling powers of s").unwrap_or_default();
        list.into_iter().map(|(c, _)| c).collect::<Vec<_>>()
    };
    let controller = ImportedController { numerator: list("numerator"), denominator: list("denominator") };
    // What is no number has been told already.
    let told = controller.numerator.iter().chain(&controller.denominator).any(|c| c.is_nan());
    (!told).then_some(controller)
}

fn unbalance(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>, within: (&str, Span<usize>)) -> Unbalance {
    let station = reading.station(table, within.clone(), "station");
    let reader = &mut reading.reader;
    let angle = reader.number(table, "angle", Domain::Finite).unwrap_or(0.0);
    let has = |key: &str| table.contains_key(key);
    let amount = match (has("gmm"), has("mass") || has("radius"), has("grade")) {
        (true, false, false) => {
            Amount::GramMillimetres(reader.number(table, "gmm", Domain::NotNegative).unwrap_or(f64::NAN))
        }
        (false, true, false) => {
            let mut required = |key| reader.required(table, within.clone(), key, Domain::NotNegative);
            // 1 kg m is a million g mm.
            Amount::GramMillimetres(required("mass") * required("radius") * 1e6)
        }
        (false, false, true) => grade(reading, table),
        _ => {
            let expected = "one of gmm = U, or mass = M and radius = R, or grade = \"G2.5\"";
            reader.fault(within.1, format!("{} without an amount, or with several", within.0), expected);
            return Unbalance { station, amount: Amount::GramMillimetres(f64::NAN), angle };
        }
    };
    if let Some(value) = table.get("speed").filter(|_| !has("grade")) {
        reading.reader.wrong("speed", value, "grade = \"G2.5\" beside it: the speed is what a grade is for");
    }
    Unbalance { station, amount, angle }
}

/// `grade = "G2.5"`, and the speed in rpm that it is for.
fn grade(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>) -> Amount {
    let expected = "a balance grade of ISO 21940-11 in quotes, such as \"G2.5\"";
    let reader = &mut reading.reader;
    let speed = reader.number(table, "speed", Domain::Positive);
    let typed = reader.string(table, "grade", expected).map(str::to_owned);
    let number = typed.as_deref().map(|typed| {
        let plain = typed.strip_prefix(['G', 'g']).unwrap_or("").trim();
        plain.parse().ok().filter(|number| Domain::Positive.admits(*number)).unwrap_or(f64::NAN)
    });
    if let (Some(value), true) = (table.get("grade"), number.is_some_and(f64::is_nan)) {
        reader.wrong("grade", value, expected);
    }
    Amount::Grade { millimetres_per_second: number.unwrap_or(f64::NAN), speed }
}
