//! Ground motion from files: `[ground.record]`.
//!
//! ```toml
//! [ground.record]
//! file = "north.at2"            # relative to the scenario file
//! format = "at2"                # or another one; from the contents or the extension of the file when left out
//! channel = 1                   # number or name of the channel, of files with several
//! quantity = "acceleration"     # or "velocity": quantity of the samples
//! baseline = "mean"             # or "linear": baseline that is subtracted from accelerations; none when left out
//! high_pass_hz = 0.1            # corner of a high-pass filter; none when left out
//! component = "horizontal"      # or "vertical": direction of the accelerations, positive to the
//!                               # right or upwards
//! scale = 1.0                   # or peak_g = 0.5, the peak to scale to
//! start_s = 0.0                 # time of the simulation at the file's time zero
//!
//! [ground.record.vertical]      # optional second record, scaled on its own, on the same clock
//! file = "up.csv"
//! time_column = 1               # of tables: number or name of the column
//! acceleration_column = "up"
//! unit = "cm/s2"                # of tables, and required there: "g", "m/s2" or "cm/s2"; "m/s" or "cm/s" of velocities
//! ```
//!
//! [`Layout`] describes the files. Straight lines join the samples, so the acceleration of a record of velocities is constant between samples.
//! Before the first sample and after the last one the acceleration is zero. Units of gravity are those of the simulation, `gravity_m_s2`.

pub(super) mod format;
pub(super) mod layout;

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

pub use archrock_records::{
    Baseline, Contents, Decimal, Format, Layout, LineFault, RecordedQuantity, Sampling,
    TableColumn, Times, Unit,
};
use archrock_records::{MAX_TIME_S, mean, numbers};

use super::assignment::Assignment;
use super::error::ScenarioErrors;
use super::files::Files;
use super::prelude::*;
use super::table;
use crate::GroundMotion;
pub use format::{format_of_file, unknown_format};
pub use layout::describes_tables;

/// Rounding error of the time at which a record begins, in s; shorter than any step.
const ROUNDING_S: f64 = 1e-9;
/// Largest acceleration of the ground, in g; beyond it the unit is probably wrong.
pub(crate) const MAX_ACCELERATION_G: f64 = 1e3;
pub(super) const SCALE: Number = within(&(-1e6..=1e6));
pub(super) const PEAK_G: Number = above(0.0, MAX_ACCELERATION_G);
const START_S: Number = within(&(0.0..=MAX_TIME_S));

named! {
    /// The direction of the accelerations of a record.
    pub enum Component {
        /// To the right.
        Horizontal = "horizontal",
        /// Upwards.
        Vertical = "vertical",
    }
}

/// The factor by which the accelerations of a file are multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Scaling {
    /// A given factor.
    #[serde(rename = "scale")]
    Factor(f64),
    /// The positive factor that scales the peak to this value, in units of gravity.
    #[serde(rename = "peak_g")]
    PeakG(f64),
}

impl Scaling {
    /// Reads the keys of a scaling; the default is the factor 1.
    pub(super) fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let scale = table.optional("scale", &SCALE);
        let peak_g = table.optional("peak_g", &PEAK_G);
        let at_most = "give at most one of them";
        table.apply_relations(&[AtMostOne(&["scale", "peak_g"], at_most)])?;
        Ok(peak_g.map_or(Self::Factor(scale.unwrap_or(1.0)), Self::PeakG))
    }

    /// Returns the scaling of accelerations that are multiplied by a factor.
    fn times(self, factor: f64) -> Self {
        Self::Factor(factor).after(self)
    }

    /// Returns its key, and the value.
    pub(crate) const fn key_and_value(self) -> (&'static str, f64) {
        match self {
            Self::Factor(factor) => ("scale", factor),
            Self::PeakG(peak_g) => ("peak_g", peak_g),
        }
    }

    /// Returns the scaling by `first` and then by this one. A factor multiplies `first`, and a peak replaces it.
    pub(super) fn after(self, first: Self) -> Self {
        match (self, first) {
            (Self::Factor(factor), Self::Factor(first)) => Self::Factor(factor * first),
            (Self::Factor(factor), Self::PeakG(peak_g)) => Self::PeakG(factor * peak_g),
            (Self::PeakG(_), _) => self,
        }
    }
}

/// A motion in one direction, from a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Name of the file, relative to the scenario file.
    pub file: String,
    /// Name of the record in results: its file, in suites also its channel or column if several records are from this file.
    #[serde(skip)]
    pub name: String,
    /// Layout of the file.
    #[serde(flatten)]
    pub layout: Layout,
    /// Scaling of the samples.
    #[serde(flatten)]
    pub scaling: Scaling,
    /// Unit of the samples in the file.
    #[serde(skip)]
    pub unit: Unit,
    /// The columns of a table or the channel of a file, in words that follow the unit; empty without a choice.
    #[serde(skip)]
    pub columns: String,
    /// True if the file states the unit: its header, or the name of the column.
    #[serde(skip)]
    pub states_unit: bool,
    /// Number from 1 and name of the channel, of formats with channels.
    #[serde(skip)]
    pub channel: Option<(usize, String)>,
    /// Differences between header and samples and doubtful samples, as a phrase that follows the name of the file.
    #[serde(skip)]
    pub difference: Option<String>,
    /// Ascending times in s, and accelerations or velocities in the unit of the file, corrected as the layout demands.
    #[serde(skip)]
    pub samples: Arc<[(f64, f64)]>,
}

/// Ground motion from one or two files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// The only record, or the horizontal one of two.
    #[serde(flatten)]
    pub main: Series,
    /// The direction of the accelerations of `main`.
    pub component: Component,
    /// Time of the simulation at time zero of the files in s, from 0 to 1e6.
    pub start_s: f64,
    /// The record of the vertical component; `None` without one, or if `main` is vertical.
    pub vertical: Option<Series>,
}

impl Record {
    /// Returns the records, the horizontal one first.
    pub fn series(&self) -> impl Iterator<Item = &Series> {
        [&self.main].into_iter().chain(&self.vertical)
    }

    /// Returns keys and values of its table that multiply all accelerations by a factor.
    pub(super) fn values_times(&self, table: &str, factor: f64) -> Vec<(String, f64)> {
        let vertical = self.vertical.as_ref();
        let vertical = vertical.map(|series| (format!("{table}.vertical"), series));
        let all = [(table.to_owned(), &self.main)].into_iter().chain(vertical);
        let value = |(table, series): (String, &Series)| {
            let (key, value) = series.scaling.times(factor).key_and_value();
            (format!("{table}.{key}"), value)
        };
        all.map(value).collect()
    }

    /// Returns the ground motion with another scaling of the main record; the vertical record is unchanged.
    pub(crate) fn rescaled(
        &self,
        scaling: Scaling,
        gravity_m_s2: f64,
    ) -> Result<GroundMotion, String> {
        ensure(self.main.peak() != 0.0, || "the record is zero throughout")?;
        let rescaled = Self {
            main: self.main.scaled(scaling),
            ..self.clone()
        };
        rescaled.main.check_strength(gravity_m_s2)?;
        Ok(rescaled.ground_motion(gravity_m_s2))
    }

    /// Returns the time at which the last record ends, in s.
    pub(super) fn end_s(&self) -> f64 {
        let ends = self.series().map(Series::last_s);
        self.start_s + ends.fold(0.0, f64::max)
    }

    /// Returns the ground motion under a gravity in m/s2.
    pub(crate) fn ground_motion(&self, gravity_m_s2: f64) -> GroundMotion {
        let [main, vertical] = [Some(&self.main), self.vertical.as_ref()]
            .map(|series| series.map_or_else(Vec::new, |it| it.accelerations_m_s2(gravity_m_s2)));
        let start_s = self.exact_start_s();
        match self.component {
            Component::Vertical => GroundMotion::polylines(&[], &main, start_s),
            Component::Horizontal => GroundMotion::polylines(&main, &vertical, start_s),
        }
    }

    /// Returns the time of the file's time zero, without the rounding error of a record that begins at time zero.
    fn exact_start_s(&self) -> f64 {
        let first_s = self
            .series()
            .map(Series::first_s)
            .fold(f64::INFINITY, f64::min);
        match (-ROUNDING_S..0.0).contains(&(self.start_s + first_s)) {
            true => -first_s,
            false => self.start_s,
        }
    }

    /// Reads `[ground.record]` and makes the motion.
    pub(super) fn read(
        table: &mut Table<'_>,
        known: KnownRecords<'_>,
    ) -> ReadResult<(Self, GroundMotion)> {
        let component = table.or("component", &one_of(Component::ALL), Component::Horizontal);
        let start_s = table.or("start_s", &START_S, 0.0);
        let main = Series::read(table, known, start_s);
        let vertical = table.table("vertical", |table| Series::read(table, known, start_s));
        let is_second = component == Component::Vertical && table.has_key("vertical");
        let wrong =
            "cannot be combined with `component = \"vertical\"`; give one record per direction";
        table.refuse(is_second, "vertical", wrong)?;
        table.check_faultless()?;
        let gravity_m_s2 = known.1.ok_or(FaultRecorded)?;
        let record = Self {
            main: main?,
            component,
            start_s,
            vertical,
        };
        let motion = record.ground_motion(gravity_m_s2);
        if let Some(time_s) = motion.free_fall_s(gravity_m_s2).filter(|_| !known.2) {
            let inside: &[_] = record.vertical.as_ref().map_or(&[], |_| &["vertical"]);
            return Err(table.reject_in(inside, "file", free_fall(time_s)));
        }
        Ok((record, motion))
    }
}

/// Input for reading the ground motion: records already in memory, gravity if `[simulation]` gives a valid value, and whether the ground may fall
/// freely, for static analysis.
pub(super) type KnownRecords<'a> = (&'a [Series], Option<f64>, bool);

impl Series {
    /// Reads the unscaled samples of a file. The error is a phrase that follows the name of the file.
    pub(super) fn of_file(files: &Files, file: String, layout: Layout) -> Result<Self, String> {
        let path = files.path(&file);
        let samples = files.samples(&path);
        let contents = match samples.and_then(|samples| layout.parse_samples(samples)) {
            Some(contents) => contents.map_err(|LineFault { line, message }| {
                format!("is faulty: sample {line}: {message}")
            }),
            None => {
                let contents = layout.parse(&files.read(&path)?);
                contents.map_err(|fault| faulty(&path, &fault))
            }
        };
        contents.map(|contents| Self::new(file, layout, contents))
    }

    fn new(file: String, layout: Layout, contents: Contents) -> Self {
        Self {
            name: file.clone(),
            file,
            layout,
            scaling: Scaling::Factor(1.0),
            unit: contents.unit,
            columns: contents.columns,
            states_unit: contents.states_unit,
            channel: contents.channel,
            difference: contents.difference,
            samples: contents.samples.into(),
        }
    }

    /// Reads a file without a scenario, with the keys of `[ground.record]` that describe it. Returns all channels of the file unless one is chosen.
    ///
    /// # Errors
    /// All faults of the keys, or the fault of the file. Each has the assignment or the file, without a line.
    pub fn read_file(path: &Path, keys: &[Assignment]) -> Result<Vec<Self>, ScenarioErrors> {
        let name = path.display().to_string();
        let layout = table::read_text(("", &Files::default()), keys, |table| {
            table.rename("the record");
            let format = format::read_or_ending(table, &name);
            Ok(layout::read(table, format.as_slice()))
        })
        .map_err(|faults| ScenarioErrors::placed(("", &name), keys, faults).without_places())?;
        let bytes = Files::default().read(path);
        let bytes = bytes.map_err(|wrong| ScenarioErrors::unreadable(&name, wrong))?;
        let read = |layouts: Vec<Layout>| {
            let count = layouts.len();
            let series = layouts.into_iter().zip(1..).map(|(layout, number)| {
                let contents = layout.parse(&bytes)?;
                let mut series = Self::new(name.clone(), layout, contents);
                if count > 1 {
                    series.name = format!("{name}, channel {number}");
                }
                Ok(series)
            });
            series.collect()
        };
        let series: Result<Vec<Self>, LineFault> = layout.by_channel(&bytes).and_then(read);
        series.map_err(|fault| {
            ScenarioErrors::unreadable(&format!("{name}:{}", fault.line), fault.message)
        })
    }

    /// Returns the name of the record, with hidden characters escaped.
    pub fn name(&self) -> String {
        shown(&self.name)
    }

    /// Returns the file with the channel that was read, of formats with channels; else the name.
    pub(crate) fn label(&self) -> String {
        match &self.channel {
            Some((number, name)) => shown(&format!("{}, channel {number} `{name}`", self.file)),
            None => self.name(),
        }
    }

    /// Returns this record with another scaling.
    pub(super) fn scaled(&self, scaling: Scaling) -> Self {
        Self {
            scaling,
            ..self.clone()
        }
    }

    /// Returns the corrections of the samples in words, each after a comma; empty without a correction.
    pub fn corrections(&self) -> String {
        let baseline = match self.layout.baseline {
            Some(Baseline::Mean) => ", mean subtracted",
            Some(Baseline::Linear) => ", line of least squares subtracted",
            None => "",
        };
        let filter = self.layout.high_pass_hz.map(plain);
        let filter = filter.map(|corner| format!(", high-pass filter at {corner} Hz"));
        baseline.to_owned() + &filter.unwrap_or_default()
    }

    /// Computes a checksum of the samples. Files with the same samples in different formats have the same checksum.
    pub fn checksum(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        for (time_s, acceleration) in self.samples.iter() {
            hasher.update(&time_s.to_le_bytes());
            hasher.update(&acceleration.to_le_bytes());
        }
        hasher.finalize()
    }

    /// Returns number and spacing of the samples.
    pub fn sampling(&self) -> Sampling {
        Sampling::of(&self.samples)
    }

    /// Returns the largest magnitude after scaling, in units of gravity.
    pub fn peak_g(&self, gravity_m_s2: f64) -> f64 {
        (self.peak() * self.factor(gravity_m_s2) / gravity_m_s2).abs()
    }

    /// Returns an error for a record without accelerations.
    pub(super) fn check_not_zero(&self, gravity_m_s2: f64) -> Result<(), String> {
        let is_zero = self.peak() == 0.0 || self.peak_g(gravity_m_s2) == 0.0;
        ensure(!is_zero, || "is zero throughout".to_owned())
    }

    /// Returns an error for accelerations that are too large for any ground.
    pub(super) fn check_strength(&self, gravity_m_s2: f64) -> Result<(), String> {
        let peak_g = self.peak_g(gravity_m_s2);
        ensure(peak_g <= MAX_ACCELERATION_G, || {
            let (peak, most) = (plain(peak_g), short(MAX_ACCELERATION_G));
            format!("reaches {peak} g as scaled; must be at most {most} g")
        })
    }

    /// Returns the time of the first sample in s, on the clock of the file.
    pub(super) fn first_s(&self) -> f64 {
        self.samples.first().map_or(0.0, |sample| sample.0)
    }

    /// Returns the time of the last sample in s, on the clock of the file.
    pub(super) fn last_s(&self) -> f64 {
        self.samples.last().map_or(0.0, |sample| sample.0)
    }

    /// Returns times in s, on the clock of the file, and scaled accelerations in m/s2, joined by straight lines. A jump has two points at the
    /// same time.
    pub fn accelerations_m_s2(&self, gravity_m_s2: f64) -> Vec<(f64, f64)> {
        let factor = self.factor(gravity_m_s2);
        let scaled = |&(time_s, acceleration): &(f64, f64)| (time_s, acceleration * factor);
        self.accelerations().iter().map(scaled).collect()
    }

    /// Returns the unscaled accelerations in the unit of the file; for velocities, in that unit per second.
    fn accelerations(&self) -> Cow<'_, [(f64, f64)]> {
        match self.unit.quantity() {
            RecordedQuantity::Acceleration => Cow::Borrowed(&*self.samples),
            RecordedQuantity::Velocity => {
                let constants = self.samples.windows(2).flat_map(|pair| {
                    let [(from_s, from), (to_s, to)] = [pair[0], pair[1]];
                    let acceleration = (to - from) / (to_s - from_s);
                    [(from_s, acceleration), (to_s, acceleration)]
                });
                Cow::Owned(constants.collect())
            }
        }
    }

    /// Returns the factor that converts an acceleration in the unit of the file to a scaled one in m/s2.
    fn factor(&self, gravity_m_s2: f64) -> f64 {
        match self.scaling {
            Scaling::Factor(factor) => factor * self.unit.in_si(gravity_m_s2),
            Scaling::PeakG(peak_g) => peak_g * gravity_m_s2 / self.peak(),
        }
    }

    /// Returns the largest magnitude of the acceleration, in the unit of the file.
    fn peak(&self) -> f64 {
        let accelerations = self.accelerations();
        accelerations.iter().map(|s| s.1.abs()).fold(0.0, f64::max)
    }

    /// Returns the mean of the scaled accelerations over the time of the record, in units of gravity.
    pub fn mean_g(&self, gravity_m_s2: f64) -> f64 {
        mean(&self.accelerations()) * self.factor(gravity_m_s2) / gravity_m_s2
    }

    fn read(table: &mut Table<'_>, known: KnownRecords<'_>, start_s: f64) -> ReadResult<Self> {
        let (known, gravity_m_s2, _) = known;
        let file = table.read_required("file", &text());
        let format = format::read_or_ending(table, &file);
        let scaling = Scaling::read(table);
        let layout = layout::read(table, format.as_slice());
        let scaling = scaling?;
        table.check_faultless()?;
        let mut known = known.iter();
        let series = match known.find(|known| known.file == file && known.layout == layout) {
            Some(known) => known.clone(),
            None => Self::of_file(table.files(), file, layout)
                .map_err(|wrong| table.reject_file("file", wrong))?,
        };
        let series = series.scaled(scaling);
        series.check(table, start_s, gravity_m_s2.ok_or(FaultRecorded)?)?;
        Ok(series)
    }

    /// Checks that the record is a possible motion of the ground.
    fn check(&self, table: &mut Table<'_>, start_s: f64, gravity_m_s2: f64) -> ReadResult<()> {
        let is_zero = matches!(self.scaling, Scaling::PeakG(_)) && self.peak() == 0.0;
        let wrong = "cannot be reached: the record is zero throughout";
        table.refuse(is_zero, "peak_g", wrong)?;
        table.accept("file", self.check_strength(gravity_m_s2))?;
        let first_s = self.first_s();
        let wrong = format!(
            "begins at {} s; allowed is a `start_s` of at least {}, so that it does not begin before time zero",
            short(first_s),
            short(-first_s)
        );
        table.refuse(start_s + first_s < -ROUNDING_S, "file", wrong)
    }
}

/// Reads rows of `N` numbers from a file, each with its line. The first row may contain names.
pub(super) fn read_numbers<const N: usize>(
    files: &Files,
    path: &Path,
    decimal: Decimal,
) -> Result<Vec<(usize, [f64; N])>, String> {
    numbers(&files.read(path)?, decimal).map_err(|fault| faulty(path, &fault))
}

/// Returns the message about a wrong line of a file.
pub(super) fn faulty(path: &Path, fault: &LineFault) -> String {
    let path = shown(&path.display().to_string());
    format!("is faulty: {path}:{fault}")
}

/// Returns the message that the ground falls freely at this time, which is impossible for a structure that rests on it.
pub(super) fn free_fall(time_s: f64) -> String {
    format!(
        "makes the ground fall as fast as a free body at {} s, where it no longer carries the \
         structure; vertical accelerations must stay above -1 g",
        plain(time_s)
    )
}
