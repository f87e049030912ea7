//! One run of a member in memory: how far it came and what it gave, whatever becomes of it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use subrope_fem::FemError;
use subrope_fem::analysis::{Analysis, Control, IncrementRecord, Observer};

use super::Twin;
use crate::Error;
use crate::model::{MeshModel, RopeModel};
use crate::scene::Scene;

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All steps are done.
    Done,
    /// The scene is refused before anything is solved: why.
    Refused(String),
    /// No equilibrium was found: why.
    Stopped(String),
    /// The time was up.
    OutOfTime,
    /// A committed state holds a number that is not finite: which one.
    NotFinite(&'static str),
    /// The program panicked: with what.
    Panicked(String),
}

/// What a run gave at its last converged increment, in the units of its scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Part of all steps that was reached \[-\].
    pub reached: f64,
    /// Converged increments.
    pub increments: usize,
    /// Newton iterations, those of failed attempts included.
    pub iterations: usize,
    /// Failed attempts.
    pub cutbacks: usize,
    /// Estimate of the condition number of the last tangent \[-\].
    pub condition: Option<f64>,
    /// Whether the tangent is symmetric.
    pub symmetric: bool,
    /// Changes of inertia that were reported.
    pub inertia_changes: usize,
    /// Snaps that were reported.
    pub jumps: usize,
    /// Energy released in them over the largest external work \[-\].
    pub released: f64,
    /// Whether increments were reported as too long to tell a snap.
    pub unresolved: bool,
    /// What the energy balance leaves open over the largest external work \[-\].
    pub energy_error: f64,
    /// Nodal displacements \[mm\].
    pub displacement: Vec<f64>,
    /// Forces on the reference points \[N\], and moments over the size of the body \[N\].
    pub forces: Vec<f64>,
    /// External work, stored and dissipated energies \[mJ\].
    pub energies: Vec<f64>,
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// How it ended.
    pub ended: Ended,
    /// What it gave.
    pub measured: Measured,
}

impl Run {
    fn refused(cause: Error) -> Self {
        Self { ended: Ended::Refused(one_line(&cause.plain())), measured: Measured::default() }
    }

    /// Runs a scene in other units on one thread. It does not panic: a panic inside is what the run ended with.
    #[must_use]
    pub fn of(text: &str, twin: Twin, time_limit: f64, interrupt: Option<&AtomicBool>) -> Self {
        let run = || match Scene::from_toml("member", text) {
            Ok(scene) => Self::of_scene(&scene, twin, time_limit, interrupt),
            Err(error) => Self::refused(error.into()),
        };
        catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|payload| {
            let text = payload.downcast_ref::<String>().cloned();
            let text = text.or_else(|| payload.downcast_ref::<&str>().map(|s| (*s).to_owned()));
            Self { ended: Ended::Panicked(text.unwrap_or_default()), measured: Measured::default() }
        })
    }

    fn of_scene(scene: &Scene, twin: Twin, time_limit: f64, interrupt: Option<&AtomicBool>) -> Self {
        let scene = match twin.of(scene) {
            Ok(scene) => scene,
            Err(error) => return Self { ended: Ended::Refused(error.to_string()), measured: Measured::default() },
        };
        let model = MeshModel::new(&scene, None).and_then(|(mut mesh, _)| {
            mesh.shift(twin.shift());
            RopeModel::from_mesh(&scene, mesh, Some(1))
        });
        let mut model = match model {
            Ok(model) => model,
            Err(error) => return Self::refused(error.into()),
        };
        let end = Instant::now() + Duration::from_secs_f64(time_limit);
        let mut watch = Watch { end, late: false, unfinite: None, reached: (0, 0.0), interrupt };
        let outcome = model.steps.iter().try_for_each(|step| model.analysis.run_step(step, &mut watch));
        let ended = match (outcome, watch.unfinite) {
            (_, Some(what)) => Ended::NotFinite(what),
            (Err(FemError::Interrupted), _) if watch.late => Ended::OutOfTime,
            (Err(error), _) => Ended::Stopped(one_line(&error.to_string())),
            (Ok(()), _) => Ended::Done,
        };
        let measured = measure(&mut model, watch.reached, ended == Ended::Done);
        Self { ended, measured }
    }
}

fn one_line(text: &str) -> String {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|l| !l.is_empty()).collect();
    lines.join(" ").trim_start_matches("error: ").to_owned()
}

fn measure(model: &mut RopeModel, (steps, fraction): (usize, f64), done: bool) -> Measured {
    let count = model.steps.len().max(1) as f64;
    let condition = model.analysis.condition();
    let analysis = &model.analysis;
    let totals = *analysis.totals();
    let size = subrope_geometry::extent(&model.mesh.mesh.points);
    let points = analysis.model().kinematics.points().len();
    let resultants = (0..points).map(|index| analysis.point_reaction(index));
    let forces = resultants.flat_map(|(force, moment)| {
        let arm = moment / size;
        [force.x, force.y, force.z, arm.x, arm.y, arm.z]
    });
    let [transverse, longitudinal] = totals.dissipated;
    let (stored, contact) = (totals.stored, totals.contact_stored);
    let scale = if totals.work_scale > 0.0 { totals.work_scale } else { 1.0 };
    Measured {
        reached: if done { 1.0 } else { (steps as f64 + fraction) / count },
        increments: totals.increments,
        iterations: totals.iterations,
        cutbacks: totals.cutbacks,
        condition,
        symmetric: analysis.system().is_none_or(subrope_fem::System::is_symmetric),
        inertia_changes: totals.inertia_changes,
        jumps: totals.jumps,
        unresolved: totals.is_unresolved(),
        released: totals.released / scale,
        energy_error: totals.energy_error(),
        displacement: analysis.displacement().to_vec(),
        forces: forces.collect(),
        energies: vec![totals.external_work, stored, transverse, longitudinal, contact, totals.contact_friction],
    }
}

/// Looks at every converged increment.
struct Watch<'a> {
    end: Instant,
    late: bool,
    unfinite: Option<&'static str>,
    /// Steps done, and part of the step that runs.
    reached: (usize, f64),
    interrupt: Option<&'a AtomicBool>,
}

impl Observer for Watch<'_> {
    fn converged(&mut self, analysis: &Analysis, record: &IncrementRecord) -> Result<Control, FemError> {
        self.reached = (record.step_index - 1, record.fraction);
        self.unfinite = unfinite(analysis);
        self.late = Instant::now() > self.end;
        let stop = self.late || self.unfinite.is_some() || self.interrupt.is_some_and(|f| f.load(Ordering::Relaxed));
        Ok(if stop { Control::Stop } else { Control::Continue })
    }
}

/// What of a committed state is not finite.
fn unfinite(analysis: &Analysis) -> Option<&'static str> {
    let t = analysis.totals();
    let energies = [t.external_work, t.stored, t.contact_stored, t.contact_friction, t.energy_error()];
    let bad = |values: &[f64]| values.iter().any(|v| !v.is_finite());
    let checks = [
        ("displacement", bad(analysis.displacement())),
        ("reactions", bad(analysis.reactions())),
        ("energies", bad(&energies) || bad(&t.dissipated) || bad(&t.dissipated_mid)),
    ];
    checks.into_iter().find(|(_, bad)| *bad).map(|(what, _)| what)
}
