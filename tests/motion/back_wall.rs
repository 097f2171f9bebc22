//! A column with a wall behind it, compared with closed forms, a quadrature and an independent integrator.

use crate::common::{Random, integral, least, pulse, runge_kutta};
use std::f64::consts::{FRAC_PI_2, PI};

use archrock::mechanics::{MechanismChain as _, NoWallRatio};
use archrock::{
    ArgumentError, BackWall, Column, GroundMotion, History, ImpactModel, Initial, Model as _,
    Outcome, Pulse, Request, RockingColumn, Sway,
};

use nalgebra::Vector2;

const GRAVITY_M_S2: f64 = 9.81;

const REQUEST: Request = Request {
    gravity_m_s2: GRAVITY_M_S2,
    end_s: 60.0,
    outcome_by_s: None,
    output_step_s: 0.01,
    initial: None,
    relative_tolerance: 1e-12,
    rest_energy_ratio: 1e-8,
};

/// A façade of half diagonal `r` and slenderness `alpha`, with a wall on this side.
fn column(r: f64, alpha: f64, back: BackWall) -> Result<Column, ArgumentError> {
    let column = Column::new(2.0 * r * alpha.cos(), 2.0 * r * alpha.sin())?;
    column.with_back(back)
}

fn wall(side: Sway, rate_ratio: Option<f64>) -> BackWall {
    BackWall {
        side,
        height_m: None,
        rate_ratio,
    }
}

/// A façade of 8 m by 0.6 m with a wall of this height on its left.
fn facade(height_m: f64, rate_ratio: Option<f64>) -> Result<Column, ArgumentError> {
    let back = BackWall {
        height_m: Some(height_m),
        ..wall(Sway::Left, rate_ratio)
    };
    Column::new(8.0, 0.6)?.with_back(back)
}

fn model(column: &Column) -> RockingColumn {
    RockingColumn::new(column, ImpactModel::MaxRestitution).unwrap()
}

fn released(model: &RockingColumn, sway: Sway, rotation_rad: f64) -> History {
    let request = Request {
        initial: Some(Initial {
            sway,
            rotation_rad,
            rate_rad_s: 0.0,
        }),
        ..REQUEST
    };
    model.history(&GroundMotion::still(), &request).unwrap()
}

/// The rate after each impact, the rate before the next one (no energy is lost between them), and the time between them: twice the integral
/// of `d theta / theta'` with `theta'^2 = 2 p^2 (cos(alpha - peak) - cos(alpha - theta))` up to the peak, `theta = peak (1 - u^2)`.
#[test]
fn a_released_facade_strikes_by_the_closed_form() {
    for (alpha, part, given) in [
        (0.075_f64, 0.6, None),
        (0.3, 0.9, None),
        (0.2, 0.5, Some(0.9)),
        (0.2, 0.8, Some(0.13)),
        (0.1, 0.4, Some(1.0)),
    ] {
        let r = 4.0;
        let column = column(r, alpha, wall(Sway::Left, given)).unwrap();
        let published =
            (1.0 - 1.5 * alpha.sin().powi(2)).powi(2) * (1.5 * alpha.cos().powi(2) - 1.0);
        let ratio = given.unwrap_or(published);
        let found = column.wall_rate_ratio().unwrap();
        assert!((found.unwrap() - ratio).abs() < 1e-14);
        let history = released(&model(&column), Sway::Right, part * alpha);
        let p = (0.75 * GRAVITY_M_S2 / r).sqrt();
        let peak_of = |rate: f64| alpha - (alpha.cos() + rate * rate / (2.0 * p * p)).acos();
        let impacts: Vec<_> = history.impacts().collect();
        assert!(impacts.len() >= 3, "{alpha} {}", impacts.len());
        for (index, (time_s, impact)) in impacts.iter().enumerate() {
            let (before, after) = (impact.rates_before_rad_s[0], impact.rates_after_rad_s[0]);
            // It turns clockwise when it leaves the wall on its left.
            assert!(before > 0.0 && after < 0.0 && impact.sway_after() == Sway::Right);
            assert!((after / before + ratio).abs() < 1e-14, "{alpha} {index}");
            assert!((impact.restitution - ratio * ratio).abs() < 1e-14);
            let Some((next_s, next)) = impacts.get(index + 1) else {
                continue;
            };
            let peak = peak_of(after);
            // Peaks of 1e-4 alpha lose digits in the quadrature's cosines.
            if peak < 1e-3 * alpha {
                continue;
            }
            assert!(
                (next.rates_before_rad_s[0] / after + 1.0).abs() < 1e-9,
                "{alpha} {index}"
            );
            let half_s = integral(|u| {
                let half_gap = 0.5 * peak * u * u;
                let sinc = if u > 0.0 {
                    half_gap.sin() / (u * u)
                } else {
                    0.5 * peak
                };
                let drop = 2.0 * (alpha - peak + half_gap).sin() * sinc;
                2.0 * peak / (2.0 * p * p * drop).sqrt()
            });
            let apart_s = next_s - time_s;
            assert!(
                (apart_s / (2.0 * half_s) - 1.0).abs() < 1e-9,
                "{alpha} {index}: {apart_s}"
            );
        }
    }
}

/// A pulse pushes the façade against the wall and away from it; the energy balance closes, and no sample leans into the wall.
#[test]
fn energy_is_never_created_and_the_wall_is_never_entered() {
    for (index, restitution) in [None, Some(0.0), Some(0.5), Some(1.0)]
        .into_iter()
        .enumerate()
    {
        let column = model(&column(4.0, 0.1, wall(Sway::Left, restitution)).unwrap());
        for (amplitude_g, duration_s) in [(-0.3, 0.8), (0.35, 1.0), (0.2, 3.0)] {
            let ground = pulse(Pulse::OneSine, amplitude_g, duration_s);
            let history = column.history(&ground, &REQUEST).unwrap();
            assert!(
                history.summary.energy_defect_ratio < 1e-9,
                "{index} {amplitude_g}"
            );
            for (_, impact) in history.impacts() {
                assert!(impact.energy_after_j <= impact.energy_before_j);
            }
            let mut rotations = history.samples.iter().map(|sample| sample.rotations_rad[0]);
            assert!(
                rotations.all(|rotation| rotation <= 0.0),
                "{index} {amplitude_g}"
            );
            assert!(
                history.summary.impacts > 0
                    || history.summary.outcome == Outcome::Overturned(Sway::Right)
            );
        }
    }
}

#[test]
fn no_push_towards_the_wall_starts_it() {
    let model = model(&column(4.0, 0.1, wall(Sway::Right, None)).unwrap());
    assert_eq!(model.incipient_acceleration_g(Sway::Right), None);
    assert!((model.incipient_acceleration_g(Sway::Left).unwrap() - 0.1_f64.tan()).abs() < 1e-15);
    // The ground accelerates to the left, which pushes it to the right.
    let ground = pulse(Pulse::Rectangular, -3.0, 1.0);
    let summary = model.simulate(&ground, &REQUEST, None).unwrap();
    assert_eq!(summary.outcome, Outcome::NeverMoved);
}

/// At rest the wall carries a push towards it; a push away from it, here to the left, is carried by the base.
#[test]
fn the_wall_carries_a_push_towards_it() {
    let model = model(&column(4.0, 0.1, wall(Sway::Right, None)).unwrap());
    let towards = model.demand_at_rest(Vector2::new(0.3, -1.0));
    assert_eq!((towards.friction, towards.excess_ratio), (0.0, 0.0));
    let middle = model.eccentricity_ratios_at_rest(Vector2::new(0.3, -1.0));
    assert!(middle.iter().all(|ratio| *ratio == Some(0.0)));
    let away = model.demand_at_rest(Vector2::new(-0.3, -1.0));
    assert!(away.friction == 0.3 && away.excess_ratio > 0.5);
}

#[test]
fn with_restitution_zero_it_stays() {
    let model = model(&column(4.0, 0.1, wall(Sway::Left, Some(0.0))).unwrap());
    let history = released(&model, Sway::Right, 0.07);
    assert_eq!(
        (history.summary.impacts, history.summary.outcome),
        (1, Outcome::Rest)
    );
    let last = history.impacts().next().unwrap().0;
    assert_eq!(history.summary.outcome_time_s, last);
    let after = history.samples.iter().filter(|sample| sample.time_s > last);
    assert!(
        after
            .into_iter()
            .all(|sample| sample.rotations_rad == [0.0])
    );
}

/// A wall on the other side and the mirrored ground give the mirrored history, to the last bit.
#[test]
fn the_mirror_image_has_the_same_bits() {
    let history = |sign: f64, side: Sway| {
        let model = model(&column(4.0, 0.1, wall(side, None)).unwrap());
        let ground = pulse(Pulse::OneSine, sign * -0.35, 1.1);
        let history = model.history(&ground, &REQUEST).unwrap();
        let samples = history.samples.iter().map(|sample| {
            let values = [sample.rotations_rad[0], sample.rates_rad_s[0]];
            (sample.time_s, values.map(|value| sign * value + 0.0))
        });
        let events = history.events.iter();
        let events = events.map(|event| (event.time_s, event.kind, sign * event.rates_rad_s[0]));
        (
            samples.collect::<Vec<_>>(),
            events.collect::<Vec<_>>(),
            history.summary.impacts,
        )
    };
    let right = history(1.0, Sway::Left);
    assert!(right.2 > 3);
    assert_eq!(right, history(-1.0, Sway::Right));
}

#[test]
fn a_wall_of_height_zero_changes_no_bit() {
    let columns = [facade(0.0, None).unwrap(), Column::new(8.0, 0.6).unwrap()];
    let [held, free] = columns.map(|column| model(&column));
    for amplitude_g in [-0.2, 0.25] {
        let ground = pulse(Pulse::OneSine, amplitude_g, 1.0);
        let history = |model: &RockingColumn| model.history(&ground, &REQUEST).unwrap();
        assert!(history(&free).summary.impacts > 0);
        assert_eq!(history(&held), history(&free));
    }
}

/// Contact models contradict three impacts at a lower wall, and before loads that move: there is no default. A wider block than 0.7071 of its height
/// does not return.
#[test]
fn only_full_walls_of_homogeneous_blocks_have_a_default() {
    let is_modelled =
        |column: &Column| RockingColumn::new(column, ImpactModel::MaxRestitution).is_ok();
    assert!(is_modelled(&facade(8.0, None).unwrap()));
    for height_m in [4.0, 5.3, 6.0, 7.0, 8.0 - 1e-9] {
        let low = facade(height_m, None).unwrap();
        let error = NoWallRatio::Low {
            wall_m: height_m,
            column_m: 8.0,
        };
        assert_eq!(low.wall_rate_ratio(), Err(error));
        assert!(!is_modelled(&low));
        // A prescribed or given restitution needs no default.
        let law = ImpactModel::Prescribed { restitution: 0.2 };
        assert!(RockingColumn::new(&low, law).is_ok());
        assert!(is_modelled(&facade(height_m, Some(0.3)).unwrap()));
    }
    assert!(facade(8.1, Some(0.4)).is_err() && facade(8.0, Some(1.1)).is_err());
    let wide = |width_m: f64| {
        let column = Column::new(1.0, width_m).unwrap();
        column.with_back(wall(Sway::Left, None)).unwrap()
    };
    assert!(is_modelled(&wide(0.5_f64.sqrt() - 1e-9)));
    let error = wide(0.5_f64.sqrt() + 1e-9).wall_rate_ratio().unwrap_err();
    assert!(matches!(error, NoWallRatio::Wide(_)), "{error}");
}

/// Below the centre of gravity, at half the height, a push turns the column over the wall, whatever its restitution.
#[test]
fn a_wall_below_the_centre_of_gravity_is_refused() {
    for height_m in [0.01, 2.0, 4.0 - 1e-9] {
        for rate_ratio in [None, Some(0.0), Some(0.48)] {
            let error = facade(height_m, rate_ratio).unwrap_err();
            assert!(
                error.argument == "height_m" && error.allowed.contains("at least 4.0 m"),
                "{error}"
            );
        }
    }
    for height_m in [4.0, 5.0, 8.0] {
        assert!(facade(height_m, Some(0.48)).is_ok());
    }
    assert!(facade(0.0, Some(0.48)).unwrap().wall().is_none());
}

/// The ratio of rates in docs/walls.md, from `k^2 + (G - A).(G - B)` written out for a block.
#[test]
fn a_full_wall_has_the_ratio_of_its_three_impacts() {
    let found = facade(8.0, None).unwrap().wall_rate_ratio();
    let found = found.unwrap().unwrap();
    let square = (64.0 + 0.36) / 12.0;
    let about = |one: f64, other: f64, side: f64| square + one * other + side * 0.09;
    let at_base = about(4.0, 4.0, -1.0) / about(4.0, 4.0, 1.0);
    let at_wall = about(4.0, -4.0, 1.0) / about(4.0, 4.0, 1.0);
    assert!((found + at_base * at_base * at_wall).abs() < 1e-14);
    assert!((found - 0.483).abs() < 5e-4, "{found}");
}

/// A façade that leaves the wall to the right, by the classical Runge-Kutta method with small steps and bisected impacts.
struct Independent {
    alpha: f64,
    p: f64,
    restitution: f64,
    /// Push to the right in g at a time.
    push_g: Box<dyn Fn(f64) -> f64>,
    pulse_end_s: f64,
}

impl Independent {
    fn acceleration(&self, time_s: f64, q: f64) -> f64 {
        let angle = self.alpha - q;
        -self.p * self.p * (angle.sin() - (self.push_g)(time_s) * angle.cos())
    }

    fn stepped(&self, time_s: f64, state: [f64; 2], h: f64) -> [f64; 2] {
        runge_kutta(|time_s, q| self.acceleration(time_s, q), time_s, state, h)
    }

    /// Returns whether it overturns, its largest rotation up to then, and its impacts with at least a millionth of the barrier.
    fn motion(&self, end_s: f64) -> (bool, f64, usize) {
        let barrier = 1.0 - self.alpha.cos();
        let (mut time_s, mut state, mut rests) = (0.0_f64, [0.0_f64; 2], true);
        let (mut peak, mut impacts) = (0.0_f64, 0);
        while time_s < end_s {
            // Steps end at the end of the pulse.
            let mut h = 2e-4_f64;
            if time_s < self.pulse_end_s - 1e-12 {
                h = h.min(self.pulse_end_s - time_s);
            }
            if rests {
                let excess = |time_s: f64| (self.push_g)(time_s) - self.alpha.tan();
                if excess(time_s) > 0.0 {
                    rests = false;
                    continue;
                }
                if excess(time_s + h) > 0.0 {
                    let opens_s = least([time_s, time_s + h], 1e-14, |s| excess(s) > 0.0);
                    (time_s, rests) = (opens_s, false);
                } else {
                    time_s += h;
                }
                continue;
            }
            let next = self.stepped(time_s, state, h);
            if next[0] < 0.0 {
                let is_closed = |h: f64| self.stepped(time_s, state, h)[0] < 0.0;
                let h = least([0.0, h], 1e-15, is_closed);
                let closing = self.stepped(time_s, state, h)[1];
                time_s += h;
                let energy = |rate: f64| rate * rate / (2.0 * self.p * self.p);
                impacts += usize::from(energy(closing) > 1e-6 * barrier);
                state = [0.0, -self.restitution * closing];
                rests = energy(state[1]) < REQUEST.rest_energy_ratio * barrier
                    && self.acceleration(time_s, 0.0) <= 0.0;
                continue;
            }
            // The turning point within a step, by the parabola of its start.
            if state[1] > 0.0 && next[1] <= 0.0 {
                let bend = self.acceleration(time_s, state[0]);
                peak = peak.max(state[0] - 0.5 * state[1] * state[1] / bend);
            }
            (time_s, state) = (time_s + h, next);
            let is_lost = time_s >= self.pulse_end_s && state[0] > self.alpha && state[1] >= 0.0;
            if is_lost || state[0] >= FRAC_PI_2 {
                return (true, peak, impacts);
            }
        }
        (false, peak, impacts)
    }
}

/// Forty random façades under a sine, against the independent integrator: outcome, peak and number of impacts.
///
/// The turning point by a parabola is wrong by the third power of the step, some 1e-11 rad; each impact multiplies errors of the motion, which a
/// peak of less than a thousandth of `alpha` does not show.
#[test]
fn random_facades_move_as_by_an_independent_integrator() {
    let mut random = Random(46);
    let (mut overturned, mut bounced) = (0, 0);
    for case in 0..40 {
        let (r, alpha) = (random.within(0.8, 6.0), random.within(0.05, 0.35));
        let restitution = random.within(0.0, 1.0);
        let amplitude_g = alpha.tan() * random.within(-6.0, 6.0);
        let duration_s = random.within(0.3, 2.0);
        let side = if random.chance(0.5) {
            Sway::Left
        } else {
            Sway::Right
        };
        let column = model(&column(r, alpha, wall(side, Some(restitution))).unwrap());
        let request = Request {
            end_s: 12.0,
            output_step_s: 12.0,
            ..REQUEST
        };
        let ground = pulse(Pulse::OneSine, amplitude_g, duration_s);
        let history = column.history(&ground, &request).unwrap();
        let summary = &history.summary;
        // A push away from the wall is an acceleration of the ground towards it.
        let away = side.opposite();
        let sign = -away.sign();
        let push_g = move |time_s: f64| match time_s < duration_s {
            true => sign * amplitude_g * (2.0 * PI * time_s / duration_s).sin(),
            false => 0.0,
        };
        let independent = Independent {
            alpha,
            p: (0.75 * GRAVITY_M_S2 / r).sqrt(),
            restitution,
            push_g: Box::new(push_g),
            pulse_end_s: duration_s,
        };
        let (overturns, peak, impacts) = independent.motion(12.0);
        assert_eq!(
            summary.outcome == Outcome::Overturned(away),
            overturns,
            "{case}"
        );
        assert!(!matches!(summary.outcome, Outcome::Overturned(side) if side != away));
        if overturns {
            overturned += 1;
            continue;
        }
        bounced += usize::from(impacts > 1);
        let own = summary.peak_rotations_rad[0];
        assert!((own - peak).abs() < 1e-7 * alpha, "{case}: {own} {peak}");
        let barrier_j = {
            let mass_kg = 2000.0 * 2.0 * r * alpha.sin() * 2.0 * r * alpha.cos();
            mass_kg * GRAVITY_M_S2 * r * (1.0 - alpha.cos())
        };
        let counted = history.impacts();
        let counted = counted.filter(|(_, impact)| impact.energy_before_j > 1e-6 * barrier_j);
        // The last counted impact may be on either side of the limit.
        assert!(counted.count().abs_diff(impacts) <= 1, "{case}");
    }
    assert!(overturned >= 5 && bounced >= 10, "{overturned} {bounced}");
}
