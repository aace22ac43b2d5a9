// Script of a page that shows a running module. It is part of this project and has its licence (MIT OR Apache-2.0); it
// uses no library.
"use strict";
// A page that shows something else later gives a signal, which ends what this one listens to.
const live = (signal) => {
  const at = (id) => document.getElementById(id);
  const PAST = 600;
  let past = [], changes = [], last = null;

  const svg = (name, attributes, text) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };
  const cell = (text, name) => {
    const element = document.createElement("td");
    element.textContent = text;
    if (name) element.className = name;
    return element;
  };
  const number = (value, digits) => (value === null || value === undefined ? "–" : value.toFixed(digits));
  const clock = (seconds) => {
    if (seconds === null || seconds === undefined) return "–";
    const two = (value) => String(Math.floor(value)).padStart(2, "0");
    return [seconds / 3600, (seconds / 60) % 60, seconds % 60].map(two).join(":");
  };

  // ---- Verdict ------------------------------------------------------------------------------------------------------

  const banner = (word, why, pin) => {
    at("banner").className = word === "protected" || word === "alert" ? word : "unavailable";
    at("state").textContent = word;
    at("why").textContent = why;
    at("pin").textContent = pin;
    document.title = `${word} – RAI`;
  };
  const figures = (now) => {
    const of = (level, limit) => (limit === null ? `${number(level, 1)} m` : `${number(level, 1)} of ${number(limit, 0)} m`);
    const place = now.latitude_deg === null ? "–" : `${number(now.latitude_deg, 5)}°, ${number(now.longitude_deg, 5)}°`;
    const all = [
      ["HPL", of(now.hpl_m, now.hal_m)], ["VPL", of(now.vpl_m, now.val_m)],
      ["satellites used of tracked", `${now.used ?? "–"} of ${now.tracked ?? "–"}`],
      ["statistic of threshold", `${number(now.statistic, 2)} of ${number(now.threshold, 2)}`],
      ["excluded", (now.excluded || []).join(" ") || "none"], ["position", place], ["UTC", clock(now.utc_s)],
    ];
    at("figures").replaceChildren(...all.map(([name, value]) => {
      const box = document.createElement("div"), dd = document.createElement("dd"), dt = document.createElement("dt");
      dd.textContent = value;
      dt.textContent = name;
      box.append(dd, dt);
      return box;
    }));
  };

  // ---- Levels -------------------------------------------------------------------------------------------------------

  const levels = (now) => {
    const picture = at("levels"), width = picture.clientWidth || 340, height = 220, left = 44, bottom = 18;
    const values = past.flatMap((one) => [one[3], one[4]]).filter((value) => value !== null && value > 0);
    const limits = [now.hal_m, now.val_m].filter((value) => value !== null);
    const all = values.concat(limits);
    const parts = [];
    if (all.length > 0) {
      const low = Math.log10(Math.min(...all) / 1.5), high = Math.log10(Math.max(...all) * 1.5);
      const y = (value) => 4 + (height - bottom - 4) * (1 - (Math.log10(value) - low) / Math.max(high - low, 0.1));
      const step = (width - left - 4) / Math.max(past.length, 60);
      const x = (index) => left + step * (index + 0.5);
      past.forEach((one, index) => {
        if (one[2] === "P") return;
        const name = one[2] === "A" ? "alert-bar" : "unavailable-bar";
        parts.push(svg("rect", { class: name, x: x(index) - step / 2, y: 4, width: step + 0.5, height: height - bottom - 4 }));
      });
      for (let power = Math.ceil(low); power <= Math.floor(high); power++) {
        const value = 10 ** power;
        parts.push(svg("line", { class: "grid", x1: left, x2: width - 4, y1: y(value), y2: y(value) }));
        parts.push(svg("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, `${value} m`));
      }
      for (const limit of limits) {
        parts.push(svg("line", { class: "limit-line", x1: left, x2: width - 4, y1: y(limit), y2: y(limit) }));
      }
      for (const [column, name] of [[3, "hpl-line"], [4, "vpl-line"]]) {
        let path = "", is_down = false;
        past.forEach((one, index) => {
          const value = one[column];
          if (value === null || value <= 0) { is_down = false; return; }
          path += `${is_down ? "L" : "M"}${x(index).toFixed(1)},${y(value).toFixed(1)}`;
          is_down = true;
        });
        if (path) parts.push(svg("path", { class: name, d: path }));
      }
      if (past.length > 1) {
        parts.push(svg("text", { x: left, y: height - 4 }, clock(past[0][1])));
        const end = Math.max(x(past.length - 1), left + 110);
        parts.push(svg("text", { x: end, y: height - 4, "text-anchor": "end" }, clock(past[past.length - 1][1])));
      }
    }
    picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    picture.replaceChildren(...parts);
  };

  // ---- Sky ----------------------------------------------------------------------------------------------------------

  const sky = (now) => {
    const parts = [], middle = 170, radius = 140;
    for (const elevation of [0, 30, 60]) {
      parts.push(svg("circle", { class: "grid", cx: middle, cy: middle, r: radius * (1 - elevation / 90) }));
    }
    for (const [text, x, y] of [["N", 170, 18], ["E", 326, 174], ["S", 170, 334], ["W", 14, 174]]) {
      parts.push(svg("text", { x, y, "text-anchor": "middle" }, text));
    }
    const rows = [];
    for (const one of now.satellites) {
      const kind = one.fate === "used" ? "used" : one.fate.startsWith("excluded") ? "excluded" : "";
      if (one.azimuth_deg !== null && one.elevation_deg !== null && one.elevation_deg >= 0) {
        const angle = one.azimuth_deg * Math.PI / 180, away = radius * (1 - one.elevation_deg / 90);
        const x = middle + away * Math.sin(angle), y = middle - away * Math.cos(angle);
        parts.push(svg("circle", { class: `body ${kind}`, cx: x, cy: y, r: 5 }));
        parts.push(svg("text", { x: x + 7, y: y + 4 }, one.name));
      }
      const row = document.createElement("tr");
      row.append(cell(one.name), cell(number(one.elevation_deg, 0), "number"), cell(number(one.cn0_dbhz, 0), "number"),
        cell(number(one.residual_m, 1), "number"), cell(one.fate));
      if (kind === "excluded") row.className = "alert";
      rows.push(row);
    }
    at("sky").replaceChildren(...parts);
    at("satellites").tBodies[0].replaceChildren(...rows);
  };

  const history = () => {
    const rows = changes.slice(-50).reverse().map(([time, word, reason]) => {
      const row = document.createElement("tr");
      row.append(cell(clock(time)), cell(word), cell(reason));
      if (word === "alert") row.className = "alert";
      return row;
    });
    at("changes").tBodies[0].replaceChildren(...rows);
  };

  // ---- Events -------------------------------------------------------------------------------------------------------

  const LETTERS = { protected: "P", alert: "A", unavailable: "U" };
  const take = (now) => {
    const words = now.explanation ? `${now.reason} – ${now.explanation}` : now.reason;
    // The verdict comes first: nothing below may delay it.
    banner(now.state, words, `integrity pin ${now.pin ? "high" : "low"}`);
    const is_new = last === null || last.verdicts !== now.verdicts;
    if (is_new && last !== null) {
      past.push([now.verdicts, now.utc_s, LETTERS[now.state], now.hpl_m, now.vpl_m, now.statistic, now.threshold]);
      past = past.slice(-PAST);
      if (last.state !== now.state || last.reason !== now.reason) {
        changes.push([now.utc_s, now.state, now.reason]);
        history();
      }
    }
    last = now;
    figures(now);
    levels(now);
    sky(now);
    const settings = now.settings.length ? `settings ${now.settings.join(" ")}` : "settings as at start";
    at("source").textContent = `${now.input}; ${settings}`;
    if (at("version")) at("version").textContent = `· rai ${now.version}`;
  };
  const lost = () => {
    banner("no connection", "the module does not answer: its last verdict is of the past", "");
  };
  const begin = (before) => {
    [past, changes, last] = [before.past, before.changes, null];
    history();
  };
  addEventListener("resize", () => last && levels(last), { signal });
  return { begin, take, lost };
};
