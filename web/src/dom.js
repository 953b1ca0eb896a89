// The few kinds of element that the page is made of. Text always goes in as text, never as markup.

export function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? "" : String(value));
  }
  append(node, children);
  return node;
}

export function append(node, children) {
  for (const child of [children].flat(Infinity)) {
    if (child !== null && child !== undefined && child !== false) {
      node.append(child instanceof Node ? child : String(child));
    }
  }
  return node;
}

/** Text in which `code` stands between backticks. */
export function prose(text) {
  return String(text)
    .split(/`([^`]+)`/)
    .map((part, i) => (i % 2 ? element("code", {}, part) : part));
}

export const paragraph = (...children) => element("p", {}, ...children);

export function bullets(items, attributes = {}) {
  return element(
    "ul",
    attributes,
    items.map((item) => element("li", {}, item)),
  );
}

/** Terms and what they mean: [[term, meaning]]. */
export function definitions(entries) {
  return element(
    "dl",
    {},
    entries.map(([term, meaning]) => [element("dt", {}, term), element("dd", {}, meaning)]),
  );
}

/** Names and values in a line: [[name, value]], and whatever else belongs there. */
export function facts_line(facts, ...more) {
  return element(
    "dl",
    { class: "facts" },
    facts.map(([name, value]) => element("div", {}, element("dt", {}, name), element("dd", {}, value))),
    more,
  );
}

export function button(label, title, action, attributes = {}) {
  return element("button", { type: "button", title, onclick: action, ...attributes }, label);
}

/** A box with a tick that calls `action(checked)`. */
export function checkbox(label, checked, action, attributes = {}) {
  const input = element("input", { type: "checkbox", checked, onchange: () => action(input.checked), ...attributes });
  return element("label", { class: "choice" }, input, ` ${label}`);
}
