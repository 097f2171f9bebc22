//! A suite of records: its table, the fragility of the structure, its picture.
//!
//! All results but the rows come from the rows and the text of the scenario, so that parts can be joined
//! where the records are not.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

use nalgebra::Vector2;
use serde_json::{Value, json};

use super::part::{self, Rows};
use super::svg::{Anchor, Axes, Drawing, Frame, Scale, Stroke, color};
use super::{OutputError, finite, verdict};
use crate::scenario::{Measure, Shakes, Spacing};
use crate::studies::fragility::{Errors, Fragility, NoFit, Observation, fit};

/// What leads a row.
const COLUMNS: [&str; 4] = ["record", "sign", "scale", "peak_g"];

/// The row of a case.
///
/// # Errors
/// When a value is not finite.
pub fn row(shakes: &Shakes<'_>, index: usize) -> Result<String, OutputError> {
    let case = shakes.case(index);
    finite("of a row of suite.csv", &[case.scale, case.peak_g])?;
    let fields = match &case.ended {
        Ok(ended) => verdict::fields(ended)?,
        Err(_) => verdict::none(verdict::FAILED),
    };
    let [scale, peak_g] = [case.scale, case.peak_g].map(|value| format!("{value:?}"));
    let sign = if case.mirrored { "-1" } else { "1" };
    let lead = [case.record, sign, &scale, &peak_g];
    // Names of files may need quotes.
    line(lead.into_iter().chain(fields.iter().map(String::as_str)))
}

/// A row as text, without the end of its line.
fn line<'a>(fields: impl Iterator<Item = &'a str>) -> Result<String, OutputError> {
    const WHAT: &str = "cannot write a row";
    let mut csv = csv::WriterBuilder::new().from_writer(Vec::new());
    csv.write_record(fields).map_err(OutputError::csv(WHAT))?;
    let bytes = csv
        .into_inner()
        .map_err(|error| OutputError::io(WHAT)(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).trim_end().to_owned())
}

/// Writes the table, a row per case.
///
/// # Errors
/// When the system refuses.
pub fn write_table(writer: impl Write, rows: &Rows) -> Result<(), OutputError> {
    part::write_table(writer, &[&COLUMNS[..], &verdict::COLUMNS].concat(), rows)
}

/// What a row says.
#[derive(Clone, Debug, PartialEq)]
struct Case {
    record: String,
    mirrored: bool,
    level: f64,
    outcome: String,
}

impl Case {
    /// `None` if the row is damaged.
    fn read(row: &str, measure: Measure) -> Option<Self> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(row.as_bytes());
        let fields = reader.records().next()?.ok()?;
        let column = COLUMNS.iter().position(|name| *name == measure.column())?;
        let level: f64 = fields.get(column)?.parse().ok()?;
        (fields.len() == COLUMNS.len() + verdict::COLUMNS.len() && level > 0.0).then_some(())?;
        Some(Self {
            record: fields.get(0)?.to_owned(),
            mirrored: fields.get(1)? == "-1",
            level,
            outcome: fields.get(COLUMNS.len())?.to_owned(),
        })
    }

    fn failed(&self) -> bool {
        self.outcome == verdict::FAILED
    }

    fn overturned(&self) -> bool {
        self.outcome == "overturned"
    }
}

/// The cases of one intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The intensity.
    pub intensity: f64,
    /// Number of cases that have an outcome.
    pub cases: usize,
    /// Number of those that overturned.
    pub overturned: usize,
    /// Number of those that had neither overturned nor come to rest.
    pub still_rocking: usize,
    /// Number of cases whose history could not be computed: they are not among the others.
    pub failed: usize,
}

impl Level {
    /// The part of the cases that overturned.
    #[must_use]
    pub fn fraction(&self) -> Option<f64> {
        (self.cases > 0).then(|| self.overturned as f64 / self.cases as f64)
    }
}

/// What all cases say together. Those that are still rocking have not overturned; those that failed do not
/// count. Nor do mirrored records: the structures are symmetric, so that they do the same to the other side, and
/// are no further evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    scenario: Value,
    /// What the intensities are.
    pub measure: Measure,
    spacing: Spacing,
    cases: Vec<Case>,
    /// By intensity, lowest first.
    pub levels: Vec<Level>,
    /// The curve, if there is one.
    pub fit: Result<Fragility, NoFit>,
}

impl Results {
    /// The results of all rows. The scenario is that of the parts' header; `None` if that is not the text of
    /// a scenario with a suite, or a row is damaged.
    #[must_use]
    pub fn of(scenario: &str, rows: &Rows) -> Option<Self> {
        // Its records may be elsewhere, so that it cannot be read as a scenario.
        let scenario: Value = toml::from_str(scenario).ok()?;
        let suite = scenario.get("suite")?;
        let (measure, levels) = Measure::ALL
            .iter()
            .find_map(|measure| Some((*measure, suite.get(measure.name())?)))?;
        let logarithmic = levels["spacing"] == Spacing::Logarithmic.name();
        let spacing = if logarithmic {
            Spacing::Logarithmic
        } else {
            Spacing::Linear
        };
        let cases: Vec<Case> = rows
            .values()
            .map(|row| Case::read(row, measure))
            .collect::<Option<_>>()?;
        let evidence: Vec<&Case> = cases.iter().filter(|case| !case.mirrored).collect();
        let indices: BTreeMap<&str, usize> = names(&cases).into_iter().zip(0..).collect();
        let observations: Vec<Observation> = evidence
            .iter()
            .filter(|case| !case.failed())
            .map(|case| Observation {
                intensity: case.level,
                overturned: case.overturned(),
                record: indices[case.record.as_str()],
            })
            .collect();
        Some(Self {
            levels: levels_of(evidence),
            fit: fit(&observations),
            scenario,
            measure,
            spacing,
            cases,
        })
    }

    /// Number of cases with an outcome.
    #[must_use]
    pub fn outcome_count(&self, outcome: &str) -> usize {
        let cases = self.cases.iter();
        cases.filter(|case| case.outcome == outcome).count()
    }

    /// Number of all cases.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.cases.len()
    }

    /// Number of records.
    #[must_use]
    pub fn record_count(&self) -> usize {
        names(&self.cases).len()
    }

    /// How many records there are.
    #[must_use]
    pub fn records_in_words(&self) -> String {
        match self.record_count() {
            1 => "1 record".to_owned(),
            count => format!("{count} records"),
        }
    }

    /// Names of the records of whose cases all overturned, or none, as `wanted`.
    #[must_use]
    pub fn always(&self, overturned: bool) -> Vec<&str> {
        let mut alike: BTreeMap<&str, bool> = BTreeMap::new();
        for case in self.cases.iter().filter(|case| !case.failed()) {
            *alike.entry(&case.record).or_insert(true) &= case.overturned() == overturned;
        }
        let alike = alike.into_iter().filter(|(_, alike)| *alike);
        alike.map(|(record, _)| record).collect()
    }

    /// The first case whose history could not be computed, in words.
    #[must_use]
    pub fn first_failed(&self) -> Option<String> {
        let case = self.cases.iter().find(|case| case.failed())?;
        Some(format!(
            "{}{}, {} {:?}",
            case.record,
            if case.mirrored { " mirrored" } else { "" },
            self.measure.column(),
            case.level
        ))
    }

    /// Writes the fragility, a row per level. What there is not is left empty.
    ///
    /// # Errors
    /// When the system refuses, or a value is not finite.
    pub fn write_levels(&self, writer: impl Write) -> Result<(), OutputError> {
        const WHAT: &str = "cannot write the fragility";
        let mut csv = csv::Writer::from_writer(writer);
        csv.write_record([
            self.measure.column(),
            "cases",
            "overturned",
            "still_rocking",
            "failed",
            "fraction",
            "probability",
            "probability_low",
            "probability_high",
        ])
        .map_err(OutputError::csv(WHAT))?;
        for level in &self.levels {
            let Level {
                intensity,
                cases,
                overturned,
                still_rocking,
                failed,
            } = *level;
            let curve = self.fit.as_ref().ok().map(|fit| {
                let (low, high) = fit.band(intensity);
                [fit.probability(intensity), low, high]
            });
            finite(
                "of a row of fragility.csv",
                curve.as_ref().map_or(&[], |c| c),
            )?;
            csv.serialize((
                (intensity, cases, overturned, still_rocking, failed),
                level.fraction(),
                curve.map_or([None; 3], |curve| curve.map(Some)),
            ))
            .map_err(OutputError::csv(WHAT))?;
        }
        csv.flush().map_err(OutputError::io(WHAT))
    }

    /// The fragility as JSON. What there is not is null.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn to_json(&self) -> Result<Value, OutputError> {
        let fit = self.fit.as_ref().ok();
        let errors = |errors: Option<&Errors>| {
            errors.map_or([None; 2], |errors| {
                [Some(errors.median), Some(errors.dispersion)]
            })
        };
        let [median_error, dispersion_error] = errors(fit.map(|fit| &fit.independent));
        let [median_error_by_record, dispersion_error_by_record] =
            errors(fit.and_then(|fit| fit.clustered.as_ref()));
        let median = fit.map(|fit| fit.median);
        let dispersion = fit.map(|fit| fit.dispersion);
        let log_likelihood = fit.map(|fit| fit.log_likelihood);
        for value in [
            median,
            median_error,
            median_error_by_record,
            dispersion,
            dispersion_error,
            dispersion_error_by_record,
            log_likelihood,
        ] {
            finite("of fragility.json", value.as_slice())?;
        }
        let total = |count: fn(&Level) -> usize| -> usize { self.levels.iter().map(count).sum() };
        Ok(json!({
            "program": env!("CARGO_PKG_NAME"),
            "version": env!("CARGO_PKG_VERSION"),
            "scenario": self.scenario,
            "intensity": self.measure.column(),
            "median": median,
            "median_standard_error": median_error,
            "median_standard_error_by_record": median_error_by_record,
            "dispersion": dispersion,
            "dispersion_standard_error": dispersion_error,
            "dispersion_standard_error_by_record": dispersion_error_by_record,
            "log_likelihood": log_likelihood,
            "no_fit": self.no_fit(),
            "records": self.record_count(),
            "cases": total(|level| level.cases),
            "overturned": total(|level| level.overturned),
            "still_rocking_counted_as_not_overturned": total(|level| level.still_rocking),
            "failed_left_out": total(|level| level.failed),
            "records_that_never_overturn": self.always(false),
            "records_that_always_overturn": self.always(true),
        }))
    }

    /// Why there is no curve.
    #[must_use]
    pub fn no_fit(&self) -> Option<String> {
        self.fit.as_ref().err().map(ToString::to_string)
    }

    /// The curve in words, with its standard errors, the larger ones first.
    #[must_use]
    pub fn curve_in_words(&self) -> Option<String> {
        let fit = self.fit.as_ref().ok()?;
        let unit = match self.measure {
            Measure::Scale => "",
            Measure::PeakG => " g",
        };
        let quantity = |value: f64, error: fn(&Errors) -> f64, unit: &str| {
            let independent = error(&fit.independent);
            // Two digits of the error are known at best.
            let digits = digits(independent);
            let by_record = fit.clustered.as_ref().map_or(String::new(), |clustered| {
                format!(" (by record ± {:.digits$}{unit})", error(clustered))
            });
            format!("{value:.digits$}{unit} ± {independent:.digits$}{unit}{by_record}")
        };
        Some(format!(
            "median {}, dispersion {}",
            quantity(fit.median, |errors| errors.median, unit),
            quantity(fit.dispersion, |errors| errors.dispersion, "")
        ))
    }

    /// Draws fractions, curve and band.
    #[must_use]
    pub fn draw(&self) -> String {
        let mut drawing = Drawing::new(900.0, 600.0);
        let title = self.scenario.get("title").and_then(Value::as_str);
        let title = title.unwrap_or("Fragility under a suite of records");
        drawing.title(title);
        let axes = Axes {
            frame: FRAME,
            x: self.scale(),
            y: Scale::exactly(0.0, 1.0, 5),
        };
        if let Ok(fit) = &self.fit {
            draw_band(&mut drawing, &axes, fit);
        }
        let label = match self.measure {
            Measure::Scale => "scale factor",
            Measure::PeakG => "peak ground acceleration (g)",
        };
        axes.draw(&mut drawing, Some(label), "fraction that overturns");
        if let Ok(fit) = &self.fit {
            let curve = along(&axes.x).map(|x| axes.place(x, fit.probability(x)));
            drawing.curve("fit", curve, CURVE);
        }
        for level in &self.levels {
            if let Some(fraction) = level.fraction() {
                let at = axes.place(level.intensity, fraction);
                drawing.circle("fraction", at, 4.5, POINT);
            }
        }
        self.legend(&mut drawing);
        drawing.finish()
    }

    /// From below the lowest level to above the highest.
    fn scale(&self) -> Scale {
        let ends = [self.levels.first(), self.levels.last()];
        let [low, high] = ends.map(|level| level.map_or(1.0, |level| level.intensity));
        match self.spacing {
            Spacing::Logarithmic => {
                let margin = (high / low).powf(0.05);
                Scale::logarithmic(low / margin, high * margin)
            }
            Spacing::Linear => Scale::exactly(0.0, 1.05 * high, 8),
        }
    }

    fn legend(&self, drawing: &mut Drawing) {
        let mut x = FRAME.left;
        let mut entry = |drawing: &mut Drawing, text: &str, advance: f64| {
            drawing.label(Vector2::new(x + 36.0, 58.5), Anchor::Start, 0.0, text);
            x += advance;
            x - advance
        };
        let cases: usize = self.levels.iter().map(|level| level.cases).sum();
        let text = format!("fraction of {}, {cases} cases", self.records_in_words());
        let left = entry(drawing, &text, 300.0);
        drawing.circle("", Vector2::new(left + 15.0, 54.0), 4.5, POINT);
        match self.curve_in_words() {
            Some(words) => {
                let left = entry(drawing, "lognormal curve", 190.0);
                let start = Vector2::new(left, 54.0);
                drawing.line(start, start + Vector2::new(30.0, 0.0), CURVE);
                let left = entry(drawing, "95 % band", 0.0);
                let swatch = format!("M{left} 47h30v14h-30z");
                drawing.path("", &swatch, BAND, Stroke::new(BAND, 0.0, ""));
                drawing.label(Vector2::new(FRAME.left, 86.0), Anchor::Start, 0.0, &words);
            }
            None => {
                let reason = format!("no curve: {}", self.no_fit().unwrap_or_default());
                for (text, y) in wrapped(&reason, 115).iter().zip([86.0, 103.0, 120.0]) {
                    drawing.label(Vector2::new(FRAME.left, y), Anchor::Start, 0.0, text);
                }
            }
        }
    }
}

/// Where the curve is drawn.
const FRAME: Frame = Frame {
    left: 85.0,
    top: 135.0,
    width: 790.0,
    height: 405.0,
};

const CURVE: Stroke = Stroke::new(color::BLUE, 2.0, "");
const POINT: Stroke = Stroke::new(color::VERMILION, 1.8, "");
const BAND: &str = "#d6e8f4";

/// So many points make a smooth curve.
const POINTS: u32 = 200;

/// Values along an axis, above zero.
fn along(scale: &Scale) -> impl Iterator<Item = f64> {
    let scale = *scale;
    (0..=POINTS)
        .map(move |i| scale.at(f64::from(i) / f64::from(POINTS)))
        .filter(|x| *x > 0.0)
}

fn draw_band(drawing: &mut Drawing, axes: &Axes, fit: &Fragility) {
    let (mut low, mut high): (Vec<_>, Vec<_>) = along(&axes.x)
        .map(|x| {
            let (low, high) = fit.band(x);
            (axes.place(x, low), axes.place(x, high))
        })
        .unzip();
    high.reverse();
    low.append(&mut high);
    let path: Vec<_> = low
        .iter()
        .map(|point| format!("{:.2} {:.2}", point.x, point.y))
        .collect();
    let path = format!("M{}Z", path.join(" "));
    drawing.path("band", &path, BAND, Stroke::new(BAND, 0.0, ""));
}

/// Names of the records.
fn names(cases: &[Case]) -> BTreeSet<&str> {
    cases.iter().map(|case| case.record.as_str()).collect()
}

fn levels_of(mut cases: Vec<&Case>) -> Vec<Level> {
    cases.sort_by(|a, b| a.level.total_cmp(&b.level));
    cases
        .chunk_by(|a, b| a.level.total_cmp(&b.level).is_eq())
        .map(|level| {
            let count = |which: fn(&Case) -> bool| level.iter().filter(|c| which(c)).count();
            let failed = count(Case::failed);
            Level {
                intensity: level[0].level,
                cases: level.len() - failed,
                overturned: count(Case::overturned),
                still_rocking: count(|case| case.outcome == "still_rocking"),
                failed,
            }
        })
        .collect()
}

/// Digits after the point that show two digits of an error.
fn digits(error: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small whole number"
    )]
    let digits = (1.0 - error.log10().floor()).clamp(0.0, 12.0) as usize;
    digits
}

/// Lines of at most so many characters, unless a word has more.
fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
