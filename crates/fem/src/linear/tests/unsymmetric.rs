//! LU over the levels and sparse LU.

use proptest::prelude::*;

use super::fixtures::{
    Grid, Random, brick_stiffness, dense_solution, difference, hold, pattern_of, random_cliques, random_values, strand,
};
use crate::linear::{
    GmresLimits, LinearError, LinearSolver, LinearTerm, Method, SolverOptions, SparsePattern, Storage, TangentSolver,
};

const METHODS: [Method; 2] = [Method::BlockLu, Method::SparseLu];

fn by(method: Method) -> SolverOptions {
    SolverOptions { unsymmetric: Some(method), ..SolverOptions::default() }
}

fn solve(pattern: &SparsePattern, values: &[f64], rhs: &[f64], options: &SolverOptions) -> Vec<f64> {
    let mut solver = LinearSolver::analyse(pattern, options).unwrap();
    let report = solver.factorise(values).unwrap();
    assert_eq!(report.negative_pivots, None);
    let mut solution = vec![0.0; pattern.n()];
    let report = solver.solve(values, rhs, &mut solution).unwrap();
    assert!(report.residual < 1e-14, "{report:?}");
    solution
}

/// A strand with unsymmetric couplings of a tenth of its stiffness.
fn unsymmetric_strand(nx: usize, ny: usize, nz: usize) -> (SparsePattern, Vec<f64>) {
    let (pattern, mut values) = strand(nx, ny, nz, Storage::Full);
    let mut random = Random(11);
    values.iter_mut().for_each(|value| *value *= 1.0 + 0.05 * random.signed());
    (pattern, values)
}

#[test]
fn both_methods_solve_a_slender_strand() {
    let (pattern, values) = unsymmetric_strand(4, 4, 30);
    let rhs = Random(12).vector(pattern.n());
    let block = solve(&pattern, &values, &rhs, &by(Method::BlockLu));
    let sparse = solve(&pattern, &values, &rhs, &by(Method::SparseLu));
    assert!(difference(&block, &sparse) < 1e-9);
    assert!(difference(&block, &dense_solution(&pattern, &values, &rhs)) < 1e-9);
}

#[test]
fn symmetric_values_give_the_symmetric_solution() {
    let (full, full_values) = strand(3, 4, 25, Storage::Full);
    let (lower, lower_values) = strand(3, 4, 25, Storage::Lower);
    let rhs = Random(13).vector(full.n());
    let mut solver = LinearSolver::analyse(&lower, &SolverOptions::default()).unwrap();
    solver.factorise(&lower_values).unwrap();
    let mut expected = vec![0.0; lower.n()];
    solver.solve(&lower_values, &rhs, &mut expected).unwrap();
    for method in METHODS {
        assert!(difference(&solve(&full, &full_values, &rhs, &by(method)), &expected) < 1e-8);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn random_systems(n in 1usize..60, count in 0usize..30, size in 1usize..8, seed: u64) {
        let mut random = Random(seed);
        let pattern = pattern_of(n, &random_cliques(n, count, size, &mut random), Storage::Full);
        let values = random_values(&pattern, &mut random, 1.1 * n as f64);
        let rhs = random.vector(n);
        let expected = dense_solution(&pattern, &values, &rhs);
        for method in METHODS {
            let solution = solve(&pattern, &values, &rhs, &by(method));
            prop_assert!(difference(&solution, &expected) < 1e-11);
        }
    }
}

#[test]
fn rows_are_exchanged_inside_a_level() {
    // Zero diagonal: no factorisation without exchanges.
    let pattern = pattern_of(2, &[vec![0, 1]], Storage::Full);
    for method in METHODS {
        assert_eq!(solve(&pattern, &[0.0, 2.0, 4.0, 0.0], &[8.0, 6.0], &by(method)), [3.0, 2.0]);
    }
}

#[test]
fn a_floating_body_is_singular() {
    let grid = Grid::new(3, 3, 12);
    let pattern = grid.pattern(Storage::Full);
    let values = grid.assemble(&pattern, &brick_stiffness());
    for method in METHODS {
        let mut solver = LinearSolver::analyse(&pattern, &by(method)).unwrap();
        let error = solver.factorise(&values).unwrap_err();
        assert!(matches!(error, LinearError::Singular { .. }), "{method:?}: {error}");
    }
}

#[test]
fn an_unknown_without_stiffness_is_singular() {
    let (pattern, mut values) = unsymmetric_strand(3, 3, 6);
    for other in 0..pattern.n() {
        for (row, col) in [(100, other), (other, 100)] {
            if let Some(slot) = pattern.slot(row, col) {
                values[slot] = 0.0;
            }
        }
    }
    for method in METHODS {
        let mut solver = LinearSolver::analyse(&pattern, &by(method)).unwrap();
        let error = solver.factorise(&values).unwrap_err();
        assert!(matches!(error, LinearError::Singular { .. }), "{method:?}: {error}");
    }
}

#[test]
fn trivial_systems() {
    for n in [0, 1] {
        let pattern = pattern_of(n, &[], Storage::Full);
        for method in METHODS {
            assert_eq!(solve(&pattern, &vec![-4.0; n], &vec![2.0; n], &by(method)), vec![-0.5; n]);
        }
    }
}

#[test]
fn disconnected_bodies_and_lone_unknowns() {
    let first = Grid::new(3, 3, 8);
    let shifted = first.elements.iter().map(|dofs| dofs.iter().map(|&dof| dof + first.n as u32 + 5).collect());
    let elements: Vec<Vec<u32>> = first.elements.iter().cloned().chain(shifted).collect();
    let both = Grid { n: 2 * first.n + 5, elements };
    let pattern = both.pattern(Storage::Full);
    let mut values = both.assemble(&pattern, &brick_stiffness());
    hold(&pattern, &mut values, both.n, 0.5);
    let mut random = Random(14);
    values.iter_mut().for_each(|value| *value *= 1.0 + 0.1 * random.signed());
    let rhs = random.vector(both.n);
    let expected = dense_solution(&pattern, &values, &rhs);
    for method in METHODS {
        assert!(difference(&solve(&pattern, &values, &rhs, &by(method)), &expected) < 1e-11);
    }
}

#[test]
fn memory_decides_between_the_methods() {
    let slender = Grid::new(3, 3, 40).pattern(Storage::Full);
    let method = |options: &SolverOptions| LinearSolver::analyse(&slender, options).unwrap().analysis().method;
    assert_eq!(method(&SolverOptions::default()), Method::BlockLu);
    assert_eq!(method(&SolverOptions { block_memory: 1000, ..SolverOptions::default() }), Method::SparseLu);
    assert_eq!(method(&SolverOptions { block_memory_ratio: 0.0, ..SolverOptions::default() }), Method::SparseLu);
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let (pattern, values) = unsymmetric_strand(6, 6, 24);
    let rhs = Random(15).vector(pattern.n());
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&pattern, &values, &rhs, &by(Method::BlockLu)))
    };
    let reference = run(1);
    for threads in [2, 3, 4] {
        assert_eq!(reference, run(threads));
    }
}

/// A product beside a matrix.
struct RankOne(Vec<f64>, Vec<f64>);

impl LinearTerm for RankOne {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn multiply_add(&self, x: &[f64], out: &mut [f64]) {
        let factor: f64 = self.1.iter().zip(x).map(|(c, x)| c * x).sum();
        out.iter_mut().zip(&self.0).for_each(|(o, r)| *o += factor * r);
    }
}

fn solve_tangent(pattern: &SparsePattern, values: &[f64], term: &RankOne, rhs: &[f64]) -> (Vec<f64>, usize) {
    let mut solver = TangentSolver::analyse(pattern.clone(), &SolverOptions::default()).unwrap();
    assert_eq!(solver.factorise(values).unwrap().negative_pivots, None);
    let mut solution = vec![0.0; pattern.n()];
    let iterations = solver.solve(values, term, rhs, &mut solution).unwrap();
    (solution, iterations)
}

#[test]
fn factors_serve_values_near_their_own() {
    for storage in [Storage::Lower, Storage::Full] {
        let (pattern, values) = strand(4, 4, 30, storage);
        let rhs = Random(15).vector(pattern.n());
        let mut random = Random(16);
        let mut change = |size: f64| {
            let mut values = values.clone();
            for column in 0..pattern.n() {
                let at = pattern.slot(column, column).unwrap();
                values[at] *= 1.0 + size * random.signed();
            }
            values
        };
        let mut solver = TangentSolver::analyse(pattern.clone(), &SolverOptions::default()).unwrap();
        solver.factorise(&values).unwrap();
        let none = RankOne(Vec::new(), Vec::new());
        let limits = GmresLimits { target: 1e-6, limit: 1e-6, most: 12, trusted: 3 };
        let (mut solution, mut back) = (vec![0.0; pattern.n()], vec![0.0; pattern.n()]);
        let near = change(1e-5);
        let iterations = solver.solve_by_kept_factors(&near, &none, &limits, &rhs, &mut solution).unwrap();
        pattern.multiply(&near, &solution, &mut back).unwrap();
        assert!(difference(&back, &rhs) < 1e-5 && iterations <= 6, "{iterations} {}", difference(&back, &rhs));
        // Far away it is told early.
        let far = change(3.0);
        let outcome = solver.solve_by_kept_factors(&far, &none, &limits, &rhs, &mut solution);
        assert!(matches!(outcome, Err(LinearError::Stalled { iterations: 3..=12, .. })), "{outcome:?}");
    }
}

#[test]
fn the_symmetric_part_preconditions() {
    let (pattern, values) = unsymmetric_strand(4, 4, 30);
    let rhs = Random(12).vector(pattern.n());
    let none = RankOne(Vec::new(), Vec::new());
    let (solution, iterations) = solve_tangent(&pattern, &values, &none, &rhs);
    let expected = solve(&pattern, &values, &rhs, &by(Method::BlockLu));
    assert!(difference(&solution, &expected) < 1e-4, "{}", difference(&solution, &expected));
    let mut back = vec![0.0; pattern.n()];
    pattern.multiply(&values, &solution, &mut back).unwrap();
    assert!(difference(&back, &rhs) < 1e-6);
    assert!((1..40).contains(&iterations), "{iterations}");
    let term = RankOne(Random(21).vector(pattern.n()), Random(22).vector(pattern.n()));
    let (solution, more) = solve_tangent(&pattern, &values, &term, &rhs);
    pattern.multiply(&values, &solution, &mut back).unwrap();
    term.multiply_add(&solution, &mut back);
    assert!(difference(&back, &rhs) < 1e-6);
    assert!(more <= iterations + 4, "{more} after {iterations}");
}

#[test]
fn where_the_symmetric_part_is_no_guide_the_lu_takes_over() {
    // The symmetric part is the identity, the rest turns and stretches a thousand times as much.
    let n = 200;
    let pattern = pattern_of(n, &[(0..n as u32).collect()], Storage::Full);
    let mut random = Random(3);
    let mut values = vec![0.0; pattern.nnz()];
    for column in 0..n {
        for row in column..n {
            let skew = 1000.0 * random.signed();
            let entry = if row == column { 1.0 } else { skew };
            values[pattern.slot(row, column).unwrap()] = entry;
            values[pattern.slot(column, row).unwrap()] = if row == column { 1.0 } else { -skew };
        }
    }
    let rhs = random.vector(n);
    let (solution, iterations) = solve_tangent(&pattern, &values, &RankOne(Vec::new(), Vec::new()), &rhs);
    assert!(difference(&solution, &dense_solution(&pattern, &values, &rhs)) < 1e-9);
    assert!(iterations > 80, "{iterations}");
}
