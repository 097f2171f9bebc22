//! The dynamic route (C8.7.1.2.1.9): histories of the mechanism under records.
//!
//! After impacts the mechanism changes. The displacement of the oscillator is always that of the common centre of gravity: the sum of masses
//! times horizontal displacements, divided by the participating mass `M*` of the mechanism that starts to that side. For that mechanism it is `d
//! = d_C / e*`, with the common centre of its masses as control point.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::mechanism::CheckedMechanism;
use super::spectrum::Spectrum;
use super::{CheckInput, SideCheck, VerifyError};
use crate::dynamics::Details;
use crate::dynamics::demand::peak_displacement;
use crate::mechanics::Sides;
use crate::scenario::{LimitState, Series, StateRule};
use crate::studies::remarks::ModelCheck;
use crate::studies::runner::in_parallel;
use crate::studies::statistics::{bootstrap, interval};
use crate::{FourLinkError, GroundMotion, MechanismModel, Outcome, Request, SimulationError, Sway};

/// Smallest number of records for which the mean of the peaks counts. With fewer records the largest peak counts (NTC 2018, § 7.3.5).
pub const FOR_THE_MEAN: usize = 7;
/// Smallest and largest allowed ratio of the mean spectrum of records to that of the code (§ 3.2.3.6).
pub const SPECTRUM_MARGIN: [f64; 2] = [0.9, 1.3];
/// Shortest period at which spectra are compared, in seconds.
const FROM_S: f64 = 0.15;
/// Number of intervals between the periods at which spectra are compared.
const PERIODS: u32 = 60;
/// Shortest time after a record until which histories are computed, in seconds.
const AFTER_S: f64 = 10.0;

/// The largest displacement to one side under a record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordPeak {
    /// The largest displacement, in metres; `None` if the structure overturns to that side, or a history ended too early.
    pub peak_m: Option<f64>,
    /// True if the structure overturned to that side.
    pub overturned: bool,
    /// True if a history ended too early for a verdict: a later peak may be larger.
    pub incomplete: bool,
    /// The largest computed displacement, in metres; meaningless if the structure overturns to that side.
    #[serde(skip)]
    pub displacement_m: f64,
}

/// The peaks under a record that acts in both directions in turn; the larger peak counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordPeaks {
    /// Name of the record file.
    pub file: String,
    /// Checksum of the samples.
    pub crc32: String,
    /// Peak acceleration of the record, in g.
    pub peak_g: f64,
    /// Peaks to each checked side.
    #[serde(flatten)]
    pub peaks: BTreeMap<Sway, RecordPeak>,
    /// Largest excess of the thrust line of four links up to the largest rotation, over the thickness; `None` for a column.
    pub thrust_excess_ratio: Option<f64>,
}

/// The results of all records to one side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistorySide {
    /// Restitution of the first impact after a sway to that side; `None` if the impact stops the structure.
    pub restitution: Option<f64>,
    /// Mean of the peaks in metres, or the largest peak if there are few records; `None` if a record overturns the structure or has no verdict.
    pub demand_m: Option<f64>,
    /// Ends of the 95 % interval of the mean, in metres, by bootstrap over the records. `None` if the largest peak counts, or there is no
    /// demand.
    pub mean_interval_m: Option<[f64; 2]>,
    /// Allowed displacement, in metres.
    pub capacity_m: f64,
    /// Allowed displacement divided by the confidence factor FC, in metres.
    pub capacity_over_fc_m: f64,
    /// Ultimate displacement, in metres. No record may exceed it.
    pub d0_m: f64,
    /// Number of records that exceed `d0_m`.
    pub records_beyond_d0: usize,
    /// Number of records that exceed `d0_m` divided by FC.
    pub records_beyond_d0_over_fc: usize,
    /// Number of records outside the model of four links. With any, the side does not pass.
    pub records_outside_model: usize,
    /// True if the side passes; `None` if that depends on a history without a verdict or outside the model.
    pub passed: Option<bool>,
    /// True if the side passes with capacities divided by FC; `None` if that depends on a history without a verdict or outside the model.
    pub passed_over_fc: Option<bool>,
    /// True if a record overturns the structure to that side.
    pub overturned: bool,
}

impl HistorySide {
    /// Allowed displacements with which the demand is compared, in metres.
    pub(super) const fn limits_m(&self) -> [f64; 2] {
        [self.capacity_m, self.capacity_over_fc_m]
    }
}

named! {
    /// The peak that is compared with the capacity.
    pub enum ComparedPeak {
        /// The mean, of at least [`FOR_THE_MEAN`] records.
        Mean = "mean of the peaks",
        /// The largest peak.
        Largest = "largest peak",
    }
}

/// The ratio of the mean 5 % spectrum of the records to the demanded spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeanSpectrum {
    /// The shortest period of the comparison, in seconds.
    pub from_s: f64,
    /// The longest period of the comparison, in seconds.
    pub to_s: f64,
    /// The smallest ratio; `None` if the demanded spectrum is unknown at these periods.
    pub least_ratio: Option<f64>,
    /// The largest ratio; `None` if the demanded spectrum is unknown at these periods.
    pub largest_ratio: Option<f64>,
    /// True if the ratios are within `SPECTRUM_MARGIN`; `None` if they are unknown.
    pub fits: Option<bool>,
}

/// The histories of a limit state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Histories {
    /// The peak that is compared with the capacity.
    pub demand: ComparedPeak,
    /// True if all sides pass; `None` if that depends on a history without a verdict or outside the model of four links.
    pub passed: Option<bool>,
    /// True if all sides pass with capacities divided by FC; `None` if that depends on a history without a verdict or outside the model of four links.
    pub passed_over_fc: Option<bool>,
    /// Number of records with a history that ended too early for a verdict.
    pub incomplete: usize,
    #[serde(flatten)]
    pub(super) model: ModelCheck,
    /// The results of each record.
    pub records: Vec<RecordPeaks>,
    /// Comparison of the spectra.
    pub mean_spectrum: MeanSpectrum,
    /// The results to each checked side.
    #[serde(flatten)]
    pub sides: BTreeMap<Sway, HistorySide>,
}

/// True if all sides pass. A failed side decides even if another has no verdict.
fn all_pass(
    sides: &BTreeMap<Sway, HistorySide>,
    passed: fn(&HistorySide) -> Option<bool>,
) -> Option<bool> {
    match sides.values().any(|side| passed(side) == Some(false)) {
        true => Some(false),
        false => sides
            .values()
            .all(|side| passed(side).is_some())
            .then_some(true),
    }
}

/// Computes the histories of a limit state; `None` if it has no records, or joints slide first to a side: the histories do not slide.
pub(super) fn histories(
    input: &CheckInput<'_>,
    (state, rule, spectrum): (LimitState, &StateRule, &Spectrum),
    mechanisms: &BTreeMap<Sway, CheckedMechanism>,
    sides: &BTreeMap<Sway, SideCheck>,
) -> Result<Option<Histories>, VerifyError> {
    let (scenario, gravity_m_s2) = (input.scenario, input.gravity_m_s2);
    let records = input.settings.records.records_of(state);
    let slides = mechanisms.values().any(|one| one.sliding.is_some());
    if records.is_empty() || slides {
        return Ok(None);
    }
    let failed = |why: String| VerifyError::Histories { state, why };
    let model = scenario.mechanisms();
    let model = model.map_err(|error| match error {
        // These errors recommend another model of motion.
        FourLinkError::Stack | FourLinkError::Argument(_) | FourLinkError::Row(..) => failed(format!(
            "they are of four links or of Housner's block, and stacks, drums, tapers and other mechanisms are neither: leave {}_records \
             out, and compute the records with `archrock suite SCENARIO`",
            state.name()
        )),
        error => failed(error.to_string()),
    })?;
    if let Some(why) = mechanisms.values().find_map(|one| one.no_curve.clone()) {
        return Err(failed(why.into()));
    }
    let compute = |series: &Series| record_peaks(input, &*model, series, mechanisms);
    let found: Result<Vec<RecordPeaks>, SimulationError> =
        in_parallel(records, compute).into_iter().collect();
    let series = records;
    let records = found.map_err(|error| failed(error.to_string()))?;
    let model_check = ModelCheck::of(records.iter().map(|one| one.thrust_excess_ratio));
    let results = mechanisms
        .iter()
        .map(|(sway, mechanism)| {
            let peaks: Vec<RecordPeak> = records.iter().map(|one| one.peaks[sway]).collect();
            let d0_m = mechanism.d0_m.unwrap_or_default();
            let capacity_m = rule.part_of_d0 * d0_m / rule.divide_displacement;
            let side = HistorySide {
                restitution: model.restitution_from(*sway, 1),
                ..history_side(
                    &peaks,
                    model_check.outside.unwrap_or_default(),
                    [capacity_m, d0_m],
                    input.settings.confidence_factor,
                )
            };
            (*sway, side)
        })
        .collect();
    let reached = sides.values().filter_map(|side| side.displacement);
    let to_s = reached.map(|reached| reached.period_s);
    let [from_s, to_s] = [FROM_S, to_s.fold(2.0 * FROM_S, f64::max)];
    let samples: Vec<_> = series
        .iter()
        .map(|series| series.accelerations_m_s2(gravity_m_s2))
        .collect();
    let ratios = spectrum_ratios(&samples, spectrum, [from_s, to_s], gravity_m_s2);
    let [least, largest] = SPECTRUM_MARGIN;
    let is_incomplete = |one: &&RecordPeaks| one.peaks.values().any(|peak| peak.incomplete);
    Ok(Some(Histories {
        demand: match records.len() >= FOR_THE_MEAN {
            true => ComparedPeak::Mean,
            false => ComparedPeak::Largest,
        },
        passed: all_pass(&results, |side| side.passed),
        passed_over_fc: all_pass(&results, |side| side.passed_over_fc),
        incomplete: records.iter().filter(is_incomplete).count(),
        model: model_check,
        records,
        mean_spectrum: MeanSpectrum {
            from_s,
            to_s,
            least_ratio: ratios.map(|ratios| ratios[0]),
            largest_ratio: ratios.map(|ratios| ratios[1]),
            fits: ratios.map(|ratios| ratios[0] >= least && ratios[1] <= largest),
        },
        sides: results,
    }))
}

/// Computes the larger peaks to each checked side of a record that acts in both directions in turn.
fn record_peaks(
    input: &CheckInput<'_>,
    model: &dyn MechanismModel,
    series: &Series,
    mechanisms: &BTreeMap<Sway, CheckedMechanism>,
) -> Result<RecordPeaks, SimulationError> {
    let scenario = input.scenario;
    let both = in_parallel(&[1.0, -1.0], |sign| {
        let ground = scenario.record_motion(series, *sign);
        let request = scenario.request_on(&ground, &scenario.structure);
        let request = Request {
            end_s: request.end_s.max(ground.end_s() + AFTER_S),
            ..request
        };
        peaks(model, &ground, &request, mechanisms)
    })
    .into_iter()
    .collect::<Result<Vec<(Sides<RecordPeak>, Option<f64>)>, _>>()?;
    let larger = |sway: Sway| {
        let (one, other) = (both[0].0.get(sway), both[1].0.get(sway));
        let overturned = one.overturned || other.overturned;
        let incomplete = one.incomplete || other.incomplete;
        let displacement_m = one.displacement_m.max(other.displacement_m);
        RecordPeak {
            peak_m: (!overturned && !incomplete).then_some(displacement_m),
            overturned,
            incomplete,
            displacement_m,
        }
    };
    Ok(RecordPeaks {
        file: series.file.clone(),
        crc32: format!("{:08x}", series.checksum()),
        peak_g: series.peak_g(input.gravity_m_s2),
        peaks: mechanisms
            .keys()
            .map(|sway| (*sway, larger(*sway)))
            .collect(),
        thrust_excess_ratio: both[0].1.zip(both[1].1).map(|(one, other)| one.max(other)),
    })
}

fn history_side(
    peaks: &[RecordPeak],
    records_outside_model: usize,
    [capacity_m, d0_m]: [f64; 2],
    confidence_factor: f64,
) -> HistorySide {
    let overturned = peaks.iter().any(|peak| peak.overturned);
    let displacements = || peaks.iter().map(|peak| peak.displacement_m);
    let is_mean = peaks.len() >= FOR_THE_MEAN;
    let mean_m = displacements().sum::<f64>() / peaks.len() as f64;
    let largest_m = displacements().fold(0.0, f64::max);
    let least_m = if is_mean { mean_m } else { largest_m };
    let incomplete = peaks.iter().any(|peak| peak.incomplete);
    let demand_m = (!overturned && !incomplete).then_some(least_m);
    let mean_interval_m = demand_m.filter(|_| is_mean).and_then(|_| {
        let means = bootstrap(peaks.len()).map(|drawn| {
            let drawn = drawn.iter().map(|record| peaks[*record].displacement_m);
            drawn.sum::<f64>() / peaks.len() as f64
        });
        interval(means.collect())
    });
    let [(beyond, passed), (beyond_fc, passed_fc)] = [1.0, confidence_factor].map(|divisor| {
        let exceeds = |peak: &&RecordPeak| peak.overturned || peak.displacement_m > d0_m / divisor;
        let exceeded = peaks.iter().filter(exceeds).count();
        let passes = !overturned && exceeded == 0 && least_m <= capacity_m / divisor;
        // Later peaks of an incomplete history can only be larger, and four links outside their model are not on the safe side, so a failure is final.
        let is_known = !incomplete && records_outside_model == 0;
        (exceeded, (!passes || is_known).then_some(passes))
    });
    HistorySide {
        restitution: None,
        demand_m,
        mean_interval_m,
        capacity_m,
        capacity_over_fc_m: capacity_m / confidence_factor,
        d0_m,
        records_beyond_d0: beyond,
        records_beyond_d0_over_fc: beyond_fc,
        records_outside_model,
        passed,
        passed_over_fc: passed_fc,
        overturned,
    }
}

/// Computes the largest displacements of a history to the right and to the left, and the excess of its thrust line.
fn peaks(
    model: &dyn MechanismModel,
    ground: &GroundMotion,
    request: &Request,
    mechanisms: &BTreeMap<Sway, CheckedMechanism>,
) -> Result<(Sides<RecordPeak>, Option<f64>), SimulationError> {
    let summary = model.simulate(ground, request, None)?;
    let shifts_kg_m = match &summary.details {
        Details::Mechanisms(of) => of.largest_shifts_kg_m,
        Details::Rigid(_) | Details::Elastic(..) => Sides::default(),
    };
    let mut peaks = Sides::of(|sway| RecordPeak {
        displacement_m: (mechanisms.get(&sway))
            .map_or(0.0, |own| shifts_kg_m.get(sway) / own.m_star_kg),
        ..RecordPeak::default()
    });
    match summary.outcome {
        Outcome::Overturned(sway) => peaks.to_mut(sway).overturned = true,
        Outcome::Incomplete => [peaks.right.incomplete, peaks.left.incomplete] = [true; 2],
        _ => {}
    }
    Ok((peaks, summary.thrust_excess_ratio()))
}

/// Computes the smallest and the largest ratio of the mean 5 % spectrum of records to another spectrum; `None` if the other spectrum is unknown
/// at a period.
fn spectrum_ratios(
    records: &[Vec<(f64, f64)>],
    spectrum: &Spectrum,
    [from_s, to_s]: [f64; 2],
    gravity_m_s2: f64,
) -> Option<[f64; 2]> {
    let steps: Vec<u32> = (0..=PERIODS).collect();
    let ratios = in_parallel(&steps, |step| {
        let part = f64::from(*step) / f64::from(PERIODS);
        let period_s = from_s * libm::pow(to_s / from_s, part);
        let own_m = records
            .iter()
            .map(|samples| peak_displacement(samples, period_s, 5.0));
        let mean_m = own_m.sum::<f64>() / records.len() as f64;
        let circular = 2.0 * std::f64::consts::PI / period_s;
        let demand_g = spectrum.acceleration_g(period_s, 5.0).ok()?;
        Some(mean_m * circular * circular / gravity_m_s2 / demand_g)
    })
    .into_iter()
    .collect::<Option<Vec<f64>>>()?;
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    Some([least, ratios.into_iter().fold(0.0, f64::max)])
}
