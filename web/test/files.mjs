// What the buttons of a page save.
import { readFileSync } from "node:fs";

/** What a click saves. The browser lets a page start ten downloads in a second and drops the next without a word: hence the pause. */
export async function downloaded(page, click) {
  await page.waitForTimeout(120);
  const [download] = await Promise.all([page.waitForEvent("download"), click()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

/**
 * What the buttons from `first` on save, taken from the page before the browser stores it, which is most of the cost: {name, bytes}.
 * The buttons are pressed by the page, wherever they stand.
 */
async function caught(page, selector, first) {
  const files = await page.evaluate(async ([buttons, start]) => {
    const { click } = HTMLAnchorElement.prototype;
    const { createObjectURL } = URL;
    const base64 = (blob) =>
      new Promise((resolve) => {
        const reader = new FileReader();
        reader.onload = () => resolve(reader.result.slice(reader.result.indexOf(",") + 1));
        reader.readAsDataURL(blob);
      });
    const blobs = new Map();
    let take = null;
    URL.createObjectURL = (blob) => {
      const address = createObjectURL.call(URL, blob);
      blobs.set(address, blob);
      return address;
    };
    HTMLAnchorElement.prototype.click = function () {
      take({ name: this.download, blob: blobs.get(this.href) });
    };
    const files = [];
    for (const button of [...document.querySelectorAll(buttons)].slice(start)) {
      const file = new Promise((resolve) => (take = resolve));
      button.click();
      const { name, blob } = await file;
      files.push({ name, content: await base64(blob) });
    }
    URL.createObjectURL = createObjectURL;
    HTMLAnchorElement.prototype.click = click;
    return files;
  }, [selector, first]);
  return files.map(({ name, content }) => ({ name, bytes: Buffer.from(content, "base64") }));
}

/**
 * What each of the buttons saves. The first is pressed with the mouse and its file downloaded, and so are all others of a
 * thorough test.
 */
export async function saved_by({ page, is_thorough }, selector) {
  const buttons = page.locator(selector);
  const count = await buttons.count();
  const files = [];
  for (let i = 0; i < (is_thorough ? count : Math.min(count, 1)); i += 1)
    files.push(await downloaded(page, () => buttons.nth(i).click()));
  return is_thorough || count < 2 ? files : [...files, ...(await caught(page, selector, 1))];
}
