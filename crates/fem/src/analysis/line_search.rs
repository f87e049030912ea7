//! How far to go along a correction.
//!
//! Where the update derives from an incremental potential (no pressure-dependent friction) the potential must fall
//! (Armijo); elsewhere the residual must, in norm or along the correction. A full step that halves the residual is taken
//! at once. When points switch between sticking and sliding, plain Newton can cycle for ever and shorter increments do
//! not help: the potential ends the cycle. Friction of contacts, whose limit follows the pressure, has one too as long as that
//! limit is kept from the start of the search.

use super::driver::Analysis;
use super::workspace::Workspace;
use crate::FemError;
use crate::contribution::Request;

/// Share of the slope that the potential must fall by.
const ARMIJO: f64 = 1e-4;
/// Most trial lengths.
const TRIALS: usize = 8;
/// Rounding of a sum of energies, over its size.
pub(super) const ENERGY_NOISE: f64 = 1e-13;

/// A trial length compared with the base.
struct Comparison {
    length: f64,
    slope: f64,
    base_norm: f64,
    base_potential: f64,
}

/// Whether an error is not helped by a shorter correction.
pub(super) fn ends_search(error: &FemError) -> bool {
    !error.is_recoverable() || matches!(error, FemError::SearchOutdated)
}

impl Analysis {
    /// Moves the base along the correction and leaves it evaluated there with its tangent.
    pub(super) fn advance(&mut self, work: &mut Workspace, slope: f64) -> Result<(), FemError> {
        let mut search = Comparison {
            length: 1.0,
            slope,
            base_norm: work.base.norm,
            base_potential: work.base.potential + self.freeze(),
        };
        let mut best: Option<(f64, f64)> = None;
        for trial in 0..TRIALS {
            let request = if trial == 0 { Request::Tangent } else { Request::Residual };
            match self.go(work, search.length, request) {
                Ok(()) => {
                    if !self.options.line_search || self.acceptable(&search, work) {
                        return self.settle(work, search.length, request);
                    }
                    if best.is_none_or(|(norm, _)| work.trial.norm < norm) {
                        best = Some((work.trial.norm, search.length));
                    }
                    search.length = self.shorter(&search, work);
                }
                Err(e) if ends_search(&e) || trial + 1 == TRIALS => return Err(e),
                Err(_) => search.length *= 0.3,
            }
        }
        match best {
            Some((norm, length)) if norm < 2.0 * search.base_norm => {
                self.go(work, length, Request::Tangent)?;
                self.settle(work, length, Request::Tangent)
            }
            _ => Err(self.not_converged(work, TRIALS)),
        }
    }

    /// Evaluates `length` along the correction.
    pub(super) fn go(&mut self, work: &mut Workspace, length: f64, request: Request) -> Result<(), FemError> {
        work.trial.q.copy_from_slice(&work.base.q);
        self.equations()?.scatter_add(length, &work.correction, &mut work.trial.q);
        self.evaluate(&mut work.trial, &work.target, None, request)
    }

    pub(super) fn settle(&mut self, work: &mut Workspace, length: f64, request: Request) -> Result<(), FemError> {
        if request == Request::Residual {
            self.go(work, length, Request::Tangent)?;
        }
        std::mem::swap(&mut work.base, &mut work.trial);
        Ok(())
    }

    fn acceptable(&self, search: &Comparison, work: &Workspace) -> bool {
        let trial = &work.trial;
        if trial.norm <= 0.5 * search.base_norm {
            return true;
        }
        if self.has_potential() && search.slope < 0.0 {
            let noise = ENERGY_NOISE * (trial.potential.abs() + search.base_potential.abs());
            return trial.potential <= search.base_potential + ARMIJO * search.length * search.slope + noise;
        }
        let along = self.slope_of(trial, &work.correction).abs();
        trial.norm <= 0.95 * search.base_norm || along <= 0.8 * search.slope.abs()
    }

    /// Next length: minimum of the parabola through what is known, kept between a tenth and a half.
    fn shorter(&self, search: &Comparison, work: &Workspace) -> f64 {
        let s = search.length;
        let guess = if self.has_potential() && search.slope < 0.0 {
            let excess = work.trial.potential - search.base_potential - search.slope * s;
            -search.slope * s * s / (2.0 * excess)
        } else {
            let along = self.slope_of(&work.trial, &work.correction);
            s * search.slope / (search.slope - along)
        };
        if guess.is_finite() { guess.clamp(0.1 * s, 0.5 * s) } else { 0.5 * s }
    }

    /// Makes the potential fit for a search from the base; answers by how much it changes there.
    pub(super) fn freeze(&mut self) -> f64 {
        self.model.contributions.iter_mut().map(|c| c.freeze()).sum()
    }

    pub(super) fn has_potential(&self) -> bool {
        self.model.contributions.iter().all(|c| c.has_potential())
    }
}
