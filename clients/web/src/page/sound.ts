/** Force as a tone: the stronger, the higher and louder. Silent without contact. */

const LOWEST_HZ = 110;
const OCTAVES = 3;

export class ForceSound {
  private context: AudioContext | null = null;
  private tone: OscillatorNode | null = null;
  private volume: GainNode | null = null;

  /** Browsers allow sound only after a click: call it from one. */
  set(on: boolean): void {
    if (!on) {
      void this.context?.close();
      this.context = this.tone = this.volume = null;
      return;
    }
    if (this.context !== null) return;
    this.context = new AudioContext();
    this.tone = new OscillatorNode(this.context, { type: "triangle", frequency: LOWEST_HZ });
    this.volume = new GainNode(this.context, { gain: 0 });
    this.tone.connect(this.volume).connect(this.context.destination);
    this.tone.start();
  }

  /** `share` of the greatest force, 0 to 1. */
  update(share: number): void {
    if (this.context === null || this.tone === null || this.volume === null) return;
    const strength = Math.min(Math.max(share, 0), 1) || 0;
    const now = this.context.currentTime;
    this.tone.frequency.setTargetAtTime(LOWEST_HZ * 2 ** (OCTAVES * Math.sqrt(strength)), now, 0.015);
    this.volume.gain.setTargetAtTime(strength > 0.002 ? 0.05 + 0.12 * strength : 0, now, 0.02);
  }
}
