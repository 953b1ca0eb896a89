// Densities of parameters: the prior's six families, and a population that is normal on a scale of its own.
// Knows no drawing and no page, so that the tests hold its numbers against closed forms.
import { is_number } from "./data.js";

const root_two_pi = Math.sqrt(2 * Math.PI);
export const normal_density = (x, mean, std) => Math.exp(-0.5 * ((x - mean) / std) ** 2) / (std * root_two_pi);

/** t of x, x of t and dx/dt: where the population is normal. `bounds` are those of a logit. */
export function scale_of(kind, bounds = []) {
  const [lower, upper] = bounds;
  if (kind === "log") return { kind, from: Math.log, to: Math.exp, slope: Math.exp };
  if (kind === "logit" && is_number(lower) && is_number(upper)) {
    const share = (t) => 1 / (1 + Math.exp(-t));
    return {
      kind,
      from: (x) => Math.log((x - lower) / (upper - x)),
      to: (t) => lower + (upper - lower) * share(t),
      slope: (t) => (upper - lower) * share(t) * (1 - share(t)),
    };
  }
  return { kind: "identity", from: (x) => x, to: (t) => t, slope: () => 1 };
}

const nodes = Array.from({ length: 61 }, (_, k) => {
  const z = (k - 30) / 5;
  return { z, weight: 0.2 * normal_density(z, 0, 1) };
});

/** E[f(z)] of a standard normal z by the trapezoidal rule, which for such integrands converges faster than any power. */
export const expectation = (f) => nodes.reduce((sum, { z, weight }) => sum + weight * f(z), 0);

function moments_on_axis(scale, { mean, std }) {
  const first = expectation((z) => scale.to(mean + std * z));
  return { mean: first, std: Math.sqrt(expectation((z) => (scale.to(mean + std * z) - first) ** 2)) };
}

/**
 * Mean and deviation on the scale of a population whose variable has `mean` and `std`; null where there are none.
 * Log: closed form. Logit: Newton's method on the two moments, differences as derivatives.
 */
export function moments_on_scale(scale, mean, std) {
  if (!is_number(mean) || !is_number(std) || std < 0) return null;
  if (scale.kind === "identity") return { mean, std };
  if (scale.kind === "log") {
    const variance = Math.log1p((std / mean) ** 2);
    return mean > 0 ? { mean: Math.log(mean) - variance / 2, std: Math.sqrt(variance) } : null;
  }
  const start = scale.from(mean);
  if (!is_number(start)) return null;
  let at = { mean: start, std: std / scale.slope(start) };
  for (let step = 0; step < 60; step += 1) {
    const here = moments_on_axis(scale, at);
    const gap = [mean - here.mean, std - here.std];
    if (Math.hypot(...gap) <= 1e-11 * std) return at;
    const h = 1e-5 * at.std;
    const by_mean = moments_on_axis(scale, { ...at, mean: at.mean + h });
    const by_std = moments_on_axis(scale, { ...at, std: at.std + h });
    const [a, b] = [(by_mean.mean - here.mean) / h, (by_std.mean - here.mean) / h];
    const [c, d] = [(by_mean.std - here.std) / h, (by_std.std - here.std) / h];
    const determinant = a * d - b * c;
    const moved = (d * gap[0] - b * gap[1]) / determinant;
    const widened = (a * gap[1] - c * gap[0]) / determinant;
    at = { mean: at.mean + moved, std: Math.max(at.std / 2, Math.min(2 * at.std, at.std + widened)) };
    if (!is_number(at.mean) || !is_number(at.std)) return null;
  }
  return moments_on_axis(scale, at).std > 0 ? at : null;
}

/** Density of the variable at x, normal with `moments` on the scale. */
export function density_on_scale(scale, moments, x) {
  const t = scale.from(x);
  const slope = scale.slope(t);
  return is_number(t) && slope > 0 ? normal_density(t, moments.mean, moments.std) / slope : 0;
}

const evenly = (low, high, count) => Array.from({ length: count }, (_, k) => low + ((high - low) * k) / (count - 1));

/** [[x, density], ...] from -`reach` to +`reach` deviations on the scale. */
export function curve_on_scale(scale, moments, reach = 4, count = 161) {
  return evenly(moments.mean - reach * moments.std, moments.mean + reach * moments.std, count).map((t) => [
    scale.to(t),
    normal_density(t, moments.mean, moments.std) / scale.slope(t),
  ]);
}

/** Densities up to a factor, and where they live. Normalised by the trapezoidal rule in prior_curve. */
const families = {
  "truncated-normal": ({ mean, std, lower, upper }) => ({
    range: [Math.max(lower, mean - 5 * std), Math.min(upper, mean + 5 * std)],
    density: (x) => normal_density(x, mean, std),
  }),
  beta: ({ mean, std, lower, upper }) => {
    const share = (mean - lower) / (upper - lower);
    const total = (share * (1 - share) * (upper - lower) ** 2) / std ** 2 - 1;
    const [a, b] = [share * total, (1 - share) * total];
    const inset = 1e-3 * (upper - lower); // a density may be infinite at the ends
    return {
      range: [Math.max(lower + inset, mean - 6 * std), Math.min(upper - inset, mean + 6 * std)],
      density: (x) => {
        const z = (x - lower) / (upper - lower);
        return Math.exp((a - 1) * Math.log(z / share) + (b - 1) * Math.log((1 - z) / (1 - share)));
      },
    };
  },
  gamma: ({ mean, std }) => {
    const shape = (mean / std) ** 2;
    return {
      range: [Math.max(1e-3 * mean, mean - 4 * std), mean + 6 * std],
      density: (x) => Math.exp((shape - 1) * Math.log(x / mean) - shape * (x / mean - 1)),
    };
  },
};

function trapezoid(points) {
  return points.slice(1).reduce((sum, [x, y], k) => sum + ((x - points[k][0]) * (y + points[k][1])) / 2, 0);
}

/** Density of the prior as a curve; of one whose family is not told, a normal of that mean and deviation. */
export function prior_curve(prior, mean, std) {
  const kind = prior?.kind;
  if (kind === "uniform") {
    const height = 1 / (prior.upper - prior.lower);
    return [
      [prior.lower, 0],
      [prior.lower, height],
      [prior.upper, height],
      [prior.upper, 0],
    ];
  }
  if (families[kind]) {
    const { range, density } = families[kind](prior);
    const points = evenly(...range, 241).map((x) => [x, density(x)]);
    const area = trapezoid(points);
    return area > 0 && is_number(area) ? points.map(([x, y]) => [x, y / area]) : [];
  }
  const scale = scale_of(kind === "lognormal" ? "log" : "identity");
  const moments = moments_on_scale(scale, mean, std);
  return moments && moments.std > 0 ? curve_on_scale(scale, moments) : [];
}

/** Least and greatest density at x of normals with a mean in [a, b] and a deviation in [c, d]. */
function normal_envelope(x, [a, b], [c, d]) {
  const near = Math.max(0, a - x, x - b);
  const far = Math.max(Math.abs(x - a), Math.abs(x - b));
  return [
    Math.min(normal_density(far, 0, c), normal_density(far, 0, d)),
    normal_density(near, 0, Math.min(d, Math.max(c, near))),
  ];
}

const least_share = 0.02; // of the interval's upper end: a deviation that may be zero has an infinite density

/**
 * [[x, least, greatest], ...]: between which densities the intervals of mean and deviation leave room. A normal's bounds are exact;
 * on another scale they are those of 17 by 7 pairs of mean and deviation.
 */
export function density_band(scale, mean_interval, std_interval, count = 161) {
  if (![...mean_interval, ...std_interval].every(is_number) || !(std_interval[1] > 0)) return [];
  const stds = [Math.max(std_interval[0], least_share * std_interval[1]), std_interval[1]];
  const [low, high] = [mean_interval[0] - 3.5 * stds[1], mean_interval[1] + 3.5 * stds[1]];
  if (scale.kind === "identity")
    return evenly(low, high, count).map((x) => [x, ...normal_envelope(x, mean_interval, stds)]);
  const pairs = evenly(...mean_interval, 17)
    .flatMap((mean) => evenly(...stds, 7).map((std) => moments_on_scale(scale, mean, std)))
    .filter(Boolean);
  if (!pairs.length) return [];
  const reach = (sign) => pairs.map(({ mean, std }) => scale.to(mean + sign * 3.5 * std));
  return evenly(Math.min(...reach(-1)), Math.max(...reach(1)), count).map((x) => {
    const values = pairs.map((moments) => density_on_scale(scale, moments, x));
    return [x, Math.min(...values), Math.max(...values)];
  });
}

/** Correlation on their scales of two variables with moments `a`, `b` there and `covariance` on their axes, by bisection. */
export function correlation_on_scales(first, a, second, b, covariance) {
  if (!a || !b || !(a.std > 0) || !(b.std > 0) || !is_number(covariance)) return null;
  if (first.kind === "identity" && second.kind === "identity") return covariance / (a.std * b.std);
  const means = [expectation((z) => first.to(a.mean + a.std * z)), expectation((z) => second.to(b.mean + b.std * z))];
  const covariance_at = (rho) => {
    const rest = Math.sqrt(1 - rho * rho);
    return expectation((z) => {
      const inner = expectation((w) => second.to(b.mean + b.std * (rho * z + rest * w)) - means[1]);
      return (first.to(a.mean + a.std * z) - means[0]) * inner;
    });
  };
  let [low, high] = [-1, 1];
  for (let step = 0; step < 34; step += 1) {
    const middle = (low + high) / 2;
    if (covariance_at(middle) < covariance) low = middle;
    else high = middle;
  }
  return (low + high) / 2;
}
