//! What can be wrong with what holds a rotor: bearings, pedestals and magnets.

use std::collections::BTreeSet;

use super::{At, Check};
use crate::drawing::{Bearing, Sketch};
use crate::{Coefficient, MAX_PEDESTALS};

impl Check {
    pub(super) fn bearing(&mut self, at: At, bearing: &Bearing) {
        self.station(at, "station", bearing.station);
        for (key, coefficient) in [
            ("stiffness", &bearing.stiffness),
            ("damping", &bearing.damping),
            ("cross_stiffness", &bearing.cross_stiffness),
            ("cross_damping", &bearing.cross_damping),
        ] {
            self.coefficient(at, key, coefficient);
        }
        self.not_negative(at, "mass", bearing.mass);
        self.not_negative(at, "clearance", bearing.clearance);
        if bearing.clearance > 0.0 && bearing.stiffness.values().any(|value| value < 0.0) {
            let expected = "a stiffness of at least 0 beside it: what is met behind a clearance pushes back";
            self.fault(at, "clearance", format!("clearance = {}", bearing.clearance), expected);
        }
    }

    /// A pedestal has to have mass, and something on it.
    pub(super) fn pedestals(&mut self, sketch: &Sketch) {
        let count = sketch.pedestals.len();
        if count > MAX_PEDESTALS {
            self.fault(
                ("pedestal", MAX_PEDESTALS),
                "",
                format!("{count} pedestals"),
                format!("at most {MAX_PEDESTALS}"),
            );
        }
        for (i, pedestal) in sketch.pedestals.iter().enumerate() {
            let at = ("pedestal", i);
            self.positive(at, "mass", pedestal.mass);
            self.not_negative(at, "stiffness", pedestal.stiffness);
            self.not_negative(at, "damping", pedestal.damping);
            self.finite(at, "cross_stiffness", pedestal.cross_stiffness);
            if !sketch.bearings.iter().any(|bearing| bearing.pedestal == Some(i)) {
                let expected = format!("pedestal = {} in a [[bearing]]: nothing stands on it", i + 1);
                self.fault(at, "", format!("pedestal {}", i + 1), expected);
            }
        }
        for (i, bearing) in sketch.bearings.iter().enumerate() {
            let Some(pedestal) = bearing.pedestal else { continue };
            let at = ("bearing", i);
            if pedestal >= count {
                let expected = if count == 0 { "a [[pedestal]] of the file".into() } else { format!("1 to {count}") };
                self.fault(at, "pedestal", format!("pedestal = {}", pedestal + 1), expected);
            }
            if bearing.clearance > 0.0 {
                let expected = "none beside pedestal: play is that of a bearing on the ground";
                self.fault(at, "clearance", format!("clearance = {}", bearing.clearance), expected);
            }
        }
    }

    fn coefficient(&mut self, at: At, key: &'static str, coefficient: &Coefficient) {
        match coefficient {
            Coefficient::Constant(value) => self.finite(at, key, *value),
            Coefficient::Table(points) => {
                if points.is_empty() {
                    self.fault(at, key, format!("{key} over no speeds"), "at least one speed and its value");
                }
                for (i, &(speed, value)) in points.iter().enumerate() {
                    if i > 0 && speed <= points[i - 1].0 {
                        let found = format!("{key} at speed {speed} after {}", points[i - 1].0);
                        self.fault(at, key, found, "rising speeds");
                    }
                    self.not_negative(at, key, speed);
                    self.finite(at, key, value);
                }
            }
        }
    }

    pub(super) fn magnetics(&mut self, sketch: &Sketch) {
        let mut names = BTreeSet::new();
        for (i, magnetic) in sketch.magnetics.iter().enumerate() {
            let at = ("magnetic", i);
            self.key(at, &magnetic.name, &mut names);
            self.station(at, "station", magnetic.station);
            self.station(at, "sensor", magnetic.sensor);
            self.positive(at, "force_per_current", magnetic.force_per_current);
            self.not_negative(at, "negative_stiffness", magnetic.negative_stiffness);
            self.not_negative(at, "clearance", magnetic.clearance);
            if let Some(stiffness) = magnetic.touchdown_stiffness {
                self.positive(at, "touchdown_stiffness", stiffness);
                if magnetic.clearance == 0.0 {
                    let expected = "clearance = G with it, the play of the touchdown bearing";
                    self.fault(at, "touchdown_stiffness", format!("touchdown_stiffness = {stiffness}"), expected);
                }
            }
            if let Some(controller) = &magnetic.controller {
                let (numerator, denominator) = (&controller.numerator, &controller.denominator);
                let numbers = || numerator.iter().chain(denominator);
                let led = |row: &[f64]| row.first().is_some_and(|&first| first != 0.0);
                if !numbers().all(|c| c.is_finite()) || !led(numerator) || !led(denominator) {
                    let expected = "finite coefficients in falling powers of s, the first of each list not 0";
                    self.fault(at, "controller", "a controller".into(), expected);
                } else if numerator.len() > denominator.len() {
                    let found = format!("a controller of order {} over {}", numerator.len() - 1, denominator.len() - 1);
                    self.fault(at, "controller", found, "a numerator of no higher order than the denominator");
                }
            }
        }
    }
}
