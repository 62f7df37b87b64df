//! What if: the machine run on from a recorded step with other settings, beside what happened.
//!
//! Everything else that was done to the machine is done to this one too: impulses, restarts and changes of other settings
//! come at the steps at which they came. With nothing changed it reproduces what happened to the last bit, as far as the
//! recording tells on which line of time the run was ([`Line`]).

use rotor::{C64, MAX_MASSES, Rotor, Settings, Spectrum, Stepper};
use wire::State;
use wire::message::Trip;

use crate::clerk::{self, Edit};

/// Numbers that the steps of a branch may take: a million steps of three masses, 64 MB.
const MOST: usize = 8_000_000;

/// Something that was done to the machine, before the step of that number.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Act {
    /// An impulse on a mass.
    Impulse(usize, C64),
    /// Back to rest.
    Restart,
    /// Other settings.
    Settings(Settings),
}

/// The line of time that a run is on: where its clock was set last, and how many steps ago.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) tau: f64,
    pub(crate) angle: f64,
    pub(crate) steps: u64,
}

/// The moment from which a branch runs on.
#[derive(Clone, Debug)]
pub(crate) struct Root {
    pub(crate) rotor: Rotor,
    pub(crate) dtau: f64,
    /// The step it begins after.
    pub(crate) state: State,
    /// The settings that this step was made with.
    pub(crate) settings: Settings,
    pub(crate) line: Line,
}

/// What a person has changed.
#[derive(Clone, Debug, PartialEq)]
struct Wish {
    settings: Settings,
    acts: Vec<(u64, Act)>,
}

/// A machine beside the recorded one.
pub(crate) struct Branch {
    root: Root,
    wish: Wish,
    done: Vec<Wish>,
    undone: Vec<Wish>,
    run: Run,
}

/// The machine in motion.
struct Run {
    stepper: Box<dyn Stepper>,
    /// The settings in force.
    settings: Settings,
    min_damping: Option<f64>,
    /// The number of the next step.
    next: u64,
    trip: Option<Trip>,
    /// The last state in which everything was finite: position and velocity.
    good: ([C64; MAX_MASSES], [C64; MAX_MASSES]),
    /// Step after step from the root on: `u_y`, `u_z`, then `y`, `z` of every mass.
    rows: Vec<f64>,
}

impl Branch {
    /// A machine that goes on from `root` as it was.
    pub(crate) fn new(root: Root) -> Self {
        let wish = Wish { settings: root.settings.clone(), acts: Vec::new() };
        let run = Run::new(&root, &wish.settings);
        Self { root, wish, done: Vec::new(), undone: Vec::new(), run }
    }

    /// The same wishes from another moment on.
    pub(crate) fn moved_to(&self, root: Root) -> Self {
        let mut moved = Self::new(root);
        clerk::carry_over(&self.root.settings, &self.wish.settings, &mut moved.wish.settings);
        moved
    }

    /// The step it begins after.
    pub(crate) fn from(&self) -> u64 {
        self.root.state.seq
    }

    /// The settings in force in it.
    pub(crate) fn settings(&self) -> &Settings {
        &self.run.settings
    }

    /// The smallest damping ratio under them.
    pub(crate) fn min_damping(&self) -> Option<f64> {
        self.run.min_damping
    }

    /// What has tripped it, if it has.
    pub(crate) fn trip(&self) -> Option<Trip> {
        self.run.trip
    }

    /// Takes an edit at step `at`, not before the root. Returns what was done, in words, or why not.
    pub(crate) fn edit(&mut self, edit: &Edit, at: u64) -> Result<String, String> {
        let mut wish = self.wish.clone();
        let words = match edit {
            Edit::Undo => {
                let last = self.done.pop().ok_or("nothing to undo")?;
                self.undone.push(std::mem::replace(&mut self.wish, last));
                return Ok("undone".into());
            }
            Edit::Redo => {
                let next = self.undone.pop().ok_or("nothing to redo")?;
                self.done.push(std::mem::replace(&mut self.wish, next));
                return Ok("done again".into());
            }
            Edit::Impulse(mass, velocity) => {
                wish.acts.push((at + 1, Act::Impulse(*mass, *velocity)));
                format!("impulse {} on mass {}", velocity.re, mass + 1)
            }
            Edit::Restart => {
                wish.acts.push((at + 1, Act::Restart));
                "restarts from rest".to_owned()
            }
            Edit::Note(_) => return Err("a recording takes no more notes".into()),
            edit => {
                edit.change(&mut wish.settings)?;
                edit.what()
            }
        };
        wish.settings.check(&self.root.rotor).map_err(|error| error.to_string())?;
        self.done.push(std::mem::replace(&mut self.wish, wish));
        self.undone.clear();
        Ok(words)
    }

    /// Runs it all over again from the root on, as far as step `to`: the wishes hold from the beginning.
    pub(crate) fn rerun(&mut self, to: u64, acts: &[(u64, Act)]) {
        self.run = Run::new(&self.root, &self.wish.settings);
        self.advance(to, acts);
    }

    /// Runs on as far as step `to`; `acts` is what was done to the recorded machine, ascending in step.
    pub(crate) fn advance(&mut self, to: u64, acts: &[(u64, Act)]) {
        let mut recorded = acts.partition_point(|(at, _)| *at < self.run.next);
        while self.run.next <= to && self.run.rows.len() < MOST {
            let seq = self.run.next;
            while let Some((_, act)) = acts.get(recorded).filter(|(at, _)| *at == seq) {
                self.run.act(&self.root, &self.wish, act);
                recorded += 1;
            }
            for (_, act) in self.wish.acts.iter().filter(|(at, _)| *at == seq) {
                self.run.act(&self.root, &self.wish, act);
            }
            self.run.step(self.root.dtau);
        }
    }

    fn row(&self, seq: u64) -> Option<&[f64]> {
        let width = 2 + 2 * self.root.rotor.len();
        let at = usize::try_from(seq.checked_sub(self.from())?).ok()?.checked_mul(width)?;
        self.run.rows.get(at..at + width)
    }

    /// Displacement `[y, z]` of a mass at step `seq`, if it has come to that.
    pub(crate) fn place(&self, seq: u64, mass: usize) -> Option<[f64; 2]> {
        self.row(seq).map(|row| [row[2 + 2 * mass], row[3 + 2 * mass]])
    }

    /// Control `[y, z]` at step `seq`.
    pub(crate) fn force(&self, seq: u64) -> Option<[f64; 2]> {
        self.row(seq).map(|row| [row[0], row[1]])
    }
}

impl Run {
    fn new(root: &Root, wanted: &Settings) -> Self {
        let of = |settings: &Settings| settings.closed_loop(&root.rotor);
        let mut stepper = rotor::stepper(&of(&root.settings));
        let points = root.state.points();
        let [displacement, velocity]: [Vec<C64>; 2] = [
            points.iter().map(|point| C64::new(point.y, point.z)).collect(),
            points.iter().map(|point| C64::new(point.vy, point.vz)).collect(),
        ];
        stepper.place(&displacement, &velocity);
        stepper.set_clock(root.line.tau, root.line.angle, root.line.steps, root.dtau);
        stepper.load(&of(wanted));
        let held = root.state.flags.has(wire::Flags::TRIPPED);
        let mut run = Self {
            stepper,
            settings: wanted.clone(),
            min_damping: None,
            next: root.state.seq + 1,
            trip: held.then(Trip::default),
            good: ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]),
            rows: Vec::new(),
        };
        run.good.0[..displacement.len()].copy_from_slice(&displacement);
        run.good.1[..velocity.len()].copy_from_slice(&velocity);
        run.keep();
        run.judge(&root.rotor);
        run
    }

    fn act(&mut self, root: &Root, wish: &Wish, act: &Act) {
        match act {
            Act::Impulse(mass, velocity) => self.stepper.kick(*mass, *velocity),
            Act::Restart => {
                self.stepper.rest();
                self.trip = None;
            }
            Act::Settings(recorded) => {
                let mut settings = recorded.clone();
                clerk::carry_over(&root.settings, &wish.settings, &mut settings);
                self.stepper.load(&settings.closed_loop(&root.rotor));
                self.settings = settings;
                self.judge(&root.rotor);
            }
        }
    }

    /// The minimum damping under the settings in force.
    fn judge(&mut self, rotor: &Rotor) {
        self.min_damping = Spectrum::of(&self.settings.closed_loop(rotor)).ok().map(|spectrum| spectrum.min_damping());
    }

    /// One step, as the simulation makes it: past the trip limit, or out of the range of numbers, it is held.
    fn step(&mut self, dtau: f64) {
        if self.trip.is_none() {
            self.stepper.step(dtau);
            let (motion, control) = (self.stepper.motion(), self.stepper.control());
            let (n, radius) = (motion.displacement.len(), motion.largest_radius());
            if motion.is_finite() && radius.is_finite() && control.re.is_finite() && control.im.is_finite() {
                self.good.0[..n].copy_from_slice(motion.displacement);
                self.good.1[..n].copy_from_slice(motion.velocity);
                if radius > self.settings.trip {
                    self.trip = Some(self.tripped(1, n));
                }
            } else {
                self.stepper.place(&self.good.0[..n], &self.good.1[..n]);
                self.trip = Some(self.tripped(2, n));
            }
        }
        self.keep();
        self.next += 1;
    }

    fn tripped(&self, cause: u32, masses: usize) -> Trip {
        let radius = |mass: &usize| self.good.0[*mass].norm();
        let mass = (0..masses).max_by(|a, b| radius(a).total_cmp(&radius(b))).unwrap_or(0);
        Trip { cause, mass: mass as u32 + 1, step: self.next, radius: radius(&mass), limit: self.settings.trip }
    }

    fn keep(&mut self) {
        let control = self.stepper.control();
        self.rows.extend([control.re, control.im]);
        self.rows.extend(self.stepper.motion().displacement.iter().flat_map(|p| [p.re, p.im]));
    }
}
