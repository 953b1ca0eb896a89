// A model at rest, every element coloured by what the best candidate that acts on it explains.
import { colour_at, css_colour } from "./colour_scale.js";
import { button, element } from "./dom.js";
import { save_canvas } from "./export.js";
import { frame } from "./figure.js";
import { draw_overlay, draw_part } from "./overlay.js";
import { edge, sequential } from "./palette.js";
import { open_scene, scenes } from "./shape_viewer.js";
import { on_theme_change, printed_width, with_light_theme } from "./theme.js";
import { Viewpoint, project, views } from "./viewpoint.js";

const id = "explained-model";
const title = "Where the candidates act";
const caption =
  "Coloured by the increase of the log-likelihood, the largest of all candidates that act on an element; rings: joints and masses. " +
  "Green: the elements of the candidate that is chosen.";
const joint_radius = 5.5; // CSS pixels

/** The largest share of the parts at each node, as the first component of a shape: scenes colour by its length. */
function shares_at_nodes({ parts, count }, shares) {
  const values = new Float32Array(3 * count);
  for (const { name, triangles, edges, points } of parts) {
    const share = shares.get(name) ?? 0;
    for (const nodes of [triangles, edges, points]) {
      for (const node of nodes) values[3 * node] = Math.max(values[3 * node], share);
    }
  }
  return values;
}

class ColouredModel {
  constructor(structure, shares, chosen) {
    Object.assign(this, { id, structure, shares });
    this.part = structure.parts.find(({ name }) => name === chosen) ?? null;
    this.values = shares_at_nodes(structure, shares);
    this.size = { width: 1, height: 1, ratio: 1 };
    this.frames = 0;
    Object.assign(this, open_scene(structure));
    this.over = element("canvas", { class: "over", "aria-hidden": "true" });
    this.still = element("canvas", { class: "still", "aria-hidden": "true" });
    this.host = element("div", { class: "plot-area scene-area" }, this.surface, this.over, this.still);
    this.surface.tabIndex = 0;
    this.surface.setAttribute("role", "img");
    this.surface.setAttribute("aria-label", `${title}. ${caption}`);
    this.viewpoint = new Viewpoint(structure, this.surface, () => this.request_frame());
    this.scene.set_shape(this.values);
  }

  start() {
    this.look("Iso");
    this.fit();
    new ResizeObserver(() => this.fit()).observe(this.host);
    on_theme_change(() => this.draw());
    window.matchMedia("print").addEventListener("change", ({ matches }) => matches && this.fill_still());
    window.addEventListener("beforeprint", () => this.fill_still());
    // The plain wheel scrolls the page, as over every plot: only with Ctrl does it reach the controls.
    this.host.addEventListener("wheel", (event) => !event.ctrlKey && event.stopPropagation(), { capture: true });
    this.surface.addEventListener("webglcontextrestored", () => this.request_frame());
    this.draw();
    this.host.dataset.drawn = "true";
    scenes[id] = this;
  }

  fit() {
    const width = Math.max(240, this.host.clientWidth);
    const height = Math.round(Math.min(460, Math.max(260, 0.72 * width)));
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const { size } = this;
    if (width === size.width && height === size.height && ratio === size.ratio) return;
    this.size = { width, height, ratio };
    this.host.style.height = `${height}px`;
    this.viewpoint.fit(width / height);
    this.scene.resize(width, height, ratio);
    this.over.width = width * ratio;
    this.over.height = height * ratio;
    this.draw();
  }

  draw_scene() {
    this.scene.draw(this.viewpoint.camera, { deflection: 0, edge_opacity: 0.25, has_outline: true });
  }

  draw() {
    const { width, height, ratio } = this.size;
    this.draw_scene();
    const context = this.over.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    this.draw_over(context, width, height);
    this.frames += 1;
  }

  /** Joints and masses have no faces: they stand over the drawing, as rings in the colour of their share. */
  draw_over(context, width, height) {
    const places = new Float32Array(this.structure.positions.length);
    project(this.viewpoint.camera, this.structure, this.values, 0, width, height, places);
    if (this.part) draw_part(context, this.part, places);
    context.strokeStyle = edge;
    context.lineWidth = 1;
    for (const { name, points } of this.structure.parts) {
      if (!this.shares.has(name)) continue;
      for (const point of points) {
        context.fillStyle = css_colour(colour_at(sequential, this.values[3 * point]));
        context.beginPath();
        context.arc(places[3 * point], places[3 * point + 1], joint_radius, 0, 2 * Math.PI);
        context.fill();
        context.stroke();
      }
    }
    draw_overlay(context, this.viewpoint.camera, {
      width,
      height,
      title: this.part ? this.part.name : "",
      note: "",
      has_masses: this.structure.points.length > 0,
      quantity: "explained",
    });
  }

  request_frame() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = null;
      this.draw();
    });
  }

  look(name) {
    this.viewpoint.look_from(views[name], 0);
    this.request_frame();
  }

  choose(part) {
    this.part = part;
    this.draw();
  }

  /** The drawing in light colours on white, at any size. */
  picture(width) {
    const height = Math.round((width * this.size.height) / this.size.width);
    const ratio = 2;
    const canvas = element("canvas", { width: width * ratio, height: height * ratio });
    const context = canvas.getContext("2d");
    with_light_theme(() => {
      context.fillStyle = "#ffffff";
      context.fillRect(0, 0, canvas.width, canvas.height);
      this.scene.resize(width, height, ratio);
      this.draw_scene();
      context.drawImage(this.surface, 0, 0, canvas.width, canvas.height);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.draw_over(context, width, height);
    });
    this.scene.resize(this.size.width, this.size.height, this.size.ratio);
    this.draw();
    return canvas;
  }

  /** Paper takes a picture of its own: browsers print what WebGL drew last, or nothing. */
  fill_still() {
    const picture = this.picture(printed_width);
    this.still.width = picture.width;
    this.still.height = picture.height;
    this.still.getContext("2d").drawImage(picture, 0, 0);
  }
}

/** Choice of the candidate whose elements are marked, those that explain most first. */
function candidate_choice(viewer) {
  const parts = viewer.structure.parts
    .filter(({ name }) => viewer.shares.has(name))
    .sort((a, b) => viewer.shares.get(b.name) - viewer.shares.get(a.name));
  const input = element(
    "select",
    { id: "candidate-shown", onchange: () => viewer.choose(parts[Number(input.value)] ?? null) },
    element("option", { value: "-1" }, "none"),
    parts.map((part, k) => element("option", { value: k, selected: part === viewer.part }, part.name)),
  );
  return element("label", { class: "choice" }, "Elements of ", input);
}

/**
 * @param structure  of read_structure(), with parts
 * @param shares     Map: name of a candidate -> share of the best one's increase, 0 to 1
 * @param chosen     the candidate whose elements are marked
 */
export function coloured_model(structure, shares, chosen) {
  const viewer = new ColouredModel(structure, shares, chosen);
  const along = (name) => (name === "Iso" ? "Look from a corner" : `Look along ${name.toLowerCase()}`);
  return frame({
    id,
    title,
    caption,
    controls: [candidate_choice(viewer)],
    tools: [
      ...Object.keys(views).map((name) => button(name, along(name), () => viewer.look(name), { "data-view": name.toLowerCase() })),
      button("PNG", "Save this view as a PNG image", () => save_canvas(id, viewer.picture(1000)), { "data-export": "png" }),
    ],
    host: viewer.host,
    attributes: { "data-scene": id, "data-renderer": viewer.scene.kind },
    start: () => viewer.start(),
  });
}
