// Provenance, and the order in which the sections are made.
function provenance() {
  const keys = [...new Set(FILES.flatMap((f) => Object.entries(f.data.context).filter(([, v]) => typeof v !== 'object').map(([k]) => k).filter((k) => !['executable', 'host_name', 'library_build_type'].includes(k))))];
  const place = element('div', {class: 'wide'}, element('table', {id: 'provenance'}, element('thead', {}, element('tr', {}, element('th', {}, ''), ...FILES.map((f) => element('th', {class: 'text'}, f.name)))),
    element('tbody', {}, element('tr', {}, element('td', {}, 'kind'), ...FILES.map((f) => element('td', {class: 'text'}, f.kind))),
      ...keys.map((k) => element('tr', {}, element('td', {}, {num_cpus: 'CPUs', mhz_per_cpu: 'MHz of a CPU', cpu_scaling_enabled: 'CPU scaling', load_avg: 'load'}[k] ?? k), ...FILES.map((f, i) => element('td', {class: 'text', 'data-json': k in f.data.context && `/${i}/data/context/${k}`}, String(f.data.context[k] ?? '–'))))))));
  section('sources', 'Where this comes from', 'This page holds the files as they were read; tauext-report reads it as one of them.',
    element('button', {onclick: () => FILES.forEach((f) => save(f.name, 'application/json', JSON.stringify(f.data)))}, 'the files as JSON'), ...table_buttons(place, 'sources'), place);
}

if (ENTRIES.length) heat_map(), ranking();
requestAnimationFrame(() => setTimeout(() => {  // what takes longer, once something is seen
  if (TRACES.length) runs(), step_answers();
  trade_offs(), detection(), standings(), meetings(), costs(), seeds(), history_of_gate(), provenance();
  document.body.dataset.done = 'yes';
}));
