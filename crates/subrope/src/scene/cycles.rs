//! Cycles as steps: one for every half cycle.

use super::prescription::{Prescription, Ramp};
use super::step::{CycleControl, Cycles, Prescribe, Step, Tension, Waveform};

/// Pieces of half a cosine.
const PIECES: u32 = 8;

/// Half a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfCycle {
    /// Number of the cycle in its step, from 1.
    pub cycle: usize,
    /// Whether it ends at the upper end.
    pub rising: bool,
    /// Whether its end is written to the fields.
    pub written: bool,
}

/// A step, or the part of one that is a half cycle.
pub(super) struct Part {
    /// The step without cycles.
    pub step: Step,
    /// Force on a reference point along z as a history of fractions of the largest one so far.
    pub of_peak: Option<(String, Ramp)>,
    /// The half cycle, if it is one.
    pub half: Option<HalfCycle>,
}

/// The parts of a step, in order, of its first `most` cycles.
pub(super) fn parts(step: &Step, most: usize) -> Vec<Part> {
    let Some(cycles) = &step.cycles else { return vec![Part { step: step.clone(), of_peak: None, half: None }] };
    let halves = (1..=cycles.count.min(most)).flat_map(|cycle| [(cycle, false), (cycle, true)]);
    halves
        .map(|(cycle, rising)| {
            let written = cycle % cycles.every == 0 || cycle == cycles.count;
            half(step, cycles, HalfCycle { cycle, rising, written })
        })
        .collect()
}

fn half(step: &Step, cycles: &Cycles, half: HalfCycle) -> Part {
    let direction = if half.rising { "up" } else { "down" };
    let ramp = ramp(cycles, half.rising);
    let mut own = Step {
        name: format!("{} {} {direction}", step.name, half.cycle),
        duration: step.duration / (2 * cycles.count) as f64,
        cycles: None,
        ..step.clone()
    };
    let (mut elongation, mut force, mut of_peak) = (None, None, None);
    match cycles.of {
        CycleControl::Elongation => elongation = Some(ramp),
        CycleControl::Force => force = Some(ramp),
        CycleControl::Peak => of_peak = Some((cycles.point.clone(), ramp)),
    }
    if of_peak.is_some() {
        let point = Some(cycles.point.clone());
        own.prescribe.push(Prescribe { point, uz: Some(Prescription::free()), ..Prescribe::default() });
    } else {
        let (length, point) = (cycles.length, cycles.point.clone());
        let twist = step.tension.as_ref().and_then(|t| t.twist.clone());
        own.tension = Some(Tension { elongation, force, twist, length, point });
    }
    Part { step: own, of_peak, half: Some(half) }
}

fn ramp(cycles: &Cycles, rising: bool) -> Ramp {
    let (from, to) = if rising { (cycles.low, cycles.high) } else { (cycles.high, cycles.low) };
    match cycles.waveform {
        Waveform::Triangle => Ramp::To(to),
        Waveform::Sine => {
            let at = |k: u32| {
                let fraction = f64::from(k) / f64::from(PIECES);
                let share = 0.5 * (1.0 - (std::f64::consts::PI * fraction).cos());
                [fraction, from + share * (to - from)]
            };
            Ramp::Path((1..=PIECES).map(at).collect())
        }
    }
}
