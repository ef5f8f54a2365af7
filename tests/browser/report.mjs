// Opens a report in headless Chromium, as a file and without a network: node report.mjs REPORT.html
// Fails when the console has an error, anything is fetched, the table has another number of rows than the data has passes,
// or what can be moved does not move.
import assert from 'node:assert/strict';
import {createRequire} from 'node:module';
import {pathToFileURL} from 'node:url';

const [, , report, modules] = process.argv;
const {chromium} = createRequire(pathToFileURL(modules + '/'))('playwright-core');
const browser = await chromium.launch({executablePath: process.env.NF_CHROMIUM || '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu']});
try {
  const page = await browser.newPage({viewport: {width: 1200, height: 900}});
  const errors = [], fetched = [];
  page.on('console', m => { if (['error', 'warning'].includes(m.type())) errors.push(m.text()); });
  page.on('pageerror', e => errors.push(String(e)));
  page.on('request', r => { if (!r.url().startsWith('data:')) fetched.push(r.url()); });
  const address = pathToFileURL(report).href;
  await page.goto(address);
  assert.deepEqual(fetched, [address], 'the page is one file');

  const data = JSON.parse(await page.locator('#data').textContent());
  const passes = data.timings.flatMap(t => t.runs).flatMap(r => r.passes).length;
  const cells = data.sweeps.flatMap(s => s.cells).length;
  assert.equal(await page.locator('#pass-table tbody tr').count(), passes);
  assert.equal(await page.locator('#cell-table tbody tr').count(), cells);
  assert.ok(passes + cells > 0, 'there is something in the report');
  assert.ok(await page.locator('#environment li, #environment p').count() > 0);
  const software = data.timings.some(t => t.runs.some(r => r.context.device.software));
  if (software) assert.match(await page.locator('#environment').innerText(), /software device/);

  // Sorting: by median, the largest first, then the smallest.
  const table = passes ? '#pass-table' : '#cell-table', column = passes ? 4 : 2;
  const medians = async () => (await page.locator(`${table} tbody tr`).evaluateAll((rows, c) => rows.map(r => Number(r.cells[c].textContent)), column));
  await page.locator(`${table} th button`, {hasText: 'median'}).click();
  const down = await medians();
  assert.deepEqual(down, [...down].sort((a, b) => b - a));
  await page.locator(`${table} th button`, {hasText: 'median'}).click();
  assert.deepEqual(await medians(), [...down].reverse().sort((a, b) => a - b));

  if (data.pictures.length > 1) {
    const width = () => page.locator('#wipe-a').evaluate(e => e.getBoundingClientRect().width);
    const before = await width();
    await page.locator('#slider').focus();
    for (let i = 0; i < 100; ++i) await page.keyboard.press('ArrowRight');
    assert.ok(await width() > before + 20, 'the slider moves');
    const box = await page.locator('#wipe').boundingBox();
    await page.mouse.click(box.x + box.width / 4, box.y + 5);
    assert.ok(Math.abs(await width() - box.width / 4) < 8, 'a click moves it too');
    for (const id of ['#image-a', '#image-b']) assert.ok(await page.locator(id).evaluate(i => i.complete && i.naturalWidth > 0));
    await page.locator('#heat').check();
    await page.waitForFunction(() => { const c = document.getElementById('heat-map'); return !c.hidden && c.width > 1; });
    const colored = await page.locator('#heat-map').evaluate(c => c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((v, i) => i % 4 < 3 && v > 0));
    assert.ok(colored, 'two different pictures have a difference');
  }
  if (cells) {
    const place = await page.locator('#front-controls select').first().inputValue();
    const metric = await page.locator('#front-controls select').nth(1).inputValue();
    const here = data.sweeps[0].cells.filter(c => c.place === place && typeof c.errors[metric] === 'number');
    assert.equal(await page.locator('#scatter .dot').count(), here.length);
    const ms = c => c[c.cost].median;
    const worst = c => here.some(o => ms(o) <= ms(c) && o.errors[metric] <= c.errors[metric] && (ms(o) < ms(c) || o.errors[metric] < c.errors[metric]));
    assert.equal(await page.locator('#scatter .dot.best').count(), here.filter(c => !worst(c)).length, 'the Pareto front');
    await page.locator('#scatter .dot.best').first().click({force: true});
    assert.match(await page.locator('#point').innerText(), /nearfield bench /);
  }
  if (process.env.NF_SCREENSHOT) await page.screenshot({path: process.env.NF_SCREENSHOT, fullPage: true});
  assert.deepEqual(errors, [], 'nothing on the console');
  console.log(`ok: ${passes} passes, ${cells} cells, ${data.pictures.length} pictures`);
} finally {
  await browser.close();
}
