// What the report shows of suites: the heat map, the ranking, noise against delay, costs.
const FILES = JSON.parse(document.getElementById('results').textContent);
const METRICS = new Map(JSON.parse(document.getElementById('metrics').textContent).map((m) => [m.key, m]));
const BASELINES = ['zero', 'truth', 'delayed_truth'];
const of_kind = (kind) => FILES.map((f, i) => ({...f, at: `/${i}/data`})).filter((f) => f.kind === kind);
// ---- the suite's rows
// ROBOT/SCENARIO/WHO or RECORDING/WHO, where keys of WHO may have slashes, too
function parts_of(name) {
  const head = name.split(/[:+]/)[0].split('/'), group = head.slice(0, head.length > 2 ? 2 : 1).join('/');
  return [group, name.slice(group.length + 1)];
}
const ENTRIES = [];
for (const f of of_kind('suite')) {
  const seen = new Map();
  f.data.benchmarks.forEach((b, i) => {
    if (b.run_type === 'aggregate') return;
    const [group, who] = parts_of(b.run_name || b.name);
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

// the entries that a metric is about: those without detector, where an estimator has such, unless it is about marks
function entries_for(key) {
  const with_value = ENTRIES.filter((e) => e.file === SUITES[0] || !BASELINES.includes(e.estimator)).filter((e) => key in e.row || e.never.includes(key) || e.row.error_occurred);
  const plain = with_value.filter((e) => !e.detector);
  const alone = (e) => !plain.some((p) => p.file === e.file && p.group === e.group && p.estimator === e.estimator);
  return plain.some((e) => key in e.row) ? with_value.filter((e) => !e.detector || alone(e)) : with_value.filter((e) => e.detector);
}

function best_of(entries, key) {
  const {better, never_is_best} = METRICS.get(key);
  const never = never_is_best && entries.find((e) => competes(e) && value_of(e, key) === undefined);
  return never || entries.filter((e) => competes(e) && Number.isFinite(value_of(e, key)))
    .sort((a, b) => better * (value_of(b, key) - value_of(a, key)))[0];
}
// how much worse than the best: 1 for the best; undefined where that is no question
function ratio_of(e, best, key) {
  const x = value_of(e, key), b = best && value_of(best, key);
  if (!Number.isFinite(x) || !(b > 0) || !(x > 0)) return undefined;
  return METRICS.get(key).better > 0 ? b / x : x / b;
}
// several may be the best, as far as they are printed
function is_best(e, best, key, values) {
  if (!competes(e) || !best) return false;
  const [x, y] = [e, best].map((of) => value_of(of, key)), r = ratio_of(e, best, key);
  if (x === undefined || y === undefined) return x === y;
  return values || r === undefined ? x.toFixed(METRICS.get(key).digits) === y.toFixed(METRICS.get(key).digits) : ratio_text(r) === '1.00';
}
const ratio_text = (r) => r < 9.995 ? r.toFixed(2) : r < 99.95 ? r.toFixed(1) : r.toFixed(0);

// ---- heat map
function heat_cell(e, best, key, values) {
  if (!e) return element('td', {class: 'none', title: 'not in the file'}, '–');
  const m = METRICS.get(key), x = value_of(e, key), r = ratio_of(e, best, key);
  const open = () => show_run(e);
  const cell = {class: 'run' + (is_best(e, best, key, values) ? ' best' : ''), tabindex: 0, onclick: open, onkeydown: (k) => k.key === 'Enter' && open()};
  const paint = (t) => `background: color-mix(in srgb, #dd7a2f ${(100 * t).toFixed(0)}%, #eaf3fa)`;
  if (e.row.error_occurred) return element('td', {...cell, style: paint(1), title: e.row.error_message}, 'failed');
  if (x === undefined) return element('td', {...cell, style: paint(m.never_is_best || BASELINES.includes(e.estimator) ? 0 : 1), title: `${e.who}: ${m.title} has no value`}, 'never');
  const text = x.toFixed(m.digits), title = `${e.group}/${label_of(e)}: ${m.title} ${text} ${m.unit}`;
  const style = paint(BASELINES.includes(e.estimator) ? 0 : r === undefined ? (best && !is_best(e, best, key, values) ? .5 : 0) : Math.min(1, Math.log(Math.max(r, 1)) / Math.log(30)));
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
    about.textContent = DIFFERENT + m.meaning + (m.joints ? ' It is the value of the worst joint.' : '') + (values ? ' The best of a row is bold.'
      : ` A cell says how many times ${m.better > 0 ? 'larger the best value of its row is' : 'the best value of its row it is'}; the best is bold. A row whose best is 0 shows values.`)
      + ' A click opens the run. zero, truth and delayed_truth do not compete.';
  };
  section('map', 'Scenarios and estimators', '', about,
    select('metric', keys.map((k) => METRICS.get(k).title), METRICS.get(key).title, (t) => { key = keys.find((k) => METRICS.get(k).title === t); draw(); }),
    select('cells', ['ratio to the best', 'value'], 'ratio to the best', (v) => { values = v === 'value'; draw(); }),
    ...table_buttons(place, 'scenarios'), place);
  draw();
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
        element('td', {class: 'text short'}, (/^tauext \S+/.exec(c.tauext || '') || [''])[0].replace(/,$/, '') + (c.commit ? ' ' + c.commit : '')));
    }))));
  section('ranking-of-all', 'Ranking', DIFFERENT + 'By the geometric mean over all scenarios of an estimator\'s rmse as a multiple of the best one\'s. A scenario that failed or is '
    + 'missing counts as its worst, and as an estimate of 0 if that is worse. Times are within one file, too: the geometric mean of a step\'s time as a multiple of the fastest one\'s in the same scenario; two machines cannot be compared.',
    ...table_buttons(place, 'ranking'), place);
}

// ---- noise against delay
const overshoot_color = (percent) => percent < 1 ? '#0072b2' : percent < 10 ? '#e69f00' : '#d55e00';
function trade_off(title, points) {  // {name, delay [s], noise [N m], overshoot [%]}
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

// ---- cost
function costs() {
  const figures = SUITES.map((file) => {
    const by = new Map();
    for (const e of ENTRIES.filter((x) => x.file === file && !x.detector && x.times.length && competes(x))) {
      const name = `${e.group.split('/')[0]} ${e.estimator}`;
      by.set(name, [...(by.get(name) || []), ...e.times].sort((a, b) => a - b));
    }
    const robot = ([name]) => name.split(' ')[0];
    const all = [...by].sort((a, b) => robot(a).localeCompare(robot(b)) || quantile(a[1], .5) - quantile(b[1], .5));
    return all.length === 0 ? undefined : chart({title: SUITES.length > 1 ? file.name : 'CPU time', rows: all.map((a) => a[0]), x: {label: 'CPU time of a step [ns]', log: true, range: spread_of(all.flatMap((a) => a[1]), true)}}, (c) => all.forEach(([name, times], i) => {
      c.box(times[0], times.at(-1), i, look(0), 5, `${name}: ${times[0].toFixed(1)} to ${times.at(-1).toFixed(1)} ns`);
      c.point([quantile(times, .5), i], look(0), `${name}: ${quantile(times, .5).toFixed(1)} ns, the median of ${times.length}`);
    }));
  }).filter((f) => f);
  if (figures.length) section('cost', 'What a step costs', 'The median over scenarios and repetitions, and from the least to the largest. Only within one file can times be compared.', element('div', {class: 'pair'}, ...figures));
}

