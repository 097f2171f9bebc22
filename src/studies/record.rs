//! The report on a record of ground motion: its peaks and intensities.

use askama::Template;
use serde::{Deserialize, Serialize};

use super::results::PrintedResult;
use crate::dynamics::Intensity;
use crate::output::{OutputError, filters};
use crate::scenario::{Baseline, RecordedQuantity, Series, Unit, shown};

/// Report on a record. Velocity and displacement are integrated from zero.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/record.txt")]
pub struct RecordSummary {
    /// Name of the file.
    file: String,
    /// Format, quantity and unit, in words.
    format: String,
    /// Number of samples and their interval, in words.
    sampling: String,
    /// Number of the channel from 1; null for formats without channels.
    channel: Option<usize>,
    /// Name of the channel; null for formats without channels.
    channel_name: Option<String>,
    /// Quantity of the samples.
    quantity: RecordedQuantity,
    /// Unit of the samples in the file.
    unit: Unit,
    /// Number of samples.
    samples: usize,
    /// Time between samples, in seconds; null if it is not constant.
    dt_s: Option<f64>,
    /// Time from the first to the last sample, in seconds.
    duration_s: f64,
    /// Gravity, in m/s2.
    gravity_m_s2: f64,
    /// Peak acceleration, in m/s2.
    peak_acceleration_m_s2: f64,
    /// Time of the peak acceleration, in seconds.
    peak_acceleration_time_s: f64,
    /// Mean acceleration, in units of gravity.
    mean_acceleration_g: f64,
    /// True if the mean was removed, alone or with a line.
    mean_removed: bool,
    /// Baseline that was subtracted: `mean` or `linear`; null without one.
    baseline: Option<Baseline>,
    /// Corner of the high-pass filter in Hz; null without a filter.
    high_pass_hz: Option<f64>,
    /// The corrections in words; empty without one.
    corrections: String,
    /// Peak velocity, in m/s.
    peak_velocity_m_s: f64,
    /// Time of the peak velocity, in seconds.
    peak_velocity_time_s: f64,
    /// Peak displacement, in metres.
    peak_displacement_m: f64,
    /// Time of the peak displacement, in seconds.
    peak_displacement_time_s: f64,
    /// Arias intensity, in m/s.
    arias_intensity_m_s: f64,
    /// Start of the significant duration, which has 5 to 95 % of the Arias intensity, in seconds.
    significant_from_s: f64,
    /// End of the significant duration, in seconds.
    significant_to_s: f64,
}

/// Makes the report on a record with these intensities.
///
/// # Errors
/// When a number is not finite.
pub fn record(
    series: &Series,
    intensity: &Intensity,
    gravity_m_s2: f64,
) -> Result<PrintedResult, OutputError> {
    let [significant_from_s, significant_to_s] = intensity.significant_s;
    let sampling = series.sampling();
    let (channel, channel_name) = series.channel.clone().unzip();
    PrintedResult::of(&RecordSummary {
        file: shown(&series.file),
        format: format(series),
        sampling: sampling.to_string(),
        channel,
        channel_name,
        quantity: series.layout.quantity,
        unit: series.unit,
        samples: sampling.count,
        dt_s: sampling.step_s.map(without_error),
        duration_s: sampling.duration_s,
        gravity_m_s2,
        peak_acceleration_m_s2: intensity.acceleration_m_s2.value,
        peak_acceleration_time_s: intensity.acceleration_m_s2.time_s,
        mean_acceleration_g: series.mean_g(gravity_m_s2),
        mean_removed: series.layout.baseline.is_some(),
        baseline: series.layout.baseline,
        high_pass_hz: series.layout.high_pass_hz,
        corrections: series.corrections(),
        peak_velocity_m_s: intensity.velocity_m_s.value,
        peak_velocity_time_s: intensity.velocity_m_s.time_s,
        peak_displacement_m: intensity.displacement_m.value,
        peak_displacement_time_s: intensity.displacement_m.time_s,
        arias_intensity_m_s: intensity.arias_m_s,
        significant_from_s,
        significant_to_s,
    })
}

/// Step without the rounding error of a mean: the time over the number of steps.
fn without_error(step_s: f64) -> f64 {
    format!("{step_s:.11e}").parse().unwrap_or(step_s)
}

/// Format and unit of a record, in words.
fn format(series: &Series) -> String {
    let format = match series.layout.wrapped {
        true => "table with several samples a row",
        false => series.layout.format.label(),
    };
    let quantity = match series.layout.quantity {
        RecordedQuantity::Acceleration => "accelerations",
        RecordedQuantity::Velocity => "velocities",
    };
    let (unit, columns) = (series.unit.name(), &series.columns);
    format!("{format}, {quantity} in {unit}{columns}")
}
