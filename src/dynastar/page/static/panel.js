// What is shown of one robot beside its map: state, numbers, the window, lines over time, events.

const TERM_SHADES = ["plan", "occupied", "robot", "seen", "contact", "faint"];

function element(kind, attributes = {}, ...children) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(attributes)) {
    if (name in made && name !== "list") made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

const number = (value, digits, unit) => (Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}` : "-");

// Cells over a grid's extent in a frame whose cells may be smaller than the grid's.
function cellsOver(grid, frame) {
  const factor = grid.frame[0] / frame[0];
  return new Cells(Math.round(grid.rows * factor), Math.round(grid.columns * factor), frame);
}

function drawRuns(cells, runs, colour) {
  for (let i = 0; i < runs.length; i += 3) cells.run(runs[i], runs[i + 1], runs[i + 2], colour);
}

// All that is shown of one robot. A source has a name and what is said beside it, the scene, a frame for each
// time, refusals in words, recorded (true if it has candidates), lines of numbers over its times with the span
// that is shown, and entries of a log. Where seek is given, charts and log lead to their times.
class Panel {
  constructor(source, { seek = null, tool = null } = {}) {
    this.source = source;
    this.seek = seek;
    this.map = element("canvas", { className: "map", role: "img", ariaLabel: `Map of ${source.name}` });
    this.window = element("canvas", { className: "window", role: "img", ariaLabel: "Candidates by v and omega" });
    this.words = element("div", { className: "words" });
    this.numbers = element("dl", { className: "numbers" });
    const hint = element("p", { className: "hint" });
    this.log = element("ol", { className: "log", ariaLabel: "Events", tabIndex: 0 });
    const charts = this.chartsPlace = element("div", { className: "charts" });
    this.root = element("section", { className: "view" },
      element("h1", {}, `${source.name} `, element("small", {}, source.about)),
      element("div", { className: "parts" }, this.map,
        element("div", { className: "side" }, this.words, this.numbers, this.window, hint)),
      charts, this.log);
    document.getElementById("views").append(this.root);
    this.view = new View(this.map, boxOf(source.scene.grid), () => this.draw(this.now || 0), tool);
    this.candidates = new WindowChart(this.window, hint, source.refusals, source.recorded);
    this.charts = source.plots().map((plot) => this.makeChart(charts, plot));
    this.times = [];
    this.items = [];
    for (const [time, text] of source.entries) this.addEntry(time, text);
  }

  // Takes a part of the page in below the map.
  hold(part) { this.root.insertBefore(part, this.chartsPlace); }

  addEntry(time, text) {
    const words = `${time.toFixed(1)} s  ${text}`;
    const item = this.seek ? element("button", { type: "button" }, words) : element("span", {}, words);
    if (this.seek) item.addEventListener("click", () => this.seek(time));
    this.log.append(element("li", {}, item));
    this.times.push(time);
    this.items.push(item);
  }

  makeChart(place, [title, lines]) {
    const { source, seek } = this, canvas = element("canvas", { className: "chart", role: "img", ariaLabel: title });
    const caption = element("figcaption", {}, title);
    for (const [colour, , name] of lines) {
      if (name) caption.append(" ", element("span", { style: `color: var(--${colour})` }, name));
    }
    place.append(element("figure", {}, caption, canvas));
    const series = lines.map(([colour, values]) => ({ colour, values }));
    const chart = new Chart(canvas, source.times, series, source.span);
    if (seek) {
      const to = (event) => { if (event.buttons) seek(chart.end * event.offsetX / canvas.clientWidth); };
      canvas.addEventListener("pointerdown", to);
      canvas.addEventListener("pointermove", to);
    }
    return chart;
  }

  draw(time) {
    this.now = time;
    const frame = this.source.frame(time);
    if (!frame) return;
    drawScene(this.view, this.source.scene, frame, layers);
    if (this.source.overlay) this.source.overlay(this.view);
    this.candidates.draw(frame);
    for (const chart of this.charts || []) {
      Object.assign(chart, this.source.span);
      chart.draw(Math.min(time, this.source.end));
    }
    this.words.replaceChildren(element("b", {}, frame.state), frame.reason);
    const rows = [["speed", number(frame.twist[0], 2, "m/s")], ["turning rate", number(frame.twist[1], 2, "rad/s")],
      ["clearance", number(frame.clearance, 2, "m")], ["limited by", frame.limit || "-"], ["path", frame.planReason || "-"]];
    this.numbers.replaceChildren(...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
    this.mark(time);
  }

  // Marks the last entry of the log that has happened.
  mark(time) {
    let last = -1;
    (this.times || []).forEach((at, i) => { if (at <= time + 1e-4) last = i; });
    if (!this.items || last === this.last) return;
    this.items.forEach((item, i) => item.classList.toggle("now", i === last));
    if (last >= 0) this.log.scrollTop = this.items[last].offsetTop - this.log.offsetTop - 40;
    this.last = last;
  }
}
