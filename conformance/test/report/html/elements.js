// Draws the report from the data inside the page. Text from elsewhere becomes text nodes and
// attributes only, never markup; charts are markup that the program has written and escaped.
const data = JSON.parse(document.getElementById('data').textContent);
const main = document.getElementById('main');

// In the order in which readers want to see them.
const kVerdicts = ['fail', 'error', 'weak', 'inconclusive', 'skip', 'pass'];

// So cases are in this order, too, each by its gravest run; what is as expected comes after.
const gravity = (one) => Math.min(...one.runs.map((run) =>
  kVerdicts.indexOf(run.verdict) + (run.unexpected ? 0 : kVerdicts.length)));
data.cases.sort((a, b) => gravity(a) - gravity(b));

function add(element, children) {
  for (const child of children.flat(Infinity)) {
    if (child === null || child === undefined || child === false || child === '') continue;
    element.append(child instanceof Node ? child : String(child));
  }
  return element;
}

function fill(element, attributes) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== null && value !== undefined && value !== false) {
      element.setAttribute(name, value);
    }
  }
  return element;
}

const h = (tag, attributes, ...children) =>
  add(fill(document.createElement(tag), attributes), children);
const s = (tag, attributes, ...children) =>
  add(fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes), children);

// A region that scrolls on its own can be reached by keyboard.
const scroll = (label, ...children) =>
  h('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': label }, children);

const facts = (rows) => h('dl', { class: 'facts' },
  rows.filter(([, value]) => value && value.length !== 0)
    .map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, value))));

const count = (number, one, many) => `${number} ${number === 1 ? one : many || one + 's'}`;

// ---- Where things are.

const hashOf = (...parts) => '#/' + parts.map(encodeURIComponent).join('/');
const caseHash = (name, run) =>
  hashOf('case', name, data.implementations[run.implementation].label, run.repeat + 1);
const ruleOf = (id) => Object.hasOwn(data.rules, id) ? data.rules[id] : null;
const ruleLink = (id) =>
  ruleOf(id) ? h('a', { class: 'mono', href: hashOf('rule', id) }, id)
    : h('span', { class: 'mono' }, id);
const familyOf = (id) => id.split('-')[0];
const families = [...new Set(Object.keys(data.rules).map(familyOf))];
const isCompared = data.implementations.map((_, i) => data.cases.some((one) =>
  one.runs.some((run) => run.implementation === i && run.earlier !== '')));
const isNew = (run) => run.earlier === '' && isCompared[run.implementation];
const isChanged = (run) => run.earlier !== '' && run.earlier !== run.verdict;

// ---- Verdicts.

const verdictClass = (name) => 'verdict v-' + name;

function flagsOf(run) {
  const flags = [];
  if (run.expectation === 'as_expected') flags.push('known');
  if (run.expectation === 'unexpected_pass') flags.push('was to fail');
  if (run.expectation === 'otherwise') flags.push('not as known');
  if (isChanged(run)) flags.push('was ' + run.earlier);
  if (isNew(run)) flags.push('new');
  return flags;
}

function verdict(run, link) {
  const attributes = { class: verdictClass(run.verdict) };
  const flags = flagsOf(run);
  return [link ? h('a', { ...attributes, href: link }, run.verdict)
    : h('span', attributes, run.verdict),
  flags.length > 0 && h('span', { class: 'flag' }, flags.join(', '))];
}

function showMissing(what, name) {
  main.replaceChildren(h('h2', {}, `This run has no ${what} ${name}`),
    h('p', {}, h('a', { href: '#/cases' }, 'All cases')));
}

// A label around its control, which changes `state[key]`.
function choice(label, state, key, options, changed) {
  const select = h('select', { onchange: () => { state[key] = select.value; changed(); } },
    options.map(([value, text]) => h('option', { value, selected: state[key] === value }, text)));
  return h('label', {}, label, select);
}

function searchField(state, changed) {
  const input = h('input', { type: 'search', id: 'search', value: state.text,
    autocomplete: 'off', spellcheck: 'false',
    oninput: () => { state.text = input.value; changed(); } });
  return h('label', {}, h('span', {}, 'Search ', h('kbd', {}, '/')), input);
}
