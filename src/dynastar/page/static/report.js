// Replays episodes: decodes them, keeps one clock, answers the keyboard.

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

// An episode that gives the frame of any time, as a Panel's source.
class Replay {
  constructor(data) {
    this.data = data;
    this.name = data.name;
    this.about = `${data.robot}${data.preset ? `, preset ${data.preset}` : ""}: ${data.outcome}, ${data.reason}`;
    this.refusals = data.refusals;
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
    this.recorded = Boolean(data.trace);
    if (this.recorded) this.readTrace(data.trace);
    this.entries = data.events.map(([time, kind, detail]) => [time, `${kind}: ${detail}`])
      .concat(this.plans.map((plan) => [plan.time, `path: ${plan.reason}`])).sort((a, b) => a[0] - b[0]);
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
    this.seenCells = cellsOver(this.data.grid, trace.seenFrame);
    this.seenTo = 0;
    this.seenTick = -1;
  }

  plots() {
    const column = (values, width, index) => values.filter((_, i) => i % width === index);
    const plots = [
      ["speed v, m/s:", [["plan", column(this.commands, 2, 0), "commanded"], ["driven", column(this.twists, 2, 0), "driven"]]],
      ["turning rate omega, rad/s:",
        [["plan", column(this.commands, 2, 1), "commanded"], ["driven", column(this.twists, 2, 1), "driven"]]],
      ["clearance, m", [["plan", this.clearance]]],
    ];
    if (this.terms) {
      const names = this.data.termNames;
      const named = names.map((name, i) => [TERM_SHADES[i], column(this.terms, names.length, i), name]);
      plots.push(["terms of Eq. 9 of the choice:", named]);
    }
    return plots;
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
      const cells = cellsOver(this.data.grid, this.data.exploredFrame);
      drawRuns(cells, this.plans[plan].explored, colours().explored);
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
      oldPaths: olderPaths(this.plans.slice(0, Math.max(plan, 0)), time),
      explored: this.exploredAt(plan), seen: this.seenAt(tick),
      trail: this.trail, trailCount: tick + 1,
      contact: this.data.outcome === "contact" && tick === this.times.length - 1,
    };
  }
}

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
  makeLegend(() => show());
  slider.max = end;
  for (const one of replays) one.span = { begin: 0, end };
  panels = replays.map((one) => new Panel(one, { seek }));
  if (panels.length === 1) panels[0].hold(document.getElementById("legend"));
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
  window.dynastar = { seek, end, panels: () => panels, time: () => now, frame: () => replays[0].frame(now) };
  show();
}

start();
