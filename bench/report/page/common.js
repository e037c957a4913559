'use strict';
// What the report and the live page share: elements, colours that colour-blind eyes tell apart, plots over time.

function element(name, attributes = {}, ...children) {
  const svg = ['svg', 'g', 'line', 'path', 'rect', 'circle', 'text', 'title', 'polyline'].includes(name);
  const e = svg ? document.createElementNS('http://www.w3.org/2000/svg', name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) e.addEventListener(key.slice(2), value);
    else if (value !== undefined && value !== false) e.setAttribute(key, value === true ? '' : value);
  }
  e.append(...children.filter((c) => c !== undefined));
  return e;
}

// after Okabe and Ito; beyond eight, dashed
const COLORS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#8a6d3b', '#7f7f7f'];
const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3]];
const look = (i) => ({color: COLORS[i % 8], dash: DASHES[Math.floor(i / 8) % 4]});
const themed = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function select(label, options, chosen, change) {
  const s = element('select', {'aria-label': label, onchange: () => change(s.value)});
  for (const o of options) s.append(element('option', {value: o, selected: o === chosen}, o));
  return s;
}

function save(name, type, text) {
  const link = element('a', {href: URL.createObjectURL(new Blob([text], {type})), download: name});
  link.click();
  URL.revokeObjectURL(link.href);
}

// the least range [low, high] of a scale: rounding noise of a signal at rest is not blown up to its height
function range_of(low, high, floor) {
  const middle = (low + high) / 2, half = Math.max(0.54 * (high - low), floor / 2);
  return [middle - half, middle + half];
}

// Spans and marks over a plot of time: spans are [from, to] in its scale, marks {t, name, color}.
function draw_over(u, spans, marks) {
  const c = u.ctx, {left, top, width, height} = u.bbox, x = (t) => u.valToPos(t, 'x', true);
  c.save();
  c.beginPath(), c.rect(left, top, width, height), c.clip();
  c.fillStyle = 'rgba(213, 94, 0, .13)';
  for (const [from, to] of spans) c.fillRect(x(from), top, Math.max(2, x(to) - x(from)), height);
  c.font = `${11 * devicePixelRatio}px sans-serif`, c.textAlign = 'left', c.textBaseline = 'alphabetic';
  const rows = [];  // where names end, so that none covers another
  for (const m of marks) {
    if (x(m.t) < left || x(m.t) > left + width) continue;
    c.strokeStyle = c.fillStyle = m.color;
    c.setLineDash([4, 3]), c.lineWidth = devicePixelRatio, c.lineJoin = 'round';
    c.beginPath(), c.moveTo(x(m.t), top), c.lineTo(x(m.t), top + height), c.stroke();
    let row = rows.findIndex((end) => end < x(m.t));
    if (row < 0) row = rows.length;
    if ((row + 1) * 13 * devicePixelRatio < height) {
      const at = [m.name, x(m.t) + 3, top + (row + 1) * 13 * devicePixelRatio];
      c.setLineDash([]), c.lineWidth = 4 * devicePixelRatio, c.strokeStyle = themed('--back'), c.strokeText(...at);  // over curves
      c.fillText(...at);
    }
    rows[row] = x(m.t) + c.measureText(m.name).width + 8;
  }
  c.restore();
}

// the point that has a value and is nearest to point i of a series
function nearest(values, i) {
  for (let k = 0; k < values.length; ++k) {
    for (const at of [i - k, i + k]) if (Number.isFinite(values[at] ?? NaN)) return at;
  }
  return i;
}

// A plot over time. series: {label, color, dash, width, show}; floor: of range_of.
function time_plot(parent, {title, unit, width, height, data, series, x_range, floor, bands, over, sync, select}) {
  const digits = Math.min(9, Math.max(0, Math.ceil(1 - Math.log10(floor))));  // of values at the cursor: a tenth of the floor
  const axis = {stroke: themed('--text'), grid: {stroke: themed('--line'), width: .5}, ticks: {stroke: themed('--line')}};
  return new uPlot({
    title, width, height, bands, legend: {markers: {width: 2, dash: (u, i) => i && series[i - 1].dash?.length ? 'dashed' : 'solid'}},
    cursor: {dataIdx: (u, s, i) => nearest(u.data[s], i), sync: sync && {key: sync}, drag: {x: true, y: false, setScale: !select}},
    scales: {x: {time: false, range: x_range}, y: {range: (u, low, high) => low === null ? [-1, 1] : range_of(low, high, floor)}},
    axes: [{...axis, label: 't [s]', labelSize: 18, size: 34}, {...axis, label: unit, labelSize: 18, size: 76, values: (u, all) => all.map((v) => Number(v.toPrecision(6)).toString())}],
    series: [{label: 't [s]', value: (u, v) => v === null || v === undefined ? '–' : v.toFixed(3)}].concat(series.map((s) => ({
      label: s.label, stroke: s.color, dash: s.dash, width: s.width || 1.2, show: s.show !== false, points: {show: false}, spanGaps: true,
      value: (u, v) => v === null || v === undefined ? '–' : v.toFixed(digits)}))),
    hooks: {draw: [(u) => over && draw_over(u, ...over())],
      setSelect: [(u) => {
        if (!select || !(u.select.width > 0)) return;
        const {left, width: wide} = u.select;
        u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);  // or its bar stays
        select(u.posToVal(left, 'x'), u.posToVal(left + wide, 'x'));
      }]},
  }, data, parent);
}
