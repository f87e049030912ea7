//! From a scene to a finite element model: mesh, fibre frames, law, ends, steps.

mod error;
mod law;
mod loads;
mod mesh;
mod rigid;
mod rope;
mod slice;
mod steps;
mod yarns;

pub use crate::contact::ContactCells;
pub use error::ModelError;
pub use mesh::{MeshModel, RopeModelShape};
pub(crate) use rigid::RigidBody;
#[cfg(feature = "contact")]
pub(crate) use rigid::size;
pub use slice::SliceShape;

use nalgebra::Vector3;
use subrope_fem::analysis::{Analysis, BranchChoice, Model, NewtonOptions, Silent, Step, TrustRegion, Viscous};
use subrope_fem::kinematics::{Kinematics, Section, SectionKind, Slide};
use subrope_fem::linear::SolverOptions;
use subrope_fem::{Contribution, FemError, Repeated};
use subrope_io::Ignored;

use crate::run::RunError;
use crate::scene::{self, End, EndKind, HalfCycle, LineSearch, Program, ProgramStep, Scene, SceneFile};
use crate::{contact, estimate};

/// A scene made ready to solve.
pub struct RopeModel {
    /// Mesh and fibre frames.
    pub mesh: MeshModel,
    /// The model and its state.
    pub analysis: Analysis,
    /// Its steps; every half cycle is one.
    pub steps: Vec<Step>,
    /// Which steps are half cycles, and of what.
    pub half_cycles: Vec<Option<CycleStep>>,
    /// Keywords of a deck that were not read.
    pub ignored: Vec<Ignored>,
    /// Faces of every contact, in the order of the contributions.
    pub contact_cells: Vec<ContactCells>,
}

/// A step that is a half cycle of tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleStep {
    /// Which one.
    pub half: HalfCycle,
    /// The reference point that moves.
    pub point: usize,
    /// Length that elongations refer to \[mm\].
    pub length: Option<f64>,
    /// Step of the scene that it belongs to.
    pub source: usize,
}

impl CycleStep {
    fn of(scene: &Scene, step: &ProgramStep, kinematics: &Kinematics) -> Option<Self> {
        let cycles = scene.step[step.source].cycles.as_ref()?;
        let point = kinematics.point_index(&cycles.point)?;
        Some(Self { half: step.half_cycle?, point, length: cycles.length.or(scene.length()), source: step.source })
    }
}

impl RopeModel {
    /// Builds the model of a scene file.
    ///
    /// # Errors
    /// [`ModelError`]: mesh, sets, law or steps that do not go together.
    pub fn new(file: &SceneFile, threads: Option<usize>) -> Result<Self, ModelError> {
        Self::from_scene(&file.scene, file.deck.as_deref(), threads)
    }

    /// Builds the model of a scene; `deck` is the path of its deck, if it has one.
    ///
    /// # Errors
    /// As [`RopeModel::new`].
    pub fn from_scene(
        scene: &Scene,
        deck: Option<&std::path::Path>,
        threads: Option<usize>,
    ) -> Result<Self, ModelError> {
        let (mesh, ignored) = MeshModel::new(scene, deck)?;
        Ok(Self { ignored, ..Self::from_mesh(scene, mesh, threads)? })
    }

    /// Builds the model of a scene on a mesh that is there.
    ///
    /// # Errors
    /// As [`RopeModel::new`].
    pub fn from_mesh(scene: &Scene, mesh: MeshModel, threads: Option<usize>) -> Result<Self, ModelError> {
        let (model, contact_cells) = match mesh.slice {
            Some(shape) => slice_model(scene, &mesh, &shape)?,
            None => whole_model(scene, &mesh)?,
        };
        if scene.solver.trust_region == scene::TrustRegion::Always && !model.can_be_minimised() {
            return Err(ModelError::NoPotential);
        }
        if scene.solver.branch == scene::BranchChoice::Switch && !model.is_symmetric() {
            return Err(ModelError::NoPivots);
        }
        let kinematics = &model.kinematics;
        let program = Program::new(scene);
        let steps = steps::steps(scene, &program, &mesh, kinematics)?;
        let half_cycles = program.steps.iter().map(|s| CycleStep::of(scene, s, kinematics)).collect();
        let threads = threads.or(scene.solver.threads).unwrap_or_else(default_threads);
        let analysis = Analysis::new(model, newton(scene), solver_options(), threads);
        Ok(Self { mesh, analysis, steps, half_cycles, ignored: Vec::new(), contact_cells })
    }
}

type Parts = (Model, Vec<ContactCells>);

/// All bricks of a mesh, its ends, rigid bodies and contacts.
fn whole_model(scene: &Scene, mesh: &MeshModel) -> Result<Parts, ModelError> {
    let solid = law::solid(mesh, &scene.law, scene.element.formulation)?;
    let mut positions = mesh.mesh.points.clone();
    let mut sections = scene.end.iter().map(|end| section_of(end, scene, mesh)).collect::<Result<Vec<_>, _>>()?;
    let bodies = rigid::rigid_bodies(scene, mesh, &mut positions, &mut sections)?;
    let contacts = contact::contacts(scene, mesh, &bodies, &positions)?;
    let kinematics = Kinematics::new(positions, sections)?;
    let mut contributions: Vec<Box<dyn Contribution>> = vec![solid];
    if let Some(bending) = yarns::bending(scene, mesh)? {
        contributions.push(Box::new(bending));
    }
    let mut contact_cells = Vec::with_capacity(contacts.len());
    for (contact, cells) in contacts {
        contributions.push(contact);
        contact_cells.push(cells);
    }
    if let Some(stabilisation) = &scene.solver.stabilisation {
        contributions.push(Box::new(Viscous::new(stabilisation.viscosity, &mesh.node_volumes()?)));
    }
    Ok((Model { kinematics, contributions }, contact_cells))
}

/// One layer of one strand and its images; everything counts as often as the rope has it.
fn slice_model(scene: &Scene, mesh: &MeshModel, shape: &SliceShape) -> Result<Parts, ModelError> {
    let solid = law::solid(mesh, &scene.law, scene.element.formulation)?;
    let mut positions = mesh.mesh.points.clone();
    let mut screw = slice::screw(shape, &mesh.mesh, scene.slice_end().map_or("END_B", |end| end.name.as_str()));
    let mut contributions: Vec<Box<dyn Contribution>> = vec![Box::new(Repeated::new(solid, shape.copies()))];
    let mut contact_cells = Vec::new();
    if let Some((contact, cells)) = contact::slice_contact(scene, mesh, &mut screw, &mut positions)? {
        contributions.push(Box::new(Repeated::new(contact, shape.contact_copies())));
        contact_cells.push(cells);
    }
    let kinematics = Kinematics::with_screw(positions, Vec::new(), screw)?;
    Ok((Model { kinematics, contributions }, contact_cells))
}

impl RopeModel {
    /// Checks that no step leaves a rigid motion free, and analyses the first.
    ///
    /// # Errors
    /// [`RunError::Solver`] with the rigid motions, or what the analysis answers.
    pub fn check_steps(&mut self) -> Result<(), RunError> {
        let refused = |cause| RunError::Solver { cause: Box::new(cause), kept: None, point: None };
        self.steps.iter().try_for_each(|step| self.analysis.check_held(step)).map_err(refused)?;
        match self.steps.first() {
            Some(step) => self.analysis.analyse(step).map_err(refused),
            None => Ok(()),
        }
    }

    /// Refuses a model that, as analysed for its first step, takes more memory than there is.
    ///
    /// # Errors
    /// [`ModelError::TooLarge`].
    pub fn check_memory(&self) -> Result<(), ModelError> {
        let mesh = &self.mesh.mesh;
        let what = || format!("{} elements with {} nodes and their factor", mesh.cell_count(), mesh.point_count());
        estimate::refuse_beyond(what, estimate::memory_of(self), estimate::limit_with_held())
    }

    /// Bytes of state per integration point, committed and trial; 0 for an elastic law.
    #[must_use]
    pub fn state_bytes_per_point(&self) -> usize {
        let fields = self.analysis.model().contributions.iter().find_map(|c| c.fields());
        fields.map_or(0, |f| f.state_bytes_per_point())
    }

    /// Runs all steps without writing anything; the state is then in `analysis`.
    ///
    /// # Errors
    /// [`FemError`], as [`Analysis::run_step`].
    pub fn solve(&mut self) -> Result<(), FemError> {
        self.steps.iter().try_for_each(|step| self.analysis.run_step(step, &mut Silent))
    }
}

fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Newton corrects what a solution lacks: twelve digits are more than it can use.
fn solver_options() -> SolverOptions {
    SolverOptions { target_residual: 1e-12, ..SolverOptions::default() }
}

fn newton(scene: &Scene) -> NewtonOptions {
    let solver = &scene.solver;
    NewtonOptions {
        force_tolerance: solver.residual_tolerance,
        energy_tolerance: solver.energy_tolerance,
        max_iterations: solver.max_iterations,
        line_search: solver.line_search == LineSearch::Auto,
        smoothing: solver.smoothing == scene::Smoothing::Auto,
        trust_region: match solver.trust_region {
            scene::TrustRegion::Auto => TrustRegion::Auto,
            scene::TrustRegion::Off => TrustRegion::Off,
            scene::TrustRegion::Always => TrustRegion::Always,
        },
        branch: match solver.branch {
            scene::BranchChoice::Follow => BranchChoice::Follow,
            scene::BranchChoice::Switch => BranchChoice::Switch,
        },
        extrapolate: solver.extrapolate,
        keep_factors: solver.keep_factors,
        growth: solver.growth,
        cutback: solver.cutback,
        temperature: scene.temperature,
        ..NewtonOptions::default()
    }
}

/// The section that an end ties to its reference point.
fn section_of(end: &End, scene: &Scene, mesh: &MeshModel) -> Result<Section, ModelError> {
    let nodes = mesh.node_set(end.set())?.to_vec();
    let centroid = mesh.centroid(&nodes);
    let position = end.point.map_or(centroid, Vector3::from);
    let (axis, kind) = match end.kind {
        EndKind::Rigid => (Vector3::z(), SectionKind::Rigid),
        EndKind::Radial => (mesh.section_normal(&nodes, end)?, SectionKind::Radial),
        EndKind::Sliding => (Vector3::z(), SectionKind::Sliding(slides(end, scene, mesh)?)),
    };
    Ok(Section { name: end.name.clone(), position, axis, nodes, kind })
}

/// The strands of an end of a rope about z, each with the radius of its centre.
fn slides(end: &End, scene: &Scene, mesh: &MeshModel) -> Result<Vec<Slide>, ModelError> {
    let strands = scene.rope.as_ref().map_or(0, |rope| rope.strands);
    let set = end.set().to_uppercase();
    let own = (1..=strands).map(|i| format!("{set}_{i}")).filter(|name| mesh.node_set(name).is_ok());
    let mut sets: Vec<String> = own.collect();
    if sets.is_empty() {
        sets.push(set);
    }
    let slide = |name: &String| {
        let nodes = mesh.node_set(name)?.to_vec();
        let centre = mesh.centroid(&nodes);
        Ok(Slide { direction: Vector3::new(centre.x, centre.y, 0.0), nodes })
    };
    sets.iter().map(slide).collect()
}

impl From<FemError> for ModelError {
    fn from(error: FemError) -> Self {
        Self::Fem(Box::new(error))
    }
}
