// ---- The run itself.

function showRun() {
  main.replaceChildren(h('h2', {}, 'This run'),
    facts([['Profile', data.profile], ['Seed', data.seed === '0' ? '' : data.seed],
      ['Shard', data.shard],
      ['Traces', data.traces.length ? data.traces.join(', ') : 'the kit\u2019s own'],
      ['Compared', data.earlier
      ? 'with an earlier run: cells say what a verdict was, and which cases are new' : ''],
      ['Cases', String(data.cases.length)],
      ['Rules', `${Object.keys(data.rules).length} named by these cases`]]),
    h('h3', {}, 'Implementations'),
    h('ul', { class: 'tiles' }, data.implementations.map(tile)),
    ...data.implementations.filter((one) => one.stderr).map((one) => h('section', {},
      h('h3', {}, 'Standard error of ', one.label),
      h('pre', { tabindex: '0', class: 'stderr' }, one.stderr))),
    h('h3', {}, 'What verdicts mean'),
    h('dl', { class: 'facts' }, [
      ['pass', 'Everything that the case asks for was seen.'],
      ['weak', 'Only rules that say SHOULD were broken.'],
      ['inconclusive', 'No MUST was broken, but not all of it could be seen.'],
      ['fail', 'A rule was broken; or the implementation died, hung, or made no sense.'],
      ['error', 'The implementation did not start, or the case makes no sense.'],
      ['skip', 'The implementation says that it cannot do what the case needs.'],
    ].map(([name, text]) =>
      h('div', {}, h('dt', {}, h('span', { class: verdictClass(name) }, name)),
        h('dd', {}, text)))),
    h('h3', {}, 'Keys'),
    h('dl', { class: 'facts' }, h('div', {}, h('dt', {}, h('kbd', {}, '/')),
      h('dd', {}, 'Search, in cases and in rules'))));
}

// ---- Where we are: #/view/part/part?query

const kViews = [['cases', 'Cases'], ['rules', 'Rules'], ['figures', 'Figures'],
  ['run', 'This run']];
const kPages = { cases: showCases, rules: showRules, rule: showRule, case: showCase,
  figures: showFigures, run: showRun };

function part(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;  // Not ours: it names nothing that there is.
  }
}

function route() {
  const at = location.hash.indexOf('?');
  const path = at < 0 ? location.hash : location.hash.slice(0, at);
  const query = at < 0 ? '' : location.hash.slice(at + 1);
  const [wanted, ...rest] = path.slice(2).split('/').map(part);
  const view = Object.hasOwn(kPages, wanted) ? wanted : 'cases';
  kPages[view](...(view === 'cases' ? [query] : rest.filter(Boolean)));
  const current = { rule: 'rules', case: 'cases' }[view] || view;
  document.getElementById('views').replaceChildren(...kViews.map(([name, text]) =>
    h('a', { href: hashOf(name), 'aria-current': name === current ? 'page' : null }, text)));
  const title = main.querySelector('h2');
  document.title = `${title.textContent} - Rubric conformance report`;
}

window.addEventListener('hashchange', () => {
  if (location.hash === '#main') return;
  route();
  window.scrollTo(0, 0);
  main.focus({ preventScroll: true });
});
document.getElementById('skip').addEventListener('click', (event) => {
  event.preventDefault();
  main.focus();
});
document.addEventListener('keydown', (event) => {
  const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName);
  if (event.key !== '/' || typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const search = document.getElementById('search');
  if (!search) return;
  event.preventDefault();
  search.focus();
  search.select();
});

// ---- Light and dark: as the system has it, until the reader says otherwise.

const theme = document.getElementById('theme');
const system = matchMedia('(prefers-color-scheme: dark)');
const isDark = () => (document.documentElement.dataset.theme || (system.matches ? 'dark' : 'light'))
  === 'dark';
const paint = () => theme.setAttribute('aria-pressed', String(isDark()));
theme.addEventListener('click', () => {
  document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
  paint();
});
system.addEventListener('change', paint);
paint();
route();
