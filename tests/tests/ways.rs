//! Minima of the incremental potential where Newton's method finds no way, on bars and columns whose answers are known in
//! closed form, and on bent strands.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::{Matrix3, Vector3};
use subrope_fem::analysis::{IncrementRecord, Increments, Model, NewtonOptions, PathControl, TrustRegion};
use subrope_fem::kinematics::Kinematics;
use subrope_fem::{Energies, FemError};
use subrope_geometry::CellKind;
use subrope_material::{EngineeringConstants, StVenantKirchhoff};
use subrope_tests::truss::{
    APEX_DOWN, Axial, HEIGHT, Springs, TOP, Truss, apex_force, column, limit_force, push, von_mises,
};
use subrope_tests::{Brick, Lattice, Problem, Row, brick, constant_frames, rigid, run_scene};

fn options(trust_region: TrustRegion) -> NewtonOptions {
    NewtonOptions { force_tolerance: 1e-11, trust_region, ..NewtonOptions::default() }
}

/// Over the last corrections each residual is at most a constant times the square of the one before, down to rounding.
fn ends_quadratically(record: &IncrementRecord) -> bool {
    let last = &record.residuals[record.residuals.len().saturating_sub(3)..];
    last.windows(2).all(|w| w[1] < 30.0 * w[0] * w[0] + 1e-13)
}

#[test]
fn a_minimum_is_found_beyond_a_limit_point() -> Result<(), FemError> {
    let mut truss = von_mises(options(TrustRegion::Always))?;
    let step = push(truss.step(Increments::Fixed(10)), APEX_DOWN, -2.1 * limit_force());
    let records = truss.run(&step)?;
    for state in &records {
        let record = &state.record;
        println!("{} {:?} {:?} {:e}", record.fraction, record.negative_pivots, record.residuals, record.released);
        assert!(record.minimised && record.negative_pivots == Some(0));
        assert!(ends_quadratically(record));
    }
    let w = -truss.analysis.coordinates()[APEX_DOWN as usize];
    assert!(w > 2.0 * HEIGHT);
    assert!((apex_force(w) / (2.1 * limit_force()) - 1.0).abs() < 1e-9);
    let totals = truss.analysis.totals();
    assert_eq!((totals.jumps, totals.minimised, totals.cutbacks), (1, 10, 0));
    // The apex falls through between .84 and 1.05 times the largest force.
    assert_eq!(records.iter().position(|r| r.record.released != 0.0), Some(4));
    assert!(totals.released > 0.0);
    Ok(())
}

#[test]
fn a_bifurcation_is_left_for_the_stable_branch() -> Result<(), FemError> {
    let run = |way| -> Result<_, FemError> {
        let mut truss = column(options(way))?;
        let step = truss.step(Increments::Fixed(8)).prescribe(TOP, -0.2);
        let records = truss.run(&step)?;
        Ok((truss.analysis.coordinates()[3], records.last().and_then(|r| r.record.negative_pivots), truss))
    };
    let (straight, pivots, newton) = run(TrustRegion::Off)?;
    assert_eq!((straight, pivots), (0.0, Some(1)), "Newton's method stays on the symmetric branch");
    let (bent, pivots, minimum) = run(TrustRegion::Always)?;
    assert_eq!(pivots, Some(0));
    // Bars that hardly shorten: x^2 + .9^2 = 1 - what the springs press them by.
    assert!((bent.abs() - 0.19_f64.sqrt()).abs() < 0.01, "{bent}");
    let stored = |truss: &Truss| truss.analysis.totals().stored;
    assert!(stored(&minimum) < 0.2 * stored(&newton), "{} {}", stored(&minimum), stored(&newton));
    Ok(())
}

#[test]
fn newtons_way_is_not_left_where_it_leads_on() -> Result<(), FemError> {
    let run = |way| -> Result<_, FemError> {
        let mut truss = column(options(way))?;
        let step = truss.step(Increments::Fixed(8)).prescribe(TOP, -0.2);
        let records = truss.run(&step)?;
        assert!(records.iter().all(|r| !r.record.minimised));
        Ok(truss.analysis.coordinates().iter().map(|q| q.to_bits()).collect::<Vec<_>>())
    };
    assert_eq!(run(TrustRegion::Auto)?, run(TrustRegion::Off)?);
    Ok(())
}

/// Newton's method with too few iterations to fall through is helped, once its increments are as short as they may be.
#[test]
fn a_stalled_run_goes_on_by_a_minimisation() -> Result<(), FemError> {
    let mut truss = von_mises(NewtonOptions { max_iterations: 5, ..options(TrustRegion::Auto) })?;
    let increments = Increments::Automatic {
        control: PathControl::Load,
        initial: 0.1,
        minimum: 1e-3,
        maximum: 0.1,
        max_count: 1000,
    };
    let step = push(truss.step(increments), APEX_DOWN, -2.1 * limit_force());
    let records = truss.run(&step)?;
    let totals = truss.analysis.totals();
    println!("{totals:?}");
    assert!(totals.cutbacks > 0 && (1..5).contains(&totals.minimised) && totals.jumps == 1);
    let jump = records.iter().position(|r| r.record.minimised && r.record.released > 0.0);
    assert!(jump.is_some());
    let w = -truss.analysis.coordinates()[APEX_DOWN as usize];
    assert!((apex_force(w) / (2.1 * limit_force()) - 1.0).abs() < 1e-9);
    Ok(())
}

/// A bar of force `atan(u + 3) - atan 3`, and a spring beside it as long as it is softened. Another without force holds the
/// body against turning about it.
struct Flat {
    spring: f64,
}

impl Springs for Flat {
    fn answer(&mut self, spring: usize, u: f64) -> (f64, f64, Energies) {
        if spring > 0 {
            return (0.0, 0.0, Energies::default());
        }
        let force = (u + 3.0).atan() - 3.0_f64.atan() + self.spring * u;
        (force, 1.0 / (1.0 + (u + 3.0) * (u + 3.0)) + self.spring, Energies::default())
    }

    fn soften(&mut self, part: f64) -> bool {
        self.spring = part;
        true
    }
}

/// Newton's method without a line search overshoots farther and farther; by way of a softened bar it ends where the bar as it is
/// carries the load.
#[test]
fn softening_leads_the_way_and_vanishes() -> Result<(), FemError> {
    let points = vec![Vector3::zeros(), Vector3::new(0.0, 0.0, 10.0), Vector3::x()];
    for smoothing in [false, true] {
        let flat = Axial { nodes: vec![[0, 1], [0, 2]], springs: Flat { spring: 0.0 } };
        let model =
            Model { kinematics: Kinematics::new(points.clone(), Vec::new())?, contributions: vec![Box::new(flat)] };
        let options = NewtonOptions { smoothing, line_search: false, ..options(TrustRegion::Off) };
        let mut bar = Truss::of(model, &[5], options);
        let step = push(bar.step(Increments::Fixed(1)), 5, -3.0_f64.atan());
        let (states, outcome) = bar.run_while_possible(&step);
        assert_eq!(outcome.is_ok(), smoothing, "{outcome:?}");
        for state in states {
            assert!(state.record.smoothed && (state.q[5] + 3.0).abs() < 1e-9, "{}", state.q[5]);
        }
        assert_eq!(bar.analysis.totals().smoothed, usize::from(smoothing));
    }
    Ok(())
}

/// Length and thickness of a column of 27-node bricks that is clamped at both ends.
const LENGTH: f64 = 40.0;
const THICKNESS: f64 = 2.0;
const YOUNG: f64 = 100.0;

fn clamped_column(trust_region: TrustRegion) -> Result<(Problem, Vec<Row>), FemError> {
    let lattice = Lattice::new([1, 1, 10], CellKind::Hex27);
    let mesh = lattice.mesh(|[x, y, z]| [3.0 * x, THICKNESS * y, LENGTH * z]);
    let [e1, e2, e3] = [YOUNG; 3];
    let [g12, g13, g23] = [0.5 * YOUNG; 3];
    let constants = EngineeringConstants { e1, e2, e3, nu12: 0.0, nu13: 0.0, nu23: 0.0, g12, g13, g23 };
    let law = StVenantKirchhoff::orthotropic(&constants).unwrap();
    let solid = brick(Brick::Quadratic, &mesh, &constant_frames(&mesh, Matrix3::identity()), law)?;
    let ends = [("foot", 0.0, false), ("head", LENGTH, true)];
    let section =
        |(name, z, far): (&str, f64, bool)| rigid(name, Vector3::new(1.5, 0.5 * THICKNESS, z), &lattice.face(2, far));
    let options = NewtonOptions { force_tolerance: 1e-9, trust_region, ..NewtonOptions::default() };
    let mut problem = Problem::with(&mesh, solid, ends.map(section).to_vec(), options)?;
    let step = problem.step(Increments::Fixed(8)).hold(0, &[]).hold(1, &[]).point(1, 2, -0.02 * LENGTH).build();
    let rows = problem.run(&step)?;
    Ok((problem, rows))
}

/// Euler's column of bricks: straight up to its load, bent beyond it.
#[test]
#[ignore = "its load is 0.997 of Euler's; the rest of its path is to be checked"]
fn a_clamped_column_buckles_at_eulers_load() -> Result<(), FemError> {
    let (problem, rows) = clamped_column(TrustRegion::Always)?;
    let area = 3.0 * THICKNESS;
    let slender = THICKNESS * THICKNESS / 12.0 * (2.0 * std::f64::consts::PI / LENGTH).powi(2);
    // With the shear between sections, of which 5/6 count.
    let critical = YOUNG * area * slender / (1.0 + 1.2 * YOUNG * slender / (0.5 * YOUNG));
    for row in &rows {
        let force = -row.reaction[1][0].z / critical;
        println!("{:.4} {force:.4} {:?} {:.3e}", row.record.fraction, row.record.residuals, row.record.released);
        assert_eq!(row.record.negative_pivots, Some(0));
        assert!(ends_quadratically(&row.record));
        if row.record.fraction * 0.02 > 1.1 * slender {
            assert!((force - 1.0).abs() < 0.02, "{force}");
        }
    }
    let sideways = problem.analysis.displacement().chunks_exact(3).map(|u| u[1].abs()).fold(0.0, f64::max);
    // A cosine that takes up the length that the column is too long.
    let amplitude = (4.0 * (0.02 - slender)).sqrt() * LENGTH / std::f64::consts::PI;
    assert!((sideways / amplitude - 1.0).abs() < 0.05, "{sideways} {amplitude}");
    let (_, straight) = clamped_column(TrustRegion::Off)?;
    let last = straight.last().unwrap();
    assert!(last.record.negative_pivots > Some(0) && -last.reaction[1][0].z > 2.0 * critical);
    Ok(())
}

const SOFTER: [(&str, f64); 4] = [("K_e", 1000.0), ("K_t", 15.0), ("K_l", 15.0), ("tau_l", 1.5)];

/// The shipped bent strand with other parameters of its law.
fn bent_strand(parameters: &[(&str, f64)]) -> String {
    let mut text = include_str!("../../scenes/bent_strand.toml").to_owned();
    for (key, value) in parameters {
        let start = text.find(&format!("\n{key} = ")).unwrap() + key.len() + 4;
        let end = start + text[start..].find([' ', '\n']).unwrap();
        text.replace_range(start..end, &format!("{value:?}"));
    }
    text
}

/// The softer of the sets below, along its path: the angle goes back where it would have jumped.
#[test]
#[ignore = "a minute: cargo nextest run -p subrope-tests --test ways --run-ignored only"]
fn a_softer_strand_is_bent_along_its_path() {
    let text = bent_strand(&SOFTER);
    let start = text.find("increments = ").unwrap();
    let end = start + text[start..].find('\n').unwrap();
    let arcs = "increments = { initial = 0.0015, maximum = 0.05, minimum = 1e-5, control = \"arc_length\" }";
    let run = run_scene(&[&text[..start], arcs, &text[end..]].concat(), None);
    let totals = run.model.analysis.totals();
    println!("{totals:?}");
    assert_eq!(totals.jumps, 0);
    assert!(totals.energy_error().abs() < 1e-3);
}

/// Two parameter sets on which Newton's method alone has stalled, at 61 and 53 degrees in another program.
#[test]
#[ignore = "minutes: cargo nextest run -p subrope-tests --test ways --run-ignored only"]
fn harder_strands_are_bent_to_the_end() {
    let narrower = [
        ("K_ec", 40.0),
        ("w_e", 0.003),
        ("nu", 0.3),
        ("K_c", 20.0),
        ("K_t", 4.0),
        ("tau_t", 0.2),
        ("H_t", 0.4),
        ("K_l", 30.0),
        ("tau_l", 1.2),
        ("H_l", 0.5),
    ];
    for parameters in [&SOFTER[..], &narrower] {
        let run = run_scene(&bent_strand(parameters), None);
        let totals = run.model.analysis.totals();
        println!("{totals:?}");
        let told = totals.released / totals.work_scale;
        assert!((totals.energy_error() - told).abs() < 1e-2, "a jump is told");
    }
}
