//! Result files: what is written is read back, and VTK's own reader agrees where it is installed.
// Helpers of tests may fail like tests.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]
#![cfg(feature = "hdf5")]

use nalgebra::Vector3;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use subrope_geometry::{CellKind, Hex20, Hex27, Hexahedron, Mesh};
use subrope_io::{
    ErrorClass, FieldSpec, IoError, Location, OutputCause, OutputError, Precision, Provenance, ResultReader,
    ResultWriter, StaticField, ValueError, WriterOptions, Writes, write_mesh_vtkhdf,
};

const EXACT: WriterOptions = WriterOptions { precision: Precision::F64, deflate: Some(4) };

/// A row of `cells` unit cubes along x.
fn row(cells: u32) -> Mesh {
    let section = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let points = (0..=cells).flat_map(|i| section.map(|[y, z]| Vector3::new(f64::from(i), y, z))).collect();
    let connectivity = (0..cells).flat_map(|i| [0, 4, 5, 1, 3, 7, 6, 2].map(|k| 4 * i + k)).collect();
    Mesh::new(CellKind::Hex8, points, connectivity)
}

fn specs() -> Vec<FieldSpec> {
    vec![
        FieldSpec::point("displacement", 3),
        FieldSpec::point("temperature", 1),
        FieldSpec::cell("stress", 6),
        FieldSpec::cell("energy at points", 8),
        FieldSpec::cell("energy", 1),
    ]
}

/// Values that differ from entry to entry, field to field and step to step.
fn values(mesh: &Mesh, step: usize) -> Vec<Vec<f64>> {
    let tuples = |location| if location == Location::Point { mesh.point_count() } else { mesh.cell_count() };
    let value = |f: usize, i: usize| 1e-3 * ((step + 1) * (f + 1)) as f64 + 1e-5 * i as f64;
    let specs = specs().into_iter().enumerate();
    specs.map(|(f, spec)| (0..tuples(spec.location) * spec.components).map(|i| value(f, i)).collect()).collect()
}

fn append(writer: &mut ResultWriter, mesh: &Mesh, step: usize) -> Result<(), IoError> {
    let values = values(mesh, step);
    writer.append(0.1 * step as f64, &values.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

fn writer(path: &Path, mesh: &Mesh, options: WriterOptions) -> ResultWriter {
    let texts = Provenance::from([("scene".to_owned(), "[strand]\nradius = 2.785 # µ\n".repeat(5000))]);
    ResultWriter::create(path, mesh, &specs(), &texts, options).unwrap()
}

/// Checks all steps of a file against what was written.
fn check(path: &Path, mesh: &Mesh, steps: usize, tolerance: f64) {
    let reader = ResultReader::open(path).unwrap();
    assert_eq!(reader.steps(), steps);
    assert_eq!(reader.counts().unwrap(), (mesh.point_count(), mesh.cell_count()));
    let points = reader.points().unwrap();
    assert!(points.iter().zip(&mesh.points).all(|(a, b)| *a == [b.x, b.y, b.z]));
    assert_eq!(reader.values().unwrap(), (0..steps).map(|s| 0.1 * s as f64).collect::<Vec<_>>());
    for step in 0..steps {
        for (spec, expected) in specs().iter().zip(values(mesh, step)) {
            let got = reader.field(spec.location, &spec.name, step).unwrap();
            assert_eq!(got.len(), expected.len(), "{}", spec.name);
            let worst = got.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst <= tolerance, "{} at step {step}: {worst}", spec.name);
        }
    }
}

/// Python with VTK, when there is one; its path may be given by `SUBROPE_VTK_PYTHON`.
fn vtk_python() -> Option<String> {
    let python = std::env::var("SUBROPE_VTK_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let probe = Command::new(&python).args(["-c", "import vtkmodules.vtkIOHDF, numpy"]).output();
    probe.ok().filter(|output| output.status.success()).map(|_| python)
}

/// Runs the check with VTK's reader; skipped where VTK is not installed.
fn check_with_vtk(path: &Path, arguments: &[&str]) {
    let Some(python) = vtk_python() else {
        println!("skipped: no Python with VTK (set SUBROPE_VTK_PYTHON)");
        return;
    };
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/check_vtkhdf.py");
    let output = Command::new(python).arg(script).arg(path).args(arguments).output().unwrap();
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert!(output.status.success(), "{out}{err}");
    // VTK tells troubles on the error stream and goes on.
    assert!(err.trim().is_empty(), "{err}");
}

#[test]
fn every_step_is_readable_at_once_and_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let (path, copy) = (folder.path().join("r.vtkhdf"), folder.path().join("copy.vtkhdf"));
    let mesh = row(7);
    let mut writer = writer(&path, &mesh, EXACT);
    for step in 0..4 {
        append(&mut writer, &mesh, step).unwrap();
        fs::copy(&path, &copy).unwrap();
        check(&copy, &mesh, step + 1, 0.0);
        let steps = (step + 1).to_string();
        check_with_vtk(
            &copy,
            &[
                "--steps",
                &steps,
                "--points",
                "32",
                "--cells",
                "7",
                "--all-varying",
                "--field",
                "point:displacement:3",
                "--field",
                "point:temperature:1",
                "--field",
                "cell:stress:6",
                "--field",
                "cell:energy at points:8",
                "--field",
                "cell:energy:1",
            ],
        );
    }
    assert_eq!(writer.steps(), 4);
    writer.close().unwrap();
    check(&path, &mesh, 4, 0.0);
    let text = ResultReader::open(&path).unwrap().text("scene").unwrap().unwrap();
    assert!(text.len() > 100_000 && text.ends_with("# µ\n"));
}

#[test]
fn the_check_with_vtk_can_fail() {
    let Some(python) = vtk_python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    let mesh = row(2);
    let mut writer = writer(&path, &mesh, EXACT);
    let fields = values(&mesh, 0);
    let mut inside_out = fields.clone();
    inside_out[0] = mesh.points.iter().flat_map(|x| [-2.0 * x.x, 0.0, 0.0]).collect();
    for (step, fields) in [&fields, &fields, &inside_out].into_iter().enumerate() {
        writer.append(step as f64, &fields.iter().map(Vec::as_slice).collect::<Vec<_>>()).unwrap();
    }
    writer.close().unwrap();
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/check_vtkhdf.py");
    for (arguments, message) in [
        (vec!["--steps", "4"], "3 steps instead of 4"),
        (vec!["--points", "7"], "12 points instead of 7"),
        (vec!["--field", "cell:stress:9"], "stress has 6 components instead of 9"),
        (vec!["--field", "cell:strain:6"], "cell array strain is missing"),
        (vec![], "a warped cell has the corner volume"),
        (vec!["--warp", "", "--varying", "displacement"], "at step 0 is the same as at the step after"),
        (vec!["--warp", "", "--all-varying"], "is the same at all steps"),
        (vec!["--static"], "3 steps in a file that should have none"),
    ] {
        let output = Command::new(&python).arg(&script).arg(&path).args(&arguments).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && text.contains(message), "{arguments:?}: {text}");
    }
}

#[test]
fn single_precision_and_no_compression() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = row(300);
    for (i, deflate) in [None, Some(0), Some(9)].into_iter().enumerate() {
        let path = folder.path().join(format!("{i}.vtkhdf"));
        let mut writer = writer(&path, &mesh, WriterOptions { precision: Precision::F32, deflate });
        (0..3).for_each(|step| append(&mut writer, &mesh, step).unwrap());
        // Dropped, not closed.
        drop(writer);
        check(&path, &mesh, 3, 1e-8);
        check_with_vtk(&path, &["--steps", "3", "--all-varying"]);
    }
}

#[test]
fn many_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    let mesh = row(2);
    let mut writer = writer(&path, &mesh, EXACT);
    (0..300).for_each(|step| append(&mut writer, &mesh, step).unwrap());
    writer.close().unwrap();
    check(&path, &mesh, 300, 0.0);
    check_with_vtk(&path, &["--steps", "300", "--all-varying"]);
}

#[test]
fn constant_fields_are_stored_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    let mesh = row(3);
    let mut writer = writer(&path, &mesh, EXACT);
    writer.write_constant(&FieldSpec::cell("strand", 1), &[0.0, 1.0, 2.0]).unwrap();
    let error = writer.write_constant(&FieldSpec::cell("strand", 1), &[0.0, 1.0, 2.0]).unwrap_err();
    assert!(matches!(error, IoError::Value(ValueError::DuplicateName { .. })));
    (0..3).for_each(|step| append(&mut writer, &mesh, step).unwrap());
    let error = writer.write_constant(&FieldSpec::cell("late", 1), &[0.0; 3]).unwrap_err();
    assert!(matches!(error, IoError::Value(ValueError::LateConstant { steps: 3, .. })));
    writer.close().unwrap();
    let reader = ResultReader::open(&path).unwrap();
    assert_eq!(reader.field(Location::Cell, "strand", 2).unwrap(), [0.0, 1.0, 2.0]);
    assert_eq!(reader.fields().unwrap().len(), 6);
    check_with_vtk(&path, &["--steps", "3", "--all-varying", "--constant", "strand"]);
}

#[test]
fn a_mesh_of_27_node_bricks_without_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.vtkhdf");
    let points = Hex27::NODES.iter().map(|&x| Vector3::from(x) + Vector3::repeat(1e6)).collect();
    let mesh = Mesh::new(CellKind::Hex27, points, (0..27).collect());
    let spec = FieldSpec::cell("fibre", 3);
    let field = StaticField { spec: &spec, values: &[0.0, 0.6, 0.8] };
    write_mesh_vtkhdf(&path, &mesh, &[field], &Provenance::new(), EXACT).unwrap();
    let reader = ResultReader::open(&path).unwrap();
    assert_eq!((reader.steps(), reader.counts().unwrap()), (0, (27, 1)));
    assert_eq!(reader.field(Location::Cell, "fibre", 0).unwrap(), [0.0, 0.6, 0.8]);
    assert_eq!(reader.points().unwrap()[0], [1e6 - 1.0; 3]);
    check_with_vtk(&path, &["--static", "--points", "27", "--cells", "1", "--field", "cell:fibre:3"]);
}

#[test]
fn a_mesh_of_20_node_bricks_without_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.vtkhdf");
    let points = Hex20::NODES.iter().map(|&x| Vector3::from(x)).collect();
    let mesh = Mesh::new(CellKind::Hex20R, points, (0..20).collect());
    write_mesh_vtkhdf(&path, &mesh, &[], &Provenance::new(), EXACT).unwrap();
    assert_eq!(ResultReader::open(&path).unwrap().counts().unwrap(), (20, 1));
    check_with_vtk(&path, &["--static", "--points", "20", "--cells", "1"]);
}

#[test]
fn a_file_without_steps_yet_is_readable() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    writer(&path, &row(2), EXACT).close().unwrap();
    check(&path, &row(2), 0, 0.0);
}

#[test]
fn wrong_values_are_refused_and_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    let mesh = row(2);
    let mut writer = writer(&path, &mesh, WriterOptions::default());
    append(&mut writer, &mesh, 0).unwrap();
    let value_error = |result: Result<(), IoError>| match result {
        Err(IoError::Value(error)) => error,
        other => panic!("{other:?}"),
    };
    for (value, wrong) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (1e300, "1e300")] {
        let mut fields = values(&mesh, 1);
        fields[2][5] = value;
        let slices: Vec<&[f64]> = fields.iter().map(Vec::as_slice).collect();
        let error = value_error(writer.append(1.0, &slices));
        assert!(matches!(&error, ValueError::NotFinite { name, index: 5, .. } if name == "stress"), "{wrong}");
    }
    let fields = values(&mesh, 1);
    let mut slices: Vec<&[f64]> = fields.iter().map(Vec::as_slice).collect();
    assert!(matches!(value_error(writer.append(f64::NAN, &slices)), ValueError::NotFinite { .. }));
    assert!(matches!(value_error(writer.append(0.0, &slices)), ValueError::StepOrder { .. }));
    slices[1] = &[0.0];
    assert!(matches!(value_error(writer.append(1.0, &slices)), ValueError::Length { expected: 12, got: 1, .. }));
    assert!(matches!(value_error(writer.append(1.0, &slices[..2])), ValueError::Count { expected: 5, got: 2 }));
    append(&mut writer, &mesh, 1).unwrap();
    writer.close().unwrap();
    check(&path, &mesh, 2, 1e-8);
}

#[test]
fn wrong_names_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    let create = |spec: FieldSpec, texts: &[(&str, &str)]| {
        let texts = texts.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
        ResultWriter::create(&path, &row(1), &[FieldSpec::point("a", 1), spec], &texts, EXACT).unwrap_err()
    };
    for name in ["", " ", "a/b", "a.b", "a\0b"] {
        let error = create(FieldSpec::cell(name, 1), &[]);
        assert!(matches!(error, IoError::Value(ValueError::Name { .. })), "{name:?}");
        let error = create(FieldSpec::cell("b", 1), &[(name, "")]);
        assert!(matches!(error, IoError::Value(ValueError::Name { .. })), "{name:?}");
    }
    assert!(matches!(create(FieldSpec::point("a", 2), &[]), IoError::Value(ValueError::DuplicateName { .. })));
    for components in [0, usize::MAX] {
        let error = create(FieldSpec::point("b", components), &[]);
        assert!(matches!(error, IoError::Value(ValueError::Components { .. })));
    }
    assert!(matches!(create(FieldSpec::point("b", 1), &[("t", "a\0b")]), IoError::Value(ValueError::Text { .. })));
    let options = WriterOptions { deflate: Some(10), ..EXACT };
    let error = ResultWriter::create(&path, &row(1), &[], &Provenance::new(), options).unwrap_err();
    assert!(matches!(error, IoError::Value(ValueError::Deflate { level: 10 })));
    assert!(!path.exists());
}

#[test]
fn what_is_not_there_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    assert!(matches!(ResultReader::open(&path), Err(IoError::Read { .. })));
    fs::write(&path, "not a result").unwrap();
    let error = ResultReader::open(&path).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Input);
    assert!(matches!(error, IoError::ReadResult { .. }));
    // An older file of any kind is replaced.
    let mesh = row(1);
    let mut writer = writer(&path, &mesh, EXACT);
    append(&mut writer, &mesh, 0).unwrap();
    writer.close().unwrap();
    let reader = ResultReader::open(&path).unwrap();
    for (name, step) in [("stress", 1), ("strain", 0)] {
        assert!(matches!(reader.field(Location::Cell, name, step), Err(IoError::NoSuchField { .. })));
    }
    assert_eq!(reader.text("none").unwrap(), None);
    let bytes = fs::read(&path).unwrap();
    for end in [0, 100, bytes.len() / 2, bytes.len() - 1] {
        let cut = folder.path().join("cut.vtkhdf");
        fs::write(&cut, &bytes[..end]).unwrap();
        assert!(matches!(ResultReader::open(&cut), Err(IoError::ReadResult { .. })), "{end}");
    }
}

#[test]
fn folders_that_cannot_be_written_are_told() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("no/r.vtkhdf"), folder.path().to_path_buf(), PathBuf::from("/proc/r.vtkhdf")] {
        let error = ResultWriter::create(&path, &row(1), &[], &Provenance::new(), EXACT).unwrap_err();
        assert_eq!(error.class(), ErrorClass::Output);
        let IoError::Output(OutputError { cause: OutputCause::System(_), .. }) = error else { panic!("{error}") };
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_device_is_told() {
    let error = ResultWriter::create(Path::new("/dev/full"), &row(1), &[], &Provenance::new(), EXACT).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Output);
    let error = write_mesh_vtkhdf(Path::new("/dev/full"), &row(1), &[], &Provenance::new(), EXACT).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Output);
}

const LIMITED: &str = "SUBROPE_TEST_LIMITED_FILE";

/// The body of [`a_full_disk_leaves_the_steps_before`], run in a process that may not write large files.
#[test]
fn limited_process() {
    let Ok(path) = std::env::var(LIMITED) else { return };
    let mesh = row(2000);
    let mut writer = writer(Path::new(&path), &mesh, WriterOptions { precision: Precision::F64, deflate: None });
    let mut step = 0;
    let error = loop {
        match append(&mut writer, &mesh, step) {
            Ok(()) => step += 1,
            Err(error) => break error,
        }
        assert!(step < 1000, "the limit does not work");
    };
    assert_eq!((error.class(), writer.steps()), (ErrorClass::Output, step));
    // Nothing was begun: the step may be tried again, and the file can be closed.
    let error = append(&mut writer, &mesh, step).unwrap_err();
    let IoError::Output(OutputError { cause: OutputCause::System(system), .. }) = error else { panic!("{error}") };
    assert!(matches!(system.kind(), std::io::ErrorKind::FileTooLarge | std::io::ErrorKind::StorageFull), "{system}");
    fs::copy(&path, format!("{path}.copy")).unwrap();
    fs::write(format!("{path}.steps"), step.to_string()).unwrap();
    writer.close().unwrap();
}

/// A limit on the size of files stands for a full disk: writing fails in the same place with another code.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_the_steps_before() {
    let folder = tempfile::tempdir().unwrap();
    let program = std::env::current_exe().unwrap();
    // Limits in KiB around a step of 470 KiB, so that different parts of a step fail.
    for limit in [3000, 3150, 3300] {
        let path = folder.path().join(format!("{limit}.vtkhdf"));
        let run = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$0\" --exact limited_process --nocapture");
        let output = Command::new("bash").args(["-c", &run]).arg(&program).env(LIMITED, &path).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{text}");
        let steps: usize = fs::read_to_string(format!("{}.steps", path.display())).unwrap().parse().unwrap();
        assert!(steps >= 3, "{text}");
        check(&path, &row(2000), steps, 0.0);
        check(&path.with_extension("vtkhdf.copy"), &row(2000), steps, 0.0);
        check_with_vtk(&path, &["--steps", &steps.to_string(), "--all-varying"]);
    }
}

/// The body of [`a_killed_run_leaves_its_steps`].
#[test]
fn killed_process() {
    let Ok(path) = std::env::var("SUBROPE_TEST_KILLED_FILE") else { return };
    let mesh = row(50);
    let mut writer = writer(Path::new(&path), &mesh, EXACT);
    (0..5).for_each(|step| append(&mut writer, &mesh, step).unwrap());
    std::process::abort();
}

#[test]
fn a_killed_run_leaves_its_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.vtkhdf");
    let program = std::env::current_exe().unwrap();
    let status =
        Command::new(program).args(["--exact", "killed_process"]).env("SUBROPE_TEST_KILLED_FILE", &path).output();
    assert!(!status.unwrap().status.success());
    check(&path, &row(50), 5, 0.0);
    check_with_vtk(&path, &["--steps", "5", "--all-varying"]);
}

/// Whatever happens to a file after a pause, it comes back as it was and goes on to the same bytes as one that nothing
/// happened to.
#[test]
fn a_file_comes_back_to_a_pause() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = row(40);
    for options in [EXACT, WriterOptions::default()] {
        let (path, other) = (folder.path().join("a.vtkhdf"), folder.path().join("b.vtkhdf"));
        let pause = |file: &mut ResultWriter| {
            let image = file.pause().unwrap();
            let mut rest = Vec::new();
            image.rest().unwrap().read_to_end(&mut rest).unwrap();
            assert_eq!(rest.len() as u64, image.rest_length());
            file.go_on().unwrap();
            (image, rest)
        };
        let (mut file, mut straight) = (writer(&path, &mesh, options), writer(&other, &mesh, options));
        for step in 0..70 {
            append(&mut file, &mesh, step).unwrap();
            append(&mut straight, &mesh, step).unwrap();
            if step % 30 == 10 {
                let (image, rest) = pause(&mut file);
                let (same, _) = pause(&mut straight);
                assert_eq!((image.length, &image.settled), (same.length, &same.settled));
                assert_eq!(image.settled.len(), (step + 1) * specs().len());
                // Goes on for a while, then everything but the values of fields is spoilt.
                for later in step + 1..step + 8 {
                    append(&mut file, &mesh, later).unwrap();
                }
                drop(file);
                let mut bytes = fs::read(&path).unwrap();
                let settled = |at: usize| image.settled.iter().any(|[b, n]| (*b..b + n).contains(&(at as u64)));
                let spoilt = |(at, byte): (usize, &mut u8)| *byte = if settled(at) { *byte } else { 0x55 };
                bytes.iter_mut().enumerate().for_each(spoilt);
                // Another file of that name: the library knows those that it has open.
                fs::remove_file(&path).unwrap();
                fs::write(&path, bytes).unwrap();
                assert!(ResultReader::open(&path).is_err());
                let again = (&image, &mut rest.as_slice() as &mut dyn Read);
                file = ResultWriter::resume(&path, &mesh, &specs(), again, (options, &Writes::default())).unwrap();
                assert_eq!(file.steps(), step + 1);
            }
        }
        file.close().unwrap();
        straight.close().unwrap();
        check(&path, &mesh, 70, if options == EXACT { 0.0 } else { 1e-6 });
        assert!(fs::read(&path).unwrap() == fs::read(&other).unwrap(), "the same bytes");
    }
}

#[test]
fn a_file_that_has_become_shorter_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (path, mesh) = (folder.path().join("a.vtkhdf"), row(3));
    let mut file = writer(&path, &mesh, EXACT);
    append(&mut file, &mesh, 0).unwrap();
    let image = file.pause().unwrap();
    let mut rest = Vec::new();
    image.rest().unwrap().read_to_end(&mut rest).unwrap();
    drop(file);
    let resume = || {
        let again = (&image, &mut rest.as_slice() as &mut dyn Read);
        ResultWriter::resume(&path, &mesh, &specs(), again, (EXACT, &Writes::default())).unwrap_err()
    };
    fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(image.length - 1).unwrap();
    assert!(matches!(resume(), IoError::Changed { .. }));
    fs::remove_file(&path).unwrap();
    assert!(matches!(resume(), IoError::Read { .. }));
}
