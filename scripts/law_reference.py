#!/usr/bin/env python3
"""Random paths of the bundle law in high precision: python3 scripts/law_reference.py SEED COUNT > law_random.json,
single steps over the whole range of strain and distortion: python3 scripts/law_reference.py range SEED > law_range.json.

Independent of the program: the logarithm of the section by eigenvectors, stress and tangent by difference quotients of
the strain modes at 110 digits, the return by bisection. Needs mpmath.
"""

import json
import math
import random
import sys

from mpmath import det, diag, exp, eigsy, eye, log, matrix, mp, mpf, sqrt

mp.dps = 110
PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
KINDS = ["small", "large", "sheared", "compressed", "distorted", "flat", "tiny"]
AMPLITUDE = {"small": 0.02, "large": 0.25, "sheared": 0.1, "compressed": 0.1, "distorted": 0.1, "flat": 0.1, "tiny": 1e-14}


def strain_modes(c):
    """I_elong, I_comp, D1, D2, g2, g3 of the right Cauchy-Green tensor."""
    section = matrix(2, 2)
    for a in (1, 2):
        for b in (1, 2):
            section[a - 1, b - 1] = c[a, b] - c[0, a] * c[0, b] / c[0, 0]
    values, vectors = eigsy(section)
    half_log = vectors * diag([log(v) for v in values]) * vectors.T / 2
    mean = (half_log[0, 0] + half_log[1, 1]) / 2
    deviator = [(half_log[0, 0] - half_log[1, 1]) / 2, half_log[0, 1]]
    return [log(c[0, 0]) / 2, mean, *deviator, c[0, 1] / c[0, 0], c[0, 2] / c[0, 0]]


def axial(p, u, comp):
    """W_,e, W_,c, energy and pressure."""
    stiff, soft, toe, nu, kc = (mpf(p[k]) for k in ("K_e", "K_ec", "w_e", "nu", "K_c"))
    slope, energy = soft * u, soft * u**2 / 2
    if 0 < u < toe:
        t = u / toe
        slope += (stiff - soft) * toe * (t**3 - t**4 / 2)
        energy += (stiff - soft) * toe**2 * (t**4 / 4 - t**5 / 10)
    elif u >= toe:
        slope += (stiff - soft) * (u - toe / 2)
        energy += (stiff - soft) * (3 * toe**2 / 20 + (u**2 - toe**2) / 2 - toe * (u - toe) / 2)
    z = comp + nu * u
    force, stored = kc * z, kc * z**2 / 2
    if z < 0 and p["comp_type"] == 1:
        k, m = mpf(p["K_p"]), mpf(p["p_exp"])
        force, stored = force - m * k * (-z) ** (m - 1), stored + k * (-z) ** m
    elif z < 0 and p["comp_type"] == 2:
        limit = mpf(p["z_lock"])
        if z <= limit:
            raise ValueError("locked up")
        room = 1 - (z / limit) ** 2
        force, stored = kc * z / room, -kc * limit**2 * log(room) / 2
    return slope + nu * force, force, energy + stored, max(mpf(0), -force)


def slide(p, mode, strain, old, pressure):
    """Force, new state (plastic strain, kappa, dissipation) and stored energy of a mode."""
    k, x, mu = (mpf(p[f"{name}_{mode}"]) for name in ("K", "X", "mu"))
    tau, h, limit = mpf(p[f"tau_{mode}0"]), mpf(p.get(f"H_{mode}", 0)), mpf(p.get(f"H_inf_{mode}", 0))
    scale = mpf(p.get(f"kappa_s_{mode}", 1))
    plastic, kappa, lost = old
    trial = [k * (strain[i] - plastic[i]) - x * plastic[i] for i in range(2)]
    size = sqrt(trial[0] ** 2 + trial[1] ** 2)

    def excess(d):
        new = kappa + d
        return size - (k + x) * d - tau - h * new - limit * (1 - exp(-new / scale)) - mu * pressure

    if excess(mpf(0)) > 0:
        low, high = mpf(0), size / (k + x)
        for _ in range(380):
            middle = (low + high) / 2
            low, high = (middle, high) if excess(middle) > 0 else (low, middle)
        plastic = [plastic[i] + low * trial[i] / size for i in range(2)]
        kappa, lost = kappa + low, lost + (size - (k + x) * low) * low
    force = [k * (strain[i] - plastic[i]) for i in range(2)]
    stored = sum(q**2 for q in force) / (2 * k) + x * sum(v**2 for v in plastic) / 2
    return force, (plastic, kappa, lost), stored


def answer(p, c, old):
    """Modes, forces, pressure, energy, stress and new state."""
    modes = strain_modes(c)
    elongation, compaction, energy, pressure = axial(p, modes[0], modes[1])
    q_t, transverse, w_t = slide(p, "t", modes[2:4], old[0], pressure)
    q_l, longitudinal, w_l = slide(p, "l", modes[4:6], old[1], pressure)
    forces = [elongation, compaction, *q_t, *q_l]
    stress, step = matrix(3, 3), mpf(10) ** -50 * abs(det(c)) ** mpf("0.3")
    for i, j in PAIRS:
        high, low = (strain_modes(moved(c, i, j, s * step)) for s in (1, -1))
        value = sum(q * (a - b) for q, a, b in zip(forces, high, low)) / step
        stress[i, j] = stress[j, i] = value
    return modes, forces, pressure, energy + w_t + w_l, stress, (transverse, longitudinal)


def moved(c, i, j, by):
    """The tensor with an entry moved, off the diagonal by half on each side."""
    out = c.copy()
    out[i, j] += by / 2
    out[j, i] += by / 2
    return out


def tangent(p, c, old):
    """dS/dE with engineering shears."""
    out, step = matrix(6, 6), mpf(10) ** -28 * abs(det(c)) ** mpf("0.3")
    for column, (i, j) in enumerate(PAIRS):
        high, low = (answer(p, moved(c, i, j, s * 2 * step), old)[4] for s in (1, -1))
        for row, (a, b) in enumerate(PAIRS):
            out[row, column] = (high[a, b] - low[a, b]) / (2 * step)
    return out


def parameters():
    draw = random.uniform
    p = {"K_e": draw(500, 3000), "K_ec": draw(20, 300), "w_e": random.choice([0.0, draw(0.002, 0.05)])}
    p |= {"K_c": draw(20, 200), "nu": random.choice([0.0, 0.5, draw(-0.2, 0.8)]), "comp_type": float(random.randrange(3))}
    p |= {"K_p": draw(50, 500), "p_exp": draw(2.1, 4), "z_lock": draw(-0.6, -0.2), "friction": 1.0}
    for mode in "tl":
        p |= {f"K_{mode}": draw(5, 50), f"tau_{mode}0": draw(0.01, 2), f"X_{mode}": random.choice([0.0, draw(0.5, 10)])}
        p[f"mu_{mode}"] = random.choice([0.0, draw(0.05, 0.5)])
        if random.random() < 0.5:
            p |= {f"H_inf_{mode}": draw(0.1, 3), f"kappa_s_{mode}": draw(0.005, 0.2)}
        else:
            p[f"H_{mode}"] = draw(0.1, 5)
    return p


def rotation():
    w, x, y, z = (random.gauss(0, 1) for _ in range(4))
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return matrix([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def gradient(kind, frame):
    """Displacement gradient in general position, rounded to doubles."""
    draw, a = random.uniform, AMPLITUDE[kind]
    noise = matrix(3, 3)
    for i in range(3):
        for j in range(3):
            noise[i, j] = draw(-a, a)
    squeeze, size = draw(0.75, 0.95), draw(1, 4)
    core = {
        "sheared": matrix([[1, draw(-6, 6), draw(-6, 6)], [0, 1, draw(-3, 3)], [0, 0, 1]]),
        "compressed": diag([draw(0.9, 1.2), squeeze, squeeze]),
        "distorted": diag([1, exp(mpf(size)), exp(-mpf(size))]),
        "flat": diag([1, draw(0.02, 0.1), 1]),
    }.get(kind)
    h = noise if core is None else (eye(3) + noise) * (frame * core * frame.T) - eye(3)
    return h.apply(lambda v: mpf(float(v)))


SIZES = ["1e-14", "1e-12", "1e-10", "1e-8", "1e-6", "1e-4", "1e-2", "0.1", "0.3", "1", "2", "3"]
DISTORTIONS = [1, 2, 3, 4, 5, 6, 7, 8]


def one_step(name, draw_gradient):
    """A path of a single step from rest, in general position."""
    while True:
        p, frame, rest = parameters(), rotation(), ([mpf(0)] * 2, mpf(0), mpf(0))
        h = draw_gradient(frame).apply(lambda v: mpf(float(v)))
        local = frame.T * h * frame + eye(3)
        # Nearly flat states are those of the distortions.
        if det(local) < mpf("0.2"):
            continue
        try:
            c = local.T * local
            found = answer(p, c, (rest, rest))
            return {"name": name, "params": p, "frame": rows(frame), "state0": [0.0] * 8,
                    "steps": [told(h, frame, found, tangent(p, c, (rest, rest)))]}
        except ValueError:
            continue


def whole_range():
    def noise(size):
        return matrix(3, 3).apply(lambda _: mpf(random.uniform(-1, 1)) * size)

    def stretched(frame, size):
        return (eye(3) + noise(mpf("0.02"))) * (frame * diag([1, exp(mpf(size)), exp(-mpf(size))]) * frame.T) - eye(3)

    strains = [one_step(f"strain {s}", lambda _, s=s: noise(mpf(s))) for s in SIZES for _ in range(3)]
    return strains + [one_step(f"distortion {s}", lambda frame, s=s: stretched(frame, s)) for s in DISTORTIONS for _ in range(3)]


def rows(m):
    return [[float(m[i, j]) for j in range(m.cols)] for i in range(m.rows)]


def told(h, frame, found, stiffness):
    """A step as the file has it."""
    modes, forces, pressure, energy, stress, ((dp, kt, dt), (gp, kl, dl)) = found
    spatial = frame * stress * frame.T
    return {
        "H": rows(h),
        "I": [float(v) for v in modes],
        "q": [float(v) for v in forces],
        "p": float(pressure),
        "W": float(energy),
        "S_fibre": [float(stress[i, j]) for i, j in PAIRS],
        "S_global": [float(spatial[i, j]) for i, j in PAIRS],
        "D_fibre": rows(stiffness),
        "state": [float(v) for v in (*dp, *gp, kt, kl, dt, dl)],
    }


def path(number):
    kind, p, frame = KINDS[number % len(KINDS)], parameters(), rotation()
    rest = ([mpf(0)] * 2, mpf(0), mpf(0))
    state, steps = (rest, rest), []
    while len(steps) < 5:
        h = gradient(kind, frame)
        local = frame.T * h * frame + eye(3)
        if det(local) < mpf("1e-4"):
            continue
        c = local.T * local
        try:
            modes, forces, pressure, energy, stress, new = answer(p, c, state)
            stiffness = tangent(p, c, state)
        except ValueError:
            p["comp_type"] = 0.0 if not steps else p["comp_type"]
            continue
        state = new
        steps.append(told(h, frame, (modes, forces, pressure, energy, stress, new), stiffness))
    return {"name": f"{number} {kind}", "params": p, "frame": rows(frame), "state0": [0.0] * 8, "steps": steps}


if __name__ == "__main__":
    if sys.argv[1] == "range":
        random.seed(int(sys.argv[2]))
        print(json.dumps({"paths": whole_range()}))
    else:
        random.seed(int(sys.argv[1]))
        print(json.dumps({"paths": [path(n) for n in range(int(sys.argv[2]))]}))
