// Lines over time with the present marked, and the window of candidates in v and omega.

function sized(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.max(1, Math.round(width * ratio));
    canvas.height = Math.max(1, Math.round(height * ratio));
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return [context, width, height];
}

// series: [{ values, colour }] over times from begin to end. Lines that stay are drawn once and kept as an
// image; those that change are drawn each time.
class Chart {
  constructor(canvas, times, series, { begin = 0, end = 1, changing = false }) {
    Object.assign(this, { canvas, times, series, begin, end, changing });
    this.image = null;
    new ResizeObserver(() => { this.image = null; this.draw(this.now || 0); }).observe(canvas);
  }

  x(time, width) { return width * (time - this.begin) / (this.end - this.begin); }

  lines(context, width, height) {
    let low = Infinity, high = -Infinity;
    for (const { values } of this.series) {
      for (const value of values) {
        if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
      }
    }
    if (low > high) { low = 0; high = 1; }
    if (high - low < 1e-6) { low -= 0.5; high += 0.5; }
    const palette = colours(), y = (value) => height - 4 - (height - 8) * (value - low) / (high - low);
    context.strokeStyle = palette.edge;
    context.lineWidth = 1;
    if (low < 0 && high > 0) {
      context.beginPath();
      context.moveTo(0, y(0));
      context.lineTo(width, y(0));
      context.stroke();
    }
    for (const { values, colour } of this.series) {
      context.strokeStyle = palette[colour];
      context.beginPath();
      let pen = false;
      for (let i = 0; i < values.length; i++) {
        if (!Number.isFinite(values[i])) { pen = false; continue; }
        const x = this.x(this.times[i], width);
        if (pen) context.lineTo(x, y(values[i]));
        else context.moveTo(x, y(values[i]));
        pen = true;
      }
      context.stroke();
    }
    context.fillStyle = palette.faint;
    context.font = "11px system-ui, sans-serif";
    context.fillText(high.toFixed(2), 3, 11);
    context.fillText(low.toFixed(2), 3, height - 3);
  }

  draw(now) {
    this.now = now;
    const [context, width, height] = sized(this.canvas);
    if (this.changing) {
      this.lines(context, width, height);
      return;
    }
    if (!this.image) {
      this.lines(context, width, height);
      this.image = document.createElement("canvas");
      this.image.width = this.canvas.width;
      this.image.height = this.canvas.height;
      this.image.getContext("2d").drawImage(this.canvas, 0, 0);
    } else {
      context.save();
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.drawImage(this.image, 0, 0);
      context.restore();
    }
    const x = this.x(now, width);
    context.strokeStyle = colours().ink;
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, height);
    context.stroke();
  }
}

// Candidates as dots, omega to the left as the robot turns, v upwards; says what is under the pointer.
class WindowChart {
  constructor(canvas, hint, refusals, recorded) {
    Object.assign(this, { canvas, hint, refusals, recorded, frame: null, dots: [], at: null });
    const point = (event) => this.point([event.offsetX, event.offsetY]);
    canvas.addEventListener("pointerdown", point);
    canvas.addEventListener("pointermove", point);
    canvas.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse") this.point(null); });
    new ResizeObserver(() => this.frame && this.draw(this.frame)).observe(canvas);
  }

  summary() {
    if (!this.recorded) return "Candidates were not recorded: run(scenario, trace=True) and dynastar run record them.";
    if (!this.frame || !this.frame.candidates.length) return "No candidates in this tick.";
    const refused = this.frame.candidates.filter((one) => one.refused !== 0).length;
    return `${this.frame.candidates.length} candidates, ${refused} refused. Point at one.`;
  }

  draw(frame) {
    this.frame = frame;
    const [context, width, height] = sized(this.canvas), palette = colours();
    this.dots = [];
    if (frame.candidates.length) this.drawDots(context, width, height, palette);
    this.describe(context, palette);
  }

  drawDots(context, width, height, palette) {
    const { frame } = this, all = frame.candidates, edge = 14, head = 32;  // the line above the dots
    const most = Math.max(0.1, ...all.map((one) => Math.abs(one.omega)));
    const top = Math.max(0.1, ...all.map((one) => one.v)), low = Math.min(0, ...all.map((one) => one.v));
    const x = (omega) => width / 2 - (width / 2 - edge) * omega / most;
    const y = (v) => height - edge - (height - edge - head) * (v - low) / (top - low);
    context.strokeStyle = palette.edge;
    context.beginPath();
    context.moveTo(x(0), head - edge); context.lineTo(x(0), height);
    context.moveTo(0, y(0)); context.lineTo(width, y(0));
    context.stroke();
    context.fillStyle = palette.faint;
    context.font = "11px system-ui, sans-serif";
    context.fillText(`up: v to ${top.toFixed(2)} m/s; left: omega to ${most.toFixed(2)} rad/s`, 4, 12);
    const rank = ranked(all);
    for (const one of all) {
      const good = one.refused === 0 && Number.isFinite(one.score), px = x(one.omega), py = y(one.v);
      context.fillStyle = good ? scoreColour(rank(one)) : palette.refused;
      disc(context, px, py, good ? 5 : 3);
      context.fill();
      this.dots.push([px, py, one]);
    }
    if (frame.chosen) {
      disc(context, x(frame.chosen[1]), y(frame.chosen[0]), 8);
      context.strokeStyle = palette.ink;
      context.lineWidth = 1.5;
      context.stroke();
      context.lineWidth = 1;
    }
  }

  // Takes where the pointer is, or null: what lies there is described with every drawing until it leaves.
  point(at) {
    this.at = at;
    if (this.frame) this.draw(this.frame);
  }

  describe(context, palette) {
    let best = null, least = 14;
    for (const dot of this.at ? this.dots : []) {
      const apart = Math.hypot(dot[0] - this.at[0], dot[1] - this.at[1]);
      if (apart < least) { least = apart; best = dot; }
    }
    if (!best) {
      this.hint.textContent = this.summary();
      return;
    }
    const [x, y, one] = best;
    disc(context, x, y, 11);
    context.strokeStyle = palette.plan;
    context.stroke();
    const why = one.refused !== 0 ? `refused: ${this.refusals[one.refused] || "not admissible"}`
      : Number.isFinite(one.score) ? `score ${one.score.toFixed(3)}` : "each of its manoeuvres touches an obstacle";
    this.hint.textContent = `v ${one.v.toFixed(2)} m/s, omega ${one.omega.toFixed(2)} rad/s: ${why}`;
  }
}
