//! Bedding-in: what changes from cycle to cycle.

use std::path::Path;

use serde::Serialize;
use subrope_fem::analysis::Analysis;
use subrope_io::{CheckpointReader, CheckpointWriter, Column, HistoryWriter, IoError};

use super::output::{Opening, save_table};
use crate::model::{CycleStep, RopeModel};

/// Name of the table.
pub const FILE: &str = "cycles.csv";

const COLUMNS: [(&str, &str); 13] = [
    ("step", "-"),
    ("cycle", "-"),
    ("low_force", "N"),
    ("high_force", "N"),
    ("low_elongation", "-"),
    ("high_elongation", "-"),
    ("bedding_in", "-"),
    ("permanent_elongation", "-"),
    ("secant_stiffness", "N"),
    ("hysteresis", "mJ"),
    ("dissipated_transverse", "mJ"),
    ("dissipated_longitudinal", "mJ"),
    ("contact_friction_work", "mJ"),
];

/// One cycle, from one upper end to the next. Elongations are displacements of the end over the length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CycleRow {
    /// Step of the scene, from 1.
    pub step: usize,
    /// Number of the cycle, from 1.
    pub cycle: usize,
    /// Tension at the lower end.
    pub low_force_n: f64,
    /// Tension at the upper end.
    pub high_force_n: f64,
    /// Elongation at the lower end.
    pub low_elongation: f64,
    /// Elongation at the upper end.
    pub high_elongation: f64,
    /// Elongation at the upper end beyond the one at which the cycles began.
    pub bedding_in: f64,
    /// Elongation at the lower end beyond that of the first cycle.
    pub permanent_elongation: f64,
    /// Range of the tension over that of the elongation.
    pub secant_stiffness_n: f64,
    /// Work put in over the cycle: the area of its loop.
    pub hysteresis_mj: f64,
    /// Of it lost to transverse sliding, mid-point value.
    pub dissipated_transverse_mj: f64,
    /// Of it lost to longitudinal sliding, mid-point value.
    pub dissipated_longitudinal_mj: f64,
    /// Of it lost to friction of contacts, mid-point value.
    pub contact_friction_mj: f64,
}

impl CycleRow {
    fn values(&self) -> [f64; COLUMNS.len()] {
        [
            self.step as f64,
            self.cycle as f64,
            self.low_force_n,
            self.high_force_n,
            self.low_elongation,
            self.high_elongation,
            self.bedding_in,
            self.permanent_elongation,
            self.secant_stiffness_n,
            self.hysteresis_mj,
            self.dissipated_transverse_mj,
            self.dissipated_longitudinal_mj,
            self.contact_friction_mj,
        ]
    }

    fn of_values(v: &[f64; COLUMNS.len()]) -> Self {
        Self {
            step: v[0] as usize,
            cycle: v[1] as usize,
            low_force_n: v[2],
            high_force_n: v[3],
            low_elongation: v[4],
            high_elongation: v[5],
            bedding_in: v[6],
            permanent_elongation: v[7],
            secant_stiffness_n: v[8],
            hysteresis_mj: v[9],
            dissipated_transverse_mj: v[10],
            dissipated_longitudinal_mj: v[11],
            contact_friction_mj: v[12],
        }
    }
}

/// Where a half cycle ended.
#[derive(Clone, Copy, Debug, Default)]
struct Turn {
    force: f64,
    elongation: f64,
    work: f64,
    dissipated: [f64; 2],
    friction: f64,
}

impl Turn {
    fn new(step: &CycleStep, analysis: &Analysis) -> Self {
        let motion = analysis.model().kinematics.point_motion(step.point, analysis.coordinates()).0;
        let totals = analysis.totals();
        Self {
            force: analysis.point_reaction(step.point).0.z,
            elongation: motion.z / step.length.unwrap_or(1.0),
            work: totals.external_work,
            dissipated: totals.dissipated_mid,
            friction: totals.contact_friction,
        }
    }

    fn values(&self) -> [f64; 6] {
        [self.force, self.elongation, self.work, self.dissipated[0], self.dissipated[1], self.friction]
    }

    fn of_values(v: &[f64; 6]) -> Self {
        Self { force: v[0], elongation: v[1], work: v[2], dissipated: [v[3], v[4]], friction: v[5] }
    }
}

/// The table while it grows; rows are on the disk when their cycle is done.
pub struct CycleTable {
    writer: Option<HistoryWriter>,
    rows: Vec<CycleRow>,
    start: Turn,
    before: Turn,
    low: Turn,
    first_low: f64,
}

impl CycleTable {
    /// Opens the table of a model with cycles; an older one must not stand beside other results.
    pub fn open(model: &RopeModel, folder: &Path, opening: Opening<'_>) -> Result<Self, IoError> {
        let path = folder.join(FILE);
        let columns: Vec<Column> = COLUMNS.iter().map(|(n, u)| Column::new(*n, *u)).collect();
        let turn = Turn::default();
        let mut out = Self { writer: None, rows: Vec::new(), start: turn, before: turn, low: turn, first_low: 0.0 };
        if model.half_cycles.iter().any(Option::is_some) {
            out.writer = Some(opening.table(&path, "cycles", &columns)?);
            opening.from.map_or(Ok(()), |checkpoint| out.restore(checkpoint))?;
        } else {
            let _ = std::fs::remove_file(&path);
        }
        Ok(out)
    }

    /// Keeps how far it has grown.
    pub fn save(&mut self, to: &mut CheckpointWriter) -> Result<(), IoError> {
        let Some(table) = &mut self.writer else { return Ok(()) };
        save_table(table, "cycles", to)?;
        let (rows, turns) = (&self.rows, [self.start, self.before, self.low]);
        to.numbers("cycle_rows", COLUMNS.len() * rows.len(), &mut rows.iter().flat_map(CycleRow::values))?;
        to.numbers("cycle_turns", 6 * turns.len(), &mut turns.iter().flat_map(Turn::values))?;
        to.numbers("cycle_first_low", 1, &mut std::iter::once(self.first_low))
    }

    fn restore(&mut self, from: &CheckpointReader) -> Result<(), IoError> {
        self.rows = from.numbers("cycle_rows")?.as_chunks().0.iter().map(CycleRow::of_values).collect();
        let mut turns = [[0.0; 6]; 3];
        from.read_numbers("cycle_turns", turns.as_flattened_mut())?;
        [self.start, self.before, self.low] = turns.map(|t| Turn::of_values(&t));
        from.read_numbers("cycle_first_low", std::slice::from_mut(&mut self.first_low))
    }

    /// Whether there is a table.
    pub fn is_open(&self) -> bool {
        self.writer.is_some()
    }

    /// Notes where a half cycle begins.
    pub fn begin(&mut self, step: &CycleStep, analysis: &Analysis) {
        if step.half.rising {
            return;
        }
        self.before = Turn::new(step, analysis);
        if step.half.cycle == 1 {
            self.start = self.before;
        }
    }

    /// Notes where a half cycle ended; writes the row of a whole cycle.
    pub fn end(&mut self, step: &CycleStep, analysis: &Analysis) -> Result<(), IoError> {
        let turn = Turn::new(step, analysis);
        if !step.half.rising {
            if step.half.cycle == 1 {
                self.first_low = turn.elongation;
            }
            self.low = turn;
            return Ok(());
        }
        let (low, before) = (self.low, self.before);
        let range = turn.elongation - low.elongation;
        let row = CycleRow {
            step: step.source + 1,
            cycle: step.half.cycle,
            low_force_n: low.force,
            high_force_n: turn.force,
            low_elongation: low.elongation,
            high_elongation: turn.elongation,
            bedding_in: turn.elongation - self.start.elongation,
            permanent_elongation: low.elongation - self.first_low,
            secant_stiffness_n: if range == 0.0 { 0.0 } else { (turn.force - low.force) / range },
            hysteresis_mj: turn.work - before.work,
            dissipated_transverse_mj: turn.dissipated[0] - before.dissipated[0],
            dissipated_longitudinal_mj: turn.dissipated[1] - before.dissipated[1],
            contact_friction_mj: turn.friction - before.friction,
        };
        self.rows.push(row);
        self.writer.as_mut().map_or(Ok(()), |writer| writer.row(&row.values()))
    }

    /// All rows so far.
    pub fn rows(&self) -> &[CycleRow] {
        &self.rows
    }
}
