//! Loads on an arch and its piers.

use nalgebra::Vector2;

use super::Pier;
use super::cut::CutArch;
use crate::argument::{ArgumentError, require};
use crate::mechanics::{Block, MassMoments, PlacedLoad, Row, Sway};

impl PlacedLoad {
    /// Adds its moving mass to the voussoirs that carry it. A live load and a constant force add none.
    ///
    /// # Errors
    /// If the load is not on the extrados.
    pub(super) fn add_to(
        &self,
        extra: &mut [Option<Block>],
        arch: &CutArch,
    ) -> Result<(), ArgumentError> {
        let bodies = self.bodies(arch);
        let placed_kg: f64 = bodies.iter().map(|(_, body)| body.mass_kg).sum();
        if self.moving_mass_kg() > 0.0 {
            for (voussoir, own) in bodies {
                let extra = &mut extra[voussoir];
                *extra = Some(extra.map_or(own, |known| known.with(&own)));
            }
        }
        // Part of the mass is missing if the patch extends beyond an end of the arch.
        let all_stands = (placed_kg / self.placed_kg() - 1.0).abs() < 1e-9;
        let ends_m = arch.ends_m();
        let half_m = 0.5 * self.width_m;
        let (from_m, to_m) = (ends_m[0] + half_m, ends_m[1] - half_m);
        let wide_m = ends_m[1] - ends_m[0];
        let allowed = match from_m < to_m {
            true => format!("from {from_m:.6} to {to_m:.6}, so that it stands on the extrados"),
            false if wide_m > 0.0 => format!("that of a load narrower than the extrados, {wide_m:.6} m"),
            false => "on the extrados, which is no upper side here: give the load as a part of a block, by its density or outline".to_owned(),
        };
        require(all_stands, "x_m", self.x_m, allowed).map(|_| ())
    }

    /// Mass of its bodies in kg. A constant force needs a point of the extrados, as a mass does.
    const fn placed_kg(&self) -> f64 {
        match self.live {
            false if self.moving_mass_kg() == 0.0 => 1.0,
            _ => self.mass_kg,
        }
    }

    /// The mass as bodies, each with the voussoir that carries it. Parts beyond the ends of the arch are left out.
    pub(super) fn bodies(&self, arch: &CutArch) -> Vec<(usize, Block)> {
        let (from_x, to_x) = (self.x_m - 0.5 * self.width_m, self.x_m + 0.5 * self.width_m);
        let mut bodies: Vec<(usize, Block)> = Vec::new();
        for voussoir in 0..arch.voussoirs() {
            for piece in arch.extrados_of(voussoir) {
                let (start, end) = (piece.point(0.0).x, piece.point(1.0).x);
                let part = |x: f64| match x {
                    x if x <= start => 0.0,
                    x if x >= end => 1.0,
                    x => piece.first(|part| piece.point(part).x >= x),
                };
                let own = if self.width_m > 0.0 {
                    if to_x <= start || from_x >= end {
                        continue;
                    }
                    let loaded = piece.between(part(from_x), part(to_x));
                    let moments = loaded.integral(|point, derivative| {
                        let mass = self.placed_kg() / self.width_m * derivative.x;
                        MassMoments::of_body(mass, point, 0.0)
                    });
                    Block {
                        mass_kg: moments.mass,
                        centre_m: moments.centroid(),
                        inertia_kg_m2: moments.central_polar().max(0.0),
                    }
                } else {
                    if !(start..=end).contains(&self.x_m) || !bodies.is_empty() {
                        continue;
                    }
                    Block {
                        mass_kg: self.placed_kg(),
                        centre_m: piece.point(part(self.x_m)),
                        inertia_kg_m2: 0.0,
                    }
                };
                bodies.push((voussoir, own));
            }
        }
        bodies
    }

    /// Block of the pier that carries this load (at a joint, the lower one), and its point in metres.
    pub(super) fn place_on_pier_m(
        &self,
        side: Sway,
        pier: &Pier,
        row: &Row,
    ) -> Result<(usize, Vector2<f64>), ArgumentError> {
        let height_m = self.height_m.unwrap_or(pier.height_m);
        let allowed = format_args!("from 0 to the height of the pier, {:?} m", pier.height_m);
        let fits = (0.0..=pier.height_m).contains(&height_m);
        require(fits, "height_m", height_m, allowed)?;
        let courses = height_m / pier.height_m * pier.blocks as f64;
        let course = ((courses * (1.0 - 1e-9)).ceil() as usize).saturating_sub(1);
        let (block, foot) = match side {
            Sway::Left => (course, &row.joints[0]),
            Sway::Right => (
                row.blocks.len() - 1 - course,
                &row.joints[row.joints.len() - 1],
            ),
        };
        Ok((block, foot.middle_m() + Vector2::new(self.x_m, height_m)))
    }

    /// Voussoir under its middle, and the point on its extrados, in metres.
    pub(super) fn place_m(&self, arch: &CutArch) -> Option<(usize, Vector2<f64>)> {
        (0..arch.voussoirs()).find_map(|voussoir| {
            arch.extrados_of(voussoir).into_iter().find_map(|piece| {
                let ends = [piece.point(0.0).x, piece.point(1.0).x];
                let part = piece.first(|part| piece.point(part).x >= self.x_m);
                let within = (ends[0]..=ends[1]).contains(&self.x_m);
                within.then(|| (voussoir, piece.point(part)))
            })
        })
    }
}
