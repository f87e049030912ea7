#!/usr/bin/env python3
"""The record of `cargo bench`: what Criterion measured, kept as fractions of what the machine gave in the same run.

    cargo bench --workspace                       measures
    python3 scripts/bench_record.py record        appends the figures to benches/history.jsonl
    python3 scripts/bench_record.py compare       the last record against those before it, and the noise
    python3 scripts/bench_record.py draw OUT.svg  every figure over the records, with its noise band

`make bench` does all of it. A figure is a time multiplied by the speed of the calibration of its run (a matrix product, or
a copy of memory for what is bound by it): the number of flops, or of bytes, that the machine could have done meanwhile.
That number is comparable between runs and, roughly, between machines; a time is not. Without arguments: record, compare.
"""

import datetime
import json
import math
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CRITERION = ROOT / "target" / "criterion"
HISTORY = ROOT / "benches" / "history.jsonl"
DRAWING = ROOT / "target" / "bench_history.svg"
PRODUCT = "calibration/dgemm 512 [flop]"
COPY = "calibration/copy 128 MiB [bytes moved]"
# What is bound by memory rather than by arithmetic.
MEMORY_BOUND = ("solution",)
# Two records are never closer than this.
LEAST_BAND = 0.05


def fail(text):
    sys.exit(f"bench_record: {text}")


def measured():
    """Figures of the last run of Criterion: nanoseconds with their interval, and throughput, by name."""
    out = {}
    for path in sorted(CRITERION.glob("**/new/estimates.json")):
        bench = json.loads((path.parent / "benchmark.json").read_text())
        estimate = json.loads(path.read_text())["median"]
        interval = estimate["confidence_interval"]
        name = "/".join(filter(None, (bench["group_id"], bench["function_id"], bench["value_str"])))
        throughput = bench.get("throughput") or {}
        out[name] = {
            "ns": estimate["point_estimate"],
            "low": interval["lower_bound"],
            "high": interval["upper_bound"],
            "per": next(iter(throughput.values()), None),
        }
    return out


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if pathlib.Path("/proc/cpuinfo").exists() else []:
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown"


def commit():
    done = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip() or "unknown"


def record():
    figures = measured()
    if PRODUCT not in figures or COPY not in figures:
        fail("no calibration among the results: run `cargo bench --workspace` first")
    speed = {key: figures[key]["per"] / figures[key]["ns"] for key in (PRODUCT, COPY)}
    entries = {}
    for name, figure in figures.items():
        if name.startswith("calibration/"):
            continue
        unit = speed[COPY if any(word in name for word in MEMORY_BOUND) else PRODUCT]
        entries[name] = {**figure, "cost": figure["ns"] * unit, "noise": (figure["high"] - figure["low"]) / figure["ns"]}
    line = {
        "date": datetime.date.today().isoformat(),
        "commit": commit(),
        "processor": processor(),
        "product_gflop_s": speed[PRODUCT],
        "copy_gbyte_s": speed[COPY],
        "entries": entries,
    }
    with HISTORY.open("a") as file:
        file.write(json.dumps(line, sort_keys=True) + "\n")
    print(f"recorded {len(entries)} figures beside {speed[PRODUCT]:.1f} GFLOP/s and {speed[COPY]:.1f} GB/s")


def history():
    if not HISTORY.exists():
        fail(f"no record yet in {HISTORY.relative_to(ROOT)}")
    return [json.loads(line) for line in HISTORY.read_text().splitlines() if line.strip()]


def band(values, noise):
    """Half width of what counts as noise: the spread of earlier records, or the interval of the run itself."""
    middle = statistics.median(values)
    spread = max(abs(v / middle - 1.0) for v in values)
    return max(LEAST_BAND, spread, noise)


def compare():
    *before, last = history()
    same = [line for line in before if line["processor"] == last["processor"]] or before
    print(f"{last['date']} {last['commit']}: {last['product_gflop_s']:.1f} GFLOP/s, {last['copy_gbyte_s']:.1f} GB/s")
    if not same:
        print("the first record: nothing to compare with")
    print(f"{'what':52} {'time':>10} {'per second':>12} {'change':>8} {'noise':>7}")
    worse = 0
    for name, entry in last["entries"].items():
        rate = f"{entry['per'] / entry['ns'] * 1e9:.3g}" if entry["per"] else ""
        values = [line["entries"][name]["cost"] for line in same if name in line["entries"]]
        change = verdict = noise = ""
        if values:
            ratio, width = entry["cost"] / statistics.median(values), band(values, entry["noise"])
            change, noise = f"{100 * (ratio - 1):+.1f} %", f"{100 * width:.0f} %"
            verdict = "slower" if ratio > 1 + width else "faster" if ratio < 1 - width else ""
            worse += verdict == "slower"
        print(f"{name:52} {duration(entry['ns']):>10} {rate:>12} {change:>8} {noise:>7} {verdict}")
    print(f"{worse} slower than before beyond the noise" if same else "")


def duration(ns):
    for unit, size in (("s", 1e9), ("ms", 1e6), ("us", 1e3)):
        if ns >= size:
            return f"{ns / size:.3g} {unit}"
    return f"{ns:.3g} ns"


def draw(path):
    lines = history()
    names = sorted({name for line in lines for name in line["entries"]})
    row, left, width = 46, 370, 420
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + width + 110}" height="{row * len(names) + 60}" '
        'font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>',
        f'<text x="10" y="22" font-size="14">Cost of every figure, records: {len(lines)}, relative to their median '
        '(band: noise)</text>',
    ]
    for number, name in enumerate(names):
        top = 40 + row * number
        known = [(i, line["entries"][name]) for i, line in enumerate(lines) if name in line["entries"]]
        values = [entry["cost"] for _, entry in known]
        middle = statistics.median(values)
        wide = band(values, max(entry["noise"] for _, entry in known))
        scale = max(math.log(1 + wide), max(abs(math.log(v / middle)) for v in values))
        x = lambda i: left + width * (i + 0.5) / len(lines)
        y = lambda v: top + row / 2 - 0.42 * row * math.log(v) / scale
        out.append(f'<text x="10" y="{top + row / 2 + 4}">{escape(name)}</text>')
        band_top, band_bottom = y(1 + wide), y(1 / (1 + wide))
        out.append(f'<rect x="{left}" y="{band_top:.1f}" width="{width}" height="{band_bottom - band_top:.1f}" fill="#e6eef6"/>')
        points = " ".join(f"{x(i):.1f},{y(entry['cost'] / middle):.1f}" for i, entry in known)
        out.append(f'<polyline points="{points}" fill="none" stroke="#1f5f99" stroke-width="1.5"/>')
        out += [f'<circle cx="{x(i):.1f}" cy="{y(e["cost"] / middle):.1f}" r="2.5" fill="#1f5f99"/>' for i, e in known]
        out.append(f'<text x="{left + width + 8}" y="{top + row / 2 + 4}">{duration(known[-1][1]["ns"])}</text>')
    out.append("</svg>\n")
    pathlib.Path(path).write_text("\n".join(out))
    print(f"drawn in {path}")


def escape(text):
    return text.replace("&", "&amp;").replace("<", "&lt;")


def main(arguments):
    match arguments:
        case []:
            record()
            compare()
        case ["record"]:
            record()
        case ["compare"]:
            compare()
        case ["draw"]:
            draw(DRAWING)
        case ["draw", path]:
            draw(path)
        case _:
            fail(f"unknown arguments {' '.join(arguments)}\n{__doc__}")


if __name__ == "__main__":
    main(sys.argv[1:])
