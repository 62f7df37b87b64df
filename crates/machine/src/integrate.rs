//! Plant and loop integrated together: classical fourth-order Runge-Kutta between instants at which something jumps.
//!
//! This is the way of everything that is not a chain under an ideal loop, which has a fused path of its own unless its speed is driven
//! by a given torque. It allocates nothing once it is made.

mod taken_over;

use std::sync::Arc;

use control::{Controller, Output, Stage};
use rotor::{C64, Direction, Plant, Spin};

use crate::motion::{Drive, Motion, SAME_TIME};

/// A plant in motion with the loop around it.
#[derive(Clone, Debug)]
pub(crate) struct Integrator {
    plant: Arc<Plant>,
    /// What the force of each control bearing does to the coordinates.
    columns: Vec<Direction>,
    clearances: Vec<f64>,
    /// The loop of each control bearing.
    pub(crate) controllers: Vec<Controller>,
    /// Displacements, velocities, and what flows in the loop.
    state: Vec<C64>,
    /// The state at which a stage looks.
    stage: Vec<C64>,
    slopes: [Vec<C64>; 4],
    /// Of a loop that remembers: its command and the rate of that at both ends of a stretch.
    remembered: Vec<[(C64, C64); 2]>,
    /// Displacement, velocity and acceleration at the stations, unless those are the coordinates.
    stations: [Vec<C64>; 3],
    /// Times closer than this are one.
    tolerance: f64,
}

impl Integrator {
    pub(crate) fn new(
        plant: Arc<Plant>,
        columns: Vec<Direction>,
        clearances: Vec<f64>,
        controllers: Vec<Controller>,
        dtau: f64,
    ) -> Self {
        let width = 2 * plant.order() + controllers.iter().map(Controller::order).sum::<usize>();
        let stations = if plant.stations_are_coordinates() { 0 } else { plant.stations().len() };
        Self {
            clearances,
            controllers,
            state: vec![C64::ZERO; width],
            stage: vec![C64::ZERO; width],
            slopes: std::array::from_fn(|_| vec![C64::ZERO; width]),
            stations: std::array::from_fn(|_| vec![C64::ZERO; stations]),
            tolerance: SAME_TIME * dtau,
            remembered: vec![Default::default(); columns.len()],
            columns,
            plant,
        }
    }

    fn order(&self) -> usize {
        self.plant.order()
    }

    pub(crate) fn displacement(&self) -> &[C64] {
        &self.state[..self.order()]
    }

    pub(crate) fn velocity(&self) -> &[C64] {
        &self.state[self.order()..2 * self.order()]
    }

    pub(crate) fn velocity_mut(&mut self) -> &mut [C64] {
        let n = self.order();
        &mut self.state[n..2 * n]
    }

    /// Whether every number in it is finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.state.iter().all(|z| z.is_finite()) && self.outputs().all(|output| output.delivered.is_finite())
    }

    /// Puts the plant somewhere; the loop stays as it is.
    pub(crate) fn place(&mut self, displacement: &[C64], velocity: &[C64]) {
        let n = self.order();
        self.state[..n].copy_from_slice(displacement);
        self.state[n..2 * n].copy_from_slice(velocity);
    }

    /// Back to rest.
    pub(crate) fn rest(&mut self) {
        self.state.fill(C64::ZERO);
        self.controllers.iter_mut().for_each(Controller::rest);
    }

    /// Bit `i` is set while contact `i` is closed.
    pub(crate) fn contact(&self) -> u32 {
        let closed = |(contact, clearance): (&rotor::Contact, &f64)| {
            let r = self.plant.stations()[contact.station].row.read(self.displacement());
            contact.stiffness > 0.0 && r.norm_sqr() > clearance * clearance
        };
        let contacts = self.plant.contacts().iter().zip(&self.clearances).take(32).enumerate();
        contacts.filter(|(_, pair)| closed(*pair)).fold(0, |mask, (i, _)| mask | 1 << i)
    }

    /// The farthest that any station is from its centre.
    pub(crate) fn largest_radius(&self) -> f64 {
        let stations = self.plant.stations().iter();
        stations.map(|s| s.row.read(self.displacement()).norm_sqr()).fold(0.0, f64::max).sqrt()
    }

    /// Draws the noise of a step.
    pub(crate) fn begin_step(&mut self) {
        self.controllers.iter_mut().for_each(Controller::begin_step);
    }

    /// Advances from `from` to `to`, stopping wherever something jumps.
    pub(crate) fn advance(&mut self, from: f64, to: f64, motion: &mut Motion) {
        let mut now = from;
        while now < to {
            motion.pass(now);
            self.act(now, motion.speed_at(now));
            let event = self.controllers.iter().map(Controller::next_event).fold(f64::INFINITY, f64::min);
            let next = event.min(motion.until());
            // What is due within rounding of the end is due at the end.
            let until = if next + self.tolerance >= to { to } else { next.max(now + self.tolerance) };
            self.stretch(now, until, motion);
            now = until;
        }
        motion.pass(to + self.tolerance);
    }

    /// Reads the sample that is due at `tau`, for a law outside. Returns whether one was read now.
    pub(crate) fn sense(&mut self, tau: f64, speed: f64) -> bool {
        let n = self.order();
        let Self { plant, controllers, state, stations, .. } = self;
        if !controllers.iter().any(Controller::may_be_external) {
            return false;
        }
        let stage = seen(plant, stations, state, tau, 0.0, speed);
        let (mut held, mut any) = (&state[2 * n..], false);
        for controller in controllers {
            let (own, rest) = held.split_at(controller.order());
            any |= controller.sense(&stage, own);
            held = rest;
        }
        any
    }

    fn act(&mut self, tau: f64, speed: f64) {
        let n = self.order();
        let Self { plant, controllers, state, stations, .. } = self;
        let stage = seen(plant, stations, state, tau, 0.0, speed);
        let mut held = &state[2 * n..];
        for controller in controllers {
            let (own, rest) = held.split_at(controller.order());
            controller.act(&stage, own);
            held = rest;
        }
    }

    /// Integrates over a stretch within which nothing jumps.
    fn stretch(&mut self, from: f64, to: f64, motion: &mut Motion) {
        let dtau = to - from;
        let half = 0.5 * dtau;
        let mut course = Course::of(motion, from, to);
        let drive = motion.drive();
        loop {
            self.stage.copy_from_slice(&self.state);
            let rate = self.slope(0, from, 0.0, &course.spins[0], drive.as_ref());
            let remembers = self.remembers();
            if remembers {
                self.commands(from, 0.0, &course.spins[0], 0, 0);
            }
            self.step_to(half, 0);
            course.go(1, half, rate);
            let rate = self.slope(1, from + half, half, &course.spins[1], drive.as_ref());
            self.step_to(half, 1);
            course.go(2, half, rate);
            let rate = self.slope(2, from + half, half, &course.spins[2], drive.as_ref());
            self.step_to(dtau, 2);
            course.go(3, dtau, rate);
            let rate = self.slope(3, to, dtau, &course.spins[3], drive.as_ref());
            course.end(dtau, rate);
            let sixth = dtau / 6.0;
            let [k0, k1, k2, k3] = &self.slopes;
            for (i, (stage, state)) in self.stage.iter_mut().zip(&self.state).enumerate() {
                *stage = state + (k0[i] + (k1[i] + k2[i]) * 2.0 + k3[i]) * sixth;
            }
            if !remembers {
                break;
            }
            // The rates at the end close the stretch of the commands that are remembered.
            self.slope(3, to, dtau, &course.last, drive.as_ref());
            self.commands(to, dtau, &course.last, 3, 1);
            // Of one delay all, they ask for another pass together.
            let mut again = false;
            for (controller, [start, end]) in self.controllers.iter_mut().zip(&self.remembered) {
                again |= controller.remember(from, to, *start, *end);
            }
            if !again {
                break;
            }
        }
        std::mem::swap(&mut self.state, &mut self.stage);
        let n = self.order();
        let Self { plant, controllers, state, stations, .. } = self;
        let stage = seen(plant, stations, state, to, dtau, course.last.speed);
        let mut held = &state[2 * n..];
        for controller in controllers {
            let (own, rest) = held.split_at(controller.order());
            controller.finish(&stage, own);
            held = rest;
        }
        if drive.is_some() {
            motion.driven_to(to, course.angle, course.last.speed, course.rate);
        }
    }

    /// `state + h slope` into the stage.
    fn step_to(&mut self, h: f64, slope: usize) {
        for ((stage, state), slope) in self.stage.iter_mut().zip(&self.state).zip(&self.slopes[slope]) {
            *stage = state + slope * h;
        }
    }

    /// The rates of everything at the stage, into slope `into`, and that of the speed.
    fn slope(&mut self, into: usize, tau: f64, since: f64, spin: &Spin, drive: Option<&Drive>) -> f64 {
        let n = self.order();
        let Self { plant, controllers, stage, slopes, stations, clearances, columns, .. } = self;
        let (velocity, rest) = slopes[into].split_at_mut(n);
        let (acceleration, flow) = rest.split_at_mut(n);
        velocity.copy_from_slice(&stage[n..2 * n]);
        plant.acceleration(spin, clearances, &stage[..n], &stage[n..2 * n], acceleration);
        let looked = seen(plant, stations, stage, tau, since, spin.speed);
        let (mut held, mut rates) = (&stage[2 * n..], flow);
        for (controller, column) in controllers.iter_mut().zip(columns.iter()) {
            let (own, rest) = held.split_at(controller.order());
            let (own_rates, rest_of_rates) = rates.split_at_mut(controller.order());
            column.add(controller.flow(&looked, own, own_rates), acceleration);
            (held, rates) = (rest, rest_of_rates);
        }
        let Some(drive) = drive else { return spin.acceleration };
        // A spin that is driven comes without its own acceleration: it follows from the others, and they from it.
        let rate = drive.acceleration(spin.speed, plant.torque(spin.direction, acceleration));
        let turned = C64::new(0.0, -rate) * spin.direction;
        acceleration.iter_mut().zip(plant.unbalance()).for_each(|(a, unbalance)| *a += unbalance * turned);
        rate
    }

    /// Whether an excitation goes on after `tau`.
    pub(crate) fn is_excited(&self, tau: f64) -> bool {
        self.controllers.iter().any(|controller| controller.is_excited(tau))
    }

    /// Whether the loops remember their commands.
    fn remembers(&self) -> bool {
        self.controllers.iter().any(Controller::remembers)
    }

    /// Notes the command of every loop at the stage and its rate, as those at the beginning (0) or end (1) of a stretch.
    fn commands(&mut self, tau: f64, since: f64, spin: &Spin, slope: usize, end: usize) {
        let n = self.order();
        let Self { plant, controllers, stage, slopes, stations, remembered, .. } = self;
        let [place, pace, push] = stations;
        if !plant.stations_are_coordinates() {
            read(plant, &slopes[slope][n..2 * n], push);
            read(plant, &stage[..n], place);
            read(plant, &stage[n..2 * n], pace);
        }
        let of = |own: &'_ [C64]| own.is_empty();
        let (p, v, a) = if of(place) {
            (&stage[..n], &stage[n..2 * n], &slopes[slope][n..2 * n])
        } else {
            (&place[..], &pace[..], &push[..])
        };
        let at = Stage { tau, since, speed: spin.speed, displacement: p, velocity: v };
        let rates = Stage { displacement: v, velocity: a, ..at };
        let (mut held, mut flow) = (&stage[2 * n..], &slopes[slope][2 * n..]);
        for (controller, remembered) in controllers.iter_mut().zip(remembered) {
            let (own, rest) = held.split_at(controller.order());
            let (own_flow, rest_of_flow) = flow.split_at(controller.order());
            remembered[end] = controller.command_and_rate(&at, own, &rates, own_flow);
            (held, flow) = (rest, rest_of_flow);
        }
    }

    /// The output of every loop in the present state, at rest since the last stretch.
    pub(crate) fn outputs(&self) -> impl Iterator<Item = Output> + '_ {
        self.controllers.iter().map(Controller::output)
    }
}

/// The spin at the four stages of a stretch: as its legs have it, or step by step as the drive makes it.
struct Course {
    spins: [Spin; 4],
    /// The spin at the end, which that of the fourth stage comes near.
    last: Spin,
    /// Angle and speed at the beginning, where the spin is driven.
    began: Option<(f64, f64)>,
    /// Speeds and rates of change of the stages so far, weighted as the method does: their sums.
    sums: [f64; 2],
    angle: f64,
    rate: f64,
}

impl Course {
    fn of(motion: &Motion, from: f64, to: f64) -> Self {
        let half = 0.5 * (to - from);
        let began = motion.drive().map(|_| (motion.angle_at(from), motion.speed_at(from)));
        let spins = match began {
            None => {
                let [start, middle, end] = [from, from + half, to].map(|tau| motion.spin_at(tau));
                [start, middle, middle, end]
            }
            Some((angle, speed)) => [Spin { speed, acceleration: 0.0, direction: C64::cis(angle) }; 4],
        };
        Self { last: spins[3], spins, began, sums: [0.0; 2], angle: 0.0, rate: 0.0 }
    }

    /// Goes on to stage `k`, `h` from the beginning, at the speed of the stage before and the rate of change found there.
    fn go(&mut self, k: usize, h: f64, rate: f64) {
        let Some((angle, speed)) = self.began else { return };
        let before = self.spins[k - 1].speed;
        let weight = if k == 1 { 1.0 } else { 2.0 };
        if k == 1 {
            self.sums = [0.0; 2];
        }
        self.sums[0] += weight * before;
        self.sums[1] += weight * rate;
        self.spins[k] = Spin { speed: speed + h * rate, acceleration: 0.0, direction: C64::cis(angle + h * before) };
    }

    /// Finds the spin at the end, with the rate of change at the fourth stage.
    fn end(&mut self, dtau: f64, rate: f64) {
        let Some((angle, speed)) = self.began else { return };
        let last = self.spins[3].speed;
        self.angle = angle + dtau / 6.0 * (self.sums[0] + last);
        self.rate = rate;
        let speed = speed + dtau / 6.0 * (self.sums[1] + rate);
        self.last = Spin { speed, acceleration: 0.0, direction: C64::cis(self.angle) };
    }
}

fn read(plant: &Plant, coordinates: &[C64], out: &mut [C64]) {
    out.iter_mut().zip(plant.stations()).for_each(|(out, station)| *out = station.row.read(coordinates));
}

/// What the loop sees of a state.
fn seen<'a>(
    plant: &Plant,
    stations: &'a mut [Vec<C64>; 3],
    state: &'a [C64],
    tau: f64,
    since: f64,
    speed: f64,
) -> Stage<'a> {
    let n = plant.order();
    let (displacement, velocity) = state[..2 * n].split_at(n);
    if plant.stations_are_coordinates() {
        return Stage { tau, since, speed, displacement, velocity };
    }
    let [place, pace, _] = stations;
    read(plant, displacement, place);
    read(plant, velocity, pace);
    Stage { tau, since, speed, displacement: place, velocity: pace }
}
