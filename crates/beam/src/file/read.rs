//! The file as a whole.

use std::ops::Range as Span;

use text::{Domain, Faults, Reader, Table};
use toml::de::DeValue;

use super::shaft;
use super::{parts, plant};
use crate::check::{faults, is_name};
use crate::{Drawing, DrawingFault, MAX_NAME, Sketch};

/// Gives the bytes of a file by the name that another file has for it, or says why not, as `FOUND: expected EXPECTED`.
pub type Open = dyn Fn(&str) -> Result<Vec<u8>, String>;

/// What a file of a drawing may hold beside the drawing, because somebody else reads it.
#[derive(Clone, Copy, Default)]
pub struct Also<'a> {
    /// Keys at the top.
    pub file: &'a [&'a str],
    /// Keys of a `[[magnetic]]`.
    pub magnetic: &'a [&'a str],
    /// Opens the files of matrices that it names; without it those are refused.
    pub open: Option<&'a Open>,
}

/// Whether a file that was parsed is a drawing: it has sections, or a plant made of matrices.
#[must_use]
pub fn is_drawing(file: &Table<'_>) -> bool {
    file.contains_key("section") || file.contains_key("plant")
}

/// Reads a drawing; `default_name` is its name if the file gives none.
///
/// # Errors
/// All that is wrong with the file, with lines and columns.
///
/// ```
/// let drawing = beam::read(
///     r#"
///     units = "si"
///     [material.steel]
///     density = 7810.0
///     youngs_modulus = 211e9
///     poisson = 0.3
///     [[section]]
///     length = 0.5
///     outer = 0.05
///     elements = 4
///     [[bearing]]
///     station = 1
///     stiffness = 1e6
///     "#,
///     "shaft",
/// )?;
/// assert_eq!((drawing.name.as_str(), drawing.stations(), drawing.elements()), ("shaft", 2, 4));
///
/// let faults = beam::read("units = \"si\"\n[[section]]\nlength = 0.5\nouter = 0.0", "shaft").unwrap_err();
/// assert_eq!(
///     faults.in_file("shaft.toml"),
///     "shaft.toml:2:1: no material: expected [material.NAME] with density, youngs_modulus and shear_modulus\n\
///      shaft.toml:4:9: outer = 0.0: expected a finite number greater than 0"
/// );
/// # Ok::<(), text::Faults>(())
/// ```
pub fn read(text: &str, default_name: &str) -> Result<Drawing, Faults> {
    read_and(text, default_name, Also::default(), |_, _, _| ()).map(|(drawing, ())| drawing)
}

/// Reads a drawing and, with the same reader, what else the file holds under keys of `also`: `rest` gets the reader, the whole file
/// and the drawing, and notes what is wrong with its part.
///
/// # Errors
/// All that is wrong with the file, with lines and columns. `rest` is not asked about a file whose drawing is wrong.
pub fn read_and<T>(
    text: &str,
    default_name: &str,
    also: Also<'_>,
    rest: impl FnOnce(&mut Reader<'_>, &Table<'_>, &Drawing) -> T,
) -> Result<(Drawing, T), Faults> {
    let (mut reader, file) = Reader::parse(text)?;
    let mut known = vec![
        "name",
        "units",
        "reference_length",
        "coordinates",
        "mass_damping",
        "stiffness_damping",
        "plant",
        "material",
        "section",
        "sleeve",
        "disc",
        "point_mass",
        "pedestal",
        "bearing",
        "seal",
        "magnetic",
        "sensor",
        "unbalance",
    ];
    known.extend(also.file);
    reader.only(&file, &known);

    let mut reading = Reading { reader, file: &file, places: Vec::new(), sketch: Sketch::default(), also };
    reading.top(default_name);
    if file.contains_key("plant") {
        plant::plant(&mut reading);
        // Stations, and so all parts, are counted by what it holds.
        reading.reader.check()?;
    }
    shaft::materials(&mut reading);
    shaft::sections(&mut reading);
    parts::all(&mut reading);

    let Reading { mut reader, places, sketch, .. } = reading;
    for fault in faults(&sketch, true) {
        let place = places.iter().find(|place| (place.table, place.index) == (fault.table, fault.index));
        tell(&mut reader, place.map_or(&file, |place| place.keys), place, &fault);
    }
    reader.check()?;
    // Nothing is left to find, but only this makes a drawing.
    let drawing = Drawing::new(sketch).map_err(|error| text::Fault::at(text, 0..0, error.to_string(), "a drawing"))?;
    let rest = rest(&mut reader, &file, &drawing);
    reader.finish((drawing, rest))
}

/// Notes what is wrong with the drawing where it stands.
fn tell(reader: &mut Reader<'_>, keys: &Table<'_>, place: Option<&DrawnPart<'_, '_>>, fault: &DrawingFault) {
    let value = keys.get(fault.key).filter(|value| {
        // The place of a list of tables is its first.
        place.is_some() || !matches!(value.get_ref(), DeValue::Table(_))
    });
    let span = value.map(|value| value.span()).or(place.map(|place| place.span.clone())).unwrap_or(0..0);
    reader.fault(span, fault.found.clone(), fault.expected.clone());
}

/// Where one of the drawing's parts stands in the file.
pub(super) struct DrawnPart<'v, 'f> {
    table: &'static str,
    index: usize,
    keys: &'v Table<'f>,
    span: Span<usize>,
}

/// A drawing being read.
pub(super) struct Reading<'v, 'f, 'a> {
    pub(super) reader: Reader<'f>,
    pub(super) file: &'v Table<'f>,
    pub(super) sketch: Sketch,
    pub(super) also: Also<'a>,
    places: Vec<DrawnPart<'v, 'f>>,
}

impl<'v, 'f> Reading<'v, 'f, '_> {
    fn top(&mut self, default_name: &str) {
        let Self { reader, file, sketch, .. } = self;
        sketch.name = match file.get("name").map(|value| (value, value.get_ref())) {
            None => fitting(default_name),
            Some((_, DeValue::String(name))) if is_name(name) => name.to_string(),
            Some((value, _)) => {
                reader.wrong("name", value, format!("1 to {MAX_NAME} bytes of printable text in quotes"));
                fitting(default_name)
            }
        };
        if !file.contains_key("units") {
            reader.fault(0..0, "no units", "units = \"si\": a drawing has no others");
        }
        reader.choice(file, "units", &["si"]);
        sketch.reference_length = reader.number(file, "reference_length", Domain::Positive);
        sketch.coordinates =
            reader.counted(file, "coordinates", crate::MAX_COORDINATES, "a number of coordinates").map(|i| i + 1);
        sketch.mass_damping = reader.number(file, "mass_damping", Domain::NotNegative).unwrap_or(0.0);
        sketch.stiffness_damping = reader.number(file, "stiffness_damping", Domain::NotNegative).unwrap_or(0.0);
    }

    /// The tables `[[table]]`, each of `keys` only, with its place noted.
    pub(super) fn tables(&mut self, table: &'static str, keys: &[&str]) -> Vec<(&'v Table<'f>, Span<usize>)> {
        let file = self.file;
        let tables = self.reader.tables(file, table, None);
        for (index, (keys_there, span)) in tables.iter().enumerate() {
            self.reader.only(keys_there, keys);
            self.place(table, index, keys_there, span.clone());
        }
        tables
    }

    /// Notes where a part stands.
    pub(super) fn place(&mut self, table: &'static str, index: usize, keys: &'v Table<'f>, span: Span<usize>) {
        self.places.push(DrawnPart { table, index, keys, span });
    }

    /// The station under `key`, counted from 0.
    pub(super) fn station(&mut self, table: &Table<'_>, within: (&str, Span<usize>), key: &str) -> usize {
        let stations = self.sketch.station_count();
        self.reader.counted(table, key, stations, "a station of the shaft").unwrap_or_else(|| {
            let expected = format!("{key} = a station of the shaft, 1 to {stations}");
            self.reader.fault(within.1, format!("{} without {key}", within.0), expected);
            0
        })
    }

    /// Which material `key` names, counted from 0: it need not be named where there is only one.
    pub(super) fn material(&mut self, table: &Table<'_>, within: (&str, Span<usize>)) -> usize {
        let names: Vec<String> = self.sketch.materials.iter().map(|material| material.name.clone()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        if table.contains_key("material") {
            let chosen = self.reader.choice(table, "material", &names);
            return names.iter().position(|name| Some(*name) == chosen).unwrap_or(0);
        }
        if names.len() > 1 {
            let expected = format!("material = one of {}", names.join(", "));
            self.reader.fault(within.1, format!("{} without material", within.0), expected);
        }
        0
    }
}

/// What of `name` can be a rotor's name.
fn fitting(name: &str) -> String {
    let mut fitting: String = name.chars().filter(|c| !c.is_control()).collect();
    fitting.truncate(fitting.floor_char_boundary(MAX_NAME));
    if fitting.is_empty() { "rotor".into() } else { fitting }
}
