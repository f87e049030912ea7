//! Forces and tangent of one contact point.
//!
//! Everything that a point does depends on the nodes through six vectors, each a combination of nodal vectors with scalar
//! weights: `r` (point less foot), the tangents `a_1`, `a_2` and the second derivatives `x_,11`, `x_,12`, `x_,22` at the
//! foot. Forces and tangent are written in these 18 numbers and then spread to the nodes.
//!
//! With `g = n . r`, `m_ij = a_i . a_j`, `b_ij = n . x_,ij`, `H = m - g b`, at fixed foot `c_i = a_i . dr`,
//! `d_i = n . da_i`, `h = c + g d`:
//! `dg = n . dr`, `dxi = H^-1 h`, `d2g = -(c m^-1 b H^-1 c + d H^-1 c + c H^-1 d + g d H^-1 d)`, and the second variation of
//! `xi` from that of `r . a_i = 0`. The work of a point is `-p dg + t_i dxi_i`.

use nalgebra::{Matrix2, Vector2, Vector3};
use subrope_fem::Product;

use crate::foot::{Foot, Local};
use crate::law::Friction;
use crate::patch::{PATCH_NODES, SECOND};

/// Numbers that a point depends on.
pub const Z: usize = 18;

/// A linear form of the 18 numbers.
pub type Form = [f64; Z];

/// Forces and tangent in the 18 numbers, per reference area.
#[derive(Clone, Debug)]
pub struct PointTerms {
    /// Work per unit of every number.
    pub force: Form,
    /// Derivative of the force.
    pub tangent: [Form; Z],
    /// Vectors in use: three without friction, six with.
    pub blocks: usize,
    /// What the tangent has beside its symmetric `tangent`.
    pub coupling: Option<Coupling>,
}

/// The part of the tangent of friction that is not symmetric: `sum_i place_i rest_i^T + lagged_i place_i^T`.
///
/// The tangent of friction is `place_i dt_i^T` and a symmetric rest. Of `dt_i` the part at constant pressure, `l_i`, goes
/// into the tangent as `(place_i l_i^T + l_i place_i^T)/2`; what is left over has `rest_i = dt_i - l_i/2` and
/// `lagged_i = -l_i/2`. So the symmetric part alone is the tangent of friction whose limit lags behind the pressure.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// `dxi_i`.
    pub place: [Form; 2],
    /// `dt_i - l_i/2`.
    pub rest: [Form; 2],
    /// `-l_i/2`.
    pub lagged: [Form; 2],
}

fn form(block: usize, v: &Vector3<f64>) -> Form {
    let mut out = [0.0; Z];
    out[3 * block..3 * block + 3].copy_from_slice(v.as_slice());
    out
}

fn add(out: &mut Form, scale: f64, v: &Form) {
    out.iter_mut().zip(v).for_each(|(o, x)| *o += scale * x);
}

fn combine(scale: [f64; 2], of: &[Form; 2]) -> Form {
    let mut out = [0.0; Z];
    add(&mut out, scale[0], &of[0]);
    add(&mut out, scale[1], &of[1]);
    out
}

impl PointTerms {
    fn outer(&mut self, scale: f64, row: &Form, column: &Form) {
        for (line, &r) in self.tangent.iter_mut().zip(row) {
            if r != 0.0 {
                let f = scale * r;
                line.iter_mut().zip(column).for_each(|(o, c)| *o += f * c);
            }
        }
    }

    fn outer_both(&mut self, scale: f64, one: &Form, other: &Form) {
        self.outer(scale, one, other);
        self.outer(scale, other, one);
    }
}

/// Geometry of a point that both terms use.
struct Variations {
    inverse: Matrix2<f64>,
    /// `dg`.
    gap: Form,
    /// `c_i`.
    across: [Form; 2],
    /// `d_i`.
    tilt: [Form; 2],
    /// `dxi_i`.
    place: [Form; 2],
}

impl Variations {
    fn new(foot: &Foot) -> Option<Self> {
        let local = &foot.local;
        let hessian = local.metric() - local.bending(&foot.normal) * foot.gap;
        let inverse = hessian.try_inverse()?;
        let across = [form(0, &local.tangents[0]), form(0, &local.tangents[1])];
        let tilt = [form(1, &foot.normal), form(2, &foot.normal)];
        let h: [Form; 2] = std::array::from_fn(|i| {
            let mut out = across[i];
            add(&mut out, foot.gap, &tilt[i]);
            out
        });
        let place = std::array::from_fn(|i| combine([inverse[(i, 0)], inverse[(i, 1)]], &h));
        Some(Self { inverse, gap: form(0, &foot.normal), across, tilt, place })
    }
}

/// Forces and tangent of a point under pressure `p` with slope `dp/dg`, with or without friction; [`None`] where the foot
/// is not unique. `third` are the third derivatives of the surface at the foot.
#[must_use]
pub fn terms(
    foot: &Foot,
    pressure: (f64, f64),
    friction: Option<(&Friction, &[Vector3<f64>; 4])>,
    symmetric: bool,
) -> Option<PointTerms> {
    let v = Variations::new(foot)?;
    let blocks = if friction.is_some() { 6 } else { 3 };
    let mut out = PointTerms { force: [0.0; Z], tangent: [[0.0; Z]; Z], blocks, coupling: None };
    add_normal(foot, pressure, &v, &mut out)?;
    if let Some((friction, third)) = friction {
        add_friction(foot, friction, third, &v, symmetric, &mut out);
    }
    Some(out)
}

fn add_normal(foot: &Foot, (p, slope): (f64, f64), v: &Variations, out: &mut PointTerms) -> Option<()> {
    add(&mut out.force, -p, &v.gap);
    out.outer(-slope, &v.gap, &v.gap);
    let local = &foot.local;
    let curving = local.metric().try_inverse()? * local.bending(&foot.normal) * v.inverse;
    for i in 0..2 {
        for j in 0..2 {
            out.outer(p * curving[(i, j)], &v.across[i], &v.across[j]);
            out.outer_both(p * v.inverse[(i, j)], &v.tilt[i], &v.across[j]);
            out.outer(p * foot.gap * v.inverse[(i, j)], &v.tilt[i], &v.tilt[j]);
        }
    }
    Some(())
}

fn add_friction(
    foot: &Foot,
    friction: &Friction,
    third: &[Vector3<f64>; 4],
    v: &Variations,
    symmetric: bool,
    out: &mut PointTerms,
) {
    let (mut rest, mut lagged) = ([[0.0; Z]; 2], [[0.0; Z]; 2]);
    let t = &friction.traction;
    let stretch = metric_changes(&foot.local, v);
    for i in 0..2 {
        add(&mut out.force, t[i], &v.place[i]);
        let mut change = combine([friction.by_place[(i, 0)], friction.by_place[(i, 1)]], &v.place);
        for (j, row) in stretch.iter().enumerate() {
            for (k, form) in row.iter().enumerate() {
                add(&mut change, friction.by_metric[i][(j, k)], form);
            }
        }
        let slow = change;
        add(&mut change, friction.by_gap[i], &v.gap);
        let half = if symmetric { &change } else { &slow };
        out.outer_both(0.5, &v.place[i], half);
        add(&mut lagged[i], -0.5, half);
        rest[i] = change;
        add(&mut rest[i], 1.0, &lagged[i]);
    }
    out.coupling = (!symmetric).then_some(Coupling { place: v.place, rest, lagged });
    add_second_variation(foot, &(v.inverse * t), third, v, out);
}

/// `dm_jk = da_j . a_k + a_j . da_k` at the moving foot.
fn metric_changes(local: &Local, v: &Variations) -> [[Form; 2]; 2] {
    let a = &local.tangents;
    let one = |j: usize, k: usize| {
        // da_j . a_k
        let mut out = form(1 + j, &a[k]);
        let bent = [0, 1].map(|i| local.second[SECOND[j][i]].dot(&a[k]));
        add(&mut out, 1.0, &combine(bent, &v.place));
        out
    };
    let both = |j, k| {
        let mut out = one(j, k);
        add(&mut out, 1.0, &one(k, j));
        out
    };
    [[both(0, 0), both(0, 1)], [both(1, 0), both(1, 1)]]
}

/// `tau_i H_ij d2xi_j`, from the second variation of `r . a_i = 0`.
fn add_second_variation(
    foot: &Foot,
    tau: &Vector2<f64>,
    third: &[Vector3<f64>; 4],
    v: &Variations,
    out: &mut PointTerms,
) {
    let Local { tangents, second, .. } = &foot.local;
    let along = tangents[0] * tau[0] + tangents[1] * tau[1];
    for j in 0..2 {
        out.outer_both(-1.0, &form(1 + j, &along), &v.place[j]);
        for k in 0..2 {
            let steep = third[j + k] * tau[0] + third[j + k + 1] * tau[1];
            let bent = foot.gap * foot.normal.dot(&steep) - along.dot(&second[SECOND[j][k]]);
            out.outer(bent, &v.place[j], &v.place[k]);
            let lifted = foot.normal * (foot.gap * tau[k]);
            out.outer_both(1.0, &form(3 + SECOND[k][j], &lifted), &v.place[j]);
        }
    }
    for axis in 0..3 {
        // Dr and tau_i Da_i, one component at a time.
        let mut moved = [0.0; Z];
        moved[axis] = 1.0;
        let mut turned = [0.0; Z];
        for i in 0..2 {
            add(&mut moved, -tangents[i][axis], &v.place[i]);
            turned[3 * (1 + i) + axis] += tau[i];
            let curve = second[SECOND[i][0]][axis] * tau[0] + second[SECOND[i][1]][axis] * tau[1];
            add(&mut turned, curve, &v.place[i]);
        }
        out.outer_both(1.0, &moved, &turned);
    }
}

/// Force and tangent of a pair of patches, component-major: entry `k n + a` is component `k` of node `a`, those of the
/// secondary patch first.
#[derive(Clone, Debug, Default)]
pub struct PairBuffer {
    /// Forces \[N\].
    pub force: Vec<f64>,
    /// Stiffness \[N/mm\], row-major; symmetric, only entries with row node <= column node are there.
    pub stiffness: Vec<f64>,
    /// Of every point the six vectors of its [`Coupling`], spread to the nodes.
    pub couplings: Vec<f64>,
}

impl PairBuffer {
    /// Zeros for `n` nodes.
    pub fn reset(&mut self, n: usize, tangent: bool) {
        self.force.clear();
        self.force.resize(3 * n, 0.0);
        self.stiffness.clear();
        self.couplings.clear();
        if tangent {
            self.stiffness.resize(9 * n * n, 0.0);
        }
    }

    /// Spreads the terms of a point with area `area` \[mm^2\] to the nodes; `own` are the shape functions of the point on
    /// the secondary patch, `count` its nodes.
    pub fn spread(&mut self, terms: &PointTerms, own: &[f64; PATCH_NODES], count: usize, foot: &Foot, area: f64) {
        let shape = &foot.local.shape;
        let other = shape.n;
        let n = count + other;
        let mut weights = [[0.0; 2 * PATCH_NODES]; 6];
        weights[0][..count].copy_from_slice(&own[..count]);
        for b in 0..other {
            weights[0][count + b] = -shape.value[b];
            weights[1][count + b] = shape.first[0][b];
            weights[2][count + b] = shape.first[1][b];
            for k in 0..3 {
                weights[3 + k][count + b] = shape.second[k][b];
            }
        }
        let used = &weights[..terms.blocks];
        for k in 0..3 {
            for (i, w) in used.iter().enumerate() {
                let f = area * terms.force[3 * i + k];
                let target = &mut self.force[k * n..(k + 1) * n];
                target.iter_mut().zip(w).for_each(|(o, w)| *o += f * w);
            }
        }
        if self.stiffness.is_empty() {
            return;
        }
        for k in 0..3 {
            for m in 0..3 {
                self.spread_block(terms, used, (k, m), (count, n), area);
            }
        }
        if let Some(coupling) = &terms.coupling {
            let scaled = [&coupling.place, &coupling.rest, &coupling.lagged].into_iter().zip([1.0, area, area]);
            for (form, scale) in scaled.flat_map(|(forms, s)| forms.iter().map(move |f| (f, s))) {
                self.spread_form(form, used, n, scale);
            }
        }
    }

    /// Appends a form as a nodal vector.
    fn spread_form(&mut self, form: &Form, weights: &[[f64; 2 * PATCH_NODES]], n: usize, scale: f64) {
        let start = self.couplings.len();
        self.couplings.resize(start + 3 * n, 0.0);
        for (k, line) in self.couplings[start..].chunks_exact_mut(n).enumerate() {
            for (i, w) in weights.iter().enumerate() {
                let f = scale * form[3 * i + k];
                line.iter_mut().zip(w).for_each(|(o, w)| *o += f * w);
            }
        }
    }

    /// The products of all points, four of each.
    pub fn products(&self) -> impl Iterator<Item = Product<'_>> {
        let n = self.force.len();
        self.couplings.chunks_exact(6 * n).flat_map(move |all| {
            let [place, rest, lagged] = [0, 2, 4].map(|k| [&all[k * n..(k + 1) * n], &all[(k + 1) * n..(k + 2) * n]]);
            let product = |row, column| Product { row, column };
            [
                product(place[0], rest[0]),
                product(place[1], rest[1]),
                product(lagged[0], place[0]),
                product(lagged[1], place[1]),
            ]
        })
    }

    /// Components `k` of rows and `m` of columns.
    fn spread_block(
        &mut self,
        terms: &PointTerms,
        weights: &[[f64; 2 * PATCH_NODES]],
        (k, m): (usize, usize),
        (count, n): (usize, usize),
        area: f64,
    ) {
        for (i, row_weights) in weights.iter().enumerate() {
            // Row i of the block times the weights of the columns.
            let mut line = [0.0; 2 * PATCH_NODES];
            for (j, column_weights) in weights.iter().enumerate() {
                let f = area * terms.tangent[3 * i + k][3 * j + m];
                if f != 0.0 {
                    line.iter_mut().zip(column_weights).for_each(|(o, w)| *o += f * w);
                }
            }
            let first = if i == 0 { 0 } else { count };
            for (a, &w) in row_weights.iter().enumerate().take(n).skip(first) {
                let at = (k * n + a) * 3 * n + m * n;
                let line = &line[a..n];
                self.stiffness[at + a..at + n].iter_mut().zip(line).for_each(|(o, l)| *o += w * l);
            }
        }
    }
}
