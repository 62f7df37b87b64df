//! Feedback as a document for scripts, with the keys of its file.

use control::{PARTS, Parts};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::feedback_text::sensor;
use crate::{ControlBearing, Feedback, Gain, GainKind, Signal};

/// Feedback that serialises to the content of its file: `{bearing, filter, signal: [{mass | displacement, velocity, kd, cd, kc,
/// cc, filter}], loop}`, masses counted from 1; of several control bearings `{bearing: [{name, station, ..the same..}]}`.
#[derive(Clone, Copy, Debug)]
pub struct FeedbackDocument<'a>(pub &'a Feedback);

impl Serialize for FeedbackDocument<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match is_plain(self.0) {
            Some(bearing) => {
                map.serialize_entry("bearing", &(bearing.station + 1))?;
                entries(bearing, &mut map)?;
            }
            None => {
                map.serialize_entry("bearing", &self.0.bearings.iter().map(BearingDocument).collect::<Vec<_>>())?;
            }
        }
        map.end()
    }
}

/// The one bearing of feedback whose file says it by a number alone.
pub(super) fn is_plain(feedback: &Feedback) -> Option<&ControlBearing> {
    feedback.only().filter(|bearing| bearing.name.is_none())
}

struct BearingDocument<'a>(&'a ControlBearing);

impl Serialize for BearingDocument<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        if let Some(name) = &self.0.name {
            map.serialize_entry("name", name)?;
        }
        map.serialize_entry("station", &(self.0.station + 1))?;
        entries(self.0, &mut map)?;
        map.end()
    }
}

/// What drives a bearing.
fn entries<M: SerializeMap>(bearing: &ControlBearing, map: &mut M) -> Result<(), M::Error> {
    if !bearing.filters.is_empty() {
        map.serialize_entry("filter", &bearing.filters)?;
    }
    map.serialize_entry("signal", &bearing.signals.iter().map(SignalDocument).collect::<Vec<_>>())?;
    if bearing.parts != Parts::default() {
        map.serialize_entry("loop", &LoopDocument(&bearing.parts))?;
    }
    Ok(())
}

struct SignalDocument<'a>(&'a Signal);

impl Serialize for SignalDocument<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        if let Some(mass) = sensor(self.0) {
            map.serialize_entry("mass", &(mass + 1))?;
        } else {
            map.serialize_entry("displacement", &self.0.displacement)?;
            map.serialize_entry("velocity", &self.0.velocity)?;
        }
        for kind in GainKind::ALL {
            map.serialize_entry(kind.name(), &GainDocument::of(self.0.gain(kind)))?;
        }
        if !self.0.filters.is_empty() {
            map.serialize_entry("filter", &self.0.filters)?;
        }
        map.end()
    }
}

/// The parts of the loop that are there.
struct LoopDocument<'a>(&'a Parts);

impl Serialize for LoopDocument<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let present = PARTS.iter().map(|part| (part.name, (part.get)(self.0), part.absent));
        serializer
            .collect_map(present.filter(|(_, value, absent)| value != absent).map(|(name, value, _)| (name, value)))
    }
}

/// A gain as its file says it.
#[derive(Serialize)]
#[serde(untagged)]
enum GainDocument {
    Constant(f64),
    Linear { at_zero: f64, slope: f64 },
    Table { speed: Vec<f64>, value: Vec<f64> },
}

impl GainDocument {
    fn of(gain: &Gain) -> Self {
        match gain {
            Gain::Constant(value) => Self::Constant(*value),
            Gain::Linear { at_zero, slope } => Self::Linear { at_zero: *at_zero, slope: *slope },
            Gain::Table(points) => {
                let (speed, value) = points.iter().copied().unzip();
                Self::Table { speed, value }
            }
        }
    }
}
