#!/usr/bin/env python3
"""Is the program's FLIP the paper's? Usage: flip_twin.py FLIP_PROBE

LDR-FLIP written from [Andersson2020] as plainly as can be, in double precision: full two-dimensional convolutions, RGB
to XYZ solved from the primaries' chromaticities. Compared pixel by pixel on seeded pictures. Exit 77 (skipped) without
numpy.
"""

import subprocess
import sys

try:
    import numpy as np
except ImportError as absent:
    print(f"skipped: {absent} (install python3-numpy)")
    sys.exit(77)

# Both compute in double; the program's map is float. Rounding of features (1e-16) is taken to the power .5.
TOLERANCE = 1e-6
PPD = 0.7 * 3840 / 0.7 * np.pi / 180


def rgb_to_xyz():
    primaries, white = [(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)], (0.31271, 0.32902)
    column = lambda x, y: np.array([x / y, 1, (1 - x - y) / y])
    unscaled = np.stack([column(*p) for p in primaries], axis=1)
    return unscaled * np.linalg.solve(unscaled, column(*white)), column(*white)


TO_XYZ, WHITE = rgb_to_xyz()


def opponent(rgb):
    x, y, z = np.moveaxis(rgb @ TO_XYZ.T / WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def opponent_to_rgb(ycc):
    y = (ycc[..., 0] + 16) / 116
    xyz = np.stack([ycc[..., 1] / 500 + y, y, y - ycc[..., 2] / 200], axis=-1) * WHITE
    return xyz @ np.linalg.inv(TO_XYZ).T


def hunt_lab(rgb):
    t = rgb @ TO_XYZ.T / WHITE
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    lightness = 116 * f[..., 1] - 16
    hunt = 0.01 * lightness
    return np.stack([lightness, hunt * 500 * (f[..., 0] - f[..., 1]), hunt * 200 * (f[..., 1] - f[..., 2])], axis=-1)


def hyab(a, b):
    return np.abs(a - b)[..., 0] + np.sqrt((a - b)[..., 1] ** 2 + (a - b)[..., 2] ** 2)


def convolve(plane, kernel):
    radius = kernel.shape[0] // 2
    padded = np.pad(plane, radius, mode="edge")
    out = np.zeros(plane.shape)
    for v in range(kernel.shape[0]):
        for u in range(kernel.shape[1]):
            out += kernel[v, u] * padded[v : v + plane.shape[0], u : u + plane.shape[1]]
    return out


def grid(radius):
    return np.meshgrid(np.arange(-radius, radius + 1.0), np.arange(-radius, radius + 1.0))


def eye_filters():
    constants = [(1, 0.0047, 0, 1e-5), (1, 0.0053, 0, 1e-5), (34.1, 0.04, 13.5, 0.025)]
    radius = int(np.ceil(3 * np.sqrt(0.04 / (2 * np.pi**2)) * PPD))
    x, y = grid(radius)
    d2 = (x / PPD) ** 2 + (y / PPD) ** 2
    for a1, b1, a2, b2 in constants:
        g = a1 * np.sqrt(np.pi / b1) * np.exp(-np.pi**2 * d2 / b1) + a2 * np.sqrt(np.pi / b2) * np.exp(-np.pi**2 * d2 / b2)
        yield g / g.sum()


def seen(ycc):
    filtered = np.stack([convolve(ycc[..., c], k) for c, k in enumerate(eye_filters())], axis=-1)
    return hunt_lab(np.clip(opponent_to_rgb(filtered), 0, 1))


def compress(error):
    qc, pc, pt = 0.7, 0.4, 0.95
    most = hyab(hunt_lab(np.array([0.0, 1, 0])), hunt_lab(np.array([0.0, 0, 1]))) ** qc
    assert abs(most - 41.2760) < 1e-4
    error = error**qc
    return np.where(error < pc * most, pt / (pc * most) * error, pt + (error - pc * most) / (most - pc * most) * (1 - pt))


def feature(luminance, points):
    sd = 0.5 * 0.082 * PPD
    x, y = grid(int(np.ceil(3 * sd)))
    g = np.exp(-(x**2 + y**2) / (2 * sd**2))
    k = (x**2 / sd**2 - 1) * g if points else -x * g
    k = np.where(k > 0, k / k[k > 0].sum(), k / -k[k < 0].sum())
    return np.sqrt(convolve(luminance, k) ** 2 + convolve(luminance, k.T) ** 2)


def flip(a, b):
    a, b = opponent(np.clip(a, 0, 1).astype(float)), opponent(np.clip(b, 0, 1).astype(float))
    colour = compress(hyab(seen(a), seen(b)))
    in_a, in_b = (a[..., 0] + 16) / 116, (b[..., 0] + 16) / 116
    features = [np.abs(feature(in_a, points) - feature(in_b, points)) for points in (False, True)]
    return colour ** (1 - (np.maximum(*features) / np.sqrt(2)) ** 0.5)


def pictures():
    random = np.random.default_rng(7)
    noise = lambda h, w: random.random((h, w, 3))
    yield "noise", noise(33, 47), noise(33, 47)
    yield "small difference", (soft := noise(30, 30)), soft + random.normal(0, 0.01, soft.shape)
    black = np.zeros((24, 40, 3))
    line, dot = black.copy(), black.copy()
    line[:, 19], dot[12, 20] = 1, (1, 0.2, 0.1)
    yield "a line", black, line
    yield "a dot", black, dot
    yield "a line moved", line, np.roll(line, 1, axis=1)
    strands = black + 0.7
    for x in range(0, 40, 3):
        strands[:, x] = (0.08, 0.04, 0.02)
    yield "strands, thinned", strands, 0.5 * strands + 0.35
    yield "hues", black + (0, 1, 0), black + (0, 0, 1)
    yield "brighter than white", 3 * noise(12, 12) - 1, noise(12, 12)
    yield "one pixel", noise(1, 1), noise(1, 1)
    yield "one row", noise(1, 50), noise(1, 50)


def main():
    good = True
    for name, a, b in pictures():
        a, b = a.astype(np.float32), b.astype(np.float32)
        data = f"{a.shape[1]} {a.shape[0]}\n".encode() + a.tobytes() + b.tobytes()
        out = subprocess.run([sys.argv[1]], input=data, stdout=subprocess.PIPE, check=True).stdout
        difference = np.abs(np.frombuffer(out, np.float32).reshape(a.shape[:2]) - flip(a, b))
        print(f"{name}: mean FLIP {flip(a, b).mean():.5f}, at most {difference.max():.2e} apart")
        good = good and difference.max() <= TOLERANCE
    sys.exit(0 if good else f"FLIP and its twin differ by more than {TOLERANCE}")


if __name__ == "__main__":
    main()
