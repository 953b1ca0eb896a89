// The numbers behind the plots against closed forms and tabulated values:   node test/numbers_test.mjs
import assert from "node:assert/strict";
import test from "node:test";
import {
  correlation_on_scales,
  curve_on_scale,
  density_band,
  density_on_scale,
  moments_on_scale,
  normal_density,
  prior_curve,
  scale_of,
} from "../src/density.js";
import { binomial_range, normal_quantile } from "../src/quantiles.js";

const close = (actual, expected, tolerance) =>
  assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} instead of ${expected}`);

/** Height of a curve at x, between its points. */
function height_at(points, x) {
  const after = points.findIndex(([at]) => at >= x);
  const [a, b] = [points[after - 1], points[after]];
  return a[1] + ((b[1] - a[1]) * (x - a[0])) / (b[0] - a[0]);
}

/** Integral of f by Simpson's rule. */
function integral(f, low, high, steps = 4000) {
  const h = (high - low) / steps;
  let sum = f(low) + f(high);
  for (let k = 1; k < steps; k += 1) sum += (k % 2 ? 4 : 2) * f(low + k * h);
  return (sum * h) / 3;
}

test("a normal quantile has the tabulated values", () => {
  close(normal_quantile(0.975), 1.959963984540054, 5e-9);
  close(normal_quantile(0.3), -0.5244005127080409, 5e-9);
  close(normal_quantile(0.001), -3.090232306167813, 5e-9);
  assert.equal(normal_quantile(0.5), 0);
});

test("a range of counts is that of the binomial quantiles", () => {
  assert.deepEqual(binomial_range(10, 0.5, 0.95), [2, 8]); // P(K <= 1) = 11/1024, P(K <= 2) = 56/1024, and mirrored
  assert.deepEqual(binomial_range(3, 0.1, 0.95), [0, 2]); // P(K <= 1) = 0.972, P(K <= 2) = 0.999
});

test("the log scale's moments are those of the lognormal distribution", () => {
  const { mean, std } = moments_on_scale(
    scale_of("log"),
    Math.exp(0.3 + 0.08),
    Math.exp(0.38) * Math.sqrt(Math.expm1(0.16)),
  );
  close(mean, 0.3, 1e-12);
  close(std, 0.4, 1e-12);
});

test("the logit scale's moments give back mean and deviation of the variable", () => {
  const scale = scale_of("logit", [1, 4]);
  for (const [mean, std] of [
    [2.5, 0.4],
    [1.4, 0.2],
    [3.7, 0.15],
  ]) {
    const moments = moments_on_scale(scale, mean, std);
    const density = (x) => density_on_scale(scale, moments, x);
    const edge = 1e-9;
    close(integral(density, 1 + edge, 4 - edge), 1, 1e-6);
    close(
      integral((x) => x * density(x), 1 + edge, 4 - edge),
      mean,
      1e-6,
    );
    close(Math.sqrt(integral((x) => (x - mean) ** 2 * density(x), 1 + edge, 4 - edge)), std, 1e-6);
  }
});

test("priors of every family have their closed density", () => {
  // Within 0.2 %: curves of straight pieces.
  const near = (curve, x, expected) => close(height_at(curve, x), expected, 2e-3 * expected);
  near(prior_curve({ kind: "normal" }, 2, 0.3), 2.1, normal_density(2.1, 2, 0.3));
  near(prior_curve({ kind: "uniform", lower: 1, upper: 3 }, 2, 1), 1.7, 0.5);
  // Beta(2, 5) on [0, 1]: 30 x (1 - x)^4.
  const beta = { kind: "beta", mean: 2 / 7, std: Math.sqrt(10 / (49 * 8)), lower: 0, upper: 1 };
  near(prior_curve(beta, beta.mean, beta.std), 0.3, 30 * 0.3 * 0.7 ** 4);
  // Gamma of shape 4 and scale 1/2: 16 x^3 exp(-2 x) / 6.
  near(prior_curve({ kind: "gamma", mean: 2, std: 1 }, 2, 1), 2, (16 * 8 * Math.exp(-4)) / 6);
  // N(0, 1) cut to [-1, 2], which holds 0.8185946.
  near(
    prior_curve({ kind: "truncated-normal", mean: 0, std: 1, lower: -1, upper: 2 }, 0.23, 0.72),
    0.1,
    normal_density(0.1, 0, 1) / 0.8185946141,
  );
  const [mean, std] = [Math.exp(0.02), Math.exp(0.02) * Math.sqrt(Math.expm1(0.04))];
  near(prior_curve({ kind: "lognormal" }, mean, std), 1, normal_density(0, 0, 0.2));
});

test("a prior whose family is not told is a normal", () => {
  assert.deepEqual(prior_curve(undefined, 1, 0.1), curve_on_scale(scale_of("identity"), { mean: 1, std: 0.1 }));
  assert.deepEqual(prior_curve(null, null, 0.1), []);
});

test("a band holds every density that its intervals allow, and touches some of them", () => {
  for (const kind of ["identity", "log"]) {
    const scale = scale_of(kind);
    const band = density_band(scale, [0.9, 1.1], [0.1, 0.3]);
    const slack = kind === "identity" ? 1e-12 : 0.03; // beside pairs of a grid there is a little more
    for (const [x, low, high] of band) {
      let [least, greatest] = [Infinity, 0];
      for (let i = 0; i <= 40; i += 1) {
        for (let j = 0; j <= 40; j += 1) {
          const density = density_on_scale(scale, moments_on_scale(scale, 0.9 + 0.005 * i, 0.1 + 0.005 * j), x);
          [least, greatest] = [Math.min(least, density), Math.max(greatest, density)];
        }
      }
      assert.ok(low <= least + 4 * slack && high >= greatest - 4 * slack, `${kind} at ${x}`);
      close(low, least, 0.05);
      close(high, greatest, 0.12);
    }
  }
});

test("an interval that is not known, or of no width, has no band", () => {
  assert.deepEqual(density_band(scale_of("identity"), [null, 1], [0.1, 0.3]), []);
  assert.deepEqual(density_band(scale_of("identity"), [0.9, 1], [0, 0]), []);
});

test("a correlation on the scales is that which makes the covariance of the variables", () => {
  const [identity, log] = [scale_of("identity"), scale_of("log")];
  const [a, b] = [
    { mean: 0.2, std: 0.3 },
    { mean: -0.1, std: 0.5 },
  ];
  const [mean_a, mean_b] = [Math.exp(0.2 + 0.045), Math.exp(-0.1 + 0.125)];
  for (const rho of [-0.9, -0.3, 0, 0.6, 0.98]) {
    close(correlation_on_scales(identity, a, identity, b, rho * 0.15), rho, 1e-12);
    close(correlation_on_scales(log, a, log, b, mean_a * mean_b * Math.expm1(rho * 0.15)), rho, 1e-6); // two digits are shown
    close(correlation_on_scales(identity, a, log, b, rho * 0.15 * mean_b), rho, 1e-6); // two digits are shown
  }
  assert.equal(correlation_on_scales(log, { mean: 0, std: 0 }, log, b, 0), null);
});
