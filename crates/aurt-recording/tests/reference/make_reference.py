"""Writes the reference values of this folder with numpy and scipy.

    python make_reference.py

Made with numpy 2.4 and scipy 1.17. The series are sums of sines with a ramp and a reproducible pseudo-random part, so
that the tests can build the same ones without reading them: see `series` here and in `tests/filters.rs`.
"""

import json
import pathlib

import numpy as np
from scipy import interpolate, signal

FOLDER = pathlib.Path(__file__).parent


def series(samples, seed):
    """Equal to the Rust function of that name, bit for bit but for the sine."""
    state = seed
    out = []
    for k in range(samples):
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        noise = (state >> 11) / 2**53 - 0.5
        out.append(np.sin(0.05 * k) + 0.3 * np.sin(0.7 * k + seed) + 0.01 * k + noise)
    return np.array(out)


def filters():
    cases = []
    for order, cutoff_hz, rate_hz, samples in [
        (4, 20.0, 500.0, 700),
        (4, 50.0, 500.0, 400),
        (4, 5.0, 100.0, 300),
        (4, 12.5, 100.0, 16),
        (4, 45.0, 100.0, 64),
        (4, 5.0, 1000.0, 2500),
        (4, 25.0, 100.0, 50),
        (1, 10.0, 200.0, 40),
        (2, 10.0, 200.0, 90),
        (3, 10.0, 200.0, 120),
        (5, 90.0, 200.0, 70),
        (6, 4.0, 200.0, 500),
        (7, 30.0, 200.0, 150),
        (8, 30.0, 200.0, 150),
    ]:
        sos = signal.butter(order, cutoff_hz / (rate_hz / 2), output="sos")
        x = series(samples, order)
        y = signal.sosfiltfilt(sos, x)
        kept = sorted(set(list(range(0, min(samples, 24))) + list(range(0, samples, 37)) + list(range(max(0, samples - 24), samples))))
        cases.append(
            {
                "order": order,
                "cutoff_hz": cutoff_hz,
                "rate_hz": rate_hz,
                "samples": samples,
                "seed": order,
                "sos": sos.tolist(),
                "steady_state": signal.sosfilt_zi(sos).tolist(),
                "at": kept,
                "filtered": y[kept].tolist(),
            }
        )
    return cases


def splines():
    cases = []
    for knots in [2, 3, 4, 5, 6, 40]:
        steps = 0.01 + 0.004 * (np.arange(knots) % 3)
        t = np.concatenate([[0.0], np.cumsum(steps)[:-1]])
        y = series(knots, knots)
        at = np.linspace(t[0], t[-1], 4 * knots + 3)
        cases.append({"knots": t.tolist(), "values": y.tolist(), "at": at.tolist(), "interpolated": interpolate.CubicSpline(t, y)(at).tolist()})
    return cases


def derivatives():
    q = series(25, 3)
    period_s = 0.004
    return {
        "period_s": period_s,
        "position": q.tolist(),
        "gradient": np.gradient(q, period_s).tolist(),
        "acceleration": ((q[2:] - 2 * q[1:-1] + q[:-2]) / period_s**2).tolist(),
    }


for name, content in [("filters", filters()), ("splines", splines()), ("derivatives", derivatives())]:
    (FOLDER / f"{name}.json").write_text(json.dumps(content, indent=None) + "\n")
