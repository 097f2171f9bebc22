//! Vertical bending of walls whose top is held: closed forms, linear programmes and virtual work that share nothing with the library.

use archrock::mechanics::{
    Anchor, CapacityError, HeldMechanism, HeldTop, HeldTopError, PlacedLoad, Tie,
};
use archrock::{Column, Sway};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver as _, NonnegativeConeT, SolverStatus, ZeroConeT,
};
use nalgebra::Vector2;

use crate::common::Random;

const G: f64 = 9.81;

/// A wall by its numbers, with all that acts on it.
#[derive(Clone, Debug)]
struct Wall {
    height_m: f64,
    /// Width at base and top.
    widths_m: [f64; 2],
    /// Heights of the joints, from 0 to below the top; the base alone without drums.
    joints_m: Vec<f64>,
    floor: HeldTop,
    /// Masses in kg at points.
    masses: Vec<(f64, Vector2<f64>)>,
    /// Constant forces in N at points.
    forces: Vec<(Vector2<f64>, Vector2<f64>)>,
    /// Tie from a point of the wall to a point of the ground, with its force in N.
    tie: Option<(Vector2<f64>, Vector2<f64>, f64)>,
}

const DEPTH_M: f64 = 1.3;
const DENSITY: f64 = 1850.0;

impl Wall {
    fn prism(height_m: f64, width_m: f64, weight_n: f64, x_m: f64) -> Self {
        Self {
            height_m,
            widths_m: [width_m; 2],
            joints_m: vec![0.0],
            floor: HeldTop { weight_n, x_m },
            masses: Vec::new(),
            forces: Vec::new(),
            tie: None,
        }
    }

    fn column(&self) -> Column {
        let [base_m, top_m] = self.widths_m;
        let ends_m = self.joints_m.iter().copied().skip(1);
        let ends_m: Vec<f64> = ends_m.chain([self.height_m]).collect();
        let starts_m = self.joints_m.iter();
        let drums_m: Vec<f64> = ends_m
            .iter()
            .zip(starts_m)
            .map(|(end, start)| end - start)
            .collect();
        let mut column = Column::new(self.height_m, base_m)
            .and_then(|column| column.with_depth_m(DEPTH_M))
            .and_then(|column| column.with_density_kg_m3(DENSITY))
            .unwrap();
        if drums_m.len() > 1 {
            column = column.with_drum_heights_m(drums_m).unwrap();
            column = column.with_top_width_m(top_m).unwrap();
        }
        let column = column.with_top(self.floor, G).unwrap();
        let load = |at_m: &Vector2<f64>| PlacedLoad {
            x_m: at_m.x,
            height_m: Some(at_m.y),
            ..PlacedLoad::default()
        };
        let masses = self.masses.iter().map(|(mass_kg, at_m)| PlacedLoad {
            mass_kg: *mass_kg,
            ..load(at_m)
        });
        let forces = self.forces.iter().map(|(force_n, at_m)| PlacedLoad {
            mass_kg: -force_n.y / G,
            thrust_n: force_n.x,
            moves: false,
            ..load(at_m)
        });
        let column = column
            .with_loads(masses.chain(forces).collect(), G)
            .unwrap();
        let Some((at_m, ground_m, force_n)) = self.tie else {
            return column;
        };
        let ends = [
            Anchor {
                block: Some(self.drum_at(at_m.y)),
                at_m,
            },
            Anchor {
                block: None,
                at_m: ground_m,
            },
        ];
        let tie = Tie {
            ends,
            stiffness_n_m: 1e6,
            prestress_n: force_n,
            yield_force_n: f64::INFINITY,
            breaks_at_strain: f64::INFINITY,
        };
        column.with_ties(vec![tie], G).unwrap()
    }

    /// The drum that carries a point; at a joint, the lower one.
    fn drum_at(&self, height_m: f64) -> usize {
        let below = self.joints_m.iter().filter(|joint_m| **joint_m < height_m);
        below.count().max(1) - 1
    }

    fn half_m(&self, height_m: f64) -> f64 {
        let [base_m, top_m] = self.widths_m;
        0.5 * (base_m + (top_m - base_m) * height_m / self.height_m)
    }

    /// Mass and centre of the masonry between two heights, by Simpson's rule, which is exact for cubics.
    fn masonry(&self, from_m: f64, to_m: f64) -> (f64, Vector2<f64>) {
        let heights_m = [from_m, 0.5 * (from_m + to_m), to_m];
        let sum = |f: &dyn Fn(f64) -> f64| {
            let [a, b, c] = heights_m.map(f);
            (to_m - from_m) / 6.0 * (a + 4.0 * b + c)
        };
        let area_m2 = sum(&|y| 2.0 * self.half_m(y));
        let moment_m3 = sum(&|y| 2.0 * self.half_m(y) * y);
        (
            area_m2 * DEPTH_M * DENSITY,
            Vector2::new(0.0, moment_m3 / area_m2),
        )
    }

    /// All masses as points: each with the height that decides which body carries it.
    fn points(&self) -> Vec<(f64, Vector2<f64>, f64)> {
        let mut points: Vec<_> = self
            .masses
            .iter()
            .map(|(kg, at_m)| (*kg, *at_m, at_m.y))
            .collect();
        for (drum, from_m) in self.joints_m.iter().enumerate() {
            let to_m = self
                .joints_m
                .get(drum + 1)
                .copied()
                .unwrap_or(self.height_m);
            let (kg, centre_m) = self.masonry(*from_m, to_m);
            points.push((kg, centre_m, centre_m.y));
        }
        points
    }

    /// All constant forces at points, the floor and the tie included.
    fn pulls(&self) -> Vec<(Vector2<f64>, Vector2<f64>)> {
        let top_m = Vector2::new(self.floor.x_m, self.height_m);
        let tie = self
            .tie
            .map(|(at_m, ground_m, force_n)| ((ground_m - at_m).normalize() * force_n, at_m));
        let floor = (Vector2::new(0.0, -self.floor.weight_n), top_m);
        self.forces
            .iter()
            .copied()
            .chain(tie)
            .chain([floor])
            .collect()
    }

    fn cut_at(&self, heights_m: &[f64]) -> Self {
        let mut cut = self.clone();
        cut.joints_m
            .extend(heights_m.iter().filter(|height_m| **height_m > 0.0));
        cut
    }

    fn mirrored(&self) -> Self {
        let seen = |v: &Vector2<f64>| Vector2::new(-v.x, v.y);
        let mut other = self.clone();
        other.floor.x_m *= -1.0;
        other
            .masses
            .iter_mut()
            .for_each(|(_, at_m)| *at_m = seen(at_m));
        other
            .forces
            .iter_mut()
            .for_each(|(n, at_m)| (*n, *at_m) = (seen(n), seen(at_m)));
        other.tie = self
            .tie
            .map(|(at_m, ground_m, n)| (seen(&at_m), seen(&ground_m), n));
        other
    }

    /// The static theorem: the largest push to a side for which joint forces exist. Unknowns are the push, the reaction at the top, and at each joint the
    /// forces at its left and right corner and the shear; three equations for each drum. Shear is free, or at most `friction` times the normal force.
    /// `None` if there is none.
    fn statically(&self, sway: Sway, friction: Option<f64>, largest: bool) -> Option<f64> {
        let joints = self.joints_m.len();
        let (width, mut entries, mut right) = (2 + 3 * joints, Vec::new(), Vec::new());
        let unit = self.masonry(0.0, self.height_m).0 * G;
        let corner_m = |joint: usize, side: f64| {
            let height_m = self.joints_m[joint];
            Vector2::new(side * self.half_m(height_m), height_m)
        };
        let wrench =
            |at_m: Vector2<f64>, force: Vector2<f64>| [force.x, force.y, at_m.perp(&force)];
        for drum in 0..joints {
            let first = right.len();
            let mut known = [0.0; 3];
            let mut put = |column: usize, parts: [f64; 3]| {
                for (axis, part) in parts.into_iter().enumerate() {
                    entries.push((first + axis, column, part));
                }
            };
            for (kg, at_m, height_m) in self.points() {
                if self.drum_at(height_m) == drum {
                    put(
                        0,
                        wrench(at_m, Vector2::new(sway.sign() * kg * G / unit, 0.0)),
                    );
                    let down = wrench(at_m, Vector2::new(0.0, -kg * G / unit));
                    (0..3).for_each(|axis| known[axis] -= down[axis]);
                }
            }
            for (force_n, at_m) in self.pulls() {
                if self.drum_at(at_m.y) == drum {
                    let pull = wrench(at_m, force_n / unit);
                    (0..3).for_each(|axis| known[axis] -= pull[axis]);
                }
            }
            if drum + 1 == joints {
                put(
                    1,
                    wrench(
                        Vector2::new(0.0, self.height_m),
                        Vector2::new(-sway.sign(), 0.0),
                    ),
                );
            }
            for (joint, sign) in [(drum, 1.0), (drum + 1, -1.0)] {
                if joint < joints {
                    for (kind, side) in [(0, -1.0), (1, 1.0)] {
                        put(
                            2 + 3 * joint + kind,
                            wrench(corner_m(joint, side), Vector2::new(0.0, sign)),
                        );
                    }
                    put(
                        4 + 3 * joint,
                        wrench(corner_m(joint, 0.0), Vector2::new(sign, 0.0)),
                    );
                }
            }
            right.extend(known);
        }
        let equations = right.len();
        for joint in 0..joints {
            for kind in 0..2 {
                entries.push((right.len(), 2 + 3 * joint + kind, -1.0));
                right.push(0.0);
            }
            for sign in friction.map_or(Vec::new(), |_| vec![1.0, -1.0]) {
                for kind in 0..2 {
                    entries.push((right.len(), 2 + 3 * joint + kind, -friction.unwrap()));
                }
                entries.push((right.len(), 4 + 3 * joint, sign));
                right.push(0.0);
            }
        }
        // No push against the side.
        entries.push((right.len(), 0, -1.0));
        right.push(0.0);
        let (rows, columns, values) = entries.into_iter().collect();
        let matrix = CscMatrix::new_from_triplets(right.len(), width, rows, columns, values);
        let mut objective = vec![0.0; width];
        objective[0] = if largest { -1.0 } else { 1.0 };
        let cones = [
            ZeroConeT(equations),
            NonnegativeConeT(right.len() - equations),
        ];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-11,
            tol_gap_rel: 1e-11,
            tol_feas: 1e-11,
            ..DefaultSettings::default()
        };
        let quadratic = CscMatrix::zeros((width, width));
        let mut solver =
            DefaultSolver::new(&quadratic, &objective, &matrix, &right, &cones, settings).unwrap();
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Some(solver.solution.x[0]),
            _ => None,
        }
    }
}

/// A wall with drums, and by chance a taper, masses that move, constant forces or a tie.
fn random_wall(random: &mut Random) -> Wall {
    let height_m = random.within(2.0, 6.0);
    let base_m = random.within(0.3, 0.9);
    let top_m = if random.chance(0.5) {
        base_m
    } else {
        base_m * random.within(0.6, 1.0)
    };
    let mut joints_m: Vec<f64> = (0..2 + random.pick(8))
        .map(|_| random.within(0.05, 0.97) * height_m)
        .collect();
    joints_m.push(0.0);
    joints_m.sort_by(f64::total_cmp);
    joints_m.dedup_by(|one, other| (*one - *other).abs() < 0.02);
    let weight_n = random.within(1e3, 6e4);
    let x_m = if random.chance(0.3) {
        0.0
    } else {
        random.within(-0.4, 0.4) * top_m
    };
    let mut wall = Wall {
        widths_m: [base_m, top_m],
        joints_m,
        ..Wall::prism(height_m, base_m, weight_n, x_m)
    };
    let mut at_m =
        |height: f64| Vector2::new(random.within(-0.49, 0.49) * top_m, height * height_m);
    let points = [at_m(0.3), at_m(0.7), at_m(1.0)];
    if random.chance(0.5) {
        wall.masses = points
            .iter()
            .map(|at_m| (random.within(100.0, 1e4), *at_m))
            .collect();
    }
    match random.pick(3) {
        0 => {
            // A heavy load on the lower part makes hinges above it.
            wall.forces = points
                .iter()
                .zip([2e5, 2e4, 2e4])
                .map(|(at_m, most_n)| {
                    let n = [random.within(-1e4, 1e4), -random.within(0.0, most_n)];
                    (n.into(), *at_m)
                })
                .collect();
        }
        1 => {
            let ground_m = Vector2::new(random.within(-3.0, 3.0), 0.0);
            wall.tie = Some((points[1], ground_m, random.within(0.0, 3e4)));
        }
        _ => {}
    }
    wall
}

/// The smallest value of a function with one minimum, by golden sections.
fn golden(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    let part = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..200 {
        let [one, other] = [high - part * (high - low), low + part * (high - low)];
        if f(one) < f(other) {
            high = other
        } else {
            low = one
        }
    }
    (0.5 * (low + high), f(0.5 * (low + high)))
}

/// The hinge of a uniform wall lies where the multiplier by virtual work is least. Golden sections find the least value to the square of the rounding error,
/// and its place to the root of it.
#[test]
fn a_uniform_wall_has_the_multiplier_of_virtual_work() {
    let mut random = Random(62);
    for _ in 0..40 {
        let [h, t] = [random.within(2.0, 6.0), random.within(0.2, 1.0)];
        let n = random.within(0.02, 3.0) * DENSITY * DEPTH_M * G * h * t;
        let q = DENSITY * DEPTH_M * G * t;
        let multiplier = |x: f64| {
            let turns = 1.0 + x / (2.0 * (h - x));
            (q * x * t / 2.0 + (q * (h - x) + n) * t * turns) / (q * h * x / 2.0)
        };
        let (at_m, least) = golden(1e-6 * h, h * (1.0 - 1e-6), multiplier);
        let column = Wall::prism(h, t, n, 0.0).column();
        for sway in [Sway::Right, Sway::Left] {
            let found = HeldMechanism::new(&column, sway).unwrap();
            let found_m = found.hinges_m();
            assert!((found.acceleration_g / least - 1.0).abs() < 1e-9);
            assert!((found_m[1].y - at_m).abs() < 1e-6 * h);
            let face_m = 0.5 * t * sway.sign();
            assert_eq!(
                (found_m[0].x, found_m[0].y, found_m[1].x),
                (face_m, 0.0, -face_m)
            );
            // Moments of the whole wall about its toe.
            let due_n = (found.acceleration_g * q * h * h / 2.0 - (q * h + n) * t / 2.0) / h;
            assert!((found.reaction_n / due_n - 1.0).abs() < 1e-9);
        }
    }
}

/// The tolerance is that of the interior-point method.
#[test]
fn walls_of_drums_have_the_multiplier_of_a_linear_programme() {
    let (mut random, mut stand, mut high, mut slide) = (Random(2), 0, 0, 0);
    for _ in 0..60 {
        let wall = random_wall(&mut random);
        let (column, mirrored) = (wall.column(), wall.mirrored().column());
        for sway in [Sway::Right, Sway::Left] {
            let due = wall.statically(sway, None, true);
            let found = match HeldMechanism::new(&column, sway) {
                Err(error) => {
                    assert_eq!(error, HeldTopError::CannotStand);
                    assert!(
                        wall.statically(sway, None, false)
                            .is_none_or(|least| least > 1e-7)
                    );
                    continue;
                }
                Ok(found) => found,
            };
            stand += 1;
            high += usize::from(found.pins[0].joint > 0);
            let due = due.unwrap();
            assert!(
                (found.acceleration_g - due).abs() < 1e-6 * due.max(1.0),
                "{wall:?}"
            );
            let other = HeldMechanism::new(&mirrored, sway.opposite()).unwrap();
            assert!((other.acceleration_g / found.acceleration_g - 1.0).abs() < 1e-13);
            // With friction the push is the smaller one, or zero.
            let coefficient = random.within(0.1, 0.6);
            let bound = found.slide_bound_g(coefficient);
            let due = wall.statically(sway, Some(coefficient), true);
            let due = due.filter(|_| {
                wall.statically(sway, Some(coefficient), false)
                    .is_some_and(|least| least < 1e-7)
            });
            slide += usize::from(bound.is_some_and(|bound| bound > 0.0));
            let push = bound.unwrap_or(found.acceleration_g);
            assert!(
                (push - due.unwrap_or(0.0)).abs() < 1e-6 * push.max(1.0),
                "{push} {due:?}"
            );
            // Joints with less friction than the mechanism needs slide first.
            let needed = found.displaced(0.0).friction;
            assert!(found.slide_bound_g(needed * (1.0 - 1e-6)).is_some());
            assert_eq!(found.slide_bound_g(needed * (1.0 + 1e-6)), None);
        }
    }
    assert!(
        stand > 90 && high > 0 && slide > 20,
        "{stand} {high} {slide}"
    );
}

/// Cut anywhere, a wall without drums is as strong or stronger; cut at its hinges it is as strong. The lower hinge lies just above a heavy load.
#[test]
fn a_wall_without_drums_has_the_weakest_hinges() {
    let (mut random, mut stand, mut high) = (Random(7), 0, 0);
    for index in 0..40 {
        let mut drums = random_wall(&mut random);
        if index == 0 {
            drums = Wall::prism(4.0, 0.5, 2e4, 0.0);
            drums.forces = vec![(Vector2::new(0.0, -2e5), Vector2::new(-0.2, 1.2))];
        }
        let wall = Wall {
            joints_m: vec![0.0],
            widths_m: [drums.widths_m[1]; 2],
            ..drums
        };
        let column = wall.column();
        for sway in [Sway::Right, Sway::Left] {
            let Ok(found) = HeldMechanism::new(&column, sway) else {
                continue;
            };
            stand += 1;
            let hinges_m = found.hinges_m().map(|at_m| at_m.y);
            high += usize::from(hinges_m[0] > 0.0);
            let due = wall.cut_at(&hinges_m).statically(sway, None, true).unwrap();
            assert!((found.acceleration_g - due).abs() < 1e-6 * due.max(1.0));
            for _ in 0..10 {
                let mut cuts_m = [0.0; 6].map(|_: f64| random.within(0.02, 0.98) * wall.height_m);
                cuts_m.sort_by(f64::total_cmp);
                if let Some(stronger) = wall.cut_at(&cuts_m).statically(sway, None, true) {
                    assert!(stronger > found.acceleration_g * (1.0 - 1e-6));
                }
            }
        }
    }
    assert!(stand > 50 && high > 1, "{stand} {high}");
}

/// The bodies at finite rotations by the energy of the test: it finds the upper rotation by bisection, and the push as the ratio of slopes, by central
/// differences, whose error is the square of their step.
#[test]
fn displaced_walls_are_in_equilibrium_up_to_their_unstable_position() {
    let (mut random, mut compared) = (Random(11), 0);
    for _ in 0..40 {
        let wall = Wall {
            tie: None,
            ..random_wall(&mut random)
        };
        let column = wall.column();
        for sway in [Sway::Right, Sway::Left] {
            let Ok(found) = HeldMechanism::new(&column, sway) else {
                continue;
            };
            let [toe_m, heel_m] = found.hinges_m();
            let top_m = Vector2::new(wall.floor.x_m, wall.height_m);
            let turned = |at_m: Vector2<f64>, rad: f64| {
                let (sin, cos) = (sway.sign() * rad).sin_cos();
                Vector2::new(cos * at_m.x + sin * at_m.y, cos * at_m.y - sin * at_m.x)
            };
            let moved = |at_m: Vector2<f64>, height_m: f64, q: f64| {
                let hinge_m = toe_m + turned(heel_m - toe_m, q);
                if height_m <= toe_m.y {
                    return at_m;
                }
                if height_m <= heel_m.y {
                    return toe_m + turned(at_m - toe_m, q);
                }
                let off_m =
                    |back: f64| sway.sign() * (hinge_m + turned(top_m - heel_m, -back) - top_m).x;
                let [mut low, mut high] = if q < 0.0 { [-0.5, 0.5] } else { [-0.1, 3.0] };
                for _ in 0..80 {
                    let middle = 0.5 * (low + high);
                    if off_m(middle) > 0.0 {
                        low = middle
                    } else {
                        high = middle
                    }
                }
                hinge_m + turned(at_m - heel_m, -0.5 * (low + high))
            };
            let energy = |q: f64| {
                let weights = wall
                    .points()
                    .into_iter()
                    .map(|(kg, at_m, height_m)| kg * G * moved(at_m, height_m, q).y);
                let pulls = wall
                    .pulls()
                    .into_iter()
                    .map(|(n, at_m)| -n.dot(&moved(at_m, at_m.y, q)));
                weights.chain(pulls).sum::<f64>()
            };
            let push = |q: f64| {
                let pushed = wall
                    .points()
                    .into_iter()
                    .map(|(kg, at_m, height_m)| sway.sign() * kg * G * moved(at_m, height_m, q).x);
                pushed.sum::<f64>()
            };
            let slope = |f: &dyn Fn(f64) -> f64, q: f64| (f(q + 1e-5) - f(q - 1e-5)) / 2e-5;
            let due_g = |q: f64| slope(&energy, q) / slope(&push, q);
            let end_rad = found.end_rad().unwrap();
            for part in [0.0, 0.3, 0.7, 0.95] {
                let q = part * end_rad;
                let displaced = found.displaced(q);
                assert!((displaced.acceleration_g - due_g(q)).abs() < 2e-6 * found.acceleration_g);
                let hinge_m = displaced.hinges_m[1];
                assert!((hinge_m - moved(heel_m, heel_m.y, q)).norm() < 1e-12 * wall.height_m);
                let above_m = displaced.poses[1].current_position(top_m);
                assert!((above_m.x - top_m.x).abs() < 1e-12 * wall.height_m);
                compared += 1;
            }
            assert!(
                (found.displaced(0.0).acceleration_g / found.acceleration_g - 1.0).abs() < 1e-10
            );
            assert!(due_g(end_rad * 0.999) > 0.0 && due_g(end_rad * 1.001) < 0.0);
        }
    }
    assert!(compared > 200, "{compared}");
}

/// Without a floor the hinge would lie at the top, where the multiplier of the closed form is 2 t / H, and the upper body could not turn.
#[test]
fn an_almost_unloaded_wall_has_its_hinge_at_the_top() {
    let found = HeldMechanism::new(&Wall::prism(3.0, 0.4, 1e-3, 0.1).column(), Sway::Left).unwrap();
    assert!((found.acceleration_g / (2.0 * 0.4 / 3.0) - 1.0).abs() < 1e-3);
    assert!(found.hinges_m()[1].y > 2.99);
    assert_eq!(
        found.end_rad(),
        Err(HeldTopError::Locks(CapacityError::Locks(Sway::Left)))
    );
}
