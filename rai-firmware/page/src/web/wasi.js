// The system that the program sees: files by name, standard input and output, a clock (WASI, snapshot preview 1). It is
// part of this project and has its licence (MIT OR Apache-2.0); it uses no library. Files that were dropped are read
// piece by piece when the program asks, so that their size does not matter. Nothing else exists.
"use strict";
const [OK, BADF, EXIST, INVAL, IO, ISDIR, NOENT, NOSYS, NOTDIR] = [0, 8, 20, 28, 29, 31, 44, 52, 54];
const PIECE = 1 << 20, ROOT = 3, FOLDER = 3, FILE = 4;

class Exit extends Error {
  constructor(code) {
    super(`exit code ${code}`);
    this.code = code;
  }
}

// A file that grows. Its full pieces leave the memory of this thread.
class Written {
  constructor() {
    [this.parts, this.open, this.pending, this.size] = [[], [], 0, 0];
  }
  write(bytes) {
    this.open.push(bytes.slice());
    this.pending += bytes.length;
    this.size += bytes.length;
    if (this.pending >= PIECE) {
      this.parts.push(new Blob(this.open));
      [this.open, this.pending] = [[], 0];
    }
  }
  blob() {
    return new Blob([...this.parts, ...this.open]);
  }
}

// `files` are those of the page by name. `hooks` hear what the program reads and writes.
const system = (files, hooks) => {
  const folders = new Set(["."]), written = new Map(), open = new Map(), reader = new FileReaderSync();
  const encoder = new TextEncoder(), decoder = new TextDecoder();
  let memory = null, next = ROOT + 1, words = [], input = new Uint8Array();
  const view = () => new DataView(memory.buffer), bytes = (at, length) => new Uint8Array(memory.buffer, at, length);
  const text = (at, length) => decoder.decode(bytes(at, length)).replace(/^(\.\/)+|\/+$/g, "") || ".";
  const size = (name) => files.get(name)?.size ?? written.get(name)?.size;
  const kind = (name) => (folders.has(name) ? FOLDER : size(name) === undefined ? 0 : FILE);
  const put64 = (at, value) => view().setBigUint64(at, BigInt(value), true);
  const put32 = (at, value) => view().setUint32(at, value, true);
  const stat = (at, type, length) => {
    bytes(at, 64).fill(0);
    view().setUint8(at + 16, type);
    put64(at + 24, 1);
    put64(at + 32, length);
    return OK;
  };
  const vectors = (at, count) => Array.from({ length: count }, (_, index) =>
    bytes(view().getUint32(at + 8 * index, true), view().getUint32(at + 8 * index + 4, true)));
  const list = (at, buffer, all) => {
    for (const word of all) {
      const coded = encoder.encode(`${word}\0`);
      put32(at, buffer);
      bytes(buffer, coded.length).set(coded);
      [at, buffer] = [at + 4, buffer + coded.length];
    }
    return OK;
  };
  const sizes = (count, length, all) => {
    put32(count, all.length);
    put32(length, all.reduce((sum, word) => sum + encoder.encode(word).length + 1, 0));
    return OK;
  };
  // Returns the bytes of a file from a place on, as many as are at hand.
  const piece = (handle) => {
    const { file, held } = handle;
    if (held && handle.at >= held.from && handle.at < held.from + held.bytes.length) return held.bytes.subarray(handle.at - held.from);
    const end = Math.min(handle.at + PIECE, file.size);
    handle.held = { from: handle.at, bytes: new Uint8Array(reader.readAsArrayBuffer(file.slice(handle.at, end))) };
    return handle.held.bytes;
  };

  const calls = {
    args_sizes_get: (count, length) => sizes(count, length, words),
    args_get: (at, buffer) => list(at, buffer, words),
    environ_sizes_get: (count, length) => sizes(count, length, []),
    environ_get: () => OK,
    clock_time_get: (_, __, at) => {
      put64(at, Math.round((performance.timeOrigin + performance.now()) * 1e6));
      return OK;
    },
    random_get: (at, length) => {
      crypto.getRandomValues(bytes(at, length));
      return OK;
    },
    proc_exit: (code) => {
      throw new Exit(code);
    },
    sched_yield: () => OK,
    fd_prestat_get: (fd, at) => {
      if (fd !== ROOT) return BADF;
      put32(at, 0);
      put32(at + 4, 1);
      return OK;
    },
    fd_prestat_dir_name: (fd, at) => {
      bytes(at, 1)[0] = ".".charCodeAt(0);
      return OK;
    },
    fd_fdstat_get: (fd, at) => {
      bytes(at, 24).fill(0);
      view().setUint8(at, fd === ROOT ? FOLDER : fd < ROOT ? 0 : FILE);
      view().setBigUint64(at + 8, ~0n, true);
      view().setBigUint64(at + 16, ~0n, true);
      return OK;
    },
    fd_filestat_get: (fd, at) => {
      const handle = open.get(fd);
      if (fd === ROOT) return stat(at, FOLDER, 0);
      return handle ? stat(at, FILE, (handle.file ?? handle.sink).size) : stat(at, 0, 0);
    },
    path_filestat_get: (fd, _, at, length, into) => {
      const name = text(at, length);
      return kind(name) ? stat(into, kind(name), size(name) ?? 0) : NOENT;
    },
    path_create_directory: (fd, at, length) => {
      const name = text(at, length);
      if (kind(name)) return EXIST;
      folders.add(name);
      return OK;
    },
    path_open: (fd, _, at, length, flags, rights, inherited, modes, into) => {
      const name = text(at, length), [creates, wantsFolder, isNew, empties] = [1, 2, 4, 8].map((bit) => (flags & bit) !== 0);
      if (kind(name) === FOLDER || wantsFolder) return kind(name) === FOLDER ? ISDIR : NOTDIR;
      if (kind(name) && isNew) return EXIST;
      if (!kind(name) && !creates) return NOENT;
      if (files.has(name) && (creates || empties)) return EXIST;
      if (creates && (!written.has(name) || empties)) written.set(name, new Written());
      const sink = written.get(name);
      open.set(next, { name, at: 0, file: creates ? null : files.get(name) ?? sink.blob(), sink, total: 0 });
      put32(into, next++);
      return OK;
    },
    path_rename: (fd, from, fromLength, toFd, to, toLength) => {
      const [before, after] = [text(from, fromLength), text(to, toLength)];
      if (!written.has(before)) return NOENT;
      written.set(after, written.get(before));
      written.delete(before);
      return OK;
    },
    path_unlink_file: (fd, at, length) => (written.delete(text(at, length)) ? OK : NOENT),
    fd_close: (fd) => (open.delete(fd) ? OK : BADF),
    fd_seek: (fd, offset, whence, into) => {
      const handle = open.get(fd);
      if (!handle?.file) return INVAL;
      const from = [0, handle.at, handle.file.size][whence];
      handle.at = Math.max(0, from + Number(offset));
      put64(into, handle.at);
      return OK;
    },
    fd_read: (fd, at, count, into) => {
      const handle = open.get(fd);
      if (fd !== 0 && !handle?.file) return BADF;
      let sum = 0;
      for (const room of vectors(at, count)) {
        let ahead;
        try {
          ahead = fd === 0 ? input : piece(handle);
        } catch (error) {
          hooks.failed?.(handle.name, error);
          return IO;
        }
        const taken = ahead.subarray(0, room.length);
        room.set(taken);
        sum += taken.length;
        if (fd === 0) input = input.subarray(taken.length);
        else {
          handle.at += taken.length;
          hooks.read?.(handle.name, handle.at);
        }
        if (taken.length < room.length) break;
      }
      put32(into, sum);
      return OK;
    },
    fd_write: (fd, at, count, into) => {
      const handle = open.get(fd);
      if (fd !== 1 && fd !== 2 && !handle?.sink) return BADF;
      let sum = 0;
      for (const one of vectors(at, count)) {
        if (fd < ROOT) hooks.said?.(fd, one.slice());
        else {
          handle.sink.write(one);
          hooks.wrote?.(handle.name, one);
        }
        sum += one.length;
      }
      put32(into, sum);
      return OK;
    },
  };
  const imports = { wasi_snapshot_preview1: new Proxy(calls, { get: (all, name) => all[name] ?? (() => NOSYS) }) };
  return {
    start(program) {
      const instance = new WebAssembly.Instance(program, imports);
      memory = instance.exports.memory;
      instance.exports._initialize?.();
      return instance.exports;
    },
    // The words of the command line, before `start`; standard input, before a call.
    say: (line) => { words = line; },
    feed: (more) => { input = more; },
    written: (name) => written.get(name)?.blob(),
    bytesOfMemory: () => memory?.buffer.byteLength ?? 0,
  };
};
