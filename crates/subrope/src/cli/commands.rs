//! What each command does.

use std::path::Path;

use super::arguments::Command;
use super::output::{print, write};
use super::study::StudyCommand;
use super::terminal::Terminal;
use super::{interrupt, study, templates};
use crate::check::check_scene;
use crate::point::PointFile;
use crate::run::{RunOptions, RunOutcome};
use crate::scene::{Scene, SceneFile};
use crate::{Error, mesh_file, point};

/// Runs a command.
pub(super) fn run(command: Command) -> Result<(), Error> {
    match command {
        Command::New { list: true, .. } | Command::New { folder: None, .. } => print(templates::list().as_bytes()),
        Command::New { folder: Some(folder), template, .. } => print(templates::write(&folder, &template)?.as_bytes()),
        Command::Check { scene } => check(&scene),
        Command::Run { scene, out, threads, restart } => {
            run_scene(&scene, out.as_deref(), threads.map(usize::from), restart)
        }
        Command::Study { file, out, repeats, target, resume } => {
            let options = StudyCommand { out, repeats: repeats.map(usize::from), target, resume };
            study::run(&file, &options)
        }
        Command::Stress { file, out, only } => super::stress::run(file.as_deref(), &out, &only),
        Command::Point { file, output, differences } => run_point(&file, output.as_deref(), differences),
        Command::Mesh { scene, output } => mesh_file::write_mesh(&SceneFile::load(&scene)?, &output),
        Command::Schema { point, study, stress } => schema(point, study, stress),
    }
}

fn check(path: &Path) -> Result<(), Error> {
    let file = SceneFile::load(path)?;
    print(summary(&file).as_bytes())?;
    let report = check_scene(&file)?;
    let mut text = report.to_string();
    for ignored in &report.ignored {
        text += &format!("  note     {}:{}: *{} is not read\n", ignored.file.display(), ignored.line, ignored.keyword);
    }
    print((text + "  ready to run\n").as_bytes())
}

/// What a scene holds, in a few lines.
fn summary(file: &SceneFile) -> String {
    let Scene { title, strand, rope, law, element, end, constraint, step, .. } = &file.scene;
    let mesh = match (strand, rope, &file.deck) {
        (Some(strand), ..) => format!("{} hexahedra", strand.mesh.cell_count()),
        (_, Some(rope), _) if rope.is_slice() => {
            let cells = rope.mesh.cell_count() / rope.mesh.layers;
            format!("{cells} hexahedra: a layer of one of {} strands", rope.strands)
        }
        (_, Some(rope), _) => {
            let strands = rope.strand_count();
            format!("{} hexahedra in {strands} strands", strands.saturating_mul(rope.mesh.cell_count()))
        }
        (.., Some(deck)) => format!("deck {}", deck.display()),
        _ => "none".to_owned(),
    };
    let steps: Vec<_> = step.iter().map(|s| s.name.as_str()).collect();
    format!(
        "{}: {title}\n  mesh     {mesh}, {}\n  law      {}\n  boundary {} reference points, {} constraints\n  \
         steps    {}\n  results  {}\n  sha256   {}\n",
        file.path.display(),
        element.formulation.word(),
        law.word(),
        end.len(),
        constraint.len(),
        steps.join(", "),
        file.output_folder().display(),
        file.hash
    )
}

fn run_scene(path: &Path, out: Option<&Path>, threads: Option<usize>, restart: bool) -> Result<(), Error> {
    let stop = interrupt::flag();
    let options = RunOptions { folder: out, threads, interrupt: Some(&stop), ..RunOptions::default() };
    let mut terminal = Terminal::new();
    let outcome = match restart {
        true => crate::run::restart_scene(path, options, &mut terminal)?,
        false => Some(crate::run::run_scene(path, options, &mut terminal)?),
    };
    let text = outcome.as_ref().map_or_else(|| "this run is done already: nothing to go on with\n".to_owned(), closing);
    print(text.as_bytes())
}

/// One sentence of physics, and where the files are.
fn closing(outcome: &RunOutcome) -> String {
    let files = &outcome.files;
    let names = files.results.iter().chain([&files.history]).chain(&files.tables).chain([&files.summary]);
    let names: Vec<_> = names.filter_map(|p| p.file_name()).map(|n| n.to_string_lossy().into_owned()).collect();
    format!("{}\n{} are in {}\n", outcome.summary.sentence(), names.join(", "), files.folder.display())
}

fn run_point(path: &Path, output: Option<&Path>, differences: bool) -> Result<(), Error> {
    let paths = match point::read(path)? {
        PointFile::Paths(paths) => paths,
        PointFile::Failed(failed) => {
            let answer = failed.replay()?;
            return output.map_or_else(|| print(answer.as_bytes()), |output| write(output, answer.as_bytes()));
        }
    };
    let computed = point::compute(&path.display().to_string(), &paths, differences)?;
    let ends_with = |p: &Path, ending: &str| p.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    let table = output.map_or_else(|| ends_with(path, "toml"), |o| ends_with(o, "csv"));
    let text = if table {
        point::to_csv(&computed).into_bytes()
    } else {
        point::to_json(&computed).map_err(|error| Error::Output {
            path: output.unwrap_or(Path::new("standard output")).to_owned(),
            source: error.into(),
        })?
    };
    match output {
        Some(output) => write(output, &text),
        None => print(&text),
    }
}

fn schema(point: bool, study: bool, stress: bool) -> Result<(), Error> {
    let schema = match (point, study, stress) {
        (true, ..) => point::PathScene::schema(),
        (_, true, _) => crate::study::Study::schema(),
        (.., true) => crate::stress::StressList::schema(),
        _ => Scene::schema(),
    };
    print(format!("{schema:#}\n").as_bytes())
}
