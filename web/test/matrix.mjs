// Just enough dense algebra to make realistic data for the page: rows of rows, no error handling.

export function random_normal(seed) {
  let state = seed >>> 0;
  const uniform = () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296 + 1e-12;
  };
  return () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

export const zeros = (rows, columns) => Array.from({ length: rows }, () => new Array(columns).fill(0));
export const diagonal = (values) => values.map((value, i) => values.map((_, j) => (i === j ? value : 0)));
export const transpose = (a) => a[0].map((_, j) => a.map((row) => row[j]));
export const multiply = (a, b) =>
  a.map((row) => b[0].map((_, j) => row.reduce((sum, value, k) => sum + value * b[k][j], 0)));
export const apply = (a, x) => a.map((row) => row.reduce((sum, value, k) => sum + value * x[k], 0));
export const add = (a, b, scale = 1) => a.map((row, i) => row.map((value, j) => value + scale * b[i][j]));
export const subtract = (x, y) => x.map((value, i) => value - y[i]);
export const standard_deviations = (covariance) => covariance.map((row, i) => Math.sqrt(Math.max(0, row[i])));

export function mean_of(rows) {
  return rows[0].map((_, j) => rows.reduce((sum, row) => sum + row[j], 0) / rows.length);
}

export function covariance_of(rows) {
  const centred = rows.map((row) => subtract(row, mean_of(rows)));
  return multiply(transpose(centred), centred).map((row) => row.map((value) => value / (rows.length - 1)));
}

export function inverse(a) {
  const n = a.length;
  const work = a.map((row, i) => [...row, ...row.map((_, j) => (i === j ? 1 : 0))]);
  for (let column = 0; column < n; column += 1) {
    let pivot = column;
    for (let i = column; i < n; i += 1) if (Math.abs(work[i][column]) > Math.abs(work[pivot][column])) pivot = i;
    [work[column], work[pivot]] = [work[pivot], work[column]];
    const scale = work[column][column];
    work[column] = work[column].map((value) => value / scale);
    for (let i = 0; i < n; i += 1) {
      if (i === column) continue;
      const factor = work[i][column];
      work[i] = work[i].map((value, j) => value - factor * work[column][j]);
    }
  }
  return work.map((row) => row.slice(n));
}

export function cholesky(a) {
  const lower = zeros(a.length, a.length);
  a.forEach((row, i) => {
    for (let j = 0; j <= i; j += 1) {
      const rest = row[j] - lower[i].slice(0, j).reduce((sum, value, k) => sum + value * lower[j][k], 0);
      lower[i][j] = i === j ? Math.sqrt(Math.max(rest, 1e-14)) : rest / lower[j][j];
    }
  });
  return lower;
}

/** Eigenvalues of a symmetric matrix, ascending, by Jacobi rotations; the vectors are columns. */
export function eigen(symmetric) {
  const a = symmetric.map((row) => [...row]);
  const n = a.length;
  const v = diagonal(new Array(n).fill(1));
  for (let sweep = 0; sweep < 30; sweep += 1) {
    for (let p = 0; p < n; p += 1) {
      for (let q = p + 1; q < n; q += 1) {
        if (Math.abs(a[p][q]) < 1e-300) continue;
        const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const t = Math.sign(theta || 1) / (Math.abs(theta) + Math.hypot(theta, 1));
        const c = 1 / Math.hypot(t, 1);
        const s = t * c;
        for (let k = 0; k < n; k += 1) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
        for (let k = 0; k < n; k += 1) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
        for (let k = 0; k < n; k += 1) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
      }
    }
  }
  const order = a.map((row, i) => i).sort((i, j) => a[i][i] - a[j][j]);
  return { values: order.map((i) => a[i][i]), vectors: v.map((row) => order.map((i) => row[i])) };
}

const ranks = (values) => {
  const order = values.map((_, i) => i).sort((i, j) => values[i] - values[j]);
  const rank = new Array(values.length);
  order.forEach((i, position) => {
    rank[i] = position;
  });
  return rank;
};

/** [parameter][output] */
export function spearman(x, y) {
  const columns = (rows) => transpose(rows).map(ranks);
  const correlation = (a, b) =>
    covariance_of(transpose([a, b]))[0][1] /
    Math.sqrt(covariance_of(transpose([a, b]))[0][0] * covariance_of(transpose([a, b]))[1][1]);
  return columns(x).map((a) => columns(y).map((b) => correlation(a, b)));
}

export function ellipses_of(mean, covariance) {
  return mean.flatMap((_, i) =>
    mean.slice(i + 1).map((__, k) => {
      const j = i + 1 + k;
      const [xx, xy, yy] = [covariance[i][i], covariance[i][j], covariance[j][j]];
      const radius = Math.hypot((xx - yy) / 2, xy);
      return {
        first: i,
        second: j,
        centre: [mean[i], mean[j]],
        semi_major: 2 * Math.sqrt((xx + yy) / 2 + radius),
        semi_minor: 2 * Math.sqrt(Math.max(0, (xx + yy) / 2 - radius)),
        angle: 0.5 * Math.atan2(2 * xy, xx - yy),
      };
    }),
  );
}
