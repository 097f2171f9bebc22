//! What several test files share: arches by their published names, and short ways to run them.
#![allow(dead_code, missing_docs, clippy::unwrap_used)]

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

use archrock::dynamics::ground::GroundMotion;
use archrock::dynamics::history::{History, Request, Sample, history};
use archrock::dynamics::hybrid::rocking::Rocking;
use archrock::mechanics::arch::Arch;
use archrock::mechanics::four_link::chain::Chain;
use archrock::mechanics::four_link::impact::ImpactModel;
use archrock::mechanics::four_link::mechanism::{HingeSites, Sway};
use archrock::mechanics::geometry::ring::Ring;

pub const GRAVITY: f64 = 9.81;

pub fn ring(thickness_ratio: f64, embrace_deg: f64) -> Ring {
    // 180 degrees must be pi itself, the largest angle allowed.
    Ring::new(thickness_ratio, embrace_deg / 180.0 * PI).unwrap()
}

pub fn chain_of(thickness_ratio: f64, embrace_deg: f64, sites: HingeSites) -> Arc<Chain> {
    let ring = ring(thickness_ratio, embrace_deg);
    Arc::new(Chain::new(ring, sites, ImpactModel::MaxRestitution).unwrap())
}

pub fn arch(chain: &Arc<Chain>, mean_radius_m: f64) -> Arch {
    Arch {
        mean_radius_m,
        depth_m: 1.0,
        density_kg_m3: 2000.0,
        chain: chain.clone(),
    }
}

/// The arch of most published numbers: a semicircle of t/R = 0.15, R = 5 m.
pub fn semicircle() -> Arch {
    arch(&chain_of(0.15, 180.0, HingeSites::Anywhere), 5.0)
}

/// 157.5 degrees, t/R = 0.15, seven voussoirs, R = 10 m.
pub fn seven_voussoirs() -> Arch {
    arch(&chain_of(0.15, 157.5, HingeSites::Voussoirs(7)), 10.0)
}

pub fn request(end_s: f64) -> Request {
    Request {
        end_s,
        relative_tolerance: 1e-9,
        initial: None,
        output_step_s: None,
    }
}

pub fn released(end_s: f64, sway: Sway, rotation_rad: f64) -> Request {
    Request {
        initial: Some((sway, rotation_rad)),
        ..request(end_s)
    }
}

pub const REST_ENERGY_RATIO: f64 = 1e-8;

pub fn run<'a>(arch: &'a Arch, ground: &'a GroundMotion, request: &Request) -> History<'a, Arch> {
    run_sampled(arch, ground, request).0
}

pub fn run_sampled<'a>(
    arch: &'a Arch,
    ground: &'a GroundMotion,
    request: &Request,
) -> (History<'a, Arch>, Vec<Sample<[f64; 3]>>) {
    let rocking = Rocking::new(arch, ground, GRAVITY, REST_ENERGY_RATIO);
    let mut samples = Vec::new();
    let history = history(&rocking, request, |sample| {
        samples.push(*sample);
        ControlFlow::Continue(())
    })
    .unwrap();
    (history, samples)
}

/// Random numbers in [0, 1) that are the same on every machine (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Four ordered sections; each one lies on a springing now and then, as maxima often do.
    pub fn quadruple(&mut self, embrace_rad: f64) -> [f64; 4] {
        let mut angles =
            [0.0; 4].map(|_: f64| (self.next() * 1.2 - 0.1).clamp(0.0, 1.0) * embrace_rad);
        angles.sort_by(f64::total_cmp);
        angles
    }
}

/// Best value of `score` near `start` by trying steps along the axes and the diagonals, ever shorter.
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
