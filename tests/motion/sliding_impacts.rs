//! Energy of impacts where joints slip: complete whatever the step, and the same in rows and summary.

use std::ops::ControlFlow;

use crate::common::GRAVITY;
use archrock::dynamics::{Event, GroundMotion, Impact, Pulse, Recorder, Sample, Summary};
use archrock::mechanics::Ring;
use archrock::mechanics::Row;
use archrock_motion::internals::free_hinges::{Settings, simulate};
use nalgebra::Vector2;

/// Impacts with their times, and the times of all events.
#[derive(Default)]
struct Impacts {
    rows: Vec<(f64, Impact)>,
    times_s: Vec<f64>,
}

impl Recorder for Impacts {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        // An impact belongs to the phase that it begins, but is reported a step later.
        assert!(sample.phase >= self.times_s.len());
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        self.times_s.push(event.time_s);
        if let Some(impact) = &event.impact {
            self.rows.push((event.time_s, impact.clone()));
        }
        ControlFlow::Continue(())
    }
}

/// A motion in equal steps. The rows of its impacts add up to the energy of the summary, in order of time.
fn run(
    row: &Row,
    ground: &GroundMotion,
    [step_s, end_s]: [f64; 2],
    coefficient: f64,
) -> (Summary, Vec<(f64, Impact)>) {
    let settings = Settings {
        longest_step_s: step_s,
        shortest_step_s: step_s,
        merged_after: 0,
        may_halve: false,
        end_s,
        outcome_by_s: None,
        output_step_s: Some(end_s / 200.0),
        friction_coefficient: Some(coefficient),
    };
    let mut impacts = Impacts::default();
    let summary = simulate(row, ground, GRAVITY, &settings, None, Some(&mut impacts)).unwrap();
    assert!(impacts.times_s.is_sorted());
    assert_eq!(summary.impacts, impacts.rows.len());
    let in_rows_j: f64 = impacts
        .rows
        .iter()
        .map(|(_, impact)| taken_j(impact) - impact.friction_j.unwrap())
        .sum();
    let all_j = summary.row().unwrap().energy_taken_j;
    assert!(
        (in_rows_j - all_j).abs() <= 1e-9 * all_j,
        "{in_rows_j} {all_j}"
    );
    (summary, impacts.rows)
}

fn taken_j(impact: &Impact) -> f64 {
    impact.energy_before_j - impact.energy_after_j
}

/// A block that does not slip keeps `(1 - 1.5 sin^2 alpha)^2 = 0.8879` of its energy at each impact (Housner), in every step, in the
/// rows and from half cycle to half cycle. In each of the two steps `h` of an impact gravity changes the rate `u` at which the corner
/// closes by at most `g h`, so the loss, proportional to its square, is known to within `4 g h/u` of it. Half cycles begin and end
/// within a step, in which the weight does as much work as one of these four parts.
#[test]
fn an_impact_without_slip_has_housners_loss_with_any_step() {
    let row = Row::tapered_stack(&[4.0], 0.8, 0.8, 1.0, 2000.0).unwrap();
    let ground = Pulse::Rectangular
        .lasting_s(0.2)
        .horizontal_m_s2(0.5 * GRAVITY)
        .unwrap();
    let square_sine = 0.8_f64.powi(2) / (0.8_f64.powi(2) + 16.0);
    let kept = (1.0 - 1.5 * square_sine).powi(2);
    assert!((kept - 0.8879).abs() < 5e-5);
    let inertia_kg_m2 = row.mass_kg() * (0.8_f64.powi(2) + 16.0) / 3.0;
    for step_s in [4e-4, 1.3e-4, 4.5e-5, 1.1e-5] {
        let (summary, rows) = run(&row, &ground, [step_s, 6.0], 0.9);
        // The rate of a corner follows from the kinetic energy just before it lands.
        let error = |impact: &Impact, parts: f64| {
            let turning_rad_s = (2.0 * impact.energy_before_j / inertia_kg_m2).sqrt();
            parts * GRAVITY * step_s / (0.8 * turning_rad_s) * (1.0 - kept)
        };
        assert!(rows.len() >= 7, "{}", rows.len());
        for (time_s, impact) in &rows {
            let miss = impact.restitution - kept;
            assert!(
                miss.abs() < error(impact, 4.0),
                "{step_s} {time_s}: {}",
                impact.restitution
            );
            assert!(impact.friction_j.unwrap() < 1e-9 * impact.energy_before_j);
            let kept = impact.energy_after_j / impact.energy_before_j;
            assert!((impact.restitution - kept).abs() < 1e-12);
            assert_eq!((impact.closed.len(), impact.opened.len()), (1, 1));
        }
        let cycles = summary.half_cycles();
        let ratios: Vec<f64> = cycles
            .iter()
            .filter_map(|cycle| cycle.energy_ratio)
            .collect();
        assert!(ratios.len() >= 6, "{ratios:?}");
        for (ratio, (_, impact)) in ratios.iter().zip(&rows[1..]) {
            let miss = ratio - kept;
            assert!(miss.abs() < error(impact, 5.0), "{step_s}: {ratio}");
        }
    }
}

/// Ground that pulls down by 4/3 g for a time `t` leaves a slab behind, which lands flat after another `t`, at `2/3 g t`, sliding at the
/// `a t` that the horizontal part of the pulse has given it. The impact takes all the energy of the fall; friction slows the slide by
/// `mu` times the rate of landing and takes that part of its energy. Steps that divide `t` end just as the slab touches the ground.
/// Gravity in the two steps of the impact changes the rate of landing as above.
#[test]
fn an_impact_of_a_sliding_slab_divides_its_energy_between_landing_and_friction() {
    let row = Row::tapered_stack(&[0.8], 4.0, 4.0, 1.0, 2000.0).unwrap();
    let (time_s, coefficient, push_g) = (0.1, 0.3, 1.0);
    let peaks = Vector2::new(-push_g, -4.0 / 3.0) * GRAVITY;
    let ground = Pulse::Rectangular
        .lasting_s(time_s)
        .inclined_m_s2(peaks)
        .unwrap();
    let [landing, sliding] = [2.0 / 3.0, push_g].map(|part| part * GRAVITY * time_s);
    let slower = sliding - coefficient * landing;
    let energy_j = |rate: f64| 0.5 * row.mass_kg() * rate * rate;
    let friction_j = energy_j(sliding) - energy_j(slower);
    let steps = [250.0, 1000.0, 1001.0, 1003.0, 4000.0, 333.3, 777.7, 1234.5];
    for parts in steps {
        let step_s = time_s / parts;
        let (_, rows) = run(&row, &ground, [step_s, 1.0], coefficient);
        let [(landed_s, impact)] = &rows[..] else {
            panic!("{parts}: {} impacts", rows.len());
        };
        assert!(
            (landed_s - 2.0 * time_s).abs() < 1.01 * step_s,
            "{landed_s}"
        );
        let error = 4.0 * GRAVITY * step_s / landing;
        for (ours_j, theirs_j) in [
            (impact.friction_j.unwrap(), friction_j),
            (taken_j(impact), energy_j(landing) + friction_j),
        ] {
            assert!(
                (ours_j / theirs_j - 1.0).abs() < error,
                "{parts}: {ours_j} {theirs_j}"
            );
        }
    }
}

/// An arch whose joints open and slip: each row is a loss, and the rows add up.
#[test]
fn rows_of_an_arch_that_slips_add_up() {
    let ring = Ring::new(0.15, 157.5_f64.to_radians()).unwrap();
    let row = Row::arch(&ring, 7, 10.0, 1.0, 2000.0).unwrap();
    let ground = Pulse::Rectangular
        .lasting_s(0.2)
        .horizontal_m_s2(0.8 * GRAVITY)
        .unwrap();
    for step_s in [2e-4, 7e-5] {
        let (summary, rows) = run(&row, &ground, [step_s, 4.0], 0.45);
        assert!(rows.len() > 20, "{}", rows.len());
        let sliding = summary.row().unwrap().sliding.as_ref().unwrap();
        let rubbed_j: f64 = rows
            .iter()
            .filter_map(|(_, impact)| impact.friction_j)
            .sum();
        assert!(0.0 < rubbed_j && rubbed_j < sliding.friction_j);
        for (time_s, impact) in &rows {
            let rounding_j = 1e-9 * sliding.friction_j;
            assert!(taken_j(impact) > -rounding_j, "{time_s} {impact:?}");
        }
    }
}

/// The losses of all impacts add up to the energy that impacts took, also if the motion starts again in the step of an impact.
#[test]
fn losses_of_impacts_add_up() {
    for (amplitude_g, duration_s) in [(0.416, 0.5), (0.42, 0.3), (0.43, 0.5)] {
        let scenario = crate::common::parsed(&format!(
            "[column]\nheight_m = 3.134\nwidth_m = 1.302\n[free_hinges]\nfriction_coefficient = 0.631\n\
             [ground.one_sine]\namplitude_g = {amplitude_g}\nduration_s = {duration_s}\n"
        ));
        let model = scenario.model().unwrap();
        let history = model.history(scenario.ground_motion(), &scenario.request());
        let history = history.unwrap();
        let impacts = history
            .events
            .iter()
            .filter_map(|event| event.impact.as_ref());
        let losses = impacts.map(|impact| {
            impact.energy_before_j - impact.energy_after_j - impact.friction_j.unwrap()
        });
        let sum_j: f64 = losses.sum();
        let taken_j = history.summary.row().unwrap().energy_taken_j;
        assert!(
            sum_j > 1e-5 && (sum_j / taken_j - 1.0).abs() < 1e-12,
            "{sum_j} {taken_j}"
        );
    }
}
