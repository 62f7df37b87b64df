//! Bearings so stiff that they are as good as rigid: the slow modes, which leave them at rest, keep their damping.

use rotor::{C64, Characteristic, LinearForm, OperatingPoint, Plant, Rotor, Stability, file};

/// A shaft of 0.75 m with two discs, pinned at both ends by bearings of a stiffness, held by a damper at the first disc.
fn pinned(stiffness: f64, damping: f64) -> Rotor {
    let text = format!(
        "units = 'si'\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\nshear_modulus = 81.2e9\n{}\
         [[disc]]\nstation = 2\nmass = 32.6\npolar_inertia = 0.356\ndiametral_inertia = 0.178\n\
         [[disc]]\nstation = 3\nmass = 35.8\npolar_inertia = 0.405\ndiametral_inertia = 0.203\n\
         [[bearing]]\nstation = 1\nstiffness = {stiffness:e}\n[[bearing]]\nstation = 4\nstiffness = {stiffness:e}\n\
         [[seal]]\nstation = 2\ndamping = {damping}\n",
        "[[section]]\nlength = 0.25\nouter = 0.05\nelements = 2\n".repeat(3)
    );
    file::read_rotor(&text, "pinned").expect("a rotor")
}

/// The poles at 4000 rpm in 1/s, slowest first.
fn poles(rotor: &Rotor) -> Vec<C64> {
    let scales = rotor.scales().expect("SI");
    let at = OperatingPoint::at(scales.speed(4000.0));
    let feedback = rotor.beam().expect("shaft elements").no_feedback();
    let form = LinearForm::of(&Plant::of(rotor), &feedback, &at).expect("fits");
    let roots = Characteristic::of(&form).expect("finite").roots().expect("found");
    let mut poles: Vec<C64> = roots.iter().map(|root| root.pole * scales.w0).collect();
    poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    poles
}

/// How a pole moves with 1 / k of the bearings is known: a tenth of it with ten times the stiffness. So what is told at 1e10 N/m says what a
/// rigid bearing leaves, and beyond it every stiffness must tell the same.
#[test]
fn val_the_slow_modes_of_a_rotor_on_rigid_bearings_keep_their_damping() {
    let [soft, firm] = [1e9, 1e10].map(|stiffness| poles(&pinned(stiffness, 2000.0)));
    let rigid: Vec<C64> = soft.iter().zip(&firm).map(|(soft, firm)| firm + (firm - soft) / 9.0).collect();
    for whole in [false, true] {
        for stiffness in [1e12, 1e13, 1e14, 1e15, 1e16] {
            let rotor = pinned(stiffness, 2000.0);
            let found = poles(&if whole { rotor.in_full().expect("a plant") } else { rotor });
            for (found, rigid) in found.iter().zip(&rigid).take(6) {
                assert_eq!(Stability::of(*found), Stability::Stable, "{found} at {stiffness:e} N/m, whole: {whole}");
                let off = (found.re - rigid.re).abs() / rigid.re.abs();
                assert!(off < 2e-3, "{found} for {rigid} at {stiffness:e} N/m, whole: {whole}");
            }
        }
    }
}

/// Without a damper nothing decays, whatever the stiffness: what is told as stable is no rounding.
#[test]
fn nothing_is_sharpened_into_a_verdict_where_there_is_no_damping() {
    for stiffness in [1e6, 1e9, 1e12, 1e14, 1e16] {
        for pole in poles(&pinned(stiffness, 0.0)) {
            assert_eq!(Stability::of(pole), Stability::Marginal, "{pole} at {stiffness:e} N/m");
        }
    }
}
