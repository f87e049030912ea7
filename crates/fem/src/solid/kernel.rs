//! The element's inner loops: gradients, forces and stiffness of one integration point.
//!
//! Everything is written for shape-function gradients by *fibre-frame* coordinates, `g_j(a) = dN_a/dX_j`, formed once
//! from the reference mesh. With `R` the fibre frame (columns e1 e2 e3) and `H = grad u`:
//! `HR_kj = sum_a u_k(a) g_j(a)`, `FR = R + HR` (spatial rows, fibre-frame columns), `H_f = R^T HR` for the law.
//! Then `dE_ij = sym(FR_ki g_j(a)) du_k(a)`, the force is `P_kj g_j` with `P = FR S`, and the stiffness is
//! `K_(ak)(bm) = g_j(a) A_kjml g_l(b)` with `A_kjml = FR_ki D_(ij)(pl) FR_mp + delta_km S_jl`.
//! Sums run over node lanes in the innermost loop, which is what the compiler turns into SIMD.

use nalgebra::{Matrix3, Matrix6, Vector6};

/// Per-node numbers of an element by component: `[component][node]`.
pub type NodeVector<const N: usize> = [[f64; N]; 3];

/// Element matrix, component-major: `[k][a][m][b]`.
pub type NodeMatrix<const N: usize> = [[[[f64; N]; 3]; N]; 3];

/// Geometry of an integration point, formed once.
#[derive(Clone, Debug)]
pub struct PointGeometry<const N: usize> {
    /// Gradients by fibre-frame coordinates \[1/mm\].
    pub gradient: NodeVector<N>,
    /// Fibre frame, columns e1 e2 e3.
    pub frame: Matrix3<f64>,
    /// Reference volume of the point \[mm^3\].
    pub volume: f64,
}

/// `1/sqrt(2)`: from a Mandel shear entry to the tensor's.
const HALF_ROOT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Mandel index of a symmetric pair.
pub const MANDEL: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// Factor from a Mandel entry to a tensor entry.
const FACTOR: [[f64; 3]; 3] = [[1.0, HALF_ROOT, HALF_ROOT], [HALF_ROOT, 1.0, HALF_ROOT], [HALF_ROOT, HALF_ROOT, 1.0]];

/// `HR = sum_a u(a) g(a)^T`.
#[inline(always)]
pub fn mixed_gradient<const N: usize>(u: &NodeVector<N>, g: &NodeVector<N>) -> Matrix3<f64> {
    let mut out = Matrix3::zeros();
    for k in 0..3 {
        for j in 0..3 {
            let mut sum = 0.0;
            for a in 0..N {
                sum += u[k][a] * g[j][a];
            }
            out[(k, j)] = sum;
        }
    }
    out
}

/// Tensor of a Mandel vector.
#[inline(always)]
pub fn tensor(v: &Vector6<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| FACTOR[i][j] * v[MANDEL[i][j]])
}

/// Adds `scale * (FR V)_kj g_j(a)`: the nodal forces of a stress, or the nodal gradient of a strain measure, `V`.
#[inline(always)]
pub fn add_force<const N: usize>(
    fr: &Matrix3<f64>,
    v: &Vector6<f64>,
    scale: f64,
    g: &NodeVector<N>,
    out: &mut NodeVector<N>,
) {
    let p = fr * tensor(v) * scale;
    for k in 0..3 {
        for a in 0..N {
            out[k][a] += p[(k, 0)] * g[0][a] + p[(k, 1)] * g[1][a] + p[(k, 2)] * g[2][a];
        }
    }
}

/// First elasticity tensor `A_kjml` times the point's volume, as `a[k][j][m][l]`.
#[inline(always)]
fn first_elasticity(fr: &Matrix3<f64>, s: &Vector6<f64>, d: &Matrix6<f64>, volume: f64) -> [[[[f64; 3]; 3]; 3]; 3] {
    // half[I][m][l] = sum_p D_(I)(pl) FR_mp, I a Mandel row scaled to a tensor entry.
    let mut half = [[[0.0; 3]; 3]; 6];
    for (row, block) in half.iter_mut().enumerate() {
        let scale = if row < 3 { volume } else { volume * HALF_ROOT };
        for l in 0..3 {
            let c: [f64; 3] = std::array::from_fn(|p| scale * FACTOR[p][l] * d[(row, MANDEL[p][l])]);
            for (m, line) in block.iter_mut().enumerate() {
                line[l] = c[0] * fr[(m, 0)] + c[1] * fr[(m, 1)] + c[2] * fr[(m, 2)];
            }
        }
    }
    let mut a = [[[[0.0; 3]; 3]; 3]; 3];
    for k in 0..3 {
        for j in 0..3 {
            let rows = [MANDEL[0][j], MANDEL[1][j], MANDEL[2][j]];
            for m in 0..3 {
                for l in 0..3 {
                    a[k][j][m][l] = fr[(k, 0)] * half[rows[0]][m][l]
                        + fr[(k, 1)] * half[rows[1]][m][l]
                        + fr[(k, 2)] * half[rows[2]][m][l];
                }
            }
        }
    }
    for j in 0..3 {
        for l in 0..3 {
            let geometric = volume * FACTOR[j][l] * s[MANDEL[j][l]];
            for (k, block) in a.iter_mut().enumerate() {
                block[j][k][l] += geometric;
            }
        }
    }
    a
}

/// Lanes of a chunk: rows are worked in chunks of four nodes, which fill one 256-bit register.
const LANES: usize = 4;

/// `row += g . t` over the node lanes from the chunk of lane `first` on.
#[inline(always)]
fn add_row<const N: usize>(g: [f64; 3], t: &NodeVector<N>, first: usize, row: &mut [f64; N]) {
    let whole = N / LANES * LANES;
    let mut lane = first / LANES * LANES;
    while lane < whole {
        for b in lane..lane + LANES {
            row[b] += g[0] * t[0][b] + g[1] * t[1][b] + g[2] * t[2][b];
        }
        lane += LANES;
    }
    for b in whole..N {
        row[b] += g[0] * t[0][b] + g[1] * t[1][b] + g[2] * t[2][b];
    }
}

/// Adds the stiffness of a point: material tangent `d` and geometric part of the stress `s`. When `SYMMETRIC` only
/// entries with row node <= column node are meaningful afterwards.
#[inline(always)]
pub fn add_stiffness<const N: usize, const SYMMETRIC: bool>(
    fr: &Matrix3<f64>,
    s: &Vector6<f64>,
    d: &Matrix6<f64>,
    point: &PointGeometry<N>,
    out: &mut NodeMatrix<N>,
) {
    let g = &point.gradient;
    let elasticity = first_elasticity(fr, s, d, point.volume);
    for k in 0..3 {
        for m in 0..3 {
            let mut t = [[0.0; N]; 3];
            for j in 0..3 {
                let c = &elasticity[k][j][m];
                for b in 0..N {
                    t[j][b] = c[0] * g[0][b] + c[1] * g[1][b] + c[2] * g[2][b];
                }
            }
            for a in 0..N {
                let first = if SYMMETRIC { a } else { 0 };
                add_row([g[0][a], g[1][a], g[2][a]], &t, first, &mut out[k][a][m]);
            }
        }
    }
}

/// Adds `scale * left (x) right` of two nodal vectors.
#[inline(always)]
pub fn add_dyad<const N: usize>(left: &NodeVector<N>, right: &NodeVector<N>, scale: f64, out: &mut NodeMatrix<N>) {
    for k in 0..3 {
        for a in 0..N {
            let value = scale * left[k][a];
            for m in 0..3 {
                for b in 0..N {
                    out[k][a][m][b] += value * right[m][b];
                }
            }
        }
    }
}
