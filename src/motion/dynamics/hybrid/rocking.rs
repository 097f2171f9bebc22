//! Rocking under ground motion, as a hybrid system.
//!
//! | mode | moves by | until |
//! |---|---|---|
//! | rest | not at all | the ground acceleration, over effective gravity, passes the incipient one on either side |
//! | rocking | the equation of motion of one mechanism | its hinges close, or it overturns |
//! | overturned | - | - |
//!
//! The structure is any [`MechanismChain`].

use nalgebra::Vector2;

use super::engine::{self, HybridSystem};
use super::integrator::{IntegratorStep, State};
use crate::dynamics::GroundMotion;
use crate::dynamics::ground::GroundPiece;
use crate::mechanics::chain::{Coefficients, MechanismState};
use crate::mechanics::{Demand, Link, Mechanism, MechanismChain, Sides, Sway};

/// Discrete state of a rocking structure.
pub type Mode<'a, M> = Phase<Swing<'a, M>>;

/// Rocking structure at one time.
pub type SystemState<'a, M> = engine::SystemState<Mode<'a, M>, 3>;

/// Phase of the motion.
#[derive(Clone, Copy, Debug)]
pub enum Phase<S> {
    /// At rest, undeformed, moving with the ground.
    Rest,
    /// Rocking with one mechanism.
    Rocking(S),
    /// Overturned.
    Overturned(S),
}

/// Moving mechanism of a chain.
pub type Swing<'a, M> = SwingOf<&'a Link<M>>;

/// Moving mechanism, with its link.
#[derive(Clone, Copy, Debug)]
pub struct SwingOf<L> {
    /// Side of the sway.
    pub sway: Sway,
    /// Number of impacts since the last rest, the index of the link.
    pub impacts: usize,
    /// Link of the mechanism.
    pub link: L,
}

impl<S: Copy> Phase<S> {
    /// Current or last mechanism; `None` at rest.
    pub const fn swing(self) -> Option<S> {
        match self {
            Self::Rest => None,
            Self::Rocking(swing) | Self::Overturned(swing) => Some(swing),
        }
    }
}

/// Guards of a rocking structure: each fires when its value falls below zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// Uplift at rest to this side, to which the ground pushes the structure, with the value `A_L (g + a_v) - push`. `a_v` does not act on constant
    /// forces.
    Uplift(Sway),
    /// Closing of all hinges in rocking, with the value `q`.
    Closing,
    /// Overturning in rocking on quiet ground, with the value `q_c - q`: beyond `q_c`, gravity overturns the structure.
    Critical,
    /// Limit position in rocking, with the value `q_limit - q`: the linkage cannot move further.
    Limit,
}

/// The coordinate `q`, its rate, and the work done by the ground since time zero.
pub type RockingState = State<3>;

/// Ratio of the push at uplift to the incipient one: sufficiently above rounding error for the mechanism to open. Exactly at the threshold the
/// mechanism could close again immediately, without end.
const UPLIFT_FACTOR: f64 = 1.0 + 1e-12;

/// Ratio of the push at uplift to the acceleration at which the equation of motion of the first mechanism changes sign. The latter equals the
/// incipient acceleration within rounding error. This error increases as the arch gets thinner, and exceeds [`UPLIFT_FACTOR`] in arches that are
/// hardly stable.
const OPENING_FACTOR: f64 = 1.0 + 1e-13;

/// Structure on moving ground.
#[derive(Debug)]
pub struct Rocking<'a, C: MechanismChain> {
    /// Mechanisms of the structure.
    pub chain: &'a C,
    /// Ground motion.
    pub ground: &'a GroundMotion,
    gravity_m_s2: f64,
    rest_energy_ratio: f64,
    /// Energy that the first mechanism needs to overturn under gravity alone, on the weaker side. Energies are in the structure's unit of mass times
    /// the square of its unit of length, per s2.
    pub barrier: f64,
    /// Horizontal acceleration at uplift to the right and to the left, in multiples of gravity; `None` if it cannot sway to that side.
    uplift_g: Sides<Option<f64>>,
}

impl<'a, C: MechanismChain> Rocking<'a, C> {
    /// Structure on the given ground. The structure comes to rest if an impact leaves less than `rest_energy_ratio` of the energy barrier
    /// of its first mechanism.
    ///
    /// The ground must press on the structure at all times: see [`GroundMotion::free_fall_s`].
    pub fn new(
        chain: &'a C,
        ground: &'a GroundMotion,
        gravity_m_s2: f64,
        rest_energy_ratio: f64,
    ) -> Self {
        let mut rocking = Self {
            chain,
            ground,
            gravity_m_s2,
            rest_energy_ratio,
            barrier: f64::INFINITY,
            uplift_g: Sides::default(),
        };
        for side in [Sway::Right, Sway::Left] {
            if let Some(first) = chain.link_from(side, 0) {
                rocking.barrier = rocking.barrier.min(rocking.barrier_of(first));
                let opening_g =
                    OPENING_FACTOR * (first.at_zero.potential_slope() / first.at_zero.s_x);
                let uplift_g = UPLIFT_FACTOR * chain.incipient_towards_g(side);
                *rocking.uplift_g.to_mut(side) = Some(uplift_g.max(opening_g));
            }
        }
        rocking
    }

    /// Energy that a mechanism needs to overturn under gravity alone.
    pub fn barrier_of(&self, link: &Link<C::Mechanism>) -> f64 {
        self.gravity_m_s2 / self.chain.length_m() * link.barrier
    }

    /// Smaller of the energy barriers of this mechanism and of the one after its impact.
    pub fn barrier_ahead(&self, swing: Swing<'a, C::Mechanism>) -> f64 {
        let first = self.chain.sway_after(swing.sway, swing.impacts);
        let next = self
            .chain
            .link_from(first, swing.impacts + 1)
            .map_or(f64::INFINITY, |link| self.barrier_of(link));
        self.barrier_of(swing.link).min(next)
    }

    /// Energy on quiet ground over the least energy barrier of the moving mechanism and of all that may follow it; below 1 the structure cannot
    /// overturn ([`MechanismChain::least_barrier_from`]). `defect` is the largest error of the energy up to now, which counts as energy. `None` if
    /// barriers do not decide, or if the moving mechanism is beyond its unstable equilibrium, or has the energy to pass it.
    pub fn energy_over_barriers(
        &self,
        swing: Swing<'a, C::Mechanism>,
        state: &RockingState,
        defect: f64,
    ) -> Option<f64> {
        let energy = self.energy(swing.link, state) + defect;
        if state[0] >= swing.link.critical_rad || energy >= self.barrier_of(swing.link) {
            return None;
        }
        let first = self.chain.sway_after(swing.sway, swing.impacts);
        let least = self.chain.least_barrier_from(first, swing.impacts)?;
        Some(energy / (self.gravity_m_s2 / self.chain.length_m() * least))
    }

    /// Sum of kinetic and potential energy of a mechanism.
    pub fn energy(&self, link: &Link<C::Mechanism>, state: &RockingState) -> f64 {
        let kinetic = 0.5 * link.mechanism.coefficients(state[0]).inertia * state[1] * state[1];
        let rise = link.mechanism.potential(state[0]);
        kinetic + self.gravity_m_s2 / self.chain.length_m() * rise
    }

    /// Mode of a structure released on one side.
    pub fn released_mode(&self, sway: Sway) -> Mode<'a, C::Mechanism> {
        let link = self.chain.link_from(sway, 0);
        let swing = |link| Swing {
            sway,
            impacts: 0,
            link,
        };
        link.map_or(Phase::Rest, |link| Phase::Rocking(swing(link)))
    }

    fn piece(&self, piece: usize) -> &'a GroundPiece {
        &self.ground.pieces[piece]
    }

    /// Ground acceleration in the frame of a mechanism with this sway.
    fn ground_m_s2(&self, sway: Sway, now: &SystemState<'a, C::Mechanism>) -> Vector2<f64> {
        let mut ground_m_s2 = self.piece(now.piece).acceleration_and_rate(now.time_s).0;
        ground_m_s2.x *= sway.sign();
        ground_m_s2
    }

    /// `q''` under gravity and a ground acceleration in the mechanism's own frame. An upward acceleration of the ground adds to gravity.
    fn acceleration(
        &self,
        coefficients: &Coefficients,
        rate: f64,
        ground_m_s2: Vector2<f64>,
    ) -> f64 {
        let force = (self.gravity_m_s2 + ground_m_s2.y) * coefficients.s_y
            + ground_m_s2.x * coefficients.s_x
            + self.gravity_m_s2 * coefficients.s_f;
        let length_m = self.chain.length_m();
        let inertial = 0.5 * coefficients.inertia_slope * rate * rate;
        -(force + length_m * inertial) / (length_m * coefficients.inertia)
    }

    /// Thrust excess and friction demand.
    pub fn demand(&self, now: &SystemState<'a, C::Mechanism>) -> Demand {
        let Some(swing) = now.mode.swing() else {
            let body_force_g = self.body_force_g(Sway::Right, now);
            return self.chain.demand_at_rest(body_force_g);
        };
        let motion = self.motion(swing, now);
        self.chain.demand(&swing.link.mechanism, &motion)
    }

    /// Thrust excess and friction demand of a moving mechanism: see [`MechanismChain::demand_at_sections`].
    pub fn demand_at_sections(
        &self,
        swing: Swing<'a, C::Mechanism>,
        now: &SystemState<'a, C::Mechanism>,
    ) -> Demand {
        let first = self.chain.sway_after(swing.sway, swing.impacts);
        let motion = self.motion(swing, now);
        let mechanism = &swing.link.mechanism;
        (self.chain).demand_at_sections(first, swing.impacts, mechanism, &motion)
    }

    /// Push of the ground to the right on a structure at rest, over gravity plus the vertical acceleration.
    pub fn push_at_rest(&self, now: &SystemState<'a, C::Mechanism>) -> f64 {
        let force_g = self.body_force_g(Sway::Right, now);
        force_g.x / -force_g.y
    }

    /// Whether a motion on quiet ground has too little energy for a rotation of more than this multiple of the critical one.
    pub fn stays_below(
        &self,
        over_critical: f64,
        swing: Swing<'a, C::Mechanism>,
        now: &SystemState<'a, C::Mechanism>,
    ) -> bool {
        let link = swing.link;
        let turned = RockingState::new(over_critical * link.critical_rad, 0.0, 0.0);
        self.piece(now.piece).stays_still()
            && over_critical < 1.0
            && self.energy(link, &now.state) <= self.energy(link, &turned)
    }

    /// Thrust line over the sections from left to right: see [`MechanismChain::eccentricity_ratios`].
    pub fn eccentricity_ratios(&self, now: &SystemState<'a, C::Mechanism>) -> Vec<Option<f64>> {
        let Some(swing) = now.mode.swing() else {
            let body_force_g = self.body_force_g(Sway::Right, now);
            return self.chain.eccentricity_ratios_at_rest(body_force_g);
        };
        let motion = self.motion(swing, now);
        let ratios = (self.chain).eccentricity_ratios(&swing.link.mechanism, &motion);
        match swing.sway {
            Sway::Right => ratios,
            Sway::Left => self.chain.mirrored(ratios),
        }
    }

    /// Gravity minus the ground acceleration in the frame of a mechanism with this sway, in multiples of gravity.
    fn body_force_g(&self, sway: Sway, now: &SystemState<'a, C::Mechanism>) -> Vector2<f64> {
        -self.ground_m_s2(sway, now) / self.gravity_m_s2 - Vector2::new(0.0, 1.0)
    }

    /// State of a mechanism.
    fn motion(
        &self,
        swing: Swing<'a, C::Mechanism>,
        now: &SystemState<'a, C::Mechanism>,
    ) -> MechanismState {
        let (q_rad, rate) = (now.state[0], now.state[1]);
        let coefficients = swing.link.mechanism.coefficients(q_rad);
        let ground_m_s2 = self.ground_m_s2(swing.sway, now);
        let acceleration = self.acceleration(&coefficients, rate, ground_m_s2);
        let square_s2 = self.chain.length_m() / self.gravity_m_s2;
        MechanismState {
            q_rad,
            rate: rate * square_s2.sqrt(),
            acceleration: acceleration * square_s2,
            body_force_g: self.body_force_g(swing.sway, now),
        }
    }

    /// Time scale of a fall from `q = 0`: `1/p`, `p^2 = g (S_y + S_f) / (L M q_c)` with the coefficients at zero.
    pub(super) fn fall_s(&self, link: &Link<C::Mechanism>) -> f64 {
        (link.at_zero.inertia * link.critical_rad / self.potential_slope(link)).sqrt()
    }

    /// Slope of the potential energy at `q = 0`.
    fn potential_slope(&self, link: &Link<C::Mechanism>) -> f64 {
        self.gravity_m_s2 * link.at_zero.potential_slope() / self.chain.length_m()
    }

    /// Largest `q` and rate that the energy of `state` can reach, as orders of magnitude: with the inertia of `q = 0` and the parabola of
    /// its weight for the potential energy.
    fn attainable_state(&self, link: &Link<C::Mechanism>, state: &RockingState) -> (f64, f64) {
        let (q, rate) = (state[0], state[1]);
        let weight = self.potential_slope(link);
        let potential = weight * q * (1.0 - 0.5 * q / link.critical_rad);
        let energy = match 0.5 * link.at_zero.inertia * rate * rate + potential {
            energy if energy > 0.0 && energy < self.barrier => energy,
            _ => self.barrier,
        };
        let rate = (2.0 * energy / link.at_zero.inertia).sqrt();
        ((energy / weight).min(link.critical_rad), rate)
    }
}

impl<'a, C: MechanismChain> HybridSystem<3> for Rocking<'a, C> {
    type Mode = Mode<'a, C::Mechanism>;
    type Guard = Guard;

    fn piece_end_s(&self, piece: usize) -> f64 {
        self.piece(piece).end_s
    }

    fn is_over(&self, mode: Self::Mode, piece: usize) -> bool {
        match mode {
            Phase::Rest => self.piece(piece).stays_still(),
            Phase::Rocking(_) => false,
            Phase::Overturned(_) => true,
        }
    }

    fn is_still(&self, mode: Self::Mode) -> bool {
        !matches!(mode, Phase::Rocking(_))
    }

    fn slope(&self, now: &SystemState<'a, C::Mechanism>) -> RockingState {
        let Phase::Rocking(Swing { sway, link, .. }) = now.mode else {
            return RockingState::zeros();
        };
        let ground_m_s2 = self.ground_m_s2(sway, now);
        let (q, rate) = (now.state[0], now.state[1]);
        let coefficients = link.mechanism.coefficients(q);
        let push = ground_m_s2.x * coefficients.s_x + ground_m_s2.y * coefficients.s_y;
        let work = -push * rate / self.chain.length_m();
        let acceleration = self.acceleration(&coefficients, rate, ground_m_s2);
        RockingState::new(rate, acceleration, work)
    }

    fn interpolate(&self, step: &IntegratorStep<3>, time_s: f64) -> RockingState {
        let span = step.end_s - step.start_s;
        if span <= 0.0 {
            return step.start;
        }
        let x = (time_s - step.start_s) / span;
        // Fifth-degree polynomial of q with the coordinates, rates and accelerations of both ends, in the time over the span; its error is
        // span^6/46080 times the sixth derivative.
        let (q, rate) = (step.start[0], step.start[1] * span);
        let bend = step.start_slope[1] * span * span;
        let miss = step.end[0] - (q + rate + 0.5 * bend);
        let miss_rate = step.end[1] * span - (rate + bend);
        let miss_bend = step.end_slope[1] * span * span - bend;
        let cubic = 10.0 * miss - 4.0 * miss_rate + 0.5 * miss_bend;
        let quartic = -15.0 * miss + 7.0 * miss_rate - miss_bend;
        let quintic = 6.0 * miss - 3.0 * miss_rate + 0.5 * miss_bend;
        let coordinate =
            q + x * (rate + x * (0.5 * bend + x * (cubic + x * (quartic + x * quintic))));
        let slope = rate + x * (bend + x * (3.0 * cubic + x * (4.0 * quartic + x * 5.0 * quintic)));
        // Cubic polynomial of the work with values and rates of both ends.
        let (work, power) = (step.start[2], step.start_slope[2] * span);
        let miss = step.end[2] - (work + power);
        let miss_power = step.end_slope[2] * span - power;
        let work =
            work + x * (power + x * (3.0 * miss - miss_power + x * (miss_power - 2.0 * miss)));
        RockingState::new(coordinate, slope / span, work)
    }

    fn scale(&self, now: &SystemState<'a, C::Mechanism>) -> RockingState {
        let Phase::Rocking(Swing { link, .. }) = now.mode else {
            return RockingState::repeat(1.0);
        };
        let (reach_rad, rate_rad_s) = self.attainable_state(link, &now.state);
        let energy = 0.5 * link.at_zero.inertia * rate_rad_s * rate_rad_s;
        RockingState::new(reach_rad, rate_rad_s, energy)
    }

    fn step_sizes_s(
        &self,
        now: &SystemState<'a, C::Mechanism>,
        relative_tolerance: f64,
    ) -> (f64, f64) {
        let Phase::Rocking(Swing { link, .. }) = now.mode else {
            return (f64::INFINITY, f64::INFINITY);
        };
        let fall_s = self.fall_s(link);
        let (reach_rad, _) = self.attainable_state(link, &now.state);
        let height = reach_rad / link.critical_rad;
        // Time until q returns to zero at constant acceleration. The weight decreases with q, so the return takes longer by up to two thirds of the
        // height; a step should end slightly later.
        let (q, rate) = (now.state[0], now.state[1]);
        let acceleration = self.slope(now)[1];
        let back_s = (rate + (rate * rate - 2.0 * acceleration * q).sqrt()) / -acceleration;
        let hop_s = if acceleration < 0.0 && back_s > 0.0 {
            ((1.0 + height) * back_s).min(fall_s)
        } else {
            fall_s
        };
        // Except for terms of the relative size of its height, a hop is a parabola. The sixth derivative, which determines the error of the method,
        // is of the order of the square of that size. The error of a step h is estimated as height^2 (h/hop)^6.
        let part = libm::pow(relative_tolerance / (height * height), 1.0 / 6.0);
        let longest_s = hop_s.min(self.piece(now.piece).longest_step_s());
        (part.min(1.0) * hop_s, longest_s)
    }

    fn guards(&self, mode: Self::Mode) -> &'static [Guard] {
        match mode {
            Phase::Rest => &[Guard::Uplift(Sway::Right), Guard::Uplift(Sway::Left)],
            Phase::Rocking(_) => &[Guard::Closing, Guard::Critical, Guard::Limit],
            Phase::Overturned(_) => &[],
        }
    }

    fn guard_value(&self, guard: Guard, now: &SystemState<'a, C::Mechanism>) -> (f64, f64) {
        let piece = self.piece(now.piece);
        let (q, rate) = (now.state[0], now.state[1]);
        match (guard, now.mode) {
            (Guard::Uplift(sway), _) => {
                let Some(uplift_g) = *self.uplift_g.get(sway) else {
                    return (1.0, 0.0);
                };
                let (acceleration, jerk) = piece.acceleration_and_rate(now.time_s);
                // A vertical acceleration acts on masses, not on constant forces.
                let first = self.chain.link_from(sway, 0);
                let of_forces = first.map_or(0.0, |it| it.at_zero.s_f / it.at_zero.s_x);
                let tilt = Vector2::new(sway.sign(), uplift_g - of_forces);
                let value = uplift_g * self.gravity_m_s2 + tilt.dot(&acceleration);
                (value, tilt.dot(&jerk))
            }
            (Guard::Closing, _) => (q, rate),
            (Guard::Critical, Phase::Rocking(swing)) if piece.stays_still() => {
                (swing.link.critical_rad - q, -rate)
            }
            (Guard::Limit, Phase::Rocking(swing)) => (swing.link.limit_rad - q, -rate),
            (Guard::Critical | Guard::Limit, _) => (1.0, 0.0),
        }
    }

    fn fired_at_once(&self, now: &SystemState<'a, C::Mechanism>) -> Option<Guard> {
        match now.mode {
            Phase::Rest => {
                let fired = |guard: &Guard| self.guard_value(*guard, now).0 < 0.0;
                self.guards(now.mode).iter().copied().find(fired)
            }
            Phase::Rocking(swing) => {
                let lost = self.piece(now.piece).stays_still()
                    && now.state[0] >= swing.link.critical_rad
                    && now.state[1] >= 0.0;
                lost.then_some(Guard::Critical)
            }
            Phase::Overturned(_) => None,
        }
    }

    fn reset(
        &self,
        guard: Guard,
        now: &SystemState<'a, C::Mechanism>,
    ) -> (Self::Mode, RockingState) {
        let work = now.state[2];
        let still = RockingState::new(0.0, 0.0, work);
        match (guard, now.mode) {
            (Guard::Uplift(sway), _) => (self.released_mode(sway), still),
            (Guard::Critical | Guard::Limit, Phase::Rocking(swing)) => {
                (Phase::Overturned(swing), now.state)
            }
            (Guard::Closing, Phase::Rocking(Swing { sway, impacts, .. })) => {
                // The closing rate is negative, except for rounding errors at the end of a very short hop.
                let closing_rate = (-now.state[1]).max(0.0);
                let first = self.chain.sway_after(sway, impacts);
                let Some(link) = self.chain.link_from(first, impacts + 1) else {
                    return (Phase::Rest, still);
                };
                let rate = link.rate_ratio * closing_rate;
                let sway = self.chain.sway_after(sway, 1);
                let ground_m_s2 = self.ground_m_s2(sway, now);
                let energy = 0.5 * link.at_zero.inertia * rate * rate;
                let held_up = self.acceleration(&link.at_zero, rate, ground_m_s2) > 0.0;
                if energy < self.rest_energy_ratio * self.barrier && !held_up {
                    return (Phase::Rest, still);
                }
                let swing = Swing {
                    sway,
                    impacts: impacts + 1,
                    link,
                };
                (Phase::Rocking(swing), RockingState::new(0.0, rate, work))
            }
            (_, mode @ (Phase::Rest | Phase::Overturned(_))) => (mode, now.state),
        }
    }
}
