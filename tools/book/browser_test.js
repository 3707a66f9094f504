'use strict';
// Tests the book in a real Chromium, from file:// and without a network: what it shows, that keys
// reach everything, that everybody can read it, on screens of all widths and on paper. Usage: node
// browser_test.js BOOK.html [SHOTS]: pictures go into SHOTS.
const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const url = require('node:url');
const { accessible, launch, open } =
  require('../../conformance/test/report/html/tests/browser.js');

const kLoadMsMax = 10000;  // On a machine that does much else.
const kPhone = { width: 360, height: 740 };
const kDesk = { width: 1400, height: 950 };

const top = (page, id) => page.evaluate((one) =>
  document.getElementById(one).getBoundingClientRect().top, id);
const focused = (page) => page.evaluate(() => {
  const one = document.activeElement;
  return one.id || one.getAttribute('href') || one.tagName;
});
const settled = (page) => page.evaluate(() => new Promise((done) =>
  requestAnimationFrame(() => requestAnimationFrame(done))));

async function go(page, anchor = '') {
  await page.goto(page.home + (anchor && '#' + anchor));
  await settled(page);
}

async function inView(page, id, height = kDesk.height) {
  await page.waitForFunction(([one, most]) => {
    const at = document.getElementById(one).getBoundingClientRect();
    return at.height > 0 && at.top >= 40 && at.top < most / 2;
  }, [id, height], { timeout: 5000 }).catch(() => {});
  const at = await top(page, id);
  assert.ok(at >= 40 && at < height / 2, `#${id} is at ${at}`);
}

const checks = [
  ['loads', kDesk, async (page) => {
    const started = Date.now();
    await go(page);
    const ms = Date.now() - started;
    assert.ok(ms < kLoadMsMax, `it took ${ms} ms to load`);
    assert.ok(await page.locator('main h1').count() > 10);
    assert.ok(await page.locator('svg').count() > 40);
  }],
  ['a rule, a message and a case can be linked to', kDesk, async (page) => {
    for (const id of ['J4-SEQ', 'join_reply', 'decision-105']) {
      await go(page, id);
      await inView(page, id);
    }
    await go(page, 'j4.wrong_seq');
    assert.ok(await page.locator('[id="j4.wrong_seq"]').evaluate((one) => one.open));
    await inView(page, 'j4.wrong_seq');
  }],
  ['keys skip to the text', kDesk, async (page) => {
    await go(page);
    await page.keyboard.press('Tab');
    assert.strictEqual(await focused(page), '#text');
    await page.keyboard.press('Enter');
    assert.strictEqual(await focused(page), 'text');
  }],
  ['keys go from the top through all that is there', kDesk, async (page) => {
    await go(page);
    const met = [];
    for (let i = 0; i < 12; ++i) {
      await page.keyboard.press('Tab');
      met.push(await focused(page));
      const outline = await page.evaluate(() => {
        const style = getComputedStyle(document.activeElement);
        return style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0;
      });
      assert.ok(outline, `${met.at(-1)} shows no focus`);
    }
    for (const one of ['#text', '#top', 'find', 'theme']) assert.ok(met.includes(one), one);
    assert.ok(met.filter((one) => one.startsWith('#')).length > 6, met.join(' '));
  }],
  ['finding with keys', kDesk, async (page) => {
    await go(page);
    await page.keyboard.press('/');
    assert.strictEqual(await focused(page), 'find');
    await page.keyboard.type('j4-seq');
    assert.match(await page.locator('#found a').first().textContent(), /^J4-SEQ rule/);
    assert.match(await page.locator('#count').textContent(), /place/);
    await page.keyboard.press('ArrowDown');
    assert.strictEqual(await focused(page), '#J4-SEQ');
    await page.keyboard.press('Enter');
    assert.strictEqual(new URL(page.url()).hash, '#J4-SEQ');
    await inView(page, 'J4-SEQ');
    assert.ok(await page.locator('#found').isHidden());
    await page.keyboard.press('/');
    await page.keyboard.type('join_reply');
    assert.match(await page.locator('#found a').first().textContent(), /^join_reply message/);
    await page.keyboard.press('Escape');
    assert.strictEqual(await page.inputValue('#find'), '');
    await page.keyboard.type('nothing-is-called-this');
    assert.match(await page.locator('#found').textContent(), /Nothing has this name/);
    assert.ok(await page.locator('#found a').count() === 0);
  }],
  ['what is looked for is text, never HTML', kDesk, async (page) => {
    await go(page);
    await page.fill('#find', '<img src=x onerror=alert(1)>');
    assert.strictEqual(await page.locator('#found img').count(), 0);
  }],
  ['the contents say where the reader is', kDesk, async (page) => {
    await go(page, 'all-rules');
    await page.waitForFunction(() =>
      document.querySelector('#contents [aria-current]').hash === '#all-rules');
    await page.locator('#contents [href="#decisions"]').click();
    await page.waitForFunction(() =>
      document.querySelector('#contents [aria-current]').hash === '#decisions');
    await inView(page, 'decisions');
  }],
  ['light and dark can be chosen', kDesk, async (page) => {
    await go(page);
    const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const before = await paper();
    await page.locator('#theme').click();
    assert.notStrictEqual(await paper(), before);
    await page.locator('#theme').click();
    assert.strictEqual(await paper(), before);
  }],
  ['a narrow screen scrolls down only', kPhone, async (page) => {
    await go(page);
    const [whole, window] = await page.evaluate(() =>
      [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(whole <= window, `${whole} wide, the window ${window}`);
    const sticking = await page.evaluate(() => [...document.querySelectorAll('main *')]
      .filter((one) => one.getBoundingClientRect().right > innerWidth + 1
        && !one.parentElement.closest('.scroll, pre'))
      .map((one) => one.outerHTML.slice(0, 90)).slice(0, 5));
    assert.deepStrictEqual(sticking, []);
  }],
  ['a narrow screen folds the contents', kPhone, async (page) => {
    await go(page);
    assert.ok(await page.locator('#contents').isHidden());
    await page.locator('.menu summary').focus();
    await page.keyboard.press('Enter');
    assert.ok(await page.locator('#contents').isVisible());
    await page.locator('#contents [href="#all-rules"]').click();
    await inView(page, 'all-rules', kPhone.height);
    assert.ok(await page.locator('#contents').isHidden());
  }],
  ['what is too wide is reached by keys', kPhone, async (page) => {
    await go(page);
    const unreachable = await page.evaluate(() => [...document.querySelectorAll('.scroll, pre')]
      .filter((one) => one.scrollWidth > one.clientWidth + 1 && one.tabIndex < 0).length);
    assert.strictEqual(unreachable, 0);
    assert.ok(await page.locator('pre[tabindex="0"]').count() > 5);
  }],
  ['paper', kDesk, async (page) => {
    await go(page);
    await page.emulateMedia({ media: 'print' });
    assert.ok(await page.locator('.menu').isHidden());
    assert.ok(await page.locator('.top').isHidden());
    await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
    assert.strictEqual(await page.locator('main details:not([open])').count(), 0);
    await page.evaluate(() => dispatchEvent(new Event('afterprint')));
    assert.ok(await page.locator('main details:not([open])').count() > 100);
  }],
];

// Without its script all of the text is there, and so are the contents.
async function withoutScript(browser, home) {
  const context = await browser.newContext({ javaScriptEnabled: false, viewport: kDesk });
  const page = await context.newPage();
  await page.goto(home);
  assert.ok(await page.locator('#contents').isVisible());
  assert.ok(await page.locator('.search').isHidden());
  await page.locator('#contents [href="#all-rules"]').click();
  assert.strictEqual(new URL(page.url()).hash, '#all-rules');
  await context.close();
}

async function main() {
  const [book, shots] = process.argv.slice(2);
  if (!book) throw new Error('usage: node browser_test.js BOOK.html [SHOTS]');
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'book-'));
  fs.copyFileSync(book, path.join(folder, 'rubric.html'));  // Alone in its folder.
  const home = url.pathToFileURL(path.join(folder, 'rubric.html')).href;
  const browser = await launch();
  let failed = 0;
  const attempt = async (name, check) => {
    try {
      await check();
      console.log('ok   ' + name);
    } catch (error) {
      ++failed;
      console.log(`FAIL ${name}\n${error.stack}`);
    }
  };
  const inPage = async (scheme, shape, check) => {
    const page = await open(browser, scheme, shape);
    page.home = home;
    await page.context().setOffline(true);
    await check(page);
    await page.clean();
    await page.context().close();
  };
  try {
    for (const [name, shape, check] of checks) {
      await attempt(name, () => inPage('light', shape, check));
    }
    await attempt('without script', () => withoutScript(browser, home));
    for (const scheme of ['light', 'dark']) {
      for (const [where, shape] of [['desk', kDesk], ['phone', kPhone]]) {
        await attempt(`axe: ${where}, ${scheme}`, () => inPage(scheme, shape, async (page) => {
          await go(page);
          // Opens everything folded once in each colour.
          if (where === 'desk') await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
          await settled(page);
          await accessible(page, `${where}, ${scheme}`);
          if (shots) {
            await page.screenshot({ path: path.join(shots, `${where}-${scheme}.png`) });
          }
        }));
      }
    }
  } finally {
    await browser.close();
    fs.rmSync(folder, { recursive: true });
  }
  console.log(failed ? `${failed} failed` : 'all passed');
  process.exit(failed ? 1 : 0);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
