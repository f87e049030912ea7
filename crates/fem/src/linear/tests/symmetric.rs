//! LDLᵀ: residuals, inertia, orders, singular matrices, threads.

use proptest::prelude::*;

use super::fixtures::{
    Grid, Random, brick_stiffness, dense, dense_solution, difference, hold, pattern_of, random_cliques, random_values,
    strand,
};
use crate::linear::{LinearError, LinearSolver, Operand, Ordering, SolverOptions, SparsePattern, Storage};

const ORDERINGS: [Ordering; 7] = [
    Ordering::Natural,
    Ordering::Layers,
    Ordering::TwistedLayers,
    Ordering::Wavefront,
    Ordering::TwistedWavefront,
    Ordering::NestedDissection,
    Ordering::CrossSections,
];

fn with_order(ordering: Option<Ordering>) -> SolverOptions {
    SolverOptions { ordering, branch_flops: 0.0, ..SolverOptions::default() }
}

fn solve(pattern: &SparsePattern, values: &[f64], rhs: &[f64], options: &SolverOptions) -> Vec<f64> {
    let mut solver = LinearSolver::analyse(pattern, options).unwrap();
    solver.factorise(values).unwrap();
    let mut solution = vec![0.0; pattern.n()];
    let report = solver.solve(values, rhs, &mut solution).unwrap();
    assert!(report.residual < 1e-14, "{report:?}");
    solution
}

#[test]
fn every_order_solves_a_slender_strand() {
    let (pattern, values) = strand(4, 4, 40, Storage::Lower);
    let expected = Random(1).vector(pattern.n());
    let mut rhs = vec![0.0; pattern.n()];
    pattern.multiply(&values, &expected, &mut rhs).unwrap();
    for ordering in ORDERINGS.map(Some).into_iter().chain([None]) {
        let solution = solve(&pattern, &values, &rhs, &with_order(ordering));
        let error = difference(&solution, &expected);
        assert!(error < 1e-8, "{ordering:?}: {error:e}");
    }
}

#[test]
fn renumbering_does_not_change_the_solution() {
    let grid = Grid::new(4, 3, 30);
    let pattern = grid.pattern(Storage::Lower);
    let mut values = grid.assemble(&pattern, &brick_stiffness());
    hold(&pattern, &mut values, 36, 1.0);
    let mut random = Random(2);
    let rhs = random.vector(grid.n);
    let reference = solve(&pattern, &values, &rhs, &SolverOptions::default());
    let new = random.permutation(grid.n);
    let renumbered = grid.renumbered(&new);
    let other = renumbered.pattern(Storage::Lower);
    let mut other_values = renumbered.assemble(&other, &brick_stiffness());
    for &dof in &new[..36] {
        let dof = dof as usize;
        other_values[other.slot(dof, dof).unwrap()] += 1.0;
    }
    let mut other_rhs = vec![0.0; grid.n];
    (0..grid.n).for_each(|dof| other_rhs[new[dof] as usize] = rhs[dof]);
    let solution = solve(&other, &other_values, &other_rhs, &SolverOptions::default());
    let back: Vec<f64> = new.iter().map(|&dof| solution[dof as usize]).collect();
    assert!(difference(&back, &reference) < 1e-9);
}

#[test]
fn negative_pivots_count_negative_eigenvalues_of_a_shifted_strand() {
    let (pattern, stiffness) = strand(3, 3, 6, Storage::Lower);
    let eigenvalues = dense(&pattern, &stiffness).symmetric_eigenvalues();
    for shift in [0.01, 0.1, 0.3, 0.7, 1.1] {
        let mut values = stiffness.clone();
        hold(&pattern, &mut values, pattern.n(), -shift);
        let negative = eigenvalues.iter().filter(|&&value| value < shift).count();
        assert!(negative > 0 && negative < pattern.n());
        let mut solver = LinearSolver::analyse(&pattern, &with_order(None)).unwrap();
        let report = solver.factorise(&values).unwrap();
        assert_eq!(report.negative_pivots, Some(negative), "shift {shift}");
        let rhs = Random(3).vector(pattern.n());
        let mut solution = vec![0.0; pattern.n()];
        let report = solver.solve(&values, &rhs, &mut solution).unwrap();
        assert!(report.digits() > 13.0, "{report:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn random_indefinite_systems(n in 1usize..60, count in 0usize..30, size in 1usize..8, seed: u64) {
        let mut random = Random(seed);
        let pattern = pattern_of(n, &random_cliques(n, count, size, &mut random), Storage::Lower);
        let mut values = random_values(&pattern, &mut random, 0.0);
        for dof in 0..n {
            // Diagonally dominant with either sign: indefinite, yet far from a vanishing pivot.
            let sign = if random.signed() < 0.0 { -1.0 } else { 1.0 };
            values[pattern.slot(dof, dof).unwrap()] = 1.1 * sign * n as f64;
        }
        let matrix = dense(&pattern, &values);
        let rhs = random.vector(n);
        let expected = dense_solution(&pattern, &values, &rhs);
        for ordering in ORDERINGS.map(Some).into_iter().chain([None]) {
            let mut solver = LinearSolver::analyse(&pattern, &with_order(ordering)).unwrap();
            let report = solver.factorise(&values).unwrap();
            let negative = matrix.clone().symmetric_eigenvalues().iter().filter(|&&value| value < 0.0).count();
            prop_assert_eq!(report.negative_pivots, Some(negative));
            let mut solution = vec![0.0; n];
            let report = solver.solve(&values, &rhs, &mut solution).unwrap();
            prop_assert!(report.residual < 1e-14);
            prop_assert!(difference(&solution, &expected) < 1e-11);
        }
    }
}

#[test]
fn poorly_pivoted_systems_are_refined() {
    // A tiny leading pivot loses ten digits in the factors, which refinement recovers.
    let cliques = [vec![0, 1, 2], vec![1, 2, 3]];
    let pattern = pattern_of(4, &cliques, Storage::Lower);
    let mut values = random_values(&pattern, &mut Random(5), 3.0);
    values[pattern.slot(0, 0).unwrap()] = 1e-10;
    let rhs = [1.0, -2.0, 3.0, 0.5];
    let options = with_order(Some(Ordering::Natural));
    let mut solver = LinearSolver::analyse(&pattern, &options).unwrap();
    let factor = solver.factorise(&values).unwrap();
    assert!(factor.smallest_pivot.unwrap() < 1e-9 && factor.smallest_pivot_dof == Some(0));
    let mut solution = vec![0.0; 4];
    let report = solver.solve(&values, &rhs, &mut solution).unwrap();
    assert!(report.first_residual > 1e-13 && report.residual < 1e-15 && report.refinements > 0, "{report:?}");
    assert!(difference(&solution, &dense_solution(&pattern, &values, &rhs)) < 1e-13);
}

#[test]
fn a_floating_body_is_singular() {
    let grid = Grid::new(3, 3, 12);
    let pattern = grid.pattern(Storage::Lower);
    let values = grid.assemble(&pattern, &brick_stiffness());
    for ordering in ORDERINGS {
        let mut solver = LinearSolver::analyse(&pattern, &with_order(Some(ordering))).unwrap();
        let error = solver.factorise(&values).unwrap_err();
        assert!(matches!(error, LinearError::Singular { .. }) && error.is_recoverable(), "{ordering:?}: {error}");
        assert_eq!(solver.solve(&values, &vec![0.0; grid.n], &mut vec![0.0; grid.n]), Err(LinearError::NotFactorised));
    }
}

#[test]
fn an_unknown_without_stiffness_is_named() {
    let (pattern, mut values) = strand(3, 3, 6, Storage::Lower);
    for other in 0..pattern.n() {
        if let Some(slot) = pattern.slot(100.max(other), 100.min(other)) {
            values[slot] = 0.0;
        }
    }
    let mut solver = LinearSolver::analyse(&pattern, &SolverOptions::default()).unwrap();
    assert!(matches!(solver.factorise(&values), Err(LinearError::Singular { dof: 100, .. })));
}

#[test]
fn trivial_systems() {
    for n in [0, 1] {
        let pattern = pattern_of(n, &[], Storage::Lower);
        for ordering in ORDERINGS.map(Some).into_iter().chain([None]) {
            let solution = solve(&pattern, &vec![-4.0; n], &vec![2.0; n], &with_order(ordering));
            assert_eq!(solution, vec![-0.5; n]);
        }
    }
}

#[test]
fn disconnected_bodies_and_lone_unknowns() {
    let first = Grid::new(3, 3, 8);
    let shifted = first.elements.iter().map(|dofs| dofs.iter().map(|&dof| dof + first.n as u32 + 5).collect());
    let elements: Vec<Vec<u32>> = first.elements.iter().cloned().chain(shifted).collect();
    let both = Grid { n: 2 * first.n + 5, elements };
    let pattern = both.pattern(Storage::Lower);
    let mut values = both.assemble(&pattern, &brick_stiffness());
    hold(&pattern, &mut values, both.n, 0.5);
    let rhs = Random(6).vector(both.n);
    let expected = dense_solution(&pattern, &values, &rhs);
    for ordering in ORDERINGS.map(Some).into_iter().chain([None]) {
        let solution = solve(&pattern, &values, &rhs, &with_order(ordering));
        assert!(difference(&solution, &expected) < 1e-12);
    }
}

#[test]
fn factorising_again_gives_the_same_bits() {
    let (pattern, values) = strand(4, 4, 20, Storage::Lower);
    let rhs = Random(8).vector(pattern.n());
    let mut solver = LinearSolver::analyse(&pattern, &with_order(None)).unwrap();
    let mut solutions = Vec::new();
    for factor in [1.0, 3.0, 1.0] {
        let scaled: Vec<f64> = values.iter().map(|value| factor * value).collect();
        solver.factorise(&scaled).unwrap();
        let mut solution = vec![0.0; pattern.n()];
        solver.solve(&scaled, &rhs, &mut solution).unwrap();
        solutions.push(solution);
    }
    assert_eq!(solutions[0], solutions[2]);
    assert_ne!(solutions[0], solutions[1]);
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let (pattern, values) = strand(11, 11, 11, Storage::Lower);
    let rhs = Random(9).vector(pattern.n());
    for ordering in ORDERINGS {
        let run = |threads: usize, branch_flops: f64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                solve(&pattern, &values, &rhs, &SolverOptions { branch_flops, ..with_order(Some(ordering)) })
            })
        };
        let reference = run(1, 0.0);
        for threads in [2, 3, 4] {
            assert_eq!(reference, run(threads, 0.0), "{ordering:?} on {threads} threads");
        }
    }
}

#[test]
fn wrong_input_is_told() {
    let (pattern, mut values) = strand(2, 2, 3, Storage::Lower);
    let n = pattern.n();
    let mut solver = LinearSolver::analyse(&pattern, &SolverOptions::default()).unwrap();
    let length = solver.factorise(&values[1..]).unwrap_err();
    let nnz = pattern.nnz();
    assert_eq!(length, LinearError::Length { what: Operand::Values, expected: nnz, actual: nnz - 1 });
    solver.factorise(&values).unwrap();
    assert!(matches!(solver.solve(&values, &vec![0.0; n - 1], &mut vec![0.0; n]), Err(LinearError::Length { .. })));
    assert!(matches!(solver.solve(&values, &vec![0.0; n], &mut vec![0.0; n + 1]), Err(LinearError::Length { .. })));
    let mut rhs = vec![1.0; n];
    rhs[7] = f64::INFINITY;
    let error = solver.solve(&values, &rhs, &mut vec![0.0; n]).unwrap_err();
    assert!(matches!(error, LinearError::NonFiniteInput { what: Operand::RightHandSide, index: 7, .. }));
    values[3] = f64::NAN;
    let error = solver.factorise(&values).unwrap_err();
    assert!(matches!(error, LinearError::NonFiniteInput { what: Operand::Values, index: 3, .. }));
}

#[test]
fn overflow_is_told() {
    let pattern = pattern_of(2, &[vec![0, 1]], Storage::Lower);
    let mut solver = LinearSolver::analyse(&pattern, &SolverOptions::default()).unwrap();
    solver.factorise(&[1e-300, 0.0, 1e-300]).unwrap();
    let error = solver.solve(&[1e-300, 0.0, 1e-300], &[1e300, 1.0], &mut [0.0; 2]).unwrap_err();
    assert!(matches!(error, LinearError::NonFinite { what: Operand::Solution, .. }), "{error}");
}

#[test]
fn a_residual_above_the_limit_is_an_error() {
    let (pattern, values) = strand(3, 3, 10, Storage::Lower);
    let options = SolverOptions { residual_limit: 0.0, most_refinements: 0, ..SolverOptions::default() };
    let mut solver = LinearSolver::analyse(&pattern, &options).unwrap();
    solver.factorise(&values).unwrap();
    let error = solver.solve(&values, &Random(4).vector(pattern.n()), &mut vec![0.0; pattern.n()]).unwrap_err();
    assert!(matches!(error, LinearError::ResidualTooLarge { refinements: 0, .. }));
}

#[test]
fn the_analysis_reports_all_orders() {
    let (pattern, _) = strand(4, 4, 30, Storage::Lower);
    let solver = LinearSolver::analyse(&pattern, &SolverOptions::default()).unwrap();
    let report = solver.analysis();
    assert_eq!((report.unknowns, report.vertices), (1440, 480));
    // A wavefront from both ends is tried where that from one end is the best so far.
    for ordering in ORDERINGS.into_iter().filter(|&ordering| ordering != Ordering::TwistedWavefront) {
        assert!(report.candidates.iter().any(|candidate| candidate.ordering == ordering), "{ordering:?}");
    }
    assert!(report.fill.nonzeros * 8.0 < report.bytes as f64);
}
