//! Quotes of samples, and samples outside the model of four links.

use std::fs;

use archrock::dynamics::MODEL_LIMIT;
use archrock::studies::ensemble::NoAnswer;
use serde_json::Value;

use super::uncertain::histories;
use crate::common::parsed;
use crate::common::program::{done, printed, scenarios};
use crate::common::prose::shows;
use crate::common::results::{Table, json};

/// A block whose width is known to 6 %: half of the samples do not survive the threshold of the given width.
const BLOCK: &str = "[column]\nheight_m = 4\nwidth_m = 0.8\n[ground.rectangular]\namplitude_g = 0.35\nduration_s = 0.45\n\
    [simulation]\nduration_s = 10.0\n[uncertain]\n'column.width_m' = { deviation = 0.05 }\n";

/// The probability that at most `most` of `count` values are below the fractile of 5 %.
fn binomial(count: u32, most: u32) -> f64 {
    let mut term = 0.95_f64.powi(count.try_into().unwrap());
    let mut sum = 0.0;
    for number in 0..=most {
        sum += term;
        term *= f64::from(count - number) / f64::from(number + 1) * 0.05 / 0.95;
    }
    sum
}

/// The quote of samples is the lowest, second lowest, ... factor that is below the fractile of 5 % with a confidence of 95 %; 58 samples give none.
#[test]
fn a_threshold_of_samples_quotes_the_limit_of_the_fractile() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let factors = ["--from", "0.3", "--to", "2", "--stride", "0.2"];
    for samples in [58_u32, 93] {
        let text = BLOCK.replace("[uncertain]", &format!("[uncertain]\nsamples = {samples}"));
        fs::write(at.join("s.toml"), text).unwrap();
        let out = samples.to_string();
        let arguments = [&["threshold", "s.toml", "--out", &out][..], &factors].concat();
        let said = printed(at, &arguments);
        let own = json(&at.join(&out).join("threshold.json"));
        let quote = |of: &Value| of["to_quote"].as_str().unwrap().to_owned();
        assert!(quote(&own).contains("no answer with one rigid block: its numbers are uncertain"));
        let results = at.join(&out).join("uncertain_threshold");
        let summary = json(&results.join("uncertain.json"));
        assert!(said.contains(&quote(&summary)), "{said}");
        let rank = summary["rank_of_limit"].as_u64();
        if samples == 58 {
            assert_eq!((rank, &summary["lower_limit_factor"]), (None, &Value::Null));
            assert!(quote(&summary).contains("give at least 59"), "{said}");
            continue;
        }
        let rank = u32::try_from(rank.unwrap()).unwrap();
        assert!(binomial(samples, rank - 1) <= 0.05 && binomial(samples, rank) > 0.05);
        let table = Table::read(results.join("samples.csv"));
        let mut safe: Vec<f64> = table.numbers("survives_up_to")[1..].to_vec();
        safe.sort_by(f64::total_cmp);
        let limit = summary["lower_limit_factor"].as_f64().unwrap();
        assert_eq!(limit, safe[rank as usize - 1]);
        assert!(limit < own["models"][0]["survives_up_to_factor"].as_f64().unwrap());
        let quote = quote(&summary);
        assert!(
            quote.contains(&format!("sample {rank} of {samples}, the weakest first")),
            "{quote}"
        );
        shows(&quote, &[95.0]);
    }
}

/// Samples of an arch whose thrust line leaves it too far have no verdict. They count in the interval of the probability only, and the interval comes
/// first. Free hinges overturn 68 % of these samples.
#[test]
fn samples_outside_the_model_have_no_verdict() {
    let text = "[arch]\nmean_radius_m = 4.0\nthickness_ratio = 0.16\nembrace_deg = 160.0\nvoussoirs = 7\n\
         [ground.one_sine]\namplitude_g = 1.0\nduration_s = 0.5\n[uncertain]\nsamples = 60\n\
         'ground.one_sine.amplitude_g' = { deviation = 0.2, distribution = 'lognormal' }\n\
         'arch.thickness_ratio' = { from = 0.152, to = 0.168 }\n";
    let rows = histories(&parsed(text), 2);
    let mut outside = 0;
    for row in &rows[1..] {
        let alone = parsed(&format!(
            "[arch]\nmean_radius_m = 4.0\nthickness_ratio = {:?}\nembrace_deg = 160.0\nvoussoirs = 7\n\
             [ground.one_sine]\namplitude_g = {:?}\nduration_s = 0.5\n",
            row.values[1], row.values[0]
        ));
        let model = alone.model().unwrap();
        let summary = model
            .simulate(alone.ground_motion(), &alone.request(), None)
            .unwrap();
        let is_outside = summary.thrust_excess_ratio().unwrap() > MODEL_LIMIT;
        assert_eq!(row.answer == Err(NoAnswer::OutsideModel), is_outside);
        outside += usize::from(is_outside);
    }
    assert!(outside > 40 && outside < 60, "{outside}");
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("s.toml"), text).unwrap();
    let said = printed(at, &["run", "s.toml", "--out", "o"]);
    let summary = json(&at.join("o/uncertain/uncertain.json"));
    let share = &summary["outcomes"]["overturned"];
    assert_eq!(share["no_verdict"], outside);
    assert_eq!(
        [&summary["outside"], &summary["outside_model"]],
        [outside; 2]
    );
    let [low, high] = ["low", "high"].map(|end| share[end].as_f64().unwrap());
    assert!(low < 0.68 && 0.68 < high, "{share}");
    let first = said
        .lines()
        .find(|line| line.contains("of [uncertain]"))
        .unwrap();
    assert!(
        first.contains("probability of 0 % to") && first.contains("samples with a verdict"),
        "{first}"
    );
    let table = Table::read(at.join("o/uncertain/samples.csv"));
    let without = table.rows[1..]
        .iter()
        .filter(|row| &row["outcome"] == "outside_model");
    assert_eq!(without.count(), outside);
    // Fewer than ten samples overturn, so no influence on overturning is known.
    assert_eq!(summary["what_matters"]["overturning"], Value::Null);
}

/// A median above the highest level is extrapolated, in words and JSON.
#[test]
fn a_median_beyond_the_levels_is_extrapolated() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scenario = scenarios().join("column-suite.toml");
    let scenario = scenario.to_str().unwrap();
    for (to, is_beyond) in [(0.45, true), (2.0, false)] {
        let levels = format!("suite.peaks_g={{ from = 0.2, to = {to}, count = 8 }}");
        let said = done(at, &["suite", scenario, "--out", "o", "--set", &levels]);
        let fragility = json(&at.join("o/fragility.json"));
        assert_eq!(
            fragility["median"].as_f64().unwrap() > to,
            is_beyond,
            "{said}"
        );
        assert_eq!(
            fragility["extrapolated_beyond"].as_f64(),
            is_beyond.then_some(to)
        );
        assert_eq!(
            said.contains("extrapolated beyond the level 0.4500 g"),
            is_beyond,
            "{said}"
        );
    }
}
