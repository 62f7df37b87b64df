//! Beams and discs with solutions in closed form.

use beam::{Bearing, Disc, Drawing, FullModel, Material, Section, Shear, Sketch};

const LENGTH: f64 = 1.2;
const OUTER: f64 = 0.08;
const INNER: f64 = 0.03;

fn steel() -> Material {
    Material { name: "steel".into(), density: 7810.0, youngs_modulus: 211e9, shear_modulus: 81.2e9 }
}

fn model(sketch: Sketch) -> FullModel {
    Drawing::new(Sketch { name: "exact".into(), ..sketch }).expect("a drawing").full()
}

/// A uniform tube in so many elements.
fn tube(elements: usize, bearings: Vec<Bearing>) -> FullModel {
    section(Section { elements, ..Section::tube(LENGTH, OUTER, INNER) }, bearings)
}

fn section(section: Section, bearings: Vec<Bearing>) -> FullModel {
    model(Sketch { materials: vec![steel()], sections: vec![section], bearings, ..Sketch::default() })
}

/// A frequency of a tube, taken to infinitely many elements: shear is constant inside an element, so that what it adds converges
/// with the square of the element's length.
fn extrapolated(bearings: &[Bearing], spin: f64, near: f64) -> f64 {
    let [coarse, fine] = [32, 64].map(|elements| nearest(&frequencies(&tube(elements, bearings.to_vec()), spin), near));
    (4.0 * fine - coarse) / 3.0
}

/// What Timoshenko's equations need: `E I`, `kappa G A`, `rho A`, `rho I`.
struct Beam {
    bending: f64,
    shear: f64,
    mass: f64,
    tilting: f64,
}

impl Beam {
    fn tube() -> Self {
        let steel = steel();
        let (outer, inner) = (OUTER / 2.0, INNER / 2.0);
        let area = std::f64::consts::PI * (outer.powi(2) - inner.powi(2));
        let moment = std::f64::consts::PI / 4.0 * (outer.powi(4) - inner.powi(4));
        // Cowper 1966 for a thick tube.
        let (nu, m2) = (steel.poisson(), (inner / outer).powi(2));
        let kappa =
            6.0 * (1.0 + nu) * (1.0 + m2).powi(2) / ((7.0 + 6.0 * nu) * (1.0 + m2).powi(2) + (20.0 + 12.0 * nu) * m2);
        Self {
            bending: steel.youngs_modulus * moment,
            shear: kappa * steel.shear_modulus * area,
            mass: steel.density * area,
            tilting: steel.density * moment,
        }
    }

    /// On knife edges, bending in `half_waves` and whirling at `w` under spin: what is 0 at a frequency.
    /// `(S k^2 - m w^2)(B k^2 + S - i w^2 + 2 i spin w) = (S k)^2`
    fn pinned(&self, half_waves: f64, spin: f64, w: f64) -> f64 {
        let k = half_waves * std::f64::consts::PI / LENGTH;
        let tilt = self.bending * k * k + self.shear - self.tilting * w * w + 2.0 * self.tilting * spin * w;
        (self.shear * k * k - self.mass * w * w) * tilt - (self.shear * k).powi(2)
    }

    /// Free at both ends: what is 0 at a frequency of an even, then of an odd mode. With displacement `cos a x`, `cosh b x` about the
    /// middle, no moment and no shear at the ends.
    fn free(&self, w: f64) -> [f64; 2] {
        let square = w * w;
        let r = self.mass * square / self.shear;
        let linear = self.bending * r + self.tilting * square;
        let constant = r * (self.tilting * square - self.shear);
        let root = (linear * linear - 4.0 * self.bending * constant).sqrt();
        let a = ((linear + root) / (2.0 * self.bending)).sqrt();
        let b = ((root - linear) / (2.0 * self.bending)).sqrt();
        let half = LENGTH / 2.0;
        let (sin, cos) = (a * half).sin_cos();
        let tanh = (b * half).tanh();
        [(r - a * a) / b * tanh * cos - (b * b + r) / a * sin, (r - a * a) / b * sin + (b * b + r) / a * tanh * cos]
    }
}

/// The roots of `f` between `from` and `to`, found where it changes sign.
fn roots(f: impl Fn(f64) -> f64, from: f64, to: f64) -> Vec<f64> {
    let steps = 4000;
    let at = |i: usize| from + (to - from) * i as f64 / steps as f64;
    let mut found = Vec::new();
    for i in 0..steps {
        let (mut low, mut high) = (at(i), at(i + 1));
        if f(low) * f(high) < 0.0 {
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if f(low) * f(middle) <= 0.0 { high = middle } else { low = middle }
            }
            found.push(0.5 * (low + high));
        }
    }
    found
}

fn frequencies(full: &FullModel, spin: f64) -> Vec<f64> {
    let poles = full.eigenvalues(spin).expect("eigenvalues");
    let mut frequencies: Vec<f64> = poles.iter().map(|pole| pole.im).collect();
    frequencies.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    frequencies
}

fn nearest(of: &[f64], to: f64) -> f64 {
    of.iter().copied().min_by(|a, b| (a - to).abs().total_cmp(&(b - to).abs())).expect("one at least")
}

#[test]
fn val_a_free_tube_bends_at_the_frequencies_of_timoshenko() {
    let beam = Beam::tube();
    let mut exact: Vec<f64> = [0, 1].into_iter().flat_map(|odd| roots(|w| beam.free(w)[odd], 50.0, 25_000.0)).collect();
    exact.sort_by(f64::total_cmp);
    assert!(exact.len() >= 4, "{exact:?}");
    let found = frequencies(&tube(32, vec![]), 0.0);
    assert!(found[..4].iter().all(|w| w.abs() < 1.0), "two rigid motions: {:?}", &found[..4]);
    for &w in &exact[..4] {
        let error = extrapolated(&[], 0.0, w) / w - 1.0;
        assert!(error.abs() < 3e-6, "{w}: {error:e}");
    }
}

fn knife_edges() -> Vec<Bearing> {
    [0, 1].map(|station| Bearing { station, stiffness: 1e15.into(), ..Bearing::default() }).into()
}

#[test]
fn val_a_spinning_tube_on_knife_edges_whirls_as_timoshenko_says() {
    let beam = Beam::tube();
    for spin in [0.0, 800.0] {
        for half_waves in [1.0, 2.0, 3.0] {
            let exact = roots(|w| beam.pinned(half_waves, spin, w), -12_000.0, 12_000.0);
            let [backward, forward] = exact[..] else { panic!("{exact:?}") };
            // The inertia of tilting makes forward whirl faster than backward.
            assert!(if spin > 0.0 { forward > -backward } else { (forward + backward).abs() < 1e-6 });
            for w in [backward, forward] {
                let error = extrapolated(&knife_edges(), spin, w) / w - 1.0;
                assert!(error.abs() < 3e-6, "{half_waves} half waves at {spin}: {w}, {error:e}");
            }
        }
    }
}

/// Bending converges with the fourth power of the length of an element, and what shear adds with the square.
#[test]
fn val_frequencies_converge_at_the_order_of_the_element() {
    let orders = |exact: f64, shear: Shear| {
        let errors = [4, 8, 16, 32].map(|elements| {
            let of = Section {
                elements,
                shear,
                rotary_inertia: shear != Shear::Rigid,
                ..Section::tube(LENGTH, OUTER, INNER)
            };
            nearest(&frequencies(&section(of, knife_edges()), 0.0), exact) / exact - 1.0
        });
        assert!(errors.iter().all(|&error| error > 0.0), "from above: {errors:?}");
        [0, 1, 2].map(|i| (errors[i] / errors[i + 1]).log2())
    };
    let beam = Beam::tube();
    let euler = (std::f64::consts::TAU / LENGTH).powi(2) * (beam.bending / beam.mass).sqrt();
    let bending = orders(euler, Shear::Rigid);
    assert!(bending.iter().all(|order| (3.9..4.1).contains(order)), "{bending:?}");
    let sheared = orders(roots(|w| beam.pinned(2.0, 0.0, w), 100.0, 12_000.0)[0], Shear::Cowper);
    assert!((1.95..2.1).contains(&sheared[2]), "{sheared:?}");
}

/// A thin disc in the middle of a shaft without mass, on springs. It moves along with `48 E I / L^3` in a row with two springs, and tilts
/// with `12 E I / L` in a row with what the springs give way: `Id w^2 - Ip spin w - k = 0`.
#[test]
fn val_a_spinning_disc_on_a_massless_shaft_has_the_poles_of_the_closed_form() {
    let (support, mass, polar, diametral) = (3e7, 30.0, 0.4, 0.21);
    let hair = Material { density: 1e-4, ..steel() };
    let half = Section { shear: Shear::Rigid, rotary_inertia: false, ..Section::cylinder(LENGTH / 2.0, OUTER) };
    let full = model(Sketch {
        materials: vec![hair],
        sections: vec![half; 2],
        discs: vec![Disc { station: 1, mass, polar_inertia: polar, diametral_inertia: diametral }],
        bearings: [0, 2].map(|station| Bearing { station, stiffness: support.into(), ..Bearing::default() }).into(),
        ..Sketch::default()
    });
    let bending = steel().youngs_modulus * std::f64::consts::PI / 64.0 * OUTER.powi(4);
    let along = 1.0 / (LENGTH.powi(3) / (48.0 * bending) + 1.0 / (2.0 * support));
    let tilt = 1.0 / (LENGTH / (12.0 * bending) + 2.0 / (support * LENGTH * LENGTH));
    for spin in [0.0, 300.0, -2000.0] {
        let root = ((polar * spin).powi(2) + 4.0 * diametral * tilt).sqrt();
        let expected = [
            (along / mass).sqrt(),
            -(along / mass).sqrt(),
            (polar * spin + root) / (2.0 * diametral),
            (polar * spin - root) / (2.0 * diametral),
        ];
        let found = frequencies(&full, spin);
        for w in expected {
            let error = nearest(&found, w) / w - 1.0;
            assert!(error.abs() < 1e-7, "{w} at {spin}: {error:e}, {:?}", &found[..6]);
        }
    }
}

/// A Jeffcott rotor with damping that turns with the shaft: stable until the shaft turns faster than it whirls, and not beyond, where
/// nothing else damps; with damping `c` of the bearings against `cr` of the shaft, until `w1 (1 + c / cr)`.
#[test]
fn val_internal_damping_drives_forward_whirl_above_the_first_critical_speed() {
    let beta = 2e-5;
    let half = Section { elements: 2, internal_damping: beta, ..Section::cylinder(LENGTH / 2.0, 0.03) };
    let with = |damping: f64| {
        model(Sketch {
            materials: vec![steel()],
            sections: vec![half.clone(); 2],
            discs: vec![Disc { station: 1, mass: 40.0, polar_inertia: 0.0, diametral_inertia: 0.0 }],
            bearings: [0, 2].map(|station| Bearing { station, stiffness: 1e12.into(), ..Bearing::default() }).into(),
            seals: vec![Bearing { station: 1, damping: damping.into(), ..Bearing::default() }],
            ..Sketch::default()
        })
    };
    let growth = |full: &FullModel, spin: f64| {
        let poles = full.eigenvalues(spin).expect("eigenvalues");
        poles.iter().filter(|pole| pole.norm() < 1e4).map(|pole| pole.re).fold(f64::NEG_INFINITY, f64::max)
    };
    let bare = with(0.0);
    let whirl = nearest(&frequencies(&bare, 0.0), 100.0);
    assert!(growth(&bare, 0.98 * whirl) < 0.0 && growth(&bare, 1.02 * whirl) > 0.0, "{whirl}");

    // Of one mass on a spring k, C = beta k: c / C is what damping outside adds.
    let modal = 40.0 * whirl * whirl;
    let damped = with(0.5 * beta * modal);
    let threshold = 1.5 * whirl;
    assert!(growth(&damped, 0.97 * threshold) < 0.0 && growth(&damped, 1.03 * threshold) > 0.0);
}
