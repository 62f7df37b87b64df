//! What a machine does from some step on: compiled whole, away from the thread that steps, and swapped in between two steps.

use std::sync::Arc;

use control::{Controller, LoopError};
use rotor::{ClosedLoop, OperatingPoint, Plant, Rotor, Settings};

use crate::integrate::Integrator;
use crate::linear_form::LinearForm;
use crate::motion::Leg;

/// Why settings cannot be stepped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProgramError {
    /// The settings do not fit the rotor.
    #[error(transparent)]
    Settings(#[from] rotor::SettingsError),
    /// The loop cannot work at this step.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// There is no such control bearing.
    #[error("no control bearing {0}")]
    NoBearing(usize),
}

/// Settings, ready to be stepped.
#[derive(Clone, Debug)]
pub struct Program {
    /// The fused path, where there is one: a chain under an ideal loop.
    pub(crate) fused: Option<ClosedLoop>,
    pub(crate) integrator: Integrator,
    /// Where the speed goes.
    pub(crate) legs: Vec<Leg>,
    /// The largest orbit before the machine trips, in `e_t`.
    pub(crate) trip_limit: f64,
    /// Steps of integration in a step.
    pub(crate) substeps: u32,
    /// The step that others see.
    pub(crate) dtau: f64,
}

impl Program {
    /// Settings of a chain, to be stepped in `substeps` parts of `dtau` each step.
    ///
    /// # Errors
    /// Settings that do not fit the rotor, or a loop that cannot work at this step.
    pub fn new(rotor: &Rotor, settings: &Settings, dtau: f64, substeps: u32) -> Result<Self, ProgramError> {
        settings.check(rotor)?;
        let feedback = &settings.feedback;
        let plant = Arc::new(Plant::of(rotor));
        let column = plant.column(feedback.bearing).ok_or(ProgramError::NoBearing(feedback.bearing + 1))?.clone();
        let inner = dtau / f64::from(substeps);
        let controller = Controller::new(feedback, plant.stations().len(), settings.speed, inner)?;
        Ok(Self {
            fused: feedback.is_ideal().then(|| settings.closed_loop(rotor)),
            integrator: Integrator::new(plant, column, settings.deadband.clone(), controller, inner),
            legs: vec![Leg::To { speed: settings.speed, rate: settings.ramp }],
            trip_limit: settings.trip,
            substeps,
            dtau,
        })
    }

    /// The machine as matrices, at an operating point.
    #[must_use]
    pub fn linear(&self, at: &OperatingPoint) -> LinearForm {
        self.integrator.linear(at)
    }

    /// The same with another program for its speed.
    #[must_use]
    pub fn following(self, legs: Vec<Leg>) -> Self {
        Self { legs, ..self }
    }

    /// The step of integration.
    pub(crate) fn inner_step(&self) -> f64 {
        self.dtau / f64::from(self.substeps)
    }
}
