//! A model evaluated without a solver: residual, energy and dense stiffness at given coordinates.

use nalgebra::{DMatrix, DVector};
use subrope_fem::kinematics::Kinematics;
use subrope_fem::linear::{SolverOptions, Storage};
use subrope_fem::{Configuration, Contribution, Energies, Evaluation, FemError, Request, System};

/// Nodes, bricks and the system of all coordinates.
pub struct Dense {
    /// Nodes and ties.
    pub kinematics: Kinematics,
    contributions: Vec<Box<dyn Contribution>>,
    system: System,
    committed: Vec<f64>,
}

impl Dense {
    /// A model with nothing prescribed.
    #[must_use]
    pub fn new(kinematics: Kinematics, solid: Box<dyn Contribution>) -> Self {
        let start = vec![0.0; kinematics.coordinate_count()];
        Self::of(kinematics, vec![solid], &start)
    }

    /// A model of several contributions with nothing prescribed, contacts made ready for some coordinates.
    #[must_use]
    pub fn of(kinematics: Kinematics, mut contributions: Vec<Box<dyn Contribution>>, q: &[f64]) -> Self {
        let free = vec![false; kinematics.coordinate_count()];
        let mut committed = vec![0.0; 3 * kinematics.node_count()];
        kinematics.displacements(q, &mut committed);
        for contribution in &mut contributions {
            contribution.prepare(&committed).unwrap();
        }
        let system = System::new(&kinematics, &contributions, &free, &SolverOptions::default()).unwrap();
        committed.fill(0.0);
        Self { kinematics, contributions, system, committed }
    }

    /// The bricks.
    #[must_use]
    pub fn contributions(&self) -> &[Box<dyn Contribution>] {
        &self.contributions
    }

    /// Generalised residual and energies at `q`.
    ///
    /// # Errors
    /// As the assembly.
    pub fn evaluate(&mut self, q: &DVector<f64>, request: Request) -> Result<(DVector<f64>, Energies), FemError> {
        let nodes = self.kinematics.node_count();
        let mut displacement = vec![0.0; 3 * nodes];
        self.kinematics.displacements(q.as_slice(), &mut displacement);
        let at = Evaluation {
            q: q.as_slice(),
            configuration: Configuration {
                displacement: &displacement,
                committed: &self.committed,
                time_increment: 1.0,
                time: 1.0,
                temperature: 293.15,
                predicting: false,
                parallel: false,
            },
            external: &vec![0.0; 3 * nodes],
            jump: None,
            request,
        };
        let mut residual = DVector::zeros(q.len());
        let out = self.system.assemble(&self.kinematics, &mut self.contributions, &at, residual.as_mut_slice())?;
        Ok((residual, out.energies))
    }

    /// Evaluates at `q` and makes it the committed state.
    pub fn commit(&mut self, q: &DVector<f64>) {
        self.evaluate(q, Request::Residual).unwrap();
        self.kinematics.displacements(q.as_slice(), &mut self.committed);
        self.contributions.iter_mut().for_each(|c| c.commit());
    }

    /// The residual alone.
    #[must_use]
    pub fn residual(&mut self, q: &DVector<f64>) -> DVector<f64> {
        self.evaluate(q, Request::Residual).unwrap().0
    }

    /// Internal nodal forces of the last evaluation, three per node.
    #[must_use]
    pub fn nodal_forces(&self) -> &[f64] {
        self.system.nodal_forces()
    }

    /// The assembled stiffness, both triangles.
    #[must_use]
    pub fn stiffness(&mut self, q: &DVector<f64>) -> DMatrix<f64> {
        self.evaluate(q, Request::Tangent).unwrap();
        let (pattern, values) = self.system.matrix();
        let mut out = DMatrix::zeros(q.len(), q.len());
        let symmetric = pattern.storage() == Storage::Lower;
        for column in 0..q.len() {
            let start = pattern.column_pointers()[column];
            for (i, &row) in pattern.column(column).iter().enumerate() {
                out[(row as usize, column)] = values[start + i];
                if symmetric {
                    out[(column, row as usize)] = values[start + i];
                }
            }
        }
        out
    }

    /// The stiffness by central differences of the residual, fourth order in `h`.
    #[must_use]
    pub fn differenced_stiffness(&mut self, q: &DVector<f64>, h: f64) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(q.len(), q.len());
        for column in 0..q.len() {
            let mut at = |step: f64| {
                let mut moved = q.clone();
                moved[column] += step;
                self.residual(&moved)
            };
            let (near, far) = (at(h) - at(-h), at(2.0 * h) - at(-2.0 * h));
            out.set_column(column, &((near * 8.0 - far) / (12.0 * h)));
        }
        out
    }
}
