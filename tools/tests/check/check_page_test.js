'use strict';
// The pages of `rubric check --report` and `rubric test --report` in a real Chromium: failures
// first, usable by everybody, and no wider than a telephone. Usage: node check_page_test.js RUBRIC;
// run in the project's folder.
const assert = require('node:assert');
const { spawnSync } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const url = require('node:url');
const { accessible, launch, open } =
  require('../../../conformance/test/report/html/tests/browser.js');

const kCapture = 'spec/captures/firmware/h4_stale_bytes.pcapng';
const kTelephone = { width: 390, height: 800 };

// The cases of one implementation, with reasons that are long.
async function casesOfOne(browser, report) {
  const done = spawnSync(process.argv[2], ['test', '--target', 'machine:answers_members', '--cases',
    'j*', '--report', report]);
  assert.strictEqual(done.status, 1, String(done.stderr));
  const page = await open(browser, 'light', kTelephone);
  page.home = url.pathToFileURL(path.join(report, 'index.html')).href;
  await page.goto(page.home);
  const verdicts = await page.locator('#matrix tbody .verdict').allTextContents();
  const failing = verdicts.lastIndexOf('fail') + 1;
  assert.ok(failing > 0 && failing < verdicts.length);
  assert.deepStrictEqual([...new Set(verdicts.slice(0, failing))], ['fail']);
  const hidden = await page.locator('.scroll').first().evaluate((one) =>
    one.scrollWidth - one.clientWidth);
  assert.strictEqual(hidden, 0, `${hidden} pixels of the table are out of sight`);
  await accessible(page, 'cases');
  await page.clean();
}

async function main() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'check-page-'));
  const browser = await launch();
  try {
    const capture = path.join(folder, `${'long_name_without_a_space'.repeat(5)}.pcapng`);
    fs.copyFileSync(kCapture, capture);
    const report = path.join(folder, 'report');
    const done = spawnSync(process.argv[2], ['check', capture, '--report', report]);
    assert.strictEqual(done.status, 1, String(done.stderr));
    for (const scheme of ['light', 'dark']) {
      const page = await open(browser, scheme, kTelephone);
      page.home = url.pathToFileURL(path.join(report, 'index.html')).href;
      await page.goto(page.home);
      const first = await page.locator('details').first();
      assert.match(await first.locator('summary').textContent(), /^fail N11-NBYTES/);
      assert.ok(await first.evaluate((one) => one.open));
      await page.evaluate(() => document.querySelectorAll('details').forEach((one) => {
        one.open = true;
      }));
      await accessible(page, scheme);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= kTelephone.width, `the page is ${wide} wide`);
      await page.clean();
    }
    await casesOfOne(browser, path.join(folder, 'cases'));
  } finally {
    await browser.close();
    fs.rmSync(folder, { recursive: true });
  }
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
