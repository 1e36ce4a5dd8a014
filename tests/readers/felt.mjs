// Looks at a tool over the page's socket and prints what its force would do to a hand, N, every few milliseconds: with the
// package's watchdog, and as the page shows it. felt.mjs PORT TOOL PACKAGE PAGE WS

import { pathToFileURL } from "node:url";

const [port, tool, ...modules] = process.argv.slice(2);
const [bus, page, { default: WebSocket }] = await Promise.all(modules.map((path) => import(pathToFileURL(path))));
globalThis.WebSocket = WebSocket;
globalThis.location = { protocol: "http:", host: `127.0.0.1:${port}` };
globalThis.document = { hidden: true };
const size = ([x, y, z]) => Math.hypot(x, y, z);

const dog = new bus.Watchdog();
let newest = null;
const socket = new WebSocket(`ws://127.0.0.1:${port}/live`);
socket.binaryType = "arraybuffer";
socket.onerror = () => {};
socket.onmessage = ({ data }) => {
  const { key, payload } = page.openFrame(new Uint8Array(data));
  if (key !== `tool/${tool}/force`) return;
  newest = bus.decode(bus.ToolForce, payload);
  dog.heard();
};

const world = new page.World();
new page.Live(world, { mode: "live", token: null }).start();

setInterval(() => {
  const shown = world.tool(tool)?.force ?? [0, 0, 0];
  console.log(newest === null ? 0 : size(dog.felt(newest).force), size(shown));
}, 2);
process.on("uncaughtException", ({ message }) => console.error(message));
process.stdout.on("error", () => process.exit());
