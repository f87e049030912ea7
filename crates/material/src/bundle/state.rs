//! The state of a point: `DP1 DP2 gP2 gP3 kappa_t kappa_l d_t d_l`, then `p` when friction depends on pressure.

use super::Update;
use super::friction::ModeState;
use crate::LawError;
use crate::law::{StateKind, StateVariable};
use crate::strain::all_finite;

const fn variable(kind: StateKind, offset: usize, components: usize) -> StateVariable {
    StateVariable { kind, offset, components }
}

static VARIABLES: [StateVariable; 7] = [
    variable(StateKind::DistortionPlastic, 0, 2),
    variable(StateKind::LongitudinalShearPlastic, 2, 2),
    variable(StateKind::TransverseSliding, 4, 1),
    variable(StateKind::LongitudinalSliding, 5, 1),
    variable(StateKind::TransverseDissipation, 6, 1),
    variable(StateKind::LongitudinalDissipation, 7, 1),
    variable(StateKind::CompactionPressure, 8, 1),
];

/// Layout of the state: nothing without friction, the pressure only when friction depends on it.
pub(super) fn variables(slides: bool, presses: bool) -> &'static [StateVariable] {
    match (slides, presses) {
        (false, _) => &[],
        (true, false) => VARIABLES.split_last().map_or(&[], |(_, head)| head),
        (true, true) => &VARIABLES,
    }
}

/// Numbers in the state.
#[inline]
pub(super) fn len(slides: bool, presses: bool) -> usize {
    match (slides, presses) {
        (false, _) => 0,
        (true, false) => 8,
        (true, true) => 9,
    }
}

/// State of both modes and the compaction pressure of the last increment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BundleState {
    pub(super) transverse: ModeState,
    pub(super) longitudinal: ModeState,
    pub(super) pressure: f64,
}

impl BundleState {
    #[inline]
    pub(super) fn read(old: &[f64], slides: bool, presses: bool) -> Result<Self, LawError> {
        if !slides {
            return Ok(Self::default());
        }
        let wrong = LawError::StateLength { expected: len(slides, presses), found: old.len() };
        let Some((&[d1, d2, g2, g3, kappa_t, kappa_l, d_t, d_l], rest)) = old.split_first_chunk() else {
            return Err(wrong);
        };
        if !all_finite(old) {
            return Err(LawError::NonFiniteInput);
        }
        let pressure = match (presses, rest) {
            (false, []) => 0.0,
            (true, &[pressure]) => pressure,
            _ => return Err(wrong),
        };
        Ok(Self {
            transverse: ModeState { plastic: [d1, d2], sliding: kappa_t, dissipation: d_t },
            longitudinal: ModeState { plastic: [g2, g3], sliding: kappa_l, dissipation: d_l },
            pressure,
        })
    }
}

impl Update {
    #[inline]
    pub(super) fn write_state(&self, new: &mut [f64], slides: bool, presses: bool) -> Result<(), LawError> {
        if !slides {
            return Ok(());
        }
        let found = new.len();
        let (t, l) = (&self.transverse.new, &self.longitudinal.new);
        let numbers = [
            t.plastic[0],
            t.plastic[1],
            l.plastic[0],
            l.plastic[1],
            t.sliding,
            l.sliding,
            t.dissipation,
            l.dissipation,
        ];
        match (presses, new.split_first_chunk_mut()) {
            (false, Some((head, []))) => *head = numbers,
            (true, Some((head, [pressure]))) => {
                *head = numbers;
                *pressure = self.axial.pressure;
            }
            _ => {
                return Err(LawError::StateLength { expected: len(slides, presses), found });
            }
        }
        Ok(())
    }
}
