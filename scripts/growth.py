#!/usr/bin/env python3
"""How the cost of an iteration grows with the size of a sub-rope, as Markdown tables with exponents.

    python3 scripts/growth.py [--binary target/release/subrope] [--out out/growth] [--repeats 3] [FAMILY ...]

Families: length (pitches of a rope), turns (of one strand, without contact), section (refinement of the section), strands
(their number), cycles (of a helical slice), threads (gain of a second one, and whether the bits are the same), largest (one
increment of a strand of --turns, two threads; only when asked for). Every member but the cycles is two iterations of a pull, of
the rope of scenes/sub_rope_cycles.toml or of the strand of scenes/strand_tension.toml, on one thread unless said. Members run
in turn, --repeats rounds. The machine changes its speed from one second to the next: the least of some repeats would be a fast
moment for a short run and never for a long one, so that cost would seem to grow faster than it does. Short members therefore run
several times in a round, as long in all as the longest (at most SHARES times), and the median of all runs counts. An exponent is
that of the cost between neighbours in the table, d log cost / d log unknowns.
"""
import argparse
import json
import math
import pathlib
import re
import statistics
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENE = ROOT / "scenes" / "sub_rope_cycles.toml"
# Every iteration factorises and evaluates once, so that its cost is the same in all sizes. Long ropes of strands that just touch
# start badly, and iterates that go astray touch where they should not: the first two iterations tell what one costs.
SOLVER = """
[solver]
keep_factors = false
line_search = "off"
max_iterations = 2
"""
PULL = """[[step]]
name = "pull"
increments = { fixed = 1 }
[step.tension]
elongation = 1e-5
""" + SOLVER
PITCH, LAYERS = 60.0, 40

STRAND = ROOT / "scenes" / "strand_tension.toml"
SLICE = ROOT / "scenes" / "sub_rope_slice_cycles.toml"
CYCLES = (10, 100, 1000)

LENGTHS = (1, 2, 4, 8, 16)


def counted(n, one, more):
    return f"{n} {one if n == 1 else more}"


# What a member changes: keys of the scene.
FAMILIES = {
    "length": [(counted(n, "pitch", "pitches"), {"length": n * PITCH, "layers": n * LAYERS}) for n in LENGTHS],
    "turns": [(counted(n, "turn", "turns"), {"turns": n}) for n in (4 * n for n in LENGTHS)],
    "section": [
        (f"{core} x {core} core, {rings} rings", {"core": core, "rings": rings, "layers": layers, "points": points})
        for core, rings, layers, points in ((2, 1, 30, "[8, 3]"), (2, 2, 40, "[8, 2]"), (4, 2, 50, "[4, 2]"), (4, 4, 80, "[4, 2]"))
    ],
    "strands": [(f"{n} strands", {"strands": n}) for n in (2, 3, 4, 5, 6)],
}
# Families along which cost should be linear.
LINEAR = {"length": "pitch", "turns": "turn"}
# Exit code of a run that ends before its last step.
NOT_CONVERGED = 3
PHASES = ("assembly", "factorisation", "solution")
# Runs of the shortest member in a round.
SHARES = 16


def changed(text, changes, section=None):
    """A scene with other values of some keys; those that it lacks are put into a section."""
    for key, value in changes.items():
        text, count = re.subn(rf"^{key} = [^#\n]*", f"{key} = {value} ", text, flags=re.M)
        if count == 0:
            if section is None:
                raise KeyError(key)
            text = text.replace(f"{section}\n", f"{section}\n{key} = {value}\n")
    return text


def scene(changes):
    """The scene with one short pull and other values of some keys."""
    if "turns" in changes:
        return strand(changes["turns"]) + SOLVER
    return changed(SCENE.read_text().split("[[step]]")[0], changes, "[rope]") + PULL


def run(args, family, name, text, threads=1, to_the_end=True):
    """One run of a member; its summary, or why it failed. A run that ends early has failed, unless only its costs count."""
    folder = args.out / family / name.replace(" ", "_")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(text)
    command = [args.binary, "run", folder / "scene.toml", "--out", folder / "results", "--threads", threads]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode != 0 and (to_the_end or done.returncode != NOT_CONVERGED):
        return None, done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit code {done.returncode}"
    return json.loads((folder / "results" / "summary.json").read_text()), None


def costs(summary):
    """Cost of an iteration by phase [ms], and memory [MB]."""
    count = summary["counts"]["factorisations"]
    out = {phase: 1e3 * summary["seconds"][phase] / count for phase in PHASES}
    out["iteration"] = sum(out.values())
    out["memory"] = summary["peak_memory_mb"] or 0.0
    return out


def median(runs):
    """The median of every cost of some runs."""
    return {k: statistics.median(cost[k] for cost in runs) for k in runs[0]}


def measured(args, family, members):
    """Median costs and sizes of the members that run, and why the others do not."""
    runs, sizes, failed = {}, {}, {}
    shares = {name: 1 for name, _ in members}
    for _ in range(args.repeats):
        for name, changes in members:
            for _ in range(0 if name in failed else shares[name]):
                summary, why = run(args, family, name, scene(changes), to_the_end=False)
                if summary is None:
                    failed[name] = why
                    break
                sizes[name] = summary["size"]
                runs.setdefault(name, []).append(costs(summary))
        longest = max((median(r)["iteration"] for r in runs.values()), default=0.0)
        shares = {name: min(SHARES, round(longest / median(r)["iteration"])) for name, r in runs.items()}
    return {name: median(r) for name, r in runs.items()}, sizes, failed, {name: len(r) for name, r in runs.items()}


def family_table(args, family):
    members = FAMILIES[family]
    medians, sizes, failed, counts = measured(args, family, members)
    print(f"\n| {family} | unknowns | GFLOP | factorisation GFLOP/s | assembly ms | factorisation ms | solution ms "
          "| iteration ms | exponent | memory MB | exponent |")
    print("|" + "---|" * 11)
    before = None
    for name, _ in members:
        if name in failed:
            print(f"| {name} | {failed[name]} |" + " |" * 9)
            continue
        cost, size = medians[name], sizes[name]
        flops = size["factor_flops"] / 1e9
        exponents = ("", "")
        if before:
            ratio = math.log(size["unknowns"] / before[1]["unknowns"])
            exponents = tuple(f"{math.log(cost[k] / before[0][k]) / ratio:.2f}" for k in ("iteration", "memory"))
        before = (cost, size)
        cells = [name, size["unknowns"], f"{flops:.2f}", f"{flops / cost['factorisation'] * 1e3:.1f}",
                 *(f"{cost[p]:.0f}" for p in PHASES), f"{cost['iteration']:.0f}", exponents[0],
                 f"{cost['memory']:.0f}", exponents[1]]
        print("| " + " | ".join(map(str, cells)) + " |", flush=True)
    if family in LINEAR:
        print_added(members, medians, LINEAR[family])
    first, last = (next((n for n, _ in order if n in medians), None) for order in (members, members[::-1]))
    if first != last:
        ratio = math.log(sizes[last]["unknowns"] / sizes[first]["unknowns"])
        overall = {k: math.log(medians[last][k] / medians[first][k]) / ratio for k in ("iteration", "memory")}
        print(f"\nFrom {first} to {last}: exponent {overall['iteration']:.2f} of the time of an iteration, "
              f"{overall['memory']:.2f} of the memory; median of {counts[first]} to {counts[last]} runs.")


def print_added(members, medians, unit):
    """What each further unit of length costs, from one member to the next."""
    known = [(int(name.split()[0]), medians[name]["iteration"]) for name, _ in members if name in medians]
    added = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in zip(known, known[1:])]
    print(f"\nThe first {members[0][0]}: {known[0][1]:.0f} ms an iteration, each further {unit} "
          + ", ".join(f"{value:.0f}" for value in added) + " ms from one member to the next.")


def cycles_table(args):
    print("\n| cycles | increments | seconds | ms per cycle | memory MB |\n|---|---|---|---|---|")
    for count in CYCLES:
        text = changed(SLICE.read_text(), {"count": count, "every": max(1, count // 10)})
        summary, why = run(args, "cycles", str(count), text)
        if summary is None:
            print(f"| {count} | {why} | | | |")
            continue
        seconds = summary["seconds"]["total"]
        print(f"| {count} | {summary['counts']['increments']} | {seconds:.1f} | {1e3 * seconds / count:.0f} "
              f"| {summary['peak_memory_mb'] or 0.0:.0f} |", flush=True)


def threads_table(args):
    """Wall time of an iteration on one thread and on two."""
    print("\n| length | threads | assembly ms | factorisation ms | solution ms | iteration ms | gain | same bits |")
    print("|" + "---|" * 8)
    for name, changes in FAMILIES["length"][:4]:
        runs = {1: [], 2: []}
        for _ in range(args.repeats):
            for threads in runs:
                summary, why = run(args, f"threads_{threads}", name, scene(changes), threads, to_the_end=False)
                if summary is None:
                    print(f"| {name} | {threads} | {why} |" + " |" * 5)
                    return
                runs[threads].append(costs(summary))
        medians = {threads: median(r) for threads, r in runs.items()}
        tables = [args.out / f"threads_{t}" / name.replace(" ", "_") / "results" / "history.csv" for t in medians]
        same = "yes" if len({table.read_bytes() for table in tables}) == 1 else "NO"
        for threads, cost in medians.items():
            gain = f"{medians[1]['iteration'] / cost['iteration']:.2f}" if threads > 1 else ""
            phases = " | ".join(f"{cost[p]:.0f}" for p in PHASES)
            print(f"| {name} | {threads} | {phases} | {cost['iteration']:.0f} | {gain} | {same if threads > 1 else ''} |", flush=True)


def strand(turns):
    """The strand of scenes/strand_tension.toml over more turns, pulled by a thousandth in one increment."""
    keys = {"length": turns * 30.3, "layers": turns * 24, "increments": "{ fixed = 1 }", "elongation": 0.001}
    return changed(STRAND.read_text(), keys)


def largest(args):
    """One increment of a strand that fills the memory."""
    summary, why = run(args, "largest", f"{args.turns} turns", strand(args.turns), 2)
    if summary is None:
        print(f"\n{args.turns} turns: {why}")
        return
    size, seconds, counts = summary["size"], summary["seconds"], summary["counts"]
    print(f"\n{args.turns} turns, two threads, one increment: {size['elements']} bricks, {size['unknowns']} unknowns, "
          f"{size['factor_entries'] / 1e6:.0f}e6 entries of the factor, {size['factor_flops'] / 1e9:.0f} GFLOP; "
          f"{counts['iterations']} iterations in {seconds['solving']:.0f} s with pattern and order, "
          f"{summary['peak_memory_mb'] or 0.0:.0f} MB.")


OTHERS = {"cycles": cycles_table, "threads": threads_table, "largest": largest}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("families", nargs="*", choices=[*FAMILIES, *OTHERS, []], default=[*FAMILIES, "cycles", "threads"])
    parser.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/subrope")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/growth")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--turns", type=int, default=1000, help="length of the largest strand")
    args = parser.parse_args()
    for family in args.families:
        OTHERS[family](args) if family in OTHERS else family_table(args, family)


if __name__ == "__main__":
    main()
