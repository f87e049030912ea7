//! Uniform cubic B-splines on one span.

/// Values and derivatives by xi in \[-1, 1\] of the four cubic B-splines that live on a span, `[order][spline]`,
/// orders 0 to 3.
///
/// With t = (1 + xi)/2: (1 - t)^3/6, (3 t^3 - 6 t^2 + 4)/6, (1 + 3 t + 3 t^2 - 3 t^3)/6, t^3/6. Their sum is one and they
/// reproduce linear functions of the control points.
#[must_use]
pub fn cubic(xi: f64) -> [[f64; 4]; 4] {
    let t = 0.5 * (1.0 + xi);
    let s = 1.0 - t;
    [
        [
            s * s * s / 6.0,
            (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
            (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
            t * t * t / 6.0,
        ],
        [-0.25 * s * s, 0.25 * (3.0 * t * t - 4.0 * t), -0.25 * (3.0 * s * s - 4.0 * s), 0.25 * t * t],
        [0.25 * s, 0.25 * (3.0 * t - 2.0), 0.25 * (3.0 * s - 2.0), 0.25 * t],
        [-0.125, 0.375, -0.375, 0.125],
    ]
}

#[cfg(test)]
mod tests {
    use super::cubic;

    #[test]
    fn derivatives_agree_with_differences() {
        let h = 1e-5;
        for xi in [-0.9, -0.2, 0.3, 0.8] {
            for order in 0..3 {
                for k in 0..4 {
                    let slope = (cubic(xi + h)[order][k] - cubic(xi - h)[order][k]) / (2.0 * h);
                    assert!((slope - cubic(xi)[order + 1][k]).abs() < 1e-9, "order {order}, spline {k}");
                }
            }
        }
    }

    #[test]
    fn linear_functions_are_reproduced_across_spans() {
        for xi in [-1.0, 0.1, 1.0] {
            let value: f64 = cubic(xi)[0].iter().enumerate().map(|(k, n)| n * (k as f64 - 1.0)).sum();
            assert!((value - 0.5 * (1.0 + xi)).abs() < 1e-15);
        }
        let (end, start) = (cubic(1.0), cubic(-1.0));
        for order in 0..3 {
            for k in 1..4 {
                assert!((end[order][k] - start[order][k - 1]).abs() < 1e-15, "C2 at the knot");
            }
        }
    }
}
