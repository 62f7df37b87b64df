//! Bearings and seals, which ROSS has as coefficients over speed, whatever their class.

use super::{Element, Import, pedestal::linked};
use crate::coefficient::RAD_PER_S;
use crate::{Bearing, Coefficient};

/// How far apart two coefficients may be that are meant to be the same, beside the largest of their table.
const SAME: f64 = 1e-9;

/// A bearing at a station, unless it does nothing across the axis.
pub(super) fn bearing(import: &mut Import<'_>, element: &Element, station: usize) -> Option<Bearing> {
    let pedestal = linked(import, element);
    let speeds = import.document.numbers(element, "frequency");
    for pair in speeds.windows(2) {
        if pair[1] <= pair[0] {
            let found = format!("{}: frequency {} after {}", element.name, pair[1], pair[0]);
            import.document.fault(&element.span, found, "rising frequencies");
            break;
        }
    }
    let [(stiffness, cross_stiffness), (damping, cross_damping), (mass, cross_mass)] =
        ['k', 'c', 'm'].map(|kind| pair(import, element, kind, &speeds));
    if !cross_mass.is_zero() {
        let found = format!("{}: mxy", element.name);
        import.document.fault(&element.span, found, "0: masses that couple both planes are not taken over");
    }
    let mass = constant(import, element, &mass);
    if pedestal.is_some() && mass != 0.0 {
        let found = format!("{}: mxx = {mass} beside n_link", element.name);
        import.document.fault(&element.span, found, "0: a mass between the rotor and a pedestal is not taken over");
    }
    if speeds.len() > 1 {
        import.note(
            element,
            "its coefficients are taken linear between the speeds of its table; ROSS fits curves to them",
        );
    }
    let axial =
        ["kzz", "czz", "mzz"].into_iter().filter(|key| import.document.numbers(element, key).iter().any(|&c| c != 0.0));
    let axial: Vec<&str> = axial.collect();
    if !axial.is_empty() {
        import.note(element, format!("{} left out: nothing moves along the axis", axial.join(", ")));
    }
    let all = [&stiffness, &cross_stiffness, &damping, &cross_damping];
    if all.iter().all(|coefficient| coefficient.is_zero()) && mass == 0.0 {
        import.note(element, "left out: it does nothing across the axis");
        return None;
    }
    Some(Bearing { station, stiffness, damping, cross_stiffness, cross_damping, mass, clearance: 0.0, pedestal })
}

/// The direct and the cross-coupled coefficient of a kind, `k`, `c` or `m`.
fn pair(import: &mut Import<'_>, element: &Element, kind: char, speeds: &[f64]) -> (Coefficient, Coefficient) {
    let keys = ["xx", "yy", "xy", "yx"].map(|ends| format!("{kind}{ends}"));
    let [xx, yy, xy, yx] = keys.each_ref().map(|key| import.document.numbers(element, key));
    // What is not given is that of the other direction, or 0.
    let yy = if yy.is_empty() { xx.clone() } else { yy };
    let length = xx.len().max(yy.len()).max(xy.len()).max(yx.len()).max(1);
    let whole = |list: Vec<f64>| match list.as_slice() {
        [] => Some(vec![0.0; length]),
        [one] => Some(vec![*one; length]),
        _ => (list.len() == length).then_some(list),
    };
    let (Some(xx), Some(yy), Some(xy), Some(yx)) = (whole(xx), whole(yy), whole(xy), whole(yx)) else {
        let found = format!("{}: {} of different lengths", element.name, keys.join(", "));
        import.document.fault(&element.span, found, "as many of each as frequencies");
        return (Coefficient::ZERO, Coefficient::ZERO);
    };
    if length > 1 && length != speeds.len() {
        let found = format!("{}: {length} of {} and {} frequencies", element.name, keys[0], speeds.len());
        import.document.fault(&element.span, found, "as many coefficients as frequencies");
        return (Coefficient::ZERO, Coefficient::ZERO);
    }
    let size = xx.iter().chain(&yy).chain(&xy).chain(&yx).fold(0.0_f64, |size, c| size.max(c.abs()));
    let differs = |a: f64, b: f64| (a - b).abs() > SAME * size;
    let broken = (0..length).find(|&i| differs(xx[i], yy[i]) || differs(xy[i], -yx[i]));
    let direct: Vec<f64> = xx.iter().zip(&yy).map(|(x, y)| 0.5 * (x + y)).collect();
    // What differs by rounding only is rounding; a mean of equal numbers is that number.
    let cross = xy.iter().zip(&yx).map(|(x, y)| 0.5 * (x - y));
    let cross: Vec<f64> = cross.map(|c| if c.abs() > SAME * size { c } else { 0.0 }).collect();
    if import.average {
        let speeds = if length > 1 { speeds } else { &[] };
        if (0..length).any(|i| differs(xx[i], yy[i])) {
            averaged(import, element, [(&keys[0], &xx), (&keys[1], &yy)], (&direct, ""), speeds);
        }
        if (0..length).any(|i| differs(xy[i], -yx[i])) {
            averaged(import, element, [(&keys[2], &xy), (&keys[3], &yx)], (&cross, "half their difference"), speeds);
        }
    } else if let Some(i) = broken {
        let value = |key: &str, list: &[f64]| format!("{key} = {}", list[i]);
        let (at, what) = if differs(xx[i], yy[i]) {
            (i, format!("{}, {}", value(&keys[0], &xx), value(&keys[1], &yy)))
        } else {
            (i, format!("{}, {}", value(&keys[2], &xy), value(&keys[3], &yx)))
        };
        let speed = if length > 1 { format!(" at {} rad/s", speeds[at]) } else { String::new() };
        let expected = format!(
            "{} = {} and {} = -{}: only what is the same in every direction, or their mean",
            keys[1], keys[0], keys[3], keys[2]
        );
        import.document.fault(&element.span, format!("{}: {what}{speed}", element.name), expected);
    }
    (over(speeds, direct), over(speeds, cross))
}

/// Notes which numbers were averaged, and what was taken for them: of a table all of it, because a part tells little of the rest.
fn averaged(
    import: &mut Import<'_>,
    element: &Element,
    [(x_key, x), (y_key, y)]: [(&String, &Vec<f64>); 2],
    (taken, how): (&[f64], &str),
    speeds: &[f64],
) {
    let list = |values: &[f64]| match values {
        [one] => one.to_string(),
        _ => format!("[{}]", values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")),
    };
    let at = if speeds.is_empty() { String::new() } else { format!(" at {} rad/s", list(speeds)) };
    let how = match (how, taken.len()) {
        ("", 1) => "their mean",
        ("", _) => "their means",
        (how, _) => how,
    };
    let is = if taken.len() > 1 { "are" } else { "is" };
    let (x, y, taken) = (list(x), list(y), list(taken));
    import.averaged(element, format!("{x_key} = {x}, {y_key} = {y}{at}: {how} {taken} {is} taken"));
}

/// A constant where all values are the same, otherwise a table over speeds in rad/s.
fn over(speeds: &[f64], values: Vec<f64>) -> Coefficient {
    let first = values.first().copied().unwrap_or(0.0);
    if values.iter().all(|&value| value == first) {
        return Coefficient::Constant(first);
    }
    Coefficient::Table(speeds.iter().map(|speed| speed / RAD_PER_S).zip(values).collect())
}

/// The mass of a bearing, which has to be the same at every speed.
fn constant(import: &mut Import<'_>, element: &Element, mass: &Coefficient) -> f64 {
    let values: Vec<f64> = mass.values().collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if least == most {
        return least;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let found = format!("mxx from {least} to {most} over speed");
    if import.average {
        import.averaged(element, format!("{found}: their mean {mean} is taken"));
    } else {
        let expected = "one mass at every speed, or their mean";
        import.document.fault(&element.span, format!("{}: {found}", element.name), expected);
    }
    mean
}
