// A structure with mode shapes to look at: a plate of quadrilaterals that swings in sines, with a mast of beams and a mass on it.

const base64 = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString("base64");

/** Nodes of the plate row by row, then of the mast from below. */
function mesh(nx, ny, mast) {
  const positions = [];
  for (let j = 0; j <= ny; j += 1) for (let i = 0; i <= nx; i += 1) positions.push((2 * i) / nx, j / ny, 0);
  const at = (i, j) => j * (nx + 1) + i;
  const triangles = [];
  const edges = [];
  for (let j = 0; j < ny; j += 1) {
    for (let i = 0; i < nx; i += 1) {
      triangles.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  for (let j = 0; j <= ny; j += 1) for (let i = 0; i < nx; i += 1) edges.push(at(i, j), at(i + 1, j));
  for (let j = 0; j < ny; j += 1) for (let i = 0; i <= nx; i += 1) edges.push(at(i, j), at(i, j + 1));
  let foot = at(Math.round(nx / 4), Math.round(ny / 2));
  const [x, y] = positions.slice(3 * foot);
  for (let k = 1; k <= mast; k += 1) {
    positions.push(x, y, (0.5 * k) / mast);
    edges.push(foot, positions.length / 3 - 1);
    foot = positions.length / 3 - 1;
  }
  return { positions, triangles, edges, tip: foot, plate: (nx + 1) * (ny + 1) };
}

/** sin sin of a supported plate, its slope carried up the mast; largest displacement 1. */
function shape_of({ positions, plate, tip }, m, n) {
  const sine = (x, y) => Math.sin((m * Math.PI * x) / 2) * Math.sin(n * Math.PI * y);
  const shape = new Float32Array(positions.length);
  const [x, y] = positions.slice(3 * tip);
  const slope = ((m * Math.PI) / 2) * Math.cos((m * Math.PI * x) / 2) * Math.sin(n * Math.PI * y);
  for (let i = 0; i < positions.length / 3; i += 1) {
    shape[3 * i + 2] = sine(positions[3 * i], positions[3 * i + 1]);
    if (i >= plate) shape[3 * i] = -slope * positions[3 * i + 2];
  }
  let largest = 0;
  for (let i = 0; i < shape.length; i += 3) largest = Math.max(largest, Math.hypot(...shape.subarray(i, i + 3)));
  return shape.map((value) => value / largest);
}

/** The object `modes` of a page: `count` modes of a plate of nx times ny quadrilaterals. */
export function plate_modes(nx, ny, count) {
  const parts = mesh(nx, ny, 5);
  const orders = [1, 2, 3, 4, 5, 6]
    .flatMap((m) => [1, 2, 3, 4].map((n) => ({ m, n, frequency: 1.37 * (m * m + 4 * n * n) })))
    .sort((a, b) => a.frequency - b.frequency)
    .slice(0, count);
  return {
    frequency_unit: "Hz",
    positions: base64(Float32Array.from(parts.positions)),
    node_ids: Array.from({ length: parts.positions.length / 3 }, (_, i) => 101 + i),
    triangles: base64(Uint32Array.from(parts.triangles)),
    edges: base64(Uint32Array.from(parts.edges)),
    points: [parts.tip],
    parameters: [
      { name: "<b>skin</b>", triangles: base64(Uint32Array.from(parts.triangles.slice(0, 60))), edges: "", points: [] },
      { name: "nothing", triangles: "", edges: "", points: [9e9] },
    ],
    list: orders.map(({ m, n, frequency }, k) => ({
      number: k + 1,
      frequency,
      label: `mode ${k + 1}`,
      residual: 3.1e-13 * (k + 1) ** 2,
      note: k === 2 ? "<b>two half waves</b>" : "",
      test: k === 0 ? { nodes: [3, 40], shape: base64(Float32Array.from([0, 0, 0.7, 0.1, 0, 0.4])) } : { nodes: [9e9] },
      shape: base64(shape_of(parts, m, n)),
    })),
  };
}

export function plate_mac(rows, columns) {
  const value = (i, j) => (i === j ? 0.97 - 0.03 * i : Math.abs(i - j) === 1 ? 0.11 : 0.004 * ((i + 2 * j) % 5));
  return {
    rows: Array.from({ length: rows }, (_, i) => `${i + 1}: ${(6.85 * (i + 1)).toFixed(2)} Hz`),
    columns: Array.from({ length: columns }, (_, j) => `test ${j + 1}`),
    row_title: "model",
    column_title: "tests.csv",
    values: Array.from({ length: rows }, (_, i) =>
      Array.from({ length: columns }, (__, j) => (i === 1 && j === columns - 1 ? null : value(i, j))),
    ),
  };
}

/** A page of `mottle modes`. */
export function modes_page(nx, ny, count) {
  return {
    kind: "modes",
    title: "Plate with a mast </script>",
    mottle: "0.1.0",
    source: "plate.bdf",
    units: "SI",
    summary: [
      `${3 * (nx + 1) * (ny + 1)} equations, ${nx * ny} quadrilaterals, 5 beams, 1 mass`,
      `${count} modes, none missed`,
      "note: card `PARAM,POST` has no effect here",
    ],
    modes: plate_modes(nx, ny, count),
    mac: plate_mac(count, count - 1),
  };
}
