//! Columns with loads, compared with hand statics, momentum theorems, an independent integrator, symmetries and energies.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::ControlFlow;

use crate::common::{Random, least, pulse, runge_kutta};
use archrock::mechanics::{
    Anchor, ColumnLoadError, MechanismChain as _, MechanismState, NoWallRatio, PlacedLoad, Ring,
    Row, RowError, Tie,
};
use archrock::{
    BackWall, Column, ElasticJoints, ElasticProperties, FreeHinges, GroundMotion, History,
    ImpactModel, Initial, MechanismModel as _, Model, Outcome, Pulse, Recorder, Request,
    RockingColumn, RowOptions, Sample, Sway,
};
use nalgebra::Vector2;

const GRAVITY_M_S2: f64 = 9.81;

const REQUEST: Request = Request {
    gravity_m_s2: GRAVITY_M_S2,
    end_s: 30.0,
    outcome_by_s: None,
    output_step_s: 0.01,
    initial: None,
    relative_tolerance: 1e-12,
    rest_energy_ratio: 1e-8,
};

const DENSITY_KG_M3: f64 = 2000.0;

/// A column as a block and points with masses and forces, by sums over all of them.
#[derive(Clone, Debug)]
struct Body {
    width_m: f64,
    /// Moment of inertia of the block about its centre.
    central_kg_m2: f64,
    /// Masses: the block, then the loads.
    masses: Vec<(f64, Vector2<f64>)>,
    forces: Vec<(Vector2<f64>, Vector2<f64>)>,
}

/// Returns a load at a point of the column.
fn load(mass_kg: f64, [x_m, y_m]: [f64; 2], moves: bool, thrust_n: f64) -> PlacedLoad {
    PlacedLoad {
        moves,
        thrust_n,
        height_m: Some(y_m),
        ..PlacedLoad::mass(mass_kg, x_m)
    }
}

fn column([height_m, width_m]: [f64; 2], loads: &[PlacedLoad]) -> Column {
    let column = Column::new(height_m, width_m).unwrap();
    column.with_loads(loads.to_vec(), GRAVITY_M_S2).unwrap()
}

fn model(column: &Column) -> RockingColumn {
    RockingColumn::new(column, ImpactModel::MaxRestitution).unwrap()
}

impl Body {
    fn new([height_m, width_m]: [f64; 2], loads: &[PlacedLoad]) -> Self {
        let block_kg = DENSITY_KG_M3 * height_m * width_m;
        let mut body = Self {
            width_m,
            central_kg_m2: block_kg * (height_m * height_m + width_m * width_m) / 12.0,
            masses: vec![(block_kg, Vector2::new(0.0, 0.5 * height_m))],
            forces: Vec::new(),
        };
        for load in loads {
            let at_m = Vector2::new(load.x_m, load.height_m.unwrap());
            body.forces.push((at_m, Vector2::new(load.thrust_n, 0.0)));
            if load.moves {
                body.masses.push((load.mass_kg, at_m));
            } else {
                let weight_n = load.mass_kg * GRAVITY_M_S2;
                body.forces.push((at_m, Vector2::new(0.0, -weight_n)));
            }
        }
        body
    }

    /// Mirror image for a sway to the left, itself for a sway to the right.
    fn towards(&self, sway: Sway) -> Self {
        let mirror = |v: Vector2<f64>| Vector2::new(sway.sign() * v.x, v.y);
        let masses = self.masses.iter().map(|(kg, at_m)| (*kg, mirror(*at_m)));
        let forces = self
            .forces
            .iter()
            .map(|(at_m, n)| (mirror(*at_m), mirror(*n)));
        Self {
            masses: masses.collect(),
            forces: forces.collect(),
            ..*self
        }
    }

    fn toe_m(&self) -> Vector2<f64> {
        Vector2::new(0.5 * self.width_m, 0.0)
    }

    /// Position from the right toe after a clockwise rotation about it.
    fn turned_m(&self, at_m: Vector2<f64>, q: f64) -> Vector2<f64> {
        let from = at_m - self.toe_m();
        let (sin, cos) = q.sin_cos();
        Vector2::new(from.x * cos + from.y * sin, from.y * cos - from.x * sin)
    }

    fn inertia_kg_m2(&self) -> f64 {
        let each = self.masses.iter();
        let each = each.map(|(kg, at_m)| kg * (at_m - self.toe_m()).norm_squared());
        self.central_kg_m2 + each.sum::<f64>()
    }

    /// Clockwise moment about the right toe under a horizontal and a vertical ground acceleration in g.
    fn moment_n_m(&self, q: f64, [across_g, up_g]: [f64; 2]) -> f64 {
        let moment = |at_m: Vector2<f64>, force_n: Vector2<f64>| {
            let at_m = self.turned_m(at_m, q);
            at_m.y * force_n.x - at_m.x * force_n.y
        };
        let weights = self.masses.iter().map(|(kg, at_m)| {
            moment(
                *at_m,
                Vector2::new(-across_g, -1.0 - up_g) * (kg * GRAVITY_M_S2),
            )
        });
        let forces = self.forces.iter().map(|(at_m, n)| moment(*at_m, *n));
        weights.sum::<f64>() + forces.sum::<f64>()
    }

    /// Potential energy above that at rest.
    fn potential_j(&self, q: f64) -> f64 {
        let moved = |at_m: Vector2<f64>| self.turned_m(at_m, q) - self.turned_m(at_m, 0.0);
        let weights = self.masses.iter();
        let weights = weights.map(|(kg, at_m)| kg * GRAVITY_M_S2 * moved(*at_m).y);
        let forces = self.forces.iter().map(|(at_m, n)| -n.dot(&moved(*at_m)));
        weights.sum::<f64>() + forces.sum::<f64>()
    }

    /// Rate about the left toe after an impact, for a unit rate about the right toe, by the angular momentum about the left toe.
    fn rate_passed(&self) -> f64 {
        let left_m = -self.toe_m();
        let momentum = self.masses.iter().map(|(kg, at_m)| {
            let from = at_m - self.toe_m();
            let velocity = Vector2::new(-from.y, from.x);
            kg * (at_m - left_m).perp(&velocity)
        });
        let momentum = momentum.sum::<f64>() + self.central_kg_m2;
        momentum / self.towards(Sway::Left).inertia_kg_m2()
    }

    /// Unstable equilibrium, found by bisection of the moment.
    fn critical(&self) -> f64 {
        let falls = |q: f64| self.moment_n_m(q, [0.0; 2]) >= 0.0;
        least([0.0, FRAC_PI_2], 1e-15, falls)
    }

    /// Push in g that starts a sway to the right, from the moments about the toe.
    fn onset_g(&self) -> f64 {
        let heights = self
            .masses
            .iter()
            .map(|(kg, at_m)| kg * GRAVITY_M_S2 * at_m.y);
        -self.moment_n_m(0.0, [0.0; 2]) / heights.sum::<f64>()
    }
}

/// One to three random loads, with which the column stands.
fn random_loads(random: &mut Random, [height_m, width_m]: [f64; 2]) -> Vec<PlacedLoad> {
    let block_kg = DENSITY_KG_M3 * height_m * width_m;
    loop {
        let count = 1 + random.pick(3);
        let loads = (0..count).map(|_| {
            let mass_kg = block_kg * random.within(0.0, 0.8);
            let at_m = [
                width_m * random.within(-0.7, 0.7),
                height_m * random.within(0.3, 1.0),
            ];
            let moves = random.chance(0.5);
            let thrust_n = match random.chance(0.5) {
                true => block_kg * GRAVITY_M_S2 * width_m / height_m * random.within(-0.4, 0.4),
                false => 0.0,
            };
            load(mass_kg, at_m, moves, thrust_n)
        });
        let loads: Vec<PlacedLoad> = loads.collect();
        let body = Body::new([height_m, width_m], &loads);
        if Sway::ALL
            .iter()
            .all(|sway| body.towards(*sway).onset_g() > 0.02)
        {
            return loads;
        }
    }
}

fn random_size(random: &mut Random) -> [f64; 2] {
    let height_m = random.within(1.0, 9.0);
    [height_m, height_m * random.within(0.05, 0.4)]
}

/// Statics of 200 random columns by hand: the onset, the curve up to the unstable equilibrium, and the impacts.
#[test]
fn statics_and_impacts_are_those_of_the_moments() {
    let mut random = Random(461);
    for _ in 0..200 {
        let size_m = random_size(&mut random);
        let loads = random_loads(&mut random, size_m);
        let model = model(&column(size_m, &loads));
        for sway in Sway::ALL {
            let body = Body::new(size_m, &loads).towards(*sway);
            let onset_g = model.incipient_acceleration_g(*sway).unwrap();
            assert!((onset_g / body.onset_g() - 1.0).abs() < 1e-12);
            let critical = model.critical_rotations_rad(*sway)[0].abs();
            assert!((critical - body.critical()).abs() < 1e-14);
            for part in [0.0, 0.3, 0.9] {
                let displaced = model.displaced_mechanism(*sway, part).unwrap();
                let push_g = displaced.acceleration_g;
                let scale = body.onset_g() * body.inertia_kg_m2() * GRAVITY_M_S2;
                let moment = body.moment_n_m(part * critical, [-push_g, 0.0]);
                assert!(moment.abs() < 1e-11 * scale);
            }
            let before = body.towards(Sway::Left);
            let rate = before.rate_passed();
            let restitution = rate * rate * body.inertia_kg_m2() / before.inertia_kg_m2();
            match model.restitution_from(sway.opposite(), 1) {
                Some(own) => assert!((own - restitution).abs() < 1e-12 && own <= 1.0),
                None => assert!(rate <= 0.0),
            }
        }
    }
}

/// Growth rates of disturbances: of an inverted pendulum with the moments of weight and inertia of the body.
#[test]
fn the_equivalent_block_has_the_growth_rate_of_the_body() {
    let size_m = [4.0, 0.8];
    let loads = [
        load(3000.0, [0.1, 4.0], true, 0.0),
        load(1000.0, [-0.2, 3.0], false, 2e3),
    ];
    let model = model(&column(size_m, &loads));
    for sway in Sway::ALL {
        let body = Body::new(size_m, &loads).towards(*sway);
        let critical = body.critical();
        let step = 1e-5;
        let slope =
            body.moment_n_m(critical + step, [0.0; 2]) - body.moment_n_m(critical - step, [0.0; 2]);
        let squared = slope / (2.0 * step) / body.inertia_kg_m2();
        let equivalent = model.equivalent(*sway, GRAVITY_M_S2).unwrap();
        let block = equivalent.at_critical.unwrap();
        assert!((block.frequency_rad_s.powi(2) / squared - 1.0).abs() < 1e-8);
        assert!((equivalent.slenderness_rad.tan() / body.onset_g() - 1.0).abs() < 1e-12);
    }
}

/// Four masses with the mass, the centre and the inertia of a block make a block of twice the density, which moves as the block alone.
#[test]
fn four_masses_make_a_block_of_twice_the_density() {
    let size_m = [5.0, 0.9];
    let quarter_kg = 0.25 * DENSITY_KG_M3 * size_m[0] * size_m[1];
    let arms = size_m.map(|side| side / 12.0_f64.sqrt());
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    let loads = corners.map(|(x, y)| {
        let at_m = [x * arms[1], 0.5 * size_m[0] + y * arms[0]];
        load(quarter_kg, at_m, true, 0.0)
    });
    let [heavy, alone] = [&loads[..], &[]].map(|loads| model(&column(size_m, loads)));
    let ground = pulse(Pulse::OneSine, 0.25, 0.9);
    let [heavy, alone] = [heavy, alone].map(|it| it.history(&ground, &REQUEST).unwrap());
    assert!(alone.summary.impacts > 5, "{:?}", alone.summary);
    let largest = alone.summary.peak_rotations_rad[0];
    for (one, other) in heavy.samples.iter().zip(alone.samples.iter()) {
        assert!((one.rotations_rad[0] - other.rotations_rad[0]).abs() < 1e-8 * largest);
        assert!((one.energy_j - 2.0 * other.energy_j).abs() < 1.0);
    }
}

#[test]
fn loads_of_zero_change_no_bit() {
    let size_m = [4.0, 0.8];
    let nothing = [
        load(0.0, [0.3, 4.0], true, 0.0),
        load(0.0, [0.0, 1.0], false, 0.0),
    ];
    for amplitude_g in [-0.25, 0.3] {
        let ground = pulse(Pulse::OneSine, amplitude_g, 1.0);
        let rigid = [&nothing[..], &[]].map(|loads| {
            let model = model(&column(size_m, loads));
            model.history(&ground, &REQUEST).unwrap()
        });
        assert!(rigid[0].summary.impacts > 0);
        assert_eq!(rigid[0].samples, rigid[1].samples);
        assert_eq!(rigid[0].events, rigid[1].events);
        let [loaded, alone] = [&nothing[..], &[]].map(|loads| column(size_m, loads).row().unwrap());
        assert_eq!(loaded, alone);
    }
}

/// Mirrored loads and mirrored ground give the mirrored history, to the last bit.
#[test]
fn the_mirror_image_has_the_same_bits() {
    let size_m = [6.0, 0.9];
    let history = |sign: f64| {
        let loads = [
            load(2500.0, [sign * 0.15, 6.0], true, 0.0),
            load(1500.0, [sign * -0.1, 3.0], false, sign * 4e3),
        ];
        let model = model(&column(size_m, &loads));
        let ground = pulse(Pulse::OneSine, sign * 0.18, 0.8);
        let history = model.history(&ground, &REQUEST).unwrap();
        let samples = history.samples.iter().map(|sample| {
            let values = [sample.rotations_rad[0], sample.rates_rad_s[0]];
            let turned = values.map(|value| sign * value + 0.0);
            (
                sample.time_s,
                turned,
                sample.energy_j,
                sample.demand.friction,
            )
        });
        (samples.collect::<Vec<_>>(), history.summary.impacts)
    };
    let (right, left) = (history(1.0), history(-1.0));
    assert!(right.1 > 5, "{}", right.1);
    assert_eq!(right.0, left.0);
}

/// A column that rocks about both toes, by the classical Runge-Kutta method with small steps and bisected impacts.
struct Independent {
    sides: [Body; 2],
    /// Horizontal and vertical amplitude.
    amplitudes_g: [f64; 2],
    duration_s: f64,
}

/// Time, side (0 right, 1 left) and state; no side at rest.
type Moment = (f64, Option<usize>, [f64; 2]);

impl Independent {
    /// Horizontal and vertical acceleration of the ground, in the frame of this side.
    fn ground_g(&self, side: usize, time_s: f64) -> [f64; 2] {
        let wave = match time_s < self.duration_s {
            true => (2.0 * PI * time_s / self.duration_s).sin(),
            false => 0.0,
        };
        let [across_g, up_g] = self.amplitudes_g.map(|amplitude_g| amplitude_g * wave);
        [[1.0, -1.0][side] * across_g, up_g]
    }

    fn acceleration(&self, side: usize, time_s: f64, q: f64) -> f64 {
        let body = &self.sides[side];
        body.moment_n_m(q, self.ground_g(side, time_s)) / body.inertia_kg_m2()
    }

    fn stepped(&self, side: usize, time_s: f64, state: [f64; 2], h: f64) -> [f64; 2] {
        let acceleration = |time_s, q| self.acceleration(side, time_s, q);
        runge_kutta(acceleration, time_s, state, h)
    }

    /// Returns the state after a step from rest.
    fn rested(&self, time_s: f64, h: f64) -> Moment {
        let opens = |time_s: f64| (0..2).find(|side| self.acceleration(*side, time_s, 0.0) > 0.0);
        if let Some(side) = opens(time_s) {
            return (time_s, Some(side), [0.0; 2]);
        }
        if opens(time_s + h).is_none() {
            return (time_s + h, None, [0.0; 2]);
        }
        let opens_s = least([time_s, time_s + h], 1e-14, |s| opens(s).is_some());
        (opens_s, opens(opens_s), [0.0; 2])
    }

    /// Returns the state after an impact within a step.
    fn struck(
        &self,
        side: usize,
        (time_s, state, h): (f64, [f64; 2], f64),
        barrier: f64,
    ) -> Moment {
        let is_closed = |h: f64| self.stepped(side, time_s, state, h)[0] < 0.0;
        let h = least([0.0, h], 1e-15, is_closed);
        let closing = -self.stepped(side, time_s, state, h)[1];
        let rate = closing * self.sides[side].rate_passed();
        let (time_s, other) = (time_s + h, 1 - side);
        let energy = 0.5 * self.sides[other].inertia_kg_m2() * rate * rate;
        let is_held = self.acceleration(other, time_s, 0.0) <= 0.0;
        match rate <= 0.0 || energy < REQUEST.rest_energy_ratio * barrier && is_held {
            true => (time_s, None, [0.0; 2]),
            false => (time_s, Some(other), [0.0, rate]),
        }
    }

    /// Returns the side to which it overturns, and the largest rotation.
    fn motion(&self, end_s: f64) -> (Option<usize>, f64) {
        let critical = self.sides.each_ref().map(Body::critical);
        let barriers = [0, 1].map(|side| self.sides[side].potential_j(critical[side]));
        let barrier = barriers[0].min(barriers[1]);
        let (mut now, mut peak): (Moment, f64) = ((0.0, None, [0.0; 2]), 0.0);
        while now.0 < end_s {
            let (time_s, side, state) = now;
            // Steps end at the end of the pulse.
            let mut h = 2e-4_f64;
            if time_s < self.duration_s - 1e-12 {
                h = h.min(self.duration_s - time_s);
            }
            let Some(side) = side else {
                now = self.rested(time_s, h);
                continue;
            };
            let next = self.stepped(side, time_s, state, h);
            if next[0] < 0.0 {
                now = self.struck(side, (time_s, state, h), barrier);
                continue;
            }
            // The turning point within a step, by the parabola of its start.
            if state[1] > 0.0 && next[1] <= 0.0 {
                let bend = self.acceleration(side, time_s, state[0]);
                peak = peak.max(state[0] - 0.5 * state[1] * state[1] / bend);
            }
            now = (time_s + h, Some(side), next);
            let is_lost = now.0 >= self.duration_s && next[0] > critical[side] && next[1] >= 0.0;
            if is_lost || next[0] >= FRAC_PI_2 {
                return (Some(side), peak);
            }
        }
        (None, peak)
    }
}

/// Forty random columns with loads under a sine, half of them with a vertical component, against the independent integrator: side of overturning, or
/// peak.
#[test]
fn random_loaded_columns_move_as_by_an_independent_integrator() {
    let mut random = Random(462);
    let (mut overturned, mut rocked) = (0, 0);
    for case in 0..40_u8 {
        let size_m = random_size(&mut random);
        let loads = random_loads(&mut random, size_m);
        let body = Body::new(size_m, &loads);
        let sides = [Sway::Right, Sway::Left].map(|sway| body.towards(sway));
        let onset_g = sides[0].onset_g().max(sides[1].onset_g());
        let up_g = f64::from(case % 2) * random.within(-0.7, 0.7);
        let amplitudes_g = [onset_g * random.within(-3.0, 3.0), up_g];
        let duration_s = random.within(0.3, 1.5);
        let request = Request {
            end_s: 8.0,
            output_step_s: 8.0,
            ..REQUEST
        };
        let ground = Pulse::OneSine.lasting_s(duration_s);
        let ground = ground.inclined_m_s2(Vector2::from(amplitudes_g) * GRAVITY_M_S2);
        let ground = ground.unwrap();
        let model = model(&column(size_m, &loads));
        let summary = model.history(&ground, &request).unwrap().summary;
        assert!(summary.energy_defect_ratio < 1e-8, "{case}");
        let independent = Independent {
            sides,
            amplitudes_g,
            duration_s,
        };
        let (falls, peak) = independent.motion(8.0);
        let falls = falls.map(|side| [Sway::Right, Sway::Left][side]);
        match (summary.outcome, falls) {
            (Outcome::Overturned(own), Some(falls)) => {
                assert_eq!(own, falls, "{case}");
                overturned += 1;
            }
            (_, None) => {
                let own = summary.peak_rotations_rad[0];
                let critical = independent.sides.each_ref().map(Body::critical);
                let scale = critical[0].min(critical[1]);
                assert!((own - peak).abs() < 1e-6 * scale, "{case}: {own} {peak}");
                rocked += usize::from(peak > 0.0);
            }
            (own, falls) => panic!("{case}: {own:?} {falls:?}"),
        }
    }
    assert!(overturned > 5 && rocked > 10, "{overturned} {rocked}");
}

/// The energy of every sample of a release is that of masses and forces at its rotation.
#[test]
fn energies_contain_the_work_of_constant_forces() {
    let size_m = [4.0, 0.8];
    let loads = [
        load(1500.0, [0.1, 4.0], true, 0.0),
        load(2000.0, [-0.1, 3.5], false, 3e3),
    ];
    let model = model(&column(size_m, &loads));
    for sway in [Sway::Right, Sway::Left] {
        let critical = Body::new(size_m, &loads).towards(sway).critical();
        let request = Request {
            initial: Some(Initial {
                sway,
                rotation_rad: 0.15 * critical,
                rate_rad_s: 0.0,
            }),
            ..REQUEST
        };
        let History {
            samples, summary, ..
        } = model.history(&GroundMotion::still(), &request).unwrap();
        assert!(
            summary.impacts > 5 && summary.energy_defect_ratio < 1e-9,
            "{summary:?}"
        );
        let first_j = samples.iter().next().unwrap().energy_j;
        for sample in samples.iter() {
            let turned = -sample.rotations_rad[0];
            let side = if turned >= 0.0 {
                Sway::Right
            } else {
                Sway::Left
            };
            let body = Body::new(size_m, &loads).towards(side);
            let rate = sample.rates_rad_s[0];
            let due = body.potential_j(turned.abs()) + 0.5 * body.inertia_kg_m2() * rate * rate;
            assert!((sample.energy_j - due).abs() < 1e-8 * first_j);
        }
    }
}

/// The base at rest, by hand: its reaction balances weights, push and forces.
#[test]
fn the_base_carries_weights_and_forces() {
    let loads = |sign: f64| {
        [
            load(2000.0, [sign * 0.1, 4.0], true, 0.0),
            load(1000.0, [sign * -0.05, 3.0], false, sign * 1.5e3),
        ]
    };
    let at_rest = |sign: f64| {
        let model = model(&column([4.0, 0.8], &loads(sign)));
        let body_force_g = Vector2::new(sign * 0.02, -1.0);
        let ratios = model.eccentricity_ratios_at_rest(body_force_g);
        let ratios = ratios.into_iter().map(Option::unwrap);
        let demand = model.demand_at_rest(body_force_g);
        (ratios.collect::<Vec<f64>>(), demand.friction)
    };
    let (ratios, friction) = at_rest(1.0);
    let weight_n = 9400.0 * GRAVITY_M_S2;
    let across_n = 0.02 * 8400.0 * GRAVITY_M_S2 + 1.5e3;
    assert!((friction - across_n / weight_n).abs() < 1e-12);
    let push_n = |kg: f64| 0.02 * kg * GRAVITY_M_S2;
    let moment = push_n(6400.0) * 2.0
        + push_n(2000.0) * 4.0
        + 1.5e3 * 3.0
        + GRAVITY_M_S2 * (2000.0 * 0.1 - 1000.0 * 0.05);
    assert!((ratios[0] - moment / weight_n / 0.8).abs() < 1e-12);
    // Half way up, the section carries half of the block and both loads.
    let weight_n = (3200.0 + 3000.0) * GRAVITY_M_S2;
    let moment = push_n(3200.0)
        + push_n(2000.0) * 2.0
        + 1.5e3
        + GRAVITY_M_S2 * (2000.0 * 0.1 - 1000.0 * 0.05);
    assert!((ratios[10] - moment / weight_n / 0.8).abs() < 1e-12);
    // Only the load at the top is above the top section: its push acts at the section itself.
    assert!((ratios[20] - 0.1 / 0.8).abs() < 1e-12);
    let (mirrored, _) = at_rest(-1.0);
    assert!(
        ratios
            .iter()
            .zip(&mirrored)
            .all(|(one, other)| (one + other).abs() < 1e-14)
    );
}

/// In motion, the thrust line passes through the toe, and the resultant at half height balances masses and forces above, whose accelerations come from
/// differences of positions.
#[test]
fn the_thrust_line_in_motion_balances_masses_and_forces() {
    let size_m = [4.0, 0.8];
    let loads = [
        load(2000.0, [0.1, 4.0], true, 0.0),
        load(1000.0, [-0.05, 3.0], false, 1.5e3),
    ];
    let model = model(&column(size_m, &loads));
    for sway in [Sway::Right, Sway::Left] {
        let link = model.link_from(sway, 0).unwrap();
        let body = Body::new(size_m, &loads).towards(sway);
        for (q_rad, push_g) in [(0.0, 0.4), (0.05, 0.0), (0.1, -0.1)] {
            let scale = model.length_m() / GRAVITY_M_S2;
            let (rate, push_m_s2) = (0.3, push_g * GRAVITY_M_S2);
            let acceleration = body.moment_n_m(q_rad, [-push_g, 0.0]) / body.inertia_kg_m2();
            let motion = MechanismState {
                q_rad,
                rate: rate * scale.sqrt(),
                acceleration: acceleration * scale,
                body_force_g: Vector2::new(push_g, -1.0),
            };
            let ratios = model.eccentricity_ratios(&link.mechanism, &motion);
            assert!((ratios[0].unwrap() - 0.5).abs() < 1e-12);
            let at = |at_m: Vector2<f64>, time_s: f64| {
                let turned = rate * time_s + 0.5 * acceleration * time_s * time_s;
                body.turned_m(at_m, q_rad + turned)
            };
            let section_m = at(Vector2::new(0.0, 2.0), 0.0);
            // Upper half of the block, and the roof.
            let half_kg = 0.5 * body.masses[0].0;
            let half = (half_kg, Vector2::new(0.0, 3.0));
            let turning_n_m = half_kg * (0.8_f64.powi(2) + 2.0_f64.powi(2)) / 12.0 * acceleration;
            let h = 1e-3;
            let inertial = [half, body.masses[1]].map(|(kg, at_m)| {
                let second = at(at_m, h) - 2.0 * at(at_m, 0.0) + at(at_m, -h);
                let load_m_s2 = Vector2::new(push_m_s2, -GRAVITY_M_S2) - second / (h * h);
                (at_m, load_m_s2 * kg)
            });
            let (mut force_n, mut moment_n_m) = (Vector2::zeros(), turning_n_m);
            for (at_m, n) in body.forces.iter().chain(&inertial) {
                force_n += n;
                moment_n_m += (at(*at_m, 0.0) - section_m).perp(n);
            }
            let axis = Vector2::new(q_rad.sin(), q_rad.cos());
            let due = moment_n_m / (force_n.dot(&axis) * 0.8);
            let found = ratios[10].unwrap();
            assert!((found - due).abs() < 1e-6, "{found} {due}");
        }
    }
}

/// A façade with a roof that stands against a wall: no default restitution, unless the roof is a constant force; one side, and energy.
#[test]
fn a_wall_behind_a_loaded_facade_needs_a_restitution() {
    let size_m = [8.0, 0.6];
    let thrust = load(0.0, [0.0, 6.0], true, 1e3);
    let facade = |loads: &[PlacedLoad], rate_ratio| {
        let back = BackWall {
            side: Sway::Left,
            height_m: None,
            rate_ratio,
        };
        let facade = Column::new(size_m[0], size_m[1]).unwrap();
        let facade = facade.with_back(back).unwrap();
        facade.with_loads(loads.to_vec(), GRAVITY_M_S2).unwrap()
    };
    let ratio = |loads: &[PlacedLoad]| facade(loads, None).wall_rate_ratio();
    let loads = [load(3000.0, [-0.1, 8.0], true, 0.0), thrust];
    assert_eq!(ratio(&loads), Err(NoWallRatio::Loads(3000.0)));
    // Constant forces change no momentum in an impact, which takes no time.
    let held = [load(3000.0, [-0.1, 8.0], false, 0.0), thrust];
    assert_eq!(ratio(&held), ratio(&[]));
    let facade = facade(&loads, Some(0.45));
    assert_eq!(facade.wall_rate_ratio(), Ok(Some(0.45)));
    let body = Body::new(size_m, &loads);
    let model = model(&facade);
    assert!(
        (model.incipient_acceleration_g(Sway::Right).unwrap() / body.onset_g() - 1.0).abs() < 1e-12
    );
    assert!(model.incipient_acceleration_g(Sway::Left).is_none());
    let ground = pulse(Pulse::OneSine, -0.3, 1.0);
    let history = model.history(&ground, &REQUEST).unwrap();
    assert!(history.summary.impacts > 2 && history.summary.energy_defect_ratio < 1e-9);
    assert!(
        history
            .samples
            .iter()
            .all(|sample| sample.rotations_rad[0] <= 0.0)
    );
}

#[test]
fn columns_that_cannot_stand_are_refused() {
    let column = || Column::new(4.0, 0.8).unwrap();
    let refused =
        |column: Column, one: PlacedLoad| column.with_loads(vec![one], GRAVITY_M_S2).unwrap_err();
    let overturns = |one| match refused(column(), one) {
        ColumnLoadError::Overturns(sway) => sway,
        error => panic!("{error}"),
    };
    // The block has a moment of 6400 kg x 0.4 m about its toe.
    let most_kg = 6400.0 * 0.4 / 0.6;
    assert_eq!(
        overturns(load(1.001 * most_kg, [1.0, 4.0], true, 0.0)),
        Sway::Right
    );
    assert_eq!(
        overturns(load(1.001 * most_kg, [-1.0, 4.0], false, 0.0)),
        Sway::Left
    );
    let most_n = 6400.0 * GRAVITY_M_S2 * 0.4 / 3.0;
    assert_eq!(
        overturns(load(0.0, [0.0, 3.0], true, -1.001 * most_n)),
        Sway::Left
    );
    for good in [
        load(0.999 * most_kg, [1.0, 4.0], true, 0.0),
        load(0.0, [0.0, 3.0], true, -0.999 * most_n),
    ] {
        assert!(column().with_loads(vec![good], GRAVITY_M_S2).is_ok());
    }
    // A wall carries a thrust towards it, but not one above its top.
    let back = |height_m| BackWall {
        side: Sway::Left,
        height_m: Some(height_m),
        rate_ratio: Some(0.4),
    };
    let against = |height_m| column().with_back(back(height_m)).unwrap();
    let thrust = |y_m, n| load(0.0, [0.0, y_m], true, n);
    let held = against(3.0).with_loads(vec![thrust(3.0, -5.0 * most_n)], GRAVITY_M_S2);
    assert!(held.is_ok());
    let over_top = 6400.0 * GRAVITY_M_S2 * 0.4 / 0.5;
    assert!(
        against(3.0)
            .with_loads(vec![thrust(3.5, -0.999 * over_top)], GRAVITY_M_S2)
            .is_ok()
    );
    assert_eq!(
        refused(against(3.0), thrust(3.5, -1.001 * over_top)),
        ColumnLoadError::Overturns(Sway::Left)
    );
    // A roof raises the centre of gravity above the wall.
    let error = refused(against(2.5), load(6400.0, [0.0, 4.0], true, 0.0));
    assert!(matches!(error, ColumnLoadError::Wall(_)), "{error}");
}

/// The least push over all joints that opens one of them under the drums above it, by hand.
fn onset_of_drums_g(size_m: [f64; 2], drums: usize, loads: &[PlacedLoad], sway: Sway) -> f64 {
    let [height_m, width_m] = size_m;
    let pushes = (0..drums).map(|joint| {
        let base_m = height_m * joint as f64 / drums as f64;
        let above = loads
            .iter()
            .filter(|load| load.height_m.unwrap() > base_m + 1e-9);
        let above = above.map(|load| PlacedLoad {
            height_m: load.height_m.map(|y_m| y_m - base_m),
            ..*load
        });
        let above: Vec<PlacedLoad> = above.collect();
        Body::new([height_m - base_m, width_m], &above)
            .towards(sway)
            .onset_g()
    });
    pushes.fold(f64::INFINITY, f64::min)
}

/// A roof that moves with a column of 4 m, and a floor that pushes it to the right.
fn roof_and_floor() -> [PlacedLoad; 2] {
    [
        load(1500.0, [0.1, 4.0], true, 0.0),
        load(1000.0, [-0.1, 2.5], false, 1e3),
    ]
}

/// Drums with free hinges: the onset by hand, and a single drum moves as Housner's column.
#[test]
fn drums_carry_loads() {
    let size_m = [4.0, 0.8];
    let loads = roof_and_floor();
    for drums in [1, 4] {
        let row = column(size_m, &loads)
            .with_drums(drums)
            .unwrap()
            .row()
            .unwrap();
        let stack = FreeHinges::new(row).unwrap();
        for sway in Sway::ALL {
            let due = onset_of_drums_g(size_m, drums, &loads, *sway);
            let own = stack.incipient_acceleration_g(*sway).unwrap();
            assert!((own / due - 1.0).abs() < 1e-9, "{drums} {own} {due}");
        }
    }
    let one = column(size_m, &loads);
    let ground = pulse(Pulse::OneSine, 0.3, 0.8);
    let request = Request {
        end_s: 4.0,
        ..REQUEST
    };
    let housner = model(&one).history(&ground, &request).unwrap();
    let row = FreeHinges::new(one.row().unwrap()).unwrap();
    let free = row.history(&ground, &request).unwrap();
    let mut lines = ThrustLines(Vec::new());
    row.simulate(&ground, &request, Some(&mut lines)).unwrap();
    assert!(housner.summary.impacts > 1 && free.summary.energy_defect_ratio < 1e-3);
    let [due, own] = [&housner, &free].map(|history| history.summary.peak_rotations_rad[0]);
    assert!((own / due - 1.0).abs() < 1e-3, "{own} {due}");
}

/// Recorder of thrust lines.
struct ThrustLines(Vec<Vec<Option<f64>>>);

impl Recorder for ThrustLines {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        assert!(
            sample.ties.is_empty(),
            "constant forces are no ties of results"
        );
        self.0.push(sample.eccentricity_ratios.clone());
        ControlFlow::Continue(())
    }

    fn wants_thrust_line(&self) -> bool {
        true
    }
}

/// Stiff elastic joints: the base carries the eccentricity by hand at rest, and the column moves as a rigid one before its first impact.
#[test]
fn stiff_joints_carry_loads() {
    let size_m = [4.0, 0.8];
    let loads = roof_and_floor();
    let one = column(size_m, &loads);
    let ground = pulse(Pulse::HalfSine, 0.35, 0.5);
    let request = Request {
        end_s: 0.6,
        ..REQUEST
    };
    let peak = |model: &dyn Model| {
        let summary = model.simulate(&ground, &request, None).unwrap();
        assert!(summary.energy_defect_ratio < 1e-3);
        summary.peak_rotations_rad[0]
    };
    let rigid = peak(&model(&one));
    // Joints delay the uplift: the error decreases with their stiffness, for a column without loads from 13 % to 6 %.
    let errors = [1e11, 1e12].map(|stiffness_pa_m| {
        let properties = ElasticProperties {
            damping_time_s: 0.0,
            ..ElasticProperties::of_stiffness(stiffness_pa_m)
        };
        let stiff = ElasticJoints::new(one.row().unwrap(), properties).unwrap();
        let mut lines = ThrustLines(Vec::new());
        stiff.simulate(&ground, &request, Some(&mut lines)).unwrap();
        let weight_kg = 6400.0 + 2500.0;
        let due = (1500.0 * 0.1 - 1000.0 * 0.1 + 1e3 * 2.5 / GRAVITY_M_S2) / weight_kg / 0.8;
        let ratio = lines.0[0][0].unwrap();
        assert!((ratio - due).abs() < 1e-4, "{ratio} {due}");
        (peak(&stiff) / rigid - 1.0).abs()
    });
    assert!(errors[1] < 0.6 * errors[0] && errors[1] < 0.1, "{errors:?}");
}

/// A façade with a thrust falls to the weak side after a swing to the strong one, whose barrier is twenty times higher. Until the impact the outcome
/// is open, and the time of overturning is that of the weak side in all models.
#[test]
fn the_weaker_side_decides_the_outcome() {
    let one = column([8.0, 0.6], &[load(0.0, [0.0, 6.0], true, 3e3)]);
    let request = Request {
        initial: Some(Initial {
            sway: Sway::Left,
            rotation_rad: 0.0,
            rate_rad_s: 0.0742,
        }),
        ..REQUEST
    };
    let early = Request {
        end_s: 0.2,
        ..request
    };
    let still = GroundMotion::still();
    let rigid = model(&one);
    let barriers = [Sway::Right, Sway::Left].map(|sway| rigid.link_from(sway, 0).unwrap().barrier);
    assert!(barriers[1] > 10.0 * barriers[0], "{barriers:?}");
    let outcome = rigid.simulate(&still, &early, None).unwrap().outcome;
    assert_eq!(outcome, Outcome::Incomplete);
    let due = rigid.simulate(&still, &request, None).unwrap();
    assert_eq!(due.outcome, Outcome::Overturned(Sway::Right));
    let slipping = FreeHinges::new(one.row().unwrap()).unwrap();
    let options = RowOptions {
        friction_coefficient: Some(0.7),
        ..RowOptions::default()
    };
    let slipping = slipping.with_options(options).unwrap();
    let properties = ElasticProperties {
        friction_coefficient: Some(0.7),
        ..ElasticProperties::of_stiffness(1e12)
    };
    let elastic = ElasticJoints::new(one.row().unwrap(), properties).unwrap();
    let models: [(&dyn Model, f64); 2] = [(&slipping, 0.01), (&elastic, 0.05)];
    for (model, tolerance) in models {
        let own = model.simulate(&still, &request, None).unwrap();
        assert_eq!(own.outcome, due.outcome);
        assert!(
            (own.outcome_time_s / due.outcome_time_s - 1.0).abs() < tolerance,
            "{} {}",
            own.outcome_time_s,
            due.outcome_time_s
        );
    }
}

/// A thrust away from the wall at a low point: the column stands by its toe, although without friction at the base its foot would slip out.
#[test]
fn a_column_that_stands_free_stands_before_a_wall() {
    let low = load(0.0, [0.0, 1.5], true, 5e3);
    let free = model(&column([8.0, 0.6], &[low]));
    let wall = BackWall {
        side: Sway::Left,
        height_m: None,
        rate_ratio: None,
    };
    let held = Column::new(8.0, 0.6).unwrap().with_back(wall).unwrap();
    let held = model(&held.with_loads(vec![low], GRAVITY_M_S2).unwrap());
    let starts_g = |model: &RockingColumn| model.incipient_acceleration_g(Sway::Right);
    // Weight times half the width, less the moment of the thrust, over weight times half the height.
    let weight_n = 2000.0 * 8.0 * 0.6 * GRAVITY_M_S2;
    let due_g = (weight_n * 0.3 - 5e3 * 1.5) / (weight_n * 4.0);
    for model in [free, held] {
        assert!((starts_g(&model).unwrap() / due_g - 1.0).abs() < 1e-9);
    }
}

/// A roof that overhangs towards the wall, beyond the base, held by a low thrust towards the wall: the base is pressed at its edge, not beyond it.
#[test]
fn a_column_that_leans_on_a_wall_presses_the_edge_of_its_base() {
    let loads = vec![
        load(6400.0, [-1.0, 4.0], true, 0.0),
        load(0.0, [0.0, 1.0], true, -5e3),
    ];
    let wall = BackWall {
        side: Sway::Left,
        height_m: None,
        rate_ratio: Some(0.4),
    };
    let held = Column::new(4.0, 0.8).unwrap().with_back(wall).unwrap();
    let held = model(&held.with_loads(loads, GRAVITY_M_S2).unwrap());
    let demand = held.demand_at_rest(Vector2::new(0.0, -1.0));
    assert_eq!(demand.friction, 0.0);
    assert!(demand.excess_ratio < 1e-14, "{demand:?}");
}

/// The second end of a constant force is at no support: the right foot of an arch does no work on it when it moves apart from the left one.
#[test]
fn moving_feet_do_no_work_on_constant_forces() {
    let ring = Ring::new(0.15, 2.75).unwrap();
    let row = Row::arch(&ring, 9, 10.0, 1.0, 2000.0).unwrap();
    let force = (8, row.blocks[8].centre_m, Vector2::new(-4e4, 0.0));
    let model = FreeHinges::new(row.with_constant_forces([force], GRAVITY_M_S2)).unwrap();
    let ground = pulse(Pulse::OneSine, 0.1, 1.0);
    let ground = ground.with_delayed_right_foot(0.2).unwrap();
    let request = Request {
        end_s: 2.0,
        ..REQUEST
    };
    let summary = model.simulate(&ground, &request, None).unwrap();
    assert!(summary.row().unwrap().right_foot_j.abs() > 100.0);
    assert!(summary.energy_defect_ratio < 1e-4, "{summary:?}");
}

/// A row carries ties or constant forces, so a column with both is refused, in either order; a moving mass does not matter.
#[test]
fn ties_and_constant_forces_are_refused_together() {
    let anchor = |block, x_m| Anchor {
        block,
        at_m: Vector2::new(x_m, 3.0),
    };
    let tie = Tie {
        ends: [anchor(Some(0), 0.0), anchor(None, 5.0)],
        stiffness_n_m: 1e6,
        prestress_n: 0.0,
        yield_force_n: f64::INFINITY,
        breaks_at_strain: f64::INFINITY,
    };
    let tied = |column: Column| column.with_ties(vec![tie], GRAVITY_M_S2).unwrap();
    let size_m = [4.0, 0.8];
    let thrust = load(0.0, [0.0, 2.0], true, 1e3);
    let free = column(size_m, &[]);
    let pushed = tied(free).with_loads(vec![thrust], GRAVITY_M_S2).unwrap();
    for both in [pushed, tied(column(size_m, &[thrust]))] {
        assert_eq!(both.row(), Err(RowError::TiesAndForces));
    }
    let roofed = tied(column(size_m, &[load(1e3, [0.0, 4.0], true, 0.0)]));
    assert_eq!(roofed.row().unwrap().bars(), [tie]);
}
