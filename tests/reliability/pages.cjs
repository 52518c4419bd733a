// Opens pages in headless Chromium and tells what a browser made of each: node pages.cjs PAGE... ; one line of JSON a page.
const path = require("path");
const { chromium } = require("playwright-core");

// The page as a tree: elements with their attributes, and texts. Data that no browser runs are read as data.
function tree(node) {
  if (node.nodeType === Node.TEXT_NODE) return node.data;
  if (node.nodeType !== Node.ELEMENT_NODE) return { other: node.nodeType };
  const attributes = Object.fromEntries([...node.attributes].map(a => [a.name, a.value]));
  let children = [...node.childNodes].map(tree);
  if (node.localName === "script" && attributes.type === "application/json") children = [JSON.parse(node.textContent)];
  if (node.localName === "script" && attributes.type === "application/octet-stream") children = [];
  return { tag: node.localName, attributes, children };
}

(async () => {
  const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] });
  for (const file of process.argv.slice(2)) {
    const told = { file, wrong: [] };
    const look = async javaScriptEnabled => {
      const context = await browser.newContext({ javaScriptEnabled });
      const page = await context.newPage();
      page.on("request", request => { if (!/^data:/.test(request.url()) && !request.url().endsWith(encodeURI(path.basename(file)))) told.wrong.push("asks for " + request.url()); });
      page.on("dialog", dialog => { told.wrong.push("a dialog opened"); dialog.dismiss(); });
      page.on("pageerror", error => told.wrong.push("page error: " + error));
      page.on("console", message => { if (message.type() === "error") told.wrong.push("console: " + message.text()); });
      await page.goto("file://" + path.resolve(file), { waitUntil: "load" });
      return { context, page };
    };
    // As written, before any of its own scripts has run.
    const still = await look(false);
    told.tree = await still.page.evaluate(`(${tree})(document.documentElement)`);
    await still.context.close();
    const live = await look(true);
    if (await live.page.$("script:not([type])")) await live.page.waitForSelector("html[data-ready]", { state: "attached", timeout: 60000 });
    if (await live.page.evaluate(() => window.grouserHit !== undefined)) told.wrong.push("a script of the data ran");
    told.foreign = await live.page.evaluate(() => document.querySelectorAll("x-grouser, iframe, object, embed, form, base").length);
    await live.context.close();
    console.log(JSON.stringify(told));
  }
  await browser.close();
})().catch(error => { console.error(String(error)); process.exit(1); });
