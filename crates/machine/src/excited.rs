//! How far a machine goes under an excitation of its loop: asked before it is excited.

use control::Tone;
use linear::{DelayError, DelaySystem, LoopGain};
use nalgebra::DMatrix;
use rotor::C64;

use crate::margins::{MachineLoop, MarginsError};

impl MachineLoop {
    /// The largest that the motion of every station can be under tones that are added to the command, beside the motion that there is,
    /// once they have swung in: the sum of what each does, in `e_t`. Of a sampled loop without what its hold does beside the
    /// tones themselves, which is less. The loop must be stable.
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
                let moved: C64 =
                    open.iter().enumerate().map(|(k, open)| open.at(tone.frequency).value * commands(k)).sum();
                tone.amplitude.norm() * moved.norm()
            };
            Ok(tones.iter().map(of).sum())
        };
        self.plant().stations().iter().map(reach).collect()
    }
}
