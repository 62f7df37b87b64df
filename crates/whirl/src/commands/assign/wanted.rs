//! Wanted poles as typed on the command line.

use rotor::C64;

/// The text of `--poles`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Poles(pub(super) Vec<C64>);

impl std::str::FromStr for Poles {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let pole = |text: &str| {
            let (re, im) = text.split_once(',')?;
            let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
            Some(C64::new(number(re)?, number(im)?))
        };
        typed
            .split(';')
            .filter(|text| !text.trim().is_empty())
            .map(|text| pole(text).ok_or_else(|| format!("'{}': expected re,im with finite numbers", text.trim())))
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_are_read_as_typed() {
        let poles: Poles = "-0.5,1; -1e-1 , -2;".parse().expect("well formed");
        assert_eq!(poles.0, [C64::new(-0.5, 1.0), C64::new(-0.1, -2.0)]);
        for wrong in ["1", "1,2,3", "a,b", "1,inf", "1,2;x"] {
            assert!(wrong.parse::<Poles>().unwrap_err().contains("expected re,im"), "{wrong}");
        }
    }
}
