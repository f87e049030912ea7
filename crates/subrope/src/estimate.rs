//! What a scene will take of memory, before anything is made of it; what exceeds the memory at hand is refused.
//!
//! Two estimates: of the scene alone, from counts that stand in it, a bound from below, so that nothing is refused that
//! would fit; and of the model after its analysis, when the size of the factor is known.

use crate::model::{ModelError, RopeModel};
use crate::scene::{Formulation, Rope, Scene, StrandMesh};

/// Memory that is taken to be there where the system does not tell \[bytes\].
const UNKNOWN_SYSTEM: f64 = 64e9;

/// Memory of the program itself and of small things \[bytes\].
const BASE: f64 = 15e6;

/// Memory of one node: positions, displacements, forces, reactions \[bytes\].
const NODE: f64 = 400.0;

/// Memory of a stored entry of the matrix: value, index, position in the factor \[bytes\].
const ENTRY: f64 = 16.0;

/// The part of it that the solver does not count.
const VALUE: f64 = 8.0;

/// Memory of one component of one reference point during one step \[bytes\].
const MOTION: f64 = 160.0;

/// Memory of one entry of a step, as written and as repeated for half a cycle \[bytes\].
const STEP_ENTRY: f64 = 400.0;

/// Memory of a point that may touch \[bytes\].
const CONTACT_POINT: f64 = 400.0;

/// Least size of a generated model, as real numbers: counts of a scene may be beyond what integers hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeEstimate {
    /// Elements.
    pub elements: f64,
    /// Nodes.
    pub nodes: f64,
    /// Steps, every half cycle being one.
    pub steps: f64,
    /// Memory of a run, at least \[bytes\].
    pub bytes: f64,
}

/// What a formulation costs.
struct Brick {
    nodes: f64,
    points: f64,
    /// Divisions of an edge that nodes make: 1 or 2.
    order: f64,
    /// Nodes over those of a brick with all of them.
    filled: f64,
}

impl Brick {
    fn of(formulation: Formulation) -> Self {
        let brick = |nodes, points, order, filled| Self { nodes, points, order, filled };
        match formulation {
            Formulation::Hex8 | Formulation::Hex8MeanVolume | Formulation::Hex8MeanElongation => {
                brick(8.0, 8.0, 1.0, 1.0)
            }
            Formulation::Hex20 => brick(20.0, 27.0, 2.0, 0.5),
            Formulation::Hex20R => brick(20.0, 8.0, 2.0, 0.5),
            Formulation::Hex27 => brick(27.0, 27.0, 2.0, 1.0),
        }
    }
}

impl SizeEstimate {
    /// Of a scene; a mesh from a deck is not counted.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let brick = Brick::of(scene.element.formulation);
        let mesh = match (&scene.strand, &scene.rope) {
            (Some(strand), _) => Some((1.0, strand.mesh.layers as f64, &strand.mesh)),
            (_, Some(rope)) if rope.is_slice() => Some((1.0, 1.0, &rope.mesh)),
            (_, Some(rope)) => Some((rope.strand_count() as f64, rope.mesh.layers as f64, &rope.mesh)),
            _ => None,
        };
        let (elements, nodes, mesh_bytes) = mesh.map_or((0.0, 0.0, 0.0), |(strands, layers, mesh)| {
            let section = Section::of(mesh, &brick);
            let (elements, nodes) = (strands * layers * section.cells, strands * section.nodes(layers, &brick));
            (elements, nodes, mesh_bytes(&brick, elements, nodes, section.nodes))
        });
        let (steps, step_bytes) = program(scene);
        let contact = scene.rope.as_ref().map_or(0.0, |rope| contact_bytes(scene, rope));
        Self { elements, nodes, steps, bytes: BASE + mesh_bytes + step_bytes + contact }
    }
}

/// Counts of a section.
struct Section {
    cells: f64,
    nodes: f64,
}

impl Section {
    fn of(mesh: &StrandMesh, brick: &Brick) -> Self {
        let (core, rings) = (mesh.core as f64, mesh.rings as f64);
        let (core_nodes, ring_nodes) = (brick.order * core + 1.0, 4.0 * brick.order * core);
        Self {
            cells: core * core + 4.0 * core * rings,
            nodes: core_nodes * core_nodes + ring_nodes * brick.order * rings,
        }
    }

    fn nodes(&self, layers: f64, brick: &Brick) -> f64 {
        self.nodes * (brick.order * layers + 1.0) * brick.filled
    }
}

/// Mesh, matrix and a factor that no order of elimination makes smaller than about `n sqrt(m)`, for n nodes in sections of m.
fn mesh_bytes(brick: &Brick, elements: f64, nodes: f64, section: f64) -> f64 {
    let point = 8.0 * (3.0 * brick.nodes + 10.0);
    let element = 4.0 * 1.5 * brick.nodes * brick.nodes + 4.0 * brick.nodes + brick.points * point;
    let couplings = (brick.nodes * brick.nodes * elements).min(13.0 * nodes * brick.order.powi(3));
    let factor = 8.0 * 9.0 * nodes * section.min(nodes).sqrt();
    elements * element + 4.5 * couplings * ENTRY + factor + nodes * NODE
}

/// Steps with half cycles, and their memory.
fn program(scene: &Scene) -> (f64, f64) {
    let components = 6.0 * scene.point_names().count() as f64 + 3.0 * scene.constraint.len() as f64;
    let sums = scene.step.iter().fold((0.0, 0.0), |(steps, bytes), step| {
        let parts = step.cycles.as_ref().map_or(1.0, |cycles| 2.0 * cycles.count as f64);
        let entries = step.prescribe.len() + step.force.len() + step.nodal_force.len() + step.traction.len();
        (steps + parts, bytes + parts * (components * MOTION + (1.0 + entries as f64) * STEP_ENTRY))
    });
    (sums.0, sums.1)
}

/// Points on the faces of strands that may touch.
fn contact_bytes(scene: &Scene, rope: &Rope) -> f64 {
    let pairs = if rope.is_slice() { 1.0 } else { rope.strand_count() as f64 - 1.0 };
    let layers = if rope.is_slice() { 1.0 } else { rope.mesh.layers as f64 };
    let faces = 4.0 * rope.mesh.core as f64 * layers * pairs;
    let between_strands = scene.contact.iter().filter(|contact| contact.primary.is_none());
    between_strands.map(|c| faces * (c.points[0] as f64) * (c.points[1] as f64) * CONTACT_POINT).sum()
}

/// Memory of a run of a model whose first step has been analysed \[bytes\].
#[must_use]
pub fn memory_of(model: &RopeModel) -> f64 {
    let mesh = &model.mesh.mesh;
    let (per_element, nodes) = (mesh.kind.points(), mesh.kind.nodes());
    let points = per_element * mesh.cell_count();
    let system = model.analysis.system();
    let entries = system.map_or(0, subrope_fem::System::entries);
    let solver = system.map_or(0.0, |s| s.analysis().bytes as f64);
    // Gradients, frame and volume of a point; positions in the matrix and connectivity of an element.
    let point = (8 * (3 * nodes + 10) + model.state_bytes_per_point()) as f64;
    let element = (4 * 3 * nodes * (nodes + 1) / 2 + 4 * nodes) as f64;
    let mesh_bytes = points as f64 * point + mesh.cell_count() as f64 * element + mesh.point_count() as f64 * NODE;
    BASE + mesh_bytes + VALUE * entries as f64 + solver
}

/// Memory that a run may take \[bytes\]: what the system has left, or a fixed bound where it does not tell.
#[must_use]
pub fn limit() -> f64 {
    subrope_io::available_memory().map_or(UNKNOWN_SYSTEM, |bytes| bytes as f64)
}

/// Memory that a model may take which this process holds in part already \[bytes\].
#[must_use]
pub fn limit_with_held() -> f64 {
    limit() + subrope_io::resident_memory().map_or(0.0, |bytes| bytes as f64)
}

/// Refuses what needs more memory than there is.
///
/// # Errors
/// [`ModelError::TooLarge`].
pub fn refuse_beyond(what: impl FnOnce() -> String, needed: f64, available: f64) -> Result<(), ModelError> {
    // A size that is no number is no size.
    if needed <= available {
        return Ok(());
    }
    Err(ModelError::TooLarge { what: what(), needed_gb: needed / 1e9, available_gb: available / 1e9 })
}

/// Memory for a byte of a deck while it is read, at least: numbers, labels, their index \[bytes\].
const DECK_BYTE: f64 = 4.0;

/// Refuses a deck that cannot be read into the memory at hand; `bytes` is the length of its file.
///
/// # Errors
/// [`ModelError::TooLarge`].
pub fn refuse_deck(bytes: u64) -> Result<(), ModelError> {
    refuse_beyond(|| format!("{} MB of the deck", bytes >> 20), BASE + DECK_BYTE * bytes as f64, limit())
}

/// Refuses a mesh that has been read and of which no model fits.
///
/// # Errors
/// [`ModelError::TooLarge`].
pub fn refuse_mesh(formulation: Formulation, elements: usize, nodes: usize) -> Result<(), ModelError> {
    let what = || format!("{elements} elements with {nodes} nodes");
    // A slender body has a small factor: nothing is known of it here.
    refuse_beyond(what, BASE + mesh_bytes(&Brick::of(formulation), elements as f64, nodes as f64, 0.0), limit())
}

/// Refuses a scene whose model or steps cannot fit.
///
/// # Errors
/// [`ModelError::TooLarge`].
pub fn refuse_scene(scene: &Scene) -> Result<(), ModelError> {
    let size = SizeEstimate::of(scene);
    let what = || format!("{} elements with {} nodes in {} steps", size.elements, size.nodes, size.steps);
    refuse_beyond(what, size.bytes, limit())
}
