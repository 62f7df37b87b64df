//! Pedestals: nodes beyond the shaft that bearings are linked to (`n_link`), each with a point mass and with bearings of its own to the
//! ground.

use super::{BEARINGS, Element, Import, Value, bearing::bearing};
use crate::{Coefficient, Pedestal};

/// Notes which nodes beyond the shaft carry a point mass, in their order: what is linked to one of them stands on a pedestal.
pub(super) fn pedestals(import: &mut Import<'_>, elements: &[Element]) {
    let is_beyond = |n: f64| n.fract() == 0.0 && n >= import.nodes as f64;
    for (at, element) in elements.iter().enumerate().filter(|(_, element)| element.class() == "PointMass") {
        if let Some(n) = node(element, "n").filter(|n| is_beyond(*n))
            && !import.pedestal_nodes.contains(&n)
            && elements.iter().any(|other| node(other, "n_link") == Some(n))
        {
            import.origins.push(("pedestal", import.pedestal_nodes.len(), at));
            import.pedestal_nodes.push(n);
            import.sketch.pedestals.push(Pedestal::default());
        }
    }
}

/// Which pedestal an element is at by its `key`, `n` or `n_link`.
pub(super) fn pedestal_of(import: &Import<'_>, element: &Element, key: &str) -> Option<usize> {
    let n = node(element, key)?;
    import.pedestal_nodes.iter().position(|pedestal| *pedestal == n)
}

/// The pedestal that a bearing is linked to; what else it is linked to is refused by name.
pub(super) fn linked(import: &mut Import<'_>, element: &Element) -> Option<usize> {
    element.get("n_link")?;
    let found = pedestal_of(import, element, "n_link");
    if found.is_none() {
        let n = node(element, "n_link").map_or_else(|| "that is no number".into(), |n| format!("= {n}"));
        let expected = format!(
            "a node beyond the shaft, {} or more, with a PointMass: a pedestal; two shafts on each other are not taken over",
            import.nodes
        );
        import.document.fault(&element.span, format!("{}: n_link {n}", element.name), expected);
    }
    found
}

/// An element that is part of a pedestal.
pub(super) fn part(import: &mut Import<'_>, pedestal: usize, element: &Element) {
    if element.class() == "PointMass" {
        let mass = import.point_mass(element);
        import.sketch.pedestals[pedestal].mass += mass;
        return;
    }
    let refuse = |import: &mut Import<'_>, found: &str, expected: &str| {
        import.document.fault(&element.span, format!("{}: {found}", element.name), expected);
    };
    if !BEARINGS.contains(&element.class()) || element.get("n_link").is_some() {
        let found = format!("an element at node {} of a pedestal", node(element, "n").unwrap_or_default());
        refuse(import, &found, "a PointMass, or a bearing between it and the ground, without n_link");
        return;
    }
    let Some(ground) = bearing(import, element, 0) else { return };
    let constant = |coefficient: &Coefficient| match coefficient {
        Coefficient::Constant(value) => Some(*value),
        Coefficient::Table(_) => None,
    };
    let numbers = [&ground.stiffness, &ground.damping, &ground.cross_stiffness].map(constant);
    let [Some(stiffness), Some(damping), Some(cross_stiffness)] = numbers else {
        refuse(import, "coefficients over speed", "constants: a pedestal does not know of the speed");
        return;
    };
    if !ground.cross_damping.is_zero() {
        refuse(import, "cxy that is not 0", "0: what holds a pedestal has no cross-coupled damping");
    }
    let whole = &mut import.sketch.pedestals[pedestal];
    whole.mass += ground.mass;
    whole.stiffness += stiffness;
    whole.damping += damping;
    whole.cross_stiffness += cross_stiffness;
}

fn node(element: &Element, key: &str) -> Option<f64> {
    match element.get(key) {
        Some(Value::Number(n)) if n.is_finite() => Some(*n),
        _ => None,
    }
}
