// The page of tauext-report. Every number that it prints of a file carries where it stands there (data-json, an RFC 6901
// pointer), or of which two it is the ratio (data-over).
const FILES = JSON.parse(document.getElementById('results').textContent);
const METRICS = new Map(JSON.parse(document.getElementById('metrics').textContent).map((m) => [m.key, m]));
const BASELINES = ['zero', 'truth', 'delayed_truth'];
const of_kind = (kind) => FILES.map((f, i) => ({...f, at: `/${i}/data`})).filter((f) => f.kind === kind);
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

// ---- the suite's rows
const ENTRIES = [];
for (const f of of_kind('suite')) {
  const seen = new Map();
  f.data.benchmarks.forEach((b, i) => {
    if (b.run_type === 'aggregate') return;
    const [, group, who] = /^([^/]+\/[^/]+)\/(.*)$/.exec(b.run_name || b.name);
    const key = group + '/' + who;
    if (!seen.has(key)) {
      const [, estimator, detector] = /^(.*?)(?:\+([a-z_].*))?$/i.exec(who);
      seen.set(key, {file: f, at: `${f.at}/benchmarks/${i}`, group, who, estimator, detector, row: b, times: [],
        never: (/^never: ?(.*)$/.exec(b.label || '') || ['', ''])[1].split(' ')});
      ENTRIES.push(seen.get(key));
    }
    if (b.cpu_ns !== undefined) seen.get(key).times.push(b.cpu_ns);
  });
}
const SUITES = [...new Set(ENTRIES.map((e) => e.file))];
const bare = (file) => file.name.replace('.json', '');
const label_of = (e) => e.who + (SUITES.length > 1 ? ` [${bare(e.file)}]` : '');
// what a suite's runs depend on beside the build: seed, faults, model errors
const conditions_of = (file) => (/MuJoCo [\d.]+[,;] ([^]*)$/.exec(file.data.context.tauext || '') || ['', 'unknown conditions'])[1].replace('\n', ', ');
const DIFFERENT = new Set(SUITES.map(conditions_of)).size > 1
  ? 'These files were not made under the same conditions, so their accuracy cannot be compared: ' + SUITES.map((f) => `${bare(f)}: ${conditions_of(f)}`).join('; ') + '. '
  : '';
const GROUPS = [...new Set(ENTRIES.map((e) => e.group))];
const competes = (e) => !BASELINES.includes(e.estimator) && !e.row.error_occurred;
const value_of = (e, key) => e.row.error_occurred ? undefined : e.row[key];

// the entries that a metric is about: those without detector, unless it is about marks
function entries_for(key) {
  const with_value = ENTRIES.filter((e) => e.file === SUITES[0] || !BASELINES.includes(e.estimator)).filter((e) => key in e.row || e.never.includes(key) || e.row.error_occurred);
  const plain = with_value.filter((e) => !e.detector);
  return plain.some((e) => key in e.row) ? plain : with_value.filter((e) => e.detector);
}

function best_of(entries, key) {
  const better = METRICS.get(key).better;
  return entries.filter((e) => competes(e) && Number.isFinite(value_of(e, key)))
    .sort((a, b) => better * (value_of(b, key) - value_of(a, key)))[0];
}

// how much worse than the best: 1 for the best; undefined where that is no question
function ratio_of(e, best, key) {
  const x = value_of(e, key), b = best && value_of(best, key);
  if (!Number.isFinite(x) || !(b > 0) || !(x > 0)) return undefined;
  return METRICS.get(key).better > 0 ? b / x : x / b;
}
const ratio_text = (r) => r < 9.995 ? r.toFixed(2) : r < 99.95 ? r.toFixed(1) : r.toFixed(0);

// ---- (a) heat map
function heat_cell(e, best, key, values) {
  if (!e) return element('td', {class: 'none', title: 'not in the file'}, '–');
  const m = METRICS.get(key), x = value_of(e, key), r = ratio_of(e, best, key);
  const open = () => show_run(e);
  const cell = {class: 'run' + (e === best ? ' best' : ''), tabindex: 0, onclick: open, onkeydown: (k) => k.key === 'Enter' && open()};
  const paint = (t) => `background: color-mix(in srgb, #dd7a2f ${(100 * t).toFixed(0)}%, #eaf3fa)`;
  if (e.row.error_occurred) return element('td', {...cell, style: paint(1), title: e.row.error_message}, 'failed');
  if (x === undefined) return element('td', {...cell, style: paint(1), title: `${e.who}: ${m.title} has no value`}, 'never');
  const text = x.toFixed(m.digits), title = `${e.group}/${label_of(e)}: ${m.title} ${text} ${m.unit}`;
  const style = paint(BASELINES.includes(e.estimator) || r === undefined ? 0 : Math.min(1, Math.log(Math.max(r, 1)) / Math.log(30)));
  if (values || r === undefined) return element('td', {...cell, style, title, 'data-json': `${e.at}/${key}`}, text);
  const pair = m.better > 0 ? [best, e] : [e, best];
  return element('td', {...cell, style, title, 'data-json': `${pair[0].at}/${key}`, 'data-over': `${pair[1].at}/${key}`}, ratio_text(r));
}

function heat_map() {
  const keys = [...METRICS.values()].filter((m) => m.table && m.better && ENTRIES.some((e) => m.key in e.row)).map((m) => m.key);
  let key = keys[0], values = false;
  const place = element('div', {class: 'wide'}), about = element('p', {});
  const draw = () => {
    const shown = entries_for(key), m = METRICS.get(key), who = [...new Set(shown.map(label_of))];
    const head = element('tr', {}, element('th', {}, values ? `${m.title} [${m.unit || '1'}]` : `${m.title}, of the best`),
      ...who.map((w) => element('th', {title: w}, ...w.split(/(?<=_|:|\+)/).flatMap((part) => [part, element('wbr')]))));
    const rows = GROUPS.filter((g) => shown.some((e) => e.group === g)).map((g) => {
      const here = shown.filter((e) => e.group === g), best = best_of(here, key);
      return element('tr', {}, element('td', {}, g), ...who.map((w) => heat_cell(here.find((e) => label_of(e) === w), best, key, values)));
    });
    place.replaceChildren(element('table', {id: 'heat'}, element('thead', {}, head), element('tbody', {}, ...rows)));
    about.textContent = DIFFERENT + `${m.meaning} ${values ? 'Of the worst joint.' : 'Of the worst joint, as a multiple of the best of its row, in bold (where that is 0, the values).'} `
      + 'A click opens the run. zero, truth and delayed_truth do not compete.';
  };
  section('map', 'Scenarios and estimators', '', about,
    select('metric', keys.map((k) => METRICS.get(k).title), METRICS.get(key).title, (t) => { key = keys.find((k) => METRICS.get(k).title === t); draw(); }),
    select('cells', ['ratio to the best', 'value'], 'ratio to the best', (v) => { values = v === 'value'; draw(); }),
    ...table_buttons(place, 'scenarios'), place);
  draw();
}

const cells_of = (place) => [...place.querySelectorAll('tr')].map((r) => [...r.children].map((c) => c.textContent));
function table_buttons(place, name) {
  const csv = () => cells_of(place).map((r) => r.map((c) => /[",]/.test(c) ? `"${c.replaceAll('"', '""')}"` : c).join(',')).join('\n') + '\n';
  const escaped = (c) => c.replace(/[_%&#$]/g, '\\$&').replace('–', '--').replace('∞', '$\\infty$');
  const latex = () => {
    const [head, ...rows] = cells_of(place).map((r) => r.map(escaped).join(' & ') + ' \\\\');
    return `\\begin{tabular}{l${'r'.repeat(cells_of(place)[0].length - 1)}}\n\\hline\n${head}\n\\hline\n${rows.join('\n')}\n\\hline\n\\end{tabular}\n`;
  };
  return [element('button', {onclick: () => save(name + '.csv', 'text/csv', csv())}, 'CSV'),
    element('button', {onclick: () => save(name + '.tex', 'text/plain', latex())}, 'LaTeX')];
}

// ---- ranking
function ranking() {
  const key = 'rmse_Nm', shown = entries_for(key).filter((e) => !BASELINES.includes(e.estimator));
  const worth = new Map();  // by label
  const median = (times) => quantile([...times].sort((x, y) => x - y), .5);
  for (const g of GROUPS) {
    const here = shown.filter((e) => e.group === g), best = best_of(here, key);
    if (!best || !(value_of(best, key) > 0)) continue;
    const zero = ENTRIES.find((e) => e.group === g && e.estimator === 'zero');
    const known = here.map((e) => ratio_of(e, best, key)).filter((r) => r !== undefined);
    const charged = Math.max(...known, zero ? value_of(zero, key) / value_of(best, key) : 1);
    for (const w of new Set(shown.map(label_of))) {
      const e = here.find((x) => label_of(x) === w), r = e && ratio_of(e, best, key);
      const all = worth.get(w) || {sum: 0, n: 0, failed: 0, missing: 0, slow: [], of: shown.find((x) => label_of(x) === w)};
      all.sum += Math.log(r ?? charged), ++all.n;
      all.failed += Boolean(e && r === undefined), all.missing += !e;
      const beside = here.filter((x) => e && x.file === e.file && x.times.length).map((x) => median(x.times));
      if (e && e.times.length) all.slow.push(Math.log(median(e.times) / Math.min(...beside)));
      worth.set(w, all);
    }
  }
  const rows = [...worth].map(([who, a]) => ({who, ...a, score: Math.exp(a.sum / a.n), slow: Math.exp(a.slow.reduce((x, y) => x + y, 0) / a.slow.length)}));
  rows.sort((a, b) => a.score - b.score);
  const place = element('div', {class: 'wide'}, element('table', {id: 'ranking'},
    element('thead', {}, element('tr', {}, ...['estimator', 'rmse, of the best', 'scenarios', 'failed', 'missing', 'time, of its file', 'submitter', 'known limitations', 'version']
      .map((t, i) => element('th', {class: i > 5 && 'text'}, t)))),
    element('tbody', {}, ...rows.map((r) => {
      const c = r.of.file.data.context, text = (t) => element('td', {class: 'text'}, t || '–');
      return element('tr', {}, element('td', {}, r.who), element('td', {}, r.score.toFixed(2)), element('td', {}, String(r.n)),
        element('td', {}, String(r.failed)), element('td', {}, String(r.missing)),
        element('td', {}, r.slow > 0 ? ratio_text(r.slow) : '–'), text(c.submitter), text(c.limitations),
        text((/^tauext \S+/.exec(c.tauext || '') || [''])[0].replace(/,$/, '') + (c.commit ? ' ' + c.commit : '')));
    }))));
  section('ranking-of-all', 'Ranking', DIFFERENT + 'By the geometric mean over all scenarios of an estimator\'s rmse as a multiple of the best one\'s. A scenario that failed or is '
    + 'missing counts as its worst, and as an estimate of 0 if that is worse. Times are within one file, too: the geometric mean of a step\'s time as a multiple of the fastest one\'s in the same scenario; two machines cannot be compared.',
    ...table_buttons(place, 'ranking'), place);
}

// ---- (b) and (c): traces
const TRACED = of_kind('traces');
const run_name = (group, file) => group + (TRACED.length > 1 ? ` [${bare(file)}]` : '');
const TRACES = TRACED.flatMap((f) => f.data.groups.map((g) => ({...g, name: run_name(g.name, f)})));
function decoded(joint) {
  const bytes = Uint8Array.from(atob(joint.values), (c) => c.charCodeAt(0));
  const range = joint.high - joint.low;
  return Array.from({length: bytes.length / 2}, (_, i) => joint.low + (bytes[2 * i] + 256 * bytes[2 * i + 1]) / 65535 * range);
}
// a series' signals, each with its name and unit
const signals_of = (s) => [...s.joints.map((x, j) => [x, `joint ${j + 1}`, 'tau_ext [N m]']),
  ...(s.wrench || []).map((x, j) => [x, `${j < 3 ? 'force' : 'moment'} ${'xyz'[j % 3]}`, j < 3 ? 'force [N]' : 'moment [N m]'])];
// points at the begins and ends of buckets, once where a bucket is one sample
function kept(t) {
  const all = [...t.keys()].filter((i) => i % 2 === 0 || t[i] > t[i - 1]);
  return (values) => all.map((i) => values[i]);
}
let show_run = () => {};
function runs() {
  let group = (TRACES.find((g) => g.contacts.length) || TRACES[0]).name, focus = TRACES[0].series[1]?.name, hidden = new Set(), detector = 'none', plots = [];
  const place = element('div', {id: 'run'}), keys = element('div'), chooser = element('span');
  const zoom = (min, max) => plots.forEach((p) => p.setScale('x', {min, max}));
  const draw = () => {
    const g = TRACES.find((x) => x.name === group), keep = kept(g.t), t = keep(g.t);
    const styles = new Map(g.series.map((s, i) => [s.name, i === 0 ? {color: themed('--truth'), dash: []} : look(i - 1)]));
    plots.forEach((p) => p.destroy());
    const marks = g.marks.filter((m) => m.name.endsWith('+' + detector))
      .flatMap((m) => m.t.map((at) => ({t: at, name: m.name.split('+')[0], color: (styles.get(m.name.split('+')[0]) || {color: '#777'}).color})));
    const shown = (s) => s.name === 'truth' || s.name === focus || !hidden.has(s.name);
    place.replaceChildren();
    place.plots = plots = signals_of(g.series[0]).map(([, title, unit], j, all) => {
      const largest = Math.max(1e-6, ...all.filter((s) => s[2] === unit).map(([s]) => s.high - s.low));
      const at = g.series.findIndex((s) => s.name === focus) + 1;
      return time_plot(place, {title, unit, width: place.clientWidth || 1000, height: all.length > 1 ? 250 : 400, sync: 'run',
        data: [t, ...g.series.map((s) => keep(decoded(signals_of(s)[j][0])))], floor: 1e-3 * largest,
        series: g.series.map((s, i) => ({label: s.name, ...styles.get(s.name), width: i === 0 ? 2 : s.name === focus ? 1.8 : 1, show: shown(s)})),
        bands: at > 1 ? [{series: [at, 1], fill: 'rgba(0, 114, 178, .15)'}, {series: [1, at], fill: 'rgba(0, 114, 178, .15)'}] : [],
        over: () => [g.contacts, marks]});
    });
    keys.replaceChildren(...g.series.slice(1).map((s) => element('label', {class: 'key', style: `color: ${styles.get(s.name).color}`},
      element('input', {type: 'checkbox', checked: shown(s), onchange: (c) => { c.target.checked ? hidden.delete(s.name) : hidden.add(s.name); draw(); }}), s.name)));
    const detectors = ['none', ...new Set(g.marks.map((m) => m.name.split('+').pop()))];
    chooser.replaceChildren(select('scenario', TRACES.map((x) => x.name), group, (v) => { group = v; draw(); }),
      ' error of ', select('estimator', g.series.slice(1).map((s) => s.name), focus, (v) => { focus = v; draw(); }),
      ' marks of ', select('detector', detectors, detector, (v) => { detector = v; draw(); }),
      element('button', {onclick: () => zoom(t[0], t.at(-1))}, 'whole run'),
      ...g.contacts.slice(0, 8).map(([from, to]) => element('button', {onclick: () => zoom(from - .1, Math.max(to, from + .5) + .1)}, `contact at ${Number(from.toPrecision(4))} s`)));
  };
  show_run = (entry) => {
    const g = TRACES.find((x) => x.name === run_name(entry.group, entry.file));
    if (!g) return;
    group = g.name, hidden = new Set(g.series.map((s) => s.name));
    focus = entry.estimator;
    draw();
    document.getElementById('runs').scrollIntoView();
  };
  section('runs', 'Truth and estimates', 'The shaded area is the error of one estimator; red spans are contacts. Drag to zoom, double-click to see all; below each plot the values at the cursor. '
    + 'Peaks are kept: of each stretch of time the least and the largest value are drawn.', chooser, keys, place);
  draw();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
}

function step_answers() {
  const steps = TRACES.filter((g) => /\/step( \[|$)/.test(g.name));
  if (steps.length === 0) return;
  const places = steps.flatMap((g) => g.series[0].joints.map((truth, j) => {
    const keep = kept(g.t), t = keep(g.t), of_truth = keep(decoded(truth)), end = of_truth.at(-1);
    const begin = t[of_truth.findIndex((x) => Math.abs(x) > 0.5 * Math.abs(end))];
    return chart({title: `${g.name}, joint ${j + 1}`, x: {label: 'time from the step [s]', range: [-0.05, 1]}, y: {label: 'estimate / step [1]', range: [-0.1, 1.35]}}, (c) => {
      g.series.forEach((s, i) => {
        const style = i === 0 ? {color: 'var(--truth)', dash: []} : look(i - 1);
        c.line(keep(decoded(s.joints[j])).map((x, k) => [t[k] - begin, x / end]), style, s.name);
      });
    });
  }));
  section('steps', 'Answers to a step', 'Estimates of a load that begins at once, as shares of it.', element('div', {class: 'pair'}, ...places));
}

// ---- figures
function ticks([low, high], log) {
  if (log) {
    const all = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high) + 1e-9; ++e) all.push(...(high / low < 8 ? [1, 1.5, 2, 3, 4, 5, 6, 8] : high / low < 200 ? [1, 2, 5] : [1]).map((m) => m * 10 ** e));
    return all.filter((x) => x >= low * .999 && x <= high * 1.001);
  }
  const rough = (high - low) / 6, power = 10 ** Math.floor(Math.log10(rough)), step = power * [1, 2, 5, 10].find((m) => m * power >= rough);
  return Array.from({length: Math.floor((high - low) / step + 1e-9) + 2}, (_, i) => (Math.ceil(low / step - 1e-9) + i) * step).filter((x) => x <= high + 1e-9 * step);
}
const tick_text = (x) => String(Number(x.toPrecision(6)));

// An SVG with axes; draw(c) puts lines, points and boxes into it. rows: names instead of a scale of y.
function chart({title, x, y, width = 690, height = 360, rows}, draw) {
  const left = rows ? Math.min(330, 20 + 6.6 * Math.max(...rows.map((r) => r.length))) : 64, right = 16, top = 26, bottom = 44, h = rows ? top + bottom + 19 * rows.length : height;
  const share = (v, {range: [low, high], log}) => log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low);
  const px = (v) => left + share(v, x) * (width - left - right), py = (v) => rows ? top + 19 * v + 10 : h - bottom - share(v, y) * (h - top - bottom);
  const plot = element('g'), names = [], texts = [];
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
        'stroke-width': width_of, 'stroke-dasharray': dash.join(' '), 'clip-path': 'inset(0)'}, name && element('title', {}, name)));
      if (name) names.push([name, color, dash]);
    },
    point: ([a, b], {color, hollow, r = 4.5}, name, text, data = {}) => {
      if (!inside([a, b])) return;
      plot.append(element('circle', {cx: px(a), cy: py(b), r, fill: hollow ? 'none' : color, stroke: color, 'stroke-width': 1.6, ...data}, element('title', {}, name)));
      if (!text) return;
      const wide = 6.7 * text.length, free = (dy) => !texts.some(([x0, y0, w]) => Math.abs(y0 - py(b) - dy) < 12 && px(a) < x0 + w && x0 < px(a) + wide);
      const dy = [0, 13, -13, 26, -26, 39, 52].find(free) ?? 0;
      texts.push([px(a), py(b) + dy, wide]);
      plot.append(element('text', {x: px(a) + 7, y: py(b) + 4 + dy}, text));
    },
    box: (from, to, row, {color}, thick, name) => plot.append(element('rect', {x: px(from), y: py(row) - thick / 2, width: Math.max(1, px(to) - px(from)), height: thick,
      fill: color, 'fill-opacity': .35, stroke: color}, element('title', {}, name || ''))),
  };
  draw(c);
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
  const key = element('div', {class: 'note'}, ...names.map(([name, color, dash]) => element('label', {class: 'key'},
    element('svg', {width: 26, height: 10}, element('line', {x1: 0, x2: 24, y1: 5, y2: 5, stroke: color, 'stroke-width': 2, 'stroke-dasharray': dash.join(' ')})), ' ' + name)));
  return element('div', {class: 'figure'}, svg, key, element('button', {onclick: file}, 'SVG'));
}

const spread_of = (values, log) => {
  const good = values.filter((v) => Number.isFinite(v) && (!log || v > 0)), low = Math.min(...good), high = Math.max(...good);
  return good.length === 0 ? [1, 10] : log ? [low / 1.3, high * 1.3] : range_of(low, high, 1e-9);
};

// ---- (d) noise against delay
const overshoot_color = (percent) => percent < 1 ? '#0072b2' : percent < 10 ? '#e69f00' : '#d55e00';
function trade_off(title, points) {  // {name, delay [s], noise [N m], overshoot [%], at, delay_key}
  const good = points.filter((p) => p.delay > 0 && p.noise > 0);
  if (good.length < 2) return undefined;
  const dominated = (p) => good.find((q) => q !== p && q.delay <= p.delay && q.noise <= p.noise && (q.delay < p.delay || q.noise < p.noise));
  return chart({title, x: {label: 'delay [s]', log: true, range: spread_of(good.map((p) => p.delay), true)}, y: {label: 'noise [N m]', log: true, range: spread_of(good.map((p) => p.noise), true)}}, (c) => {
    for (const p of good) {
      const by = dominated(p);
      c.point([p.delay, p.noise], {color: overshoot_color(p.overshoot), hollow: Boolean(by)},
        `${p.name}: noise ${p.noise.toPrecision(4)} N m, delay ${p.delay.toPrecision(4)} s, overshoot ${(p.overshoot ?? NaN).toFixed(1)} %${by ? `; ${by.name} is better at both` : ''}`,
        good.length < 25 ? p.name : '', {'data-name': p.name});
    }
  });
}
function trade_offs() {
  const figures = GROUPS.filter((g) => g.endsWith('/step')).map((g) => trade_off(`${g}: rise to 90 %, noise`, entries_for('rise_0_90_s')
    .filter((e) => e.group === g && competes(e)).map((e) => ({name: label_of(e), delay: value_of(e, 'rise_0_90_s'), noise: value_of(e, 'noise_Nm'), overshoot: value_of(e, 'overshoot_percent')}))));
  for (const f of of_kind('equal bandwidth')) figures.push(trade_off(`${f.name}: lag at one bandwidth`, f.data.rows.map((r) => ({name: r.estimator, delay: r.lag_ms / 1e3, noise: r.noise_Nm, overshoot: r.overshoot_percent}))));
  for (const f of of_kind('pareto')) figures.push(trade_off(`${f.name}: rise to 90 % of designs`, f.data.rows.map((r) => ({name: `${r.estimator} ${r.design_rad_s} rad/s`, delay: r['rise_0-90_percent_ms'] / 1e3, noise: r.noise_Nm, overshoot: r.overshoot_percent}))));
  const shown = figures.filter((f) => f);
  if (shown.length) section('fronts', 'Noise against delay', 'Towards the lower left is better. Blue: less than 1 % overshoot, yellow: less than 10 %, red: more. A hollow point has another one that is at least as good at both.', element('div', {class: 'pair'}, ...shown));
}

// ---- (e) detection
const apart = (i) => ({...look(i), dash: i % 2 ? [7, 5] : []});  // of two equal curves both are seen
function detection() {
  for (const f of of_kind('study')) {
    const conditions = [...new Set(f.data.cells.map((c) => c.condition))], estimators = [...new Set(f.data.cells.map((c) => c.estimator))];
    let condition = conditions[0], estimator = estimators[0];
    const place = element('div', {class: 'pair'}), id = 'study' + f.at.replace(/\D/g, '');
    const draw = () => {
      const cells = f.data.cells.filter((c) => c.condition === condition && c.estimator === estimator);
      const points = cells.flatMap((c) => c.roc), least = 0.3;
      const alarms = (p) => Math.max(least, p.false_alarms_per_hour);
      const roc = chart({title: `${condition}, ${estimator}: recall, false alarms`, x: {label: `false alarms [1/h], 0 at ${least}`, log: true, range: [least, Math.max(10, ...points.map(alarms)) * 1.2]}, y: {label: 'recall [1]', range: [0, 1.02]}}, (c) => cells.forEach((cell, i) => {
        const sorted = cell.roc.filter((p) => Number.isFinite(p.false_alarms_per_hour)).sort((a, b) => alarms(a) - alarms(b) || a.recall - b.recall);
        c.line(sorted.map((p) => [alarms(p), p.recall]), apart(i), cell.detector);
        for (const p of sorted) {
          if (p.recall_low !== undefined) c.line([[alarms(p), p.recall_low], [alarms(p), p.recall_high]], look(i), undefined, 1);
          c.point([alarms(p), p.recall], {...look(i), hollow: p.threshold_factor !== 1}, `${cell.detector}, threshold times ${p.threshold_factor}: recall ${p.recall.toFixed(3)}, ${p.false_alarms_per_hour.toFixed(1)} false alarms an hour`);
        }
      }));
      const quantiles = cells.flatMap((c) => c.delay_quantiles_s || []);
      const delays = chart({title: `${condition}, ${estimator}: delays of marks`, x: {label: 'delay [s]', range: [0, Math.max(0.01, ...quantiles) * 1.05]}, y: {label: 'share of blows, at most so late [1]', range: [0, 1.02]}}, (c) => cells.forEach((cell, i) =>
        cell.delay_quantiles_s && c.line(cell.delay_quantiles_s.map((d, k) => [d, cell.recall * k / 20]), apart(i), cell.detector)));
      place.replaceChildren(roc, delays);
    };
    section(id, `Detection: ${f.name}`, 'Points are thresholds from an eighth to eight times the calibrated one, which is full, with 95 % intervals of the recall. A blow that is not marked never counts as late enough.',
      select('condition', conditions, condition, (v) => { condition = v; draw(); }), select('estimator', estimators, estimator, (v) => { estimator = v; draw(); }), place);
    draw();
  }
}

function meetings() {
  for (const f of of_kind('study').filter((x) => x.data.cells.some((c) => c.regions))) {
    const cells = f.data.cells.map((c, i) => ({...c, at: `${f.at}/cells/${i}`})).filter((c) => c.regions);
    const name_of = (c) => `${c.condition}: ${c.estimator}+${c.detector}`, place = element('div'), all = (of) => [...new Set(of)];
    const draw = (chosen) => {
      const r = chosen.regions, kinds = all(r.map((x) => x.kind));
      const cell = (k) => k < 0 ? element('td', {class: 'none'}, '–')
        : element('td', {'data-json': `${chosen.at}/regions/${k}/recall`, title: `${r[k].found} of ${r[k].touches}; 95 %: ${r[k].recall_low.toFixed(3)} to ${r[k].recall_high.toFixed(3)}`}, r[k].recall.toFixed(METRICS.get('recall').digits));
      const table = element('div', {class: 'wide'}, element('table', {}, element('thead', {}, element('tr', {}, element('th', {}, 'found [1]'), ...kinds.map((k) => element('th', {}, k)))),
        element('tbody', {}, ...all(r.map((x) => x.region)).map((region) => element('tr', {}, element('td', {}, region),
          ...kinds.map((kind) => cell(r.findIndex((x) => x.region === region && x.kind === kind))))))));
      const most = Math.max(1.1, ...r.map((x) => x.until_found_of_limit_quantiles[20]));
      const figure = chart({title: 'largest force until the mark', rows: r.map((x) => x.class), x: {label: 'force / limit of the region [1]', range: [0, most]}}, (c) => {
        r.forEach((x, i) => {
          const q = x.until_found_of_limit_quantiles;
          c.line([[q[0], i], [q[20], i]], look(0));
          c.box(q[5], q[15], i, look(0), 9, `${x.class}: median ${q[10].toPrecision(3)}, half of them ${q[5].toPrecision(3)} to ${q[15].toPrecision(3)}, at most ${q[20].toPrecision(3)}`);
        });
        c.line([[1, -.5], [1, r.length - .5]], {color: 'var(--truth)', dash: [4, 4]});
      });
      place.replaceChildren(...table_buttons(table, 'regions'), table, figure);
    };
    section('regions' + f.at.replace(/\D/g, ''), `Regions of a body: ${f.name}`, 'Meetings of the arm with a part of a person: the share that was found, by speed [m/s], share of the limit, grazing or clamped; and what was pressed '
      + 'until the mark, or at most where there was none. Boxes hold half of the meetings, lines all of them; beyond 1 the limit was exceeded first.',
      select('condition and pair', cells.map(name_of), undefined, (n) => draw(cells.find((c) => name_of(c) === n))), place);
    draw(cells[0]);
  }
}

// ---- (f) cost
function costs() {
  const figures = SUITES.map((file) => {
    const by = new Map();
    for (const e of ENTRIES.filter((x) => x.file === file && !x.detector && x.times.length && competes(x))) {
      const name = `${e.group.split('/')[0]} ${e.estimator}`;
      by.set(name, [...(by.get(name) || []), ...e.times].sort((a, b) => a - b));
    }
    const all = [...by].sort((a, b) => quantile(a[1], .5) - quantile(b[1], .5));
    return all.length === 0 ? undefined : chart({title: file.name, rows: all.map((a) => a[0]), x: {label: 'CPU time of a step [ns]', log: true, range: spread_of(all.flatMap((a) => a[1]), true)}}, (c) => all.forEach(([name, times], i) => {
      c.box(times[0], times.at(-1), i, look(0), 5, `${name}: ${times[0].toFixed(1)} to ${times.at(-1).toFixed(1)} ns`);
      c.point([quantile(times, .5), i], look(0), `${name}: ${quantile(times, .5).toFixed(1)} ns, the median of ${times.length}`);
    }));
  }).filter((f) => f);
  if (figures.length) section('cost', 'What a step costs', 'The median over scenarios and repetitions, and from the least to the largest. Only within one file can times be compared.', element('div', {class: 'pair'}, ...figures));
}

// ---- (g) seeds
function seeds() {
  for (const f of of_kind('seeds')) {
    const group_of = (r) => r.entry.split('/').slice(0, 2).join('/');
    const keys = [...new Set(f.data.rows.map((r) => r.metric))], groups = [...new Set(f.data.rows.map(group_of))];
    let key = keys[0], group = groups[0];
    const place = element('div', {class: 'pair'});
    const draw = () => {
      const m = METRICS.get(key) || {title: key, unit: ''}, rows = f.data.rows.filter((r) => r.metric === key && group_of(r) === group);
      if (rows.length === 0) return place.replaceChildren(element('p', {}, `no values of ${m.title} in ${group}`));
      const values = rows.map((r) => String(r.by_seed ?? '').split(' ').map(Number).filter(Number.isFinite).sort((a, b) => a - b));
      const boxes = chart({title: `${m.title} at each seed`, rows: rows.map((r) => r.entry.split('/').slice(2).join('/')), x: {label: `${m.title} [${m.unit || '1'}]`, range: spread_of(values.flat())}}, (c) => rows.forEach((r, i) => {
        if (values[i].length === 0) return;
        const [low, q1, q2, q3, high] = [0, .25, .5, .75, 1].map((q) => quantile(values[i], q));
        c.line([[low, i], [high, i]], look(0));
        c.box(q1, q3, i, look(0), 11, `${r.entry}: ${low.toPrecision(4)}, quartiles ${q1.toPrecision(4)}, ${q2.toPrecision(4)}, ${q3.toPrecision(4)}, ${high.toPrecision(4)}${r.never ? `; never at ${r.never} seeds` : ''}`);
        c.point([q2, i], {...look(1), r: 2}, `${r.entry}: median ${q2.toPrecision(4)}`);
      }));
      const pairs = rows.filter((r) => Number.isFinite(r.difference));
      const differences = pairs.length === 0 ? undefined : chart({title: `${m.title}: less that of ${pairs[0].against.split('/').pop()}, at the same seed`, rows: pairs.map((r) => r.entry.split('/').slice(2).join('/')),
        x: {label: `difference [${m.unit || '1'}], mean and 95 % interval`, range: spread_of([0, ...pairs.flatMap((r) => [r.difference_low ?? r.difference, r.difference_high ?? r.difference])])}}, (c) => pairs.forEach((r, i) => {
        c.line([[0, i - .5], [0, i + .5]], {color: 'var(--truth)'});
        if (Number.isFinite(r.difference_low)) c.line([[r.difference_low, i], [r.difference_high, i]], look(0), undefined, 3);
        c.point([r.difference, i], {...look(0), r: 2.5}, `${r.entry}: ${r.difference}`);
      }));
      place.replaceChildren(boxes, ...(differences ? [differences] : []));
    };
    section('seeds' + f.at.replace(/\D/g, ''), `Seeds: ${f.name}`, 'Boxes hold half of the seeds, lines all of them; the mark is the median.',
      select('scenario', groups, group, (g) => { group = g; draw(); }),
      select('metric', keys.map((k) => (METRICS.get(k) || {title: k}).title), undefined, (t) => { key = keys.find((k) => (METRICS.get(k) || {title: k}).title === t); draw(); }), place);
    draw();
  }
}

// ---- (h) history
function history_of_gate() {
  for (const f of of_kind('history')) {
    const rows = f.data.rows, kernels = [...new Set(rows.flatMap((r) => Object.keys(r.kernels)))], place = element('div');
    const draw = (kernel) => {
      const points = rows.map((r, i) => [i, r.kernels[kernel]]).filter(([, k]) => k);
      place.replaceChildren(chart({title: kernel, width: 1200, x: {label: 'commits, the oldest first', names: rows.map((r) => r.commit.slice(0, 8)), range: [-.5, rows.length - .5]}, y: {label: 'time of a step / reference [1]', range: spread_of(points.flatMap(([, k]) => [k.low, k.high, 1]))}}, (c) => {
        c.line([[-.5, 1], [rows.length, 1]], {color: '#7f7f7f', dash: [4, 4]});
        c.line(points.map(([i, k]) => [i, k.ratio]), look(0));
        for (const [i, k] of points) {
          c.line([[i, k.low], [i, k.high]], look(0), undefined, 1);
          c.point([i, k.ratio], look(0), `${rows[i].commit} ${rows[i].date} ${rows[i].title}: ${k.ratio.toFixed(4)} (${k.low.toFixed(4)} to ${k.high.toFixed(4)})`);
        }
      }));
    };
    section('history' + f.at.replace(/\D/g, ''), `History of the gate: ${f.name}`, 'The time of a step at each commit as a multiple of the reference\'s, with its 95 % interval.', select('kernel', kernels, kernels[0], draw), place);
    draw(kernels[0]);
  }
}

// ---- (i) provenance
function provenance() {
  const keys = [...new Set(FILES.flatMap((f) => Object.entries(f.data.context).filter(([, v]) => typeof v !== 'object').map(([k]) => k).filter((k) => !['executable', 'host_name', 'library_build_type'].includes(k))))];
  const place = element('div', {class: 'wide'}, element('table', {id: 'provenance'}, element('thead', {}, element('tr', {}, element('th', {}, ''), ...FILES.map((f) => element('th', {class: 'text'}, f.name)))),
    element('tbody', {}, element('tr', {}, element('td', {}, 'kind'), ...FILES.map((f) => element('td', {class: 'text'}, f.kind))),
      ...keys.map((k) => element('tr', {}, element('td', {}, k), ...FILES.map((f, i) => element('td', {class: 'text', 'data-json': k in f.data.context && `/${i}/data/context/${k}`}, String(f.data.context[k] ?? '–'))))))));
  section('sources', 'Where this comes from', 'This page holds the files as they were read; tauext-report reads it as one of them.',
    element('button', {onclick: () => FILES.forEach((f) => save(f.name, 'application/json', JSON.stringify(f.data)))}, 'the files as JSON'), ...table_buttons(place, 'sources'), place);
}

if (ENTRIES.length) heat_map(), ranking();
requestAnimationFrame(() => setTimeout(() => {  // what takes longer, once something is seen
  if (TRACES.length) runs(), step_answers();
  trade_offs(), detection(), meetings(), costs(), seeds(), history_of_gate(), provenance();
  document.body.dataset.done = 'yes';
}));
