// Script of the report: pictures over time that zoom together. It is part of this project and has its licence
// (MIT OR Apache-2.0); it uses no library. The page works without it: it then shows the same values as SVG.
"use strict";
// A page that shows one report after another gives a signal, which ends what this one listens to.
const report = (signal) => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const root = document.documentElement;
  if (!data.n) return;

  // ---- Values -----------------------------------------------------------------------------------------------------

  const bytes = (text) => {
    const raw = atob(text), all = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) all[i] = raw.charCodeAt(i);
    return all;
  };
  // The value of every code of 16 bits; see code.rs.
  const table = new Float32Array(65536);
  for (let code = 1; code < 32768; code++) {
    const value = 1e-4 * 10 ** ((code - 1) * 12 / 32766);
    table[code] = value;
    table[65536 - code] = -value;
  }
  table[32768] = NaN;
  const codes = (array) => Float32Array.from(array, (code) => table[code]);
  const spread = (array, n) => (array.length === n ? array : new array.constructor(n).fill(array[0]));
  const n = data.n;
  const column = (name, Type) => spread(new Type(bytes(data.col[name]).buffer), n);
  const curve = (name) => {
    const lo = codes(column(name, Uint16Array));
    return { lo, hi: data.col[name + "+"] ? codes(column(name + "+", Uint16Array)) : lo };
  };
  const single = (array) => ({ lo: array, hi: array });
  const seconds = (array) => Float64Array.from(array, (ms) => ms / 1000);
  const time = seconds(column("t", Uint32Array));
  const [reason, severity, pin, used, excluded] =
    ["reason", "severity", "pin", "used", "excluded"].map((name) => column(name, Uint8Array));
  const clock = column("clock", Float32Array).map((metres) => metres / 299.792458);
  const [east, north] = ["east", "north"].map((name) => column(name, Float32Array));

  const colours = { G: "blue", J: "blue", C: "orange", E: "green", R: "violet" };
  const dashes = { G: [], J: [2, 3], C: [7, 5], E: [], R: [7, 5] };
  const names = { G: "GPS", J: "QZSS", C: "BeiDou", E: "Galileo", R: "GLONASS" };
  const times = seconds(new Uint32Array(bytes(data.st).buffer));
  const satellites = data.sats.map((one) => {
    const raw = bytes(one.b).buffer, m = raw.byteLength / 17;
    const wide = (k) => new Uint16Array(raw, 2 * k * m, m), small = (k) => new Uint8Array(raw, 14 * m + k * m, m);
    const degrees = (k) => Float32Array.from(new Int16Array(raw, 2 * k * m, m), (v) => (v === -32768 ? NaN : v / 100));
    const cn0 = (k) => Float32Array.from(small(k), (v) => (v ? v / 4 : NaN));
    const bucket = wide(0);
    return {
      name: one.n, system: one.n[0], bucket, time: Float64Array.from(bucket, (b) => times[b]),
      residual: { lo: codes(wide(1)), hi: codes(wide(2)) }, sigma: codes(wide(3)), w: codes(wide(4)),
      azimuth: degrees(5), elevation: degrees(6), cn0: { lo: cn0(0), hi: cn0(1) }, fate: small(2),
    };
  });
  // The first index at or behind a time.
  const after = (array, t) => {
    let low = 0, high = array.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (array[middle] < t) low = middle + 1; else high = middle;
    }
    return low;
  };
  const nearest = (array, t) => {
    const i = after(array, t);
    return i === 0 ? 0 : i === array.length || t - array[i - 1] <= array[i] - t ? i - 1 : i;
  };
  const present = (one, t) => {
    const index = nearest(one.bucket, nearest(times, t));
    return one.bucket[index] === nearest(times, t) ? index : -1;
  };

  // ---- Words ------------------------------------------------------------------------------------------------------

  const two = (number) => String(number).padStart(2, "0");
  const months = "Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec".split(" ");
  const stamp = (t, step) => {
    if (data.t0 === null) return String(+t.toFixed(step < 1 ? 1 : 0));
    const at = new Date(data.t0 + Math.round(t * 1000));
    const [h, m, s] = [at.getUTCHours(), at.getUTCMinutes(), at.getUTCSeconds()];
    if (step >= 3600 && h === 0 && m === 0) return months[at.getUTCMonth()] + " " + at.getUTCDate();
    const tenths = step < 1 ? "." + Math.floor(at.getUTCMilliseconds() / 100) : "";
    return two(h) + ":" + two(m) + (step < 60 ? ":" + two(s) + tenths : "");
  };
  const short = (value) => {
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    if (Number.isInteger(value) && size < 1e5) return String(value);
    if (size >= 9.9e7) return "∞";
    if (size >= 1e5) return value.toExponential(1);
    return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
  };
  const label = (value) => String(+value.toPrecision(3)).replace("-", "−");
  const element = (tag, className, text) => {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
  };
  let ink = {};
  const readColours = () => {
    const style = getComputedStyle(root);
    for (const name of ["ink", "soft", "line", "card", "blue", "orange", "violet", "green", "red", "grey", "teal"]) {
      ink[name] = style.getPropertyValue("--" + name).trim();
    }
  };

  // ---- Scales -----------------------------------------------------------------------------------------------------

  const scales = {
    linear: { of: (v) => v, ticks: (low, high, most) => even(low, high, most) },
    log: { of: (v) => Math.log10(Math.max(v, 1e-4)), ticks: (low, high, most) => decades(low, high, most) },
    // Linear near zero, logarithmic beyond a metre.
    symmetric: { of: (v) => Math.asinh(v), ticks: (low, high, most) => symmetric(low, high, most) },
  };
  const nice = (rough) => {
    const power = 10 ** Math.floor(Math.log10(rough));
    return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= rough * 0.999);
  };
  const even = (low, high, most) => {
    const step = nice((high - low) / most), ticks = [];
    for (let k = Math.ceil(low / step); k * step <= high * (1 + 1e-12); k++) ticks.push(k * step);
    return ticks;
  };
  const decades = (low, high, most) => {
    const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))], every = [];
    const digits = last - first <= 1 ? [1, 2, 3, 5] : last - first <= 2 ? [1, 3] : [1];
    for (let e = first; e <= last; e++) for (const digit of digits) every.push(digit * 10 ** e);
    const within = every.filter((value) => value >= low * 0.999 && value <= high * 1.001);
    return within.filter((_, index) => index % Math.ceil(within.length / (most + 2)) === 0);
  };
  const symmetric = (low, high, most) => {
    const size = Math.max(-low, high);
    if (size <= 6) return even(low, high, most);
    const powers = [];
    for (let e = size < 1e4 ? 0 : 1; 10 ** e <= size; e += size < 1e4 ? 1 : 2) powers.push(10 ** e);
    return [...powers.map((value) => -value), 0, ...powers].filter((value) => value >= low && value <= high);
  };
  const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400,
    172800, 604800, 1209600, 2592000];
  const instants = (from, to, most) => {
    const step = data.t0 === null ? nice((to - from) / most) : STEPS.find((s) => (to - from) / s <= most) || 5184000;
    const offset = data.t0 === null ? 0 : (data.t0 / 1000) % step, ticks = [];
    for (let k = Math.ceil((from + offset) / step); k * step - offset <= to; k++) ticks.push(k * step - offset);
    return [ticks, step];
  };

  // ---- Rows -------------------------------------------------------------------------------------------------------

  // The last epoch lasts as long as the one before, but is never wide.
  const lasts = n > 1 ? Math.min(time[n - 1] - time[n - 2], (time[n - 1] - time[0]) / 20) : 1;
  const whole = [time[0], time[n - 1] + Math.max(lasts, 0.1)];
  let view = whole.slice(), cursor = null, chosen = null, width = 0;
  const LEFT = 58, RIGHT = 14, BOTTOM = 22, TOP = 6;
  const x = (t) => LEFT + (t - view[0]) / (view[1] - view[0]) * (width - LEFT - RIGHT);
  const instant = (px) => view[0] + (px - LEFT) / (width - LEFT - RIGHT) * (view[1] - view[0]);
  const rows = [];
  // As in the pictures without script: overlapping faults differ.
  const tint = (index) => ["red", "teal", "violet", "orange", "blue"][index % 5];

  class Row {
    constructor(title, height, parent) {
      this.height = height;
      this.box = parent.appendChild(element("figure", "row-live"));
      const head = this.box.appendChild(element("figcaption"));
      head.appendChild(element("b", "", title));
      this.legend = head.appendChild(element("span", "legend"));
      const frame = this.box.appendChild(element("div", "frame"));
      this.canvas = frame.appendChild(element("canvas"));
      this.canvas.setAttribute("role", "img");
      this.canvas.setAttribute("aria-label", title);
      this.line = frame.appendChild(element("div", "cursor"));
      this.area = frame.appendChild(element("div", "selection"));
      this.frame = frame;
      rows.push(this);
      listen(this);
    }
    key(name, colour, dash, mark) {
      const entry = this.legend.appendChild(element("span", "entry"));
      const box = mark ? `<rect x="2" y="1" width="18" height="10" fill="var(--${colour})"${mark === "band" ? ' opacity=".35"' : ""}/>`
        : `<path d="M1 6H23" stroke="var(--${colour})" stroke-width="2.5" stroke-dasharray="${dash.join(" ")}"/>`;
      if (mark !== "cross") entry.innerHTML = `<svg width="24" height="12" viewBox="0 0 24 12" aria-hidden="true">${box}</svg>`;
      entry.append(name + " ");
      if (mark !== "band") return entry.appendChild(element("output"));
    }
    prepare() {
      const ratio = window.devicePixelRatio || 1;
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(this.height * ratio);
      this.canvas.style.height = this.height + "px";
      const pen = this.canvas.getContext("2d");
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.font = "12px system-ui, sans-serif";
      return pen;
    }
    faults(pen) {
      pen.globalAlpha = 0.14;
      for (const [index, [, from, to]] of data.faults.entries()) {
        pen.fillStyle = ink[tint(index)];
        const [a, b] = [Math.max(x(from), LEFT), Math.min(x(to ?? whole[1]), width - RIGHT)];
        if (b > a) pen.fillRect(a, TOP, b - a, this.height - TOP - BOTTOM);
      }
      pen.globalAlpha = 1;
    }
    axis(pen) {
      const y = this.height - BOTTOM, [ticks, step] = instants(view[0], view[1], Math.max(2, (width - LEFT) / 95));
      pen.strokeStyle = ink.soft;
      pen.fillStyle = ink.ink;
      pen.textBaseline = "top";
      pen.textAlign = "center";
      pen.beginPath();
      for (const t of ticks) {
        const text = stamp(t, step), half = pen.measureText(text).width / 2;
        pen.moveTo(x(t), y);
        pen.lineTo(x(t), y + 4);
        pen.fillText(text, Math.min(Math.max(x(t), half + 1), width - half - 1), y + 6);
      }
      pen.moveTo(LEFT, y);
      pen.lineTo(width - RIGHT, y);
      pen.stroke();
    }
  }

  // Smallest and largest value of each pixel column.
  const extremes = (line, put) => {
    const { lo, hi } = line.values, at = line.time || time;
    const first = Math.max(after(at, view[0]) - 1, 0), last = Math.min(after(at, view[1]) + 1, at.length);
    let column = null, low = 0, high = 0, before = NaN, end = NaN, pen = false;
    const flush = () => {
      if (column === null) return;
      put(column, before, low, high, end, pen);
      pen = true;
      column = null;
    };
    for (let i = first; i < last; i++) {
      const [a, b] = [lo[i], hi[i]];
      const gap = line.bucket && i > first && line.bucket[i] - line.bucket[i - 1] > 1;
      if (a !== a || gap) {
        flush();
        pen = false;
        if (a !== a) continue;
      }
      const px = Math.round(x(at[i]));
      if (px !== column) {
        flush();
        [column, low, high, before] = [px, a, b, a];
      }
      if (a < low) low = a;
      if (b > high) high = b;
      end = b;
    }
    flush();
  };

  class Chart extends Row {
    constructor(title, unit, scale, lines, parent, height = 170) {
      super(title + ", " + unit, height, parent);
      Object.assign(this, { scale: scales[scale], kind: scale, lines });
      for (const line of lines) if (line.name) line.output = this.key(line.name, line.colour, line.dash, line.cross && "cross");
      data.faults.forEach(([name], index) => this.key(name, tint(index), [], "band"));
    }
    range() {
      let low = Infinity, high = -Infinity;
      for (const line of this.lines) {
        const at = line.time || time, { lo, hi } = line.values;
        for (let i = after(at, view[0]), last = after(at, view[1] + 1e-9); i < last; i++) {
          if (lo[i] < low && (this.kind !== "log" || lo[i] > 0)) low = lo[i];
          if (hi[i] > high && hi[i] < 9.9e7) high = hi[i];
        }
      }
      if (low > high) return this.kind === "log" ? [0.1, 1] : [0, 1];
      if (this.kind === "log") {
        low = Math.max(low, high / 1e5, 1e-3);
        return [low / 1.25, Math.max(high, low * 2) * 1.25];
      }
      if (this.kind === "symmetric") return [Math.min(low * 1.25, -1), Math.max(high * 1.25, 1)];
      const air = high > low ? 0.08 * (high - low) : 1;
      return [low >= 0 && low < 2 * air ? 0 : low - air, high + air];
    }
    draw() {
      const pen = this.prepare(), [low, high] = this.range(), bottom = this.height - BOTTOM;
      const [a, b] = [this.scale.of(low), this.scale.of(high)];
      this.y = (v) => bottom - (Math.min(Math.max(this.scale.of(v), a), b) - a) / (b - a) * (bottom - TOP);
      pen.textAlign = "right";
      pen.textBaseline = "middle";
      for (const tick of this.scale.ticks(low, high, Math.floor(this.height / 38))) {
        pen.strokeStyle = ink.line;
        pen.beginPath();
        pen.moveTo(LEFT, this.y(tick));
        pen.lineTo(width - RIGHT, this.y(tick));
        pen.stroke();
        pen.fillStyle = ink.ink;
        pen.fillText(label(tick), LEFT - 7, this.y(tick));
      }
      this.faults(pen);
      pen.save();
      pen.beginPath();
      pen.rect(LEFT, 0, width - LEFT - RIGHT, bottom + 1);
      pen.clip();
      for (const line of this.lines) this.stroke(pen, line);
      pen.restore();
      this.axis(pen);
    }
    stroke(pen, line) {
      pen.strokeStyle = pen.fillStyle = ink[line.colour];
      const isChosen = chosen && line.satellite === chosen;
      pen.lineWidth = isChosen ? 3.5 : line.satellite ? 1.2 : 2;
      pen.globalAlpha = line.satellite ? (isChosen ? 1 : chosen ? 0.25 : 0.75) : 1;
      if (line.cross) {
        pen.beginPath();
        extremes(line, (px, before, lo, hi) => {
          for (const v of lo === hi ? [lo] : [lo, hi]) {
            const y = this.y(v);
            pen.moveTo(px - 4, y - 4); pen.lineTo(px + 4, y + 4);
            pen.moveTo(px - 4, y + 4); pen.lineTo(px + 4, y - 4);
          }
        });
        pen.stroke();
        pen.globalAlpha = 1;
        return;
      }
      // Dashes of a crowded line would merge: its extremes are drawn without.
      const dense = (line.time || time).length && view[1] > view[0] &&
        (after(line.time || time, view[1]) - after(line.time || time, view[0])) > 2 * width;
      pen.setLineDash(dense && !line.steady ? [] : line.dash);
      pen.beginPath();
      let alone = null;
      const dot = () => { if (alone) pen.fillRect(alone[0] - 1, alone[1] - 1, 2, 2); };
      extremes(line, (px, before, lo, hi, end, joined) => {
        if (joined) pen.lineTo(px, this.y(before)); else { dot(); pen.moveTo(px, this.y(before)); }
        alone = joined || lo !== hi ? null : [px, this.y(before)];
        if (lo !== hi) {
          pen.moveTo(px, this.y(lo));
          pen.lineTo(px, this.y(hi));
          pen.moveTo(px, this.y(end));
        }
      });
      dot();
      pen.stroke();
      pen.setLineDash([]);
      pen.globalAlpha = 1;
    }
    show(at) {
      for (const line of this.lines) {
        let index = at;
        if (!line.output || line.satellite) continue;
        const { lo, hi } = line.values;
        if (index !== null && line.time) index = nearest(line.time, time[index]);
        line.output.textContent = index === null || line.cross ? "" :
          short(lo[index]) + (short(lo[index]) === short(hi[index]) ? "" : " … " + short(hi[index]));
      }
    }
  }

  // Satellites in one chart: the one nearest to the pointer is named.
  class Crowd extends Chart {
    constructor(title, unit, scale, pick, parent) {
      const known = new Set(), lines = satellites.map((one) => {
        const isFirst = !known.has(one.system);
        known.add(one.system);
        return {
          name: isFirst ? names[one.system] : "", colour: colours[one.system], dash: dashes[one.system], satellite: one,
          time: one.time, bucket: one.bucket, values: pick(one),
        };
      });
      if (scale === "symmetric") {
        const crosses = satellites.map((one) => ({
          name: "", colour: "red", dash: [], cross: true, satellite: one, time: one.time, bucket: one.bucket,
          values: single(pick(one).hi.map((v, i) => (data.fates[one.fate[i]].startsWith("excluded") ? v : NaN))),
        })).filter((line) => line.values.lo.some((v) => v === v));
        if (crosses.length) crosses[0].name = "× excluded";
        lines.push(...crosses);
      }
      super(title, unit, scale, lines, parent, 200);
      this.name = this.legend.appendChild(element("output", "named"));
    }
    near(t, py) {
      let best = null, distance = 24;
      for (const line of this.lines) {
        if (line.cross) continue;
        const index = present(line.satellite, t);
        if (index < 0) continue;
        const away = Math.abs(this.y(line.values.hi[index]) - py);
        if (away < distance) [best, distance] = [line.satellite, away];
      }
      return best;
    }
    show(_, t) {
      if (t === null || !chosen) return void (this.name.textContent = "");
      const index = present(chosen, t), line = this.lines.find((one) => one.satellite === chosen && !one.cross);
      this.name.textContent = index < 0 ? chosen.name : chosen.name + " " + short(line.values.hi[index]);
    }
  }

  class States extends Row {
    constructor(parent) {
      super("May the position be used?", 92, parent);
      this.output = instantly;
      this.key("protected, pin high", "green", [], true);
      this.key("alert (hatched)", "red", [], true);
      this.key("unavailable", "grey", [], true);
      this.key("satellite excluded", "orange", [], true);
    }
    draw() {
      const pen = this.prepare(), strip = (y, name, colourOf) => {
        pen.textAlign = "right";
        pen.textBaseline = "middle";
        pen.fillStyle = ink.ink;
        pen.fillText(name, LEFT - 7, y + 9);
        const first = Math.max(after(time, view[0]) - 1, 0), last = Math.min(after(time, view[1]) + 1, n);
        // Each epoch lasts until the next; the worst of a pixel is drawn last.
        const boxes = [];
        for (let i = first; i < last;) {
          const kind = colourOf(i);
          let j = i + 1;
          while (j < last && colourOf(j) === kind) j++;
          boxes.push([kind, x(time[i]), j < n ? x(time[j]) : width - RIGHT]);
          i = j;
        }
        const order = ["green", "ink", "grey", "orange", "red"];
        for (const colour of order) for (const [kind, from, to] of boxes) if (kind === colour) {
          const left = Math.max(from, LEFT), right = Math.min(Math.max(to, left + 1.5), width - RIGHT);
          if (right <= left) continue;
          pen.fillStyle = ink[colour];
          if (colour === "ink") pen.fillRect(left, y + 16, right - left, 2); else pen.fillRect(left, y, right - left, 18);
          if (colour === "red") {
            pen.save();
            pen.beginPath();
            pen.rect(left, y, right - left, 18);
            pen.clip();
            pen.strokeStyle = "#fff";
            pen.lineWidth = 1.5;
            pen.beginPath();
            for (let k = left - 18 - left % 7; k < right; k += 7) { pen.moveTo(k, y + 18); pen.lineTo(k + 18, y); }
            pen.stroke();
            pen.restore();
          }
        }
      };
      strip(4, "state", (i) => ["green", "grey", "red"][severity[i]]);
      strip(26, "pin", (i) => (pin[i] ? "green" : "ink"));
      strip(48, "excl.", (i) => (excluded[i] ? "orange" : ""));
      this.axis(pen);
    }
    show(index) {
      if (index === null) return void (this.output.textContent = "");
      // The same instant as that of the epoch: satellites have no bucket in a silence.
      const left = (one) => {
        const i = present(one, time[index]);
        return i >= 0 && data.fates[one.fate[i]].startsWith("excluded");
      };
      const out = excluded[index] ? satellites.filter(left).map((one) => one.name).join(" ") : "";
      this.output.textContent = `${stamp(time[index], 1)} ${data.scale} ${data.reasons[reason[index]].join(" ")}, ` +
        `${used[index]} used` + (out ? `, ${out} left out` : "");
    }
  }

  // ---- Pointer ----------------------------------------------------------------------------------------------------

  let drag = null;
  function listen(row) {
    const place = (event) => event.clientX - row.frame.getBoundingClientRect().left;
    row.frame.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      drag = { row, from: place(event), to: place(event) };
      row.frame.setPointerCapture(event.pointerId);
    });
    row.frame.addEventListener("pointermove", (event) => {
      const px = Math.min(Math.max(place(event), LEFT), width - RIGHT);
      if (drag) {
        drag.to = px;
        const [a, b] = [Math.min(drag.from, px), Math.max(drag.from, px)];
        for (const each of rows) Object.assign(each.area.style, { display: "block", left: a + "px", width: b - a + "px" });
      }
      hover(instant(px), row, event.clientY - row.frame.getBoundingClientRect().top);
    });
    const release = (event) => {
      for (const each of rows) each.area.style.display = "none";
      const done = drag;
      drag = null;
      if (!done || event.type === "pointercancel") return;
      const [a, b] = [Math.min(done.from, done.to), Math.max(done.from, done.to)];
      if (b - a > 6) zoom(instant(Math.max(a, LEFT)), instant(b));
    };
    row.frame.addEventListener("pointerup", release);
    row.frame.addEventListener("pointercancel", release);
    row.frame.addEventListener("dblclick", () => zoom(...whole));
  }

  function hover(t, row, py) {
    if (row instanceof Crowd) {
      const near = row.near(t, py);
      if (near !== chosen) {
        chosen = near;
        for (const each of rows) if (each instanceof Crowd) each.draw();
      }
    }
    cursor = t;
    const index = nearest(time, t);
    for (const each of rows) {
      Object.assign(each.line.style, { display: "block", left: x(time[index]) + "px" });
      each.show(index, t);
    }
    places(t);
  }

  const LEAST = Math.max(0.5, (whole[1] - whole[0]) / 1e6);
  function zoom(from, to) {
    if (to - from < LEAST) to = from + LEAST;
    view = [Math.max(from, whole[0]), Math.min(to, whole[1])];
    if (view[1] - view[0] < LEAST) view = [Math.max(view[1] - LEAST, whole[0]), view[1]];
    for (const row of rows) {
      row.line.style.display = "none";
      row.draw();
      row.show(null, null);
    }
    cursor = null;
    span.textContent = `${stamp(view[0], 1)} to ${stamp(view[1], 1)} ${data.scale}`;
    places(null);
  }

  // ---- Sky, track, satellites of an instant -----------------------------------------------------------------------

  const square = (title, parent) => {
    const box = parent.appendChild(element("figure", "square"));
    const head = box.appendChild(element("figcaption"));
    head.appendChild(element("b", "", title));
    const canvas = box.appendChild(element("canvas"));
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", title);
    const legend = head.appendChild(element("span", "legend"));
    return { box, canvas, legend };
  };
  const pencil = (one, side) => {
    const ratio = window.devicePixelRatio || 1;
    one.canvas.width = one.canvas.height = Math.round(side * ratio);
    one.canvas.style.width = one.canvas.style.height = side + "px";
    const pen = one.canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = "12px system-ui, sans-serif";
    return pen;
  };

  function drawSky(t) {
    const side = Math.min(sky.box.clientWidth - 8, 460), pen = pencil(sky, side), half = side / 2, radius = half - 34;
    const at = (azimuth, elevation) => {
      const r = radius * (1 - elevation / 90), a = azimuth * Math.PI / 180;
      return [half + r * Math.sin(a), half - r * Math.cos(a)];
    };
    const ring = (elevation, colour, dash) => {
      pen.strokeStyle = colour;
      pen.setLineDash(dash);
      pen.beginPath();
      pen.arc(half, half, radius * (1 - elevation / 90), 0, 2 * Math.PI);
      pen.stroke();
      pen.setLineDash([]);
    };
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (const elevation of [0, 30, 60]) ring(elevation, ink.line, []);
    ring(data.mask, ink.red, [4, 4]);
    pen.fillStyle = ink.soft;
    for (const elevation of [30, 60]) pen.fillText(elevation + "°", ...at(8, elevation - 4));
    pen.fillStyle = ink.ink;
    ["N", "E", "S", "W"].forEach((name, quarter) => pen.fillText(name, ...at(90 * quarter, -9)));
    const taken = [];
    for (const one of satellites) {
      pen.strokeStyle = pen.fillStyle = ink[colours[one.system]];
      pen.globalAlpha = chosen && chosen !== one ? 0.15 : 0.45;
      pen.lineWidth = chosen === one ? 3 : 1.2;
      pen.beginPath();
      let before = null;
      const last = after(one.time, view[1] + 1e-9);
      for (let i = after(one.time, view[0]); i < last; i++) {
        if (!(one.elevation[i] >= 0)) { before = null; continue; }
        const [px, py] = at(one.azimuth[i], one.elevation[i]);
        if (before !== null && one.bucket[i] - before === 1) pen.lineTo(px, py); else pen.moveTo(px, py);
        before = one.bucket[i];
      }
      pen.stroke();
      pen.globalAlpha = 1;
      const index = present(one, t);
      if (index < 0 || !(one.elevation[index] >= 0)) continue;
      const [px, py] = at(one.azimuth[index], one.elevation[index]), fate = one.fate[index];
      pen.beginPath();
      pen.arc(px, py, 5.5, 0, 2 * Math.PI);
      if (fate === 0) pen.fill(); else { pen.lineWidth = 1.5; pen.stroke(); }
      if (fate === 1 || fate === 2) {
        pen.strokeStyle = ink.red;
        pen.lineWidth = 3;
        pen.beginPath();
        pen.arc(px, py, 10, 0, 2 * Math.PI);
        pen.moveTo(px - 7, py - 7); pen.lineTo(px + 7, py + 7);
        pen.moveTo(px - 7, py + 7); pen.lineTo(px + 7, py - 7);
        pen.stroke();
      }
      taken.push([px, py, one.name]);
    }
    pen.lineWidth = 1;
    const boxes = taken.map(([px, py]) => [px - 7, py - 7, px + 7, py + 7]);
    pen.fillStyle = ink.ink;
    for (const [px, py, name] of taken) {
      const places = [[20, 0], [-20, 0], [0, -14], [0, 14], [17, -11], [17, 11], [-17, -11], [-17, 11]];
      const box = ([dx, dy]) => [px + dx - 13, py + dy - 6, px + dx + 13, py + dy + 6];
      const free = places.find((place) => {
        const [l, u, r, d] = box(place);
        return l > 0 && r < side && boxes.every(([a, b, c, e]) => r < a || l > c || d < b || u > e);
      });
      if (!free) continue;
      boxes.push(box(free));
      pen.fillText(name, px + free[0], py + free[1]);
    }
  }

  function drawTrack(t) {
    const side = Math.min(track.box.clientWidth - 8, 460), pen = pencil(track, side);
    const [first, last] = [after(time, view[0]), after(time, view[1] + 1e-9)];
    let [w, e, s, u] = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = first; i < last; i++) if (east[i] === east[i]) {
      w = Math.min(w, east[i]); e = Math.max(e, east[i]); s = Math.min(s, north[i]); u = Math.max(u, north[i]);
    }
    pen.fillStyle = ink.ink;
    if (w > e) {
      pen.textAlign = "center";
      pen.fillText("no position", side / 2, side / 2);
      return;
    }
    const size = Math.max(e - w, u - s, 0.5) * 1.1, left = 56, bottom = 40, room = side - left - 12;
    const [west, south] = [(w + e - size) / 2, (s + u - size) / 2];
    const px = (v) => left + (v - west) / size * room, py = (v) => 12 + room - (v - south) / size * room;
    pen.strokeStyle = ink.line;
    pen.beginPath();
    for (const v of even(west, west + size, side / 90)) {
      pen.moveTo(px(v), py(south)); pen.lineTo(px(v), 12);
      pen.textAlign = "center";
      pen.textBaseline = "top";
      pen.fillText(label(v), px(v), py(south) + 5);
    }
    for (const v of even(south, south + size, side / 70)) {
      pen.moveTo(left, py(v)); pen.lineTo(left + room, py(v));
      pen.textAlign = "right";
      pen.textBaseline = "middle";
      pen.fillText(label(v), left - 5, py(v));
    }
    pen.stroke();
    pen.textAlign = "center";
    pen.fillText("east / m", left + room / 2, side - 8);
    pen.save();
    pen.translate(9, 12 + room / 2);
    pen.rotate(-Math.PI / 2);
    pen.fillText("north / m", 0, 0);
    pen.restore();
    const drawn = new Set();
    for (const worst of [0, 1, 2]) {
      pen.fillStyle = pen.strokeStyle = ink[["green", "grey", "red"][worst]];
      pen.beginPath();
      for (let i = first; i < last; i++) if (severity[i] === worst && east[i] === east[i]) {
        const [a, b] = [Math.round(px(east[i])), Math.round(py(north[i]))], key = (a * 4096 + b) * 4 + worst;
        if (drawn.has(key)) continue;
        drawn.add(key);
        if (worst === 2) {
          pen.moveTo(a - 3, b - 3); pen.lineTo(a + 3, b + 3); pen.moveTo(a - 3, b + 3); pen.lineTo(a + 3, b - 3);
        } else pen.rect(a - 1.5, b - 1.5, 3, 3);
      }
      if (worst === 2) pen.stroke(); else pen.fill();
    }
    const index = nearest(time, t);
    if (cursor !== null && east[index] === east[index]) {
      pen.strokeStyle = ink.ink;
      pen.lineWidth = 2;
      pen.beginPath();
      pen.arc(px(east[index]), py(north[index]), 7, 0, 2 * Math.PI);
      pen.stroke();
    }
  }

  const HEADS = ["satellite", "azimuth / °", "elevation / °", "C/N0 / dB-Hz", "residual / m", "sigma / m", "w-test", "used",
    "reason"];
  function drawNow(t) {
    const place = document.getElementById("now");
    if (!place) return;
    place.textContent = "";
    place.appendChild(element("h3", "", `At ${stamp(t, 1)} ${data.scale}`));
    const body = place.appendChild(element("div", "wide")).appendChild(element("table"));
    const row = (cells, tag) => {
      const line = body.appendChild(element("tr"));
      cells.forEach((cell, index) =>
        line.appendChild(element(tag, index && index < 7 && tag === "td" ? "number" : "", cell)));
      return line;
    };
    row(HEADS, "th");
    for (const one of satellites) {
      const i = present(one, t);
      if (i < 0) continue;
      const fixed = (v, digits) => (v === v ? v.toFixed(digits) : "–");
      const line = row([one.name, fixed((one.azimuth[i] + 360) % 360, 0), fixed(one.elevation[i], 0), fixed(one.cn0.hi[i], 1),
        short(one.residual.hi[i]), short(one.sigma[i]), fixed(one.w[i], 1), one.fate[i] === 0 ? "yes" : "no",
        one.fate[i] === 0 ? "" : data.fates[one.fate[i]]], "td");
      if (one.fate[i] === 1 || one.fate[i] === 2) line.className = "alert";
      line.addEventListener("pointerenter", () => choose(one));
      line.addEventListener("pointerleave", () => choose(null));
    }
  }
  function choose(one) {
    chosen = one;
    for (const row of rows) if (row instanceof Crowd) row.draw();
    drawSky(cursor ?? view[1]);
  }

  let waiting = null;
  function places(t) {
    // One drawing for all moves of the pointer within a frame.
    const isFirst = waiting === null;
    waiting = t ?? view[1];
    if (isFirst) requestAnimationFrame(() => {
      const now = waiting;
      waiting = null;
      drawSky(now);
      drawTrack(now);
      drawNow(now);
    });
  }

  // ---- Page -------------------------------------------------------------------------------------------------------

  root.classList.add("live");
  readColours();
  const live = document.getElementById("live"), around = document.getElementById("sky");
  const bar = live.appendChild(element("p", "bar"));
  const span = bar.appendChild(element("span", "span"));
  const button = (text, act) => bar.appendChild(element("button", "", text)).addEventListener("click", act);
  const middle = () => (view[0] + view[1]) / 2, length = () => view[1] - view[0];
  button("whole", () => zoom(...whole));
  button("−", () => zoom(middle() - length(), middle() + length()));
  button("+", () => zoom(middle() - length() / 4, middle() + length() / 4));
  const shift = (by) => zoom(...(by < 0 ? [Math.max(view[0] + by, whole[0]), Math.max(view[0] + by, whole[0]) + length()]
    : [Math.min(view[1] + by, whole[1]) - length(), Math.min(view[1] + by, whole[1])]));
  button("◀", () => shift(-length() / 2));
  button("▶", () => shift(length() / 2));
  bar.appendChild(element("span", "hint", "Drag over a row to zoom all of them; double click for the whole."));
  const instantly = bar.appendChild(element("output", "instantly"));
  new States(live);
  const line = (name, colour, dash, values) => ({ name, colour, dash, values, steady: dash.length > 0 });
  const has = (one) => one.values.hi.some((v) => v === v);
  const chart = (title, unit, scale, lines, height) => {
    const known = lines.filter(has);
    if (known.length) new Chart(title, unit, scale, known, live, height);
  };
  const bounds = (level, limit, error) => [line("alert limit", "red", [7, 5], curve(limit)),
    line("protection level", "violet", [], curve(level)), line("error", "blue", [], curve(error))];
  // Lines of another receiver are behind the others.
  const beside = (which) => data.beside[which].map((one) => ({ ...line(one.name, "grey", [], single(Float32Array.from(one.v))),
    time: Float64Array.from(one.t) }));
  chart("HPL", "m", "log", [...beside(1), ...bounds("hpl", "hal", "he")]);
  chart("VPL", "m", "log", bounds("vpl", "val", "ve"));
  chart("Test statistic", "no unit", "linear",
    [...beside(0), line("threshold", "orange", [7, 5], curve("thr")), line("statistic", "blue", [], curve("stat"))]);
  chart("Satellites", "number", "linear",
    [line("used", "blue", [], single(Float32Array.from(used))), line("excluded", "orange", [2, 3], single(Float32Array.from(excluded)))], 120);
  if (satellites.length) {
    new Crowd("C/N0", "dB-Hz", "linear", (one) => one.cn0, live);
    new Crowd("Residuals", "m", "symmetric", (one) => one.residual, live);
  }
  chart("Receiver clock", "µs", "linear", [line("clock", "blue", [], single(clock))], 130);
  const sky = square("Satellites in the sky", around), track = square("Positions over the ground", around);
  const present_systems = [...new Set(satellites.map((one) => one.system))];
  sky.legend.innerHTML = present_systems.map((system) =>
    `<span class="entry"><svg width="14" height="12" aria-hidden="true"><circle cx="7" cy="6" r="5" fill="var(--${colours[system]})"/></svg>${names[system]}</span>`).join("") +
    '<span class="entry">○ not used</span><span class="entry">⊗ excluded</span>';
  track.legend.innerHTML = '<span class="entry">■ protected or unavailable</span><span class="entry">× alert</span>';
  for (const one of document.querySelectorAll("button[data-from]")) one.addEventListener("click", () => {
    const from = +one.dataset.from, to = Math.min(+one.dataset.to, from + 600);
    zoom(from - 30, Math.max(to, from) + 30);
    hover(from, rows[0], 0);
    live.scrollIntoView({ behavior: "smooth" });
  });
  const size = () => {
    width = rows[0].frame.clientWidth;
    for (const row of rows) row.draw();
    places(cursor);
  };
  // A page that hides the report leaves it no width, and a picture of no width has circles of a negative radius.
  const measure = () => { if (![0, width].includes(rows[0].frame.clientWidth)) size(); };
  new ResizeObserver(measure).observe(live);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readColours(); size(); }, { signal });
  width = rows[0].frame.clientWidth;
  zoom(...whole);
  root.dataset.ready = String(Math.round(performance.now()));
};
