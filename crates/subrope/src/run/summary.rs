//! The summary of a run.

use std::collections::BTreeMap;

use serde::Serialize;
use subrope_fem::analysis::Phase;
use subrope_fem::kinematics::NodeRule;
use subrope_fem::{FemError, LineBending};

use super::clock::Reading;
use super::cycles::CycleRow;
use super::findings::{Findings, PeakDensities};
use super::line_load::{self, AnalyticLineLoad, ContactLine, LineLoadSummary, contact_lines};
use super::strands::{self, StrandSummary};
use crate::contact::{self, PairSummary};
use crate::model::RopeModel;
use crate::plan::Plan;
use crate::scene::SceneFile;
use crate::sizing::{RopeSizing, SizingSummary};

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "state", content = "cause")]
pub enum Status {
    /// All steps.
    Done,
    /// By the user; results up to then are complete.
    Interrupted,
    /// No equilibrium; results up to the last converged increment.
    NotConverged(String),
}

impl Status {
    pub(super) fn of(outcome: &Result<(), FemError>) -> Self {
        match outcome {
            Ok(()) => Self::Done,
            Err(FemError::Interrupted) => Self::Interrupted,
            Err(cause) => Self::NotConverged(cause.to_string()),
        }
    }
}

/// Numbers of a run; units in the names.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Title of the scene.
    pub title: String,
    /// How it ended.
    pub status: Status,
    /// Time reached in the scene \[s\].
    pub time_s: f64,
    /// What the mesh stands for, where it is a slice of a rope.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<SymmetrySummary>,
    /// Motions and reactions of the reference points.
    pub reference_points: BTreeMap<String, PointSummary>,
    /// Energies.
    pub energies: EnergySummary,
    /// Contacts, where there are any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<PairSummary>,
    /// Load along the contact lines of generated strands, in the order of `contacts`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub line_loads: Vec<LineLoadSummary>,
    /// What a closed form gives for the lines of a straight rope without core.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub analytic_line_load: Option<AnalyticLineLoad>,
    /// What each strand of a rope carries, stores and loses.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub strands: Vec<StrandSummary>,
    /// Cycle by cycle, where there are cycles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cycles: Vec<CycleRow>,
    /// Largest densities of dissipation, where strands slide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_densities: Option<PeakDensities>,
    /// Findings on a bent strand, where there is one.
    pub findings: Option<Findings>,
    /// What is given of a rope and what follows, where it is sized.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizing: Option<SizingSummary>,
    /// What the run used and left out.
    pub plan: Plan,
    /// Sizes.
    pub size: SizeSummary,
    /// Counts of increments and iterations.
    pub counts: CountSummary,
    /// Wall-clock time per phase \[s\].
    pub seconds: SecondsSummary,
    /// Largest resident memory \[MB\].
    pub peak_memory_mb: Option<f64>,
    /// Version of the program.
    pub version: &'static str,
    /// SHA-256 of the scene and its deck.
    pub scene_hash: String,
}

/// What a slice stands for. Forces, torques, energies and the sums of a pair are those of the whole rope, without ends.
#[derive(Clone, Debug, Serialize)]
pub struct SymmetrySummary {
    /// "helical".
    pub kind: &'static str,
    /// Strands of the rope.
    pub strands: usize,
    /// Layers in its length.
    pub layers: usize,
    /// Height of a layer at rest.
    pub height_mm: f64,
    /// Its turn at rest.
    pub turn_degrees: f64,
    /// Force on the node that is held along z, and its tangential force: both balance and say how well.
    pub held_reaction_n: [f64; 2],
}

/// A reference point at the end.
#[derive(Clone, Debug, Serialize)]
pub struct PointSummary {
    /// Displacement.
    pub displacement_mm: [f64; 3],
    /// Rotation vector.
    pub rotation_rad: [f64; 3],
    /// Reaction force.
    pub force_n: [f64; 3],
    /// Reaction moment about its current position.
    pub moment_n_mm: [f64; 3],
    /// How far each strand has slid outwards, at a sliding end; the force along it is zero.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub slides_mm: Vec<f64>,
}

/// Energies at the end.
#[derive(Clone, Debug, Serialize)]
pub struct EnergySummary {
    /// Work of reactions and loads, trapezoidal rule.
    pub external_work_mj: f64,
    /// Stored.
    pub stored_mj: f64,
    /// Of it in the bending of rope-yarns, where they have a stiffness of their own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stored_in_yarn_bending_mj: Option<f64>,
    /// Dissipated by transverse sliding, end values as in the fields.
    pub dissipated_transverse_mj: f64,
    /// Dissipated by longitudinal sliding, end values as in the fields.
    pub dissipated_longitudinal_mj: f64,
    /// Mid-point values: second order in the increment, used in the balance.
    pub dissipated_transverse_midpoint_mj: f64,
    /// Mid-point values: second order in the increment, used in the balance.
    pub dissipated_longitudinal_midpoint_mj: f64,
    /// Spent by viscous stabilisation.
    pub stabilising_mj: f64,
    /// Dissipated by friction of contacts, mid-point values.
    pub contact_friction_mj: f64,
    /// Stored in the compliance of contacts.
    pub contact_stored_mj: f64,
    /// Put in by pressing apart surfaces that overlapped at the start; part of the external work.
    pub interference_mj: f64,
    /// External work less everything else, over the external work.
    pub energy_error: f64,
    /// Released in snaps, as far as increments are short enough to tell, less what appeared; part of the energy error.
    pub released_mj: f64,
    /// What the balances of all other increments leave open, added up without sign: where it is much beside the work,
    /// increments are too long to tell a snap.
    pub open_mj: f64,
}

/// Sizes.
#[derive(Clone, Debug, Serialize)]
pub struct SizeSummary {
    /// Elements.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Unknowns of the last step.
    pub unknowns: usize,
    /// Stored entries of the tangent.
    pub matrix_entries: usize,
    /// Entries of its factor.
    pub factor_entries: f64,
    /// Operations of one factorisation.
    pub factor_flops: f64,
    /// Ordering chosen.
    pub ordering: String,
    /// Whether the tangent is symmetric.
    pub symmetric: bool,
    /// Bytes of state per integration point.
    pub state_bytes_per_point: usize,
    /// Threads.
    pub threads: usize,
}

/// Counts.
#[derive(Clone, Debug, Serialize)]
pub struct CountSummary {
    /// Converged increments.
    pub increments: usize,
    /// Newton iterations, those of failed attempts included.
    pub iterations: usize,
    /// Failed attempts.
    pub cutbacks: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Iterations of GMRES.
    pub linear_iterations: usize,
    /// Rounds in which an augmented Lagrangian moved its multipliers.
    pub augmentations: usize,
    /// Patterns made anew because surfaces touched elsewhere.
    pub searches: usize,
    /// Converged increments whose tangent has negative pivots: unstable equilibria.
    pub unstable_increments: usize,
    /// Converged increments at which the number of negative pivots changed: limit and bifurcation points.
    pub inertia_changes: usize,
    /// Converged increments with a snap.
    pub jumps: usize,
    /// Converged increments found by minimising the incremental potential.
    pub minimised: usize,
    /// Converged increments that left an unstable branch for one that forks off it.
    pub switched: usize,
    /// Converged increments that Newton's method found by way of softened contacts.
    pub smoothed: usize,
}

/// What took how long.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elapsed {
    /// Everything from opening the files \[s\].
    pub total: f64,
    /// All steps.
    pub solving: Reading,
    /// Writing checkpoints \[s\]; part of the others.
    pub checkpoints: f64,
}

/// Wall-clock time; `solving_cpu` apart.
#[derive(Clone, Debug, Serialize)]
pub struct SecondsSummary {
    /// Everything from opening the files.
    pub total: f64,
    /// All steps, from the analysis of the first to the end of the last: without making the mesh and this summary.
    pub solving: f64,
    /// The same as time that all threads had a processor, where the system tells it.
    pub solving_cpu: Option<f64>,
    /// Pattern, ordering, symbolic factorisation.
    pub analysis: f64,
    /// Search for faces that may touch.
    pub search: f64,
    /// Laws, elements, assembly.
    pub assembly: f64,
    /// Factorisation.
    pub factorisation: f64,
    /// Solves.
    pub solution: f64,
    /// Writing checkpoints, part of `solving`.
    pub checkpoints: f64,
}

impl Summary {
    pub(super) fn new(
        file: &SceneFile,
        model: &RopeModel,
        status: Status,
        cycles: &[CycleRow],
        elapsed: Elapsed,
    ) -> Self {
        let analysis = &model.analysis;
        let mesh = &model.mesh.mesh;
        Self {
            title: file.scene.title.clone(),
            status,
            time_s: analysis.time(),
            symmetry: symmetry(model),
            reference_points: points(model),
            energies: energies(model),
            contacts: contact::summaries(&model.mesh, analysis),
            line_loads: contact_lines(model).iter().map(ContactLine::summary).collect(),
            analytic_line_load: line_load::analytic(model),
            strands: strands::strands(&model.mesh, analysis),
            cycles: cycles.to_vec(),
            peak_densities: PeakDensities::new(analysis),
            findings: Findings::new(mesh, analysis),
            sizing: RopeSizing::of(&file.scene).map(|sizing| sizing.summary()),
            plan: Plan::new(&file.scene, model),
            size: sizes(model),
            counts: counts(model),
            seconds: times(model, elapsed),
            peak_memory_mb: subrope_io::peak_memory().map(|bytes| bytes as f64 / 1e6),
            version: env!("CARGO_PKG_VERSION"),
            scene_hash: file.hash.clone(),
        }
    }

    /// One sentence of physics.
    #[must_use]
    pub fn sentence(&self) -> String {
        let e = &self.energies;
        let mut parts: Vec<String> = Vec::new();
        for (name, p) in &self.reference_points {
            let (force, moment) = (norm(&p.force_n), norm(&p.moment_n_mm));
            parts.push(format!("{name} carries {} N and {} N mm", number(force), number(moment)));
        }
        let slid = e.dissipated_transverse_mj + e.dissipated_longitudinal_mj;
        let (work, stored) = (number(e.external_work_mj), number(e.stored_mj));
        let energy = if slid > 0.0 {
            let (across, along) = (number(e.dissipated_transverse_mj), number(e.dissipated_longitudinal_mj));
            let slid = number(slid);
            format!(
                "of {work} mJ put in, {stored} mJ are stored and {slid} mJ lost to sliding between rope-yarns ({across} \
                 across, {along} along them)"
            )
        } else {
            format!("of {work} mJ put in, {stored} mJ are stored and nothing is lost to sliding")
        };
        parts.push(energy);
        if !self.contacts.is_empty() {
            let normal: f64 = self.contacts.iter().map(|c| c.normal_force_n).sum();
            let friction = number(e.contact_friction_mj);
            let mut contacts = format!("contacts press with {} N and lose {friction} mJ to friction", number(normal));
            if e.contact_stored_mj > NOTABLE * e.external_work_mj.abs() {
                contacts += &format!(", {} mJ are stored in their compliance", number(e.contact_stored_mj));
            }
            parts.push(contacts);
        }
        format!(
            "At {} s: {}; energy balance off by {:.1e} of the work.",
            number(self.time_s),
            parts.join("; "),
            e.energy_error
        )
    }
}

/// Part of the work put in from which energy stored in contacts is told.
const NOTABLE: f64 = 1e-4;

/// Four digits that matter; less than a millionth is nothing.
fn number(value: f64) -> String {
    if value.abs() < 1e-6 {
        return "0".into();
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6);
    format!("{value:.*}", digits as usize)
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn symmetry(model: &RopeModel) -> Option<SymmetrySummary> {
    let slice = model.mesh.slice?;
    let NodeRule::Free { first } = model.analysis.model().kinematics.rules()[slice.held as usize] else { return None };
    let held = &model.analysis.reactions()[first as usize..][..3];
    Some(SymmetrySummary {
        kind: "helical",
        strands: slice.strands,
        layers: slice.layers,
        height_mm: slice.height,
        turn_degrees: slice.angle.to_degrees(),
        held_reaction_n: [held[2], held[1]],
    })
}

fn points(model: &RopeModel) -> BTreeMap<String, PointSummary> {
    let analysis = &model.analysis;
    let kinematics = &analysis.model().kinematics;
    let all = kinematics.points().iter().enumerate().map(|(index, point)| {
        let (u, r) = kinematics.point_motion(index, analysis.coordinates());
        let (force, moment) = analysis.point_reaction(index);
        let summary = PointSummary {
            displacement_mm: u.into(),
            rotation_rad: r.into(),
            force_n: force.into(),
            moment_n_mm: moment.into(),
            slides_mm: point.slides.iter().map(|&c| analysis.coordinates()[c as usize]).collect(),
        };
        (point.name.clone(), summary)
    });
    all.collect()
}

fn energies(model: &RopeModel) -> EnergySummary {
    let t = model.analysis.totals();
    EnergySummary {
        external_work_mj: t.external_work,
        stored_mj: t.stored,
        stored_in_yarn_bending_mj: model.yarn_bending().map(LineBending::stored),
        dissipated_transverse_mj: t.dissipated[0],
        dissipated_longitudinal_mj: t.dissipated[1],
        dissipated_transverse_midpoint_mj: t.dissipated_mid[0],
        dissipated_longitudinal_midpoint_mj: t.dissipated_mid[1],
        stabilising_mj: t.stabilising,
        contact_friction_mj: t.contact_friction,
        contact_stored_mj: t.contact_stored,
        interference_mj: t.interference,
        energy_error: t.energy_error(),
        released_mj: t.released,
        open_mj: t.open,
    }
}

fn sizes(model: &RopeModel) -> SizeSummary {
    let system = model.analysis.system();
    let report = system.map(subrope_fem::System::analysis);
    SizeSummary {
        elements: model.mesh.mesh.cell_count(),
        nodes: model.mesh.mesh.point_count(),
        unknowns: system.map_or(0, |s| s.equations().len()),
        matrix_entries: system.map_or(0, subrope_fem::System::entries),
        factor_entries: report.map_or(0.0, |r| r.fill.nonzeros),
        factor_flops: report.map_or(0.0, |r| r.fill.flops),
        ordering: report.map_or_else(String::new, |r| r.ordering.name().to_string()),
        symmetric: system.is_none_or(subrope_fem::System::is_symmetric),
        state_bytes_per_point: model.state_bytes_per_point(),
        threads: model.analysis.threads(),
    }
}

fn counts(model: &RopeModel) -> CountSummary {
    let t = model.analysis.totals();
    CountSummary {
        increments: t.increments,
        iterations: t.iterations,
        cutbacks: t.cutbacks,
        factorisations: t.factorisations,
        linear_iterations: t.linear_iterations,
        augmentations: t.augmentations,
        searches: t.searches,
        unstable_increments: t.unstable_increments,
        inertia_changes: t.inertia_changes,
        jumps: t.jumps,
        minimised: t.minimised,
        switched: t.switched,
        smoothed: t.smoothed,
    }
}

fn times(model: &RopeModel, elapsed: Elapsed) -> SecondsSummary {
    let phase = |p: Phase| model.analysis.phases().times[p as usize].as_secs_f64();
    SecondsSummary {
        total: elapsed.total,
        solving: elapsed.solving.wall,
        solving_cpu: elapsed.solving.cpu,
        analysis: phase(Phase::Analysis),
        search: phase(Phase::Search),
        assembly: phase(Phase::Assembly),
        factorisation: phase(Phase::Factorisation),
        solution: phase(Phase::Solution),
        checkpoints: elapsed.checkpoints,
    }
}
