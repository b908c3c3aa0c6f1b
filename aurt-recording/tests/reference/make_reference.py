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


def alignment():
    """The original tool's preprocessing of calibration data, step by step, on a motion between two rests."""
    cases = []
    for samples, rate_hz, f_dyn_hz in [(900, 500.0, 10.0), (903, 500.0, 12.0), (400, 100.0, 2.5)]:
        period_s = 1 / rate_hz
        k = np.arange(samples)
        start, end = 0.15 * samples, 0.85 * samples
        window = np.where((k > start) & (k < end), np.sin(np.pi * (k - start) / (end - start)) ** 2, 0.0)
        q = np.array([0.4 * window * np.sin(2 * np.pi * 1.5 * k * period_s + j) + 0.1 * j for j in range(2)])
        current = np.array([series(samples, 11 + j) for j in range(2)])
        low = signal.butter(4, 5 * f_dyn_hz / (rate_hz / 2), output="sos")
        parallel = signal.butter(4, 2 * f_dyn_hz / (rate_hz / 2), output="sos")
        q_hat = signal.sosfiltfilt(low, q, axis=1)
        velocity = np.gradient(q_hat, period_s, axis=1)[:, 1:-1]
        acceleration = (q_hat[:, 2:] - 2 * q_hat[:, 1:-1] + q_hat[:, :-2]) / period_s**2
        position = q_hat[:, 1:-1]
        moving = np.any(np.abs(velocity) > 0.03, axis=0)
        s = max(int(np.argmax(moving)), 1)
        e = samples - 2 - 1 - int(np.argmax(moving[::-1]))
        factor = round(0.8 / (4 * f_dyn_hz * period_s))
        filtered = signal.sosfiltfilt(parallel, current, axis=1)
        cases.append(
            {
                "samples": samples,
                "rate_hz": rate_hz,
                "f_dyn_hz": f_dyn_hz,
                "decimation": factor,
                "first": s,
                "end": e,
                "position": position[:, s:e:7].tolist(),
                "velocity": velocity[:, s:e:7].tolist(),
                "acceleration": acceleration[:, s:e:7].tolist(),
                "measurement": filtered[:, s:e][:, 1:-1][:, ::factor].tolist(),
                "regressor_rows": len(range(s, e)[::factor]),
                "validation_measurement": filtered[:, 1:-1][:, ::factor].tolist(),
            }
        )
    return cases


for name, content in [("alignment", alignment()), ("filters", filters()), ("splines", splines()), ("derivatives", derivatives())]:
    (FOLDER / f"{name}.json").write_text(json.dumps(content, indent=None) + "\n")
