//! Scenes to start from.

use std::path::Path;

use super::output::{failed, write_new};
use crate::Error;
use crate::document::nearest;

/// A scene to start from.
pub(super) struct Template {
    pub name: &'static str,
    pub about: &'static str,
    pub text: &'static str,
}

macro_rules! templates {
    ($($name:literal: $about:literal,)*) => {
        [$(Template {
            name: $name,
            about: $about,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/templates/", $name, ".toml")),
        }),*]
    };
}

/// All of them.
pub(super) static TEMPLATES: [Template; 17] = templates! {
    "bent_strand_coarse": "a coarse strand bent by 45 degrees: the first minute",
    "bent_strand": "a strand bent to a half circle, with friction between rope-yarns",
    "bent_strand_elastic": "the same without friction",
    "rope_yarn_tension": "one rope-yarn in tension: identification of the moduli along the yarns",
    "strand_tension": "a strand in tension, its ends kept from turning",
    "tension_twist": "a strand pulled, then twisted to and fro",
    "buckled_strand": "a strand buckled to one side and pushed through to the other, along its equilibrium path",
    "sub_rope_tension": "three strands laid together, in contact, stretched by 5 %",
    "sub_rope_free_twist": "the same with one end free to turn: how far a rope unlays",
    "sub_rope_cycles": "the same, then twenty cycles of tension: bedding-in, cycle by cycle",
    "sub_rope_slice": "the tension of the sub-rope far from its ends: one layer of one strand stands for all",
    "sub_rope_slice_cycles": "the same, then a thousand cycles of tension",
    "sub_rope_from_tex": "the same sized from its yarns and 90 000 tex, on ends where strands slide",
    "sub_rope_over_cylinder": "three strands under a load, bent over a rigid cylinder",
    "strand_on_rod": "a strand in tension against a rigid rod: identification across the yarns",
    "three_wire_rope": "three elastic wires in tension, to compare with the theory of thin rods",
    "steel_1x7": "a steel strand of a core and six wires in tension",
};

fn find(name: &str) -> Result<&'static Template, Error> {
    let names = || TEMPLATES.iter().map(|t| t.name);
    TEMPLATES.iter().find(|t| t.name == name).ok_or_else(|| Error::UnknownTemplate {
        found: name.to_owned(),
        allowed: names().collect(),
        suggestion: nearest(name, names()),
    })
}

/// The names with a line about each.
pub(super) fn list() -> String {
    TEMPLATES.iter().map(|t| format!("{:24}{}\n", t.name, t.about)).collect()
}

/// Writes a scene and a README into a folder, which is made if it is not there.
pub(super) fn write(folder: &Path, name: &str) -> Result<String, Error> {
    let template = find(name)?;
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let scene = folder.join(format!("{name}.toml"));
    write_new(&scene, template.text.as_bytes())?;
    write_new(&folder.join("README.md"), readme(template).as_bytes())?;
    Ok(format!("{}\n{}\n", scene.display(), folder.join("README.md").display()))
}

fn readme(template: &Template) -> String {
    let Template { name, about, .. } = template;
    format!(
        "# {name}\n\n\
         A scene of subrope: {about}. Units: mm, N, MPa, s; angles in degrees.\n\n\
         ```sh\n\
         subrope check {name}.toml    # every key, value and name; counts, mesh quality, memory\n\
         subrope run {name}.toml      # results in out/{name}\n\
         subrope mesh {name}.toml -o mesh.vtkhdf   # or mesh.inp, for Abaqus and CalculiX\n\
         ```\n\n\
         Results are read by ParaView 5.12 or newer (VTKHDF). All keys with their units: `subrope schema`.\n\
         Other scenes to start from: `subrope new --list`.\n"
    )
}
