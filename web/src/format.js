// Numbers, percentages and names as text: four significant digits, a true minus sign, powers of ten spelled out.
import { is_number } from "./data.js";

const superscripts = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const with_minus = (text) => text.replace("-", "\u2212");
const nothing = "–";

/** 1.086, 0.09213, 2.100·10¹¹. */
export function number_text(value, digits = 4) {
  if (!is_number(value)) return nothing;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    const power = String(Number(exponent)).replace(/./g, (sign) => superscripts[sign]);
    return `${with_minus(mantissa)}·10${power}`;
  }
  const text = value.toPrecision(digits);
  // Beyond its digits a whole number: 69190, not 6.919e+4.
  return with_minus(text.includes("e") ? String(Number(text)) : text);
}

/** Like number_text, without trailing zeros: for bounds, options and axis labels. */
export function short_number(value, digits = 4) {
  if (!is_number(value)) return nothing;
  if (Number.isInteger(value) && Math.abs(value) < 1e6) return with_minus(String(value));
  return number_text(value, digits)
    .replace(/(\.\d*?)0+(?=$|·)/, "$1")
    .replace(/\.(?=$|·)/, "");
}

export function percent_text(value, digits = 1) {
  if (!is_number(value)) return nothing;
  const rounded = value.toFixed(digits);
  const sign = Number(rounded) > 0 ? "+" : "";
  return `${sign}${with_minus(Number(rounded) === 0 ? (0).toFixed(digits) : rounded)}\u00a0%`;
}

export function p_value_text(value) {
  if (!is_number(value)) return nothing;
  return value < 1e-4 ? "< 0.0001" : value.toFixed(4);
}

export function count_text(value) {
  return is_number(value) ? String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, "\u202f") : nothing;
}

export function seconds_text(value) {
  if (!is_number(value)) return nothing;
  if (value < 1) return `${short_number(1000 * value, 3)} ms`;
  return value < 120 ? `${short_number(value, 3)} s` : `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`;
}

export const plural = (count, one, many = `${one}s`) => `${count_text(count)} ${count === 1 ? one : many}`;
export const name_with_unit = (axis) => (axis.unit ? `${axis.name} (${axis.unit})` : axis.name);

/** Labels cut in the middle to the width that they have: names that differ at their ends stay different. */
export const fit_in = (width, font_size = 12) => (name) => {
  const letters = Math.max(4, Math.floor(width / (0.6 * font_size)));
  const text = String(name);
  if (text.length <= letters) return text;
  const end = Math.floor((letters - 1) / 2);
  return `${text.slice(0, letters - 1 - end)}…${text.slice(text.length - end)}`;
};

/** "0.71 k1 − 0.70 k2": the largest weights of a combination, largest first, with an ellipsis where smaller ones were left out. */
export function combination_text(weights, { least = 0.1, terms = 6 } = {}) {
  const all = Object.entries(weights)
    .filter(([, weight]) => is_number(weight) && Math.abs(weight) >= 0.005)
    .sort(([, a], [, b]) => Math.abs(b) - Math.abs(a));
  const shown = all.filter(([, weight]) => Math.abs(weight) >= least).slice(0, terms);
  const text = shown
    .map(([name, weight], position) => {
      const sign = weight < 0 ? "\u2212 " : "+ ";
      return `${position === 0 ? (weight < 0 ? "\u2212" : "") : sign}${Math.abs(weight).toFixed(2)}\u00a0${name}`;
    })
    .join(" ");
  return shown.length < all.length ? `${text} + …` : text;
}

/** max-iterations -> max iterations. */
export const words = (identifier) => String(identifier ?? "").replace(/[_-]+/g, " ");
