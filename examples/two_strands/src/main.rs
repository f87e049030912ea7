//! Two strands of unequal size, laid together in frictional contact and pulled by 1 %. Units: mm, N, MPa, mJ.

use std::f64::consts::PI;

use subrope_contact::{Contact, ContactOptions, Smoothing, Surface, contacts};
use subrope_fem::analysis::{Analysis, Increments, Model, NewtonOptions, PathControl, Silent, Step};
use subrope_fem::kinematics::{Kinematics, Section as EndSection};
use subrope_fem::linear::SolverOptions;
use subrope_fem::solid::{Full, SolidBlock, SolidMesh};
use subrope_geometry::{Axis, CellKind, GeometryError, Handedness, Helix, Hex8, Lay, RopeFibres, Section, Strand};
use subrope_geometry::{fibre_frames, join_strands, touching_pair};
use subrope_material::{BundleLaw, BundleParameters, Compaction, Friction, ModeParameters, transverse_modulus};

const LENGTH: f64 = 24.0;
const RADII: [f64; 2] = [2.0, 1.3];

/// Two right-handed helices opposite to each other; the yarns of each strand turn against them, 20 deg at its surface.
fn strands() -> Result<Vec<Strand>, GeometryError> {
    let lay = Lay::from_lay_length(48.0, Handedness::Right)?;
    let section = Section { core_cells: 4, rings: 1, ..Section::default() };
    // In contact is the smooth surface through the nodes, whose radius is a little smaller than that of the strand.
    let smooth = |radius| Ok(section.mesh(radius, CellKind::Hex8)?.smooth_radius());
    let helix_radii = touching_pair([smooth(RADII[0])?, smooth(RADII[1])?], lay)?;
    let strand = |i: usize| {
        let helix = Helix::new(Axis::default(), helix_radii[i], lay, PI * i as f64)?;
        let yarns = Lay::from_angle(RADII[i], PI / 9.0, Handedness::Left)?;
        Ok(Strand { radius: RADII[i], section, layers: 12, lay: yarns, ..Strand::on_helix(helix, LENGTH) })
    };
    Ok(vec![strand(0)?, strand(1)?])
}

/// Rope-yarns slide along each other at 1 MPa, and across at .05 MPa.
fn law() -> Result<BundleLaw, subrope_material::LawError> {
    BundleLaw::new(BundleParameters {
        k_e: 2000.0,
        k_ec: 100.0,
        w_e: 0.005,
        k_c: 60.0,
        nu: 0.5,
        compaction: Compaction::Quadratic,
        transverse: ModeParameters::sliding(15.0, Friction::isotropic(0.05, 0.1)),
        longitudinal: ModeParameters::sliding(20.0, Friction::isotropic(1.0, 0.3)),
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Mesh: the strands as one, their ends END_A (below) and END_B, the surfaces LATERAL_1 and LATERAL_2.
    let strands = strands()?;
    let (mesh, _) = join_strands(&strands)?;
    let frames = fibre_frames(&mesh, &RopeFibres::new(&strands))?;
    let solid = SolidMesh { positions: &mesh.points, cells: &mesh.cells, labels: &mesh.cell_labels, frames: &frames };
    let bricks = SolidBlock::<8, _, Full>::new::<Hex8>(&solid, law()?)?;

    // Contact, its penalty from the stiffness across the yarns and the size of the thin strand.
    let surface = |name: &str| Surface::new(&mesh, &mesh.surfaces[name], Smoothing::Spline);
    let base = ContactOptions::new(transverse_modulus(&law()?)?, RADII[1]);
    let options = ContactOptions { friction: 0.15, tangential_penalty: 0.1 * base.penalty, ..base };
    let pair = Contact::new("pair", surface("LATERAL_1")?, surface("LATERAL_2")?, &mesh.points, options)?;

    // Both ends follow points on the axis of the rope, rigidly. One stays, the other goes up without turning.
    let end = |name: &str, z| EndSection::rigid(name, Axis::default().position(0.0, 0.0, z), &mesh.node_sets[name]);
    let sections = vec![end("END_A", -0.5 * LENGTH), end("END_B", 0.5 * LENGTH)];
    let kinematics = Kinematics::new(mesh.points.clone(), sections)?;
    let increments = Increments::Automatic {
        control: PathControl::Load,
        initial: 0.05,
        minimum: 1e-5,
        maximum: 0.2,
        max_count: 500,
    };
    let (low, high) = (&kinematics.points()[0], &kinematics.points()[1]);
    let pull = Step::new("pull", increments).hold(low).hold(high).prescribe(high.first + 2, 0.01 * LENGTH);

    let model = Model { kinematics, contributions: vec![Box::new(bricks), Box::new(pair)] };
    let mut analysis = Analysis::new(model, NewtonOptions::default(), SolverOptions::default(), 1);
    analysis.run_step(&pull, &mut Silent)?;

    let (force, moment) = analysis.point_reaction(1);
    println!("axial force {:.2} N, torque {:.2} N mm", force.z, moment.z);
    let pressing: f64 = contacts(&analysis).map(|contact| contact.report().normal).sum();
    let totals = analysis.totals();
    println!("contact: {pressing:.2} N normal force, {:.4} mJ lost to friction", totals.contact_friction);
    println!("energy balance off by {:.1e} of the work", totals.energy_error());
    Ok(())
}
