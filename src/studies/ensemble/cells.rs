//! What becomes of every cell of a map in every sample: the probability of overturning in place of an outcome.

mod told;

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};

use super::{NoAnswer, SampleRow, Told, uncertain};
use crate::dynamics::history::Outcome;
use crate::output::OutputError;
use crate::scenario::{Axis, Quantity, Scenario, Spacing, Uncertain, UncertainKey};
use crate::studies::ending::Ending;
use crate::studies::map::{CellResult, OverturningMap};
use crate::studies::results::{Look, Reported, Results};
use crate::studies::runner::Study;
use crate::studies::statistics::Share;

/// What became of a cell of a sample.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Came {
    /// It certainly overturned.
    Overturned,
    /// Whether it overturned is uncertain.
    Uncertain,
    /// It came to rest.
    Rest,
    /// It never moved.
    NeverMoved,
    /// Its elastic joints vibrated without opening.
    Vibrates,
    /// It had not come to rest at the end.
    StillRocking,
    /// It makes no structure that stands, or none of four links.
    Invalid(Box<str>),
    /// It could not be computed.
    Failed(Box<str>),
    /// It ended too early for a verdict.
    Incomplete,
}

impl From<CellResult> for Came {
    fn from(result: CellResult) -> Self {
        match result {
            CellResult::Ended(ending) if ending.uncertain.is_some() => Self::Uncertain,
            CellResult::Ended(ending) => match ending.outcome {
                Outcome::Overturned(_) => Self::Overturned,
                Outcome::Rest => Self::Rest,
                Outcome::NeverMoved => Self::NeverMoved,
                Outcome::Vibrates => Self::Vibrates,
                Outcome::StillRocking => Self::StillRocking,
                Outcome::Incomplete => Self::Incomplete,
            },
            CellResult::CannotStand => Self::Invalid("it cannot stand".into()),
            CellResult::NotFourLinks => Self::Invalid("it is too thick for four links".into()),
            CellResult::Failed(reason) => Self::Failed(reason.into()),
        }
    }
}

impl Came {
    /// Why there is no outcome, and whether its values are the reason.
    fn why_not(&self) -> Option<(&'static str, &str)> {
        match self {
            Self::Invalid(reason) => Some(("invalid", reason)),
            Self::Failed(reason) => Some(("failed", reason)),
            Self::Incomplete => Some((Outcome::Incomplete.name(), Ending::INCOMPLETE)),
            _ => None,
        }
    }
}

/// Most histories: their rows must fit into memory.
const MAX_HISTORIES: usize = 20_000_000;
/// Samples whose structures are kept at a time: threads work on neighbours.
const KEPT: usize = 8;

/// The map of a sample, or why there is none.
type OfSample<'a> = Result<OverturningMap<'a>, Box<str>>;
/// The same, made when first asked for, with its number.
type Kept<'a> = (usize, Arc<OnceLock<OfSample<'a>>>);

/// The cells of a map, for every sample: those of a sample follow one another, and first come those of the scenario itself.
#[derive(Debug)]
pub struct CellsOfSamples<'a> {
    scenario: &'a Scenario,
    uncertain: &'a Uncertain,
    map: OverturningMap<'a>,
    /// The maps of the samples that were last asked for.
    kept: Mutex<VecDeque<Kept<'a>>>,
}

impl<'a> CellsOfSamples<'a> {
    /// Of a scenario with a map and a table `[uncertain]`.
    ///
    /// # Errors
    /// In words, what to change.
    pub fn of(scenario: &'a Scenario) -> Result<Self, String> {
        let map = OverturningMap::of(scenario)?;
        let uncertain = uncertain(scenario)?;
        for axis in map.axes() {
            let mut keys = uncertain.keys.iter();
            if let Some(key) = keys.find(|key| says_the_same(axis, key)) {
                return Err(format!(
                    "`{}` of [map] and \"{}\" of [uncertain] contradict: leave one of them out",
                    axis.key, key.key
                ));
            }
        }
        let histories = map.count().saturating_mul(1 + uncertain.cases());
        if histories > MAX_HISTORIES {
            return Err(format!(
                "{} cells of [map] and {} samples of [uncertain] are {histories} histories; at most {MAX_HISTORIES} are allowed",
                map.count(),
                uncertain.cases()
            ));
        }
        Ok(Self {
            scenario,
            uncertain,
            map,
            kept: Mutex::default(),
        })
    }

    /// The map of a sample, counted from 1; 0 is the scenario itself.
    fn of_sample(&self, sample: usize) -> Arc<OnceLock<OfSample<'a>>> {
        let found = {
            // What is kept is complete whatever a thread that panicked did.
            let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            let found = kept.iter().find(|(other, _)| *other == sample).cloned();
            let (_, found) = found.unwrap_or_else(|| {
                kept.truncate(KEPT - 1);
                kept.push_front((sample, Arc::default()));
                kept[0].clone()
            });
            found
        };
        found.get_or_init(|| {
            let scenario = match sample.checked_sub(1) {
                None => Ok(self.scenario.clone()),
                Some(sample) => {
                    let values = self.uncertain.values(sample);
                    self.uncertain.scenario(self.scenario, &values)
                }
            };
            let map = OverturningMap::of_sample(self.scenario, scenario?);
            Ok(map.expect("the scenario has a map"))
        });
        found
    }

    /// The number of a sample, and that of a cell within it.
    fn place(&self, index: usize) -> [usize; 2] {
        let cells = self.map.count();
        [index / cells, index % cells]
    }
}

/// Whether an axis varies what an uncertain key says.
fn says_the_same(axis: &Axis, key: &UncertainKey) -> bool {
    let parts =
        |key: &str| -> Vec<String> { key.split('.').map(|part| part.trim().to_owned()).collect() };
    let own = parts(&key.key);
    let ends_with = |names: &[&str]| {
        let last = own.last().map_or("", String::as_str);
        names.contains(&last)
    };
    let is_of = |table: &str| own.first().is_some_and(|first| first == table);
    match axis.quantity {
        Quantity::Other => own == parts(&axis.key),
        Quantity::Duration | Quantity::Frequency => {
            is_of("ground") && ends_with(&["duration_s", "frequency_hz"])
        }
        Quantity::Amplitude => is_of("ground") && ends_with(&["amplitude_g"]),
        Quantity::Scale | Quantity::PeakG => is_of("ground") && ends_with(&["scale", "peak_g"]),
        Quantity::MeanRadius => is_of("arch") && ends_with(&["mean_radius_m"]),
        Quantity::ThicknessRatio => is_of("arch") && ends_with(&["thickness_ratio", "thickness_m"]),
        Quantity::Embrace => is_of("arch") && ends_with(&["embrace_deg"]),
        Quantity::Restitution => is_of("impact") && ends_with(&["restitution"]),
    }
}

impl Study for CellsOfSamples<'_> {
    type Row = Came;

    const NAME: &'static str = "uncertain_map";

    fn scenario(&self) -> String {
        self.scenario.to_toml()
    }

    fn inputs(&self) -> Vec<String> {
        self.scenario.record_checksums()
    }

    fn count(&self) -> usize {
        self.map.count() * (1 + self.uncertain.cases())
    }

    fn row(&self, index: usize) -> Came {
        self.rows(&[index]).remove(0)
    }

    /// Cells of one sample with one structure.
    fn family(&self, index: usize) -> Option<usize> {
        let [sample, cell] = self.place(index);
        let family = self.map.family(cell)?;
        Some(sample * self.map.count() + family)
    }

    fn rows(&self, indices: &[usize]) -> Vec<Came> {
        let Some([sample, _]) = indices.first().map(|index| self.place(*index)) else {
            return Vec::new();
        };
        let map = self.of_sample(sample);
        let cells: Vec<usize> = indices.iter().map(|index| self.place(*index)[1]).collect();
        match map.get().expect("it was made") {
            Ok(map) => {
                let rows = map.rows(&cells).into_iter();
                rows.map(|row| row.result.into()).collect()
            }
            Err(reason) => vec![Came::Invalid(reason.clone()); cells.len()],
        }
    }
}

/// What became of a cell over all samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Likely {
    /// Values of x and y.
    pub at: [f64; 2],
    /// How many samples have an outcome here.
    pub samples: usize,
    /// How many certainly overturn; `None` where no sample has an outcome.
    pub overturned: Option<Share>,
    /// How many are uncertain, come to rest, never move, vibrate, are still rocking.
    pub others: [usize; 5],
    /// How many have none because of their values, because they could not be computed, and because they ended too early.
    pub without: [usize; 3],
}

/// Outcomes beside overturning, by their names in results.
const OTHERS: [&str; 5] = [
    "uncertain",
    "rest",
    "never_moved",
    "vibrates",
    "still_rocking",
];

impl Likely {
    fn of<'r>(at: [f64; 2], rows: impl Iterator<Item = &'r Came>) -> Self {
        let (mut overturned, mut others, mut without) = (0, [0; 5], [0; 3]);
        for row in rows {
            *match row {
                Came::Overturned => &mut overturned,
                Came::Uncertain => &mut others[0],
                Came::Rest => &mut others[1],
                Came::NeverMoved => &mut others[2],
                Came::Vibrates => &mut others[3],
                Came::StillRocking => &mut others[4],
                Came::Invalid(_) => &mut without[0],
                Came::Failed(_) => &mut without[1],
                Came::Incomplete => &mut without[2],
            } += 1;
        }
        let samples = overturned + others.iter().sum::<usize>();
        Self {
            at,
            samples,
            overturned: Share::of(overturned, samples),
            others,
            without,
        }
    }

    /// The part of the samples that certainly overturn.
    #[must_use]
    pub fn probability(&self) -> Option<f64> {
        self.overturned.map(|share| share.share)
    }
}

/// The probabilities whose place on the map is told.
pub const LEVELS: [f64; 3] = [0.05, 0.5, 0.95];

/// Where on a column of the map the probability first reaches the [`LEVELS`], going up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// The value of x.
    pub x: f64,
    /// The values of y, between cells by the line through them; that of the lowest cell if it is reached there already, and
    /// `None` if it is not reached.
    pub y: [Option<f64>; 3],
    /// Whether the lowest cell reaches it already, so that it may be reached below the map.
    pub at_most: [bool; 3],
}

impl Reached {
    /// The value of y at which a level is reached, if that is inside the map.
    fn inside(&self, level: usize) -> Option<f64> {
        self.y[level].filter(|_| !self.at_most[level])
    }
}

/// Where the probability first reaches the levels on a column, whose cells go up.
fn reached(column: &[Likely], logarithmic: bool) -> Reached {
    let known: Vec<[f64; 2]> = column
        .iter()
        .filter_map(|cell| Some([cell.at[1], cell.probability()?]))
        .collect();
    let first = |level: f64| {
        let index = known
            .iter()
            .position(|[_, probability]| *probability >= level)?;
        let [y, probability] = known[index];
        let Some([below, least]) = index.checked_sub(1).map(|before| known[before]) else {
            return Some(y);
        };
        let part = (level - least) / (probability - least);
        Some(if logarithmic {
            below * (y / below).powf(part)
        } else {
            below + part * (y - below)
        })
    };
    let lowest = known.first().map_or(0.0, |[_, probability]| *probability);
    Reached {
        x: column.first().map_or(0.0, |cell| cell.at[0]),
        y: LEVELS.map(first),
        at_most: LEVELS.map(|level| lowest >= level),
    }
}

impl CellsOfSamples<'_> {
    /// What became of each cell over all samples.
    #[must_use]
    pub fn likely(&self, rows: &[Came]) -> Vec<Likely> {
        let cells = self.map.count();
        let samples = self.samples(rows);
        let of = |cell: usize| {
            let rows = samples.iter().skip(cell).step_by(cells);
            Likely::of(self.map.coordinates(cell), rows)
        };
        (0..cells).map(of).collect()
    }

    /// The rows of samples, without those of the scenario itself and of total indices.
    fn samples<'r>(&self, rows: &'r [Came]) -> &'r [Came] {
        let cells = self.map.count();
        let to = cells * (1 + self.uncertain.samples);
        rows.get(cells..to).unwrap_or_default()
    }

    /// Where the probability first reaches the [`LEVELS`], column by column.
    #[must_use]
    pub fn reached(&self, likely: &[Likely]) -> Vec<Reached> {
        let [_, y] = self.map.axes();
        let values = &self.map.values()[1];
        let logarithmic =
            y.sequence.spacing() == Spacing::Logarithmic && values.iter().all(|value| *value > 0.0);
        likely
            .chunks(values.len())
            .map(|column| reached(column, logarithmic))
            .collect()
    }

    /// Of each sample the part of its cells that certainly overturn, as answers of samples; the scenario itself comes first.
    fn parts(&self, rows: &[Came]) -> Vec<SampleRow<Share>> {
        let samples = rows.chunks(self.map.count()).enumerate();
        samples
            .map(|(sample, cells)| {
                let likely = Likely::of([0.0; 2], cells.iter());
                let why_not = || {
                    let why_not = cells.iter().find(|cell| cell.why_not().is_some());
                    match why_not {
                        Some(Came::Failed(reason)) => NoAnswer::Failed(reason.to_string()),
                        Some(Came::Incomplete) => NoAnswer::Incomplete,
                        Some(Came::Invalid(reason)) => NoAnswer::Invalid(reason.to_string()),
                        _ => NoAnswer::Invalid("it has no cells".to_owned()),
                    }
                };
                SampleRow {
                    values: match sample.checked_sub(1) {
                        None => Vec::new(),
                        Some(sample) => self.uncertain.values(sample),
                    },
                    answer: likely.overturned.ok_or_else(why_not),
                }
            })
            .collect()
    }
}

impl Reported for CellsOfSamples<'_> {
    fn results(&self, rows: Vec<Came>, look: Look) -> Result<Results, OutputError> {
        let parts = self.parts(&rows);
        let told = Told::new(self.scenario, self.uncertain, &parts);
        told::tell(self, &told, &rows, look)
    }
}
