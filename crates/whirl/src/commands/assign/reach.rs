//! `whirl assign --table`: what each bearing and sensor reaches.

use rotor::{C64, ClosedLoop, Influence, PBH_LIMIT, Rotor};
use serde::Serialize;

use crate::commands::linear::ComplexDocument;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table};
use crate::units::{CommandUnits, UnitsDocument};

/// The JSON document of `--table`.
#[derive(Debug, Serialize)]
struct Reach<'a> {
    rotor: &'a str,
    speed: f64,
    modes: Vec<ReachOfMode>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// Per mode, one entry a mass.
#[derive(Debug, Serialize)]
struct ReachOfMode {
    re: f64,
    im: f64,
    whirl: rotor::Whirl,
    shape: Vec<ComplexDocument>,
    controllability: Vec<f64>,
    observability: Vec<f64>,
    pbh: Vec<f64>,
    controllable: Vec<bool>,
}

/// Prints how well a bearing or sensor at each mass reaches each mode of the rotor that `closed_loop` is made of.
///
/// # Errors
/// Eigenvalues that do not converge.
pub(super) fn run(rotor: &Rotor, closed_loop: &ClosedLoop, format: Format) -> Result<(), Failure> {
    let (reach, units) = (rotor::influence(closed_loop)?, CommandUnits::of(rotor));
    let whirl = |pole: C64| rotor::Mode { pole, shape: vec![] }.whirl();
    let reaches = |mode: &Influence, mass: usize| mode.pbh[mass] >= PBH_LIMIT;
    let mut table = Table::new(units.pick(
        &["re", "im", "whirl", "mass", "control", "observe", "pbh", "controllable"],
        &["re (1/s)", "im (rad/s)", "whirl", "mass", "control", "observe", "pbh", "controllable"],
    ));
    for mode in &reach {
        for mass in 0..rotor.len() {
            let word = if reaches(mode, mass) { "yes" } else { "NO" };
            table.row([
                units.rate(mode.pole.re).into(),
                units.rate(mode.pole.im).into(),
                Cell::from(&whirl(mode.pole)),
                Cell::from(&(mass + 1)),
                mode.controllability[mass].into(),
                mode.observability[mass].into(),
                mode.pbh[mass].into(),
                Cell::from(&word),
            ]);
        }
    }
    let document = Reach {
        rotor: rotor.name(),
        speed: closed_loop.speed(),
        modes: reach
            .iter()
            .map(|mode| ReachOfMode {
                re: mode.pole.re,
                im: mode.pole.im,
                whirl: whirl(mode.pole),
                shape: mode.shape.iter().map(|&p| p.into()).collect(),
                controllability: mode.controllability.clone(),
                observability: mode.observability.clone(),
                pbh: mode.pbh.clone(),
                controllable: (0..rotor.len()).map(|mass| reaches(mode, mass)).collect(),
            })
            .collect(),
        units: units.document(),
    };
    format.print(
        &document,
        &format!(
            "{} at {}, control off: what a bearing or a displacement sensor at each mass reaches",
            rotor.name(),
            units.speed_text(closed_loop.speed())
        ),
        &table,
        "control, observe: cosines between 0 and 1; pbh: least singular value of [A - lambda I, b] over |A|, 0 if the mode stays",
    )
}
