// What must hold of the page of `mottle compare`: it shows the numbers of the results that it was made from.
import assert from "node:assert/strict";
import path from "node:path";
import { fits_the_window } from "./window_checks.mjs";

/** {row name: {column key: value}} of a table. */
const cells_of = (page, id) =>
  page.$$eval(`table[data-table="${id}"] tbody tr`, (rows) =>
    Object.fromEntries(
      rows.map((row) => [
        row.dataset.row.replace(/ \(.*\)$/, ""),
        Object.fromEntries([...row.children].map((cell) => [cell.dataset.key, cell.dataset.value ?? cell.textContent])),
      ]),
    ),
  );

export const compare_checks = [
  [
    "a row for each run with its verdict",
    async ({ page, results }) => {
      const rows = Object.values(await cells_of(page, "runs"));
      assert.deepEqual(rows.map((row) => row.method), results.map((result) => result.method));
      rows.forEach((row, at) => assert.ok(row.verdict.startsWith(results[at].verdict.conclusion)));
    },
  ],
  [
    "means and standard deviations are those of result.json, up to the unit",
    async ({ page, results }) => {
      const rows = await cells_of(page, "parameters");
      for (const [at, { parameters }] of results.entries()) {
        parameters.names.forEach((name, k) => {
          const factor = Number(rows[name][`estimate${at}`]) / parameters.mean[k];
          assert.ok(Math.abs(Math.log10(factor) % 1) < 1e-9 || Math.abs(Math.abs(Math.log10(factor) % 1) - 1) < 1e-9, name);
          if (parameters.std[k] !== null)
            assert.ok(Math.abs(Number(rows[name][`std${at}`]) / (factor * parameters.std[k]) - 1) < 1e-12, name);
        });
      }
    },
  ],
  [
    "errors of outputs are those of result.json",
    async ({ page, results }) => {
      const rows = await cells_of(page, "outputs");
      for (const [at, { agreement }] of results.entries()) {
        for (const output of agreement.outputs) {
          assert.equal(Number(rows[output.name][`after${at}`]), output.final.mean_error);
          assert.equal(Number(rows[output.name][`scatter${at}`]), output.final.std_ratio);
        }
      }
    },
  ],
  [
    "evidences of the same tests are compared, and results without one are named",
    async ({ page, folders, results }) => {
      const with_evidence = folders.filter((_, at) => results[at].evidence);
      const rows = await cells_of(page, "evidence").catch(() => ({}));
      assert.equal(Object.keys(rows).length, with_evidence.length > 1 ? with_evidence.length : 0);
      const logs = results.flatMap(({ evidence }) => (evidence ? [evidence.ln_evidence] : []));
      const best = Math.max(...logs);
      Object.values(rows).forEach((row, at) => {
        assert.equal(Number(row.ln_evidence), logs[at]);
        assert.ok(Math.abs(Number(row.ln_bayes_factor) - (best - logs[at])) < 1e-12);
        const probability = Math.exp(logs[at] - best) / logs.reduce((sum, log) => sum + Math.exp(log - best), 0);
        assert.ok(Math.abs(Number(row.probability) - probability) < 1e-12);
      });
      const named = await page.locator("#evidence li").allInnerTexts();
      for (const [at, { evidence, method }] of results.entries()) {
        if (evidence || !with_evidence.length) continue;
        assert.ok(named.some((text) => text.includes(`${path.basename(folders[at])} is not compared: method '${method}'`)), named.join());
      }
    },
  ],
  [
    "every run has a bar for each of its parameters, on an axis that the runs share",
    async ({ page, results }) => {
      const bars = await page.$$eval(".compared", (blocks) =>
        blocks.map((block) => ({
          name: block.dataset.parameter,
          tracks: [...block.querySelectorAll(".bar-track")].map((track) => {
            const { left, width: wide } = track.getBoundingClientRect();
            return [left, wide];
          }),
        })),
      );
      for (const { name, tracks } of bars) {
        assert.equal(tracks.length, results.filter(({ parameters }) => parameters.names.includes(name)).length);
        assert.ok(tracks.every(([left, wide]) => left === tracks[0][0] && wide === tracks[0][1] && wide > 100), name);
      }
    },
  ],
  fits_the_window,
  [
    "each run's own report is linked",
    async ({ page, folders }) => {
      const links = await page.$$eval('table[data-table="runs"] a', (all) => all.map((one) => one.href));
      links.forEach((link, at) => assert.equal(new URL(link).pathname, path.resolve(folders[at], "report.html")));
      assert.equal(links.length, folders.length);
    },
  ],
];
