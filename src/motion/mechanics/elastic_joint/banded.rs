//! Linear equations with a banded matrix, by Gaussian elimination with partial pivoting.

/// Square matrix that is zero more than `width` from its diagonal.
pub(super) struct Banded {
    size: usize,
    width: usize,
    /// Entries by rows, each row from `width` before the diagonal to `2 width` after it; pivoting fills the additional width.
    rows: Vec<f64>,
}

impl Banded {
    pub(super) fn new(size: usize, width: usize) -> Self {
        Self {
            size,
            width,
            rows: vec![0.0; size * (3 * width + 1)],
        }
    }

    pub(super) fn clear(&mut self) {
        self.rows.fill(0.0);
    }

    fn index(&self, row: usize, column: usize) -> usize {
        row * (3 * self.width + 1) + self.width + column - row
    }

    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        let index = self.index(row, column);
        self.rows[index] += value;
    }

    /// Solves for the right-hand sides in place, and overwrites the matrix. Returns false if the matrix is singular.
    pub(super) fn solve<const K: usize>(&mut self, mut rights: [&mut [f64]; K]) -> bool {
        let (size, width) = (self.size, self.width);
        for column in 0..size {
            let below = (column + width).min(size - 1);
            let last = (column + 2 * width).min(size - 1);
            let magnitude = |row: usize| self.rows[self.index(row, column)].abs();
            let larger = |one: &usize, other: &usize| magnitude(*one).total_cmp(&magnitude(*other));
            let pivot = (column..=below).max_by(larger).unwrap_or(column);
            if pivot != column {
                for other in column..=last {
                    let (one, two) = (self.index(column, other), self.index(pivot, other));
                    self.rows.swap(one, two);
                }
                for right in &mut rights {
                    right.swap(column, pivot);
                }
            }
            let diagonal = self.rows[self.index(column, column)];
            if diagonal == 0.0 || !diagonal.is_finite() {
                return false;
            }
            for row in column + 1..=below {
                let factor = self.rows[self.index(row, column)] / diagonal;
                if factor != 0.0 {
                    for other in column..=last {
                        let above = self.rows[self.index(column, other)];
                        let index = self.index(row, other);
                        self.rows[index] -= factor * above;
                    }
                    for right in &mut rights {
                        right[row] -= factor * right[column];
                    }
                }
            }
        }
        for right in rights {
            for row in (0..size).rev() {
                let last = (row + 2 * width).min(size - 1);
                let known = (row + 1..=last)
                    .map(|column| self.rows[self.index(row, column)] * right[column]);
                right[row] = (right[row] - known.sum::<f64>()) / self.rows[self.index(row, row)];
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right-hand sides are the matrix times a known solution. Zeros on the diagonal require row exchanges.
    #[test]
    fn equations_with_a_band_are_solved() {
        let (size, width) = (30, 4);
        let entry = |row: usize, column: usize| {
            if row == column && row.is_multiple_of(3) {
                0.0
            } else {
                ((7 * row + 13 * column + row * column) % 17) as f64 - 7.5
            }
        };
        let band = |row: usize| row.saturating_sub(width)..=(row + width).min(size - 1);
        let due: Vec<f64> = (0..size).map(|i| (i as f64).sin()).collect();
        let mut matrix = Banded::new(size, width);
        let mut right = vec![0.0; size];
        for (row, right) in right.iter_mut().enumerate() {
            for column in band(row) {
                matrix.add(row, column, entry(row, column));
                *right += entry(row, column) * due[column];
            }
        }
        let mut twice: Vec<f64> = right.iter().map(|right| 2.0 * right).collect();
        assert!(matrix.solve([&mut right, &mut twice]));
        for ((found, twice), due) in right.iter().zip(twice).zip(due) {
            assert!((found - due).abs() < 1e-11, "{found} {due}");
            assert!((0.5 * twice - due).abs() < 1e-11, "{twice} {due}");
        }
        matrix.clear();
        assert!(!matrix.solve([&mut right]));
    }
}
