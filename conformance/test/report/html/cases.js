// ---- All cases on all implementations.

const kNoFilter = { text: '', verdict: 'all', role: 'all', family: 'all' };
const filter = { ...kNoFilter };
const kChoices = { verdict: ['unexpected', 'changed', 'new', ...kVerdicts],
  role: data.roles, family: families };
const kRulesShown = 4;

const wordsOf = (one) => [one.name, one.comment, one.requirements.join(' '),
  ...one.runs.map((run) => run.headline)].join(' ').toLowerCase();
const searchable = new Map(data.cases.map((one) => [one, wordsOf(one)]));

function fits(one) {
  const words = filter.text.toLowerCase().split(/\s+/).filter(Boolean);
  if (!words.every((word) => searchable.get(one).includes(word))) return false;
  if (filter.role !== 'all' && !one.roles.includes(filter.role)) return false;
  if (filter.family !== 'all' && !one.requirements.some((id) => familyOf(id) === filter.family)) {
    return false;
  }
  if (filter.verdict === 'all') return true;
  if (filter.verdict === 'unexpected') return one.runs.some((run) => run.unexpected);
  if (filter.verdict === 'changed') return one.runs.some(isChanged);
  if (filter.verdict === 'new') return one.runs.some(isNew);
  return one.runs.some((run) => run.verdict === filter.verdict);
}

// The address holds the filter, so that it can be kept and shared.
function casesHash(state) {
  const query = new URLSearchParams();
  for (const [key, value] of Object.entries(state)) {
    if (value !== kNoFilter[key]) query.set(key, value);
  }
  const text = query.toString();
  return '#/cases' + (text ? '?' + text : '');
}

function readFilter(query) {
  const given = new URLSearchParams(query);
  for (const key of Object.keys(kNoFilter)) {
    const value = given.get(key) ?? '';
    filter[key] = key === 'text' || kChoices[key].includes(value) ? value : kNoFilter[key];
  }
}

function bar(counts, total) {
  const drawn = s('svg', { class: 'bar', viewBox: '0 0 100 8', preserveAspectRatio: 'none',
    'aria-hidden': 'true' });
  let x = 0;
  for (const name of [...kVerdicts].reverse()) {
    const width = total ? counts[name] / total * 100 : 0;
    if (width) drawn.append(s('rect', { class: 's-' + name, x, y: 0, width, height: 8 }));
    x += width;
  }
  return drawn;
}

function ruleWords(rules) {
  const parts = [`${rules.kept} of ${count(rules.all, 'rule')} kept`];
  if (rules.broken) parts.push(`${rules.broken} broken`);
  if (rules.suspected) parts.push(`${rules.suspected} suspected`);
  if (rules.undecided) parts.push(`${rules.undecided} undecided`);
  if (rules.untried) parts.push(`${rules.untried} not tried`);
  return parts.join(', ');
}

function tile(implementation) {
  const counts = implementation.counts;
  const total = kVerdicts.reduce((sum, name) => sum + counts[name], 0);
  const words = kVerdicts.filter((name) => counts[name]).map((name, i) => [i ? ' ' : '',
    h('a', { class: verdictClass(name), href: casesHash({ ...kNoFilter, verdict: name }) },
      `${counts[name]} ${name}`)]);
  return h('li', {},
    h('h3', {}, implementation.label),
    h('div', { class: 'soft mono target', title: implementation.target }, implementation.target),
    bar(counts, total),
    h('div', {}, implementation.dishonest
      ? [h('span', { class: verdictClass('error') }, 'refused'), ' ', implementation.dishonest]
      : words.length ? words : 'nothing was run'),
    implementation.incomplete && h('div', {}, `incomplete: ${implementation.incomplete}`),
    implementation.outside && h('div', {}, `outside of the cases: ${implementation.outside}`),
    implementation.advice.map((one) => h('div', {}, one)),
    total > 0 && h('div', { class: 'soft' }, ruleWords(implementation.rules)),
    h('div', { class: 'soft' },
      `${implementation.roles.join(', ').replace('_', ' ') || 'no role'} \u00b7 ` +
      `${(implementation.wall_ms / 1000).toFixed(2)} s`));
}

function rulesCell(one) {
  const shown = one.requirements.slice(0, kRulesShown);
  const more = one.requirements.length - shown.length;
  return h('span', { class: 'rules' }, shown.map(ruleLink),
    more > 0 && h('span', { class: 'soft', title: one.requirements.join(' ') }, `+${more}`));
}

function resultCell(one, implementation) {
  const runs = one.runs.filter((run) => run.implementation === implementation);
  const alone = data.implementations.length === 1 && runs.length === 1;
  return h('td', {}, runs.map((run) => {
    const why = run.verdict === 'pass' && !run.unexpected ? '' : run.headline;
    const badge = verdict(run, caseHash(one.name, run));
    if (!alone && why) badge[0].setAttribute('title', why);
    return h('div', { class: 'result' }, badge,
      alone && why && h('span', { class: 'why', title: why }, why));
  }));
}

function caseRow(one) {
  return h('tr', {},
    h('th', { scope: 'row', class: 'mono' },
      h('a', { href: caseHash(one.name, one.runs[0]), title: one.comment }, one.name)),
    data.implementations.map((_, i) => resultCell(one, i)),
    h('td', {}, rulesCell(one)));
}

function stale() {
  if (!data.stale.length) return null;
  return h('section', { class: 'failure' }, h('h3', {}, 'Expectations that are not true'),
    h('ul', {}, data.stale.map((one) =>
      h('li', {}, h('code', {}, one.place), ': ', one.text))));
}

// Lists the cases of an earlier run that this one lacks; their rows would be empty.
function gone() {
  if (!data.gone.length) return null;
  return h('details', { id: 'gone' },
    h('summary', {}, `${count(data.gone.length, 'case')} of the earlier run ` +
      `${data.gone.length === 1 ? 'is' : 'are'} gone, or not chosen this time`),
    scroll('Cases that are gone', h('table', {},
      h('thead', {}, h('tr', {}, ['Case', 'On', 'Was'].map((name) =>
        h('th', { scope: 'col' }, name)))),
      h('tbody', {}, data.gone.map((one) => h('tr', {},
        h('th', { scope: 'row', class: 'mono' }, one.name), h('td', {}, one.implementation),
        h('td', {}, h('span', { class: verdictClass(one.was) }, one.was))))))));
}

function filters(changed) {
  const has = (wanted) => data.cases.some((one) => one.runs.some(wanted));
  const verdicts = [['all', 'all'], ['unexpected', 'not as expected'],
    ...(data.earlier ? [['changed', 'changed since']] : []),
    ...(has(isNew) ? [['new', 'new since']] : []),
    ...kVerdicts.filter((name) => name === filter.verdict || has((run) => run.verdict === name))
      .map((name) => [name, name])];
  const roles = [['all', 'all'], ...data.roles.map((name) => [name, name.replace('_', ' ')])];
  return h('form', { class: 'filters', role: 'search',
    onsubmit: (event) => event.preventDefault() },
  searchField(filter, changed),
  choice('Verdict', filter, 'verdict', verdicts, changed),
  choice('Role', filter, 'role', roles, changed),
  choice('Rules', filter, 'family',
    [['all', 'all'], ...families.map((name) => [name, name])], changed),
  h('button', { type: 'button', onclick: () => {
    Object.assign(filter, kNoFilter);
    changed();
    showCases();
    document.getElementById('search').focus();
  } }, 'Clear'));
}

function showCases(query) {
  if (query !== undefined) readFilter(query);
  const body = h('tbody', {});
  const caption = h('p', { class: 'soft count', role: 'status' });
  const refresh = () => {
    const chosen = data.cases.filter(fits);
    caption.textContent = chosen.length === data.cases.length
      ? count(chosen.length, 'case') : `${chosen.length} of ${count(data.cases.length, 'case')}`;
    body.replaceChildren(...chosen.map(caseRow));
  };
  const changed = () => {
    refresh();
    history.replaceState(null, '', casesHash(filter));
  };
  main.replaceChildren(
    h('h2', {}, 'Cases'),
    h('ul', { class: 'tiles' }, data.implementations.map(tile)),
    ...[stale(), gone()].filter(Boolean),
    filters(changed), caption,
    scroll('Matrix of cases', h('table', { id: 'matrix',
      class: data.implementations.length > 1 ? 'many' : 'one' },
      h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Case'),
        data.implementations.map((one) => h('th', { scope: 'col' }, one.label)),
        h('th', { scope: 'col' }, 'Rules'))),
      body)));
  refresh();
}
