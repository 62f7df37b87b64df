//! A loop at work. Its continuous parts are integrated together with the plant, stage by stage; its sampled parts act at
//! their instants, between two stretches of integration, and hold.
//!
//! Who integrates does this for every stretch over which nothing jumps:
//!
//! 1. [`Controller::act`] at its start: samples that are due are taken, commands that are due take effect.
//! 2. [`Controller::flow`] in every stage: the rates of the continuous states, and the force.
//! 3. With a continuous delay, [`Controller::remember`] at its end, with what the rates are there; if it says so the stretch is
//!    integrated again, because the delay is shorter than the stretch.
//! 4. [`Controller::finish`] at its end: the force there is where the limit of its rate goes on from.

mod adopt;
mod excite;
mod external;
mod flow;
mod law_row;
mod loop_error;
mod save;

use std::collections::VecDeque;

use law_row::{Chain, LawRow, Noise};
pub use loop_error::LoopError;

use crate::block::Sampled;
use crate::delay_line::{DelayLine, Stretch};
use crate::{C64, ControlBearing, Excitation, LinearLoop, Parts};

/// More stretches of delay than this are refused: 5 MB.
const MOST_STRETCHES: f64 = 65_536.0;
/// Times that differ by less than this share of a step are one: sums of steps round.
const SAME_TIME: f64 = 1e-9;

/// What a loop sees in one stage.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    /// Time.
    pub tau: f64,
    /// Time since the stretch began.
    pub since: f64,
    /// Spin speed `R`.
    pub speed: f64,
    /// Displacement at every station.
    pub displacement: &'a [C64],
    /// Velocity at every station.
    pub velocity: &'a [C64],
}

/// What a loop puts out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output {
    /// What the law asks for now, with an excitation if there is one; a sampled law, at its last sample.
    pub commanded: C64,
    /// What acts on the plant.
    pub delivered: C64,
    /// Whether the actuator is at its limit of force or of rate.
    pub saturated: bool,
}

/// A loop in motion around one control bearing.
#[derive(Clone, Debug)]
pub struct Controller {
    parts: Parts,
    /// The stations that it senses.
    sensors: Vec<usize>,
    rows: Vec<LawRow>,
    /// Filters of the sum, at the bearing.
    bearing: Chain,
    scheduled: bool,
    speed: f64,
    /// Continuous states: of sensors, of filters unless they are sampled, of the actuator.
    sensor_states: usize,
    filter_states: usize,
    actuator_states: usize,
    noise: Option<Noise>,
    reading: [Vec<C64>; 2],
    /// States of filters in a sampled loop.
    sampled: Vec<C64>,
    next_sample: u64,
    /// Commands under way, with the time from which they act.
    waiting: VecDeque<(f64, C64)>,
    /// The command that acts, in a sampled loop.
    acting: C64,
    line: Option<DelayLine>,
    /// The command over the stretch that is being integrated.
    current: Stretch,
    /// How often the present stretch was integrated.
    passes: u32,
    output: Output,
    tolerance: f64,
    /// What is added to the command, while it is.
    excitation: Option<Box<Excitation>>,
    /// Whether it acts over the present stretch.
    is_exciting: bool,
    /// Whether commands come from outside.
    is_external: bool,
    /// Whether the sample that is due has been read already.
    is_sensed: bool,
}

impl Controller {
    /// A loop that has never done anything, for steps of `dtau` at most.
    ///
    /// # Errors
    /// Feedback that does not fit `stations` stations, or parts that cannot work at this step.
    pub fn new(bearing: &ControlBearing, stations: usize, speed: f64, dtau: f64) -> Result<Self, LoopError> {
        bearing.check(stations)?;
        let parts = bearing.parts;
        let is_sampled = parts.sample > 0.0;
        if is_sampled && parts.sample < dtau * (1.0 - SAME_TIME) {
            return Err(LoopError::SampleWithinStep { sample: parts.sample, dtau });
        }
        let stretch = if is_sampled { parts.sample } else { dtau };
        let stretches = (parts.delay / stretch).ceil();
        if stretches > MOST_STRETCHES {
            return Err(LoopError::DelayTooLong { delay: parts.delay, dtau: stretch });
        }
        let room = (1.25 * stretches) as usize + 16;
        Ok(Self::with_room(bearing, stations, speed, room, SAME_TIME * dtau))
    }

    /// A loop that can remember so many stretches, or commands under way; the bearing has been checked.
    pub(crate) fn with_room(
        bearing: &ControlBearing,
        stations: usize,
        speed: f64,
        room: usize,
        tolerance: f64,
    ) -> Self {
        let parts = bearing.parts;
        let is_sampled = parts.sample > 0.0;
        let sensors: Vec<usize> = (0..stations).filter(|station| bearing.senses(*station)).collect();
        let count = sensors.len();
        let mut filter_states = 0;
        let mut chain = |filters: &[crate::Filter]| {
            let first = filter_states;
            let period = if is_sampled { parts.sample } else { 0.0 };
            let blocks: Vec<Sampled> =
                filters.iter().flat_map(crate::Filter::blocks).map(|b| Sampled::new(b, period, speed)).collect();
            filter_states += blocks.iter().map(|b| b.block.order).sum::<usize>();
            Chain { blocks, first }
        };
        let rows: Vec<LawRow> =
            bearing.signals.iter().map(|signal| LawRow::new(signal, &sensors, chain(&signal.filters))).collect();
        let behind = chain(&bearing.filters);
        let noise = (parts.noise > 0.0).then(|| Noise {
            deviation: parts.noise,
            random: fastrand::Rng::with_seed(parts.seed as u64),
            displacement: vec![C64::ZERO; count],
            velocity: vec![C64::ZERO; count],
        });
        let mut made = Self {
            parts,
            scheduled: rows.iter().any(LawRow::is_scheduled)
                || rows.iter().any(|row| row.filters.follows_speed())
                || behind.follows_speed(),
            rows,
            bearing: behind,
            speed: f64::NAN,
            sensor_states: if parts.sensor_lag > 0.0 { 2 * count } else { 0 },
            filter_states: if is_sampled { 0 } else { filter_states },
            actuator_states: match (parts.lag > 0.0, parts.lag_damping > 0.0) {
                (false, _) => 0,
                (true, false) => 1,
                (true, true) => 2,
            },
            noise,
            reading: [vec![C64::ZERO; count], vec![C64::ZERO; count]],
            sampled: vec![C64::ZERO; if is_sampled { filter_states } else { 0 }],
            next_sample: 0,
            waiting: VecDeque::with_capacity(if is_sampled { room } else { 0 }),
            acting: C64::ZERO,
            line: (parts.delay > 0.0 && !is_sampled).then(|| DelayLine::new(room)),
            current: Stretch::default(),
            passes: 0,
            output: Output::default(),
            tolerance,
            excitation: None,
            is_exciting: false,
            is_external: false,
            is_sensed: false,
            sensors,
        };
        made.follow(speed);
        made
    }

    /// How many complex states it has that flow.
    #[must_use]
    pub fn order(&self) -> usize {
        self.sensor_states + self.filter_states + self.actuator_states
    }

    /// The stations that it senses, counted from 0.
    #[must_use]
    pub fn sensors(&self) -> &[usize] {
        &self.sensors
    }

    /// What its sensors read last: displacement of each.
    #[must_use]
    pub fn readings(&self) -> &[C64] {
        &self.reading[0]
    }

    /// What it read last of the displacement at a station, counted from 0; `None` where it has no sensor.
    #[must_use]
    pub fn reading_at(&self, station: usize) -> Option<C64> {
        let sensor = self.sensors.binary_search(&station).ok()?;
        self.reading[0].get(sensor).copied()
    }

    /// What it puts out at the end of the last stretch.
    #[must_use]
    pub fn output(&self) -> Output {
        self.output
    }

    /// Whether it remembers its command because of a delay without sampling.
    #[must_use]
    pub fn remembers(&self) -> bool {
        self.line.is_some()
    }

    /// Back to before it did anything, at `tau` = 0.
    pub fn rest(&mut self) {
        self.stop_excitation();
        self.is_sensed = false;
        self.sampled.fill(C64::ZERO);
        self.reading.iter_mut().for_each(|readings| readings.fill(C64::ZERO));
        self.waiting.clear();
        (self.next_sample, self.acting, self.output) = (0, C64::ZERO, Output::default());
        self.current = Stretch::default();
        if let Some(line) = &mut self.line {
            line.fill(C64::ZERO);
        }
        if let Some(noise) = &mut self.noise {
            noise.random = fastrand::Rng::with_seed(self.parts.seed as u64);
        }
    }

    /// Takes the gains of this speed.
    #[inline]
    fn follow(&mut self, speed: f64) {
        if speed == self.speed || !self.scheduled && !self.speed.is_nan() {
            return;
        }
        self.speed = speed;
        for row in &mut self.rows {
            let [kd, cd, kc, cc] = [0, 1, 2, 3].map(|i: usize| row.gains[i].at(speed));
            row.now = [C64::new(kd, -kc), C64::new(cd, -cc)];
            row.filters.blocks.iter_mut().for_each(|block| block.follow(speed));
        }
        self.bearing.blocks.iter_mut().for_each(|block| block.follow(speed));
    }

    /// Draws the noise of a step, in a loop without sampling: once a step, before anything else.
    pub fn begin_step(&mut self) {
        if self.parts.sample == 0.0
            && let Some(noise) = &mut self.noise
        {
            noise.draw();
        }
    }

    /// When a sample is taken or a command takes effect next; infinite in a continuous loop.
    pub(super) fn next_sample_event(&self) -> f64 {
        if self.parts.sample == 0.0 {
            return f64::INFINITY;
        }
        let next_sample = self.next_sample as f64 * self.parts.sample;
        self.waiting.front().map_or(next_sample, |(time, _)| time.min(next_sample))
    }

    /// Takes the samples and lets the commands take effect that are due.
    pub fn act(&mut self, stage: &Stage<'_>, x: &[C64]) {
        self.follow(stage.speed);
        self.is_exciting = self.is_excited(stage.tau);
        if self.parts.sample > 0.0 {
            let now = stage.tau + self.tolerance;
            loop {
                let at = self.next_sample as f64 * self.parts.sample;
                if at > now {
                    break;
                }
                self.next_sample += 1;
                if !std::mem::take(&mut self.is_sensed) {
                    self.take_sample(stage, x);
                }
                // Computed in any case, so that what its filters hold is of the present when it has to take over.
                let command = self.sampled_command();
                if !self.is_external {
                    self.send(self.excited(command, at), at + self.parts.delay);
                }
            }
            while let Some((_, command)) = self.waiting.front().filter(|(time, _)| *time <= now) {
                self.acting = *command;
                self.waiting.pop_front();
            }
        } else if self.line.is_some() {
            self.passes = 0;
            let guess = self.line.as_ref().and_then(DelayLine::last).copied();
            // Beyond the last stretch until this one is known: as that went on.
            self.current = guess.unwrap_or(Stretch { value: [self.output.commanded; 2], ..Stretch::default() });
        }
    }

    fn take_sample(&mut self, stage: &Stage<'_>, x: &[C64]) {
        if let Some(noise) = &mut self.noise {
            noise.draw();
        }
        self.read(stage, x);
    }

    /// Sends a command on its way.
    fn send(&mut self, command: C64, acts_from: f64) {
        self.output.commanded = command;
        // A delay that was shortened meanwhile: the newest word counts.
        while self.waiting.back().is_some_and(|(time, _)| *time >= acts_from) {
            self.waiting.pop_back();
        }
        self.waiting.push_back((acts_from, command));
    }

    /// The law on the present readings, in a sampled loop, whose filters go on by a sample.
    fn sampled_command(&mut self) -> C64 {
        let saturated = self.output.saturated;
        let held = |further: C64| saturated && further.re > 0.0;
        let Self { rows, bearing, sampled, reading, .. } = self;
        let mut through = |chain: &Chain, mut w: C64| {
            let mut first = chain.first;
            for block in &chain.blocks {
                let states = first..first + block.block.order;
                w = block.take(&mut sampled[states.clone()], w, held);
                first = states.end;
            }
            w
        };
        let mut sum = C64::ZERO;
        for row in rows.iter() {
            sum -= through(&row.filters, row.of(reading));
        }
        through(bearing, sum)
    }

    /// Begins where an ideal loop was, whose force was `force`.
    pub fn begin_with(&mut self, force: C64) {
        self.output = Output { commanded: force, delivered: force, saturated: false };
        self.acting = force;
        if let Some(line) = &mut self.line {
            line.fill(force);
        }
    }

    /// Ends a stretch: the force at its end stands from here on.
    pub fn finish(&mut self, stage: &Stage<'_>, x: &[C64]) -> Output {
        self.follow(stage.speed);
        let command = if self.parts.sample > 0.0 {
            self.acting
        } else {
            self.read(stage, x);
            let (from, to) = (self.sensor_states, self.sensor_states + self.filter_states);
            let command = self.command(&x[from..to], None);
            let command = self.excited(command, stage.tau);
            self.output.commanded = command;
            self.late(stage, command)
        };
        let first = self.sensor_states + self.filter_states;
        let drive = if self.actuator_states > 0 { x[first] } else { command };
        let (delivered, saturated) = self.limited(drive, stage.since);
        self.output = Output { delivered, saturated, ..self.output };
        self.output
    }

    /// The same loop as matrices at a spin speed: noise, resolution and limits left out.
    pub(crate) fn linear(&self, speed: f64) -> LinearLoop {
        let rows =
            self.rows.iter().map(|row| (&row.displacement[..], &row.velocity[..], row.now, &row.filters.blocks[..]));
        LinearLoop::of(&self.parts, &self.sensors, rows, &self.bearing.blocks, speed)
    }
}
