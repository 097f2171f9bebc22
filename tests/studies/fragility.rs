//! Fragility curves: compared with published and independent fits, and with samples of known curves.

use std::f64::consts::{LN_10, TAU};

use crate::common::Random;
use archrock::studies::suite::{Errors, Fraction, Fragility, NoFit, Observation, fit, fractions};
use proptest::prelude::*;

/// Cases from counts by intensity, each with its own record.
fn counts(levels: &[(f64, usize, usize)]) -> Vec<Observation> {
    let cases = levels.iter().flat_map(|&(intensity, cases, overturned)| {
        (0..cases).map(move |i| (intensity, i < overturned))
    });
    cases
        .enumerate()
        .map(|(record, (intensity, overturned))| Observation {
            intensity,
            overturned: f64::from(overturned),
            record,
        })
        .collect()
}

fn assert_close(value: f64, reference: f64, relative: f64) {
    assert!(
        (value - reference).abs() <= relative * reference.abs(),
        "{value} {reference}"
    );
}

fn assert_errors(errors: Errors, reference: Errors, relative: f64) {
    assert_close(errors.median, reference.median, relative);
    assert_close(errors.dispersion, reference.dispersion, relative);
}

/// Beetles killed by carbon disulphide, of Bliss (1935): decimal logarithm of the dose in mg/l, number of
/// beetles, number killed.
const BLISS: [(f64, usize, usize); 8] = [
    (1.6907, 59, 6),
    (1.7242, 60, 13),
    (1.7552, 62, 18),
    (1.7842, 56, 28),
    (1.8113, 63, 52),
    (1.8369, 59, 53),
    (1.8610, 62, 61),
    (1.8839, 60, 60),
];

fn beetles() -> Vec<Observation> {
    counts(&BLISS.map(|(dose, cases, killed)| (10_f64.powf(dose), cases, killed)))
}

#[test]
fn the_beetles_of_bliss() {
    let fragility = fit(&beetles()).unwrap();
    // Probit -34.94 + 19.73 dose of Dobson, An Introduction to Generalized Linear Models: to the last
    // printed digit, with standard error 1.48 of the slope.
    let slope = LN_10 / fragility.dispersion;
    assert!((slope - 19.73).abs() < 0.005, "{slope}");
    assert!((slope * fragility.median.log10() - 34.94).abs() < 0.005);
    let slope_error = slope * fragility.independent.dispersion / fragility.dispersion;
    assert!((slope_error - 1.48).abs() < 0.005, "{slope_error}");
    // Deviance 10.12 there: twice the log-likelihood by which the observed fractions themselves are likelier.
    let saturated: f64 = BLISS
        .iter()
        .flat_map(|&(_, cases, killed)| [(killed, cases), (cases - killed, cases)])
        .filter(|(part, _)| *part > 0)
        .map(|(part, all)| part as f64 * (part as f64 / all as f64).ln())
        .sum();
    let deviance = 2.0 * (saturated - fragility.log_likelihood);
    assert!((deviance - 10.12).abs() < 0.005, "{deviance}");

    // The same maximum with forty digits. Ours is within 1e-10 standard errors of it.
    assert_close(fragility.median, 59.000_047_622_339_55, 1e-11);
    assert_close(fragility.dispersion, 0.116_716_989_641_649_2, 1e-11);
    assert_close(fragility.log_likelihood, -185.679_166_779_559, 1e-13);
    let errors = Errors {
        median: 0.513_219_774_126_16,
        dispersion: 0.008_780_180_329_703_7,
    };
    assert_errors(fragility.independent, errors, 1e-10);
}

/// With two levels the curve passes through both fractions.
#[test]
fn two_levels_are_met_exactly() {
    // Quartiles of the normal distribution, and its 80th percentile below: tabulated.
    let quarter = 0.674_489_750_196_081_7;
    let fragility = fit(&counts(&[(0.3, 8, 2), (0.6, 8, 6)])).unwrap();
    assert_close(fragility.median, (0.3_f64 * 0.6).sqrt(), 1e-10);
    assert_close(fragility.dispersion, 2_f64.ln() / (2.0 * quarter), 1e-10);
    assert!((fragility.probability(0.3) - 0.25).abs() < 1e-10);
    assert!((fragility.probability(0.6) - 0.75).abs() < 1e-10);
    let likelihood = 16.0 * 0.25 * 0.25_f64.ln() + 16.0 * 0.75 * 0.75_f64.ln();
    assert_close(fragility.log_likelihood, likelihood, 1e-12);

    // Independent levels: var(eta) = p (1 - p) / (n phi^2) at each.
    let density = (-0.5 * quarter * quarter).exp() / TAU.sqrt();
    let eta_error = (0.25 * 0.75 / 8.0_f64).sqrt() / density;
    let errors = Errors {
        // ln(theta) is (eta_2 ln x_1 - eta_1 ln x_2) / (eta_2 - eta_1); here both levels have the same weight.
        median: fragility.median * fragility.dispersion * eta_error / 2_f64.sqrt(),
        dispersion: fragility.dispersion.powi(2) * 2_f64.sqrt() * eta_error / 2_f64.ln(),
    };
    assert_errors(fragility.independent, errors, 1e-9);

    let fragility = fit(&counts(&[(0.3, 8, 2), (0.6, 5, 4)])).unwrap();
    let slope = (0.841_621_233_572_914_3 + quarter) / 2_f64.ln();
    assert_close(fragility.dispersion, slope.recip(), 1e-10);
    assert_close(fragility.median, 0.3 * (quarter / slope).exp(), 1e-10);
    // At a level the band follows from the cases of that level alone, each of which has its own record. There the scores
    // scatter exactly as independence requires, and the thirteen records add their factor.
    let (low, high) = fragility.band(0.3);
    // Student's quantile of 97.5 % for 12 degrees of freedom, from a table.
    let margin = 2.178_812_829_667 * eta_error * (13.0_f64 / 12.0).sqrt();
    assert!((low - normal(-quarter - margin)).abs() < 1e-9, "{low}");
    assert!((high - normal(-quarter + margin)).abs() < 1e-9, "{high}");
}

/// `ln Phi` from `Phi(-t) = phi(t) int_0^oo exp(-t u - u^2/2) du`, `t >= 0`, by Simpson's rule: accurate to
/// `1e-9` at any distance.
fn log_normal(eta: f64) -> f64 {
    let t = eta.abs();
    let scale = 1.0 + t;
    let integrand = |v: f64| {
        let u = v / scale;
        (-t * u - 0.5 * u * u).exp() / scale
    };
    let (pairs, step) = (1000, 0.015);
    let integral: f64 = (0..pairs)
        .map(|i| {
            let v = 2.0 * step * f64::from(i);
            step / 3.0 * (integrand(v) + 4.0 * integrand(v + step) + integrand(v + 2.0 * step))
        })
        .sum();
    let tail = -0.5 * t * t + (integral / TAU.sqrt()).ln();
    if eta < 0.0 {
        tail
    } else {
        (-tail.exp()).ln_1p()
    }
}

fn normal(eta: f64) -> f64 {
    log_normal(eta).exp()
}

/// A normal deviate (Box and Muller).
fn deviate(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - random.next()).ln()).sqrt();
    radius * (TAU * random.next()).cos()
}

const LEVELS: [f64; 6] = [0.15, 0.22, 0.3, 0.4, 0.55, 0.8];
const MEDIAN: f64 = 0.35;

/// Every record at every level. Each record has its own capacity, which its levels share to the part `shared`
/// of the dispersion.
fn suite(random: &mut Random, records: usize, dispersion: f64, shared: f64) -> Vec<Observation> {
    let own = (dispersion * dispersion - shared * shared).sqrt();
    (0..records)
        .flat_map(|record| {
            let shift = shared * deviate(random);
            LEVELS.map(|intensity| Observation {
                intensity,
                overturned: f64::from(MEDIAN.ln() + shift + own * deviate(random) < intensity.ln()),
                record,
            })
        })
        .collect()
}

#[test]
fn a_large_sample_gives_its_curve_back() {
    let mut random = Random(20);
    for dispersion in [0.2, 0.5, 1.2] {
        let fragility = fit(&suite(&mut random, 20_000, dispersion, 0.0)).unwrap();
        let Errors {
            median: median_error,
            dispersion: dispersion_error,
        } = fragility.independent;
        assert!((fragility.median - MEDIAN).abs() < 3.5 * median_error);
        assert!((fragility.dispersion - dispersion).abs() < 3.5 * dispersion_error);
        // The errors are small enough for a sharp test.
        assert!(median_error < 0.01 * MEDIAN && dispersion_error < 0.02 * dispersion);
        // Independent cases in groups: both kinds of errors are right. Relative error of the robust variance
        // sqrt(2 / G) = 0.01.
        assert_errors(fragility.clustered.unwrap(), fragility.independent, 0.03);
    }
}

/// Fits of many samples from one curve.
struct Repeated {
    fits: Vec<Fragility>,
}

impl Repeated {
    fn new(samples: usize, sample: impl FnMut() -> Vec<Observation>) -> Self {
        let fits = std::iter::repeat_with(sample)
            .take(samples)
            .map(|sample| fit(&sample).unwrap())
            .collect();
        Self { fits }
    }

    /// Standard deviation of a number over the samples.
    fn spread(&self, number: fn(&Fragility) -> f64) -> f64 {
        let mean = self.mean(number);
        let squares = self.fits.iter().map(|fit| (number(fit) - mean).powi(2));
        (squares.sum::<f64>() / (self.fits.len() - 1) as f64).sqrt()
    }

    fn mean(&self, number: fn(&Fragility) -> f64) -> f64 {
        self.fits.iter().map(number).sum::<f64>() / self.fits.len() as f64
    }

    /// Mean standard errors, relative to the actual scatter: of median and dispersion.
    fn ratios(&self, errors: fn(&Fragility) -> Errors) -> [f64; 2] {
        let mean = |error: fn(&Errors) -> f64| {
            let sum: f64 = self.fits.iter().map(|fit| error(&errors(fit))).sum();
            sum / self.fits.len() as f64
        };
        [
            mean(|errors| errors.median) / self.spread(|fit| fit.median),
            mean(|errors| errors.dispersion) / self.spread(|fit| fit.dispersion),
        ]
    }

    /// The fraction of the samples whose band contains the true probability at an intensity.
    fn coverage(&self, intensity: f64, truth: f64) -> f64 {
        let holds = |fit: &&Fragility| {
            let (low, high) = fit.band(intensity);
            (low..=high).contains(&truth)
        };
        self.fits.iter().filter(holds).count() as f64 / self.fits.len() as f64
    }
}

/// The scatter of 1000 samples is known to 1 / sqrt(2000) = 2.2 %, the coverage to 0.7 %. Three times these are
/// allowed, plus 1 % because the errors are of first order.
#[test]
fn errors_and_bands_predict_the_scatter_of_independent_cases() {
    let (mut random, dispersion) = (Random(21), 0.5);
    // Every case has its own record.
    let repeated = Repeated::new(1000, || {
        let mut sample = suite(&mut random, 100, dispersion, 0.0);
        for (i, case) in sample.iter_mut().enumerate() {
            case.record = i;
        }
        sample
    });
    for ratio in repeated.ratios(|fit| fit.independent) {
        assert!((ratio - 1.0).abs() < 0.076, "{ratio}");
    }
    for ratio in repeated.ratios(|fit| fit.clustered.unwrap()) {
        assert!((ratio - 1.0).abs() < 0.076, "{ratio}");
    }
    for eta in [-1.5, -0.5, 0.0, 1.0, 2.0] {
        let coverage = repeated.coverage(MEDIAN * (dispersion * eta).exp(), normal(eta));
        // The larger of the two errors is slightly too large.
        assert!((0.925..0.985).contains(&coverage), "{eta} {coverage}");
    }
}

/// Cases of one record share most of their capacity. The scatter of 600 samples is known to 2.9 %, and with
/// 100 records the errors are some percent too small.
#[test]
fn clustered_errors_predict_the_scatter_of_dependent_cases() {
    let (mut random, dispersion) = (Random(22), 0.5);
    let repeated = Repeated::new(600, || suite(&mut random, 100, dispersion, 0.45));
    for ratio in repeated.ratios(|fit| fit.clustered.unwrap()) {
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }
    let [median, _] = repeated.ratios(|fit| fit.independent);
    assert!(median < 0.7, "{median}");
    for eta in [-1.5, -0.5, 0.0, 1.0, 2.0] {
        let coverage = repeated.coverage(MEDIAN * (dispersion * eta).exp(), normal(eta));
        assert!((0.915..0.985).contains(&coverage), "{eta} {coverage}");
    }
}

/// Twice the levels with the same records add hardly any information.
#[test]
fn repeated_cases_of_the_same_records_are_no_evidence() {
    let once = suite(&mut Random(23), 40, 0.5, 0.3);
    let (single, double) = (fit(&once).unwrap(), fit(&once.repeat(2)).unwrap());
    assert_errors(double.clustered.unwrap(), single.clustered.unwrap(), 1e-9);
    let halved = Errors {
        median: single.independent.median / 2_f64.sqrt(),
        dispersion: single.independent.dispersion / 2_f64.sqrt(),
    };
    assert_errors(double.independent, halved, 1e-9);
}

/// Cases of new records, in contrast, divide both variances by their number; the fit is the same.
#[test]
fn k_times_the_sample_divides_variances_by_k() {
    let once = suite(&mut Random(24), 40, 0.5, 0.3);
    let single = fit(&once).unwrap();
    let k = 5;
    let again: Vec<Observation> = (0..k)
        .flat_map(|copy| {
            once.iter().map(move |case| Observation {
                record: case.record + 40 * copy,
                ..*case
            })
        })
        .collect();
    let many = fit(&again).unwrap();
    assert_close(many.median, single.median, 1e-10);
    assert_close(many.dispersion, single.dispersion, 1e-10);
    assert_close(many.log_likelihood, k as f64 * single.log_likelihood, 1e-12);
    let divided = |errors: Errors, by: f64| Errors {
        median: errors.median / by.sqrt(),
        dispersion: errors.dispersion / by.sqrt(),
    };
    assert_errors(
        many.independent,
        divided(single.independent, k as f64),
        1e-9,
    );
    // The factors G / (G - 1) differ.
    let factors = (40.0 / 39.0) / (200.0 / 199.0);
    let expected = divided(single.clustered.unwrap(), k as f64 * factors);
    assert_errors(many.clustered.unwrap(), expected, 1e-9);
}

#[test]
fn the_unit_of_the_intensity_does_not_matter() {
    let sample = suite(&mut Random(25), 40, 0.5, 0.3);
    let original = fit(&sample).unwrap();
    for factor in [1e-6, 9.81, 1e200] {
        let scaled: Vec<Observation> = sample
            .iter()
            .map(|case| Observation {
                intensity: case.intensity * factor,
                ..*case
            })
            .collect();
        let scaled = fit(&scaled).unwrap();
        // Logarithms of 1e200 have an absolute rounding error of 1e-13.
        assert_close(scaled.median, original.median * factor, 1e-11);
        assert_close(scaled.dispersion, original.dispersion, 1e-11);
        assert_close(scaled.log_likelihood, original.log_likelihood, 1e-12);
        let expected = |errors: Errors| Errors {
            median: errors.median * factor,
            ..errors
        };
        assert_errors(scaled.independent, expected(original.independent), 1e-9);
        let clustered = original.clustered.unwrap();
        assert_errors(scaled.clustered.unwrap(), expected(clustered), 1e-9);
        assert_close(
            scaled.probability(0.2 * factor),
            original.probability(0.2),
            1e-10,
        );
        assert_close(scaled.band(0.2 * factor).0, original.band(0.2).0, 1e-9);
    }
}

#[test]
fn order_and_names_of_records_do_not_matter() {
    let mut random = Random(26);
    let mut sample = suite(&mut random, 400, 0.5, 0.3);
    let original = fit(&sample).unwrap();
    for i in (1..sample.len()).rev() {
        sample.swap(i, random.pick(i + 1));
    }
    assert_eq!(fit(&sample).unwrap(), original);
    for case in &mut sample {
        case.record = usize::MAX - 7 * case.record;
    }
    let renamed = fit(&sample).unwrap();
    assert_eq!(renamed.independent, original.independent);
    assert_errors(
        renamed.clustered.unwrap(),
        original.clustered.unwrap(),
        1e-12,
    );
}

/// The log-likelihood of the cases of some records, by `(ln theta, beta)`, in an independent implementation.
fn log_likelihood<'a>(
    cases: impl Iterator<Item = &'a Observation>,
    [log_median, dispersion]: [f64; 2],
) -> f64 {
    cases
        .map(|case| {
            let eta = (case.intensity.ln() - log_median) / dispersion;
            log_normal(if case.overturned > 0.5 { eta } else { -eta })
        })
        .sum()
}

fn gradient(f: impl Fn([f64; 2]) -> f64, at: [f64; 2]) -> [f64; 2] {
    let step = 1e-3;
    [0, 1].map(|i| {
        let shifted = |by: f64| {
            let mut to = at;
            to[i] += by * step;
            f(to)
        };
        // Fourth order.
        (8.0 * (shifted(1.0) - shifted(-1.0)) - (shifted(2.0) - shifted(-2.0))) / (12.0 * step)
    })
}

fn inverse([[a, b], [c, d]]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let determinant = a * d - b * c;
    [[d, -b], [-c, a]].map(|row| row.map(|entry| entry / determinant))
}

fn product(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// Finite differences of the likelihood in the parameters themselves, which assume no linear form, give the same
/// maximum and both sets of errors.
#[test]
fn differences_of_the_likelihood_confirm_maximum_and_errors() {
    let records = 30;
    let sample = suite(&mut Random(27), records, 0.5, 0.4);
    let fragility = fit(&sample).unwrap();
    let at = [fragility.median.ln(), fragility.dispersion];
    let whole = |to: [f64; 2]| log_likelihood(sample.iter(), to);
    assert_close(whole(at), fragility.log_likelihood, 1e-8);

    let slope_of = |i: usize| move |to: [f64; 2]| gradient(whole, to)[i];
    let hessian = [gradient(slope_of(0), at), gradient(slope_of(1), at)];
    let covariance = inverse(hessian.map(|row| row.map(|entry| -entry)));
    let errors = |covariance: [[f64; 2]; 2]| Errors {
        median: fragility.median * covariance[0][0].sqrt(),
        dispersion: covariance[1][1].sqrt(),
    };
    // The finite differences are accurate to some 1e-9 of the curvature.
    assert_errors(errors(covariance), fragility.independent, 1e-6);
    let score = gradient(whole, at);
    assert!(score[0].abs() * covariance[0][0].sqrt() < 1e-7, "{score:?}");
    assert!(score[1].abs() * covariance[1][1].sqrt() < 1e-7, "{score:?}");

    let mut squares = [[0.0; 2]; 2];
    for record in 0..records {
        let of_record = || sample.iter().filter(|case| case.record == record);
        let score = gradient(|to| log_likelihood(of_record(), to), at);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            squares[i][j] += score[i] * score[j];
        }
    }
    let factor = records as f64 / (records as f64 - 1.0);
    let sandwich = product(product(covariance, squares), covariance)
        .map(|row| row.map(|entry| entry * factor));
    assert_errors(errors(sandwich), fragility.clustered.unwrap(), 1e-6);

    // At the median the band is the error of -ln(theta) / beta.
    let larger = covariance[0][0].max(sandwich[0][0]).sqrt();
    // Student's quantile of 97.5 % for 29 degrees of freedom, from a table.
    let margin = 2.045_229_642_133 * larger / fragility.dispersion;
    let (low, high) = fragility.band(fragility.median);
    assert!((low - normal(-margin)).abs() < 1e-6, "{low}");
    assert!((high - normal(margin)).abs() < 1e-6, "{high}");
}

#[test]
fn one_record_has_no_clustered_errors() {
    let mut sample = counts(&[(0.3, 8, 2), (0.6, 8, 6)]);
    for case in &mut sample {
        case.record = 3;
    }
    let fragility = fit(&sample).unwrap();
    assert_eq!(fragility.clustered, None);
    let (low, high) = fragility.band(0.3);
    assert!(0.0 < low && low < 0.25 && 0.25 < high && high < 1.0);
}

/// One record overturns more steeply than the other, about the same median, which is therefore certain.
#[test]
fn two_records_that_agree_on_the_median() {
    let cases = |record, levels: [(f64, usize); 4]| {
        let levels = levels.map(|(intensity, overturned)| (intensity, 10, overturned));
        counts(&levels)
            .into_iter()
            .map(move |case| Observation { record, ..case })
    };
    let steep = cases(0, [(0.25, 0), (0.5, 1), (2.0, 9), (4.0, 10)]);
    let shallow = cases(1, [(0.25, 2), (0.5, 4), (2.0, 6), (4.0, 8)]);
    let fragility = fit(&steep.chain(shallow).collect::<Vec<_>>()).unwrap();
    assert!((fragility.median - 1.0).abs() < 1e-12);
    let clustered = fragility.clustered.unwrap();
    assert!(clustered.median < 1e-8, "{clustered:?}");
    assert!(clustered.dispersion > fragility.independent.dispersion);
}

#[test]
fn the_curve_holds_from_zero_to_infinity() {
    let fragility = fit(&suite(&mut Random(28), 40, 0.5, 0.3)).unwrap();
    assert_eq!(fragility.probability(0.0), 0.0);
    assert_eq!(fragility.probability(f64::INFINITY), 1.0);
    assert!((fragility.probability(fragility.median) - 0.5).abs() < 1e-14);
    assert_eq!(fragility.band(0.0), (0.0, 0.0));
    assert_eq!(fragility.band(f64::MAX), (1.0, 1.0));
}

#[test]
fn a_record_that_behaves_oddly_far_out_has_a_likelihood() {
    // One case in a thousand survives a thousand times the intensity that overturns the others, and one overturns at a
    // thousandth of it.
    let sample = counts(&[
        (1e-3, 1000, 1),
        (0.9, 1000, 400),
        (1.1, 1000, 600),
        (1e3, 1000, 999),
    ]);
    let fragility = fit(&sample).unwrap();
    assert!((fragility.median - 1.0).abs() < 1e-2);
    // From the probabilities 1e-3 and 0.4 alone the dispersion would be 2.4 and 0.4.
    assert!(0.4 < fragility.dispersion && fragility.dispersion < 2.4);
    no_curve_nearby_is_likelier(&fragility, &sample);
}

/// From equal chances Newton's method overshoots here, on the way to the one case in 20 000.
#[test]
fn a_step_too_far_is_halved() {
    let sample = counts(&[
        (3e-22, 14_586, 0),
        (0.838, 4990, 0),
        (0.9624, 2, 1),
        (1.3503, 269, 0),
    ]);
    no_curve_nearby_is_likelier(&fit(&sample).unwrap(), &sample);
}

#[test]
fn cases_without_a_curve_give_the_reason() {
    let refusal = |levels: &[(f64, usize, usize)]| fit(&counts(levels)).unwrap_err();
    assert_eq!(refusal(&[]), NoFit::NoObservations);
    assert_eq!(
        refusal(&[(0.2, 3, 0), (0.4, 5, 0)]),
        NoFit::NoneOverturned(8, 0.4)
    );
    assert_eq!(
        refusal(&[(0.2, 3, 3), (0.4, 5, 5)]),
        NoFit::AllOverturned(8, 0.2)
    );
    assert_eq!(refusal(&[(0.3, 5, 2)]), NoFit::OneIntensity(0.3, 5, 2));
    // Two numbers with the same logarithm.
    let next = 1000_f64.next_up();
    assert_eq!(
        refusal(&[(1000.0, 5, 2), (next, 5, 3)]),
        NoFit::OneIntensity(1000.0, 10, 5)
    );
    for intensity in [0.0, -0.3, f64::INFINITY, f64::NEG_INFINITY] {
        let error = refusal(&[(0.2, 2, 1), (intensity, 2, 1)]);
        assert_eq!(error, NoFit::Intensity(intensity));
    }
    let NoFit::Intensity(intensity) = refusal(&[(0.2, 2, 1), (f64::NAN, 2, 1)]) else {
        panic!("a fit to NaN");
    };
    assert!(intensity.is_nan());
}

#[test]
fn separated_cases_are_recognised_exactly() {
    let refusal = |levels: &[(f64, usize, usize)]| fit(&counts(levels)).unwrap_err();
    let separated = NoFit::Separated;
    assert_eq!(
        refusal(&[(0.1, 3, 0), (0.2, 3, 0), (0.4, 5, 5), (0.5, 1, 1)]),
        separated(0.2, 0.4)
    );
    // One level with cases of both kinds: in the middle, first, last.
    let middle = [(0.1, 3, 0), (0.2, 3, 1), (0.4, 5, 5)];
    assert_eq!(refusal(&middle), separated(0.2, 0.2));
    assert_eq!(refusal(&middle[1..]), separated(0.2, 0.2));
    assert_eq!(refusal(&middle[..2]), separated(0.2, 0.2));
    // The smallest overlap has a fit: one case of either kind on the wrong side, by next to nothing.
    let above = 0.2_f64 * (1.0 + 1e-9);
    assert!(
        fit(&counts(&[
            (0.1, 9, 0),
            (0.2, 3, 1),
            (above, 3, 2),
            (0.4, 9, 9)
        ]))
        .is_ok()
    );
}

#[test]
fn a_fraction_that_does_not_grow_gives_no_curve() {
    for levels in [
        // Falling; falling and separated; level; level in the mean of logarithms.
        [(0.2, 4, 3), (0.4, 4, 2), (0.8, 4, 1)],
        [(0.2, 4, 4), (0.4, 4, 2), (0.8, 4, 0)],
        [(0.2, 4, 2), (0.4, 4, 2), (0.8, 4, 2)],
        [(0.2, 4, 3), (0.4, 4, 0), (0.8, 4, 3)],
    ] {
        let error = fit(&counts(&levels)).unwrap_err();
        let NoFit::NotIncreasing(survived, overturned) = error else {
            panic!("{levels:?} {error:?}");
        };
        assert!(overturned <= survived * (1.0 + 1e-12));
    }
    // Geometric means by hand: (0.2^2 0.8)^(1/3) and (0.2 0.8^2)^(1/3).
    let error = fit(&counts(&[(0.2, 3, 2), (0.8, 3, 1)])).unwrap_err();
    let NoFit::NotIncreasing(survived, overturned) = error else {
        panic!("{error:?}");
    };
    assert_close(overturned, 0.032_f64.cbrt(), 1e-14);
    assert_close(survived, 0.128_f64.cbrt(), 1e-14);
}

/// Out of 100 000 cases one more overturns at a 10 % higher intensity: at that rate, half would at e^1800.
#[test]
fn a_median_beyond_floating_point_is_undetermined() {
    let levels = [(1.0, 100_000, 30_000), (1.1, 100_000, 30_001)];
    assert_eq!(fit(&counts(&levels)), Err(NoFit::Undetermined));
}

#[test]
fn messages_report_the_observed_cases() {
    let message = |levels: &[(f64, usize, usize)]| fit(&counts(levels)).unwrap_err().to_string();
    assert_eq!(
        message(&[(0.2, 3, 0), (0.4, 5, 0)]),
        "none of 8 cases overturns up to the intensity 0.4: add higher intensities"
    );
    let separated = message(&[(0.2, 3, 0), (0.4, 5, 5)]);
    assert!(
        separated.starts_with(
            "no case overturns below an intensity of 0.4 and none survives above 0.2:"
        ),
        "{separated}"
    );
}

/// A case whose repetitions overturn in a fraction counts as that part of a case: the likeliest curve of cases that are all doubled, with one
/// of each uncertain pair overturned, is the same.
#[test]
fn uncertain_cases_count_with_their_fractions() {
    let levels = [
        (0.2, 4, 0),
        (0.3, 5, 1),
        (0.4, 6, 3),
        (0.6, 5, 4),
        (0.9, 4, 4),
    ];
    let mut halves = counts(&levels);
    for (index, intensity) in [0.3, 0.6].into_iter().enumerate() {
        let record = halves.len() + index;
        halves.push(Observation {
            intensity,
            overturned: 0.5,
            record,
        });
    }
    let doubled = levels.map(|(intensity, cases, overturned)| {
        let more = usize::from(intensity == 0.3 || intensity == 0.6);
        (intensity, 2 * (cases + more), 2 * overturned + more)
    });
    let [one, two] = [halves, counts(&doubled)].map(|cases| fit(&cases).unwrap());
    assert_close(one.median, two.median, 1e-9);
    assert_close(one.dispersion, two.dispersion, 1e-9);
    assert_close(
        one.independent.median,
        two.independent.median * 2_f64.sqrt(),
        1e-9,
    );
}

#[test]
fn fractions_by_level() {
    let mut sample = counts(&[(0.4, 3, 3), (0.2, 2, 0), (0.3, 4, 1)]);
    sample.extend(counts(&[(0.2, 1, 1)]));
    let level = |intensity, cases, overturned: i32| Fraction {
        intensity,
        cases,
        overturned: f64::from(overturned),
    };
    assert_eq!(
        fractions(&sample),
        [level(0.2, 3, 1), level(0.3, 4, 1), level(0.4, 3, 3)]
    );
    assert_eq!(fractions(&[]), []);
    let next = 0.2_f64.next_up();
    assert_eq!(
        fractions(&counts(&[(next, 1, 1), (0.2, 1, 0)])),
        [level(0.2, 1, 0), level(next, 1, 1)]
    );
}

fn intensity() -> impl Strategy<Value = f64> {
    prop_oneof![
        // Few levels, adjacent levels, wide ranges, any positive number.
        4 => (1_i32..8).prop_map(|i| 0.1 * f64::from(i)),
        1 => (0_u64..4).prop_map(|i| f64::from_bits(0.3_f64.to_bits() + i)),
        2 => (-3.0_f64..3.0).prop_map(|exponent| 10_f64.powf(exponent)),
        1 => (1_u64..f64::INFINITY.to_bits()).prop_map(f64::from_bits),
    ]
}

fn sample() -> impl Strategy<Value = Vec<Observation>> {
    let case = (intensity(), any::<bool>(), 0_usize..6, -1.0_f64..1.0);
    // Some samples are noise; the others follow a threshold with more or less noise.
    let noise = prop_oneof![Just(None), (0.0_f64..1.0).prop_map(Some)];
    (prop::collection::vec(case, 0..40), noise).prop_map(|(cases, noise)| {
        cases
            .into_iter()
            .map(|(intensity, flag, record, deviate)| Observation {
                intensity,
                overturned: f64::from(
                    noise.map_or(flag, |noise| (intensity / 0.35).ln() > noise * deviate),
                ),
                record,
            })
            .collect()
    })
}

/// Tests both sides at a distance of half a standard error, or half the dispersion if that is less.
fn no_curve_nearby_is_likelier(fragility: &Fragility, sample: &[Observation]) {
    let (log_median, dispersion) = (fragility.median.ln(), fragility.dispersion);
    let likelihood = |to| log_likelihood(sample.iter(), to);
    let best = likelihood([log_median, dispersion]);
    assert_close(fragility.log_likelihood, best, 1e-8);
    for way in [-0.5, 0.5] {
        let errors = fragility.independent;
        let shift = way * (errors.median / fragility.median).min(dispersion);
        let stretch = way * (errors.dispersion / dispersion).min(1.0);
        for moved in [
            [log_median + shift, dispersion],
            [log_median, dispersion * stretch.exp()],
        ] {
            let other = likelihood(moved);
            assert!(other < best + 1e-8 * best.abs(), "{other} {best}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn whatever_the_cases_numbers_are_finite(sample in sample(), x in intensity()) {
        match fit(&sample) {
            Ok(fragility) => {
                prop_assert!(fragility.median > 0.0 && fragility.median.is_finite());
                prop_assert!(fragility.dispersion > 0.0 && fragility.dispersion.is_finite());
                prop_assert!(fragility.log_likelihood.is_finite() && fragility.log_likelihood < 0.0);
                let Errors { median, dispersion } = fragility.independent;
                prop_assert!(median > 0.0 && median.is_finite());
                prop_assert!(dispersion > 0.0 && dispersion.is_finite());
                if let Some(Errors { median, dispersion }) = fragility.clustered {
                    prop_assert!(median >= 0.0 && median.is_finite());
                    prop_assert!(dispersion >= 0.0 && dispersion.is_finite());
                }
                let (low, high) = fragility.band(x);
                let probability = fragility.probability(x);
                prop_assert!(0.0 <= low && low <= probability);
                prop_assert!(probability <= high && high <= 1.0);
                // With less dispersion the rounding error of the median's logarithm is noticeable.
                if fragility.dispersion > 1e-3 {
                    no_curve_nearby_is_likelier(&fragility, &sample);
                }
            }
            Err(refusal) => prop_assert!(!refusal.to_string().contains("NaN")),
        }
    }
}
