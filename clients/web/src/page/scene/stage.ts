/**
 * The stage: renderer, camera, lights, ground. It knows nothing of bodies.
 *
 * A picture is drawn when somebody asked for one, not sixty times a second for nothing. Where drawing is slow (software
 * rendering, an old laptop) shadows and fine pixels are given up, so that the hand still feels in time.
 */

import {
  AmbientLight, Color, DirectionalLight, DoubleSide, Group, HemisphereLight, Mesh, NoToneMapping,
  PCFShadowMap, PerspectiveCamera, PlaneGeometry, Plane, Scene, ShaderMaterial, ShadowMaterial, Vector2, Vector3,
  WebGLRenderer, MOUSE, TOUCH,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Vec3 } from "../geometry";
import { niceAbove } from "../units";
import { drawsInSoftware } from "./software";

export interface Palette {
  readonly grid: string;
  readonly light: boolean;
}

/** Slower pictures than this, in the mean, give up shadows and fine pixels, ms. */
const SLOW_MS = 28;

/** Pixels of a coarse picture, and how long after the last one it is drawn sharp. */
const COARSE = 0.55;
const STILL_MS = 180;

const GRID_VERTEX = `
varying vec2 place;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  place = world.xy;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

// Lines as wide as a pixel at any distance, fading out away from the middle.
const GRID_FRAGMENT = `
varying vec2 place;
uniform vec3 colour;
uniform vec2 middle;
uniform float cell, reach;
float lines(float size) {
  vec2 at = place / size;
  vec2 near = abs(fract(at - 0.5) - 0.5) / max(fwidth(at), vec2(1e-6));
  return 1.0 - min(min(near.x, near.y), 1.0);
}
void main() {
  float fade = 1.0 - smoothstep(0.25 * reach, reach, length(place - middle));
  float alpha = max(0.22 * lines(cell), 0.5 * lines(10.0 * cell)) * fade;
  if (alpha < 0.004) discard;
  gl_FragColor = vec4(colour, alpha);
}`;

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(38, 1, 0.001, 100);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  readonly content = new Group();
  readonly clip = new Plane(new Vector3(1, 0, 0), 0);
  /** Length of a cell of the ground grid, m. */
  cell = 0.01;
  size = 0.1;
  /** Mean time to draw a picture, ms. */
  cost = 0;
  /** True once drawing turned out slow: no shadows, no fine pixels. */
  thrifty = false;
  /** True where even that is slow: pictures that follow each other are coarse, one that stays is sharp. */
  coarse = false;
  mayBeCoarse = true;
  onCamera: () => void = () => {};

  private readonly sun = new DirectionalLight(0xfffaf2, 2.3);
  private readonly head = new DirectionalLight(0xffffff, 0.7);
  private readonly sky = new HemisphereLight(0xfbfcff, 0x868da0, 1.1);
  private readonly grid: Mesh<PlaneGeometry, ShaderMaterial>;
  private readonly shade: Mesh<PlaneGeometry, ShadowMaterial>;
  private wanted = true;
  private slow = 0;
  private lastDrawn = 0;
  /** Width and height on the page, pixels; and what the buffer was made for: these and the ratio. */
  private extent: [number, number] = [1, 1];
  private buffer = "";
  private ratio = 1;
  private shadows = true;
  /** The middle of the picture is beside what a panel covers. */
  private inset = 0;
  private goal: { target: Vector3; position: Vector3 } | null = null;

  /** Throws where there is no WebGL. */
  constructor(readonly canvas: HTMLCanvasElement) {
    const software = drawsInSoftware();
    this.thrifty = this.coarse = software;
    this.renderer = new WebGLRenderer({ canvas, antialias: !software, alpha: true, powerPreference: "high-performance" });
    this.renderer.toneMapping = NoToneMapping;
    this.renderer.localClippingEnabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.controls.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    this.controls.addEventListener("change", () => this.ask());
    this.controls.addEventListener("start", () => (this.goal = null));

    const sheet = new PlaneGeometry(1, 1);
    this.grid = new Mesh(sheet, new ShaderMaterial({
      vertexShader: GRID_VERTEX, fragmentShader: GRID_FRAGMENT, transparent: true, depthWrite: false, side: DoubleSide,
      uniforms: { colour: { value: new Color() }, middle: { value: new Vector2() }, cell: { value: 0.01 }, reach: { value: 1 } },
    }));
    this.grid.renderOrder = -1;
    this.shade = new Mesh(sheet, new ShadowMaterial({ opacity: 0.28, depthWrite: false }));
    this.shade.receiveShadow = true;
    this.shade.renderOrder = -2;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 4;
    this.scene.add(this.content, this.grid, this.shade, this.sky, this.sun, this.sun.target, this.camera, new AmbientLight(0xffffff, 0.12));
    this.camera.add(this.head);
    this.head.position.set(-0.4, 0.5, 1);
    this.setShadows(true);
  }

  /** Asks for a picture. */
  ask(): void {
    this.wanted = true;
  }

  setPalette({ grid, light }: Palette): void {
    (this.grid.material.uniforms["colour"].value as Color).set(grid);
    this.shade.material.opacity = light ? 0.2 : 0.42;
    this.sky.intensity = light ? 1.3 : 1.0;
    this.ask();
  }

  setShadows(on: boolean): void {
    this.shadows = on;
    const cast = on && !this.thrifty;
    if (this.sun.castShadow !== cast) {
      this.sun.castShadow = cast;
      this.renderer.shadowMap.enabled = cast;
      this.renderer.shadowMap.needsUpdate = true;
      this.scene.traverse((object) => {
        if (object instanceof Mesh && !Array.isArray(object.material)) object.material.needsUpdate = true;
      });
    }
    this.shade.visible = cast && this.grid.visible;
    this.ask();
  }

  setGrid(on: boolean): void {
    this.grid.visible = on;
    this.shade.visible = on && this.sun.castShadow;
    this.ask();
  }

  /** Sets ground, light and depth range for a scene of this place and size. */
  setScene(middle: Vec3, size: number, groundZ: number): void {
    this.size = size;
    this.cell = niceAbove(size / 12);
    const reach = 2.6 * size;
    const { uniforms } = this.grid.material;
    uniforms["cell"].value = this.cell;
    uniforms["reach"].value = reach;
    (uniforms["middle"].value as Vector2).set(middle[0], middle[1]);
    for (const mesh of [this.grid, this.shade]) {
      mesh.scale.setScalar(2 * reach);
      mesh.position.set(middle[0], middle[1], groundZ);
    }
    this.shade.position.z -= 1e-4 * size;
    this.sun.position.set(middle[0] + 0.6 * size, middle[1] - 0.8 * size, middle[2] + 2 * size);
    this.sun.target.position.set(...middle);
    const shadow = this.sun.shadow;
    Object.assign(shadow.camera, { left: -size, right: size, top: size, bottom: -size, near: 0.1 * size, far: 5 * size });
    shadow.camera.updateProjectionMatrix();
    shadow.bias = -2e-4;
    shadow.normalBias = 0.01 * size;
    this.camera.near = size / 200;
    this.camera.far = size * 40;
    this.camera.updateProjectionMatrix();
    this.controls.minDistance = 0.15 * size;
    this.controls.maxDistance = 12 * size;
    this.ask();
  }

  /** Looks at a sphere from a direction; `direction` null keeps the present one. */
  fit(middle: Vec3, size: number, direction: Vec3 | null, gently = true): void {
    const target = new Vector3(...middle);
    const from = direction === null
      ? this.camera.position.clone().sub(this.controls.target)
      : new Vector3(...direction);
    if (from.lengthSq() === 0) from.set(1, -1, 0.6);
    const half = (this.camera.fov * Math.PI) / 360;
    const { clientWidth, clientHeight } = this.canvas;
    const narrow = Math.min(1, (clientWidth - this.inset) / Math.max(clientHeight, 1));
    const distance = (0.5 * size) / Math.tan(half) / narrow + 0.12 * size;
    const position = target.clone().add(from.setLength(distance));
    if (gently && !matchMedia("(prefers-reduced-motion: reduce)").matches) {
      this.goal = { target, position };
    } else {
      this.goal = null;
      this.controls.target.copy(target);
      this.camera.position.copy(position);
      this.controls.update();
    }
    this.ask();
  }

  /** Turns the view about its target, rad; from the keyboard. */
  orbit(left: number, up: number): void {
    this.goal = null;
    const from = this.camera.position.clone().sub(this.controls.target);
    const radius = from.length();
    const pitch = Math.min(Math.max(Math.asin(from.z / radius) + up, -1.5), 1.5);
    const yaw = Math.atan2(from.y, from.x) - left;
    from.set(Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)).multiplyScalar(radius);
    this.camera.position.copy(this.controls.target).add(from);
    this.ask();
  }

  zoom(factor: number): void {
    const from = this.camera.position.clone().sub(this.controls.target);
    const length = Math.min(Math.max(from.length() * factor, this.controls.minDistance), this.controls.maxDistance);
    this.camera.position.copy(this.controls.target).add(from.setLength(length));
    this.ask();
  }

  /** Pixels of the page; `inset` of them at the left are covered by a panel. */
  resize(width: number, height: number, inset: number): void {
    if (width < 1 || height < 1) return;
    this.extent = [width, height];
    this.inset = inset;
    this.sharpness(this.coarse && this.mayBeCoarse ? COARSE : this.fine());
    this.camera.aspect = width / height;
    if (this.inset > 0) this.camera.setViewOffset(width, height, -this.inset / 2, 0, width, height);
    else this.camera.clearViewOffset();
    this.camera.updateProjectionMatrix();
    this.ask();
  }

  /** Pixels of the picture for each of the page's. A new size costs a new buffer: none is made for the same. */
  private sharpness(ratio: number): void {
    const [width, height] = this.extent;
    const wanted = [width, height, ratio].join();
    if (wanted === this.buffer) return;
    this.buffer = wanted;
    this.ratio = ratio;
    this.renderer.setDrawingBufferSize(width, height, ratio);
  }

  /** The sharpness of a picture that stays. */
  private fine(): number {
    return this.thrifty ? 1 : Math.min(devicePixelRatio, 2);
  }

  /** Pixels on the canvas of a place in the world; `null` behind the camera. */
  project(place: Vec3): { x: number; y: number; metresPerPixel: number } | null {
    const point = new Vector3(...place);
    const depth = -point.clone().applyMatrix4(this.camera.matrixWorldInverse).z;
    point.project(this.camera);
    if (depth <= this.camera.near || !Number.isFinite(point.x)) return null;
    const { clientWidth, clientHeight } = this.canvas;
    const tall = 2 * depth * Math.tan((this.camera.fov * Math.PI) / 360);
    return { x: (point.x / 2 + 0.5) * clientWidth, y: (0.5 - point.y / 2) * clientHeight, metresPerPixel: tall / clientHeight };
  }

  /** Axes of the view in the world: right, up, and away from the viewer. */
  axes(): { right: Vec3; up: Vec3; away: Vec3 } {
    const e = this.camera.matrixWorld.elements;
    return { right: [e[0], e[1], e[2]], up: [e[4], e[5], e[6]], away: [-e[8], -e[9], -e[10]] };
  }

  /** Draws if asked to. True if it did. */
  draw(): boolean {
    if (this.goal !== null) {
      const { target, position } = this.goal;
      this.controls.target.lerp(target, 0.2);
      this.camera.position.lerp(position, 0.2);
      if (this.camera.position.distanceTo(position) < 1e-3 * this.size) this.goal = null;
      this.wanted = true;
    }
    // Damping moves the camera on after the hand has gone: "change" asks for those pictures.
    this.controls.update();
    if (this.renderer.getContext().isContextLost()) return false;
    const start = performance.now();
    const still = start - this.lastDrawn > STILL_MS;
    const ratio = this.coarse && this.mayBeCoarse && !(still && !this.wanted) ? COARSE : this.fine();
    if (still && ratio > this.ratio) this.wanted = true;
    if (!this.wanted) return false;
    this.sharpness(ratio);
    this.wanted = false;
    this.lastDrawn = start;
    this.renderer.render(this.scene, this.camera);
    this.cost += 0.1 * (performance.now() - start - this.cost);
    this.onCamera();
    return true;
  }

  /** Told how long pictures are apart while they follow each other, ms. */
  pace(ms: number): void {
    // Long apart and quickly drawn: the page was in the background.
    if (this.coarse || (ms > 500 && this.cost < 100)) return;
    this.slow += ms > (this.thrifty ? 2 * SLOW_MS : SLOW_MS) ? 1 : -1;
    this.slow = Math.max(0, this.slow);
    if (this.slow < 24) return;
    this.slow = 0;
    this.coarse = this.thrifty;
    this.thrifty = true;
    this.setShadows(this.shadows);
  }

  /** A picture on a plain ground. */
  async png(background: string): Promise<Blob | null> {
    this.sharpness(this.fine());
    this.renderer.render(this.scene, this.camera);
    const copy = document.createElement("canvas");
    copy.width = this.canvas.width;
    copy.height = this.canvas.height;
    const pen = copy.getContext("2d");
    if (pen === null) return null;
    pen.fillStyle = background;
    pen.fillRect(0, 0, copy.width, copy.height);
    pen.drawImage(this.canvas, 0, 0);
    return new Promise((resolve) => copy.toBlob(resolve, "image/png"));
  }
}
