// ---- Rules, and how each was kept.

const ruleFilter = { text: '', state: 'all' };

const casesOf = new Map(Object.keys(data.rules).map((id) => [id, []]));
for (const one of data.cases) for (const id of one.requirements) casesOf.get(id)?.push(one);

const breaks = (run, id) => run.failures.some((failure) => !failure.implied &&
  failure.requirements.includes(id));
const suspects = (run, id) => run.failures.some((failure) =>
  failure.requirements.includes(id) || failure.suspected.includes(id));

// Returns a rule's state for an implementation: a verdict's name for its colour, and words.
function stateOf(id, implementation) {
  const runs = casesOf.get(id).flatMap((one) =>
    one.runs.filter((run) => run.implementation === implementation));
  const bad = runs.filter((run) => breaks(run, id));
  if (bad.length) {
    const weak = bad.every((run) => run.verdict === 'weak');
    return [weak ? 'weak' : 'fail', `broken in ${bad.length} of ${runs.length}`];
  }
  const odd = runs.filter((run) => suspects(run, id)).length;
  if (odd) return ['inconclusive', `suspected in ${odd} of ${runs.length}`];
  const good = runs.filter((run) => run.verdict === 'pass' || run.verdict === 'weak').length;
  if (good) return ['pass', good === runs.length ? `kept in ${good}` : `kept in ${good} of ` +
    runs.length];
  return ['skip', runs.length ? 'not decided' : 'not tried'];
}

const kRuleStates = [['all', 'all'], ['bad', 'broken'], ['inconclusive', 'suspected'],
  ['pass', 'kept'], ['skip', 'not decided']];

function ruleFits(id, states) {
  const words = ruleFilter.text.toLowerCase().split(/\s+/).filter(Boolean);
  const text = `${id} ${data.rules[id].sentence}`.toLowerCase();
  if (!words.every((word) => text.includes(word))) return false;
  if (ruleFilter.state === 'all') return true;
  const wanted = ruleFilter.state === 'bad' ? ['fail', 'weak'] : [ruleFilter.state];
  return states.some(([state]) => wanted.includes(state));
}

function showRules() {
  const ids = Object.keys(data.rules);
  const states = new Map(ids.map((id) => [id, data.implementations.map((_, i) => stateOf(id, i))]));
  const body = h('tbody', {});
  const caption = h('p', { class: 'soft count', role: 'status' });
  const row = (id) => h('tr', {},
    h('th', { scope: 'row' }, ruleLink(id)),
    h('td', { class: 'soft' }, data.rules[id].level),
    h('td', { class: 'sentence' }, data.rules[id].sentence),
    states.get(id).map(([state, text]) =>
      h('td', {}, h('span', { class: verdictClass(state) }, text))));
  const refresh = () => {
    const chosen = ids.filter((id) => ruleFits(id, states.get(id)));
    caption.textContent = chosen.length === ids.length
      ? `${count(ids.length, 'rule')} that the cases of this run name`
      : `${chosen.length} of ${count(ids.length, 'rule')}`;
    body.replaceChildren(...chosen.map(row));
  };
  main.replaceChildren(h('h2', {}, 'Rules'),
    h('form', { class: 'filters', role: 'search', onsubmit: (event) => event.preventDefault() },
      searchField(ruleFilter, refresh), choice('State', ruleFilter, 'state', kRuleStates, refresh)),
    caption,
    scroll('Rules', h('table', { id: 'rules' },
      h('thead', {}, h('tr', {},
        ['Rule', 'Level', 'Sentence', ...data.implementations.map((one) => one.label)]
          .map((text) => h('th', { scope: 'col' }, text)))),
      body)));
  refresh();
}

function showRule(id) {
  const rule = ruleOf(id);
  if (!rule) return showMissing('rule', id);
  const many = data.implementations.length > 1;
  main.replaceChildren(
    h('p', { class: 'crumbs' }, h('a', { href: '#/rules' }, 'Rules')),
    h('h2', { class: 'mono' }, id),
    h('blockquote', {}, rule.sentence),
    facts([['Level', rule.level], ['Clause', rule.clause], ['Source', rule.source],
      ['Release 1.0', rule.deployed]]),
    h('h3', {}, 'How it was kept'),
    h('ul', { class: 'plain' }, data.implementations.map((one, i) => {
      const [state, text] = stateOf(id, i);
      return h('li', {}, h('span', { class: verdictClass(state) }, text), ' ', one.label);
    })),
    h('h3', {}, 'Cases that name it'),
    scroll('Cases', h('table', {},
      h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Case'),
        data.implementations.map((one) => h('th', { scope: 'col' }, many ? one.label : 'Verdict')),
        h('th', { scope: 'col' }, 'The mistake that it catches'))),
      h('tbody', {}, casesOf.get(id).map((one) => h('tr', {},
        h('th', { scope: 'row', class: 'mono' },
          h('a', { href: caseHash(one.name, one.runs[0]) }, one.name)),
        data.implementations.map((_, i) => h('td', {},
          one.runs.filter((run) => run.implementation === i).map((run) =>
            h('div', { class: 'result' }, verdict(run, caseHash(one.name, run)))))),
        h('td', { class: 'sentence soft' }, one.comment)))))));
}
