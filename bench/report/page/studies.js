// What the report shows of studies: detection, regions of a body, seeds, the history of a gate.
// ---- detection
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
    section(id, `Detection: ${f.name}`, 'Points are thresholds from an eighth to eight times the calibrated one, which is full, with 95 % intervals of the recall. A curve of delays ends at the share that was marked at all.',
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

// names of pairs without their keys, where that tells them apart
function short_names(pairs) {
  const bare = pairs.map((p) => p.replace(/:.*?(?=\+[a-z_]|$)/g, ''));
  return bare.map((name, i) => bare.filter((other) => other === name).length === 1 ? name : pairs[i]);
}

// which pairs nobody can tell apart
function standings() {
  for (const f of of_kind('study').filter((x) => (x.data.comparisons || []).some((c) => c.touches > 0))) {
    const all = f.data.comparisons.map((c, i) => ({...c, at: `${f.at}/comparisons/${i}`})).filter((c) => c.touches > 0);
    const conditions = [...new Set(all.map((c) => c.condition))], place = element('div');
    let condition = conditions[0], what = all[0].touches_of;
    const draw = () => {
      const c = all.find((x) => x.condition === condition && x.touches_of === what);
      if (!c) return place.replaceChildren(element('p', {}, `${what}: nothing of it under ${condition}`));
      const rows = c.groups.flatMap((group, g) => group.map((s) => ({...s, group: g})));
      if (rows.length === 0) return place.replaceChildren(element('p', {}, 'no pair is so quiet'));
      const figure = chart({title: `${condition}, ${what}: ${c.touches} touches, at most ${c.false_alarms_per_hour} false alarm an hour`, rows: short_names(rows.map((s) => s.pair)), width: Math.max(690, place.clientWidth), x: {label: 'found [1], 95 % interval', range: [0, 1]}}, (plot) => rows.forEach((s, i) => {
        plot.box(s.recall_low, s.recall_high, i, look(s.group), 9, `group ${s.group + 1}: ${s.found} of ${c.touches}, thresholds times ${s.threshold_factor}`);
        plot.point([s.recall, i], {...look(s.group), r: 2.5}, `${s.pair}: ${s.recall.toFixed(3)} (${s.recall_low.toFixed(3)} to ${s.recall_high.toFixed(3)})`);
      }));
      const loud = c.too_loud.length > 0 ? [element('p', {class: 'note'}, `Louder at every threshold: ${c.too_loud.join(', ')}.`)] : [];
      place.replaceChildren(figure, ...loud);
    };
    section('standings' + f.at.replace(/\D/g, ''), `Which pairs can be told apart: ${f.name}`, 'Each pair with its thresholds times the least factor at which it raises so few false alarms. A colour is a group: intervals that reach that of its best pair, so from these runs nobody can say which is better.',
      select('condition', conditions, condition, (v) => { condition = v; draw(); }), select('of', [...new Set(all.map((c) => c.touches_of))], what, (v) => { what = v; draw(); }), place);
    draw();
  }
}

// ---- seeds
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

// ---- history
function history_of_gate() {
  for (const f of of_kind('history')) {
    const rows = f.data.rows, kernels = [...new Set(rows.flatMap((r) => Object.keys(r.kernels)))], place = element('div');
    const draw = (kernel) => {
      const points = rows.map((r, i) => [i, r.kernels[kernel]]).filter(([, k]) => k);
      place.replaceChildren(chart({title: kernel, width: Math.max(320, place.clientWidth), x: {label: 'commits, the oldest first', names: rows.map((r) => r.commit.slice(0, 8)), range: [-.5, rows.length - .5]}, y: {label: 'time of a step / reference [1]', range: spread_of(points.flatMap(([, k]) => [k.low, k.high, 1]))}}, (c) => {
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

