//! What `whirl run` prints.

use rotor::Stability;
use serde::Serialize;
use study::disturbance::{self, DisturbanceGrowth, Means};
use study::run::{Outcome, Settled};
use study::spectrum::{Peak, Spectrum};

use crate::catalog::Machine;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, rounded};
use crate::units::UnitsDocument;

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    deadband: &'a [f64],
    /// The longest step taken, and the shortest if they are not all even: impulses part them.
    dtau: f64,
    shortest_dtau: f64,
    steps: u64,
    seconds: f64,
    diverged: bool,
    diverged_at: Option<f64>,
    /// How the motion came to rest; `given` where the command line said from when.
    settled: Settled,
    settled_at: Option<f64>,
    /// Whether a small disturbance of the motion at the end dies away; `null` on the margin, and where no motion is steady, see
    /// `stability`.
    stable: Option<bool>,
    /// `stable`, `marginal` or `unstable`; `null` where no motion is steady: it diverged, or has not settled.
    stability: Option<Stability>,
    /// How fast the fastest disturbance grows, per unit of tau.
    growth: Option<f64>,
    /// By `eigenvalues` on a circular orbit and at rest, by `simulation` on any other: that sees growth above `growth_seen`.
    stability_by: Option<Means>,
    growth_seen: f64,
    /// The same for the rotor at rest in its centre, support bearings with clearance out of action.
    centre_stability: Option<Stability>,
    centre_growth: Option<f64>,
    maxima_from: f64,
    max_force: f64,
    max_force_component: f64,
    /// Steps at which the actuator was at its limit of force or of rate, and their share of all.
    saturated_steps: u64,
    saturated_share: f64,
    max_displacement: Vec<f64>,
    mean_radius: Vec<f64>,
    #[serde(rename = "final")]
    last: FinalDocument,
    #[serde(skip_serializing_if = "Option::is_none")]
    psd: Option<PsdDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct FinalDocument {
    tau: f64,
    masses: Vec<MassDocument>,
}

#[derive(Debug, Serialize)]
struct MassDocument {
    y: f64,
    z: f64,
    vy: f64,
    vz: f64,
}

/// The spectrum; densities are per radian per unit of tau.
#[derive(Debug, Serialize)]
struct PsdDocument {
    mass: usize,
    window: &'static str,
    segments: usize,
    resolution: f64,
    peaks: Vec<Peak>,
    frequency: Vec<f64>,
    density: Vec<f64>,
}

/// Prints what came out.
///
/// # Errors
/// The output cannot be written.
pub(super) fn print(
    format: Format,
    machine: &Machine,
    outcome: Outcome,
    seconds: f64,
    spectrum: Option<(usize, Spectrum, Vec<Peak>)>,
    profile: Option<&str>,
) -> Result<(), Failure> {
    let (Machine { rotor, settings, .. }, units) = (machine, machine.units());
    let spin = profile.map_or_else(
        || format!("at {}", units.speed_text(settings.speed)),
        |path| format!("along {path}, which ends at {}", units.speed_text_rounded(outcome.last.speed)),
    );
    // Scripts count places.
    let place = if format.csv { "mass" } else { machine.place_heading() };
    let mut table = Table::new(&units.pick(
        [place, "max radius", "mean radius", "y", "z", "vy", "vz"],
        [place, "max radius (m)", "mean radius (m)", "y (m)", "z (m)", "vy (m/s)", "vz (m/s)"],
    ));
    let last = &outcome.last;
    for (k, (p, v)) in last.displacement.iter().zip(&last.velocity).enumerate() {
        let lengths = [outcome.max_displacement[k], outcome.mean_radius[k], p.re, p.im].map(|r| units.length(r));
        let numbers = lengths.into_iter().chain([v.re, v.im].map(|v| units.velocity(v)));
        let place = if format.csv { Cell::from(&(k + 1)) } else { machine.place_cell(k) };
        table.row([place].into_iter().chain(numbers.map(Cell::from)));
    }
    let heading = format!(
        "{} {}, {} steps of {} to {}{}",
        rotor.name(),
        spin,
        outcome.steps,
        steps(outcome.step),
        units.time_text(last.tau),
        units.pick("; lengths in e_t, times in tau = w0 t, forces in w0^2 e_t", "; steps in tau = w0 t")
    );
    let force = |u: f64| {
        let shown = rounded(units.force(u, machine.bearing_mass()));
        units.pick(shown.clone(), format!("{shown} {}", units.force_unit()))
    };
    let mut footer = vec![format!(
        "largest control force {}, largest component {}; maxima and means from {}{}",
        force(outcome.max_force),
        force(outcome.max_force_component),
        units.time_text(outcome.maxima_from),
        match outcome.settled {
            Settled::Given => "",
            Settled::Steady => ", where it had settled",
            Settled::Beating => ", beating but bounded",
            Settled::No => ", NOT settled",
        }
    )];
    let share = outcome.saturated_steps as f64 / outcome.steps.max(1) as f64;
    if outcome.saturated_steps > 0 {
        let percent = rounded(100.0 * share);
        footer.push(format!("the actuator was at its limit at {} steps, {percent} % of all", outcome.saturated_steps));
    }
    footer.push(stability(&outcome));
    footer.extend(outcome.diverged_at.map(|at| format!("DIVERGED at {}", units.time_text(at))));
    if let Some((mass, _, peaks)) = &spectrum {
        let columns = units.pick("order, frequency, radius", "order, frequency in Hz, radius in m");
        footer.push(format!("spectral lines of mass {mass} ({columns}):"));
        footer.extend(peaks.iter().map(|p| {
            let [frequency, radius] = [units.frequency(p.frequency), units.length(p.radius)].map(rounded);
            format!("  {:>8}  {frequency:>10}  {radius:>10}", p.name)
        }));
    }
    let document = Document {
        rotor: rotor.name(),
        speed: settings.speed,
        deadband: &settings.deadband,
        dtau: outcome.step.0,
        shortest_dtau: outcome.step.1,
        steps: outcome.steps,
        seconds,
        diverged: outcome.diverged_at.is_some(),
        diverged_at: outcome.diverged_at,
        settled: outcome.settled,
        settled_at: matches!(outcome.settled, Settled::Steady | Settled::Beating).then_some(outcome.maxima_from),
        stable: outcome.stability.and_then(|growth| growth.stability.is_stable()),
        stability: outcome.stability.map(|growth| growth.stability),
        growth: outcome.stability.map(|growth| growth.growth),
        stability_by: outcome.stability.map(|growth| growth.by),
        growth_seen: disturbance::slowest_seen(),
        centre_stability: outcome.centre.map(|growth| growth.stability),
        centre_growth: outcome.centre.map(|growth| growth.growth),
        maxima_from: outcome.maxima_from,
        max_force: outcome.max_force,
        saturated_steps: outcome.saturated_steps,
        saturated_share: share,
        max_force_component: outcome.max_force_component,
        max_displacement: outcome.max_displacement,
        mean_radius: outcome.mean_radius,
        last: FinalDocument {
            tau: last.tau,
            masses: last
                .displacement
                .iter()
                .zip(&last.velocity)
                .map(|(p, v)| MassDocument { y: p.re, z: p.im, vy: v.re, vz: v.im })
                .collect(),
        },
        psd: spectrum.map(|(mass, spectrum, peaks)| PsdDocument {
            mass,
            window: "hann",
            segments: spectrum.segments,
            resolution: spectrum.resolution(),
            peaks,
            frequency: spectrum.frequency,
            density: spectrum.density,
        }),
        units: units.document(),
    };
    format.print(&document, &heading, &table, &machine.with_taken(&footer.join("\n")))
}

/// The steps of a run: even between impulses, so there may be several sizes.
fn steps((longest, shortest): (f64, f64)) -> String {
    let even = longest - shortest <= 1e-9 * longest;
    if even { rounded(longest) } else { format!("{} to {}", rounded(shortest), rounded(longest)) }
}

/// Whether the motion found would stay, and the centre.
fn stability(outcome: &Outcome) -> String {
    let grows = |j: DisturbanceGrowth| format!("{} (disturbances go as exp({} tau))", j.word(), rounded(j.growth));
    let centre = outcome.centre.map_or_else(|| "not told of amplifiers that differ along the axes".to_owned(), grows);
    let centre = format!("the rotor at rest in its centre: {centre}");
    match outcome.stability {
        Some(growth @ DisturbanceGrowth { by: Means::Eigenvalues, .. }) => {
            format!("this motion: {}; {centre}", grows(growth))
        }
        Some(growth @ DisturbanceGrowth { by: Means::Simulation, .. }) => format!(
            "this motion: {}, by simulation, which sees growth above {}; {centre}",
            grows(growth),
            rounded(disturbance::slowest_seen())
        ),
        None => format!("no steady motion whose stability could be told; {centre}"),
    }
}
