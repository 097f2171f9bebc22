//! Thinning of long series for pictures.

/// Largest number of columns to which a curve is thinned: about two per pixel.
pub const COLUMNS: usize = 1600;

/// A long series in at most a given number of columns. All columns hold the same number of values; when there are too many columns, pairs of
/// columns are joined.
#[derive(Clone, Debug)]
pub struct Thinned<T> {
    most: usize,
    group: usize,
    /// Number of values in the last column.
    in_last: usize,
    /// The columns.
    pub columns: Vec<T>,
}

impl<T> Thinned<T> {
    /// Makes an empty series of at most this many columns.
    pub const fn new(most: usize) -> Self {
        Self {
            most,
            group: 1,
            in_last: 0,
            columns: Vec::new(),
        }
    }

    /// Returns the column of the next value; `None` if that value begins a new column. `join` adds a column to the previous one.
    pub fn next(&mut self, join: impl Fn(&mut T, T)) -> Option<&mut T> {
        if self.in_last == self.group && self.columns.len() == self.most {
            let mut all = std::mem::take(&mut self.columns).into_iter();
            while let Some(mut column) = all.next() {
                self.in_last = self.group;
                if let Some(after) = all.next() {
                    join(&mut column, after);
                    self.in_last += self.group;
                }
                self.columns.push(column);
            }
            self.group *= 2;
        }
        let is_full = self.columns.is_empty() || self.in_last == self.group;
        self.in_last = if is_full { 1 } else { self.in_last + 1 };
        self.columns.last_mut().filter(|_| !is_full)
    }
}

/// A long series of values, thinned to the smallest and the largest value of each column.
#[derive(Clone, Debug)]
pub struct Envelope {
    /// Time and value of the minimum and of the maximum of each column.
    thinned: Thinned<[(f64, f64); 2]>,
    last: Option<(f64, f64)>,
}

impl Default for Envelope {
    fn default() -> Self {
        Self::of_columns(COLUMNS)
    }
}

impl Envelope {
    /// Makes an envelope of at most this many columns.
    pub const fn of_columns(most: usize) -> Self {
        Self {
            thinned: Thinned::new(most),
            last: None,
        }
    }

    /// Adds a value.
    pub fn push(&mut self, time_s: f64, value: f64) {
        let point = (time_s, value);
        self.last = Some(point);
        match self.thinned.next(join) {
            Some(column) => join(column, [point; 2]),
            None => self.thinned.columns.push([point; 2]),
        }
    }

    /// Returns the points to draw, in order of time.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        let extremes = self.thinned.columns.iter().flat_map(|extremes| {
            let mut in_order = *extremes;
            in_order.sort_by(|a, b| a.0.total_cmp(&b.0));
            in_order
        });
        for point in extremes.chain(self.last) {
            if points.last().is_none_or(|last| last.0 < point.0) {
                points.push(point);
            }
        }
        points.into_iter()
    }
}

fn join([low, high]: &mut [(f64, f64); 2], after: [(f64, f64); 2]) {
    if after[0].1 < low.1 {
        *low = after[0];
    }
    if after[1].1 > high.1 {
        *high = after[1];
    }
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
