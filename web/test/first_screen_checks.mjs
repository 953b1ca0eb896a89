// What must hold of the first screen: it never looks better than the result, nothing is cut off, and it prints on two pages.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import path from "node:path";
import { in_readable_units, shown_unit } from "../src/units.js";
import { answer_of, is_modes, list, result_of } from "./expectations.mjs";

const is_update = (data) =>
  !is_modes(data) && (result_of(data).command ?? "update") === "update" && Boolean(data.result.parameters);
const largest_page = 3e6; // bytes

export const first_screen_checks = [
  [
    "a diagnosis in the same folder is linked, and nothing that is not there",
    async ({ page, data, file }) => {
      const links = await page.$$eval("[data-link=diagnosis]", (all) => all.map((one) => one.href));
      assert.equal(links.length, is_update(data) && data.diagnosis ? 1 : 0);
      for (const link of links) assert.equal(new URL(link).pathname, path.join(path.dirname(path.resolve(file)), data.diagnosis));
    },
  ],
  [
    "the conclusion is green only where the result is reassuring",
    async ({ page, data }) => {
      if (!is_update(data)) return;
      const { verdict, agreement } = result_of(data);
      const tone = await page.locator("#conclusion .verdict").getAttribute("class");
      const is_reproduced = agreement?.are_means_reproduced !== false && agreement?.is_scatter_reproduced !== false;
      const is_adequate = verdict?.conclusion === "adequate" || verdict?.adequate === true;
      assert.equal(/good/.test(tone), is_adequate && is_reproduced && verdict.is_reassuring !== false);
      if (!is_reproduced && !is_adequate) assert.match(tone, /bad/);
      if (verdict?.headline) assert.ok((await page.locator(".headline").innerText()).includes(verdict.headline));
      assert.equal(await page.locator("header .badge.good").count(), 0, "a green badge says nothing of the model");
    },
  ],
  [
    "every cause of the verdict is said under it, a test that refused the model with a cross",
    async ({ page, data }) => {
      const causes = list(result_of(data).verdict?.causes);
      if (!is_update(data)) return;
      const shown = page.locator("#conclusion [data-cause]");
      assert.equal(await shown.count(), causes.length);
      for (const [i, { kind, sentence }] of causes.entries()) {
        const text = await shown.nth(i).innerText();
        assert.ok(text.includes(sentence));
        assert.equal(text.includes("✗"), ["means", "scatter", "bounds", "prior-shift", "cover"].includes(kind));
      }
    },
  ],
  [
    "outputs stand with their errors, the worst first, and what is not reproduced is marked in words and signs",
    async ({ page, data }) => {
      const rows = list(result_of(data).agreement?.outputs);
      if (!rows.length) return;
      if (answer_of(result_of(data)) === "box") {
        assert.equal(await page.locator('[data-table="agreement"]').count(), 0, "a box has no mean and no scatter");
        return;
      }
      const table = page.locator('[data-table="agreement"]');
      const shown = await table.locator("tbody tr").evaluateAll((all) => all.map((row) => row.dataset.row));
      assert.deepEqual(
        shown,
        rows.slice(0, 8).map(({ name }) => name),
      );
      for (const [i, row] of rows.slice(0, 8).entries()) {
        const cell = table.locator("tbody tr").nth(i).locator('[data-key="s1"]');
        assert.equal((await cell.innerText()).includes("✗"), row.is_scatter_reproduced === false);
      }
      const region = result_of(data).agreement.region;
      if (region)
        assert.ok(
          (await page.locator('[data-field="inside"]').innerText()).includes(
            `${region.final_inside} of ${region.tests} tests`,
          ),
        );
    },
  ],
  [
    "every parameter has a bar with its mark, and nothing of it lies outside of its axis",
    async ({ page, data }) => {
      const findings = list(result_of(data).parameters?.findings);
      if (!is_update(data) || !findings.length) return;
      const shown = await page.locator("[data-parameter]").evaluateAll((all) =>
        all.map((bar) => ({
          name: bar.dataset.parameter,
          mark: bar.querySelector("[data-mark]")?.dataset.mark ?? null,
        })),
      );
      const names = result_of(data).parameters.names;
      assert.deepEqual(
        new Map(shown.map(({ name, mark }) => [name, mark])),
        new Map(shown.map(({ name }) => [name, findings[names.indexOf(name)].mark])),
      );
      assert.equal(shown.length, names.length);
      const is_adequate = result_of(data).verdict?.conclusion === "adequate";
      if (!is_adequate)
        assert.equal(await page.locator("[data-mark].good").count(), 0, "green in a model that is not adequate");
      const places = await page
        .locator(".bar-track > span")
        .evaluateAll((all) =>
          all.flatMap(({ style }) => [parseFloat(style.left), parseFloat(style.left) + (parseFloat(style.width) || 0)]),
        );
      assert.ok(places.every((place) => place > -0.01 && place < 100.01));
    },
  ],
  [
    "the next command is shown as it is to be typed",
    async ({ page, data }) => {
      const next = list(result_of(data).verdict?.next ?? result_of(data).next).filter(({ command }) => command);
      assert.deepEqual(
        await page.locator(".next-step > code").allInnerTexts(),
        next.map(({ command }) => command),
      );
    },
  ],
  [
    "notes are folded away",
    async ({ page, data }) => {
      if (!list(result_of(data).notes).length || !is_update(data)) return;
      assert.equal(await page.locator("details.notes").getAttribute("open"), null);
    },
  ],
  [
    "to print, every drawing takes the width of the paper, and that of its place afterwards",
    async ({ page, is_due }) => {
      if (!is_due("printing from the screen")) return;
      // In one task of the page: with no paper about, the next frame would fit the drawings to the screen again.
      const [on_screen, on_paper, afterwards] = await page.evaluate(() =>
        ["", "beforeprint", "afterprint"].map((name) => {
          if (name) window.dispatchEvent(new Event(name));
          return Object.values(window.mottle.charts).map((chart) => chart.getWidth());
        }),
      );
      // A line of the paper, or of the summary's at its zoom of 0.42.
      const wanted = await page.evaluate(() =>
        Object.values(window.mottle.charts).map((chart) => (chart.getDom().closest(".in-print") ? 1560 : 660)),
      );
      assert.deepEqual(on_paper, wanted);
      assert.deepEqual(afterwards, on_screen);
    },
  ],
  [
    "the page has 3 MB at most",
    async ({ file, data }) => {
      if (path.basename(file) !== "report.html") return; // fixtures hold every sample
      assert.ok(statSync(file).size <= largest_page, `${statSync(file).size} bytes`);
    },
  ],
  [
    "the units of the study can be chosen",
    async ({ page, data }) => {
      if (!(await page.locator('[data-action="units"]').count())) return;
      const shown = () => page.locator('[data-table="parameters"] tbody td[data-key="unit"]').allInnerTexts();
      const choose = async () => {
        await Promise.all([page.waitForEvent("load"), page.click('[data-action="units"]')]);
        await page.waitForSelector("html[data-ready=true]", { state: "attached" });
      };
      const readable = await shown();
      assert.deepEqual(readable, data.result.parameters.units);
      await choose();
      assert.notDeepEqual(await shown(), readable);
      await choose();
      assert.deepEqual(await shown(), readable);
    },
  ],
  [
    "units are converted with all that is said in them",
    async () => {
      assert.deepEqual(shown_unit("Pa", 7e10), { unit: "GPa", factor: 1e-9 });
      assert.deepEqual(shown_unit("N/m", 2), { unit: "N/m", factor: 1 });
      const result = {
        parameters: {
          names: ["E"],
          units: ["Pa"],
          prior_mean: [7e10],
          covariance: [[4e18]],
          bounds: [[6e10, null]],
          densities: [{ prior: { x: [7e10], density: [1e-9] } }],
        },
        regression: { sensitivity: [[2e-9]] },
      };
      const shown = in_readable_units({ result, clouds: [{ parameters: [[7.1e10]], outputs: [[3]] }] });
      const near = (value, expected) => assert.ok(Math.abs(value / expected - 1) < 1e-12, `${value} for ${expected}`);
      near(shown.result.parameters.prior_mean[0], 70);
      near(shown.result.parameters.covariance[0][0], 4);
      near(shown.result.parameters.bounds[0][0], 60);
      near(shown.result.parameters.densities[0].prior.density[0], 1);
      near(shown.result.regression.sensitivity[0][0], 2);
      near(shown.clouds[0].parameters[0][0], 71);
      assert.deepEqual(shown.clouds[0].outputs, [[3]]);
      assert.equal(shown.result.parameters.bounds[0][1], null);
    },
  ],
];
