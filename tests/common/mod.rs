//! Code that several test files share: arches by their published names, and short ways to run them.

pub mod browser;
pub mod documents;
pub mod momentum;
pub mod motions;
pub mod program;
pub mod prose;
pub mod results;
pub mod schema;

use archrock::dynamics::Pulse;
use archrock::mechanics::four_link::HingeSites;
use archrock::mechanics::masonry::{
    BasketArch, CircularArch, Dimensions, Fill, FillLevel, Masonry, MasonryShape, Material, Pier,
    Piers, PlacedLoad,
};
use archrock::mechanics::settling::Follower;
use archrock::mechanics::stability::collapse_mechanism;
use archrock::mechanics::{Block, Drum, Joint, Row, RowError, Supports};
use archrock::mechanics::{Edge, Ring};
use archrock::{
    Arch, FourLinks, GroundMotion, History, ImpactModel, Initial, Model, Request, Sample, Scenario,
    Sway,
};
use proptest::prelude::*;

use nalgebra::Vector2;

pub const GRAVITY: f64 = 9.81;

pub const REST_ENERGY_RATIO: f64 = 1e-8;

pub fn ring(thickness_ratio: f64, embrace_deg: f64) -> Ring {
    Ring::new(thickness_ratio, embrace_deg.to_radians()).unwrap()
}

pub fn arch(mean_radius_m: f64, thickness_ratio: f64, embrace_deg: f64, sites: HingeSites) -> Arch {
    let arch = Arch::new(mean_radius_m, thickness_ratio, embrace_deg).unwrap();
    match sites {
        HingeSites::Anywhere => arch,
        HingeSites::Voussoirs(voussoirs) => arch.with_voussoirs(voussoirs).unwrap(),
    }
}

/// The table of [`semicircle`].
pub const ARCH: &str = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\n";

/// A column five times as high as wide.
pub const COLUMN: &str = "[column]\nheight_m = 4.0\nwidth_m = 0.8\n";

/// An uneven arch on one pier, with a load: the first table may be continued after [`UNEVEN_ARCH`].
pub const UNEVEN_ARCH: &str =
    "[pointed_arch]\nspan_m = 6.0\nrise_m = 4.0\nthickness_m = 0.6\nvoussoirs = 13\n";
/// Further tables of [`UNEVEN_ARCH`].
pub const ON_A_PIER: &str = "[piers.right]\nheight_m = 2.0\nwidth_m = 1.5\n\
    [[load]]\nmass_kg = 1500.0\nx_m = 1.0\nwidth_m = 0.5\n";

/// A valid scenario.
#[track_caller]
pub fn parsed(text: &str) -> Scenario {
    Scenario::parse(text, "s.toml").unwrap_or_else(|errors| panic!("{errors}"))
}

/// An arch with the impact model of the paper.
pub fn four_links(
    mean_radius_m: f64,
    thickness_ratio: f64,
    embrace_deg: f64,
    sites: HingeSites,
) -> FourLinks {
    let arch = arch(mean_radius_m, thickness_ratio, embrace_deg, sites);
    FourLinks::of_arch(&arch, ImpactModel::MaxRestitution).unwrap()
}

/// The arch of most published numbers: a semicircle of t/R = 0.15, R = 5 m.
pub fn semicircle() -> FourLinks {
    four_links(5.0, 0.15, 180.0, HingeSites::Anywhere)
}

/// 157.5 degrees, t/R = 0.15, seven voussoirs, R = 10 m.
pub fn seven_voussoirs() -> FourLinks {
    four_links(10.0, 0.15, 157.5, HingeSites::Voussoirs(7))
}

/// From rest, with samples at the start and at the end.
pub fn request(end_s: f64) -> Request {
    Request {
        gravity_m_s2: GRAVITY,
        end_s,
        outcome_by_s: None,
        output_step_s: end_s,
        initial: None,
        relative_tolerance: 1e-9,
        rest_energy_ratio: REST_ENERGY_RATIO,
    }
}

pub fn sampled(end_s: f64, output_step_s: f64) -> Request {
    Request {
        output_step_s,
        ..request(end_s)
    }
}

pub fn released(end_s: f64, sway: Sway, rotation_rad: f64) -> Request {
    Request {
        initial: Some(Initial {
            sway,
            rotation_rad,
            rate_rad_s: 0.0,
        }),
        ..request(end_s)
    }
}

/// A pulse from time zero.
pub fn pulse(kind: Pulse, amplitude_g: f64, duration_s: f64) -> GroundMotion {
    kind.lasting_s(duration_s)
        .horizontal_m_s2(amplitude_g * GRAVITY)
        .unwrap()
}

pub fn run(model: &impl Model, ground: &GroundMotion, request: &Request) -> History {
    model.history(ground, request).unwrap()
}

/// A history and its samples.
pub fn run_sampled(
    model: &impl Model,
    ground: &GroundMotion,
    request: &Request,
) -> (History, Vec<Sample>) {
    let history = run(model, ground, request);
    let samples = history.samples.iter().collect();
    (history, samples)
}

/// The least number between two from which a condition holds, to a width.
pub fn least([mut low, mut high]: [f64; 2], width: f64, holds: impl Fn(f64) -> bool) -> f64 {
    while high - low > width {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// Integral over `0..1` by Simpson's rule, for smooth integrands.
pub fn integral(integrand: impl Fn(f64) -> f64) -> f64 {
    let intervals = 4000;
    let h = 1.0 / f64::from(intervals);
    let of = |index: i32| {
        let at = |x: f64| integrand(h * (f64::from(index) + x));
        h / 6.0 * (at(0.0) + 4.0 * at(0.5) + at(1.0))
    };
    (0..intervals).map(of).sum()
}

/// Angle and rate after a step by the classical Runge-Kutta method, for an acceleration that depends on time and angle.
pub fn runge_kutta(
    acceleration: impl Fn(f64, f64) -> f64,
    time_s: f64,
    [q, rate]: [f64; 2],
    h: f64,
) -> [f64; 2] {
    let slope = |time_s: f64, [q, rate]: [f64; 2]| [rate, acceleration(time_s, q)];
    let add = |k: [f64; 2], h: f64| [q + h * k[0], rate + h * k[1]];
    let k1 = slope(time_s, [q, rate]);
    let k2 = slope(time_s + 0.5 * h, add(k1, 0.5 * h));
    let k3 = slope(time_s + 0.5 * h, add(k2, 0.5 * h));
    let k4 = slope(time_s + h, add(k3, h));
    let sum = |i: usize| k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i];
    [q + h / 6.0 * sum(0), rate + h / 6.0 * sum(1)]
}

/// Instants of the impacts.
pub fn impact_times_s(history: &History) -> Vec<f64> {
    history.impacts().map(|(time_s, _)| time_s).collect()
}

/// Random numbers in [0, 1), the same on every machine (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.next()
    }

    /// A whole number below this one.
    pub fn pick(&mut self, below: usize) -> usize {
        (self.next() * below as f64) as usize
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.next() < probability
    }

    /// Four ordered sections; now and then one lies on a springing, as maxima often do.
    pub fn quadruple(&mut self, embrace_rad: f64) -> [f64; 4] {
        let mut angles =
            [0.0; 4].map(|_: f64| (self.next() * 1.2 - 0.1).clamp(0.0, 1.0) * embrace_rad);
        angles.sort_by(f64::total_cmp);
        angles
    }
}

/// Best value of `score` near `start`, by trying ever shorter steps along the axes and the diagonals.
/// Slow and plain: it shares nothing with the search of the library.
pub fn climb(
    start: [f64; 4],
    embrace_rad: f64,
    score: impl Fn([f64; 4]) -> Option<f64>,
) -> Option<(f64, [f64; 4])> {
    let mut angles = start;
    let mut best = score(angles)?;
    let mut step = 0.1 * embrace_rad;
    while step > 1e-7 {
        let before = best;
        for code in 0..81_i32 {
            let mut moved = angles;
            for (i, angle) in moved.iter_mut().enumerate() {
                let way = f64::from(code / 3_i32.pow(i as u32) % 3 - 1);
                *angle = (*angle + way * step).clamp(0.0, embrace_rad);
            }
            if let Some(value) = score(moved).filter(|value| *value > best) {
                (best, angles) = (value, moved);
            }
        }
        if best <= before + 1e-12 {
            step *= 0.5;
        }
    }
    Some((best, angles))
}

pub fn degrees(radians: [f64; 4]) -> [f64; 4] {
    radians.map(f64::to_degrees)
}

/// Asserts that every angle agrees with the printed one to its last digit.
pub fn assert_hinges(hinges_rad: [f64; 4], printed_deg: [f64; 4], tolerance_deg: f64) {
    for (hinge, printed) in degrees(hinges_rad).into_iter().zip(printed_deg) {
        assert!(
            (hinge - printed).abs() <= tolerance_deg,
            "{:?} {printed_deg:?}",
            degrees(hinges_rad)
        );
    }
}

/// Rotations or rates of the three bodies of an arch.
pub fn three(of_bodies: &[f64]) -> [f64; 3] {
    of_bodies.try_into().unwrap()
}

/// Valid numbers, and numbers that a caller may give by mistake.
pub fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => any::<f64>(),
        2 => proptest::num::f64::ANY,
        3 => (-12.0_f64..12.0, any::<bool>()).prop_map(|(exponent, negative)| {
            10_f64.powf(exponent) * if negative { -1.0 } else { 1.0 }
        }),
        2 => proptest::sample::select(vec![
            f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, f64::MIN_POSITIVE, 5e-324,
            1e-320, f64::MAX, f64::MIN, f64::EPSILON, 1.0, 180.0, 2.0, -1.0,
        ]),
    ]
}

/// Mostly valid, so that one wrong number is found among valid ones.
pub fn number(fine: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![4 => fine, 1 => any_number()]
}

/// Pairs the elements of both; neither may be empty, and both must have the same length.
#[track_caller]
pub fn pairs<A, B>(
    a: impl IntoIterator<Item = A>,
    b: impl IntoIterator<Item = B>,
) -> impl Iterator<Item = (A, B)> {
    let (a, b): (Vec<A>, Vec<B>) = (a.into_iter().collect(), b.into_iter().collect());
    assert!(
        !a.is_empty() && a.len() == b.len(),
        "{} elements beside {}",
        a.len(),
        b.len()
    );
    a.into_iter().zip(b)
}

/// Quadrilateral blocks between consecutive faces. The first face lies on the left support; the last one on the right support, or
/// else it is the free top of a stack.
pub fn between_faces(
    faces: &[Joint],
    supports: Supports,
    size_m: f64,
    depth_m: f64,
    density_kg_m3: f64,
) -> Result<Row, RowError> {
    let pairs = faces.windows(2);
    let blocks =
        pairs.map(|pair| Block::prism(&pair[0].outline_m(&pair[1]), depth_m, density_kg_m3));
    let count = match supports {
        Supports::Left => faces.len().saturating_sub(1),
        Supports::Both => faces.len(),
    };
    Row::new(blocks.collect(), faces[..count].to_vec(), supports, size_m)
}

/// An arch of equal straight-sided voussoirs, whose corners lie on the intrados and the extrados of the ring.
pub fn straight_sided_arch(
    ring: &Ring,
    voussoirs: usize,
    mean_radius_m: f64,
    depth_m: f64,
    density_kg_m3: f64,
) -> Result<Row, RowError> {
    let corner = |angle: f64, edge| ring.point(angle, edge) * mean_radius_m;
    let faces = ring.sections(voussoirs).into_iter().map(|angle| Joint {
        intrados_m: corner(angle, Edge::Intrados),
        extrados_m: corner(angle, Edge::Extrados),
    });
    let faces: Vec<Joint> = faces.collect();
    between_faces(
        &faces,
        Supports::Both,
        mean_radius_m,
        depth_m,
        density_kg_m3,
    )
}

/// Any arch or stack, of up to `most` blocks.
pub fn random_row(random: &mut Random, most: usize) -> Row {
    let count = 1 + random.pick(most);
    if random.chance(0.4) {
        let mut width_m = 0.6 + random.next();
        let drums: Vec<Drum> = (0..count)
            .map(|_| {
                let base_width_m = width_m;
                width_m *= 0.85 + 0.2 * random.next();
                let height_m = (0.3 + random.next()) * (6.0 / count as f64);
                Drum {
                    height_m,
                    base_width_m,
                    top_width_m: width_m,
                }
            })
            .collect();
        return Row::stack(&drums, 1.0, 2000.0).unwrap();
    }
    let embrace = (0.35 + 0.65 * random.next()) * std::f64::consts::PI;
    let ring = Ring::new(0.11 + 0.15 * random.next(), embrace).unwrap();
    let radius_m = 1.0 + 12.0 * random.next();
    if random.chance(0.5) || count < 3 {
        Row::arch(&ring, count, radius_m, 0.7, 1900.0).unwrap()
    } else {
        straight_sided_arch(&ring, count, radius_m, 0.7, 1900.0).unwrap()
    }
}

/// A pointed, elliptic, basket or uneven circular arch, on piers or not, under fill and a load or not.
pub fn random_masonry(random: &mut Random) -> Option<Masonry> {
    let voussoirs = [5, 8, 11, 16][random.pick(4)];
    let thickness_m = random.within(0.5, 1.4);
    let dimensions = |rise_m| Dimensions {
        span_m: 10.0,
        rise_m,
        thickness_m,
        voussoirs,
        material: Material::default(),
    };
    let shape = match random.pick(4) {
        0 => MasonryShape::PointedArch(dimensions(random.within(5.0, 9.0))),
        1 => MasonryShape::EllipticArch(dimensions(random.within(3.0, 7.0))),
        2 => MasonryShape::BasketArch(BasketArch {
            dimensions: dimensions(random.within(3.2, 5.0)),
            crown_deg: random.within(40.0, 75.0),
        }),
        _ => {
            let embrace_deg = random.within(130.0, 180.0);
            let arch = Arch::new(5.0, thickness_m / 5.0, embrace_deg).ok()?;
            let mut inner: Vec<f64> = (1..voussoirs)
                .map(|_| random.within(0.0, embrace_deg))
                .collect();
            inner.sort_by(f64::total_cmp);
            let mut joints_deg = vec![0.0];
            joints_deg.extend(inner);
            joints_deg.push(embrace_deg);
            MasonryShape::Circular(CircularArch::new(arch, Some(joints_deg)).ok()?)
        }
    };
    let pier = |random: &mut Random| {
        random.chance(0.5).then(|| Pier {
            height_m: random.within(1.0, 4.0),
            width_m: random.within(1.5, 4.0),
            blocks: 1 + random.pick(3),
            density_kg_m3: None,
            pedestal: false,
        })
    };
    let piers = Piers {
        left: pier(random),
        right: pier(random),
    };
    let fill = random.chance(0.5).then(|| Fill {
        level: if random.chance(0.5) {
            FillLevel::AboveCrown(random.within(0.0, 1.0))
        } else {
            FillLevel::AboveSpringing(random.within(0.5, 3.0))
        },
        density_kg_m3: 1600.0,
        on_piers: random.chance(0.5),
    });
    let loads = if random.chance(0.5) {
        vec![PlacedLoad {
            mass_kg: random.within(100.0, 4000.0),
            x_m: random.within(-3.0, 3.0),
            width_m: 0.5,
            ..PlacedLoad::default()
        }]
    } else {
        Vec::new()
    };
    Masonry::new(shape, piers, fill, loads).ok()
}

/// Broadband noise, with a vertical component of up to free fall.
pub fn noise(random: &mut Random, peak_g: [f64; 2], length_s: f64) -> GroundMotion {
    let count = (length_s / 0.02) as usize;
    let mut record = |peak: f64| -> Vec<(f64, f64)> {
        (0..count)
            .map(|i| {
                (
                    0.02 * i as f64,
                    (2.0 * random.next() - 1.0) * peak * GRAVITY,
                )
            })
            .collect()
    };
    let (horizontal, vertical) = (record(peak_g[0]), record(peak_g[1]));
    GroundMotion::record(&horizontal, &vertical, 0.0).unwrap()
}

/// Any row that stands, under any ground.
pub fn random_history(random: &mut Random, most: usize, length_s: f64) -> (Row, GroundMotion) {
    let row = loop {
        let row = random_row(random, most);
        if collapse_mechanism(&row).unwrap().is_none() {
            break row;
        }
    };
    let strength_g = 0.05 + 1.5 * random.next() * random.next();
    let ground = if random.chance(0.4) {
        let kind = Pulse::ALL[random.pick(Pulse::ALL.len())];
        let amplitude = Vector2::new(strength_g, random.next() - 0.5) * GRAVITY;
        let duration_s = 0.05 + random.next();
        kind.lasting_s(duration_s)
            .starting_at_s(0.1)
            .inclined_m_s2(amplitude)
            .unwrap()
    } else {
        let vertical_g = random.next() * 1.0;
        noise(random, [2.0 * strength_g, 2.0 * vertical_g], length_s)
    };
    (row, ground)
}

/// The pushes of the first motion of a row and at its fall, to one side and in units of gravity.
pub fn pushes_g(follower: &Follower, sway: Sway) -> [f64; 2] {
    let first_g = follower.first_motion_g(sway).unwrap().unwrap();
    [
        first_g,
        follower.capacity_g(sway, first_g).unwrap().unwrap(),
    ]
}
