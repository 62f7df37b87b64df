//! From one loop to another while the machine runs: what still means something goes on, the rest starts as if it had been so
//! for ever.

use super::law_row::Chain;
use super::{Controller, Output, Stage};
use crate::C64;
use crate::block::{Block, Sampled};

impl Controller {
    /// Begins in the middle of a motion, as if what is read now had been read for ever and `output` had been its output; its
    /// continuous states are filled.
    pub fn start(&mut self, output: Output, stage: &Stage<'_>, x: &mut [C64]) {
        self.output = output;
        self.waiting.clear();
        self.acting = output.commanded;
        self.next_sample = match self.parts.sample {
            0.0 => 0,
            sample => ((stage.tau - self.tolerance) / sample).ceil().max(0.0) as u64,
        };
        if let Some(line) = &mut self.line {
            line.fill(output.commanded);
        }
        let count = self.sensors.len();
        if self.sensor_states > 0 {
            for (k, station) in self.sensors.iter().enumerate() {
                (x[k], x[count + k]) = (stage.displacement[*station], stage.velocity[*station]);
            }
        }
        self.read(stage, x);
        let mut states = std::mem::take(&mut self.sampled);
        let filters = self.sensor_states..self.sensor_states + self.filter_states;
        self.settle(if self.parts.sample > 0.0 { &mut states } else { &mut x[filters] });
        self.sampled = states;
        let actuator = &mut x[self.sensor_states + self.filter_states..];
        if let Some((first, second)) = actuator.split_first_mut() {
            *first = output.delivered;
            second.fill(C64::ZERO);
        }
    }

    /// Goes on where `other` was, as far as what that held still means something: `from` are its continuous states, `to` are
    /// filled. What is new begins as by [`Controller::start`].
    pub fn adopt(&mut self, other: &Self, from: &[C64], stage: &Stage<'_>, to: &mut [C64]) {
        self.start(other.output, stage, to);
        self.set_external(other.is_external);
        if let (Some(noise), Some(old)) = (&mut self.noise, &other.noise)
            && self.parts.seed == other.parts.seed
        {
            noise.random = old.random.clone();
        }
        let same_samples = self.parts.sample > 0.0 && self.parts.sample == other.parts.sample;
        if same_samples {
            self.next_sample = other.next_sample;
        }
        if self.sensor_states > 0 && other.sensor_states > 0 {
            let (count, old_count) = (self.sensors.len(), other.sensors.len());
            for (k, station) in self.sensors.iter().enumerate() {
                if let Some(at) = other.sensors.iter().position(|s| s == station) {
                    (to[k], to[count + k]) = (from[at], from[old_count + at]);
                }
            }
        }
        let same_filters = self.chains().eq(other.chains());
        if same_filters && same_samples {
            self.sampled.copy_from_slice(&other.sampled);
        } else if same_filters && self.parts.sample == 0.0 && other.parts.sample == 0.0 {
            let old = &from[other.sensor_states..other.sensor_states + other.filter_states];
            to[self.sensor_states..self.sensor_states + self.filter_states].copy_from_slice(old);
        }
        if self.actuator_states > 0 && other.actuator_states > 0 {
            let (at, old) = (self.sensor_states + self.filter_states, other.sensor_states + other.filter_states);
            to[at] = from[old];
            if self.actuator_states == 2 && other.actuator_states == 2 {
                to[at + 1] = from[old + 1] * (self.parts.lag / other.parts.lag);
            }
        }
        if self.parts.sample > 0.0 && other.parts.sample > 0.0 {
            self.acting = other.acting;
            let room = self.waiting.capacity();
            self.waiting.extend(other.waiting.iter().take(room).copied());
        }
        if let (Some(line), Some(old)) = (&mut self.line, &other.line) {
            line.adopt(old);
        }
    }

    fn chains(&self) -> impl Iterator<Item = Block> {
        self.rows
            .iter()
            .map(|row| &row.filters)
            .chain([&self.bearing])
            .flat_map(|chain| chain.blocks.iter().map(|b| b.block))
    }

    /// Filters' states as if the present readings had been there for ever.
    fn settle(&self, states: &mut [C64]) {
        let still = |chain: &Chain, mut w: C64, states: &mut [C64]| {
            let mut first = chain.first;
            for Sampled { block, .. } in &chain.blocks {
                let x = &mut states[first..first + block.order];
                first += block.order;
                x.fill(C64::ZERO);
                if let Some(x) = block.at_rest(w, self.speed) {
                    states[first - block.order] = x;
                }
                w = block.output(&states[first - block.order..first], w);
            }
            w
        };
        let mut sum = C64::ZERO;
        for row in &self.rows {
            sum -= still(&row.filters, row.of(&self.reading), states);
        }
        still(&self.bearing, sum, states);
    }
}
