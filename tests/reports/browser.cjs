// Opens a report in headless Chromium and checks what a reader would meet.
// node browser.cjs REPORT.html charts=0|1 player=0|1 film=0|1 ; exit code 0 when all holds, 1 with a line for each thing that does not.
const path = require("path");
const fs = require("fs");
const { execFileSync } = require("child_process");
const { chromium } = require("playwright-core");
const looks = require("./looks.cjs");

const [file, ...rest] = process.argv.slice(2);
const expected = Object.fromEntries(rest.map(option => option.split("=")));
const wrong = [];
const check = (holds, text) => { if (!holds) wrong.push(text); };
const softly = ["--no-sandbox", "--disable-gpu"];
const launch = args => chromium.launch({ executablePath: "/usr/bin/chromium", args });

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

const settle = page => page.waitForTimeout(150);
const ranges = page => page.evaluate(() => grouserCharts.all.map(c => ({ linked: c.linked, low: c.u.scales.x.min, high: c.u.scales.x.max })));
const width = range => range.high - range.low;

// Drags over a part of the chart with that number, from and to in shares of its width.
async function drag(page, chart, from, to) {
  const plot = (await page.$$(".uplot .u-over"))[chart];
  await plot.scrollIntoViewIfNeeded();
  const over = await plot.boundingBox(), y = over.y + over.height / 2;
  await page.mouse.move(over.x + over.width * from, y);
  await page.mouse.down();
  await page.mouse.move(over.x + over.width * to, y, { steps: 5 });
  await page.mouse.up();
  await settle(page);
  return over;
}

async function zoomIsLinked(page) {
  const before = await ranges(page), over = await drag(page, 0, 0.3, 0.5), zoomed = await ranges(page);
  zoomed.forEach((range, i) => check(Math.abs(width(range) / width(before[i]) - (range.linked ? 0.2 : 1)) < 0.03,
    `a zoom over time makes chart ${i} show ${range.low} to ${range.high}`));
  await page.mouse.dblclick(over.x + over.width * 0.4, over.y + over.height / 2);
  await settle(page);
  (await ranges(page)).forEach((range, i) => check(Math.abs(width(range) / width(before[i]) - 1) < 0.02, `a double click does not show all of chart ${i} again`));
  const alone = before.findIndex(range => !range.linked);
  if (alone < 0) return;
  const place = await drag(page, alone, 0.2, 0.6), own = await ranges(page);
  check(Math.abs(width(own[alone]) / width(before[alone]) - 0.4) < 0.05, `a chart that is not over time does not zoom: ${width(own[alone])} of ${width(before[alone])}`);
  own.forEach((range, i) => check(i === alone || width(range) === width(before[i]) || !range.linked, "a zoom over frequency moves a chart over time"));
  await page.mouse.dblclick(place.x + place.width * 0.4, place.y + place.height / 2);
  await settle(page);
  check(Math.abs(width((await ranges(page))[alone]) / width(before[alone]) - 1) < 1e-6, "a double click does not show the range of the figure again");
}

// The cursor stands at one time in all charts over time, and what it reads stands in the twin.
async function cursorIsLinked(page) {
  const plot = (await page.$$(".uplot .u-over"))[0];
  await plot.scrollIntoViewIfNeeded();
  const over = await plot.boundingBox();
  await page.mouse.move(over.x + over.width * 0.37, over.y + over.height / 2);
  await settle(page);
  const read = await page.evaluate(() => grouserCharts.all.map(c => ({
    linked: c.linked, figure: c.figure, panel: c.index, time: c.u.cursor.idx == null ? null : c.u.data[0][c.u.cursor.idx],
    span: c.u.scales.x.max - c.u.scales.x.min, map: c.reading ? c.reading.textContent : "", keys: c.keys.map(key => key.lastChild.textContent),
  })));
  const linked = read.filter(chart => chart.linked);
  check(linked.length > 3, "hardly any chart over time");
  for (const chart of linked) check(chart.time != null && Math.abs(chart.time - linked[0].time) < 0.01 * chart.span, `the cursor of ${chart.figure} stands at ${chart.time}, that of the first at ${linked[0].time}`);
  const twin = figuresOf(JSON.parse(fs.readFileSync(file.replace(/html$/, "json"), "utf8")));
  let compared = 0;
  for (const chart of linked) {
    const panel = twin[chart.figure][chart.panel];
    const series = panel.tables.flatMap(table => table.series), cells = panel.map ? panel.map.cells.flat() : [];
    chart.keys.forEach((text, i) => { if (text && text !== "–") { ++compared; check(holds(panel.tables.flatMap(t => t.series.map(s => s.y)).flat(), text), `${chart.figure}: ${text} does not stand in the twin`); } });
    if (chart.map) { ++compared; check(holds(cells, chart.map), `${chart.figure}: ${chart.map} does not stand in the twin`); }
    check(series.length === chart.keys.length, `${chart.figure}: the twin has ${series.length} curves of ${chart.keys.length}`);
  }
  check(compared > 5, `the cursor reads ${compared} numbers`);
}
// Data of each chart by the id of its figure.
function figuresOf(value, found = {}) {
  if (value && typeof value === "object") {
    if (value.chart === true && Array.isArray(value.data)) found[value.id] = value.data;
    Object.values(value).forEach(item => figuresOf(item, found));
  }
  return found;
}
// Whether one of the values is what the text says in its digits.
function holds(values, text) {
  const digits = text.replace("\u2212", "-").match(/-?\d+(\.\d+)?(e[-+]?\d+)?/i)[0], shown = Number(digits);
  const [mantissa, power = "0"] = digits.toLowerCase().split("e"), step = 10 ** (Number(power) - (mantissa.split(".")[1] || "").length);
  return values.some(value => value != null && Math.abs(value - shown) <= 0.51 * step + 1e-4 * Math.abs(value));
}

async function chartsObeyKeys(page) {
  const first = (await page.$$(".chart [tabindex]"))[0];
  const before = (await ranges(page))[0];
  await first.focus();
  await page.keyboard.press("End");
  for (let i = 0; i < 5; ++i) await page.keyboard.press("Shift+ArrowLeft");
  await settle(page);
  const at = await page.evaluate(() => { const { u } = grouserCharts.all[0]; return u.posToVal(u.cursor.left, "x"); });
  check(Math.abs((at - before.low) / width(before) - 0.5) < 0.02, `arrows move the cursor to ${at}`);
  await page.keyboard.press("+");
  await settle(page);
  (await ranges(page)).filter(r => r.linked).forEach(r => check(Math.abs(width(r) / width(before) - 0.5) < 0.05, "+ does not zoom all charts over time"));
  await page.keyboard.press("0");
  await settle(page);
  check(Math.abs(width((await ranges(page))[0]) / width(before) - 1) < 0.02, "0 does not show all again");
  if (expected.player !== "1") return;
  const clock = () => page.$eval(".clock", output => output.textContent);
  const was = await clock();
  await page.keyboard.press("Home");
  await page.keyboard.press("Enter");
  check(await clock() !== was, "enter on a chart does not move the player");
}

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
  const maps = await page.evaluate(() => grouserCharts.all.filter(c => c.panel.map).map(c => c.u.ctx.canvas.id = "map" + Math.random().toString(36).slice(2)));
  for (const id of maps) check(await colors(page, "#" + id) > 30, "a map is empty");
  await zoomIsLinked(page);
  await cursorIsLinked(page);
  await chartsObeyKeys(page);
  const key = await page.$(".keys button");
  await key.click();
  check(await page.evaluate(() => !grouserCharts.all[0].u.series[1].show), "a click on a name does not hide its curve");
  await key.click();
}

async function player(page) {
  if (expected.player !== "1") return;
  const state = await page.evaluate(() => window.grouserPage);
  check(state.players === 1, `expected a player, found ${state.players}`);
  check(await colors(page, ".stage canvas") > 100, "the player draws nothing");
  const clock = () => page.$eval(".clock", output => output.textContent);
  const changes = was => page.waitForFunction(text => document.querySelector(".clock").textContent !== text, was, { timeout: 20000 });
  const first = await clock();
  await page.$eval(".seek", input => { input.value = 3; input.dispatchEvent(new Event("input")); });
  const second = await clock();
  check(first !== second, "the slider does not move the player");
  await page.click(".play");
  await changes(second);
  await page.$eval(".play", button => button.click());  // without a GPU a playing picture leaves a pointer waiting
  await page.focus(".stage");
  await page.keyboard.press("Home");
  const begin = await clock();
  check(/^0\.00 /.test(begin), `home shows ${begin}`);
  await page.keyboard.press("ArrowRight");
  check(await clock() !== begin, "an arrow does not step the player");
  const turned = () => page.$eval(".stage canvas", canvas => canvas.toDataURL().length);
  const before = await turned();
  await page.keyboard.press("Shift+ArrowLeft");
  check(await turned() !== before, "shift and an arrow do not orbit");
  const still = await clock();
  await page.keyboard.press(" ");
  await changes(still);
  await page.keyboard.press(" ");
}

// What stands for the player where there is no WebGL: the film, else pictures.
async function withoutWebGl() {
  if (expected.player !== "1") return;
  const browser = await launch([...softly, "--disable-3d-apis"]);
  const page = await open(browser, { viewport: { width: 1200, height: 900 } });
  const state = await page.evaluate(() => window.grouserPage);
  check(state.players === 0 && state.errors.length === 0, "a player without WebGL: " + state.errors.join("; "));
  check(await page.$$eval(".stage, .controls", all => all.length) === 0, "an empty player stays");
  const visible = selector => page.$$eval(selector, all => all.some(e => e.getClientRects().length > 0 && e.getBoundingClientRect().height > 100));
  check(await visible(".film video") === (expected.film === "1"), "the film does not stand in");
  check(await visible(".stills") === (expected.film !== "1"), "pictures do not stand in");
  check(/no WebGL2/.test(await page.innerText("main")), "the page does not say that WebGL is absent");
  await browser.close();
}

// Every heading of the paper is followed by what it heads, on its own page.
async function paper(page) {
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  check(await page.$$eval("details", all => all.every(fold => fold.open)), "folded parts are not printed");
  check(await page.$$eval(".screen, .chart", all => all.every(e => e.getClientRects().length === 0)), "moving parts are printed");
  const headings = await page.$$eval("h1, h2, h3, h4", all => all.filter(h => h.getClientRects().length > 0).map(h => ({ level: Number(h.tagName[1]), text: h.innerText.replace(/\s+/g, " ").trim() })));
  const pdf = file.replace(/html$/, "pdf");
  await page.pdf({ path: pdf, format: "A4", preferCSSPageSize: true });
  const pages = execFileSync("pdftotext", [pdf, "-"], { encoding: "utf8" }).split("\f").map(text => text.split("\n").map(line => line.replace(/\s+/g, " ").trim()).filter(Boolean));
  if (pages.length && pages[pages.length - 1].length === 0) pages.pop();
  const lines = pages.flat();
  for (const heading of headings) check(lines.some(line => heading.text.startsWith(line)), `the paper lacks the heading ${heading.text}`);
  // A level for lines that are nothing but a heading.
  const levelOf = line => headings.find(heading => heading.text === line)?.level;
  pages.forEach((text, k) => {
    check(text.length > 3, `page ${k + 1} of ${pages.length} is nearly empty: ${text.join(" / ")}`);
    text.forEach((line, i) => {
      const level = levelOf(line), next = i + 1 < text.length ? levelOf(text[i + 1]) : undefined;
      if (level == null) return;
      check(i + 1 < text.length, `the heading ${line} stands alone at the end of page ${k + 1}`);
      check(next == null || next > level || text[i + 1] === line, `nothing stands under the heading ${line}`);
    });
  });
}

(async () => {
  const browser = await launch([...softly, "--enable-unsafe-swiftshader"]);
  const page = await open(browser, { viewport: { width: 1200, height: 900 }, colorScheme: "light" });
  wrong.push(...await looks.contrast(page, "light"), ...await looks.structure(page));
  await charts(page);
  await player(page);
  const background = p => p.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await background(page);
  await paper(page);

  const dark = await open(browser, { viewport: { width: 1200, height: 900 }, colorScheme: "dark" });
  check(light !== await background(dark), "dark mode looks like light mode");
  wrong.push(...await looks.contrast(dark, "dark"));

  const narrow = await open(browser, { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true });
  const small = await narrow.$$eval("svg.figure", all => all.filter(svg => svg.getClientRects().length > 0).map(svg => svg.getBoundingClientRect().width));
  check(small.every(width => width > 250), `a small multiple is too small for a telephone: ${Math.min(...small)} pixels`);
  check(await narrow.evaluate(() => document.documentElement.scrollWidth <= innerWidth + 1), "the page is wider than a telephone");
  await browser.close();
  await withoutWebGl();
  for (const text of wrong) console.log(text);
  process.exit(wrong.length ? 1 : 0);
})().catch(error => { console.log(String(error)); process.exit(1); });
