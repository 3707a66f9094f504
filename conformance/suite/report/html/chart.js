// ---- Sequence charts.
//
// A row is a line of the log, or one that is missing. Its `arrows` go from lane to lane; a lane is
// a node, or the application above one. Null is somebody whom the case does not have.

const kRow = 22;
const kRowFigure = 40;
const kHead = 34;
const kTimeWidth = 76;
const kStub = 30;
const kRowsMax = 400;
const kTextWidth = 400;

const appLane = (node) => 'app of ' + node;

// Returns rows as they are drawn: a frame that one node under test emits and another is given is
// one arrow.
function rowsOf(run, hasAppLane) {
  const rows = run.log.map((line, index) =>
    ({ ...line, index, heard: new Set(), text: textOf(line) }));
  for (const row of rows) {
    if (row.of !== undefined) rows[row.of].heard.add(row.node);
  }
  for (const row of rows) row.arrows = arrowsOf(row, run.nodes, hasAppLane);
  return rows.filter((row) => row.of === undefined);
}

const textOf = (line) => line.text ?? data.frames[line.frame].text;

function arrowsOf(row, nodes, hasAppLane) {
  if (row.frame === undefined) {
    if (row.link !== 'app' || !hasAppLane) return [{ from: row.node, to: row.node, app: row.op }];
    const app = appLane(row.node);
    return row.op === '<' ? [{ from: app, to: row.node }] : [{ from: row.node, to: app }];
  }
  const peers = (row.peers || []).map((i) => nodes[i]);
  if (row.op === '<') {
    const from = peers.length === 1 ? peers[0].name : null;
    return [row.node, ...row.heard].map((to) => ({ from, to }));
  }
  const all = [...new Set([...peers.map((node) => node.name), ...row.heard])];
  if (!all.length) return [{ from: row.node, to: null }];
  const byName = new Map(nodes.map((node) => [node.name, node]));
  return all.map((to) => ({ from: row.node, to,
    lost: byName.get(to).iut && !row.heard.has(to) }));
}

// Marks the lines that break something and adds those that are missing, in the order of time.
function withFailures(rows, run, hasAppLane) {
  for (const failure of run.failures) {
    const broken = rows.find((row) => row.index === failure.row);
    if (broken) {
      broken.marked = true;
      continue;
    }
    const missing = failure.expected !== '';
    const at = rows.findIndex((row) => row.time > failure.time);
    const named = run.nodes.some((node) => node.name === failure.node);
    const peer = failure.peers.length ? run.nodes[failure.peers[0]].name : null;
    const to = failure.link === 'app' && hasAppLane ? appLane(failure.node) : peer;
    rows.splice(at < 0 ? rows.length : at, 0, { marked: true, missing: true, time: failure.to,
      node: failure.node, link: failure.link,
      short: missing ? 'no ' + failure.short : 'it broke',
      text: missing ? failure.expected : failure.text,
      arrows: named && missing
        ? [{ from: failure.node, to, lost: true, app: failure.link === 'app' && '>' }] : [] });
  }
  return rows;
}

// Returns the nodes that take part, in the order of the case.
function lanesOf(rows, nodes, appsOf) {
  const used = new Set(rows.flatMap((row) => row.arrows.flatMap((one) => [one.from, one.to])));
  const lanes = [];
  for (const node of nodes) {
    const app = appLane(node.name);
    const place = appsOf(node);
    if (place === 'left' && used.has(app)) lanes.push({ key: app, text: 'application' });
    if (used.has(node.name)) {
      lanes.push({ key: node.name, text: node.name, role: node.role.replace('_', ' '),
        iut: node.iut });
    }
    if (place === 'right' && used.has(app)) lanes.push({ key: app, text: 'application' });
  }
  for (const name of used) {  // Whoever the case does not know has a lane too.
    if (name && !lanes.some((lane) => lane.key === name)) {
      lanes.push({ key: name, text: cut(name, 16) });
    }
  }
  return lanes;
}

// Draws the chart of a case: time, arrows, and the words of each row after them.
function caseChart(run, pick) {
  const alone = run.nodes.filter((node) => node.iut).length === 1;
  const all = withFailures(rowsOf(run, alone), run, alone);
  if (!all.length) return h('p', { class: 'soft' }, 'Nothing was given, and nothing came.');
  const marked = all.findIndex((row) => row.marked);
  const first = Math.max(0, Math.min(all.length - kRowsMax, marked - kRowsMax / 2));
  const rows = all.slice(first, first + kRowsMax);
  const lanes = lanesOf(rows, run.nodes, (node) => alone && node.iut ? 'left' : '');
  const title = rows.length < all.length
    ? `${rows.length} of ${all.length} events` : count(all.length, 'event');
  const words = 'Sequence chart: ' + title + (marked >= 0 ? ', what is wrong is marked' : '');
  const drawn = sequence(rows, lanes, { words, pick });
  return [rows.length < all.length && h('p', { class: 'soft' }, title),
    h('div', { class: 'scroll chart-frame', tabindex: '0', role: 'region',
      'aria-label': 'Sequence chart' }, drawn)];
}

// The heads of the lanes stay in sight while the rest scrolls.
function sequence(rows, lanes, { words, figure, pick }) {
  const gap = figure ? 330 : Math.max(72, Math.min(200, 600 / lanes.length));
  const left = kTimeWidth + (figure ? 90 : Math.max(kStub + 14, gap / 2));
  const x = new Map(lanes.map((lane, i) => [lane.key, left + i * gap]));
  const end = left + (lanes.length - 1) * gap + (figure ? 90 : 50);
  const width = end + (figure ? 0 : kTextWidth);
  const step = figure ? kRowFigure : kRow;
  const height = rows.length * step + 14;
  const heads = s('svg', { class: 'heads', width, height: kHead, 'aria-hidden': 'true',
    viewBox: `0 0 ${width} ${kHead}` },
  s('text', { class: 'dim', x: kTimeWidth - 12, y: 28, 'text-anchor': 'end' }, 'tick'));
  const body = s('svg', { class: 'chart', role: 'img', 'aria-label': words, width, height,
    viewBox: `0 0 ${width} ${height}` });
  for (const lane of lanes) {
    const at = x.get(lane.key);
    heads.append(s('text', { class: lane.iut ? 'iut' : lane.role ? '' : 'dim', x: at,
      y: lane.role ? 14 : 28, 'text-anchor': 'middle' }, lane.text));
    if (lane.role) {
      heads.append(s('text', { class: 'dim small', x: at, y: 28, 'text-anchor': 'middle' },
        lane.role));
    }
  }
  rows.forEach((row, i) => body.append(drawRow(row, {
    y: i * step + (figure ? step - 10 : step / 2 + 3), step, x, end, width, figure, pick,
    before: i > 0 ? rows[i - 1].time : -1 })));
  for (const lane of lanes) {  // Above the bands of rows.
    const at = x.get(lane.key);
    body.append(s('line', { class: lane.iut ? 'life iut' : 'life', x1: at, x2: at, y1: 0,
      y2: height }));
  }
  return h('div', { class: 'sequence' }, heads, body);
}

function drawRow(row, at) {
  const { y, x, figure } = at;
  const group = s('g', { class: 'row' + (row.marked ? ' marked' : '') + ' on-' + row.kind },
    s('title', {}, `${row.time} ${row.node} ${row.link} ${row.text}`),
    s('rect', { class: 'band', x: 0, y: figure ? y - at.step + 10 : y - at.step / 2,
      width: at.width, height: at.step }));
  if (row.time !== at.before) {
    group.append(s('text', { class: 'dim', x: kTimeWidth - 12, y: y + 4, 'text-anchor': 'end' },
      row.time));
  }
  for (const arrow of inSteps(row.arrows, x)) group.append(...drawArrow(arrow, x, y));
  if (figure) {
    const ends = row.arrows.flatMap((one) => [x.get(one.from), x.get(one.to)])
      .filter((value) => value !== undefined);
    const middle = (Math.min(...ends) + Math.max(...ends)) / 2;
    group.append(s('text', { x: middle, y: y - 7, 'text-anchor': 'middle' }, row.label));
    return group;
  }
  group.append(
    s('text', { class: 'dim', x: at.end + 10, y: y + 4 }, row.link || ''),
    s('text', { class: 'label', x: at.end + 62, y: y + 4 },
      (row.marked ? '\u25c0 ' : '') + cut(row.short, 54)));
  if (at.pick && row.index !== undefined) {
    group.addEventListener('click', () => at.pick(row.index));
    group.classList.add('picks');
  }
  return group;
}

// Splits an arrow to several lanes into one from each to the next.
function inSteps(arrows, x) {
  const starts = new Map();
  return [...arrows].sort((a, b) => Math.abs(x.get(a.to) - x.get(a.from)) -
    Math.abs(x.get(b.to) - x.get(b.from))).map((one) => {
    const way = one.from + Math.sign(x.get(one.to) - x.get(one.from));
    const start = starts.get(way);
    if (!one.lost) starts.set(way, x.get(one.to));
    return { ...one, start };
  });
}

function drawArrow(arrow, x, y) {
  let from = arrow.start ?? x.get(arrow.from);
  let to = x.get(arrow.to);
  if (arrow.app) {  // To or from an application that has no lane, or something done to the node.
    if (arrow.app === '<') from = to - kStub;
    else to = from - kStub;
  } else if (from === undefined) {
    from = to - kStub;
  } else if (to === undefined) {
    to = from + kStub;
  }
  const way = Math.sign(to - from);
  if (arrow.lost) {
    const stop = from + (to - from) * (Math.abs(to - from) > 2 * kStub ? 0.6 : 1);
    return [s('line', { class: 'arrow lost', x1: from, x2: stop, y1: y, y2: y }),
      s('path', { class: 'cross', d: `M ${stop - 4} ${y - 4} l 8 8 m 0 -8 l -8 8` })];
  }
  return [s('line', { class: 'arrow', x1: from, x2: to - way * 6, y1: y, y2: y }),
    s('path', { class: 'head', d: `M ${to} ${y} l ${-way * 8} -3.5 v 7 z` })];
}
