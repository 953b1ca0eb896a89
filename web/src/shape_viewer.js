// A structure that swings in a mode shape: the drawing, its moving picture, what can be set about it, its picture as a file.
import { element } from "./dom.js";
import { frame } from "./figure.js";
import { number_text } from "./format.js";
import { draw_measured, draw_overlay, draw_part } from "./overlay.js";
import { canvas_scene } from "./scene_canvas.js";
import { webgl_scene } from "./scene_webgl.js";
import { controls_of, tools_of } from "./shape_controls.js";
import { name_of_mode } from "./structure.js";
import { on_theme_change, printed_width, with_light_theme } from "./theme.js";
import { Viewpoint, project, views } from "./viewpoint.js";

const id = "mode-shapes";
const title = "Mode shape";
const caption =
  "Coloured by displacement, the largest of each mode alike; grey lines: the structure at rest; green, where it is chosen: the " +
  "elements that a parameter acts on; rings: the mean of the tests where it was measured. Amplitude and speed are for the eye, not to scale.";
const standstill = Math.PI / 2; // the phase of the largest deflection
const finest_mesh = 2.5; // CSS pixels from node to node below which edges are not drawn, and from which on they are drawn in full
const coarse_mesh = 10;
const reach_of_pointer = 12; // CSS pixels

/** For tests and for the console, like window.mottle.charts. */
export const scenes = {};

/** The canvas that the structure is drawn on, with WebGL or, where there is none, without. */
export function open_scene(structure) {
  const canvas = () => element("canvas", { class: "scene" });
  const surface = canvas();
  try {
    const scene = webgl_scene(surface, structure);
    if (scene) return { scene, surface };
  } catch {
    // A driver that gives a context and then fails: drawn without it.
  }
  const plain = canvas();
  return { scene: canvas_scene(plain, structure), surface: plain };
}

class ShapeViewer {
  constructor(structure, modes, unit) {
    Object.assign(this, { id, structure, modes, unit });
    this.state = {
      phase: standstill,
      is_playing: false,
      amplitude: 0.08,
      speed: 0.6,
      has_edges: true,
      has_outline: true,
      part: null,
      has_test: true,
    };
    this.mode = modes[0];
    this.shape = structure.shape(this.mode);
    this.size = { width: 1, height: 1, ratio: 1 };
    this.is_visible = true;
    this.frames = 0;
    Object.assign(this, open_scene(structure));
    this.over = element("canvas", { class: "over", "aria-hidden": "true" });
    this.still = element("canvas", { class: "still", "aria-hidden": "true" });
    this.reading = element("p", { class: "node-reading" });
    this.host = element("div", { class: "plot-area scene-area" }, this.surface, this.over, this.still);
    this.surface.tabIndex = 0;
    this.surface.setAttribute("role", "img");
    this.viewpoint = new Viewpoint(structure, this.surface, () => this.request_frame());
    this.measured = structure.measured(this.mode, this.shape);
    this.scene.set_shape(this.shape);
  }

  /** Once the page stands: sizes are known, the drawing begins. */
  start() {
    this.look("Iso");
    this.fit();
    this.follow();
    this.choose(this.mode.index);
    this.host.dataset.drawn = "true";
    if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches) this.play();
    scenes[id] = this;
  }

  follow() {
    new ResizeObserver(() => this.fit()).observe(this.host);
    new IntersectionObserver(([entry]) => {
      this.is_visible = entry.isIntersecting;
      if (this.is_visible) this.request_frame();
    }).observe(this.host);
    on_theme_change(() => this.draw());
    window.matchMedia("print").addEventListener("change", ({ matches }) => matches && this.fill_still());
    window.addEventListener("beforeprint", () => this.fill_still());
    // The plain wheel scrolls the page, as over every plot: only with Ctrl does it reach the controls.
    this.host.addEventListener("wheel", (event) => !event.ctrlKey && event.stopPropagation(), { capture: true });
    this.surface.addEventListener("webglcontextrestored", () => this.request_frame());
    this.surface.addEventListener("pointermove", (event) => event.buttons === 0 && this.read_node(event));
    this.surface.addEventListener("pointerleave", () => this.show_reading(""));
  }

  fit() {
    const width = Math.max(240, this.host.clientWidth);
    const height = Math.round(Math.min(560, Math.max(260, 0.72 * width)));
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

  deflection(phase) {
    return this.state.amplitude * this.structure.size * Math.sin(phase);
  }

  /** Edges fade where the mesh is so fine that they would hide the colours. */
  what_to_draw(phase, height) {
    const pitch = this.viewpoint.pixels(this.structure.pitch, height);
    const share = Math.min(1, (pitch - finest_mesh) / (coarse_mesh - finest_mesh));
    return {
      deflection: this.deflection(phase),
      edge_opacity: this.state.has_edges ? Math.max(0, 0.5 * share) : 0,
      has_outline: this.state.has_outline,
    };
  }

  draw() {
    const { width, height, ratio } = this.size;
    this.scene.draw(this.viewpoint.camera, this.what_to_draw(this.state.phase, height));
    const context = this.over.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    this.draw_overlay(context, width, height);
    this.frames += 1;
  }

  draw_overlay(context, width, height, phase = this.state.phase) {
    this.draw_over_structure(context, width, height, phase);
    draw_overlay(context, this.viewpoint.camera, {
      width,
      height,
      title: name_of_mode(this.mode, this.unit),
      note: this.mode.note,
      has_masses: this.structure.points.length > 0,
    });
  }

  /** Where the nodes are on the screen in a shape. */
  places_of(shape, width, height, phase) {
    const places = new Float32Array(this.structure.positions.length);
    project(this.viewpoint.camera, this.structure, shape, this.deflection(phase), width, height, places);
    return places;
  }

  /** The chosen parameter's elements, and the measured shape, seen through what lies before them. */
  draw_over_structure(context, width, height, phase) {
    const { part, has_test } = this.state;
    const is_compared = has_test && this.measured;
    if (!part && !is_compared) return;
    const places = this.places_of(this.shape, width, height, phase);
    if (part) draw_part(context, part, places);
    if (is_compared) {
      draw_measured(context, this.measured.nodes, places, this.places_of(this.measured.shape, width, height, phase));
    }
  }

  request_frame() {
    if (this.pending) return;
    this.pending = requestAnimationFrame((now) => {
      this.pending = null;
      if (this.state.is_playing) {
        const passed = Math.min(0.1, (now - (this.before ?? now)) / 1000);
        this.state.phase += 2 * Math.PI * this.state.speed * passed;
        this.before = now;
        if (this.is_visible) this.request_frame();
      }
      this.draw();
    });
  }

  play() {
    this.state.is_playing = true;
    this.before = undefined;
    this.play_button.textContent = "❚❚ Pause";
    this.request_frame();
  }

  pause() {
    this.state.is_playing = false;
    this.play_button.textContent = "▶ Play";
  }

  look(name) {
    this.viewpoint.look_from(views[name], this.deflection(standstill));
    this.request_frame();
  }

  set(change) {
    Object.assign(this.state, change);
    if (!this.state.is_playing && "amplitude" in change) this.state.phase = standstill;
    this.request_frame();
  }

  choose(index) {
    this.mode = this.modes[index];
    this.shape = this.structure.shape(this.mode);
    this.measured = this.structure.measured(this.mode, this.shape);
    this.scene.set_shape(this.shape);
    if (!this.state.is_playing) this.state.phase = standstill;
    this.surface.setAttribute("aria-label", `${title}: ${name_of_mode(this.mode, this.unit)}. ${caption}`);
    this.show_reading("");
    this.draw();
  }

  /** The drawing as it stands (as it is most deflected, while it moves) in light colours on white, at any size. */
  picture(width) {
    const height = Math.round((width * this.size.height) / this.size.width);
    const ratio = 2;
    const canvas = element("canvas", { width: width * ratio, height: height * ratio });
    const context = canvas.getContext("2d");
    with_light_theme(() => {
      context.fillStyle = "#ffffff";
      context.fillRect(0, 0, canvas.width, canvas.height);
      this.scene.resize(width, height, ratio);
      const phase = this.state.is_playing ? standstill : this.state.phase;
      this.scene.draw(this.viewpoint.camera, this.what_to_draw(phase, height));
      context.drawImage(this.surface, 0, 0, canvas.width, canvas.height);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.draw_overlay(context, width, height, phase);
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

  read_node({ clientX, clientY }) {
    const { width, height } = this.size;
    const box = this.surface.getBoundingClientRect();
    const places = (this.places = this.places_of(this.shape, width, height, this.state.phase));
    let best = -1;
    let nearest = reach_of_pointer;
    for (let node = 0; node < this.structure.count; node += 1) {
      const distance = Math.hypot(
        places[3 * node] - (clientX - box.left),
        places[3 * node + 1] - (clientY - box.top),
      );
      const is_nearer = distance < nearest - 1.5;
      const is_before = best >= 0 && distance < nearest + 1.5 && places[3 * node + 2] < places[3 * best + 2];
      if (!is_nearer && !is_before) continue;
      best = node;
      nearest = Math.min(nearest, distance);
    }
    this.show_reading(best < 0 ? "" : this.text_of_node(best));
  }

  text_of_node(node) {
    const shape = this.shape.subarray(3 * node, 3 * node + 3);
    const parts = ["x", "y", "z"].map((name, k) => `u${name} ${number_text(shape[k], 3)}`);
    return `Node ${this.structure.node_ids[node] ?? node + 1}: ${parts.join(", ")}`;
  }

  show_reading(text) {
    this.reading.textContent = text || "Point at a node for its displacement; the largest of the mode is 1.";
  }
}

/** @return {element, choose(index)}: the figure, and how to show another of the modes. */
export function shape_viewer(structure, modes, unit) {
  const viewer = new ShapeViewer(structure, modes, unit);
  const node = frame({
    id,
    title,
    caption,
    controls: controls_of(viewer),
    tools: tools_of(viewer),
    host: viewer.host,
    under: [
      viewer.reading,
      viewer.scene.kind === "webgl"
        ? null
        : element(
            "p",
            { class: "note screen-only" },
            "This browser has no WebGL: drawn without it, with fewer details.",
          ),
    ],
    attributes: { "data-scene": id, "data-renderer": viewer.scene.kind },
    start: () => viewer.start(),
  });
  return { element: node, choose: (index) => viewer.choose(index) };
}
