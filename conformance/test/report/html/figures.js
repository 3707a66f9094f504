// ---- The paper's two figures, drawn from a run.

const isMote = (run, name) => run.nodes.some((node) => node.name === name && node.role === 'mote');
const readingsOf = (run, name) => run.log.filter((line) => line.node === name && line.op === '>' &&
  line.kind === 'radio' && line.short.startsWith('net_msg'));
const joinOf = (run, name) => run.log.find((line) => line.node === name && line.op === '>' &&
  line.link === 'app' && line.short === 'joined success');
const hasReadings = (run) => run.nodes.some((node) => isMote(run, node.name) &&
  joinOf(run, node.name) && readingsOf(run, node.name).length > 1);

// The best run for the timeline: one that passed, of a case that was made for it.
function timelineRun(implementation) {
  const names = ['timeline', 'hospital', 'home.network'];
  const rank = ({ one, run }) => (['pass', 'weak'].includes(run.verdict) ? 0 : 1000) +
    (names.includes(one.name) ? names.indexOf(one.name) : 500);
  return data.cases.flatMap((one) => one.runs.map((run) => ({ one, run })))
    .filter(({ run }) => run.implementation === implementation && hasReadings(run))
    .sort((a, b) => rank(a) - rank(b))[0];
}

function showFigures(label) {
  const chosen = Math.max(0, data.implementations.findIndex((one) => one.label === label));
  const join = data.implementations[chosen]?.join;
  const time = timelineRun(chosen);
  const place = (name, repeat) => h('figcaption', { class: 'soft' }, 'Drawn from ',
    h('a', { class: 'mono', href: caseHash(name, { implementation: chosen, repeat }) }, name),
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
    join ? h('figure', {}, place(join.name, join.repeat), chartView(join.chart))
      : h('p', {}, 'No case of this run shows a whole join.'),
    h('h3', {}, 'Timeline of join and data acquisition from motes'),
    time ? h('figure', {}, place(time.one.name, time.run.repeat), timelineKey(),
      scroll('Timeline', timeline(time.run)))
      : h('p', {}, 'No case of this run shows a mote that joins and sends readings.'));
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
