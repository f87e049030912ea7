//! Arguments of the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

/// Simulation of synthetic mooring ropes from the inside.
///
/// Exit codes: 0 done, 2 the input is wrong, 3 no equilibrium was found, 4 the output could not be written.
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
    },
    /// Drive a law along the paths of a point file (.json or .toml)
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
    },
}
