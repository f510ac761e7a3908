// Drawing of one moment: a scene that stays, and a frame that passes. Metres, x to the right, y up.

const KINDS = { int8: Int8Array, uint8: Uint8Array, uint16: Uint16Array, int32: Int32Array, float32: Float32Array };

function unpacked({ kind, data }) {
  const text = atob(data), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return new KINDS[kind](bytes.buffer);
}

function colours() {
  const style = getComputedStyle(document.documentElement);
  return new Proxy({}, { get: (_, name) => style.getPropertyValue(`--${name}`).trim() });
}

// A canvas with a part of the world on it, moved by dragging and zoomed by the wheel or two fingers. A
// tool with begin, move and end (place, event) takes the drags of one finger or the left button instead.
class View {
  constructor(canvas, box, redraw, tool = null) {
    this.canvas = canvas;
    this.whole = box;
    this.redraw = redraw;
    this.tool = tool;
    this.using = null;
    this.fitted = true;
    this.pointers = new Map();
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    canvas.addEventListener("pointerup", (event) => this.up(event, true));
    canvas.addEventListener("pointercancel", (event) => this.up(event, false));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("dblclick", () => { this.fitted = true; this.resize(); redraw(); });
    new ResizeObserver(() => { this.resize(); redraw(); }).observe(canvas);
    this.resize();
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.canvas.width = Math.max(1, Math.round(width * ratio));
    this.canvas.height = Math.max(1, Math.round(height * ratio));
    this.ratio = ratio;
    this.width = width;
    this.height = height;
    if (!this.fitted) return;
    const [x0, y0, x1, y1] = this.whole;
    this.scale = 0.96 * Math.min(width / (x1 - x0), height / (y1 - y0)) || 1;
    this.centre = [(x0 + x1) / 2, (y0 + y1) / 2];
  }

  zoom(factor, px, py) {
    const [x, y] = this.world(px, py);
    this.fitted = false;
    this.scale = Math.min(Math.max(this.scale * factor, 1), 2000);
    const [nx, ny] = this.world(px, py);
    this.centre = [this.centre[0] + x - nx, this.centre[1] + y - ny];
    this.redraw();
  }

  down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (this.using !== null) {  // a second finger: both zoom
      this.tool.cancel();
      this.using = null;
    } else if (this.tool && this.pointers.size === 1 && event.button === 0
      && this.tool.begin(this.world(event.offsetX, event.offsetY), event)) {
      this.using = event.pointerId;
    }
  }

  up(event, done) {
    this.pointers.delete(event.pointerId);
    if (this.using !== event.pointerId) return;
    this.using = null;
    if (done) this.tool.end(this.world(event.offsetX, event.offsetY), event);
    else this.tool.cancel();
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    if (this.using === event.pointerId) {
      this.tool.move(this.world(event.offsetX, event.offsetY), event);
      return;
    }
    const now = [event.offsetX, event.offsetY];
    const others = [...this.pointers.entries()].filter(([id]) => id !== event.pointerId);
    if (others.length === 1) {
      const other = others[0][1];
      const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      this.zoom(apart(now) / Math.max(apart(before), 1), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
    } else {
      this.fitted = false;
      this.centre = [this.centre[0] - (now[0] - before[0]) / this.scale,
        this.centre[1] + (now[1] - before[1]) / this.scale];
      this.redraw();
    }
    this.pointers.set(event.pointerId, now);
  }

  // Keeps a place in the middle, close up.
  follow([x, y]) {
    if (this.fitted) this.scale *= 3;
    this.fitted = false;
    this.centre = [x, y];
  }

  world(px, py) {
    return [this.centre[0] + (px - this.width / 2) / this.scale,
      this.centre[1] - (py - this.height / 2) / this.scale];
  }

  // A context whose unit is a metre and whose y axis points up.
  begin() {
    const context = this.canvas.getContext("2d");
    const unit = this.ratio * this.scale;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.setTransform(unit, 0, 0, -unit, this.canvas.width / 2 - unit * this.centre[0],
      this.canvas.height / 2 + unit * this.centre[1]);
    return context;
  }

  pixels(count) { return count / this.scale; }
}

// Cells of a grid, coloured once, as an image that is drawn with one call.
class Cells {
  constructor(rows, columns, frame) {
    this.rows = rows;
    this.columns = columns;
    this.frame = frame;
    this.canvas = document.createElement("canvas");
    this.canvas.width = columns;
    this.canvas.height = rows;
    this.context = this.canvas.getContext("2d");
  }

  run(row, column, count, colour) {
    this.context.fillStyle = colour;
    this.context.fillRect(column, row, count, 1);
  }

  clear() { this.context.clearRect(0, 0, this.columns, this.rows); }

  draw(context) {
    const [resolution, x, y, yaw] = this.frame;
    context.save();
    context.translate(x, y);
    context.rotate(yaw || 0);
    context.scale(resolution, resolution);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.canvas, 0, 0);
    context.restore();
  }
}

function mapCells(grid, palette) {
  const cells = new Cells(grid.rows, grid.columns, grid.frame);
  for (let row = 0; row < grid.rows; row++) {
    let begin = 0, last = null;
    for (let column = 0; column <= grid.columns; column++) {
      let colour = null;
      if (column < grid.columns) {
        const at = row * grid.columns + column, value = grid.values[at];
        colour = value < 0 ? palette.unknown : value >= 65 ? palette.occupied
          : grid.keepout && grid.keepout[at] ? palette.keepout : palette.free;
      }
      if (colour !== last) {
        if (last !== null) cells.run(row, begin, column - begin, last);
        begin = column;
        last = colour;
      }
    }
  }
  return cells;
}

function boxOf(grid) {
  const [resolution, x, y, yaw] = grid.frame;
  const [c, s] = [Math.cos(yaw || 0), Math.sin(yaw || 0)];
  const corners = [[0, 0], [grid.columns, 0], [0, grid.rows], [grid.columns, grid.rows]]
    .map(([i, j]) => [x + resolution * (c * i - s * j), y + resolution * (s * i + c * j)]);
  const xs = corners.map((p) => p[0]), ys = corners.map((p) => p[1]);
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

function polyline(context, points, count = points.length / 2, begin = 0) {
  context.beginPath();
  for (let i = begin; i < count; i++) context.lineTo(points[2 * i], points[2 * i + 1]);
}

function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

// Where a robot is after t seconds on the arc of v and omega.
function along([x, y, heading], v, omega, t) {
  const turn = 0.5 * omega * t;
  const chord = v * t * (Math.abs(turn) < 1e-9 ? 1 : Math.sin(turn) / turn);
  return [x + chord * Math.cos(heading + turn), y + chord * Math.sin(heading + turn), heading + 2 * turn];
}

// From vermillion (worst) to blue (best), which the colour-blind tell apart [Okabe2008].
function scoreColour(part) {
  const worst = [213, 94, 0], best = [0, 114, 178];
  const mixed = worst.map((value, i) => Math.round(value + part * (best[i] - value)));
  return `rgb(${mixed.join(" ")})`;
}

// The place of each candidate among those with a score, 0 the worst and 1 the best.
function ranked(candidates) {
  const scores = candidates.filter((one) => one.refused === 0 && Number.isFinite(one.score))
    .map((one) => one.score).sort((a, b) => a - b);
  const places = new Map(scores.map((score, i) => [score, i / Math.max(scores.length - 1, 1)]));
  return (one) => places.get(one.score) ?? 0;
}

const ARC_TIME = 1.0, ARC_POINTS = 8;

function drawArcs(context, view, frame, palette) {
  const rank = ranked(frame.candidates);
  const order = [...frame.candidates].sort((a, b) => (a.refused ? 0 : 1) - (b.refused ? 0 : 1));
  for (const one of order) {
    const good = one.refused === 0 && Number.isFinite(one.score);
    context.strokeStyle = good ? scoreColour(rank(one)) : palette.refused;
    context.globalAlpha = good ? 0.9 : 0.35;
    context.lineWidth = view.pixels(1);
    context.beginPath();
    for (let k = 0; k <= ARC_POINTS; k++) {
      const [x, y] = along(frame.pose, one.v, one.omega, ARC_TIME * k / ARC_POINTS);
      context.lineTo(x, y);
    }
    context.stroke();
  }
  context.globalAlpha = 1;
}

function drawRobot(context, view, scene, frame, palette) {
  const [x, y, heading] = frame.pose;
  context.save();
  context.translate(x, y);
  context.rotate(heading);
  context.beginPath();
  if (scene.footprint.length) {
    for (const [px, py] of scene.footprint) context.lineTo(px, py);
    context.closePath();
  } else {
    context.arc(0, 0, scene.radius, 0, 2 * Math.PI);
  }
  context.fillStyle = palette.robot;
  context.globalAlpha = 0.75;
  context.fill();
  context.globalAlpha = 1;
  context.beginPath();
  context.moveTo(0, 0);
  context.lineTo(1.3 * scene.radius, 0);
  context.strokeStyle = palette.robot;
  context.lineWidth = view.pixels(2.5);
  context.stroke();
  context.restore();
}

function drawGoals(context, view, scene, palette) {
  context.strokeStyle = palette.driven;
  context.lineWidth = view.pixels(1.5);
  for (const [x, y, heading] of scene.goals) {
    disc(context, x, y, scene.tolerance);
    context.stroke();
    disc(context, x, y, view.pixels(2.5));
    context.fillStyle = palette.driven;
    context.fill();
    if (heading === null) continue;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + 2 * scene.tolerance * Math.cos(heading), y + 2 * scene.tolerance * Math.sin(heading));
    context.stroke();
  }
}

const FADE = 10;  // s in which a path that was replaced fades away

// Paths that were replaced and have not faded yet at a time (s). A path is old since the next was made.
function olderPaths(plans, time) {
  const alpha = (plan) => 1 - Math.min(Math.max((time - plan.time) / FADE, 0), 1);
  return plans.map((plan) => ({ points: plan.points, alpha: alpha(plan) })).filter((one) => one.alpha > 0);
}

// Words in a box above a place (x, y), within the canvas.
function drawCallout(view, text, [x, y], palette) {
  const context = view.canvas.getContext("2d");
  context.save();
  context.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
  context.font = "600 14px system-ui, sans-serif";
  const width = context.measureText(text).width + 20, height = 30, gap = 14;
  const px = view.width / 2 + (x - view.centre[0]) * view.scale;
  const py = view.height / 2 - (y - view.centre[1]) * view.scale;
  const left = Math.min(Math.max(px - width / 2, 4), view.width - width - 4);
  const top = py - gap - height > 4 ? py - gap - height : py + gap;
  context.beginPath();
  context.roundRect(left, top, width, height, 6);
  context.fillStyle = palette.robot;
  context.fill();
  context.fillStyle = palette.ground;
  context.textBaseline = "middle";
  context.fillText(text, left + 10, top + height / 2 + 1);
  context.restore();
}

// layers: which parts are wanted, by name.
function drawScene(view, scene, frame, layers) {
  if (layers.follow) view.follow(frame.pose);
  const palette = colours(), context = view.begin();
  scene.map.draw(context);
  if (layers.explored && frame.explored) frame.explored.draw(context);
  context.fillStyle = palette.obstacle;
  for (const corners of scene.obstacles) {
    context.beginPath();
    for (const [x, y] of corners) context.lineTo(x, y);
    context.closePath();
    context.fill();
  }
  if (layers.seen && frame.seen) frame.seen.draw(context);
  drawGoals(context, view, scene, palette);
  if (layers.plans) {
    for (const { points, alpha } of frame.oldPaths) {
      polyline(context, points);
      context.strokeStyle = palette.old;
      context.globalAlpha = alpha;
      context.lineWidth = view.pixels(1);
      context.stroke();
    }
    context.globalAlpha = 1;
    if (frame.path) {
      polyline(context, frame.path);
      context.strokeStyle = palette.plan;
      context.lineWidth = view.pixels(2);
      context.stroke();
    }
  }
  if (layers.driven) {
    polyline(context, frame.trail, frame.trailCount);
    context.strokeStyle = palette.driven;
    context.lineWidth = view.pixels(1.5);
    context.stroke();
  }
  if (layers.candidates) drawArcs(context, view, frame, palette);
  context.lineWidth = view.pixels(1.5);
  if (layers.movers) {
    context.fillStyle = palette.mover;
    for (const [x, y, radius] of frame.movers) {
      disc(context, x, y, radius);
      context.globalAlpha = 0.5;
      context.fill();
      context.globalAlpha = 1;
    }
  }
  if (layers.tracks) {
    context.strokeStyle = palette.mover;
    for (const [x, y, vx, vy, radius] of frame.tracks) {
      for (const [ahead, alpha] of [[0, 1], [1, 0.6], [2, 0.3]]) {
        context.globalAlpha = alpha;
        disc(context, x + ahead * vx, y + ahead * vy, radius);
        context.stroke();
      }
    }
    context.globalAlpha = 1;
  }
  drawRobot(context, view, scene, frame, palette);
  if (frame.contact) {
    disc(context, frame.pose[0], frame.pose[1], 2 * scene.radius);
    context.strokeStyle = palette.contact;
    context.lineWidth = view.pixels(3);
    context.stroke();
  }
}
