//! What a stretch of steps has in common: the settings in force with their poles; and what divides the steps.

use std::sync::Arc;

use machine::MachinePoles;
use rotor::{C64, ControlMasses, Rotor, Settings};
use wire::BenchStatus;
use wire::message::Analysis;

/// Settings that were in force over some steps, and what follows from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Era {
    /// Which run of which process.
    pub run_id: u64,
    /// Revision of the settings.
    pub revision: u64,
    /// Who put them in force.
    pub who: String,
    /// The rotor, if it is one.
    pub rotor: Option<Arc<Rotor>>,
    /// The settings.
    pub settings: Settings,
    /// The spin speed that the poles are for; that of the settings unless it is on its way.
    pub speed: f64,
    /// The poles, least damped first; none if they are not known.
    pub poles: Vec<C64>,
    /// The smallest damping ratio, of the modes that count; 0 without poles.
    pub min_damping: f64,
}

impl Era {
    /// What a bench status tells of. The rotor of a run never changes: `rotor` is the one known from an earlier bench status.
    pub fn of(bench_status: &BenchStatus, rotor: Option<Arc<Rotor>>) -> Self {
        Self {
            run_id: bench_status.run_id,
            revision: bench_status.revision,
            who: bench_status.changed_by.as_str().to_owned(),
            rotor: rotor.or_else(|| bench_status.rotor().ok().map(Arc::new)),
            settings: bench_status.settings.get().clone(),
            speed: bench_status.analysis.speed,
            poles: bench_status.analysis.poles().collect(),
            min_damping: bench_status.analysis.min_damping,
        }
    }

    /// What turns control into a force at each control bearing.
    #[must_use]
    pub fn masses_of_bearings(&self) -> ControlMasses {
        self.rotor
            .as_ref()
            .map_or_else(ControlMasses::default, |rotor| ControlMasses::of(rotor, &self.settings.feedback))
    }

    /// The same with the poles at another speed than was told of, through which the machine passes.
    #[must_use]
    pub fn at_speed(&self, speed: f64) -> Option<Self> {
        let settings = Settings { speed, ..self.settings.clone() };
        let rotor = self.rotor.as_ref()?;
        let linear = MachinePoles::of(rotor, &settings).ok()?;
        let min_damping = linear.counted_damping(rotor, speed);
        let poles = linear.modes.into_iter().map(|mode| mode.pole).collect();
        Some(Self { speed, min_damping, poles, ..self.clone() })
    }

    /// Whether an analysis tells nothing new.
    pub fn has_same_poles(&self, analysis: &Analysis) -> bool {
        self.speed == analysis.speed
            && self.min_damping == analysis.min_damping
            && self.poles.iter().copied().eq(analysis.poles())
    }
}

/// What happened between a step and the one before it.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// So many steps were sent and did not reach us.
    Lost(u64),
    /// The rotor started again from rest.
    Restart,
    /// Another run: the simulation was started again.
    NewRun,
    /// The machine tripped with this step.
    Trip,
    /// Somebody put a note on the record.
    Note,
    /// Settings of this revision came into force.
    Settings(u64),
}

impl Mark {
    /// Whether what was largest before it counts no longer.
    pub fn resets_peaks(&self) -> bool {
        matches!(self, Self::Restart | Self::NewRun | Self::Settings(_))
    }
}
