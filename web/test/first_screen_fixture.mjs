// What a result says for the first screen, made up for simulated runs: comparison with the tests, marks, next command.

const number = (value) => (Number.isFinite(value) ? value : null);
const deviation = (covariance, k) => Math.sqrt(covariance?.[k]?.[k] ?? NaN);

function compared(outputs, which, k) {
  const tested = outputs.test_mean[k];
  const difference = outputs[`${which}_mean`][k] - tested;
  const scatter = deviation(outputs.test_covariance, k);
  return {
    mean_difference: number(difference),
    mean_error: number(difference / Math.abs(tested)),
    standard_errors: number(difference / (scatter / Math.sqrt(10))),
    std_ratio: number(deviation(outputs[`${which}_covariance`], k) / scatter),
  };
}

/** Adds agreement, findings, headline and next command; `flagged`: positions of outputs whose scatter is not reproduced. */
export function with_first_screen(data, { flagged = [], marks = [], is_reassuring = false, headline, command } = {}) {
  const { outputs, parameters, verdict } = data.result;
  const order = outputs.names.map((_, k) => k).sort((a, b) => flagged.includes(b) - flagged.includes(a) || a - b);
  data.result.agreement = {
    chance: 0.01,
    outputs: order.map((k) => ({
      name: outputs.names[k],
      unit: outputs.units[k],
      initial: compared(outputs, "initial", k),
      final: compared(outputs, "final", k),
      critical_standard_errors: 3.7,
      std_ratio_range: [0.58, 2.6],
      is_mean_reproduced: true,
      is_scatter_reproduced: !flagged.includes(k),
    })),
    region: { probability: 0.95, tests: 10, initial_inside: 0, final_inside: 9, least_inside: 7, is_reproduced: true },
    are_means_reproduced: true,
    is_scatter_reproduced: flagged.length === 0,
  };
  parameters.findings = parameters.names.map((_, i) => ({
    mark: marks[i % (marks.length || 1)] ?? "found",
    interval95: parameters.mean_ci95?.[i] ?? [null, null],
    prior95: [
      parameters.prior_mean[i] - 2 * parameters.prior_std[i],
      parameters.prior_mean[i] + 2 * parameters.prior_std[i],
    ],
    reason: "<b>A reason</b> in words.",
  }));
  Object.assign(verdict, {
    headline: headline ?? "A headline.",
    is_reassuring,
    summary: ["Means: <i>as text</i>.", "Scatter: as text."],
    causes: [
      { kind: "outlier", sentence: "Specimen <3> lies 9.4 standard deviations from the others.", specimens: [3], outputs: [], next: { command: null, reason: "Look at it." } },
      ...(verdict.conclusion === "inadequate" ? [{ kind: "means", sentence: "The means of f1 differ.", specimens: [], outputs: ["f1"], next: { command: null, reason: "Diagnose." } }] : []),
    ],
    next: [{ command: command ?? "mottle diagnose 'case <1>.toml'", reason: "Since `it` is so." }],
  });
  return data;
}
