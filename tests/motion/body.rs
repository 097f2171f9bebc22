//! A rigid body by its numbers, against the column with these numbers, and against an integrator of its own.

use std::f64::consts::PI;

use archrock::mechanics::GivenBody;
use archrock::scenario::{Scenario, Source};
use archrock::{
    Column, GroundMotion, ImpactModel, Model as _, Outcome, Pulse, Request, RockingColumn, Sway,
};
use nalgebra::Vector2;

use crate::common::{Random, parsed};

const GRAVITY_M_S2: f64 = 9.81;

/// The column of 4 by 0.8 m with its default depth and density.
const PRISM: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";

/// Its numbers, from a point 3 m left of the middle of its base.
fn numbers_of_prism() -> String {
    let mass_kg: f64 = 2000.0 * 4.0 * 0.8;
    let inertia_kg_m2 = mass_kg * (16.0 + 0.64) / 12.0;
    format!(
        "[body]\nmass_kg = {mass_kg}\ninertia_kg_m2 = {inertia_kg_m2:?}\ncentre_m = [3.0, 2.0]\ntoes_x_m = [2.6, 3.4]\n"
    )
}

/// Differences of two numbers from the same formulas, which differ by the rounding of the numbers of the body.
fn assert_near(one: f64, other: f64, what: &str) {
    assert!(
        (one - other).abs() <= 1e-12 * (1.0 + one.abs()),
        "{what}: {one} {other}"
    );
}

/// Onset, impacts and largest rotation of a scenario.
fn results(text: &str) -> Vec<f64> {
    let scenario = parsed(text);
    let model = scenario.model().unwrap();
    let sides = [Sway::Right, Sway::Left];
    let starts_g = sides.map(|sway| model.incipient_acceleration_g(sway).unwrap());
    let history = model
        .history(scenario.ground_motion(), &scenario.request())
        .unwrap();
    let impacts = history.impacts().take(6);
    let impacts = impacts.flat_map(|(time_s, impact)| [time_s, impact.restitution]);
    let samples = (0..).map_while(|index| history.samples.get(index));
    let rotations = samples.map(|sample| sample.rotations_rad[0]);
    starts_g
        .into_iter()
        .chain(impacts)
        .chain(rotations)
        .collect()
}

#[test]
fn a_body_with_the_numbers_of_a_column_moves_as_it_does() {
    let ground = "[ground.one_sine]\namplitude_g = -0.45\nduration_s = 0.6\n[simulation]\nduration_s = 6.0\noutput_step_s = 0.02\ndirection = \"as_given\"\n";
    let load = |x_m: f64| format!("[[load]]\nmass_kg = 500.0\nx_m = {x_m}\nheight_m = 3.0\n");
    let thrust = |x_m: f64| format!("[[load]]\nthrust_n = 900.0\nx_m = {x_m}\n");
    for (of_prism, of_body) in [
        (String::new(), String::new()),
        (load(0.1), load(3.1)),
        (thrust(0.0), thrust(3.0)),
    ] {
        let prism = results(&format!("{PRISM}{of_prism}{ground}"));
        let body = results(&format!("{}{of_body}{ground}", numbers_of_prism()));
        assert_eq!(prism.len(), body.len());
        assert!(prism.len() > 100);
        for (index, (one, other)) in prism.iter().zip(&body).enumerate() {
            assert_near(*one, *other, &format!("{of_prism} {index}"));
        }
    }
    // A release, and free hinges, whose steps are the same.
    let initial =
        "[initial]\nsway = \"right\"\nrotation_rad = 0.1\n[simulation]\nduration_s = 3.0\n";
    for more in [initial.to_owned(), format!("[free_hinges]\n{ground}")] {
        let [one, other] =
            [PRISM.to_owned(), numbers_of_prism()].map(|text| results(&format!("{text}{more}")));
        for (index, (one, other)) in one.iter().zip(&other).enumerate() {
            assert!(
                (one - other).abs() <= 1e-12 * (1.0 + one.abs()),
                "{more} {index}: {one} {other}"
            );
        }
    }
}

/// A body that turns about a toe by the angle `q` towards it, integrated by the theorem of angular momentum about that toe.
struct Own {
    body: GivenBody,
    /// Toe about which it turns: 1 right, -1 left.
    side: f64,
    q_rad: f64,
    rate_rad_s: f64,
    time_s: f64,
}

impl Own {
    /// Centre of gravity from the toe, upright.
    fn arm_m(&self, side: f64) -> Vector2<f64> {
        let toe_x_m = self.body.toes_x_m[usize::from(side > 0.0)];
        self.body.centre_m - Vector2::new(toe_x_m, 0.0)
    }

    fn inertia_kg_m2(&self, side: f64) -> f64 {
        self.body.inertia_kg_m2 + self.body.mass_kg * self.arm_m(side).norm_squared()
    }

    /// Angular acceleration towards the toe, with the ground acceleration in m/s2.
    fn acceleration(&self, q_rad: f64, ground_m_s2: f64) -> f64 {
        let angle = -self.side * q_rad;
        let (sin, cos) = angle.sin_cos();
        let arm = self.arm_m(self.side);
        let arm = Vector2::new(cos * arm.x - sin * arm.y, sin * arm.x + cos * arm.y);
        let force = Vector2::new(-ground_m_s2, -GRAVITY_M_S2) * self.body.mass_kg;
        -self.side * arm.perp(&force) / self.inertia_kg_m2(self.side)
    }

    /// One step by the method of Runge and Kutta.
    fn stepped(&self, step_s: f64, ground: &dyn Fn(f64) -> f64) -> [f64; 2] {
        let slope =
            |state: [f64; 2], time_s: f64| [state[1], self.acceleration(state[0], ground(time_s))];
        let state = [self.q_rad, self.rate_rad_s];
        let along =
            |slope: [f64; 2], part: f64| [0, 1].map(|i| state[i] + part * step_s * slope[i]);
        let k1 = slope(state, self.time_s);
        let k2 = slope(along(k1, 0.5), self.time_s + 0.5 * step_s);
        let k3 = slope(along(k2, 0.5), self.time_s + 0.5 * step_s);
        let k4 = slope(along(k3, 1.0), self.time_s + step_s);
        [0, 1].map(|i| state[i] + step_s / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// Integrates up to the next impact. Returns its time and its ratio of energies; `None` if the body falls on its side, or has no impact within ten
    /// seconds.
    fn move_to_impact(
        &mut self,
        ends_s: &[f64],
        ground: &dyn Fn(f64) -> f64,
    ) -> Option<(f64, f64)> {
        let until_s = self.time_s + 10.0;
        while self.time_s < until_s {
            // Steps end at the corners of the ground motion.
            let next = ends_s.iter().find(|end_s| **end_s > self.time_s + 1e-12);
            let mut step_s = 2e-4_f64.min(next.map_or(1.0, |end_s| end_s - self.time_s));
            let mut after = self.stepped(step_s, ground);
            let closes = after[0] < 0.0;
            if closes {
                let [mut low, mut high] = [0.0, step_s];
                for _ in 0..60 {
                    step_s = 0.5 * (low + high);
                    after = self.stepped(step_s, ground);
                    if after[0] < 0.0 {
                        high = step_s
                    } else {
                        low = step_s
                    }
                }
            }
            self.time_s += step_s;
            [self.q_rad, self.rate_rad_s] = after;
            if self.q_rad > 0.5 * PI {
                return None;
            }
            if closes {
                return Some((self.time_s, self.strike()));
            }
        }
        None
    }

    /// Impact on the other toe: the angular momentum about it is that before. Returns the ratio of kinetic energies.
    fn strike(&mut self) -> f64 {
        let energy = |own: &Self| own.inertia_kg_m2(own.side) * own.rate_rad_s.powi(2);
        let before = energy(self);
        let spin = -self.side * self.rate_rad_s;
        let arm = self.arm_m(self.side);
        let velocity = Vector2::new(-arm.y, arm.x) * spin;
        let momentum = self.body.inertia_kg_m2 * spin
            + self.body.mass_kg * self.arm_m(-self.side).perp(&velocity);
        self.side = -self.side;
        self.q_rad = 0.0;
        self.rate_rad_s = -self.side * momentum / self.inertia_kg_m2(self.side);
        energy(self) / before
    }
}

/// Forty bodies under half sines: the first impacts with their times and energies, or overturning without one. The integrator above has steps of
/// 0.2 ms and an error far below the tolerance, which is that of times of impacts.
#[test]
fn forty_random_bodies_move_as_an_own_integrator_computes() {
    let mut random = Random(62);
    let (mut impacts, mut falls) = (0, 0);
    for _ in 0..40 {
        let (width_m, height_m) = (random.within(0.3, 1.5), random.within(0.6, 2.5));
        let mass_kg = random.within(50.0, 5000.0);
        let left_m = random.within(-2.0, 2.0);
        let body = GivenBody {
            mass_kg,
            inertia_kg_m2: mass_kg * random.within(0.1, 0.5) * height_m * height_m,
            centre_m: Vector2::new(left_m + width_m * random.within(0.25, 0.75), height_m),
            toes_x_m: [left_m, left_m + width_m],
        };
        let column = Column::of_body(body).unwrap();
        let model = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
        let to_right = random.chance(0.5);
        let (sway, side) = if to_right {
            (Sway::Right, 1.0)
        } else {
            (Sway::Left, -1.0)
        };
        let mut own = Own {
            body,
            side,
            q_rad: 0.0,
            rate_rad_s: 0.0,
            time_s: 0.0,
        };
        let onset_g = own.arm_m(side).x.abs() / height_m;
        let found_g = model.incipient_acceleration_g(sway).unwrap();
        assert!((found_g / onset_g - 1.0).abs() < 1e-12);
        let (peak_g, lasts_s) = (onset_g * random.within(1.2, 2.5), random.within(0.2, 0.6));
        let amplitude_m_s2 = -side * peak_g * GRAVITY_M_S2;
        let ground = |time_s: f64| match time_s < lasts_s {
            true => amplitude_m_s2 * (PI * time_s / lasts_s).sin(),
            false => 0.0,
        };
        own.time_s = lasts_s / PI * (onset_g / peak_g).asin();
        let motion: GroundMotion = Pulse::HalfSine
            .lasting_s(lasts_s)
            .horizontal_m_s2(amplitude_m_s2)
            .unwrap();
        let request = Request {
            end_s: 20.0,
            relative_tolerance: 1e-11,
            ..Request::default()
        };
        let history = model.history(&motion, &request).unwrap();
        let mut found = history.impacts();
        for _ in 0..4 {
            let Some((time_s, ratio)) = own.move_to_impact(&[lasts_s], &ground) else {
                if own.q_rad > 0.5 * PI {
                    assert_eq!(
                        history.summary.outcome,
                        Outcome::Overturned(if own.side > 0.0 {
                            Sway::Right
                        } else {
                            Sway::Left
                        })
                    );
                    falls += 1;
                }
                break;
            };
            let Some((other_s, impact)) = found.next() else {
                break;
            };
            assert!(
                (time_s - other_s).abs() < 1e-6,
                "{body:?}: {time_s} {other_s}"
            );
            assert!(
                (ratio - impact.restitution).abs() < 1e-9,
                "{body:?}: {ratio} {}",
                impact.restitution
            );
            // The ratio of energies is equal to both sides.
            let inertias = own.inertia_kg_m2(1.0) * own.inertia_kg_m2(-1.0);
            let passed = body.inertia_kg_m2 + mass_kg * own.arm_m(1.0).dot(&own.arm_m(-1.0));
            assert!((impact.restitution - passed * passed / inertias).abs() < 1e-12);
            impacts += 1;
            // A body that is flat for its new toe stops.
            if own.rate_rad_s <= 0.0 {
                break;
            }
        }
        // The mirror image moves as the mirror image, to the last bit.
        let mirrored = GivenBody {
            centre_m: Vector2::new(-body.centre_m.x, height_m),
            toes_x_m: [-body.toes_x_m[1], -body.toes_x_m[0]],
            ..body
        };
        let column = Column::of_body(mirrored).unwrap();
        let model = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
        let other = model.history(&motion.mirrored(), &request).unwrap();
        let times = |history: &archrock::History| {
            history
                .impacts()
                .map(|(time_s, _)| time_s)
                .collect::<Vec<_>>()
        };
        assert_eq!(times(&history), times(&other));
    }
    assert!(
        impacts > 60 && falls > 3,
        "{impacts} impacts, {falls} falls"
    );
}

#[test]
fn a_body_that_does_not_stand_is_refused() {
    let refused = |change: (&str, &str), more: &str| {
        let text = format!("{}{more}", numbers_of_prism().replace(change.0, change.1));
        let source = Source::of_text(&text, "s.toml");
        Scenario::of(&source, &Default::default())
            .unwrap_err()
            .to_string()
    };
    for (change, more, words) in [
        (
            ("[3.0, 2.0]", "[3.5, 2.0]"),
            "",
            "s.toml:4:12: `centre_m = [3.5, 2.0]` gives 3.5; must be between the toes",
        ),
        (
            ("[3.0, 2.0]", "[3.0]"),
            "",
            "must be two numbers, x and y or left and right, not 1",
        ),
        (("[2.6, 3.4]", "[3.4, 2.6]"), "", "toes_x_m"),
        (("mass_kg = 6400", "mass_kg = 0"), "", "mass_kg"),
        (
            ("", ""),
            "[column]\nheight_m = 4\nwidth_m = 1\n",
            "exactly one of the tables",
        ),
        (
            ("", ""),
            "[[tie]]\nfrom_m = [3.0, 1.0]\nto_m = [6.0, 1.0]\nstiffness_n_m = 1e6\n",
            "not with a [body]",
        ),
        (
            ("", ""),
            "[piers]\nheight_m = 1\nwidth_m = 1\n",
            "applies to an arch",
        ),
        (("mass_kg", "drums = 2\nmass_kg"), "", "drums"),
    ] {
        let error = refused(change, more);
        assert!(error.contains(words), "{error}");
    }
}
