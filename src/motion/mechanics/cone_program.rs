//! Convex programs with linear constraints, solved by an interior-point method.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver as _, NonnegativeConeT, ZeroConeT,
};

/// Entries of a sparse matrix.
#[derive(Default)]
pub(crate) struct Entries {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Entries {
    pub fn put(&mut self, row: usize, column: usize, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }

    /// The matrix of this height and width.
    pub fn matrix(self, height: usize, width: usize) -> CscMatrix {
        CscMatrix::new_from_triplets(height, width, self.rows, self.columns, self.values)
    }
}

/// Minimises `x P x / 2 + q x` where `s = b - A x` is zero in its first rows, the equations, and not negative in the others.
pub(crate) fn solve(
    [quadratic, matrix]: [&CscMatrix; 2],
    linear: &[f64],
    right: &[f64],
    equations: usize,
    settings: DefaultSettings<f64>,
) -> DefaultSolution<f64> {
    let cones = [
        ZeroConeT(equations),
        NonnegativeConeT(right.len() - equations),
    ];
    let mut solver = DefaultSolver::new(quadratic, linear, matrix, right, &cones, settings)
        .expect("the dimensions fit and the settings are valid");
    solver.solve();
    solver.solution
}
