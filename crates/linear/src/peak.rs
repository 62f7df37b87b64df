//! Where a function of one number is largest: by golden section, between two places with one maximum.

/// Where `of` is largest between `from` and `to`, to nine digits: finer than that a maximum is flat to the last place.
pub fn top(from: f64, to: f64, of: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (from, to);
    let [mut a, mut b] = [high - golden * (high - low), low + golden * (high - low)].map(|x| (x, of(x)));
    while high - low > 1e-9 * (1.0 + high.abs()) {
        if a.1 > b.1 {
            (high, b) = (b.0, a);
            let x = high - golden * (high - low);
            a = (x, of(x));
        } else {
            (low, a) = (a.0, b);
            let x = low + golden * (high - low);
            b = (x, of(x));
        }
    }
    if a.1 > b.1 { a.0 } else { b.0 }
}
