//! Fields of the result file: nodal values, and element means weighted by reference volume.

use nalgebra::Vector3;
use subrope_fem::FemError;
use subrope_fem::analysis::Analysis;
use subrope_fem::solid::{PointSample, SolidFields};
use subrope_material::StateKind;

use super::contacts::{self, ContactField};
use crate::model::{ContactCells, MeshModel};
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
    Strand,
}

impl Content {
    /// Whether it comes from the integration points of the solid.
    fn is_sampled(self) -> bool {
        !matches!(self, Self::Displacement | Self::Reaction | Self::Contact(_) | Self::Strand)
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
            element("contact_pressure", 1, C::Contact(ContactField::Pressure)),
            element("contact_friction_work", 1, C::Contact(ContactField::FrictionWork)),
            element("contact_slip", 1, C::Contact(ContactField::Slip)),
        ],
    }
}

/// The arrays that a scene asks for and its law, mesh and contacts have.
pub fn arrays(fields: &[Field], mesh: &MeshModel, analysis: &Analysis) -> Vec<FieldArray> {
    let solid = solid(analysis);
    let exists = |array: &FieldArray| match array.content {
        Content::State(kind) => solid.is_some_and(|s| s.state_variables().iter().any(|v| v.kind == kind)),
        Content::Contact(_) => contacts::contacts(analysis).next().is_some(),
        Content::Strand => mesh.rope.is_some(),
        _ => true,
    };
    fields.iter().flat_map(|&f| arrays_of(f)).filter(exists).collect()
}

fn solid(analysis: &Analysis) -> Option<&dyn SolidFields> {
    analysis.model().contributions.iter().find_map(|c| c.fields())
}

/// Values of all arrays at the committed state, component running fastest.
///
/// # Errors
/// As an evaluation of the law at the committed state.
pub fn values(
    arrays: &[FieldArray],
    mesh: &MeshModel,
    cells: &[ContactCells],
    analysis: &Analysis,
) -> Result<Vec<Vec<f64>>, FemError> {
    // Nodes of rigid bodies stand behind those of the mesh.
    let nodal = 3 * mesh.mesh.point_count();
    let mut out: Vec<Vec<f64>> = arrays
        .iter()
        .map(|a| match a.content {
            Content::Displacement => analysis.displacement()[..nodal].to_vec(),
            Content::Reaction => tied_only(analysis)[..nodal].to_vec(),
            Content::Contact(kind) => contacts::field(kind, &mesh.mesh, analysis, cells),
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
        Content::Displacement | Content::Reaction | Content::Contact(_) | Content::Strand => {}
    }
}

/// Reactions where something holds the node; exactly zero elsewhere, where only the residual is left.
fn tied_only(analysis: &Analysis) -> Vec<f64> {
    use subrope_fem::kinematics::NodeRule;
    let mut out = analysis.nodal_reactions();
    for (node, rule) in analysis.model().kinematics.rules().iter().enumerate() {
        if let NodeRule::Free { first } = rule {
            for k in 0..3 {
                if !analysis.is_prescribed(*first as usize + k) {
                    out[3 * node + k] = 0.0;
                }
            }
        }
    }
    out
}
