//! Assembly of a strand allocates nothing once its buffers have grown.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(unsafe_code, reason = "a global allocator that counts is unsafe by its trait; it only passes calls on")]

use std::alloc::{GlobalAlloc, Layout, System as Heap};
use std::cell::Cell;
use std::f64::consts::PI;

use nalgebra::Vector3;
use subrope_fem::kinematics::{Kinematics, NodeRule, Section, SectionKind};
use subrope_fem::linear::SolverOptions;
use subrope_fem::{Configuration, Contribution, Evaluation, Request, System};
use subrope_geometry::{Axis, HelicalFibres, Lay, Mesh, Strand, fibre_frames, strand::sets};
use subrope_material::{BundleLaw, BundleParameters, Compaction, Friction, ModeParameters};
use subrope_tests::{Brick, brick};

/// The system's allocator with a count per thread of what it hands out.
struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

fn count_one() {
    // A thread that ends may still free, and then has no counter any more.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: every call goes to the system's allocator unchanged; the counter neither allocates nor unwinds.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_one();
        // SAFETY: the caller's promise is passed on.
        unsafe { Heap.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count_one();
        // SAFETY: the caller's promise is passed on.
        unsafe { Heap.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count_one();
        // SAFETY: the caller's promise is passed on.
        unsafe { Heap.realloc(block, layout, size) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { Heap.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations_of(work: impl FnOnce()) -> usize {
    let before = COUNT.get();
    work();
    COUNT.get() - before
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations_of(|| drop(std::hint::black_box(vec![1_u8; 10]))), 1);
}

/// Set C with a low longitudinal threshold, so that both modes slide; with `mu` its tangent is unsymmetric.
fn law(mu: f64) -> BundleLaw {
    let mode = |k, tau, h| ModeParameters::sliding(k, Friction { mu, ..Friction::isotropic(tau, h) });
    BundleLaw::new(BundleParameters {
        k_e: 2000.0,
        k_ec: 100.0,
        w_e: 0.005,
        k_c: 60.0,
        nu: 0.5,
        compaction: Compaction::Quadratic,
        transverse: mode(15.0, 0.05, 0.1),
        longitudinal: mode(20.0, 1e-3, 0.3),
    })
    .unwrap()
}

/// A strand between two sections, ready to be assembled at coordinates that make points slide.
struct Ready {
    kinematics: Kinematics,
    contributions: Vec<Box<dyn Contribution>>,
    system: System,
    q: Vec<f64>,
    displacement: Vec<f64>,
    nodal: Vec<f64>,
    residual: Vec<f64>,
}

impl Ready {
    fn new(kind: Brick, section: SectionKind, mu: f64) -> Self {
        let strand = Strand { kind: kind.kind(), layers: layers(kind), ..Strand::default() };
        let mesh = strand.mesh().unwrap();
        let axis = Axis::new(Vector3::zeros(), Vector3::z()).unwrap();
        let field = HelicalFibres::new(axis, Lay::from_rate((PI / 6.0).tan() / 2.785).unwrap());
        let solid = brick(kind, &mesh, &fibre_frames(&mesh, &field).unwrap(), law(mu)).unwrap();
        let kinematics = Kinematics::new(mesh.points.clone(), ends(&mesh, &section)).unwrap();
        let contributions = vec![solid];
        let count = kinematics.coordinate_count();
        let free = vec![false; count];
        let system = System::new(&kinematics, &contributions, &free, &SolverOptions::default()).unwrap();
        let mut q = vec![0.0; count];
        for (rule, x) in kinematics.rules().iter().zip(&mesh.points) {
            if let NodeRule::Free { first } = rule {
                q[*first as usize..*first as usize + 3].copy_from_slice((bent(x) - x).as_slice());
            }
        }
        for point in kinematics.points() {
            let first = point.first as usize;
            q[first..first + 3].copy_from_slice((bent(&point.position) - point.position).as_slice());
            q[first + 3] = CURVATURE * point.position.z;
        }
        let nodal = vec![0.0; 3 * mesh.point_count()];
        Self { kinematics, contributions, system, q, displacement: nodal.clone(), nodal, residual: vec![0.0; count] }
    }

    fn assemble(&mut self, request: Request) {
        self.kinematics.displacements(&self.q, &mut self.displacement);
        let at = Evaluation {
            q: &self.q,
            configuration: Configuration {
                displacement: &self.displacement,
                committed: &self.nodal,
                time_increment: 1.0,
                time: 1.0,
                temperature: 293.15,
                predicting: false,
                parallel: false,
            },
            external: &self.nodal,
            jump: None,
            request,
        };
        let out = self.system.assemble(&self.kinematics, &mut self.contributions, &at, &mut self.residual).unwrap();
        assert!(out.energies.dissipated_mid.iter().all(|d| *d > 0.0), "not everything slides: {:?}", out.energies);
    }
}

const CURVATURE: f64 = 0.02;

/// Place on an arc in the y-z plane of what was at x, sections plane.
fn bent(x: &Vector3<f64>) -> Vector3<f64> {
    let (sin, cos) = (CURVATURE * x.z).sin_cos();
    Vector3::new(x.x, (cos - 1.0) / CURVATURE + x.y * cos, sin / CURVATURE + x.y * sin)
}

fn layers(kind: Brick) -> usize {
    if kind == Brick::Quadratic { 6 } else { 50 }
}

fn ends(mesh: &Mesh, kind: &SectionKind) -> Vec<Section> {
    [(sets::END_A, f64::min as fn(f64, f64) -> f64), (sets::END_B, f64::max)]
        .map(|(name, pick)| Section {
            name: name.into(),
            position: Vector3::new(0.0, 0.0, mesh.points.iter().map(|p| p.z).reduce(pick).unwrap()),
            axis: Vector3::z(),
            nodes: mesh.node_sets[name].clone(),
            kind: kind.clone(),
        })
        .into()
}

#[test]
fn assembly_allocates_nothing() {
    for kind in Brick::ALL {
        for section in [SectionKind::Rigid, SectionKind::Radial] {
            for mu in [0.0, 0.2] {
                let mut ready = Ready::new(kind, section.clone(), mu);
                ready.assemble(Request::Tangent);
                let count = allocations_of(|| {
                    ready.assemble(Request::Tangent);
                    ready.assemble(Request::Residual);
                    ready.contributions[0].commit();
                    ready.contributions[0].dissipated();
                });
                let elements = ready.contributions[0].element_count();
                println!("{kind:?}, {section:?}, mu {mu}: {count} allocations for {elements} elements");
                assert_eq!(count, 0, "{kind:?}, {section:?}, mu {mu}, {elements} elements");
            }
        }
    }
}
