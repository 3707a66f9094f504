'use strict';
// Checks of the page. Each gets a page of its own, and `go` to open a place in it.
const assert = require('node:assert');
const fs = require('node:fs');
const path = require('node:path');
const { kFailing, views } = require('./views.js');

const texts = (page, selector) => page.locator(selector).allTextContents();
const rows = (page) => page.locator('#matrix tbody tr').count();
const focused = (page) => page.evaluate(() =>
  document.activeElement.id || document.activeElement.textContent);
const titled = (page, start) => page.waitForFunction((wanted) =>
  document.querySelector('h2').textContent.startsWith(wanted), start, { timeout: 5000 });
const background = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);

async function filters(page, go) {
  await go('#/cases');
  const all = await rows(page);
  await page.getByLabel('Verdict').selectOption('fail');
  const failing = await rows(page);
  assert.ok(failing > 0 && failing < all, `${failing} of ${all}`);
  assert.strictEqual(await page.locator('#matrix tbody tr:has(.v-fail)').count(), failing);
  assert.strictEqual(await page.locator('.count').textContent(), `${failing} of ${all} cases`);
  // It is in the address, so it is still there when the page is loaded again.
  assert.match(page.url(), /#\/cases\?verdict=fail$/);
  await page.reload();
  assert.strictEqual(await rows(page), failing);
  assert.strictEqual(await page.getByLabel('Verdict').inputValue(), 'fail');
  await page.getByRole('button', { name: 'Clear' }).click();
  assert.strictEqual(await rows(page), all);
  await page.getByLabel('Role').selectOption('base_station');
  const bases = await rows(page);
  await page.getByLabel('Rules').selectOption('N11');
  const both = await texts(page, '#matrix tbody th');
  assert.ok(both.length > 0 && both.length < bases && bases < all);
  assert.ok(both.every((name) => /base_station|n11/.test(name)), both.join(' '));
}

// Each implementation's own, once for all its cases.
async function advice(page, go) {
  await go('#/cases');
  const tiles = await texts(page, '.tiles li');
  assert.deepStrictEqual(tiles.map((text) => text.match(/\d+ failed cases? would/g)),
    [null, null, ['6 failed cases would']]);
}

async function order(page, go) {
  await go('#/cases');
  const verdicts = await page.locator('#matrix tbody tr').evaluateAll((all) => all.map((row) => {
    const its = [...row.querySelectorAll('.verdict')].map((one) => one.textContent);
    return its.every((one) => one === 'pass') ? 'pass' : its.find((one) => one !== 'pass');
  }));
  const begin = verdicts.indexOf('pass');
  assert.ok(begin > 0 && verdicts[0] === 'fail', verdicts.slice(0, 5).join(' '));
  assert.deepStrictEqual([...new Set(verdicts.slice(begin))], ['pass']);
}

async function search(page, go) {
  await go('#/cases');
  await page.getByLabel('Search').fill('J4-SEQ  J5-accept');
  assert.deepStrictEqual(await texts(page, '#matrix tbody th'),
    ['edges_j.ack_join_is_no_reply', 'n10.mote_power_off_while_joining',
      'edges_j.ack_join_is_no_reply.again', 'n10.mote_power_off_while_joining.again']);
  await page.getByLabel('Search').fill('release 1.0 does');  // Words of a comment.
  assert.ok((await texts(page, '#matrix tbody th')).includes('j4.wrong_seq'));
  await page.getByLabel('Search').fill('there is no such case');
  assert.match(await page.locator('.count').textContent(), /^0 of \d+ cases$/);
  assert.strictEqual(await rows(page), 0);
}

async function compared(page, go) {
  await go('#/cases?verdict=changed');
  const names = await texts(page, '#matrix tbody th');
  assert.deepStrictEqual(names, ['j4.wrong_seq', 'j8.stray_replies',
    'j4.many_replies', 'second_life.mote_joins', 'wide.mote_reply_number']);
  assert.deepStrictEqual(await texts(page, '#matrix tbody .flag'),
    ['was pass', 'was pass', 'was pass', 'was pass', 'was pass']);
  await go('#/cases?text=j4.wrong_seq.again');
  assert.deepStrictEqual(await texts(page, '#matrix tbody .flag'), ['new', 'new']);
  await go('#/cases?verdict=new');
  const fresh = await texts(page, '#matrix tbody th');
  assert.ok(fresh.length > 0 && fresh.every((name) => name.endsWith('.again')), fresh.join(' '));
  // A case that is gone has no row of its own there.
  const gone = page.locator('#gone');
  assert.strictEqual(await gone.locator('summary').textContent(),
    '2 cases of the earlier run are gone, or not chosen this time');
  assert.strictEqual(await gone.locator('table').isVisible(), false);
  await gone.locator('summary').click();
  assert.deepStrictEqual(await gone.locator('tbody tr').evaluateAll((all) =>
    all.map((row) => [...row.children].map((cell) => cell.textContent))),
  [['j4.that_was', 'good 1', 'fail'], ['j4.accept', 'retired', 'pass']]);
}

async function failing(page, go) {
  await go(kFailing);
  assert.match(await page.locator('h2').textContent(), /^j4\.wrong_seq fail.* on broken 1$/);
  assert.match(await page.title(), /^j4\.wrong_seq/);
  const first = (await page.locator('.failure').first().textContent()).replace(/\s+/g, ' ');
  for (const words of ['J4-SEQ', 'A mote ignores a join_reply whose sequence number is not that',
    'Forbidden', '!> rA ack_join(*)', 'line 35', 'it emitted rA ack_join']) {
    assert.ok(first.includes(words), `${words}: ${first}`);
  }
  // The arrows that break a rule, and the one that is missing.
  assert.deepStrictEqual(await texts(page, '.rc-marked .rc-label'),
    ['\u25c0 joined(12:5 success)', '\u25c0 ack_join 12:5->12:1 seq 1001',
      '\u25c0 no ack_join']);
  const look = await page.evaluate(() => {
    const lanes = [...document.querySelectorAll('.rc-heads .rc-name')];
    const mote = lanes.find((one) => one.textContent === 'm5').getAttribute('x');
    const [, ack, missing] = document.querySelectorAll('.rc-marked');
    const red = getComputedStyle(document.documentElement).getPropertyValue('--fail').trim();
    const swatch = document.createElement('i');
    swatch.style.color = red;
    document.body.append(swatch);
    return { mote, from: ack.querySelector('.rc-line').getAttribute('x1'),
      color: getComputedStyle(ack.querySelector('.rc-line')).stroke,
      red: getComputedStyle(swatch).color, plain: getComputedStyle(
        document.querySelector('.rc-row:not(.rc-marked) .rc-line')).stroke,
      heads: ack.querySelectorAll('.rc-tip').length, cross: !!missing.querySelector('.rc-lost') };
  });
  assert.strictEqual(look.from, look.mote);
  assert.strictEqual(look.color, look.red);
  assert.notStrictEqual(look.plain, look.red);
  assert.strictEqual(look.heads, 2);  // Both sinks have the address.
  assert.ok(look.cross);
  assert.strictEqual(await page.locator('.source mark').count(), 5);
  assert.match(await page.locator('.command').textContent(),
    /^rubric test --target \.\/broken --cases j4\.wrong_seq$/);
}

async function bytes(page, go) {
  await go(kFailing);
  await page.locator('.rc-marked').nth(1).click();  // Leads to its line in the log.
  const entry = page.locator('details.entry[open]');
  assert.strictEqual(await entry.count(), 1);
  assert.ok(await entry.evaluate((one) => one.classList.contains('marked')));
  const fields = await entry.locator('tbody tr').evaluateAll((all) =>
    all.map((row) => [...row.children].map((cell) => cell.textContent)));
  let next = 0;
  for (const [offset, dump] of fields) {
    assert.strictEqual(Number(offset), next);
    next += dump.split(' ').length;
  }
  assert.strictEqual(next, 8 + 14);
  const value = (name) => fields.find((field) => field[2] === name)[3];
  assert.strictEqual(value('seq_num'), '1001');
  assert.strictEqual(value('src.devid'), '5');
  assert.strictEqual(value('mote_desc.transducers'), 'light|temp|humid');
}

async function files(page, go) {
  await go(kFailing);
  const links = await page.locator('aside a[href^="cases/"]').evaluateAll((all) =>
    all.map((one) => one.getAttribute('href')));
  assert.deepStrictEqual(links, ['cases/broken_1/j4.wrong_seq.rtr',
    'cases/broken_1/j4.wrong_seq.pcapng']);
  for (const link of links) assert.ok(fs.statSync(path.join(page.folder, link)).size > 100, link);
}

async function rules(page, go) {
  await go('#/rules');
  const all = await page.locator('#rules tbody tr').count();
  await page.getByLabel('State').selectOption('bad');
  const broken = await texts(page, '#rules tbody th');
  assert.ok(broken.length < all && broken.includes('J4-SEQ'), broken.join(' '));
  await page.getByRole('link', { name: 'J4-SEQ', exact: true }).click();
  await titled(page, 'J4-SEQ');
  assert.strictEqual(await page.locator('blockquote').textContent(),
    'A mote ignores a join_reply whose sequence number is not that of its outstanding request.');
  await page.locator('tr:has(a:text-is("j4.wrong_seq")) a.v-fail').first().click();
  await titled(page, 'j4.wrong_seq fail');
  await page.goBack();
  await titled(page, 'J4-SEQ');
}

async function figures(page, go) {
  await go('#/figures');
  assert.deepStrictEqual(
    (await texts(page, 'figure .rc-label')).map((text) => text.split(/[( ]/)[0]),
    ['join', 'join_request', 'join_reply', 'joined', 'ack_join', 'mote_joined']);
  assert.deepStrictEqual(await texts(page, '.rc-heads text:not(.rc-about)'),
    ['tick', 'application', 'm2', 'sA', 'application']);
  // As in the paper: motes 2, 4 and 3, then a reading every 500 ms.
  assert.deepStrictEqual(await texts(page, '.timeline text.iut'), ['m2', 'm4', 'm3']);
  assert.deepStrictEqual(await texts(page, '.timeline text.small'),
    ['0 ms', '3842 ms', '6940 ms']);
  const steps = await page.locator('.timeline circle').evaluateAll((all) => {
    const places = all.map((one) => [Number(one.getAttribute('cy')),
      Number(one.getAttribute('cx'))]);
    return places.slice(1).map((one, i) => one[0] === places[i][0] ? one[1] - places[i][1] : null)
      .filter((step) => step !== null);
  });
  assert.ok(steps.length > 10);
  for (const step of steps) assert.ok(Math.abs(step - steps[0]) < 0.01, steps.join(' '));
}

async function keyboard(page, go) {
  await go('#/cases');
  const cases = await page.locator('#matrix tbody tr').count();
  const order = [];
  for (let i = 0; i < 9; ++i) {
    await page.keyboard.press('Tab');
    order.push(await focused(page));
    if (i === 0) assert.ok(await page.locator('#skip').evaluate((one) => one.offsetLeft >= 0));
  }
  assert.deepStrictEqual(order.slice(0, 7),
    ['skip', 'Cases', 'Rules', 'Figures', 'This run', 'theme', `${cases} pass`]);
  assert.ok(await page.locator('#skip').evaluate((one) => one.offsetLeft < 0));
  await page.locator('#skip').focus();
  await page.keyboard.press('Enter');
  assert.strictEqual(await focused(page), 'main');
  await page.keyboard.press('/');
  assert.strictEqual(await focused(page), 'search');
  await page.keyboard.type('j4.wrong_seq/');  // There it is a letter like others.
  assert.strictEqual(await page.locator('#search').inputValue(), 'j4.wrong_seq/');
  await page.keyboard.press('Backspace');
  await page.locator('#matrix').getByRole('link', { name: 'fail' }).first().focus();
  await page.keyboard.press('Enter');
  await titled(page, 'j4.wrong_seq fail');
  assert.strictEqual(await focused(page), 'main');
  await page.locator('.entry > summary').first().focus();
  await page.keyboard.press('Enter');
  await page.locator('.entry[open] .hex').waitFor({ timeout: 5000 });
}

async function themes(page, go) {
  await go('#/cases');
  const light = await background(page);
  await page.emulateMedia({ colorScheme: 'dark' });
  const dark = await background(page);
  assert.notStrictEqual(light, dark);
  const button = page.locator('#theme');
  assert.strictEqual(await button.getAttribute('aria-pressed'), 'true');
  await button.click();
  assert.strictEqual(await background(page), light);
  assert.strictEqual(await button.getAttribute('aria-pressed'), 'false');
  await page.emulateMedia({ colorScheme: 'light' });
  await button.click();
  assert.strictEqual(await background(page), dark);
}

// Expects whatever implementations say to be shown as text.
async function harmless(page, go) {
  const places = ['#/cases', '#/rules', '#/figures', '#/run'];
  await go('#/cases');
  const hrefs = await page.locator('#matrix td:nth-child(4) a').evaluateAll((all) =>
    all.map((one) => one.getAttribute('href')));
  assert.strictEqual(hrefs.length, 6);
  for (const place of [...places, ...hrefs]) {
    await go(place);
    const state = await page.evaluate(() => ({ pwned: window.pwned,
      scripts: document.scripts.length, images: document.images.length,
      links: [...document.links].map((one) => one.protocol)
        .filter((one) => one !== 'file:') }));
    assert.deepStrictEqual(state, { pwned: undefined, scripts: 2, images: 0, links: [] }, place);
  }
  await go(hrefs[3]);
  assert.match(await page.locator('h2').textContent(), /<\/script><script>window\.pwned = 1/);
  assert.match(await page.locator('pre.stderr').textContent(), /<\/script><script>window\.pwned/);
  const folders = fs.readdirSync(path.join(page.folder, 'cases'));
  assert.deepStrictEqual(folders.filter((name) => !/^[\w.~-]+$/.test(name)), []);
  assert.strictEqual(folders.length, 3);
  assert.deepStrictEqual(fs.readdirSync(page.folder).sort(),
    ['cases', 'index.html', 'report.files']);
}

async function nowhere(page, go) {
  for (const [hash, title] of [['#/case/none', 'This run has no case none'],
    ['#/case/j4.accept/nobody', 'This run has no case j4.accept on nobody'],
    ['#/rule/constructor', 'This run has no rule constructor'],
    ['#/rule/__proto__', 'This run has no rule __proto__'], ['#/rule/%E0%A4%A',
      'This run has no rule %E0%A4%A'], ['#/constructor', 'Cases'], ['#', 'Cases'],
    ['#/cases?verdict=nonsense&role=x', 'Cases']]) {
    await go(hash);
    assert.strictEqual(await page.locator('h2').textContent(), title);
  }
  assert.ok(await rows(page) >= 500);
}

// Expects every view, with all of it unfolded, to be no wider than the screen; what is wider
// scrolls in a box of its own.
async function narrow(page, go) {
  for (const [name, hash, prepare] of views) {
    await go(hash);
    if (prepare) await prepare(page);
    const folded = 'details:not([open])';
    while (await page.locator(folded).count()) {  // What is unfolded may hold more.
      await page.evaluate((one) => document.querySelectorAll(one).forEach((details) => {
        details.open = true;
      }), folded);
      await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
    }
    const sticking = await page.evaluate(() => [...document.querySelectorAll('main *')]
      .filter((one) => one.getBoundingClientRect().right > innerWidth + 1
        && !one.parentElement.closest('.scroll, .chart-frame, pre, .bar, .target'))
      .map((one) => one.outerHTML.slice(0, 90)).slice(0, 5));
    assert.deepStrictEqual(sticking, [], name);
    const [wide, window_] = await page.evaluate(() =>
      [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(wide <= window_, `${name} is ${wide} wide`);
  }
}

const kTelephone = { shape: { width: 390, height: 800 } };
const checks = [['filters', filters], ['advice', advice], ['failures first', order],
  ['search', search],
  ['an earlier run', compared],
  ['a failing case and its chart', failing], ['bytes by field', bytes], ['files', files],
  ['rules', rules], ['the figures of the paper', figures], ['keyboard', keyboard],
  ['light and dark', themes], ['markup is text', harmless], ['places that are not', nowhere],
  ['a small screen', narrow, kTelephone]];

module.exports = { checks };
