//! Supernodal LDLᵀ factorisation of a symmetric, possibly indefinite matrix.
//!
//! Left-looking over the supernodes, without pivoting: `A = L D Lᵀ` with diagonal `D`, whose signs give the inertia.
//! Subtrees of the elimination tree are factorised at the same time; every panel is computed by the same sequential
//! kernels in the same order whatever the threads, so the factors are bitwise equal for any number of them.

use std::ops::Range;

use super::error::{LinearError, Operand};
use super::ldlt_plan::Plan;
use super::panel::{self, Workspace};
use super::parallel::map_mut;

/// The factors and the buffers of repeated factorisations.
pub(super) struct Ldlt {
    pub(super) plan: Plan,
    pub(super) values: Vec<f64>,
    branch_work: Vec<Workspace>,
    trunk_work: Workspace,
}

/// A branch at work: its supernodes, their panels, its buffers.
struct Branch<'a> {
    supernodes: Range<usize>,
    values: &'a mut [f64],
    work: &'a mut Workspace,
}

impl Ldlt {
    /// # Errors
    /// [`LinearError::OutOfMemory`] if the factors cannot be allocated.
    pub(super) fn new(plan: Plan) -> Result<Self, LinearError> {
        let entries = plan.supernodes.values();
        let mut values = Vec::new();
        let bytes = entries.saturating_mul(size_of::<f64>());
        values.try_reserve_exact(entries).map_err(|_| LinearError::OutOfMemory { bytes })?;
        values.resize(entries, 0.0);
        let work = |branch: &Range<usize>| Workspace::new(&plan.workspace_size(branch.clone()));
        let branch_work = plan.schedule.branches.iter().map(work).collect();
        let trunk_work = Workspace::new(&plan.workspace_size(plan.schedule.trunk.iter().copied()));
        Ok(Self { plan, values, branch_work, trunk_work })
    }

    pub(super) fn bytes(&self) -> usize {
        let work: usize = self.branch_work.iter().map(Workspace::bytes).sum();
        self.plan.bytes() + self.values.len() * size_of::<f64>() + work + self.trunk_work.bytes()
    }

    /// Factorises the matrix with `values` in the order of the pattern.
    ///
    /// # Errors
    /// [`LinearError::Singular`] on a zero pivot, [`LinearError::NonFinite`] on overflow.
    pub(super) fn factorise(&mut self, values: &[f64]) -> Result<(), LinearError> {
        let Self { plan, values: factor, branch_work, trunk_work } = self;
        let mut branches = split_branches(plan, factor, branch_work);
        let outcomes = map_mut(&mut branches, &|branch: &mut Branch<'_>| branch.factorise(plan, values));
        outcomes.into_iter().collect::<Result<(), LinearError>>()?;
        for &number in &plan.schedule.trunk {
            factorise_panel(plan, number, values, factor, 0, trunk_work)?;
        }
        Ok(())
    }

    /// Unknown of the caller at every position of the elimination.
    pub(super) fn order(&self) -> &[u32] {
        &self.plan.order
    }

    /// Position in elimination order and value of every pivot.
    pub(super) fn pivots(&self) -> impl Iterator<Item = (usize, f64)> {
        self.plan.supernodes.list.iter().flat_map(|supernode| {
            let entry =
                |column| (supernode.begin + column, self.values[supernode.offset + column * (supernode.rows + 1)]);
            (0..supernode.columns()).map(entry)
        })
    }
}

/// Hands every branch the panels of its own supernodes.
fn split_branches<'a>(plan: &Plan, factor: &'a mut [f64], work: &'a mut [Workspace]) -> Vec<Branch<'a>> {
    let mut branches = Vec::with_capacity(work.len());
    let (mut rest, mut taken) = (factor, 0);
    for (supernodes, work) in plan.schedule.branches.iter().zip(work) {
        let first = plan.supernodes.list[supernodes.start].offset;
        let last = &plan.supernodes.list[supernodes.end - 1];
        let end = last.offset + last.len();
        let (_, tail) = rest.split_at_mut(first - taken);
        let (values, tail) = tail.split_at_mut(end - first);
        branches.push(Branch { supernodes: supernodes.clone(), values, work });
        (rest, taken) = (tail, end);
    }
    branches
}

impl Branch<'_> {
    fn factorise(&mut self, plan: &Plan, values: &[f64]) -> Result<(), LinearError> {
        let base = plan.supernodes.list[self.supernodes.start].offset;
        self.supernodes.clone().try_for_each(|s| factorise_panel(plan, s, values, self.values, base, self.work))
    }
}

/// Fills, updates and factorises one panel. `factor` starts at entry `base` of all panels.
fn factorise_panel(
    plan: &Plan,
    number: usize,
    values: &[f64],
    factor: &mut [f64],
    base: usize,
    work: &mut Workspace,
) -> Result<(), LinearError> {
    let supernode = &plan.supernodes.list[number];
    let (finished, open) = factor.split_at_mut(supernode.offset - base);
    let target: &mut [f64] = &mut open[..supernode.len()];
    target.fill(0.0);
    for entries in plan.entries(number) {
        let step = if entries.along_row { supernode.rows } else { 1 };
        let places = target[entries.place as usize..].iter_mut().step_by(step);
        let from = &values[entries.slot as usize..][..usize::from(entries.len)];
        places.zip(from).for_each(|(entry, value)| *entry += value);
    }
    for update in plan.updates(number) {
        let source = &plan.supernodes.list[update.source as usize];
        let source_values = &finished[source.offset - base..][..source.len()];
        panel::update(&plan.supernodes, (supernode, target), (source, source_values), update.first_run as usize, work);
    }
    panel::factorise(target, supernode, work).map_err(|column| {
        let dof = plan.order.get(supernode.begin + column).map_or(0, |&dof| dof as usize);
        let pivot = target[column * (supernode.rows + 1)];
        if pivot.is_finite() {
            LinearError::Singular { dof, pivot, scale: 1.0 }
        } else {
            LinearError::NonFinite { what: Operand::Factors, dof }
        }
    })
}
