//! Statistics of the pace: percentiles of lateness and cost over the whole run.

use std::sync::atomic::Ordering;

use hdrhistogram::Histogram;
use wire::message::{ControlHealth, Health};

use crate::engine::Exchange;
use crate::external::ExternalCounts;

/// Gathers what the stepping thread measures.
#[derive(Debug)]
pub(crate) struct PaceStatistics {
    lateness_ns: Histogram<u64>,
    cost_ns: Histogram<u64>,
    age_ns: Histogram<u64>,
}

/// Longest time told apart, in nanoseconds: a minute. Longer ones count as that.
const LONGEST_NS: u64 = 60_000_000_000;

impl PaceStatistics {
    pub(crate) fn new() -> Self {
        let histogram = || Histogram::new_with_bounds(1, LONGEST_NS, 3).expect("bounds and digits are in range");
        Self { lateness_ns: histogram(), cost_ns: histogram(), age_ns: histogram() }
    }

    /// Takes in all measures that have come since the last call.
    pub(crate) fn gather(&mut self, exchange: &Exchange) {
        while let Some(measure) = exchange.measures.pop() {
            self.lateness_ns.saturating_record(measure.lateness_ns);
            self.cost_ns.saturating_record(measure.cost_ns);
        }
        while let Some(age_ns) = exchange.ages.pop() {
            self.age_ns.saturating_record(age_ns);
        }
    }

    /// How a controller outside did so far.
    pub(crate) fn control(&self, exchange: &Exchange) -> ControlHealth {
        let ExternalCounts { taken, late, missed, refused, took_over, lost, acting } = exchange.counters.external.now();
        let age_us = |quantile| match self.age_ns.is_empty() {
            true => 0.0,
            false => self.age_ns.value_at_quantile(quantile) as f64 / 1e3,
        };
        ControlHealth {
            taken,
            late,
            missed,
            refused,
            took_over,
            lost,
            age_p50_us: age_us(0.5),
            age_p99_us: age_us(0.99),
            acting: u32::from(acting),
            reserved: 0,
        }
    }

    /// The statistics so far.
    pub(crate) fn health(&self, exchange: &Exchange, subscribers: usize) -> Health {
        let us = |ns: u64| ns as f64 / 1e3;
        let at = |histogram: &Histogram<u64>, quantile| us(histogram.value_at_quantile(quantile));
        Health {
            steps: exchange.counters.steps.load(Ordering::Relaxed),
            late: exchange.counters.late.load(Ordering::Relaxed),
            missed: exchange.counters.missed.load(Ordering::Relaxed),
            lateness_p50_us: at(&self.lateness_ns, 0.5),
            lateness_p99_us: at(&self.lateness_ns, 0.99),
            lateness_max_us: us(self.lateness_ns.max()),
            cost_p50_us: at(&self.cost_ns, 0.5),
            cost_p99_us: at(&self.cost_ns, 0.99),
            subscribers: subscribers as u32,
            reserved: 0,
        }
    }
}
