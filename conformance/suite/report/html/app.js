'use strict';
// Draws the report from the data inside the page. Text from elsewhere becomes text nodes only.
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const main = document.getElementById('main');
  const kVerdicts = ['fail', 'error', 'weak', 'inconclusive', 'skip', 'pass'];
  const kViews = [['cases', 'Cases'], ['rules', 'Rules'], ['figures', 'Figures'], ['run', 'This run']];

  // ---- Elements.

  function add(element, children) {
    for (const child of children.flat()) {
      if (child === null || child === undefined || child === false) continue;
      element.append(child instanceof Node ? child : String(child));
    }
    return element;
  }
  function fill(element, attributes) {
    for (const [name, value] of Object.entries(attributes || {})) {
      if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
      else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value);
    }
    return element;
  }
  const h = (tag, attributes, ...children) => add(fill(document.createElement(tag), attributes), children);
  const s = (tag, attributes, ...children) =>
    add(fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes), children);

  // ---- What is where.

  const hashOf = (...parts) => '#/' + parts.map(encodeURIComponent).join('/');
  const caseHash = (name, run) => hashOf('case', name, data.implementations[run.implementation].label, run.repeat + 1);
  const families = [...new Set(Object.keys(data.rules).map((id) => id.split('-')[0]))];

  function verdict(run, link) {
    const attributes = { class: 'verdict ' + (run.verdict === 'skip' ? 'skip-verdict' : run.verdict) };
    const flags = [];
    if (run.expectation === 'as_expected') flags.push('known');
    if (run.expectation === 'unexpected_pass') flags.push('was to fail');
    if (run.expectation === 'otherwise') flags.push('not as known');
    if (run.earlier && run.earlier !== run.verdict) flags.push('was ' + run.earlier);
    const badge = link ? h('a', { ...attributes, href: link }, run.verdict) : h('span', attributes, run.verdict);
    return [badge, flags.length ? h('span', { class: 'flag' }, flags.join(', ')) : null];
  }

  const ruleLink = (id) => data.rules[id] ? h('a', { href: hashOf('rule', id) }, id) : h('span', {}, id);

  // ---- All cases.

  const filter = { text: '', verdict: 'all', role: 'all', family: 'all' };

  function fits(one) {
    const text = filter.text.trim().toLowerCase();
    if (text && ![one.name, one.comment, one.rules.join(' ')].join(' ').toLowerCase().includes(text)) return false;
    if (filter.role !== 'all' && !one.roles.includes(filter.role)) return false;
    if (filter.family !== 'all' && !one.rules.some((id) => id.split('-')[0] === filter.family)) return false;
    if (filter.verdict === 'all') return true;
    if (filter.verdict === 'unexpected') return one.runs.some((run) => run.unexpected);
    if (filter.verdict === 'changed') return one.runs.some((run) => run.earlier && run.earlier !== run.verdict);
    return one.runs.some((run) => run.verdict === filter.verdict);
  }

  function tile(implementation) {
    const total = kVerdicts.reduce((sum, name) => sum + implementation.counts[name], 0);
    const bar = s('svg', { class: 'bar', viewBox: '0 0 100 8', preserveAspectRatio: 'none', 'aria-hidden': 'true' });
    let x = 0;
    for (const name of ['pass', 'weak', 'inconclusive', 'skip', 'fail', 'error']) {
      const width = total ? implementation.counts[name] / total * 100 : 0;
      if (width) bar.append(s('rect', { class: 's-' + name, x, y: 0, width, height: 8 }));
      x += width;
    }
    const counts = kVerdicts.filter((name) => implementation.counts[name])
      .map((name) => `${implementation.counts[name]} ${name}`).join(', ');
    return h('li', {}, h('h3', {}, implementation.label),
      h('div', { class: 'soft mono' }, implementation.target), bar,
      h('div', {}, implementation.dishonest ? 'Not believed: ' + implementation.dishonest : counts || 'nothing was run'),
      h('div', { class: 'soft' }, `${implementation.roles.join(', ')}; ${(implementation.wall_ms / 1000).toFixed(2)} s`));
  }

  function choice(label, key, options, changed) {
    const select = h('select', { onchange: () => { filter[key] = select.value; changed(); } },
      options.map(([value, text]) => h('option', { value, selected: filter[key] === value }, text)));
    return h('label', {}, label, select);
  }

  function showCases() {
    const body = h('tbody', {});
    const caption = h('caption', { 'aria-live': 'polite' });
    const refresh = () => {
      const chosen = data.cases.filter(fits);
      caption.textContent = `${chosen.length} of ${data.cases.length} cases`;
      body.replaceChildren(...chosen.map((one) => h('tr', {},
        h('th', { scope: 'row', class: 'mono' }, one.runs.length
          ? h('a', { href: caseHash(one.name, one.runs[0]) }, one.name) : one.name),
        data.implementations.map((implementation, i) => h('td', {},
          one.runs.filter((run) => run.implementation === i).map((run) => verdict(run, caseHash(one.name, run))))),
        h('td', {}, h('span', { class: 'rules' }, one.rules.map(ruleLink))))));
    };
    const search = h('input', { type: 'search', id: 'search', placeholder: 'name, rule, or words', value: filter.text,
      oninput: () => { filter.text = search.value; refresh(); } });
    const verdicts = [['all', 'all'], ['unexpected', 'not as expected'],
      ...(data.earlier ? [['changed', 'changed since']] : []), ...kVerdicts.map((name) => [name, name])];
    main.replaceChildren(
      h('h2', {}, 'Cases'),
      h('ul', { class: 'tiles' }, data.implementations.map(tile)),
      stale(),
      h('form', { class: 'filters', role: 'search', onsubmit: (event) => event.preventDefault() },
        h('label', { for: 'search' }, 'Search ( / )', search),
        choice('Verdict', 'verdict', verdicts, refresh),
        choice('Role', 'role', [['all', 'all'], ['mote', 'mote'], ['sink', 'sink'], ['base_station', 'base station']], refresh),
        choice('Rules', 'family', [['all', 'all'], ...families.map((name) => [name, name])], refresh)),
      h('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Matrix of cases' }, h('table', { id: 'matrix' }, caption,
        h('thead', {}, h('tr', {}, h('th', { scope: 'col' }, 'Case'),
          data.implementations.map((one) => h('th', { scope: 'col' }, one.label)), h('th', { scope: 'col' }, 'Rules'))),
        body)));
    refresh();
  }

  function stale() {
    if (!data.stale.length) return null;
    return h('section', {}, h('h3', {}, 'Expectations that are not true'),
      h('ul', {}, data.stale.map((one) => h('li', {}, h('code', {}, one.place), ': ', one.text))));
  }

  // ---- Rules.

  const casesOf = (id) => data.cases.filter((one) => one.rules.includes(id));
  const broken = (run, id) => run.failures.some((failure) => failure.rules.includes(id));

  function stateOf(id, implementation) {
    const runs = casesOf(id).flatMap((one) => one.runs.filter((run) => run.implementation === implementation));
    const bad = runs.filter((run) => broken(run, id));
    if (bad.length) return [bad.every((run) => run.verdict === 'weak') ? 'weak' : 'fail', `broken in ${bad.length} of ${runs.length}`];
    const good = runs.filter((run) => run.verdict === 'pass' || run.verdict === 'weak').length;
    if (good) return ['pass', `kept in ${good} of ${runs.length}`];
    return ['skip', runs.length ? 'not decided' : 'not tried'];
  }

  function showRules() {
    main.replaceChildren(h('h2', {}, 'Rules'),
      h('p', { class: 'soft' }, 'Every rule that a case of this run names, and whether it was kept.'),
      h('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Rules' }, h('table', {},
        h('thead', {}, h('tr', {}, ['Rule', 'Level', 'Sentence'].map((text) => h('th', { scope: 'col' }, text)),
          data.implementations.map((one) => h('th', { scope: 'col' }, one.label)))),
        h('tbody', {}, Object.entries(data.rules).map(([id, rule]) => h('tr', {},
          h('th', { scope: 'row', class: 'mono' }, ruleLink(id)), h('td', {}, rule.level), h('td', {}, rule.sentence),
          data.implementations.map((_, i) => {
            const [state, text] = stateOf(id, i);
            return h('td', {}, h('span', { class: 'verdict ' + (state === 'skip' ? 'skip-verdict' : state) }, text));
          })))))));
  }

  function showRule(id) {
    const rule = data.rules[id];
    if (!rule) return showMissing('rule', id);
    main.replaceChildren(h('h2', {}, id), h('p', {}, rule.sentence),
      facts([['Level', rule.level], ['Clause', rule.clause], ['Source', rule.source], ['Release 1.0', rule.deployed]]),
      h('h3', {}, 'Cases'),
      h('ul', {}, casesOf(id).map((one) => h('li', {}, h('span', { class: 'mono' }, one.name), ' ',
        one.runs.map((run) => [verdict(run, caseHash(one.name, run)), ' ',
          h('span', { class: 'soft' }, data.implementations[run.implementation].label), ' '])))));
  }

  const facts = (rows) => h('dl', { class: 'facts' },
    rows.filter(([, value]) => value).map(([name, value]) => [h('dt', {}, name), h('dd', {}, value)]));

  // ---- One case on one implementation.

  function showCase(name, label, number) {
    const one = data.cases.find((each) => each.name === name);
    const run = one && (one.runs.find((each) => data.implementations[each.implementation].label === label &&
      each.repeat + 1 === Number(number || 1)) || (label ? null : one.runs[0]));
    if (!run) return showMissing('case', [name, label].filter(Boolean).join(' on '));
    const implementation = data.implementations[run.implementation];
    main.replaceChildren(
      h('h2', {}, h('span', { class: 'mono' }, name), ' on ', implementation.label, ' ', verdict(run)),
      h('p', {}, one.comment),
      facts([
        ['Rules', h('span', { class: 'rules' }, one.rules.map(ruleLink))],
        ['File', h('code', {}, one.file)],
        ['Known failure', run.expected_reason],
        ['Reason', run.failures.length ? '' : run.reason],
        ['Length', `${run.length_ticks} ticks (${(run.length_ticks / 1024).toFixed(3)} s) of its own time, ${run.wall_ms.toFixed(1)} ms of ours`],
        ['Seed', run.seed ? String(run.seed) : ''],
        ['Run again', h('code', {}, run.replay)],
        ['Files', run.rtr ? h('span', {}, h('a', { href: run.rtr }, 'log (.rtr)'),
          run.pcapng ? [' ', h('a', { href: run.pcapng }, 'capture (.pcapng)')] : null) : ''],
        ['Also on', one.runs.length > 1 ? h('span', {}, one.runs.filter((each) => each !== run).map((each) => [
          data.implementations[each.implementation].label, ' ', verdict(each, caseHash(name, each)), ' '])) : ''],
      ]),
      run.failures.map(failureView),
      h('h3', {}, 'What happened'),
      h('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Sequence chart' }, chart(run)),
      run.stderr ? [h('h3', {}, 'Standard error'), h('pre', {}, run.stderr)] : null,
      h('h3', {}, 'Frames'), frames(run),
      h('h3', {}, 'The case'), source(one, run));
  }

  function failureView(failure) {
    return h('section', { class: 'failure' + (failure.weak ? ' is-weak' : '') },
      h('h3', {}, failure.rules.length ? failure.rules.map((id, i) => [i ? ', ' : '', ruleLink(id)]) : 'No rule',
        failure.weak ? ' (weak)' : ''),
      failure.rules.map((id) => data.rules[id] && h('p', {}, data.rules[id].sentence)),
      h('dl', {}, failure.expected ? [h('dt', {}, 'expected'), h('dd', {}, h('code', {}, failure.expected))] : null,
        h('dt', {}, 'but'), h('dd', {}, failure.text),
        h('dt', {}, 'at'), h('dd', {}, `tick ${failure.time_ticks}, line ${failure.line} of the case's file`)));
  }

  function source(one, run) {
    const lines = new Set(run.failures.map((failure) => failure.line));
    return h('pre', { class: 'source', tabindex: '0' }, one.source.map(([line, text]) => {
      const row = `${String(line).padStart(4)}  ${text}\n`;
      return lines.has(line) ? h('mark', {}, row) : row;
    }));
  }

  function frames(run) {
    const seen = new Set();
    const rows = run.log.filter((row) => row.frame >= 0 && !seen.has(row.frame) && seen.add(row.frame));
    if (!rows.length) return h('p', { class: 'soft' }, 'None.');
    return h('div', {}, rows.map((row) => h('details', {},
      h('summary', {}, h('code', {}, `${row.time} ${row.node} ${row.op} ${row.link} ${row.short}`)), hexdump(data.frames[row.frame]))));
  }

  function hexdump(frame) {
    const bytes = frame.hex.match(/../g) || [];
    return h('table', { class: 'hex' },
      h('caption', { class: 'visually-hidden' }, 'Bytes of the frame by field'),
      h('thead', {}, h('tr', {}, ['offset', 'bytes', 'field', 'value'].map((text) => h('th', { scope: 'col' }, text)))),
      h('tbody', {}, frame.fields.map(([offset, size, path, value]) => h('tr', {},
        h('td', {}, offset), h('td', {}, bytes.slice(offset, offset + size).join(' ')), h('td', {}, path), h('td', {}, value)))));
  }

  // ---- Sequence charts.

  const kRow = 24;
  const kTop = 44;
  const kRowsMax = 400;

  // One arrow for a frame that one node under test emits and another is given.
  function arrows(log) {
    const rows = log.map((row, index) => ({ ...row, index, to: null, dropped: false }));
    rows.forEach((row, i) => {
      if (row.op !== '<' || row.frame < 0) return;
      for (let k = i - 1; k >= 0 && row.time - rows[k].time <= 40; --k) {
        const before = rows[k];
        if (before.op !== '>' || before.node === row.node || before.link !== row.link || before.short !== row.short) continue;
        (before.to = before.to || []).push(row.node);
        row.dropped = !row.marked;
        return;
      }
    });
    return rows.filter((row) => !row.dropped);
  }

  function lanesOf(rows) {
    const nodes = [...new Set(rows.map((row) => row.node).filter(Boolean))];
    const links = [...new Set(rows.filter((row) => !row.to && row.link !== 'app' && row.link !== 'power').map((row) => row.link))];
    return [...(rows.some((row) => row.link === 'app') ? ['app'] : []), ...nodes, ...links];
  }

  function chart(run) {
    const marks = new Map(run.failures.filter((failure) => failure.row >= 0).map((failure) => [failure.row, failure]));
    const log = run.log.map((row, i) => ({ ...row, marked: marks.has(i) }));
    const missing = run.failures.filter((failure) => failure.row < 0 && failure.expected);
    const rows = arrows(log);
    for (const failure of missing) {
      const at = rows.findIndex((row) => row.time > failure.time_ticks);
      rows.splice(at < 0 ? rows.length : at, 0, { missing: true, time: failure.time_ticks, node: failure.node, link: failure.link,
        op: '>', short: 'missing: ' + failure.short, marked: true, frame: -1 });
    }
    if (!rows.length) return h('p', { class: 'soft' }, 'Nothing was given or came.');
    const first = Math.max(0, Math.min(rows.length - kRowsMax, rows.findIndex((row) => row.marked) - kRowsMax / 2));
    return sequence(rows.slice(first, first + kRowsMax), `${rows.length > kRowsMax ? kRowsMax + ' of ' : ''}${rows.length} events`);
  }

  function sequence(rows, title) {
    const lanes = lanesOf(rows);
    const gap = Math.max(150, Math.min(320, 1000 / lanes.length));
    const x = (lane) => 90 + gap / 2 + lanes.indexOf(lane) * gap;
    const height = kTop + rows.length * kRow + 20;
    const width = 90 + gap * lanes.length + 420;
    const svg = s('svg', { width, height, viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': 'Sequence chart, ' + title, class: 'chart' },
      s('title', {}, title));
    for (const lane of lanes) {
      svg.append(s('line', { class: 'life', x1: x(lane), x2: x(lane), y1: kTop - 10, y2: height - 10 }),
        s('text', { x: x(lane), y: 22, 'text-anchor': 'middle' }, lane));
    }
    rows.forEach((row, i) => drawRow(svg, row, kTop + i * kRow + 10, x, width));
    return svg;
  }

  function drawRow(svg, row, y, x, width) {
    const marked = row.marked;
    if (marked) svg.append(s('rect', { class: 'band', x: 0, y: y - 13, width, height: kRow }));
    svg.append(s('text', { class: 'dim', x: 78, y: y + 4, 'text-anchor': 'end' }, row.time));
    const out = row.op === '>' || row.op === '?>' || row.op === '!>';
    const here = row.node ? x(row.node) : x(row.link);
    const others = (row.to || [row.link === 'power' ? row.node : row.link]).map((lane) => x(lane)).filter((at) => at !== undefined);
    for (const other of others) {
      const [from, to] = out ? [here, other] : [other, here];
      if (from === to || Number.isNaN(to) || Number.isNaN(from)) {
        svg.append(s('circle', { class: marked ? 'marked-head' : 'dot', cx: here, cy: y, r: 4 }));
        continue;
      }
      const way = Math.sign(to - from);
      svg.append(
        s('line', { class: 'arrow' + (marked ? ' marked' : '') + (row.missing ? ' lost' : ''), x1: from, x2: to - way * 6, y1: y, y2: y }),
        s('path', { class: marked ? 'marked-head' : 'head', d: `M ${to} ${y} l ${-way * 8} -4 v 8 z` }));
    }
    svg.append(s('text', { class: marked ? 'marked-text' : '', x: width - 410, y: y + 4 }, (marked ? '\u25c0 ' : '') + row.short));
  }

  // ---- The paper's figures.

  function figureRun(names, wanted) {
    for (const name of names) {
      const one = data.cases.find((each) => each.name === name);
      const run = one && one.runs.find((each) => each.implementation === wanted && each.log.length);
      if (run) return [one, run];
    }
    return [null, null];
  }

  function showFigures(label) {
    const chosen = Math.max(0, data.implementations.findIndex((one) => one.label === label));
    const select = h('select', { onchange: () => { location.hash = hashOf('figures', data.implementations[select.value].label); } },
      data.implementations.map((one, i) => h('option', { value: i, selected: i === chosen }, one.label)));
    const [joinCase, join] = figureRun(['timeline', 'home.network', 'j4.accept', 'j3.reply'], chosen);
    const [timeCase, time] = figureRun(['timeline', 'hospital', 'home.network'], chosen);
    main.replaceChildren(h('h2', {}, 'Figures'),
      h('p', { class: 'soft' }, 'The two figures of the paper, drawn from what this implementation did.'),
      h('div', { class: 'filters' }, h('label', {}, 'Implementation', select)),
      h('h3', {}, 'Join sequence'),
      join ? [h('p', { class: 'soft' }, `The first join of case ${joinCase.name}.`),
        h('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Join sequence' }, joinFigure(join))] : h('p', {}, 'No case with a join was run.'),
      h('h3', {}, 'Timeline of joins and data acquisition'),
      time ? [h('p', { class: 'soft' }, `Case ${timeCase.name}; ticks of 1/1024 s.`),
        h('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Timeline' }, timeline(time))] : h('p', {}, 'No case with joins and readings was run.'));
  }

  function joinFigure(run) {
    const first = run.log.findIndex((row) => row.short.startsWith('join'));
    const mote = first < 0 ? '' : run.log[first].node;
    let end = run.log.findIndex((row, i) => i > first && row.short.startsWith('mote_joined'));
    if (end < 0) end = run.log.findIndex((row, i) => i > first && row.node === mote && row.short.startsWith('joined'));
    return sequence(arrows(run.log.slice(Math.max(0, first), end < 0 ? first + 12 : end + 3)), 'join of ' + mote);
  }

  function timeline(run) {
    const nodes = [...new Set(run.log.map((row) => row.node).filter((name) => run.motes.includes(name)))];
    const end = Math.max(1, ...run.log.map((row) => row.time));
    const width = 1000;
    const left = 70;
    const lane = 46;
    const height = nodes.length * lane + 60;
    const x = (time) => left + time / end * (width - left - 30);
    const svg = s('svg', { width, height, viewBox: `0 0 ${width} ${height}`, role: 'img', class: 'chart timeline',
      'aria-label': `Joins and readings of ${nodes.length} motes in ${end} ticks` });
    nodes.forEach((name, i) => {
      const y = 30 + i * lane;
      svg.append(s('text', { x: left - 12, y: y + 4, 'text-anchor': 'end' }, name),
        s('line', { class: 'life', x1: left, x2: width - 20, y1: y, y2: y }));
      for (const row of run.log.filter((each) => each.node === name && each.op === '>')) {
        if (row.short.startsWith('join_request')) svg.append(s('rect', { class: 'box', x: x(row.time) - 2, y: y - 12, width: 4, height: 24 }, s('title', {}, `${row.time}: ${row.short}`)));
        else if (row.short.startsWith('joined')) svg.append(s('path', { class: 'joined', d: `M ${x(row.time)} ${y - 12} l 7 9 h -14 z` }, s('title', {}, `${row.time}: ${row.short}`)));
        else if (row.frame >= 0 && row.short.startsWith('net_msg')) svg.append(s('circle', { class: 'dot', cx: x(row.time), cy: y, r: 4 }, s('title', {}, `${row.time}: ${row.short}`)));
      }
    });
    const base = 30 + nodes.length * lane;
    svg.append(s('line', { class: 'axis', x1: left, x2: width - 20, y1: base, y2: base }));
    for (let time = 0; time <= end; time += 1024) {
      svg.append(s('line', { class: 'axis', x1: x(time), x2: x(time), y1: base, y2: base + 6 }),
        s('text', { class: 'dim', x: x(time), y: base + 22, 'text-anchor': 'middle' }, time / 1024 + ' s'));
    }
    return add(svg, []);
  }

  // ---- The run itself.

  function showRun() {
    main.replaceChildren(h('h2', {}, 'This run'),
      facts([['Profile', data.profile], ['Seed', String(data.seed)], ['Shard', data.shard],
        ['Traces', data.traces.join(', ') || "the kit's own"], ['Compared with', data.earlier ? 'an earlier run' : ''],
        ['Rules named', String(Object.keys(data.rules).length)]]),
      h('h3', {}, 'Verdicts'),
      facts([['pass', 'Everything that the case asks for was seen.'], ['weak', 'Only a SHOULD was broken.'],
        ['inconclusive', 'Nothing was broken, but not all of it could be seen.'], ['fail', 'A MUST was broken.'],
        ['error', 'The implementation or its adapter broke: it died, hung, or said what makes no sense.'],
        ['skip', 'The implementation says that it cannot do what the case needs.']]),
      h('h3', {}, 'Implementations'),
      h('ul', { class: 'tiles' }, data.implementations.map(tile)));
  }

  function showMissing(what, name) {
    main.replaceChildren(h('h2', {}, `This run has no ${what} ${name}`), h('p', {}, h('a', { href: '#/cases' }, 'All cases')));
  }

  // ---- Where we are.

  function route() {
    if (location.hash === '#main') return;  // The skip link.
    const [view, ...rest] = location.hash.slice(2).split('/').map(decodeURIComponent);
    const pages = { cases: showCases, rules: showRules, rule: showRule, case: showCase, figures: showFigures, run: showRun };
    (pages[view] || showCases)(...rest);
    const current = { rule: 'rules', case: 'cases' }[view] || (pages[view] ? view : 'cases');
    document.getElementById('views').replaceChildren(...kViews.map(([name, text]) =>
      h('a', { href: hashOf(name), 'aria-current': name === current ? 'page' : null }, text)));
    const title = main.querySelector('h2');
    document.title = (title ? title.textContent + ' - ' : '') + 'Rubric conformance report';
  }

  window.addEventListener('hashchange', () => { route(); window.scrollTo(0, 0); if (location.hash !== '#main') main.focus(); });
  document.getElementById('skip').addEventListener('click', (event) => { event.preventDefault(); main.focus(); });
  document.addEventListener('keydown', (event) => {
    const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName);
    if (event.key !== '/' || typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const search = document.getElementById('search');
    if (search) { event.preventDefault(); search.focus(); }
  });

  const theme = document.getElementById('theme');
  const dark = () => document.documentElement.dataset.theme
    ? document.documentElement.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  const paint = () => { theme.setAttribute('aria-pressed', String(dark())); };
  theme.addEventListener('click', () => { document.documentElement.dataset.theme = dark() ? 'light' : 'dark'; paint(); });
  paint();
  route();
})();
