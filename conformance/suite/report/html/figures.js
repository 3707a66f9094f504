// ---- The paper's two figures, drawn from a run.

const kJoinWords = ['join', 'join_request', 'join_reply', 'ack_join', 'joined', 'mote_joined'];
const wordOf = (line) => textOf(line).split('(')[0];

// Returns the best run for a figure: one that passed, of a case that was made for it.
function figureRun(implementation, names, fitsFigure) {
  const places = new Map(names.map((name, i) => [name, i]));
  let best = null;
  for (const one of data.cases) {
    for (const run of one.runs) {
      if (run.implementation !== implementation || !fitsFigure(run)) continue;
      const good = run.verdict === 'pass' || run.verdict === 'weak';
      const rank = (good ? 0 : 1000) + (places.get(one.name) ?? 500);
      if (!best || rank < best.rank) best = { rank, one, run };
    }
  }
  return best;
}

const hasJoin = (run) => ['join_request', 'join_reply', 'ack_join'].every((word) =>
  run.log.some((line) => line.frame !== undefined && wordOf(line) === word));
const isMote = (run, name) => run.nodes.some((node) => node.name === name && node.role === 'mote');
const readingsOf = (run, name) => run.log.filter((line) => line.node === name && line.op === '>' &&
  line.kind === 'radio' && line.short.startsWith('net_msg'));
const joinOf = (run, name) => run.log.find((line) => line.node === name && line.op === '>' &&
  line.link === 'app' && line.short === 'joined success');
const hasReadings = (run) => run.nodes.some((node) => isMote(run, node.name) &&
  joinOf(run, node.name) && readingsOf(run, node.name).length > 1);

function showFigures(label) {
  const chosen = Math.max(0, data.implementations.findIndex((one) => one.label === label));
  const join = figureRun(chosen, ['timeline', 'j4.accept', 'home.network'], hasJoin);
  const time = figureRun(chosen, ['timeline', 'hospital', 'home.network'], hasReadings);
  const place = (found) => h('figcaption', { class: 'soft' }, 'Drawn from ',
    h('a', { class: 'mono', href: caseHash(found.one.name, found.run) }, found.one.name),
    ` on ${data.implementations[chosen].label}. A tick is 1/1024 s.`);
  const select = h('select', { id: 'whose', onchange: () => {
    location.hash = hashOf('figures', data.implementations[select.value].label);
  } }, data.implementations.map((one, i) =>
    h('option', { value: i, selected: i === chosen }, one.label)));
  main.replaceChildren(h('h2', {}, 'Figures'),
    h('p', { class: 'soft' }, 'The two figures of the paper that show the protocol at work, ' +
      'drawn from what was seen in this run.'),
    ...(data.implementations.length > 1
      ? [h('form', { class: 'filters' }, h('label', {}, 'Implementation', select))] : []),
    h('h3', {}, 'Sequence diagram of the join protocol'),
    join ? h('figure', {}, place(join), scroll('Sequence diagram', joinFigure(join.run)))
      : h('p', {}, 'No case of this run shows a whole join.'),
    h('h3', {}, 'Timeline of join and data acquisition from motes'),
    time ? h('figure', {}, place(time), timelineKey(), scroll('Timeline', timeline(time.run)))
      : h('p', {}, 'No case of this run shows a mote that joins and sends readings.'));
}

// Draws the first mote's join, from the application's call to the sink's notice.
function joinFigure(run) {
  const rows = rowsOf(run, true).filter((row) => kJoinWords.includes(wordOf(row)));
  const asked = rows.find((row) => wordOf(row) === 'ack_join');
  const mote = asked.op === '>' ? asked.node : asked.arrows[0].from;
  const isOf = (row) => row.arrows.some((one) => one.from === mote || one.to === mote);
  const sinks = new Set(rows.filter((row) => isOf(row) && wordOf(row) === 'join_reply')
    .flatMap((row) => row.arrows.flatMap((one) => [one.from, one.to])));
  const from = Math.max(0, rows.findIndex((row) => isOf(row)));
  const acked = rows.indexOf(asked);
  let end = acked;
  for (let i = acked; i < rows.length && rows[i].time - asked.time <= 600; ++i) {
    const notice = wordOf(rows[i]) === 'mote_joined' && sinks.has(rows[i].node);
    if (notice || (wordOf(rows[i]) === 'joined' && rows[i].node === mote)) end = i;
    if (notice) break;
  }
  const shown = rows.slice(from, end + 1).filter((row) => isOf(row) || sinks.has(row.node))
    .map((row) => ({ ...row, label: figureLabel(row) }));
  const lanes = lanesOf(shown, run.nodes, (node) => node.role === 'mote' ? 'left' : 'right');
  return sequence(shown, lanes, { figure: true, words: `The join of ${mote}, ` +
    count(shown.length, 'message') + ': ' + shown.map((row) => row.label).join(', ') });
}

// Returns "joined(11:2, success)"; for frames, the subject of the join.
function figureLabel(row) {
  const word = wordOf(row);
  const fields = [...row.text.matchAll(/([\w.]+)=([^\s()]+)/g)];
  const wanted = { join_request: ['mote_type', 'seq_num'], ack_join: ['src', 'seq_num'],
    join_reply: ['island_addr', 'mote_addr', 'seq_num'] }[word];
  const shown = wanted
    ? wanted.map((name) => fields.find((field) =>
      field[1].split('.').pop() === name)).filter(Boolean)
      .map(([, name, value]) => ({ seq_num: 'seq ', island_addr: 'island ',
        mote_addr: 'mote ' }[name] || '') + value)
    : fields.map((field) => field[2]);
  return cut(`${word}(${shown.join(', ')})`, 43);
}

const kLane = 44;
const kLeft = 64;

function timelineKey() {
  const sign = (shape, text) => h('li', {}, s('svg', { class: 'chart', width: 16, height: 16,
    viewBox: '-8 -8 16 16', 'aria-hidden': 'true' }, shape), text);
  return h('ul', { class: 'key' },
    sign(s('path', { class: 'asks', d: 'M 0 -7 v 14' }), 'join request'),
    sign(s('path', { class: 'joined', d: 'M 0 -7 l 7 7 l -7 7 l -7 -7 z' }), 'joined'),
    sign(s('circle', { class: 'dot', r: 3.5 }), 'reading sent to the sink'));
}

// Draws milliseconds, counted from the first join, as the paper does.
function timeline(run) {
  const motes = run.nodes.filter((node) => isMote(run, node.name))
    .map((node) => ({ ...node, joined: joinOf(run, node.name),
      readings: readingsOf(run, node.name),
      asks: run.log.filter((line) => line.node === node.name && line.op === '>' &&
        line.short.startsWith('join_request')) }))
    .filter((mote) => mote.joined || mote.readings.length || mote.asks.length)
    .sort((a, b) => (a.joined?.time ?? Infinity) - (b.joined?.time ?? Infinity));
  const zero = motes[0].joined.time;
  const ms = (line) => (line.time - zero) * 1000 / 1024;
  const last = Math.max(...motes.flatMap((mote) =>
    [mote.joined, ...mote.readings, ...mote.asks].filter(Boolean).map(ms)));
  const width = 1040;
  const base = motes.length * kLane + 12;
  const step = [500, 1000, 2000, 5000, 10000, 60000].find((one) => last / one <= 14) || 600000;
  const end = Math.ceil(last / step) * step || step;
  const x = (at) => kLeft + 20 + at / end * (width - kLeft - 60);
  const words = motes.map((mote) => mote.joined
    ? `${mote.name} joins at ${Math.round(ms(mote.joined))} ms and sends ` +
      count(mote.readings.length, 'reading') : `${mote.name} does not join`).join('; ');
  const drawn = s('svg', { class: 'chart timeline', width, height: base + 44, role: 'img',
    viewBox: `0 0 ${width} ${base + 44}`, 'aria-label': 'Timeline: ' + words });
  for (let at = 0; at <= end; at += step) {
    drawn.append(s('line', { class: 'grid', x1: x(at), x2: x(at), y1: 6, y2: base }),
      s('text', { class: 'dim', x: x(at), y: base + 18, 'text-anchor': 'middle' }, at));
  }
  drawn.append(s('text', { class: 'dim', x: x(end / 2), y: base + 38, 'text-anchor': 'middle' },
    `ms since ${motes[0].name} joined`));
  motes.forEach((mote, i) => drawMote(drawn, mote, 34 + i * kLane, x, ms, end));
  return drawn;
}

function drawMote(drawn, mote, y, x, ms, end) {
  const point = (shape, line) => {
    shape.append(s('title', {}, `${Math.round(ms(line))} ms: ${textOf(line)}`));
    drawn.append(shape);
  };
  drawn.append(
    s('text', { class: 'iut', x: kLeft - 8, y: y + 4, 'text-anchor': 'end' }, mote.name),
    s('line', { class: 'life', x1: x(0), x2: x(end), y1: y, y2: y }));
  for (const line of mote.asks) {
    point(s('path', { class: 'asks', d: `M ${x(ms(line))} ${y - 9} v 18` }), line);
  }
  if (mote.joined) {
    const at = x(ms(mote.joined));
    point(s('path', { class: 'joined', d: `M ${at} ${y - 8} l 8 8 l -8 8 l -8 -8 z` }),
      mote.joined);
    drawn.append(s('text', { class: 'small', x: at + 2, y: y - 12 },
      Math.round(ms(mote.joined)) + ' ms'));
  }
  for (const line of mote.readings) {
    point(s('circle', { class: 'dot', cx: x(ms(line)), cy: y, r: 3.5 }), line);
  }
}
