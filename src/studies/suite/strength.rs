//! Capacities: the lowest overturning intensity of each record, in several measures, and the efficiency of these measures.
//!
//! A measure is efficient if all records overturn the structure at about the same intensity in this measure (Luco and Cornell, Earthquake
//! Spectra 23, 2007). The dispersion of the capacities is the standard deviation of their logarithms: the smaller, the more efficient is the
//! measure.

use serde::{Deserialize, Serialize};

use super::{CaseRow, SuiteFragility};
use crate::dynamics::Intensity;
use crate::dynamics::demand::peak_displacement;
use crate::output::each;
use crate::scenario::{Series, Spectral};
use crate::studies::intervals::dispersion_interval;
use crate::studies::statistics::bootstrap;
use crate::studies::threshold::Survival;

/// Intensities of an unscaled record in all measures apart from its peak acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strength {
    /// Peak velocity, in m/s.
    pub velocity_m_s: f64,
    /// Spectral acceleration, in units of gravity.
    pub spectral_g: f64,
    /// Arias intensity, in m/s.
    pub arias_m_s: f64,
}

impl Strength {
    /// Computes the intensities of a record. The spectral acceleration is the pseudo-acceleration: `omega^2` times the largest displacement.
    pub fn of(series: &Series, spectral: Spectral, gravity_m_s2: f64) -> Self {
        let samples = series.accelerations_m_s2(gravity_m_s2);
        let intensity = Intensity::of(&samples, gravity_m_s2);
        let period_s = spectral.period_s;
        let displacement_m = peak_displacement(&samples, period_s, spectral.damping_percent);
        let omega = 2.0 * std::f64::consts::PI / period_s;
        Self {
            velocity_m_s: intensity.velocity_m_s.value,
            spectral_g: omega * omega * displacement_m / gravity_m_s2,
            arias_m_s: intensity.arias_m_s,
        }
    }
}

impl Strength {
    /// Intensities of the record times a factor, in the order of [`MEASURES`] after the peak acceleration.
    pub(super) fn at(&self, scale: f64) -> [f64; 3] {
        [
            self.velocity_m_s * scale,
            self.spectral_g * scale,
            self.arias_m_s * scale.powi(2),
        ]
    }
}

/// The lowest intensity that overturns the structure under a record.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordCapacity<'a> {
    /// Name of the record file.
    pub record: &'a str,
    /// True if the record is mirrored.
    pub mirrored: bool,
    /// The largest factor on the record up to which the structure certainly survives; `None` if it does not survive the lowest level.
    pub survives_up_to_scale: Option<f64>,
    /// The factor on the record; `None` if no level overturns the structure.
    pub scale: Option<f64>,
    /// True if the capacity may be less: the lowest level already overturns the structure, or the level below has no complete history.
    pub at_most: bool,
    /// True if factors between the levels below it were not tried, so that some of them may overturn the structure.
    pub levels_only: bool,
    /// The intensities at that factor, in the order of [`MEASURES`]; `None` if no level overturns the structure.
    pub in_measures: [Option<f64>; 4],
}

/// The measures: name in results, name in words, and the power of the factor on a record to which the measure is proportional.
pub const MEASURES: [(&str, &str, f64); 4] = [
    ("peak_g", "peak acceleration", 1.0),
    ("peak_velocity_m_s", "peak velocity", 1.0),
    ("spectral_acceleration_g", "spectral acceleration", 1.0),
    ("arias_m_s", "Arias intensity", 2.0),
];

/// The efficiency of a measure: the scatter of the overturning intensities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Efficiency {
    /// Name of the measure.
    pub measure: String,
    /// Number of capacities.
    pub capacities: usize,
    /// Geometric mean of the capacities.
    pub median: f64,
    /// Standard deviation of the logarithms of the capacities.
    pub dispersion: f64,
    /// Dispersion of the factor on the record: the dispersion of the measure, halved if the measure is proportional to the square of the factor.
    pub dispersion_of_factor: f64,
    /// Ends of the 95 % interval of `dispersion_of_factor`, by the chi-square distribution for the number of records that overturn the structure.
    pub dispersion_of_factor_interval: Option<[f64; 2]>,
    /// Share of the bootstrap draws in which no other measure has a smaller dispersion of the factor.
    pub best_share: f64,
}

impl SuiteFragility {
    /// Computes the capacity under each record and each mirrored record.
    pub fn capacities(&self) -> Vec<RecordCapacity<'_>> {
        self.cases_by_record()
            .map(|levels| self.capacity(levels))
            .collect()
    }

    fn capacity<'a>(&self, levels: &'a [CaseRow]) -> RecordCapacity<'a> {
        let own = &levels[0];
        let survival = self.survival(levels);
        let levels_only = Self::is_of_levels_only(levels, &survival);
        let Survival {
            survives_up_to: safe,
            overturns_from: level,
            at_most,
            ..
        } = survival;
        let scale_of = |level: f64| own.scale * level / own.level(self.measure);
        let scale = level.map(scale_of);
        // All measures are scaled by the factor of the peak.
        let peak_g = scale.map(|scale| own.peak_g / own.scale * scale);
        let at = own.strength.as_ref().zip(scale);
        let [velocity, spectral, arias] = each(at.map(|(strength, scale)| strength.at(scale)));
        RecordCapacity {
            record: &own.record,
            mirrored: own.mirrored,
            survives_up_to_scale: safe.map(scale_of),
            scale,
            at_most,
            levels_only,
            in_measures: [peak_g, velocity, spectral, arias],
        }
    }
}

/// Number of records below which a dispersion gets a note.
const MANY_RECORDS: usize = 30;

/// Error of a dispersion from this number of records, in words; `None` with many records. The relative standard deviation of the
/// standard deviation of `n` normal values is `1 / sqrt(2 (n - 1))`.
pub(in crate::studies) fn warning_of_few_records(records: usize) -> Option<String> {
    let percent = 100.0 / (2.0 * (records.max(2) - 1) as f64).sqrt();
    (records < MANY_RECORDS).then(|| {
        format!("few records: a dispersion from {records} has a standard error of at least {percent:.0} %")
    })
}

/// Smallest number of capacities for a dispersion.
const LEAST_CAPACITIES: usize = 3;

/// Computes number, geometric mean and dispersion of the capacities in a measure, and the dispersion of the factor on the record. `None` with
/// fewer than three capacities.
fn scatter<'a>(
    capacities: impl Iterator<Item = &'a RecordCapacity<'a>>,
    measure: usize,
) -> Option<(usize, [f64; 3])> {
    let found = capacities.filter_map(|capacity| capacity.in_measures[measure]);
    let logarithms: Vec<f64> = found.filter(|at| *at > 0.0).map(libm::log).collect();
    let count = logarithms.len() as f64;
    let mean = logarithms.iter().sum::<f64>() / count;
    let squares: f64 = logarithms.iter().map(|value| (value - mean).powi(2)).sum();
    let dispersion = (squares / (count - 1.0)).sqrt();
    let numbers = [
        libm::exp(mean),
        dispersion,
        dispersion / MEASURES[measure].2,
    ];
    (logarithms.len() >= LEAST_CAPACITIES).then_some((logarithms.len(), numbers))
}

/// Computes the efficiency of each measure of intensity, the best first, with intervals. Records that do not
/// overturn the structure are ignored. Empty with fewer than three capacities that are no upper bounds: bounds have the order of the levels.
pub fn efficiencies(capacities: &[RecordCapacity<'_>]) -> Vec<Efficiency> {
    let known = |one: &&RecordCapacity<'_>| one.scale.is_some() && !one.at_most;
    if capacities.iter().filter(known).count() < LEAST_CAPACITIES {
        return Vec::new();
    }
    // Draws whole records, because a record and its mirror image are not independent.
    let records: Vec<&[RecordCapacity<'_>]> = capacities
        .chunk_by(|a, b| a.record == b.record)
        .filter(|own| own.iter().any(|capacity| capacity.scale.is_some()))
        .collect();
    let measures = 0..MEASURES.len();
    let drawn: Vec<Vec<Option<f64>>> = bootstrap(records.len())
        .map(|drawn| {
            let of = |measure| {
                let capacities = drawn.iter().flat_map(|record| records[*record]);
                scatter(capacities, measure).map(|(_, [.., of_factor])| of_factor)
            };
            measures.clone().map(of).collect()
        })
        .collect();
    let least = |draw: &[Option<f64>]| draw.iter().flatten().copied().reduce(f64::min);
    let of = |measure: usize| {
        let (count, [median, dispersion, dispersion_of_factor]) =
            scatter(capacities.iter(), measure)?;
        // Both signs of a record count as one value.
        let degrees = records.len() as f64 - 1.0;
        let likeliest = dispersion_of_factor * (degrees.max(0.0) / records.len() as f64).sqrt();
        let best = drawn
            .iter()
            .filter(|draw| draw[measure].is_some() && draw[measure] == least(draw));
        Some(Efficiency {
            measure: MEASURES[measure].0.to_owned(),
            capacities: count,
            median,
            dispersion,
            dispersion_of_factor,
            dispersion_of_factor_interval: dispersion_interval(likeliest, records.len()),
            best_share: best.count() as f64 / drawn.len() as f64,
        })
    };
    let mut all: Vec<Efficiency> = measures.clone().filter_map(of).collect();
    all.sort_by(|a, b| a.dispersion_of_factor.total_cmp(&b.dispersion_of_factor));
    all
}
