//! A suite of records: its table, the fragility of the structure, its picture.

use std::io::Write;

use serde_json::{Value, json};

use super::ending::{self, Failed};
use super::svg::{Axes, Drawing, Figure, Scale, Sign, Stroke, color};
use super::table::table;
use super::{OutputError, finite};
use crate::scenario::{Measure, Scenario, Spacing, Suite, shown};
use crate::studies::fragility::{Errors, Fragility};
use crate::studies::suite::{CaseRow, CurvePoint, FragilityRow, SuiteFragility};

/// What leads a row.
const COLUMNS: [&str; 4] = ["record", "sign", "scale", "peak_g"];

/// Writes the table, a row per case.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_table(
    writer: impl Write,
    heading: &Heading,
    rows: &[CaseRow],
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the table";
    let mut csv = table(writer);
    let free_hinges = heading.has_free_hinges();
    csv.write_record(COLUMNS.into_iter().chain(ending::columns(free_hinges)))
        .map_err(OutputError::csv(WHAT))?;
    for case in rows {
        finite("of a row of suite.csv", &[case.scale, case.peak_g])?;
        let fields = match &case.result {
            Ok(ended) => ending::fields(ended)?,
            Err(_) => ending::none(ending::FAILED, free_hinges),
        };
        let [scale, peak_g] = [case.scale, case.peak_g].map(ending::number);
        let sign = if case.mirrored { "-1" } else { "1" };
        let lead = [&*shown(&case.record), sign, &scale, &peak_g];
        csv.write_record(lead.into_iter().chain(fields.iter().map(String::as_str)))
            .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// What the results of a suite say of its scenario. That can be had from the resolved text alone, so that parts
/// are joined where the records are not.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    scenario: Value,
    /// What the intensities are.
    pub measure: Measure,
    spacing: Spacing,
}

impl Heading {
    /// The heading of a scenario with this suite.
    #[must_use]
    pub fn of(scenario: &Scenario, suite: &Suite) -> Self {
        Self {
            scenario: scenario.to_json(),
            measure: suite.measure,
            spacing: suite.levels.spacing(),
        }
    }

    /// The heading of a scenario, every default resolved; `None` if that is not the text of one with a suite.
    #[must_use]
    pub fn of_resolved(scenario: &str) -> Option<Self> {
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
        Some(Self {
            scenario,
            measure,
            spacing,
        })
    }

    fn has_free_hinges(&self) -> bool {
        self.scenario.get("free_hinges").is_some()
    }

    pub(super) fn title(&self) -> &str {
        let title = self.scenario.get("title").and_then(Value::as_str);
        title.unwrap_or("Fragility under a suite of records")
    }
}

/// How many records there are.
#[must_use]
pub fn records_in_words(results: &SuiteFragility) -> String {
    match results.record_count() {
        1 => "1 record".to_owned(),
        count => format!("{count} records"),
    }
}

/// Writes the fragility, a row per level. Missing values are left empty.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_fragility(writer: impl Write, results: &SuiteFragility) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the fragility";
    let mut csv = table(writer);
    csv.write_record([
        results.measure.column(),
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
    for level in &results.levels {
        let FragilityRow {
            intensity,
            cases,
            overturned,
            still_rocking,
            failed,
            curve,
        } = *level;
        let curve = curve.map(|point| {
            let CurvePoint {
                probability,
                low,
                high,
            } = point;
            [probability, low, high]
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

/// The fragility as JSON. Missing values are null.
///
/// # Errors
/// When a value is not finite.
pub fn to_json(heading: &Heading, results: &SuiteFragility) -> Result<Value, OutputError> {
    let fit = results.fit.as_ref().ok();
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
    let total =
        |count: fn(&FragilityRow) -> usize| -> usize { results.levels.iter().map(count).sum() };
    let mut json = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": heading.scenario,
        "intensity": results.measure.column(),
        "median": median,
        "median_standard_error": median_error,
        "median_standard_error_by_record": median_error_by_record,
        "dispersion": dispersion,
        "dispersion_standard_error": dispersion_error,
        "dispersion_standard_error_by_record": dispersion_error_by_record,
        "log_likelihood": log_likelihood,
        "no_fit": no_fit(results),
        "records": results.record_count(),
        "cases": total(|level| level.cases),
        "overturned": total(|level| level.overturned),
        "still_rocking_counted_as_not_overturned": total(|level| level.still_rocking),
        "failed_left_out": total(|level| level.failed),
        "records_that_never_overturn": results.always(false),
        "records_that_always_overturn": results.always(true),
    });
    Failed::list_in(&mut json, &failures(results));
    Ok(json)
}

/// The cases that failed: which, and why.
#[must_use]
pub fn failures(results: &SuiteFragility) -> Vec<Failed> {
    let failed = results.cases.iter().filter_map(|case| {
        let reason = case.result.as_ref().err()?;
        let mirrored = if case.mirrored { " mirrored" } else { "" };
        let (column, level) = (results.measure.column(), case.level(results.measure));
        let case = format!("{}{mirrored}, {column} {level:?}", case.record);
        Some(Failed::new(case, reason))
    });
    failed.collect()
}

/// Why there is no curve.
#[must_use]
pub fn no_fit(results: &SuiteFragility) -> Option<String> {
    results.fit.as_ref().err().map(ToString::to_string)
}

/// The curve in words, with its standard errors, the larger ones first.
#[must_use]
pub fn curve_in_words(results: &SuiteFragility) -> Option<String> {
    let fit = results.fit.as_ref().ok()?;
    let unit = match results.measure {
        Measure::Scale => "",
        Measure::PeakG => " g",
    };
    let quantity = |value: f64, error: fn(&Errors) -> f64, unit: &str| {
        let independent = error(&fit.independent);
        // The error has two significant digits at best.
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
pub fn draw(figure: Figure, heading: &Heading, results: &SuiteFragility) -> String {
    let mut drawing = Drawing::new(figure);
    let top = drawing.title(heading.title());
    let top = legend(&mut drawing, figure, top, results);
    let axes = Axes {
        frame: figure.plot(top, figure.height_px(405.0)),
        x: intensity_scale(heading, &results.levels, figure),
        y: Scale::exactly(0.0, 1.0, 5),
    };
    if let Ok(fit) = &results.fit {
        draw_band(&mut drawing, &axes, fit);
    }
    let label = intensity_label(results.measure);
    axes.draw(&mut drawing, Some(label), "fraction that overturns");
    if let Ok(fit) = &results.fit {
        let curve = along(&axes.x).map(|x| axes.place(x, fit.probability(x)));
        drawing.curve("fit", curve, CURVE);
    }
    for level in &results.levels {
        if let Some(fraction) = level.fraction() {
            let at = axes.place(level.intensity, fraction);
            drawing.circle("fraction", at, 4.5, POINT);
        }
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

/// What the intensities are, in words.
pub(super) const fn intensity_label(measure: Measure) -> &'static str {
    match measure {
        Measure::Scale => "scale factor",
        Measure::PeakG => "peak ground acceleration (g)",
    }
}

/// From below the lowest level to above the highest.
pub(super) fn intensity_scale(heading: &Heading, levels: &[FragilityRow], figure: Figure) -> Scale {
    let ends = [levels.first(), levels.last()];
    let [low, high] = ends.map(|level| level.map_or(1.0, |level| level.intensity));
    match heading.spacing {
        Spacing::Logarithmic => {
            let margin = (high / low).powf(0.05);
            Scale::logarithmic(low / margin, high * margin)
        }
        Spacing::Linear => Scale::exactly(0.0, 1.05 * high, figure.ticks(8)),
    }
}

/// What is drawn, and the curve in words or why there is none; returns where that ends.
fn legend(drawing: &mut Drawing, figure: Figure, top: f64, results: &SuiteFragility) -> f64 {
    let cases: usize = results.levels.iter().map(|level| level.cases).sum();
    let text = format!("fraction of {}, {cases} cases", records_in_words(results));
    let mut keys = vec![(text.as_str(), Sign::Circle(4.5, POINT))];
    let words = curve_in_words(results);
    if words.is_some() {
        keys.extend([
            ("lognormal curve", Sign::Line(CURVE)),
            ("95 % band", Sign::Band(BAND, 1.0)),
        ]);
    }
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys);
    let words =
        words.unwrap_or_else(|| format!("no curve: {}", no_fit(results).unwrap_or_default()));
    drawing.caption(top + 14.0, &words) + 10.0
}

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
