//! The exact tangent of the discrete update.
//!
//! The second variation of `W` is a sum of a few dyads in the reduced strain increment of
//! [`crate::strain::Kinematics`]: a 3x3 block in `(dI_comp, dv)`, `v` the deviator of `T`, a 2x2 block in the
//! longitudinal shears and the fibre's entry, with the fibre coupled to both. One sparse congruence takes it to
//! `dS/dE`.

use std::f64::consts::SQRT_2;

use super::Update;
use super::forces::SectionStress;
use crate::lanes::{Lanes, finite};
use crate::law::LaneResponse;
use crate::strain::dot;

/// Rows of a 6x6 matrix in the reduced Mandel order 11, 22, 33, 12, 13, 23.
type Rows<V> = [[V; 6]; 6];
/// Quadratic form in `(dI_comp, dd, do)`.
type SectionForm<V> = [[V; 3]; 3];

impl<V: Lanes> Update<V> {
    /// Writes `dS/dE`, at a fixed elongation when it is averaged. Answers where it is finite.
    #[inline(always)]
    pub(super) fn write_tangent(
        &self,
        section: &SectionStress<V>,
        averaged: bool,
        out: &mut LaneResponse<V>,
    ) -> V::Mask {
        let mut rows = [[self.kinematics.phi.splat(0.0); 6]; 6];
        self.add_section(section, &mut rows);
        self.add_shear(section, &mut rows);
        if !averaged {
            self.add_fibre(&mut rows);
        }
        self.expand_rows(&mut rows, &mut out.tangent);
        finite(out.tangent.as_flattened())
    }

    /// Writes the response conjugate to an averaged elongation.
    #[inline(always)]
    pub(super) fn write_fibre_response(&self, out: &mut LaneResponse<V>) {
        let axial = &self.axial;
        let [b1, b2, b3] = self.kinematics.compaction_gradient();
        let (coupling, zero) = (axial.coupling, axial.coupling.splat(0.0));
        let by_strain = [zero, coupling * b1, coupling * b2, zero, zero, coupling * b3];
        out.fibre.fibre_stress = axial.by_elongation;
        out.fibre.fibre_stiffness = axial.elongation_stiffness;
        out.fibre.fibre_stress_by_strain = self.kinematics.expand(by_strain);
        out.fibre.stress_by_elongation = self.kinematics.expand(self.stress_by_elongation());
    }

    /// `dS/de` at fixed strain, reduced.
    #[inline(always)]
    fn stress_by_elongation(&self) -> [V; 6] {
        let axial = &self.axial;
        let [b1, b2, b3] = self.kinematics.compaction_gradient();
        let [c, d, o] = self.pressure_force();
        let shear = self.pressure_shear();
        let slope = axial.pressure_by_elongation;
        let compaction = axial.coupling + slope * c;
        [
            slope.splat(0.0),
            compaction * b1 + slope * d,
            compaction * b2 - slope * d,
            slope * shear[0],
            slope * shear[1],
            compaction * b3 + slope * o * SQRT_2,
        ]
    }

    /// Change of the transverse force with pressure, as a covector in `(dI_comp, dd, do)`.
    #[inline(always)]
    fn pressure_force(&self) -> [V; 3] {
        let kinematics = &self.kinematics;
        let (n, v) = (self.transverse.direction, kinematics.deviator);
        let slope = self.transverse.pressure_slope;
        let along = slope * dot(v, n);
        let (phi, radial) = (slope * kinematics.phi, kinematics.c * along);
        [-(along * kinematics.inverse_mean), phi * n[0] - radial * v[0], phi * n[1] - radial * v[1]]
    }

    /// Change of the longitudinal shear stress with pressure, entries 12 and 13.
    #[inline(always)]
    fn pressure_shear(&self) -> [V; 2] {
        let factor = self.longitudinal.pressure_slope * self.kinematics.inverse_c11 * SQRT_2;
        let n = self.longitudinal.direction;
        [factor * n[0], factor * n[1]]
    }

    /// Second variation of the transverse part in `(dI_comp, dv)`: with `a = q.v`,
    /// `q.d2D = -c (v.dv' q.dv + q.dv' v.dv) - (dI_comp' q.dv + dI_comp q.dv')/m - c a dv.dv' + a c_v v.dv v.dv'
    /// + (a/m^3)(dI_comp v.dv' + dI_comp' v.dv) + (2 s^2 a/m^3) dI_comp dI_comp' - (a/m) d2I_comp`, and
    /// `d2I_comp = (2 s^2/m^2 - 4) dI_comp dI_comp' + (dI_comp v.dv' + dI_comp' v.dv)/m^2
    /// - (dv.dv' + (v x dv)(v x dv')/s^2)/(2 m^2)`.
    #[inline(always)]
    fn section_form(&self, section: &SectionStress<V>) -> SectionForm<V> {
        let k = &self.kinematics;
        let (q, v) = (self.transverse.force, k.deviator);
        let (phi, c, inverse) = (k.phi, k.c, k.inverse_mean);
        let inverse_square = inverse * inverse;
        let ratio = k.section_det * inverse_square * 2.0;
        let (a, chi4) = (section.work, section.chi * 4.0);
        // dD = (-v/m) dI_comp + (phi - c v v) dv.
        let cross = -(c * v[0] * v[1]);
        let gradient =
            [[-(v[0] * inverse), phi - c * v[0] * v[0], cross], [-(v[1] * inverse), cross, phi - c * v[1] * v[1]]];
        let mut form = self.transverse_stiffness(&gradient);
        let mixed = (a * inverse + chi4) * inverse_square;
        let compaction = self.axial.compaction_stiffness + ratio * a * inverse + chi4 * (ratio - 4.0);
        let border = [mixed * v[0] - q[0] * inverse, mixed * v[1] - q[1] * inverse];
        let around = chi4 * inverse_square * 0.5;
        let turned = around * k.inverse_det;
        let (isotropic, radial) = (-(c * a) - around, a * k.c_v);
        form[0][0] += compaction;
        form[1][1] += isotropic + (radial * v[0] - c * q[0] * 2.0) * v[0] - turned * v[1] * v[1];
        form[2][2] += isotropic + (radial * v[1] - c * q[1] * 2.0) * v[1] - turned * v[0] * v[0];
        let off = (radial + turned) * v[0] * v[1] - c * (v[0] * q[1] + v[1] * q[0]);
        form[1][2] += off;
        form[2][1] += off;
        for (i, value) in [(1, border[0]), (2, border[1])] {
            form[0][i] += value;
            form[i][0] += value;
        }
        form
    }

    /// `gradient^T (dq/dI) gradient` for the transverse mode.
    #[inline(always)]
    fn transverse_stiffness(&self, gradient: &[[V; 3]; 2]) -> SectionForm<V> {
        let mode = &self.transverse;
        let (along, across) = (mode.along - mode.across, mode.across);
        let [d, o] = gradient;
        let n = mode.direction;
        let mut form = [[across.splat(0.0); 3]; 3];
        for i in 0..3 {
            let sliding = along * (n[0] * d[i] + n[1] * o[i]);
            for j in 0..3 {
                let projected = n[0] * d[j] + n[1] * o[j];
                form[i][j] = across * (d[i] * d[j] + o[i] * o[j]) + sliding * projected;
            }
        }
        form
    }

    /// Transverse block `B^T form B`, `B` = rows of `dI_comp`, `dd`, `do` in the entries 22, 33, 23, and what pressure
    /// adds through compaction.
    #[inline(always)]
    fn add_section(&self, section: &SectionStress<V>, rows: &mut Rows<V>) {
        let gradient = self.kinematics.compaction_gradient();
        let mut form = self.section_form(section);
        if positive(self.transverse.pressure_slope) {
            let force = self.pressure_force();
            for i in 0..3 {
                form[i][0] += force[i] * self.axial.pressure_by_compaction;
            }
        }
        let mut right = form;
        for [first, second, third] in &mut right {
            let [c, d, o] = [*first, *second, *third];
            [*first, *second, *third] = [c * gradient[0] + d, c * gradient[1] - d, c * gradient[2] + o * SQRT_2];
        }
        let place = [1, 2, 5];
        for j in 0..3 {
            let [c, d, o] = [right[0][j], right[1][j], right[2][j]];
            rows[1][place[j]] = gradient[0] * c + d;
            rows[2][place[j]] = gradient[1] * c - d;
            rows[5][place[j]] = gradient[2] * c + o * SQRT_2;
        }
    }

    /// Longitudinal block: `(4/C11^2) dq/dI` and, from `d2T_ab = -C11 (dg_a dg_b' + dg_b dg_a')`, `-(8/C11) P_ab`.
    #[inline(always)]
    fn add_shear(&self, section: &SectionStress<V>, rows: &mut Rows<V>) {
        let inverse = self.kinematics.inverse_c11;
        let stiffness = inverse * inverse * 2.0;
        let [p22, p33, p23] = section.components;
        let first = self.longitudinal.stiffness_times([1.0, 0.0]);
        let second = self.longitudinal.stiffness_times([0.0, 1.0]);
        let geometric = inverse * -4.0;
        rows[3][3] = stiffness * first[0] + geometric * p22;
        rows[4][4] = stiffness * second[1] + geometric * p33;
        rows[3][4] = stiffness * second[0] + geometric * p23;
        rows[4][3] = rows[3][4];
        let q = self.longitudinal.force;
        let turning = inverse * inverse * (-2.0 * SQRT_2);
        for (i, force) in [(3, q[0]), (4, q[1])] {
            rows[0][i] = turning * force;
            rows[i][0] = turning * force;
        }
        if positive(self.longitudinal.pressure_slope) {
            self.add_pressure_shear(rows);
        }
    }

    #[inline(always)]
    fn add_pressure_shear(&self, rows: &mut Rows<V>) {
        let shear = self.pressure_shear();
        let slope = self.axial.pressure_by_compaction;
        let [b1, b2, b3] = self.kinematics.compaction_gradient();
        for (row, factor) in [(3, shear[0] * slope), (4, shear[1] * slope)] {
            rows[row][1] = factor * b1;
            rows[row][2] = factor * b2;
            rows[row][5] = factor * b3;
        }
    }

    /// What the point's own elongation adds: its stiffness, its coupling and `d2I_elong = -dC11 dC11'/(2 C11^2)`.
    #[inline(always)]
    fn add_fibre(&self, rows: &mut Rows<V>) {
        let axial = &self.axial;
        let inverse = self.kinematics.inverse_c11;
        let [b1, b2, b3] = self.kinematics.compaction_gradient();
        let coupling = axial.coupling * inverse;
        for (i, gradient) in [(1, b1), (2, b2), (5, b3)] {
            rows[0][i] += coupling * gradient;
        }
        let column = self.stress_by_elongation();
        for i in 1..6 {
            rows[i][0] += column[i] * inverse;
        }
        rows[0][0] += (axial.elongation_stiffness - axial.by_elongation * 2.0) * inverse * inverse;
    }

    /// `M^T rows M`, `M` the map from the Mandel strain increment to the reduced one: `M^T` from the left,
    /// transposed, and once more, which leaves the columns of the tangent.
    #[inline(always)]
    fn expand_rows(&self, rows: &mut Rows<V>, columns: &mut Rows<V>) {
        self.kinematics.expand_columns(rows);
        for (i, row) in rows.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                columns[j][i] = *entry;
            }
        }
        self.kinematics.expand_columns(columns);
    }
}

/// Whether any lane is positive.
#[inline(always)]
fn positive<V: Lanes>(numbers: V) -> bool {
    V::any(numbers.splat(0.0).lt(numbers))
}
