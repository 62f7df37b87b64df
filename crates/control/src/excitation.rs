//! Tones added to the command of a loop that works, so that it can be measured: whoever measures and whoever steps make them of the
//! same few numbers, and so need to tell each other nothing else.

use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

use crate::C64;
use crate::state_words::StateWords;

/// Lines on either side of a frequency that is kept free on which there is no tone.
const KEPT_FREE: f64 = 2.0;

/// A multisine: tones of one amplitude and random phases on multiples of `2 pi / period`, of both signs.
#[derive(Clone, Debug, PartialEq)]
pub struct Multisine {
    /// Which phases: the same seed gives the same tones.
    pub seed: u64,
    /// Its period, in `tau`.
    pub period: f64,
    /// The lowest and the highest multiple, from 1 on.
    pub lines: [u32; 2],
    /// How many tones of each sign, at most; spread over the lines as evenly over the logarithm of frequency as these allow.
    pub tones: u32,
    /// A frequency from which tones of either sign keep away by two lines: the spin speed, where unbalance is.
    pub away_from: f64,
    /// Amplitude of each tone, in `w0^2 e_t`.
    pub amplitude: f64,
    /// How long it goes on, in `tau`.
    pub duration: f64,
}

/// A multisine that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExcitationError {
    /// A number that is out of range.
    #[error("excitation: {name} = {found}: expected {expected}")]
    OutOfRange {
        /// Which.
        name: &'static str,
        /// The number.
        found: f64,
        /// What is allowed.
        expected: &'static str,
    },
    /// No line is left for a tone.
    #[error("excitation: no tone fits: every line is within two of the spin speed")]
    NoTones,
    /// Not the text of one.
    #[error("excitation '{found}': expected seed= period= lines=A..B tones= away_from= amplitude= duration=")]
    Text {
        /// The text.
        found: String,
    },
}

/// One tone `a exp(j w tau)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// `w`, in radians per `tau`; negative for backward whirl.
    pub frequency: f64,
    /// `a`, with its phase, in `w0^2 e_t`.
    pub amplitude: C64,
}

impl Multisine {
    /// The most tones of each sign.
    pub const MAX_TONES: u32 = 32;
    /// The highest line.
    pub const MAX_LINE: u32 = 1_000_000;

    /// The tones.
    ///
    /// # Errors
    /// A number out of range, or no tone.
    pub fn tones(&self) -> Result<Vec<Tone>, ExcitationError> {
        let refused = |name, found, expected| Err(ExcitationError::OutOfRange { name, found, expected });
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        let [first, last] = self.lines;
        if !is_positive(self.period) {
            return refused("period", self.period, "more than 0");
        }
        if !(1..=Self::MAX_LINE).contains(&first) {
            return refused("the lowest line", first.into(), "1 to 1000000");
        }
        if !(first..=Self::MAX_LINE).contains(&last) {
            return refused("the highest line", last.into(), "the lowest to 1000000");
        }
        if !(1..=Self::MAX_TONES).contains(&self.tones) {
            return refused("tones", self.tones.into(), "1 to 32");
        }
        if !is_positive(self.amplitude) {
            return refused("amplitude", self.amplitude, "more than 0");
        }
        if !is_positive(self.duration) {
            return refused("duration", self.duration, "more than 0");
        }
        if !self.away_from.is_finite() {
            return refused("away_from", self.away_from, "a frequency");
        }
        let spacing = TAU / self.period;
        let is_free = |line: &u32| {
            let apart = (f64::from(*line) * spacing - self.away_from.abs()).abs();
            apart > KEPT_FREE * spacing * (1.0 - 1e-9)
        };
        let mut random = fastrand::Rng::with_seed(self.seed);
        let tones: Vec<Tone> = (self.chosen_lines().iter().filter(|line| is_free(line)))
            .flat_map(|line| [1.0, -1.0].map(|sign| sign * f64::from(*line) * spacing))
            .map(|frequency| Tone { frequency, amplitude: C64::from_polar(self.amplitude, TAU * random.f64()) })
            .collect();
        if tones.is_empty() { Err(ExcitationError::NoTones) } else { Ok(tones) }
    }

    /// As many lines as there are to be tones, in order.
    fn chosen_lines(&self) -> Vec<u32> {
        let [first, last] = self.lines;
        let steps = f64::from(self.tones.max(2) - 1);
        let (low, ratio) = (f64::from(first), f64::from(last) / f64::from(first));
        let mut lines: Vec<u32> = Vec::new();
        for k in 0..self.tones {
            let wanted = (low * ratio.powf(f64::from(k) / steps)).round() as u32;
            let line = lines.last().map_or(first, |before| wanted.max(before + 1));
            if line > last {
                break;
            }
            lines.push(line);
        }
        lines
    }
}

impl fmt::Display for Multisine {
    /// To the last bit; [`FromStr`] reads it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seed, period, lines: [first, last], tones, away_from, amplitude, duration } = self;
        write!(f, "seed={seed} period={period:?} lines={first}..{last} tones={tones} ")?;
        write!(f, "away_from={away_from:?} amplitude={amplitude:?} duration={duration:?}")
    }
}

impl FromStr for Multisine {
    type Err = ExcitationError;

    fn from_str(text: &str) -> Result<Self, ExcitationError> {
        let read = || {
            let mut words = text.split(' ');
            let mut next = |key: &str| words.next()?.strip_prefix(key)?.strip_prefix('=');
            let seed = next("seed")?.parse().ok()?;
            let period = next("period")?.parse().ok()?;
            let (first, last) = next("lines")?.split_once("..")?;
            let made = Self {
                seed,
                period,
                lines: [first.parse().ok()?, last.parse().ok()?],
                tones: next("tones")?.parse().ok()?,
                away_from: next("away_from")?.parse().ok()?,
                amplitude: next("amplitude")?.parse().ok()?,
                duration: next("duration")?.parse().ok()?,
            };
            words.next().is_none().then_some(made)
        };
        read().ok_or_else(|| ExcitationError::Text { found: text.to_owned() })
    }
}

/// A multisine at work, from some time on.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    tones: Vec<Tone>,
    duration: f64,
    from: f64,
    until: f64,
}

impl Excitation {
    /// Words that one is saved in, at most.
    pub const WORDS_AT_MOST: usize = 3 + 3 * 2 * Multisine::MAX_TONES as usize;

    /// One that has not begun.
    ///
    /// # Errors
    /// A number out of range, or no tone.
    pub fn of(multisine: &Multisine) -> Result<Self, ExcitationError> {
        let tones = multisine.tones()?;
        Ok(Self { tones, duration: multisine.duration, from: 0.0, until: f64::NEG_INFINITY })
    }

    /// Begins at `tau`: there every tone has its phase.
    pub fn begin(&mut self, tau: f64) {
        (self.from, self.until) = (tau, tau + self.duration);
    }

    /// Is over.
    pub(crate) fn stop(&mut self) {
        self.until = f64::NEG_INFINITY;
    }

    /// When it ends.
    #[must_use]
    pub fn until(&self) -> f64 {
        self.until
    }

    /// Its value, and its rate.
    pub(crate) fn at(&self, tau: f64) -> C64 {
        self.tones.iter().map(|tone| tone.amplitude * C64::cis(tone.frequency * (tau - self.from))).sum()
    }

    pub(crate) fn rate_at(&self, tau: f64) -> C64 {
        let rate = |tone: &Tone| {
            let turning = C64::cis(tone.frequency * (tau - self.from));
            tone.amplitude * C64::new(0.0, tone.frequency) * turning
        };
        self.tones.iter().map(rate).sum()
    }

    pub(crate) fn save(&self, words: &mut StateWords) {
        words.put(self.tones.len() as u64);
        words.put_f64(self.from);
        words.put_f64(self.until);
        for Tone { frequency, amplitude } in &self.tones {
            words.put_f64(*frequency);
            words.put_c64(*amplitude);
        }
    }

    pub(crate) fn restored(words: &mut StateWords) -> Option<Self> {
        let count = words.take().filter(|count| *count <= 2 * u64::from(Multisine::MAX_TONES))?;
        let (from, until) = (words.take_f64()?, words.take_f64()?);
        let tone = |_| Some(Tone { frequency: words.take_f64()?, amplitude: words.take_c64()? });
        let tones = (0..count).map(tone).collect::<Option<Vec<Tone>>>()?;
        Some(Self { tones, duration: until - from, from, until })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn multisine() -> Multisine {
        Multisine {
            seed: 7,
            period: 50.0,
            lines: [1, 60],
            tones: 20,
            away_from: 2.5,
            amplitude: 0.1 + 0.2,
            duration: 1.0 / 3.0,
        }
    }

    #[test]
    fn tones_are_of_both_signs_on_lines_and_away_from_the_spin() {
        let made = multisine();
        let tones = made.tones().unwrap();
        assert!((30..=40).contains(&tones.len()), "{}", tones.len());
        let spacing = TAU / 50.0;
        for pair in tones.chunks(2) {
            let [forward, backward] = pair else { panic!("pairs") };
            assert_eq!(forward.frequency, -backward.frequency);
            let line = forward.frequency / spacing;
            assert!((line - line.round()).abs() < 1e-9 && (0.999..60.001).contains(&line), "{line}");
            assert!((forward.frequency - 2.5).abs() > 1.999 * spacing);
            assert!((forward.amplitude.norm() - made.amplitude).abs() < 1e-15);
        }
        assert!((tones[0].frequency - spacing).abs() < 1e-12, "the lowest is there");
        assert!((tones[tones.len() - 2].frequency - 60.0 * spacing).abs() < 1e-9, "and the highest");
        let other = Multisine { seed: 8, ..made.clone() }.tones().unwrap();
        assert!(other[0].amplitude != tones[0].amplitude && made.tones().unwrap() == tones);
    }

    #[test]
    fn a_text_keeps_every_bit_and_what_is_wrong_is_told() {
        let long = Multisine {
            seed: u64::MAX,
            period: 1.234_567_890_123_456_7e-300,
            lines: [999_999, 1_000_000],
            away_from: -1.234_567_890_123_456_7e300,
            ..multisine()
        };
        for made in [multisine(), long] {
            let text = made.to_string();
            assert!(text.len() <= 240, "{}: {text}", text.len());
            assert_eq!(text.parse(), Ok(made));
        }
        assert!("seed=1".parse::<Multisine>().unwrap_err().to_string().starts_with("excitation 'seed=1': expected"));
        assert!(format!("{} more", multisine()).parse::<Multisine>().is_err());
        let refused = |made: Multisine| made.tones().unwrap_err().to_string();
        assert!(refused(Multisine { period: f64::NAN, ..multisine() }).contains("period = NaN"));
        assert!(refused(Multisine { lines: [3, 2], ..multisine() }).contains("the highest line = 2"));
        assert!(refused(Multisine { tones: 33, ..multisine() }).contains("expected 1 to 32"));
        assert!(refused(Multisine { amplitude: 0.0, ..multisine() }).contains("amplitude = 0"));
        assert!(refused(Multisine { duration: f64::INFINITY, ..multisine() }).contains("duration = inf"));
        let only = Multisine { lines: [20, 21], ..multisine() };
        assert_eq!(only.tones(), Err(ExcitationError::NoTones));
    }

    #[test]
    fn the_rate_is_that_of_the_value() {
        let mut made = Excitation::of(&multisine()).unwrap();
        made.begin(3.0);
        let h = 1e-5;
        for tau in [3.0, 4.7, 30.0] {
            let slope = (made.at(tau + h) - made.at(tau - h)) / (2.0 * h);
            assert!((slope - made.rate_at(tau)).norm() < 1e-6 * (1.0 + slope.norm()));
        }
        assert_eq!(made.until(), 3.0 + 1.0 / 3.0);
        let mut words = StateWords::default();
        made.save(&mut words);
        let restored = Excitation::restored(&mut StateWords::from_saved(words.as_slice().to_vec())).unwrap();
        assert_eq!((restored.from, restored.until, restored.tones), (made.from, made.until, made.tones));
    }
}
