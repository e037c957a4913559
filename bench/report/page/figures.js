// Sections, tables and figures of the report, whatever they show. Every number that the page prints of a file carries where it
// stands there (data-json, an RFC 6901 pointer), or of which two it is the ratio (data-over).
const quantile = (sorted, q) => {
  const x = q * (sorted.length - 1), i = Math.floor(x);
  return sorted[i] + (x - i) * ((sorted[i + 1] ?? sorted[i]) - sorted[i]);
};

// a section of the page, if it has something to show
function section(id, title, note, ...children) {
  document.getElementById('nav').append(element('a', {href: '#' + id}, title));
  document.getElementById('main').append(
    element('section', {id}, element('h2', {}, title), element('p', {}, note), ...children));
}

const cells_of = (place) => [...place.querySelectorAll('tr')].map((r) => [...r.children].map((c) => c.textContent));
function table_buttons(place, name) {
  const csv = () => cells_of(place).map((r) => r.map((c) => c === '–' ? '' : /[",]/.test(c) ? `"${c.replaceAll('"', '""')}"` : c).join(',')).join('\n') + '\n';
  const escaped = (c) => c.replace(/[_%&#$]/g, '\\$&').replace('–', '--').replace('∞', '$\\infty$');
  const latex = () => {
    const [head, ...rows] = cells_of(place).map((r) => r.map(escaped).join(' & ') + ' \\\\');
    return `\\begin{tabular}{l${'r'.repeat(cells_of(place)[0].length - 1)}}\n\\hline\n${head}\n\\hline\n${rows.join('\n')}\n\\hline\n\\end{tabular}\n`;
  };
  return [element('button', {onclick: () => save(name + '.csv', 'text/csv', csv())}, 'CSV'),
    element('button', {onclick: () => save(name + '.tex', 'text/plain', latex())}, 'LaTeX')];
}

function ticks([low, high], log) {
  if (log) {
    const all = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high) + 1e-9; ++e) all.push(...(high / low < 8 ? [1, 1.5, 2, 3, 4, 5, 6, 8] : high / low < 200 ? [1, 2, 5] : [1]).map((m) => m * 10 ** e));
    return all.filter((x) => x >= low * .999 && x <= high * 1.001);
  }
  const rough = (high - low) / 6, power = 10 ** Math.floor(Math.log10(rough)), step = power * [1, 2, 5, 10].find((m) => m * power >= rough);
  return Array.from({length: Math.floor((high - low) / step + 1e-9) + 2}, (_, i) => (Math.ceil(low / step - 1e-9) + i) * step).filter((x) => x <= high + 1e-9 * step);
}
// a piece of a line, for a list of names
const sample_of = ({color, dash = []}) => element('svg', {width: 26, height: 10},
  element('line', {x1: 0, x2: 24, y1: 5, y2: 5, stroke: color, 'stroke-width': 2, 'stroke-dasharray': dash.join(' ')}));
const tick_text = (x) => String(Number(x.toPrecision(6)));

// An SVG with axes; draw(c) puts lines, points and boxes into it. rows: names instead of a scale of y.
function chart({title, x, y, width = 690, height = 360, rows}, draw) {
  const left = rows ? Math.min(330, 20 + 6.6 * Math.max(...rows.map((r) => r.length))) : 64, right = 16, top = 26, bottom = 44, h = rows ? top + bottom + 19 * rows.length : height;
  const share = (v, {range: [low, high], log}) => log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low);
  const px = (v) => left + share(v, x) * (width - left - right), py = (v) => rows ? top + 19 * v + 10 : h - bottom - share(v, y) * (h - top - bottom);
  const plot = element('g'), names = [], points = [];
  const svg = element('svg', {viewBox: `0 0 ${width} ${h}`, width, height: h, role: 'img', 'aria-label': title},
    element('text', {x: left, y: 15, 'font-weight': 600}, title), element('text', {x: (left + width - right) / 2, y: h - 6, 'text-anchor': 'middle'}, x.label));
  for (const v of ticks(x.range, x.log).filter((at) => !x.names || at in x.names)) {
    svg.append(element('line', {class: 'grid', x1: px(v), x2: px(v), y1: top, y2: h - bottom}), element('text', {x: px(v), y: h - bottom + 16, 'text-anchor': 'middle'}, x.names ? x.names[v] : tick_text(v)));
  }
  (rows || ticks(y.range, y.log)).forEach((v, i) => {
    const at = rows ? py(i) : py(v);
    svg.append(element('line', {class: 'grid', x1: left, x2: width - right, y1: at, y2: at}), element('text', {x: left - 6, y: at + 4, 'text-anchor': 'end'}, rows ? v : tick_text(v)));
  });
  if (!rows) svg.append(element('text', {x: 14, y: (top + h - bottom) / 2, transform: `rotate(-90 14 ${(top + h - bottom) / 2})`, 'text-anchor': 'middle'}, y.label));
  const inside = ([a, b]) => Number.isFinite(a) && Number.isFinite(b) && (!x.log || a > 0) && (rows || !y.log || b > 0);
  const c = {
    line: (points, {color, dash = []}, name, width_of = 1.6) => {
      plot.append(element('polyline', {points: points.filter((p) => inside(p) && Math.abs(share(p[0], x) - .5) < .7).map(([a, b]) => `${px(a).toFixed(1)},${py(b).toFixed(1)}`).join(' '), fill: 'none', stroke: color,
        'stroke-width': width_of, 'stroke-dasharray': dash.join(' ')}, name && element('title', {}, name)));
      if (name) names.push([name, color, dash]);
    },
    point: ([a, b], {color, hollow, r = 4.5}, name, text, data = {}) => {
      if (!inside([a, b])) return;
      plot.append(element('circle', {cx: px(a), cy: py(b), r, fill: hollow ? 'none' : color, stroke: color, 'stroke-width': 1.6, ...data}, element('title', {}, name)));
      points.push([px(a), py(b), text || '']);
    },
    box: (from, to, row, {color}, thick, name) => plot.append(element('rect', {x: px(from), y: py(row) - thick / 2, width: Math.max(1, px(to) - px(from)), height: thick,
      fill: color, 'fill-opacity': .35, stroke: color}, element('title', {}, name || ''))),
  };
  draw(c);
  const taken = points.map(([a, b]) => [a - 5, b, 10]);  // x, y and width of what no name may cover
  for (const [a, b, text] of points.filter((p) => p[2])) {
    const wide = 6.7 * text.length, end = width - right - wide;
    const free = ([dx, dy]) => a + dx >= left && a + dx <= end && b + dy > top && b + dy < h - bottom && !taken.some(([x0, y0, w]) => Math.abs(y0 - b - dy) < 11 && a + dx < x0 + w && x0 < a + dx + wide);
    const [dx, dy] = [0, 13, -13, 26, -26, 39, -39, 52].flatMap((d) => [[8, d], [-8 - wide, d]]).find(free) ?? [];
    if (dx === undefined) continue;  // its title says it
    taken.push([a + dx, b + dy, wide]);
    plot.append(element('text', {x: dx < 0 ? a - 8 : a + 8, y: b + 4 + dy, 'text-anchor': dx < 0 ? 'end' : 'start'}, text));
  }
  // lines may leave the field; the clip is the field's
  const id = `clip${chart.count = (chart.count || 0) + 1}`, clip = document.createElementNS('http://www.w3.org/2000/svg', 'clipPath');
  clip.setAttribute('id', id), clip.append(element('rect', {x: left, y: top, width: width - left - right, height: h - top - bottom}));
  plot.querySelectorAll('polyline').forEach((p) => p.setAttribute('clip-path', `url(#${id})`));
  svg.append(clip, plot, element('path', {class: 'axis', d: `M${left} ${top}V${h - bottom}H${width - right}`}));
  const file = () => {
    const copy = svg.cloneNode(true);
    copy.prepend(element('style', {}, 'text{font:12px sans-serif}.axis{stroke:#555;fill:none}.grid{stroke:#ccc;stroke-width:.5}'));
    save(title.replace(/\W+/g, '_') + '.svg', 'image/svg+xml', new XMLSerializer().serializeToString(copy).replaceAll('var(--truth)', '#000'));
  };
  const key = element('div', {class: 'note'}, ...names.map(([name, color, dash]) => element('label', {class: 'key'}, sample_of({color, dash}), ' ' + name)));
  return element('div', {class: 'figure'}, svg, key, element('button', {onclick: file}, 'SVG'));
}

const spread_of = (values, log) => {
  const good = values.filter((v) => Number.isFinite(v) && (!log || v > 0)), low = Math.min(...good), high = Math.max(...good);
  return good.length === 0 ? [1, 10] : log ? [low / 1.3, high * 1.3] : range_of(low, high, 1e-9);
};

