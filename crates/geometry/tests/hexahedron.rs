//! Shape functions, quadrature and the isoparametric map of hexahedra and quadrilaterals.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use subrope_geometry::quadrilateral::{face_area, map_surface_point};
use subrope_geometry::{
    CellKind, Hex8, Hex20, Hex20R, Hex27, Hexahedron, Quad4, Quad8, Quad9, Quadrilateral, map_point,
};

const XI: [f64; 3] = [0.31, -0.47, 0.83];

fn check_shape<H: Hexahedron<N>, const N: usize>(xi: [f64; 3]) {
    assert!((H::shape(xi).iter().sum::<f64>() - 1.0).abs() < 1e-14, "partition of unity");
    let gradient = H::gradient(xi);
    for (i, row) in gradient.iter().enumerate() {
        assert!(row.iter().sum::<f64>().abs() < 1e-14, "gradients sum to zero");
        let h = 1e-5;
        let (mut low, mut high) = (xi, xi);
        low[i] -= h;
        high[i] += h;
        let (low, high) = (H::shape(low), H::shape(high));
        for a in 0..N {
            let difference = (high[a] - low[a]) / (2.0 * h);
            assert!((row[a] - difference).abs() < 1e-9, "dN_{a}/dxi_{i}: {} against {difference}", row[a]);
        }
    }
}

fn check_kronecker<H: Hexahedron<N>, const N: usize>() {
    for (b, &xi) in H::NODES.iter().enumerate() {
        for (a, value) in H::shape(xi).into_iter().enumerate() {
            assert_eq!(value, if a == b { 1.0 } else { 0.0 }, "N_{a} at node {b}");
        }
    }
    assert_eq!((H::KIND.nodes(), H::KIND.points()), (N, H::quadrature().len()));
}

#[test]
fn shape_functions_at_nodes_are_kronecker() {
    check_kronecker::<Hex8, 8>();
    check_kronecker::<Hex20, 20>();
    check_kronecker::<Hex20R, 20>();
    check_kronecker::<Hex27, 27>();
}

/// The Gauss rule with L points per direction integrates x^i y^j z^k, i, j, k <= 2 L - 1, exactly.
#[test]
fn quadrature_is_exact_to_its_degree() {
    for (rule, degree) in [(Hex8::quadrature(), 3), (Hex20R::quadrature(), 3), (Hex27::quadrature(), 5)] {
        let exact = |n: i32| {
            if n % 2 == 0 { 2.0 / f64::from(n + 1) } else { 0.0 }
        };
        for (i, j, k) in (0..=degree).flat_map(|i| (0..=degree).flat_map(move |j| (0..=degree).map(move |k| (i, j, k))))
        {
            let sum: f64 = rule.iter().map(|p| p.weight * p.xi[0].powi(i) * p.xi[1].powi(j) * p.xi[2].powi(k)).sum();
            assert!((sum - exact(i) * exact(j) * exact(k)).abs() < 1e-14, "x^{i} y^{j} z^{k}: {sum}");
        }
    }
}

#[test]
fn quadrature_runs_fastest_in_the_first_coordinate() {
    let rule = Hex27::quadrature();
    assert!(rule[0].xi[0] < rule[1].xi[0] && rule[0].xi[1] == rule[1].xi[1]);
    assert!(rule[0].xi[1] < rule[3].xi[1] && rule[0].xi[2] < rule[9].xi[2]);
    assert_eq!(rule[13].xi, [0.0; 3]);
}

/// Mid-edge and mid-face nodes of VTK's tri-quadratic hexahedron are the means of these corners.
#[test]
fn nodes_of_27_follow_vtk() {
    let means: [&[usize]; 19] = [
        &[0, 1],
        &[1, 2],
        &[2, 3],
        &[3, 0],
        &[4, 5],
        &[5, 6],
        &[6, 7],
        &[7, 4],
        &[0, 4],
        &[1, 5],
        &[2, 6],
        &[3, 7],
        &[0, 4, 7, 3],
        &[1, 2, 6, 5],
        &[0, 1, 5, 4],
        &[3, 7, 6, 2],
        &[0, 1, 2, 3],
        &[4, 5, 6, 7],
        &[0, 1, 2, 3, 4, 5, 6, 7],
    ];
    assert_eq!(Hex27::NODES[..8], Hex8::NODES[..]);
    assert_eq!(Hex27::NODES[..20], Hex20::NODES[..]);
    assert_eq!(Hex20R::NODES, Hex20::NODES);
    for (node, corners) in (8..).zip(means) {
        let sum: Vector3<f64> = corners.iter().map(|&c| Vector3::from(Hex8::NODES[c])).sum();
        assert_eq!(Vector3::from(Hex27::NODES[node]), sum / corners.len() as f64, "node {node}");
    }
}

#[test]
fn faces_point_outwards_and_carry_their_nodes() {
    // S1 to S6 of an Abaqus C3D8, one-based.
    let abaqus = [[1, 2, 3, 4], [5, 8, 7, 6], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 8, 4], [4, 8, 5, 1]];
    for (face, list) in (0_u8..).zip(abaqus) {
        let four = CellKind::Hex8.face(face).unwrap();
        let mut same = four.iter().map(|n| n + 1).collect::<Vec<_>>();
        let mut expected = list.to_vec();
        same.sort_unstable();
        expected.sort_unstable();
        assert_eq!(same, expected);
        let nodes: [Vector3<f64>; 4] = std::array::from_fn(|a| Hex8::NODES[four[a]].into());
        let at = map_surface_point::<Quad4, 4>(&nodes, [0.2, -0.3]);
        assert!(at.area_normal.dot(&at.position) > 0.9, "face {face}: {}", at.area_normal);
        let nine = CellKind::Hex27.face(face).unwrap();
        assert_eq!(nine[..4], *four);
        let nodes: [Vector3<f64>; 9] = std::array::from_fn(|a| Hex27::NODES[nine[a]].into());
        assert_eq!(nine[..8], *CellKind::Hex20.face(face).unwrap());
        for (xi, node) in Quad9::NODES.into_iter().zip(nodes) {
            let bilinear = map_surface_point::<Quad4, 4>(&nodes[..4].try_into().unwrap(), xi).position;
            assert!((bilinear - node).norm() < 1e-15, "face {face}");
        }
    }
    assert!(CellKind::Hex8.face(6).is_none());
}

fn check_affine_map<H: Hexahedron<N>, const N: usize>(f: &Matrix3<f64>, c: &Vector3<f64>, xi: [f64; 3]) {
    let nodes = H::NODES.map(|x| f * Vector3::from(x) + c);
    let Ok(point) = map_point::<H, N>(&nodes, xi) else {
        assert!(f.determinant() <= 1e-12);
        return;
    };
    assert!((point.jacobian - f).amax() < 1e-13 * (1.0 + c.amax()));
    assert!((point.position - (f * Vector3::from(xi) + c)).amax() < 1e-13 * (1.0 + c.amax()));
    // The physical gradient of a linear field a . X is a.
    let a = Vector3::new(0.3, -1.2, 0.7);
    let slope: [f64; 3] = std::array::from_fn(|i| (0..N).map(|n| point.gradient[i][n] * a.dot(&nodes[n])).sum());
    assert!((Vector3::from(slope) - a).amax() < 1e-10 / point.determinant.min(1.0));
}

#[test]
fn physical_gradients_match_differences_on_a_curved_cell() {
    let bend =
        |x: [f64; 3]| Vector3::new(x[0] + 0.1 * x[1] * x[1], 1.3 * x[1] + 0.1 * x[0] * x[2], x[2] - 0.08 * x[0] * x[0]);
    let nodes = Hex27::NODES.map(bend);
    let point = map_point::<Hex27, 27>(&nodes, XI).unwrap();
    for a in 0..27 {
        let natural = Hex27::gradient(XI);
        let back =
            point.jacobian.transpose() * Vector3::new(point.gradient[0][a], point.gradient[1][a], point.gradient[2][a]);
        for i in 0..3 {
            assert!((back[i] - natural[i][a]).abs() < 1e-13);
        }
    }
    assert!((point.position - bend(XI)).norm() < 1e-14, "the map is quadratic");
}

#[test]
fn inverted_and_flat_maps_are_refused() {
    let mirrored = Hex8::NODES.map(|[x, y, z]| Vector3::new(y, x, z));
    assert!(map_point::<Hex8, 8>(&mirrored, [0.0; 3]).is_err());
    let flat = Hex8::NODES.map(|[x, y, _]| Vector3::new(x, y, 0.0));
    assert!(map_point::<Hex8, 8>(&flat, [0.0; 3]).is_err());
}

#[test]
fn quadrilaterals_are_kronecker_and_integrate_areas() {
    for (b, &xi) in Quad4::NODES.iter().enumerate() {
        assert!(Quad4::shape(xi).iter().enumerate().all(|(a, &n)| n == f64::from(u8::from(a == b))));
    }
    for (b, &xi) in Quad8::NODES.iter().enumerate() {
        assert_eq!(xi, Quad9::NODES[b]);
        assert!(Quad8::shape(xi).iter().enumerate().all(|(a, &n)| n == f64::from(u8::from(a == b))));
    }
    for (b, &xi) in Quad9::NODES.iter().enumerate() {
        assert!(Quad9::shape(xi).iter().enumerate().all(|(a, &n)| n == f64::from(u8::from(a == b))));
    }
    let trapezium = [[0.0, 0.0], [4.0, 0.0], [3.0, 2.0], [1.0, 2.0]].map(|[x, y]| Vector3::new(x, y, 0.5 * x));
    assert!((face_area::<Quad4, 4>(&trapezium) - 6.0 * 1.25_f64.sqrt()).abs() < 1e-13);
    check_slopes::<Quad8, 8>();
    check_slopes::<Quad9, 9>();
}

fn check_slopes<Q: Quadrilateral<N>, const N: usize>() {
    let h = 1e-6;
    let [slope_x, slope_y] = Q::gradient([0.2, -0.6]);
    for a in 0..N {
        let dx = (Q::shape([0.2 + h, -0.6])[a] - Q::shape([0.2 - h, -0.6])[a]) / (2.0 * h);
        let dy = (Q::shape([0.2, -0.6 + h])[a] - Q::shape([0.2, -0.6 - h])[a]) / (2.0 * h);
        assert!((slope_x[a] - dx).abs() < 1e-9 && (slope_y[a] - dy).abs() < 1e-9);
    }
}

/// Shares of a uniform load on a square of eight nodes, as every textbook has them.
#[test]
fn corners_of_a_serendipity_face_pull_against_a_load() {
    let mut shares = [0.0; 8];
    for point in Quad8::quadrature() {
        shares.iter_mut().zip(Quad8::shape(point.xi)).for_each(|(s, n)| *s += 0.25 * point.weight * n);
    }
    for (a, share) in shares.into_iter().enumerate() {
        assert!((share - if a < 4 { -1.0 / 12.0 } else { 1.0 / 3.0 }).abs() < 1e-15, "{shares:?}");
    }
}

/// The serendipity map has all quadratics and the products of two or three coordinates, quadratic in one of them at most.
#[test]
fn twenty_nodes_reproduce_quadratics() {
    let field = |[x, y, z]: [f64; 3]| 1.0 + x * x - 2.0 * y * z + 0.3 * x * y * z + 0.7 * x * x * y - z * z * x * y;
    let value: f64 = Hex20::NODES.iter().zip(Hex20::shape(XI)).map(|(&node, n)| n * field(node)).sum();
    assert!((value - field(XI)).abs() < 1e-15, "{value} {}", field(XI));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn shape_functions_hold_everywhere(x in -1.0..1.0, y in -1.0..1.0, z in -1.0..1.0) {
        check_shape::<Hex8, 8>([x, y, z]);
        check_shape::<Hex20, 20>([x, y, z]);
        check_shape::<Hex27, 27>([x, y, z]);
    }

    #[test]
    fn affine_maps_are_reproduced(
        f in prop::array::uniform9(-2.0..2.0_f64), c in prop::array::uniform3(-50.0..50.0_f64),
    ) {
        let f = Matrix3::from_row_slice(&f);
        check_affine_map::<Hex8, 8>(&f, &c.into(), XI);
        check_affine_map::<Hex20, 20>(&f, &c.into(), XI);
        check_affine_map::<Hex27, 27>(&f, &c.into(), XI);
    }
}
