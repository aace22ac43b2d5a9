// The thread that judges: one recording after another, or the bytes of a port. The page ends it to cancel.
"use strict";
const SENTENCES = "sentences.nmea", OUTPUTS = { report: "report/report.html", table: "epochs.csv", sentences: SENTENCES };
const EVERY_MS = 100, TICK_MS = 100;
let program = null, live = null;

const decode = (parts) => {
  const decoder = new TextDecoder();
  return parts.map((part) => decoder.decode(part, { stream: true })).join("") + decoder.decode();
};

// Runs one command; returns what it said and its files.
const run = (words, files, hooks = {}) => {
  const said = [[], [], []];
  const own = system(files, { said: (fd, bytes) => said[fd].push(bytes), ...hooks });
  own.say(words);
  let code = 0, trap = null;
  try {
    code = own.start(program).run();
  } catch (error) {
    if (error instanceof Exit) code = error.code;
    else [code, trap] = [1, String(error)];
  }
  return { code, trap, out: decode(said[1]), error: decode(said[2]), written: own.written, memory: own.bytesOfMemory() };
};

// Counts the verdicts of the sentences while they are written.
const tally = (post) => {
  const counts = { P: 0, A: 0, U: 0 };
  let rest = "", told = 0;
  const decoder = new TextDecoder();
  return (bytes) => {
    const lines = (rest + decoder.decode(bytes, { stream: true })).split("\n");
    rest = lines.pop();
    let last = null;
    for (const line of lines) {
      if (!line.startsWith("$PRAIS,")) continue;
      last = line.split(",");
      counts[last[2]] = (counts[last[2]] ?? 0) + 1;
    }
    const now = performance.now();
    if (last && now - told > EVERY_MS) {
      told = now;
      post({ counts: { ...counts }, state: last[2], reason: last[3] });
    }
  };
};

const judge = ({ id, files: given, options }) => {
  const files = new Map(given.map(({ name, file }) => [name, file])), names = [...files.keys()];
  const post = (message) => postMessage({ id, ...message });
  const total = given.reduce((sum, { file }) => sum + file.size, 0) || 1, read = new Map();
  let place = null, changed = null, told = 0;
  const failed = (name) => { changed = name; };
  const arranged = run(["page", "arrange", ...names], files, { read: (name, at) => { place = { name, at }; }, failed });
  if (arranged.code) return post({ kind: "failed", error: arranged.error, trap: arranged.trap, memory: arranged.memory, place, changed });
  const { arguments: words, notes } = JSON.parse(arranged.out);
  const progress = (more) => {
    told = performance.now();
    const done = [...read.values()].reduce((sum, bytes) => sum + bytes, 0);
    post({ kind: "progress", share: Math.min(1, done / total), ...more });
  };
  const count = tally(progress);
  const options_ = options.flatMap(([name, value]) => [name, value]);
  const line = ["rai", "replay", ...words, ...options_, "--report", "report", "--csv", OUTPUTS.table, "--nmea", SENTENCES];
  const result = run(line, files, {
    read: (name, at) => {
      read.set(name, Math.max(read.get(name) ?? 0, at));
      place = { name, at };
      if (performance.now() - told > EVERY_MS) progress();
    },
    wrote: (name, bytes) => name === SENTENCES && count(bytes),
    failed,
  });
  const outputs = Object.fromEntries(Object.entries(OUTPUTS).map(([key, name]) => [key, result.written(name)]));
  post({ kind: result.code ? "failed" : "done", line, notes, place, changed, outputs, ...result, written: undefined });
};

// ---- Live -------------------------------------------------------------------------------------------------------------

const begin = ({ name, rate, settings, now }) => {
  let said = [], last = now;
  const passed = monotonic(), time = () => { last = Math.max(last, now + passed()); return last; };
  const own = system(new Map(), { said: (fd, bytes) => said.push([fd, bytes]) });
  own.say(["page", "live", name, rate, ...settings]);
  const exports = own.start(program);
  const texts = (wanted) => decode(said.filter(([fd]) => fd === wanted).map(([, bytes]) => bytes));
  const tell = (came) => {
    for (const line of texts(1).split("\n").filter(Boolean)) postMessage({ kind: "state", state: JSON.parse(line), came });
    said = [];
  };
  const guarded = (act) => {
    try {
      act();
    } catch (error) {
      clearInterval(live.timer);
      live = null;
      postMessage({ kind: "trapped", error: `${error} ${texts(2)}` });
    }
  };
  if (exports.run() !== 0) return postMessage({ kind: "refused", error: texts(2) });
  tell(null);
  live = {
    receive: (bytes, came) => guarded(() => {
      last = Math.max(last, came);
      own.feed(bytes);
      exports.receive(last);
      tell(came);
      postMessage({ kind: "contact", frames: exports.frames(), rate: exports.rate(), memory: own.bytesOfMemory() });
    }),
    timer: setInterval(() => guarded(() => {
      exports.tick(time());
      tell(null);
    }), TICK_MS),
  };
};

onmessage = ({ data }) => {
  try {
    if (data.kind === "load") {
      program = new WebAssembly.Module(data.bytes);
      postMessage({ kind: "ready" });
    } else if (data.kind === "ask") {
      const files = new Map(data.files.map(({ name, file }) => [name, file]));
      const { code, trap, out, error, written, memory } = run(data.words, files);
      postMessage({ kind: "answer", id: data.id, code, trap, out, error, memory, file: data.file && written(data.file) });
    } else if (data.kind === "judge") judge(data);
    else if (data.kind === "live") begin(data);
    else if (data.kind === "bytes") live?.receive(data.bytes, data.came);
  } catch (error) {
    postMessage({ kind: "failed", id: data.id, trap: String(error), error: "" });
  }
};
