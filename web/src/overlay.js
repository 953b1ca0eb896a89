// What stands over the drawing of a structure, on the page and in its pictures: the mode's name, the legend, the directions.
import { Vector3 } from "three";
import { accent, bound, font_family, ink, muted, sequential } from "./palette.js";

function legend(context, height, has_masses, quantity) {
  const width = 120;
  const top = height - 30;
  const scale = context.createLinearGradient(12, 0, 12 + width, 0);
  sequential.forEach((colour, k) => scale.addColorStop(k / (sequential.length - 1), colour));
  context.fillStyle = scale;
  context.fillRect(12, top, width, 9);
  context.fillStyle = muted;
  context.font = `11px ${font_family}`;
  context.textAlign = "left";
  context.fillText("0", 12, top + 22);
  context.fillText(quantity, 12, top - 6);
  context.textAlign = "right";
  context.fillText("largest", 12 + width, top + 22);
  if (!has_masses) return;
  context.beginPath();
  context.arc(24 + width, top + 4.5, 4.5, 0, 2 * Math.PI);
  context.fillStyle = bound;
  context.fill();
  context.fillStyle = muted;
  context.textAlign = "left";
  context.fillText("mass", 33 + width, top + 8.5);
}

function directions(context, camera, width, height) {
  const reach = 24;
  const [x, y] = [width - 42, height - 42];
  context.font = `600 11px ${font_family}`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 1.5;
  ["x", "y", "z"].forEach((name, k) => {
    const axis = new Vector3().setComponent(k, 1).transformDirection(camera.matrixWorldInverse);
    const tip = [x + reach * axis.x, y - reach * axis.y];
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(...tip);
    context.strokeStyle = muted;
    context.stroke();
    // An axis that points at the reader has no length: its name then stands beside the origin.
    const length = Math.hypot(axis.x, axis.y);
    const [dx, dy] = length < 0.25 ? [-0.75, -0.75] : [axis.x / length, axis.y / length];
    context.fillStyle = ink;
    context.fillText(name, (length < 0.25 ? x : tip[0]) + 8 * dx, (length < 0.25 ? y : tip[1]) - 8 * dy);
  });
  context.textBaseline = "alphabetic";
}

export function draw_overlay(context, camera, { width, height, title, note, has_masses, quantity = "displacement" }) {
  context.fillStyle = ink;
  context.textAlign = "left";
  context.font = `600 13px ${font_family}`;
  context.fillText(title, 12, 20, width - 24);
  context.fillStyle = muted;
  context.font = `12px ${font_family}`;
  if (note) context.fillText(note, 12, 37, width - 24);
  legend(context, height, has_masses, quantity);
  directions(context, camera, width, height);
}

const part_opacity = 0.4;

/** The elements that a parameter acts on, at `places` of the nodes on the screen [node x (x, y, depth)]. */
export function draw_part(context, { triangles, edges, points }, places) {
  const at = (node) => [places[3 * node], places[3 * node + 1]];
  context.fillStyle = accent;
  context.globalAlpha = part_opacity;
  context.beginPath();
  for (let i = 0; i < triangles.length; i += 3) {
    context.moveTo(...at(triangles[i]));
    context.lineTo(...at(triangles[i + 1]));
    context.lineTo(...at(triangles[i + 2]));
    context.closePath();
  }
  context.fill("nonzero");
  context.globalAlpha = 1;
  context.strokeStyle = accent;
  context.lineWidth = triangles.length ? 1.2 : 5;
  context.beginPath();
  for (let i = 0; i < edges.length; i += 2) {
    context.moveTo(...at(edges[i]));
    context.lineTo(...at(edges[i + 1]));
  }
  context.stroke();
  for (const point of points) {
    context.beginPath();
    context.arc(...at(point), 7, 0, 2 * Math.PI);
    context.fill();
  }
}

/** Rings where the tests have the nodes, each joined to where the model has it. */
export function draw_measured(context, nodes, places, tested) {
  context.strokeStyle = ink;
  context.lineWidth = 1.4;
  for (const node of nodes) {
    const [x, y] = [tested[3 * node], tested[3 * node + 1]];
    context.beginPath();
    context.moveTo(places[3 * node], places[3 * node + 1]);
    context.lineTo(x, y);
    context.stroke();
    context.beginPath();
    context.arc(x, y, 3.4, 0, 2 * Math.PI);
    context.stroke();
  }
}
