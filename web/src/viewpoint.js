// Where the structure is looked at from: an orthographic camera, turned, moved and enlarged by mouse, touch and keyboard.
// Shared by both ways of drawing, with or without WebGL.
import { OrthographicCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

/** Directions to look from; z points up, and along z x runs to the right. */
export const views = {
  X: [1, 0, 0],
  Y: [0, -1, 0],
  Z: [0, 0, 1],
  Iso: [1, -1.3, 0.9],
};

const margin = 1.08;
const keyboard_turn = Math.PI / 36;
const keyboard_zoom = 1.15;

export class Viewpoint {
  constructor({ low, high, centre, size }, surface, on_change) {
    this.size = size;
    this.centre = new Vector3(...centre);
    this.corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
      (bits) => new Vector3(...low.map((value, k) => (bits & (1 << k) ? high[k] : value))),
    );
    this.camera = new OrthographicCamera();
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, surface);
    Object.assign(this.controls, { minZoom: 0.2, maxZoom: 200, zoomToCursor: true });
    this.controls.addEventListener("change", on_change);
    this.half = { width: 1, height: 1 };
    this.aspect = 1;
    surface.addEventListener("keydown", (event) => this.answer_key(event));
  }

  look_from(direction, deflection) {
    const { camera, controls } = this;
    camera.position
      .set(...direction)
      .normalize()
      .multiplyScalar(4 * this.size)
      .add(this.centre);
    // Exactly along the axis of turning there is no sideways: a trifle before it settles x to the right.
    if (direction[0] === 0 && direction[1] === 0) camera.position.y -= 1e-5 * this.size;
    camera.near = 0.01 * this.size;
    camera.far = 8 * this.size;
    camera.zoom = 1;
    controls.target.copy(this.centre);
    this.measure(deflection);
    this.fit(this.aspect);
    controls.update();
  }

  /** Half of what the box measures across the view, with room for the deflection. */
  measure(deflection) {
    this.camera.lookAt(this.centre);
    this.camera.updateMatrixWorld();
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    const reach = (axis) =>
      Math.max(...this.corners.map((corner) => Math.abs(corner.clone().sub(this.centre).dot(axis))));
    const room = 0.7 * deflection + 0.01 * this.size;
    this.half = { width: margin * (reach(right) + room), height: margin * (reach(up) + room) };
  }

  fit(aspect) {
    this.aspect = aspect;
    const height = Math.max(this.half.height, this.half.width / aspect);
    Object.assign(this.camera, { left: -height * aspect, right: height * aspect, top: height, bottom: -height });
    this.camera.updateProjectionMatrix();
  }

  /** CSS pixels that a length of the model takes on a surface of the given height. */
  pixels(length, height) {
    return (length * height * this.camera.zoom) / (this.camera.top - this.camera.bottom);
  }

  answer_key(event) {
    const { controls } = this;
    const act = {
      ArrowLeft: () => controls.rotateLeft(keyboard_turn),
      ArrowRight: () => controls.rotateLeft(-keyboard_turn),
      ArrowUp: () => controls.rotateUp(keyboard_turn),
      ArrowDown: () => controls.rotateUp(-keyboard_turn),
      "+": () => controls.dollyIn(1 / keyboard_zoom),
      "-": () => controls.dollyOut(1 / keyboard_zoom),
    }[event.key];
    if (!act || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    act();
  }
}

/** Screen places [node x (x, y, depth)] in CSS pixels of nodes displaced by `deflection` times the shape. */
export function project(camera, { positions, count }, shape, deflection, width, height, into) {
  camera.updateMatrixWorld();
  const m = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).elements;
  for (let i = 0; i < 3 * count; i += 3) {
    const x = positions[i] + deflection * shape[i];
    const y = positions[i + 1] + deflection * shape[i + 1];
    const z = positions[i + 2] + deflection * shape[i + 2];
    into[i] = (0.5 + 0.5 * (m[0] * x + m[4] * y + m[8] * z + m[12])) * width;
    into[i + 1] = (0.5 - 0.5 * (m[1] * x + m[5] * y + m[9] * z + m[13])) * height;
    into[i + 2] = m[2] * x + m[6] * y + m[10] * z + m[14];
  }
  return into;
}
