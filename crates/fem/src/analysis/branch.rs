//! From a branch that has become unstable to the one that forks off it.
//!
//! Where equilibrium forks, the tangent has a null vector `phi` that loads and motions do no work on: the path goes
//! on along `db = dq/ds` without it. At a limit point `db` turns into `phi` instead. So an increment with more
//! negative pivots than the last has passed a fork if `db` and the mode of least stiffness are nearly perpendicular.
//! The other branch leaves along the mode (Wagner and Wriggers, Eng. Comput. 5 (1988) 103): Newton's method from the
//! state that has converged plus a multiple of it, small ones first, until it ends in a state that lies in that
//! direction and has no more negative pivots. With a given fraction that is a state at the same loads, which exists
//! where the branch rises from the fork; on a path with arc lengths it is one as far from the last increment as the
//! multiple is, whether the branch rises or falls.

use super::arc_length::{Measure, Sweep};
use super::driver::Analysis;
use super::line_search::ends_search;
use super::mode::Metric;
use super::newton::Attempt;
use super::record::IncrementRecord;
use super::step::{BranchChoice, Step};
use super::workspace::Workspace;
use crate::contribution::Request;
use crate::{Energies, FemError};

/// Amplitudes that are tried, over the largest change of a coordinate in the increment.
const AMPLITUDES: [f64; 6] = [0.25, 1.0, 4.0, 16.0, 64.0, 256.0];

/// Cosine of the angle between path and mode below which a branch forks off.
const FORK: f64 = 0.1;

/// Part of the change of the increment by which another state differs at least.
const STILL: f64 = 1e-3;

/// Cosine of the angle between the mode and the way to a state above which it lies on the branch that forks off.
const ASIDE: f64 = 0.3;

/// What an increment has converged to, and where it may leave to.
struct Fork {
    q: Vec<f64>,
    /// The mode, as coordinates, as large as the change of the increment.
    mode: Vec<f64>,
    metric: Metric,
    energies: Energies,
    negative_pivots: usize,
}

impl Analysis {
    /// Leaves for the branch that forks off, if that is wanted and there is one.
    pub(super) fn choose_branch(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        attempt: &mut Attempt,
        record: &mut IncrementRecord,
    ) -> Result<(), FemError> {
        if self.options.branch == BranchChoice::Follow {
            return Ok(());
        }
        if record.negative_pivots.is_none() {
            record.negative_pivots = self.count_negative_pivots()?;
        }
        let before = self.totals.negative_pivots.unwrap_or(0);
        if record.negative_pivots.is_none_or(|now| now <= before) {
            return Ok(());
        }
        let Some(fork) = self.fork(work, step, *attempt, before)? else {
            // What was looked at around the state that has converged is not to be committed.
            return self.evaluate(&mut work.base, &work.target, None, Request::Tangent);
        };
        for amplitude in AMPLITUDES.iter().flat_map(|a| [*a, -*a]) {
            let (mut there, mut trial) = (*attempt, record.clone());
            let found = self.leave(work, step, (&mut there, &mut trial), (&fork, amplitude));
            record.iterations = trial.iterations;
            match found {
                Ok(()) if there.to <= 1.0 && self.is_aside(work, &fork, trial.negative_pivots)? => {
                    (*attempt, *record) = (there, trial);
                    record.switched = true;
                    return Ok(());
                }
                Err(error) if ends_search(&error) => return Err(error),
                _ => {}
            }
        }
        self.leave(work, step, (attempt, record), (&fork, 0.0))
    }

    /// Whether the base, with a tangent that has become unstable, is past a fork.
    fn fork(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        attempt: Attempt,
        before: usize,
    ) -> Result<Option<Fork>, FemError> {
        let Some(negative_pivots) = self.correct(work)?.filter(|now| *now > before) else { return Ok(None) };
        let metric = self.metric_of_motion()?;
        let (mut mode, mut buffer) = (work.correction.clone(), vec![0.0; work.rhs.len()]);
        self.least_mode(&metric, &work.correction, &mut mode, &mut buffer)?;
        let mut sweep = Sweep::new(work.rhs.len());
        self.sweep(work, step, attempt, &mut sweep)?;
        self.aim_at(work, step, attempt);
        if metric.product(&sweep.along, &mode).abs() >= FORK * metric.length(&sweep.along) {
            return Ok(None);
        }
        let q = work.base.q.clone();
        let mut direction = vec![0.0; q.len()];
        self.equations()?.scatter_add(1.0, &mode, &mut direction);
        let scale = self.largest(&self.moved(&work.base)) / self.largest(&direction);
        direction.iter_mut().for_each(|d| *d *= scale);
        let energies = work.base.energies;
        Ok(scale.is_normal().then_some(Fork { q, mode: direction, metric, energies, negative_pivots }))
    }

    /// Newton's method from beside the state that has converged.
    fn leave(
        &mut self,
        work: &mut Workspace,
        step: &Step,
        (attempt, record): (&mut Attempt, &mut IncrementRecord),
        (fork, amplitude): (&Fork, f64),
    ) -> Result<(), FemError> {
        self.start_anew(work);
        for ((q, found), mode) in work.base.q.iter_mut().zip(&fork.q).zip(&fork.mode) {
            *q = found + amplitude * mode;
        }
        if self.is_along(step, *attempt) {
            if amplitude != 0.0 {
                work.base.energies = fork.energies;
                self.stretch(&work.base, attempt);
            }
            self.correct_along(work, step, (attempt, record), Measure::Arc)?;
        } else {
            self.aim_at(work, step, *attempt);
            self.iterate_here(work, *attempt, record)?;
        }
        record.negative_pivots = self.count_negative_pivots()?;
        Ok(())
    }

    /// Whether the base lies on the branch that forks off.
    fn is_aside(&self, work: &mut Workspace, fork: &Fork, pivots: Option<usize>) -> Result<bool, FemError> {
        let (equations, metric) = (self.equations()?, &fork.metric);
        let way: Vec<f64> = work.base.q.iter().zip(&fork.q).map(|(new, old)| new - old).collect();
        equations.gather(&way, &mut work.correction);
        equations.gather(&fork.mode, &mut work.rhs);
        let lengths = metric.length(&work.correction) * metric.length(&work.rhs);
        let common = metric.product(&work.rhs, &work.correction);
        let moved = self.largest(&way) > STILL * self.largest(&fork.mode);
        Ok(moved && common.abs() > ASIDE * lengths && pivots.is_some_and(|now| now <= fork.negative_pivots))
    }

    /// Motions, rotations times the lever \[mm\].
    fn metric_of_motion(&self) -> Result<Metric, FemError> {
        let weight = |c: &u32| self.lever_of(*c as usize).powi(2);
        Ok(Metric { weights: self.equations()?.coordinates().iter().map(weight).collect() })
    }

    /// The largest coordinate, rotations times the lever \[mm\].
    fn largest(&self, q: &[f64]) -> f64 {
        q.iter().enumerate().fold(0.0, |most, (c, value)| most.max((self.lever_of(c) * value).abs()))
    }
}
