//! Files and words of a map of samples: a map of probability, the crossings of its levels, and the influence of the uncertain numbers.

use std::collections::BTreeMap;

use askama::Template;
use serde::{Deserialize, Serialize};

use super::{CellCounts, CellRow, CellsOfSamples, Crossing, LEVELS, Samples, outcome_of};
use crate::output::{Key, Mark, OutputError, Stroke, Table, color, column, each, list};
use crate::scenario::Varied;
use crate::studies::Study as _;
use crate::studies::ending::columns::{OUTCOMES, yes_or_no};
use crate::studies::ensemble::influence::{InfluencedAnswer, percent};
use crate::studies::ensemble::report::{Band, SampleSummary};
use crate::studies::ensemble::samples::ReasonCounts;
use crate::studies::map::page::CellNumbers;
use crate::studies::map::picture::{ColoredCells, Drawn, MapChart};
use crate::studies::outcome_colors::OutcomeColor;
use crate::studies::quotable::SurvivorFriction;
use crate::studies::report::{Report, Warnings};
use crate::studies::statistics::{Share, band, quantile};
use crate::studies::{ModelCheck, Results, Style, format_edge};

/// Names of the files, the seal last.
pub const FILES: [&str; 6] = [
    "map.svg",
    "map.html",
    "matters.svg",
    "probability.csv",
    "map.csv",
    "uncertain.json",
];

/// Colours of probabilities, dark for high ones. The last two are for cells that overturn in all samples, and for cells without an outcome.
const PALETTE: [OutcomeColor; 9] = [
    OutcomeColor::new("probability-0", "no sample overturns", "#f4f4f4"),
    OutcomeColor::new("probability-5", "up to 5 %", "#fee5d5"),
    OutcomeColor::new("probability-25", "up to 25 %", "#fcc4a0"),
    OutcomeColor::new("probability-50", "up to 50 %", "#f9986a"),
    OutcomeColor::new("probability-75", "up to 75 %", "#e86a3c"),
    OutcomeColor::new("probability-95", "up to 95 %", "#c93a1c"),
    OutcomeColor::new("probability-99", "above 95 %", "#97150f"),
    OutcomeColor::new("probability-100", "every sample overturns", "#5a0008"),
    OutcomeColor::new("no-answer", "no sample has a verdict", "#ffffff"),
];

fn color_of(cell: &CellCounts) -> OutcomeColor {
    let bounds = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95];
    PALETTE[match cell.overturned {
        None => 8,
        Some(share) if share.count == share.of + share.no_verdict => 7,
        Some(share) => {
            let in_doubt = usize::from(share.uncertain + share.no_verdict > 0);
            let above = bounds.partition_point(|bound| *bound < share.share);
            above.max(in_doubt)
        }
    }]
}

/// Contour lines of the [`LEVELS`]: name and stroke.
const LINES: [(&str, Stroke); 3] = [
    ("probability of 5 %", Stroke::new(color::BLUE, 1.8, "2 4")),
    ("probability of 50 %", Stroke::new(color::BLUE, 2.4, "")),
    ("probability of 95 %", Stroke::new(color::BLUE, 1.8, "8 4")),
];

/// Report on the map of samples.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/ensemble/uncertain_map/words.txt")]
pub struct UncertainMapSummary {
    #[serde(flatten)]
    all: SampleSummary,
    /// Keys of the x and y axes.
    axes: [String; 2],
    /// Number of cells.
    cells: usize,
    /// Number of cells that overturn with a probability of at least 5, 50 and 95 %.
    cells_at_levels: [usize; 3],
    /// The map of the scenario itself; null if no cell has an outcome.
    own: Option<OwnMap>,
    /// The cells between which the probability reaches 5, 50 and 95 %: in the first, the middle and the last column of the map.
    crossings: Vec<Crossing>,
    /// Number of histories without an outcome, for each reason.
    histories_without_outcome: ReasonCounts,
    /// The reason why the first of these histories has no outcome, in words; null without such histories.
    first_without_outcome: Option<String>,
    /// Share of the cells that overturn.
    part_that_overturns: Band,
}

/// The map of the scenario itself.
#[derive(Serialize, Deserialize)]
struct OwnMap {
    /// Number of cells that overturn.
    overturned: usize,
    /// Number of cells that survive, but overturn with a probability of at least 5 % with the uncertain numbers.
    survived_in_doubt: usize,
}

pub(super) fn report(
    study: &CellsOfSamples<'_>,
    samples: &Samples<'_, Share>,
    rows: &[CellRow],
    style: Style,
) -> Result<Results, OutputError> {
    let cells = study.map.count();
    let (own, rows) = rows.split_at(cells);
    let scenario = study.samples.scenario;
    let rows = &rows[..cells * study.samples.uncertain.samples];
    let counts = study.counts(rows);
    let crossings = study.crossings(&counts);
    let without = rows.iter().filter_map(|row| row.as_ref().err());
    let reasons = ReasonCounts::of(without.clone());
    let (kind, structure) = (scenario.motion.kind, &scenario.structure);
    let four = kind.has_mechanism && structure.has_horizontal_thrust();
    let answered: usize = counts.iter().map(|cell| cell.samples).sum();
    let outside = reasons.outside;
    let model = ModelCheck::counted(four.then_some([outside, answered + outside]));
    let limits = (CHECKED, reasons.no_verdict(rows.len(), CHECKED));
    let demands = rows
        .iter()
        .flatten()
        .map(|(.., demand)| demand.map(f64::from));
    let survivors = ("map FILE", "surviving cells of samples");
    let friction = SurvivorFriction::of(demands, scenario, survivors);
    let influence = samples.influence(false, |share: &Share| share.share);
    let influences = [(InfluencedAnswer::PartThatOverturns, influence)];
    let at_least = |level: f64| {
        let cells = counts.iter();
        cells.filter(move |cell| cell.probability() >= Some(level))
    };
    let parts = samples.answers().map(|part| part.share);
    let report = UncertainMapSummary {
        all: SampleSummary::new(
            (samples, &Varied::default()),
            model,
            friction,
            limits,
            influences,
        ),
        axes: study.map.axes.map(|axis| axis.key.clone()),
        cells,
        cells_at_levels: LEVELS.map(|level| at_least(level).count()),
        own: samples.own.as_ref().ok().map(|share| OwnMap {
            overturned: share.count,
            survived_in_doubt: survived_in_doubt(&counts, own),
        }),
        crossings: select_columns(&crossings),
        histories_without_outcome: reasons,
        first_without_outcome: without.clone().next().map(|why| why.reason().to_owned()),
        part_that_overturns: each(band(parts.collect(), quantile)).into(),
    };
    let title = samples.title("Probability of overturning");
    let colored = ColoredCells {
        palette: &PALETTE,
        colors: counts.iter().map(color_of).collect(),
        outside: counts.iter().map(CellCounts::is_outside_model).collect(),
        mirrored: Vec::new(),
    };
    let picture = |style| draw(title, study, &colored, &crossings, style);
    let results = Results::of("uncertain.json", &report)?;
    let (on_page, columns) = (|figure| picture(style.with(figure)), page_columns(&counts));
    let page = colored.page(
        title,
        &study.map,
        on_page,
        &results.statement,
        (BTreeMap::new(), columns),
    );
    let influences = report.all.draw_influences(samples, style.figure);
    let results = results
        .with_table("map.csv", table(study, &counts)?)
        .with_table("probability.csv", crossing_table(study, &crossings)?)
        .with_file("map.svg", picture(style).picture)
        .with_file("map.html", page)
        .with_file("matters.svg", influences);
    Ok(results.in_order(&FILES))
}

/// Number of cells that survive in the scenario itself, but overturn with a probability of at least 5 %.
fn survived_in_doubt(counts: &[CellCounts], own: &[CellRow]) -> usize {
    let survives = |row: &CellRow| {
        row.as_ref()
            .is_ok_and(|(outcome, ..)| outcome_of(*outcome) > 0)
    };
    let in_doubt = |(cell, own): &(&CellCounts, &CellRow)| {
        survives(own) && cell.probability() >= Some(LEVELS[0])
    };
    counts.iter().zip(own).filter(in_doubt).count()
}

/// Crossings at the ends and in the middle of the map.
fn select_columns(crossings: &[Crossing]) -> Vec<Crossing> {
    let last = crossings.len() - 1;
    let mut chosen = vec![0, last / 2, last];
    chosen.dedup();
    chosen.into_iter().map(|column| crossings[column]).collect()
}

impl Report for UncertainMapSummary {
    fn verdict(&self) -> String {
        let [some, half, most] = self.cells_at_levels;
        let [low, middle, high] = LEVELS.map(percent);
        let (cells, samples) = (self.cells, self.all.samples);
        self.all.verdict(|| {
            format!(
                "overturns with a probability of at least {low} in {some} of {cells} cells, {middle} in {half}, {high} in {most}, \
                 from {samples} samples of [uncertain]"
            )
        })
    }

    fn warnings(&self) -> &Warnings {
        &self.all.warnings
    }
}

impl Crossing {
    /// Cells between which the [`LEVELS`] are reached, in words.
    fn in_words(&self) -> String {
        let level = |(level, (y, above)): (f64, (&Option<f64>, &Option<f64>))| {
            let percent = percent(level);
            match (y.map(format_edge), above.map(format_edge)) {
                (Some(y), None) => format!("{percent} at or below {y}"),
                (Some(y), Some(above)) => format!("{percent} between {above} and {y}"),
                (None, _) => format!("{percent} nowhere"),
            }
        };
        let crossings = self.y.iter().zip(&self.above);
        let levels = LEVELS.into_iter().zip(crossings).map(level);
        levels.collect::<Vec<_>>().join(", ")
    }
}

/// The histories that are checked, in words.
const CHECKED: &str = "histories";

/// Makes `map.csv`, with a row per cell as the map of the scenario: x varies slowly, y fast.
fn table(study: &CellsOfSamples<'_>, counts: &[CellCounts]) -> Result<Table, OutputError> {
    let axes = study.map.axes.map(|axis| axis.key.as_str());
    let columns = [
        list(axes, |cell: &CellCounts| cell.at),
        column("samples", |cell: &CellCounts| cell.samples),
        list(SHARE, |cell: &CellCounts| {
            each(cell.overturned.map(|share| share.numbers()))
        }),
        list(OUTCOMES.into_iter().skip(1), |cell: &CellCounts| {
            (1..OUTCOMES.len())
                .map(|which| cell.part(which))
                .collect::<Vec<_>>()
        }),
        column("invalid", |cell: &CellCounts| cell.without.invalid),
        column("failed", |cell: &CellCounts| cell.without.failed),
        column("incomplete", |cell: &CellCounts| cell.without.incomplete),
        column("outside_model", |cell: &CellCounts| cell.without.outside),
        column("mirrored", |cell: &CellCounts| cell.mirrored),
    ];
    Table::new(columns, counts)
}

/// The share of overturned samples, with its interval, in the table and on the page.
const SHARE: [&str; 3] = ["overturned", "overturned_low", "overturned_high"];

/// Makes `probability.csv`, with a row per column of the map.
fn crossing_table(
    study: &CellsOfSamples<'_>,
    crossings: &[Crossing],
) -> Result<Table, OutputError> {
    let [x, _] = study.map.axes.map(|axis| axis.key.as_str());
    let levels = ["05", "50", "95"];
    let columns = [
        column(x, |crossing: &Crossing| crossing.x),
        list(
            levels.map(|level| format!("overturned_{level}")),
            |crossing: &Crossing| crossing.y,
        ),
        list(
            levels.map(|level| format!("above_{level}")),
            |crossing: &Crossing| crossing.above,
        ),
        list(
            levels.map(|level| format!("at_most_{level}")),
            |crossing: &Crossing| crossing.at_most.map(yes_or_no),
        ),
    ];
    Table::new(columns, crossings)
}

fn draw(
    title: &str,
    study: &CellsOfSamples<'_>,
    cells: &ColoredCells,
    crossings: &[Crossing],
    style: Style,
) -> Drawn {
    let chart = MapChart::new(title, &study.map, style);
    let (mut keys, mut lines) = (Vec::new(), Vec::new());
    for (level, (name, stroke)) in LINES.into_iter().enumerate() {
        if crossings
            .iter()
            .any(|crossing| crossing.lines[level].is_some())
        {
            keys.push(Key::line(name, stroke));
        }
        // A line is interrupted where the level is not reached, or is reached below the map.
        let points = crossings
            .iter()
            .map(|crossing| chart.point(crossing.x, crossing.lines[level].unwrap_or(f64::NAN)));
        lines.push(Mark::curve(name, stroke, points));
    }
    chart.draw(cells, keys, vec![Mark::clipped(lines)])
}

/// Columns of the page.
fn page_columns(counts: &[CellCounts]) -> impl Iterator<Item = CellNumbers> {
    let shares = SHARE.into_iter().enumerate().map(|(which, name)| {
        let of = |cell: &CellCounts| Some(cell.overturned?.numbers()[which]);
        (name, counts.iter().map(of).collect())
    });
    let others = OUTCOMES
        .into_iter()
        .enumerate()
        .skip(1)
        .map(|(which, name)| {
            let parts = counts.iter().map(|cell| cell.part(which));
            (name, parts.collect())
        });
    shares.chain(others)
}
