// What must hold of the sections on a population: its densities, correlations, specimens, blind spots and predictions.
import assert from "node:assert/strict";
import { close_to_data, expected_plots, has_numbers, is_number, list, result_of, series_of } from "./expectations.mjs";

const has_plot = (data, id) => expected_plots(data).includes(id);
const option_of = (page, id) =>
  page.evaluate((plot) => {
    const { series, title, xAxis } = window.mottle.charts[plot].getOption();
    return {
      titles: (title ?? []).map(({ text }) => text),
      columns: xAxis[0].data,
      series: series.map(({ name, xAxisIndex, data }) => ({ name, xAxisIndex, data })),
    };
  }, id);

/** Points of the named curve in a panel. */
const curve_in = ({ series }, panel, name) =>
  series.find((one) => one.xAxisIndex === panel && one.name === name)?.data ?? [];

/** Several batches together are not normal. */
const has_batches = (data) => list(result_of(data).components).length > 1;

export const population_checks = [
  [
    "the intervals of means and deviations stand in the parameters' table",
    async ({ page, data }) => {
      const { parameters = {} } = result_of(data);
      for (const key of ["mean_ci95", "std_ci95"]) {
        const known = list(parameters[key]).filter((interval) => has_numbers(interval)).length;
        const cells = await page.locator(`[data-table="parameters"] td[data-key="${key}"]`).allInnerTexts();
        assert.equal(cells.filter((text) => text.includes("…")).length, known, key);
      }
    },
  ],
  [
    "an updated density is that of the estimate: its height, its place, its area; one tick for every specimen",
    async ({ page, data }) => {
      if (!has_plot(data, "densities")) return;
      const { parameters, specimens } = result_of(data);
      const option = await option_of(page, "densities");
      const shown = list(parameters.names)
        .map((_, i) => i)
        .filter((i) => is_number(parameters.mean?.[i]) && is_number(parameters.std?.[i]))
        .slice(0, 9);
      for (const [panel, i] of shown.entries()) {
        const curve = curve_in(option, panel, "Updated");
        if (parameters.densities[i]?.updated?.x.length > 2) {
          const area = curve.slice(1).reduce((sum, [x, y], k) => sum + ((x - curve[k][0]) * (y + curve[k][1])) / 2, 0);
          assert.ok(Math.abs(area - 1) < 2e-3, `area ${area} of parameter ${i}`);
          const is_sampled = parameters.estimate?.kind === "posterior"; // neither normal nor smooth
          if (!is_sampled && !has_batches(data) && (parameters.scale?.[i] ?? "identity") === "identity") {
            const [place, height] = curve.reduce((best, point) => (point[1] > best[1] ? point : best));
            assert.ok(
              Math.abs(place - parameters.mean[i]) < 1e-9 * Math.abs(parameters.mean[i]) + 1e-3 * parameters.std[i],
            );
            assert.ok(Math.abs(height * parameters.std[i] * Math.sqrt(2 * Math.PI) - 1) < 1e-5);
          }
        }
        const ticks = list(specimens?.parameters).filter((row) => is_number(row?.[i])).length;
        assert.equal(curve_in(option, panel, "Estimate of a specimen").length, ticks);
      }
    },
  ],
  [
    "the updated density lies within the band that the intervals leave open",
    async ({ page, data }) => {
      if (!has_plot(data, "densities")) return;
      const { parameters } = result_of(data);
      const option = await option_of(page, "densities");
      for (const i of list(parameters.names).slice(0, 9).keys()) {
        const band = curve_in(option, i, "Range within the 95 % intervals");
        const curve = curve_in(option, i, "Updated");
        const is_inside = (interval, value) =>
          list(interval).length === 2 && interval[0] <= value && value <= interval[1];
        if (
          !is_inside(parameters.mean_ci95?.[i], parameters.mean[i]) ||
          !is_inside(parameters.std_ci95?.[i], parameters.std[i])
        )
          continue;
        const top = Math.max(...curve.map(([, y]) => y));
        const between = (x, which) => {
          const after = band.findIndex(([at]) => at >= x);
          if (after < 1) return null;
          const [a, b] = [band[after - 1], band[after]];
          return a[which] + ((b[which] - a[which]) * (x - a[0])) / (b[0] - a[0]);
        };
        for (const [x, y] of curve) {
          const [low, high] = [between(x, 1), between(x, 2)];
          if (low === null) continue;
          assert.ok(low - 0.03 * top <= y && y <= high + 0.03 * top, `parameter ${i} at ${x}: ${low} ${y} ${high}`);
        }
      }
    },
  ],
  [
    "a posterior tells its quantiles, its evidence and what it is worth",
    async ({ page, data }) => {
      const { parameters = {} } = result_of(data);
      const is_posterior = parameters.estimate?.kind === "posterior";
      assert.equal(await page.locator('[data-table="quantiles"]').count(), is_posterior ? 1 : 0);
      if (!is_posterior) return;
      const cells = page.locator('[data-table="quantiles"] tbody td.number');
      assert.equal(await cells.count(), parameters.quantiles.values.flat().length);
      const text = await page.locator("#parameters > p").allInnerTexts();
      const worth = String(Math.round(parameters.estimate.effective_samples)).replace(/\B(?=(\d{3})+$)/g, "\u202f");
      assert.ok(text.join(" ").includes(`worth ${worth} independent draws`), text.join(" "));
    },
  ],
  [
    "the correlations are those of the covariance, with the intervals of the result",
    async ({ page, data }) => {
      if (!has_plot(data, "correlation-ellipses")) return;
      const { names, scale, covariance, correlation_ci95, std } = result_of(data).parameters;
      const rows = page.locator('[data-table="correlations"] tbody tr');
      const count = await rows.count();
      assert.equal(count > 0 && count <= 15, true, `${count} rows`);
      for (let k = 0; k < count; k += 1) {
        const name = await rows.nth(k).getAttribute("data-row");
        const [i, j] = names
          .flatMap((a, first) => names.map((b, second) => [first, second, `${a}, ${b}`]))
          .find(([, , text]) => text === name);
        const interval = list(correlation_ci95?.[i]?.[j]).filter(is_number);
        const text = await rows.nth(k).locator('[data-key="interval"]').innerText();
        if (interval.length < 2) {
          assert.equal(text, "–");
          continue;
        }
        const shown = text.split(" … ").map((end) => Number(end.replace("−", "-")));
        interval.forEach((end, which) => assert.ok(Math.abs(end - shown[which]) < 0.006, `${name}: ${text}`));
        const kinds = [scale?.[i] ?? "identity", scale?.[j] ?? "identity"];
        if (kinds.some((kind) => kind !== "identity") || !(std[i] > 0 && std[j] > 0)) continue;
        const value = Number(await rows.nth(k).locator('[data-key="correlation"]').getAttribute("data-value"));
        assert.ok(Math.abs(value - covariance[i][j] / (std[i] * std[j])) < 1e-9, name);
      }
    },
  ],
  [
    "an ellipse stands in the box of two deviations, whatever its correlation",
    async ({ page, data }) => {
      if (!has_plot(data, "correlation-ellipses") || has_batches(data)) return;
      const { names, scale, mean, std } = result_of(data).parameters;
      if (names.length > 3 || list(scale).some((kind) => kind !== "identity")) return;
      const { series } = await option_of(page, "correlation-ellipses");
      const pairs = names.flatMap((_, i) => names.slice(i + 1).map((__, k) => [i, i + 1 + k]));
      for (const { name, xAxisIndex, data: points } of series) {
        if (name === "Estimate of a specimen" || !points.length) continue;
        pairs[xAxisIndex].forEach((parameter, which) => {
          const reach = Math.max(...points.map((point) => Math.abs(point[which] - mean[parameter])));
          assert.ok(Math.abs(reach / (2 * std[parameter]) - 1) < 2e-3, `${name}: ${reach}`);
        });
      }
    },
  ],
  [
    "residuals beyond three are framed and counted, outlying specimens named",
    async ({ page, data }) => {
      const { specimens, outliers } = result_of(data);
      assert.equal(await page.locator('[data-table="outliers"] tbody tr').count(), list(outliers).length);
      for (const { specimen } of list(outliers)) {
        assert.equal(await page.locator(`[data-table="outliers"] tr[data-row="${specimen}"]`).count(), 1);
      }
      if (!has_plot(data, "residuals")) return;
      const rows = list(specimens.residuals).map(list);
      const beyond = (some) => some.flat().filter((value) => Math.abs(value) > 3).length;
      const [{ data: cells }] = await series_of(page, "residuals");
      const shown = rows.slice(0, 50);
      assert.equal(cells.length, shown.flat().filter(is_number).length);
      assert.equal(cells.filter(({ itemStyle }) => itemStyle?.borderWidth).length, beyond(shown));
      const number = (k) => list(specimens.numbers)[k] ?? k + 1;
      const marked = new Set(list(outliers).map(({ specimen }) => specimen));
      const { columns } = await option_of(page, "residuals");
      assert.deepEqual(
        columns,
        shown.map((_, k) => `${number(k)}${marked.has(number(k)) ? "*" : ""}`),
      );
      const text = await page.locator("#specimens > p").first().innerText();
      assert.ok(text.startsWith(beyond(rows) ? `${beyond(rows)} residual` : "None"), text);
    },
  ],
  [
    "unseen directions are drawn as bars by parameter and told in words",
    async ({ page, data }) => {
      const directions = list(result_of(data).identifiability?.unseen_directions);
      if (!has_plot(data, "unseen-directions")) return;
      assert.equal(await page.locator(".unseen li").count(), directions.length);
      const panels = await series_of(page, "unseen-directions");
      assert.equal(panels.length, Math.min(6, directions.length));
      for (const [k, { data: bars }] of panels.entries()) {
        const largest = Math.max(...Object.values(directions[k].weights).map(Math.abs));
        const length = Math.hypot(...Object.values(directions[k].weights));
        assert.ok(Math.abs(Math.abs(bars[0].value) - largest / length) < 1e-12);
      }
      const [{ data: parts }] = await series_of(page, "unseen-parts");
      const total = parts.reduce((sum, { value }) => sum + value, 0);
      assert.ok(Math.abs(total - directions.length) < 1e-2 * directions.length, `unseen parts add up to ${total}`);
    },
  ],
  [
    "the surrogate's errors stand by output, those of its last round first",
    async ({ page, data }) => {
      const { surrogate, outputs } = result_of(data);
      const rounds = list(surrogate?.rounds);
      const names = rounds.length ? list(outputs?.names) : [];
      assert.equal(await page.locator('[data-table="surrogate"] tbody tr').count(), names.length);
      for (const key of ["carried_error", "error_at_estimate"]) {
        const values = list(rounds.at(-1)?.[key]);
        if (has_numbers(values)) await close_to_data(page, "surrogate", key, names, values);
      }
      if (!is_number(surrogate?.tolerance)) return;
      const shares = list(rounds.at(-1).error_at_estimate).map((error, k) => error / Math.sqrt(outputs.test_covariance[k][k]));
      const flagged = await page.locator('[data-table="surrogate"] td[data-key="share"].flag').count();
      assert.equal(flagged, shares.filter((share) => share > surrogate.tolerance).length);
    },
  ],
  [
    "predictions stand with their coverage; every held-out test is drawn and counted once",
    async ({ page, data }) => {
      const { prediction } = result_of(data);
      const names = list(prediction?.names);
      assert.equal(await page.locator('[data-table="predictions"] tbody tr').count(), names.length);
      for (const key of ["mean", "std"]) {
        if (has_numbers(prediction?.[key])) await close_to_data(page, "predictions", key, names, prediction[key]);
      }
      const held_out = prediction?.held_out;
      for (const [k, share] of list(held_out?.coverage).entries()) {
        const cell = page.locator('[data-table="predictions"] tbody tr').nth(k).locator('[data-key="coverage"]');
        assert.equal(await cell.innerText(), `${(100 * share).toFixed(0)}\u00a0%`);
      }
      if (!has_plot(data, "prediction-pit")) return;
      const column = (k) => list(held_out.transforms).filter((row) => is_number(row?.[k])).length;
      const { series } = await option_of(page, "prediction-pit");
      const drawn = names.map((_, k) => k).filter((k) => column(k) > 0);
      for (const [panel, k] of drawn.slice(0, 9).entries()) {
        assert.equal(
          curve_in({ series }, panel, "Held-out tests").reduce((sum, [, count]) => sum + count, 0),
          column(k),
        );
      }
      if (!has_plot(data, "prediction-intervals")) return;
      const marks = (await series_of(page, "prediction-intervals")).filter(({ name }) => name.startsWith("Held-out"));
      const with_bar = drawn.filter((k) => has_numbers(prediction.interval95?.[k]) && prediction.std?.[k] > 0);
      const total = with_bar.reduce((sum, k) => sum + column(k), 0);
      assert.equal(
        marks.reduce((sum, { data: points }) => sum + points.length, 0),
        total,
      );
    },
  ],
  [
    "panels that do not fit one page can be leafed through",
    async ({ page, data }) => {
      for (const id of ["densities", "residuals", "unseen-directions", "prediction-pit"]) {
        const pager = page.locator(`#figure-${id} .pager`);
        if (!has_plot(data, id) || !(await pager.count())) continue;
        const state = async () => JSON.stringify(await series_of(page, id));
        const [label, first] = [await pager.locator(".pager-label").innerText(), await state()];
        await pager.locator("button").nth(1).click();
        assert.notEqual(await pager.locator(".pager-label").innerText(), label);
        assert.notEqual(await state(), first, `${id} stayed`);
        await pager.locator("button").nth(0).click();
        assert.equal(await state(), first, `${id} did not return`);
      }
    },
  ],
];
