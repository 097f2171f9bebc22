//! Convex programs with linear constraints, solved by an interior-point method.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver as _, NonnegativeConeT, ZeroConeT,
};

/// Sparse matrix with given height, width and entries (row, column, value).
pub(crate) fn matrix(
    height: usize,
    width: usize,
    entries: impl IntoIterator<Item = (usize, usize, f64)>,
) -> CscMatrix {
    let (rows, columns, values) = entries.into_iter().collect();
    CscMatrix::new_from_triplets(height, width, rows, columns, values)
}

/// Minimises `x P x / 2 + q x` subject to `s = b - A x`. The first components of `s`, `equations` in number, are zero; the others are not negative.
pub(crate) fn solve(
    [quadratic, matrix]: [&CscMatrix; 2],
    linear: &[f64],
    right: &[f64],
    equations: usize,
    mut settings: DefaultSettings<f64>,
) -> DefaultSolution<f64> {
    settings.verbose = false;
    let others = right.len() - equations;
    let cones = [ZeroConeT(equations), NonnegativeConeT(others)];
    let mut solver = DefaultSolver::new(quadratic, linear, matrix, right, &cones, settings)
        .expect("the dimensions fit and the settings are valid");
    solver.solve();
    solver.solution
}
