// Pages to look at and to test on, made of simulated runs:   node test/make_fixture.mjs [OUT_DIR] [TEMPLATE] [NAME...]
//   case1      the paper's three masses, right model           refused   its case 2: inadequate, a parameter on its bound, hostile texts
//   population case1 by a method that estimates a population: every scale, an outlier, a prediction
//   modes      a page of mode shapes                           shapes    case1 with mode shapes
//   diagnosis  a page of diagnose, linear-diagnosis before its fits
//   posterior  case1 by a sampler of a posterior
//   old        population without the curves that earlier versions did not write
//   aeroplane  14 outputs and 18 parameters, gaps in the tests  propagate only a cloud        sparse    most entries missing or null
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { add_curves } from "./curves_fixture.mjs";
import { diagnosis_page } from "./diagnosis_fixture.mjs";
import { eigen, random_normal } from "./matrix.mjs";
import { with_first_screen } from "./first_screen_fixture.mjs";
import { add_posterior } from "./posterior_fixture.mjs";
import { prediction_of, with_batches, with_population } from "./population_fixture.mjs";
import { update } from "./simulate.mjs";
import { modes_page, plate_mac, plate_modes } from "./structure_fixture.mjs";

const here = path.dirname(new URL(import.meta.url).pathname);
const out = path.resolve(process.argv[2] ?? path.join(here, "..", "dist", "fixtures"));
const place = "/*MOTTLE_DATA*/";
/** The page without data, or any page that the program wrote, of which the data are taken out. */
const template = readFileSync(process.argv[3] ?? path.join(here, "..", "dist", "page.html"), "utf8").replace(
  /(id="mottle-data">)[^]*?(?=<\/script>)/,
  `$1${place}`,
);

function three_masses(k1, k2, k5, k6) {
  const stiffness = [
    [k1 + 1 + k6, -1, -k6],
    [-1, k2 + 1 + k5, -k5],
    [-k6, -k5, 1 + k5 + k6],
  ];
  return eigen(stiffness).values.map((value) => Math.sqrt(Math.max(value, 0)) / (2 * Math.PI));
}

const check = (name, statistic, critical, p_value, meaning) => ({
  name,
  statistic,
  critical,
  p_value,
  passed: statistic < critical,
  meaning,
});

function masses_study(more) {
  const normal = random_normal(7);
  const specimens = Array.from({ length: 10 }, () => [1 + 0.2 * normal(), 1 + 0.2 * normal(), 1 + 0.2 * normal()]);
  return {
    title: "Three masses, case 1: only the wrong parameters are updated",
    names: ["k1", "k2", "k5"],
    units: ["N/m", "N/m", "N/m"],
    output_names: ["f1", "f2", "f3"],
    output_units: ["Hz", "Hz", "Hz"],
    prior_mean: [2, 2, 2],
    prior_std: [0.3, 0.3, 0.3],
    bounds: [
      [0.5, 3],
      [0.5, 3],
      [0.5, 3],
    ],
    samples: 1000,
    iterations: 12,
    seed: 1,
    model: (x) => three_masses(...x, 3),
    tests: specimens.map((x) => three_masses(...x, more.test_k6 ?? 3)),
    verdict: {
      conclusion: "adequate",
      adequate: true,
      level: 0.05,
      tests: [
        check("Hotelling's T² on the means", 0.41, 7.858, 0.9378, "The means of tests and cloud agree."),
        check("Box's M on the covariances", 9.62, 16.81, 0.1417, "The scatter of tests and cloud agrees."),
        check("Whitened residuals of the specimens", 2.91, 3.72, 0.112, "No specimen lies outside the cloud."),
      ],
      reasons: [],
      not_tested: [],
      could_hide: [
        {
          name: "k6",
          nominal: 3,
          relative_change: 0.043,
          is_detected: true,
          would_move: [
            { parameter: "k1", half_widths: 0.62 },
            { parameter: "k2", half_widths: -0.21 },
            { parameter: "k5", half_widths: 0.44 },
          ],
        },
      ],
    },
    ...more,
  };
}

function refused_study() {
  return masses_study({
    title: "</script><b>x",
    test_k6: 3.5,
    iterations: 10,
    output_names: ["f1", "<img src=x onerror=alert(1)>", "f3"],
    verdict: {
      conclusion: "inadequate",
      adequate: false,
      level: 0.05,
      tests: [
        check(
          "Hotelling's T² on the means",
          118.4,
          7.858,
          1.2e-9,
          "The means of tests and cloud differ by more than chance.",
        ),
        check("Box's M on the covariances", 31.2, 16.81, 2.4e-5, "The cloud scatters less than the tests."),
        check("Parameters on their bounds", 1, 0.5, null, "k2 ended on its lower bound."),
      ],
      reasons: [
        "The mean of f1 stays 13.3 % above the tests, 10.9 standard errors.",
        "Parameter k2 ended on its lower bound 0.5 N/m.",
        "<!-- <script>alert(1)</script> -->",
      ],
    },
  });
}

function aeroplane_study() {
  const normal = random_normal(42);
  const p = 14;
  const q = 18;
  const nominal = Array.from({ length: p }, (_, j) => 6.1 * 1.32 ** j);
  const slopes = nominal.map((f, j) =>
    Array.from({ length: q }, (_, i) =>
      i === 11 ? 0 : 0.06 * f * Math.exp(-0.25 * Math.abs(i - 1.3 * j)) * (1 + 0.3 * normal()),
    ),
  );
  const model = (x) =>
    nominal.map(
      (f, j) =>
        f +
        slopes[j].reduce((sum, slope, i) => sum + slope * (x[i] - 1) - 0.05 * slope * (x[i] - 1) ** 2, 0) +
        0.002 * f * normal(),
    );
  const truth = Array.from({ length: q }, (_, i) => 1 + 0.25 * Math.sin(i));
  return {
    title: "Aeroplane frame, 86 assemblies: support and joint stiffness, cable and screw masses",
    names: Array.from({ length: q }, (_, i) =>
      i < 4 ? `support_${i + 1}` : i < 12 ? `joint_stiffness_${i - 3}` : `mass_${i - 11}`,
    ),
    units: Array.from({ length: q }, (_, i) => (i < 12 ? "1" : "kg")),
    output_names: nominal.map((_, j) => `f${j + 1}`),
    output_units: nominal.map(() => "Hz"),
    prior_mean: new Array(q).fill(1),
    prior_std: new Array(q).fill(0.2),
    bounds: Array.from({ length: q }, (_, i) => (i % 3 ? [0.3, null] : [0.3, 2])),
    samples: 600,
    iterations: 8,
    seed: 20060117,
    model,
    tests: Array.from({ length: 86 }, () => model(truth.map((t) => t + 0.1 * normal()))),
    verdict: {
      conclusion: "undecided",
      adequate: null,
      level: 0.05,
      tests: [],
      reasons: ["Too many entries are missing for a test of the covariances."],
      not_tested: [
        "14 outputs are no more than the identifiable parameters: any means can be matched.",
        "`MAT1:2:E` off by 10 % would have passed, and moves joint_stiffness_3 by 1.4 half-widths of its 95 % interval.",
        "<b>hostile</b> texts are texts.",
      ],
      could_hide: [
        {
          name: "MAT1:2:E",
          nominal: 7.1e10,
          relative_change: 0.1,
          is_detected: false,
          would_move: [
            { parameter: "joint_stiffness_3", half_widths: 1.4 },
            { parameter: "mass_2", half_widths: null },
          ],
        },
        { name: "PSHELL:7:T", nominal: null, relative_change: null, is_detected: true, would_move: null },
      ],
    },
  };
}

function with_gaps(data) {
  data.tests.rows.forEach((row, i) =>
    row.forEach((_, j) => {
      if ((3 * i + 5 * j) % 17 === 0) row[j] = null;
    }),
  );
  data.result.outputs.test_count = data.tests.columns.map(
    (_, j) => data.tests.rows.filter((row) => row[j] !== null).length,
  );
  data.result.status = "max-iterations";
  data.result.warnings = ["11 of 5411 evaluations failed: the cloud may be biased where they lie."];
  data.result.failed_evaluations = Array.from({ length: 11 }, (_, i) => ({
    iteration: i % 4,
    sample: 37 * i + 5,
    reason: i % 3 ? "solver ended with code 201: zero pivot at node 4711" : "no answer within 60 s",
  }));
  return data;
}

function propagate(data) {
  const {
    schema,
    mottle,
    units,
    seed,
    regression,
    spearman,
    identifiability,
    sample_size,
    parameters,
    outputs,
    timings_s,
  } = data.result;
  return {
    result: {
      schema,
      mottle,
      title: "Three masses, the cloud alone",
      command: "propagate",
      units,
      seed,
      status: null,
      method: null,
      parameters: {
        names: parameters.names,
        units: parameters.units,
        prior_mean: parameters.prior_mean,
        prior_std: parameters.prior_std,
        bounds: parameters.bounds,
      },
      outputs: {
        names: outputs.names,
        units: outputs.units,
        initial_mean: outputs.initial_mean,
        initial_covariance: outputs.initial_covariance,
      },
      regression,
      spearman,
      identifiability,
      sample_size: { monte_carlo_error: sample_size.monte_carlo_error },
      verdict: null,
      model_evaluations: 1000,
      failed_evaluations: [],
      timings_s,
      options: { samples: 1000 },
    },
    clouds: [data.clouds[0]],
  };
}

function sparse(data) {
  const { result } = data;
  result.title = null;
  result.parameters.densities = [{ prior: null, updated: { x: [1, null], density: [0.1] }, band: null }, null];
  result.verdict = {
    adequate: null,
    tests: [{ name: "Hotelling's T²", statistic: null, critical: null, p_value: null, passed: null }],
  };
  result.parameters.mean[1] = null;
  result.parameters.regions = result.parameters.regions.filter(({ first, second }) => first !== 1 && second !== 1);
  result.parameters.correlation.forEach((row) => (row[1] = null));
  result.parameters.correlation[1] = null;
  result.parameters.mean_ci95 = null;
  result.parameters.bounds = null;
  result.parameters.at_bound = [null, null, null];
  result.outputs.test_covariance = null;
  result.outputs.units = null;
  result.test_ellipses = null;
  result.iterations = result.iterations.map((entry, i) =>
    i === 3
      ? { index: 3, distance_euclidean: null, parameter_mean: null, output_mean: [null, 0.3, null] }
      : { ...entry, ellipses: undefined, parameter_std: i === 5 ? null : entry.parameter_std },
  );
  result.regression = {
    sensitivity: [
      [0.03, null, 0.01],
      [null, null, null],
      [0.02, 0.01, 0.1],
    ],
    r_squared: [null, 0.9, 0.99],
  };
  result.spearman[1] = [null, null, null];
  result.sample_size = { alpha: null, n_test: 10, n_model: null, curve: null };
  result.identifiability = {
    rank: 2,
    singular_values: [3.1, 0.4, 0],
    unseen_directions: [{ weights: { k1: 0.71, k2: -0.7, k5: 0.04 } }],
  };
  result.parameters.is_population = true;
  result.parameters.estimate = { kind: "population", log_evidence: null };
  result.parameters.correlation_ci95 = [[[1, 1], [null, null], null], null, [null, null, [1, 1]]];
  result.specimens = {
    parameters: [[1.1, null, 0.9], null, [null, null, null]],
    residuals: [[0.4, null, -3.2], [1.1, -0.3, 0.8], null],
  };
  result.outliers = [];
  result.other_solutions = [{ mean: [1.4, null, 0.7], std: null, mean_ci95: null, weight: 0.3 }];
  result.prediction = {
    names: ["f4", "f5"],
    units: null,
    mean: [0.31, null],
    std: [0.01, null],
    interval95: [[0.29, 0.33], null],
    held_out: {
      specimens: null,
      coverage: null,
      joint_coverage: null,
      transforms: [[0.5, null], null],
      scores: [[0, null], null],
      histograms: [{ counts: [0, 0, 1, 0], expected_range: [0, 1] }, null],
      uniformity_p_values: null,
    },
  };
  result.surrogate = {
    kind: null,
    rounds: [{ runs: null, carried_error: [0.1, null], error_at_estimate: null }, null],
  };
  result.rejected_draws = null;
  result.options = null;
  data.clouds = [data.clouds[0], data.clouds[6]];
  data.tests.rows[2][1] = null;
  data.tests.rows[4] = [null, null, null];
  return data;
}

/** As an earlier version wrote it. */
function without_curves(data) {
  const copy = structuredClone(data);
  for (const key of ["estimate", "densities", "correlation", "regions"]) delete copy.result.parameters[key];
  return copy;
}

/** What a sampler of a posterior leaves: no intervals, but quantiles and evidence. */
function as_posterior(data) {
  const { parameters } = data.result;
  const scores = [-1.96, -1, 0, 1, 1.96];
  Object.assign(parameters, {
    is_population: false,
    mean_ci95: null,
    std_ci95: null,
    estimate: { kind: "posterior", log_evidence: -12.34, effective_samples: 412.7, region_probability: 1 - Math.exp(-2) },
    quantiles: {
      probabilities: [0.025, 0.16, 0.5, 0.84, 0.975],
      values: parameters.mean.map((mean, i) => scores.map((z) => mean + z * parameters.std[i])),
    },
  });
  return add_posterior(data, { levels: ["noise:f"] });
}

function write_page(name, data) {
  const json = JSON.stringify(data);
  writeFileSync(path.join(out, `${name}.json`), json);
  writeFileSync(
    path.join(out, `${name}.html`),
    template.replace(place, () => json.replaceAll("<", "\\u003c")),
  );
}

let simulated = null;
/** Its own copy for everyone: what is made of it changes it. */
function case_1() {
  if (!simulated) {
    simulated = update(masses_study({})).data;
    add_curves(simulated.result.parameters);
  }
  return structuredClone(simulated);
}

function population() {
  const data = with_population(case_1(), {
    scales: ["identity", "log", "logit"],
    outliers: [4],
    prediction: prediction_of(["f4", "f5", "<b>mass</b>"], 12),
  });
  data.result.surrogate = {
    kind: "kriging",
    tolerance: 0.1,
    within_tolerance: false,
    rounds: [
      { runs: 30, carried_error: [0.0021, 0.004, 0.011], error_at_estimate: [0.0009, 0.0012, 0.0061] },
      { runs: 40, carried_error: [0.0009, 0.0012, 0.0061], error_at_estimate: [0.0004, 0.0005, 0.0058], scatter_error_at_estimate: [0.01, -0.22, 0.04] },
    ],
  };
  return data;
}

function aeroplane() {
  const data = with_population(with_gaps(update(aeroplane_study()).data), {
    scales: ["identity", "identity", "log"],
    unseen: 4,
    outliers: [17, 60],
    prediction: prediction_of(
      Array.from({ length: 11 }, (_, k) => `f${k + 15}`),
      43,
      { narrow: 0.7 },
    ),
  });
  data.diagnosis = "diagnosis.html"; // beside it
  return with_first_screen(data, { flagged: [3, 7], marks: ["found", "mean-only", "at-bound", "not-seen"] });
}

function refused() {
  const marks = ["doubtful", "at-bound", "not-seen"];
  return with_first_screen(update(refused_study()).data, { flagged: [2], marks });
}

const pages = {
  case1: () => with_first_screen(case_1(), { is_reassuring: true }),
  refused,
  population,
  aeroplane,
  propagate: () => propagate(case_1()),
  sparse: () => sparse(case_1()),
  modes: () => modes_page(20, 10, 8),
  diagnosis: () => diagnosis_page(),
  "linear-diagnosis": () => diagnosis_page({ is_linear: true }),
  shapes: () => ({ ...case_1(), modes: plate_modes(20, 10, 3), mac: plate_mac(3, 3) }),
  posterior: () => as_posterior(case_1()),
  batches: () => with_batches(population()),
  old: () => without_curves(population()),
  empty: () => ({ result: { title: "Nothing but a title" } }),
};

mkdirSync(out, { recursive: true });
const names = process.argv.slice(4);
for (const name of names.length ? names : Object.keys(pages)) write_page(name, pages[name]());
console.log(out);
