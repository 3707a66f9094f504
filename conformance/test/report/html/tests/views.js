'use strict';
// The views of the page, each with the parts to open in it first. Of the cases some, as axe looks
// at every cell and all rows are alike.

const kFailing = '#/case/j4.wrong_seq/broken%201/1';

const unfold = async (page) => {
  for (const one of await page.locator('details > summary').all()) await one.click();
};

const views = [
  ['cases', '#/cases?text=j4'],
  ['gone', '#/cases?verdict=fail', unfold],
  ['failures', '#/cases?verdict=fail'],
  ['nothing', '#/cases?text=there+is+no+such+case'],
  ['rules', '#/rules'],
  ['rule', '#/rule/J4-SEQ'],
  ['failing', kFailing],
  ['unfolded', kFailing, unfold],
  ['passing', '#/case/open_door/good%201/1'],
  ['long', '#/case/hospital/good%201/1'],
  ['figures', '#/figures'],
  ['run', '#/run'],
  ['missing', '#/case/none'],
];

module.exports = { views, kFailing };
