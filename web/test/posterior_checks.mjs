// What must hold of the sections on a sampled posterior: chains, stages, evidence, modes, predictions, pairs.
import assert from "node:assert/strict";
import { expected_plots, is_number, list, result_of, series_of } from "./expectations.mjs";

const has_plot = (data, id) => expected_plots(data).includes(id);
const rows_of = (page, table) =>
  page.locator(`[data-table="${table}"] tbody tr`).evaluateAll((rows) =>
    rows.map((row) => ({
      ...Object.fromEntries(
        [...row.children].map((cell) => [
          cell.dataset.key,
          { value: Number(cell.dataset.value), is_flagged: cell.classList.contains("flag") },
        ]),
      ),
      name: row.dataset.row,
    })),
  );

export const posterior_checks = [
  [
    "the table of chains holds R-hat and effective sample sizes of every quantity, and sets off what is not good",
    async ({ page, data }) => {
      const { posterior } = result_of(data);
      const rows = await rows_of(page, "posterior-chains");
      const names = list(posterior?.names);
      assert.deepEqual(rows.map((row) => row.name), names.map((name) => name.replaceAll("_", "-")));
      rows.forEach((row, k) => {
        if (!is_number(posterior.r_hat[k])) return;
        assert.equal(row.r_hat.value, posterior.r_hat[k]);
        assert.equal(row.r_hat.is_flagged, posterior.r_hat[k] > 1.01);
        assert.equal(row.ess_bulk.value, posterior.ess_bulk[k]);
        assert.equal(row.ess_tail.is_flagged, posterior.ess_tail[k] < 400);
      });
    },
  ],
  [
    "ranks, stages and evidences are drawn of every island",
    async ({ page, data }) => {
      const { posterior, evidence } = result_of(data);
      if (!has_plot(data, "posterior-ranks")) return;
      const shown = posterior.names.slice(0, 9);
      const ranks = (await series_of(page, "posterior-ranks")).filter(({ name }) => name.startsWith("Island"));
      assert.equal(ranks.length, shown.length * posterior.chains);
      ranks.forEach(({ data: points }, at) => {
        const [name, chain] = [Math.floor(at / posterior.chains), at % posterior.chains];
        assert.deepEqual(points.map(([, count]) => count), posterior.ranks.counts[name][chain]);
      });
      const exponents = (await series_of(page, "posterior-stages")).slice(0, posterior.chains);
      exponents.forEach(({ data: points }, chain) =>
        assert.deepEqual(points.map(([, value]) => value), posterior.stages[chain].map(({ exponent }) => exponent).filter((value) => value > 0)),
      );
      const drawn = await series_of(page, "posterior-evidence");
      const islands = drawn.find(({ name }) => name === "Island");
      assert.equal(drawn.some(({ name }) => name === "By importance sampling"), evidence.source === "importance-sampling");
      assert.deepEqual(islands.data.map(([value]) => value), evidence.islands);
    },
  ],
  [
    "separate modes stand with their probability",
    async ({ page, data }) => {
      const modes = list(result_of(data).modes);
      const rows = await rows_of(page, "posterior-modes");
      assert.equal(rows.length, modes.length > 1 ? modes.length : 0);
      rows.forEach((row, k) => assert.equal(row.probability.value, modes[k].probability));
    },
  ],
  [
    "every specimen lies on the bars of further tests, those outside as triangles",
    async ({ page, data }) => {
      if (!has_plot(data, "posterior-predictive")) return;
      const { posterior, outputs } = result_of(data);
      const { columns, rows } = data.tests;
      const series = await series_of(page, "posterior-predictive");
      const drawn = (name) => series.find((one) => one.name === name).data.length;
      let [inside, outside] = [0, 0];
      outputs.names.forEach((name, k) => {
        const [low, , , , high] = posterior.predictive.tests[k];
        for (const row of rows) {
          const value = row[columns.indexOf(name)];
          if (is_number(value)) value >= low && value <= high ? (inside += 1) : (outside += 1);
        }
      });
      assert.deepEqual([drawn("Specimen"), drawn("Specimen outside")], [inside, outside]);
    },
  ],
  [
    "leave-one-out sets off specimens of too much influence, or says why there is none",
    async ({ page, data }) => {
      const { posterior } = result_of(data);
      const shapes = list(posterior?.leave_one_out?.pareto_k).slice(0, 15);
      const flagged = (await rows_of(page, "leave-one-out")).filter((row) => row.shape.is_flagged).length;
      if (list(posterior?.leave_one_out?.pareto_k).length <= 15)
        assert.equal(flagged, shapes.filter((shape) => shape === null || shape > 0.7).length);
      if (posterior?.not_left_out && has_plot(data, "posterior-predictive"))
        assert.ok((await page.locator("#posterior-predictive").innerText()).includes(posterior.not_left_out));
    },
  ],
  [
    "pairs show the prior's draws behind those of the posterior, within the panel",
    async ({ page, data }) => {
      if (!has_plot(data, "posterior-pairs")) return;
      const series = await series_of(page, "posterior-pairs");
      const draws = series.filter(({ name }) => name === "Posterior, draws");
      const shown = Math.min(3, result_of(data).parameters.names.length);
      assert.equal(draws.length, (shown * (shown - 1)) / 2);
      const last = list(data.clouds).at(-1).parameters.length;
      for (const { data: points } of draws) assert.equal(points.length, last);
      assert.ok(series.filter(({ name }) => name === "Prior, draws").some(({ data: points }) => points.length > 0));
    },
  ],
];
