// What must hold of a page with mode shapes, beside what holds of every page.
import assert from "node:assert/strict";
import { let_frames_pass } from "./browser.mjs";
import { is_number, list } from "./expectations.mjs";
import { downloaded } from "./files.mjs";

const id = "mode-shapes";
const area = `[data-scene="${id}"] .scene-area`;

/** Whether the data hold a structure to draw. */
export const has_scene = (data) => list(data.modes?.list).length > 0 && Boolean(data.modes.positions);

/** Number of distinct colours of what stands on the screen there; a blank area has one. */
async function colours_on_screen(page, selector) {
  const png = (await page.locator(selector).screenshot()).toString("base64");
  return page.evaluate(async (text) => {
    const image = new Image();
    image.src = `data:image/png;base64,${text}`;
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    return new Set(Array.from({ length: data.length / 4 }, (_, i) => data.subarray(4 * i, 4 * i + 3).join())).size;
  }, png);
}

/** A digest of the drawing's picture. */
const picture = (page) =>
  page.evaluate((scene) => {
    const canvas = window.mottle.scenes[scene].picture(240);
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return new Uint32Array(data.buffer).reduce((digest, pixel) => Math.imul(digest ^ pixel, 16777619), 2166136261);
  }, id);
const zoom = (page) => page.evaluate((scene) => window.mottle.scenes[scene].viewpoint.camera.zoom, id);
const title_of = (page) => page.locator(`${area} .scene`).getAttribute("aria-label");

async function changes(page, what, act) {
  const before = await picture(page);
  await act();
  assert.notEqual(await picture(page), before, `the picture stayed after ${what}`);
}

async function hold(page) {
  if ((await page.locator("#shape-play").innerText()).includes("Pause")) await page.click("#shape-play");
}

/** Held in the frame that leaves the largest deflection well behind, since a later one may be back there. */
async function swing_and_hold(page) {
  await page.click("#shape-play");
  await page.waitForFunction((scene) => {
    const is_far = Math.sin(window.mottle.scenes[scene].state.phase) < 0.7;
    if (is_far) document.querySelector("#shape-play").click();
    return is_far;
  }, id);
}

async function set_range(page, name, value) {
  await page.locator(`#shape-${name}`).fill(String(value));
}

async function drag(page, from, to) {
  await page.locator(area).scrollIntoViewIfNeeded();
  const box = await page.locator(area).boundingBox();
  await page.mouse.move(box.x + from[0], box.y + from[1]);
  await page.mouse.down();
  await page.mouse.move(box.x + to[0], box.y + to[1], { steps: 4 });
  await page.mouse.up();
}

async function is_drawn({ page }) {
  assert.ok((await colours_on_screen(page, area)) > 60, "the structure is not to be seen");
  await hold(page);
}

/** What both ways of drawing must do. */
async function answers({ page, data }) {
  if (data.modes.list.length > 1) {
    const before = await title_of(page);
    await changes(page, "choosing another mode", () => page.locator('[name="mode-shown"]').nth(1).check());
    assert.notEqual(await title_of(page), before);
    await changes(page, "an arrow key in the table", () => page.keyboard.press("ArrowUp"));
    assert.equal(await title_of(page), before);
  }
  await changes(page, "dragging", () => drag(page, [150, 120], [220, 150]));
  await changes(page, "a view along z", () => page.click('[data-view="z"]'));
  await changes(page, "a view from the corner", () => page.click('[data-view="iso"]'));
  await changes(page, "a while of swinging", () => swing_and_hold(page));
  await changes(page, "no amplitude", () => set_range(page, "amplitude", 0));
  await set_range(page, "amplitude", 8);
  if (data.modes.triangles) await changes(page, "taking the edges away", () => page.click("#shape-edges"));
  if (data.modes.triangles) await page.click("#shape-edges");
  await changes(page, "taking the undeformed structure away", () => page.click("#shape-outline"));
  await page.click("#shape-outline");
  if (data.modes.list.some(({ test }) => test?.shape)) {
    await page.locator("[name=mode-shown]").first().click();
    await changes(page, "taking the measured shape away", () => page.click("#shape-test"));
    await page.click("#shape-test");
  }
  if (!data.modes.parameters) return;
  const options = await page.locator("#shape-part option").allTextContents();
  assert.deepEqual(options.slice(0, 2), ["none", data.modes.parameters[0].name]);
  assert.ok(!options.includes("nothing"), "a parameter without elements is offered");
  await changes(page, "colouring a parameter's elements", () => page.selectOption("#shape-part", "0"));
  await page.selectOption("#shape-part", "-1");
}

export const scene_checks = [
  [
    "it swings by itself, unless the reader wants less motion",
    async ({ page, open, is_due }) => {
      if (!is_due("swinging at once")) return;
      const is_playing = () => page.evaluate((scene) => window.mottle.scenes[scene].state.is_playing, id);
      assert.equal(await is_playing(), true);
      await open({ reducedMotion: "reduce" });
      assert.equal(await is_playing(), false);
    },
  ],
  [
    "the table lists every mode with its frequency",
    async ({ page, data }) => {
      const cells = page.locator('[data-table="modes"] [data-key="frequency"]');
      assert.equal(await cells.count(), data.modes.list.length);
      for (const [i, mode] of data.modes.list.entries())
        assert.equal(
          await cells.nth(i).getAttribute("data-value"),
          is_number(mode.frequency) ? String(mode.frequency) : null,
        );
      assert.equal(await page.locator('[data-table="modes"] td *').count(), 0, "a note was taken as markup");
    },
  ],
  [
    "the structure is drawn in WebGL and answers to all that can be set",
    async (study) => {
      assert.equal(await study.page.locator(`[data-scene="${id}"]`).getAttribute("data-renderer"), "webgl");
      await is_drawn(study);
      if (study.is_due("a structure in WebGL")) await answers(study);
    },
  ],
  [
    "held, the structure stands still",
    async ({ page }) => {
      await hold(page);
      const phase = () => page.evaluate((scene) => window.mottle.scenes[scene].state.phase, id);
      const before = [await phase(), await picture(page)];
      await let_frames_pass(page, 4);
      assert.deepEqual([await phase(), await picture(page)], before);
    },
  ],
  [
    "Ctrl and the wheel enlarge the structure, the wheel alone scrolls the page, keys turn and enlarge",
    async ({ page }) => {
      await page.locator(area).scrollIntoViewIfNeeded();
      const box = await page.locator(area).boundingBox();
      await page.mouse.move(box.x + 200, box.y + 150);
      const before = await zoom(page);
      const place = await page.evaluate(() => window.scrollY);
      await page.mouse.wheel(0, 40);
      await page.waitForFunction((was) => window.scrollY > was, place);
      assert.equal(await zoom(page), before);
      await page.keyboard.down("Control");
      await page.mouse.wheel(0, -40);
      await page.waitForFunction(([scene, was]) => window.mottle.scenes[scene].viewpoint.camera.zoom > was, [id, before]);
      await page.keyboard.up("Control");
      await page.click('[data-view="iso"]');
      await page.locator(`${area} .scene`).focus();
      await page.keyboard.press("+");
      assert.ok((await zoom(page)) > before, "not enlarged by the key");
      await changes(page, "an arrow key on the drawing", () => page.keyboard.press("ArrowLeft"));
      await page.click('[data-view="iso"]');
    },
  ],
  [
    "pointing at a node tells its number and displacement",
    async ({ page, data }) => {
      await page.locator(area).scrollIntoViewIfNeeded();
      const at = await page.evaluate((scene) => {
        const viewer = window.mottle.scenes[scene];
        const box = viewer.surface.getBoundingClientRect();
        viewer.read_node({ clientX: box.x, clientY: box.y });
        return { x: box.x + viewer.places[0], y: box.y + viewer.places[1] };
      }, id);
      await page.mouse.move(at.x, at.y);
      assert.match(await page.locator(".node-reading").innerText(), /^Node \d+: ux .*, uy .*, uz /);
      assert.ok(list(data.modes.node_ids).length > 0);
      await page.mouse.move(2, 2);
    },
  ],
  [
    "the view saves as PNG",
    async ({ page }) => {
      const { name, bytes } = await downloaded(page, () => page.click(`[data-scene="${id}"] [data-export="png"]`));
      assert.equal(name, `mottle-${id}.png`);
      assert.equal(bytes.subarray(1, 4).toString(), "PNG");
    },
  ],
  [
    "on paper stands a picture of the structure",
    async ({ page, data, is_due }) => {
      if (!is_due("a structure on paper")) return;
      await page.evaluate((still) => {
        document.documentElement.classList.add("print-all"); // a report prints a summary else
        document.querySelector(still).width = 1; // no picture yet
      }, `${area} .still`);
      await page.emulateMedia({ media: "print" });
      await page.waitForFunction((still) => document.querySelector(still).width > 1, `${area} .still`);
      assert.equal(await page.locator(`${area} .scene:visible, ${area} .over:visible`).count(), 0);
      assert.ok((await colours_on_screen(page, `${area} .still`)) > 60, "the picture is blank");
      await page.emulateMedia({ media: null });
      await page.evaluate((all) => document.documentElement.classList.toggle("print-all", all), data.kind === "modes");
    },
  ],
  [
    "without WebGL the structure is drawn all the same and answers to all that can be set",
    async ({ file, window, data, browser_of, is_due }) => {
      if (!is_due("a structure without WebGL")) return;
      const { page, complaints, open } = await browser_of("none");
      await open(file, window);
      assert.equal(await page.locator(`[data-scene="${id}"]`).getAttribute("data-renderer"), "canvas");
      await is_drawn({ page });
      await answers({ page, data });
      assert.deepEqual(complaints, []);
    },
  ],
];
