// A browser that reports everything a page must not do: messages on the console, errors, requests beyond the page itself.
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
];

/** "plain" draws fastest; "webgl" is WebGL by the processor; "none" a browser that refuses it. */
const flags_of_graphics = {
  plain: ["--disable-gpu"],
  webgl: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  none: ["--disable-gpu", "--disable-3d-apis"],
};

/** A driver's word on its own speed, when a picture is read back, is no complaint about the page. */
const is_of_driver = (text) => text.includes("GL Driver Message (OpenGL, Performance");

export async function open_page(file, { width = 1280, height = 900, graphics = "plain", media = {} } = {}) {
  const profile = mkdtempSync(path.join(tmpdir(), "mottle-page-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    args: [...flags, ...flags_of_graphics[graphics]],
    viewport: { width, height },
    acceptDownloads: true,
    ...media,
  });
  const page = context.pages()[0] ?? (await context.newPage());
  const complaints = [];
  const address = pathToFileURL(path.resolve(file)).href;
  page.on("console", (message) => {
    if (!["error", "warning"].includes(message.type()) || is_of_driver(message.text())) return;
    complaints.push(`console ${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`page error: ${error.message}`));
  page.on("dialog", (dialog) => {
    complaints.push(`dialog: ${dialog.message()}`);
    dialog.dismiss();
  });
  context.on("request", (request) => {
    const url = request.url();
    if (url !== address && !url.startsWith("data:") && !url.startsWith("blob:")) complaints.push(`request: ${url}`);
  });
  page.setDefaultTimeout(180000); // how long a page takes is no claim of these tests: the machine may do other things
  await page.goto(address);
  await page.waitForSelector("html[data-ready=true]", { state: "attached" });
  const close = async () => {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  };
  return { page, complaints, close };
}
