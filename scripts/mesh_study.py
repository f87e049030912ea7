#!/usr/bin/env python3
"""The findings on the bent strand over meshes and element formulations, as a Markdown table.

    python3 scripts/mesh_study.py [--binary target/release/subrope] [--out out/mesh_study] [--scene scenes/bent_strand.toml]

Every member is a run of the binary on a copy of the scene with another mesh and formulation.
"""
import argparse
import csv
import json
import pathlib
import re
import subprocess

# formulation, (core, rings, layers)
MEMBERS = [
    ("hex8", (2, 1, 25)), ("hex8", (4, 2, 50)), ("hex8", (6, 3, 75)),
    ("hex8_mean_elongation", (2, 1, 25)), ("hex8_mean_elongation", (4, 2, 50)), ("hex8_mean_elongation", (6, 3, 75)),
    ("hex27", (2, 1, 13)), ("hex27", (2, 1, 25)), ("hex27", (2, 1, 38)),
]


def member_scene(text, formulation, mesh):
    """The scene with another formulation and mesh."""
    text = re.sub(r'formulation = "\w+"', f'formulation = "{formulation}"', text)
    for key, value in zip(("core", "rings", "layers"), mesh):
        text = re.sub(rf"^{key} = \d+", f"{key} = {value}", text, flags=re.M)
    return text


def column(row, name):
    """A column of the history by its name without unit."""
    return float(next(v for k, v in row.items() if k.split(" [")[0] == name))


def run(args, formulation, mesh):
    """Runs a member; returns its summary and the peak of the end moment with its angle."""
    folder = args.out / f"{formulation}_{mesh[0]}_{mesh[1]}_{mesh[2]}"
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(member_scene(args.scene.read_text(), formulation, mesh))
    command = [args.binary, "run", scene, "--out", folder / "results"]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    (folder / "log.txt").write_text(done.stdout + done.stderr)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{scene}: {done.stderr}")
    rows = list(csv.DictReader((folder / "results" / "history.csv").open()))
    peak = max(rows, key=lambda r: column(r, "END_A_mx"))
    return json.loads((folder / "results" / "summary.json").read_text()), rows, peak


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--binary", default="target/release/subrope")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/mesh_study"))
    parser.add_argument("--scene", type=pathlib.Path, default=pathlib.Path("scenes/bent_strand.toml"))
    args = parser.parse_args()
    print("| element | bricks | unknowns | moment at 18 deg | largest (at deg) | at the end | zones at | ratio | ovality |"
          " out of plane | centre t | centre l | peak l/t | 90 % vol. t | 90 % vol. l | dissipated t, l | energy error | s |")
    print("|" + "---|" * 18)
    for formulation, mesh in MEMBERS:
        summary, rows, peak = run(args, formulation, mesh)
        f, size, energy = summary["findings"], summary["size"], summary["energies"]
        angle = lambda row: 57.29577951 * column(row, "END_A_rx")
        before = [r for r in rows if angle(r) <= 18.0] or rows[:1]
        after = next((r for r in rows if angle(r) >= 18.0), rows[-1])
        a, b = before[-1], after
        t = 0.0 if angle(b) == angle(a) else (18.0 - angle(a)) / (angle(b) - angle(a))
        at18 = column(a, "END_A_mx") + t * (column(b, "END_A_mx") - column(a, "END_A_mx"))
        zones = f["curvature_zones"]
        print("| {} | {} | {} | {:.1f} | {:.1f} ({:.0f}) | {:.1f} ({:.0f} deg) | {} | {} | {} | {:.2f} | {:+.2f} | {:+.2f} | {:.0f} | {:.2f} | {:.2f} |"
              " {:.1f}, {:.1f} | {:.1e} | {:.0f} |".format(
                  formulation, size["elements"], size["unknowns"], at18, column(peak, "END_A_mx"), angle(peak),
                  column(rows[-1], "END_A_mx"), angle(rows[-1]),
                  ", ".join(f"{z['z_mm']:+.1f}" for z in zones), ", ".join(f"{z['curvature_ratio']:.2f}" for z in zones),
                  ", ".join(f"{z['ovality']:.2f}" for z in zones), f["out_of_plane_mm"],
                  f["transverse"]["centre_over_radius"], f["longitudinal"]["centre_over_radius"], f["peak_ratio"],
                  f["transverse"]["volume_of_90_percent"], f["longitudinal"]["volume_of_90_percent"],
                  energy["dissipated_transverse_mj"], energy["dissipated_longitudinal_mj"], energy["energy_error"],
                  summary["seconds"]["total"]), flush=True)


if __name__ == "__main__":
    main()
