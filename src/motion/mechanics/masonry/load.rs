//! Loads on an arch and its piers.

use nalgebra::Vector2;

use super::Pier;
use super::cut::CutArch;
use crate::argument::{ArgumentError, require};
use crate::mechanics::{Block, MassMoments, PlacedLoad, Row, Sway};

impl PlacedLoad {
    pub(super) fn add_to(
        &self,
        extra: &mut [Option<Block>],
        arch: &CutArch,
    ) -> Result<(), ArgumentError> {
        if self.moving_mass_kg() == 0.0 {
            // A constant force needs a point of the extrados, as a mass does.
            let mass = Self::mass(1.0, self.x_m);
            return mass.add_to(&mut vec![None; extra.len()], arch);
        }
        let (from_x, to_x) = (self.x_m - 0.5 * self.width_m, self.x_m + 0.5 * self.width_m);
        let mut placed_kg = 0.0;
        for (voussoir, extra) in extra.iter_mut().enumerate() {
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
                        let mass = self.mass_kg / self.width_m * derivative.x;
                        MassMoments::of_body(mass, point, 0.0)
                    });
                    Block {
                        mass_kg: moments.mass,
                        centre_m: moments.centroid(),
                        inertia_kg_m2: moments.central_polar().max(0.0),
                    }
                } else {
                    if !(start..=end).contains(&self.x_m) || placed_kg > 0.0 {
                        continue;
                    }
                    Block {
                        mass_kg: self.mass_kg,
                        centre_m: piece.point(part(self.x_m)),
                        inertia_kg_m2: 0.0,
                    }
                };
                placed_kg += own.mass_kg;
                *extra = Some(extra.map_or(own, |known| known.with(&own)));
            }
        }
        // Part of the mass is missing if the patch extends beyond an end of the arch.
        let all_stands = (placed_kg / self.mass_kg - 1.0).abs() < 1e-9;
        let joints = arch.joints();
        let ends_m = [joints[0], joints[joints.len() - 1]].map(|joint| joint.extrados_m.x);
        let half_m = 0.5 * self.width_m;
        let (from_m, to_m) = (ends_m[0] + half_m, ends_m[1] - half_m);
        let allowed = match from_m < to_m {
            true => format!("from {from_m:.6} to {to_m:.6}, so that it stands on the extrados"),
            false => "on the extrados, which is no upper side here: give the load as a part of a block, by its density or outline".to_owned(),
        };
        require(all_stands, "x_m", self.x_m, allowed).map(|_| ())
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
