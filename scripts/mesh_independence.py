#!/usr/bin/env python3
"""What of the bent strand converges with the mesh, for every way of limiting the localisation of slip: Markdown and chart.

    python3 scripts/mesh_independence.py [--binary target/release/subrope] [--out out/mesh_independence]
                                         [--docs docs/studies] [--resume]

Every member is a run of the binary on a copy of scenes/bent_strand.toml with other parameters and another mesh, mesh lines
along the rope-yarns. Needs nothing but Python.
"""
import argparse
import json
import pathlib
import re
import subprocess

# Parameters of the law that set C has and the rope-yarns' bending stiffness.
SET_C = {"H_t": 0.1, "H_l": 0.3}
NONE = {"H_t": 0.0, "H_l": 0.0}
VARIANTS = {
    "none": ("H = X = mu = 0", NONE, None),
    "set_c": ("set C: H_l = 0.3, H_t = 0.1 MPa", SET_C, None),
    "kinematic": ("X_l = 2, X_t = 0.5 MPa", {**NONE, "X_t": 0.5, "X_l": 2.0}, None),
    "pressure": ("mu_l = 0.1, mu_t = 0.2", {**NONE, "mu_t": 0.2, "mu_l": 0.1}, None),
    "yarns": ("10 rope-yarns of EI = 20 N mm^2", NONE, 20.0),
    "stiff_yarns": ("10 rope-yarns of EI = 100 N mm^2", NONE, 100.0),
}
# (core, rings, layers); the layers double every other mesh, and the last has a finer section.
MESHES = [(2, 2, 20), (2, 2, 28), (2, 2, 40), (2, 2, 56), (2, 2, 80), (2, 2, 112), (4, 2, 56)]
COLUMNS = [
    ("moment", "moment [N mm]", "{:.2f}"),
    ("peak", "largest curvature over the mean", "{:.3f}"),
    ("length", "length of that peak [mm]", "{:.2f}"),
    ("density_l", "peak density, longitudinal [mJ/mm^3]", "{:.4f}"),
    ("density_t", "peak density, transverse [mJ/mm^3]", "{:.5f}"),
    ("lost", "dissipated [mJ]", "{:.3f}"),
]


def member_scene(text, variant, mesh, angle):
    """The scene with other parameters, another mesh and angle, without fields."""
    _, law, stiffness = VARIANTS[variant]
    for key in ("H_t", "H_l"):
        text = re.sub(rf"^{key} = .*\n", "", text, flags=re.M)
    text = text.replace("friction = true\n", "friction = true\n" + "".join(f"{k} = {v}\n" for k, v in law.items()))
    text = text.replace('lines = "axis" ', 'lines = "yarns" ')
    for key, value in zip(("core", "rings", "layers"), mesh):
        text = re.sub(rf"^{key} = \d+", f"{key} = {value}", text, flags=re.M)
    if stiffness:
        bending = f"[strand.yarn_bending]\nyarns = 10\nstiffness = {stiffness}\n\n"
        text = text.replace("[element]", bending + "[element]")
    text = re.sub(r"^angle = 90.0", f"angle = {angle}", text, flags=re.M)
    return re.sub(r"^fields = \[.*\]\nevery = 1", 'fields = ["displacement"]\nevery = 1000', text, flags=re.M)


def has_ended(summary):
    """Whether a run has gone as far as it goes."""
    return summary.exists() and json.loads(summary.read_text())["status"]["state"] != "interrupted"


def run(args, variant, mesh):
    """Runs a member unless it has run; its summary."""
    folder = args.out / (variant + "_" + "_".join(map(str, mesh)))
    folder.mkdir(parents=True, exist_ok=True)
    results = folder / "results"
    if not (args.resume and has_ended(results / "summary.json")):
        scene = folder / "scene.toml"
        scene.write_text(member_scene(args.scene.read_text(), variant, mesh, args.angle))
        command = [str(args.binary), "run", str(scene), "--out", str(results), "--threads", "1"]
        done = subprocess.run(command, capture_output=True, text=True)
        (folder / "log.txt").write_text(done.stdout + done.stderr)
        if done.returncode not in (0, 3):
            raise SystemExit(f"{scene}: {done.stderr}")
    return json.loads((results / "summary.json").read_text())


def measures(summary):
    """What is compared."""
    findings, peaks = summary["findings"], summary["peak_densities"]
    moment = summary["reference_points"]["END_A"]["moment_n_mm"]
    energies = summary["energies"]
    return {
        "done": summary["status"]["state"] == "done",
        "moment": sum(m * m for m in moment) ** 0.5,
        "peak": findings["largest_curvature_per_mm"] / findings["mean_curvature_per_mm"],
        "length": findings.get("curvature_peak_length_mm", float("nan")),
        "density_l": peaks["longitudinal_mj_per_mm3"],
        "density_t": peaks["transverse_mj_per_mm3"],
        "lost": energies["dissipated_transverse_midpoint_mj"] + energies["dissipated_longitudinal_midpoint_mj"],
        "error": energies["energy_error"],
        "unstable": summary["counts"]["unstable_increments"],
        "seconds": summary["seconds"]["solving_cpu"],
        "unknowns": summary["size"]["unknowns"],
    }


def table(results):
    """Markdown of all members."""
    heads = ["variant", "core, rings, layers", "unknowns"] + [head.replace("[", "\\[").replace("]", "\\]") for _, head, _ in COLUMNS]
    lines = ["| " + " | ".join(heads + ["unstable increments", "energy error", "CPU time \\[s\\]"]) + " |"]
    lines.append("|" + "---|" * (len(heads) + 3))
    for (variant, mesh), m in results.items():
        cells = [VARIANTS[variant][0], "{}, {}, {}".format(*mesh), str(m["unknowns"])]
        cells += [form.format(m[key]) for key, _, form in COLUMNS]
        cells += [str(m["unstable"]), f"{m['error']:.1e}", f"{m['seconds']:.1f}"]
        if not m["done"]:
            cells[0] += " (not to the end)"
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def changes(results):
    """Markdown of what the last doublings of the layers change."""
    along = [mesh for mesh in MESHES if mesh[:2] == MESHES[0][:2]]
    lines = ["| variant | doubling | " + " | ".join(head.split(" [")[0] for _, head, _ in COLUMNS) + " |"]
    lines.append("|" + "---|" * (len(COLUMNS) + 2))
    for variant, (name, _, _) in VARIANTS.items():
        for coarse, fine in zip(along, along[2:]):
            a, b = results.get((variant, coarse)), results.get((variant, fine))
            if a and b:
                cells = ["{:+.1f} %".format(100.0 * (b[key] / a[key] - 1.0)) for key, _, _ in COLUMNS]
                lines.append(f"| {name} | {coarse[2]} to {fine[2]} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


COLOURS = ["#c0392b", "#2c6fbb", "#27864a", "#b7791f", "#6b3fa0", "#444444"]


def chart(results, key, head):
    """An SVG of one measure over the layers, each mesh finer by the square root of two."""
    along = [mesh for mesh in MESHES if mesh[:2] == MESHES[0][:2]]
    values = [results[v, m][key] for v in VARIANTS for m in along if (v, m) in results]
    low, high = 0.0, 1.1 * max(values)
    x = lambda i: 70 + 84 * i
    y = lambda value: 330 - 290 * (value - low) / (high - low)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="760" height="380" font-family="sans-serif" font-size="12">',
           '<rect width="760" height="380" fill="white"/>',
           f'<text x="70" y="22" font-size="14">{head}</text>',
           f'<path d="M70 40V330H{x(len(along) - 1) + 20}" fill="none" stroke="black"/>']
    for i, mesh in enumerate(along):
        out.append(f'<text x="{x(i)}" y="348" text-anchor="middle">{mesh[2]}</text>')
    out.append(f'<text x="{x(1.5)}" y="368" text-anchor="middle">layers along the strand</text>')
    for i in range(5):
        value = low + (high - low) * i / 4
        out.append(f'<text x="62" y="{y(value) + 4:.1f}" text-anchor="end">{value:.3g}</text>')
        out.append(f'<path d="M70 {y(value):.1f}H{x(len(along) - 1) + 20}" stroke="#dddddd"/>')
    for n, (variant, (name, _, _)) in enumerate(VARIANTS.items()):
        points = [(x(i), y(results[variant, m][key])) for i, m in enumerate(along) if (variant, m) in results]
        line = " ".join(f"{px:.1f},{py:.1f}" for px, py in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[n]}" stroke-width="2"/>')
        out += [f'<circle cx="{px:.1f}" cy="{py:.1f}" r="3.5" fill="{COLOURS[n]}"/>' for px, py in points]
        out.append(f'<text x="540" y="{60 + 20 * n}" fill="{COLOURS[n]}">{name}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--binary", type=pathlib.Path, default=pathlib.Path("target/release/subrope"))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/mesh_independence"))
    parser.add_argument("--docs", type=pathlib.Path, default=pathlib.Path("docs/studies"))
    parser.add_argument("--scene", type=pathlib.Path, default=pathlib.Path("scenes/bent_strand.toml"))
    parser.add_argument("--angle", type=float, default=60.0, help="degrees at each end")
    parser.add_argument("--meshes", type=int, nargs="*", help="layers; all meshes when left out")
    parser.add_argument("--resume", action="store_true", help="run nothing again that has run")
    parser.add_argument("--variants", nargs="*", choices=VARIANTS, default=list(VARIANTS))
    args = parser.parse_args()
    meshes = [m for m in MESHES if not args.meshes or m[2] in args.meshes]
    results = {}
    for mesh in meshes:
        for variant in args.variants:
            results[variant, mesh] = measures(run(args, variant, mesh))
            print(variant, mesh, results[variant, mesh], flush=True)
    results = {(v, m): results[v, m] for v in args.variants for m in meshes}
    text = f"# The bent strand over meshes, {args.angle:.0f} degrees at each end\n\n" + table(results) + "\n" + changes(results)
    args.docs.mkdir(parents=True, exist_ok=True)
    (args.docs / "mesh_independence.md").write_text(text)
    for key, head, _ in COLUMNS:
        if key in ("peak", "length", "density_l"):
            (args.docs / f"mesh_independence_{key}.svg").write_text(chart(results, key, head))
    print(text)


if __name__ == "__main__":
    main()
