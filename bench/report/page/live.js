'use strict';
// The page of tauext-live --page. It gets messages as LCM has them and decodes them by their .lcm files.
const TYPES = new Map();  // by hash
const READ = {
  int8_t: [1, (v, at) => v.getInt8(at)], int32_t: [4, (v, at) => v.getInt32(at)],
  int64_t: [8, (v, at) => Number(v.getBigInt64(at))], double: [8, (v, at) => v.getFloat64(at)],
};

// constants stand before the field whose values they are
function type_of(name, {hash, text}) {
  const fields = [];
  let names = {};
  for (const line of text.split('\n')) {
    const field = /^\s+(\w+)\s+(\w+)(?:\[(\w+)\])?\s*;/.exec(line), constants = /^\s*const \w+ (.*);/.exec(line);
    if (constants) for (const [, n, value] of constants[1].matchAll(/k(\w+) = (\d+)/g)) names[value] = n;
    if (field) fields.push({type: field[1], key: field[2], count: field[3], names}), names = {};
  }
  return {name, hash, fields, names_of: (key) => fields.find((f) => f.key === key).names};
}

// A message; throws where its bytes are no message of ours.
function decode(view) {
  const type = TYPES.get(view.getBigUint64(0).toString(16).padStart(16, '0')), message = {type: type.name};
  let at = 8;
  const one = (kind) => {
    if (kind !== 'string') {
      const [size, read] = READ[kind];
      return at += size, read(view, at - size);
    }
    const length = view.getInt32(at), from = at + 4;
    at = from + length;
    return new TextDecoder().decode(new Uint8Array(view.buffer, view.byteOffset + from, length - 1));
  };
  for (const {type: kind, key, count} of type.fields) {
    const n = count && Number(message[count] ?? count);
    if (n > 1000) throw new RangeError(`${n} values of ${key}`);
    message[key] = count ? Array.from({length: n}, () => one(kind)) : one(kind);
  }
  if (at !== view.byteLength) throw new RangeError(`${view.byteLength} bytes of ${type.name}`);
  return message;
}

// Rows of [least, largest] of so many columns over time, for 10 minutes; and of 16 rows at once, for long windows.
const KEPT = 600, FOLD = 16;
class Rows {
  constructor(width, folds = true) {
    Object.assign(this, {width, n: 0, back: Infinity, t: new Float64Array(64), low: new Float32Array(64 * width), high: new Float32Array(64 * width)});
    this.coarse = folds ? new Rows(width, false) : null;
  }
  add(t, low, high) {
    if (this.n && t < this.t[this.n - 1]) {  // one time that goes back says nothing, a second one near it that the stream goes on there
      if (!(t >= this.back && t < this.back + 10)) return void (this.back = t);
      const kept = this.from(this.back);
      this.n = this.n - kept > 1 ? 0 : kept;  // one row ahead of it was wrong, more are of another run
      if (this.coarse) this.coarse.n = this.n ? this.coarse.from(this.back) : 0;
    }
    this.back = Infinity;
    if (this.n === this.t.length) this.make_room();
    this.t[this.n] = t;
    this.low.set(low, this.n * this.width);
    this.high.set(high, this.n * this.width);
    if (++this.n % FOLD || !this.coarse) return;
    const all = (values, best) => Array.from({length: this.width}, (_, j) => best(...Array.from({length: FOLD}, (_, k) =>
      values[(this.n - 1 - k) * this.width + j]).filter(Number.isFinite)));
    this.coarse.add(t, all(this.low, Math.min), all(this.high, Math.max));
  }
  make_room() {  // what is too old goes, else there is more of it
    const old = Math.floor(this.from(this.t[this.n - 1] - KEPT) / FOLD) * FOLD, keep = this.n - old;
    const moved = (from, width) => {
      const to = new from.constructor(keep > 0.75 * this.n ? 2 * from.length : from.length);
      to.set(from.subarray(old * width, this.n * width));
      return to;
    };
    [this.t, this.low, this.high, this.n] = [moved(this.t, 1), moved(this.low, this.width), moved(this.high, this.width), keep];
  }
  from(t) {  // the first row at t or later
    let a = 0, b = this.n;
    while (a < b) { const m = (a + b) >> 1; if (this.t[m] < t) a = m + 1; else b = m; }
    return a;
  }
  // two points for each stretch of time of so many seconds from t0 on: its least value and its largest, first the one nearer to the last
  points(j, t0, step, count) {
    const out = new Array(2 * count).fill(null), last = this.from(t0 + step * count);
    let k = this.from(t0);
    if (this.coarse && last - k > 3 * FOLD * count) return this.coarse.points(j, t0, step, count);
    for (; k < last; ++k) {
      const i = 2 * Math.min(count - 1, Math.floor((this.t[k] - t0) / step)), at = k * this.width + j;
      if (!Number.isFinite(this.low[at])) continue;
      if (out[i] === null || this.low[at] < out[i]) out[i] = this.low[at];
      if (out[i + 1] === null || this.high[at] > out[i + 1]) out[i + 1] = this.high[at];
    }
    let before = null;
    for (let i = 0; i < out.length; i += 2) {
      if (out[i] === null) continue;
      if (before !== null && Math.abs(out[i + 1] - before) < Math.abs(out[i] - before)) [out[i], out[i + 1]] = [out[i + 1], out[i]];
      before = out[i + 1];
    }
    return out;
  }
}

// ---- what has come: rows by quantity and then by whose they are
const QUANTITIES = {tau_ext: 'N m', force: 'N', moment: 'N m', link: '1', statistic: '1', q: 'rad', qd: 'rad/s', tau: 'N m'};
const FLOORS = {tau_ext: 0.02, force: 0.1, moment: 0.02, link: 1, statistic: 1.2, q: 1e-3, qd: 1e-3, tau: 0.02};
const MEASURED = ['q', 'qd', 'tau'], WRENCH = ['force', 'moment'];
const seen = {messages: 0, lost: 0, rejected: 0, frames: 0, text: ''};
const all = Object.fromEntries(Object.keys(QUANTITIES).map((quantity) => [quantity, new Map()])), streams = new Map();
let marks = [], contacts = [], newest = -Infinity, oldest = Infinity, leads = '', site = '';  // leads: the channel whose measurements are shown; site: of forces
function keep(quantity, who, t, low, high = low) {
  if (!all[quantity].has(who)) all[quantity].set(who, new Rows(low.length)), layout = '';
  if (all[quantity].get(who).width === low.length) all[quantity].get(who).add(t, low, high);
}

// What comes was judged before it was sent: a number that goes back is a sender that has started anew.
function count(stream, {seq, utime}) {
  const last = streams.get(stream);
  if (last) seen.lost += Math.max(0, seq - last.next);
  streams.set(stream, {next: seq + 1, t: utime / 1e6, heard: clock, goes_on: Boolean(last)});
}
const speaks = (stream) => stream?.heard > clock - 1000;

// What is seen ends at the time that most streams have come to, and of two halves at that of the first stream: no stream moves it alone,
// and none with a single message.
function settle() {
  const now = [...streams.values()].filter(speaks), on = now.filter((s) => s.goes_on), times = (on.length ? on : now).map((s) => s.t);
  if (times.length % 2 === 0) times.push(times[0]);
  const time = times.sort((a, b) => a - b)[times.length >> 1];
  if (time === undefined) return;
  if (time < newest - 1) {  // they have begun anew; what has not is over
    for (const rows of Object.values(all)) for (const [who, r] of rows) if (r.t[r.n - 1] > time + 1) rows.delete(who), layout = '';
    [marks, contacts] = [marks.filter((mark) => mark.t < time + 1), contacts.filter(([begin]) => begin < time + 1)];
    oldest = time, site = '';
  }
  newest = time;
  marks = marks.filter((mark) => Math.abs(mark.t - newest) < KEPT);
  contacts = contacts.filter(([, end]) => Math.abs(end - newest) < KEPT);
}

function take(channel, m) {
  if (m.type === 'summary_t') return;
  const t = m.utime / 1e6, pair = `${m.estimator}+${m.detector}`, at = m.site || 'end_effector';
  count({detection_t: pair, force_t: `force of ${m.estimator} at ${at}`}[m.type] ?? channel, m);
  oldest = Math.min(oldest, t);
  if (m.type === 'detection_t') {
    keep('statistic', pair, t, [m.score]);
    const contact = TYPES.get('detection_t').names_of('contact')[m.contact] ?? '?';
    if (m.mark) marks.push({t: m.mark_utime / 1e6, who: m.estimator, name: `${m.estimator} ${contact === 'None' ? m.detector : contact.toLowerCase()}`});
    if (m.contact_true && contacts.at(-1)?.[0] <= t && contacts.at(-1)[1] >= t - 0.1) contacts.at(-1)[1] = t;
    else if (m.contact_true) contacts.push([t, t]);
    return;
  }
  if (m.type === 'force_t') {
    site ||= at;
    const who = m.estimator + (at === site ? '' : ` at ${at}`);
    keep('force', who, t, m.force);
    keep('link', who, t, [m.link]);
    if (all.moment.size || m.moment.some((x) => x !== 0)) keep('moment', who, t, m.moment);
    return;
  }
  const n = m.n, first = (x) => x.slice(0, n), estimator = channel.replace(/^TAUEXT_ESTIMATE_/, ''), who = estimator === 'reference' ? channel : estimator;
  if (m.type === 'estimate_t') keep('tau_ext', who, t, first(m.tau_ext_hat_min), first(m.tau_ext_hat_max));
  if (!speaks(streams.get(leads))) leads = channel;  // all estimates carry the same measurements
  if (leads !== channel) return;
  for (const quantity of MEASURED) keep(quantity, 'measured', t, first(m[quantity]));
  if (m.reference) keep('tau_ext', 'reference', t, first(m.tau_ext_true_min ?? m.tau_ext_true), first(m.tau_ext_true_max ?? m.tau_ext_true));
}

let clock = 0, frame_at = 0;  // [ms] clock: while others speak, so that a page that was held up takes nobody for silent
function take_frame(buffer) {
  clock += Math.min(100, performance.now() - frame_at), frame_at = performance.now();
  const view = new DataView(buffer);
  for (let at = 0; at < view.byteLength;) {
    const name = view.getUint16(at, true), size = view.getUint32(at + 2, true), from = at + 6 + name;
    ++seen.messages;
    try {
      take(new TextDecoder().decode(new Uint8Array(buffer, at + 6, name)), decode(new DataView(buffer, from, size)));
    } catch (e) {
      ++seen.rejected;
    }
    at = from + size;
  }
  settle();
}

// ---- what is seen: the last seconds, or what was chosen
const state = {seconds: 10, paused: null};  // paused: [from, to]
const window_now = () => {
  const end = Math.max(newest, oldest + state.seconds);  // a time before the first sample is none
  return state.paused ?? [end - state.seconds, end];
};
const order = (who) => who === 'reference' ? -1 : [...all.tau_ext.keys()].filter((w) => w !== 'reference').indexOf(who.split(/\+| at /)[0]);
const style_of = (who) => ({width: 1, ...(order(who) < 0 ? {color: themed('--truth'), dash: []} : look(order(who)))});  // a pixel: wider takes longer
let layout = '', plots = [];
function lay_out() {
  plots.forEach((p) => p.u.destroy());
  document.getElementById('plots').replaceChildren();
  plots = [];
  const plot = (title, quantity, lines) => {
    const place = element('div', {class: 'plot'}), p = {lines, place, seen: true};
    document.getElementById('plots').append(place);
    p.u = time_plot(place, {title, unit: `${quantity} [${QUANTITIES[quantity]}]`, width: place.clientWidth, height: 200, floor: FLOORS[quantity], sync: 'live',
      x_range: (u, min, max) => [min, max], data: [[], ...lines.map(() => [])], series: lines.map((l) => ({label: l.label, ...l.style})),
      over: () => [contacts, marks.map((m) => ({...m, color: style_of(m.who).color}))], select: (from, to) => choose([from, to])});
    p.u.over.addEventListener('dblclick', () => choose(null));
    new IntersectionObserver(([e]) => { p.seen = e.isIntersecting, drawn = -1; }).observe(place);
    plots.push(p);
  };
  const names = [...all.tau_ext.keys()].sort((a, b) => order(a) - order(b)), joints = Math.max(0, ...[...all.tau_ext.values()].map((r) => r.width));
  for (let j = 0; j < joints; ++j) plot(`joint ${j + 1}`, 'tau_ext', names.map((w) => ({rows: all.tau_ext.get(w), j, label: w, style: style_of(w)})));
  for (const quantity of WRENCH.filter((w) => all[w].size)) {
    for (const [j, axis] of ['x', 'y', 'z'].entries())
      plot(`${quantity} ${axis} at ${site}, axes of the base`, quantity, [...all[quantity]].map(([w, rows]) => ({rows, j, label: w, style: style_of(w)})));
  }
  if (all.link.size) plot('link touched, 0: none', 'link', [...all.link].map(([w, rows]) => ({rows, j: 0, label: w, style: style_of(w)})));
  const pairs = [...all.statistic.keys()];
  const threshold = {rows: {points: (j, from, step, count) => new Array(2 * count).fill(1)}, label: 'threshold', style: {color: themed('--quiet'), dash: [4, 4]}};
  if (pairs.length) plot('statistics of detectors', 'statistic', [threshold, ...pairs.map((w) => ({rows: all.statistic.get(w), j: 0, label: w, style: style_of(w)}))]);
  for (const quantity of MEASURED) {
    for (const [, rows] of all[quantity]) plot(`measured ${quantity}`, quantity, Array.from({length: rows.width}, (_, j) => ({rows, j, label: `joint ${j + 1}`, style: {width: 1, ...look(j)}})));
  }
}

function choose(window) {
  if (!window?.every(Number.isFinite)) window = null;  // nothing has come yet
  state.paused = window;
  document.getElementById('pause').textContent = window ? 'follow' : 'pause';
  drawn = -1;
}
const shift = (share) => { const [a, b] = window_now(), d = share * (b - a); choose([a + d, b + d]); };

let drawn = -1;
function draw() {
  requestAnimationFrame(draw);
  if (!Number.isFinite(newest) || drawn === (state.paused ? 0 : seen.messages)) return;
  if (!layout) lay_out(), layout = 'done';
  drawn = state.paused ? 0 : seen.messages;
  ++seen.frames;
  const [from, to] = window_now(), count = 400, step = (to - from) / count, begin = Math.floor(from / step) * step;
  const x = Array.from({length: 2 * count + 2}, (_, i) => begin + step * ((i >> 1) + (i % 2 ? 0.75 : 0.25)));
  for (const p of plots.filter((p) => p.seen)) {
    p.u.setData([x, ...p.lines.map((l) => l.rows.points(l.j, begin, step, count + 1))], false);
    p.u.setScale('x', {min: from, max: to});
  }
}

function csv() {
  const [from, to] = window_now(), lines = ['quantity,source,t_s,joint,least,largest'];
  for (const [quantity, by] of Object.entries(all)) {
    for (const [who, r] of by) {
      for (let k = r.from(from); k < r.n && r.t[k] <= to; ++k) {
        for (let j = 0; j < r.width; ++j) lines.push([quantity, who, r.t[k], j + 1, r.low[k * r.width + j], r.high[k * r.width + j]].join());
      }
    }
  }
  return lines.join('\n') + '\n';
}

function connect() {
  const socket = new WebSocket(`ws://${location.host}/stream`);
  socket.binaryType = 'arraybuffer';
  socket.onmessage = ({data}) => take_frame(data);
  socket.onopen = () => { seen.text = 'connected'; };
  socket.onclose = ({code}) => {
    if (seen.text === 'connected') seen.text = `the stream ${code === 1000 ? 'is over' : 'broke off'}; asked for again every 2 s`;
    setTimeout(connect, 2000);
  };
}

document.getElementById('controls').append(
  element('button', {id: 'pause', onclick: () => choose(state.paused ? null : window_now())}, 'pause'), ' the last ',
  select('seconds', ['5', '10', '30', '60', '300', '600'], '10', (s) => { state.seconds = Number(s); choose(null); }), ' s ',
  element('button', {onclick: () => shift(-0.5)}, '◀ earlier'), element('button', {onclick: () => shift(0.5)}, 'later ▶'),
  element('button', {onclick: () => save('live.csv', 'text/csv', csv())}, 'CSV of what is seen'));
addEventListener('resize', () => { layout = '', drawn = -1; });
let before = 0;
setInterval(() => {
  document.getElementById('status').textContent = `${seen.text}; ${seen.messages - before} messages/s, ${seen.messages} in all, ${seen.lost} lost, `
    + `${seen.rejected} rejected`;
  before = seen.messages;
}, 1000);
fetch('/stream.json').then((r) => r.json()).then(({title, types}) => {
  document.title = document.querySelector('h1').textContent = `${title}: tauext live`;
  for (const [name, t] of Object.entries(types)) TYPES.set(t.hash, type_of(name, t)), TYPES.set(name, TYPES.get(t.hash));
  connect();
  draw();
});
