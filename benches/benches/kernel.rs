//! The parts of an iteration, one thread: law, elements with assembly, analysis, factorisation, solution.
//!
//! A `calibration` group runs in the same process: a figure is worth reading only beside it.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};
use pulp::{Simd, WithSimd};
use subrope_benches::{block, bundle, displacement, gradients, model, orthotropic, strand};
use subrope_fem::linear::SolverOptions;
use subrope_fem::parallel::with_threads;
use subrope_fem::solid::{Full, MeanElongation, MeanVolume, Wide};
use subrope_fem::{Configuration, Contribution, Evaluation, Product, REFERENCE_TEMPERATURE, Request, Sink, System};
use subrope_material::lanes::{Lanes, MAX_LANES};
use subrope_material::{LaneInput, LaneResponse, Law, PointInput, Request as LawRequest};

/// Takes elements and forgets them: measures the elements alone.
struct Nowhere(f64);

impl Sink for Nowhere {
    fn add(&mut self, _: usize, force: &[f64], stiffness: Option<&[f64]>) {
        self.0 += force[0] + stiffness.map_or(0.0, |k| k[0]);
    }

    fn add_products(&mut self, _: usize, products: &[Product<'_>]) {
        self.0 += products.len() as f64;
    }
}

/// Matrix product and memory bandwidth: what this machine gives at this moment.
fn calibration(c: &mut Criterion) {
    let mut group = c.benchmark_group("calibration");
    let n = 512;
    let a = faer::Mat::<f64>::from_fn(n, n, |i, j| ((i * 7 + j * 3) % 11) as f64);
    let b = a.clone();
    let mut out = faer::Mat::<f64>::zeros(n, n);
    group.throughput(Throughput::Elements(2 * (n * n * n) as u64));
    group.bench_function("dgemm 512 [flop]", |bench| {
        bench.iter(|| {
            faer::linalg::matmul::matmul(&mut out, faer::Accum::Replace, &a, &b, 1.0, faer::Par::Seq);
            black_box(&out);
        });
    });
    let from = vec![1.0_f64; 1 << 24];
    let mut to = vec![0.0_f64; 1 << 24];
    group.throughput(Throughput::Bytes(16 << 24));
    group.bench_function("copy 128 MiB [bytes moved]", |bench| {
        bench.iter(|| {
            to.copy_from_slice(black_box(&from));
            black_box(&mut to);
        });
    });
    group.finish();
}

/// The tangent at many points, as the elements ask for it: in all lanes of the processor.
struct Points<'a, L> {
    law: &'a L,
    inputs: &'a [PointInput],
    old: &'a [f64],
    new: &'a mut [f64],
}

impl<L: Law> WithSimd for Points<'_, L> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let witness = Wide::new(simd, 0.0);
        let mut out = LaneResponse::zero(witness);
        let mut done = true;
        for points in self.inputs.chunks_exact(S::F64_LANES) {
            let entry = |i, j| witness.fill(|lane| points[lane].displacement_gradient[(i, j)]);
            let input = LaneInput {
                points: points.len(),
                gradient: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
                mean_elongation: None,
                time_increment: 1.0,
                temperature: REFERENCE_TEMPERATURE,
            };
            let states = ..points.len() * self.law.state_len();
            let answer = self.law.evaluate_lanes(
                &input,
                &self.old[states],
                &mut self.new[states],
                LawRequest::Tangent,
                &mut out,
            );
            done &= answer.is_ok();
            black_box(&mut out);
        }
        done
    }
}

fn laws(c: &mut Criterion) {
    let inputs = gradients(1024, 0.05);
    let mut group = c.benchmark_group("law with tangent");
    group.throughput(Throughput::Elements(inputs.len() as u64));
    for (name, law) in
        [("sticking", bundle(1e6, 0.0)), ("sliding", bundle(0.1, 0.0)), ("sliding, pressure", bundle(0.1, 0.2))]
    {
        let Ok(law) = law else { continue };
        let old = vec![0.0; MAX_LANES * law.state_len()];
        let mut new = old.clone();
        group.bench_function(name, |bench| {
            bench.iter(|| {
                let points = Points { law: &law, inputs: black_box(&inputs), old: &old, new: &mut new };
                black_box(pulp::Arch::new().dispatch(points))
            });
        });
    }
    group.finish();
}

fn run_elements(bench: &mut criterion::Bencher<'_>, contribution: &mut dyn Contribution, u: &[f64]) {
    let committed = vec![0.0; u.len()];
    let configuration = Configuration {
        displacement: u,
        committed: &committed,
        time_increment: 1.0,
        time: 1.0,
        temperature: REFERENCE_TEMPERATURE,
        predicting: false,
        parallel: false,
    };
    let mut sink = Nowhere(0.0);
    bench.iter(|| {
        let done = contribution.assemble(black_box(&configuration), Request::Tangent, &mut sink);
        black_box(done.is_ok())
    });
}

fn elements(c: &mut Criterion) {
    let mut group = c.benchmark_group("elements with tangent");
    let strand = strand(1);
    group.throughput(Throughput::Elements(strand.cell_count() as u64));
    if let (Ok(law), Ok(svk)) = (bundle(1.0, 0.0), orthotropic())
        && let Ok((mesh, mut full)) = block::<_, Full>(&strand, law.clone())
        && let Ok((_, mut mean)) = block::<_, MeanElongation>(&strand, law.clone())
        && let Ok((_, mut volume)) = block::<_, MeanVolume>(&strand, law)
        && let Ok((_, mut elastic)) = block::<_, Full>(&strand, svk)
    {
        let u = displacement(&mesh, 0.5);
        group.bench_function("hex8, St. Venant-Kirchhoff", |b| run_elements(b, &mut elastic, &u));
        group.bench_function("hex8, bundle", |b| run_elements(b, &mut full, &u));
        group.bench_function("hex8 mean elongation, bundle", |b| run_elements(b, &mut mean, &u));
        group.bench_function("hex8 mean volume, bundle", |b| run_elements(b, &mut volume, &u));
    }
    group.finish();
}

/// Assembly into the sparse matrix, factorisation and solution of a strand whose ends are held.
fn system(c: &mut Criterion) {
    for refine in [1, 2] {
        let strand = strand(refine);
        let Ok(Ok((mesh, solid))) = bundle(1.0, 0.0).map(|law| block::<_, Full>(&strand, law)) else { continue };
        let u = displacement(&mesh, 0.0);
        let Ok(mut model) = model(&mesh, Box::new(solid)) else { continue };
        let mut held = vec![false; model.kinematics.coordinate_count()];
        for point in model.kinematics.points() {
            held[point.first as usize..point.first as usize + 6].fill(true);
        }
        let options = SolverOptions { target_residual: 1e-12, ..SolverOptions::default() };
        let size = format!("{} bricks", strand.cell_count());
        let mut group = c.benchmark_group("system, one thread");
        group.sample_size(10);
        group.bench_function(BenchmarkId::new("analysis", &size), |b| {
            b.iter(|| black_box(System::new(&model.kinematics, &model.contributions, &held, &options).is_ok()));
        });
        let Ok(mut system) = System::new(&model.kinematics, &model.contributions, &held, &options) else { continue };
        let q = vec![0.0; model.kinematics.coordinate_count()];
        let external = vec![0.0; u.len()];
        let mut residual = q.clone();
        let at = Evaluation {
            q: &q,
            configuration: Configuration {
                displacement: &u,
                committed: &u,
                time_increment: 1.0,
                time: 1.0,
                temperature: REFERENCE_TEMPERATURE,
                predicting: false,
                parallel: false,
            },
            external: &external,
            jump: None,
            request: Request::Tangent,
        };
        group.throughput(Throughput::Elements(strand.cell_count() as u64));
        group.bench_function(BenchmarkId::new("assembly [elements]", &size), |b| {
            b.iter(|| {
                let done = system.assemble(&model.kinematics, &mut model.contributions, &at, &mut residual);
                black_box(done.is_ok())
            });
        });
        group.throughput(Throughput::Elements(system.analysis().fill.flops as u64));
        group.bench_function(BenchmarkId::new("factorisation [flop]", &size), |b| {
            // Alone, when the group is filtered, nothing has been assembled.
            let done = system.assemble(&model.kinematics, &mut model.contributions, &at, &mut residual);
            assert!(done.is_ok() && system.factorise().is_ok(), "a strand that is held has a positive tangent");
            b.iter(|| black_box(system.factorise().is_ok()));
        });
        let rhs: Vec<f64> = (0..system.equations().len()).map(|i| (i % 7) as f64 - 3.0).collect();
        let mut x = vec![0.0; rhs.len()];
        group.throughput(Throughput::Elements(rhs.len() as u64));
        group.bench_function(BenchmarkId::new("solution [unknowns]", &size), |b| {
            b.iter(|| black_box(system.solve(&rhs, &mut x).is_ok()));
        });
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().warm_up_time(std::time::Duration::from_millis(500)).measurement_time(std::time::Duration::from_secs(2));
    targets = calibration, laws, elements, system
}

/// `criterion_main!` within a pool of one thread: factorisation and analysis would take as many as there are.
fn main() {
    let done = with_threads(1, || {
        benches();
        Criterion::default().configure_from_args().final_summary();
    });
    assert!(done.is_ok(), "a pool of one thread can be made");
}
