// The structure whose mode shapes a page shows: nodes, faces, edges and shapes as typed arrays, checked against one another.
// What does not fit (an index beyond the nodes, a shape of another length) is left out, so that the drawing never has to ask.
import { is_number, list, number_or_null, record } from "./data.js";
import { number_text } from "./format.js";

const sharp = Math.cos(Math.PI / 6); // faces that meet at more than 30 degrees make an outline

/** Base64 of a little-endian array; whatever is no base64 is empty. */
function array_of(Type, text) {
  let binary = "";
  try {
    binary = typeof text === "string" ? atob(text) : "";
  } catch {
    binary = "";
  }
  const bytes = new Uint8Array(binary.length - (binary.length % Type.BYTES_PER_ELEMENT));
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = binary.charCodeAt(i);
  return new Type(bytes.buffer);
}

/** Groups of `size` indices without those that name a node beyond `count`. */
function groups_within(indices, size, count) {
  const whole = indices.length - (indices.length % size);
  const kept = [];
  for (let i = 0; i < whole; i += size) {
    const group = indices.subarray(i, i + size);
    if (group.every((index) => index < count)) kept.push(...group);
  }
  return Uint32Array.from(kept);
}

/** Shape [node x 3] of a mode, zeros where the data hold none. */
function shape_of(text, count) {
  const shape = array_of(Float32Array, text);
  if (shape.length !== 3 * count) return new Float32Array(3 * count);
  return shape.map((value) => (Number.isFinite(value) ? value : 0));
}

function box_of(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 1) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  return { low, high, centre: low.map((value, k) => (value + high[k]) / 2) };
}

/** Mean length of the edges. */
function pitch_of({ edges, positions }) {
  let sum = 0;
  for (let i = 0; i < edges.length; i += 2) {
    const [a, b] = [3 * edges[i], 3 * edges[i + 1]];
    sum += Math.hypot(...[0, 1, 2].map((k) => positions[a + k] - positions[b + k]));
  }
  return (2 * sum) / (edges.length || 1);
}

/** The modes of a page in their order; `shape()` decodes on demand, as a page may hold many megabytes of them. */
export function read_modes(modes) {
  return list(record(modes).list)
    .map(record)
    .map((mode, position) => ({
      index: position,
      number: is_number(mode.number) ? mode.number : position + 1,
      frequency: number_or_null(mode.frequency),
      residual: number_or_null(mode.residual),
      label: String(mode.label ?? "").trim(),
      note: String(mode.note ?? "").trim(),
      text: mode.shape,
      test: record(mode.test),
    }));
}

/** "Mode 3, 5.65 Hz". */
export function name_of_mode(mode, unit) {
  const name = mode.label || `mode ${mode.number}`;
  const title = name.charAt(0).toUpperCase() + name.slice(1);
  return mode.frequency === null ? title : `${title}, ${number_text(mode.frequency, 5)} ${unit}`;
}

/** The shape as measured: {nodes, shape [node x 3], the model's where nothing was measured}; null where it was not. */
function measured_of({ nodes, shape }, model, count) {
  const values = array_of(Float32Array, shape);
  const known = list(nodes);
  const is_whole = known.length > 0 && values.length === 3 * known.length;
  if (!is_whole || !known.every((node) => Number.isInteger(node) && node >= 0 && node < count)) return null;
  const displaced = Float32Array.from(model);
  known.forEach((node, k) => displaced.set(values.subarray(3 * k, 3 * k + 3), 3 * node));
  return { nodes: known, shape: displaced };
}

/** What a parameter acts on: {name, triangles, edges, points}, as of the structure. */
function part_of({ name, triangles, edges, points }, count) {
  return {
    name: String(name ?? ""),
    triangles: groups_within(array_of(Uint32Array, triangles), 3, count),
    edges: groups_within(array_of(Uint32Array, edges), 2, count),
    points: list(points).filter((index) => Number.isInteger(index) && index >= 0 && index < count),
  };
}

const has_something = ({ triangles, edges, points }) => triangles.length + edges.length + points.length > 0;

/** Null where there is no node to draw. */
export function read_structure(modes) {
  const source = record(modes);
  const all = array_of(Float32Array, source.positions);
  const count = Math.floor(all.length / 3);
  if (count === 0 || !all.every(Number.isFinite)) return null;
  const positions = all.subarray(0, 3 * count);
  const box = box_of(positions);
  const structure = {
    count,
    positions,
    ...box,
    size: Math.hypot(...box.high.map((value, k) => value - box.low[k])) || 1,
    node_ids: list(source.node_ids),
    triangles: groups_within(array_of(Uint32Array, source.triangles), 3, count),
    edges: groups_within(array_of(Uint32Array, source.edges), 2, count),
    points: list(source.points).filter((index) => Number.isInteger(index) && index >= 0 && index < count),
    shape: (mode) => shape_of(mode.text, count),
    measured: (mode, shape) => measured_of(mode.test, shape, count),
    parts: list(source.parameters).map(record).map((part) => part_of(part, count)).filter(has_something),
  };
  return { ...structure, pitch: pitch_of(structure), ...kinds_of_edges(structure) };
}

const key_of = (a, b, count) => (a < b ? a * count + b : b * count + a);

function unit_normal({ positions, triangles }, triangle) {
  const [a, b, c] = triangles.subarray(3 * triangle, 3 * triangle + 3);
  const side = (from, to) => [0, 1, 2].map((k) => positions[3 * to + k] - positions[3 * from + k]);
  const [p, q] = [side(a, b), side(a, c)];
  const normal = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
  const length = Math.hypot(...normal) || 1;
  return normal.map((value) => value / length);
}

/** Sides of the faces: how often each occurs, and whether the faces beside it meet sharply. Orientation does not count. */
function sides_of_faces(structure) {
  const sides = new Map();
  const { triangles, count } = structure;
  for (let triangle = 0; 3 * triangle < triangles.length; triangle += 1) {
    const normal = unit_normal(structure, triangle);
    for (let k = 0; k < 3; k += 1) {
      const key = key_of(triangles[3 * triangle + k], triangles[3 * triangle + ((k + 1) % 3)], count);
      const side = sides.get(key);
      if (!side) {
        sides.set(key, { normal, times: 1, is_sharp: false });
        continue;
      }
      side.times += 1;
      side.is_sharp ||= Math.abs(normal.reduce((sum, value, i) => sum + value * side.normal[i], 0)) < sharp;
    }
  }
  return sides;
}

/**
 * Edges told apart: `loose` belong to no face (beams, rods), `face_edges` do; `outline` say what the structure looks like
 * (loose ones, free borders, ridges; all where there are none of these). `face_sides` has a bit for each side of a triangle
 * that is an edge.
 */
function kinds_of_edges(structure) {
  const { edges, triangles, count } = structure;
  const sides = sides_of_faces(structure);
  const loose = [];
  const face_edges = [];
  const outline = [];
  const keys = new Set();
  for (let i = 0; i < edges.length; i += 2) {
    const pair = [edges[i], edges[i + 1]];
    const key = key_of(...pair, count);
    const side = sides.get(key);
    keys.add(key);
    (side ? face_edges : loose).push(...pair);
    if (!side || side.times !== 2 || side.is_sharp) outline.push(...pair);
  }
  const face_sides = new Uint8Array(triangles.length / 3);
  for (let i = 0; i < triangles.length; i += 1) {
    const next = i % 3 === 2 ? i - 2 : i + 1;
    if (keys.has(key_of(triangles[i], triangles[next], count))) face_sides[Math.floor(i / 3)] |= 1 << (i % 3);
  }
  return {
    loose: Uint32Array.from(loose),
    face_edges: Uint32Array.from(face_edges),
    outline: outline.length ? Uint32Array.from(outline) : edges,
    face_sides,
  };
}
