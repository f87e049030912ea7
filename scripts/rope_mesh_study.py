#!/usr/bin/env python3
"""A sub-rope pulled and taken through its first cycle over several meshes, as a Markdown table.

    python3 scripts/rope_mesh_study.py [--binary target/release/subrope] [--out out/rope_mesh_study]
        [--scene scenes/sub_rope_cycles.toml] [--threads 1]

Every member is a run of the binary on a copy of the scene with another mesh and one cycle.
"""
import argparse
import csv
import json
import pathlib
import re
import subprocess

# core, rings, layers, points of a face: the spacing of points is about the same
MESHES = [(2, 1, 30, (8, 3)), (2, 2, 40, (8, 2)), (4, 2, 50, (4, 2)), (4, 3, 70, (4, 2))]


def member_scene(text, core, rings, layers, points):
    """The scene with another mesh and one cycle."""
    values = {"core": core, "rings": rings, "layers": layers, "count": 1, "every": 1, "points": f"[{points[0]}, {points[1]}]"}
    for key, value in values.items():
        text, changed = re.subn(rf"^{key} = [^#\n]*", f"{key} = {value} ", text, flags=re.M)
        if changed != 1:
            raise SystemExit(f"the scene does not say {key} once")
    return text


def column(row, name):
    """A column of a table by its name without unit."""
    return float(next(v for k, v in row.items() if k.split(" [")[0] == name))


def run(args, mesh):
    """Runs a member; returns its summary and tables."""
    folder = args.out / "_".join(str(m) for m in mesh[:3])
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(member_scene(args.scene.read_text(), *mesh))
    command = [args.binary, "run", scene, "--out", folder / "results", "--threads", args.threads]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    (folder / "log.txt").write_text(done.stdout + done.stderr)
    if done.returncode:
        raise SystemExit(f"{scene}: {done.stderr}")
    results = folder / "results"
    history = list(csv.DictReader((results / "history.csv").open()))
    cycle = list(csv.DictReader((results / "cycles.csv").open()))[0]
    return json.loads((results / "summary.json").read_text()), history, cycle


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--binary", default="target/release/subrope")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/rope_mesh_study"))
    parser.add_argument("--scene", type=pathlib.Path, default=pathlib.Path("scenes/sub_rope_cycles.toml"))
    parser.add_argument("--threads", type=int, default=1)
    args = parser.parse_args()
    print("| bricks | unknowns | force N | torque N mm | cycle: hysteresis mJ | transverse mJ | longitudinal mJ |"
          " contact friction mJ | energy error | iterations | s |")
    print("|" + "---|" * 11)
    for mesh in MESHES:
        summary, history, cycle = run(args, mesh)
        # The cycle is given in fractions of the tension at the end of the pull.
        peak = [row for row in history if column(row, "step") == 1][-1]
        cells = [
            str(summary["size"]["elements"]), str(summary["size"]["unknowns"]),
            f"{column(peak, 'END_B_fz'):.1f}", f"{column(peak, 'END_B_mz'):.1f}",
            *(f"{column(cycle, name):.3f}" for name in
              ("hysteresis", "dissipated_transverse", "dissipated_longitudinal", "contact_friction_work")),
            f"{column(history[-1], 'energy_error'):.1e}",
            str(summary["counts"]["iterations"]), f"{summary['seconds']['total']:.0f}",
        ]
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
