// Colours between the stops of a scale, and the colour of a text that can be read on them.

const channels_of = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

/** Red, green and blue, 0 to 255, at `share` (0 to 1) of a scale of evenly spaced hexadecimal stops. */
export function colour_at(stops, share) {
  const place = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const below = Math.min(stops.length - 2, Math.floor(place));
  const [from, to] = [channels_of(stops[below]), channels_of(stops[below + 1])];
  return from.map((value, k) => value + (place - below) * (to[k] - value));
}

export const css_colour = (channels) => `rgb(${channels.map(Math.round).join(",")})`;

/** Each stop as three numbers from 0 to 1, for a shader. */
export const shader_colours = (stops) => stops.flatMap((stop) => channels_of(stop).map((value) => value / 255));

/** Whether white can be read on the colour better than black. */
export const is_deep = ([red, green, blue]) => 0.299 * red + 0.587 * green + 0.114 * blue < 127;
