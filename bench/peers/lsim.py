"""SciPy's lsim on the R2R soft rotor (thesis Table A.7): 10 s chirp held at 10 kHz. Prints time and error as JSON."""
import json
import time

import numpy as np
from scipy.linalg import expm
from scipy.signal import lsim


def soft_rotor():
    """State matrix over (angles relative to node 0 without the first, speeds), input, output row of the shaft torque."""
    n_slices, inertia, k_im, c_im = 70, 4.813, 8.90e6, 28.4
    inertias = np.r_[np.full(n_slices, inertia / n_slices), 0.137, 0.081]
    k = np.r_[np.full(n_slices - 1, k_im * (n_slices - 1)), 5.76e6, 6.37e6]
    c = np.r_[np.full(n_slices - 1, c_im * (n_slices - 1)), 5.5, 125.1]
    n = inertias.size
    twist = np.eye(n - 1, n) - np.eye(n - 1, n, 1)
    K, C = twist.T @ np.diag(k) @ twist, twist.T @ np.diag(c) @ twist
    airgap = np.zeros(n)
    airgap[4:67] = 1 / 63
    relative = np.eye(n)[1:] - np.eye(n)[:1]
    A = np.block([[np.zeros((n - 1, n - 1)), relative],
                  [-(K / inertias[:, None])[:, 1:], -C / inertias[:, None]]])
    B = np.r_[np.zeros(n - 1), airgap / inertias]
    row = np.r_[np.zeros(n - 3), k[-1], -k[-1], np.zeros(n - 2), c[-1], -c[-1]]
    return A, B, row


A, B, row = soft_rotor()
n, steps, dt = A.shape[0], 100_000, 1e-4
t = np.arange(steps) * dt
u = np.sin(2 * np.pi * 100.0 * t * t)

big = np.zeros((n + 1, n + 1))
big[:n, :n], big[:n, n] = A * dt, B * dt
step = expm(big)
phi, gamma = step[:n, :n], step[:n, n]
x, exact = np.zeros(n), np.empty(steps)
for i in range(steps):
    exact[i] = row @ x
    x = phi @ x + gamma * u[i]

begin = time.perf_counter()
_, y, _ = lsim((A, B[:, None], row[None, :], [[0.0]]), u, t, interp=False)
seconds = time.perf_counter() - begin
error = float(np.max(np.abs(np.ravel(y) - exact)) / np.max(np.abs(exact)))
print(json.dumps({"name": "SciPy lsim (held input)", "ms": 1e3 * seconds, "per_step_ns": 1e9 * seconds / steps, "error": error}))
