// Errors of means and of scatter as text, as the report and the comparison of runs show them.
import { is_number } from "./data.js";
import { percent_text, short_number } from "./format.js";

const percent = (share) => (is_number(share) ? percent_text(100 * share, Math.abs(share) < 0.001 ? 3 : 2) : "–");
export const of_tests = (ratio) => (is_number(ratio) ? `${short_number(100 * ratio, 3)}\u00a0%` : "–");
export const refused = (claim, text) => (claim === false ? `✗ ${text}` : text);

/** A mean near zero has no error in percent: its difference is shown then. */
export function mean_text(cloud, unit) {
  if (is_number(cloud.mean_error)) return percent(cloud.mean_error);
  return is_number(cloud.mean_difference) ? `${short_number(cloud.mean_difference, 3)} ${unit}` : "–";
}
