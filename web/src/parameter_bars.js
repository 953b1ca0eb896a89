// A bar a parameter: its prior, the estimate with its interval, the scatter of the specimens and the bounds, on one axis.
import { extent, is_number } from "./data.js";
import { element } from "./dom.js";
import { number_text, short_number } from "./format.js";

/** Sign, word and tone of a mark; the meaning is in words, so that none depends on a colour. */
const marks = {
  found: { sign: "✓", word: "found", tone: "good" },
  "mean-only": { sign: "◐", word: "mean only", tone: "open" },
  "at-bound": { sign: "▮", word: "at bound", tone: "bad" },
  "not-seen": { sign: "○", word: "not seen", tone: "bad" },
  doubtful: { sign: "?", word: "doubtful", tone: "bad" },
};

const worst_first = ["at-bound", "not-seen", "doubtful", "mean-only", "found", null];

/** The parameters that need attention first, where there are too many to show all. */
export const by_attention = (findings) =>
  [...findings].sort((a, b) => worst_first.indexOf(a.mark) - worst_first.indexOf(b.mark));

/** What the axis of bars spans: all that is drawn on it, and a bound where it is near. */
export function span_of(findings) {
  const drawn = ({ prior, prior_mean, estimate, interval, specimens }) =>
    [...(prior ?? []), ...(interval ?? []), ...(specimens ?? []), prior_mean, estimate];
  const range = extent(findings.flatMap(drawn));
  if (!range) return null;
  const width = range[1] - range[0] || Math.abs(range[0]) || 1;
  const near = findings.flatMap(({ bounds }) => bounds).filter(
    (bound) => is_number(bound) && bound > range[0] - width / 3 && bound < range[1] + width / 3,
  );
  const [low, high] = extent([...range, ...near]);
  return { low: low - 0.03 * width, high: high + 0.03 * width };
}

export function track(finding, span = span_of([finding])) {
  if (!span) return null;
  const share = (value) => (100 * (value - span.low)) / (span.high - span.low);
  const strip = (kind, ends) =>
    ends &&
    element("span", {
      class: `bar-${kind}`,
      style: `left:${share(ends[0])}%;width:${share(ends[1]) - share(ends[0])}%`,
    });
  const tick = (kind, value) =>
    is_number(value) && share(value) >= 0 && share(value) <= 100
      ? element("span", { class: `bar-${kind}`, style: `left:${share(value)}%` })
      : null;
  return element(
    "div",
    { class: "bar-track" },
    strip("prior", finding.prior),
    tick("prior-mean", finding.prior_mean),
    strip("specimens", finding.specimens),
    strip("interval", finding.interval),
    finding.bounds.map((bound) => tick("bound", bound)),
    tick("estimate", finding.estimate),
  );
}

const unit_text = (unit) => (unit && unit !== "-" ? ` ${unit}` : "");
const range_text = (ends) => `${short_number(ends[0], 3)} … ${short_number(ends[1], 3)}`;

export function value_text({ estimate, interval, unit, number }) {
  if (!is_number(estimate)) return interval ? `${range_text(interval)}${unit_text(unit)}` : "–";
  const known = interval ? ` (${range_text(interval)})` : "";
  return `${number_text(estimate)}${known}${unit_text(unit)}${number ? ` = ${number}` : ""}`;
}

export function spoken(finding) {
  const { name, prior, estimate, interval, unit } = finding;
  const parts = [
    prior ? `prior ${range_text(prior)}` : null,
    is_number(estimate) ? `estimate ${number_text(estimate)}` : null,
    interval ? `${finding.is_box ? "box" : "95 % interval"} ${range_text(interval)}` : null,
  ].filter(Boolean);
  return `${name}: ${parts.join(", ")}${unit_text(unit)}`;
}

/** Green only in a model that stood its tests: what is found in any other is found on a condition. */
export function mark_badge({ mark, reason, is_confirmed }) {
  const shown = marks[mark];
  if (!shown) return null;
  const tone = shown.tone === "good" && !is_confirmed ? "open" : shown.tone;
  return element("span", { class: `mark ${tone}`, title: reason, "data-mark": mark }, `${shown.sign} ${shown.word}`);
}

/** A track between the numbers of its ends. */
function scaled_track(finding) {
  const span = span_of([finding]);
  const end = (value) => element("span", { class: "bar-end" }, short_number(value, 3));
  return span && element("div", { class: "bar-scale", "aria-hidden": "true" }, end(span.low), track(finding, span), end(span.high));
}

function bar(finding) {
  const says = ["at-bound", "not-seen"].includes(finding.mark) ? finding.reason : null; // the conclusion says the others
  return element(
    "div",
    { class: "parameter-bar", role: "img", "aria-label": spoken(finding), "data-parameter": finding.name },
    element(
      "div",
      { class: "bar-head" },
      element("b", {}, finding.name),
      element("span", { class: "bar-value" }, value_text(finding)),
      mark_badge(finding),
    ),
    scaled_track(finding),
    says ? element("div", { class: "bar-reason" }, says) : null,
  );
}

export function key(findings) {
  const any = (field) => findings.some((finding) => finding[field]);
  const entry = (kind, text) =>
    element("span", { class: "key-entry" }, element("span", { class: `key key-${kind}` }), text);
  return element(
    "div",
    { class: "bar-key", "aria-hidden": "true" },
    any("prior") ? entry("prior", "prior, 95 %") : null,
    any("specimens") ? entry("specimens", "specimens, 95 %") : null,
    any("interval") ? entry("interval", any("is_box") ? "box" : any("is_posterior") ? "posterior, 95 %" : "mean, 95 % interval") : null,
    findings.some(({ estimate }) => is_number(estimate)) ? entry("estimate", any("is_posterior") ? "its mean" : "estimate") : null,
    findings.some(({ bounds }) => bounds.some(is_number)) ? entry("bound", "bound") : null,
  );
}

export function parameter_bars(findings) {
  return element("div", { class: "parameter-bars" }, key(findings), findings.map(bar));
}
