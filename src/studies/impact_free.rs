//! Overturning without impact: in the first fall from rest, before the hinges ever close.
//!
//! Nothing of the impact model enters here, so this boundary is what other programs and closed forms can be
//! compared with. Along the amplitude of a pulse with one lobe it has one edge. A pulse with side lobes can
//! overturn within narrow windows of the amplitude, in which a lobe carries the structure just over and the next
//! does not catch it; so the edge is looked for in small strides, and bisected where it is found.

use crate::dynamics::ground::Pulse;

/// Ratio of the amplitudes at which the edge of a pulse with lobes to both sides is looked for: a window that is
/// narrower may go unseen. The narrowest found, under Ricker, Gabor and windowed pulses, were some 1.5 % wide.
const STRIDE: f64 = 1.005;

/// The same for pulses to one side. More of these pushes harder at every instant, so there is one edge, however far
/// the strides.
const ONE_SIDED_STRIDE: f64 = 1.5;

/// Relative width to which the edge is bisected: the integration at the default tolerance knows no more.
const RESOLUTION: f64 = 1e-9;

/// Amplitudes of a pulse from `from` to `to`, in strides that do not miss an edge: of 0.5 % where there can be
/// windows.
pub fn strides(pulse: Pulse, from: f64, to: f64) -> impl Iterator<Item = f64> {
    let stride = if pulse.is_one_sided() {
        ONE_SIDED_STRIDE
    } else {
        STRIDE
    };
    std::iter::successors(Some(from), move |last| {
        (*last < to).then(|| (last * stride).min(to))
    })
}

/// The least amplitude that overturns without impact, from a function that tells whether one does: the first
/// of ascending ones, bisected to `1e-9` of it against the one before. `None` if none does.
///
/// # Errors
/// Those of the function.
pub fn least_amplitude<E>(
    ascending: impl IntoIterator<Item = f64>,
    overturns: impl Fn(f64) -> Result<bool, E>,
) -> Result<Option<f64>, E> {
    let mut below = None;
    for amplitude in ascending {
        if overturns(amplitude)? {
            let (mut low, mut high) = (below.unwrap_or(amplitude), amplitude);
            while high - low > RESOLUTION * high {
                let middle = 0.5 * (low + high);
                if overturns(middle)? {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            return Ok(Some(high));
        }
        below = Some(amplitude);
    }
    Ok(None)
}
