// Curves and regions of a made-up result, as the program writes them: normal on each parameter's scale to first order. Its
// numbers serve to look at the page; nobody takes them as results.
const is_number = (value) => typeof value === "number" && Number.isFinite(value);
const scales = {
  identity: () => ({ from: (x) => x, to: (t) => t, slope: () => 1 }),
  log: () => ({ from: Math.log, to: Math.exp, slope: Math.exp }),
  logit: ([low, high]) => ({
    from: (x) => Math.log((x - low) / (high - x)),
    to: (t) => low + (high - low) / (1 + Math.exp(-t)),
    slope: (t) => ((high - low) * Math.exp(-t)) / (1 + Math.exp(-t)) ** 2,
  }),
};
const normal_density = (z) => Math.exp(-0.5 * z * z) / Math.sqrt(2 * Math.PI);

function on_scale(scale, mean, std) {
  const t = scale.from(mean);
  return { mean: t, std: std / scale.slope(t) };
}

function curve(scale, { mean, std }) {
  const t = Array.from({ length: 161 }, (_, k) => mean + ((k - 80) / 20) * std);
  return {
    x: t.map(scale.to),
    density: t.map((at) => normal_density((at - mean) / std) / (std * scale.slope(at))),
  };
}

/** Least and greatest of the curves at the corners of the intervals and in the middle. */
function band(scale, mean_interval, std_interval) {
  if (![...mean_interval, ...std_interval].every(is_number)) return null;
  const pairs = [0, 0.25, 0.5, 0.75, 1].flatMap((a) =>
    [0, 0.25, 0.5, 0.75, 1].map((b) =>
      on_scale(
        scale,
        mean_interval[0] + a * (mean_interval[1] - mean_interval[0]),
        std_interval[0] + b * (std_interval[1] - std_interval[0]),
      ),
    ),
  );
  const low = Math.min(...pairs.map(({ mean, std }) => scale.to(mean - 3.5 * std)));
  const high = Math.max(...pairs.map(({ mean, std }) => scale.to(mean + 3.5 * std)));
  const x = Array.from({ length: 161 }, (_, k) => low + ((high - low) * k) / 160);
  const values = x.map((at) => {
    const t = scale.from(at);
    return pairs.map(({ mean, std }) => normal_density((t - mean) / std) / (std * scale.slope(t)));
  });
  return { x, least: values.map((row) => Math.min(...row)), greatest: values.map((row) => Math.max(...row)) };
}

function outline(first, second, correlation) {
  const angles = Array.from({ length: 65 }, (_, k) => (2 * Math.PI * k) / 64);
  const rest = Math.sqrt(1 - correlation ** 2);
  return {
    x: angles.map((a) => first.scale.to(first.moments.mean + 2 * first.moments.std * Math.cos(a))),
    y: angles.map((a) =>
      second.scale.to(second.moments.mean + 2 * second.moments.std * (correlation * Math.cos(a) + rest * Math.sin(a))),
    ),
  };
}

/** Adds `estimate`, `densities`, `correlation`, `regions` to the parameters of a result that has moments. */
export function add_curves(parameters) {
  const { mean, std, covariance, bounds, prior_mean, prior_std, mean_ci95, std_ci95, correlation_ci95 } = parameters;
  const all = mean.map((value, i) => {
    const kind = parameters.scale?.[i] ?? "identity";
    const scale = scales[kind](bounds?.[i] ?? []);
    return { scale, kind, moments: on_scale(scale, value, std[i]) };
  });
  const intervals = (i, j) => (correlation_ci95?.[i]?.[j] ?? []).filter(is_number);
  const rho = (i, j) => (std[i] > 0 && std[j] > 0 ? covariance[i][j] / Math.sqrt(covariance[i][i] * covariance[j][j]) : null);
  const has_intervals = mean.some((_, i) => mean.some((__, j) => i !== j && intervals(i, j).length === 2));
  const correlation = mean.map((_, i) =>
    mean.map((__, j) => (i !== j && has_intervals && intervals(i, j).length < 2 ? null : rho(i, j))),
  );
  parameters.estimate = { kind: parameters.is_population ? "population" : "mean", log_evidence: null, effective_samples: null, region_probability: 1 - Math.exp(-2) };
  parameters.densities = all.map(({ scale, kind, moments }, i) => {
    const prior_scale = kind === "log" ? scale : scales.identity();
    return {
      prior: curve(prior_scale, on_scale(prior_scale, prior_mean[i], prior_std[i])),
      updated: std[i] > 0 ? curve(scale, moments) : null,
      band: mean_ci95?.[i] && std_ci95?.[i] ? band(scale, mean_ci95[i], std_ci95[i]) : null,
    };
  });
  parameters.correlation = correlation;
  parameters.regions = all.flatMap((first, i) =>
    all.slice(i + 1).map((second, k) => {
      const j = i + 1 + k;
      const is_drawn = is_number(correlation[i][j]);
      return {
        first: i,
        second: j,
        outlines: is_drawn ? [outline(first, second, correlation[i][j])] : [],
        interval_ends: is_drawn ? intervals(i, j).map((end) => outline(first, second, end)) : [],
      };
    }),
  );
}
