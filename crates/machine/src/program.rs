//! What a machine does from some step on: compiled whole, away from the thread that steps, and swapped in between two steps.

use std::sync::Arc;

use control::{Controller, Feedback, LoopError};
use rotor::step::{Fastest, StepError};
use rotor::{
    C64, Characteristic, ClosedLoop, ControlMasses, LinearForm, LoopOverSpeed, OperatingPoint, Plant, PoleError, Rotor,
    Settings, eigenvalues,
};

use crate::integrate::Integrator;
use crate::poles::PolesError;
use rotor::profile::{Leg, Profile};

/// Modes so many times as fast as the spin are not what it makes resonate.
const FAR: f64 = 4.0;
/// How far the seeds of the noise of two control bearings are apart.
const SEEDS_APART: f64 = 65_536.0;

/// Why settings cannot be stepped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProgramError {
    /// The settings do not fit the rotor.
    #[error(transparent)]
    Settings(#[from] rotor::SettingsError),
    /// The loop cannot work at this step.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// The step does not follow the machine, and no substeps that there is time for would.
    #[error(transparent)]
    Step(#[from] StepError),
}

impl From<PoleError> for ProgramError {
    fn from(error: PoleError) -> Self {
        Self::Step(error.into())
    }
}

/// Why a profile of speed cannot be stepped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{error}", at.as_ref().map_or(String::new(), |leg| format!("{leg}: ")))]
pub struct ProfileError {
    /// The leg that leads to the speed that is to blame; none for the speed that the profile begins at, or where no speed is.
    pub at: Option<String>,
    /// Why.
    pub error: ProgramError,
}

/// The pace at which a machine is to be stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// The step that others see, in `tau`.
    pub dtau: f64,
    /// Steps a second; 0 where nothing is paced.
    pub rate_hz: f64,
}

/// A chain under an ideal loop: what its fused path reads.
#[derive(Clone, Debug)]
pub(crate) struct Fused {
    /// At the speed at which the program ends.
    pub(crate) steady: ClosedLoop,
    /// On the way there.
    pub(crate) over_speed: LoopOverSpeed,
}

/// Settings, ready to be stepped.
#[derive(Clone, Debug)]
pub struct Program {
    /// The fused path, where there is one.
    pub(crate) fused: Option<Fused>,
    pub(crate) integrator: Integrator,
    plant: Arc<Plant>,
    feedback: Feedback,
    clearances: Vec<f64>,
    control_masses: ControlMasses,
    /// Where the speed goes.
    pub(crate) legs: Vec<Leg>,
    /// The speed that a machine has at first, and again when it restarts; none for the speed that it has then.
    pub(crate) begins: Option<f64>,
    /// The largest orbit before the machine trips, in `e_t`.
    pub(crate) trip_limit: f64,
    /// Rate at which the speed falls at first once it has tripped; 0 where the machine is held.
    pub(crate) coast_down: f64,
    /// Steps of integration in a step.
    pub(crate) substeps: u32,
    /// The step that others see.
    pub(crate) dtau: f64,
}

impl Program {
    /// Words that a machine of this program saves at most: see [`crate::Machine::save`].
    #[must_use]
    pub fn words_at_most(&self) -> usize {
        // Form, step, path and grid; motion; output; trip; then the coordinates and their velocities.
        let fixed = 6 + 9 + 3 * self.legs.len() + 5 * self.feedback.bearings.len() + 4;
        let motion = 4 * self.integrator.displacement().len();
        fixed + motion + self.integrator.words_at_most() + 1 + control::Excitation::WORDS_AT_MOST
    }

    /// Settings to be stepped in as many parts as they need at all speeds from those that the machine may `have` when they are taken to
    /// theirs, and down to rest where it would coast down after a trip.
    ///
    /// # Errors
    /// Settings that do not fit the rotor, a loop that cannot work at this step, or more parts than there is time for.
    pub fn compile(rotor: &Rotor, settings: &Settings, have: [f64; 2], pace: Pace) -> Result<Self, ProgramError> {
        settings.check(rotor)?;
        let rest = (settings.coast_down > 0.0).then_some(0.0);
        let passes = have.into_iter().chain([settings.speed]).chain(rest);
        let over = passes.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        let substeps = substeps_over(rotor, settings, over, pace)?;
        Self::in_substeps(rotor, settings, pace.dtau, substeps)
    }

    /// Settings whose speed follows a profile, to be stepped in as many parts as they need at all of its speeds. A machine that is made
    /// of it spins at `profile.from`, and does again when it restarts.
    ///
    /// # Errors
    /// As for [`Program::compile`], with the leg whose speed is to blame, if one is.
    pub fn compile_profile(
        rotor: &Rotor,
        settings: &Settings,
        profile: &Profile,
        pace: Pace,
    ) -> Result<Self, ProfileError> {
        settings.check(rotor).map_err(|error| ProfileError { at: None, error: error.into() })?;
        let needed = |over| substeps_over(rotor, settings, over, pace);
        let mut substeps = needed([profile.from; 2]).map_err(|error| ProfileError { at: None, error })?;
        for (leg, ends) in profile.course().windows(2).enumerate() {
            let at = |error| ProfileError { at: Some(profile.leg_words(leg)), error };
            substeps = substeps.max(needed([ends[0].1, ends[1].1]).map_err(at)?);
        }
        if settings.coast_down > 0.0 {
            let over = [0.0, profile.speeds()[1]];
            substeps = substeps.max(needed(over).map_err(|error| ProfileError { at: None, error })?);
        }
        let program = Self::in_substeps(rotor, settings, pace.dtau, substeps);
        Ok(program.map_err(|error| ProfileError { at: None, error })?.along(profile))
    }

    /// The same in so many parts a step, whatever they need: as a recording was made.
    ///
    /// # Errors
    /// Settings that do not fit the rotor, or a loop that cannot work at this step.
    pub fn in_substeps(rotor: &Rotor, settings: &Settings, dtau: f64, substeps: u32) -> Result<Self, ProgramError> {
        settings.check(rotor)?;
        let unbalanced = settings.unbalanced(rotor);
        let (rotor, feedback) = (&*unbalanced, &settings.feedback);
        let plant = Arc::new(Plant::of(rotor));
        let stations = plant.stations().len();
        let inner = dtau / f64::from(substeps);
        let (mut columns, mut controllers) = (Vec::new(), Vec::new());
        for (k, bearing) in feedback.bearings.iter().enumerate() {
            let missing = control::FeedbackError::Bearing { found: bearing.station + 1, masses: stations };
            columns.push(plant.column(bearing.station).ok_or(LoopError::Feedback(missing))?.clone());
            let mut own = bearing.clone();
            // Sensors of different bearings do not hiss in step.
            own.parts.seed += k as f64 * SEEDS_APART;
            controllers.push(Controller::new(&own, stations, settings.speed, inner)?);
        }
        Ok(Self {
            fused: ClosedLoop::describes(rotor, feedback)
                .then(|| Fused { steady: settings.closed_loop(rotor), over_speed: LoopOverSpeed::of(rotor, feedback) }),
            integrator: Integrator::new(plant.clone(), columns, settings.deadband.clone(), controllers, inner),
            plant,
            feedback: feedback.clone(),
            clearances: settings.deadband.clone(),
            control_masses: ControlMasses::of(rotor, feedback),
            legs: vec![Leg::To { speed: settings.speed, rate: settings.ramp }],
            begins: None,
            trip_limit: settings.trip,
            coast_down: settings.coast_down,
            substeps,
            dtau,
        })
    }

    /// The same with a speed that begins as a profile does and follows it.
    #[must_use]
    pub fn along(self, profile: &Profile) -> Self {
        Self { begins: Some(profile.from), ..self.following(profile.legs.clone()) }
    }

    /// The same with another program for its speed.
    #[must_use]
    pub fn following(self, legs: Vec<Leg>) -> Self {
        Self { legs, ..self }
    }

    /// How many steps of integration make a step.
    #[must_use]
    pub fn substeps(&self) -> u32 {
        self.substeps
    }

    /// The step that others see, in `tau`.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.dtau
    }

    /// The equations of motion that hold from the first step to the last: of a chain under an ideal loop that spins at one speed, in steps
    /// of one part. `None` for every other.
    #[must_use]
    pub fn steady_loop(&self) -> Option<&ClosedLoop> {
        let goes_nowhere = |at: f64| matches!(self.legs.as_slice(), [Leg::To { speed, .. }] if *speed == at);
        let steady = self.closed_loop()?;
        (self.begins.is_none() && self.substeps == 1 && goes_nowhere(steady.speed())).then_some(steady)
    }

    /// The same in steps of `dtau`, no longer than its own.
    #[must_use]
    pub fn paced(self, dtau: f64) -> Self {
        Self { dtau, ..self }
    }

    /// The equations of motion of the fused path, at the speed at which it ends; `None` where the loop is not ideal.
    #[must_use]
    pub fn closed_loop(&self) -> Option<&ClosedLoop> {
        self.fused.as_ref().map(|fused| &fused.steady)
    }

    /// The spin speed that it ends at.
    #[must_use]
    pub fn speed(&self) -> f64 {
        let ends = self.legs.iter().rev().find_map(|leg| match leg {
            Leg::To { speed, .. } | Leg::Decay { speed, .. } => Some(*speed),
            Leg::Dwell { .. } | Leg::Drive { .. } => None,
        });
        ends.unwrap_or(0.0)
    }

    /// How many control bearings there are.
    #[must_use]
    pub fn bearings(&self) -> usize {
        self.feedback.bearings.len()
    }

    /// The control bearings.
    #[must_use]
    pub fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    /// What turns the control of each bearing into a force.
    #[must_use]
    pub fn control_masses(&self) -> &ControlMasses {
        &self.control_masses
    }

    /// How many coordinates the plant has.
    #[must_use]
    pub fn order(&self) -> usize {
        self.plant.order()
    }

    /// The clearance of every contact, in `e_t`.
    #[must_use]
    pub fn clearances(&self) -> &[f64] {
        &self.clearances
    }

    /// How fast the fastest small disturbance of the balanced machine at rest in its centre grows at a speed, contacts with a clearance
    /// out of action: as `exp(growth tau)`; exactly 0 where that is rounding.
    ///
    /// # Errors
    /// Poles that cannot be had.
    pub fn growth_at_centre(&self, speed: f64) -> Result<f64, PolesError> {
        let factor = |clearance: &f64| if *clearance > 0.0 { 0.0 } else { 1.0 };
        let contact_factors = self.clearances.iter().map(factor).collect();
        let at = OperatingPoint { speed, contact_factors };
        let characteristic = Characteristic::of(&LinearForm::of(&self.plant, &self.feedback, &at)?)?;
        let growth = characteristic.roots()?.iter().map(|root| root.pole.re).fold(f64::NEG_INFINITY, f64::max);
        // Where nothing is right of the line, the line is a bound.
        Ok(growth.max(characteristic.right_of().unwrap_or(f64::NEG_INFINITY)))
    }

    /// The step of integration.
    pub(crate) fn inner_step(&self) -> f64 {
        self.dtau / f64::from(self.substeps)
    }
}

/// The step of an offline run that nobody says otherwise of: accurate, and no longer than a sampling period.
///
/// # Errors
/// Settings that do not fit the rotor, or eigenvalues that do not converge.
pub fn default_step(rotor: &Rotor, settings: &Settings) -> Result<f64, ProgramError> {
    let step = fastest(rotor, settings, settings.speed)?.default_step();
    Ok(match settings.feedback.sample() {
        0.0 => step,
        sample => step.min(sample),
    })
}

/// The same for a spin speed that passes from one to another of `speeds`: the shortest on the way.
///
/// # Errors
/// As for [`default_step`].
pub fn default_step_over(rotor: &Rotor, settings: &Settings, speeds: [f64; 2]) -> Result<f64, ProgramError> {
    let mut shortest = f64::INFINITY;
    for speed in telling_speeds(rotor, settings, speeds) {
        shortest = shortest.min(default_step(rotor, &Settings { speed, ..settings.clone() })?);
    }
    Ok(shortest)
}

/// Into how many parts a step is cut so that each follows the machine at every speed between two.
fn substeps_over(rotor: &Rotor, settings: &Settings, over: [f64; 2], pace: Pace) -> Result<u32, ProgramError> {
    let mut substeps = 1;
    for speed in telling_speeds(rotor, settings, over) {
        substeps = substeps.max(fastest(rotor, settings, speed)?.substeps(pace.dtau, pace.rate_hz)?);
    }
    Ok(substeps)
}

/// The speeds between two that tell how fast a machine gets between them, each once: both ends, and where the table of a gain or of what holds the rotor has
/// a corner. Between these every coefficient goes along a straight line.
fn telling_speeds(rotor: &Rotor, settings: &Settings, [a, b]: [f64; 2]) -> Vec<f64> {
    let (low, high) = (a.min(b), a.max(b));
    let gains = settings.feedback.bearings.iter().flat_map(|bearing| bearing.corner_speeds());
    let mut speeds: Vec<f64> =
        gains.chain(Plant::of(rotor).corner_speeds()).filter(|at| low < *at && *at < high).collect();
    speeds.extend([low, high]);
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    speeds
}

/// The fastest that is integrated under settings at a spin speed: the modes of the machine with every support bearing in and
/// out of action, the control as immediate as it gets; and, where it comes late or in samples, without it too.
///
/// # Errors
/// Settings that do not fit the rotor, or eigenvalues that do not converge.
pub fn fastest(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<Fastest, ProgramError> {
    // A gain that is lost makes nothing faster, one that is more than designed does.
    let excess =
        |parts: &control::Parts| parts.sensor_gain.max(1.0) * parts.amplifier_y.max(parts.amplifier_z).max(1.0);
    let mut feedback = settings.feedback.sound();
    for (sound, bearing) in feedback.bearings.iter_mut().zip(&settings.feedback.bearings) {
        sound.parts.amplifier_y = excess(&bearing.parts);
        sound.parts.amplifier_z = sound.parts.amplifier_y;
    }
    let feedback = &feedback;
    if ClosedLoop::describes(rotor, feedback) {
        let closed_loop = ClosedLoop::new(rotor, feedback, speed, &settings.deadband);
        return Ok(Fastest::of(&closed_loop)?);
    }
    let plant = Plant::of(rotor);
    let mut poles: Vec<C64> = Vec::new();
    for factor in [1.0, 0.0] {
        let at = OperatingPoint { speed, contact_factors: vec![factor; plant.contacts().len()] };
        let form = LinearForm::of(&plant, feedback, &at).map_err(LoopError::from)?;
        match form.continuous() {
            Some([a, b, c]) => {
                poles.extend(eigenvalues(&a + b * c).map_err(PoleError::from)?);
                if form.delay > 0.0 {
                    poles.extend(eigenvalues(a).map_err(PoleError::from)?);
                }
            }
            None => {
                poles.extend(eigenvalues(&form.a + &form.b * &form.law.d * &form.readings).map_err(PoleError::from)?);
                poles.extend(eigenvalues(form.a).map_err(PoleError::from)?);
            }
        }
    }
    // A state of the loop costs about as much as half a mass, and what has no fused path about twice as much.
    let states = poles.len() / 2;
    let far = if rotor.is_chain() { f64::INFINITY } else { FAR * speed };
    Ok(Fastest::of_poles_near(states, speed, poles, far))
}
