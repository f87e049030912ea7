//! Wrong scenes are answered with place, cause, allowed values and a suggestion.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use subrope::scene::{Scene, SceneError};

/// A correct scene; each case changes something in it.
const GOOD: &str = r#"title = "test"

[strand]
radius = 2.785
length = 60.0
surface_angle = 30.0
[strand.mesh]
core = 4
rings = 2

[law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
K_c = 60.0
K_t = 15.0
K_l = 20.0
tau_t = 0.05
tau_l = 1.0

[[end]]
name = "END_A"

[[end]]
name = "END_B"

[[step]]
name = "bend"
increments = { initial = 0.1, maximum = 0.2 }
[step.bend]
angle = 90.0
"#;

/// The answer to the good scene with one text replaced by another.
fn answer(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "the good scene has no {from:?}");
    let text = GOOD.replacen(from, to, 1);
    match Scene::from_toml("bad.toml", &text) {
        Ok(_) => panic!("accepted: {from:?} -> {to:?}"),
        Err(error @ SceneError::Invalid(_)) => error.plain(),
        Err(error) => panic!("{error}"),
    }
}

fn expect(from: &str, to: &str, fragments: &[&str]) {
    let answer = answer(from, to);
    for fragment in fragments {
        assert!(answer.contains(fragment), "{from:?} -> {to:?}: no {fragment:?} in\n{answer}");
    }
}

#[test]
fn the_good_scene_is_good() {
    Scene::from_toml("good.toml", GOOD).unwrap_or_else(|e| panic!("{}", e.plain()));
}

#[test]
fn whole_answer() {
    let expected = "\
error: unknown key `radus` in [strand]
 --> bad.toml:4:1
  |
4 | radus = 2.785
  | ^^^^^ not a key of this table
  = help: did you mean `radius`? allowed keys: ";
    let answer = answer("radius =", "radus =");
    assert!(answer.contains(expected), "{answer}");
    assert!(answer.contains("[strand] needs the key `radius`"), "{answer}");
}

#[test]
fn keys() {
    expect("title = \"test\"", "", &["the top of the file needs the key `title`", "bad.toml:1:1"]);
    expect("[strand.mesh]", "[strand.msh]", &["unknown key `msh` in [strand]", "did you mean `mesh`", "bad.toml:7:9"]);
    expect("surface_angle = 30.0", "surface_angle = 30.0\ncore = 4", &["`core` belongs to [strand.mesh]", ":7:1"]);
    expect("length = 60.0\n", "", &["[strand] needs the key `length`", "bad.toml:3:2", "Length along z [mm]"]);
    expect("K_t = 15.0\n", "", &["[law] needs the key `K_t`", "[MPa]"]);
    expect("tau_t", "tau_T", &["unknown key `tau_T`", "did you mean `tau_t`?"]);
    expect("radius = 2.785", "radius = 2.785\nradius = 3.0", &["bad.toml:5:1", "duplicate key"]);
    expect("angle = 90.0", "angle = 90.0\naxs = \"x\"", &["unknown key `axs`", "did you mean `axis`"]);
    expect(
        "name = \"END_A\"",
        "name = \"END_A\"\nnodes = \"X\"",
        &["unknown key `nodes` in [end]", "kind, name, point, set"],
    );
}

#[test]
fn types() {
    expect("radius = 2.785", "radius = \"2.785\"", &["`radius` must be a number, not a string", "bad.toml:4:10"]);
    expect("core = 4", "core = 4.0", &["`core` must be an integer", "4.0", "bad.toml:8:8"]);
    expect("angle = 90.0", "angle = \"free\"", &["`angle` must be a number or a list", "not a string"]);
    expect("[[end]]\nname = \"END_A\"", "[[end]]\nname = 3", &["`name` must be a string, not an integer"]);
    expect("[strand]\n", "[strand]\nhand = true\n", &["`hand` must be", "\"right\"", "not true or false"]);
    expect("name = \"END_A\"", "name = \"END_A\"\npoint = [0.0, 0.0]", &["`point` must hold 3 entries, not 2"]);
    expect("name = \"END_A\"", "name = \"END_A\"\npoint = [0.0, 0.0, \"a\"]", &["`point[2]` must be a number"]);
    expect("title = \"test\"", "title = \"test\"\nlaw = 3\n[lw]", &["bad.toml"]);
}

#[test]
fn words() {
    expect(
        "kind = \"bundle\"",
        "kind = \"bundel\"",
        &["`kind` cannot be \"bundel\"", "did you mean `bundle`?", "neo_hooke", "bad.toml:12:8"],
    );
    expect("kind = \"bundle\"\n", "", &["[law] needs the key `kind`", "allowed values: bundle, charmetant"]);
    expect("[strand]\n", "[strand]\nhand = \"rigth\"\n", &["did you mean `right`?", "allowed values: right, left"]);
    expect(
        "angle = 90.0",
        "angle = 90.0\nends = \"fixed\"",
        &["`ends` cannot be \"fixed\"", "allowed values: free, circle"],
    );
    expect(
        "[law]",
        "[element]\nformulation = \"C3D8\"\n[law]",
        &["`formulation` cannot be \"C3D8\"", "hex8_mean_volume"],
    );
    expect("[law]", "[output]\nfields = [\"strain\"]\n[law]", &["`fields[0]` cannot be \"strain\"", "strain_modes"]);
}

#[test]
fn bricks_that_cannot_touch() {
    let contact = "[element]\nformulation = \"hex20\"\n[[rigid]]\nname = \"rod\"\nshape = \"plane\"\npoint = [0, 9, 0]\naxis = \
                   [0, -1, 0]\n[[contact]]\nname = \"rubs\"\nprimary = \"rod\"\nsecondary = \"LATERAL\"\n[law]";
    let fragments =
        ["surfaces of a [[contact]] touch along smooth surfaces", "\"hex20\"", "\"hex27\"", "bad.toml:12:15"];
    expect("[law]", contact, &fragments);
    expect("[law]", &contact.replace("hex20", "hex20r"), &["\"hex20r\" lack", "bad.toml:12:15"]);
    Scene::from_toml("good.toml", &GOOD.replace("[law]", &contact.replace("hex20", "hex27"))).unwrap();
    Scene::from_toml("good.toml", &GOOD.replace("[law]", "[element]\nformulation = \"hex20r\"\n[law]")).unwrap();
}

#[test]
fn numbers() {
    expect(
        "radius = 2.785",
        "radius = -2.785",
        &["`radius` = -2.785 is out of range: it must be at least 1e-9 and at most 1000000000", "[mm]"],
    );
    expect("surface_angle = 30.0", "surface_angle = 90", &["`surface_angle` = 90", "less than 90", "bad.toml:6:17"]);
    expect("length = 60.0", "length = nan", &["`length` = NaN is out of range: it must be a finite number"]);
    expect("length = 60.0", "length = inf", &["a finite number"]);
    expect("length = 60.0", "length = 1e999", &["bad.toml:5:10"]);
    expect("core = 4", "core = 3", &["a multiple of 2"]);
    expect("core = 4", "core = -4", &["`core` = -4", "at least 2"]);
    expect("initial = 0.1", "initial = 0", &["`initial` = 0", "at least 1e-12"]);
    expect("{ initial = 0.1, maximum = 0.2 }", "{ fixed = 0 }", &["`fixed` = 0", "at least 1"]);
    expect("angle = 90.0", "angle = 270.0", &["between -180 and 180 degrees"]);
    expect("tau_l = 1.0", "tau_l = 1.0\nnu = nan", &["`nu` = NaN"]);
    expect("[law]", "[solver]\ncutback = 1.5\n[law]", &["`cutback` = 1.5", "less than 1"]);
    expect("[law]", "[output]\ncompression = 12\n[law]", &["`compression` = 12", "at most 9"]);
}

/// Nothing absurd gets as far as the mesh: it would end in infinite aspect ratios, overflow or no progress at all.
#[test]
fn absurd_numbers() {
    for value in ["1e300", "1e-300", "0"] {
        for (key, old) in [("radius", "radius = 2.785"), ("length", "length = 60.0")] {
            expect(old, &format!("{key} = {value}"), &[&format!("`{key}` = {value} is out of range")]);
        }
        expect("surface_angle = 30.0", &format!("pitch = {value}"), &[&format!("`pitch` = {value} is out of range")]);
    }
    for count in ["1000000000", "9223372036854775806", "0"] {
        for (key, old) in [("core", "core = 4"), ("rings", "rings = 2"), ("layers", "rings = 2")] {
            let wanted =
                if key == "core" { "at least 2 and at most 1048576" } else { "at least 1 and at most 1048576" };
            expect(old, &format!("{key} = {count}"), &[&format!("`{key}` = "), wanted, "bad.toml:"]);
        }
    }
    expect("{ initial = 0.1, maximum = 0.2 }", "{ fixed = 10000000000 }", &["at least 1 and at most 1000000"]);
    expect("initial = 0.1", "initial = 1e-300", &["`initial` = 1e-300", "at least 1e-12 and at most 1"]);
}

#[test]
fn contradictions() {
    expect(
        "[law]",
        "[deck]\nfile = \"a.inp\"\nfibres = \"deck\"\n[law]",
        &["either [strand] or [deck], not both", "bad.toml:11:2"],
    );
    expect(
        "surface_angle = 30.0",
        "surface_angle = 30.0\npitch = 30.3",
        &["`surface_angle` and `pitch` exclude", "bad.toml:7:9"],
    );
    expect("surface_angle = 30.0\n", "", &["needs the key `surface_angle`", "or `pitch`"]);
    expect(
        "initial = 0.1, maximum = 0.2",
        "initial = 0.3, maximum = 0.2",
        &["reversed bounds: `initial` = 0.3", "minimum <= initial <= maximum"],
    );
    expect("initial = 0.1, maximum = 0.2", "fixed = 4, maximum = 0.2", &["`fixed` excludes"]);
    expect("initial = 0.1, maximum = 0.2", "fixed = 4, control = \"arc_length\"", &["`fixed` excludes"]);
    for (solver, cause) in [
        ("trust_region = \"always\"", "follows unstable states too"),
        ("stabilisation = { viscosity = 1e-3 }", "follows equilibria, which `solver.stabilisation` disturbs"),
    ] {
        let step =
            format!("[solver]\n{solver}\n[[step]]\nname = \"arcs\"\nincrements = {{ control = \"arc_length\" }}\n");
        expect("[[step]]", &format!("{step}[[step]]"), &[cause, "leave out one of them", "bad.toml:"]);
    }
    expect("tau_t = 0.05\n", "", &["[law] needs the key `tau_t`", "friction = false"]);
    expect("tau_t = 0.05", "tau_t = 0.05\nz_lock = -0.3", &["`z_lock` is not read with this `compaction`"]);
    expect("tau_t = 0.05", "tau_t = 0.05\ncompaction = \"power\"", &["needs the key `K_p`", "needs the key `m`"]);
    expect("tau_t = 0.05", "tau_t = 0.05\nH_inf_t = 0.3", &["needs the key `kappa_s_t`"]);
    expect("angle = 90.0", "angle = [[0.5, 90.0], [0.4, 0.0]]", &["`fraction` = 0.4", "greater than 0.5"]);
    expect("angle = 90.0", "angle = []", &["the history is empty"]);
}

#[test]
fn names() {
    expect(
        "name = \"END_B\"",
        "name = \"END_C\"\nset = \"END_B\"",
        &["no reference point named \"END_B\"", "did you mean `END_A`?", "bad.toml:31:7"],
    );
    expect(
        "name = \"END_A\"",
        "name = \"END_A\"\nset = \"END_AA\"",
        &["no node set named \"END_AA\"", "known names: END_A, END_B"],
    );
    expect("name = \"END_B\"", "name = \"END_A\"", &["the name \"END_A\" is used twice in [[end]]", "bad.toml:25:8"]);
    expect("name = \"END_B\"", "name = \"END_B\"\nset = \"END_A\"", &["already carried by \"END_A\""]);
    expect(
        "angle = 90.0",
        "angle = 90.0\n[[step.force]]\npoint = \"TIP\"\nfz = 1.0",
        &["no reference point named \"TIP\""],
    );
    expect(
        "angle = 90.0",
        "angle = 90.0\n[[step.traction]]\nsurface = \"LATREAL\"\ntz = 1.0",
        &["did you mean `LATERAL`?"],
    );
    expect(
        "angle = 90.0",
        "angle = 90.0\n[[step.nodal_force]]\nset = \"NONE\"\nfz = 1.0",
        &["no node set named \"NONE\""],
    );
}

#[test]
fn steps() {
    let start = GOOD.find("[[step]]").unwrap();
    let none = Scene::from_toml("bad.toml", &GOOD[..start]).unwrap_err();
    assert!(none.plain().contains("needs the key `step`"), "{}", none.plain());
    let empty = format!("step = []\n{}", &GOOD[..start]);
    let empty = Scene::from_toml("bad.toml", &empty).unwrap_err();
    assert!(empty.plain().contains("`step` must hold 1 to 10000 entries, not 0"), "{}", empty.plain());
    let twice = "angle = 90.0\n[[step.prescribe]]\npoint = \"END_B\"\nuz = 1.0";
    expect("angle = 90.0", twice, &["`uz` of \"END_B\" is prescribed twice", "also by step[0].bend", "bad.toml:34:6"]);
    let held = "angle = 90.0\n[[step.force]]\npoint = \"END_B\"\nfx = 1.0";
    expect("angle = 90.0", held, &["`fx` on \"END_B\" does nothing: `ux` is prescribed", "ux = \"free\""]);
    let nothing = "angle = 90.0\n[[step.prescribe]]\npoint = \"END_B\"";
    expect("angle = 90.0", nothing, &["nothing is prescribed"]);
    expect("[step.bend]\nangle = 90.0", "[step.tension]", &["needs the key `elongation`"]);
    let both = "[step.tension]\nelongation = 0.1\nforce = 10.0";
    expect("[step.bend]\nangle = 90.0", both, &["`elongation` and `force` exclude each other"]);
    expect("name = \"bend\"", "name = \"\"", &["`name` must not be empty"]);
}

#[test]
fn laws_and_elements() {
    let law = &GOOD[GOOD.find("kind").unwrap()..GOOD.find("[[end]]").unwrap()];
    expect(law, "kind = \"isotropic\"\nE = 1.0\nnu = 0.3\n", &["the law \"isotropic\" has none", "hex8_mean_volume"]);
    expect(law, "kind = \"isotropic\"\nE = 1.0\nnu = 0.5\n", &["less than 0.5"]);
    let orthotropic = "kind = \"orthotropic\"\nE1 = 1.0\nE2 = 10.0\nE3 = 1.0\nnu12 = 0.5\nnu13 = 0.0\nnu23 = 0.0\n\
                       G12 = 1.0\nG13 = 1.0\nG23 = 1.0\n";
    expect(law, orthotropic, &["not positive definite", "nu12^2 < E1/E2"]);
    expect(
        law,
        "kind = \"neo_hooke\"\nmu = 1.0\nkappa = 2.0\n",
        &["unknown key `kappa` in [law]", "allowed keys: kind, lambda, mu"],
    );
}

#[test]
fn rope_yarns_that_bend() {
    let bending = "[strand.yarn_bending]\nyarns = 10\nstiffness = 20.0\n\n[strand.mesh]\n";
    expect("[strand.mesh]\n", bending, &["run along its axis", "lines = \"yarns\"", "[strand.yarn_bending]"]);
    let one_layer = bending.to_owned() + "lines = \"yarns\"\nlayers = 1\n";
    expect("[strand.mesh]\n", &one_layer, &["no mesh line has an inner node", "layers = 2"]);
    expect("[strand.mesh]\n", &bending.replace("20.0", "0.0"), &["`stiffness`"]);
    expect("[strand.mesh]\n", &bending.replace("yarns = 10\n", ""), &["[strand.yarn_bending] needs the key `yarns`"]);
}

#[test]
fn syntax() {
    expect("[strand]", "[strand", &["bad.toml:3:"]);
    expect("radius = 2.785", "radius = ", &["bad.toml:4:"]);
    expect("radius = 2.785", "radius = 2,785", &["bad.toml:4:"]);
}

#[test]
fn all_problems_come_at_once_and_in_order() {
    let text = GOOD.replacen("radius = 2.785", "radius = -1", 1).replacen("core = 4", "cor = 4", 1);
    let Err(SceneError::Invalid(document)) = Scene::from_toml("bad.toml", &text) else { panic!("accepted") };
    let places: Vec<_> = document.problems().iter().map(|p| (p.line(), p.column())).collect();
    assert_eq!(places, [(4, 10), (8, 1)]);
    assert_eq!(document.to_string().lines().count(), 1);
    assert!(document.to_string().contains("and 1 more problem"));
}

#[test]
fn the_schema_is_valid_and_states_units() {
    let schema = Scene::schema();
    let text = serde_json::to_string(&schema).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), schema);
    let radius = &schema["$defs"]["Strand"]["properties"]["radius"]["description"];
    assert_eq!(radius, "Radius of the section [mm].");
    let mut without = Vec::new();
    numbers_without_unit(&schema, "", &mut without);
    assert!(without.is_empty(), "no unit: {without:?}");
}

/// Every number a user can write states its unit in brackets.
fn numbers_without_unit(value: &serde_json::Value, path: &str, found: &mut Vec<String>) {
    let Some(map) = value.as_object() else { return };
    for (key, inner) in map {
        let place = format!("{path}/{key}");
        let kind = inner.get("type").map(ToString::to_string).unwrap_or_default();
        let is_key = path.ends_with("/properties");
        let described = inner.get("description").and_then(|d| d.as_str()).is_some_and(|d| d.contains('['));
        if is_key && (kind.contains("number") || kind.contains("integer")) && !described {
            found.push(place.clone());
        }
        numbers_without_unit(inner, &place, found);
        if let Some(list) = inner.as_array() {
            list.iter().enumerate().for_each(|(i, v)| numbers_without_unit(v, &format!("{place}/{i}"), found));
        }
    }
}
