//! Filters as they travel: a kind and its numbers in fixed places.

use iceoryx2::prelude::ZeroCopySend;
use rotor::Filter;

/// Filters of all signals and of the bearing together.
pub(crate) const MAX_FILTERS: usize = 32;
/// Numbers of one filter: the coefficients of a ratio of polynomials of the highest order.
const MAX_NUMBERS: usize = 18;

/// One filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
pub struct FilterMessage {
    /// 0 none; else its kind, counted from 1 in the order of [`control::FILTERS`].
    pub kind: u32,
    /// What it shapes: 0 the sum at the bearing, else the signal, counted from 1.
    pub signal: u32,
    /// How many entries of `numbers` are used; of a ratio of polynomials, those of the numerator come first.
    pub count: u32,
    /// How many of them are of the numerator; a low-pass has its order here.
    pub order: u32,
    /// Its numbers, in the order of its keys.
    pub numbers: [f64; MAX_NUMBERS],
}

impl FilterMessage {
    /// Packs a filter for the journey.
    pub(crate) fn pack(filter: &Filter, signal: usize) -> Self {
        let (kind, order, numbers): (u32, usize, Vec<f64>) = match filter {
            Filter::Lowpass { corner, order } => (1, *order, vec![*corner]),
            Filter::Lead { zero, pole } => (2, 0, vec![*zero, *pole]),
            Filter::Notch { frequency, width } => (3, 0, vec![*frequency, *width]),
            Filter::SynchronousNotch { width } => (4, 0, vec![*width]),
            Filter::Integrator { rate } => (5, 0, vec![*rate]),
            Filter::Derivative { corner } => (6, 0, vec![*corner]),
            Filter::Transfer { numerator, denominator } => {
                (7, numerator.len(), numerator.iter().chain(denominator).copied().collect())
            }
        };
        let (count, order) = (numbers.len() as u32, order as u32);
        let mut packed = Self { kind, signal: signal as u32, count, order, ..Self::default() };
        packed.numbers.iter_mut().zip(&numbers).for_each(|(place, number)| *place = *number);
        packed
    }

    /// Unpacks it again; `None` for no filter, or a kind that is not known. Counts are held within bounds, the rest is judged
    /// by [`rotor::Settings::check`].
    pub(crate) fn unpack(&self) -> Option<Filter> {
        let [first, second, ..] = self.numbers;
        let order = self.order as usize;
        Some(match self.kind {
            1 => Filter::Lowpass { corner: first, order },
            2 => Filter::Lead { zero: first, pole: second },
            3 => Filter::Notch { frequency: first, width: second },
            4 => Filter::SynchronousNotch { width: first },
            5 => Filter::Integrator { rate: first },
            6 => Filter::Derivative { corner: first },
            7 => {
                let used = &self.numbers[..(self.count as usize).min(MAX_NUMBERS)];
                let (numerator, denominator) = used.split_at(order.min(used.len()));
                Filter::Transfer { numerator: numerator.to_vec(), denominator: denominator.to_vec() }
            }
            _ => return None,
        })
    }
}
