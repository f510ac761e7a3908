// A live scene: takes what the server tells, draws it, and asks for what is done on the page.

const WINDOW = 30;  // s of lines over time
const TRAIL = 20000;  // places of the trail that are kept
const DRAG = 12;  // pixels from which a click is a drag
const FLUSH = 60;  // ms between the messages of a stroke
const SPEED = 1.0;  // m/s of a walker for a drag of 1 m
const FASTEST = 1.5;  // m/s of a walker
const BRUSH = 0.15;  // m

// A scene as the server tells of it, as a Panel's source.
class Live {
  constructor(message) {
    this.name = message.name;
    this.about = message.robot;
    this.refusals = message.refusals;
    this.termNames = message.termNames;
    const grid = { ...message.grid, values: unpacked(message.grid.values) };
    if (grid.keepout) grid.keepout = unpacked(grid.keepout);
    this.cellFrame = message.cellFrame;
    this.scene = { grid, map: mapCells(grid, colours()), radius: message.radius, footprint: message.footprint,
      goals: [], tolerance: message.tolerance, obstacles: message.obstacles };
    this.rings = new Map(message.obstacles.entries());  // obstacles by their number
    this.seen = cellsOver(grid, this.cellFrame);
    this.explored = null;
    this.known = new Map();  // cells that are seen, to draw them again in other colours
    this.plans = [];
    this.entries = [];
    this.times = [];
    this.lines = { v: [], wanted: [], omega: [], turning: [], clearance: [] };
    this.terms = this.termNames.map(() => []);
    this.trail = [];
    this.last = this.before = null;
    this.end = 0;
  }

  takeObstacles(message) {
    for (const number of message.gone) this.rings.delete(number);
    for (const [number, ring] of message.new) this.rings.set(number, ring);
    this.scene.obstacles = [...this.rings.values()];
  }

  recolour() {
    this.scene.map = mapCells(this.scene.grid, colours());
    this.seen.clear();
    for (const [row, column] of this.known.values()) this.seen.run(row, column, 1, colours().seen);
    if (this.plans.length) this.drawExplored(this.plans[this.plans.length - 1]);
  }

  get span() { return { begin: this.end - WINDOW, end: this.end, changing: true }; }

  plots() {
    const { v, wanted, omega, turning, clearance } = this.lines;
    return [["v, driven and commanded, m/s", [["old", wanted], ["driven", v]]],
      ["omega, driven and commanded, rad/s", [["old", turning], ["driven", omega]]],
      ["clearance, m", [["plan", clearance]]],
      ["terms of Eq. 9 of the choice", this.termNames.map((name, i) => [TERM_SHADES[i], this.terms[i], name])]];
  }

  drawExplored(plan) {
    this.explored = cellsOver(this.scene.grid, this.cellFrame);
    drawRuns(this.explored, plan.explored, colours().explored);
  }

  takePlan(message) {
    const plan = { ...message, points: unpacked(message.points), explored: unpacked(message.explored) };
    this.plans.push(plan);
    if (this.plans.length > 20) this.plans.shift();
    this.drawExplored(plan);
  }

  takeSeen({ cells }) {
    for (const [row, column, blocked] of cells) {
      if (blocked) {
        this.known.set(`${row},${column}`, [row, column]);
        this.seen.run(row, column, 1, colours().seen);
      } else {
        this.known.delete(`${row},${column}`);
        this.seen.context.clearRect(column, row, 1, 1);
      }
    }
  }

  takeFrame(message) {
    const table = unpacked(message.candidates), candidates = [];
    for (let i = 0; i < table.length; i += 4) {
      candidates.push({ v: table[i], omega: table[i + 1], score: table[i + 2], refused: table[i + 3] });
    }
    if (this.last && message.time <= this.last.time) return;
    this.before = this.last;
    this.last = { ...message, candidates, came: performance.now() };
    this.end = message.time;
    this.scene.goals = message.goals;
    this.times.push(message.time);
    const { lines } = this;
    lines.v.push(message.twist[0]);
    lines.wanted.push(message.command[0]);
    lines.omega.push(message.twist[1]);
    lines.turning.push(message.command[1]);
    lines.clearance.push(message.clearance);
    this.terms.forEach((term, i) => term.push(message.terms[i] === null ? NaN : message.terms[i]));
    while (this.times[0] < this.end - WINDOW) {
      for (const values of [this.times, ...Object.values(lines), ...this.terms]) values.shift();
    }
    this.trail.push(message.pose[0], message.pose[1]);
    if (this.trail.length > 2 * TRAIL) this.trail.splice(0, 2);
  }

  // The newest frame; poses glide from the frame before to it, for the 50 ms until the next comes.
  frame() {
    const { last, before } = this;
    if (!last) return null;
    const part = before ? Math.min((performance.now() - last.came) / (1000 * (last.time - before.time)), 1) : 1;
    const glide = (a, b) => a + part * (b - a);
    let pose = last.pose;
    const places = new Map(before ? before.movers.map((mover) => [mover[0], mover]) : []);
    if (before && part < 1) {
      let turn = last.pose[2] - before.pose[2];
      turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
      pose = [glide(before.pose[0], last.pose[0]), glide(before.pose[1], last.pose[1]), before.pose[2] + part * turn];
    }
    const movers = last.movers.map(([id, x, y, radius]) => {
      const was = places.get(id);
      const near = was && Math.hypot(was[1] - x, was[2] - y) < 0.5;
      return near ? [glide(was[1], x), glide(was[2], y), radius] : [x, y, radius];
    });
    const plan = this.plans[this.plans.length - 1];
    return { ...last, pose, movers, seen: this.seen, explored: this.explored,
      path: plan ? plan.points : null, planReason: plan ? plan.reason : "",
      oldPaths: this.plans.slice(0, -1).map((one) => one.points),
      trail: this.trail, trailCount: this.trail.length / 2, contact: false };
  }

  moverAt([x, y]) {
    const found = this.last && this.last.movers.find(([, mx, my, radius]) => Math.hypot(mx - x, my - y) <= radius + 0.1);
    return found ? found[0] : null;
  }
}

// The connection: messages in order, and again after it was lost.
class Connection {
  constructor(take, lost) {
    Object.assign(this, { take, lost });
    this.open();
  }

  open() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.socket = new WebSocket(`${scheme}://${location.host}/socket${location.search}`);
    this.socket.addEventListener("message", (event) => { for (const one of JSON.parse(event.data)) this.take(one); });
    this.socket.addEventListener("close", (event) => {
      this.lost(event.reason);
      setTimeout(() => this.open(), 1000);
    });
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}

const TOOLS = { goal: ["G", "drive here (Shift: add a goal; drag: set heading)"], paint: ["P", "paint obstacles"],
  erase: ["E", "erase"], walker: ["W", "put walkers in, push them (drag)"], move: ["M", "move the map"] };

// What is done on the map with the tool that is chosen.
class Hand {
  constructor(page) {
    this.page = page;
    this.tool = "goal";
    this.cross = null;  // where the keyboard's cross is
    this.from = this.to = null;
    this.points = [];
  }

  begin(place, event) {
    if (this.tool === "move") return false;
    this.from = this.to = place;
    this.shift = event.shiftKey;
    this.pushed = this.tool === "walker" ? this.page.live.moverAt(place) : null;
    this.points = [place];
    this.flushed = performance.now();
    return true;
  }

  move(place) {
    this.to = place;
    if (this.tool !== "paint" && this.tool !== "erase") return;
    this.points.push(place);
    if (performance.now() - this.flushed > FLUSH) this.flush();
  }

  flush() {
    const shown = this.points.slice(-100).map(([x, y]) => [x, y]);
    this.page.send("stroke", { points: shown, radius: BRUSH, erase: this.tool === "erase" });
    this.points = this.points.slice(-1);
    this.flushed = performance.now();
  }

  end(place) {
    this.to = place;
    const dragged = this.dragged();
    if (this.tool === "goal") this.goal(this.from, dragged ? Math.atan2(dragged[1], dragged[0]) : null, this.shift);
    if (this.tool === "paint" || this.tool === "erase") this.flush();
    if (this.tool === "walker") this.walk(dragged);
    this.cancel();
  }

  cancel() { this.from = this.to = null; }

  // The drag in metres, or null for a click.
  dragged() {
    const [dx, dy] = [this.to[0] - this.from[0], this.to[1] - this.from[1]];
    return Math.hypot(dx, dy) * this.page.panel.view.scale > DRAG ? [dx, dy] : null;
  }

  goal([x, y], heading, more) {
    this.page.send("goals", { goals: [[x, y, heading]], more });
  }

  walk(dragged) {
    const angle = 2 * Math.PI * Math.random();
    let [vx, vy] = dragged ? dragged.map((part) => SPEED * part)
      : this.pushed !== null ? [0, 0] : [0.7 * Math.cos(angle), 0.7 * Math.sin(angle)];
    const speed = Math.hypot(vx, vy);
    if (speed > FASTEST) [vx, vy] = [vx * FASTEST / speed, vy * FASTEST / speed];
    if (this.pushed !== null) this.page.send("push", { mover: this.pushed, vx, vy });
    else this.page.send("walker", { x: this.from[0], y: this.from[1], vx, vy });
  }

  // The keyboard's cross: moved by arrows, used by Enter.
  key(event) {
    const step = event.shiftKey ? 1 : 0.25;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (event.key in moves) {
      const { live } = this.page, [x, y] = this.cross || (live.last ? live.last.pose : [0, 0]);
      this.cross = [x + moves[event.key][0], y + moves[event.key][1]];
      return true;
    }
    if (event.key !== "Enter" || !this.cross || this.tool === "move") return false;
    this.begin(this.cross, event);
    this.end(this.cross);
    return true;
  }

  draw(view) {
    const context = view.canvas.getContext("2d"), palette = colours();
    context.strokeStyle = context.fillStyle = palette.ink;
    context.lineWidth = view.pixels(1.5);
    if (this.cross) {
      const [[x, y], size] = [this.cross, view.pixels(9)];
      context.beginPath();
      context.moveTo(x - size, y); context.lineTo(x + size, y);
      context.moveTo(x, y - size); context.lineTo(x, y + size);
      context.stroke();
    }
    if (!this.from) return;
    if (this.tool === "paint" || this.tool === "erase") {
      disc(context, ...this.to, BRUSH);
      context.stroke();
    } else if (this.dragged()) {
      const angle = Math.atan2(this.to[1] - this.from[1], this.to[0] - this.from[0]), head = view.pixels(10);
      context.beginPath();
      context.moveTo(...this.from);
      context.lineTo(...this.to);
      for (const side of [-2.6, 2.6]) {
        context.moveTo(...this.to);
        context.lineTo(this.to[0] + head * Math.cos(angle + side), this.to[1] + head * Math.sin(angle + side));
      }
      context.stroke();
    }
  }
}

class Page {
  constructor() {
    this.live = this.panel = null;
    this.paused = false;
    this.hand = new Hand(this);
    this.notice = document.getElementById("notice");
    makeLayers(() => { this.dirty = true; });
    this.makeControls();
    this.connection = new Connection((message) => this.take(message),
      (reason) => this.say(`The connection is lost${reason ? `: ${reason}` : ""}. Trying again.`, true));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      if (this.live) this.live.recolour();
      this.dirty = true;
    });
    const step = () => { this.draw(); requestAnimationFrame(step); };
    requestAnimationFrame(step);
  }

  send(type, fields = {}) { this.connection.send({ type, ...fields }); }

  say(text, lasting = false) {
    this.notice.textContent = text;
    clearTimeout(this.timer);
    if (!lasting && text) this.timer = setTimeout(() => { this.notice.textContent = ""; }, 6000);
  }

  take(message) {
    const takes = { scene: () => this.open(message), settings: () => this.fill(message),
      plan: () => { this.live.takePlan(message); this.log(message.time, `path: ${message.reason}`); },
      seen: () => this.live.takeSeen(message), obstacles: () => this.live.takeObstacles(message),
      event: () => this.log(message.time, message.text), frame: () => this.live.takeFrame(message),
      loop: () => this.clock(message), refused: () => this.say(message.reason) };
    takes[message.type]();
    this.dirty = true;
  }

  log(time, text) {
    this.live.entries.push([time, text]);
    this.panel.addEntry(time, text);
  }

  open(message) {
    this.say("");
    const focused = this.panel && document.activeElement === this.panel.map;
    const before = this.panel && this.live.name === message.name ? this.panel.view : null;
    if (this.panel) this.panel.root.remove();
    this.live = new Live(message);
    this.live.overlay = (view) => this.hand.draw(view);
    this.panel = new Panel(this.live, { tool: this.hand });
    if (before) {  // the same map: it stays where it was moved to
      const { fitted, scale, centre } = before;
      Object.assign(this.panel.view, { fitted, scale, centre });
    } else {
      this.hand.cross = null;
    }
    const { map } = this.panel;
    map.tabIndex = 0;
    map.setAttribute("role", "application");
    map.classList.toggle("using", this.hand.tool !== "move");
    map.addEventListener("keydown", (event) => {
      if (!this.hand.key(event)) return;
      event.preventDefault();
      event.stopPropagation();
      this.dirty = true;
    });
    map.addEventListener("pointermove", () => { this.dirty = true; });
    if (focused) map.focus();
    const options = (id, names, chosen) => document.getElementById(id).replaceChildren(
      ...names.map((name) => element("option", { value: name, selected: name === chosen }, name)));
    const names = message.scenes.includes(message.name) ? message.scenes : [message.name, ...message.scenes];
    options("scenes", names, message.name);
    options("presets", message.presets, message.preset);
    this.fill(message);
  }

  fill({ preset, sliders }) {
    document.getElementById("presets").value = preset;
    const place = document.getElementById("sliders");
    const inputs = new Map([...place.querySelectorAll("input")].map((input) => [input.name, input]));
    if (sliders.some(({ name, high }) => !inputs.has(name) || Number(inputs.get(name).max) !== high)) {
      place.replaceChildren(...sliders.map((slider) => this.slider(slider)));
      return;
    }
    for (const { name, value } of sliders) {
      const input = inputs.get(name);
      if (document.activeElement !== input) input.value = value;
      input.nextElementSibling.textContent = Number(value).toFixed(2);
    }
  }

  slider({ name, value, low, high, step, doc }) {
    const shown = element("output", {}, value.toFixed(2));
    const input = element("input", { type: "range", name, min: low, max: high, step, value });
    input.addEventListener("input", () => { shown.textContent = Number(input.value).toFixed(2); });
    input.addEventListener("change", () => this.send("set", { name, value: Number(input.value) }));
    return element("label", { title: name }, doc, input, shown);
  }

  clock({ paused, halted, rate }) {
    this.paused = paused;
    document.getElementById("pause").textContent = paused ? "Resume" : "Pause";
    document.getElementById("step").disabled = !paused;
    const { last } = this.live, touched = last ? last.touched : { moving: 0, resting: 0 };
    document.getElementById("clock").textContent = `${(last ? last.time : 0).toFixed(1)} s, ${rate.toFixed(0)} Hz, `
      + `contacts: ${touched.moving} moving, ${touched.resting} standing`;
    if (halted) this.say(`Halted: ${halted}`, true);
    this.halted = halted;
  }

  draw() {
    const { live } = this;
    if (!live || !live.last) return;
    const gliding = performance.now() - live.last.came < 100;
    if (!this.dirty && !gliding) return;
    this.dirty = false;
    this.drawn = (this.drawn || 0) + 1;
    this.panel.draw(live.end);
  }

  choose(tool) {
    this.hand.tool = tool;
    this.hand.cancel();
    document.querySelector(`#tools input[value=${tool}]`).checked = true;
    if (this.panel) this.panel.map.classList.toggle("using", tool !== "move");
  }

  makeControls() {
    const tools = document.getElementById("tools");
    for (const [name, [key, title]] of Object.entries(TOOLS)) {
      const box = element("input", { type: "radio", name: "tool", value: name, checked: name === "goal" });
      box.addEventListener("change", () => this.choose(name));
      tools.append(element("label", { title: key }, box, ` ${title}`));
    }
    const click = (id, action) => document.getElementById(id).addEventListener("click", action);
    click("pause", () => this.send("pause", { paused: !this.paused }));
    click("step", () => this.send("step"));
    click("stop", () => this.send("goals", { goals: [] }));
    click("reset", () => this.send("reset"));
    for (const [id, type, field] of [["scenes", "scene", "scene"], ["presets", "preset", "preset"]]) {
      document.getElementById(id).addEventListener("change", (event) => this.send(type, { [field]: event.target.value }));
    }
    for (const id of ["scene", "episode", "report"]) document.getElementById(id).search = location.search;
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (event.target.matches("select, input[type=range]") || event.ctrlKey || event.altKey || event.metaKey) return;
    const tool = Object.keys(TOOLS).find((name) => TOOLS[name][0].toLowerCase() === event.key.toLowerCase());
    if (tool) this.choose(tool);
    else if (event.key === " " && !event.target.matches("button, input, summary, a")) {
      this.send("pause", { paused: !this.paused });
    } else if (event.key === "ArrowRight" && this.paused && !event.target.matches("input")) this.send("step");
    else if (event.key.toLowerCase() === "r") this.send("reset");
    else return;
    event.preventDefault();
  }
}

const page = new Page();
window.dynastar = { page, frame: () => page.live && page.live.last };
