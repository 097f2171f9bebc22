//! The suite of records: `[suite]`.
//!
//! ```toml
//! [suite]
//! records = ["records/*.at2", "north.csv"]   # files or patterns of files, relative to the scenario file
//! scales = { from = 0.2, to = 3.0, count = 20, spacing = "logarithmic" }   # or peaks_g
//! both_signs = true                          # every record mirrored as well
//! time_column = 1                            # of the CSV files, as in [ground.record]
//! acceleration_column = 2
//! unit = "cm/s2"
//! ```
//!
//! Every record shakes the structure at every level: multiplied by every factor of `scales`, or scaled to
//! every peak of `peaks_g`. `[ground]` is not used.

use serde::ser::{Serialize, SerializeMap as _, Serializer};

use super::listing::{Listing, layout_keys};
use super::record::{self, Component, Format, Record, Scaling, Series};
use super::relation::Relation;
use super::rule::{Number, OneOrMore, Switch, Text, above, within};
use super::sequence::Sequence;
use super::simulation::Simulation;
use super::table::{Reading, Reported, Table};
use crate::argument::{plain, short};

named! {
    /// The measure of the levels of a suite, named by its key in `[suite]`.
    pub enum Measure {
        /// Factors on the records.
        Scale = "scales",
        /// Peak accelerations to which the records are scaled, in units of gravity.
        PeakG = "peaks_g",
    }
}

/// Largest factor on a record: beyond it the unit must be wrong.
const MAX_SCALE: f64 = 1e6;
const SCALE: Number = above(0.0, MAX_SCALE);

impl Measure {
    /// The range of a single level.
    const fn range(self) -> &'static Number {
        match self {
            Self::Scale => &SCALE,
            Self::PeakG => &record::PEAK_G,
        }
    }

    /// The name of a single level in results.
    #[must_use]
    pub const fn column(self) -> &'static str {
        match self {
            Self::Scale => "scale",
            Self::PeakG => "peak_g",
        }
    }

    const fn scaling(self, level: f64) -> Scaling {
        match self {
            Self::Scale => Scaling::Factor(level),
            Self::PeakG => Scaling::PeakG(level),
        }
    }
}

/// The records of a suite and the levels to which they are scaled.
#[derive(Clone, Debug, PartialEq)]
pub struct Suite {
    /// Unscaled records, sorted by file name; at least one.
    pub records: Vec<Series>,
    /// Intensity measure of the levels.
    pub measure: Measure,
    /// The levels to which each record is scaled, above 0.
    pub levels: Sequence,
    /// Whether every record is also run mirrored, so that it acts to the other side.
    pub both_signs: bool,
    /// The oscillator whose spectral acceleration is one of the measures of intensity.
    pub spectral: Spectral,
}

/// An oscillator with one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectral {
    /// Its period, in s.
    pub period_s: f64,
    /// Its damping, in percent of the critical one.
    pub damping_percent: f64,
}

const SPECTRAL_PERIOD_S: &str = "spectral_period_s";
const SPECTRAL_DAMPING_PERCENT: &str = "spectral_damping_percent";

impl Spectral {
    /// Oscillator of a suite that sets neither key: 1 s, and the 5 % of codes.
    pub(crate) const DEFAULT: Self = Self {
        period_s: 1.0,
        damping_percent: 5.0,
    };

    fn read(table: &mut Table<'_>) -> Self {
        let default = Self::DEFAULT;
        Self {
            period_s: table.or(
                SPECTRAL_PERIOD_S,
                &within(&(0.01..=100.0)),
                default.period_s,
            ),
            damping_percent: table.or(
                SPECTRAL_DAMPING_PERCENT,
                &within(&(0.0..=99.0)),
                default.damping_percent,
            ),
        }
    }
}

/// Largest number of cases of a suite: their rows must fit into memory.
const MAX_CASES: usize = 1_000_000;

impl Suite {
    /// Reads `[suite]` with its records; `None`: `[simulation]` is faulty.
    pub(super) fn read(table: &mut Table<'_>, simulation: Option<&Simulation>) -> Reading<Self> {
        let patterns = table.required(RECORDS, &OneOrMore(&Text));
        let format = Format::read(table);
        let levels = Measure::ALL.iter().filter_map(|&measure| {
            let levels = Sequence::read(table, measure.name(), measure.range());
            levels.map(|levels| (measure, levels))
        });
        let levels: Vec<_> = levels.collect();
        let both_signs = table.or("both_signs", &Switch, true);
        let spectral = Spectral::read(table);
        let related = table.relate(&[Relation::OneOf(&["scales", "peaks_g"], None)]);
        let listing = Listing::read(table, &[(RECORDS, patterns)], format);
        related.and(table.sound())?;
        let (measure, levels) = levels.into_iter().next().ok_or(Reported)?;
        let values = levels.values();
        let cases = listing.len() * (1 + usize::from(both_signs)) * values.len();
        if cases > MAX_CASES {
            return Err(table.wrong_itself(format!(
                "has {cases} cases, {} records at {} levels; at most {MAX_CASES} are allowed",
                listing.len(),
                values.len()
            )));
        }
        let strongest = measure.scaling(values[values.len() - 1]);
        let accept = |series: &Series| suits(series, strongest, simulation);
        let records = listing.series(table, accept)?.into_iter();
        Ok(Self {
            records: records.map(|(_, series)| series).collect(),
            measure,
            levels,
            both_signs,
            spectral,
        })
    }

    /// A record scaled to a level, perhaps mirrored.
    pub(crate) fn shake(&self, record: usize, level: f64, mirrored: bool) -> Record {
        let signed = if mirrored { -level } else { level };
        shaking(&self.records[record], self.measure.scaling(signed))
    }
}

impl Serialize for Suite {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let files: Vec<_> = self.records.iter().map(|series| &series.file).collect();
        map.serialize_entry(RECORDS, &files)?;
        for (key, value) in layout_keys(self.records.iter()) {
            map.serialize_entry(&key, &value)?;
        }
        map.serialize_entry(self.measure.name(), &self.levels)?;
        map.serialize_entry("both_signs", &self.both_signs)?;
        map.serialize_entry(SPECTRAL_PERIOD_S, &self.spectral.period_s)?;
        map.serialize_entry(SPECTRAL_DAMPING_PERCENT, &self.spectral.damping_percent)?;
        map.end()
    }
}

const RECORDS: &str = "records";

/// Checks that a record can be used at the strongest level, or explains why not.
fn suits(
    series: &Series,
    strongest: Scaling,
    simulation: Option<&Simulation>,
) -> Result<(), String> {
    let Some(&Simulation {
        gravity_m_s2,
        duration_s,
        ..
    }) = simulation
    else {
        return Ok(());
    };
    let own_g = series.peak_g(gravity_m_s2);
    if own_g == 0.0 {
        return Err("is zero throughout".to_owned());
    }
    if let Scaling::PeakG(peak_g) = strongest
        && peak_g / own_g > MAX_SCALE
    {
        return Err(format!(
            "has a peak of {} g, which cannot be scaled to {} g: factors are at most {}",
            plain(own_g),
            plain(peak_g),
            short(MAX_SCALE)
        ));
    }
    series.scaled(strongest).check_strength(gravity_m_s2)?;
    let lasts_s = start_s(series) + series.last_s();
    if let Some(duration_s) = duration_s
        && lasts_s > duration_s
    {
        return Err(format!(
            "lasts {} s and would be cut off at {} s; give a longer `duration_s` in [simulation]",
            plain(lasts_s),
            plain(duration_s)
        ));
    }
    Ok(())
}

/// The horizontal ground motion of a record.
pub(super) fn shaking(series: &Series, scaling: Scaling) -> Record {
    Record {
        component: Component::Horizontal,
        main: series.scaled(scaling),
        vertical: None,
        start_s: start_s(series),
    }
}

/// Time in the simulation of the file's time zero; it is chosen so that no record begins before the simulation.
fn start_s(series: &Series) -> f64 {
    (0.0 - series.first_s()).max(0.0)
}
