//! Arguments of the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

/// Simulation of synthetic mooring ropes from the inside.
///
/// Exit codes: 0 done, 1 a member of a stress table fails, 2 the input is wrong, 3 no equilibrium was found, 4 the output could not be written.
#[derive(Debug, Parser)]
#[command(name = "subrope", version, about, long_about)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Write a commented scene and a short README into a new folder
    New {
        /// The folder
        #[arg(required_unless_present = "list")]
        folder: Option<PathBuf>,
        /// Which scene to start from
        #[arg(long, default_value = "bent_strand_coarse")]
        template: String,
        /// List the templates
        #[arg(long)]
        list: bool,
    },
    /// Check a scene without running it: counts, mesh quality, yarn angles, memory
    Check {
        /// The scene file
        scene: PathBuf,
    },
    /// Run a scene: results.vtkhdf, history.csv, summary.json
    Run {
        /// The scene file
        scene: PathBuf,
        /// Folder of the results [default: the scene's output.folder, or out/NAME beside the scene NAME.toml]
        #[arg(long)]
        out: Option<PathBuf>,
        /// Threads [default: the scene's solver.threads, or as many as there are processors]
        #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
        threads: Option<u16>,
        /// Go on from the last checkpoint in the folder of the results: files are cut back to there, and the end is the
        /// same bit by bit as without the stop. A run that is done is left as it is
        #[arg(long)]
        restart: bool,
    },
    /// Run a scene with varied settings: errors against time and memory
    ///
    /// A study file names a scene, series of settings from coarse to fine, quantities and a reference. Every member runs as
    /// a process of its own, all members once, then all again; one that fails is reported and the others go on. Written:
    /// study.csv, study.json, study.md, and per quantity the charts NAME_time.svg and NAME_memory.svg.
    Study {
        /// The study file
        file: PathBuf,
        /// Folder of the results [default: out/NAME beside the study NAME.toml]
        #[arg(long)]
        out: Option<PathBuf>,
        /// Runs of every member [default: the study's]
        #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
        repeats: Option<u16>,
        /// Relative error to be reached, such as 1% or 0.01 [default: the study's]: names the cheapest member that
        /// reaches it, and compares the times of series at it
        #[arg(long, value_parser = fraction)]
        target: Option<f64>,
        /// Keep the runs that an earlier study in the folder has finished, if scene and version are the same
        #[arg(long)]
        resume: bool,
    },
    /// Run families of extreme scenes and say of each whether the program holds there
    ///
    /// Every member runs in memory, and once more in other units. Written: stress.md, stress.csv, stress.json with load
    /// reached, iterations, cutbacks, condition, changes of inertia, snaps, energy error, digits lost and verdict. The exit
    /// code is 1 when a verdict is FAILS.
    Stress {
        /// The list of families [default: those that come with the program]
        file: Option<PathBuf>,
        /// Folder of the tables
        #[arg(long, default_value = "out/stress")]
        out: PathBuf,
        /// Only families whose name holds this text; may be repeated
        #[arg(long)]
        only: Vec<String>,
    },
    /// Drive a law along the paths of a point file (.json or .toml), or ask it again at the point where a run failed
    /// (failed_point.toml)
    Point {
        /// The point file: .json (every step) or .toml (a few targets, the steps between them are filled in)
        file: PathBuf,
        /// Where to write: a table to NAME.csv, JSON to any other name [default: the standard output, a table for
        /// .toml and JSON for .json]
        #[arg(short, long)]
        output: Option<PathBuf>,
        /// Also the tangent by difference quotients (JSON only)
        #[arg(long)]
        differences: bool,
    },
    /// Write the mesh of a scene
    Mesh {
        /// The scene file
        scene: PathBuf,
        /// Where to write: .inp (Abaqus) or .vtkhdf
        #[arg(short, long)]
        output: PathBuf,
    },
    /// Print the JSON schema of scene files: every key with its unit
    Schema {
        /// The schema of point files (TOML) instead
        #[arg(long)]
        point: bool,
        /// The schema of study files instead
        #[arg(long, conflicts_with = "point")]
        study: bool,
        /// The schema of stress lists instead
        #[arg(long, conflicts_with_all = ["point", "study"])]
        stress: bool,
    },
}

/// A fraction between 0 and 1, also in per cent.
fn fraction(text: &str) -> Result<f64, String> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text.trim(), 1.0), |n| (n.trim(), 0.01));
    match number.parse::<f64>().map(|n| n * unit) {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err("give a fraction between 0 and 1, such as 1% or 0.01".to_owned()),
    }
}
