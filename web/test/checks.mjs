// What must hold of every report. Each check is a sentence and a function that throws where it does not hold.
import assert from "node:assert/strict";
import {
  list,
  has_numbers,
  is_modes,
  result_of,
  expected_plots,
  drawn_colours,
  series_of,
  close_to_data,
} from "./expectations.mjs";
import { saved_by } from "./files.mjs";

function is_picture(name, bytes) {
  assert.equal(bytes.subarray(1, 4).toString(), "PNG", name);
  assert.ok(bytes.length > 5000, `${name} holds ${bytes.length} bytes`);
}

function is_drawing(name, bytes) {
  const svg = bytes.toString("utf8");
  assert.match(svg, /^<svg[^>]*xmlns="http:\/\/www.w3.org\/2000\/svg"/, name);
  assert.ok(svg.split("<path").length > 5, `${name} is blank`);
}

const conclusion_of = (verdict) => {
  const { conclusion, adequate } = verdict ?? {};
  return conclusion ?? (adequate === true ? "adequate" : adequate === false ? "inadequate" : "none");
};

export const checks = [
  [
    "the title is shown as text, whatever it holds",
    async ({ page, data }) => {
      assert.equal(
        await page.locator("h1").innerText(),
        (result_of(data).title ?? "").trim() || (is_modes(data) ? "Mode shapes" : "Untitled study"),
      );
      assert.equal(await page.locator("h1 *").count(), 0);
    },
  ],
  [
    "the conclusion stands first and says what the data say; pages of mode shapes and of propagate have none",
    async ({ page, data }) => {
      if (is_modes(data)) {
        assert.equal(await page.locator("[data-verdict], #run").count(), 0);
        return;
      }
      if (result_of(data).command === "propagate") {
        assert.equal(await page.locator("section").first().getAttribute("id"), "propagated");
        assert.equal(await page.locator("[data-verdict], #conclusion, #verdict-section").count(), 0);
        return;
      }
      assert.equal(await page.locator("section").first().getAttribute("id"), "conclusion");
      assert.equal(
        await page.locator("[data-verdict]").getAttribute("data-verdict"),
        conclusion_of(result_of(data).verdict),
      );
      const signs = { adequate: "✓", inadequate: "✗", undecided: "?", none: "–" };
      assert.equal(await page.locator(".verdict .sign").innerText(), signs[conclusion_of(result_of(data).verdict)]);
      assert.equal(
        await page.locator('[data-table="verdict"] tbody tr').count(),
        list(result_of(data).verdict?.tests).length,
      );
    },
  ],
  [
    "what was not tested, and what could hide, is listed as the data list it",
    async ({ page, data }) => {
      const { not_tested, could_hide } = result_of(data)?.verdict ?? {};
      assert.deepEqual(
        await page.locator("#verdict-section .not-tested > li").allInnerTexts(),
        list(not_tested).map((text) => text.replaceAll("`", "")),
      );
      assert.equal(await page.locator(".not-tested b").count(), 0);
      const names = await page.locator('[data-table="could-hide"] tbody th').allTextContents();
      assert.deepEqual(
        names,
        list(could_hide).map(({ name }) => name),
      );
    },
  ],
  [
    "a deviation that is not the scatter of specimens is not called so",
    async ({ page, data }) => {
      const { command, parameters = {} } = result_of(data);
      if (command === "propagate" || !has_numbers(parameters.std)) return;
      const heads = await page.locator('[data-table="parameters"] thead').innerText();
      if (parameters.estimate?.kind === "box") {
        assert.match(heads, /Box/);
        assert.equal((heads.match(/Std\. dev\./g) ?? []).length, 1, "that of the prior");
        return;
      }
      assert.equal(/of the mean|Posterior/.test(heads), parameters.is_population === false);
    },
  ],
  [
    "every plot that the data call for is there, and no other",
    async ({ page, data }) => {
      assert.deepEqual(await page.evaluate(() => Object.keys(window.mottle.charts)), expected_plots(data));
      assert.deepEqual(
        await page.evaluate(() => [...document.querySelectorAll("[data-plot]")].map((node) => node.dataset.plot)),
        expected_plots(data),
      );
    },
  ],
  [
    "every plot is drawn and holds data",
    async ({ page, data }) => {
      for (const id of expected_plots(data)) {
        assert.ok((await drawn_colours(page, id)) > 5, `${id} is blank`);
        assert.ok(
          (await series_of(page, id)).some((series) => series.data.length > 0),
          `${id} has no data`,
        );
        assert.equal(await page.locator(`[data-plot="${id}"] .plot-area`).getAttribute("data-drawn"), "true");
      }
    },
  ],
  [
    "every figure has a caption and a text alternative",
    async ({ page }) => {
      const bare = await page.evaluate(
        () =>
          [...document.querySelectorAll("figure")].filter(
            (figure) =>
              !figure.querySelector("figcaption").textContent.trim() ||
              !figure.querySelector("[role=img]").getAttribute("aria-label"),
          ).length,
      );
      assert.equal(bare, 0);
    },
  ],
  [
    "the tables show the numbers of the result",
    async ({ page, data }) => {
      const { parameters = {}, outputs = {} } = result_of(data);
      const names = list(parameters.names);
      const estimated = parameters.estimate?.kind === "box" ? [] : ["mean", "std"]; // a box has its ends alone
      for (const key of ["prior_mean", "prior_std", ...estimated]) {
        if (has_numbers(parameters[key]))
          await close_to_data(
            page,
            "parameters",
            key,
            names,
            names.map((_, i) => parameters[key][i]),
          );
      }
      const output_names = list(outputs.names);
      for (const key of ["test_mean", "initial_mean", "final_mean"]) {
        if (has_numbers(outputs[key]))
          await close_to_data(
            page,
            "outputs",
            key,
            output_names,
            output_names.map((_, i) => outputs[key][i]),
          );
      }
    },
  ],
  [
    "a parameter on its bound is flagged",
    async ({ page, data }) => {
      const flagged = list(result_of(data).parameters?.at_bound).filter(Boolean).length;
      assert.equal(await page.locator('[data-table="parameters"] [data-key="at_bound"].flag').count(), flagged);
    },
  ],
  [
    "the distance can be read on a logarithmic axis",
    async ({ page, data }) => {
      if (!expected_plots(data).includes("distance")) return;
      const axis_type = () => page.evaluate(() => window.mottle.charts.distance.getOption().yAxis[0].type);
      await page.check("#distance-log");
      assert.equal(await axis_type(), "log");
      await page.uncheck("#distance-log");
      assert.equal(await axis_type(), "value");
    },
  ],
  [
    "the slider moves cloud and ellipse, also by keyboard",
    async ({ page, data, shot }) => {
      if (!expected_plots(data).includes("scatter-outputs")) return;
      const state = async () =>
        JSON.stringify((await series_of(page, "scatter-outputs")).filter(({ name }) => name.startsWith("Model")));
      const range = page.locator("#iteration");
      const last = await range.inputValue();
      const at_end = await state();
      await range.focus();
      await page.keyboard.press("Home");
      assert.equal(await range.inputValue(), "0");
      const at_start = await state();
      assert.notEqual(at_start, at_end, "cloud and ellipse stayed");
      assert.ok((await page.locator(".reading").innerText()).startsWith("Iteration "), "no reading");
      await shot("first");
      await page.keyboard.press("ArrowRight");
      assert.equal(await range.inputValue(), "1");
      await page.keyboard.press("End");
      assert.equal(await range.inputValue(), last);
      assert.equal(await state(), at_end);
    },
  ],
  [
    "play walks through the iterations and can be stopped",
    async ({ page, data, is_due }) => {
      if (!expected_plots(data).includes("scatter-outputs") || !is_due("playing")) return;
      // Stopped within the step that reaches the second iteration: on a busy machine the walk goes on between two commands.
      const stopping = page.evaluate(
        () =>
          new Promise((resolve) => {
            const slider = document.querySelector("#iteration");
            new MutationObserver((_, observer) => {
              if (Number(slider.value) < 1) return;
              observer.disconnect();
              if (Number(slider.value) < Number(slider.max)) document.querySelector("#play").click();
              resolve(slider.value);
            }).observe(document.querySelector(".reading"), { childList: true });
          }),
      );
      await page.click("#play");
      const stopped = await stopping;
      assert.equal(stopped, "1");
      await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 200))); // more than two steps of the walk
      assert.equal(await page.locator("#iteration").inputValue(), stopped);
      await page.locator("#iteration").focus();
      await page.keyboard.press("End");
    },
  ],
  [
    "axes can be chosen where there are too many for all pairs",
    async ({ page, data }) => {
      const boxes = page.locator("#figure-scatter-first-last .chip input");
      if (!(await boxes.count())) return;
      const grids = () => page.evaluate(() => window.mottle.charts["scatter-first-last"].getOption().grid.length);
      const before = await grids();
      await boxes.nth(3).check();
      assert.ok((await grids()) > before);
      if ((await boxes.count()) > 4) {
        await boxes.nth(4).click();
        assert.equal(await boxes.nth(4).isChecked(), false, "more axes than the limit");
      }
      await boxes.nth(3).uncheck();
      assert.equal(await grids(), before);
    },
  ],
  [
    "zooming in and Reset change and restore a plot",
    async ({ page, data, is_due }) => {
      const plots = expected_plots(data).filter((plot, k) => k === 0 || plot === "scatter-outputs");
      for (const id of plots.filter((plot) => is_due(`zooming ${plot}`))) {
        const zoomed = () =>
          page.evaluate(
            (plot) => window.mottle.charts[plot].getModel().option.dataZoom?.some(({ start, end }) => end - start < 99),
            id,
          );
        if ((await page.evaluate((plot) => window.mottle.charts[plot].getModel().option.dataZoom?.length ?? 0, id)) === 0)
          continue;
        await page.click(`[data-plot="${id}"] .tools button >> nth=0`);
        const box = await page.locator(`[data-plot="${id}"] .plot-area`).boundingBox();
        await page.locator(`[data-plot="${id}"] .plot-area`).scrollIntoViewIfNeeded();
        const at = await page.locator(`[data-plot="${id}"] .plot-area`).boundingBox();
        assert.ok(box);
        const { left, top } = await page.evaluate((plot) => window.mottle.charts[plot].getOption().grid[0], id);
        await page.mouse.move(at.x + left + 20, at.y + top + 20);
        await page.mouse.down();
        await page.mouse.move(at.x + left + 90, at.y + top + 70, { steps: 4 });
        await page.mouse.up();
        assert.equal(await zoomed(), true, `${id} did not zoom`);
        await page.click(`[data-plot="${id}"] .tools button >> nth=1`);
        assert.equal(await zoomed(), false, `${id} did not return`);
        await page.click(`[data-plot="${id}"] .tools button >> nth=0`);
      }
    },
  ],
  [
    "hovering a plot shows values as text",
    async ({ page, data }) => {
      for (const [id, pattern] of [
        ["spearman", /→[^]*ρ: /],
        ["mac", /–[^]*MAC: /],
      ]) {
        if (!expected_plots(data).includes(id)) continue;
        await page.locator(`[data-plot="${id}"] .plot-area`).scrollIntoViewIfNeeded();
        const at = await page.evaluate((plot) => {
          const chart = window.mottle.charts[plot];
          const [column, row] = chart.getOption().series[0].data[0].value;
          const box = document.querySelector(`[data-plot="${plot}"] .plot-area`).getBoundingClientRect();
          const [x, y] = chart.convertToPixel({ seriesIndex: 0 }, [column, row]);
          return { x: box.x + x, y: box.y + y };
        }, id);
        await page.mouse.move(at.x, at.y);
        await page.mouse.move(at.x + 2, at.y + 2);
        await page.waitForSelector(`[data-plot="${id}"] .tooltip`);
        assert.match(await page.locator(`[data-plot="${id}"] .tooltip`).innerText(), pattern);
      }
      await page.mouse.move(2, 2);
    },
  ],
  [
    "every plot saves as PNG and as SVG",
    async (study) => {
      const plots = expected_plots(study.data).filter((id) => study.is_due(`saving ${id}`));
      for (const kind of plots.length ? ["png", "svg"] : []) {
        const buttons = plots.map((id) => `[data-plot="${id}"] [data-export="${kind}"]`);
        const files = await saved_by(study, buttons.join());
        assert.deepEqual(
          files.map(({ name }) => name),
          plots.map((id) => `mottle-${id}.${kind}`),
        );
        for (const { name, bytes } of files) kind === "png" ? is_picture(name, bytes) : is_drawing(name, bytes);
      }
    },
  ],
  [
    "a table saves as CSV",
    async (study) => {
      const set_open = (change) => study.page.locator("details").evaluateAll(change);
      await set_open((all) => all.forEach((part) => ([part.was_open, part.open] = [part.open, true])));
      for (const { name, bytes } of await saved_by(study, '.table-block [data-export="csv"]'))
        assert.ok(bytes.toString("utf8").split("\r\n").length > 2, name);
      await set_open((all) => all.forEach((part) => (part.open = part.was_open)));
    },
  ],
];
