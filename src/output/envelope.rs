//! Thins long series for pictures.

/// Largest number of columns to which a curve is thinned: about two per pixel.
pub(crate) const COLUMNS: usize = 1600;

/// A long series of values, thinned to the smallest and largest of each of equal groups.
#[derive(Clone, Debug)]
pub(crate) struct Envelope {
    /// Largest number of columns.
    most: usize,
    group: usize,
    /// Number of samples in the last column.
    in_last: usize,
    /// Time and value of the minimum and of the maximum of each column.
    columns: Vec<[(f64, f64); 2]>,
    last: Option<(f64, f64)>,
}

impl Default for Envelope {
    fn default() -> Self {
        Self::of_columns(COLUMNS)
    }
}

impl Envelope {
    /// An envelope thinned to at most this many columns.
    pub(crate) const fn of_columns(most: usize) -> Self {
        Self {
            most,
            group: 1,
            in_last: 0,
            columns: Vec::new(),
            last: None,
        }
    }

    pub(crate) fn push(&mut self, time_s: f64, value: f64) {
        let point = (time_s, value);
        self.last = Some(point);
        if self.in_last < self.group
            && let Some(column) = self.columns.last_mut()
        {
            *column = joined(*column, [point; 2]);
            self.in_last += 1;
            return;
        }
        if self.columns.len() == self.most {
            self.columns = self
                .columns
                .chunks(2)
                .map(|pair| joined(pair[0], pair[pair.len() - 1]))
                .collect();
            self.group *= 2;
        }
        self.columns.push([point; 2]);
        self.in_last = 1;
    }

    /// The points to draw, in order of time.
    pub(crate) fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        let extremes = self.columns.iter().flat_map(|[low, high]| {
            if low.0 <= high.0 {
                [*low, *high]
            } else {
                [*high, *low]
            }
        });
        for point in extremes.chain(self.last) {
            if points.last().is_none_or(|last| last.0 < point.0) {
                points.push(point);
            }
        }
        points.into_iter()
    }
}

fn joined(a: [(f64, f64); 2], b: [(f64, f64); 2]) -> [(f64, f64); 2] {
    let low = if b[0].1 < a[0].1 { b[0] } else { a[0] };
    let high = if b[1].1 > a[1].1 { b[1] } else { a[1] };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_envelope_keeps_extremes_and_ends_in_few_points() {
        let mut envelope = Envelope::default();
        let count = 100_003;
        for i in 0..count {
            let spike = if i == 77_777 { 5.0 } else { 0.0 };
            envelope.push(f64::from(i), (f64::from(i) * 0.1).sin() + spike);
        }
        let points: Vec<_> = envelope.points().collect();
        assert!(points.len() <= 2 * COLUMNS + 1, "{}", points.len());
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
        assert!(points.iter().any(|point| point.0 == 77_777.0));
        assert_eq!(points[points.len() - 1].0, f64::from(count - 1));
        assert!(points[0].0 < 200.0);
    }

    #[test]
    fn a_short_series_is_kept_as_it_is() {
        let mut envelope = Envelope::default();
        let values = [(0.0, 1.0), (0.1, -2.0), (0.2, 3.0)];
        for (time_s, value) in values {
            envelope.push(time_s, value);
        }
        assert_eq!(envelope.points().collect::<Vec<_>>(), values);
    }
}
