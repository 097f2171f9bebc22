//! Ties of rows in motion: rest and small vibration by closed forms, rocking by an independent equation of motion, yielding and
//! breaking by areas; energies; histories side by side; and the output of a run about ties.

use std::f64::consts::PI;
use std::fs;
use std::os::unix::fs::symlink;

use crate::common::program::{
    archrock, assert_shown_output_is_printed, done, printed, refused, scenarios, stderr,
};
use crate::common::prose::{golden, shows};
use crate::common::results::{Table, json, named};
use crate::common::{parsed, pulse, run_sampled, sampled};
use archrock::dynamics::EventKind;
use archrock::mechanics::{Anchor, Drum, Row, Tie, TieEventDisplacements, TieMemory};
use archrock::studies::capacity;
use archrock::{
    Contact, ElasticJoints, ElasticProperties, FreeHinges, GroundMotion, JointStiffness, Model,
    Pulse, Request, RowOptions, Stiffness,
};
use archrock_motion::internals::lanes::Lanes;
use nalgebra::{Matrix2, Vector2};
use roxmltree::Document;

const GRAVITY_M_S2: f64 = 9.81;

/// A horizontal tie of this length to the left, at this height on the left face of a block.
fn to_the_left(
    width_m: f64,
    height_m: f64,
    length_m: f64,
    stiffness_n_m: f64,
    prestress_n: f64,
) -> Tie {
    let at_m = Vector2::new(-0.5 * width_m, height_m);
    Tie {
        ends: [
            Anchor {
                block: Some(0),
                at_m,
            },
            Anchor {
                block: None,
                at_m: at_m - Vector2::new(length_m, 0.0),
            },
        ],
        stiffness_n_m,
        prestress_n,
        yield_force_n: f64::INFINITY,
        breaks_at_strain: f64::INFINITY,
    }
}

/// A block of 4 x 0.8 m, 6400 kg.
fn block(tie: Option<Tie>) -> Row {
    let drum = Drum {
        height_m: 4.0,
        base_width_m: 0.8,
        top_width_m: 0.8,
    };
    let row = Row::stack(&[drum], 1.0, 2000.0).unwrap();
    row.with_ties(tie.into_iter().collect(), GRAVITY_M_S2)
        .unwrap()
}

fn joints(stiffness_pa_m: f64) -> ElasticProperties {
    ElasticProperties {
        stiffness: Stiffness::Uniform(JointStiffness {
            normal_pa_m: stiffness_pa_m,
            shear_pa_m: stiffness_pa_m,
        }),
        damping_time_s: 0.0,
        friction_coefficient: None,
        contact: Contact::Continuous,
        ..ElasticProperties::of_stiffness(stiffness_pa_m)
    }
}

/// The frequency between two limits at which a signal is strongest, in Hz, by a Fourier integral with a smooth window.
fn strongest_hz(step_s: f64, signal: &[f64], [mut low, mut high]: [f64; 2]) -> f64 {
    let count = signal.len() as f64;
    let window = |index: usize| {
        let phase = 2.0 * PI * (index as f64 + 0.5) / count;
        // Blackman's window.
        0.42 - 0.5 * phase.cos() + 0.08 * (2.0 * phase).cos()
    };
    let whole: f64 = (0..signal.len()).map(window).sum();
    let mean = signal
        .iter()
        .enumerate()
        .map(|(index, value)| window(index) * value)
        .sum::<f64>()
        / whole;
    let power = |hz: f64| {
        let (mut cos, mut sin) = (0.0, 0.0);
        for (index, value) in signal.iter().enumerate() {
            let phase = 2.0 * PI * hz * index as f64 * step_s;
            cos += window(index) * (value - mean) * phase.cos();
            sin += window(index) * (value - mean) * phase.sin();
        }
        cos.hypot(sin)
    };
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if power(low + third) < power(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    0.5 * (low + high)
}

/// A block on a closed elastic base: two linear equations give the remaining force of the tie after the base has compressed, and
/// the frequencies of slip and tilt.
#[test]
fn a_tied_block_obeys_two_linear_equations() {
    let (width, height, mass) = (0.8, 4.0, 6400.0);
    let (normal, stiffness, force_n, at) = (1e10, 1e7, 1e3, 3.5);
    let weight_n = mass * GRAVITY_M_S2;
    let held = |stiffness: f64| {
        Matrix2::new(
            normal * width + stiffness,
            stiffness * at,
            stiffness * at,
            normal * f64::powi(width, 3) / 12.0 + stiffness * at * at - 0.5 * weight_n * height,
        )
    };
    let masses = Matrix2::new(
        mass,
        0.5 * mass * height,
        0.5 * mass * height,
        mass * (width * width / 12.0 + height * height / 3.0),
    );
    let frequencies_hz = |stiffness: f64| {
        let squares = (masses.try_inverse().unwrap() * held(stiffness)).complex_eigenvalues();
        let mut hz: Vec<f64> = squares
            .iter()
            .map(|square| square.re.sqrt() / (2.0 * PI))
            .collect();
        hz.sort_by(f64::total_cmp);
        hz
    };
    let moved = held(stiffness).try_inverse().unwrap() * Vector2::new(1.0, at) * force_n;
    let left_n = force_n - stiffness * (moved.x + at * moved.y);
    assert!((left_n - 776.130_03).abs() < 1e-5 && (moved.y - 6.369e-6).abs() < 1e-9);
    let hz = frequencies_hz(stiffness);
    assert!((hz[0] - 20.020_013).abs() < 1e-6 && (hz[1] - 352.020_615).abs() < 1e-6);

    let tie = to_the_left(width, at, 3.0, stiffness, force_n);
    for (tie, due_hz) in [(Some(tie), hz[0]), (None, frequencies_hz(0.0)[0])] {
        let model = ElasticJoints::new(block(tie), joints(normal)).unwrap();
        let rest = model.rest(GRAVITY_M_S2).unwrap();
        if tie.is_some() {
            // The second-order effect of the rotation is some 1e-6 of the force.
            assert!((rest.ties[0].force_n.0[0] - left_n).abs() < 2e-3);
            assert!((rest.moved[0][2] - moved.y).abs() < 1e-11);
        }
        // A steady push far too small to open the base excites the first frequency.
        let model = model.with_longest_step_s(4e-5).unwrap();
        let ground = pulse(Pulse::Rectangular, -1e-4, 3.0);
        let (_, samples) = run_sampled(&model, &ground, &sampled(2.0, 1e-3));
        let tilts: Vec<f64> = samples
            .iter()
            .map(|sample| sample.rotations_rad[0])
            .collect();
        let found_hz = strongest_hz(1e-3, &tilts, [0.9 * due_hz, 1.1 * due_hz]);
        assert!(
            (found_hz / due_hz - 1.0).abs() < 2e-5,
            "{found_hz} {due_hz}"
        );
    }
}

/// Reference motion of a rectangular block under a constant push that rotates it about its right toe: rotation in time by the
/// Runge-Kutta method, with a tie force that depends only on the length of the tie.
struct Toe {
    tie: Tie,
    push_g: f64,
}

impl Toe {
    const MASS: f64 = 6400.0;

    /// Position of a point of the block after a clockwise rotation by `angle`.
    fn at(point: Vector2<f64>, angle: f64) -> Vector2<f64> {
        let toe = Vector2::new(0.4, 0.0);
        let arm = point - toe;
        let (sin, cos) = angle.sin_cos();
        toe + Vector2::new(cos * arm.x + sin * arm.y, cos * arm.y - sin * arm.x)
    }

    fn force_n(&self, angle: f64) -> f64 {
        let [on, off] = self.tie.ends.map(|end| end.at_m);
        let stretched = (off - Self::at(on, angle)).norm() - (off - on).norm();
        (self.tie.prestress_n + self.tie.stiffness_n_m * stretched).max(0.0)
    }

    fn acceleration(&self, angle: f64) -> f64 {
        let toe = Vector2::new(0.4, 0.0);
        let centre = Self::at(Vector2::new(0.0, 2.0), angle) - toe;
        let load = Vector2::new(self.push_g, -1.0) * (Self::MASS * GRAVITY_M_S2);
        let [on, off] = self.tie.ends.map(|end| end.at_m);
        let point = Self::at(on, angle);
        let pull = (off - point).normalize() * self.force_n(angle);
        let moment = centre.perp(&load) + (point - toe).perp(&pull);
        let inertia = Self::MASS * (16.0 + 0.64) / 3.0;
        -moment / inertia
    }

    /// Rotations at equal times.
    fn rotations(&self, step_s: f64, count: usize) -> Vec<f64> {
        let substeps = 50;
        let h = step_s / f64::from(substeps);
        let (mut q, mut v) = (0.0, 0.0);
        let mut rotations = vec![0.0];
        for _ in 1..count {
            for _ in 0..substeps {
                let k1 = (v, self.acceleration(q));
                let k2 = (v + 0.5 * h * k1.1, self.acceleration(q + 0.5 * h * k1.0));
                let k3 = (v + 0.5 * h * k2.1, self.acceleration(q + 0.5 * h * k2.0));
                let k4 = (v + h * k3.1, self.acceleration(q + h * k3.0));
                q += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
                v += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
            }
            rotations.push(q);
        }
        rotations
    }
}

/// On a rigid base, under a push above the onset, the block swings on its toe about the equilibrium of tie, weight and push, and
/// returns.
#[test]
fn a_tied_block_swings_on_its_toe() {
    let tie = to_the_left(0.8, 3.5, 3.0, 1e6, 5e3);
    let model = FreeHinges::new(block(Some(tie))).unwrap();
    let push_g = 0.4;
    let (history, samples) = run_sampled(
        &model,
        &pulse(Pulse::Rectangular, -push_g, 3.0),
        &sampled(0.33, 1e-3),
    );
    let toe = Toe { tie, push_g };
    let due = toe.rotations(1e-3, samples.len() - 1);
    // A linear oscillator swings to twice its equilibrium.
    let balance = 6.282_13e-4;
    let top = due.iter().copied().fold(0.0, f64::max);
    assert!((top / (2.0 * balance) - 1.0).abs() < 1e-3, "{top}");
    for (sample, due) in samples.iter().zip(&due) {
        // The error of steps of 1.5e-4 s is the square of their part of a radian of the swing.
        assert!(
            (sample.rotations_rad[0] + due).abs() < 1e-5 * top,
            "{} {due}",
            sample.time_s
        );
        let force_n = sample.ties[0].force_n;
        assert!((force_n - toe.force_n(*due)).abs() < 0.1, "{force_n}");
    }
    let peak_n = history.summary.row().unwrap().ties[0].peak_force_n;
    assert!((peak_n - toe.force_n(top)).abs() < 1.0, "{peak_n}");
    // At 0.340 s, the period for 2.941541 Hz, the block is back and almost at rest.
    let back = due.last().unwrap() / top;
    assert!(back < 0.02, "{back}");
    assert!(history.summary.energy_defect_ratio < 1e-9);
}

fn stiff_ground(row: Row) -> ElasticJoints {
    let properties = ElasticProperties {
        damping_time_s: 1e-4,
        ..joints(1e10)
    };
    ElasticJoints::new(row, properties).unwrap()
}

/// On slender piers with a stiff tie between its springings, an arch at rest has the thrust and the crown opening that it has on
/// fixed supports. Without much of a tie the piers give way. Joints are elastic.
#[test]
fn a_stiff_tie_on_piers_is_equivalent_to_fixed_supports() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 20\n\
                [elastic_joints]\nnormal_stiffness_gpa_m = 10.0\n";
    let rest = |more: &str, crown: usize| {
        let scenario = parsed(&format!("{arch}{more}"));
        let model = scenario.model().unwrap();
        let still = pulse(Pulse::HalfSine, 1e-9, 1e-3);
        let history = model.history(&still, &sampled(1e-3, 1e-3)).unwrap();
        let first = history.samples.iter().next().unwrap();
        let tie_n = first.ties.first().map_or(0.0, |tie| tie.force_n);
        [
            first.pressures[crown].normal_n,
            first.gaps_m[crown][0],
            tie_n,
        ]
    };
    let [thrust_n, gap_m, _] = rest("", 10);
    // Many ties of the largest stiffness, side by side.
    let tied = |count: usize, stiffness_n_m: f64| {
        let piers = "[piers]\nheight_m = 1.0\nwidth_m = 1.2\nblocks = 1\n";
        let tie = format!("[[tie]]\nbetween = \"springings\"\nstiffness_n_m = {stiffness_n_m:e}\n");
        let [thrust_n, gap_m, tie_n] = rest(&format!("{piers}{}", tie.repeat(count)), 11);
        let ties_n = tie_n * count as f64;
        [thrust_n, gap_m, ties_n]
    };
    let [stiff_n, stiff_m, tie_n] = tied(100, 1e10);
    // Measured 4e-4 and 7e-3. The remaining difference comes from the tops of the piers, which rotate by 6e-7 while blocks of the
    // arch rotate by 1e-4.
    assert!(
        (stiff_n / thrust_n - 1.0).abs() < 1e-3,
        "{stiff_n} {thrust_n}"
    );
    assert!((stiff_m / gap_m - 1.0).abs() < 1e-2, "{stiff_m} {gap_m}");
    // The tie, not the piers, holds the thrust.
    assert!(tie_n > 0.9 * thrust_n && tie_n < thrust_n, "{tie_n}");
    let [_, soft_m, _] = tied(1, 1e8);
    assert!(soft_m > 1.5 * gap_m, "{soft_m} {gap_m}");
}

fn slipping(row: Row, coefficient: f64) -> FreeHinges {
    let options = RowOptions {
        friction_coefficient: Some(coefficient),
        ..RowOptions::default()
    };
    FreeHinges::new(row).unwrap().with_options(options).unwrap()
}

/// With so much friction that nothing slips, the block swings on its toe as in [`a_tied_block_swings_on_its_toe`].
#[test]
fn a_tied_block_whose_base_could_slip_swings_on_its_toe() {
    let tie = to_the_left(0.8, 3.5, 3.0, 1e6, 5e3);
    let push_g = 0.4;
    let (history, samples) = run_sampled(
        &slipping(block(Some(tie)), 10.0),
        &pulse(Pulse::Rectangular, -push_g, 3.0),
        &sampled(0.33, 1e-3),
    );
    let due = Toe { tie, push_g }.rotations(1e-3, samples.len() - 1);
    let top = due.iter().copied().fold(0.0, f64::max);
    for (sample, due) in samples.iter().zip(&due) {
        // The error of equal steps of 5e-5 s is the square of their part of a radian of the swing.
        assert!(
            (sample.rotations_rad[0] + due).abs() < 1e-5 * top,
            "{} {due}",
            sample.time_s
        );
    }
    assert!(history.summary.energy_defect_ratio < 1e-9);
}

/// A push drives a low block along its base against a tie. In half a period the block moves twice as far as to the equilibrium of
/// friction, push and tie, and sticks there.
#[test]
fn a_block_slides_against_its_tie() {
    let [stiffness_n_m, coefficient, push_g, mass_kg] = [1e5, 0.3, 0.5, 6400.0];
    let drum = Drum {
        height_m: 0.8,
        base_width_m: 4.0,
        top_width_m: 4.0,
    };
    // The tie is so long that it stays level.
    let tie = to_the_left(4.0, 0.4, 1e5, stiffness_n_m, 0.0);
    let row = Row::stack(&[drum], 1.0, 2000.0).unwrap();
    let row = row.with_supports_that_extend([true; 2]);
    let row = row.with_ties(vec![tie], GRAVITY_M_S2).unwrap();
    let (history, samples) = run_sampled(
        &slipping(row, coefficient),
        &pulse(Pulse::Rectangular, -push_g, 3.0),
        &sampled(1.0, 1e-2),
    );
    let far_m = 2.0 * mass_kg * (push_g - coefficient) * GRAVITY_M_S2 / stiffness_n_m;
    let rate = (stiffness_n_m / mass_kg).sqrt();
    for sample in &samples {
        let phase = (rate * sample.time_s).min(PI);
        let due_m = 0.5 * far_m * (1.0 - phase.cos());
        // Steps are 4e-5 s long. The block sticks at the end of the step in which it stops, and a tie that is not exactly level
        // is longer by a millionth.
        assert!(
            (sample.offsets_m[0] - due_m).abs() < 1e-6 * far_m,
            "{} {} {due_m}",
            sample.time_s,
            sample.offsets_m[0]
        );
        let force_n = sample.ties[0].force_n;
        assert!((force_n / stiffness_n_m - due_m).abs() < 1e-6 * far_m);
    }
    let of_row = history.summary.row().unwrap();
    let rubbed_j = of_row.sliding.as_ref().unwrap().friction_j;
    let due_j = coefficient * mass_kg * GRAVITY_M_S2 * far_m;
    assert!((rubbed_j / due_j - 1.0).abs() < 1e-5, "{rubbed_j} {due_j}");
    assert!(history.summary.energy_defect_ratio < 1e-7);
}

/// A yielding tie dissipates its force times its plastic elongation, with rigid and with elastic joints. The total energy
/// balances, better with shorter steps.
#[test]
fn a_yielding_tie_takes_the_area_of_its_loop() {
    let tie = Tie {
        yield_force_n: 1.2e4,
        ..to_the_left(0.8, 3.5, 3.0, 1e7, 5e3)
    };
    let ground = pulse(Pulse::HalfSine, -0.6, 0.4);
    let free = |step_s| {
        let options = RowOptions {
            longest_step_s: Some(step_s),
            ..RowOptions::default()
        };
        FreeHinges::new(block(Some(tie)))
            .unwrap()
            .with_options(options)
            .unwrap()
    };
    let elastic = stiff_ground(block(Some(tie)));
    let models: [(&dyn Model, f64); 3] =
        [(&free(1e-4), 2e-6), (&free(5e-5), 5e-7), (&elastic, 1e-6)];
    let mut yielded = Vec::new();
    for (model, defect) in models {
        let history = model.history(&ground, &sampled(4.0, 1e-3)).unwrap();
        let summary = &history.summary;
        let reported = summary.row().unwrap().ties[0];
        assert_eq!(reported.peak_force_n, 1.2e4);
        assert!(reported.yielded_m > 1e-3, "{}", reported.yielded_m);
        // The step in which each yielding begins is not exact.
        let area_j = 1.2e4 * reported.yielded_m;
        assert!(
            (reported.taken_j / area_j - 1.0).abs() < 2e-3,
            "{} {area_j}",
            reported.taken_j
        );
        assert!(
            summary.energy_defect_ratio < defect,
            "{:e}",
            summary.energy_defect_ratio
        );
        // Force and elongation at every instant lie on the loop.
        let mut yielded_m = 0.0_f64;
        for sample in history.samples.iter() {
            let now = sample.ties[0];
            assert!((0.0..=1.2e4).contains(&now.force_n));
            let plastic_m = now.elongation_m - (now.force_n - 5e3) / 1e7;
            if now.force_n > 0.0 {
                assert!(plastic_m > yielded_m - 1e-9);
                yielded_m = yielded_m.max(plastic_m);
            } else {
                assert!(now.elongation_m <= yielded_m - 5e-4 + 1e-9);
            }
        }
        let events: Vec<_> = history
            .events
            .iter()
            .filter(|event| event.tie == Some(0))
            .collect();
        assert_eq!(events.len(), 1);
        assert_eq!(events[0].kind, EventKind::TieYields);
        assert_eq!(Some(events[0].time_s), reported.yielded_s);
        yielded.push(reported.yielded_m);
    }
    assert!((yielded[0] / yielded[1] - 1.0).abs() < 1e-3, "{yielded:?}");
}

/// A tie is stretched until it yields, released, and stretched until it breaks. The dissipated energy plus the elastic energy is
/// the area under its law. If steps end at the bends of the law, this is at every instant the integral of its force by
/// trapezoids.
#[test]
fn a_tie_that_is_stretched_takes_the_area_under_its_law() {
    let tie = Tie {
        yield_force_n: 1.2e4,
        breaks_at_strain: 2e-3,
        ..to_the_left(0.8, 3.5, 3.0, 1e7, 0.0)
    };
    // The tie yields at 1.2 mm, goes slack at 2.8 mm after 4 mm, carries again from there, and breaks at 6 mm.
    let bends_m = [0.0, 1.2e-3, 4e-3, 2.8e-3, 2.5e-3, 2.8e-3, 4e-3];
    for steps in [1, 10, 100] {
        let mut memory = TieMemory::stretched(&tie, 0.0, Lanes([0.0]));
        let mut trapezoid_j = 0.0;
        let mut stretch = |memory: &mut TieMemory<Lanes<1>>, to_m: f64| {
            let (force_n, from_m) = (memory.force_n.0[0], memory.stretch_m.0[0]);
            memory.stretch(&tie, Lanes([to_m]));
            trapezoid_j += 0.5 * (force_n + memory.force_n.0[0]) * (to_m - from_m);
            let held_j = memory.taken_j.0[0] + memory.energy_j(&tie).0[0];
            assert!(
                (held_j - trapezoid_j).abs() < 1e-12,
                "{to_m} {held_j} {trapezoid_j}"
            );
        };
        for way in bends_m.windows(2) {
            for step in 1..=steps {
                let part = f64::from(step) / f64::from(steps);
                stretch(&mut memory, way[0] + (way[1] - way[0]) * part);
            }
        }
        // Further stretching beyond the break; the step that breaks the tie may end anywhere.
        let step_m = 2.9e-3 / f64::from(steps);
        for step in 1..=steps {
            stretch(&mut memory, 4e-3 + step_m * f64::from(step));
        }
        assert!(memory.intact.0[0] == 0.0 && memory.force_n.0[0] == 0.0);
        let area_j = 1.2e4 * (6e-3 - 1.2e-3) + 0.5 * 1.2e4 * 1.2e-3;
        let off_j = memory.taken_j.0[0] - area_j;
        assert!(off_j.abs() < 0.51 * 1.2e4 * step_m, "{off_j}");
    }
}

/// A broken tie loses its elastic energy and has no force. With a tie that breaks the block overturns; with one that holds it
/// does not.
#[test]
fn a_broken_tie_has_no_force() {
    let whole = to_the_left(0.8, 3.5, 3.0, 1e7, 5e3);
    let broken = Tie {
        breaks_at_strain: 5e-4,
        ..whole
    };
    let ground = pulse(Pulse::HalfSine, -0.9, 0.8);
    for elastic in [false, true] {
        let model = |tie: Tie| -> Box<dyn Model> {
            if elastic {
                Box::new(stiff_ground(block(Some(tie))))
            } else {
                Box::new(FreeHinges::new(block(Some(tie))).unwrap())
            }
        };
        let holds = model(whole)
            .history(&ground, &sampled(4.0, 1e-3))
            .unwrap()
            .summary;
        assert!(holds.overturned_s().is_none());
        let history = model(broken).history(&ground, &sampled(4.0, 1e-3)).unwrap();
        assert!(
            history.summary.overturned_s().is_some(),
            "{elastic} {:?}",
            history.summary
        );
        let reported = history.summary.row().unwrap().ties[0];
        let at_s = reported.broken_s.unwrap();
        let kinds: Vec<_> = history
            .events
            .iter()
            .filter(|event| event.tie.is_some())
            .collect();
        assert!(kinds.len() == 1 && kinds[0].kind == EventKind::TieBreaks);
        // It breaks at its limiting strain, with the force and the energy of that strain.
        let force_n = 1e7 * 5e-4 * whole.slack_length_m();
        assert!(
            (reported.peak_force_n / force_n - 1.0).abs() < 1e-9,
            "{}",
            reported.peak_force_n
        );
        assert!((reported.taken_j / (0.5 * force_n * force_n / 1e7) - 1.0).abs() < 0.02);
        assert!(
            reported.force_n == 0.0 && reported.elastic_j == 0.0 && reported.yielded_s.is_none()
        );
        for sample in history.samples.iter() {
            assert_eq!(
                sample.ties[0].force_n == 0.0,
                sample.time_s >= at_s,
                "{}",
                sample.time_s
            );
        }
        assert!(history.summary.energy_defect_ratio < 1e-3);
    }
}

/// Histories with ties computed side by side are bit-identical to single histories.
#[test]
fn ties_computed_side_by_side_equal_single_histories() {
    let tie = Tie {
        yield_force_n: 1.2e4,
        breaks_at_strain: 5e-3,
        ..to_the_left(0.8, 3.5, 3.0, 1e7, 5e3)
    };
    let model = stiff_ground(block(Some(tie)));
    let cases: Vec<(GroundMotion, Request)> = (0..10)
        .map(|case| {
            let amplitude_g = -0.3 - 0.07 * f64::from(case);
            (pulse(Pulse::HalfSine, amplitude_g, 0.4), sampled(1.5, 0.01))
        })
        .collect();
    let mut breaks = 0;
    for ((ground, request), together) in cases.iter().zip(model.simulate_all(&cases)) {
        let together = together.unwrap();
        let alone = model.simulate(ground, request, None).unwrap();
        assert_eq!(alone.row().unwrap().ties, together.row().unwrap().ties);
        assert_eq!(alone.peak_rotations_rad, together.peak_rotations_rad);
        breaks += usize::from(alone.row().unwrap().ties[0].broken_s.is_some());
    }
    assert!((1..10).contains(&breaks), "{breaks}");
}

/// A symmetric arch with symmetric ties sways left as it sways right.
#[test]
fn tied_arches_have_mirror_images() {
    let ring = crate::common::ring(0.15, 157.5);
    let row = Row::arch(&ring, 10, 5.0, 1.0, 2000.0).unwrap();
    let end = |joint: usize, block: usize| Anchor {
        block: Some(block),
        at_m: row.joints[joint].intrados_m,
    };
    let tie = Tie {
        ends: [end(2, 2), end(8, 7)],
        yield_force_n: 2e4,
        ..to_the_left(0.8, 3.5, 3.0, 1e7, 5e3)
    };
    let row = row.with_ties(vec![tie], GRAVITY_M_S2).unwrap();
    let peaks = |model: &dyn Model, amplitude_g: f64| {
        let ground = pulse(Pulse::OneSine, amplitude_g, 0.3);
        let summary = model.simulate(&ground, &sampled(0.3, 0.01), None).unwrap();
        let tie = summary.row().unwrap().ties[0];
        (summary.peak_rotations_rad, tie.peak_force_n)
    };
    let free = FreeHinges::new(row.clone()).unwrap();
    let elastic = stiff_ground(row);
    let models: [(&dyn Model, f64); 2] = [(&free, 1e-5), (&elastic, 1e-5)];
    for (model, tolerance) in models {
        let (right, right_n) = peaks(model, -0.7);
        let (left, left_n) = peaks(model, 0.7);
        assert!(
            (right_n / left_n - 1.0).abs() < tolerance,
            "{right_n} {left_n}"
        );
        let largest = right.iter().copied().fold(0.0, f64::max);
        assert!(largest > 1e-4);
        for (right, left) in right.iter().zip(left.iter().rev()) {
            assert!((right - left).abs() < tolerance * largest, "{right} {left}");
        }
    }
}

/// Tables, summary, words, pictures and page of a run report ties. Models without ties refuse them with the reason.
#[test]
fn a_run_reports_its_ties() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n\
                [[tie]]\nfrom_m = [-0.4, 3.5]\nto_m = [-3.4, 3.5]\nto_block = 0\nstiffness_n_m = 1e7\nprestress_n = 5000.0\n\
                yield_force_n = 12000.0\nbreaks_at_strain = 0.004\n\
                [elastic_joints]\nnormal_stiffness_gpa_m = 1.0\n\
                [ground.half_sine]\namplitude_g = -0.6\nduration_s = 0.4\n[simulation]\nduration_s = 1.0\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    for hinges in ["elastic", "free"] {
        let run = [
            "run",
            "s.toml",
            "--out",
            hinges,
            "--no-repeat",
            "--hinges",
            hinges,
            "--snapshots",
            "0.1,0.8",
        ];
        let run: Vec<&str> = run
            .into_iter()
            .chain(["--set", "tie.1.breaks_at_strain=0.003"])
            .collect();
        done(folder.path(), &run);
        let results = folder.path().join(hinges);
        let joints = Table::read(results.join("joints.csv"));
        let forces_n = joints.numbers("tie_1_force_n");
        let elongations_m = joints.numbers("tie_1_elongation_m");
        assert!(
            forces_n
                .iter()
                .all(|force_n| (0.0..=12_000.0).contains(force_n))
        );
        assert!(forces_n[0] > 1000.0 && elongations_m[0].abs() < 4.1e-4);
        let events = Table::read(results.join("events.csv"));
        let of_tie = events.rows.iter().filter(|row| !row["tie"].is_empty());
        let of_tie: Vec<_> = of_tie
            .map(|row| (row["kind"].clone(), row["tie"].clone()))
            .collect();
        let due = ["tie_yields", "tie_breaks"].map(|kind| (kind.to_owned(), "1".to_owned()));
        assert_eq!(of_tie, due, "{hinges}");
        let summary = std::fs::read_to_string(results.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let tie = &summary["ties"][0];
        assert_eq!(tie["peak_force_n"], 12_000.0);
        assert!(tie["broken_s"].as_f64() > tie["yielded_s"].as_f64());
        assert_eq!(tie["force_n"], 0.0);
        // The tie yields at 12 kN up to its limiting strain, and then loses its elastic energy. It dissipates the area under its
        // law, except for half of the elongation in the step in which it breaks, some 0.1 mm.
        let due_j = 12_000.0 * (0.003 * 2.9995 - 0.0012) + 0.5 * 12_000.0 * 0.0012;
        let taken_j = tie["taken_j"].as_f64().unwrap();
        assert!((taken_j / due_j - 1.0).abs() < 6e-3, "{taken_j} {due_j}");
        let snapshots = std::fs::read_to_string(results.join("snapshots.svg")).unwrap();
        let snapshots = Document::parse(&snapshots).unwrap();
        assert_eq!(
            (
                named(&snapshots, "tie").len(),
                named(&snapshots, "broken tie").len()
            ),
            (1, 2),
            "whole in the first picture, its two ends in the second"
        );
        let page = std::fs::read_to_string(results.join("report.html")).unwrap();
        assert!(page.contains("\"ties\":[[[0,-0.4,3.5],[-1,-3.4,3.5]]]"));
        assert!(page.contains(&format!("\"ties_broken_s\":[{}]", tie["broken_s"])));
        assert!(page.contains("12.000 kN"));
    }
    // Limit analysis reports what it ignores, without a remedy; a threshold has its curve for rigid joints.
    let limit = printed(folder.path(), &["limit", "s.toml"]);
    assert!(!limit.contains("give ["), "{limit}");
    let threshold = [
        "threshold",
        "s.toml",
        "--out",
        "t",
        "--from",
        "1",
        "--to",
        "3",
        "--stride",
        "0.5",
        "--set",
        "elastic_joints.friction_coefficient=0.7",
    ];
    golden("threshold-of-ties", &printed(folder.path(), &threshold));
    let refuses = |arguments: &[&str], words: &str| {
        let all: Vec<&str> = arguments.iter().copied().chain(["--out", "none"]).collect();
        refused(folder.path(), &all, &[words]);
    };
    let four = "four links cannot have ties";
    refuses(&["run", "s.toml", "--hinges", "four"], four);
    let words = printed(folder.path(), &["capacity", "s.toml", "--out", "curve"]);
    let reported = json(&folder.path().join("curve/capacity.json"));
    let sides = capacity(&parsed(text), None).unwrap();
    let [right, left] = sides.map(|side| side.clone().unwrap()).into();
    for side in [&right, &left] {
        let TieEventDisplacements {
            yields_at_m,
            breaks_at_m,
        } = side.ties[0];
        let tie = &reported["capacity"][side.sway.name()]["ties"];
        let due = serde_json::json!([{ "yields_at_m": yields_at_m, "breaks_at_m": breaks_at_m }]);
        assert_eq!(*tie, due);
    }
    // The crown is at 4 m, the tie at 3.5 m. Its elongation is 0.7 mm at yielding, and 0.4 % less the prestress at the break. In
    // a sway to the left it goes slack.
    let [yields_m, breaks_m] = [right.ties[0].yields_at_m, right.ties[0].breaks_at_m];
    let due_m = [0.0007, 0.004 * 2.9995 - 0.0005].map(|longer_m| longer_m * 4.0 / 3.5);
    for (told_m, due_m) in [yields_m, breaks_m].into_iter().zip(due_m) {
        assert!((told_m.unwrap() / due_m - 1.0).abs() < 2e-3, "{told_m:?}");
    }
    shows(&words, &[yields_m.unwrap(), breaks_m.unwrap()]);
    golden("capacity-of-ties", &words);
    let released = "initial={sway='right', rotation_rad=0.01}";
    refuses(
        &["run", "s.toml", "--hinges", "free", "--set", released],
        "cannot be combined with [[tie]]",
    );
}

/// The commands in docs/ties.md, an example that finds the section a tie needs, print the output shown there.
#[test]
fn commands_print_the_output_shown_in_docs_ties() {
    let folder = tempfile::tempdir().unwrap();
    symlink(scenarios(), folder.path().join("scenarios")).unwrap();
    assert_eq!(
        assert_shown_output_is_printed("docs/ties.md", folder.path()),
        6
    );
}

/// Two hundred bars of 1e10 N/m at the haunches of an arch need steps of 3.5 microseconds. The run is refused before it starts, with the remedies.
#[test]
fn ties_too_stiff_for_the_steps_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let ties: String = (0..200)
        .map(|tie| {
            format!(
                "[[tie]]\nheight_m = {:.4}\nstiffness_n_m = 1e10\nprestress_n = 100\n",
                0.5 + 0.0175 * f64::from(tie)
            )
        })
        .collect();
    let arch = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\nvoussoirs = 24\n[free_hinges]\n";
    let ground = "[ground.one_sine]\namplitude_g = 0.5\nduration_s = 0.5\n";
    fs::write(
        folder.path().join("s.toml"),
        format!("{arch}{ground}{ties}"),
    )
    .unwrap();
    let output = archrock(folder.path(), &["run", "s.toml"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for words in ["the ties are too stiff", "combine ties", "longest_step_s"] {
        assert!(message.contains(words), "{message}");
    }
    assert!(!folder.path().join("results").exists());
}
