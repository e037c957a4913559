// What the report shows of traces: truth and estimates over time, and answers to a step.
const TRACED = of_kind('traces');
const run_name = (group, file) => group + (TRACED.length > 1 ? ` [${bare(file)}]` : '');
const TRACES = TRACED.flatMap((f) => f.data.groups.map((g) => ({...g, name: run_name(g.name, f)})));
function decoded(joint) {
  const bytes = Uint8Array.from(atob(joint.values), (c) => c.charCodeAt(0));
  const range = joint.high - joint.low;
  return Array.from({length: bytes.length / 2}, (_, i) => joint.low + (bytes[2 * i] + 256 * bytes[2 * i + 1]) / 65535 * range);
}
// a series' signals, each with its name and unit
const signals_of = (s, site) => [...s.joints.map((x, j) => [x, `joint ${j + 1}`, 'tau_ext [N m]']),
  ...(s.wrench || []).map((x, j) => [x, `${j < 3 ? 'force' : 'moment'} ${'xyz'[j % 3]}${site ? ' at ' + site : ''}, axes of the base`, j < 3 ? 'force [N]' : 'moment [N m]'])];
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
    place.plots = plots = signals_of(g.series[0], g.site).map(([, title, unit], j, all) => {
      const largest = Math.max(1e-6, ...all.filter((s) => s[2] === unit).map(([s]) => s.high - s.low));
      const at = g.series.findIndex((s) => s.name === focus) + 1;
      return time_plot(place, {title, unit, width: place.clientWidth || 1000, height: all.length > 1 ? 250 : 400, sync: 'run',
        data: [t, ...g.series.map((s) => keep(decoded(signals_of(s)[j][0])))], floor: 1e-3 * largest,
        series: g.series.map((s, i) => ({label: s.name, ...styles.get(s.name), width: i === 0 ? 2 : s.name === focus ? 1.8 : 1, show: shown(s)})),
        bands: at > 1 ? [{series: [at, 1], fill: 'rgba(0, 114, 178, .15)'}, {series: [1, at], fill: 'rgba(0, 114, 178, .15)'}] : [],
        over: () => [g.contacts, marks]});
    });
    keys.replaceChildren(...g.series.slice(1).map((s) => element('label', {class: 'key', style: `color: ${styles.get(s.name).color}`},
      element('input', {type: 'checkbox', checked: shown(s), onchange: (c) => { c.target.checked ? hidden.delete(s.name) : hidden.add(s.name); draw(); }}), sample_of(styles.get(s.name)), ' ' + s.name)));
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
  section('runs', 'Truth and estimates', 'The shaded area is the error of one estimator; orange spans are contacts. Drag to zoom, double-click to see all; below each plot the values at the cursor. '
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
    const lines = g.series.map((s) => keep(decoded(s.joints[j])).map((x, k) => [t[k] - begin, x / end]));
    const shares = lines.flat().filter(([at]) => at > -.05 && at < 1).map(([, x]) => Math.min(2, Math.max(-1, x)));  // one that diverges does not hide the others
    return chart({title: `${g.name}, joint ${j + 1}`, x: {label: 'time from the step [s]', range: [-0.05, 1]}, y: {label: 'estimate / step [1]', range: spread_of(shares)}}, (c) =>
      lines.forEach((line, i) => c.line(line, i === 0 ? {color: 'var(--truth)', dash: []} : look(i - 1), g.series[i].name)));
  }));
  section('steps', 'Answers to a step', 'Estimates of a load that begins at once, as shares of it.', element('div', {class: 'pair'}, ...places));
}

