//! The state of a point: `DP1 DP2 gP2 gP3 kappa_t kappa_l d_t d_l`, then `p` when friction depends on pressure.

use super::Update;
use super::friction::ModeState;
use crate::lanes::Lanes;
use crate::law::{StateKind, StateVariable};

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
#[inline(always)]
pub(super) fn len(slides: bool, presses: bool) -> usize {
    match (slides, presses) {
        (false, _) => 0,
        (true, false) => 8,
        (true, true) => 9,
    }
}

/// State of both modes and the compaction pressure of the last increment.
#[derive(Clone, Copy, Debug)]
pub(super) struct BundleState<V> {
    pub(super) transverse: ModeState<V>,
    pub(super) longitudinal: ModeState<V>,
    pub(super) pressure: V,
}

impl<V: Lanes> BundleState<V> {
    /// From the states of the points one after the other, whose length has been checked; lanes without a point repeat
    /// the last.
    #[inline(always)]
    pub(super) fn read(witness: V, old: &[f64], slides: bool, presses: bool) -> Self {
        let mut numbers = [witness.splat(0.0); 9];
        match (slides, presses) {
            (false, _) => {}
            (true, false) => read_numbers::<V, 8>(witness, old, &mut numbers),
            (true, true) => read_numbers::<V, 9>(witness, old, &mut numbers),
        }
        let [d1, d2, g2, g3, kappa_t, kappa_l, d_t, d_l, pressure] = numbers;
        Self {
            transverse: ModeState { plastic: [d1, d2], sliding: kappa_t, dissipation: d_t },
            longitudinal: ModeState { plastic: [g2, g3], sliding: kappa_l, dissipation: d_l },
            pressure,
        }
    }

    /// All that was read.
    #[inline(always)]
    pub(super) fn numbers(&self) -> [V; 9] {
        numbers(&self.transverse, &self.longitudinal, self.pressure)
    }
}

/// In the order of [`VARIABLES`].
#[inline(always)]
fn numbers<V: Lanes>(t: &ModeState<V>, l: &ModeState<V>, pressure: V) -> [V; 9] {
    [
        t.plastic[0],
        t.plastic[1],
        l.plastic[0],
        l.plastic[1],
        t.sliding,
        l.sliding,
        t.dissipation,
        l.dissipation,
        pressure,
    ]
}

/// The first `N` numbers of every point; a full pack by loops of constant length.
#[inline(always)]
fn read_numbers<V: Lanes, const N: usize>(witness: V, old: &[f64], numbers: &mut [V; 9]) {
    let (states, _) = old.as_chunks::<N>();
    if states.len() == V::COUNT {
        for (at, number) in numbers[..N].iter_mut().enumerate() {
            *number = witness.fill(|lane| states[lane][at]);
        }
    } else {
        for (at, number) in numbers[..N].iter_mut().enumerate() {
            *number = witness.fill(|lane| states[lane.min(states.len() - 1)][at]);
        }
    }
}

/// The first `N` numbers into the states of the points.
#[inline(always)]
fn write_numbers<V: Lanes, const N: usize>(new: &mut [f64], numbers: &[V; 9]) {
    let (states, _) = new.as_chunks_mut::<N>();
    if states.len() == V::COUNT {
        for (at, number) in numbers[..N].iter().enumerate() {
            let lanes = number.to_array();
            for lane in 0..V::COUNT {
                states[lane][at] = lanes[lane];
            }
        }
    } else {
        for (at, number) in numbers[..N].iter().enumerate() {
            for (state, value) in states.iter_mut().zip(number.to_array()) {
                state[at] = value;
            }
        }
    }
}

impl<V: Lanes> Update<V> {
    /// Writes the states of the points one after the other.
    #[inline(always)]
    pub(super) fn write_state(&self, new: &mut [f64], slides: bool, presses: bool) {
        let numbers = numbers(&self.transverse.new, &self.longitudinal.new, self.axial.pressure);
        match (slides, presses) {
            (false, _) => {}
            (true, false) => write_numbers::<V, 8>(new, &numbers),
            (true, true) => write_numbers::<V, 9>(new, &numbers),
        }
    }
}
