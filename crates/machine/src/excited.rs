//! How far a machine goes under an excitation of its loop: asked before it is excited.

use std::f64::consts::TAU;

use control::Tone;
use linear::{DelayError, DelaySystem, LoopGain};
use nalgebra::DMatrix;
use rotor::C64;

use crate::margins::{MachineLoop, MarginsError};

/// Images on each side of a tone that are counted.
const IMAGES: i32 = 8;

/// What a hold of `period` makes of a tone: frequencies, and the share of the tone's size at each. The tone itself counts whole, as it
/// does where nothing is held.
fn held(tone: f64, period: f64) -> impl Iterator<Item = (f64, f64)> {
    let images = if period > 0.0 { IMAGES } else { 0 };
    (-images..=images).map(move |k| {
        let w = if k == 0 { tone } else { tone + TAU / period * f64::from(k) };
        // |1 - exp(-j w h)| / |w h|: its top is the same at all images.
        let share = if k == 0 { 1.0 } else { (0.5 * tone * period).sin().abs() / (0.5 * w * period).abs() };
        (w, share)
    })
}

impl MachineLoop {
    /// The largest that the motion of every station can be under tones that are added to the command, beside the motion that there is,
    /// once they have swung in: the sum of what each does, in `e_t`. Of a sampled loop with the images of each tone that the hold of its
    /// samples makes, eight on each side: what is beyond is less than the first of them by a thousand. The loop must be stable.
    ///
    /// # Errors
    /// Eigenvalues that cannot be had.
    pub fn excited(&self, tones: &[Tone]) -> Result<Vec<f64>, MarginsError> {
        // A sampled loop is looked at between its samples, as what it is there: its gain is that of the fundamental.
        let form = self.form();
        let (n, size) = (form.coordinates, form.a.nrows());
        let reach = |station: &rotor::Station| -> Result<f64, MarginsError> {
            let mut c = DMatrix::zeros(1, size);
            c.view_mut((0, 0), (1, n)).copy_from(&station.row.dense(n).transpose());
            let open: Result<Vec<LoopGain>, DelayError> = (0..form.b.ncols())
                .map(|k| {
                    let b = form.b.columns(k, 1).into_owned();
                    LoopGain::of(&DelaySystem::new(form.a.clone(), b, c.clone(), 0.0)?)
                })
                .collect();
            let open = open?;
            let of = |tone: &Tone| {
                // What is pushed at one command comes out of all of them.
                let closed = self.gain.matrix(tone.frequency).sensitivity();
                let commands = |k: usize| closed.as_ref().map_or(C64::from(f64::NAN), |s| s[(k, self.bearing())]);
                let moved =
                    |w: f64| open.iter().enumerate().map(|(k, open)| open.at(w).value * commands(k)).sum::<C64>();
                let all: f64 = held(tone.frequency, form.sample).map(|(w, share)| share * moved(w).norm()).sum();
                tone.amplitude.norm() * all
            };
            Ok(tones.iter().map(of).sum())
        };
        self.plant().stations().iter().map(reach).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_a_held_tone_has_the_images_of_its_stairs() {
        // Fourier's sum over one period of a beat: stairs of cis(w k h), of which 20 make a turn.
        let (tone, period, fine) = (1.0, TAU / 20.0, 4000);
        let of = |w: f64| {
            let sample = |i: usize| {
                let tau = TAU * i as f64 / f64::from(fine);
                let held = (tau / period + 1e-9).floor() * period;
                C64::cis(tone * held) * C64::cis(-w * tau)
            };
            (0..fine as usize).map(sample).sum::<C64>().norm() / f64::from(fine)
        };
        for (w, share) in held(tone, period).filter(|(w, _)| w.abs() < 70.0) {
            let slack = if w == tone { 0.01 } else { 2e-4 };
            assert!(of(w) <= share + 1e-4 && of(w) >= share - slack, "{w}: {} {share}", of(w));
        }
        assert_eq!(held(tone, 0.0).collect::<Vec<_>>(), [(tone, 1.0)]);
    }
}
