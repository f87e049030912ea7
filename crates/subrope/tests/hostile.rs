//! Input that means harm, or does it by mistake: refused with place, cause and size, quickly, and without a trace.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use subrope::point::PathScene;
use subrope::progress::Silent;
use subrope::run::{RunOptions, run_scene};
use subrope::scene::{Scene, SceneError, SceneFile};
use subrope::{Error, ExitCode, check::check_scene, mesh_file::write_mesh};

const STRAND: &str = r#"title = "t"
[strand]
radius = 2.0
length = 3.0
surface_angle = 20.0
mesh = { core = 2, rings = 1, layers = 1 }
[law]
kind = "fibre_reinforced"
mu = 10.0
lambda = 10.0
k = 100.0
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "pull"
tension = { elongation = 0.001 }
"#;

const ROPE: &str = r#"title = "t"
[rope]
radius = 2.0
length = 30.0
lay_angle = 20.0
yarns = { surface_angle = 20.0 }
mesh = { core = 2, rings = 1, layers = 1 }
[law]
kind = "fibre_reinforced"
mu = 10.0
lambda = 10.0
k = 100.0
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[contact]]
name = "strands"
[[step]]
name = "pull"
tension = { elongation = 0.001 }
"#;

/// CPU time that a refusal may take \[s\]: of the whole process, so that what else is tested counts too.
const SOON: f64 = 30.0;

/// Stops the time that this process had a processor.
struct Watch(f64);

impl Watch {
    fn start() -> Self {
        Self(subrope_io::cpu_time().unwrap_or_default().as_secs_f64())
    }

    fn elapsed(&self) -> f64 {
        Self::start().0 - self.0
    }
}

fn changed(scene: &str, from: &str, to: &str) -> String {
    assert!(scene.contains(from), "{from:?}");
    scene.replacen(from, to, 1)
}

fn written(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    path
}

/// All files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}

#[test]
fn sizes_beyond_the_memory_are_refused_with_the_estimate() {
    let cases = [
        (STRAND, "layers = 1", "layers = 1048576, core_fraction = 0.3"),
        (STRAND, "core = 2, rings = 1, layers = 1", "core = 1048576, rings = 1048576, layers = 1048576"),
        (STRAND, "core = 2, rings = 1", "core = 4096, rings = 4096"),
        (ROPE, "core = 2, rings = 1, layers = 1", "core = 512, rings = 512, layers = 1048576"),
        (ROPE, "[[contact]]", "[element]\nformulation = \"hex27\"\n[[contact]]\npoints = [32, 32]"),
    ];
    for (scene, from, to) in cases {
        let mut text = changed(scene, from, to);
        if text.contains("points") {
            text = changed(&text, "layers = 1 ", "layers = 1048576 ");
        }
        if text.contains("core_fraction") {
            text = changed(&text, "core = 2, rings = 1", "core = 64, rings = 64");
        }
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), &text);
        let start = Watch::start();
        let file = SceneFile::load(&path).unwrap_or_else(|error| panic!("{}", error.plain()));
        let answers = [
            check_scene(&file).map(|_| ()).unwrap_err(),
            run_scene(&path, RunOptions::default(), &mut Silent).map(|_| ()).unwrap_err(),
            write_mesh(&file, &folder.path().join("mesh.inp")).unwrap_err(),
        ];
        for error in answers {
            assert_eq!(error.exit_code(), ExitCode::Input);
            let told = error.plain();
            assert!(told.contains("GB of memory") && told.contains("help:"), "{told}");
        }
        assert!(start.elapsed() < SOON, "{to}: {:?}", start.elapsed());
        assert_eq!(files(folder.path()), [path], "nothing is written");
    }
}

#[test]
fn counts_beyond_all_bounds_are_refused_by_the_scene() {
    let refused = |text: &str, part: &str| {
        let start = Watch::start();
        let told = match Scene::from_toml("s.toml", text) {
            Ok(_) => panic!("accepted: {part}"),
            Err(error @ SceneError::Invalid(_)) => error.plain(),
            Err(error) => panic!("{error}"),
        };
        assert!(told.contains(part), "no {part:?} in\n{}", &told[..told.len().min(2000)]);
        assert!(start.elapsed() < SOON, "{part}: {:?}", start.elapsed());
    };
    let step = "tension = { elongation = 0.001 }\n";
    let increments = |value: &str| changed(STRAND, step, &format!("{step}increments = {{ {value} }}\n"));
    refused(&increments("fixed = 1000000000000"), "`fixed` = 1e12 is out of range");
    refused(&increments("max_count = 1000000000000"), "`max_count` = 1e12 is out of range");
    refused(&changed(STRAND, "layers = 1", "layers = 1000000000"), "`layers` = 1000000000 is out of range");
    refused(&changed(STRAND, "layers = 1", "layers = 99999999999999999999"), "too large");
    refused(&changed(ROPE, "length = 30.0", "length = 30.0\nstrands = 1000000000"), "`strands` = 1000000000");
    let cycles = "[step.cycles]\nlow = 0.0\nhigh = 1.0\nof = \"force\"\ncount = 1000000000000\n";
    refused(&changed(STRAND, step, cycles), "`count` = 1e12");
    let many = |table: &str, count: usize| {
        (0..count).fold(String::new(), |mut text, i| {
            let _ = write!(text, "[[{table}]]\nname = \"n{i}\"\n");
            text
        })
    };
    refused(&(STRAND.to_owned() + &many("end", 200_000)), "`end` must hold");
    refused(&(STRAND.to_owned() + &many("step", 200_000)), "`step` must hold");
    let text = changed(STRAND, "[[step]]", &(many("end", 900) + "[[step]]"));
    refused(&text, "there is no node set");
}

#[test]
fn steps_and_components_together_are_refused_with_their_number() {
    let ends = (0..300).fold(String::new(), |mut text, i| {
        let _ = write!(text, "[[rigid]]\nname = \"r{i}\"\nshape = \"plane\"\npoint = [0,0,0]\naxis = [0,0,1]\n");
        text
    });
    let steps = (0..9000).fold(String::new(), |mut text, i| {
        let _ = write!(text, "[[step]]\nname = \"s{i}\"\n");
        text
    });
    let text = changed(STRAND, "[[step]]", &(ends + &steps + "[[step]]"));
    let told = Scene::from_toml("s.toml", &text).unwrap_err().plain();
    assert!(told.contains("entries, more than"), "{}", &told[..told.len().min(2000)]);
}

#[test]
fn a_million_half_cycles_are_counted_not_made_by_a_check() {
    let cycles = "[step.cycles]\nlow = 0.0\nhigh = 1.0\nof = \"force\"\ncount = 100000\n";
    let start = Watch::start();
    let scene = Scene::from_toml("s.toml", &changed(STRAND, "tension = { elongation = 0.001 }\n", cycles)).unwrap();
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    let size = subrope::estimate::SizeEstimate::of(&scene);
    assert!(size.steps == 200_000.0 && size.bytes > 1e8, "{size:?}");
}

/// Deep nesting must not exhaust the stack, and many problems must not take the square of their number.
#[test]
fn nesting_and_floods_of_problems_end_soon() {
    let deep = 200_000;
    let texts = [
        format!("a = {}", "[".repeat(deep)),
        format!("a = {}{}", "[".repeat(deep), "]".repeat(deep)),
        format!("a = {}", "{a=".repeat(deep)),
        format!("{}a = 1", "a.".repeat(deep)),
        format!("[{}a]", "a.".repeat(deep)),
        format!("[[{}a]]", "a.".repeat(20_000)),
        (0..100_000).fold(String::new(), |mut text, i| {
            let _ = writeln!(text, "k{i} = 1");
            text
        }),
        "= \n".repeat(100_000),
        "a = 99999999999999999999\n".repeat(50_000),
    ];
    for text in texts {
        let start = Watch::start();
        let told = Scene::from_toml("s.toml", &text).unwrap_err().plain();
        assert!(!told.is_empty());
        assert!(start.elapsed() < SOON, "{:?} for {:?}", start.elapsed(), &text[..40]);
    }
}

#[test]
fn results_stay_below_the_folder_of_the_scene() {
    for folder in ["/tmp/elsewhere", "..", "../x", "a/../../b", "", "out/.."] {
        let text = format!("{STRAND}[output]\nfolder = \"{folder}\"\n");
        let told = Scene::from_toml("s.toml", &text).unwrap_err().plain();
        assert!(told.contains("does not lie below") && told.contains("--out"), "{folder}: {told}");
    }
    let good = format!("{STRAND}[output]\nfolder = \"./a/b\"\n");
    Scene::from_toml("s.toml", &good).unwrap_or_else(|error| panic!("{}", error.plain()));
}

#[test]
fn names_do_not_become_paths() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("within");
    std::fs::create_dir(&folder).unwrap();
    let mut text = changed(STRAND, "title = \"t\"", "title = \"../../../tmp/title/\\u0007\"\nnotes = \"/etc/../x\"");
    text = changed(&text, "name = \"pull\"", "name = \"../../step/\"");
    let path = written(&folder, &text);
    run_scene(&path, RunOptions::default(), &mut Silent).unwrap_or_else(|error| panic!("{}", error.plain()));
    for file in files(place.path()) {
        assert!(file == path || file.starts_with(folder.join("out/scene")), "{}", file.display());
    }
    for (table, name) in [("rigid", "a,b"), ("rigid", "../a"), ("contact", "a\\nb"), ("contact", " a")] {
        let more = match table {
            "rigid" => "shape = \"plane\"\npoint = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n",
            _ => "primary = \"LATERAL\"\nsecondary = \"LATERAL\"\n",
        };
        let text = changed(STRAND, "[[step]]", &format!("[[{table}]]\nname = \"{name}\"\n{more}[[step]]"));
        let told = Scene::from_toml("s.toml", &text).unwrap_err().plain();
        assert!(told.contains("cannot head a column"), "{told}");
    }
}

#[test]
#[cfg(unix)]
fn what_is_no_file_is_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let deck = changed(STRAND, "[strand]\nradius = 2.0\nlength = 3.0\nsurface_angle = 20.0\n", "");
    let deck = changed(
        &deck,
        "mesh = { core = 2, rings = 1, layers = 1 }\n",
        "[deck]\nfile = \"/dev/zero\"\nfibres = \"deck\"\n",
    );
    let path = written(folder.path(), &deck);
    let told = SceneFile::load(&path).unwrap_err().plain();
    assert!(told.contains("cannot read the deck /dev/zero") && told.contains("not a regular file"), "{told}");
    for path in [Path::new("/dev/zero"), folder.path()] {
        let told = SceneFile::load(path).unwrap_err().plain();
        assert!(told.contains("not a regular file"), "{told}");
        assert!(matches!(subrope::point::load(path), Err(subrope::point::PointError::Read { .. })));
        assert!(subrope::study::StudyFile::load(path).is_err());
    }
}

#[test]
fn endless_paths_of_a_point_are_refused_with_the_estimate() {
    let text = "title = \"t\"\ncycles = 1000000000000\n[law]\nkind = \"isotropic\"\nE = 1.0\nnu = 0.3\n[[path]]\n\
                modes = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0]\nsteps = 1000000\n";
    let told = Error::from(PathScene::from_toml("p.toml", text).unwrap_err()).plain();
    assert!(told.contains("GB") && told.contains("fewer `cycles`"), "{told}");
}

#[test]
fn studies_without_number_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), STRAND);
    let list = (0..10).fold(String::new(), |mut list, i| {
        let _ = write!(list, "\"step[{i}].duration\" = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], ");
        list
    });
    let text = format!(
        "title = \"t\"\nscene = \"scene.toml\"\n[[quantity]]\nname = \"force\"\nvalue = 1.0\n[[series]]\nname = \"s\"\n\
         each = {{ {} }}\n",
        list.trim_end_matches(", ")
    );
    let path = folder.path().join("study.toml");
    std::fs::write(&path, text).unwrap();
    let told = subrope::study::StudyFile::load(&path).unwrap_err().plain();
    assert!(told.contains("10000000000 members"), "{told}");
}
