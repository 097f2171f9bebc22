//! The dynamic route (C8.7.1.2.1.9): histories of the mechanism under records.
//!
//! Whichever mechanism moves after impacts, the displacement of the oscillator is that of the common centre of gravity: the sum
//! of the masses times their horizontal displacements, divided by the participating mass `M*` of the mechanism that starts to that
//! side. For that mechanism it is `d = d_C / e*`, with the common centre of its masses as control point.

use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

use super::{Check, Mechanism, NoCheck, SideCheck, Spectrum, Way};
use crate::dynamics::demand::oscillator::peak_displacement;
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::{EventKind, Outcome, State};
use crate::dynamics::model::{MechanismModel, Request, SimulationError};
use crate::mechanics::four_links::FourLinkError;
use crate::mechanics::sway::Sway;
use crate::scenario::{LimitState, Scenario, Series, StateRule};
use crate::studies::statistics::{bootstrap, interval};

/// With this many records or more the mean counts, otherwise the largest (NTC 2018, § 7.3.5).
pub const FOR_THE_MEAN: usize = 7;
/// Allowed ratios of the mean spectrum of records to that of the code, the least and the largest (§ 3.2.3.6).
pub const SPECTRUM_MARGIN: [f64; 2] = [0.9, 1.3];
/// Shortest period at which spectra are compared, in seconds.
const FROM_S: f64 = 0.15;
/// Number of intervals between the periods at which they are compared.
const PERIODS: u32 = 60;
/// Interval at which peaks are looked for, in seconds. The error of a peak is about half its acceleration, at most a few m/s2, times
/// the square of half the interval.
const STEP_S: f64 = 0.002;
/// Least time after a record, in seconds, that is followed.
const AFTER_S: f64 = 10.0;

/// The largest displacement under a record to one side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// In metres; meaningless if the structure overturns to that side.
    pub displacement_m: f64,
    /// Whether it overturned to that side.
    pub overturned: bool,
    /// Whether a history ended too early for a verdict: a later peak may be larger.
    pub incomplete: bool,
}

/// The peaks under a record that acts in either direction; the larger peak counts.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordPeaks {
    /// The file.
    pub file: String,
    /// Checksum of its samples.
    pub checksum: u32,
    /// Peak acceleration, in g.
    pub peak_g: f64,
    /// To the right and to the left.
    pub peaks: [Peak; 2],
}

/// The results of all records to one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistorySide {
    /// The side.
    pub sway: Sway,
    /// The restitution of the first impact after a sway to that side; `None` if it stops the structure.
    pub restitution: Option<f64>,
    /// Mean of the peaks, or the largest if there are few records; `None` if one overturns or has no verdict.
    pub demand_m: Option<f64>,
    /// Ends of the 95 % interval of the mean, in metres, by bootstrap over the records: after impacts peaks scatter. `None` if the
    /// largest peak counts, or there is no demand.
    pub mean_interval_m: Option<[f64; 2]>,
    /// Displacement that may be reached, in metres.
    pub capacity_m: f64,
    /// The same divided by FC.
    pub capacity_over_fc_m: f64,
    /// Ultimate displacement, in metres, which no record may exceed.
    pub d0_m: f64,
    /// The number of records that exceed it, without and with division by FC.
    pub exceeded: [usize; 2],
    /// Whether a record overturns the structure to that side.
    pub overturned: bool,
    /// Whether the side passes, with capacities not divided and divided by FC; `None` if that depends on a history without a verdict.
    pub passes: [Option<bool>; 2],
}

/// The histories of a limit state.
#[derive(Clone, Debug, PartialEq)]
pub struct Histories {
    /// The results of each record.
    pub records: Vec<RecordPeaks>,
    /// The results to each side.
    pub sides: Vec<HistorySide>,
    /// Least and largest ratio of the mean 5 % spectrum of the records to the demanded one; `None` if the latter is
    /// unknown at these periods.
    pub spectrum_ratios: Option<[f64; 2]>,
    /// The shortest and the longest period of the comparison, in seconds.
    pub periods_s: [f64; 2],
}

impl Histories {
    /// Whether all sides pass, with capacities not divided and divided by FC; `None` if that depends on a history without a verdict.
    #[must_use]
    pub fn passes(&self) -> [Option<bool>; 2] {
        [0, 1].map(|divided| {
            let passes = self.sides.iter().map(|side| side.passes[divided]);
            // `None` is less than `Some(true)`, and does not hide a side that fails.
            if passes.clone().any(|passes| passes == Some(false)) {
                return Some(false);
            }
            passes.min().flatten()
        })
    }

    /// Number of records with a history that ended too early for a verdict.
    #[must_use]
    pub fn incomplete(&self) -> usize {
        let records = self.records.iter();
        let incomplete = |record: &&RecordPeaks| record.peaks.iter().any(|peak| peak.incomplete);
        records.filter(incomplete).count()
    }

    /// Whether the mean of the peaks counts, instead of the largest.
    #[must_use]
    pub fn is_mean(&self) -> bool {
        self.records.len() >= FOR_THE_MEAN
    }

    /// Whether the mean spectrum of the records is within the margins of the code.
    #[must_use]
    pub fn fits_the_spectrum(&self) -> Option<bool> {
        let [least, largest] = self.spectrum_ratios?;
        Some(least >= SPECTRUM_MARGIN[0] && largest <= SPECTRUM_MARGIN[1])
    }
}

/// The histories of a limit state, if it has records.
pub(super) fn histories(
    scenario: &Scenario,
    check: &Check,
    (state, checks): (LimitState, &[SideCheck]),
    spectrum: &Spectrum,
    rule: Option<&StateRule>,
) -> Result<Option<Histories>, NoCheck> {
    let (records, Some(rule)) = (check.settings.records.of(state), rule) else {
        return Ok(None);
    };
    if records.is_empty() {
        return Ok(None);
    }
    let failed = |why: String| NoCheck::Histories { state, why };
    let model = scenario.mechanisms();
    let model = model.map_err(|error| match error {
        // These errors recommend another model of motion.
        FourLinkError::Stack | FourLinkError::Argument(_) | FourLinkError::Row { .. } => failed(format!(
            "they are of four links or of Housner's block, and stacks, drums, tapers and other mechanisms are neither: leave {}_records \
             out, and compute the records with `archrock suite`",
            state.name()
        )),
        error => failed(error.to_string()),
    })?;
    let ways: Result<Vec<(&Mechanism, &Way)>, String> = (check.mechanisms.iter())
        .map(|mechanism| Ok((mechanism, mechanism.way.as_ref().map_err(String::clone)?)))
        .collect();
    let ways = ways.map_err(failed)?;
    // Right and left, the order of the sides: histories sway to both.
    let participating_kg = [0, 1].map(|side: usize| {
        let mechanism = ways.get(side).map(|way| way.0);
        mechanism.map_or(f64::INFINITY, |one| one.participation.participating_mass_kg)
    });
    let runs: Vec<(usize, f64)> = (0..records.len())
        .flat_map(|record| [1.0, -1.0].map(|sign| (record, sign)))
        .collect();
    let peaks: Result<Vec<[Peak; 2]>, SimulationError> = runs
        .into_par_iter()
        .map(|(record, sign)| {
            let series = &records[record];
            let ground = scenario.shaken_by(series, sign);
            let request = scenario.request_on(&ground, scenario.structure());
            let request = Request {
                end_s: request.end_s.max(ground.end_s() + AFTER_S),
                output_step_s: STEP_S,
                ..request
            };
            peaks(&*model, &ground, &request, participating_kg)
        })
        .collect();
    let peaks = peaks.map_err(|error| failed(error.to_string()))?;
    let gravity_m_s2 = check.gravity_m_s2;
    let records: Vec<(RecordPeaks, &Series)> = records
        .iter()
        .zip(peaks.chunks(2))
        .map(|(series, both)| {
            let larger = |side: usize| Peak {
                displacement_m: both[0][side]
                    .displacement_m
                    .max(both[1][side].displacement_m),
                overturned: both[0][side].overturned || both[1][side].overturned,
                incomplete: both[0][side].incomplete || both[1][side].incomplete,
            };
            let peaks = RecordPeaks {
                file: series.file.clone(),
                checksum: series.checksum(),
                peak_g: series.peak_g(gravity_m_s2),
                peaks: [larger(0), larger(1)],
            };
            (peaks, series)
        })
        .collect();
    let factor = check.settings.confidence_factor;
    let told: Vec<RecordPeaks> = records.iter().map(|(peaks, _)| peaks.clone()).collect();
    let sides = ways.iter().enumerate().map(|(side, (mechanism, way))| {
        let d0_m = way.centre.end().oscillator_displacement_m;
        let capacity_m = rule.part_of_d0 * d0_m / rule.divide_displacement;
        HistorySide {
            restitution: model.restitution_from(mechanism.sway, 1),
            ..history_side(mechanism.sway, side, &told, [capacity_m, d0_m], factor)
        }
    });
    let periods = checks
        .iter()
        .filter_map(|side| Some(side.displacement?.period_s));
    let periods_s = [FROM_S, periods.fold(2.0 * FROM_S, f64::max)];
    let samples: Vec<Vec<(f64, f64)>> = records
        .iter()
        .map(|(_, series)| series.accelerations_m_s2(gravity_m_s2))
        .collect();
    Ok(Some(Histories {
        sides: sides.collect(),
        spectrum_ratios: spectrum_ratios(&samples, spectrum, periods_s, gravity_m_s2),
        periods_s,
        records: told,
    }))
}

fn history_side(
    sway: Sway,
    side: usize,
    records: &[RecordPeaks],
    [capacity_m, d0_m]: [f64; 2],
    confidence_factor: f64,
) -> HistorySide {
    let peaks: Vec<Peak> = records.iter().map(|record| record.peaks[side]).collect();
    let overturned = peaks.iter().any(|peak| peak.overturned);
    let displacements = || peaks.iter().map(|peak| peak.displacement_m);
    let is_mean = peaks.len() >= FOR_THE_MEAN;
    let least_m = if is_mean {
        displacements().sum::<f64>() / peaks.len() as f64
    } else {
        displacements().fold(0.0, f64::max)
    };
    let incomplete = peaks.iter().any(|peak| peak.incomplete);
    let demand_m = (!overturned && !incomplete).then_some(least_m);
    let mean_interval_m = demand_m.filter(|_| is_mean).and_then(|_| {
        let means = bootstrap(peaks.len()).map(|drawn| {
            let drawn = drawn.iter().map(|record| peaks[*record].displacement_m);
            drawn.sum::<f64>() / peaks.len() as f64
        });
        interval(means.collect())
    });
    let divisors = [1.0, confidence_factor];
    let exceeded = divisors.map(|divisor| {
        let exceeds = |peak: &&Peak| peak.overturned || peak.displacement_m > d0_m / divisor;
        peaks.iter().filter(exceeds).count()
    });
    // Later peaks of an incomplete history can only make it worse.
    let passes = [0, 1].map(|i: usize| {
        let passes = !overturned && exceeded[i] == 0 && least_m <= capacity_m / divisors[i];
        (!passes || !incomplete).then_some(passes)
    });
    HistorySide {
        sway,
        restitution: None,
        demand_m,
        mean_interval_m,
        capacity_m,
        capacity_over_fc_m: capacity_m / confidence_factor,
        d0_m,
        exceeded,
        overturned,
        passes,
    }
}

/// The largest displacements of a history to the right and to the left.
fn peaks(
    model: &dyn MechanismModel,
    ground: &GroundMotion,
    request: &Request,
    participating_kg: [f64; 2],
) -> Result<[Peak; 2], SimulationError> {
    let history = model.history(ground, request)?;
    // The chain of mechanisms is the one that begins with the side of the latest uplift.
    let mut first = Sway::Right;
    let links: Vec<Option<(Sway, usize)>> = history
        .events
        .iter()
        .map(|event| {
            if event.kind == EventKind::Uplift {
                first = event.state.sway().unwrap_or(first);
            }
            Some((first, event.mechanism?))
        })
        .collect();
    let mut peaks = [Peak::default(); 2];
    for sample in history.samples.iter() {
        let State::Rocking(sway) = sample.state else {
            continue;
        };
        let link = sample
            .phase
            .checked_sub(1)
            .and_then(|event| *links.get(event)?);
        let carrier = match sway {
            Sway::Right => sample.rotations_rad.first(),
            Sway::Left => sample.rotations_rad.last(),
        };
        let shift = link
            .zip(carrier)
            .and_then(|((first, impacts), rotation_rad)| {
                model.shift_kg_m(first, impacts, rotation_rad.abs())
            });
        let side = usize::from(sway == Sway::Left);
        let displacement_m = shift.unwrap_or_default() / participating_kg[side];
        peaks[side].displacement_m = peaks[side].displacement_m.max(displacement_m);
    }
    match history.summary.outcome {
        Outcome::Overturned(sway) => peaks[usize::from(sway == Sway::Left)].overturned = true,
        Outcome::Incomplete => peaks.iter_mut().for_each(|peak| peak.incomplete = true),
        _ => {}
    }
    Ok(peaks)
}

/// Least and largest ratio of the mean 5 % spectrum of records to another spectrum.
fn spectrum_ratios(
    records: &[Vec<(f64, f64)>],
    spectrum: &Spectrum,
    [from_s, to_s]: [f64; 2],
    gravity_m_s2: f64,
) -> Option<[f64; 2]> {
    let ratios: Option<Vec<f64>> = (0..=PERIODS)
        .into_par_iter()
        .map(|step| {
            let part = f64::from(step) / f64::from(PERIODS);
            let period_s = from_s * (to_s / from_s).powf(part);
            let own_m = records
                .iter()
                .map(|samples| peak_displacement(samples, period_s, 5.0));
            let mean_m = own_m.sum::<f64>() / records.len() as f64;
            let circular = 2.0 * std::f64::consts::PI / period_s;
            let demand_g = spectrum.acceleration_g(period_s, 5.0).ok()?;
            Some(mean_m * circular * circular / gravity_m_s2 / demand_g)
        })
        .collect();
    let ratios = ratios?;
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    Some([least, ratios.into_iter().fold(0.0, f64::max)])
}
