//! The suite of records: `[suite]`.
//!
//! ```toml
//! [suite]
//! records = ["records/*.at2", "north.csv"]   # files or patterns of files, relative to the scenario file
//! scales = { from = 0.2, to = 3.0, count = 20, spacing = "logarithmic" }   # or peaks_g
//! time_column = 1                            # of the CSV files, as in [ground.record]
//! acceleration_column = 2
//! unit = "cm/s2"
//!
//! [[suite.record]]                           # files with keys of their own; those above are their defaults
//! file = "east.csv"                          # a file or a pattern
//! unit = "g"
//! scale = 2.0                                # or peak_g
//! ```
//!
//! Every record acts on the structure at every level: multiplied by each factor of `scales`, or scaled to each peak of `peaks_g`. Without both,
//! every record acts once, unscaled. `[ground]` is not used.

use std::collections::{BTreeMap, BTreeSet};

use super::change::BOTH_SIGNS;
use super::listing::{RecordListing, table_entries};
use super::prelude::*;
use super::record::{self, Component, Record, Scaling, Series, format};
use super::sequence::Sequence;
use super::simulation::Simulation;
use crate::dynamics::Directions;

named! {
    /// The measure of the levels of a suite, by its name in results.
    pub enum Measure {
        /// Factors on the records.
        Scale = "scale",
        /// Peak accelerations to which the records are scaled, in units of gravity.
        PeakG = "peak_g",
    }
}

/// Largest factor on a record; beyond it the unit is probably wrong.
const MAX_SCALE: f64 = 1e6;
const SCALE: Number = above(0.0, MAX_SCALE);

impl Measure {
    /// Range of a single level.
    const fn range(self) -> &'static Number {
        match self {
            Self::Scale => &SCALE,
            Self::PeakG => &record::PEAK_G,
        }
    }

    /// Key of the levels in `[suite]`.
    const fn key(self) -> &'static str {
        match self {
            Self::Scale => "scales",
            Self::PeakG => "peaks_g",
        }
    }

    /// Unit that follows a level in words.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Scale => "",
            Self::PeakG => " g",
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
    /// Records, each with its own scaling: those of the key `records`, sorted by file name, then those of the entries. At least one.
    pub records: Vec<Series>,
    /// True if some of the records have entries `[[suite.record]]`.
    pub has_entries: bool,
    /// Intensity measure of the levels.
    pub measure: Measure,
    /// The levels to which each record is scaled, above 0; `None`: each record acts once, unscaled.
    pub levels: Option<Sequence>,
    /// The oscillator whose spectral acceleration is a measure of intensity.
    pub spectral: Spectral,
}

/// An oscillator with one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Spectral {
    /// Period of the oscillator, in s.
    pub period_s: f64,
    /// Damping of the oscillator, in percent of critical damping.
    pub damping_percent: f64,
}

const SPECTRAL_PERIOD_S: &str = "spectral_period_s";
const PERIOD_S: Number = within(&(0.01..=100.0));
const DAMPING: Number = within(&(0.0..=99.0));
const SPECTRAL_DAMPING_PERCENT: &str = "spectral_damping_percent";

impl Spectral {
    /// Default oscillator: 1 s, and 5 % damping as in codes.
    pub(crate) const DEFAULT: Self = Self {
        period_s: 1.0,
        damping_percent: 5.0,
    };

    fn read(table: &mut Table<'_>) -> Self {
        let default = Self::DEFAULT;
        Self {
            period_s: table.or(SPECTRAL_PERIOD_S, &PERIOD_S, default.period_s),
            damping_percent: table.or(SPECTRAL_DAMPING_PERCENT, &DAMPING, default.damping_percent),
        }
    }
}

/// Largest number of cases of a suite: their rows must fit into memory.
const MAX_CASES: usize = 1_000_000;

impl Suite {
    /// Reads `[suite]` with its records. Also returns the directions that `both_signs` names. `simulation` is `None` if `[simulation]` is faulty.
    pub(super) fn read(
        table: &mut Table<'_>,
        simulation: Option<&Simulation>,
    ) -> ReadResult<(Self, Option<Directions>)> {
        let patterns = table.optional(RECORDS, &one_or_more(&text()));
        let format = format::read(table);
        let levels = Measure::ALL.iter().filter_map(|&measure| {
            let levels = Sequence::read(table, measure.key(), measure.range())?;
            Some((measure, levels))
        });
        let levels: Vec<_> = levels.collect();
        let named = table.optional(BOTH_SIGNS, &switch()).map(directions_of);
        let spectral = Spectral::read(table);
        let strongest = levels.first().and_then(|(measure, levels)| {
            let level = levels.values().last().copied();
            level.map(|level| measure.scaling(level))
        });
        let accept = |series: &Series| match simulation {
            Some(simulation) => check_record(
                series,
                strongest.unwrap_or(Scaling::Factor(1.0)),
                simulation,
            ),
            None => Ok(()),
        };
        let entry = |entry: &mut Table<'_>| read_entry(entry, strongest, accept);
        let entries = table.tables(ENTRIES, entry).concat();
        let related = table.apply_relations(&[
            SomeOf(
                &[RECORDS, ENTRIES],
                Some("lacks `records`: give a string or an array of at least one, or entries [[suite.record]]"),
            ),
            AtMostOne(&["scales", "peaks_g"], GIVE_ONE),
        ]);
        let patterns: Vec<_> = patterns.map(|found| (RECORDS, found)).into_iter().collect();
        let listing = RecordListing::read(table, &patterns, format, &entries);
        related.and(table.check_faultless())?;
        let (measure, levels) = levels.into_iter().next().unzip();
        let measure = measure.unwrap_or(Measure::Scale);
        let count = level_values(levels.as_ref()).len();
        let files = listing.len() + entries.len();
        let directions = named.or(simulation.map(|simulation| simulation.direction));
        let signs = 1 + usize::from(directions == Some(Directions::Both));
        let cases = files * signs * count;
        let wrong = format!(
            "has {cases} cases, {files} records at {count} levels; at most {MAX_CASES} are allowed"
        );
        table.refuse_all(cases > MAX_CASES, wrong)?;
        table.refuse_all(files == 0, "has no records")?;
        listing.refuse_without_effect(table)?;
        let has_entries = !entries.is_empty();
        let listed = listing.series(table, accept)?;
        let count = listed.len();
        let listed = listed.into_iter().map(|(_, series)| series);
        let mut records: Vec<_> = listed.chain(entries).collect();
        let twice = name_apart(&mut records).map_or(String::new(), |name| {
            format!("reads {name} twice; leave an entry out, or give each its `channel` or `acceleration_column`")
        });
        table.refuse_all(!twice.is_empty(), twice)?;
        let duration_s = simulation.and_then(|simulation| simulation.duration_s);
        let (listed, entries) = records.split_at(count);
        if let Some(wrong) = cut_off(listed, duration_s) {
            table.reject(RECORDS, wrong);
        }
        if let Some(wrong) = cut_off(entries, duration_s) {
            table.fault_of_table(wrong);
        }
        table.check_faultless()?;
        let suite = Self {
            records,
            has_entries,
            measure,
            levels,
            spectral,
        };
        Ok((suite, named))
    }

    /// Levels of the cases, in the measure of the suite.
    pub fn level_values(&self) -> Vec<f64> {
        level_values(self.levels.as_ref())
    }

    /// Each record with a peak of 1 g, as the ground motion of a scenario.
    pub(crate) fn unit_grounds(&self, gravity_m_s2: f64) -> Vec<UnitGround> {
        let records = self.records.iter();
        let unit = records.map(|series| {
            let unscaled = series.scaled(Scaling::Factor(1.0));
            let to_unit = Scaling::Factor(1.0 / unscaled.peak_g(gravity_m_s2));
            let record = scaled_record(&unscaled, to_unit);
            let (key, value) = record.main.scaling.key_and_value();
            UnitGround {
                record: series.name.clone(),
                key: format!("ground.record.{key}"),
                value,
                ground: super::given(json!({ "record": record })),
            }
        });
        unit.collect()
    }

    /// Record scaled to a level.
    pub(crate) fn record_at(&self, record: usize, level: f64) -> Record {
        scaled_record(&self.records[record], self.measure.scaling(level))
    }
}

/// A record with a peak of 1 g, as the ground motion of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub(crate) struct UnitGround {
    /// Name of the record.
    pub(crate) record: String,
    /// The key of its scaling.
    pub(crate) key: String,
    /// The value of that key.
    pub(crate) value: f64,
    /// The table `[ground]`.
    pub(crate) ground: Value,
}

impl Serialize for Suite {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let records = match self.has_entries {
            true => Map::from_iter([(ENTRIES.to_owned(), json!(self.records))]),
            false => table_entries(&[(RECORDS, &self.records)]),
        };
        let levels = self.levels.iter();
        let levels = levels.map(|levels| (self.measure.key().to_owned(), json!(levels)));
        let own = [
            (SPECTRAL_PERIOD_S, json!(self.spectral.period_s)),
            (
                SPECTRAL_DAMPING_PERCENT,
                json!(self.spectral.damping_percent),
            ),
        ]
        .map(|(key, value)| (key.to_owned(), value));
        serializer.collect_map(records.into_iter().chain(levels).chain(own))
    }
}

/// Levels of the cases; 1 without levels.
fn level_values(levels: Option<&Sequence>) -> Vec<f64> {
    levels.map_or_else(|| vec![1.0], Sequence::values)
}

/// Directions that `both_signs` names.
const fn directions_of(both_signs: bool) -> Directions {
    match both_signs {
        true => Directions::Both,
        false => Directions::AsGiven,
    }
}

impl Suite {
    /// Returns the directions of the ground motion that the suite chooses: those of `both_signs` (`named`), or as given if it has no levels. `None` leaves
    /// those of `[simulation]` (`own`). Rejects `both_signs` if `[simulation]` gives other directions.
    pub(super) fn directions(
        &self,
        table: &mut Table<'_>,
        own: Directions,
        named: Option<Directions>,
    ) -> ReadResult<Option<Directions>> {
        let is_given = table.has_key_in("simulation", "direction");
        match named {
            Some(named) if own != named && is_given => {
                let (own, named) = (own.name(), named.name());
                let wrong = format!(
                    "is `direction = \"{named}\"` of [simulation] by an older name, and [simulation] gives \"{own}\"; leave `both_signs` out"
                );
                Err(table.reject_in(&["suite"], BOTH_SIGNS, wrong))
            }
            Some(named) => Ok(Some(named)),
            None if self.levels.is_none() && !is_given => Ok(Some(Directions::AsGiven)),
            None => Ok(None),
        }
    }
}

const RECORDS: &str = "records";
const ENTRIES: &str = "record";

/// Reads the records of an entry `[[suite.record]]`.
fn read_entry(
    table: &mut Table<'_>,
    strongest: Option<Scaling>,
    accept: impl Fn(&Series) -> Result<(), String>,
) -> ReadResult<Vec<Series>> {
    let listing = RecordListing::of_entry(table);
    let scaling = Scaling::read(table)?;
    let is_replaced = matches!(strongest, Some(Scaling::PeakG(_)));
    let key = match table.has_key("scale") {
        true => "scale",
        false => "peak_g",
    };
    let wrong = "has no effect beside `peaks_g`, which replaces the peak; leave it out";
    table.refuse(is_replaced && scaling != Scaling::Factor(1.0), key, wrong)?;
    let wrong = "scales all accelerations to zero; must be another number";
    table.refuse(scaling == Scaling::Factor(0.0), "scale", wrong)?;
    table.check_faultless()?;
    let scaled = |series: &Series| accept(&series.scaled(scaling));
    let records = listing.series(table, scaled)?.into_iter();
    Ok(records.map(|(_, series)| series.scaled(scaling)).collect())
}

/// Adds channel or column to the names of records that share their file. Returns a name that two records still share.
fn name_apart(records: &mut [Series]) -> Option<String> {
    let mut shares: BTreeMap<String, usize> = BTreeMap::new();
    for series in &*records {
        *shares.entry(series.file.clone()).or_default() += 1;
    }
    let mut names = BTreeSet::new();
    for series in records {
        let (channel, column) = (&series.layout.channel, &series.layout.acceleration_column);
        if let Some(column) = channel.as_ref().or(column.as_ref())
            && shares[&series.file] > 1
        {
            series.name = format!("{} {column}", series.file);
        }
        if !names.insert(&series.name) {
            return Some(series.name());
        }
    }
    None
}

/// Checks that a record can be used at the strongest level; the error is the reason if not.
fn check_record(
    series: &Series,
    strongest: Scaling,
    simulation: &Simulation,
) -> Result<(), String> {
    let own_g = series.peak_g(simulation.gravity_m_s2);
    series.check_not_zero(simulation.gravity_m_s2)?;
    if let Scaling::PeakG(peak_g) = strongest {
        ensure(peak_g / own_g <= MAX_SCALE, || {
            let (own, peak, most) = (plain(own_g), plain(peak_g), short(MAX_SCALE));
            format!(
                "has a peak of {own} g, which cannot be scaled to {peak} g: factors are at most {most}"
            )
        })?;
    }
    let strongest = series.scaled(strongest.after(series.scaling));
    strongest.check_strength(simulation.gravity_m_s2)
}

/// Error that lists the records longer than the given duration; `None` if there are none.
fn cut_off(records: &[Series], duration_s: Option<f64>) -> Option<String> {
    let end_s = |series: &Series| start_s(series) + series.last_s();
    let duration_s = duration_s?;
    let cut: Vec<_> = records
        .iter()
        .filter(|series| end_s(series) > duration_s)
        .collect();
    let longest_s = cut.iter().map(|series| end_s(series)).reduce(f64::max)?;
    let listed = cut
        .iter()
        .map(|series| format!("{} ({} s)", series.name(), plain(end_s(series))));
    let names = if cut.len() == 1 {
        "a record that lasts"
    } else {
        "records that last"
    };
    Some(format!(
        "has {names} longer than `duration_s` and would be cut off at {} s: {}; give at least {} s in [simulation], or leave it out",
        plain(duration_s),
        listed.collect::<Vec<_>>().join(", "),
        plain(longest_s)
    ))
}

/// Horizontal ground motion of a record.
pub(super) fn scaled_record(series: &Series, scaling: Scaling) -> Record {
    Record {
        component: Component::Horizontal,
        main: series.scaled(scaling.after(series.scaling)),
        vertical: None,
        start_s: start_s(series),
    }
}

/// Time of the simulation at time zero of the file: no record begins before the simulation.
fn start_s(series: &Series) -> f64 {
    (0.0 - series.first_s()).max(0.0)
}
