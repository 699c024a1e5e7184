/** Automatic camera motion: to a viewpoint or along the fly-through, until the visitor takes over. */
import { type PerspectiveCamera, Vector3 } from "three";
import type { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { FLIGHT_S, flightAt, type Viewpoint } from "./viewpoints";

const MOVE_S = 2.2;

const ease = (t: number) => t * t * t * (t * (t * 6 - 15) + 10);

export class CameraFlight {
  private readonly fromEye = new Vector3();
  private readonly fromTarget = new Vector3();
  private readonly eye = new Vector3();
  private readonly target = new Vector3();
  /** Progress to the viewpoint; 1 on arrival. */
  private share = 1;
  private goal: Viewpoint | null = null;
  private flown_s: number | null = null;

  /** `onLanded` is called when the visitor ends the flight by moving the camera. */
  constructor(
    private readonly camera: PerspectiveCamera,
    private readonly controls: OrbitControls,
    private readonly onLanded: () => void,
  ) {
    controls.addEventListener("start", () => this.release());
  }

  get flying(): boolean {
    return this.flown_s !== null;
  }

  private release(): void {
    const flew = this.flying;
    this.goal = null;
    this.flown_s = null;
    if (flew) this.onLanded();
  }

  private setOut(goal: Viewpoint): void {
    this.fromEye.copy(this.camera.position);
    this.fromTarget.copy(this.controls.target);
    this.goal = goal;
    this.share = 0;
  }

  /** Moves to a viewpoint smoothly, or immediately if reduced motion is preferred. */
  go(goal: Viewpoint, cut: boolean): void {
    this.release();
    this.setOut(goal);
    if (cut) this.share = 1;
  }

  /** Starts the flight at the nearest waypoint. */
  fly(): void {
    this.release();
    let least = Number.POSITIVE_INFINITY;
    for (let t = 0; t < FLIGHT_S; t += 1) {
      const { x, y, z } = flightAt(t).eye;
      const distance = this.eye.set(x, y, z).distanceTo(this.camera.position);
      if (distance >= least) continue;
      least = distance;
      this.flown_s = t;
    }
    this.setOut(flightAt(this.flown_s ?? 0));
  }

  land(): void {
    this.release();
  }

  advance(dt_s: number): void {
    if (this.flown_s !== null) {
      this.flown_s += dt_s;
      this.goal = flightAt(this.flown_s);
    }
    if (!this.goal) return;
    this.share = Math.min(1, this.share + dt_s / MOVE_S);
    const t = ease(this.share);
    const { eye, target } = this.goal;
    this.camera.position.lerpVectors(this.fromEye, this.eye.set(eye.x, eye.y, eye.z), t);
    this.controls.target.lerpVectors(this.fromTarget, this.target.set(target.x, target.y, target.z), t);
    if (this.share >= 1 && this.flown_s === null) this.goal = null;
  }
}
