//! Where something is largest between two speeds, by golden section.

/// Looks between `low` and `high`, around one maximum, until they are `near` apart. `look` gives the height at a speed, and keeps
/// what it has seen if that is to be kept.
///
/// # Errors
/// The first of `look`.
pub(super) fn climb<E>(
    [mut low, mut high]: [f64; 2],
    near: f64,
    mut look: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(), E> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (look(a)?, look(b)?);
    while high - low > near {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = look(a)?;
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = look(b)?;
        }
    }
    Ok(())
}
