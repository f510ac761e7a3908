// Replays episodes: decodes them, keeps one clock, answers the keyboard.

const KINDS = { int8: Int8Array, uint8: Uint8Array, uint16: Uint16Array, int32: Int32Array, float32: Float32Array };
const LAYERS = { explored: "explored cells", seen: "sensed obstacles", plans: "paths", driven: "driven",
  candidates: "candidates", movers: "moving obstacles, truly", tracks: "tracked, and in 1 and 2 s",
  follow: "follow the robot" };

function unpacked({ kind, data }) {
  const text = atob(data), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new KINDS[kind](bytes.buffer);
}

async function episodes() {
  const packed = unpacked({ kind: "uint8", data: document.getElementById("data").textContent.trim() });
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return JSON.parse(await new Response(stream).text());
}

function words({ table, rows }) {
  const places = unpacked(rows);
  return (tick) => (places.length ? table[places[Math.min(tick, places.length - 1)]] : "");
}

function offsets(rows) {
  const ends = new Int32Array(rows.length + 1);
  for (let i = 0; i < rows.length; i++) ends[i + 1] = ends[i] + rows[i];
  return ends;
}

// An episode that gives the frame of any time.
class Replay {
  constructor(data) {
    this.data = data;
    for (const name of ["times", "poses", "twists", "commands", "clearance", "movers"]) this[name] = unpacked(data[name]);
    this.end = this.times[this.times.length - 1] || 0;
    this.state = words(data.states);
    this.limit = words(data.limits);
    this.plans = data.plans.map((plan) => ({ ...plan, points: unpacked(plan.points), explored: unpacked(plan.explored) }));
    const grid = { ...data.grid, values: unpacked(data.grid.values) };
    if (grid.keepout) grid.keepout = unpacked(grid.keepout);
    this.scene = { grid, map: mapCells(grid, colours()), radius: data.radius, footprint: data.footprint,
      goals: data.goals, tolerance: data.tolerance, obstacles: data.obstacles };
    this.trail = new Float32Array(2 * this.times.length);
    for (let i = 0; i < this.times.length; i++) this.trail.set([this.poses[3 * i], this.poses[3 * i + 1]], 2 * i);
    if (data.trace) this.readTrace(data.trace);
    this.exploredOf = -1;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.scene.map = mapCells(grid, colours());
      this.exploredOf = -1;
      this.seenTo = Infinity;
    });
  }

  readTrace(trace) {
    for (const name of ["candidates", "refused", "terms", "chosen", "tracks", "seen"]) this[name] = unpacked(trace[name]);
    this.candidateEnds = offsets(unpacked(trace.candidateRows));
    this.trackEnds = offsets(unpacked(trace.trackRows));
    this.reason = words(trace.reasons);
    this.traced = this.candidateEnds.length - 1;
    this.seenCells = this.cellsOf(trace.seenFrame);
    this.seenTo = 0;
    this.seenTick = -1;
  }

  // Empty cells over the map in a frame whose cells may be smaller than the map's.
  cellsOf(frame) {
    const { rows, columns } = this.data.grid, factor = this.data.grid.frame[0] / frame[0];
    return new Cells(Math.round(rows * factor), Math.round(columns * factor), frame);
  }

  tickAt(time) {
    let low = 0, high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time + 1e-4) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  planAt(time) {
    let found = -1;
    while (found + 1 < this.plans.length && this.plans[found + 1].time <= time + 1e-4) found++;
    return found;
  }

  // Cells that were sensed as blocked up to a tick; forwards only what is new is drawn.
  seenAt(tick) {
    if (!this.seenCells) return null;
    if (tick < this.seenTick || this.seenTo === Infinity) {
      this.seenCells.clear();
      this.seenTo = 0;
    }
    this.seenTick = tick;
    const colour = colours().seen;
    for (; 4 * this.seenTo < this.seen.length && this.seen[4 * this.seenTo] <= tick; this.seenTo++) {
      const [, row, column, blocked] = this.seen.subarray(4 * this.seenTo, 4 * this.seenTo + 4);
      if (blocked) this.seenCells.run(row, column, 1, colour);
      else this.seenCells.context.clearRect(column, row, 1, 1);
    }
    return this.seenCells;
  }

  exploredAt(plan) {
    if (plan < 0 || !this.plans[plan].explored.length) return null;
    if (plan !== this.exploredOf) {
      const cells = this.cellsOf(this.data.exploredFrame);
      const runs = this.plans[plan].explored, colour = colours().explored;
      for (let i = 0; i < runs.length; i += 3) cells.run(runs[i], runs[i + 1], runs[i + 2], colour);
      this.exploredOf = plan;
      this.exploredCells = cells;
    }
    return this.exploredCells;
  }

  frame(time) {
    const tick = this.tickAt(time), plan = this.planAt(time), next = Math.min(tick + 1, this.times.length - 1);
    const span = this.times[next] - this.times[tick];
    const part = span > 0 ? Math.min(Math.max((time - this.times[tick]) / span, 0), 1) : 0;
    const at = (values, width, column) => {
      const a = values[width * tick + column], b = values[width * next + column];
      return Number.isFinite(b) ? a + part * (b - a) : a;
    };
    let turn = this.poses[3 * next + 2] - this.poses[3 * tick + 2];
    turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
    const count = this.data.moverRadii.length, movers = [];
    for (let i = 0; i < count; i++) {
      const [x, y] = [at(this.movers, 2 * count, 2 * i), at(this.movers, 2 * count, 2 * i + 1)];
      if (Number.isFinite(x)) movers.push([x, y, this.data.moverRadii[i]]);
    }
    const traced = this.seenCells ? Math.min(tick, this.traced - 1) : -1, candidates = [], tracks = [];
    if (traced >= 0) {
      for (let i = this.candidateEnds[traced]; i < this.candidateEnds[traced + 1]; i++) {
        candidates.push({ v: this.candidates[3 * i], omega: this.candidates[3 * i + 1],
          score: this.candidates[3 * i + 2], refused: this.refused[i] });
      }
      for (let i = this.trackEnds[traced]; i < this.trackEnds[traced + 1]; i++) {
        tracks.push(Array.from(this.tracks.subarray(5 * i, 5 * i + 5)));
      }
    }
    const chosen = traced >= 0 ? Array.from(this.chosen.subarray(3 * traced, 3 * traced + 3)) : [];
    return {
      tick, movers, candidates, tracks,
      pose: [at(this.poses, 3, 0), at(this.poses, 3, 1), this.poses[3 * tick + 2] + part * turn],
      twist: [this.twists[2 * tick], this.twists[2 * tick + 1]],
      clearance: this.clearance[tick], state: this.state(tick), limit: this.limit(tick),
      reason: traced >= 0 ? this.reason(traced) : "",
      chosen: Number.isFinite(chosen[0]) ? chosen : null,
      path: plan >= 0 ? this.plans[plan].points : null, planReason: plan >= 0 ? this.plans[plan].reason : "",
      oldPaths: this.plans.slice(0, Math.max(plan, 0)).map((one) => one.points),
      explored: this.exploredAt(plan), seen: this.seenAt(tick),
      trail: this.trail, trailCount: tick + 1,
      contact: this.data.outcome === "contact" && tick === this.times.length - 1,
    };
  }
}

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

// Everything that is shown of one episode.
class Panel {
  constructor(replay, end, seek) {
    this.replay = replay;
    const { data } = replay;
    this.map = element("canvas", { className: "map", role: "img", ariaLabel: `Map of ${data.name}` });
    this.window = element("canvas", { className: "window", role: "img", ariaLabel: "Candidates by v and omega" });
    this.words = element("div", { className: "words" });
    this.numbers = element("dl", { className: "numbers" });
    const hint = element("p", { className: "hint" });
    this.log = element("ol", { className: "log", ariaLabel: "Events" });
    const charts = element("div", { className: "charts" });
    const preset = data.preset ? `, preset ${data.preset}` : "";
    this.root = element("section", { className: "view" },
      element("h1", {}, `${data.name} `, element("small", {}, `${data.robot}${preset}: ${data.outcome}, ${data.reason}`)),
      element("div", { className: "parts" }, this.map,
        element("div", { className: "side" }, this.words, this.numbers, this.window, hint)),
      charts, this.log);
    document.getElementById("views").append(this.root);
    this.view = new View(this.map, boxOf(replay.scene.grid), () => this.draw(this.now || 0));
    this.candidates = new WindowChart(this.window, hint, data.refusals);
    this.charts = this.makeCharts(charts, end, seek);
    this.entries = data.events.map(([time, kind, detail]) => [time, `${kind}: ${detail}`])
      .concat(replay.plans.map((plan) => [plan.time, `path: ${plan.reason}`])).sort((a, b) => a[0] - b[0]);
    this.items = this.entries.map(([time, text]) => {
      const button = element("button", { type: "button" }, `${time.toFixed(1)} s  ${text}`);
      button.addEventListener("click", () => seek(time));
      this.log.append(element("li", {}, button));
      return button;
    });
  }

  makeCharts(place, end, seek) {
    const { replay } = this, column = (values, width, index) => values.filter((_, i) => i % width === index);
    const plots = [
      ["v, driven and commanded, m/s", [["old", column(replay.commands, 2, 0)], ["driven", column(replay.twists, 2, 0)]]],
      ["omega, driven and commanded, rad/s", [["old", column(replay.commands, 2, 1)], ["driven", column(replay.twists, 2, 1)]]],
      ["clearance, m", [["plan", replay.clearance]]],
    ];
    if (replay.terms) {
      const shades = ["plan", "occupied", "driven", "seen", "contact"];
      const named = replay.data.termNames.map((name, i) => [shades[i], column(replay.terms, 5, i), name]);
      plots.push([`terms of Eq. 9 of the choice`, named]);
    }
    return plots.map(([title, lines]) => {
      const canvas = element("canvas", { className: "chart", role: "img", ariaLabel: title });
      const caption = element("figcaption", {}, title);
      for (const [colour, , name] of lines) {
        if (name) caption.append(" ", element("span", { style: `color: var(--${colour})` }, name));
      }
      place.append(element("figure", {}, caption, canvas));
      const to = (event) => { if (event.buttons) seek(end * event.offsetX / canvas.clientWidth); };
      canvas.addEventListener("pointerdown", to);
      canvas.addEventListener("pointermove", to);
      return new Chart(canvas, replay.times, lines.map(([colour, values]) => ({ colour, values })), end);
    });
  }

  draw(time) {
    this.now = time;
    const frame = this.replay.frame(time);
    drawScene(this.view, this.replay.scene, frame, layers);
    this.candidates.draw(frame);
    for (const chart of this.charts || []) chart.draw(Math.min(time, this.replay.end));
    this.words.replaceChildren(element("b", {}, frame.state), frame.reason);
    const rows = [["v", number(frame.twist[0], 2, "m/s")], ["omega", number(frame.twist[1], 2, "rad/s")],
      ["clearance", number(frame.clearance, 2, "m")], ["limited by", frame.limit || "-"], ["path", frame.planReason || "-"]];
    this.numbers.replaceChildren(...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
    let last = -1;
    (this.entries || []).forEach(([at], i) => { if (at <= time + 1e-4) last = i; });
    if (last !== this.last && this.items) {
      this.items.forEach((item, i) => item.classList.toggle("now", i === last));
      if (last >= 0) this.log.scrollTop = this.items[last].offsetTop - this.log.offsetTop - 40;
      this.last = last;
    }
  }
}

const layers = {};

async function start() {
  const replays = (await episodes()).map((data) => new Replay(data));
  const end = Math.max(...replays.map((one) => one.end), 0.1);
  const slider = document.getElementById("time"), clock = document.getElementById("clock");
  const play = document.getElementById("play"), speed = document.getElementById("speed");
  let now = 0, running = false, last = 0, panels = [];
  const show = () => {
    slider.value = now;
    clock.textContent = `${now.toFixed(1)} of ${end.toFixed(1)} s`;
    for (const panel of panels) panel.draw(now);
  };
  const seek = (time) => { now = Math.min(Math.max(time, 0), end); show(); };
  const run = (on) => {
    running = on;
    play.textContent = on ? "Pause" : "Play";
    if (on && now >= end) now = 0;
    last = 0;
    if (on) requestAnimationFrame(step);
  };
  const step = (stamp) => {
    if (!running) return;
    if (last) now = Math.min(now + (stamp - last) / 1000 * Number(speed.value), end);
    last = stamp;
    show();
    if (now >= end) run(false);
    else requestAnimationFrame(step);
  };
  for (const [name, title] of Object.entries(LAYERS)) {
    layers[name] = name !== "follow";
    const box = element("input", { type: "checkbox", checked: layers[name] });
    box.addEventListener("change", () => { layers[name] = box.checked; show(); });
    document.getElementById("layers").append(element("label", {}, box, ` ${title}`));
  }
  slider.max = end;
  panels = replays.map((one) => new Panel(one, end, seek));
  slider.addEventListener("input", () => seek(Number(slider.value)));
  play.addEventListener("click", () => run(!running));
  document.addEventListener("keydown", (event) => {
    if (event.target.matches("select") || event.ctrlKey || event.altKey || event.metaKey) return;
    const times = replays[0].times, tick = replays[0].tickAt(now);
    const actions = { " ": () => run(!running), Home: () => seek(0), End: () => seek(end),
      ArrowRight: () => seek(times[Math.min(tick + 1, times.length - 1)]),
      ArrowLeft: () => seek(times[Math.max(tick - 1, 0)]) };
    if (!(event.key in actions) || (event.key === " " && event.target.matches("button, input"))) return;
    event.preventDefault();
    actions[event.key]();
  });
  window.dynastar = { seek, end, time: () => now, frame: () => replays[0].frame(now) };
  show();
}

start();
