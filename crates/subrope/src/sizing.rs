//! Sizing of a rope: what follows from its yarns, masses and diameters, for who left out its radius or its lay.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt;

use serde::Serialize;
use subrope_geometry::sizing::{Check, Open, Origin, SizingReport};
use subrope_geometry::{Hierarchy, Quantity};

use crate::scene::{Rope, Scene, Sizing};

/// What the sizing of a rope comes to: strands are circles of their radius, which touch or are `gap` apart. The smooth
/// surfaces that touch in the mesh lie a little inside, so that the rope of the mesh is that much thinner.
#[derive(Clone, Debug)]
pub struct RopeSizing {
    /// What is given, what follows, what is told twice, what stays open.
    pub report: SizingReport,
    /// Largest relative difference of what is told twice.
    pub tolerance: f64,
}

impl RopeSizing {
    /// The sizing of the rope of a scene; `None` without a rope, and for a rope that asks for none: its radius is given,
    /// its linear density and `[rope.sizing]` are not.
    #[must_use]
    pub fn of(scene: &Scene) -> Option<Self> {
        let rope = scene.rope.as_ref()?;
        if !rope.is_sized() {
            return None;
        }
        let sizing = rope.sizing.clone().unwrap_or_default();
        let report = hierarchy(rope, &sizing).report();
        Some(Self { report, tolerance: sizing.tolerance })
    }

    /// Radius of a strand \[mm\], given or not.
    #[must_use]
    pub fn radius(&self) -> Option<f64> {
        self.report.value(Quantity::StrandRadius)
    }

    /// Lay angle \[rad\], given or not.
    #[must_use]
    pub fn lay_angle(&self) -> Option<f64> {
        self.report.value(Quantity::LayAngle)
    }

    /// Values that follow but lie outside their range by more than the tolerance.
    pub fn impossible_values(&self) -> impl Iterator<Item = (Quantity, f64)> + '_ {
        let beyond = |&(quantity, value): &(Quantity, f64)| {
            let (least, greatest) = quantity.admissible();
            let slack = self.tolerance * least.abs().max(greatest.min(1.0));
            value < least - slack || value > greatest + slack
        };
        self.report.inadmissible.iter().copied().filter(beyond)
    }

    /// What `summary.json` says of it.
    #[must_use]
    pub fn summary(&self) -> SizingSummary {
        let report = &self.report;
        let quantities = report.known.iter().map(|(&quantity, known)| {
            let (relation, from) = match known.origin {
                Origin::Given => (None, Vec::new()),
                Origin::Derived(relation) => (Some(relation.to_string()), keys(&report.sources(quantity))),
            };
            let (value, unit) = (scaled(quantity, known.value), unit(quantity));
            (key(quantity), QuantitySummary { value, unit, relation, from })
        });
        let told_twice = report.checks.iter().map(|check| ToldTwice {
            quantity: key(check.quantity),
            value: scaled(check.quantity, check.value),
            follows: check.implied.map(|value| scaled(check.quantity, value)),
            unit: unit(check.quantity),
            relation: check.relation.to_string(),
            from: keys(&other_sources(report, check)),
        });
        let open = report.open.iter().map(|Open { relation, unknown }| OpenSummary {
            relation: relation.to_string(),
            give_all_but_one_of: keys(unknown),
        });
        SizingSummary { quantities: quantities.collect(), told_twice: told_twice.collect(), open: open.collect() }
    }
}

/// Sizing, in `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct SizingSummary {
    /// Everything known, by the keys of a scene.
    pub quantities: BTreeMap<&'static str, QuantitySummary>,
    /// Over-determined: what a relation gives beside the value itself.
    pub told_twice: Vec<ToldTwice>,
    /// Under-determined: what could still be given.
    pub open: Vec<OpenSummary>,
}

/// A known quantity.
#[derive(Clone, Debug, Serialize)]
pub struct QuantitySummary {
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// The relation that it follows from; none when it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relation: Option<String>,
    /// The given quantities that it follows from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub from: Vec<&'static str>,
}

/// A quantity with two values.
#[derive(Clone, Debug, Serialize)]
pub struct ToldTwice {
    /// Its key.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// The value by the relation; none when no value fits.
    pub follows: Option<f64>,
    /// Unit of both.
    pub unit: &'static str,
    /// The relation.
    pub relation: String,
    /// The given quantities behind the second value.
    pub from: Vec<&'static str>,
}

/// A relation that lacks more than one quantity.
#[derive(Clone, Debug, Serialize)]
pub struct OpenSummary {
    /// The relation.
    pub relation: String,
    /// Its unknown quantities.
    pub give_all_but_one_of: Vec<&'static str>,
}

impl fmt::Display for SizingSummary {
    /// One line per finding.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (key, QuantitySummary { value, unit, relation, .. }) in &self.quantities {
            let value = digits(*value);
            match relation {
                None => writeln!(f, "{key} {value} {unit}, given")?,
                Some(relation) => writeln!(f, "{key} {value} {unit}, follows ({relation})")?,
            }
        }
        for ToldTwice { quantity, value, follows, unit, relation, from } in &self.told_twice {
            let second = follows.map_or_else(|| "nothing".to_owned(), digits);
            let from = from.join(", ");
            writeln!(f, "told twice: {quantity} {} {unit}, {second} from {from} ({relation})", digits(*value))?;
        }
        for OpenSummary { relation, give_all_but_one_of } in &self.open {
            writeln!(f, "open: give all but one of {} ({relation})", give_all_but_one_of.join(", "))?;
        }
        Ok(())
    }
}

/// The given quantities behind the value that a redundant relation gives.
pub(crate) fn other_sources(report: &SizingReport, check: &Check) -> Vec<Quantity> {
    let others = check.relation.quantities().iter().filter(|q| **q != check.quantity);
    let mut sources: Vec<Quantity> = others.flat_map(|q| report.sources(*q)).collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}

/// Five digits that matter; less than a billionth is nothing.
pub(crate) fn digits(value: f64) -> String {
    if value.abs() < 1e-9 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    let decimals = (4 - value.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

pub(crate) fn keys(quantities: &[Quantity]) -> Vec<&'static str> {
    quantities.iter().copied().map(key).collect()
}

/// The key of a scene that gives a quantity.
pub(crate) fn key(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::FilamentDtex => "filament_dtex",
        Quantity::FilamentDiameter => "filament_diameter",
        Quantity::FilamentsPerYarn => "filaments_per_yarn",
        Quantity::YarnTex => "yarn_tex",
        Quantity::YarnsPerRopeYarn => "yarns_per_rope_yarn",
        Quantity::RopeYarnsPerStrand => "rope_yarns_per_strand",
        Quantity::Strands => "strands",
        Quantity::FibreTex => "all_yarns",
        Quantity::Density => "density",
        Quantity::Coating => "coating",
        Quantity::StrandAngle => "surface_angle",
        Quantity::LayAngle => "lay_angle",
        Quantity::LayLength => "lay_length",
        Quantity::RopeTex => "linear_density",
        Quantity::Packing => "packing",
        Quantity::StrandRadius => "radius",
        Quantity::OuterDiameter => "outer_diameter",
    }
}

/// Its unit in a scene.
pub(crate) fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::FilamentDtex => "dtex",
        Quantity::YarnTex | Quantity::FibreTex | Quantity::RopeTex => "tex",
        Quantity::Density => "kg/m^3",
        Quantity::StrandAngle | Quantity::LayAngle => "degrees",
        Quantity::FilamentDiameter | Quantity::LayLength | Quantity::StrandRadius | Quantity::OuterDiameter => "mm",
        _ => "-",
    }
}

/// Its value in that unit.
pub(crate) fn scaled(quantity: Quantity, value: f64) -> f64 {
    if unit(quantity) == "degrees" { value.to_degrees() } else { value }
}

fn hierarchy(rope: &Rope, sizing: &Sizing) -> Hierarchy {
    let pitched = rope.yarns.pitch.zip(rope.radius).map(|(pitch, radius)| (TAU * radius / pitch).atan());
    Hierarchy {
        filament_dtex: sizing.filament_dtex,
        filament_diameter: sizing.filament_diameter,
        filaments_per_yarn: sizing.filaments_per_yarn,
        yarn_tex: sizing.yarn_tex,
        yarns_per_rope_yarn: sizing.yarns_per_rope_yarn,
        rope_yarns_per_strand: sizing.rope_yarns_per_strand,
        strands: u32::try_from(rope.strands).unwrap_or(u32::MAX),
        density: sizing.density,
        coating: sizing.coating,
        strand_angle: rope.yarns.surface_angle.map(f64::to_radians).or(pitched),
        lay_angle: rope.lay_angle.map(f64::to_radians),
        lay_length: rope.lay_length,
        rope_tex: rope.linear_density,
        packing: sizing.packing,
        strand_radius: rope.radius,
        outer_diameter: rope.outer_diameter,
        gap: gap(rope),
    }
}

/// Distance of neighbouring circles over their radius; `None` when something else gives the helix radius.
fn gap(rope: &Rope) -> Option<f64> {
    let otherwise = rope.core.is_some() || rope.helix_radius.is_some() || rope.compaction > 0.0;
    (!otherwise).then_some(rope.gap)
}
