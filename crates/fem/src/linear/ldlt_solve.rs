//! Solution with the supernodal LDLᵀ factors, in place and in elimination order.
//!
//! It reads every entry of the factors twice and is as fast as memory: the rows of a panel, scattered over many runs of
//! unknowns, are gathered so that each panel is one product of a matrix and a vector.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_unit_lower_triangular_in_place, solve_unit_upper_triangular_in_place};
use faer::{Accum, ColMut, ColRef, MatRef, Par};

use super::ldlt::Ldlt;
use super::ldlt_plan::Plan;
use super::panel;
use super::parallel::map_mut;
use super::supernodes::Supernode;

/// A branch of a solution: its supernodes, its unknowns, what it adds to the unknowns above it, room for the rows of a
/// panel below its diagonal block.
struct Branch<'a> {
    number: usize,
    unknowns: &'a mut [f64],
    above: &'a mut [f64],
    rows: &'a mut [f64],
}

impl Ldlt {
    /// Entries of the buffer [`Ldlt::solve_in_place`] needs: the room of every branch, then the rows of the tallest panel of
    /// the trunk.
    pub(super) fn solve_buffer(&self) -> usize {
        branch_buffer(&self.plan) + tallest(&self.plan, self.plan.schedule.trunk.iter().copied())
    }

    /// Overwrites `x`, in elimination order, by the solution of `L D Lᵀ x = x`.
    pub(super) fn solve_in_place(&self, x: &mut [f64], buffer: &mut [f64]) {
        let plan = &self.plan;
        let (buffer, rows) = buffer.split_at_mut(branch_buffer(plan));
        let mut branches = split_branches(plan, x, buffer);
        map_mut(&mut branches, &|branch: &mut Branch<'_>| self.forward_branch(branch));
        self.gather(x, buffer);
        for &number in &plan.schedule.trunk {
            self.forward(number, x, rows);
        }
        for &number in plan.schedule.trunk.iter().rev() {
            self.backward(number, x, rows);
        }
        self.distribute(x, buffer);
        let mut branches = split_branches(plan, x, buffer);
        map_mut(&mut branches, &|branch: &mut Branch<'_>| self.backward_branch(branch));
    }

    fn panel(&self, supernode: &Supernode) -> MatRef<'_, f64> {
        panel::panel(&self.values[supernode.offset..supernode.offset + supernode.len()], supernode)
    }

    fn forward(&self, number: usize, x: &mut [f64], rows: &mut [f64]) {
        let supernode = &self.plan.supernodes.list[number];
        let (top, bottom) = self.panel(supernode).split_at_row(supernode.columns());
        let (head, tail) = x.split_at_mut(supernode.end);
        let own = &mut head[supernode.begin..];
        lower_solve(top, own);
        let below = multiply(bottom, own, rows);
        for run in self.plan.supernodes.runs(supernode) {
            let first = run.local as usize - supernode.columns();
            let unknowns = run.begin as usize - supernode.end..run.end as usize - supernode.end;
            subtract(&below[first..], &mut tail[unknowns]);
        }
    }

    fn backward(&self, number: usize, x: &mut [f64], rows: &mut [f64]) {
        let supernode = &self.plan.supernodes.list[number];
        let (top, bottom) = self.panel(supernode).split_at_row(supernode.columns());
        let (head, tail) = x.split_at_mut(supernode.end);
        let own = &mut head[supernode.begin..];
        divide_pivots(top, own);
        for run in self.plan.supernodes.runs(supernode) {
            let first = run.local as usize - supernode.columns();
            let above = &tail[run.begin as usize - supernode.end..run.end as usize - supernode.end];
            rows[first..first + above.len()].copy_from_slice(above);
        }
        subtract_transposed(bottom, &rows[..bottom.nrows()], own);
        upper_solve(top, own);
    }

    /// Forward substitution within a branch; contributions to the unknowns above go to a buffer of its own.
    fn forward_branch(&self, branch: &mut Branch<'_>) {
        branch.above.fill(0.0);
        self.visit_branch(branch, false);
    }

    fn backward_branch(&self, branch: &mut Branch<'_>) {
        self.visit_branch(branch, true);
    }

    fn visit_branch(&self, branch: &mut Branch<'_>, backward: bool) {
        let range = self.plan.schedule.branches[branch.number].clone();
        let root = range.end - 1;
        let mut each = |number: usize| {
            let supernode = &self.plan.supernodes.list[number];
            if backward {
                self.backward_within(supernode, root, branch);
            } else {
                self.forward_within(supernode, root, branch);
            }
        };
        if backward { range.rev().for_each(&mut each) } else { range.for_each(&mut each) }
    }

    fn forward_within(&self, supernode: &Supernode, root: usize, branch: &mut Branch<'_>) {
        let (top, bottom) = self.panel(supernode).split_at_row(supernode.columns());
        let split = Split::new(&self.plan, root);
        let base = self.first_unknown(branch.number);
        let (head, tail) = branch.unknowns.split_at_mut(supernode.end - base);
        let own = &mut head[supernode.begin - base..];
        lower_solve(top, own);
        let below = multiply(bottom, own, branch.rows);
        for run in self.plan.supernodes.runs(supernode) {
            for part in split.parts(run.begin as usize, run.end as usize) {
                let first = run.local as usize - supernode.columns() + part.begin - run.begin as usize;
                if part.above {
                    subtract(&below[first..], &mut branch.above[part.place..part.place + part.len]);
                } else {
                    let place = part.begin - supernode.end;
                    subtract(&below[first..], &mut tail[place..place + part.len]);
                }
            }
        }
    }

    fn backward_within(&self, supernode: &Supernode, root: usize, branch: &mut Branch<'_>) {
        let (top, bottom) = self.panel(supernode).split_at_row(supernode.columns());
        let split = Split::new(&self.plan, root);
        let base = self.first_unknown(branch.number);
        let (head, tail) = branch.unknowns.split_at_mut(supernode.end - base);
        let own = &mut head[supernode.begin - base..];
        divide_pivots(top, own);
        for run in self.plan.supernodes.runs(supernode) {
            for part in split.parts(run.begin as usize, run.end as usize) {
                let first = run.local as usize - supernode.columns() + part.begin - run.begin as usize;
                let place = if part.above { part.place } else { part.begin - supernode.end };
                let from = if part.above { &branch.above[..] } else { &tail[..] };
                branch.rows[first..first + part.len].copy_from_slice(&from[place..place + part.len]);
            }
        }
        subtract_transposed(bottom, &branch.rows[..bottom.nrows()], own);
        upper_solve(top, own);
    }

    fn first_unknown(&self, branch: usize) -> usize {
        self.plan.supernodes.list[self.plan.schedule.branches[branch].start].begin
    }

    /// Adds the contributions of the branches, in their order, to the unknowns above.
    fn gather(&self, x: &mut [f64], buffer: &[f64]) {
        self.for_each_above(|unknowns, place| {
            for (value, &contribution) in x[unknowns.clone()].iter_mut().zip(&buffer[place..]) {
                *value += contribution;
            }
        });
    }

    /// Hands every branch the solved unknowns above it.
    fn distribute(&self, x: &[f64], buffer: &mut [f64]) {
        self.for_each_above(|unknowns, place| {
            buffer[place..place + unknowns.len()].copy_from_slice(&x[unknowns]);
        });
    }

    fn for_each_above(&self, mut visit: impl FnMut(Range<usize>, usize)) {
        let mut room = 0;
        for branch in &self.plan.schedule.branches {
            let root = &self.plan.supernodes.list[branch.end - 1];
            let mut place = room;
            for run in self.plan.supernodes.runs(root) {
                visit(run.begin as usize..run.end as usize, place);
                place += (run.end - run.begin) as usize;
            }
            room += branch_room(&self.plan, branch);
        }
    }
}

fn rows_below(plan: &Plan, number: usize) -> usize {
    let supernode = &plan.supernodes.list[number];
    supernode.rows - supernode.columns()
}

/// Most rows of some panels below their diagonal blocks.
fn tallest(plan: &Plan, supernodes: impl Iterator<Item = usize>) -> usize {
    supernodes.map(|number| rows_below(plan, number)).max().unwrap_or(0)
}

/// Room of a branch: the unknowns above it, and the rows of its tallest panel.
fn branch_room(plan: &Plan, branch: &Range<usize>) -> usize {
    rows_below(plan, branch.end - 1) + tallest(plan, branch.clone())
}

fn branch_buffer(plan: &Plan) -> usize {
    plan.schedule.branches.iter().map(|branch| branch_room(plan, branch)).sum()
}

fn split_branches<'a>(plan: &Plan, x: &'a mut [f64], buffer: &'a mut [f64]) -> Vec<Branch<'a>> {
    let mut branches = Vec::with_capacity(plan.schedule.branches.len());
    let (mut rest, mut taken, mut buffer) = (x, 0, buffer);
    for (number, range) in plan.schedule.branches.iter().enumerate() {
        let (first, end) = (plan.supernodes.list[range.start].begin, plan.supernodes.list[range.end - 1].end);
        let (_, tail) = rest.split_at_mut(first - taken);
        let (unknowns, tail) = tail.split_at_mut(end - first);
        let (room, remaining) = buffer.split_at_mut(branch_room(plan, range));
        let (above, rows) = room.split_at_mut(rows_below(plan, range.end - 1));
        branches.push(Branch { number, unknowns, above, rows });
        (rest, taken, buffer) = (tail, end, remaining);
    }
    branches
}

/// Consecutive rows of a run that lie within the branch, or above it at `place` of its buffer.
struct Part {
    begin: usize,
    len: usize,
    above: bool,
    place: usize,
}

/// Where the rows of a branch's panels lie.
struct Split<'a> {
    plan: &'a Plan,
    root: &'a Supernode,
}

impl<'a> Split<'a> {
    fn new(plan: &'a Plan, root: usize) -> Self {
        Self { plan, root: &plan.supernodes.list[root] }
    }

    /// The part of `begin..end` within the branch and the part above it, which lies in one run of the root.
    fn parts(&self, begin: usize, end: usize) -> impl Iterator<Item = Part> {
        let boundary = self.root.end.clamp(begin, end);
        let within = Part { begin, len: boundary - begin, above: false, place: 0 };
        let place =
            if boundary < end { self.plan.supernodes.local_row(self.root, boundary) - self.root.columns() } else { 0 };
        let above = Part { begin: boundary, len: end - boundary, above: true, place };
        [within, above].into_iter().filter(|part| part.len > 0)
    }
}

fn lower_solve(top: MatRef<'_, f64>, own: &mut [f64]) {
    solve_unit_lower_triangular_in_place(top, ColMut::from_slice_mut(own).as_mat_mut(), Par::Seq);
}

fn upper_solve(top: MatRef<'_, f64>, own: &mut [f64]) {
    solve_unit_upper_triangular_in_place(top.transpose(), ColMut::from_slice_mut(own).as_mat_mut(), Par::Seq);
}

fn divide_pivots(top: MatRef<'_, f64>, own: &mut [f64]) {
    for (column, value) in own.iter_mut().enumerate() {
        *value /= top[(column, column)];
    }
}

/// `matrix vector` in the first of `rows`.
fn multiply<'a>(matrix: MatRef<'_, f64>, vector: &[f64], rows: &'a mut [f64]) -> &'a [f64] {
    let product = &mut rows[..matrix.nrows()];
    matmul(ColMut::from_slice_mut(product), Accum::Replace, matrix, ColRef::from_slice(vector), 1.0, Par::Seq);
    product
}

/// `target -= matrix^T vector`.
fn subtract_transposed(matrix: MatRef<'_, f64>, vector: &[f64], target: &mut [f64]) {
    let (matrix, vector) = (matrix.transpose(), ColRef::from_slice(vector));
    matmul(ColMut::from_slice_mut(target), Accum::Add, matrix, vector, -1.0, Par::Seq);
}

/// `target -= vector`, as many as the target has.
fn subtract(vector: &[f64], target: &mut [f64]) {
    target.iter_mut().zip(vector).for_each(|(t, v)| *t -= v);
}
