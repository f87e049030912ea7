//! Whole scenes, one thread: the coarse bent strand, and the race P1 (2400 bricks, orthotropic, ten equal steps to
//! +-90 degrees) that CHANGELOG compares with another program.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use subrope_benches::scene;
use subrope_fem::analysis::Silent;

const COARSE: &str = include_str!("../../scenes/bent_strand_coarse.toml");

const RACE: &str = r#"
title = "P1 on the default mesh"
[strand]
radius = 2.785
length = 60.0
surface_angle = 30.0
[element]
formulation = "hex8"
[law]
kind = "orthotropic"
E1 = 300.0
E2 = 60.0
E3 = 60.0
nu12 = 0.3
nu13 = 0.3
nu23 = 0.3
G12 = 50.0
G13 = 50.0
G23 = 23.076923076923077
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "bend"
increments = { fixed = 10 }
[step.bend]
angle = 90.0
"#;

fn scenes(c: &mut Criterion) {
    let mut group = c.benchmark_group("scene");
    group.sample_size(10);
    for (name, text) in [("bent strand, coarse", COARSE), ("race P1", RACE)] {
        group.bench_function(name, |bench| {
            bench.iter_batched(
                || scene(text, 1),
                |model| {
                    let Ok(mut model) = model else { return false };
                    let steps = model.steps.clone();
                    black_box(steps.iter().all(|step| model.analysis.run_step(step, &mut Silent).is_ok()))
                },
                criterion::BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, scenes);
criterion_main!(benches);
