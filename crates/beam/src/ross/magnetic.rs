//! Magnetic bearings: what they are made of, not the stiffness and damping that ROSS has made of that.
//!
//! ROSS tabulates the controller at the frequency of the spin, as if every pole whirled with it. Here the magnet is linear about its bias
//! (Schweitzer & Maslen 2009, ch. 4), with `mu0 = 4 pi 1e-7`, and the controller stays what it is:
//!
//! ```text
//! ki   = 4 mu0 n^2 A i0 cos(a) / (4 g0^2)        |ks| = 4 mu0 n^2 A i0^2 cos(a) / (4 g0^3)
//! force on the rotor = |ks| p - ki k_amp k_sense C(s) p
//! ```

use super::{Element, Import};
use crate::{ImportedController, Magnetic};

const MU0: f64 = 4e-7 * std::f64::consts::PI;

/// Whether an element has what makes a magnet, though it be saved as a plain bearing.
pub(super) fn is_magnetic(element: &Element) -> bool {
    ["g0", "i0", "ag", "nw"].into_iter().all(|key| element.get(key).is_some())
}

pub(super) fn magnetic(import: &mut Import<'_>, at: usize, element: &Element) {
    let station = import.document.node(element, import.nodes);
    let [gap, area, turns] = ["g0", "ag", "nw"].map(|key| import.document.number(element, key, None));
    let angle = import.document.number(element, "alpha", Some(std::f64::consts::FRAC_PI_8));
    let bias = both(import, element, "i0", None);
    if element.get("n_link").is_some() {
        let found = format!("{}: n_link", element.name);
        import.document.fault(&element.span, found, "a bearing between the rotor and the ground, without n_link");
    }
    for (key, value) in [("g0", gap), ("ag", area), ("nw", turns), ("i0", bias)] {
        if value <= 0.0 {
            let found = format!("{}: {key} = {value}", element.name);
            import.document.fault(&element.span, found, "a number greater than 0");
        }
    }
    let pull = MU0 * turns * turns * area * angle.cos();
    let name = import.key(element);
    let controller = controller(import, element);
    if controller.is_none() {
        import.note(
            element,
            "a magnetic bearing whose controller the file does not have: its magnet is taken, a controller is missing",
        );
    }
    import.origins.push(("magnetic", import.sketch.magnetics.len(), at));
    import.sketch.magnetics.push(Magnetic {
        name,
        station,
        sensor: station,
        force_per_current: pull * bias / (gap * gap),
        negative_stiffness: pull * bias * bias / (gap * gap * gap),
        clearance: 0.0,
        touchdown_stiffness: None,
        controller,
    });
}

/// A number that may be given for each direction.
fn both(import: &mut Import<'_>, element: &Element, key: &str, otherwise: Option<f64>) -> f64 {
    match import.document.numbers(element, key).as_slice() {
        [x, y] => import.mean(element, (&format!("{key} of x"), *x), (&format!("{key} of y"), *y)),
        _ => import.document.number(element, key, otherwise),
    }
}

/// `C(s)` in A/m, amplifier and sensor with it.
fn controller(import: &mut Import<'_>, element: &Element) -> Option<ImportedController> {
    let gain = both(import, element, "k_amp", Some(1.0)) * both(import, element, "k_sense", Some(1.0));
    let numerator = import.document.numbers(element, "controller_transfer_function_num");
    let denominator = import.document.numbers(element, "controller_transfer_function_den");
    let (numerator, denominator) = if numerator.is_empty() || denominator.is_empty() {
        let [kp, ki, kd] = ["kp_pid", "ki_pid", "kd_pid"].map(|key| import.document.number(element, key, Some(0.0)));
        pid(kp, ki, kd, import.document.number(element, "n_f", Some(10_000.0)))?
    } else {
        (led(&numerator)?, led(&denominator)?)
    };
    Some(ImportedController { numerator: numerator.into_iter().map(|c| c * gain).collect(), denominator })
}

/// Coefficients without zeros in front of them.
fn led(coefficients: &[f64]) -> Option<Vec<f64>> {
    let first = coefficients.iter().position(|&c| c != 0.0)?;
    Some(coefficients[first..].to_vec())
}

/// `Kp + Ki / s + Kd s / (1 + s / N)` over one denominator; `None` if there are no gains.
fn pid(kp: f64, ki: f64, kd: f64, corner: f64) -> Option<(Vec<f64>, Vec<f64>)> {
    let slow = if kd == 0.0 { 0.0 } else { 1.0 / corner };
    let numerator = [kp * slow + kd, kp + ki * slow, ki];
    let denominator = [slow, 1.0, 0.0];
    let last = if ki == 0.0 { 2 } else { 3 };
    Some((led(&numerator[..last])?, led(&denominator[..last])?))
}
