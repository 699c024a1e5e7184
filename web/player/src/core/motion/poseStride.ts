/** Floats per tree in a pose buffer: the modes and the local wind speed, padded to whole RGBA texels. */
export function poseStride(modes: number): number {
  return Math.ceil((modes + 1) / 4) * 4;
}
