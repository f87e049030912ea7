//! The sparse system of a model for one set of prescribed coordinates: pattern, scatter maps, solver, assembly.

use super::Equations;
use super::products::Products;
use super::scatter::{self, Cliques, ScatterMap};
use crate::FemError;
use crate::contribution::{Configuration, Contribution, Energies, Product, Request, Sink};
use crate::kinematics::{Kinematics, Reduction, Tie};
use crate::linear::{AnalysisReport, GmresLimits, LinearTerm, SolverOptions, SparsePattern, Storage, TangentSolver};

/// Pattern, scatter maps, matrix values and solver: made once per set of prescribed coordinates.
pub struct System {
    equations: Equations,
    maps: Vec<ScatterMap>,
    solver: TangentSolver,
    /// What the tangent has beside the matrix.
    products: Products,
    has_products: bool,
    /// Matrix values, with one spare position at the end.
    values: Vec<f64>,
    /// Internal nodal forces \[N\].
    nodal: Vec<f64>,
    /// Nodal forces less the external ones.
    net: Vec<f64>,
    ties: Vec<Tie>,
    nodes: Vec<Nodes>,
    reduction: Reduction,
}

/// A sudden motion of prescribed coordinates, linearised: adds `K du` to the forces.
#[derive(Clone, Copy, Debug)]
pub struct Jump<'a> {
    /// Nodal displacements of the motion \[mm\].
    pub displacement: &'a [f64],
}

/// What an assembly gives besides the values of the matrix.
#[derive(Clone, Copy, Debug, Default)]
pub struct Assembled {
    /// Energies of all contributions.
    pub energies: Energies,
    /// Norm of all element forces \[N\].
    pub force_scale: f64,
    /// Norm of the products of diagonal stiffness and displacement \[N\], with the tangent only: what the rounding of
    /// forces is in proportion to. A body that moves far without strain has no forces, yet these roundings.
    pub stiffness_scale: Option<f64>,
}

impl System {
    /// Numbers, patterns, analyses: everything symbolic.
    ///
    /// # Errors
    /// [`FemError::Linear`] from the analysis.
    pub fn new(
        kinematics: &Kinematics,
        contributions: &[Box<dyn Contribution>],
        prescribed: &[bool],
        options: &SolverOptions,
    ) -> Result<Self, FemError> {
        let equations = Equations::new(prescribed);
        let symmetric = contributions.iter().all(|c| c.is_symmetric());
        let storage = if symmetric { Storage::Lower } else { Storage::Full };
        let pattern = pattern(kinematics, &equations, contributions, storage)?;
        let maps =
            contributions.iter().map(|c| ScatterMap::new(kinematics, &equations, &pattern, c.as_ref())).collect();
        let solver = TangentSolver::analyse(pattern, options)?;
        let pattern = solver.pattern();
        Ok(Self {
            values: vec![0.0; pattern.nnz() + 1],
            nodal: vec![0.0; 3 * kinematics.node_count()],
            net: vec![0.0; 3 * kinematics.node_count()],
            ties: Vec::new(),
            nodes: contributions.iter().map(|c| Nodes::of(c.as_ref())).collect(),
            reduction: Reduction::default(),
            products: Products::default(),
            has_products: contributions.iter().any(|c| c.has_products()),
            equations,
            maps,
            solver,
        })
    }

    /// Numbering of the unknowns.
    pub fn equations(&self) -> &Equations {
        &self.equations
    }

    /// Whether the tangent is symmetric.
    pub fn is_symmetric(&self) -> bool {
        !self.has_products && self.solver.pattern().storage() == Storage::Lower
    }

    /// Stored entries of the matrix.
    pub fn entries(&self) -> usize {
        self.solver.pattern().nnz()
    }

    /// What the analysis chose.
    pub fn analysis(&self) -> &AnalysisReport {
        self.solver.analysis()
    }

    /// Internal nodal forces of the last assembly \[N\], three per node.
    pub fn nodal_forces(&self) -> &[f64] {
        &self.nodal
    }

    /// Assembles at `q` and reduces the nodal forces less `external` to generalised forces in `residual`.
    ///
    /// # Errors
    /// What a contribution answers; [`FemError::NonFiniteResidual`].
    pub fn assemble(
        &mut self,
        kinematics: &Kinematics,
        contributions: &mut [Box<dyn Contribution>],
        at: &Evaluation<'_>,
        residual: &mut [f64],
    ) -> Result<Assembled, FemError> {
        kinematics.ties(at.q, &mut self.ties);
        self.nodal.fill(0.0);
        if at.request == Request::Tangent {
            self.values.fill(0.0);
            self.products.clear();
        }
        let mut out = Assembled::default();
        let (mut scale, mut stiffness_scale) = (0.0, 0.0);
        let symmetric = self.solver.pattern().storage() == Storage::Lower;
        for ((contribution, map), nodes) in contributions.iter_mut().zip(&mut self.maps).zip(&self.nodes) {
            let mut sink = Assembler {
                kinematics,
                equations: &self.equations,
                pattern: self.solver.pattern(),
                ties: &self.ties,
                map,
                nodes,
                symmetric,
                own_symmetry: contribution.is_symmetric(),
                jump: at.jump,
                displacement: at.configuration.displacement,
                nodal: &mut self.nodal,
                values: &mut self.values,
                products: &mut self.products,
                reduction: &mut self.reduction,
                scale: 0.0,
                stiffness_scale: 0.0,
            };
            out.energies += contribution.assemble(&at.configuration, at.request, &mut sink)?;
            scale += sink.scale;
            stiffness_scale += sink.stiffness_scale;
        }
        out.force_scale = scale.sqrt();
        out.stiffness_scale = (at.request == Request::Tangent).then_some(stiffness_scale.sqrt());
        self.finish(kinematics, at, residual);
        if residual.iter().all(|v| v.is_finite()) { Ok(out) } else { Err(FemError::NonFiniteResidual) }
    }

    fn finish(&mut self, kinematics: &Kinematics, at: &Evaluation<'_>, residual: &mut [f64]) {
        for ((net, internal), external) in self.net.iter_mut().zip(&self.nodal).zip(at.external) {
            *net = internal - external;
        }
        kinematics.reduce(&self.ties, &self.net, residual);
        if at.request == Request::Tangent {
            let (equations, pattern, values) = (&self.equations, self.solver.pattern(), &mut self.values);
            kinematics.curvature_blocks(at.q, &self.net, &mut |coordinates, block| {
                add_block(equations, pattern, coordinates, block, values);
            });
        }
    }

    /// Factorises the assembled matrix, or its symmetric part, without the products beside it. Returns the number of
    /// negative pivots where it says something of the tangent: only if that is symmetric.
    ///
    /// # Errors
    /// [`FemError::Linear`].
    pub fn factorise(&mut self) -> Result<Option<usize>, FemError> {
        let nnz = self.entries();
        let report = self.solver.factorise(&self.values[..nnz])?;
        Ok(report.negative_pivots.filter(|_| self.products.is_empty()))
    }

    /// Solves `K x = rhs` with the last factorisation: at once, or by GMRES where the tangent is unsymmetric. Answers the
    /// iterations that this took.
    ///
    /// # Errors
    /// [`FemError::Linear`].
    pub fn solve(&mut self, rhs: &[f64], x: &mut [f64]) -> Result<usize, FemError> {
        let nnz = self.entries();
        Ok(self.solver.solve(&self.values[..nnz], &self.products, rhs, x)?)
    }

    /// As [`System::solve`] with factors of an earlier assembly, by GMRES as far as `limits` say.
    ///
    /// # Errors
    /// [`FemError::Linear`], with [`LinearError::Stalled`](crate::linear::LinearError::Stalled) where they do not serve.
    pub fn solve_by_kept_factors(
        &mut self,
        limits: &GmresLimits,
        rhs: &[f64],
        x: &mut [f64],
    ) -> Result<usize, FemError> {
        let nnz = self.entries();
        Ok(self.solver.solve_by_kept_factors(&self.values[..nnz], &self.products, limits, rhs, x)?)
    }

    /// Iterations of GMRES that cost as much as a factorisation.
    pub fn worth_of_factors(&self) -> f64 {
        self.solver.worth_of_factors()
    }

    /// Estimate of the condition number of the tangent last factorised, scaled to a unit diagonal; of its symmetric part
    /// where it is not symmetric. See [`TangentSolver::condition`](crate::linear::TangentSolver::condition).
    pub fn condition(&mut self) -> Option<f64> {
        let nnz = self.entries();
        self.solver.condition(&self.values[..nnz])
    }

    /// The diagonal of the matrix.
    pub(crate) fn diagonal(&self, out: &mut [f64]) {
        for (i, entry) in out.iter_mut().enumerate() {
            *entry = self.solver.pattern().slot(i, i).map_or(0.0, |slot| self.values[slot]);
        }
    }

    /// Puts other values on the diagonal, until the next tangent is assembled.
    pub(crate) fn set_diagonal(&mut self, entries: impl Iterator<Item = f64>) {
        for (i, entry) in entries.enumerate() {
            if let Some(slot) = self.solver.pattern().slot(i, i) {
                self.values[slot] = entry;
            }
        }
    }

    /// `out = K x`, without the products beside the matrix.
    pub(crate) fn multiply(&self, x: &[f64], out: &mut [f64]) -> Result<(), FemError> {
        Ok(self.solver.pattern().multiply(&self.values[..self.entries()], x, out)?)
    }

    /// Matrix values and pattern, for checks.
    pub fn matrix(&self) -> (&SparsePattern, &[f64]) {
        (self.solver.pattern(), &self.values[..self.entries()])
    }
}

/// Where and how much to assemble.
#[derive(Clone, Copy, Debug)]
pub struct Evaluation<'a> {
    /// Coordinates.
    pub q: &'a [f64],
    /// Nodal displacements of `q`, the committed ones and the circumstances.
    pub configuration: Configuration<'a>,
    /// External nodal forces \[N\].
    pub external: &'a [f64],
    /// Linearised motion of prescribed coordinates.
    pub jump: Option<Jump<'a>>,
    /// Forces only, or stiffness as well.
    pub request: Request,
}

fn pattern(
    kinematics: &Kinematics,
    equations: &Equations,
    contributions: &[Box<dyn Contribution>],
    storage: Storage,
) -> Result<SparsePattern, FemError> {
    let mut cliques = Cliques::default();
    for contribution in contributions {
        scatter::cliques(kinematics, equations, contribution.as_ref(), &mut cliques);
    }
    for point in kinematics.points() {
        let omega = (point.first + 3)..(point.first + 6);
        cliques.push(omega.filter_map(|c| equations.of(c as usize)));
    }
    Ok(SparsePattern::from_cliques(equations.len(), cliques.iter(), storage)?)
}

/// Adds a small dense symmetric block on a list of coordinates.
fn add_block(equations: &Equations, pattern: &SparsePattern, coordinates: &[u32], block: &[f64], values: &mut [f64]) {
    let n = coordinates.len();
    for r in 0..n {
        for c in 0..n {
            let pair = (equations.of(coordinates[r] as usize), equations.of(coordinates[c] as usize));
            if let (Some(row), Some(column)) = pair
                && let Some(slot) = pattern.slot(row as usize, column as usize)
            {
                values[slot] += block[r * n + c];
            }
        }
    }
}

/// Nodes of the elements of a contribution, copied out so that the contribution can be evaluated mutably.
struct Nodes {
    starts: Vec<usize>,
    flat: Vec<u32>,
}

impl Nodes {
    fn of(contribution: &dyn Contribution) -> Self {
        let mut out = Self { starts: Vec::with_capacity(contribution.element_count() + 1), flat: Vec::new() };
        for e in 0..contribution.element_count() {
            out.starts.push(out.flat.len());
            out.flat.extend_from_slice(contribution.element_nodes(e));
        }
        out.starts.push(out.flat.len());
        out
    }

    fn element(&self, e: usize) -> &[u32] {
        &self.flat[self.starts[e]..self.starts[e + 1]]
    }
}

struct Assembler<'a> {
    kinematics: &'a Kinematics,
    equations: &'a Equations,
    pattern: &'a SparsePattern,
    ties: &'a [Tie],
    map: &'a mut ScatterMap,
    nodes: &'a Nodes,
    symmetric: bool,
    own_symmetry: bool,
    jump: Option<Jump<'a>>,
    displacement: &'a [f64],
    nodal: &'a mut [f64],
    values: &'a mut [f64],
    products: &'a mut Products,
    reduction: &'a mut Reduction,
    scale: f64,
    stiffness_scale: f64,
}

impl Sink for Assembler<'_> {
    fn add(&mut self, element: usize, force: &[f64], stiffness: Option<&[f64]>) {
        let nodes = self.nodes.element(element);
        let n = nodes.len();
        for (k, line) in force.chunks_exact(n).enumerate() {
            for (&node, value) in nodes.iter().zip(line) {
                self.nodal[3 * node as usize + k] += value;
                self.scale += value * value;
            }
        }
        let Some(matrix) = stiffness else { return };
        for k in 0..3 {
            for (a, &node) in nodes.iter().enumerate() {
                let product = matrix[((k * n + a) * 3 + k) * n + a] * self.displacement[3 * node as usize + k];
                self.stiffness_scale += product * product;
            }
        }
        if let Some(jump) = self.jump {
            self.add_jump(nodes, matrix, jump.displacement);
        }
        self.map.place(element, self.kinematics, self.equations, self.pattern, nodes);
        match self.map.tied(element) {
            None if self.symmetric || !self.own_symmetry => {
                self.map.add_free(element, n, self.symmetric, matrix, self.values);
            }
            None => {
                fill_mirrored(matrix, n, true, &mut self.reduction.nodal);
                self.map.add_free(element, n, false, &self.reduction.nodal, self.values);
            }
            Some(map) => {
                fill_mirrored(matrix, n, self.own_symmetry, &mut self.reduction.nodal);
                self.reduction.apply(self.kinematics, self.ties, nodes, map);
                let (size, reduced) = (map.coordinates.len(), &self.reduction.reduced);
                self.map.add_tied(element, size, self.symmetric, reduced, self.values);
            }
        }
    }

    fn add_products(&mut self, element: usize, products: &[Product<'_>]) {
        let nodes = self.nodes.element(element);
        if let Some(jump) = self.jump {
            let n = nodes.len();
            for product in products {
                let entries = (0..3).flat_map(|k| nodes.iter().map(move |&node| 3 * node as usize + k));
                let factor: f64 = entries.zip(product.column).map(|(at, c)| c * jump.displacement[at]).sum();
                for (i, r) in product.row.iter().enumerate() {
                    self.nodal[3 * nodes[i % n] as usize + i / n] += r * factor;
                }
            }
        }
        self.products.push(self.kinematics, self.ties, self.equations, nodes, products);
    }
}

impl Assembler<'_> {
    /// Adds `K du` to the nodal forces.
    fn add_jump(&mut self, nodes: &[u32], matrix: &[f64], jump: &[f64]) {
        let n = nodes.len();
        if nodes.iter().all(|&a| (0..3).all(|k| jump[3 * a as usize + k] == 0.0)) {
            return;
        }
        let entry = entry_reader(matrix, n, self.own_symmetry);
        for (a, &row) in nodes.iter().enumerate() {
            for k in 0..3 {
                let mut sum = 0.0;
                for (b, &column) in nodes.iter().enumerate() {
                    for m in 0..3 {
                        sum += entry(k, a, m, b) * jump[3 * column as usize + m];
                    }
                }
                self.nodal[3 * row as usize + k] += sum;
            }
        }
    }
}

/// Reads entry (component k of node a, component m of node b) of a component-major matrix of which a symmetric
/// contribution fills only the upper node triangle.
fn entry_reader(matrix: &[f64], n: usize, symmetric: bool) -> impl Fn(usize, usize, usize, usize) -> f64 {
    move |k, a, m, b| {
        let (k, a, m, b) = if symmetric && a > b { (m, b, k, a) } else { (k, a, m, b) };
        matrix[((k * n + a) * 3 + m) * n + b]
    }
}

/// The full component-major matrix of one that may be symmetric and half filled.
fn fill_mirrored(matrix: &[f64], n: usize, symmetric: bool, out: &mut Vec<f64>) {
    let entry = entry_reader(matrix, n, symmetric);
    out.clear();
    for row in 0..3 * n {
        out.extend((0..3 * n).map(|column| entry(row / n, row % n, column / n, column % n)));
    }
}
