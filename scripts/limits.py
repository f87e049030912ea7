#!/usr/bin/env python3
"""What fraction of the machine's limits the slowest phases of a sub-rope reach, as a Markdown table.

    cargo bench --bench kernel -- calibration      measures the limits: a matrix product, a copy of memory
    python3 scripts/limits.py [--binary target/release/subrope] [--out out/limits] [--repeats 3] [SCENE]

SCENE (default: the pull of scenes/sub_rope_cycles.toml at two pitches) runs on one thread; the least time of the repeats
counts. Work is counted, not measured:
factorisation   operations of the LDL^T by its structure, times the factorisations;
solution        every entry of the factors read twice by each pair of triangular solves, one pair per iteration of GMRES or
                two per direct solution (the second refines); the matrix once with each;
elements        operations of a brick of eight nodes outside its law, counted in crates/fem/src/solid: 4200 a point.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import bench_record
import growth

POINT_FLOPS = 4200.0
BYTES = 8.0


def limits():
    figures = bench_record.measured()
    wanted = (bench_record.PRODUCT, bench_record.COPY)
    if any(key not in figures for key in wanted):
        sys.exit("limits: no calibration: run `cargo bench --bench kernel -- calibration` first")
    return [figures[key]["per"] / figures[key]["ns"] for key in wanted]


def run(binary, scene, folder):
    command = [binary, "run", scene, "--out", folder, "--threads", "1"]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"limits: {scene} failed: {done.stderr.strip()}")
    return json.loads((folder / "summary.json").read_text())


def rows(summary, product, copy):
    size, counts, seconds = summary["size"], summary["counts"], summary["seconds"]
    flops = size["factor_flops"] * counts["factorisations"]
    pairs = counts["linear_iterations"] or 2 * counts["factorisations"]
    moved = pairs * BYTES * (2.0 * size["factor_entries"] + 1.5 * size["matrix_entries"])
    # The iterations and the first iterate of every increment.
    evaluated = (counts["iterations"] + counts["increments"]) * size["elements"] * 8
    yield "factorisation", seconds["factorisation"], flops * 1e-9, "GFLOP", product
    yield "solution", seconds["solution"], moved * 1e-9, "GB", copy
    yield "elements, contact, assembly", seconds["assembly"], evaluated * POINT_FLOPS * 1e-9, "GFLOP", product


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=pathlib.Path, default=growth.ROOT / "target/release/subrope")
    parser.add_argument("--out", type=pathlib.Path, default=growth.ROOT / "out/limits")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("scene", nargs="?", type=pathlib.Path)
    args = parser.parse_args()
    product, copy = limits()
    args.out.mkdir(parents=True, exist_ok=True)
    scene = args.scene
    if scene is None:
        scene = args.out / "scene.toml"
        scene.write_text(growth.scene(dict(growth.FAMILIES["length"])["2 pitches"]))
    summaries = [run(args.binary, scene, args.out / "results") for _ in range(args.repeats)]
    best = min(summaries, key=lambda s: s["seconds"]["solving"])
    print(f"Limits: {product:.1f} GFLOP/s in a matrix product, {copy:.1f} GB/s in a copy. {best['counts']['iterations']} iterations.\n")
    print("| phase | s | work | reached | limit | fraction |\n|---|---|---|---|---|---|")
    for name, time, work, unit, limit in rows(best, product, copy):
        print(f"| {name} | {time:.2f} | {work:.1f} {unit} | {work / time:.1f} {unit}/s | {limit:.1f} | {work / time / limit:.2f} |")


if __name__ == "__main__":
    main()
