//! Reports ensembles: their tables, JSON and words.

use serde::Serialize;
use serde_json::{Value, json};

use super::edges::{FirstStrength, ProbabilityAt};
use super::histories::{BandAt, Histories, Went};
use super::matters::Matters;
use super::records::{AtLevel, Capacities, Capacity, Fragilities};
use super::{NoAnswer, Told, picture};
use crate::output::table::{Cell, Column, column, csv, several};
use crate::output::{Figure, OutputError, pretty};
use crate::scenario::{Uncertain, UncertainKey, shown};
use crate::studies::ending::columns::{self, UNCERTAIN, yes};
use crate::studies::remarks::warnings;
use crate::studies::results::Results;
use crate::studies::statistics::{Share, band, fractile};
use crate::studies::threshold::first_edge::FirstEdge;
use crate::studies::threshold::{rounded, rounded_range};

pub(super) const SUMMARY: &str = "uncertain.json";

/// A row of the table of samples: its number, from 1, or 0 for the scenario itself; its values; and its answer.
struct Line<'a, A> {
    number: usize,
    values: Vec<Option<f64>>,
    answer: &'a Result<A, NoAnswer>,
}

/// The scenario itself, then all samples.
fn lines<'a, A>(told: &Told<'a, A>) -> Vec<Line<'a, A>> {
    let own = Line {
        number: 0,
        values: told.uncertain.keys.iter().map(|key| key.own).collect(),
        answer: told.own,
    };
    let samples = told.samples.iter().zip(1..).map(|(row, number)| Line {
        number,
        values: row.values.iter().copied().map(Some).collect(),
        answer: &row.answer,
    });
    [own].into_iter().chain(samples).collect()
}

/// The columns with the numbers of the samples and their values.
fn sample_columns<'a, A: 'a>(uncertain: &Uncertain) -> Vec<Column<'a, Line<'a, A>>> {
    let names: Vec<String> = uncertain.keys.iter().map(|key| key.key.clone()).collect();
    vec![
        column("sample", |line: &Line<'_, A>| line.number),
        several(names, |line: &Line<'_, A>, cells: &mut Vec<Cell<'_>>| {
            cells.extend(line.values.iter().map(|value| Cell::from(*value)));
        }),
    ]
}

/// How much each uncertain number, given by its key, matters for an answer.
pub(super) struct Decides<'a> {
    /// The answer, in words that follow "decides 60 % of".
    pub(super) what: &'static str,
    /// Its name in JSON.
    name: &'static str,
    /// Each number, in the order of the keys; `None` if nothing can be said.
    pub(super) of: Option<Vec<(&'a UncertainKey, Matters)>>,
}

impl<'a> Decides<'a> {
    pub(super) fn new<A>(
        told: &Told<'a, A>,
        [name, what]: [&'static str; 2],
        by_rank: bool,
        number: impl Fn(&A) -> f64,
    ) -> Self {
        let of = told.what_matters(by_rank, number);
        let keys = &told.uncertain.keys;
        Self {
            what,
            name,
            of: of.map(|of| keys.iter().zip(of).collect()),
        }
    }

    /// The end of the first sentence of every study: what decides, and what was not considered.
    pub(super) fn ending(&self, uncertain: &Uncertain) -> String {
        let decided = self.in_words(uncertain).unwrap_or_else(|| {
            format!(
                "what decides {} cannot be said: the samples are alike, or too few",
                self.what
            )
        });
        format!(";\n    {decided};\n    {NOT_CONSIDERED}")
    }

    /// `friction coefficient decides 60 % (95 %: 51 % to 67 %) of the first factor that overturns, thickness ratio 25 % (...)`. What is
    /// left is decided by several numbers together, unless the intervals allow that nothing is left.
    fn in_words(&self, uncertain: &Uncertain) -> Option<String> {
        const LEAST: f64 = 0.05;
        let mut of: Vec<_> = self.of.as_ref()?.iter().collect();
        of.sort_by(|a, b| b.1.first_order.total_cmp(&a.1.first_order));
        if let [(key, _)] = of[..] {
            let name = spoken(&key.key, uncertain);
            return Some(format!("{name} alone decides {}", self.what));
        }
        let known: f64 = of.iter().map(|(_, matters)| matters.first_order).sum();
        let at_most: f64 = of
            .iter()
            .map(|(_, matters)| matters.first_order_interval[1])
            .sum();
        let matter = of
            .iter()
            .filter(|(_, matters)| matters.first_order >= LEAST);
        let mut words = matter.map(|(key, matters)| {
            let name = spoken(&key.key, uncertain);
            let [low, high] = matters.first_order_interval.map(percent);
            let share = percent(matters.first_order);
            (name, format!("{share} (95 %: {low} to {high})"))
        });
        let Some((first, share)) = words.next() else {
            return Some(format!(
                "no number alone decides {}: several together do, or chance",
                self.what
            ));
        };
        let others: String = words
            .map(|(name, share)| format!(", {name} {share}"))
            .collect();
        let together = if known < 1.0 - LEAST {
            let chance = if at_most < 1.0 { "" } else { ", or by chance" };
            let left = percent(1.0 - known);
            format!("; {left} is decided by several together{chance}")
        } else {
            String::new()
        };
        Some(format!(
            "{first} decides {share} of {}{others}{together}",
            self.what
        ))
    }

    pub(super) fn to_json(&self) -> (&'static str, Value) {
        #[derive(Serialize)]
        struct Of<'a> {
            key: &'a str,
            #[serde(flatten)]
            matters: Matters,
        }
        let of = self.of.as_ref().map(|of| {
            let of = of.iter().map(|(key, matters)| {
                json!(Of {
                    key: &key.key,
                    matters: *matters,
                })
            });
            of.collect::<Vec<_>>()
        });
        (self.name, json!(of))
    }
}

/// A key in spoken form: `thickness ratio` for `arch.thickness_ratio`, if no other key has the same last part.
pub(super) fn spoken(key: &str, uncertain: &Uncertain) -> String {
    const UNITS: [&str; 12] = [
        "_m_s2", "_kg_m3", "_gpa_m", "_mpa", "_gpa", "_rad", "_deg", "_hz", "_kn", "_m", "_s", "_g",
    ];
    let last = |key: &str| -> String {
        let last = key.rsplit('.').next().unwrap_or(key).trim();
        let unit = UNITS.iter().find_map(|unit| last.strip_suffix(unit));
        unit.unwrap_or(last).replace('_', " ")
    };
    let own = last(key);
    let alike = uncertain
        .keys
        .iter()
        .filter(|other| last(&other.key) == own);
    if alike.count() > 1 {
        key.to_owned()
    } else {
        own
    }
}

pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 0.0 && percent < 9.95 || percent > 90.05 && percent < 100.0 {
        format!("{percent:.1} %")
    } else {
        format!("{percent:.0} %")
    }
}

fn share_in_words(share: &Share) -> String {
    let Share {
        count,
        of,
        share,
        low,
        high,
    } = share;
    format!(
        "{} (95 %: {} to {}), {count} of {of} samples",
        percent(*share),
        percent(*low),
        percent(*high)
    )
}

/// The uncertainty that samples do not cover.
pub(super) const NOT_CONSIDERED: &str = "not considered: numbers that [uncertain] does not name, other ground motions, and the model of motion itself";

/// The first part of the JSON of every ensemble.
pub(super) fn beginning<A>(told: &Told<'_, A>) -> Value {
    let reasons = told.samples.iter().zip(1..).filter_map(|(row, sample)| {
        let reason = row.answer.as_ref().err()?;
        Some(json!({ "sample": sample, "why": reason.name(), "reason": reason.reason() }))
    });
    json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": told.scenario.to_json(),
        "warnings": warnings(told.scenario).into_iter().chain(told.no_verdict()).collect::<Vec<_>>(),
        "samples": told.samples.len(),
        "answered": told.answered().count(),
        "invalid": told.without("invalid"),
        "failed": told.without("failed"),
        "incomplete": told.without("incomplete"),
        "without_answer": reasons.collect::<Vec<_>>(),
        "not_considered": NOT_CONSIDERED,
    })
}

/// How many samples have no answer, and why the first of them has none.
pub(super) fn without_answer<A>(told: &Told<'_, A>) -> Vec<String> {
    let all = [
        (
            "invalid",
            "make no structure that stands, and are left out of the shares",
        ),
        (
            "failed",
            "could not be computed, and are left out of the shares",
        ),
    ];
    let words = all.into_iter().filter_map(|(name, what)| {
        let mut reasons = told
            .samples
            .iter()
            .filter_map(|row| row.answer.as_ref().err());
        let first = reasons.find(|reason| reason.name() == name)?;
        let count = told.without(name);
        Some(format!(
            "{count} of {} samples {what}; the first: {}",
            told.samples.len(),
            first.reason()
        ))
    });
    words.chain(told.no_verdict()).collect()
}

/// Replaces infinite values by null.
fn finite(values: [f64; 3]) -> [Option<f64>; 3] {
    values.map(|value| value.is_finite().then_some(value))
}

/// The quantiles of the answers in JSON, by their names.
pub(super) fn band_to_json(band: Option<[f64; 3]>) -> Value {
    let [low, median, high] = band.map_or([None; 3], finite);
    json!({ "quantile_05": low, "median": median, "quantile_95": high })
}

/// Files and words that report how histories proceed and end.
pub(super) fn histories(
    told: &Told<'_, Went>,
    asked: &Histories,
    figure: Figure,
) -> Result<Results, OutputError> {
    let bands = told.bands(asked);
    let outcomes = told.outcomes();
    let peaks: Vec<f64> = told.answered().map(|(_, went)| went.peak_rad()).collect();
    let names = ["overturning", "whether it overturns"];
    let overturning = Decides::new(told, names, false, Went::overturned);
    // A sample that overturned has no largest rotation, but it ranks above all others.
    let names = ["peak_rotation_rank", "how far it rocks"];
    let far = Decides::new(told, names, true, Went::peak_rad);
    let decides = [overturning, far];
    let mut json = beginning(told);
    let shares = outcomes
        .0
        .iter()
        .map(|(name, share)| ((*name).to_owned(), json!(share)));
    json["outcomes"] = Value::Object(shares.collect());
    json["peak_rotation_rad"] = band_to_json(band(peaks, fractile));
    json["followed_body"] = json!(asked.body);
    json["what_matters"] = Value::Object(
        decides
            .iter()
            .map(|one| {
                let (name, of) = one.to_json();
                (name.to_owned(), of)
            })
            .collect(),
    );
    let has_joints = told.scenario.motion().hinges().has_joints();
    let mut all = sample_columns(told.uncertain);
    all.extend(columns::columns(has_joints, |line: &Line<'_, Went>| {
        let went = line.answer.as_ref();
        went.map(|went| &went.ending).map_err(NoAnswer::name)
    }));
    if has_joints {
        all.push(column(
            "peak_potential_over_barrier",
            |line: &Line<'_, Went>| {
                line.answer
                    .as_ref()
                    .ok()
                    .and_then(|went| went.potential_over_barrier)
            },
        ));
    } else {
        all.push(column("peak_rotation_rad", |line: &Line<'_, Went>| {
            line.answer.as_ref().ok().map(|went| went.peak_rotation_rad)
        }));
    }
    let mut lines_of_words = vec![first_of_histories(told, &decides)];
    for (name, share) in &outcomes.0 {
        if share.count > 0 {
            lines_of_words.push(format!(
                "{}: {}",
                name.replace('_', " "),
                share_in_words(share)
            ));
        }
    }
    lines_of_words.push(far_in_words(told));
    lines_of_words.extend(without_answer(told));
    Ok(Results {
        peaks: told.answered().map(|(_, went)| went.peak_rad()).collect(),
        files: vec![
            (
                "bands.svg",
                picture::bands(figure, told, &bands, asked).into_bytes(),
            ),
            (
                "matters.svg",
                picture::matters(figure, told, &decides).into_bytes(),
            ),
            ("bands.csv", csv(band_columns(), &bands)?),
            ("samples.csv", csv(all, &lines(told))?),
            (SUMMARY, pretty(&json).into_bytes()),
        ],
        words: lines_of_words.join("\n  "),
        summary: json,
    })
}

fn band_columns() -> Vec<Column<'static, BandAt>> {
    vec![
        column("time_s", |at: &BandAt| at.time_s),
        column("own_rad", |at: &BandAt| at.own_rad),
        column("quantile_05_rad", |at: &BandAt| finite(at.band_rad)[0]),
        column("median_rad", |at: &BandAt| finite(at.band_rad)[1]),
        column("quantile_95_rad", |at: &BandAt| finite(at.band_rad)[2]),
        column("overturned", |at: &BandAt| at.overturned),
    ]
}

/// The sentence that sums it all up.
fn first_of_histories(told: &Told<'_, Went>, decides: &[Decides<'_>; 2]) -> String {
    let counts = |went: &&Went| went.ending.outcome_name() == "overturned";
    let overturned = told.answered().map(|(_, went)| went).filter(counts).count();
    let Some(share) = Share::of(overturned, told.answered().count()) else {
        return "no sample has an answer".to_owned();
    };
    // Rounded down, as in `run`, so that a value just below 100 % does not read as 100 %.
    let down = |part: f64| format!("{:.1} %", (1000.0 * part).floor() / 10.0);
    let own = match told.own {
        Ok(went) => match went.ending.outcome_name() {
            "overturned" => "overturns".to_owned(),
            UNCERTAIN => "is uncertain".to_owned(),
            _ => {
                let margin = went
                    .ending
                    .peak
                    .over_critical()
                    .map(|part| (part, "rotation"));
                let margin = margin.or(went.potential_over_barrier.map(|part| (part, "energy")));
                margin.map_or("stands".to_owned(), |(part, what)| {
                    format!(
                        "stands, at {} of the {what} from which it would overturn",
                        down(part)
                    )
                })
            }
        },
        Err(_) => "has no answer".to_owned(),
    };
    // Where all samples end alike, how far they rock may still be decided by something.
    let [whether, far] = decides;
    let decides = if whether.of.is_some() { whether } else { far };
    format!(
        "overturns with a probability of {} of [uncertain];\n    the scenario itself {own}{}",
        share_in_words(&share),
        decides.ending(told.uncertain)
    )
}

/// How far the samples rock, in words.
fn far_in_words(told: &Told<'_, Went>) -> String {
    let number = |value: f64| {
        if value.is_finite() {
            format!("{value:.4} rad")
        } else {
            "overturning".to_owned()
        }
    };
    let peaks: Vec<f64> = told.answered().map(|(_, went)| went.peak_rad()).collect();
    match band(peaks, fractile) {
        Some([low, median, high]) => format!(
            "largest rotation: median {}; 5 to 95 %: {} to {}",
            number(median),
            number(low),
            number(high)
        ),
        None => "largest rotation: not known".to_owned(),
    }
}

/// Files and words for the first factors that overturn.
pub(super) fn edges(told: &Told<'_, FirstEdge>, figure: Figure) -> Result<Results, OutputError> {
    let probabilities = told.probabilities();
    // A sample that never overturns counts with the largest factor tried.
    let strength = |edge: &FirstEdge| edge.factor.unwrap_or(edge.tried_to);
    let names = ["first_factor", "the first factor that overturns"];
    let decides = [Decides::new(told, names, false, strength)];
    let at_one = told.share_up_to(1.0);
    let mut json = beginning(told);
    let band = told.band();
    json["first_factor"] = band_to_json(band.map(|band| band.map(|one| one.strength)));
    // The numbers of samples whose first factor is only known to be at most, or beyond, what was tried.
    let count = |wanted: fn(&FirstEdge) -> bool| {
        let edges = told.answered().map(|(_, edge)| edge);
        edges.filter(|edge| wanted(edge)).count()
    };
    json["at_smallest_factor"] = json!(count(|edge| edge.at_most));
    json["beyond_largest_factor"] = json!(count(|edge| edge.factor.is_none()));
    json["own_first_factor"] = json!(told.own.as_ref().ok().and_then(|edge| edge.factor));
    json["overturned_up_to_factor_1"] = json!(at_one);
    let (name, of) = decides[0].to_json();
    json["what_matters"] = json!({ name: of });
    let mut all = sample_columns(told.uncertain);
    type Of = fn(&FirstEdge) -> Option<f64>;
    let numbers: [(&str, Of); 3] = [
        ("first_factor", |edge| edge.factor),
        ("tried_to", |edge| Some(edge.tried_to)),
        ("uncertain_from", |edge| edge.uncertain_from),
    ];
    for (name, of) in numbers {
        all.push(column(name, move |line: &Line<'_, FirstEdge>| {
            line.answer.as_ref().ok().and_then(of)
        }));
    }
    all.push(column("at_most", |line: &Line<'_, FirstEdge>| {
        line.answer.as_ref().ok().map(|edge| yes(edge.at_most))
    }));
    all.push(column("why_not", |line: &Line<'_, FirstEdge>| {
        line.answer.as_ref().err().map(NoAnswer::name)
    }));
    let mut words = vec![first_of_edges(told, &decides[0])];
    words.extend(without_answer(told));
    Ok(Results {
        files: vec![
            (
                "probability.svg",
                picture::probability(figure, told, &probabilities).into_bytes(),
            ),
            (
                "matters.svg",
                picture::matters(figure, told, &decides).into_bytes(),
            ),
            (
                "probability.csv",
                csv(probability_columns(), &probabilities)?,
            ),
            ("samples.csv", csv(all, &lines(told))?),
            (SUMMARY, pretty(&json).into_bytes()),
        ],
        words: words.join("\n  "),
        summary: json,
        ..Results::default()
    })
}

fn probability_columns() -> Vec<Column<'static, ProbabilityAt>> {
    vec![
        column("factor", |at: &ProbabilityAt| at.factor),
        column("probability", |at: &ProbabilityAt| at.share.share),
        column("probability_low", |at: &ProbabilityAt| at.share.low),
        column("probability_high", |at: &ProbabilityAt| at.share.high),
    ]
}

fn first_of_edges(told: &Told<'_, FirstEdge>, decides: &Decides<'_>) -> String {
    let Some([low, median, high]) = told.band() else {
        return "no sample has an answer".to_owned();
    };
    let tried_to = told
        .answered()
        .map(|(_, edge)| edge.tried_to)
        .fold(0.0, f64::max);
    let beyond = format!("beyond {}", rounded(tried_to));
    let factor = |factor: FirstStrength| factor.in_words("", &beyond);
    let probability = told.share_up_to(1.0).map_or(
        "overturns with a probability that is not known up to the factor 1, which is outside the factors that were tried"
            .to_owned(),
        |at_one| {
            format!(
                "overturns up to the factor 1 with a probability of {}",
                share_in_words(&at_one)
            )
        },
    );
    let own = match told.own {
        Ok(edge) => match edge.factor {
            Some(own) => {
                let at_most = if edge.at_most { "at or below" } else { "at" };
                format!("the scenario itself {at_most} {}", rounded(own))
            }
            None => "the scenario itself at none that was tried".to_owned(),
        },
        Err(_) => "the scenario itself has no answer".to_owned(),
    };
    format!(
        "{probability};\n    half of the samples first overturn {} (5 %: {}, 95 %: {}), {own}{}",
        factor(median),
        factor(low),
        factor(high),
        decides.ending(told.uncertain)
    )
}

/// With which probability records overturn, and how much stronger those are that overturn half of the cases.
fn first_of_capacities(
    told: &Told<'_, Capacity>,
    asked: &Capacities,
    fragilities: &Fragilities,
) -> String {
    let column = asked.measure().column();
    let [own, all] = told.counted(asked);
    let at = |part: f64, of: &[&FirstEdge], column: &str| {
        let found = FirstStrength::of(of.iter().copied(), part);
        let unknown = "nowhere up to the highest level";
        found.map_or(unknown.to_owned(), |found| found.in_words(column, unknown))
    };
    let column = format!("{} ", column);
    format!(
        "overturns with a probability of 5 % {}, of 50 % {} (dispersion {}), over records and {} samples of [uncertain];\n    \
         the scenario itself with 5 % {}, with 50 % {}",
        at(0.05, &all, &column),
        at(0.5, &all, ""),
        fragilities
            .both
            .of
            .dispersion
            .map_or("not known".to_owned(), rounded),
        told.samples.len(),
        at(0.05, &own, ""),
        at(0.5, &own, "")
    )
}

/// A row of the table of capacities.
struct Reached<'a> {
    sample: usize,
    record: &'a str,
    mirrored: bool,
    edge: &'a FirstEdge,
}

/// Files and words for the intensities from which records overturn.
pub(super) fn capacities(
    told: &Told<'_, Capacity>,
    asked: &Capacities,
    figure: Figure,
) -> Result<Results, OutputError> {
    let fragilities = told.fragilities(asked);
    let levels = told.at_levels(asked);
    // The median over the records for each sample; the largest level if half of the records do not overturn the sample.
    let most = asked.levels().last().copied().unwrap_or(1.0);
    let median = |capacity: &Capacity| {
        let median = FirstStrength::of(capacity.0.iter(), 0.5);
        median.map_or(most, |median| median.strength.min(most))
    };
    let names = ["median_intensity", "the median intensity that overturns"];
    let decides = [Decides::new(told, names, false, median)];
    let column_name = asked.measure().column();
    let mut json = beginning(told);
    json["intensity"] = json!(column_name);
    json["fragility"] = fragilities.to_json();
    let [_, counted] = told.counted(asked);
    let at_lowest = counted.iter().filter(|edge| edge.at_most).count();
    json["at_lowest_level"] = json!(at_lowest);
    let (name, of) = decides[0].to_json();
    json["what_matters"] = json!({ name: of });
    let reached = lines(told);
    let reached: Vec<Reached<'_>> = reached
        .iter()
        .flat_map(|line| {
            let edges = line.answer.iter().flat_map(|capacity| &capacity.0);
            edges
                .zip(asked.shakes())
                .map(|(edge, (record, mirrored))| Reached {
                    sample: line.number,
                    record,
                    mirrored,
                    edge,
                })
        })
        .collect();
    let of_edges: [Column<'_, Reached<'_>>; 7] = [
        column("sample", |row: &Reached<'_>| row.sample),
        column("record", |row: &Reached<'_>| shown(row.record)),
        column(
            "sign",
            |row: &Reached<'_>| if row.mirrored { "-1" } else { "1" },
        ),
        column("intensity", |row: &Reached<'_>| row.edge.factor),
        column("tried_to", |row: &Reached<'_>| row.edge.tried_to),
        column("uncertain_from", |row: &Reached<'_>| {
            row.edge.uncertain_from
        }),
        column("at_most", |row: &Reached<'_>| yes(row.edge.at_most)),
    ];
    let at_levels: [Column<'_, AtLevel>; 3] = [
        column(column_name, |at: &AtLevel| at.intensity),
        column("record_to_record", |at: &AtLevel| at.records),
        column("both", |at: &AtLevel| at.both),
    ];
    let mut all = sample_columns(told.uncertain);
    all.push(column("overturned", |line: &Line<'_, Capacity>| {
        let capacity = line.answer.as_ref().ok();
        capacity.map(|capacity| {
            capacity
                .0
                .iter()
                .filter(|edge| edge.factor.is_some())
                .count()
        })
    }));
    all.push(column("why_not", |line: &Line<'_, Capacity>| {
        line.answer.as_ref().err().map(NoAnswer::name)
    }));
    let rounded_or = |number: Option<f64>| number.map_or("not known".to_owned(), rounded);
    let interval = |ends: Option<[f64; 2]>| match ends {
        Some(ends) => {
            let [low, high] = rounded_range(ends);
            format!(" ({low} to {high})")
        }
        None => String::new(),
    };
    let distributions = fragilities.all().map(|(name, estimated)| {
        format!(
            "{}: median {}{}, dispersion {}{}",
            name.replace('_', " "),
            rounded_or(estimated.of.median),
            interval(estimated.median),
            rounded_or(estimated.of.dispersion),
            interval(estimated.dispersion)
        )
    });
    let mut words = vec![format!(
        "{}{}",
        first_of_capacities(told, asked, &fragilities),
        decides[0].ending(told.uncertain)
    )];
    words.extend(distributions);
    words.push(
        "median and dispersion are those of the fractiles (16, 50 and 84 %) of the intensities at which a record first overturns;\n    \
         record to record: of the scenario itself; uncertain data: of the median over the records of each sample; both: of all samples;\n    \
         in brackets: 95 % by bootstrap over records"
            .to_owned(),
    );
    words.extend((at_lowest > 0).then(|| {
        format!(
            "{at_lowest} of {} records and samples overturn at the lowest level already, which counts as their intensity: the \
             fractiles may be lower",
            counted.len()
        )
    }));
    words.extend(without_answer(told));
    Ok(Results {
        files: vec![
            (
                "fragility.svg",
                picture::fragility(figure, told, asked).into_bytes(),
            ),
            (
                "matters.svg",
                picture::matters(figure, told, &decides).into_bytes(),
            ),
            ("fragility.csv", csv(at_levels, &levels)?),
            ("capacities.csv", csv(of_edges, &reached)?),
            ("samples.csv", csv(all, &lines(told))?),
            (SUMMARY, pretty(&json).into_bytes()),
        ],
        words: words.join("\n  "),
        summary: json,
        ..Results::default()
    })
}
