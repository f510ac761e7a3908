// What is done on the map with the tool that is chosen, by pointer and by keyboard.

const DRAG = 12;  // pixels from which a click is a drag
const FLUSH = 60;  // ms between the messages of a stroke
const SPEED = 1.0;  // m/s of a walker for a drag of 1 m
const FASTEST = 1.5;  // m/s of a walker
const BRUSH = 0.15;  // m

// Name of a tool: its key, its words, and how it is used.
const TOOLS = {
  goal: ["G", "drive here", "Click: drive there. With Shift: add a goal. Drag: set the heading at the goal."],
  paint: ["P", "paint obstacles", "Drag: paint an obstacle that the map does not have."],
  erase: ["E", "erase", "Drag: erase obstacles and walkers; walls of the map stay."],
  walker: ["W", "add or push walkers", "Click: add a walker. Drag: its direction and speed. Drag a walker: push it."],
  move: ["M", "move the map", "Drag: move the map. The wheel or two fingers zoom with every tool."],
};

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
