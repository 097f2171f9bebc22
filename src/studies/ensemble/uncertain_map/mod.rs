//! A map of every sample: the probability of overturning of each cell, instead of an outcome.

mod report;

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};

pub use self::report::UncertainMapSummary;
use super::samples::ReasonCounts;
use super::{NoAnswer, SampleCases, SampleRow, Samples};
use crate::dynamics::Direction;
use crate::output::OutputError;
use crate::scenario::{Scenario, replaces};
use crate::studies::ending::columns::OUTCOMES;
use crate::studies::map::OverturningMap;
use crate::studies::statistics::Share;
use crate::studies::{Ending, NoHistory, Results, Study, Style, Verdict};

/// The outcome of a cell of a sample, as an index of [`OUTCOMES`], plus
/// [`MIRRORED`] for a history under the mirrored ground motion, its probability of overturning, in parts of [`PARTS`], and of a survivor the friction
/// demand; or the reason why there is none. Rows are small, because all must fit into memory.
type CellRow = Result<(u8, u8, Option<f32>), NoAnswer>;

/// Number of parts of a probability: fractions of 2, 3, 5, 6 and 7 repetitions are exact, others almost.
const PARTS: f64 = 210.0;

/// Added to the index of the outcome of a history under the mirrored ground motion.
const MIRRORED: u8 = 50;

/// Index of the outcome of a history, without its additions.
const fn outcome_of(place: u8) -> usize {
    (place % MIRRORED) as usize
}

fn cell_row(result: Result<Ending, NoHistory>) -> CellRow {
    let ending = result?;
    let outcome = ending.outcome_name();
    let place = OUTCOMES.iter().position(|name| *name == outcome);
    if ending.is_outside_model() {
        return Err(NoAnswer::OutsideModel);
    }
    let mirrored = MIRRORED * u8::from(ending.direction == Direction::Mirrored);
    let both = place.zip(ending.overturning_share());
    let survives = ending.verdict() == Verdict::Survives;
    let demand = ending.friction_demand.filter(|_| survives);
    let demand = demand.map(|demand| demand as f32);
    let both = both.map(|(place, share)| {
        let place = place as u8 + mirrored;
        (place, (PARTS * share).round() as u8, demand)
    });
    both.ok_or(NoAnswer::Incomplete)
}

/// Largest number of histories; their rows must fit into memory.
const MAX_HISTORIES: usize = 20_000_000;
/// Number of samples whose maps are cached. Threads work on neighbouring samples.
const CACHED: usize = 8;

/// The map of a sample, or the reason why there is none.
type OfSample<'a> = Result<OverturningMap<'a>, String>;
/// Cached map of a sample, with the number of the sample.
type Cached<'a> = (usize, Arc<OnceLock<OfSample<'a>>>);

/// The cells of a map for the scenario itself, followed by those for each sample.
#[derive(Debug)]
pub struct CellsOfSamples<'a> {
    samples: SampleCases<'a>,
    map: OverturningMap<'a>,
    /// The maps of the samples that were last used.
    cache: Mutex<VecDeque<Cached<'a>>>,
}

impl<'a> CellsOfSamples<'a> {
    /// Makes the study of a scenario with a map and a table `[uncertain]`.
    ///
    /// # Errors
    /// Change that the scenario needs, in words.
    pub fn of(scenario: &'a Scenario) -> Result<Self, String> {
        let map = OverturningMap::of(scenario)?;
        let samples = SampleCases::of(scenario)?;
        let uncertain = samples.uncertain;
        for axis in map.axes {
            let mut keys = uncertain.keys.iter();
            let path = axis.path(scenario.ground.as_ref());
            if let Some(key) = keys.find(|key| replaces(&path, &key.key)) {
                return Err(format!(
                    "`{}` of [map] and \"{}\" of [uncertain] contradict: leave one of them out",
                    axis.key, key.key
                ));
            }
        }
        let histories = map.count().saturating_mul(samples.count());
        if histories > MAX_HISTORIES {
            return Err(format!(
                "{} cells of [map] and {} samples of [uncertain] are {histories} histories; at most {MAX_HISTORIES} are allowed",
                map.count(),
                uncertain.cases()
            ));
        }
        Ok(Self {
            samples,
            map,
            cache: Mutex::default(),
        })
    }

    /// Map of a sample, counted from 1; 0 is the scenario itself. The map is computed at first use.
    fn map_of_sample(&self, sample: usize) -> Arc<OnceLock<OfSample<'a>>> {
        let found = {
            // The cache is valid even after a panic of another thread.
            let mut cache = self.cache.lock().unwrap_or_else(PoisonError::into_inner);
            let found = cache.iter().find(|(other, _)| *other == sample).cloned();
            let (_, found) = found.unwrap_or_else(|| {
                cache.truncate(CACHED - 1);
                cache.push_front((sample, Arc::default()));
                cache[0].clone()
            });
            found
        };
        found.get_or_init(|| {
            let scenario = self.samples.scenario_of(sample)?;
            let map = OverturningMap::with_sample(self.samples.scenario, scenario);
            Ok(map.expect("the scenario has a map"))
        });
        found
    }

    /// Number of the sample and the index of the cell within its map.
    fn sample_and_cell(&self, index: usize) -> [usize; 2] {
        let cells = self.map.count();
        [index / cells, index % cells]
    }
}

impl Study for CellsOfSamples<'_> {
    type Row = CellRow;

    const NAME: &'static str = "uncertain_map";

    const FILES: &'static [&'static str] = &report::FILES;

    fn base(&self) -> Option<&Scenario> {
        Some(self.samples.scenario)
    }

    fn count(&self) -> usize {
        self.map.count() * self.samples.count()
    }

    /// Family of cells of one sample with one structure.
    fn family(&self, index: usize) -> Option<usize> {
        let [sample, cell] = self.sample_and_cell(index);
        let family = self.map.family(cell)?;
        Some(sample * self.map.count() + family)
    }

    fn rows(&self, indices: &[usize]) -> Vec<CellRow> {
        let Some([sample, _]) = indices.first().map(|index| self.sample_and_cell(*index)) else {
            return Vec::new();
        };
        let map = self.map_of_sample(sample);
        let cells: Vec<usize> = indices
            .iter()
            .map(|index| self.sample_and_cell(*index)[1])
            .collect();
        match map.get().expect("it was made") {
            Ok(map) => {
                let rows = map.rows(&cells).into_iter();
                rows.map(|row| cell_row(row.result)).collect()
            }
            Err(reason) => vec![Err(NoAnswer::Invalid(reason.clone())); cells.len()],
        }
    }

    fn results(&self, rows: Vec<CellRow>, style: Style) -> Result<Results, OutputError> {
        let parts = self.parts(&rows);
        let samples = Samples::new(self.samples, &parts);
        report::report(self, &samples, &rows, style)
    }
}

/// The outcomes of a cell in all samples.
struct CellCounts {
    /// Values of x and y of the cell.
    at: [f64; 2],
    /// Number of samples with an outcome of this cell.
    samples: usize,
    /// Share of the samples that overturn; `None` without an outcome.
    overturned: Option<Share>,
    /// Number of samples with each of the [`OUTCOMES`].
    outcomes: [usize; OUTCOMES.len()],
    /// Number of samples with the numbers of the mirrored ground motion.
    mirrored: usize,
    /// Numbers of samples without an outcome.
    without: ReasonCounts,
}

impl CellCounts {
    fn of<'r>(at: [f64; 2], rows: impl Iterator<Item = &'r CellRow> + Clone) -> Self {
        let mut outcomes = [0; OUTCOMES.len()];
        let mut mirrored = 0;
        for (outcome, ..) in rows.clone().flatten() {
            mirrored += usize::from(*outcome >= MIRRORED);
            outcomes[outcome_of(*outcome)] += 1;
        }
        let without = ReasonCounts::of(rows.clone().filter_map(|row| row.as_ref().err()));
        let samples = outcomes.iter().sum();
        let chances = rows.filter_map(|row| match row {
            Ok((_, parts, _)) => Some(Some(f64::from(*parts) / PARTS)),
            Err(NoAnswer::Invalid(_)) => None,
            Err(_) => Some(None),
        });
        Self {
            at,
            samples,
            overturned: Share::of_chances(chances),
            outcomes,
            mirrored,
            without,
        }
    }

    /// True if most samples have a history outside the model of four links.
    const fn is_outside_model(&self) -> bool {
        self.without.outside > self.samples
    }

    /// Share of samples that overturn; `None` without samples.
    fn probability(&self) -> Option<f64> {
        self.overturned.map(|share| share.share)
    }

    /// Share of samples with this index of [`OUTCOMES`]; `None` without samples.
    fn part(&self, outcome: usize) -> Option<f64> {
        (self.samples > 0).then(|| self.outcomes[outcome] as f64 / self.samples as f64)
    }
}

/// The probabilities whose contour lines are drawn on the map.
const LEVELS: [f64; 3] = [0.05, 0.5, 0.95];

/// The lowest values of y in a column of the map at which the probability reaches the [`LEVELS`].
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Crossing {
    /// The value of x.
    x: f64,
    /// The values of y of the lowest cells that reach the level; `None` if no cell reaches it.
    y: [Option<f64>; 3],
    /// The values of y of the cells below these, which do not reach the level: it is reached between the two. `None` if there is no lower cell, or no cell
    /// reaches the level.
    above: [Option<f64>; 3],
    /// The contour lines: values of y interpolated between the two; `None` if the level is not reached between two cells.
    #[serde(skip)]
    lines: [Option<f64>; 3],
    /// True if the lowest cell already reaches the level, so that the level may be reached below the map.
    at_most: [bool; 3],
}

impl Crossing {
    /// Finds the crossings in a column of cells with ascending y.
    fn of(column: &[CellCounts], logarithmic: bool) -> Self {
        let known: Vec<[f64; 2]> = column
            .iter()
            .filter_map(|cell| Some([cell.at[1], cell.probability()?]))
            .collect();
        let index = |level: f64| known.iter().position(|[_, share]| *share >= level);
        let ends = |level: f64| Some([index(level)?.checked_sub(1)?, index(level)?]);
        let line = |level: f64| {
            let [[below, least], [y, share]] = ends(level)?.map(|index| known[index]);
            let part = (level - least) / (share - least);
            Some(if logarithmic {
                below * libm::pow(y / below, part)
            } else {
                below + part * (y - below)
            })
        };
        let lowest = known.first().map_or(0.0, |[_, share]| *share);
        Self {
            x: column.first().map_or(0.0, |cell| cell.at[0]),
            y: LEVELS.map(|level| Some(known[index(level)?][0])),
            above: LEVELS.map(|level| Some(known[ends(level)?[0]][0])),
            lines: LEVELS.map(line),
            at_most: LEVELS.map(|level| lowest >= level),
        }
    }
}

impl CellsOfSamples<'_> {
    /// Counts the outcomes of each cell in these samples.
    fn counts(&self, samples: &[CellRow]) -> Vec<CellCounts> {
        let cells = self.map.count();
        let of = |cell: usize| {
            let rows = samples.iter().skip(cell).step_by(cells);
            CellCounts::of(self.map.coordinates(cell), rows)
        };
        (0..cells).map(of).collect()
    }

    /// Finds the crossings of all columns.
    fn crossings(&self, counts: &[CellCounts]) -> Vec<Crossing> {
        let [_, y] = self.map.axes;
        let values = &self.map.values[1];
        let logarithmic = y.sequence.is_logarithmic(values);
        let crossing = |column| Crossing::of(column, logarithmic);
        counts.chunks(values.len()).map(crossing).collect()
    }

    /// Share of cells that overturn as the answer of each sample; the scenario itself comes first.
    fn parts(&self, rows: &[CellRow]) -> Vec<SampleRow<Share>> {
        let samples = rows.chunks(self.map.count()).enumerate();
        let part = |(sample, cells): (usize, &[CellRow])| {
            let why_not = cells.iter().find_map(|cell| cell.clone().err());
            let overturned = CellCounts::of([0.0; 2], cells.iter()).overturned;
            SampleRow {
                values: self.samples.values(sample),
                answer: overturned.ok_or_else(|| why_not.expect("a map has cells")),
            }
        };
        samples.map(part).collect()
    }
}
