// Programs of others on the page's server; packages are in the folder PALPATE_NODE.
//
//   live_peers.mjs foxglove URL    @foxglove/ws-protocol: channels, and messages of each; ends when every
//                                  channel had one; prints {topic: bytes}
//   live_peers.mjs roslib URL      roslib presses the ball and hears forces; prints the largest

import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const require = createRequire(`${process.env.PALPATE_NODE}/package.json`);
const WebSocket = require("ws");
const [what, url] = process.argv.slice(2);

const giveUp = setTimeout(() => {
  console.error("nothing came in a minute");
  process.exit(1);
}, 60_000);

function done(found) {
  clearTimeout(giveUp);
  console.log(JSON.stringify(found));
  process.exit(0);
}

async function foxglove() {
  const { FoxgloveClient } = require("@foxglove/ws-protocol");
  const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  const topics = new Map();
  const found = {};
  client.on("error", (error) => {
    console.error(error);
    process.exit(1);
  });
  client.on("status", (status) => console.error(JSON.stringify(status)));
  client.on("advertise", (channels) => {
    for (const channel of channels) {
      topics.set(client.subscribe(channel.id), channel.topic);
    }
  });
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    if (timestamp < 1_600_000_000_000_000_000n) {
      throw new Error(`time ${timestamp}`);
    }
    found[topics.get(subscriptionId)] = data.byteLength;
    if (Object.keys(found).length === topics.size) {
      done(found);
    }
  });
}

async function roslib() {
  globalThis.WebSocket ??= WebSocket;
  const { Ros, Topic, Service } = await import(pathToFileURL(`${process.env.PALPATE_NODE}/roslib/dist/RosLib.js`));
  const ros = new Ros({ url });
  await new Promise((resolve, reject) => {
    ros.on("connection", resolve);
    ros.on("error", reject);
  });
  const poses = new Topic({ ros, name: "/arm/measured_cp", messageType: "geometry_msgs/PoseStamped" });
  const forces = new Topic({ ros, name: "/arm/body/servo_cf", messageType: "geometry_msgs/WrenchStamped" });
  let peak = 0;
  forces.subscribe((message) => {
    peak = Math.max(peak, message.wrench.force.x);
  });
  const orientation = { x: 0, y: 0, z: 0, w: 1 };
  const begun = Date.now();
  // From outside, again for as long as nothing is felt: inside the body it would feel nothing.
  let coming = 0;
  while (peak < 0.5 || Date.now() - begun < 500) {
    coming = peak > 0 ? Math.min(coming + 1, 20) : (coming + 1) % 250;
    const position = { x: 0.0255 + 0.0105 * (1 - Math.min(1, coming / 20)), y: 0.003, z: 0.045 };
    poses.publish({ header: { frame_id: "world" }, pose: { position, orientation } });
    await new Promise((resolve) => setTimeout(resolve, 2));
  }
  const reset = new Service({ ros, name: "/palpate/reset", serviceType: "std_srvs/Trigger" });
  const answer = await new Promise((resolve, reject) => reset.callService({}, resolve, reject));
  done({ peak, answer });
}

await { foxglove, roslib }[what]();
