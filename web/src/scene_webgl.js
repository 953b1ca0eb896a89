// The structure drawn by three.js in WebGL. Nodes and shape lie in the graphics card; a frame of the animation only sets one
// number, by which the vertex shader displaces every node.
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  GLSL3,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  LineSegments,
  Mesh,
  Points,
  RawShaderMaterial,
  Scene,
  Vector2,
  WebGLRenderer,
} from "three";
import { shader_colours } from "./colour_scale.js";
import { bound, edge, muted, sequential } from "./palette.js";

const beam_width = 4; // CSS pixels
const beam_border = 0.5; // opacity
const mass_size = 9;

const head = `precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform float deflection;
`;

/** `stops` colours of the scale, even steps from no displacement to the largest. */
const colour_of = `uniform vec3 stops[5];
vec3 colour_of(float share) {
  float place = clamp(share, 0.0, 1.0) * 4.0;
  int below = min(int(place), 3);
  return mix(stops[below], stops[below + 1], place - float(below));
}
`;

const displaced_vertex = `${head}
in vec3 position;
in vec3 shape;
uniform float point_size;
out vec3 seen;
out float share;
void main() {
  vec4 place = modelViewMatrix * vec4(position + deflection * shape, 1.0);
  seen = place.xyz;
  share = length(shape);
  gl_PointSize = point_size;
  gl_Position = projectionMatrix * place;
}`;

// Faces have no normals: the shader takes them from the slope of the face on the screen, lit alike from both sides.
const face_fragment = `precision highp float;
in vec3 seen;
in float share;
out vec4 colour;
${colour_of}
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  colour = vec4(colour_of(share) * (0.74 + 0.26 * abs(dot(normal, normalize(vec3(-0.35, 0.5, 0.8))))), 1.0);
}`;

const plain_fragment = `precision highp float;
uniform vec4 paint;
out vec4 colour;
void main() { colour = paint; }`;

const mass_fragment = `precision highp float;
uniform vec4 paint;
out vec4 colour;
void main() {
  if (length(gl_PointCoord - 0.5) > 0.5) discard;
  colour = paint;
}`;

// A beam is a strip of constant width on the screen: WebGL draws lines of one pixel only.
const beam_vertex = `${head}
in vec3 position;
in vec3 start;
in vec3 finish;
in vec3 start_shape;
in vec3 finish_shape;
uniform vec2 viewport;
uniform float width;
out float share;
out float side;
void main() {
  mat4 view = projectionMatrix * modelViewMatrix;
  vec4 from = view * vec4(start + deflection * start_shape, 1.0);
  vec4 to = view * vec4(finish + deflection * finish_shape, 1.0);
  vec2 along = (to.xy - from.xy) * viewport;
  vec2 across = length(along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(0.0);
  gl_Position = mix(from, to, position.x);
  gl_Position.xy += across * position.y * width / viewport;
  share = mix(length(start_shape), length(finish_shape), position.x);
  side = position.y;
}`;

// Darker along both sides, so that a beam at rest stands out from a pale page.
const beam_fragment = `precision highp float;
in float share;
in float side;
uniform vec4 paint;
out vec4 colour;
${colour_of}
void main() {
  colour = vec4(mix(colour_of(share), paint.rgb, paint.a * smoothstep(0.4, 0.7, abs(side))), 1.0);
}`;

function paint_of(hex, opacity) {
  return [...shader_colours([hex]), opacity];
}

/** What every material shares, by reference: setting a value here sets it for all. */
function shared_uniforms() {
  return {
    deflection: { value: 0 },
    stops: { value: [] },
    point_size: { value: mass_size },
    viewport: { value: new Vector2(1, 1) },
    width: { value: beam_width },
  };
}

function material(uniforms, vertexShader, fragmentShader, more = {}) {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    uniforms,
    vertexShader,
    fragmentShader,
    side: DoubleSide,
    ...more,
  });
}

/** Both ends of every beam, node by node, from an array [node x 3]. */
function ends_of(beams, values, which) {
  const ends = new Float32Array((3 * beams.length) / 2);
  for (let i = 0; i < beams.length / 2; i += 1) {
    for (let k = 0; k < 3; k += 1) ends[3 * i + k] = values[3 * beams[2 * i + which] + k];
  }
  return ends;
}

function beam_geometry({ loose, positions }) {
  const geometry = new InstancedBufferGeometry();
  const corners = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.setAttribute("start", new InstancedBufferAttribute(ends_of(loose, positions, 0), 3));
  geometry.setAttribute("finish", new InstancedBufferAttribute(ends_of(loose, positions, 1), 3));
  geometry.setAttribute("start_shape", new InstancedBufferAttribute(new Float32Array((3 * loose.length) / 2), 3));
  geometry.setAttribute("finish_shape", new InstancedBufferAttribute(new Float32Array((3 * loose.length) / 2), 3));
  geometry.instanceCount = loose.length / 2;
  return geometry;
}

/** The drawn parts; nodes and shape are one buffer each, whatever is drawn of them. */
function parts_of(structure, uniforms) {
  const position = new BufferAttribute(structure.positions, 3);
  const shape = new BufferAttribute(new Float32Array(structure.positions.length), 3);
  const indexed = (indices) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", position);
    geometry.setAttribute("shape", shape);
    geometry.setIndex(new BufferAttribute(indices, 1));
    return geometry;
  };
  const painted = (more = {}) => ({ ...uniforms, paint: { value: [0, 0, 0, 1] }, ...more });
  const parts = {
    faces: new Mesh(
      indexed(structure.triangles),
      material(uniforms, displaced_vertex, face_fragment, {
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      }),
    ),
    beams: new Mesh(beam_geometry(structure), material(painted(), beam_vertex, beam_fragment)),
    edges: new LineSegments(
      indexed(structure.face_edges),
      material(painted(), displaced_vertex, plain_fragment, { transparent: true }),
    ),
    outline: new LineSegments(
      indexed(structure.outline),
      material(painted({ deflection: { value: 0 } }), displaced_vertex, plain_fragment, { transparent: true }),
    ),
    masses: new Points(
      indexed(Uint32Array.from(structure.points)),
      material(painted(), displaced_vertex, mass_fragment),
    ),
  };
  return { parts, shape };
}

/** Null where the browser has no WebGL; the canvas can then still be drawn on in two dimensions. */
export function webgl_scene(canvas, structure) {
  const settings = { alpha: true, antialias: true };
  const context = canvas.getContext("webgl2", settings);
  if (!context) return null;
  const renderer = new WebGLRenderer({ canvas, context, ...settings });
  renderer.setClearColor(0, 0);
  const uniforms = shared_uniforms();
  const { parts, shape } = parts_of(structure, uniforms);
  const scene = new Scene();
  for (const part of Object.values(parts)) {
    part.frustumCulled = false; // displaced by the shader, out of three.js's sight
    scene.add(part);
  }
  return {
    kind: "webgl",
    resize(width, height, ratio) {
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height, false);
      uniforms.viewport.value.set(width, height);
      uniforms.point_size.value = mass_size * ratio;
    },
    set_shape(values) {
      shape.array.set(values);
      shape.needsUpdate = true;
      ["start_shape", "finish_shape"].forEach((name, which) => {
        const ends = parts.beams.geometry.getAttribute(name);
        ends.array.set(ends_of(structure.loose, values, which));
        ends.needsUpdate = true;
      });
    },
    draw(camera, { deflection, edge_opacity, has_outline }) {
      uniforms.deflection.value = deflection;
      uniforms.stops.value = shader_colours(sequential);
      parts.edges.material.uniforms.paint.value = paint_of(edge, edge_opacity);
      parts.beams.material.uniforms.paint.value = paint_of(edge, beam_border);
      parts.outline.material.uniforms.paint.value = paint_of(muted, 0.75);
      parts.masses.material.uniforms.paint.value = paint_of(bound, 1);
      parts.edges.visible = edge_opacity > 0;
      parts.outline.visible = has_outline;
      renderer.render(scene, camera);
    },
  };
}
