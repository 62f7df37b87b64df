//! How far a machine goes under an excitation of its loop: asked before it is excited.

use control::Tone;
use linear::{DelaySystem, LoopGain};
use nalgebra::DMatrix;

use crate::margins::{MachineLoop, MarginsError};

impl MachineLoop {
    /// The largest that the motion of every station can be under tones that are added to the command, beside the motion that there is,
    /// once they have swung in: the sum of what each does, in `e_t`. Of a sampled loop without what its hold does beside the
    /// tones themselves, which is less. The loop must be stable.
    ///
    /// # Errors
    /// Eigenvalues that cannot be had.
    pub fn excited(&self, tones: &[Tone]) -> Result<Vec<f64>, MarginsError> {
        let form = self.form();
        let (n, size) = (form.coordinates, form.a.nrows());
        let reach = |station: &rotor::Station| -> Result<f64, MarginsError> {
            let mut c = DMatrix::zeros(1, size);
            c.view_mut((0, 0), (1, n)).copy_from(&station.row.dense(n).transpose());
            let response = LoopGain::of(&DelaySystem::new(form.a.clone(), form.b.clone(), c, 0.0)?)?;
            let of = |tone: &Tone| {
                let closed = self.gain.at(tone.frequency).sensitivity();
                tone.amplitude.norm() * (response.at(tone.frequency).value * closed).norm()
            };
            Ok(tones.iter().map(of).sum())
        };
        self.plant().stations().iter().map(reach).collect()
    }
}
