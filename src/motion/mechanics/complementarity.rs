//! Linear complementarity: `w = M z + q`, `w, z >= 0`, `w . z = 0`, by Lemke's method.
//!
//! C. E. Lemke, "Bimatrix equilibrium points and mathematical programming", Management Science 11, 1965. The method terminates for
//! the matrices of friction, which are copositive (Stewart and Trinkle, "An implicit time-stepping scheme for rigid body dynamics
//! with inelastic collisions and Coulomb friction", Int. J. Numer. Methods Eng. 39, 1996), but its work grows with the cube of the
//! size.

use nalgebra::DMatrix;

/// Maximum number of pivots per unknown.
const PIVOTS: usize = 20;
/// Least pivot, in a matrix with unit diagonal.
const LEAST_PIVOT: f64 = 1e-11;
/// Value of the artificial variable, over the largest constant, that counts as zero.
const ROUNDING: f64 = 1e-12;

/// Solves for `z`. `matrix` should be scaled to a unit diagonal where the diagonal is not zero.
///
/// `None` if the method ends on a ray or needs too many pivots.
pub fn solve(matrix: &DMatrix<f64>, constant: &[f64]) -> Option<Vec<f64>> {
    let n = constant.len();
    if constant.iter().all(|q| *q >= 0.0) {
        return Some(vec![0.0; n]);
    }
    // Columns: w, z, the artificial variable, the right side. Each row belongs to the variable in `basis`.
    let (artificial, right) = (2 * n, 2 * n + 1);
    let mut table = DMatrix::zeros(n, 2 * n + 2);
    for row in 0..n {
        table[(row, row)] = 1.0;
        for column in 0..n {
            table[(row, n + column)] = -matrix[(row, column)];
        }
        table[(row, artificial)] = -cover(row);
        table[(row, right)] = constant[row];
    }
    let mut basis: Vec<usize> = (0..n).collect();
    let by_constant =
        |a: &usize, b: &usize| (constant[*a] / cover(*a)).total_cmp(&(constant[*b] / cover(*b)));
    let mut row = (0..n).min_by(by_constant)?;
    let mut entering = artificial;
    for _ in 0..PIVOTS * n {
        pivot(&mut table, row, entering);
        let left = std::mem::replace(&mut basis[row], entering);
        if left == artificial {
            return Some(values(&table, &basis));
        }
        // The complement of the leaving variable enters.
        entering = if left < n { left + n } else { left - n };
        let mut least: Option<(f64, usize)> = None;
        for candidate in 0..n {
            let slope = table[(candidate, entering)];
            if slope > LEAST_PIVOT {
                let ratio = table[(candidate, right)].max(0.0) / slope;
                // Among equal ratios, prefer the artificial variable to leave, otherwise the row with the larger pivot.
                let better = least.is_none_or(|(ratio_least, row_least)| {
                    let same = (ratio - ratio_least).abs() <= 1e-12 * ratio_least.abs();
                    if same {
                        basis[candidate] == artificial
                            || (basis[row_least] != artificial
                                && slope > table[(row_least, entering)])
                    } else {
                        ratio < ratio_least
                    }
                });
                if better {
                    least = Some((ratio, candidate));
                }
            }
        }
        let Some((_, leaving)) = least else {
            // The method ends on a ray, unless the artificial variable is zero within rounding error.
            let rest = basis.iter().position(|variable| *variable == artificial)?;
            let most = constant.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
            return (table[(rest, right)] <= ROUNDING * most).then(|| values(&table, &basis));
        };
        row = leaving;
    }
    None
}

/// Coefficient of the artificial variable in a row; it differs between rows, so that equal ratios are rare.
fn cover(row: usize) -> f64 {
    let golden = row as f64 * 0.618_033_988_749_894_9;
    1.0 + 0.5 * golden.fract()
}

/// Values of the unknowns in a basis.
fn values(table: &DMatrix<f64>, basis: &[usize]) -> Vec<f64> {
    let n = basis.len();
    let mut z = vec![0.0; n];
    for (row, variable) in basis.iter().enumerate() {
        if let Some(index) = variable.checked_sub(n).filter(|index| *index < n) {
            z[index] = table[(row, 2 * n + 1)].max(0.0);
        }
    }
    z
}

fn pivot(table: &mut DMatrix<f64>, row: usize, column: usize) {
    let scale = 1.0 / table[(row, column)];
    for entry in table.row_mut(row).iter_mut() {
        *entry *= scale;
    }
    let factors = table.column(column).clone_owned();
    for mut entries in table.column_iter_mut() {
        let pivot = entries[row];
        if pivot != 0.0 {
            for (other, factor) in factors.iter().enumerate() {
                if other != row {
                    entries[other] -= factor * pivot;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The optimality conditions of small problems with known solutions.
    #[test]
    fn known_solutions() {
        let matrix = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let z = solve(&matrix, &[-5.0, -6.0]).unwrap();
        assert!((z[0] - 4.0 / 3.0).abs() < 1e-14 && (z[1] - 7.0 / 3.0).abs() < 1e-14);
        let z = solve(&matrix, &[-1.0, 3.0]).unwrap();
        assert!((z[0] - 0.5).abs() < 1e-14 && z[1] == 0.0);
        assert_eq!(solve(&matrix, &[1.0, 0.0]), Some(vec![0.0, 0.0]));
        // No `z` makes a row of zeros and -1 positive.
        assert_eq!(solve(&DMatrix::zeros(1, 1), &[-1.0]), None);
    }

    #[test]
    fn random_definite_problems() {
        let mut state = 7_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            f64::from(u32::try_from(state >> 33).unwrap()) / f64::from(1_u32 << 31) - 0.5
        };
        for n in 1..25 {
            let root = DMatrix::from_fn(n, n, |_, _| next());
            let matrix = &root * root.transpose() + DMatrix::identity(n, n) * 0.1;
            let constant: Vec<f64> = (0..n).map(|_| next()).collect();
            let z = solve(&matrix, &constant).unwrap();
            for row in 0..n {
                let w = constant[row] + (0..n).map(|c| matrix[(row, c)] * z[c]).sum::<f64>();
                assert!(z[row] >= 0.0 && w > -1e-10 && (w * z[row]).abs() < 1e-10);
            }
        }
    }
}
