//! What the cells of samples tell: a map of probability, where that is reached, and what matters.

use serde_json::json;

use super::{Came, CellsOfSamples, LEVELS, Likely, OTHERS, Reached, Told};
use crate::output::Figure;
use crate::output::chart::Mark;
use crate::output::sheet::{Key, Sign};
use crate::output::svg::{Stroke, color};
use crate::output::table::{Cell, Column, column, csv, several};
use crate::output::{OutputError, pretty};
use crate::studies::ending::columns::yes;
use crate::studies::ensemble::picture;
use crate::studies::ensemble::told::{
    Decides, SUMMARY, band_to_json, beginning, percent, without_answer,
};
use crate::studies::kind::Kind;
use crate::studies::map::page::Cells;
use crate::studies::map::picture::{Drawn, Sheet};
use crate::studies::remarks::{no_verdict, warnings};
use crate::studies::results::{Look, Results};
use crate::studies::statistics::{Share, band, quantile};
use crate::studies::threshold::rounded;

/// Colours of probabilities, the darker the likelier, and up to where each goes; no sample and every sample are apart.
const COLORS: [(f64, Kind); 8] = [
    (0.0, kind("probability-0", "no sample overturns", "#f4f4f4")),
    (0.05, kind("probability-5", "up to 5 %", "#fee5d5")),
    (0.25, kind("probability-25", "up to 25 %", "#fcc4a0")),
    (0.5, kind("probability-50", "up to 50 %", "#f9986a")),
    (0.75, kind("probability-75", "up to 75 %", "#e86a3c")),
    (0.95, kind("probability-95", "up to 95 %", "#c93a1c")),
    (1.0, kind("probability-99", "above 95 %", "#97150f")),
    (
        f64::INFINITY,
        kind("probability-100", "every sample overturns", "#5a0008"),
    ),
];
/// Where no sample has an outcome.
const NONE: Kind = kind("no-answer", "no sample has an outcome", "#ffffff");

const fn kind(name: &'static str, label: &'static str, fill: &'static str) -> Kind {
    Kind { name, label, fill }
}

fn kind_of(cell: &Likely) -> Kind {
    let [.., (_, every)] = COLORS;
    let Some(share) = cell.overturned else {
        return NONE;
    };
    if share.count == share.of {
        return every;
    }
    let found = COLORS.iter().find(|(to, _)| share.share <= *to);
    found.map_or(every, |(_, kind)| *kind)
}

/// The lines at the probabilities of 5, 50 and 95 %.
const LINES: [(&str, Stroke); 3] = [
    ("probability of 5 %", Stroke::new(color::BLUE, 1.8, "2 4")),
    ("probability of 50 %", Stroke::new(color::BLUE, 2.4, "")),
    ("probability of 95 %", Stroke::new(color::BLUE, 1.8, "8 4")),
];

/// All that is known of the cells.
struct Found {
    likely: Vec<Likely>,
    reached: Vec<Reached>,
}

pub(super) fn tell(
    study: &CellsOfSamples<'_>,
    told: &Told<'_, Share>,
    rows: &[Came],
    look: Look,
) -> Result<Results, OutputError> {
    let likely = study.likely(rows);
    let found = Found {
        reached: study.reached(&likely),
        likely,
    };
    let parts: Vec<f64> = told.answered().map(|(_, share)| share.share).collect();
    let names = ["part_that_overturns", "how much of the map overturns"];
    let decides = [Decides::new(told, names, false, |share: &Share| {
        share.share
    })];
    let title = study.scenario.title();
    let title = title.unwrap_or("Probability of overturning");
    let screen = Look {
        figure: Figure::SCREEN,
        ..look
    };
    let page = page_cells(&found).page(title, &study.map, &draw(title, study, &found, screen));
    let own = &rows[..found.likely.len()];
    let samples = study.samples(rows);
    let counted = |wanted: &str| -> usize {
        samples
            .iter()
            .filter(|row| row.why_not().is_some_and(|(name, _)| name == wanted))
            .count()
    };
    let mut json = beginning(told);
    json["cells"] = json!(found.likely.len());
    let names = ["invalid", "failed", "incomplete"];
    json["histories_without_outcome"] = names
        .map(|name| (name, counted(name)))
        .into_iter()
        .collect();
    let incomplete = no_verdict(counted("incomplete"), samples.len(), "histories");
    json["warnings"] = warnings(study.scenario)
        .into_iter()
        .chain(incomplete.clone())
        .collect();
    json["part_that_overturns"] = band_to_json(band(parts, quantile));
    let (name, of) = decides[0].to_json();
    json["what_matters"] = json!({ name: of });
    Ok(Results {
        files: vec![
            (
                "map.svg",
                draw(title, study, &found, look).picture.into_bytes(),
            ),
            ("map.html", page.into_bytes()),
            (
                "matters.svg",
                picture::matters(look.figure, told, &decides).into_bytes(),
            ),
            ("probability.csv", csv(line_columns(study), &found.reached)?),
            ("map.csv", csv(columns(study), &found.likely)?),
            (SUMMARY, pretty(&json).into_bytes()),
        ],
        words: words(study, told, &found, [own, samples], &decides[0]).join("\n  "),
        summary: json,
        ..Results::default()
    })
}

/// A row per cell, as `map.csv` of the map itself: x varies slowly, y fast.
fn columns<'s>(study: &'s CellsOfSamples<'_>) -> Vec<Column<'s, Likely>> {
    let [x, y] = study.map.axes().map(|axis| axis.key.as_str());
    let share = |of: fn(&Share) -> f64| move |cell: &Likely| cell.overturned.as_ref().map(of);
    vec![
        column(x, |cell: &Likely| cell.at[0]),
        column(y, |cell: &Likely| cell.at[1]),
        column("samples", |cell: &Likely| cell.samples),
        column("overturned", share(|share| share.share)),
        column("overturned_low", share(|share| share.low)),
        column("overturned_high", share(|share| share.high)),
        several(
            OTHERS.map(str::to_owned).to_vec(),
            |cell: &Likely, cells: &mut Vec<Cell<'_>>| {
                let parts = (0..OTHERS.len()).map(|which| part(cell, which));
                cells.extend(parts.map(Cell::from));
            },
        ),
        column("invalid", |cell: &Likely| cell.without[0]),
        column("failed", |cell: &Likely| cell.without[1]),
        column("incomplete", |cell: &Likely| cell.without[2]),
    ]
}

/// The part of the samples with an outcome that came to one of the [`OTHERS`].
fn part(cell: &Likely, which: usize) -> Option<f64> {
    (cell.samples > 0).then(|| cell.others[which] as f64 / cell.samples as f64)
}

/// A row per column of the map.
fn line_columns<'s>(study: &'s CellsOfSamples<'_>) -> Vec<Column<'s, Reached>> {
    let [x, _] = study.map.axes().map(|axis| axis.key.as_str());
    vec![
        column(x, |reached: &Reached| reached.x),
        column("overturned_05", |reached: &Reached| reached.y[0]),
        column("overturned_50", |reached: &Reached| reached.y[1]),
        column("overturned_95", |reached: &Reached| reached.y[2]),
        column("at_most_05", |reached: &Reached| yes(reached.at_most[0])),
        column("at_most_50", |reached: &Reached| yes(reached.at_most[1])),
        column("at_most_95", |reached: &Reached| yes(reached.at_most[2])),
    ]
}

fn draw(title: &str, study: &CellsOfSamples<'_>, found: &Found, look: Look) -> Drawn {
    let kinds: Vec<Kind> = found.likely.iter().map(kind_of).collect();
    let palette: Vec<Kind> = palette().collect();
    let present = palette.iter().filter(|kind| kinds.contains(kind));
    let mut keys: Vec<Key> = present
        .map(|kind| Key::new(kind.label, Sign::Band(kind.fill, 1.0)))
        .collect();
    let sheet = Sheet::new(title, &study.map, look);
    let mut lines = Vec::new();
    for (level, (name, stroke)) in LINES.into_iter().enumerate() {
        if found.is_reached(level) {
            keys.push(Key::line(name, stroke));
        }
        // A line is interrupted where the probability is not reached, or reached below the map.
        let points = found
            .reached
            .iter()
            .map(|reached| sheet.point(reached.x, reached.inside(level).unwrap_or(f64::NAN)));
        lines.push(Mark::curve(name, stroke, points));
    }
    sheet.draw(&palette, &kinds, keys, vec![Mark::clipped(lines)])
}

fn palette() -> impl Iterator<Item = Kind> {
    COLORS.into_iter().map(|(_, kind)| kind).chain([NONE])
}

impl Found {
    fn is_reached(&self, level: usize) -> bool {
        self.reached
            .iter()
            .any(|reached| reached.inside(level).is_some())
    }
}

/// What the page knows of the cells.
fn page_cells(found: &Found) -> Cells<'static> {
    const ALL: [Kind; 9] = {
        let mut all = [NONE; 9];
        let mut index = 0;
        while index < COLORS.len() {
            all[index] = COLORS[index].1;
            index += 1;
        }
        all
    };
    let of = |value: &dyn Fn(&Likely) -> Option<f64>| -> Vec<Option<f64>> {
        found.likely.iter().map(value).collect()
    };
    let share = |which: fn(&Share) -> f64| of(&|cell| cell.overturned.as_ref().map(which));
    let mut columns = vec![
        ("overturned", share(|share| share.share)),
        ("overturned_low", share(|share| share.low)),
        ("overturned_high", share(|share| share.high)),
    ];
    let others = OTHERS.into_iter().enumerate();
    columns.extend(others.map(|(which, name)| (name, of(&|cell| part(cell, which)))));
    Cells {
        palette: &ALL,
        kinds: found.likely.iter().map(kind_of).collect(),
        doubts: Vec::new(),
        columns,
    }
}

/// What the cells say, line by line.
fn words(
    study: &CellsOfSamples<'_>,
    told: &Told<'_, Share>,
    found: &Found,
    [own, samples]: [&[Came]; 2],
    decides: &Decides<'_>,
) -> Vec<String> {
    let all = found.likely.len();
    let at_least = |level: f64| {
        let reached = found.likely.iter();
        reached
            .filter(|cell| cell.probability().is_some_and(|found| found >= level))
            .count()
    };
    let [few, half, most] = LEVELS.map(|level| (percent(level), at_least(level)));
    let own = match told.own {
        Ok(share) => format!(
            "the scenario itself overturns in {}, and in {} that it survives the probability is at least 5 %",
            share.count,
            in_doubt(&found.likely, own)
        ),
        Err(_) => "the scenario itself has no outcome".to_owned(),
    };
    let mut lines = vec![format!(
        "overturns with a probability of at least {} in {} of {all} cells, {} in {}, {} in {}, from {} samples of [uncertain];\n    {own}{}",
        few.0,
        few.1,
        half.0,
        half.1,
        most.0,
        most.1,
        told.samples.len(),
        decides.ending(told.uncertain)
    )];
    lines.extend(columns_in_words(study, found));
    lines.extend(without_answer(told));
    let why_not = samples.iter().filter_map(Came::why_not);
    let why_not: Vec<(&str, &str)> = why_not.collect();
    if let Some((_, first)) = why_not.first() {
        lines.push(format!(
            "{} of {} histories have no outcome, and do not count; the first: {first}",
            why_not.len(),
            samples.len()
        ));
    }
    lines
}

/// The number of cells in which the scenario itself does not overturn, but samples do with some probability.
fn in_doubt(likely: &[Likely], own: &[Came]) -> usize {
    let cells = likely.iter().zip(own);
    let survives = |came: &Came| *came != Came::Overturned && came.why_not().is_none();
    cells
        .filter(|(cell, own)| survives(own) && cell.probability() >= Some(LEVELS[0]))
        .count()
}

/// Where the probability is reached, in words, at the ends and in the middle of the map.
fn columns_in_words(study: &CellsOfSamples<'_>, found: &Found) -> Vec<String> {
    let [x, y] = study.map.axes().map(|axis| axis.key.as_str());
    let last = found.reached.len().saturating_sub(1);
    let mut chosen = vec![0, last / 2, last];
    chosen.dedup();
    let column = |index: usize| {
        let reached = found.reached.get(index)?;
        let levels = LEVELS.iter().zip(reached.y).zip(reached.at_most);
        let levels = levels.map(|((level, y), at_most)| match y {
            Some(y) if at_most => format!("{} at or below {}", percent(*level), rounded(y)),
            Some(y) => format!("{} from {}", percent(*level), rounded(y)),
            None => format!("{} nowhere", percent(*level)),
        });
        let levels: Vec<String> = levels.collect();
        Some(format!(
            "at {x} {} by {y}: {}",
            rounded(reached.x),
            levels.join(", ")
        ))
    };
    chosen.into_iter().filter_map(column).collect()
}
