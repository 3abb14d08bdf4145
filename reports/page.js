// The page: pictures drawn when they come into sight, zoomed together where they share the time of a run, and the theme.
'use strict';

// --- Colours ---------------------------------------------------------------------------------------------------------
const probe = document.body.appendChild(document.createElement('span'));
probe.hidden = true;
const known = new Map();
/** The colour that a CSS variable has at present. */
function colour(name) {
  if (!known.has(name)) {
    probe.style.color = `var(--${name})`;
    known.set(name, getComputedStyle(probe).color);
  }
  return known.get(name);
}
const curveColour = (i) => colour('c' + i % 8);

// --- One picture -----------------------------------------------------------------------------------------------------
/** What a canvas shows of a picture apart from axes and plain curves. `px`, `py` map values to canvas pixels. */
function paintUnder(ctx, chart, px, py) {
  chart.picture.areas.forEach((area, k) => {
    ctx.fillStyle = colour(k % 2 ? 'area2' : 'area');
    ctx.beginPath();
    for (let i = 0; i < area.x.length; ++i) ctx.lineTo(px(area.x[i]), py(area.y[i]));
    ctx.fill();
  });
}
function paintOver(ctx, chart, px, py, box, ratio) {
  ctx.lineWidth = ratio;
  ctx.font = `${11 * ratio}px system-ui, sans-serif`;
  const labelled = [-Infinity, -Infinity];  // how far the labels of each line reach
  for (const mark of [...chart.picture.marks].sort((a, b) => a.at - b.at)) {
    const at = mark.horizontal ? py(mark.at) : px(mark.at);
    if (mark.horizontal ? at < box.top || at > box.top + box.height : at < box.left || at > box.left + box.width) continue;
    ctx.strokeStyle = colour(mark.horizontal ? 'fail' : 'mark');
    ctx.fillStyle = colour(mark.horizontal ? 'fail' : 'dim');
    ctx.setLineDash([5 * ratio, 4 * ratio]);
    ctx.beginPath();
    if (mark.horizontal) {
      ctx.moveTo(box.left, at);
      ctx.lineTo(box.left + box.width, at);
      ctx.textAlign = 'right';
      ctx.fillText(mark.label, box.left + box.width - 4 * ratio, at - 4 * ratio);
    } else {
      ctx.moveTo(at, box.top);
      ctx.lineTo(at, box.top + box.height);
      const wide = ctx.measureText(mark.label).width + 6 * ratio, left = at + wide > box.left + box.width;
      const line = labelled.findIndex((end) => at - (left ? wide : 0) > end);
      if (line >= 0) {  // labels do not run into each other
        ctx.textAlign = left ? 'right' : 'left';
        ctx.fillText(mark.label, at + (left ? -3 : 3) * ratio, box.top + (11 + 13 * line) * ratio);
        labelled[line] = left ? at : at + wide;
      }
    }
    ctx.stroke();
  }
  ctx.setLineDash([]);
  chart.curves.forEach((curve, k) => {
    if (!curve.shown || !chart.byHand(curve)) return;
    ctx.strokeStyle = curveColour(k);
    ctx.lineWidth = 1.6 * ratio;
    const crosses = curve.style === 'crosses', small = ['points', 'samples'].includes(curve.style);
    if (curve.style === 'line' || curve.style === 'dashed') {  // a curve in a plane
      ctx.lineWidth = 1.2 * ratio;
      ctx.beginPath();
      for (let i = 0; i < curve.x.length; ++i) ctx.lineTo(px(curve.x[i]), py(curve.y[i]));
      ctx.stroke();
      return;
    }
    const inSight = new Map();  // one mark a pixel: a campaign has more runs than a picture has room
    let count = 0;
    for (let i = 0; i < curve.x.length; ++i) {
      const x = px(curve.x[i]), y = py(curve.y[i]);
      if (!(x >= box.left - 5 * ratio && x <= box.left + box.width + 5 * ratio) || !Number.isFinite(y)) continue;
      inSight.set(Math.round(x) * 65536 + Math.round(y), [x, y]);
      ++count;
    }
    const crowded = small && count * 5 * ratio > box.width;
    // Samples of a comparison would hide the curve as long as they cannot be told apart.
    if (crowded && curve.style === 'samples') return;
    const size = (crowded ? 1.2 : small ? 2.5 : 5) * ratio;
    ctx.beginPath();
    for (const [x, y] of inSight.values()) {
      if (crosses) {
        ctx.moveTo(x - size, y - size);
        ctx.lineTo(x + size, y + size);
        ctx.moveTo(x - size, y + size);
        ctx.lineTo(x + size, y - size);
      } else {
        ctx.moveTo(x + size, y);
        ctx.arc(x, y, size, 0, 2 * Math.PI);
      }
    }
    ctx.stroke();
  });
}

const MARKERS = ['points', 'samples', 'crosses', 'circles'];  // uPlot draws lines only

/** A picture in its place: its data, its range, its legend. Drawn by uPlot, or plainly where the page has none. */
class Chart {
  constructor(host, picture, group) {
    this.host = host;
    this.picture = picture;
    this.group = picture.course ? group : null;  // charts that show the same stretch of time
    this.curves = picture.curves.map((curve) => ({ ...curve, x: unpack(curve.x), y: unpack(curve.y) }));
    picture.areas = picture.areas.map((area) => ({ ...area, x: unpack(area.x), y: unpack(area.y) }));
    const rises = (x) => x.every((value, i) => i === 0 || value >= x[i - 1]);
    this.plane = !this.curves.every((curve) => rises(curve.x));  // curves that turn back: no function of x
    const areas = this.picture.areas;
    this.allX = extent([...this.curves.map((c) => c.x), ...areas.map((a) => a.x)], false);
    // A mark at the very edge would be cut in two, and a range of nothing shows nothing.
    const marked = this.curves.some((curve) => curve.style === 'points') || this.curves.every((curve) => MARKERS.includes(curve.style));
    if (this.plane || marked || this.allX[0] === this.allX[1]) this.allX = roomy(this.allX, picture.x.log);
    this.allY = null;
    if (this.plane) this.allY = roomy(extent([...this.curves.map((c) => c.y), ...areas.map((a) => a.y)], false));
    this.x = [picture.x.from ?? this.allX[0], picture.x.to ?? this.allX[1]];
    this.y = picture.y.from === undefined ? this.allY : [picture.y.from, picture.y.to ?? this.allY[1]];
    if (this.group && this.group.x && picture.x.from === undefined) this.x = this.group.x;
    this.legend();
    this.canvas = window.uPlot ? new UPlotCanvas(this) : new PlainCanvas(this);
    this.listen();
    host.chart = this;
  }
  get width() { return Math.max(200, this.host.clientWidth); }
  /** Curves that uPlot does not draw itself. */
  byHand(curve) { return this.plane || MARKERS.includes(curve.style); }

  /** Abscissae and ordinates to draw for the present range: one table a curve. */
  tables() {
    const pixels = Math.ceil(2 * this.width * Math.min(2, devicePixelRatio));
    return this.curves.map((curve) => this.byHand(curve) ? [[this.x[0], this.x[1]], [null, null]] : visible(curve, ...this.x, pixels));
  }
  /** The range of the ordinate: chosen, or that of what is in sight. */
  rangeY(tables) {
    if (this.y) return this.y;
    const log = this.picture.y.log, [from, to] = this.x;
    const shown = tables.filter((table, k) => this.curves[k].shown).map((table) => table[1]);
    for (const area of this.picture.areas) shown.push(area.y.filter((y, i) => area.x[i] >= from && area.x[i] <= to));
    this.curves.forEach((curve) => {
      if (!curve.shown || curve.style === 'samples' || !MARKERS.includes(curve.style)) return;
      shown.push(curve.y.filter((y, i) => curve.x[i] >= from && curve.x[i] <= to));
    });
    for (const mark of this.picture.marks) if (mark.horizontal && log) shown.push([mark.at]);
    return roomy(extent(shown, log), log);
  }

  /** Shows a range; the other charts of the group follow. `y` null: as the curves ask for. */
  show(x, y = this.y, alone = false) {
    const least = 1e-9 * (this.allX[1] - this.allX[0]);
    if (!(x[1] - x[0] > least)) return;
    this.x = x;
    this.y = y;
    this.canvas.draw();
    if (!this.group || alone) return;
    this.group.x = x;
    for (const other of this.group.charts) if (other !== this) other.show(x, null, true);
  }
  all() { this.show(this.allX, this.allY); }
  zoom(factor, at = 0.5, atY = 0.5) {
    const scaled = ([a, b], share) => [a + (b - a) * share * (1 - factor), b - (b - a) * (1 - share) * (1 - factor)];
    this.show(this.inside(scaled(this.x, at)), this.plane ? scaled(this.y, atY) : this.y);
  }
  pan(share, shareY = 0) {
    const moved = ([a, b], s) => [a + (b - a) * s, b + (b - a) * s];
    const x = moved(this.x, share);
    if (!this.plane && (x[0] < this.allX[0] || x[1] > this.allX[1])) return;
    this.show(x, this.plane && this.y ? moved(this.y, shareY) : this.y);
  }
  inside(x) { return this.plane ? x : [Math.max(x[0], this.allX[0]), Math.min(x[1], this.allX[1])]; }

  legend() {
    this.list = document.createElement('div');
    this.list.className = 'legend';
    this.values = this.curves.map((curve, k) => {
      const entry = this.list.appendChild(document.createElement('button'));
      entry.type = 'button';
      entry.setAttribute('aria-pressed', curve.shown);
      const swatch = entry.appendChild(document.createElement('span'));
      swatch.className = 'swatch ' + ({ dashed: 'dashed', line: '', hold: '' }[curve.style] ?? 'dotted');
      swatch.style.borderColor = `var(--c${k % 8})`;
      entry.append(curve.label);
      entry.addEventListener('click', () => {
        curve.shown = !curve.shown;
        entry.setAttribute('aria-pressed', curve.shown);
        this.canvas.draw();
      });
      return entry.appendChild(document.createElement('span'));
    });
    this.at = this.list.appendChild(document.createElement('span'));
    this.at.className = 'at';
    for (const [kind, made] of [['PNG', () => asPng(this)], ['CSV', () => new Blob([asCsv(this)], { type: 'text/csv' })]]) {
      const save = this.list.appendChild(document.createElement('button'));
      save.type = 'button';
      save.className = 'save';
      save.textContent = `save ${kind}`;
      save.setAttribute('aria-label', `save ${kind} of ${this.host.getAttribute('aria-label')}`);
      save.addEventListener('click', async () => keep(await made(), `${this.picture.key.replace(/[^\w.-]+/g, '_')}.${kind.toLowerCase()}`));
    }
    this.host.after(this.list);
  }
  /** Values at the pointer, with their units; null where it has left. */
  hover(x, y) {
    const { picture } = this, unit = (axis) => axis.unit === '1' ? '' : ' ' + axis.unit;
    this.at.textContent = x === null ? '' : `${picture.course ? 't' : 'x'} = ${readable(x, 7)}${unit(picture.x)}` +
      (this.plane ? `, y = ${readable(y)}${unit(picture.y)}` : '');
    this.curves.forEach((curve, k) => {
      const value = x === null || this.plane ? NaN : valueAt(curve, x);
      this.values[k].textContent = Number.isNaN(value) ? '' : `: ${readable(value)}${unit(picture.y)}`;
    });
  }

  listen() {
    const { host } = this;
    host.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && document.activeElement !== host) return;  // the page scrolls
      event.preventDefault();
      const box = host.querySelector('.u-over, canvas').getBoundingClientRect();
      this.zoom(event.deltaY < 0 ? 0.8 : 1.25, (event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height);
    }, { passive: false });
    host.addEventListener('dblclick', () => this.all());
    host.addEventListener('pointerdown', () => host.focus({ preventScroll: true }));
    host.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (step && event.shiftKey) this.canvas.moveCursor?.(...step);
      else if (step && (this.plane || step[0])) this.pan(0.1 * step[0], 0.1 * step[1]);
      else if (event.key === '+' || event.key === '=') this.zoom(0.8);
      else if (event.key === '-') this.zoom(1.25);
      else if (event.key === '0' || event.key === 'Home') this.all();
      else return;
      event.preventDefault();
    });
    new ResizeObserver(() => {
      if (this.width !== this.canvas.width) this.canvas.resize();
    }).observe(host);
  }
}

// --- Saving ----------------------------------------------------------------------------------------------------------
function keep(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
/** What is in sight: the picture with its title above and the names of its curves below. */
function asPng(chart) {
  const drawn = chart.host.querySelector('canvas'), ratio = drawn.width / drawn.clientWidth, line = 20 * ratio;
  const sheet = document.createElement('canvas'), ctx = sheet.getContext('2d');
  sheet.width = drawn.width;
  sheet.height = drawn.height + 2 * line;
  ctx.fillStyle = colour('card');
  ctx.fillRect(0, 0, sheet.width, sheet.height);
  ctx.drawImage(drawn, 0, line);
  const write = (text, x, y, ink) => {
    ctx.fillStyle = colour(ink);
    ctx.fillText(text, x, y);
    return x + ctx.measureText(text).width + 12 * ratio;
  };
  ctx.font = `600 ${13 * ratio}px system-ui, sans-serif`;
  write(chart.host.getAttribute('aria-label'), 8 * ratio, 15 * ratio, 'text');
  ctx.font = `${12 * ratio}px system-ui, sans-serif`;
  let x = 8 * ratio;
  chart.curves.forEach((curve, k) => {
    if (curve.shown) x = write(`— ${curve.label}`, x, sheet.height - 6 * ratio, 'c' + k % 8);
  });
  return new Promise((done) => sheet.toBlob(done, 'image/png'));
}
/** All samples of the page: two columns for each curve, as each may have times of its own. */
function asCsv(chart) {
  const { picture, curves } = chart, cell = (text) => `"${text.replace(/"/g, '""')}"`;
  const head = curves.flatMap((curve) => [cell(withUnit(picture.x.label, picture.x.unit)), cell(withUnit(curve.label, picture.y.unit))]);
  const rows = [head];
  const number = (values, i) => i < values.length && Number.isFinite(values[i]) ? String(values[i]) : '';
  for (let i = 0; i < Math.max(...curves.map((curve) => curve.x.length)); ++i)
    rows.push(curves.flatMap((curve) => [number(curve.x, i), number(curve.y, i)]));
  return rows.map((row) => row.join(',')).join('\r\n') + '\r\n';
}

const HEIGHT = 270;

class UPlotCanvas {
  constructor(chart) {
    this.chart = chart;
    const { picture, curves } = chart;
    const axis = (label, more) => ({
      label, labelSize: 18, labelGap: 2, labelFont: '12px system-ui, sans-serif', font: '11px system-ui, sans-serif',
      stroke: () => colour('text'), grid: { stroke: () => colour('grid'), width: 1 },
      ticks: { stroke: () => colour('grid'), width: 1, size: 5 },
      values: (u, ticks) => ticks.map((tick) => tick === null ? '' : readable(tick, 6)), ...more,
    });
    // Over many decades only these are marked.
    const decades = (u, i, low, high) => Array.from({ length: Math.round(Math.log10(high / low)) + 1 }, (_, k) => low * 10 ** k);
    const onto = (u, paint, ...more) => {
      const { ctx } = u, box = u.bbox;
      ctx.save();
      ctx.beginPath();
      ctx.rect(box.left, box.top, box.width, box.height);
      ctx.clip();
      paint(ctx, chart, (x) => u.valToPos(x, 'x', true), (y) => u.valToPos(y, 'y', true), ...more);
      ctx.restore();
    };
    const dash = { dashed: [6, 4] };
    this.plot = new uPlot({
      width: chart.width, height: HEIGHT, legend: { show: false }, pxAlign: 1,
      scales: {
        x: { time: false, distr: picture.x.log ? 3 : 1, range: () => chart.x },
        y: { distr: picture.y.log ? 3 : 1, range: () => this.y },
      },
      axes: [
        axis(withUnit(picture.x.label, picture.x.unit), { size: 32, space: 60 }),
        axis(withUnit(picture.y.label, picture.y.unit), {
          size: (u, texts) => 18 + 6.2 * Math.max(3, ...(texts ?? []).map((text) => text.length)), space: 28,
          ...(picture.y.log ? { splits: decades, filter: (u, ticks) => {
            const every = Math.ceil(ticks.length / 8);
            return ticks.map((tick, k) => k % every ? null : tick);
          } } : {}),
        }),
      ],
      series: [{}, ...curves.map((curve, k) => ({
        label: curve.label, show: curve.shown, stroke: () => curveColour(k), width: 1.3, dash: dash[curve.style], points: { show: false },
        paths: curve.style === 'hold' ? uPlot.paths.stepped({ align: 1 }) : undefined,
      }))],
      cursor: {
        drag: { x: true, y: chart.plane, setScale: false }, points: { show: false },
        sync: chart.group ? { key: chart.group.key, scales: ['x', null], setSeries: false } : undefined,
      },
      hooks: {
        drawAxes: [(u) => onto(u, paintUnder)],
        draw: [(u) => onto(u, paintOver, u.bbox, devicePixelRatio)],
        setCursor: [(u) => {
          const { left, top } = u.cursor, off = left === null || left < 0;
          chart.hover(off ? null : u.posToVal(left, 'x'), off ? null : u.posToVal(top, 'y'));
        }],
        setSelect: [(u) => {
          const { left, top, width, height } = u.select;
          if (width < 4) return;
          const x = [u.posToVal(left, 'x'), u.posToVal(left + width, 'x')];
          const y = chart.plane ? [u.posToVal(top + height, 'y'), u.posToVal(top, 'y')] : null;
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          chart.show(chart.inside(x), y);
        }],
      },
    }, this.data(), chart.host);
  }
  data() {
    const tables = this.chart.tables();
    this.width = this.chart.width;
    this.y = this.chart.rangeY(tables);
    return uPlot.join(tables);
  }
  draw() {
    const data = this.data();
    this.chart.curves.forEach((curve, k) => { this.plot.series[k + 1].show = curve.shown; });
    this.plot.setData(data);
  }
  resize() {
    this.plot.setSize({ width: this.chart.width, height: HEIGHT });
    this.draw();
  }
  moveCursor(right, up) {
    const { left, top } = this.plot.cursor, box = this.plot.over;
    const start = left === null || left < 0 ? [box.clientWidth / 2, box.clientHeight / 2] : [left, top];
    this.plot.setCursor({ left: start[0] + 4 * right, top: start[1] - 4 * up });
  }
}

/** Frame, ticks and curves on a canvas, for pages without uPlot: no values at the pointer, else the same. */
class PlainCanvas {
  constructor(chart) {
    this.chart = chart;
    this.canvas = chart.host.appendChild(document.createElement('canvas'));
    this.draw();
  }
  resize() { this.draw(); }
  draw() {
    const { chart } = this, { picture } = chart, ratio = devicePixelRatio, ctx = this.canvas.getContext('2d');
    this.width = chart.width;
    this.canvas.width = this.width * ratio;
    this.canvas.height = HEIGHT * ratio;
    this.canvas.style.width = '100%';
    const tables = chart.tables(), [x0, x1] = chart.x, [y0, y1] = chart.rangeY(tables);
    const box = { left: 70 * ratio, top: 8 * ratio, width: (this.width - 80) * ratio, height: (HEIGHT - 55) * ratio };
    const part = (a, b, log) => log ? (v) => Math.log(v / a) / Math.log(b / a) : (v) => (v - a) / (b - a);
    const sx = part(x0, x1, picture.x.log), sy = part(y0, y1, picture.y.log);
    const px = (v) => box.left + box.width * sx(v), py = (v) => box.top + box.height * (1 - sy(v));
    ctx.font = `${11 * ratio}px system-ui, sans-serif`;
    const ticks = (a, b, log) => {
      if (log) return Array.from({ length: 40 }, (_, i) => 10 ** (Math.ceil(Math.log10(a)) + i)).filter((v) => v <= b);
      const rough = (b - a) / 6, power = 10 ** Math.floor(Math.log10(rough));
      const step = power * [1, 2, 5, 10].find((m) => m * power >= rough);
      return Array.from({ length: 12 }, (_, i) => (Math.ceil(a / step) + i) * step).filter((v) => v <= b);
    };
    const line = (points) => {
      ctx.beginPath();
      for (const [x, y] of points) ctx.lineTo(x, y);
      ctx.stroke();
    };
    ctx.strokeStyle = colour('grid');
    ctx.fillStyle = colour('text');
    ctx.lineWidth = ratio;
    ctx.textAlign = 'center';
    for (const v of ticks(x0, x1, picture.x.log)) {
      line([[px(v), box.top], [px(v), box.top + box.height]]);
      ctx.fillText(readable(v, 4), px(v), box.top + box.height + 14 * ratio);
    }
    ctx.fillText(withUnit(picture.x.label, picture.x.unit), box.left + box.width / 2, box.top + box.height + 32 * ratio);
    ctx.textAlign = 'right';
    for (const v of ticks(y0, y1, picture.y.log)) {
      line([[box.left, py(v)], [box.left + box.width, py(v)]]);
      ctx.fillText(readable(v, 4), box.left - 5 * ratio, py(v) + 4 * ratio);
    }
    ctx.save();
    ctx.translate(11 * ratio, box.top + box.height / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.textAlign = 'center';
    ctx.fillText(withUnit(picture.y.label, picture.y.unit), 0, 0);
    ctx.restore();
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.left, box.top, box.width, box.height);
    ctx.clip();
    paintUnder(ctx, chart, px, py);
    chart.curves.forEach((curve, k) => {
      if (!curve.shown || chart.byHand(curve)) return;
      ctx.strokeStyle = curveColour(k);
      ctx.lineWidth = 1.3 * ratio;
      ctx.setLineDash(curve.style === 'dashed' ? [6 * ratio, 4 * ratio] : []);
      const [x, y] = tables[k], points = [];
      x.forEach((v, i) => {
        if (curve.style === 'hold' && i > 0) points.push([px(v), py(y[i - 1])]);
        points.push([px(v), py(y[i])]);
      });
      line(points);
    });
    ctx.setLineDash([]);
    paintOver(ctx, chart, px, py, box, ratio);
    ctx.restore();
  }
}

// --- The page --------------------------------------------------------------------------------------------------------
const charts = [];
for (const data of document.querySelectorAll('script.data')) {
  const hosts = document.querySelectorAll(`.plot[data-set="${data.id}"]`);
  const group = { key: data.id, charts: [], x: null };
  let pictures = null;
  for (const host of hosts) {
    host.drawNow = () => {
      if (host.chart) return;
      pictures ??= JSON.parse(data.textContent);
      const chart = new Chart(host, pictures[host.dataset.picture], group);
      charts.push(chart);
      if (chart.group) group.charts.push(chart);
    };
  }
}
const eye = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    if (!entry.isIntersecting) continue;
    eye.unobserve(entry.target);
    entry.target.drawNow();
  }
}, { rootMargin: '300px' });
for (const host of document.querySelectorAll('.plot')) eye.observe(host);
const unfolded = () => [...document.querySelectorAll('.plot')].filter((host) => !host.closest('details:not([open])'));
// A few are drawn at once: what turns a page into a picture does not scroll.
if (unfolded().length <= 30) for (const host of unfolded()) host.drawNow();

function redrawAll() {
  known.clear();
  for (const chart of charts) chart.canvas.draw();
}
const root = document.documentElement, dark = matchMedia('(prefers-color-scheme: dark)');
document.getElementById('theme').addEventListener('click', () => {
  const now = root.dataset.theme ?? (dark.matches ? 'dark' : 'light');
  root.dataset.theme = now === 'dark' ? 'light' : 'dark';
  redrawAll();
});
dark.addEventListener('change', redrawAll);

// Of many scenarios those that are looked for: by words of their name, title or worst check, and by verdict.
// Wide tables become cards where there is no room for their columns (page.css).
for (const table of document.querySelectorAll('.table table')) {
  const names = [...table.querySelectorAll('thead th')].map((cell) => cell.textContent);
  if (names.length < 4) continue;
  table.classList.add('wide');
  for (const row of table.tBodies[0].rows) [...row.cells].forEach((cell, i) => { cell.dataset.column = names[i] ?? ''; });
}

const filter = document.getElementById('filter');
filter?.addEventListener('input', () => {
  const words = filter.querySelector('input').value.toLowerCase().split(/\s+/), verdict = filter.querySelector('select').value;
  for (const row of document.querySelectorAll('#overview tbody tr')) {
    const part = document.getElementById(decodeURIComponent(row.querySelector('a').hash.slice(1)));
    const text = (row.textContent + part.querySelector('summary').textContent).toLowerCase();
    row.hidden = part.hidden = (verdict && part.dataset.verdict !== verdict) || !words.every((word) => text.includes(word));
  }
});

// On paper: light, and every picture of what is open.
let before;
addEventListener('beforeprint', () => {
  before = root.dataset.theme;
  root.dataset.theme = 'light';
  for (const host of unfolded()) host.drawNow();
  redrawAll();
});
addEventListener('afterprint', () => {
  if (before) root.dataset.theme = before; else delete root.dataset.theme;
  redrawAll();
});

/** A link to a part opens it. */
function openTarget() {
  const part = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (!part) return;
  for (let at = part; at; at = at.parentElement) if (at.tagName === 'DETAILS') at.open = true;
  part.scrollIntoView();
}
addEventListener('hashchange', openTarget);
openTarget();
