//! What a scene amounts to before anything is solved: counts, mesh quality, yarn angles, cost and memory.

use std::fmt;

use nalgebra::Vector3;
use subrope_geometry::quality::{AngleStatistics, MeshQuality, fibre_angles, mesh_quality};
use subrope_io::Ignored;

use crate::Error;
use crate::estimate;
use crate::model::{ModelError, RopeModel, SliceShape};
use crate::plan::Plan;
use crate::scene::SceneFile;
use crate::sizing::{RopeSizing, SizingSummary};

/// What a scene amounts to.
#[derive(Clone, Debug)]
pub struct CheckReport {
    /// Elements.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Integration points.
    pub points: usize,
    /// Worst cells and volume.
    pub quality: Option<MeshQuality>,
    /// Volume of the smooth strand \[mm^3\], for a generated one.
    pub exact_volume: Option<f64>,
    /// Angles between yarns and the z axis.
    pub angles: Option<AngleStatistics>,
    /// Size of the first step's system.
    pub system: SystemSize,
    /// Bytes of state per integration point, committed and trial; 0 for an elastic law.
    pub state_bytes_per_point: usize,
    /// Estimate of the largest memory of a run \[MB\].
    pub memory_mb: f64,
    /// What a run uses and leaves out.
    pub plan: Plan,
    /// What the mesh stands for, where it is a slice of a rope.
    pub slice: Option<SliceShape>,
    /// What is given of a rope and what follows, where it is sized.
    pub sizing: Option<SizingSummary>,
    /// Keywords of the deck that were not read.
    pub ignored: Vec<Ignored>,
}

/// Size of a sparse system.
#[derive(Clone, Debug)]
pub struct SystemSize {
    /// Unknowns.
    pub unknowns: usize,
    /// Stored entries of the matrix.
    pub entries: usize,
    /// Entries of the factor.
    pub factor_entries: f64,
    /// Operations of a factorisation.
    pub factor_flops: f64,
    /// Ordering.
    pub ordering: String,
    /// Whether the matrix is symmetric.
    pub symmetric: bool,
}

/// Builds the model of a scene and analyses its first step, without solving.
///
/// # Errors
/// As a run before its first increment: [`Error::Scene`], [`Error::Model`], and [`Error::Run`] for rigid motions that
/// nothing holds.
pub fn check_scene(file: &SceneFile) -> Result<CheckReport, Error> {
    let mut model = RopeModel::new(file, None)?;
    model.check_steps()?;
    model.check_memory()?;
    let sizing = RopeSizing::of(&file.scene).map(|sizing| sizing.summary());
    let plan = Plan::new(&file.scene, &model);
    report(model, plan, sizing).map_err(Error::Model)
}

fn report(model: RopeModel, plan: Plan, sizing: Option<SizingSummary>) -> Result<CheckReport, ModelError> {
    let mesh = &model.mesh.mesh;
    let state_bytes_per_point = model.state_bytes_per_point();
    let points = model.mesh.frames.len();
    Ok(CheckReport {
        elements: mesh.cell_count(),
        nodes: mesh.point_count(),
        points,
        quality: mesh_quality(mesh)?,
        exact_volume: model.mesh.exact_volume(),
        angles: (points > 0).then(|| fibre_angles(mesh, &model.mesh.frames, &Vector3::z())).transpose()?,
        system: system_size(&model),
        state_bytes_per_point,
        memory_mb: estimate::memory_of(&model) / 1e6,
        plan,
        slice: model.mesh.slice,
        sizing,
        ignored: model.ignored,
    })
}

fn system_size(model: &RopeModel) -> SystemSize {
    let system = model.analysis.system();
    let analysis = system.map(subrope_fem::System::analysis);
    SystemSize {
        unknowns: system.map_or(0, |s| s.equations().len()),
        entries: system.map_or(0, subrope_fem::System::entries),
        factor_entries: analysis.map_or(0.0, |a| a.fill.nonzeros),
        factor_flops: analysis.map_or(0.0, |a| a.fill.flops),
        ordering: analysis.map_or_else(String::new, |a| a.ordering.name().to_string()),
        symmetric: system.is_none_or(subrope_fem::System::is_symmetric),
    }
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  size     {} elements, {} nodes, {} integration points", self.elements, self.nodes, self.points)?;
        if let Some(SliceShape { strands, layers, angle, height, .. }) = &self.slice {
            writeln!(
                f,
                "  symmetry helical: one layer of one strand, {height:.4} mm high and turned by {:.4} degrees, stands for \
                 {strands} strands of {layers} layers; the ends of the rope are not modelled, their `kind` has no effect",
                angle.to_degrees()
            )?;
        }
        if let Some(q) = &self.quality {
            writeln!(
                f,
                "  quality  least scaled Jacobian {:.3} (element {}), largest aspect ratio {:.2} (element {})",
                q.least_scaled_jacobian.value,
                q.least_scaled_jacobian.cell_label,
                q.largest_aspect_ratio.value,
                q.largest_aspect_ratio.cell_label
            )?;
            match self.exact_volume {
                Some(exact) => {
                    let off = 100.0 * (q.volume / exact - 1.0);
                    writeln!(f, "  volume   {:.2} mm^3, {off:+.2} % from the smooth strand", q.volume)?;
                }
                None => writeln!(f, "  volume   {:.2} mm^3", q.volume)?,
            }
        }
        if let Some(a) = &self.angles {
            let [least, mean, greatest] = [a.least, a.mean, a.greatest].map(f64::to_degrees);
            writeln!(
                f,
                "  yarns    {least:.2} to {greatest:.2} degrees from the z axis at the integration points, mean {mean:.2}"
            )?;
        }
        let s = &self.system;
        let matrix = if s.symmetric { "symmetric" } else { "unsymmetric" };
        writeln!(
            f,
            "  system   {} unknowns, {matrix}, {:.2} GFLOP per factorisation",
            s.unknowns,
            s.factor_flops / 1e9
        )?;
        writeln!(f, "  memory   about {:.0} MB", self.memory_mb)?;
        write!(f, "  plan\n{}", self.plan)?;
        if let Some(sizing) = &self.sizing {
            for (i, line) in sizing.to_string().lines().enumerate() {
                writeln!(f, "  {:<8} {line}", if i == 0 { "sizing" } else { "" })?;
            }
        }
        Ok(())
    }
}
