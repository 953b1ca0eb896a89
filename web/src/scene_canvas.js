// The structure drawn without WebGL, on a canvas in two dimensions: faces from back to front, or only lines where there are
// too many faces to sort and fill while it moves.
import { colour_at, css_colour } from "./colour_scale.js";
import { bound, edge, muted, sequential } from "./palette.js";
import { project } from "./viewpoint.js";

const faces_at_most = 8000;
const levels = 24; // of colour

function level_colours() {
  return Array.from({ length: levels }, (_, k) => css_colour(colour_at(sequential, k / (levels - 1))));
}

/** Colour level of each group of `size` nodes by its mean displacement. */
function levels_of(indices, size, shape) {
  const magnitude = (node) => Math.hypot(shape[3 * node], shape[3 * node + 1], shape[3 * node + 2]);
  return Uint8Array.from({ length: indices.length / size }, (_, k) => {
    let sum = 0;
    for (let i = 0; i < size; i += 1) sum += magnitude(indices[size * k + i]);
    return Math.min(levels - 1, Math.round((sum / size) * (levels - 1)));
  });
}

function line_path(context, pairs, places, wanted = () => true) {
  context.beginPath();
  for (let i = 0; i < pairs.length; i += 2) {
    if (!wanted(i / 2)) continue;
    context.moveTo(places[3 * pairs[i]], places[3 * pairs[i] + 1]);
    context.lineTo(places[3 * pairs[i + 1]], places[3 * pairs[i + 1] + 1]);
  }
}

/** Beams get a darker border, so that one at rest stands out from a pale page. */
function border_of_lines(context, pairs, places) {
  context.strokeStyle = edge;
  context.globalAlpha = 0.5;
  context.lineWidth = 4.2;
  line_path(context, pairs, places);
  context.stroke();
  context.globalAlpha = 1;
}

function coloured_lines(context, pairs, places, level, width) {
  context.lineWidth = width;
  level_colours().forEach((colour, k) => {
    context.strokeStyle = colour;
    line_path(context, pairs, places, (i) => level[i] === k);
    context.stroke();
  });
}

/** Positions of triangles in their list, farthest first. */
function from_back_to_front(triangles, places) {
  const depth = new Float32Array(triangles.length / 3);
  for (let i = 0; i < triangles.length; i += 1) depth[Math.floor(i / 3)] += places[3 * triangles[i] + 2];
  return Uint32Array.from(depth.keys()).sort((a, b) => depth[b] - depth[a]);
}

function faces(context, { triangles, face_sides }, places, level, edge_opacity) {
  const colours = level_colours();
  context.lineJoin = "round";
  const corner = (triangle, k) => {
    const node = 3 * triangles[3 * triangle + (k % 3)];
    return [places[node], places[node + 1]];
  };
  for (const triangle of from_back_to_front(triangles, places)) {
    context.beginPath();
    context.moveTo(...corner(triangle, 0));
    context.lineTo(...corner(triangle, 1));
    context.lineTo(...corner(triangle, 2));
    context.closePath();
    context.fillStyle = colours[level[triangle]];
    context.strokeStyle = colours[level[triangle]]; // closes the hair that smoothing leaves between neighbours
    context.lineWidth = 0.8;
    context.fill();
    context.stroke();
    if (edge_opacity === 0 || !face_sides[triangle]) continue;
    context.beginPath();
    for (let k = 0; k < 3; k += 1) {
      if (!(face_sides[triangle] & (1 << k))) continue;
      context.moveTo(...corner(triangle, k));
      context.lineTo(...corner(triangle, k + 1));
    }
    context.strokeStyle = edge;
    context.globalAlpha = edge_opacity;
    context.stroke();
    context.globalAlpha = 1;
  }
}

export function canvas_scene(canvas, structure) {
  const context = canvas.getContext("2d");
  const places = new Float32Array(structure.positions.length);
  const is_filled = structure.triangles.length <= 3 * faces_at_most;
  const lines = is_filled ? structure.loose : structure.edges;
  let size = { width: 1, height: 1 };
  let shape = places;
  let face_levels = new Uint8Array(0);
  let line_levels = new Uint8Array(0);
  return {
    kind: "canvas",
    resize(width, height, ratio) {
      size = { width, height };
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
    },
    set_shape(values) {
      shape = values;
      face_levels = is_filled ? levels_of(structure.triangles, 3, shape) : face_levels;
      line_levels = levels_of(lines, 2, shape);
    },
    draw(camera, { deflection, edge_opacity, has_outline }) {
      context.clearRect(0, 0, size.width, size.height);
      if (has_outline) {
        project(camera, structure, shape, 0, size.width, size.height, places);
        context.strokeStyle = muted;
        context.globalAlpha = 0.75;
        context.lineWidth = 0.8;
        line_path(context, structure.outline, places);
        context.stroke();
        context.globalAlpha = 1;
      }
      project(camera, structure, shape, deflection, size.width, size.height, places);
      if (is_filled) faces(context, structure, places, face_levels, edge_opacity);
      if (is_filled) border_of_lines(context, lines, places);
      coloured_lines(context, lines, places, line_levels, is_filled ? 3 : 1);
      context.fillStyle = bound;
      for (const node of structure.points) {
        context.beginPath();
        context.arc(places[3 * node], places[3 * node + 1], 4.5, 0, 2 * Math.PI);
        context.fill();
      }
    },
  };
}
