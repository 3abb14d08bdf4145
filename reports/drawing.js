// From the numbers in the page to what a canvas of some pixels can show. Nothing here knows the page or uPlot.
'use strict';

const BLOCK = 256;  // values a block of packed numbers, as reports/packed.cc writes them

/** A packed array: { from, step, n }, or blocks of { offset, step: float64, then uint16 a value; 65535 is a gap }. */
function unpack(packed) {
  const values = new Float64Array(packed.n);
  if (packed.q === undefined) {
    for (let i = 0; i < packed.n; ++i) values[i] = packed.from + packed.step * i;
    return values;
  }
  const text = atob(packed.q), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const view = new DataView(bytes.buffer);
  for (let begin = 0, at = 0; begin < packed.n; begin += BLOCK) {
    const offset = view.getFloat64(at, true), step = view.getFloat64(at + 8, true);
    at += 16;
    for (let i = begin; i < Math.min(packed.n, begin + BLOCK); ++i, at += 2) {
      const q = view.getUint16(at, true);
      values[i] = q === 65535 ? NaN : offset + step * q;
    }
  }
  return values;
}

/** The first index with x[i] >= value, of rising x. */
function lowerBound(x, value) {
  let low = 0, high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < value) low = middle + 1; else high = middle;
  }
  return low;
}

/** Where y is least and largest in any range of indices, by levels of FACTOR values: O(log n) instead of O(n). */
class Pyramid {
  static FACTOR = 16;
  constructor(y) {
    this.y = y;
    this.levels = [];  // level k: indices of the least and of the largest of each FACTOR^(k+1) values
    for (let n = y.length, below = null; n > Pyramid.FACTOR; n = below.low.length) {
      const count = Math.ceil(n / Pyramid.FACTOR), low = new Uint32Array(count), high = new Uint32Array(count);
      for (let b = 0; b < count; ++b) {
        const begin = b * Pyramid.FACTOR, end = Math.min(n, begin + Pyramid.FACTOR);
        let l = below ? below.low[begin] : begin, h = below ? below.high[begin] : begin;
        for (let i = begin + 1; i < end; ++i) {
          l = this.pick(l, below ? below.low[i] : i, -1);
          h = this.pick(h, below ? below.high[i] : i, 1);
        }
        low[b] = l;
        high[b] = h;
      }
      below = { low, high };
      this.levels.push(below);
    }
  }
  /** Of two indices that of the larger (sign 1) or smaller (-1) value; gaps lose. */
  pick(a, b, sign) {
    return sign * this.y[b] > sign * this.y[a] || Number.isNaN(this.y[a]) ? b : a;
  }
  /** [index of the least, index of the largest] in begin ... end - 1. */
  extremes(begin, end) {
    let low = begin, high = begin, i = begin;
    while (i < end) {
      let size = 1, level = -1;
      while (level + 1 < this.levels.length && i % (size * Pyramid.FACTOR) === 0 && i + size * Pyramid.FACTOR <= end) {
        size *= Pyramid.FACTOR;
        ++level;
      }
      low = this.pick(low, level < 0 ? i : this.levels[level].low[i / size], -1);
      high = this.pick(high, level < 0 ? i : this.levels[level].high[i / size], 1);
      i += size;
    }
    return [low, high];
  }
}

/** The curve between two abscissae, for so many pixels: every sample, or of each pixel the least and the largest. */
function visible(curve, from, to, pixels) {
  const begin = Math.max(0, lowerBound(curve.x, from) - 1), end = Math.min(curve.x.length, lowerBound(curve.x, to) + 2);
  const x = [], y = [];
  const add = (i) => {
    x.push(curve.x[i]);
    y.push(Number.isNaN(curve.y[i]) ? null : curve.y[i]);
  };
  if (end - begin <= 4 * pixels) {
    for (let i = begin; i < end; ++i) add(i);
    return [x, y];
  }
  curve.pyramid ??= new Pyramid(curve.y);
  for (let p = 0; p < pixels; ++p) {
    const first = begin + Math.floor((end - begin) * p / pixels), last = begin + Math.floor((end - begin) * (p + 1) / pixels);
    const [low, high] = curve.pyramid.extremes(first, last);
    add(Math.min(low, high));
    if (low !== high) add(Math.max(low, high));
  }
  return [x, y];
}

/** The value of a curve at x: of the sample before (hold), or straight between its neighbours. */
function valueAt(curve, x) {
  const n = curve.x.length, i = lowerBound(curve.x, x);
  if (n === 0 || x < curve.x[0] || x > curve.x[n - 1]) return NaN;
  if (curve.x[i] === x) return curve.y[i];
  if (['hold', 'points', 'samples'].includes(curve.style)) return curve.y[i - 1];
  const share = (x - curve.x[i - 1]) / (curve.x[i] - curve.x[i - 1]);
  return curve.y[i - 1] + share * (curve.y[i] - curve.y[i - 1]);
}

/** Least and largest finite value of some arrays; with `positive` of those above zero. */
function extent(arrays, positive) {
  let low = Infinity, high = -Infinity;
  for (const values of arrays) {
    for (const value of values) {
      if (value === null || !Number.isFinite(value) || (positive && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : positive ? [0.1, 1] : [0, 1];
}

/** A little room around a range; of a constant enough to see it as one. */
function roomy([low, high], logarithmic) {
  if (logarithmic) return [10 ** Math.floor(Math.log10(low) + 1e-9), 10 ** Math.ceil(Math.log10(high * 1.01))];
  const room = high > low ? 0.05 * (high - low) : Math.abs(high) || 1;
  return [low - room, high + room];
}

/** A number for people: five digits, an exponent where it would be long. */
function readable(value, digits = 5) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  const size = Math.abs(value);
  const text = Number(value.toPrecision(digits)), long = size !== 0 && (size >= 1e6 || size < 1e-3);
  return (long ? text.toExponential().replace('e+', 'e') : String(text)).replaceAll('-', '−');
}

const withUnit = (label, unit) => unit && unit !== '1' ? `${label} [${unit}]` : label;
