//! The boundaries of a map whose y is the amplitude of the pulse: the onset of rocking, and the amplitude
//! from which the first fall overturns, before any impact.

use serde::{Deserialize, Serialize};

use super::{CellResult, CellRow, OverturningMap};
use crate::mechanics::sway::Sway;
use crate::scenario::Quantity;
use crate::studies::ending::check_finite;
use crate::studies::runner::Study;

/// The boundaries at a value of x, as magnitudes: a mirrored pulse has the same boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Boundary {
    /// Peak acceleration below which the structure does not move, in g.
    pub incipient_g: f64,
    /// The smallest amplitude that overturns in the first fall, before any impact, in g; `None` if no allowed
    /// amplitude does.
    pub impact_free_g: Option<f64>,
}

/// The result at a value of x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundaryRow {
    /// The value of x.
    pub x: f64,
    /// The boundaries; `None` if there is no arch of four links; or why they could not be found.
    pub result: Result<Option<Boundary>, String>,
}

/// The boundaries of a map, one case for each value of x.
#[derive(Clone, Copy, Debug)]
pub struct ImpactFreeBoundary<'m> {
    map: &'m OverturningMap<'m>,
}

impl<'m> ImpactFreeBoundary<'m> {
    /// The boundaries of a map; `None` if its y is not the amplitude, or its hinges are free.
    #[must_use]
    pub fn new(map: &'m OverturningMap<'m>) -> Option<Self> {
        // If the amplitude is one of the axes, it is y.
        let has_edge = map.axes()[1].quantity == Quantity::Amplitude && !map.has_free_hinges();
        has_edge.then_some(Self { map })
    }

    fn result(&self, x: usize) -> Result<Option<Boundary>, String> {
        let amplitudes_g = &self.map.values()[1];
        let index = x * amplitudes_g.len();
        let pulse = self.map.pulse(index);
        // The amplitudes of the cells are tried too, so that no cell contradicts the boundary.
        let tried_g: Vec<f64> = amplitudes_g.iter().map(|value| value.abs()).collect();
        let found = self.map.ask_mechanisms(index, |model, request| {
            let Some(pulse) = pulse else {
                return Ok(None);
            };
            let found = pulse
                .minimum_without_impact(model, request, &tried_g)
                .map_err(|error| error.to_string())?;
            let incipient_g = model
                .incipient_acceleration_g(Sway::Right)
                .unwrap_or(f64::INFINITY);
            check_finite(&[incipient_g])?;
            Ok(Some(Boundary {
                incipient_g,
                impact_free_g: found.map(|(amplitude_g, _)| amplitude_g),
            }))
        });
        match found {
            Ok(found) => found.unwrap_or(Ok(None)),
            Err(CellResult::Failed(reason)) => Err(reason),
            Err(_) => Ok(None),
        }
    }
}

impl Study for ImpactFreeBoundary<'_> {
    type Row = BoundaryRow;

    const NAME: &'static str = "boundary";

    fn scenario(&self) -> String {
        Study::scenario(self.map)
    }

    fn count(&self) -> usize {
        self.map.values()[0].len()
    }

    fn row(&self, index: usize) -> BoundaryRow {
        BoundaryRow {
            x: self.map.values()[0][index],
            result: self.result(index),
        }
    }
}

/// A map with its boundaries, if it has any, as one study: first the cells, then the boundaries. Threads, parts
/// and resuming work for both.
#[derive(Clone, Copy, Debug)]
pub struct MapWithBoundary<'m> {
    map: &'m OverturningMap<'m>,
    boundary: Option<ImpactFreeBoundary<'m>>,
}

/// A row of either kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MapRow {
    /// A cell.
    Cell(CellRow),
    /// The boundaries at a value of x.
    Boundary(BoundaryRow),
}

impl MapRow {
    /// The cells and the boundaries, each in their order.
    #[must_use]
    pub fn sorted(rows: Vec<Self>) -> (Vec<CellRow>, Vec<BoundaryRow>) {
        let (mut cells, mut boundaries) = (Vec::new(), Vec::new());
        for row in rows {
            match row {
                Self::Cell(cell) => cells.push(cell),
                Self::Boundary(boundary) => boundaries.push(boundary),
            }
        }
        (cells, boundaries)
    }
}

impl<'m> MapWithBoundary<'m> {
    /// The study of a map.
    #[must_use]
    pub fn new(map: &'m OverturningMap<'m>) -> Self {
        Self {
            map,
            boundary: ImpactFreeBoundary::new(map),
        }
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &'m OverturningMap<'m> {
        self.map
    }

    /// Whether the map has boundaries.
    #[must_use]
    pub const fn has_boundary(&self) -> bool {
        self.boundary.is_some()
    }
}

impl Study for MapWithBoundary<'_> {
    type Row = MapRow;

    const NAME: &'static str = "map";

    fn scenario(&self) -> String {
        Study::scenario(self.map)
    }

    fn inputs(&self) -> Vec<String> {
        self.map.inputs()
    }

    fn count(&self) -> usize {
        self.map.count() + self.boundary.map_or(0, |boundary| boundary.count())
    }

    fn row(&self, index: usize) -> MapRow {
        match (index.checked_sub(self.map.count()), &self.boundary) {
            (Some(x), Some(boundary)) => MapRow::Boundary(boundary.row(x)),
            _ => MapRow::Cell(self.map.row(index)),
        }
    }

    fn family(&self, index: usize) -> Option<usize> {
        (index < self.map.count())
            .then(|| self.map.family(index))
            .flatten()
    }

    fn rows(&self, indices: &[usize]) -> Vec<MapRow> {
        match indices {
            // Only cells have a family.
            [_, _, ..] => self
                .map
                .rows(indices)
                .into_iter()
                .map(MapRow::Cell)
                .collect(),
            alone => alone.iter().map(|index| self.row(*index)).collect(),
        }
    }
}
