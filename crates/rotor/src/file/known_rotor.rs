//! The rotor that feedback is read for: what its places are called.

use crate::{BeamRotor, Rotor};

/// The rotor that feedback is read for, as far as it is known.
pub(super) struct KnownRotor<'r> {
    /// How many masses it has.
    pub(super) masses: usize,
    /// What a number of a mass is, in words that follow "expected".
    pub(super) of: &'static str,
    pub(super) rotor: Option<&'r Rotor>,
}

impl KnownRotor<'_> {
    pub(super) fn beam(&self) -> Option<&BeamRotor> {
        self.rotor.and_then(Rotor::beam)
    }

    /// The key by which a place is called.
    pub(super) fn key(&self) -> &'static str {
        if self.beam().is_some() { "station" } else { "mass" }
    }

    /// The largest number of a place.
    pub(super) fn most(&self) -> usize {
        self.beam().map_or(self.masses, |beam| beam.drawing().stations())
    }

    /// What is expected of a place.
    pub(super) fn words(&self) -> String {
        match self.beam() {
            Some(_) => "station = a number of the drawing, or the name of a magnetic bearing or sensor,".to_owned(),
            None => format!("mass = {}, 1 to {}", self.of, self.masses),
        }
    }

    /// The place of a magnetic bearing, sensor or named coordinate of that name: of a bearing where it pulls, or where it `senses`.
    pub(super) fn named(&self, name: &str, senses: bool) -> Option<usize> {
        let beam = self.beam()?;
        let magnetic = beam.drawing().magnetics.iter().find(|of| of.name == name);
        let magnetic = magnetic.map(|of| if senses { of.sensor } else { of.station });
        let sensor = || beam.drawing().sensors.iter().find(|of| of.name == name).map(|of| of.station);
        let coordinate = || beam.places().iter().position(|place| place.station.is_some() && place.name == name);
        magnetic.or_else(sensor).map_or_else(coordinate, |station| beam.coordinate(station))
    }
}
