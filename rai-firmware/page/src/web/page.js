// The page: files and ports in, the report and the live state out. It is part of this project and has its licence
// (MIT OR Apache-2.0); it uses no library, and asks nobody: its policy allows no request.
"use strict";
const page = async () => {
  const at = (id) => document.getElementById(id);
  const show = (id, is_shown) => { at(id).hidden = !is_shown; };
  let chosen = [], settings = [], outputs = {}, place = null, job = 0;

  // ---- Program ------------------------------------------------------------------------------------------------------

  const program = (async () => {
    const packed = Uint8Array.from(atob(at("program").textContent.trim()), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return new Response(stream).arrayBuffer();
  })();
  const source = URL.createObjectURL(new Blob([at("thread").textContent], { type: "text/javascript" }));
  // A thread that has read the program; the next one is made ready while the first one works.
  const thread = async (heard) => {
    const worker = new Worker(source);
    const ready = new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => (data.kind === "ready" ? resolve() : reject(new Error(data.trap)));
      worker.onerror = (event) => reject(new Error(event.message));
    });
    worker.postMessage({ kind: "load", bytes: await program });
    await ready;
    worker.onmessage = ({ data }) => heard(data);
    worker.onerror = (event) => heard({ kind: "failed", id: job, trap: event.message, error: "" });
    return worker;
  };
  let worker = thread((data) => receive(data));
  const questions = new Map();
  let asked = 0;
  const ask = async (words, { file, files = [] } = {}) => {
    const id = `question ${++asked}`;
    const answer = new Promise((resolve) => questions.set(id, resolve));
    (await worker).postMessage({ kind: "ask", id, words, file, files });
    return answer;
  };

  // ---- Words --------------------------------------------------------------------------------------------------------

  const problem = (text, is_trap) => {
    at("problem").textContent = text;
    show("problem", text !== "");
    show("offer", Boolean(is_trap && place));
  };
  const count = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;
  // The error of the program is one sentence behind "error:"; notes stand before it.
  const sentence = (error) => {
    const lines = error.split("\n").filter((line) => line.trim());
    const last = lines.findLast((line) => line.startsWith("error: ")) ?? lines.at(-1) ?? "";
    // What is an option on a computer is another file here.
    const text = last.replace(/^error: /, "").replaceAll(" by --nav", ", dropped beside it").replaceAll("with --nav", "beside it");
    // The name of a file keeps its letters.
    const begins = /^[a-z]+ /.test(text) ? text.charAt(0).toUpperCase() + text.slice(1) : text;
    return begins + (/[.?!]$/.test(begins) ? "" : ".");
  };

  // ---- Recording ----------------------------------------------------------------------------------------------------

  const options = () => {
    const all = [];
    for (const fault of at("inject").value.trim().split(/\s+/).filter(Boolean)) {
      all.push(fault.includes("/s@") ? ["--ramp", fault.replace("/s@", "@")] : ["--inject", fault]);
    }
    if (at("truth").value.trim()) all.push(["--truth", at("truth").value.trim().replace(/\s+/g, "")]);
    for (const setting of changed()) all.push(["--set", setting]);
    return all;
  };
  const unique = (files) => {
    // Those of the results are taken.
    const names = new Set(["sentences.nmea", "epochs.csv", "report"]);
    return files.map((file) => {
      // A name must not look like an option, an address or a folder.
      let name = file.name.replace(/[:/\\]/g, "_").replace(/^-/, "_");
      while (names.has(name)) name = `again-${name}`;
      names.add(name);
      return { name, file };
    });
  };
  const judge = async (files) => {
    chosen = files;
    if (!files.length) return;
    await stop();
    const id = ++job;
    problem("");
    clear();
    at("share").value = 0;
    at("counts").textContent = `reading ${files.map((file) => file.name).join(", ")}`;
    delete at("work").dataset.first;
    show("work", true);
    document.body.dataset.state = "working";
    (await worker).postMessage({ kind: "judge", id, files: unique(files), options: options() });
    at("work").dataset.since = String(performance.now());
  };
  // Ends the work, if there is some, and has a new thread ready.
  const cancel = async () => {
    if (at("work").hidden) return;
    job += 1;
    (await worker).terminate();
    worker = thread((data) => receive(data));
    show("work", false);
    document.body.dataset.state = "cancelled";
  };
  const stop = async () => {
    await cancel();
    await disconnect();
  };

  let shown = null;
  const clear = () => {
    shown?.abort();
    shown = null;
    document.documentElement.classList.remove("live");
    at("report").replaceChildren();
    show("result", false);
  };
  const verdict = (counts, plain) => {
    const all = counts.P + counts.A + counts.U;
    const [kind, sign, words] = counts.P === all && all > 0 ? ["good", "✓", "Trusted all the time"]
      : counts.P > 0 ? ["", "!", "Not trusted all the time"] : ["bad", "✗", "Never to be trusted"];
    at("verdict").className = kind;
    at("verdict").querySelector(".sign").textContent = sign;
    at("headline").textContent = words;
    at("plain").textContent = plain;
  };
  // Shows the report of the program: its body without its title, in this page's own style.
  const show_report = async (result) => {
    // The policy allows no style in a document, only by this script. A quote in a text is escaped, so that this is a tag's.
    const whole = await result.outputs.report.text();
    const text = whole.replace(/<style>[^<]*<\/style>/g, "").replaceAll(' style="', ' data-style="');
    const made = new DOMParser().parseFromString(text, "text/html");
    const main = made.querySelector("main");
    const plain = main.querySelector(".plain")?.textContent ?? "";
    for (const one of main.querySelectorAll("h1, .lead, .plain, script:not([type])")) one.remove();
    at("report").replaceChildren(...[...main.childNodes].map((one) => document.adoptNode(one)));
    for (const one of at("report").querySelectorAll("[data-style]")) one.style.cssText = one.dataset.style;
    const counts = tallied(result.out);
    verdict(counts, plain);
    at("notes").replaceChildren(...[...result.notes, ...notes(result.error)].map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }));
    at("line").textContent = at("report").querySelector(".facts tr:last-child td")?.textContent ?? "";
    show("result", true);
    shown = new AbortController();
    try {
      report(shown.signal);
    } catch (error) {
      document.documentElement.classList.remove("live");
      for (const id of ["live", "sky", "now"]) at(id)?.replaceChildren();
      console.error(error);
    }
  };
  const tallied = (out) => {
    const found = out.match(/protected (\d+), alerts (\d+), unavailable (\d+)/) ?? [0, 0, 0, 0];
    return { P: Number(found[1]), A: Number(found[2]), U: Number(found[3]) };
  };
  const notes = (error) => error.split("\n").filter((line) => line.startsWith("note: ")).map((line) => line.slice(6));

  const receive = async (data) => {
    if (data.kind === "answer") {
      questions.get(data.id)(data);
      questions.delete(data.id);
      return;
    }
    if (data.id !== job) return;
    if (data.kind === "progress") {
      at("share").value = data.share;
      if (!data.counts) return;
      const { P, A, U } = data.counts;
      if (!at("work").dataset.first) at("work").dataset.first = String(performance.now() - at("work").dataset.since);
      at("counts").textContent = `${count(P + A + U, "epoch")}: ${P} trusted, ${A} in alert, ${U} without a promise`;
      return;
    }
    show("work", false);
    place = data.place;
    at("work").dataset.took = String(performance.now() - at("work").dataset.since);
    at("work").dataset.memory = String(data.memory);
    if (data.kind === "done") {
      outputs = data.outputs;
      await show_report(data);
      at("verdict").focus({ preventScroll: true });
      at("verdict").scrollIntoView({ block: "nearest" });
    } else if (data.changed) {
      problem(`${data.changed} has changed since it was chosen, or cannot be read any more: choose it again.`);
    } else if (data.trap) {
      problem(`The program stopped, which it must not do (${data.trap}). The next file is judged by a new one. Please save the bytes around the place and report them.`, true);
      (await worker).terminate();
      worker = thread((more) => receive(more));
    } else problem(sentence(data.error));
    document.body.dataset.state = data.kind;
  };

  // ---- Settings -----------------------------------------------------------------------------------------------------

  const field = (one) => document.getElementById(`set-${one.key}`);
  const changed = () => settings.filter((one) => field(one).value.trim() && field(one).value.trim() !== one.start)
    .map((one) => `${one.key}=${field(one).value.trim().replace(/\s+/g, "")}`);
  const mark = () => {
    for (const one of settings) field(one).closest("tr").className = changed().some((text) => text.startsWith(`${one.key}=`)) ? "changed" : "";
    at("options").querySelector("summary").textContent = ["Settings and faults", ...[changed().length ? `${changed().length} changed` : ""]].filter(Boolean).join(": ");
  };
  const list_settings = (all) => {
    settings = all;
    at("settings").tBodies[0].replaceChildren(...all.map((one) => {
      const row = document.createElement("tr"), cells = [0, 1, 2].map(() => row.appendChild(document.createElement("td")));
      const label = cells[0].appendChild(document.createElement("label"));
      label.textContent = one.key;
      label.htmlFor = `set-${one.key}`;
      // A word, where one word is all of it, is chosen; everything else is written.
      const is_word = one.words.length > 1 && one.words.includes(one.start) && one.words.includes(one.example) && !one.ranges.length;
      const value = cells[1].appendChild(document.createElement(is_word ? "select" : "input"));
      value.id = `set-${one.key}`;
      if (is_word) {
        value.append(...one.words.map((word) => new Option(word, word, word === one.start, word === one.start)));
      } else {
        value.placeholder = one.start || "off";
        value.spellcheck = false;
      }
      const unit = one.unit ? ` ${one.unit}` : "";
      const range = one.ranges.length ? ` From ${one.ranges.join(", ")}${unit}.` : unit ? ` In${unit}.` : "";
      const words = one.words.length && !is_word ? ` Words: ${one.words.join(", ")}.` : "";
      cells[2].textContent = `${one.text.replace(/`|<[^>]*>/g, "")}.${range}${words} Such as ${one.example}.`;
      return row;
    }));
    mark();
  };
  at("form").addEventListener("change", () => {
    mark();
    if (chosen.length && at("now-live").hidden) judge(chosen);
  });
  at("form").addEventListener("submit", (event) => event.preventDefault());
  at("reset").addEventListener("click", () => {
    at("form").reset();
    mark();
    if (chosen.length && at("now-live").hidden) judge(chosen);
  });

  // ---- Input --------------------------------------------------------------------------------------------------------

  at("files").addEventListener("change", () => {
    judge([...at("files").files]);
    at("files").value = "";
  });
  const over = (is_over) => at("drop").classList.toggle("over", is_over);
  addEventListener("dragover", (event) => { event.preventDefault(); over(true); });
  addEventListener("dragleave", () => over(false));
  addEventListener("drop", (event) => {
    event.preventDefault();
    over(false);
    const items = [...(event.dataTransfer.items ?? [])].map((item) => item.webkitGetAsEntry?.());
    if (items.some((entry) => entry?.isDirectory)) return problem("That is a folder: drop the files in it.");
    judge([...event.dataTransfer.files]);
  });
  const sample = async (fault) => {
    const { code, file, error } = await ask(["page", "sample"], { file: "sample.rtcm3" });
    if (code) return problem(sentence(error));
    at("inject").value = fault;
    judge([new File([file], "sample.rtcm3")]);
  };
  at("sample").addEventListener("click", () => sample(""));
  at("faulty").addEventListener("click", () => sample("G06:+80@20..40"));
  at("cancel").addEventListener("click", cancel);

  // ---- Output -------------------------------------------------------------------------------------------------------

  const save = (blob, name) => {
    const link = document.createElement("a"), address = URL.createObjectURL(blob);
    [link.href, link.download] = [address, name];
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 60e3);
  };
  const base = () => (chosen[0]?.name ?? "rai").replace(/\.[^.]*$/, "");
  at("save-report").addEventListener("click", () => save(new Blob([outputs.report], { type: "text/html" }), `${base()}-report.html`));
  at("save-table").addEventListener("click", () => save(outputs.table, `${base()}.csv`));
  at("save-sentences").addEventListener("click", () => save(outputs.sentences, `${base()}.nmea`));
  at("print").addEventListener("click", () => print());
  at("around").addEventListener("click", () => {
    const file = chosen.find((one) => one.name === place.name) ?? chosen[0];
    save(file.slice(Math.max(0, place.at - (4 << 20)), place.at), `${base()}-around.bin`);
  });

  // ---- Receiver -----------------------------------------------------------------------------------------------------

  const steady = monotonic(), WIRES = { mosaic: ["COM1", "COM2", "COM3", "COM4", "USB1", "USB2"], ublox: ["UART1", "UART2", "USB"] };
  const SILENT_MS = 3500, INPUTS = ["lead", "open", "options"];
  let port = null, listener = null, screen = null, baud = 0, kept = null, record = null, heard = 0, beat = null;

  // The state of the module, as soon as it comes.
  const watch = (data) => {
    if (data.kind === "state") {
      heard = steady();
      screen?.view.take(data.state);
      document.body.dataset.live = data.state.state;
      if (data.came !== null) document.body.dataset.delay = String(steady() - data.came);
    } else if (data.kind === "contact") {
      document.body.dataset.memory = String(data.memory);
      if (data.rate !== baud) change(data.rate);
      else say_port(data.frames ? `${count(data.frames, "message")} at ${baud} bit/s` : `bytes at ${baud} bit/s, and no message yet`);
    } else if (data.kind === "refused" || data.kind === "trapped" || data.kind === "failed") {
      problem(data.kind === "refused" ? sentence(data.error) : `The module stopped, which it must not do: connect the receiver again (${data.error || data.trap}).`);
      disconnect();
    }
  };
  const say_port = (text) => { if (at("port").textContent !== text) at("port").textContent = text; };
  const change = (rate) => {
    baud = rate;
    say_port(`no message yet; trying ${baud} bit/s`);
    port?.reader?.cancel().catch(() => {});
  };
  // Reads a port until it is gone; opens it again at another rate.
  const read = async (mine) => {
    while (mine === port) {
      const opened = baud;
      await mine.port.open({ baudRate: opened, bufferSize: 1 << 16 });
      while (mine === port && mine.port.readable && opened === baud) {
        mine.reader = mine.port.readable.getReader();
        try {
          for (;;) {
            const { value, done } = await mine.reader.read();
            const came = steady();
            if (done) break;
            listener.postMessage({ kind: "bytes", bytes: value, came });
            if (record) keep(value);
          }
        } catch (error) {
          // A bit of the line was wrong, or the plug is out: then nothing is readable any more.
        } finally {
          mine.reader.releaseLock();
        }
      }
      const is_gone = !mine.port.readable;
      await mine.port.close().catch(() => {});
      if (is_gone) break;
    }
    if (mine === port) say_port("the receiver is unplugged: plug it in again");
  };
  const follow = (mine) => read(mine).catch((error) => mine === port && say_port(`the port does not open (${error.message}): does another program hold it?`));
  const connect = async () => {
    let wanted;
    try {
      wanted = await navigator.serial.requestPort();
    } catch (error) {
      // Nothing was chosen.
      return;
    }
    await stop();
    clear();
    problem("");
    const chosen_rate = at("rate").value;
    baud = chosen_rate === "AUTO" ? 115200 : Number(chosen_rate);
    at("live-view").replaceChildren(at("live-body").content.cloneNode(true));
    const end = new AbortController();
    screen = { end, view: live(end.signal) };
    show("now-live", true);
    for (const id of INPUTS) show(id, false);
    show("result", false);
    listener = await thread(watch);
    listener.postMessage({ kind: "live", name: "the receiver at this computer", rate: chosen_rate, settings: changed(), now: steady() });
    port = { port: wanted, reader: null };
    heard = steady();
    beat = setInterval(() => steady() - heard > SILENT_MS && heard && screen.view.lost(), 250);
    say_port(`waiting at ${baud} bit/s`);
    follow(port);
  };
  const disconnect = async () => {
    if (!port) return;
    const last = port;
    port = null;
    if (record) stop_record();
    clearInterval(beat);
    await last.reader?.cancel().catch(() => {});
    listener?.terminate();
    screen?.end.abort();
    [listener, screen] = [null, null];
    at("live-view").replaceChildren();
    show("now-live", false);
    for (const id of INPUTS) show(id, true);
  };
  const keep = (bytes) => {
    record.open.push(bytes);
    record.pending += bytes.length;
    if (record.pending > 1 << 20) {
      record.parts.push(new Blob(record.open));
      [record.open, record.pending] = [[], 0];
    }
  };
  const stop_record = () => {
    save(new Blob([...record.parts, ...record.open]), `receiver-${new Date().toISOString().replace(/[:.]/g, "-")}.bin`);
    record = null;
    at("record").textContent = "Record to a file";
  };
  at("record").addEventListener("click", () => {
    if (record) return stop_record();
    record = { parts: [], open: [], pending: 0 };
    at("record").textContent = "Stop, and save the file";
  });
  at("connect").addEventListener("click", connect);
  at("disconnect").addEventListener("click", disconnect);
  const frames = async () => {
    const { code, out, error } = await ask(["page", "steps", at("kind").value, at("wire").value]);
    kept = code ? [] : JSON.parse(out);
    at("steps").textContent = code ? sentence(error) : kept.map((one) => `${one.typed.trim()}   ${one.purpose}`).join("\n");
  };
  const wires = () => {
    const names = WIRES[at("kind").value.startsWith("mosaic") ? "mosaic" : "ublox"];
    at("wire").replaceChildren(...names.map((name) => new Option(name, name)));
    return frames();
  };
  at("kind").addEventListener("change", wires);
  at("wire").addEventListener("change", frames);
  at("configure").addEventListener("toggle", () => at("configure").open && kept === null && wires());
  at("send").addEventListener("click", async () => {
    const writer = port?.port.writable?.getWriter();
    if (!writer) return;
    try {
      for (const one of kept ?? []) {
        await writer.write(Uint8Array.from(one.bytes));
        // A receiver answers one command before it takes the next.
        await new Promise((resolve) => setTimeout(resolve, 150));
      }
    } finally {
      writer.releaseLock();
    }
    say_port(`${count(kept.length, "command")} sent`);
  });
  if ("serial" in navigator) {
    for (const rate of [9600, 38400, 57600, 115200, 230400, 460800, 921600]) at("rate").append(new Option(`${rate} bit/s`, rate));
    navigator.serial.addEventListener?.("connect", () => port && !port.port.readable && follow(port));
  } else {
    show("ports", false);
    show("watch", false);
    show("without", true);
  }
  // For tests: what the page has made.
  window.rai = { outputs: () => outputs, files: () => chosen, ask };
  const answer = await ask(["page", "settings"]);
  list_settings(JSON.parse(answer.out));
  document.body.dataset.ready = String(Math.round(performance.now()));
};
page().catch((error) => {
  const place = document.getElementById("problem");
  place.textContent = `This browser cannot run the page (${error.message}): Chromium, Edge or Firefox of the last two years can.`;
  place.hidden = false;
});
