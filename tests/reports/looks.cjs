// What can be computed of a page's legibility and structure. Each function returns a line for each thing that is wrong.

// Contrast of every visible text with what lies behind it, WCAG 2.1 criterion 1.4.3 (AA): 4.5, of large text 3; of what is
// drawn (curves, 1.4.11) 3.
exports.contrast = (page, scheme) => page.evaluate(scheme => {
  const rgba = text => {
    const probe = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    probe.fillStyle = text;
    probe.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = probe.getImageData(0, 0, 1, 1).data;
    return [r, g, b, a / 255];
  };
  const linear = v => v / 255 <= 0.03928 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4;
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const ratio = (a, b) => { const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y); return (high + 0.05) / (low + 0.05); };
  const behind = element => {
    for (let e = element; e; e = e.parentElement) {
      const color = rgba(getComputedStyle(e).backgroundColor);
      if (color[3] === 1) return color;
    }
    return [255, 255, 255, 1];
  };
  const wrong = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), seen = new Set();
  let count = 0;
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const element = node.parentElement;
    if (!node.data.trim() || seen.has(element) || element.closest("script, style, noscript, .stage, .skip")) continue;
    seen.add(element);
    if (element.getClientRects().length === 0) continue;
    const style = getComputedStyle(element), size = parseFloat(style.fontSize), bold = Number(style.fontWeight) >= 700;
    const found = ratio(rgba(element.closest("svg") ? style.fill : style.color), behind(element));
    const needed = size >= 24 || bold && size >= 18.66 ? 3 : 4.5;
    ++count;
    if (found < needed) wrong.push(`${scheme}: contrast ${found.toFixed(2)} of “${node.data.trim().slice(0, 40)}”`);
  }
  if (count < 30) wrong.push(`${scheme}: only ${count} texts were looked at`);
  const root = getComputedStyle(document.documentElement), card = rgba(root.getPropertyValue("--card"));
  const drawn = (name, needed) => {
    const found = ratio(rgba(root.getPropertyValue(name)), card);
    if (found < needed) wrong.push(`${scheme}: contrast ${found.toFixed(2)} of ${name} on a card`);
  };
  for (let i = 1; i <= 8; ++i) drawn("--s" + i, 3);
  for (const name of ["--soft", "--note", "--plot-ink", "--plot-muted", "--plot-mark"]) drawn(name, 4.5);
  return wrong;
}, scheme);

// One h1, no level left out, a name for everything that is operated or seen, and a way past the contents.
exports.structure = page => page.evaluate(() => {
  const wrong = [];
  const levels = [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")].map(h => Number(h.tagName[1]));
  if (levels.filter(level => level === 1).length !== 1) wrong.push("not one h1");
  levels.forEach((level, i) => { if (i > 0 && level > levels[i - 1] + 1) wrong.push(`h${level} after h${levels[i - 1]}`); });
  for (const image of document.querySelectorAll("img")) if (!image.closest("a[aria-hidden]") && !image.alt.trim()) wrong.push("a picture without a text");
  for (const svg of document.querySelectorAll("svg.figure")) if (!svg.getAttribute("aria-label")) wrong.push("a drawing without a text");
  for (const e of document.querySelectorAll("button, input, select, a, video, [tabindex]:not([tabindex='-1'])")) {
    const named = e.getAttribute("aria-label") || e.textContent.trim() || e.closest("label")?.textContent.trim();
    if (!named) wrong.push(`${e.tagName.toLowerCase()}.${e.className} has no name`);
  }
  const link = document.querySelector("a");
  if (!link || !document.querySelector(link.hash || "#none")) wrong.push("the first link does not lead past the contents");
  for (const name of ["lang"]) if (!document.documentElement.getAttribute(name)) wrong.push("the page has no " + name);
  return wrong;
});
