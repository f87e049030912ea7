//! Finite rotations as rotation vectors: exponential map, its tangent and the derivative of that tangent.
//!
//! With `theta = |omega|`: `R = 1 + c1 [w] + c2 [w]^2`, `T = 1 + c2 [w] + c3 [w]^2`, where `[w] a = omega x a` and
//! `c1 = sin(theta)/theta`, `c2 = (1 - cos(theta))/theta^2`, `c3 = (theta - sin(theta))/theta^3`. A variation of the
//! rotation vector turns the body by the spatial spin `T d(omega)`. `T` is singular at `theta = 2 pi, 4 pi, ...`.
//! Source: Cardona and Geradin, Int. J. Numer. Meth. Engng 26 (1988) 2403.

use nalgebra::{Matrix3, Vector3};

/// Coefficients of the exponential map and of its tangent, and their derivatives by theta over theta.
struct Coefficients {
    c1: f64,
    c2: f64,
    c3: f64,
    d2: f64,
    d3: f64,
}

/// Below this angle the power series is exact to rounding and the closed form cancels.
const SERIES_ANGLE: f64 = 0.25;

fn coefficients(theta: f64) -> Coefficients {
    let x = theta * theta;
    if theta < SERIES_ANGLE {
        return series(x);
    }
    let (s, c) = theta.sin_cos();
    // 1 - cos by the half angle: no cancellation.
    let half = (0.5 * theta).sin();
    let versine = 2.0 * half * half;
    Coefficients {
        c1: s / theta,
        c2: versine / x,
        c3: (theta - s) / (x * theta),
        d2: (theta * s - 2.0 * versine) / (x * x),
        d3: (3.0 * s - theta * c - 2.0 * theta) / (x * x * theta),
    }
}

/// `sum_k (-x)^k / (2k + n)!` and its derivative by x, times 2 (derivative by theta over theta).
fn alternating(x: f64, n: u32) -> (f64, f64) {
    let mut factorial: f64 = (1..=n).map(f64::from).product();
    let (mut value, mut slope, mut power) = (0.0, 0.0, 1.0);
    let mut previous_power = 0.0;
    for k in 0..9_u32 {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        value += sign * power / factorial;
        slope += sign * f64::from(k) * previous_power / factorial;
        previous_power = power;
        power *= x;
        factorial *= f64::from((2 * k + n + 1) * (2 * k + n + 2));
    }
    (value, 2.0 * slope)
}

fn series(x: f64) -> Coefficients {
    let (c1, _) = alternating(x, 1);
    let (c2, d2) = alternating(x, 2);
    let (c3, d3) = alternating(x, 3);
    Coefficients { c1, c2, c3, d2, d3 }
}

/// A rotation given by its rotation vector \[rad\], with what the kinematics need of it.
#[derive(Clone, Debug)]
pub struct Rotation {
    vector: Vector3<f64>,
    /// `R - 1`: kept apart so that a rotation of 1e-14 survives.
    increment: Matrix3<f64>,
    tangent: Matrix3<f64>,
}

impl Rotation {
    /// Exponential map of a rotation vector \[rad\].
    #[must_use]
    pub fn new(vector: Vector3<f64>) -> Self {
        let c = coefficients(vector.norm());
        let spin = vector.cross_matrix();
        let spin2 = spin * spin;
        Self {
            vector,
            increment: spin * c.c1 + spin2 * c.c2,
            tangent: Matrix3::identity() + spin * c.c2 + spin2 * c.c3,
        }
    }

    /// `R a - a`.
    #[must_use]
    pub fn displacement(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        self.increment * arm
    }

    /// `R a`.
    #[must_use]
    pub fn rotate(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        arm + self.increment * arm
    }

    /// `T`: spatial spin by variation of the rotation vector.
    #[must_use]
    pub fn tangent(&self) -> &Matrix3<f64> {
        &self.tangent
    }

    /// Second derivative by the rotation vector of `sum_i f_i . R a_i`, from the sums
    /// `moment = sum (R a_i) x f_i` and `dyad = sum (R a_i) f_i^T`. Symmetric.
    #[must_use]
    pub fn second_derivative(&self, moment: &Vector3<f64>, dyad: &Matrix3<f64>) -> Matrix3<f64> {
        let spatial = dyad - Matrix3::identity() * dyad.trace();
        let full = self.tangent.transpose() * spatial * self.tangent + self.tangent_derivative(moment);
        0.5 * (full + full.transpose())
    }

    /// `d(T^T m)/d(omega)` for a fixed vector m.
    fn tangent_derivative(&self, m: &Vector3<f64>) -> Matrix3<f64> {
        let w = &self.vector;
        let c = coefficients(w.norm());
        // T^T m = m - c2 w x m + c3 w x (w x m), and w x (w x m) = w (w.m) - m (w.w).
        let wm = w.dot(m);
        let cross = w.cross(m);
        let double = w * wm - m * w.norm_squared();
        let by_cross = m.cross_matrix();
        let by_double = w * m.transpose() + Matrix3::identity() * wm - m * w.transpose() * 2.0;
        by_cross * c.c2 - cross * w.transpose() * c.d2 + by_double * c.c3 + double * w.transpose() * c.d3
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const VECTORS: [[f64; 3]; 5] =
        [[0.0, 0.0, 0.0], [1e-9, 2e-9, -1e-9], [0.1, -0.2, 0.1], [1.5, 0.3, -0.7], [2.9, -1.0, 3.5]];

    #[test]
    fn orthogonal_and_continuous_over_the_series_limit() {
        for v in VECTORS {
            let r = Rotation::new(Vector3::from(v));
            let full = Matrix3::identity() + r.increment;
            assert_relative_eq!(full.transpose() * full, Matrix3::identity(), epsilon = 1e-14);
        }
        let below = coefficients(SERIES_ANGLE * (1.0 - 1e-15));
        let above = coefficients(SERIES_ANGLE);
        assert_relative_eq!(below.c3, above.c3, max_relative = 1e-12);
        assert_relative_eq!(below.d2, above.d2, max_relative = 1e-9);
        assert_relative_eq!(below.d3, above.d3, max_relative = 1e-7);
    }

    #[test]
    fn tangent_and_second_derivative_match_differences() {
        let (arm, force) = (Vector3::new(0.3, -1.2, 0.8), Vector3::new(-2.0, 0.5, 1.1));
        for v in VECTORS {
            let vector = Vector3::from(v);
            let gradient = |w: Vector3<f64>| {
                let r = Rotation::new(w);
                r.tangent.transpose() * r.rotate(&arm).cross(&force)
            };
            let rotation = Rotation::new(vector);
            let y = rotation.rotate(&arm);
            let hessian = rotation.second_derivative(&y.cross(&force), &(y * force.transpose()));
            let h = 1e-6;
            for j in 0..3 {
                let mut step = Vector3::zeros();
                step[j] = h;
                let column = (gradient(vector + step) - gradient(vector - step)) / (2.0 * h);
                assert_relative_eq!(column, hessian.column(j).into_owned(), epsilon = 2e-8);
                let energy = |w: Vector3<f64>| force.dot(&Rotation::new(w).rotate(&arm));
                let slope = (energy(vector + step) - energy(vector - step)) / (2.0 * h);
                assert_relative_eq!(slope, gradient(vector)[j], epsilon = 1e-8);
            }
        }
    }
}
