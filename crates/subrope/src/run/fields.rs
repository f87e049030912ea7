//! Fields of the result file: nodal values, and element means weighted by reference volume.

use nalgebra::Vector3;
use subrope_fem::FemError;
use subrope_fem::analysis::Analysis;
use subrope_fem::solid::{PointSample, SolidFields};
use subrope_material::StateKind;

use crate::contact::{self, ContactField};
use crate::model::{ContactCells, MeshModel, RopeModel};
use crate::scene::Field;

/// Where a field lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// At the nodes.
    Node,
    /// In the elements.
    Element,
}

/// What a written array holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Displacement,
    Reaction,
    Stress,
    Elongation,
    Compaction,
    Distortion,
    LongitudinalShear,
    State(StateKind),
    Fibre,
    Contact(ContactField),
    Cycle(CycleField),
    Strand,
}

/// What was lost during a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CycleField {
    /// To a sliding mode: 0 transverse, 1 longitudinal.
    Sliding(usize),
    /// To friction of contacts.
    Friction,
}

/// What had been lost where when a cycle began, mid-point values.
pub struct CycleStart {
    /// To each sliding mode in every element \[mJ\].
    sliding: Vec<[f64; 2]>,
    /// To friction at every point of every contact \[mJ/mm^2\].
    friction: Vec<Vec<f64>>,
}

impl CycleStart {
    /// Notes the committed state.
    pub fn new(analysis: &Analysis) -> Self {
        let elements = solid(analysis).into_iter();
        let sliding = elements.flat_map(|s| (0..s.element_count()).map(move |e| s.element_energies(e).dissipated_mid));
        Self { sliding: sliding.collect(), friction: contact::friction_work(analysis) }
    }

    /// Both, to be kept.
    pub fn parts(&self) -> (&[[f64; 2]], &[Vec<f64>]) {
        (&self.sliding, &self.friction)
    }

    /// From what was kept.
    pub fn of_parts(sliding: Vec<[f64; 2]>, friction: Vec<Vec<f64>>) -> Self {
        Self { sliding, friction }
    }
}

impl Content {
    /// Whether it comes from the integration points of the solid.
    fn is_sampled(self) -> bool {
        !matches!(self, Self::Displacement | Self::Reaction | Self::Contact(_) | Self::Cycle(_) | Self::Strand)
    }
}

/// An array of the result file.
#[derive(Clone, Copy, Debug)]
pub struct FieldArray {
    /// Name in the file.
    pub name: &'static str,
    /// Nodes or elements.
    pub place: Place,
    /// Components.
    pub components: usize,
    content: Content,
}

const fn node(name: &'static str, components: usize, content: Content) -> FieldArray {
    FieldArray { name, place: Place::Node, components, content }
}

const fn element(name: &'static str, components: usize, content: Content) -> FieldArray {
    FieldArray { name, place: Place::Element, components, content }
}

fn arrays_of(field: Field) -> Vec<FieldArray> {
    use Content as C;
    match field {
        Field::Displacement => vec![node("displacement", 3, C::Displacement)],
        Field::Reactions => vec![node("reaction", 3, C::Reaction)],
        Field::Stress => vec![element("stress", 6, C::Stress)],
        Field::StrainModes => vec![
            element("elongation", 1, C::Elongation),
            element("compaction", 1, C::Compaction),
            element("distortion", 2, C::Distortion),
            element("longitudinal_shear", 2, C::LongitudinalShear),
        ],
        Field::PlasticStrains => vec![
            element("distortion_plastic", 2, C::State(StateKind::DistortionPlastic)),
            element("longitudinal_shear_plastic", 2, C::State(StateKind::LongitudinalShearPlastic)),
        ],
        Field::Dissipation => vec![
            element("dissipation_transverse", 1, C::State(StateKind::TransverseDissipation)),
            element("dissipation_longitudinal", 1, C::State(StateKind::LongitudinalDissipation)),
        ],
        Field::Fibre => vec![element("fibre", 3, C::Fibre)],
        Field::Strand => vec![element("strand", 1, C::Strand)],
        Field::Contact => vec![
            element("contact_gap", 1, C::Contact(ContactField::Gap)),
            element("contact_pressure", 1, C::Contact(ContactField::Pressure)),
            element("contact_traction", 3, C::Contact(ContactField::Traction)),
            element("contact_friction_work", 1, C::Contact(ContactField::FrictionWork)),
            element("contact_slip", 1, C::Contact(ContactField::Slip)),
        ],
        Field::Cycle => vec![
            element("dissipation_transverse_cycle", 1, C::Cycle(CycleField::Sliding(0))),
            element("dissipation_longitudinal_cycle", 1, C::Cycle(CycleField::Sliding(1))),
            element("contact_friction_work_cycle", 1, C::Cycle(CycleField::Friction)),
        ],
    }
}

/// The arrays that a scene asks for and its law, mesh, contacts and steps have.
pub fn arrays(fields: &[Field], model: &RopeModel) -> Vec<FieldArray> {
    let analysis = &model.analysis;
    let solid = solid(analysis);
    let has_state = |kind| solid.is_some_and(|s| s.state_variables().iter().any(|v| v.kind == kind));
    let (touches, cycles) = (contact::is_any(analysis), model.half_cycles.iter().any(Option::is_some));
    let exists = |array: &FieldArray| match array.content {
        Content::State(kind) => has_state(kind),
        Content::Contact(_) => touches,
        Content::Cycle(CycleField::Sliding(mode)) => cycles && has_state(MODES[mode]),
        Content::Cycle(CycleField::Friction) => cycles && touches,
        Content::Strand => model.mesh.rope.is_some(),
        _ => true,
    };
    fields.iter().flat_map(|&f| arrays_of(f)).filter(exists).collect()
}

/// Dissipation of the sliding modes, in their order.
const MODES: [StateKind; 2] = [StateKind::TransverseDissipation, StateKind::LongitudinalDissipation];

/// Whether some arrays need to know how a cycle began.
pub fn want_cycles(arrays: &[FieldArray]) -> bool {
    arrays.iter().any(|a| matches!(a.content, Content::Cycle(_)))
}

fn solid(analysis: &Analysis) -> Option<&dyn SolidFields> {
    analysis.model().contributions.iter().find_map(|c| c.fields())
}

/// Values of all arrays at the committed state, component running fastest. Without the start of a cycle nothing was lost
/// during one.
///
/// # Errors
/// As an evaluation of the law at the committed state.
pub fn values(
    arrays: &[FieldArray],
    mesh: &MeshModel,
    cells: &[ContactCells],
    analysis: &Analysis,
    cycle: Option<&CycleStart>,
) -> Result<Vec<Vec<f64>>, FemError> {
    // Nodes of rigid bodies stand behind those of the mesh.
    let nodal = 3 * mesh.mesh.point_count();
    let mut out: Vec<Vec<f64>> = arrays
        .iter()
        .map(|a| match a.content {
            Content::Displacement => analysis.displacement()[..nodal].to_vec(),
            Content::Reaction => tied_only(analysis)[..nodal].to_vec(),
            Content::Contact(kind) => contact::field(kind, &mesh.mesh, analysis, cells),
            Content::Cycle(kind) => match (cycle, kind) {
                (None, _) => vec![0.0; mesh.mesh.cell_count()],
                (Some(start), CycleField::Sliding(mode)) => sliding_since(&start.sliding, mode, analysis),
                (Some(start), CycleField::Friction) => {
                    contact::friction_work_since(&start.friction, &mesh.mesh, analysis, cells)
                }
            },
            Content::Strand => mesh.rope.iter().flat_map(|r| &r.strand_of_cell).map(|s| f64::from(s + 1)).collect(),
            _ => Vec::new(),
        })
        .collect();
    if !arrays.iter().any(|a| a.content.is_sampled()) {
        return Ok(out);
    }
    let Some(solid) = solid(analysis) else { return Ok(out) };
    let mut point = Vec::new();
    for e in 0..solid.element_count() {
        let mut volume = 0.0;
        for (array, values) in arrays.iter().zip(&mut out) {
            if array.content.is_sampled() {
                values.resize((e + 1) * array.components, 0.0);
            }
        }
        solid.sample(e, analysis.displacement(), &mut |_, sample| {
            volume += sample.volume;
            for (array, values) in arrays.iter().zip(&mut out) {
                if array.content.is_sampled() {
                    point.clear();
                    components(array.content, sample, solid, &mut point);
                    let target = &mut values[e * array.components..];
                    target.iter_mut().zip(&point).for_each(|(t, v)| *t += sample.volume * v);
                }
            }
        })?;
        for (array, values) in arrays.iter().zip(&mut out) {
            if array.content.is_sampled() {
                finish(array.content, volume, &mut values[e * array.components..]);
            }
        }
    }
    Ok(out)
}

/// Lost to a sliding mode since some earlier state, per reference volume \[mJ/mm^3\].
fn sliding_since(before: &[[f64; 2]], mode: usize, analysis: &Analysis) -> Vec<f64> {
    let Some(solid) = solid(analysis) else { return Vec::new() };
    let volume = |e: usize| (0..solid.points_per_element()).map(|q| solid.point_state(e, q).1).sum::<f64>();
    let lost = |e: usize| solid.element_energies(e).dissipated_mid[mode];
    before.iter().enumerate().map(|(e, b)| (lost(e) - b[mode]) / volume(e)).collect()
}

/// Mean, or for directions the unit vector of the mean.
fn finish(content: Content, volume: f64, values: &mut [f64]) {
    let scale = match content {
        Content::Fibre => values.iter().map(|v| v * v).sum::<f64>().sqrt(),
        _ => volume,
    };
    if scale > 0.0 {
        values.iter_mut().for_each(|v| *v /= scale);
    }
}

fn components(content: Content, sample: &PointSample<'_>, solid: &dyn SolidFields, out: &mut Vec<f64>) {
    match content {
        Content::Stress => {
            let s = &sample.cauchy_stress;
            // Order of six components in VTK: xx yy zz xy yz xz.
            out.extend([s[(0, 0)], s[(1, 1)], s[(2, 2)], s[(0, 1)], s[(1, 2)], s[(0, 2)]]);
        }
        Content::Elongation => out.push(sample.modes.elongation),
        Content::Compaction => out.push(sample.modes.compaction),
        Content::Distortion => out.extend(sample.modes.distortion),
        Content::LongitudinalShear => out.extend(sample.modes.longitudinal_shear),
        Content::State(kind) => {
            if let Some(v) = solid.state_variables().iter().find(|v| v.kind == kind) {
                out.extend_from_slice(&sample.state[v.offset..v.offset + v.components]);
            }
        }
        Content::Fibre => {
            let fibre: Vector3<f64> = sample.deformation_gradient * sample.frame.column(0);
            out.extend_from_slice(fibre.normalize().as_slice());
        }
        Content::Displacement | Content::Reaction | Content::Contact(_) | Content::Cycle(_) | Content::Strand => {}
    }
}

/// Reactions where something holds the node; exactly zero elsewhere, where only the residual is left.
fn tied_only(analysis: &Analysis) -> Vec<f64> {
    use subrope_fem::kinematics::NodeRule;
    let mut out = analysis.nodal_reactions();
    for (node, rule) in analysis.model().kinematics.rules().iter().enumerate() {
        match rule {
            NodeRule::Free { first } => {
                // With what its images hand on.
                for c in *first as usize..*first as usize + 3 {
                    let held = analysis.is_prescribed(c);
                    out[3 * node + c - *first as usize] = if held { analysis.reactions()[c] } else { 0.0 };
                }
            }
            // What acts on an image acts on its master.
            NodeRule::Image { .. } => out[3 * node..3 * node + 3].fill(0.0),
            NodeRule::Tied { .. } => {}
        }
    }
    out
}
