/** The wind at the trees of one group, and their poses as rows for the screen. Allocates nothing per frame. */
import { poseStride } from "../nodeLayout";
import { dynamicPressure, type WindField } from "../wind";

const KNEE_M_S = 5;
const STREAMLINED_EXPONENT = 1.3;

/** Wind speed (m/s) whose effective pressure (Pa) this is: inverse of `dynamicPressure`. */
export function speedFromPressure(pressure_pa: number): number {
  const knee_pa = dynamicPressure(KNEE_M_S);
  const share = pressure_pa / knee_pa;
  return KNEE_M_S * (share <= 1 ? Math.sqrt(share) : share ** (1 / STREAMLINED_EXPONENT));
}

export class GroupWind {
  readonly count: number;
  readonly x: Float32Array;
  readonly z: Float32Array;
  readonly pressureX: Float32Array;
  readonly pressureZ: Float32Array;

  /** `placement`: x, z, yaw, scale of each tree. */
  constructor(readonly placement: Float32Array) {
    this.count = placement.length / 4;
    this.x = this.column(0);
    this.z = this.column(1);
    this.pressureX = new Float32Array(this.count);
    this.pressureZ = new Float32Array(this.count);
  }

  column(channel: 0 | 1 | 2 | 3): Float32Array {
    return Float32Array.from({ length: this.count }, (_, tree) => this.placement[tree * 4 + channel]);
  }

  blow(field: WindField, time_s: number): void {
    field.pressure(this.x, this.z, time_s, this.pressureX, this.pressureZ);
  }

  /** Puts each tree's wind speed (m/s) into its row, behind the modes. */
  writeSpeeds(out: Float32Array, modes: number): void {
    const stride = poseStride(modes);
    for (let tree = 0; tree < this.count; tree++) {
      const pressure_pa = Math.hypot(this.pressureX[tree], this.pressureZ[tree]);
      out[tree * stride + modes] = speedFromPressure(pressure_pa);
    }
  }
}
