'use strict';
// Tests the page in a real Chromium, from file://: what it shows, what it does, that everybody can
// use it, and that no text of a report can break out of its place. Usage: node browser_test.js
// SAMPLE [SHOTS]: SAMPLE writes a report into a folder; pictures of the views go into SHOTS.
const { execFileSync } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const url = require('node:url');
const { accessible, launch, open } = require('./browser.js');
const { views } = require('./views.js');
const { checks } = require('./checks.js');

const kCasesMin = 500;

async function go(page, hash) {
  await page.goto(page.home + hash);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
}

async function allCases(page) {
  await page.goto(page.home);
  await page.waitForFunction((least) =>
    document.querySelectorAll('#matrix tbody tr').length >= least, kCasesMin);
  const rows = await page.locator('#matrix tbody tr').count();
  console.log(`ok   ${rows} cases are there`);
}

// Expects every view, in both colours, to be accessible. Only contrasts depend on the colours.
async function everyView(browser, home, shots) {
  for (const [scheme, rules] of [['light'], ['dark', ['color-contrast']]]) {
    const page = await open(browser, scheme);
    page.home = home;
    for (const [name, hash, prepare] of views) {
      await go(page, hash);
      if (prepare) await prepare(page);
      await accessible(page, `${name}, ${scheme}`, rules);
      if (shots) await page.screenshot({ path: path.join(shots, `${name}-${scheme}.png`) });
    }
    await page.clean();
    await page.context().close();
    console.log(`ok   axe: 0 violations in ${views.length} views, ${scheme}`);
  }
}

async function main() {
  const [sample, shots] = process.argv.slice(2);
  if (!sample) throw new Error('usage: node browser_test.js SAMPLE [SHOTS]');
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'report-'));
  const browser = await launch();
  let failed = 0;
  try {
    execFileSync(sample, [folder], { stdio: 'inherit' });
    const home = url.pathToFileURL(path.join(folder, 'index.html')).href;
    const whole = [
      ['all cases', async () => {
        const page = await open(browser, 'light');
        page.home = home;
        await allCases(page);
        await page.clean();
        await page.context().close();
      }],
      ['every view', () => everyView(browser, home, shots)],
      ...checks.map(([name, check, options = {}]) => [name, async () => {
        const page = await open(browser, options.scheme || 'light', options.shape);
        page.home = home;
        page.folder = folder;
        await check(page, (hash) => go(page, hash));
        await page.clean();
        await page.context().close();
      }]),
    ];
    for (const [name, check] of whole) {
      try {
        await check();
        console.log('ok   ' + name);
      } catch (error) {
        ++failed;
        console.log(`FAIL ${name}\n${error.stack}`);
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
