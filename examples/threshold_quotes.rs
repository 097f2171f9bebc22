//! How often a structure overturns below the factor that `threshold` quotes. Run with
//! `cargo run --release --example threshold_quotes -- block 120` (or `drums`, `arch`, `four`, `friction`, `elastic`, `wall`, `feet`);
//! a third argument is the seed of the random structures.
//!
//! Half of the structures have a pulse, half an artificial record of 9 s. A quote is wrong if an unrepeated history overturns more than 1 % below it,
//! among factors in steps of 0.1 % (mechanisms) or 0.25 % (rows of blocks), down to the onset of motion or half of it where that is unknown.

#![allow(
    clippy::print_stderr,
    clippy::print_stdout,
    reason = "an example prints its progress and results"
)]
#![allow(
    clippy::disallowed_methods,
    reason = "digits of an example may depend on the machine"
)]

use std::env;
use std::error::Error;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

mod random;

use archrock::{
    Counted, Directions, EndCondition, Factors, GroundMotion, Model, Progress, Pulse, Request,
    Runner, Scenario, Sway, Threshold, Verdict, threshold,
};
use random::Random;

/// Returns the tables of a random structure of a class.
fn structure(class: &str, random: &mut Random) -> String {
    let (height_m, slenderness) = (random.within(1.5, 9.0), random.within(3.5, 12.0));
    let width_m = height_m / slenderness;
    let column = format!("[column]\nheight_m = {height_m:.3}\nwidth_m = {width_m:.4}\n");
    let arch = format!(
        "[arch]\nmean_radius_m = {:.3}\nthickness_ratio = {:.4}\nembrace_deg = {}\nvoussoirs = 7\n",
        random.within(2.0, 6.0),
        random.within(0.13, 0.22),
        random.one_of(&[120.0, 140.0, 157.5, 180.0])
    );
    let drums = format!("{column}drums = {}\n", random.one_of(&[2, 3, 4, 5]));
    let friction = random.within(0.4, 0.7);
    let stiffness = random.one_of(&[5, 10, 30]);
    let row = if random.next() < 0.5 { &arch } else { &drums };
    match class {
        "block" => column,
        "drums" => format!("{drums}[free_hinges]\n"),
        "four" => arch,
        "friction" => format!("{row}[free_hinges]\nfriction_coefficient = {friction:.3}\n"),
        "elastic" => format!("{row}[elastic_joints]\nnormal_stiffness_gpa_m = {stiffness}\n"),
        "wall" => format!("{column}[column.back]\nside = \"left\"\n"),
        _ => format!("{arch}[free_hinges]\n"),
    }
}

/// Estimates of the time that steps of a search take yet. Steps of less than 20 ms do not count.
#[derive(Default)]
struct Estimates {
    /// Cases at the last report, and cases of all steps before.
    done: usize,
    before: usize,
    /// True if the step ends at the first collapse.
    is_open: bool,
    /// Beginning of the step, and its estimates: time now, and time left.
    begun: Option<Instant>,
    left: Vec<(Instant, Duration)>,
    over_true: Vec<f64>,
}

impl Estimates {
    fn note(&mut self, Progress { done, all, counted }: Progress) {
        let is_open = matches!(counted, Counted::Search(step) if step.is_open);
        if done < self.done || is_open != self.is_open {
            self.end_step();
        }
        self.is_open = is_open;
        self.done = done;
        let now = Instant::now();
        let begun = *self.begun.get_or_insert(now);
        if done > 0 && !is_open {
            let each = (now - begun).div_f64(done as f64);
            self.left.push((now, each.mul_f64((all - done) as f64)));
        }
    }

    /// Takes the estimates at a quarter, half and three quarters of the time, over the time that was left.
    fn end_step(&mut self) {
        self.before += self.done;
        self.done = 0;
        let left = std::mem::take(&mut self.left);
        let (Some(begun), Some((end, _))) = (self.begun.take(), left.last()) else {
            return;
        };
        let all = *end - begun;
        if all < Duration::from_millis(20) {
            return;
        }
        let at = [0.25, 0.5, 0.75].map(|part| begun + all.mul_f64(part));
        for at in at {
            if let Some((now, left)) = left.iter().find(|(now, _)| *now >= at)
                && end > now
            {
                self.over_true
                    .push(left.as_secs_f64() / (*end - *now).as_secs_f64());
            }
        }
    }
}

/// A structure and its ground motion, whose peak is the push of incipient motion.
struct Case {
    model: Box<dyn Model>,
    ground: GroundMotion,
    request: Request,
}

impl Case {
    /// Makes a random case; `None` if the structure does not stand.
    fn random(class: &str, is_record: bool, random: &mut Random) -> Option<Self> {
        let text = structure(class, random);
        let pulses = [
            Pulse::Rectangular,
            Pulse::HalfSine,
            Pulse::OneSine,
            Pulse::OneCosine,
            Pulse::Ricker,
            Pulse::WindowedSine,
        ];
        let (pulse, duration_s) = (random.one_of(&pulses), 0.15 * 8.0_f64.powf(random.next()));
        let (samples, sign) = (random.record(), random.one_of(&[-1.0, 1.0]));
        let delay_s = random.within(0.02, 0.1);
        let ground = "[ground.half_sine]\namplitude_g = 0.1\nduration_s = 0.5\n";
        let scenario = Scenario::parse(&format!("{text}{ground}"), "case.toml").ok()?;
        let model = scenario.model().ok()?;
        let starts_g = [Sway::Right, Sway::Left].map(|side| model.incipient_acceleration_g(side));
        let start_g = starts_g.into_iter().flatten().reduce(f64::min)?;
        let peak_m_s2 = sign * start_g * scenario.gravity_m_s2();
        let scaled = samples
            .iter()
            .map(|(time_s, value)| (*time_s, peak_m_s2 * value));
        let ground = match is_record {
            true => GroundMotion::record(&scaled.collect::<Vec<_>>(), &[], 0.0),
            false => pulse.lasting_s(duration_s).horizontal_m_s2(peak_m_s2),
        };
        let ground = match class {
            "feet" => ground.ok()?.with_delayed_right_foot(delay_s).ok()?,
            _ => ground.ok()?,
        };
        let request = Request {
            output_step_s: 1.0,
            ..scenario.request_on(&ground, &scenario.structure)
        };
        Some(Self {
            model,
            ground,
            request,
        })
    }

    /// Returns the threshold, the number of its factors, and its estimates of the time left, over the true one.
    fn threshold(&self) -> Result<(Threshold, usize, Vec<f64>), Box<dyn Error>> {
        let mut estimates = Estimates::default();
        let watch = |progress: Progress| {
            estimates.note(progress);
            ControlFlow::Continue(())
        };
        let found = threshold(
            ("model", &*self.model),
            (Directions::AsGiven, &self.ground),
            &self.request,
            &Factors::default(),
            &Runner::default(),
            watch,
        )?;
        estimates.end_step();
        Ok((found, estimates.before, estimates.over_true))
    }

    fn overturns(&self, factor: f64) -> bool {
        let history = self.ground.scaled(factor).ok().and_then(|ground| {
            let case = (ground, self.request);
            self.model.simulate_until(EndCondition::Safe, &case).ok()
        });
        history.is_some_and(|history| Verdict::from(history.outcome) == Verdict::Overturns)
    }

    /// Returns the factors down to `last` that overturn the structure more than 1 % below a quote, over the quote.
    fn wrong(&self, quote: f64, last: f64, step: f64) -> Vec<f64> {
        let next = |factor: &f64| Some(factor / (1.0 + step));
        let factors = std::iter::successors(Some(0.99 * quote), next);
        let factors = factors.take_while(|factor| *factor >= last);
        factors
            .filter(|factor| self.overturns(*factor))
            .map(|factor| factor / quote)
            .collect()
    }
}

/// Returns the ends of the 95 % interval of a share (Wilson 1927).
fn interval(count: usize, of: usize) -> [f64; 2] {
    let (share, of, z) = (count as f64 / of as f64, of as f64, 1.96_f64);
    let middle = share + z * z / (2.0 * of);
    let half = z * (share * (1.0 - share) / of + z * z / (4.0 * of * of)).sqrt();
    [-half, half].map(|half| ((middle + half) / (1.0 + z * z / of)).clamp(0.0, 1.0))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let class = arguments.first().map_or("block", String::as_str);
    let all: usize = arguments.get(1).map_or(Ok(20), |count| count.parse())?;
    let step = match class {
        "block" | "four" | "wall" => 0.001,
        _ => 0.0025,
    };
    let seed = arguments.get(2).map_or(Ok(57), |seed| seed.parse())?;
    let mut random = Random(seed);
    let (mut quotes, mut wrong, mut cases) = (0, 0, 0);
    let mut estimates = Vec::new();
    for index in 0..all {
        let case = loop {
            if let Some(case) = Case::random(class, index % 2 == 1, &mut random) {
                break case;
            }
        };
        let (found, own, left) = case.threshold()?;
        cases += own;
        estimates.extend(left);
        let (Some(quote), Some(_)) = (found.survives_up_to(), found.lowest_factor()) else {
            continue;
        };
        quotes += 1;
        eprintln!("{class} {index}: {own} factors, quote {quote:.4}");
        let first = found.factors.from;
        let last = if found.factors.lower_not_tried {
            0.5
        } else {
            first
        };
        let hits = case.wrong(quote, last, step);
        if let Some(highest) = hits.first() {
            wrong += 1;
            let lowest = hits[hits.len() - 1];
            println!(
                "{class} {index}: overturns in {} steps from {lowest:.4} to {highest:.4} of the quote",
                hits.len()
            );
        }
    }
    let [low, high] = interval(wrong, quotes.max(1)).map(|share| 100.0 * share);
    let mean = cases as f64 / all as f64;
    println!("| {class} | {all} | {quotes} | {wrong} | {low:.1} to {high:.1} % | {mean:.0} |");
    let good = estimates.iter().filter(|over| (0.5..=2.0).contains(*over));
    println!(
        "estimates of the time left within a factor of two: {} of {}",
        good.count(),
        estimates.len()
    );
    Ok(())
}
