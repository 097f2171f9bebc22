//! Files and words of a map of samples: a map of probability, the crossings of its levels, and the influence of the uncertain numbers.

use serde::Serialize;
use serde_json::Value;

use super::{CellCounts, CellRow, CellsOfSamples, Crossing, LEVELS, OUTSIDE, Samples};
use crate::output::{Figure, Key, Mark, OutputError, Stroke, color, column, csv, each, list};
use crate::studies::ending::columns::{OUTCOMES, yes};
use crate::studies::ensemble::influence::percent;
use crate::studies::ensemble::report::{Band, Findings};
use crate::studies::kind::{Kind, kind};
use crate::studies::map::page::Cells;
use crate::studies::map::picture::{Drawn, Sheet};
use crate::studies::runner::Study as _;
use crate::studies::statistics::{Share, band, quantile};
use crate::studies::{ModelCheck, Results, Style, no_verdict, rounded};

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
const PALETTE: [Kind; 9] = [
    kind("probability-0", "no sample overturns", "#f4f4f4"),
    kind("probability-5", "up to 5 %", "#fee5d5"),
    kind("probability-25", "up to 25 %", "#fcc4a0"),
    kind("probability-50", "up to 50 %", "#f9986a"),
    kind("probability-75", "up to 75 %", "#e86a3c"),
    kind("probability-95", "up to 95 %", "#c93a1c"),
    kind("probability-99", "above 95 %", "#97150f"),
    kind("probability-100", "every sample overturns", "#5a0008"),
    kind("no-answer", "no sample has an outcome", "#ffffff"),
];

fn kind_of(cell: &CellCounts) -> Kind {
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

/// The part of the summary that is specific to maps.
#[derive(Serialize)]
struct Details {
    /// Number of cells.
    cells: usize,
    /// Number of histories without an outcome, for each reason.
    histories_without_outcome: Value,
    /// Share of the cells that overturn.
    part_that_overturns: Band,
}

pub(super) fn report(
    study: &CellsOfSamples<'_>,
    samples: &Samples<'_, Share>,
    rows: &[CellRow],
    style: Style,
) -> Result<Results, OutputError> {
    let cells = study.map.count();
    let (own, rows) = rows.split_at(cells);
    let rows = &rows[..cells * study.uncertain.samples];
    let counts = study.counts(rows);
    let crossings = study.crossings(&counts);
    let without = rows.iter().filter_map(|row| row.as_ref().err());
    let count = |name| without.clone().filter(|why| why.name() == name).count();
    let reasons = WITHOUT.map(|name| (name, count(name)));
    let mut lines = at_columns(study, &crossings);
    lines.extend(without.clone().next().map(|first| {
        format!(
            "{} of {} histories have no outcome, and do not count; the first: {}",
            without.clone().count(),
            rows.len(),
            first.reason()
        )
    }));
    let (kind, structure) = (study.scenario.motion.kind, &study.scenario.structure);
    let four = !kind.has_joints && structure.has_horizontal_thrust();
    let outside = counts.iter().map(|cell| cell.outside);
    let answered = counts.iter().map(|cell| cell.samples);
    let title = samples.title("Probability of overturning");
    let screen = Style {
        figure: Figure::SCREEN,
        ..style
    };
    let drawn = draw(title, study, &counts, &crossings, screen);
    let names = ["part_that_overturns", "how much of the map overturns"];
    let findings = Findings {
        first: Some(first_words(samples, &counts, own)),
        lines,
        influences: vec![samples.influence(names, false, |share: &Share| share.share)],
        model: ModelCheck::counted(four.then(|| [outside.sum(), answered.sum()])),
        checked: "histories",
        no_verdict: no_verdict(count("incomplete"), rows.len(), "histories"),
        details: Details {
            cells,
            histories_without_outcome: reasons.into_iter().collect(),
            part_that_overturns: band(samples.answers().map(|part| part.share).collect(), quantile)
                .into(),
        },
        pictures: vec![
            draw(title, study, &counts, &crossings, style).picture,
            page_cells(&counts).page(title, &study.map, &drawn),
        ],
        tables: vec![crossing_table(study, &crossings)?, table(study, &counts)?],
        columns: Vec::new(),
        peaks: Vec::new(),
    };
    findings.results(samples, &FILES, style.figure)
}

/// Makes `map.csv`, with a row per cell as the map of the scenario: x varies slowly, y fast.
fn table(study: &CellsOfSamples<'_>, counts: &[CellCounts]) -> Result<Vec<u8>, OutputError> {
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
        list(WITHOUT, |cell: &CellCounts| cell.without),
        column("outside_model", |cell: &CellCounts| cell.outside),
    ];
    csv(columns, counts)
}

/// The reasons why histories have no outcome.
const WITHOUT: [&str; 3] = ["invalid", "failed", "incomplete"];

/// The share of overturned samples, with its interval, in the table and on the page.
const SHARE: [&str; 3] = ["overturned", "overturned_low", "overturned_high"];

/// Makes `probability.csv`, with a row per column of the map.
fn crossing_table(
    study: &CellsOfSamples<'_>,
    crossings: &[Crossing],
) -> Result<Vec<u8>, OutputError> {
    let [x, _] = study.map.axes.map(|axis| axis.key.as_str());
    let levels = ["05", "50", "95"];
    let columns = [
        column(x, |crossing: &Crossing| crossing.x),
        list(
            levels.map(|level| format!("overturned_{level}")),
            |crossing: &Crossing| crossing.y,
        ),
        list(
            levels.map(|level| format!("at_most_{level}")),
            |crossing: &Crossing| crossing.at_most.map(yes),
        ),
    ];
    csv(columns, crossings)
}

fn draw(
    title: &str,
    study: &CellsOfSamples<'_>,
    counts: &[CellCounts],
    crossings: &[Crossing],
    style: Style,
) -> Drawn {
    let kinds: Vec<Kind> = counts.iter().map(kind_of).collect();
    let sheet = Sheet::new(title, &study.map, style);
    let (mut keys, mut lines) = (Vec::new(), Vec::new());
    for (level, (name, stroke)) in LINES.into_iter().enumerate() {
        if crossings
            .iter()
            .any(|crossing| crossing.inside(level).is_some())
        {
            keys.push(Key::line(name, stroke));
        }
        // A line is interrupted where the level is not reached, or is reached below the map.
        let points = crossings
            .iter()
            .map(|crossing| sheet.point(crossing.x, crossing.inside(level).unwrap_or(f64::NAN)));
        lines.push(Mark::curve(name, stroke, points));
    }
    let outside: Vec<bool> = counts.iter().map(CellCounts::is_outside_model).collect();
    sheet.draw(
        (&PALETTE, &kinds, &outside),
        keys,
        vec![Mark::clipped(lines)],
    )
}

/// Returns the cells of the page.
fn page_cells(counts: &[CellCounts]) -> Cells<'static> {
    let numbers = SHARE.into_iter().enumerate().map(|(which, name)| {
        let of = |cell: &CellCounts| Some(cell.overturned?.numbers()[which]);
        (name, counts.iter().map(of).collect())
    });
    let others = OUTCOMES.into_iter().enumerate().skip(1);
    let others = others.map(|(which, name)| {
        let parts = counts.iter().map(|cell| cell.part(which));
        (name, parts.collect())
    });
    Cells {
        palette: &PALETTE,
        kinds: counts.iter().map(kind_of).collect(),
        doubts: Vec::new(),
        outside: counts.iter().map(CellCounts::is_outside_model).collect(),
        columns: numbers.chain(others).collect(),
    }
}

/// Returns the number of cells that overturn with each probability, and in the scenario itself, in words.
fn first_words(samples: &Samples<'_, Share>, counts: &[CellCounts], own: &[CellRow]) -> String {
    let at_least = |level: f64| {
        let cells = counts
            .iter()
            .filter(|cell| cell.probability() >= Some(level));
        format!("{} in {}", percent(level), cells.count())
    };
    let [few, half, most] = LEVELS.map(at_least);
    let survives = |row: &CellRow| {
        row.as_ref()
            .is_ok_and(|(outcome, _)| *outcome % OUTSIDE > 0)
    };
    let in_doubt = counts
        .iter()
        .zip(own)
        .filter(|(cell, own)| survives(own) && cell.probability() >= Some(LEVELS[0]));
    let own = match samples.own {
        Ok(share) => format!(
            "the scenario itself overturns in {}, and in {} of the others the probability is at least 5 %",
            share.count,
            in_doubt.count()
        ),
        Err(_) => "the scenario itself has no outcome".to_owned(),
    };
    format!(
        "overturns with a probability of at least {few} of {} cells, {half}, {most}, from {} samples of [uncertain];\n    {own}",
        counts.len(),
        samples.rows.len()
    )
}

/// Returns the crossings in words, at the ends and in the middle of the map.
fn at_columns(study: &CellsOfSamples<'_>, crossings: &[Crossing]) -> Vec<String> {
    let [x, y] = study.map.axes.map(|axis| axis.key.as_str());
    let last = crossings.len() - 1;
    let mut chosen = vec![0, last / 2, last];
    chosen.dedup();
    let column = |index: usize| {
        let crossing = &crossings[index];
        let level = |level: usize| {
            let percent = percent(LEVELS[level]);
            match (crossing.y[level].map(rounded), crossing.at_most[level]) {
                (Some(y), true) => format!("{percent} at or below {y}"),
                (Some(y), false) => format!("{percent} from {y}"),
                (None, _) => format!("{percent} nowhere"),
            }
        };
        let [few, half, most] = [0, 1, 2].map(level);
        let at = rounded(crossing.x);
        format!("at {x} {at} by {y}: {few}, {half}, {most}")
    };
    chosen.into_iter().map(column).collect()
}
