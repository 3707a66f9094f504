// ---- One case on one implementation.

function showCase(name, label, number) {
  const one = data.cases.find((each) => each.name === name);
  const run = one && (label === undefined ? one.runs[0] : one.runs.find((each) =>
    data.implementations[each.implementation].label === label &&
    each.repeat + 1 === Number(number || 1)));
  if (!run) return showMissing('case', [name, label].filter(Boolean).join(' on '));
  const implementation = data.implementations[run.implementation];
  const log = logView(run);
  main.replaceChildren(
    neighbours(one, run),
    h('h2', {}, h('span', { class: 'mono' }, name), ' ', verdict(run),
      h('span', { class: 'on' }, ' on ', implementation.label,
        run.repeat ? `, time ${run.repeat + 1}` : '')),
    h('p', { class: 'comment' }, one.comment),
    h('div', { class: 'columns' },
      h('div', {},
        failuresView(run),
        !run.failures.length && run.reason &&
          h('section', { class: 'failure is-' + run.verdict }, h('h3', {}, 'Why'),
            h('p', {}, run.reason)),
        run.stderr && [h('h3', {}, 'Standard error'),
          h('pre', { tabindex: '0', class: 'stderr' }, run.stderr)],
        h('h3', {}, 'What happened'),
        run.chart === null
          ? h('p', { class: 'soft' }, 'Nothing was given, and nothing came.')
          : chartView(run.chart, (i) => log.pick(i), run.log),
        h('h3', {}, 'Log'), log.element),
      h('aside', { 'aria-label': 'About this case' }, aboutCase(one, run))),
    h('h3', {}, 'The case'), source(one, run));
}

// Links to the cases before and after, among those that the matrix shows.
function neighbours(one, run) {
  const chosen = data.cases.filter((each) => each === one || fits(each));
  const at = chosen.indexOf(one);
  const link = (other, text) => {
    if (!other) return null;
    const same = other.runs.find((each) => each.implementation === run.implementation);
    return h('a', { href: caseHash(other.name, same || other.runs[0]) }, text(other.name));
  };
  return h('p', { class: 'crumbs' }, h('a', { href: casesHash(filter) }, 'Cases'),
    h('span', { class: 'apart' },
      link(chosen[at - 1], (text) => '\u2190 ' + text), ' ',
      link(chosen[at + 1], (text) => text + ' \u2192')));
}

function aboutCase(one, run) {
  const others = one.runs.filter((each) => each !== run);
  return facts([
    ['Rules', h('span', { class: 'rules' }, one.requirements.map(ruleLink))],
    ['Known failure', run.expected_reason],
    ['Nodes', h('ul', { class: 'plain' }, run.nodes.map((node) => h('li', {},
      h('span', { class: 'mono' }, node.name), ' ', node.role.replace('_', ' '),
      node.island !== undefined && ` of island ${node.island}`,
      node.iut && h('span', { class: 'flag' }, 'under test'))))],
    ['File', h('code', {}, one.file)],
    ['Profile', run.profile],
    ['Seed', run.seed === '0' ? '' : run.seed],
    ['Length', `${run.length_ticks} ticks (${(run.length_ticks / 1024).toFixed(3)} s)`],
    ['Took', run.wall_ms < 0.1 ? 'below 0.1 ms' : `${run.wall_ms.toFixed(1)} ms`],
    ['Again', h('code', { class: 'command' }, run.replay)],
    ['Files', [run.rtr && h('a', { href: run.rtr }, 'log (.rtr)'), ' ',
      run.pcapng && h('a', { href: run.pcapng }, 'capture (.pcapng)')].filter(Boolean)],
    ['Also on', others.length ? h('ul', { class: 'plain' }, others.map((each) => h('li', {},
      verdict(each, caseHash(one.name, each)), ' ',
      data.implementations[each.implementation].label,
      each.repeat > 0 && `, time ${each.repeat + 1}`))) : ''],
  ]);
}

// Shows the first in full; more of them often say the same.
function failuresView(run) {
  const [first, ...rest] = run.failures;
  return [first && failureView(first, run),
    rest.length > 0 && h('details', { class: 'rest' },
      h('summary', {}, count(rest.length, 'more line') + ' of the case that ' +
        (rest.length === 1 ? 'was' : 'were') + ' not kept'),
      rest.map((failure) => failureView(failure, run)))];
}

const ms = (ticks) => (ticks * 1000 / 1024).toFixed(1);

function failureView(failure, run) {
  const when = failure.from === failure.to ? `at tick ${failure.from}`
    : `from tick ${failure.from} to ${failure.to}`;
  const real = failure.from === failure.to ? ms(failure.from)
    : `${ms(failure.from)} to ${ms(failure.to)}`;
  const asked = failure.expected !== '';
  return h('section', { class: 'failure' + (failure.weak ? ' is-weak' : '') +
      (run.verdict === 'error' ? ' is-error' : '') },
  h('h3', {}, failure.requirements.length
    ? failure.requirements.map((id, i) => [i ? ' ' : '', ruleLink(id)])
    : asked ? 'A line without a rule' : 'It broke',
  failure.weak && h('span', { class: 'flag' }, 'SHOULD'),
  failure.cause ? h('span', { class: 'flag' }, 'perhaps of ', ruleLink(failure.cause))
    : failure.implied && h('span', { class: 'flag' }, 'implied')),
  failure.requirements.map((id) => ruleOf(id) && h('p', {}, ruleOf(id).sentence)),
  h('dl', { class: 'facts' },
    asked && h('div', {},
      h('dt', {}, failure.forbidden ? 'Forbidden' : 'Expected'),
      h('dd', {}, h('code', {}, failure.expected),
        h('div', { class: 'soft' }, `${when} (${real} ms), line ${failure.line} of `,
          h('code', {}, data.cases.find((one) => one.runs.includes(run)).file)))),
    h('div', {}, h('dt', {}, asked ? 'But' : 'How'), h('dd', { class: 'but' }, failure.text)),
    failure.suspected.length > 0 && h('div', {}, h('dt', {}, 'Suspected'),
      h('dd', {}, failure.suspected.map((id, i) => [i ? ' ' : '', ruleLink(id)])))));
}

// ---- Charts, which the program has drawn.

const textOf = (line) => line.text ?? data.frames[line.frame].text;

// A row of the chart leads to its line of the log; the heads of its columns stay in sight.
function chartView(index, pick, log) {
  const drawn = document.importNode(new DOMParser()
    .parseFromString(data.charts[index], 'image/svg+xml').documentElement, true);
  for (const row of log ? drawn.querySelectorAll('.rc-row') : []) {
    const first = Number(row.dataset.lines.split(' ')[0] || NaN);
    if (!(first in log)) continue;
    row.prepend(s('title', {}, `${log[first].link} ${textOf(log[first])}`));
    row.addEventListener('click', () => pick(first));
    row.classList.add('picks');
  }
  const title = drawn.querySelector('title').textContent;
  const frame = h('div', { class: 'scroll chart-frame', tabindex: '0', role: 'region',
    'aria-label': 'Sequence chart', onscroll: () => drawn.querySelector('.rc-heads')
      .setAttribute('transform', `translate(0 ${frame.scrollTop})`) }, drawn);
  return [/ of /.test(title) && h('p', { class: 'soft' }, title), frame];
}

// ---- Every line of the log, frames with their bytes.

function logView(run) {
  const marked = new Set(run.failures.map((failure) => failure.row));
  const entries = run.log.map((line, i) => logEntry(line, marked.has(i)));
  const list = h('ol', { class: 'log' }, entries.map((entry) => h('li', {}, entry)));
  const pick = (index) => {
    const entry = entries[index];
    if ('open' in entry) entry.open = true;
    entry.scrollIntoView({ block: 'center' });
    entry.classList.add('picked');
    setTimeout(() => entry.classList.remove('picked'), 1500);
  };
  return { element: entries.length ? list : h('p', { class: 'soft' }, 'It is empty.'), pick };
}

function logEntry(line, marked) {
  const words = [h('span', { class: 'time' }, line.time), h('span', { class: 'who' }, line.node),
    h('span', { class: 'op' }, line.op), h('span', { class: 'who' }, line.link)];
  const kind = marked ? 'entry marked' : 'entry';
  if (line.frame === undefined) {
    return h('div', { class: kind }, words, h('span', { class: 'message' }, line.text));
  }
  const entry = h('details', { class: kind },
    h('summary', {}, words, h('span', { class: 'message' }, line.short)));
  entry.addEventListener('toggle', () => {
    if (entry.open && entry.children.length === 1) entry.append(hexdump(data.frames[line.frame]));
  });
  return entry;
}

function hexdump(frame) {
  const bytes = frame.hex.match(/../g) || [];
  const row = ([offset, size, path, value]) => h('tr', {},
    h('td', { class: 'offset' }, offset),
    h('td', { class: 'bytes' }, bytes.slice(offset, offset + size).join(' ')),
    h('td', {}, path), h('td', { class: 'value' }, value));
  return h('div', { class: 'frame' },
    h('p', { class: 'mono' }, frame.text),
    h('table', { class: 'hex' },
      h('caption', { class: 'visually-hidden' }, 'Bytes of the frame by field'),
      h('thead', {}, h('tr', {}, ['Offset', 'Bytes', 'Field', 'Value']
        .map((text) => h('th', { scope: 'col' }, text)))),
      h('tbody', {}, frame.fields.map(row))));
}

function source(one, run) {
  if (!one.source.length) return h('p', { class: 'soft' }, 'Its file cannot be read any more.');
  const lines = new Set(run.failures.map((failure) => failure.line));
  return h('pre', { class: 'source', tabindex: '0' }, one.source.map(([number, text]) =>
    h(lines.has(number) ? 'mark' : 'span', {},
      h('span', { class: 'number' }, String(number).padStart(4)), '  ' + text + '\n')));
}
