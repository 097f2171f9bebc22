//! How often further computations contradict a verdict. Run with
//! `cargo run --release --example certainty -- rigid 400` (or `friction`, `elastic`).
//!
//! Half of the histories are near an edge, with an amplitude 0.2 to 5 % off it; half have an amplitude chosen at random. Half have a pulse, half an
//! artificial record of 9 s. Each verdict is judged by six histories with steps that no repetition has.

#![allow(clippy::print_stdout, reason = "an example prints its results")]
#![allow(
    clippy::disallowed_methods,
    reason = "digits of an example may depend on the machine"
)]

use std::env;
use std::error::Error;

mod random;

use archrock::{
    Arch, Contact, ElasticJoints, ElasticProperties, EndCondition, Ending, FreeHinges,
    GroundMotion, JointStiffness, Model, Outcome, Pulse, Request, RowOptions, Stiffness, Sway,
    Verdict,
};
use random::Random;

/// Steps of the judging histories over the default ones. With elastic joints, longer steps may be unstable.
const RIGID: [f64; 6] = [0.15, 0.3, 0.6, 0.85, 1.7, 3.0];
const ELASTIC: [f64; 6] = [0.13, 0.3, 0.45, 0.6, 0.8, 1.15];
const GRAVITY_M_S2: f64 = 9.81;

/// A structure with one of the models.
enum Joints {
    Rigid(Box<FreeHinges>, RowOptions),
    Elastic(Box<ElasticJoints>),
}

/// A structure, its ground motion, and the request for its history.
type Case = (Joints, GroundMotion, Request);

impl Joints {
    fn new(kind: &str, arch: &Arch, random: &mut Random) -> Result<Self, Box<dyn Error>> {
        let coefficient = random.within(0.5, 0.8);
        let normal_pa_m = random.one_of(&[5e9, 1e10, 2e10]);
        if kind == "elastic" {
            let properties = ElasticProperties {
                stiffness: Stiffness::Uniform(JointStiffness {
                    normal_pa_m,
                    shear_pa_m: 0.4 * normal_pa_m,
                }),
                depth_m: 1.0,
                friction_coefficient: None,
                damping_time_s: 1e-4,
                compressive_strength_pa: None,
                contact: Contact::Continuous,
            };
            let model = ElasticJoints::new(arch.row()?, properties)?;
            return Ok(Self::Elastic(Box::new(model)));
        }
        let friction_coefficient = (kind == "friction").then_some(coefficient);
        let options = RowOptions {
            friction_coefficient,
            ..RowOptions::default()
        };
        let model = FreeHinges::of_arch(arch)?.with_options(options)?;
        Ok(Self::Rigid(Box::new(model), options))
    }

    fn model(&self) -> &dyn Model {
        match self {
            Self::Rigid(model, _) => &**model,
            Self::Elastic(model) => &**model,
        }
    }

    /// Returns the model with other steps.
    fn with_steps(&self, times: f64, request: &Request) -> Result<Box<dyn Model>, Box<dyn Error>> {
        Ok(match self {
            Self::Rigid(model, options) => {
                let longest_step_s = Some(times * model.longest_step_s(request));
                Box::new((**model).clone().with_options(RowOptions {
                    longest_step_s,
                    ..*options
                })?)
            }
            Self::Elastic(model) => Box::new(
                (**model)
                    .clone()
                    .with_longest_step_s(times * model.longest_step_s())?,
            ),
        })
    }
}

/// The counts of a class of histories.
#[derive(Clone, Copy, Default)]
struct Class {
    /// Verdicts of paths that repeat or stay far from overturning, of paths that do not repeat, and no verdict.
    verdicts: [usize; 3],
    /// Number of judging histories of the first two, and of those among them that contradict.
    judged: [[usize; 2]; 2],
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let kind = arguments.first().map_or("rigid", String::as_str);
    let all: usize = arguments.get(1).map_or(Ok(40), |count| count.parse())?;
    let mut random = Random(7);
    let mut classes = [Class::default(); 4];
    for index in 0..all {
        let class = index % 4;
        let (is_record, is_near) = (class >= 2, class % 2 == 0);
        let (joints, ground, request) = loop {
            if let Some(case) = case(kind, &mut random, is_record, is_near)? {
                break case;
            }
        };
        let class = &mut classes[class];
        let Ok(ending) = Ending::of(joints.model(), &ground, &request) else {
            continue;
        };
        let verdict = match ending.verdict() {
            Verdict::Survives => Outcome::Rest,
            Verdict::Overturns => ending.outcome,
            _ => {
                class.verdicts[2] += 1;
                continue;
            }
        };
        let repeats = usize::from(ending.count.is_some_and(|count| count.of > 3));
        class.verdicts[repeats] += 1;
        for times in if kind == "elastic" { ELASTIC } else { RIGID } {
            let judge = joints
                .with_steps(times, &request)?
                .simulate(&ground, &request, None);
            let Ok(judge) = judge.map(|history| Verdict::from(history.outcome)) else {
                continue;
            };
            if judge != Verdict::Incomplete {
                class.judged[repeats][0] += 1;
                class.judged[repeats][1] += usize::from(judge != Verdict::from(verdict));
            }
        }
    }
    let names = [
        "pulse, near an edge",
        "pulse, random",
        "record, near an edge",
        "record, random",
    ];
    for (
        name,
        Class {
            verdicts: [repeats, agrees, uncertain],
            judged,
        },
    ) in names.iter().zip(classes)
    {
        let [first, second] =
            judged.map(|[all, contradict]| 100.0 * contradict as f64 / all.max(1) as f64);
        println!(
            "| {kind} | {name} | {repeats} | {first:.1} % | {agrees} | {second:.1} % | {uncertain} |"
        );
    }
    Ok(())
}

/// Makes a random case; `None` if the arch does not stand, or no amplitude overturns it.
fn case(
    kind: &str,
    random: &mut Random,
    is_record: bool,
    is_near: bool,
) -> Result<Option<Case>, Box<dyn Error>> {
    let embrace_deg = random.one_of(&[120.0, 140.0, 157.5, 180.0]);
    let voussoirs = random.one_of(&[5, 6, 7, 8]);
    let arch = Arch::new(
        random.within(2.0, 6.0),
        random.within(0.13, 0.2),
        embrace_deg,
    )?;
    let arch = arch.with_voussoirs(voussoirs)?;
    let pulses = [
        Pulse::Rectangular,
        Pulse::HalfSine,
        Pulse::OneSine,
        Pulse::OneCosine,
        Pulse::Ricker,
        Pulse::WindowedSine,
    ];
    let (pulse, duration_s, samples) = (
        random.one_of(&pulses),
        random.within(0.2, 0.8),
        random.record(),
    );
    let sign = random.one_of(&[-1.0, 1.0]);
    let off = random.one_of(&[-1.0, 1.0]) * 0.002 * 25.0_f64.powf(random.next());
    let power = random.within(1.0, 9.0);
    let end_s = if is_record { 17.0 } else { 10.0 };
    let request = Request {
        end_s,
        output_step_s: 1.0,
        ..Request::default()
    };
    let Ok(joints) = Joints::new(kind, &arch, random) else {
        return Ok(None);
    };
    let Some(incipient_g) = joints.model().incipient_acceleration_g(Sway::Right) else {
        return Ok(None);
    };
    let ground = |amplitude_g: f64| {
        let peak_m_s2 = sign * amplitude_g * GRAVITY_M_S2;
        match is_record {
            true => {
                let samples: Vec<_> = samples
                    .iter()
                    .map(|(time_s, value)| (*time_s, peak_m_s2 * value))
                    .collect();
                GroundMotion::record(&samples, &[], 0.0)
            }
            false => pulse.lasting_s(duration_s).horizontal_m_s2(peak_m_s2),
        }
    };
    let mut amplitude_g = incipient_g * 1.3_f64.powf(power);
    if is_near {
        let overturns = |amplitude_g: f64| -> Result<bool, Box<dyn Error>> {
            let history = joints
                .model()
                .simulate_until(EndCondition::Safe, &(ground(amplitude_g)?, request));
            Ok(history.is_ok_and(|history| history.overturned_s().is_some()))
        };
        let (mut low, mut high) = (incipient_g, 1.3 * incipient_g);
        while !overturns(high)? {
            (low, high) = (high, 1.3 * high);
            if high > 40.0 * incipient_g {
                return Ok(None);
            }
        }
        for _ in 0..8 {
            let middle = 0.5 * (low + high);
            if overturns(middle)? {
                high = middle
            } else {
                low = middle
            }
        }
        amplitude_g = 0.5 * (low + high) * (1.0 + off);
    }
    let ground = ground(amplitude_g)?;
    Ok(Some((joints, ground, request)))
}
