//! Observed points of blocks, such as the crown, and their displacements.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::packed::curve;
use super::summary::PointPeaks;
use crate::dynamics::NO_RISE;
use crate::output::mechanisms::columns;
use crate::output::point::StructurePoint;
use crate::output::{CURVES, Cell, Column, Envelope, HistoryPanels, Mark, Scene, several};
use crate::{OpenHinge, Pose, Sample};

/// Largest number of points: each has two curves with different strokes in the pictures.
pub const MAX_POINTS: usize = CURVES.len() / 2;

/// Observed points of a structure. Collects their displacements from the undeformed structure, relative to the ground.
#[derive(Clone, Debug)]
pub struct ObservedPoints {
    scene: Scene,
    observed: Vec<ObservedPoint>,
}

#[derive(Clone, Debug)]
struct ObservedPoint {
    point: StructurePoint,
    /// Name of the point in columns; empty if there is only one point.
    name: String,
    /// Displacements to the right and upwards.
    displacements: [Displacement; 2],
}

#[derive(Clone, Debug, Default)]
struct Displacement {
    millimetres: Envelope,
    /// The largest displacement, with its sign, in metres.
    farthest_m: f64,
    time_s: f64,
}

/// The axes of displacements in columns, with words for the positive direction.
const AXES: [(&str, &str); 2] = [("x", "to the right"), ("y", "up")];

impl ObservedPoints {
    /// Makes observed points of a structure from their undeformed positions in metres.
    ///
    /// # Errors
    /// When a point is outside the structure, or there are too many points.
    pub(super) fn new(scene: Scene, places_m: &[Vector2<f64>]) -> Result<Self, String> {
        if places_m.len() > MAX_POINTS {
            return Err(format!(
                "--point is given {} times: at most {MAX_POINTS} points are watched at once",
                places_m.len()
            ));
        }
        let mut observed = Vec::new();
        for (index, at_m) in places_m.iter().enumerate() {
            let point = scene.point(*at_m).map_err(|nearest_m| {
                let [low_m, high_m] = scene.bounds_m();
                format!(
                    "--point {} is in no block: the nearest place of one is {}; the structure lies between {} and {} (in metres)",
                    format_point(*at_m),
                    format_point(nearest_m),
                    format_point(low_m),
                    format_point(high_m)
                )
            })?;
            observed.push(ObservedPoint {
                point,
                name: match places_m.len() {
                    1 => String::new(),
                    _ => (index + 1).to_string(),
                },
                displacements: Default::default(),
            });
        }
        Ok(Self { scene, observed })
    }

    /// True if there are observed points.
    pub(super) const fn has_points(&self) -> bool {
        !self.observed.is_empty()
    }

    /// Updates the largest displacements at an instant, and the curves if it is that of a sample. Instants come in the order of time.
    pub(super) fn push(
        &mut self,
        time_s: f64,
        (poses, hinges): (&[Pose], &[OpenHinge]),
        is_sample: bool,
    ) {
        for observed in &mut self.observed {
            let displaced_m = displacement_m(&self.scene, &observed.point, poses, hinges);
            for (component, displaced_m) in
                observed.displacements.iter_mut().zip(displaced_m.iter())
            {
                if is_sample {
                    component.millimetres.push(time_s, 1e3 * displaced_m);
                }
                if displaced_m.abs() > component.farthest_m.abs() * (1.0 + NO_RISE) {
                    (component.farthest_m, component.time_s) = (*displaced_m, time_s);
                }
            }
        }
    }

    /// Columns of the points in `rotations.csv`: `point_x_m` and `point_y_m`, displacements to the right and upwards; with several
    /// points `point_1_x_m` and so on.
    pub(super) fn columns(&self) -> Vec<Column<'static, Sample>> {
        let column = |observed: &ObservedPoint| {
            let (scene, point) = (self.scene.clone(), observed.point);
            let name = std::slice::from_ref(&observed.name);
            let names = AXES.map(|(axis, _)| columns(name, "point", &format!("{axis}_m")));
            several(
                names.into_iter().flatten(),
                move |sample: &Sample, cells| {
                    let displaced_m = displacement_m(&scene, &point, &sample.poses, &sample.hinges);
                    cells.extend(displaced_m.iter().map(|along_m| Cell::from(*along_m)));
                },
            )
        };
        self.observed.iter().map(column).collect()
    }

    /// Largest displacements of the points.
    pub(super) fn peaks(&self) -> Vec<PointPeaks> {
        let peaks = self.observed.iter().map(|observed| {
            let [x, y] = &observed.displacements;
            PointPeaks {
                x_m: observed.point.at_m.x,
                y_m: observed.point.at_m.y,
                peak_x_m: x.farthest_m,
                peak_x_time_s: x.time_s,
                peak_y_m: y.farthest_m,
                peak_y_time_s: y.time_s,
            }
        });
        peaks.collect()
    }

    /// Adds the panel of the displacements.
    pub(super) fn draw(&self, panels: &mut HistoryPanels<'_>) {
        let displacements = self
            .observed
            .iter()
            .flat_map(|observed| &observed.displacements);
        let named = self.names().into_iter().flatten().zip(CURVES);
        let curves: Vec<Mark> = named
            .zip(displacements)
            .map(|((name, stroke), component)| {
                Mark::curve(name, stroke, component.millimetres.points())
            })
            .collect();
        if !curves.iter().all(Mark::is_flat) {
            panels.panels.keys.extend(curves.iter().map(Mark::key));
        }
        panels.curves("Displacement (mm)", 150.0, curves);
    }

    /// Names of the curves of each point, for displacements to the right and upwards.
    pub(super) fn names(&self) -> Vec<[String; 2]> {
        let places = self.observed.iter().map(|one| format_point(one.point.at_m));
        let named = places.map(|at| AXES.map(|(_, positive)| format!("point {at}, {positive}")));
        named.collect()
    }

    /// Bodies that carry the points while these hinges are open.
    pub(super) fn bodies(&self, hinges: &[OpenHinge]) -> Vec<Option<usize>> {
        let marks = self
            .observed
            .iter()
            .map(|one| self.scene.body_point(&one.point, hinges));
        marks.map(|mark| mark.body).collect()
    }

    /// Positions and named curves of the points, in millimetres, for the page.
    pub(super) fn page_curves(&self) -> Vec<PointCurves> {
        let observed = self.observed.iter().zip(self.names());
        let point = |(observed, names): (&ObservedPoint, [String; 2])| PointCurves {
            at_m: observed.point.at_m,
            curves: std::array::from_fn(|axis| NamedCurve {
                name: names[axis].clone(),
                curve: curve(observed.displacements[axis].millimetres.points()),
            }),
        };
        observed.map(point).collect()
    }
}

/// The position of a point, and its encoded displacements.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct PointCurves {
    at_m: Vector2<f64>,
    curves: [NamedCurve; 2],
}

#[derive(Debug, Serialize, Deserialize)]
struct NamedCurve {
    name: String,
    curve: String,
}

fn displacement_m(
    scene: &Scene,
    point: &StructurePoint,
    poses: &[Pose],
    hinges: &[OpenHinge],
) -> Vector2<f64> {
    let carried = scene.body_point(point, hinges);
    carried.current_position(poses, 1.0) - point.at_m
}

/// Position in the format of `--point`.
pub(super) fn format_point(at_m: Vector2<f64>) -> String {
    // Rounds to a millimetre. Adding zero makes a negative zero positive.
    let [x, y] = [at_m.x, at_m.y].map(|metres| (1e3 * metres).round() / 1e3 + 0.0);
    format!("{x},{y}")
}
