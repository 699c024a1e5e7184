/** The sound of the wind at the camera: filtered noise that follows the local gusts. Off until asked for. */
import { effect } from "@preact/signals-core";
import { toggle } from "./controls/tools";
import type { Frame } from "./forest/frameLoop";
import type { World } from "./forest/world";
import type { Store } from "./store/store";

const NOISE_S = 4;
/** Time constant with which the sound follows the wind, s. */
const FOLLOWS_S = 0.18;
/** At this speed the sound has its full volume, m/s. */
const LOUDEST_M_S = 25;

/** Loudness (0..1) and pitch (Hz) of the wind: the power of its noise grows steeply with the speed. Pure. */
export function soundOf(speed_m_s: number): { gain: number; leaves_hz: number; howl_hz: number } {
  const share = Math.min(1, Math.max(0, speed_m_s / LOUDEST_M_S));
  return { gain: share ** 1.5, leaves_hz: 900 + 2600 * share, howl_hz: 120 + 420 * share };
}

/** Noise whose power falls with frequency: white noise, smoothed a little. */
function noise(context: AudioContext): AudioBuffer {
  const buffer = context.createBuffer(1, NOISE_S * context.sampleRate, context.sampleRate);
  const samples = buffer.getChannelData(0);
  let slow = 0;
  for (let i = 0; i < samples.length; i++) {
    const white = 2 * Math.random() - 1;
    slow = 0.96 * slow + 0.04 * white;
    samples[i] = 0.35 * white + 2.2 * slow;
  }
  // Fade the end into the beginning, so that the loop has no click.
  const fade = Math.floor(0.2 * context.sampleRate);
  const end = samples.length - fade;
  for (let i = 0; i < fade; i++) samples[end + i] += (i / fade) * (samples[i] - samples[end + i]);
  return buffer;
}

interface Voice {
  readonly context: AudioContext;
  readonly gain: GainNode;
  readonly leaves: BiquadFilterNode;
  readonly howl: BiquadFilterNode;
}

function makeVoice(): Voice {
  const context = new AudioContext();
  const source = new AudioBufferSourceNode(context, { buffer: noise(context), loop: true });
  const leaves = new BiquadFilterNode(context, { type: "bandpass", Q: 0.5 });
  const howl = new BiquadFilterNode(context, { type: "lowpass", Q: 1.2 });
  const rustle = new GainNode(context, { gain: 0.5 });
  const gain = new GainNode(context, { gain: 0 });
  source.connect(leaves).connect(rustle).connect(gain);
  source.connect(howl).connect(gain);
  gain.connect(context.destination);
  source.start();
  return { context, gain, leaves, howl };
}

export class WindSound {
  readonly tool: HTMLButtonElement;
  /** Current loudness, 0..1. */
  loudness = 0;
  private voice: Voice | null = null;
  private readonly x = new Float64Array(1);
  private readonly z = new Float64Array(1);
  private readonly vx = new Float64Array(1);
  private readonly vz = new Float64Array(1);

  constructor(
    private readonly store: Store,
    private readonly world: World,
  ) {
    const { state } = store;
    this.tool = toggle(
      "sound",
      "Sound of the wind",
      () => state.sound,
      () => {
        state.sound = !state.sound;
      },
    );
    // A page that nobody looks at is silent. The first sound follows from a click, or the browser would suppress it.
    effect(() => this.play(state.sound && !state.away));
  }

  private play(heard: boolean): void {
    if (heard) this.voice ??= makeVoice();
    void (heard ? this.voice?.context.resume() : this.voice?.context.suspend());
  }

  /** The wind where the visitor stands; silent while the motion is paused. */
  advance({ playing }: Frame): void {
    const { voice } = this;
    const { sound, volume } = this.store.state;
    if (!sound || !voice) return;
    const { field, client, stage } = this.world;
    [this.x[0], this.z[0]] = [stage.camera.position.x, stage.camera.position.z];
    field.velocity(this.x, this.z, field.at(client.time_s), this.vx, this.vz);
    const { gain, leaves_hz, howl_hz } = soundOf(Math.hypot(this.vx[0], this.vz[0]));
    this.loudness = playing ? gain * volume : 0;
    const now_s = voice.context.currentTime;
    voice.gain.gain.setTargetAtTime(this.loudness, now_s, FOLLOWS_S);
    voice.leaves.frequency.setTargetAtTime(leaves_hz, now_s, FOLLOWS_S);
    voice.howl.frequency.setTargetAtTime(howl_hz, now_s, FOLLOWS_S);
  }
}
