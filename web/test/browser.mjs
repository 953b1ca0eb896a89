// A browser with one tab that reports everything a page must not do: messages on the console, errors, requests beyond the page itself.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const flags = [
  "--headless",
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--js-flags=--no-opt", // a page lives too shortly to be worth optimised code
  "--disable-gpu", // the page is painted by the processor: five times faster than a software GPU painting it
];

/** "webgl" is WebGL by the processor, "none" a browser that refuses it. */
const flags_of_graphics = {
  webgl: ["--enable-unsafe-swiftshader"],
  none: ["--disable-3d-apis"],
};

/** How long anything may take; a condition that is not met by then never will be. A slow machine is no failure of the page. */
export const patience = 90000;

/** A driver's word on its own speed, when a picture is read back, is no complaint about the page. */
const is_of_driver = (text) => text.includes("GL Driver Message (OpenGL, Performance");

/** A walk through the iterations leaves time to look; a test does not look. */
function hasten_intervals() {
  const { setInterval } = window;
  window.setInterval = (action, milliseconds, ...rest) => setInterval.call(window, action, milliseconds / 10, ...rest);
}

export async function open_browser(graphics = "webgl") {
  const profile = mkdtempSync(path.join(tmpdir(), "mottle-page-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    args: [...flags, ...flags_of_graphics[graphics]],
    acceptDownloads: true,
    timeout: patience,
  });
  const page = context.pages()[0] ?? (await context.newPage());
  page.setDefaultTimeout(patience);
  await page.addInitScript(hasten_intervals);
  const complaints = [];
  let address = "";
  page.on("console", (message) => {
    if (!["error", "warning"].includes(message.type()) || is_of_driver(message.text())) return;
    complaints.push(`console ${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`page error: ${error.message}`));
  page.on("crash", () => complaints.push("the page's process crashed"));
  page.on("dialog", (dialog) => {
    complaints.push(`dialog: ${dialog.message()}`);
    dialog.dismiss();
  });
  context.on("request", (request) => {
    const url = request.url();
    if (url !== address && !url.startsWith("data:") && !url.startsWith("blob:")) complaints.push(`request: ${url}`);
  });

  /** Shows a file as if nothing had been shown before it. Throws with the page's own errors where it does not get ready. */
  async function open(file, { width, height, media = {} }) {
    await page.goto("about:blank");
    complaints.length = 0;
    address = pathToFileURL(path.resolve(file)).href;
    await page.setViewportSize({ width, height });
    await page.emulateMedia({ media: null, colorScheme: null, reducedMotion: null, ...media });
    await page.goto(address);
    // Scripts run before the page has loaded: one that is not ready by now, and complains, is broken.
    const is_ready = await page.evaluate(() => document.documentElement.dataset.ready === "true");
    if (!is_ready && complaints.length) throw new Error(`the page did not get ready: ${complaints.join("; ")}`);
    await page.waitForSelector("html[data-ready=true]", { state: "attached" });
  }

  async function close() {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  }
  return { page, complaints, open, close };
}

/** Waits until every drawing has taken the width of its place. */
export function until_drawings_fit(page) {
  return page.waitForFunction(() => {
    const { charts, scenes } = window.mottle;
    const do_charts_fit = Object.values(charts).every(
      (chart) => chart.getWidth() === Math.max(240, Math.floor(chart.getDom().clientWidth || 900)),
    );
    return do_charts_fit && Object.values(scenes).every(({ host, size }) => size.width === Math.max(240, host.clientWidth));
  });
}

export async function resize(page, width, height) {
  await page.setViewportSize({ width, height });
  await page.waitForFunction((expected) => window.innerWidth === expected, width);
  await until_drawings_fit(page);
}

/** Lets the page draw so many frames, however long it takes. */
export function let_frames_pass(page, count) {
  return page.evaluate(
    (left) =>
      new Promise((resolve) => {
        const next = () => (left-- > 0 ? requestAnimationFrame(next) : resolve());
        next();
      }),
    count,
  );
}
