//! A point at which an element had no answer: what the law was asked there, and the same question once more.

use nalgebra::Matrix3;
use pulp::{Simd, WithSimd};
use subrope_material::lanes::Lanes;
use subrope_material::{LaneInput, LaneResponse, Law, LawError, Request};

use super::wide::Wide;

/// What a law was asked at an integration point where it gave no answer. Numbers are those that the law saw, bit by bit.
#[derive(Clone, Debug, PartialEq)]
pub struct FailedPoint {
    /// Displacement gradient `H = F - 1` in the fibre frame \[-\], with what the element averages in it.
    pub gradient: Matrix3<f64>,
    /// Mean elongation in place of the point's own \[-\], for an element that averages it.
    pub mean_elongation: Option<f64>,
    /// Displacement gradient of the point at the committed state \[-\], fibre frame, nothing averaged.
    pub committed_gradient: Matrix3<f64>,
    /// Fibre frame, columns e1 e2 e3.
    pub frame: Matrix3<f64>,
    /// Committed state of the law.
    pub state: Vec<f64>,
    /// Length of the time increment \[s\].
    pub time_increment: f64,
    /// Temperature \[K\].
    pub temperature: f64,
}

impl FailedPoint {
    /// Asks a law the same again, in the vectors of this processor as an element does: on the same processor the answer is
    /// the same bit by bit.
    ///
    /// # Errors
    /// [`LawError`], as in the run.
    pub fn ask<L: Law>(&self, law: &L) -> Result<(), LawError> {
        let expected = law.state_len();
        if self.state.len() != expected {
            return Err(LawError::StateLength { expected, found: self.state.len() });
        }
        pulp::Arch::new().dispatch(Question { point: self, law })
    }
}

struct Question<'a, L> {
    point: &'a FailedPoint,
    law: &'a L,
}

impl<L: Law> WithSimd for Question<'_, L> {
    type Output = Result<(), LawError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let FailedPoint { gradient, mean_elongation, state, time_increment, temperature, .. } = self.point;
        let zero = Wide::new(simd, 0.0);
        let mut lanes = [[zero; 3]; 3];
        for (i, row) in lanes.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = zero.splat(gradient[(i, j)]);
            }
        }
        let input = LaneInput {
            points: 1,
            gradient: lanes,
            mean_elongation: mean_elongation.map(|mean| zero.splat(mean)),
            time_increment: *time_increment,
            temperature: *temperature,
        };
        let mut new = state.clone();
        let mut response = LaneResponse::zero(zero);
        super::formulation::ask(simd, self.law, (&input, state), &mut new, Request::Tangent, &mut response)
            .map_err(|failure| failure.source)
    }
}
