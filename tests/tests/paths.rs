//! Equilibrium paths followed past limit points, through snap-back and at forks, against their closed forms.

use subrope_fem::analysis::{Analysis, BranchChoice, Increments, Model, NewtonOptions, PathControl, Step, TrustRegion};
use subrope_fem::kinematics::Kinematics;
use subrope_fem::{Energies, FemError};
use subrope_tests::truss::{
    APEX_DOWN, Axial, BAR, HEIGHT, Springs, State, TOP, Truss, WIDTH, apex_force, column, limit_force, push, von_mises,
};
use subrope_tests::{run_scene, scene_file};

fn options(branch: BranchChoice) -> NewtonOptions {
    NewtonOptions { force_tolerance: 1e-11, trust_region: TrustRegion::Off, branch, ..NewtonOptions::default() }
}

fn automatic(control: PathControl, minimum: f64, maximum: f64) -> Increments {
    Increments::Automatic { control, initial: 0.02, minimum, maximum, max_count: 1000 }
}

fn arcs(maximum: f64) -> Increments {
    automatic(PathControl::ArcLength, 1e-5, maximum)
}

/// Whether the fraction of the step goes back somewhere.
fn goes_back(states: &[State]) -> bool {
    states.windows(2).any(|w| w[1].record.fraction < w[0].record.fraction)
}

/// Nothing has jumped: energies balance as well as the trapezoidal rule does.
fn is_smooth(analysis: &Analysis) -> bool {
    let totals = analysis.totals();
    totals.jumps == 0 && totals.energy_error().abs() < 1e-2
}

#[test]
fn a_flat_truss_is_followed_through() -> Result<(), FemError> {
    let mut truss = von_mises(options(BranchChoice::Follow))?;
    let load = 1.5 * limit_force();
    let step = push(truss.step(arcs(0.1)), APEX_DOWN, -load);
    let states = truss.run(&step)?;
    let mut last = 0.0;
    for State { record, q, .. } in &states {
        let w = -q[APEX_DOWN as usize];
        assert!(w > last, "the apex goes down all the way");
        assert!((apex_force(w) - record.fraction * load).abs() < 1e-8 * load, "{w}");
        let unstable = (w - HEIGHT).abs() < HEIGHT / 3.0_f64.sqrt();
        let near = ((w - HEIGHT).abs() - HEIGHT / 3.0_f64.sqrt()).abs() < 0.05;
        assert!(near || record.negative_pivots == Some(usize::from(unstable)), "{w} {:?}", record.negative_pivots);
        last = w;
    }
    let least = states.iter().map(|s| s.record.fraction).fold(1.0, f64::min);
    assert!((least + 1.0 / 1.5).abs() < 0.02, "the load is turned round in between: {least}");
    assert_eq!(states.last().map(|s| s.record.fraction), Some(1.0));
    assert_eq!(truss.analysis.totals().inertia_changes, 2);
    assert!(is_smooth(&truss.analysis));
    Ok(())
}

/// The flat truss pushed through a bar half as stiff as the truss is against it in the middle.
#[test]
fn a_soft_press_snaps_back() -> Result<(), FemError> {
    let points = [[-WIDTH, 0.0, 0.0], [WIDTH, 0.0, 0.0], [0.0, 0.0, HEIGHT], [0.0, 1.0, 0.0], [0.0, 0.0, 7.0 * HEIGHT]];
    let soft = 1.0 / 36.0;
    let bars = [(0, 2, BAR), (1, 2, BAR), (0, 3, 0.0), (2, 4, soft)];
    let press = 3 * 4 + 2;
    let mut truss = Truss::new(&points, &bars, &[APEX_DOWN], options(BranchChoice::Follow))?;
    let step = truss.step(arcs(0.05)).prescribe(press as u32, -2.8);
    let states = truss.run(&step)?;
    let mut last = 0.0;
    for State { q, reaction, .. } in &states {
        let w = -q[APEX_DOWN as usize];
        assert!(w > last, "the apex goes down all the way");
        assert!((-reaction[press] - apex_force(w)).abs() < 1e-8, "{w}");
        last = w;
    }
    assert!(goes_back(&states) && is_smooth(&truss.analysis));
    // Motion alone would have snapped.
    let mut truss = Truss::new(&points, &bars, &[APEX_DOWN], options(BranchChoice::Follow))?;
    let increments = automatic(PathControl::Load, 1e-6, 0.05);
    let step = truss.step(increments).prescribe(press as u32, -2.8);
    let snapped = truss.run(&step).map(|_| truss.analysis.totals().jumps);
    assert!(!matches!(snapped, Ok(0)), "{snapped:?}");
    Ok(())
}

/// Springs in a row, the first of which slips at a force that falls with the slip: `F = F0 exp(-s/s0)`.
struct Slipping {
    slip: f64,
    trial: f64,
}

const SPRINGS: usize = 10;
const SPRING: f64 = 10.0;
const CLUTCH: f64 = 100.0;
const STRENGTH: f64 = 1.0;
const DECAY: f64 = 0.25;

fn strength(slip: f64) -> f64 {
    STRENGTH * (-slip / DECAY).exp()
}

impl Slipping {
    /// Slip, force and stiffness at a stretch.
    fn clutch(&self, stretch: f64) -> (f64, f64, f64) {
        let elastic = CLUTCH * (stretch - self.slip);
        if elastic <= strength(self.slip) {
            return (self.slip, elastic, CLUTCH);
        }
        let mut slip = self.slip;
        for _ in 0..50 {
            slip -= (CLUTCH * (stretch - slip) - strength(slip)) / (strength(slip) / DECAY - CLUTCH);
        }
        let softening = strength(slip) / DECAY;
        (slip, strength(slip), -CLUTCH * softening / (CLUTCH - softening))
    }
}

impl Springs for Slipping {
    fn answer(&mut self, spring: usize, stretch: f64) -> (f64, f64, Energies) {
        let mut energies = Energies::default();
        if spring > 0 {
            energies.stored = 0.5 * SPRING * stretch * stretch;
            return (SPRING * stretch, SPRING, energies);
        }
        let (slip, force, stiffness) = self.clutch(stretch);
        let before = if slip > self.slip { strength(self.slip) } else { 0.0 };
        energies.dissipated_mid[0] = 0.5 * (force + before) * (slip - self.slip);
        energies.stored = 0.5 * force * force / CLUTCH;
        self.trial = slip;
        (force, stiffness, energies)
    }

    fn commit(&mut self) {
        self.slip = self.trial;
    }
}

/// A row of springs that unloads while its end slips: motions go back almost as they came, only dissipation goes on.
#[test]
fn a_slipping_row_is_followed_by_its_dissipation() -> Result<(), FemError> {
    let nodes = SPRINGS as u32 + 1;
    let points = (0..=nodes).map(|n| nalgebra::Vector3::new(f64::from(n % 2), f64::from(n / 2 % 2), f64::from(n)));
    let springs = Slipping { slip: 0.0, trial: 0.0 };
    let chain = Axial { nodes: (0..nodes).map(|n| [n, n + 1]).collect(), springs };
    let model =
        Model { kinematics: Kinematics::new(points.collect(), Vec::new())?, contributions: vec![Box::new(chain)] };
    let free: Vec<u32> = (1..nodes).map(|n| 3 * n + 2).collect();
    let mut row = Truss::of(model, &free, options(BranchChoice::Follow));
    let (end, pull) = (3 * nodes + 2, 1.3);
    let step: Step = row.step(arcs(0.05)).prescribe(end, pull);
    let states = row.run(&step)?;
    let compliance = 1.0 / CLUTCH + SPRINGS as f64 / SPRING;
    let mut last = 0.0;
    for State { q, reaction, record } in &states {
        let force = reaction[end as usize];
        let slip = record.fraction * pull - compliance * force;
        assert!(slip > last - 1e-9, "{slip} after {last}");
        assert!(slip < 1e-9 || (force - strength(slip)).abs() < 1e-8, "{force} at {slip}");
        assert!((q[end as usize] - record.fraction * pull).abs() < 1e-14);
        last = slip;
    }
    assert!(goes_back(&states) && is_smooth(&row.analysis));
    let least = states.iter().skip_while(|s| s.record.fraction < 0.7).map(|s| s.record.fraction).fold(1.0, f64::min);
    // u = s + C F is least where C F = s0.
    let turn = DECAY * (1.0 + (compliance / DECAY).ln());
    assert!((least * pull - turn).abs() < 0.01, "{} {turn}", least * pull);
    let dissipated: f64 = row.analysis.totals().dissipated_mid.iter().sum();
    assert!((dissipated - DECAY * (STRENGTH - strength(last))).abs() < 1e-2 * dissipated);
    Ok(())
}

/// A truss too steep to stay upright: from `z^2 = h^2 - 2 w^2` on its apex moves aside, along `x^2 + z^2 = h^2 - 2 w^2`.
fn steep(branch: BranchChoice) -> Result<Truss, FemError> {
    let points = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 1.0, 0.0]];
    Truss::new(&points, &[(0, 2, BAR), (1, 2, BAR), (0, 3, 0.0)], &[3 * 2, APEX_DOWN], options(branch))
}

/// Force that holds the upright apex at a height.
fn upright(z: f64) -> f64 {
    BAR * z * (4.0 - z * z)
}

/// The branch that forks off falls from the fork: no state on it has its load, only a path leads there.
#[test]
fn a_fork_is_passed_or_taken() -> Result<(), FemError> {
    let load = 1.2 * upright(2.0_f64.sqrt());
    for branch in [BranchChoice::Follow, BranchChoice::Switch] {
        let mut truss = steep(branch)?;
        let step = push(truss.step(arcs(0.04)), APEX_DOWN, -load);
        let (states, outcome) = truss.run_while_possible(&step);
        for State { record, q, .. } in &states {
            let (x, z) = (q[6], 2.0 + q[8]);
            let force = record.fraction * load;
            if x == 0.0 {
                assert!((upright(z) - force).abs() < 1e-8 * load, "{z}");
            } else {
                assert!((x * x + z * z - 2.0).abs() < 1e-7, "{x} {z}");
                assert!((2.0 * BAR * z - force).abs() < 1e-7 * load, "{z}");
            }
        }
        assert!(is_smooth(&truss.analysis), "{:?}", truss.analysis.totals());
        let aside = states.iter().filter(|s| s.q[6] != 0.0).count();
        if branch == BranchChoice::Follow {
            outcome?;
            assert_eq!((aside, states.last().map(|s| s.record.fraction)), (0, Some(1.0)));
        } else {
            // The other branch is a circle and has no end.
            assert!(aside > 100 && matches!(outcome, Err(FemError::TooManyIncrements { .. })), "{aside}");
            assert!(states.iter().any(|s| s.q[6] > 1.4) && states.iter().any(|s| s.q[6] < -1.4));
        }
    }
    Ok(())
}

#[test]
fn a_column_leaves_for_its_bent_branch() -> Result<(), FemError> {
    for increments in [Increments::Fixed(8), arcs(0.1)] {
        let mut truss = column(options(BranchChoice::Switch))?;
        let step = truss.step(increments).prescribe(TOP, -0.2);
        let states = truss.run(&step)?;
        assert_eq!(states.iter().filter(|s| s.record.switched).count(), 1);
        assert_eq!(truss.analysis.totals().switched, 1);
        let last = states.last().map(|s| (s.record.negative_pivots, s.q[3]));
        assert!(
            last.is_some_and(|(pivots, x)| pivots == Some(0) && (x.abs() - 0.19_f64.sqrt()).abs() < 0.01),
            "{last:?}"
        );
    }
    Ok(())
}

/// Friction that grows with pressure has no potential, so that nothing but the path leads past the limit point.
#[test]
fn a_strand_with_friction_by_pressure_is_pushed_through() {
    let text = scene_file("buckled_strand.toml")
        .replace("friction = false\n", "tau_t = 0.05\nmu_t = 0.2\nX_t = 2.0\ntau_l = 0.5\nmu_l = 0.1\nX_l = 2.0\n");
    let run = run_scene(&text, None);
    let fractions: Vec<f64> =
        run.rows.iter().filter(|r| r.record.step == "push through").map(|r| r.record.fraction).collect();
    let totals = run.model.analysis.totals();
    println!("{} states, fractions {fractions:.3?}, {totals:?}", run.rows.len());
    assert!(!run.model.analysis.model().can_be_minimised());
    assert!(fractions.windows(2).any(|w| w[1] < w[0]), "the load goes back");
    assert_eq!((fractions.last().copied(), totals.jumps, totals.minimised), (Some(1.0), 0, 0));
    assert!(totals.energy_error().abs() < 1e-3, "{}", totals.energy_error());
}
