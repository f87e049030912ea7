#!/usr/bin/env python3
"""Decks of half a cylinder for studies/hertz.toml: bricks graded towards the line of contact, one brick thick.

    python3 scripts/hertz_decks.py [--out studies/decks]

The cylinder of radius R lies along z and touches y = 0 at x = 0. Meshed is 0 <= x <= .96 R from its surface up to its middle
plane y = R; what is left out beyond carries nothing.
"""
import argparse
import math
import pathlib

RADIUS = 10.0
THICKNESS = 1.0
WIDTH = 0.96 * RADIUS
LEVELS = [6, 12, 24, 48]


def graded(t, beta):
    """0 to 1 with small parts at 0."""
    return math.sinh(beta * t) / math.sinh(beta)


def lines(numbers, per_line=16):
    """Numbers of a set, some per line."""
    return [", ".join(str(n) for n in numbers[i:i + per_line]) for i in range(0, len(numbers), per_line)]


def deck(across):
    """A deck with `across` bricks along the surface and half as many up to the middle plane."""
    up = across // 2
    number = lambda i, j, k: 1 + i + (across + 1) * (j + (up + 1) * k)
    out = [f"** half a cylinder of radius {RADIUS}, {across} x {up} bricks: scripts/hertz_decks.py", "*NODE"]
    for k in range(2):
        for j in range(up + 1):
            for i in range(across + 1):
                x = WIDTH * graded(i / across, 5.5)
                low = RADIUS - math.sqrt(RADIUS**2 - x**2)
                y = low + (RADIUS - low) * graded(j / up, 6.0)
                out.append(f"{number(i, j, k)}, {x:.9g}, {y:.9g}, {THICKNESS * k:.9g}")
    out.append("*ELEMENT, TYPE=C3D8, ELSET=CYLINDER")
    element = lambda i, j: 1 + i + across * j
    for j in range(up):
        for i in range(across):
            ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            nodes = [number(a, b, k) for k in range(2) for a, b in ring]
            out.append(", ".join(str(n) for n in [element(i, j), *nodes]))
    both = [(j, k) for j in range(up + 1) for k in range(2)]
    out += ["*NSET, NSET=SYMMETRY", *lines([number(0, j, k) for j, k in both])]
    out += ["*NSET, NSET=MIDDLE", *lines([number(i, up, k) for i in range(across + 1) for k in range(2)])]
    out += ["*ELSET, ELSET=LOWEST", *lines([element(i, 0) for i in range(across)])]
    out += ["*SURFACE, NAME=LOW, TYPE=ELEMENT", "LOWEST, S3"]
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("studies/decks"))
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    for across in LEVELS:
        (args.out / f"half_cylinder_{across}.inp").write_text(deck(across))


if __name__ == "__main__":
    main()
