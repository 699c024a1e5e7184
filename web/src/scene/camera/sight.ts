/** What of the forest a camera sees, by directions along the ground. Pure. */
import type { Viewer } from "galewood/client";
import type { PerspectiveCamera } from "three";

/** How far a view may turn until the worker knows of it, rad. */
const TURN_RAD = 0.25;

/** The viewer behind a camera, whose world matrix must be up to date. Views that contain the zenith or the nadir see trees all around. */
export function viewerAt({ position, matrixWorld, fov, aspect }: PerspectiveCamera): Viewer {
  const { x, z } = position;
  const [rightX, rightY, rightZ, , upX, upY, upZ, , backX, backY, backZ] = matrixWorld.elements;
  const halfUp = Math.tan((fov * Math.PI) / 360);
  const halfAcross = halfUp * aspect;
  const steep = Math.abs(backY);
  if (Math.abs(rightY) <= halfAcross * steep && Math.abs(upY) <= halfUp * steep) return [x, z];
  const length = Math.hypot(backX, backZ);
  const [aheadX, aheadZ] = [-backX / length, -backZ / length];
  // Seen from the zenith or the nadir, the picture is widest at its corners.
  const corners = [-halfAcross, halfAcross].flatMap((across) =>
    [-halfUp, halfUp].map((up) => {
      const dx = across * rightX + up * upX - backX;
      const dz = across * rightZ + up * upZ - backZ;
      return Math.acos(Math.max(-1, Math.min(1, (dx * aheadX + dz * aheadZ) / Math.hypot(dx, dz))));
    }),
  );
  return [x, z, aheadX, aheadZ, Math.cos(Math.min(Math.PI, Math.max(...corners) + TURN_RAD))];
}
