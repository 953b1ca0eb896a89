// What must hold of every page in the browser's window.
import assert from "node:assert/strict";

export const fits_the_window = [
  "the page is no wider than the window",
  async ({ page }) => {
    const { scrollWidth, innerWidth } = await page.evaluate(() => ({
      scrollWidth: document.documentElement.scrollWidth,
      innerWidth: window.innerWidth,
    }));
    assert.ok(scrollWidth <= innerWidth, `${scrollWidth} pixels`);
  },
];
