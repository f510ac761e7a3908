// The playground: takes what the server tells, draws it, and asks for what is done on the page.

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

// A slider's value, with decimals only where its steps have them.
const shownValue = (value, step) => Number(value).toFixed(Number(step) % 1 ? 2 : 0);

class Page {
  constructor() {
    this.live = this.panel = null;
    this.paused = false;
    this.hand = new Hand(this);
    this.notice = document.getElementById("notice");
    this.legend = document.getElementById("legend");
    makeLegend(() => { this.dirty = true; });
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
    this.notice.parentElement.classList.toggle("shown", text !== "");
    clearTimeout(this.timer);
    if (!lasting && text) this.timer = setTimeout(() => this.say(""), 6000);
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
    this.live.overlay = (view) => this.overlay(view);
    this.panel = new Panel(this.live, { tool: this.hand });
    this.panel.hold(this.legend);
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
      input.nextElementSibling.textContent = shownValue(value, input.step);
    }
  }

  slider({ name, value, low, high, step, doc }) {
    const input = element("input", { type: "range", name, min: low, max: high, step, value });
    const shown = element("output", {}, shownValue(value, step));
    input.addEventListener("input", () => { shown.textContent = shownValue(input.value, step); });
    input.addEventListener("change", () => this.send("set", { name, value: Number(input.value) }));
    return element("label", { title: name }, doc, input, shown);
  }

  overlay(view) {
    this.hand.draw(view);
    if (this.live.waiting) drawCallout(view, "click to send me", this.live.last.pose, colours());
  }

  clock({ paused, halted, rate }) {
    const { live } = this, { last } = live;
    this.paused = paused;
    live.waiting = paused && live.end === 0;
    document.getElementById("pause").textContent = live.waiting ? "Start" : paused ? "Resume" : "Pause";
    document.getElementById("step").disabled = !paused;
    const touched = last ? last.touched : { moving: 0, resting: 0 };
    document.getElementById("clock").textContent = `${live.end.toFixed(1)} s, ${paused ? "paused" : `${rate.toFixed(0)} Hz`}, `
      + `contacts: ${touched.moving} moving, ${touched.resting} standing still`;
    if (halted && halted !== this.halted) this.say(`Halted: ${halted}`, true);
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
    document.getElementById("usage").textContent = TOOLS[tool][2];
    if (this.panel) this.panel.map.classList.toggle("using", tool !== "move");
  }

  makeControls() {
    const tools = document.getElementById("tools");
    for (const [name, [key, words]] of Object.entries(TOOLS)) {
      const box = element("input", { type: "radio", name: "tool", value: name, checked: name === "goal" });
      box.addEventListener("change", () => this.choose(name));
      tools.append(element("label", {}, box, words, element("kbd", {}, key)));
    }
    this.choose("goal");
    const click = (id, action) => document.getElementById(id).addEventListener("click", action);
    click("pause", () => this.send("pause", { paused: !this.paused }));
    click("step", () => this.send("step"));
    click("stop", () => this.send("goals", { goals: [] }));
    click("reset", () => this.send("reset"));
    click("dismiss", () => this.say(""));
    click("notice", () => this.say(""));
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
