//! Unbalance that is added while a machine turns, beside rotors that have it in their files.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use rotor::{Mass, Plant, Rotor, Settings, builtin};

fn with(rotor: &Rotor, place: usize, added: f64) -> Plant {
    let name = builtin::feedback_names(rotor)[0];
    let mut settings = Settings::new(rotor, 1.0, builtin::feedback(rotor, name).unwrap());
    settings.set(format!("unbalance_added.{}", place + 1).parse().unwrap(), added).unwrap();
    settings.check(rotor).unwrap();
    Plant::of(&settings.unbalanced(rotor))
}

#[test]
fn val_added_to_a_chain_it_is_the_eccentricity_of_that_mass() {
    let rotor = builtin::rotor("three-mass").unwrap();
    for place in 0..3 {
        let mut masses: Vec<Mass> = rotor.masses().to_vec();
        // U / (m_t e_t) of a mass Rm m_t is an eccentricity of U / Rm.
        masses[place].unbalance += 0.3 / masses[place].mass;
        let drawn = Rotor::new("drawn", masses, rotor.shafts().to_vec()).unwrap();
        assert_eq!(with(&rotor, place, 0.3), Plant::of(&drawn));
    }
}

#[test]
fn val_added_to_shaft_elements_it_is_a_mass_drawn_there() {
    let rotor = builtin::rotor("rig").unwrap();
    let beam = rotor.beam().unwrap();
    let scales = *beam.scales();
    for (place, at) in beam.places().iter().enumerate() {
        let Some(station) = at.station else { continue };
        let gram_millimetres = 0.3 * scales.m_t * scales.e_t * 1e6;
        let mut sketch = beam.drawing().clone().into_sketch();
        let amount = beam::Amount::GramMillimetres(gram_millimetres);
        sketch.unbalances.push(beam::Unbalance { station, amount, angle: 0.0 });
        let drawn = Plant::of(&rotor.redrawn(beam::Drawing::new(sketch).unwrap()).unwrap());
        let added = with(&rotor, place, 0.3);
        let largest = drawn.unbalance().iter().map(|u| u.norm()).fold(0.0, f64::max);
        // What is drawn anew is reduced anew: its coordinates are the same but for the rounding of an eigenvalue problem.
        for (ours, theirs) in added.unbalance().iter().zip(drawn.unbalance()) {
            assert!((ours - theirs).norm() < 1e-8 * largest, "station {}: {ours} {theirs}", station + 1);
        }
    }
}
