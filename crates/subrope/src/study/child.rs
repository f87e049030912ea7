//! One run of a member, as a process of its own: its memory and its time are its own, and whatever becomes of it, the
//! study goes on.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::StudyError;

/// A run to be made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Launch<'a> {
    /// The `subrope` program.
    pub program: &'a Path,
    pub scene: &'a Path,
    /// Folder of its results, made anew.
    pub folder: &'a Path,
    pub threads: usize,
    pub time_limit: Option<f64>,
}

/// Time between two looks at a running member.
const LOOK: Duration = Duration::from_millis(10);

/// Runs a member; why it failed, if it did. A signal from the keyboard reaches the member as well, which stops after its
/// increment.
///
/// # Errors
/// [`StudyError`] when the program cannot be started or the folder cannot be made.
pub(super) fn run(launch: Launch<'_>) -> Result<Result<(), String>, StudyError> {
    let Launch { program, scene, folder, threads, time_limit } = launch;
    renew(folder)?;
    let file = |name: &str| {
        let path = folder.join(name);
        File::create(&path).map_err(|source| StudyError::File { path, source })
    };
    let (stdout, stderr) = (file("stdout.txt")?, file("stderr.txt")?);
    let started = |source| StudyError::Start { program: program.to_owned(), source };
    let mut child = Command::new(program)
        .arg("run")
        .arg(scene)
        .arg("--out")
        .arg(folder)
        .args(["--threads", &threads.to_string()])
        .stdin(Stdio::null())
        .stdout(stdout)
        .stderr(stderr)
        .spawn()
        .map_err(started)?;
    let status = wait(&mut child, time_limit).map_err(started)?;
    Ok(match status {
        None => Err(format!("stopped after the time limit of {} s", time_limit.unwrap_or_default())),
        Some(status) if status.success() => Ok(()),
        Some(status) => Err(reason(folder, status)),
    })
}

/// An empty folder.
fn renew(folder: &Path) -> Result<(), StudyError> {
    let fault = |source| StudyError::File { path: PathBuf::from(folder), source };
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(fault)?;
    }
    std::fs::create_dir_all(folder).map_err(fault)
}

/// Waits for the end; `None` when the time was up and the process was ended.
fn wait(child: &mut Child, time_limit: Option<f64>) -> std::io::Result<Option<ExitStatus>> {
    let Some(limit) = time_limit else { return child.wait().map(Some) };
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed().as_secs_f64() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        std::thread::sleep(LOOK);
    }
}

/// Most lines of a message that are kept.
const LINES: usize = 6;

/// What the process said last, and how it ended.
fn reason(folder: &Path, status: ExitStatus) -> String {
    let text = std::fs::read_to_string(folder.join("stderr.txt")).unwrap_or_default();
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|l| !l.is_empty()).collect();
    let told = lines.iter().rposition(|l| l.starts_with("error:")).unwrap_or(lines.len().saturating_sub(LINES));
    let message = lines.iter().skip(told).take(LINES).copied().collect::<Vec<_>>().join("; ");
    match (message.is_empty(), status.code()) {
        (true, _) => format!("ended with {status}"),
        (false, Some(_)) => message.trim_start_matches("error: ").to_owned(),
        (false, None) => format!("{message} ({status})"),
    }
}
