"""Kernels by CSPICE, and what CSPICE makes of them, for the tests: python kernels.py FOLDER COUNT

FOLDER/mars.tpc, probe.tls, probe.tf and probe.tsc are read; FOLDER/*.bsp, *.bc, *.bpc are made; FOLDER/expected.json has states, rotations and
apparent places at edges, nodes, in gaps and at COUNT random moments for each thing; null where CSPICE knows nothing.
"""

import json
import os
import sys

import numpy as np
import spiceypy as sp

folder, count = sys.argv[1], int(sys.argv[2])
random = np.random.default_rng(3)
T0 = 8.4e8  # s of TDB since J2000: in August 2026


def path(name):
    return os.path.join(folder, name)


def fresh(name):
    if os.path.exists(path(name)):
        os.remove(path(name))
    return path(name)


for name in ["probe.tls", "mars.tpc", "probe.tf", "probe.tsc"]:
    sp.furnsh(path(name))


def orbit(t, size, period):
    """A state on a tilted ellipse-like curve, km and km/s."""
    w = 2 * np.pi / period
    p = [size * np.cos(w * t), 0.9 * size * np.sin(w * t), 0.3 * size * np.sin(2 * w * t + 0.4)]
    v = [-size * w * np.sin(w * t), 0.9 * size * w * np.cos(w * t), 0.6 * size * w * np.cos(2 * w * t + 0.4)]
    return np.array(p + v)


def chebyshev(size, records, terms, series):
    """Random series whose terms fall off."""
    scale = size * 0.3 ** np.arange(terms)
    return random.uniform(-1, 1, (records, series, terms)) * scale


states, rotations, apparent = [], [], []
moments = {}  # of each target: (centre, frame, edges and nodes, earliest, latest)

# Things of each type, in two segments with a gap: (target, type, degree, nodes)
spk = sp.spkopn(fresh("probe.bsp"), "probe", 300)
KINDS = [(-9008, 8, 7, 30), (-9108, 8, 6, 30), (-9009, 9, 7, 120), (-9109, 9, 4, 30), (-9012, 12, 7, 30), (-9112, 12, 5, 30), (-9013, 13, 7, 30),
         (-9113, 13, 9, 30)]
for body, kind, degree, nodes in KINDS:
    edges = []
    for start in [T0, T0 + 60000.0]:
        step = 300.0
        times = start + step * np.arange(nodes)
        if kind in (9, 13):
            times[1:-1] += random.uniform(-100, 100, nodes - 2)
        table = np.array([orbit(t - T0, 50.0, 27000.0) for t in times])
        # Held from between the first nodes to the last.
        first, last = times[0] + 10.0, times[-1]
        common = [spk, body, 401, "J2000" if kind < 12 else "ECLIPJ2000", first, last, f"type {kind}", degree, nodes]
        if kind == 8:
            sp.spkw08(*common, table, times[0], step)
        elif kind == 9:
            sp.spkw09(*common, table, times)
        elif kind == 12:
            sp.spkw12(*common, table, times[0], step)
        else:
            sp.spkw13(*common, table, times)
        edges += [first, last, first - 1e-3, last + 1e-3, *times[1:6], times[-2], times[-1] - 1.0, *(times[10:14] + times[11:15]) / 2, last + 5000.0]
    moments[body] = (401, "J2000", edges, T0 - 500.0, T0 + 70000.0 + 300 * (nodes - 20))
# The later segment of a file holds: another orbit over a part of the first.
for centre, size in [(401, 70.0), (4, 9000.0)]:
    times = T0 + 2000.0 + 300.0 * np.arange(12)
    sp.spkw13(spk, -9013, centre, "J2000", times[0], times[-1] - 1000.0 * (centre == 4), "later", 7, 12, [orbit(t - T0, size, 21000.0) for t in times], times)
    moments[-9013][2].extend([times[0] - 0.1, times[0], times[5], times[-1] - 1000.0, times[-1] - 500.0, times[-1], times[-1] + 0.1])
for body, kind, centre, size, intervals, terms in [(4, 2, 0, 2e8, 6, 9), (10, 2, 0, 1e6, 4, 6), (401, 3, 4, 9e3, 8, 8), (499, 2, 4, 1e-4, 3, 4)]:
    length = 90000.0 / intervals
    data = chebyshev(size, intervals, terms, 3 if kind == 2 else 6)
    if kind == 3:
        data[:, 3:] *= 2e-4
    if body == 4:
        data[:, :, 0] = [2.06e8, 3e6, -5e6]
        data[:, :, 1] = np.array([1.2, 23.9, 10.9]) * length / 2
        data[:, :, 2:] *= 1e-4
    if body == 10:
        data[:, :, 1:] *= 1e-2
        data[:, :, 0] = [-1e6, -4e5, -1.4e5]
    first = T0 - 10000.0
    last = first + intervals * length
    (sp.spkw02 if kind == 2 else sp.spkw03)(spk, body, centre, "J2000", first, last, f"type {kind}", length, intervals, terms - 1, data.ravel(), first)
    joints = first + length * np.arange(intervals + 1)
    moments[body] = (centre, "J2000", [*joints, *(joints[:-1] + 1e-3), first - 1e-3, last + 1e-3], first, last)
sp.spkcls(spk)

# The same file by a machine of the other byte order.
with open(path("probe.bsp"), "rb") as file:
    raw = bytearray(file.read())


def swap(start, end, size):
    raw[start:end] = np.frombuffer(bytes(raw[start:end]), f"<u{size}").byteswap().tobytes()


if count < 1000:
    swap(8, 16, 4)
    swap(76, 88, 4)
    raw[88:96] = b"BIG-IEEE"
    record = int.from_bytes(raw[76:80], "big")
    ranges = []
    while record:
        at = 1024 * (record - 1)
        following, _, number = np.frombuffer(bytes(raw[at : at + 24]), "<f8")
        for i in range(int(number)):
            s = at + 24 + 40 * i
            begin, end = np.frombuffer(bytes(raw[s + 32 : s + 40]), "<i4")
            ranges.append((8 * (int(begin) - 1), 8 * int(end)))
            swap(s, s + 16, 8)
            swap(s + 16, s + 40, 4)
        swap(at, at + 24, 8)
        record = int(following)
    for begin, end in ranges:
        swap(begin, end, 8)
    with open(path("big.bsp"), "wb") as file:
        file.write(raw)

# Angles of a body.
pck = sp.pckopn(fresh("rock.bpc"), "rock", 300)
angles = chebyshev(0.5, 5, 6, 3)
sp.pckw02(pck, 31999, "ECLIPJ2000", T0, T0 + 50000.0, "rock", 10000.0, 5, 5, angles.ravel(), T0)
sp.pckcls(pck)


def quaternions(number, turn):
    """Attitudes each of which is turned from the one before, with signs at random."""
    axis = random.normal(size=(number, 3))
    q = [np.array([1.0, 0.0, 0.0, 0.0])]
    for a in axis[1:]:
        a /= np.linalg.norm(a)
        q.append(sp.qxq(q[-1], np.array([np.cos(turn / 2), *(np.sin(turn / 2) * a)])))
    return np.array(q) * random.choice([-1.0, 1.0], (number, 1))


def ticks(clock, et):
    return np.round(np.array([sp.sce2c(clock, t) for t in et]))


ck = sp.ckopn(fresh("probe.bc"), "probe", 300)
attitude_moments = {}
# Type 3 with three intervals, once with rates; its directory has two entries.
number = 210
t3 = ticks(-999, T0 + 100.0 * np.arange(number) + random.uniform(-20, 20, number))
starts = t3[[0, 70, 150]]
sp.ckw03(ck, t3[0], t3[-1], -999000, "J2000", False, "type 3", number, t3, quaternions(number, 0.2), np.zeros((number, 3)), 3, starts)
at = [sp.sct2e(-999, t) for t in t3]
attitude_moments["PROBE_SC"] = [at[0] + 0.02, at[-1] - 0.02, at[0] - 1, at[-1] + 1, at[69] - 0.02, at[69] + 0.02, (at[69] + at[70]) / 2, at[70] - 0.02,
                                at[70] + 0.02, at[149] + 3, at[150] + 3, *(np.array(at[20:25]) + 0.02), *at[30:34]]
number = 30
t3 = ticks(-888, T0 + 400.0 * np.arange(number))
sp.ckw03(ck, t3[0] - 500, t3[-1] + 500, -888000, "ECLIPJ2000", True, "type 3 with rates", number, t3, quaternions(number, 2.5), random.normal(size=(number, 3)), 2, t3[[0, 12]])
at = [sp.sct2e(-888, t) for t in t3]
attitude_moments["OTHER_SC"] = [at[0] - 0.1, at[0] + 0.1, at[5] + 3.0, at[11] + 3.0, at[12] - 3.0, at[12] + 3.0, at[-1] - 3, at[-1] + 0.1]
# Type 2: steady turns of more than half a circle, at a pace that is not quite that of the clock.
number = 120
start = ticks(-999, T0 + 30000.0 + 100.0 * np.arange(number))
stop = start + np.where(np.arange(number) % 3, start[1] - start[0], 10000.0)
stop[:-1] = np.minimum(stop[:-1], start[1:])
sp.ckw02(ck, start[0], stop[-1], -999002, "J2000", "type 2", number, start, stop, quaternions(number, 1.0), random.normal(scale=0.05, size=(number, 3)),
         np.full(number, 1.0 / 256.0))
at = np.array([sp.sct2e(-999, t) for t in start])
attitude_moments["PROBE_SPIN"] = [*(at[:9] + 5), *(at[:9] + 95), at[0] - 1, at[-1] + 39.0, at[-1] + 200.0]
# Type 1: single attitudes.
number = 12
t1 = ticks(-999, T0 + 50000.0 + 60.0 * np.arange(number))
sp.ckw01(ck, t1[0], t1[-1], -999001, "J2000", False, "type 1", number, t1, quaternions(number, 1.0), np.zeros((number, 3)))
# A later segment over a part of the first holds.
t3 = ticks(-999, T0 + 1500.0 + 100.0 * np.arange(8))
sp.ckw03(ck, t3[0], t3[-1], -999000, "J2000", False, "later", 8, t3, quaternions(8, 0.3), np.zeros((8, 3)), 2, t3[[0, 4]])
at = [sp.sct2e(-999, t) for t in t3]
attitude_moments["PROBE_SC"] += [at[0] - 0.02, at[0] + 0.02, at[3] + 3, at[4] + 3, at[-1] - 0.02, at[-1] + 0.02]
sp.ckcls(ck)

for name in ["rock.bpc", "probe.bsp", "probe.bc"]:
    sp.furnsh(path(name))


def asked(function):
    try:
        return function()
    except sp.utils.exceptions.SpiceyError:
        return None


def numbers(values):
    return None if values is None else [float(v) for v in np.ravel(values)]


def state(target, centre, frame, et):
    found = asked(lambda: sp.spkezr(str(target), et, frame, "NONE", str(centre))[0])
    states.append([str(target), str(centre), frame, float(et), numbers(found)])


def rotation(to, base, et):
    rotations.append([to, base, float(et), numbers(asked(lambda: sp.pxform(base, to, et)))])


for target, (centre, frame, edges, first, last) in moments.items():
    for et in [*edges, *random.uniform(first, last, count)]:
        state(target, centre, frame, et)
for et in random.uniform(T0, T0 + 15000.0, max(count // 2, 4)):
    state(-9013, "SUN", "ECLIPJ2000", et)
    state("FAST", "PROBE", "J2000", et)
for frame, edges in attitude_moments.items():
    for et in [*edges, *random.uniform(min(edges), max(edges), count)]:
        rotation(frame, "J2000", et)
for et in [T0, T0 + 50000.0, T0 - 1e-3, T0 + 50000.001, *(T0 + 10000.0 * np.arange(1, 5)), *random.uniform(T0, T0 + 50000.0, count)]:
    rotation("ROCK_PA", "J2000", et)
for et in random.uniform(T0, T0 + 6000.0, max(count // 2, 4)):
    for frame in ["PROBE_CAM", "PROBE_STR", "PROBE_ANT"]:
        rotation(frame, "ECLIPJ2000", et)
        rotation("PROBE_SC", frame, et)
for et in [0.0, T0, *random.uniform(-3e9, 3e9, count)]:
    for frame in ["IAU_MARS", "IAU_PHOBOS", "IAU_DEIMOS", "IAU_MOON", "PHOBOS_FIXED"]:
        rotation(frame, "J2000", et)
# What CSPICE finds with a tolerance of one tick.
for t in t1:
    c, _ = sp.ckgp(-999001, t, 0.0, "J2000")
    rotations.append(["PROBE_STILL", "J2000", sp.sct2e(-999, t), numbers(c)])
for et in random.uniform(T0 + 500.0, T0 + 8000.0, max(count // 2, 6)):
    for target in ["SUN", "MARS", "-9009"]:
        for correction in ["CN", "CN+S", "LT+S"]:
            apparent.append([target, "-9013", "J2000", float(et), correction, *map(numbers, sp.spkpos(target, et, "J2000", correction, "-9013"))])

utc = [[text, float(sp.str2et(text))] for text in ["1999-12-31T23:59:59.5", "2016-12-31T23:59:60.5", "2017-01-01T00:00:00", "2026-08-14T10:00:00.25"]]
sizes = {body: numbers(sp.bodvrd(body, "RADII", 3)[1]) for body in ["MARS", "PHOBOS"]}
masses = {body: numbers(sp.bodvrd(body, "GM", 1)[1]) for body in ["MARS", "PHOBOS"]}
with open(path("expected.json"), "w", encoding="utf-8") as file:
    expected = {"states": states, "rotations": rotations, "apparent": apparent, "utc": utc, "radii_km": sizes, "gm_km3_s2": masses}
    lines = [f'"{key}": ' + ("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]" if isinstance(rows, list) else json.dumps(rows))
             for key, rows in expected.items()]
    file.write("{\n" + ",\n".join(lines) + "\n}\n")
