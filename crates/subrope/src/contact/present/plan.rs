//! What a plan says of contact.

use subrope_contact::{FrictionTangent, Method, contacts};

use crate::model::RopeModel;
use crate::plan::PlanPart;

/// Pairs, their method and what they need not know.
pub fn plan(model: &RopeModel) -> PlanPart {
    let pairs: Vec<_> = contacts(&model.analysis).collect();
    let Some(first) = pairs.first() else {
        let why = "no [[contact]]";
        return PlanPart::new("contact", "none").without("surfaces, search for candidates, projection", why);
    };
    let options = first.options();
    let method = match options.method {
        Method::Penalty => "penalty",
        Method::Augmented { .. } => "augmented Lagrangian",
    };
    let rubs = pairs.iter().any(|c| c.options().friction > 0.0);
    let number = pairs.len();
    let uses = format!("{number} {}, {method}", if number == 1 { "pair" } else { "pairs" });
    let uses = if rubs { uses + " with friction" } else { uses };
    PlanPart::new("contact", uses)
        .without_if(!rubs, "slip and traction, unsymmetric tangent", "friction = 0")
        .without_if(
            rubs && options.tangent == FrictionTangent::Symmetric,
            "what couples friction to pressure in the tangent",
            "tangent = \"symmetric\"",
        )
        .without_if(options.method == Method::Penalty, "multipliers", "method = \"penalty\"")
}
