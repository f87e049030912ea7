//! What a run will compute, and what it leaves out because the scene does not need it.

use std::fmt;

use serde::Serialize;
use subrope_fem::Contribution;

use crate::contact;
use crate::model::RopeModel;
use crate::scene::{BranchChoice, BundleLaw, Field, Formulation, Incrementation, Law, PathControl, Scene};

/// What is in use, part by part.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Plan {
    /// Its parts.
    pub parts: Vec<PlanPart>,
}

/// A part of a computation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanPart {
    /// Which.
    pub part: &'static str,
    /// What is in use.
    pub uses: String,
    /// What is left out, and costs neither time nor memory.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub leaves_out: Vec<LeftOut>,
}

/// Something that a scene does not need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// What.
    pub what: &'static str,
    /// Why.
    pub why: String,
}

impl PlanPart {
    pub(crate) fn new(part: &'static str, uses: impl Into<String>) -> Self {
        Self { part, uses: uses.into(), leaves_out: Vec::new() }
    }

    pub(crate) fn without(mut self, what: &'static str, why: impl Into<String>) -> Self {
        self.leaves_out.push(LeftOut { what, why: why.into() });
        self
    }

    pub(crate) fn without_if(self, is_out: bool, what: &'static str, why: &str) -> Self {
        if is_out { self.without(what, why) } else { self }
    }
}

impl Plan {
    /// The plan of a scene and the model made of it, whose first step has been analysed.
    #[must_use]
    pub fn new(scene: &Scene, model: &RopeModel) -> Self {
        let parts = vec![
            symmetry(scene, model),
            state(scene, model),
            element(scene, model),
            yarns(scene, model),
            contact::plan(model),
            solver(model),
            increments(scene),
            threads(model),
            output(scene),
        ];
        Self { parts }
    }
}

fn symmetry(scene: &Scene, model: &RopeModel) -> PlanPart {
    let Some(slice) = &model.mesh.slice else {
        let part = PlanPart::new("model", "every strand over its whole length");
        let whole = "symmetry along and about the axis";
        return match &scene.rope {
            Some(_) => part.without(whole, "symmetry = \"none\"; \"helical\" takes one layer, for tension and torsion"),
            None => part,
        };
    };
    let uses = format!("one layer of one strand for {:.0}", slice.copies());
    PlanPart::new("model", uses)
        .without("the other strands and layers, ends", "symmetry = \"helical\": they are images of this one")
}

fn state(scene: &Scene, model: &RopeModel) -> PlanPart {
    let bytes = model.state_bytes_per_point();
    let word = scene.law.word();
    if bytes == 0 {
        let part = PlanPart::new("law", format!("{word}, elastic"));
        return part.without("state of the points", "nothing slides inside the material: 0 bytes per point");
    }
    let part = PlanPart::new("law", format!("{word} with sliding, {bytes} bytes of state per point"));
    let Law::Bundle(law) = &scene.law else { return part };
    let BundleLaw { X_t, X_l, mu_t, mu_l, .. } = law;
    part.without_if(*X_t == 0.0 && *X_l == 0.0, "back stress", "X_t = X_l = 0").without_if(
        *mu_t == 0.0 && *mu_l == 0.0,
        "pressure in the state",
        "mu_t = mu_l = 0",
    )
}

fn element(scene: &Scene, model: &RopeModel) -> PlanPart {
    let formulation = scene.element.formulation;
    let per_brick = model.mesh.mesh.kind.points();
    PlanPart::new("element", format!("{}, {per_brick} points a brick", formulation.word())).without_if(
        !matches!(formulation, Formulation::Hex8MeanVolume | Formulation::Hex8MeanElongation),
        "averages over an element",
        "this formulation has none",
    )
}

fn yarns(scene: &Scene, model: &RopeModel) -> PlanPart {
    let entry = scene.strand.as_ref().and_then(|strand| strand.yarn_bending.as_ref());
    let (Some(bending), Some(entry)) = (model.yarn_bending(), entry) else {
        let why = match scene.strand {
            Some(_) => "no [strand.yarn_bending]",
            None => "only the mesh lines of a [strand] may follow its rope-yarns",
        };
        return PlanPart::new("yarns", "part of the law").without("bending stiffness of rope-yarns", why);
    };
    let (count, stiffness, elements) = (entry.yarns, entry.stiffness, bending.element_count());
    PlanPart::new(
        "yarns",
        format!("{count} that bend with EI = {stiffness} N mm^2 each, {elements} elements of 4 nodes"),
    )
}

fn solver(model: &RopeModel) -> PlanPart {
    let Some(system) = model.analysis.system() else { return PlanPart::new("solver", "none: no step") };
    let analysis = system.analysis();
    let ordering = analysis.ordering.name();
    let gigaflops = analysis.fill.flops / 1e9;
    let kept = model.analysis.keeps_factors();
    let serve = if kept { "; factors serve later iterations by GMRES" } else { "" };
    if system.is_symmetric() {
        let uses = format!("LDL^T, {ordering}, {gigaflops:.2} GFLOP{serve}");
        let symmetric = "the tangent is symmetric for this law and these contacts";
        let part = PlanPart::new("solver", uses).without("half of the matrix, LU", symmetric);
        return part.without_if(!kept, "GMRES", "factors of a model of this size are cheap to renew");
    }
    let uses = format!("LDL^T of the symmetric part and GMRES, {ordering}, {gigaflops:.2} GFLOP{serve}");
    PlanPart::new("solver", uses).without("LU", "made only where GMRES stalls")
}

fn increments(scene: &Scene) -> PlanPart {
    let steps = scene.step.len();
    let resolved: Vec<_> = scene.step.iter().map(|s| s.increments.resolve()).collect();
    let along = |i: &Incrementation| matches!(i, Incrementation::Automatic { control: PathControl::ArcLength, .. });
    let fixed = |i: &Incrementation| matches!(i, Incrementation::Fixed { .. });
    let kinds = [
        ("fixed increments", resolved.iter().any(fixed)),
        ("automatic increments", resolved.iter().any(|i| !fixed(i) && !along(i))),
        ("increments along the path", resolved.iter().any(along)),
    ];
    let kinds: Vec<&str> = kinds.iter().filter(|kind| kind.1).map(|kind| kind.0).collect();
    let uses = format!("{steps} {}, {}", if steps == 1 { "step" } else { "steps" }, kinds.join(" and "));
    let follows = scene.solver.branch == BranchChoice::Follow;
    PlanPart::new("steps", uses)
        .without_if(!resolved.iter().any(along), "arc length", "no increments.control = \"arc_length\"")
        .without_if(follows, "search for branches", "solver.branch = \"follow\"")
        .without_if(scene.solver.stabilisation.is_none(), "artificial damping", "no [solver.stabilisation]")
        .without_if(!scene.solver.extrapolate, "extrapolated first iterate", "extrapolate = false")
        .without_if(scene.step.iter().all(|s| s.cycles.is_none()), "table of cycles", "no step has cycles")
}

fn threads(model: &RopeModel) -> PlanPart {
    match model.analysis.threads() {
        1 => PlanPart::new("threads", "one").without("scheduling", "one thread"),
        n => PlanPart::new("threads", format!("{n}; the results are those of one")),
    }
}

fn output(scene: &Scene) -> PlanPart {
    let tables = "history.csv, summary.json";
    if !cfg!(feature = "hdf5") {
        return PlanPart::new("output", tables).without("result file", "built without the feature `hdf5`");
    }
    let output = &scene.output;
    let every = if output.every == 1 { "every increment".into() } else { format!("every {} increments", output.every) };
    let count = output.fields.len();
    let uses = format!("{count} fields {every}, {tables}");
    PlanPart::new("output", uses)
        .without_if(count < Field::ALL.len(), "other fields", "not among [output] fields")
        .without("values at integration points", "fields are means of elements")
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for part in &self.parts {
            writeln!(f, "    {:<8} {}", part.part, part.uses)?;
            for LeftOut { what, why } in &part.leaves_out {
                writeln!(f, "             left out: {what} ({why})")?;
            }
        }
        Ok(())
    }
}
