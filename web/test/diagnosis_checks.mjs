// What must hold of the page of `mottle diagnose`: the answer first, linear answers marked, twins one line, the model coloured.
import assert from "node:assert/strict";
import { is_number, list } from "./expectations.mjs";
import { saved_by } from "./files.mjs";
import { fits_the_window } from "./window_checks.mjs";

const answer_of = (candidate) => (candidate.fitted ? candidate[candidate.best] : candidate.linear);

/** Names of the lines: those that cannot be told apart stand under the first of them. */
function lines_of({ candidates }) {
  const named = new Set();
  return candidates.filter(({ name, inseparable }) => {
    if (named.has(name)) return false;
    list(inseparable).forEach((other) => named.add(other));
    return true;
  });
}

const drawn_lines = (data) => lines_of(data.result).filter((candidate) => !answer_of(candidate).failure);
const has_model = (data) => list(data.model?.parameters).length > 0;

const cells_of = (page) =>
  page.$$eval('table[data-table="candidates"] tbody tr', (rows) =>
    rows.map((row) => ({
      name: row.dataset.row,
      title: { text: row.children[0].innerText },
      ...Object.fromEntries([...row.children].slice(1).map((cell) => [cell.dataset.key, { text: cell.innerText, value: cell.dataset.value ?? null }])),
    })),
  );

/** Colours of the drawn model: one that is blank, or coloured by nothing, has few. */
const colours_of_model = (page) =>
  page.evaluate(() => {
    const canvas = window.mottle.scenes["explained-model"].picture(300);
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return new Set(Array.from({ length: data.length / 4 }, (_, i) => data.subarray(4 * i, 4 * i + 3).join())).size;
  });

export const diagnosis_checks = [
  [
    "the answer stands first, in one sentence, and a linear one is called so",
    async ({ page, data }) => {
      assert.equal(await page.locator("section").first().getAttribute("id"), "answer");
      assert.equal(await page.locator("#answer .verdict-word").innerText(), data.result.headline);
      const state = await page.locator("#answer [data-answer]").getAttribute("data-answer");
      assert.equal(state === "linear", data.result.stage === "linear");
      assert.deepEqual(await page.locator("#answer .verdict li").allTextContents(), list(data.result.sentences).map((text) => text.replaceAll("`", "")));
      assert.equal(await page.locator("#answer b:not(.plot-title b), h1 *").count(), 0, "names became markup");
    },
  ],
  [
    "candidates that cannot be told apart are one line, and linear answers are marked",
    async ({ page, data }) => {
      const rows = await cells_of(page);
      const lines = drawn_lines(data);
      assert.deepEqual(
        rows.map(({ name }) => name),
        lines.map(({ name }) => name),
      );
      rows.forEach((row, at) => {
        assert.equal(row.is_fitted.text, lines[at].fitted ? "fitted" : "linear");
        for (const other of list(lines[at].inseparable)) assert.ok(row.title.text.includes(other), `${other} is not named`);
      });
    },
  ],
  [
    "the numbers are those of diagnosis.json",
    async ({ page, data }) => {
      const rows = await cells_of(page);
      drawn_lines(data).forEach((candidate, at) => {
        const answer = answer_of(candidate);
        for (const [key, value] of [["gain", answer.gain], ["bic", answer.bic], ["mean", answer.mean]]) {
          if (is_number(value)) assert.equal(Number(rows[at][key].value), value, `${candidate.name}: ${key}`);
        }
      });
    },
  ],
  [
    "an explanation that cannot be says what it would need",
    async ({ page, data }) => {
      const rows = await cells_of(page);
      drawn_lines(data).forEach((candidate, at) =>
        assert.equal(rows[at].title.text.includes("which cannot be"), answer_of(candidate).possible === false, candidate.name),
      );
    },
  ],
  [
    "bars show what each candidate explains",
    async ({ page, data }) => {
      const series = await page.evaluate(() => window.mottle.charts.explained.getOption().series.map(({ data }) => data));
      drawn_lines(data)
        .slice(0, 14)
        .forEach((candidate, at) => {
          const values = series.map((values) => values[at]).filter((value) => value !== null && value !== undefined);
          assert.deepEqual(values, [Math.max(0, answer_of(candidate).gain)], candidate.name);
        });
    },
  ],
  [
    "the model is drawn, coloured by what candidates explain, and marks the elements of the best",
    async ({ page, data }) => {
      if (!has_model(data)) {
        assert.equal(await page.locator('[data-scene="explained-model"]').count(), 0);
        return;
      }
      const state = await page.evaluate(() => {
        const { values, part, structure } = window.mottle.scenes["explained-model"];
        const used = structure.parts.find(({ name }) => name === part?.name);
        return { part: part?.name, largest: Math.max(...values), of_part: Math.max(...[...used.triangles, ...used.edges, ...used.points].map((node) => values[3 * node])) };
      });
      assert.equal(state.part, data.result.candidates[0].name);
      assert.ok(state.largest <= 1 && state.of_part > 0);
      const marked = await colours_of_model(page);
      assert.ok(marked > 20, `${marked} colours`);
      await page.selectOption("#candidate-shown", "-1");
      assert.equal(await page.evaluate(() => window.mottle.scenes["explained-model"].part), null);
      await page.selectOption("#candidate-shown", "0");
    },
  ],
  [
    "residuals stand without and with the best candidate",
    async ({ page, data }) => {
      const before = list(data.result.parameters.residuals);
      const shown = await page.$$eval('table[data-table="residuals"] [data-key="before"]', (cells) => cells.map((cell) => cell.dataset.value ?? null));
      assert.deepEqual(shown.map((value) => (value === null ? null : Number(value))), before);
    },
  ],
  [
    "the lines for the study are those of diagnosis.json",
    async ({ page, data }) => {
      const text = (data.result.proposed_toml ?? "").trim();
      assert.equal(await page.locator("#proposal pre").count(), text ? 1 : 0);
      if (text) assert.equal(await page.locator("#proposal pre").innerText(), text);
    },
  ],
  [
    "every figure has a caption and a text alternative, and tables save as CSV",
    async (study) => {
      const bare = await study.page.evaluate(
        () => [...document.querySelectorAll("figure")].filter((figure) => !figure.querySelector("figcaption").textContent.trim() || !figure.querySelector("[role=img]").getAttribute("aria-label")).length,
      );
      assert.equal(bare, 0);
      for (const { name, bytes } of await saved_by(study, '.table-block [data-export="csv"]'))
        assert.ok(bytes.toString("utf8").split("\r\n").length > 2, name);
    },
  ],
  fits_the_window,
];
