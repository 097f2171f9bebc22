//! A suite of records: its table, the fragility of the structure, its picture.

use std::io::Write;

use serde_json::{Value, json};

use super::ending::{self, Remarks};
use super::svg::{Axes, Drawing, Figure, Scale, Sign, Stroke, color};
use super::table::table;
use super::{OutputError, finite};
use crate::scenario::{Measure, Scenario, Spacing, Suite, shown};
use crate::studies::ending::Verdict;
use crate::studies::fragility::{Errors, Fragility, NoFit};
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
pub fn write_fragility(
    writer: impl Write,
    heading: &Heading,
    results: &SuiteFragility,
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the fragility";
    let mut csv = table(writer);
    let columns = [
        results.measure.column(),
        "cases",
        "overturned",
        "still_rocking",
        "failed",
        "fraction",
        "probability",
        "probability_low",
        "probability_high",
    ];
    let free_hinges = heading.has_free_hinges();
    let uncertain = UNCERTAIN_COLUMNS.into_iter().filter(|_| free_hinges);
    csv.write_record(columns.into_iter().chain(uncertain))
        .map_err(OutputError::csv(WHAT))?;
    for level in &results.levels {
        let FragilityRow {
            intensity,
            cases,
            overturned,
            uncertain,
            still_rocking,
            failed,
            curve,
            curve_with_uncertain,
        } = *level;
        let with_uncertain = (
            uncertain,
            level.fraction_with_uncertain(),
            numbers(curve_with_uncertain)?,
        );
        csv.serialize((
            (intensity, cases, overturned, still_rocking, failed),
            level.fraction(),
            numbers(curve)?,
            free_hinges.then_some(with_uncertain).as_slice(),
        ))
        .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// What rows of blocks have besides: the number of uncertain cases, and what counts them as overturned.
const UNCERTAIN_COLUMNS: [&str; 5] = [
    "uncertain",
    "fraction_with_uncertain",
    "probability_with_uncertain",
    "probability_with_uncertain_low",
    "probability_with_uncertain_high",
];

/// The probability of a curve at a level and its band, if there is a curve.
fn numbers(curve: Option<CurvePoint>) -> Result<[Option<f64>; 3], OutputError> {
    let Some(CurvePoint {
        probability,
        low,
        high,
    }) = curve
    else {
        return Ok([None; 3]);
    };
    let numbers = [probability, low, high];
    finite("of a row of fragility.csv", &numbers)?;
    Ok(numbers.map(Some))
}

/// The fragility as JSON. Missing values are null.
///
/// # Errors
/// When a value is not finite.
pub fn to_json(heading: &Heading, results: &SuiteFragility) -> Result<Value, OutputError> {
    let total =
        |count: fn(&FragilityRow) -> usize| -> usize { results.levels.iter().map(count).sum() };
    let mut json = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": heading.scenario,
        "intensity": results.measure.column(),
    });
    let curve = curve_to_json(&results.fit)?;
    if let (Some(json), Value::Object(curve)) = (json.as_object_mut(), curve) {
        json.extend(curve);
    }
    let counts = [
        ("records", results.record_count()),
        ("cases", total(|level| level.cases)),
        ("overturned", total(|level| level.overturned)),
        ("uncertain", total(|level| level.uncertain)),
        (
            "still_rocking_counted_as_not_overturned",
            total(|level| level.still_rocking),
        ),
        ("failed_left_out", total(|level| level.failed)),
    ];
    for (name, count) in counts {
        json[name] = json!(count);
    }
    json["mirrored_cases_count"] = json!(results.mirrored_count);
    json["records_that_never_overturn"] = json!(results.always(Verdict::Survives));
    json["records_that_always_overturn"] = json!(results.always(Verdict::Overturns));
    if results.has_uncertain() {
        json["with_uncertain_as_overturned"] = curve_to_json(&results.fit_with_uncertain)?;
    }
    remarks(results).add_to(&mut json);
    Ok(json)
}

/// A curve with its standard errors, or why there is none.
fn curve_to_json(fit: &Result<Fragility, NoFit>) -> Result<Value, OutputError> {
    let no_fit = fit.as_ref().err().map(ToString::to_string);
    let fit = fit.as_ref().ok();
    let errors = |errors: Option<&Errors>| {
        errors.map_or([None; 2], |errors| {
            [Some(errors.median), Some(errors.dispersion)]
        })
    };
    let [median_error, dispersion_error] = errors(fit.map(|fit| &fit.independent));
    let [median_error_by_record, dispersion_error_by_record] =
        errors(fit.and_then(|fit| fit.clustered.as_ref()));
    let mut json = json!({});
    for (name, value) in [
        ("median", fit.map(|fit| fit.median)),
        ("median_standard_error", median_error),
        ("median_standard_error_by_record", median_error_by_record),
        ("dispersion", fit.map(|fit| fit.dispersion)),
        ("dispersion_standard_error", dispersion_error),
        (
            "dispersion_standard_error_by_record",
            dispersion_error_by_record,
        ),
        ("log_likelihood", fit.map(|fit| fit.log_likelihood)),
    ] {
        finite("of fragility.json", value.as_slice())?;
        json[name] = json!(value);
    }
    json["no_fit"] = json!(no_fit);
    Ok(json)
}

/// What is to be remarked of the cases: which failed or are uncertain, and why.
#[must_use]
pub fn remarks(results: &SuiteFragility) -> Remarks {
    let mut remarks = Remarks::default();
    for case in &results.cases {
        let name = || {
            let mirrored = if case.mirrored { " mirrored" } else { "" };
            let (column, level) = (results.measure.column(), case.level(results.measure));
            format!("{}{mirrored}, {column} {level:?}", case.record)
        };
        remarks.note(name, case.result.as_ref().map_err(String::as_str));
    }
    remarks
}

/// A curve in words, or why there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CurveInWords {
    /// How uncertain cases are taken: `, 2 uncertain cases taken as survived`; empty where there are none.
    pub taken: String,
    /// The curve, or the reason.
    pub curve: Result<String, String>,
}

/// The curve in words; where cases are uncertain, first with these as survived, then as overturned.
#[must_use]
pub fn curves_in_words(results: &SuiteFragility) -> Vec<CurveInWords> {
    let uncertain: usize = results.levels.iter().map(|level| level.uncertain).sum();
    let curve = |fit: &Result<Fragility, NoFit>, how: &str| CurveInWords {
        taken: match uncertain {
            0 => String::new(),
            1 => format!(", 1 uncertain case taken as {how}"),
            _ => format!(", {uncertain} uncertain cases taken as {how}"),
        },
        curve: match fit {
            Ok(fit) => Ok(fit_in_words(fit, results.measure)),
            Err(reason) => Err(reason.to_string()),
        },
    };
    let mut curves = vec![curve(&results.fit, "survived")];
    if uncertain > 0 {
        curves.push(curve(&results.fit_with_uncertain, "overturned"));
    }
    curves
}

/// A curve in words, with its standard errors, the larger ones last.
fn fit_in_words(fit: &Fragility, measure: Measure) -> String {
    let unit = match measure {
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
    format!(
        "median {}, dispersion {}",
        quantity(fit.median, |errors| errors.median, unit),
        quantity(fit.dispersion, |errors| errors.dispersion, "")
    )
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
    let curves = curves(results);
    draw_bands(&mut drawing, &axes, &curves);
    let label = intensity_label(results.measure);
    axes.draw(&mut drawing, Some(label), "fraction that overturns");
    for (fit, look) in &curves {
        let curve = along(&axes.x).map(|x| axes.place(x, fit.probability(x)));
        drawing.curve(look.name, curve, look.line);
    }
    for level in &results.levels {
        let fractions = level.fraction().zip(level.fraction_with_uncertain());
        let Some((certain, possible)) = fractions else {
            continue;
        };
        let [low, high] = [certain, possible].map(|part| axes.place(level.intensity, part));
        if possible > certain {
            drawing.curve("uncertain", [low, high], POINT);
            drawing.circle("fraction-with-uncertain", high, 4.5, POINT);
        }
        drawing.circle("fraction", low, 4.5, POINT);
    }
    drawing.finish(axes.frame.top + axes.frame.height + 56.0)
}

/// How a curve is drawn.
struct Look {
    name: &'static str,
    label: &'static str,
    line: Stroke,
}

const CURVE: Look = Look {
    name: "fit",
    label: "lognormal curve",
    line: Stroke::new(color::BLUE, 2.0, ""),
};
const CURVE_WITH_UNCERTAIN: Look = Look {
    name: "fit-with-uncertain",
    label: "the same with uncertain cases as overturned",
    line: Stroke::new(color::BLUE, 2.0, "7 4"),
};

/// The curves that are drawn: with uncertain cases as survived, and, where there are such, as overturned.
fn curves(results: &SuiteFragility) -> Vec<(&Fragility, Look)> {
    let with_uncertain = (&results.fit_with_uncertain, CURVE_WITH_UNCERTAIN);
    let with_uncertain = results.has_uncertain().then_some(with_uncertain);
    [(&results.fit, CURVE)]
        .into_iter()
        .chain(with_uncertain)
        .filter_map(|(fit, look)| Some((fit.as_ref().ok()?, look)))
        .collect()
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

/// What is drawn, and the curves in words or why there are none; returns where that ends.
fn legend(drawing: &mut Drawing, figure: Figure, top: f64, results: &SuiteFragility) -> f64 {
    let cases: usize = results.levels.iter().map(|level| level.cases).sum();
    let text = format!("fraction of {}, {cases} cases", records_in_words(results));
    let mut keys = vec![(text.as_str(), Sign::Circle(4.5, POINT))];
    let curves = curves(results);
    let lines = curves.iter();
    keys.extend(lines.map(|(_, look)| (look.label, Sign::Line(look.line))));
    if curves.len() > 1 {
        keys.push(("between these", Sign::Band(BETWEEN, 1.0)));
    }
    if !curves.is_empty() {
        keys.push(("95 % band", Sign::Band(BAND, 1.0)));
    }
    let top = drawing.legend(figure.plot(0.0, 0.0).left, top, &keys);
    let words = curves_in_words(results).into_iter();
    let words = words.map(|CurveInWords { taken, curve }| match curve {
        Ok(curve) => format!("{curve}{taken}"),
        Err(reason) => format!("no curve: {reason}{taken}"),
    });
    let words: Vec<String> = words.collect();
    drawing.caption(top + 14.0, &words.join("; ")) + 10.0
}

const POINT: Stroke = Stroke::new(color::VERMILION, 1.8, "");
const BAND: &str = "#d6e8f4";
const BETWEEN: &str = "#9cc7e3";

/// So many points make a smooth curve.
const POINTS: u32 = 200;

/// Values along an axis, above zero.
fn along(scale: &Scale) -> impl Iterator<Item = f64> {
    let scale = *scale;
    (0..=POINTS)
        .map(move |i| scale.at(f64::from(i) / f64::from(POINTS)))
        .filter(|x| *x > 0.0)
}

/// The band of 95 % of the curves together, and the one between them.
fn draw_bands(drawing: &mut Drawing, axes: &Axes, curves: &[(&Fragility, Look)]) {
    let mut fill = |name: &str, color: &'static str, ends: &dyn Fn(f64) -> [f64; 2]| {
        let (low, mut high): (Vec<_>, Vec<_>) = along(&axes.x)
            .map(|x| {
                let [low, high] = ends(x).map(|probability| axes.place(x, probability));
                (low, high)
            })
            .unzip();
        high.reverse();
        let corners = low.into_iter().chain(high);
        drawing.polygon(name, corners, color, Stroke::new(color, 0.0, ""));
    };
    if curves.is_empty() {
        return;
    }
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([1.0, 0.0], |[low, high]: [f64; 2], value| {
            [low.min(value), high.max(value)]
        })
    };
    fill("band", BAND, &|x| {
        let bands = curves.iter();
        range(&mut bands.flat_map(|(fit, _)| <[f64; 2]>::from(fit.band(x))))
    });
    if curves.len() > 1 {
        fill("between", BETWEEN, &|x| {
            range(&mut curves.iter().map(|(fit, _)| fit.probability(x)))
        });
    }
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
