// Opens a report in headless Chromium and checks what a reader would meet.
// node browser.cjs REPORT.html charts=0|1 player=0|1 ; exit code 0 when all holds, 1 with a line for each thing that does not.
const path = require("path");
const { chromium } = require("playwright-core");

const [file, ...rest] = process.argv.slice(2);
const expected = Object.fromEntries(rest.map(option => option.split("=")));
const wrong = [];
const check = (holds, text) => { if (!holds) wrong.push(text); };

async function open(browser, options) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const requests = [];
  page.on("request", request => { if (!/^(data|blob):/.test(request.url())) requests.push(request.url()); });
  page.on("console", message => { if (message.type() === "error") wrong.push("console: " + message.text()); });
  page.on("pageerror", error => wrong.push("page error: " + error));
  page.on("dialog", dialog => { wrong.push("a dialog opened: " + dialog.message()); dialog.dismiss(); });
  await page.goto("file://" + path.resolve(file));
  await page.waitForSelector("html[data-ready]", { state: "attached", timeout: 60000 });
  check(requests.length === 1, `expected one request, found ${requests.join(" ")}`);
  return page;
}

// Distinct colours of a few hundred pixels: a picture that was drawn has many, an empty one has few.
const colors = (page, selector) => page.$eval(selector, canvas => {
  const copy = document.createElement("canvas");
  copy.width = 160; copy.height = 90;
  const pixels = copy.getContext("2d");
  pixels.drawImage(canvas, 0, 0, 160, 90);
  const data = pixels.getImageData(0, 0, 160, 90).data, seen = new Set();
  for (let i = 0; i < data.length; i += 4) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
  return seen.size;
});

async function charts(page) {
  const state = await page.evaluate(() => window.grouserPage);
  check(state.errors.length === 0, "errors: " + state.errors.join("; "));
  if (expected.charts === "0") {
    check(state.charts === 0, `expected no charts, found ${state.charts}`);
    const multiples = await page.$$eval("svg.figure", all => all.filter(svg => svg.getClientRects().length > 0).map(svg => svg.getBoundingClientRect().width));
    check(multiples.length > 5, `expected small multiples, found ${multiples.length}`);
    check(multiples.every(width => width > 200), `a small multiple is too small to read: ${Math.min(...multiples)} pixels`);
    return;
  }
  check(state.charts >= 5, `expected charts, found ${state.charts}`);
  check(await colors(page, ".uplot canvas") > 3, "the first chart is empty");
  // A zoom of one chart over time is the zoom of all of them, and a double click takes it back.
  const ranges = () => page.evaluate(() => grouserCharts.all.filter(c => c.linked).map(c => c.u.scales.x.max - c.u.scales.x.min));
  const before = await ranges();
  const plot = await page.$(".uplot .u-over");
  await plot.scrollIntoViewIfNeeded();
  const over = await plot.boundingBox();
  await page.mouse.move(over.x + over.width * 0.3, over.y + over.height / 2);
  await page.mouse.down();
  await page.mouse.move(over.x + over.width * 0.5, over.y + over.height / 2, { steps: 5 });
  await page.mouse.up();
  await page.waitForTimeout(200);
  const zoomed = await ranges();
  check(zoomed.every((range, i) => Math.abs(range / before[i] - 0.2) < 0.03), `zoom is not shared: ${zoomed.join(" ")}`);
  await page.mouse.dblclick(over.x + over.width * 0.4, over.y + over.height / 2);
  await page.waitForTimeout(200);
  check((await ranges()).every((range, i) => Math.abs(range / before[i] - 1) < 0.02), "a double click does not show all again");
  const key = await page.$(".keys button");
  await key.click();
  check(await page.evaluate(() => !grouserCharts.all[0].u.series[1].show), "a click on a name does not hide its curve");
}

async function player(page) {
  const state = await page.evaluate(() => window.grouserPage);
  if (expected.player !== "1") return;
  check(state.players === 1, `expected a player, found ${state.players}`);
  check(await colors(page, ".stage canvas") > 100, "the player draws nothing");
  const clock = () => page.$eval(".clock", output => output.textContent);
  const first = await clock();
  await page.$eval(".seek", input => { input.value = 3; input.dispatchEvent(new Event("input")); });
  const second = await clock();
  check(first !== second, "the slider does not move the player");
  await page.click(".play");
  await page.waitForFunction(was => document.querySelector(".clock").textContent !== was, second, { timeout: 20000 });
  await page.click(".play");
}

(async () => {
  const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"] });
  const page = await open(browser, { viewport: { width: 1200, height: 900 }, colorScheme: "light" });
  await charts(page);
  await player(page);
  const background = p => p.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await background(page);
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  check(await page.$$eval("details", all => all.every(fold => fold.open)), "folded parts are not printed");
  check(await page.$$eval(".screen, .chart", all => all.every(e => e.getClientRects().length === 0)), "moving parts are printed");
  check(await page.$$eval("h1, h2, h3", all => all.filter(h => h.getClientRects().length > 0).every(h => h.parentElement.innerText.trim() !== h.innerText.trim())),
    "a heading is printed over nothing");

  const dark = await open(browser, { viewport: { width: 1200, height: 900 }, colorScheme: "dark" });
  check(light !== await background(dark), "dark mode looks like light mode");

  const narrow = await open(browser, { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true });
  const small = await narrow.$$eval("svg.figure", all => all.filter(svg => svg.getClientRects().length > 0).map(svg => svg.getBoundingClientRect().width));
  check(small.every(width => width > 250), `a small multiple is too small for a telephone: ${Math.min(...small)} pixels`);
  check(await narrow.evaluate(() => document.documentElement.scrollWidth <= innerWidth + 1), "the page is wider than a telephone");

  await browser.close();
  for (const text of wrong) console.log(text);
  process.exit(wrong.length ? 1 : 0);
})().catch(error => { console.log(String(error)); process.exit(1); });
