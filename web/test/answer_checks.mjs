// What must hold of the first screen of each kind of method: its own answer stands there, in words and in one figure.
import assert from "node:assert/strict";
import { resize } from "./browser.mjs";
import { answer_of, is_number, list, result_of, series_of } from "./expectations.mjs";

const figure_of = { batches: "batches", box: "cover", posterior: "densities" };
const desk = { width: 1280, height: 800 };
const seen_at_least = 200; // px of the drawing, above the fold

export const answer_checks = [
  [
    "a method with an answer of its own shows it first: its sentence under the verdict, its figure above the fold",
    async ({ page, data }) => {
      const kind = answer_of(result_of(data));
      const answer = page.locator("#conclusion [data-answer]");
      assert.equal(await answer.count(), kind ? 1 : 0);
      if (!kind) return;
      assert.equal(await answer.getAttribute("data-answer"), kind);
      const { verdict, parameters } = result_of(data);
      if (verdict?.answer) assert.equal(await page.locator("#conclusion .answer").innerText(), verdict.answer);
      if (kind === "posterior" && !Array.isArray(parameters?.densities)) return; // an earlier version's
      assert.deepEqual(
        await answer.locator("[data-plot]").evaluateAll((all) => all.map((node) => node.dataset.plot)),
        [figure_of[kind]],
      );
      const before = page.viewportSize();
      await resize(page, desk.width, desk.height);
      await page.evaluate(() => window.scrollTo(0, 0));
      const { y } = await page.locator(`[data-plot="${figure_of[kind]}"] .plot-area`).boundingBox();
      await resize(page, before.width, before.height);
      assert.ok(y + seen_at_least <= desk.height, `the figure begins at ${Math.round(y)} pixels`);
    },
  ],
  [
    "an axis that has a name has numbers, and a parameter's bar stands between those of its ends",
    async ({ page }) => {
      const bare = await page.evaluate(() =>
        Object.entries(window.mottle.charts).flatMap(([id, chart]) => {
          const { xAxis = [], yAxis = [] } = chart.getOption();
          return [...xAxis, ...yAxis].filter(({ name, axisLabel }) => name && axisLabel?.show === false).map(({ name }) => `${id}: ${name}`);
        }),
      );
      assert.deepEqual(bare, []);
      const ends = await page
        .locator("#conclusion .bar-scale")
        .evaluateAll((all) => all.map((bar) => [...bar.querySelectorAll(".bar-end")].map(({ textContent }) => textContent)));
      assert.equal(ends.length, await page.locator("#conclusion .bar-track").count());
      for (const pair of ends) assert.ok(pair.length === 2 && pair.every((text) => /\d/.test(text)), pair.join(" to "));
    },
  ],
  [
    "nothing of a box or a posterior is called an iteration, and a box has no mean and no 95 % interval",
    async ({ page, data }) => {
      const { parameters, posterior, command } = result_of(data);
      const kind = parameters?.estimate?.kind;
      if (command === "propagate" || !(["box", "posterior"].includes(kind) || posterior?.names)) return;
      const terms = await page.locator("header .facts dt").allInnerTexts();
      assert.ok(!terms.includes("Iterations"));
      assert.equal(await page.locator("#convergence, #output-history, #parameter-history, #iteration").count(), 0);
      const titles = await page.evaluate(() =>
        Object.values(window.mottle.charts).flatMap((chart) => (chart.getOption().title ?? []).map(({ text }) => text)),
      );
      assert.deepEqual(titles.filter((text) => /^Iteration/.test(text)), []);
      if (kind !== "box") return;
      assert.doesNotMatch(await page.locator("#conclusion .first-screen").first().innerText(), /mean|95 % interval|middle of the box/);
      const values = await page.locator("#conclusion .bar-value").allInnerTexts();
      for (const text of values) assert.match(text, /^\S+ … \S+/);
    },
  ],
  [
    "every specimen is drawn in its batch, the table has a row a batch, and doubtful ones stand with their probability",
    async ({ page, data }) => {
      const { components, assignments, specimens } = result_of(data);
      if (!list(components).length) return;
      const outliers = list(assignments).filter(({ component }) => !is_number(component));
      const rows = page.locator('[data-table="batches"] tbody tr');
      assert.equal(await rows.count(), components.length + (outliers.length ? 1 : 0));
      const drawn = await series_of(page, "batches");
      if (list(specimens?.parameters).length) {
        for (const k of components.keys()) {
          const members = assignments.filter(({ component }) => component === k + 1).map(({ specimen }) => specimen);
          assert.deepEqual(drawn.find(({ name }) => name === `Batch ${k + 1}`).data.map(([, , number]) => number), members);
        }
        assert.deepEqual(drawn.find(({ name }) => name === "Outlier").data.map(([, , number]) => number), outliers.map(({ specimen }) => specimen));
      }
      for (const { specimen, component, probabilities } of list(assignments)) {
        if (!is_number(component) || probabilities[component - 1] >= 0.9) continue;
        assert.match(await rows.nth(component - 1).innerText(), new RegExp(`${specimen} \\(${Math.round(100 * probabilities[component - 1])}\\s%\\)`));
      }
    },
  ],
  [
    "outputs that the box does not cover stand first with a cross, and tests outside its range as triangles",
    async ({ page, data }) => {
      const { parameters, interval, outputs } = result_of(data);
      if (parameters?.estimate?.kind !== "box") return;
      const image = list(interval.image);
      const labels = await page.evaluate(() => window.mottle.charts.cover.getOption().yAxis[0].data);
      const bad = image.filter(({ covered }) => !covered).map(({ output }) => output);
      assert.deepEqual(labels.map((text) => text.startsWith("✗")), labels.map((_, k) => k < bad.length));
      bad.slice(0, 8).forEach((name, k) => assert.ok(labels[k].startsWith(`✗ ${name}`), labels[k]));
      if (image.length > 8) return;
      const { columns, rows } = data.tests;
      const outside = image.flatMap(({ image: [low, high] }, k) =>
        rows.map((row) => row[columns.indexOf(outputs.names[k])]).filter((value) => is_number(value) && (value < low || value > high)),
      );
      const drawn = await series_of(page, "cover");
      assert.equal(drawn.find(({ name }) => name === "Test outside that range").data.length, outside.length);
    },
  ],
];
