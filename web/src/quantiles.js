// Quantiles that the plots need: of the standard normal, and of counts.

/** z with P(N <= z) = p by the rational approximation of Acklam, relative error below 1.2e-9. */
export function normal_quantile(p) {
  if (p <= 0) return -Infinity;
  if (p >= 1) return Infinity;
  if (p > 0.5) return -normal_quantile(1 - p);
  const polynomial = (coefficients, x) => coefficients.reduce((sum, c) => sum * x + c, 0);
  const tail = [
    -7.784894002430293e-3, -0.3223964580411365, -2.400758277161838, -2.549732539343734, 4.374664141464968,
    2.938163982698783,
  ];
  const tail_below = [7.784695709041462e-3, 0.3224671290700398, 2.445134137142996, 3.754408661907416, 1];
  const middle = [
    -39.69683028665376, 220.9460984245205, -275.9285104469687, 138.357751867269, -30.66479806614716, 2.506628277459239,
  ];
  const middle_below = [
    -54.47609879822406, 161.5858368580409, -155.6989798598866, 66.80131188771972, -13.28068155288572, 1,
  ];
  if (p < 0.02425) {
    const q = Math.sqrt(-2 * Math.log(p));
    return polynomial(tail, q) / polynomial(tail_below, q);
  }
  const q = p - 0.5;
  return (polynomial(middle, q * q) * q) / polynomial(middle_below, q * q);
}

/** Fewest and most of `count` that a share `p` gives, each end passed over with (1 - level) / 2 at most. */
export function binomial_range(count, p, level) {
  const tail = (1 - level) / 2;
  let below = 0;
  let term = Math.exp(count * Math.log1p(-p));
  let low = null;
  for (let k = 0; k <= count; k += 1) {
    below += term;
    if (low === null && below > tail) low = k;
    if (below >= 1 - tail) return [low ?? k, k];
    term *= ((count - k) * p) / ((k + 1) * (1 - p));
  }
  return [low ?? count, count];
}
