// A small daemon for tests of the page: its routes, its socket and a body that gives way like a spring. No Rust needed.

import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { WebSocketServer } from "ws";
import * as bus from "../dist/palpate.js";
import { callOf, frame, ofCall, ofText, openFrame, textOf } from "../dist/page.js";
import { ballOutline, forceOf, nodesFrame, snapshotOf, statusOf, twoCells } from "./scenes.mjs";

const PAGE = new URL("../../../src/viewer/page/", import.meta.url);
const TYPES = { "index.html": "text/html; charset=utf-8", "app.js": "text/javascript; charset=utf-8", "app.css": "text/css; charset=utf-8" };
const POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; frame-ancestors 'none'";
const STIFFNESS_N_M = 1000;

export class Mock {
  scene = snapshotOf();
  mode = "live";
  /** What everybody on the network reaches. */
  open = [];
  token = "secret";
  recordings = [];
  files = new Map();
  /** What is inside bodies: two cells of unlike materials. */
  inside = [twoCells("drop")];
  /** What pages said: [key, payload]. */
  said = [];
  holders = new Map();
  paused = false;
  recorder = "Off";
  tick = 1000n;
  events = 0n;
  sockets = new Set();
  poses = new Map();

  async start(port = 0) {
    this.server = createServer((request, response) => this.answer(request, response));
    this.ws = new WebSocketServer({ server: this.server, path: "/live" });
    this.ws.on("connection", (socket) => this.connect(socket));
    await new Promise((resolve) => this.server.listen(port, "127.0.0.1", resolve));
    this.port = this.server.address().port;
    this.timer = setInterval(() => this.step(), 16);
    this.statusTimer = setInterval(() => this.toAll("status", bus.encode(bus.LoopStatus, this.status())), 100);
    return this;
  }

  get url() {
    return `http://127.0.0.1:${this.port}/`;
  }

  async stop() {
    clearInterval(this.timer);
    clearInterval(this.statusTimer);
    for (const socket of this.sockets) socket.terminate();
    this.sockets.clear();
    this.holders.clear();
    this.ws.close();
    this.server.closeAllConnections();
    await new Promise((resolve) => this.server.close(resolve));
  }

  answer(request, response) {
    const path = new URL(request.url, "http://x").pathname;
    const send = (type, body, more = {}) => response.writeHead(200, { "Content-Type": type, "Content-Security-Policy": POLICY, ...more }).end(body);
    const name = path === "/" ? "index.html" : path.slice(1);
    if (name in TYPES) return send(TYPES[name], readFileSync(new URL(name, PAGE)));
    if (path === "/session.json") {
      return send("application/json", JSON.stringify({ mode: this.mode, instance: "default", version: "mock", token: this.token, recordings: this.recordings, instances: ["default"], open: this.open }));
    }
    if (path === "/tools.json") return send("application/json", JSON.stringify(this.scene.tools.map(({ id, radius }) => ballOutline(id, radius || 0.01))));
    if (path === "/inside.json") return send("application/json", JSON.stringify(this.inside));
    const file = this.files.get(path);
    if (file === undefined) return response.writeHead(404).end();
    const range = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? "");
    if (range === null) return send("application/octet-stream", file);
    const [from, to] = [Number(range[1]), Math.min(Number(range[2]), file.length - 1)];
    response.writeHead(206, { "Content-Range": `bytes ${from}-${to}/${file.length}`, "Content-Type": "application/octet-stream" }).end(file.subarray(from, to + 1));
  }

  status() {
    return statusOf(this.tick, this.scene.tools.map(({ id }) => id), this.paused ? "Paused" : "Running", this.recorder);
  }

  connect(socket) {
    this.sockets.add(socket);
    socket.may = false;
    socket.held = new Set();
    const send = (key, payload) => socket.send(frame(key, payload));
    send("scene", bus.encode(bus.SceneSnapshot, this.scene));
    send("holders", ofText(JSON.stringify(this.holderList())));
    send("status", bus.encode(bus.LoopStatus, this.status()));
    socket.on("message", (data) => {
      const { key, payload } = openFrame(new Uint8Array(data));
      this.said.push([key, payload]);
      this.hear(socket, key, payload, send);
    });
    socket.on("close", () => {
      this.sockets.delete(socket);
      for (const tool of socket.held) this.holders.delete(tool);
      this.tellHolders();
    });
  }

  holderList() {
    return Object.fromEntries(this.scene.tools.map(({ id }) => [id, this.holders.get(id) ?? null]));
  }

  tellHolders() {
    this.toAll("holders", ofText(JSON.stringify(this.holderList())));
  }

  hear(socket, key, payload, send) {
    const refuse = (error) => send("refused", ofText(JSON.stringify({ key, error })));
    if (key === "inside") {
      // A cell around the first body, its nodes a millimetre from where they rest.
      if (payload[0] === 1) for (const { id, nodes } of this.inside) this.toAll(`body/${id}/nodes`, nodesFrame(this.tick, nodes.map((x) => x + 1e-3)));
      return;
    }
    if (key === "token") return (socket.may = textOf(payload) === this.token);
    if (!socket.may) return refuse("this page may only look");
    const [kind, id, part] = key.split("/");
    if (kind === "rpc") return this.rpc(id, callOf(payload), send);
    if (part === "device") {
      const holder = this.holders.get(id);
      if (holder !== undefined && !socket.held.has(id)) return refuse(`${id} is held by ${holder}`);
      socket.held.add(id);
      this.holders.set(id, bus.decode(bus.DeviceInfo, payload).name);
      this.tellHolders();
    } else if (part === "release") {
      socket.held.delete(id);
      this.holders.delete(id);
      this.poses.delete(id);
      this.tellHolders();
    } else if (part === "pose") {
      this.poses.set(id, bus.decode(bus.ToolPose, payload));
      this.press(id);
    }
  }

  rpc(method, { id, json }, send) {
    const args = JSON.parse(json || "{}");
    let answer = { ok: true, tick: Number(this.tick) };
    if (method === "pause") this.paused = true;
    else if (method === "resume") this.paused = false;
    else if (method === "step" && this.paused) this.tick += BigInt(args.ticks ?? 1);
    else if (method === "record_start") [this.recorder, answer] = ["Recording", { ...answer, path: "a.mcap" }];
    else if (method === "record_stop") [this.recorder, answer] = ["Off", { ...answer, path: "a.mcap" }];
    else if (method === "snapshot") answer = { ok: false, error: "nothing is kept in memory: start with --ring" };
    else if (method !== "reset") answer = { ok: false, error: `no method ${method}` };
    send("rpc", ofCall(id, JSON.stringify(answer)));
  }

  toAll(key, payload) {
    const bytes = frame(key, payload);
    for (const socket of this.sockets) if (socket.readyState === 1) socket.send(bytes);
  }

  event(kind) {
    this.events += 1n;
    this.toAll("event", bus.encode(bus.SimEvent, { tick: this.tick, seq: this.events, t_ns: 0n, kind }));
  }

  setScene(scene) {
    this.scene = scene;
    this.toAll("scene", bus.encode(bus.SceneSnapshot, scene));
    this.tellHolders();
  }

  net(body, points, more = {}) {
    this.toAll(`body/${body.id}/net`, bus.encode(bus.ControlNet, {
      tick: this.tick, revision: this.tick, body: body.id, degree_u: body.degree[0], degree_v: body.degree[1],
      count_u: body.count[0], count_v: body.count[1], points, weights: null, ...more,
    }));
  }

  step() {
    if (!this.paused) this.tick += 16n;
  }

  /** The first body is a cylinder of springs about its middle: good enough to be pushed. */
  press(id) {
    const pose = this.poses.get(id);
    const [body] = this.scene.bodies;
    if (body === undefined || pose === undefined) return;
    const [x, y, z] = pose.position;
    let surface = 0;
    for (let k = 0; k < body.rest_points.length; k += 3) {
      const p = body.rest_points.subarray(k, k + 3);
      if (Math.abs(p[2] - z) < 0.012) surface = Math.max(surface, Math.hypot(p[0], p[1]) * 0.9);
    }
    const away = Math.hypot(x, y) || 1e-9;
    const depth = Math.max(0, surface + 0.01 - away);
    const out = [x / away, y / away, 0];
    const size = Math.min(STIFFNESS_N_M * depth, 8);
    const proxy = [x + out[0] * depth * 0.7, y + out[1] * depth * 0.7, z];
    const force = { ...forceOf(this.tick, out.map((c) => c * size), proxy, depth), pose_seq: pose.seq, t_client_ns: pose.t_client_ns };
    this.toAll(`tool/${id}/force`, bus.encode(bus.ToolForce, force));
    if (depth > 0 || this.dented) {
      this.dented = depth > 0;
      const points = body.rest_points.map((value, k) => {
        const p = body.rest_points.subarray(k - (k % 3), k - (k % 3) + 3);
        const near = Math.exp(-((p[0] - proxy[0]) ** 2 + (p[1] - proxy[1]) ** 2 + (p[2] - z) ** 2) / 0.0004);
        return value - out[k % 3] * depth * near;
      });
      this.net(body, points);
    }
    const contacts = depth > 0 ? [{ tool: id, body: body.id, u: 0.5, v: 0.5, point: [proxy[0] - out[0] * 0.01, proxy[1] - out[1] * 0.01, z], normal: out, depth, force: out.map((c) => c * size) }] : [];
    this.toAll("contact", bus.encode(bus.ContactSet, { tick: this.tick, contacts }));
  }
}
