// A diagnosis of a plate with a mast, as the page gets it: fitted and linear answers, twins, and one that cannot be.
import { plate_modes } from "./structure_fixture.mjs";

const base64 = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString("base64");

const answer = (gain, more = {}) => ({
  gain,
  bic: 2.3 - 2 * gain,
  p_value: Math.exp(-gain),
  adjusted_p_value: Math.min(1, 8 * Math.exp(-gain)),
  mean: 1.4,
  std: 0,
  needed: null,
  possible: true,
  within_bounds: true,
  converged: true,
  ...more,
});

function candidate(name, linear, fitted, more = {}) {
  const failure = { failure: "less increase of the log-likelihood in the linear models" };
  return {
    name,
    nominal: 1,
    scale: 0.2,
    visibility: 4.2,
    own_share: 0.6,
    variance_inflation: 2.8,
    targets: [`spring:${name}`],
    bic: fitted ? fitted.bic : null,
    best: "shifted",
    linear: { ...linear, kind: "shifted" },
    fitted: Boolean(fitted),
    shifted: fitted ?? failure,
    freed: fitted ? { ...fitted, gain: fitted.gain + 0.1, bic: fitted.bic + 2, std: 0.02 } : failure,
    screened_out: !fitted,
    inseparable: [],
    residuals: [0.4, -0.2, null],
    ...more,
  };
}

export function diagnosis_page({ is_linear = false } = {}) {
  const fit = (gain, more) => (is_linear ? null : answer(gain, more));
  const model = plate_modes(12, 6, 1);
  const at = (from, to) => base64(cut(model.triangles, from, to));
  model.list = [];
  model.parameters = [
    { name: "<b>skin</b>", triangles: at(0, 60), edges: "", points: [] },
    { name: "rib", triangles: at(120, 180), edges: "", points: [] },
    { name: "joint", triangles: "", edges: "", points: [20] },
    { name: "accelerometer", triangles: "", edges: "", points: model.points },
  ];
  const candidates = [
    candidate("<b>skin</b>", answer(41.2), fit(43.7), { inseparable: ["rib"] }),
    candidate("joint", answer(9.1), fit(8.4)),
    candidate("accelerometer", answer(12.5, { needed: -0.01, possible: false }), fit(12.9, { needed: -0.01, possible: false, mean: 1e-6 })),
    candidate("rib", answer(40.8), null, { inseparable: ["<b>skin</b>"] }),
    candidate("mast", answer(0.3), null),
    candidate("paint", { failure: "no effect on any output" }, null),
  ];
  return {
    kind: "diagnosis",
    result: {
      schema: 1,
      mottle: "0.1.0",
      title: "Plate with a mast </script>",
      command: "diagnose",
      stage: is_linear ? "linear" : "fitted",
      level: 0.05,
      headline: `${is_linear ? "Linear answer: " : ""}<b>skin</b> and rib explain the tests equally well; best by a small margin is <b>skin</b>, changed from 1 to 1.4.`,
      explained: true,
      best: "<b>skin</b>",
      alike: ["<b>skin</b>", "rib"],
      sentences: ["accelerometer would need -0.01, which cannot be.", "rib <i>and</i> joint.", "3 of 6 candidates were compared in the linear model only."],
      parameters: { names: ["k1", "k2"], residuals: [5.1, -3.3, null] },
      outputs: { names: ["f1", "f2", "u<3>"] },
      candidates,
      proposed_toml: is_linear ? "" : '\n[[parameter]]\nname = "skin"\n',
      model_evaluations: 1234,
      timings_s: { total: 12.3 },
    },
    model,
  };
}

/** Some of the indices of an array in base64. */
function cut(text, from, to) {
  const bytes = Buffer.from(text, "base64");
  return new Uint32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)).slice(from, to);
}
