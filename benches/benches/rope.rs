//! Three strands in contact, one thread: the search for candidates, and the first increment of a pull.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Vector3;
use subrope_benches::scene;
use subrope_contact::{Contact, ContactOptions, Smoothing, Surface};
use subrope_fem::Contribution;
use subrope_fem::analysis::Silent;

const ROPE: &str = include_str!("../../scenes/sub_rope_cycles.toml");

/// Two neighbouring strands with the points of the scene.
fn pair() -> Option<(Contact, Vec<f64>)> {
    let model = scene(ROPE, 1).ok()?;
    let mesh = &model.mesh.mesh;
    let surface = |name: &str| Surface::new(mesh, mesh.surfaces.get(name)?, Smoothing::Spline).ok();
    let positions: Vec<Vector3<f64>> = mesh.points.clone();
    let options = ContactOptions { points: [8, 2], ..ContactOptions::new(30.0, 2.785) };
    let contact = Contact::new("pair", surface("LATERAL_1")?, surface("LATERAL_2")?, &positions, options).ok()?;
    Some((contact, vec![0.0; 3 * positions.len()]))
}

fn search(c: &mut Criterion) {
    let Some((mut contact, u)) = pair() else { return };
    let mut group = c.benchmark_group("contact search");
    group.throughput(Throughput::Elements(contact.points().count() as u64));
    group.bench_function("a pair of strands [points]", |bench| {
        bench.iter(|| black_box(contact.prepare(black_box(&u)).is_ok()));
    });
    group.finish();
}

/// A short pull in one increment: analysis, iterations, commit.
fn increment(c: &mut Criterion) {
    let text = ROPE.split("[[step]]").next().unwrap_or(ROPE).to_owned()
        + "[[step]]\nname = \"pull\"\nincrements = { initial = 1.0 }\n[step.tension]\nelongation = 1e-5\n";
    let mut group = c.benchmark_group("one increment");
    group.sample_size(10);
    group.bench_function("sub-rope, 2400 bricks", |bench| {
        bench.iter_batched(
            || scene(&text, 1),
            |model| {
                let Ok(mut model) = model else { return false };
                let steps = model.steps.clone();
                black_box(steps.iter().all(|step| model.analysis.run_step(step, &mut Silent).is_ok()))
            },
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

criterion_group!(benches, search, increment);
criterion_main!(benches);
