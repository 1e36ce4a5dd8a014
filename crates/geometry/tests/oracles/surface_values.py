"""Writes src/surface/data/high_precision.json: surfaces, and their points and derivatives by the Cox-de Boor recursion
in 60-digit arithmetic (mpmath). Run again only to change the cases: python3 tests/oracles/surface_values.py
"""

import json
import pathlib
import random

from mpmath import mp, mpf

mp.dps = 60
rng = random.Random(20)


def basis(t, span, i, p, order, u):
    if p == 0:
        return mpf(1) if order == 0 and i == span else mpf(0)
    left, right = t[i + p] - t[i], t[i + p + 1] - t[i + 1]
    over = lambda a, b: a / b if b > 0 else mpf(0)
    if order:
        return p * (over(basis(t, span, i, p - 1, order - 1, u), left) - over(basis(t, span, i + 1, p - 1, order - 1, u), right))
    return over(u - t[i], left) * basis(t, span, i, p - 1, 0, u) + over(t[i + p + 1] - u, right) * basis(t, span, i + 1, p - 1, 0, u)


def direction(degree, kind):
    """File knots, count, extended knots, domain."""
    inner, at = [], rng.uniform(-1, 1)
    start = at
    for _ in range(rng.randint(2, 4)):
        at += rng.choice([1e-3, 0.3, 1.0]) * rng.uniform(0.5, 1)
        inner += [at] * (rng.randint(1, degree) if rng.random() < 0.4 else 1)
    end = at + rng.uniform(0.3, 1)
    if kind == "clamped":
        knots = [start] * (degree + 1) + inner + [end] * (degree + 1)
        return knots, len(knots) - degree - 1, [mpf(k) for k in knots], (mpf(start), mpf(end))
    if kind == "open":
        before = sorted(start - rng.uniform(0, 1) for _ in range(degree))
        after = sorted(end + rng.uniform(0, 1) for _ in range(degree))
        knots = before + [start] + inner + [end] + after
        return knots, len(knots) - degree - 1, [mpf(k) for k in knots], (mpf(start), mpf(end))
    knots = [start] + inner
    while len(knots) < degree + 2:
        knots.append(knots[-1] + rng.uniform(0.3, 1))
    knots.append(knots[-1] + 0.5)
    count = len(knots) - 1
    exact = [mpf(k) for k in knots]
    period = exact[-1] - exact[0]
    extended = [k - period for k in exact[count - degree:count]] + exact + [k + period for k in exact[1:degree + 1]]
    return knots, count, extended, (exact[0], exact[-1])


def row(t, degree, count, domain, order, u):
    spans = [i for i in range(degree, len(t) - degree - 1) if t[i] < t[i + 1]]
    span = [i for i in spans if t[i] <= u][-1]
    out = [mpf(0)] * count
    for i in range(len(t) - degree - 1):
        out[i % count] += basis(t, span, i, degree, order, u)
    return out


cases = []
for degrees in [(1, 2), (2, 3), (3, 3), (3, 3), (4, 1), (5, 3), (3, 6), (7, 7), (6, 5), (3, 3)]:
    kinds = [rng.choice(["clamped", "open", "periodic"]) for _ in range(2)]
    (ku, nu, tu, du), (kv, nv, tv, dv) = direction(degrees[0], kinds[0]), direction(degrees[1], kinds[1])
    points = [[[i + rng.uniform(-1, 1), j + rng.uniform(-1, 1), rng.uniform(-1, 1)] for j in range(nv)] for i in range(nu)]
    weights = [[rng.choice([0.01, 1, 7.5]) * rng.uniform(0.5, 2) for _ in range(nv)] for _ in range(nu)] if rng.random() < 0.6 else None
    answers = []
    for _ in range(6):
        pick = lambda d: float(d[0] + (d[1] - d[0]) * mpf(rng.choice([0, 1e-9, rng.random(), rng.random(), 0.999999])))
        u, v = pick(du), pick(dv)
        orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
        rows = {k: row(tu, degrees[0], nu, du, k, mpf(u)) for k in range(3)}
        columns = {k: row(tv, degrees[1], nv, dv, k, mpf(v)) for k in range(3)}
        a, w = {}, {}
        for k, l in orders:
            share = [[rows[k][i] * columns[l][j] * (mpf(weights[i][j]) if weights else 1) for j in range(nv)] for i in range(nu)]
            a[k, l] = [sum(share[i][j] * mpf(points[i][j][c]) for i in range(nu) for j in range(nv)) for c in range(3)]
            w[k, l] = sum(map(sum, share))
        s = {(0, 0): [x / w[0, 0] for x in a[0, 0]]}
        if not weights:
            s = a
        else:
            w0 = w[0, 0]
            for one in [(1, 0), (0, 1)]:
                s[one] = [(a[one][c] - w[one] * s[0, 0][c]) / w0 for c in range(3)]
            s[2, 0] = [(a[2, 0][c] - 2 * w[1, 0] * s[1, 0][c] - w[2, 0] * s[0, 0][c]) / w0 for c in range(3)]
            s[1, 1] = [(a[1, 1][c] - w[1, 0] * s[0, 1][c] - w[0, 1] * s[1, 0][c] - w[1, 1] * s[0, 0][c]) / w0 for c in range(3)]
            s[0, 2] = [(a[0, 2][c] - 2 * w[0, 1] * s[0, 1][c] - w[0, 2] * s[0, 0][c]) / w0 for c in range(3)]
        answers.append({"u": u, "v": v, "orders": [[float(x) for x in s[order]] for order in orders]})
    surface = {
        "format": "palpate.surface.v1", "degree": list(degrees), "periodic": [k == "periodic" for k in kinds],
        "knots": [ku, kv], "points": points, "weights": weights, "flip_normal": False,
    }
    cases.append({"surface": surface, "answers": answers})

target = pathlib.Path(__file__).parents[2] / "src/surface/data/high_precision.json"
target.write_text(json.dumps(cases) + "\n")
