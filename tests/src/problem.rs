//! Models put together by hand: nodes, sections, prescribed values, loads, one step after another.

use std::sync::Arc;

use nalgebra::Vector3;
use subrope_fem::analysis::{
    Analysis, Control, IncrementRecord, Increments, Load, LoadBefore, Model, NewtonOptions, Observer, Prescription,
    Step, StepLoad, Totals,
};
use subrope_fem::kinematics::{Kinematics, NodeRule, Section};
use subrope_fem::linear::SolverOptions;
use subrope_fem::{Contribution, FemError};
use subrope_geometry::Mesh;

/// A model with its state.
pub struct Problem {
    /// The analysis.
    pub analysis: Analysis,
}

impl Problem {
    /// Bricks on a mesh with sections tied to reference points; one thread, residual 1e-11.
    ///
    /// # Errors
    /// As [`Kinematics::new`].
    pub fn new(mesh: &Mesh, solid: Box<dyn Contribution>, sections: Vec<Section>) -> Result<Self, FemError> {
        let options = NewtonOptions { force_tolerance: 1e-11, ..NewtonOptions::default() };
        Self::with(mesh, solid, sections, options)
    }

    /// The same with other settings.
    ///
    /// # Errors
    /// As [`Kinematics::new`].
    pub fn with(
        mesh: &Mesh,
        solid: Box<dyn Contribution>,
        sections: Vec<Section>,
        options: NewtonOptions,
    ) -> Result<Self, FemError> {
        Self::of(mesh, vec![solid], sections, options)
    }

    /// A model of several contributions: bricks, contacts.
    ///
    /// # Errors
    /// As [`Kinematics::new`].
    pub fn of(
        mesh: &Mesh,
        contributions: Vec<Box<dyn Contribution>>,
        sections: Vec<Section>,
        options: NewtonOptions,
    ) -> Result<Self, FemError> {
        let kinematics = Kinematics::new(mesh.points.clone(), sections)?;
        let model = Model { kinematics, contributions };
        Ok(Self { analysis: Analysis::new(model, options, SolverOptions::default(), 1) })
    }

    /// A step to fill.
    #[must_use]
    pub fn step(&self, increments: Increments) -> StepBuilder<'_> {
        let step = Step {
            name: "step".into(),
            duration: 1.0,
            prescriptions: Vec::new(),
            loads: Vec::new(),
            increments,
            knots: Vec::new(),
        };
        StepBuilder { kinematics: &self.analysis.model().kinematics, step }
    }

    /// Runs a step and keeps a row per increment.
    ///
    /// # Errors
    /// As [`Analysis::run_step`].
    pub fn run(&mut self, step: &Step) -> Result<Vec<Row>, FemError> {
        let mut recorder = Recorder::default();
        self.analysis.run_step(step, &mut recorder)?;
        Ok(recorder.rows)
    }

    /// Displacement of a node \[mm\].
    #[must_use]
    pub fn displacement(&self, node: u32) -> Vector3<f64> {
        let at = 3 * node as usize;
        Vector3::from_column_slice(&self.analysis.displacement()[at..at + 3])
    }

    /// Sum of the reactions of nodes \[N\].
    #[must_use]
    pub fn reaction(&self, nodes: &[u32]) -> Vector3<f64> {
        let all = self.analysis.nodal_reactions();
        nodes.iter().map(|&n| Vector3::from_column_slice(&all[3 * n as usize..3 * n as usize + 3])).sum()
    }
}

/// Fills a step. Prescribed values are reached linearly from where the coordinate stands.
pub struct StepBuilder<'a> {
    kinematics: &'a Kinematics,
    step: Step,
}

impl StepBuilder<'_> {
    fn prescribe(mut self, coordinate: u32, value: f64) -> Self {
        self.step.prescriptions.retain(|p| p.coordinate != coordinate);
        let path = Arc::new(move |fraction: f64, reached: f64| reached + (value - reached) * fraction);
        self.step.prescriptions.push(Prescription { coordinate, path });
        self
    }

    /// Prescribes component `k` of nodes.
    #[must_use]
    pub fn nodes(mut self, nodes: &[u32], k: u32, value: f64) -> Self {
        for &node in nodes {
            match self.kinematics.rules()[node as usize] {
                NodeRule::Free { first } => self = self.prescribe(first + k, value),
                NodeRule::Tied { .. } | NodeRule::Image { .. } => panic!("node {node} is tied"),
            }
        }
        self
    }

    /// Prescribes all components of a node.
    #[must_use]
    pub fn place(self, node: u32, displacement: &Vector3<f64>) -> Self {
        (0..3).fold(self, |step, k| step.nodes(&[node], k, displacement[k as usize]))
    }

    /// Prescribes component `k` (0 to 2 displacement, 3 to 5 rotation vector) of a reference point.
    #[must_use]
    pub fn point(self, index: usize, k: u32, value: f64) -> Self {
        let first = self.kinematics.points()[index].first;
        self.prescribe(first + k, value)
    }

    /// Holds all components of a reference point but some.
    #[must_use]
    pub fn hold(self, index: usize, except: &[u32]) -> Self {
        (0..6).filter(|k| !except.contains(k)).fold(self, |step, k| step.point(index, k, 0.0))
    }

    /// Prescribes component `k` of a reference point as a function of the fraction of the step.
    #[must_use]
    pub fn point_path(mut self, index: usize, k: u32, path: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        let coordinate = self.kinematics.points()[index].first + k;
        self.step.prescriptions.retain(|p| p.coordinate != coordinate);
        self.step.prescriptions.push(Prescription { coordinate, path: Arc::new(move |fraction, _| path(fraction)) });
        self
    }

    /// Loads component `k` of a reference point with a force or moment that goes linearly from one value to another.
    #[must_use]
    pub fn load(mut self, index: usize, k: u32, from: f64, to: f64) -> Self {
        let coordinate = self.kinematics.points()[index].first + k;
        let load = Load { nodal: Vec::new(), coordinates: vec![(coordinate, 1.0)] };
        let path = Arc::new(move |fraction: f64, _: LoadBefore| from + (to - from) * fraction);
        self.step.loads.push(StepLoad { load, path });
        self
    }

    /// Loads nodes with shares of a dead force that grows linearly over the step.
    #[must_use]
    pub fn force(mut self, nodes: &[u32], shares: &[f64], force: Vector3<f64>) -> Self {
        let nodal = nodes.iter().zip(shares).map(|(&n, s)| (n, force * *s)).collect();
        let load = Load { nodal, coordinates: Vec::new() };
        self.step.loads.push(StepLoad { load, path: Arc::new(|fraction, _| fraction) });
        self
    }

    /// The step.
    #[must_use]
    pub fn build(self) -> Step {
        self.step
    }
}

/// What a run says after one increment.
#[derive(Clone, Debug)]
pub struct Row {
    /// The attempt that converged.
    pub record: IncrementRecord,
    /// Displacement and rotation vector of every reference point.
    pub motion: Vec<[Vector3<f64>; 2]>,
    /// Force and moment on every reference point.
    pub reaction: Vec<[Vector3<f64>; 2]>,
    /// Energies so far.
    pub totals: Totals,
}

/// Keeps a row per increment.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    /// The rows.
    pub rows: Vec<Row>,
    /// Attempts that failed, with their causes.
    pub failures: Vec<String>,
}

impl Observer for Recorder {
    fn converged(&mut self, analysis: &Analysis, record: &IncrementRecord) -> Result<Control, FemError> {
        let kinematics = &analysis.model().kinematics;
        let points = 0..kinematics.points().len();
        self.rows.push(Row {
            record: record.clone(),
            motion: points.clone().map(|p| kinematics.point_motion(p, analysis.coordinates()).into()).collect(),
            reaction: points.map(|p| analysis.point_reaction(p).into()).collect(),
            totals: *analysis.totals(),
        });
        Ok(Control::Continue)
    }

    fn failed(&mut self, _: &IncrementRecord, cause: &FemError) {
        self.failures.push(cause.to_string());
    }
}
