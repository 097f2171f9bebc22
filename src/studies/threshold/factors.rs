//! Factors on a ground motion that a search for thresholds tries.

use serde::{Deserialize, Serialize};

use crate::argument::{ArgumentError, plain, require_above, require_within};
use crate::dynamics::Directions;
use crate::scenario::Varied;
use crate::{GroundMotion, Model, Request, Sway};

/// Relative width to which bisection encloses the edge between neighbouring factors with different certain verdicts.
pub const EDGE_WIDTH: f64 = 1e-4;
/// Relative width of an edge beside an uncertain factor, whose histories are all repeated six times.
pub(super) const UNCERTAIN_EDGE_WIDTH: f64 = 1e-2;

/// Factors on a ground motion that a search tries, as given: a default depends on the model and on the ground motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Factors {
    /// The first factor; `None`: the onset of motion, or 0.1 where the onset is unknown.
    pub from: Option<f64>,
    /// The last factor; `None`: the first one that certainly overturns the structure.
    pub to: Option<f64>,
    /// The relative step between factors.
    pub stride: f64,
}

impl Default for Factors {
    /// Factors from the onset to the first certain collapse in strides of 2 %.
    fn default() -> Self {
        Self {
            from: None,
            to: None,
            stride: 0.02,
        }
    }
}

/// Largest factor of a search that no collapse ends, if the onset is below 1; otherwise over the onset.
const MOST: f64 = 10.0;
/// First factor where the onset is unknown.
const LEAST: f64 = 0.1;

impl Factors {
    /// Makes factors from `from`, at least 1e-6, to `to`, which is larger and at most 1e6. Each step is `stride` times the factor; `stride` is
    /// between 1e-4 and 1.
    ///
    /// # Errors
    /// When a number is not allowed.
    pub fn new(
        from: impl Into<Option<f64>>,
        to: impl Into<Option<f64>>,
        stride: f64,
    ) -> Result<Self, ArgumentError> {
        let (from, to) = (from.into(), to.into());
        if let Some(from) = from {
            require_within("from", from, 1e-6..=1e6)?;
        }
        if let Some(to) = to {
            require_above("to", to, from.unwrap_or(1e-6), 1e6)?;
        }
        let stride = require_within("stride", stride, 1e-4..=1.0)?;
        Ok(Self { from, to, stride })
    }

    /// Largest factor, for warnings about it.
    pub(in crate::studies) fn varied(&self) -> Varied<'static> {
        Varied {
            factor: self.to,
            ..Varied::default()
        }
    }

    /// Options of a command that searches these factors, with a space before each; empty for the default.
    pub(in crate::studies) fn options(&self) -> String {
        let given = [("--from", self.from), ("--to", self.to)]
            .into_iter()
            .filter_map(|(name, at)| Some((name, at?)));
        let own = Self::default().stride != self.stride;
        let stride = own.then_some(("--stride", self.stride));
        let all = given.chain(stride);
        all.map(|(name, value)| format!(" {name} {value}"))
            .collect()
    }

    /// Command that searches these factors for a scenario on standard input, without `archrock`.
    pub(in crate::studies) fn command(&self) -> String {
        format!("threshold -{} --out case", self.options())
    }

    /// Factors of a search for a structure that never moves below its [onset](onset_factor), if that is known.
    ///
    /// # Errors
    /// If no factor moves the structure, or the last factor is not above the first.
    pub fn factors_to_search(&self, onset: Option<f64>) -> Result<SearchedFactors, String> {
        if onset == Some(f64::INFINITY) {
            return Err(
                "there is no threshold: no push of the ground moves the structure without sliding"
                    .to_owned(),
            );
        }
        let start = onset.map(|onset| onset * (1.0 - EDGE_WIDTH));
        let from = self.from.or(start).unwrap_or(LEAST);
        let to = self.to.unwrap_or(MOST * from.max(1.0));
        if to <= from {
            return Err(format!(
                "--to {}: the structure does not move below the factor {}: give a larger one",
                plain(to),
                plain(from)
            ));
        }
        Ok(SearchedFactors {
            from,
            to,
            stride: self.stride,
            begins_at_onset: start == Some(from),
            lower_not_tried: start.is_none_or(|start| from > start),
            ends_at_collapse: self.to.is_none(),
        })
    }
}

/// Factors on a ground motion that a search tries, for one model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SearchedFactors {
    /// The first factor.
    pub from: f64,
    /// The last factor.
    pub to: f64,
    /// The relative step between factors.
    pub stride: f64,
    /// True if the first factor is the onset of motion.
    pub begins_at_onset: bool,
    /// True if factors below the first one may overturn the structure: the first one is above the onset of motion, or the onset is unknown.
    pub lower_not_tried: bool,
    /// True if the search ends at the first factor that certainly overturns the structure.
    pub ends_at_collapse: bool,
}

impl SearchedFactors {
    /// All factors, ascending.
    pub fn values(&self) -> Vec<f64> {
        // Drops a last step that is due to rounding errors only.
        let end = self.to * (1.0 - 1e-9);
        let next = |factor: &f64| Some(factor * (1.0 + self.stride));
        let mut values: Vec<f64> = std::iter::successors(Some(self.from), next)
            .take_while(|factor| *factor < end)
            .collect();
        values.push(self.to);
        values
    }
}

/// Factor on a ground motion below which a structure at rest never moves, in any of these directions: the largest push of the ground is
/// that of incipient motion. Infinity if none of its pushes moves the structure. `None` where it is unknown: with elastic joints, with vertical
/// motion, with feet that move apart, and for a motion that does not start from rest.
pub fn onset_factor(
    model: &dyn Model,
    directions: Directions,
    (ground, request): (&GroundMotion, &Request),
) -> Option<f64> {
    let moves_otherwise = ground.has_vertical() || ground.right_foot().is_some();
    if model.moves_below_incipient() || moves_otherwise || request.initial.is_some() {
        return None;
    }
    let starts_g = [Sway::Right, Sway::Left].map(|sway| model.incipient_acceleration_g(sway));
    let [right, left] = ground.pushes_m_s2(f64::INFINITY);
    let mirrored = (directions == Directions::Both).then_some([left, right]);
    let over = [right, left]
        .into_iter()
        .chain(mirrored.into_iter().flatten());
    let starts_g = starts_g.into_iter().cycle();
    let over = over
        .zip(starts_g)
        .filter_map(|(push_m_s2, start_g)| Some(push_m_s2 / (start_g? * request.gravity_m_s2)));
    let factor = 1.0 / over.fold(0.0, f64::max);
    (factor > 0.0).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(from: f64, to: f64, stride: f64) -> Vec<f64> {
        let factors = Factors::new(from, to, stride).unwrap();
        factors.factors_to_search(None).unwrap().values()
    }

    #[test]
    fn factors_rise_by_strides_from_the_first_to_the_last() {
        assert_eq!(values(1.0, 8.0, 1.0), [1.0, 2.0, 4.0, 8.0]);
        assert_eq!(values(1.0, 5.0, 1.0), [1.0, 2.0, 4.0, 5.0]);
        assert_eq!(values(1.0, 1.02, 0.02), [1.0, 1.02]);
        let default = Factors::default().factors_to_search(None).unwrap().values();
        assert_eq!((default.len(), default[0]), (234, 0.1));
        assert!(
            default
                .windows(2)
                .all(|pair| pair[1] <= pair[0] * 1.0200001)
        );
    }

    /// A default search begins at the onset; one that begins above it leaves out factors that may overturn the structure.
    #[test]
    fn a_search_knows_whether_lower_factors_may_overturn() {
        let search = |from, onset| {
            Factors::new(from, None, 0.02)
                .unwrap()
                .factors_to_search(onset)
                .unwrap()
        };
        let own = search(None, Some(0.4));
        assert!(own.from < 0.4 && own.from > 0.3999 && !own.lower_not_tried);
        assert!(search(None, None).lower_not_tried);
        assert!(search(Some(0.5), Some(0.4)).lower_not_tried);
        assert!(!search(Some(0.3), Some(0.4)).lower_not_tried);
        assert_eq!(
            search(None, Some(3.0)).to,
            10.0 * search(None, Some(3.0)).from
        );
        let below = Factors::new(None, 0.3, 0.02).unwrap();
        assert!(below.factors_to_search(Some(0.4)).is_err());
    }

    #[test]
    fn factors_that_are_none_are_refused() {
        for (from, to, stride, argument) in [
            (0.0, 1.0, 0.1, "from"),
            (f64::NAN, 1.0, 0.1, "from"),
            (1.0, 1.0, 0.1, "to"),
            (1.0, f64::INFINITY, 0.1, "to"),
            (1.0, 2.0, 0.0, "stride"),
            (1.0, 2.0, f64::NAN, "stride"),
        ] {
            let error = Factors::new(from, to, stride).unwrap_err();
            assert_eq!(error.argument, argument);
        }
    }
}
