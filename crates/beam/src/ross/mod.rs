//! Rotors from files of ROSS, TOML and JSON, of its versions 2.3 and 3.
//!
//! Such a file is one table an element, named `ClassName_tag`, with the node `n` that it is at. What is the same in every direction
//! becomes part of the drawing; nodes become stations. What is not is refused by its name, with the numbers that break it, unless
//! their mean is asked for.

mod bearing;
mod document;
mod magnetic;
mod pedestal;
mod shaft;

use std::fmt;

use text::{Fault, Faults};

use crate::check::{is_key, is_name};
use crate::{Disc, Drawing, MAX_NAME, PointMass, Sketch};
use bearing::bearing;
use document::{Document, Element, Value};
use magnetic::{is_magnetic, magnetic};
use pedestal::{part, pedestal_of, pedestals};
use shaft::shaft;

/// Something about an import that whoever asked for it should know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The element, as the file names it; empty for the whole file.
    pub element: String,
    /// What there is to know.
    pub text: String,
    /// Whether it tells of numbers that were averaged, so that this is not the machine of the file.
    pub averaged: bool,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.element.as_str() {
            "" => f.write_str(&self.text),
            element => write!(f, "{element}: {}", self.text),
        }
    }
}

/// An import under way.
struct Import<'t> {
    document: Document<'t>,
    sketch: Sketch,
    notes: Vec<Note>,
    /// Whether to take the mean of what differs between directions.
    average: bool,
    /// How many nodes the shaft has.
    nodes: usize,
    /// Which nodes beyond the shaft are pedestals.
    pedestal_nodes: Vec<f64>,
    /// Which element of the file each table of the drawing is from.
    origins: Vec<(&'static str, usize, usize)>,
}

/// Classes that are springs and dampers by tables over speed.
const BEARINGS: [&str; 10] = [
    "BearingElement",
    "BallBearingElement",
    "RollerBearingElement",
    "CylindricalBearing",
    "BearingFluidFlow",
    "FluidFilmBearing",
    "PlainJournal",
    "TiltingPad",
    "SqueezeFilmDamper",
    "ThrustPad",
];
/// Classes that are seals.
const SEALS: [&str; 4] = ["SealElement", "LabyrinthSeal", "HolePatternSeal", "HybridSeal"];

/// Reads a rotor that ROSS has saved; `average` takes the mean where both directions differ. Its name is that of the file, which is
/// not known here: `rotor`.
///
/// # Errors
/// Everything that cannot be taken over, with its line: text that is neither TOML nor JSON, classes of elements that are not known,
/// shafts with gaps, and, unless averaged, whatever differs between two directions.
pub fn import_ross(text: &str, average: bool) -> Result<(Drawing, Vec<Note>), Faults> {
    let mut document = Document::parse(text)?;
    let elements = std::mem::take(&mut document.elements);
    let sketch = Sketch { name: "rotor".into(), ..Sketch::default() };
    let mut import =
        Import { document, sketch, notes: vec![], average, nodes: 0, pedestal_nodes: vec![], origins: vec![] };
    import.version();
    shaft(&mut import, &elements);
    pedestals(&mut import, &elements);
    for (at, element) in elements.iter().enumerate() {
        import.element(at, element);
    }
    import.finish(&elements)
}

impl Import<'_> {
    fn note(&mut self, element: &Element, text: impl Into<String>) {
        self.notes.push(Note { element: element.name.clone(), text: text.into(), averaged: false });
    }

    /// Notes that a mean was taken.
    fn averaged(&mut self, element: &Element, text: String) {
        self.notes.push(Note { element: element.name.clone(), text, averaged: true });
    }

    fn version(&mut self) {
        let version = self.document.version.clone();
        let known = version.as_deref().is_some_and(|v| v.starts_with("2.") || v.starts_with("3."));
        if !known {
            let text = match version {
                Some(version) => format!("written by version {version} of ROSS: read as if by 2.3 or 3"),
                None => "no version of ROSS in it: read as if by 2.3 or 3".into(),
            };
            self.notes.push(Note { element: String::new(), text, averaged: false });
        }
    }

    fn element(&mut self, at: usize, element: &Element) {
        if let Some(pedestal) = pedestal_of(self, element, "n") {
            part(self, pedestal, element);
            return;
        }
        match element.class() {
            "ShaftElement" | "CouplingElement" => {}
            "DiskElement" | "GearElement" => {
                let station = self.document.node(element, self.nodes);
                let [mass, diametral_inertia, polar_inertia] =
                    ["m", "Id", "Ip"].map(|key| self.document.number(element, key, None));
                self.origins.push(("disc", self.sketch.discs.len(), at));
                self.sketch.discs.push(Disc { station, mass, polar_inertia, diametral_inertia });
                if element.class() == "GearElement" {
                    self.note(element, "taken as a disc: its teeth are left out");
                }
            }
            "PointMass" => {
                let station = self.document.node(element, self.nodes);
                let mass = self.point_mass(element);
                self.origins.push(("point_mass", self.sketch.point_masses.len(), at));
                self.sketch.point_masses.push(PointMass { station, mass });
            }
            "MagneticBearingElement" => magnetic(self, at, element),
            _ if is_magnetic(element) => magnetic(self, at, element),
            class if BEARINGS.contains(&class) => {
                let station = self.document.node(element, self.nodes);
                if let Some(made) = bearing(self, element, station) {
                    self.origins.push(("bearing", self.sketch.bearings.len(), at));
                    self.sketch.bearings.push(made);
                }
            }
            class if SEALS.contains(&class) => {
                let station = self.document.node(element, self.nodes);
                if let Some(made) = bearing(self, element, station) {
                    self.origins.push(("seal", self.sketch.seals.len(), at));
                    self.sketch.seals.push(made);
                }
            }
            class => {
                let found = format!("{}: an element of class {class}", element.name);
                let expected =
                    "ShaftElement, CouplingElement, DiskElement, PointMass, or a class of bearings or seals of ROSS";
                self.document.fault(&element.span, found, expected);
            }
        }
    }

    /// The mass of a point mass.
    fn point_mass(&mut self, element: &Element) -> f64 {
        let whole = self.document.numbers(element, "m").first().copied();
        let [x, y] = ["mx", "my"].map(|key| self.document.number(element, key, Some(whole.unwrap_or(0.0))));
        self.mean(element, ("mx", x), ("my", y))
    }

    /// One value for both directions.
    fn mean(&mut self, element: &Element, (x_name, x): (&str, f64), (y_name, y): (&str, f64)) -> f64 {
        if x == y || x.is_nan() || y.is_nan() {
            return x;
        }
        let found = format!("{x_name} = {x}, {y_name} = {y}");
        if self.average {
            let mean = 0.5 * (x + y);
            self.averaged(element, format!("{found}: their mean {mean} is taken"));
            return mean;
        }
        let expected = format!("{y_name} = {x_name}: only what is the same in every direction, or their mean");
        self.document.fault(&element.span, format!("{}: {found}", element.name), expected);
        x
    }

    /// A name for a setting's key, made of the tag of an element.
    fn key(&self, element: &Element) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        let mut name: String = element.tag().chars().map(plain).collect();
        name.truncate(MAX_NAME - 4);
        if !is_key(&name) {
            name = format!("amb-{name}").trim_end_matches('-').to_owned();
        }
        let taken = |name: &str| self.sketch.magnetics.iter().any(|magnetic| magnetic.name == name);
        let mut numbered = (2..).map(|i| format!("{name}-{i}"));
        if taken(&name) { numbered.find(|name| !taken(name)).unwrap_or(name) } else { name }
    }

    fn finish(self, elements: &[Element]) -> Result<(Drawing, Vec<Note>), Faults> {
        let Self { document, sketch, notes, origins, .. } = self;
        let sort = |mut faults: Vec<Fault>| {
            faults.sort_by_key(|fault| fault.span.start);
            faults.truncate(Faults::MOST);
            Faults::some(faults)
        };
        let Document { faults, text, .. } = document;
        if let Some(faults) = sort(faults) {
            return Err(faults);
        }
        debug_assert!(is_name(&sketch.name));
        let drawing = Drawing::new(sketch).map_err(|error| {
            let faults = error.0.into_iter().map(|fault| {
                let origin = origins.iter().find(|(table, index, _)| (*table, *index) == (fault.table, fault.index));
                let element = origin.map(|&(_, _, at)| &elements[at]);
                let name = element.map_or(String::new(), |element| format!("{}: ", element.name));
                let span = element.map_or(0..0, |element| element.span.clone());
                Fault::at(text, span, format!("{name}{}", fault.found), fault.expected)
            });
            sort(faults.collect()).unwrap_or_else(|| Fault::at(text, 0..0, "no rotor", "one").into())
        })?;
        Ok((drawing, notes))
    }
}
