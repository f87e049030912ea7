//! Trusses whose equilibrium paths are known in closed form.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use subrope_fem::analysis::{
    Analysis, Control, IncrementRecord, Increments, Load, Model, NewtonOptions, Observer, Step, StepLoad,
};
use subrope_fem::kinematics::Kinematics;
use subrope_fem::linear::SolverOptions;
use subrope_fem::{
    Configuration, Contribution, Energies, FemError, Request, Sink, StateError, StateReader, StateWriter,
};

/// Bars of Green strain: `Pi = c/2 e^2`, `e = (l^2 - L^2)/2`, `c = EA/L^3`.
struct Bars {
    points: Vec<Vector3<f64>>,
    ends: Vec<[u32; 2]>,
    stiffness: Vec<f64>,
}

impl Contribution for Bars {
    fn element_count(&self) -> usize {
        self.ends.len()
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        &self.ends[element]
    }

    fn is_symmetric(&self) -> bool {
        true
    }

    fn has_potential(&self) -> bool {
        true
    }

    fn assemble(
        &mut self,
        at: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
    ) -> Result<Energies, FemError> {
        let mut out = Energies::default();
        for (e, (&[a, b], &c)) in self.ends.iter().zip(&self.stiffness).enumerate() {
            let moved = |n: u32| Vector3::from_fn(|k, _| at.displacement[3 * n as usize + k]);
            let length = self.points[b as usize] - self.points[a as usize];
            let change = moved(b) - moved(a);
            let d = length + change;
            let strain = length.dot(&change) + 0.5 * change.norm_squared();
            out.potential += 0.5 * c * strain * strain;
            let force = d * (c * strain);
            let block = (d * d.transpose() + Matrix3::identity() * strain) * c;
            let forces: [f64; 6] = std::array::from_fn(|i| if i % 2 == 0 { -force[i / 2] } else { force[i / 2] });
            let matrix: [f64; 36] = std::array::from_fn(|i| {
                let (row, column) = (i / 6, i % 6);
                let sign = if row % 2 == column % 2 { 1.0 } else { -1.0 };
                sign * block[(row / 2, column / 2)]
            });
            sink.add(e, &forces, (request == Request::Tangent).then_some(&matrix));
        }
        out.stored = out.potential;
        Ok(out)
    }

    fn commit(&mut self) {}

    fn save(&self, _: &mut dyn StateWriter) -> Result<(), StateError> {
        Ok(())
    }

    fn restore(&mut self, _: &dyn StateReader) -> Result<(), StateError> {
        Ok(())
    }
}

/// The law of springs between points along z.
pub trait Springs {
    /// Force, stiffness and energies of a spring at a stretch.
    fn answer(&mut self, spring: usize, stretch: f64) -> (f64, f64, Energies);

    /// The stretches asked last are those of the increment.
    fn commit(&mut self) {}

    /// As [`Contribution::soften`].
    fn soften(&mut self, part: f64) -> bool {
        let _ = part;
        false
    }
}

/// Springs along z, each between two nodes.
pub struct Axial<S> {
    /// Their ends.
    pub nodes: Vec<[u32; 2]>,
    /// Their law.
    pub springs: S,
}

impl<S: Springs + Send> Contribution for Axial<S> {
    fn element_count(&self) -> usize {
        self.nodes.len()
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        &self.nodes[element]
    }

    fn is_symmetric(&self) -> bool {
        true
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn assemble(
        &mut self,
        at: &Configuration<'_>,
        request: Request,
        sink: &mut dyn Sink,
    ) -> Result<Energies, FemError> {
        let mut out = Energies::default();
        for (e, [a, b]) in self.nodes.iter().enumerate() {
            let stretch = at.displacement[3 * *b as usize + 2] - at.displacement[3 * *a as usize + 2];
            let (force, stiffness, energies) = self.springs.answer(e, stretch);
            out += energies;
            let mut forces = [0.0; 6];
            (forces[4], forces[5]) = (-force, force);
            let mut matrix = [0.0; 36];
            (matrix[28], matrix[29], matrix[34], matrix[35]) = (stiffness, -stiffness, -stiffness, stiffness);
            sink.add(e, &forces, (request == Request::Tangent).then_some(&matrix));
        }
        Ok(out)
    }

    fn commit(&mut self) {
        self.springs.commit();
    }

    fn soften(&mut self, part: f64) -> bool {
        self.springs.soften(part)
    }

    fn save(&self, _: &mut dyn StateWriter) -> Result<(), StateError> {
        Ok(())
    }

    fn restore(&mut self, _: &dyn StateReader) -> Result<(), StateError> {
        Ok(())
    }
}

/// Bars `(from, to, EA/L^3)` between points, all of whose coordinates are held but some.
pub struct Truss {
    /// Model and state.
    pub analysis: Analysis,
    free: Vec<u32>,
}

/// Keeps the records of converged increments, and the coordinates they ended at.
#[derive(Default)]
struct Keep(Vec<State>);

/// A converged increment.
#[derive(Clone, Debug)]
pub struct State {
    /// How it came about.
    pub record: IncrementRecord,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Reactions of all coordinates.
    pub reaction: Vec<f64>,
}

impl Observer for Keep {
    fn converged(&mut self, analysis: &Analysis, record: &IncrementRecord) -> Result<Control, FemError> {
        let (q, reaction) = (analysis.coordinates().to_vec(), analysis.reactions().to_vec());
        self.0.push(State { record: record.clone(), q, reaction });
        Ok(Control::Continue)
    }
}

impl Truss {
    /// Made of bars.
    ///
    /// # Errors
    /// [`FemError`].
    pub fn new(
        points: &[[f64; 3]],
        bars: &[(u32, u32, f64)],
        free: &[u32],
        options: NewtonOptions,
    ) -> Result<Self, FemError> {
        let points: Vec<Vector3<f64>> = points.iter().map(|p| Vector3::from(*p)).collect();
        let ends = bars.iter().map(|(a, b, _)| [*a, *b]).collect();
        let stiffness = bars.iter().map(|b| b.2).collect();
        let kinematics = Kinematics::new(points.clone(), Vec::new())?;
        let model = Model { kinematics, contributions: vec![Box::new(Bars { points, ends, stiffness })] };
        Ok(Self::of(model, free, options))
    }

    /// Made of anything.
    #[must_use]
    pub fn of(model: Model, free: &[u32], options: NewtonOptions) -> Self {
        Self { analysis: Analysis::new(model, options, SolverOptions::default(), 1), free: free.to_vec() }
    }

    /// A step that holds what is not free.
    #[must_use]
    pub fn step(&self, increments: Increments) -> Step {
        let coordinates = 0..self.analysis.coordinates().len() as u32;
        let held = coordinates.filter(|c| !self.free.contains(c));
        held.fold(Step::new("load", increments), |step, c| step.prescribe(c, 0.0))
    }

    /// Runs a step; answers its increments.
    ///
    /// # Errors
    /// [`FemError`].
    pub fn run(&mut self, step: &Step) -> Result<Vec<State>, FemError> {
        let (states, outcome) = self.run_while_possible(step);
        outcome.map(|()| states)
    }

    /// Runs a step; answers its increments and how it ended.
    pub fn run_while_possible(&mut self, step: &Step) -> (Vec<State>, Result<(), FemError>) {
        let mut keep = Keep::default();
        let outcome = self.analysis.run_step(step, &mut keep);
        (keep.0, outcome)
    }
}

/// A force on a coordinate that grows with the fraction of the step.
#[must_use]
pub fn push(mut step: Step, coordinate: u32, force: f64) -> Step {
    let load = Load { nodal: Vec::new(), coordinates: vec![(coordinate, force)] };
    step.loads.push(StepLoad { load, path: Arc::new(|fraction, _| fraction) });
    step
}

/// Height of the flat truss of von Mises.
pub const HEIGHT: f64 = 1.0;
/// Half its width.
pub const WIDTH: f64 = 3.0;
/// `EA/L^3` of its bars.
pub const BAR: f64 = 2.0;

/// Force on its apex at a deflection: `c (w^3 - 3 h w^2 + 2 h^2 w)` of two bars.
#[must_use]
pub fn apex_force(w: f64) -> f64 {
    BAR * w * (w - HEIGHT) * (w - 2.0 * HEIGHT)
}

/// The largest force, at `w = h (1 - 1/sqrt 3)`.
#[must_use]
pub fn limit_force() -> f64 {
    BAR * HEIGHT.powi(3) * 2.0 / 27.0_f64.sqrt()
}

/// Its free coordinate.
pub const APEX_DOWN: u32 = 3 * 2 + 2;

/// Two bars on a flat apex; a bar without stiffness holds the body against turning about them.
///
/// # Errors
/// [`FemError`].
pub fn von_mises(options: NewtonOptions) -> Result<Truss, FemError> {
    let points = [[-WIDTH, 0.0, 0.0], [WIDTH, 0.0, 0.0], [0.0, 0.0, HEIGHT], [0.0, 1.0, 0.0]];
    Truss::new(&points, &[(0, 2, BAR), (1, 2, BAR), (0, 3, 0.0)], &[APEX_DOWN], options)
}

/// A column of two bars in line with a hinge in the middle, which springs hold from both sides.
///
/// # Errors
/// [`FemError`].
pub fn column(options: NewtonOptions) -> Result<Truss, FemError> {
    let points = [[0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0], [-4.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
    let bars = [(0, 1, 100.0), (1, 2, 100.0), (1, 3, 0.01), (1, 4, 0.01), (0, 5, 0.0)];
    Truss::new(&points, &bars, &[3, 5], options)
}

/// Its loaded end.
pub const TOP: u32 = 8;
