'use strict';
// A headless Chromium whose pages record everything that must not happen. The book's test
// (tools/book) uses it, too.
const assert = require('node:assert');
const axe = require('axe-core').source;
const { chromium } = require('playwright-core');

const kFlags = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync'];

const launch = () => chromium.launch({ executablePath: '/usr/bin/chromium', headless: true,
  args: kFlags });

// Opens a page that records everything that must not happen.
async function open(browser, scheme, shape = { width: 1400, height: 950 }) {
  const context = await browser.newContext({ colorScheme: scheme, viewport: shape });
  await context.addInitScript(() => {
    window.violations = [];
    document.addEventListener('securitypolicyviolation', (event) =>
      window.violations.push(`${event.violatedDirective} ${event.blockedURI}`));
  });
  const page = await context.newPage();
  const breaches = [];
  page.on('console', (message) => breaches.push('console: ' + message.text()));
  page.on('pageerror', (error) => breaches.push('error: ' + error.stack));
  page.on('request', (request) => {
    const wanted = request.url().split('#')[0];
    if (wanted !== page.home && !wanted.startsWith('data:')) breaches.push('request: ' + wanted);
  });
  page.clean = async () => {
    const violations = await page.evaluate(() => window.violations);
    assert.deepStrictEqual([...breaches, ...violations], []);
  };
  return page;
}

// Expects no accessibility violation in the page as it is; `rules` limits axe to some of its rules.
async function accessible(page, name, rules) {
  await page.evaluate(axe);
  const found = await page.evaluate((only) => window.axe.run(document, { resultTypes:
    ['violations'], ...(only && { runOnly: only }) }), rules);
  assert.deepStrictEqual(found.violations.map((one) =>
    `${one.id}: ${one.nodes.map((node) => node.html).join(' ')}`), [], name);
  assert.ok(found.passes.length >= (rules ? rules.length : 11), 'axe looked at next to nothing');
}

module.exports = { launch, open, accessible };
