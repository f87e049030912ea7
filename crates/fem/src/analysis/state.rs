//! The state of an analysis in the middle of a step, kept and taken up.
//!
//! Everything that later increments depend on is kept as it is; nothing is formed anew that might come out different in the
//! last bit. The system of equations (pattern, order, symbolic factors) is made again from the same lists of elements.

use std::time::Duration;

use super::arc_length::PathScale;
use super::division::Progress;
use super::driver::Analysis;
use super::record::{Phases, Totals};
use super::step::LoadBefore;
use crate::FemError;
use crate::state::{StateError, StateReader, StateWriter, Within};

impl Analysis {
    /// Keeps the state after a converged increment: to be called from [`Observer::converged`](super::Observer::converged).
    ///
    /// # Errors
    /// [`StateError`].
    pub fn save(&self, state: &mut dyn StateWriter) -> Result<(), StateError> {
        for (name, values) in self.vectors() {
            state.numbers(name, values.len(), &mut values.iter().copied())?;
        }
        let mut before = self.before.iter().flat_map(|b| [b.load, b.peak]);
        state.numbers("before", 2 * self.before.len(), &mut before)?;
        let released = &self.released;
        state.counts("released", released.len(), &mut released.iter().map(|(c, _)| u64::from(*c)))?;
        state.numbers("released_reactions", released.len(), &mut released.iter().map(|(_, r)| *r))?;
        for (name, flags) in [("prescribed", &self.prescribed), ("prescribed_before", &self.prescribed_before)] {
            state.counts(name, flags.len(), &mut flags.iter().map(|f| u64::from(*f)))?;
        }
        let Progress { done, length, count } = self.progress;
        let (largest, stiffness) = (self.largest_reference, self.stiffness_scale);
        let scalars = [largest, stiffness, self.last_length, self.time, done, length, self.curvature];
        let PathScale { motion, work, advance, dissipation } = self.path;
        state.numbers("path", 4, &mut [motion, work, advance, dissipation].into_iter())?;
        state.numbers("scalars", scalars.len(), &mut scalars.into_iter())?;
        state.counts("progress", 2, &mut [self.steps_done as u64, count as u64].into_iter())?;
        let (energies, counts) = self.totals.kept();
        state.numbers("totals", energies.len(), &mut energies.into_iter())?;
        state.counts("total_counts", counts.len(), &mut counts.into_iter())?;
        let times = self.phases.times.map(|t| u64::try_from(t.as_nanos()).unwrap_or(u64::MAX));
        state.counts("nanoseconds", times.len(), &mut times.into_iter())?;
        for (index, contribution) in self.model.contributions.iter().enumerate() {
            contribution.save(&mut Within::new(&mut *state, contribution_name(index)))?;
        }
        Ok(())
    }

    /// Takes up a state that [`Analysis::save`] kept of an equal model. The next [`Analysis::run_step`], of the same step,
    /// goes on after that increment, and everything that follows is the same bit by bit.
    ///
    /// # Errors
    /// [`FemError::State`] when the state belongs to another model; [`FemError::Linear`]. The analysis is then of no use
    /// any more.
    pub fn restore(&mut self, state: &dyn StateReader) -> Result<(), FemError> {
        for (name, values) in self.vectors_mut() {
            state.read_numbers(name, values)?;
        }
        let before = state.numbers("before")?;
        StateError::expect("before", before.len(), 2 * self.before.len())?;
        let (pairs, _) = before.as_chunks::<2>();
        self.before = pairs.iter().map(|&[load, peak]| LoadBefore { load, peak }).collect();
        let (coordinates, reactions) = (state.counts("released")?, state.numbers("released_reactions")?);
        StateError::expect("released_reactions", reactions.len(), coordinates.len())?;
        let limit = self.q.len() as u64;
        if coordinates.iter().any(|c| *c >= limit) {
            return Err(StateError::Value { name: "released".into() }.into());
        }
        self.released = coordinates.into_iter().map(|c| c as u32).zip(reactions).collect();
        self.prescribed_before = self.flags(state, "prescribed_before")?;
        self.restore_scalars(state)?;
        for (index, contribution) in self.model.contributions.iter_mut().enumerate() {
            contribution.restore(&Within::new(state, contribution_name(index)))?;
        }
        self.make_system(self.flags(state, "prescribed")?)?;
        self.restored = true;
        Ok(())
    }

    fn restore_scalars(&mut self, state: &dyn StateReader) -> Result<(), FemError> {
        let mut scalars = [0.0; 7];
        state.read_numbers("scalars", &mut scalars)?;
        let [largest_reference, stiffness_scale, last_length, time, done, length, curvature] = scalars;
        let [steps_done, count] = counts(state, "progress")?;
        let mut path = [0.0; 4];
        state.read_numbers("path", &mut path)?;
        let [motion, work, advance, dissipation] = path;
        self.path = PathScale { motion, work, advance, dissipation };
        if path.iter().any(|value| !value.is_finite()) {
            return Err(StateError::Value { name: "path".into() }.into());
        }
        // On a path with arc lengths the fraction may lie below zero.
        if !(done <= 1.0 && length > 0.0 && length <= 1.0 && time.is_finite() && curvature.is_finite()) {
            return Err(StateError::Value { name: "scalars".into() }.into());
        }
        (self.largest_reference, self.stiffness_scale) = (largest_reference, stiffness_scale);
        (self.last_length, self.time, self.curvature) = (last_length, time, curvature);
        self.steps_done = steps_done as usize;
        self.progress = Progress { done, length, count: count as usize };
        let mut energies = [0.0; 13];
        state.read_numbers("totals", &mut energies)?;
        self.totals = Totals::of_kept(energies, counts(state, "total_counts")?);
        self.phases = Phases { times: counts(state, "nanoseconds")?.map(Duration::from_nanos) };
        Ok(())
    }

    /// Flags of coordinates.
    fn flags(&self, state: &dyn StateReader, name: &str) -> Result<Vec<bool>, StateError> {
        let flags = state.counts(name)?;
        StateError::expect(name, flags.len(), self.q.len())?;
        Ok(flags.into_iter().map(|f| f != 0).collect())
    }

    fn vectors(&self) -> [(&'static str, &[f64]); 9] {
        [
            ("q", &self.q),
            ("peak", &self.peak),
            ("step_start", &self.step_start),
            ("last_change", &self.last_change),
            ("displacement", &self.displacement),
            ("reaction", &self.reaction),
            ("nodal_load", &self.nodal_load),
            ("coordinate_load", &self.coordinate_load),
            ("internal", &self.internal),
        ]
    }

    fn vectors_mut(&mut self) -> [(&'static str, &mut [f64]); 9] {
        [
            ("q", &mut self.q),
            ("peak", &mut self.peak),
            ("step_start", &mut self.step_start),
            ("last_change", &mut self.last_change),
            ("displacement", &mut self.displacement),
            ("reaction", &mut self.reaction),
            ("nodal_load", &mut self.nodal_load),
            ("coordinate_load", &mut self.coordinate_load),
            ("internal", &mut self.internal),
        ]
    }
}

fn contribution_name(index: usize) -> String {
    format!("contribution_{index}")
}

/// Counts beyond this were never counted, and would overflow one day.
const MOST: u64 = 1 << 60;

fn counts<const N: usize>(state: &dyn StateReader, name: &str) -> Result<[u64; N], StateError> {
    let found = state.counts(name)?;
    StateError::expect(name, found.len(), N)?;
    if found.iter().any(|count| *count > MOST) {
        return Err(StateError::Value { name: name.into() });
    }
    Ok(std::array::from_fn(|i| found[i]))
}

impl Totals {
    fn kept(&self) -> ([f64; 13], [u64; 14]) {
        // Taken apart, so that nothing that is added later can be forgotten.
        let Self {
            external_work,
            work_scale,
            stored,
            dissipated: [transverse, longitudinal],
            dissipated_mid: [transverse_mid, longitudinal_mid],
            stabilising,
            contact_stored,
            contact_friction,
            interference,
            increments,
            iterations,
            cutbacks,
            factorisations,
            linear_iterations,
            augmentations,
            searches,
            unstable_increments,
            negative_pivots,
            inertia_changes,
            minimised,
            switched,
            smoothed,
            jumps,
            released,
            open,
        } = *self;
        let energies = [
            external_work,
            work_scale,
            stored,
            transverse,
            longitudinal,
            transverse_mid,
            longitudinal_mid,
            stabilising,
            contact_stored,
            contact_friction,
            interference,
            released,
            open,
        ];
        let counts = [
            increments,
            iterations,
            cutbacks,
            factorisations,
            linear_iterations,
            augmentations,
            searches,
            unstable_increments,
            // Zero stands for unknown.
            negative_pivots.map_or(0, |n| n + 1),
            inertia_changes,
            jumps,
            minimised,
            switched,
            smoothed,
        ];
        (energies, counts.map(|n| n as u64))
    }

    fn of_kept(energies: [f64; 13], counts: [u64; 14]) -> Self {
        let c = counts.map(|n| n as usize);
        Self {
            external_work: energies[0],
            work_scale: energies[1],
            stored: energies[2],
            dissipated: [energies[3], energies[4]],
            dissipated_mid: [energies[5], energies[6]],
            stabilising: energies[7],
            contact_stored: energies[8],
            contact_friction: energies[9],
            interference: energies[10],
            increments: c[0],
            iterations: c[1],
            cutbacks: c[2],
            factorisations: c[3],
            linear_iterations: c[4],
            augmentations: c[5],
            searches: c[6],
            unstable_increments: c[7],
            negative_pivots: c[8].checked_sub(1),
            inertia_changes: c[9],
            jumps: c[10],
            minimised: c[11],
            switched: c[12],
            smoothed: c[13],
            open: energies[12],
            released: energies[11],
        }
    }
}
