//! The shaft: elements one after the other, or beside each other between the same nodes.

use super::{Element, Import, Value};
use crate::{Coupling, Disc, Material, Section, Shear, Sleeve};

/// Keys of a shaft element that mean something here, or nothing to its motion.
const KNOWN: [&str; 19] = [
    "L",
    "idl",
    "odl",
    "idr",
    "odr",
    "n",
    "axial_force",
    "torque",
    "shear_effects",
    "rotary_inertia",
    "gyroscopic",
    "shear_method_calc",
    "tag",
    "alpha",
    "beta",
    "material",
    "color",
    "scale_factor",
    "axial_cg_pos",
];

/// Classes that the shaft is made of.
const SHAFT: [&str; 2] = ["ShaftElement", COUPLING];
const COUPLING: &str = "CouplingElement";

/// Reads all shaft elements and couplings, which come from left to right: the first between two nodes is a section, the others between the same two are sleeves on it.
pub(super) fn shaft(import: &mut Import<'_>, elements: &[Element]) {
    let whole = damping_of_all(import);
    let mut layers: Vec<(f64, usize, Section)> = Vec::new();
    for (at, element) in elements.iter().enumerate().filter(|(_, element)| SHAFT.contains(&element.class())) {
        let n = import.document.number(element, "n", None);
        let is_coupling = element.class() == COUPLING;
        let section = if is_coupling { coupling(import, element) } else { section(import, at, element, whole) };
        layers.push((n, at, section));
    }
    if layers.is_empty() && import.document.faults.is_empty() {
        import.document.fault(&(0..0), "no ShaftElement", "a file that ROSS has saved, with a shaft");
    }
    let mut next = 0.0;
    for (n, at, layer) in layers {
        let sections = import.sketch.sections.len();
        if sections > 0 && n == next - 1.0 {
            let under = &import.sketch.sections[sections - 1];
            if layer.coupling.is_some() || under.coupling.is_some() {
                let found = format!("{}: n = {n}", elements[at].name);
                import.document.fault(&elements[at].span, found, "one element at the place of a coupling");
                continue;
            }
            import.origins.push(("sleeve", import.sketch.sleeves.len(), at));
            import.sketch.sleeves.push(Sleeve { section: sections - 1, layer });
            continue;
        }
        if n != next && n.is_finite() {
            let element = &elements[at];
            let found = format!("{}: n = {n}", element.name);
            import.document.fault(&element.span, found, format!("{next}: elements from left to right without a gap"));
        }
        import.origins.push(("section", sections, at));
        import.sketch.sections.push(layer);
        next = if n.is_finite() { n + 1.0 } else { next };
    }
    import.nodes = (next as usize).saturating_add(1);
    for (at, element) in elements.iter().enumerate().filter(|(_, element)| element.class() == COUPLING) {
        hubs(import, at, element);
    }
}

/// What holds the two ends of a coupling together.
fn coupling(import: &mut Import<'_>, element: &Element) -> Section {
    let length = import.document.number(element, "L", Some(0.2));
    let mut both = |x: &str, y: &str| {
        let values = [x, y].map(|key| import.document.number(element, key, Some(0.0)));
        import.mean(element, (x, values[0]), (y, values[1]))
    };
    let coupling = Coupling {
        stiffness: both("kt_x", "kt_y"),
        damping: both("ct_x", "ct_y"),
        tilt_stiffness: both("kr_x", "kr_y"),
        tilt_damping: both("cr_x", "cr_y"),
    };
    Section::coupling(length, coupling)
}

/// What a coupling weighs at its ends, as discs.
fn hubs(import: &mut Import<'_>, at: usize, element: &Element) {
    let left = import.document.node(element, import.nodes.saturating_sub(1));
    for (station, keys) in [(left, ["m_l", "Id_l", "Ip_l"]), (left + 1, ["m_r", "Id_r", "Ip_r"])] {
        let [mass, diametral, polar_inertia] = keys.map(|key| import.document.number(element, key, Some(0.0)));
        let diametral_inertia = if diametral == 0.0 { 0.5 * polar_inertia } else { diametral };
        if mass != 0.0 || polar_inertia != 0.0 || diametral_inertia != 0.0 {
            import.origins.push(("disc", import.sketch.discs.len(), at));
            import.sketch.discs.push(Disc { station, mass, polar_inertia, diametral_inertia });
        }
    }
}

/// Proportional damping that is said of the whole rotor, and whether there is any: it is then the only one.
fn damping_of_all(import: &mut Import<'_>) -> bool {
    let parameters = std::mem::take(&mut import.document.parameters);
    let [alpha, beta] = ["alpha", "beta"].map(|key| import.document.number(&parameters, key, Some(0.0)));
    (import.sketch.mass_damping, import.sketch.stiffness_damping) = (alpha, beta);
    if parameters.get("modal_damping_ratio").is_some() {
        let found = "parameters: modal_damping_ratio";
        let expected = "none: damping by mode is not of any part of the rotor, alpha and beta are";
        import.document.fault(&parameters.span, found, expected);
    }
    alpha != 0.0 || beta != 0.0
}

fn section(import: &mut Import<'_>, at: usize, element: &Element, damped_as_a_whole: bool) -> Section {
    let mut number = |key, otherwise| import.document.number(element, key, otherwise);
    let (length, outer, inner) = (number("L", None), number("odl", None), number("idl", None));
    let (outer_right, inner_right) = (number("odr", Some(outer)), number("idr", Some(inner)));
    let (axial_force, torque) = (number("axial_force", Some(0.0)), number("torque", Some(0.0)));
    let [alpha, beta] = ["alpha", "beta"].map(|key| number(key, Some(0.0)));
    let bends = import.document.boolean(element, "shear_effects", true);
    let shear = match element.get("shear_method_calc") {
        _ if !bends => Shear::Rigid,
        None => Shear::Cowper,
        Some(Value::Text(method)) if method == "cowper" => Shear::Cowper,
        Some(Value::Text(method)) if method == "hutchinson" => Shear::HutchinsonOfRoss,
        Some(_) => {
            let found = format!("{}: shear_method_calc", element.name);
            import.document.fault(&element.span, found, "\"cowper\" or \"hutchinson\"");
            Shear::Cowper
        }
    };
    if torque != 0.0 && (beta != 0.0 || import.sketch.stiffness_damping != 0.0) {
        let found = format!("{}: torque = {torque} beside damping by stiffness, beta", element.name);
        import.document.fault(&element.span, found, "one of them 0: damping would couple both planes");
    }
    let unknown: Vec<&str> = element.keys().filter(|key| !KNOWN.contains(key)).collect();
    if !unknown.is_empty() {
        let text = format!("{} left out, as it is not known", unknown.join(", "));
        import.note(element, text);
    }
    let own = !damped_as_a_whole;
    if !own && (alpha != 0.0 || beta != 0.0) {
        import.note(element, "its own alpha and beta are left out, as in ROSS, beside those of the whole rotor");
    }
    Section {
        length,
        outer,
        inner,
        outer_right,
        inner_right,
        elements: 1,
        material: material(import, at, element),
        shear,
        rotary_inertia: import.document.boolean(element, "rotary_inertia", true),
        gyroscopic: import.document.boolean(element, "gyroscopic", true),
        axial_force,
        torque,
        mass_damping: if own { alpha } else { 0.0 },
        stiffness_damping: if own { beta } else { 0.0 },
        internal_damping: 0.0,
        coupling: None,
    }
}

/// Which material of the drawing an element is made of, a new one if need be.
fn material(import: &mut Import<'_>, at: usize, element: &Element) -> usize {
    let Some(table) = element.table("material") else {
        import.document.fault(&element.span, format!("{}: no material", element.name), "rho, E and G_s of a material");
        return 0;
    };
    let [density, youngs_modulus] = ["rho", "E"].map(|key| import.document.number(&table, key, None));
    let shear_modulus = if table.get("G_s").is_none() && table.get("Poisson").is_some() {
        youngs_modulus / (2.0 * (1.0 + import.document.number(&table, "Poisson", None)))
    } else {
        import.document.number(&table, "G_s", None)
    };
    let name = match table.get("name") {
        Some(Value::Text(name)) if !name.is_empty() => name.chars().filter(|c| !c.is_control()).collect(),
        _ => "material".to_owned(),
    };
    let made = Material { name, density, youngs_modulus, shear_modulus };
    let materials = &mut import.sketch.materials;
    let numbers = |of: &Material| (of.density, of.youngs_modulus, of.shear_modulus);
    if let Some(at) = materials.iter().position(|other| numbers(other) == numbers(&made)) {
        return at;
    }
    // Two materials may share a name in ROSS, where every element has its own.
    let mut names = std::iter::once(made.name.clone()).chain((2..).map(|i| format!("{}-{i}", made.name)));
    let name = names.find(|name| materials.iter().all(|other| other.name != *name)).unwrap_or_default();
    import.origins.push(("material", materials.len(), at));
    materials.push(Material { name, ..made });
    materials.len() - 1
}
