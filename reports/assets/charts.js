"use strict";
// Interactive charts over uPlot. Each .chart element names a JSON description and a packed table of Float32 values beside it.
const grouserCharts = (() => {
  const all = [];
  let spreading = false;

  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const palette = ["--s1", "--s2", "--s3", "--s4", "--s5", "--s6", "--s7", "--s8"];
  const colorOf = (series, i) => series.color || css(palette[(series.hue ?? i) % palette.length]);
  const translucent = color => color.startsWith("#") ? color + "40" : color.replace("rgb(", "rgba(").replace(")", ",0.25)");
  const unitOf = label => (/\[([^\]]*)\]\s*$/.exec(label) || ["", ""])[1];
  const number = (v, digits) => {
    if (v == null || Number.isNaN(v)) return "–";
    const size = Math.abs(v);
    const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? v.toExponential(2)
      : v.toFixed(Math.max(0, Math.min(6, digits - 1 - Math.floor(Math.log10(Math.max(size, 10 ** (digits - 5)))))));
    return text.replace("-", "\u2212");
  };
  const tick = v => v == null ? "" : (Math.abs(v) >= 1e5 || (v !== 0 && Math.abs(v) < 1e-3) ? v.toExponential(0) : String(+v.toPrecision(6))).replace("-", "\u2212");

  // Columns of a panel in uPlot's form: one sorted x, gaps as null. A map's cells come first; of them uPlot sees only the columns' middles.
  function columns(panel, values, offset) {
    if (panel.map) {
      const { columns: count, rows, x_span } = panel.map;
      panel.map.cells = values.subarray(offset, offset + count * rows);
      const x = Array.from({ length: count }, (_, k) => x_span[0] + (k + 0.5) * (x_span[1] - x_span[0]) / count);
      return { data: [x, x.map(() => null)], offset: offset + count * rows };
    }
    const tables = [], order = [];
    for (const table of panel.tables) {
      const read = () => { const part = values.subarray(offset, offset + table.rows); offset += table.rows; return part; };
      const x = Array.from(read());
      const curves = table.series.map(() => Array.from(read(), v => Number.isNaN(v) || (panel.log_y && v <= 0) ? null : v));
      tables.push([x, ...curves]);
      order.push(...table.series);
    }
    const joined = tables.length === 1 ? tables[0] : uPlot.join(tables);
    const data = [joined[0]];
    order.forEach((series, k) => { data[series + 1] = joined[k + 1]; });
    return { data, offset };
  }

  function valueAt(u, series, index) {
    const curve = u.data[series];
    for (let reach = 0; reach < 40; ++reach) {
      if (curve[index - reach] != null) return curve[index - reach];
      if (curve[index + reach] != null) return curve[index + reach];
    }
    return null;
  }

  function drawMarks(u, panel) {
    const c = u.ctx, box = u.bbox, ratio = devicePixelRatio;
    c.save();
    c.beginPath(); c.rect(box.left, box.top, box.width, box.height); c.clip();
    c.strokeStyle = c.fillStyle = css("--note");
    c.textAlign = "left"; c.lineWidth = ratio; c.setLineDash([4 * ratio, 3 * ratio]);
    c.font = `${11.5 * ratio}px ${getComputedStyle(document.body).fontFamily}`;
    for (const mark of panel.marks) {
      const at = Math.round(u.valToPos(mark.at, mark.vertical ? "x" : "y", true)) + 0.5;
      c.beginPath();
      if (mark.vertical) { c.moveTo(at, box.top); c.lineTo(at, box.top + box.height); }
      else { c.moveTo(box.left, at); c.lineTo(box.left + box.width, at); }
      c.stroke();
      const wide = c.measureText(mark.label).width, right = at + 6 * ratio + wide < box.left + box.width;
      if (mark.vertical) { c.textBaseline = "top"; c.fillText(mark.label, right ? at + 6 * ratio : at - 6 * ratio - wide, box.top + 5 * ratio); }
      else { c.textBaseline = "bottom"; c.fillText(mark.label, box.left + box.width - wide - 6 * ratio, at - 3 * ratio); }
    }
    c.restore();
  }

  // Colour of a share 0..1 of the map's range, straight lines in sRGB between the given colours.
  function mapPicture(map) {
    const stops = map.colors.map(text => text.match(/\d+/g).map(Number)), [low, high] = map.range;
    const picture = document.createElement("canvas");
    picture.width = map.columns; picture.height = map.rows;
    const context = picture.getContext("2d"), image = context.createImageData(map.columns, map.rows);
    for (let row = 0; row < map.rows; ++row)
      for (let column = 0; column < map.columns; ++column) {
        const value = map.cells[row * map.columns + column];
        if (Number.isNaN(value)) continue;
        const share = Math.max(0, Math.min(1, (value - low) / (high - low))) * (stops.length - 1);
        const k = Math.min(stops.length - 2, Math.floor(share)), at = 4 * ((map.rows - 1 - row) * map.columns + column);
        for (let c = 0; c < 3; ++c) image.data[at + c] = stops[k][c] + (share - k) * (stops[k + 1][c] - stops[k][c]);
        image.data[at + 3] = 255;
      }
    context.putImageData(image, 0, 0);
    return picture;
  }

  function drawMap(u, map) {
    map.picture ??= mapPicture(map);
    const c = u.ctx, box = u.bbox, left = u.valToPos(map.x_span[0], "x", true), right = u.valToPos(map.x_span[1], "x", true);
    const bottom = u.valToPos(map.y_span[0], "y", true), top = u.valToPos(map.y_span[1], "y", true);
    c.save();
    c.beginPath(); c.rect(box.left, box.top, box.width, box.height); c.clip();
    c.imageSmoothingEnabled = false;
    c.drawImage(map.picture, left, top, right - left, bottom - top);
    c.restore();
  }

  // What the cursor reads: the cell under it, or of a column that another chart points at the largest cell.
  function readMap(u, map, name) {
    const column = u.cursor.idx;
    if (column == null) return "";
    const unit = unitOf(map.label), text = v => number(v, 4) + (unit ? " " + unit : "");
    if (u.cursor.top < 0) {
      let largest = -Infinity;
      for (let row = 0; row < map.rows; ++row) largest = Math.max(largest, map.cells[row * map.columns + column]);
      return "largest " + text(largest);
    }
    const step = (map.y_span[1] - map.y_span[0]) / map.rows;
    const row = Math.max(0, Math.min(map.rows - 1, Math.floor((u.posToVal(u.cursor.top, "y") - map.y_span[0]) / step)));
    return `${text(map.cells[row * map.columns + column])} at ${name.toLowerCase()} ${tick(map.y_span[0] + (row + 0.5) * step)}`;
  }

  function mapKey(map) {
    const key = document.createElement("span"), bar = document.createElement("i"), unit = unitOf(map.label);
    key.className = "color-bar";
    bar.style.background = `linear-gradient(90deg, ${map.colors.join(", ")})`;
    key.append(map.label.replace(/\s*\[.*$/, "") + " " + number(map.range[0], 3), bar, number(map.range[1], 3) + " " + unit);
    return key;
  }

  // A constant still needs a height to stand in.
  const paddedRange = (u, low, high) => low == null || (low === 0 && high === 0) ? [0, 1] : low === high ? [low - Math.max(1, Math.abs(low)) * 0.5, high + Math.max(1, Math.abs(high)) * 0.5]
    : uPlot.rangeNum(low, high, 0.08, true);

  // The range that the figure asks for where all is shown, a zoom as it is.
  const wholeRange = range => (u, low, high) => {
    const x = u.data[0];
    return low === x[0] && high === x[x.length - 1] ? range : [low, high];
  };

  // Zoom of one chart over time is the zoom of all of its run; other runs last longer or shorter.
  function spread(u) {
    if (spreading) return;
    spreading = true;
    const { min, max } = u.scales.x, part = all.find(chart => chart.u === u)?.part;
    for (const other of all) if (other.u !== u && other.linked && other.part === part) other.u.setScale("x", { min, max });
    spreading = false;
  }

  function placeNow(chart) {
    const { u, now } = chart;
    if (!chart.linked || chart.time == null) return;
    const x = u.valToPos(chart.time, "x");
    now.style.display = x >= 0 && x <= u.over.clientWidth ? "block" : "none";
    now.style.left = x + "px";
  }

  function head(panel, chart) {
    const top = document.createElement("div");
    top.className = "panel-head";
    const name = document.createElement("span");
    name.className = "name";
    name.textContent = [panel.title, panel.y_label].filter(Boolean).join(" · ");
    const keys = document.createElement("span");
    keys.className = "keys";
    if (panel.map) {
      chart.reading = document.createElement("output");
      keys.append(chart.reading, mapKey(panel.map));
    }
    chart.keys = panel.series.map((series, i) => {
      const key = document.createElement("button");
      key.type = "button";
      const alone = panel.series.length === 1 && panel.title;  // the panel's title names it already
      key.className = alone ? "alone" : series.style === "dashed" ? "dashed" : "";
      key.setAttribute("aria-pressed", "true");
      key.setAttribute("aria-label", series.name || panel.title || panel.y_label);
      key.append(alone ? "" : series.name + " ", document.createElement("b"));
      key.onclick = () => {
        const shown = !chart.u.series[i + 1].show;
        chart.u.setSeries(i + 1, { show: shown });
        key.setAttribute("aria-pressed", shown);
      };
      keys.append(key);
      return key;
    });
    top.append(name, keys);
    return top;
  }

  function colorKeys(chart) {
    chart.keys.forEach((key, i) => key.style.setProperty("--key", colorOf(chart.panel.series[i], i)));
  }

  function options(panel, chart, last, width, height, label) {
    const unit = unitOf(panel.y_label);
    const font = "12px " + getComputedStyle(document.body).fontFamily;
    const axis = extra => ({ stroke: () => css("--soft"), font, labelFont: font, grid: { stroke: () => css("--line"), width: 1 },
      ticks: { show: false }, gap: 6, values: (u, splits) => splits.map(tick), ...extra });
    const dash = { dashed: [6, 4] };
    return {
      width, height, pxAlign: 0, legend: { show: false }, padding: [8, 12, 0, 0],
      scales: {
        x: { time: false, distr: panel.log_x ? 3 : 1, ...(panel.x_range ? { range: wholeRange(panel.x_range) } : {}) },
        y: { distr: panel.log_y ? 3 : 1, ...(panel.map ? { range: panel.map.y_span } : panel.y_range ? { range: panel.y_range } : panel.log_y ? {} : { range: paddedRange }) },
      },
      axes: [axis(last ? { label, labelSize: 22, size: 26 } : { size: 10, values: (u, splits) => splits.map(() => "") }), axis({ size: 58 })],
      cursor: { drag: { x: true, y: false, dist: 4 }, points: { size: 7 }, focus: { prox: -1 },
        ...(chart.linked ? { sync: { key: "time " + chart.part, setSeries: false } } : {}) },
      series: [{}, ...panel.series.map((series, i) => ({
        label: series.name, stroke: () => colorOf(series, i), width: series.style === "points" ? 0 : Math.max(1, series.width * 0.9),
        ...(series.style === "bars" ? { paths: uPlot.paths.bars({ size: [1, Infinity] }), fill: () => translucent(colorOf(series, i)) } : {}),
        dash: dash[series.style], spanGaps: true, points: { show: series.style === "points" },
        ...(series.style === "steps" ? { paths: uPlot.paths.stepped({ align: 1 }) } : {}),
      })), ...(panel.map ? [{ points: { show: false } }] : [])],
      hooks: {
        draw: [u => { if (panel.map) drawMap(u, panel.map); drawMarks(u, panel); }],
        setScale: [(u, key) => { if (key === "x" && chart.u) { if (chart.linked) spread(u); placeNow(chart); } }],
        setCursor: [u => {
          const index = u.cursor.idx;
          panel.series.forEach((series, i) => {
            chart.keys[i].lastChild.textContent = index == null ? "" : number(valueAt(u, i + 1, index), 4) + (unit ? " " + unit : "");
          });
          if (panel.map) chart.reading.textContent = readMap(u, panel.map, panel.y_label);
        }],
      },
    };
  }

  function seekOnClick(chart, id) {
    let from = null;
    chart.u.over.addEventListener("mousedown", e => { from = e.clientX; });
    chart.u.over.addEventListener("click", e => {
      if (from == null || Math.abs(e.clientX - from) > 3) return;
      const time = chart.u.posToVal(e.clientX - chart.u.over.getBoundingClientRect().left, "x");
      seek(id, time);
    });
  }

  // With the keyboard: arrows move the cursor, + and - zoom about it, 0 or escape shows all, enter asks the player for that time.
  function steer(chart, id) {
    const { u } = chart;
    const zoom = factor => {
      const at = u.cursor.left >= 0 ? u.posToVal(u.cursor.left, "x") : (u.scales.x.min + u.scales.x.max) / 2;
      u.setScale("x", { min: at - (at - u.scales.x.min) * factor, max: at + (u.scales.x.max - at) * factor });
    };
    const move = share => {
      const width = u.over.clientWidth, from = u.cursor.left >= 0 ? u.cursor.left : width / 2;
      u.setCursor({ left: Math.max(0, Math.min(width, from + share * width)), top: u.over.clientHeight / 2 });
    };
    const x = u.data[0];
    const actions = {
      ArrowLeft: e => move(e.shiftKey ? -0.1 : -0.01), ArrowRight: e => move(e.shiftKey ? 0.1 : 0.01), Home: () => move(-1), End: () => move(1),
      "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2),
      0: () => u.setScale("x", { min: x[0], max: x[x.length - 1] }), Escape: () => u.setScale("x", { min: x[0], max: x[x.length - 1] }),
      Enter: () => { if (chart.linked && u.cursor.left >= 0) seek(id, u.posToVal(u.cursor.left, "x")); },
    };
    chart.place.addEventListener("keydown", e => {
      if (!actions[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
      actions[e.key](e);
      e.preventDefault();
    });
  }

  const seek = (id, time) => document.dispatchEvent(new CustomEvent("grouser-seek", { detail: { part: id.split("-")[0], time } }));

  async function build(element) {
    const id = element.dataset.chart;
    const spec = JSON.parse(document.querySelector(`[data-spec="${id}"]`).textContent);
    const values = new Float32Array(await unpacked(document.querySelector(`[data-values="${id}"]`).textContent));
    const heights = [0, 280, 205, 160], height = heights[Math.min(3, spec.panels.length)];
    let offset = 0;
    spec.panels.forEach((panel, k) => {
      const last = k === spec.panels.length - 1;
      const table = columns(panel, values, offset);
      offset = table.offset;
      const chart = { panel, figure: id, index: k, linked: panel.over_time, part: id.split("-")[0], time: null };
      const box = document.createElement("div");
      box.className = "panel";
      const place = document.createElement("div");
      place.setAttribute("role", "group");
      place.setAttribute("aria-roledescription", "chart");
      place.tabIndex = 0;
      chart.place = place;
      place.setAttribute("aria-label", k === 0 ? element.dataset.alt : panel.title || panel.y_label);
      box.append(head(panel, chart), place);
      element.append(box);
      const label = spec.panels[spec.panels.length - 1].x_label;
      const size = () => [place.clientWidth || 600, height + (last ? 22 : 0)];
      chart.u = new uPlot(options(panel, chart, last, ...size(), label), table.data, place);
      chart.now = document.createElement("div");
      chart.now.className = "now";
      chart.u.over.append(chart.now);
      colorKeys(chart);
      if (chart.linked) seekOnClick(chart, id);
      steer(chart, id);
      new ResizeObserver(() => { const [w, h] = size(); if (w !== chart.u.width) { chart.u.setSize({ width: w, height: h }); placeNow(chart); } }).observe(place);
      all.push(chart);
    });
  }

  async function start() {
    for (const element of document.querySelectorAll(".chart[data-chart]")) await build(element);
    const first = document.querySelector(".chart[data-chart]");
    if (first) {
      const help = document.createElement("p");
      help.className = "chart-help";
      help.textContent = "Drag to zoom, double-click to see all again; charts of a run over time zoom together and share the cursor. Click a name to hide its curve. Keyboard: arrows move the cursor, + and − zoom, 0 shows all, Enter shows that time in the 3D playback.";
      first.append(help);
    }
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => all.forEach(chart => { colorKeys(chart); chart.u.redraw(); }));
    document.addEventListener("grouser-time", e => {
      for (const chart of all) if (chart.linked && chart.part === e.detail.part) { chart.time = e.detail.time; placeNow(chart); }
    });
    return all.length;
  }

  return { start, all };
})();
