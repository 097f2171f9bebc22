//! Damping time that gives a column of one block a rebound, found by simulated impacts.
//!
//! The ratio of rates after and before an impact has no closed form: the contact opens and closes, and the new toe may bounce. So the block is
//! set rocking from rest with several rates, for damping times up to those that hardly change the rebound, and the ratio follows from
//! its peaks before and after the first impact. A ratio holds if all rates give it.

use nalgebra::{Vector2, Vector3};

use super::ElasticJoints;
use super::motion::{ElasticMotion, ElasticStep, GroundActivity};
use crate::dynamics::{ReboundError, RowModelError};
use crate::mechanics::elastic_joint::ElasticProperties;
use crate::mechanics::{
    Column, ElasticStructure, Equilibrium, ImpactModel, Lanes, Mechanism, MechanismChain,
    RockingColumn, Sway,
};

/// Rotations to which the block is set rocking, over that which overturns it.
const PEAKS: [f64; 3] = [0.12, 0.25, 0.45];
/// Rotations with which a damping time is checked.
const CHECKED_PEAKS: [f64; 3] = [0.17, 0.33, 0.6];
/// Rotation of a rebound, over the first peak, above which it has passed its peak once it has lost a twentieth of it.
const LEAST_REBOUND: f64 = 0.05;
/// Longest half cycle, over the square root of size over gravity; from the larger of [`PEAKS`] it takes about three.
const LONGEST_CYCLE: f64 = 20.0;
/// First and last damping ratio of the fastest vibration, in powers of the root of ten. Above, the ratio of rates hardly changes on a base, and is
/// near zero against a wall.
const DAMPING_POWERS: [i32; 2] = [-6, 2];
/// Largest error of the mean ratio of rates, over the ratio, and of the mean loss of rate, over this loss.
const MOST_ERROR: f64 = 0.02;
const MOST_ERROR_OF_LOSS: f64 = 0.06;
/// Error over the largest one at which the search ends.
const FINE: f64 = 0.2;
/// Largest error of the mean ratio of the checked impacts, and of the ratio of any impact, over the ratio.
const MOST_CHECKED_ERROR: f64 = 0.03;
const MOST_SPREAD: f64 = 0.05;
/// Bisections of an interval of damping times. The ratio varies a little with the phase of vibrations, so more find no better one.
const BISECTIONS: usize = 8;

/// A column of one block that is set rocking on its base, or away from the wall behind it.
struct Rocking {
    structure: ElasticStructure,
    gravity_m_s2: f64,
    rest: Equilibrium,
    chain: RockingColumn,
    /// Sides to which it starts: both if they differ.
    sways: &'static [Sway],
    /// Centre of gravity from the middle of the base, and half the width of the base, in m.
    centre_m: Vector2<f64>,
    half_width_m: f64,
}

/// Damping time in s, with the mean, the least and the largest ratio of rates that it gives.
#[derive(Clone, Copy)]
struct Damped {
    time_s: f64,
    mean: f64,
    least: f64,
    most: f64,
}

impl ElasticJoints {
    /// Damping time in s with which a column of one block, under this gravity, rebounds with this ratio of rates after and before an impact on its
    /// base, or on the wall behind it. The ratio is the root of the ratio of the energies of rocking, without vibration.
    ///
    /// # Errors
    /// If no damping gives this ratio, or the column has no joints with these properties, or does not stand on them.
    pub fn damping_time_of_rebound_s(
        gravity_m_s2: f64,
        column: &Column,
        properties: &ElasticProperties,
        rate_ratio: f64,
    ) -> Result<f64, RowModelError> {
        let mut rocking = Rocking::new(gravity_m_s2, column, properties)?;
        let frequency = rocking.structure.frequency_bound_rad_s();
        let [first, last] = DAMPING_POWERS;
        let times_s = (first..=last)
            .map(|power| 2.0 / frequency * libm::pow(10.0, 0.5 * f64::from(power)))
            .filter(|time_s| ElasticProperties::DAMPING_TIME_S.contains(time_s));
        let accepted = (MOST_ERROR * rate_ratio).min(MOST_ERROR_OF_LOSS * (1.0 - rate_ratio));
        let error = |one: &Damped| one.mean - rate_ratio;
        let nearest = |all: &mut dyn Iterator<Item = Damped>| {
            all.min_by(|a, b| error(a).abs().total_cmp(&error(b).abs()))
        };
        let holds = |one: &Damped, accepted: f64| {
            let farthest = (rate_ratio - one.least).max(one.most - rate_ratio);
            error(one).abs() <= accepted && farthest <= MOST_SPREAD * rate_ratio
        };
        let mut found: Vec<Damped> = Vec::new();
        let (mut best, mut failed): (Option<Damped>, Option<Damped>) = (None, None);
        // The weakest damping that holds allows the longest steps.
        for time_s in times_s {
            let before = found.last().copied();
            let mut more = rocking.damped(time_s, PEAKS);
            let mut tried = vec![more];
            let mut less = before.filter(|before| error(before) * error(&more) < 0.0);
            while let Some(low) = less
                && tried.len() <= BISECTIONS
                && !tried.iter().any(|one| holds(one, FINE * accepted))
            {
                let middle = rocking.damped((low.time_s * more.time_s).sqrt(), PEAKS);
                tried.push(middle);
                match error(&middle) * error(&low) > 0.0 {
                    true => less = Some(middle),
                    false => more = middle,
                }
            }
            let fits = tried.iter().filter(|one| holds(one, accepted));
            if let Some(one) = nearest(&mut fits.copied()) {
                let checked = rocking.damped(one.time_s, CHECKED_PEAKS);
                match holds(&checked, MOST_CHECKED_ERROR * rate_ratio) {
                    true if holds(&one, 0.5 * accepted) => return Ok(one.time_s),
                    true => best = nearest(&mut best.into_iter().chain([one])),
                    false => failed = Some(checked),
                }
            }
            // The end of the interval comes last.
            tried.reverse();
            found.extend(tried);
        }
        let least = found.iter().map(|one| one.mean).fold(1.0, f64::min);
        let most = found.iter().map(|one| one.mean).fold(0.0, f64::max);
        if let Some(best) = best {
            return Ok(best.time_s);
        }
        Err(match failed.or(nearest(&mut found.into_iter())) {
            Some(one) if (least..=most).contains(&rate_ratio) => {
                ReboundError::Varies(one.least, one.most)
            }
            _ => ReboundError::OutOfReach(least, most),
        }
        .into())
    }
}

impl Rocking {
    fn new(
        gravity_m_s2: f64,
        column: &Column,
        properties: &ElasticProperties,
    ) -> Result<Self, RowModelError> {
        let law = ImpactModel::Prescribed { restitution: 1.0 };
        let chain = RockingColumn::new(column, law);
        let chain = chain.ok().filter(|_| column.is_one_prism());
        let chain = chain.ok_or(ReboundError::SeveralBlocks)?;
        let wall = column.wall_behind_drums()?;
        let sways: &[Sway] = match wall {
            Some((Sway::Left, _)) => &[Sway::Right],
            Some((Sway::Right, _)) => &[Sway::Left],
            None if column.is_symmetric() => &[Sway::Right],
            None => &[Sway::Right, Sway::Left],
        };
        let needs = sways.iter().map(|sway| chain.incipient_towards_g(*sway));
        let needs = needs.fold(0.0, f64::max);
        let friction = properties.friction_coefficient;
        if friction.is_some_and(|given| given <= needs) {
            return Err(ReboundError::Slides(needs).into());
        }
        let row = column.row()?;
        let structure =
            ElasticStructure::of_row(&row, properties)?.with_wall(&row, wall, properties)?;
        let rest = structure.rest([0.0, -gravity_m_s2])?;
        Ok(Self {
            structure,
            gravity_m_s2,
            rest,
            chain,
            sways,
            centre_m: row.blocks[0].centre_m - row.joints[0].middle_m(),
            half_width_m: 0.5 * column.width_m,
        })
    }

    /// Ratios of rates that a damping time gives, for first peaks of these parts of the rotation that overturns the block.
    fn damped(&mut self, time_s: f64, peaks: [f64; 3]) -> Damped {
        self.structure.damping_time_s = time_s;
        let sways = self.sways.iter();
        let ratios: Vec<f64> = sways
            .flat_map(|sway| peaks.map(|part| self.ratio(*sway, part)))
            .collect();
        Damped {
            time_s,
            mean: ratios.iter().sum::<f64>() / ratios.len() as f64,
            least: ratios.iter().copied().fold(f64::INFINITY, f64::min),
            most: ratios.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Ratio of rates after and before the first impact, for a first peak of about this part of the rotation that overturns the block.
    fn ratio(&self, sway: Sway, part: f64) -> f64 {
        let (structure, sign) = (&self.structure, sway.sign());
        let (side, returned) = match structure.wall {
            Some(_) => (1.0, sway),
            None => (-1.0, sway.opposite()),
        };
        let links = [sway, returned].map(|sway| self.chain.link_from(sway, 0));
        let [Some(first), Some(second)] = links else {
            return 0.0;
        };
        let size_m = self.chain.length_m();
        let potential = first.mechanism.potential(part * first.critical_rad);
        let rate = (2.0 * self.gravity_m_s2 * potential / (size_m * first.at_zero.inertia)).sqrt();
        let mut motion = ElasticMotion::<1>::new(structure, self.gravity_m_s2);
        motion.start_from_rest(0, &self.rest);
        let arm_m = self.centre_m - Vector2::new(sign * self.half_width_m, 0.0);
        let unit = Vector3::new(arm_m.y, -arm_m.x, -1.0) * sign;
        motion.set_velocities(0, &[rate * unit]);
        let step_s = ElasticJoints::default_step_s(structure);
        let mut step = ElasticStep {
            drift_s: Lanes([step_s]),
            kick_s: Lanes([0.5 * step_s]),
            damping: Lanes([structure.damping_time_s / step_s]),
            ..ElasticStep::none()
        };
        let mut next_rad = || {
            motion.step(&step, GroundActivity::default());
            step.kick_s = step.drift_s;
            -sign * motion.bodies[0].angle_rad.0[0]
        };
        let longest_s = LONGEST_CYCLE * (size_m / self.gravity_m_s2).sqrt();
        let (mut peak_rad, mut rebound_rad) = (0.0_f64, 0.0_f64);
        // At the start the block may vibrate.
        let half_cycle = (1..(longest_s / step_s) as usize).find(|_| {
            let turned_rad = next_rad();
            peak_rad = peak_rad.max(turned_rad);
            turned_rad <= 0.0 && peak_rad > 0.5 * part * first.critical_rad
        });
        for _ in 0..half_cycle.unwrap_or(0) {
            let turned_rad = side * next_rad();
            rebound_rad = rebound_rad.max(turned_rad);
            if rebound_rad > LEAST_REBOUND * peak_rad && turned_rad < 0.95 * rebound_rad {
                break;
            }
        }
        let energies =
            second.mechanism.potential(rebound_rad) / first.mechanism.potential(peak_rad);
        energies.max(0.0).sqrt()
    }
}
