//! A family of operating conditions: a box of speeds, stiffness factors, parameters and delays, every point of which the
//! same gains must hold.

use rotor::{C64, ClosedLoop, FIELDS, Feedback, Mass, OperatingPoint, Plant, Quadratic, Rotor};

/// What one coordinate of a condition is.
#[derive(Clone, Debug, PartialEq)]
pub enum FamilyQuantity {
    /// Spin speed `R`.
    Speed,
    /// The factor, 0 to 1, that deadband leaves of the stiffness of the support bearings at these masses or places (from 0).
    Stiffness(Vec<usize>),
    /// A parameter of one mass (from 0): the index in [`rotor::FIELDS`].
    Parameter {
        /// Index in [`rotor::FIELDS`].
        field: usize,
        /// The mass.
        mass: usize,
    },
    /// The stiffness ratio of one shaft (from 0).
    Shaft(usize),
    /// A delay between measurement and force, in units of `tau`.
    Delay,
}

impl FamilyQuantity {
    /// Its name, as on the command line: `speed`, `factor.1`, `factor`, `damping.2`, `shaft.1`, `delay`.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Speed => "speed".into(),
            Self::Stiffness(masses) => match masses[..] {
                [mass] => format!("factor.{}", mass + 1),
                _ => "factor".into(),
            },
            Self::Parameter { field, mass } => format!("{}.{}", FIELDS[*field].name, mass + 1),
            Self::Shaft(shaft) => format!("shaft.{}", shaft + 1),
            Self::Delay => "delay".into(),
        }
    }

    /// Whether the coordinate that is stepped through is the inverse of the quantity. Masses divide everything else: in
    /// terms of `1 / Rm` the equations of motion are linear in every coordinate, which the certificate builds on.
    fn is_inverse(&self) -> bool {
        matches!(self, Self::Parameter { field: 0, .. })
    }
}

/// One coordinate with its range.
#[derive(Clone, Debug, PartialEq)]
pub struct FamilyAxis {
    /// What it is.
    pub quantity: FamilyQuantity,
    /// Its least value.
    pub from: f64,
    /// Its greatest value; the same if it does not vary.
    pub to: f64,
}

impl FamilyAxis {
    /// The range in the coordinate that is stepped through, see [`FamilyQuantity::is_inverse`].
    fn ends(&self) -> [f64; 2] {
        if self.quantity.is_inverse() { [1.0 / self.to, 1.0 / self.from] } else { [self.from, self.to] }
    }
}

/// Why a family makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FamilyError {
    /// An empty range, or one that is not finite.
    #[error("{name} = {from}..{to}: expected a range of finite numbers, the lower one first")]
    Empty {
        /// The coordinate.
        name: String,
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
    /// A value that the quantity cannot have.
    #[error("{name} = {from}..{to}: expected {expected}")]
    Value {
        /// The coordinate.
        name: String,
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
        /// What it may be, in words.
        expected: &'static str,
    },
    /// A mass or shaft that the rotor does not have.
    #[error("{name}: the rotor has {masses} masses and {} shafts", masses - 1)]
    Missing {
        /// The coordinate.
        name: String,
        /// How many masses there are.
        masses: usize,
    },
    /// A parameter of masses, of a rotor that has none.
    #[error("{0} is of a chain of masses, but this rotor is of shaft elements")]
    Chain(String),
    /// A coordinate named twice.
    #[error("{0} is given twice")]
    Twice(String),
}

/// A rotor over a box of operating conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    rotor: Rotor,
    axes: Vec<FamilyAxis>,
}

impl Family {
    /// `rotor` over all speeds `from..=to`, a single one if they are the same.
    ///
    /// # Errors
    /// A range that is empty, negative or not finite.
    pub fn new(rotor: &Rotor, from: f64, to: f64) -> Result<Self, FamilyError> {
        let mut made = Self { rotor: rotor.clone(), axes: Vec::new() };
        made.push(FamilyAxis { quantity: FamilyQuantity::Speed, from, to })?;
        Ok(made)
    }

    /// Adds a coordinate.
    ///
    /// # Errors
    /// A range that is empty or not allowed, a mass that does not exist, or a coordinate that is there already.
    pub fn push(&mut self, axis: FamilyAxis) -> Result<(), FamilyError> {
        let FamilyAxis { quantity, from, to } = &axis;
        let (name, from, to) = (quantity.name(), *from, *to);
        if !(from <= to && from.is_finite() && to.is_finite()) {
            return Err(FamilyError::Empty { name, from, to });
        }
        if self.axes.iter().any(|other| other.quantity.name() == name) {
            return Err(FamilyError::Twice(name));
        }
        if !self.rotor.is_chain() && matches!(quantity, FamilyQuantity::Parameter { .. } | FamilyQuantity::Shaft(_)) {
            return Err(FamilyError::Chain(name));
        }
        let masses = self.rotor.len();
        let (exists, expected, allowed) = match quantity {
            FamilyQuantity::Speed | FamilyQuantity::Delay => (true, "finite numbers, not negative", from >= 0.0),
            FamilyQuantity::Stiffness(of) => {
                (of.iter().all(|&i| i < masses), "factors from 0 to 1", from >= 0.0 && to <= 1.0)
            }
            FamilyQuantity::Parameter { field, mass } => {
                let domain = FIELDS[*field].domain;
                (*mass < masses, domain.words(), domain.admits(from) && domain.admits(to))
            }
            FamilyQuantity::Shaft(shaft) => (shaft + 1 < masses, "finite numbers, not negative", from >= 0.0),
        };
        if !exists {
            return Err(FamilyError::Missing { name, masses });
        }
        if !allowed {
            return Err(FamilyError::Value { name, from, to, expected });
        }
        self.axes.push(axis);
        Ok(())
    }

    /// Lets deadband leave any factor from 0 to 1 of the stiffness of every support bearing there is: each by itself, or
    /// one and the same of all.
    ///
    /// # Errors
    /// As for [`Family::push`].
    pub fn any_deadband(&mut self, each_by_itself: bool) -> Result<(), FamilyError> {
        let plant = Plant::of(&self.rotor);
        // A touchdown bearing holds nothing while all is well.
        let holds = |k: &usize| plant.contacts()[*k].stiffness > 0.0 && !plant.contacts()[*k].is_touchdown;
        let bearings: Vec<usize> = (0..plant.contacts().len()).filter(holds).collect();
        let groups: Vec<Vec<usize>> =
            if each_by_itself { bearings.into_iter().map(|i| vec![i]).collect() } else { vec![bearings] };
        for group in groups.into_iter().filter(|group| !group.is_empty()) {
            self.push(FamilyAxis { quantity: FamilyQuantity::Stiffness(group), from: 0.0, to: 1.0 })?;
        }
        Ok(())
    }

    /// The rotor as it is described, before parameters vary.
    #[must_use]
    pub fn rotor(&self) -> &Rotor {
        &self.rotor
    }

    /// Its coordinates, speed first.
    #[must_use]
    pub fn axes(&self) -> &[FamilyAxis] {
        &self.axes
    }

    /// The range of speeds.
    #[must_use]
    pub fn speeds(&self) -> (f64, f64) {
        (self.axes[0].from, self.axes[0].to)
    }

    /// The same family at one speed alone.
    #[must_use]
    pub fn at_speed(&self, speed: f64) -> Self {
        self.over_speeds(speed, speed)
    }

    /// The same family over other speeds.
    pub(crate) fn over_speeds(&self, from: f64, to: f64) -> Self {
        let mut made = self.clone();
        (made.axes[0].from, made.axes[0].to) = (from, to);
        made
    }

    /// Whether it has delays: then its poles are not those of a matrix.
    #[must_use]
    pub fn has_delay(&self) -> bool {
        self.axes.iter().any(|axis| axis.quantity == FamilyQuantity::Delay && axis.to > 0.0)
    }

    /// Indices of the coordinates that vary.
    pub(crate) fn varying(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.axes.len()).filter(|&i| self.axes[i].from < self.axes[i].to)
    }

    /// The range of coordinate `axis` as points have it.
    pub(crate) fn ends(&self, axis: usize) -> [f64; 2] {
        self.axes[axis].ends()
    }

    /// The values of the quantities at a point.
    #[must_use]
    pub fn values(&self, point: &[f64]) -> Vec<f64> {
        let value = |(axis, &at): (&FamilyAxis, &f64)| if axis.quantity.is_inverse() { 1.0 / at } else { at };
        self.axes.iter().zip(point).map(value).collect()
    }

    /// The point at which the quantities have these values: the inverse of [`Self::values`].
    #[must_use]
    pub fn point(&self, values: &[f64]) -> Vec<f64> {
        self.values(values)
    }

    /// The equations of motion of a chain at a point, control off.
    pub(crate) fn open(&self, point: &[f64]) -> Quadratic {
        let off = Feedback::new(0, Vec::new());
        Quadratic::of(&ClosedLoop::new(&self.rotor_at(point), &off, point[0], &[]))
    }

    /// The rotor without control at a point.
    pub(crate) fn plant(&self, point: &[f64]) -> Plant {
        Plant::of(&self.rotor_at(point))
    }

    /// Where [`Self::plant`] is looked at: factors of a chain are in its stiffness already.
    pub(crate) fn operating(&self, point: &[f64]) -> OperatingPoint {
        let mut at = OperatingPoint::at(point[0]);
        if self.rotor.is_chain() || self.axes.len() == 1 {
            return at;
        }
        let contacts = Plant::of(&self.rotor);
        let all = |contact: &rotor::Contact| if contact.is_touchdown { 0.0 } else { 1.0 };
        at.contact_factors = contacts.contacts().iter().map(all).collect();
        for (axis, &factor) in self.axes.iter().zip(point) {
            if let FamilyQuantity::Stiffness(of) = &axis.quantity {
                of.iter().for_each(|&i| at.contact_factors[i] = factor);
            }
        }
        at
    }

    /// The rotor at a point; of shaft elements, the rotor.
    pub(crate) fn rotor_at(&self, point: &[f64]) -> Rotor {
        if !self.rotor.is_chain() {
            return self.rotor.clone();
        }
        let mut masses = self.rotor.masses().to_vec();
        let mut shafts = self.rotor.shafts().to_vec();
        for (axis, &at) in self.axes.iter().zip(point) {
            match &axis.quantity {
                FamilyQuantity::Parameter { field, mass } => {
                    let mut values = masses[*mass].values();
                    values[*field] = if axis.quantity.is_inverse() { 1.0 / at } else { at };
                    masses[*mass] = Mass::from_values(values);
                }
                FamilyQuantity::Shaft(shaft) => shafts[*shaft] = at,
                FamilyQuantity::Speed | FamilyQuantity::Stiffness(_) | FamilyQuantity::Delay => {}
            }
        }
        // Factors act on whatever stiffness a parameter has set.
        for (axis, &at) in self.axes.iter().zip(point) {
            if let FamilyQuantity::Stiffness(of) = &axis.quantity {
                of.iter().for_each(|&i| masses[i].bearing_stiffness *= at);
            }
        }
        Rotor::new(self.rotor.name(), masses, shafts).expect("every value was checked when its range was")
    }

    /// What unbalance drives each coordinate with at a point; of a chain `Re R^2` of each mass.
    pub(crate) fn unbalance(&self, point: &[f64]) -> Vec<C64> {
        let speed = point[0];
        if !self.rotor.is_chain() {
            return Plant::of(&self.rotor).unbalance().iter().map(|u| u * (speed * speed)).collect();
        }
        let mut made: Vec<f64> = self.rotor.masses().iter().map(|mass| mass.unbalance).collect();
        for (axis, &at) in self.axes.iter().zip(point) {
            if let FamilyQuantity::Parameter { field: 5, mass } = axis.quantity {
                made[mass] = at;
            }
        }
        made.iter().map(|radius| C64::from(radius * speed * speed)).collect()
    }

    /// The delay at a point, if it is one of the coordinates.
    pub(crate) fn delay(&self, point: &[f64]) -> Option<f64> {
        self.axes.iter().zip(point).find(|(axis, _)| axis.quantity == FamilyQuantity::Delay).map(|(_, &at)| at)
    }

    /// Whether a grid of `counts` is walked whole: one that is larger than [`MOST_POINTS`] is not.
    pub(crate) fn is_grid(counts: &[usize]) -> bool {
        let points = counts.iter().try_fold(1_usize, |points, &count| points.checked_mul(count));
        points.is_some_and(|points| points <= MOST_POINTS)
    }

    /// How many points [`Self::grid`] has.
    pub(crate) fn points(counts: &[usize]) -> usize {
        if Self::is_grid(counts) { counts.iter().product() } else { SAMPLE }
    }

    /// A grid of points, with `counts[i]` along coordinate `i`, both ends included; 1 where it does not vary. If that is
    /// more than can be walked, a sample of its corners: the same every time, both that have everything at one end first.
    pub(crate) fn grid(&self, counts: &[usize]) -> Vec<Vec<f64>> {
        if !Self::is_grid(counts) {
            return self.corners();
        }
        let mut points = vec![Vec::with_capacity(self.axes.len())];
        for (i, &count) in counts.iter().enumerate() {
            let [from, to] = self.ends(i);
            let count = if from < to { count.max(2) } else { 1 };
            let at = |k: usize| if k + 1 == count { to } else { from + (to - from) * k as f64 / (count - 1) as f64 };
            points = points.iter().flat_map(|point| (0..count).map(|k| [&point[..], &[at(k)]].concat())).collect();
        }
        points
    }

    /// [`SAMPLE`] corners.
    fn corners(&self) -> Vec<Vec<f64>> {
        let mut random = fastrand::Rng::with_seed(1);
        let corner = |k: usize| {
            (0..self.axes.len())
                .map(|axis| {
                    let high = match k {
                        0 => false,
                        1 => true,
                        _ => random.bool(),
                    };
                    self.ends(axis)[usize::from(high)]
                })
                .collect()
        };
        (0..SAMPLE).map(corner).collect()
    }
}

/// A grid with more points than this is not walked: with 14 coordinates two points along each are too many.
const MOST_POINTS: usize = 10_000;
/// So many of its corners are looked at instead, and from the worst of them on by need.
const SAMPLE: usize = 200;
