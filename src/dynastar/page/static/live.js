// A live scene as the server tells of it: what is known of it, and the newest frame.

const WINDOW = 30;  // s of lines over time
const TRAIL = 20000;  // places of the trail that are kept
const READY = "Click on the map to send me there. Start lets time pass.";

// A scene as the server tells of it, as a Panel's source.
class Live {
  constructor(message) {
    this.name = message.name;
    this.about = message.robot;
    this.refusals = message.refusals;
    this.recorded = true;
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
    this.waiting = false;  // for the first goal, before time passes
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
    return [["speed v, m/s:", [["plan", wanted, "commanded"], ["driven", v, "driven"]]],
      ["turning rate omega, rad/s:", [["plan", turning, "commanded"], ["driven", omega, "driven"]]],
      ["clearance, m", [["plan", clearance]]],
      ["terms of Eq. 9 of the choice:", this.termNames.map((name, i) => [TERM_SHADES[i], this.terms[i], name])]];
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
    if (this.last && message.time < this.last.time) return;
    this.scene.goals = message.goals;
    if (this.last && message.time === this.last.time) {  // time stands still: goals and walkers may be others
      this.last = this.before = { ...message, candidates, came: this.last.came };
      return;
    }
    this.before = this.last;
    this.last = { ...message, candidates, came: performance.now() };
    this.end = message.time;
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
    const part = before && before.time < last.time ? Math.min((performance.now() - last.came) / (1000 * (last.time - before.time)), 1) : 1;
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
    const words = this.waiting ? { state: "ready", reason: READY } : {};
    return { ...last, ...words, pose, movers, seen: this.seen, explored: this.explored,
      path: plan ? plan.points : null, planReason: plan ? plan.reason : "",
      oldPaths: olderPaths(this.plans.slice(0, -1), this.end),
      trail: this.trail, trailCount: this.trail.length / 2, contact: false };
  }

  moverAt([x, y]) {
    const found = this.last && this.last.movers.find(([, mx, my, radius]) => Math.hypot(mx - x, my - y) <= radius + 0.1);
    return found ? found[0] : null;
  }
}
