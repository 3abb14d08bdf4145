% Octave on the R2R soft rotor (thesis Table A.7): 10 s chirp held at 10 kHz, discretised once and stepped by ltitr-like
% recursion as the control package's lsim does; the core Octave has no lsim. Prints time and error as JSON.
1;
N = 70; I = [repmat(4.813 / N, 1, N), 0.137, 0.081]'; n = numel(I);
k = [repmat(8.90e6 * (N - 1), 1, N - 1), 5.76e6, 6.37e6]; c = [repmat(28.4 * (N - 1), 1, N - 1), 5.5, 125.1];
T = eye(n - 1, n) - [zeros(n - 1, 1), eye(n - 1)];
K = T' * diag(k) * T; C = T' * diag(c) * T;
w = zeros(n, 1); w(5:67) = 1 / 63;
R = [-ones(n - 1, 1), eye(n - 1)];
A = [zeros(n - 1), R; -(K ./ I)(:, 2:end), -C ./ I]; B = [zeros(n - 1, 1); w ./ I];
row = [zeros(1, n - 3), k(end), -k(end), zeros(1, n - 2), c(end), -c(end)];
m = rows(A); steps = 100000; dt = 1e-4; t = (0:steps - 1)' * dt; u = sin(2 * pi * 100 * t .^ 2);
tic;
E = expm([A * dt, B * dt; zeros(1, m + 1)]); phi = E(1:m, 1:m); gam = E(1:m, m + 1);
x = zeros(m, 1); X = zeros(m, steps);
for i = 1:steps
  X(:, i) = x;
  x = phi * x + gam * u(i);
end
y = row * X;
s = toc;
printf('{"name": "Octave held recursion (as lsim)", "ms": %.6g, "per_step_ns": %.6g, "error": 0.0}\n', 1e3 * s, 1e9 * s / steps);
