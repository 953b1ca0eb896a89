// What must hold in windows of every width, on a dark screen and on paper. All drawings are made anew for each of them: it is visited
// once, and what the claims need is measured then. The page is left as it was seen last.
import assert from "node:assert/strict";
import { let_frames_pass, resize, until_drawings_fit } from "./browser.mjs";
import { expected_plots, is_modes } from "./expectations.mjs";

const widths_of = ({ is_thorough }) => (is_thorough ? [800, 1280, 1440, 390] : [800, 1440, 390]);
const paper = { width: 680, height: 962 }; // A4 without its margins

/** What is wider than its place, and whether tools can be seen. */
const measured = (page) =>
  page.evaluate(() => {
    const { scrollWidth, clientWidth } = document.documentElement;
    const is_wide = (node, place) => node.scrollWidth > place.clientWidth + 1;
    const plots = [...document.querySelectorAll(".plot-area > div")].filter((node) => is_wide(node, node.parentElement));
    const tables = [...document.querySelectorAll(".table-scroll")].filter((node) => is_wide(node, node));
    const bars = [...document.querySelectorAll("[data-parameter], .bar-track > span")];
    const is_seen = (node) => node.checkVisibility({ checkVisibilityCSS: true }) && node.getBoundingClientRect().height > 0;
    return {
      overflow: { page: scrollWidth - clientWidth, plots: plots.length },
      cut_tables: tables.map((node) => node.getAttribute("aria-label")),
      end_of_bars: Math.max(0, ...bars.map((node) => node.getBoundingClientRect().right)),
      tools: [...document.querySelectorAll(".slider, .tools, .controls, nav")].filter(is_seen).length,
    };
  });

const background_of = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
const text_colours_of = (page) =>
  page.evaluate(() => Object.values(window.mottle.charts).map((chart) => chart.getModel().get(["textStyle", "color"])));

/** Waits until the text of every drawing has its colour of before, or none has. */
const until_text = (page, before, { is_same }) =>
  page.waitForFunction(
    ([colours, expected]) =>
      Object.values(window.mottle.charts).every(
        (chart, i) => (chart.getModel().get(["textStyle", "color"]) === colours[i]) === expected,
      ),
    [before, is_same],
  );

async function measure_windows(study) {
  const { page, shot } = study;
  const layouts = {};
  for (const width of widths_of(study)) {
    await resize(page, width, 900);
    layouts[width] = await measured(page);
    await shot(width);
  }
  return layouts;
}

/** The colours of the screen, which is dark afterwards; null where every kind of plot has been seen dark. */
async function darken({ page, data, shot, is_due }) {
  if (!["page", ...expected_plots(data)].filter((what) => is_due(`darkening ${what}`)).length) return null;
  const light = { background: await background_of(page), text: await text_colours_of(page) };
  await page.emulateMedia({ colorScheme: "dark" });
  await until_text(page, light.text, { is_same: false });
  const dark = await background_of(page);
  await shot("dark");
  return { light, dark };
}

/** On paper, for readers of a dark screen too: the summary, if the page has one, and then every section. */
async function measure_screen_and_paper(study) {
  const { page, data, shot } = study;
  const print_all = (on) => page.evaluate((all) => document.documentElement.classList.toggle("print-all", all), on);
  const tools = (await measured(page)).tools;
  const colours = await darken(study);
  await page.emulateMedia({ colorScheme: colours ? "dark" : null, media: "print" });
  await page.setViewportSize(paper);
  if (colours) await until_text(page, colours.light.text, { is_same: true });
  const background = await background_of(page);
  const layouts = [];
  for (const all of is_modes(data) ? [true] : [false, true]) {
    await print_all(all);
    await let_frames_pass(page, 1);
    await until_drawings_fit(page);
    layouts.push(await measured(page));
  }
  await print_all(is_modes(data));
  await shot("print");
  return { tools, colours, printed: { background, layouts } };
}

const windows_of = (study) => (study.windows ??= measure_windows(study));
const screen_and_paper_of = (study) => (study.screen_and_paper ??= measure_screen_and_paper(study));

export const layout_checks = [
  [
    "nothing overflows in a wide or narrow window or on a phone",
    async (study) => {
      const layouts = await windows_of(study);
      for (const width of widths_of(study)) assert.deepEqual(layouts[width].overflow, { page: 0, plots: 0 }, `at ${width} pixels`);
    },
  ],
  [
    "no column is cut off at 1440 pixels, and a phone shows every parameter without scrolling sideways",
    async (study) => {
      const layouts = await windows_of(study);
      assert.deepEqual(layouts[1440].cut_tables, []);
      assert.deepEqual(
        layouts[390].cut_tables.filter((title) => /^(Parameters|Model against tests|Outputs)/.test(title)),
        [],
      );
      assert.ok(layouts[390].end_of_bars <= 390, `a bar ends at ${layouts[390].end_of_bars}`);
    },
  ],
  [
    "on a dark screen page and drawings are dark, on paper light",
    async (study) => {
      const { colours, printed } = await screen_and_paper_of(study); // waits for the drawings
      if (!colours) return;
      assert.notEqual(colours.dark, colours.light.background);
      assert.equal(printed.background, colours.light.background);
    },
  ],
  [
    "in print the tools are gone and everything fits the paper",
    async (study) => {
      const { tools: tools_on_screen, printed } = await screen_and_paper_of(study);
      assert.ok(tools_on_screen > 0, "there are no tools on the screen");
      for (const { overflow, cut_tables, tools } of printed.layouts) {
        assert.deepEqual(overflow, { page: 0, plots: 0 });
        assert.deepEqual(cut_tables, [], "a table is wider than the paper");
        assert.equal(tools, 0);
      }
    },
  ],
  [
    "the printed summary has two pages at most",
    async (study) => {
      if (is_modes(study.data)) return;
      await screen_and_paper_of(study);
      const pdf = await study.page.pdf({ preferCSSPageSize: true });
      const pages = pdf.toString("latin1").match(/\/Type \/Page[^s]/g)?.length;
      assert.ok(pages >= 1 && pages <= 2, `${pages} pages`);
      const figures = await study.page.locator("section.in-print .plot-area").count();
      if (study.data.result?.command === "update") assert.ok(figures >= 1 && figures <= 2, `${figures} figures`);
    },
  ],
];
